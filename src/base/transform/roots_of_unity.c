/* SPDX-License-Identifier: Apache-2.0 */
/* Roots of unity e^{-2 pi i k/n} to the last bit or so. The angle is reduced to the first octant in
 * integers, so its rounding error is that of an angle below pi/4, not of one near 2 pi. */
#include "base/sine_internal.h"
#include "fourier_internal.h"

#define PI 3.14159265358979323846

void imki_root(uint64_t k, uint64_t n, double *re, double *im)
{
    /* k/n of a turn is octant + rest/n of an eighth turn. */
    const uint64_t eighths = 8 * k;
    const unsigned octant = (unsigned)(eighths / n);
    const uint64_t rest = eighths % n;
    const bool mirrored = octant & 1;
    const double part = (double)(mirrored ? n - rest : rest) / (double)n;
    double c, s;
    imki_sine_and_cosine(0.25 * PI * part, &s, &c);
    /* Cosine and sine of the whole angle, octant by octant: an odd octant is counted back from the
     * next quarter turn. */
    switch ((octant + 1) / 2 % 4) {
    case 0:
        *re = c;
        *im = mirrored ? s : -s;
        break;
    case 1:
        *re = mirrored ? s : -s;
        *im = -c;
        break;
    case 2:
        *re = -c;
        *im = mirrored ? -s : s;
        break;
    default:
        *re = mirrored ? -s : s;
        *im = c;
        break;
    }
}

void imki_roots(uint64_t n, size_t count, double *roots)
{
    for (size_t k = 0; k < count; k++)
        imki_root(k % n, n, &roots[2 * k], &roots[2 * k + 1]);
}

static unsigned half_bits(uint64_t n)
{
    unsigned shift = 0;
    while ((UINT64_C(1) << (2 * shift)) < n)
        shift++;
    return shift;
}

size_t imki_root_table_size(uint64_t n)
{
    const unsigned shift = half_bits(n);
    return 2 * (((size_t)1 << shift) + (size_t)(n >> shift) + 1);
}

imki_root_table imki_root_table_make(uint64_t n, double *storage)
{
    const unsigned shift = half_bits(n);
    const size_t fine_count = (size_t)1 << shift;
    const size_t coarse_count = (size_t)(n >> shift) + 1;
    double *coarse = storage + 2 * fine_count;
    imki_roots(n, fine_count, storage);
    for (size_t k = 0; k < coarse_count; k++)
        imki_root(((uint64_t)k << shift) % n, n, &coarse[2 * k], &coarse[2 * k + 1]);
    return (imki_root_table){
        .fine = storage, .coarse = coarse, .shift = shift, .mask = fine_count - 1};
}
