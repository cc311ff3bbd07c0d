/* SPDX-License-Identifier: Apache-2.0 */
/* Spectral densities: Parseval, level and distribution for white noise, tapers against SciPy,
 * leakage, large constants, missing samples, and the parameters fitted to them. */
#include "check.h"

#include "imukit/distributions.h"
#include "imukit/noise.h"
#include "imukit/random.h"
#include "imukit/spectrum.h"

#include <string.h>

enum { BINS = 1 << 17 };
static double density[BINS], degrees[BINS], harmonic[BINS];

static imk_status estimate(const imk_spectrum_settings *settings, size_t n, const double *x,
                           imk_spectrum *s)
{
    const size_t size = imk_spectrum_workspace_size(settings, n);
    void *workspace = malloc(size + 1);
    imk_error error;
    assert_true(imk_spectrum_count(settings, n) <= BINS);
    const imk_status status = imk_spectrum_estimate(settings, n, x, s, density, degrees, harmonic,
                                                    workspace, size, &error);
    free(workspace);
    return status;
}

static double *normals(size_t n, uint64_t seed)
{
    double *x = malloc(n * sizeof *x);
    imk_random_normals(imk_random_seeded(seed), 1, 0, n, x);
    return x;
}

/* Power of all bins: both ends once, the others for their mirror images too. */
static double total(const imk_spectrum *s)
{
    double sum = 0;
    for (size_t k = 0; k < s->count; k++)
        sum += (k == 0 || k == s->count - 1 ? 1 : 2) * s->density[k] * s->step;
    return sum;
}

/* One segment of unit weights: the bins add up to the mean square about the mean. With a window: to
 * its weighted mean square (computed here by the window's own formula). */
static void test_parseval(void **state)
{
    (void)state;
    enum { N = 4000 };
    double *x = normals(N, 1), mean = 0, squares = 0, weighted = 0, energy = 0;
    imk_spectrum_settings settings = imk_spectrum_default();
    imk_spectrum s;
    settings.dt = 0.005;
    settings.window = IMK_WINDOW_RECTANGULAR;
    settings.resolution = 1 / (N * settings.dt);
    for (size_t i = 0; i < N; i++)
        mean += x[i] / N;
    for (size_t i = 0; i < N; i++) {
        const double w = 0.5 - 0.5 * cos(6.283185307179586 * (double)i / N);
        squares += (x[i] - mean) * (x[i] - mean) / N;
        weighted += w * w * (x[i] - mean) * (x[i] - mean);
        energy += w * w;
    }
    CHECK_OK(estimate(&settings, N, x, &s));
    assert_int_equal(s.length, N);
    assert_int_equal(s.segments, 1);
    CHECK_RELATIVE(total(&s), squares, 1e-12);
    settings.window = IMK_WINDOW_HANN;
    settings.resolution *= 1.5;
    CHECK_OK(estimate(&settings, N, x, &s));
    assert_int_equal(s.length, N);
    CHECK_RELATIVE(total(&s), weighted / energy, 1e-12);
    free(x);
}

/* Mean and scatter of the bins of white noise: N^2, and 2/degrees as their relative variance. The
 * mean over all bins has (bins/correlation) degrees/2 as its squared inverse deviation. Five such
 * deviations: false alarm 6e-7. The relative variance of B independent gamma bins of shape a = v/2
 * scatters by sqrt((2 + 6/a)/B) of itself, B the bins over the correlation. */
static void check_white(imk_spectrum_settings settings, size_t n, uint64_t seed)
{
    double *x = normals(n, seed), mean = 0, squares = 0;
    imk_spectrum s;
    settings.dt = 0.01;
    for (size_t i = 0; i < n; i++)
        x[i] = 9.8 + 0.3 / sqrt(settings.dt) * x[i];
    CHECK_OK(estimate(&settings, n, x, &s));
    const size_t first = 20, last = s.count - 20, bins = last - first;
    for (size_t k = first; k < last; k++)
        mean += s.density[k] / (double)bins;
    for (size_t k = first; k < last; k++)
        squares += (s.density[k] - mean) * (s.density[k] - mean) / (double)bins;
    const double v = s.degrees[100], independent = (double)bins / s.correlation;
    CHECK_RELATIVE(mean, 0.09, 5 * sqrt(2 / v / independent));
    CHECK_RELATIVE(squares / mean / mean, 2 / v, 5 * sqrt((2 + 12 / v) / independent) + 0.02);
    CHECK_RELATIVE(s.mean, 9.8, 1e-2);
    CHECK_CLOSE(s.fraction_used, 1, 0);
    free(x);
}

static void test_white(void **state)
{
    (void)state;
    imk_spectrum_settings settings = imk_spectrum_default();
    check_white(settings, 200000, 2);
    settings.overlap = 0.75;
    settings.window = IMK_WINDOW_BLACKMAN_HARRIS;
    check_white(settings, 200000, 3);
    settings.window = IMK_WINDOW_KAISER;
    check_white(settings, 200000, 4);
    settings = imk_spectrum_default();
    settings.method = IMK_SPECTRUM_MULTITAPER;
    check_white(settings, 50000, 5);
    settings.adaptive = false;
    check_white(settings, 50000, 6);
    settings.trend = true;
    settings.resolution = 0.2;
    check_white(settings, 50000, 7);
}

/* Noise bandwidths of [HARRIS1978, table I], and known degrees of freedom: M separate segments have
 * 2 M; Hann's at half overlap correlate by 1/6, so 2 M/(1 + 2 (1 - 1/M)/36). K tapers have 2 K. */
static void test_figures_of_merit(void **state)
{
    (void)state;
    enum { N = 16000 };
    double *x = normals(N, 8);
    imk_spectrum s;
    imk_spectrum_settings settings = imk_spectrum_default();
    settings.dt = 1;
    settings.resolution = 1.5 / 1000;
    CHECK_OK(estimate(&settings, N, x, &s));
    assert_int_equal(s.segments, 31);
    CHECK_RELATIVE(s.noise_bandwidth, 1.5 / 1000, 1e-12);
    CHECK_RELATIVE(s.degrees[7], 62 / (1 + 2 * (30.0 / 31) / 36), 1e-9);
    CHECK_RELATIVE(s.degrees[s.count - 1], 31 / (1 + 2 * (30.0 / 31) / 36), 1e-9);
    CHECK_RELATIVE(s.blur, s.step / sqrt(3.0), 1e-4); /* kernel 1/6, 2/3, 1/6 */
    settings.overlap = 0;
    CHECK_OK(estimate(&settings, N, x, &s));
    CHECK_RELATIVE(s.degrees[7], 32, 1e-12);
    CHECK_RELATIVE(s.correlation, 35.0 / 18, 1e-9); /* mean w^4 over squared mean w^2 */
    settings.window = IMK_WINDOW_BLACKMAN_HARRIS;
    settings.resolution = 2.0 / 1000;
    CHECK_OK(estimate(&settings, N, x, &s));
    CHECK_RELATIVE(s.noise_bandwidth / s.step, 2.0044, 1e-3);
    settings = imk_spectrum_default();
    settings.dt = 1;
    settings.method = IMK_SPECTRUM_MULTITAPER;
    settings.adaptive = false;
    CHECK_OK(estimate(&settings, N, x, &s));
    CHECK_RELATIVE(s.degrees[7], 14, 1e-12);
    free(x);
}

/* Samples 0, 10, 31 and 0, 777, 2400, and the concentrations, of scipy.signal.windows.dpss (SciPy
 * 1.10), whose own error is about 1e-12 here. */
static void test_slepian(void **state)
{
    (void)state;
    static const double short_ones[7][4] = {
        {3.106368300717931e-05, 0.01214737014300064, 0.2473371865596638, 0.9999999997458373},
        {0.0002471114595640911, 0.04535300039388693, 0.01870942749480621, 0.9999999753972032},
        {0.001346580507673749, 0.1075739504274661, -0.1678741176861505, 0.9999988951897141},
        {0.005769171852681975, 0.1802182418790326, -0.0214361273436435, 0.9999696576800483},
        {0.02040826169999293, 0.2094021380879526, 0.1373210579559685, 0.9994365497071939},
        {0.06030832371511841, 0.1386958796082519, 0.02169410857201387, 0.992710115932201},
        {0.1446986286645277, -0.01582446002162468, -0.1131483306071003, 0.9374686049264537}};
    static const double long_ones[4][4] = {
        {9.284483800621949e-05, 0.003652070548489818, 0.02466886270947522, 0.999997183937306},
        {0.0006652479177044599, 0.01100169400101199, 0.003671887005994018, 0.9998429997733003},
        {0.003094257354753888, 0.01948205758104914, -0.01585987252797465, 0.9962154155793108},
        {0.01019224695291466, 0.02050133175008394, -0.003838277268291607, 0.9521247255139191}};
    enum { LONG = 5000 };
    double *v = malloc(7 * LONG * sizeof *v), lambda[7];
    const size_t size = imk_slepian_workspace_size(LONG);
    void *workspace = malloc(size);
    CHECK_OK(imk_slepian_tapers(64, 4, 7, v, lambda, workspace, size));
    static const size_t places[3] = {0, 10, 31}, long_places[3] = {0, 777, 2400};
    for (size_t k = 0; k < 7; k++) {
        for (size_t i = 0; i < 3; i++)
            CHECK_CLOSE(v[64 * k + places[i]], short_ones[k][i], 1e-10);
        CHECK_CLOSE(lambda[k], short_ones[k][3], 1e-10);
    }
    CHECK_OK(imk_slepian_tapers(LONG, 2.5, 4, v, lambda, workspace, size));
    for (size_t k = 0; k < 4; k++) {
        for (size_t i = 0; i < 3; i++)
            CHECK_CLOSE(v[LONG * k + long_places[i]], long_ones[k][i], 1e-10);
        CHECK_CLOSE(lambda[k], long_ones[k][3], 1e-10);
        for (size_t j = 0; j <= k; j++) {
            double product = 0;
            for (size_t i = 0; i < LONG; i++)
                product += v[LONG * k + i] * v[LONG * j + i];
            CHECK_CLOSE(product, j == k, 1e-10);
        }
    }
    CHECK_STATUS(imk_slepian_tapers(64, 4, 9, v, lambda, workspace, size), IMK_ERROR_RANGE);
    CHECK_STATUS(imk_slepian_tapers(64, 4, 7, v, lambda, workspace, 64), IMK_ERROR_WORKSPACE);
    free(workspace);
    free(v);
}

/* A random walk whose fastest density is 1e-8 of its slowest: what leaks through the window stays
 * below a tenth of what is there, at the upper end of the spectrum. S = K^2 dt^2/(4 sin^2(pi f
 * dt)). 1000 bins of 50 degrees: five deviations are 5 sqrt(2 * 2/(50 * 1000)) = 0.045. */
static void test_leakage(void **state)
{
    (void)state;
    enum { N = 100000 };
    double *x = normals(N, 9);
    imk_spectrum s;
    for (size_t i = 1; i < N; i++)
        x[i] += x[i - 1];
    for (int method = 0; method < 2; method++) {
        imk_spectrum_settings settings = imk_spectrum_default();
        settings.dt = 1;
        settings.method = (imk_spectrum_method)method;
        CHECK_OK(estimate(&settings, N, x, &s));
        double ratio = 0, count = 0;
        for (size_t k = s.count / 2; k < s.count - 1; k++, count++)
            ratio += s.density[k] / imk_random_walk_sampled_spectrum(1, 1, (double)k * s.step);
        CHECK_CLOSE(ratio / count, 1, 0.1);
    }
    free(x);
}

/* A record about 9.8 gives the spectrum of the same record about 0, to the rounding of its samples
 * (2^-50, relative to deviations of 1e-3: 1e-12, which the densest bins square). */
static void test_large_constant(void **state)
{
    (void)state;
    enum { N = 20000 };
    double *x = normals(N, 10), *y = malloc(N * sizeof *y), *first = malloc(BINS * sizeof *first);
    imk_spectrum_settings settings = imk_spectrum_default();
    imk_spectrum s;
    settings.dt = 0.01;
    for (size_t i = 0; i < N; i++) {
        y[i] = 9.8 + 1e-3 * x[i];
        x[i] = y[i] - 9.8; /* exact [Sterbenz]: the same deviations */
    }
    CHECK_OK(estimate(&settings, N, x, &s));
    memcpy(first, s.density, s.count * sizeof *first);
    CHECK_OK(estimate(&settings, N, y, &s));
    for (size_t k = 2; k < s.count; k++)
        CHECK_RELATIVE(s.density[k], first[k], 1e-9);
    free(first);
    free(x);
    free(y);
}

/* A hole costs the segments that touch it, and no more. */
static void test_missing(void **state)
{
    (void)state;
    enum { N = 64000, HOLE = 30000 };
    double *x = normals(N, 11);
    imk_spectrum_settings settings = imk_spectrum_default();
    imk_spectrum s;
    settings.dt = 1;
    settings.resolution = 1.5 / 4000;
    for (size_t i = 0; i < 100; i++)
        x[HOLE + i] = NAN;
    CHECK_OK(estimate(&settings, N, x, &s));
    /* Segments start every 2000 samples: those at 28000 and 30000 hold sample 30000 and the next.
     */
    assert_int_equal(s.segments, 29);
    assert_int_equal(s.left_out, 2);
    CHECK_RELATIVE(s.fraction_used, (N - 2000) / (double)N, 1e-12);
    double mean = 0;
    for (size_t k = 10; k + 1 < s.count; k++)
        mean += s.density[k] / (double)(s.count - 11);
    CHECK_CLOSE(mean, 1, 5 * sqrt(2.0 / N)); /* all samples are in the mean */
    x[5] = 1e160;
    CHECK_STATUS(estimate(&settings, N, x, &s), IMK_ERROR_NOT_FINITE);
    for (size_t i = 0; i < N; i += 100)
        x[i] = INFINITY;
    CHECK_STATUS(estimate(&settings, N, x, &s), IMK_ERROR_GAP);
    free(x);
}

static void test_refusals(void **state)
{
    (void)state;
    double x[200] = {0};
    imk_spectrum s;
    imk_spectrum_settings settings = {0};
    CHECK_STATUS(estimate(&settings, 200, x, &s), IMK_ERROR_UNINITIALISED);
    settings = imk_spectrum_default();
    CHECK_STATUS(estimate(&settings, 200, x, &s), IMK_ERROR_RANGE); /* no dt */
    settings.dt = 1;
    CHECK_STATUS(estimate(&settings, 200, x, &s), IMK_ERROR_CONSTANT);
    CHECK_STATUS(estimate(&settings, 63, x, &s), IMK_ERROR_TOO_SHORT);
    settings.resolution = 1e-9;
    CHECK_STATUS(estimate(&settings, 200, x, &s), IMK_ERROR_RANGE);
    settings.resolution = 0.4;
    CHECK_STATUS(estimate(&settings, 200, x, &s), IMK_ERROR_RANGE);
    settings.resolution = NAN;
    CHECK_STATUS(estimate(&settings, 200, x, &s), IMK_ERROR_RANGE);
    settings = imk_spectrum_default();
    settings.dt = 1;
    settings.tapers = 9;
    CHECK_STATUS(estimate(&settings, 200, x, &s), IMK_ERROR_RANGE);
    settings.tapers = 0;
    x[7] = 1;
    char small[8];
    CHECK_STATUS(imk_spectrum_estimate(&settings, 200, x, &s, density, degrees, NULL, small,
                                       sizeof small, NULL),
                 IMK_ERROR_WORKSPACE);
}

/* Quantiles of chi-square: of 2 degrees 1 - exp(-x/2). */
static void test_interval(void **state)
{
    (void)state;
    double lower, upper;
    imk_spectrum_interval(3, 2, 0.9, &lower, &upper);
    CHECK_RELATIVE(lower, 3 / -log(0.05), 1e-10);
    CHECK_RELATIVE(upper, 3 / -log(0.95), 1e-10);
}

/* Bands hold all bins but the first, once; their intervals cover the level of white noise. At 95 %
 * and 60 bands of which neighbours hardly correlate, less than 45 inside happens once in 1e7. */
static void test_bands(void **state)
{
    (void)state;
    enum { N = 200000 };
    double *x = normals(N, 12), held = 0;
    imk_spectrum_settings settings = imk_spectrum_default();
    imk_spectrum s;
    imk_spectrum_band bands[200];
    settings.dt = 1;
    CHECK_OK(estimate(&settings, N, x, &s));
    const size_t count = imk_spectrum_bands(&s, 20, 0.95, 0, NULL, 200, bands);
    assert_in_range(count, 50, 80);
    CHECK_RELATIVE(bands[0].from, 0.5 * s.step, 1e-12);
    CHECK_RELATIVE(bands[count - 1].to, 0.5, 1e-12);
    size_t inside = 0;
    for (size_t i = 0; i < count; i++) {
        if (i > 0)
            CHECK_RELATIVE(bands[i].from, bands[i - 1].to, 1e-12);
        held += bands[i].density * (bands[i].to - bands[i].from);
        inside += bands[i].lower <= 1 && bands[i].upper >= 1;
    }
    CHECK_CLOSE(held, 0.5, 0.5 * 5 * sqrt(2.0 / N) + 1e-4);
    assert_true(inside * 60 >= 45 * count);
    const imk_spectrum_line line = {.first = 5, .last = 3000};
    assert_true(imk_spectrum_bands(&s, 20, 0.95, 1, &line, 200, bands) < count);
    free(x);
}

/* N, B and K of simulated logs lie within their 95 % intervals, and a term that is not there is
 * rarely called present. 40 logs: less than 30 inside, or more than 9 false ones at 1 %, have
 * chances below 1e-6. */
static void test_parameters(void **state)
{
    (void)state;
    enum { N = 1 << 16 };
    const uint32_t logs = check_runs(40);
    const double dt = 0.1, truth[] = {0, 8.7e-5, 4e-5, 1.5e-6};
    double *x = malloc(N * sizeof *x);
    uint32_t inside[4] = {0}, present[4] = {0};
    static imk_flicker_state flicker;
    static imk_white_state white;
    static imk_random_walk_state walk;
    for (uint32_t log = 0; log < logs; log++) {
        const imk_random random = imk_random_seeded(100 + log);
        imk_spectrum s;
        imk_spectrum_parameters p;
        imk_spectrum_settings settings = imk_spectrum_default();
        for (size_t i = 0; i < N; i++)
            x[i] = 9.8;
        CHECK_OK(imk_white_start(&white, truth[1], dt, random, 1));
        imk_white_add(&white, N, x);
        CHECK_OK(imk_flicker_start(&flicker, (imk_flicker){truth[2], 0}, dt, random,
                                   imk_stream(0, 2, 0, 0)));
        imk_flicker_add(&flicker, N, x);
        CHECK_OK(imk_random_walk_start(&walk, truth[3], dt, random, 3));
        imk_random_walk_add(&walk, N, x);
        settings.dt = dt;
        settings.resolution = 1.5 / (N / 8 * dt);
        CHECK_OK(estimate(&settings, N, x, &s));
        CHECK_OK(imk_spectrum_fit(&s, 0, NULL, 0, 0, 0.95, 0.01, &p));
        for (int term = 0; term < 4; term++) {
            present[term] += p.term[term].present;
            inside[term] += p.term[term].lower <= truth[term] && p.term[term].upper >= truth[term];
        }
        CHECK_BELOW(p.misfit, 2);
    }
    for (int term = 0; term < 4; term++)
        assert_true(4 * inside[term] >= 3 * logs);
    assert_int_equal(present[1], logs);
    assert_true(present[2] + 2 > logs);
    assert_true(present[0] * 40 <= 9 * logs);
    free(x);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_parseval),         cmocka_unit_test(test_white),
        cmocka_unit_test(test_figures_of_merit), cmocka_unit_test(test_slepian),
        cmocka_unit_test(test_leakage),          cmocka_unit_test(test_large_constant),
        cmocka_unit_test(test_missing),          cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_interval),         cmocka_unit_test(test_bands),
        cmocka_unit_test(test_parameters)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
