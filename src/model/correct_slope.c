/* SPDX-License-Identifier: Apache-2.0 */
/* The response of one axis along its own input: the range of its slope
 *
 *     1 + s(T) + n'(u),   n'(u) = 2 K2 u + 2 Koq |u| + 3 K3 u^2 + sign(u) asymmetry/2 + …,
 *
 * and where it turns. The range of a temperature polynomial over its valid range is bounded by its
 * Bernstein coefficients: with T = minimum + t width and p = sum of c_k t^k,
 *
 *     b_j = sum over k <= j of C(j, k)/C(n, k) c_k,   min b <= p <= max b      [FAROUKI2012] */
#include "correct_internal.h"

#include <math.h>
#include <string.h>

static const double endless = INFINITY, not_a_number = NAN;

enum { ORDERS = IMK_TEMPERATURE_ORDER_MAX + 1, SLOPES = IMK_POWERS + 3 };

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

/* n' at |u| = a on one side as a sum of c_k a^k: of u^p |u|^q, n = p + q, it is n a^(n - 1), with
 * the sign of the side where p is even. @return how many */
static int slope_on_side(const imk_axis_response *axis, double side, double c[SLOPES])
{
    const int count = axis->powers + 1;
    for (int k = 0; k < count; k++) {
        const double square = k > 0 ? axis->power[0][k - 1] : 0.0;
        const double size = k < IMK_POWERS ? axis->power[1][k] : 0.0;
        c[k] = (k + 1) * (k % 2 ? side * square + size : square + side * size);
    }
    return count;
}

/* Sum of c_k a^k, differentiated `order` times. */
static double derivative_at(int count, const double *c, int order, double a)
{
    double sum = 0.0;
    for (int k = order; k < count; k++) {
        double term = c[k];
        for (int j = 0; j < order; j++)
            term *= k - j;
        for (int j = order; j < k; j++)
            term *= a;
        sum += term;
    }
    return sum;
}

static double zero_between(int count, const double *c, int order, double low, double high)
{
    const bool falls = derivative_at(count, c, order, low) > 0.0;
    for (int step = 0; step < 100; step++) {
        const double middle = 0.5 * (low + high);
        if ((derivative_at(count, c, order, middle) > 0.0) == falls)
            low = middle;
        else
            high = middle;
    }
    return high;
}

/* Where a polynomial, differentiated `order` times, is 0 between 0 and the limit, ascending. The
 * zeros of each derivative bound the pieces on which the one below it is monotonic. */
static int zeros_within(int count, const double *c, int order, double limit, double zero[SLOPES])
{
    int found = 0;
    for (int now = count - 2; now >= order; now--) {
        double low = 0.0, next[SLOPES];
        int zeros = 0;
        for (int k = 0; k <= found; k++) {
            const double high = k < found ? zero[k] : limit;
            if ((derivative_at(count, c, now, low) > 0.0) !=
                (derivative_at(count, c, now, high) > 0.0))
                next[zeros++] = zero_between(count, c, now, low, high);
            low = high;
        }
        memcpy(zero, next, (size_t)zeros * sizeof *zero);
        found = zeros;
    }
    return found;
}

/* Where a slope has its extremes, besides both ends. */
static int turns_within(int count, const double *c, double limit, double turn[SLOPES])
{
    if (count > 3)
        return zeros_within(count, c, 1, limit, turn);
    turn[0] = count == 3 ? -(0.5 * c[1]) / c[2] : 0.0;
    return turn[0] > 0.0 && turn[0] < limit;
}

imki_interval imki_slope(const imk_axis_response *axis, double limit)
{
    double lower = 0.0, upper = 0.0;
    if (axis->has_nonlinearity) {
        lower = endless;
        upper = -endless;
        for (int side = -1; side <= 1; side += 2) {
            double c[SLOPES], place[SLOPES];
            const int count = slope_on_side(axis, side, c);
            int places = turns_within(count, c, limit, place);
            place[places++] = 0.0;
            place[places++] = limit;
            for (int i = 0; i < places; i++) {
                lower = fmin(lower, derivative_at(count, c, 0, place[i]));
                upper = fmax(upper, derivative_at(count, c, 0, place[i]));
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
        double c[SLOPES] = {0.0}, zero[SLOPES];
        const int count = slope_on_side(axis, side, c);
        c[0] += 1.0 + axis->scale + coldest + linear;
        double a = first_root(c[0], c[1], c[2]);
        if (count > 3 && a > 0.0)
            a = zeros_within(count, c, 0, limit, zero) > 0 ? zero[0] : endless;
        if (a < nearest) {
            nearest = a;
            sign = side;
        }
    }
    return nearest <= limit ? sign * nearest : not_a_number;
}
