/* SPDX-License-Identifier: Apache-2.0 */
/* Quaternions of moving attitudes with their first two derivatives, and vectors likewise. */
#ifndef IMUKI_ATTITUDE_JET_INTERNAL_H
#define IMUKI_ATTITUDE_JET_INTERNAL_H

#include "imukit/attitude.h"
#include "script_profile_internal.h"

/* A quaternion (or, with w = 0, a vector) and its first two derivatives. */
typedef struct imki_quaternion_jet {
    imk_quaternion d[3];
} imki_quaternion_jet;

/* A quaternion that does not change. */
imki_quaternion_jet imki_quaternion_constant(imk_quaternion q);

/* The turn by an angle about a fixed unit vector. */
imki_quaternion_jet imki_turn(imk_vector3 axis, imki_jet angle);
/* The same about x, y or z: axis 0 … 2. */
imki_quaternion_jet imki_turn_axis(int axis, imki_jet angle);

/* a b. */
imki_quaternion_jet imki_quaternion_jet_product(imki_quaternion_jet a, imki_quaternion_jet b);

/* The vector v turned by the unit quaternion q: q v q*. */
imki_quaternion_jet imki_quaternion_jet_rotate(imki_quaternion_jet q, imki_quaternion_jet v);

/* Angular rate 2 vec(q* q')/|q|^2 in the axes on the right. */
imk_vector3 imki_quaternion_rate(imk_quaternion q, imk_quaternion derivative);

/* Coefficients of s^0 … s^5 of the polynomial that has these values and derivatives at s = 0 and
 * s = length. All but the first are exactly zero when nothing changes. */
void imki_quintic(const double first[3], const double last[3], double length, double *coefficient);

#endif
