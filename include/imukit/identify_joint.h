/* SPDX-License-Identifier: Apache-2.0 */
/** @file identify_joint.h
 *  Several records: of one sensor, or of several sensors.
 *
 *  Runs of one sensor share their noise parameters, not their bias, ramp and lines. Each record is
 *  identified with a summary of its spectrum kept (imk_identify_settings.summary); the joint
 *  estimate is maximum likelihood on all summaries together, with the selection of terms and the
 *  intervals of one record (docs/theory/several-records.md). Records of different sensors make a
 *  population: a mean and a spread for each parameter. */
#ifndef IMUKIT_IDENTIFY_JOINT_H
#define IMUKIT_IDENTIFY_JOINT_H

#include "imukit/identify.h"

IMK_BEGIN_C

/** Most records of a joint estimate. */
enum { IMK_JOINT_RECORDS_MAX = 24 };

/** Bytes of a summary, about 200 kB. */
IMK_API size_t imk_spectral_summary_size(void);

/** Do the records agree with the joint model? */
typedef struct imk_joint_agreement {
    double chi_square;  /**< twice the likelihood that separate strengths gain over common ones */
    size_t degrees;     /**< common strengths x (records - 1) */
    double probability; /**< of a chi-square as large by chance */
    /** Record and term that differ most (a record of -1: none), and by how many sigmas. */
    int record, term;
    double sigmas;
    /** Strength of each random term in each record alone, the joint model's terms free, and its
     *  sigma; of term IMK_NOISE_RAMP 0. */
    double value[IMK_JOINT_RECORDS_MAX][IMK_NOISE_TERMS];
    double sigma[IMK_JOINT_RECORDS_MAX][IMK_NOISE_TERMS];
} imk_joint_agreement;

/** Bytes of workspace, about 2 MB. */
IMK_API size_t imk_identify_joint_workspace_size(void);

/** Joint estimate of records of one sensor, equally sampled.
 *
 *  Each record's own ramp is taken out before, so a ramp is not part of the joint model. Of the
 *  rounding errors at the ends of quantized records their expectation is taken.
 *  @param settings   those of the single records; shape: look for a filter and resonances
 *  @param count      2 … IMK_JOINT_RECORDS_MAX
 *  @param summaries  as filled by imk_identify_channel() or imk_identify_record_finish()
 *  @param single     results of the records, for their resonances
 *  @param joint      terms, filter, resonances, Gauss-Markov terms; mean: of the means; what
 *                    concerns samples (verdict, tau, lines) is zero
 *  @param agreement  may be NULL
 *  @return IMK_ERROR_ARGUMENT (count), IMK_ERROR_UNINITIALISED (a summary that was not filled),
 *          IMK_ERROR_CONFLICT (sample intervals that differ by more than 1e-3; error.index: the
 *          record), IMK_ERROR_WORKSPACE, IMK_ERROR_NO_CONVERGENCE */
IMK_API imk_status imk_identify_joint(const imk_identify_settings *settings, size_t count,
                                      const imk_spectral_summary *const *summaries,
                                      const imk_identification *single, imk_identification *joint,
                                      imk_joint_agreement *agreement, void *workspace,
                                      size_t workspace_size, imk_error *error);

/** Mean and spread of a quantity over sensors, or over runs. */
typedef struct imk_population {
    double mean, mean_lower, mean_upper;       /**< of the population */
    double spread, spread_lower, spread_upper; /**< standard deviation between the members; upper is
                                                    infinite where nothing bounds it */
    double chi_square;  /**< of the members about a common value, count - 1 degrees */
    double probability; /**< of one as large by chance when there is no spread */
} imk_population;

/** Random-effects estimate from values known to their sigmas: value_i = mean + spread a_i + sigma_i
 *  b_i with normal a, b. The spread by restricted maximum likelihood [VIECHTBAUER2005], its
 *  interval by the generalised Q statistic [VIECHTBAUER2007], that of the mean by Student's t with
 *  count - 1 degrees and the scatter found [KNAPP2003].
 *  @param sigmas  > 0
 *  @return IMK_ERROR_TOO_SHORT (fewer than two), IMK_ERROR_RANGE, IMK_ERROR_NOT_FINITE */
IMK_API imk_status imk_population_estimate(size_t count, const double *values, const double *sigmas,
                                           double confidence, imk_population *population);

IMK_END_C
#endif
