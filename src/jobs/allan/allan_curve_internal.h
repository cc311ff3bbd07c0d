/* SPDX-License-Identifier: Apache-2.0 */
/* Allan deviations of one channel. */
#ifndef IMUKI_ALLAN_CURVE_INTERNAL_H
#define IMUKI_ALLAN_CURVE_INTERNAL_H

#include "imukit/allan_log.h"

/* @param n      rate samples; sums has n + 1 values
 * @param stage  what the progress says, or NULL for none
 * The memory is the job's allocator's. */
imk_status imki_allan_curve_compute(const imk_allan_settings *settings, size_t n,
                                    const double *sums, double dt, size_t factor_count,
                                    const size_t *factors, const char *stage, const imk_job *job,
                                    imk_allan_curve *curve);
/* The overlapping deviation of rates of which some are missing (NaN). */
imk_status imki_allan_curve_with_gaps(const imk_allan_settings *settings, size_t n,
                                      const double *rate, double dt, size_t factor_count,
                                      const size_t *factors, const imk_job *job,
                                      imk_allan_curve *curve);
/* A curve of points that are known. */
imk_status imki_allan_curve_of(size_t count, const imk_allan_point *points, double dt,
                               const imk_allocator *allocator, imk_allan_curve *curve);

/* Averaging factors of a grid in the range of a statistic, from the allocator; NULL when memory is
 * exhausted. */
size_t *imki_allan_factors(imk_allan_statistic statistic, imk_allan_grid grid, size_t n,
                           const imk_allocator *allocator, size_t *count);

#endif
