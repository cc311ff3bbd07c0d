/* SPDX-License-Identifier: Apache-2.0 */
/* Fuzz entry point of .npy matrices. What stands before the magic number is the file of names
 * beside the matrix.
 * Reads: src/io/log/npy.c src/io/log/log_npy.c src/io/log/log_matrix.c */
#include "harness.h"

#include "imukit/log.h"
#include "io/log/npy_internal.h"

#include <stdlib.h>
#include <string.h>

enum { ROWS = 64 };

static size_t find_magic(const uint8_t *data, size_t size)
{
    for (size_t at = 0; at + 6 <= size; at++)
        if (memcmp(data + at, "\x93NUMPY", 6) == 0)
            return at;
    return size;
}

/* The header alone; what it says is written and read again. */
static void check_header(const char *matrix, size_t size)
{
    imki_npy npy, back;
    char header[IMKI_NPY_HEADER_SIZE];
    imk_error error = {.status = IMK_OK};
    const imk_status status = imki_npy_header_read(matrix, size, &npy, &error);
    require_told(status, &error);
    if (status != IMK_OK)
        return;
    require(npy.header_size <= size && (npy.value_size == 8 || npy.value_size == 4));
    imki_npy_header_write(npy.rows, npy.columns, header);
    require(imki_npy_header_read(header, sizeof header, &back, NULL) == IMK_OK);
    require(back.rows == npy.rows && back.columns == npy.columns && back.value_size == 8);
}

static void check_rows(imk_log_reader *reader, size_t piece)
{
    static double values[IMK_LOG_COLUMNS_MAX][ROWS];
    double *columns[IMK_LOG_COLUMNS_MAX];
    size_t rows = 0, total = 0;
    imk_error error = {.status = IMK_OK};
    for (size_t i = 0; i < IMK_LOG_COLUMNS_MAX; i++)
        columns[i] = values[i];
    imk_status status;
    while ((status = imk_log_read(reader, piece, columns, &rows, &error)) == IMK_OK && rows > 0)
        total += rows;
    require_told(status, &error);
    require(imk_log_findings_get(reader).rows == total);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const size_t names = find_magic(data, size);
    char *matrix = malloc(size - names + 1);
    if (!matrix)
        return 0;
    memcpy(matrix, data + names, size - names);
    check_header(matrix, size - names);
    const uint32_t choice = choice_of(data, size);
    imk_log_settings settings = imk_log_default();
    settings.rate = choice % 2 == 0 ? 100.0 : 0.0;
    settings.columns = choice % 4 < 2 ? NULL : "time,gyro_x [deg/s],-";
    input_file_put(INPUT_MATRIX_NAMES, data, names);
    const char *path = input_file_put(INPUT_MATRIX, (const uint8_t *)matrix, size - names);
    imk_log_reader *reader = NULL;
    imk_error error = {.status = IMK_OK};
    const imk_status status = imk_log_open(path, &settings, &reader, &error);
    require_told(status, &error);
    if (status == IMK_OK)
        check_rows(reader, 1 + choice / 4 % ROWS);
    imk_log_close(reader);
    free(matrix);
    return 0;
}
