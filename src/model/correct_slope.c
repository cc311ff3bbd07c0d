/* SPDX-License-Identifier: Apache-2.0 */
/* The response of one axis along its own input: the range of its slope
 *
 *     1 + s(T) + n'(u),   n'(u) = 2 K2 u + 2 Koq |u| + 3 K3 u^2 + sign(u) asymmetry/2,
 *
 * and where it turns. The range of a temperature polynomial over its valid range is bounded by its
 * Bernstein coefficients: with T = minimum + t width and p = sum of c_k t^k,
 *
 *     b_j = sum over k <= j of C(j, k)/C(n, k) c_k,   min b <= p <= max b      [FAROUKI2012] */
#include "correct_internal.h"

#include <math.h>

static const double endless = INFINITY, not_a_number = NAN;

enum { ORDERS = IMK_TEMPERATURE_ORDER_MAX + 1 };

static double binomial(int n, int k)
{
    double product = 1.0;
    for (int i = 1; i <= k; i++)
        product = product * (n - k + i) / i;
    return product;
}

void imki_scale_range(const imk_axis_response *axis, double *lower, double *upper)
{
    const int n = axis->scale_order;
    const double start = axis->scale_minimum - axis->scale_reference;
    const double width = axis->scale_maximum - axis->scale_minimum;
    double c[ORDERS] = {0.0};
    *lower = *upper = 0.0; /* without temperature */
    /* Horner's rule on polynomials in t: p <- (p + a_k)(start + width t). */
    for (int k = n - 1; k >= 0; k--) {
        c[0] += axis->scale_temperature[k];
        for (int j = n; j > 0; j--)
            c[j] = c[j] * start + c[j - 1] * width;
        c[0] *= start;
    }
    for (int j = 0; n > 0 && j <= n; j++) {
        double b = 0.0;
        for (int k = 0; k <= j; k++)
            b += binomial(j, k) / binomial(n, k) * c[k];
        *lower = fmin(*lower, b);
        *upper = fmax(*upper, b);
    }
}

/* n' at |u| = a on one side. */
static double slope_at(const imk_axis_response *axis, double side, double a)
{
    return side * axis->half_asymmetry + 2.0 * (side * axis->k2 + axis->koq) * a +
           3.0 * axis->k3 * a * a;
}

imki_interval imki_slope(const imk_axis_response *axis, double limit)
{
    double lower = 0.0, upper = 0.0;
    if (axis->has_nonlinearity) {
        lower = endless;
        upper = -endless;
        for (int side = -1; side <= 1; side += 2) {
            const double vertex = -(side * axis->k2 + axis->koq) / (3.0 * axis->k3);
            const double places[3] = {0.0, limit, vertex > 0.0 && vertex < limit ? vertex : 0.0};
            for (int i = 0; i < 3; i++) {
                lower = fmin(lower, slope_at(axis, side, places[i]));
                upper = fmax(upper, slope_at(axis, side, places[i]));
            }
        }
    }
    double coldest, warmest;
    imki_scale_range(axis, &coldest, &warmest);
    lower += axis->scale + coldest;
    upper += axis->scale + warmest;
    return (imki_interval){0.5 * (lower + upper), 0.5 * (upper - lower)};
}

/* Smallest a >= 0 where c0 + c1 a + c2 a^2 <= 0; infinity when there is none. */
static double first_root(double c0, double c1, double c2)
{
    if (!(c0 > 0.0))
        return 0.0;
    const double discriminant = c1 * c1 - 4.0 * c0 * c2;
    if (!(discriminant >= 0.0))
        return endless;
    /* c0 over this is the root of the smaller size, and the one wanted when it is positive; else
     * the parabola is positive up to the other one, if that is. */
    const double q = -0.5 * (c1 + (c1 < 0.0 ? -1.0 : 1.0) * sqrt(discriminant));
    const double small = q != 0.0 ? c0 / q : endless, large = c2 != 0.0 ? q / c2 : endless;
    if (small > 0.0)
        return large > 0.0 && large < small ? large : small;
    return large > 0.0 ? large : endless;
}

double imki_turning_point(const imk_axis_response *axis, double linear, double limit)
{
    double coldest, warmest, nearest = endless, sign = 0.0;
    imki_scale_range(axis, &coldest, &warmest);
    for (int side = -1; side <= 1; side += 2) {
        const double a =
            first_root(1.0 + axis->scale + coldest + linear + side * axis->half_asymmetry,
                       2.0 * (side * axis->k2 + axis->koq), 3.0 * axis->k3);
        if (a < nearest) {
            nearest = a;
            sign = side;
        }
    }
    return nearest <= limit ? sign * nearest : not_a_number;
}
