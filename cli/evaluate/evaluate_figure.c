/* SPDX-License-Identifier: Apache-2.0 */
/* Deviations of the mean readings from both lines, rising and falling apart, and the loop they
 * make. */
#include "evaluate_parts.h"

#include "imukit/figure_file.h"

#include <math.h>
#include <stdlib.h>

enum { CURVES = 6, ARRAYS = 12 };

typedef struct channel_figure {
    imk_panel panel[2];
    size_t panels;
    imk_curve curve[2][CURVES];
    char y_label[2][100], x_label[100], title[2][100];
    double *memory;
} channel_figure;

static imk_curve curve_of(const char *label, imk_curve_style style, int color, size_t count,
                          const double *x, const double *y)
{
    return (imk_curve){
        .label = label, .style = style, .color = color, .count = count, .x = x, .y = y};
}

/* Levels with a mean of this direction: reference, deviation from the least-squares line. */
static size_t side_points(const evaluate_channel *c, bool up, double *x, double *y)
{
    const imk_evaluation_line *line = &c->result.line;
    size_t count = 0;
    for (size_t k = 0; k < c->result.levels; k++) {
        const imk_evaluation_level *l = &c->level[k];
        const double mean = up ? l->up : l->down;
        if (!isfinite(mean))
            continue;
        x[count] = l->reference / c->reference_unit.scale;
        y[count++] = (mean - line->zero - line->sensitivity * l->reference) / c->reading_unit.scale;
    }
    return count;
}

/* The mean of both with its interval, and the minimax line with its strip. */
static size_t mean_curves(const evaluate_channel *c, double *m, imk_curve *curve)
{
    const imk_evaluation *r = &c->result;
    const size_t n = r->levels;
    double *x = m, *y = m + n, *low = m + 2 * n, *high = m + 3 * n, *best = m + 4 * n;
    double *above = m + 5 * n, *below = m + 6 * n;
    const double scale = c->reading_unit.scale;
    for (size_t k = 0; k < n; k++) {
        const imk_evaluation_level *l = &c->level[k];
        const double off = r->best.zero - r->line.zero +
                           (r->best.sensitivity - r->line.sensitivity) * l->reference;
        x[k] = l->reference / c->reference_unit.scale;
        y[k] = l->deviation / scale;
        low[k] = (l->deviation - 2 * l->sigma) / scale;
        high[k] = (l->deviation + 2 * l->sigma) / scale;
        best[k] = off / scale;
        above[k] = (off + r->best.deviation) / scale;
        below[k] = (off - r->best.deviation) / scale;
    }
    curve[0] = curve_of("strip of the best line", IMK_CURVE_BAND, 5, n, x, best);
    curve[0].lower = below;
    curve[0].upper = above;
    curve[1] = curve_of("best line", IMK_CURVE_DASHES, 1, n, x, best);
    curve[2] = curve_of("mean reading, 2 sigma", IMK_CURVE_POINTS, 0, n, x, y);
    curve[2].lower = low;
    curve[2].upper = high;
    return 3;
}

static void make(const evaluate_channel *c, channel_figure *f)
{
    const size_t n = c->result.levels;
    f->memory = command_memory(NULL, (n > 0 ? n : 1) * ARRAYS * sizeof *f->memory);
    f->panels = 0;
    snprintf(f->x_label, sizeof f->x_label, "reference [%s]", c->reference_unit.text);
    const size_t means = mean_curves(c, f->memory, f->curve[0]);
    snprintf(f->title[0], sizeof f->title[0], "%s: off the least-squares line", c->name);
    snprintf(f->y_label[0], sizeof f->y_label[0], "deviation [%s]", c->reading_unit.text);
    f->panel[f->panels++] = (imk_panel){.title = f->title[0],
                                        .x_label = f->x_label,
                                        .y_label = f->y_label[0],
                                        .curve_count = means,
                                        .curves = f->curve[0],
                                        .key = IMK_KEY_BELOW};
    if (c->result.hysteresis_level < 0)
        return;
    double *m = f->memory + 7 * n;
    const size_t ups = side_points(c, true, m, m + n);
    const size_t downs = side_points(c, false, m + 2 * n, m + 3 * n);
    f->curve[1][0] = curve_of("rising", IMK_CURVE_LINE, 2, ups, m, m + n);
    f->curve[1][1] = curve_of("falling", IMK_CURVE_LINE, 1, downs, m + 2 * n, m + 3 * n);
    f->curve[1][2] = curve_of("", IMK_CURVE_POINTS, 2, ups, m, m + n);
    f->curve[1][3] = curve_of("", IMK_CURVE_POINTS, 1, downs, m + 2 * n, m + 3 * n);
    snprintf(f->title[1], sizeof f->title[1], "%s: hysteresis", c->name);
    f->panel[f->panels++] = (imk_panel){.title = f->title[1],
                                        .x_label = f->x_label,
                                        .y_label = f->y_label[0],
                                        .curve_count = 4,
                                        .curves = f->curve[1],
                                        .key = IMK_KEY_BELOW};
}

/* A single panel keeps its own width; two stand side by side. */
static imk_figure figure_of(const imk_panel *panel, size_t panels, size_t columns)
{
    return (imk_figure){.title = "", .panel_count = panels, .columns = columns, .panels = panel};
}

int evaluate_draw(const evaluation *v, const char *path)
{
    imk_error error;
    imk_panel panel[2 * EVALUATE_CHANNELS];
    size_t panels = 0;
    channel_figure *f = command_memory(NULL, EVALUATE_CHANNELS * sizeof *f);
    imk_status status;
    bool two = false;
    for (size_t k = 0; k < v->channel_count; k++) {
        make(&v->channel[k], &f[k]);
        for (size_t p = 0; p < f[k].panels; p++)
            panel[panels++] = f[k].panel[p];
        two = two || f[k].panels > 1;
    }
    if (panels == 0) {
        status = imk_error_set(&error, IMK_ERROR_EMPTY, "plot", NULL,
                               "a table or a log with a reference");
    } else {
        const imk_figure figure = figure_of(panel, panels, two && panels > 1 ? 2 : 1);
        status = imk_figure_write(&figure, path, &error);
    }
    for (size_t k = 0; k < v->channel_count; k++)
        free(f[k].memory);
    free(f);
    return status == IMK_OK ? -1 : command_error(&error, NULL);
}

void evaluate_put_figure(const evaluate_channel *channel, imk_page *page)
{
    channel_figure f = {.panels = 0};
    if (channel->result.levels > 1) {
        make(channel, &f);
        const imk_figure figure = figure_of(f.panel, f.panels, f.panels);
        imk_page_figure(page, &figure,
                        "Mean readings of each level less the least-squares line. Dashes: the best "
                        "line; tinted: the narrowest strip that holds all means. Rising and "
                        "falling: the mean readings of each direction.");
    }
    free(f.memory);
}
