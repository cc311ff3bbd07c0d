/* SPDX-License-Identifier: Apache-2.0 */
/* Correlations of calibrated values: in the covariance the sum of C_jk x_j x_k^T over the responses
 * to single values, in runs the draws of the same distribution; what two terms have in common, and
 * its part in a requirement. */
#include "car_profile.h"
#include "check.h"

#include "imukit/drift.h"
#include "imukit/model_parameter.h"
#include "navigate/drift/drift_correlation_internal.h"
#include "navigate/drift/drift_runs_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { STATES = IMK_DRIFT_STATES, COUNT = 18 };

/* Biases, scale factors and misalignments of both triads, as multiposition finds them. */
static imk_model_parameter parameter_of(int k)
{
    static const uint8_t terms[] = {IMK_MODEL_BIAS, IMK_MODEL_SCALE_FACTOR, IMK_MODEL_MISALIGNMENT};
    const uint8_t axis = (uint8_t)(k / 2 % 3);
    const uint8_t term = terms[k / 6];
    return (imk_model_parameter){(uint8_t)(k % 2), term, axis,
                                 (uint8_t)(term == IMK_MODEL_MISALIGNMENT ? (axis + 1) % 3 : 0)};
}

static double sigma_of(int k)
{
    static const double sizes[2][3] = {{1e-6, 1e-4, 1e-4}, {1e-3, 1e-4, 1e-4}};
    return sizes[k % 2][k / 6] * (1 + 0.1 * k);
}

/* 1 sigma of each, and correlations of a matrix A A^T, A from draws. */
static imk_model calibrated(void)
{
    imk_model model;
    double a[COUNT][COUNT], r[COUNT][COUNT];
    imk_model_default(&model);
    imk_random_normals(imk_random_seeded(4), 1, 0, sizeof a / sizeof(double), a[0]);
    for (int i = 0; i < COUNT; i++)
        for (int j = 0; j < COUNT; j++) {
            r[i][j] = 0;
            for (int k = 0; k < COUNT / 2; k++) /* of half the rank: singular */
                r[i][j] += a[i][k] * a[j][k];
        }
    model.correlation.count = COUNT;
    for (int i = 0; i < COUNT; i++) {
        double *sigma;
        model.correlation.parameter[i] = parameter_of(i);
        assert_non_null(imk_model_parameter_at(&model, parameter_of(i), &sigma));
        *sigma = sigma_of(i);
        for (int j = 0; j < i; j++)
            model.correlation.value[i * (i - 1) / 2 + j] =
                (float)(r[i][j] / sqrt(r[i][i] * r[j][j]));
    }
    CHECK_OK(imk_model_validate(&model, NULL));
    return model;
}

static imk_drift_analysis *analyse(const imk_model *model, const imk_drift_settings *settings,
                                   void **memory)
{
    imk_drift_analysis *analysis = NULL;
    const size_t size = imk_drift_covariance_size(model, settings);
    *memory = aligned_alloc(64, (size + 63) / 64 * 64);
    assert_non_null(*memory);
    CHECK_OK(imk_drift_covariance(model, settings, NULL, &analysis, *memory, size, NULL));
    return analysis;
}

static void drive(imk_trajectory *trajectory, imk_trajectory_piece **piece)
{
    imk_motion_script script;
    imk_motion_step step[CAR_PROFILE_STEPS];
    size_t count = 0;
    car_profile(&script, step);
    CHECK_OK(imk_motion_script_pieces(&script, &count, NULL));
    *piece = malloc(count * sizeof **piece);
    assert_non_null(*piece);
    CHECK_OK(imk_motion_script_compile(&script, *piece, count, trajectory, NULL));
}

/* ---- covariance ------------------------------------------------------------------------------ */

/* The mean that a single known value of 1 sigma makes is its response. */
static void responses(const imk_drift_settings *settings, double x[COUNT][STATES])
{
    imk_drift_settings known = *settings;
    known.compensated = false;
    for (int k = 0; k < COUNT; k++) {
        void *memory;
        imk_model one;
        imk_model_default(&one);
        *imk_model_parameter_at(&one, parameter_of(k), NULL) = sigma_of(k);
        memcpy(x[k], analyse(&one, &known, &memory)->total[0].mean, sizeof x[k]);
        free(memory);
    }
}

static void covariance_is_that_of_the_responses(void **state)
{
    (void)state;
    const double time = 300;
    const imk_model model = calibrated();
    imk_trajectory trajectory;
    imk_trajectory_piece *piece;
    drive(&trajectory, &piece);
    for (int way = 0; way < 3; way++) {
        static double x[COUNT][STATES];
        void *memory;
        imk_drift_settings settings = imk_drift_default();
        settings.compensated = true;
        settings.time = &time;
        settings.time_count = 1;
        settings.motion = way > 0 ? &trajectory : NULL;
        settings.alignment = way == 2 ? IMK_ALIGNED_SELF : IMK_ALIGNED_GIVEN;
        settings.vertical = way == 1 ? IMK_VERTICAL_FREE : IMK_VERTICAL_SLAVED;
        responses(&settings, x);
        const imk_drift_analysis *a = analyse(&model, &settings, &memory);
        assert_int_equal(a->cross_count, 15); /* pairs of six sources */
        double due[STATES][STATES] = {{0}};
        for (int j = 0; j < COUNT; j++)
            for (int k = 0; k < COUNT; k++)
                for (int i = 0; i < STATES; i++)
                    for (int l = 0; l < STATES; l++)
                        due[i][l] +=
                            imki_correlation_value(&model.correlation, j, k) * x[j][i] * x[k][l];
        for (int i = 0; i < STATES; i++)
            for (int l = 0; l < STATES; l++)
                CHECK_CLOSE(a->total[0].covariance[i][l], due[i][l],
                            1e-9 * sqrt(due[i][i] * due[l][l]) + 1e-30);
        free(memory);
    }
    free(piece);
}

/* At rest for a short time: a force b moves by b t^2/2, a rate d about east by g d t^3/6 of the
 * other sign than a tilt by the right hand has to north (the Earth's turn and curvature: 1e-3). */
static void two_parameters_have_a_closed_form(void **state)
{
    (void)state;
    const double t = 20, g = 9.80620, b = 1e-3, d = 3e-5, r = 0.8;
    imk_model model;
    void *memory;
    imk_model_default(&model);
    model.accel.bias.fixed.sigma[0] = b;
    model.gyro.bias.fixed.sigma[1] = d;
    model.correlation.count = 2;
    model.correlation.parameter[0] = (imk_model_parameter){IMK_ACCEL, IMK_MODEL_BIAS, 0, 0};
    model.correlation.parameter[1] = (imk_model_parameter){IMK_GYRO, IMK_MODEL_BIAS, 1, 0};
    model.correlation.value[0] = (float)r;
    imk_drift_settings settings = imk_drift_default();
    settings.compensated = true;
    settings.time = &t;
    settings.time_count = 1;
    const imk_drift_analysis *a = analyse(&model, &settings, &memory);
    const double force = b * t * t / 2, rate = g * d * t * t * t / 6;
    CHECK_RELATIVE(a->total[0].covariance[0][0], force * force + rate * rate - 2 * r * force * rate,
                   2e-3);
    assert_int_equal(a->cross_count, 1);
    assert_string_equal(a->source[a->cross[0].first].name, "gyro.bias.fixed");
    assert_string_equal(a->source[a->cross[0].second].name, "accel.bias.fixed");
    CHECK_RELATIVE(a->cross[0].moments[0].covariance[0][0], -2 * r * force * rate, 2e-3);
    free(memory);
    settings.compensated = false;
    assert_int_equal(analyse(&model, &settings, &memory)->cross_count, 0);
    free(memory);
}

/* Two names of one error, of which only the sum is known: what one has the other takes. */
static imk_model undone(void)
{
    imk_model model;
    imk_model_default(&model);
    model.accel.misalignment.sigma[0][2] = model.accel.cross_axis.sigma[0][2] = 1e-3;
    model.correlation.count = 2;
    model.correlation.parameter[0] = (imk_model_parameter){IMK_ACCEL, IMK_MODEL_MISALIGNMENT, 0, 2};
    model.correlation.parameter[1] = (imk_model_parameter){IMK_ACCEL, IMK_MODEL_CROSS_AXIS, 0, 2};
    model.correlation.value[0] = -1;
    return model;
}

static void opposite_errors_cancel(void **state)
{
    (void)state;
    const double t = 60;
    void *memory;
    const imk_model model = undone();
    imk_drift_settings settings = imk_drift_default();
    settings.compensated = true;
    settings.rate = 5;
    settings.time = &t;
    settings.time_count = 1;
    const imk_drift_analysis *a = analyse(&model, &settings, &memory);
    const double alone = a->contribution[0].covariance[0][0];
    assert_true(alone > 100); /* 1e-3 g for a minute: 17.7 m */
    assert_true(fabs(a->total[0].covariance[0][0]) <= 1e-12 * alone);
    free(memory);
    double errors[2][STATES];
    const size_t size = imk_drift_runs_workspace_size(&model, &settings);
    memory = aligned_alloc(64, (size + 63) / 64 * 64);
    assert_non_null(memory);
    CHECK_OK(imk_drift_runs(&model, &settings, 3, 0, 2, errors[0], memory, size, NULL));
    assert_true(fabs(errors[0][0]) < 1e-5 && fabs(errors[1][0]) < 1e-5);
    free(memory);
}

/* ---- runs ------------------------------------------------------------------------------------ */

/* The draws of 4000 runs: products of normals have a variance of 1 + r^2, so that five of their
 * standard deviations are 0.11 at most (one false alarm in a thousand sets of 171 figures; the seed
 * is fixed). The first parameter is drawn as without correlations. */
static void draws_are_correlated(void **state)
{
    (void)state;
    enum { RUNS = 4000 };
    const imk_model model = calibrated();
    static double factor[IMKI_CORRELATION_FACTOR];
    double sum[COUNT][COUNT] = {{0}};
    assert_true(imki_correlation_factor(&model.correlation, factor));
    for (uint32_t run = 0; run < RUNS; run++) {
        imk_model drawn = model, alone = model;
        double n[COUNT];
        imki_drift_residual(&drawn, factor, imk_random_seeded(11), run);
        for (int i = 0; i < COUNT; i++)
            n[i] = imk_model_parameter_get(&drawn, parameter_of(i)) / sigma_of(i);
        for (int i = 0; i < COUNT; i++)
            for (int j = 0; j <= i; j++)
                sum[i][j] += n[i] * n[j] / RUNS;
        if (run >= 3)
            continue;
        alone.correlation.count = 0;
        imki_drift_residual(&alone, NULL, imk_random_seeded(11), run);
        assert_true(drawn.gyro.bias.fixed.value[0] == alone.gyro.bias.fixed.value[0]);
        assert_true(drawn.accel.misalignment.value[2][0] != alone.accel.misalignment.value[2][0]);
    }
    for (int i = 0; i < COUNT; i++)
        for (int j = 0; j <= i; j++)
            CHECK_CLOSE(sum[i][j], imki_correlation_value(&model.correlation, i, j), 0.11);
}

/* A value without an effect stands between two others: their correlation by way of it stays. */
static void values_without_effect_are_drawn_too(void **state)
{
    (void)state;
    enum { RUNS = 4000 };
    imk_model model;
    static double factor[IMKI_CORRELATION_FACTOR];
    double sum = 0;
    imk_model_default(&model);
    model.gyro.bias.temperature.order = 1;
    model.gyro.bias.temperature.reference = 293;
    model.gyro.bias.temperature.minimum = 273;
    model.gyro.bias.temperature.maximum = 313;
    model.gyro.bias.temperature.coefficient[0].sigma[0] = 1e-7;
    model.gyro.bias.fixed.sigma[0] = model.gyro.bias.fixed.sigma[1] = 1;
    model.correlation.count = 3;
    model.correlation.parameter[0] =
        (imk_model_parameter){IMK_GYRO, IMK_MODEL_BIAS_TEMPERATURE, 0, 0};
    model.correlation.parameter[1] = (imk_model_parameter){IMK_GYRO, IMK_MODEL_BIAS, 0, 0};
    model.correlation.parameter[2] = (imk_model_parameter){IMK_GYRO, IMK_MODEL_BIAS, 1, 0};
    model.correlation.value[0] = model.correlation.value[1] = 0.9F;
    model.correlation.value[2] = 0.8F;
    assert_true(imki_correlation_factor(&model.correlation, factor));
    for (uint32_t run = 0; run < RUNS; run++) {
        imk_model drawn = model;
        imki_drift_residual(&drawn, factor, imk_random_seeded(12), run);
        sum += drawn.gyro.bias.fixed.value[0] * drawn.gyro.bias.fixed.value[1] / RUNS;
    }
    CHECK_CLOSE(sum, 0.8, 0.11);
}

/* Covariance and runs of the whole chain, 160 runs: chi-square at 1e-7 each side is 0.49 to 1.76
 * times; without the correlation of -0.95 the variance would be 5.8 times as large. */
static void runs_have_the_covariance(void **state)
{
    (void)state;
    enum { RUNS = 160 };
    const double t = 20;
    imk_model model;
    void *memory;
    static double errors[RUNS][STATES];
    imk_model_default(&model);
    model.accel.bias.fixed.sigma[0] = 1e-3;
    model.accel.scale_factor.fixed.sigma[2] = 1e-4;
    model.gyro.bias.fixed.sigma[1] = 1.5e-5;
    model.correlation.count = 2;
    model.correlation.parameter[0] = (imk_model_parameter){IMK_GYRO, IMK_MODEL_BIAS, 1, 0};
    model.correlation.parameter[1] = (imk_model_parameter){IMK_ACCEL, IMK_MODEL_BIAS, 0, 0};
    model.correlation.value[0] = 0.95F;
    imk_drift_settings settings = imk_drift_default();
    settings.compensated = true;
    settings.rate = 5;
    settings.time = &t;
    settings.time_count = 1;
    const imk_drift_analysis *a = analyse(&model, &settings, &memory);
    const double variance = a->total[0].covariance[0][0];
    assert_true(a->contribution[0].covariance[0][0] + a->contribution[1].covariance[0][0] >
                3 * variance);
    free(memory);
    const size_t size = imk_drift_runs_workspace_size(&model, &settings);
    memory = aligned_alloc(64, (size + 63) / 64 * 64);
    assert_non_null(memory);
    double sum = 0;
    for (uint32_t run = 0; run < RUNS; run += IMK_DRIFT_LANES)
        CHECK_OK(imk_drift_runs(&model, &settings, 6, run, IMK_DRIFT_LANES, errors[run], memory,
                                size, NULL));
    for (int run = 0; run < RUNS; run++)
        sum += errors[run][0] * errors[run][0] / RUNS;
    assert_true(sum > 0.49 * variance && sum < 1.76 * variance);
    free(memory);
}

/* ---- requirement, refusals ------------------------------------------------------------------- */

/* Sigmas multiplied by the factors, at the same correlations, meet the goal. */
static void requirements_are_met_by_their_factors(void **state)
{
    (void)state;
    const double t = 600;
    const imk_model model = calibrated();
    imk_drift_settings settings = imk_drift_default();
    imk_drift_allocation need;
    void *memory, *again;
    settings.compensated = true;
    settings.time = &t;
    settings.time_count = 1;
    const imk_drift_analysis *a = analyse(&model, &settings, &memory);
    const double goal = 0.4 * imk_drift_figures_of(&a->total[0]).cep;
    CHECK_OK(imk_drift_require(a, 0, IMK_REQUIRED_CEP, goal, &need, NULL));
    for (int alone = 0; alone < 2; alone++) {
        imk_model better = model;
        size_t best = 0;
        for (size_t k = 0; k < a->source_count; k++)
            best = need.alone[k] > need.alone[best] && need.alone[k] < 1 ? k : best;
        if (alone && !(need.alone[best] > 0))
            break;
        for (int i = 0; i < COUNT; i++) {
            double *sigma;
            char name[64];
            (void)imk_model_parameter_at(&better, parameter_of(i), &sigma);
            static const char *const terms[] = {"bias.fixed", "scale_factor.fixed", "misalignment"};
            snprintf(name, sizeof name, "%s.%s", i % 2 ? "accel" : "gyro", terms[i / 6]);
            for (size_t k = 0; k < a->source_count; k++)
                if (strcmp(a->source[k].name, name) == 0 && (!alone || k == best))
                    *sigma *= alone ? need.alone[k] : need.source[k];
        }
        const imk_drift_analysis *b = analyse(&better, &settings, &again);
        CHECK_RELATIVE(imk_drift_figures_of(&b->total[0]).cep, goal, 1e-6);
        free(again);
    }
    free(memory);
}

static void impossible_correlations_are_refused(void **state)
{
    (void)state;
    imk_error error;
    const double t = 10;
    imk_model model;
    imk_model_default(&model);
    model.correlation.count = 3;
    for (int i = 0; i < 3; i++) {
        model.gyro.bias.fixed.sigma[i] = 1e-6;
        model.correlation.parameter[i] =
            (imk_model_parameter){IMK_GYRO, IMK_MODEL_BIAS, (uint8_t)i, 0};
        model.correlation.value[i] = -0.5F; /* the sum of the three is known */
    }
    imk_drift_settings settings = imk_drift_default();
    settings.compensated = true;
    settings.time = &t;
    settings.time_count = 1;
    CHECK_OK(imk_drift_validate(&model, &settings, &error));
    for (int i = 0; i < 3; i++)
        model.correlation.value[i] = -0.9F;
    CHECK_STATUS(imk_drift_validate(&model, &settings, &error), IMK_ERROR_CONFLICT);
    assert_string_equal(error.field, "correlation.values");
    settings.compensated = false; /* they have no part in it */
    CHECK_OK(imk_drift_validate(&model, &settings, &error));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(covariance_is_that_of_the_responses),
        cmocka_unit_test(two_parameters_have_a_closed_form),
        cmocka_unit_test(opposite_errors_cancel),
        cmocka_unit_test(draws_are_correlated),
        cmocka_unit_test(values_without_effect_are_drawn_too),
        cmocka_unit_test(runs_have_the_covariance),
        cmocka_unit_test(requirements_are_met_by_their_factors),
        cmocka_unit_test(impossible_correlations_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
