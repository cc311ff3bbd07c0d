/* SPDX-License-Identifier: Apache-2.0 */
/* sensor_msgs/Imu as bytes, in the serialisations of ROS 1 and ROS 2. */
#ifndef IMUKIT_LOG_ROS_IMU_INTERNAL_H
#define IMUKIT_LOG_ROS_IMU_INTERNAL_H

#include "ros_bytes_internal.h"

#include <stdbool.h>
#include <stddef.h>

typedef enum imki_ros_encoding {
    IMKI_ROS_OTHER = 0, /* not read */
    IMKI_ROS_1,         /* sensor_msgs/Imu of ROS 1 */
    IMKI_ROS_CDR        /* sensor_msgs/msg/Imu of ROS 2 */
} imki_ros_encoding;

/* What is read of a message. */
typedef struct imki_imu {
    int64_t stamp;        /* header.stamp [ns] */
    const uint8_t *frame; /* header.frame_id, in the message */
    size_t frame_size;
    bool has[2];        /* angular rate, specific force: the first covariance is not -1 */
    double value[2][3]; /* [rad/s], [m/s^2] */
} imki_imu;

/* Read a message. @return whether it is one, as a whole */
bool imki_ros_imu_read(imki_ros_encoding encoding, const uint8_t *data, size_t size, imki_imu *imu);
/* Is it as long as the texts in it say? */
bool imki_ros_imu_fits(imki_ros_encoding encoding, const uint8_t *data, size_t size);

/* The number of the kind of CDR that a message is in, if it is one that is not read; else 0. */
int imki_ros_imu_representation(const uint8_t *data, size_t size);

enum { IMKI_ROS_IMU_MAX = 336 }; /* bytes of a message that is written */

/* Write a message without orientation, in the frame "imu", little-endian. What it does not have is
 * 0 with the covariance -1. @param sequence  of ROS 1 @return its size, the same for all */
size_t imki_ros_imu_write(imki_ros_encoding encoding, const imki_imu *imu, uint32_t sequence,
                          uint8_t data[IMKI_ROS_IMU_MAX]);

/* The fields of the message and of those within it, as ROS 1 and ROS 2 describe them. */
extern const char imki_ros1_imu_definition[], imki_ros2_imu_definition[];
/* Digest by which ROS 1 knows the definition. */
extern const char imki_ros1_imu_digest[];

#endif
