/* SPDX-License-Identifier: Apache-2.0 */
/** @file filter_noise.h
 *  What a Kalman filter needs from a sensor model: bias states, and the matrices that drive them.
 *
 *  Per axis the filter's error states are the integral of the axis' error, x0 (the attitude error
 *  of a gyro [rad], the velocity error of an accelerometer [m/s]), and its bias states b_i:
 *
 *      dx0/dt  = sum b_i + w,             w   white, density N^2
 *      db_i/dt = -b_i/T_i + w_i,          w_i white, density q_i^2     (T_i infinite: random walk)
 *
 *  Densities are two-sided and continuous: Q_c = diag(N^2, q_1^2, …). They are NOT variances per
 *  sample. Between samples dt apart the same noises have these standard deviations:
 *
 *      | noise                | continuous            | per sample       |
 *      | white, of a reading  | N [unit/sqrt(Hz)]     | N/sqrt(dt)       |
 *      | white, of x0         | N                     | N sqrt(dt)       |
 *      | walk of a bias       | q [unit/s/sqrt(Hz)]   | q sqrt(dt)       |
 *
 *  A filter that takes the continuous number for the per-sample one, or the other way round, is
 *  wrong by sqrt(dt): at 200 Hz by a factor of 14. docs/filter-noise.md. */
#ifndef IMUKIT_FILTER_NOISE_H
#define IMUKIT_FILTER_NOISE_H

#include "imukit/model.h"

IMK_BEGIN_C

/** How bias instability (flicker noise), which no finite number of states has, is approximated. */
typedef enum imk_filter_flicker {
    IMK_FILTER_FLICKER_RANDOM_WALK = 0,  /**< with the floor's Allan deviation at sqrt(from to) */
    IMK_FILTER_FLICKER_GAUSS_MARKOV,     /**< one process, optimised over from … to */
    IMK_FILTER_FLICKER_TWO_GAUSS_MARKOV, /**< two: within a fifth over three decades */
    IMK_FILTER_FLICKER_LEFT_OUT
} imk_filter_flicker;

/** Start from imk_filter_noise_default(), then change fields. */
typedef struct imk_filter_noise_settings {
    uint32_t cookie;
    imk_filter_flicker flicker;
    /** Averaging times over which the filter's model has to hold [s], 1e-9 … 1e9, from <= to:
     *  from the update interval of its aiding to the longest time without. */
    double from, to;
} imk_filter_noise_settings;
/** A random walk, matched over 1 s … 1000 s. */
IMK_API imk_filter_noise_settings imk_filter_noise_default(void);

/** What a bias state stands for. */
typedef enum imk_filter_source {
    IMK_FILTER_FROM_RANDOM_WALK = 0,  /**< K of the model */
    IMK_FILTER_FROM_GAUSS_MARKOV,     /**< a Gauss-Markov term of the model */
    IMK_FILTER_FROM_BIAS_INSTABILITY, /**< an approximation of its flicker noise */
    IMK_FILTER_FROM_CONSTANT          /**< nothing drives it: the bias of a run */
} imk_filter_source;

typedef struct imk_filter_state {
    imk_filter_source source;
    double correlation_time; /**< T [s]; infinite: random walk */
    double driving;          /**< q, continuous [unit/s/sqrt(Hz)] = [unit/sqrt(s)] */
    double flicker_walk;     /**< part of it that stands for bias instability, in a random walk */
    double sigma;   /**< stationary, q sqrt(T/2) [unit]; of a walk 0: it grows without end */
    double initial; /**< 1 sigma at the start [unit]: stationary, and of the first state
                         that is no process the run-to-run bias */
} imk_filter_state;

/** Terms of the model that the states leave out. */
enum {
    IMK_FILTER_LOST_FLICKER = 1 << 0,
    IMK_FILTER_LOST_RAMP = 1 << 1,
    IMK_FILTER_LOST_SINUSOID = 1 << 2,
    IMK_FILTER_LOST_RESONANCE = 1 << 3,
    IMK_FILTER_LOST_LOW_PASS = 1 << 4
};

enum { IMK_FILTER_STATES_MAX = IMK_TERMS_MAX + 3 };

/** One axis. */
typedef struct imk_filter_noise {
    double white;        /**< N [unit/sqrt(Hz)], two-sided */
    double quantization; /**< Q [unit s]: measurement noise of x0, 1 sigma of each reading of the
                              integral, independent of the others; it does not add up */
    int state_count;
    imk_filter_state state[IMK_FILTER_STATES_MAX];
    unsigned lost;     /**< IMK_FILTER_LOST_… bits */
    double misfit;     /**< largest relative error of the Allan deviation, all terms together, over
                            from … to; 0 without bias instability */
    double misfit_tau; /**< where [s] */
} imk_filter_noise;

/** The filter's model of one axis. Its states: those of the Gauss-Markov terms, then a random walk
 *  (K), then those of bias instability; one without driving noise when there are none of these. A
 *  random walk for bias instability is added to that of K: two of them could not be told apart.
 *  @param triad  of a valid model
 *  @return IMK_ERROR_UNINITIALISED, _RANGE (error.field: the setting, or "axis") */
IMK_API imk_status imk_filter_noise_of(const imk_triad *triad, int axis,
                                       const imk_filter_noise_settings *settings,
                                       imk_filter_noise *noise, imk_error *error);

/** Allan variance of the states and the white noise at tau [s]. */
IMK_API double imk_filter_noise_allan_variance(const imk_filter_noise *noise, double tau);

/** Continuous matrices over (x0, b_1 …), (1 + state_count) square, row-major: dx/dt = F x + w, w of
 *  density Q_c. Either may be NULL. */
IMK_API void imk_filter_continuous(const imk_filter_noise *noise, double *f, double *q_c);

/** Exact discretisation over dt [s], 1e-9 … 1e9: x[k+1] = Phi x[k] + w[k], w of covariance Q_d.
 *  For a state of time T, with a = dt/T:
 *
 *      Phi_0b = T (1 - e^-a)       Q_00 = N^2 dt + sum q^2 T^3 [a - 2 (1 - e^-a) + (1 - e^-2a)/2]
 *      Phi_bb = e^-a               Q_0b = q^2 T^2 (1 - e^-a)^2/2,   Q_bb = q^2 T (1 - e^-2a)/2
 *
 *  and dt^3/3, dt^2/2, dt for a walk; by series where these cancel, relative error < 1e-14. Either
 *  may be NULL. Q_d is of the process between two readings: quantization is not in it. */
IMK_API void imk_filter_discrete(const imk_filter_noise *noise, double dt, double *phi,
                                 double *q_d);

IMK_END_C
#endif
