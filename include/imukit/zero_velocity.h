/* SPDX-License-Identifier: Apache-2.0 */
/** @file zero_velocity.h
 *  Navigation with zero-velocity updates: a strapdown mechanisation whose errors are estimated and
 *  corrected whenever the unit is known to be stationary, and a detector of these times.
 *
 *  The filter is a closed-loop Kalman filter in Earth-fixed axes. Its states are nine errors of
 *  navigation (position, velocity, attitude) and, per axis of gyro and accelerometer, a bias that
 *  is the sum of parts: a constant that may walk, and first-order Gauss-Markov processes. At a stop
 *  of a few seconds the velocity is known to be zero. As velocity errors grow from tilt, heading
 *  and bias, the update corrects these, too. Without any update the covariance is that of free
 *  navigation.
 *
 *  Every update is tested: if its innovation is too unlikely (chi-square), the update is refused
 *  and counted. Equations: docs/theory/zero-velocity.md. */
#ifndef IMUKIT_ZERO_VELOCITY_H
#define IMUKIT_ZERO_VELOCITY_H

#include "imukit/alignment.h"
#include "imukit/model.h"
#include "imukit/navigate.h"

IMK_BEGIN_C

enum { IMK_BIAS_PARTS_MAX = 13, IMK_NAVIGATION_ERRORS = 9 };

/** One part of the biases of three axes. */
typedef struct imk_bias_part {
    double correlation_time; /**< [s]; 0: a constant, which walks when `walk` is not 0 */
    double sigma[3]; /**< 1 sigma at the start; for a Gauss-Markov process 1 sigma at all times
                        [unit] */
    double walk[3];  /**< random walk K of a constant [unit/sqrt(s)] */
} imk_bias_part;

/** The errors of one triad as modelled by the filter; unit is rad/s or m/s^2. */
typedef struct imk_triad_errors {
    double white[3];        /**< N [unit/sqrt(Hz)] */
    double quantization[3]; /**< 1 sigma of a reading of the integral [unit s] */
    size_t part_count;
    imk_bias_part part[IMK_BIAS_PARTS_MAX];
} imk_triad_errors;

/** Start from imk_zero_velocity_default(). */
typedef struct imk_zero_velocity_settings {
    uint32_t cookie;
    imk_triad_errors gyro, accel; /**< imk_zero_velocity_describe() fills them from a model */
    bool hold_height;             /**< the height is held at that of the start */
    int samples; /**< samples of the coning and sculling algorithms, 1 … 4: imk_strapdown.samples */
    double step;           /**< shortest time step of the covariance [s]; 0.001 … 10 */
    double velocity_sigma; /**< 1 sigma of the remaining velocity of a stationary unit, each axis
                              [m/s], > 0 */
    double rotation_sigma; /**< 1 sigma of its remaining mean rate over a stop [rad/s]; 0: the
                              rotation is not used */
    double false_alarm;    /**< probability that a good update is refused, 0 < … < 0.5 */
    /** 1 sigma of the errors at the start that are independent of the biases: position, velocity,
     *  attitude; north, east, down (drift.h). */
    double initial_sigma[IMK_NAVIGATION_ERRORS];
    /** Further covariance of the attitude error at the start, also independent of the biases
     *  [rad^2]; it is added to initial_sigma. */
    double attitude_covariance[3][3];
    /** After a self-alignment, the attitude errors about north, east, down (i) contain the mean
     *  biases over `alignment_time` [s], multiplied by alignment[i][axis]: gyro x, y, z [s], then
     *  accelerometer x, y, z [s^2/m]. Zeros: no self-alignment. */
    double alignment[3][6];
    double alignment_time;
} imk_zero_velocity_settings;

/** Perfect sensors, free vertical, three samples, steps of 0.5 s, velocity sigma 10 mm/s, rotation
 *  not used, false alarm 1e-4. */
IMK_API void imk_zero_velocity_default(imk_zero_velocity_settings *settings);

/** Fill gyro and accel from a model with three axes of each.
 *
 *  White noise, random walk and Gauss-Markov terms are taken as they are, quantization together
 *  with white noise of the integral (imk_noise_reading()). Flicker (bias instability B) becomes
 *  Gauss-Markov processes with correlation times of 10, 100, 1000 and 10^4 s, each of variance B^2
 *  ln(10)/pi: the spectrum is accurate within 12 % from 0.1 to 10 mHz. The constant part contains
 *  all errors that are constant while the unit is stationary: repeatability, the sigma of the fixed
 *  bias, and the sigmas of scale factors, misalignments and g-sensitivity times the means of rate
 *  and force. Known values are assumed to be taken out (imukit compensate).
 *  @param dt          sample interval [s], > 0
 *  @param rate,force  mean readings at the start, body axes [rad/s], [m/s^2]
 *  @return IMK_ERROR_UNSUPPORTED (a triad is missing or has not three axes) */
IMK_API imk_status imk_zero_velocity_describe(const imk_model *model, double dt, imk_vector3 rate,
                                              imk_vector3 force,
                                              imk_zero_velocity_settings *settings,
                                              imk_error *error);

/** Fill `alignment`, and the part of the alignment's covariance that the biases do not explain, for
 *  a unit that aligned itself: e_N = -a_E/g, e_E = a_N/g, e_D = -w_E/(W cos L) + a_E tan(L)/g, with
 *  a and w the biases turned to north, east and down, W the Earth's rate, L the latitude. An
 *  alignment in inertial axes holds for the middle of its time, and the gyros carry it on over the
 *  other half: w_D times this half is added to e_D, and w_N times it to e_N unless the method is
 *  fine. Call it after gyro and accel are filled.
 *  @param heading  false: the heading in `alignment` was given, not found: e_D is independent
 *  @return IMK_ERROR_NO_CONVERGENCE, IMK_ERROR_NOT_FINITE (the covariance is not valid) */
IMK_API imk_status imk_zero_velocity_aligned(const imk_alignment_result *alignment,
                                             imk_alignment_method method, bool heading,
                                             double alignment_time,
                                             imk_zero_velocity_settings *settings);

/** Estimate of the filter. */
typedef struct imk_zero_velocity_estimate {
    imk_navigation_state state;
    /** Of position, velocity and attitude errors; north, east, down at the estimated place. */
    double covariance[IMK_NAVIGATION_ERRORS][IMK_NAVIGATION_ERRORS];
    imk_vector3 gyro_bias, accel_bias;             /**< sums of the parts; body axes */
    imk_vector3 gyro_bias_sigma, accel_bias_sigma; /**< 1 sigma of these biases */
} imk_zero_velocity_estimate;

/** Counts of updates. */
typedef struct imk_zero_velocity_counts {
    uint64_t accepted, refused;
    uint64_t refused_in_row; /**< latest updates refused without a break; if this keeps growing, the
                                filter has diverged */
    double first_refused;    /**< time of the first one refused [s]; NaN: none */
    uint64_t degrees;        /**< degrees of freedom of all tested updates together */
    double chi_square; /**< sum of their squared normalised innovations; near `degrees` if the model
                          describes the unit */
} imk_zero_velocity_counts;

/** A filter in progress: opaque memory of imk_zero_velocity_size() bytes, given by the caller. */
typedef struct imk_zero_velocity imk_zero_velocity;
/** Bytes for a filter. */
IMK_API size_t imk_zero_velocity_size(const imk_zero_velocity_settings *settings);
/** Start at a state.
 *  @return IMK_ERROR_UNINITIALISED, IMK_ERROR_RANGE (a sigma that is negative or not finite, …:
 *          error.field), IMK_ERROR_WORKSPACE */
IMK_API imk_status imk_zero_velocity_start(const imk_zero_velocity_settings *settings,
                                           const imk_navigation_state *start,
                                           imk_zero_velocity **filter, void *memory,
                                           size_t memory_size, imk_error *error);

/** Take one sample as read: increments of angle [rad] and velocity [m/s] over dt > 0 [s], body
 *  axes. The function subtracts the estimated biases. */
IMK_API void imk_zero_velocity_step(imk_zero_velocity *filter, double dt, imk_vector3 angle,
                                    imk_vector3 velocity);
/** Update with zero velocity, and with zero rotation if it is used. The unit must have been
 *  stationary since the last update or imk_zero_velocity_moved(). @return false: the update was
 *  refused */
IMK_API bool imk_zero_velocity_update(imk_zero_velocity *filter);
/** State that the unit has moved until now: rotation before this moment does not count for the next
 *  update. */
IMK_API void imk_zero_velocity_moved(imk_zero_velocity *filter);
/** Update with a known place, on the axes whose sigma is finite, such as the height of a barometer
 *  only.
 *  @param sigma  1 sigma north, east, down [m], > 0; infinity: not known
 *  @return false: the update was refused */
IMK_API bool imk_zero_velocity_fix(imk_zero_velocity *filter, imk_geodetic place,
                                   imk_vector3 sigma);

/** The estimate at the end of the last sample. */
IMK_API void imk_zero_velocity_get(imk_zero_velocity *filter, imk_zero_velocity_estimate *estimate);
/** The state without covariance, at little cost. */
IMK_API imk_navigation_state imk_zero_velocity_state(const imk_zero_velocity *filter);
/** Mean readings of a stationary unit, biases included, body axes; and their 1 sigma, as root sum
 *  of squares of the axes. */
typedef struct imk_rest_readings {
    imk_vector3 rate, force; /**< [rad/s], [m/s^2] */
    double rate_sigma, force_sigma;
} imk_rest_readings;
/** These readings at present, from the estimated attitude and biases. */
IMK_API imk_rest_readings imk_zero_velocity_rest(const imk_zero_velocity *filter);
/** Counts of updates up to now. */
IMK_API imk_zero_velocity_counts imk_zero_velocity_counted(const imk_zero_velocity *filter);

/* ---- detection of stops
 * ---------------------------------------------------------------------------
 */

enum { IMK_STANDSTILL_FIGURES = 4 };

/** Detects whether the unit is stationary or moves, by four figures of each window of samples: the
 *  scatter of the force, the scatter of the rate, and the distances of the mean force and rate from
 *  those of a stationary unit. Their values at rest, with usual disturbances, are learnt while the
 *  unit is known to be stationary. Steady motion on a straight line shows only by its vibration;
 *  the filter's test of the innovation is a second safeguard. Plain data. */
typedef struct imk_standstill {
    double window;      /**< length of a window [s] */
    double false_alarm; /**< probability that a window at rest is taken for motion */
    uint64_t learnt;    /**< number of windows learnt */
    double sum[IMK_STANDSTILL_FIGURES], square_sum[IMK_STANDSTILL_FIGURES];
    double limit[IMK_STANDSTILL_FIGURES]; /**< set by imk_standstill_ready() */
    imk_vector3 turn_sum, speed_sum;      /**< of all windows */
    double time_sum;
    /** The present window: */
    size_t count;
    double time;
    imk_vector3 turn, speed; /**< sums of the increments */
    imk_vector3 first_rate, first_force, rate_off, force_off;
    double rate_square[3], force_square[3]; /**< about the first sample */
} imk_standstill;

/** Start a detector.
 *  @param window       length of a window [s], > 0, at least four samples; 1 s is usual
 *  @param false_alarm  probability that a window at rest is taken for motion, 0 < … < 1 */
IMK_API imk_standstill imk_standstill_start(double window, double false_alarm);
/** Learn from one sample while the unit is known to be stationary. */
IMK_API void imk_standstill_learn(imk_standstill *detector, double dt, imk_vector3 angle,
                                  imk_vector3 velocity);
/** End the learning. Each figure is modelled as a multiple of a chi-square variable with the mean
 *  and variance found; its limit is the quantile of that.
 *  @return IMK_ERROR_TOO_SHORT (fewer than 10 windows) */
IMK_API imk_status imk_standstill_ready(imk_standstill *detector, imk_error *error);

typedef enum imk_standstill_verdict {
    IMK_STANDSTILL_UNDECIDED = 0, /**< the window is not full yet */
    IMK_STANDSTILL_MOVES,
    IMK_STANDSTILL_STANDS
} imk_standstill_verdict;
/** Take one sample; the verdict comes when a window is full.
 *  @param rest  from imk_zero_velocity_rest(), used when the window is full. Four times its sigmas
 *               are added to the limits of the two distances */
IMK_API imk_standstill_verdict imk_standstill_add(imk_standstill *detector, double dt,
                                                  imk_vector3 angle, imk_vector3 velocity,
                                                  const imk_rest_readings *rest);

IMK_END_C
#endif
