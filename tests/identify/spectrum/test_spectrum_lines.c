/* SPDX-License-Identifier: Apache-2.0 */
/* Spectral lines: the rate of false alarms, and frequency, amplitude and phase of those found
 * against their stated sigmas. */
#include "check.h"

#include "imukit/random.h"
#include "imukit/spectrum.h"

#include <string.h>

enum { BINS = 1 << 14, LINES = 32 };
static double density[BINS], degrees[BINS], harmonic[BINS];
static imk_spectrum_line lines[LINES];
static const double TURN = 6.283185307179586;

/* Spectrum and lines of a record. */
static size_t find(imk_spectrum_method method, size_t n, double dt, const double *x,
                   double false_alarm, imk_spectrum *s)
{
    imk_spectrum_settings settings = imk_spectrum_default();
    settings.dt = dt;
    settings.method = method;
    const size_t size = imk_spectrum_workspace_size(&settings, n);
    void *workspace = malloc(size);
    assert_true(imk_spectrum_count(&settings, n) <= BINS);
    CHECK_OK(imk_spectrum_estimate(&settings, n, x, s, density, degrees, harmonic, workspace, size,
                                   NULL));
    free(workspace);
    const size_t more = imk_spectrum_lines_workspace_size(s, n);
    size_t count = 0;
    workspace = malloc(more);
    CHECK_OK(imk_spectrum_lines(s, n, x, false_alarm, LINES, lines, &count, workspace, more));
    free(workspace);
    return count;
}

/* At 5 % a record, of white noise or of a random walk in white noise: the number with lines is at
 * most binomial; 5 % of 200 is 10, and 29 or more have a chance of 2e-7. */
static void test_false_alarms(void **state)
{
    (void)state;
    enum { N = 1024 };
    const uint32_t records = check_runs(200);
    static double x[N], steps[N];
    imk_spectrum s;
    for (int method = 0; method < 2; method++) {
        uint32_t alarms = 0;
        for (uint32_t r = 0; r < records; r++) {
            imk_random_normals(imk_random_seeded(1), r, 0, N, x);
            imk_random_normals(imk_random_seeded(2), r, 0, N, steps);
            double walk = 0;
            for (size_t i = 0; i < N && r % 2 == 1; i++)
                x[i] += walk += 0.02 * steps[i];
            alarms += find((imk_spectrum_method)method, N, 0.01, x, 0.05, &s) > 0;
        }
        assert_true(alarms * 200 < 29 * records);
    }
}

/* A sinusoid in white noise: errors over their sigmas have mean 0 and deviation 1. With R records
 * five deviations of either are 5/sqrt(R) and 5/sqrt(2 R). It stands 6 sigmas high, so it is always
 * found; the weak tail of the amplitude adds the 0.15. */
static void test_sigmas(void **state)
{
    (void)state;
    enum { N = 8000 };
    const uint32_t records = check_runs(60);
    const double dt = 0.01, amplitude = 0.19;
    static double x[N];
    imk_spectrum s;
    for (int method = 0; method < 2; method++) {
        double sum[3] = {0}, squares[3] = {0};
        for (uint32_t r = 0; r < records; r++) {
            double draw[2];
            imk_random_normals(imk_random_seeded(3), r, 0, N, x);
            imk_random_normals(imk_random_seeded(4), r, 0, 2, draw);
            const double f = 20 + 5 * draw[0], phase = draw[1];
            for (size_t i = 0; i < N; i++)
                x[i] += 9.8 + amplitude * cos(TURN * f * dt * (double)i + phase);
            const size_t count = find((imk_spectrum_method)method, N, dt, x, 1e-3, &s);
            assert_in_range(count, 1, 2);
            size_t at = 0;
            for (size_t i = 1; i < count; i++)
                at = fabs(lines[i].frequency - f) < fabs(lines[at].frequency - f) ? i : at;
            assert_true(lines[at].coherent);
            const double turns = (lines[at].phase - phase) / TURN;
            /* Phase at the first sample, half a record from where it is best known:
             * sigma = 2 sigma_a/a. */
            const double z[3] = {(lines[at].frequency - f) / lines[at].frequency_sigma,
                                 (lines[at].amplitude - amplitude) / lines[at].amplitude_sigma,
                                 (turns - floor(turns + 0.5)) * TURN /
                                     (2 * lines[at].amplitude_sigma / amplitude)};
            for (int k = 0; k < 3; k++) {
                sum[k] += z[k] / records;
                squares[k] += z[k] * z[k] / records;
            }
        }
        for (int k = 0; k < 3; k++) {
            CHECK_CLOSE(sum[k], 0, 5 / sqrt(records) + 0.15);
            CHECK_CLOSE(sqrt(squares[k]), 1, 5 / sqrt(2.0 * records) + 0.15);
        }
    }
}

/* 50 Hz with two multiples, a stranger, and a line that wanders, in white noise and gravity. */
static void test_families(void **state)
{
    (void)state;
    enum { N = 1 << 18 };
    const double dt = 1e-3;
    double *x = malloc(N * sizeof *x), wander = 0, steps[2];
    imk_spectrum s;
    imk_random_normals(imk_random_seeded(5), 1, 0, N, x);
    for (size_t i = 0; i < N; i++) {
        const double t = dt * (double)i;
        if (i % 2 == 0)
            imk_random_normals(imk_random_seeded(5), 2, i, 2, steps);
        wander += 0.02 * steps[i % 2];
        x[i] += 9.8 + 0.5 * cos(TURN * 50.01 * t) + 0.1 * cos(TURN * 100.02 * t) +
                0.2 * cos(TURN * 150.03 * t) + 0.1 * cos(TURN * 77.7 * t) +
                0.5 * cos(TURN * 210 * t + wander);
    }
    const size_t count = find(IMK_SPECTRUM_WELCH, N, dt, x, 1e-3, &s);
    assert_int_equal(count, 5);
    static const double frequency[] = {50.01, 77.7, 100.02, 150.03, 210};
    static const double amplitude[] = {0.5, 0.1, 0.1, 0.2, 0.5};
    static const int multiple[] = {1, 1, 2, 3, 1}, family[] = {0, 1, 0, 0, 2};
    for (size_t i = 0; i < 5; i++) {
        assert_int_equal(lines[i].multiple, multiple[i]);
        assert_int_equal(lines[i].family, family[i]);
        assert_int_equal(lines[i].coherent, i < 4);
        CHECK_CLOSE(lines[i].frequency, frequency[i], 5 * lines[i].frequency_sigma);
        CHECK_CLOSE(lines[i].amplitude, amplitude[i], 5 * lines[i].amplitude_sigma);
        CHECK_BELOW(lines[i].false_alarm, 1e-6);
    }
    /* The phase walks 0.02 rad a sample: a Lorentzian of half-power width D/(2 pi dt) = 0.064 Hz,
     * D = 0.02^2. Its
     * highest bin is too high by the scatter of 50 degrees, so the width comes out narrower. */
    assert_true(lines[4].width > 0.03 && lines[4].width < 0.12);
    free(x);
}

/* Without the record there are peaks, none coherent; without noise in it there is nothing else. */
static void test_spectrum_alone(void **state)
{
    (void)state;
    enum { N = 8192 };
    static double x[N];
    imk_spectrum s;
    imk_random_normals(imk_random_seeded(6), 1, 0, N, x);
    for (size_t i = 0; i < N; i++)
        x[i] += 0.5 * cos(TURN * 0.123 * (double)i);
    assert_int_equal(find(IMK_SPECTRUM_WELCH, N, 1, x, 1e-3, &s), 1);
    const imk_spectrum_line with = lines[0];
    const size_t size = imk_spectrum_lines_workspace_size(&s, N);
    size_t count = 0;
    void *workspace = malloc(size);
    CHECK_OK(imk_spectrum_lines(&s, N, NULL, 1e-3, LINES, lines, &count, workspace, size));
    assert_int_equal(count, 1);
    assert_true(with.coherent && !lines[0].coherent);
    CHECK_CLOSE(lines[0].frequency, 0.123, s.step);
    CHECK_RELATIVE(lines[0].amplitude, 0.5, 0.1);
    CHECK_STATUS(imk_spectrum_lines(&s, N, x, 0, LINES, lines, &count, workspace, size),
                 IMK_ERROR_RANGE);
    CHECK_STATUS(imk_spectrum_lines(&s, N, x, 0.1, LINES, lines, &count, workspace, 8),
                 IMK_ERROR_WORKSPACE);
    free(workspace);
}

/* A fifth of the record missing in one hole: the line is found all the same. */
static void test_missing(void **state)
{
    (void)state;
    enum { N = 50000 };
    static double x[N];
    imk_spectrum s;
    imk_random_normals(imk_random_seeded(7), 1, 0, N, x);
    for (size_t i = 0; i < N; i++)
        x[i] = i > 20000 && i < 30000 ? (double)NAN
                                      : x[i] + 0.2 * cos(TURN * 12.34 * 0.01 * (double)i);
    assert_int_equal(find(IMK_SPECTRUM_WELCH, N, 0.01, x, 1e-3, &s), 1);
    assert_true(lines[0].coherent);
    CHECK_CLOSE(lines[0].frequency, 12.34, 5 * lines[0].frequency_sigma);
    CHECK_CLOSE(lines[0].amplitude, 0.2, 5 * lines[0].amplitude_sigma);
    assert_true(s.fraction_used > 0.7 && s.fraction_used < 0.85);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_false_alarms), cmocka_unit_test(test_sigmas),
        cmocka_unit_test(test_families), cmocka_unit_test(test_spectrum_alone),
        cmocka_unit_test(test_missing)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
