/* SPDX-License-Identifier: Apache-2.0 */
/** @file alignment.h
 *  Self-alignment: the attitude of a unit at a known place, from gravity and the Earth's rotation.
 *
 *  Three ways, from increments as they come, in constant memory:
 *   - means: the means of force and rate over the time give the vertical (first) and north. For a
 *     unit that does not move at all. To first order, mean errors b of force and c of rate in
 *     north-east-down axes leave an attitude error, in the sense of drift.h, of
 *
 *         north -b_E/g,   east b_N/g,   down b_E tan(L)/g - c_E/(w_ie cos L);
 *
 *   - inertial: gravity seen from the unit's own inertial axes turns with the Earth; the velocities
 *     it makes give the attitude, while the unit may rock and turn as it likes, as long as it stays
 *     where it is (or moves by known velocities). All times weigh alike;
 *   - fine: the same velocities, weighed as likely as the sensors' noise makes them, and what the
 *     gyros' noise has turned the attitude by since the start taken off.
 *
 *  Constant errors do to the other two what they do to means: nothing that one unit sees at one
 *  place tells a level bias from a tilt or a bias to the east from a heading. And the attitude they
 *  carry along turns with the gyros' bias meanwhile, that of means does not: with gyros worse than
 *  the Earth's rotation, which find no north, means give the better vertical.
 *  Equations: docs/theory/alignment.md. */
#ifndef IMUKIT_ALIGNMENT_H
#define IMUKIT_ALIGNMENT_H

#include "imukit/model.h"
#include "imukit/navigate.h"

IMK_BEGIN_C

typedef enum imk_alignment_method {
    IMK_ALIGNMENT_MEANS = 0,
    IMK_ALIGNMENT_INERTIAL,
    IMK_ALIGNMENT_FINE
} imk_alignment_method;

/** Start from imk_alignment_default(). */
typedef struct imk_alignment_settings {
    uint32_t cookie;
    imk_alignment_method method;
    imk_geodetic place;     /**< of the unit at the start */
    double duration;        /**< how long it will be fed [s], > 0; more is no error */
    const imk_model *model; /**< for weights and the covariance; kept until the end. Values it knows
                                 are to be taken out of the samples before (correct.h): errors are
                                 their sigmas, repeatability and noise. NULL: noise from the scatter
                                 of the data, no biases */
} imk_alignment_settings;

/** Inertial, 300 s, at latitude and longitude 0. */
IMK_API imk_alignment_settings imk_alignment_default(void);

/** What was found. */
typedef struct imk_alignment_result {
    /** at the end of the time: where it is by then, as it last moved */
    imk_navigation_state state;
    double roll, pitch, yaw; /**< [rad]; yaw is the azimuth of body x, east of north */
    double covariance[3][3]; /**< of the attitude error about north, east, down [rad^2], for small
                                  errors: a heading of sigma above a radian is not known at all.
                                  Without a model good to a factor of 1.5 in sigma */
    double disturbance;      /**< rms of the horizontal velocity that is not gravity's, in means
                                  over a 256th of the duration [m/s]; means: 0 */
    double gravity_ratio;    /**< mean force found over normal gravity: far from 1, a unit is
                                  wrong */
    double earth_rate_ratio; /**< the same of the rotation: how fast gravity turns in the unit's
                                  inertial axes */
} imk_alignment_result;

/** An alignment under way: opaque memory of imk_alignment_size() bytes (23 kB), aligned as a
 * double, given by the caller. */
typedef struct imk_alignment imk_alignment;
/** Bytes for an alignment with these settings. */
IMK_API size_t imk_alignment_size(const imk_alignment_settings *settings);
/** @return IMK_ERROR_UNINITIALISED, _RANGE, _NOT_FINITE, _CONFLICT (within 1 deg of a pole: no
 *          north there), _UNSUPPORTED (a model without gyros or accelerometers, or with fewer than
 *          three of either), _WORKSPACE, and those of imk_model_validate() */
IMK_API imk_status imk_alignment_start(const imk_alignment_settings *settings,
                                       imk_alignment **alignment, void *memory, size_t memory_size,
                                       imk_error *error);
/** One sample: increments of angle [rad] and velocity [m/s] over dt > 0 [s], and the velocity of
 *  the unit relative to the Earth, north-east-down, in its middle (NULL: it stays; means: it does
 *  not count). About 0.2 us. */
IMK_API void imk_alignment_add(imk_alignment *alignment, double dt, imk_vector3 angle,
                               imk_vector3 velocity, const imk_vector3 *moving);
/** The attitude at the end of the last sample. More may be added after. About 0.1 ms.
 *  @return IMK_ERROR_TOO_SHORT (less than a second, than eight samples, or than a 32nd of the
 *          duration; means: without a model than a quarter, with one only the first),
 *          IMK_ERROR_SINGULAR (force or rate is missing, or they are parallel; not finite) */
IMK_API imk_status imk_alignment_finish(const imk_alignment *alignment,
                                        imk_alignment_result *result, imk_error *error);

IMK_END_C
#endif
