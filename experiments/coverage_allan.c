/* SPDX-License-Identifier: Apache-2.0 */
/* Do the 95 % intervals of the Allan family hold the truth at every averaging time?
 *
 * usage: coverage_allan [RECORDS] [SAMPLES] [SEED]
 *
 * Simulates records of white noise, bias instability, random walk and all three at 100 Hz. For each
 * and for several statistics it prints the share of intervals that hold the expected deviation, at
 * some averaging factors and, over all factors (ten a decade), the lowest and the highest up to
 * T/10 and from there to T/4. OADEV is also taken of records of which a tenth of the samples is
 * missing. The other statistics have fewer records. The generator of bias instability holds its
 * slow stages for powers of four samples, to which the clusters of ADEV that are as long belong at
 * every place alike; this is the generator's, and ADEV of flicker noise by fractional differencing
 * is held like the others. Theo1 takes its bias off for one law, which is none where two are mixed.
 * Fails when OADEV of a complete record is not within 93.5 to 96.5 % up to T/10 or not within 94 to
 * 98 % up to T/4, four standard errors beyond. */
#include "noise_record.h"

#include "imukit/allan_gaps.h"

#include <stdio.h>
#include <stdlib.h>

enum { FACTORS = 128, SHOWN = 6 };

static const truth TRUTHS[] = {
    {.name = "N", .rate = 100, .term = {0, 1, 0, 0, 0}},
    {.name = "B", .rate = 100, .term = {0, 0, 1, 0, 0}},
    {.name = "K", .rate = 100, .term = {0, 0, 0, 1, 0}},
    {.name = "N+B+K", .rate = 100, .term = {0, 1, 1, 0.15, 0}},
};

typedef struct kind {
    const char *name;
    imk_allan_statistic statistic;
    bool missing;
    size_t share; /* one of so many records */
} kind;

static const kind KINDS[] = {
    {"oadev", IMK_ALLAN_OVERLAPPING, false, 1}, {"oadev, gaps", IMK_ALLAN_OVERLAPPING, true, 4},
    {"adev", IMK_ALLAN_PLAIN, false, 4},        {"totdev", IMK_ALLAN_TOTAL, false, 4},
    {"theo1", IMK_ALLAN_THEO1, false, 20},
};

/* Counts of one truth and one kind. */
typedef struct cover {
    size_t count, m[FACTORS], records, held[FACTORS];
    double ratio[FACTORS]; /* measured variance over the expected one */
} cover;

static double variance_of(const truth *t, double averaging)
{
    imk_allan_noise noise = {0};
    memcpy(noise.term, t->term, sizeof noise.term);
    const size_t below = (size_t)averaging;
    const double low = imk_allan_noise_variance(&noise, 1 / t->rate, below);
    const double high = imk_allan_noise_variance(&noise, 1 / t->rate, below + 1);
    return low + (averaging - (double)below) * (high - low);
}

static void count_point(cover *c, size_t i, double expected, const imk_allan_point *p)
{
    c->held[i] += p->lower * p->lower <= expected && expected <= p->upper * p->upper;
    c->ratio[i] += p->deviation * p->deviation / expected;
}

static void complete(const truth *t, const kind *k, const double *sums, void *workspace,
                     size_t size, cover *c)
{
    imk_allan_point points[FACTORS];
    imk_allan_settings settings = imk_allan_default();
    settings.statistic = k->statistic;
    settings.workspace = workspace;
    settings.workspace_size = size;
    if (imk_allan_points(&settings, t->samples, sums, c->count, c->m, points, NULL) != IMK_OK)
        exit(1);
    for (size_t i = 0; i < c->count; i++)
        count_point(c, i, variance_of(t, imk_allan_averaging(k->statistic, c->m[i])), &points[i]);
}

static void with_gaps(const truth *t, uint64_t record, double *x, void *workspace, size_t size,
                      cover *c)
{
    imk_allan_gap_point points[FACTORS];
    const imk_allan_gaps_settings settings = imk_allan_gaps_default();
    double draw[1024];
    for (size_t i = 0; i < t->samples; i++) {
        if (i % 1024 == 0)
            imk_random_normals(imk_random_seeded(77), record << 20, i, 1024, draw);
        if (draw[i % 1024] < -1.2816) /* one in ten */
            x[i] = (double)NAN;
    }
    if (imk_allan_gaps_points(&settings, t->samples, x, c->count, c->m, points, NULL, workspace,
                              size) != IMK_OK)
        exit(1);
    for (size_t i = 0; i < c->count; i++)
        count_point(c, i, variance_of(t, (double)c->m[i]), &points[i].point);
}

static void run(const truth *t, const kind *k, size_t records, uint64_t seed, cover *c)
{
    const size_t n = t->samples;
    *c = (cover){.records = records};
    c->count = imk_allan_factors_for(k->statistic, IMK_ALLAN_DECADE, n, c->m);
    while (c->count > 0 && imk_allan_averaging(k->statistic, c->m[c->count - 1]) > (double)n / 4)
        c->count--;
    const size_t size = k->missing ? imk_allan_gaps_workspace_size(n)
                                   : imk_allan_workspace_size(k->statistic, n, c->count, c->m, 1);
    double *x = malloc((n + 1) * sizeof *x), *sums = malloc((n + 1) * sizeof *sums);
    void *workspace = malloc(size + 1);
    if (!x || !sums || !workspace)
        exit(1);
    for (size_t record = 0; record < records; record++) {
        make_record(t, seed, record, x);
        if (k->missing) {
            with_gaps(t, record, x, workspace, size, c);
            continue;
        }
        imk_allan_sums(n, x, sums, NULL);
        complete(t, k, sums, workspace, size, c);
    }
    free(workspace);
    free(sums);
    free(x);
}

static double share(const cover *c, size_t i)
{
    return 100 * (double)c->held[i] / (double)c->records;
}

/* Lowest and highest coverage over the averaging times above `from` and up to `to`, in shares of
 * the record. */
static void extremes(const cover *c, const truth *t, const kind *k, double from, double to,
                     double *low, double *high)
{
    *low = 100;
    *high = 0;
    for (size_t i = 0; i < c->count; i++) {
        const double part = imk_allan_averaging(k->statistic, c->m[i]) / (double)t->samples;
        if (part > from && part <= to) {
            *low = fmin(*low, share(c, i));
            *high = fmax(*high, share(c, i));
        }
    }
}

static bool report(const truth *t, const kind *k, const cover *c)
{
    static const double shown[SHOWN] = {0.001, 0.01, 1.0 / 30, 0.1, 1.0 / 6.3, 0.25};
    double low, high, low_end, high_end;
    extremes(c, t, k, 0, 0.1, &low, &high);
    extremes(c, t, k, 0.1, 0.25, &low_end, &high_end);
    printf("%-6s %-12s %6zu %5.1f to %4.1f %5.1f to %4.1f ", t->name, k->name, c->records, low,
           high, low_end, high_end);
    double worst = 0;
    for (size_t i = 0; i < c->count; i++)
        worst = fmax(worst, fabs(c->ratio[i] / (double)c->records - 1));
    for (size_t s = 0; s < SHOWN; s++) {
        size_t best = 0;
        for (size_t i = 0; i < c->count; i++)
            if (imk_allan_averaging(k->statistic, c->m[i]) <= shown[s] * (double)t->samples)
                best = i;
        printf(" %5.1f", share(c, best));
    }
    printf("  %5.1f\n", 100 * worst);
    fflush(stdout);
    const double error = 4 * 100 * sqrt(0.95 * 0.05 / (double)c->records);
    return low > 93.5 - error && high < 96.5 + error && low_end > 94 - error &&
           high_end < 98 + error;
}

int main(int argc, char **argv)
{
    const size_t records = argc > 1 ? strtoul(argv[1], NULL, 10) : 4000;
    const size_t samples = argc > 2 ? strtoul(argv[2], NULL, 10) : 20000;
    const uint64_t seed = argc > 3 ? strtoull(argv[3], NULL, 10) : 1;
    bool good = true;
    printf("Coverage [%%] of 95 %% intervals, %zu samples; one standard error of %zu records: %.2f "
           "%%\n%-6s %-12s %6s %13s %13s  at T/1000 T/100 T/30 T/10 T/6.3 T/4; largest bias of "
           "the variance [%%]\n",
           samples, records, 100 * sqrt(0.95 * 0.05 / (double)records), "noise", "statistic",
           "records", "up to T/10", "to T/4");
    for (size_t i = 0; i < sizeof TRUTHS / sizeof *TRUTHS; i++)
        for (size_t j = 0; j < sizeof KINDS / sizeof *KINDS; j++) {
            truth t = TRUTHS[i];
            t.samples = samples;
            cover c;
            run(&t, &KINDS[j], records / KINDS[j].share, seed, &c);
            const bool held = report(&t, &KINDS[j], &c);
            good = good && (held || j > 0);
        }
    return !good;
}
