/* SPDX-License-Identifier: Apache-2.0 */
/* Conventions of programs that their files do not state, from the programs' own documents and
 * sources. Where a program lets its user choose the unit, none stands here. */
#include "log_dialects_internal.h"

#include "base/text_internal.h"

#include <stdbool.h>
#include <string.h>

static const imki_log_dialect dialects[] = {
    /* `rostopic echo -p`: fields of sensor_msgs/Imu in SI [SENSORMSGS], times in nanoseconds; the
     * first column is when the message was received [ROSTOPIC]. */
    {"rostopic echo -p",
     NULL,
     {"time", "field.header.stamp", "field.angular_velocity.x"},
     {{"time", "-"},
      {"field.header.stamp", "time [ns]"},
      {"field.angular_velocity.x", "gyro_x [rad/s]"},
      {"field.angular_velocity.y", "gyro_y [rad/s]"},
      {"field.angular_velocity.z", "gyro_z [rad/s]"},
      {"field.linear_acceleration.x", "accel_x [m/s^2]"},
      {"field.linear_acceleration.y", "accel_y [m/s^2]"},
      {"field.linear_acceleration.z", "accel_z [m/s^2]"}},
     NULL},
    /* Topic sensor_combined of PX4, as ulog2csv writes it: times in microseconds [ULOG]. */
    {"PX4 sensor_combined",
     NULL,
     {"timestamp", "gyro_rad[0]", "accelerometer_m_s2[0]"},
     {{"timestamp", "time [us]"},
      {"gyro_rad[0]", "gyro_x [rad/s]"},
      {"gyro_rad[1]", "gyro_y [rad/s]"},
      {"gyro_rad[2]", "gyro_z [rad/s]"},
      {"accelerometer_m_s2[0]", "accel_x [m/s^2]"},
      {"accelerometer_m_s2[1]", "accel_y [m/s^2]"},
      {"accelerometer_m_s2[2]", "accel_z [m/s^2]"}},
     NULL},
    /* Files of OXTS units in the KITTI data set, one row of 30 numbers a frame, put together; x
     * forward, y left, z up. Their times are in a file of their own [KITTI]. */
    {"KITTI oxts",
     "kitti",
     {NULL},
     {{NULL, NULL}},
     "-,-,-,-,-,-,-,-,-,-,-,accel_x [m/s^2],accel_y [m/s^2],accel_z [m/s^2],-,-,-,gyro_x [rad/s],"
     "gyro_y [rad/s],gyro_z [rad/s],-,-,-,-,-,-,-,-,-,-"},
    /* Matrices `imu` of PSINS as text: increments over the step before each time; x right, y
     * forward, z up [PSINS]. */
    {"PSINS imu",
     "psins",
     {NULL},
     {{NULL, NULL}},
     "dtheta_x [rad],dtheta_y [rad],dtheta_z [rad],dvel_x [m/s],dvel_y [m/s],dvel_z [m/s],"
     "time [s]"},
};

enum { DIALECTS = sizeof dialects / sizeof dialects[0], HAS = 3 };

const imki_log_dialect *imki_log_dialect_get(size_t index)
{
    return index < DIALECTS ? &dialects[index] : NULL;
}

static bool has_name(size_t count, const char *const *names, const char *name)
{
    for (size_t i = 0; i < count; i++)
        if (strcmp(names[i], name) == 0)
            return true;
    return false;
}

const imki_log_dialect *imki_log_dialect_of(size_t count, const char *const *names)
{
    for (size_t d = 0; d < DIALECTS; d++) {
        bool all = dialects[d].has[0] != NULL;
        for (size_t k = 0; k < HAS && dialects[d].has[k]; k++)
            all = all && has_name(count, names, dialects[d].has[k]);
        if (all)
            return &dialects[d];
    }
    return NULL;
}

const imki_log_dialect *imki_log_dialect_named(const char *format)
{
    for (size_t d = 0; d < DIALECTS; d++)
        if (dialects[d].format && strcmp(dialects[d].format, format) == 0)
            return &dialects[d];
    return NULL;
}
