/* SPDX-License-Identifier: Apache-2.0 */
/* What must hold for bags of any bytes: they are read or refused, from memory and from a file, from
 * the beginning and from another place; and what the streams say does not depend on which is read.
 */
#ifndef IMUKIT_FUZZ_BAGS_H
#define IMUKIT_FUZZ_BAGS_H

#include "harness.h"

#include "imukit/log.h"

#include <stdio.h>
#include <unistd.h>

static inline void bags_read(imk_log_reader *reader, size_t piece)
{
    enum { ROWS = 64 };
    static double values[8][ROWS];
    double *columns[8];
    size_t rows = 0, total = 0;
    imk_error error = {.status = IMK_OK};
    for (size_t i = 0; i < 8; i++)
        columns[i] = values[i];
    require(imk_log_column_count(reader) <= 7);
    imk_status status;
    while ((status = imk_log_read(reader, piece, columns, &rows, &error)) == IMK_OK && rows > 0)
        total += rows;
    require_told(status, &error);
    require(imk_log_findings_get(reader).rows == total);
}

static inline void bags_check(const uint8_t *data, size_t size, const char *format)
{
    const uint32_t choice = choice_of(data, size);
    imk_log_settings settings = imk_log_default();
    imk_log_reader *reader = NULL;
    imk_error error = {.status = IMK_OK};
    imk_log_stream stream[4];
    size_t count = 0;
    settings.format = format;
    settings.topic = choice % 8 == 0 ? "imu" : NULL;
    const char *path = input_file_put(INPUT_TABLE, data, size);
    imk_status status = imk_log_streams(path, &settings, 4, stream, &count, NULL, &error);
    require_told(status, &error);
    require(status != IMK_OK || count > 0);
    error = (imk_error){.status = IMK_OK};
    status = choice % 2 == 0
                 ? imk_log_open(path, &settings, &reader, &error)
                 : imk_log_open_memory((const char *)data, size, &settings, &reader, &error);
    require_told(status, &error);
    if (status != IMK_OK)
        return;
    bags_read(reader, 1 + choice / 4 % 64);
    if (choice % 3 == 0) {
        const imk_record_source source = imk_log_source(reader);
        require(source.rewind(source.context, NULL) == IMK_OK);
        bags_read(reader, 64);
    }
    error = (imk_error){.status = IMK_OK};
    status = imk_log_seek(reader, (double)(choice % 5) / 4.0, &error);
    require_told(status, &error);
    if (status == IMK_OK)
        bags_read(reader, 64);
    imk_log_close(reader);
}

/* From a pipe, in which nothing can be looked up. */
static inline void bags_check_pipe(const uint8_t *data, size_t size, const char *format)
{
    enum { HOLDS = 1 << 16 }; /* bytes that a pipe takes before they are read */
    imk_log_settings settings = imk_log_default();
    imk_log_reader *reader = NULL;
    imk_error error = {.status = IMK_OK};
    char path[32];
    int ends[2];
    settings.format = format;
    if (size > HOLDS || pipe(ends) != 0)
        return;
    require(write(ends[1], data, size) == (ssize_t)size);
    close(ends[1]);
    snprintf(path, sizeof path, "/dev/fd/%d", ends[0]);
    require_told(imk_log_open(path, &settings, &reader, &error), &error);
    if (reader)
        bags_read(reader, 64);
    imk_log_close(reader);
    close(ends[0]);
}

#endif
