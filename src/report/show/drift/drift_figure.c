/* SPDX-License-Identifier: Apache-2.0 */
/* Drift as a picture: how the error grows, and how much each term contributes at each time. */
#include "drift_show_internal.h"

#include "report/result_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { BANDS = 8, OTHERS = BANDS - 1 /* the last colour */ };

/* A term that has a band of its own. */
typedef struct band {
    size_t source;
    const char *label;
    double peak; /* its largest share at any time */
    int color;
} band;

/* Times in the unit of their axis, and room for as many values. */
typedef struct drawing {
    const imk_drift_models *of;
    imk_figure_builder *figure;
    const char *time_label;
    double unit, length; /* [s], [m] */
    size_t first, count; /* times: those behind the end of the aids, if they end */
    double *time, *below;
} drawing;

static bool is_drawn(const imk_drift_figures *f)
{
    return imk_drift_validity_of(f) != IMK_DRIFT_LOST;
}

static void begin_panel(const drawing *d, const char *title, const char *y_label, imk_key_place key,
                        bool y_logarithmic)
{
    imk_figure_panel(d->figure, &(imk_panel){.title = title,
                                             .x_label = d->time_label,
                                             .y_label = y_label,
                                             .x_logarithmic = true,
                                             .y_logarithmic = y_logarithmic,
                                             .key = key});
}

/* ---- growth ---- */

static void add_line(const drawing *d, const imk_drift_case *one, imk_drift_requirement requirement,
                     const char *label, int color)
{
    imki_begin_curve(d->figure, label, IMK_CURVE_LINE, color);
    for (size_t t = d->first; t < d->count; t++) {
        const imk_drift_figures *f = &one->figures[t];
        imk_figure_point(d->figure, d->time[t],
                         is_drawn(f) ? imk_drift_required(f, requirement) / d->length
                                     : (double)NAN);
    }
}

/* Points with their intervals; too few runs have no upper limit. */
static void add_runs(const drawing *d, imk_drift_requirement requirement, const char *label,
                     int color)
{
    const imk_drift_models *r = d->of;
    imki_begin_curve(d->figure, label, IMK_CURVE_POINTS, color);
    for (size_t k = 0; k < r->times->row_count; k++) {
        if (r->times->row[k] < d->first)
            continue;
        const double found = imk_drift_required(&r->found[k], requirement) / d->length,
                     low = imk_drift_required(&r->low[k], requirement) / d->length,
                     high = imk_drift_required(&r->high[k], requirement) / d->length;
        imk_figure_bar(d->figure, d->time[r->times->row[k]], found, low,
                       isfinite(high) ? high : found);
    }
}

/* CEP of each case; of one case also R95. */
static void show_growth(const drawing *d)
{
    const imk_drift_models *r = d->of;
    begin_panel(d, r->case_count > 1 ? "CEP: half of all outcomes are within" : "Horizontal error",
                d->length > 1 ? "radius [km]" : "radius [m]", IMK_KEY_LOWER, true);
    for (size_t c = 0; c < r->case_count && r->case_count > 1; c++)
        add_line(d, &r->cases[c], IMK_REQUIRED_CEP, r->cases[c].label, (int)c);
    if (r->case_count == 1) {
        add_line(d, &r->cases[0], IMK_REQUIRED_CEP, "CEP: half are within", 0);
        add_line(d, &r->cases[0], IMK_REQUIRED_R95, "R95: 95 % are within", 1);
    }
    if (r->found) {
        add_runs(d, IMK_REQUIRED_CEP, "CEP of the runs", 2);
        add_runs(d, IMK_REQUIRED_R95, "R95 of the runs", 4);
    }
}

/* ---- shares ---- */

static int by_peak(const void *a, const void *b)
{
    const band *x = a, *y = b;
    return (x->peak < y->peak) - (x->peak > y->peak);
}

static double variance(const imk_drift_moments *m)
{
    return m->covariance[0][0] + m->covariance[1][1];
}

double imki_drift_share_at(const imk_drift_analysis *a, size_t source, size_t t)
{
    double total = variance(&a->total[t]);
    for (size_t k = 0; k < a->cross_count; k++)
        total -= variance(&a->cross[k].moments[t]);
    return total > 0 ? variance(&a->contribution[source * a->time_count + t]) / total : 0;
}

/* @return how many terms have a band of their own */
static size_t rank_sources(const imk_drift_analysis *a, band *bands)
{
    const double visible = 0.01;
    size_t count = 0;
    for (size_t k = 0; k < a->source_count; k++) {
        double peak = 0;
        for (size_t t = 0; t < a->time_count; t++)
            peak = fmax(peak, imki_drift_share_at(a, k, t));
        if (peak >= visible)
            bands[count++] = (band){k, a->source[k].text, peak, 0};
    }
    qsort(bands, count, sizeof *bands, by_peak);
    return count < OTHERS ? count : OTHERS;
}

/* A term keeps its colour from the panel before calibration; others take what is free. */
static void choose_colors(const band *before, size_t before_count, band *bands, size_t count)
{
    bool taken[BANDS] = {false}, kept[OTHERS] = {false};
    for (size_t b = 0; b < count; b++)
        for (size_t k = 0; k < before_count; k++)
            if (strcmp(bands[b].label, before[k].label) == 0) {
                bands[b].color = before[k].color;
                kept[b] = taken[bands[b].color] = true;
            }
    for (size_t b = 0; b < count; b++) {
        int color = 0;
        while (!kept[b] && color < OTHERS && taken[color])
            color++;
        if (!kept[b]) {
            bands[b].color = color;
            taken[color] = true;
        }
    }
}

static bool has_shares(const imk_drift_case *one, size_t t)
{
    return is_drawn(&one->figures[t]) && variance(&one->analysis->total[t]) > 0;
}

/* Bands from 0 to 100 %, each on top of the previous ones; the rest, if it is visible, is the last
 * band. */
static void add_bands(const drawing *d, const imk_drift_case *one, const band *bands, size_t count)
{
    double *below = d->below, rest = 0;
    for (size_t t = 0; t < d->count; t++)
        below[t] = has_shares(one, t) ? 0 : (double)NAN;
    for (size_t b = 0; b <= count; b++) {
        const band *of = b < count ? &bands[b] : &(band){.label = "others", .color = OTHERS};
        for (size_t t = d->first; t < d->count && b == count; t++)
            rest = fmax(rest, 100 - below[t]);
        if (b == count && !(rest > 0.5))
            break;
        imki_begin_curve(d->figure, of->label, IMK_CURVE_LAYER, of->color);
        for (size_t t = d->first; t < d->count; t++) {
            const double above =
                b < count ? below[t] + 100 * imki_drift_share_at(one->analysis, of->source, t)
                          : below[t] + (100 - below[t]);
            imk_figure_bar(d->figure, d->time[t], above, below[t], above);
            below[t] = above;
        }
    }
}

static void show_shares(const drawing *d)
{
    const imk_drift_models *r = d->of;
    const char *const when[] = {", before calibration", ", after calibration"};
    band bands[2][IMK_DRIFT_SOURCES_MAX];
    size_t count[2] = {0};
    for (size_t c = 0; c < r->case_count; c++) {
        const imk_drift_case *one = &r->cases[c];
        char title[60];
        count[c] = rank_sources(one->analysis, bands[c]);
        choose_colors(bands[0], c > 0 ? count[0] : 0, bands[c], count[c]);
        snprintf(title, sizeof title, "Shares of the horizontal variance%s",
                 r->case_count == 1 ? "" : when[c]);
        begin_panel(d, title, "share [%]", IMK_KEY_BELOW, false);
        add_bands(d, one, bands[c], count[c]);
    }
}

/* ---- all ---- */

/* The largest distance that is drawn; it decides between metres and kilometres. */
static double largest(const imk_drift_models *r)
{
    double most = 0;
    for (size_t c = 0; c < r->case_count; c++)
        for (size_t t = 0; t < r->times->count; t++)
            if (is_drawn(&r->cases[c].figures[t]))
                most = fmax(most, r->cases[c].figures[t].cep);
    for (size_t k = 0; r->found && k < r->times->row_count; k++)
        if (isfinite(r->found[k].cep))
            most = fmax(most, r->found[k].cep);
    return most;
}

/* Of one model, where there are any. */
static bool any_shares(const imk_drift_models *r)
{
    for (size_t t = 0; t < r->times->count && r->model_count == 1; t++)
        if (has_shares(&r->cases[0], t))
            return true;
    return false;
}

/* Where the time begins: at 0, or where the aids end if there is more behind that. */
static double origin_of(const imk_drift_models *r, size_t *first)
{
    const double outage = imk_drift_outage(&r->settings.drift);
    *first = 0;
    while (*first < r->times->count && r->times->time[*first] <= outage)
        (*first)++;
    if (*first > 0 && *first < r->times->count)
        return outage;
    *first = 0;
    return 0.0;
}

static const char *time_label(double last, bool without)
{
    static const char *const labels[2][3] = {{"time [s]", "time [min]", "time [h]"},
                                             {"outage [s]", "outage [min]", "outage [h]"}};
    return labels[without][last >= 7200 ? 2 : last >= 120 ? 1 : 0];
}

void imki_drift_show_figure(const imk_drift_models *r, bool shares, imk_result *result)
{
    const size_t count = r->times->count;
    size_t first = 0;
    const double origin = origin_of(r, &first), last = r->times->time[count - 1] - origin;
    const bool any = any_shares(r);
    drawing d = {.of = r,
                 .time_label = time_label(last, first > 0),
                 .unit = last >= 7200  ? 3600
                         : last >= 120 ? 60
                                       : 1,
                 .length = largest(r) >= 2000 ? 1000 : 1,
                 .first = first,
                 .count = count,
                 .time =
                     result ? imki_arena_take(&result->arena, 2 * count * sizeof *d.time) : NULL};
    if (!d.time)
        return;
    d.below = d.time + count;
    for (size_t t = 0; t < count; t++)
        d.time[t] = (r->times->time[t] - origin) / d.unit;
    d.figure = imk_result_figure(
        result, r->model_count > 1 ? "Comparison" : r->name[0], any ? 1 + r->case_count : 1,
        "CEP is the radius of the circle that holds half of all outcomes, R95 that of 95 %. Shares "
        "refer to the variance: a term with 25 % causes half as much error as all terms together.");
    show_growth(&d);
    if (shares && any)
        show_shares(&d);
}
