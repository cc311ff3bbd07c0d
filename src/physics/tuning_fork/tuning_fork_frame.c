/* SPDX-License-Identifier: Apache-2.0 */
/* One carrier cycle of the two modes of a tuning fork gyro, exactly.
 *
 * A step of h is  z' = phi z + gamma u + e  with z = x, x', y, y', u the accelerations held over
 * it and e of the exact covariance. A held sinusoid has its first harmonic later by h/2 and
 * smaller by sin(a/2)/(a/2), a = wd h: taken at the middle of each step and divided by that it has
 * neither error.
 *
 * Behind each step both displacements are read. n readings at phases t_j = (j - (n + 1)/2) a,
 * symmetric about 0, give their phasor Z (z = Re Z e^{i t} + constant) by least squares,
 *
 *     Re Z = sum z_j (cos t_j - c)/C,   c = sin(n a/2)/(n sin(a/2)),   C = (n + r)/2 - n c^2
 *     Im Z = -sum z_j sin t_j/S,        S = (n - r)/2,                 r = sin(n a)/sin a
 *
 * exact for a sinusoid whether or not the frame is a whole cycle, as the products with the sine
 * sum to 0. The phasors are carried as four more states, so that their noise and that of the motion
 * have their exact joint covariance; the noise of the pickoffs, independent from reading to
 * reading, adds to the variance of the phasors. One draw of eight normals then serves a whole
 * frame. */
#include "tuning_fork_internal.h"

#include "base/algebra/linear_system_internal.h"
#include "imukit/elementary.h"

#include <string.h>

enum { N = IMKI_FORK_STATES, ROWS = IMKI_FORK_ROWS };

/* What the readings of one frame are weighted with. */
typedef struct weights {
    int steps;
    double cosine[IMKI_FORK_STEPS_MAX], sine[IMKI_FORK_STEPS_MAX]; /* (cos t_j - c)/C, -sin t_j/S */
    double force_cosine[IMKI_FORK_STEPS_MAX], force_sine[IMKI_FORK_STEPS_MAX];
    double variance[2]; /* of Re Z and Im Z for readings of unit variance */
} weights;

static void weights_design(int steps, double angle, double hold, weights *w)
{
    w->steps = steps;
    const double n = (double)steps, centre = 0.5 * (n + 1.0);
    const double ripple = imk_sin(n * angle) / imk_sin(angle);
    const double mean = imk_sin(0.5 * n * angle) / (n * imk_sin(0.5 * angle));
    w->variance[0] = 1.0 / (0.5 * (n + ripple) - n * mean * mean);
    w->variance[1] = 2.0 / (n - ripple);
    for (int j = 0; j < steps; j++) {
        const double reading = ((double)j + 1.0 - centre) * angle, middle = reading - 0.5 * angle;
        w->cosine[j] = (imk_cos(reading) - mean) * w->variance[0];
        w->sine[j] = -imk_sin(reading) * w->variance[1];
        w->force_cosine[j] = hold * imk_cos(middle);
        w->force_sine[j] = hold * imk_sin(middle);
    }
}

/* The equations of motion of tuning_fork.h; the force of the molecules has the density matrix
 * (2 kB T/m) C, C that of the damping, couplings included [CALLEN1951]. */
static void equations(const imk_tuning_fork *design, const imki_fork_point *point,
                      const imki_fork_condition *condition, double a[N * N], double b[N * 2],
                      double density[N * N])
{
    const double k = design->angular_gain;
    const double coriolis = 2.0 * k * condition->rate, euler = k * condition->acceleration;
    const double damping = 2.0 * k * design->damping_coupling;
    const double stiffness = 4.0 * IMKI_PI * k * design->drive.frequency * design->quadrature;
    const double heat = 2.0 * IMKI_BOLTZMANN * condition->temperature / design->mass;
    const double matrix[N * N] = {0.0,
                                  1.0,
                                  0.0,
                                  0.0,
                                  -point->drive * point->drive,
                                  -point->drive_damping,
                                  -stiffness + euler,
                                  coriolis - damping,
                                  0.0,
                                  0.0,
                                  0.0,
                                  1.0,
                                  -stiffness - euler,
                                  -coriolis - damping,
                                  -point->sense * point->sense,
                                  -point->sense_damping};
    const double input[N * 2] = {0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0};
    memcpy(a, matrix, sizeof matrix);
    memcpy(b, input, sizeof input);
    memset(density, 0, N * N * sizeof *density);
    density[1 * N + 1] = heat * point->drive_damping;
    density[3 * N + 3] = heat * point->sense_damping;
    density[1 * N + 3] = density[3 * N + 1] = heat * damping;
}

static void advance(const imki_fork_frame *frame, double ux, double uy, double z[N])
{
    double next[N];
    for (int i = 0; i < N; i++) {
        double sum = frame->gamma[2 * i] * ux + frame->gamma[2 * i + 1] * uy;
        for (int k = 0; k < N; k++)
            sum += frame->phi[N * i + k] * z[k];
        next[i] = sum;
    }
    memcpy(z, next, sizeof next);
}

/* Accelerations in step j of a frame: phasors of both forces, and the constant. */
static void accelerations(const weights *w, const double force[5], int j, double u[2])
{
    u[0] = force[0] * w->force_cosine[j] - force[1] * w->force_sine[j];
    u[1] = force[2] * w->force_cosine[j] - force[3] * w->force_sine[j] + force[4];
}

/* The columns of one input each: the frame run with a one there. */
static void response(imki_fork_frame *frame, const weights *w)
{
    for (int c = 0; c < IMKI_FORK_INPUTS; c++) {
        double z[N] = {0.0}, force[5] = {0.0}, *column = frame->column[c], u[2];
        double phasor[4] = {0.0};
        *(c < N ? &z[c] : &force[c - N]) = 1.0;
        for (int j = 0; j < w->steps; j++) {
            accelerations(w, force, j, u);
            advance(frame, u[0], u[1], z);
            phasor[0] += w->cosine[j] * z[0];
            phasor[1] += w->sine[j] * z[0];
            phasor[2] += w->cosine[j] * z[2];
            phasor[3] += w->sine[j] * z[2];
        }
        memcpy(column, z, sizeof z);
        memcpy(column + N, phasor, sizeof phasor);
    }
}

static void product(const double a[N * N], const double b[N * N], double c[N * N])
{
    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++) {
            double sum = 0.0;
            for (int k = 0; k < N; k++)
                sum += a[N * i + k] * b[N * k + j];
            c[N * i + j] = sum;
        }
}

/* One step of the motion's covariance p and its covariance x with the phasors. */
static void covariance_step(const double phi[N * N], const double q[N * N], double p[N * N],
                            double x[N * N])
{
    double half[N * N], turned[N * N], transposed[N * N];
    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++)
            transposed[N * j + i] = phi[N * i + j];
    product(phi, p, half);
    product(half, transposed, p);
    product(phi, x, turned);
    for (int i = 0; i < N * N; i++)
        p[i] += q[i];
    memcpy(x, turned, sizeof turned);
}

/* Covariance of the eight rows at the end of a frame: the phasor's gain in step j is d_j of the
 * displacements, so with z the motion behind the step and s the phasors before it
 *     cov(z, s) += P d^T,   cov(s, s) += d cov(z, s) + (d cov(z, s))^T + d P d^T. */
static void frame_covariance(const imki_fork_frame *frame, const weights *w, const double q[N * N],
                             double whole[ROWS * ROWS])
{
    double p[N * N] = {0.0}, x[N * N] = {0.0}, s[N * N] = {0.0};
    for (int j = 0; j < w->steps; j++) {
        const double d[N] = {w->cosine[j], w->sine[j], w->cosine[j], w->sine[j]};
        covariance_step(frame->phi, q, p, x);
        for (int a = 0; a < N; a++)
            for (int b = 0; b < N; b++) {
                const int za = a / 2 * 2, zb = b / 2 * 2; /* the displacement a phasor is of */
                s[N * a + b] +=
                    d[a] * x[N * za + b] + d[b] * x[N * zb + a] + d[a] * d[b] * p[N * za + zb];
            }
        for (int i = 0; i < N; i++)
            for (int b = 0; b < N; b++)
                x[N * i + b] += p[N * i + b / 2 * 2] * d[b];
    }
    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++) {
            whole[ROWS * i + j] = p[N * i + j];
            whole[ROWS * i + N + j] = whole[ROWS * (N + j) + i] = x[N * i + j];
            whole[ROWS * (N + i) + N + j] = s[N * i + j];
        }
}

static void frame_noise(const imk_tuning_fork *design, const weights *w, const double q[N * N],
                        double step, imki_fork_frame *frame)
{
    double covariance[ROWS * ROWS], root[ROWS * ROWS];
    const double density[2] = {design->drive.pickoff_noise, design->sense.pickoff_noise};
    frame_covariance(frame, w, q, covariance);
    for (int i = 0; i < N; i++) {
        const double sigma = density[i / 2];
        covariance[(ROWS + 1) * (N + i)] += sigma * sigma / (2.0 * step) * w->variance[i % 2];
    }
    imki_covariance_root(ROWS, covariance, root);
    for (int c = 0; c < ROWS; c++)
        for (int r = 0; r < ROWS; r++)
            frame->column[IMKI_FORK_INPUTS + c][r] = root[ROWS * r + c];
}

void imki_fork_frame_design(const imk_tuning_fork *design, const imki_fork_condition *condition,
                            double step, int steps, bool noise, imki_fork_frame *frame)
{
    const imki_fork_point point = imki_fork_at(design, condition->temperature);
    double a[N * N], b[N * 2], density[N * N], q[N * N];
    weights w;
    equations(design, &point, condition, a, b, density);
    imki_discretise(N, 2, a, b, step, frame->phi, frame->gamma);
    frame->steps = steps;
    frame->angle = point.drive * step;
    frame->hold = 0.5 * frame->angle / imk_sin(0.5 * frame->angle);
    weights_design(steps, frame->angle, frame->hold, &w);
    response(frame, &w);
    memset(frame->column[IMKI_FORK_INPUTS], 0, sizeof(double[ROWS][ROWS]));
    if (!noise)
        return;
    imki_step_covariance(N, a, density, step, q);
    frame_noise(design, &w, q, step, frame);
}

void imki_fork_frame_inside(const imki_fork_frame *frame, const double state[4],
                            const double force[5], int count, double inside[4])
{
    const double centre = 0.5 * ((double)frame->steps + 1.0);
    memcpy(inside, state, sizeof(double[4]));
    for (int j = 0; j < count; j++) {
        const double middle = ((double)j + 0.5 - centre) * frame->angle;
        const double c = frame->hold * imk_cos(middle), s = frame->hold * imk_sin(middle);
        advance(frame, force[0] * c - force[1] * s, force[2] * c - force[3] * s + force[4], inside);
    }
}
