/* SPDX-License-Identifier: Apache-2.0 */
/* Noise models from tables of Allan variances: exact tables give their model back; simulated
 * records give it back within the stated intervals; published curves are explained. */
#include "check.h"

#include "imukit/allan_fit.h"
#include "imukit/random.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LENGTH = 1 << 20 };
static char workspace[1 << 22];
static const size_t LENGTH_OF_RECORD = LENGTH;

/* Octaves from `first` on and their exact variances under a model. */
typedef struct exact_table {
    size_t factors[32];
    double variances[32];
    imk_allan_table table;
} exact_table;

static void fill(exact_table *t, const imk_allan_noise *noise, double dt, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        t->factors[i] = (size_t)1 << i;
        t->variances[i] = imk_allan_noise_variance(noise, dt, t->factors[i]);
    }
    t->table = (imk_allan_table){.dt = dt,
                                 .count = count,
                                 .factors = t->factors,
                                 .variances = t->variances,
                                 .record_count = 1,
                                 .lengths = &LENGTH_OF_RECORD};
}

static imk_allan_fit fit_table(const imk_allan_fit_settings *settings, const exact_table *t)
{
    imk_allan_fit fit;
    imk_error error;
    CHECK_OK(imk_allan_fit_table(settings, &t->table, &fit, workspace, sizeof workspace, &error));
    return fit;
}

/* Five terms that the record shows clearly: back to rounding of the normal equations. */
static void test_exact_table(void **state)
{
    (void)state;
    const imk_allan_noise noise = {.term = {0.02, 1, 0.3, 0.02, 2e-4}};
    exact_table t;
    fill(&t, &noise, 0.01, 18);
    imk_allan_fit_settings settings = imk_allan_fit_default();
    for (int i = 0; i < IMK_NOISE_TERMS; i++)
        settings.keep[i] = true;
    const imk_allan_fit fit = fit_table(&settings, &t);
    for (int i = 0; i < IMK_NOISE_TERMS; i++) {
        assert_true(fit.term[i].present);
        CHECK_RELATIVE(fit.term[i].value, noise.term[i], 1e-6);
        CHECK_BELOW(fit.term[i].lower, noise.term[i]);
        CHECK_BELOW(noise.term[i], fit.term[i].upper);
    }
    CHECK_BELOW(fit.chi_square, 1e-6);
    assert_int_equal(fit.degrees, 13);
    assert_int_equal(fit.first, 0);
    /* White noise from n samples: sigma/N = 1/sqrt(2 n) is the least possible; the shortest octaves
     * of the overlapping variance together lose little against it. */
    CHECK_BELOW(1 / sqrt(2.0 * LENGTH), fit.term[IMK_NOISE_WHITE].sigma);
}

/* With one term C is proportional to the amount's square, so that the quasi-score is that of one
 * chi-square of v = 1/(2 (sigma/K)^2) degrees, and the interval must be v (x - 1 - log x) =
 * 3.84 (1 + 1/(3 v)), x = fitted/amount. Tolerance: Simpson's rule in panels of half a sigma. */
static void test_profile_is_chi_square(void **state)
{
    (void)state;
    const imk_allan_noise noise = {.term = {0, 0, 0, 1, 0}};
    static const size_t factors[3] = {LENGTH / 16, LENGTH / 8, LENGTH / 4};
    double variances[3];
    for (int i = 0; i < 3; i++)
        variances[i] = imk_allan_noise_variance(&noise, 1, factors[i]);
    const imk_allan_table table = {.dt = 1,
                                   .count = 3,
                                   .factors = factors,
                                   .variances = variances,
                                   .record_count = 1,
                                   .lengths = &LENGTH_OF_RECORD};
    imk_allan_fit_settings settings = imk_allan_fit_default();
    memset(settings.term, 0, sizeof settings.term);
    settings.keep[IMK_NOISE_RANDOM_WALK] = true;
    imk_allan_fit fit;
    CHECK_OK(imk_allan_fit_table(&settings, &table, &fit, workspace, sizeof workspace, NULL));
    const imk_estimate *k = &fit.term[IMK_NOISE_RANDOM_WALK];
    CHECK_RELATIVE(k->value, 1, 1e-9);
    const double v = 1 / (2 * k->sigma * k->sigma), drop = 3.841458820694124 * (1 + 1 / (3 * v));
    const double low = 1 / (k->lower * k->lower), high = 1 / (k->upper * k->upper);
    CHECK_RELATIVE(v * (low - 1 - log(low)), drop, 2e-3);
    CHECK_RELATIVE(v * (high - 1 - log(high)), drop, 2e-3);
}

static void test_gauss_markov(void **state)
{
    (void)state;
    for (int i = 0; i < 3; i++) {
        static const double times[3] = {1, 20, 300}, sigmas[3] = {0.5, 0.3, 0.2};
        imk_allan_noise noise = {.term = {0, 1, 0, 0, 0}, .gauss_markov_count = 1};
        noise.gauss_markov[0] = (imk_gauss_markov){sigmas[i], times[i]};
        exact_table t;
        fill(&t, &noise, 0.1, 18);
        imk_allan_fit_settings settings = imk_allan_fit_default();
        settings.gauss_markov_max = 2;
        const imk_allan_fit fit = fit_table(&settings, &t);
        assert_int_equal(fit.gauss_markov_count, 1);
        /* Golden sections end within 5e-4 of the logarithm's range. */
        CHECK_RELATIVE(fit.gauss_markov[0].correlation_time.value, times[i], 1e-3);
        CHECK_RELATIVE(fit.gauss_markov[0].sigma.value, sigmas[i], 1e-3);
        CHECK_BELOW(fit.gauss_markov[0].correlation_time.lower, times[i]);
        CHECK_BELOW(times[i], fit.gauss_markov[0].correlation_time.upper);
        assert_false(fit.term[IMK_NOISE_BIAS_INSTABILITY].present);
    }
}

static void test_shapes(void **state)
{
    (void)state;
    imk_allan_noise noise = {
        .term = {0, 1, 0.1, 0, 0}, .filter = {30, 0.7}, .sinusoid_count = 1, .resonance_count = 1};
    noise.sinusoid[0] = (imk_sinusoid){0.5, 0.56};
    noise.resonance[0] = (imk_resonance){3, 20.3, 16};
    exact_table t;
    fill(&t, &noise, 0.01, 18);
    imk_allan_fit_settings settings = imk_allan_fit_default();
    settings.filter = noise.filter;
    settings.sinusoid_count = settings.resonance_count = 1;
    settings.sinusoid[0].frequency = 0.58; /* 4 % off: refined */
    settings.sinusoid_refine = true;
    settings.resonance[0] = noise.resonance[0];
    const imk_allan_fit fit = fit_table(&settings, &t);
    /* 16 golden sections of +-0.1 end within 1e-4. */
    CHECK_RELATIVE(fit.noise.sinusoid[0].frequency, 0.56, 2e-4);
    CHECK_RELATIVE(fit.sinusoid[0].value, 0.5, 2e-3);
    CHECK_RELATIVE(fit.resonance[0].value, 3, 2e-3);
    CHECK_RELATIVE(fit.term[IMK_NOISE_WHITE].value, 1, 2e-3);
    CHECK_RELATIVE(fit.term[IMK_NOISE_BIAS_INSTABILITY].value, 0.1, 0.02);
}

/* A filter that the settings do not know spoils the shortest tau only. */
static void test_trim(void **state)
{
    (void)state;
    const imk_allan_noise noise = {.term = {0, 1, 0.3, 0, 0}, .filter = {20, 0.7}};
    exact_table t;
    fill(&t, &noise, 0.01, 18);
    imk_allan_fit_settings settings = imk_allan_fit_default();
    settings.term[IMK_NOISE_QUANTIZATION] = false;
    imk_allan_fit fit = fit_table(&settings, &t);
    assert_in_range(fit.first, 3, 9);
    CHECK_RELATIVE(fit.term[IMK_NOISE_WHITE].value, 1, 0.05);
    CHECK_RELATIVE(fit.term[IMK_NOISE_BIAS_INSTABILITY].value, 0.3, 0.15);
    settings.trim = false;
    fit = fit_table(&settings, &t);
    assert_int_equal(fit.first, 0);
    CHECK_BELOW(fit.probability, 1e-10);
    settings.filter = noise.filter;
    fit = fit_table(&settings, &t);
    CHECK_BELOW(0.9, fit.probability);
    settings.filter.bandwidth = 0;
    settings.tolerance = 0.3; /* all of it admitted */
    fit = fit_table(&settings, &t);
    CHECK_BELOW(0.01, fit.probability);
}

enum { RECORD = 1 << 14, TAUS = 13 };

static void simulate(const imk_allan_noise *noise, uint64_t seed, double *variances)
{
    static double y[RECORD + 1];
    static imk_white_state white;
    static imk_flicker_state flicker;
    static imk_random_walk_state walk;
    const imk_random random = imk_random_seeded(seed);
    size_t factors[TAUS];
    for (size_t i = 0; i < TAUS; i++)
        factors[i] = (size_t)1 << i;
    memset(y, 0, sizeof y);
    CHECK_OK(imk_white_start(&white, noise->term[1], 1, random, 1));
    CHECK_OK(imk_flicker_start(&flicker, (imk_flicker){noise->term[2], 0}, 1, random, 2ull << 32));
    CHECK_OK(imk_random_walk_start(&walk, noise->term[3], 1, random, 3ull << 32));
    imk_white_add(&white, RECORD, y);
    imk_flicker_add(&flicker, RECORD, y);
    imk_random_walk_add(&walk, RECORD, y);
    imk_allan_sums(RECORD, y, y, NULL);
    imk_allan_variances(IMK_ALLAN_OVERLAPPING, RECORD, y, TAUS, factors, variances, NULL, NULL);
}

/* Simulated records: intervals hold, squares have no bias, chi-square is as probable as it says.
 * Coverage of 95 % over R records is within sqrt(.0475/R) times 5.5 (skewed: and 2 %); means within
 * 5.5 standard errors and a tenth of a standard deviation; 4e-8 each. */
static void test_simulated_records(void **state)
{
    (void)state;
    const uint32_t runs = check_runs(100);
    const imk_allan_noise noise = {.term = {0, 1, 0.1, 0.003, 0}};
    exact_table t;
    fill(&t, &noise, 1, TAUS);
    const size_t length = RECORD;
    t.table.lengths = &length;
    imk_allan_fit_settings settings = imk_allan_fit_default();
    /* Called present by chance, in one record of a hundred, it takes some white noise with it. */
    settings.term[IMK_NOISE_QUANTIZATION] = false;
    double mean[3] = {0}, square[3] = {0}, covered[3] = {0}, improbable = 0;
    for (uint32_t r = 0; r < runs; r++) {
        simulate(&noise, 100 + r, t.variances);
        const imk_allan_fit fit = fit_table(&settings, &t);
        improbable += fit.probability < 0.05;
        for (int i = 0; i < 3; i++) {
            const imk_estimate *e = &fit.term[IMK_NOISE_WHITE + i];
            const double truth = noise.term[IMK_NOISE_WHITE + i];
            const double ratio = e->free_value * e->free_value / (truth * truth);
            covered[i] += e->lower <= truth && truth <= e->upper;
            mean[i] += ratio / runs;
            square[i] += ratio * ratio / runs;
        }
    }
    for (int i = 0; i < 3; i++) {
        const double sd = sqrt(square[i] - mean[i] * mean[i]);
        print_message("%c: covered %.3f, sd %.4f, bias %.3f sd\n", "NBK"[i], covered[i] / runs, sd,
                      (mean[i] - 1) / sd);
        CHECK_BELOW(0.95 - 0.02 - 5.5 * sqrt(0.0475 / runs), covered[i] / runs);
        CHECK_CLOSE(mean[i], 1, (0.1 + 5.5 / sqrt(runs)) * sd);
    }
    /* The bound 1/sqrt(2 n) of N, for the square twice that; octaves lose some percent. */
    CHECK_BELOW(sqrt(square[0] - mean[0] * mean[0]),
                2 / sqrt(2.0 * RECORD) * (1.15 + 5.5 / sqrt(2.0 * runs)));
    CHECK_BELOW(improbable / runs, 0.05 + 0.03 + 5.5 * sqrt(0.0475 / runs));
}

/* White noise alone: what is not there is not called present. At 1 % for each of three terms and a
 * tenth for the ramp, 100 records have 3.1 in the mean and more than 16 by chance in 3e-8 of
 * trials. */
static void test_white_only(void **state)
{
    (void)state;
    const uint32_t runs = check_runs(100);
    const imk_allan_noise noise = {.term = {0, 1, 0, 0, 0}};
    exact_table t;
    fill(&t, &noise, 1, TAUS);
    const size_t length = RECORD;
    t.table.lengths = &length;
    const imk_allan_fit_settings settings = imk_allan_fit_default();
    unsigned present = 0;
    for (uint32_t r = 0; r < runs; r++) {
        simulate(&noise, 5000 + r, t.variances);
        const imk_allan_fit fit = fit_table(&settings, &t);
        assert_true(fit.term[IMK_NOISE_WHITE].present);
        for (int i = 0; i < IMK_NOISE_TERMS; i++)
            present += i != IMK_NOISE_WHITE && fit.term[i].present;
    }
    print_message("white noise only: %u of %u called something else\n", present, runs);
    assert_in_range(present, 0, 16);
}

/* The bootstrap's scatter agrees with the asymptotic sigma where there are many degrees of freedom:
 * 100 draws have 7 % of their own; 5.5 of them are 39 %; and its profile intervals hold. */
static void test_bootstrap(void **state)
{
    (void)state;
    enum { DRAWS = 100 };
    const imk_allan_noise noise = {.term = {0, 1, 0.3, 0, 0}};
    exact_table t;
    fill(&t, &noise, 0.01, 18);
    const imk_allan_fit_settings settings = imk_allan_fit_default();
    const imk_allan_fit fit = fit_table(&settings, &t);
    imk_allan_bootstrap result, again;
    CHECK_OK(imk_allan_fit_bootstrap(&settings, &t.table, &fit, imk_random_seeded(5), DRAWS,
                                     &result, workspace, sizeof workspace));
    for (int i = IMK_NOISE_WHITE; i <= IMK_NOISE_BIAS_INSTABILITY; i++) {
        const struct imk_allan_bootstrap_term *b = &result.term[i];
        CHECK_RELATIVE(b->sigma, 2 * fit.term[i].sigma / fit.term[i].value, 0.39);
        CHECK_CLOSE(b->bias, 0, 0.55 * b->sigma);
        CHECK_CLOSE(b->covered, 0.95, 0.02 + 5.5 * sqrt(0.0475 / DRAWS));
        CHECK_BELOW(b->lower, fit.term[i].value);
        CHECK_BELOW(fit.term[i].value, b->upper);
    }
    assert_true(result.term[IMK_NOISE_RANDOM_WALK].sigma == 0);
    CHECK_BELOW(0.97, result.probability); /* the exact table's chi-square is 0 */
    CHECK_OK(imk_allan_fit_bootstrap(&settings, &t.table, &fit, imk_random_seeded(5), DRAWS, &again,
                                     workspace, sizeof workspace));
    assert_memory_equal(&result, &again, sizeof result);
    CHECK_STATUS(imk_allan_fit_bootstrap(&settings, &t.table, &fit, imk_random_seeded(5), 19,
                                         &again, workspace, sizeof workspace),
                 IMK_ERROR_RANGE);
}

/* Gyro z of a published 36 h curve: 99 tau, of which a quarter octave apart are taken. It is a
 * plain (not overlapping) Allan variance: read so, chi-square is probable; read as overlapping, its
 * scatter is impossible. The maker's angle random walk is 0.039 deg/sqrt(h). */
static void test_published_curve(void **state)
{
    (void)state;
#ifdef SHARED_DIRECTORY
    FILE *file = fopen(SHARED_DIRECTORY "/data/reference/hg4930_36h_adev.csv", "r");
    if (!file)
        skip();
    static size_t factors[IMK_ALLAN_FIT_FACTORS_MAX];
    static double variances[IMK_ALLAN_FIT_FACTORS_MAX];
    size_t count = 0;
    char line[512];
    while (fgets(line, sizeof line, file) && count < IMK_ALLAN_FIT_FACTORS_MAX) {
        double tau, value = 0;
        char *at = line;
        tau = strtod(line, &at);
        for (int i = 0; i < 6 && at != line && *at == ','; i++)
            value = strtod(at + 1, &at);
        if (!(value > 0) || (count > 0 && tau * 10 < 1.25 * (double)factors[count - 1]))
            continue;
        factors[count] = (size_t)(tau * 10 + 0.5);
        variances[count++] = value * value;
    }
    fclose(file);
    assert_in_range(count, 30, 40);
    const size_t length = 1296000;
    imk_allan_table table = {.dt = 0.1,
                             .count = count,
                             .factors = factors,
                             .variances = variances,
                             .strides = factors,
                             .record_count = 1,
                             .lengths = &length};
    imk_allan_fit_settings settings = imk_allan_fit_default();
    settings.tolerance = 0.02; /* the shortest tau hold more than the five terms */
    imk_allan_fit fit;
    CHECK_OK(imk_allan_fit_table(&settings, &table, &fit, workspace, sizeof workspace, NULL));
    CHECK_BELOW(0.01, fit.probability);
    CHECK_RELATIVE(fit.term[IMK_NOISE_WHITE].value * 60, 0.039, 0.03);
    settings.tolerance = 0;
    table.strides = NULL;
    CHECK_OK(imk_allan_fit_table(&settings, &table, &fit, workspace, sizeof workspace, NULL));
    CHECK_BELOW(fit.probability, 1e-10);
#else
    skip();
#endif
}

static void test_bad_arguments(void **state)
{
    (void)state;
    const imk_allan_noise noise = {.term = {0, 1, 0.3, 0, 0}};
    exact_table t;
    fill(&t, &noise, 0.01, 18);
    imk_allan_fit_settings settings = {0};
    imk_allan_fit fit = {.degrees = 77};
    imk_error error;
    const size_t size = sizeof workspace;
    CHECK_STATUS(imk_allan_fit_table(&settings, &t.table, &fit, workspace, size, &error),
                 IMK_ERROR_UNINITIALISED);
    settings = imk_allan_fit_default();
    settings.confidence = NAN;
    CHECK_STATUS(imk_allan_fit_table(&settings, &t.table, &fit, workspace, size, &error),
                 IMK_ERROR_RANGE);
    settings = imk_allan_fit_default();
    CHECK_STATUS(imk_allan_fit_table(&settings, &t.table, &fit, workspace, 100, &error),
                 IMK_ERROR_WORKSPACE);
    t.variances[3] = 0;
    CHECK_STATUS(imk_allan_fit_table(&settings, &t.table, &fit, workspace, size, &error),
                 IMK_ERROR_RANGE);
    t.variances[3] = NAN;
    CHECK_STATUS(imk_allan_fit_table(&settings, &t.table, &fit, workspace, size, &error),
                 IMK_ERROR_NOT_FINITE);
    t.table.variances = NULL;
    CHECK_STATUS(imk_allan_fit_table(&settings, &t.table, &fit, workspace, size, &error),
                 IMK_ERROR_ARGUMENT);
    assert_int_equal(fit.degrees, 77);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_exact_table),
        cmocka_unit_test(test_profile_is_chi_square),
        cmocka_unit_test(test_gauss_markov),
        cmocka_unit_test(test_shapes),
        cmocka_unit_test(test_trim),
        cmocka_unit_test(test_simulated_records),
        cmocka_unit_test(test_white_only),
        cmocka_unit_test(test_bootstrap),
        cmocka_unit_test(test_published_curve),
        cmocka_unit_test(test_bad_arguments),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
