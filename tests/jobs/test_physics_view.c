/* SPDX-License-Identifier: Apache-2.0 */
/* Views of instruments show what their titles say, with the view's own input and with another. */
#include "check.h"

#include "imukit/physics_log.h"

#include <math.h>

#define DEGREE 0.017453292519943295

static imk_error error;

/* The view that a title begins with; at `rate`, or with its own input if that is NaN. */
static imk_physics_view view_of(const char *name, const char *title, double rate)
{
    static double design[512]; /* more than any */
    imk_physics_log_settings s = imk_physics_log_default();
    imk_physics_view view;
    s.instrument = imk_instrument_find(name);
    assert_in_range(s.instrument->design_size, 1, sizeof design);
    s.instrument->set_default(design);
    s.design = design;
    s.view_input = isfinite(rate);
    s.input.exposure.angular_rate[0] = isfinite(rate) ? rate : 0;
    const int index = imk_physics_view_find(s.instrument, title);
    assert_true(index >= 0);
    assert_int_equal(imk_physics_view_run(&s, (size_t)index, NULL, &view, &error), IMK_OK);
    return view;
}

static double span_of(const double *y, size_t count)
{
    double low = y[0], high = y[0];
    for (size_t i = 1; i < count; i++) {
        low = fmin(low, y[i]);
        high = fmax(high, y[i]);
    }
    return high - low;
}

/* At 10 deg/s the phase grows by 1000 rad in the time of the view, and kicks are 0.01 rad. */
static void test_kicks_without_ramp(void **state)
{
    (void)state;
    imk_physics_view view = view_of("ring_laser", "kicks", 10 * DEGREE);
    const double *y = view.data + view.points;
    CHECK_CLOSE(y[0], 0.0, 0.0);
    CHECK_CLOSE(y[view.points - 1], 0.0, 1e-9);
    assert_true(span_of(y, view.points) > 0.005 && span_of(y, view.points) < 0.5);
    imk_physics_view_free(&view);
}

/* The light has the power of the raised cosine: the detector's noise is added behind it. */
static void test_light_on_its_fringe(void **state)
{
    (void)state;
    imk_physics_view view = view_of("fibre_optic", "light", 10 * DEGREE);
    const double *x = view.data, *y = x + view.points;
    const double *law = y + view.points + view.law_points;
    static double design[512];
    view.instrument->set_default(design);
    assert_true(view.law_points > 100);
    /* Displayed in rad and uW. Taylor's series of the simulation are exact to the last digits. */
    for (size_t i = 0; i < view.points; i++)
        CHECK_CLOSE(y[i], view.view.law(design, x[i]) * 1e6, 1e-6);
    /* Over a whole fringe from bright (1 + V) to dark (1 - V). */
    CHECK_CLOSE(span_of(law, view.law_points), 39.0, 1.0);
    imk_physics_view_free(&view);
}

/* A nutation of 300 Hz in a view of a minute: two rows that follow one another hold its extremes,
 * nearly 0.008 deg apart, less what friction takes in half a second. */
static void test_quick_nutation_in_slow_view(void **state)
{
    (void)state;
    imk_physics_view view = view_of("free_gyro", "the gimbals", (double)NAN);
    const double *inner = view.data + 2 * view.points;
    assert_int_equal(view.points % 2, 0);
    size_t row = 0;
    for (; view.data[row + 1] < 0.5; row += 2)
        assert_true(fabs(inner[row + 1] - inner[row]) > 0.005);
    assert_true(row > 20);
    imk_physics_view_free(&view);
}

/* The ball falls by the view's own force, whatever the rate. */
static void test_force_of_view(void **state)
{
    (void)state;
    imk_physics_view view = view_of("suspended_rotor", "the ball falls", 10 * DEGREE);
    assert_false(view.empty);
    assert_true(span_of(view.data + view.points, view.points) > 4.0); /* um: to its stop */
    imk_physics_view_free(&view);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_kicks_without_ramp), cmocka_unit_test(test_light_on_its_fringe),
        cmocka_unit_test(test_quick_nutation_in_slow_view), cmocka_unit_test(test_force_of_view)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
