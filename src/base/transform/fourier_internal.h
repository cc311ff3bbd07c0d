/* SPDX-License-Identifier: Apache-2.0 */
/* What the Fourier and cosine transforms share: tables of roots of unity and the passes of the
 * Stockham transform. */
#ifndef IMUKIT_FOURIER_INTERNAL_H
#define IMUKIT_FOURIER_INTERNAL_H

#include "base/workspace_internal.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    /** Transforms done side by side in one batch: a cache line of real parts, and as wide as the
     *  widest vector register. */
    IMKI_LANES = 8,
    /** Largest prime done as a radix; 13 keeps the r^2 operations of a pass below the cost of
     *  Bluestein's three transforms. */
    IMKI_LARGEST_RADIX = 13,
    IMKI_FACTORS_MAX = 33
};

/** n as a product of the radices of its passes. */
typedef struct imki_factors {
    size_t count;
    size_t radix[IMKI_FACTORS_MAX];
} imki_factors;

/** Radices of n, largest power-of-two radix first; false when a prime above 13 is left. */
bool imki_factorise(size_t n, imki_factors *factors);

/** e^{-2 pi i k / n}, 0 <= k < n, by the octant: error below 1 ulp of 1. */
void imki_root(uint64_t k, uint64_t n, double *re, double *im);

/** Roots e^{-2 pi i k / n}, k = 0 … count - 1, as alternating parts. */
void imki_roots(uint64_t n, size_t count, double *roots);

/** Roots of any order n from two tables of about sqrt(n) entries:
 *  e^{-2 pi i k / n} = coarse[k >> shift] fine[k & mask], for 0 <= k < n. */
typedef struct imki_root_table {
    const double *fine;
    const double *coarse;
    unsigned shift;
    uint64_t mask;
} imki_root_table;

/** Doubles of storage for the table, and the table made in it. */
size_t imki_root_table_size(uint64_t n);
imki_root_table imki_root_table_make(uint64_t n, double *storage);

static inline void imki_root_table_get(const imki_root_table *table, uint64_t k, double *re,
                                       double *im)
{
    const double *c = table->coarse + 2 * (size_t)(k >> table->shift);
    const double *f = table->fine + 2 * (size_t)(k & table->mask);
    *re = c[0] * f[0] - c[1] * f[1];
    *im = c[0] * f[1] + c[1] * f[0];
}

/** Forward transforms of length n of one sequence (alternating parts), or of IMKI_LANES sequences
 *  side by side (element j: real parts of all, then imaginary parts of all).
 *  @param roots  imki_roots(n, n)
 *  @param a,b    input in a; both are overwritten. @return the one that holds the result */
double *imki_stockham_single(const imki_factors *factors, size_t n, const double *roots, double *a,
                             double *b);
double *imki_stockham_batch(const imki_factors *factors, size_t n, const double *roots, double *a,
                            double *b);

/** Forward transform of n points whose factors are known, in place.
 *  @param workspace  imki_smooth_workspace(n) doubles */
size_t imki_smooth_workspace(size_t n);
void imki_smooth_transform(size_t n, double *data, double *workspace);

/** Forward transform of any n > 1 by convolution with a chirp, in place.
 *  @param workspace  imki_bluestein_workspace(n) doubles */
size_t imki_bluestein_workspace(size_t n);
void imki_bluestein_transform(size_t n, double *data, double *workspace);

#endif
