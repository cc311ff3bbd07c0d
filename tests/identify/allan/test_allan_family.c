/* SPDX-License-Identifier: Apache-2.0 */
/* The whole Allan family against published tables and against its definitions term by term. */
#include "check.h"

#include "identify/allan_oracle.h"

#include "imukit/random.h"

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

static double deviation(imk_allan_statistic statistic, size_t n, const double *sums, size_t m)
{
    double variance = -1;
    const size_t size = imk_allan_workspace_size(statistic, n, 1, &m, 1);
    void *workspace = malloc(size + 1);
    CHECK_STATUS(
        imk_allan_compute(statistic, n, sums, 1, &m, &variance, NULL, NULL, workspace, size),
        IMK_OK);
    free(workspace);
    return sqrt(variance);
}

typedef struct published {
    imk_allan_statistic statistic;
    double value[3];
} published;

/* The ten phase points of [RILEY2008], section 12.2, as nine frequencies; m = 1, 2; nine decimals.
 */
static void test_published_nine(void **state)
{
    (void)state;
    static const double y[9] = {892, 809, 823, 798, 671, 644, 883, 903, 677};
    static const published table[] = {
        {IMK_ALLAN_PLAIN, {91.229449741, 115.808210705}},
        {IMK_ALLAN_OVERLAPPING, {91.229449741, 85.952869838}},
        {IMK_ALLAN_MODIFIED, {91.229449741, 74.788493433}},
        {IMK_ALLAN_TIME, {52.671347366, 86.358313632}},
        {IMK_ALLAN_HADAMARD_PLAIN, {70.806073186, 116.797991564}},
        {IMK_ALLAN_HADAMARD, {70.806073186, 85.614871664}},
        {IMK_ALLAN_TOTAL, {91.229449741, 93.903790525}},
    };
    double s[10];
    imk_allan_sums(9, y, s, NULL);
    for (size_t i = 0; i < sizeof table / sizeof table[0]; i++)
        for (size_t m = 1; m <= 2; m++)
            CHECK_CLOSE(deviation(table[i].statistic, 9, s, m), table[i].value[m - 1],
                        0.5000001e-9);
}

/* m = 1, 10, 100 of the 1000-point set; ten decimals. MTOT and HTOT as defined, Theo1 at m = 10,
 * 100, 1000 (the design document golden.md, each computed by two programs). */
static void test_published_thousand(void **state)
{
    (void)state;
    static const published table[] = {
        {IMK_ALLAN_PLAIN, {.2922318781, .0996573606, .0389780433}},
        {IMK_ALLAN_OVERLAPPING, {.2922318781, .0915995342, .0324134303}},
        {IMK_ALLAN_MODIFIED, {.2922318781, .0617237638, .0217092091}},
        {IMK_ALLAN_TIME, {.1687201535, .3563623166, 1.2533817739}},
        {IMK_ALLAN_HADAMARD_PLAIN, {.2943883291, .1052754194, .0391086056}},
        {IMK_ALLAN_HADAMARD, {.2943883291, .0958108317, .0323763825}},
        {IMK_ALLAN_TOTAL, {.2922318781, .0913474326, .0340653025}},
        {IMK_ALLAN_MODIFIED_TOTAL, {.2066391427, .0555288598, .0195467513}},
        {IMK_ALLAN_HADAMARD_TOTAL, {.2081639838, .0959072041, .0305044788}},
        {IMK_ALLAN_THEO1, {.1075739889, .0317893126, .0050523996}},
    };
    static const size_t factors[2][3] = {{1, 10, 100}, {10, 100, 1000}};
    double y[TABLE], s[TABLE + 1];
    published_set(y);
    imk_allan_sums(TABLE, y, s, NULL);
    for (size_t i = 0; i < sizeof table / sizeof table[0]; i++)
        for (size_t k = 0; k < 3; k++)
            CHECK_CLOSE(deviation(table[i].statistic, TABLE, s,
                                  factors[table[i].statistic == IMK_ALLAN_THEO1][k]),
                        table[i].value[k], 0.5000001e-10);
}

/* What Stable32 prints with the bias of white rate noise taken off: seven digits, the last of which
 * is cut in one place (.096147875 is printed as .09614787): 0.6 units. */
static void test_published_without_bias(void **state)
{
    (void)state;
    static const size_t factors[] = {1, 10, 100};
    static const published table[] = {
        {IMK_ALLAN_MODIFIED_TOTAL, {.2418528, .06499161, .02287774}},
        {IMK_ALLAN_HADAMARD_TOTAL, {.2943883, .09614787, .03058103}},
    };
    static const double unit[3] = {1e-7, 1e-8, 1e-8};
    double y[TABLE], s[TABLE + 1];
    published_set(y);
    imk_allan_sums(TABLE, y, s, NULL);
    for (size_t i = 0; i < 2; i++) {
        imk_allan_settings settings = imk_allan_default();
        imk_allan_point points[3];
        settings.statistic = table[i].statistic;
        settings.bias = IMK_ALLAN_BIAS_PUBLISHED;
        settings.workspace_size =
            imk_allan_workspace_size(settings.statistic, TABLE, 3, factors, 1);
        settings.workspace = malloc(settings.workspace_size);
        CHECK_STATUS(imk_allan_points(&settings, TABLE, s, 3, factors, points, NULL), IMK_OK);
        for (size_t k = 0; k < 3; k++) {
            assert_int_equal(points[k].type, IMK_WHITE_RATE);
            CHECK_CLOSE(points[k].deviation, table[i].value[k], 0.6 * unit[k]);
        }
        free(settings.workspace);
    }
}

/* Records of several kinds: white sums, white rates, a walk, and a walk on a ramp with a large
 * constant, n and m drawn. The fast statistics have rounding errors of their sums' last digits,
 * some 1e-15 of the largest sum of a stretch: 1e-10 leaves room for the walk, whose second
 * differences are the smallest part of it. */
static void draw(int kind, uint64_t stream, size_t n, double *rate)
{
    double walk = 0, last = 0;
    imk_random_normals(imk_random_seeded(5), stream, 0, n, rate);
    for (size_t i = 0; i < n; i++) {
        const double value = rate[i];
        walk += value;
        if (kind == 0)
            rate[i] = value - last;
        else if (kind == 2)
            rate[i] = walk;
        else if (kind == 3)
            rate[i] = 9.8e3 + 0.3 * (double)i + walk;
        last = value;
    }
}

static void test_definitions(void **state)
{
    (void)state;
    enum { LONGEST = 700, RECORDS = 24 };
    static double rate[LONGEST], s[LONGEST + 1];
    static long double x[LONGEST + 1], y[LONGEST];
    const imk_random random = imk_random_seeded(9);
    size_t compared = 0;
    for (uint64_t r = 0; r < RECORDS; r++) {
        double u[2];
        if (check_skips(r / 4, 4)) /* each kind of noise stays */
            continue;
        imk_random_normals(random, 1, 32 * r, 2, u);
        const size_t n = 12 + (size_t)(fabs(u[0]) * 10007) % (LONGEST - 12);
        draw((int)(r % 4), r, n, rate);
        imk_allan_sums(n, rate, s, NULL);
        for (size_t i = 0; i <= n; i++)
            x[i] = (long double)s[i];
        for (size_t i = 0; i < n; i++)
            y[i] = x[i + 1] - x[i];
        for (imk_allan_statistic k = 0; k < IMK_ALLAN_STATISTICS; k++) {
            size_t lowest, highest, step;
            imk_allan_range(k, n, &lowest, &highest, &step);
            highest = k == IMK_ALLAN_TOTAL ? n : highest; /* where it is defined */
            lowest = k == IMK_ALLAN_THEO1 ? 2 : lowest;
            const size_t choices = (highest - lowest) / step + 1;
            const size_t some[] = {lowest, highest, lowest + 1 % choices * step,
                                   lowest + 4 % choices * step,
                                   lowest + (size_t)(fabs(u[1]) * 1009) % choices * step};
            for (size_t i = 0; i < 5; i++, compared++) {
                const double got = deviation(k, n, s, some[i]);
                const double expected = sqrt((double)oracle(k, n, x, y, some[i]));
                if (!(fabs(got / expected - 1) <= 1e-10))
                    print_error("%s kind %d n %zu m %zu: %.15g against %.15g\n", imk_allan_name(k),
                                (int)(r % 4), n, some[i], got, expected);
                CHECK_RELATIVE(got, expected, 1e-10);
            }
        }
    }
    assert_true(compared > (check_quick() ? 400 : 1200));
}

/* Theo1 beyond the factors at which it is summed as defined: several blocks, one, and fewer terms
 * than m/2; white rates, and a walk on a ramp. The comment of allan_theo_fast.c bounds its error by
 * 1e-11 of the variance. */
static void test_theo_by_correlation(void **state)
{
    (void)state;
    enum { N = 12000 };
    static double rate[N], s[N + 1];
    static long double x[N + 1];
    static const size_t factors[] = {1026, 3000, 5998, 9000, 11000};
    for (int kind = 1; kind < 4; kind += 2) {
        draw(kind, (uint64_t)kind, N, rate);
        imk_allan_sums(N, rate, s, NULL);
        for (size_t i = 0; i <= N; i++)
            x[i] = (long double)s[i];
        for (size_t i = 0; i < 5; i++) {
            assert_true(imk_allan_workspace_size(IMK_ALLAN_THEO1, N, 1, &factors[i], 1) > 0);
            CHECK_RELATIVE(deviation(IMK_ALLAN_THEO1, N, s, factors[i]),
                           sqrt((double)oracle_theo(N, x, factors[i])), 0.5e-11);
        }
    }
}

/* Gravity on an accelerometer of 1 ug noise: the record as read, 9.8 plus noise, is rounded to
 * 1.8e-15, 1.8e-10 of the noise. The same sums, taken in long double, give the same deviations to
 * 1e-12: what is added to the rounding of the record itself is nothing. */
static void test_gravity(void **state)
{
    (void)state;
    enum { N = 1 << 20 };
    double *rate = malloc((N + 1) * sizeof *rate), *s = malloc((N + 1) * sizeof *s);
    imk_random_normals(imk_random_seeded(3), 1, 0, N, rate);
    long double mean = 0, sum = 0;
    for (size_t i = 0; i < N; i++) {
        rate[i] = 9.8 + 9.8e-6 * rate[i];
        mean += (long double)rate[i] / N;
    }
    long double *x = malloc((N + 1) * sizeof *x);
    x[0] = 0;
    for (size_t i = 0; i < N; i++)
        x[i + 1] = sum += (long double)rate[i] - mean;
    imk_allan_sums(N, rate, s, NULL);
    const size_t factors[] = {1, 7, 64, 1000, N / 3};
    for (size_t i = 0; i < 5; i++) {
        const size_t m = factors[i];
        CHECK_RELATIVE(deviation(IMK_ALLAN_OVERLAPPING, N, s, m),
                       sqrt((double)oracle_differences(N, x, m, 2, 1)), 1e-12);
        CHECK_RELATIVE(deviation(IMK_ALLAN_HADAMARD, N, s, m),
                       sqrt((double)oracle_differences(N, x, m, 3, 1)), 1e-12);
        CHECK_RELATIVE(deviation(IMK_ALLAN_TOTAL, N, s, m), sqrt((double)oracle_total(N, x, m)),
                       1e-12);
        if (m <= 64 || m == N / 3) {
            CHECK_RELATIVE(deviation(IMK_ALLAN_MODIFIED, N, s, m),
                           sqrt((double)oracle_modified(N, x, m)), 1e-12);
            if (m <= 64)
                CHECK_RELATIVE(deviation(IMK_ALLAN_PARABOLIC, N, s, m),
                               sqrt((double)oracle_parabolic(N, x, m)), 1e-12);
        }
    }
    free(rate), free(s), free(x);
}

/* Exact power-law noise of even type: sums of N + 1 values from normals, differenced for white
 * phase, summed for the walks. */
static void draw_power_law(imk_power_law type, uint64_t record, size_t n, double *rate)
{
    imk_random_normals(imk_random_seeded(77), (uint64_t)(type + 10), 4096 * record, n + 1, rate);
    if (type == IMK_WHITE_PHASE)
        for (size_t i = 0; i < n; i++)
            rate[i] = rate[i + 1] - rate[i];
    for (int t = 0; t > type; t -= 2) {
        double walk = 0;
        for (size_t i = 0; i < n; i++)
            rate[i] = walk += rate[i];
    }
}

/* Degrees of freedom and biases by draws. With R records, 2 mean^2/variance has a relative standard
 * deviation of sqrt((2 + 12/edf)/R), 12/edf for the kurtosis of chi-square, and the mean one of
 * sqrt(2/(edf R)): 5.5 of them for each of 140 comparisons (5e-6 in all). Besides: 1e-2 for exact
 * sums, the header's 5 % for tables and 20 % for phase noises, 1.5 % for the bias of MTOT and HTOT.
 * Biases are of two estimates from the same records, each with its scatter. */
static void test_degrees_and_bias_by_draws(void **state)
{
    (void)state;
    enum { N = 256, FACTORS = 3 };
    const double records = check_quick() ? 150 : 600;
    static const size_t factors[FACTORS] = {8, 24, 60}, theo[FACTORS] = {16, 64, 160};
    static const imk_allan_statistic stands_for[IMK_ALLAN_STATISTICS] = {
        [IMK_ALLAN_MODIFIED_TOTAL] = IMK_ALLAN_MODIFIED,
        [IMK_ALLAN_HADAMARD_TOTAL] = IMK_ALLAN_HADAMARD};
    static double rate[N + 1], s[N + 1];
    static double workspace[16384];
    for (int type = IMK_WHITE_PHASE; type >= IMK_RANDOM_RUN_RATE; type -= 2) {
        double mean[IMK_ALLAN_STATISTICS][FACTORS] = {0},
               square[IMK_ALLAN_STATISTICS][FACTORS] = {0};
        double other[FACTORS] = {0}; /* AVAR at Theo1's averaging times */
        for (uint64_t r = 0; (double)r < records; r++) {
            draw_power_law((imk_power_law)type, r, N, rate);
            imk_allan_sums(N, rate, s, NULL);
            for (imk_allan_statistic k = 0; k < IMK_ALLAN_STATISTICS; k++) {
                double v[FACTORS];
                CHECK_STATUS(imk_allan_compute(k, N, s, FACTORS,
                                               k == IMK_ALLAN_THEO1 ? theo : factors, v, NULL, NULL,
                                               workspace, sizeof workspace),
                             IMK_OK);
                for (size_t i = 0; i < FACTORS; i++) {
                    mean[k][i] += v[i] / records;
                    square[k][i] += v[i] * v[i] / records;
                }
            }
            for (size_t i = 0; i < FACTORS; i++) {
                const size_t m = theo[i] * 3 / 4;
                double v;
                imk_allan_variances(IMK_ALLAN_OVERLAPPING, N, s, 1, &m, &v, NULL, NULL);
                other[i] += v / records;
            }
        }
        for (imk_allan_statistic k = 0; k < IMK_ALLAN_STATISTICS; k++)
            for (size_t i = 0; i < FACTORS; i++) {
                const bool hadamard = k == IMK_ALLAN_HADAMARD || k == IMK_ALLAN_HADAMARD_PLAIN ||
                                      k == IMK_ALLAN_HADAMARD_TOTAL;
                const bool table = k == IMK_ALLAN_TOTAL || k == IMK_ALLAN_MODIFIED_TOTAL ||
                                   k == IMK_ALLAN_HADAMARD_TOTAL || k == IMK_ALLAN_THEO1;
                if (type < IMK_RANDOM_WALK_RATE && !hadamard)
                    continue;
                const size_t m = k == IMK_ALLAN_THEO1 ? theo[i] : factors[i];
                const double edf = imk_allan_edf_exact(k, (imk_power_law)type, N, m);
                const double drawn =
                    2 * mean[k][i] * mean[k][i] / (square[k][i] - mean[k][i] * mean[k][i]);
                const double spread = 5.5 * sqrt((2 + 12 / edf) / records);
                CHECK_RELATIVE(drawn, edf, spread + (!table ? 1e-2 : type > 0 ? 0.2 : 0.05));
                if (!table)
                    continue;
                const double of = k == IMK_ALLAN_THEO1 ? other[i] : mean[stands_for[k]][i];
                CHECK_RELATIVE(mean[k][i] / of, imk_allan_bias(k, (imk_power_law)type, N, m),
                               5.5 * 2 * sqrt(2 / (edf * records)) + 0.015);
            }
    }
}

/* Types of drawn even power laws at 2000 clusters, down to the random run that only the Hadamard
 * family can bear; as in test_allan.c, the limits are at least six standard deviations away. */
static void test_noise_types_of_hadamard(void **state)
{
    (void)state;
    enum { N = 4000 };
    static double rate[N + 1], s[N + 1];
    for (uint64_t r = 0; r < 10; r++)
        for (int type = IMK_WHITE_PHASE; type >= IMK_RANDOM_RUN_RATE; type -= 2) {
            imk_power_law found;
            draw_power_law((imk_power_law)type, 10 * r, N, rate);
            imk_allan_sums(N, rate, s, NULL);
            CHECK_STATUS(imk_allan_noise_type_for(IMK_ALLAN_HADAMARD, N, s, 2, &found), IMK_OK);
            assert_int_equal(found, type);
            CHECK_STATUS(imk_allan_noise_type_for(IMK_ALLAN_MODIFIED, N, s, 2, &found), IMK_OK);
            assert_int_equal(found, type < -2 ? -2 : type);
        }
}

static void test_grids(void **state)
{
    (void)state;
    size_t f[2000];
    const size_t many = imk_allan_factors(IMK_ALLAN_MANY, 100000, f);
    assert_true(many < 2000);
    for (size_t i = 0; i < 64; i++)
        assert_int_equal(f[i], i + 1);
    assert_int_equal(f[64], 66);
    for (size_t i = 64; i < many; i++) { /* 32 to the octave: steps of 1/32 to 1/64 */
        assert_true(64 * (f[i] - f[i - 1]) >= f[i] - f[i] / 32);
        assert_true(32 * (f[i] - f[i - 1]) <= f[i]);
    }
    assert_true(f[many - 1] <= 50000 && f[many - 1] > 48000);
    const size_t expected[] = {16, 32, 64, 128, 256};
    assert_int_equal(imk_allan_factors_for(IMK_ALLAN_THEO1, IMK_ALLAN_OCTAVE, 300, f), 5);
    assert_memory_equal(f, expected, sizeof expected);
    assert_int_equal(imk_allan_factors_for(IMK_ALLAN_THEO1, IMK_ALLAN_ALL, 9, f), 0);
    assert_int_equal(imk_allan_factors_for(IMK_ALLAN_HADAMARD, IMK_ALLAN_ALL, 2, f), 0);
    assert_int_equal(imk_allan_factors_for(IMK_ALLAN_MODIFIED, IMK_ALLAN_ALL, 5, f), 2);
}

static void run_backwards(void *context, size_t count, imk_work work, void *work_context)
{
    (void)context;
    while (count-- > 0)
        work(work_context, count);
}

/* The same bits whatever the executor, its order and its threads; and what is refused. */
static void test_executors_and_refusals(void **state)
{
    (void)state;
    enum { N = 4000 };
    static double rate[N], s[N + 1];
    imk_random_normals(imk_random_seeded(1), 1, 0, N, rate);
    imk_allan_sums(N, rate, s, NULL);
    const imk_executor backwards = {run_backwards, NULL, 3};
    size_t f[1500];
    static double first[1500], second[1500];
    for (imk_allan_statistic k = 0; k < IMK_ALLAN_STATISTICS; k++) {
        const size_t count = imk_allan_factors_for(k, IMK_ALLAN_DECADE, N, f);
        const size_t size = imk_allan_workspace_size(k, N, count, f, 3);
        char *workspace = malloc(size + 8);
        CHECK_STATUS(imk_allan_compute(k, N, s, count, f, first, NULL, NULL, workspace + 1, size),
                     IMK_OK);
        CHECK_STATUS(
            imk_allan_compute(k, N, s, count, f, second, NULL, &backwards, workspace + 3, size),
            IMK_OK);
        assert_memory_equal(first, second, count * sizeof *first);
        if (size > 0)
            CHECK_STATUS(
                imk_allan_compute(k, N, s, count, f, first, NULL, &backwards, workspace, size - 1),
                IMK_ERROR_WORKSPACE);
        size_t lowest, highest, step;
        imk_allan_range(k, N, &lowest, &highest, &step);
        const size_t bad[] = {k == IMK_ALLAN_TOTAL ? N + 1 : highest + step,
                              k == IMK_ALLAN_THEO1 ? 0 : lowest - 1};
        for (size_t i = 0; i < 2; i++)
            CHECK_STATUS(imk_allan_compute(k, N, s, 1, &bad[i], first, NULL, NULL, workspace, size),
                         IMK_ERROR_RANGE);
        free(workspace);
        assert_non_null(imk_allan_title(k));
    }
    const size_t odd = 11;
    CHECK_STATUS(imk_allan_variances(IMK_ALLAN_THEO1, N, s, 1, &odd, first, NULL, NULL),
                 IMK_ERROR_RANGE);
    CHECK_STATUS(imk_allan_variances(IMK_ALLAN_STATISTICS, N, s, 1, &odd, first, NULL, NULL),
                 IMK_ERROR_ARGUMENT);
    assert_null(imk_allan_name(IMK_ALLAN_STATISTICS));
    assert_true(isnan(imk_allan_edf_exact(IMK_ALLAN_MODIFIED, IMK_WHITE_RATE, N, N)));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_published_nine),
        cmocka_unit_test(test_published_thousand),
        cmocka_unit_test(test_published_without_bias),
        cmocka_unit_test(test_definitions),
        cmocka_unit_test(test_theo_by_correlation),
        cmocka_unit_test(test_gravity),
        cmocka_unit_test(test_degrees_and_bias_by_draws),
        cmocka_unit_test(test_noise_types_of_hadamard),
        cmocka_unit_test(test_grids),
        cmocka_unit_test(test_executors_and_refusals),
    };
    return cmocka_run_group_tests_name("allan_family", tests, NULL, NULL);
}
