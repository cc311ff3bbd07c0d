/* SPDX-License-Identifier: Apache-2.0 */
/* Correlations of calibrated values. */
#ifndef IMUKI_DRIFT_CORRELATION_INTERNAL_H
#define IMUKI_DRIFT_CORRELATION_INTERNAL_H

#include "drift_covariance_internal.h"

enum { IMKI_CORRELATION_FACTOR = IMK_CORRELATED_MAX * (IMK_CORRELATED_MAX + 1) / 2 };

/* Place of a parameter among the correlated ones; -1: it is none. */
int imki_correlation_index(const imk_correlation *correlation, imk_model_parameter parameter);
double imki_correlation_value(const imk_correlation *correlation, int i, int j);
/* L of R = L L^T, row i from i (i + 1)/2 on. @return false: the numbers are no correlations, as of
 * three parameters of which each two have -0.9 */
bool imki_correlation_factor(const imk_correlation *correlation,
                             double factor[IMKI_CORRELATION_FACTOR]);

/* Pairs of sources with correlations at most; those there are. */
size_t imki_drift_cross_max(const imk_model *model, const imk_drift_settings *settings);
size_t imki_drift_cross_pairs(const imki_drift_plan *plan, size_t max, imk_drift_cross *cross);
/* What correlations of the elements of two sources, or within one, add to a covariance. */
void imki_drift_add_correlated(const imki_drift_plan *plan, const imki_drift_part *a,
                               const imki_drift_part *b, const imki_drift_node *node,
                               imki_matrix9 *p);
/* The cross covariance at an instant, in north-east-down axes. */
void imki_drift_cross_at(const imki_drift_plan *plan, const imk_drift_cross *cross,
                         const imki_drift_node *node, imk_drift_moments *moments);

#endif
