/* SPDX-License-Identifier: Apache-2.0 */
/* Discrete Fourier transform of a length without large prime factors.
 *
 * Short lengths are one Stockham transform. A long one, n = n1 n2 with both near sqrt(n), is done
 * as a matrix x[j1 n2 + j2] in two sweeps over the memory [BAILEY1990]:
 *
 *     X[k1 + n1 k2] = sum_{j2} w(n2)^{j2 k2} w(n)^{j2 k1} sum_{j1} w(n1)^{j1 k1} x[j1 n2 + j2],
 *     w(n) = e^{-2 pi i/n},
 *
 * columns first, then rows, IMKI_LANES of them at a time in a buffer that stays in the cache. */
#include "fourier_internal.h"

#include <string.h>

/* Below this a single transform fits the first-level cache and the sweeps would cost more. */
enum { SINGLE_MAX = 256 };

bool imki_factorise(size_t n, imki_factors *factors)
{
    static const size_t radices[] = {4, 2, 3, 5, 7, 11, 13};
    factors->count = 0;
    for (size_t i = 0; i < sizeof radices / sizeof radices[0]; i++) {
        while (n % radices[i] == 0) {
            factors->radix[factors->count++] = radices[i];
            n /= radices[i];
        }
    }
    return n == 1;
}

/* Largest divisor of n not above its square root. */
static size_t split(size_t n)
{
    size_t root = 1;
    while ((uint64_t)(root + 1) * (root + 1) <= n)
        root++;
    while (n % root != 0)
        root--;
    return root;
}

static size_t round_up(size_t count)
{
    return (count + IMKI_LANES - 1) / IMKI_LANES * IMKI_LANES;
}

/* The parts of the workspace of the two sweeps, each a whole number of cache lines. */
typedef struct sweeps {
    size_t n1, n2;
    size_t scratch, buffer, roots1, roots2, column_roots, table; /* doubles */
} sweeps;

static sweeps sweeps_of(size_t n)
{
    const size_t n1 = split(n);
    const size_t n2 = n / n1;
    return (sweeps){.n1 = n1,
                    .n2 = n2,
                    .scratch = round_up(2 * n),
                    .buffer = 2 * IMKI_LANES * n2,
                    .roots1 = round_up(2 * n1),
                    .roots2 = round_up(2 * n2),
                    .column_roots = 2 * IMKI_LANES * n1,
                    .table = round_up(imki_root_table_size(n))};
}

size_t imki_smooth_workspace(size_t n)
{
    if (n <= SINGLE_MAX)
        return 2 * round_up(2 * n);
    const sweeps s = sweeps_of(n);
    return s.scratch + 2 * s.buffer + s.roots1 + s.roots2 + s.column_roots + s.table;
}

/* Columns j2 … j2 + width - 1 of x, transformed and turned by e^{-2 pi i j2 k1/n}, to y. */
static void sweep_columns(const sweeps *s, size_t j2, size_t width, const imki_factors *factors,
                          const double *roots, const imki_root_table *table,
                          const double *column_roots, const double *x, double *y, double *a,
                          double *b)
{
    enum { L = IMKI_LANES };
    for (size_t j1 = 0; j1 < s->n1; j1++) {
        const double *row = x + 2 * (j1 * s->n2 + j2);
        double *element = a + j1 * 2 * L;
        for (size_t l = 0; l < width; l++) {
            element[l] = row[2 * l];
            element[L + l] = row[2 * l + 1];
        }
        for (size_t l = width; l < L; l++)
            element[l] = element[L + l] = 0.0;
    }
    const double *columns = imki_stockham_batch(factors, s->n1, roots, a, b);
    for (size_t k1 = 0; k1 < s->n1; k1++) {
        const double *element = columns + k1 * 2 * L;
        const double *lane_root = column_roots + k1 * 2 * L;
        double *row = y + 2 * (k1 * s->n2 + j2);
        double wr, wi;
        imki_root_table_get(table, (uint64_t)k1 * j2, &wr, &wi);
        for (size_t l = 0; l < width; l++) {
            const double tr = wr * lane_root[l] - wi * lane_root[L + l];
            const double ti = wr * lane_root[L + l] + wi * lane_root[l];
            row[2 * l] = element[l] * tr - element[L + l] * ti;
            row[2 * l + 1] = element[l] * ti + element[L + l] * tr;
        }
    }
}

/* Rows k1 … k1 + height - 1 of y, transformed, to the places k1 + n1 k2 of x. */
static void sweep_rows(const sweeps *s, size_t k1, size_t height, const imki_factors *factors,
                       const double *roots, const double *y, double *x, double *a, double *b)
{
    enum { L = IMKI_LANES };
    if (height < L)
        memset(a, 0, s->buffer * sizeof *a);
    for (size_t j2 = 0; j2 < s->n2; j2++) {
        const double *column = y + 2 * (k1 * s->n2 + j2);
        double *element = a + j2 * 2 * L;
        for (size_t l = 0; l < height; l++) {
            element[l] = column[2 * l * s->n2];
            element[L + l] = column[2 * l * s->n2 + 1];
        }
    }
    const double *rows = imki_stockham_batch(factors, s->n2, roots, a, b);
    for (size_t k2 = 0; k2 < s->n2; k2++) {
        const double *element = rows + k2 * 2 * L;
        double *place = x + 2 * (k1 + s->n1 * k2);
        for (size_t l = 0; l < height; l++) {
            place[2 * l] = element[l];
            place[2 * l + 1] = element[L + l];
        }
    }
}

static void transform_in_sweeps(size_t n, double *data, double *workspace)
{
    const sweeps s = sweeps_of(n);
    double *scratch = workspace;
    double *a = scratch + s.scratch;
    double *b = a + s.buffer;
    double *roots1 = b + s.buffer;
    double *roots2 = roots1 + s.roots1;
    double *column_roots = roots2 + s.roots2;
    const imki_root_table table = imki_root_table_make(n, column_roots + s.column_roots);
    imki_roots(s.n1, s.n1, roots1);
    imki_roots(s.n2, s.n2, roots2);
    for (size_t k1 = 0; k1 < s.n1; k1++) {
        double *place = column_roots + k1 * 2 * IMKI_LANES;
        for (size_t l = 0; l < IMKI_LANES; l++)
            imki_root_table_get(&table, (uint64_t)k1 * l % n, &place[l], &place[IMKI_LANES + l]);
    }
    imki_factors factors;
    (void)imki_factorise(s.n1, &factors);
    for (size_t j2 = 0; j2 < s.n2; j2 += IMKI_LANES) {
        const size_t width = s.n2 - j2 < IMKI_LANES ? s.n2 - j2 : IMKI_LANES;
        sweep_columns(&s, j2, width, &factors, roots1, &table, column_roots, data, scratch, a, b);
    }
    (void)imki_factorise(s.n2, &factors);
    for (size_t k1 = 0; k1 < s.n1; k1 += IMKI_LANES) {
        const size_t height = s.n1 - k1 < IMKI_LANES ? s.n1 - k1 : IMKI_LANES;
        sweep_rows(&s, k1, height, &factors, roots2, scratch, data, a, b);
    }
}

void imki_smooth_transform(size_t n, double *data, double *workspace)
{
    if (n > SINGLE_MAX) {
        transform_in_sweeps(n, data, workspace);
        return;
    }
    imki_factors factors;
    (void)imki_factorise(n, &factors);
    double *roots = workspace + round_up(2 * n);
    imki_roots(n, n, roots);
    const double *result = imki_stockham_single(&factors, n, roots, data, workspace);
    if (result != data)
        memcpy(data, result, 2 * n * sizeof *data);
}
