/* SPDX-License-Identifier: Apache-2.0 */
/* A log that a verb has written as a matrix and the names of its columns, in SI units. */
#include "gateway.h"

#include "imukit/io.h"

#include <stdlib.h>
#include <string.h>

/* "gyro_x [rad/s]" */
static void column_text(const imk_log_column *column, char *text, size_t size)
{
    char unit[64];
    if (column->quantity == IMK_QUANTITY_OTHER ||
        imk_dimension_si(column->unit.dimension, unit, sizeof unit) == 0)
        snprintf(unit, sizeof unit, "%s", column->unit.text);
    snprintf(text, size, "%s%s%s%s", column->name, unit[0] ? " [" : "", unit, unit[0] ? "]" : "");
}

/* A reader divides increments by the time step of their row (the first by the next one); here they
 * are increments again. */
static void restore_increments(imk_log *log, size_t column)
{
    const int time = imk_log_find(log, IMK_QUANTITY_TIME, -1);
    const double *t = time >= 0 ? log->data[time] : NULL;
    for (size_t k = 0; t && log->rows > 1 && k < log->rows; k++)
        log->data[column][k] *= k > 0 ? t[k] - t[k - 1] : t[1] - t[0];
}

bool gateway_read_log(mxArray **columns, mxArray **data)
{
    imk_log_settings settings = imk_log_default();
    imk_log log;
    imk_error error = {.status = IMK_OK};
    char text[900], *path = gateway_file(GATEWAY_LOG);
    if (!path)
        return false;
    const imk_status status = imk_log_load(path, &settings, NULL, &log, &error);
    imk_error_text(&error, path, text, sizeof text);
    free(path);
    if (status != IMK_OK)
        return gateway_refuse("%s", text);
    *data = mxCreateDoubleMatrix(log.rows, log.column_count, mxREAL);
    *columns = mxCreateCellMatrix(log.column_count, 1);
    for (size_t c = 0; c < log.column_count; c++) {
        if (log.column[c].increment)
            restore_increments(&log, c);
        memcpy(mxGetPr(*data) + c * log.rows, log.data[c], log.rows * sizeof(double));
        column_text(&log.column[c], text, sizeof text);
        mxSetCell(*columns, c, mxCreateString(text));
    }
    imk_log_free(&log);
    return true;
}
