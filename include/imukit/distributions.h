/* SPDX-License-Identifier: Apache-2.0 */
/** @file distributions.h
 *  Distribution functions and quantiles that confidence intervals need.
 *  All take probabilities in (0, 1) and return NaN outside the domain. */
#ifndef IMUKIT_DISTRIBUTIONS_H
#define IMUKIT_DISTRIBUTIONS_H

#include "imukit/status.h"

IMK_BEGIN_C

/** Probability that a standard normal is below x; relative error < 1e-14, also in the tails. */
IMK_API double imk_normal_probability(double x);
/** Inverse of imk_normal_probability(), with the same accuracy. */
IMK_API double imk_normal_quantile(double probability);

/** log Gamma(x) for x > 0, relative error < 1e-14 (absolute near 1 and 2). */
IMK_API double imk_log_gamma(double x);

/** Regularised incomplete gamma function P(a, x), a > 0, x >= 0. The smaller one of P and Q = 1 - P
 *  has a relative error < 1e-12 for a <= 1e8. */
IMK_API double imk_gamma_lower(double a, double x);
/** Regularised incomplete gamma function Q(a, x) = 1 - P(a, x). */
IMK_API double imk_gamma_upper(double a, double x);

/** Probability that chi-square with any real degrees of freedom > 0 is <= x. This function and its
 *  inverse have a relative error < 1e-12 (1e-12/degrees below 1 degree) for probabilities 1e-12 … 1
 *  - 1e-12, and take about 1 us. */
IMK_API double imk_chi_square_probability(double x, double degrees);
/** Inverse of imk_chi_square_probability(). */
IMK_API double imk_chi_square_quantile(double probability, double degrees);

/** Regularised incomplete beta function I_x(a, b), a, b > 0, with y = 1 - x given as well, so that
 *  both ends are accurate; relative error of the smaller one of I and 1 - I < 1e-12 for a,
 *  b <= 1e6. About 1 us, more with the square root of a and b. */
IMK_API double imk_beta_lower(double a, double b, double x, double y);

/** Probability that a ratio of mean squares with these degrees of freedom (F distribution) exceeds
 *  f >= 0. Infinite `denominator`: chi-square over its degrees. */
IMK_API double imk_f_upper(double f, double numerator, double denominator);
/** The ratio that is exceeded with this probability, relative error < 1e-12; some us. */
IMK_API double imk_f_upper_quantile(double probability, double numerator, double denominator);
/** Quantile of Student's distribution; infinite degrees: the normal one. */
IMK_API double imk_student_quantile(double probability, double degrees);

IMK_END_C
#endif
