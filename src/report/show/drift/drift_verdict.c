/* SPDX-License-Identifier: Apache-2.0 */
/* What makes figures of drift doubtful. */
#include "drift_show_internal.h"
#include "unstated_show_internal.h"

#include "report/result_internal.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>

/* A linear figure and a figure of runs differ when the interval of the runs lies outside this
 * tolerance around the linear figure; fourth-order terms explain smaller differences. In a table of
 * 95 % intervals some miss the truth, so they are widened by 2.5, to a chance of 1e-6 each for a
 * nearly normal figure. */
static const double tolerance = 0.05, widening = 2.5;

static void warn(imk_verdict *v, const char *code, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

static void warn(imk_verdict *v, const char *code, const char *format, ...)
{
    imki_arena *arena = &v->result->arena;
    va_list arguments;
    va_start(arguments, format);
    const char *words = imki_arena_format(arena, format, arguments);
    va_end(arguments);
    v->message = imki_arena_extend(arena, v->message, v->count, sizeof *v->message);
    if (v->message)
        v->message[v->count++] =
            (imk_message){.level = IMK_FINDING_WARNING, .code = code, .text = words};
    else
        v->count = 0;
}

/* Omitted terms of one case in a list. */
static void warn_of_omitted(const imk_drift_case *one, imk_verdict *v)
{
    imki_text list = {.bytes = NULL};
    for (size_t i = 0; i < one->analysis->omitted_count; i++)
        imki_text_add(&list, "%s%s", i > 0 ? ", " : "", one->analysis->omitted[i]);
    if (list.failed)
        v->result->arena.failed = true;
    else if (list.size > 0)
        warn(v, "omitted",
             "%s: the linear theory leaves out %.239s; --monte-carlo includes everything that "
             "needs no temperature",
             one->label, list.bytes);
    free(list.bytes);
}

/* Figures that something material is missing from. */
static void warn_of_missing(const imk_drift_case *one, imk_verdict *v)
{
    imki_text list = {.bytes = NULL};
    imki_missing_names(one->missing_count, one->missing, &list);
    if (list.failed)
        v->result->arena.failed = true;
    else if (list.size > 0)
        warn(v, "lower_bound",
             "%s: the figures are lower bounds, because the model does not state %.500s; state "
             "them, 0 where they are 0, or assume what is typical with --assume-class own",
             one->label, list.bytes);
    free(list.bytes);
}

/* The time of the first row of the table with this validity. */
static const char *first_time(const imk_drift_models *r, const imk_drift_case *one,
                              imk_drift_validity validity, char text[IMKI_DRIFT_TIME])
{
    const imk_drift_times *times = r->times;
    for (size_t k = 0; k < times->row_count; k++)
        if (imk_drift_validity_of(&one->figures[times->row[k]]) == validity)
            return imki_drift_moment(r, times->time[times->row[k]], text);
    return NULL;
}

static void warn_of_range(const imk_drift_models *r, const imk_drift_case *one, imk_verdict *v)
{
    char text[IMKI_DRIFT_TIME];
    if (first_time(r, one, IMK_DRIFT_LOST, text))
        warn(v, "no_position",
             "%s: at %s the error exceeds a tenth of the Earth's radius: this is no longer a "
             "position",
             one->label, text);
    else if (first_time(r, one, IMK_DRIFT_ROUGH, text))
        warn(
            v, "nonlinear",
            "%s: at %s attitude errors exceed 0.1 rad: linear figures are rough from then on (~)%s",
            one->label, text, r->found ? "" : "; --monte-carlo 1000 computes accurate figures");
}

/* First row where an interval of the runs does not contain the linear figure; -1: none. */
static int disagreement(const imk_drift_models *r, imk_drift_requirement *requirement)
{
    static const imk_drift_requirement looked_at[] = {IMK_REQUIRED_CEP, IMK_REQUIRED_DRMS,
                                                      IMK_REQUIRED_VELOCITY, IMK_REQUIRED_TILT,
                                                      IMK_REQUIRED_HEADING};
    for (size_t k = 0; k < r->times->row_count; k++) {
        const imk_drift_figures *f = &imki_drift_last_case(r)->figures[r->times->row[k]];
        for (size_t c = 0; c < sizeof looked_at / sizeof looked_at[0]; c++) {
            *requirement = looked_at[c];
            const double linear = imk_drift_required(f, *requirement),
                         found = imk_drift_required(&r->found[k], *requirement);
            const double low = imk_drift_required(&r->low[k], *requirement),
                         high = imk_drift_required(&r->high[k], *requirement);
            if (found * pow(low / found, widening) > (1 + tolerance) * linear ||
                found * pow(high / found, widening) < (1 - tolerance) * linear)
                return (int)k;
        }
    }
    return -1;
}

/* The filter's own covariance against its errors, from the first time at which they differ. */
static void warn_of_filter(const imk_drift_models *r, imk_verdict *v)
{
    char text[IMKI_DRIFT_TIME];
    double low = 0, high = 0, degrees = r->nees_degrees;
    const double part = (1 + tolerance) * (1 + tolerance); /* of a sigma, squared */
    size_t k = 0, worst = 0;
    for (; k < r->times->row_count; k++) {
        imki_drift_nees_due(r, k, &low, &high);
        if (r->nees[k] > part * degrees * pow(high / degrees, widening) ||
            r->nees[k] < degrees * pow(low / degrees, widening) / part)
            break;
    }
    if (k == r->times->row_count)
        return;
    for (size_t i = worst = k; i < r->times->row_count; i++)
        if (fabs(log(r->nees[i] / degrees)) > fabs(log(r->nees[worst] / degrees)))
            worst = i;
    const bool better = r->nees[k] > degrees;
    warn(v, "inconsistent",
         "from %s on the filter believes itself %s than it is (NEES %.3g, due %.3g to %.3g; at "
         "worst its sigmas are off by a factor of %.2g): %s",
         imki_drift_moment(r, imki_drift_row_time(r, k), text), better ? "better" : "worse",
         r->nees[k], low, high, exp(0.5 * fabs(log(r->nees[worst] / degrees))),
         better ? "it does not know all errors that act on it; --compensated takes the known "
                  "values out, --filter-model gives it more noise, imukit tune finds how much"
                : "--filter-model gives it a model with less noise, imukit tune finds how much");
}

static void warn_of_runs(const imk_drift_models *r, imk_verdict *v)
{
    imk_drift_requirement requirement;
    char text[IMKI_DRIFT_TIME];
    const size_t last = r->times->row_count - 1;
    if (r->used[last] < r->run_count)
        warn(v, "lost_runs",
             "%llu of %llu runs left the Earth or found no attitude; the figures are from the "
             "other runs",
             (unsigned long long)(r->run_count - r->used[last]), (unsigned long long)r->run_count);
    const int row = disagreement(r, &requirement);
    if (row < 0)
        return;
    warn(v, "disagreement",
         "from %s on the runs differ from the covariance by more than %g %% (%s): the runs are "
         "right, and the linear theory leaves something out%s",
         imki_drift_moment(r, imki_drift_row_time(r, (size_t)row), text), 100 * tolerance,
         imk_drift_requirement_name(requirement),
         r->nees_degrees > 0 ? ", such as readings of an aid that the filter refuses" : "");
}

imk_verdict imk_drift_verdict(const imk_drift_models *r, imk_result *result)
{
    imk_verdict v = {.result = result};
    if (!result)
        return v;
    for (size_t c = 0; c < r->case_count; c++) {
        if (c == 0 || r->cases[c].model != r->cases[c - 1].model)
            warn_of_omitted(&r->cases[c], &v);
        warn_of_missing(&r->cases[c], &v);
        warn_of_range(r, &r->cases[c], &v);
    }
    if (r->found)
        warn_of_runs(r, &v);
    if (r->found && r->nees_degrees > 0)
        warn_of_filter(r, &v);
    return v;
}
