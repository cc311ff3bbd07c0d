/* SPDX-License-Identifier: Apache-2.0 */
/* For how long an error is small enough for a position, or whether a requirement is met, and what
 * limits it. */
#include "drift_show_internal.h"
#include "unstated_show_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A position to a nautical mile is a position; to 100 m it is a good one [m]. */
static const double usable_error = 1852, good_error = 100;

/* The CEP in a row of the table, or where there are only runs, the upper end of its interval;
 * infinite where there is no position. */
static double cep_at(const imk_drift_models *r, const imk_drift_case *one, size_t row)
{
    const imk_drift_figures *f = one ? &one->figures[r->times->row[row]] : &r->found[row];
    const double cep = one || !isfinite(r->high[row].cep) ? f->cep : r->high[row].cep;
    return (one && imk_drift_validity_of(f) == IMK_DRIFT_LOST) || !isfinite(cep) ? HUGE_VAL : cep;
}

/* Rows from the first on within a limit. */
static size_t rows_within(const imk_drift_models *r, const imk_drift_case *one, double limit)
{
    size_t rows = 0;
    while (rows < r->times->row_count && cep_at(r, one, rows) <= limit)
        rows++;
    return rows;
}

static const char *time_text(const imk_drift_models *r, size_t row, char text[IMKI_DRIFT_TIME])
{
    return imki_drift_moment(r, imki_drift_row_time(r, row), text);
}

/* "gyro bias repeatability makes 55 % of the variance after 10 min" */
static void add_share(const imk_drift_models *r, const char *source, double share, double time,
                      imki_reasons *reasons)
{
    char text[IMKI_DRIFT_TIME];
    if (share > 0)
        imki_reason(reasons, "%s makes %.0f %% of the variance after %s", source, 100 * share,
                    imki_drift_moment(r, time, text));
}

/* What makes the error where it becomes too large, or at the end: at a row of the table. */
static void add_limit(const imk_drift_models *r, const imk_drift_case *one, size_t row,
                      imki_reasons *reasons)
{
    const imk_drift_analysis *a = one ? one->analysis : NULL;
    const size_t last = r->times->row_count - 1;
    const size_t t = a ? r->times->row[row < last ? row : last] : 0;
    size_t largest = 0;
    if (!a || a->source_count == 0)
        return;
    for (size_t k = 1; k < a->source_count; k++)
        if (imki_drift_share_at(a, k, t) > imki_drift_share_at(a, largest, t))
            largest = k;
    add_share(r, a->source[largest].text, imki_drift_share_at(a, largest, t), r->times->time[t],
              reasons);
}

/* A message without the label of its case, where there is one model. */
static const char *without_label(const imk_drift_models *r, const char *text)
{
    for (size_t c = 0; r->model_count == 1 && c < r->case_count; c++) {
        const size_t length = strlen(r->cases[c].label);
        if (strncmp(text, r->cases[c].label, length) == 0 && strncmp(text + length, ": ", 2) == 0)
            return text + length + 2;
    }
    return text;
}

/* Doubts that are not about times at which there is no position any more. */
static bool add_doubts(const imk_drift_models *r, const imk_verdict *v, imki_reasons *reasons)
{
    const size_t told = reasons->told;
    for (size_t k = 0; k < v->count; k++)
        if (strcmp(v->message[k].code, "no_position") != 0 &&
            strcmp(v->message[k].code, "nonlinear") != 0)
            imki_reason_of_message(reasons, without_label(r, v->message[k].text));
    return reasons->told > told;
}

/* ---- one case, or runs alone ----------------------------------------------------------------- */

static void judge_time(const imk_drift_models *r, const imk_drift_case *one, const imk_verdict *v,
                       imki_reasons *reasons)
{
    char text[IMKI_DRIFT_TIME], cep[IMK_READABLE_SIZE], use[IMKI_DRIFT_TIME + 20] = "";
    const size_t rows = rows_within(r, one, usable_error), good = rows_within(r, one, good_error);
    const char *figure = one ? "CEP" : "CEP of the runs";
    const bool doubts = add_doubts(r, v, reasons);
    if (rows == 0) {
        const double first = cep_at(r, one, 0);
        if (isfinite(first))
            imki_reason(reasons, "the %s is %s after %s already", figure,
                        imk_readable_figure(IMK_REQUIRED_CEP, first, cep), time_text(r, 0, text));
        else
            imki_reason(reasons, "there is none after %s already", time_text(r, 0, text));
        add_limit(r, one, 0, reasons);
        imki_judge(reasons, IMK_NOT_USABLE, " for a position");
        return;
    }
    snprintf(use, sizeof use, " for %s", time_text(r, rows - 1, text));
    imki_reason(reasons, "the %s stays within 1 nmi%s", figure,
                rows == r->times->row_count ? " to the end" : "");
    if (good > 0 && good < rows)
        imki_reason(reasons, "it is within 100 m for %s", time_text(r, good - 1, text));
    else if (good == rows)
        imki_reason(reasons, "it is %s then",
                    imk_readable_figure(IMK_REQUIRED_CEP, cep_at(r, one, rows - 1), cep));
    add_limit(r, one, rows, reasons);
    imki_judge(reasons, doubts ? IMK_USABLE_WITH_CARE : IMK_USABLE, use);
}

/* ---- several models -------------------------------------------------------------------------- */

static void judge_models(const imk_drift_models *r, const imk_verdict *v, imki_reasons *reasons)
{
    bool any = false;
    for (size_t c = 0; c < r->case_count; c++) {
        const imk_drift_case *one = &r->cases[c];
        char text[IMKI_DRIFT_TIME];
        const size_t rows = rows_within(r, one, usable_error);
        any = any || rows > 0;
        if (rows > 0)
            imki_reason(reasons, "%s for %s%s", one->label, time_text(r, rows - 1, text),
                        one->missing_count > 0 ? " at best" : "");
        else
            imki_reason(reasons, "%s not even for %s", one->label, time_text(r, 0, text));
    }
    const bool doubts = add_doubts(r, v, &(imki_reasons){.result = reasons->result});
    imki_judge(reasons,
               !any     ? IMK_NOT_USABLE
               : doubts ? IMK_USABLE_WITH_CARE
                        : IMK_USABLE,
               " within 1 nmi (CEP)");
}

/* ---- a requirement --------------------------------------------------------------------------- */

static void judge_want(const imk_drift_models *r, const imk_verdict *v, imki_reasons *reasons)
{
    const imk_drift_case *one = imki_drift_last_case(r);
    const imk_drift_wanted *want = &r->settings.want;
    const double present = r->answer->allocation.present;
    const bool met = present <= want->goal;
    char use[160], goal[IMK_READABLE_SIZE], now[IMK_READABLE_SIZE], time[IMKI_DRIFT_TIME];
    snprintf(use, sizeof use, " for %s %s after %s", imk_drift_requirement_name(want->figure),
             imk_readable_quantity(want->goal, &want->unit, goal),
             imki_drift_moment(r, want->time, time));
    if (isfinite(present))
        imki_reason(reasons, "the figure is %s%s", one->missing_count > 0 ? "at least " : "",
                    imk_readable_quantity(present, &want->unit, now));
    if (one->share_count > 0)
        add_share(r, one->analysis->source[one->share[0].source].text, one->share[0].share,
                  want->time, reasons);
    const bool doubts = add_doubts(r, v, reasons);
    imki_judge(reasons, !met ? IMK_NOT_USABLE : doubts ? IMK_USABLE_WITH_CARE : IMK_USABLE, use);
}

void imki_judge_drift(const imk_drift_models *r, const imk_verdict *v, imk_result *result)
{
    imki_reasons reasons = {.result = result};
    if (r->answer)
        judge_want(r, v, &reasons);
    else if (r->model_count > 1)
        judge_models(r, v, &reasons);
    else
        judge_time(r, r->case_count > 0 ? imki_drift_last_case(r) : NULL, v, &reasons);
}
