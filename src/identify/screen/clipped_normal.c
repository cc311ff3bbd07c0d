/* SPDX-License-Identifier: Apache-2.0 */
/* Noise that reaches the end of the range, its values put onto the limits [TOBIN1958].
 *
 * With shares p and q of the samples on the lower and upper limit, these lie at a = quantile(p) and
 * b = quantile(1 - q) of the normal distribution of unit variance, whose clipped form has
 *
 *     E y   = a p + b q + phi(a) - phi(b)
 *     E y^2 = a^2 p + b^2 q + 1 - p - q + a phi(a) - b phi(b)
 *
 * White noise stays white, with this variance. A slow change much smaller than the noise passes
 * with the gain 1 - p - q, the share of the samples that show it [BUSSGANG1952]. Where values have
 * a step, a limit stands for everything beyond half a step before it. */
#include "imukit/distributions.h"
#include "imukit/elementary.h"
#include "screener_internal.h"

#include <math.h>

static double density(double x)
{
    return 0.3989422804014327 * imk_exp(-0.5 * x * x);
}

imki_clipped imki_clipped_normal(const double share[2], const double limit[2], double mean,
                                 double deviation, double step)
{
    imki_clipped c = {1, 1, 0};
    double first = 0, second = 1 - share[0] - share[1], edge[2] = {0, 0};
    if (!(second > 0.02) || !(share[0] + share[1] > 0))
        return c;
    for (int side = 0; side < 2; side++) {
        if (!(share[side] > 0))
            continue;
        const double sign = side == 0 ? -1 : 1, x = -imk_normal_quantile(share[side]);
        edge[side] = sign * x;
        first += sign * (x * share[side] - density(x));
        second += x * x * share[side] - x * density(x);
    }
    /* Standard deviation of the normal distribution: from both limits, or from one and the mean. */
    double sigma = 0;
    if (share[0] > 0 && share[1] > 0)
        sigma = (limit[1] - limit[0] - step) / (edge[1] - edge[0]);
    else if (share[0] > 0)
        sigma = (limit[0] + step / 2 - mean) / (edge[0] - first);
    else
        sigma = (limit[1] - step / 2 - mean) / (edge[1] - first);
    const double variance = second - first * first;
    if (!(sigma > 0) || !(variance > 0))
        return c;
    /* Of values on the grid: the limits are half a step farther out, the others rounded. */
    const double half = 0.5 * step / sigma;
    const double outer = 2 * half *
                         (share[0] * (first - edge[0]) * (share[0] > 0) +
                          share[1] * (edge[1] - first) * (share[1] > 0));
    const double rounded = variance + outer + half * half / 3;
    c.deviation = sqrt((1 + half * half / 3) / rounded);
    c.gain = 1 - share[0] - share[1];
    c.misfit = fabs(deviation / (sigma * sqrt(rounded)) - 1);
    return c;
}
