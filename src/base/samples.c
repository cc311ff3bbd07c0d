/* SPDX-License-Identifier: Apache-2.0 */
/* Times as numbers of intervals. */
#include "imukit/samples.h"

#include <math.h>

bool imk_step_is_gap(double step, double interval)
{
    return !(step < 1.5 * interval);
}

size_t imk_step_intervals(double step, double interval)
{
    return step > 0.0 && !imk_step_is_gap(step, interval) ? 1 : imk_samples_in(step, interval);
}

size_t imk_samples_in(double time, double interval)
{
    if (!(time > 0.0))
        return 0;
    const double samples = floor(time / interval + 0.5);
    return samples < 1e15 ? (size_t)samples : (size_t)1e15;
}
