/* SPDX-License-Identifier: Apache-2.0 */
/* Between the matrices of other programs and the terms of the model.
 *
 *     reading = T v + b,   T_i = (1 + s_i) e_i + A_i + X_i
 *
 * with scale factor s, direction e, misalignment A and cross-axis response X of axis i. A matrix
 * tells only their sum: reading one gives scale factors and misalignment. */
#include "parameter_internal.h"

#include "base/algebra/vector_internal.h"

#include "imukit/attitude.h"

#include <math.h>
#include <string.h>

void imki_response_of(const imk_triad *triad, double matrix[3][3])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            matrix[i][j] = (1 + triad->scale_factor.fixed.value[i]) * triad->direction[i][j] +
                           triad->misalignment.value[i][j] + triad->cross_axis.value[i][j];
}

bool imki_is_identity(double matrix[3][3])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            if (matrix[i][j] != (i == j))
                return false;
    return true;
}

void imki_multiply(double a[3][3], double b[3][3], double product[3][3])
{
    double result[3][3];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            result[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
    memcpy(product, result, sizeof result);
}

/* Misalignments are small angles; beyond this share of the diagonal, the axes are turned. */
static const double small_share = 0.5;

void imki_response_set(imki_parameters *p, imki_place place, imk_triad *triad, double matrix[3][3])
{
    bool small = true;
    for (int i = 0; i < 3; i++) {
        double length = imki_norm3(matrix[i]);
        if (!(length >= 0.05 && length <= 20)) {
            imki_parameter_refuse_at(p, place, IMK_ERROR_RANGE, "",
                                     "a matrix near a rotation: rows of a length near 1");
            return;
        }
        for (int j = 0; j < 3; j++)
            small = small &&
                    (i == j ? matrix[i][i] > 0 : fabs(matrix[i][j]) <= small_share * matrix[i][i]);
    }
    memset(&triad->misalignment, 0, sizeof triad->misalignment);
    memset(&triad->cross_axis, 0, sizeof triad->cross_axis);
    for (int i = 0; i < 3; i++) {
        double length = imki_norm3(matrix[i]);
        triad->scale_factor.fixed.value[i] = (small ? matrix[i][i] : length) - 1;
        for (int j = 0; j < 3; j++) {
            triad->direction[i][j] = small ? i == j : matrix[i][j] / length;
            if (small && i != j)
                triad->misalignment.value[i][j] = matrix[i][j];
        }
    }
    if (!small)
        imki_note(p, false,
                  "the matrices turn the axes by large angles: the model has them as directions");
}

static bool inverse_of(double matrix[3][3], double inverse[3][3])
{
    imk_matrix3 a, made;
    for (int i = 0; i < 9; i++)
        a.m[i / 3][i % 3] = matrix[i / 3][i % 3];
    if (imk_matrix3_inverse(a, &made) != IMK_OK)
        return false;
    for (int i = 0; i < 9; i++)
        inverse[i / 3][i % 3] = made.m[i / 3][i % 3] + 0.0; /* no negative zero */
    return true;
}

void imki_correction_of(imki_parameters *p, const imk_triad *triad, const char *name,
                        double matrix[3][3])
{
    double response[3][3];
    imki_response_of(triad, response);
    if (!inverse_of(response, matrix))
        imki_parameter_refuse(p, IMK_ERROR_UNSUPPORTED, name,
                              "the axes of the sensor are not independent of each other", "");
}

void imki_correction_set(imki_parameters *p, imki_place place, imk_triad *triad,
                         double matrix[3][3])
{
    double response[3][3];
    if (inverse_of(matrix, response))
        imki_response_set(p, place, triad, response);
    else
        imki_parameter_refuse_at(p, place, IMK_ERROR_RANGE, "",
                                 "a matrix near a rotation, which has an inverse");
}

/* Gram-Schmidt on the rows: exact where the matrix is lower triangular already. */
bool imki_lower_and_rotation(double matrix[3][3], double lower[3][3], double rotation[3][3])
{
    memset(lower, 0, 9 * sizeof(double));
    for (int i = 0; i < 3; i++) {
        double rest[3] = {matrix[i][0], matrix[i][1], matrix[i][2]};
        for (int k = 0; k < i; k++) {
            const double *q = rotation[k];
            lower[i][k] = imki_dot3(rest, q);
            for (int j = 0; j < 3; j++)
                rest[j] -= lower[i][k] * q[j];
        }
        lower[i][i] = imki_norm3(rest);
        if (!(lower[i][i] > 1e-6))
            return false;
        for (int j = 0; j < 3; j++)
            rotation[i][j] = rest[j] / lower[i][i];
    }
    double across[3];
    imki_cross3(rotation[0], rotation[1], across);
    return imki_dot3(rotation[2], across) > 0;
}
