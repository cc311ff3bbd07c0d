/* SPDX-License-Identifier: Apache-2.0 */
/** @file noise.h
 *  The stochastic terms: for each its Allan variance, its spectrum, and its generator.
 *
 *  Three views of a term are kept apart, because confusing them is the most common error:
 *  - `imk_<term>_allan_variance(…, tau)`: the continuous-time closed form [IEEE952];
 *  - `imk_<term>_sampled_allan_variance(…, dt, n)`: exact for the sequence that the generator
 *    makes, at tau = n dt, n >= 1;
 *  - `imk_<term>_sampled_spectrum(…, dt, f)`: two-sided power spectral density [unit^2/Hz] of that
 *    sequence, 0 < f <= 1/(2 dt); the integral over (-1/2dt, 1/2dt) is its variance. For terms that
 *    are not stationary it is the spectrum seen by a cosine transform of the sequence.
 *
 *  Generators add `count` samples to `out`. Sample k of a term depends only on the random source,
 *  its stream and k. Blocks may have any size but must be generated in order. The state of a
 *  generator is plain data; a copy of it continues the same sequence independently. All generators
 *  use only + - * / sqrt and elementary.h.
 *
 *  It is fixed for ever which normal random number drives which sample. Recursions run over 16
 *  segments of a block of 512 samples at a time, so white noise, random walk, Gauss-Markov and the
 *  two fastest flicker stages drive sample 512 b + 32 s + i (s < 16, i < 32) by normal 512 b + 16
 *  i + s; the ARMA sequences drive sample k by normal k. Normals 2^63 and up of the same stream
 *  draw stationary starting values, words 3 * 2^62 and up starting phases.
 *
 *  Every `_start` takes dt [s] > 0 and returns IMK_ERROR_NOT_FINITE for a parameter that is not
 *  finite and IMK_ERROR_RANGE for one outside its range; the state is then unchanged. The formulas
 *  do not check their arguments: outside the range their value is meaningless. */
#ifndef IMUKIT_NOISE_H
#define IMUKIT_NOISE_H

#include "imukit/random.h"
#include "imukit/status.h"

IMK_BEGIN_C

/** The stochastic terms, in the order in which their samples are added, with the numbers of their
 *  random streams. */
#define IMK_NOISE_TERM_LIST(TERM)                                                                  \
    TERM(WHITE, white, 1)                                                                          \
    TERM(FLICKER, flicker, 2)                                                                      \
    TERM(RANDOM_WALK, random_walk, 3)                                                              \
    TERM(GAUSS_MARKOV, gauss_markov, 4)                                                            \
    TERM(SINUSOID, sinusoid, 5)                                                                    \
    TERM(RESONANCE, resonance, 6)                                                                  \
    TERM(ANGLE_WHITE, angle_white, 14)                                                             \
    TERM(READING_NOISE, reading_noise, 15)

/** Term numbers of the random streams: imk_stream(run, term, instance, axis). Fixed for ever. */
enum {
    IMK_TERM_QUANTIZATION = 7,
    IMK_TERM_REPEATABILITY = 8,
    IMK_TERM_JITTER = 9,
    IMK_TERM_DROPS = 10,
    IMK_TERM_PHYSICS = 11,
    IMK_TERM_RESIDUAL = 12, /**< errors of known values left after calibration (drift.h) */
    IMK_TERM_INITIAL = 13,  /**< errors at the start of a navigation (drift.h) */
    IMK_TERM_AID = 16,      /**< errors of aids; the instance is their kind (simulate_log.h), or
                               their number (drift.h) */
    IMK_TERM_GRAVITY = 17,  /**< deflection of gravity along a path (drift.h) */
#define IMK_TERM_NUMBER(NAME, name, number) IMK_TERM_##NAME = number,
    IMK_NOISE_TERM_LIST(IMK_TERM_NUMBER)
#undef IMK_TERM_NUMBER
};

enum {
    IMK_NOISE_STEPS = 32, /**< samples of one segment */
    IMK_NOISE_BLOCK = 512 /**< samples the generators make at a time: 16 segments */
};

/** A buffer of samples generated but not yet given out. */
typedef struct imk_noise_block {
    size_t used; /**< samples of the block already given out; IMK_NOISE_BLOCK: all */
    double sample[IMK_NOISE_BLOCK];
} imk_noise_block;

/* ---- white noise: N [unit/sqrt(Hz)], two-sided density N^2 --------------------------------- */

/** N^2/tau [unit^2] of white noise of density N [unit/sqrt(Hz)]; tau [s]. */
IMK_API double imk_white_allan_variance(double density, double tau);
/** N^2/tau at tau = n dt, for samples that are means over dt [s]. */
IMK_API double imk_white_sampled_allan_variance(double density, double dt, size_t n);
/** N^2 at every frequency [unit^2/Hz]. */
IMK_API double imk_white_sampled_spectrum(double density, double dt, double frequency);

typedef struct imk_white_state {
    imk_random random;
    uint64_t stream, next; /**< next: index of the next normal random number */
    double sigma;          /**< N/sqrt(dt) */
    imk_noise_block block;
} imk_white_state;
/** Start at sample 0. @return IMK_ERROR_RANGE, IMK_ERROR_NOT_FINITE */
IMK_API imk_status imk_white_start(imk_white_state *state, double density, double dt,
                                   imk_random random, uint64_t stream);
/** Add the next `count` samples. */
IMK_API void imk_white_add(imk_white_state *state, size_t count, double *out);

/* ---- ARMA sequences -------------------------------------------------------------------------
 *
 *  y[k] = a1 y[k-1] + a2 y[k-2] + b0 e[k] + b1 e[k-1] + b2 e[k-2], e standard normal: the sampled
 *  form of a linear filter or resonance of first or second order. The poles are kept beside a1 and
 *  a2, which do not determine them accurately when they are close to 1. */

typedef struct imk_arma {
    double dt;
    double a1, a2, b0, b1, b2;
    double pole[2];     /**< the two poles if real, else twice their modulus */
    double distance[2]; /**< 1 - pole[], without cancellation */
    double angle;       /**< of the upper pole if they are complex, else 0 [rad] */
    double variance;    /**< of y */
    double decrement;   /**< variance minus the covariance of neighbours, without cancellation */
} imk_arma;

/** Two-sided spectrum dt |B/A|^2 [unit^2/Hz] of an ARMA sequence, 0 <= f <= 1/(2 dt), accurate even
 *  in a narrow resonance. Takes about 40 ns. */
IMK_API double imk_arma_spectrum(const imk_arma *arma, double frequency);

typedef struct imk_arma_state {
    imk_random random;
    uint64_t stream, next;
    double a1, a2, b0, b1, b2;
    double y1, y2, e1, e2;
    imk_noise_block block;
} imk_arma_state;

/** Start a sequence that is stationary from sample 0: the two samples and two innovations before it
 *  are drawn from their joint distribution. */
IMK_API imk_status imk_arma_start(imk_arma_state *state, const imk_arma *arma, imk_random random,
                                  uint64_t stream);
/** Add the next `count` samples. */
IMK_API void imk_arma_add(imk_arma_state *state, size_t count, double *out);

/* ---- white noise through the sensor's output filter ----------------------------------------
 *
 *  Continuous white noise of density N through  H(s) = w^2/(s^2 + 2 zeta w s + w^2)  (or first
 *  order w/(s + w)), averaged over each sample: exact at any bandwidth, also above Nyquist. It is
 *  an ARMA(2,2) sequence (first order: ARMA(1,1)), driven by one normal per sample. The mean of n
 *  samples is the mean over n dt, so its Allan variance does not depend on dt. */

/** An output filter of first or second order. */
typedef struct imk_low_pass {
    double bandwidth; /**< -3 dB bandwidth [Hz]; 0: no filter */
    double damping;   /**< damping ratio of a second-order filter, 0.05 … 50; 0: first order */
} imk_low_pass;

/** Allan variance at tau = n dt of the filtered noise. Relative error < 1e-9 for bandwidth *
 *  dt > 1e-5. Takes about 5 us. */
IMK_API double imk_filtered_white_sampled_allan_variance(double density, imk_low_pass filter,
                                                         double dt, size_t n);
/** Spectrum of the filtered noise. Every call designs the sequence anew (about 5 us); for many
 *  frequencies call imk_filtered_white_arma() once and imk_arma_spectrum() for each. */
IMK_API double imk_filtered_white_sampled_spectrum(double density, imk_low_pass filter, double dt,
                                                   double frequency);
/** Design the ARMA sequence of the filtered noise. @return IMK_ERROR_RANGE unless
 *  1e-6 <= bandwidth * dt <= 1e6 or bandwidth is 0 */
IMK_API imk_status imk_filtered_white_arma(double density, imk_low_pass filter, double dt,
                                           imk_arma *arma);
/** Start the filtered noise, stationary from sample 0; get samples by imk_arma_add(). @return
 *  errors of imk_filtered_white_arma() */
IMK_API imk_status imk_filtered_white_start(imk_arma_state *state, double density,
                                            imk_low_pass filter, double dt, imk_random random,
                                            uint64_t stream);

/* ---- flicker noise (bias instability): B [unit], S(f) = B^2/(2 pi f) ------------------------
 *
 *  down to f = 1/(2 pi T), flat below, at B^2 T. It is the sum of first-order stages [KESHNER1982],
 *  each of variance (ln 4/pi) B^2, whose correlation times are 0.85 T 4^-k, k = 0, 1 …, down to the
 *  last one of at least 1.5 dt; a further stage stands for all that are faster. So the noise does
 *  not depend on dt. Stages of 6 dt and more change only every 4, 16 … samples, at a moment drawn
 * at random, so that 2.33 normals a sample are enough and the sequence is still stationary. Its
 * Allan deviation is that of ideal flicker noise within 0.4 % from 2 dt to T/100, for every dt;
 * then it falls, by 1 % at 0.1 T and by 11 % at T; at dt it is 1 to 3 % too large. Its spectrum is
 * 0.89 … 1.04 times B^2/(2 pi f) from 10/T to 0.1/dt. Sample 0 has the variance of all stages: (2.2
 * B)^2 at 1 s, (2.5 B)^2 at 0.01 s for T = 1e6 s. Where T < 1.8 dt, samples are white noise of
 * density B^2 T. */

/** T of flicker noise where none is stated [s]. */
#define IMK_FLICKER_TIME 1e6

typedef struct imk_flicker {
    double instability;      /**< B [unit], >= 0 */
    double correlation_time; /**< T [s], > 0 and at most 6e18 dt; 0: IMK_FLICKER_TIME */
} imk_flicker;

/** The flat part of the Allan variance, (2 ln 2/pi) B^2 [unit^2]; the same at every tau. */
IMK_API double imk_flicker_allan_variance(double instability, double tau);
/** Exact for the generated stages. */
IMK_API double imk_flicker_sampled_allan_variance(imk_flicker flicker, double dt, size_t n);
/** Variance of the mean of n >= 1 samples [unit^2], not of its change; exact for the generated
 *  stages. It is what flicker noise makes of the bias from run to run, when each run is n dt long
 *  and begins anew. */
IMK_API double imk_flicker_mean_variance(imk_flicker flicker, double dt, size_t n);
/** Exact for the generated stages. */
IMK_API double imk_flicker_sampled_spectrum(imk_flicker flicker, double dt, double frequency);
/** Expected square, times dt, of cosine coefficient k (imk_cosine(), 1 <= k < n) of n samples: the
 *  spectrum at f = k/(2 n dt) less an effect of the ends of a finite record. The effect matters for
 *  processes that are correlated over the whole record: 22 % at k = 1, 1 % at k = 30. */
IMK_API double imk_flicker_cosine_spectrum(imk_flicker flicker, double dt, size_t n, size_t k);

/** Stages at most; the normals drawn at a time for stages 3 … 2 + IMK_FLICKER_AHEAD. */
enum { IMK_FLICKER_STAGES = 32, IMK_FLICKER_AHEAD = 6, IMK_FLICKER_BUFFER = 64 };
/** Stages are counted from the fastest. */
typedef struct imk_flicker_state {
    imk_random random;
    uint64_t stream; /**< stream of stage 0; stage j uses this number plus j in the instance bits */
    uint64_t next;   /**< next sample */
    uint64_t phase;  /**< stages j >= 2 change at samples k where 4^(j-1) divides k + phase */
    size_t stages;   /**< how many there are: 1 + log4(T/dt), about */
    double sigma;    /**< of every stage but the fastest */
    double innovation;                    /**< of stages 1 and slower, of unit variance */
    double fast_innovation;               /**< of stage 0 */
    double power[2][IMK_NOISE_STEPS + 1]; /**< phi^i of stages 0 and 1 */
    double fast[2];                       /**< stages 0 and 1, in units of their innovation */
    double value[IMK_FLICKER_STAGES];     /**< of the held stages, of unit variance */
    double above[IMK_FLICKER_STAGES + 1]; /**< sums of value[j] and slower stages */
    uint64_t changes[IMK_FLICKER_STAGES]; /**< of the held stages so far */
    double ahead[IMK_FLICKER_AHEAD][IMK_FLICKER_BUFFER]; /**< normals of stages 3 … */
    imk_noise_block block;
} imk_flicker_state;
/** Start flicker noise. It uses the streams of as many instances as it has stages, 32 at most:
 *  `stream` and the next ones. 21 are enough at 1 MHz for T = 1e6 s. @return IMK_ERROR_RANGE also
 *  for a correlation time below 0 or beyond 6e18 dt */
IMK_API imk_status imk_flicker_start(imk_flicker_state *state, imk_flicker flicker, double dt,
                                     imk_random random, uint64_t stream);
/** Add the next `count` samples. */
IMK_API void imk_flicker_add(imk_flicker_state *state, size_t count, double *out);

/* ---- random walk of the output: K [unit/sqrt(s)] -------------------------------------------- */

/** K^2 tau/3 [unit^2] of a random walk K [unit/sqrt(s)]. */
IMK_API double imk_random_walk_allan_variance(double k, double tau);
/** K^2 tau/3 (1 + 1/(2 n^2)) at tau = n dt, as the walk is point-sampled. */
IMK_API double imk_random_walk_sampled_allan_variance(double k, double dt, size_t n);
/** K^2 dt^2/(4 sin^2(pi f dt)). */
IMK_API double imk_random_walk_sampled_spectrum(double k, double dt, double frequency);

typedef struct imk_random_walk_state {
    imk_random random;
    uint64_t stream, next;
    double value; /**< in steps */
    double step;  /**< K sqrt(dt) [unit] */
    imk_noise_block block;
} imk_random_walk_state;
/** Start a random walk at 0: sample 0 is 0. */
IMK_API imk_status imk_random_walk_start(imk_random_walk_state *state, double k, double dt,
                                         imk_random random, uint64_t stream);
/** Add the next `count` samples. */
IMK_API void imk_random_walk_add(imk_random_walk_state *state, size_t count, double *out);

/* ---- ramp: R [unit/s], deterministic -------------------------------------------------------- */

/** R^2 tau^2/2 [unit^2] of a ramp of slope R [unit/s]. */
IMK_API double imk_ramp_allan_variance(double slope, double tau);
/** Add slope * dt * (first + i) to out[i]; `first` is the number of the first sample. */
IMK_API void imk_ramp_add(double slope, double dt, uint64_t first, size_t count, double *out);

/* ---- first-order Gauss-Markov --------------------------------------------------------------- */

typedef struct imk_gauss_markov {
    double sigma;            /**< stationary standard deviation [unit], >= 0 */
    double correlation_time; /**< [s], > 0 and finite */
} imk_gauss_markov;

/** 2 sigma^2 T/tau [1 - T/(2 tau) (3 - 4 e^(-tau/T) + e^(-2 tau/T))], by series for short tau. */
IMK_API double imk_gauss_markov_allan_variance(imk_gauss_markov process, double tau);
/** Allan variance at tau = n dt of the point-sampled process, an AR(1) sequence. */
IMK_API double imk_gauss_markov_sampled_allan_variance(imk_gauss_markov process, double dt,
                                                       size_t n);
/** Of the point-sampled process. */
IMK_API double imk_gauss_markov_sampled_spectrum(imk_gauss_markov process, double dt,
                                                 double frequency);
/** As imk_flicker_cosine_spectrum(), for a Gauss-Markov process; exact. */
IMK_API double imk_gauss_markov_cosine_spectrum(imk_gauss_markov process, double dt, size_t n,
                                                size_t k);

typedef struct imk_gauss_markov_state {
    imk_random random;
    uint64_t stream, next;
    double value;                      /**< in units of the innovation */
    double gain;                       /**< standard deviation of the innovation [unit] */
    double power[IMK_NOISE_STEPS + 1]; /**< phi^i */
    imk_noise_block block;
} imk_gauss_markov_state;
/** Stationary from sample 0. */
IMK_API imk_status imk_gauss_markov_start(imk_gauss_markov_state *state, imk_gauss_markov process,
                                          double dt, imk_random random, uint64_t stream);
/** Add the next `count` samples. */
IMK_API void imk_gauss_markov_add(imk_gauss_markov_state *state, size_t count, double *out);

/* ---- sinusoid of random phase --------------------------------------------------------------- */

typedef struct imk_sinusoid {
    double amplitude; /**< [unit] */
    double frequency; /**< [Hz], > 0 */
} imk_sinusoid;

/** a^2 (sin^2(pi f tau)/(pi f tau))^2 */
IMK_API double imk_sinusoid_allan_variance(imk_sinusoid sinusoid, double tau);
/** a^2 [sin^2(pi f tau)/(n sin(pi f dt))]^2, averaged over the phase. */
IMK_API double imk_sinusoid_sampled_allan_variance(imk_sinusoid sinusoid, double dt, size_t n);

typedef struct imk_sinusoid_state {
    double amplitude;
    uint64_t phase, step; /**< phase of the next sample, and its step per sample [2^-64 cycles] */
    double turn_sine[IMK_NOISE_STEPS], turn_cosine[IMK_NOISE_STEPS]; /**< of i steps */
    imk_noise_block block;
} imk_sinusoid_state;
/** Start a sinusoid at a random phase. The phase is counted in whole 2^-64 cycles, so it neither
 *  drifts nor repeats. */
IMK_API imk_status imk_sinusoid_start(imk_sinusoid_state *state, imk_sinusoid sinusoid, double dt,
                                      imk_random random, uint64_t stream);
/** Add the next `count` samples. */
IMK_API void imk_sinusoid_add(imk_sinusoid_state *state, size_t count, double *out);

/* ---- structural resonance: x'' + (w/Q) x' + w^2 x = white, point-sampled -------------------- */

typedef struct imk_resonance {
    double sigma;     /**< stationary standard deviation [unit] */
    double frequency; /**< undamped natural frequency [Hz], > 0 (above Nyquist it folds) */
    double q;         /**< quality factor, > 0.5, at most 1e6 */
} imk_resonance;

/** Allan variance of the continuous process. */
IMK_API double imk_resonance_allan_variance(imk_resonance resonance, double tau);
/** Of the point-sampled process. */
IMK_API double imk_resonance_sampled_allan_variance(imk_resonance resonance, double dt, size_t n);
/** Spectrum of the point-sampled process. Every call designs the sequence anew; for many
 *  frequencies see imk_resonance_arma(). */
IMK_API double imk_resonance_sampled_spectrum(imk_resonance resonance, double dt, double frequency);
/** Design the ARMA(2,1) sequence that describes the resonance exactly. @return IMK_ERROR_RANGE
 *  unless 1e-6 <= frequency * dt <= 1e6 */
IMK_API imk_status imk_resonance_arma(imk_resonance resonance, double dt, imk_arma *arma);
/** Stationary from sample 0; continue with imk_arma_add(). */
IMK_API imk_status imk_resonance_start(imk_arma_state *state, imk_resonance resonance, double dt,
                                       imk_random random, uint64_t stream);

/* ---- white noise of the integrated output: A [unit s/sqrt(Hz)], two-sided density A^2 ------- */

/** 3 A^2/(dt tau^2) [unit^2], for readings of the integral that are means over dt [s]. Unlike that
 *  of other terms it depends on the sample interval. */
IMK_API double imk_angle_white_allan_variance(double density, double dt, double tau);
/** 3 A^2/(dt tau^2) at tau = n dt, exact. */
IMK_API double imk_angle_white_sampled_allan_variance(double density, double dt, size_t n);
/** 4 A^2 sin^2(pi f dt)/dt^2, which is A^2 (2 pi f)^2 at low frequencies. */
IMK_API double imk_angle_white_sampled_spectrum(double density, double dt, double frequency);

typedef struct imk_angle_white_state {
    imk_random random;
    uint64_t stream, next;
    double last; /**< normal of the sample before */
    double step; /**< A/dt^1.5 [unit] */
    imk_noise_block block;
} imk_angle_white_state;
/** Start white noise of the integral: each reading of the integral has an independent error of 1
 *  sigma A/sqrt(dt), and a sample is the difference of two over dt. Readings with an error of 1
 *  sigma r whatever the rate are those of A = r sqrt(dt). */
IMK_API imk_status imk_angle_white_start(imk_angle_white_state *state, double density, double dt,
                                         imk_random random, uint64_t stream);
/** Add the next `count` samples. */
IMK_API void imk_angle_white_add(imk_angle_white_state *state, size_t count, double *out);

/* ---- quantization of the integrated output -------------------------------------------------- */

/** 3 Q^2/tau^2 [unit^2], for Q = LSB/sqrt(12) [unit s] and an input busy enough to make the
 *  rounding errors independent. */
IMK_API double imk_quantization_allan_variance(double q, double tau);
/** 3 Q^2/tau^2, exact for independent rounding errors of the integral. */
IMK_API double imk_quantization_sampled_allan_variance(double q, double dt, size_t n);
/** 4 Q^2 sin^2(pi f dt)/dt. */
IMK_API double imk_quantization_sampled_spectrum(double q, double dt, double frequency);

typedef struct imk_quantization_state {
    double lsb; /**< of the integral: Q sqrt(12) [unit s] */
    double dt;
    double residual;     /**< of the integral at the last segment's end; |residual| <= lsb/2 */
    double sum, counted; /**< since that end: integral without the residual, and steps given out */
    uint64_t next;       /**< next sample */
} imk_quantization_state;
/** Start quantization; the first residual is drawn uniformly from the stream. */
IMK_API imk_status imk_quantization_start(imk_quantization_state *state, double q, double dt,
                                          imk_random random, uint64_t stream);
/** Replace the rates in `out` by quantised increments divided by dt; the residual is carried over,
 *  so no rate is ever lost. Apply it last, to the sum of all other terms. */
IMK_API void imk_quantization_apply(imk_quantization_state *state, size_t count, double *out);

IMK_END_C
#endif
