/* SPDX-License-Identifier: Apache-2.0 */
/* Drift as a picture: how the error grows, and which term makes how much of it at which time. */
#include "drift_figure.h"

#include "imukit/figure_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static double *cut(double **rest, size_t count)
{
    double *start = *rest;
    *rest += count;
    return start;
}

/* Hours for long times, else minutes or seconds. */
static double unit_of_time(double last, const char **label)
{
    *label = last >= 7200 ? "time [h]" : last >= 120 ? "time [min]" : "time [s]";
    return last >= 7200 ? 3600 : last >= 120 ? 60 : 1;
}

/* ---- growth ---- */

static bool is_drawn(const imk_drift_figures *f)
{
    return drift_validity_of(f) != DRIFT_LOST;
}

static void add_line(drift_figure *d, const char *label, int color, imk_curve_style style,
                     const double *y)
{
    d->growth[d->growth_count++] =
        (imk_curve){label, style, color, d->times, d->time, y, NULL, NULL};
}

/* CEP of each case; of one case also R95. */
static void add_growth(drift_figure *d, const drift_result *r, double **rest)
{
    for (size_t c = 0; c < r->case_count; c++) {
        const drift_case *one = &r->cases[c];
        double *cep = cut(rest, d->times), *r95 = cut(rest, d->times);
        for (size_t t = 0; t < d->times; t++) {
            const bool drawn = is_drawn(&one->figures[t]);
            cep[t] = drawn ? one->figures[t].cep / d->length : (double)NAN;
            r95[t] = drawn ? one->figures[t].r95 / d->length : (double)NAN;
        }
        const bool single = r->case_count == 1;
        add_line(d, single ? "CEP: half are within" : one->label, (int)c, IMK_CURVE_LINE, cep);
        if (single)
            add_line(d, "R95: 95 % are within", 1, IMK_CURVE_LINE, r95);
    }
}

/* Points with their intervals. */
static void add_runs(drift_figure *d, const drift_result *r, double **rest)
{
    const size_t rows = r->scene->row_count;
    double *time = cut(rest, rows);
    for (size_t k = 0; k < rows; k++)
        time[k] = r->scene->time[r->scene->row[k]] / d->unit;
    for (int which = 0; which < 2; which++) {
        double *value[3] = {cut(rest, rows), cut(rest, rows), cut(rest, rows)};
        const imk_drift_figures *of[3] = {r->found, r->low, r->high};
        for (size_t k = 0; k < rows; k++) {
            for (int i = 0; i < 3; i++)
                value[i][k] = (which == 0 ? of[i][k].cep : of[i][k].r95) / d->length;
            if (!isfinite(value[2][k])) /* too few runs for an upper limit */
                value[2][k] = value[0][k];
        }
        d->growth[d->growth_count++] =
            (imk_curve){which == 0 ? "CEP of the runs" : "R95 of the runs",
                        IMK_CURVE_POINTS,
                        which == 0 ? 2 : 4,
                        rows,
                        time,
                        value[0],
                        value[1],
                        value[2]};
    }
}

/* ---- shares ---- */

static const char others[] = "others";

typedef struct ranking {
    size_t source;
    double peak; /* its largest share at any time */
} ranking;

static int by_peak(const void *a, const void *b)
{
    const ranking *x = a, *y = b;
    return (x->peak < y->peak) - (x->peak > y->peak);
}

static double variance(const imk_drift_moments *m)
{
    return m->covariance[0][0] + m->covariance[1][1];
}

static double share_at(const imk_drift_analysis *a, size_t source, size_t t)
{
    const double total = variance(&a->total[t]);
    return total > 0 ? variance(&a->contribution[source * a->time_count + t]) / total : 0;
}

/* @return how many terms have a band of their own */
static size_t rank_sources(const imk_drift_analysis *a, ranking *rank)
{
    const double visible = 0.01;
    size_t count = 0;
    for (size_t k = 0; k < a->source_count; k++) {
        double peak = 0;
        for (size_t t = 0; t < a->time_count; t++)
            peak = fmax(peak, share_at(a, k, t));
        if (peak >= visible)
            rank[count++] = (ranking){k, peak};
    }
    qsort(rank, count, sizeof *rank, by_peak);
    return count < DRIFT_BANDS - 1 ? count : DRIFT_BANDS - 1;
}

/* A term keeps its colour from the panel before calibration; others take what is free. */
static void choose_colors(const imk_curve *before, size_t before_count, imk_curve *curve,
                          size_t count)
{
    bool taken[DRIFT_BANDS] = {false}, kept[DRIFT_BANDS] = {false};
    for (size_t b = 0; b < count; b++) {
        for (size_t k = 0; k < before_count; k++) {
            if (strcmp(curve[b].label, before[k].label) != 0)
                continue;
            curve[b].color = before[k].color;
            kept[b] = true;
        }
        if (kept[b])
            taken[curve[b].color] = true;
    }
    for (size_t b = 0; b < count; b++) {
        int color = 0;
        while (!kept[b] && color < DRIFT_BANDS - 1 && taken[color])
            color++;
        if (!kept[b] && strcmp(curve[b].label, others) != 0) {
            curve[b].color = color;
            taken[color] = true;
        }
    }
}

/* Bands from 0 to 100 %, each on the ones before; the rest is the last. */
static size_t add_shares(drift_figure *d, const drift_case *one, imk_curve *curve, double **rest)
{
    const imk_drift_analysis *a = one->analysis;
    ranking rank[IMK_DRIFT_SOURCES_MAX];
    const size_t bands = rank_sources(a, rank);
    double *below = cut(rest, d->times);
    size_t count = 0;
    for (size_t t = 0; t < d->times; t++)
        below[t] = is_drawn(&one->figures[t]) && variance(&a->total[t]) > 0 ? 0 : (double)NAN;
    for (size_t b = 0; b <= bands; b++) {
        double *above = cut(rest, d->times), most = 0;
        for (size_t t = 0; t < d->times; t++) {
            above[t] = b < bands ? below[t] + 100 * share_at(a, rank[b].source, t)
                                 : below[t] + (100 - below[t]);
            most = above[t] - below[t] > most ? above[t] - below[t] : most;
        }
        if (b < bands || most > 0.5)
            curve[count++] = (imk_curve){b < bands ? a->source[rank[b].source].text : others,
                                         IMK_CURVE_LAYER,
                                         b < bands ? (int)b : DRIFT_BANDS - 1,
                                         d->times,
                                         d->time,
                                         above,
                                         below,
                                         above};
        below = above;
    }
    return count;
}

/* ---- all ---- */

static void add_share_panels(drift_figure *d, const drift_result *r, double **rest)
{
    const size_t cases = r->model_count == 1 ? r->case_count : 0;
    size_t first = 0; /* bands of the first panel */
    for (size_t c = 0; c < cases; c++) {
        const size_t curves = add_shares(d, &r->cases[c], d->share[c], rest);
        if (c > 0)
            choose_colors(d->share[0], first, d->share[c], curves);
        else
            first = curves;
        snprintf(d->share_title[c], sizeof d->share_title[c], "Shares of the horizontal variance%s",
                 cases == 1 ? ""
                 : c == 0   ? ", before calibration"
                            : ", after calibration");
        if (curves > 0)
            d->panel[d->figure.panel_count++] = (imk_panel){.title = d->share_title[c],
                                                            .x_label = d->time_label,
                                                            .y_label = "share [%]",
                                                            .x_logarithmic = true,
                                                            .curve_count = curves,
                                                            .curves = d->share[c],
                                                            .key = IMK_KEY_BELOW};
    }
}

/* The largest distance that is drawn: kilometres when they are some. */
static double largest(const drift_result *r)
{
    double most = 0;
    for (size_t c = 0; c < r->case_count; c++)
        for (size_t t = 0; t < r->scene->time_count; t++)
            if (is_drawn(&r->cases[c].figures[t]))
                most = fmax(most, r->cases[c].figures[t].cep);
    for (size_t k = 0; r->found && k < r->scene->row_count; k++)
        if (isfinite(r->found[k].cep))
            most = fmax(most, r->found[k].cep);
    return most;
}

void drift_figure_make(const drift_result *r, drift_figure *d)
{
    const drift_scene *scene = r->scene;
    *d = (drift_figure){.times = scene->time_count};
    const size_t lines = 1 + r->case_count * (2 + DRIFT_BANDS + 2);
    d->memory = command_memory(NULL, (lines * scene->time_count + 7 * scene->row_count) *
                                         sizeof *d->memory);
    double *rest = d->memory, *time = cut(&rest, scene->time_count);
    d->unit = unit_of_time(scene->time[scene->time_count - 1], &d->time_label);
    d->length = largest(r) >= 2000 ? 1000 : 1;
    for (size_t t = 0; t < scene->time_count; t++)
        time[t] = scene->time[t] / d->unit;
    d->time = time;
    add_growth(d, r, &rest);
    if (r->found)
        add_runs(d, r, &rest);
    d->panel[d->figure.panel_count++] = (imk_panel){
        .title = r->case_count > 1 ? "CEP: half of all outcomes are within" : "Horizontal error",
        .x_label = d->time_label,
        .y_label = d->length > 1 ? "radius [km]" : "radius [m]",
        .x_logarithmic = true,
        .y_logarithmic = true,
        .curve_count = d->growth_count,
        .curves = d->growth,
        .key = IMK_KEY_LOWER};
    add_share_panels(d, r, &rest);
    d->figure.title = r->model_count > 1 ? "Comparison" : r->name[0];
    d->figure.columns = d->figure.panel_count < 3 ? d->figure.panel_count : 3;
    d->figure.panels = d->panel;
}

void drift_figure_free(drift_figure *figure)
{
    free(figure->memory);
}

int drift_draw(const drift_result *r, const char *path)
{
    imk_error error;
    drift_figure *d = command_memory(NULL, sizeof *d);
    drift_figure_make(r, d);
    if (strcmp(path, "term") == 0) /* letters have no shades */
        d->figure.panel_count = 1;
    const imk_status status = imk_figure_write(&d->figure, path, &error);
    drift_figure_free(d);
    free(d);
    return status == IMK_OK ? -1 : command_error(&error, NULL);
}
