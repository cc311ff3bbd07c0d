/* SPDX-License-Identifier: Apache-2.0 */
/* Allan deviations of one channel, as columns ready to be plotted. */
#ifndef IMUKIT_ALLAN_CURVE_H
#define IMUKIT_ALLAN_CURVE_H

#include "shell/command.h"

#include "imukit/allan.h"

typedef struct allan_curve {
    size_t count;
    imk_allan_point *point;
    double *tau, *deviation, *lower, *upper; /* [s], [SI] */
    double *used; /* share of the record's pairs behind each point; NULL without gaps */
} allan_curve;

/* @param n     rate samples; sums has n + 1 values
 * @param label what the progress line says, or NULL for none */
imk_status allan_curve_compute(const imk_allan_settings *settings, size_t n, const double *sums,
                               double dt, size_t factor_count, const size_t *factors,
                               const char *label, const imk_executor *executor, allan_curve *curve);
/* The overlapping deviation of rates of which some are missing (NaN). */
imk_status allan_curve_with_gaps(const imk_allan_settings *settings, size_t n, const double *rate,
                                 double dt, size_t factor_count, const size_t *factors,
                                 const imk_executor *executor, allan_curve *curve);
void allan_curve_free(allan_curve *curve);

/* Averaging factors of a grid, for OADEV or in the range of a statistic; from malloc(). */
size_t *allan_factors_of_grid(imk_allan_grid grid, size_t n, size_t *count);
size_t *allan_factors_of(imk_allan_statistic statistic, imk_allan_grid grid, size_t n,
                         size_t *count);

#endif
