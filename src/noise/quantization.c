/* SPDX-License-Identifier: Apache-2.0 */
/* Quantization of the integrated output: the integral of the rate is rounded to whole steps of
 * lsb = Q sqrt(12), the steps of each sample are put out as a rate, and what is left is carried:
 *
 *     I[k] = r + sum x dt,   m[k] = round(I[k]/lsb),   y[k] = (m[k] - m[k-1]) lsb/dt
 *
 * so that the sum of y dt never strays more than lsb/2 from the integral. For a busy input the
 * residual is white, uniform, of variance Q^2, and enters the rate by its difference:
 * sigma_A^2 = 3 Q^2/tau^2 exactly, S(f) = 4 (Q^2/dt) sin^2(pi f dt)   [IEEE952]
 *
 * At the end of each segment of 32 samples the residual is folded back to +-lsb/2, which keeps the
 * sums short: no digits are lost however long the record. */
#include "generator_internal.h"

double imk_quantization_allan_variance(double q, double tau)
{
    double ratio = q / tau;
    return 3.0 * ratio * ratio;
}

double imk_quantization_sampled_allan_variance(double q, double dt, size_t n)
{
    return imk_quantization_allan_variance(q, (double)n * dt);
}

double imk_quantization_sampled_spectrum(double q, double dt, double frequency)
{
    double amplitude = 2.0 * q * imki_sin_half_turns(frequency * dt);
    return amplitude * amplitude / dt;
}

imk_status imk_quantization_start(imk_quantization_state *state, double q, double dt,
                                  imk_random random, uint64_t stream)
{
    imk_status status = imki_check_noise(q, dt);
    if (status != IMK_OK)
        return status;
    uint32_t word;
    imk_random_words(random, stream, IMKI_START_WORD, 1, &word);
    double lsb = q * sqrt(12.0);
    /* Half a unit keeps the start symmetric: (word + 1/2)/2^32 - 1/2. */
    double start = ((double)word + 0.5) * 0x1p-32 - 0.5;
    *state = (imk_quantization_state){.lsb = lsb, .dt = dt, .residual = start * lsb};
    return IMK_OK;
}

void imk_quantization_apply(imk_quantization_state *state, size_t count, double *out)
{
    if (!(state->lsb > 0.0))
        return;
    const imki_quantizer quantizer = imki_quantizer_of(state->lsb, state->dt);
    for (size_t i = 0; i < count; i++)
        out[i] = imki_quantized(&quantizer, ++state->next % IMK_NOISE_STEPS == 0, out[i],
                                &state->residual, &state->sum, &state->counted);
}

void imki_quantization_block(imk_quantization_state *state, imk_kernel kernel, double *block)
{
    if (!(state->lsb > 0.0))
        return;
    imki_quantize(kernel, state->lsb, state->dt, &state->residual, block);
    state->next += IMK_NOISE_BLOCK;
}
