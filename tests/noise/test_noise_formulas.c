/* SPDX-License-Identifier: Apache-2.0 */
/* Allan variances and spectra of the stochastic terms, against sums over autocovariances,
 * quadrature of the spectrum, aliasing sums, and published or multiprecision values. */
#include "check.h"

#include "imukit/noise.h"

static const double pi = 3.141592653589793;

/* ---- independent ways to the same numbers --------------------------------------------------- */

/* Allan variance of n-sample means from autocovariances at lags 0 … 2n-1:
 * (4 V(n) - V(2n))/(2 n^2), V(m) = sum over |k| < m of (m - |k|) R(k). */
typedef double (*autocovariance)(const double *parameters, size_t lag);

static long double variance_of_sum(autocovariance r, const double *parameters, size_t m)
{
    long double sum = (long double)m * r(parameters, 0);
    for (size_t k = 1; k < m; k++)
        sum += 2.0L * (long double)(m - k) * r(parameters, k);
    return sum;
}

static double brute_allan_variance(autocovariance r, const double *parameters, size_t n)
{
    long double once = variance_of_sum(r, parameters, n);
    long double twice = variance_of_sum(r, parameters, 2 * n);
    return (double)((4.0L * once - twice) / (2.0L * (long double)n * (long double)n));
}

/* The same from a two-sided spectrum of a sequence with dt = 1:
 * 2 * integral 0 … 1/2 of S(f) 2 sin^4(pi f n)/(n sin(pi f))^2 df, midpoint rule in log f, which
 * sees 1/f spectra evenly. The lower end 1e-9 leaves out less than 1e-9 of what is tested. */
typedef double (*spectrum)(const double *parameters, double f);

static double allan_variance_of_spectrum(spectrum s, const double *parameters, size_t n)
{
    enum { POINTS = 100000 };
    double range = log(0.5 / 1e-9), sum = 0.0;
    for (int i = 0; i < POINTS; i++) {
        double f = 0.5 * exp(-range * (i + 0.5) / POINTS);
        double half = sin(pi * f * (double)n), one = (double)n * sin(pi * f);
        sum += s(parameters, f) * half * half * half * half / (one * one) * f;
    }
    return 4.0 * sum * range / POINTS;
}

/* ---- closed forms of the lecture's five terms ----------------------------------------------- */

static void test_simple_terms(void **state)
{
    (void)state;
    /* N^2/tau, K^2 tau/3, R^2 tau^2/2, 3 Q^2/tau^2, (2 ln 2/pi) B^2 by hand */
    CHECK_RELATIVE(imk_white_allan_variance(3.0, 4.0), 2.25, 1e-15);
    CHECK_RELATIVE(imk_white_sampled_allan_variance(3.0, 0.5, 8), 2.25, 1e-15);
    CHECK_RELATIVE(imk_white_sampled_spectrum(3.0, 0.5, 0.1), 9.0, 1e-15);
    CHECK_RELATIVE(imk_random_walk_allan_variance(3.0, 4.0), 12.0, 1e-15);
    CHECK_RELATIVE(imk_ramp_allan_variance(3.0, 4.0), 72.0, 1e-15);
    CHECK_RELATIVE(imk_quantization_allan_variance(2.0, 4.0), 0.75, 1e-15);
    CHECK_RELATIVE(imk_quantization_sampled_allan_variance(2.0, 0.5, 8), 0.75, 1e-15);
    CHECK_RELATIVE(imk_flicker_allan_variance(2.0, 7.0), 4.0 * 2.0 * log(2.0) / pi, 1e-15);
    CHECK_CLOSE(sqrt(imk_flicker_allan_variance(1.0, 1.0)), 0.664, 5e-4); /* as published */
}

/* K^2 tau/3 (1 + 1/(2 n^2)): at n = 1 the difference of two points, K^2 dt/2. */
static void test_random_walk(void **state)
{
    (void)state;
    CHECK_RELATIVE(imk_random_walk_sampled_allan_variance(3.0, 0.1, 1), 9.0 * 0.1 / 2.0, 1e-15);
    for (size_t n = 1; n < 40; n++) {
        /* weights of the unit steps in mean2 - mean1: 1/n, 2/n … 1 … 1/n */
        double sum = 0.0;
        for (size_t j = 1; j <= n; j++)
            sum += (j < n ? 2.0 : 1.0) * (double)(j * j);
        double expected = 9.0 * 0.1 * sum / (2.0 * (double)(n * n));
        CHECK_RELATIVE(imk_random_walk_sampled_allan_variance(3.0, 0.1, n), expected, 1e-14);
    }
}

/* The cosine transform diagonalises the walk: for N points the coefficients
 * sqrt(2/N) sum y[j] cos(pi k (j + 1/2)/N) have mean squares S(k/(2 N dt))/dt exactly. The walk's
 * covariance is min(i, j) step^2. */
static void test_random_walk_spectrum(void **state)
{
    (void)state;
    enum { N = 24 };
    const double k = 0.7, dt = 0.02;
    for (int m = 1; m < N; m++) {
        double sum = 0.0;
        for (int i = 0; i < N; i++)
            for (int j = 0; j < N; j++)
                sum += cos(pi * m * (i + 0.5) / N) * cos(pi * m * (j + 0.5) / N) * (i < j ? i : j) *
                       k * k * dt;
        double spectrum_value = imk_random_walk_sampled_spectrum(k, dt, m / (2.0 * N * dt));
        CHECK_RELATIVE(spectrum_value / dt, 2.0 / N * sum, 1e-11);
    }
}

/* White residual of variance Q^2, differenced. */
static void test_quantization_spectrum(void **state)
{
    (void)state;
    const double q = 2e-6, dt = 0.01;
    CHECK_RELATIVE(imk_quantization_sampled_spectrum(q, dt, 0.5 / dt), 4.0 * q * q / dt, 1e-15);
    /* low frequencies: (2 pi f)^2 Q^2 dt, the continuous form [IEEE952]; sin x = x within 2e-7 */
    double f = 0.02;
    CHECK_RELATIVE(imk_quantization_sampled_spectrum(q, dt, f), 4.0 * pi * pi * f * f * q * q * dt,
                   1e-6);
}

/* ---- Gauss-Markov --------------------------------------------------------------------------- */

static double gauss_markov_r(const double *p, size_t lag)
{
    return p[0] * p[0] * exp(-(double)lag * p[2] / p[1]);
}

static double gauss_markov_s(const double *p, double f)
{
    return imk_gauss_markov_sampled_spectrum((imk_gauss_markov){p[0], p[1]}, 1.0, f);
}

static void test_gauss_markov_check_values(void **state)
{
    (void)state;
    /* (n, phi, innovation variance) -> Allan variance, given to 8 digits: two independent checks */
    const double dt = 0.01;
    imk_gauss_markov slow = {1.0 / sqrt(1.0 - 0.81), -dt / log(0.9)};
    imk_gauss_markov fast = {sqrt(2.0 / 0.75), -dt / log(0.5)};
    CHECK_CLOSE(imk_gauss_markov_sampled_allan_variance(slow, dt, 5), 1.3042822, 5e-8);
    CHECK_CLOSE(imk_gauss_markov_sampled_allan_variance(fast, dt, 8), 0.7513008, 5e-8);
}

static void test_gauss_markov_sums(void **state)
{
    (void)state;
    const double ratios[] = {0.01, 0.1, 0.5, 1.0, 2.0}; /* dt/T */
    for (size_t i = 0; i < sizeof ratios / sizeof *ratios; i++)
        for (size_t n = 1; n < 300; n = 3 * n + 1) {
            double p[] = {0.3, 1.0 / ratios[i], 1.0};
            double expected = brute_allan_variance(gauss_markov_r, p, n);
            /* the sum of autocovariances itself cancels to about 1e-16/avar */
            CHECK_CLOSE(
                imk_gauss_markov_sampled_allan_variance((imk_gauss_markov){p[0], p[1]}, 1.0, n),
                expected, 1e-13);
            double by_spectrum = allan_variance_of_spectrum(gauss_markov_s, p, n);
            if (n < 20) /* the midpoint rule resolves sin^4(pi n f) to 1e-7 there */
                CHECK_RELATIVE(by_spectrum, expected, 1e-7);
        }
}

/* Where the closed forms cancel: 50-digit values of
 *     (n - 3 phi - n phi^2 + 4 phi^(n+1) - phi^(2n+1))/(n (1 - phi))^2,  phi = exp(-x),
 *     (2 x - 3 + 4 e^-x - e^-2x)/x^2                     (tests/reference/gauss_markov_allan.py) */
static void test_gauss_markov_cancellation(void **state)
{
    (void)state;
    static const struct {
        double x;
        size_t n;
        double sampled;
    } reference[] = {
#include "reference/gauss_markov_sampled.inc"
    };
    for (size_t i = 0; i < sizeof reference / sizeof *reference; i++) {
        imk_gauss_markov process = {1.0, 1.0};
        double value =
            imk_gauss_markov_sampled_allan_variance(process, reference[i].x, reference[i].n);
        CHECK_RELATIVE(value, reference[i].sampled, 1e-14); /* 20 operations and an exponential */
    }
    static const struct {
        double x, continuous;
    } limit[] = {
#include "reference/gauss_markov_continuous.inc"
    };
    for (size_t i = 0; i < sizeof limit / sizeof *limit; i++)
        CHECK_RELATIVE(imk_gauss_markov_allan_variance((imk_gauss_markov){1.0, 1.0}, limit[i].x),
                       limit[i].continuous, 1e-14);
}

/* ---- sinusoid ------------------------------------------------------------------------------- */

static double sinusoid_r(const double *p, size_t lag)
{
    return 0.5 * p[0] * p[0] * cos(2.0 * pi * p[1] * (double)lag);
}

static void test_sinusoid(void **state)
{
    (void)state;
    for (double f = 0.013; f < 2.5; f += 0.17)
        for (size_t n = 1; n < 60; n = 2 * n + 1) {
            double p[] = {1.7, f};
            CHECK_CLOSE(imk_sinusoid_sampled_allan_variance((imk_sinusoid){1.7, f}, 1.0, n),
                        brute_allan_variance(sinusoid_r, p, n), 1e-12);
        }
    /* a whole number of cycles a sample is a constant */
    CHECK_CLOSE(imk_sinusoid_sampled_allan_variance((imk_sinusoid){1.7, 3.0}, 1.0, 4), 0.0, 0.0);
    /* many samples per cycle: the continuous form, to (pi f dt)^2/3 */
    CHECK_RELATIVE(imk_sinusoid_sampled_allan_variance((imk_sinusoid){1.0, 1.0}, 1e-4, 3000),
                   imk_sinusoid_allan_variance((imk_sinusoid){1.0, 1.0}, 0.3), 1e-6);
    /* at f tau = 1/2 it is a^2 (2/pi)^2 */
    CHECK_RELATIVE(imk_sinusoid_allan_variance((imk_sinusoid){3.0, 0.5}, 1.0),
                   9.0 * 4.0 / (pi * pi), 1e-15);
}

/* ---- flicker -------------------------------------------------------------------------------- */

/* Of samples `interval` apart, recomputed: the stages of noise.h, their times from the longest
 * down.
 */
typedef struct stages {
    int count;
    double x;       /* time of stage 1 */
    double phi[2];  /* of stage 0, of the others */
    double fastest; /* variance of stage 0 relative to the others */
} stages;

static stages stages_of(double longest, double interval)
{
    double x = 3.0 * pi / (8.0 * log(4.0)) * longest / interval;
    if (x < 1.5)
        return (stages){1, 0.0, {0.0, 0.0}, 8.0 / 3.0 * x};
    int count = 2;
    for (; x >= 6.0; count++)
        x /= 4.0;
    const double l = log(x);
    return (stages){count,
                    x,
                    {0.36056 - 0.34515 * l + 0.37854 * l * l - 0.08901 * l * l * l,
                     (2.0 * x - 1.0) / (2.0 * x + 1.0)},
                    0.24881 + 0.66356 * l + 0.048 * l * l - 0.02265 * l * l * l};
}

/* Autocovariance of the stages of p = {longest time, interval}, B = 1: those that are held are
 * their coarse sequences interpolated. */
static double flicker_r(const double *p, size_t lag)
{
    const stages s = stages_of(p[0], p[1]);
    double sum = s.fastest * pow(s.phi[0], (double)lag);
    for (int j = 1; j < s.count; j++) {
        const double hold = pow(4.0, j - 1.0), a = floor((double)lag / hold);
        const double b = (double)lag - a * hold;
        sum += pow(s.phi[1], a) * (1.0 - b / hold + s.phi[1] * b / hold);
    }
    return log(4.0) / pi * sum;
}

static double flicker_s(const double *p, double f)
{
    return imk_flicker_sampled_spectrum((imk_flicker){1.0, p[0]}, p[1], f / p[1]) / p[1];
}

/* Longest times that give x from one end of its range to the other, few stages and many, and white
 * noise. */
static const double longest[] = {0.5, 1.7, 1.8, 3.0, 6.9, 30.0, 1e3, 3e5, 1e6, 5.1e6, 1e12};
enum { LONGEST = sizeof longest / sizeof *longest };

static void test_flicker_is_the_sum_of_its_stages(void **state)
{
    (void)state;
    for (size_t i = 0; i < LONGEST; i++)
        for (size_t n = 1; n < 200; n = 2 * n + 3) {
            const double p[] = {longest[i], 0.01};
            const imk_flicker flicker = {0.5, longest[i]};
            /* slow stages are differences of numbers near 1: 24 of them leave 1e-14 */
            CHECK_CLOSE(imk_flicker_sampled_allan_variance(flicker, 0.01, n),
                        0.25 * brute_allan_variance(flicker_r, p, n), 5e-14);
            double sum = 0.0;
            for (size_t lag = 0; lag < n; lag++)
                sum += (lag == 0 ? 1.0 : 2.0) * (double)(n - lag) * flicker_r(p, lag);
            CHECK_RELATIVE(imk_flicker_mean_variance(flicker, 0.01, n),
                           0.25 * sum / (double)(n * n), 1e-13);
        }
}

/* No time stated is 1e6 s. */
static void test_flicker_default_time(void **state)
{
    (void)state;
    CHECK_CLOSE(imk_flicker_mean_variance((imk_flicker){1.0, 0.0}, 0.01, 1000),
                imk_flicker_mean_variance((imk_flicker){1.0, 1e6}, 0.01, 1000), 0.0);
    CHECK_CLOSE(IMK_FLICKER_TIME, 1e6, 0.0);
}

static void test_flicker_spectrum_and_allan_agree(void **state)
{
    (void)state;
    for (size_t i = 0; i < LONGEST; i++)
        for (size_t n = 1; n < 20; n = 2 * n + 1) {
            const double p[] = {longest[i], 1.0};
            CHECK_RELATIVE(
                allan_variance_of_spectrum(flicker_s, p, n),
                imk_flicker_sampled_allan_variance((imk_flicker){1.0, longest[i]}, 1.0, n), 1e-6);
        }
}

/* The density at 0 Hz is B^2 T, whatever dt: from the flicker of half a million intervals down to
 * white noise, within 2 % where the fastest stage alone stands for many (stages_of()). */
static void test_flicker_is_flat_below(void **state)
{
    (void)state;
    for (double interval = 1.0; interval < 1e7; interval *= 1.7) {
        const double density =
            imk_flicker_sampled_spectrum((imk_flicker){2.0, 5e5}, interval, 1e-10);
        CHECK_RELATIVE(density, 4.0 * 5e5, interval < 1e4 ? 1e-3 : interval < 2.8e5 ? 0.02 : 1e-12);
    }
}

/* E c_k^2 of n samples from their autocovariance: sum over lags of R(l) times the autocorrelation
 * of the transform's row. */
static double expected_square(double (*r)(const double *, size_t), const double *p, size_t n,
                              size_t k)
{
    double row[512], sum = 0.0;
    for (size_t i = 0; i < n; i++)
        row[i] = sqrt(2.0 / (double)n) * cos(pi * (double)k * ((double)i + 0.5) / (double)n);
    for (size_t lag = 0; lag < n; lag++) {
        double product = 0.0;
        for (size_t i = 0; i + lag < n; i++)
            product += row[i] * row[i + lag];
        sum += (lag == 0 ? 1.0 : 2.0) * product * r(p, lag);
    }
    return sum;
}

static void test_cosine_spectrum(void **state)
{
    (void)state;
    const size_t n = 509;
    for (double time = 0.3; time < 1e5; time *= 7.0) {
        const double p[] = {1.0, time, 0.1}; /* sigma, T, dt */
        for (size_t k = 1; k < n; k = 2 * k + 1)
            /* both sums lose digits to the lags' cancellation: 1e-13 of the variance times n */
            CHECK_CLOSE(imk_gauss_markov_cosine_spectrum((imk_gauss_markov){1.0, time}, 0.1, n, k) /
                            0.1,
                        expected_square(gauss_markov_r, p, n, k), 2e-10);
    }
    /* The end correction takes held stages for ones that are not held. */
    for (size_t i = 0; i < LONGEST; i++)
        for (size_t k = 1; k < 64; k++) {
            const double p[] = {longest[i], 0.1};
            CHECK_RELATIVE(imk_flicker_cosine_spectrum((imk_flicker){1.0, longest[i]}, 0.1, n, k) /
                               0.1,
                           expected_square(flicker_r, p, n, k), k < 9 ? 3.6e-2 : 1.6e-2);
        }
}

/* The Allan deviation of ideal flicker noise is sqrt(2 ln 2/pi) B at every tau. noise.h promises
 * 0.4 % from 2 dt to T/100 at every dt, 1 % less at 0.1 T and 10 % at T. */
static void test_flicker_is_flat(void **state)
{
    (void)state;
    const double ideal = sqrt(2.0 * log(2.0) / pi), time = 1e6;
    const imk_flicker flicker = {1.0, time};
    for (double interval = 1e-4; interval < 1e4; interval *= 1.13) {
        for (double m = 2.0; m * interval < 0.01 * time; m = ceil(m * 1.3))
            CHECK_CLOSE(sqrt(imk_flicker_sampled_allan_variance(flicker, interval, (size_t)m)) /
                            ideal,
                        1.0, 4e-3);
        const size_t n = (size_t)(time / interval);
        CHECK_CLOSE(sqrt(imk_flicker_sampled_allan_variance(flicker, interval, n / 10)) / ideal,
                    0.99, 4e-3);
        CHECK_CLOSE(sqrt(imk_flicker_sampled_allan_variance(flicker, interval, n)) / ideal, 0.89,
                    0.01);
        CHECK_CLOSE(sqrt(imk_flicker_sampled_allan_variance(flicker, interval, 1)) / ideal, 1.02,
                    0.013);
    }
}

/* S(f) = B^2/(2 pi f) but for the ripple of the stages, whose mean is 1. */
static void test_flicker_spectrum_is_1_over_f(void **state)
{
    (void)state;
    for (double x = 1.0; x < 4.0; x *= 1.1) {
        const imk_flicker flicker = {2.0, 1e8 * x};
        double sum = 0.0;
        int count = 0;
        for (double f = 0.1; f > 1e-5; f /= 1.003) {
            const double ratio =
                imk_flicker_sampled_spectrum(flicker, 0.01, f * 100.0) * 2.0 * pi * f * 100.0 / 4.0;
            CHECK_CLOSE(ratio, 0.965, 0.076);               /* 0.89 … 1.04, as noise.h says */
            if (f < 0.1 / 4.0 && f >= 0.1 / 4.0 / 4096.0) { /* six whole ratios of 4 */
                sum += ratio;
                count++;
            }
        }
        CHECK_CLOSE(sum / count, 1.0, 2e-3);
    }
}

/* ---- filtered white noise ------------------------------------------------------------------- */

static const imk_low_pass filters[] = {
    {1e-3, 0.0}, {1e-3, 0.7},       {0.05, 0.0},       {0.05, 0.05},  {0.05, 0.7071},
    {0.3, 1.0},  {0.3, 1.0 - 1e-9}, {0.3, 1.0 + 1e-9}, {0.3, 1.5},    {0.3, 50.0},
    {2.0, 0.0},  {2.0, 0.3},        {1000.0, 0.0},     {1000.0, 0.7}, {0.4, 0.0}};
enum { FILTERS = sizeof filters / sizeof *filters };

/* |H|^2 of a filter whose gain is 1/2 at the bandwidth: second order by bisection for w, so not the
 * closed form of the library. */
static double filter_power(imk_low_pass filter, double f)
{
    if (filter.damping == 0.0) {
        double ratio = f / filter.bandwidth;
        return 1.0 / (1.0 + ratio * ratio);
    }
    double low = 1e-3 * filter.bandwidth, high = 1e3 * filter.bandwidth;
    for (int i = 0; i < 80; i++) {
        double middle = sqrt(low * high), u = filter.bandwidth / middle;
        double power =
            1.0 / ((1.0 - u * u) * (1.0 - u * u) + 4.0 * filter.damping * filter.damping * u * u);
        *(power < 0.5 ? &low : &high) = middle;
    }
    double u = f / low, real = 1.0 - u * u, imaginary = 2.0 * filter.damping * u;
    return 1.0 / (real * real + imaginary * imaginary);
}

/* The sampled spectrum is the sum of the aliases of N^2 |H|^2 sinc^2(f dt). Beyond 2000 aliases
 * |H|^2 is constant or negligible, and the rest of the sum of 1/(f + k)^2 is 1/2000 of the sinc. */
static void test_filtered_white_spectrum(void **state)
{
    (void)state;
    const double frequency[] = {1e-4, 0.01, 0.13, 0.31, 0.5};
    for (int i = 0; i < FILTERS; i++)
        for (size_t j = 0; j < 5; j++) {
            enum { ALIASES = 2000 };
            double f = frequency[j], sum = 0.0, sine = sin(pi * f);
            for (int k = -ALIASES; k <= ALIASES; k++) {
                double g = f + k;
                sum += filter_power(filters[i], g) * sine * sine / (pi * pi * g * g);
            }
            double tail =
                filter_power(filters[i], ALIASES) * sine * sine / (pi * pi) * 2.0 / ALIASES;
            CHECK_RELATIVE(imk_filtered_white_sampled_spectrum(1.0, filters[i], 1.0, f), sum,
                           1e-9 + 1.1 * tail / sum);
        }
}

/* Midpoint rule in f, exact for a smooth periodic integrand: 6000 points see autocovariances that
 * have died away after as many samples, as those of filters from 0.05 up have. */
static void test_filtered_white_allan_variance(void **state)
{
    (void)state;
    for (int i = 2; i < FILTERS; i++)
        for (size_t n = 1; n < 40; n = 3 * n + 2) {
            enum { POINTS = 6000 };
            double sum = 0.0;
            imk_arma arma;
            CHECK_OK(imk_filtered_white_arma(1.0, filters[i], 1.0, &arma));
            for (int j = 0; j < POINTS; j++) {
                double f = 0.5 * (j + 0.5) / POINTS;
                double half = sin(pi * f * (double)n), one = (double)n * sin(pi * f);
                sum += imk_arma_spectrum(&arma, f) * half * half * half * half / (one * one);
            }
            CHECK_RELATIVE(imk_filtered_white_sampled_allan_variance(1.0, filters[i], 1.0, n),
                           2.0 * sum / POINTS, 1e-10);
        }
}

static void test_filtered_white_limits(void **state)
{
    (void)state;
    /* far above the rate: white; the first sample in the filter's time constant is what lacks */
    for (int second = 0; second < 2; second++) {
        imk_low_pass wide = {1e6, second ? 0.7 : 0.0};
        CHECK_RELATIVE(imk_filtered_white_sampled_allan_variance(2.0, wide, 1.0, 1), 4.0, 1e-6);
        CHECK_RELATIVE(imk_filtered_white_sampled_spectrum(2.0, wide, 1.0, 0.3), 4.0, 1e-6);
    }
    /* no filter */
    CHECK_RELATIVE(imk_filtered_white_sampled_spectrum(2.0, (imk_low_pass){0.0, 0.0}, 0.1, 3.0),
                   4.0, 1e-15);
    /* a first-order filter of continuous white noise is Gauss-Markov of sigma^2 = N^2 w/2,
     * averaged; its Allan variance is that of the continuous process */
    double w = 2.0 * pi * 0.002;
    imk_gauss_markov process = {sqrt(w / 2.0), 1.0 / w};
    for (size_t n = 1; n < 5000; n *= 7)
        CHECK_RELATIVE(
            imk_filtered_white_sampled_allan_variance(1.0, (imk_low_pass){0.002, 0.0}, 1.0, n),
            imk_gauss_markov_allan_variance(process, (double)n), 1e-11);
    /* long means: white again, N^2/tau (1 - O(time constant/tau)) */
    CHECK_RELATIVE(imk_filtered_white_sampled_allan_variance(1.0, filters[4], 1.0, 1000000000),
                   1e-9, 1e-7);
}

/* ---- resonance ------------------------------------------------------------------------------ */

/* {sigma, frequency, Q}, dt = 1: sigma^2 e^-at (cos bt + a/b sin bt) */
static double resonance_r(const double *p, size_t lag)
{
    double w = 2.0 * pi * p[1], a = 0.5 * w / p[2];
    double b = w * sqrt(1.0 - 0.25 / (p[2] * p[2])), t = (double)lag;
    return p[0] * p[0] * exp(-a * t) * (cos(b * t) + a / b * sin(b * t));
}

static void test_resonance_allan_variance(void **state)
{
    (void)state;
    const double cases[][3] = {{1.0, 0.1, 0.6},  {2.0, 0.1, 16.0}, {1.0, 0.37, 100.0},
                               {1.0, 0.21, 1e4}, {1.0, 0.01, 1e4}, {1.0, 1.3, 5.0},
                               {1.0, 0.5, 3.0}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        imk_resonance r = {cases[i][0], cases[i][1], cases[i][2]};
        for (size_t n = 1; n < 700; n = 3 * n + 2)
            /* the sum over autocovariances cancels: 1e-13 of the variance */
            CHECK_CLOSE(imk_resonance_sampled_allan_variance(r, 1.0, n),
                        brute_allan_variance(resonance_r, cases[i], n), 4e-13);
    }
    /* 1000 points a cycle approach the continuous form, to (w dt)^2 */
    imk_resonance fine = {1.0, 0.001, 7.0};
    CHECK_RELATIVE(imk_resonance_sampled_allan_variance(fine, 1.0, 700),
                   imk_resonance_allan_variance(fine, 700.0), 1e-5);
}

/* Transform of the autocovariance, summed until it has died away. */
static void test_resonance_spectrum(void **state)
{
    (void)state;
    const double cases[][3] = {{1.0, 0.1, 0.6},
                               {2.0, 0.1, 16.0},
                               {1.0, 0.37, 100.0},
                               {1.0, 1.3, 5.0},
                               {1.0, 0.021, 200.0}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        for (double f = 0.0107; f < 0.5; f *= 1.9) {
            size_t lags = (size_t)(15.0 * cases[i][2] / cases[i][1]); /* e^-47 */
            double sum = cases[i][0] * cases[i][0];
            for (size_t k = 1; k < lags; k++)
                sum += 2.0 * resonance_r(cases[i], k) * cos(2.0 * pi * f * (double)k);
            imk_resonance r = {cases[i][0], cases[i][1], cases[i][2]};
            /* rounding of up to 1e5 terms of size sigma^2 */
            CHECK_CLOSE(imk_resonance_sampled_spectrum(r, 1.0, f), sum, 1e-9);
        }
}

/* At Q = 1e4 the peak is a Lorentzian: height sigma^2 Q/(pi f0)/2 two-sided, half of it 1/(2Q) off
 * the centre, each to 1/Q. */
static void test_sharp_resonance(void **state)
{
    (void)state;
    imk_resonance r = {1.0, 0.1, 1e4};
    double height = 1e4 / (pi * 0.1) / 2.0 * 2.0;
    CHECK_RELATIVE(imk_resonance_sampled_spectrum(r, 1.0, 0.1), height, 1e-3);
    CHECK_RELATIVE(imk_resonance_sampled_spectrum(r, 1.0, 0.1 * (1.0 + 0.5e-4)), height / 2.0,
                   1e-3);
}

/* ---- arguments ------------------------------------------------------------------------------ */

static void test_arguments(void **state)
{
    (void)state;
    imk_random random = imk_random_seeded(1);
    imk_white_state white = {.sigma = 5.0};
    CHECK_STATUS(imk_white_start(&white, (double)NAN, 0.1, random, 0), IMK_ERROR_NOT_FINITE);
    CHECK_STATUS(imk_white_start(&white, -1.0, 0.1, random, 0), IMK_ERROR_RANGE);
    CHECK_STATUS(imk_white_start(&white, 1.0, 0.0, random, 0), IMK_ERROR_RANGE);
    CHECK_CLOSE(white.sigma, 5.0, 0.0); /* untouched */
    imk_gauss_markov_state gauss_markov;
    CHECK_STATUS(
        imk_gauss_markov_start(&gauss_markov, (imk_gauss_markov){1.0, 0.0}, 1.0, random, 0),
        IMK_ERROR_RANGE);
    CHECK_STATUS(imk_gauss_markov_start(&gauss_markov, (imk_gauss_markov){1.0, (double)INFINITY},
                                        1.0, random, 0),
                 IMK_ERROR_NOT_FINITE);
    imk_arma arma = {.b0 = 5.0};
    CHECK_STATUS(imk_filtered_white_arma(1.0, (imk_low_pass){1.0, 0.01}, 0.1, &arma),
                 IMK_ERROR_RANGE);
    CHECK_STATUS(imk_filtered_white_arma(1.0, (imk_low_pass){-1.0, 0.0}, 0.1, &arma),
                 IMK_ERROR_RANGE);
    CHECK_STATUS(imk_filtered_white_arma(1.0, (imk_low_pass){1e-9, 0.0}, 0.1, &arma),
                 IMK_ERROR_RANGE);
    CHECK_STATUS(imk_resonance_arma((imk_resonance){1.0, 1.0, 0.5}, 0.1, &arma), IMK_ERROR_RANGE);
    CHECK_STATUS(imk_resonance_arma((imk_resonance){1.0, (double)NAN, 5.0}, 0.1, &arma),
                 IMK_ERROR_NOT_FINITE);
    CHECK_CLOSE(arma.b0, 5.0, 0.0);
    imk_sinusoid_state sinusoid;
    CHECK_STATUS(imk_sinusoid_start(&sinusoid, (imk_sinusoid){1.0, 0.0}, 1.0, random, 0),
                 IMK_ERROR_RANGE);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_simple_terms),
        cmocka_unit_test(test_random_walk),
        cmocka_unit_test(test_random_walk_spectrum),
        cmocka_unit_test(test_quantization_spectrum),
        cmocka_unit_test(test_gauss_markov_check_values),
        cmocka_unit_test(test_gauss_markov_sums),
        cmocka_unit_test(test_gauss_markov_cancellation),
        cmocka_unit_test(test_sinusoid),
        cmocka_unit_test(test_flicker_is_the_sum_of_its_stages),
        cmocka_unit_test(test_flicker_default_time),
        cmocka_unit_test(test_flicker_is_flat_below),
        cmocka_unit_test(test_flicker_spectrum_and_allan_agree),
        cmocka_unit_test(test_cosine_spectrum),
        cmocka_unit_test(test_flicker_is_flat),
        cmocka_unit_test(test_flicker_spectrum_is_1_over_f),
        cmocka_unit_test(test_filtered_white_spectrum),
        cmocka_unit_test(test_filtered_white_allan_variance),
        cmocka_unit_test(test_filtered_white_limits),
        cmocka_unit_test(test_resonance_allan_variance),
        cmocka_unit_test(test_resonance_spectrum),
        cmocka_unit_test(test_sharp_resonance),
        cmocka_unit_test(test_arguments),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
