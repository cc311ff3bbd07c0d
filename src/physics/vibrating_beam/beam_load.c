/* SPDX-License-Identifier: Apache-2.0 */
/* The frequency of a clamped beam under an axial load, by its characteristic equation.
 *
 * Of E I w'''' - N w'' = rho A w_t^2 w, with the middle as origin, the symmetric modes are
 * cosh(2 s x/L)/cosh(s) - cos(2 t x/L)/cos(t). With n = N L^2/(E I) they have
 *
 *     s^2 - t^2 = n/4,   w_t^2 rho A L^4/(E I) = 16 s^2 t^2,
 *
 * and the clamps ask for s tanh s + t tan t = 0 [TIMOSHENKO1974]. The first mode has t between pi/2
 * (a string) and pi (s = 0: the beam buckles, n = -4 pi^2).
 *
 * With A(z) = sqrt(z) tanh(sqrt(z)), which is -t tan t at z = -t^2, the clamps ask for A(a) = A(b),
 * a = s^2, b = -t^2 = n/4 - a. From 2 z A' = A + z - A^2 follow all derivatives of A, and from
 * these those of a and of the square of the frequency, 16 s^2 t^2, with respect to n. */
#include "imukit/elementary.h"
#include "vibrating_beam_internal.h"

#include <math.h>

/* s tanh s */
static double s_tanh(double s)
{
    if (s > 20.0)
        return s;
    const double grown = imk_expm1(2.0 * s);
    return s * grown / (grown + 2.0);
}

/* t of the first mode: the root of s tanh s cos t + t sin t, which falls from t at the string's end
 * to below 0 at pi; Newton's steps, halved where they would leave the bracket. */
static double mode_of(double n)
{
    double low = 0.5 * IMKI_PI, high = IMKI_PI;
    if (-0.25 * n > low * low)
        low = sqrt(-0.25 * n);
    double t = 0.5 * (low + high);
    for (int i = 0; i < 100; i++) {
        const double square = t * t + 0.25 * n, s = sqrt(square > 0.0 ? square : 0.0);
        const double q = s_tanh(s), c = imk_cos(t), sine = imk_sin(t);
        const double value = q * c + t * sine;
        if (value > 0.0)
            low = t;
        else
            high = t;
        /* d(s tanh s)/dt = 2 t A'(s^2), and A'(0) = 1 */
        const double rise = square > 0.0 ? (q + square - q * q) / square * t : 2.0 * t;
        const double slope = rise * c - q * sine + sine + t * c;
        const double next = t - value / slope;
        if (fabs(next - t) <= 4e-16 * t)
            return next;
        t = next > low && next < high ? next : 0.5 * (low + high);
    }
    return t;
}

/* The first three derivatives of A at z. */
static void derivatives(double a, double z, double *d)
{
    const double half = 0.5 / z;
    d[0] = (a + z - a * a) * half;
    d[1] = (1.0 - d[0] - 2.0 * a * d[0]) * half;
    d[2] = -(3.0 * d[1] + 2.0 * d[0] * d[0] + 2.0 * a * d[1]) * half;
}

imki_beam_load imki_beam_load_at(double n)
{
    const double x = IMKI_BEAM_ROOT * IMKI_BEAM_ROOT, scale = 16.0 / (x * x);
    if (!(n > -IMKI_BEAM_BUCKLING))
        return (imki_beam_load){0.0, 0.0, 0.0, 0.0};
    const double t = mode_of(n), lower = t * t, upper = lower + 0.25 * n;
    if (!(upper > 0.0)) /* the last digits before it buckles */
        return (imki_beam_load){0.0, 0.0, 0.0, 0.0};
    const double a = s_tanh(sqrt(upper));
    double p[3], r[3];
    derivatives(a, upper, p);
    derivatives(a, -lower, r);
    /* of upper; that of -lower is 1/4 less it */
    const double sum = p[0] + r[0], u = 0.25 * r[0] / sum, v = 0.25 - u;
    const double u2 = (r[1] * v * v - p[1] * u * u) / sum;
    const double u3 =
        (r[2] * v * v * v - 3.0 * r[1] * v * u2 - p[2] * u * u * u - 3.0 * p[1] * u * u2) / sum;
    /* divided, the square is 1 to the last digit without a load */
    return (imki_beam_load){16.0 * (upper * lower) / (x * x), scale * (u * lower - upper * v),
                            scale * (u2 * (upper + lower) - 2.0 * u * v),
                            scale * (u3 * (upper + lower) + 3.0 * u2 * (u - v))};
}

/* Interpolation at the extrema of a Chebyshev polynomial [CHENEY1966], put out in powers of n over
 * its largest value: the terms fall by eight from one to the next, so that no digits are lost. */
void imki_load_series_make(double *coefficient)
{
    enum { LAST = IMKI_LOAD_TERMS - 1 };
    double value[IMKI_LOAD_TERMS];
    double power[IMKI_LOAD_TERMS] = {1.0}, before[IMKI_LOAD_TERMS] = {0.0, 1.0}; /* of T_0, T_-1 */
    for (int k = 0; k <= LAST; k++) {
        value[k] = imki_beam_load_at(IMKI_BEAM_LOAD_MAX * imk_cos(IMKI_PI * k / LAST)).square;
        coefficient[k] = 0.0;
    }
    for (int j = 0; j <= LAST; j++) {
        double sum = 0.0;
        for (int k = 0; k <= LAST; k++)
            sum += (k == 0 || k == LAST ? 0.5 : 1.0) * value[k] *
                   imk_cos(IMKI_PI * (j * k % (2 * LAST)) / LAST);
        sum *= (j == 0 || j == LAST ? 1.0 : 2.0) / LAST;
        for (int k = 0; k <= j; k++)
            coefficient[k] += sum * power[k];
        for (int k = LAST; k >= 0; k--) { /* the next is 2 x T_j - T_(j-1) */
            const double next = (k > 0 ? 2.0 * power[k - 1] : 0.0) - before[k];
            before[k] = power[k];
            power[k] = next;
        }
    }
}
