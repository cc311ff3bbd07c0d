/* SPDX-License-Identifier: Apache-2.0 */
/* Allan deviations of records with missing samples. */
#include "check.h"
#include "imukit/allan_gaps.h"
#include "imukit/noise.h"

#include <string.h>

enum { N = 4096, FACTORS = 9 };

static double rate[N];
static char workspace[64 + 64 * (N + 8192)];
static size_t factors[FACTORS];

static void octaves(void)
{
    for (size_t i = 0; i < FACTORS; i++)
        factors[i] = (size_t)1 << i;
}

static void evaluate(size_t n, bool robust, size_t count, const size_t *m,
                     imk_allan_gap_point *points)
{
    imk_allan_gaps_settings settings = imk_allan_gaps_default();
    settings.robust = robust;
    assert_true(imk_allan_gaps_workspace_size(n) <= sizeof workspace);
    assert_int_equal(imk_allan_gaps_points(&settings, n, rate, count, m, points, NULL, workspace,
                                           sizeof workspace),
                     IMK_OK);
}

/* Nothing missing: the ordinary deviation, to the last bit. */
static void test_complete_record(void **state)
{
    (void)state;
    static double sums[N + 1];
    static size_t all[N / 2];
    static imk_allan_gap_point p[N / 2];
    static imk_allan_point q[N / 2];
    imk_random_normals(imk_random_seeded(1), 5, 0, N, rate);
    for (size_t i = 0; i < N / 2; i++)
        all[i] = i + 1;
    const imk_allan_settings settings = imk_allan_default();
    imk_allan_sums(N, rate, sums, NULL);
    assert_int_equal(imk_allan_points(&settings, N, sums, N / 2, all, q, NULL), IMK_OK);
    evaluate(N, false, N / 2, all, p);
    for (size_t i = 0; i < N / 2; i++) {
        assert_true(p[i].point.deviation == q[i].deviation && p[i].point.lower == q[i].lower &&
                    p[i].point.upper == q[i].upper && p[i].point.type == q[i].type);
        assert_true(p[i].used == 1 && p[i].fullness == 1 && p[i].resolved);
    }
}

/* The definition, literally, where holes are as short as chance makes them. */
static double by_definition(size_t n, size_t m, double *fullness)
{
    double terms = 0, weights = 0, squares = 0, degrees = 0, full = 0;
    size_t count = 0, present = 0;
    for (size_t i = 0; i < n; i++)
        present += isfinite(rate[i]);
    const double least = fmax(ceil(0.5 * (double)present / (double)n * (double)m), 1);
    for (size_t j = 0; j + 2 * m <= n; j++) {
        double sum[2] = {0}, there[2] = {0};
        for (size_t i = 0; i < 2 * m; i++)
            if (isfinite(rate[j + i])) {
                sum[i / m] += rate[j + i];
                there[i / m] += 1;
            }
        if (there[0] < least || there[1] < least)
            continue;
        const double d = sum[1] / there[1] - sum[0] / there[0];
        const double weight = 2 / (double)m / (1 / there[0] + 1 / there[1]);
        terms += weight * d * d;
        weights += weight;
        full += (there[0] + there[1]) / (2 * (double)m);
        count++;
    }
    for (size_t c = 0; (c + 1) * m <= n; c++) {
        double mean = 0, there = 0;
        for (size_t i = c * m; i < (c + 1) * m; i++) {
            mean += isfinite(rate[i]) ? rate[i] : 0;
            there += isfinite(rate[i]);
        }
        if (there < 2)
            continue;
        mean /= there;
        for (size_t i = c * m; i < (c + 1) * m; i++)
            squares += isfinite(rate[i]) ? (rate[i] - mean) * (rate[i] - mean) : 0;
        degrees += there - 1;
    }
    *fullness = full / (double)count;
    const double inside = degrees > 0 ? squares / degrees : 0;
    return terms / weights / 2 - inside / (double)m * ((double)count / weights - 1);
}

static void test_definition(void **state)
{
    (void)state;
    enum { SHORT = 700 };
    uint32_t word[SHORT];
    const size_t m[] = {1, 2, 3, 7, 20, 64};
    imk_allan_gap_point p[6];
    imk_random_normals(imk_random_seeded(2), 5, 0, SHORT, rate);
    imk_random_words(imk_random_seeded(2), 6, 0, SHORT, word);
    for (size_t i = 0; i < SHORT; i++)
        rate[i] = word[i] < 600000000u ? (double)NAN : rate[i] + 0.01 * (double)i;
    evaluate(SHORT, false, 6, m, p);
    for (size_t i = 0; i < 6; i++) {
        double fullness;
        const double expected = by_definition(SHORT, m[i], &fullness);
        /* Sums of some hundred terms. */
        CHECK_RELATIVE(p[i].point.deviation * p[i].point.deviation, expected, 1e-11);
        CHECK_RELATIVE(p[i].fullness, fullness, 1e-12);
        assert_true(p[i].resolved);
    }
}

/* The mean over every way to miss one sample of each cluster is the variance of the complete
 * record, whatever the values: theory of sampling without replacement. */
static void test_no_bias_for_any_values(void **state)
{
    (void)state;
    static const double value[8] = {0.3, -1.7, 2.2, 0.9, 17, 14.5, 19.1, 16.6};
    const double first = (0.3 - 1.7 + 2.2 + 0.9) / 4, second = (17 + 14.5 + 19.1 + 16.6) / 4;
    const size_t m = 4;
    double sum = 0;
    for (size_t a = 0; a < 4; a++)
        for (size_t b = 4; b < 8; b++) {
            imk_allan_gap_point p;
            memcpy(rate, value, sizeof value);
            rate[a] = rate[b] = NAN;
            evaluate(8, false, 1, &m, &p);
            assert_true(p.resolved && p.point.count == 1);
            sum += p.point.deviation * p.point.deviation / 16;
        }
    CHECK_RELATIVE(sum, (second - first) * (second - first) / 2, 1e-13);
}

static void take_out(int mask, uint32_t run)
{
    static uint32_t word[N];
    imk_random_words(imk_random_seeded(4), imk_stream(run, 9, 0, 0), 0, N, word);
    for (size_t i = 0; i < N; i++)
        if (mask == 1 ? word[i / 20] < 858993459u : word[i] < 858993459u)
            rate[i] = NAN;
}

/* Unbiased, and the intervals hold what they say: noise of three terms, samples missing at random
 * and in holes. 240 records; per point the mean stays within 5 of its standard errors (5.7e-7), and
 * the share of 95 % intervals that cover between 0.88 and 0.995 (binomial: 2e-6 below with all 9
 * factors of both masks, and coverage of 0.95). */
static void test_bias_and_coverage(void **state)
{
    (void)state;
    enum { RECORDS = 240 };
    static imk_white_state white;
    static imk_flicker_state flicker;
    static imk_random_walk_state walk;
    const imk_random random = imk_random_seeded(3);
    octaves();
    for (int mask = 0; mask < 2; mask++) {
        double sum[FACTORS] = {0}, squares[FACTORS] = {0};
        size_t covered[FACTORS] = {0};
        double truth[FACTORS];
        for (uint32_t run = 0; run < RECORDS; run++) {
            imk_allan_gap_point p[FACTORS];
            memset(rate, 0, sizeof rate);
            imk_white_start(&white, 1, 1, random, imk_stream(run, 1, 0, 0));
            imk_white_add(&white, N, rate);
            imk_flicker_start(&flicker, (imk_flicker){0.3, 0}, 1, random, imk_stream(run, 2, 0, 0));
            imk_flicker_add(&flicker, N, rate);
            imk_random_walk_start(&walk, 0.03, 1, random, imk_stream(run, 3, 0, 0));
            imk_random_walk_add(&walk, N, rate);
            take_out(mask, run);
            evaluate(N, false, FACTORS, factors, p);
            for (size_t i = 0; i < FACTORS; i++) {
                truth[i] =
                    imk_white_sampled_allan_variance(1, 1, factors[i]) +
                    imk_flicker_sampled_allan_variance((imk_flicker){0.3, 0}, 1, factors[i]) +
                    imk_random_walk_sampled_allan_variance(0.03, 1, factors[i]);
                const double v = p[i].point.deviation * p[i].point.deviation;
                sum[i] += v;
                squares[i] += v * v;
                covered[i] +=
                    p[i].point.lower <= sqrt(truth[i]) && sqrt(truth[i]) <= p[i].point.upper;
            }
        }
        for (size_t i = 0; i < FACTORS; i++) {
            const double mean = sum[i] / RECORDS;
            const double sd = sqrt(squares[i] / RECORDS - mean * mean);
            CHECK_CLOSE(mean, truth[i], 5 * sd / sqrt(RECORDS));
            CHECK_CLOSE((double)covered[i] / RECORDS, 0.9375, 0.0575);
        }
    }
}

/* 0.1 % of samples 50 sigma off, in bursts too, move the robust deviation by less than 2 %, where
 * the plain one doubles. */
static void test_robust(void **state)
{
    (void)state;
    imk_allan_gap_point clean[FACTORS], dirty[FACTORS], plain[FACTORS];
    octaves();
    for (uint32_t run = 0; run < 5; run++) {
        imk_random_normals(imk_random_seeded(7), run, 0, N, rate);
        for (size_t i = 0; i < N; i++)
            rate[i] += 9.8;
        evaluate(N, true, FACTORS - 2, factors, clean);
        rate[100] += 50;
        rate[2000] -= 50;
        rate[2001] -= 50;
        rate[3500] += 50;
        evaluate(N, true, FACTORS - 2, factors, dirty);
        evaluate(N, false, FACTORS - 2, factors, plain);
        for (size_t i = 0; i < FACTORS - 2; i++)
            CHECK_RELATIVE(dirty[i].point.deviation, clean[i].point.deviation, 0.02);
        assert_true(plain[0].point.deviation > 1.5 * clean[0].point.deviation);
        /* Consistent for Gaussian noise: 4096 squares, sd of the deviation 1.4 % at m = 1. */
        CHECK_RELATIVE(clean[0].point.deviation, 1, 0.07);
    }
}

/* Gravity costs no digits; a hole in which clusters fit leaves those on both sides. */
static void test_large_constant_and_hole(void **state)
{
    (void)state;
    static imk_allan_gap_point p[FACTORS], q[FACTORS];
    octaves();
    imk_random_normals(imk_random_seeded(8), 1, 0, N, rate);
    for (size_t i = 0; i < N; i++) /* on a grid of 2^-20: adding 2^23 loses nothing */
        rate[i] = i >= 1000 && i < 1500 ? (double)NAN : floor(ldexp(rate[i], 20)) / 1048576;
    evaluate(N, false, FACTORS, factors, p);
    for (size_t i = 0; i < N; i++)
        rate[i] += 8388608;
    evaluate(N, false, FACTORS, factors, q);
    for (size_t i = 0; i < FACTORS; i++) {
        CHECK_RELATIVE(q[i].point.deviation, p[i].point.deviation, 1e-9);
        /* Pairs that touch the hole are left out up to where it is small: 499 + 2 m of N. */
        assert_true(factors[i] > 64 ||
                    p[i].point.count == N - 2 * factors[i] + 1 - (500 + 2 * factors[i] - 1));
        assert_true(p[i].correction == 0 || factors[i] > 64);
    }
}

static void test_refusals(void **state)
{
    (void)state;
    imk_allan_gaps_settings settings = imk_allan_gaps_default();
    imk_allan_gap_point p;
    size_t m = 3;
    for (size_t i = 0; i < 100; i++)
        rate[i] = i == 50 ? 1 : (double)NAN;
    const size_t size = imk_allan_gaps_workspace_size(100);
    assert_int_equal(imk_allan_gaps_points(&settings, 100, rate, 1, &m, &p, NULL, workspace, size),
                     IMK_ERROR_TOO_SHORT);
    rate[51] = 2;
    assert_int_equal(imk_allan_gaps_points(&settings, 100, rate, 1, &m, &p, NULL, workspace, size),
                     IMK_OK);
    assert_true(p.point.count == 0 || p.point.deviation > 0);
    /* Values whose squares overflow have no variance, and their noise no type. */
    for (size_t i = 0; i < 100; i++)
        rate[i] = i == 50 ? 1e160 : i == 52 ? (double)NAN : sin((double)i);
    m = 1;
    assert_int_equal(imk_allan_gaps_points(&settings, 100, rate, 1, &m, &p, NULL, workspace, size),
                     IMK_ERROR_NOT_FINITE);
    m = 51;
    assert_int_equal(imk_allan_gaps_points(&settings, 100, rate, 1, &m, &p, NULL, workspace, size),
                     IMK_ERROR_RANGE);
    m = 3;
    assert_int_equal(
        imk_allan_gaps_points(&settings, 100, rate, 1, &m, &p, NULL, workspace, size - 1),
        IMK_ERROR_WORKSPACE);
    settings.confidence = NAN;
    assert_int_equal(imk_allan_gaps_points(&settings, 100, rate, 1, &m, &p, NULL, workspace, size),
                     IMK_ERROR_RANGE);
    settings.cookie = 0;
    assert_int_equal(imk_allan_gaps_points(&settings, 100, rate, 1, &m, &p, NULL, workspace, size),
                     IMK_ERROR_UNINITIALISED);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_complete_record),
        cmocka_unit_test(test_definition),
        cmocka_unit_test(test_no_bias_for_any_values),
        cmocka_unit_test(test_bias_and_coverage),
        cmocka_unit_test(test_robust),
        cmocka_unit_test(test_large_constant_and_hole),

        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
