/* SPDX-License-Identifier: Apache-2.0 */
/* How the errors of a strapdown navigator grow over a step h, in Earth-fixed axes [GROVES2013]:
 *
 *     dr' = dv
 *     dv' = -[f x] e - 2 w x dv + G dr + C b_a + C n_a,     G = (g/R) (3 u u^T - I)
 *     e'  = -w x e + C b_g + C n_g
 *     b'  = -b/T + n                                          each part of a bias
 *
 * with f and C the means of specific force and attitude over the step, u upwards. With F the matrix
 * of the nine errors and B that of the biases (C in the rows of e or dv),
 *
 *     Phi = I + F h + F^2 h^2/2 + F^3 h^3/6,     Gamma = (I h + F h^2/2 + F^2 h^3/6) B
 *     P  <- Phi P Phi^T + integral of A(s) N^2 A(s)^T ds,     A(s) = (I + F s + F^2 s^2/2) B
 *
 * the integral by Simpson's rule, which is exact for velocity and attitude. A part decays by
 * e^{-h/T} from step to step and is constant within: the sum's variance then is 1 + h^2/(12 T^2)
 * times that of the integral. What else is left out is of order (h/R) g and (h |w|)^4: nothing for
 * steps of a second. The integral of the gyros' noise
 * since a stand began, s, has with the errors the covariance J <- Phi J + Gamma N^2. */
#include "navigation_filter_internal.h"

#include "imukit/earth.h"
#include "imukit/elementary.h"

#include <string.h>

enum { ERRORS = IMK_NAVIGATION_ERRORS };

typedef double square[ERRORS][ERRORS];

static void multiply(square a, square b, square out)
{
    for (int i = 0; i < ERRORS; i++)
        for (int j = 0; j < ERRORS; j++) {
            double sum = 0.0;
            for (int k = 0; k < ERRORS; k++)
                sum += a[i][k] * b[k][j];
            out[i][j] = sum;
        }
}

/* The matrix of v x, times a factor, into the 3 x 3 block at (row, column). */
static void set_cross(square m, int row, int column, imk_vector3 v, double factor)
{
    m[row][column + 1] = -factor * v.v[2];
    m[row][column + 2] = factor * v.v[1];
    m[row + 1][column] = factor * v.v[2];
    m[row + 1][column + 2] = -factor * v.v[0];
    m[row + 2][column] = -factor * v.v[1];
    m[row + 2][column + 1] = factor * v.v[0];
}

static imk_vector3 upward(imk_vector3 gravity)
{
    return imk_vector3_scale(gravity, -1.0 / imk_vector3_norm(gravity));
}

static void error_matrix(const imk_navigation_filter *f, imk_vector3 force, square m)
{
    const imk_vector3 earth = {{0.0, 0.0, IMK_EARTH_RATE}};
    const imk_vector3 place = f->strapdown.state.position;
    const imk_vector3 gravity = imk_gravity_ecef(place);
    const imk_vector3 up = upward(gravity);
    /* Either radius of curvature is within 0.4 % of the distance from the centre. */
    const double stiffness = imk_vector3_norm(gravity) / imk_vector3_norm(place);
    memset(m, 0, sizeof(square));
    for (int i = 0; i < 3; i++) {
        m[i][3 + i] = 1.0;
        for (int j = 0; j < 3; j++)
            m[3 + i][j] = stiffness * (3.0 * up.v[i] * up.v[j] - (i == j ? 1.0 : 0.0));
    }
    set_cross(m, 3, 3, earth, -2.0);
    set_cross(m, 3, 6, force, -1.0);
    set_cross(m, 6, 6, earth, -1.0);
}

/* The step: phi (9 x 9), gamma (9 x 3) of gyro and accelerometer biases, and the white noise. */
typedef struct step_matrices {
    square phi;
    double gamma[2][ERRORS][3];
    square noise;
} step_matrices;

/* Adds weight * N^2 a a^T, a what a unit of noise on one axis has become after the time s. */
static void add_noise(square m, square m2, const double b[ERRORS], double s, double weight,
                      square noise)
{
    double a[ERRORS];
    for (int i = 0; i < ERRORS; i++) {
        a[i] = b[i];
        for (int k = 0; k < ERRORS; k++)
            a[i] += s * (m[i][k] + 0.5 * s * m2[i][k]) * b[k];
    }
    for (int i = 0; i < ERRORS; i++)
        for (int j = 0; j < ERRORS; j++)
            noise[i][j] += weight * a[i] * a[j];
}

static void make_step(const imk_navigation_filter *f, double h, const imk_matrix3 *c,
                      imk_vector3 force, step_matrices *step)
{
    const imk_triad_errors *triad[2] = {&f->settings.gyro, &f->settings.accel};
    square m, m2, m3, integral;
    error_matrix(f, force, m);
    multiply(m, m, m2);
    multiply(m2, m, m3);
    for (int i = 0; i < ERRORS; i++)
        for (int j = 0; j < ERRORS; j++) {
            const double one = i == j ? 1.0 : 0.0;
            step->phi[i][j] = one + h * (m[i][j] + 0.5 * h * (m2[i][j] + h / 3.0 * m3[i][j]));
            integral[i][j] = h * (one + 0.5 * h * (m[i][j] + h / 3.0 * m2[i][j]));
            step->noise[i][j] = 0.0;
        }
    for (int sensor = 0; sensor < 2; sensor++)
        for (int axis = 0; axis < 3; axis++) {
            const int rows = sensor == IMKI_GYRO_PART ? 6 : 3;
            const double n = triad[sensor]->white[axis], power = n * n * h;
            double b[ERRORS] = {0};
            for (int k = 0; k < 3; k++)
                b[rows + k] = c->m[k][axis];
            for (int i = 0; i < ERRORS; i++) {
                step->gamma[sensor][i][axis] = 0.0;
                for (int k = 0; k < ERRORS; k++)
                    step->gamma[sensor][i][axis] += integral[i][k] * b[k];
            }
            add_noise(m, m2, b, 0.0, power / 6.0, step->noise);
            add_noise(m, m2, b, 0.5 * h, power * 2.0 / 3.0, step->noise);
            add_noise(m, m2, b, h, power / 6.0, step->noise);
        }
}

/* Of each part over a step: what remains of it, and what noise is added. */
typedef struct part_step {
    double decay, noise[3];
} part_step;

double imki_bias_part_decay(const imk_bias_part *part, double h)
{
    const double t = part->correlation_time;
    return t > 0.0 ? 1.0 + imk_expm1(-h / t) : 1.0;
}

static part_step make_part(const imk_bias_part *part, double h)
{
    part_step step = {.decay = imki_bias_part_decay(part, h)};
    const double t = part->correlation_time;
    if (t > 0.0) {
        const double lost = -imk_expm1(-h / t);
        for (int i = 0; i < 3; i++)
            step.noise[i] = part->sigma[i] * part->sigma[i] * lost * (2.0 - lost);
    } else {
        for (int i = 0; i < 3; i++)
            step.noise[i] = part->walk[i] * part->walk[i] * h;
    }
    return step;
}

/* One vector of all errors by the step: `stride` apart, in place. */
static void advance(const imk_navigation_filter *f, const step_matrices *step,
                    const part_step *parts, double *x, size_t stride)
{
    double now[ERRORS], bias[2][3] = {{0}};
    for (int i = 0; i < ERRORS; i++)
        now[i] = x[(size_t)i * stride];
    double *at = x + ERRORS * stride;
    for (int sensor = 0; sensor < 2; sensor++)
        for (size_t p = 0; p < f->parts[sensor]; p++, parts++)
            for (int axis = 0; axis < 3; axis++, at += stride) {
                bias[sensor][axis] += *at;
                *at *= parts->decay;
            }
    for (int i = 0; i < ERRORS; i++) {
        double sum = 0.0;
        for (int k = 0; k < ERRORS; k++)
            sum += step->phi[i][k] * now[k];
        for (int sensor = 0; sensor < 2; sensor++)
            for (int axis = 0; axis < 3; axis++)
                sum += step->gamma[sensor][i][axis] * bias[sensor][axis];
        x[(size_t)i * stride] = sum;
    }
}

/* Height and climb are those of another instrument: no error there. */
static void hold_vertical(imk_vector3 up, double *x, size_t stride)
{
    for (size_t block = 0; block < 6; block += 3) {
        double along = 0.0;
        for (size_t i = 0; i < 3; i++)
            along += up.v[i] * x[(block + i) * stride];
        for (size_t i = 0; i < 3; i++)
            x[(block + i) * stride] -= along * up.v[i];
    }
}

static void make_symmetric(imk_navigation_filter *f)
{
    const size_t n = f->states;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < i; j++) {
            const double mean = 0.5 * (f->covariance[i * n + j] + f->covariance[j * n + i]);
            f->covariance[i * n + j] = f->covariance[j * n + i] = mean;
        }
}

/* Parts of the biases: their noise, and the decay of their estimates. */
static void advance_parts(imk_navigation_filter *f, const part_step *parts)
{
    size_t state = ERRORS;
    for (int sensor = 0; sensor < 2; sensor++) {
        f->bias_sum[sensor] = (imk_vector3){{0}};
        for (size_t p = 0; p < f->parts[sensor]; p++, parts++)
            for (int axis = 0; axis < 3; axis++, state++) {
                f->bias[sensor][p][axis] *= parts->decay;
                f->bias_sum[sensor].v[axis] += f->bias[sensor][p][axis];
                f->covariance[state * f->states + state] += parts->noise[axis];
            }
    }
}

static void advance_cross(imk_navigation_filter *f, const step_matrices *step,
                          const part_step *parts, imk_vector3 up)
{
    for (size_t axis = 0; axis < 3; axis++) {
        const double n = f->settings.gyro.white[axis];
        advance(f, step, parts, f->cross + axis, 3);
        for (size_t i = 0; i < ERRORS; i++)
            f->cross[3 * i + axis] += step->gamma[IMKI_GYRO_PART][i][axis] * n * n;
        if (f->settings.hold_height)
            hold_vertical(up, f->cross + axis, 3);
    }
}

void imki_navigation_filter_propagate(imk_navigation_filter *f)
{
    const double h = f->span;
    if (!(h > 0.0))
        return;
    step_matrices step;
    part_step parts[2 * IMK_BIAS_PARTS_MAX];
    imk_matrix3 c = f->turned;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            c.m[i][j] /= h;
    make_step(f, h, &c, imk_vector3_scale(f->force, 1.0 / h), &step);
    for (size_t p = 0; p < f->parts[0]; p++)
        parts[p] = make_part(&f->settings.gyro.part[p], h);
    for (size_t p = 0; p < f->parts[1]; p++)
        parts[f->parts[0] + p] = make_part(&f->settings.accel.part[p], h);

    const imk_vector3 up = upward(imk_gravity_ecef(f->strapdown.state.position));
    for (size_t column = 0; column < f->states; column++)
        advance(f, &step, parts, f->covariance + column, f->states);
    for (size_t row = 0; row < f->states; row++)
        advance(f, &step, parts, f->covariance + row * f->states, 1);
    for (size_t i = 0; i < ERRORS; i++)
        for (size_t j = 0; j < ERRORS; j++)
            f->covariance[i * f->states + j] += step.noise[i][j];
    for (size_t column = 0; column < f->states && f->settings.hold_height; column++)
        hold_vertical(up, f->covariance + column, f->states);
    for (size_t row = 0; row < f->states && f->settings.hold_height; row++)
        hold_vertical(up, f->covariance + row * f->states, 1);
    advance_parts(f, parts);
    if (f->settings.rotation_sigma > 0.0)
        advance_cross(f, &step, parts, up);
    make_symmetric(f);
    f->span = 0.0;
    memset(&f->turned, 0, sizeof f->turned);
    f->force = (imk_vector3){{0}};
}
