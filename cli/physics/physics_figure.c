/* SPDX-License-Identifier: Apache-2.0 */
/* Pictures: the outputs of a run against time, the views of an instrument, and what a laboratory
 * found. */
#include "physics_parts.h"

#include "imukit/figure_file.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* More points than this are not seen. */
enum { VIEW_POINTS = 5000 };

void physics_figure_free(physics_figure *figure)
{
    for (size_t i = 0; i < PHYSICS_PANELS_MAX; i++) {
        free(figure->memory[i]);
        figure->memory[i] = NULL;
    }
}

static void finish(physics_figure *f, const char *title, size_t panels)
{
    f->figure = (imk_figure){title, panels, panels < 2 ? 1 : 2, f->panel};
    if (panels == 1) /* drawn over two or more */
        f->figure.title = "";
}

/* "beat frequency [kHz]"; pure numbers have no unit. */
static void label(char *text, size_t size, const char *name, const char *unit)
{
    if (strcmp(unit, "1") == 0)
        snprintf(text, size, "%.48s", name);
    else
        snprintf(text, size, "%.48s [%.40s]", name, unit);
    for (char *c = text; *c && *c != '['; c++)
        if (*c == '_')
            *c = ' ';
}

/* ---- a run ----------------------------------------------------------------------------------- */

/* Output 0 against the input: a curve of response, with its dead band, when the sine is slow, an
 * ellipse when the instrument lags behind. */
static void response_of_run(const physics_run *run, const char *unit, physics_figure *f, size_t at)
{
    const double *values = f->curve[0][0].y, *input = f->curve[0][1].y;
    f->curve[at][0] =
        (imk_curve){"output", IMK_CURVE_POINTS, 0, run->points, input, values, NULL, NULL};
    f->curve[at][1] =
        (imk_curve){"input", IMK_CURVE_DASHES, 1, run->points, input, input, NULL, NULL};
    label(f->label[at][0], sizeof f->label[at][0], "input", unit);
    label(f->label[at][1], sizeof f->label[at][1], "output", unit);
    f->panel[at] = (imk_panel){"Output against input",
                               f->label[at][0],
                               f->label[at][1],
                               false,
                               false,
                               2,
                               f->curve[at],
                               0,
                               NULL,
                               IMK_KEY_UPPER};
}

void physics_figure_of_run(const physics *p, const physics_run *run, physics_figure *f)
{
    const imk_instrument *instrument = p->file.instrument;
    const size_t outputs = instrument->output_count;
    memset(f, 0, sizeof *f);
    for (size_t i = 0; i < outputs; i++) {
        const imk_signal *signal = &instrument->outputs[i];
        const imk_unit unit = physics_output_unit(p, run, i);
        double *values = command_memory(NULL, 2 * (run->points + 1) * sizeof *values);
        double *input = values + run->points;
        f->memory[i] = values;
        for (size_t k = 0; k < run->points; k++) {
            values[k] = (run->curve[i][k] - unit.offset) / unit.scale;
            input[k] = run->input[k] / unit.scale;
        }
        f->curve[i][0] = (imk_curve){
            i == 0 ? "output" : "", IMK_CURVE_LINE, 0, run->points, run->time, values, NULL, NULL};
        f->curve[i][1] =
            (imk_curve){"input", IMK_CURVE_DASHES, 1, run->points, run->time, input, NULL, NULL};
        label(f->label[i][0], sizeof f->label[i][0], signal->name, "1");
        snprintf(f->label[i][0] + strlen(f->label[i][0]),
                 sizeof f->label[i][0] - strlen(f->label[i][0]), ": %s", signal->help);
        label(f->label[i][1], sizeof f->label[i][1], signal->name, unit.text);
        f->panel[i] = (imk_panel){f->label[i][0], "time [s]",     f->label[i][1], false,
                                  false,          i == 0 ? 2 : 1, f->curve[i],    0,
                                  NULL,           IMK_KEY_UPPER};
    }
    if (p->input.is_sine)
        response_of_run(run, physics_output_unit(p, run, 0).text, f, outputs);
    finish(f, p->file.name[0] ? p->file.name : instrument->title, outputs + p->input.is_sine);
}

/* ---- views ----------------------------------------------------------------------------------- */

/* The view's own input, unless another was asked for. */
static physics_input input_of(const physics *p, const imk_view *view)
{
    physics_input input = p->input;
    if (!p->options->rate && !p->options->acceleration) {
        const bool gyro = p->file.instrument->sensor == IMK_GYRO;
        (gyro ? input.exposure.angular_rate : input.exposure.specific_force)[0] = view->input;
    }
    return input;
}

imk_view physics_view_as_asked(const physics *p, size_t index)
{
    imk_view view = p->file.instrument->views[index];
    if (!isnan(p->options->view_duration))
        view.duration = p->options->view_duration;
    if (p->options->view && !isnan(p->options->view_rate))
        view.rate = p->options->view_rate;
    return view;
}

/* Run the instrument as the view says; rows of x, y … in display units into `data`. */
static int record(const physics *p, const imk_view *view, size_t points, uint64_t stride,
                  double *data)
{
    const imk_instrument *instrument = p->file.instrument;
    imk_physics_settings settings = p->settings;
    double outputs[IMK_INSTRUMENT_OUTPUTS_MAX], inside[IMK_INSTRUMENT_SIGNALS_MAX];
    void *state;
    const physics_input input = input_of(p, view);
    settings.rate = view->rate;
    int code = physics_start(p, &settings, &state);
    if (code >= 0)
        return code;
    const uint64_t settle = (uint64_t)floor(view->settle * view->rate + 0.5);
    for (uint64_t k = 0; k < settle; k++) {
        const imk_exposure e = physics_input_at(&input, view->rate, k);
        instrument->step(state, &e, outputs);
    }
    for (uint64_t k = 0; k < points * stride; k++) {
        const imk_exposure e = physics_input_at(&input, view->rate, settle + k);
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

/* The time axis of a short view is in ms or us. */
static const char *scale_time(const imk_view *view, size_t points, double *time)
{
    const imk_unit unit = imk_unit_readable(imk_unit_of("s").dimension, view->duration);
    if (unit.scale > 1)
        return "s";
    for (size_t k = 0; k < points; k++)
        time[k] /= unit.scale;
    return unit.scale == 1 ? "s" : unit.scale > 1e-4 ? "ms" : "us";
}

/* "tilt x, tilt y", as far as there is room. */
static void join_names(const imk_instrument *instrument, const imk_view *view, char *text,
                       size_t size)
{
    size_t length = 0;
    for (int c = 0; c < view->curve_count && length < size; c++)
        length += (size_t)snprintf(text + length, size - length, "%s%s", c > 0 ? ", " : "",
                                   instrument->signals[view->y[c]].name);
    if (length > 48)
        text[0] = '\0'; /* the key says it */
}

static void label_panel(const imk_instrument *instrument, const imk_view *view, const char *x_unit,
                        physics_figure *f, size_t at)
{
    char names[200];
    join_names(instrument, view, names, sizeof names);
    label(f->label[at][0], sizeof f->label[at][0],
          view->x < 0 ? "time" : instrument->signals[view->x].name, x_unit);
    label(f->label[at][1], sizeof f->label[at][1], names, instrument->signals[view->y[0]].unit);
    for (int c = 0; view->curve_count > 1 && c < view->curve_count; c++) {
        label(f->name[at][c], sizeof f->name[at][c], instrument->signals[view->y[c]].name, "1");
        f->curve[at][c].label = f->name[at][c];
    }
}

static int make_panel(const physics *p, const imk_view *view, physics_figure *f, size_t at)
{
    const imk_instrument *instrument = p->file.instrument;
    const uint64_t samples = (uint64_t)floor(view->duration * view->rate + 0.5);
    const uint64_t stride = samples / VIEW_POINTS + 1;
    const size_t points = (size_t)(samples / stride);
    const size_t columns = (size_t)view->curve_count + 1;
    double *data = command_memory(NULL, (columns * points + 1) * sizeof *data);
    f->memory[at] = data;
    int code = record(p, view, points, stride, data);
    if (code >= 0)
        return code;
    for (int c = 0; c < view->curve_count; c++)
        f->curve[at][c] = (imk_curve){"",   view->points ? IMK_CURVE_POINTS : IMK_CURVE_LINE,
                                      c,    points,
                                      data, data + (size_t)(c + 1) * points,
                                      NULL, NULL};
    const char *x_unit =
        view->x < 0 ? scale_time(view, points, data) : instrument->signals[view->x].unit;
    label_panel(instrument, view, x_unit, f, at);
    f->panel[at] = (imk_panel){view->title,
                               f->label[at][0],
                               f->label[at][1],
                               false,
                               false,
                               (size_t)view->curve_count,
                               f->curve[at],
                               0,
                               NULL,
                               IMK_KEY_UPPER};
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
bool physics_view_is_empty(const imk_view *view, const imk_panel *panel)
{
    const imk_curve *first = &panel->curves[0];
    if (view->x >= 0 && is_constant(first->count, first->x))
        return true;
    if (first->y[0] == 0 && is_constant(first->count, first->y))
        return true;
    for (size_t c = 0; c < panel->curve_count; c++)
        if (!is_constant(panel->curves[c].count, panel->curves[c].y))
            return false;
    return true;
}

int physics_figure_of_view(const physics *p, size_t index, physics_figure *f)
{
    const imk_instrument *instrument = p->file.instrument;
    const size_t first = index == SIZE_MAX ? 0 : index;
    const size_t all =
        instrument->view_count < PHYSICS_PANELS_MAX ? instrument->view_count : PHYSICS_PANELS_MAX;
    const size_t count = index == SIZE_MAX ? all : 1;
    size_t kept = 0;
    int code = -1;
    memset(f, 0, sizeof *f);
    for (size_t i = 0; i < count && code < 0; i++) {
        const imk_view view = physics_view_as_asked(p, first + i);
        if (!(view.duration * view.rate >= 2 && view.duration * view.rate <= 1e9))
            code = command_misused("--duration: %g s at %g points per second are %s", view.duration,
                                   view.rate,
                                   view.duration * view.rate >= 2 ? "too many" : "no picture");
        else
            code = make_panel(p, &view, f, kept);
        if (code >= 0 || count == 1 || !physics_view_is_empty(&view, &f->panel[kept])) {
            kept++;
        } else {
            free(f->memory[kept]);
            f->memory[kept] = NULL;
        }
    }
    if (code < 0 && kept == 0)
        code = command_failed("nothing moves in the views of this design; add --%s",
                              instrument->sensor == IMK_GYRO ? "rate" : "acceleration");
    if (code >= 0)
        physics_figure_free(f);
    finish(f, instrument->title, kept);
    return code;
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

int physics_find_view(const physics *p, size_t *index)
{
    const imk_instrument *instrument = p->file.instrument;
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

/* ---- laboratory ------------------------------------------------------------------------------ */

/* Distance from the straight line through zero of the computed scale, in parts of full scale. */
static void table_panel(const physics_laboratory *l, bool gyro, physics_figure *f)
{
    const char *unit = gyro ? "deg/s" : "m/s^2";
    const imk_laboratory_result *r = &l->result;
    const size_t count = (size_t)r->point_count;
    const double scale = imk_unit_of(unit).scale;
    double *data = command_memory(NULL, 4 * (count + 1) * sizeof *data);
    f->memory[0] = data;
    for (size_t i = 0; i < count; i++) {
        const double error = (r->point[i].output - r->point[i].input) / scale;
        const double spread = 2 * r->point[i].sigma / scale;
        data[i] = r->point[i].input / scale;
        data[count + i] = error;
        data[2 * count + i] = error - spread;
        data[3 * count + i] = error + spread;
    }
    f->curve[0][0] = (imk_curve){
        "", IMK_CURVE_POINTS, 0, count, data, data + count, data + 2 * count, data + 3 * count};
    snprintf(f->label[0][0], sizeof f->label[0][0], "input [%s]", unit);
    snprintf(f->label[0][1], sizeof f->label[0][1], "output - input [%s]", unit);
    f->panel[0] = (imk_panel){gyro ? "Rate table" : "Static response",
                              f->label[0][0],
                              f->label[0][1],
                              false,
                              false,
                              1,
                              f->curve[0],
                              0,
                              NULL,
                              IMK_KEY_UPPER};
}

static void response_panel(const physics_laboratory *l, physics_figure *f, size_t at)
{
    const imk_laboratory_result *r = &l->result;
    const size_t count = (size_t)r->response_count;
    double *data = command_memory(NULL, 2 * (count + 1) * sizeof *data);
    f->memory[at] = data;
    for (size_t i = 0; i < count; i++) {
        data[i] = r->response[i].frequency;
        data[count + i] = r->response[i].gain;
    }
    f->curve[at][0] = (imk_curve){"", IMK_CURVE_POINTS, 0, count, data, data + count, NULL, NULL};
    f->panel[at] = (imk_panel){
        "Frequency response", "frequency [Hz]", "gain", true, true, 1, f->curve[at], 0, NULL,
        IMK_KEY_UPPER};
}

bool physics_figure_of_laboratory(const physics *p, const physics_laboratory *l, physics_figure *f)
{
    const bool gyro = p->file.instrument->sensor == IMK_GYRO;
    size_t panels = 0;
    memset(f, 0, sizeof *f);
    if (l->result.point_count > 0) {
        table_panel(l, gyro, f);
        panels++;
    }
    if (l->result.response_count > 0)
        response_panel(l, f, panels++);
    finish(f, p->file.instrument->title, panels);
    return panels > 0;
}

int physics_draw(const imk_figure *figure, const char *path)
{
    imk_error error;
    if (imk_figure_write(figure, path, &error) == IMK_OK)
        return -1;
    return command_error(&error, NULL);
}
