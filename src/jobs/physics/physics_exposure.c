/* SPDX-License-Identifier: Apache-2.0 */
/* The exposure is held over a sample, so a sine a sin(2 pi f t) is given as its mean over the
 * sample from t to t + h:
 *
 *     a (cos(2 pi f t) - cos(2 pi f (t + h)))/(2 pi f h)
 *
 * with the cosines of elementary.h, so that a log has the same bytes on every machine. */
#include "imukit/physics_log.h"

#include "imukit/elementary.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

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
