/* SPDX-License-Identifier: Apache-2.0 */
/** @file compensate.h
 *  Compensation: takes a model's errors out of a stream of samples, and flags samples that cannot
 *  be trusted.
 *
 *  Lever arms need the angular acceleration, which a log does not contain. It is computed as the
 *  central difference of the corrected rates, (w[k+1] - w[k-1])/(2 dt), so the output is one sample
 *  late. The first and last sample, and those beside a sample that is not finite, use the one-sided
 *  difference. The error of the angular acceleration is at most dt^2/6 max|w'''| plus 0.71/dt times
 *  the noise of a rate sample (one-sided: dt/2 max|w''| and 1.41/dt); the error of the specific
 *  force is that times the lever arm. The differentiated rates are corrected without the angular
 *  acceleration, so its effect through g-sensitivity is missing: this adds about |g-sensitivity|
 *  |lever arm|^2 max|w''| to the error of the force. Models without lever arms have no delay.
 *
 *  The rate of temperature, where a model needs it, is the slope from sample to sample smoothed
 *  over a time tau, which is exact for a steady slope: rate[k] = rate[k-1] + (1 - e^(-dt/tau))
 *  ((T[k] - T[k-1])/dt - rate[k-1]). It starts at zero and takes a few tau to settle. A temperature
 *  that is NaN is replaced by the last known one. Warm-up is computed for the middle of the
 *  interval that ends at a sample's time, as a sample is the mean over it.
 *
 *  No allocation; the loop cannot fail. Streams, blocks and whole records give the same bits. */
#ifndef IMUKIT_COMPENSATE_H
#define IMUKIT_COMPENSATE_H

#include "imukit/correct.h"

IMK_BEGIN_C

/** Flags of a sample. */
enum {
    IMK_FLAG_SATURATED =
        1, /**< an axis reaches its range, less what the output stage may subtract from a saturated
              reading: half a resolution, half a count, one step of a quantized integral */
    IMK_FLAG_TEMPERATURE = 2, /**< the temperature is outside the valid range of the polynomials:
                                 their end value is used */
    IMK_FLAG_LIMIT = 4, /**< a corrected value is beyond imk_correction.limit, so the bound on its
                           error is not proven (terms that are not linear) */
    IMK_FLAG_NOT_FINITE = 8, /**< a reading is NaN or infinite, or the temperature was never known:
                                  the outputs that depend on it are NaN */
    IMK_FLAG_ACCELERATION =
        16 /**< the angular acceleration, which lever arms need, comes from a saturated rate, or is
              taken as zero because no neighbour is finite */
};
/** Number of different flags. */
enum { IMK_FLAG_COUNT = 5 };

/** Readings of a sample (in), and the corrected rate and force (out). */
typedef struct imk_compensator_sample {
    double reading[2][IMK_AXES_MAX]; /**< in: counts if the model has a sensitivity, else SI */
    double temperature;              /**< in: [K]; NaN: not known */
    double rate[IMK_AXES_MAX];       /**< out: angular rate; body axes, or one per axis (see
                                          imk_correction.solves) [rad/s] */
    double force[IMK_AXES_MAX];      /**< out: specific force, in the same form [m/s^2] */
    unsigned flags;                  /**< out */
} imk_compensator_sample;

/** A compensator under way. About 13 kB; plain data. */
typedef struct imk_compensator {
    imk_correction correction;
    double dt;
    bool needs_temperature, needs_acceleration, needs_temperature_rate;
    bool uses_temperature[2]; /**< gyros, accelerometers */
    bool limited[2];          /**< imk_correction.limit applies */
    bool depends_on_other[2]; /**< rates depend on readings of accelerometers; forces on those of
                                 gyros */
    /** Level from which a reading counts as saturated; or infinity. */
    double range[2][IMK_AXES_MAX];
    double temperature_minimum, temperature_maximum;
    double warm_up_time[2];  /**< [s]; 0: no warm-up */
    double temperature_time; /**< tau of the rate of temperature [s], default 30 s; may be changed
                                  before the first sample */
    double start_time;       /**< time of the first counted sample since power-on [s] */
    uint64_t count;          /**< number of samples taken in since start_time */
    double temperature, temperature_rate; /**< last known; NaN before the first */
    double temperature_interval;          /**< time from the sample before to the next one [s] */
    bool holds; /**< a sample is held until the rates of the next one are known */
    imk_compensator_sample held[2]; /**< the sample before, and the one before it */
    double held_temperature_rate, held_warm_up[2];
    uint32_t held_marks[2];
} imk_compensator;

/** Start a compensator for a model.
 *  @param dt        sample interval [s]
 *  @param settings  NULL: imk_correction_default()
 *  @return errors of imk_model_validate() and imk_correction_start(); IMK_ERROR_RANGE (dt) */
IMK_API imk_status imk_compensator_start(imk_compensator *compensator, const imk_model *model,
                                         double dt, const imk_correction_settings *settings,
                                         imk_error *error);
/** Delay of the output: 0 or 1 sample. */
IMK_API int imk_compensator_delay(const imk_compensator *compensator);
/** Components of the output of gyros (IMK_GYRO) or accelerometers: 3, or the number of axes. */
IMK_API int imk_compensator_components(const imk_compensator *compensator, int sensor);
/** Take a sample in, and give out the sample that is `delay` samples earlier.
 *  @return true when `sample` holds an output (false only for the first one with delay 1) */
IMK_API bool imk_compensator_next(imk_compensator *compensator, imk_compensator_sample *sample);
/** Give out the sample that is still held with delay 1: call it at the end and at each gap in time.
 *  A new stretch begins afterwards; no difference is formed across the gap.
 *  @return false when no sample is held */
IMK_API bool imk_compensator_finish(imk_compensator *compensator, imk_compensator_sample *sample);
/** State that the next sample is `time` seconds after power-on. Call it before the first sample of
 *  a unit that was already on, and after a gap (after imk_compensator_finish()). Only warm-up and
 *  rate of temperature depend on it. */
IMK_API void imk_compensator_resume(imk_compensator *compensator, double time);

/** Compensate the next `count` samples of a stream, with the same values as imk_compensator_next().
 *  The outputs follow one another in `out`; the first is `delay` samples before the first reading.
 *  The arrays of `readings` may be the outputs. readings->warm_up is ignored (time counts from the
 *  first sample). readings->temperature_rate and angular_acceleration, if not NULL, are used
 *  instead of differences; with angular_acceleration there is no delay.
 *  @param out    imk_compensator_components() arrays for each kind of sensor; NULL: not wanted
 *  @param flags  NULL: not wanted
 *  @return number of outputs: count, or one less at the beginning of a stretch with delay 1; 0 when
 *          the workspace is too small */
IMK_API size_t imk_compensator_block(imk_compensator *compensator, const imk_readings *readings,
                                     size_t count, double *out[2][IMK_AXES_MAX],
                                     unsigned char *flags, void *workspace, size_t workspace_size);

/** Compensate a whole record at once: imk_compensator_block(), then the sample still held.
 *  @param flags  `count` flags; NULL: not wanted
 *  @return IMK_ERROR_WORKSPACE */
IMK_API imk_status imk_compensate_record(imk_compensator *compensator, const imk_readings *readings,
                                         size_t count, double *out[2][IMK_AXES_MAX],
                                         unsigned char *flags, void *workspace,
                                         size_t workspace_size);
/** Bytes of workspace for blocks and records of `count` samples; at most about 96 000. */
IMK_API size_t imk_compensate_workspace_size(size_t count);

IMK_END_C
#endif
