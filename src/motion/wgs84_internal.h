/* SPDX-License-Identifier: Apache-2.0 */
/* Constants of WGS84 [NIMA-TR8350.2, tables 3.1, 3.3 and 3.4]. */
#ifndef IMUKIT_WGS84_INTERNAL_H
#define IMUKIT_WGS84_INTERNAL_H

#define SEMI_MAJOR_AXIS 6378137.0        /* a [m] */
#define FLATTENING (1.0 / 298.257223563) /* f */
#define SEMI_MINOR_AXIS (SEMI_MAJOR_AXIS * (1.0 - FLATTENING))
#define FIRST_ECCENTRICITY_SQUARED (FLATTENING * (2.0 - FLATTENING)) /* e^2 of the geometry */

/* e^2 as printed, which the magnitude of gravity uses; 2e-16 less than the above. */
#define ECCENTRICITY_SQUARED 6.69437999014e-3
#define EQUATOR_GRAVITY 9.7803253359      /* [m/s^2] */
#define GRAVITY_CONSTANT 1.93185265241e-3 /* k = b g_pole/(a g_equator) - 1 */
#define ROTATION_RATIO 3.44978650684e-3   /* m = rate^2 a^2 b/GM */

#endif
