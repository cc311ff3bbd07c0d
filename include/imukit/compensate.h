/* SPDX-License-Identifier: Apache-2.0 */
/** @file compensate.h
 *  Taking a model's errors out of a stream of samples, with flags for those that cannot be trusted.
 *
 *  Lever arms need the angular acceleration, which a log does not have: it is the central
 * difference of the corrected rates, (w[k+1] - w[k-1])/(2 dt), so the output is one sample late
 * (the first and last sample take the one-sided difference). Its error is at most dt^2/6 max|w'''|
 * plus 0.71/dt times the noise of a rate sample; the specific force errs by that times the lever
 * arm. Models without lever arms have no delay.
 *
 *  No allocation; the loop cannot fail. */
#ifndef IMUKIT_COMPENSATE_H
#define IMUKIT_COMPENSATE_H

#include "imukit/correct.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Flags of a sample. */
enum {
    IMK_FLAG_SATURATED = 1,   /**< an axis at or beyond its range (less half a resolution) */
    IMK_FLAG_TEMPERATURE = 2, /**< outside the valid range of the polynomials: end value used */
    IMK_FLAG_LIMIT = 4,       /**< corrected value beyond the limits the bound is proven for */
    IMK_FLAG_NOT_FINITE = 8   /**< a reading is NaN or infinite: output is NaN */
};

/** A sample of a unit, and of its corrected motion. */
typedef struct imk_compensator_sample {
    double reading[2][IMK_AXES_MAX]; /**< in: physical units or counts, as the model has them */
    double temperature;              /**< in: [K]; NaN: not known */
    double rate[IMK_AXES_MAX];       /**< out: angular rate; body axes, or one per axis (see
                                          imk_correction.solves) [rad/s] */
    double force[IMK_AXES_MAX];      /**< out: specific force, likewise [m/s^2] */
    unsigned flags;                  /**< out */
} imk_compensator_sample;

/** A compensator under way. About 16 kB; plain data. */
typedef struct imk_compensator {
    imk_correction correction;
    double dt;
    bool needs_temperature, needs_acceleration;
    double range[2][IMK_AXES_MAX];
    double temperature_minimum, temperature_maximum;
    double warm_up_time[2];
    uint64_t count;                 /**< samples taken in */
    imk_compensator_sample held[2]; /**< the sample before, and the one before it */
} imk_compensator;

/** Start.
 *  @param dt  sample interval [s]
 *  @return errors of imk_model_validate() and imk_correction_start(); IMK_ERROR_RANGE (dt) */
IMK_API imk_status imk_compensator_start(imk_compensator *compensator, const imk_model *model,
                                         double dt, const imk_correction_settings *settings,
                                         imk_error *error);
/** Samples of delay: 0 or 1. */
IMK_API int imk_compensator_delay(const imk_compensator *compensator);
/** Take a sample in, and give the one `delay` samples before it out.
 *  @return true when `sample` holds an output (false only for the first one with delay 1) */
IMK_API bool imk_compensator_next(imk_compensator *compensator, imk_compensator_sample *sample);
/** At the end: the sample still held, with delay 1. @return false when there is none */
IMK_API bool imk_compensator_finish(imk_compensator *compensator, imk_compensator_sample *sample);

/** A whole record at once, the same values as the stream's. The arrays of `readings` may be the
 *  outputs; its angular_acceleration (if not NULL) is used instead of the difference, warm_up is
 *  ignored (time counts from the first sample).
 *  @param flags  count flags, or NULL */
IMK_API void imk_compensate_record(imk_compensator *compensator, const imk_readings *readings,
                                   size_t count, double *const out[2][IMK_AXES_MAX],
                                   unsigned char *flags, double *workspace);
/** Doubles of workspace for imk_compensate_record(). */
IMK_API size_t imk_compensate_workspace(size_t count);

#ifdef __cplusplus
}
#endif
#endif
