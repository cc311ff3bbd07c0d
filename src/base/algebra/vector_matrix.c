/* SPDX-License-Identifier: Apache-2.0 */
/* 3-vectors and 3x3 matrices. */
#include "imukit/attitude.h"

#include <math.h>

imk_vector3 imk_vector3_add(imk_vector3 a, imk_vector3 b)
{
    return (imk_vector3){{a.v[0] + b.v[0], a.v[1] + b.v[1], a.v[2] + b.v[2]}};
}

imk_vector3 imk_vector3_subtract(imk_vector3 a, imk_vector3 b)
{
    return (imk_vector3){{a.v[0] - b.v[0], a.v[1] - b.v[1], a.v[2] - b.v[2]}};
}

imk_vector3 imk_vector3_scale(imk_vector3 a, double factor)
{
    return (imk_vector3){{a.v[0] * factor, a.v[1] * factor, a.v[2] * factor}};
}

double imk_vector3_dot(imk_vector3 a, imk_vector3 b)
{
    return a.v[0] * b.v[0] + a.v[1] * b.v[1] + a.v[2] * b.v[2];
}

imk_vector3 imk_vector3_cross(imk_vector3 a, imk_vector3 b)
{
    return (imk_vector3){{a.v[1] * b.v[2] - a.v[2] * b.v[1], a.v[2] * b.v[0] - a.v[0] * b.v[2],
                          a.v[0] * b.v[1] - a.v[1] * b.v[0]}};
}

double imk_vector3_norm(imk_vector3 a)
{
    const double sum = imk_vector3_dot(a, a);
    /* Between these no square has left the normal range far enough to matter. */
    if (sum > 1e-280 && sum < 1e280)
        return sqrt(sum);
    const double largest = fmax(fmax(fabs(a.v[0]), fabs(a.v[1])), fabs(a.v[2]));
    if (isnan(sum) || !(largest > 0.0) || isinf(largest))
        return isnan(sum) ? sum : largest;
    const imk_vector3 scaled = {{a.v[0] / largest, a.v[1] / largest, a.v[2] / largest}};
    return largest * sqrt(imk_vector3_dot(scaled, scaled));
}

imk_matrix3 imk_matrix3_identity(void)
{
    return (imk_matrix3){{{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}}};
}

imk_matrix3 imk_matrix3_multiply(imk_matrix3 a, imk_matrix3 b)
{
    imk_matrix3 product;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            product.m[i][j] = a.m[i][0] * b.m[0][j] + a.m[i][1] * b.m[1][j] + a.m[i][2] * b.m[2][j];
    }
    return product;
}

imk_matrix3 imk_matrix3_transpose(imk_matrix3 a)
{
    imk_matrix3 transpose;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            transpose.m[i][j] = a.m[j][i];
    }
    return transpose;
}

imk_vector3 imk_matrix3_apply(imk_matrix3 a, imk_vector3 v)
{
    imk_vector3 product;
    for (int i = 0; i < 3; i++)
        product.v[i] = a.m[i][0] * v.v[0] + a.m[i][1] * v.v[1] + a.m[i][2] * v.v[2];
    return product;
}

static double frobenius_norm(const imk_matrix3 *a)
{
    double sum = 0.0;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            sum += a->m[i][j] * a->m[i][j];
    }
    return sqrt(sum);
}

/* The rows of the adjugate's transpose are the cross products of the rows, and any row times its
 * cofactors is the determinant. */
imk_status imk_matrix3_inverse(imk_matrix3 a, imk_matrix3 *inverse)
{
    imk_matrix3 result;
    const imk_vector3 rows[3] = {{{a.m[0][0], a.m[0][1], a.m[0][2]}},
                                 {{a.m[1][0], a.m[1][1], a.m[1][2]}},
                                 {{a.m[2][0], a.m[2][1], a.m[2][2]}}};
    const imk_vector3 cofactors[3] = {imk_vector3_cross(rows[1], rows[2]),
                                      imk_vector3_cross(rows[2], rows[0]),
                                      imk_vector3_cross(rows[0], rows[1])};
    const double determinant = imk_vector3_dot(rows[0], cofactors[0]);
    if (!(fabs(determinant) >= 1e-300) || !isfinite(determinant))
        return IMK_ERROR_SINGULAR;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            result.m[j][i] = cofactors[i].v[j] / determinant;
    }
    if (!(frobenius_norm(&a) * frobenius_norm(&result) <= 1e14))
        return IMK_ERROR_SINGULAR;
    *inverse = result;
    return IMK_OK;
}
