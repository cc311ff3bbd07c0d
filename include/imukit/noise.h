/* SPDX-License-Identifier: Apache-2.0 */
/** @file noise.h
 *  The stochastic terms: for each its Allan variance, its spectrum, and its generator.
 *
 *  Three views of a term are kept apart, because mixing them up is the commonest error of the
 * field:
 *   - `imk_<term>_allan_variance(…, tau)`: the continuous-time closed form [IEEE952];
 *   - `imk_<term>_sampled_allan_variance(…, dt, n)`: exact for the sequence the generator makes, at
 *     tau = n dt, n >= 1;
 *   - `imk_<term>_sampled_spectrum(…, dt, f)`: two-sided power spectral density [unit^2/Hz] of that
 *     sequence, 0 < f <= 1/(2 dt); the integral over (-1/2dt, 1/2dt) is its variance. For terms
 *     that are not stationary it is the spectrum seen by a cosine transform of the sequence.
 *
 *  Generators add `count` samples to `out`. Sample k of a term depends on the random source, its
 *  stream and k only: blocks may have any size, but must be asked for in order. Their state is
 *  plain data: copying it forks the sequence. All use + - * / sqrt and elementary.h only. */
#ifndef IMUKIT_NOISE_H
#define IMUKIT_NOISE_H

#include "imukit/random.h"
#include "imukit/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Term numbers of the random streams: imk_stream(run, term, instance, axis). Fixed for ever. */
enum {
    IMK_TERM_WHITE = 1,
    IMK_TERM_FLICKER = 2,
    IMK_TERM_RANDOM_WALK = 3,
    IMK_TERM_GAUSS_MARKOV = 4,
    IMK_TERM_SINUSOID = 5,
    IMK_TERM_RESONANCE = 6,
    IMK_TERM_QUANTIZATION = 7,
    IMK_TERM_REPEATABILITY = 8
};

/* ---- white noise: N [unit/sqrt(Hz)], two-sided density N^2 --------------------------------- */

/** N^2/tau */
IMK_API double imk_white_allan_variance(double density, double tau);
IMK_API double imk_white_sampled_allan_variance(double density, double dt, size_t n);
IMK_API double imk_white_sampled_spectrum(double density, double dt, double frequency);

typedef struct imk_white_state {
    imk_random random;
    uint64_t stream, next;
    double sigma; /**< N/sqrt(dt) */
} imk_white_state;
IMK_API imk_status imk_white_start(imk_white_state *state, double density, double dt,
                                   imk_random random, uint64_t stream);
IMK_API void imk_white_add(imk_white_state *state, size_t count, double *out);

/* ---- white noise through the sensor's output filter ----------------------------------------
 *
 *  Continuous white noise of density N through  H(s) = w^2/(s^2 + 2 zeta w s + w^2)  (or first
 * order w/(s + w)), averaged over each sample: exact at any bandwidth, also above Nyquist. It is an
 *  ARMA(2,2) sequence (first order: ARMA(1,1)), driven by one normal per sample. */

/** The filter: -3 dB bandwidth [Hz]; damping > 0 for second order, 0 for first order. */
typedef struct imk_low_pass {
    double bandwidth; /**< [Hz] of the -3 dB point; 0: no filter */
    double damping;   /**< second order's damping ratio, 0.05 … 50; 0: first order */
} imk_low_pass;

IMK_API double imk_filtered_white_sampled_allan_variance(double density, imk_low_pass filter,
                                                         double dt, size_t n);
IMK_API double imk_filtered_white_sampled_spectrum(double density, imk_low_pass filter, double dt,
                                                   double frequency);

/** An ARMA(2,2) sequence y[k] = a1 y[k-1] + a2 y[k-2] + b0 e[k] + b1 e[k-1] + b2 e[k-2]. */
typedef struct imk_arma_state {
    imk_random random;
    uint64_t stream, next;
    double a1, a2, b0, b1, b2;
    double y1, y2, e1, e2;
} imk_arma_state;
IMK_API imk_status imk_filtered_white_start(imk_arma_state *state, double density,
                                            imk_low_pass filter, double dt, imk_random random,
                                            uint64_t stream);
IMK_API void imk_arma_add(imk_arma_state *state, size_t count, double *out);

/* ---- flicker noise (bias instability): B [unit], S(f) = B^2/(2 pi f) ------------------------ */

/** The flat part, (2 ln 2/pi) B^2. */
IMK_API double imk_flicker_allan_variance(double instability, double tau);
IMK_API double imk_flicker_sampled_allan_variance(double instability, double dt, size_t n);
IMK_API double imk_flicker_sampled_spectrum(double instability, double dt, double frequency);

enum { IMK_FLICKER_STAGES = 16 };
typedef struct imk_flicker_state {
    imk_random random;
    uint64_t stream[IMK_FLICKER_STAGES], next;
    double value[IMK_FLICKER_STAGES];
    double phi[IMK_FLICKER_STAGES];
    double q[IMK_FLICKER_STAGES];
} imk_flicker_state;
IMK_API imk_status imk_flicker_start(imk_flicker_state *state, double instability, double dt,
                                     imk_random random, uint64_t stream);
IMK_API void imk_flicker_add(imk_flicker_state *state, size_t count, double *out);

/* ---- random walk of the output: K [unit/sqrt(s)] -------------------------------------------- */

/** K^2 tau/3 */
IMK_API double imk_random_walk_allan_variance(double k, double tau);
IMK_API double imk_random_walk_sampled_allan_variance(double k, double dt, size_t n);
IMK_API double imk_random_walk_sampled_spectrum(double k, double dt, double frequency);

typedef struct imk_random_walk_state {
    imk_random random;
    uint64_t stream, next;
    double value, step; /**< K sqrt(dt) */
} imk_random_walk_state;
/** Starts at 0: sample 0 is 0. */
IMK_API imk_status imk_random_walk_start(imk_random_walk_state *state, double k, double dt,
                                         imk_random random, uint64_t stream);
IMK_API void imk_random_walk_add(imk_random_walk_state *state, size_t count, double *out);

/* ---- ramp: R [unit/s], deterministic -------------------------------------------------------- */

/** R^2 tau^2/2 */
IMK_API double imk_ramp_allan_variance(double slope, double tau);
/** Add slope * dt * (first + i) to out[i]. */
IMK_API void imk_ramp_add(double slope, double dt, uint64_t first, size_t count, double *out);

/* ---- first-order Gauss-Markov --------------------------------------------------------------- */

typedef struct imk_gauss_markov {
    double sigma;            /**< stationary standard deviation [unit], >= 0 */
    double correlation_time; /**< [s], > 0 and finite */
} imk_gauss_markov;

IMK_API double imk_gauss_markov_allan_variance(imk_gauss_markov process, double tau);
IMK_API double imk_gauss_markov_sampled_allan_variance(imk_gauss_markov process, double dt,
                                                       size_t n);
IMK_API double imk_gauss_markov_sampled_spectrum(imk_gauss_markov process, double dt,
                                                 double frequency);

typedef struct imk_gauss_markov_state {
    imk_random random;
    uint64_t stream, next;
    double value, phi, q;
} imk_gauss_markov_state;
/** Stationary from sample 0. */
IMK_API imk_status imk_gauss_markov_start(imk_gauss_markov_state *state, imk_gauss_markov process,
                                          double dt, imk_random random, uint64_t stream);
IMK_API void imk_gauss_markov_add(imk_gauss_markov_state *state, size_t count, double *out);

/* ---- sinusoid of random phase --------------------------------------------------------------- */

typedef struct imk_sinusoid {
    double amplitude; /**< [unit] */
    double frequency; /**< [Hz], > 0 */
} imk_sinusoid;

/** a^2 (sin^2(pi f tau)/(pi f tau))^2 */
IMK_API double imk_sinusoid_allan_variance(imk_sinusoid sinusoid, double tau);
IMK_API double imk_sinusoid_sampled_allan_variance(imk_sinusoid sinusoid, double dt, size_t n);

typedef struct imk_sinusoid_state {
    double amplitude, phase, cycles_per_sample;
    uint64_t next;
} imk_sinusoid_state;
IMK_API imk_status imk_sinusoid_start(imk_sinusoid_state *state, imk_sinusoid sinusoid, double dt,
                                      imk_random random, uint64_t stream);
IMK_API void imk_sinusoid_add(imk_sinusoid_state *state, size_t count, double *out);

/* ---- structural resonance: x'' + (w/Q) x' + w^2 x = white, point-sampled -------------------- */

typedef struct imk_resonance {
    double sigma;     /**< stationary standard deviation [unit] */
    double frequency; /**< undamped natural frequency [Hz], > 0 (above Nyquist it folds) */
    double q;         /**< quality factor, > 0.5 */
} imk_resonance;

IMK_API double imk_resonance_allan_variance(imk_resonance resonance, double tau);
IMK_API double imk_resonance_sampled_allan_variance(imk_resonance resonance, double dt, size_t n);
IMK_API double imk_resonance_sampled_spectrum(imk_resonance resonance, double dt, double frequency);
/** Exact ARMA(2,1), stationary from sample 0; continue with imk_arma_add(). */
IMK_API imk_status imk_resonance_start(imk_arma_state *state, imk_resonance resonance, double dt,
                                       imk_random random, uint64_t stream);

/* ---- quantization of the integrated output -------------------------------------------------- */

/** 3 Q^2/tau^2, for Q = LSB/sqrt(12) [unit s] and a busy input. */
IMK_API double imk_quantization_allan_variance(double q, double tau);
IMK_API double imk_quantization_sampled_allan_variance(double q, double dt, size_t n);
IMK_API double imk_quantization_sampled_spectrum(double q, double dt, double frequency);

typedef struct imk_quantization_state {
    double lsb; /**< of the integral: Q sqrt(12) [unit s] */
    double dt;
    double residual; /**< of the integral, carried; |residual| <= lsb/2 */
} imk_quantization_state;
/** The residual starts uniform, drawn from the stream. */
IMK_API imk_status imk_quantization_start(imk_quantization_state *state, double q, double dt,
                                          imk_random random, uint64_t stream);
/** Replace the rates in `out` by quantised increments divided by dt; the residual is carried, so no
 *  rate is ever lost. Applies to the sum of everything else, last. */
IMK_API void imk_quantization_apply(imk_quantization_state *state, size_t count, double *out);

#ifdef __cplusplus
}
#endif
#endif
