/* SPDX-License-Identifier: Apache-2.0 */
/** @file attitude.h
 *  3-vectors, 3x3 matrices, quaternions and attitude steps.
 *
 *  C_nb takes body to navigation: v_n = C_nb v_b. Quaternions are (w, x, y, z), scalar first, unit
 *  norm, and q_nb rotates as C_nb does. Euler angles are roll, pitch, yaw (rotations about x, y, z
 *  of the body, yaw applied first). Outputs may alias inputs. */
#ifndef IMUKIT_ATTITUDE_H
#define IMUKIT_ATTITUDE_H

#include "imukit/status.h"

IMK_BEGIN_C

typedef struct imk_vector3 {
    double v[3];
} imk_vector3;

typedef struct imk_matrix3 {
    double m[3][3]; /**< m[row][column] */
} imk_matrix3;

typedef struct imk_quaternion {
    double w, x, y, z;
} imk_quaternion;

/** a + b. */
IMK_API imk_vector3 imk_vector3_add(imk_vector3 a, imk_vector3 b);
/** a - b. */
IMK_API imk_vector3 imk_vector3_subtract(imk_vector3 a, imk_vector3 b);
/** factor a. */
IMK_API imk_vector3 imk_vector3_scale(imk_vector3 a, double factor);
/** Inner product of a and b. */
IMK_API double imk_vector3_dot(imk_vector3 a, imk_vector3 b);
/** a x b, right-handed. */
IMK_API imk_vector3 imk_vector3_cross(imk_vector3 a, imk_vector3 b);
/** Length without overflow or underflow. */
IMK_API double imk_vector3_norm(imk_vector3 a);

/** The unit matrix. */
IMK_API imk_matrix3 imk_matrix3_identity(void);
/** a b: first b, then a. */
IMK_API imk_matrix3 imk_matrix3_multiply(imk_matrix3 a, imk_matrix3 b);
/** Rows and columns exchanged; the inverse of a rotation. */
IMK_API imk_matrix3 imk_matrix3_transpose(imk_matrix3 a);
/** a v. */
IMK_API imk_vector3 imk_matrix3_apply(imk_matrix3 a, imk_vector3 v);
/** IMK_ERROR_SINGULAR when the determinant is below 1e-300 or the condition beyond 1e14. */
IMK_API imk_status imk_matrix3_inverse(imk_matrix3 a, imk_matrix3 *inverse);

/** No rotation: (1, 0, 0, 0). */
IMK_API imk_quaternion imk_quaternion_identity(void);
/** a b, which rotates by b first, then by a. */
IMK_API imk_quaternion imk_quaternion_multiply(imk_quaternion a, imk_quaternion b);
/** The inverse of a unit quaternion. */
IMK_API imk_quaternion imk_quaternion_conjugate(imk_quaternion a);
/** Unit quaternion of the same direction; the identity for one that is zero or not finite. */
IMK_API imk_quaternion imk_quaternion_normalise(imk_quaternion a);
/** v rotated by the unit quaternion q, as imk_quaternion_to_matrix(q) rotates it. */
IMK_API imk_vector3 imk_quaternion_rotate(imk_quaternion q, imk_vector3 v);
/** Quaternion of a rotation vector [rad], exact; by series where its norm is small.
 *  Bit-reproducible. */
IMK_API imk_quaternion imk_quaternion_from_rotation_vector(imk_vector3 rotation);
/** The rotation vector [rad] of at most half a turn; q and -q give the same. Bit-reproducible. */
IMK_API imk_vector3 imk_quaternion_to_rotation_vector(imk_quaternion q);
/** Rotation matrix of a unit quaternion. */
IMK_API imk_matrix3 imk_quaternion_to_matrix(imk_quaternion q);
/** From a rotation matrix, by the largest of the four squares [SHEPPERD1978]; w >= 0. */
IMK_API imk_quaternion imk_quaternion_from_matrix(imk_matrix3 c);
/** C_nb from roll, pitch, yaw [rad], with the bit-reproducible sine and cosine. */
IMK_API imk_matrix3 imk_matrix3_from_euler(double roll, double pitch, double yaw);
/** Roll, pitch, yaw [rad] of C_nb, bit-reproducible; at pitch = +-90 deg (cosine below 1e-12) roll
 *  is 0. */
IMK_API void imk_matrix3_to_euler(imk_matrix3 c, double *roll, double *pitch, double *yaw);

IMK_END_C
#endif
