/* SPDX-License-Identifier: Apache-2.0 */
/* The vertical and normal gravity at an Earth-fixed position without trigonometric functions, for
 * `real` a double or a vector of them. No include guard: define first
 *
 *     real               the type; + - * / with itself and with doubles
 *     square_root(a)     correctly rounded
 *
 * The latitude by Bowring's formula [BOWRING1985] from the parametric latitude u,
 *
 *     tan(latitude) = (z + e'^2 b sin^3 u)/(p - e^2 a cos^3 u)
 *
 * p being the distance from the axis: an error of u comes out with 0.002 of its square. With
 * D^2 = a^2 sin^2 u + b^2 cos^2 u,
 *
 *     tan u = z (a D + b h)/(p (b D + a h))
 *
 * exactly, as z = b sin u + h sin(latitude) = (b + h a/D) sin u and likewise p; and
 * to 1e-7 rad with the sine z/r in place of sin u,
 *
 *     D = b + (a - b) z^2/r^2,   h = r - a + (a - b) z^2/r^2
 *
 * so that one pass is exact to rounding. Tangents are kept as S/(K p), with K instead of the
 * cosine: nothing is divided by p, and the poles are not special. */
#include "motion/wgs84_internal.h"

/* e'^2 b and e^2 a [m] */
#define POLAR_EXCESS (FIRST_ECCENTRICITY_SQUARED * SEMI_MAJOR_AXIS / (1.0 - FLATTENING))
#define EQUATOR_EXCESS (FIRST_ECCENTRICITY_SQUARED * SEMI_MAJOR_AXIS)

/* tan(latitude) = s/(k p) */
typedef struct slope {
    real s, k;
} slope;

static inline slope parametric_slope(real pp, real z)
{
    const real square = pp + z * z;
    const real bulge = (SEMI_MAJOR_AXIS - SEMI_MINOR_AXIS) * (z * z / square);
    const real d = SEMI_MINOR_AXIS + bulge;
    const real height = square_root(square) - SEMI_MAJOR_AXIS + bulge;
    return (slope){z * (SEMI_MAJOR_AXIS * d + SEMI_MINOR_AXIS * height),
                   SEMI_MINOR_AXIS * d + SEMI_MAJOR_AXIS * height};
}

/* Sine of the angle, and its cosine by p. */
static inline slope normalised(slope tangent, real pp)
{
    const real inverse = 1.0 / square_root(tangent.s * tangent.s + tangent.k * tangent.k * pp);
    return (slope){tangent.s * inverse, tangent.k * inverse};
}

static inline slope geodetic_slope(real pp, real z)
{
    const slope u = normalised(parametric_slope(pp, z), pp);
    return (slope){z + POLAR_EXCESS * (u.s * u.s * u.s),
                   1.0 - EQUATOR_EXCESS * (u.k * u.k * u.k) * pp};
}

/* Height above the ellipsoid, p cos + z sin - a sqrt(1 - e^2 sin^2): an error of the latitude
 * matters with its square only. `vertical` is normalised. */
static inline real height_along(slope vertical, real pp, real z)
{
    const real root = square_root(1.0 - FIRST_ECCENTRICITY_SQUARED * (vertical.s * vertical.s));
    return pp * vertical.k + z * vertical.s - SEMI_MAJOR_AXIS * root;
}

/* Normal gravity, along the ellipsoid's normal; the magnitude as in imk_normal_gravity(). */
static inline void gravity_at(const real position[3], real gravity[3])
{
    const real x = position[0], y = position[1], z = position[2];
    const real pp = x * x + y * y;
    const slope vertical = normalised(geodetic_slope(pp, z), pp);
    const real s = vertical.s * vertical.s;
    const real relative = height_along(vertical, pp, z) * (1.0 / SEMI_MAJOR_AXIS);
    const real surface = EQUATOR_GRAVITY * (1.0 + GRAVITY_CONSTANT * s) /
                         square_root(1.0 - ECCENTRICITY_SQUARED * s);
    const real change = 2.0 * (1.0 + FLATTENING + ROTATION_RATIO - 2.0 * FLATTENING * s);
    const real magnitude = surface * (1.0 - change * relative + 3.0 * (relative * relative));
    const real across = magnitude * vertical.k;
    gravity[0] = -(across * x);
    gravity[1] = -(across * y);
    gravity[2] = -(magnitude * vertical.s);
}
