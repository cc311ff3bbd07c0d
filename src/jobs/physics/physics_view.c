/* SPDX-License-Identifier: Apache-2.0 */
/* A view of an instrument: some of its signals, against time or against one another. */
#include "physics_log_internal.h"

#include "base/refuse_internal.h"
#include "jobs/arena_internal.h"
#include "jobs/job_internal.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* More points than this are not seen; a law is a smooth curve. */
enum { VIEW_POINTS = 5000, LAW_POINTS = 500 };

const char *imki_physics_label(char *text, const char *name, const char *unit)
{
    if (strcmp(unit, "1") == 0)
        snprintf(text, IMK_PHYSICS_LABEL, "%.48s", name);
    else
        snprintf(text, IMK_PHYSICS_LABEL, "%.48s [%.40s]", name, unit);
    for (char *c = text; *c && *c != '['; c++)
        if (*c == '_')
            *c = ' ';
    return text;
}

/* The view's own input, unless another was asked for. Where a rate was, the force of the view is
 * what it shows. */
static imk_physics_input input_of(const imk_physics_log_settings *settings, const imk_view *view)
{
    imk_physics_input input = settings->input;
    double *force = input.exposure.specific_force;
    const bool gyro = settings->instrument->sensor == IMK_GYRO;
    const bool forced = force[0] != 0 || force[1] != 0 || force[2] != 0;
    if (!settings->view_input)
        (gyro ? input.exposure.angular_rate : force)[0] = view->input;
    if (gyro && (!settings->view_input || !forced))
        force[0] = view->force;
    return input;
}

static imk_status refuse_signal(const imk_instrument *instrument, const char *name, double time,
                                imk_error *error)
{
    char found[sizeof error->found], expected[sizeof error->expected];
    snprintf(found, sizeof found, "\"%.48s\" is not finite at %.4g s", name, time);
    snprintf(
        expected, sizeof expected,
        "bring the design nearer to the default one, which imukit physics %.40s --show prints, "
        "or the input nearer to 0",
        instrument->name);
    return imk_error_set(error, IMK_ERROR_NOT_FINITE, "", found, expected);
}

/* Of more samples than rows, against time: two rows hold the least and the greatest of a stretch,
 * in their order, so that what is quicker than the rows is seen in its size. */
static bool keeps_extremes(const imk_view *view, uint64_t stride)
{
    return view->x < 0 && stride > 1;
}

static void keep_extremes(double *row, bool first, double value)
{
    const double least = fmin(row[0], row[1]), greatest = fmax(row[0], row[1]);
    if (first) {
        row[0] = row[1] = value;
    } else if (value < least) {
        row[0] = greatest;
        row[1] = value;
    } else if (value > greatest) {
        row[0] = least;
        row[1] = value;
    }
}

/* Put sample k into column c, 0: x. */
static void keep(const imk_physics_view *v, int c, uint64_t stride, uint64_t k, double value)
{
    double *column = v->data + (size_t)c * v->points;
    if (c > 0 && keeps_extremes(&v->view, stride))
        keep_extremes(column + 2 * (k / (2 * stride)), k % (2 * stride) == 0, value);
    else if ((k + 1) % stride == 0)
        column[k / stride] = value;
}

/* Rows of x, y … in display units into `data`. */
static imk_status record(const imk_physics_log_settings *settings, const imk_physics_view *v,
                         uint64_t stride, void *state, imk_error *error)
{
    const imk_instrument *instrument = settings->instrument;
    const imk_view *view = &v->view;
    double outputs[IMK_INSTRUMENT_OUTPUTS_MAX], inside[IMK_INSTRUMENT_SIGNALS_MAX];
    const imk_physics_input input = input_of(settings, view);
    const uint64_t settle = (uint64_t)floor(view->settle * view->rate + 0.5);
    for (uint64_t k = 0; k < settle; k++) {
        const imk_exposure e = imk_physics_input_at(&input, view->rate, k);
        instrument->step(state, &e, outputs);
    }
    for (uint64_t k = 0; k < v->points * stride; k++) {
        const imk_exposure e = imk_physics_input_at(&input, view->rate, settle + k);
        instrument->step(state, &e, outputs);
        if (stride > 1 && (k + 1) % stride != 0 && !keeps_extremes(view, stride))
            continue;
        instrument->observe(state, inside);
        for (int c = -1; c < view->curve_count; c++) {
            const int signal = c < 0 ? view->x : view->y[c];
            const imk_unit unit = imk_unit_of(signal < 0 ? "s" : instrument->signals[signal].unit);
            const double time = (double)(k + 1) / view->rate;
            const double value = signal < 0 ? time : inside[signal];
            if (!isfinite(value))
                return refuse_signal(instrument, instrument->signals[signal].name, time, error);
            keep(v, c + 1, stride, k, (value - unit.offset) / unit.scale);
        }
    }
    return IMK_OK;
}

/* The line from the first to the last point is taken out. */
static void take_out_ramp(const imk_physics_view *v)
{
    const size_t last = v->points - 1;
    for (int c = 1; c <= v->view.curve_count; c++) {
        double *y = v->data + (size_t)c * v->points;
        const double begin = y[0], slope = (y[last] - begin) / (double)last;
        for (size_t i = 0; i <= last; i++)
            y[i] -= begin + slope * (double)i;
    }
}

/* The law over the range of x, behind the curves. */
static void add_law(const void *design, imk_physics_view *v)
{
    const imk_view *view = &v->view;
    const imk_unit x_unit = imk_unit_of(v->instrument->signals[view->x].unit);
    const imk_unit y_unit = imk_unit_of(v->instrument->signals[view->y[0]].unit);
    double *x = v->data + (size_t)(view->curve_count + 1) * v->points, *y = x + LAW_POINTS;
    double low = v->data[0], high = v->data[0];
    for (size_t i = 1; i < v->points; i++) {
        low = fmin(low, v->data[i]);
        high = fmax(high, v->data[i]);
    }
    v->law_points = LAW_POINTS;
    for (int i = 0; i < LAW_POINTS; i++) {
        x[i] = low + (high - low) * i / (LAW_POINTS - 1);
        y[i] =
            (view->law(design, x[i] * x_unit.scale + x_unit.offset) - y_unit.offset) / y_unit.scale;
    }
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
static void label_view(const char *x_unit, imk_physics_view *v)
{
    const imk_view *view = &v->view;
    const imk_signal *signals = v->instrument->signals;
    const imk_unit unit = imk_unit_readable(imk_unit_of("s").dimension, view->duration);
    char names[256] = "";
    size_t length = 0;
    for (int c = 0; c < view->curve_count && length < sizeof names; c++)
        length += (size_t)snprintf(names + length, sizeof names - length, "%s%s", c > 0 ? ", " : "",
                                   signals[view->y[c]].name);
    imki_physics_label(v->x_label, view->x < 0 ? "time" : signals[view->x].name, x_unit);
    if (view->less_ramp && length < 32)
        snprintf(names + length, sizeof names - length, " less its ramp");
    imki_physics_label(v->y_label, length > 48 ? "" : names, signals[view->y[0]].unit);
    snprintf(v->clock, sizeof v->clock, "a round: %.4g %s", view->duration / unit.scale, unit.text);
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
static bool is_empty(const imk_physics_view *v)
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

static void finish(const void *design, imk_physics_view *v)
{
    const imk_view *view = &v->view;
    if (view->less_ramp)
        take_out_ramp(v);
    if (view->law)
        add_law(design, v);
    label_view(view->x < 0 ? scale_time(view, v->points, v->data)
                           : v->instrument->signals[view->x].unit,
               v);
    v->empty = is_empty(v);
}

imk_status imk_physics_view_run(const imk_physics_log_settings *settings, size_t index,
                                const imk_job *job, imk_physics_view *v, imk_error *error)
{
    imk_status status = imki_physics_check(v, settings, error);
    if (!v)
        return status;
    *v = (imk_physics_view){.points = 0};
    if (status != IMK_OK)
        return status;
    const imk_instrument *instrument = settings->instrument;
    if (index >= instrument->view_count)
        return imki_refuse(error, IMK_ERROR_RANGE, "index", (double)index,
                           (double)instrument->view_count, "fewer than the instrument has views");
    job = imki_job_of(job);
    *v = (imk_physics_view){
        .view = instrument->views[index], .instrument = instrument, .allocator = job->allocator};
    imk_view *view = &v->view;
    if (settings->view_duration > 0)
        view->duration = settings->view_duration;
    if (settings->view_rate > 0)
        view->rate = settings->view_rate;
    const double samples = view->duration * view->rate;
    if (!(samples >= 2 && samples <= 1e9))
        return imki_refuse(error, IMK_ERROR_RANGE, "view", samples, samples < 2 ? 2 : 1e9, NULL);
    const uint64_t stride = (uint64_t)floor(samples + 0.5) / VIEW_POINTS + 1;
    v->points = (size_t)((uint64_t)floor(samples + 0.5) / stride);
    if (keeps_extremes(view, stride))
        v->points -= v->points % 2;
    imki_arena arena = {.allocator = job->allocator};
    const size_t size = instrument->state_size;
    void *state = imki_arena_take(&arena, size > 256 ? size : 256); /* a cache line begins there */
    v->data = imki_resize(&job->allocator, NULL,
                          ((size_t)(view->curve_count + 1) * v->points + 2 * LAW_POINTS) *
                              sizeof *v->data);
    imk_physics_settings physics = settings->physics;
    physics.rate = view->rate;
    physics.duration = view->settle + view->duration;
    /* a page has several views; who asks for a length of one waits for it as for a run */
    physics.steps_max = settings->view_duration > 0 ? IMK_PHYSICS_STEPS * fmax(1, physics.duration)
                                                    : IMK_PHYSICS_VIEW_STEPS;
    const imk_physics_input input = input_of(settings, view);
    physics.turning = imki_physics_turning(&input);
    status = state && v->data
                 ? imk_instrument_init(instrument, settings->design, &physics, state, error)
                 : imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    if (status == IMK_OK)
        status = record(settings, v, stride, state, error);
    if (status == IMK_OK)
        finish(settings->design, v);
    imki_arena_free(&arena);
    return status;
}

void imk_physics_view_free(imk_physics_view *view)
{
    imki_resize(&view->allocator, view->data, 0);
    view->data = NULL;
}

bool imk_physics_view_moves(const imk_view *view)
{
    return view->x >= 0 && view->curve_count == 1;
}

/* Titles are compared by their letters and digits. */
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

int imk_physics_view_find(const imk_instrument *instrument, const char *text)
{
    char *end;
    const unsigned long number = strtoul(text, &end, 10);
    if (*end == '\0')
        return number >= 1 && number <= instrument->view_count ? (int)number - 1 : -1;
    for (size_t i = 0; i < instrument->view_count; i++)
        if (begins_alike(instrument->views[i].title, text))
            return (int)i;
    return -1;
}
