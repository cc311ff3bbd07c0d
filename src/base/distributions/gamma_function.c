/* SPDX-License-Identifier: Apache-2.0 */
/* log Gamma(x) to double precision:
 *
 *   near 2    log Gamma(2 + z) = (1 - gamma) z + sum_{k>=2} (-1)^k (zeta(k) - 1) z^k / k,
 *                                                             |z| <= 1/2   [ABRAMOWITZ1964, 6.1.33]
 *   x < 10    from there by Gamma(x + 1) = x Gamma(x)
 *   x >= 10   Stirling's series                                            [ABRAMOWITZ1964, 6.1.41]
 *
 * libm's lgamma() would write the global signgam. */
#include "imukit/distributions.h"
#include "imukit/elementary.h"

#include "gamma_internal.h"

#include <math.h>

/* log Gamma(2 + z), |z| <= 1/2. The terms fall as 4^-k. Coefficients: tests/reference/
 * distributions.py tables. */
static double log_gamma_two_plus(double z)
{
    static const double coefficient[] = {
        0.3224670334241132,     -0.0673523010531981,     0.020580808427784546,
        -0.007385551028673986,  0.0028905103307415234,   -0.001192753911703261,
        0.0005096695247430425,  -0.00022315475845357939, 9.945751278180853e-05,
        -4.492623673813314e-05, 2.050721277567069e-05,   -9.439488275268397e-06,
        4.374866789907488e-06,  -2.039215753801366e-06,  9.55141213040742e-07,
        -4.492469198764566e-07, 2.1207184805554665e-07,  -1.0043224823968099e-07,
        4.7698101693639804e-08, -2.2711094608943164e-08, 1.0838659214896955e-08,
        -5.183475041970047e-09, 2.4836745438024785e-09,  -1.1921401405860912e-09};
    const double one_minus_euler = 0.42278433509846713;
    double sum = 0.0;
    for (int k = (int)(sizeof coefficient / sizeof coefficient[0]) - 1; k >= 0; k--)
        sum = (sum + coefficient[k]) * z;
    return z * (one_minus_euler + sum);
}

double imki_log_gamma_one_plus(double x)
{
    if (x > 0.5)
        return log_gamma_two_plus(x - 1.0);
    return log_gamma_two_plus(x) - imk_ln1p(x);
}

double imki_stirling_error(double x)
{
    static const double coefficient[] = {1.0 / 12.0,    -1.0 / 360.0,      1.0 / 1260.0,
                                         -1.0 / 1680.0, 1.0 / 1188.0,      -691.0 / 360360.0,
                                         1.0 / 156.0,   -3617.0 / 122400.0};
    const double inverse_square = 1.0 / x / x;
    double sum = 0.0;
    for (int k = (int)(sizeof coefficient / sizeof coefficient[0]) - 1; k >= 0; k--)
        sum = sum * inverse_square + coefficient[k];
    return sum / x;
}

double imk_log_gamma(double x)
{
    const double half_log_two_pi = 0.91893853320467274178;
    if (!(x > 0.0))
        return (double)NAN;
    if (x < 0.5)
        return imki_log_gamma_one_plus(x) - imk_ln(x);
    if (x <= 2.5)
        return imki_log_gamma_one_plus(x - 1.0);
    if (x >= 10.0) {
        const double series = x < 1e17 ? half_log_two_pi - x + imki_stirling_error(x) : -x;
        return (x - 0.5) * imk_ln(x) + series;
    }
    double product = 1.0;
    while (x > 2.5) {
        x -= 1.0;
        product *= x;
    }
    return log_gamma_two_plus(x - 2.0) + imk_ln(product);
}
