/* SPDX-License-Identifier: Apache-2.0 */
/* What drives the errors: small linear systems, and their exact integrals over a step.
 *
 * A column over a step is a polynomial in the time u that is left of it, so that all the errors
 * need of a driver s is
 *
 *     I_k = integral of u^k/k! s du = (k + 1)-fold integral of s over the step.
 *
 * These are states of a chain of integrators behind the driver: z' = A z + w, I_0' = s,
 * I_k' = I_(k-1). Transition and noise of driver and chain together are exact, whether the driver
 * is slow or fast compared with the step [VANLOAN1978]. */
#include "drift_covariance_internal.h"

#include "base/algebra/linear_system_internal.h"

#include <string.h>

imki_drift_driver imki_driver_white(void)
{
    return (imki_drift_driver){.states = 0};
}

imki_drift_driver imki_driver_constant(void)
{
    return (imki_drift_driver){.states = 1};
}

imki_drift_driver imki_driver_walk(void)
{
    return (imki_drift_driver){.states = 1, .w = {1.0, 0.0}};
}

imki_drift_driver imki_driver_ramp(void)
{
    return (imki_drift_driver){.states = 2, .a = {{0.0, 1.0}, {0.0, 0.0}}};
}

imki_drift_driver imki_driver_decay(double time)
{
    return (imki_drift_driver){.states = 1, .a = {{-1.0 / time, 0.0}, {0.0, 0.0}}};
}

imki_drift_driver imki_driver_gauss_markov(double time)
{
    imki_drift_driver driver = imki_driver_decay(time);
    driver.w[0] = 2.0 / time;
    driver.start[0] = 1.0;
    return driver;
}

imki_drift_driver imki_driver_oscillator(double rate)
{
    return (imki_drift_driver){.states = 2, .a = {{0.0, rate}, {-rate, 0.0}}};
}

/* x'' + (r/q) x' + r^2 x = white, of variance 1; the second state is x'/r. */
imki_drift_driver imki_driver_resonance(double rate, double q)
{
    return (imki_drift_driver){.states = 2,
                               .a = {{0.0, rate}, {-rate, -rate / q}},
                               .w = {0.0, 2.0 * rate / q},
                               .start = {1.0, 1.0}};
}

bool imki_driver_equal(const imki_drift_driver *a, const imki_drift_driver *b)
{
    bool equal = a->states == b->states;
    for (int i = 0; i < 2; i++) {
        equal = equal && a->w[i] == b->w[i] && a->start[i] == b->start[i];
        for (int j = 0; j < 2; j++)
            equal = equal && a->a[i][j] == b->a[i][j];
    }
    return equal;
}

/* White noise: covariance of I_k and I_l is h^(k+l+1)/((k+l+1) k! l!). */
static void white_over(double h, int moments, imki_driver_step *step)
{
    double power[2 * IMKI_DRIFT_MOMENTS], factorial[IMKI_DRIFT_MOMENTS];
    power[0] = h;
    for (int k = 1; k < 2 * moments; k++)
        power[k] = power[k - 1] * h;
    for (int k = 0; k < moments; k++)
        factorial[k] = k == 0 ? 1.0 : factorial[k - 1] * k;
    for (int k = 0; k < moments; k++)
        for (int l = 0; l < moments; l++)
            step->moment_noise[k][l] =
                power[k + l] / ((double)(k + l + 1) * factorial[k] * factorial[l]);
}

void imki_driver_over(const imki_drift_driver *driver, double h, int moments,
                      imki_driver_step *step)
{
    enum { MOST = 2 + IMKI_DRIFT_MOMENTS };
    double a[MOST * MOST] = {0.0}, phi[MOST * MOST], q[MOST * MOST] = {0.0}, w[MOST * MOST] = {0.0};
    memset(step, 0, sizeof *step);
    const int z = driver->states, n = z + moments;
    if (z == 0) {
        white_over(h, moments, step);
        return;
    }
    for (int i = 0; i < z; i++) {
        for (int j = 0; j < z; j++)
            a[i * n + j] = driver->a[i][j];
        w[i * n + i] = driver->w[i];
    }
    for (int k = 0; k < moments; k++)
        a[(z + k) * n + (k == 0 ? 0 : z + k - 1)] = 1.0;
    imki_exponential(n, a, h, phi);
    if (driver->w[0] > 0.0 || driver->w[1] > 0.0)
        imki_step_covariance(n, a, w, h, q);
    for (int i = 0; i < z; i++)
        for (int j = 0; j < z; j++) {
            step->phi[i][j] = phi[i * n + j];
            step->state_noise[i][j] = q[i * n + j];
        }
    for (int k = 0; k < moments; k++) {
        for (int i = 0; i < z; i++) {
            step->gain[k][i] = phi[(z + k) * n + i];
            step->cross_noise[k][i] = q[(z + k) * n + i];
        }
        for (int l = 0; l < moments; l++)
            step->moment_noise[k][l] = q[(z + k) * n + z + l];
    }
}
