/* SPDX-License-Identifier: Apache-2.0 */
/* Columns that resemble a sensor's and are not used are told; what is something else is not. */
#include "check.h"

#include "imukit/jobs.h"
#include "imukit/log.h"

#include <stdio.h>
#include <string.h>

enum { ROWS = 20 };

/* What an Allan deviation of gyro_x, gyro_z, accel_x and one more column tells of the last. */
static const imk_finding *told(const char *name, imk_allan_log **a)
{
    char text[4000];
    imk_log_reader *reader;
    imk_error error;
    int used = snprintf(text, sizeof text, "gyro_x [deg/s],gyro_z [deg/s],accel_x [g],%s\n", name);
    for (int i = 0; i < ROWS; i++)
        used += snprintf(text + used, sizeof text - (size_t)used, "%d,%d,%d,%d\n", i * i % 7,
                         i * i % 11, i * i % 13, i * i % 5);
    imk_log_settings reading = imk_log_default();
    reading.rate = 100;
    CHECK_OK(imk_log_open_memory(text, (size_t)used, &reading, &reader, &error));
    const imk_record_source source = imk_log_source(reader);
    const imk_allan_log_settings settings = imk_allan_log_default();
    CHECK_OK(imk_allan_log_run(&source, &settings, NULL, a, &error));
    imk_log_close(reader);
    for (size_t k = 0; k < (*a)->findings.count; k++)
        if (strncmp((*a)->findings.item[k].code, "unused", 6) == 0)
            return &(*a)->findings.item[k];
    return NULL;
}

static void test_a_missing_axis_is_a_warning(void **state)
{
    (void)state;
    static const char *const names[] = {"gryo_y",
                                        "gyo_y",
                                        "giro_y",
                                        "gyro y",
                                        "gyroy",
                                        "GyroY",
                                        "gyr_y",
                                        "-gyro_y",
                                        "+gyro_y [deg/s]",
                                        "gyro.y",
                                        "Gyro-Y",
                                        "ygyro",
                                        "wy [rad/s]",
                                        "gyro_raw_y",
                                        "gyro 1",
                                        "gyroscope_y",
                                        "imu0_gyro_y",
                                        "omega_y",
                                        "angular_velocity_y",
                                        "angularVelocity.y [rad/s]",
                                        "gyro_y_filtered"};
    for (size_t k = 0; k < sizeof names / sizeof names[0]; k++) {
        imk_allan_log *a;
        const imk_finding *f = told(names[k], &a);
        if (!f || f->level != IMK_FINDING_WARNING || strcmp(f->code, "unused_axis") != 0 ||
            !strstr(f->name, "\tgyro_y"))
            fail_msg("%s: %s, %s", names[k], f ? f->code : "nothing", f ? f->name : "");
        imk_allan_log_free(a);
    }
}

/* An axis that is there, too. */
static void test_others_are_notes(void **state)
{
    (void)state;
    static const char *const names[] = {"gryo_x", "-gyro_z", "gyro_x_raw", "xgyro", "ax", "wz"};
    for (size_t k = 0; k < sizeof names / sizeof names[0]; k++) {
        imk_allan_log *a;
        const imk_finding *f = told(names[k], &a);
        if (!f || f->level != IMK_FINDING_NOTE)
            fail_msg("%s: %s", names[k], f ? f->code : "nothing");
        imk_allan_log_free(a);
    }
}

static void test_what_is_something_else(void **state)
{
    (void)state;
    static const char *const names[] = {"time_y",
                                        "temperature_y",
                                        "gyro_temperature",
                                        "gyro_temp_y",
                                        "pressure",
                                        "status",
                                        "label",
                                        "counter",
                                        "q_x",
                                        "qy",
                                        "q_w",
                                        "w",
                                        "quaternion_y",
                                        "orientation_y",
                                        "roll",
                                        "yaw",
                                        "altitude",
                                        "vel_y [m/s]",
                                        "vy",
                                        "position_y",
                                        "pos_y [m]",
                                        "theta_y",
                                        "gyro_y_std",
                                        "gyro_y_bias",
                                        "reference_rate_y [deg/s]",
                                        "table_rate",
                                        "gyro",
                                        "accuracy",
                                        "gain_y",
                                        "max",
                                        "may",
                                        "map",
                                        "gyro_count",
                                        "x",
                                        "y",
                                        "wy [N]",
                                        "ay [m]",
                                        "my_note",
                                        "key",
                                        "display",
                                        "pyro",
                                        "zero_y",
                                        "euro_y",
                                        "barometer",
                                        "odometer_y",
                                        "axis_y",
                                        "magnitude",
                                        "lat",
                                        "lon",
                                        "heading",
                                        "gps_y",
                                        "current_y",
                                        "calibration_y",
                                        "angle_y",
                                        "angular_acceleration_y",
                                        "angular_position_y",
                                        "rate"};
    for (size_t k = 0; k < sizeof names / sizeof names[0]; k++) {
        imk_allan_log *a;
        const imk_finding *f = told(names[k], &a);
        if (f)
            fail_msg("%s: %s, %s", names[k], f->code, f->name);
        imk_allan_log_free(a);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_missing_axis_is_a_warning),
        cmocka_unit_test(test_others_are_notes),
        cmocka_unit_test(test_what_is_something_else),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
