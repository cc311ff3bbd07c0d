/* SPDX-License-Identifier: Apache-2.0 */
/* The loops of distort_kernel.h, each by the instruction set asked for. */
#include "base/kernel_call_internal.h"
#include "distort_internal.h"

void imki_distort_chunks(imk_kernel kernel, const imk_axis_response *axis,
                         const imki_exposure *exposure, size_t chunks, double *out)
{
    IMKI_CALL(kernel, imki_distort_chunks, axis, exposure, chunks, out);
}

void imki_distort_still(imk_kernel kernel, const imk_axis_response *axis,
                        const imki_exposure *exposure, size_t chunks, double *out)
{
    IMKI_CALL(kernel, imki_distort_still, axis, exposure, chunks, out);
}

void imki_distort_alike(imk_kernel kernel, size_t count, const imk_axis_response *const *axes,
                        const imki_exposure *exposure, size_t chunks, double *const *out)
{
    IMKI_CALL(kernel, imki_distort_alike, count, axes, exposure, chunks, out);
}

void imki_residual(imk_kernel kernel, size_t chunks, const double *reading, double *response)
{
    IMKI_CALL(kernel, imki_residual, chunks, reading, response);
}

void imki_add_residual(imk_kernel kernel, size_t chunks, double gain, const double *residual,
                       double *sum)
{
    IMKI_CALL(kernel, imki_add_residual, chunks, gain, residual, sum);
}

void imki_limit(imk_kernel kernel, size_t chunks, double limit, double *x)
{
    IMKI_CALL(kernel, imki_limit, chunks, limit, x);
}
