/* SPDX-License-Identifier: Apache-2.0 */
/* Motion, temperature and length of a simulation, from the options. */
#include "simulate_parts.h"

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

static bool has_temperature_terms(const imk_triad *triad)
{
    if (!triad->present)
        return false;
    bool any = triad->bias.temperature.order > 0 || triad->scale_factor.temperature.order > 0;
    for (int i = 0; i < triad->axis_count; i++)
        any = any || triad->bias.temperature_rate.value[i] != 0 ||
              triad->bias.hysteresis.value[i] != 0;
    return any;
}

static int open_temperature(const simulate_options *o, const imk_model *model, scene *s)
{
    imk_error error;
    if (!o->temperature) {
        if (has_temperature_terms(&model->gyro) || has_temperature_terms(&model->accel) ||
            has_temperature_terms(&model->mag))
            command_warn("temperature_unknown", "the model's temperature terms are left out: add "
                                                "--temperature 25degC or a profile");
        return -1;
    }
    if (imk_temperature_read(o->temperature, &s->temperature, &error) != IMK_OK)
        return table_error(&error, o->temperature);
    s->settings.simulation.temperature = imk_temperature_file_profile(s->temperature);
    return -1;
}

/* A magnetometer needs a field, and a motion with an attitude. */
static int choose_field(const simulate_options *o, const imk_model *model, scene *s)
{
    imk_simulation *simulation = &s->settings.simulation;
    const imk_trajectory *trajectory = simulation->motion.trajectory;
    imk_error error;
    imk_unit unit;
    double sigma[3];
    size_t count = 0;
    if (o->field && !model->mag.present)
        return command_misused(
            "--field is for a model with a magnetometer (mag:), and this has none");
    if (model->mag.present && simulation->motion.recorded) {
        command_warn("no_attitude",
                     "the magnetometer is left out: %s states rates and forces, but "
                     "not the attitude in the field",
                     o->motion);
        return -1;
    }
    if (o->field) {
        const imk_status status =
            imk_quantity_parse(o->field, o->field + strlen(o->field), imk_unit_of("T").dimension, 3,
                               simulation->field, sigma, &count, &unit, &error);
        return status == IMK_OK && count == 3
                   ? -1
                   : command_misused(
                         "--field \"%s\": expected three numbers and a unit, north, east "
                         "and down, such as \"20 1 43 uT\"",
                         o->field);
    }
    double latitude = simulation->latitude, last;
    if (trajectory) {
        imk_motion_state state;
        double first;
        imk_trajectory_span(trajectory, &first, &last);
        imk_trajectory_state(trajectory, first, &state);
        latitude = state.place.latitude;
    }
    if (model->mag.present)
        imk_dipole_field(latitude, simulation->field);
    return -1;
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

/* Vibration that the parts of a sample cannot follow is neither averaged nor rectified rightly. */
static void warn_of_vibration(const simulate_options *o, const scene *s)
{
    const imk_trajectory *trajectory = s->settings.simulation.motion.trajectory;
    const double rate = s->settings.simulation.rate;
    if (!trajectory || o->substeps.given)
        return;
    size_t parts = imk_trajectory_substeps(trajectory, 1 / rate);
    if (parts > IMK_SUBSTEPS_MAX)
        command_warn("vibration",
                     "the vibration needs %zu parts per sample, but %d are the most; its effect is "
                     "wrong below --rate %.0fHz",
                     parts, IMK_SUBSTEPS_MAX, ceil(rate * (double)parts / IMK_SUBSTEPS_MAX));
}

/* A motion given without a length is simulated to its end, the last row included. */
static int choose_length(const simulate_options *o, scene *s)
{
    const double rate = s->settings.simulation.rate;
    const double length = s->motion ? imk_motion_file_duration(s->motion) : (double)INFINITY;
    if (isnan(o->duration) && isinf(length))
        return command_misused("the length is missing: add --duration 1h");
    if (isnan(o->duration)) {
        const imk_recorded_motion *recorded = s->settings.simulation.motion.recorded;
        if (!recorded && !(length * rate < 1e15))
            return command_misused("the motion's %g s at %g Hz are %.3g rows: expected up to 1e15; "
                                   "add --duration, or a lower rate",
                                   length, rate, length * rate);
        s->settings.rows = recorded ? recorded->count : (uint64_t)floor(length * rate + 1e-6) + 1;
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
    s->settings.rows = (uint64_t)llround(o->duration * rate);
    return -1;
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
        code = open_temperature(o, model, s);
    if (code < 0)
        code = choose_field(o, model, s);
    if (code < 0)
        code = choose_rate(o, s);
    if (code < 0)
        code = choose_length(o, s);
    if (code < 0)
        warn_of_vibration(o, s);
    if (s->settings.simulation.motion.trajectory) {
        double last;
        imk_trajectory_span(s->settings.simulation.motion.trajectory, &s->settings.start, &last);
    }
    return code;
}

void scene_free(scene *s)
{
    imk_motion_file_free(s->motion);
    imk_temperature_file_free(s->temperature);
    imk_result_free(s->result);
}
