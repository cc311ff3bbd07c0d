/* SPDX-License-Identifier: Apache-2.0 */
/* Do the intervals hold where the verdict is clear? Mixtures of noise terms, resonances, output
 * filters and rounding.
 *
 * usage: coverage_mixtures [records] [seed] [first case] [last case]
 *
 * Prints for each mixture the share of records without a doubt, and for each term how often it is
 * reported present and how often its 95 % interval holds the truth: in all records, and in those
 * without a doubt, with the standard error of a share of so many, and whether that is in the band
 * of 93 to 97 %. Below it the interval is too narrow: a lie. Above it is conservative. A term that
 * is not in the mixture holds when its interval reaches 0, which it may do always, so it can only
 * be below. A Gauss-Markov term counts where as many are found as there are, the shortest for the
 * shortest; found in fewer than half of the records it is found because chance has made it large,
 * and is counted apart. Then what was reported that is not there. The last line counts the terms of
 * all mixtures. Sinusoids, resonances and filters are reported without intervals. The flicker noise
 * of cases with a star is made by fractional differences, not by the library. */
#include "imukit/io.h"
#include "noise_record.h"

#include <stdio.h>
#include <stdlib.h>

enum { WORKERS = 2, SAMPLES = 1 << 16 };

#define GM(sigma, time)                                                                            \
    {                                                                                              \
        sigma, time                                                                                \
    }

/* At 100 Hz: N = 1 has 10 in one sample, and 0.1 in the angle of one. */
static const truth cases[] = {
    {.name = "N", .term = {0, 1}},
    {.name = "N B", .term = {0, 1, 1}},
    {.name = "N B *", .term = {0, 1, 1}, .fractional = true},
    {.name = "N B K", .term = {0, 1, 1, 0.3}},
    {.name = "N B K *", .term = {0, 1, 1, 0.3}, .fractional = true},
    {.name = "Q N B K", .term = {0.03, 1, 1, 0.3}},
    {.name = "Q N R", .term = {0.03, 1, 0, 0, 0.01}},
    {.name = "N R", .term = {0, 1, 0, 0, 0.002}},
    {.name = "N B R", .term = {0, 1, 1, 0, 0.012}},
    {.name = "N B R *", .term = {0, 1, 1, 0, 0.012}, .fractional = true},
    {.name = "N K R", .term = {0, 1, 0, 0.02, 0.01}},
    {.name = "N B K R", .term = {0, 1, 1, 0.1, 0.012}},
    {.name = "N GM 0.04", .term = {0, 1}, .gauss_markov = {GM(5, 0.04)}},
    {.name = "N B GM 0.04", .term = {0, 1, 1}, .gauss_markov = {GM(5, 0.04)}},
    {.name = "N GM 0.1", .term = {0, 1}, .gauss_markov = {GM(3, 0.1)}},
    {.name = "N GM 1", .term = {0, 1}, .gauss_markov = {GM(1, 1)}},
    {.name = "N GM 10", .term = {0, 1}, .gauss_markov = {GM(0.5, 10)}},
    {.name = "N GM 100", .term = {0, 1}, .gauss_markov = {GM(0.3, 100)}},
    {.name = "N B K GM 1", .term = {0, 1, 1, 0.1}, .gauss_markov = {GM(1, 1)}},
    {.name = "N GM 1 GM 30", .term = {0, 1}, .gauss_markov = {GM(1, 1), GM(0.5, 30)}},
    {.name = "N GM 1 K", .term = {0, 1, 0, 0.1}, .gauss_markov = {GM(1, 1)}},
    {.name = "N B, resonance 20 Hz q 16", .term = {0, 1, 1}, .resonance = {{6, 20.3, 16}}},
    {.name = "N B, resonance 20 Hz q 4", .term = {0, 1, 1}, .resonance = {{6, 20, 4}}},
    {.name = "N B, resonance 5 Hz q 3", .term = {0, 1, 1}, .resonance = {{3, 5, 3}}},
    {.name = "N B, weak resonance 12 Hz q 8", .term = {0, 1, 1}, .resonance = {{1.5, 12, 8}}},
    {.name = "N B, 2 resonances", .term = {0, 1, 1}, .resonance = {{4, 12, 8}, {5, 30, 5}}},
    {.name = "N B, 3 resonances",
     .term = {0, 1, 1},
     .resonance = {{4, 8, 10}, {5, 20, 6}, {6, 35, 12}}},
    {.name = "N B, filter 61 Hz", .term = {0, 1, 1}, .filter = {61, 0}},
    {.name = "N B, filter 20 Hz", .term = {0, 1, 1}, .filter = {20, 0}},
    {.name = "N B, filter 5 Hz", .term = {0, 1, 1}, .filter = {5, 0}},
    {.name = "N B, filter 40 Hz 0.7", .term = {0, 1, 1}, .filter = {40, 0.7}},
    {.name = "N B, filter 10 Hz 0.7", .term = {0, 1, 1}, .filter = {10, 0.7}},
    {.name = "N B, filter 20 Hz, resonance",
     .term = {0, 1, 1},
     .filter = {20, 0},
     .resonance = {{6, 20, 8}}},
    {.name = "rounded 1", .term = {0, 1, 1}, .step = 10, .mean = 3},
    {.name = "rounded 1.5", .term = {0, 1, 1}, .step = 15, .mean = 4},
    {.name = "rounded 0.5, filter 5 Hz", .term = {0, 1, 1}, .filter = {5, 0}, .step = 2, .mean = 1},
    {.name = "rounded 1, filter 5 Hz", .term = {0, 1, 1}, .filter = {5, 0}, .step = 4, .mean = 1},
    {.name = "angle rounded 0.3", .term = {0, 1, 1}, .angle_step = 0.03, .mean = 2},
    {.name = "angle rounded 1", .term = {0, 1, 1}, .angle_step = 0.1, .mean = 2},
    {.name = "angle rounded 2", .term = {0, 1, 1}, .angle_step = 0.2, .mean = 2},
    {.name = "angle rounded 2, mean 0", .term = {0, 1, 1}, .angle_step = 0.2},
    {.name = "angle rounded 2, fast", .term = {0, 1, 1}, .angle_step = 0.2, .mean = 137},
    /* Steps that always bring a doubt. */
    {.name = "rounded 2", .term = {0, 1, 1}, .step = 20, .mean = 6},
    {.name = "rounded 2.25", .term = {0, 1, 1}, .step = 22.5, .mean = 7},
    {.name = "rounded 2.5", .term = {0, 1, 1}, .step = 25, .mean = 8},
    {.name = "rounded 3", .term = {0, 1, 1}, .step = 30, .mean = 10},
    {.name = "rounded 5", .term = {0, 1, 1}, .step = 50, .mean = 15},
    {.name = "rounded 10", .term = {0, 1, 1}, .step = 100, .mean = 45},
    {.name = "rounded 2, filter 5 Hz", .term = {0, 1, 1}, .filter = {5, 0}, .step = 8, .mean = 1},
    {.name = "rounded 4, K", .term = {0, 1, 0, 10}, .step = 40},
    {.name = "angle rounded 2.25", .term = {0, 1, 1}, .angle_step = 0.225, .mean = 2},
    {.name = "angle rounded 2.5", .term = {0, 1, 1}, .angle_step = 0.25, .mean = 2},
    {.name = "angle rounded 3", .term = {0, 1, 1}, .angle_step = 0.3, .mean = 2},
    {.name = "angle rounded 5", .term = {0, 1, 1}, .angle_step = 0.5, .mean = 2},
    {.name = "angle rounded 10", .term = {0, 1, 1}, .angle_step = 1, .mean = 2},
    {.name = "angle rounded 30", .term = {0, 1, 1}, .angle_step = 3, .mean = 2},
    {.name = "angle rounded 3, mean 0", .term = {0, 1, 1}, .angle_step = 0.3},
};
enum { CASES = sizeof cases / sizeof cases[0] };

static const char *const kinds[] = {"Q", "N", "B", "K", "R", "GM", "line", "resonance", "filter"};
enum { GAUSS_MARKOV = IMK_NOISE_TERMS, LINE, RESONANCE, FILTER, KINDS };

typedef struct experiment {
    truth t;
    uint64_t seed;
    size_t records;
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
    for (size_t record = index; record < e->records; record += WORKERS) {
        make_record(&e->t, e->seed, record, e->samples[index]);
        memset(&e->results[record], 0, sizeof e->results[record]);
        const imk_status status =
            imk_identify_channel(&settings, e->t.samples, e->samples[index], &e->results[record],
                                 e->workspace[index], e->workspace_size, NULL);
        e->results[record].rounds = status == IMK_OK ? 0 : -1;
    }
}

/* Without a warning of `identify`: being short is no fault, intervals say how wide they are. */
static bool is_clear(const imk_identification *r)
{
    const unsigned notes =
        IMK_VERDICT_SHORT | IMK_VERDICT_LINES | IMK_VERDICT_RESONANCE | IMK_VERDICT_FILTERED;
    return r->rounds == 0 && !(r->verdict & ~notes);
}

/* The estimate of a true term; NULL: none, as many Gauss-Markov terms have not been found as there
 * are. Both are in the order of their times. */
static const imk_estimate *find(const truth *t, const imk_identification *r, int which, bool time)
{
    if (which < IMK_NOISE_TERMS)
        return &r->term[which];
    int held = 0;
    for (int i = 0; i < TIMES; i++)
        held += t->gauss_markov[i].sigma > 0;
    if (r->gauss_markov_count != held)
        return NULL;
    return time ? &r->gauss_markov[which - IMK_NOISE_TERMS].correlation_time
                : &r->gauss_markov[which - IMK_NOISE_TERMS].sigma;
}

/* Records without a doubt that it takes to tell 93 % from 95 %, and the band. */
enum { ENOUGH = 100 };
static const double LOWEST = 0.93, HIGHEST = 0.97;

typedef struct tally {
    size_t below, above, in_band, reaching, seldom, too_few;
} tally;

/* @param records  without a doubt; `clear` of them have the estimate, and in `held` it holds */
static const char *judge(bool there, size_t records, size_t clear, size_t held, tally *sum)
{
    const double share = (double)held / (double)clear;
    size_t *count = clear < ENOUGH        ? &sum->too_few
                    : 2 * clear < records ? &sum->seldom
                    : share < LOWEST      ? &sum->below
                    : !there              ? &sum->reaching
                    : share > HIGHEST     ? &sum->above
                                          : &sum->in_band;
    ++*count;
    return count == &sum->too_few    ? "too few"
           : count == &sum->seldom   ? "seldom found"
           : count == &sum->below    ? "BELOW"
           : count == &sum->reaching ? "not there"
           : count == &sum->above    ? "conservative"
                                     : "in band";
}

static void print_term(const experiment *e, const char *name, double value, int which, bool time,
                       tally *all)
{
    size_t found = 0, present = 0, covered = 0, clear = 0, clear_covered = 0, wide = 0,
           doubtless = 0;
    double sum = 0;
    for (size_t i = 0; i < e->records; i++) {
        const imk_identification *r = &e->results[i];
        doubtless += is_clear(r);
        const imk_estimate *estimate = find(&e->t, r, which, time);
        if (!estimate)
            continue;
        const bool holds = estimate->lower <= value && value <= estimate->upper;
        found++;
        present += estimate->present;
        covered += holds;
        clear += is_clear(r);
        clear_covered += is_clear(r) && holds;
        wide += is_clear(r) && estimate->present && estimate->upper > 9 * estimate->lower;
        sum += estimate->free_value;
    }
    const double n = (double)e->records, share = (double)clear_covered / (double)clear;
    printf("    %-2s present %5.1f %%", name, 100 * (double)present / n);
    if (found > 0)
        printf("  holds %5.1f %%", 100 * (double)covered / (double)found);
    if (clear > 0)
        printf("  clear %5.1f ± %.1f %%", 100 * share,
               100 * sqrt(share * (1 - share) / (double)clear));
    printf("  %s", judge(value != 0, doubtless, clear, clear_covered, all));
    if (wide > 0)
        printf("  wide %.1f %%", 100 * (double)wide / n);
    if (value > 0 && found > 0)
        printf("  mean/true %.4f", sum / (double)found / value);
    printf("\n");
}

static int found_of(const imk_identification *r, int kind)
{
    return kind < IMK_NOISE_TERMS ? r->term[kind].present
           : kind == GAUSS_MARKOV ? r->gauss_markov_count
           : kind == LINE         ? r->sinusoid_count
           : kind == RESONANCE    ? r->resonance_count
                                  : r->filter.bandwidth > 0;
}

static double white_of(const truth *t)
{
    const double n = t->term[IMK_NOISE_WHITE];
    const double step = t->filter.bandwidth > 0 ? 0 : t->step; /* rounded after the filter */
    return sqrt(n * n + step * step / 12 / t->rate);
}

static void print_verdicts(const experiment *e)
{
    static const char *const names[] = {"short",   "coarse",    "lines",  "resonance", "filtered",
                                        "warm-up", "saturated", "misfit", "frozen"};
    size_t wide = 0;
    for (size_t i = 0; i < e->records; i++)
        wide += (e->results[i].verdict & IMK_VERDICT_UNDETERMINED) > 0;
    if (wide > 0)
        printf("  undetermined %.1f", 100 * (double)wide / (double)e->records);
    for (unsigned bit = 0; bit < 9; bit++) {
        size_t count = 0;
        for (size_t i = 0; i < e->records; i++)
            count += e->results[i].verdict >> bit & 1;
        if (count > 0 && bit != 2 && bit != 3 && bit != 4)
            printf("  %s %.1f", names[bit], 100 * (double)count / (double)e->records);
    }
}

/* Terms of a kind that are reported without an alternative. */
static int certain_of(const imk_identification *r, int kind)
{
    if (kind < IMK_NOISE_TERMS)
        return r->term[kind].present && !(r->ambiguous >> kind & 1);
    int count = 0;
    for (int i = 0; i < r->gauss_markov_count; i++)
        count += r->gauss_markov[i].sigma.lower > 0;
    return count;
}

/* Terms of a kind in the mixture. */
static int held_of(const truth *t, int kind)
{
    int count = 0;
    if (kind < IMK_NOISE_TERMS)
        return t->term[kind] != 0 || (kind == IMK_NOISE_QUANTIZATION && t->angle_step > 0);
    for (int i = 0; i < TIMES; i++)
        count += kind == GAUSS_MARKOV && t->gauss_markov[i].sigma > 0;
    for (int i = 0; i < RESONANCES; i++)
        count += kind == RESONANCE && t->resonance[i].sigma > 0;
    return count + (kind == FILTER && t->filter.bandwidth > 0);
}

/* Of Gauss-Markov terms more than there are, each must be able to be 0. */
static void print_more_gauss_markov(const experiment *e, tally *all)
{
    size_t clear = 0, held = 0;
    for (size_t i = 0; i < e->records; i++) {
        const imk_identification *r = &e->results[i];
        clear += is_clear(r);
        held += is_clear(r) && certain_of(r, GAUSS_MARKOV) <= held_of(&e->t, GAUSS_MARKOV);
    }
    const double share = (double)held / (double)clear;
    printf("    no further GM");
    if (clear > 0)
        printf("  clear %5.1f ± %.1f %%", 100 * share,
               100 * sqrt(share * (1 - share) / (double)clear));
    printf("  %s\n", judge(false, clear, clear, held, all));
}

static void print_false(const experiment *e)
{
    printf("    false:");
    for (int kind = 0; kind < KINDS; kind++) {
        size_t more = 0, less = 0, certain = 0;
        for (size_t i = 0; i < e->records; i++) {
            more += found_of(&e->results[i], kind) > held_of(&e->t, kind);
            certain +=
                kind <= GAUSS_MARKOV && certain_of(&e->results[i], kind) > held_of(&e->t, kind);
            less += found_of(&e->results[i], kind) < held_of(&e->t, kind);
        }
        if (more > 0)
            printf("  %s %.1f", kinds[kind], 100 * (double)more / (double)e->records);
        if (more > 0 && kind <= GAUSS_MARKOV)
            printf(" (certain %.1f)", 100 * (double)certain / (double)e->records);
        if (less > 0 && kind > IMK_NOISE_TERMS)
            printf("  missed %s %.1f", kinds[kind], 100 * (double)less / (double)e->records);
    }
    printf("\n");
}

static void print_case(const experiment *e, tally *all)
{
    const truth *t = &e->t;
    size_t clear = 0;
    for (size_t i = 0; i < e->records; i++)
        clear += is_clear(&e->results[i]);
    printf("%s: clear %.1f %%", t->name, 100 * (double)clear / (double)e->records);
    print_verdicts(e);
    printf("\n");
    for (int i = 0; i < IMK_NOISE_TERMS; i++) {
        double value = i == IMK_NOISE_WHITE ? white_of(t) : t->term[i];
        if (i == IMK_NOISE_QUANTIZATION && t->angle_step > 0)
            value = t->angle_step / sqrt(12);
        print_term(e, kinds[i], value, i, false, all);
    }
    for (int i = 0; i < TIMES; i++)
        if (t->gauss_markov[i].sigma > 0) {
            print_term(e, "GM", t->gauss_markov[i].sigma, IMK_NOISE_TERMS + i, false, all);
            print_term(e, "T", t->gauss_markov[i].correlation_time, IMK_NOISE_TERMS + i, true, all);
        }
    print_more_gauss_markov(e, all);
    print_false(e);
    fflush(stdout);
}

int main(int argc, char **argv)
{
    const size_t records = argc > 1 ? strtoul(argv[1], NULL, 10) : 100;
    const uint64_t seed = argc > 2 ? strtoull(argv[2], NULL, 10) : 1;
    const size_t first = argc > 3 ? strtoul(argv[3], NULL, 10) : 0;
    const size_t last = argc > 4 ? strtoul(argv[4], NULL, 10) : CASES - 1;
    imk_thread_pool *pool = imk_thread_pool_create(WORKERS);
    const imk_executor executor = imk_thread_pool_executor(pool);
    experiment e = {.seed = seed,
                    .records = records,
                    .workspace_size = imk_identify_workspace_size(SAMPLES),
                    .results = malloc(records * sizeof(imk_identification))};
    tally all = {0};
    for (size_t i = 0; i < WORKERS; i++) {
        e.samples[i] = malloc(SAMPLES * sizeof(double));
        e.workspace[i] = malloc(e.workspace_size);
    }
    for (size_t i = first; i <= last && i < CASES; i++) {
        e.t = cases[i];
        e.t.samples = SAMPLES;
        e.t.rate = 100;
        imk_execute(&executor, WORKERS, worker, &e);
        print_case(&e, &all);
    }
    printf(
        "terms below the band %zu, above %zu, in it %zu; not in the mixture, and not below, %zu; "
        "found in fewer than half of the clear records %zu, in fewer than %d %zu\n",
        all.below, all.above, all.in_band, all.reaching, all.seldom, ENOUGH, all.too_few);
    for (size_t i = 0; i < WORKERS; i++) {
        free(e.samples[i]);
        free(e.workspace[i]);
    }
    free(e.results);
    imk_thread_pool_destroy(pool);
    return 0;
}
