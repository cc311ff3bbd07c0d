/* SPDX-License-Identifier: Apache-2.0 */
/* What is called present, what not, and how well what is there is estimated, over kinds of noise.
 *
 * usage: selection [records] [seed] [first case] [last case] [significance]
 *
 * Each record is 2^18 samples of noise made by the library's generators. Prints, for each term that
 * a case holds, the lowest relative standard deviation possible (from the information of all the
 * case's parameters together), how often it is found, how often its 95 % interval covers the truth
 * and the bias and scatter of its square; and for what it does not hold, how often it is found. */
#include "imukit/io.h"
#include "noise_record.h"

#include <stdio.h>
#include <stdlib.h>

enum { SAMPLES = 1 << 18, WORKERS = 8 };

static const truth cases[] = {
    {.name = "N", .rate = 20, .term = {0, 1}},
    {.name = "N, 100 Hz", .rate = 100, .term = {0, 1}},
    {.name = "N B", .rate = 20, .term = {0, 1, 0.15}},
    {.name = "N B K", .rate = 20, .term = {0, 1, 0.15, 0.03}},
    {.name = "N B K, 3 h", .rate = 10, .samples = 108000, .term = {0, 1, 0.4444, 0.01852}},
    {.name = "N K", .rate = 20, .term = {0, 1, 0, 0.01}},
    {.name = "N B, weak Q", .rate = 20, .term = {0.02, 1, 0.15}},
    {.name = "N B, Q", .rate = 20, .term = {0.5, 1, 0.15}},
    {.name = "N B, strong Q", .rate = 20, .term = {30, 1, 0.3}},
    {.name = "strong Q", .rate = 20, .term = {300, 0}},
    {.name = "N, 1 s", .rate = 20, .term = {0, 1}, .gauss_markov = {{0.5, 1}}},
    {.name = "N, 10 s", .rate = 20, .term = {0, 1}, .gauss_markov = {{0.3, 10}}},
    {.name = "N, 100 s", .rate = 20, .term = {0, 1}, .gauss_markov = {{0.5, 100}}},
    {.name = "N, 300 s", .rate = 20, .term = {0, 1}, .gauss_markov = {{0.5, 300}}},
    {.name = "N, 1000 s", .rate = 20, .term = {0, 1}, .gauss_markov = {{0.5, 1000}}},
    {.name = "N B, 1 s", .rate = 20, .term = {0, 1, 0.15}, .gauss_markov = {{0.5, 1}}},
    {.name = "N B, 10 s", .rate = 20, .term = {0, 1, 0.15}, .gauss_markov = {{0.5, 10}}},
    {.name = "N B, 100 s", .rate = 20, .term = {0, 1, 0.1}, .gauss_markov = {{0.8, 100}}},
    {.name = "N B K, 1 s", .rate = 20, .term = {0, 1, 0.15, 0.03}, .gauss_markov = {{1, 1}}},
    {.name = "N B K, 10 s", .rate = 20, .term = {0, 1, 0.15, 0.03}, .gauss_markov = {{1, 10}}},
    {.name = "N K, 100 s", .rate = 20, .term = {0, 1, 0, 0.1}, .gauss_markov = {{1.5, 100}}},
    {.name = "N, 1 s, 100 s", .rate = 20, .term = {0, 1}, .gauss_markov = {{1, 1}, {1, 100}}},
    {.name = "N B K, line 50 Hz", .rate = 200, .term = {0, 1, 0.5, 0.3}, .line = {0.4, 50}},
    {.name = "N B, resonance", .rate = 20, .term = {0, 1, 0.15}, .resonance = {{1, 3, 16}}},
    {.name = "N B, low-pass", .rate = 20, .term = {0, 1, 0.15}, .filter = {6, 0.7}},
    {.name = "N R", .rate = 20, .term = {0, 1, 0, 0, 2.3e-5}},
    {.name = "N B R", .rate = 20, .term = {0, 1, 0.15, 0, 1.3e-4}},
    {.name = "N B, coarse", .rate = 20, .term = {0, 1, 0.15}, .step = 4.47213595499958},
};
enum { CASES = sizeof cases / sizeof cases[0] };

static const char *const kinds[] = {"Q", "N", "B", "K", "R", "GM", "line", "resonance", "filter"};
enum { GAUSS_MARKOV = IMK_NOISE_TERMS, LINE, RESONANCE, FILTER, KINDS };

typedef struct experiment {
    truth t;
    uint64_t seed;
    double significance;
    size_t records, workers;
    double *samples[WORKERS];
    void *workspace[WORKERS];
    size_t workspace_size;
    imk_identification *results;
} experiment;

static void worker(void *context, size_t index)
{
    experiment *e = context;
    imk_identify_settings settings = imk_identify_default();
    settings.dt = 1 / e->t.rate;
    settings.significance = e->significance;
    for (size_t record = index; record < e->records; record += e->workers) {
        make_record(&e->t, e->seed, record, e->samples[index]);
        memset(&e->results[record], 0, sizeof e->results[record]);
        (void)imk_identify_channel(&settings, e->t.samples, e->samples[index], &e->results[record],
                                   e->workspace[index], e->workspace_size, NULL);
    }
}

static void print_term(const experiment *e, const char *name, double value, double bound, int which,
                       bool time)
{
    size_t found = 0, covered = 0;
    double sum = 0, squares = 0, truth_square = value * value;
    for (size_t i = 0; i < e->records; i++) {
        const imk_identification *r = &e->results[i];
        const int g = which - IMK_NOISE_TERMS;
        if (g >= 0 && r->gauss_markov_count <= g)
            continue;
        const imk_estimate *estimate = g < 0  ? &r->term[which]
                                       : time ? &r->gauss_markov[g].correlation_time
                                              : &r->gauss_markov[g].sigma;
        found += estimate->present;
        covered += estimate->lower <= value && value <= estimate->upper;
        const double square = which == IMK_NOISE_RAMP ? estimate->free_value * value
                              : time                  ? log(estimate->value / value)
                                                      : estimate->free_value * estimate->free_value;
        sum += square;
        squares += square * square;
    }
    const double n = which < IMK_NOISE_TERMS ? (double)e->records : (double)found;
    const double mean = sum / n, sd = sqrt(fmax(0, squares / n - mean * mean));
    const double scale = time ? 1 : truth_square, centre = time ? 0 : truth_square;
    printf("    %-4s bound %5.1f %%  found %5.1f %%  covered %5.1f %%  bias %+.2f sd  sd/bound "
           "%.2f\n",
           name, 100 * bound, 100 * (double)found / (double)e->records, 100 * (double)covered / n,
           (mean - centre) / sd, sd / scale / bound / (which == IMK_NOISE_RAMP || time ? 1 : 2));
}

static int found_of(const imk_identification *r, int kind)
{
    return kind < IMK_NOISE_TERMS ? r->term[kind].present
           : kind == GAUSS_MARKOV ? r->gauss_markov_count
           : kind == LINE         ? r->sinusoid_count
           : kind == RESONANCE    ? r->resonance_count
                                  : r->filter.bandwidth > 0;
}

static void print_case(const experiment *e)
{
    const truth *t = &e->t;
    double bound[PARAMETERS];
    bounds(t, bound);
    printf("%s\n", t->name);
    int held[KINDS] = {0};
    for (int i = 0; i < IMK_NOISE_TERMS; i++)
        if (t->term[i] != 0) {
            double value = t->term[i];
            if (i == IMK_NOISE_WHITE && t->step > 0)
                value = sqrt(value * value + t->step * t->step / 12 / t->rate);
            held[i] = 1;
            print_term(e, kinds[i], value, i == IMK_NOISE_RAMP ? bound[i] : bound[i] / 2, i, false);
        }
    for (int i = 0; i < TIMES; i++)
        if (t->gauss_markov[i].sigma > 0) {
            held[GAUSS_MARKOV]++;
            print_term(e, "GM", t->gauss_markov[i].sigma, bound[IMK_NOISE_TERMS + 2 * i] / 2,
                       IMK_NOISE_TERMS + i, false);
            print_term(e, "T", t->gauss_markov[i].correlation_time,
                       bound[IMK_NOISE_TERMS + 2 * i + 1], IMK_NOISE_TERMS + i, true);
        }
    held[LINE] = t->line.amplitude > 0;
    held[RESONANCE] = t->resonance[0].sigma > 0;
    held[FILTER] = t->filter.bandwidth > 0;
    size_t any = 0, false_of[KINDS] = {0};
    for (size_t record = 0; record < e->records; record++) {
        bool wrong = false;
        for (int kind = 0; kind < KINDS; kind++) {
            const bool more = found_of(&e->results[record], kind) > held[kind];
            false_of[kind] += more;
            wrong = wrong || more;
        }
        any += wrong;
    }
    const double percent = 100 / (double)e->records;
    printf("    false: any %.1f %%", percent * (double)any);
    for (int kind = 0; kind < KINDS; kind++)
        if (false_of[kind] > 0)
            printf("  %s %.1f", kinds[kind], percent * (double)false_of[kind]);
    for (int kind = LINE; kind < KINDS; kind++)
        if (held[kind]) {
            size_t found = 0;
            for (size_t record = 0; record < e->records; record++)
                found += found_of(&e->results[record], kind) > 0;
            printf("  found %s %.1f %%", kinds[kind], percent * (double)found);
        }
    printf("\n");
    fflush(stdout);
}

int main(int argc, char **argv)
{
    const size_t records = argc > 1 ? strtoul(argv[1], NULL, 10) : 200;
    const uint64_t seed = argc > 2 ? strtoull(argv[2], NULL, 10) : 1;
    const size_t first = argc > 3 ? strtoul(argv[3], NULL, 10) : 0;
    const size_t last = argc > 4 ? strtoul(argv[4], NULL, 10) : CASES - 1;
    imk_thread_pool *pool = imk_thread_pool_create(0);
    const imk_executor executor = imk_thread_pool_executor(pool);
    experiment e = {.seed = seed,
                    .significance = argc > 5 ? strtod(argv[5], NULL) : 0.01,
                    .records = records,
                    .workers = records < WORKERS ? records : WORKERS,
                    .workspace_size = imk_identify_workspace_size(SAMPLES),
                    .results = malloc(records * sizeof(imk_identification))};
    for (size_t i = 0; i < e.workers; i++) {
        e.samples[i] = malloc(SAMPLES * sizeof(double));
        e.workspace[i] = malloc(e.workspace_size);
    }
    for (size_t i = first; i <= last && i < CASES; i++) {
        e.t = cases[i];
        e.t.samples = e.t.samples > 0 ? e.t.samples : SAMPLES;
        imk_execute(&executor, e.workers, worker, &e);
        print_case(&e);
    }
    for (size_t i = 0; i < e.workers; i++) {
        free(e.samples[i]);
        free(e.workspace[i]);
    }
    free(e.results);
    imk_thread_pool_destroy(pool);
    return 0;
}
