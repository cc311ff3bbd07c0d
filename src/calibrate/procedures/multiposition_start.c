/* SPDX-License-Identifier: Apache-2.0 */
/* What counts stand for, found from the log: first values of sensitivity and zero offset, good to a
 * few per cent, from which the estimator goes on.
 *
 * Accelerometers. The mean readings of holds lie on an ellipsoid; with its axes along the sensors',
 *
 *     a_x x^2 + a_y y^2 + a_z z^2 + b_x x + b_y y + b_z z = 1,
 *
 * linear in six unknowns. Least absolute deviations, by reweighting, keep holds in which the unit
 * was touched from bending it.
 *
 * Gyros. During a turn the accelerometers show the vertical v well enough, the hand's accelerations
 * average out, and with c the counts less the offset and B from counts to rates
 *
 *     v(end) - v(start) = -integral w x v dt = sum over j of (integral c_j [v x] dt) B_j,
 *
 * B_j the column of B: linear in nine unknowns. The length of B_j is what a count of gyro j stands
 * for, whichever way that gyro points: an exchanged or reversed axis is not hidden by the guess but
 * found afterwards, by what it does to the solution. */
#include "multiposition_internal.h"

#include "imukit/attitude.h"
#include "imukit/linear_algebra.h"

#include <math.h>

enum { ELLIPSOID = 6, MATRIX = 9, ROUNDS = 12 };

/* Add w row row^T and w row value to normal equations. */
static void add_row(int n, const double *row, double value, double w, double *normal, double *right)
{
    for (int i = 0; i < n; i++) {
        for (int j = 0; j <= i; j++)
            normal[i * n + j] += w * row[i] * row[j];
        right[i] += w * row[i] * value;
    }
}

/* Middle and half of the range of readings: the ellipsoid is solved in units of about one. */
static bool find_range(size_t count, const imk_static_interval *hold, double middle[3],
                       double half[3])
{
    for (int i = 0; i < 3; i++) {
        double low = (double)INFINITY, high = -(double)INFINITY;
        for (size_t k = 0; k < count; k++) {
            low = fmin(low, hold[k].mean[IMK_ACCEL][i]);
            high = fmax(high, hold[k].mean[IMK_ACCEL][i]);
        }
        middle[i] = 0.5 * (low + high);
        half[i] = 0.5 * (high - low);
        if (!(half[i] > 0.0) || !isfinite(half[i]))
            return false;
    }
    return true;
}

static void ellipsoid_row(const imk_static_interval *hold, const double middle[3],
                          const double half[3], double row[ELLIPSOID])
{
    for (int i = 0; i < 3; i++) {
        const double x = (hold->mean[IMK_ACCEL][i] - middle[i]) / half[i];
        row[i] = x * x;
        row[3 + i] = x;
    }
}

bool imki_start_accelerometers(size_t count, const imk_static_interval *hold, double gravity,
                               imki_scaling *accel)
{
    double middle[3], half[3], p[ELLIPSOID] = {0.0};
    if (count < ELLIPSOID || !find_range(count, hold, middle, half))
        return false;
    for (int round = 0; round < ROUNDS; round++) {
        double normal[ELLIPSOID * ELLIPSOID] = {0.0}, right[ELLIPSOID] = {0.0}, row[ELLIPSOID];
        for (size_t k = 0; k < count; k++) {
            ellipsoid_row(&hold[k], middle, half, row);
            double residual = 1.0;
            for (int i = 0; i < ELLIPSOID; i++)
                residual -= row[i] * p[i];
            /* 1e-3 of g: deviations below it all count alike. */
            const double weight = round == 0 ? 1.0 : 1.0 / fmax(fabs(residual), 1e-3);
            add_row(ELLIPSOID, row, 1.0, weight, normal, right);
        }
        if (imk_cholesky_factor(ELLIPSOID, normal) != IMK_OK)
            return false;
        imk_cholesky_solve(ELLIPSOID, normal, right);
        for (int i = 0; i < ELLIPSOID; i++)
            p[i] = right[i];
    }
    /* Complete the squares: a (x - x0)^2 ... = 1 + sum a x0^2. */
    double size = 1.0;
    for (int i = 0; i < 3; i++) {
        if (!(p[i] > 0.0))
            return false;
        size += 0.25 * p[3 + i] * p[3 + i] / p[i];
    }
    for (int i = 0; i < 3; i++) {
        accel->zero[i] = middle[i] - 0.5 * half[i] * p[3 + i] / p[i];
        accel->unit[i] = gravity / (half[i] * sqrt(size / p[i]));
    }
    return true;
}

/* Unit vector along the force that the accelerometers read. */
static void vertical_at(const imk_test_record *record, const imki_scaling *accel, size_t k,
                        double v[3])
{
    double square = 0.0;
    for (int i = 0; i < 3; i++) {
        v[i] = (record->reading[IMK_ACCEL][i][k] - accel->zero[i]) * accel->unit[i];
        square += v[i] * v[i];
    }
    const double scale = square > 0.0 ? 1.0 / sqrt(square) : 0.0;
    for (int i = 0; i < 3; i++)
        v[i] *= scale;
}

/* The three equations of a turn, in nine unknowns, the column j of B at 3 j. */
static void turn_rows(const imk_test_record *record, const imki_scaling *accel,
                      const imki_scaling *gyro, const imk_turn *turn, double row[3][MATRIX],
                      double change[3])
{
    double sum[3][3] = {{0.0}}, v[3] = {0.0}, first[3];
    vertical_at(record, accel, turn->begin, first);
    for (size_t k = turn->begin; k < turn->end; k++) {
        const double dt =
            record->time && k > 0 ? record->time[k] - record->time[k - 1] : record->dt;
        vertical_at(record, accel, k, v);
        for (int j = 0; j < 3; j++) {
            const double c = (record->reading[IMK_GYRO][j][k] - gyro->zero[j]) * gyro->unit[j] * dt;
            for (int i = 0; i < 3; i++)
                sum[j][i] += c * v[i];
        }
    }
    for (int i = 0; i < 3; i++) {
        change[i] = v[i] - first[i];
        for (int m = 0; m < MATRIX; m++)
            row[i][m] = 0.0;
    }
    for (int j = 0; j < 3; j++) {
        const double *s = sum[j]; /* integral c_j v: its cross product with B_j */
        row[0][3 * j + 1] = -s[2];
        row[0][3 * j + 2] = s[1];
        row[1][3 * j] = s[2];
        row[1][3 * j + 2] = -s[0];
        row[2][3 * j] = -s[1];
        row[2][3 * j + 1] = s[0];
    }
}

/* Scale the counts by their root mean square over all turns. */
static bool scale_counts(const imk_test_record *record, size_t count, const imk_turn *turn,
                         imki_scaling *gyro)
{
    for (int j = 0; j < 3; j++) {
        double square = 0.0;
        size_t samples = 0;
        for (size_t t = 0; t < count; t++) {
            for (size_t k = turn[t].begin; k < turn[t].end; k++) {
                const double c = record->reading[IMK_GYRO][j][k] - gyro->zero[j];
                square += c * c;
            }
            samples += turn[t].end - turn[t].begin;
        }
        if (!(square > 0.0) || !isfinite(square))
            return false;
        gyro->unit[j] = sqrt((double)samples / square);
    }
    return true;
}

/* B of counts scaled so; twice, the second time with turns that do not fit weighing less. */
static bool fit_matrix(const imk_test_record *record, const imki_scaling *accel,
                       const imki_scaling *gyro, size_t count, const imk_turn *turn,
                       double b[MATRIX])
{
    for (int round = 0; round < 2; round++) {
        double normal[MATRIX * MATRIX] = {0.0}, right[MATRIX] = {0.0};
        for (size_t t = 0; t < count; t++) {
            double row[3][MATRIX], change[3];
            turn_rows(record, accel, gyro, &turn[t], row, change);
            for (int i = 0; i < 3; i++) {
                double residual = change[i];
                for (int m = 0; m < MATRIX; m++)
                    residual -= row[i][m] * b[m];
                /* 0.1 rad: what the hand's accelerations leave. */
                const double weight = round == 0 ? 1.0 : 1.0 / fmax(fabs(residual), 0.1);
                add_row(MATRIX, row[i], change[i], weight, normal, right);
            }
        }
        if (imk_cholesky_factor(MATRIX, normal) != IMK_OK)
            return false;
        imk_cholesky_solve(MATRIX, normal, right);
        for (int m = 0; m < MATRIX; m++)
            b[m] = right[m];
    }
    return true;
}

bool imki_start_gyros(const imk_test_record *record, const imki_scaling *accel, size_t turn_count,
                      const imk_turn *turn, imki_scaling *gyro)
{
    imki_scaling scaled = *gyro;
    double b[MATRIX] = {0.0};
    if (!scale_counts(record, turn_count, turn, &scaled) ||
        !fit_matrix(record, accel, &scaled, turn_count, turn, b))
        return false;
    for (int j = 0; j < 3; j++) {
        const imk_vector3 column = {{b[3 * j], b[3 * j + 1], b[3 * j + 2]}};
        const double length = imk_vector3_norm(column);
        if (!(length > 0.0) || !isfinite(length))
            return false;
        scaled.unit[j] *= length;
    }
    *gyro = scaled;
    return true;
}
