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

static int open_motion(const simulate_options *o, scene *s)
{
    imk_error error;
    imk_geodetic place = place_of(o);
    if (o->roll != 0 || o->pitch != 0 || o->yaw != 0)
        return command_misused("--roll, --pitch and --yaw are of a unit at rest: with --motion the "
                               "attitude is in the motion file");
    if (imk_motion_read(o->motion, NULL, isnan(o->latitude) ? NULL : &place, o->seed, &s->motion,
                        &error) != IMK_OK)
        return command_error(&error, o->motion);
    s->simulation.motion = *imk_motion_file_motion(s->motion);
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
        if (has_temperature_terms(&model->gyro) || has_temperature_terms(&model->accel))
            command_warn("temperature_unknown", "the model's temperature terms are left out: add "
                                                "--temperature 25degC or a profile");
        return -1;
    }
    if (imk_temperature_read(o->temperature, &s->temperature, &error) != IMK_OK)
        return command_error(&error, o->temperature);
    s->simulation.temperature = imk_temperature_file_profile(s->temperature);
    return -1;
}

static int choose_rate(const simulate_options *o, scene *s)
{
    const imk_recorded_motion *recorded = s->simulation.motion.recorded;
    s->simulation.rate = isnan(o->rate) && recorded ? recorded->rate : o->rate;
    if (isnan(s->simulation.rate))
        return command_misused("the sample rate is missing: add --rate 100Hz");
    if (!(s->simulation.rate > 0))
        return command_misused("--rate must be positive");
    return -1;
}

/* A motion given without a length is simulated to its end, the last row included. */
static int choose_length(const simulate_options *o, scene *s)
{
    const double rate = s->simulation.rate;
    const double length = s->motion ? imk_motion_file_duration(s->motion) : (double)INFINITY;
    if (isnan(o->duration) && isinf(length))
        return command_misused("the length is missing: add --duration 1h");
    if (isnan(o->duration)) {
        const imk_recorded_motion *recorded = s->simulation.motion.recorded;
        s->rows = recorded ? recorded->count : (uint64_t)floor(length * rate + 1e-6) + 1;
        return -1;
    }
    if (!(o->duration > 0))
        return command_misused("--duration must be positive");
    if (!(rate * o->duration >= 0.5 && rate * o->duration < 1e15))
        return command_misused("%g s at %g Hz is %.3g rows: expected 1 to 1e15", o->duration, rate,
                               rate * o->duration);
    if (o->duration > length + 1.5 / rate)
        return command_misused("--duration %g s: the motion ends after %g s (leave the option out, "
                               "or let the motion end with `then: hold`)",
                               o->duration, length);
    s->rows = (uint64_t)llround(o->duration * rate);
    return -1;
}

int scene_open(const simulate_options *o, const imk_model *model, scene *s)
{
    imk_geodetic place = place_of(o);
    memset(s, 0, sizeof *s);
    s->simulation = imk_simulation_default();
    s->simulation.seed = o->seed;
    s->simulation.run = (uint32_t)o->run;
    s->simulation.earth = !o->no_earth;
    s->simulation.latitude = place.latitude;
    s->simulation.height = place.height;
    s->simulation.roll = o->roll;
    s->simulation.pitch = o->pitch;
    s->simulation.yaw = o->yaw;
    s->simulation.substeps = o->substeps;
    int code = o->motion ? open_motion(o, s) : -1;
    if (code < 0)
        code = open_temperature(o, model, s);
    if (code < 0)
        code = choose_rate(o, s);
    if (code < 0)
        code = choose_length(o, s);
    if (s->simulation.motion.trajectory) {
        double last;
        imk_trajectory_span(s->simulation.motion.trajectory, &s->start, &last);
    }
    return code;
}

void scene_free(scene *s)
{
    imk_motion_file_free(s->motion);
    imk_temperature_file_free(s->temperature);
}
