/* SPDX-License-Identifier: Apache-2.0 */
/* Does the search for the shape of the fast end find what is not there, and does it disturb the
 * slow terms?
 *
 * usage: spurious_resonances [records] [samples] [seed]
 *
 * Simulates records at 100 Hz of white noise, bias instability and random walk, alone and with one
 * thing more, and identifies them. Prints how often more resonances were found than there are, and
 * how often the 95 % intervals of N, B and K hold. Fails when more than 1 % of the records of a
 * kind have a spurious resonance (a record or two are always allowed). */
#include "imukit/identify.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* A tone between two cosine frequencies may be described as a resonance as narrow as the record
 * resolves. */
static const double LINE_Q = 1000;
static const double DT = 0.01, WHITE = 1, INSTABILITY = 1, WALK = 0.1;

typedef struct kind {
    const char *name;
    imk_low_pass filter;
    imk_resonance resonance;
    imk_gauss_markov process;
    imk_sinusoid sinusoid;
} kind;

static const kind KINDS[] = {
    {"N B K", {0, 0}, {0, 0, 0}, {0, 0}, {0, 0}},
    {"+ first-order filter at 61 Hz", {61, 0}, {0, 0, 0}, {0, 0}, {0, 0}},
    {"+ second-order filter at 40 Hz", {40, 0.7}, {0, 0, 0}, {0, 0}, {0, 0}},
    {"+ resonance at 20.3 Hz, Q 16", {0, 0}, {6, 20.3, 16}, {0, 0}, {0, 0}},
    {"+ filter and resonance", {61, 0}, {6, 20.3, 16}, {0, 0}, {0, 0}},
    {"+ Gauss-Markov of 1 s", {0, 0}, {0, 0, 0}, {1, 1}, {0, 0}},
    {"+ line at 17 Hz", {0, 0}, {0, 0, 0}, {0, 0}, {1, 17}},
};
enum { COUNT = sizeof KINDS / sizeof *KINDS };

static void simulate(const kind *k, size_t n, uint64_t seed, double *x)
{
    const imk_random random = imk_random_seeded(seed);
    imk_arma_state arma;
    imk_flicker_state *flicker = malloc(sizeof *flicker);
    imk_random_walk_state walk;
    for (size_t i = 0; i < n; i++)
        x[i] = 0;
    imk_filtered_white_start(&arma, WHITE, k->filter, DT, random, (uint64_t)1 << 40);
    imk_arma_add(&arma, n, x);
    imk_flicker_start(flicker, (imk_flicker){INSTABILITY, 0}, DT, random, (uint64_t)2 << 40);
    imk_flicker_add(flicker, n, x);
    free(flicker);
    imk_random_walk_start(&walk, WALK, DT, random, (uint64_t)3 << 40);
    imk_random_walk_add(&walk, n, x);
    if (k->resonance.sigma > 0) {
        imk_resonance_start(&arma, k->resonance, DT, random, (uint64_t)4 << 40);
        imk_arma_add(&arma, n, x);
    }
    if (k->process.sigma > 0) {
        imk_gauss_markov_state process;
        imk_gauss_markov_start(&process, k->process, DT, random, (uint64_t)5 << 40);
        imk_gauss_markov_add(&process, n, x);
    }
    if (k->sinusoid.amplitude > 0) {
        imk_sinusoid_state sinusoid;
        imk_sinusoid_start(&sinusoid, k->sinusoid, DT, random, (uint64_t)6 << 40);
        imk_sinusoid_add(&sinusoid, n, x);
    }
}

static bool holds(const imk_estimate *e, double truth)
{
    return truth >= e->lower && truth <= e->upper;
}

int main(int argc, char **argv)
{
    const size_t records = argc > 1 ? strtoul(argv[1], NULL, 10) : 300;
    const size_t n = argc > 2 ? strtoul(argv[2], NULL, 10) : 131072;
    const uint64_t seed = argc > 3 ? strtoull(argv[3], NULL, 10) : 1;
    double *x = malloc(n * sizeof *x);
    const size_t size = imk_identify_workspace_size(n);
    void *workspace = malloc(size);
    imk_identify_settings settings = imk_identify_default();
    settings.dt = DT;
    bool good = true;
    printf("%zu records of %zu samples at 100 Hz each\n%-32s %9s %9s %9s %9s %9s\n", records, n, "",
           "spurious", "missed", "N holds", "B holds", "K holds");
    for (size_t k = 0; k < COUNT; k++) {
        size_t spurious = 0, missed = 0, held[3] = {0, 0, 0};
        const int there = KINDS[k].resonance.sigma > 0;
        for (size_t i = 0; i < records; i++) {
            imk_identification r;
            simulate(&KINDS[k], n, seed + i, x);
            if (imk_identify_channel(&settings, n, x, &r, workspace, size, NULL) != IMK_OK)
                return 1;
            int found = 0;
            for (int j = 0; j < r.resonance_count; j++)
                found += r.resonance[j].q < LINE_Q;
            spurious += found > there;
            missed += found < there;
            held[0] += holds(&r.term[IMK_NOISE_WHITE], WHITE);
            held[1] += holds(&r.term[IMK_NOISE_BIAS_INSTABILITY], INSTABILITY);
            held[2] += holds(&r.term[IMK_NOISE_RANDOM_WALK], WALK);
        }
        const double percent = 100 / (double)records;
        printf("%-32s %7.1f %% %7.1f %% %7.1f %% %7.1f %% %7.1f %%\n", KINDS[k].name,
               percent * (double)spurious, percent * (double)missed, percent * (double)held[0],
               percent * (double)held[1], percent * (double)held[2]);
        fflush(stdout);
        good = good && (double)spurious <= 2 + 0.01 * (double)records;
    }
    free(workspace);
    free(x);
    return !good;
}
