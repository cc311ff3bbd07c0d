/* SPDX-License-Identifier: Apache-2.0 */
/** @file fourier.h
 *  Discrete Fourier and cosine transforms of any length. */
#ifndef IMUKIT_FOURIER_H
#define IMUKIT_FOURIER_H

#include "imukit/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Workspace [bytes] for transforms of n points; 0 when n is 0 or too large. */
IMK_API size_t imk_fourier_workspace_size(size_t n);
IMK_API size_t imk_cosine_workspace_size(size_t n);

/** Complex transform in place: X[k] = sum_j x[j] exp(-+ 2 pi i j k / n); `inverse` takes the plus
 *  sign and divides by n. Any n: mixed radix 2, 3, 4, 5, and Bluestein's algorithm otherwise
 *  [BLUESTEIN1970]. Error about 1e-16 sqrt(log n) of the norm.
 *  @param data  n complex numbers, real and imaginary parts alternating
 *  @return IMK_ERROR_WORKSPACE, IMK_ERROR_ARGUMENT */
IMK_API imk_status imk_fourier(size_t n, double *data, int inverse, void *workspace,
                               size_t workspace_size);

/** Orthonormal cosine transform of type II in place:
 *
 *      c[k] = s_k sum_j x[j] cos(pi k (2j + 1) / 2n),   s_0 = sqrt(1/n), s_k = sqrt(2/n)
 *
 *  by one complex transform of n/2 points for even n (n for odd). [MAKHOUL1980] */
IMK_API imk_status imk_cosine(size_t n, double *data, void *workspace, size_t workspace_size);

#ifdef __cplusplus
}
#endif
#endif
