/* SPDX-License-Identifier: Apache-2.0 */
/* What the errors of a model amount to in the mean over an alignment of length T, along each axis:
 *
 *     repeatability, 1 sigma of fixed values     s^2
 *     Gauss-Markov  2 s^2 t/T [1 - t/T (1 - exp(-T/t))]
 *     flicker       the same of stages of variance (ln 4/pi) B^2 and times 0.85 T 4^-k (noise.h):
 *                   those longer than T act as a bias, so that the sum is about (1.75 B)^2
 *     random walk   K^2 T/3
 *     sinusoid      (a^2/2) [sin(pi f T)/(pi f T)]^2
 *
 * and how much their change over T looks like a turn, in what a parabola fitted to velocity says
 * (force weighed by u (1-u)(1-2u), u = 0 … 1): as a random walk of
 *
 *     K^2 = 6 s^2/T (4 M0 - 84 M2 + 140 M3 - 84 M5 + 24 M7),   Mk = integral of u^k exp(-u T/t)
 *
 * (flicker: 2.785 B^2/T). A resonance counts as white noise of
 * its spectrum at 0, 2 s^2/(q w).
 *
 * Scale factor, misalignment and a gyro's sensitivity to force act through what is measured. Values
 * that are known are not errors here: they are taken out before, by imk_correct(). */
#include "alignment_internal.h"

#include "base/algebra/vector_internal.h"
#include "imukit/elementary.h"
#include "noise/noise_terms_internal.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

static double square(double x)
{
    return x * x;
}

/* Variance of the mean over `duration` of a first-order process of unit variance. */
static double mean_variance(double correlation_time, double duration)
{
    if (!(correlation_time > 0.0))
        return 0.0;
    const double x = duration / correlation_time;
    if (x < 1e-3) /* 1 - x/3 + x^2/12: the difference below loses its digits */
        return 1.0 - x * (1.0 / 3 - x * (1.0 / 12));
    return 2.0 / x * (1.0 + imk_expm1(-x) / x);
}

/* K^2 of the random walk that changes as much, times the duration. */
static double change_variance(double correlation_time, double duration)
{
    if (!(correlation_time > 0.0))
        return 0.0;
    const double x = duration / correlation_time;
    if (x < 3.0) { /* terms of x^j; the next is below 1e-17 */
        double sum = 0.0, power = 6.0;
        for (int j = 1; j < 30; j++) {
            power *= -x / j;
            sum += power * (4.0 / (j + 1) - 84.0 / (j + 3) + 140.0 / (j + 4) - 84.0 / (j + 6) +
                            24.0 / (j + 8));
        }
        return sum;
    }
    double moment[8];
    const double e = imk_exp(-x);
    moment[0] = (1.0 - e) / x;
    for (int k = 1; k < 8; k++)
        moment[k] = (k * moment[k - 1] - e) / x;
    return 6.0 * (4.0 * moment[0] - 84.0 * moment[2] + 140.0 * moment[3] - 84.0 * moment[5] +
                  24.0 * moment[7]);
}

/* Errors of one axis. */
typedef struct axis_errors {
    double white, mean, walk, change, quantum;
} axis_errors;

static void add_first_order(axis_errors *errors, double variance, double correlation_time,
                            double duration)
{
    errors->mean += variance * mean_variance(correlation_time, duration);
    errors->change += variance * change_variance(correlation_time, duration) / duration;
}

static void add_process(axis_errors *errors, const imki_process *p, double duration)
{
    const double variance = p->share * square(p->size);
    const double x = pi * p->frequency * duration, w = 2.0 * pi * p->frequency;
    switch (p->kind) {
    case IMKI_PROCESS_WHITE:
        errors->white += variance;
        break;
    case IMKI_PROCESS_WALK:
        errors->walk += variance;
        break;
    case IMKI_PROCESS_FIRST_ORDER:
        add_first_order(errors, variance, p->time, duration);
        break;
    case IMKI_PROCESS_SINE:
        if (x > 0.0)
            errors->mean += 0.5 * square(p->size * imk_sin(x) / x);
        break;
    case IMKI_PROCESS_RESONANCE:
        if (w > 0.0 && p->q > 0.0)
            errors->white += 2.0 * variance / (p->q * w);
        break;
    case IMKI_PROCESS_READING:
        errors->quantum += variance;
        break;
    }
}

static void add_terms(axis_errors *errors, const imk_triad *triad, int axis, double duration,
                      double dt)
{
    imki_process process[IMKI_PROCESSES_MAX];
    imki_term_place place = {triad, axis, 0};
    for (int t = 0; t < IMKI_NOISE_TERMS; t++) {
        const imki_noise_term *term = imki_noise_terms[t];
        const int instances = imki_term_count(term, &triad->noise);
        for (place.instance = 0; place.instance < instances; place.instance++) {
            const size_t count =
                term->strength(place) != 0.0 ? term->processes(place, dt, process) : 0;
            for (size_t i = 0; i < count; i++)
                add_process(errors, &process[i], duration);
        }
    }
}

static double reading_variance(const imk_triad *triad, int axis, imk_vector3 input,
                               const imk_vector3 *force)
{
    const double *e = triad->direction[axis];
    const double along = imki_dot3(e, input.v);
    double sum = square(along) * (square(triad->scale_factor.fixed.sigma[axis]) +
                                  square(triad->scale_factor.repeatability.value[axis]));
    for (int j = 0; j < 3; j++) {
        sum += square(input.v[j]) * (square(triad->misalignment.sigma[axis][j]) +
                                     square(triad->cross_axis.sigma[axis][j]));
        if (force != NULL)
            sum += square(force->v[j] * triad->g_sensitivity.sigma[axis][j]);
    }
    return sum;
}

static axis_errors errors_of_axis(const imk_triad *triad, int axis, double duration, double dt)
{
    /* Rounding of each sample, when noise is larger than the step. */
    axis_errors errors = {.white = square(triad->resolution.value[axis]) / 12.0 * dt,
                          .mean = square(triad->bias.fixed.sigma[axis]) +
                                  square(triad->bias.repeatability.value[axis]),
                          .quantum = square(triad->noise.quantization.value[axis])};
    add_terms(&errors, triad, axis, duration, dt);
    return errors;
}

/* Covariance of the body-axes vector that least squares finds from axes of these variances,
 * (sum e e^T/v)^-1; axes without any error get a little, so that it exists. */
static imk_matrix3 body_covariance(const imk_triad *triad, const double *variance)
{
    imk_matrix3 information = {{{0}}}, covariance = {{{0}}};
    double largest = 0.0;
    for (int i = 0; i < triad->axis_count; i++)
        largest = fmax(largest, variance[i]);
    if (!(largest > 0.0))
        return covariance;
    for (int i = 0; i < triad->axis_count; i++) {
        const double *e = triad->direction[i], weight = largest / fmax(variance[i], 1e-9 * largest);
        for (int r = 0; r < 3; r++)
            for (int c = 0; c < 3; c++)
                information.m[r][c] += weight * e[r] * e[c];
    }
    if (imk_matrix3_inverse(information, &covariance) != IMK_OK)
        return (imk_matrix3){{{0}}}; /* fewer than three directions: nothing can be said */
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
            covariance.m[r][c] *= largest;
    return covariance;
}

imki_alignment_errors imki_alignment_errors_of(const imk_triad *triad, double duration, double dt,
                                               imk_vector3 input, const imk_vector3 *force)
{
    double white[IMK_AXES_MAX], mean[IMK_AXES_MAX], walk[IMK_AXES_MAX], change[IMK_AXES_MAX];
    double reading[IMK_AXES_MAX], quantum[IMK_AXES_MAX];
    for (int axis = 0; axis < triad->axis_count; axis++) {
        const axis_errors errors = errors_of_axis(triad, axis, duration, dt);
        white[axis] = errors.white;
        mean[axis] = errors.mean;
        walk[axis] = errors.walk;
        change[axis] = errors.change;
        reading[axis] = reading_variance(triad, axis, input, force);
        quantum[axis] = errors.quantum;
    }
    return (imki_alignment_errors){.white = body_covariance(triad, white),
                                   .mean = body_covariance(triad, mean),
                                   .walk = body_covariance(triad, walk),
                                   .change = body_covariance(triad, change),
                                   .reading = body_covariance(triad, reading),
                                   .quantum = body_covariance(triad, quantum)};
}

double imki_alignment_isotropic(const imk_matrix3 *covariance)
{
    return (covariance->m[0][0] + covariance->m[1][1] + covariance->m[2][2]) / 3.0;
}
