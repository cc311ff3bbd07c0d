/* SPDX-License-Identifier: Apache-2.0 */
/* Fuzz entry point of solution files of RTKLIB.
 * Reads: src/io/log/gnss/log_rtklib.c */
#include "harness.h"

#include "imukit/log.h"

enum { ROWS = 16 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static double values[IMK_LOG_COLUMNS_MAX][ROWS];
    double *columns[IMK_LOG_COLUMNS_MAX];
    size_t rows = 0, total = 0;
    imk_log_settings settings = imk_log_default();
    settings.any_columns = true;
    settings.format = "rtklib";
    for (size_t i = 0; i < IMK_LOG_COLUMNS_MAX; i++)
        columns[i] = values[i];
    imk_log_reader *reader = NULL;
    imk_error error = {.status = IMK_OK};
    imk_status status = imk_log_open_memory((const char *)data, size, &settings, &reader, &error);
    require_told(status, &error);
    if (status == IMK_OK) {
        while ((status = imk_log_read(reader, 1 + choice_of(data, size) % ROWS, columns, &rows,
                                      &error)) == IMK_OK &&
               rows > 0)
            total += rows;
        require_told(status, &error);
        require(imk_log_findings_get(reader).rows == total);
    }
    imk_log_close(reader);
    return 0;
}
