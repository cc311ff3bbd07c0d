/* SPDX-License-Identifier: Apache-2.0 */
/* Places on the WGS84 ellipsoid: geodetic and Earth-fixed coordinates, the local axes, curvature
 * and the vector of normal gravity. */
#include "imukit/earth.h"

#include "imukit/elementary.h"

#include <math.h>

typedef double real;

static inline real square_root(real a)
{
    return sqrt(a);
}

#include "gravity_kernel.h"

/* N = a/sqrt(1 - e^2 sin^2),   x, y = (N + h) cos,   z = (N (1 - e^2) + h) sin */
imk_vector3 imk_ecef_from_geodetic(imk_geodetic place)
{
    const double sine = imk_sin(place.latitude), cosine = imk_cos(place.latitude);
    const double normal = SEMI_MAJOR_AXIS / sqrt(1.0 - FIRST_ECCENTRICITY_SQUARED * (sine * sine));
    const double across = (normal + place.height) * cosine;
    const double along = (normal * (1.0 - FIRST_ECCENTRICITY_SQUARED) + place.height) * sine;
    return (imk_vector3){
        {across * imk_cos(place.longitude), across * imk_sin(place.longitude), along}};
}

imk_geodetic imk_geodetic_from_ecef(imk_vector3 position)
{
    const double x = position.v[0], y = position.v[1], z = position.v[2];
    const double pp = x * x + y * y;
    const slope vertical = vertical_at(pp, z);
    return (imk_geodetic){
        .latitude = imk_atan2(vertical.s, vertical.k * sqrt(pp)),
        .longitude = pp > 0.0 ? imk_atan2(y, x) : 0.0,
        .height = height_along(vertical, pp, z),
    };
}

imk_vector3 imk_gravity_ecef(imk_vector3 position)
{
    imk_vector3 gravity;
    gravity_at(position.v, gravity.v);
    return gravity;
}

/* M = a (1 - e^2)/(1 - e^2 sin^2)^(3/2),   N = a/(1 - e^2 sin^2)^(1/2) */
void imk_curvature_radii(double latitude, double *meridian, double *prime_vertical)
{
    const double sine = imk_sin(latitude);
    const double square = 1.0 - FIRST_ECCENTRICITY_SQUARED * (sine * sine);
    *prime_vertical = SEMI_MAJOR_AXIS / sqrt(square);
    *meridian = *prime_vertical * ((1.0 - FIRST_ECCENTRICITY_SQUARED) / square);
}

imk_matrix3 imk_ned_axes(double latitude, double longitude)
{
    const double sp = imk_sin(latitude), cp = imk_cos(latitude);
    const double sl = imk_sin(longitude), cl = imk_cos(longitude);
    return (imk_matrix3){{{-sp * cl, -sl, -cp * cl}, {-sp * sl, cl, -cp * sl}, {cp, 0.0, -sp}}};
}

imk_matrix3 imk_plumb_axes(imk_geodetic place)
{
    place.longitude = 0.0;
    const imk_vector3 gravity =
        imk_matrix3_apply(imk_matrix3_transpose(imk_ned_axes(place.latitude, 0.0)),
                          imk_gravity_ecef(imk_ecef_from_geodetic(place)));
    const double g = imk_vector3_norm(gravity), c = gravity.v[2] / g, s = gravity.v[0] / g;
    return (imk_matrix3){{{c, 0.0, s}, {0.0, 1.0, 0.0}, {-s, 0.0, c}}};
}
