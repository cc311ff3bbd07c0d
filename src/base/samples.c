/* SPDX-License-Identifier: Apache-2.0 */
/* Steps of time as numbers of intervals. */
#include "imukit/samples.h"

#include <math.h>

bool imk_step_is_gap(double step, double interval)
{
    return !(step < 1.5 * interval);
}

size_t imk_step_intervals(double step, double interval)
{
    if (!(step > 0.0))
        return 0;
    if (!imk_step_is_gap(step, interval))
        return 1;
    const double intervals = floor(step / interval + 0.5);
    return intervals < 1e15 ? (size_t)intervals : (size_t)1e15;
}
