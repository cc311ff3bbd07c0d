/* SPDX-License-Identifier: Apache-2.0 */
/** @file identify_joint.h
 *  Joint estimates from several records of one sensor, and populations of several sensors.
 *
 *  Runs of one sensor have the same noise parameters but different bias, ramp and lines. Each
 *  record is identified with a summary of its spectrum kept (imk_identify_settings.summary); the
 *  joint estimate is maximum likelihood on all summaries together, with the selection of terms and
 *  the intervals of one record (docs/theory/several-records.md). Records of different sensors make
 *  a population: each parameter has a mean and a spread. Records of one sensor at several rates
 *  part what its readings have at every rate from what they have less of at a lower one. */
#ifndef IMUKIT_IDENTIFY_JOINT_H
#define IMUKIT_IDENTIFY_JOINT_H

#include "imukit/identify.h"

IMK_BEGIN_C

/** Largest number of records in a joint estimate. */
enum { IMK_JOINT_RECORDS_MAX = 24 };

/** Bytes of a summary, about 200 kB. */
IMK_API size_t imk_spectral_summary_size(void);

/** How well the records agree with the joint model. */
typedef struct imk_joint_agreement {
    /** Twice the gain in log-likelihood when each record has its own strengths. */
    double chi_square;
    size_t degrees;     /**< number of common strengths x (records - 1) */
    double probability; /**< probability of a chi-square this large by chance */
    /** Record (from 0; -1: none) and term that differ most, and by how many sigmas. */
    int record, term;
    double sigmas;
    /** Strength of each random term in each record alone, with all terms of the joint model free,
     *  and its 1 sigma; 0 for IMK_NOISE_RAMP. */
    double value[IMK_JOINT_RECORDS_MAX][IMK_NOISE_TERMS];
    double sigma[IMK_JOINT_RECORDS_MAX][IMK_NOISE_TERMS];
} imk_joint_agreement;

/** Bytes of workspace, about 2 MB. */
IMK_API size_t imk_identify_joint_workspace_size(void);

/** Joint estimate of records of one sensor, equally sampled.
 *
 *  Each record's own ramp is taken out before, so a ramp is not part of the joint model. The
 *  rounding errors at the ends of quantized records are replaced by their expectation.
 *  @param settings   as for the single records; `shape`: look for a filter and resonances
 *  @param count      2 … IMK_JOINT_RECORDS_MAX
 *  @param summaries  as filled by imk_identify_channel() or imk_identify_record_finish()
 *  @param single     results of the records; their resonances are used
 *  @param joint      receives terms, filter, resonances and Gauss-Markov terms; `mean` is the mean
 *                    of the records' means; fields about samples (verdict, tau, lines) are zero
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
    double mean, mean_lower, mean_upper;       /**< mean of the population, and its interval */
    double spread, spread_lower, spread_upper; /**< standard deviation between the members; upper is
                                                    infinite where nothing bounds it */
    /** Of the members about a common value, with count - 1 degrees of freedom. */
    double chi_square;
    /** Probability of a chi-square this large by chance if there is no spread. */
    double probability;
} imk_population;

/** Random-effects estimate from values with known sigmas: value_i = mean + spread a_i + sigma_i b_i
 *  with a, b standard normal. The spread is found by restricted maximum likelihood
 *  [VIECHTBAUER2005], its interval by the generalised Q statistic [VIECHTBAUER2007], and the
 *  interval of the mean by Student's t with count - 1 degrees of freedom and the scatter found
 *  [KNAPP2003].
 *  @param sigmas      1 sigma of each value, > 0
 *  @param confidence  two-sided, of the intervals
 *  @return IMK_ERROR_TOO_SHORT (fewer than two values), IMK_ERROR_RANGE, IMK_ERROR_NOT_FINITE */
IMK_API imk_status imk_population_estimate(size_t count, const double *values, const double *sigmas,
                                           double confidence, imk_population *population);

/** What explains the errors of the readings of the integral at several rates. */
typedef enum imk_reading_kind {
    IMK_READING_UNTOLD = 0, /**< either of the two alone */
    IMK_READING_ALIKE,      /**< reading noise, the same at each rate */
    IMK_READING_WHITE,      /**< white noise of the integral */
    IMK_READING_BOTH        /**< only both together */
} imk_reading_kind;

/** Reading noise r and white noise of the integral A, which add up to r^2 + A^2/dt. */
typedef struct imk_reading_parts {
    size_t count; /**< readings compared; 0: not compared */
    imk_reading_kind kind;
    imk_estimate reading_noise, angle_white; /**< [unit s], [unit s/sqrt(Hz)]; neither is present
                                                where the kind is not told */
    double chi_square;                       /**< of the readings about what explains them */
    size_t degrees;     /**< its degrees of freedom: the readings less what is present, or one */
    double probability; /**< of a chi-square this large by chance */
} imk_reading_parts;

/** Part the squares of readings at several rates by weighted least squares in which neither r^2 nor
 *  A^2 is negative. One of them is left out if the others explain the readings as well; intervals
 *  are by profile, with the other one free, and hold the value without it, too.
 *  @param dt           sample intervals [s]
 *  @param squares      of 1 sigma of the readings [(unit s)^2]
 *  @param sigmas       1 sigma of each square, > 0
 *  @param confidence   of the intervals
 *  @param significance chance that what is absent is called present
 *  @return IMK_ERROR_TOO_SHORT (fewer than two intervals that differ by 1e-3), IMK_ERROR_RANGE,
 *          IMK_ERROR_NOT_FINITE */
IMK_API imk_status imk_reading_parts_estimate(size_t count, const double *dt, const double *squares,
                                              const double *sigmas, double confidence,
                                              double significance, imk_reading_parts *parts);

/** Put them into one axis of a model, in place of what one record alone makes of them
 *  (imk_identification_store()), if the kind is told. */
IMK_API void imk_reading_parts_store(const imk_reading_parts *parts, imk_model *model, int sensor,
                                     int axis);

IMK_END_C
#endif
