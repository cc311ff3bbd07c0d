/* SPDX-License-Identifier: Apache-2.0 */
/* The equations of a magnetometer in one attitude, and their sums. With y = A^-1 (m - h),
 *
 *     r1 = (|y|^2 - F^2)/(2 F) - tr(A^-1 V A^-T)/(2 F),      r2 = y . f + F sin(dip)
 *
 * V the covariance of the reading: the mean of |y|^2 lies above F^2 by the trace, which is the bias
 * of algebraic fits and is taken away. Derivatives are those at the adjusted reading, the point
 * nearest to m that fulfils both equations. Its error lies along the surface and is not correlated
 * with r, so that the sum of (dr/dx)^T W r has mean zero at the true x: nothing is left of the bias
 * in the second order of the noise. [MARKOVSKY2004] */
#include "magnetometer_internal.h"

#include "imukit/linear_algebra.h"

#include "base/algebra/vector_internal.h"

#include <math.h>
#include <string.h>

/* ---- independent parameters ------------------------------------------------------------------ */

static void add_free(imki_mag_fit *fit, int parameter)
{
    fit->map[parameter][fit->free++] = 1.0;
}

/* Elements of A that the frame leaves, where there is no `up`. */
static void map_frame(imki_mag_fit *fit)
{
    const imk_triad_frame frame = fit->problem->frame;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            const bool upper = frame == IMK_FRAME_UPPER, lower = frame == IMK_FRAME_LOWER;
            if (i == j || (upper && j > i) || (lower && j < i))
                add_free(fit, IMKI_MAG_RESPONSE + 3 * i + j);
            else if (!upper && !lower && j > i) {
                fit->map[IMKI_MAG_RESPONSE + 3 * j + i][fit->free] = 1.0;
                add_free(fit, IMKI_MAG_RESPONSE + 3 * i + j);
            }
        }
}

/* det A = 1 sets the scale: d log(det A) = sum of A^-T dA is 0. The independent parameter that it
 * depends on most follows the others. */
static void tie_scale(imki_mag_fit *fit)
{
    double slope[IMKI_MAG_ALL] = {0.0};
    size_t most = 0;
    for (size_t k = 0; k < fit->free; k++) {
        slope[k] = 0.0;
        for (int i = 0; i < 9; i++)
            slope[k] += fit->inverse.m[i % 3][i / 3] * fit->map[IMKI_MAG_RESPONSE + i][k];
        most = fabs(slope[k]) > fabs(slope[most]) ? k : most;
    }
    for (int p = 0; p < IMKI_MAG_ALL; p++) {
        const double tied = fit->map[p][most] / slope[most];
        for (size_t k = 0; k < fit->free; k++)
            fit->map[p][k] -= tied * slope[k];
        for (size_t k = most; k < fit->free; k++)
            fit->map[p][k] = k + 1 < fit->free ? fit->map[p][k + 1] : 0.0;
    }
    fit->free--;
}

static void map_parameters(imki_mag_fit *fit)
{
    const imk_magnetometer *problem = fit->problem;
    memset(fit->map, 0, sizeof fit->map);
    fit->free = 0;
    for (int i = 0; i < 3; i++)
        add_free(fit, IMKI_MAG_BIAS + i);
    if (fit->aligned)
        for (int i = 0; i < 9; i++)
            add_free(fit, IMKI_MAG_RESPONSE + i);
    else
        map_frame(fit);
    if (!fit->field_known)
        tie_scale(fit);
    if (!fit->field_known || problem->field_sigma > 0.0)
        add_free(fit, IMKI_MAG_FIELD);
    if (fit->aligned)
        add_free(fit, IMKI_MAG_DIP);
}

/* ---- equations ------------------------------------------------------------------------------- */

bool imki_mag_set_response(imki_mag_fit *fit)
{
    imk_matrix3 a;
    double cross[3];
    memcpy(a.m, fit->x + IMKI_MAG_RESPONSE, sizeof a.m);
    imki_cross3(a.m[1], a.m[2], cross);
    const double scale = fit->field_known ? 1.0 : cbrt(fabs(imki_dot3(a.m[0], cross)));
    for (int i = 0; i < 9; i++)
        a.m[i / 3][i % 3] /= scale;
    if (imk_matrix3_inverse(a, &fit->inverse) != IMK_OK)
        return false;
    memcpy(fit->x + IMKI_MAG_RESPONSE, a.m, sizeof a.m);
    fit->x[IMKI_MAG_FIELD] *= scale;
    map_parameters(fit);
    return true;
}

/* A^-1 (m - h) */
static void field_of(const imki_mag_fit *fit, const double reading[3], double y[3])
{
    for (int i = 0; i < 3; i++) {
        y[i] = 0.0;
        for (int j = 0; j < 3; j++)
            y[i] += fit->inverse.m[i][j] * (reading[j] - fit->x[j]);
    }
}

/* A^-T v */
static void to_reading(const imki_mag_fit *fit, const double v[3], double p[3])
{
    for (int j = 0; j < 3; j++) {
        p[j] = 0.0;
        for (int i = 0; i < 3; i++)
            p[j] += fit->inverse.m[i][j] * v[i];
    }
}

static double variance_of(const imki_mag_fit *fit, const imk_magnetometer_observation *o, int i)
{
    const double sigma = fit->factor * o->sigma[i];
    return sigma * sigma + fit->added * fit->added;
}

/* d r/d(h, A) from p = A^-T (dr/dy): dy = -A^-1 (dh + dA y). */
static void fill_gradient(const double p[3], const double y[3], double *gradient)
{
    for (int i = 0; i < 3; i++) {
        gradient[IMKI_MAG_BIAS + i] = -p[i];
        for (int j = 0; j < 3; j++)
            gradient[IMKI_MAG_RESPONSE + 3 * i + j] = -p[i] * y[j];
    }
}

static void invert_covariance(imki_mag_equations *e, const double c[3])
{
    memset(e->information, 0, sizeof e->information);
    if (e->count == 1) {
        e->information[0][0] = 1.0 / c[0];
        return;
    }
    const double determinant = c[0] * c[2] - c[1] * c[1];
    e->information[0][0] = c[2] / determinant;
    e->information[0][1] = e->information[1][0] = -c[1] / determinant;
    e->information[1][1] = c[0] / determinant;
}

void imki_mag_equate(const imki_mag_fit *fit, const imk_magnetometer_observation *o,
                     imki_mag_equations *e)
{
    const double F = fit->x[IMKI_MAG_FIELD], s = fit->x[IMKI_MAG_DIP];
    double here[3], y[3], along[3], p[2][3], v[3], covariance[3] = {0.0, 0.0, 0.0}, trace = 0.0;
    field_of(fit, o->reading, here);
    field_of(fit, fit->rough ? o->reading : o->adjusted, y);
    for (int i = 0; i < 3; i++) {
        along[i] = y[i] / F;
        v[i] = variance_of(fit, o, i);
        for (int j = 0; j < 3; j++)
            trace += fit->inverse.m[j][i] * fit->inverse.m[j][i] * v[i];
    }
    memset(e, 0, sizeof *e);
    e->count = fit->aligned && imki_mag_has_up(o) ? 2 : 1;
    e->residual[0] = (imki_dot3(here, here) - F * F - trace) / (2.0 * F);
    to_reading(fit, along, p[0]);
    to_reading(fit, o->up, p[1]);
    fill_gradient(p[0], y, e->gradient[0]);
    e->gradient[0][IMKI_MAG_FIELD] = -(imki_dot3(y, y) + F * F) / (2.0 * F * F);
    if (e->count == 2) {
        e->residual[1] = imki_dot3(here, o->up) + F * s;
        fill_gradient(p[1], y, e->gradient[1]);
        e->gradient[1][IMKI_MAG_FIELD] = s;
        e->gradient[1][IMKI_MAG_DIP] = F;
    }
    const double up = imki_dot3(y, o->up);
    for (int i = 0; i < 3; i++) {
        covariance[0] += p[0][i] * p[0][i] * v[i];
        covariance[1] += p[0][i] * p[1][i] * v[i];
        covariance[2] += p[1][i] * p[1][i] * v[i];
        e->up_gradient[i] = y[i] - up * o->up[i];
    }
    e->up_variance = fit->up_factor * fit->up_factor * o->up_sigma * o->up_sigma *
                     imki_dot3(e->up_gradient, e->up_gradient);
    covariance[2] += e->up_variance;
    invert_covariance(e, covariance);
    for (int i = 0; i < 3; i++) {
        e->adjusted[i] = o->reading[i];
        for (int k = 0; k < e->count; k++)
            e->adjusted[i] -=
                v[i] * p[k][i] *
                (e->information[k][0] * e->residual[0] + e->information[k][1] * e->residual[1]);
    }
}

/* ---- sums ------------------------------------------------------------------------------------ */

static void add_equations(imki_mag_fit *fit, double weight, const imki_mag_equations *e)
{
    for (int k = 0; k < e->count; k++) {
        double combined[IMKI_MAG_ALL], pull = 0.0;
        for (int p = 0; p < IMKI_MAG_ALL; p++) {
            combined[p] = 0.0;
            for (int l = 0; l < e->count; l++)
                combined[p] += weight * e->information[k][l] * e->gradient[l][p];
        }
        for (int l = 0; l < e->count; l++)
            pull += weight * e->information[k][l] * e->residual[l];
        fit->chi_square += pull * e->residual[k];
        for (int p = 0; p < IMKI_MAG_ALL; p++) {
            fit->gradient[p] += e->gradient[k][p] * pull;
            for (int q = 0; q < IMKI_MAG_ALL; q++)
                fit->normal[p * IMKI_MAG_ALL + q] += e->gradient[k][p] * combined[q];
        }
    }
}

/* What is known before of the field. */
static void add_known(imki_mag_fit *fit)
{
    const imk_magnetometer *problem = fit->problem;
    if (fit->field_known && problem->field_sigma > 0.0) {
        const double weight = 1.0 / (problem->field_sigma * problem->field_sigma);
        fit->normal[IMKI_MAG_FIELD * (IMKI_MAG_ALL + 1)] += weight;
        fit->gradient[IMKI_MAG_FIELD] += weight * (fit->x[IMKI_MAG_FIELD] - problem->field);
    }
}

void imki_mag_sum(imki_mag_fit *fit)
{
    const imk_magnetometer *problem = fit->problem;
    memset(fit->normal, 0, sizeof fit->normal);
    memset(fit->gradient, 0, sizeof fit->gradient);
    fit->chi_square = 0.0;
    for (size_t k = 0; k < problem->count; k++) {
        imk_magnetometer_observation *o = &problem->observation[k];
        imki_mag_equations e;
        imki_mag_equate(fit, o, &e);
        memcpy(o->adjusted, e.adjusted, sizeof o->adjusted);
        if (o->weight > 0.0)
            add_equations(fit, o->weight, &e);
    }
    add_known(fit);
}

/* map^T normal map, scaled to a unit diagonal; its factor in `factor`. */
static bool factorise(const imki_mag_fit *fit, double *factor, double *scale)
{
    const size_t n = fit->free;
    double half[IMKI_MAG_ALL][IMKI_MAG_ALL];
    for (int p = 0; p < IMKI_MAG_ALL; p++)
        for (size_t k = 0; k < n; k++) {
            half[p][k] = 0.0;
            for (int q = 0; q < IMKI_MAG_ALL; q++)
                half[p][k] += fit->normal[p * IMKI_MAG_ALL + q] * fit->map[q][k];
        }
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) {
            factor[i * n + j] = 0.0;
            for (int p = 0; p < IMKI_MAG_ALL; p++)
                factor[i * n + j] += fit->map[p][i] * half[p][j];
        }
    for (size_t i = 0; i < n; i++) {
        if (!(factor[i * n + i] > 0.0))
            return false;
        scale[i] = 1.0 / sqrt(factor[i * n + i]);
    }
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++)
            factor[i * n + j] *= scale[i] * scale[j];
    return imk_cholesky_factor(n, factor) == IMK_OK;
}

bool imki_mag_invert(imki_mag_fit *fit)
{
    double factor[IMKI_MAG_ALL * IMKI_MAG_ALL], inverse[IMKI_MAG_ALL * IMKI_MAG_ALL];
    double scale[IMKI_MAG_ALL], half[IMKI_MAG_ALL][IMKI_MAG_ALL];
    const size_t n = fit->free;
    if (!factorise(fit, factor, scale))
        return false;
    imk_cholesky_inverse(n, factor, inverse);
    for (int p = 0; p < IMKI_MAG_ALL; p++)
        for (size_t k = 0; k < n; k++) {
            half[p][k] = 0.0;
            for (size_t l = 0; l < n; l++)
                half[p][k] += fit->map[p][l] * scale[l] * inverse[l * n + k] * scale[k];
        }
    for (int p = 0; p < IMKI_MAG_ALL; p++)
        for (int q = 0; q < IMKI_MAG_ALL; q++)
            fit->covariance[p * IMKI_MAG_ALL + q] = imki_dot(n, half[p], fit->map[q]);
    return true;
}

bool imki_mag_step(imki_mag_fit *fit, double *size)
{
    double change[IMKI_MAG_ALL], next[IMKI_MAG_ALL], shorter = 1.0;
    const imki_mag_fit before = *fit;
    if (!imki_mag_invert(fit))
        return false;
    *size = 0.0;
    for (int p = 0; p < IMKI_MAG_ALL; p++) {
        change[p] =
            -imki_dot(IMKI_MAG_ALL, fit->covariance + (ptrdiff_t)p * IMKI_MAG_ALL, fit->gradient);
        const double sigma = sqrt(fit->covariance[p * (IMKI_MAG_ALL + 1)]);
        if (sigma > 0.0)
            *size = fmax(*size, fabs(change[p]) / sigma);
        /* No step turns or stretches by more than a quarter. */
        const double whole =
            p < IMKI_MAG_RESPONSE || p == IMKI_MAG_FIELD ? fit->x[IMKI_MAG_FIELD] : 1.0;
        shorter = fmin(shorter, 0.25 * whole / (fabs(change[p]) + 1e-30));
    }
    for (int p = 0; p < IMKI_MAG_ALL; p++)
        next[p] = fit->x[p] + shorter * change[p];
    memcpy(fit->x, next, sizeof next);
    if (fit->x[IMKI_MAG_FIELD] > 0.0 && imki_mag_set_response(fit))
        return true;
    *fit = before;
    return false;
}
