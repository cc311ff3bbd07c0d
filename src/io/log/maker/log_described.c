/* SPDX-License-Identifier: Apache-2.0 */
/* Logs of binary records whose layout the user describes (description.c). A word at the beginning
 * of each record, if there is one, must also stand behind it, so that a record which lost bytes is
 * not read as one of shifted numbers. */
#include "../log_reader_internal.h"
#include "description_internal.h"
#include "record_bytes_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct described {
    imki_record_form form;
    uint64_t begin; /* byte of the first record */
    imki_counter clock;
    int64_t origin; /* of the clock */
    bool lost;      /* the last bytes were no record */
} described;

/* The record at the place, or NULL: there is no more. It is consumed. */
static imk_status next_record(imk_log_reader *reader, size_t rows, const unsigned char **record,
                              imk_error *error)
{
    described *d = reader->state;
    imki_log_text *text = &reader->text;
    const imki_record_form *form = &d->form;
    for (;;) {
        const imk_status status = imki_log_text_need(text, form->size + form->sync_size, error);
        if (status != IMK_OK)
            return status;
        const size_t left = (size_t)(text->end - text->next);
        const size_t front = left < form->sync_size ? left : form->sync_size;
        const bool begins = memcmp(text->next, form->sync, front) == 0;
        *record = NULL;
        if (left < form->size && (begins || left == 0)) {
            reader->cut_short |= left > 0;
            text->next = text->end;
            return IMK_OK;
        }
        const size_t behind =
            left - form->size < form->sync_size ? left - form->size : form->sync_size;
        if (begins && memcmp(text->next + form->size, form->sync, behind) == 0) {
            *record = (const unsigned char *)text->next;
            text->next += form->size;
            d->lost = false;
            return IMK_OK;
        }
        if (!d->lost)
            imki_log_damage(reader, rows);
        d->lost = true;
        const char *next = memchr(text->next + 1, form->sync[0], left - 1);
        text->next = next ? next : text->end;
    }
}

static uint64_t bits_of(const imki_record_field *field, const unsigned char *record)
{
    return field->big_endian ? imki_big(record + field->place, field->size)
                             : imki_little(record + field->place, field->size);
}

static double number_of(const imki_record_field *field, const unsigned char *record)
{
    const uint64_t bits = bits_of(field, record);
    if (field->is_float)
        return field->size == 4 ? imki_float(bits) : imki_double(bits);
    return field->is_signed ? (double)imki_signed(bits, 8 * (unsigned)field->size) : (double)bits;
}

static double scaled(const imki_count_scale *scale, double number)
{
    return number / scale->divisor * scale->factor + scale->offset;
}

/* The time as it stands, in its unit, of a clock that does not begin again. */
static double time_of(described *d, const unsigned char *record)
{
    const imki_record_field *field = &d->form.field[d->form.time_field];
    if (field->is_float)
        return scaled(&field->scale, number_of(field, record));
    const int64_t ticks = imki_counter_unwrap(&d->clock, bits_of(field, record),
                                              8 * (unsigned)field->size, field->is_signed);
    return scaled(&field->scale, (double)(int64_t)((uint64_t)ticks - (uint64_t)d->origin));
}

/* Whole ticks beyond 1e6 s count from the first one, so that no digit is lost. */
static void find_origin(imk_log_reader *reader, const unsigned char *record)
{
    described *d = reader->state;
    const imki_record_field *field = &d->form.field[d->form.time_field];
    imki_counter clock = {.begun = false};
    if (field->is_float)
        return;
    const int64_t ticks = imki_counter_unwrap(&clock, bits_of(field, record),
                                              8 * (unsigned)field->size, field->is_signed);
    const double seconds =
        scaled(&field->scale, (double)ticks) * reader->layout.factor[reader->layout.time_column];
    if (fabs(seconds) > 1e6) {
        d->origin = ticks;
        reader->origin_before = seconds;
        reader->origin_nanoseconds = fabs(seconds) < 9.2e9 ? llround(seconds * 1e9) : 0;
    }
}

/* The first two records; they stay. */
static imk_status look_at_rows(imk_log_reader *reader, imk_error *error)
{
    described *d = reader->state;
    imki_log_text *text = &reader->text;
    double time[2] = {(double)NAN, (double)NAN};
    uint64_t rows = 0;
    imk_status status = IMK_OK;
    text->hold = text->next;
    for (; rows < 2; rows++) {
        const unsigned char *record;
        status = next_record(reader, 0, &record, error);
        if (status != IMK_OK || !record)
            break;
        if (rows == 0 && d->form.time_field >= 0)
            find_origin(reader, record);
        if (d->form.time_field >= 0)
            time[rows] = time_of(d, record);
    }
    text->next = text->hold;
    text->hold = NULL;
    d->clock.begun = d->lost = reader->cut_short = false;
    reader->damaged = reader->first_damaged = 0;
    if (status != IMK_OK)
        return status;
    return imki_log_first_rows(reader, rows, time,
                               d->form.sync_size > 0
                                   ? "no record begins and ends at the sync word of --binary"
                                   : "the file has no record of the size that --binary states",
                               "the layout of the records of this file", error);
}

static imk_status skip_header(imk_log_reader *reader, imk_error *error)
{
    imki_log_text *text = &reader->text;
    const described *d = reader->state;
    for (uint64_t left = d->form.header; left > 0;) {
        const imk_status status = imki_log_text_need(text, 1, error);
        if (status != IMK_OK)
            return status;
        const size_t at_hand = (size_t)(text->end - text->next);
        const size_t part = at_hand < left ? at_hand : (size_t)left;
        if (part == 0)
            return imk_error_set(error, IMK_ERROR_EMPTY, "binary",
                                 "the file is shorter than the header", "a smaller header");
        text->next += part;
        left -= part;
    }
    return IMK_OK;
}

/* A file that says what it is is no file of records alone; behind a header that is passed over it
 * may hold some. Beginnings of fewer bytes are too easily those of a record. */
static imk_status refuse_known(const imk_log_reader *reader, imk_error *error)
{
    enum { CERTAIN = 4 };
    const imki_log_text *text = &reader->text;
    const imk_log_format *format =
        imk_log_format_begun(text->next, (size_t)(text->end - text->next));
    char found[96];
    if (!format || strlen(format->beginning) < CERTAIN)
        return IMK_OK;
    snprintf(found, sizeof found, "the file begins as one of the format %.32s", format->title);
    return imk_error_set(error, IMK_ERROR_CONFLICT, "binary", found,
                         "leave --binary out; or state how many bytes stand before the records, "
                         "as \"header 128\"");
}

static imk_status open_described(imk_log_reader *reader, imk_error *error)
{
    const char *names[IMK_LOG_COLUMNS_MAX];
    if (!reader->settings.binary)
        return imk_error_set(error, IMK_ERROR_CONFLICT, "format",
                             "the layout of the records is not stated",
                             "add --binary with the layout, such as \"u32 time us, 3 x i16 gyro "
                             "16.4 LSB/(deg/s), 3 x i16 accel 2048 LSB/g\"");
    described *d = calloc(1, sizeof *d);
    reader->state = d;
    if (!d)
        return imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
    imk_status status = imki_record_form_parse(reader->settings.binary, &d->form, error);
    for (size_t i = 0; i < d->form.field_count; i++)
        names[i] = d->form.field[i].name;
    if (status == IMK_OK)
        status = imki_log_layout_of(reader, d->form.field_count, names, error);
    for (size_t i = 0; i < reader->layout.column_count; i++)
        reader->layout.column[i].unit_origin = IMK_UNIT_OF_SETTINGS;
    if (status == IMK_OK)
        status = d->form.header > 0 ? skip_header(reader, error) : refuse_known(reader, error);
    if (status != IMK_OK)
        return status;
    d->begin = imki_log_text_place(&reader->text);
    return look_at_rows(reader, error);
}

static imk_status read_described(imk_log_reader *reader, size_t max_rows, double *const *out,
                                 size_t *rows, imk_error *error)
{
    described *d = reader->state;
    const imki_log_layout_read *layout = &reader->layout;
    for (*rows = 0; *rows < max_rows; ++*rows) {
        const unsigned char *record;
        const imk_status status = next_record(reader, *rows, &record, error);
        if (status != IMK_OK || !record)
            return status;
        bool finite = true;
        for (size_t i = 0; i < d->form.field_count; i++) {
            const imki_record_field *field = &d->form.field[i];
            double value = (int)i == d->form.time_field
                               ? time_of(d, record)
                               : scaled(&field->scale, number_of(field, record));
            value *= layout->cell_factor[i];
            finite &= isfinite(value) != 0;
            out[i][*rows] = value;
        }
        if (!finite && reader->not_finite++ == 0)
            reader->first_not_finite = reader->rows + *rows + 1;
    }
    return IMK_OK;
}

static imk_status seek_described(imk_log_reader *reader, double fraction, imk_error *error)
{
    described *d = reader->state;
    const uint64_t size = imki_log_text_size(&reader->text);
    const uint64_t records = size > d->begin ? (size - d->begin) / d->form.size : 0;
    const uint64_t record = (uint64_t)(fraction * (double)records);
    const uint64_t to = record < records ? record : records;
    const imk_status status =
        imki_log_text_seek(&reader->text, d->begin + to * d->form.size, error);
    d->clock.begun = false;
    d->lost = true; /* lost bytes before may have moved the records */
    return status;
}

const imki_log_codec imki_log_described = {
    .open = open_described, .read = read_described, .seek = seek_described};
