/* SPDX-License-Identifier: Apache-2.0 */
/** @file allan_gaps.h
 *  Allan deviations of a record with missing samples (docs/theory/gaps.md).
 *
 *  Each cluster of m samples is represented by the mean of the samples present; there are n_1 and
 *  n_2 in the two clusters of a pair. A pair is weighted by how full it is:
 *
 *      AVAR(m) = 1/2 sum w (y_2 - y_1)^2 / sum w - (s^2/m) (1/w_mean - 1),
 *      w = (2/m) / (1/n_1 + 1/n_2)
 *
 *  s^2 is the mean variance inside clusters. The mean of n values drawn at random out of m scatters
 *  about the mean of all by (1/n - 1/m) s^2 whatever the values are [COCHRAN1977, (2.11)]: the
 *  subtraction leaves no bias for white noise, quantization, flicker, walks, ramps and lines alike
 *  when samples are missing independently of their values. Pairs that touch a gap too long for this
 *  assumption are left out. For a record without missing samples the result is the overlapping
 *  Allan variance. */
#ifndef IMUKIT_ALLAN_GAPS_H
#define IMUKIT_ALLAN_GAPS_H

#include "imukit/allan.h"

IMK_BEGIN_C

/** One averaging time of a record with gaps. */
typedef struct imk_allan_gap_point {
    imk_allan_point point; /**< as for a complete record; if the gaps leave no pair of clusters, the
                              deviation is NaN and the count 0 */
    double used;           /**< share of the record's pairs of clusters that were used, 0 … 1 */
    double fullness;       /**< mean share of samples present in the clusters used, 0 … 1 */
    double correction;     /**< variance subtracted for the missing samples [unit^2] */
    bool resolved;         /**< false: the subtraction leaves less than half a standard error of the
                              variance; then the variance is set to this half, and the interval begins at 0
                            */
} imk_allan_gap_point;

/** How to evaluate. Start from imk_allan_gaps_default(), then change fields. */
typedef struct imk_allan_gaps_settings {
    uint32_t cookie;
    double confidence; /**< two-sided, of the intervals; default 0.95 */
    bool robust; /**< limit the influence of outliers: samples far from the level around them count
                    as missing, and squares are limited to 6.25 times their mean. The degrees of
                    freedom are then multiplied by 0.96. Default false */
} imk_allan_gaps_settings;

/** 95 % intervals, not robust. */
IMK_API imk_allan_gaps_settings imk_allan_gaps_default(void);

/** Bytes of workspace for n samples (13 n and 64 kB). */
IMK_API size_t imk_allan_gaps_workspace_size(size_t n);

/** Overlapping Allan deviations of rates, some of them missing.
 *  @param rate      n samples on an even grid, NaN (or not finite) where missing; not changed
 *  @param factors   averaging factors, ascending, 1 … n/2
 *  @param points    factor_count values
 *  @param executor  may be NULL; the result does not depend on it
 *  Cost: about 40 ns per sample and factor, three times that when robust; much less when nothing
 *  is missing.
 *  @return IMK_ERROR_UNINITIALISED, IMK_ERROR_RANGE, IMK_ERROR_TOO_SHORT (fewer than two samples
 *          are there), IMK_ERROR_WORKSPACE, IMK_ERROR_NOT_FINITE (squares overflow) */
IMK_API imk_status imk_allan_gaps_points(const imk_allan_gaps_settings *settings, size_t n,
                                         const double *rate, size_t factor_count,
                                         const size_t *factors, imk_allan_gap_point *points,
                                         const imk_executor *executor, void *workspace,
                                         size_t workspace_size);

IMK_END_C
#endif
