/* SPDX-License-Identifier: Apache-2.0 */
/* What a count of a part is: figures by hand from the data sheets, every row against the width of
 * its output, and the look-up. */
#include "check.h"

#include "imukit/device_sensitivity.h"
#include "imukit/names.h"

#include <stdio.h>
#include <string.h>

static const double degree = 3.14159265358979323846 / 180, g = 9.80665;

static imk_device_sensitivity find(const char *part, imk_count_kind kind, const char *range)
{
    imk_device_sensitivity found = {0};
    imk_error error;
    if (imk_device_sensitivity_find(part, kind, range, &found, &error) != IMK_OK)
        fail_msg("%s %s: %s %s; %s", part, range ? range : "", error.field, error.found,
                 error.expected);
    return found;
}

/* LSB/(deg/s) and LSB/g as the data sheets print them. */
static void printed_sensitivities_are_found(void **state)
{
    (void)state;
    static const struct {
        const char *part, *range;
        double gyro, accel; /* counts per deg/s, per g; 0: the other one */
    } printed[] = {
        {"BMI088", "2000deg/s", 16.384, 0},
        {"bmi088", "125 deg/s", 262.144, 0},
        {"BMI088", "24g", 0, 1365},
        {"BMI088", "3 g", 0, 10920},
        {"BMI088", "235.3596 m/s^2", 0, 1365}, /* 24 g */
        {"BMI160", "+-2000 dps", 16.4, 0},
        {"BMI160", "±500 deg/s", 65.6, 0},
        {"BMI270", "1000 deg/s", 32.768, 0},
        {"BMI270", "8 g", 0, 4096},
        {"ICM-20948", "250 deg/s", 131.072, 0},
        {"icm 42688 p", "15.625 deg/s", 2097.2, 0},
        {"ICM-42688-P", "16 g", 0, 2048},
        {"MPU-6050", "2000 deg/s", 16.4, 0},
        {"MPU-6000", "250 deg/s", 131, 0}, /* one data sheet for both */
        {"MPU6050", "16g", 0, 2048},
        {"MPU-9250", "4 g", 0, 8192},
        {"LSM6DSO", "250 deg/s", 1 / 8.75e-3, 0},
        {"LSM6DSO", "2 g", 0, 1 / 0.061e-3},
        {"ISM330DHCX", "4000 deg/s", 1 / 0.14, 0},
        {"ISM330DHCX", "16 g", 0, 1 / 0.488e-3},
        {"ADIS16470 16-bit", NULL, 10, 0},
        {"ADIS16470 32 bit", "2000 deg/s", 655360, 0},
        {"ADIS16470-16bit", " ", 0, 800},
        {"ADIS16488 16-bit", NULL, 50, 0},
        {"ADIS16488 16-bit", "18 g", 0, 1250},
        {"ADIS16495-2 16-bit", "450 deg/s", 40, 0},
        {"ADIS16495-1 32-bit", NULL, 10485760, 0},
        {"ADIS16495-3 32-bit", NULL, 0, 262144000},
        {"ADIS16505-1 16-bit", NULL, 160, 0},
        {"ADIS16505-2 32-bit", NULL, 0, 26756268 * 9.80665},
        {"BMI088 16-bit", "6g", 0, 5460}, /* stated although there is one width */
    };
    for (size_t i = 0; i < sizeof printed / sizeof printed[0]; i++) {
        const bool gyro = printed[i].gyro > 0;
        const imk_device_sensitivity found =
            find(printed[i].part, gyro ? IMK_COUNTS_GYRO : IMK_COUNTS_ACCEL, printed[i].range);
        CHECK_RELATIVE(found.per_count, gyro ? degree / printed[i].gyro : g / printed[i].accel,
                       1e-14);
    }
}

/* The temperature registers: K per count, and degC at 0. */
static void temperatures_have_a_zero(void **state)
{
    (void)state;
    static const struct {
        const char *part;
        double per_count, zero;
    } printed[] = {{"BMI088", 0.125, 23},           {"BMI160", 1.0 / 512, 23},
                   {"BMI270", 1.0 / 512, 23},       {"ICM-20948", 1 / 333.87, 21},
                   {"ICM-42688-P", 1 / 132.48, 25}, {"MPU-6050", 1.0 / 340, 36.53},
                   {"MPU-9250", 1 / 333.87, 21},    {"LSM6DSO", 1.0 / 256, 25},
                   {"ISM330DHCX", 1.0 / 256, 25},   {"ADIS16488", 0.00565, 25},
                   {"ADIS16495-1", 0.0125, 25},     {"ADIS16470", 0.1, 0}};
    for (size_t i = 0; i < sizeof printed / sizeof printed[0]; i++) {
        const imk_device_sensitivity found = find(printed[i].part, IMK_COUNTS_TEMPERATURE, "9 g");
        CHECK_RELATIVE(found.per_count, printed[i].per_count, 1e-14);
        CHECK_CLOSE(found.zero, 273.15 + printed[i].zero, 1e-12);
    }
}

/* A full scale fills at least half of the numbers and, but for rounding in the data sheets (131 LSB
 * for 131.07), no more than all. */
static void every_row_fits_its_width(void **state)
{
    (void)state;
    imk_device_sensitivity row = {0}, found;
    size_t count = 0;
    for (; imk_device_sensitivity_get(count, &row); count++) {
        assert_true(row.per_count > 0 && row.bits >= 11 && row.bits <= 32);
        assert_true(row.part[0] && row.stated[0] && row.source[0]);
        assert_true((row.range > 0) == (row.range_stated[0] != '\0'));
        const double full = ldexp(1, row.bits - 1);
        if (row.range > 0) {
            CHECK_BELOW(row.range / row.per_count, 1.002 * full);
            CHECK_BELOW(0.5 * full, row.range / row.per_count);
        }
        assert_true((row.kind == IMK_COUNTS_TEMPERATURE) == (row.zero > 0));
        char part[96];
        assert_true(snprintf(part, sizeof part, "%s %d-bit", row.part, row.bits) < 96);
        assert_int_equal(
            imk_device_sensitivity_find(part, row.kind, row.range_stated, &found, NULL), IMK_OK);
        assert_string_equal(found.stated, row.stated);
    }
    assert_int_equal(count, imk_device_sensitivity_count());
    assert_true(count > 100);
}

static void what_is_not_there_is_refused_with_what_is(void **state)
{
    (void)state;
    static const struct {
        const char *part;
        imk_count_kind kind;
        const char *range;
        imk_status status;
        const char *field, *found, *expected;
    } wrong[] = {
        {"BMI088", IMK_COUNTS_ACCEL, "16g", IMK_ERROR_RANGE, "range", "16g",
         "one of 3 g, 6 g, 12 g, 24 g"},
        {"BMI088", IMK_COUNTS_ACCEL, NULL, IMK_ERROR_KEY_MISSING, "range", "",
         "one of 3 g, 6 g, 12 g, 24 g"},
        {"BMI088", IMK_COUNTS_GYRO, "", IMK_ERROR_KEY_MISSING, "range", "",
         "one of 125 deg/s, 250 deg/s, 500 deg/s, 1000 deg/s, 2000 deg/s"},
        {"ADIS16470", IMK_COUNTS_GYRO, NULL, IMK_ERROR_NAME_UNKNOWN, "device", "ADIS16470",
         "one of ADIS16470 16-bit, ADIS16470 32-bit"},
        {"ADIS16470 16-bit", IMK_COUNTS_GYRO, "500 deg/s", IMK_ERROR_RANGE, "range", "500 deg/s",
         "one of 2000 deg/s"},
        {"ADIS16505-2 16-bit", IMK_COUNTS_GYRO, "500 deg/s", IMK_ERROR_RANGE, "range", "500 deg/s",
         "leave it out: the part has one range"},
        {"BMI088 32-bit", IMK_COUNTS_ACCEL, "3 g", IMK_ERROR_NAME_UNKNOWN, "device",
         "BMI088 32-bit", "one of BMI088 16-bit"},
        {"BMI088", IMK_COUNTS_ACCEL, "24 deg/s", IMK_ERROR_DIMENSION, "range", NULL, NULL},
        {"BMI088", IMK_COUNTS_ACCEL, "24", IMK_ERROR_UNIT_MISSING, "range", NULL, NULL},
        {"BMI088", IMK_COUNTS_ACCEL, "wide", IMK_ERROR_SYNTAX, "range", NULL, NULL},
        {"BMI088", IMK_COUNTS_ACCEL, "-24 g", IMK_ERROR_RANGE, "range", "-24 g", NULL},
        {"ICM42688", IMK_COUNTS_GYRO, "500 deg/s", IMK_ERROR_NAME_UNKNOWN, "device", "ICM42688",
         "ICM-42688-P"},
        {"HG1700", IMK_COUNTS_GYRO, NULL, IMK_ERROR_NAME_UNKNOWN, "device", "HG1700", NULL},
        {"", IMK_COUNTS_GYRO, NULL, IMK_ERROR_NAME_UNKNOWN, "device", "", NULL},
        {"16-bit", IMK_COUNTS_GYRO, NULL, IMK_ERROR_NAME_UNKNOWN, "device", "16-bit", NULL},
        {NULL, IMK_COUNTS_GYRO, NULL, IMK_ERROR_ARGUMENT, "device", NULL, NULL},
        {"BMI088", (imk_count_kind)7, NULL, IMK_ERROR_ARGUMENT, "kind", NULL, NULL},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        imk_device_sensitivity found = {.bits = -1};
        imk_error error;
        assert_int_equal(imk_device_sensitivity_find(wrong[i].part, wrong[i].kind, wrong[i].range,
                                                     &found, &error),
                         wrong[i].status);
        assert_string_equal(error.field, wrong[i].field);
        if (wrong[i].found)
            assert_string_equal(error.found, wrong[i].found);
        if (wrong[i].expected)
            assert_string_equal(error.expected, wrong[i].expected);
        assert_int_equal(found.bits, -1); /* untouched */
    }
}

static void long_names_are_unknown(void **state)
{
    (void)state;
    char part[300];
    imk_device_sensitivity found;
    memset(part, 'B', sizeof part);
    part[sizeof part - 1] = '\0';
    assert_int_equal(imk_device_sensitivity_find(part, IMK_COUNTS_GYRO, NULL, &found, NULL),
                     IMK_ERROR_NAME_UNKNOWN);
    memcpy(part, "BMI088 ", 7);
    assert_int_equal(imk_device_sensitivity_find(part, IMK_COUNTS_GYRO, NULL, &found, NULL),
                     IMK_ERROR_NAME_UNKNOWN);
}

static void versions_belong_to_their_part(void **state)
{
    (void)state;
    const imk_device_sensitivity version = find("ADIS16465-2 16-bit", IMK_COUNTS_GYRO, NULL);
    assert_true(imk_device_sensitivity_of(&version, "ADIS16465"));
    assert_true(imk_device_sensitivity_of(&version, "adis16465-2"));
    assert_false(imk_device_sensitivity_of(&version, "ADIS16465-1"));
    assert_false(imk_device_sensitivity_of(&version, "ADIS1646"));
    const imk_device_sensitivity other = find("MPU-6050", IMK_COUNTS_GYRO, "250 deg/s");
    assert_true(imk_device_sensitivity_of(&other, "MPU-6000"));
    assert_false(imk_device_sensitivity_of(&other, "MPU-9250"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(printed_sensitivities_are_found),
        cmocka_unit_test(temperatures_have_a_zero),
        cmocka_unit_test(every_row_fits_its_width),
        cmocka_unit_test(what_is_not_there_is_refused_with_what_is),
        cmocka_unit_test(long_names_are_unknown),
        cmocka_unit_test(versions_belong_to_their_part),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
