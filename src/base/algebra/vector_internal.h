/* SPDX-License-Identifier: Apache-2.0 */
/* Numbers in an array as a vector. */
#ifndef IMUKIT_VECTOR_INTERNAL_H
#define IMUKIT_VECTOR_INTERNAL_H

#include <math.h>
#include <stddef.h>

static inline double imki_dot(size_t count, const double *a, const double *b)
{
    double sum = 0.0;
    for (size_t k = 0; k < count; k++)
        sum += a[k] * b[k];
    return sum;
}

static inline double imki_dot3(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* a x b; `out` is neither of them. */
static inline void imki_cross3(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* Of sizes whose squares are normal numbers; imk_vector3_norm() takes all. */
static inline double imki_norm3(const double a[3])
{
    return sqrt(imki_dot3(a, a));
}

#endif
