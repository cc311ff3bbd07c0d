/* SPDX-License-Identifier: Apache-2.0 */
/** @file compensate.h
 *  Taking a model's errors out of a stream of samples, with flags for those that cannot be trusted.
 *
 *  Lever arms need the angular acceleration, which a log does not have: it is the central
 *  difference of the corrected rates, (w[k+1] - w[k-1])/(2 dt), so the output is one sample late
 *  (the first and last sample, and those beside one that is not finite, take the one-sided
 *  difference). Its error is at most dt^2/6 max|w'''| plus 0.71/dt times the noise of a rate
 *  sample (one-sided: dt/2 max|w''| and 1.41/dt); the specific force errs by that times the lever
 *  arm. The rates differentiated are those corrected without it, which leaves out what it does to
 *  them through g-sensitivity: the force errs by about |g-sensitivity| |lever arm|^2 max|w''|
 *  more. Models without lever arms have no delay.
 *
 *  The rate of temperature, where a model needs it, is the slope from sample to sample smoothed
 *  over a time tau, which is exact for a steady slope: rate[k] = rate[k-1] + (1 - e^(-dt/tau))
 *  ((T[k] - T[k-1])/dt - rate[k-1]). It starts at zero and takes a few tau to settle. A
 *  temperature that is NaN stands for the last one that was known. Warm-up is that of the middle of
 *  the interval that ends at a sample's time, of which the sample is the mean.
 *
 *  No allocation; the loop cannot fail. Streams, blocks and whole records give the same bits. */
#ifndef IMUKIT_COMPENSATE_H
#define IMUKIT_COMPENSATE_H

#include "imukit/correct.h"

IMK_BEGIN_C

/** Flags of a sample. */
enum {
    IMK_FLAG_SATURATED = 1,   /**< an axis at or beyond its range, less what its output stage may
                                   take from a saturated reading: half a resolution, half a count,
                                   one step of a quantized integral */
    IMK_FLAG_TEMPERATURE = 2, /**< outside the valid range of the polynomials: end value used */
    IMK_FLAG_LIMIT = 4, /**< corrected value beyond imk_correction.limit, for which the bound is
                             proven (where terms are not linear) */
    IMK_FLAG_NOT_FINITE = 8, /**< a reading is NaN or infinite, or the temperature was never known:
                                  the outputs that depend on it are NaN */
    IMK_FLAG_ACCELERATION = 16 /**< lever arms: the angular acceleration comes from a saturated
                                    rate, or is taken as zero because no neighbour is finite */
};
/** Number of different flags: 1, 2, 4 and so on. */
enum { IMK_FLAG_COUNT = 5 };

/** A sample of a unit, and of its corrected motion. */
typedef struct imk_compensator_sample {
    double reading[2][IMK_AXES_MAX]; /**< in: physical units or counts, as the model has them */
    double temperature;              /**< in: [K]; NaN: not known */
    double rate[IMK_AXES_MAX];       /**< out: angular rate; body axes, or one per axis (see
                                          imk_correction.solves) [rad/s] */
    double force[IMK_AXES_MAX];      /**< out: specific force, likewise [m/s^2] */
    unsigned flags;                  /**< out */
} imk_compensator_sample;

/** A compensator under way. About 13 kB; plain data. */
typedef struct imk_compensator {
    imk_correction correction;
    double dt;
    bool needs_temperature, needs_acceleration, needs_temperature_rate;
    bool uses_temperature[2];      /**< gyros, accelerometers */
    bool limited[2];               /**< imk_correction.limit means something */
    bool depends_on_other[2];      /**< rates on readings of accelerometers; forces on gyros' */
    double range[2][IMK_AXES_MAX]; /**< from which a reading counts as saturated; or infinity */
    double temperature_minimum, temperature_maximum;
    double warm_up_time[2];  /**< [s]; 0: no warm-up */
    double temperature_time; /**< tau of the rate of temperature [s], default 30 s; may be changed
                                  before the first sample */
    double start_time;       /**< since power-on, of the first of the samples counted [s] */
    uint64_t count;          /**< samples taken in */
    double temperature, temperature_rate; /**< last known; NaN before the first */
    double temperature_interval;          /**< from the sample before to the next one [s] */
    bool holds;                           /**< a sample waits for the next one's rates */
    imk_compensator_sample held[2];       /**< the sample before, and the one before it */
    double held_temperature_rate, held_warm_up[2];
    uint32_t held_marks[2];
} imk_compensator;

/** Start.
 *  @param dt        sample interval [s]
 *  @param settings  NULL: imk_correction_default()
 *  @return errors of imk_model_validate() and imk_correction_start(); IMK_ERROR_RANGE (dt) */
IMK_API imk_status imk_compensator_start(imk_compensator *compensator, const imk_model *model,
                                         double dt, const imk_correction_settings *settings,
                                         imk_error *error);
/** Samples of delay: 0 or 1. */
IMK_API int imk_compensator_delay(const imk_compensator *compensator);
/** Components of the output of gyros (IMK_GYRO) or accelerometers: 3, or the number of axes. */
IMK_API int imk_compensator_components(const imk_compensator *compensator, int sensor);
/** Take a sample in, and give the one `delay` samples before it out.
 *  @return true when `sample` holds an output (false only for the first one with delay 1) */
IMK_API bool imk_compensator_next(imk_compensator *compensator, imk_compensator_sample *sample);
/** At the end, and at a gap in time: the sample still held, with delay 1. What follows is a new
 *  stretch, over whose beginning no difference is formed. @return false when there is none */
IMK_API bool imk_compensator_finish(imk_compensator *compensator, imk_compensator_sample *sample);
/** The next sample is `time` seconds after power-on: before the first sample of a unit that was on
 *  already, and after a gap (when imk_compensator_finish() has given what was held). Only warm-up
 *  and rate of temperature depend on it. */
IMK_API void imk_compensator_resume(imk_compensator *compensator, double time);

/** The next `count` samples of a stream: the same values as of imk_compensator_next(). The outputs
 *  follow one another in `out`, beginning with the one `delay` samples before the first reading.
 *  The arrays of `readings` may be the outputs. Of `readings`, warm_up is ignored (time counts from
 *  the first sample), and temperature_rate and angular_acceleration, if not NULL, are used instead
 *  of the differences; with the latter there is no delay.
 *  @param out        imk_compensator_components() arrays each, NULL where not wanted
 *  @param flags      NULL: not wanted
 *  @return number of outputs: count, or one less at the beginning of a stretch with delay 1; 0 when
 *          the workspace is too small */
IMK_API size_t imk_compensator_block(imk_compensator *compensator, const imk_readings *readings,
                                     size_t count, double *out[2][IMK_AXES_MAX],
                                     unsigned char *flags, void *workspace, size_t workspace_size);

/** A whole record at once, from its first sample to its last: imk_compensator_block() and what is
 *  held after it. @param flags  count flags, or NULL. @return IMK_ERROR_WORKSPACE */
IMK_API imk_status imk_compensate_record(imk_compensator *compensator, const imk_readings *readings,
                                         size_t count, double *out[2][IMK_AXES_MAX],
                                         unsigned char *flags, void *workspace,
                                         size_t workspace_size);
/** Bytes of workspace for blocks and records of `count` samples; at most about 96 000. */
IMK_API size_t imk_compensate_workspace_size(size_t count);

IMK_END_C
#endif
