/* SPDX-License-Identifier: Apache-2.0 */
/* Fuzz entry point of binary records of a described layout: the first line is the description, the
 * bytes behind it are the records.
 * Reads: src/io/log/maker/log_described.c src/io/log/maker/description.c
 * src/io/log/maker/description_scale.c */
#include "harness.h"

#include "imukit/log.h"

#include <string.h>

enum { ROWS = 64 };

static void check_rows(imk_log_reader *reader, size_t piece)
{
    static double values[IMK_LOG_COLUMNS_MAX][ROWS];
    double *columns[IMK_LOG_COLUMNS_MAX];
    size_t rows = 0, total = 0;
    imk_error error = {.status = IMK_OK};
    imk_status status;
    for (size_t i = 0; i < IMK_LOG_COLUMNS_MAX; i++)
        columns[i] = values[i];
    while ((status = imk_log_read(reader, piece, columns, &rows, &error)) == IMK_OK && rows > 0)
        total += rows;
    require_told(status, &error);
    require(imk_log_findings_get(reader).rows == total);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char text[512];
    const uint8_t *end = size > 0 ? memchr(data, '\n', size) : NULL;
    const size_t length = end ? (size_t)(end - data) : 0;
    if (!end || length >= sizeof text)
        return 0;
    memcpy(text, data, length);
    text[length] = '\0';
    const uint32_t choice = choice_of(data, size);
    imk_log_settings settings = imk_log_default();
    settings.binary = text;
    settings.rate = choice % 2 == 0 ? 100.0 : 0.0;
    settings.gyro_unit = choice % 4 < 2 ? "count" : NULL;
    imk_log_reader *reader = NULL;
    imk_error error = {.status = IMK_OK};
    const imk_status status = imk_log_open_memory((const char *)data + length + 1,
                                                  size - length - 1, &settings, &reader, &error);
    require_told(status, &error);
    if (status == IMK_OK) {
        check_rows(reader, 1 + choice / 4 % ROWS);
        require(imk_log_seek(reader, choice % 101 / 100.0, NULL) == IMK_OK);
        check_rows(reader, ROWS);
    }
    imk_log_close(reader);
    return 0;
}
