/* SPDX-License-Identifier: Apache-2.0 */
/* Whether the attitudes of a magnetometer tell its parameters: the spread of the directions of the
 * field, the directions that would tell most, by the variance of the equation |u| = F there, and
 * the order of the axes that the response shows. */
#include "magnetometer_internal.h"

#include "imukit/linear_algebra.h"

#include "base/algebra/vector_internal.h"
#include "calibrate/estimator/calibration_internal.h"

#include <math.h>
#include <string.h>

static void find_spread(const imki_mag_fit *fit, imk_magnetometer_result *result)
{
    const imk_magnetometer *problem = fit->problem;
    double mean[3] = {0.0, 0.0, 0.0}, square[9] = {0.0}, value[3], vector[9];
    const double n = (double)problem->count;
    for (int pass = 0; pass < 2; pass++)
        for (size_t k = 0; k < problem->count; k++) {
            const double *u = problem->observation[k].field;
            const double length = imki_norm3(u) > 0.0 ? imki_norm3(u) : 1.0;
            for (int i = 0; pass == 0 && i < 3; i++)
                mean[i] += u[i] / length / n;
            for (int i = 0; pass == 1 && i < 9; i++)
                square[i] +=
                    (u[i / 3] / length - mean[i / 3]) * (u[i % 3] / length - mean[i % 3]) / n;
        }
    if (imk_symmetric_eigen(3, square, value, vector) != IMK_OK)
        return;
    result->spread = fmax(value[0], 0.0);
    for (int i = 0; i < 3; i++)
        result->normal[i] = vector[3 * i];
}

/* Usual sizes of what is sought: without them nothing is known along some directions. */
static void add_usual(imki_mag_fit *fit)
{
    const double field = fit->x[IMKI_MAG_FIELD];
    for (int p = 0; p < IMKI_MAG_ALL; p++) {
        const bool tesla = p < IMKI_MAG_RESPONSE || p == IMKI_MAG_FIELD;
        const double sigma = tesla ? field : 0.3;
        fit->normal[p * (IMKI_MAG_ALL + 1)] += 1.0 / (sigma * sigma);
    }
}

/* Directions to the faces, edges and corners of a cube. */
static void candidate(int index, double u[3])
{
    const int number = index < 13 ? index : index + 1; /* 13 is the middle */
    for (int i = 0, rest = number; i < 3; i++, rest /= 3)
        u[i] = rest % 3 - 1;
    const double length = imki_norm3(u);
    for (int i = 0; i < 3; i++)
        u[i] /= length;
}

static void advise(imki_mag_fit *fit, imk_magnetometer_result *result)
{
    enum { CANDIDATES = 26 };
    const double field = fit->x[IMKI_MAG_FIELD];
    add_usual(fit);
    for (int k = 0; k < IMK_MAGNETOMETER_ADVICE && imki_mag_invert(fit); k++) {
        double most = -1.0, best[IMKI_MAG_ALL] = {0.0};
        for (int c = 0; c < CANDIDATES; c++) {
            double u[3], gradient[IMKI_MAG_ALL] = {0.0}, variance = 0.0;
            candidate(c, u);
            for (int j = 0; j < 3; j++) {
                for (int i = 0; i < 3; i++)
                    gradient[j] -= fit->inverse.m[i][j] * u[i];
                for (int i = 0; i < 3; i++)
                    gradient[IMKI_MAG_RESPONSE + 3 * j + i] = gradient[j] * u[i] * field;
            }
            gradient[IMKI_MAG_FIELD] = -1.0;
            for (int p = 0; p < IMKI_MAG_ALL; p++)
                variance += gradient[p] * imki_dot(IMKI_MAG_ALL, gradient,
                                                   fit->covariance + (ptrdiff_t)p * IMKI_MAG_ALL);
            if (!(variance > most * (1.0 + 1e-9)))
                continue;
            most = variance;
            memcpy(best, gradient, sizeof best);
            memcpy(result->advice[k], u, sizeof u);
        }
        /* As well known as the noise of a good reading, a thousandth of the field. */
        for (int p = 0; p < IMKI_MAG_ALL; p++)
            for (int q = 0; q < IMKI_MAG_ALL; q++)
                fit->normal[p * IMKI_MAG_ALL + q] += best[p] * best[q] / (1e-6 * field * field);
    }
}

void imki_mag_coverage(const imki_mag_fit *fit, imk_magnetometer_result *result)
{
    imki_mag_fit copy = *fit;
    find_spread(fit, result);
    imki_mag_sum(&copy);
    advise(&copy, result);
}

int imki_mag_nearest(const double a[9], double *angle)
{
    double m[3][3], c[3][3] = {{0.0}}, best = -HUGE_VAL, trace = 0.0;
    int nearest = 0;
    memcpy(m, a, sizeof m);
    if (!imki_frame_rotation((const double(*)[3])m, IMK_FRAME_SYMMETRIC, c))
        memcpy(c, m, sizeof c);
    for (int k = 0; k < IMK_SIGNED_AXES; k++) {
        const imk_signed_axes axes = imk_signed_axes_of(k);
        double sum = 0.0;
        for (int i = 0; i < 3; i++)
            sum += axes.sign[i] * c[i][axes.column[i]];
        if (sum > best) {
            best = sum;
            nearest = k;
        }
    }
    trace = 0.5 * (best - 1.0);
    *angle = acos(fmax(-1.0, fmin(1.0, trace)));
    return nearest;
}
