/* SPDX-License-Identifier: Apache-2.0 */
/* Consistency of filters as a picture: NEES against time. */
#include "tune_show_internal.h"

static void add_curve(const imk_tune_model *r, imk_filter_answer_kind kind, imk_curve_style style,
                      int color, imk_figure_builder *figure)
{
    const imk_filter_answer *a = &r->tuning->answer[kind];
    if (!a->found)
        return;
    /* The line, and the times that were computed, which also decide what the axes span. */
    for (int points = 0; points < 2; points++) {
        imki_begin_curve(figure, points ? "" : imk_filter_answer_name(kind),
                         points ? IMK_CURVE_POINTS : style, color);
        for (size_t t = 0; t < r->tuning->time_count; t++)
            imk_figure_point(figure, r->tuning->time[t], a->consistency[t].nees);
    }
}

static void add_runs(const imk_tune_model *r, imk_filter_answer_kind kind, int color,
                     imk_figure_builder *figure)
{
    if (!r->found || !r->tuning->answer[kind].found)
        return;
    imki_begin_curve(figure, "runs, 99 %", IMK_CURVE_POINTS, color);
    for (size_t t = 0; t < r->tuning->time_count; t++) {
        const imk_tune_found *found = &r->found[(size_t)kind * r->tuning->time_count + t];
        imk_figure_bar(figure, r->tuning->time[t], found->nees, found->lower, found->upper);
    }
}

void imki_tune_figure(const imk_tune_model *r, imk_result *result)
{
    const double first = r->tuning->time[0], last = r->tuning->time[r->tuning->time_count - 1];
    imk_figure_builder *figure = imk_result_figure(
        result, "Consistency of a filter", 1,
        "NEES over its degrees of freedom of increments, against the time over which they are "
        "integrated. 1 is consistent, more is overconfident; between 0.5 and 2 constant noise "
        "describes the errors.");
    imk_figure_panel(figure, &(imk_panel){.title = r->name,
                                          .x_label = "time of integration [s]",
                                          .y_label = "NEES/9",
                                          .x_logarithmic = true,
                                          .y_logarithmic = true});
    if (first < last)
        imk_figure_region(figure, &(imk_region){.label = "0.5 to 2",
                                                .color = 2,
                                                .x_low = first,
                                                .x_high = last,
                                                .y_low = 0.5,
                                                .y_high = 2.0});
    add_curve(r, IMK_FILTER_STATED, IMK_CURVE_LINE, 1, figure);
    add_curve(r, IMK_FILTER_TENFOLD, IMK_CURVE_DASHES, 1, figure);
    add_curve(r, IMK_FILTER_FIT, IMK_CURVE_LINE, 0, figure);
    add_curve(r, IMK_FILTER_FIT_SCALED, IMK_CURVE_DASHES, 0, figure);
    add_curve(r, IMK_FILTER_SAFE, IMK_CURVE_LINE, 2, figure);
    add_runs(r, IMK_FILTER_FIT, 3, figure);
}
