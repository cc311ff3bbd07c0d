/* SPDX-License-Identifier: Apache-2.0 */
/* The motions of a filter, and its settings, from the options. */
#include "tune_parts.h"

#include <math.h>
#include <string.h>

static int open_motion(tune_work *w, size_t m)
{
    const tune_options *o = w->o;
    const char *path = w->name[1 + m];
    imk_filter_tuning_settings *s = &w->settings.tuning;
    const imk_geodetic place = {o->latitude, 0.0, o->height};
    imk_error error;
    if (imk_motion_read(path, NULL, isnan(o->latitude) ? NULL : &place, o->seed.value,
                        &w->motion[m], &error) != IMK_OK)
        return command_error(&error, path);
    const char *note = imk_motion_file_note(w->motion[m]);
    if (*note)
        command_warn("motion", "%s: %s", path, note);
    s->motion[m] = *imk_motion_file_motion(w->motion[m]);
    const double length = imk_motion_file_duration(w->motion[m]);
    s->duration[m] = isinf(length) ? 0.0 : length;
    s->motion_count = m + 1;
    w->settings.motion[m] = path;
    return -1;
}

/* Recorded motions state their rate. */
static int choose_rate(tune_work *w)
{
    imk_error error;
    const double stated = isnan(w->o->rate) ? 0.0 : w->o->rate;
    if (imk_tune_model_rate(stated, &w->settings.tuning, &error) == IMK_OK)
        return -1;
    return command_misused(
        "%s has %g samples a second, and %s; recorded rates and forces are taken "
        "at their own rate",
        w->name[1 + error.index], error.value,
        strstr(error.found, "another motion") ? error.found : "--rate is another");
}

int tune_scene_open(tune_work *w)
{
    const tune_options *o = w->o;
    w->settings = imk_tune_model_default();
    imk_filter_tuning_settings *s = &w->settings.tuning;
    int code = -1;
    for (size_t m = 0; w->name[1 + m] && code < 0; m++)
        code = open_motion(w, m);
    if (code < 0)
        code = choose_rate(w);
    if (code >= 0)
        return code;
    if (o->from > 0)
        s->from = o->from;
    if (o->to > 0)
        s->to = o->to;
    if (!(s->from <= s->to))
        return command_misused("--from %g s is later than --to-time %g s", s->from, s->to);
    if (o->windows.given)
        s->window_count = (size_t)o->windows.value;
    for (int sensor = 0; sensor < 2; sensor++)
        if (!isnan(o->bias[sensor]))
            s->bias_sigma[sensor] = o->bias[sensor];
    if (!isnan(o->bias_time))
        s->bias_time = o->bias_time;
    s->correlation_time = o->correlation_time;
    s->learned = o->learned;
    s->compensated = o->compensated;
    s->per_axis = o->per_axis;
    w->settings.run_count = (uint32_t)o->runs.value;
    w->settings.seed = o->seed.value;
    return -1;
}

void tune_scene_free(tune_work *w)
{
    for (size_t m = 0; m < IMK_TUNING_MOTIONS_MAX; m++)
        imk_motion_file_free(w->motion[m]);
}

int tune_refuse(const tune_work *w, const imk_error *error)
{
    const bool of_motion = strcmp(error->field, "motion") == 0;
    const bool of_model =
        strncmp(error->field, "gyro", 4) == 0 || strncmp(error->field, "accel", 5) == 0 ||
        strncmp(error->field, "timing", 6) == 0 || strcmp(error->field, "model") == 0;
    return command_error(error, of_model                                            ? w->name[0]
                                : of_motion && w->settings.tuning.motion_count == 1 ? w->name[1]
                                                                                    : NULL);
}
