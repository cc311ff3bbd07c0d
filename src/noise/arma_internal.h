/* SPDX-License-Identifier: Apache-2.0 */
/* From a linear system driven by white noise to the ARMA sequence of its samples. */
#ifndef IMUKIT_ARMA_INTERNAL_H
#define IMUKIT_ARMA_INTERNAL_H

#include "generator_internal.h"

/* x' = -w x + drive u (order 1), or x'' + 2 damping w x' + w^2 x = drive u (order 2), u white noise
 * of unit density. The state is (x, v = x'); order 1 leaves v at 0. */
typedef struct imki_dynamics {
    int order;
    double omega;   /* [rad/s] */
    double rate[2]; /* decay rates of the two modes, slow one first; order 1: {w, infinity} [1/s] */
    double angular; /* > 0: the modes are an oscillation of this angular frequency [rad/s] */
    double drive;
} imki_dynamics;

imki_dynamics imki_first_order(double omega, double drive);
imki_dynamics imki_second_order(double omega, double damping, double drive);

/* What a stretch of time does:  (x, v) -> phi (x, v) + noise;  total = g (x, v) + noise,  where the
 * total is the integral of x over the stretch, or the sum of samples. q is the covariance of the
 * three noises, in the order x, v, total. */
typedef struct imki_stretch {
    double phi[2][2];
    double g[2];
    double q[3][3];
} imki_stretch;

/* phi over a time h. */
void imki_transition(const imki_dynamics *dynamics, double h, double phi[2][2]);
/* A time h, the total being the integral. */
imki_stretch imki_stretch_of_time(const imki_dynamics *dynamics, double h);
/* n samples dt apart, the first at the start; the total is their sum. */
imki_stretch imki_stretch_of_samples(const imki_dynamics *dynamics, double dt, size_t n);
/* Half the mean square of the difference of the totals of two neighbouring stretches, in the
 * stationary state: the Allan variance when the totals are made means. */
double imki_half_difference(const imki_dynamics *dynamics, const imki_stretch *stretch);
/* Stationary variances of x and v (which are uncorrelated). */
void imki_stationary(const imki_dynamics *dynamics, double variance[2]);
/* a^T q b for two linear forms of the noises of a stretch. */
double imki_covariance(const imki_stretch *stretch, const double a[3], const double b[3]);
/* angular * dt, brought to 0 … pi: the angle of the upper pole of the samples. */
double imki_angle_of(double angular, double dt);

/* What a sensor's output filter does over a time. @return IMK_ERROR_RANGE, IMK_ERROR_NOT_FINITE
 * where it does not fit a sample interval of this length */
imk_status imki_low_pass_over(imk_low_pass filter, double time, imki_stretch *stretch);

/* The sequence with the poles of the dynamics over dt and a moving average of the given
 * autocovariances at lags 0, 1, 2. Its polynomial B is the invertible factor: B(1) and B(-1) are
 * positive roots of the spectrum at 0 and 1/2, which give b1 and b0 + b2; b0 b2 is the
 * autocovariance at lag 2. `variance` and `decrement` are left to the caller. */
imk_arma imki_arma_design(const double autocovariance[3], const imki_dynamics *dynamics, double dt);

#endif
