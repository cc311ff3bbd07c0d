/* SPDX-License-Identifier: Apache-2.0 */
/* The vertical and normal gravity at an Earth-fixed position without trigonometric functions, with
 * one root and one division, for `real` a double or a vector of them. No include guard: define
 * first
 *
 *     real               the type; + - * / with itself and with doubles
 *     square_root(a)     correctly rounded
 *
 * The latitude by Bowring's formula [BOWRING1985] from the parametric latitude u,
 *
 *     tan(latitude) = (z + e'^2 b sin^3 u)/(p - e^2 a cos^3 u)
 *
 * p being the distance from the axis: an error of u comes out with 0.002 of its square. Exactly,
 * with D^2 = a^2 sin^2 u + b^2 cos^2 u and the height h above the ellipsoid,
 *
 *     tan u = z (a D + b h)/(p (b D + a h))
 *
 * as z = b sin u + h sin(latitude) = (b + h a/D) sin u and likewise p. To 1e-7 rad the sine z/r
 * stands for sin u in
 *
 *     D = b + (a - b) z^2/r^2,   h = r - a + (a - b) z^2/r^2
 *
 * so that one pass is exact to rounding; and with these
 *
 *     b D + a h = a r - (a^2 - b^2) p^2/r^2 = a r (1 - n)
 *     tan u = (1 + w) z/p,   w = (a - b)(a + b - r)/(a r (1 - n))
 *
 * where n and w are below 0.007, and an error of 1e-9 in w is one of 1e-9 rad in u.
 *
 * Every direction is kept as its sine and as its cosine by p: nothing is divided by p, and the
 * poles are not special. Normalised they are by the power series of (1 + x)^(-1/2), as their
 * lengths are known to 0.014. */
#include "wgs84_internal.h"

/* e'^2 b and e^2 a [m] */
#define POLAR_EXCESS (FIRST_ECCENTRICITY_SQUARED * SEMI_MAJOR_AXIS / (1.0 - FLATTENING))
#define EQUATOR_EXCESS (FIRST_ECCENTRICITY_SQUARED * SEMI_MAJOR_AXIS)

/* 2 c0 … of g_north in gravity_along() [1/s^2] */
#define MERIDIAN_GRAVITY_0 16.29722e-9
#define MERIDIAN_GRAVITY_1 -12.0032e-9
#define MERIDIAN_GRAVITY_2 5.7534e-9
#define MERIDIAN_GRAVITY_S -15.822e-12

/* A direction in the meridian: its sine, and its cosine by p. */
typedef struct slope {
    real s, k;
} slope;

/* (1 + x)^(-1/2) - 1 for |x| < 0.015: the next term is below 1e-17. Summed in pairs, as the terms
 * of one chain would wait for one another. */
static inline real root_deficit(real x)
{
    const real xx = x * x;
    const real low = 3.0 / 8.0 - 5.0 / 16.0 * x;
    const real middle = 35.0 / 128.0 - 63.0 / 256.0 * x;
    const real high = (231.0 / 1024.0 - 429.0 / 2048.0 * x) + 6435.0 / 32768.0 * xx;
    return xx * (low + xx * (middle + xx * high)) - 0.5 * x;
}

/* u, from z and 1/r */
static inline slope parametric_slope(real z, real inverse)
{
    const real sine = z * inverse, q = sine * sine;
    const real n = EQUATOR_EXCESS * inverse * (1.0 - q);
    const real excess = FLATTENING * ((SEMI_MAJOR_AXIS + SEMI_MINOR_AXIS) * inverse - 1.0);
    const real w = excess + excess * (n + n * n);
    const real length = 1.0 + root_deficit((2.0 + w) * w * q);
    return (slope){(sine + sine * w) * length, inverse * length};
}

/* The vertical, from u and 1/r. With its sine and cosine s = z + ds, k p = p - dk p before they are
 * normalised, s^2 + (k p)^2 = r^2 (1 + x). */
static inline slope vertical_from(slope u, real pp, real z, real inverse)
{
    const real ds = POLAR_EXCESS * (u.s * u.s * u.s);
    const real dk = EQUATOR_EXCESS * (u.k * u.k * u.k) * pp;
    const real x = ((2.0 * z + ds) * ds - (2.0 - dk) * dk * pp) * (inverse * inverse);
    const real length = inverse + inverse * root_deficit(x);
    return (slope){(z + ds) * length, (1.0 - dk) * length};
}

static inline slope vertical_at(real pp, real z)
{
    const real inverse = 1.0 / square_root(pp + z * z);
    return vertical_from(parametric_slope(z, inverse), pp, z, inverse);
}

/* Height above the ellipsoid, p cos + z sin - a sqrt(1 - e^2 sin^2): an error of the latitude
 * matters with its square only. */
static inline real height_along(slope vertical, real pp, real z)
{
    const real bulge = FIRST_ECCENTRICITY_SQUARED * (vertical.s * vertical.s);
    const real deficit = root_deficit(-bulge);
    const real root = 1.0 + (deficit - (bulge + bulge * deficit));
    return pp * vertical.k + z * vertical.s - SEMI_MAJOR_AXIS * root;
}

/* Normal gravity. Down as in imk_normal_gravity(), but for 2e-16 of it, as one e^2 serves the
 * height and the magnitude. Toward the equator, as the vertical turns with the height
 * [HEISKANEN1967, sec. 2-8],
 *
 *     g_north = -h sin(2 latitude) (c0 + c1 h/a + c2 (h/a)^2 + c3 s),   s = sin^2(latitude)
 *
 * whose coefficients are fitted to the closed form in ellipsoidal coordinates [NIMA-TR8350.2,
 * sec. 4]: to 5e-4 of it up to 1000 km and to 1.1 % up to 4000 km. Near the ellipsoid it is what a
 * field without curl needs, -1/M of the latitude's derivative of the integral of the magnitude. */
static inline void gravity_along(slope vertical, real height, const real position[3],
                                 real gravity[3])
{
    const real s = vertical.s * vertical.s;
    const real relative = height * (1.0 / SEMI_MAJOR_AXIS);
    const real inverse_root = 1.0 + root_deficit(-(FIRST_ECCENTRICITY_SQUARED * s));
    const real surface = EQUATOR_GRAVITY * (1.0 + GRAVITY_CONSTANT * s) * inverse_root;
    const real change = 2.0 * (1.0 + FLATTENING + ROTATION_RATIO - 2.0 * FLATTENING * s);
    const real magnitude = surface * (1.0 - change * relative + 3.0 * (relative * relative));
    /* g_north = -bend sin cos;  north is -(s k x, s k y) across the axis, k p along it */
    const real bend = height * ((MERIDIAN_GRAVITY_0 + MERIDIAN_GRAVITY_S * s) +
                                relative * (MERIDIAN_GRAVITY_1 + MERIDIAN_GRAVITY_2 * relative));
    const real across = (magnitude - s * bend) * vertical.k;
    gravity[0] = -(across * position[0]);
    gravity[1] = -(across * position[1]);
    gravity[2] = -((magnitude + (1.0 - s) * bend) * vertical.s);
}

static inline void gravity_at(const real position[3], real gravity[3])
{
    const real pp = position[0] * position[0] + position[1] * position[1];
    const slope vertical = vertical_at(pp, position[2]);
    gravity_along(vertical, height_along(vertical, pp, position[2]), position, gravity);
}
