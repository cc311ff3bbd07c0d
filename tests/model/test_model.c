/* SPDX-License-Identifier: Apache-2.0 */
/* The default model, validation and comparison. Each case of validation spoils one field of a
 * valid model and expects the status and the path of that field. */
#include "check.h"

#include "imukit/model.h"

#include <stdlib.h>
#include <string.h>

static void default_is_a_perfect_unit(void **state)
{
    (void)state;
    imk_model model;
    imk_model_default(&model);
    CHECK_OK(imk_model_validate(&model, NULL));
    assert_true(model.gyro.present && model.accel.present);
    assert_int_equal(model.gyro.axis_count, 3);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            CHECK_CLOSE(model.accel.direction[i][j], i == j ? 1 : 0, 0);
    CHECK_CLOSE(model.gyro.noise.white.value[0], 0, 0);
}

static void uninitialised_model_is_caught(void **state)
{
    (void)state;
    imk_model *model = calloc(1, sizeof *model);
    imk_error error;
    assert_non_null(model);
    CHECK_STATUS(imk_model_validate(model, &error), IMK_ERROR_UNINITIALISED);
    CHECK_STATUS(imk_model_validate(NULL, &error), IMK_ERROR_UNINITIALISED);
    free(model);
}

/* A model with something in every field. */
static imk_model full_model(void)
{
    imk_model model;
    imk_model_default(&model);
    imk_triad *gyro = &model.gyro, *accel = &model.accel;
    for (int i = 0; i < 3; i++) {
        gyro->bias.fixed.value[i] = 1e-6;
        gyro->bias.warm_up_amplitude.value[i] = 1e-6;
        gyro->noise.white.value[i] = 1e-5;
        gyro->noise.gauss_markov[0].sigma.value[i] = 1e-6;
        gyro->noise.gauss_markov[0].correlation_time.value[i] = 100;
        gyro->noise.gauss_markov[1] = gyro->noise.gauss_markov[0];
        gyro->noise.resonance[0].sigma.value[i] = 1e-4;
        gyro->noise.resonance[0].frequency.value[i] = 20;
        gyro->noise.resonance[0].q.value[i] = 16;
        gyro->bandwidth.value[i] = 50;
        gyro->damping.value[i] = 0.7;
        gyro->sensitivity.value[i] = 4778;
        gyro->zero_offset.value[i] = 32768;
        accel->noise.sinusoid[0].amplitude.value[i] = 1e-3;
        accel->noise.sinusoid[0].frequency.value[i] = 0.5;
        accel->noise.quantization.value[i] = 1e-3;
        gyro->bias.temperature.coefficient[0].value[i] = 1e-7;
    }
    gyro->bias.warm_up_time.value = 300;
    gyro->noise.gauss_markov_count = 2;
    gyro->noise.resonance_count = 1;
    accel->noise.sinusoid_count = 1;
    gyro->bias.temperature.order = 1;
    gyro->bias.temperature.reference = 298.15;
    gyro->bias.temperature.minimum = 233.15;
    gyro->bias.temperature.maximum = 358.15;
    model.timing.drops.value = 0.01;
    strcpy(model.gyro_evidence.interval[0].key, "noise.gauss_markov.sigma");
    model.gyro_evidence.interval[0].instance = 1;
    for (int i = 0; i < 3; i++)
        model.gyro_evidence.interval[0].upper.value[i] = 1e-5;
    model.gyro_evidence.interval_count = 1;
    return model;
}

/* Sets one field and expects a refusal. */
#define REFUSED(assignment, expected_status, path)                                                 \
    do {                                                                                           \
        imk_model model = full_model();                                                            \
        imk_error error;                                                                           \
        CHECK_OK(imk_model_validate(&model, &error));                                              \
        assignment;                                                                                \
        CHECK_STATUS(imk_model_validate(&model, &error), expected_status);                         \
        assert_string_equal(error.field, path);                                                    \
        assert_int_equal(error.status, expected_status);                                           \
        assert_true(error.expected[0] != '\0');                                                    \
    } while (0)

static void wrong_numbers_are_refused(void **state)
{
    (void)state;
    const double nan = (double)NAN, infinity = (double)INFINITY;
    REFUSED(model.gyro.bias.fixed.value[1] = nan, IMK_ERROR_NOT_FINITE, "gyro.bias.fixed");
    REFUSED(model.accel.bias.fixed.sigma[1] = infinity, IMK_ERROR_NOT_FINITE, "accel.bias.fixed");
    REFUSED(model.accel.bias.fixed.sigma[2] = -1, IMK_ERROR_RANGE, "accel.bias.fixed");
    REFUSED(model.gyro.bias.repeatability.value[0] = -1e-9, IMK_ERROR_RANGE,
            "gyro.bias.repeatability");
    REFUSED(model.gyro.noise.white.value[2] = -1, IMK_ERROR_RANGE, "gyro.noise.angle_random_walk");
    REFUSED(model.accel.noise.white.value[2] = -1, IMK_ERROR_RANGE,
            "accel.noise.velocity_random_walk");
    REFUSED(model.gyro.scale_factor.fixed.value[0] = -1, IMK_ERROR_RANGE,
            "gyro.scale_factor.fixed");
    REFUSED(model.gyro.nonlinearity.asymmetry.value[0] = 2, IMK_ERROR_RANGE,
            "gyro.nonlinearity.asymmetry");
    REFUSED(model.gyro.misalignment.value[1][1] = 1e-3, IMK_ERROR_RANGE, "gyro.misalignment");
    REFUSED(model.gyro.damping.value[0] = 0.01, IMK_ERROR_RANGE, "gyro.damping");
    REFUSED(model.timing.drops.value = 1, IMK_ERROR_RANGE, "timing.drops");
    REFUSED(model.timing.rate_error.value = nan, IMK_ERROR_NOT_FINITE, "timing.rate_error");
}

static void wrong_terms_are_refused(void **state)
{
    (void)state;
    REFUSED(model.gyro.noise.gauss_markov[1].correlation_time.value[2] = 0, IMK_ERROR_RANGE,
            "gyro.noise.gauss_markov[1].correlation_time");
    REFUSED(model.gyro.noise.gauss_markov[1].correlation_time.value[2] = (double)INFINITY,
            IMK_ERROR_NOT_FINITE, "gyro.noise.gauss_markov[1].correlation_time");
    REFUSED(model.gyro.noise.gauss_markov_count = 9, IMK_ERROR_RANGE, "gyro.noise.gauss_markov");
    REFUSED(model.gyro.noise.gauss_markov_count = -1, IMK_ERROR_RANGE, "gyro.noise.gauss_markov");
    REFUSED(model.gyro.noise.resonance[0].q.value[0] = 0.5, IMK_ERROR_RANGE,
            "gyro.noise.resonance[0].q");
    REFUSED(model.accel.noise.sinusoid[0].frequency.value[0] = -1, IMK_ERROR_RANGE,
            "accel.noise.sinusoid[0].frequency");
    REFUSED(model.gyro.bias.temperature.order = 6, IMK_ERROR_RANGE, "gyro.bias.temperature");
    REFUSED(model.gyro.bias.temperature.maximum = 200, IMK_ERROR_RANGE, "gyro.bias.temperature");
    REFUSED(model.gyro.bias.temperature.coefficient[0].value[0] = (double)NAN, IMK_ERROR_NOT_FINITE,
            "gyro.bias.temperature");
    REFUSED(model.gyro.bias.warm_up_time.value = 0, IMK_ERROR_RANGE, "gyro.bias.warm_up.time");
    REFUSED(model.accel.noise.bias_instability_correlation_time.value = -1, IMK_ERROR_RANGE,
            "accel.noise.bias_instability_correlation_time");
    REFUSED(model.accel.noise.bias_instability_correlation_time.value = 2e9, IMK_ERROR_RANGE,
            "accel.noise.bias_instability_correlation_time");
}

static void wrong_structure_is_refused(void **state)
{
    (void)state;
    REFUSED(model.gyro.axis_count = 0, IMK_ERROR_RANGE, "gyro.axis_count");
    REFUSED(model.gyro.axis_count = 9, IMK_ERROR_RANGE, "gyro.axis_count");
    REFUSED(model.gyro.direction[0][1] = 0.1, IMK_ERROR_RANGE, "gyro.direction");
    REFUSED(model.gyro.direction[0][0] = 1 + 2e-9, IMK_ERROR_RANGE, "gyro.direction");
    REFUSED(model.gyro.direction[0][0] = 1 - 2e-9, IMK_ERROR_RANGE, "gyro.direction");
    REFUSED(model.accel.nonlinearity.pendulous_axis[1][2] = 1 + 2e-9, IMK_ERROR_RANGE,
            "accel.pendulous_axis");
    REFUSED(model.accel.nonlinearity.pendulous_axis[1][2] = 1.1, IMK_ERROR_RANGE,
            "accel.pendulous_axis");
    REFUSED(model.accel.nonlinearity.pendulous_axis[1][1] = 1, IMK_ERROR_RANGE, /* along y */
            "accel.pendulous_axis");
    REFUSED(model.accel.nonlinearity.pendulous_axis[0][0] = (double)NAN, IMK_ERROR_NOT_FINITE,
            "accel.pendulous_axis");
    REFUSED(model.gyro.noise.density = (imk_density)7, IMK_ERROR_RANGE, "gyro.noise.density");
    REFUSED(model.gyro.present = model.accel.present = false, IMK_ERROR_KEY_MISSING, "gyro");
    REFUSED(memset(model.name, 'x', sizeof model.name), IMK_ERROR_ARGUMENT, "name");
}

static void wrong_company_is_refused(void **state)
{
    (void)state;
    REFUSED(model.accel.g_sensitivity.value[0][0] = 1, IMK_ERROR_CONFLICT, "accel.g_sensitivity");
    REFUSED(model.accel.g2_sensitivity.value[0][0] = 1, IMK_ERROR_CONFLICT, "accel.g2_sensitivity");
    REFUSED(model.gyro.lever_arm.value[0][0] = 1, IMK_ERROR_CONFLICT, "gyro.lever_arm");
    REFUSED(model.gyro.nonlinearity.cross_products.value[0][0] = 1, IMK_ERROR_CONFLICT,
            "gyro.cross_products");
    REFUSED(model.gyro.nonlinearity.pendulous_axis[0][1] = 1, IMK_ERROR_CONFLICT,
            "gyro.pendulous_axis");
    REFUSED(model.gyro.bandwidth.value[2] = 0, IMK_ERROR_CONFLICT, "gyro.damping");
    REFUSED(model.gyro.sensitivity.value[2] = 0, IMK_ERROR_CONFLICT, "gyro.sensitivity");
    REFUSED(model.accel.zero_offset.value[0] = 1, IMK_ERROR_CONFLICT, "accel.zero_offset");
    REFUSED(model.accel.resolution.value[1] = 1, IMK_ERROR_CONFLICT, "accel.resolution");
}

static void wrong_evidence_is_refused(void **state)
{
    (void)state;
    REFUSED(strcpy(model.gyro_evidence.interval[0].key, "noise.gauss"), IMK_ERROR_KEY_UNKNOWN,
            "gyro.evidence.interval_95");
    REFUSED(strcpy(model.gyro_evidence.interval[0].key, "noise.velocity_random_walk"),
            IMK_ERROR_KEY_UNKNOWN, "gyro.evidence.interval_95");
    REFUSED(model.gyro_evidence.interval[0].lower.value[2] = 1, IMK_ERROR_RANGE,
            "gyro.evidence.interval_95.noise.gauss_markov.sigma");
    REFUSED(model.gyro_evidence.interval_count = 25, IMK_ERROR_RANGE, "gyro.evidence");
    REFUSED((model.gyro_evidence.interval[1] = model.gyro_evidence.interval[0],
             model.gyro_evidence.interval_count = 2),
            IMK_ERROR_KEY_DUPLICATE, "gyro.evidence");
}

/* One axis without a term must not need what the term needs. */
static void absent_term_on_one_axis_is_valid(void **state)
{
    (void)state;
    imk_model model = full_model();
    model.gyro.noise.gauss_markov[0].sigma.value[1] = 0;
    model.gyro.noise.gauss_markov[0].correlation_time.value[1] = 0;
    model.gyro.noise.resonance[0].sigma.value[0] = 0;
    model.gyro.noise.resonance[0].q.value[0] = 0;
    CHECK_OK(imk_model_validate(&model, NULL));
}

static void what_is_not_there_does_not_count(void **state)
{
    (void)state;
    imk_model model = full_model(), other = full_model();
    other.gyro.noise.gauss_markov[5].sigma.value[0] = (double)NAN;
    other.gyro.bias.fixed.value[3] = 7;
    CHECK_OK(imk_model_validate(&other, NULL));
    assert_true(imk_model_equal(&model, &other));
    model.accel.present = other.accel.present = false;
    other.accel.bias.fixed.value[0] = 1;
    assert_true(imk_model_equal(&model, &other));
}

#define UNEQUAL(assignment)                                                                        \
    do {                                                                                           \
        imk_model model = full_model(), other = full_model();                                      \
        assert_true(imk_model_equal(&model, &other));                                              \
        assignment;                                                                                \
        assert_false(imk_model_equal(&model, &other));                                             \
    } while (0)

#define EQUAL(assignment)                                                                          \
    do {                                                                                           \
        imk_model model = full_model(), other = full_model();                                      \
        assignment;                                                                                \
        assert_true(imk_model_equal(&model, &other));                                              \
    } while (0)

static void comparison_sees_what_simulates(void **state)
{
    (void)state;
    UNEQUAL(other.gyro.bias.fixed.value[2] = nextafter(1e-6, 1));
    UNEQUAL(other.accel.lever_arm.value[2][1] = 1e-3);
    UNEQUAL(other.gyro.g2_sensitivity.value[2][5] = 1e-3);
    UNEQUAL(other.gyro.noise.gauss_markov_count = 1);
    UNEQUAL(other.gyro.noise.gauss_markov[1].sigma.value[2] = 2);
    UNEQUAL(other.gyro.bias.temperature.maximum = 360);
    UNEQUAL(other.gyro.bias.warm_up_time.value = 301);
    UNEQUAL(other.gyro.noise.bias_instability_correlation_time.value = 1e5);
    UNEQUAL(other.timing.skew.value = 1e-6);
    UNEQUAL(other.accel.present = false);
    UNEQUAL(other.gyro.axis_count = 2);
    EQUAL(other.gyro.bias.fixed.sigma[0] = 1);
    EQUAL(strcpy(other.name, "another"));
    EQUAL(other.gyro.noise.density = IMK_DENSITY_ONE_SIDED);
    EQUAL(other.gyro_evidence.interval_count = 0);
    EQUAL(other.gyro.range.value[0] = -0.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(default_is_a_perfect_unit),
        cmocka_unit_test(uninitialised_model_is_caught),
        cmocka_unit_test(wrong_numbers_are_refused),
        cmocka_unit_test(wrong_terms_are_refused),
        cmocka_unit_test(wrong_structure_is_refused),
        cmocka_unit_test(wrong_company_is_refused),
        cmocka_unit_test(wrong_evidence_is_refused),
        cmocka_unit_test(absent_term_on_one_axis_is_valid),
        cmocka_unit_test(what_is_not_there_does_not_count),
        cmocka_unit_test(comparison_sees_what_simulates),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
