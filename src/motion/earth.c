/* SPDX-License-Identifier: Apache-2.0 */
/* Rotation and normal gravity of the Earth, WGS84 [NIMA-TR8350.2, tables 3.1, 3.4 and eqs. 4-1,
 * 4-3]. */
#include "imukit/earth.h"

#include "imukit/elementary.h"
#include "wgs84_internal.h"

#include <math.h>

/* g0 = g_equator (1 + k s)/sqrt(1 - e^2 s),  s = sin^2(latitude)
 * g  = g0 [1 - 2 (1 + f + m - 2 f s) h/a + 3 (h/a)^2]                                    */
double imk_normal_gravity(double latitude, double height)
{
    double sine = imk_sin(latitude), s = sine * sine;
    double surface =
        EQUATOR_GRAVITY * (1.0 + GRAVITY_CONSTANT * s) / sqrt(1.0 - ECCENTRICITY_SQUARED * s);
    double relative = height / SEMI_MAJOR_AXIS;
    double slope = 2.0 * (1.0 + FLATTENING + ROTATION_RATIO - 2.0 * FLATTENING * s);
    return surface * (1.0 - slope * relative + 3.0 * relative * relative);
}

imk_vector3 imk_earth_rate(double latitude)
{
    return (imk_vector3){
        {IMK_EARTH_RATE * imk_cos(latitude), 0.0, -IMK_EARTH_RATE * imk_sin(latitude)}};
}
