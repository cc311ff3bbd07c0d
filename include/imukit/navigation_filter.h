/* SPDX-License-Identifier: Apache-2.0 */
/** @file navigation_filter.h
 *  Aided navigation: a strapdown mechanisation whose errors are estimated and corrected by what
 *  else is known: that the unit stands, where it is, how fast, where it points (aiding.h).
 *
 *  The filter is a closed-loop Kalman filter in Earth-fixed axes. Its states are nine errors of
 *  navigation (position, velocity, attitude) and, per axis of gyro and accelerometer, a bias that
 *  is the sum of parts: a constant that may walk, and first-order Gauss-Markov processes; and, for
 *  aids that have them, correlated errors and errors of lever arms. As velocity errors grow from
 *  tilt, heading and bias, an update of the velocity or the position corrects these, too. Without
 *  any update the covariance is that of free navigation.
 *
 *  Every update is tested: if its innovation is too unlikely (chi-square), the update is refused
 *  and counted. Equations: docs/theory/navigation-filter.md. */
#ifndef IMUKIT_NAVIGATION_FILTER_H
#define IMUKIT_NAVIGATION_FILTER_H

#include "imukit/aiding.h"
#include "imukit/alignment.h"
#include "imukit/model.h"
#include "imukit/navigate.h"
#include "imukit/standstill.h"

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

/** Start from imk_navigation_filter_default(). */
typedef struct imk_navigation_filter_settings {
    uint32_t cookie;
    imk_triad_errors gyro, accel; /**< imk_navigation_filter_describe() fills them from a model */
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
    /** Aids; of each the kind, the sigmas and the lever arm are used, while their times are the
     *  caller's. Aids with the same lever arm and the same sigma of it, above 0, have one error of
     *  it in common. */
    size_t aid_count;
    imk_aid aid[IMK_AIDS_MAX];
    int recover_after; /**< readings of an aid refused in a row after which the covariance is
                          enlarged until the next one fits; 0: never */
} imk_navigation_filter_settings;

/** Perfect sensors, free vertical, three samples, steps of 0.5 s, velocity sigma 10 mm/s, rotation
 *  not used, false alarm 1e-4, no aids, recovery after 30 refusals. */
IMK_API void imk_navigation_filter_default(imk_navigation_filter_settings *settings);

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
IMK_API imk_status imk_navigation_filter_describe(const imk_model *model, double dt,
                                                  imk_vector3 rate, imk_vector3 force,
                                                  imk_navigation_filter_settings *settings,
                                                  imk_error *error);

/** Fill `alignment`, and the part of the alignment's covariance that the biases do not explain, for
 *  a unit that aligned itself: e_N = -a_E/g, e_E = a_N/g, e_D = -w_E/(W cos L) + a_E tan(L)/g, with
 *  a and w the biases turned to north, east and down, W the Earth's rate, L the latitude. An
 *  alignment in inertial axes holds for the middle of its time, and the gyros carry it on over the
 *  other half: w_D times this half is added to e_D, and w_N times it to e_N unless the method is
 *  fine. Call it after gyro and accel are filled.
 *  @param heading  false: the heading in `alignment` was given, not found: e_D is independent
 *  @return IMK_ERROR_NO_CONVERGENCE, IMK_ERROR_NOT_FINITE (the covariance is not valid) */
IMK_API imk_status imk_navigation_filter_aligned(const imk_alignment_result *alignment,
                                                 imk_alignment_method method, bool heading,
                                                 double alignment_time,
                                                 imk_navigation_filter_settings *settings);

/** Estimate of the filter. */
typedef struct imk_navigation_filter_estimate {
    imk_navigation_state state;
    /** Of position, velocity and attitude errors; north, east, down at the estimated place. Those
     *  of attitude are of what is displayed (imk_displayed_attitude_error()). */
    double covariance[IMK_NAVIGATION_ERRORS][IMK_NAVIGATION_ERRORS];
    imk_vector3 gyro_bias, accel_bias;             /**< sums of the parts; body axes */
    imk_vector3 gyro_bias_sigma, accel_bias_sigma; /**< 1 sigma of these biases */
} imk_navigation_filter_estimate;

/** Counts of updates of one kind: of stands, or of one aid. */
typedef struct imk_navigation_filter_counts {
    uint64_t accepted, refused;
    uint64_t refused_in_row; /**< latest updates refused without a break; if this keeps growing, the
                                filter has diverged */
    double first_refused;    /**< time of the first one refused [s]; NaN: none */
    uint64_t recovered; /**< of those accepted, how many only after the covariance was enlarged */
    double first_recovered; /**< time of the first of these [s]; NaN: none */
    uint64_t degrees;       /**< degrees of freedom of the accepted updates together */
    double chi_square; /**< sum of their squared normalised innovations; near `degrees` if the model
                          describes the unit */
    uint64_t pairs;    /**< degrees of freedom of accepted updates whose predecessor has as many */
    double pair_sum;   /**< sum of the products of normalised innovations with those before */
} imk_navigation_filter_counts;
/** Correlation of the innovations with those before: 0 within 1/sqrt(pairs) if all is as described;
 *  more if errors of the aid are correlated in time and not described so. NaN without pairs. */
IMK_API double imk_navigation_filter_correlation(const imk_navigation_filter_counts *counts);

/** A filter in progress: opaque memory of imk_navigation_filter_size() bytes, given by the caller.
 */
typedef struct imk_navigation_filter imk_navigation_filter;
/** Bytes for a filter. */
IMK_API size_t imk_navigation_filter_size(const imk_navigation_filter_settings *settings);
/** Start at a state.
 *  @return IMK_ERROR_UNINITIALISED, IMK_ERROR_RANGE (a sigma that is negative or not finite, …:
 *          error.field), IMK_ERROR_WORKSPACE */
IMK_API imk_status imk_navigation_filter_start(const imk_navigation_filter_settings *settings,
                                               const imk_navigation_state *start,
                                               imk_navigation_filter **filter, void *memory,
                                               size_t memory_size, imk_error *error);

/** Take one sample as read: increments of angle [rad] and velocity [m/s] over dt > 0 [s], body
 *  axes. The function subtracts the estimated biases. */
IMK_API void imk_navigation_filter_step(imk_navigation_filter *filter, double dt, imk_vector3 angle,
                                        imk_vector3 velocity);
/** Update with zero velocity, and with zero rotation if it is used. The unit must have been
 *  stationary since the last update or imk_navigation_filter_moved(). @return false: the update was
 *  refused */
IMK_API bool imk_navigation_filter_stand(imk_navigation_filter *filter);
/** State that the unit has moved until now: rotation before this moment does not count for the next
 *  update. */
IMK_API void imk_navigation_filter_moved(imk_navigation_filter *filter);
/** A reading of an aid. */
typedef struct imk_aid_reading {
    double time;     /**< [s], on the clock of imk_navigation_state.time, within the last sample */
    double value[3]; /**< position: latitude, longitude [rad], height [m]; velocity: north, east,
                        down [m/s]; heading [rad]; height [m]; odometer: along body x, y, z [m/s];
                        zero velocity: 0 */
    double sigma[3]; /**< 1 sigma of w of this reading (aiding.h), on the axes of the kind; 0: that
                        of the aid; infinity: not measured */
    bool compare;    /**< only compare: the innovation is that, and nothing changes */
} imk_aid_reading;

typedef enum imk_aid_verdict {
    IMK_AID_USED = 0,
    IMK_AID_RECOVERED, /**< used, after the covariance was enlarged */
    IMK_AID_REFUSED,   /**< its innovation is too unlikely */
    IMK_AID_NOT_USED   /**< out of the last sample; no axis is measured; not finite; a heading while
                          body x is vertical or at a pole */
} imk_aid_verdict;

/** Update with a reading of aid number `aid` of the settings. The state at its time is
 *  interpolated within the last sample. */
IMK_API imk_aid_verdict imk_navigation_filter_aid(imk_navigation_filter *filter, size_t aid,
                                                  const imk_aid_reading *reading);

/** The innovation of the last update tried: prediction minus reading. */
typedef struct imk_innovation {
    size_t rows;
    int axis[3];     /**< of each row */
    double value[3]; /**< [unit of the aid; stands: m/s or rad/s] */
    double sigma[3]; /**< 1 sigma predicted */
    double chi_square;
    bool accepted;
} imk_innovation;
/** That of the last update tried; no rows before the first. */
IMK_API imk_innovation imk_navigation_filter_innovation(const imk_navigation_filter *filter);

/** The estimate at the end of the last sample. */
IMK_API void imk_navigation_filter_get(imk_navigation_filter *filter,
                                       imk_navigation_filter_estimate *estimate);
/** The state without covariance, at little cost. */
IMK_API imk_navigation_state imk_navigation_filter_state(const imk_navigation_filter *filter);
/** These readings at present, from the estimated attitude and biases. */
IMK_API imk_rest_readings imk_navigation_filter_rest(const imk_navigation_filter *filter);
/** Counts of the updates at stands up to now. */
IMK_API imk_navigation_filter_counts
imk_navigation_filter_counted(const imk_navigation_filter *filter);
/** The same of aid number `aid` of the settings. */
IMK_API imk_navigation_filter_counts
imk_navigation_filter_aided(const imk_navigation_filter *filter, size_t aid);

IMK_END_C
#endif
