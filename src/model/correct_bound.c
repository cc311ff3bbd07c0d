/* SPDX-License-Identifier: Apache-2.0 */
/* How fast the fixed point of correct.h is reached, proven before the first sample.
 *
 * Let x* be the solution and e the error of x. The mean value theorem gives, with derivatives of
 * the channels between C - R and C + R over a box that holds x, x* and what lies between them,
 *
 *     |e after| <= P |e before|,   P = |I - J+ C| + |J+| R                 [NEUMAIER1990, ch. 5]
 *
 * element by element. Starting from x = 0, |e| is the limit of the motion before the first step;
 * the box of each later step is as large as what is left of it. J+ comes from the middle of the
 * derivatives over the range, which makes P smallest. */
#include "correct_internal.h"

#include "base/algebra/vector_internal.h"
#include "imukit/linear_algebra.h"

#include <math.h>
#include <string.h>

typedef double square[IMKI_UNKNOWNS][IMKI_UNKNOWNS];

/* Bounds that have grown to so many limits do not shrink again. */
static const double hopeless = 1e6;

imk_status imki_pseudo_inverse(int rows, const double (*matrix)[3], double (*out)[IMK_AXES_MAX])
{
    double normal[9] = {0.0}, inverse[9];
    for (int i = 0; i < rows; i++)
        for (int j = 0; j < 9; j++)
            normal[j] += matrix[i][j / 3] * matrix[i][j % 3];
    if (imk_cholesky_factor(3, normal) != IMK_OK)
        return IMK_ERROR_SINGULAR;
    imk_cholesky_inverse(3, normal, inverse);
    for (int j = 0; j < 3; j++)
        for (int i = 0; i < rows; i++)
            out[j][i] = imki_dot3(inverse + 3 * j, matrix[i]);
    /* X <- X + (I - X J) X takes out the rounding of the normal equations. */
    double rest[3][3], better[3][IMK_AXES_MAX];
    for (int j = 0; j < 9; j++) {
        rest[j / 3][j % 3] = j % 4 == 0 ? 1.0 : 0.0;
        for (int i = 0; i < rows; i++)
            rest[j / 3][j % 3] -= out[j / 3][i] * matrix[i][j % 3];
    }
    for (int j = 0; j < 3; j++)
        for (int i = 0; i < rows; i++)
            better[j][i] = rest[j][0] * out[0][i] + rest[j][1] * out[1][i] + rest[j][2] * out[2][i];
    for (int j = 0; j < 3; j++)
        for (int i = 0; i < rows; i++)
            out[j][i] += better[j][i];
    return IMK_OK;
}

/* Own block of J+ of one kind of sensor, and of J what it takes from the other kind. */
static imk_status invert_own(imki_inversion *v, int sensor, double (*coupling)[3])
{
    const int own = sensor * IMK_AXES_MAX, other = IMK_AXES_MAX - own;
    double rows[IMK_AXES_MAX][3], center[IMKI_UNKNOWNS], radius[IMKI_UNKNOWNS];
    double inverse[3][IMK_AXES_MAX];
    const int axes = v->distortion->axis_count[sensor];
    for (int i = 0; i < axes; i++) {
        imki_channel_derivatives(v, sensor, i, NULL, center, radius);
        memcpy(rows[i], center + own, sizeof rows[i]);
        memcpy(coupling[i], center + other, sizeof coupling[i]);
        if (!v->solves[sensor] && !(fabs(center[own + i]) > 1e-12))
            return IMK_ERROR_SINGULAR;
        if (!v->solves[sensor])
            v->inverse[own + i][own + i] = 1.0 / center[own + i];
    }
    if (!v->solves[sensor])
        return IMK_OK;
    if (imki_pseudo_inverse(axes, (const double(*)[3])rows, inverse) != IMK_OK)
        return IMK_ERROR_SINGULAR;
    for (int j = 0; j < 3; j++)
        memcpy(v->inverse[own + j] + own, inverse[j], (size_t)axes * sizeof **inverse);
    return IMK_OK;
}

/* The accelerometers alone determine the forces; what these do to the gyros is subtracted from
 * their readings: J+ of the gyros is (Jg+, -Jg+ G Ja+). */
imk_status imki_invert_middle(imki_inversion *inversion, int *sensor)
{
    imki_inversion *v = inversion;
    double unused[IMK_AXES_MAX][3], coupling[IMK_AXES_MAX][3] = {{0.0}};
    const int axes = v->distortion->axis_count[IMK_GYRO];
    memset(v->inverse, 0, sizeof v->inverse);
    for (*sensor = IMK_GYRO; *sensor <= IMK_ACCEL; ++*sensor)
        if (v->outputs[*sensor] > 0 &&
            invert_own(v, *sensor, *sensor == IMK_GYRO ? coupling : unused) != IMK_OK)
            return IMK_ERROR_SINGULAR;
    if (!v->solves[IMK_GYRO] || !v->solves[IMK_ACCEL])
        return IMK_OK;
    for (int j = 0; j < 3; j++)
        for (int k = 0; k < 3; k++) {
            double force = 0.0;
            for (int i = 0; i < axes; i++)
                force += v->inverse[j][i] * coupling[i][k];
            for (int c = IMK_AXES_MAX; force != 0.0 && c < IMKI_UNKNOWNS; c++)
                v->inverse[j][c] -= force * v->inverse[IMK_AXES_MAX + k][c];
        }
    return IMK_OK;
}

static void bound_matrix(const imki_inversion *v, const double *error, square p)
{
    square rest = {{0.0}};
    double center[IMKI_UNKNOWNS], radius[IMKI_UNKNOWNS];
    memset(p, 0, sizeof(square));
    for (int a = 0; a < IMKI_UNKNOWNS; a++)
        rest[a][a] = a % IMK_AXES_MAX < v->outputs[a / IMK_AXES_MAX] ? 1.0 : 0.0;
    for (int c = 0; c < IMKI_UNKNOWNS; c++) {
        if (c % IMK_AXES_MAX >= v->distortion->axis_count[c / IMK_AXES_MAX])
            continue;
        imki_channel_derivatives(v, c / IMK_AXES_MAX, c % IMK_AXES_MAX, error, center, radius);
        for (int a = 0; a < IMKI_UNKNOWNS; a++) {
            const double gain = v->inverse[a][c];
            for (int b = 0; gain != 0.0 && b < IMKI_UNKNOWNS; b++) {
                rest[a][b] -= gain * center[b];
                p[a][b] += fabs(gain) * radius[b];
            }
        }
    }
    for (int a = 0; a < IMKI_UNKNOWNS; a++)
        for (int b = 0; b < IMKI_UNKNOWNS; b++)
            p[a][b] += fabs(rest[a][b]);
}

static void step(square p, double *error)
{
    double after[IMKI_UNKNOWNS] = {0.0};
    for (int a = 0; a < IMKI_UNKNOWNS; a++)
        for (int b = 0; b < IMKI_UNKNOWNS; b++)
            after[a] += p[a][b] * error[b];
    memcpy(error, after, sizeof after);
}

static bool all_within(const double *values, double factor, const double *limits)
{
    for (int a = 0; a < IMKI_UNKNOWNS; a++)
        if (!(values[a] <= factor * limits[a]))
            return false;
    return true;
}

/* Gelfand's formula: |P^n|^(1/n), n = 64, of P with every unknown in units of its limit. Each
 * squared matrix is divided by its norm, whose root is carried. */
static double spectral_radius(const imki_inversion *v, square p)
{
    square product;
    double radius = 1.0;
    for (int a = 0; a < IMKI_UNKNOWNS; a++)
        for (int b = 0; b < IMKI_UNKNOWNS; b++)
            p[a][b] *= v->limit[a] > 0.0 ? v->limit[b] / v->limit[a] : 0.0;
    for (int squarings = 0; squarings <= 6; squarings++) {
        double norm = 0.0;
        for (int a = 0; a < IMKI_UNKNOWNS; a++) {
            double sum = 0.0;
            for (int b = 0; b < IMKI_UNKNOWNS; b++)
                sum += p[a][b];
            norm = fmax(norm, sum);
        }
        if (!(norm > 0.0))
            return 0.0;
        double root = norm;
        for (int i = 0; i < squarings; i++)
            root = sqrt(root);
        radius *= root;
        for (int a = 0; a < IMKI_UNKNOWNS; a++)
            for (int b = 0; b < IMKI_UNKNOWNS; b++) {
                product[a][b] = 0.0;
                for (int c = 0; c < IMKI_UNKNOWNS; c++)
                    product[a][b] += (p[a][c] / norm) * (p[c][b] / norm);
            }
        memcpy(p, product, sizeof product);
    }
    return radius;
}

double imki_contraction(const imki_inversion *inversion)
{
    square p;
    bound_matrix(inversion, NULL, p);
    return spectral_radius(inversion, p);
}

imk_status imki_count_iterations(const imki_inversion *inversion, double tolerance, int *iterations,
                                 double *contraction, double error[IMKI_UNKNOWNS])
{
    square p;
    memcpy(error, inversion->limit, sizeof inversion->limit);
    for (*iterations = 1; *iterations <= IMKI_ITERATIONS_MAX; ++*iterations) {
        bound_matrix(inversion, *iterations == 1 ? NULL : error, p);
        step(p, error);
        if (all_within(error, tolerance, inversion->limit)) {
            *contraction = *iterations == 1 ? 0.0 : spectral_radius(inversion, p);
            return IMK_OK;
        }
        if (!all_within(error, hopeless, inversion->limit))
            break;
    }
    return IMK_ERROR_NO_CONVERGENCE;
}
