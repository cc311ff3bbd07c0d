/* SPDX-License-Identifier: Apache-2.0 */
/* Counts as rates, forces and temperatures: by a sensitivity, by a device and its ranges. */
#include "check.h"

#include "imukit/log.h"
#include "imukit/units.h"

#include <string.h>

static const double degree = 3.14159265358979323846 / 180;

static const char counts[] = "time [s],gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z,temp\n"
                             "0.00,164,-328,0,2048,0,-2048,512\n"
                             "0.01,165,-328,0,2048,0,-2048,-512\n";

static imk_log_reader *open_counts(const char *text, const imk_log_settings *settings)
{
    imk_log_reader *reader = NULL;
    imk_error error;
    CHECK_OK(imk_log_open_memory(text, strlen(text), settings, &reader, &error));
    return reader;
}

static void read_two(imk_log_reader *reader, double value[8][2])
{
    double *columns[8];
    size_t rows;
    imk_error error;
    for (int i = 0; i < 8; i++)
        columns[i] = value[i];
    CHECK_OK(imk_log_read(reader, 2, columns, &rows, &error));
    assert_int_equal(rows, 2);
}

/* 164 counts of 16.4 a deg/s are 10 deg/s; 2048 of 2048 a g are 9.80665 m/s^2. The temperature
 * needs its unit. */
static void test_by_scale(void **state)
{
    (void)state;
    imk_log_settings settings = imk_log_default();
    double value[8][2];
    settings.gyro_scale = "16.4 LSB/(deg/s)";
    settings.accel_scale = "2048 LSB/g";
    settings.temperature_unit = "degC";
    imk_log_reader *reader = open_counts(counts, &settings);
    read_two(reader, value);
    CHECK_RELATIVE(value[1][0], 10 * degree, 1e-15);
    CHECK_RELATIVE(value[2][0], -20 * degree, 1e-15);
    CHECK_RELATIVE(value[4][0], 9.80665, 1e-15);
    CHECK_RELATIVE(value[6][1], -9.80665, 1e-15);
    CHECK_RELATIVE(value[7][0], 512 + 273.15, 1e-15);
    const imk_log_column *gyro = imk_log_column_get(reader, 1);
    assert_string_equal(gyro->unit.text, "deg/s");
    assert_int_equal(gyro->unit_origin, IMK_UNIT_OF_SETTINGS);
    imk_log_close(reader);
}

/* BMI270, data sheet: 16.384 counts a deg/s at 2000 deg/s, 4096 a g at 8 g; temperature
 * count/512 + 23 degC. */
static void test_by_device(void **state)
{
    (void)state;
    imk_log_settings settings = imk_log_default();
    double value[8][2];
    settings.device = "bmi270";
    settings.gyro_range = "2000 deg/s";
    settings.accel_range = "8g";
    imk_log_reader *reader = open_counts(counts, &settings);
    read_two(reader, value);
    CHECK_RELATIVE(value[1][0], 164 / 16.384 * degree, 1e-14);
    CHECK_RELATIVE(value[4][0], 9.80665 / 2, 1e-14);
    CHECK_RELATIVE(value[7][0], 24 + 273.15, 1e-14);
    CHECK_RELATIVE(value[7][1], 22 + 273.15, 1e-14);
    assert_int_equal(imk_log_column_get(reader, 1)->unit_origin, IMK_UNIT_OF_DEVICE);
    imk_log_close(reader);
}

/* Counts that a header names are converted, too; axes turn their signs. */
static void test_header_of_counts(void **state)
{
    (void)state;
    static const char text[] = "time [s],gyro_x [count],gyro_y [count],gyro_z [count]\n"
                               "0,164,0,0\n1,164,0,0\n";
    imk_log_settings settings = imk_log_default();
    double value[8][2];
    settings.gyro_scale = "0.1 deg/s/LSB";
    settings.axes = "backward-left-down";
    imk_log_reader *reader = open_counts(text, &settings);
    read_two(reader, value);
    CHECK_RELATIVE(value[1][0], -16.4 * degree, 1e-14);
    imk_log_close(reader);
}

static void refuse(const char *text, const imk_log_settings *settings, imk_status status,
                   const char *field, const char *words)
{
    imk_log_reader *reader = NULL;
    imk_error error;
    CHECK_STATUS(imk_log_open_memory(text, strlen(text), settings, &reader, &error), status);
    assert_string_equal(error.field, field);
    if (!strstr(error.found, words) && !strstr(error.expected, words)) {
        print_error("%s; %s\n  lacks: %s\n", error.found, error.expected, words);
        fail();
    }
}

static void test_refusals(void **state)
{
    (void)state;
    imk_log_settings settings = imk_log_default();
    settings.gyro_scale = "16.4 LSB/(deg/s)";
    settings.accel_unit = "g";
    refuse("time [s],gyro_x [deg/s]\n0,1\n1,1\n", &settings, IMK_ERROR_CONFLICT, "gyro_x",
           "its unit is deg/s, and --gyro-scale is for counts");
    refuse("time [s],dtheta_x [count]\n0,1\n1,1\n", &settings, IMK_ERROR_CONFLICT, "dtheta_x",
           "increments");
    settings.temperature_unit = "degC";
    settings.gyro_scale = "16.4 LSB/g";
    refuse(counts, &settings, IMK_ERROR_DIMENSION, "gyro-scale", "");
    settings.gyro_scale = NULL;
    settings.gyro_range = "2000 deg/s";
    refuse(counts, &settings, IMK_ERROR_CONFLICT, "gyro-range", "--device PART");
    settings.device = "BMI088";
    settings.gyro_range = "3000 deg/s";
    refuse(counts, &settings, IMK_ERROR_RANGE, "gyro-range", "2000 deg/s");
    settings.gyro_range = NULL;
    refuse(counts, &settings, IMK_ERROR_CONFLICT, "gyro-range", "add --gyro-range RANGE (one of");
    settings.gyro_scale = "16.4 LSB/(deg/s)";
    settings.gyro_range = "2000 deg/s";
    refuse(counts, &settings, IMK_ERROR_CONFLICT, "gyro-scale", "leave one of the two out");
    settings.gyro_scale = NULL;
    settings.gyro_range = "2000";
    refuse(counts, &settings, IMK_ERROR_SYNTAX, "gyro-range", "has no unit");
    settings.gyro_range = NULL;
    settings.device = "no such part";
    refuse(counts, &settings, IMK_ERROR_NAME_UNKNOWN, "device", "");
}

/* -1 of 16 bits, written without a sign. */
static void test_unsigned(void **state)
{
    (void)state;
    static const char text[] = "time [s],gyro_x\n0,1\n1,32767\n2,-32768\n3,65535\n";
    imk_log_settings settings = imk_log_default();
    double value[2][8], *columns[2] = {value[0], value[1]};
    size_t rows;
    imk_error error;
    settings.device = "BMI270";
    settings.gyro_range = "2000 deg/s";
    imk_log_reader *reader = open_counts(text, &settings);
    imk_status status = imk_log_read(reader, 8, columns, &rows, &error);
    while (status == IMK_OK && rows > 0)
        status = imk_log_read(reader, 8, columns, &rows, &error);
    CHECK_STATUS(status, IMK_ERROR_CONFLICT);
    assert_string_equal(error.field, "gyro_x");
    assert_non_null(strstr(error.found, "65535 counts in row 4"));
    imk_log_close(reader);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_by_scale),         cmocka_unit_test(test_by_device),
        cmocka_unit_test(test_header_of_counts), cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_unsigned),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
