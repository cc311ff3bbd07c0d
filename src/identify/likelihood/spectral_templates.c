/* SPDX-License-Identifier: Apache-2.0 */
/* Expected spectra, at the bands, of the terms of amount 1.
 *
 * A coefficient of a finite record expects less of a process with a long memory than its spectrum
 * (imk_gauss_markov_cosine_spectrum()). The loss falls as 1/k; for flicker noise it is taken into
 * account up to coefficient CORRECTED, where it is 0.03 %. */
#include "identify_internal.h"

#include "imukit/elementary.h"

#include <math.h>

enum { CORRECTED = 1000 };

/* Place of a band's centre among the coefficients of the transform behind it. */
static double index_of(const imki_bands *bands, size_t b)
{
    return 2 * bands->frequency[b] * (double)bands->length[b] * bands->dt;
}

/* Flicker noise at a band. The loss at the ends differs between even and odd k: a band of both gets
 * the mean of two neighbours. */
static double flicker_at(const imki_bands *bands, size_t b)
{
    const double dt = bands->dt, f = bands->frequency[b], index = index_of(bands, b);
    const size_t n = bands->length[b];
    if (b < bands->singles)
        return imk_flicker_cosine_spectrum((imk_flicker){1, 0}, dt, n, b + 1);
    if (!(index < CORRECTED && index >= 1))
        return imk_flicker_sampled_spectrum((imk_flicker){1, 0}, dt, f);
    if (bands->degrees[b] < 1.5)
        return imk_flicker_cosine_spectrum((imk_flicker){1, 0}, dt, n, (size_t)(index + 0.5));
    const size_t k = (size_t)index;
    const double step_hz = 0.5 / ((double)n * dt);
    double expected = 0, spectrum = 0;
    for (size_t i = k; i <= k + 1; i++) {
        expected += imk_flicker_cosine_spectrum((imk_flicker){1, 0}, dt, n, i);
        spectrum += imk_flicker_sampled_spectrum((imk_flicker){1, 0}, dt, (double)i * step_hz);
    }
    return imk_flicker_sampled_spectrum((imk_flicker){1, 0}, dt, f) * expected / spectrum;
}

/* Quantization: where the two ends of each of many segments are not told apart, they add their
 * expectation, (4 Q^2/T) cos^2(w/2). */
static double quantization_at(const imki_bands *bands, size_t b)
{
    const double dt = bands->dt, f = bands->frequency[b];
    const double spectrum = imk_quantization_sampled_spectrum(1, dt, f);
    if (bands->length[b] == bands->n)
        return spectrum;
    const double half = imk_cos(3.141592653589793 * f * dt);
    return spectrum + 4 / ((double)bands->length[b] * dt) * half * half;
}

void imki_templates_set(imki_fit *fit, const imki_bands *bands)
{
    for (size_t b = 0; b < bands->count; b++) {
        const double f = bands->frequency[b], dt = bands->dt;
        fit->shape[IMK_NOISE_QUANTIZATION][b] = quantization_at(bands, b);
        fit->shape[IMK_NOISE_WHITE][b] = imk_white_sampled_spectrum(1, dt, f);
        fit->shape[IMK_NOISE_BIAS_INSTABILITY][b] = flicker_at(bands, b);
        fit->shape[IMK_NOISE_RANDOM_WALK][b] = imk_random_walk_sampled_spectrum(1, dt, f);
        const double sine = imk_sin(3.141592653589793 * f * dt);
        fit->sine_square[b] = sine * sine;
    }
}

/* imk_gauss_markov_cosine_spectrum() for many bands at once: with phi = e^(-dt/T), w = 2 pi f dt,
 * D = (1 - phi)^2 + 4 phi sin^2(w/2)
 *
 *     dt [ (1 - phi^2)/D - (4/n) phi (1 - phi)^2 cos^2(w/2)/D^2 (1 - (-1)^k phi^n) ] */
void imki_gauss_markov_shape(const imki_fit *fit, const imki_bands *bands, double correlation_time,
                             double *shape)
{
    const double x = bands->dt / correlation_time, phi = imk_exp(-x), distance = -imk_expm1(-x);
    const double numerator = bands->dt * -imk_expm1(-2 * x);
    for (size_t b = 0; b < bands->count; b++) {
        const double reciprocal = 1 / (distance * distance + 4 * phi * fit->sine_square[b]);
        const double ratio = distance * reciprocal, n = (double)bands->length[b];
        shape[b] = numerator * reciprocal -
                   4 / n * bands->dt * phi * ratio * ratio * (1 - fit->sine_square[b]);
    }
    /* The even and the odd ones singly: b = 0 is k = 1. */
    const double far = imk_exp(-x * (double)bands->n);
    for (size_t b = 0; b < bands->singles; b++) {
        const double reciprocal = 1 / (distance * distance + 4 * phi * fit->sine_square[b]);
        const double ratio = distance * reciprocal;
        shape[b] -= (b % 2 == 0 ? far : -far) * 4 / (double)bands->n * bands->dt * phi * ratio *
                    ratio * (1 - fit->sine_square[b]);
    }
}
