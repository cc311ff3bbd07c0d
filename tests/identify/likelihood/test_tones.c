/* SPDX-License-Identifier: Apache-2.0 */
/* Strong tones and strong narrow resonances leave the white noise under them as it is. */
#include "check.h"
#include "identify/identify_values.h"
#include "identify/likelihood/identify_internal.h"
#include "imukit/fourier.h"
#include "imukit/noise.h"

#include <math.h>
#include <stdlib.h>

enum { SHORT = 1000, N = 6000, LONG = 20000 };
static const double DT = 0.01, TURN = 6.283185307179586;

/* White noise of strength 1 at 100 Hz: 10 standard deviations a sample. */
static void make_noise(uint32_t run, size_t n, double *x)
{
    imk_random_normals(imk_random_seeded(53), imk_stream(run, 1, 0, 0), 0, n, x);
    for (size_t i = 0; i < n; i++)
        x[i] *= 10;
}

static void add_tone(double amplitude, double frequency, size_t n, double *x)
{
    for (size_t i = 0; i < n; i++)
        x[i] += amplitude * sin(TURN * frequency * DT * (double)i + 0.3);
}

static void check_white(const imk_identification *r, double tolerance)
{
    const imk_estimate *white = &r->term[IMK_NOISE_WHITE];
    CHECK_CLOSE(white->value, 1, tolerance);
    assert_true(white->lower < white->value && white->value < white->upper);
    assert_true(white->lower > 1 - 3 * tolerance && white->upper < 1 + 3 * tolerance);
}

/* Each tone is below the skirts of the others where these are 3 to 300 times the noise. */
static void test_harmonics(void **state)
{
    static double x[LONG];
    static const double levels[] = {30, 300, 3000}, fundamentals[] = {7.31, 12};
    static const size_t lengths[] = {SHORT, N, LONG};
    (void)state;
    for (size_t level = 0; level < 3; level++)
        for (size_t f = 0; f < 2; f++)
            for (size_t k = 0; k < 3; k++) {
                const size_t n = lengths[k];
                make_noise((uint32_t)k, n, x);
                for (int harmonic = 1; harmonic <= 3; harmonic++)
                    add_tone(levels[level] / sqrt(harmonic), harmonic * fundamentals[f], n, x);
                const imk_identification r = identify_values(true, n, x);
                assert_int_equal(r.sinusoid_count, 3);
                for (int i = 0; i < 3; i++) {
                    const double amplitude = levels[level] / sqrt(i + 1);
                    const double sigma = 10 / amplitude * sqrt(6.0 / (double)n) /
                                         (0.5 * TURN * (double)n * DT); /* [RIFE1974] */
                    CHECK_CLOSE(r.sinusoid[i].frequency, (i + 1) * fundamentals[f], 4 * sigma);
                    CHECK_CLOSE(r.sinusoid[i].amplitude, amplitude, 40 * sqrt(2.0 / (double)n));
                }
                check_white(&r, n == SHORT ? 0.12 : 0.06);
            }
}

/* A tone of a few dozen cycles: the mean of the record and its own negative frequency move it. */
static void test_slow_tone(void **state)
{
    static double x[N];
    (void)state;
    for (uint32_t run = 0; run < 4; run++) {
        make_noise(10 + run, N, x);
        add_tone(300, 0.5, N, x);
        const imk_identification r = identify_values(true, N, x);
        assert_int_equal(r.sinusoid_count, 1);
        check_white(&r, 0.06);
    }
}

/* More tones than a model holds are all taken out; the strongest are in the result. */
static void test_many_tones(void **state)
{
    static double x[N];
    (void)state;
    make_noise(20, N, x);
    for (int i = 0; i < 12; i++)
        add_tone(i == 5 ? 60 : 40, 2.3 + 3.7 * i, N, x);
    const imk_identification r = identify_values(true, N, x);
    assert_int_equal(r.sinusoid_count, IMK_TERMS_MAX);
    CHECK_CLOSE(r.sinusoid[0].amplitude, 60, 2);
    check_white(&r, 0.06);
}

/* The skirts of a strong resonance are above the noise at nearly all frequencies: without those
 * there was nothing left to estimate the noise from. */
static void test_strong_narrow_resonance(void **state)
{
    static double x[LONG];
    (void)state;
    for (uint32_t run = 0; run < 4; run++) {
        imk_arma_state resonance;
        make_noise(30 + run, LONG, x);
        CHECK_STATUS(imk_resonance_start(&resonance, (imk_resonance){50, 3, 100}, DT,
                                         imk_random_seeded(53), imk_stream(30 + run, 2, 0, 0)),
                     IMK_OK);
        imk_arma_add(&resonance, LONG, x);
        const imk_identification r = identify_values(true, LONG, x);
        assert_int_equal(r.resonance_count, 1);
        CHECK_CLOSE(r.resonance[0].frequency, 3, 0.05);
        check_white(&r, 0.12);
    }
}

/* With less weight on some bands, as where residuals scatter or samples are missing, the ends of a
 * quantized record still explain no more than the power that there is: the likelihood falls as the
 * noise that is left goes to 0. */
static void test_ends_keep_their_part(void **state)
{
    static double x[N], scratch[N + 1], cumulative[N + 1];
    static imki_bands bands;
    static imki_fit fit;
    (void)state;
    const size_t size = imk_cosine_workspace_size(N);
    void *workspace = malloc(size);
    make_noise(40, N, x);
    x[0] += 1e5; /* as a large error before the first sample would */
    for (size_t i = 0; i < N; i++)
        scratch[i] = x[i];
    CHECK_STATUS(imk_cosine(N, scratch, workspace, size), IMK_OK);
    free(workspace);
    for (size_t k = 1; k < N; k++)
        cumulative[k + 1] = cumulative[k] + scratch[k] * scratch[k] * DT;
    imki_bands_build(&bands, N, DT, scratch, cumulative, 0, NULL, 0, NULL);
    fit.templates = IMKI_FIRST_RESONANCE;
    imki_templates_set(&fit, &bands);
    fit.active[IMK_NOISE_QUANTIZATION] = fit.active[IMK_NOISE_WHITE] = true;
    for (size_t b = 0; b < bands.count; b++)
        imki_bands_weigh(&bands, b, 0.1);
    double previous = -HUGE_VAL;
    for (double level = 1e-12; level < 10; level *= 10) {
        fit.amount[IMK_NOISE_QUANTIZATION] = 1e-2 * level;
        fit.amount[IMK_NOISE_WHITE] = level;
        imki_fit_slope(&fit, &bands, 0, NULL, NULL, NULL); /* evaluates the fit */
        assert_true(fit.evaluation.log_likelihood > previous);
        previous = fit.evaluation.log_likelihood;
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_harmonics),
        cmocka_unit_test(test_slow_tone),
        cmocka_unit_test(test_many_tones),
        cmocka_unit_test(test_strong_narrow_resonance),
        cmocka_unit_test(test_ends_keep_their_part),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
