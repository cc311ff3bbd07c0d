/* SPDX-License-Identifier: Apache-2.0 */
/* What the writers of bags share: which columns a message holds, times as stamps. */
#include "log_ros_write_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const char *const triads[2] = {"gyro", "accel"};

/* Column -> place in the message: 0 time, 1 … 6 gyro and accel; -1: none. */
static int place_of(const imk_log_column *column)
{
    if (column->quantity == IMK_QUANTITY_TIME)
        return 0;
    if (column->increment || column->label || column->axis < 0 || column->axis > 2)
        return -1;
    return column->quantity == IMK_QUANTITY_ANGULAR_RATE     ? 1 + column->axis
           : column->quantity == IMK_QUANTITY_SPECIFIC_FORCE ? 4 + column->axis
                                                             : -1;
}

/* The command that leaves out what cannot be written; "" if nothing would remain. */
static void suggest(const imki_ros_writer *writer, const imki_log_output *log, const char *path,
                    size_t size, char *text)
{
    const bool any = writer->time >= 0 && (writer->has[0] || writer->has[1]);
    bool keep[IMK_LOG_COLUMNS_MAX];
    for (size_t i = 0; i < log->rows.column_count; i++) {
        const int place = place_of(&log->column[i]);
        keep[i] = any && (place == 0 || (place > 0 && writer->has[(place - 1) / 3]));
    }
    imki_log_select_text(log, path, keep, size, text);
}

static imk_status refuse(const imki_ros_writer *writer, const imki_log_output *log,
                         const char *path, const char *column, const char *found, imk_error *error)
{
    char expected[160];
    suggest(writer, log, path, sizeof expected, expected);
    return imk_error_set(error, IMK_ERROR_COLUMN, column, found,
                         expected[0] ? expected
                                     : "columns time, gyro_x to gyro_z and accel_x to accel_z");
}

imk_status imki_ros_writer_start(imki_ros_writer *writer, imki_log_output *log, const char *path,
                                 imk_error *error)
{
    int cell[7] = {-1, -1, -1, -1, -1, -1, -1};
    writer->cells = log->rows.column_count;
    for (size_t i = 0; i < writer->cells; i++) {
        const int place = place_of(&log->column[i]);
        if (place >= 0)
            cell[place] = (int)i;
        imki_column_format_set(&log->rows.column[i], 1.0, 0.0, 0); /* rows in SI */
    }
    writer->time = cell[0];
    for (int k = 0; k < 2; k++) {
        memcpy(writer->column[k], cell + 1 + 3 * k, sizeof writer->column[k]);
        writer->has[k] = cell[1 + 3 * k] >= 0 && cell[2 + 3 * k] >= 0 && cell[3 + 3 * k] >= 0;
    }
    if (writer->time < 0)
        return refuse(writer, log, path, "time",
                      "messages sensor_msgs/Imu have stamps, and there is no time column", error);
    for (size_t i = 0; i < writer->cells; i++) {
        const int place = place_of(&log->column[i]);
        char found[128];
        if (place < 0)
            return refuse(writer, log, path, log->column[i].name,
                          "messages sensor_msgs/Imu have no place for this column", error);
        if (place == 0 || writer->has[(place - 1) / 3])
            continue;
        snprintf(found, sizeof found,
                 "messages sensor_msgs/Imu hold three axes, and not all of %s_x, %s_y and %s_z "
                 "are there",
                 triads[(place - 1) / 3], triads[(place - 1) / 3], triads[(place - 1) / 3]);
        return refuse(writer, log, path, log->column[i].name, found, error);
    }
    if (!writer->has[0] && !writer->has[1])
        return refuse(writer, log, path, "gyro_x", "there are neither gyros nor accelerometers",
                      error);
    return IMK_OK;
}

bool imki_ros_writer_take(imki_ros_writer *writer, int64_t origin, const char *row, imki_imu *imu)
{
    const double most = 2147483647.0; /* the seconds of ROS 2 are 32 bits with a sign */
    const uint8_t *cells = (const uint8_t *)row;
    const double time = imki_get_f64(cells + 8 * writer->time);
    if (writer->refused_row > 0)
        return false;
    const double stamp = time + (double)origin * 1e-9;
    if (!(stamp >= 0.0 && stamp <= most)) {
        writer->refused_row = writer->rows + 1;
        writer->refused_time = stamp;
        return false;
    }
    *imu = (imki_imu){.stamp = origin + (int64_t)floor(time) * 1000000000 +
                               llround((time - floor(time)) * 1e9),
                      .has = {writer->has[0], writer->has[1]}};
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < 3 && writer->has[k]; i++)
            imu->value[k][i] = imki_get_f64(cells + 8 * writer->column[k][i]);
    if (writer->rows == 0 || imu->stamp < writer->first)
        writer->first = imu->stamp;
    if (writer->rows == 0 || imu->stamp > writer->last)
        writer->last = imu->stamp;
    writer->rows++;
    return true;
}

imk_status imki_ros_writer_check(const imki_ros_writer *writer, imk_error *error)
{
    char found[96];
    if (writer->refused_row == 0)
        return IMK_OK;
    snprintf(found, sizeof found, "the time of row %llu is %.9g s, and stamps count from 0",
             (unsigned long long)writer->refused_row, writer->refused_time);
    return imk_error_set(error, IMK_ERROR_RANGE, "time", found, "times from 0 s to 2147483647 s");
}

uint8_t *imki_ros_gather(imki_ros_gathered *gathered, size_t size)
{
    if (gathered->failed)
        return NULL;
    if (size > gathered->room - gathered->size) {
        const size_t room = 2 * gathered->size + size + 4096;
        uint8_t *larger = realloc(gathered->bytes, room);
        if (!larger) {
            gathered->failed = true;
            return NULL;
        }
        gathered->bytes = larger;
        gathered->room = room;
    }
    gathered->size += size;
    return gathered->bytes + gathered->size - size;
}

void imki_ros_gather_bytes(imki_ros_gathered *gathered, const void *bytes, size_t size)
{
    uint8_t *at = imki_ros_gather(gathered, size);
    if (at && size > 0)
        memcpy(at, bytes, size);
}
