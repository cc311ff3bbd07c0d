/* SPDX-License-Identifier: Apache-2.0 */
/* What stands for a random walk that the model does not have: bias instability, or its bound. */
#include "check.h"

#include "imukit/io.h"
#include "imukit/noise.h"
#include "imukit/parameter_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static imk_model model, back;
static imk_parameter_notes notes;
static imk_error error;

/* White noise everywhere; gyros B = 1e-4 rad/s and bounds of K, accelerometers B = 1e-3 m/s^2. */
static void fill_model(void)
{
    imk_model_default(&model);
    for (int axis = 0; axis < 3; axis++) {
        model.gyro.noise.white.value[axis] = 1e-4;
        model.gyro.noise.bias_instability.value[axis] = 1e-4;
        model.accel.noise.white.value[axis] = 1e-3;
        model.accel.noise.bias_instability.value[axis] = 1e-3;
        model.gyro_evidence.interval[0].upper.value[axis] = 1e-6 * (axis + 1);
    }
    model.gyro_evidence.interval_count = 1;
    strcpy(model.gyro_evidence.interval[0].key, "noise.rate_random_walk");
}

static imk_status convert(const imk_parameter_settings *settings)
{
    char *text = NULL;
    size_t size;
    const imk_status status =
        imk_parameters_print(NULL, settings, &model, &text, &size, &notes, &error);
    if (status == IMK_OK)
        CHECK_OK(imk_parameters_parse(text, size, settings, &back, NULL, NULL));
    free(text);
    return status;
}

static bool has_note(bool lost, const char *part)
{
    for (size_t i = 0; i < notes.count; i++)
        if (notes.note[i].lost == lost && strstr(notes.note[i].text, part))
            return true;
    return false;
}

static imk_parameter_settings gtsam(void)
{
    imk_parameter_settings settings = imk_parameter_default();
    settings.format = IMK_PARAMETERS_GTSAM; /* it has each axis */
    return settings;
}

/* sqrt(6 ln 2/pi) */
static const double factor = 1.1505709890814688;

static void test_bias_instability(void **state)
{
    (void)state;
    fill_model();
    model.gyro.noise.random_walk.value[1] = 2e-5;
    imk_parameter_settings settings = gtsam();
    settings.bias_instability_tau = 100;
    const imk_model before = model;
    CHECK_OK(convert(&settings));
    assert_true(imk_model_equal(&before, &model));
    CHECK_RELATIVE(back.gyro.noise.random_walk.value[0], factor * 1e-4 / 10, 1e-12);
    CHECK_RELATIVE(back.gyro.noise.random_walk.value[1], hypot(factor * 1e-5, 2e-5), 1e-12);
    CHECK_RELATIVE(back.accel.noise.random_walk.value[2], factor * 1e-3 / 10, 1e-12);
    /* The Allan variance at T is that of B; the deviation is sqrt(10) times as large at 10 T. */
    const double k = back.gyro.noise.random_walk.value[0];
    const double floor = imk_flicker_allan_variance(1e-4, 100);
    CHECK_RELATIVE(imk_random_walk_allan_variance(k, 100), floor, 1e-12);
    CHECK_RELATIVE(sqrt(imk_random_walk_allan_variance(k, 1000) / floor), sqrt(10), 1e-12);
    CHECK_RELATIVE(sqrt(imk_random_walk_allan_variance(k, 10) / floor), sqrt(0.1), 1e-12);
    assert_true(has_note(false, "gyro: bias instability (B) is in the random walk"));
    assert_false(has_note(true, "bias_instability"));
}

static void test_bounds(void **state)
{
    (void)state;
    fill_model();
    model.gyro.noise.random_walk.value[1] = 5e-7;
    model.accel.present = false;
    imk_parameter_settings settings = gtsam();
    settings.use_bounds = true;
    CHECK_OK(convert(&settings));
    CHECK_RELATIVE(back.gyro.noise.random_walk.value[0], 1e-6, 1e-12);
    CHECK_RELATIVE(back.gyro.noise.random_walk.value[1], 5e-7, 1e-12); /* its own */
    CHECK_RELATIVE(back.gyro.noise.random_walk.value[2], 3e-6, 1e-12);
    assert_true(has_note(false, "95 %"));
    assert_true(has_note(false, "x 1e-06, z 3e-06 rad/s^2/sqrt(Hz)"));
    assert_true(has_note(true, "gyro.noise.bias_instability is not held"));
    /* Both: the bound, and B on top. */
    settings.bias_instability_tau = 100;
    CHECK_OK(convert(&settings));
    CHECK_RELATIVE(back.gyro.noise.random_walk.value[2], hypot(3e-6, factor * 1e-5), 1e-12);
    /* An interval that does not begin at 0 is of a term that was found. */
    settings.bias_instability_tau = 0;
    model.gyro.noise.random_walk.value[1] = 0;
    for (int axis = 0; axis < 3; axis++)
        model.gyro_evidence.interval[0].lower.value[axis] = 1e-9;
    CHECK_STATUS(convert(&settings), IMK_ERROR_KEY_MISSING);
    assert_non_null(strstr(error.expected, "add --bias-instability-tau TIME"));
}

/* What the message says to add is what there is. */
static void test_missing(void **state)
{
    (void)state;
    static const imk_parameter_format needing[] = {
        IMK_PARAMETERS_KALIBR,  IMK_PARAMETERS_OPENVINS,  IMK_PARAMETERS_VINS,
        IMK_PARAMETERS_LIO_SAM, IMK_PARAMETERS_ORB_SLAM3, IMK_PARAMETERS_GTSAM};
    for (size_t i = 0; i < sizeof needing / sizeof needing[0] + 2; i++) {
        const bool needed = i < sizeof needing / sizeof needing[0];
        imk_parameter_settings settings = imk_parameter_default();
        settings.rate = 100;
        settings.format = needed       ? needing[i]
                          : i % 2 == 0 ? IMK_PARAMETERS_FAST_LIO
                                       : IMK_PARAMETERS_GLIM;
        fill_model();
        CHECK_STATUS(convert(&settings), IMK_ERROR_KEY_MISSING);
        assert_string_equal(error.field, "gyro.noise.rate_random_walk");
        assert_non_null(strstr(error.expected, "add --use-bounds (the largest K that the data "
                                               "allow) or --bias-instability-tau TIME"));
        memset(&model.gyro.noise.bias_instability, 0, sizeof(imk_axes));
        CHECK_STATUS(convert(&settings), IMK_ERROR_KEY_MISSING);
        assert_string_equal(error.expected, "add --use-bounds (the largest K that the data allow)");
        settings.use_bounds = true;
        CHECK_STATUS(convert(&settings), IMK_ERROR_KEY_MISSING);
        assert_string_equal(error.field, "accel.noise.acceleration_random_walk");
        assert_non_null(strstr(error.expected, "add --bias-instability-tau TIME with"));
        settings.use_bounds = false;
        model.gyro_evidence.interval_count = 0;
        memset(&model.accel.noise.bias_instability, 0, sizeof(imk_axes));
        if (needed) {
            CHECK_STATUS(convert(&settings), IMK_ERROR_KEY_MISSING);
            assert_non_null(strstr(error.expected, "nothing in the model stands for it"));
        } else {
            CHECK_OK(convert(&settings));
            assert_true(has_note(true, "accel: the model has no random walk (K)"));
        }
    }
    /* A simulator's file may have no walk; one without white noise is about other things. */
    imk_parameter_settings settings = imk_parameter_default();
    fill_model();
    settings.format = IMK_PARAMETERS_NAVEGO;
    CHECK_OK(convert(&settings));
    /* GTSAM has a covariance of each axis, others one number. */
    settings.format = IMK_PARAMETERS_OPENVINS;
    model.gyro.noise.random_walk.value[1] = 1e-5;
    memcpy(model.accel.noise.random_walk.value, (double[3]){1e-4, 1e-4, 1e-4}, 3 * sizeof(double));
    CHECK_OK(convert(&settings));
    settings.format = IMK_PARAMETERS_GTSAM;
    CHECK_STATUS(convert(&settings), IMK_ERROR_KEY_MISSING);
    assert_string_equal(error.field, "gyro.noise.rate_random_walk");
    assert_non_null(strstr(error.found, "is not in the model on all axes"));
    settings.format = IMK_PARAMETERS_KALIBR;
    imk_model_default(&model);
    model.accel.scale_factor.fixed.value[0] = 0.01;
    CHECK_OK(convert(&settings));
}

static void test_settings(void **state)
{
    (void)state;
    fill_model();
    static const double wrong[] = {-1, 1e-9, 1e9, NAN};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        imk_parameter_settings settings = gtsam();
        settings.bias_instability_tau = wrong[i];
        CHECK_STATUS(convert(&settings), IMK_ERROR_RANGE);
        assert_string_equal(error.field, "bias_instability_tau");
    }
    static const imk_parameter_format useless[] = {
        IMK_PARAMETERS_GAZEBO,    IMK_PARAMETERS_GNSS_INS_SIM, IMK_PARAMETERS_PX4,
        IMK_PARAMETERS_ARDUPILOT, IMK_PARAMETERS_DLIO,         IMK_PARAMETERS_FUSION};
    for (size_t i = 0; i < sizeof useless / sizeof useless[0]; i++) {
        imk_parameter_settings settings = imk_parameter_default();
        settings.format = useless[i];
        settings.use_bounds = true;
        CHECK_STATUS(convert(&settings), IMK_ERROR_CONFLICT);
    }
    imk_parameter_settings settings = imk_parameter_default();
    settings.format = IMK_PARAMETERS_MATLAB;
    settings.bias_instability_tau = 1;
    CHECK_STATUS(convert(&settings), IMK_ERROR_CONFLICT);
    settings.bias_instability_tau = 0;
    settings.use_bounds = true;
    CHECK_OK(convert(&settings));
    CHECK_RELATIVE(back.gyro.noise.random_walk.value[1], 2e-6, 1e-12);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bias_instability), cmocka_unit_test(test_bounds),
        cmocka_unit_test(test_missing), cmocka_unit_test(test_settings)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
