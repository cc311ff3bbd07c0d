/* SPDX-License-Identifier: Apache-2.0 */
/* Deviations of the mean readings from both lines, rising and falling apart, and the loop they
 * make. */
#include "show_internal.h"

#include <math.h>
#include <stdio.h>

static void begin_panel(const imk_evaluate_channel *c, const char *what, imk_figure_builder *figure)
{
    char title[100], x_label[100], y_label[100];
    snprintf(title, sizeof title, "%s: %s", c->name, what);
    snprintf(x_label, sizeof x_label, "reference [%s]", c->reference_unit.text);
    snprintf(y_label, sizeof y_label, "deviation [%s]", c->reading_unit.text);
    imk_figure_panel(
        figure,
        &(imk_panel){.title = title, .x_label = x_label, .y_label = y_label, .key = IMK_KEY_BELOW});
}

/* The minimax line with its strip, and the mean of both directions with its interval. */
static void show_means(const imk_evaluate_channel *c, imk_figure_builder *figure)
{
    static const char *const labels[] = {"strip of the best line", "best line",
                                         "mean reading, 2 sigma"};
    static const imk_curve_style styles[] = {IMK_CURVE_BAND, IMK_CURVE_DASHES, IMK_CURVE_POINTS};
    static const int colors[] = {5, 1, 0};
    const imk_evaluation *r = &c->result;
    const double scale = c->reading_unit.scale;
    for (int curve = 0; curve < 3; curve++) {
        imki_begin_curve(figure, labels[curve], styles[curve], colors[curve]);
        for (size_t k = 0; k < r->levels; k++) {
            const imk_evaluation_level *l = &c->level[k];
            const double x = l->reference / c->reference_unit.scale;
            const double off = r->best.zero - r->line.zero +
                               (r->best.sensitivity - r->line.sensitivity) * l->reference;
            const double y = curve == 2 ? l->deviation : off;
            const double half = curve == 2 ? 2 * l->sigma : r->best.deviation;
            if (curve == 1)
                imk_figure_point(figure, x, y / scale);
            else
                imk_figure_bar(figure, x, y / scale, (y - half) / scale, (y + half) / scale);
        }
    }
}

/* Levels with a mean of one direction: deviation from the least-squares line. */
static void show_side(const imk_evaluate_channel *c, bool up, const char *label,
                      imk_curve_style style, imk_figure_builder *figure)
{
    const imk_evaluation_line *line = &c->result.line;
    imki_begin_curve(figure, label, style, up ? 2 : 1);
    for (size_t k = 0; k < c->result.levels; k++) {
        const imk_evaluation_level *l = &c->level[k];
        const double mean = up ? l->up : l->down;
        if (isfinite(mean))
            imk_figure_point(figure, l->reference / c->reference_unit.scale,
                             (mean - line->zero - line->sensitivity * l->reference) /
                                 c->reading_unit.scale);
    }
}

void imki_show_evaluate_panels(const imk_evaluate_channel *c, imk_figure_builder *figure)
{
    begin_panel(c, "off the least-squares line", figure);
    show_means(c, figure);
    if (c->result.hysteresis_level < 0)
        return;
    begin_panel(c, "hysteresis", figure);
    show_side(c, true, "rising", IMK_CURVE_LINE, figure);
    show_side(c, false, "falling", IMK_CURVE_LINE, figure);
    show_side(c, true, "", IMK_CURVE_POINTS, figure);
    show_side(c, false, "", IMK_CURVE_POINTS, figure);
}
