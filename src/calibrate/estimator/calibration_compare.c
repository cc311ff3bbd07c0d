/* SPDX-License-Identifier: Apache-2.0 */
/* Two calibrations of one unit, in the frame of the first. Where that is a convention about the
 * accelerometers (upper triangular ...), b is converted to it: the rotation is not a matter of how
 * well the two agree, and no difference of misalignments is lost to it. Where it is the reference
 * of a test, whose mounting is another each time, the small rotation psi that takes b's
 * misalignments closest to a's,
 *
 *     minimise  sum over rows i and columns j != i of  (E_b + [psi x] - E_a)_ij^2/sigma_ij^2,
 *
 * is found from the misalignments and cross-axis terms of both triads and applied exactly; three
 * times, because what is left after the first time is of second order. */
#include "calibration_internal.h"

#include "imukit/attitude.h"
#include "imukit/linear_algebra.h"

#include <math.h>
#include <string.h>

static double element(const imk_triad *triad, int i, int j)
{
    return triad->misalignment.value[i][j] + triad->cross_axis.value[i][j];
}

static double variance(const imk_triad *triad, int i, int j)
{
    const double m = triad->misalignment.sigma[i][j], x = triad->cross_axis.sigma[i][j];
    return m * m + x * x;
}

/* How much psi_k raises element (i, j). */
static double lift(int i, int j, int k)
{
    return (i + 1) % 3 == j && k == (i + 2) % 3   ? -1.0
           : (j + 1) % 3 == i && k == (j + 2) % 3 ? 1.0
                                                  : 0.0;
}

/* Weights 1/sigma^2; without any sigmas all are alike, and an element that both frames hold at 0
 * says nothing. */
static bool best_rotation(const imk_model *a, const imk_model *b, double psi[3])
{
    const imk_triad *of_a[2] = {&a->gyro, &a->accel}, *of_b[2] = {&b->gyro, &b->accel};
    double normal[9] = {0.0}, known = 0.0;
    for (int s = 0; s < 2; s++)
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                known += i == j ? 0.0 : variance(of_a[s], i, j) + variance(of_b[s], i, j);
    memset(psi, 0, 3 * sizeof *psi);
    for (int s = 0; s < 2; s++)
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) {
                const bool both = of_a[s]->present && of_b[s]->present &&
                                  of_a[s]->axis_count == 3 && of_b[s]->axis_count == 3;
                const double v =
                    known > 0.0 ? variance(of_a[s], i, j) + variance(of_b[s], i, j) : 1.0;
                if (!both || i == j || !(v > 0.0))
                    continue;
                const double off = element(of_a[s], i, j) - element(of_b[s], i, j);
                for (int k = 0; k < 3; k++) {
                    psi[k] += lift(i, j, k) * off / v;
                    for (int l = 0; l < 3; l++)
                        normal[3 * k + l] += lift(i, j, k) * lift(i, j, l) / v;
                }
            }
    if (imk_cholesky_factor(3, normal) != IMK_OK)
        return false;
    imk_cholesky_solve(3, normal, psi);
    return true;
}

/* E' = R C^T - I = E + [psi x] for C = Exp(-psi). */
static void rotation_matrix(const double psi[3], double c[3][3])
{
    const imk_matrix3 turned = imk_quaternion_to_matrix(
        imk_quaternion_from_rotation_vector((imk_vector3){{-psi[0], -psi[1], -psi[2]}}));
    memcpy(c, turned.m, sizeof turned.m);
}

/* ---- a convention -----------------------------------------------------------------------------
 */

/* Of three axes of accelerometers; IMK_FRAME_REFERENCE: none that says anything. */
static imk_triad_frame convention_of(const imk_model *a, const imk_model *b)
{
    const bool both = a->accel.present && b->accel.present && a->accel.axis_count == 3 &&
                      b->accel.axis_count == 3;
    for (int frame = 0; both && frame < IMK_FRAME_REFERENCE; frame++)
        if (strcmp(a->accel_evidence.frame, imk_triad_frame_name((imk_triad_frame)frame)) == 0)
            return (imk_triad_frame)frame;
    return IMK_FRAME_REFERENCE;
}

/* What is correlated, and all misalignments, whose sigmas a rotation changes. */
static size_t list_parameters(const imk_model *model, imk_model_parameter *parameter)
{
    size_t count = (size_t)model->correlation.count;
    memcpy(parameter, model->correlation.parameter, count * sizeof *parameter);
    for (unsigned sensor = 0; sensor < 2; sensor++)
        for (unsigned k = 0; k < 9; k++) {
            const imk_model_parameter place = {(uint8_t)sensor, IMK_MODEL_MISALIGNMENT,
                                               (uint8_t)(k / 3), (uint8_t)(k % 3)};
            const imk_triad *triad = imk_model_triad(model, sensor);
            bool is_listed = k % 4 == 0 || !triad->present || triad->axis_count != 3;
            for (size_t p = 0; !is_listed && p < count; p++)
                is_listed = memcmp(&parameter[p], &place, sizeof place) == 0;
            if (!is_listed && count < IMK_CORRELATED_MAX)
                parameter[count++] = place;
        }
    return count;
}

static double correlation_of(const imk_correlation *correlation, size_t p, size_t q)
{
    const size_t high = p > q ? p : q, low = p > q ? q : p;
    return p == q ? 1.0
           : high < (size_t)correlation->count
               ? (double)correlation->value[high * (high - 1) / 2 + low]
               : 0.0;
}

/* Values and sigmas. @return false when the triad cannot have the form */
static bool convert(imk_model *model, imk_triad_frame frame, double rotation[9])
{
    imk_model_parameter parameter[IMK_CORRELATED_MAX];
    double covariance[IMK_CORRELATED_MAX * IMK_CORRELATED_MAX], *sigma[IMK_CORRELATED_MAX];
    const size_t count = list_parameters(model, parameter);
    for (size_t p = 0; p < count; p++)
        if (!imk_model_parameter_at(model, parameter[p], &sigma[p]))
            return false;
    for (size_t p = 0; p < count; p++)
        for (size_t q = 0; q < count; q++)
            covariance[p * count + q] =
                *sigma[p] * *sigma[q] * correlation_of(&model->correlation, p, q);
    if (imk_triad_frame_convert(model, frame, count, parameter, covariance, rotation) != IMK_OK)
        return false;
    for (size_t p = 0; p < count; p++)
        *sigma[p] = sqrt(fmax(0.0, covariance[p * (count + 1)]));
    return true;
}

/* ---- both -------------------------------------------------------------------------------------
 */

/* The model b turned to the frame of a, and by what. */
static bool align(const imk_model *a, imk_model *turned, double total[3])
{
    const imk_triad_frame frame = convention_of(a, turned);
    memset(total, 0, 3 * sizeof *total);
    if (frame != IMK_FRAME_REFERENCE) {
        double rotation[9];
        imk_matrix3 c;
        if (!convert(turned, frame, rotation))
            return false;
        memcpy(c.m, rotation, sizeof rotation);
        const imk_vector3 back = imk_quaternion_to_rotation_vector(imk_quaternion_from_matrix(c));
        for (int k = 0; k < 3; k++)
            total[k] = -back.v[k];
        return true;
    }
    for (int round = 0; round < 3; round++) {
        double psi[3], c[3][3];
        if (!best_rotation(a, turned, psi))
            break; /* no triads in common: nothing to turn */
        rotation_matrix(psi, c);
        if (!imki_turn_model(turned, (const double(*)[3])c))
            return false;
        for (int k = 0; k < 3; k++)
            total[k] += psi[k];
    }
    return true;
}

imk_status imk_calibration_compare(const imk_model *a, const imk_model *b, size_t count,
                                   const imk_model_parameter *parameter, imk_model *turned,
                                   double rotation[3], double *difference, double *sigma,
                                   imk_error *error)
{
    imk_status status = imk_model_validate(a, error);
    if (status == IMK_OK)
        status = imk_model_validate(b, error);
    if (status != IMK_OK)
        return status;
    double total[3];
    *turned = *b;
    if (!align(a, turned, total))
        return imk_error_set(error, IMK_ERROR_SINGULAR, "direction", NULL,
                             "triads whose axes 1, 2, 3 are near body x, y, z");
    if (rotation)
        memcpy(rotation, total, sizeof total);
    for (size_t p = 0; p < count; p++) {
        double *of_b = NULL;
        const double *y = imk_model_parameter_at(turned, parameter[p], &of_b);
        difference[p] = y ? *y - imk_model_parameter_get(a, parameter[p]) : (double)NAN;
        if (isnan(difference[p])) {
            sigma[p] = (double)NAN;
            continue;
        }
        /* The sigma stands at the same place in both. */
        double of_a;
        memcpy(&of_a, (const char *)a + ((const char *)of_b - (const char *)turned), sizeof of_a);
        sigma[p] = sqrt(of_a * of_a + *of_b * *of_b);
    }
    return IMK_OK;
}
