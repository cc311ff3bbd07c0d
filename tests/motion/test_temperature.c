/* SPDX-License-Identifier: Apache-2.0 */
/* Temperature profiles against closed forms and a fine integration, and their independence of how
 * the times are asked for. */
#include "check.h"

#include "imukit/motion.h"

#include <string.h>

static const double point_time[] = {0.0, 100.0, 100.0, 300.0, 1000.0};
static const double point_value[] = {290.0, 290.0, 320.0, 320.0, 250.0};

static imk_temperature_profile profile_of(size_t points, double time_constant)
{
    return (imk_temperature_profile){.point_count = points,
                                     .time = point_time,
                                     .temperature = point_value,
                                     .time_constant = time_constant};
}

static void test_at_once(void **state)
{
    (void)state;
    const imk_temperature_profile profile = profile_of(5, 0.0);
    const double time[] = {-5.0, 0.0, 99.0, 100.0, 250.0, 300.0, 650.0, 1000.0, 1e6};
    /* the surroundings themselves; the slope is -70 K in 700 s */
    const double expected[] = {290.0, 290.0, 290.0, 320.0, 320.0, 320.0, 285.0, 250.0, 250.0};
    const double slope[] = {0.0, 0.0, 0.0, 0.0, 0.0, -0.1, -0.1, 0.0, 0.0};
    double temperature[9], rate[9];
    imk_temperature_at(&profile, 9, time, temperature, rate);
    for (int i = 0; i < 9; i++) {
        CHECK_CLOSE(temperature[i], expected[i], 1e-13);
        CHECK_CLOSE(rate[i], slope[i], 1e-16);
    }
    imk_temperature_at(&profile, 9, time, temperature, NULL);
}

static void test_step_and_ramp_in_closed_form(void **state)
{
    (void)state;
    for (double lag = 4.0; lag < 50.0; lag += 36.0) {
        const imk_temperature_profile profile = profile_of(5, lag);
        for (double s = 0.0; s < 200.0; s += 3.7) { /* 50 and 5 time constants */
            const double time = 100.0 + s;
            double temperature, rate;
            imk_temperature_at(&profile, 1, &time, &temperature, &rate);
            CHECK_CLOSE(temperature, 320.0 - 30.0 * exp(-s / lag), 2e-13);
            CHECK_CLOSE(rate, 30.0 / lag * exp(-s / lag), 4e-14 / lag);
        }
    }
    const double tau = 40.0;
    const imk_temperature_profile profile = profile_of(5, tau);
    /* On the ramp it lags by the slope times the time constant, once the transient has died. */
    const double late = 990.0;
    double temperature, rate;
    imk_temperature_at(&profile, 1, &late, &temperature, &rate);
    const double before = 30.0 * exp(-200.0 / tau); /* what was left of the step */
    CHECK_CLOSE(temperature, 251.0 + 0.1 * tau - (before + 0.1 * tau) * exp(-690.0 / tau), 3e-13);
    CHECK_CLOSE(rate, -0.1 + (before / tau + 0.1) * exp(-690.0 / tau), 1e-15);
}

/* Classical Runge-Kutta with 0.05 s: its error is (0.05/7)^4/120 of the change. */
static void test_against_integration(void **state)
{
    (void)state;
    enum { POINTS = 40 };
    double time[POINTS], value[POINTS];
    for (int i = 0; i < POINTS; i++) {
        time[i] = 10.0 * i;
        value[i] = 300.0 + 20.0 * sin(1.7 * i);
    }
    const imk_temperature_profile profile = {
        .point_count = POINTS, .time = time, .temperature = value, .time_constant = 7.0};
    double now = value[0];
    const double h = 0.05;
    for (int i = 0; i < (POINTS - 1) * 200; i++) {
        const double t = h * i;
        const int at = i / 200;
        const double slope = (value[at + 1] - value[at]) / 10.0;
        const double u0 = value[at] + slope * (t - time[at]), u1 = u0 + 0.5 * h * slope;
        const double k1 = (u0 - now) / 7.0, k2 = (u1 - (now + 0.5 * h * k1)) / 7.0;
        const double k3 = (u1 - (now + 0.5 * h * k2)) / 7.0;
        const double k4 = (u0 + h * slope - (now + h * k3)) / 7.0;
        double temperature, rate;
        if (i % 37 == 0) {
            imk_temperature_at(&profile, 1, &t, &temperature, &rate);
            CHECK_CLOSE(temperature, now, 1e-9);
            CHECK_CLOSE(rate, k1, 2e-10);
        }
        now += h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4);
    }
}

/* One by one, all at once, and with the points carried beforehand. */
static void test_division_does_not_matter(void **state)
{
    (void)state;
    enum { COUNT = 600 };
    double time[COUNT], all[2][COUNT], one[2][COUNT], carried[5], quick[2][COUNT];
    for (int i = 0; i < COUNT; i++)
        time[i] = 2.0 * i - 50.0;
    imk_temperature_profile profile = profile_of(5, 60.0);
    imk_temperature_at(&profile, COUNT, time, all[0], all[1]);
    for (int i = 0; i < COUNT; i++)
        imk_temperature_at(&profile, 1, &time[i], &one[0][i], &one[1][i]);
    imk_temperature_carry(&profile, carried);
    profile.carried = carried;
    imk_temperature_at(&profile, 100, time, quick[0], quick[1]);
    imk_temperature_at(&profile, COUNT - 100, time + 100, quick[0] + 100, quick[1] + 100);
    assert_memory_equal(all, one, sizeof all);
    assert_memory_equal(all, quick, sizeof all);
    /* times that come more often than points, and less often, with a time constant far below */
    profile = profile_of(5, 1e-9);
    imk_temperature_at(&profile, COUNT, time, all[0], all[1]);
    profile.time_constant = 0.0;
    imk_temperature_at(&profile, COUNT, time, one[0], one[1]);
    for (int i = 0; i < COUNT; i++)
        if (time[i] != 0.0 && time[i] != 100.0 && time[i] != 300.0 && time[i] != 1000.0) {
            CHECK_CLOSE(all[0][i], one[0][i], 2e-10);
            CHECK_CLOSE(all[1][i], one[1][i], 1e-16);
        }
}

static void test_odd_profiles_are_refused(void **state)
{
    (void)state;
    imk_error error;
    imk_temperature_profile profile = profile_of(5, 1.0);
    CHECK_OK(imk_temperature_validate(&profile, &error));
    profile.point_count = 0;
    CHECK_STATUS(imk_temperature_validate(&profile, &error), IMK_ERROR_EMPTY);
    profile = profile_of(5, -1.0);
    CHECK_STATUS(imk_temperature_validate(&profile, &error), IMK_ERROR_RANGE);
    profile = profile_of(5, (double)NAN);
    CHECK_STATUS(imk_temperature_validate(&profile, &error), IMK_ERROR_NOT_FINITE);
    double time[] = {0.0, 2.0, 1.0}, value[] = {300.0, 300.0, 0.0};
    profile = (imk_temperature_profile){.point_count = 3, .time = time, .temperature = value};
    CHECK_STATUS(imk_temperature_validate(&profile, &error), IMK_ERROR_TIME_ORDER);
    assert_int_equal(error.index, 2);
    time[2] = 3.0;
    CHECK_STATUS(imk_temperature_validate(&profile, &error), IMK_ERROR_RANGE);
    assert_int_equal(error.index, 2);
    value[2] = (double)INFINITY;
    CHECK_STATUS(imk_temperature_validate(&profile, &error), IMK_ERROR_NOT_FINITE);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_at_once),
        cmocka_unit_test(test_step_and_ramp_in_closed_form),
        cmocka_unit_test(test_against_integration),
        cmocka_unit_test(test_division_does_not_matter),
        cmocka_unit_test(test_odd_profiles_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
