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
#include "navigation_smoother_internal.h"

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

/* The step, and the white noise. */
typedef struct step_matrices {
    imki_filter_step by;
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

/* What a bias, or a unit of noise, on one axis does to the derivative of the errors. */
static void bias_column(const imk_matrix3 *c, int sensor, int axis, double b[ERRORS])
{
    memset(b, 0, ERRORS * sizeof *b);
    for (int k = 0; k < 3; k++)
        b[(sensor == IMKI_GYRO_PART ? 6 : 3) + k] = c->m[k][axis];
}

/* phi and gamma of a step; m is the matrix of the errors, m2 its square. */
static void make_shift(double h, const imk_matrix3 *c, square m, square m2, imki_filter_step *by)
{
    square m3, integral;
    multiply(m2, m, m3);
    for (int i = 0; i < ERRORS; i++)
        for (int j = 0; j < ERRORS; j++) {
            const double one = i == j ? 1.0 : 0.0;
            by->phi[i][j] = one + h * (m[i][j] + 0.5 * h * (m2[i][j] + h / 3.0 * m3[i][j]));
            integral[i][j] = h * (one + 0.5 * h * (m[i][j] + h / 3.0 * m2[i][j]));
        }
    for (int sensor = 0; sensor < 2; sensor++)
        for (int axis = 0; axis < 3; axis++) {
            double b[ERRORS];
            bias_column(c, sensor, axis, b);
            for (int i = 0; i < ERRORS; i++) {
                by->gamma[sensor][i][axis] = 0.0;
                for (int k = 0; k < ERRORS; k++)
                    by->gamma[sensor][i][axis] += integral[i][k] * b[k];
            }
        }
}

void imki_navigation_filter_shift(const imk_navigation_filter *f, double h, imki_filter_step *step)
{
    square m, m2;
    error_matrix(f, f->last.force, m);
    multiply(m, m, m2);
    make_shift(h, &f->attitude, m, m2, step);
}

static void make_step(const imk_navigation_filter *f, double h, const imk_matrix3 *c,
                      imk_vector3 force, step_matrices *step)
{
    const imk_triad_errors *triad[2] = {&f->settings.gyro, &f->settings.accel};
    square m, m2;
    error_matrix(f, force, m);
    multiply(m, m, m2);
    make_shift(h, c, m, m2, &step->by);
    memset(step->noise, 0, sizeof step->noise);
    for (int sensor = 0; sensor < 2; sensor++)
        for (int axis = 0; axis < 3; axis++) {
            const double n = triad[sensor]->white[axis], power = n * n * h;
            double b[ERRORS];
            bias_column(c, sensor, axis, b);
            add_noise(m, m2, b, 0.0, power / 6.0, step->noise);
            add_noise(m, m2, b, 0.5 * h, power * 2.0 / 3.0, step->noise);
            add_noise(m, m2, b, h, power / 6.0, step->noise);
        }
}

double imki_bias_part_decay(const imk_bias_part *part, double h)
{
    const double t = part->correlation_time;
    return t > 0.0 ? 1.0 + imk_expm1(-h / t) : 1.0;
}

/* Of each state behind the nine over a step: what remains of it, and what noise is added. */
typedef struct rest_step {
    double decay[IMKI_FILTER_STATES_MAX], noise[IMKI_FILTER_STATES_MAX];
} rest_step;

static double lost_variance(double correlation_time, double h)
{
    const double lost = -imk_expm1(-h / correlation_time);
    return lost * (2.0 - lost);
}

static void make_rest(const imk_navigation_filter *f, double h, rest_step *rest)
{
    const imk_triad_errors *triad[2] = {&f->settings.gyro, &f->settings.accel};
    size_t k = 0;
    for (int sensor = 0; sensor < 2; sensor++)
        for (size_t p = 0; p < f->parts[sensor]; p++) {
            const imk_bias_part *part = &triad[sensor]->part[p];
            const double t = part->correlation_time, decay = imki_bias_part_decay(part, h);
            const double lost = t > 0.0 ? lost_variance(t, h) : 0.0;
            for (int i = 0; i < 3; i++, k++) {
                rest->decay[k] = decay;
                rest->noise[k] = t > 0.0 ? part->sigma[i] * part->sigma[i] * lost
                                         : part->walk[i] * part->walk[i] * h;
            }
        }
    for (size_t a = 0; a < f->aid_states; a++, k++) {
        const imki_aid_state *state = &f->aid_state[a];
        const double t = state->correlation_time;
        rest->decay[k] = t > 0.0 ? 1.0 + imk_expm1(-h / t) : 1.0;
        rest->noise[k] = t > 0.0 ? state->sigma * state->sigma * lost_variance(t, h) : 0.0;
    }
}

/* The state of part p of a sensor's bias on an axis. */
static size_t part_state(const imk_navigation_filter *f, int sensor, size_t p, size_t axis)
{
    return ERRORS + 3 * ((sensor == IMKI_GYRO_PART ? 0 : f->parts[IMKI_GYRO_PART]) + p) + axis;
}

/* One vector of all errors by the step: `stride` apart, in place. */
static void advance(const imk_navigation_filter *f, const imki_filter_step *step,
                    const double *decay, double *x, size_t stride)
{
    double now[ERRORS], bias[2][3] = {{0}};
    for (size_t i = 0; i < ERRORS; i++)
        now[i] = x[i * stride];
    for (int sensor = 0; sensor < 2; sensor++)
        for (size_t p = 0; p < f->parts[sensor]; p++)
            for (size_t axis = 0; axis < 3; axis++)
                bias[sensor][axis] += x[part_state(f, sensor, p, axis) * stride];
    for (size_t i = ERRORS; i < f->states; i++)
        x[i * stride] *= decay[i - ERRORS];
    for (size_t i = 0; i < ERRORS; i++) {
        double sum = 0.0;
        for (int k = 0; k < ERRORS; k++)
            sum += step->phi[i][k] * now[k];
        for (int sensor = 0; sensor < 2; sensor++)
            for (int axis = 0; axis < 3; axis++)
                sum += step->gamma[sensor][i][axis] * bias[sensor][axis];
        x[i * stride] = sum;
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

/* Rows 0-8 of A P, A the matrix of the step without the decays, by the structure of A: A P is phi
 * P + gamma times the sums of the rows of the parts. @param row  9 x n */
static void advance_rows(const imk_navigation_filter *f, const imki_filter_step *step, double *row)
{
    const size_t n = f->states;
    const double *p = f->covariance;
    double sum[6][IMKI_FILTER_STATES_MAX];
    memset(sum, 0, sizeof sum);
    for (int sensor = 0; sensor < 2; sensor++)
        for (size_t part = 0; part < f->parts[sensor]; part++)
            for (size_t axis = 0; axis < 3; axis++) {
                const double *from = p + part_state(f, sensor, part, axis) * n;
                double *to = sum[3 * sensor + (int)axis];
                for (size_t j = 0; j < n; j++)
                    to[j] += from[j];
            }
    memset(row, 0, ERRORS * n * sizeof *row);
    for (size_t i = 0; i < ERRORS; i++) {
        double *to = row + i * n;
        for (size_t k = 0; k < ERRORS; k++) {
            const double factor = step->phi[i][k], *from = p + k * n;
            for (size_t j = 0; j < n; j++)
                to[j] += factor * from[j];
        }
        for (size_t k = 0; k < 6; k++) {
            const double factor = step->gamma[k / 3][i][k % 3], *from = sum[k];
            for (size_t j = 0; j < n; j++)
                to[j] += factor * from[j];
        }
    }
}

/* P <- A P A^T + noise, its two halves the same to the last bit. */
static void advance_covariance(imk_navigation_filter *f, const step_matrices *step,
                               const rest_step *rest)
{
    const size_t n = f->states;
    double *p = f->covariance, *row = f->scratch;
    advance_rows(f, &step->by, row);
    for (size_t i = 0; i < ERRORS; i++) {
        double bias[6] = {0};
        const double *of = row + i * n;
        for (int sensor = 0; sensor < 2; sensor++)
            for (size_t part = 0; part < f->parts[sensor]; part++)
                for (size_t axis = 0; axis < 3; axis++)
                    bias[3 * sensor + (int)axis] += of[part_state(f, sensor, part, axis)];
        for (size_t j = 0; j <= i; j++) {
            double sum = step->noise[i][j];
            for (size_t k = 0; k < ERRORS; k++)
                sum += of[k] * step->by.phi[j][k];
            for (size_t k = 0; k < 6; k++)
                sum += bias[k] * step->by.gamma[k / 3][j][k % 3];
            p[i * n + j] = p[j * n + i] = sum;
        }
    }
    for (size_t i = 0; i < ERRORS; i++)
        for (size_t j = ERRORS; j < n; j++)
            p[i * n + j] = p[j * n + i] = row[i * n + j] * rest->decay[j - ERRORS];
    for (size_t i = ERRORS; i < n; i++) {
        const double factor = rest->decay[i - ERRORS];
        for (size_t j = ERRORS; j < n; j++)
            p[i * n + j] *= factor * rest->decay[j - ERRORS];
        p[i * n + i] += rest->noise[i - ERRORS];
    }
}

static void hold_covariance(imk_navigation_filter *f, imk_vector3 up)
{
    const size_t n = f->states;
    double *p = f->covariance;
    for (size_t column = 0; column < n; column++)
        hold_vertical(up, p + column, n);
    for (size_t row = 0; row < n; row++)
        hold_vertical(up, p + row * n, 1);
    for (size_t i = 0; i < 6; i++)
        for (size_t j = 0; j < i; j++)
            p[i * n + j] = p[j * n + i] = 0.5 * (p[i * n + j] + p[j * n + i]);
    for (size_t i = 0; i < 6; i++)
        for (size_t j = 6; j < n; j++)
            p[j * n + i] = p[i * n + j];
}

/* The estimates of biases and of errors of aids decay as these do. */
static void advance_estimates(imk_navigation_filter *f, const rest_step *rest)
{
    const double *decay = rest->decay;
    for (int sensor = 0; sensor < 2; sensor++) {
        f->bias_sum[sensor] = (imk_vector3){{0}};
        for (size_t p = 0; p < f->parts[sensor]; p++)
            for (int axis = 0; axis < 3; axis++) {
                f->bias[sensor][p][axis] *= *decay++;
                f->bias_sum[sensor].v[axis] += f->bias[sensor][p][axis];
            }
    }
    for (size_t k = 0; k < f->aid_states; k++)
        f->aid_state[k].estimate *= *decay++;
}

static void advance_cross(imk_navigation_filter *f, const imki_filter_step *step,
                          const rest_step *rest, imk_vector3 up)
{
    for (size_t axis = 0; axis < 3; axis++) {
        const double n = f->settings.gyro.white[axis];
        advance(f, step, rest->decay, f->cross + axis, 3);
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
    rest_step rest;
    imk_matrix3 c = f->turned;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            c.m[i][j] /= h;
    make_step(f, h, &c, imk_vector3_scale(f->force, 1.0 / h), &step);
    make_rest(f, h, &rest);
    const imk_vector3 up = upward(imk_gravity_ecef(f->strapdown.state.position));
    advance_covariance(f, &step, &rest);
    if (f->settings.hold_height)
        hold_covariance(f, up);
    advance_estimates(f, &rest);
    if (f->smoother)
        imki_smoother_step(f->smoother, &step.by, rest.decay, f->settings.hold_height ? &up : NULL);
    if (f->settings.rotation_sigma > 0.0)
        advance_cross(f, &step.by, &rest, up);
    f->span = 0.0;
    memset(&f->turned, 0, sizeof f->turned);
    f->force = (imk_vector3){{0}};
}
