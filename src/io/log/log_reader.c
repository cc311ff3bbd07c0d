/* SPDX-License-Identifier: Apache-2.0 */
/* Reading a log: rows in blocks, as its format gives them; then per block what needs neighbours:
 * times, intervals, increments, findings. */
#include "log_reader_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LOOK = 64 }; /* bytes that tell the format */

static const uint32_t settings_cookie = 0x4C4F4732; /* "LOG2" */

imk_log_settings imk_log_default(void)
{
    return (imk_log_settings){.cookie = settings_cookie};
}

static imk_status check_settings(const imk_log_settings *settings, imk_error *error)
{
    if (settings->cookie != settings_cookie)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, "settings", NULL, "imk_log_default()");
    if (!(settings->rate >= 0.0) || !isfinite(settings->rate)) {
        imk_error_set(error, IMK_ERROR_RANGE, "rate", NULL,
                      "a positive number of samples per second, as in --rate 100Hz");
        if (error)
            error->value = settings->rate;
        return IMK_ERROR_RANGE;
    }
    return imki_log_part_check(settings, error);
}

static imk_status open_reader(imk_log_reader *reader, imki_input *input, imk_error *error)
{
    imki_log_text *text = &reader->text;
    imk_status status = imki_log_text_start(text, input, error);
    if (status == IMK_OK)
        status = imki_log_text_need(text, LOOK, error);
    if (status != IMK_OK)
        return status;
    reader->rate = reader->settings.rate;
    reader->format =
        imki_log_format_recognise(reader->path, text->next, (size_t)(text->end - text->next));
    reader->codec = imki_log_codec_of(reader->format);
    status = reader->codec->open(reader, error);
    if (status != IMK_OK)
        return status;
    reader->last_time = (double)NAN;
    imki_record_times_start(&reader->times, reader->rate > 0.0 ? 1.0 / reader->rate : 0.0);
    if (reader->layout.time_column >= 0)
        reader->times.findings.time_origin =
            reader->time_origin * reader->layout.factor[reader->layout.time_column];
    return IMK_OK;
}

/* Takes the input, also on error. */
static imk_status make_reader(imki_input *input, const char *path, const imk_log_settings *settings,
                              imk_log_reader **reader, imk_error *error)
{
    imk_log_reader *made = calloc(1, sizeof *made);
    if (!made) {
        imki_input_close(input);
        return imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
    }
    made->path = path;
    made->settings = *settings;
    const imk_status status = open_reader(made, input, error);
    if (status != IMK_OK) {
        imk_log_close(made);
        return status;
    }
    *reader = made;
    return IMK_OK;
}

imk_status imk_log_open(const char *path, const imk_log_settings *settings, imk_log_reader **reader,
                        imk_error *error)
{
    const imk_log_settings usual = imk_log_default();
    settings = settings ? settings : &usual;
    imki_input *input;
    imk_status status = check_settings(settings, error);
    if (status == IMK_OK)
        status = settings->reopened ? imki_input_open_kept(path, &input, error)
                                    : imki_input_open(path, &input, error);
    if (status == IMK_OK)
        status = make_reader(input, path, settings, reader, error);
    return status;
}

imk_status imk_log_open_memory(const char *text, size_t size, const imk_log_settings *settings,
                               imk_log_reader **reader, imk_error *error)
{
    const imk_log_settings usual = imk_log_default();
    settings = settings ? settings : &usual;
    imki_input *input;
    imk_status status = check_settings(settings, error);
    if (status == IMK_OK && imki_input_open_memory(text, size, &input) != IMK_OK)
        status = imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
    if (status == IMK_OK)
        status = make_reader(input, NULL, settings, reader, error);
    if (status == IMK_OK) {
        (*reader)->memory = text;
        (*reader)->memory_size = size;
    }
    return status;
}

imk_status imki_log_rewind(imk_log_reader *reader, imk_error *error)
{
    imk_log_reader *again;
    imk_log_settings settings = reader->settings;
    settings.reopened = false;
    const imk_status status =
        reader->memory
            ? imk_log_open_memory(reader->memory, reader->memory_size, &settings, &again, error)
            : imk_log_open(reader->path, &settings, &again, error);
    if (status != IMK_OK)
        return status;
    const imk_log_reader before = *reader;
    *reader = *again;
    *again = before;
    imk_log_close(again);
    return IMK_OK;
}

void imk_log_close(imk_log_reader *reader)
{
    if (reader) {
        if (reader->codec && reader->codec->close)
            reader->codec->close(reader);
        imki_log_text_stop(&reader->text);
        free(reader->state);
        free(reader->labels);
        free(reader);
    }
}

size_t imk_log_column_count(const imk_log_reader *reader)
{
    return reader->layout.column_count;
}

const imk_log_column *imk_log_column_get(const imk_log_reader *reader, size_t index)
{
    return index < reader->layout.column_count ? &reader->layout.column[index] : NULL;
}

int imk_log_column_find(const imk_log_reader *reader, imk_quantity quantity, int axis)
{
    for (size_t i = 0; i < reader->layout.column_count; i++)
        if (reader->layout.column[i].quantity == quantity && reader->layout.column[i].axis == axis)
            return (int)i;
    return -1;
}

const char *imk_log_label(const imk_log_reader *reader, size_t index)
{
    return index < reader->label_count ? reader->labels[index] : NULL;
}

void imk_log_progress(const imk_log_reader *reader, uint64_t *done, uint64_t *size)
{
    const imki_log_text *text = &reader->text;
    if (text->buffer) {
        const uint64_t consumed = text->taken + (uint64_t)(text->next - text->base);
        const uint64_t fetched = text->taken + (uint64_t)(text->end - text->base);
        imki_input_progress(text->input, done, size);
        if (*done == fetched) /* it is not compressed */
            *done = consumed;
    } else {
        *done = (uint64_t)(text->next - text->base);
        *size = (uint64_t)(text->end - text->base);
    }
}

/* Intervals that the increments of these rows are divided by. */
static void find_intervals(imk_log_reader *reader, size_t rows, const double *time)
{
    for (size_t i = 0; i < rows; i++) {
        const double step = time[i] - reader->last_time;
        if (step > 0.0 && isfinite(step))
            reader->last_step = step;
        reader->interval[i] = reader->last_step;
        reader->last_time = time[i];
    }
}

/* What needs more than a row: times, findings, increments; and the offsets of units. */
static void finish_block(imk_log_reader *reader, size_t rows, double *time, double *const *columns)
{
    const imki_log_layout_read *layout = &reader->layout;
    if (time) {
        const double origin = reader->time_origin, scale = layout->factor[layout->time_column];
        for (size_t i = 0; i < rows; i++)
            time[i] = (time[i] - origin) * scale;
        imki_record_times_add(&reader->times, reader->part.before + reader->rows + 1, rows, time);
        if (layout->has_increments && reader->rate == 0.0)
            find_intervals(reader, rows, time);
    }
    for (size_t j = 0; j < layout->column_count; j++) {
        double *value = columns[j];
        if (!value)
            continue;
        if (layout->column[j].increment)
            for (size_t i = 0; i < rows; i++)
                value[i] =
                    reader->rate > 0.0 ? value[i] * reader->rate : value[i] / reader->interval[i];
        const double offset = layout->column[j].unit.offset;
        if (offset != 0.0 && !layout->column[j].label)
            for (size_t i = 0; i < rows; i++)
                value[i] += offset;
    }
    reader->rows += rows;
}

static imk_status read_block(imk_log_reader *reader, size_t max_rows, double *const *columns,
                             size_t *rows, imk_error *error)
{
    const imki_log_layout_read *layout = &reader->layout;
    double *time = NULL, *out[IMK_LOG_COLUMNS_MAX];
    for (size_t i = 0; i < IMK_LOG_COLUMNS_MAX; i++)
        out[i] = reader->spare;
    for (size_t i = 0; i < layout->cell_count; i++) {
        const int column = layout->cell_column[i];
        if (column >= 0 && columns[column])
            out[i] = columns[column];
        if (column >= 0 && column == layout->time_column)
            time = out[i] = columns[column] ? columns[column] : reader->time;
    }
    imk_status status;
    size_t read;
    do {
        status = reader->codec->read(reader, max_rows, out, &read, error);
        *rows = imki_log_part_keep(reader, read, time, out);
    } while (status == IMK_OK && read > 0 && *rows == 0);
    finish_block(reader, *rows, time, columns);
    return status;
}

imk_status imk_log_read(imk_log_reader *reader, size_t max_rows, double *const *columns,
                        size_t *rows, imk_error *error)
{
    size_t done = 0;
    while (done < max_rows && !reader->failed) {
        double *place[IMK_LOG_COLUMNS_MAX] = {NULL};
        for (size_t j = 0; j < reader->layout.column_count; j++)
            place[j] = columns[j] ? columns[j] + done : NULL;
        const size_t left = max_rows - done;
        size_t got;
        reader->failed = read_block(reader, left < IMKI_LOG_BLOCK ? left : IMKI_LOG_BLOCK, place,
                                    &got, &reader->failure) != IMK_OK;
        if (got == 0)
            break;
        done += got;
    }
    if (done == 0 && reader->failed) {
        if (error)
            *error = reader->failure;
        return reader->failure.status;
    }
    *rows = done;
    return done > 0 || reader->rows > 0 ? IMK_OK : imki_log_part_empty(reader, error);
}

imk_log_findings imk_log_findings_get(const imk_log_reader *reader)
{
    imk_log_findings found = imki_record_times_findings(&reader->times);
    found.rows = reader->rows;
    found.not_finite = reader->not_finite;
    found.first_not_finite = reader->first_not_finite;
    if (reader->layout.time_column < 0 && reader->rows > 0)
        found.last_time = (double)(reader->rows - 1) / reader->rate;
    return found;
}
