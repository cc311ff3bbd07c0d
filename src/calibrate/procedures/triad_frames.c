/* SPDX-License-Identifier: Apache-2.0 */
/* The same unit in other body axes. With v' = C v, a response R (row i: what axis i senses of the
 * three components, (1 + s_i) e_i + A_i + X_i) becomes R' = R C^T. C is chosen so that R' of the
 * accelerometers has the form wanted:
 *
 *     upper triangular  R = U C, by orthogonalising the rows from the last up
 *     lower triangular  R = L C, from the first down
 *     symmetric         R = P C, P = (R R^T)^(1/2): the polar decomposition, by Newton's iteration
 *                       C <- (C + C^-T)/2 from R                          [HIGHAM1986]
 *
 * R' is written back as scale factors and misalignments; cross-axis terms stay. Everything else
 * that has body axes turns with them: sensitivities to force, places, pendulous axes.
 *
 * The covariance follows to first order: with R = I + E and C = I - [psi x],
 *
 *     E' = E + [psi x],   psi from the elements of E that are to vanish or to become equal. */
#include "calibrate/estimator/calibration_internal.h"

#include "base/algebra/vector_internal.h"
#include "imukit/attitude.h"

#include <math.h>
#include <string.h>

/* ---- responses --------------------------------------------------------------------------------
 */

static void response_of(const imk_triad *triad, int axis, double row[3])
{
    for (int j = 0; j < 3; j++)
        row[j] = (1.0 + triad->scale_factor.fixed.value[axis]) * triad->direction[axis][j] +
                 triad->misalignment.value[axis][j] + triad->cross_axis.value[axis][j];
}

/* The axes of a triad are told apart by the body axes of their numbers. */
static bool can_turn(const imk_triad *triad)
{
    for (int i = 0; triad->present && triad->axis_count == 3 && i < 3; i++)
        if (fabs(triad->direction[i][i]) < 0.5)
            return false;
    return true;
}

/* The inverse: scale factor and misalignment of a triad's axis from its component along the body
 * axis of its number, whose misalignment is 0; of any other axis from that along its direction. */
static void set_response(imk_triad *triad, int axis, const double row[3])
{
    const double *e = triad->direction[axis], *x = triad->cross_axis.value[axis];
    double *s = &triad->scale_factor.fixed.value[axis], along = 0.0;
    if (triad->axis_count == 3) {
        *s = (row[axis] - x[axis]) / e[axis] - 1.0;
    } else {
        for (int j = 0; j < 3; j++)
            along += e[j] * (row[j] - x[j]);
        *s = along - 1.0;
    }
    for (int j = 0; j < 3; j++)
        triad->misalignment.value[axis][j] = row[j] - x[j] - (1.0 + *s) * e[j];
    if (triad->axis_count == 3)
        triad->misalignment.value[axis][axis] = 0.0;
}

static void apply(const double c[3][3], const double v[3], double out[3])
{
    double made[3];
    for (int i = 0; i < 3; i++)
        made[i] = imki_dot3(c[i], v);
    memcpy(out, made, sizeof made);
}

/* q(f) = f^T Q f becomes f'^T C Q C^T f'. */
static void turn_quadratic(const double c[3][3], double q[6])
{
    const double full[3][3] = {{q[0], 0.5 * q[3], 0.5 * q[5]},
                               {0.5 * q[3], q[1], 0.5 * q[4]},
                               {0.5 * q[5], 0.5 * q[4], q[2]}};
    double half[3][3], turned[3][3];
    for (int i = 0; i < 3; i++)
        apply(c, full[i], half[i]); /* rows of Q C^T */
    for (int j = 0; j < 3; j++) {
        const double column[3] = {half[0][j], half[1][j], half[2][j]};
        double out[3];
        apply(c, column, out);
        for (int i = 0; i < 3; i++)
            turned[i][j] = out[i];
    }
    q[0] = turned[0][0];
    q[1] = turned[1][1];
    q[2] = turned[2][2];
    q[3] = 2.0 * turned[0][1];
    q[4] = 2.0 * turned[1][2];
    q[5] = 2.0 * turned[2][0];
}

static void turn_triad(imk_triad *triad, int sensor, const double c[3][3])
{
    for (int i = 0; triad->present && i < triad->axis_count; i++) {
        double row[3];
        response_of(triad, i, row);
        apply(c, row, row);
        set_response(triad, i, row);
        apply(c, triad->nonlinearity.pendulous_axis[i], triad->nonlinearity.pendulous_axis[i]);
        if (sensor == IMK_GYRO) {
            apply(c, triad->g_sensitivity.value[i], triad->g_sensitivity.value[i]);
            turn_quadratic(c, triad->g2_sensitivity.value[i]);
        } else {
            apply(c, triad->lever_arm.value[i], triad->lever_arm.value[i]);
        }
    }
}

bool imki_turn_model(imk_model *model, const double c[3][3])
{
    if (!can_turn(&model->gyro) || !can_turn(&model->accel))
        return false;
    turn_triad(&model->gyro, IMK_GYRO, c);
    turn_triad(&model->accel, IMK_ACCEL, c);
    return true;
}

/* ---- the rotation wanted ----------------------------------------------------------------------
 */

/* Rows of C from those of R, each made perpendicular to those before it; order of the rows. */
static bool orthogonalise(const double r[3][3], const int order[3], double c[3][3])
{
    for (int k = 0; k < 3; k++) {
        double *row = c[order[k]], norm = 0.0, whole = 0.0;
        memcpy(row, r[order[k]], 3 * sizeof *row);
        for (int pass = 0; pass < 2; pass++) /* twice is enough [BJORCK1996, sec. 2.4.5] */
            for (int l = 0; l < k; l++) {
                const double *other = c[order[l]];
                const double along = imki_dot3(row, other);
                for (int j = 0; j < 3; j++)
                    row[j] -= along * other[j];
            }
        for (int j = 0; j < 3; j++) {
            norm += row[j] * row[j];
            whole += r[order[k]][j] * r[order[k]][j];
        }
        if (!(norm > 1e-6 * whole))
            return false;
        for (int j = 0; j < 3; j++)
            row[j] /= sqrt(norm);
    }
    return true;
}

static bool polar(const double r[3][3], double c[3][3])
{
    imk_matrix3 q, inverse;
    memcpy(q.m, r, sizeof q.m);
    for (int round = 0; round < 40; round++) {
        if (imk_matrix3_inverse(q, &inverse) != IMK_OK)
            return false;
        double change = 0.0;
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) {
                const double next = 0.5 * (q.m[i][j] + inverse.m[j][i]);
                change = fmax(change, fabs(next - q.m[i][j]));
                c[i][j] = next;
            }
        memcpy(q.m, c, sizeof q.m);
        if (change < 1e-15)
            break;
    }
    return true;
}

bool imki_frame_rotation(const double r[3][3], imk_triad_frame frame, double c[3][3])
{
    static const int up[3] = {2, 1, 0}, down[3] = {0, 1, 2};
    if (frame == IMK_FRAME_SYMMETRIC)
        return polar(r, c);
    return orthogonalise(r, frame == IMK_FRAME_UPPER ? up : down, c);
}

/* ---- covariance -------------------------------------------------------------------------------
 */

/* psi as sums of elements of E of the accelerometers: psi_k = plus E_(row,column) - minus
 * E_(column, row), (row, column) the element that [psi x] raises by psi_k. */
static void psi_weights(imk_triad_frame frame, int k, double *own, double *opposite)
{
    /* [psi x] has +psi_x at (z, y), +psi_y at (x, z), +psi_z at (y, x): the first and the last are
     * in the lower triangle. */
    const bool lower = k != 1;
    const bool vanishes = (frame == IMK_FRAME_UPPER) == lower;
    *own = frame == IMK_FRAME_SYMMETRIC ? -0.5 : vanishes ? -1.0 : 0.0;
    *opposite = frame == IMK_FRAME_SYMMETRIC ? 0.5 : vanishes ? 0.0 : 1.0;
}

static int find(size_t count, const imk_model_parameter *parameter, int sensor, int axis,
                int element)
{
    for (size_t p = 0; p < count; p++)
        if (parameter[p].sensor == sensor && parameter[p].term == IMK_MODEL_MISALIGNMENT &&
            parameter[p].axis == axis && parameter[p].element == element)
            return (int)p;
    return -1;
}

/* Rows of the linear map: new parameter = old + weight (own element) + weight (opposite one). */
static void turn_covariance(imk_triad_frame frame, size_t count,
                            const imk_model_parameter *parameter, double *covariance)
{
    static const int row_of[3] = {2, 0, 1}, column_of[3] = {1, 2, 0};
    int source[3][2];
    double weight[3][2];
    for (int k = 0; k < 3; k++) {
        psi_weights(frame, k, &weight[k][0], &weight[k][1]);
        source[k][0] = find(count, parameter, IMK_ACCEL, row_of[k], column_of[k]);
        source[k][1] = find(count, parameter, IMK_ACCEL, column_of[k], row_of[k]);
    }
    double map[IMK_CORRELATED_MAX][6];
    int used[IMK_CORRELATED_MAX];
    for (size_t p = 0; p < count; p++) {
        used[p] = -1;
        for (int k = 0; k < 3 && parameter[p].term == IMK_MODEL_MISALIGNMENT; k++) {
            const bool own = parameter[p].axis == row_of[k] && parameter[p].element == column_of[k];
            const bool other =
                parameter[p].axis == column_of[k] && parameter[p].element == row_of[k];
            if (!own && !other)
                continue;
            used[p] = k;
            for (int s = 0; s < 2; s++)
                map[p][s] = (own ? 1.0 : -1.0) * weight[k][s];
        }
    }
    /* T V T^T, columns first: each column needs only old ones. */
    for (int side = 0; side < 2; side++)
        for (size_t r = 0; r < count; r++) {
            double made[IMK_CORRELATED_MAX];
            for (size_t p = 0; p < count; p++) {
                const size_t stride = side == 0 ? 1 : count, first = side == 0 ? r * count : r;
                made[p] = covariance[first + p * stride];
                for (int s = 0; used[p] >= 0 && s < 2; s++)
                    if (source[used[p]][s] >= 0)
                        made[p] +=
                            map[p][s] * covariance[first + (size_t)source[used[p]][s] * stride];
            }
            for (size_t p = 0; p < count; p++)
                covariance[side == 0 ? r * count + p : p * count + r] = made[p];
        }
}

imk_status imk_triad_frame_convert(imk_model *model, imk_triad_frame frame, size_t count,
                                   const imk_model_parameter *parameter, double *covariance,
                                   double *rotation)
{
    double r[3][3], c[3][3];
    const imk_triad *accel = &model->accel;
    if (!accel->present || accel->axis_count != 3)
        return IMK_ERROR_CONFLICT;
    if ((unsigned)frame >= IMK_FRAME_REFERENCE || count > IMK_CORRELATED_MAX)
        return IMK_ERROR_ARGUMENT;
    for (int i = 0; i < 3; i++)
        response_of(accel, i, r[i]);
    if (!imki_frame_rotation((const double(*)[3])r, frame, c))
        return IMK_ERROR_SINGULAR;
    const double determinant = c[0][0] * (c[1][1] * c[2][2] - c[1][2] * c[2][1]) -
                               c[0][1] * (c[1][0] * c[2][2] - c[1][2] * c[2][0]) +
                               c[0][2] * (c[1][0] * c[2][1] - c[1][1] * c[2][0]);
    if (!(determinant > 0.0) || !imki_turn_model(model, (const double(*)[3])c))
        return IMK_ERROR_SINGULAR;
    if (covariance)
        turn_covariance(frame, count, parameter, covariance);
    if (rotation)
        memcpy(rotation, c, sizeof c);
    return IMK_OK;
}
