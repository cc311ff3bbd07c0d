/* SPDX-License-Identifier: Apache-2.0 */
/* Motion, temperature and length of a simulation, from the options. */
#include "simulate_parts.h"

#include "log/log_input.h"

#include <math.h>
#include <string.h>

static imk_geodetic place_of(const simulate_options *o)
{
    imk_simulation standard = imk_simulation_default();
    return (imk_geodetic){isnan(o->latitude) ? standard.latitude : o->latitude, 0.0, o->height};
}

static bool lacks_rate(const imk_error *error)
{
    return strncmp(error->expected, "add --rate", 10) == 0;
}

/* Options that say how to read a log are of `imukit convert`, not of this verb. */
static int table_error(imk_error *error, const char *path)
{
    if (strncmp(error->expected, "add --columns", 13) == 0) {
        snprintf(error->expected, sizeof error->expected,
                 "a header with names and units, time [s] among them");
    } else if (strncmp(error->expected, "add --", 6) == 0 && !lacks_rate(error)) {
        char options[300];
        snprintf(options, sizeof options, "%.299s", error->expected + 4);
        options[strcspn(options, "(")] = '\0';
        snprintf(error->expected, sizeof error->expected, "imukit convert %.60s NEW.csv %s", path,
                 options);
    }
    return command_error(error, path);
}

static int open_motion(const simulate_options *o, scene *s)
{
    imk_error error;
    imk_geodetic place = place_of(o);
    if (o->roll != 0 || o->pitch != 0 || o->yaw != 0)
        return command_misused("--roll, --pitch and --yaw are for a unit at rest; with --motion "
                               "the attitude is in the motion file");
    if (o->no_earth)
        return command_misused(
            "--no-earth is for a unit at rest; in a motion script write `earth: no`");
    const imk_geodetic *stated = isnan(o->latitude) ? NULL : &place;
    imk_log_settings settings = imk_log_default();
    settings.reopened = true;
    imk_status status =
        imk_motion_read(o->motion, &settings, stated, o->seed.value, &s->motion, &error);
    if (status != IMK_OK && lacks_rate(&error) && o->rate > 0) {
        /* A table without time has the rate of the log. */
        settings.rate = o->rate;
        status = imk_motion_read(o->motion, &settings, stated, o->seed.value, &s->motion, &error);
    }
    if (status != IMK_OK)
        return table_error(&error, o->motion);
    s->settings.simulation.motion = *imk_motion_file_motion(s->motion);
    const char *note = imk_motion_file_note(s->motion);
    if (*note)
        command_warn("motion", "%s: %s", o->motion, note);
    return -1;
}

static int check_clock(const simulate_options *o, const imk_model *model, const scene *s)
{
    const imk_timing *timing = &model->timing;
    if (s->settings.simulation.motion.recorded &&
        (timing->rate_error.value != 0 || timing->jitter.value != 0 || timing->skew.value != 0))
        return command_misused("%s is known at its samples only, and the model has errors of the "
                               "clock: add --without rate_error,jitter,skew",
                               o->motion);
    return -1;
}

static int open_temperature(const simulate_options *o, scene *s)
{
    imk_error error;
    if (!o->temperature)
        return -1;
    if (imk_temperature_read(o->temperature, &s->temperature, &error) != IMK_OK)
        return table_error(&error, o->temperature);
    s->settings.simulation.temperature = imk_temperature_file_profile(s->temperature);
    return -1;
}

/* Without the option the job chooses it. */
static int choose_field(const simulate_options *o, const imk_model *model, scene *s)
{
    imk_simulation *simulation = &s->settings.simulation;
    imk_error error;
    imk_unit unit;
    double sigma[3];
    size_t count = 0;
    if (!o->field || (model->mag.present && simulation->motion.recorded))
        return -1;
    if (!model->mag.present)
        return command_misused(
            "--field is for a model with a magnetometer (mag:), and this has none");
    const imk_status status =
        imk_quantity_parse(o->field, o->field + strlen(o->field), imk_unit_of("T").dimension, 3,
                           simulation->field, sigma, &count, &unit, &error);
    return status == IMK_OK && count == 3
               ? -1
               : command_misused("--field \"%s\": expected three numbers and a unit, north, east "
                                 "and down, such as \"20 1 43 uT\"",
                                 o->field);
}

static int choose_rate(const simulate_options *o, scene *s)
{
    const imk_recorded_motion *recorded = s->settings.simulation.motion.recorded;
    s->settings.simulation.rate = isnan(o->rate) && recorded ? recorded->rate : o->rate;
    if (isnan(s->settings.simulation.rate))
        return command_misused("the sampling rate is missing: add --rate 100Hz");
    if (!(s->settings.simulation.rate > 0))
        return command_misused("--rate must be positive");
    if (!(s->settings.simulation.rate >= 1e-9 && s->settings.simulation.rate <= 1e12))
        return command_misused("--rate %g Hz: expected 1e-9 Hz to 1e12 Hz",
                               s->settings.simulation.rate);
    if (recorded && fabs(s->settings.simulation.rate - recorded->rate) > 1e-9 * recorded->rate)
        return command_misused("--rate %g Hz: the recorded motion has %g Hz; leave the option out",
                               s->settings.simulation.rate, recorded->rate);
    return -1;
}

static double motion_length(const scene *s)
{
    return s->motion ? imk_motion_file_duration(s->motion) : HUGE_VAL;
}

/* Lengths that the job refuses, too, in terms of the options. */
static int check_length(const simulate_options *o, scene *s)
{
    const double rate = s->settings.simulation.rate;
    const double length = motion_length(s);
    if (isnan(o->duration) && isinf(length))
        return command_misused("the length is missing: add --duration 1h");
    if (isnan(o->duration)) {
        const imk_recorded_motion *recorded = s->settings.simulation.motion.recorded;
        if (!recorded && !(length * rate < 1e15))
            return command_misused("the motion's %g s at %g Hz are %.3g rows: expected up to 1e15; "
                                   "add --duration, or a lower rate",
                                   length, rate, length * rate);
        return -1;
    }
    if (!(o->duration > 0))
        return command_misused("--duration must be positive");
    if (!(rate * o->duration >= 0.5 && rate * o->duration < 1e15))
        return command_misused("%g s at %g Hz is %.3g rows: expected 1 to 1e15", o->duration, rate,
                               rate * o->duration);
    if (o->duration > length + 1.5 / rate)
        return command_misused("--duration %g s: the motion ends after %g s (leave the option "
                               "out%s)",
                               o->duration, length,
                               imk_motion_file_kind(s->motion) == IMK_MOTION_SCRIPT
                                   ? ", or let the motion end with `then: hold`"
                                   : "");
    return -1;
}

/* What follows from the model and the motion. */
static int complete(const simulate_options *o, const imk_model *model, scene *s)
{
    imk_findings findings = {.count = 0};
    imk_error error;
    const imk_status status = imk_simulate_log_complete(model, o->duration, motion_length(s),
                                                        &s->settings, &findings, &error);
    (void)log_input_tell(o->motion, &findings, IMK_OK, NULL);
    return status == IMK_OK ? -1 : command_error(&error, NULL);
}

int scene_open(const simulate_options *o, const imk_model *model, scene *s)
{
    imk_geodetic place = place_of(o);
    memset(s, 0, sizeof *s);
    s->settings = imk_simulate_log_default();
    s->settings.simulation.seed = o->seed.value;
    s->settings.simulation.run = (uint32_t)o->run.value;
    s->settings.simulation.earth = !o->no_earth;
    s->settings.simulation.latitude = place.latitude;
    s->settings.simulation.height = place.height;
    s->settings.simulation.roll = o->roll;
    s->settings.simulation.pitch = o->pitch;
    s->settings.simulation.yaw = o->yaw;
    s->settings.simulation.substeps = o->substeps.value;
    int code = o->motion ? open_motion(o, s) : -1;
    if (code < 0)
        code = check_clock(o, model, s);
    if (code < 0)
        code = open_temperature(o, s);
    if (code < 0)
        code = choose_field(o, model, s);
    if (code < 0)
        code = choose_rate(o, s);
    if (code < 0)
        code = check_length(o, s);
    if (code < 0)
        code = complete(o, model, s);
    return code;
}

void scene_free(scene *s)
{
    imk_motion_file_free(s->motion);
    imk_temperature_file_free(s->temperature);
    imk_result_free(s->result);
}
