/* SPDX-License-Identifier: Apache-2.0 */
/* What the fuzz entry points have in common.
 *
 * The files of input_file_put() are descriptors of fixed numbers, to which links of the right names
 * lead (made by CMake in FUZZ_FILES): nothing is written to a disk, nothing is left behind, and
 * processes side by side do not see each other's. */
#ifdef __linux__
#define _GNU_SOURCE
#else
#define _POSIX_C_SOURCE 200809L
#endif
#include "harness.h"

#include "imukit/io.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/types.h>
#include <unistd.h>

void require_told(imk_status status, const imk_error *error)
{
    char text[1024];
    require(status == error->status);
    if (status == IMK_OK)
        return;
    const size_t length = imk_error_text(error, "input", text, sizeof text);
    require(length > 0 && length < sizeof text && strlen(text) == length);
}

void read_log(const char *path, const imk_log_settings *settings, size_t piece)
{
    enum { ROWS = 64, ROWS_MOST = 1 << 16 /* a bomb is not read to its end */ };
    static double values[IMK_LOG_COLUMNS_MAX][ROWS];
    double *columns[IMK_LOG_COLUMNS_MAX];
    size_t rows = 0, total = 0;
    imk_log_reader *reader = NULL;
    imk_error error = {.status = IMK_OK};
    imk_status status = imk_log_open(path, settings, &reader, &error);
    require_told(status, &error);
    for (size_t i = 0; i < IMK_LOG_COLUMNS_MAX; i++)
        columns[i] = i % 3 == 2 ? NULL : values[i];
    while (status == IMK_OK && total < ROWS_MOST) {
        status = imk_log_read(reader, 1 + piece % ROWS, columns, &rows, &error);
        require_told(status, &error);
        if (status != IMK_OK || rows == 0)
            break;
        total += rows;
        require(imk_log_findings_get(reader).rows == total);
    }
    imk_log_close(reader);
}

uint32_t choice_of(const uint8_t *data, size_t size)
{
    uint32_t choice = 0;
    for (size_t i = 0; i < size; i++)
        choice += data[i];
    return choice;
}

/* As cmake/fuzz.cmake has it. */
enum { FIRST_DESCRIPTOR = 100 };

static const char *const paths[INPUT_FILES] = {
    [INPUT_TABLE] = FUZZ_FILES "/table",
    [INPUT_SCRIPT] = FUZZ_FILES "/script.yaml",
    [INPUT_MATRIX] = FUZZ_FILES "/matrix.npy",
    [INPUT_MATRIX_NAMES] = FUZZ_FILES "/matrix.npy.columns",
    [INPUT_CAMPAIGN_PART] = FUZZ_FILES "/campaign.h5.part",
};

static void make_file(int descriptor)
{
#ifdef __linux__
    const int made = memfd_create("input", 0);
#else
    FILE *file = tmpfile();
    const int made = file ? fileno(file) : -1;
#endif
    require(made >= 0 && dup2(made, descriptor) == descriptor);
}

const char *input_file_put(input_file file, const uint8_t *data, size_t size)
{
    const int descriptor = FIRST_DESCRIPTOR + (int)file;
    if (lseek(descriptor, 0, SEEK_SET) != 0)
        make_file(descriptor);
    require(ftruncate(descriptor, 0) == 0);
    require(pwrite(descriptor, data, size, 0) == (ssize_t)size);
    return paths[file];
}
