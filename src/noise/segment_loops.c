/* SPDX-License-Identifier: Apache-2.0 */
/* The loops of segment_kernel.h, each by the instruction set asked for. */
#include "base/kernel_call_internal.h"
#include "segment_internal.h"

void imki_add_scaled(imk_kernel kernel, double scale, const double *normals, double *block)
{
    IMKI_CALL(kernel, imki_add_scaled, scale, normals, block);
}

void imki_add_ramp(imk_kernel kernel, double per_sample, uint64_t first, double *block)
{
    IMKI_CALL(kernel, imki_add_ramp, per_sample, first, block);
}

void imki_add_sinusoid(imk_kernel kernel, const imki_turning *turning, double *block)
{
    IMKI_CALL(kernel, imki_add_sinusoid, turning, block);
}

void imki_add_arma(imk_kernel kernel, imki_arma_lanes *lanes, size_t half)
{
    IMKI_CALL(kernel, imki_add_arma, lanes, half);
}

void imki_add_recursions(imk_kernel kernel, const imki_recursion *recursions, size_t count,
                         double *block)
{
    IMKI_CALL(kernel, imki_add_recursions, recursions, count, block);
}

void imki_add_flicker(imk_kernel kernel, const imki_recursion recursions[2], double held,
                      double *change, double *block)
{
    IMKI_CALL(kernel, imki_add_flicker, recursions, held, change, block);
}

void imki_add_sums(imk_kernel kernel, double gain, const double *normals, double *value,
                   double *block)
{
    IMKI_CALL(kernel, imki_add_sums, gain, normals, value, block);
}

void imki_quantize(imk_kernel kernel, double lsb, double dt, double *residual, double *block)
{
    IMKI_CALL(kernel, imki_quantize, lsb, dt, residual, block);
}

void imki_saturate(imk_kernel kernel, double dead_band, double range, double *block)
{
    IMKI_CALL(kernel, imki_saturate, dead_band, range, block);
}

void imki_add_held(imk_kernel kernel, const double *held, size_t offset, double *block)
{
    IMKI_CALL(kernel, imki_add_held, held, offset, block);
}

void imki_to_time_order(imk_kernel kernel, const double *block, double *out)
{
    IMKI_CALL(kernel, imki_to_time_order, block, out);
}

void imki_to_segment_order(imk_kernel kernel, const double *samples, double *block)
{
    IMKI_CALL(kernel, imki_to_segment_order, samples, block);
}

void imki_interleave(imk_kernel kernel, const double *const *blocks, double *out, size_t stride)
{
    IMKI_CALL(kernel, imki_interleave, blocks, out, stride);
}
