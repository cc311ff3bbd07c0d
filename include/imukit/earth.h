/* SPDX-License-Identifier: Apache-2.0 */
/** @file earth.h
 *  The Earth's rotation and the normal gravity of the WGS84 ellipsoid [NIMA-TR8350.2]. Real gravity
 *  differs from it by up to about 3e-3 m/s^2. */
#ifndef IMUKIT_EARTH_H
#define IMUKIT_EARTH_H

#include "imukit/attitude.h"

IMK_BEGIN_C

/** Rotation of the Earth in inertial space [rad/s], WGS84. */
#define IMK_EARTH_RATE 7.292115e-5

/** Normal gravity down the ellipsoid's normal [m/s^2] at a geodetic latitude [rad] and a height
 *  above the ellipsoid [m]: Somigliana's formula, and the expansion of second order in height
 *  (error below 1e-6 m/s^2 up to 10 km). The magnitude differs by less than 4e-10 m/s^2 up to
 *  10 km, as the component toward the equator is small; imk_gravity_ecef() has both. */
IMK_API double imk_normal_gravity(double latitude, double height);

/** The Earth's rotation in north-east-down axes [rad/s]. */
IMK_API imk_vector3 imk_earth_rate(double latitude);

/** A place on or near the WGS84 ellipsoid. */
typedef struct imk_geodetic {
    double latitude, longitude; /**< [rad] */
    double height;              /**< above the ellipsoid [m] */
} imk_geodetic;

/** Earth-centred, Earth-fixed coordinates [m]: x towards longitude 0, z along the axis. */
IMK_API imk_vector3 imk_ecef_from_geodetic(imk_geodetic place);

/** The inverse of imk_ecef_from_geodetic(), bit-reproducible, for heights from -10 km to 10000 km:
 *  error below 1e-15 rad in the angles, and in height some units in the last place of the distance
 *  from the centre: 4e-9 m up to 100 km, 1e-8 m up to 10000 km. At the poles the longitude is that
 *  of the point, 0 on the axis itself. Bowring's formula [BOWRING1985]. */
IMK_API imk_geodetic imk_geodetic_from_ecef(imk_vector3 position);

/** Normal gravity (gravitation and centrifugal force together) at an ECEF position, in ECEF axes
 *  [m/s^2]: imk_normal_gravity() down the ellipsoid's normal, and aloft a component toward the
 *  equator, 8.1e-9 1/s^2 times height and sin(2 latitude): 8.1e-5 m/s^2 at 10 km and 45 deg, zero
 *  on the ellipsoid. It is within 0.1 % of the closed ellipsoidal field from -10 to 1000 km and
 *  within 2 % up to 3600 km. Only + - * / sqrt. Motion and navigation both use this gravity, so
 *  they agree. Not valid within 6000 km of the centre. */
IMK_API imk_vector3 imk_gravity_ecef(imk_vector3 position);

/** Radii of curvature of the ellipsoid in the meridian and in the prime vertical [m]. */
IMK_API void imk_curvature_radii(double latitude, double *meridian, double *prime_vertical);

/** C_en: north, east and down at a place, as columns in ECEF axes. */
IMK_API imk_matrix3 imk_ned_axes(double latitude, double longitude);

/** North, east and down as a plumb line has them, along normal gravity, as columns in
 *  north-east-down axes: what levelling by gravity finds. Aloft they are turned about east by the
 *  component toward the equator, 8.3e-6 rad at 10 km and 45 deg; on the ellipsoid by nothing. */
IMK_API imk_matrix3 imk_plumb_axes(imk_geodetic place);

IMK_END_C
#endif
