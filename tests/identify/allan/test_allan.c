/* SPDX-License-Identifier: Apache-2.0 */
/* Allan deviations against published tables, their confidence against theory and against draws. */
#include "check.h"

#include "imukit/allan.h"
#include "imukit/distributions.h"
#include "imukit/noise.h"
#include "imukit/random.h"
#include "imukit/samples.h"

#include <stdlib.h>
#include <string.h>

enum { TABLE = 1000 };

/* The 1000-point set of [RILEY2008], section 12.4: n <- 16807 n mod 2147483647. */
static void published_set(double *y)
{
    uint64_t value = 1234567890;
    for (size_t i = 0; i < TABLE; i++) {
        y[i] = (double)value / 2147483647.0;
        value = 16807 * value % 2147483647;
    }
}

/* Ten digits are printed: half a unit of the last. */
static const double PRINTED = 0.5000001e-10;

static void test_published_deviations(void **state)
{
    (void)state;
    static const size_t factors[] = {1, 10, 100};
    static const double overlapping[] = {.2922318781, .0915995342, .0324134303};
    static const double plain[] = {.2922318781, .0996573606, .0389780433};
    double y[TABLE], s[TABLE + 1], variances[3];
    size_t counts[3];
    published_set(y);
    imk_allan_sums(TABLE, y, s, NULL);
    CHECK_STATUS(
        imk_allan_variances(IMK_ALLAN_OVERLAPPING, TABLE, s, 3, factors, variances, counts, NULL),
        IMK_OK);
    for (size_t i = 0; i < 3; i++)
        CHECK_CLOSE(sqrt(variances[i]), overlapping[i], PRINTED);
    assert_int_equal(counts[2], 801);
    imk_allan_variances(IMK_ALLAN_PLAIN, TABLE, s, 3, factors, variances, counts, NULL);
    for (size_t i = 0; i < 3; i++)
        CHECK_CLOSE(sqrt(variances[i]), plain[i], PRINTED);
    assert_int_equal(counts[2], 9);
}

/* OADEV at octaves, printed to nine digits [RILEY2008]. */
static void test_published_octaves(void **state)
{
    (void)state;
    static const double expected[] = {.292231878, .201016042, .144791307, .105703850, .061914778,
                                      .048082143, .036237213, .027673856, .010282218};
    double y[TABLE], s[TABLE + 1], variances[9];
    size_t factors[16];
    published_set(y);
    imk_allan_sums(TABLE, y, s, NULL);
    assert_int_equal(imk_allan_factors(IMK_ALLAN_OCTAVE, TABLE, factors), 9);
    imk_allan_variances(IMK_ALLAN_OVERLAPPING, TABLE, s, 9, factors, variances, NULL, NULL);
    for (size_t i = 0; i < 9; i++)
        CHECK_CLOSE(sqrt(variances[i]), expected[i], 0.5000001e-9);
}

/* The ten phase points of [RILEY2008], section 12.2, as nine frequencies. */
static void test_published_nine(void **state)
{
    (void)state;
    static const double y[9] = {892, 809, 823, 798, 671, 644, 883, 903, 677};
    static const size_t factors[] = {1, 2};
    double s[10], variances[2];
    imk_allan_sums(9, y, s, NULL);
    imk_allan_variances(IMK_ALLAN_OVERLAPPING, 9, s, 2, factors, variances, NULL, NULL);
    CHECK_CLOSE(sqrt(variances[0]), 91.229449741, 0.5000001e-9);
    CHECK_CLOSE(sqrt(variances[1]), 85.952869838, 0.5000001e-9);
    imk_allan_variances(IMK_ALLAN_PLAIN, 9, s, 2, factors, variances, NULL, NULL);
    CHECK_CLOSE(sqrt(variances[1]), 115.808210705, 0.5000001e-9);
}

/* 68.3 % intervals that Stable32 prints for the 1000-point set, to within 2e-3 relative: its
 * degrees of freedom are Greenhall and Riley's, rounded. */
static void test_published_intervals(void **state)
{
    (void)state;
    static const size_t factors[] = {1, 16, 128};
    static const double lower[] = {.28515, .057696, .023045};
    static const double upper[] = {.29987, .067217, .037027};
    double y[TABLE], s[TABLE + 1];
    imk_allan_point points[3];
    imk_allan_settings settings = imk_allan_default();
    settings.confidence = 0.683;
    settings.greenhall_riley = true;
    published_set(y);
    imk_allan_sums(TABLE, y, s, NULL);
    CHECK_STATUS(imk_allan_points(&settings, TABLE, s, 3, factors, points, NULL), IMK_OK);
    for (size_t i = 0; i < 3; i++) {
        assert_int_equal(points[i].type, IMK_WHITE_RATE);
        CHECK_RELATIVE(points[i].lower, lower[i], 2e-3);
        CHECK_RELATIVE(points[i].upper, upper[i], 2e-3);
    }
    CHECK_CLOSE(points[0].edf, 782.03, 0.005);
}

/* Exact degrees of freedom for independent samples. At m = 1 by hand: r = 6, -4, 1 (in units of the
 * sums' increments 2, -1), so edf = M 4/(4 + 2 (1 - 1/M)) with M = 999. */
static void test_exact_degrees_of_freedom(void **state)
{
    (void)state;
    const double m = 999;
    CHECK_RELATIVE(imk_allan_edf_exact(IMK_ALLAN_OVERLAPPING, IMK_WHITE_RATE, TABLE, 1),
                   m * 4 / (4 + 2 * (1 - 1 / m)), 1e-12);
    CHECK_CLOSE(imk_allan_edf_exact(IMK_ALLAN_OVERLAPPING, IMK_WHITE_RATE, TABLE, 16), 91.15,
                0.005);
    /* Independent increments of a random walk make independent second differences at m = 1. */
    CHECK_RELATIVE(imk_allan_edf_exact(IMK_ALLAN_OVERLAPPING, IMK_RANDOM_WALK_RATE, TABLE, 1), m,
                   1e-12);
    /* The scaled form beyond m = 256 joins the full one. */
    CHECK_RELATIVE(imk_allan_edf_exact(IMK_ALLAN_OVERLAPPING, IMK_WHITE_RATE, 1000000, 257) * 257,
                   imk_allan_edf_exact(IMK_ALLAN_OVERLAPPING, IMK_WHITE_RATE, 1000000, 256) * 256,
                   1e-3);
}

/* Draws: 2 mean^2/variance of the Allan variance over many records is the degrees of freedom. With
 * R records the ratio has a relative standard deviation of about sqrt(2/R + 8/(edf R)); 5.5 of them
 * are exceeded by chance in 4e-8 of trials. */
static void test_degrees_of_freedom_by_draws(void **state)
{
    (void)state;
    enum { N = 256, RECORDS = 4000, M = 8 };
    static double y[N], s[N + 1];
    const imk_random random = imk_random_seeded(7);
    const size_t m = M;
    double mean = 0, square = 0;
    for (uint64_t r = 0; r < RECORDS; r++) {
        double variance;
        imk_random_normals(random, 1, r * N, N, y);
        imk_allan_sums(N, y, s, NULL);
        imk_allan_variances(IMK_ALLAN_OVERLAPPING, N, s, 1, &m, &variance, NULL, NULL);
        mean += variance / RECORDS;
        square += variance * variance / RECORDS;
    }
    const double edf = imk_allan_edf_exact(IMK_ALLAN_OVERLAPPING, IMK_WHITE_RATE, N, M);
    /* The mean was removed from each record, which takes 1e-3 here. */
    CHECK_RELATIVE(2 * mean * mean / (square - mean * mean), edf,
                   5.5 * sqrt((2 + 8 / edf) / RECORDS) + 2e-3);
    CHECK_RELATIVE(mean, 1.0 / M, 5.5 * sqrt(2 / (edf * RECORDS)));
}

/* A large constant costs no digits: the record plus 9.8 has the same deviation as
 * far as its own rounding allows. */
static void test_large_mean(void **state)
{
    (void)state;
    enum { N = 100000 };
    double *y = malloc(N * sizeof *y), *z = malloc((N + 1) * sizeof *z),
           *s = malloc((N + 1) * sizeof *s);
    size_t factors[20];
    double plain[20], shifted[20];
    imk_random_normals(imk_random_seeded(3), 2, 0, N, y);
    for (size_t i = 0; i < N; i++) {
        y[i] = floor(y[i] * 4096) / 4096 * 1e-3; /* multiples of 2^-12 * 1e-3 */
        z[i] = y[i] + 9.8;
    }
    const size_t count = imk_allan_factors(IMK_ALLAN_OCTAVE, N, factors);
    imk_allan_sums(N, y, s, NULL);
    imk_allan_variances(IMK_ALLAN_OVERLAPPING, N, s, count, factors, plain, NULL, NULL);
    imk_allan_sums(N, z, z, NULL); /* in place */
    imk_allan_variances(IMK_ALLAN_OVERLAPPING, N, z, count, factors, shifted, NULL, NULL);
    /* y + 9.8 is rounded to 2^-50: independent errors of 2.6e-16 beside 1e-3 noise. */
    for (size_t i = 0; i < count; i++)
        CHECK_RELATIVE(shifted[i], plain[i], 1e-10);
    free(y), free(z), free(s);
}

static void run_backwards(void *context, size_t count, imk_work work, void *work_context)
{
    (void)context;
    while (count-- > 0)
        work(work_context, count);
}

static void test_order_of_work(void **state)
{
    (void)state;
    const imk_executor backwards = {run_backwards, NULL, 1};
    double y[TABLE], s[TABLE + 1];
    size_t factors[512];
    static imk_allan_point first[512], second[512];
    const imk_allan_settings settings = imk_allan_default();
    published_set(y);
    imk_allan_sums(TABLE, y, s, NULL);
    const size_t count = imk_allan_factors(IMK_ALLAN_ALL, TABLE, factors);
    assert_int_equal(count, 500);
    imk_allan_points(&settings, TABLE, s, count, factors, first, NULL);
    imk_allan_points(&settings, TABLE, s, count, factors, second, &backwards);
    double z[TABLE + 1]; /* the running sums too, and in place */
    published_set(z);
    imk_allan_sums(TABLE, z, z, &backwards);
    assert_memory_equal(z, s, sizeof z);
    for (size_t i = 0; i < count; i++) {
        assert_true(first[i].deviation == second[i].deviation);
        assert_true(first[i].edf == second[i].edf);
    }
}

static void test_factors(void **state)
{
    (void)state;
    size_t factors[64];
    const size_t expected[] = {1, 2, 3, 4, 5, 6, 8, 10, 13, 16, 20, 25, 32, 40, 50};
    assert_int_equal(imk_allan_factors(IMK_ALLAN_DECADE, 100, NULL), 15);
    assert_int_equal(imk_allan_factors(IMK_ALLAN_DECADE, 100, factors), 15);
    assert_memory_equal(factors, expected, sizeof expected);
    assert_int_equal(imk_allan_factors(IMK_ALLAN_OCTAVE, 1, factors), 0);
}

/* Types of drawn power-law noises at 4000 clusters. The type changes where the lag-1
 * autocorrelation passes -0.43, -0.18 and 0.33; it is -0.5 for white phase, 0 for white rate and,
 * differenced once, 0.17 for a random walk, with standard deviations of 0.011, 0.016 and 0.016: six
 * of them at least, 2e-9. */
static void test_noise_types(void **state)
{
    (void)state;
    enum { N = 8000 };
    static double y[N + 1], s[N + 1];
    for (uint64_t stream = 0; stream < 10; stream++) {
        imk_power_law type;
        imk_random_normals(imk_random_seeded(11), stream, 0, N + 1, y);
        imk_allan_sums(N, y, s, NULL);
        CHECK_STATUS(imk_allan_noise_type(N, s, 2, &type), IMK_OK);
        assert_int_equal(type, IMK_WHITE_RATE);
        CHECK_STATUS(imk_allan_noise_type(N, y, 2, &type), IMK_OK); /* sums that are white */
        assert_int_equal(type, IMK_WHITE_PHASE);
        double walk = 0;
        for (size_t i = 0; i < N; i++)
            y[i] = walk += y[i];
        imk_allan_sums(N, y, s, NULL);
        CHECK_STATUS(imk_allan_noise_type(N, s, 2, &type), IMK_OK);
        assert_int_equal(type, IMK_RANDOM_WALK_RATE);
        CHECK_STATUS(imk_allan_noise_type(N, s, 300, &type), IMK_ERROR_TOO_SHORT);
    }
}

/* Means of flicker noise, differenced once, have -0.22, and random walk 0.25: the limit is midway.
 * With 1000 clusters of 20 the deviation is 0.03: seven of them. */
static void test_noise_type_of_means(void **state)
{
    (void)state;
    enum { N = 20000 };
    static double y[N + 1];
    for (uint64_t stream = 0; stream < 10; stream++) {
        imk_flicker_state flicker;
        imk_power_law type;
        memset(y, 0, sizeof y);
        CHECK_STATUS(
            imk_flicker_start(&flicker, (imk_flicker){1, 0}, 0.01, imk_random_seeded(21), stream),
            IMK_OK);
        imk_flicker_add(&flicker, N, y);
        imk_allan_sums(N, y, y, NULL);
        CHECK_STATUS(imk_allan_noise_type(N, y, 20, &type), IMK_OK);
        assert_int_equal(type, IMK_FLICKER_RATE);
    }
}

/* White noise is never taken for phase noise where clusters are few, and the intervals hold it: of
 * 1000 at each time 95 %, standard error 0.7 %; at n/4, where chi-square is wider than the truth,
 * 97 %. The limits are five errors off. A type from the clusters of that time alone is phase noise
 * in one record in ten, and 87 % of the intervals hold. */
static void test_few_clusters(void **state)
{
    (void)state;
    enum { N = 3000, TIMES = 9 };
    static const size_t factors[TIMES] = {1, 3, 10, 30, 60, 100, 200, 300, 750};
    static double y[N + 1];
    const uint32_t records = check_runs(1000);
    size_t held[TIMES] = {0};
    const imk_allan_settings settings = imk_allan_default();
    for (uint32_t record = 0; record < records; record++) {
        imk_allan_point points[TIMES];
        imk_random_normals(imk_random_seeded(22), record, 0, N, y);
        imk_allan_sums(N, y, y, NULL);
        CHECK_STATUS(imk_allan_points(&settings, N, y, TIMES, factors, points, NULL), IMK_OK);
        for (size_t i = 0; i < TIMES; i++) {
            const double truth = 1 / sqrt((double)factors[i]);
            held[i] += points[i].lower <= truth && truth <= points[i].upper;
            assert_true(points[i].type <= IMK_WHITE_RATE);
        }
    }
    for (size_t i = 0; i < TIMES; i++) {
        const double share = (double)held[i] / records, error = sqrt(0.95 * 0.05 / records);
        CHECK_BELOW(0.95 - share, 5 * error);
        CHECK_BELOW(share - (i + 1 < TIMES ? 0.95 : 0.97), 5 * error);
    }
}

/* Factors in several calls: types follow on from the call before. */
static void test_calls_in_a_row(void **state)
{
    (void)state;
    enum { N = 3000, TIMES = 40 };
    static double y[N + 1];
    size_t factors[TIMES];
    const size_t count = imk_allan_factors(IMK_ALLAN_DECADE, N, factors);
    assert_true(count <= TIMES);
    for (uint64_t record = 0; record < 50; record++) {
        imk_allan_point together[TIMES], single[TIMES];
        imk_allan_settings settings = imk_allan_default();
        imk_random_normals(imk_random_seeded(23), record, 0, N, y);
        imk_allan_sums(N, y, y, NULL);
        CHECK_STATUS(imk_allan_points(&settings, N, y, count, factors, together, NULL), IMK_OK);
        for (size_t i = 0; i < count; i++) {
            settings.before = i > 0 ? &single[i - 1] : NULL;
            CHECK_STATUS(imk_allan_points(&settings, N, y, 1, &factors[i], &single[i], NULL),
                         IMK_OK);
            assert_int_equal(single[i].type, together[i].type);
            assert_true(single[i].upper == together[i].upper);
        }
    }
}

/* One value whose square overflows: the correlation is inf/inf, and no type. */
static void test_overflow(void **state)
{
    (void)state;
    enum { N = 2000 };
    static double y[N + 1], s[N + 1];
    imk_allan_settings settings = imk_allan_default();
    imk_power_law type = IMK_FLICKER_RATE;
    imk_allan_point point = {.m = 99};
    const size_t m = 2;
    imk_random_normals(imk_random_seeded(12), 0, 0, N, y);
    y[700] = 1e160;
    imk_allan_sums(N, y, s, NULL);
    CHECK_STATUS(imk_allan_noise_type(N, s, 2, &type), IMK_ERROR_NOT_FINITE);
    assert_int_equal(type, IMK_FLICKER_RATE);
    CHECK_STATUS(imk_allan_points(&settings, N, s, 1, &m, &point, NULL), IMK_ERROR_NOT_FINITE);
    /* The largest reading there may be is no fault of arithmetic. */
    y[700] = IMK_READING_MAX;
    imk_allan_sums(N, y, s, NULL);
    CHECK_OK(imk_allan_points(&settings, N, s, 1, &m, &point, NULL));
    assert_true(point.deviation > 1e58 && point.upper < 1e60);
}

static void test_bad_arguments(void **state)
{
    (void)state;
    double s[11] = {0}, variance = 7;
    size_t m = 6;
    CHECK_STATUS(imk_allan_variances(IMK_ALLAN_PLAIN, 10, s, 1, &m, &variance, NULL, NULL),
                 IMK_ERROR_RANGE);
    CHECK_STATUS(imk_allan_variances(IMK_ALLAN_PLAIN, 1, s, 1, &m, &variance, NULL, NULL),
                 IMK_ERROR_TOO_SHORT);
    assert_true(variance == 7);
    imk_allan_settings settings = {0};
    imk_allan_point point;
    CHECK_STATUS(imk_allan_points(&settings, 10, s, 1, &m, &point, NULL), IMK_ERROR_UNINITIALISED);
    settings = imk_allan_default();
    settings.confidence = NAN;
    CHECK_STATUS(imk_allan_points(&settings, 10, s, 1, &m, &point, NULL), IMK_ERROR_RANGE);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_published_deviations),
        cmocka_unit_test(test_published_octaves),
        cmocka_unit_test(test_published_nine),
        cmocka_unit_test(test_published_intervals),
        cmocka_unit_test(test_exact_degrees_of_freedom),
        cmocka_unit_test(test_degrees_of_freedom_by_draws),
        cmocka_unit_test(test_large_mean),
        cmocka_unit_test(test_order_of_work),
        cmocka_unit_test(test_factors),
        cmocka_unit_test(test_noise_types),
        cmocka_unit_test(test_noise_type_of_means),
        cmocka_unit_test(test_few_clusters),
        cmocka_unit_test(test_calls_in_a_row),
        cmocka_unit_test(test_overflow),
        cmocka_unit_test(test_bad_arguments),
    };
    return cmocka_run_group_tests_name("allan", tests, NULL, NULL);
}
