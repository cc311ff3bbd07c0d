/* SPDX-License-Identifier: Apache-2.0 */
/* J_n(x) = 1/(2 pi) integral of cos(n t - x sin t) over a period. The integrand is periodic and
 * entire, so that the trapezoidal rule with N points errs by J_{N-n}(x) and its like, which vanish
 * once N exceeds |n| + |x| by some multiples of |x|^(1/3) [TREFETHEN2014]. */
#include "bessel_internal.h"

#include "imukit/elementary.h"

#include <math.h>

static const double two_pi = 6.283185307179586477;

double imki_bessel_j(int n, double x)
{
    const double size = fabs((double)n) + fabs(x);
    const int points = (int)(1.1 * size) + 64;
    double sum = 0.0;
    for (int k = 0; k < points; k++) {
        const double t = two_pi * k / points;
        sum += imk_cos(n * t - x * imk_sin(t));
    }
    return sum / points;
}
