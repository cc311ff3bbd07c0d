/* SPDX-License-Identifier: Apache-2.0 */
/* Resolution and threshold: the smallest change of the reference from which on every tested one
 * gives at least half of the expected change of the reading [IEEE528]. Where every tested change
 * does, the figure has no value, only its upper end: it is finer than what was tested. Changes are
 * those between successive holds of a run, and from the run's mean reading at rest: at the level
 * nearest to 0, when that is ten times nearer than the next one (a reference in inertial space has
 * the Earth's rate). */
#include "evaluate_internal.h"

#include "imukit/distributions.h"

/* Steps that differ less than this part of themselves are one. */
static const double equal = 1e-6;
/* So much nearer to 0 than to the next level is at rest. */
static const double at_rest = 0.1;

/* Successive readings of one run at one level. */
typedef struct hold {
    size_t end;
    int level, run;
    double mean, variance;
} hold;

static hold next_hold(const imki_evaluation *e, size_t begin)
{
    hold h = {begin, e->level_of[begin], imki_run_of(e, begin), 0.0, 0.0};
    for (; h.end < e->rows && e->level_of[h.end] == h.level && imki_run_of(e, h.end) == h.run;
         h.end++) {
        const double count = (double)(h.end - begin) + 1.0;
        const double shift = e->table->reference[h.end] - e->reference[h.level];
        h.mean += (e->table->reading[h.end] - e->result->line.sensitivity * shift - h.mean) / count;
        h.variance += imki_reading_variance(e, h.end);
    }
    h.variance /= (double)(h.end - begin) * (double)(h.end - begin);
    return h;
}

/* A tested change: its amount, the part of the expected change that came, and the half width of
 * that by the noise. */
typedef struct change {
    double amount, part, half;
} change;

/* Gathered over all steps. */
typedef struct summary {
    size_t count;
    double failed;   /* largest that gave less than half, noise permitting */
    double bad;      /* largest that surely did */
    double doubtful; /* largest that may have done */
    double smallest; /* that could be assessed */
    double passed;   /* smallest above `failed` that gave half */
    double sure;     /* smallest above `doubtful` */
} summary;

typedef void (*visitor)(summary *s, const change *step);

static void count_step(summary *s, const change *step)
{
    (void)step;
    s->count++;
}

static void find_failures(summary *s, const change *step)
{
    const bool assessed = step->half < 0.5, bad = step->part + step->half < 0.5;
    if (bad || (assessed && step->part < 0.5))
        s->failed = fmax(s->failed, step->amount);
    if (bad)
        s->bad = fmax(s->bad, step->amount);
    if (assessed)
        s->smallest = fmin(s->smallest, step->amount);
    if (!(step->part - step->half >= 0.5))
        s->doubtful = fmax(s->doubtful, step->amount);
}

static void find_successes(summary *s, const change *step)
{
    const bool assessed = step->half < 0.5;
    if (assessed && step->part >= 0.5 && step->amount > s->failed * (1.0 + equal))
        s->passed = fmin(s->passed, step->amount);
    if (step->part - step->half >= 0.5 && step->amount > s->doubtful * (1.0 + equal))
        s->sure = fmin(s->sure, step->amount);
}

/* The level at rest, -1: none; its mean reading by run, NaN where there is none, and variance. */
typedef struct zeros {
    int level;
    double mean[IMK_EVALUATION_RUNS_MAX], variance[IMK_EVALUATION_RUNS_MAX];
} zeros;

static int level_at_rest(const imki_evaluation *e)
{
    size_t rest = 0;
    double next = HUGE_VAL;
    for (size_t k = 1; k < e->levels; k++)
        if (fabs(e->reference[k]) < fabs(e->reference[rest]))
            rest = k;
    for (size_t k = 0; k < e->levels; k++)
        if (k != rest)
            next = fmin(next, fabs(e->reference[k] - e->reference[rest]));
    return fabs(e->reference[rest]) <= at_rest * next ? (int)rest : -1;
}

static void find_zeros(const imki_evaluation *e, zeros *z)
{
    double count[IMK_EVALUATION_RUNS_MAX] = {0.0};
    for (int run = 0; run < e->runs; run++)
        z->mean[run] = z->variance[run] = 0.0;
    for (size_t row = 0; row < e->rows; row++) {
        const int run = imki_run_of(e, row);
        if (e->level_of[row] != z->level)
            continue;
        count[run] += 1.0;
        z->mean[run] += (e->table->reading[row] - z->mean[run]) / count[run];
        z->variance[run] += imki_reading_variance(e, row);
    }
    for (int run = 0; run < e->runs; run++) {
        z->variance[run] /= count[run] * count[run];
        z->mean[run] = count[run] > 0.0 ? z->mean[run] : (double)NAN;
    }
}

static void visit_change(const imki_evaluation *e, double input, double answer, double variance,
                         double quantile, visitor visit, summary *s)
{
    const double expected = e->result->line.sensitivity * input;
    const double half = quantile > 0.0 ? quantile * sqrt(variance) / fabs(expected) : 0.0;
    const change step = {fabs(input), answer / expected, half};
    visit(s, &step);
}

/* Between successive holds, or from the readings at 0 when `zero` is given. */
static void visit_steps(const imki_evaluation *e, const zeros *zero, double quantile, visitor visit,
                        summary *s)
{
    hold last = {0, -1, -1, 0.0, 0.0};
    for (size_t begin = 0; begin < e->rows;) {
        const hold h = next_hold(e, begin);
        const double x = e->reference[h.level];
        if (zero && h.level != zero->level && isfinite(zero->mean[h.run]))
            visit_change(e, x - e->reference[zero->level], h.mean - zero->mean[h.run],
                         h.variance + zero->variance[h.run], quantile, visit, s);
        if (!zero && last.run == h.run)
            visit_change(e, x - e->reference[last.level], h.mean - last.mean,
                         h.variance + last.variance, quantile, visit, s);
        last = h;
        begin = h.end;
    }
}

static imk_evaluation_figure smallest_step(const imki_evaluation *e, const zeros *zero,
                                           double *tested)
{
    summary s = {0, 0.0, 0.0, 0.0, HUGE_VAL, HUGE_VAL, HUGE_VAL};
    visit_steps(e, zero, 0.0, count_step, &s);
    if (s.count == 0)
        return imki_unknown();
    /* All steps together are assessed with the confidence [BONFERRONI1936]. */
    const double tail = 0.5 * (1.0 - e->settings->confidence) / (double)s.count;
    const double quantile = e->result->source == IMK_SCATTER_NONE
                                ? 0.0
                                : imk_student_quantile(1.0 - tail, e->result->freedom);
    visit_steps(e, zero, quantile, find_failures, &s);
    visit_steps(e, zero, quantile, find_successes, &s);
    *tested = s.smallest < HUGE_VAL ? s.smallest : (double)NAN;
    const bool intervals = e->result->source != IMK_SCATTER_NONE;
    return (imk_evaluation_figure){s.failed > 0.0 ? s.passed : (double)NAN,
                                   intervals ? s.bad : (double)NAN,
                                   intervals && s.sure < HUGE_VAL ? s.sure : (double)NAN};
}

void imki_steps(imki_evaluation *e)
{
    zeros zero;
    if (e->levels < 2)
        return;
    e->result->resolution = smallest_step(e, NULL, &e->result->smallest_step);
    zero.level = level_at_rest(e);
    if (zero.level < 0)
        return;
    find_zeros(e, &zero);
    e->result->threshold = smallest_step(e, &zero, &e->result->smallest_input);
}
