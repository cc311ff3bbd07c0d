/* SPDX-License-Identifier: Apache-2.0 */
/* The way from one place to another in Earth-fixed axes. The difference of two positions of 6e6 m
 * has an error of 1e-9 m, which in a table at 1 kHz is 1e-3 m/s^2; so every difference is taken
 * where it is small. With d = lat - lat0, l = lon - lon0, W^2 = 1 - e^2 sin^2 lat, N = a/W,
 *
 *     N - N0        = a e^2 sin(lat + lat0) sin(d)/(W W0 (W + W0))
 *     p - p0        = (N - N0 + h - h0) cos lat - 2 (N0 + h0) sin((lat + lat0)/2) sin(d/2)
 *     z - z0        = ((1 - e^2)(N - N0) + h - h0) sin lat
 *                     + 2 ((1 - e^2) N0 + h0) cos((lat + lat0)/2) sin(d/2)
 *     along lon0    = (p - p0) - 2 p sin^2(l/2),       across it = p sin(l)
 *
 * p being the distance from the axis. */
#include "geodetic_difference_internal.h"

#include "imukit/elementary.h"
#include "motion/wgs84_internal.h"

#include <math.h>

static double root_of(double sine)
{
    return sqrt(1.0 - FIRST_ECCENTRICITY_SQUARED * sine * sine);
}

imk_vector3 imki_geodetic_difference(imk_geodetic from, imk_geodetic to)
{
    const double e2 = FIRST_ECCENTRICITY_SQUARED;
    const double d = to.latitude - from.latitude, l = to.longitude - from.longitude;
    const double sum = to.latitude + from.latitude, rise = to.height - from.height;
    const double sine = imk_sin(to.latitude), cosine = imk_cos(to.latitude);
    const double w = root_of(sine), w0 = root_of(imk_sin(from.latitude));
    const double n0 = SEMI_MAJOR_AXIS / w0, half = imk_sin(0.5 * d), turn = imk_sin(0.5 * l);
    const double dn = SEMI_MAJOR_AXIS * e2 * imk_sin(sum) * imk_sin(d) / (w * w0 * (w + w0));
    const double dp = (dn + rise) * cosine - 2.0 * (n0 + from.height) * imk_sin(0.5 * sum) * half;
    const double dz = ((1.0 - e2) * dn + rise) * sine +
                      2.0 * ((1.0 - e2) * n0 + from.height) * imk_cos(0.5 * sum) * half;
    const double p = (SEMI_MAJOR_AXIS / w + to.height) * cosine;
    const double along = dp - 2.0 * p * turn * turn, across = p * imk_sin(l);
    const double sl = imk_sin(from.longitude), cl = imk_cos(from.longitude);
    return (imk_vector3){{cl * along - sl * across, sl * along + cl * across, dz}};
}
