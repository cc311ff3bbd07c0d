/* SPDX-License-Identifier: Apache-2.0 */
/** @file fourier.h
 *  Discrete Fourier and cosine transforms of any length. */
#ifndef IMUKIT_FOURIER_H
#define IMUKIT_FOURIER_H

#include "imukit/status.h"

IMK_BEGIN_C

/** Workspace [bytes] for transforms of n points; 0 when n is 0 or above 2^31. About 17 n for large
 *  n, 34 n for small n, and 115 n where Bluestein's algorithm is needed. The workspace may have any
 *  alignment, and need not be kept between calls. */
IMK_API size_t imk_fourier_workspace_size(size_t n);
/** Workspace [bytes] of imk_cosine() for n points; 0 when n is 0 or too large. */
IMK_API size_t imk_cosine_workspace_size(size_t n);

/** Complex transform in place: X[k] = sum_j x[j] exp(-+ 2 pi i j k / n); `inverse` takes the plus
 *  sign and divides by n. Any n: mixed radix up to 13 by Stockham's algorithm [VANLOAN1992], long
 *  lengths in two sweeps over the memory [BAILEY1990], and where a larger prime divides n
 *  Bluestein's algorithm [BLUESTEIN1970], about seven times slower. Error of the whole below 1e-15
 *  of its norm up to 1e6 points (3e-16 without Bluestein). The bits may differ between machines,
 *  because the sine of libm does.
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
/** The inverse of imk_cosine(), the orthonormal transform of type III in place: x[j] = sum_k s_k
 *  c[k] cos(...). */
IMK_API imk_status imk_cosine_inverse(size_t n, double *data, void *workspace,
                                      size_t workspace_size);

IMK_END_C
#endif
