/* SPDX-License-Identifier: Apache-2.0 */
/* Where the fit of a magnetometer begins. The ellipsoid by algebra, q . (squares, products,
 * components) = 1 of readings about their middle, by least squares; where that is no ellipsoid, a
 * sphere. Then its rotation from the dip: y . R f = -F sin(dip) is linear in the elements of R,
 * which are the null vector of ten unknowns; the 24 rotations that exchange axes are tried as well.
 */
#include "magnetometer_internal.h"

#include "imukit/linear_algebra.h"

#include "base/algebra/vector_internal.h"
#include "calibrate/estimator/calibration_internal.h"

#include <math.h>
#include <string.h>

enum { QUADRIC = 9, SPHERE = 4 };

typedef struct middle {
    double centre[3], radius;
} middle;

static middle middle_of(const imk_magnetometer *problem)
{
    middle m = {{0.0, 0.0, 0.0}, 0.0};
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    for (size_t k = 0; k < problem->count; k++)
        for (int i = 0; i < 3; i++) {
            const double x = problem->observation[k].reading[i];
            low[i] = fmin(low[i], x);
            high[i] = fmax(high[i], x);
        }
    for (int i = 0; i < 3; i++) {
        m.centre[i] = 0.5 * (low[i] + high[i]);
        m.radius = fmax(m.radius, 0.5 * (high[i] - low[i]));
    }
    return m;
}

static void scaled(const middle *m, const imk_magnetometer_observation *o, double z[3])
{
    for (int i = 0; i < 3; i++)
        z[i] = (o->reading[i] - m->centre[i]) / m->radius;
}

static void quadric_row(const double z[3], double row[QUADRIC])
{
    for (int i = 0; i < 3; i++) {
        row[i] = z[i] * z[i];
        row[3 + i] = 2.0 * z[i] * z[(i + 1) % 3];
        row[6 + i] = 2.0 * z[i];
    }
}

static void sphere_row(const double z[3], double row[QUADRIC])
{
    for (int i = 0; i < 3; i++)
        row[i] = 2.0 * z[i];
    row[3] = 1.0;
}

/* Least squares of row . q = 1, or of |z|^2 for a sphere. */
static bool solve_rows(const imk_magnetometer *problem, const middle *m, size_t n, double *q)
{
    double normal[QUADRIC * QUADRIC] = {0.0}, row[QUADRIC], z[3];
    for (size_t i = 0; i < n; i++)
        q[i] = 0.0;
    for (size_t k = 0; k < problem->count; k++) {
        scaled(m, &problem->observation[k], z);
        (n == QUADRIC ? quadric_row : sphere_row)(z, row);
        const double due = n == QUADRIC ? 1.0 : imki_dot3(z, z);
        for (size_t i = 0; i < n; i++) {
            q[i] += row[i] * due;
            for (size_t j = 0; j < n; j++)
                normal[i * n + j] += row[i] * row[j];
        }
    }
    if (imk_cholesky_factor(n, normal) != IMK_OK)
        return false;
    imk_cholesky_solve(n, normal, q);
    return true;
}

/* (z - c)^T Q (z - c) = 1: A with A A^T = Q^-1, symmetric; false: no ellipsoid like a sensor's. */
static bool ellipsoid(const double q[QUADRIC], double centre[3], double a[3][3])
{
    static const double flattest = 0.05; /* of the axes */
    imk_matrix3 m = {{{q[0], q[3], q[5]}, {q[3], q[1], q[4]}, {q[5], q[4], q[2]}}}, inverse;
    double value[3], vector[9], copy[9], k = 1.0;
    if (imk_matrix3_inverse(m, &inverse) != IMK_OK)
        return false;
    for (int i = 0; i < 3; i++) {
        centre[i] = -imki_dot3(inverse.m[i], q + 6);
        k -= centre[i] * q[6 + i];
    }
    memcpy(copy, m.m, sizeof copy);
    if (imk_symmetric_eigen(3, copy, value, vector) != IMK_OK)
        return false;
    for (int l = 0; l < 3; l++)
        if (!(value[l] / k > 0.0) || !(value[l] / value[2] > flattest * flattest))
            return false;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            a[i][j] = 0.0;
            for (int l = 0; l < 3; l++)
                a[i][j] += vector[3 * i + l] * vector[3 * j + l] / sqrt(value[l] / k);
        }
    return true;
}

static void sphere(const imk_magnetometer *problem, const middle *m, double centre[3],
                   double a[3][3])
{
    double q[SPHERE], radius = 1.0;
    memset(centre, 0, 3 * sizeof *centre);
    if (solve_rows(problem, m, SPHERE, q) && q[3] + imki_dot3(q, q) > 0.0 &&
        imki_dot3(q, q) < 100.0) {
        memcpy(centre, q, 3 * sizeof *centre);
        radius = sqrt(q[3] + imki_dot3(q, q));
    }
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            a[i][j] = i == j ? radius : 0.0;
}

/* ---- rotation -------------------------------------------------------------------------------- */

/* Variance of y . R f over the attitudes, and its mean. */
static double variance_of_dip(const imki_mag_fit *fit, const double r[3][3], double *mean)
{
    double n = 0.0, square = 0.0;
    *mean = 0.0;
    for (size_t k = 0; k < fit->problem->count; k++) {
        const imk_magnetometer_observation *o = &fit->problem->observation[k];
        double s = 0.0;
        if (!imki_mag_has_up(o))
            continue;
        for (int i = 0; i < 3; i++)
            s += o->field[i] * imki_dot3(r[i], o->up);
        n += 1.0;
        const double off = s - *mean;
        *mean += off / n;
        square += off * (s - *mean);
    }
    return square;
}

/* The rotation nearest to the null vector; false: there is none. */
static bool rotation_by_algebra(const imki_mag_fit *fit, double r[3][3])
{
    enum { N = 10 };
    double normal[N * N] = {0.0}, value[N], vector[N * N];
    for (size_t k = 0; k < fit->problem->count; k++) {
        const imk_magnetometer_observation *o = &fit->problem->observation[k];
        double row[N];
        if (!imki_mag_has_up(o))
            continue;
        for (int i = 0; i < 9; i++)
            row[i] = o->field[i / 3] * o->up[i % 3] / fit->x[IMKI_MAG_FIELD];
        row[9] = 1.0;
        for (int i = 0; i < N * N; i++)
            normal[i] += row[i / N] * row[i % N];
    }
    if (imk_symmetric_eigen(N, normal, value, vector) != IMK_OK)
        return false;
    imk_matrix3 m;
    for (int i = 0; i < 9; i++)
        m.m[i / 3][i % 3] = vector[i * N];
    imk_matrix3 inverse;
    double determinant = 0.0, cross[3];
    imki_cross3(m.m[1], m.m[2], cross);
    determinant = imki_dot3(m.m[0], cross);
    if (imk_matrix3_inverse(m, &inverse) != IMK_OK)
        return false;
    for (int i = 0; i < 9; i++)
        m.m[i / 3][i % 3] *= determinant < 0.0 ? -1.0 : 1.0;
    return imki_frame_rotation((const double(*)[3])m.m, IMK_FRAME_SYMMETRIC, r);
}

static void best_rotation(const imki_mag_fit *fit, double best[3][3], double *mean)
{
    double r[3][3], here, least = HUGE_VAL;
    for (int k = -1; k < IMK_SIGNED_AXES; k++) {
        const imk_signed_axes axes = imk_signed_axes_of(k);
        if (k < 0 ? !rotation_by_algebra(fit, r) : axes.determinant < 0)
            continue;
        for (int i = 0; k >= 0 && i < 9; i++)
            r[i / 3][i % 3] = axes.column[i / 3] == i % 3 ? axes.sign[i / 3] : 0.0;
        const double variance = variance_of_dip(fit, (const double(*)[3])r, &here);
        if (!(variance < least))
            continue;
        least = variance;
        *mean = here;
        memcpy(best, r, sizeof r);
    }
}

/* A = A_symmetric R */
static void turn(imki_mag_fit *fit, const double r[3][3])
{
    imk_matrix3 a, by;
    memcpy(a.m, fit->x + IMKI_MAG_RESPONSE, sizeof a.m);
    memcpy(by.m, r, sizeof by.m);
    a = imk_matrix3_multiply(a, by);
    memcpy(fit->x + IMKI_MAG_RESPONSE, a.m, sizeof a.m);
}

/* What a triangular frame has no part in is 0, not a rounding. */
static void clear_corner(imki_mag_fit *fit)
{
    const imk_triad_frame frame = fit->problem->frame;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            if ((frame == IMK_FRAME_UPPER && j < i) || (frame == IMK_FRAME_LOWER && j > i))
                fit->x[IMKI_MAG_RESPONSE + 3 * i + j] = 0.0;
}

void imki_mag_start(imki_mag_fit *fit)
{
    const imk_magnetometer *problem = fit->problem;
    const middle m = middle_of(problem);
    double q[QUADRIC], centre[3], a[3][3], r[3][3], mean = 0.0;
    if (!solve_rows(problem, &m, QUADRIC, q) || !ellipsoid(q, centre, a))
        sphere(problem, &m, centre, a);
    for (int i = 0; i < 3; i++)
        fit->x[i] = m.centre[i] + m.radius * centre[i];
    memcpy(fit->x + IMKI_MAG_RESPONSE, a, sizeof a);
    fit->x[IMKI_MAG_FIELD] = m.radius;
    fit->x[IMKI_MAG_DIP] = 0.0;
    (void)imki_mag_set_response(fit);
    for (size_t k = 0; k < problem->count; k++) {
        imk_magnetometer_observation *o = &problem->observation[k];
        memcpy(o->adjusted, o->reading, sizeof o->adjusted);
        for (int i = 0; i < 3; i++) {
            const double *row = fit->inverse.m[i];
            o->field[i] = 0.0;
            for (int j = 0; j < 3; j++)
                o->field[i] += row[j] * (o->reading[j] - fit->x[j]);
        }
    }
    if (fit->aligned) {
        best_rotation(fit, r, &mean);
        turn(fit, (const double(*)[3])r);
        fit->x[IMKI_MAG_DIP] = fmax(-1.0, fmin(1.0, -mean / fit->x[IMKI_MAG_FIELD]));
    } else if (imki_frame_rotation((const double(*)[3])a, problem->frame, r)) {
        imk_matrix3 c;
        memcpy(c.m, r, sizeof c.m);
        turn(fit, (const double(*)[3])imk_matrix3_transpose(c).m);
        clear_corner(fit);
    }
    for (int i = 0; fit->field_known && i < 9; i++)
        fit->x[IMKI_MAG_RESPONSE + i] *= fit->x[IMKI_MAG_FIELD] / problem->field;
    if (fit->field_known)
        fit->x[IMKI_MAG_FIELD] = problem->field;
    (void)imki_mag_set_response(fit);
}
