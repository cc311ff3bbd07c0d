/* SPDX-License-Identifier: Apache-2.0 */
/* The error of a displayed attitude. A display shows C_lb = C_le C_eb, l being the local level at
 * the position that the navigator believes in. With ^ for what it believes, the error is the
 * rotation
 *
 *     R = C_lb^ C_lb^T = C_le^ exp([psi x]) C_el,   C_eb^ = exp([psi x]) C_eb
 *
 * and to first order the rotation vector phi = psi - dtheta, dtheta being what the position error
 * turns the level by. With dN, dE of it, the radii of curvature M and N, latitude L and height h,
 * north-east-down axes turn by [BRITTING1971]
 *
 *     dtheta = (dE/(N + h), -dN/(M + h), -tan(L) dE/(N + h)).
 *
 * Near a pole l is turned about the vertical by the longitude, so that its first axis keeps the
 * direction of the meridian of longitude 0 over the pole: north and the singular part of dtheta,
 * -sin(L) times the change of the longitude, go, and cos(L)/(1 + |sin L|) stands for tan(L). */
#include "imukit/navigate.h"

#include "imukit/elementary.h"

#include <math.h>

static const double grid_latitude = IMK_GRID_LATITUDE;

static bool by_grid(double latitude)
{
    return fabs(latitude) > grid_latitude;
}

imk_matrix3 imk_level_turn(imk_geodetic place)
{
    double meridian, prime_vertical;
    imk_curvature_radii(place.latitude, &meridian, &prime_vertical);
    const double north = 1.0 / (meridian + place.height);
    const double east = 1.0 / (prime_vertical + place.height);
    const double sine = imk_sin(place.latitude), cosine = imk_cos(place.latitude);
    const double down = by_grid(place.latitude)
                            ? (sine < 0.0 ? -cosine : cosine) / (1.0 + fabs(sine))
                            : -sine / cosine;
    return (imk_matrix3){{{0.0, east, 0.0}, {-north, 0.0, 0.0}, {0.0, down * east, 0.0}}};
}

/* North-east-down to the axes of the display, about down: by the longitude from east to west
 * around the north pole. */
static imk_quaternion display_turn(bool grid, imk_geodetic place)
{
    const double angle = !grid ? 0.0 : place.latitude < 0.0 ? -place.longitude : place.longitude;
    return (imk_quaternion){imk_cos(0.5 * angle), 0.0, 0.0, imk_sin(0.5 * angle)};
}

/* q_el at a place: `grid` says which level. */
static imk_quaternion level_at(bool grid, imk_geodetic place)
{
    return imk_quaternion_multiply(
        imk_quaternion_from_matrix(imk_ned_axes(place.latitude, place.longitude)),
        display_turn(grid, place));
}

/* R = S T, T about down and S about an axis across: then the angle of S is that by which the
 * displayed vertical is wrong, whatever the heading. */
imk_vector3 imk_displayed_attitude_error(const imk_navigation_state *estimate,
                                         const imk_navigation_state *truth)
{
    const imk_geodetic place = imk_geodetic_from_ecef(truth->position);
    const bool grid = by_grid(place.latitude);
    const imk_quaternion there = level_at(grid, imk_geodetic_from_ecef(estimate->position));
    const imk_quaternion here = level_at(grid, place);
    const imk_quaternion turn =
        imk_quaternion_multiply(estimate->attitude, imk_quaternion_conjugate(truth->attitude));
    imk_quaternion r = imk_quaternion_multiply(
        imk_quaternion_multiply(imk_quaternion_conjugate(there), turn), here);
    if (r.w < 0.0 || (r.w == 0.0 && r.z < 0.0))
        r = (imk_quaternion){-r.w, -r.x, -r.y, -r.z};
    const double length = sqrt(r.w * r.w + r.z * r.z);
    const double c = length > 0.0 ? r.w / length : 1.0, s = length > 0.0 ? r.z / length : 0.0;
    const imk_quaternion tilt = {length, r.x * c - r.y * s, r.x * s + r.y * c, 0.0};
    imk_vector3 phi =
        imk_quaternion_rotate(display_turn(grid, place), imk_quaternion_to_rotation_vector(tilt));
    phi.v[2] = 2.0 * imk_atan2(s, c);
    return phi;
}

imk_quaternion imk_displayed_attitude(const imk_navigation_state *truth, imk_vector3 position,
                                      imk_vector3 phi)
{
    const imk_geodetic place = imk_geodetic_from_ecef(truth->position);
    const bool grid = by_grid(place.latitude);
    const imk_quaternion there = level_at(grid, imk_geodetic_from_ecef(position));
    const imk_quaternion here = level_at(grid, place);
    const imk_vector3 across = {{phi.v[0], phi.v[1], 0.0}}, about = {{0.0, 0.0, phi.v[2]}};
    const imk_quaternion tilt = imk_quaternion_from_rotation_vector(
        imk_quaternion_rotate(imk_quaternion_conjugate(display_turn(grid, place)), across));
    const imk_quaternion r =
        imk_quaternion_multiply(tilt, imk_quaternion_from_rotation_vector(about));
    return imk_quaternion_multiply(
        imk_quaternion_multiply(imk_quaternion_multiply(there, r), imk_quaternion_conjugate(here)),
        truth->attitude);
}
