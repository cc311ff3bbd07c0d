/* SPDX-License-Identifier: Apache-2.0 */
/* Logs as HDF5 files [HDF5], and MAT-files of version 7.3, which are HDF5 files with a head of
 * MATLAB in front. They are read by libhdf5 in a child (child_process.c): it is known to crash on
 * damaged files. The child is asked for the next block while the last one is used. */
#include "array_rows_internal.h"
#include "child_messages_internal.h"
#include "child_process_internal.h"
#include "column_store_internal.h"
#include "hdf5_reader_internal.h"
#include "hdf5_write_internal.h"

#include <stdlib.h>
#include <string.h>

enum { BLOCK_ROWS = 8192, VALUE = 8 };

typedef struct hdf5_state {
    imki_array_rows rows; /* first */
    imki_child child;
    imki_rows_request asked; /* count 0: nothing is under way */
    size_t columns;          /* that are asked for */
    unsigned char *values;
} hdf5_state;

/* A block of the user's own may stand before the file, of 512 bytes, 1024 and so on [HDF5]. */
static bool recognise(const char *begin, size_t size)
{
    static const char text[] = "MATLAB 7.3 MAT-file", own[] = "\x89HDF\r\n\x1a\n";
    bool found = size >= sizeof text && memcmp(begin, text, sizeof text - 1) == 0;
    for (size_t at = 512; at + sizeof own - 1 <= size && !found; at *= 2)
        found = memcmp(begin + at, own, sizeof own - 1) == 0;
    return found;
}

static imk_status refuse(hdf5_state *state, imk_error *error)
{
    return imki_child_refuse(&state->child, "HDF5", error);
}

/* Ask for a block. @return false: the child is gone */
static bool ask(hdf5_state *state, uint64_t first)
{
    const uint64_t left = state->rows.rows - first;
    memset(&state->asked, 0, sizeof state->asked);
    state->asked.first = first;
    state->asked.count = (uint32_t)(left < BLOCK_ROWS ? left : BLOCK_ROWS);
    return state->asked.count == 0 ||
           imki_socket_send(state->child.socket, &state->asked, sizeof state->asked);
}

/* @return as imki_child_rows() */
static bool receive(hdf5_state *state, imk_status *status, imk_error *error)
{
    return imki_child_rows(state->child.socket, state->values,
                           state->asked.count * state->columns * VALUE, status, error);
}

/* As imki_array_rows.load. */
static imk_status load(imk_log_reader *reader, imk_error *error)
{
    hdf5_state *state = reader->state;
    const uint64_t first = state->rows.begin;
    imk_status status = IMK_OK;
    /* What was asked for before a seek comes first. */
    bool good =
        state->asked.count == 0 || state->asked.first == first || receive(state, &status, error);
    if (good && status == IMK_OK && (state->asked.count == 0 || state->asked.first != first))
        good = ask(state, first);
    if (good && status == IMK_OK)
        good = receive(state, &status, error);
    if (!good || status != IMK_OK)
        return good ? status : refuse(state, error);
    const uint32_t count = state->asked.count;
    for (size_t i = 0, column = 0; i < reader->layout.cell_count; i++)
        if (reader->layout.cell_column[i] >= 0)
            state->rows.cell[i].at = state->values + column++ * count * VALUE;
    state->rows.at_hand = count;
    return ask(state, first + count) ? IMK_OK : refuse(state, error);
}

/* Tell the child which columns. @return false: it is gone */
static bool send_columns(imk_log_reader *reader)
{
    hdf5_state *state = reader->state;
    const int socket = state->child.socket;
    const uint32_t count = (uint32_t)state->columns;
    const uint64_t rows = state->rows.rows;
    bool sent = imki_socket_send(socket, &count, sizeof count) &&
                imki_socket_send(socket, &rows, sizeof rows);
    for (size_t i = 0; i < reader->layout.cell_count && sent; i++) {
        const imki_array_column *column = &state->rows.column[i];
        const uint32_t which[2] = {(uint32_t)column->array, (uint32_t)column->part};
        if (reader->layout.cell_column[i] >= 0)
            sent = imki_socket_send(socket, which, sizeof which);
    }
    return sent;
}

static imk_status begin_rows(imk_log_reader *reader, imk_error *error)
{
    hdf5_state *state = reader->state;
    for (size_t i = 0; i < reader->layout.cell_count; i++) {
        const imki_array *array = &state->rows.list.array[state->rows.column[i].array];
        state->columns += reader->layout.cell_column[i] >= 0;
        state->rows.cell[i] = (imki_array_cell){
            .type = array->type, .coding = array->coded ? &array->coding : NULL, .step = VALUE};
    }
    state->values = malloc(state->columns * BLOCK_ROWS * VALUE);
    if (!state->values)
        return imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
    state->rows.load = load;
    return send_columns(reader) ? imki_array_rows_begin(reader, error) : refuse(state, error);
}

static imk_status open_hdf5(imk_log_reader *reader, imk_error *error)
{
    hdf5_state *state = calloc(1, sizeof *state);
    if (!state)
        return imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
    reader->state = state;
    state->child.socket = -1;
    state->rows.list.separator = '/';
    imk_status status = imki_child_start(imki_hdf5_serve, imki_input_file(reader->text.input),
                                         &state->child, error);
    if (status != IMK_OK)
        return status;
    if (!imki_child_list(state->child.socket, &state->rows.list, &status, error))
        return refuse(state, error);
    if (status == IMK_OK)
        status = imki_arrays_choose(reader, &state->rows.list, state->rows.column,
                                    &state->rows.rows, error);
    return status == IMK_OK ? begin_rows(reader, error) : status;
}

static void close_hdf5(imk_log_reader *reader)
{
    hdf5_state *state = reader->state;
    if (!state)
        return;
    imki_child_end(&state->child);
    free(state->values);
    imki_array_list_free(&state->rows.list);
}

const imki_log_codec imki_log_hdf5 = {.recognise = recognise,
                                      .needs_file = true,
                                      .open = open_hdf5,
                                      .read = imki_array_rows_read,
                                      .close = close_hdf5,
                                      .seek = imki_array_rows_seek,
                                      .progress = imki_array_rows_progress,
                                      .create = imki_column_store_create,
                                      .format = imki_log_format_matrix,
                                      .write = imki_column_store_write,
                                      .end = imki_hdf5_end,
                                      .discard = imki_column_store_discard};
