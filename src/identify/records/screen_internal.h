/* SPDX-License-Identifier: Apache-2.0 */
/* Parts of the screening of one channel. Samples that are not finite are missing: every function
 * skips them. */
#ifndef IMUKIT_SCREEN_INTERNAL_H
#define IMUKIT_SCREEN_INTERNAL_H

#include "base/sort_internal.h"
#include "imukit/record_screen.h"

#include <stdint.h>

static inline bool imki_is_there(double value)
{
    return value - value == 0;
}

/* Eight samples times a sign are all below a limit: none is missing, and none at the limit. */
enum { IMKI_EIGHT = 8 };
static inline bool imki_eight_below(const double *value, double sign, double limit)
{
    uint64_t below = 0; /* a sum has no branch, and becomes vectors */
    for (size_t l = 0; l < IMKI_EIGHT; l++)
        below += sign * value[l] < limit;
    return below == IMKI_EIGHT;
}

/* record_checks.c */
/* Smallest step between different values in a sample of the record, when the values lie on a grid
 * of that step; else 0. */
double imki_record_resolution(size_t n, const double *samples, double *scratch,
                              size_t scratch_count);
/* True when samples pile up at this extreme value (toward: the inside, -1 or 1). */
bool imki_record_sticks(size_t n, const double *samples, double extreme, double toward,
                        double step);

/* coarse_ranges.c */
enum { IMKI_BLOCK = 32 }; /* samples whose range and variance are looked at */
/* Highest less lowest of IMKI_BLOCK samples. */
double imki_block_range(const double *value);
/* The step of ranges or distances, in order; where half of them are zero there is one even if it
 * was not seen: the smallest that is not. */
double imki_coarse_step(size_t count, const double *sorted, double resolution);
/* Median of multiples of a step: between the edges of its cell, in proportion. (Rounding to steps
 * would else make it zero, or far too small.) */
double imki_median_on_steps(size_t count, const double *sorted, double step);

/* record_verdict.c: of a whole record. */
unsigned imki_record_verdict(size_t n, const double *samples, double resolution, double deviation);

/* screen_outliers.c */
typedef struct imki_outlier_rule {
    double threshold; /* distance from the median of the 31 samples around */
    double noise;     /* standard deviation of these distances, by their median */
} imki_outlier_rule;
/* From up to scratch_count samples spread over the record. */
imki_outlier_rule imki_outlier_rule_find(size_t n, const double *samples, double false_alarm,
                                         double resolution, size_t scratch_count, double *scratch);
/* Outliers by the rule; they become NaN in `marked` unless that is NULL. It may be `samples`. */
imk_screen_count imki_outliers_find(size_t n, const double *samples, const imki_outlier_rule *rule,
                                    double *marked, double *largest);

/* screen_trend.c: warm-up and temperature against slow noise. */
enum { IMKI_TREND_PARTS = 256 };
/* Of `parts` means, at most IMKI_TREND_PARTS, of so many samples each, and those of the temperature
 * or NULL. */
void imki_trend_of_means(double significance, size_t parts, size_t samples, double dt,
                         const double *mean, const double *temperature, imk_screen *found);
/* A warm-up among samples; times are in samples. */
void imki_trend_find(double significance, size_t n, const double *samples, imk_screen *found);

#endif
