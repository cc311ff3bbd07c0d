/* SPDX-License-Identifier: Apache-2.0 */
/* Values that end abruptly: limited, folded, rectified, wrapped, replaced; and noise that ends as
 * noise does. */
enum { SCREENED_SAMPLES = 60000 };
#include "screened_noise.h"

#include <math.h>

typedef double (*distortion)(double x);
static double clip(double x) /* and a calibration behind it, which leaves no two values equal */
{
    return fmax(fmin(x, 1.5), -1.5) + 0.01 * sin(1e4 * x);
}
static double fold(double x)
{
    return fabs(x) > 2 ? copysign(4, x) - x : x;
}
static double rectify(double x)
{
    return fabs(x - 0.7);
}
static double wrap(double x)
{
    return x - 3 * nearbyint(x / 3);
}
static double compress(double x)
{
    return 1.5 * tanh(x / 1.5);
}
static double replace(double x)
{
    return fabs(x) > 2.5 ? 0.01 * sin(1e4 * x) : x;
}

static void test_abrupt(void **state)
{
    (void)state;
    static const distortion all[] = {clip, fold, rectify, wrap, compress, replace};
    static const bool both[] = {true, true, false, true, true, true};
    for (size_t k = 0; k < sizeof all / sizeof *all; k++)
        for (uint64_t seed = 0; seed < 4; seed++) {
            make(seed, 0, 0, 0);
            for (size_t i = 0; i < N; i++)
                rate[i] = all[k](rate[i]);
            const imk_screen found = screen();
            assert_true(found.ends_low);
            assert_int_equal(found.ends_high, both[k]);
            assert_int_equal(found.saturated.count, 0);
            if (k == 0)
                CHECK_CLOSE(found.end_high, 1.5, 0.02);
        }
}

/* White and slow noise, behind a filter too, of Laplace's or Gauss' distribution, in steps or not:
 * none of 80 records ends abruptly. */
static void test_sound(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 80; seed++) {
        if (check_skips(seed, 11))
            continue;
        const bool heavy = seed % 5 == 2;
        make(seed, 0, !heavy && seed % 2 ? 0.5 : 0, !heavy && seed % 3 ? 0.02 : 0);
        double filtered = rate[0];
        for (size_t i = 0; i < N; i++) {
            filtered += (seed % 5 == 1 ? 0.02 : 0.3) * (rate[i] - filtered);
            const double step = seed % 7 == 2 ? 0.05 : 0.3;
            rate[i] = seed % 5 < 2 ? filtered : heavy ? rate[i] * fabs(rate[i]) : rate[i];
            if (seed % 7 < 3)
                rate[i] = step * nearbyint(rate[i] / step);
        }
        const imk_screen found = screen();
        assert_true(!found.ends_low && !found.ends_high);
    }
}

static void check_sound_in_steps(uint64_t seed, double step)
{
    make(seed, 0, 0, 0);
    for (size_t i = 0; i < N; i++)
        rate[i] = step * nearbyint(rate[i] / step);
    const imk_screen found = screen();
    assert_true(!found.ends_low && !found.ends_high);
}

/* Steps make the largest values equal: of white noise none ends abruptly. The first three have
 * thirty pieces in the last half of a standard deviation, as one record in a thousand. */
static void test_sound_in_steps(void **state)
{
    (void)state;
    static const double steps[] = {0.15, 0.2, 0.24, 0.3, 0.4, 0.49};
    check_sound_in_steps(3390, 0.24);
    check_sound_in_steps(4025, 0.49);
    check_sound_in_steps(4671, 0.49);
    for (uint64_t seed = 0; seed < 30; seed++)
        if (!check_skips(seed, 7))
            check_sound_in_steps(seed, steps[seed % 6]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_abrupt),
        cmocka_unit_test(test_sound),
        cmocka_unit_test(test_sound_in_steps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
