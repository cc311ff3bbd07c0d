/* SPDX-License-Identifier: Apache-2.0 */
/* Parts of the gamma function that the incomplete gamma functions and quantiles share, and the
 * error function. */
#ifndef IMUKIT_GAMMA_INTERNAL_H
#define IMUKIT_GAMMA_INTERNAL_H

/** log Gamma(1 + x) for -0.5 <= x <= 1.5, relative error near 1e-16 also where it is near 0. */
double imki_log_gamma_one_plus(double x);

/** What Stirling's formula lacks: log Gamma(x) - [(x - 1/2) log x - x + log(2 pi)/2], x >= 10. */
double imki_stirling_error(double x);

/** mu - log(1 + mu), mu > -1, without cancellation. */
double imki_log_deficit(double mu);

/** x^a e^{-x} / Gamma(a + 1), a > 0, x > 0. */
double imki_gamma_power(double a, double x);

/** 2/sqrt(pi) int_0^x e^{-t^2} dt, error below 2.5 ulp, and 1 less it, below 4 ulp; NaN stays. */
double imki_erf(double x);
double imki_erfc(double x);

/** P(a, x) and Q(a, x) together. */
void imki_gamma_both(double a, double x, double *lower, double *upper);

#endif
