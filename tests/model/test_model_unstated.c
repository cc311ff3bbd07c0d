/* SPDX-License-Identifier: Apache-2.0 */
/* What a model does not state: told from zeros that are stated, assumed from the presets, and where
 * it leaves a device of the catalogue without a class. */
#include "check.h"

#include "imukit/model_unstated.h"

#include <string.h>

static const imk_unstated_term *find(const imk_unstated *all, int sensor, const char *key)
{
    for (size_t i = 0; i < all->count; i++)
        if (all->term[i].sensor == sensor && strcmp(all->term[i].key, key) == 0)
            return &all->term[i];
    return NULL;
}

static const char *const keys[2][8] = {
    {"bias.repeatability", "noise.angle_random_walk", "noise.bias_instability",
     "noise.rate_random_walk", "scale_factor.repeatability", "misalignment", "g_sensitivity",
     "g2_sensitivity"},
    {"bias.repeatability", "noise.velocity_random_walk", "noise.bias_instability",
     "noise.acceleration_random_walk", "scale_factor.repeatability", "misalignment",
     "nonlinearity.k2", NULL}};

static imk_model preset(imk_grade grade)
{
    imk_model model;
    imk_device_model(imk_device_get((size_t)grade), &model);
    return model;
}

/* ---- zero, and not stated -------------------------------------------------------------------- */

static void each_term_is_missed_until_it_is_stated(void **state)
{
    (void)state;
    imk_model model;
    imk_unstated all;
    imk_model_default(&model);
    imk_model_unstated(&model, &all);
    assert_int_equal(all.count, 15);
    for (int sensor = 0; sensor < 2; sensor++)
        for (int i = 0; i < 8 && keys[sensor][i]; i++) {
            const char *key = keys[sensor][i];
            imk_model_unstated(&model, &all);
            const imk_unstated_term *term = find(&all, sensor, key);
            assert_non_null(term);
            /* Nothing tells the class: the worst. */
            assert_int_equal(term->grade, IMK_GRADE_CONTROL);
            assert_false(imk_model_states(&model, sensor, key));
            CHECK_OK(imk_model_state_zero(&model, sensor, key, NULL));
            assert_true(imk_model_states(&model, sensor, key));
            imk_model_unstated(&model, &all);
            assert_null(find(&all, sensor, key));
        }
    imk_model_unstated(&model, &all);
    assert_int_equal(all.count, 0);
    CHECK_OK(imk_model_validate(&model, NULL));
    model.accel.present = false;
    imk_model_unstated(&model, &all);
    assert_int_equal(all.count, 7); /* all of the accelerometers */
}

/* A 1 sigma of the bias is of the day of its calibration, unless the model is a residual. */
static void other_numbers_state_a_term(void **state)
{
    (void)state;
    imk_model model;
    imk_unstated all;
    imk_model_default(&model);
    model.gyro.bias.fixed.sigma[1] = 1e-6;
    model.gyro.scale_factor.fixed.value[2] = 1e-4;
    model.gyro.cross_axis.value[0][1] = 1e-3;
    model.gyro.noise.gauss_markov_count = 1;
    imk_model_unstated(&model, &all);
    assert_non_null(find(&all, IMK_GYRO, "bias.repeatability"));
    assert_null(find(&all, IMK_GYRO, "scale_factor.repeatability"));
    assert_null(find(&all, IMK_GYRO, "misalignment"));
    assert_null(find(&all, IMK_GYRO, "noise.bias_instability"));
    strcpy(model.residual_of, "calibration of May");
    imk_model_unstated(&model, &all);
    assert_null(find(&all, IMK_GYRO, "bias.repeatability"));
    assert_non_null(find(&all, IMK_ACCEL, "bias.repeatability"));
}

/* What was looked for and not found is not larger than the data allow. */
static void evidence_bounds_what_is_typical(void **state)
{
    (void)state;
    imk_model model = preset(IMK_GRADE_TACTICAL);
    imk_unstated all;
    const double typical = model.gyro.noise.bias_instability.value[0];
    for (int i = 0; i < 3; i++)
        model.gyro.noise.bias_instability.value[i] = 0;
    model.gyro_evidence.interval_count = 1;
    imk_interval *bound = &model.gyro_evidence.interval[0];
    strcpy(bound->key, "noise.bias_instability");
    for (int larger = 0; larger < 2; larger++) {
        for (int i = 0; i < 3; i++)
            bound->upper.value[i] = (larger ? 2 : 0.5) * typical / (1 + i);
        imk_model_unstated(&model, &all);
        assert_int_equal(all.count, 1);
        CHECK_RELATIVE(all.term[0].typical, larger ? typical : 0.5 * typical, 1e-14);
    }
}

static void names_that_are_none_are_refused(void **state)
{
    (void)state;
    imk_error error;
    imk_model model;
    imk_model_default(&model);
    static const char *const wrong[] = {"lever_arm",        "noise.gauss_markov",
                                        "bias.temperature", "noise.gauss_markov.sigma",
                                        "bias.repeat",      "direction"};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++)
        CHECK_STATUS(imk_model_state_zero(&model, IMK_GYRO, wrong[i], &error),
                     IMK_ERROR_NAME_UNKNOWN);
    CHECK_STATUS(imk_model_state_zero(&model, 3, "bias.fixed", &error), IMK_ERROR_NAME_UNKNOWN);
    assert_false(imk_model_states(&model, IMK_GYRO, "noise.gauss_markov"));
    assert_false(imk_model_states(&model, IMK_GYRO, "lever_arm"));
    assert_true(model.gyro.stated_zero == 0);
}

/* ---- classes --------------------------------------------------------------------------------- */

/* Each preset is of its own class, and so is a part of it; a perfect unit of a class is the
 * preset but for range and output. */
static void presets_are_typical_of_their_class(void **state)
{
    (void)state;
    for (int grade = 0; grade < IMK_GRADE_NONE; grade++) {
        imk_unstated assumed;
        imk_model model = preset((imk_grade)grade), filled;
        assert_int_equal(imk_model_class(&model, IMK_GYRO), grade);
        assert_int_equal(imk_model_class(&model, IMK_ACCEL), grade);
        for (int i = 0; i < 3; i++) /* of the noise of the gyros alone */
            model.gyro.bias.repeatability.value[i] = 0;
        model.accel.present = false;
        assert_int_equal(imk_model_class(&model, IMK_GYRO), grade);
        assert_int_equal(imk_model_class(&model, IMK_ACCEL), grade);

        imk_model_default(&filled);
        filled.accel.present = false;
        imk_model_assume_class(&filled, (imk_grade)grade, &assumed);
        model = preset((imk_grade)grade);
        assert_true(filled.accel.present);
        assert_int_equal(assumed.count, grade < IMK_GRADE_TACTICAL ? 13 : 15);
        for (int sensor = 0; sensor < 2; sensor++)
            for (int i = 0; i < 8 && keys[sensor][i]; i++)
                assert_true(imk_model_states(&filled, sensor, keys[sensor][i]) ==
                            imk_model_states(&model, sensor, keys[sensor][i]));
        for (int i = 0; i < 3; i++) {
            CHECK_RELATIVE(filled.gyro.bias.repeatability.value[i],
                           model.gyro.bias.repeatability.value[i], 1e-14);
            CHECK_RELATIVE(filled.accel.bias.repeatability.value[i],
                           model.accel.bias.repeatability.value[i], 1e-14);
            CHECK_RELATIVE(filled.accel.nonlinearity.k2.value[i],
                           model.accel.nonlinearity.k2.value[i], 1e-14);
            for (int j = 0; j < 3; j++) {
                CHECK_CLOSE(filled.gyro.misalignment.value[i][j],
                            model.gyro.misalignment.value[i][j], 1e-18);
                CHECK_CLOSE(filled.gyro.g_sensitivity.value[i][j],
                            model.gyro.g_sensitivity.value[i][j], 1e-18);
                CHECK_CLOSE(filled.gyro.g2_sensitivity.value[i][j],
                            model.gyro.g2_sensitivity.value[i][j], 1e-18);
            }
        }
        CHECK_OK(imk_model_validate(&filled, NULL));
        imk_model_assume_class(&filled, IMK_GRADE_NONE, &assumed);
        assert_int_equal(assumed.count, 0);
    }
}

/* Whatever the number of axes and their directions, what is assumed is valid. */
static void odd_triads_are_filled(void **state)
{
    (void)state;
    static const double axes[4][3] = {{0, 1, 0}, {0, 0, 1}, {1, 0, 0}, {0.6, 0.8, 0}};
    for (int count = 1; count <= 4; count++) {
        imk_model model;
        imk_model_default(&model);
        model.gyro.axis_count = model.accel.axis_count = count;
        memcpy(model.gyro.direction, axes, sizeof axes);
        memcpy(model.accel.direction, axes, sizeof axes);
        imk_model_assume_class(&model, IMK_GRADE_AHRS, NULL);
        CHECK_OK(imk_model_validate(&model, NULL));
        assert_true(model.gyro.bias.repeatability.value[count - 1] > 0);
    }
}

/* ---- grades ---------------------------------------------------------------------------------- */

/* An entry has a class exactly where no bias that is missing would matter: where both sensors state
 * the run-to-run bias and an instability, or the one that is missing is below a fifth, or where it
 * is below every class in any case. Typical values are those of the preset of imk_model_class(). */
static void devices_have_a_class_where_their_biases_are_stated(void **state)
{
    (void)state;
    int given = 0, refused = 0;
    for (size_t d = 0; d < imk_device_count(); d++) {
        imk_model model;
        imk_device_model(imk_device_get(d), &model);
        const imk_grade_result result = imk_grade_model(&model);
        const imk_grade grades[2] = {result.gyro, result.accel};
        const double bias[2] = {result.gyro_bias, result.accel_bias};
        bool lacks[2] = {false, false};
        for (int sensor = 0; sensor < 2; sensor++) {
            const imk_triad *triad = imk_model_triad(&model, sensor);
            if (!triad->present || (!isnan(bias[sensor]) && grades[sensor] == IMK_GRADE_NONE))
                continue;
            const imk_grade own = imk_model_class(&model, sensor);
            const imk_model typical = preset(own == IMK_GRADE_NONE ? IMK_GRADE_CONTROL : own);
            const imk_triad *of = imk_model_triad(&typical, sensor);
            const double r =
                triad->bias.repeatability.value[0] > 0 ? 0 : of->bias.repeatability.value[0];
            const double b = triad->noise.bias_instability.value[0] > 0
                                 ? 0
                                 : of->noise.bias_instability.value[0];
            const double square = r * r + b * b, stated = isnan(bias[sensor]) ? 0 : bias[sensor];
            lacks[sensor] = square / (square + stated * stated) > 0.05;
        }
        if (lacks[0] != result.gyro_at_best || lacks[1] != result.accel_at_best)
            fail_msg("%s", imk_device_get(d)->name);
        const bool below = *result.limiting && result.overall == IMK_GRADE_NONE;
        assert_true(result.at_best == (!below && (lacks[0] || lacks[1])));
        if (imk_device_get(d)->is_preset)
            assert_false(result.at_best);
        given += !result.at_best;
        refused += result.at_best;
    }
    assert_true(given > 5 && refused > 40);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_term_is_missed_until_it_is_stated),
        cmocka_unit_test(other_numbers_state_a_term),
        cmocka_unit_test(evidence_bounds_what_is_typical),
        cmocka_unit_test(names_that_are_none_are_refused),
        cmocka_unit_test(presets_are_typical_of_their_class),
        cmocka_unit_test(odd_triads_are_filled),
        cmocka_unit_test(devices_have_a_class_where_their_biases_are_stated),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
