/* SPDX-License-Identifier: Apache-2.0 */
/* Records of known noise, made by the library's generators, and the bound of Cramer and Rao on what
 * can be estimated from them. */
#ifndef IMUKIT_NOISE_RECORD_H
#define IMUKIT_NOISE_RECORD_H

#include "imukit/imukit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { TIMES = 2, RESONANCES = 3, PARAMETERS = IMK_NOISE_TERMS + 2 * TIMES };

typedef struct truth {
    const char *name;
    double rate;
    double term[IMK_NOISE_TERMS]; /* Q N B K R */
    imk_gauss_markov gauss_markov[TIMES];
    imk_sinusoid line;
    imk_resonance resonance[RESONANCES];
    imk_low_pass filter;
    size_t samples;
    double step;       /* values are rounded to it */
    double angle_step; /* their sum times dt is rounded to it */
    double mean;       /* of the record */
    bool fractional;   /* flicker noise by fractional differences, not by the library */
} truth;

/* Rounding errors as they are in theory, independent from sample to sample. (Rounding the record
 * itself makes them so only where the noise of one sample exceeds the step.) */
static void add_quantization(const truth *t, imk_random random, uint64_t stream, double *x)
{
    const double q = t->term[IMK_NOISE_QUANTIZATION] * t->rate;
    double error[1024], before;
    imk_random_normals(random, stream, 0, 1, &before);
    for (size_t i = 0; q > 0 && i < t->samples; i++) {
        if (i % 1024 == 0)
            imk_random_normals(random, stream, 16 + i, 1024, error);
        x[i] += q * (error[i % 1024] - before);
        before = error[i % 1024];
    }
}

/* S = B^2 dt/(2 sin(pi f dt)): white noise of B^2 per sample, differenced -1/2 times [HOSKING1981],
 * with the weights h_k = h_k-1 (k - 1/2)/k of as many samples before the record as in it. */
static void add_fractional_flicker(const truth *t, imk_random random, uint64_t stream, double *x)
{
    size_t n = 1;
    while (n < 2 * t->samples)
        n *= 2;
    const size_t padded = 2 * n, size = imk_fourier_workspace_size(padded);
    double *a = calloc(2 * padded, sizeof *a), *h = calloc(2 * padded, sizeof *h);
    double *normals = malloc(n * sizeof *normals);
    void *workspace = malloc(size);
    imk_random_normals(random, stream, 0, n, normals);
    for (size_t k = 0; k < n; k++) {
        a[2 * k] = t->term[IMK_NOISE_BIAS_INSTABILITY] * normals[k];
        h[2 * k] = k == 0 ? 1 : h[2 * k - 2] * ((double)k - 0.5) / (double)k;
    }
    imk_fourier(padded, a, 0, workspace, size);
    imk_fourier(padded, h, 0, workspace, size);
    for (size_t k = 0; k < padded; k++) {
        const double real = a[2 * k] * h[2 * k] - a[2 * k + 1] * h[2 * k + 1];
        a[2 * k + 1] = a[2 * k] * h[2 * k + 1] + a[2 * k + 1] * h[2 * k];
        a[2 * k] = real;
    }
    imk_fourier(padded, a, 1, workspace, size);
    for (size_t i = 0; i < t->samples; i++)
        x[i] += a[2 * (n - t->samples + i)];
    free(a), free(h), free(normals), free(workspace);
}

/* The output is the growth of the angle in whole steps. */
static void round_angle(const truth *t, double *x)
{
    double angle = 0, before = 0;
    for (size_t i = 0; i < t->samples; i++) {
        angle += x[i] / t->rate;
        const double steps = floor(angle / t->angle_step + 0.5);
        x[i] = (steps - before) * t->angle_step * t->rate;
        before = steps;
    }
}

static void make_record(const truth *t, uint64_t seed, uint64_t record, double *x)
{
    const imk_random random = imk_random_seeded(seed);
    const uint64_t stream = record << 20;
    const double dt = 1 / t->rate;
    memset(x, 0, t->samples * sizeof *x);
    imk_arma_state arma;
    imk_white_state white;
    if (t->filter.bandwidth > 0 &&
        imk_filtered_white_start(&arma, t->term[IMK_NOISE_WHITE], t->filter, dt, random,
                                 stream + 1) == IMK_OK)
        imk_arma_add(&arma, t->samples, x);
    else if (imk_white_start(&white, t->term[IMK_NOISE_WHITE], dt, random, stream + 1) == IMK_OK)
        imk_white_add(&white, t->samples, x);
    imk_flicker_state flicker;
    if (t->fractional)
        add_fractional_flicker(t, random, stream + 2, x);
    else if (t->term[IMK_NOISE_BIAS_INSTABILITY] > 0 &&
             imk_flicker_start(&flicker, (imk_flicker){t->term[IMK_NOISE_BIAS_INSTABILITY], 0}, dt,
                               random, stream + 2) == IMK_OK)
        imk_flicker_add(&flicker, t->samples, x);
    imk_random_walk_state walk;
    if (imk_random_walk_start(&walk, t->term[IMK_NOISE_RANDOM_WALK], dt, random, stream + 3) ==
        IMK_OK)
        imk_random_walk_add(&walk, t->samples, x);
    for (size_t i = 0; i < TIMES; i++) {
        imk_gauss_markov_state gauss_markov;
        if (t->gauss_markov[i].sigma > 0 &&
            imk_gauss_markov_start(&gauss_markov, t->gauss_markov[i], dt, random,
                                   stream + 64 + i) == IMK_OK)
            imk_gauss_markov_add(&gauss_markov, t->samples, x);
    }
    for (size_t i = 0; i < RESONANCES; i++)
        if (t->resonance[i].sigma > 0 &&
            imk_resonance_start(&arma, t->resonance[i], dt, random, stream + 80 + i) == IMK_OK)
            imk_arma_add(&arma, t->samples, x);
    imk_sinusoid_state sinusoid;
    if (t->line.amplitude > 0 &&
        imk_sinusoid_start(&sinusoid, t->line, dt, random, stream + 6) == IMK_OK)
        imk_sinusoid_add(&sinusoid, t->samples, x);
    imk_ramp_add(t->term[IMK_NOISE_RAMP], dt, 0, t->samples, x);
    add_quantization(t, random, stream + 7, x);
    for (size_t i = 0; t->mean != 0 && i < t->samples; i++)
        x[i] += t->mean;
    for (size_t i = 0; t->step > 0 && i < t->samples; i++)
        x[i] = t->step * floor(x[i] / t->step + 0.5);
    if (t->angle_step > 0)
        round_angle(t, x);
}

/* Expected power of coefficient k for the parameters p: amounts of Q N B K, then sigma^2 and log T
 * of the Gauss-Markov terms. */
static double expected(const truth *t, const double *p, size_t k)
{
    const double dt = 1 / t->rate, f = (double)k / (2.0 * (double)t->samples * dt);
    double s = p[0] * imk_quantization_sampled_spectrum(1, dt, f) +
               p[2] * imk_flicker_cosine_spectrum((imk_flicker){1, 0}, dt, t->samples, k) +
               p[3] * imk_random_walk_sampled_spectrum(1, dt, f);
    imk_arma arma;
    if (t->filter.bandwidth > 0 && imk_filtered_white_arma(1, t->filter, dt, &arma) == IMK_OK)
        s += p[1] * imk_arma_spectrum(&arma, f);
    else
        s += p[1];
    for (size_t i = 0; i < RESONANCES; i++)
        if (t->resonance[i].sigma > 0 && imk_resonance_arma(t->resonance[i], dt, &arma) == IMK_OK)
            s += imk_arma_spectrum(&arma, f);
    for (size_t i = 0; i < TIMES; i++)
        if (p[IMK_NOISE_TERMS + 2 * i] > 0)
            s += p[IMK_NOISE_TERMS + 2 * i] *
                 imk_gauss_markov_cosine_spectrum(
                     (imk_gauss_markov){1, exp(p[IMK_NOISE_TERMS + 2 * i + 1])}, dt, t->samples, k);
    return s;
}

/* Relative standard deviation of each parameter (the square of a strength; log T) at the bound of
 * Cramer and Rao; of the ramp itself, which is independent of the others. */
static inline void bounds(const truth *t, double *bound)
{
    double p[PARAMETERS] = {0}, h[PARAMETERS * PARAMETERS] = {0}, inverse[PARAMETERS * PARAMETERS];
    size_t index[PARAMETERS], count = 0;
    for (size_t i = 0; i < IMK_NOISE_RAMP; i++)
        p[i] = t->term[i] * t->term[i];
    if (t->step > 0)
        p[IMK_NOISE_WHITE] += t->step * t->step / 12 / t->rate;
    for (size_t i = 0; i < TIMES; i++)
        if (t->gauss_markov[i].sigma > 0) {
            p[IMK_NOISE_TERMS + 2 * i] = t->gauss_markov[i].sigma * t->gauss_markov[i].sigma;
            p[IMK_NOISE_TERMS + 2 * i + 1] = log(t->gauss_markov[i].correlation_time);
        }
    for (size_t i = 0; i < PARAMETERS; i++) {
        bound[i] = 0;
        if (i != IMK_NOISE_RAMP && p[i] != 0)
            index[count++] = i;
        else if (i > IMK_NOISE_TERMS && i % 2 == 0 && p[i - 1] > 0)
            index[count++] = i; /* log T = 0 */
    }
    double ramp = 0;
    for (size_t k = 1; k < t->samples;) {
        const size_t width = k < 256 ? 1 : k / 64, middle = k + width / 2;
        const double s = expected(t, p, middle < t->samples ? middle : t->samples - 1);
        double column[PARAMETERS];
        for (size_t i = 0; i < count; i++) {
            double moved[PARAMETERS];
            memcpy(moved, p, sizeof p);
            const bool time = index[i] > IMK_NOISE_TERMS && (index[i] - IMK_NOISE_TERMS) % 2 == 1;
            moved[index[i]] += time ? 1e-4 : 1e-4 * p[index[i]];
            column[i] =
                (expected(t, moved, middle < t->samples ? middle : t->samples - 1) / s - 1) / 1e-4;
        }
        for (size_t i = 0; i < count; i++)
            for (size_t j = 0; j < count; j++)
                h[i * count + j] += 0.5 * (double)width * column[i] * column[j];
        if (k % 2 == 1 && k < 256) {
            const double half = 1.5707963267948966 * (double)k / (double)t->samples;
            const double d =
                sqrt(2.0 / (double)t->samples) / t->rate * cos(half) / (2 * sin(half) * sin(half));
            ramp += d * d / t->rate / s;
        }
        k += width;
    }
    if (imk_cholesky_factor(count, h) == IMK_OK) {
        imk_cholesky_inverse(count, h, inverse);
        for (size_t i = 0; i < count; i++)
            bound[index[i]] = sqrt(inverse[i * count + i]);
    }
    if (t->term[IMK_NOISE_RAMP] > 0)
        bound[IMK_NOISE_RAMP] = 1 / sqrt(ramp) / t->term[IMK_NOISE_RAMP];
}

#endif
