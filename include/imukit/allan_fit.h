/* SPDX-License-Identifier: Apache-2.0 */
/** @file allan_fit.h
 *  Noise model from a table of Allan variances, by generalised least squares with the full
 *  covariance across tau (docs/theory/allan-fit.md).
 *
 *  Use it if you have a curve but not the record: a published table, the sums that a device kept
 *  while it ran, or the pooled curves of several records. If you have the record, use
 *  imk_identify_channel(), which loses nothing. Allan variance is twice the variance of Haar
 *  wavelet coefficients, so the same functions fit those (the generalised method of wavelet moments
 *  [GUERRIER2013]).
 *
 *  Neighbouring tau share most of their data; the covariance of the estimates follows from the
 *  noise model, and so does each estimate's weight. Both are iterated: the amounts a >= 0 solve
 *
 *      A^T C(a)^-1 (v - A a) = 0
 *
 *  with C the covariance of the measured variances v under the model A a itself. Its errors have
 *  expectation zero at the truth, so the weights bring no bias of first order.
 *
 *  Nothing allocates; about 100 kB of stack besides the workspace. */
#ifndef IMUKIT_ALLAN_FIT_H
#define IMUKIT_ALLAN_FIT_H

#include "imukit/identify.h"
#include "imukit/noise.h"

IMK_BEGIN_C

enum {
    IMK_ALLAN_FIT_FACTORS_MAX = 64, /**< tau in a table */
    IMK_ALLAN_FIT_TERMS_MAX = IMK_NOISE_TERMS + 3 * IMK_TERMS_MAX
};

/** A noise model, whose Allan variance imk_allan_noise_variance() computes. Zero-initialised: no
 *  noise. */
typedef struct imk_allan_noise {
    double term[IMK_NOISE_TERMS]; /**< Q [unit s], N [unit/sqrt(Hz)], B [unit], K [unit/sqrt(s)],
                                       R [unit/s] */
    imk_low_pass filter; /**< output filter, which the white noise passes; bandwidth 0: none */
    int gauss_markov_count, sinusoid_count, resonance_count; /**< 0 … IMK_TERMS_MAX each */
    imk_gauss_markov gauss_markov[IMK_TERMS_MAX];
    imk_sinusoid sinusoid[IMK_TERMS_MAX];
    imk_resonance resonance[IMK_TERMS_MAX];
} imk_allan_noise;

/** Expected Allan variance of the model at tau = m dt, exact for the sampled process. */
IMK_API double imk_allan_noise_variance(const imk_allan_noise *noise, double dt, size_t m);

/** Measured Allan variances, and how they were computed. */
typedef struct imk_allan_table {
    double dt;             /**< sample interval [s] */
    size_t count;          /**< number of tau: 2 … IMK_ALLAN_FIT_FACTORS_MAX */
    const size_t *factors; /**< ascending averaging factors m, tau = m dt */
    /** Variance at each tau [unit^2]; NULL if only a covariance is computed. */
    const double *variances;
    const size_t *strides; /**< samples from one second difference to the next, each a divisor of
                                its factor; NULL: 1, full overlap (OAVAR). m: plain AVAR */
    size_t record_count;   /**< records pooled, each variance weighted by its number of squares */
    const size_t *lengths; /**< samples of each record; every factor fits twice into one of them */
} imk_allan_table;

/** Bytes of workspace for a table of `count` tau and a model of `terms` terms (at most 5, and the
 *  Gauss-Markov terms, sinusoids and resonances); 40 kB for 25 tau and five terms. */
IMK_API size_t imk_allan_covariance_workspace_size(size_t count, size_t terms);

/** Covariance of the table's variances when the records have this noise.
 *
 *      cov(v1, v2) = 1/(4 m1^2 m2^2 M1 M2) sum_l W(l) [2 rho12(l)^2 + 4 rho12(l) mu12(l)]
 *
 *  where rho12 is the cross-covariance of the Gaussian part of the second differences, from the
 *  generalised autocovariance of the running sums [GREENHALL2003], mu12 is the mean product of the
 *  deterministic part (ramp and sinusoids, averaged over phase), and W(l) is the number of pairs at
 *  lag l. Lags are summed one by one between close kinks of rho12 and by Gauss-Legendre quadrature
 *  elsewhere: within 1 % of the full sum; the time does not depend on the record's length.
 *  Resonances are assumed narrow against the rest of the spectrum: within 10 % for q >= 5.
 *  @param covariance  count x count, row-major
 *  @return IMK_ERROR_RANGE, IMK_ERROR_TOO_SHORT (a factor that fits in no record),
 *          IMK_ERROR_ARGUMENT, IMK_ERROR_NOT_FINITE, IMK_ERROR_WORKSPACE */
IMK_API imk_status imk_allan_covariance(const imk_allan_table *table, const imk_allan_noise *noise,
                                        double *covariance, void *workspace, size_t workspace_size);

/** Settings of a fit. Start from imk_allan_fit_default(), then change fields. */
typedef struct imk_allan_fit_settings {
    uint32_t cookie;
    double confidence;   /**< of the intervals; default 0.95 */
    double significance; /**< false-alarm rate at which a term is called present; default 0.01 */
    bool term[IMK_NOISE_TERMS]; /**< terms that may be present; default all */
    bool keep[IMK_NOISE_TERMS]; /**< terms that are always present; default none */
    double tolerance; /**< relative error of each deviation that is allowed beside its random error,
                         0 … 0.5; default 0 */
    /** Where the model does not explain the table (chi-square's probability below 1e-6), leave out
     *  the shortest tau: as few as bring the probability above 0.01, and at most half. Filters,
     *  resonances and lines disturb the shortest tau. Default true. */
    bool trim;
    int gauss_markov_max; /**< Gauss-Markov terms looked for, 0 … IMK_TERMS_MAX; default 0 */
    imk_low_pass filter;  /**< known output filter; default none */
    int sinusoid_count;   /**< sinusoids whose amplitude is fitted */
    imk_sinusoid sinusoid[IMK_TERMS_MAX]; /**< their frequencies; amplitudes are not read */
    bool sinusoid_refine; /**< also fit the frequencies, within 10 %; default false */
    int resonance_count;  /**< resonances whose strength is fitted */
    imk_resonance resonance[IMK_TERMS_MAX]; /**< their frequency and q; sigma is not read */
} imk_allan_fit_settings;

/** The defaults stated above: the five terms, with trimming. */
IMK_API imk_allan_fit_settings imk_allan_fit_default(void);

/** Result of a fit. */
typedef struct imk_allan_fit {
    imk_estimate term[IMK_NOISE_TERMS]; /**< lower, upper by the profile of the quasi-likelihood;
                                             value +- z sigma is the asymptotic interval */
    double correlation[IMK_NOISE_TERMS][IMK_NOISE_TERMS]; /**< of the amounts Q^2, N^2 … */
    int gauss_markov_count;
    struct imk_allan_gauss_markov {
        imk_estimate sigma;            /**< [unit] */
        imk_estimate correlation_time; /**< [s] */
    } gauss_markov[IMK_TERMS_MAX];
    imk_estimate sinusoid[IMK_TERMS_MAX];  /**< amplitudes, in the order of the settings */
    imk_estimate resonance[IMK_TERMS_MAX]; /**< sigmas, in the order of the settings */
    imk_allan_noise noise;                 /**< the model of the terms present */
    size_t first; /**< index in the table of the shortest tau used; more than 0 after trimming */
    double expected[IMK_ALLAN_FIT_FACTORS_MAX]; /**< Allan variances of this model */
    double sigma[IMK_ALLAN_FIT_FACTORS_MAX]; /**< standard deviations of the measured variances */
    double chi_square;                       /**< (v - A a)^T C^-1 (v - A a) */
    int degrees;                             /**< tau used less fitted parameters */
    /** Probability of a larger chi-square by chance if variances were Gaussian. At long tau they
     *  are skewed, so 14 % of good fits to octaves have a value below 0.05, and 20 % with ten tau a
     *  decade; the bootstrap gives a better value. */
    double probability;
} imk_allan_fit;

/** Bytes of workspace for a fit, and for bootstraps of up to `draws` draws. */
IMK_API size_t imk_allan_fit_workspace_size(const imk_allan_fit_settings *settings, size_t count,
                                            size_t draws);

/** Fit a model to a table.
 *  @return errors of imk_allan_covariance(), IMK_ERROR_UNINITIALISED, IMK_ERROR_NO_CONVERGENCE,
 *          IMK_ERROR_SINGULAR (the covariance of these tau is singular: leave some out) */
IMK_API imk_status imk_allan_fit_table(const imk_allan_fit_settings *settings,
                                       const imk_allan_table *table, imk_allan_fit *fit,
                                       void *workspace, size_t workspace_size, imk_error *error);

/** Result of a bootstrap: statistics of fits to tables drawn from the fitted model. */
typedef struct imk_allan_bootstrap {
    size_t draws;
    struct imk_allan_bootstrap_term {
        double bias, sigma;  /**< relative bias and 1 sigma of the amount (square) over the draws */
        double lower, upper; /**< quantiles of the value at the confidence */
        double covered;      /**< share of draws whose profile interval contains the fitted value */
    } term[IMK_NOISE_TERMS]; /**< zeros for terms that are absent */
    double probability;      /**< share of draws with a larger chi-square */
} imk_allan_bootstrap;

/** Parametric bootstrap: variances are drawn as chi-squares of the degrees of freedom that the
 *  model's covariance gives each, joined by a Gaussian copula with the model's correlations, and
 *  fitted with the terms that are present.
 *  @param fit    from imk_allan_fit_table() with the same settings and table
 *  @param draws  20 up to the number for which the workspace was sized */
IMK_API imk_status imk_allan_fit_bootstrap(const imk_allan_fit_settings *settings,
                                           const imk_allan_table *table, const imk_allan_fit *fit,
                                           imk_random random, size_t draws,
                                           imk_allan_bootstrap *result, void *workspace,
                                           size_t workspace_size);

IMK_END_C
#endif
