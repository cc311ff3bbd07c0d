/* SPDX-License-Identifier: Apache-2.0 */
/* What is said about a run that ended where it should not have. */
#include "physics_parts.h"

#include <math.h>

/* A rate or force as a person reads it: "0.5 deg/h". */
static const char *readable(const physics *p, double value, char *text, size_t size)
{
    const bool gyro = p->file.instrument->sensor == IMK_GYRO;
    const imk_unit unit = imk_unit_readable(imk_unit_of(gyro ? "rad/s" : "m/s^2").dimension, value);
    snprintf(text, size, "%.5g %s", value / unit.scale, unit.text);
    return text;
}

/* Did the output go where the input is? A tenth of it, the biases of the run and the scatter are
 * allowed for; one sample does not show the scatter. */
static bool is_followed(const physics *p, const imk_triad *t, const physics_run *r, double input)
{
    const double allowed = 0.1 * fabs(input) + fabs(t->bias.fixed.value[0]) +
                           5 * t->bias.repeatability.value[0] +
                           5 * t->noise.bias_instability.value[0] + 5 * r->deviation[0];
    return p->input.is_sine || r->samples < 2 || fabs(r->last[0] - input) <= allowed;
}

/* Beyond the temperatures that the design is made for, where its errors are known. */
static void warn_of_temperature(const physics *p, const imk_triad *t)
{
    const double duration = p->options->duration, begin = p->input.exposure.temperature;
    const double end = begin + p->input.temperature_rate * duration;
    const imk_temperature_polynomial *course =
        t->bias.temperature.order > 0 ? &t->bias.temperature : &t->scale_factor.temperature;
    if (course->order > 0 &&
        (fmin(begin, end) < course->minimum || fmax(begin, end) > course->maximum))
        command_warn("temperature",
                     "%.4g degC is outside the temperatures of this design, %.4g to %.4g degC",
                     (fmin(begin, end) < course->minimum ? fmin(begin, end) : fmax(begin, end)) -
                         273.15,
                     course->minimum - 273.15, course->maximum - 273.15);
}

/* What can be known of a run that went wrong quietly. */
void physics_warn_of_run(const physics *p, const physics_run *r)
{
    const bool gyro = p->file.instrument->sensor == IMK_GYRO;
    const imk_triad *t = gyro ? &p->model->gyro : &p->model->accel;
    const double range = t->range.value[0], band = t->dead_band.value[0];
    const double input =
        (gyro ? p->input.exposure.angular_rate : p->input.exposure.specific_force)[0];
    char a[64], b[64];
    (void)readable(p, input, a, sizeof a);
    if (range > 0 && fabs(input) >= range)
        command_warn("range", "the input of %s is beyond the range of %s", a,
                     readable(p, range, b, sizeof b));
    else if (range > 0 && fabs(r->last[0]) >= 0.999 * range)
        command_warn("saturated", "the output ends saturated, at %s; the input is %s",
                     readable(p, r->last[0], b, sizeof b), a);
    else if (band > 0 && input != 0 && fabs(input) <= band)
        command_warn("dead_band",
                     "the input of %s is within the dead band of %s: the output does not follow it",
                     a, readable(p, band, b, sizeof b));
    else if (!is_followed(p, t, r, input))
        command_warn("not_followed", "the output ends at %s, the input is %s",
                     readable(p, r->last[0], b, sizeof b), a);
    warn_of_temperature(p, t);
}
