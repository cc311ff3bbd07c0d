/* SPDX-License-Identifier: Apache-2.0 */
/* What an instrument is exposed to. It is held over a sample, so a sine a sin(2 pi f t) is given as
 * its mean over the sample from t to t + h:
 *
 *     a (cos(2 pi f t) - cos(2 pi f (t + h)))/(2 pi f h)
 *
 * with the cosines of elementary.h, so that a log has the same bytes on every machine. */
#include "imukit/physics_log.h"

#include "base/refuse_internal.h"
#include "imukit/elementary.h"

#include <math.h>

static const double pi = 3.14159265358979323846;
/* The limit of the steps of a motion script; and at higher temperatures nothing is solid. */
static const double largest_motion = 1e6; /* [rad/s], [m/s^2] */
static const double highest_temperature = 1e4;

imk_exposure imk_physics_input_at(const imk_physics_input *input, double rate, uint64_t index)
{
    imk_exposure e = input->exposure;
    const double time = (double)index / rate;
    e.temperature += input->temperature_rate * (time + 0.5 / rate);
    if (!(input->frequency > 0))
        return e;
    /* whole cycles are taken off, so that the phase is good after any time */
    const double cycles = fmod(time * input->frequency, 1.0), step = input->frequency / rate;
    const double begin = 2 * pi * cycles, angle = 2 * pi * step;
    const double mean = (imk_cos(begin) - imk_cos(begin + angle)) / angle;
    const double slope = (imk_sin(begin + angle) - imk_sin(begin)) * rate;
    for (int k = 0; k < 3; k++) {
        e.angular_acceleration[k] = slope * e.angular_rate[k];
        e.angular_rate[k] *= mean;
        e.specific_force[k] *= mean;
    }
    return e;
}

static imk_status check_vector(const char *field, const double *vector, const char *expected,
                               imk_error *error)
{
    for (int k = 0; k < 3; k++)
        if (!(fabs(vector[k]) <= largest_motion))
            return imki_refuse(error, IMK_ERROR_RANGE, field, vector[k], largest_motion, expected);
    return IMK_OK;
}

imk_status imk_physics_input_check(const imk_physics_log_settings *settings, imk_error *error)
{
    const imk_physics_input *input = &settings->input;
    const double warm = input->exposure.temperature, rate = input->temperature_rate;
    const double end = settings->duration > 0 ? warm + rate * settings->duration : 0;
    const double quickest = 0.25 * settings->physics.rate;
    imk_status status = check_vector("angular_rate", input->exposure.angular_rate,
                                     "at most 1e6 rad/s, which is 5.7e7 deg/s", error);
    if (status == IMK_OK)
        status = check_vector("specific_force", input->exposure.specific_force,
                              "at most 1e6 m/s^2, which is 102000 g", error);
    if (status != IMK_OK)
        return status;
    if (!(input->frequency >= 0 && input->frequency <= quickest))
        return imki_refuse(error, IMK_ERROR_RANGE, "frequency", input->frequency, quickest,
                           "above 0, with at least four samples a cycle at the output rate");
    if (!(warm > 0 && warm <= highest_temperature))
        return imki_refuse(error, IMK_ERROR_RANGE, "temperature", warm, highest_temperature,
                           "more than absolute zero, and at most 10000 K");
    if (!(fabs(rate) <= highest_temperature && end <= highest_temperature))
        return imki_refuse(error, IMK_ERROR_RANGE, "temperature_rate", rate, highest_temperature,
                           "at most 10000 K/s, and to end at no more than 10000 K");
    return IMK_OK;
}
