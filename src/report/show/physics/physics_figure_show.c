/* SPDX-License-Identifier: Apache-2.0 */
/* Pictures: the outputs of a run against time, the views of an instrument (also animated), and the
 * results of a laboratory. */
#include "jobs/physics/physics_log_internal.h"
#include "physics_show_internal.h"

#include <stdio.h>

static void begin_panel(imk_figure_builder *figure, const char *title, const char *x, const char *y,
                        const char *unit)
{
    char x_label[IMK_PHYSICS_LABEL], y_label[IMK_PHYSICS_LABEL];
    const imk_panel panel = {.title = title,
                             .x_label = imki_physics_label(x_label, x, unit),
                             .y_label = imki_physics_label(y_label, y, unit)};
    imk_figure_panel(figure, &panel);
}

/* ---- a run ----------------------------------------------------------------------------------- */

static void add_curves(const imk_physics_log *run, const double *x, const double *output,
                       imk_curve_style style, bool with_input, imk_figure_builder *figure)
{
    imk_curve curve = {with_input ? "output" : "", style, 0, run->points, x, output, NULL, NULL};
    imk_figure_curve(figure, &curve, 1);
    if (with_input) {
        curve = (imk_curve){"input", IMK_CURVE_DASHES, 1, run->points, x, run->input, NULL, NULL};
        imk_figure_curve(figure, &curve, 1);
    }
}

/* Output 0 against the input: a response curve with its dead band if the sine is slow, an ellipse
 * if the instrument lags behind. */
void imki_show_physics_run(const imk_physics_shown *p, imk_result *result)
{
    const imk_physics_log *run = p->run;
    const imk_instrument *instrument = run->settings.instrument;
    char x[IMK_PHYSICS_LABEL], y[IMK_PHYSICS_LABEL], title[IMK_PHYSICS_LABEL + 200];
    imk_figure_builder *figure = imk_result_figure(
        result, imki_physics_name(p), 2,
        run->stride > 1 ? "Each point is the mean of several samples."
                        : "Each point is a sample: the mean since the previous one.");
    for (size_t i = 0; i < instrument->output_count; i++) {
        const imk_signal *signal = &instrument->outputs[i];
        snprintf(title, sizeof title, "%s: %.190s", imki_physics_label(x, signal->name, "1"),
                 signal->help);
        const imk_panel panel = {
            .title = title,
            .x_label = "time [s]",
            .y_label = imki_physics_label(y, signal->name, imk_physics_output_unit(run, i).text)};
        imk_figure_panel(figure, &panel);
        add_curves(run, run->time, run->curve[i], IMK_CURVE_LINE, i == 0, figure);
    }
    if (run->settings.input.frequency > 0) {
        begin_panel(figure, "Output against input", "input", "output",
                    imk_physics_output_unit(run, 0).text);
        add_curves(run, run->input, run->curve[0], IMK_CURVE_POINTS, true, figure);
    }
}

/* ---- views ----------------------------------------------------------------------------------- */

void imk_show_physics_panel(const imk_physics_view *v, imk_figure_builder *figure)
{
    const imk_view *view = &v->view;
    char name[IMK_PHYSICS_LABEL];
    const imk_panel panel = {.title = view->title, .x_label = v->x_label, .y_label = v->y_label};
    imk_figure_panel(figure, &panel);
    for (int c = 0; c < view->curve_count; c++) {
        const char *signal = v->instrument->signals[view->y[c]].name;
        const imk_curve curve = {
            .label = view->curve_count > 1 ? imki_physics_label(name, signal, "1") : "",
            .style = view->points ? IMK_CURVE_POINTS : IMK_CURVE_LINE,
            .color = c,
            .count = v->points,
            .x = v->data,
            .y = v->data + (size_t)(c + 1) * v->points};
        imk_figure_curve(figure, &curve, 1);
    }
}

imk_animation imk_physics_animation(const imk_physics_view *v)
{
    return (imk_animation){.title = v->view.title,
                           .x_label = v->x_label,
                           .y_label = v->y_label,
                           .count = v->points,
                           .x = v->data,
                           .y = v->data + v->points,
                           .points = v->view.points,
                           .duration = 12, /* slow enough to follow with the eye [s] */
                           .clock = v->clock};
}

void imk_show_physics_view(const imk_physics_view *v, imk_result *result)
{
    if (v->empty)
        return;
    if (imk_physics_view_moves(&v->view)) {
        const imk_animation animation = imk_physics_animation(v);
        imk_result_animation(result, &animation, v->view.caption);
    } else {
        imk_show_physics_panel(v, imk_result_figure(result, "", 1, v->view.caption));
    }
}

/* ---- laboratory ------------------------------------------------------------------------------ */

/* Distance from the straight line through zero of the computed scale, in parts of full scale. */
static void add_table(const imk_laboratory_result *r, bool gyro, imk_figure_builder *figure)
{
    const char *unit = gyro ? "deg/s" : "m/s^2";
    const double scale = imk_unit_of(unit).scale;
    begin_panel(figure, gyro ? "Rate table" : "Static response", "input", "output - input", unit);
    imk_figure_curve(figure, &(imk_curve){.label = "", .style = IMK_CURVE_POINTS}, 1);
    for (int i = 0; i < r->point_count; i++) {
        const imk_laboratory_point *at = &r->point[i];
        const double error = (at->output - at->input) / scale, spread = 2 * at->sigma / scale;
        imk_figure_bar(figure, at->input / scale, error, error - spread, error + spread);
    }
}

static void add_response(const imk_laboratory_result *r, imk_figure_builder *figure)
{
    const imk_panel panel = {.title = "Frequency response",
                             .x_label = "frequency [Hz]",
                             .y_label = "gain",
                             .x_logarithmic = true,
                             .y_logarithmic = true};
    imk_figure_panel(figure, &panel);
    imk_figure_curve(figure, &(imk_curve){.label = "", .style = IMK_CURVE_POINTS}, 1);
    for (int i = 0; i < r->response_count; i++)
        imk_figure_point(figure, r->response[i].frequency, r->response[i].gain);
}

void imki_show_sweep_figure(const imk_physics_shown *p, imk_result *result)
{
    const imk_laboratory_result *r = &p->sweep->result;
    const imk_instrument *instrument = p->settings->instrument;
    if (r->point_count == 0 && r->response_count == 0)
        return;
    imk_figure_builder *figure =
        imk_result_figure(result, instrument->title, 2,
                          "The rate table shows output minus input, with bars of two standard "
                          "deviations; the response is the gain for a sine.");
    if (r->point_count > 0)
        add_table(r, instrument->sensor == IMK_GYRO, figure);
    if (r->response_count > 0)
        add_response(r, figure);
}
