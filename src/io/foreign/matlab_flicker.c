/* SPDX-License-Identifier: Apache-2.0 */
/* Flicker noise as MATLAB's imuSensor can make it: white noise through one filter of numerator and
 * denominator. It is the sum of five first-order sequences with times from 1.5 to 1e5 samples.
 *
 * More stages would reach farther, or come nearer, but the filter works with the coefficients of
 * the products: their sum is the product of all 1 - decay, 8e-14, which doubles just hold.
 * tests/reference/matlab_flicker.py derives the numbers. */
#include "matlab_flicker_internal.h"

#include <math.h>

const imki_matlab_filter imki_matlab_flicker = {
    {0.8880600395413696, -3.4041183021921997, 4.885501602272399, -3.1108874792130323,
     0.741444139628306},
    {1, -4.470027805486323, 7.901335893616966, -6.88378624779442, 2.9436760454201765,
     -0.49119788575631707}};

static const double decay[IMKI_MATLAB_STAGES] = {0.513417119032592, 0.9593600176094306,
                                                 0.9974213415688361, 0.9998393272254641,
                                                 0.9999900000499998};
static const double variance[IMKI_MATLAB_STAGES] = {0.8792812951855892, 0.8982483725172479,
                                                    0.8641319184403073, 0.8921606561276454,
                                                    0.9519592723371225};

/* Of the sum of n samples of a first-order sequence of unit variance. */
static double variance_of_sum(double p, double n)
{
    const double step = 1 - p;
    return n * (1 + p) / step - 2 * p * (1 - pow(p, n)) / (step * step);
}

double imki_matlab_flicker_allan_variance(double n)
{
    double sum = 0;
    for (int k = 0; k < IMKI_MATLAB_STAGES; k++)
        sum += variance[k] * (4 * variance_of_sum(decay[k], n) - variance_of_sum(decay[k], 2 * n)) /
               (2 * n * n);
    return sum;
}

/* At one sample the model's own sequence is 1 to 3 % too large. */
static double due(imk_flicker flicker, double dt, double n)
{
    return n < 2 ? imk_flicker_allan_variance(flicker.instability, dt)
                 : imk_flicker_sampled_allan_variance(flicker, dt, (size_t)n);
}

double imki_matlab_flicker_range(imk_flicker flicker, double dt)
{
    double farthest = 0;
    for (double n = 1; n <= IMKI_MATLAB_FARTHEST; n = n < 50 ? n + 1 : floor(1.02 * n)) {
        const double ratio = imki_matlab_flicker_allan_variance(n) / due(flicker, dt, n);
        if (!(fabs(sqrt(ratio) - 1) <= IMKI_MATLAB_ERROR))
            return farthest;
        farthest = n;
    }
    return IMKI_MATLAB_FARTHEST;
}
