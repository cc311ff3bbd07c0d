/* SPDX-License-Identifier: Apache-2.0 */
/* Runs of an aided navigator against its covariance, and what their bits depend on. More of it, and
 * with more runs: experiments/aided_covariance.c. */
#include "check.h"

#include "imukit/distributions.h"
#include "imukit/drift.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { STATES = IMK_DRIFT_STATES, ALL = IMK_DRIFT_AIDED_STATES, TIMES = 3 };

static const double times[TIMES] = {10.0, 40.0, 60.0};

static void set_model(imk_model *model)
{
    imk_model_default(model);
    for (int i = 0; i < 3; i++) {
        model->gyro.noise.white.value[i] = 3e-5;
        model->gyro.bias.repeatability.value[i] = 1e-5;
        model->accel.noise.white.value[i] = 1e-3;
        model->accel.bias.repeatability.value[i] = 1e-2;
    }
}

static void set_settings(imk_aid aid[3], imk_drift_settings *settings)
{
    aid[0] = imk_aid_default(IMK_AID_POSITION);
    aid[1] = imk_aid_default(IMK_AID_VELOCITY);
    aid[2] = imk_aid_default(IMK_AID_HEADING);
    aid[2].sigma[0] = 0.02;
    for (int i = 0; i < 3; i++) {
        aid[0].sigma[i] = 0.2;
        aid[0].correlated_sigma[i] = 1.0;
        aid[0].lever_arm[i] = 1.0;
        aid[0].lever_arm_sigma[i] = 0.2;
        aid[1].sigma[i] = 0.1;
    }
    aid[0].correlation_time = 20.0;
    for (int k = 0; k < 3; k++)
        aid[k].until = 40.0;
    *settings = imk_drift_default();
    settings->rate = 20.0;
    settings->aid = aid;
    settings->aid_count = 3;
    settings->time = times;
    settings->time_count = TIMES;
    for (int i = 0; i < 3; i++) {
        settings->initial_sigma[i] = 3.0;
        settings->initial_sigma[3 + i] = 0.1;
        settings->initial_sigma[6 + i] = 0.01;
    }
}

static double *run(const imk_model *model, const imk_drift_settings *settings, uint64_t seed,
                   uint32_t first, size_t runs, size_t together)
{
    const size_t size = imk_drift_runs_workspace_size(model, settings);
    void *memory = aligned_alloc(64, (size + 63) / 64 * 64);
    double *errors = malloc(runs * settings->time_count * ALL * sizeof *errors);
    imk_error error;
    assert_true(memory && errors);
    for (size_t done = 0; done < runs; done += together) {
        const size_t count = runs - done < together ? runs - done : together;
        CHECK_OK(imk_drift_aided_runs(model, settings, seed, first + (uint32_t)done, count,
                                      errors + done * settings->time_count * ALL, memory, size,
                                      &error));
    }
    free(memory);
    return errors;
}

/* Each variance within the interval that the quantiles of chi-square give at 99 % for all of them
 * together, and the normalised errors squared within theirs at 99 %. */
static void test_covariance(void **state)
{
    (void)state;
    imk_model model;
    imk_aid aid[3];
    imk_drift_settings settings;
    imk_error error;
    imk_drift_analysis *analysis;
    const size_t runs = check_quick() ? 48 : 400;
    set_model(&model);
    set_settings(aid, &settings);
    const size_t size = imk_drift_covariance_size(&model, &settings);
    void *memory = aligned_alloc(64, (size + 63) / 64 * 64);
    assert_non_null(memory);
    CHECK_OK(imk_drift_covariance(&model, &settings, NULL, &analysis, memory, size, &error));
    double *errors = run(&model, &settings, 3, 0, runs, 8);
    const double n = (double)runs, family = 0.01 / (TIMES * (STATES + 1));
    for (size_t t = 0; t < TIMES; t++) {
        double sum[ALL] = {0.0};
        for (size_t r = 0; r < runs; r++) {
            const double *e = errors + (r * TIMES + t) * ALL;
            for (size_t i = 0; i < STATES; i++)
                sum[i] += e[i] * e[i] / analysis->total[t].covariance[i][i];
            sum[STATES] += e[STATES];
        }
        for (size_t i = 0; i < ALL; i++) {
            const double degrees = i < STATES ? n : n * (double)imk_drift_nees_degrees(&settings);
            CHECK_BELOW(sum[i], imk_chi_square_quantile(1.0 - 0.5 * family, degrees));
            CHECK_BELOW(imk_chi_square_quantile(0.5 * family, degrees), sum[i]);
        }
    }
    free(errors);
    free(memory);
}

/* The bits of a run depend on its number alone, and the nine errors are those of imk_drift_runs().
 */
static void test_bits(void **state)
{
    (void)state;
    imk_model model;
    imk_aid aid[3];
    imk_drift_settings settings;
    imk_error error;
    set_model(&model);
    set_settings(aid, &settings);
    settings.alignment = IMK_ALIGNED_SELF;
    settings.alignment_time = 10.0;
    double *together = run(&model, &settings, 5, 2, 5, 5);
    double *single = run(&model, &settings, 5, 2, 5, 1);
    assert_memory_equal(together, single, 5 * TIMES * ALL * sizeof *single);
    assert_true(together[0] != together[TIMES * ALL]);
    const size_t size = imk_drift_runs_workspace_size(&model, &settings);
    void *memory = malloc(size);
    double errors[TIMES * STATES];
    assert_non_null(memory);
    CHECK_OK(imk_drift_runs(&model, &settings, 5, 4, 1, errors, memory, size, &error));
    for (size_t t = 0; t < TIMES; t++)
        assert_memory_equal(errors + t * STATES, together + (2 * TIMES + t) * ALL,
                            STATES * sizeof *errors);
    settings.aid_count = 0;
    CHECK_STATUS(imk_drift_aided_runs(&model, &settings, 5, 4, 1, errors, memory, size, &error),
                 IMK_ERROR_ARGUMENT);
    free(memory);
    free(together);
    free(single);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_covariance),
        cmocka_unit_test(test_bits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
