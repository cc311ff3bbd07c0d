/* SPDX-License-Identifier: Apache-2.0 */
/* What must hold of any bytes that are taken for a flight log. */
#ifndef IMUKIT_FUZZ_FLIGHT_CHECKS_H
#define IMUKIT_FUZZ_FLIGHT_CHECKS_H

#include "harness.h"

#include "imukit/log.h"

#include <string.h>

enum { FLIGHT_ROWS = 64, FLIGHT_KEPT = 512 };

/* Read on to the end. @param kept  receives the first values of the second column */
static inline size_t read_all(imk_log_reader *reader, size_t piece, double *kept)
{
    static double values[IMK_LOG_COLUMNS_MAX][FLIGHT_ROWS];
    double *columns[IMK_LOG_COLUMNS_MAX];
    size_t rows = 0, total = 0;
    imk_error error = {.status = IMK_OK};
    for (size_t i = 0; i < IMK_LOG_COLUMNS_MAX; i++)
        columns[i] = values[i];
    imk_status status;
    while ((status = imk_log_read(reader, piece, columns, &rows, &error)) == IMK_OK && rows > 0)
        for (size_t row = 0; row < rows; row++, total++)
            if (total < FLIGHT_KEPT)
                kept[total] = values[1][row];
    require_told(status, &error);
    /* IMK_ERROR_COLUMN: from here on the messages have other fields. */
    require(status == IMK_OK || status == IMK_ERROR_COLUMN);
    require(imk_log_findings_get(reader).rows == total);
    return total;
}

/* The same rows whatever the pieces are; and from another place, which rows it may be. */
static inline void check_rows(imk_log_reader *reader, uint32_t choice)
{
    static double first[FLIGHT_KEPT], second[FLIGHT_KEPT];
    imk_error error = {.status = IMK_OK};
    const size_t rows = read_all(reader, FLIGHT_ROWS, first);
    const imk_log_findings found = imk_log_findings_get(reader);
    require(imk_log_seek(reader, 0, &error) == IMK_OK);
    require(read_all(reader, 1 + choice % 31, second) == rows);
    require(memcmp(first, second, (rows < FLIGHT_KEPT ? rows : FLIGHT_KEPT) * sizeof *first) == 0);
    const imk_log_findings again = imk_log_findings_get(reader);
    require(again.damaged == found.damaged && again.cut_short == found.cut_short &&
            again.not_finite == found.not_finite);
    const imk_status status = imk_log_seek(reader, choice % 97 / 96.0, &error);
    require_told(status, &error);
    require(status == IMK_OK || status == IMK_ERROR_UNSUPPORTED);
    if (status == IMK_OK)
        (void)read_all(reader, FLIGHT_ROWS, second);
}

static inline void check_flight_log(const uint8_t *data, size_t size, const char *format,
                                    size_t count, const char *const *topics)
{
    const uint32_t choice = choice_of(data, size);
    imk_log_settings settings = imk_log_default();
    imk_error error = {.status = IMK_OK};
    imk_log_reader *reader;
    settings.format = format;
    settings.topic = topics[choice % count];
    settings.instance = choice / 16 % 4 == 0 ? (int)(choice / 64 % 3) : 0;
    imk_status status = imk_log_open_memory((const char *)data, size, &settings, &reader, &error);
    require_told(status, &error);
    if (status == IMK_ERROR_NAME_UNKNOWN) { /* what the bytes hold, rather than what was asked */
        error = (imk_error){.status = IMK_OK};
        settings.topic = NULL;
        settings.instance = 0;
        status = imk_log_open_memory((const char *)data, size, &settings, &reader, &error);
        require_told(status, &error);
    }
    if (status != IMK_OK)
        return;
    require(imk_log_column_count(reader) >= 4 && imk_log_stream_get(reader)->readable);
    check_rows(reader, choice);
    imk_log_close(reader);
}

#endif
