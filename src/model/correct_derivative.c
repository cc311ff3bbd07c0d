/* SPDX-License-Identifier: Apache-2.0 */
/* Intervals of the derivatives of a channel with respect to the unknowns x. With the features'
 * weights, u and the other linear part have derivatives that are constant in the components of the
 * channel's own kind and, for products, linear in those of the other kind; then
 *
 *     dy/dx = (1 + s + n'(u)) du/dx + d other/dx
 *             + Kip (p du + u dp) + Kio (o du + u do) + Kpo (o dp + p do)
 *
 * over all of |u| <= U and so on. The bounds grow from those of the true motion by the distance
 * between the solution and an iterate. Of the angular acceleration nothing is asked after the first
 * step: it is the same for both. On the way from 0 to the solution, t x, an input is
 * t u* + (1 - t) a + (t^2 - t) l, with the part a of the angular acceleration within the limit too
 * and l from w x (w x r): within U + |l|/4. */
#include "correct_internal.h"

#include <math.h>
#include <string.h>

enum { OWN = 0, CROSS = 3, PRODUCTS = 3, MIXED = 6, THIRD = 9 };

/* With respect to the components of the own and of the other kind. */
typedef struct gradient {
    double center[6], radius[6];
} gradient;

/* Where the derivatives are asked for. */
typedef struct box {
    double cross[3]; /* largest components of the other kind */
    double own_error[3], cross_error[3];
    double u, p, o;
} box;

static gradient gradient_of(const double *weight, int sensor, const double cross[3])
{
    gradient g;
    for (int j = 0; j < 3; j++) {
        const int next = (j + 1) % 3, before = (j + 2) % 3;
        g.center[OWN + j] = weight[j];
        g.radius[OWN + j] = 0.0;
        g.center[CROSS + j] = sensor == IMK_GYRO ? weight[THIRD + j] : 0.0;
        g.radius[CROSS + j] = 2.0 * fabs(weight[PRODUCTS + j]) * cross[j] +
                              fabs(weight[MIXED + j]) * cross[next] +
                              fabs(weight[MIXED + before]) * cross[before];
    }
    return g;
}

static double largest(const gradient *g, int j)
{
    return fabs(g->center[j]) + g->radius[j];
}

/* By how much u, p or o can be beyond its true limit. */
static double growth(const double *weight, int sensor, const box *b, bool is_first)
{
    double sum = 0.0;
    if (is_first) {
        for (int j = 0; sensor == IMK_ACCEL && j < 3; j++)
            sum += 0.25 *
                   (fabs(weight[PRODUCTS + j]) * b->cross[j] +
                    fabs(weight[MIXED + j]) * b->cross[(j + 1) % 3]) *
                   b->cross[j];
        return sum;
    }
    const gradient g = gradient_of(weight, sensor, b->cross);
    for (int j = 0; j < 3; j++)
        sum += largest(&g, OWN + j) * b->own_error[j] + largest(&g, CROSS + j) * b->cross_error[j];
    return sum;
}

static box box_of(const imki_inversion *v, int sensor, int i, const double *error)
{
    const imk_axis_response *axis = &v->distortion->axis[sensor][i];
    const int own = sensor * IMK_AXES_MAX, other = IMK_AXES_MAX - own;
    double most = 0.0;
    box b;
    memset(&b, 0, sizeof b);
    for (int j = 0; j < 3; j++) {
        const double limit = v->limit[v->solves[sensor] ? own + j : own + i];
        most += fabs(axis->input[j]) * limit; /* of clipped components */
        b.p += fabs(axis->pendulous[j]) * limit;
        b.o += fabs(axis->output[j]) * limit;
        /* A set that is not solved has no effect on the other kind: imk_correction_start(). */
        if (v->solves[1 - sensor]) {
            b.cross_error[j] = error ? error[other + j] : 0.0;
            b.cross[j] = v->limit[other + j] + b.cross_error[j];
        }
        if (error)
            b.own_error[j] =
                v->solves[sensor] ? error[own + j] : fabs(v->along[sensor][i][j]) * error[own + i];
    }
    b.u = v->input_limit[sensor][i] + growth(axis->input, sensor, &b, !error);
    if (v->stays_within[sensor] && !axis->has_place)
        b.u = fmin(b.u, most);
    b.p += growth(axis->pendulous, sensor, &b, !error);
    b.o += growth(axis->output, sensor, &b, !error);
    return b;
}

static void add_cross_products(const imk_axis_response *axis, int sensor, const box *b,
                               const gradient *gu, gradient *sum)
{
    const gradient gp = gradient_of(axis->pendulous, sensor, b->cross);
    const gradient go = gradient_of(axis->output, sensor, b->cross);
    for (int j = 0; j < 6; j++) {
        const double du = largest(gu, j), dp = largest(&gp, j), dout = largest(&go, j);
        sum->radius[j] += fabs(axis->kip) * (du * b->p + b->u * dp) +
                          fabs(axis->kio) * (du * b->o + b->u * dout) +
                          fabs(axis->kpo) * (dp * b->o + b->p * dout);
    }
}

static gradient body_gradient(const imk_axis_response *axis, int sensor, const box *b)
{
    const gradient gu = gradient_of(axis->input, sensor, b->cross);
    const imki_interval slope = imki_slope(axis, b->u);
    gradient sum = gradient_of(axis->other, sensor, b->cross);
    for (int j = 0; j < 6; j++) {
        sum.center[j] += (1.0 + slope.center) * gu.center[j];
        sum.radius[j] += fabs(1.0 + slope.center) * gu.radius[j] + slope.radius * largest(&gu, j);
    }
    if (axis->has_cross_products)
        add_cross_products(axis, sensor, b, &gu, &sum);
    return sum;
}

void imki_channel_derivatives(const imki_inversion *inversion, int sensor, int axis,
                              const double *error, double *center, double *radius)
{
    const int own = sensor * IMK_AXES_MAX, other = IMK_AXES_MAX - own;
    const box b = box_of(inversion, sensor, axis, error);
    const gradient g = body_gradient(&inversion->distortion->axis[sensor][axis], sensor, &b);
    memset(center, 0, IMKI_UNKNOWNS * sizeof *center);
    memset(radius, 0, IMKI_UNKNOWNS * sizeof *radius);
    for (int j = 0; j < 3; j++) {
        const double along = inversion->along[sensor][axis][j];
        if (inversion->solves[sensor]) {
            center[own + j] = g.center[OWN + j];
            radius[own + j] = g.radius[OWN + j];
        } else {
            center[own + axis] += along * g.center[OWN + j];
            radius[own + axis] += fabs(along) * g.radius[OWN + j];
        }
        if (inversion->solves[1 - sensor]) {
            center[other + j] = g.center[CROSS + j];
            radius[other + j] = g.radius[CROSS + j];
        }
    }
}
