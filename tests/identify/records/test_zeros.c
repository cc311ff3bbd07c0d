/* SPDX-License-Identifier: Apache-2.0 */
/* Zeros that stand for lost rows, small values put to zero, values cut off toward zero: told apart
 * from zeros that are measurements. */
enum { SCREENED_SAMPLES = 60000 };
#include "screened_noise.h"

#include <math.h>
#include <string.h>

static double clean[N];

static void round_to(double step)
{
    for (size_t i = 0; i < N; i++)
        rate[i] = step * nearbyint(rate[i] / step);
}

/* Lost rows are left out, however many, and the noise beside them is the noise. */
static void test_lost(void **state)
{
    (void)state;
    static const size_t every[] = {5000, 100, 20, 5};
    for (size_t k = 0; k < 4; k++) {
        size_t lost, written = 0;
        make(k, 9.8, 0, 0);
        for (size_t i = every[k] / 2; i < N; i += every[k], written++)
            rate[i] = 0;
        const imk_screen found = screen();
        assert_int_equal(found.lost.count, written);
        assert_int_equal(found.lost.runs, written);
        assert_int_equal(found.lost.first, every[k] / 2);
        assert_int_equal(found.outliers.count, 0);
        assert_true(found.zeros == 0 && !found.heavy_tails);
        imk_screen_settings settings = imk_screen_default();
        settings.dt = 0.01;
        memcpy(clean, rate, sizeof rate);
        CHECK_OK(imk_screen_apply(&settings, &found, IMK_SCREEN_ALL, N, clean, &lost, memory,
                                  sizeof memory, NULL));
        assert_int_equal(lost, written);
        for (size_t i = 0; i < N; i++)
            assert_int_equal(isnan(clean[i]), rate[i] == 0);
    }
}

/* So are other values that stand for them; a single one is an outlier. */
static void test_code(void **state)
{
    (void)state;
    static const double code[] = {-32768, 999, 1e9, 40};
    for (size_t k = 0; k < 4; k++)
        for (size_t every = 97; every < 3000; every += 1400) {
            size_t written = 0;
            make(k, 3, 0, k % 2 ? 0.01 : 0);
            for (size_t i = 50; i < N; i += every, written++)
                rate[i] = code[k];
            const imk_screen found = screen();
            assert_int_equal(found.lost.count, written);
            assert_true(found.lost_value == code[k]);
            assert_int_equal(found.outliers.count, 0);
            assert_false(found.heavy_tails);
            assert_true(found.resolution == 0);
            make(k, 3, 0, 0);
            rate[1000] = code[k];
            assert_int_equal(screen().lost.count, 0);
        }
}

/* Values below a limit are put to zero; all are cut off toward zero. */
static void test_too_many(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 6; seed++) {
        make(seed, 0.3, 0, 0);
        round_to(0.01);
        for (size_t i = 0; i < N; i++)
            rate[i] = fabs(rate[i]) < 0.5 ? 0 : rate[i];
        /* P(|x + 0.3| < 0.5), less those of the steps around */
        CHECK_CLOSE(screen().zeros, 0.367, 0.02);
        const double step = seed % 2 ? 0.2 : 0.6;
        make(seed, 0.2, 0, 0);
        for (size_t i = 0; i < N; i++)
            rate[i] = step * trunc(rate[i] / step);
        /* A cell of zeros twice as wide. */
        CHECK_CLOSE(screen().zeros / step, 0.39, 0.08);
        make(seed, 0.1, 0, 0);
        for (size_t i = 0; i < N; i++) /* not rounded, rarely zero */
            rate[i] = i % 20 == 0 ? 0 : rate[i];
        CHECK_CLOSE(screen().zeros, 0.05, 0.001);
    }
}

/* Rounded noise about any level near zero, with or without slow noise, has no zeros too many: none
 * of 120 records. */
static void test_sound(void **state)
{
    (void)state;
    static const double steps[] = {0.02, 0.1, 0.15, 0.3, 0.5, 0.8, 1, 1.3, 1.6, 2};
    for (uint64_t seed = 0; seed < 24; seed++) {
        if (check_skips(seed, 5))
            continue;
        const double level = 0.13 * (double)(seed % 8);
        make(seed, level, 0, seed % 3 ? 0 : 0.01);
        memcpy(clean, rate, sizeof rate);
        for (size_t k = seed / 3 % 2; k < sizeof steps / sizeof *steps; k += 2) {
            memcpy(rate, clean, sizeof rate);
            round_to(steps[k]);
            if (seed % 3 == 2) /* and some that are no multiples */
                for (size_t i = 0; i < N / 5; i++)
                    rate[i] += 0.3 * sin(0.013 * (double)i);
            const imk_screen found = screen();
            assert_true(found.zeros == 0);
            assert_int_equal(found.lost.count, 0);
        }
    }
}

/* Noise of Laplace's density, which has a corner where it is densest: x1 x2 + x3 x4 of normal
 * numbers. Its standard deviation is 1. */
static void make_laplace(uint64_t seed, double level)
{
    static double z[4][N];
    for (uint32_t k = 0; k < 4; k++)
        imk_random_normals(imk_random_seeded(seed), imk_stream(k, 1, 0, 0), 0, N, z[k]);
    for (size_t i = 0; i < N; i++)
        rate[i] = level + (z[0][i] * z[1][i] + z[2][i] * z[3][i]) / sqrt(2);
}

/* Nor has rounded noise with heavy tails, of whose values zero is the most frequent. */
static void test_sound_with_heavy_tails(void **state)
{
    (void)state;
    static const double steps[] = {0.04, 0.1, 0.12, 0.2, 0.3, 0.5, 0.8, 1};
    for (uint64_t seed = 0; seed < 16; seed++) {
        if (check_skips(seed, 5))
            continue;
        make_laplace(seed, 0.05 * (double)(seed % 4));
        memcpy(clean, rate, sizeof rate);
        for (size_t k = seed / 4 % 2; k < sizeof steps / sizeof *steps; k += 2) {
            memcpy(rate, clean, sizeof rate);
            round_to(steps[k]);
            assert_true(screen().zeros == 0);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_lost),
        cmocka_unit_test(test_code),
        cmocka_unit_test(test_too_many),
        cmocka_unit_test(test_sound),
        cmocka_unit_test(test_sound_with_heavy_tails),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
