/* SPDX-License-Identifier: Apache-2.0 */
/** @file identify_several.h
 *  The jobs of `imukit identify --runs` and `--devices`: records of one sensor make one joint
 *  estimate, those of different sensors a population.
 *
 *  Each record is identified alone before (identify_log.h); its samples are not needed any more. */
#ifndef IMUKIT_IDENTIFY_SEVERAL_H
#define IMUKIT_IDENTIFY_SEVERAL_H

#include "imukit/identify_log.h"
#include "imukit/repeatability.h"

IMK_BEGIN_C

/** A strength of one record; its square and the sigma of that are known also where the term is
 *  absent. */
typedef struct imk_device_strength {
    bool present;
    double value, sigma, bound;
    double square, square_sigma;
} imk_device_strength;

/** One term of one channel over all devices. */
typedef struct imk_device_term {
    bool compared;                             /**< some show it, and all state its square */
    imk_population squares;                    /**< of the squares */
    double mean, lower, upper;                 /**< roots of the mean square and of its interval */
    double spread, spread_lower, spread_upper; /**< of the value, to first order */
    bool differs;     /**< all comparisons together say so by chance with 1 - confidence at most */
    size_t low, high; /**< the two devices farthest apart */
    double sigmas;    /**< between them */
    imk_device_strength device[IMK_JOINT_RECORDS_MAX];
} imk_device_term;

/** What was found. */
typedef struct imk_identify_several {
    bool runs; /**< of one sensor; false: of different ones */
    size_t count;
    const imk_identify_log *log[IMK_JOINT_RECORDS_MAX]; /**< the caller's */
    /** The channels of the first record, the rows of the longest, the time of all. Of runs: the
     *  joint estimate, and their Allan deviations pooled. */
    imk_identify_log joint;
    /** @name Of each channel, of runs
     *  @{ */
    imk_joint_agreement agreement[IMK_LOG_COLUMNS_MAX];
    bool differs[IMK_LOG_COLUMNS_MAX];           /**< not the same noise; 1 % of all by chance */
    imk_repeatability bias[IMK_LOG_COLUMNS_MAX]; /**< of the means, from run to run */
    /** @} */
    /** @name Of devices
     *  @{ */
    size_t compared_count, differing_count; /**< parameters */
    imk_device_term term[IMK_LOG_COLUMNS_MAX][IMK_NOISE_RAMP];
    /** @} */
} imk_identify_several;

/** May a record be compared with the first?
 *  @return IMK_ERROR_CONFLICT: it has other channels (error.field "channels"), or, as a run,
 *          another sample rate ("rate") */
IMK_API imk_status imk_identify_comparable(const imk_identify_log *first,
                                           const imk_identify_log *other, bool runs,
                                           imk_error *error);

/** Runs of one sensor: a joint estimate of each channel, whether the runs agree with it, and how
 *  much the mean differs from run to run.
 *  @param count   2 … IMK_JOINT_RECORDS_MAX
 *  @param logs    identified with settings.summarise, all with the same settings
 *  @param result  free it with imk_identify_several_free(); NULL after a failure
 *  @return as imk_identify_comparable() (error.index: the record), imk_identify_joint() and
 *          imk_repeatability_estimate() (error.field: the channel), IMK_ERROR_MEMORY */
IMK_API imk_status imk_identify_runs(size_t count, const imk_identify_log *const *logs,
                                     const imk_job *job, imk_identify_several **result,
                                     imk_error *error);

/** Different sensors: mean and spread of each term over them, and which of them differ. Squares
 *  are compared, N^2 and so on: they are nearly normal and known also where a term is absent, so
 *  that a sensor without a term counts as one that has little of it.
 *  @return as imk_identify_comparable(), IMK_ERROR_MEMORY */
IMK_API imk_status imk_identify_devices(size_t count, const imk_identify_log *const *logs,
                                        const imk_job *job, imk_identify_several **result,
                                        imk_error *error);

/** Free it and all it holds; NULL is allowed. */
IMK_API void imk_identify_several_free(imk_identify_several *result);

IMK_END_C
#endif
