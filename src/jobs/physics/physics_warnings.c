/* SPDX-License-Identifier: Apache-2.0 */
/* What is said about a run that ended where it should not have. */
#include "physics_log_internal.h"

#include "jobs/job_internal.h"

#include <math.h>

/* Did the output go where the input is? A tenth of it and the biases of the run are allowed for,
 * and `scatter` standard deviations of the samples; one sample does not show these. */
static bool is_followed(const imk_physics_log *log, const imk_triad *t, double input,
                        double scatter)
{
    const double allowed = 0.1 * fabs(input) + fabs(t->bias.fixed.value[0]) +
                           5 * t->bias.repeatability.value[0] +
                           5 * t->noise.bias_instability.value[0] + scatter * log->deviation[0];
    return log->settings.input.frequency > 0 || log->samples < 2 ||
           fabs(log->last[0] - input) <= allowed;
}

/* Beyond the temperatures that the design is made for, where its errors are known. */
static void warn_of_temperature(imk_physics_log *log, const imk_triad *t)
{
    const imk_physics_input *input = &log->settings.input;
    const double begin = input->exposure.temperature;
    const double end = begin + input->temperature_rate * log->settings.duration;
    const imk_temperature_polynomial *course =
        t->bias.temperature.order > 0 ? &t->bias.temperature : &t->scale_factor.temperature;
    if (course->order > 0 &&
        (fmin(begin, end) < course->minimum || fmax(begin, end) > course->maximum))
        imki_find(
            &log->findings, IMK_FINDING_WARNING, "physics:temperature", NULL,
            IMKI_NUMBERS(
                (fmin(begin, end) < course->minimum ? fmin(begin, end) : fmax(begin, end)) - 273.15,
                course->minimum - 273.15, course->maximum - 273.15));
}

void imki_physics_warn(imk_physics_log *log)
{
    const bool gyro = log->settings.instrument->sensor == IMK_GYRO;
    const imk_exposure *e = &log->settings.input.exposure;
    const imk_triad *t = gyro ? &log->model.gyro : &log->model.accel;
    const double range = t->range.value[0], band = t->dead_band.value[0];
    const double input = (gyro ? e->angular_rate : e->specific_force)[0], last = log->last[0];
    const char *code = range > 0 && fabs(input) >= range               ? "range"
                       : range > 0 && fabs(last) >= 0.999 * range      ? "physics:saturated"
                       : band > 0 && input != 0 && fabs(input) <= band ? "dead_band"
                       : !is_followed(log, t, input, 5)                ? "not_followed"
                       : input != 0 && !is_followed(log, t, input, 0)  ? "scattered"
                                                                       : NULL;
    if (code)
        imki_find(&log->findings, IMK_FINDING_WARNING, code, gyro ? "rad/s" : "m/s^2",
                  IMKI_NUMBERS(input, last, range, band, log->deviation[0]));
    warn_of_temperature(log, t);
}
