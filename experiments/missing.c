/* SPDX-License-Identifier: Apache-2.0 */
/* Records with samples missing: do the intervals still hold?
 *
 * usage: missing [records] [seed] [case]
 *
 * Each record is an hour and a half at 10 Hz of N = 1, B = 0.8, K = 0.05 and what the case adds,
 * made by the generators of imukit/noise.h; samples are taken out, and the rest is identified.
 * Prints for each parameter how often its 95 % interval covers the truth, mean and scatter of the
 * likeliest square, the scatter the same records have when nothing is missing, and what was found
 * that is not there. */
#include "imukit/imukit.h"
#include "imukit/io.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { SAMPLES = 54000, WORKERS = 16 };
static const double STEP = 0.1;

typedef enum gaps { NONE, SCATTERED, HALF, HOLE, HOLES, BURSTS, THIRD, ALTERNATE } gaps;

typedef struct scene {
    const char *name;
    gaps gaps;
    double quantization;
    imk_low_pass filter;
    imk_sinusoid tone;
    imk_resonance resonance;
} scene;

static const scene scenes[] = {
    {.name = "complete", .gaps = NONE},
    {.name = "20 % missing at random", .gaps = SCATTERED},
    {.name = "half missing at random", .gaps = HALF},
    {.name = "one hole of 150 s", .gaps = HOLE},
    {.name = "50 holes of 10 s", .gaps = HOLES},
    {.name = "20 % missing in runs of 10", .gaps = BURSTS},
    {.name = "a third missing at the middle", .gaps = THIRD},
    {.name = "every other sample missing", .gaps = ALTERNATE},
    {.name = "complete, low-pass of 2 Hz", .gaps = NONE, .filter = {2, 0.7}},
    {.name = "20 %, low-pass of 2 Hz", .gaps = SCATTERED, .filter = {2, 0.7}},
    {.name = "hole, low-pass of 2 Hz", .gaps = HOLE, .filter = {2, 0.7}},
    {.name = "complete, quantization", .gaps = NONE, .quantization = 0.2},
    {.name = "20 %, quantization", .gaps = SCATTERED, .quantization = 0.2},
    {.name = "holes, quantization", .gaps = HOLES, .quantization = 0.2},
    {.name = "complete, line at 3.3 Hz", .gaps = NONE, .tone = {1.5, 3.3}},
    {.name = "20 %, line at 3.3 Hz", .gaps = SCATTERED, .tone = {1.5, 3.3}},
    {.name = "hole, line at 3.3 Hz", .gaps = HOLE, .tone = {1.5, 3.3}},
    {.name = "complete, resonance at 1.1 Hz", .gaps = NONE, .resonance = {3, 1.1, 12}},
    {.name = "20 %, resonance at 1.1 Hz", .gaps = SCATTERED, .resonance = {3, 1.1, 12}},
};

enum { SCENES = sizeof scenes / sizeof scenes[0], TERMS = 4 };
static const double truth[TERMS] = {0, 1, 0.8, 0.05}; /* by imk_noise_term */

typedef struct worker {
    const struct scene *scene;
    uint64_t seed, record;
    double *samples;
    void *workspace;
    imk_identification result;
    imk_status status;
} worker;

static void make_samples(worker *w)
{
    const imk_random random = imk_random_seeded(w->seed);
    const uint64_t stream = w->record << 8;
    imk_arma_state arma;
    imk_white_state white;
    imk_flicker_state flicker;
    imk_random_walk_state walk;
    double *x = w->samples;
    memset(x, 0, SAMPLES * sizeof *x);
    if (w->scene->filter.bandwidth > 0) {
        imk_filtered_white_start(&arma, truth[IMK_NOISE_WHITE], w->scene->filter, STEP, random,
                                 stream + 1);
        imk_arma_add(&arma, SAMPLES, x);
    } else {
        imk_white_start(&white, truth[IMK_NOISE_WHITE], STEP, random, stream + 1);
        imk_white_add(&white, SAMPLES, x);
    }
    imk_flicker_start(&flicker, (imk_flicker){truth[IMK_NOISE_BIAS_INSTABILITY], 0}, STEP, random,
                      stream + 2);
    imk_flicker_add(&flicker, SAMPLES, x);
    imk_random_walk_start(&walk, truth[IMK_NOISE_RANDOM_WALK], STEP, random, stream + 60);
    imk_random_walk_add(&walk, SAMPLES, x);
    if (w->scene->tone.amplitude > 0) {
        imk_sinusoid_state tone;
        imk_sinusoid_start(&tone, w->scene->tone, STEP, random, stream + 61);
        imk_sinusoid_add(&tone, SAMPLES, x);
    }
    if (w->scene->resonance.sigma > 0) {
        imk_resonance_start(&arma, w->scene->resonance, STEP, random, stream + 62);
        imk_arma_add(&arma, SAMPLES, x);
    }
    if (w->scene->quantization > 0) {
        imk_quantization_state quantization;
        imk_quantization_start(&quantization, w->scene->quantization, STEP, random, stream + 63);
        imk_quantization_apply(&quantization, SAMPLES, x);
    }
}

static void take_out(worker *w)
{
    uint32_t word[1];
    double u[2];
    size_t run = 0;
    for (size_t i = 0; i < SAMPLES; i++) {
        imk_random_words(imk_random_seeded(w->seed), (w->record << 8) + 70, i, 1, word);
        u[0] = word[0] / 4294967296.0;
        bool out = false;
        switch (w->scene->gaps) {
        case NONE:
            break;
        case SCATTERED:
            out = u[0] < 0.2;
            break;
        case HALF:
            out = u[0] < 0.5;
            break;
        case HOLE:
            out = i >= SAMPLES / 3 && i < SAMPLES / 3 + 1500;
            break;
        case HOLES:
            run = u[0] < 50.0 / SAMPLES ? 100 : run;
            out = run > 0;
            run -= run > 0;
            break;
        case BURSTS: /* stays out with 0.9, begins so that 20 % are out */
            out = run > 0 ? u[0] < 0.9 : u[0] < 0.025;
            run = out;
            break;
        case THIRD:
            out = i >= SAMPLES / 3 && i < 2 * SAMPLES / 3;
            break;
        case ALTERNATE:
            out = i % 2 == 1;
            break;
        }
        w->samples[i] = out ? (double)NAN : w->samples[i];
    }
}

static void work(void *context, size_t item)
{
    worker *w = (worker *)context + item;
    imk_identify_settings settings = imk_identify_default();
    settings.dt = STEP;
    make_samples(w);
    take_out(w);
    w->status = imk_identify_channel(&settings, SAMPLES, w->samples, &w->result, w->workspace,
                                     imk_identify_workspace_size(SAMPLES), NULL);
}

typedef struct tally {
    size_t covered, present;
    double sum, squares;
} tally;

static void run(const scene *one, size_t records, uint64_t seed, worker *workers,
                const imk_executor *executor)
{
    tally t[TERMS] = {0};
    size_t failed = 0, found = 0, ramps = 0, gauss_markov = 0, lines = 0, filters = 0, rounds = 0,
           misfits = 0;
    const clock_t begin = clock();
    for (size_t first = 0; first < records; first += WORKERS) {
        const size_t count = records - first < WORKERS ? records - first : WORKERS;
        for (size_t i = 0; i < count; i++) {
            workers[i].scene = one;
            workers[i].seed = seed;
            workers[i].record = first + i;
        }
        imk_execute(executor, count, work, workers);
        for (size_t i = 0; i < count; i++) {
            const imk_identification *r = &workers[i].result;
            failed += workers[i].status != IMK_OK;
            for (int k = 0; k < TERMS; k++) {
                const imk_estimate *e = &r->term[k];
                const double value = k == 0 ? one->quantization : truth[k];
                t[k].covered += e->lower <= value && value <= e->upper;
                t[k].present += e->present;
                t[k].sum += e->free_value * e->free_value;
                t[k].squares += pow(e->free_value, 4);
            }
            ramps += r->term[IMK_NOISE_RAMP].present;
            gauss_markov += r->gauss_markov_count > 0;
            lines += (size_t)(r->sinusoid_count + r->resonance_count);
            filters += r->filter.bandwidth > 0;
            misfits += (r->verdict & IMK_VERDICT_MISFIT) != 0;
            rounds += (size_t)r->rounds;
            found++;
        }
    }
    static const char *const names[TERMS] = {"Q", "N", "B", "K"};
    const double n = (double)found;
    printf("%s: %zu records, %.1f rounds, %.2f s of processor each\n", one->name, found,
           (double)rounds / n, (double)(clock() - begin) / CLOCKS_PER_SEC / n);
    for (int k = 0; k < TERMS; k++) {
        const double value = k == 0 ? one->quantization : truth[k], mean = t[k].sum / n;
        const double unit = value > 0 ? value * value : 1;
        printf("  %s covered %5.1f %%, present %5.1f %%, square: mean %.4f, sd %.4f of the truth\n",
               names[k], 100 * (double)t[k].covered / n, 100 * (double)t[k].present / n,
               mean / unit, sqrt(fmax(0, t[k].squares / n - mean * mean)) / unit);
    }
    printf("  ramps %zu, Gauss-Markov %zu, lines and resonances %zu, filters %zu, misfits %zu, "
           "failed %zu\n",
           ramps, gauss_markov, lines, filters, misfits, failed);
}

int main(int argc, char **argv)
{
    const size_t records = argc > 1 ? strtoul(argv[1], NULL, 10) : 300;
    const uint64_t seed = argc > 2 ? strtoull(argv[2], NULL, 10) : 1;
    const size_t only = argc > 3 ? strtoul(argv[3], NULL, 10) : SCENES;
    static worker workers[WORKERS];
    for (size_t i = 0; i < WORKERS; i++) {
        workers[i].samples = malloc(SAMPLES * sizeof(double));
        workers[i].workspace = malloc(imk_identify_workspace_size(SAMPLES));
        if (!workers[i].samples || !workers[i].workspace)
            return 1;
    }
    imk_thread_pool *pool = imk_thread_pool_create(0);
    const imk_executor executor = imk_thread_pool_executor(pool);
    for (size_t s = 0; s < SCENES; s++)
        if (only == SCENES || only == s) {
            run(&scenes[s], records, seed, workers, &executor);
            fflush(stdout);
        }
    imk_thread_pool_destroy(pool);
    return 0;
}
