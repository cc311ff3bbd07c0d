/* SPDX-License-Identifier: Apache-2.0 */
/* Words of the two sensors, gyros first. */
#ifndef IMUKI_CALIBRATE_INTERNAL_H
#define IMUKI_CALIBRATE_INTERNAL_H

#include "imukit/calibrate_log.h"

static const char *const imki_sensor_keys[2] = {"gyro", "accel"};
static const char *const imki_sensor_titles[2] = {"gyro", "accelerometer"};
static const char *const imki_sensor_units[2] = {"rad/s", "m/s^2"};

#endif
