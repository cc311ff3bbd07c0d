/* SPDX-License-Identifier: Apache-2.0 */
/* The record behind Allan variances with missing samples, shared by all averaging factors. */
#ifndef IMUKIT_ALLAN_GAPS_INTERNAL_H
#define IMUKIT_ALLAN_GAPS_INTERNAL_H

#include "imukit/allan_gaps.h"

enum { IMKI_HOLE_CLASSES = 48, IMKI_GAP_LAGS = 128 };

typedef struct imki_gap_record {
    size_t n, present;
    double *sums;         /* n + 1: running sums of what is there, less its mean */
    uint32_t *counts;     /* n + 1: samples there so far */
    unsigned char *holes; /* n: 0 where present, 1 in a hole as short as chance makes them, else
                             2 + floor(log2(length of the hole)) */
    double squares[IMKI_HOLE_CLASSES]; /* sum of the squared lengths of the holes of a class */
    bool long_holes;                   /* there are any beyond class 1 */
    size_t lag_count, lag[IMKI_GAP_LAGS];
    double variogram[IMKI_GAP_LAGS]; /* half the mean square of differences at these lags */
    size_t pairs[IMKI_GAP_LAGS];     /* how many were averaged */
} imki_gap_record;

/* One averaging factor, before the correction is subtracted. */
typedef struct imki_gap_estimate {
    size_t m, count;
    double variance;
    double correction, correction_error; /* for what is missing, and its standard error */
    double share;                        /* of the degrees of freedom of a complete record */
    bool told;                           /* the noise type could be */
    imk_power_law type;
    double used, fullness; /* as of imk_allan_gap_point */
} imki_gap_estimate;

imki_gap_estimate imki_gap_estimate_at(const imki_gap_record *record, bool robust, size_t m);

/* Noise type by the lag-1 autocorrelation of the means of clusters that hold `least` samples, where
 * they are neighbours; false with fewer than 30. */
bool imki_gap_noise_type(const imki_gap_record *record, size_t m, size_t least,
                         imk_power_law *type);

/* allan_gaps_lags.c */
void imki_gap_take_lags(imki_gap_record *record);
/* Factor of the correction by how the samples of a cluster are missing together; `inside` is the
 * variance inside clusters. 1 where they are missing one by one. `error`: its standard error. */
double imki_gap_hole_factor(const imki_gap_record *record, size_t m, size_t least, double inside,
                            double *error);

#endif
