/* SPDX-License-Identifier: Apache-2.0 */
/* Stated errors of the displayed attitude: a case in closed form, and full runs against the
 * covariance at several latitudes and at the poles. The statistics of 400 runs up to 4 h are in
 * experiments/results/displayed_attitude.txt. */
#include "check.h"

#include "imukit/drift.h"

#include <stdlib.h>

enum { STATES = IMK_DRIFT_STATES, TIMES = 2 };

static const double degree = 0.017453292519943295, earth_rate = 7.292115e-5;

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

/* A gyro bias b about north, at the equator after one period of Schuler, 2 pi sqrt(R/g) = 84.4 min:
 * the level has followed the position by b t, which is the error against the Earth, and what is
 * displayed is b/w sin(w t) with w = sqrt(g/R): nothing, but for the Earth's rate, which mixes the
 * axes by e t^2/2 in the time. */
static void tilt_after_a_period_is_not_displayed(void **state)
{
    (void)state;
    const double bias = 1.0 * degree / 3600.0;
    imk_model model;
    imk_model_default(&model);
    model.gyro.bias.fixed.value[0] = bias;
    imk_drift_settings settings = imk_drift_default();
    settings.latitude = 0.0;
    double meridian, prime_vertical;
    imk_curvature_radii(0.0, &meridian, &prime_vertical);
    const double w = sqrt(imk_normal_gravity(0.0, 0.0) / prime_vertical);
    const double period = 2.0 * 3.14159265358979323846 / w;
    const imk_drift_moments quarter = moments_at(&model, settings, 0.25 * period);
    const imk_drift_moments whole = moments_at(&model, settings, period);
    settings.attitude_errors = IMK_ATTITUDE_EARTH;
    const imk_drift_moments against_earth = moments_at(&model, settings, period);
    CHECK_RELATIVE(quarter.mean[6], bias / w, 0.01);
    CHECK_RELATIVE(against_earth.mean[6], bias * period, 0.01);
    CHECK_BELOW(hypot(whole.mean[6], whole.mean[7]), 0.01 * bias * period);
    CHECK_BELOW(bias * period, 1.5 * degree); /* the 1.4 deg that would be stated otherwise */
    CHECK_BELOW(1.3 * degree, bias * period);
}

/* North of 60 deg an error of the position to the east by d turns the displayed heading by
 * d tan(L)/N; the grid heading at a pole it leaves alone. */
static void heading_follows_the_position(void **state)
{
    (void)state;
    imk_model model;
    imk_model_default(&model);
    imk_drift_settings settings = imk_drift_default();
    settings.initial_sigma[1] = 100.0;
    double meridian, prime_vertical;
    for (int south = 0; south < 2; south++) {
        settings.latitude = (south ? -85.0 : 85.0) * degree;
        imk_curvature_radii(settings.latitude, &meridian, &prime_vertical);
        settings.attitude_errors = IMK_ATTITUDE_LOCAL; /* given as displayed: no error at first */
        imk_drift_moments m = moments_at(&model, settings, 1e-3);
        CHECK_CLOSE(m.covariance[8][8], 0.0, 1e-20);
        settings.attitude_errors = IMK_ATTITUDE_EARTH; /* nor against the Earth */
        m = moments_at(&model, settings, 1e-3);
        CHECK_CLOSE(m.covariance[8][8], 0.0, 1e-20);
        /* A velocity error v to the east makes it grow by v tan(L)/N, nearly. */
        imk_drift_settings moving = imk_drift_default();
        moving.latitude = settings.latitude;
        moving.initial_sigma[4] = 10.0;
        m = moments_at(&model, moving, 10.0);
        CHECK_RELATIVE(sqrt(m.covariance[8][8]), 100.0 * tan(85.0 * degree) / prime_vertical, 1e-3);
        assert_true((m.covariance[8][1] > 0.0) == !south);
        moving.latitude = south ? -90.0 * degree : 90.0 * degree;
        m = moments_at(&model, moving, 10.0);
        CHECK_BELOW(sqrt(m.covariance[8][8]), 10.0 * 10.0 / 6.4e6 * earth_rate * 10.0 + 1e-12);
    }
}

/* Root mean squares of n runs scatter by 1/sqrt(2 n) of the stated: five times that is allowed,
 * and the 4 % that squares of angles of some 0.1 rad could make. */
static void runs_have_the_stated_errors(void **state)
{
    (void)state;
    static const double latitudes[] = {-60.0, 85.0, 90.0}, times[TIMES] = {600.0, 3600.0};
    const size_t runs = check_quick() ? 16 : 80;
    const double allowed = 5.0 / sqrt(2.0 * (double)runs) + 0.04;
    imk_model model;
    imk_device_model(imk_device_find("navigation"), &model);
    for (size_t k = 0; k < sizeof latitudes / sizeof *latitudes; k++) {
        imk_drift_settings settings = imk_drift_default();
        settings.latitude = latitudes[k] * degree;
        settings.yaw = 0.5;
        settings.rate = 1.0;
        settings.time = times;
        settings.time_count = TIMES;
        for (int i = 0; i < STATES; i++)
            settings.initial_sigma[i] = i < 2 ? 20.0 : i < 6 ? 0.0 : 0.01 * degree;
        const size_t size = imk_drift_runs_workspace_size(&model, &settings);
        void *memory = aligned_alloc(64, (size + 63) / 64 * 64);
        assert_non_null(memory);
        double square[TIMES][3] = {{0.0}}, errors[IMK_DRIFT_LANES][TIMES][STATES];
        for (uint32_t first = 0; first < runs; first += IMK_DRIFT_LANES) {
            CHECK_OK(imk_drift_runs(&model, &settings, 3, first, IMK_DRIFT_LANES, &errors[0][0][0],
                                    memory, size, NULL));
            for (int run = 0; run < IMK_DRIFT_LANES; run++)
                for (int t = 0; t < TIMES; t++)
                    for (int i = 0; i < 3; i++)
                        square[t][i] += errors[run][t][6 + i] * errors[run][t][6 + i];
        }
        free(memory);
        for (int t = 0; t < TIMES; t++) {
            const imk_drift_moments m = moments_at(&model, settings, times[t]);
            for (int i = 0; i < 3; i++) {
                const double stated =
                    sqrt(m.covariance[6 + i][6 + i] + m.mean[6 + i] * m.mean[6 + i]);
                CHECK_CLOSE(sqrt(square[t][i] / (double)runs) / stated, 1.0, allowed);
            }
        }
    }
}

static void odd_senses_are_refused(void **state)
{
    (void)state;
    imk_model model;
    imk_error error;
    imk_model_default(&model);
    imk_drift_settings settings = imk_drift_default();
    const double time = 1.0;
    settings.time = &time;
    settings.time_count = 1;
    CHECK_OK(imk_drift_validate(&model, &settings, NULL));
    settings.attitude_errors = (imk_attitude_errors)2;
    CHECK_STATUS(imk_drift_validate(&model, &settings, &error), IMK_ERROR_RANGE);
    assert_string_equal(error.field, "attitude_errors");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tilt_after_a_period_is_not_displayed),
        cmocka_unit_test(heading_follows_the_position),
        cmocka_unit_test(runs_have_the_stated_errors),
        cmocka_unit_test(odd_senses_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
