/* SPDX-License-Identifier: Apache-2.0 */
/* A sensor that was moved: at the start, in the middle, at the end; and what is no movement. */
enum { SCREENED_SAMPLES = 120000 };
#include "screened_noise.h"

#include <math.h>

/* Swings of some seconds in samples first … end - 1. */
static void swing(size_t first, size_t end, double amplitude)
{
    for (size_t i = first; i < end; i++)
        rate[i] += amplitude * sin(0.013 * (double)(i - first) + 0.4);
}

static void test_moved(void **state)
{
    (void)state;
    static const size_t place[][2] = {{0, 150},       {0, 3000},   {0, 40000},  {50000, 50800},
                                      {70000, 73000}, {118000, N}, {N - 200, N}};
    for (size_t k = 0; k < sizeof place / sizeof *place; k++)
        for (uint64_t seed = 0; seed < 4; seed++) {
            const size_t first = place[k][0], end = place[k][1];
            make(seed, 0, seed % 2 ? 0.3 : 0, 0.001);
            swing(first, end, 60);
            const imk_screen found = screen();
            assert_int_equal(found.moved.runs, 1);
            /* To three means of 64 samples, and those before and behind. */
            CHECK_CLOSE((double)found.moved.first, (double)first, 320);
            CHECK_CLOSE((double)found.move_end[0], (double)end, 320);
            assert_true(found.moved.first <= first && found.move_end[0] >= end);
            assert_int_equal(found.move_first[0], found.moved.first);
            assert_int_equal(found.moved.count, found.move_end[0] - found.moved.first);
            assert_true(!found.warm_up && found.steps.count == 0);
        }
}

static void test_twice(void **state)
{
    (void)state;
    make(9, 0, 0.3, 0);
    swing(0, 2000, 60);
    swing(90000, 91000, 60);
    const imk_screen found = screen();
    assert_int_equal(found.moved.runs, 2);
    assert_int_equal(found.move_first[0], 0);
    assert_in_range(found.move_end[0], 2000, 2320);
    assert_in_range(found.move_first[1], 89680, 90000);
    assert_in_range(found.move_end[1], 91000, 91320);
}

/* Slow noise however strong, tones, jumps, a warm-up, bursts of noise and holes are no movement. */
static void test_still(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 40; seed++) {
        const bool bursts = seed % 5 == 3; /* of white noise */
        make(seed, 0, bursts ? 0 : seed % 4 == 0 ? 5 : 0.3, !bursts && seed % 4 == 1 ? 0.3 : 0);
        for (size_t i = 0; i < N; i++) {
            const double x = (double)i;
            rate[i] += seed % 5 == 0   ? 20 * sin(0.002 * x)
                       : seed % 5 == 1 ? (i > 30000 ? 15 : 0) + (i > 80000 ? 9 : 0)
                       : seed % 5 == 2 ? 30 * exp(-x / 6000)
                                       : 0;
            rate[i] *= bursts && i % 10000 < 900 ? 6 : 1;
            if (seed % 5 == 4 && i % 30000 < 20000 && i % 997 > 3)
                rate[i] = (double)NAN;
        }
        assert_int_equal(screen().moved.count, 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_moved),
        cmocka_unit_test(test_twice),
        cmocka_unit_test(test_still),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
