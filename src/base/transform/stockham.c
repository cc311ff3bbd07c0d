/* SPDX-License-Identifier: Apache-2.0 */
/* Mixed-radix Fourier transform in the self-sorting order of Stockham [VANLOAN1992, sec. 1.7].
 *
 * A pass of radix r over a length n = r m, repeated over a stride s, computes with w = e^{-2 pi
 * i/n}
 *
 *     y[q + s (r p + j)] = w^{j p} sum_k e^{-2 pi i j k / r} x[q + s (p + m k)],
 *     0 <= p < m,  0 <= q < s,  0 <= j < r,
 *
 * and leaves transforms of length m at stride r s. The root depends on p only, so the inner loops
 * over q and over the lanes are free of it and of shuffles: the compiler vectorises them. */
#include "fourier_internal.h"

/* Where a pass reads and writes. The roots of this length are every root_step-th of the table. */
typedef struct pass {
    size_t m, s;
    const double *roots;
    size_t root_step;
} pass;

/* Root w^{j p}; j p < n, so the table is long enough. */
static inline const double *root(const pass *t, size_t j, size_t p)
{
    return t->roots + 2 * j * p * t->root_step;
}

static inline void pass2(size_t lanes, const pass *t, const double *restrict x, double *restrict y)
{
    const size_t in = t->m * t->s * 2 * lanes;
    const size_t out = t->s * 2 * lanes;
    for (size_t p = 0; p < t->m; p++) {
        const double wr = root(t, 1, p)[0], wi = root(t, 1, p)[1];
        for (size_t q = 0; q < t->s; q++) {
            const double *restrict a = x + (q + t->s * p) * 2 * lanes;
            double *restrict b = y + (q + t->s * 2 * p) * 2 * lanes;
            for (size_t l = 0; l < lanes; l++) {
                const double ar = a[l], ai = a[lanes + l];
                const double br = a[in + l], bi = a[in + lanes + l];
                const double dr = ar - br, di = ai - bi;
                b[l] = ar + br;
                b[lanes + l] = ai + bi;
                b[out + l] = dr * wr - di * wi;
                b[out + lanes + l] = dr * wi + di * wr;
            }
        }
    }
}

static inline void pass3(size_t lanes, const pass *t, const double *restrict x, double *restrict y)
{
    const double half_root3 = 0.86602540378443864676; /* sin(2 pi/3) */
    const size_t in = t->m * t->s * 2 * lanes;
    const size_t out = t->s * 2 * lanes;
    for (size_t p = 0; p < t->m; p++) {
        const double w1r = root(t, 1, p)[0], w1i = root(t, 1, p)[1];
        const double w2r = root(t, 2, p)[0], w2i = root(t, 2, p)[1];
        for (size_t q = 0; q < t->s; q++) {
            const double *restrict a = x + (q + t->s * p) * 2 * lanes;
            double *restrict b = y + (q + t->s * 3 * p) * 2 * lanes;
            for (size_t l = 0; l < lanes; l++) {
                const double ar = a[l], ai = a[lanes + l];
                const double sr = a[in + l] + a[2 * in + l];
                const double si = a[in + lanes + l] + a[2 * in + lanes + l];
                const double dr = half_root3 * (a[in + l] - a[2 * in + l]);
                const double di = half_root3 * (a[in + lanes + l] - a[2 * in + lanes + l]);
                const double mr = ar - 0.5 * sr, mi = ai - 0.5 * si;
                const double ur = mr + di, ui = mi - dr;
                const double vr = mr - di, vi = mi + dr;
                b[l] = ar + sr;
                b[lanes + l] = ai + si;
                b[out + l] = ur * w1r - ui * w1i;
                b[out + lanes + l] = ur * w1i + ui * w1r;
                b[2 * out + l] = vr * w2r - vi * w2i;
                b[2 * out + lanes + l] = vr * w2i + vi * w2r;
            }
        }
    }
}

static inline void pass4(size_t lanes, const pass *t, const double *restrict x, double *restrict y)
{
    const size_t in = t->m * t->s * 2 * lanes;
    const size_t out = t->s * 2 * lanes;
    for (size_t p = 0; p < t->m; p++) {
        const double w1r = root(t, 1, p)[0], w1i = root(t, 1, p)[1];
        const double w2r = root(t, 2, p)[0], w2i = root(t, 2, p)[1];
        const double w3r = root(t, 3, p)[0], w3i = root(t, 3, p)[1];
        for (size_t q = 0; q < t->s; q++) {
            const double *restrict a = x + (q + t->s * p) * 2 * lanes;
            double *restrict b = y + (q + t->s * 4 * p) * 2 * lanes;
            for (size_t l = 0; l < lanes; l++) {
                const double ar = a[l], ai = a[lanes + l];
                const double br = a[in + l], bi = a[in + lanes + l];
                const double cr = a[2 * in + l], ci = a[2 * in + lanes + l];
                const double dr = a[3 * in + l], di = a[3 * in + lanes + l];
                const double acr = ar + cr, aci = ai + ci;
                const double amr = ar - cr, ami = ai - ci;
                const double bdr = br + dr, bdi = bi + di;
                const double bmr = br - dr, bmi = bi - di;
                const double ur = amr + bmi, ui = ami - bmr;
                const double vr = acr - bdr, vi = aci - bdi;
                const double zr = amr - bmi, zi = ami + bmr;
                b[l] = acr + bdr;
                b[lanes + l] = aci + bdi;
                b[out + l] = ur * w1r - ui * w1i;
                b[out + lanes + l] = ur * w1i + ui * w1r;
                b[2 * out + l] = vr * w2r - vi * w2i;
                b[2 * out + lanes + l] = vr * w2i + vi * w2r;
                b[3 * out + l] = zr * w3r - zi * w3i;
                b[3 * out + lanes + l] = zr * w3i + zi * w3r;
            }
        }
    }
}

/* Radix 5 by the pairs x[1] + x[4], x[2] + x[3] and their differences. */
static inline void pass5(size_t lanes, const pass *t, const double *restrict x, double *restrict y)
{
    const double c1 = 0.30901699437494742410, s1 = 0.95105651629515357212;  /* 2 pi/5 */
    const double c2 = -0.80901699437494742410, s2 = 0.58778525229247312917; /* 4 pi/5 */
    const size_t in = t->m * t->s * 2 * lanes;
    const size_t out = t->s * 2 * lanes;
    for (size_t p = 0; p < t->m; p++) {
        const double *w1 = root(t, 1, p), *w2 = root(t, 2, p);
        const double *w3 = root(t, 3, p), *w4 = root(t, 4, p);
        const double w1r = w1[0], w1i = w1[1], w2r = w2[0], w2i = w2[1];
        const double w3r = w3[0], w3i = w3[1], w4r = w4[0], w4i = w4[1];
        for (size_t q = 0; q < t->s; q++) {
            const double *restrict a = x + (q + t->s * p) * 2 * lanes;
            double *restrict b = y + (q + t->s * 5 * p) * 2 * lanes;
            for (size_t l = 0; l < lanes; l++) {
                const double *f = a + l;
                const double *g = a + lanes + l;
                const double pr = f[in] + f[4 * in], pi = g[in] + g[4 * in];
                const double mr = f[in] - f[4 * in], mi = g[in] - g[4 * in];
                const double qr = f[2 * in] + f[3 * in], qi = g[2 * in] + g[3 * in];
                const double nr = f[2 * in] - f[3 * in], ni = g[2 * in] - g[3 * in];
                const double e1r = f[0] + (c1 * pr + c2 * qr), e1i = g[0] + (c1 * pi + c2 * qi);
                const double e2r = f[0] + (c2 * pr + c1 * qr), e2i = g[0] + (c2 * pi + c1 * qi);
                const double o1r = s1 * mi + s2 * ni, o1i = s1 * mr + s2 * nr;
                const double o2r = s2 * mi - s1 * ni, o2i = s2 * mr - s1 * nr;
                b[l] = f[0] + (pr + qr);
                b[lanes + l] = g[0] + (pi + qi);
                b[out + l] = (e1r + o1r) * w1r - (e1i - o1i) * w1i;
                b[out + lanes + l] = (e1r + o1r) * w1i + (e1i - o1i) * w1r;
                b[2 * out + l] = (e2r + o2r) * w2r - (e2i - o2i) * w2i;
                b[2 * out + lanes + l] = (e2r + o2r) * w2i + (e2i - o2i) * w2r;
                b[3 * out + l] = (e2r - o2r) * w3r - (e2i + o2i) * w3i;
                b[3 * out + lanes + l] = (e2r - o2r) * w3i + (e2i + o2i) * w3r;
                b[4 * out + l] = (e1r - o1r) * w4r - (e1i + o1i) * w4i;
                b[4 * out + lanes + l] = (e1r - o1r) * w4i + (e1i + o1i) * w4r;
            }
        }
    }
}

/* One butterfly of any odd radix. The pairs x[k] + x[r-k] and x[k] - x[r-k] halve the products:
 *     X[j], X[r-j] = x[0] + sum_k c[jk] (x[k] + x[r-k])  -+  i sum_k s[jk] (x[k] - x[r-k]). */
static inline void odd_butterfly(size_t r, size_t lanes, const double *c, const double *d,
                                 const pass *t, size_t p, const double *restrict a,
                                 double *restrict b)
{
    const size_t in = t->m * t->s * 2 * lanes;
    const size_t out = t->s * 2 * lanes;
    for (size_t l = 0; l < 2 * lanes; l++)
        b[l] = a[l];
    for (size_t k = 1; k < r; k++)
        for (size_t l = 0; l < 2 * lanes; l++)
            b[l] += a[k * in + l];
    for (size_t j = 1; j <= r / 2; j++) {
        const double *u = root(t, j, p), *v = root(t, r - j, p);
        double er[IMKI_LANES], ei[IMKI_LANES], fr[IMKI_LANES], fi[IMKI_LANES];
        for (size_t l = 0; l < lanes; l++) {
            er[l] = a[l];
            ei[l] = a[lanes + l];
            fr[l] = fi[l] = 0.0;
        }
        size_t jk = 0; /* modulo r */
        for (size_t k = 1; k <= r / 2; k++) {
            const double *f = a + k * in, *g = a + (r - k) * in;
            jk = jk + j < r ? jk + j : jk + j - r;
            const double cosine = c[jk], sine = d[jk];
            for (size_t l = 0; l < lanes; l++) {
                er[l] += cosine * (f[l] + g[l]);
                ei[l] += cosine * (f[lanes + l] + g[lanes + l]);
                fr[l] += sine * (f[lanes + l] - g[lanes + l]);
                fi[l] += sine * (f[l] - g[l]);
            }
        }
        for (size_t l = 0; l < lanes; l++) {
            const double ur = er[l] + fr[l], ui = ei[l] - fi[l];
            const double vr = er[l] - fr[l], vi = ei[l] + fi[l];
            b[j * out + l] = ur * u[0] - ui * u[1];
            b[j * out + lanes + l] = ur * u[1] + ui * u[0];
            b[(r - j) * out + l] = vr * v[0] - vi * v[1];
            b[(r - j) * out + lanes + l] = vr * v[1] + vi * v[0];
        }
    }
}

static inline void pass_odd(size_t r, size_t lanes, const pass *t, const double *restrict x,
                            double *restrict y)
{
    double c[IMKI_LARGEST_RADIX] = {0}, d[IMKI_LARGEST_RADIX] = {0};
    for (size_t k = 0; k < r; k++) {
        imki_root(k, r, &c[k], &d[k]);
        d[k] = -d[k];
    }
    for (size_t p = 0; p < t->m; p++)
        for (size_t q = 0; q < t->s; q++)
            odd_butterfly(r, lanes, c, d, t, p, x + (q + t->s * p) * 2 * lanes,
                          y + (q + t->s * r * p) * 2 * lanes);
}

static inline double *stockham(size_t lanes, const imki_factors *factors, size_t n,
                               const double *roots, double *from, double *to)
{
    pass t = {.m = n, .s = 1, .roots = roots, .root_step = 1};
    for (size_t i = 0; i < factors->count; i++) {
        const size_t radix = factors->radix[i];
        t.m /= radix;
        switch (radix) {
        case 2:
            pass2(lanes, &t, from, to);
            break;
        case 3:
            pass3(lanes, &t, from, to);
            break;
        case 4:
            pass4(lanes, &t, from, to);
            break;
        case 5:
            pass5(lanes, &t, from, to);
            break;
        default:
            pass_odd(radix, lanes, &t, from, to);
            break;
        }
        t.s *= radix;
        t.root_step *= radix;
        double *const swap = from;
        from = to;
        to = swap;
    }
    return from;
}

double *imki_stockham_single(const imki_factors *factors, size_t n, const double *roots, double *a,
                             double *b)
{
    return stockham(1, factors, n, roots, a, b);
}

double *imki_stockham_batch(const imki_factors *factors, size_t n, const double *roots, double *a,
                            double *b)
{
    return stockham(IMKI_LANES, factors, n, roots, a, b);
}
