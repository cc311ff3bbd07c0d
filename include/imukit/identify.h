/* SPDX-License-Identifier: Apache-2.0 */
/** @file identify.h
 *  Static record -> stochastic terms with confidence, and a verdict on the record.
 *
 *  The estimator is maximum likelihood on the cosine spectrum of the record
 *  (docs/theory/identification.md): the cosine transform makes white noise and random walk exactly
 *  independent and the rest nearly so, which gives every frequency its right weight;
 *  profile-likelihood intervals; a term is kept when the likelihood says so, and otherwise reported
 *  as absent with an upper bound. */
#ifndef IMUKIT_IDENTIFY_H
#define IMUKIT_IDENTIFY_H

#include "imukit/allan.h"
#include "imukit/model.h"
#include "imukit/noise.h"

#include <stdbool.h>

IMK_BEGIN_C

/** The five terms of the lecture and of IEEE 952. */
typedef enum imk_noise_term {
    IMK_NOISE_QUANTIZATION = 0,
    IMK_NOISE_WHITE,
    IMK_NOISE_BIAS_INSTABILITY,
    IMK_NOISE_RANDOM_WALK,
    IMK_NOISE_RAMP,
    IMK_NOISE_TERMS
} imk_noise_term;

/** One estimated parameter. */
typedef struct imk_estimate {
    bool present;        /**< false: absent; value 0, lower 0, upper the bound at the confidence */
    double value, sigma; /**< [unit of the parameter]; sigma by the likelihood's curvature */
    double lower, upper; /**< profile-likelihood interval */
    double free_value; /**< likeliest value while white noise, bias instability, random walk and the
                            term itself are all free, chosen or not: the interval's centre, with
                            next to no bias in its square */
} imk_estimate;

/** What the record holds that the five terms do not explain. */
enum {
    IMK_VERDICT_SHORT = 1 << 0,  /**< too short for the slowest terms: bounds only */
    IMK_VERDICT_COARSE = 1 << 1, /**< resolution step larger than the noise: white noise doubtful */
    IMK_VERDICT_LINES = 1 << 2,  /**< spectral lines (vibration, interference) modelled apart */
    IMK_VERDICT_RESONANCE = 1 << 3, /**< structural resonance modelled apart */
    IMK_VERDICT_FILTERED = 1 << 4,  /**< the output is low-pass filtered within the band */
    IMK_VERDICT_WARM_UP = 1 << 5,   /**< the start drifts unlike the rest */
    IMK_VERDICT_SATURATED = 1 << 6, /**< samples stick at an extreme value */
    IMK_VERDICT_MISFIT = 1 << 7,    /**< something else remains outside valid_from … valid_to */
    IMK_VERDICT_FROZEN = 1 << 8 /**< long runs of one value: samples repeated, rate overstated */
};

/** Everything found on one channel. Values in the channel's unit. */
typedef struct imk_identification {
    imk_estimate term[IMK_NOISE_TERMS];
    double correlation[IMK_NOISE_TERMS][IMK_NOISE_TERMS];
    double mean, deviation; /**< of the samples */
    double minimum_floor;   /**< smallest Allan deviation/0.664, for comparison with B */
    imk_low_pass filter;    /**< output filter, bandwidth 0 when none is seen */
    int gauss_markov_count, sinusoid_count, resonance_count;
    struct imk_gauss_markov_estimate {
        imk_estimate sigma;            /**< [unit] */
        imk_estimate correlation_time; /**< [s] */
    } gauss_markov[IMK_TERMS_MAX];
    imk_sinusoid sinusoid[IMK_TERMS_MAX];
    imk_resonance resonance[IMK_TERMS_MAX];
    double valid_from, valid_to; /**< range of tau [s] over which the model explains the measured
                                      Allan deviation; from is infinite when there is none */
    double five_terms_from;      /**< the same start for the five terms alone, without Gauss-Markov
                                      terms, lines, resonances and filter */
    double longest;              /**< longest tau [s] compared: a ninth of the record */
    double resolution;           /**< smallest step between values, 0 when none is seen [unit] */
    double log_likelihood;
    size_t missing;     /**< samples missing between the first and the last that is there */
    double largest_gap; /**< longest run of them [s] */
    int rounds;         /**< in which they and the spectrum were found by turns; 0: none missing */
    unsigned verdict;   /**< IMK_VERDICT_… bits */
} imk_identification;

/** What a joint estimate needs of a record (identify_joint.h). */
typedef struct imk_spectral_summary imk_spectral_summary;

typedef struct imk_identify_settings {
    uint32_t cookie;
    double dt;           /**< sample interval [s] */
    double confidence;   /**< of intervals and bounds; default 0.95 */
    double significance; /**< false-alarm rate at which a term is called present; default 0.01 */
    bool shape;          /**< look for lines, resonances and the output filter; default true */
    imk_spectral_summary *summary; /**< filled when not NULL, imk_spectral_summary_size() bytes */
} imk_identify_settings;

/** 95 % intervals, 1 % significance, shapes looked for; dt must be set. */
IMK_API imk_identify_settings imk_identify_default(void);

/** Bytes of workspace for n samples: about 62 n, of which 21 n are touched only where samples are
 *  missing. */
IMK_API size_t imk_identify_workspace_size(size_t n);

/** Identify one channel.
 *
 *  NaN is a missing sample. The estimate is then that of maximum likelihood on the samples that are
 *  there, and the intervals are as wide as these make them (docs/theory/identification.md).
 *  @param n         samples, at least 256; of these no more than three quarters may be missing
 *  @param samples   equally spaced; not changed
 *  @return IMK_ERROR_TOO_SHORT, IMK_ERROR_CONSTANT, IMK_ERROR_NOT_FINITE (error.index: sample),
 *          IMK_ERROR_WORKSPACE, IMK_ERROR_NO_CONVERGENCE (no noise in the record) */
IMK_API imk_status imk_identify_channel(const imk_identify_settings *settings, size_t n,
                                        const double *samples, imk_identification *result,
                                        void *workspace, size_t workspace_size, imk_error *error);

/** Expected Allan variance of the identified model at tau = m dt, exact for the sampled process;
 *  `term` < 0: of all; else of one of the five. */
IMK_API double imk_identification_allan_variance(const imk_identification *result, double dt,
                                                 size_t m, int term);

/** Put a channel's result into one axis of a model: its noise terms, its output filter and the
 *  evidence for them. Terms that are absent become zero there, with their bound in the evidence.
 *  @param sensor  IMK_GYRO or IMK_ACCEL
 *  @param axis    0 … IMK_AXES_MAX - 1 */
IMK_API void imk_identification_store(const imk_identification *result, imk_model *model,
                                      int sensor, int axis);

IMK_END_C
#endif
