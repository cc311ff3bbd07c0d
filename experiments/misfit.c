/* SPDX-License-Identifier: Apache-2.0 */
/* How often is a model that is right called a misfit, and one that is wrong?
 *
 * usage: misfit [RECORDS] [SAMPLES] [SEED]
 *        misfit - SAMPLES < RECORDS        of doubles at 100 Hz, one record after the other
 *
 * Records of more than half a million samples are identified in one pass. Simulates records at 100
 * Hz and identifies them: first sound ones of a dozen kinds, then ones with something that no model
 * of imukit holds. Prints the share of records whose model disagrees with the measured Allan
 * deviation, up to which part of the longest tau it agrees on average, and how far N is from 1 on
 * average, in half widths of its 95 % interval. Fails when more than 3 of 1000 sound records of a
 * kind are called a misfit. */
#include "noise_record.h"

#include <stdio.h>
#include <stdlib.h>

typedef void (*disturbance)(size_t n, double *x);

/* Half of the white noise's strength more in the second half. */
static void stronger(size_t n, double *x)
{
    for (size_t i = n / 2; i < n; i++)
        x[i] *= 1.5;
}

static void step(size_t n, double *x)
{
    for (size_t i = n / 2; i < n; i++)
        x[i] += 3;
}

/* From 5 to 10 Hz, as strong as the white noise of one sample. */
static void chirp(size_t n, double *x)
{
    for (size_t i = 0; i < n; i++) {
        const double t = (double)i / (double)n;
        x[i] += 14 * sin(2 * 3.14159265358979 * (0.05 * t + 0.025 * t * t) * (double)n);
    }
}

/* One transient of a minute, as of a passing vehicle. */
static void bump(size_t n, double *x)
{
    for (size_t i = 0; i < n; i++) {
        const double t = ((double)i - 0.4 * (double)n) / 2000;
        x[i] += 3 * exp(-0.5 * t * t);
    }
}

static const struct {
    truth truth;
    disturbance disturb;
} KINDS[] = {
    {{.name = "N", .rate = 100, .term = {0, 1, 0, 0, 0}}, NULL},
    {{.name = "N+B", .rate = 100, .term = {0, 1, 1, 0, 0}}, NULL},
    {{.name = "N+K", .rate = 100, .term = {0, 1, 0, 0.2, 0}}, NULL},
    {{.name = "N+B+K", .rate = 100, .term = {0, 1, 1, 0.2, 0}}, NULL},
    {{.name = "Q+N+R", .rate = 100, .term = {0.1, 1, 0, 0, 0.05}}, NULL},
    {{.name = "N+B+R", .rate = 100, .term = {0, 1, 1, 0, 0.05}}, NULL},
    {{.name = "N+Gauss-Markov 10 s",
      .rate = 100,
      .term = {0, 1, 0, 0, 0},
      .gauss_markov = {{1, 10}}},
     NULL},
    {{.name = "N+B+Gauss-Markov 0.3 s",
      .rate = 100,
      .term = {0, 1, 1, 0, 0},
      .gauss_markov = {{3, 0.3}}},
     NULL},
    {{.name = "N+B+resonance", .rate = 100, .term = {0, 1, 1, 0, 0}, .resonance = {6, 20.3, 16}},
     NULL},
    {{.name = "N+B+line", .rate = 100, .term = {0, 1, 1, 0, 0}, .line = {3, 17}}, NULL},
    {{.name = "N+B+filter", .rate = 100, .term = {0, 1, 1, 0, 0}, .filter = {20, 0.7}}, NULL},
    {{.name = "N+B, rounded", .rate = 100, .term = {0, 1, 1, 0, 0}, .step = 15}, NULL},
    {{.name = "noise half stronger later", .rate = 100, .term = {0, 1, 0.3, 0, 0}}, stronger},
    {{.name = "N, step", .rate = 100, .term = {0, 1, 0, 0, 0}}, step},
    {{.name = "N, chirp", .rate = 100, .term = {0, 1, 0, 0, 0}}, chirp},
    {{.name = "N, bump", .rate = 100, .term = {0, 1, 0, 0, 0}}, bump},
};

typedef struct counts {
    size_t records, misfits, failed;
    double to;    /* sum of valid_to over longest */
    double moved; /* sum of N - 1, in half widths of its interval */
} counts;

/* In one pass, as logs of half a million samples and more are identified. */
static imk_status identify_long(const imk_identify_settings *settings, size_t n, const double *x,
                                imk_identification *r)
{
    const size_t size = imk_identify_record_size(n);
    void *memory = malloc(size), *workspace = NULL;
    imk_identify_record *record = NULL;
    imk_status status =
        memory ? imk_identify_record_begin(n, &record, memory, size, NULL) : IMK_ERROR_MEMORY;
    if (status == IMK_OK)
        status = imk_identify_record_add(record, n, x, NULL);
    const size_t room = status == IMK_OK ? imk_identify_record_workspace_size(record) : 0;
    if (room > 0)
        workspace = malloc(room);
    if (workspace)
        status = imk_identify_record_finish(record, settings, r, workspace, room, NULL);
    free(workspace);
    free(memory);
    return status;
}

static void identify(size_t n, const double *x, void *workspace, size_t size, counts *c)
{
    imk_identification r;
    imk_identify_settings settings = imk_identify_default();
    settings.dt = 0.01;
    c->records++;
    const imk_status status = n < IMK_IDENTIFY_RECORD_LEAST
                                  ? imk_identify_channel(&settings, n, x, &r, workspace, size, NULL)
                                  : identify_long(&settings, n, x, &r);
    if (status != IMK_OK) {
        c->failed++;
        return;
    }
    const bool misfit = r.verdict & IMK_VERDICT_MISFIT;
    c->misfits += misfit;
    c->to += r.valid_to / r.longest;
    const imk_estimate *white = &r.term[IMK_NOISE_WHITE];
    c->moved += (white->value - 1) / (0.5 * (white->upper - white->lower));
    if (misfit && getenv("MISFIT_SHOWN"))
        printf("record %zu: from %g to %g of %g\n", c->records - 1, r.valid_from, r.valid_to,
               r.longest);
}

static void print(const char *name, const counts *c)
{
    const double all = (double)c->records;
    printf("%-28s %7zu %7zu %9.2f %% %9.3f %9.2f\n", name, c->records, c->failed,
           100 * (double)c->misfits / all, c->to / all, c->moved / all);
    fflush(stdout);
}

int main(int argc, char **argv)
{
    const bool given = argc > 2 && strcmp(argv[1], "-") == 0;
    const size_t records = argc > 1 ? strtoul(argv[1], NULL, 10) : 1000;
    const size_t n = argc > 2 ? strtoul(argv[2], NULL, 10) : 20000;
    const uint64_t seed = argc > 3 ? strtoull(argv[3], NULL, 10) : 1;
    const size_t size = imk_identify_workspace_size(n);
    double *x = malloc(n * sizeof *x);
    void *workspace = malloc(size);
    if (!x || !workspace)
        return 1;
    bool good = true;
    printf("%-28s %7s %7s %11s %9s %9s\n", "", "records", "refused", "misfit", "valid to",
           "N moves");
    counts all = {0};
    while (given && fread(x, sizeof *x, n, stdin) == n)
        identify(n, x, workspace, size, &all);
    if (given)
        print("records given", &all);
    for (size_t k = 0; !given && k < sizeof KINDS / sizeof *KINDS; k++) {
        truth t = KINDS[k].truth;
        counts c = {0};
        t.samples = n;
        for (size_t i = 0; i < records; i++) {
            make_record(&t, seed, i, x);
            if (KINDS[k].disturb)
                KINDS[k].disturb(n, x);
            identify(n, x, workspace, size, &c);
        }
        print(t.name, &c);
        good = good && (KINDS[k].disturb || c.misfits <= 3 + 3 * records / 1000);
    }
    free(workspace);
    free(x);
    return !good;
}
