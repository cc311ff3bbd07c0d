/* SPDX-License-Identifier: Apache-2.0 */
/* libFuzzer entry: any bytes as a log, read in pieces whose length the bytes choose. */
#include "imukit/log.h"

#include <stdlib.h>
#include <string.h>

enum { ROWS_MAX = 64 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static imk_log_settings settings_of(uint32_t choice)
{
    imk_log_settings settings = imk_log_settings_default();
    if (choice & 1)
        settings.rate = 100.0;
    if (choice & 2)
        settings.gyro_unit = "deg/s";
    if (choice & 4)
        settings.accel_unit = "g";
    if (choice & 8)
        settings.time_unit = "us";
    if (choice & 16)
        settings.axes = "right-forward-up";
    if (choice & 32)
        settings.columns = "time,gyro_x,-";
    return settings;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    /* The sum of the bytes chooses, so that a log as it is can be an input. */
    uint32_t choice = 0;
    for (size_t i = 0; i < size; i++)
        choice += data[i];
    const imk_log_settings settings = settings_of(choice);
    const size_t piece = 1 + choice / 64 % ROWS_MAX;
    imk_log_reader *reader;
    imk_error error;
    /* A copy of exact size lets the address sanitiser see every byte read outside. */
    char *text = malloc(size + (size == 0));
    if (!text)
        return 0;
    if (size > 0)
        memcpy(text, data, size);
    if (imk_log_open_memory(text, size, &settings, &reader, &error) == IMK_OK) {
        static double values[IMK_LOG_COLUMNS_MAX][ROWS_MAX];
        double *columns[IMK_LOG_COLUMNS_MAX];
        for (size_t i = 0; i < IMK_LOG_COLUMNS_MAX; i++)
            columns[i] = i % 3 == 2 ? NULL : values[i];
        size_t rows = 0, total = 0;
        while (imk_log_read(reader, piece, columns, &rows, &error) == IMK_OK && rows > 0)
            total += rows;
        const imk_log_findings found = imk_log_findings_get(reader);
        if (found.rows != total || found.not_finite > total || found.gaps > total)
            abort();
        imk_log_close(reader);
    }
    free(text);
    return 0;
}
