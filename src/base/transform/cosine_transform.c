/* SPDX-License-Identifier: Apache-2.0 */
/* Orthonormal cosine transform of type II by one Fourier transform [MAKHOUL1980].
 *
 * The even samples followed by the odd ones backwards, v[j] = x[2j], v[n-1-j] = x[2j+1], have the
 * spectrum V with
 *
 *     c[k] = s_k Re( e^{-i pi k/2n} V[k] ),   s_0 = sqrt(1/n),  s_k = sqrt(2/n).
 *
 * v is real: for even n its spectrum comes from the n/2 complex numbers z[j] = v[2j] + i v[2j+1],
 *
 *     V[k] = (Z[k] + Z*[h-k])/2 - i e^{-2 pi i k/n} (Z[k] - Z*[h-k])/2,   h = n/2,
 *
 * and V[n-k] is the conjugate of V[k], which gives c[k] and c[n-k] together. The inverse (type III)
 * takes the same steps backwards. */
#include "imukit/fourier.h"

#include "fourier_internal.h"

#include <math.h>

/* Doubles of the parts of the workspace, each a whole number of cache lines. */
typedef struct layout {
    size_t sequence, table, total; /* [doubles]; the total includes the transform's [bytes/8] */
    size_t transform_size;         /* [bytes] */
} layout;

static layout layout_of(size_t n)
{
    const size_t points = n % 2 == 0 ? n / 2 : n;
    const size_t transform_size = imk_fourier_workspace_size(points);
    if (transform_size == 0)
        return (layout){0};
    layout part = {.transform_size = transform_size};
    part.sequence = (2 * points + 7) / 8 * 8;
    part.table = (imki_root_table_size(4 * (uint64_t)n) + 7) / 8 * 8;
    part.total = part.sequence + part.table + transform_size / sizeof(double);
    return part;
}

size_t imk_cosine_workspace_size(size_t n)
{
    if (n == 0)
        return 0;
    const layout part = layout_of(n);
    return part.total ? part.total * sizeof(double) + IMKI_ALIGNMENT_SLACK : 0;
}

/* v[j] of the reordered sequence goes to place(j) = stride j of z. */
static void reorder(size_t n, const double *x, double *z, size_t stride)
{
    const size_t half = (n + 1) / 2;
    for (size_t j = 0; j < half; j++)
        z[stride * j] = x[2 * j];
    for (size_t j = half; j < n; j++)
        z[stride * j] = x[2 * (n - 1 - j) + 1];
}

/* From the spectrum of v itself, at the even places of z. */
static void from_full_spectrum(size_t n, const double *z, const imki_root_table *table, double *c)
{
    const double scale = sqrt(2.0 / (double)n);
    c[0] = z[0] * sqrt(1.0 / (double)n);
    for (size_t k = 1; k < n; k++) {
        double re, im;
        imki_root_table_get(table, k, &re, &im);
        c[k] = scale * (z[2 * k] * re - z[2 * k + 1] * im);
    }
}

/* c[k] and c[n-k] from V[k] = (vr, vi) and the root e^{-i pi k/2n}:
 * e^{-i pi (n-k)/2n} V*[k] = -i (e^{-i pi k/2n} V[k])*. */
static inline void store_pair(double *c, size_t n, size_t k, double scale, double re, double im,
                              double vr, double vi)
{
    c[k] = scale * (vr * re - vi * im);
    c[n - k] = -scale * (vr * im + vi * re);
}

/* From the spectrum Z of the pairs; n even. */
static void from_half_spectrum(size_t n, const double *z, const imki_root_table *table, double *c)
{
    const size_t h = n / 2;
    const double scale = sqrt(2.0 / (double)n);
    c[0] = (z[0] + z[1]) * sqrt(1.0 / (double)n);
    /* V[h] = Re Z[0] - Im Z[0], turned by e^{-i pi/4}. */
    c[h] = (z[0] - z[1]) * sqrt(1.0 / (double)n);
    for (size_t k = 1; k <= h / 2; k++) {
        const size_t mirror = h - k;
        const double er = 0.5 * (z[2 * k] + z[2 * mirror]);
        const double ei = 0.5 * (z[2 * k + 1] - z[2 * mirror + 1]);
        const double or = 0.5 * (z[2 * k + 1] + z[2 * mirror + 1]);
        const double oi = -0.5 * (z[2 * k] - z[2 * mirror]);
        double wr, wi, re, im;
        imki_root_table_get(table, 4 * (uint64_t)k, &wr, &wi);
        const double tr = or *wr - oi * wi;
        const double ti = or *wi + oi * wr;
        imki_root_table_get(table, k, &re, &im);
        store_pair(c, n, k, scale, re, im, er + tr, ei + ti);
        /* V[h-k] = conj(E[k] - w^k O[k]); for k = h/2 it is the same pair again. */
        imki_root_table_get(table, mirror, &re, &im);
        store_pair(c, n, mirror, scale, re, im, er - tr, -(ei - ti));
    }
}

imk_status imk_cosine(size_t n, double *data, void *workspace, size_t workspace_size)
{
    const size_t needed = imk_cosine_workspace_size(n);
    if (needed == 0 || !data || !workspace)
        return IMK_ERROR_ARGUMENT;
    if (workspace_size < needed)
        return IMK_ERROR_WORKSPACE;
    const layout part = layout_of(n);
    const bool even = n % 2 == 0;
    double *z = imki_align(workspace);
    const imki_root_table table = imki_root_table_make(4 * (uint64_t)n, z + part.sequence);
    reorder(n, data, z, even ? 1 : 2);
    for (size_t j = 0; !even && j < n; j++)
        z[2 * j + 1] = 0.0;
    const imk_status status =
        imk_fourier(even ? n / 2 : n, z, 0, z + part.sequence + part.table, part.transform_size);
    if (status != IMK_OK)
        return status;
    if (even)
        from_half_spectrum(n, z, &table, data);
    else
        from_full_spectrum(n, z, &table, data);
    return IMK_OK;
}

/* V[k] s_k = e^{i pi k/2n} (c[k] - i c[n-k]). */
static inline void take_pair(const double *c, size_t n, size_t k, const imki_root_table *table,
                             double *vr, double *vi)
{
    double re, im;
    imki_root_table_get(table, k, &re, &im);
    *vr = c[k] * re - c[n - k] * im;
    *vi = -(c[k] * im + c[n - k] * re);
}

static void to_full_spectrum(size_t n, const double *c, const imki_root_table *table, double *z)
{
    const double scale = sqrt(0.5 * (double)n);
    z[0] = c[0] * sqrt((double)n);
    z[1] = 0;
    for (size_t k = 1; k < n; k++) {
        double vr, vi;
        take_pair(c, n, k, table, &vr, &vi);
        z[2 * k] = scale * vr;
        z[2 * k + 1] = scale * vi;
    }
}

/* The spectrum Z of the pairs from E[k] = (V[k] + V*[h-k])/2 and O[k] = w^{-k} (V[k] - V*[h-k])/2:
 * Z[k] = E + i O, Z[h-k] = E* + i O*; n even. */
static void to_half_spectrum(size_t n, const double *c, const imki_root_table *table, double *z)
{
    const size_t h = n / 2;
    const double whole = sqrt((double)n), scale = 0.5 * sqrt(0.5 * (double)n);
    z[0] = 0.5 * whole * (c[0] + c[h]);
    z[1] = 0.5 * whole * (c[0] - c[h]);
    for (size_t k = 1; k <= h / 2; k++) {
        const size_t mirror = h - k;
        double ar, ai, br, bi, wr, wi;
        take_pair(c, n, k, table, &ar, &ai);
        take_pair(c, n, mirror, table, &br, &bi);
        imki_root_table_get(table, 4 * (uint64_t)k, &wr, &wi);
        const double er = scale * (ar + br), ei = scale * (ai - bi);
        const double tr = scale * (ar - br), ti = scale * (ai + bi);
        const double or = tr * wr + ti * wi, oi = ti * wr - tr * wi;
        z[2 * k] = er - oi;
        z[2 * k + 1] = ei + or ;
        z[2 * mirror] = er + oi;
        z[2 * mirror + 1] = or -ei;
    }
}

imk_status imk_cosine_inverse(size_t n, double *data, void *workspace, size_t workspace_size)
{
    const size_t needed = imk_cosine_workspace_size(n);
    if (needed == 0 || !data || !workspace)
        return IMK_ERROR_ARGUMENT;
    if (workspace_size < needed)
        return IMK_ERROR_WORKSPACE;
    const layout part = layout_of(n);
    const bool even = n % 2 == 0;
    double *z = imki_align(workspace);
    const imki_root_table table = imki_root_table_make(4 * (uint64_t)n, z + part.sequence);
    if (even)
        to_half_spectrum(n, data, &table, z);
    else
        to_full_spectrum(n, data, &table, z);
    const imk_status status =
        imk_fourier(even ? n / 2 : n, z, 1, z + part.sequence + part.table, part.transform_size);
    if (status != IMK_OK)
        return status;
    const size_t half = (n + 1) / 2, stride = even ? 1 : 2;
    for (size_t j = 0; j < half; j++)
        data[2 * j] = z[stride * j];
    for (size_t j = half; j < n; j++)
        data[2 * (n - 1 - j) + 1] = z[stride * j];
    return IMK_OK;
}
