/* SPDX-License-Identifier: Apache-2.0 */
/* Pictures: the outputs of a run against time, the views of an instrument, still and in motion, and
 * what a laboratory found. */
#include "physics_parts.h"
#include "shell/growing_list.h"

#include "imukit/figure_file.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* More points than this are not seen. */
enum { VIEW_POINTS = 5000 };

/* "beat frequency [kHz]"; pure numbers have no unit. */
static const char *label(char text[PHYSICS_LABEL], const char *name, const char *unit)
{
    if (strcmp(unit, "1") == 0)
        snprintf(text, PHYSICS_LABEL, "%.48s", name);
    else
        snprintf(text, PHYSICS_LABEL, "%.48s [%.40s]", name, unit);
    for (char *c = text; *c && *c != '['; c++)
        if (*c == '_')
            *c = ' ';
    return text;
}

static void begin_panel(imk_figure_builder *figure, const char *title, const char *x, const char *y,
                        const char *unit)
{
    char x_label[PHYSICS_LABEL], y_label[PHYSICS_LABEL];
    const imk_panel panel = {
        .title = title, .x_label = label(x_label, x, unit), .y_label = label(y_label, y, unit)};
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

/* Against the input, output 0 is a curve of response, with its dead band, when the sine is slow, an
 * ellipse when the instrument lags behind. */
void physics_show_run_figure(const physics *p, const imk_physics_log *run, imk_result *result)
{
    const imk_instrument *instrument = p->settings.instrument;
    char x[PHYSICS_LABEL], y[PHYSICS_LABEL], title[PHYSICS_LABEL + 200];
    imk_figure_builder *figure = imk_result_figure(
        result, physics_name(p), 2,
        run->stride > 1 ? "Each point is the mean of several samples."
                        : "Each point is a sample: the mean since the one before.");
    for (size_t i = 0; i < instrument->output_count; i++) {
        const imk_signal *signal = &instrument->outputs[i];
        snprintf(title, sizeof title, "%s: %.190s", label(x, signal->name, "1"), signal->help);
        const imk_panel panel = {.title = title,
                                 .x_label = "time [s]",
                                 .y_label =
                                     label(y, signal->name, imk_physics_output_unit(run, i).text)};
        imk_figure_panel(figure, &panel);
        add_curves(run, run->time, run->curve[i], IMK_CURVE_LINE, i == 0, figure);
    }
    if (p->settings.input.frequency > 0) {
        begin_panel(figure, "Output against input", "input", "output",
                    imk_physics_output_unit(run, 0).text);
        add_curves(run, run->input, run->curve[0], IMK_CURVE_POINTS, true, figure);
    }
}

/* ---- views ----------------------------------------------------------------------------------- */

/* The view's own input, unless another was asked for. */
static imk_physics_input input_of(const physics *p, const imk_view *view)
{
    imk_physics_input input = p->settings.input;
    if (!p->options->rate && !p->options->acceleration) {
        const bool gyro = p->settings.instrument->sensor == IMK_GYRO;
        (gyro ? input.exposure.angular_rate : input.exposure.specific_force)[0] = view->input;
    }
    return input;
}

/* Run the instrument as the view says; rows of x, y … in display units into `data`. */
static int record(const physics *p, const imk_view *view, size_t points, uint64_t stride,
                  double *data)
{
    const imk_instrument *instrument = p->settings.instrument;
    imk_physics_settings settings = p->settings.physics;
    double outputs[IMK_INSTRUMENT_OUTPUTS_MAX], inside[IMK_INSTRUMENT_SIGNALS_MAX];
    void *state;
    const imk_physics_input input = input_of(p, view);
    settings.rate = view->rate;
    int code = physics_start(p, &settings, &state);
    if (code >= 0)
        return code;
    const uint64_t settle = (uint64_t)floor(view->settle * view->rate + 0.5);
    for (uint64_t k = 0; k < settle; k++) {
        const imk_exposure e = imk_physics_input_at(&input, view->rate, k);
        instrument->step(state, &e, outputs);
    }
    for (uint64_t k = 0; k < points * stride; k++) {
        const imk_exposure e = imk_physics_input_at(&input, view->rate, settle + k);
        instrument->step(state, &e, outputs);
        if ((k + 1) % stride != 0)
            continue;
        const size_t row = (size_t)(k / stride);
        instrument->observe(state, inside);
        for (int c = -1; c < view->curve_count; c++) {
            const int signal = c < 0 ? view->x : view->y[c];
            const imk_unit unit = imk_unit_of(signal < 0 ? "s" : instrument->signals[signal].unit);
            const double value = signal < 0 ? (double)(k + 1) / view->rate : inside[signal];
            data[(size_t)(c + 1) * points + row] = (value - unit.offset) / unit.scale;
        }
    }
    free(state);
    return -1;
}

/* The time axis of a short view is in ms or us. @return its unit */
static const char *scale_time(const imk_view *view, size_t points, double *time)
{
    const imk_unit unit = imk_unit_readable(imk_unit_of("s").dimension, view->duration);
    if (unit.scale > 1)
        return "s";
    for (size_t k = 0; k < points; k++)
        time[k] /= unit.scale;
    return unit.scale == 1 ? "s" : unit.scale > 1e-4 ? "ms" : "us";
}

/* "tilt x, tilt y", as far as there is room: else the key says it. */
static void label_view(const imk_instrument *instrument, const char *x_unit, physics_view *v)
{
    const imk_view *view = &v->view;
    const imk_unit unit = imk_unit_readable(imk_unit_of("s").dimension, view->duration);
    growing_list names = {0};
    for (int c = 0; c < view->curve_count; c++)
        list_add_item(&names, "%s", instrument->signals[view->y[c]].name);
    label(v->x_label, view->x < 0 ? "time" : instrument->signals[view->x].name, x_unit);
    label(v->y_label, names.size > 48 ? "" : names.text, instrument->signals[view->y[0]].unit);
    snprintf(v->clock, sizeof v->clock, "a round: %.4g %s", view->duration / unit.scale, unit.text);
    list_free(&names);
}

/* With the duration and rate that were asked for. @return -1 or the exit code; free the data */
static int make_view(const physics *p, size_t index, physics_view *v)
{
    const imk_instrument *instrument = p->settings.instrument;
    imk_view *view = &v->view;
    *v = (physics_view){.view = instrument->views[index]};
    if (!isnan(p->options->view_duration))
        view->duration = p->options->view_duration;
    if (p->options->view && !isnan(p->options->view_rate))
        view->rate = p->options->view_rate;
    const double samples = view->duration * view->rate;
    if (!(samples >= 2 && samples <= 1e9))
        return command_misused("--duration: %g s at %g points per second are %s", view->duration,
                               view->rate, samples >= 2 ? "too many" : "no picture");
    const uint64_t stride = (uint64_t)floor(samples + 0.5) / VIEW_POINTS + 1;
    v->points = (size_t)((uint64_t)floor(samples + 0.5) / stride);
    v->data =
        command_memory(NULL, ((size_t)(view->curve_count + 1) * v->points + 1) * sizeof *v->data);
    const int code = record(p, view, v->points, stride, v->data);
    if (code >= 0) {
        free(v->data);
        return code;
    }
    label_view(
        instrument,
        view->x < 0 ? scale_time(view, v->points, v->data) : instrument->signals[view->x].unit, v);
    return -1;
}

static bool is_constant(size_t count, const double *values)
{
    for (size_t i = 1; i < count; i++)
        if (values[i] != values[0])
            return false;
    return true;
}

/* What the view shows is not in this design, such as the bits of an open loop: the first curve is
 * 0, or no curve moves, or a curve against a signal has no width. */
static bool is_empty(const physics_view *v)
{
    const double *y = v->data + v->points;
    if (v->view.x >= 0 && is_constant(v->points, v->data))
        return true;
    if (y[0] == 0 && is_constant(v->points, y))
        return true;
    for (int c = 0; c < v->view.curve_count; c++)
        if (!is_constant(v->points, y + (size_t)c * v->points))
            return false;
    return true;
}

static void add_panel(const physics *p, const physics_view *v, imk_figure_builder *figure)
{
    const imk_view *view = &v->view;
    char name[PHYSICS_LABEL];
    const imk_panel panel = {.title = view->title, .x_label = v->x_label, .y_label = v->y_label};
    imk_figure_panel(figure, &panel);
    for (int c = 0; c < view->curve_count; c++) {
        const char *signal = p->settings.instrument->signals[view->y[c]].name;
        const imk_curve curve = {.label = view->curve_count > 1 ? label(name, signal, "1") : "",
                                 .style = view->points ? IMK_CURVE_POINTS : IMK_CURVE_LINE,
                                 .color = c,
                                 .count = v->points,
                                 .x = v->data,
                                 .y = v->data + (size_t)(c + 1) * v->points};
        imk_figure_curve(figure, &curve, 1);
    }
}

/* Views whose axes are both signals can move. */
static bool can_move(const imk_view *view)
{
    return view->x >= 0 && view->curve_count == 1;
}

static imk_animation animation_of(const physics_view *v)
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

/* Titles and --view are compared by their letters and digits. */
static bool begins_alike(const char *title, const char *text)
{
    for (;; title++, text++) {
        while (*text && !isalnum((unsigned char)*text))
            text++;
        while (*title && !isalnum((unsigned char)*title))
            title++;
        if (!*text)
            return true;
        if (tolower((unsigned char)*title) != tolower((unsigned char)*text))
            return false;
    }
}

/* The view that --view names. @return -1 or the exit code */
static int find_view(const physics *p, size_t *index)
{
    const imk_instrument *instrument = p->settings.instrument;
    const char *text = p->options->view;
    char *end;
    const unsigned long number = strtoul(text, &end, 10);
    if (instrument->view_count == 0)
        return command_misused("--view %s: the %s has no views", text, instrument->title);
    if (*end == '\0' && number >= 1 && number <= instrument->view_count) {
        *index = number - 1;
        return -1;
    }
    for (size_t i = 0; i < instrument->view_count; i++)
        if (*end != '\0' && begins_alike(instrument->views[i].title, text)) {
            *index = i;
            return -1;
        }
    return command_misused("--view %s: expected 1 to %zu, or how the title of a view begins; "
                           "imukit physics %s lists them",
                           text, instrument->view_count, instrument->name);
}

/* A view that cannot be drawn (the reason is on standard error) is left out, and so is one of what
 * this design has not. */
void physics_show_views(const physics *p, imk_result *result)
{
    const imk_instrument *instrument = p->settings.instrument;
    if (instrument->view_count > 0)
        imk_result_heading(result, "Inside the instrument");
    for (size_t i = 0; i < instrument->view_count; i++) {
        const imk_view *view = &instrument->views[i];
        physics_view v;
        if (make_view(p, i, &v) >= 0) {
            command_warn("view", "the view \"%s\" is left out", view->title);
            continue;
        }
        if (!is_empty(&v) && can_move(view)) {
            const imk_animation animation = animation_of(&v);
            imk_result_animation(result, &animation, view->caption);
        } else if (!is_empty(&v)) {
            add_panel(p, &v, imk_result_figure(result, "", 1, view->caption));
        }
        free(v.data);
    }
}

int physics_show_view_figure(const physics *p, imk_result *result)
{
    const imk_instrument *instrument = p->settings.instrument;
    const bool one = p->options->view != NULL;
    size_t first = 0, kept = 0;
    if (instrument->view_count == 0)
        return command_failed("the %s has no views: add --duration TIME to draw its outputs",
                              instrument->title);
    int code = one ? find_view(p, &first) : -1;
    imk_figure_builder *figure = imk_result_figure(result, instrument->title, 2, "");
    const size_t end = one ? first + 1 : instrument->view_count;
    for (size_t i = first; i < end && code < 0; i++) {
        physics_view v;
        code = make_view(p, i, &v);
        if (code >= 0)
            break;
        if (one || !is_empty(&v)) {
            add_panel(p, &v, figure);
            kept++;
        }
        free(v.data);
    }
    if (code < 0 && kept == 0)
        code = command_failed("nothing moves in the views of this design; add --%s",
                              instrument->sensor == IMK_GYRO ? "rate" : "acceleration");
    return code;
}

/* Of the view asked for, else of the first that can move. */
static int choose_moving(const physics *p, size_t *index)
{
    const imk_instrument *instrument = p->settings.instrument;
    const imk_view *views = instrument->views;
    *index = 0;
    const int code = p->options->view ? find_view(p, index) : -1;
    while (!p->options->view && *index < instrument->view_count && !can_move(&views[*index]))
        ++*index;
    if (code >= 0)
        return code;
    if (*index >= instrument->view_count)
        return command_misused("--animate: no view of the %s shows one signal against another",
                               instrument->title);
    if (!can_move(&views[*index]))
        return command_misused("--animate: the view \"%s\" is drawn against time; a view of one "
                               "signal against another can move",
                               views[*index].title);
    return -1;
}

int physics_animate(const physics *p, const char *path)
{
    size_t index;
    physics_view v;
    imk_error error;
    int code = choose_moving(p, &index);
    if (code < 0)
        code = make_view(p, index, &v);
    if (code >= 0)
        return code;
    const imk_animation animation = animation_of(&v);
    const imk_status status = imk_animation_write(&animation, path, &error);
    free(v.data);
    return status == IMK_OK ? -1 : command_error(&error, NULL);
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

bool physics_show_laboratory_figure(const physics *p, const physics_laboratory *l,
                                    imk_result *result)
{
    const imk_laboratory_result *r = &l->result;
    if (r->point_count == 0 && r->response_count == 0)
        return false;
    imk_figure_builder *figure = imk_result_figure(
        result, p->settings.instrument->title, 2,
        "The rate table shows output less input, bars of two standard deviations; the response is "
        "the gain for a sine.");
    if (r->point_count > 0)
        add_table(r, p->settings.instrument->sensor == IMK_GYRO, figure);
    if (r->response_count > 0)
        add_response(r, figure);
    return true;
}
