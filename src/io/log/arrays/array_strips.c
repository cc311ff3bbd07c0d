/* SPDX-License-Identifier: Apache-2.0 */
/* A source that is packed and holds one strip is inflated as it is read. One that holds several is
 * unpacked to a temporary file first: they would all begin anew. */
#define _POSIX_C_SOURCE 200809L
#include "array_strips_internal.h"

#include "io/file/nameless_file_internal.h"
#include "io/file/system_error_internal.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { BLOCK_ROWS = 4096 };

imk_status imki_array_strips_make(imk_log_reader *reader, char separator, imk_error *error)
{
    imki_array_strips *state = calloc(1, sizeof *state);
    if (!state)
        return imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
    state->rows.list.separator = separator;
    state->unpacked = -1;
    reader->state = state;
    return IMK_OK;
}

imk_status imki_array_source_add(imki_array_strips *state, const imki_packed *source,
                                 const char *name, imk_error *error)
{
    if (state->source_count == state->source_room) {
        const size_t room = state->source_room > 0 ? 2 * state->source_room : 16;
        imki_packed *sources = realloc(state->source, room * sizeof *sources);
        state->source = sources ? sources : state->source;
        char **names = realloc(state->source_name, room * sizeof *names);
        state->source_name = names ? names : state->source_name;
        if (!sources || !names)
            return imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
        state->source_room = room;
    }
    char *own = name ? strdup(name) : NULL;
    if (name && !own)
        return imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
    state->source_name[state->source_count] = own;
    state->source[state->source_count] = *source;
    state->source[state->source_count++].name = own;
    return IMK_OK;
}

/* The strip of a cell; a part of an array whose parts are interleaved shares one. */
static void add_strip(imki_array_strips *state, size_t cell)
{
    const imki_array_column *column = &state->rows.column[cell];
    const imki_array *array = &state->rows.list.array[column->array];
    const size_t size = imki_value_size(array->type);
    const uint64_t row_step = array->step[array->along], step = array->step[!array->along];
    const bool interleaved = array->parts > 1 && row_step >= step * array->parts;
    const uint64_t at = array->place + (interleaved ? 0 : column->part * step);
    size_t i = 0;
    while (i < state->strip_count &&
           (state->strip[i].source != array->source || state->strip[i].begin != at || !interleaved))
        i++;
    if (i == state->strip_count)
        state->strip[state->strip_count++] = (imki_strip){
            .source = array->source, .begin = at, .record = interleaved ? (size_t)row_step : size};
    state->cell_strip[cell] = i;
    state->cell_offset[cell] = interleaved ? (size_t)(column->part * step) : 0;
}

/* Unpack a source in which several strips are, once. */
static imk_status unpack(imki_array_strips *state, size_t source, uint64_t most, imk_error *error)
{
    imki_packed *packed = &state->source[source];
    if (state->unpacked < 0)
        state->unpacked = imki_open_nameless();
    const off_t begin = state->unpacked < 0 ? -1 : lseek(state->unpacked, 0, SEEK_END);
    if (begin < 0) {
        imk_error reason;
        char found[96];
        (void)imki_system_error(&reason, IMK_ERROR_WRITE, "", errno);
        snprintf(found, sizeof found, "its unpacked copy cannot be written: %.55s", reason.found);
        return imk_error_set(error, IMK_ERROR_WRITE, "", found, "set TMPDIR to a folder with room");
    }
    const imk_status status =
        imki_packed_copy(packed, most, state->unpacked, (uint64_t)begin, error);
    *packed = (imki_packed){.file = state->unpacked,
                            .begin = (uint64_t)begin,
                            .size = most,
                            .packing = IMKI_PLAIN,
                            .name = packed->name};
    return status;
}

/* The byte behind the last row of a strip. */
static uint64_t end_of(const imki_array_strips *state, const imki_strip *strip)
{
    return strip->begin + state->rows.rows * strip->record;
}

/* Bytes before the first row are read, too, so that the checksum holds. */
static imk_status open_strip(const imki_packed *source, imki_strip *strip, imk_error *error)
{
    imk_status status = imki_packed_open(source, &strip->part, error);
    const size_t step = BLOCK_ROWS * strip->record;
    strip->buffer = malloc(step);
    if (status == IMK_OK && !strip->buffer)
        status = imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
    while (status == IMK_OK && source->has_crc && strip->part.place < strip->begin) {
        const uint64_t left = strip->begin - strip->part.place;
        status = imki_packed_read(&strip->part, strip->part.place, strip->buffer,
                                  left < step ? (size_t)left : step, error);
    }
    return status;
}

static imk_status open_strips(imki_array_strips *state, imk_error *error)
{
    imk_status status = IMK_OK;
    for (size_t source = 0; source < state->source_count && status == IMK_OK; source++) {
        uint64_t most = 0;
        size_t strips = 0;
        for (size_t i = 0; i < state->strip_count; i++)
            if (state->strip[i].source == source) {
                const uint64_t end = end_of(state, &state->strip[i]);
                most = most > end ? most : end;
                strips++;
            }
        const bool packed = state->source[source].packing != IMKI_PLAIN;
        if (packed && strips > 1)
            status = unpack(state, source, most, error);
        else if (strips > 1 && state->source[source].has_crc)
            status = imki_packed_check(&state->source[source], error);
        state->source[source].has_crc = state->source[source].has_crc && strips == 1;
        state->packed = state->packed || (packed && strips == 1);
    }
    for (size_t i = 0; i < state->strip_count && status == IMK_OK; i++)
        status = open_strip(&state->source[state->strip[i].source], &state->strip[i], error);
    return status;
}

/* As imki_array_rows.load. The last rows are given when the checksum holds. */
static imk_status load(imk_log_reader *reader, imk_error *error)
{
    imki_array_strips *state = reader->state;
    const uint64_t left = state->rows.rows - state->rows.begin;
    const size_t count = left < BLOCK_ROWS ? (size_t)left : BLOCK_ROWS;
    for (size_t i = 0; i < state->strip_count; i++) {
        imki_strip *strip = &state->strip[i];
        const uint64_t place = strip->begin + state->rows.begin * strip->record;
        imk_status status =
            imki_packed_read(&strip->part, place, strip->buffer, count * strip->record, error);
        if (status == IMK_OK && count == left)
            status = imki_packed_end(&strip->part, error);
        if (status != IMK_OK)
            return status;
    }
    state->rows.at_hand = count;
    return IMK_OK;
}

imk_status imki_array_strips_begin(imk_log_reader *reader, imk_error *error)
{
    imki_array_strips *state = reader->state;
    imk_status status =
        imki_arrays_choose(reader, &state->rows.list, state->rows.column, &state->rows.rows, error);
    if (status != IMK_OK)
        return status;
    for (size_t i = 0; i < reader->layout.cell_count; i++)
        if (reader->layout.cell_column[i] >= 0)
            add_strip(state, i);
    status = open_strips(state, error);
    if (status != IMK_OK)
        return status;
    for (size_t i = 0; i < reader->layout.cell_count; i++) {
        if (reader->layout.cell_column[i] < 0)
            continue;
        const imki_array *array = &state->rows.list.array[state->rows.column[i].array];
        const imki_strip *strip = &state->strip[state->cell_strip[i]];
        state->rows.cell[i] = (imki_array_cell){.type = array->type,
                                                .swapped = array->swapped,
                                                .at = strip->buffer + state->cell_offset[i],
                                                .step = strip->record};
    }
    state->rows.load = load;
    return imki_array_rows_begin(reader, error);
}

imk_status imki_array_strips_seek(imk_log_reader *reader, double fraction, imk_error *error)
{
    const imki_array_strips *state = reader->state;
    if (state->packed)
        return imk_error_set(error, IMK_ERROR_UNSUPPORTED, "",
                             "compressed arrays are read from their beginning", "");
    return imki_array_rows_seek(reader, fraction, error);
}

void imki_array_strips_close(imk_log_reader *reader)
{
    imki_array_strips *state = reader->state;
    if (!state)
        return;
    for (size_t i = 0; i < state->strip_count; i++) {
        imki_packed_close(&state->strip[i].part);
        free(state->strip[i].buffer);
    }
    for (size_t i = 0; i < state->source_count; i++)
        free(state->source_name[i]);
    free(state->source_name);
    free(state->source);
    if (state->unpacked >= 0)
        close(state->unpacked);
    imki_array_list_free(&state->rows.list);
}
