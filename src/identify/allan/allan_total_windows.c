/* SPDX-License-Identifier: Apache-2.0 */
/* Modified total and Hadamard total variances [RILEY2008, (26), (27)].
 *
 * Each stretch of L = 3m values x (sums for MTOT, rates for HTOT) loses its trend (the slope
 * between its two halves), is continued by its mirror images to 9m values, and gives the 6m second
 * differences z of neighbouring means of m:
 *
 *     MTOT = 1/(2 m^2 W) sum_W 1/(6m) sum z^2,  W = n - 3m + 2 stretches of sums
 *     HTOT = 1/(6 W)     sum_W 1/(6m) sum z^2,  W = n - 3m + 1 stretches of rates
 *
 * Done as defined that is O(n m). Here it is O(n). With the sums U_0 = 0 … U_L = 0 of the stretch
 * (mean and trend off), mirroring makes U odd with period 2L, and m z is its third difference, so
 *
 *     m^2 sum z^2 = sum over a period of
 *                   20 U_k^2 - 30 U_k U_{k+m} + 12 U_k U_{k+2m} - 2 U_k U_{k+3m}
 *
 * which by symmetry is a form U'BU of products U_k U_{k+l}, l = 0, m, 2m, and U_k U_{t-k}, t = m,
 * 2m, 3m, 4m, 5m, within the stretch. Let V be the running sums of x over a block of stretches, and
 * q_p = V_p e_0 + D e_1 + b e_2 the parabola that the stretch at p takes off, e = 1, k/m,
 * k(k-L)/2m^2. Then U'BU = V'BV - 2 q'BV + q'Bq, and
 *
 * - V'BV added over the block: a product V_i V_{i+l} occurs in a known number of stretches; the
 *   V_j that meet V_i in a sum over U_k U_{t-k} are every second one of an interval (|i - j| and
 *   i + j are bounded), whose sum is a difference of two running sums;
 * - B e is a parabola on each third of the stretch, beside single values at their ends: q'BV
 *   follows from running moments of V.
 *
 * A block has 4m stretches and has a trend of its own taken off first, so that all terms are of the
 * size of what remains and no digits are lost however long the record is. */
#include "allan_internal.h"

enum { THIRDS = 3, BASIS = 3, STRETCHES_LEAST = 16, SHORT = 4 };

typedef struct stretch {
    size_t m, length;
    double gram[BASIS][BASIS];             /* e_i' B e_j */
    double parabola[BASIS][THIRDS][3];     /* B e_j inside a third, by powers of (k - start)/m */
    double end[BASIS][THIRDS + 1];         /* B e_j at 0, m, 2m, 3m */
    double row[BASIS][THIRDS * SHORT + 1]; /* the whole of B e_j where m < SHORT */
} stretch;

static double basis(const stretch *w, size_t j, size_t k)
{
    const double u = (double)k / (double)w->m;
    return j == 0 ? 1 : j == 1 ? u : 0.5 * u * (u - 3);
}

/* (B e_j)_k */
static double form_row(const stretch *w, size_t j, size_t k)
{
    const size_t m = w->m;
    double one = 0, two = 0; /* partners at distance m and 2m, mirrored ones with a minus */
    if (k <= 2 * m)
        one += basis(w, j, k + m);
    if (k >= m)
        one += basis(w, j, k - m);
    if (k <= m)
        one -= basis(w, j, m - k);
    if (k >= 2 * m)
        one -= basis(w, j, 5 * m - k);
    if (k <= m)
        two += basis(w, j, k + 2 * m);
    if (k >= 2 * m)
        two += basis(w, j, k - 2 * m);
    if (k <= 2 * m)
        two -= basis(w, j, 2 * m - k);
    if (k >= m)
        two -= basis(w, j, 4 * m - k);
    return 40 * basis(w, j, k) - 30 * one + 12 * two + 4 * basis(w, j, 3 * m - k);
}

/* Parabola through the values at k = start + 1, the middle and start + m - 1, by powers of
 * (k - start)/m. */
static void through_three(const stretch *w, size_t j, size_t third, double *coefficient)
{
    const size_t m = w->m, start = third * m, at[3] = {1, m / 2, m - 1};
    double u[3], v[3];
    for (size_t i = 0; i < 3; i++) {
        u[i] = (double)at[i] / (double)m;
        v[i] = form_row(w, j, start + at[i]);
    }
    const double first = (v[1] - v[0]) / (u[1] - u[0]), second = (v[2] - v[1]) / (u[2] - u[1]);
    const double curvature = (second - first) / (u[2] - u[0]);
    coefficient[2] = curvature;
    coefficient[1] = first - curvature * (u[0] + u[1]);
    coefficient[0] = v[0] - u[0] * (coefficient[1] + u[0] * curvature);
}

static void prepare(stretch *w, size_t m)
{
    *w = (stretch){.m = m, .length = 3 * m};
    for (size_t j = 0; j < BASIS; j++) {
        for (size_t k = 0; k <= w->length; k++) {
            const double row = form_row(w, j, k);
            for (size_t i = 0; i < BASIS; i++)
                w->gram[i][j] += basis(w, i, k) * row;
            if (m < SHORT)
                w->row[j][k] = row;
        }
        for (size_t third = 0; third <= THIRDS; third++)
            w->end[j][third] = form_row(w, j, third * m);
        for (size_t third = 0; third < THIRDS && m >= SHORT; third++)
            through_three(w, j, third, w->parabola[j][third]);
    }
}

/* A block of stretches: V of `size` + 1 values and its running sums. */
typedef struct block {
    size_t stretches, size;
    double *v;
    double *alternate; /* [i + 2] = v[i] + v[i-2] + … */
    double *moment[3]; /* [i] = sum over i' < i of v[i'] (i'/m - centre)^power */
    double centre;
} block;

static void fill(const stretch *w, block *b, bool hadamard, const double *s)
{
    const size_t half = b->size / 2;
    double left = 0, right = 0;
    if (!hadamard) {
        for (size_t i = 0; i < half; i++) {
            left += s[i] - s[half];
            right += s[b->size - 1 - i] - s[half];
        }
    } else {
        left = s[half] - s[0];
        right = s[b->size] - s[b->size - half];
    }
    const double apart = (double)(b->size - half), middle = 0.5 * ((double)b->size - 1);
    const double slope = (right - left) / ((double)half * apart);
    const double mean = 0.5 * (right + left) / (double)half;
    double v = 0;
    b->v[0] = 0;
    for (size_t i = 0; i < b->size; i++) {
        const double x = hadamard ? s[i + 1] - s[i] : s[i] - s[half];
        b->v[i + 1] = v += x - mean - slope * ((double)i - middle);
    }
    b->alternate[0] = b->alternate[1] = 0;
    b->moment[0][0] = b->moment[1][0] = b->moment[2][0] = 0;
    b->centre = 0.5 * (double)b->size / (double)w->m;
    for (size_t i = 0; i <= b->size; i++) {
        const double u = (double)i / (double)w->m - b->centre, value = b->v[i];
        b->alternate[i + 2] = b->alternate[i] + value;
        b->moment[0][i + 1] = b->moment[0][i] + value;
        b->moment[1][i + 1] = b->moment[1][i] + u * value;
        b->moment[2][i + 1] = b->moment[2][i] + u * u * value;
    }
}

/* sum_p sum_{k=0}^{last} V_{p+k} V_{p+k+lag} */
static double forward(const block *b, size_t lag, size_t last)
{
    const double *v = b->v;
    const size_t top = b->stretches - 1;
    double total = 0;
    for (size_t j = 0; j <= top + last; j++) {
        const size_t upper = j < top ? j : top, lower = j > last ? j - last : 0;
        total += v[j] * v[j + lag] * (double)(upper - lower + 1);
    }
    return total;
}

/* sum_p sum_{k=(t-reach)/2}^{(t+reach)/2} V_{p+k} V_{p+t-k} */
static double backward(const block *b, size_t t, size_t reach)
{
    const size_t limit = 2 * (b->stretches - 1) + t;
    double total = 0;
    for (size_t i = (t - reach) / 2; i <= (limit + reach) / 2; i++) {
        const size_t low = 2 * i > t + reach ? i - reach : t - i;
        const size_t high = 2 * i + reach < limit ? i + reach : limit - i;
        total += b->v[i] * (b->alternate[high + 2] - b->alternate[low]);
    }
    return total;
}

/* sum over k of (B e_j)_k V_{p+k} for the three e_j. */
static void project(const stretch *w, const block *b, size_t p, double *projection)
{
    const size_t m = w->m;
    const double *v = b->v + p;
    for (size_t j = 0; j < BASIS; j++) {
        projection[j] = 0;
        if (m < SHORT)
            for (size_t k = 0; k <= w->length; k++)
                projection[j] += w->row[j][k] * v[k];
        else
            for (size_t third = 0; third <= THIRDS; third++)
                projection[j] += w->end[j][third] * v[third * m];
    }
    for (size_t third = 0; third < THIRDS && m >= SHORT; third++) {
        const size_t from = p + third * m + 1, to = p + (third + 1) * m;
        const double start = (double)(p + third * m) / (double)m - b->centre;
        const double m0 = b->moment[0][to] - b->moment[0][from];
        const double m1 = b->moment[1][to] - b->moment[1][from];
        const double m2 = b->moment[2][to] - b->moment[2][from];
        const double first = m1 - start * m0, second = m2 - start * (m1 + first);
        for (size_t j = 0; j < BASIS; j++) {
            const double *c = w->parabola[j][third];
            projection[j] += c[0] * m0 + c[1] * first + c[2] * second;
        }
    }
}

static double block_squares(const stretch *w, const block *b)
{
    const size_t m = w->m, length = w->length, half = length / 2, rest = length - half;
    double total = 40 * forward(b, 0, length) - 60 * forward(b, m, 2 * m) +
                   24 * forward(b, 2 * m, m) + 30 * (backward(b, m, m) + backward(b, 5 * m, m)) -
                   12 * (backward(b, 2 * m, 2 * m) + backward(b, 4 * m, 2 * m)) +
                   4 * backward(b, 3 * m, 3 * m);
    const double bend = (double)m * (double)m / ((double)half * (double)rest);
    for (size_t p = 0; p < b->stretches; p++) {
        const double *v = b->v + p;
        const double a[BASIS] = {v[0], (v[length] - v[0]) / 3,
                                 bend * ((v[length] - v[rest]) - (v[half] - v[0]))};
        double projection[BASIS];
        project(w, b, p, projection);
        for (size_t j = 0; j < BASIS; j++)
            total += a[j] * (a[0] * w->gram[0][j] + a[1] * w->gram[1][j] + a[2] * w->gram[2][j] -
                             2 * projection[j]);
    }
    return total;
}

static size_t block_stretches(size_t m)
{
    return 4 * m > STRETCHES_LEAST ? 4 * m : STRETCHES_LEAST;
}

size_t imki_allan_windows_doubles(size_t n, size_t m)
{
    const size_t all = n + 2 - 3 * m, most = block_stretches(m);
    const size_t size = (all < most ? all : most) - 1 + 3 * m;
    return 5 * (size + 3);
}

double imki_allan_windows(bool hadamard, size_t n, const double *sums, size_t m, size_t *count,
                          double *scratch)
{
    stretch w;
    prepare(&w, m);
    const size_t all = n + (hadamard ? 1 : 2) - 3 * m, most = block_stretches(m);
    const size_t room = (imki_allan_windows_doubles(n, m)) / 5;
    double total = 0;
    for (size_t first = 0; first < all; first += most) {
        block b = {.stretches = all - first < most ? all - first : most,
                   .v = scratch,
                   .alternate = scratch + room,
                   .moment = {scratch + 2 * room, scratch + 3 * room, scratch + 4 * room}};
        b.size = b.stretches - 1 + w.length;
        fill(&w, &b, hadamard, sums + first);
        total += block_squares(&w, &b);
    }
    *count = all;
    const double length = (double)m, mean = total / (6 * length * length * length * (double)all);
    return hadamard ? mean / 6 : mean / (2 * length * length);
}
