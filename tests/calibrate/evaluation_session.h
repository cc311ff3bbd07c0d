/* SPDX-License-Identifier: Apache-2.0 */
/* Laboratory tables that are drawn, and how often the intervals of their figures hold the truth:
 * for the test and for the long experiment. */
#ifndef IMUKIT_TESTS_EVALUATION_SESSION_H
#define IMUKIT_TESTS_EVALUATION_SESSION_H

#include "imukit/evaluate.h"
#include "imukit/random.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A unit on a rate table that sweeps -1 … 1 up and down; the noise of a reading is 1e-3. */
typedef struct evaluation_plan {
    const char *name;
    int levels, sweeps, runs;
    double zero, scale;         /* error of both */
    double cubic, square;       /* nonlinearity */
    double asymmetry, loop;     /* |x|/2; half of the hysteresis at the middle */
    double run_zero, run_scale; /* 1 sigma from run to run */
} evaluation_plan;

static const evaluation_plan evaluation_plans[] = {
    {"linear, 2 sweeps", 11, 2, 1, 2e-3, 1e-3, 0, 0, 0, 0, 0, 0},
    {"cubic of one noise, 3 sweeps", 21, 3, 1, 0, 5e-3, 3e-3, 0, 0, 1e-3, 0, 0},
    {"cubic of 10 noises, loop", 21, 2, 1, 1e-3, 0, 3e-2, 0, 2e-3, 5e-3, 0, 0},
    {"square, 5 levels, 2 sweeps", 5, 2, 1, 5e-3, 0, 0, 5e-3, 0, 2e-3, 0, 0},
    {"everything, 4 runs", 11, 1, 4, 3e-3, 2e-3, 1e-2, 4e-3, 3e-3, 3e-3, 5e-3, 2e-3},
    {"cubic, 10 runs of 2 sweeps", 21, 2, 10, 3e-3, 2e-3, 1e-3, 0, 3e-3, 5e-4, 5e-3, 2e-3}};

enum {
    EVALUATION_PLANS = sizeof evaluation_plans / sizeof *evaluation_plans,
    EVALUATION_FIGURES = 9,
    EVALUATION_ROWS = 2000
};

typedef struct evaluation_score {
    double stated, high, low; /* intervals; of these, wholly above and below the truth */
    double sum, square;       /* of value less truth */
} evaluation_score;

typedef struct evaluation_rows {
    size_t count;
    double reference[EVALUATION_ROWS], reading[EVALUATION_ROWS];
    int run[EVALUATION_ROWS];
} evaluation_rows;

static inline void evaluation_add(const evaluation_plan *p, evaluation_rows *t, int level, int side,
                                  int run, const double *run_error, const double *noise)
{
    const double x = 2.0 * level / (p->levels - 1) - 1.0;
    const double y = p->zero + (1.0 + p->scale) * x + p->cubic * x * x * x + p->square * x * x +
                     0.5 * p->asymmetry * fabs(x) + side * p->loop * (1.0 - x * x);
    t->reference[t->count] = x;
    t->run[t->count] = run;
    t->reading[t->count] = y + (run_error ? run_error[0] + run_error[1] * x : 0.0) +
                           (noise ? 1e-3 * noise[t->count] : 0.0);
    t->count++;
}

/* Each run begins in the middle, rises, and then goes down and up. NULL: without noise, and
 * without differences between runs. */
static inline void evaluation_draw(const evaluation_plan *p, evaluation_rows *t,
                                   const double *run_error, const double *noise)
{
    t->count = 0;
    for (int run = 0; run < p->runs; run++) {
        const double *own = run_error ? run_error + 2 * run : NULL;
        for (int sweep = 0; sweep < p->sweeps; sweep++) {
            for (int k = p->levels - 1; k >= 0; k--)
                evaluation_add(p, t, k, k == p->levels - 1 ? 1 : -1, run, own, noise);
            for (int k = 1; k < p->levels - 1; k++)
                evaluation_add(p, t, k, 1, run, own, noise);
        }
    }
}

static inline void evaluation_figures(const imk_evaluation *r, imk_evaluation_figure *figure)
{
    const imk_evaluation_figure all[EVALUATION_FIGURES] = {
        r->precision, r->sensitivity,    r->zero,       r->accuracy, r->coverage,
        r->linearity, r->linearity_best, r->hysteresis, r->asymmetry};
    memcpy(figure, all, sizeof all);
}

/* 1.96 sigma and the mean error: what the coverage figure is of, by bisection on the closed form.
 */
static inline double evaluation_coverage(double mean, double sigma)
{
    double low = 0.0, high = fabs(mean) + 10.0 * sigma;
    for (int i = 0; i < 60; i++) {
        const double w = 0.5 * (low + high), root = sigma * sqrt(2.0);
        const double inside = 0.5 * (erf((w - mean) / root) + erf((w + mean) / root));
        *(inside < 0.95 ? &low : &high) = w;
    }
    return low;
}

static inline void evaluation_cover(const evaluation_plan *plan, uint32_t number, int tables,
                                    uint64_t seed, evaluation_score *score)
{
    static evaluation_rows t;
    static double noise[EVALUATION_ROWS], error[2 * IMK_EVALUATION_RUNS_MAX];
    const imk_random source = imk_random_seeded(seed);
    const imk_evaluation_settings settings = imk_evaluation_default();
    imk_evaluation_figure truth[EVALUATION_FIGURES], found[EVALUATION_FIGURES];
    imk_evaluation result;
    for (int i = -1; i < tables; i++) {
        imk_random_normals(source, 2 * number, (uint64_t)(i + 1) * EVALUATION_ROWS, EVALUATION_ROWS,
                           noise);
        imk_random_normals(source, 2 * number + 1, (uint64_t)(i + 1) * 2 * IMK_EVALUATION_RUNS_MAX,
                           (size_t)2 * IMK_EVALUATION_RUNS_MAX, error);
        /* Runs whose differences have no mean: the figures are those of these runs. */
        double mean[2] = {0.0, 0.0};
        for (int k = 0; k < 2 * plan->runs; k++)
            mean[k % 2] += error[k] / plan->runs;
        for (int k = 0; k < 2 * plan->runs; k++)
            error[k] = (error[k] - mean[k % 2]) * (k % 2 ? plan->run_scale : plan->run_zero);
        evaluation_draw(plan, &t, i < 0 ? NULL : error, i < 0 ? NULL : noise);
        const imk_evaluation_table table = {.count = t.count,
                                            .reference = t.reference,
                                            .reading = t.reading,
                                            .run = plan->runs > 1 ? t.run : NULL};
        const size_t size = imk_evaluation_workspace_size(&table);
        void *workspace = malloc(size);
        if (imk_evaluate(&table, &settings, NULL, 0, &result, workspace, size, NULL) != IMK_OK)
            abort();
        free(workspace);
        if (i < 0) {
            evaluation_figures(&result, truth);
            truth[0].value = 1e-3;
            truth[4].value = evaluation_coverage(truth[3].value, 1e-3);
            continue;
        }
        evaluation_figures(&result, found);
        for (int k = 0; k < EVALUATION_FIGURES; k++) {
            const double d = found[k].value - truth[k].value;
            if (!isfinite(found[k].lower) || !isfinite(found[k].upper))
                continue;
            score[k].stated += 1;
            /* Rounding of exact zeros is no error. */
            score[k].high += found[k].lower > truth[k].value + 1e-12;
            score[k].low += found[k].upper < truth[k].value - 1e-12;
            score[k].sum += d;
            score[k].square += d * d;
        }
    }
}

#endif
