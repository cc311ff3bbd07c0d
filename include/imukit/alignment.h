/* SPDX-License-Identifier: Apache-2.0 */
/** @file alignment.h
 *  Self-alignment: the attitude of a unit at a known place, from gravity and the Earth's rotation.
 *
 *  Three methods, which take increments as they come and need constant memory:
 *  - means: the mean force gives the vertical, then the mean rate gives north. For a unit that does
 *    not move at all. To first order, mean errors b of force and c of rate in north-east-down axes
 *    leave an attitude error, in the sense of drift.h, of
 *
 *         north -b_E/g,   east b_N/g,   down b_E tan(L)/g - c_E/(w_ie cos L);
 *
 *  - inertial: in inertial axes carried along by the gyros, gravity turns with the Earth; its
 *    integrals (velocities) give the attitude. The unit may rock and turn, as long as it stays at
 *    its place (or moves at known velocities). All times have equal weight;
 *  - fine: the same velocities, weighted by the sensors' noise, and corrected for the rotation that
 *    the gyros' noise has caused since the start.
 *
 *  Constant errors have the same effect in all three methods: a unit at one place cannot
 *  distinguish a horizontal force bias from a tilt, or an east rate bias from a heading. In the
 *  last two methods the attitude also drifts with the gyro bias during the alignment. So if the
 *  gyro bias exceeds the Earth's rotation and no north is found, means give the better vertical.
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
    imk_geodetic place; /**< of the unit at the start */
    double duration;    /**< planned length of the alignment [s], > 0; more samples are no error */
    /** For weights and the covariance; must exist until the end. Take its known values out of the
     *  samples before (correct.h): the errors are their sigmas, repeatability and noise. NULL:
     *  noise from the scatter of the data, no biases. */
    const imk_model *model;
} imk_alignment_settings;

/** Method inertial, 300 s, at latitude and longitude 0. */
IMK_API imk_alignment_settings imk_alignment_default(void);

/** Result of an alignment. */
typedef struct imk_alignment_result {
    /** State at the end of the last sample, with the last velocity. */
    imk_navigation_state state;
    double roll, pitch, yaw; /**< [rad]; yaw is the azimuth of body x, east of north */
    double covariance[3][3]; /**< of the attitude error about north, east, down [rad^2], for small
                                errors: a heading of sigma above a radian is not known at all.
                                Without a model its sigmas are accurate to a factor of 1.5 */
    double disturbance; /**< rms of the horizontal velocity not caused by gravity, in averages over
                           1/256 of the duration [m/s]; 0 with method means */
    double gravity_ratio; /**< mean force over normal gravity; far from 1: the unit of a column is
                             wrong */
    double earth_rate_ratio; /**< rate at which gravity turns in the unit's inertial axes, over the
                                Earth's rate */
} imk_alignment_result;

/** An alignment in progress: opaque memory of imk_alignment_size() bytes (23 kB), aligned as a
 *  double, given by the caller. */
typedef struct imk_alignment imk_alignment;
/** Bytes for an alignment with these settings. */
IMK_API size_t imk_alignment_size(const imk_alignment_settings *settings);
/** Start an alignment in memory of imk_alignment_size() bytes.
 *  @return IMK_ERROR_UNINITIALISED, _RANGE, _NOT_FINITE, _CONFLICT (within 1 deg of a pole, where
 *          north is not defined), _UNSUPPORTED (a model without gyros or accelerometers, or with
 *          fewer than three of either), _WORKSPACE, and errors of imk_model_validate() */
IMK_API imk_status imk_alignment_start(const imk_alignment_settings *settings,
                                       imk_alignment **alignment, void *memory, size_t memory_size,
                                       imk_error *error);
/** Add one sample: increments of angle [rad] and velocity [m/s] over dt > 0 [s]. Takes about 0.2
 *  us.
 *  @param moving  velocity of the unit relative to the Earth in the middle of the sample,
 *                 north-east-down [m/s]; NULL: at rest; not used by method means */
IMK_API void imk_alignment_add(imk_alignment *alignment, double dt, imk_vector3 angle,
                               imk_vector3 velocity, const imk_vector3 *moving);
/** Compute the attitude at the end of the last sample. More samples may be added afterwards. Takes
 *  about 0.1 ms.
 *  @return IMK_ERROR_TOO_SHORT (less than a second, eight samples, or 1/32 of the duration; method
 *          means: less than 1/4 of the duration without a model, less than a second with one),
 *          IMK_ERROR_SINGULAR (force or rate is zero, they are parallel, or not finite) */
IMK_API imk_status imk_alignment_finish(const imk_alignment *alignment,
                                        imk_alignment_result *result, imk_error *error);

IMK_END_C
#endif
