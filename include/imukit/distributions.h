/* SPDX-License-Identifier: Apache-2.0 */
/** @file distributions.h
 *  Distribution functions and quantiles that confidence intervals need.
 *  All take probabilities in (0, 1) and return NaN outside the domain. */
#ifndef IMUKIT_DISTRIBUTIONS_H
#define IMUKIT_DISTRIBUTIONS_H

#include "imukit/status.h"

IMK_BEGIN_C

/** Standard normal distribution function and its inverse; relative error < 1e-14, also in tails. */
IMK_API double imk_normal_probability(double x);
/** x below which a standard normal lies with this probability. */
IMK_API double imk_normal_quantile(double probability);

/** log Gamma(x) for x > 0, relative error < 1e-14 (absolute near 1 and 2). */
IMK_API double imk_log_gamma(double x);

/** Regularised incomplete gamma functions P(a, x) and Q = 1 - P, a > 0, x >= 0; relative error of
 *  the smaller one < 1e-12 for a <= 1e8. */
IMK_API double imk_gamma_lower(double a, double x);
/** Q(a, x), the upper one. */
IMK_API double imk_gamma_upper(double a, double x);

/** Chi-square distribution with any real degrees of freedom > 0: probability of a value <= x, and
 *  the value below which it lies with a probability, relative error < 1e-12 (1e-12/degrees below 1
 *  degree) for probabilities 1e-12 … 1 - 1e-12; about 1 us. */
IMK_API double imk_chi_square_probability(double x, double degrees);
/** x below which chi-square lies with this probability. */
IMK_API double imk_chi_square_quantile(double probability, double degrees);

/** Regularised incomplete beta function I_x(a, b), a, b > 0, with y = 1 - x given besides, so that
 *  neither end is lost to rounding; relative error of the smaller one of I and 1 - I < 1e-12 for
 *  a, b <= 1e6. About 1 us, more with the square root of a and b. */
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
