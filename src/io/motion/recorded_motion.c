/* SPDX-License-Identifier: Apache-2.0 */
/* Truth recorded by another program: rates and forces in equal steps. */
#include "motion_file_internal.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* Times are written with some digits only: a step may be off by this part of the interval. */
static const double step_tolerance = 0.01;

/* Rounding of the times to a microsecond, at 1 kHz. */
static const double rounding_tolerance = 1e-3;

/* The roundest rate, of up to three decimals, that puts the last row where it is up to the rounding
 * of the times: 99.99999998 Hz of rounded times is 100 Hz. */
static double round_rate(double rate, double steps, double length)
{
    for (double scale = 1.0; scale <= 1000.0; scale *= 10.0) {
        const double rounded = floor(rate * scale + 0.5) / scale;
        if (rounded > 0.0 && fabs(steps / rounded - length) <= rounding_tolerance / rounded)
            return rounded;
    }
    return rate;
}

/* @param stated  0: not */
static imk_status find_rate(const imk_log *log, double stated, double *rate, imk_error *error)
{
    const int column = imk_log_find(log, IMK_QUANTITY_TIME, -1);
    *rate = stated;
    if (column < 0)
        return IMK_OK;
    imk_status status = imki_table_column_check(log, (size_t)column, "s", error);
    if (status != IMK_OK)
        return status;
    const double *time = log->data[column];
    const double length = time[log->rows - 1] - time[0], steps = (double)(log->rows - 1);
    const double interval = stated > 0.0 ? 1.0 / stated : log->findings.interval;
    for (size_t i = 1; i < log->rows; i++) {
        const double step = time[i] - time[i - 1];
        if (!(fabs(step - interval) <= step_tolerance * interval)) {
            char found[96];
            snprintf(found, sizeof found, "the time since the row before is %.6g s, not %.6g s",
                     step, interval);
            return imki_table_row_error("time", IMK_ERROR_GAP, i + 1, found,
                                        "recorded rates and forces must have equal time steps; "
                                        "resample them, or give a table of poses",
                                        error);
        }
    }
    if (!(stated > 0.0))
        *rate = round_rate(steps / length, steps, length);
    return IMK_OK;
}

/* "angular_acceleration_x", in any case. */
static int find_acceleration(const imk_log *log, int axis)
{
    char name[32];
    snprintf(name, sizeof name, "angular_acceleration_%c", "xyz"[axis]);
    for (size_t i = 0; i < log->column_count; i++) {
        const char *p = log->column[i].name, *q = name;
        while (*p != '\0' && tolower((unsigned char)*p) == *q) {
            p++;
            q++;
        }
        if (*p == '\0' && *q == '\0')
            return (int)i;
    }
    return -1;
}

static imk_status take_triad(const imk_log *log, imk_quantity quantity, const char *name,
                             const char *si, const char *integral_si, const double *triad[3],
                             imk_error *error)
{
    for (int axis = 0; axis < 3; axis++) {
        const int column = imk_log_find(log, quantity, axis);
        if (column < 0) {
            char missing[32];
            snprintf(missing, sizeof missing, "%s_%c", name, "xyz"[axis]);
            return imk_error_set(
                error, IMK_ERROR_COLUMN, missing, "this column is missing",
                "recorded motion needs gyro_x, gyro_y, gyro_z, accel_x, accel_y and accel_z");
        }
        const bool increment = log->column[column].increment; /* divided by the interval since */
        const imk_status status =
            imki_table_column_check(log, (size_t)column, increment ? integral_si : si, error);
        if (status != IMK_OK)
            return status;
        triad[axis] = log->data[column];
    }
    return IMK_OK;
}

static imk_status take_acceleration(const imk_log *log, const double *triad[3], imk_error *error)
{
    int column[3], found = 0;
    for (int axis = 0; axis < 3; axis++) {
        column[axis] = find_acceleration(log, axis);
        found += column[axis] >= 0;
    }
    if (found == 0)
        return IMK_OK;
    if (found < 3)
        return imk_error_set(error, IMK_ERROR_COLUMN, "angular_acceleration",
                             "the column of one axis is missing", "give all three axes or none");
    for (int axis = 0; axis < 3; axis++) {
        const imk_status status =
            imki_table_column_check(log, (size_t)column[axis], "rad/s^2", error);
        if (status != IMK_OK)
            return status;
        triad[axis] = log->data[column[axis]];
    }
    return IMK_OK;
}

imk_status imki_recorded_open(imk_log *log, double rate, imk_motion_file *file, imk_error *error)
{
    imk_recorded_motion *recorded = &file->recorded;
    imk_status status = take_triad(log, IMK_QUANTITY_ANGULAR_RATE, "gyro", "rad/s", "rad",
                                   recorded->angular_rate, error);
    if (status == IMK_OK)
        status = take_triad(log, IMK_QUANTITY_SPECIFIC_FORCE, "accel", "m/s^2", "m/s",
                            recorded->specific_force, error);
    if (status == IMK_OK)
        status = take_acceleration(log, recorded->angular_acceleration, error);
    if (status == IMK_OK)
        status = find_rate(log, rate, &recorded->rate, error);
    if (status != IMK_OK)
        return status;
    recorded->count = log->rows;
    file->kind = IMK_MOTION_RECORDED;
    file->duration = (double)recorded->count / recorded->rate;
    file->motion.recorded = recorded;
    return IMK_OK;
}
