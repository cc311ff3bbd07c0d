/* SPDX-License-Identifier: Apache-2.0 */
/* Ramp y[k] = R k dt: sigma_A^2 = R^2 tau^2/2, for the sampled ramp too [IEEE952]. */
#include "imukit/noise.h"

double imk_ramp_allan_variance(double slope, double tau)
{
    double rise = slope * tau;
    return 0.5 * rise * rise;
}

void imk_ramp_add(double slope, double dt, uint64_t first, size_t count, double *out)
{
    double step = slope * dt;
    for (size_t i = 0; i < count; i++)
        out[i] += step * (double)(first + i);
}
