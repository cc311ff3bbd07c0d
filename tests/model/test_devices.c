/* SPDX-License-Identifier: Apache-2.0 */
/* The catalogue: every entry makes a valid model; figures arrive converted as stated. Conversions
 * used here: 1 deg/sqrt(h) = pi/180/60 rad/sqrt(s), 1 ug = 9.80665e-6 m/s^2, floor = 0.664 B. */
#include "check.h"

#include "imukit/model.h"

#include <string.h>

static const double pi = 3.14159265358979323846;
static const double degree_per_hour = 3.14159265358979323846 / 180 / 3600;

static void every_entry_is_valid(void **state)
{
    (void)state;
    size_t presets = 0;
    assert_true(imk_device_count() >= 51 + 14 + 5);
    for (size_t i = 0; i < imk_device_count(); i++) {
        const imk_device *device = imk_device_get(i);
        imk_model model;
        imk_error error;
        imk_device_model(device, &model);
        if (imk_model_validate(&model, &error) != IMK_OK)
            fail_msg("%s: %s", device->name, error.field);
        assert_string_equal(model.name, device->name);
        assert_true(strlen(device->name) > 0 && strlen(device->grade) > 0);
        assert_true(strlen(device->note) > 0);
        /* the source must fit the evidence as it stands */
        assert_string_equal(model.gyro_evidence.source, device->source);
        assert_ptr_equal(imk_device_find(device->name), device);
        presets += device->is_preset;
    }
    assert_int_equal(presets, 5);
    assert_null(imk_device_get(imk_device_count()));
}

static void names_are_found_in_any_case(void **state)
{
    (void)state;
    assert_non_null(imk_device_find("adis16465"));
    assert_ptr_equal(imk_device_find(" xsens mti-1 "), imk_device_find("XsensMTi-1"));
    assert_string_equal(imk_device_find("icm42688_p")->name, "ICM-42688-P");
    assert_null(imk_device_find("ADIS1646"));
    assert_null(imk_device_find(""));
    assert_null(imk_device_find(NULL));
}

/* devices.csv: ADIS16405 2 deg/sqrt(h), floor 25.2 deg/h, 0.2 m/s/sqrt(h), floor 200 ug. */
static void data_sheet_floors_are_converted(void **state)
{
    (void)state;
    imk_model model;
    imk_device_model(imk_device_find("ADIS16405"), &model);
    double floor = sqrt(2 * log(2) / pi);
    for (int i = 0; i < 3; i++) { /* a few roundings: 1e-15 */
        CHECK_RELATIVE(model.gyro.noise.white.value[i], 2 * pi / 180 / 60, 1e-15);
        CHECK_RELATIVE(model.gyro.noise.bias_instability.value[i] * floor, 25.2 * degree_per_hour,
                       1e-15);
        CHECK_RELATIVE(model.accel.noise.white.value[i], 0.2 / 60, 1e-15);
        CHECK_RELATIVE(model.accel.noise.bias_instability.value[i] * floor, 200 * 9.80665e-6,
                       1e-15);
    }
}

/* devices.csv: STIM300 (RWTH measured) B .1877 deg/h as given, K 2.182 deg/h/sqrt(h), 400 deg/s;
 * its angle random walk is contradicted by the data sheet and must not appear. */
static void measured_figures_stay(void **state)
{
    (void)state;
    imk_model model;
    imk_device_model(imk_device_find("STIM300 measured"), &model);
    CHECK_RELATIVE(model.gyro.noise.bias_instability.value[0], .1877 * degree_per_hour, 1e-15);
    CHECK_RELATIVE(model.gyro.noise.random_walk.value[1], 2.182 * degree_per_hour / 60, 1e-15);
    CHECK_RELATIVE(model.gyro.range.value[2], 400 * pi / 180, 1e-15);
    CHECK_CLOSE(model.gyro.noise.white.value[0], 0, 0);
}

/* The published example: M_g row x = 40000 -14000 12500 ppm, G_g row z = 30 110 -130 deg/h/g. */
static void matrices_arrive_by_rows(void **state)
{
    (void)state;
    imk_model model;
    imk_device_model(imk_device_find("Groves consumer"), &model);
    CHECK_RELATIVE(model.gyro.scale_factor.fixed.value[0], 0.04, 1e-15);
    CHECK_RELATIVE(model.gyro.misalignment.value[0][1], -0.014, 1e-15);
    CHECK_RELATIVE(model.gyro.misalignment.value[0][2], 0.0125, 1e-15);
    CHECK_RELATIVE(model.gyro.g_sensitivity.value[2][1], 110 * degree_per_hour / 9.80665, 1e-15);
    CHECK_RELATIVE(model.accel.misalignment.value[2][1], 0.005, 1e-15);
    CHECK_RELATIVE(model.accel.bias.fixed.value[1], -13000 * 9.80665e-6, 1e-15);
}

static void gyro_only_unit_has_no_accelerometer(void **state)
{
    (void)state;
    imk_model model;
    imk_device_model(imk_device_find("ASTRIX 200"), &model);
    assert_true(model.gyro.present);
    assert_false(model.accel.present);
}

/* Each preset is of its class by the table, its biases in the range that the table prints for the
 * class (down to 0.0001, 0.001 and 0.1 deg/h where no lower end is printed [ELSHEIMY2020]), and the
 * strategic one is below the 0.00145 deg/h that its claim of 1 nmi in 24 h needs. */
static void presets_have_their_grade(void **state)
{
    (void)state;
    static const char *const names[] = {"strategic", "navigation", "tactical", "AHRS", "control"};
    for (int i = 0; i < 5; i++) {
        imk_model model;
        imk_device_model(imk_device_find(names[i]), &model);
        imk_grade_result result = imk_grade_model(&model);
        assert_int_equal(result.overall, i);
        assert_true(model.gyro.noise.white.value[0] > 0 && model.accel.noise.white.value[0] > 0);
        assert_true(model.gyro.noise.random_walk.value[0] > 0);
        assert_true(model.gyro.scale_factor.repeatability.value[0] > 0);
        assert_true(model.accel.misalignment.value[0][1] > 0);
        assert_true(model.gyro.range.value[0] > 0 && model.accel.range.value[0] > 0);
        assert_true(model.accel.nonlinearity.k2.value[0] > 0);
        /* integrating sensors quantise the integral, the others the output */
        const bool integrates = i <= IMK_GRADE_TACTICAL;
        assert_true(integrates == (model.gyro.noise.quantization.value[0] > 0));
        assert_true(integrates == (model.accel.resolution.value[0] == 0));
        static const double lowest[5] = {0.0001, 0.001, 0.1, 1, 10}; /* [deg/h] */
        const imk_grade_row *row = imk_grade_table((imk_grade)i);
        CHECK_BELOW(lowest[i] * degree_per_hour, result.gyro_bias);
        CHECK_BELOW(result.gyro_bias, row->gyro_bias_limit);
        CHECK_BELOW(result.accel_bias, row->accel_bias_limit);
        if (i == 0)
            CHECK_BELOW(result.gyro_bias, 0.00145 * degree_per_hour);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_entry_is_valid),
        cmocka_unit_test(names_are_found_in_any_case),
        cmocka_unit_test(data_sheet_floors_are_converted),
        cmocka_unit_test(measured_figures_stay),
        cmocka_unit_test(matrices_arrive_by_rows),
        cmocka_unit_test(gyro_only_unit_has_no_accelerometer),
        cmocka_unit_test(presets_have_their_grade),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
