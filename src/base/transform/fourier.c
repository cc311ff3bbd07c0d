/* SPDX-License-Identifier: Apache-2.0 */
/* Discrete Fourier transform of any length: without prime factors above 13 in smooth_transform.c,
 * others in bluestein.c. */
#include "imukit/fourier.h"

#include "fourier_internal.h"

/* Doubles of workspace, or 0 when n is 0 or too large for size_t or for the roots' arithmetic. */
static size_t workspace_doubles(size_t n)
{
    imki_factors factors;
    if (n == 0 || (uint64_t)n > UINT64_C(1) << 31 || n > SIZE_MAX / 512)
        return 0;
    return imki_factorise(n, &factors) ? imki_smooth_workspace(n) : imki_bluestein_workspace(n);
}

size_t imk_fourier_workspace_size(size_t n)
{
    const size_t doubles = workspace_doubles(n);
    return doubles ? doubles * sizeof(double) + IMKI_ALIGNMENT_SLACK : 0;
}

imk_status imk_fourier(size_t n, double *data, int inverse, void *workspace, size_t workspace_size)
{
    const size_t needed = imk_fourier_workspace_size(n);
    if (needed == 0 || !data || !workspace)
        return IMK_ERROR_ARGUMENT;
    if (workspace_size < needed)
        return IMK_ERROR_WORKSPACE;
    /* The inverse is the conjugate of the forward transform of the conjugate. */
    if (inverse) {
        for (size_t j = 0; j < n; j++)
            data[2 * j + 1] = -data[2 * j + 1];
    }
    imki_factors factors;
    if (imki_factorise(n, &factors))
        imki_smooth_transform(n, data, imki_align(workspace));
    else
        imki_bluestein_transform(n, data, imki_align(workspace));
    if (inverse) {
        const double scale = (double)n;
        for (size_t j = 0; j < n; j++) {
            data[2 * j] = data[2 * j] / scale;
            data[2 * j + 1] = -data[2 * j + 1] / scale;
        }
    }
    return IMK_OK;
}
