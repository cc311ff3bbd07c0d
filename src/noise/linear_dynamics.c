/* SPDX-License-Identifier: Apache-2.0 */
/* What a linear system of first or second order, driven by white noise, does over a stretch of
 * time: transition, and covariance of what the noise adds.
 *
 * The covariance is built by doubling: over h0 so short that power series converge at once, then
 *
 *     psi(2 h) = psi(h)^2,   Q(2 h) = Q(h) + psi(h) Q(h) psi(h)^T
 *
 * [VANLOAN1978 has the integrals; doubling adds only positive variances, so that nothing cancels
 * however small w dt or the damping is]. The transition itself is taken from its closed form at
 * each length, so its errors do not grow. */
#include "arma_internal.h"

#include "base/algebra/vector_internal.h"

imki_dynamics imki_first_order(double omega, double drive)
{
    return (imki_dynamics){
        .order = 1, .omega = omega, .rate = {omega, (double)INFINITY}, .drive = drive};
}

imki_dynamics imki_second_order(double omega, double damping, double drive)
{
    imki_dynamics dynamics = {.order = 2, .omega = omega, .drive = drive};
    /* w^2 (damping^2 - 1), factored so that it is accurate near critical damping */
    double discriminant = omega * omega * (damping - 1.0) * (damping + 1.0);
    if (discriminant < 0.0) {
        dynamics.angular = sqrt(-discriminant);
        dynamics.rate[0] = dynamics.rate[1] = damping * omega;
    } else {
        dynamics.rate[1] = damping * omega + sqrt(discriminant);
        dynamics.rate[0] = omega * omega / dynamics.rate[1];
    }
    return dynamics;
}

double imki_angle_of(double angular, double dt)
{
    double cycles = angular * dt / (2.0 * IMKI_PI);
    return 2.0 * IMKI_PI * fabs(cycles - floor(cycles + 0.5));
}

/* E(h), the response of x to a unit step of v, and phi:
 *     oscillation e^-ah (cos bh, sin bh), else e1, e2 the decays of the two modes,
 *     E = (e1 - e2)/(rate2 - rate1) = e1 (1 - e^-dh)/d, d = rate2 - rate1, e1 h where d = 0. */
void imki_transition(const imki_dynamics *dynamics, double h, double phi[2][2])
{
    double slow = imk_exp(-dynamics->rate[0] * h);
    if (dynamics->order == 1) {
        phi[0][0] = slow;
        phi[0][1] = phi[1][0] = phi[1][1] = 0.0;
        return;
    }
    double response;
    if (dynamics->angular > 0.0) {
        double turn = dynamics->angular * h;
        if (!(turn < 1e9)) /* a sine must be reduced first, and has its digits in the cycles */
            turn -= 2.0 * IMKI_PI * floor(turn / (2.0 * IMKI_PI));
        response = slow * imk_sin(turn) / dynamics->angular;
        double cosine = slow * imk_cos(turn);
        phi[0][0] = cosine + dynamics->rate[0] * response;
        phi[1][1] = cosine - dynamics->rate[0] * response;
    } else {
        double spread = dynamics->rate[1] - dynamics->rate[0];
        double fast = imk_exp(-dynamics->rate[1] * h);
        response = spread > 0.0 ? slow * -imk_expm1(-spread * h) / spread : slow * h;
        phi[0][0] = slow + dynamics->rate[0] * response;
        phi[1][1] = fast - dynamics->rate[0] * response;
    }
    phi[0][1] = response;
    phi[1][0] = -dynamics->omega * dynamics->omega * response;
}

/* Terms of the series below, for which rate * h0 <= 1/4: the first left out is < 4^-16/16! of the
 * whole. */
enum { TERMS = 16 };

/* Integral over 0 … 1 of the product of two polynomials. */
static double integral_of_product(const double *a, const double *b)
{
    double sum = 0.0;
    for (int i = 0; i < TERMS; i++)
        for (int j = 0; j < TERMS; j++)
            sum += a[i] * b[j] / (i + j + 1);
    return sum;
}

/* A stretch so short that the impulse response x(t) is a short polynomial in t/h. */
static imki_stretch short_stretch(const imki_dynamics *dynamics, double h)
{
    double response[3][TERMS + 1] = {
        {0.0}}; /* of x, v h and integral/h to an impulse of size 1/h^(order-1) */
    double *x = response[0], *v = response[1], *integral = response[2];
    double wh = dynamics->omega * h;
    if (dynamics->order == 1) {
        x[0] = 1.0;
        for (int k = 0; k < TERMS; k++)
            x[k + 1] = -wh * x[k] / (k + 1);
    } else {
        double friction = dynamics->angular > 0.0 ? 2.0 * dynamics->rate[0] * h
                                                  : (dynamics->rate[0] + dynamics->rate[1]) * h;
        x[1] = 1.0;
        for (int k = 0; k + 2 <= TERMS; k++)
            x[k + 2] = -(friction * (k + 1) * x[k + 1] + wh * wh * x[k]) / ((k + 2) * (k + 1));
        for (int k = 0; k < TERMS; k++)
            v[k] = (k + 1) * x[k + 1];
    }
    double whole = 0.0, end = 0.0; /* x over the stretch, and at its end */
    for (int k = 0; k < TERMS; k++) {
        integral[k + 1] = x[k] / (k + 1);
        whole += x[k] / (k + 1);
        end += x[k];
    }
    imki_stretch stretch;
    imki_transition(dynamics, h, stretch.phi);
    double unit[3] = {1.0, 1.0, h}; /* of the three responses, times drive */
    if (dynamics->order == 1) {
        stretch.g[0] = h * whole;
        stretch.g[1] = 0.0;
    } else {
        double friction = dynamics->angular > 0.0 ? 2.0 * dynamics->rate[0]
                                                  : dynamics->rate[0] + dynamics->rate[1];
        stretch.g[1] = h * h * whole;
        stretch.g[0] = h * end + friction * stretch.g[1];
        unit[0] = h;
        unit[2] = h * h;
    }
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            stretch.q[i][j] = dynamics->drive * dynamics->drive * h * unit[i] * unit[j] *
                              integral_of_product(response[i], response[j]);
    return stretch;
}

double imki_covariance(const imki_stretch *stretch, const double a[3], const double b[3])
{
    double sum = 0.0;
    for (int i = 0; i < 3; i++)
        sum += a[i] * imki_dot3(stretch->q[i], b);
    return sum;
}

/* One stretch after another, `length` together. */
static imki_stretch join(const imki_dynamics *dynamics, const imki_stretch *first,
                         const imki_stretch *second, double length)
{
    double psi[3][3] = {{second->phi[0][0], second->phi[0][1], 0.0},
                        {second->phi[1][0], second->phi[1][1], 0.0},
                        {second->g[0], second->g[1], 1.0}};
    imki_stretch whole;
    imki_transition(dynamics, length, whole.phi);
    for (int j = 0; j < 2; j++)
        whole.g[j] =
            first->g[j] + (second->g[0] * first->phi[0][j] + second->g[1] * first->phi[1][j]);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j <= i; j++)
            whole.q[i][j] = whole.q[j][i] =
                second->q[i][j] + imki_covariance(first, psi[i], psi[j]);
    return whole;
}

imki_stretch imki_stretch_of_time(const imki_dynamics *dynamics, double h)
{
    double fastest =
        dynamics->order == 1 ? dynamics->omega : fmax(dynamics->omega, dynamics->rate[1]);
    int doublings = 0;
    double start = h;
    while (fastest * start > 0.25) {
        start *= 0.5; /* exact */
        doublings++;
    }
    imki_stretch stretch = short_stretch(dynamics, start);
    for (int i = 0; i < doublings; i++) {
        start *= 2.0;
        stretch = join(dynamics, &stretch, &stretch, start);
    }
    return stretch;
}

imki_stretch imki_stretch_of_samples(const imki_dynamics *dynamics, double dt, size_t n)
{
    imki_stretch power = imki_stretch_of_time(dynamics, dt); /* of 2^i samples */
    power.g[0] = 1.0;                                        /* the sample at the start */
    power.g[1] = 0.0;
    for (int i = 0; i < 3; i++)
        power.q[i][2] = power.q[2][i] = 0.0;
    imki_stretch whole = power;
    size_t done = 0, length = 1;
    for (size_t rest = n; rest > 0; rest >>= 1) {
        if (rest & 1) {
            whole =
                done == 0 ? power : join(dynamics, &whole, &power, (double)(done + length) * dt);
            done += length;
        }
        length *= 2;
        if (rest > 1)
            power = join(dynamics, &power, &power, (double)length * dt);
    }
    return whole;
}

/* Order 1: drive^2/(2 w). Order 2: with 2 damping w = rate1 + rate2 =: r, var v = drive^2/(2 r),
 * var x = var v/w^2. */
void imki_stationary(const imki_dynamics *dynamics, double variance[2])
{
    double square = dynamics->drive * dynamics->drive;
    if (dynamics->order == 1) {
        variance[0] = square / (2.0 * dynamics->omega);
        variance[1] = 0.0;
        return;
    }
    variance[1] = square / (2.0 * (dynamics->rate[0] + dynamics->rate[1]));
    variance[0] = variance[1] / (dynamics->omega * dynamics->omega);
}

/* total2 - total1 = g (phi - 1) (x, v) + (g noise1 - total noise1) + total noise2 */
double imki_half_difference(const imki_dynamics *dynamics, const imki_stretch *stretch)
{
    double variance[2];
    imki_stationary(dynamics, variance);
    const double *g = stretch->g;
    double change[2] = {g[0] * (stretch->phi[0][0] - 1.0) + g[1] * stretch->phi[1][0],
                        g[0] * stretch->phi[0][1] + g[1] * (stretch->phi[1][1] - 1.0)};
    double form[3] = {g[0], g[1], -1.0};
    double sum = imki_covariance(stretch, form, form) + stretch->q[2][2];
    for (int i = 0; i < 2; i++)
        sum += change[i] * change[i] * variance[i];
    return 0.5 * sum;
}
