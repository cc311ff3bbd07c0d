/* SPDX-License-Identifier: Apache-2.0 */
/* Pictures: the views of an instrument (also animated), and the results of a laboratory. */
#include "jobs/physics/physics_log_internal.h"
#include "physics_show_internal.h"

#include <math.h>
#include <stdio.h>

/* ---- views ----------------------------------------------------------------------------------- */

void imk_show_physics_panel(const imk_physics_view *v, imk_figure_builder *figure)
{
    const imk_view *view = &v->view;
    char name[IMK_PHYSICS_LABEL];
    const imk_panel panel = {.title = view->title, .x_label = v->x_label, .y_label = v->y_label};
    imk_figure_panel(figure, &panel);
    if (v->law_points > 0) {
        const double *x = v->data + (size_t)(view->curve_count + 1) * v->points;
        imk_curve law = {.label = view->law_name,
                         .style = IMK_CURVE_LINE,
                         .color = 7,
                         .count = v->law_points,
                         .x = x,
                         .y = x + v->law_points};
        imk_figure_curve(figure, &law, 1);
        law.label = ""; /* a band without height: the axes span bands, not lines */
        law.style = IMK_CURVE_BAND;
        law.lower = law.upper = law.y;
        imk_figure_curve(figure, &law, 1);
    }
    for (int c = 0; c < view->curve_count; c++) {
        const char *signal = v->instrument->signals[view->y[c]].name;
        const bool named = view->curve_count > 1 || v->law_points > 0;
        const imk_curve curve = {.label = named ? imki_physics_label(name, signal, "1") : "",
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
                           .law_count = v->law_points,
                           .law_x = v->data + 2 * v->points,
                           .law_y = v->data + 2 * v->points + v->law_points,
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

/* A panel is left out where nothing changes by more than the rounding of the arithmetic. */
static const double nothing = 1e-12;

/* Bars of two standard deviations, and then the closed form as a line through the same inputs. */
static void add_measured(imk_figure_builder *figure)
{
    imk_figure_curve(figure, &(imk_curve){.label = "experiment", .style = IMK_CURVE_POINTS}, 1);
}

static void add_computed(imk_figure_builder *figure, imk_curve_style style)
{
    imk_figure_curve(figure, &(imk_curve){.label = "closed form", .style = style, .color = 1}, 1);
}

static void add_bar(imk_figure_builder *figure, double x, double y, double sigma)
{
    imk_figure_bar(figure, x, y, y - 2 * sigma, y + 2 * sigma);
}

/* A unit in which the largest of some values is easily read. */
static imk_unit unit_for(const char *si, double largest)
{
    const imk_unit unit = imk_unit_of(si);
    return largest > 0 ? imk_unit_readable(unit.dimension, largest) : unit;
}

/* What the output has beyond the input and beyond its reading without input. */
static void add_table(const imk_laboratory_result *r, bool gyro, imk_figure_builder *figure)
{
    const double scale = imk_unit_of(gyro ? "deg/s" : "m/s^2").scale;
    char x[IMK_PHYSICS_LABEL], y[IMK_PHYSICS_LABEL];
    double largest = 0;
    for (int i = 0; i < r->point_count; i++)
        largest = fmax(largest, fmax(fabs(r->point[i].error), fabs(r->point[i].computed)));
    const imk_unit unit = unit_for(gyro ? "rad/s" : "m/s^2", largest);
    const imk_panel panel = {
        .title = gyro ? "Rate table" : "Static response",
        .x_label = imki_physics_label(x, "input", gyro ? "deg/s" : "m/s^2"),
        .y_label = imki_physics_label(y, "output - input, less that at 0", unit.text)};
    imk_figure_panel(figure, &panel);
    add_measured(figure);
    for (int i = 0; i < r->point_count; i++)
        add_bar(figure, r->point[i].input / scale, r->point[i].error / unit.scale,
                r->point[i].error_sigma / unit.scale);
    add_computed(figure, IMK_CURVE_LINE);
    for (int i = 0; i < r->point_count; i++)
        imk_figure_point(figure, r->point[i].input / scale, r->point[i].computed / unit.scale);
}

/* Poses by number: the faces +x -x +y -y +z -z, then the edges between x and y, y and z, z and x.
 */
static void add_poses(const imk_laboratory_result *r, bool gyro, imk_figure_builder *figure)
{
    char y[IMK_PHYSICS_LABEL];
    double largest = 0;
    for (int i = 0; i < r->pose_count; i++)
        largest = fmax(largest, fmax(fabs(r->pose[i].error), fabs(r->pose[i].computed)));
    if (largest <= nothing * r->full_scale)
        return;
    const imk_unit unit = unit_for(gyro ? "rad/s" : "m/s^2", largest);
    const imk_panel panel = {.title = "Tumble: 1 g in 18 directions",
                             .x_label = "direction",
                             .y_label = imki_physics_label(
                                 y, gyro ? "change of the output" : "output - input", unit.text)};
    imk_figure_panel(figure, &panel);
    add_measured(figure);
    for (int i = 0; i + 1 < r->pose_count; i++)
        add_bar(figure, i + 1, r->pose[i].error / unit.scale, r->pose[i].sigma / unit.scale);
    add_computed(figure, IMK_CURVE_DASHES);
    for (int i = 0; i + 1 < r->pose_count; i++)
        imk_figure_point(figure, i + 1, r->pose[i].computed / unit.scale);
}

static void add_warmth(const imk_laboratory_result *r, bool gyro, bool scale_factor,
                       imk_figure_builder *figure)
{
    char y[IMK_PHYSICS_LABEL];
    double largest = 0;
    for (int i = 0; i < r->warmth_count; i++) {
        const imk_laboratory_warmth *w = &r->warmth[i];
        largest = fmax(largest, scale_factor ? fmax(fabs(w->scale), fabs(w->scale_computed))
                                             : fmax(fabs(w->bias), fabs(w->bias_computed)));
    }
    if (largest <= nothing * (scale_factor ? 1 : r->full_scale))
        return;
    const imk_unit unit =
        scale_factor ? imk_unit_of("ppm") : unit_for(gyro ? "rad/s" : "m/s^2", largest);
    const imk_panel panel = {
        .title = scale_factor ? "Scale factor by temperature" : "Bias by temperature",
        .x_label = "temperature [degC]",
        .y_label = imki_physics_label(
            y, scale_factor ? "change of the scale factor" : "change of the bias", unit.text)};
    imk_figure_panel(figure, &panel);
    add_measured(figure);
    for (int i = 0; i < r->warmth_count; i++) {
        const imk_laboratory_warmth *w = &r->warmth[i];
        add_bar(figure, w->temperature - 273.15, (scale_factor ? w->scale : w->bias) / unit.scale,
                (scale_factor ? w->scale_sigma : w->bias_sigma) / unit.scale);
    }
    add_computed(figure, IMK_CURVE_LINE);
    for (int i = 0; i < r->warmth_count; i++) {
        const imk_laboratory_warmth *w = &r->warmth[i];
        imk_figure_point(figure, w->temperature - 273.15,
                         (scale_factor ? w->scale_computed : w->bias_computed) / unit.scale);
    }
}

/* Gain of a low-pass filter of first (damping 0) or second order with this -3 dB bandwidth, as
 * imk_low_pass states it. */
static double low_pass_gain(double bandwidth, double damping, double frequency)
{
    if (!(damping > 0))
        return 1 / hypot(1, frequency / bandwidth);
    const double a = 2 * damping * damping - 1, edge = sqrt(sqrt(a * a + 1) - a);
    const double u = frequency / bandwidth * edge;
    return 1 / hypot(1 - u * u, 2 * damping * u);
}

static void add_response(const imk_physics_sweep *l, imk_figure_builder *figure)
{
    const imk_laboratory_result *r = &l->result;
    const imk_panel panel = {.title = "Frequency response",
                             .x_label = "frequency [Hz]",
                             .y_label = "gain",
                             .x_logarithmic = true,
                             .y_logarithmic = true,
                             .key = IMK_KEY_BELOW};
    imk_figure_panel(figure, &panel);
    add_measured(figure);
    for (int i = 0; i < r->response_count; i++)
        imk_figure_point(figure, r->response[i].frequency, r->response[i].gain);
    if (!(l->gain_bandwidth > 0))
        return;
    add_computed(figure, IMK_CURVE_LINE);
    for (int i = 0; i < 8 * (r->response_count - 1) + 1; i++) {
        const double first = r->response[0].frequency;
        const double ratio = r->response[r->response_count - 1].frequency / first;
        const double f = first * pow(ratio, i / (8.0 * (r->response_count - 1)));
        imk_figure_point(figure, f, low_pass_gain(l->gain_bandwidth, l->gain_damping, f));
    }
}

void imki_show_sweep_figure(const imk_physics_shown *p, imk_result *result)
{
    const imk_laboratory_result *r = &p->sweep->result;
    const imk_instrument *instrument = p->settings->instrument;
    const bool gyro = instrument->sensor == IMK_GYRO;
    if (r->point_count == 0 && r->response_count == 0)
        return;
    imk_figure_builder *figure = imk_result_figure(
        result, instrument->title, 2,
        "What the input, 1 g and the temperature change in the reading, with bars of two standard "
        "deviations, and the gain for a sine. The lines are the closed forms. Directions 1 to 6 "
        "are "
        "+x, -x, +y, -y, +z, -z, then 7 to 10 between x and y, 11 to 14 between y and z, 15 to 18 "
        "between z and x.");
    if (r->point_count > 0)
        add_table(r, gyro, figure);
    if (r->pose_count > 0)
        add_poses(r, gyro, figure);
    if (r->warmth_count > 0) {
        add_warmth(r, gyro, false, figure);
        add_warmth(r, gyro, true, figure);
    }
    if (r->response_count > 1)
        add_response(p->sweep, figure);
}
