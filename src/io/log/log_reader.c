/* SPDX-License-Identifier: Apache-2.0 */
/* Reading a log: rows in blocks, as its format gives them; then per block what needs neighbours:
 * times, intervals, increments, findings. */
#define _POSIX_C_SOURCE 200809L
#include "base/text_internal.h"
#include "csv/log_dialects_internal.h"
#include "log_reader_internal.h"
#include "maker/foreign_kinds_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { LOOK = 4096 }; /* bytes that tell the format */

static const uint32_t settings_cookie = 0x4C4F4733; /* "LOG3" */

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
    if ((settings->gyro_range || settings->accel_range) && !settings->device)
        return imk_error_set(
            error, IMK_ERROR_CONFLICT, settings->gyro_range ? "gyro-range" : "accel-range",
            "it is the full scale of a device, and none is named",
            "name it with --device PART, or state what a count is with --gyro-scale and "
            "--accel-scale");
    if ((settings->gyro_range && settings->gyro_scale) ||
        (settings->accel_range && settings->accel_scale))
        return imk_error_set(
            error, IMK_ERROR_CONFLICT,
            settings->gyro_range && settings->gyro_scale ? "gyro-scale" : "accel-scale",
            "the range of the device says what a count is, too", "leave one of the two out");
    if (settings->binary && settings->format && strcmp(settings->format, "binary") != 0)
        return imk_error_set(error, IMK_ERROR_CONFLICT, "binary",
                             "--binary is the format of the file, and --format states another",
                             "leave one of the two out");
    return imki_log_part_check(settings, error);
}

static void refuse_format(const char *name, imk_error *error)
{
    char found[96], expected[400] = "one of";
    size_t used = strlen(expected);
    snprintf(found, sizeof found, "no format is called \"%.40s\"", name);
    const imk_log_format *format;
    for (size_t i = 0; (format = imk_log_format_get(i)) != NULL && used < sizeof expected; i++)
        used += (size_t)snprintf(expected + used, sizeof expected - used, "%s %s", i > 0 ? "," : "",
                                 format->name);
    const imki_log_dialect *dialect;
    for (size_t i = 0; (dialect = imki_log_dialect_get(i)) != NULL; i++)
        if (dialect->format) {
            imki_append_text(expected, sizeof expected, ", ");
            imki_append_text(expected, sizeof expected, dialect->format);
        }
    imk_error_set(error, IMK_ERROR_NAME_UNKNOWN, "format", found, expected);
}

/* The format, by the settings, or by the content; that of folders where there is no input. */
static imk_status find_format(imk_log_reader *reader, const imki_input *input, imk_error *error)
{
    const imki_log_text *text = &reader->text;
    const char *name = reader->settings.binary ? "binary" : reader->settings.format;
    const bool of_text = name && imki_log_dialect_named(name);
    if (input && !name) {
        const imk_status status =
            imki_foreign_packing_refuse(text->next, (size_t)(text->end - text->next), error);
        if (status != IMK_OK)
            return status;
    }
    reader->format =
        of_text ? imk_log_format_get(0)
        : name  ? imk_log_format_named(name)
        : input ? imki_log_recognise(reader->path, text->next, (size_t)(text->end - text->next))
                : imki_log_format_of_folders();
    if (!reader->format) {
        refuse_format(name, error);
        return IMK_ERROR_NAME_UNKNOWN;
    }
    reader->codec = imki_log_codec_of(reader->format);
    if (!input && !reader->codec->folders) {
        char found[96];
        snprintf(found, sizeof found, "it is a folder, and a log of the format %.40s is a file",
                 reader->format->title);
        return imk_error_set(error, IMK_ERROR_OPEN, reader->path, found, "");
    }
    if (input && reader->codec->needs_file && imki_input_file(input) < 0) {
        char found[96];
        snprintf(found, sizeof found, "%.32s is not read from a pipe, .gz, .zst or memory",
                 reader->format->title);
        return imk_error_set(error, IMK_ERROR_UNSUPPORTED, reader->path, found,
                             "write it to a plain file and give that");
    }
    return IMK_OK;
}

/* @param input  NULL: a folder */
static imk_status open_reader(imk_log_reader *reader, imki_input *input, imk_error *error)
{
    imki_log_text *text = &reader->text;
    imk_status status = input ? imki_log_text_start(text, input, error) : IMK_OK;
    if (status == IMK_OK && input)
        status = imki_log_text_need(text, LOOK, error);
    if (status != IMK_OK)
        return status;
    reader->rate = reader->settings.rate;
    status = find_format(reader, input, error);
    if (status == IMK_OK)
        status = reader->codec->open(reader, error);
    if (status == IMK_OK && reader->stream_count == 0 &&
        (reader->settings.topic || reader->settings.instance > 0))
        status = imk_error_set(error, IMK_ERROR_NAME_UNKNOWN, "topic",
                               "the log holds one sensor, which has no name",
                               "leave --topic and --instance out");
    if (status != IMK_OK)
        return status;
    for (size_t i = 0; i < reader->layout.column_count && reader->codec->defines_units; i++)
        reader->layout.column[i].unit_origin = IMK_UNIT_OF_FORMAT;
    reader->last_time = (double)NAN;
    imki_record_times_start(&reader->times, reader->rate > 0.0 ? 1.0 / reader->rate : 0.0);
    if (reader->layout.time_column >= 0)
        reader->times.findings.time_origin =
            reader->origin_before +
            reader->time_origin * reader->layout.factor[reader->layout.time_column];
    return IMK_OK;
}

/* Takes the input, also on error. On error the reader is made only if there is memory; it is to be
 * closed. */
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
    *reader = made;
    return open_reader(made, input, error);
}

static bool is_folder(const char *path)
{
    struct stat about;
    return path && imki_log_format_of_folders() && stat(path, &about) == 0 &&
           S_ISDIR(about.st_mode);
}

/* Is it read, if it begins so? What the settings state the format of may begin anyhow. */
static bool is_known(const void *context, const char *begin, size_t size)
{
    const imk_log_settings *settings = context;
    return settings->format || settings->binary ||
           imki_log_recognise(NULL, begin, size < LOOK ? size : LOOK) != imk_log_format_get(0);
}

/* As imk_log_open(), but the reader may be made also on error. NULL: it is not. */
static imk_status open_path(const char *path, const imk_log_settings *settings,
                            imk_log_reader **reader, imk_error *error)
{
    const imk_log_settings usual = imk_log_default();
    settings = settings ? settings : &usual;
    imki_input *input = NULL;
    *reader = NULL;
    imk_status status = check_settings(settings, error);
    if (status == IMK_OK && !is_folder(path))
        status = settings->reopened ? imki_input_open_known(path, is_known, settings, &input, error)
                                    : imki_input_open(path, &input, error);
    if (status == IMK_OK)
        status = make_reader(input, path, settings, reader, error);
    return status;
}

/* The reader on success only. */
static imk_status give(imk_log_reader *made, imk_status status, imk_log_reader **reader)
{
    if (status == IMK_OK)
        *reader = made;
    else
        imk_log_close(made);
    return status;
}

imk_status imk_log_open(const char *path, const imk_log_settings *settings, imk_log_reader **reader,
                        imk_error *error)
{
    imk_log_reader *made;
    const imk_status status = open_path(path, settings, &made, error);
    return give(made, status, reader);
}

imk_status imk_log_streams(const char *path, const imk_log_settings *settings, size_t most,
                           imk_log_stream *stream, size_t *count, const imk_log_format **format,
                           imk_error *error)
{
    const imk_log_settings usual = imk_log_default();
    imk_log_settings any = settings ? *settings : usual;
    imk_log_reader *made;
    imk_error reason;
    any.topic = NULL;
    any.instance = 0;
    imk_status status = open_path(path, &any, &made, &reason);
    /* That none is chosen, or none can be read, is no error here. */
    if (made && made->stream_count > 0 &&
        (status == IMK_ERROR_NAME_UNKNOWN || status == IMK_ERROR_EMPTY))
        status = IMK_OK;
    if (status != IMK_OK && error)
        *error = reason;
    if (status == IMK_OK) {
        *count = imk_log_stream_list(made, most, stream);
        if (format)
            *format = made->format;
    }
    imk_log_close(made);
    return status;
}

size_t imk_log_stream_list(const imk_log_reader *reader, size_t most, imk_log_stream *stream)
{
    for (size_t i = 0; i < reader->stream_count && i < most; i++)
        stream[i] = reader->streams[i];
    return reader->stream_count;
}

const imk_log_stream *imk_log_stream_get(const imk_log_reader *reader)
{
    static const imk_log_stream only = {
        .instance = -1, .readable = true, .begin = (double)NAN, .end = (double)NAN};
    return reader->stream_count > 0 ? &reader->streams[reader->stream] : &only;
}

const imk_log_format *imk_log_format_read(const imk_log_reader *reader)
{
    return reader->format;
}

imk_status imk_log_open_memory(const char *text, size_t size, const imk_log_settings *settings,
                               imk_log_reader **reader, imk_error *error)
{
    const imk_log_settings usual = imk_log_default();
    settings = settings ? settings : &usual;
    imki_input *input;
    imk_status status = check_settings(settings, error);
    imk_log_reader *made = NULL;
    if (status == IMK_OK && imki_input_open_memory(text, size, &input) != IMK_OK)
        status = imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
    if (status == IMK_OK)
        status = make_reader(input, NULL, settings, &made, error);
    if (status == IMK_OK) {
        made->memory = text;
        made->memory_size = size;
    }
    return give(made, status, reader);
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
        free(reader->streams);
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
    if (reader->codec->progress)
        reader->codec->progress(reader, done, size);
    else
        imki_log_text_progress(&reader->text, done, size);
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
            imki_log_intervals(reader, rows, time);
    }
    for (size_t j = 0; j < layout->column_count; j++) {
        double *value = columns[j];
        if (!value)
            continue;
        if (layout->column[j].increment)
            for (size_t i = 0; i < rows; i++)
                value[i] =
                    reader->rate > 0.0 ? value[i] * reader->rate : value[i] / reader->interval[i];
        const double offset = layout->offset[j];
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
    if (status == IMK_OK)
        status = imki_log_counts_check(reader, *rows, columns, error);
    if (status == IMK_OK && time)
        status = imki_log_pace_check(reader, *rows, time, read == 0, error);
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

imk_status imk_log_seek(imk_log_reader *reader, double fraction, imk_error *error)
{
    if (!reader->codec->seek || !(fraction >= 0 && fraction <= 1)) {
        char found[96];
        snprintf(found, sizeof found, "a log of the format %.40s is read from its beginning",
                 reader->format->title);
        return imk_error_set(error, IMK_ERROR_UNSUPPORTED, "", found, "");
    }
    const double origin = reader->times.findings.time_origin;
    const imk_status status = reader->codec->seek(reader, fraction, error);
    if (status != IMK_OK)
        return status;
    memset(&reader->times, 0, sizeof reader->times);
    imki_record_times_start(&reader->times, reader->rate > 0.0 ? 1.0 / reader->rate : 0.0);
    reader->times.findings.time_origin = origin;
    reader->last_time = (double)NAN;
    reader->rows = reader->not_finite = reader->first_not_finite = 0;
    reader->damaged = reader->first_damaged = 0;
    reader->damaged_line = reader->damaged_column = 0;
    reader->headers = reader->first_header = 0;
    reader->other_frames = 0;
    reader->absent = reader->stated = reader->stamps = 0;
    memset(reader->later, 0, sizeof reader->later);
    reader->failed = reader->cut_short = false;
    return IMK_OK;
}

/* [ns] subtracted from the times */
static int64_t origin_of(const imk_log_reader *reader)
{
    const int column = reader->layout.time_column;
    const double more = column < 0 ? 0 : reader->time_origin * reader->layout.factor[column];
    return fabs(more) < 9e9 ? reader->origin_nanoseconds + llround(more * 1e9) : 0;
}

imk_log_findings imk_log_findings_get(const imk_log_reader *reader)
{
    imk_log_findings found = imki_record_times_findings(&reader->times);
    found.time_origin_nanoseconds = origin_of(reader);
    found.rows = reader->rows;
    found.not_finite = reader->not_finite;
    found.first_not_finite = reader->first_not_finite;
    found.damaged = reader->damaged;
    found.first_damaged = reader->first_damaged;
    found.damaged_line = reader->damaged_line;
    found.damaged_column = reader->damaged_column;
    found.headers = reader->headers;
    found.first_header = reader->first_header;
    found.cut_short = reader->cut_short;
    found.received = reader->received;
    found.stamps = reader->stamps;
    memcpy(found.later, reader->later, sizeof found.later);
    found.device_interval = reader->device_interval;
    found.unread = reader->unread;
    found.absent = reader->absent;
    found.stated = reader->stated;
    found.unclosed = reader->unclosed;
    found.unlisted = reader->unlisted;
    memcpy(found.unlisted_name, reader->unlisted_name, sizeof found.unlisted_name);
    memcpy(found.unread_name, reader->unread_name, sizeof found.unread_name);
    memcpy(found.unread_kind, reader->unread_kind, sizeof found.unread_kind);
    found.other_frames = reader->other_frames;
    memcpy(found.frames, reader->frames, sizeof found.frames);
    if (reader->layout.time_column < 0 && reader->rows > 0)
        found.last_time = (double)(reader->rows - 1) / reader->rate;
    return found;
}
