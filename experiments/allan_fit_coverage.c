/* SPDX-License-Identifier: Apache-2.0 */
/* What a fit of Allan variances loses against the record itself: simulated records of 3 h at 100 Hz
 * with N = 0.3 deg/sqrt(h), B = 8 deg/h, K = 20 deg/h/sqrt(h) from the noise generators; scatter,
 * bias and interval coverage of N^2, B^2, K^2 from octaves, from ten tau a decade, and (with
 * LIKELIHOOD = 1) from imk_identify_channel().
 *
 *   allan_fit_coverage [LOGS=200] [SEED=1] [LIKELIHOOD=0] [BOOTSTRAP=0]
 *
 * The longest tau is a quarter of the record. */
#include "imukit/allan_fit.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SAMPLES = 1080000, METHODS = 3, TERMS = 3 };

static const double DEGREE = 3.14159265358979323846 / 180;
static const char *METHOD[METHODS] = {"octaves", "ten a decade", "likelihood"};
static const char *TERM[TERMS] = {"N", "B", "K"};

typedef struct tally {
    size_t trials, covered, asymptotic, present;
    double sum, squares, free_sum, free_squares, amplitude;
} tally;

static void count(tally *t, const imk_estimate *e, double truth)
{
    const double ratio = e->value * e->value / (truth * truth);
    const double free_ratio = e->free_value * e->free_value / (truth * truth);
    t->trials++;
    t->covered += e->lower <= truth && truth <= e->upper;
    t->asymptotic += e->present && fabs(e->value - truth) <= 1.959964 * e->sigma;
    t->present += e->present;
    t->sum += ratio;
    t->squares += ratio * ratio;
    t->free_sum += free_ratio;
    t->free_squares += free_ratio * free_ratio;
    t->amplitude += (e->value / truth - 1) * (e->value / truth - 1);
}

static void print(const char *name, const tally *t)
{
    const double n = (double)t->trials, mean = t->sum / n, free_mean = t->free_sum / n;
    const double sd = sqrt(t->squares / n - mean * mean);
    const double free_sd = sqrt(t->free_squares / n - free_mean * free_mean);
    printf(
        "  %s: covered %.2f %% (+- %.2f; asymptotic %.1f %%), present %.1f %%; square: sd %.3f %%, "
        "bias %.3f sd; all free: sd %.3f %%, bias %.3f sd\n",
        name, 100 * (double)t->covered / n, 100 * sqrt(0.05 * 0.95 / n),
        100 * (double)t->asymptotic / n, 100 * (double)t->present / n, 100 * sd, (mean - 1) / sd,
        100 * free_sd, (free_mean - 1) / free_sd);
}

static void simulate(double *y, const double *truth, double dt, uint64_t seed)
{
    static imk_white_state white;
    static imk_flicker_state flicker;
    static imk_random_walk_state walk;
    const imk_random random = imk_random_seeded(seed);
    memset(y, 0, SAMPLES * sizeof *y);
    imk_white_start(&white, truth[0], dt, random, 1);
    imk_flicker_start(&flicker, (imk_flicker){truth[1], 0}, dt, random, (uint64_t)2 << 32);
    imk_random_walk_start(&walk, truth[2], dt, random, (uint64_t)3 << 32);
    imk_white_add(&white, SAMPLES, y);
    imk_flicker_add(&flicker, SAMPLES, y);
    imk_random_walk_add(&walk, SAMPLES, y);
}

int main(int argc, char **argv)
{
    const size_t logs = argc > 1 ? strtoul(argv[1], NULL, 10) : 200;
    const uint64_t seed = argc > 2 ? strtoull(argv[2], NULL, 10) : 1;
    const int likelihood = argc > 3 ? atoi(argv[3]) : 0;
    const size_t draws = argc > 4 ? strtoul(argv[4], NULL, 10) : 0;
    const double truth[TERMS] = {0.3 * DEGREE / 60, 8 * DEGREE / 3600, 20 * DEGREE / 3600 / 60};
    const double dt = 0.01;
    double *y = malloc((SAMPLES + 1) * sizeof *y), *s = malloc((SAMPLES + 1) * sizeof *s);
    const size_t identify_size = imk_identify_workspace_size(SAMPLES);
    void *identify_memory = likelihood ? malloc(identify_size) : NULL;
    const imk_allan_fit_settings settings = imk_allan_fit_default();
    const size_t size = imk_allan_fit_workspace_size(&settings, IMK_ALLAN_FIT_FACTORS_MAX, 1000);
    void *memory = malloc(size);
    tally tallies[METHODS][TERMS] = {{{0}}};
    size_t failed = 0, spurious[METHODS][2] = {{0}}, improbable[METHODS] = {0};
    imk_allan_bootstrap bootstrap = {0};

    for (size_t log = 0; log < logs; log++) {
        simulate(y, truth, dt, (seed << 32) + log);
        imk_allan_sums(SAMPLES, y, s, NULL);
        for (int method = 0; method < 2; method++) {
            const imk_allan_grid grid = method == 0 ? IMK_ALLAN_OCTAVE : IMK_ALLAN_DECADE;
            size_t factors[128], n = SAMPLES;
            double variances[128];
            size_t taus = imk_allan_factors(grid, SAMPLES, factors);
            while (factors[taus - 1] > SAMPLES / 4)
                taus--;
            imk_allan_variances(IMK_ALLAN_OVERLAPPING, n, s, taus, factors, variances, NULL, NULL);
            const imk_allan_table table = {dt, taus, factors, variances, NULL, 1, &n};
            imk_allan_fit fit;
            if (imk_allan_fit_table(&settings, &table, &fit, memory, size, NULL) != IMK_OK) {
                failed++;
                continue;
            }
            for (int i = 0; i < TERMS; i++)
                count(&tallies[method][i], &fit.term[IMK_NOISE_WHITE + i], truth[i]);
            spurious[method][0] += fit.term[IMK_NOISE_QUANTIZATION].present;
            spurious[method][1] += fit.term[IMK_NOISE_RAMP].present;
            improbable[method] += fit.probability < 0.05;
            if (draws > 0 && log == 0)
                imk_allan_fit_bootstrap(&settings, &table, &fit, imk_random_seeded(seed), draws,
                                        &bootstrap, memory, size);
        }
        if (likelihood) {
            imk_identify_settings own = imk_identify_default();
            imk_identification result;
            own.dt = dt;
            failed += imk_identify_channel(&own, SAMPLES, y, &result, identify_memory,
                                           identify_size, NULL) != IMK_OK;
            for (int i = 0; i < TERMS; i++)
                count(&tallies[2][i], &result.term[IMK_NOISE_WHITE + i], truth[i]);
            spurious[2][0] += result.term[IMK_NOISE_QUANTIZATION].present;
            spurious[2][1] += result.term[IMK_NOISE_RAMP].present;
        }
    }
    for (int method = 0; method < 2 + likelihood; method++) {
        printf(
            "%s: spurious quantization %zu, ramp %zu; chi-square improbable at 5 %%: %zu of %zu\n",
            METHOD[method], spurious[method][0], spurious[method][1], improbable[method], logs);
        for (int i = 0; i < TERMS; i++)
            print(TERM[i], &tallies[method][i]);
    }
    for (int i = 0; i < TERMS && draws > 0; i++) {
        const struct imk_allan_bootstrap_term *t = &bootstrap.term[IMK_NOISE_WHITE + i];
        printf(
            "bootstrap of log 0, %s: bias %.3f, sd %.3f of the square, %.4g to %.4g of the truth, "
            "profile covers %.1f %%\n",
            TERM[i], t->bias, t->sigma, t->lower / truth[i], t->upper / truth[i], 100 * t->covered);
    }
    printf("failed: %zu\n", failed);
    free(y), free(s), free(memory), free(identify_memory);
    return failed > 0;
}
