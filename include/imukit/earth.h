/* SPDX-License-Identifier: Apache-2.0 */
/** @file earth.h
 *  The Earth as inertial sensors see it: its rotation, and the normal gravity of the WGS84
 *  ellipsoid [NIMA-TR8350.2]. Real gravity differs from it by up to about 3e-3 m/s^2. */
#ifndef IMUKIT_EARTH_H
#define IMUKIT_EARTH_H

#include "imukit/attitude.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Rotation of the Earth in inertial space [rad/s], WGS84. */
#define IMK_EARTH_RATE 7.292115e-5

/** Magnitude of normal gravity [m/s^2] at a geodetic latitude [rad] and a height above the
 *  ellipsoid [m]: Somigliana's formula, and the expansion of second order in height (error below
 *  1e-6 m/s^2 up to 10 km). */
IMK_API double imk_normal_gravity(double latitude, double height);

/** The Earth's rotation in north-east-down axes [rad/s]. */
IMK_API imk_vector3 imk_earth_rate(double latitude);

#ifdef __cplusplus
}
#endif
#endif
