/* SPDX-License-Identifier: Apache-2.0 */
/* libFuzzer entry: any bytes as a log, read in pieces whose length the bytes choose.
 * Reads: src/io/log/log_reader.c src/io/log/log_format.c src/io/log/log_columns.c
 * src/io/log/log_names.c src/io/log/log_map.c src/io/log/log_missing.c src/io/log/log_stamps.c
 * src/io/log/log_decode.c src/io/log/log_rate.c src/io/log/log_text.c
 * src/io/log/csv/log_csv.c src/io/log/csv/log_csv_header.c src/io/log/csv/log_csv_look.c
 * src/io/log/csv/log_csv_rows.c src/io/log/csv/log_csv_sensors.c src/io/log/csv/log_dialects.c
 * src/io/log/csv/log_row.c src/io/log/csv/log_cells.c src/io/log/csv/log_cells_avx2.c */
#include "harness.h"

#include "imukit/log.h"

enum { ROWS_MAX = 64 };

static imk_log_settings settings_of(uint32_t choice)
{
    imk_log_settings settings = imk_log_default();
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
    const uint32_t other = choice * UINT32_C(2654435761) >> 28;
    if (other == 0)
        settings.map = "gyro_x=wx,time=t [ms]";
    if (other == 1)
        settings.topic = "imu0";
    if (other == 2 || other == 3)
        settings.format = other == 2 ? "psins" : "kitti";
    return settings;
}

static void read_all(imk_log_reader *reader, size_t piece)
{
    static double values[IMK_LOG_COLUMNS_MAX][ROWS_MAX];
    double *columns[IMK_LOG_COLUMNS_MAX];
    imk_error error = {.status = IMK_OK};
    imk_status status;
    for (size_t i = 0; i < IMK_LOG_COLUMNS_MAX; i++)
        columns[i] = i % 3 == 2 ? NULL : values[i];
    size_t rows = 0, total = 0;
    while ((status = imk_log_read(reader, piece, columns, &rows, &error)) == IMK_OK && rows > 0)
        total += rows;
    require_told(status, &error);
    const imk_log_findings found = imk_log_findings_get(reader);
    require(found.rows == total && found.not_finite <= total && found.gaps <= total);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const uint32_t choice = choice_of(data, size);
    const imk_log_settings settings = settings_of(choice);
    imk_log_reader *reader = NULL;
    imk_error error = {.status = IMK_OK};
    const imk_status status =
        imk_log_open_memory((const char *)data, size, &settings, &reader, &error);
    require_told(status, &error);
    if (status == IMK_OK)
        read_all(reader, 1 + choice / 64 % ROWS_MAX);
    imk_log_close(reader);
    return 0;
}
