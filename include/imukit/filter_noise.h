/* SPDX-License-Identifier: Apache-2.0 */
/** @file filter_noise.h
 *  Inputs of a Kalman filter from a sensor model: bias states, and the matrices of their driving
 *  noise.
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
 *  | white, of a reading  | N [unit/sqrt(Hz)]     | N/sqrt(dt)       |
 *  | white, of x0         | N                     | N sqrt(dt)       |
 *  | walk of a bias       | q [unit/s/sqrt(Hz)]   | q sqrt(dt)       |
 *
 *  A filter that confuses the continuous number with the number per sample is wrong by sqrt(dt): at
 *  200 Hz by a factor of 14. See docs/filter-noise.md. */
#ifndef IMUKIT_FILTER_NOISE_H
#define IMUKIT_FILTER_NOISE_H

#include "imukit/model.h"

IMK_BEGIN_C

/** Approximation of bias instability (flicker noise), which no finite number of states describes
 *  exactly. */
typedef enum imk_filter_flicker {
    IMK_FILTER_FLICKER_RANDOM_WALK =
        0, /**< random walk with the Allan deviation of the floor at tau = sqrt(from to) */
    IMK_FILTER_FLICKER_GAUSS_MARKOV, /**< one Gauss-Markov process, optimised over from … to */
    IMK_FILTER_FLICKER_TWO_GAUSS_MARKOV, /**< two Gauss-Markov processes: within a fifth over three
                                            decades */
    IMK_FILTER_FLICKER_LEFT_OUT
} imk_filter_flicker;

/** Settings. Start from imk_filter_noise_default(), then change fields. */
typedef struct imk_filter_noise_settings {
    uint32_t cookie;
    imk_filter_flicker flicker;
    /** Averaging times over which the filter's model must hold [s], 1e-9 … 1e9, from <= to: `from`
     *  is the interval of the aiding updates, `to` the longest time without updates. */
    double from, to;
} imk_filter_noise_settings;
/** A random walk, matched over 1 s … 1000 s. */
IMK_API imk_filter_noise_settings imk_filter_noise_default(void);

/** Origin of a bias state. */
typedef enum imk_filter_source {
    IMK_FILTER_FROM_RANDOM_WALK = 0,  /**< K of the model */
    IMK_FILTER_FROM_GAUSS_MARKOV,     /**< a Gauss-Markov term of the model */
    IMK_FILTER_FROM_BIAS_INSTABILITY, /**< an approximation of its flicker noise */
    IMK_FILTER_FROM_CONSTANT          /**< a constant without driving noise: the bias of a run */
} imk_filter_source;

typedef struct imk_filter_state {
    imk_filter_source source;
    double correlation_time; /**< T [s]; infinite: random walk */
    double driving;          /**< q, continuous [unit/s/sqrt(Hz)] = [unit/sqrt(s)] */
    /** Part of `driving` that represents bias instability, for a random walk. */
    double flicker_walk;
    double sigma;   /**< stationary 1 sigma, q sqrt(T/2) [unit]; 0 for a random walk, which grows
                       without bound */
    double initial; /**< 1 sigma at the start [unit]: the stationary value; for the first state that
                       is not a Gauss-Markov process, the run-to-run bias */
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
    double white;         /**< N [unit/sqrt(Hz)], two-sided */
    double quantization;  /**< Q [unit s]: measurement noise of x0: 1 sigma of each reading of the
                             integral. Readings are independent, so it does not accumulate */
    double reading_noise; /**< the same [unit s], not of counting: the variances add up */
    double angle_white;   /**< A [unit s/sqrt(Hz)]: the same, but of the density A^2: the variance
                             of readings that are means over dt is A^2/dt more */
    int state_count;
    imk_filter_state state[IMK_FILTER_STATES_MAX];
    unsigned lost;     /**< IMK_FILTER_LOST_… bits */
    double misfit;     /**< largest relative error of the Allan deviation, all terms together, over
                            from … to; 0 without bias instability */
    double misfit_tau; /**< averaging time of that error [s] */
} imk_filter_noise;

/** The filter's model of one axis. Its states are those of the Gauss-Markov terms, then a random
 *  walk (K), then those of bias instability. If there are none of these, there is one constant
 *  without driving noise. A random walk for bias instability is combined with that of K, as two
 *  could not be distinguished.
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

/** Exact discretisation over dt [s], 1e-9 … 1e9: x[k+1] = Phi x[k] + w[k], w of covariance Q_d. For
 *  a state of time T, with a = dt/T:
 *
 *      Phi_0b = T (1 - e^-a)       Q_00 = N^2 dt + sum q^2 T^3 [a - 2 (1 - e^-a) + (1 - e^-2a)/2]
 *      Phi_bb = e^-a               Q_0b = q^2 T^2 (1 - e^-a)^2/2,   Q_bb = q^2 T (1 - e^-2a)/2
 *
 *  and with dt^3/3, dt^2/2, dt for a random walk; by series where terms cancel, relative error <
 *  1e-14. Either may be NULL. Q_d describes the process between two readings, so it does not
 *  contain quantization. */
IMK_API void imk_filter_discrete(const imk_filter_noise *noise, double dt, double *phi,
                                 double *q_d);

IMK_END_C
#endif
