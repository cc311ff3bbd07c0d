/* SPDX-License-Identifier: Apache-2.0 */
/* Rows of a log as messages sensor_msgs/Imu on the topic /imu: what the writers of bags share. */
#ifndef IMUKIT_LOG_ROS_WRITE_INTERNAL_H
#define IMUKIT_LOG_ROS_WRITE_INTERNAL_H

#include "io/log/log_formats_internal.h"
#include "log_ros_imu_internal.h"

#define IMKI_ROS_TOPIC "/imu"

enum {
    IMKI_ROS_CHUNK_WRITTEN = 768 * 1024
}; /* bytes of a chunk before it is closed, as rosbag's */

/* Where the cells of a row go. The state of each writer begins with it. */
typedef struct imki_ros_writer {
    size_t cells;
    int time, column[2][3]; /* cell of the time; of gyro and accel */
    bool has[2];
    uint64_t rows;        /* written */
    int64_t first, last;  /* smallest and largest stamp [ns] */
    uint64_t refused_row; /* whose time is no stamp; 0: none */
    double refused_time;
} imki_ros_writer;

/* Refuse columns that a message does not hold, and what lacks its time; rows are then those of
 * imki_log_format_matrix(), in SI. @return IMK_ERROR_COLUMN */
imk_status imki_ros_writer_start(imki_ros_writer *writer, imki_log_output *log, const char *path,
                                 imk_error *error);
/* The next row. @return false: its time is no stamp, which imki_ros_writer_check() tells */
bool imki_ros_writer_take(imki_ros_writer *writer, int64_t origin, const char *row, imki_imu *imu);
/* @return IMK_ERROR_RANGE if a row was refused */
imk_status imki_ros_writer_check(const imki_ros_writer *writer, imk_error *error);

/* Bytes that are gathered; zero-initialised. Free with free(bytes). */
typedef struct imki_ros_gathered {
    uint8_t *bytes;
    size_t size, room;
    bool failed; /* out of memory */
} imki_ros_gathered;

/* Room for `size` more. @return where they begin; NULL: out of memory, now or before */
uint8_t *imki_ros_gather(imki_ros_gathered *gathered, size_t size);
void imki_ros_gather_bytes(imki_ros_gathered *gathered, const void *bytes, size_t size);

#endif
