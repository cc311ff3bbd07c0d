/* SPDX-License-Identifier: Apache-2.0 */
/* Logs that hold several sensors: which there are, which one is read. And what formats that define
 * their own columns and clocks share. */
#include "log_reader_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

imk_status imki_log_stream_add(imk_log_reader *reader, const imk_log_stream *stream,
                               imk_error *error)
{
    if (reader->stream_count == reader->stream_room) {
        const size_t room = reader->stream_room > 0 ? 2 * reader->stream_room : 16;
        imk_log_stream *larger = realloc(reader->streams, room * sizeof *larger);
        if (!larger)
            return imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
        reader->streams = larger;
        reader->stream_room = room;
    }
    reader->streams[reader->stream_count++] = *stream;
    return IMK_OK;
}

/* How well the name of the settings is that of a stream: 2 the same, 1 its ending behind a "/" or
 * as a whole, 0 not. */
static int likeness(const imk_log_stream *stream, const char *name)
{
    const size_t length = strlen(name), whole = strlen(stream->name);
    if (strcmp(stream->name, name) == 0)
        return 2;
    return length > 0 && length < whole && strcmp(stream->name + whole - length, name) == 0;
}

/* The only sensor of its name is the first one, too. */
bool imki_log_stream_is_named(const imk_log_reader *reader, const imk_log_stream *stream)
{
    const imk_log_settings *s = &reader->settings;
    return (!s->topic || likeness(stream, s->topic) > 0) &&
           (s->instance == 0 || stream->instance == s->instance - 1 ||
            (s->instance == 1 && stream->instance < 0));
}

static bool is_asked(const imk_log_reader *reader, const imk_log_stream *stream, int alike)
{
    const char *topic = reader->settings.topic;
    return stream->readable && imki_log_stream_is_named(reader, stream) &&
           (!topic || likeness(stream, topic) >= alike);
}

/* How a stream is asked for: "--topic imu --instance 1", or "--instance 1" where the settings name
 * the topic rightly. */
static void describe(const imk_log_reader *reader, const imk_log_stream *stream, size_t size,
                     char *text)
{
    const imk_log_settings *s = &reader->settings;
    size_t same = 0;
    for (size_t i = 0; i < reader->stream_count; i++)
        same += reader->streams[i].readable && strcmp(reader->streams[i].name, stream->name) == 0;
    const bool named = s->topic && strcmp(s->topic, stream->name) == 0;
    const bool told = stream->instance < 0 || (same <= 1 && s->instance == 0);
    int used = 0;
    if (!named || told)
        used = snprintf(text, size, "--topic %.96s", stream->name);
    if (!told && used >= 0 && (size_t)used < size)
        snprintf(text + used, size - (size_t)used, "%s--instance %d", used > 0 ? " " : "",
                 stream->instance);
}

/* Several are there, or none of that name: the first ones as options. */
static imk_status refuse(const imk_log_reader *reader, size_t matches, imk_error *error)
{
    const imk_log_settings *s = &reader->settings;
    char found[96], expected[160] = "", one[128];
    size_t readable = 0, used = 0, listed = 0, numbered = 0;
    for (size_t i = 0; i < reader->stream_count; i++) {
        const imk_log_stream *stream = &reader->streams[i];
        readable += stream->readable;
        numbered += stream->readable && stream->instance >= 0;
        if (!(matches > 0 ? is_asked(reader, stream, 1) : stream->readable) || listed >= 3)
            continue;
        describe(reader, stream, sizeof one, one);
        if (used + strlen(one) + 12 >= sizeof expected)
            continue;
        used += (size_t)snprintf(expected + used, sizeof expected - used, "%s%s",
                                 listed == 0   ? "add "
                                 : listed == 1 ? " (or "
                                               : ", ",
                                 one);
        listed++;
    }
    if (s->instance > 1 && numbered == 0)
        return imk_error_set(error, IMK_ERROR_NAME_UNKNOWN, "instance",
                             "the sensors of the log are told apart by their names",
                             "leave --instance out");
    const size_t shown = matches > 0 ? matches : readable;
    if (listed > 1)
        snprintf(expected + used, sizeof expected - used, listed < shown ? ", ...)" : ")");
    if (matches > 0 && !s->topic && s->instance == 0)
        snprintf(found, sizeof found, "the log holds %zu sensors", readable);
    else if (s->topic && matches == 0 && s->instance > 0)
        snprintf(found, sizeof found, "none of the %zu sensors is \"%.40s\" of instance %d",
                 readable, s->topic, s->instance - 1);
    else if (readable == 1)
        snprintf(found, sizeof found, "the log holds one sensor, and it is another one");
    else if (s->topic)
        snprintf(found, sizeof found, "%s of the %zu sensors of the log %s called \"%.40s\"",
                 matches > 0 ? "several" : "none", readable, matches > 0 ? "are" : "is", s->topic);
    else
        snprintf(found, sizeof found, "%s of the %zu sensors of the log %s instance %d",
                 matches > 0 ? "several" : "none", readable, matches > 0 ? "have" : "has",
                 s->instance - 1);
    return imk_error_set(error, IMK_ERROR_NAME_UNKNOWN, "topic", found, expected);
}

imk_status imki_log_stream_choose(imk_log_reader *reader, const char *nothing, size_t *index,
                                  imk_error *error)
{
    size_t matches[3] = {0}, first[3] = {0}, readable = 0;
    for (size_t i = 0; i < reader->stream_count; i++) {
        readable += reader->streams[i].readable;
        for (int alike = 1; alike <= 2; alike++)
            if (is_asked(reader, &reader->streams[i], alike) && matches[alike]++ == 0)
                first[alike] = i;
    }
    if (readable == 0)
        return imk_error_set(error, IMK_ERROR_EMPTY, "", nothing,
                             "a log with gyros or accelerometers");
    const int alike = matches[2] > 0 ? 2 : 1;
    if (matches[alike] != 1)
        return refuse(reader, matches[alike], error);
    *index = reader->stream = first[alike];
    return IMK_OK;
}

imk_status imki_log_layout_of(imk_log_reader *reader, size_t count, const char *const *names,
                              imk_error *error)
{
    imki_log_piece cells[IMK_LOG_COLUMNS_MAX];
    if (count > IMK_LOG_COLUMNS_MAX)
        return imk_error_set(error, IMK_ERROR_COLUMN, "", "the log has more than 64 columns",
                             "at most 64 columns");
    if (reader->settings.columns)
        return imk_error_set(
            error, IMK_ERROR_CONFLICT, "columns",
            "names are for logs that have none, and this format defines its columns",
            "leave --columns out; --map chooses columns by their names");
    for (size_t i = 0; i < count; i++) {
        const char *name = names[i] ? names[i] : "-";
        cells[i] = (imki_log_piece){name, name + strlen(name)};
    }
    return imki_log_layout_make(cells, count, &reader->settings, &reader->layout, error);
}

int64_t imki_log_nanoseconds(int64_t ticks, int64_t per_second)
{
    enum { BILLION = 1000000000 };
    const int64_t each = per_second > 0 && BILLION % per_second == 0 ? BILLION / per_second : 0;
    if (each > 0 && ticks < INT64_MAX / each && ticks > INT64_MIN / each)
        return ticks * each;
    if (per_second > BILLION && per_second % BILLION == 0) {
        const int64_t parts = per_second / BILLION, rest = ticks % parts;
        return ticks / parts + (2 * rest >= parts) - (2 * rest <= -parts);
    }
    const double nanoseconds = (double)ticks / (double)per_second * BILLION;
    return fabs(nanoseconds) < 9.2e18 ? llround(nanoseconds) : 0;
}

int64_t imki_log_stamp_origin(imk_log_reader *reader, int64_t first, int64_t per_second)
{
    const double seconds = (double)first / (double)per_second;
    if (fabs(seconds) <= 1e6)
        return 0;
    reader->origin_before = seconds;
    reader->origin_nanoseconds = imki_log_nanoseconds(first, per_second);
    return first;
}

void imki_log_damage(imk_log_reader *reader, size_t rows)
{
    if (reader->damaged++ == 0)
        reader->first_damaged = reader->rows + rows;
}

imk_status imki_log_first_rows(imk_log_reader *reader, uint64_t rows, const double time[2],
                               const char *none, const char *due, imk_error *error)
{
    const imki_log_layout_read *layout = &reader->layout;
    if (rows == 0)
        return imk_error_set(error, IMK_ERROR_EMPTY, "", none, due);
    if (rows < 2 && layout->has_increments && reader->rate == 0.0)
        return imk_error_set(error, IMK_ERROR_TOO_SHORT, "",
                             "a single row of increments does not tell the sampling rate",
                             "give two rows, or add --rate RATE (samples per second)");
    if (layout->time_column >= 0) {
        const double scale = layout->factor[layout->time_column];
        if (fabs(time[0]) * scale > 1e6)
            reader->time_origin = time[0];
        reader->steps.usual = (time[1] - time[0]) * scale;
    }
    return IMK_OK;
}
