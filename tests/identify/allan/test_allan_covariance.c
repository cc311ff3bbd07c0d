/* SPDX-License-Identifier: Apache-2.0 */
/* Covariance of Allan variances across tau: against full sums over all pairs of second differences
 * of explicitly built covariances of samples, against published degrees of freedom, and against
 * draws. */
#include "check.h"

#include "imukit/allan_fit.h"
#include "imukit/random.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { N = 192, TAUS = 7, LONG_N = 1 << 20 };
static const size_t FACTORS[TAUS] = {1, 2, 5, 8, 16, 32, 64};
static const double PI = 3.14159265358979323846;
static char workspace[1 << 22];

/* Autocovariance of samples, stationary terms. */
static double autocovariance(const imk_allan_noise *noise, double dt, size_t lag)
{
    double sum = 0;
    const double n = noise->term[IMK_NOISE_WHITE], q = noise->term[IMK_NOISE_QUANTIZATION];
    if (noise->filter.bandwidth == 0 && lag == 0)
        sum += n * n / dt;
    if (lag < 2)
        sum += (lag == 0 ? 2 : -1) * q * q / (dt * dt);
    for (int i = 0; i < noise->gauss_markov_count; i++)
        sum += noise->gauss_markov[i].sigma * noise->gauss_markov[i].sigma *
               exp(-(double)lag * dt / noise->gauss_markov[i].correlation_time);
    for (int i = 0; i < noise->resonance_count; i++) {
        const imk_resonance *r = &noise->resonance[i];
        const double w = 2 * PI * r->frequency * dt * (double)lag, z = 0.5 / r->q;
        const double root = sqrt(1 - z * z);
        sum += r->sigma * r->sigma * exp(-z * w) * (cos(root * w) + z / root * sin(root * w));
    }
    return sum;
}

/* Filtered white noise: autocovariance of means over dt, by integrating that of the continuous
 * first-order process: sigma^2 e^-w|t|, sigma^2 = N^2 w/2. */
static double filtered(const imk_allan_noise *noise, double dt, size_t lag)
{
    const double w = 2 * PI * noise->filter.bandwidth, x = w * dt;
    const double n = noise->term[IMK_NOISE_WHITE], sigma2 = n * n * w / 2;
    if (lag == 0)
        return sigma2 * 2 * (x - 1 + exp(-x)) / (x * x);
    return sigma2 * exp(-x * (double)lag) * (2 * cosh(x) - 2) / (x * x);
}

/* Flicker noise has no autocovariance, but -B^2/pi of the second difference of t^2/2 ln t does for
 * second differences of sums, which do not see constants. Random walk likewise: -K^2 dt |lag|/2. */
static double generalised(const imk_allan_noise *noise, double dt, size_t lag)
{
    const double l = (double)lag, b = noise->term[IMK_NOISE_BIAS_INSTABILITY];
    const double k = noise->term[IMK_NOISE_RANDOM_WALK];
    double r[3];
    for (int i = -1; i <= 1; i++) {
        const double t = fabs(l + i);
        r[i + 1] = t > 0 ? t * t * log(t) : 0;
    }
    return -b * b / (2 * PI) * (r[0] - 2 * r[1] + r[2]) - 0.5 * k * k * dt * l;
}

/* cov(v1, v2) from the matrix of samples: the second difference j at m is the sum over samples of
 * weights -1 (m of them), +1 (m of them). */
static void exact(const imk_allan_noise *noise, double dt, size_t n, const size_t *strides,
                  double *covariance)
{
    static double c[N], cumulative[N + 1][N + 1];
    assert_true(n <= N);
    for (size_t l = 0; l < n; l++)
        c[l] = autocovariance(noise, dt, l) + generalised(noise, dt, l) +
               (noise->filter.bandwidth > 0 ? filtered(noise, dt, l) : 0);
    /* covariance of the running sums s[a], s[b] */
    for (size_t a = 0; a <= n; a++)
        for (size_t b = 0; b <= n; b++)
            cumulative[a][b] = a == 0 || b == 0
                                   ? 0
                                   : cumulative[a - 1][b] + cumulative[a][b - 1] -
                                         cumulative[a - 1][b - 1] + c[a > b ? a - b : b - a];
    static const double w[3] = {1, -2, 1};
    for (size_t i = 0; i < TAUS; i++)
        for (size_t j = 0; j < TAUS; j++) {
            const size_t m1 = FACTORS[i], m2 = FACTORS[j];
            const size_t s1 = strides ? strides[i] : 1, s2 = strides ? strides[j] : 1;
            double sum = 0, counted = 0;
            for (size_t p = 0; p + 2 * m1 <= n; p += s1)
                for (size_t q = 0; q + 2 * m2 <= n; q += s2) {
                    double rho = 0;
                    for (size_t a = 0; a < 3; a++)
                        for (size_t b = 0; b < 3; b++)
                            rho += w[a] * w[b] * cumulative[p + a * m1][q + b * m2];
                    const double mu = noise->term[IMK_NOISE_RAMP] * noise->term[IMK_NOISE_RAMP] *
                                      dt * dt * (double)(m1 * m1 * m2 * m2);
                    sum += 2 * rho * rho + 4 * rho * mu;
                    counted++;
                }
            covariance[i * TAUS + j] = sum / counted / (4.0 * (double)(m1 * m1 * m2 * m2));
        }
}

/* Largest error of a standard deviation (relative) and of a correlation. */
static void compare(const imk_allan_noise *noise, double dt, const size_t *strides,
                    double tolerance, const char *name)
{
    double truth[TAUS * TAUS], fast[TAUS * TAUS], worst = 0, worst_correlation = 0;
    const size_t n = N;
    const imk_allan_table table = {.dt = dt,
                                   .count = TAUS,
                                   .factors = FACTORS,
                                   .strides = strides,
                                   .record_count = 1,
                                   .lengths = &n};
    exact(noise, dt, N, strides, truth);
    CHECK_OK(imk_allan_covariance(&table, noise, fast, workspace, sizeof workspace));
    for (size_t i = 0; i < TAUS; i++) {
        worst = fmax(worst, fabs(sqrt(fast[i * TAUS + i] / truth[i * TAUS + i]) - 1));
        for (size_t j = 0; j < i; j++) {
            const double a = truth[i * TAUS + j] / sqrt(truth[i * TAUS + i] * truth[j * TAUS + j]);
            const double b = fast[i * TAUS + j] / sqrt(fast[i * TAUS + i] * fast[j * TAUS + j]);
            worst_correlation = fmax(worst_correlation, fabs(a - b));
        }
    }
    print_message("%s: sigma %.2g, correlation %.2g\n", name, worst, worst_correlation);
    CHECK_BELOW(worst, tolerance);
    CHECK_BELOW(worst_correlation, tolerance);
}

static void test_against_full_sums(void **state)
{
    (void)state;
    const double dt = 0.01;
    imk_allan_noise noise[5] = {0};
    for (int i = 0; i < 5; i++)
        noise[i].term[i < 4 ? i : IMK_NOISE_WHITE] = 0.3;
    noise[4].term[IMK_NOISE_RAMP] = 2;
    static const char *names[5] = {"quantization", "white", "flicker", "walk", "white and ramp"};
    for (int i = 0; i < 5; i++)
        compare(&noise[i], dt, NULL, 5e-3, names[i]);
    for (int k = 0; k < 3; k++) {
        imk_allan_noise decay = {.gauss_markov_count = 1};
        decay.gauss_markov[0] = (imk_gauss_markov){1, k == 0 ? 0.005 : k == 1 ? 0.2 : 100};
        compare(&decay, dt, NULL, 2e-3, "Gauss-Markov");
    }
    imk_allan_noise mixed = {.term = {1e-4, 0.1, 1, 2, 0}, .gauss_markov_count = 1};
    mixed.gauss_markov[0] = (imk_gauss_markov){1, 0.1};
    compare(&mixed, dt, NULL, 5e-3, "mixed");
    imk_allan_noise low_pass = {.term = {0, 0.1, 0, 0, 0}, .filter = {20, 0}};
    compare(&low_pass, dt, NULL, 1e-2, "low-pass");
}

/* Near a kink lag by lag; a memory of 1.8 samples, beside which most factors are long, in closed
 * form. */
static void test_resonance(void **state)
{
    (void)state;
    for (int i = 0; i < 4; i++) {
        static const double q[4] = {5, 10, 30, 2}, f[4] = {13, 20.3, 31, 35};
        imk_allan_noise noise = {.term = {0, 0.1, 0, 0, 0}, .resonance_count = 1};
        noise.resonance[0] = (imk_resonance){1, f[i], q[i]};
        compare(&noise, 0.01, NULL, i < 3 ? 1e-3 : 0.02, "resonance");
    }
}

/* Strides: every second difference at m = 1 … 2, a quarter of m beyond; and plain, none shared. */
static void test_strides(void **state)
{
    (void)state;
    static const size_t quarter[TAUS] = {1, 1, 1, 2, 4, 8, 16};
    const imk_allan_noise mixed = {.term = {1e-4, 0.1, 1, 2, 0}};
    compare(&mixed, 0.01, quarter, 0.02, "quarter");
    compare(&mixed, 0.01, FACTORS, 0.06, "plain");
}

/* Degrees of freedom 2 v^2/var agree with those of allan.h at every octave of a long record, all of
 * them far below the longest correlation time of flicker noise. */
static void test_degrees_of_freedom(void **state)
{
    (void)state;
    static const imk_power_law law[3] = {IMK_WHITE_RATE, IMK_FLICKER_RATE, IMK_RANDOM_WALK_RATE};
    const size_t n = LONG_N;
    size_t factors[20];
    for (size_t i = 0; i < 20; i++)
        factors[i] = (size_t)1 << i;
    const imk_allan_table table = {
        .dt = 0.001, .count = 20, .factors = factors, .record_count = 1, .lengths = &n};
    static double c[400];
    for (int k = 0; k < 3; k++) {
        imk_allan_noise noise = {0};
        noise.term[IMK_NOISE_WHITE + k] = 1;
        CHECK_OK(imk_allan_covariance(&table, &noise, c, workspace, sizeof workspace));
        for (size_t i = 1; i < 20; i++) {
            const double v = imk_allan_noise_variance(&noise, 0.001, factors[i]);
            /* Those of m > 256 are by proportion, which leaves out the sampling at the ends; at
             * the longest tau they are 1e-2 apart. Flicker noise: continuous against stages. */
            CHECK_RELATIVE(2 * v * v / c[i * 21],
                           imk_allan_edf_exact(IMK_ALLAN_OVERLAPPING, law[k], n, factors[i]), 2e-2);
        }
    }
}

/* Several records count as what they hold; a large record's covariance is its length's share. */
static void test_records(void **state)
{
    (void)state;
    const size_t one = 1 << 18, four[4] = {1 << 18, 1 << 18, 1 << 18, 1 << 18};
    const size_t mixed[2] = {1 << 18, 100};
    const size_t factors[3] = {1, 64, 4096};
    const imk_allan_noise noise = {.term = {0, 1, 0.05, 1e-3, 0}};
    double a[9], b[9], c[9];
    imk_allan_table table = {
        .dt = 1, .count = 3, .factors = factors, .record_count = 1, .lengths = &one};
    CHECK_OK(imk_allan_covariance(&table, &noise, a, workspace, sizeof workspace));
    table.record_count = 4;
    table.lengths = four;
    CHECK_OK(imk_allan_covariance(&table, &noise, b, workspace, sizeof workspace));
    table.record_count = 2;
    table.lengths = mixed;
    CHECK_OK(imk_allan_covariance(&table, &noise, c, workspace, sizeof workspace));
    for (int i = 0; i < 9; i++) {
        CHECK_RELATIVE(b[i], a[i] / 4, 1e-12);
        CHECK_RELATIVE(c[i], a[i], 1e-3);
    }
}

/* Draws of white noise, flicker noise and random walk together: variances and correlations of
 * Allan variances over R records. A variance has the relative standard deviation
 * sqrt((2 + 12/edf)/R), a correlation r at most (1 - r^2) sqrt(1 + 12/edf)/sqrt(R); six of them,
 * 2e-9 each. Flicker noise of the generator is 1 % from ideal in spectrum. */
static void test_against_draws(void **state)
{
    (void)state;
    enum { LENGTH = 4096, COUNT = 5 };
    const uint32_t runs = check_runs(1500);
    static const size_t factors[COUNT] = {2, 16, 128, 512, 1024};
    static double y[LENGTH + 1];
    const imk_allan_noise noise = {.term = {0, 1, 0.2, 0.003, 0}};
    const size_t n = LENGTH;
    const imk_allan_table table = {
        .dt = 1, .count = COUNT, .factors = factors, .record_count = 1, .lengths = &n};
    double expected[COUNT * COUNT], mean[COUNT] = {0}, product[COUNT * COUNT] = {0};
    CHECK_OK(imk_allan_covariance(&table, &noise, expected, workspace, sizeof workspace));
    static imk_white_state white;
    static imk_flicker_state flicker;
    static imk_random_walk_state walk;
    for (uint32_t r = 0; r < runs; r++) {
        const imk_random random = imk_random_seeded(21 + (uint64_t)r);
        double v[COUNT];
        memset(y, 0, sizeof y);
        CHECK_OK(imk_white_start(&white, 1, 1, random, 1));
        CHECK_OK(imk_flicker_start(&flicker, (imk_flicker){0.2, 0}, 1, random, 2ull << 32));
        CHECK_OK(imk_random_walk_start(&walk, 0.003, 1, random, 3ull << 32));
        imk_white_add(&white, n, y);
        imk_flicker_add(&flicker, n, y);
        imk_random_walk_add(&walk, n, y);
        imk_allan_sums(n, y, y, NULL);
        imk_allan_variances(IMK_ALLAN_OVERLAPPING, n, y, COUNT, factors, v, NULL, NULL);
        for (size_t i = 0; i < COUNT; i++) {
            mean[i] += v[i] / runs;
            for (size_t j = 0; j < COUNT; j++)
                product[i * COUNT + j] += v[i] * v[j] / runs;
        }
    }
    for (size_t i = 0; i < COUNT; i++) {
        const double v = imk_allan_noise_variance(&noise, 1, factors[i]);
        const double edf = 2 * v * v / expected[i * COUNT + i];
        const double variance = product[i * COUNT + i] - mean[i] * mean[i];
        CHECK_RELATIVE(mean[i], v, 6 * sqrt(2 / edf / runs));
        CHECK_RELATIVE(variance, expected[i * COUNT + i], 0.02 + 6 * sqrt((2 + 12 / edf) / runs));
        for (size_t j = 0; j < i; j++) {
            const double actual = (product[i * COUNT + j] - mean[i] * mean[j]) /
                                  sqrt(variance * (product[j * COUNT + j] - mean[j] * mean[j]));
            const double due =
                expected[i * COUNT + j] / sqrt(expected[i * COUNT + i] * expected[j * COUNT + j]);
            CHECK_CLOSE(actual, due, 0.01 + 6 * sqrt((1 + 12 / edf) / runs));
        }
    }
}

/* Time does not depend on the record: 25 octaves of 1e9 samples, five terms. */
static void test_cost(void **state)
{
    (void)state;
    const size_t lengths[2] = {(size_t)1 << 26, 1000000000};
    size_t factors[25];
    for (size_t i = 0; i < 25; i++)
        factors[i] = (size_t)1 << i;
    const imk_allan_noise noise = {.term = {1e-3, 1, 0.01, 1e-5, 1e-9}};
    static double c[625];
    for (int k = 0; k < 2; k++) {
        const imk_allan_table table = {
            .dt = 0.01, .count = 25, .factors = factors, .record_count = 1, .lengths = &lengths[k]};
        const clock_t start = clock();
        CHECK_OK(imk_allan_covariance(&table, &noise, c, workspace, sizeof workspace));
        print_message("%.3g samples: %.1f ms\n", (double)lengths[k],
                      1e3 * (double)(clock() - start) / CLOCKS_PER_SEC);
        for (int i = 0; i < 25; i++)
            assert_true(c[i * 26] > 0);
    }
}

static void test_bad_arguments(void **state)
{
    (void)state;
    const size_t n = 100, factors[2] = {1, 51}, strides[2] = {1, 2};
    double c[4] = {7};
    imk_allan_noise noise = {.term = {0, 1, 0, 0, 0}};
    imk_allan_table table = {
        .dt = 1, .count = 2, .factors = factors, .record_count = 1, .lengths = &n};
    CHECK_STATUS(imk_allan_covariance(&table, &noise, c, workspace, sizeof workspace),
                 IMK_ERROR_TOO_SHORT);
    table.strides = strides;
    CHECK_STATUS(imk_allan_covariance(&table, &noise, c, workspace, sizeof workspace),
                 IMK_ERROR_RANGE);
    table.strides = NULL;
    table.dt = NAN;
    CHECK_STATUS(imk_allan_covariance(&table, &noise, c, workspace, sizeof workspace),
                 IMK_ERROR_NOT_FINITE);
    table.dt = 1;
    const size_t right[2] = {1, 50};
    table.factors = right;
    CHECK_STATUS(imk_allan_covariance(&table, &noise, c, workspace, 8), IMK_ERROR_WORKSPACE);
    noise.gauss_markov_count = 9;
    CHECK_STATUS(imk_allan_covariance(&table, &noise, c, workspace, sizeof workspace),
                 IMK_ERROR_RANGE);
    assert_true(c[0] == 7);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_against_full_sums),
        cmocka_unit_test(test_resonance),
        cmocka_unit_test(test_strides),
        cmocka_unit_test(test_degrees_of_freedom),
        cmocka_unit_test(test_records),
        cmocka_unit_test(test_against_draws),
        cmocka_unit_test(test_cost),
        cmocka_unit_test(test_bad_arguments),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
