/* SPDX-License-Identifier: Apache-2.0 */
/* Motion from a table: which kind it is, and its times. */
#include "motion_file_internal.h"

#include <stdlib.h>

/* Times of the rows, from 0; by the rate where there is no column. */
static imk_status read_times(const imk_log *log, double rate, double **times, imk_error *error)
{
    const int column = imk_log_find(log, IMK_QUANTITY_TIME, -1);
    double *time = malloc((log->rows + 1) * sizeof *time);
    if (!time)
        return imk_error_set(error, IMK_ERROR_MEMORY, "", "", "");
    imk_status status = IMK_OK;
    if (column >= 0)
        status = imki_table_column_check(log, (size_t)column, "s", error);
    for (size_t i = 0; status == IMK_OK && i < log->rows; i++) {
        time[i] = column >= 0 ? log->data[column][i] - log->data[column][0] : (double)i / rate;
        if (i > 0 && !(time[i] > time[i - 1])) {
            status =
                imki_table_row_error("time", IMK_ERROR_TIME_ORDER, i + 1,
                                     "this time is not later than that of the row before",
                                     "remove one of the two rows, or sort the rows by time", error);
        }
    }
    if (status == IMK_OK)
        *times = time;
    else
        free(time);
    return status;
}

static bool has_sensors(const imk_log *log)
{
    for (size_t i = 0; i < log->column_count; i++)
        if (log->column[i].quantity == IMK_QUANTITY_ANGULAR_RATE ||
            log->column[i].quantity == IMK_QUANTITY_SPECIFIC_FORCE)
            return true;
    return false;
}

static imk_status open_poses(const imk_log *log, double rate, const imk_geodetic *place,
                             imk_motion_file *file, imk_error *error)
{
    double *time = NULL;
    imk_status status = read_times(log, rate, &time, error);
    if (status == IMK_OK)
        status = imki_poses_open(log, time, place, file, error);
    if (status == IMK_OK)
        file->duration = time[log->rows - 1];
    free(time);
    return status;
}

imk_status imki_motion_table_take(double rate, const imk_geodetic *place, imk_motion_file *file,
                                  imk_error *error)
{
    const bool poses = imki_has_poses(&file->log), sensors = has_sensors(&file->log);
    if (poses && sensors)
        return imk_error_set(error, IMK_ERROR_CONFLICT, "",
                             "the table has both poses, and rates or forces",
                             "remove the columns of one of the two");
    if (!poses && !sensors)
        return imk_error_set(
            error, IMK_ERROR_COLUMN, "", "no column of a motion has a known name",
            "one of latitude, longitude, height, x, y, z, roll, pitch, yaw, q_w … q_z, "
            "or "
            "gyro_x … accel_z");
    if (file->log.rows < 2)
        return imk_error_set(error, IMK_ERROR_TOO_SHORT, "", "a single row is not a motion",
                             "two rows or more");
    if (sensors)
        return imki_recorded_open(&file->log, rate, file, error);
    const imk_status status = open_poses(&file->log, rate, place, file, error);
    imk_log_free(&file->log);
    return status;
}
