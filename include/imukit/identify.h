/* SPDX-License-Identifier: Apache-2.0 */
/** @file identify.h
 *  Noise terms with confidence intervals from a stationary record, and a verdict on the record.
 *
 *  The estimator is maximum likelihood on the cosine spectrum of the record
 *  (docs/theory/identification.md). The coefficients of white noise and random walk are exactly
 *  independent, those of the other terms nearly so, which gives every frequency its right weight.
 *  Intervals are by profile likelihood. A term is kept if the likelihood ratio supports it; else it
 *  is reported as absent with an upper bound. */
#ifndef IMUKIT_IDENTIFY_H
#define IMUKIT_IDENTIFY_H

#include "imukit/allan.h"
#include "imukit/model.h"
#include "imukit/noise.h"

#include <stdbool.h>

IMK_BEGIN_C

/** The five noise terms of IEEE 952. */
typedef enum imk_noise_term {
    IMK_NOISE_QUANTIZATION = 0, /**< 1 sigma of the errors of the readings of the integral, counted
                                   or not: imk_identification_counted() */
    IMK_NOISE_WHITE,
    IMK_NOISE_BIAS_INSTABILITY,
    IMK_NOISE_RANDOM_WALK,
    IMK_NOISE_RAMP,
    IMK_NOISE_TERMS
} imk_noise_term;

/** One estimated parameter. */
typedef struct imk_estimate {
    bool present; /**< false: the term is absent; then value and lower are 0, and upper is the bound
                     at the confidence */
    double value, sigma; /**< estimate and its 1 sigma [unit of the parameter]; sigma is from the
                            curvature of the likelihood */
    double lower, upper; /**< profile-likelihood interval */
    double free_value;   /**< most likely value when white noise, bias instability, random walk and
                            the term itself are all free, whether present or not; centre of the
                            interval; its square is almost unbiased */
} imk_estimate;

/** Features of a record that the five terms do not explain. */
enum {
    IMK_VERDICT_SHORT =
        1 << 0, /**< the record is too short for the slowest terms: only bounds are given */
    IMK_VERDICT_COARSE = 1 << 1, /**< the resolution step is so large that rounding errors are not
                                    white: do not trust white noise and quantization */
    IMK_VERDICT_LINES =
        1 << 2, /**< spectral lines (vibration, interference), modelled separately */
    IMK_VERDICT_RESONANCE = 1 << 3, /**< structural resonance, modelled separately */
    IMK_VERDICT_FILTERED = 1 << 4,  /**< the output is low-pass filtered within the band */
    IMK_VERDICT_WARM_UP = 1 << 5,   /**< the start drifts differently from the rest */
    IMK_VERDICT_SATURATED = 1 << 6, /**< samples stick at an extreme value */
    IMK_VERDICT_MISFIT = 1 << 7,    /**< the model does not explain all tau (false alarms: less than
                                       one record in 10000): see valid_from, valid_to */
    IMK_VERDICT_FROZEN =
        1 << 8, /**< long runs of one value: samples are repeated, and the true rate is lower */
    IMK_VERDICT_UNDETERMINED = 1 << 12 /**< white noise or quantization is present, but known to no
                                          better than a factor of three up and down */
};

/** Bits of imk_identification.ambiguous and .instead: 1 << a term of imk_noise_term, and this. */
enum { IMK_AMBIGUOUS_GAUSS_MARKOV = 1 << IMK_NOISE_TERMS };

/** Power of the lowest coefficients of the cosine spectrum. */
typedef struct imk_level_sum {
    double degrees; /**< coefficients; 0: none */
    double power;   /**< sum of their powers, each over the model's */
    double period;  /**< shortest period among them [s] */
} imk_level_sum;

enum { IMK_LEVEL_SUMS = 10 };

/** Result for one channel. Values are in the channel's unit. */
typedef struct imk_identification {
    imk_estimate term[IMK_NOISE_TERMS];
    double correlation[IMK_NOISE_TERMS][IMK_NOISE_TERMS];
    double mean, deviation; /**< of the samples */
    double minimum_floor;   /**< smallest Allan deviation divided by 0.664, for comparison with B */
    imk_low_pass filter;    /**< output filter; bandwidth 0 when none is detected */
    int gauss_markov_count, sinusoid_count, resonance_count;
    struct imk_gauss_markov_estimate {
        imk_estimate sigma;            /**< [unit] */
        imk_estimate correlation_time; /**< [s] */
    } gauss_markov[IMK_TERMS_MAX];
    imk_sinusoid sinusoid[IMK_TERMS_MAX];
    imk_resonance resonance[IMK_TERMS_MAX];
    double valid_from, valid_to; /**< longest range of tau [s] over which the measured Allan
                                      deviation is within 5 % of the model's or may be so by chance;
                                      from is infinite when there is none */
    double five_terms_from; /**< the same lower end for the five terms alone, without Gauss-Markov
                               terms, lines, resonances and filter */
    double longest;         /**< longest tau compared with the record: a ninth of its length [s] */
    double resolution;      /**< smallest step between values [unit]; 0 when none is detected */
    double log_likelihood;  /**< of the spectrum, less that of one that equals each band's power */
    double dt;          /**< sample interval [s]; 0: not known, as of a table of Allan deviations */
    double rounding;    /**< white noise of rounding to these steps after the filter [unit of N]; 0
                           when none is detected: then the white noise holds it */
    double plateau;     /**< white noise together with what resonances have at frequency 0, if some
                           were no lines [unit of N]: behind a digital filter they stand for its
                           shape, and this is the sensor's; else 0 */
    size_t missing;     /**< missing samples between the first and the last sample present */
    double largest_gap; /**< longest run of missing samples [s] */
    int rounds; /**< iterations between missing samples and spectrum; 0: no sample is missing */
    imk_level_sum level[IMK_LEVEL_SUMS]; /**< of the lowest 8, 16, 32, … coefficients; degrees 0
                                            where there are no more, and in a joint estimate */
    unsigned verdict;                    /**< IMK_VERDICT_… bits */
    unsigned ambiguous; /**< terms called present without which other terms explain the record about
                           as well; their intervals begin at 0. Intervals hold either way */
    unsigned instead;   /**< terms, not called present, that may be there in their place */
} imk_identification;

/** Summary of a record for a joint estimate (identify_joint.h). */
typedef struct imk_spectral_summary imk_spectral_summary;

typedef struct imk_identify_settings {
    uint32_t cookie;
    double dt;           /**< sample interval [s] */
    double confidence;   /**< of intervals and bounds; default 0.95 */
    double significance; /**< false-alarm rate at which a term is called present; default 0.01 */
    bool shape;          /**< look for lines, resonances and the output filter; default true */
    imk_spectral_summary *summary; /**< filled when not NULL, imk_spectral_summary_size() bytes */
} imk_identify_settings;

/** The defaults stated above; dt must be set. */
IMK_API imk_identify_settings imk_identify_default(void);

/** Bytes of workspace for n samples: about 62 n, of which 21 n are touched only where samples are
 *  missing. */
IMK_API size_t imk_identify_workspace_size(size_t n);

/** Identify one channel.
 *
 *  NaN is a missing sample. The estimate is then maximum likelihood on the samples present, and the
 *  intervals take the missing samples into account (docs/theory/identification.md).
 *  @param n        number of samples, at least 256; at most three quarters may be missing
 *  @param samples  equally spaced; not changed
 *  @return IMK_ERROR_TOO_SHORT, IMK_ERROR_CONSTANT, IMK_ERROR_NOT_FINITE (error.index: sample),
 *          IMK_ERROR_WORKSPACE, IMK_ERROR_NO_CONVERGENCE (no noise in the record) */
IMK_API imk_status imk_identify_channel(const imk_identify_settings *settings, size_t n,
                                        const double *samples, imk_identification *result,
                                        void *workspace, size_t workspace_size, imk_error *error);

/** Do channels of independent noise hold less power at the lowest frequencies than their models, as
 *  behind a high-pass filter or an automatic zero? False alarms: one log of six channels in 10000,
 *  if each is tested.
 *  @return  the sum over the channels that is least probable; degrees 0: none is low */
IMK_API imk_level_sum imk_level_loss(size_t count, const imk_identification *const *channels);

/** Kinds of what a model has beside the five terms. */
typedef enum imk_identified_kind {
    IMK_IDENTIFIED_GAUSS_MARKOV = 0,
    IMK_IDENTIFIED_SINUSOID,
    IMK_IDENTIFIED_RESONANCE,
    IMK_IDENTIFIED_ROUNDING, /**< to steps, after the output filter */
    IMK_IDENTIFIED_KINDS
} imk_identified_kind;
/** How many of a kind the identified model has. */
IMK_API int imk_identification_count(const imk_identification *result, imk_identified_kind kind);
/** Expected Allan variance of one of them at tau = m dt, exact for the sampled process [unit^2].
 *  @param index  0 … imk_identification_count() - 1 */
IMK_API double imk_identification_part_allan_variance(const imk_identification *result,
                                                      imk_identified_kind kind, int index,
                                                      double dt, size_t m);
/** Expected Allan variance of the identified model at tau = m dt, exact for the sampled process
 *  [unit^2].
 *  @param term  one of the five terms, white noise behind the output filter; negative: the whole
 *               model */
IMK_API double imk_identification_allan_variance(const imk_identification *result, double dt,
                                                 size_t m, int term);

/** Are the errors of the readings of the integral, IMK_NOISE_QUANTIZATION, those of counting? True
 * if the samples lie on a grid whose step is sqrt(12) Q/dt, within a fifth or the interval of Q, or
 * if the interval of samples is not known. Else they are white noise of the integral, A = Q
 * sqrt(dt): one record at one rate cannot tell it from counts whose grid does not show, such as
 * those of a dithered ring laser. */
IMK_API bool imk_identification_counted(const imk_identification *result);

/** Put a channel's result into one axis of a model: its noise terms, its output filter and the
 *  evidence for them. What is not counted becomes noise.angle_white. Absent terms become zero in
 *  the model, and their bounds go into the evidence. Where the output is rounded after its filter,
 *  its step becomes the model's resolution.
 *  @param sensor  IMK_GYRO or IMK_ACCEL
 *  @param axis    0 … IMK_AXES_MAX - 1 */
IMK_API void imk_identification_store(const imk_identification *result, imk_model *model,
                                      int sensor, int axis);

IMK_END_C
#endif
