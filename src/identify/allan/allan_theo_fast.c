/* SPDX-License-Identifier: Apache-2.0 */
/* Theo1's sum of squares in O(log^2 m) a term, for m too large for the definition.
 *
 * With p[i] = s[i] + s[i+m], h = m/2 and `count` values of i from 0, the squares expand to
 *
 *     sum_{i, k} 1/k (p[i] - s[i+k] - s[i+m-k])^2 = H[h] sum_i p[i]^2
 *         + sum_j s[j]^2 (V[j] + V[count+m-1-j]) - 2 sum_k 1/k (R[k] + R[m-k]) + 2 sum_t C[t]/(h-t)
 *
 *     R[l] = sum_i p[i] s[i+l],   C[t] = sum_{c=h}^{h+count-1} s[c-t] s[c+t],   t = h - k
 *
 * where H[k] = 1 + … + 1/k and V[j] = H[min(j,h)] - H[max(j-count,0)] weighs a square by the k that
 * meet it. R is a correlation, done by Fourier transform. In C the first factor's place u = c - t
 * moves with t, over [h-t, h-t+count): t is cut into strips of width T <= count, and in a strip the
 * places common to all its t are a correlation again, while the two triangles beside it are halved
 * into a square and two triangles until they are small enough to be summed as they stand.
 *
 * Squares and products are large where the phase wanders, their difference is not. So i goes in
 * blocks, of L = 8m sums at most, and from each the line nearest to its sums is taken off, which
 * Theo1 does not see. What that leaves is bounded: smooth sums have squares of (L/4.73)^4 those of
 * their curvature s'' at most (the lowest mode of a free beam), 8.2 m^4, and Theo1 has
 * 0.057 m^4 s''^2 for each i; the terms above, 6 H[h] s^2 together, are then no more than 860 H[h]
 * times the result, and less for all that is not smooth. Four digits are lost at worst, and 1e-15
 * becomes 1e-11; 2.4e-12 is the worst found over noises, drifts, steps, lines and outliers. */
#include "allan_internal.h"

#include "imukit/fourier.h"

/* A block has SPAN m sums where the record allows: more would cost digits, fewer cost time. */
enum { SPAN = 8 };
/* Triangles not wider than this are summed directly; below, transforms cost more. */
enum { LEAF = 128 };
/* Below BREAK_EVEN (count + m) squares the definition is as fast. */
enum { BREAK_EVEN = 400 };
typedef struct theo_block {
    size_t m, half, count;
    double *s;        /* count + m sums less their line */
    double *harmonic; /* half + 1 */
    double *first, *second;
    void *workspace;
    size_t workspace_size;
} theo_block;

static size_t rounded(size_t doubles)
{
    return (doubles + 7) / 8 * 8;
}

/* Smallest comfortable transform: 1, 9/8, 5/4 or 3/2 times a power of two. */
static size_t transform_points(size_t least)
{
    static const size_t eighths[] = {8, 9, 10, 12};
    size_t power = 2;
    while (12 * power < least)
        power *= 2;
    for (size_t i = 0; i < 4; i++)
        if (eighths[i] * power >= least)
            return eighths[i] * power;
    return 16 * power;
}

/* Workspace for transforms of this length and of all shorter ones. */
static size_t transform_bytes(size_t points)
{
    size_t most = 0;
    for (size_t p = transform_points(1); p <= points; p = transform_points(p + 1)) {
        const size_t bytes = imk_fourier_workspace_size(p);
        most = bytes > most ? bytes : most;
    }
    return most;
}

/* Values of i in a block: the blocks of a record differ by one at most. */
static size_t block_count(size_t count, size_t m)
{
    const size_t most = (SPAN - 1) * m, blocks = (count + most - 1) / most;
    return (count + blocks - 1) / blocks;
}

static bool is_fast(size_t n, size_t m)
{
    const double count = (double)(n + 1 - m);
    return count * (double)m / 2 > BREAK_EVEN * (count + (double)m);
}

size_t imki_allan_theo_doubles(size_t n, size_t m)
{
    if (!is_fast(n, m))
        return 0;
    const size_t sums = block_count(n + 1 - m, m) + m, points = transform_points(sums);
    return rounded(sums) + rounded(m / 2 + 1) + 2 * rounded(2 * points) +
           rounded(transform_bytes(points) / sizeof(double) + 1);
}

/* x + i y, zeros behind. */
static void load(double *z, size_t points, size_t size, const double *x, size_t other,
                 const double *y)
{
    for (size_t j = 0; j < points; j++) {
        z[2 * j] = j < size ? x[j] : 0;
        z[2 * j + 1] = j < other ? y[j] : 0;
    }
}

/* Cross spectrum conj(X) Y at place f from the transform of x + i y there and at points - f. */
static void cross(const double *a, const double *c, double *re, double *im)
{
    const double xr = a[0] + c[0], xi = a[1] - c[1], yr = a[1] + c[1], yi = c[0] - a[0];
    *re = (xr * yr + xi * yi) / 4;
    *im = (xr * yi - xi * yr) / 4;
}

/* From x + i y in `first` and `second`: the correlations sum_u x[u] y[u+l] at lag l as real
 * (first) and imaginary (second) parts of first[2l]. */
static void correlate(theo_block *b, size_t points)
{
    double *z = b->first, *w = b->second;
    imk_fourier(points, z, 0, b->workspace, b->workspace_size);
    imk_fourier(points, w, 0, b->workspace, b->workspace_size);
    for (size_t f = 0; f <= points / 2; f++) {
        const size_t g = f > 0 ? points - f : 0;
        double zr, zi, wr, wi;
        cross(z + 2 * f, z + 2 * g, &zr, &zi);
        cross(w + 2 * f, w + 2 * g, &wr, &wi);
        z[2 * f] = zr - wi;
        z[2 * f + 1] = zi + wr;
        z[2 * g] = zr + wi;
        z[2 * g + 1] = wr - zi;
    }
    imk_fourier(points, z, 1, b->workspace, b->workspace_size);
}

/* A part of C in which all t have the same places: t, width of them; u, `size` of them. */
typedef struct rectangle {
    size_t t, width, u, size;
} rectangle;

static bool is_empty(rectangle r)
{
    return r.width == 0 || r.size == 0;
}

/* Values of the second factor that meet it. */
static size_t reach(rectangle r)
{
    return is_empty(r) ? 0 : r.size + 2 * (r.width - 1);
}

static void load_rectangle(const theo_block *b, double *z, size_t points, rectangle r)
{
    const size_t other = reach(r);
    load(z, points, other ? r.size : 0, b->s + r.u, other, b->s + r.u + (other ? 2 * r.t : 0));
}

/* sum_t C[t]/(h-t) from every other lag of a correlation. */
static double weigh(const theo_block *b, rectangle r, const double *correlation)
{
    double total = 0;
    for (size_t j = 0; j < r.width && r.size > 0; j++)
        total += correlation[4 * j] / (double)(b->half - r.t - j);
    return total;
}

static double rectangles(theo_block *b, rectangle one, rectangle other)
{
    const size_t wider = reach(one) > reach(other) ? reach(one) : reach(other);
    if (wider == 0)
        return 0;
    const size_t points = transform_points(wider);
    load_rectangle(b, b->first, points, one);
    load_rectangle(b, b->second, points, other);
    correlate(b, points);
    return weigh(b, one, b->first) + weigh(b, other, b->first + 1);
}

/* sum over `size` places from u of s[u] s[u+2t]. */
static double products(const double *s, size_t u, size_t t, size_t size)
{
    const double *x = s + u, *y = s + u + 2 * t;
    double lane[IMKI_ALLAN_LANES] = {0};
    size_t i = 0;
    for (; i + IMKI_ALLAN_LANES <= size; i += IMKI_ALLAN_LANES)
        for (size_t l = 0; l < IMKI_ALLAN_LANES; l++)
            lane[l] += x[i + l] * y[i + l];
    for (; i < size; i++)
        lane[0] += x[i] * y[i];
    return imki_sum_lanes(lane);
}

/* The triangles of a strip of t from `t`, T wide: before the common places, which begin at u, those
 * u - 1 - v with v < j, j = t's place in the strip; behind them, from u + count - T, those v with
 * v < T - j. Cut at T i/2^level. */
static double triangles(theo_block *b, size_t t, size_t width)
{
    const size_t u = b->half - t, behind = u + b->count - width;
    size_t pieces = 1;
    double total = 0;
    for (; width / pieces > LEAF; pieces *= 2)
        for (size_t i = 0; i < pieces; i++) {
            const size_t low = width * i / pieces, high = width * (i + 1) / pieces,
                         middle = width * (2 * i + 1) / (2 * pieces);
            total += rectangles(
                b, (rectangle){t + middle, high - middle, u - middle, middle - low},
                (rectangle){t + low, middle - low, behind + width - high, high - middle});
        }
    for (size_t i = 0; i < pieces; i++) {
        const size_t low = width * i / pieces, high = width * (i + 1) / pieces;
        for (size_t j = low; j < high; j++)
            total += (products(b->s, u - j, t + j, j - low) +
                      products(b->s, behind + width - high, t + j, high - j)) /
                     (double)(b->half - t - j);
    }
    return total;
}

/* sum_t C[t]/(h-t) but for the common places of the first strip. */
static double mirrored(theo_block *b)
{
    double total = 0;
    for (size_t t = 0; t < b->half; t += b->count) {
        const size_t left = b->half - t, width = left < b->count ? left : b->count;
        if (t > 0)
            total += rectangles(b, (rectangle){t, width, b->half - t, b->count - width},
                                (rectangle){0, 0, 0, 0});
        total += triangles(b, t, width);
    }
    return total;
}

/* sum_k 1/k (R[k] + R[m-k]) less sum_t C[t]/(h-t) of the common places of the first strip. */
static double correlations(theo_block *b)
{
    const size_t m = b->m, sums = b->count + m, points = transform_points(sums);
    const size_t width = b->half < b->count ? b->half : b->count;
    const rectangle common = {0, width, b->half, b->count - width};
    for (size_t j = 0; j < points; j++) {
        b->first[2 * j] = j < b->count ? b->s[j] + b->s[j + m] : 0;
        b->first[2 * j + 1] = j < sums ? b->s[j] : 0;
    }
    load_rectangle(b, b->second, points, common);
    correlate(b, points);
    double total = 0;
    for (size_t k = 1; k <= b->half; k++)
        total += (b->first[2 * k] + b->first[2 * (m - k)]) / (double)k;
    return total - weigh(b, common, b->first + 1);
}

/* H[h] sum_i p[i]^2 + sum_j s[j]^2 (V[j] + V[count+m-1-j]), by blocks of terms. */
static double squares(const theo_block *b)
{
    const double *s = b->s, *harmonic = b->harmonic;
    const size_t m = b->m, h = b->half, count = b->count, last = count + m - 1;
    double total = 0;
    for (size_t begin = 0; begin <= last; begin += IMKI_ALLAN_BLOCK) {
        double part = 0;
        for (size_t j = begin; j <= last && j < begin + IMKI_ALLAN_BLOCK; j++) {
            const size_t mirror = last - j;
            const double near = harmonic[j < h ? j : h], far = harmonic[mirror < h ? mirror : h];
            const double past = j < count ? 0 : harmonic[j - count < h ? j - count : h];
            const double ahead =
                mirror < count ? 0 : harmonic[mirror - count < h ? mirror - count : h];
            part += s[j] * s[j] * ((near - past) + (far - ahead));
            if (j < count) {
                const double p = s[j] + s[j + m];
                part += p * p * harmonic[h];
            }
        }
        total += part;
    }
    return total;
}

/* The sums less their least-squares line. */
static void take_line_off(size_t size, const double *sums, double *s)
{
    const double centre = ((double)size - 1) / 2, base = sums[size / 2];
    double mean = 0, slope = 0;
    for (size_t begin = 0; begin < size; begin += IMKI_ALLAN_BLOCK) {
        double value = 0, moment = 0;
        for (size_t j = begin; j < size && j < begin + IMKI_ALLAN_BLOCK; j++) {
            const double v = sums[j] - base;
            value += v;
            moment += v * ((double)j - centre);
        }
        mean += value;
        slope += moment;
    }
    mean /= (double)size;
    slope /= (double)size * ((double)size * (double)size - 1) / 12;
    for (size_t j = 0; j < size; j++)
        s[j] = (sums[j] - base) - (mean + slope * ((double)j - centre));
}

static theo_block lay_out(size_t n, size_t m, double *scratch)
{
    const size_t sums = block_count(n + 1 - m, m) + m, points = transform_points(sums);
    theo_block b = {.m = m, .half = m / 2, .s = scratch};
    b.harmonic = b.s + rounded(sums);
    b.first = b.harmonic + rounded(b.half + 1);
    b.second = b.first + rounded(2 * points);
    b.workspace = b.second + rounded(2 * points);
    b.workspace_size = transform_bytes(points);
    b.harmonic[0] = 0;
    double rest = 0; /* what rounding took: half a million terms would cost four digits */
    for (size_t k = 1; k <= b.half; k++) {
        const double term = 1 / (double)k + rest;
        b.harmonic[k] = b.harmonic[k - 1] + term;
        rest = term - (b.harmonic[k] - b.harmonic[k - 1]);
    }
    return b;
}

double imki_allan_theo_fast(size_t n, const double *sums, size_t m, double *scratch)
{
    theo_block b = lay_out(n, m, scratch);
    const size_t all = n + 1 - m, most = block_count(all, m);
    double total = 0;
    for (size_t begin = 0; begin < all; begin += most) {
        b.count = all - begin < most ? all - begin : most;
        take_line_off(b.count + m, sums + begin, b.s);
        const double sum = squares(&b) - 2 * (correlations(&b) - mirrored(&b));
        total += sum > 0 ? sum : 0; /* the rounding of a block without noise may be negative */
    }
    return total;
}
