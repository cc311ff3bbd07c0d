/* SPDX-License-Identifier: Apache-2.0 */
/* Views of an instrument: on a page, in a figure, in motion. */
#include "physics_parts.h"

#include "imukit/figure_file.h"
#include "imukit/schematic.h"

#include <math.h>
#include <string.h>
#include <strings.h>

/* With the duration and rate that were asked for. */
static int make_view(const physics *p, size_t index, imk_physics_view *v)
{
    imk_error error = {.status = IMK_OK};
    const imk_status status = imk_physics_view_run(&p->settings, index, NULL, v, &error);
    if (status == IMK_OK)
        return -1;
    imk_physics_view_free(v);
    if (command_unless_memory(status) != IMK_ERROR_RANGE || strcmp(error.field, "view") != 0)
        return physics_refused(p, &error);
    return command_misused("--duration: %g s at %g points per second are %s", v->view.duration,
                           v->view.rate,
                           v->view.duration * v->view.rate >= 2 ? "too many" : "no picture");
}

/* The view that --view names. */
static int find_view(const physics *p, size_t *index)
{
    const imk_instrument *instrument = p->settings.instrument;
    const char *text = p->options->view;
    const int found = imk_physics_view_find(instrument, text);
    if (instrument->view_count == 0)
        return command_misused("--view %s: the %s has no views", text, instrument->title);
    if (found < 0)
        return command_misused("--view %s: expected 1 to %zu, or the beginning of the title of a "
                               "view; imukit physics %s lists them",
                               text, instrument->view_count, instrument->name);
    *index = (size_t)found;
    return -1;
}

/* A view that cannot be drawn (the reason is on standard error) is left out. */
void physics_show_views(const physics *p, imk_result *result)
{
    const imk_instrument *instrument = p->settings.instrument;
    if (instrument->view_count > 0)
        imk_result_heading(result, "Inside the instrument");
    for (size_t i = 0; i < instrument->view_count; i++) {
        imk_physics_view v;
        if (make_view(p, i, &v) >= 0) {
            command_warn("view", "the view \"%s\" is left out", instrument->views[i].title);
            continue;
        }
        imk_show_physics_view(&v, result);
        imk_physics_view_free(&v);
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
        imk_physics_view v;
        code = make_view(p, i, &v);
        if (code >= 0)
            break;
        if (one || !v.empty) {
            imk_show_physics_panel(&v, figure);
            kept++;
        }
        imk_physics_view_free(&v);
    }
    if (code < 0 && kept == 0)
        code = command_failed("nothing moves in the views of this design; add --%s",
                              instrument->sensor == IMK_GYRO ? "rate" : "acceleration");
    return code;
}

/* Animate the requested view, or else the first view that can be animated. */
static int choose_moving(const physics *p, size_t *index)
{
    const imk_instrument *instrument = p->settings.instrument;
    const imk_view *views = instrument->views;
    *index = 0;
    const int code = p->options->view ? find_view(p, index) : -1;
    while (!p->options->view && *index < instrument->view_count &&
           !imk_physics_view_moves(&views[*index]))
        ++*index;
    if (code >= 0)
        return code;
    if (*index >= instrument->view_count)
        return command_misused("--animate: no view of the %s shows one signal against another",
                               instrument->title);
    if (!imk_physics_view_moves(&views[*index]))
        return command_misused("--animate: the view \"%s\" is drawn against time; only a view of "
                               "one signal against another can move",
                               views[*index].title);
    return -1;
}

int physics_animate(const physics *p, const char *path)
{
    size_t index;
    imk_physics_view v;
    imk_error error;
    int code = choose_moving(p, &index);
    if (code < 0)
        code = make_view(p, index, &v);
    if (code >= 0)
        return code;
    const imk_animation animation = imk_physics_animation(&v);
    const imk_status status = imk_animation_write(&animation, path, &error);
    imk_physics_view_free(&v);
    return status == IMK_OK ? -1 : command_error(&error, NULL);
}

/* ---- the schematic --------------------------------------------------------------------------- */

bool physics_asks_schematic(const physics_options *o)
{
    return o->view && strcasecmp(o->view, "schematic") == 0;
}

int physics_draw_schematic(const physics *p, const char *path)
{
    const imk_instrument *instrument = p->settings.instrument;
    const imk_schematic *schematic = imk_schematic_of(instrument);
    imk_error error = {.status = IMK_OK};
    if (!schematic)
        return command_failed("the %s has no schematic", instrument->title);
    const double pace = imk_schematic_pace(schematic, p->settings.design);
    const double seconds = p->settings.view_duration / pace; /* 0: as the schematic states */
    const imk_status status = imk_schematic_write(&p->settings, seconds, 0, path, &error);
    if (status == IMK_OK)
        return -1;
    if (status == IMK_ERROR_RANGE && strcmp(error.field, "seconds") == 0)
        return command_misused("--duration: %g s last %.3g s in the drawing, which is %.3g times "
                               "as slow; expected %.3g s to %.3g s",
                               p->settings.view_duration, seconds, 1 / pace, pace, 3600 * pace);
    if (status == IMK_ERROR_OPEN || status == IMK_ERROR_WRITE)
        return command_error(&error, NULL);
    return physics_refused(p, &error);
}
