/* SPDX-License-Identifier: Apache-2.0 */
/* Quaternions, rotation vectors, matrices and Euler angles.
 *
 * A unit quaternion q = (cos(a/2), u sin(a/2)) turns v into q v q*, by the angle a about the unit
 * vector u. C_nb = Rz(yaw) Ry(pitch) Rx(roll). */
#include "imukit/attitude.h"

#include "imukit/elementary.h"

#include <math.h>

imk_quaternion imk_quaternion_identity(void)
{
    return (imk_quaternion){1.0, 0.0, 0.0, 0.0};
}

imk_quaternion imk_quaternion_multiply(imk_quaternion a, imk_quaternion b)
{
    return (imk_quaternion){.w = a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z,
                            .x = a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
                            .y = a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
                            .z = a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}

imk_quaternion imk_quaternion_conjugate(imk_quaternion a)
{
    return (imk_quaternion){a.w, -a.x, -a.y, -a.z};
}

imk_quaternion imk_quaternion_normalise(imk_quaternion a)
{
    const double largest = fmax(fmax(fabs(a.w), fabs(a.x)), fmax(fabs(a.y), fabs(a.z)));
    if (!(largest > 0.0) || !isfinite(largest))
        return imk_quaternion_identity();
    /* Scaled first, so that no square overflows or underflows. */
    const double w = a.w / largest, x = a.x / largest, y = a.y / largest, z = a.z / largest;
    const double norm = sqrt(w * w + x * x + y * y + z * z);
    return (imk_quaternion){w / norm, x / norm, y / norm, z / norm};
}

/* v + 2 w (u x v) + 2 u x (u x v), u the vector part: q v q* with fewer products. */
imk_vector3 imk_quaternion_rotate(imk_quaternion q, imk_vector3 v)
{
    const imk_vector3 u = {{q.x, q.y, q.z}};
    const imk_vector3 t = imk_vector3_scale(imk_vector3_cross(u, v), 2.0);
    return imk_vector3_add(imk_vector3_add(v, imk_vector3_scale(t, q.w)), imk_vector3_cross(u, t));
}

imk_quaternion imk_quaternion_from_rotation_vector(imk_vector3 rotation)
{
    const double angle = imk_vector3_norm(rotation);
    double factor; /* sin(a/2)/a */
    if (angle < 0.01) {
        /* 1/2 - a^2/48 + a^4/3840; the next term is below 1e-17 of it. */
        const double square = angle * angle;
        factor = 0.5 - square * (1.0 / 48.0 - square / 3840.0);
    } else {
        factor = imk_sin(0.5 * angle) / angle;
    }
    return (imk_quaternion){.w = imk_cos(0.5 * angle),
                            .x = factor * rotation.v[0],
                            .y = factor * rotation.v[1],
                            .z = factor * rotation.v[2]};
}

imk_vector3 imk_quaternion_to_rotation_vector(imk_quaternion q)
{
    const imk_vector3 vector = {{q.x, q.y, q.z}};
    const double sine = imk_vector3_norm(vector);
    /* q and -q are the same rotation: the one with w >= 0 turns by at most half a turn. */
    const double w = fabs(q.w);
    const double factor = sine > 0.0 ? 2.0 * imk_atan2(sine, w) / sine : 2.0;
    return imk_vector3_scale(vector, q.w < 0.0 ? -factor : factor);
}

imk_matrix3 imk_quaternion_to_matrix(imk_quaternion q)
{
    const double xx = q.x * q.x, yy = q.y * q.y, zz = q.z * q.z;
    const double xy = q.x * q.y, xz = q.x * q.z, yz = q.y * q.z;
    const double wx = q.w * q.x, wy = q.w * q.y, wz = q.w * q.z;
    return (imk_matrix3){{{1.0 - 2.0 * (yy + zz), 2.0 * (xy - wz), 2.0 * (xz + wy)},
                          {2.0 * (xy + wz), 1.0 - 2.0 * (xx + zz), 2.0 * (yz - wx)},
                          {2.0 * (xz - wy), 2.0 * (yz + wx), 1.0 - 2.0 * (xx + yy)}}};
}

/* Four times the squares of the components are 1 ± the diagonal elements; dividing the off-diagonal
 * sums by the largest component loses no digits [SHEPPERD1978]. */
imk_quaternion imk_quaternion_from_matrix(imk_matrix3 c)
{
    const double(*const m)[3] = (const double(*)[3])c.m;
    const double w4 = 1.0 + m[0][0] + m[1][1] + m[2][2];
    const double x4 = 1.0 + m[0][0] - m[1][1] - m[2][2];
    const double y4 = 1.0 - m[0][0] + m[1][1] - m[2][2];
    const double z4 = 1.0 - m[0][0] - m[1][1] + m[2][2];
    imk_quaternion q;
    if (w4 >= x4 && w4 >= y4 && w4 >= z4)
        q = (imk_quaternion){w4, m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]};
    else if (x4 >= y4 && x4 >= z4)
        q = (imk_quaternion){m[2][1] - m[1][2], x4, m[0][1] + m[1][0], m[0][2] + m[2][0]};
    else if (y4 >= z4)
        q = (imk_quaternion){m[0][2] - m[2][0], m[0][1] + m[1][0], y4, m[1][2] + m[2][1]};
    else
        q = (imk_quaternion){m[1][0] - m[0][1], m[0][2] + m[2][0], m[1][2] + m[2][1], z4};
    q = imk_quaternion_normalise(q);
    return q.w < 0.0 ? (imk_quaternion){-q.w, -q.x, -q.y, -q.z} : q;
}

imk_matrix3 imk_matrix3_from_euler(double roll, double pitch, double yaw)
{
    const double sr = imk_sin(roll), cr = imk_cos(roll);
    const double sp = imk_sin(pitch), cp = imk_cos(pitch);
    const double sy = imk_sin(yaw), cy = imk_cos(yaw);
    return (imk_matrix3){{{cp * cy, sr * sp * cy - cr * sy, cr * sp * cy + sr * sy},
                          {cp * sy, sr * sp * sy + cr * cy, cr * sp * sy - sr * cy},
                          {-sp, sr * cp, cr * cp}}};
}

void imk_matrix3_to_euler(imk_matrix3 c, double *roll, double *pitch, double *yaw)
{
    const double cosine = hypot(c.m[2][1], c.m[2][2]);
    *pitch = imk_atan2(-c.m[2][0], cosine);
    /* Nearer to the vertical than this, rounding decides about roll: only the sum with yaw is
     * known. */
    if (cosine < 1e-12) {
        *roll = 0.0;
        *yaw = imk_atan2(-c.m[0][1], c.m[1][1]);
        return;
    }
    *roll = imk_atan2(c.m[2][1], c.m[2][2]);
    *yaw = imk_atan2(c.m[1][0], c.m[0][0]);
}
