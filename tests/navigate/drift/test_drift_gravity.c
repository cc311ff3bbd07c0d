/* SPDX-License-Identifier: Apache-2.0 */
/* Deflection of gravity: at rest it is a bias of the horizontal accelerometers, at a steady speed a
 * Gauss-Markov noise of theirs, and runs have what the covariance says when the speed changes. */
#include "check.h"

#include "imukit/drift.h"
#include "imukit/motion_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { STATES = IMK_DRIFT_STATES };

static const double ug = 9.80665e-6;

static imk_drift_moments moments_at(const imk_model *model, imk_drift_settings settings,
                                    double time)
{
    settings.time = &time;
    settings.time_count = 1;
    const size_t size = imk_drift_covariance_size(model, &settings);
    void *memory = aligned_alloc(64, (size + 63) / 64 * 64);
    imk_drift_analysis *analysis;
    assert_non_null(memory);
    CHECK_OK(imk_drift_covariance(model, &settings, NULL, &analysis, memory, size, NULL));
    const imk_drift_moments total = analysis->total[0];
    free(memory);
    return total;
}

static void check_equal(const imk_drift_moments *a, const imk_drift_moments *b, double tolerance)
{
    for (int i = 0; i < STATES; i++)
        for (int j = 0; j < STATES; j++)
            CHECK_CLOSE(a->covariance[i][j], b->covariance[i][j],
                        tolerance * sqrt(b->covariance[i][i] * b->covariance[j][j]) + 1e-30);
}

/* Level and heading north, x and y are north and east. */
static void at_rest_it_is_a_bias(void **state)
{
    (void)state;
    imk_model perfect, biased;
    imk_model_default(&perfect);
    biased = perfect;
    biased.accel.bias.repeatability.value[0] = 30 * ug;
    biased.accel.bias.repeatability.value[1] = 30 * ug;
    for (int self = 0; self < 2; self++) {
        imk_drift_settings settings = imk_drift_default();
        settings.alignment = self ? IMK_ALIGNED_SELF : IMK_ALIGNED_GIVEN;
        const imk_drift_moments expected = moments_at(&biased, settings, 3000.0);
        settings.gravity_deflection = 30 * ug;
        const imk_drift_moments found = moments_at(&perfect, settings, 3000.0);
        CHECK_BELOW(1e-7, expected.covariance[6][6] + expected.covariance[0][0]);
        check_equal(&found, &expected, 1e-9);
    }
}

static imk_motion_file *parse(const char *steps)
{
    char text[500];
    imk_motion_file *file;
    imk_error error;
    snprintf(text, sizeof text,
             "imukit_motion: 1\nstart: {latitude: 40 deg, longitude: 0 deg, height: 0 m%s\n",
             steps);
    CHECK_OK(imk_motion_parse(text, strlen(text), NULL, 0, &file, &error));
    return file;
}

/* On 20 m/s northward a distance of 5 km is a time of 250 s. The meridian turns the level by 1 mrad
 * in 300 s. */
static void at_a_steady_speed_it_is_noise(void **state)
{
    (void)state;
    imk_motion_file *file = parse(", speed: 20 m/s}\nsteps:\n  - hold 400 s");
    imk_model perfect, noisy;
    imk_model_default(&perfect);
    noisy = perfect;
    noisy.accel.noise.gauss_markov_count = 1;
    for (int i = 0; i < 2; i++) {
        noisy.accel.noise.gauss_markov[0].sigma.value[i] = 30 * ug;
        noisy.accel.noise.gauss_markov[0].correlation_time.value[i] = 250.0;
    }
    imk_drift_settings settings = imk_drift_default();
    settings.motion = imk_motion_file_motion(file)->trajectory;
    const imk_drift_moments expected = moments_at(&noisy, settings, 300.0);
    settings.gravity_deflection = 30 * ug;
    settings.gravity_distance = 5e3;
    const imk_drift_moments found = moments_at(&perfect, settings, 300.0);
    CHECK_BELOW(1.0, expected.covariance[0][0]);
    check_equal(&found, &expected, 1e-4);
    settings.gravity_distance = 0.0; /* constant: more */
    const imk_drift_moments constant = moments_at(&perfect, settings, 300.0);
    CHECK_BELOW(1.2 * found.covariance[0][0], constant.covariance[0][0]);
    imk_motion_file_free(file);
}

/* Stops and turns, after self-alignment: root mean squares of n runs scatter by 1/sqrt(2 n). */
static void runs_have_it(void **state)
{
    (void)state;
    imk_motion_file *file =
        parse("}\nsteps:\n  - hold 5 s\n  - accelerate to 30 m/s at 3 m/s^2\n  - hold 60 s\n"
              "  - turn left 120 deg at 10 deg/s\n  - hold 60 s\n  - stop at 3 m/s^2\n"
              "  - hold 60 s\n  - accelerate to 30 m/s at 3 m/s^2\n  - hold 60 s");
    static const double times[2] = {140.0, 280.0};
    const size_t runs = check_quick() ? 16 : 120;
    const double allowed = 5.0 / sqrt(2.0 * (double)runs);
    imk_model model;
    imk_model_default(&model);
    for (int self = 0; self < 2; self++) {
        imk_drift_settings settings = imk_drift_default();
        settings.motion = imk_motion_file_motion(file)->trajectory;
        settings.rate = 10.0;
        settings.alignment = self ? IMK_ALIGNED_SELF : IMK_ALIGNED_GIVEN;
        settings.alignment_time = 30.0;
        settings.gravity_deflection = 50 * ug;
        settings.gravity_distance = 1e3;
        settings.time = times;
        settings.time_count = 2;
        const size_t size = imk_drift_runs_workspace_size(&model, &settings);
        void *memory = aligned_alloc(64, (size + 63) / 64 * 64);
        assert_non_null(memory);
        double square[2][STATES] = {{0.0}}, errors[IMK_DRIFT_LANES][2][STATES];
        double alone[2][STATES], none[2][STATES];
        for (uint32_t first = 0; first < runs; first += IMK_DRIFT_LANES) {
            CHECK_OK(imk_drift_runs(&model, &settings, 9, first, IMK_DRIFT_LANES, &errors[0][0][0],
                                    memory, size, NULL));
            for (int run = 0; run < IMK_DRIFT_LANES; run++)
                for (int t = 0; t < 2; t++)
                    for (int i = 0; i < STATES; i++)
                        square[t][i] += errors[run][t][i] * errors[run][t][i];
        }
        /* A run is the same alone: the last one. */
        CHECK_OK(imk_drift_runs(&model, &settings, 9, (uint32_t)runs - 1, 1, &alone[0][0], memory,
                                size, NULL));
        assert_memory_equal(alone, errors[IMK_DRIFT_LANES - 1], sizeof alone);
        settings.gravity_deflection = 0.0;
        CHECK_OK(imk_drift_runs(&model, &settings, 9, 0, 1, &none[0][0], memory, size, NULL));
        CHECK_BELOW(hypot(none[1][0], none[1][1]), 0.01); /* the motion alone is exact */
        free(memory);
        settings.gravity_deflection = 50 * ug;
        for (int t = 0; t < 2; t++) {
            const imk_drift_moments m = moments_at(&model, settings, times[t]);
            for (int i = 0; i < STATES; i++)
                if (i != 2 && i != 5 && i != 8) /* the heading is below rounding if given */
                    CHECK_CLOSE(sqrt(square[t][i] / (double)runs / m.covariance[i][i]), 1.0,
                                allowed);
        }
    }
    imk_motion_file_free(file);
}

static void odd_numbers_are_refused(void **state)
{
    (void)state;
    imk_model model;
    imk_error error;
    imk_model_default(&model);
    const double time = 1.0;
    static const double bad[][2] = {{-1e-6, 1e4}, {0.2, 1e4}, {1e-4, -1.0}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        imk_drift_settings settings = imk_drift_default();
        settings.time = &time;
        settings.time_count = 1;
        settings.gravity_deflection = bad[i][0];
        settings.gravity_distance = bad[i][1];
        CHECK_STATUS(imk_drift_validate(&model, &settings, &error), IMK_ERROR_RANGE);
        assert_string_equal(error.field, i < 2 ? "gravity_deflection" : "gravity_distance");
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(at_rest_it_is_a_bias),
        cmocka_unit_test(at_a_steady_speed_it_is_noise),
        cmocka_unit_test(runs_have_it),
        cmocka_unit_test(odd_numbers_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
