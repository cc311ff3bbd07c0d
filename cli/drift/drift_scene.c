/* SPDX-License-Identifier: Apache-2.0 */
/* The motion and the times of the navigation, from the options. */
#include "drift_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- motion ---- */

static int check_rest(const drift_options *o)
{
    if (o->roll != 0 || o->pitch != 0 || o->yaw != 0)
        return command_misused("--roll, --pitch and --yaw are for a unit at rest; with --motion "
                               "the attitude is in the motion file");
    return -1;
}

static int open_motion(const drift_options *o, drift_scene *s)
{
    imk_error error;
    int code = check_rest(o);
    if (code >= 0)
        return code;
    const imk_geodetic place = {s->settings.latitude, 0.0, s->settings.height};
    imk_status status = imk_motion_read(o->motion, NULL, isnan(o->latitude) ? NULL : &place,
                                        o->seed.value, &s->motion, &error);
    if (status != IMK_OK)
        return command_error(&error, o->motion);
    const imk_motion *motion = imk_motion_file_motion(s->motion);
    if (!motion->trajectory)
        return command_failed_by(
            "no_position", NULL, o->motion,
            "%s: recorded rates and forces do not contain the true position of the unit; give a "
            "motion script or a table of poses (position and attitude)",
            o->motion);
    if (!motion->trajectory->earth)
        return command_failed_by(
            "no_earth", NULL, o->motion,
            "%s: the motion is not on the Earth (`earth: no`), and navigation needs the Earth",
            o->motion);
    const char *note = imk_motion_file_note(s->motion);
    if (*note)
        command_warn("motion", "%s: %s", o->motion, note);
    s->settings.motion = motion->trajectory;
    return -1;
}

/* ---- initial errors ---- */

/* One number for all three axes, or three: north, east, down. */
static int read_initial(const char *name, const char *text, const char *unit, double sigma[3])
{
    const double most = 1e9; /* of any state, SI */
    imk_error error;
    double value[3], spread[3];
    size_t count;
    if (!text)
        return -1;
    const imk_status status =
        imk_quantity_parse(text, text + strlen(text), imk_unit_of(unit).dimension, 3, value, spread,
                           &count, NULL, &error);
    bool good = status == IMK_OK && (count == 1 || count == 3);
    for (size_t i = 0; good && i < count; i++)
        good = value[i] >= 0 && isfinite(value[i]);
    if (!good)
        return command_misused("--%s \"%s\": expected one or three numbers (north, east, down) "
                               "that are not negative, with a unit such as %s",
                               name, text, unit);
    for (size_t i = 0; i < 3; i++)
        sigma[i] = value[count == 1 ? 0 : i];
    if (!(fmax(fmax(sigma[0], sigma[1]), sigma[2]) <= most))
        return command_misused("--%s \"%s\": expected at most %.4g %s", name, text,
                               most / imk_unit_of(unit).scale, unit);
    return -1;
}

static int read_gravity(const drift_options *o, imk_drift_settings *s)
{
    if (!(o->deflection >= 0 && o->deflection <= 0.1))
        return command_misused("--gravity-deflection %g m/s^2: expected 0 to 0.1 m/s^2",
                               o->deflection);
    if (!isnan(o->deflection_distance) && o->deflection == 0)
        return command_misused("--gravity-distance is for --gravity-deflection; add that option");
    if (!isnan(o->deflection_distance) &&
        !(o->deflection_distance > 0 && o->deflection_distance <= 1e9))
        return command_misused("--gravity-distance %g m: expected a length up to 1e9 m",
                               o->deflection_distance);
    s->gravity_deflection = o->deflection;
    if (!isnan(o->deflection_distance))
        s->gravity_distance = o->deflection_distance;
    return -1;
}

static int read_start(const drift_options *o, imk_drift_settings *s)
{
    if (o->aligned == 1 && o->initial_attitude)
        return command_misused("--initial-attitude is for a given attitude, but --aligned self "
                               "finds the attitude; leave one out");
    if (o->aligned != 1 && !isnan(o->align_time))
        return command_misused("--align-time is for --aligned self; add that option");
    if (!isnan(o->align_time) && !(o->align_time >= 1.0 && o->align_time <= 1e7))
        return command_misused("--align-time %g s: expected 1 s to 1e7 s", o->align_time);
    int code = read_initial("initial-position", o->initial_position, "m", s->initial_sigma);
    if (code < 0)
        code = read_initial("initial-velocity", o->initial_velocity, "m/s", s->initial_sigma + 3);
    if (code < 0)
        code = read_initial("initial-attitude", o->initial_attitude, "deg", s->initial_sigma + 6);
    s->alignment = o->aligned == 1 ? IMK_ALIGNED_SELF : IMK_ALIGNED_GIVEN;
    if (!isnan(o->align_time))
        s->alignment_time = o->align_time;
    s->vertical = o->vertical == 1 ? IMK_VERTICAL_FREE : IMK_VERTICAL_SLAVED;
    s->attitude_errors = o->attitude_errors == 1 ? IMK_ATTITUDE_EARTH : IMK_ATTITUDE_LOCAL;
    return code;
}

/* ---- times ---- */

int drift_stated_times(const char *name, const char *text, drift_stated *t)
{
    const double latest = 1e8; /* [s]: imk_drift_validate() */
    for (const char *begin = text; *begin;) {
        const size_t length = strcspn(begin, ",");
        double value, sigma;
        size_t count;
        if (imk_quantity_parse(begin, begin + length, imk_unit_of("s").dimension, 1, &value, &sigma,
                               &count, NULL, NULL) != IMK_OK ||
            count != 1 || !(value > 0 && value <= latest))
            return command_misused("--%s \"%s\": \"%.*s\" is not a positive time with a unit; "
                                   "write --%s \"1min, 10min, 1h\"",
                                   name, text, (int)length, begin, name);
        if (t->count == IMK_DRIFT_ROWS_MAX - 2)
            return command_misused("--%s: at most %d times", name, IMK_DRIFT_ROWS_MAX - 2);
        t->at[t->count++] = value;
        begin += length;
        begin += *begin == ',';
    }
    return -1;
}

static int refuse_times(const drift_scene *s, const imk_error *error)
{
    const double value = error->value;
    if (strcmp(error->field, "motion") == 0)
        return command_misused("%g s: the motion ends after %g s%s", value, error->limit,
                               imk_motion_file_kind(s->motion) == IMK_MOTION_SCRIPT
                                   ? " (or let it end with `then: hold`)"
                                   : "");
    if (strcmp(error->field, "want.time") == 0)
        return command_misused("--want asks for a time after the end: add --duration or leave it "
                               "out");
    if (strcmp(error->field, "duration") != 0)
        return command_error(error, NULL);
    if (!(value > 0))
        return command_misused("--duration must be positive");
    if (value > 1e8)
        return command_misused("--duration %g s: expected at most three years (1e8 s)", value);
    return command_misused("--duration %g s is less than a sample at %g Hz", value,
                           s->settings.rate);
}

static int choose_times(const drift_options *o, drift_scene *s)
{
    drift_stated times = {0}, outage = {0};
    imk_error error;
    int code = o->times ? drift_stated_times("times", o->times, &times) : -1;
    if (code < 0 && o->outage)
        code = drift_stated_times("outage", o->outage, &outage);
    if (code < 0 && !(isnan(o->duration) || o->duration > 0))
        code = command_misused("--duration must be positive");
    if (code >= 0)
        return code;
    const imk_drift_when when = {.duration = isnan(o->duration) ? 0.0 : o->duration,
                                 .time_count = times.count,
                                 .time = o->times ? times.at : NULL,
                                 .outage_count = outage.count,
                                 .outage = o->outage ? outage.at : NULL,
                                 .motion = s->motion ? imk_motion_file_duration(s->motion) : 0.0,
                                 .curves = o->plot || o->report || o->output};
    return imk_drift_times_ask(&when, &s->settings, &s->want, NULL, &s->times, &error) == IMK_OK
               ? -1
               : refuse_times(s, &error);
}

int drift_scene_open(const drift_options *o, drift_scene *s)
{
    *s = (drift_scene){.settings = imk_drift_default()};
    imk_drift_settings *settings = &s->settings;
    if (!isnan(o->latitude))
        settings->latitude = o->latitude;
    settings->height = o->height;
    settings->roll = o->roll;
    settings->pitch = o->pitch;
    settings->yaw = o->yaw;
    if (!isnan(o->rate))
        settings->rate = o->rate;
    if (!(settings->rate > 0))
        return command_misused("--rate must be positive");
    if (!(settings->rate >= 1e-3 && settings->rate <= 1e6))
        return command_misused("--rate %g Hz: expected 0.001 Hz to 1 MHz", settings->rate);
    if (!isnan(o->duration) && o->times)
        return command_misused("--duration and --times exclude each other");
    int code = o->want ? drift_want_parse(o->want, &s->want, &s->want_after) : -1;
    if (code < 0)
        code = read_start(o, settings);
    if (code < 0)
        code = read_gravity(o, settings);
    if (code < 0)
        code = drift_aids_open(o, s);
    if (code < 0 && o->motion)
        code = open_motion(o, s);
    if (code < 0)
        code = choose_times(o, s);
    return code;
}

void drift_scene_free(drift_scene *s)
{
    free(s->filter_model);
    imk_motion_file_free(s->motion);
    imk_drift_times_free(&s->times);
}
