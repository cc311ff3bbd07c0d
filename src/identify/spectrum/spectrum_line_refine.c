/* SPDX-License-Identifier: Apache-2.0 */
/* A sinusoid in the whole record, near a peak of its spectrum.
 *
 * The record is turned back by the peak's frequency and summed over blocks shorter than the
 * spectrum's segments; the few block sums z_b are then searched for the frequency offset d that
 * makes |sum_b w_b z_b exp(-2 pi i d t_b)| largest, which is least squares. Weights w taper the
 * ends so that slow noise does not leak in. For noise of density S about the line, with weights w_i
 * at times t_i = i dt [RIFE1974] (there w = 1):
 *
 *     var a = 2 (S/dt) sum w^2/(sum w)^2
 *     var f = 2 (S/dt)/a^2 sum w^2 t^2/(sum w t^2)^2/(2 pi)^2        t from the weighted middle
 */
#include "identify/likelihood/identify_internal.h"
#include "spectrum_internal.h"

#include "imukit/elementary.h"
#include "imukit/fourier.h"

#include <math.h>

static const double TURN = 6.283185307179586477;
/* A sinusoid must hold this much of the peak's power; a wandering line gives it a small part. */
static const double COHERENT_SHARE = 0.6;
/* A tenth of the record at either end rises as sin^2. */
static const double TAPER = 0.1;
enum { SECTIONS = 44 }; /* of a golden-section search: to 1e-9 of a bin */

size_t imki_tone_lay_out(const imk_spectrum *spectrum, size_t n, double *memory, imki_tone *tone)
{
    tone->n = n;
    tone->dt = spectrum->dt;
    tone->block = spectrum->length / 8 > 1 ? spectrum->length / 8 : 1;
    tone->count = n / tone->block;
    tone->padded = 2;
    while (tone->padded < 2 * tone->count)
        tone->padded *= 2;
    tone->re = memory;
    tone->im = memory ? memory + tone->count : NULL;
    tone->weight = memory ? memory + 2 * tone->count : NULL;
    tone->transform = memory ? memory + 3 * tone->count : NULL;
    tone->scratch = memory ? tone->transform + 2 * tone->padded : NULL;
    tone->scratch_size = imk_fourier_workspace_size(tone->padded);
    return (3 * tone->count + 2 * tone->padded) * sizeof(double) + tone->scratch_size;
}

/* Sums of samples times exp(-2 pi i f t) over the blocks. The phasor is set anew every 64 samples
 * so that its rounding does not grow. Missing samples count as none. */
static void demodulate(imki_tone *tone, double mean, double cycles)
{
    enum { RESET = 64 };
    const double cosine = imk_cos(TURN * cycles), sine = imk_sin(TURN * cycles);
    for (size_t b = 0; b < tone->count; b++) {
        double re = 0, im = 0, used = 0, c = 1, s = 0;
        for (size_t i = 0; i < tone->block; i++) {
            const size_t at = b * tone->block + i;
            if (i % RESET == 0) {
                const double turns = cycles * (double)at;
                c = imk_cos(TURN * (turns - floor(turns)));
                s = imk_sin(TURN * (turns - floor(turns)));
            }
            const double x = tone->samples[at] - mean;
            if (x - x == 0) {
                re += x * c;
                im -= x * s;
                used += 1;
            }
            const double next = c * cosine - s * sine;
            s = c * sine + s * cosine;
            c = next;
        }
        const double place = ((double)b + 0.5) / (double)tone->count;
        const double edge = fmin(1, fmin(place, 1 - place) / TAPER);
        const double rise = imk_sin(0.25 * TURN * edge);
        tone->re[b] = re * rise * rise;
        tone->im[b] = im * rise * rise;
        tone->weight[b] = used * rise * rise;
    }
}

/* Sum of the blocks turned back by `offset` cycles per block. */
static double turned_sum(const imki_tone *tone, double offset, double *re, double *im)
{
    const double cosine = imk_cos(TURN * offset), sine = imk_sin(TURN * offset);
    double c = 1, s = 0;
    *re = *im = 0;
    for (size_t b = 0; b < tone->count; b++) {
        if (b % 64 == 0) {
            const double turns = offset * (double)b;
            c = imk_cos(TURN * (turns - floor(turns)));
            s = imk_sin(TURN * (turns - floor(turns)));
        }
        *re += tone->re[b] * c + tone->im[b] * s;
        *im += tone->im[b] * c - tone->re[b] * s;
        const double next = c * cosine - s * sine;
        s = c * sine + s * cosine;
        c = next;
    }
    return *re * *re + *im * *im;
}

static double height(void *context, double offset)
{
    double re, im;
    return turned_sum(context, offset, &re, &im);
}

/* Offset of the highest sum within `reach` [cycles per block]: the highest bin of a transform at
 * least twice as fine as the record resolves, then between its neighbours. */
static double best_offset(imki_tone *tone, double reach)
{
    const size_t size = tone->padded;
    for (size_t b = 0; b < size; b++) {
        tone->transform[2 * b] = b < tone->count ? tone->re[b] : 0;
        tone->transform[2 * b + 1] = b < tone->count ? tone->im[b] : 0;
    }
    if (imk_fourier(size, tone->transform, 0, tone->scratch, tone->scratch_size) != IMK_OK)
        return 0;
    double best = 0, highest = -1;
    for (size_t j = 0; j < size; j++) {
        const double offset = ((double)j - (2 * j < size ? 0 : (double)size)) / (double)size;
        const double re = tone->transform[2 * j], im = tone->transform[2 * j + 1];
        if (fabs(offset) <= reach && re * re + im * im > highest) {
            highest = re * re + im * im;
            best = offset;
        }
    }
    const double step = 1 / (double)size;
    return imki_peak(height, tone, best - step, best + step, SECTIONS);
}

void imki_line_refine(const imk_spectrum *spectrum, imki_tone *tone, imk_spectrum_line *line)
{
    const double block_time = (double)tone->block * tone->dt;
    if (tone->count < 8)
        return;
    demodulate(tone, spectrum->mean, line->frequency * tone->dt);
    const double reach = fmin(0.45, 1.5 * spectrum->noise_bandwidth * block_time);
    const double offset = best_offset(tone, reach);
    double re, im, sum = 0, squares = 0, first = 0;
    turned_sum(tone, offset, &re, &im);
    for (size_t b = 0; b < tone->count; b++) {
        const double samples = (double)tone->block, w = tone->weight[b] / samples;
        sum += tone->weight[b];
        squares += w * tone->weight[b];
        first += tone->weight[b] * (double)b;
    }
    const double middle = first / sum;
    double moment = 0, spread = 0;
    for (size_t b = 0; b < tone->count; b++) {
        const double t = ((double)b - middle) * block_time, w = tone->weight[b];
        moment += w * t * t;
        spread += w * w / (double)tone->block * t * t;
    }
    /* Within a block the turn goes on: its sum is smaller by sinc(offset). */
    const double angle = 0.5 * TURN * offset;
    const double loss = fabs(angle) > 1e-9 ? imk_sin(angle) / angle : 1;
    const double amplitude = 2 * sqrt(re * re + im * im) / (sum * loss);
    if (amplitude * amplitude < COHERENT_SHARE * line->amplitude * line->amplitude)
        return;
    const double noise = 2 * line->level / tone->dt;
    line->coherent = true;
    line->width = 0;
    line->frequency += offset / block_time;
    line->amplitude = amplitude;
    line->amplitude_sigma = sqrt(noise * squares) / sum;
    line->frequency_sigma = sqrt(noise * spread) / (amplitude * moment * TURN);
    /* The sums refer to the first sample of the first block, the offset's turn to its middle. */
    line->phase = imk_atan2(im, re) - angle * (1 - 1 / (double)tone->block);
}
