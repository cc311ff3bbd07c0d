/* SPDX-License-Identifier: Apache-2.0 */
/* What the generators share: blocks of 512 samples in segment order, and the loops over them.
 *
 * A recursion y[k] = phi y[k-1] + n[k] done one sample after another waits for each multiplication
 * and addition. A block is therefore cut into 16 segments of 32 samples; all segments advance
 * together, as lanes of vector registers, each from zero; then the true value at each segment's
 * start is carried from segment to segment and its decay added. In segment order, element
 * 16 i + s is step i of segment s, that is sample 32 s + i. The order of operations is fixed by
 * this, not by the instruction set. */
#ifndef IMUKIT_GENERATOR_INTERNAL_H
#define IMUKIT_GENERATOR_INTERNAL_H

#include "base/random/normals_internal.h"
#include "imukit/elementary.h"
#include "imukit/noise.h"

#include <math.h>
#include <stdbool.h>

enum { IMKI_SEGMENTS = IMK_NOISE_BLOCK / IMK_NOISE_STEPS };

/* Normals and blocks on the stack: a vector across two lines of the cache costs two accesses. */
#define IMKI_ALIGNED _Alignas(64)

#define IMKI_PI 3.141592653589793
#define IMKI_START_NORMAL                                                                          \
    ((uint64_t)1 << 63)                     /* normals for starting values: never reached by k     \
                                             */
#define IMKI_START_WORD ((uint64_t)3 << 62) /* words for starting phases: blocks of their own */

/* Element of sample 0 … 511 in a block in segment order. */
static inline size_t imki_place(size_t sample)
{
    return sample % IMK_NOISE_STEPS * IMKI_SEGMENTS + sample / IMK_NOISE_STEPS;
}

/* Nearest whole number for |x| < 2^51, ties to even, without a call: adding 1.5 * 2^52 leaves no
 * room for a fraction. */
static inline double imki_round(double x)
{
    const double shift = 0x1.8p52;
    return (x + shift) - shift;
}

/* 0 within +-dead_band, and no further than +-range (0 and infinity: none). */
static inline double imki_saturated(double x, double dead_band, double range)
{
    const double size = x < 0.0 ? -x : x;
    x = size < dead_band ? 0.0 : x;
    x = x < -range ? -range : x;
    return x > range ? range : x;
}

/* The steps of quantization.c. */
typedef struct imki_quantizer {
    double lsb, dt, per_step, rate_step;
} imki_quantizer;

static inline imki_quantizer imki_quantizer_of(double lsb, double dt)
{
    return (imki_quantizer){lsb, dt, 1.0 / lsb, lsb / dt};
}

/* One sample, the last of a segment (`end`) or another; residual, sum and counted as in
 * imk_quantization_state. What is not finite is passed on, and adds nothing to the integral. */
static inline double imki_quantized(const imki_quantizer *q, bool end, double x, double *residual,
                                    double *sum, double *counted)
{
    const bool finite = x - x == 0.0;
    const double now = *sum + (finite ? x : 0.0) * q->dt, integral = *residual + now;
    const double steps = imki_round(integral * q->per_step);
    const double y = (steps - *counted) * q->rate_step;
    *residual = end ? integral - steps * q->lsb : *residual;
    *sum = end ? 0.0 : now;
    *counted = end ? 0.0 : steps;
    return finite ? y : x;
}

/* |sin(pi c)| of c cycles: c is reduced exactly to +-1/2 first. */
static inline double imki_sin_half_turns(double c)
{
    double rest = c - floor(c + 0.5);
    return imk_sin(IMKI_PI * fabs(rest));
}

/* [rad] of a count of 2^-64 cycles, between -pi and pi. */
static inline double imki_angle(uint64_t count)
{
    double turns = count < (uint64_t)1 << 63 ? (double)count : -(double)(~count + 1);
    return 2.0 * IMKI_PI * (turns * 0x1p-64);
}

/* A strength that must be finite and >= 0, and the sample interval. */
imk_status imki_check_noise(double strength, double dt);

/* power[i] = phi^i, i = 0 … IMK_NOISE_STEPS. */
void imki_powers(double phi, double *power);

/* Hand out `count` samples: what is left of the block, then new blocks. `next` adds the next 512
 * samples, in segment order. */
void imki_add_blocks(imk_noise_block *block, void (*next)(void *state, double *block), void *state,
                     size_t count, double *out);

/* ---- loops over a block, by instruction set (segment_loops.c); all give the same bits ---- */

/* block += scale * normals */
void imki_add_scaled(imk_kernel kernel, double scale, const double *normals, double *block);
/* block += per_sample k, k = first … first + 511 */
void imki_add_ramp(imk_kernel kernel, double per_sample, uint64_t first, double *block);
/* A sine that turns: phase of sample 0 and step per sample in 2^-64 cycles, and sine and cosine of
 * i steps. */
typedef struct imki_turning {
    double amplitude;
    uint64_t phase, step;
    const double *turn_sine, *turn_cosine; /* i = 0 … IMK_NOISE_STEPS - 1 */
} imki_turning;
/* block += amplitude sin phase[k] */
void imki_add_sinusoid(imk_kernel kernel, const imki_turning *turning, double *block);
/* Sequences y[k] = a1 y[k-1] + a2 y[k-2] + b0 e[k] + b1 e[k-1] + b2 e[k-2], one to a lane: each
 * alone waits for its own sums, and its bits allow no cutting into segments. Lanes from `count` on
 * are computed and thrown away. */
enum { IMKI_ARMA_LANES = 8 };
typedef struct imki_arma_lanes {
    double a1[IMKI_ARMA_LANES], a2[IMKI_ARMA_LANES];
    double b0[IMKI_ARMA_LANES], b1[IMKI_ARMA_LANES], b2[IMKI_ARMA_LANES];
    double y1[IMKI_ARMA_LANES], y2[IMKI_ARMA_LANES], e1[IMKI_ARMA_LANES], e2[IMKI_ARMA_LANES];
    const double *normals[IMKI_ARMA_LANES]; /* of this half, in time order */
    double *block[IMKI_ARMA_LANES];
    size_t count;
} imki_arma_lanes;
/* block += y of 256 samples, the first half of each block (half = 0) or the second (1) */
void imki_add_arma(imk_kernel kernel, imki_arma_lanes *lanes, size_t half);
/* One of several recursions that run together, because each alone waits for its own sums:
 * y[k] = phi y[k-1] + n[k]. */
typedef struct imki_recursion {
    double gain;
    const double *power; /* phi^i, i = 0 … IMK_NOISE_STEPS */
    double *normals;     /* n of this block; overwritten */
    double *value;       /* the last y of the block before, then of this one */
} imki_recursion;
/* block += gain y of each, in this order */
void imki_add_recursions(imk_kernel kernel, const imki_recursion *recursions, size_t count,
                         double *block);
/* block += gain y,  y[k+1] = y[k] + n[k];  *value is y[0] of this block, then of the next */
void imki_add_sums(imk_kernel kernel, double gain, const double *normals, double *value,
                   double *block);
/* Replace rates by quantised ones (quantization.c); *residual is carried. */
void imki_quantize(imk_kernel kernel, double lsb, double dt, double *residual, double *block);
/* imki_saturated() of each element */
void imki_saturate(imk_kernel kernel, double dead_band, double range, double *block);
/* Two recursions as above, and the changes of a held stage: change[k] = phi change[k-1] + change[k]
 * with the phi of the second one, change[-1] being `held`. */
enum { IMKI_FLICKER_CHANGES = IMK_NOISE_BLOCK / 4 };
void imki_add_flicker(imk_kernel kernel, const imki_recursion recursions[2], double held,
                      double *change, double *block);
/* Add values that stay for 4 samples: held[0] ends after 4 - offset samples, 0 <= offset < 4; the
 * block takes IMK_NOISE_BLOCK/4 of them, and one more if offset > 0. */
void imki_add_held(imk_kernel kernel, const double *held, size_t offset, double *block);
/* out = block in time order */
void imki_to_time_order(imk_kernel kernel, const double *block, double *out);
/* the reverse */
void imki_to_segment_order(imk_kernel kernel, const double *samples, double *block);
/* Eight blocks side by side: sample k of block i becomes out[k * stride + i]. */
enum { IMKI_INTERLEAVED = 8 };
void imki_interleave(imk_kernel kernel, const double *const *blocks, double *out, size_t stride);

enum { IMKI_FLICKER_NORMALS = 2 * IMK_NOISE_BLOCK + IMKI_FLICKER_CHANGES };

/* count <= IMKI_ARMA_LANES sequences of one seed, each adding 512 samples in segment order to a
 * block of its own. */
void imki_arma_blocks(imk_arma_state *const *states, size_t count, double *const *blocks);
/* The same of any number of states, imk_arma_state each. */
void imki_arma_across(void *const *states, size_t count, double *const *blocks);
/* Applies to a block, instead of adding. Not to be mixed with imk_quantization_apply() within a
 * block. */
void imki_quantization_block(imk_quantization_state *state, imk_kernel kernel, double *block);

/* What the ends of a record of n samples take from the expected square of cosine coefficient k of a
 * Gauss-Markov sequence of unit variance, x = dt/T. */
double imki_cosine_end_loss(double x, size_t n, size_t k);

#endif
