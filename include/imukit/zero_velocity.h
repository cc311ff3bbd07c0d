/* SPDX-License-Identifier: Apache-2.0 */
/** @file zero_velocity.h
 *  Navigation with zero-velocity updates: a strapdown mechanisation whose errors are estimated and
 *  taken out whenever the unit is known to stand, and a detector that tells when it does.
 *
 *  The filter is a closed-loop Kalman filter in Earth-fixed axes. Its states are nine errors of
 *  navigation (position, velocity, attitude) and, per axis of gyro and accelerometer, a bias made
 *  of parts: a constant that may walk, and first-order Gauss-Markov processes. A standstill of a
 *  few seconds says that the velocity is zero; since a velocity error grows from tilt, heading and
 *  bias, it corrects these too. Without any update the covariance is that of free navigation.
 *
 *  Every update is tested: one whose innovation is too unlikely (chi-square) is refused and
 *  counted. Equations: docs/theory/zero-velocity.md. */
#ifndef IMUKIT_ZERO_VELOCITY_H
#define IMUKIT_ZERO_VELOCITY_H

#include "imukit/alignment.h"
#include "imukit/model.h"
#include "imukit/navigate.h"

IMK_BEGIN_C

enum { IMK_BIAS_PARTS_MAX = 13, IMK_NAVIGATION_ERRORS = 9 };

/** A part of the biases of three axes. */
typedef struct imk_bias_part {
    double correlation_time; /**< [s]; 0: a constant, which walks when `walk` is not 0 */
    double sigma[3];         /**< 1 sigma at the start; of a Gauss-Markov process always [unit] */
    double walk[3];          /**< of a constant: K [unit/sqrt(s)] */
} imk_bias_part;

/** The errors of one triad as the filter knows them; unit rad/s or m/s^2. */
typedef struct imk_triad_errors {
    double white[3];        /**< N [unit/sqrt(Hz)] */
    double quantization[3]; /**< Q [unit s] */
    size_t part_count;
    imk_bias_part part[IMK_BIAS_PARTS_MAX];
} imk_triad_errors;

/** Start from imk_zero_velocity_default(). */
typedef struct imk_zero_velocity_settings {
    uint32_t cookie;
    imk_triad_errors gyro, accel; /**< imk_zero_velocity_describe() fills them from a model */
    bool hold_height;             /**< slaved vertical: the height stays that of the start */
    int samples;                  /**< of coning and sculling, 1 … 4: imk_strapdown.samples */
    double step; /**< the covariance goes by steps of at least so long [s]; 0.001 … 10 */
    double velocity_sigma; /**< of what is left of the velocity of a standing unit, each axis
                                [m/s], > 0 */
    double rotation_sigma; /**< of what is left of its rate, mean over a stand; 0: the rotation
                                is not used [rad/s] */
    double false_alarm;    /**< probability that a good update is refused, 0 < … < 0.5 */
    /** 1 sigma of the errors at the start, independent of the biases: position, velocity, attitude;
     *  north, east, down (drift.h). */
    double initial_sigma[IMK_NAVIGATION_ERRORS];
    /** Covariance of the attitude error at the start that is independent of the biases too [rad^2],
     *  added to initial_sigma. */
    double attitude_covariance[3][3];
    /** A self-alignment before the start leaves errors of attitude about north, east, down that
     *  come from the biases' means over `alignment_time` [s]: alignment[i][axis] times that of
     *  gyro x, y, z [s], then accelerometer x, y, z [s^2/m]. Zeros: no self-alignment. */
    double alignment[3][6];
    double alignment_time;
} imk_zero_velocity_settings;

/** Perfect sensors, free vertical, three samples, steps of 0.5 s, 10 mm/s, no rotation, false alarm
 * 1e-4. */
IMK_API void imk_zero_velocity_default(imk_zero_velocity_settings *settings);

/** Fill gyro and accel from a model with three axes of each.
 *
 *  White noise, quantization, random walk and Gauss-Markov terms are taken as they are. Flicker
 *  (bias instability B) becomes Gauss-Markov processes with correlation times of 10, 100, 1000 and
 *  10^4 s, each of variance B^2 ln(10)/pi: its spectrum within 12 % from 0.1 to 10 mHz. What is
 *  constant while the unit stands joins the constant part: repeatability, the sigma of the fixed
 *  bias, and the uncertain scale factors, misalignments and g-sensitivity times the means of rate
 *  and force. Fixed values count as taken out (imukit compensate).
 *  @param rate,force  means at the start, body axes [rad/s], [m/s^2]
 *  @return IMK_ERROR_UNSUPPORTED (a triad is missing or has not three axes) */
IMK_API imk_status imk_zero_velocity_describe(const imk_model *model, imk_vector3 rate,
                                              imk_vector3 force,
                                              imk_zero_velocity_settings *settings,
                                              imk_error *error);

/** Fill `alignment`, and what of its covariance the biases do not explain, for a unit that aligned
 *  itself: e_N = -a_E/g, e_E = a_N/g, e_D = -w_E/(W cos L) + a_E tan(L)/g, with a and w the biases
 *  turned to north, east and down, W the Earth's rate, L the latitude. An alignment in inertial
 *  axes is that of the middle of its time, carried on by the gyros for the other half: w_D times it
 *  is added to e_D, and w_N times it to e_N unless the method is fine. After the gyro and accel
 *  fields.
 *  @param heading  false: the heading in `alignment` was given, not found: e_D is independent
 *  @return IMK_ERROR_NO_CONVERGENCE, IMK_ERROR_NOT_FINITE (a covariance that is none) */
IMK_API imk_status imk_zero_velocity_aligned(const imk_alignment_result *alignment,
                                             imk_alignment_method method, bool heading,
                                             double alignment_time,
                                             imk_zero_velocity_settings *settings);

/** What the filter knows. */
typedef struct imk_zero_velocity_estimate {
    imk_navigation_state state;
    double covariance[IMK_NAVIGATION_ERRORS][IMK_NAVIGATION_ERRORS]; /**< of position, velocity and
                                                    attitude errors; north, east, down there */
    imk_vector3 gyro_bias, accel_bias;             /**< sums of the parts; body axes */
    imk_vector3 gyro_bias_sigma, accel_bias_sigma; /**< and their 1 sigma */
} imk_zero_velocity_estimate;

/** How the updates went. */
typedef struct imk_zero_velocity_counts {
    uint64_t accepted, refused;
    uint64_t refused_in_row; /**< up to now: a filter that refuses on and on has lost its way */
    double first_refused;    /**< time of the first one refused [s]; NaN: none */
    uint64_t degrees;        /**< of freedom of all updates tested together */
    double chi_square;       /**< sum of their normalised innovations squared: near `degrees` when
                                  the model describes the unit */
} imk_zero_velocity_counts;

/** A filter under way: opaque memory of imk_zero_velocity_size() bytes, given by the caller. */
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

/** One sample as read: increments of angle [rad] and velocity [m/s] over dt > 0 [s], body axes. The
 *  biases estimated so far are taken off inside. */
IMK_API void imk_zero_velocity_step(imk_zero_velocity *filter, double dt, imk_vector3 angle,
                                    imk_vector3 velocity);
/** The unit has stood since the last update, or since imk_zero_velocity_moved(), and still does:
 *  update with zero velocity, and zero rotation if it is used. @return false: refused */
IMK_API bool imk_zero_velocity_update(imk_zero_velocity *filter);
/** A stand, if any, begins here at the earliest: what was turned before is not looked at. */
IMK_API void imk_zero_velocity_moved(imk_zero_velocity *filter);
/** The unit is at a known place: update with those axes whose sigma is finite, such as only the
 *  height of a barometer. @param sigma north, east, down [m], > 0; infinity: not known there
 *  @return false: refused */
IMK_API bool imk_zero_velocity_fix(imk_zero_velocity *filter, imk_geodetic place,
                                   imk_vector3 sigma);

/** The estimate at the end of the last sample. */
IMK_API void imk_zero_velocity_get(imk_zero_velocity *filter, imk_zero_velocity_estimate *estimate);
/** The state alone, at little cost. */
IMK_API imk_navigation_state imk_zero_velocity_state(const imk_zero_velocity *filter);
/** What the sensors of a unit read in the mean while it stands, biases included, body axes; and
 *  1 sigma of that, root sum of squares of the axes. */
typedef struct imk_rest_readings {
    imk_vector3 rate, force; /**< [rad/s], [m/s^2] */
    double rate_sigma, force_sigma;
} imk_rest_readings;
/** These readings now, as the filter knows attitude and biases. */
IMK_API imk_rest_readings imk_zero_velocity_rest(const imk_zero_velocity *filter);
/** Counts of updates up to now. */
IMK_API imk_zero_velocity_counts imk_zero_velocity_counted(const imk_zero_velocity *filter);

/* ---- does it stand? ---------------------------------------------------------------------------
 */

enum { IMK_STANDSTILL_FIGURES = 4 };

/** Tells standing from moving by four figures of each window of samples: the scatter of the force,
 *  the scatter of the rate, and the distances of the mean force and rate from those of a standing
 *  unit. What they are at rest is learnt from a time when the unit is known to stand, its usual
 *  disturbances included. Steady motion on a straight line makes no such signal but vibration; the
 *  filter's own test of the innovation is the second guard. Plain data. */
typedef struct imk_standstill {
    double window;      /**< [s] */
    double false_alarm; /**< probability that a window at rest is taken for motion */
    uint64_t learnt;    /**< windows */
    double sum[IMK_STANDSTILL_FIGURES], square_sum[IMK_STANDSTILL_FIGURES];
    double limit[IMK_STANDSTILL_FIGURES]; /**< once imk_standstill_ready() has been called */
    imk_vector3 turn_sum, speed_sum;      /**< of all windows */
    double time_sum;
    /** The window under way: */
    size_t count;
    double time;
    imk_vector3 turn, speed; /**< sums of the increments */
    imk_vector3 first_rate, first_force, rate_off, force_off;
    double rate_square[3], force_square[3]; /**< about the first sample */
} imk_standstill;

/** @param window  [s], > 0, and at least four samples: 1 s is usual
 *  @param false_alarm  per window, 0 < … < 1 */
IMK_API imk_standstill imk_standstill_start(double window, double false_alarm);
/** One sample of a time when the unit is known to stand. */
IMK_API void imk_standstill_learn(imk_standstill *detector, double dt, imk_vector3 angle,
                                  imk_vector3 velocity);
/** End of the learning: each figure is taken for a multiple of a chi-square variable with the mean
 *  and variance found, and its limit for the quantile of that.
 *  @return IMK_ERROR_TOO_SHORT (fewer than 10 windows) */
IMK_API imk_status imk_standstill_ready(imk_standstill *detector, imk_error *error);

typedef enum imk_standstill_verdict {
    IMK_STANDSTILL_UNDECIDED = 0, /**< the window is not full yet */
    IMK_STANDSTILL_MOVES,
    IMK_STANDSTILL_STANDS
} imk_standstill_verdict;
/** One sample. @param rest  of imk_zero_velocity_rest(); looked at when the window is full. Its
 * sigmas widen the limits of the two distances by four times themselves */
IMK_API imk_standstill_verdict imk_standstill_add(imk_standstill *detector, double dt,
                                                  imk_vector3 angle, imk_vector3 velocity,
                                                  const imk_rest_readings *rest);

IMK_END_C
#endif
