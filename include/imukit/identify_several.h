/* SPDX-License-Identifier: Apache-2.0 */
/** @file identify_several.h
 *  The jobs of `imukit identify --runs` and `--devices`: records of one sensor make one joint
 *  estimate, records of different sensors make a population.
 *
 *  Each record must be identified alone before (identify_log.h); its samples are not needed after
 *  that. */
#ifndef IMUKIT_IDENTIFY_SEVERAL_H
#define IMUKIT_IDENTIFY_SEVERAL_H

#include "imukit/identify_log.h"
#include "imukit/repeatability.h"

IMK_BEGIN_C

/** Strength of a term in one record. Its square and the sigma of the square are known even if the
 *  term is absent. */
typedef struct imk_device_strength {
    bool present;
    double value, sigma, bound; /**< bound: upper bound, if the term is absent */
    double square, square_sigma;
} imk_device_strength;

/** One term of one channel over all devices. */
typedef struct imk_device_term {
    bool compared;             /**< some devices show the term, and all state its square */
    imk_population squares;    /**< population of the squares of the strengths */
    double mean, lower, upper; /**< root of the mean square, and of the ends of its interval */
    double spread, spread_lower, spread_upper; /**< spread of the strength, to first order */
    bool differs;     /**< the devices differ; over all comparisons together the chance of a false
                         statement is at most 1 - confidence */
    size_t low, high; /**< the two devices farthest apart */
    double sigmas;    /**< their difference, in sigmas */
    imk_device_strength device[IMK_JOINT_RECORDS_MAX];
} imk_device_term;

/** Result of both jobs. */
typedef struct imk_identify_several {
    bool runs; /**< true: runs of one sensor; false: different sensors */
    size_t count;
    /** Logs compared; they belong to the caller. */
    const imk_identify_log *log[IMK_JOINT_RECORDS_MAX];
    /** Channels of the first record, number of rows of the longest, total duration of all. For runs
     *  also the joint estimate and the pooled Allan deviations. */
    imk_identify_log joint;
    /** @name For runs: per channel
     *  @{ */
    imk_joint_agreement agreement[IMK_LOG_COLUMNS_MAX];
    bool differs[IMK_LOG_COLUMNS_MAX]; /**< the noise differs between runs (false alarm: 1 % over
                                          all channels) */
    /** Of the mean, from run to run: on top of the noise that the joint model states, whose slow
     *  flicker differs from run to run by itself. */
    imk_repeatability bias[IMK_LOG_COLUMNS_MAX];
    /** @} */
    /** @name For runs at several rates
     *  The joint estimate is that of the longest record; joint.readings are these. There are no
     *  agreement and no bias; differs[] says that nothing explains the readings at these rates, and
     *  then the kind is untold.
     *  @{ */
    bool rates;
    size_t longest; /**< from 0 */
    imk_reading_parts readings[IMK_LOG_COLUMNS_MAX];
    /** @} */
    /** @name For devices
     *  @{ */
    size_t compared_count, differing_count; /**< numbers of parameters */
    imk_device_term term[IMK_LOG_COLUMNS_MAX][IMK_NOISE_RAMP];
    /** @} */
} imk_identify_several;

/** Check that a record can be compared with the first one.
 *  @param runs  true: both are runs of one sensor
 *  @return IMK_ERROR_CONFLICT when the channels differ (error.field "channels") or, for runs, the
 *          sampling rate ("rate") */
IMK_API imk_status imk_identify_comparable(const imk_identify_log *first,
                                           const imk_identify_log *other, bool runs,
                                           imk_error *error);

/** Runs of one sensor: a joint estimate of each channel, whether the runs agree with it, and how
 *  much the mean differs from run to run.
 *
 *  Runs at several rates have no joint estimate. If the readings of the integral of a channel have
 *  errors at two rates at least, and none are counted, they are parted
 *  (imk_reading_parts_estimate()); else the rates are refused.
 *  @param count   2 … IMK_JOINT_RECORDS_MAX
 *  @param logs    results of imk_identify_log_run(), all with the same settings and with
 *                 settings.summarise
 *  @param result  free it with imk_identify_several_free(); NULL after a failure
 *  @return errors of imk_identify_comparable() (error.index: the record), imk_identify_joint() and
 *          imk_repeatability_estimate() (error.field: the channel), IMK_ERROR_MEMORY;
 *          IMK_ERROR_CONFLICT also when the readings of a record are those of another one
 *          (error.field "readings", error.index the record, error.value the other one, from 0) */
IMK_API imk_status imk_identify_runs(size_t count, const imk_identify_log *const *logs,
                                     const imk_job *job, imk_identify_several **result,
                                     imk_error *error);

/** Different sensors: mean and spread of each term over the sensors, and which sensors differ.
 *  Squares (N^2 and so on) are compared: they are nearly normal and known even if a term is absent,
 *  so a sensor without a term counts as one with little of it.
 *  @param count,logs,result  as for imk_identify_runs()
 *  @return errors of imk_identify_comparable(), IMK_ERROR_MEMORY, and that of the same readings */
IMK_API imk_status imk_identify_devices(size_t count, const imk_identify_log *const *logs,
                                        const imk_job *job, imk_identify_several **result,
                                        imk_error *error);

/** Free it and all it holds; NULL is allowed. */
IMK_API void imk_identify_several_free(imk_identify_several *result);

IMK_END_C
#endif
