/* SPDX-License-Identifier: Apache-2.0 */
/* The outputs of a run against time. A few points far from all others, such as those before an
 * instrument has settled, would make a flat line of the rest: the axis leaves them out, marks stand
 * at its edge, and a note says where they are. */
#include "jobs/physics/physics_log_internal.h"
#include "physics_show_internal.h"
#include "report/show/show_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* At each end, this part of the points may be left out, if the others then span less than a quarter
 * of the axis. Normal noise spans less than twice what 98 % of it do, and a sine no more. */
static const double part = 0.01, narrower = 4;

/* What the axis of an output shows; empty: all of it. */
typedef struct window {
    double low, high;
} window;

static int by_size(const void *a, const void *b)
{
    const double *x = a, *y = b;
    return (*x > *y) - (*x < *y);
}

/* The values that are not further from most of them than these are from one another, with some
 * air. */
static window window_of(const double *sorted, size_t count)
{
    const size_t left = (size_t)ceil(part * (double)count);
    const double most = sorted[count - 1 - left] - sorted[left];
    size_t first = left, last = count - 1 - left;
    if (!(most > 0) || sorted[count - 1] - sorted[0] <= narrower * most)
        return (window){0, 0};
    while (first > 0 && sorted[first - 1] >= sorted[left] - most)
        first--;
    while (last + 1 < count && sorted[last + 1] <= sorted[count - 1 - left] + most)
        last++;
    const double air = 0.07 * (sorted[last] - sorted[first]);
    return (window){sorted[first] - air, sorted[last] + air};
}

/* For the means and the bands about them. The input, which is drawn with the first output, is shown
 * wholly. */
static window find_window(const imk_physics_log *run, size_t output)
{
    enum { LEAST = 50 };
    window found = {0, 0};
    double *sorted = run->points >= LEAST ? malloc(3 * run->points * sizeof *sorted) : NULL;
    if (!sorted)
        return found;
    for (size_t k = 0; k < run->points; k++) {
        sorted[3 * k] = run->curve[output][k];
        sorted[3 * k + 1] = run->least[output][k];
        sorted[3 * k + 2] = run->greatest[output][k];
    }
    qsort(sorted, 3 * run->points, sizeof *sorted, by_size);
    found = window_of(sorted, 3 * run->points);
    free(sorted);
    for (size_t k = 0; k < run->points && output == 0 && found.low < found.high; k++) {
        found.low = fmin(found.low, run->input[k]);
        found.high = fmax(found.high, run->input[k]);
    }
    return found;
}

/* ---- points outside -------------------------------------------------------------------------- */

static bool is_outside(const window *w, double value)
{
    return w->low < w->high && (value < w->low || value > w->high);
}

static void write_note(const imk_physics_log *run, size_t output, const window *w, const char *unit,
                       size_t size, char *note)
{
    size_t count = 0, first = 0, last = 0, furthest = 0;
    const double *y = run->curve[output], middle = 0.5 * (w->low + w->high);
    for (size_t k = 0; k < run->points; k++) {
        if (!is_outside(w, y[k]))
            continue;
        first = count == 0 ? k : first;
        last = k;
        furthest = count == 0 || fabs(y[k] - middle) > fabs(y[furthest] - middle) ? k : furthest;
        count++;
    }
    if (count == 1)
        snprintf(note, size, "1 of %zu points is beyond the axis (diamond):\n%.3g %s at %.3g s.",
                 run->points, y[first], unit, run->time[first]);
    else if (count > 1)
        snprintf(note, size,
                 "%zu of %zu points are beyond the axis (diamonds):\n"
                 "from %.3g to %.3g s, the furthest %.3g %s.",
                 count, run->points, run->time[first], run->time[last], y[furthest], unit);
}

static void add_marks(const imk_physics_log *run, size_t output, const window *w, const double *x,
                      imk_figure_builder *figure)
{
    const double *y = run->curve[output];
    const double inset = 0.02 * (w->high - w->low); /* the whole mark is seen */
    bool begun = false;
    for (size_t k = 0; k < run->points; k++) {
        if (!is_outside(w, y[k]))
            continue;
        if (!begun)
            imki_begin_curve(figure, "", IMK_CURVE_MARKS, 0);
        begun = true;
        imk_figure_point(figure, x[k], y[k] < w->low ? w->low + inset : w->high - inset);
    }
}

/* ---- panels ---------------------------------------------------------------------------------- */

static void add_curves(const imk_physics_log *run, size_t output, const double *x,
                       imk_curve_style style, const window *w, imk_figure_builder *figure)
{
    imk_curve curve = {"", IMK_CURVE_BAND, 0, run->points, x, run->curve[output], NULL, NULL};
    if (run->stride > 1 && style == IMK_CURVE_LINE) {
        curve.lower = run->least[output];
        curve.upper = run->greatest[output];
        imk_figure_curve(figure, &curve, 1);
        curve.lower = curve.upper = NULL;
    }
    curve.style = style;
    curve.label = output == 0 ? "output" : "";
    imk_figure_curve(figure, &curve, 1);
    if (output == 0) {
        curve = (imk_curve){"input", IMK_CURVE_DASHES, 1, run->points, x, run->input, NULL, NULL};
        imk_figure_curve(figure, &curve, 1);
    }
    add_marks(run, output, w, x, figure);
}

static void add_output(const imk_physics_log *run, size_t output, imk_figure_builder *figure)
{
    const imk_signal *signal = &run->settings.instrument->outputs[output];
    const imk_unit unit = imk_physics_output_unit(run, output);
    const window w = find_window(run, output);
    char x[IMK_PHYSICS_LABEL], y[IMK_PHYSICS_LABEL], title[IMK_PHYSICS_LABEL + 200], note[200] = "";
    snprintf(title, sizeof title, "%s: %.190s", imki_physics_label(x, signal->name, "1"),
             signal->help);
    write_note(run, output, &w, unit.text, sizeof note, note);
    const imk_panel panel = {.title = title,
                             .x_label = "time [s]",
                             .y_label = imki_physics_label(y, signal->name, unit.text),
                             .y_low = w.low,
                             .y_high = w.high,
                             .note = note};
    imk_figure_panel(figure, &panel);
    add_curves(run, output, run->time, IMK_CURVE_LINE, &w, figure);
}

/* Output 0 against the input: a response curve with its dead band if the sine is slow, an ellipse
 * if the instrument lags behind. */
static void add_response(const imk_physics_log *run, imk_figure_builder *figure)
{
    char x[IMK_PHYSICS_LABEL], y[IMK_PHYSICS_LABEL];
    const char *unit = imk_physics_output_unit(run, 0).text;
    const window w = find_window(run, 0);
    const imk_panel panel = {.title = "Output against input",
                             .x_label = imki_physics_label(x, "input", unit),
                             .y_label = imki_physics_label(y, "output", unit),
                             .y_low = w.low,
                             .y_high = w.high};
    imk_figure_panel(figure, &panel);
    add_curves(run, 0, run->input, IMK_CURVE_POINTS, &w, figure);
}

void imki_show_physics_run(const imk_physics_shown *p, imk_result *result)
{
    const imk_physics_log *run = p->run;
    char caption[200] = "Each point is a sample: the mean since the previous one.";
    if (run->stride > 1)
        snprintf(
            caption, sizeof caption,
            "Each point is the mean of %llu samples; the tinted band reaches from the least of "
            "them to the greatest.",
            (unsigned long long)run->stride);
    imk_figure_builder *figure = imk_result_figure(result, imki_physics_name(p), 2, caption);
    for (size_t i = 0; i < run->settings.instrument->output_count; i++)
        add_output(run, i, figure);
    if (run->settings.input.frequency > 0)
        add_response(run, figure);
}
