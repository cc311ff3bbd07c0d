/* SPDX-License-Identifier: Apache-2.0 */
/* A view in motion: a point that walks along the path of one signal against another. */
#include "physics_parts.h"

#include "imukit/figure_file.h"

#include <math.h>
#include <stdlib.h>

/* A round on the screen [s]: slow enough to follow with the eye. */
static const double round_time = 12;

bool physics_view_can_move(const imk_view *view)
{
    return view->x >= 0 && view->curve_count == 1;
}

imk_animation physics_animation_of_view(const imk_view *view, const physics_figure *figure,
                                        char *clock, size_t size)
{
    const imk_panel *panel = &figure->panel[0];
    const imk_curve *curve = &panel->curves[0];
    const imk_unit unit = imk_unit_readable(imk_unit_of("s").dimension, view->duration);
    snprintf(clock, size, "a round: %.4g %s", view->duration / unit.scale, unit.text);
    return (imk_animation){.title = panel->title,
                           .x_label = panel->x_label,
                           .y_label = panel->y_label,
                           .count = curve->count,
                           .x = curve->x,
                           .y = curve->y,
                           .points = view->points,
                           .duration = round_time,
                           .clock = clock};
}

/* Of the view asked for, else of the first that can move. */
static int choose(const physics *p, size_t *index)
{
    const imk_instrument *instrument = p->file.instrument;
    int code = -1;
    *index = 0;
    if (p->options->view)
        code = physics_find_view(p, index);
    else
        while (*index < instrument->view_count &&
               !physics_view_can_move(&instrument->views[*index]))
            ++*index;
    if (code >= 0)
        return code;
    if (*index >= instrument->view_count)
        return command_misused("--animate: no view of the %s shows one signal against another",
                               instrument->title);
    if (!physics_view_can_move(&instrument->views[*index]))
        return command_misused("--animate: the view \"%s\" is drawn against time; a view of one "
                               "signal against another can move",
                               instrument->views[*index].title);
    return -1;
}

int physics_animate(const physics *p, const char *path)
{
    size_t index;
    char clock[80];
    imk_error error;
    int code = choose(p, &index);
    if (code >= 0)
        return code;
    physics_figure *figure = command_memory(NULL, sizeof *figure);
    code = physics_figure_of_view(p, index, figure);
    if (code < 0) {
        const imk_view view = physics_view_as_asked(p, index);
        const imk_animation animation =
            physics_animation_of_view(&view, figure, clock, sizeof clock);
        if (imk_animation_write(&animation, path, &error) != IMK_OK)
            code = command_error(&error, NULL);
        physics_figure_free(figure);
    }
    free(figure);
    return code;
}
