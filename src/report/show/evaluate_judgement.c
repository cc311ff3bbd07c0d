/* SPDX-License-Identifier: Apache-2.0 */
/* Whether a unit keeps its limits; where none is stated, how well its figures are known. */
#include "show_internal.h"

#include <math.h>
#include <string.h>

/* ---- with limits ----------------------------------------------------------------------------- */

/* Rows of a sheet with one of these verdicts, each as a reason. */
static size_t add_rows(const char *name, const imk_evaluate_sheet *sheet, bool surely,
                       imki_reasons *reasons)
{
    size_t count = 0;
    for (const imk_evaluate_row *row = sheet->row; row < sheet->row + sheet->count; row++) {
        const bool missed = row->verdict == IMK_EVALUATE_NOT_MET;
        if (row->verdict <= IMK_EVALUATE_MET || missed != surely)
            continue;
        count++;
        imki_reason(reasons, "%s of %s is %s its limit, %s", row->title, name,
                    missed                                  ? "beyond"
                    : row->verdict == IMK_EVALUATE_DOUBTFUL ? "not surely within"
                                                            : "not determined, so it cannot meet",
                    row->limit);
    }
    return count;
}

static size_t count_limits(const imk_evaluate_sheet *sheet)
{
    size_t count = 0;
    for (size_t k = 0; k < sheet->count; k++)
        count += sheet->row[k].verdict != IMK_EVALUATE_NONE;
    return count;
}

static void judge_limits(const imk_evaluate_shown *v, imki_reasons *reasons)
{
    size_t count[2] = {0, 0}, limits = 0; /* doubtful, missed */
    for (int surely = 1; surely >= 0; surely--) {
        for (size_t k = 0; k < v->channel_count; k++)
            count[surely] +=
                add_rows(v->channel[k].name, &v->channel[k].sheet, surely > 0, reasons);
        for (size_t k = 0; k < v->rest_count; k++)
            count[surely] += add_rows(v->rest[k].name, &v->rest[k].sheet, surely > 0, reasons);
    }
    for (size_t k = 0; k < v->channel_count; k++)
        limits += count_limits(&v->channel[k].sheet);
    for (size_t k = 0; k < v->rest_count; k++)
        limits += count_limits(&v->rest[k].sheet);
    if (count[0] + count[1] == 0)
        imki_reason(reasons,
                    limits == 1 ? "the limit is met with the whole interval"
                                : "all %zu limits are met with their whole intervals",
                    limits);
    imki_judge(reasons,
               count[1] > 0   ? IMK_NOT_USABLE
               : count[0] > 0 ? IMK_USABLE_WITH_CARE
                              : IMK_USABLE,
               "");
}

/* ---- without --------------------------------------------------------------------------------- */

static const imk_evaluation_figure *figure_of(const imk_evaluate_channel *c, const char *key)
{
    for (size_t k = 0; k < c->sheet.count; k++)
        if (strcmp(c->sheet.row[k].key, key) == 0)
            return &c->sheet.row[k].figure;
    return NULL;
}

/* Half the interval of the scale factor, relative, and the upper end of a figure, of the worst
 * channel; 0: not known of any, infinite: not of one of them. */
static double worst_scale(const imk_evaluate_shown *v)
{
    double most = 0;
    for (size_t k = 0; k < v->channel_count; k++) {
        const imk_evaluation_figure *f = figure_of(&v->channel[k], "sensitivity");
        const double half = f ? (f->upper - f->lower) / 2 / fabs(f->value) : (double)NAN;
        most = isfinite(half) ? fmax(most, half) : HUGE_VAL;
    }
    return most;
}

static double worst_of(const imk_evaluate_shown *v, const char *key)
{
    double most = 0;
    for (size_t k = 0; k < v->channel_count; k++) {
        const imk_evaluation_figure *f = figure_of(&v->channel[k], key);
        most = f && isfinite(f->upper) ? fmax(most, f->upper) : HUGE_VAL;
    }
    return most;
}

/* What makes figures doubtful. */
static void add_doubts(const imk_evaluate_shown *v, imki_reasons *reasons)
{
    size_t alone = 0, equal = 0;
    if (v->findings)
        imki_reasons_of_warnings(reasons, v->findings);
    for (size_t k = 0; k < v->channel_count; k++) {
        const imk_evaluation *r = &v->channel[k].result;
        alone += r->source >= IMK_SCATTER_RESIDUALS;
        equal += r->source == IMK_SCATTER_REPLICATES && r->precision.value == 0;
    }
    if (alone > 0)
        imki_reason(reasons, "no reading was repeated, so that noise cannot be told from "
                             "nonlinearity and hysteresis");
    if (equal > 0)
        imki_reason(reasons, "repeated readings are all equal, so that the noise is hidden");
}

static void judge_figures(const imk_evaluate_shown *v, imki_reasons *reasons)
{
    const double scale = worst_scale(v), linearity = worst_of(v, "linearity");
    add_doubts(v, reasons);
    const bool doubts = reasons->told > 0;
    if (isfinite(scale) && scale > 0)
        imki_reason(reasons, "the scale factor is known to %s ppm",
                    imki_value(1e6 * scale, 1e6 * scale, 2).text);
    if (isfinite(linearity))
        imki_reason(reasons, "linearity is %.3g %% of full scale or better", 100 * linearity);
    imki_judge(reasons, doubts || !isfinite(scale) ? IMK_USABLE_WITH_CARE : IMK_USABLE,
               v->channel_count > 1 ? " (worst axis)" : "");
}

void imki_judge_evaluation(const imk_evaluate_shown *v, imk_result *result)
{
    imki_reasons reasons = {.result = result};
    bool scaled = false;
    size_t identified = 0;
    for (size_t k = 0; k < v->channel_count; k++)
        scaled = scaled || isfinite(v->channel[k].result.line.sensitivity);
    for (size_t k = 0; k < v->rest_count; k++)
        identified += v->rest[k].identified;
    if (v->limit_count > 0) {
        judge_limits(v, &reasons);
    } else if (v->channel_count == 0) {
        imki_reason(&reasons, "noise is identified in %zu of %zu columns at rest", identified,
                    v->rest_count);
        imki_judge(&reasons,
                   identified == 0              ? IMK_NOT_USABLE
                   : identified < v->rest_count ? IMK_USABLE_WITH_CARE
                                                : IMK_USABLE,
                   "");
    } else if (!scaled) {
        imki_reason(&reasons, "the reference has too few levels for a scale factor");
        imki_judge(&reasons, IMK_NOT_USABLE, "");
    } else {
        judge_figures(v, &reasons);
    }
}
