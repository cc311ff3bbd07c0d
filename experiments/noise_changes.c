/* SPDX-License-Identifier: Apache-2.0 */
/* Noise that changes with time: false alarms of sound records, what is found of changes, and
 * whether the interval of white noise holds when its tails are heavy.
 *
 * usage: noise_changes [records] [samples] [seed] [kind; 1000: the sound ones]
 *
 * Records at 100 Hz are screened, identified and searched for changes as by the command, at a
 * significance of 1e-3. Printed is the share of records in which a change was found, in which it
 * matters, in which bursts and heavy tails were found, and in which the 95 % interval of N,
 * widened, holds the truth. Fails when more than 0.3 % of the sound records (and two) have a doubt.
 */
#include "imukit/imukit.h"
#include "imukit/record_screen.h"
#include "noise_record.h"

#include <stdio.h>
#include <stdlib.h>

typedef enum tails { GAUSSIAN, STUDENT5, LAPLACE, CONTAMINATED } tails;
typedef enum fault {
    SOUND,
    DOUBLED,
    TENTH,
    GROWTH,
    FLICKER_DOUBLED,
    TONE_PART,
    RING_PART,
    BURSTS
} fault;

typedef struct kind {
    truth t;
    tails tails;
    fault fault;
    double missing; /* share */
} kind;

#define RATE .rate = 100
static const kind KINDS[] = {
    {.t = {.name = "N", RATE, .term = {0, 1}}},
    {.t = {.name = "N B K", RATE, .term = {0, 1, 1, 0.1}}},
    {.t = {.name = "N and strong K", RATE, .term = {0, 1, 0, 3}}},
    {.t = {.name = "weak N, B", RATE, .term = {0, 0.05, 1}}},
    {.t = {.name = "N, Gauss-Markov 1 s", RATE, .term = {0, 1}, .gauss_markov = {{1, 1}}}},
    {.t = {.name = "N, Gauss-Markov 100 s", RATE, .term = {0, 1}, .gauss_markov = {{2, 100}}}},
    {.t = {.name = "Q N B", RATE, .term = {0.02, 1, 1}}},
    {.t = {.name = "N B ramp", RATE, .term = {0, 1, 1, 0, 0.01}}},
    {.t = {.name = "N B, resonance Q 16", RATE, .term = {0, 1, 1}, .resonance = {6, 20.3, 16}}},
    {.t = {.name = "N B, resonance Q 200", RATE, .term = {0, 1, 1}, .resonance = {3, 11.7, 200}}},
    {.t = {.name = "N B, tone 17 Hz", RATE, .term = {0, 1, 1}, .line = {3, 17}}},
    {.t = {.name = "N B, tone 12.503 Hz", RATE, .term = {0, 1, 1}, .line = {5, 12.503}}},
    {.t = {.name = "N B, tone 49.9 Hz", RATE, .term = {0, 1, 1}, .line = {5, 49.9}}},
    {.t = {.name = "filter 10 Hz", RATE, .term = {0, 1, 0.3}, .filter = {10, 0.7}}},
    {.t = {.name = "filter 5 Hz, first order", RATE, .term = {0, 1, 0.3}, .filter = {5, 0}}},
    {.t = {.name = "steps of 0.5 sigma", RATE, .term = {0, 1, 1, 0.1}, .step = 5}},
    {.t = {.name = "steps of 1.5 sigma", RATE, .term = {0, 1, 1, 0.1}, .step = 15}},
    {.t = {.name = "steps of 3 sigma", RATE, .term = {0, 1, 1, 1}, .step = 30}},
    {.t = {.name = "Student t5", RATE, .term = {0, 1, 1}}, .tails = STUDENT5},
    {.t = {.name = "Laplace", RATE, .term = {0, 1, 1}}, .tails = LAPLACE},
    {.t = {.name = "2 % of 3 times", RATE, .term = {0, 1, 1}}, .tails = CONTAMINATED},
    {.t = {.name = "5 % missing", RATE, .term = {0, 1, 1}}, .missing = 0.05},
    {.t = {.name = "N doubled half-way", RATE, .term = {0, 1, 0.3}}, .fault = DOUBLED},
    {.t = {.name = "N + 20 % for a tenth", RATE, .term = {0, 1, 0.3}}, .fault = TENTH},
    {.t = {.name = "N grows by 30 %", RATE, .term = {0, 1, 0.3}}, .fault = GROWTH},
    {.t = {.name = "B doubled half-way", RATE, .term = {0, 0.1, 1}}, .fault = FLICKER_DOUBLED},
    {.t = {.name = "tone for a quarter", RATE, .term = {0, 1, 0.3}}, .fault = TONE_PART},
    {.t = {.name = "vibration for a quarter", RATE, .term = {0, 1, 0.3}}, .fault = RING_PART},
    {.t = {.name = "bursts of 2 s", RATE, .term = {0, 1, 0.3}}, .fault = BURSTS},
};
enum { COUNT = sizeof KINDS / sizeof *KINDS };

static double tail_factor(tails form, const double *g, uint32_t word)
{
    const double u = ((double)word + 0.5) / 4294967296.0;
    double chi = 0;
    for (int i = 0; i < 5; i++)
        chi += g[i] * g[i];
    return form == STUDENT5       ? sqrt(3 / chi) /* variance 1: times sqrt(3/5) */
           : form == LAPLACE      ? sqrt(-log(u)) /* a normal of exponential variance */
           : form == CONTAMINATED ? (u < 0.02 ? 3 : 1) / sqrt(1.16)
                                  : 1;
}

/* Strength of white noise at a place of the record. */
static double strength_at(const kind *k, size_t i)
{
    const double place = (double)i / (double)k->t.samples;
    switch (k->fault) {
    case DOUBLED:
        return place < 0.5 ? 1 : 2;
    case TENTH:
        return place > 0.62 && place < 0.72 ? 1.2 : 1;
    case GROWTH:
        return 1 + 0.3 * place;
    case BURSTS:
        return i / 200 * 2654435761u % 4294967296u < 430000000u ? 2 : 1;
    default:
        return 1;
    }
}

static void simulate(const kind *k, uint64_t seed, uint64_t record, double *x, double *y)
{
    const imk_random random = imk_random_seeded(seed);
    const uint64_t stream = (record << 20) + 512;
    truth t = k->t;
    const double white = t.term[IMK_NOISE_WHITE];
    t.step = 0;                               /* after everything is added */
    const bool own = t.filter.bandwidth == 0; /* white noise is made here */
    t.term[IMK_NOISE_WHITE] = own ? 0 : white;
    make_record(&t, seed, record, x);
    if (k->fault == FLICKER_DOUBLED)
        for (size_t i = t.samples / 2; i < t.samples; i++)
            x[i] = x[t.samples / 2] + 2 * (x[i] - x[t.samples / 2]);
    imk_random_normals(random, stream, 0, 6 * t.samples, y);
    for (size_t i = 0; i < t.samples && own; i++) {
        uint32_t word = 0;
        if (k->tails == LAPLACE || k->tails == CONTAMINATED)
            imk_random_words(random, stream + 1, i, 1, &word);
        x[i] +=
            10 * white * y[6 * i] * tail_factor(k->tails, y + 6 * i + 1, word) * strength_at(k, i);
    }
    if (k->fault == TONE_PART)
        for (size_t i = t.samples / 2; i < 3 * t.samples / 4; i++)
            x[i] += 10 * sin(0.8123 * (double)i);
    if (k->fault == RING_PART) {
        imk_arma_state ring;
        const imk_resonance vibration = {4, 23.4, 10};
        memset(y, 0, t.samples * sizeof *y);
        if (imk_resonance_start(&ring, vibration, 0.01, random, stream + 2) == IMK_OK)
            imk_arma_add(&ring, t.samples, y);
        for (size_t i = t.samples / 2; i < 3 * t.samples / 4; i++)
            x[i] += y[i];
    }
    for (size_t i = 0; k->t.step > 0 && i < t.samples; i++)
        x[i] = k->t.step * floor(x[i] / k->t.step + 0.5);
    for (size_t i = 0; k->missing > 0 && i < t.samples; i++) /* alone, and runs */
        if (i * 2654435761u % 4294967296u < k->missing * 2147483648.0 ||
            i / 500 * 40503u % 65536u < k->missing * 32768)
            x[i] = NAN;
}

typedef struct tally {
    size_t records, changed, matters, bursts, heavy, doubts, held, before;
    double segments, kurtosis, location;
} tally;

static bool holds(const imk_estimate *e, double value)
{
    return value >= e->lower && value <= e->upper;
}

typedef struct room {
    double *x, *y;
    void *workspace;
    size_t size;
    imk_noise_map *map;
} room;

static bool assess(const kind *k, const room *r, tally *sum)
{
    const size_t n = k->t.samples;
    imk_screen_settings screening = imk_screen_default();
    imk_screen screen;
    screening.dt = 0.01;
    imk_identify_settings settings = imk_identify_default();
    settings.dt = 0.01;
    imk_noise_changes_settings test = imk_noise_changes_default();
    test.dt = 0.01;
    imk_identification found;
    imk_noise_changes changes;
    if (imk_screen_channel(&screening, n, r->x, &screen, r->workspace, r->size, NULL) != IMK_OK)
        return false;
    const unsigned what =
        k->tails ? IMK_SCREEN_ALL & ~(unsigned)IMK_SCREEN_OUTLIERS : IMK_SCREEN_ALL;
    size_t lost;
    if (imk_screen_apply(&screening, &screen, what, n, r->x, &lost, r->workspace, r->size, NULL) !=
        IMK_OK)
        return false;
    if (imk_identify_channel(&settings, n, r->x, &found, r->workspace, r->size, NULL) != IMK_OK)
        return false;
    imk_noise_map_begin(r->map);
    imk_noise_map_add(r->map, n, r->x);
    imk_noise_map_end(r->map);
    imk_noise_changes_find(&test, r->map, &found, &changes, NULL);
    sum->records++;
    sum->changed += changes.changed != 0;
    sum->matters += changes.matters;
    sum->bursts += changes.bursts;
    sum->heavy += changes.heavy_tails;
    sum->doubts += changes.matters || changes.bursts;
    sum->segments += (double)changes.segment_count;
    sum->kurtosis += changes.kurtosis;
    sum->before += holds(&found.term[IMK_NOISE_WHITE], k->t.term[IMK_NOISE_WHITE]);
    imk_noise_changes_widen(&changes, n, &found);
    sum->held += holds(&found.term[IMK_NOISE_WHITE], k->t.term[IMK_NOISE_WHITE]);
    return true;
}

int main(int argc, char **argv)
{
    const size_t records = argc > 1 ? strtoul(argv[1], NULL, 10) : 100;
    const size_t n = argc > 2 ? strtoul(argv[2], NULL, 10) : 32768;
    const uint64_t seed = argc > 3 ? strtoull(argv[3], NULL, 10) : 1;
    const long only = argc > 4 ? strtol(argv[4], NULL, 10) : -1;
    const size_t size = imk_identify_workspace_size(n) + imk_screen_workspace_size(n);
    const room r = {malloc(n * sizeof(double)), malloc(6 * n * sizeof(double)), malloc(size), size,
                    malloc(sizeof *r.map)};
    size_t sound = 0, doubts = 0;
    if (!r.x || !r.y || !r.workspace || !r.map)
        return 1;
    printf("%zu records of %zu samples at 100 Hz each; percent of the records\n%-26s %8s %8s %8s "
           "%8s %8s %8s %9s %9s\n",
           records, n, "", "changed", "matters", "bursts", "heavy", "N holds", "widened",
           "segments", "kurtosis");
    for (size_t i = 0; i < COUNT; i++) {
        kind k = KINDS[i];
        tally sum = {0};
        if (only >= 0 && (size_t)only != i && !(only == 1000 && k.fault == SOUND))
            continue;
        k.t.samples = n;
        for (size_t record = 0; record < records; record++) {
            simulate(&k, seed, record, r.x, r.y);
            if (!assess(&k, &r, &sum))
                return 1;
        }
        const double percent = 100 / (double)sum.records, one = 1 / (double)sum.records;
        printf("%-26s %8.2f %8.2f %8.2f %8.2f %8.1f %8.1f %9.2f %9.2f\n", k.t.name,
               percent * (double)sum.changed, percent * (double)sum.matters,
               percent * (double)sum.bursts, percent * (double)sum.heavy,
               percent * (double)sum.before, percent * (double)sum.held, one * sum.segments,
               one * sum.kurtosis);
        fflush(stdout);
        sound += k.fault == SOUND ? sum.records : 0;
        doubts += k.fault == SOUND ? sum.doubts : 0;
    }
    printf("doubts in %zu of %zu sound records\n", doubts, sound);
    free(r.x);
    free(r.y);
    free(r.workspace);
    free(r.map);
    (void)bounds;
    return !((double)doubts <= 2 + 0.003 * (double)sound);
}
