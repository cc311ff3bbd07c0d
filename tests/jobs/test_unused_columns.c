/* SPDX-License-Identifier: Apache-2.0 */
/* Columns that resemble a sensor's and are not used are told; what is something else is not. */
#include "check.h"

#include "imukit/jobs.h"
#include "imukit/log.h"

#include <stdio.h>
#include <string.h>

enum { ROWS = 20 };

/* An Allan deviation of a log with these columns. */
static imk_allan_log *log_of(const char *header)
{
    static const int primes[] = {7, 11, 13, 5, 17, 19, 23, 29};
    char text[4000];
    imk_allan_log *a = NULL;
    imk_log_reader *reader;
    imk_error error;
    size_t columns = 1, used = (size_t)snprintf(text, sizeof text, "%s\n", header);
    for (const char *c = header; *c; c++)
        columns += *c == ',';
    for (int i = 0; i < ROWS; i++)
        for (size_t c = 0; c < columns; c++)
            used += (size_t)snprintf(text + used, sizeof text - used, "%d%s", i * i % primes[c],
                                     c + 1 < columns ? "," : "\n");
    imk_log_settings reading = imk_log_default();
    reading.rate = 100;
    CHECK_OK(imk_log_open_memory(text, used, &reading, &reader, &error));
    const imk_record_source source = imk_log_source(reader);
    const imk_allan_log_settings settings = imk_allan_log_default();
    CHECK_OK(imk_allan_log_run(&source, &settings, NULL, &a, &error));
    imk_log_close(reader);
    return a;
}

/* What is told of one more column beside gyro_x, gyro_z, accel_x. */
static const imk_finding *told(const char *name, imk_allan_log **a)
{
    char header[200];
    snprintf(header, sizeof header, "gyro_x [deg/s],gyro_z [deg/s],accel_x [g],%s", name);
    *a = log_of(header);
    for (size_t k = 0; k < (*a)->findings.count; k++)
        if (strncmp((*a)->findings.item[k].code, "unused", 6) == 0)
            return &(*a)->findings.item[k];
    return NULL;
}

static void test_a_missing_axis_is_a_warning(void **state)
{
    (void)state;
    static const char *const names[] = {
        "gryo_y",     "gyo_y",         "giro_y",          "-gyro_y",    "+gyro_y [deg/s]",
        "gyro_y_raw", "raw_gyro_y_lp", "gyro_y_filtered", "gyro_y_2nd", "Gryo-Y"};
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
    static const char *const names[] = {"gryo_x", "-gyro_z", "gyro_x_raw", "gyro_raw_x",
                                        "imu0_gyro_z"};
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

static bool has(const imk_findings *findings, const char *code, imk_finding_level level)
{
    for (size_t k = 0; k < findings->count; k++)
        if (strcmp(findings->item[k].code, code) == 0 && findings->item[k].level == level)
            return true;
    return false;
}

/* All axes are misspelt, or are in another language, or no sensor is read at all. */
static void test_a_whole_sensor(void **state)
{
    (void)state;
    static const struct {
        const char *header;
        bool sensor, channels; /* told of */
    } logs[] = {
        {"gryo_x,gryo_y,gryo_z,accel_x [g],accel_y [g],accel_z [g]", true, false},
        {"giro_x [deg/s],giro_y [deg/s],giro_z [deg/s],accel_x [g]", true, false},
        {"velang_x [rad/s],velang_y [rad/s],velang_z [rad/s],accel_x [g]", true, false},
        {"gyro_x [deg/s],Beschl_x [m/s^2],Beschl_y [m/s^2],Beschl_z [m/s^2]", true, false},
        {"Drehrate_x [deg/s],Drehrate_y [deg/s],Drehrate_z [deg/s],temperature [degC]", true, true},
        {"accel_x [g],reference_rate_x [deg/s],reference_rate_y [deg/s],reference_rate_z [deg/s]",
         false, false},
        {"accel_x [g],table_rate [deg/s],roll_rate [deg/s]", false, false},
        {"gyro_n [deg/s],gyro_e [deg/s],gyro_d [deg/s],accel_x [g]", true, false},
        {"rate_front [deg/s],rate_right [deg/s],rate_down [deg/s],accel_x [g]", true, false},
        {"rollspeed [rad/s],pitchspeed [rad/s],yawspeed [rad/s],accel_x [g]", true, false},
        {"gyro_x [deg/s],accel_n [g],accel_e [g],accel_d [g]", true, false},
        {"delta_theta_x [rad],delta_theta_y [rad],delta_theta_z [rad],accel_x [g]", true, false},
        {"gyro_x [deg/s],deltaVelocity[0] [m/s],deltaVelocity[1] [m/s],deltaVelocity[2] [m/s]",
         true, false},
        {"accel_x [g],rate_bias_n [deg/s],rate_bias_e [deg/s],rate_bias_d [deg/s]", false, false},
        {"accel_x [g],delta_x [rad],delta_y [rad],delta_z [rad]", false, false},
        {"gyro_x [deg/s],vel_x [m/s],vel_y [m/s],vel_z [m/s]", false, false},
        {"gyro_x [deg/s],angle_x [deg],angle_y [deg],angle_z [deg]", false, false},
        {"gyro_x [deg/s],mag_x [uT],mag_y [uT],mag_z [uT]", false, false},
        {"gyro_x [deg/s],pressure,altitude [m]", false, false},
    };
    for (size_t k = 0; k < sizeof logs / sizeof logs[0]; k++) {
        imk_allan_log *a = log_of(logs[k].header);
        if (has(&a->findings, "unused_sensor", IMK_FINDING_WARNING) != logs[k].sensor ||
            has(&a->findings, "unknown_channels", IMK_FINDING_WARNING) != logs[k].channels)
            fail_msg("%s", logs[k].header);
        imk_allan_log_free(a);
    }
    static const struct {
        const char *header, *name;
    } names[] = {
        {"gyro1 [deg/s],gyro2 [deg/s],gyro3 [deg/s],accel_x [g]",
         "gyro1, gyro2, gyro3\tgyro_x, gyro_y, gyro_z"},
        {"gyro0 [deg/s],gyro1 [deg/s],gyro2 [deg/s],accel_x [g]",
         "gyro0, gyro1, gyro2\tgyro_x, gyro_y, gyro_z"},
        {"delta_theta_x [rad],delta_theta_y [rad],delta_theta_z [rad],accel_x [g]",
         "delta_theta_x, delta_theta_y, delta_theta_z\tdtheta_x, dtheta_y, dtheta_z"},
        {"p1 [deg/s],p2 [deg/s],p3 [deg/s],accel_x [g]", "p1, p2, p3\tgyro_x, gyro_y, gyro_z"},
    };
    for (size_t k = 0; k < sizeof names / sizeof names[0]; k++) {
        imk_allan_log *n = log_of(names[k].header);
        assert_true(n->findings.count > 0);
        assert_string_equal(n->findings.item[0].name, names[k].name);
        imk_allan_log_free(n);
    }
    /* Channels of no sensor are a note. */
    imk_allan_log *a = log_of("temperature [degC],pressure");
    assert_true(has(&a->findings, "unknown_channels", IMK_FINDING_NOTE));
    imk_allan_log_free(a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_missing_axis_is_a_warning),
        cmocka_unit_test(test_others_are_notes),
        cmocka_unit_test(test_what_is_something_else),
        cmocka_unit_test(test_a_whole_sensor),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
