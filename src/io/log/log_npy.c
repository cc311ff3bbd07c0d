/* SPDX-License-Identifier: Apache-2.0 */
/* Logs as .npy matrices: the head (npy.c), and the number of rows in it. */
#include "io/file/output_file_internal.h"
#include "log_matrix_internal.h"
#include "log_reader_internal.h"
#include "npy_internal.h"

#include <stdio.h>

static imk_status open_npy(imk_log_reader *reader, imk_error *error)
{
    imki_log_text *text = &reader->text;
    imki_npy npy;
    imk_status status = imki_log_text_need(text, IMKI_NPY_PREFIX, error);
    const bool whole = status == IMK_OK && text->end - text->next >= IMKI_NPY_PREFIX;
    const size_t header_size = whole ? imki_npy_header_size(text->next) : 0;
    if (status == IMK_OK && (header_size == 0 || header_size > IMKI_LINE_MAX))
        status =
            imk_error_set(error, IMK_ERROR_FORMAT, "", "the header of the .npy file is damaged",
                          "a file that numpy.save() wrote");
    if (status == IMK_OK)
        status = imki_log_text_need(text, header_size, error);
    if (status == IMK_OK)
        status = imki_npy_header_read(text->next, (size_t)(text->end - text->next), &npy, error);
    if (status != IMK_OK)
        return status;
    if (npy.columns == 0 || npy.columns > IMK_LOG_COLUMNS_MAX) {
        char found[96];
        snprintf(found, sizeof found, "the matrix has %llu columns",
                 (unsigned long long)npy.columns);
        return imk_error_set(error, IMK_ERROR_COLUMN, "", found, "1 to 64 columns");
    }
    text->next += npy.header_size;
    return imki_log_matrix_open(reader, npy.columns, npy.rows, npy.value_size, error);
}

static imk_status create(imki_log_output *log, const char *path, imk_error *error)
{
    if (log->announced == 0 && !imki_output_file_can_replace(log->file))
        return imk_error_set(error, IMK_ERROR_UNSUPPORTED, path,
                             "a .npy of unknown length cannot be compressed or go to a pipe",
                             "write a plain .npy file, or a .csv");
    return imki_log_matrix_create(log, path, error);
}

static void begin(imki_log_output *log)
{
    char header[IMKI_NPY_HEADER_SIZE];
    imki_npy_header_write(log->announced, log->rows.column_count, header);
    imk_output_file_write(log->file, header, sizeof header);
}

/* The number of rows into the header. */
static imk_status end(imki_log_output *log, imk_error *error)
{
    if (log->written == log->announced)
        return IMK_OK;
    if (!imki_output_file_can_replace(log->file)) {
        char found[96];
        snprintf(found, sizeof found, "%llu rows are written, but %llu were announced",
                 (unsigned long long)log->written, (unsigned long long)log->announced);
        return imk_error_set(error, IMK_ERROR_CONFLICT, "row_count", found, "");
    }
    char header[IMKI_NPY_HEADER_SIZE];
    imki_npy_header_write(log->written, log->rows.column_count, header);
    imki_output_file_replace(log->file, 0, header, sizeof header);
    return IMK_OK;
}

const imki_log_codec imki_log_npy = {.open = open_npy,
                                     .read = imki_log_matrix_read,
                                     .seek = imki_log_matrix_seek,
                                     .create = create,
                                     .begin = begin,
                                     .format = imki_log_format_matrix,
                                     .end = end};
