/* SPDX-License-Identifier: Apache-2.0 */
/* Discrete Fourier transform of any length.
 *
 * Short lengths are one Stockham transform. A long one, n = n1 n2 with both near sqrt(n), is done
 * as a matrix x[j1 n2 + j2] in two sweeps over the memory [BAILEY1990]:
 *
 *     X[k1 + n1 k2] = sum_{j2} w(n2)^{j2 k2} w(n)^{j2 k1} sum_{j1} w(n1)^{j1 k1} x[j1 n2 + j2],
 *     w(n) = e^{-2 pi i/n},
 *
 * columns first, then rows, IMKI_LANES of them to a batch, in buffers that stay in the cache.
 * Lengths with a prime factor above 13 go to bluestein.c. */
#include "imukit/fourier.h"

#include "base/fourier_internal.h"

#include <string.h>

/* Below this a single transform fits the first-level cache and the sweeps would cost more. */
enum { SINGLE_MAX = 256, GROUPS_MAX = 4 };

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

/* The two sweeps: sizes of the matrix, and of the parts of the workspace in doubles, each a whole
 * number of cache lines. */
typedef struct sweeps {
    size_t n1, n2;
    size_t groups; /* batches of lanes gathered together */
    size_t scratch, buffer, roots1, roots2, column_roots, table;
} sweeps;

/* Four batches side by side read and write 512 bytes at a time, which spares page look-ups; as long
 * as they and the spare buffer fit the second-level cache of most processors. */
static size_t groups_for(size_t buffer)
{
    const size_t cache = 1 << 17; /* doubles: 1 MiB */
    return 5 * buffer <= cache ? GROUPS_MAX : 3 * buffer <= cache ? 2 : 1;
}

static sweeps sweeps_of(size_t n)
{
    const size_t n1 = split(n);
    const size_t n2 = n / n1;
    const size_t buffer = 2 * IMKI_LANES * n2;
    return (sweeps){.n1 = n1,
                    .n2 = n2,
                    .groups = groups_for(buffer),
                    .scratch = round_up(2 * n),
                    .buffer = buffer,
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
    return s.scratch + (s.groups + 1) * s.buffer + s.roots1 + s.roots2 + s.column_roots + s.table;
}

/* Transform the gathered batches; the results are in buffers[0 … groups - 1], the last is spare. */
static void transform_batches(const sweeps *s, size_t used, const imki_factors *factors, size_t n,
                              const double *roots, double **buffers)
{
    for (size_t g = 0; g < used; g++) {
        double *const spare = buffers[s->groups];
        double *const result = imki_stockham_batch(factors, n, roots, buffers[g], spare);
        if (result == spare) {
            buffers[s->groups] = buffers[g];
            buffers[g] = spare;
        }
    }
}

/* Columns j2 … j2 + width - 1 of x, transformed and turned by e^{-2 pi i j2 k1/n}, to y. */
static void sweep_columns(const sweeps *s, size_t j2, size_t width, const imki_factors *factors,
                          const double *roots, const imki_root_table *table,
                          const double *column_roots, const double *x, double *y, double **buffers)
{
    enum { L = IMKI_LANES };
    const size_t used = (width + L - 1) / L;
    for (size_t j1 = 0; j1 < s->n1; j1++) {
        const double *row = x + 2 * (j1 * s->n2 + j2);
        for (size_t g = 0; g < used; g++) {
            double *element = buffers[g] + j1 * 2 * L;
            const size_t lanes = width - g * L < L ? width - g * L : L;
            for (size_t l = 0; l < lanes; l++) {
                element[l] = row[2 * (g * L + l)];
                element[L + l] = row[2 * (g * L + l) + 1];
            }
            for (size_t l = lanes; l < L; l++)
                element[l] = element[L + l] = 0.0;
        }
    }
    transform_batches(s, used, factors, s->n1, roots, buffers);
    for (size_t k1 = 0; k1 < s->n1; k1++) {
        const double *lane_root = column_roots + k1 * 2 * L;
        double *row = y + 2 * (k1 * s->n2 + j2);
        for (size_t g = 0; g < used; g++, row += 2 * L) {
            const double *element = buffers[g] + k1 * 2 * L;
            const size_t lanes = width - g * L < L ? width - g * L : L;
            double wr, wi;
            imki_root_table_get(table, (uint64_t)k1 * (j2 + g * L), &wr, &wi);
            for (size_t l = 0; l < lanes; l++) {
                const double tr = wr * lane_root[l] - wi * lane_root[L + l];
                const double ti = wr * lane_root[L + l] + wi * lane_root[l];
                row[2 * l] = element[l] * tr - element[L + l] * ti;
                row[2 * l + 1] = element[l] * ti + element[L + l] * tr;
            }
        }
    }
}

/* Rows k1 … k1 + height - 1 of y, transformed, to the places k1 + n1 k2 of x. */
static void sweep_rows(const sweeps *s, size_t k1, size_t height, const imki_factors *factors,
                       const double *roots, const double *y, double *x, double **buffers)
{
    enum { L = IMKI_LANES };
    const size_t used = (height + L - 1) / L;
    for (size_t g = 0; g < used; g++) {
        const size_t lanes = height - g * L < L ? height - g * L : L;
        if (lanes < L)
            memset(buffers[g], 0, s->buffer * sizeof *buffers[g]);
        for (size_t j2 = 0; j2 < s->n2; j2++) {
            const double *column = y + 2 * ((k1 + g * L) * s->n2 + j2);
            double *element = buffers[g] + j2 * 2 * L;
            for (size_t l = 0; l < lanes; l++) {
                element[l] = column[2 * l * s->n2];
                element[L + l] = column[2 * l * s->n2 + 1];
            }
        }
    }
    transform_batches(s, used, factors, s->n2, roots, buffers);
    for (size_t k2 = 0; k2 < s->n2; k2++) {
        double *place = x + 2 * (k1 + s->n1 * k2);
        for (size_t g = 0; g < used; g++, place += 2 * L) {
            const double *element = buffers[g] + k2 * 2 * L;
            const size_t lanes = height - g * L < L ? height - g * L : L;
            for (size_t l = 0; l < lanes; l++) {
                place[2 * l] = element[l];
                place[2 * l + 1] = element[L + l];
            }
        }
    }
}

static void transform_in_sweeps(size_t n, double *data, double *workspace)
{
    const sweeps s = sweeps_of(n);
    double *buffers[GROUPS_MAX + 1];
    double *scratch = workspace;
    double *next = scratch + s.scratch;
    for (size_t g = 0; g <= s.groups; g++, next += s.buffer)
        buffers[g] = next;
    double *roots1 = next;
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
    const size_t together = s.groups * IMKI_LANES;
    imki_factors factors;
    (void)imki_factorise(s.n1, &factors);
    for (size_t j2 = 0; j2 < s.n2; j2 += together) {
        const size_t width = s.n2 - j2 < together ? s.n2 - j2 : together;
        sweep_columns(&s, j2, width, &factors, roots1, &table, column_roots, data, scratch,
                      buffers);
    }
    (void)imki_factorise(s.n2, &factors);
    for (size_t k1 = 0; k1 < s.n1; k1 += together) {
        const size_t height = s.n1 - k1 < together ? s.n1 - k1 : together;
        sweep_rows(&s, k1, height, &factors, roots2, scratch, data, buffers);
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
