/* SPDX-License-Identifier: Apache-2.0 */
/* How well the sigmas of a solution are known. The variance of a parameter is a sum over the parts,
 *
 *     v = sum v_g,   v_g = Cov J_g^T J_g Cov,
 *
 * each proportional to the squared factor of its part. The information of the restricted likelihood
 * about the logarithms of these is F/2 [PATTERSON1971],
 *
 *     F_gh = sum over rows i of g, j of h of phi_i phi_j R_ij^2,   R = I - M,  M = J Cov J^T,
 *
 * so that v has v^2/(sum v_g F^-1_gh v_h) degrees of freedom [SATTERTHWAITE1946]. F is not
 * diagonal: the readings of a pose share what its attitude leaves of them, and so do turns and
 * rests, placements and readings. Parts whose factor was not estimated, and what is known before,
 * count as certain. Factors that err also give the rows other weights than the best, and make Cov
 * too small; both together by [KENWARD1997]
 *
 *     2 sum of 2 F^-1_gh phi_i phi_j c_i c_j R_ij,   c = Cov J^T.
 *
 * M_ij of rows of different items goes through the globals, b_i C b_j with b a row after its locals
 * have given way; where they have locals in common, through these as well. */
#include "estimator_internal.h"

#include "base/algebra/vector_internal.h"
#include "imukit/linear_algebra.h"

#include <math.h>
#include <string.h>

/* A direction of F below this share of the largest: two parts that nothing tells apart. */
static const double least_information = 1e-6;
/* Of a variance; where it is more, the factors are hardly known, and their degrees say so. */
static const double largest_correction = 1.0;

typedef struct information {
    int parts, index[IMKI_PARTS];        /* of a part in F; -1: not estimated */
    double *f;                           /* then its inverse */
    double *vector;                      /* eigenvectors of F */
    double (*share)[IMK_CORRELATED_MAX]; /* of a part in the variances */
    double more[IMK_CORRELATED_MAX];     /* sum of F^-1 phi phi c c R */
    bool inverted;
} information;

enum { INFORMATION = 2 * IMKI_PARTS * IMKI_PARTS + IMKI_PARTS * IMK_CORRELATED_MAX };

size_t imki_freedoms_room(void)
{
    return INFORMATION;
}

static void matrix_vector(size_t n, const double *a, const double *x, double *out)
{
    for (size_t i = 0; i < n; i++)
        out[i] = imki_dot(n, a + i * n, x);
}

/* Rows of a thing, and what the globals see of them; `place` 0 or 1. @return their number */
static int take_rows(imki_estimator *e, size_t thing, size_t place)
{
    const int count = imki_rows_of(e, thing);
    const size_t first = place * IMKI_ROWS_MAX;
    if (place > 0)
        memcpy(e->row + first, e->row, (size_t)count * sizeof *e->row);
    for (size_t i = 0; i < (size_t)count; i++) {
        double *moved = e->moved + (first + i) * e->globals;
        imki_row_project(&e->normal, &e->row[first + i], e->seen + (first + i) * e->globals);
        matrix_vector(e->globals, e->normal.covariance, e->seen + (first + i) * e->globals, moved);
    }
    return count;
}

/* Rows i and j: what they have in F beyond the globals' part, or in the corrections. */
static void add_rows(const imki_estimator *e, size_t i, size_t j, bool twice, information *f)
{
    const size_t g = e->globals;
    const imki_row *x = &e->row[i], *y = &e->row[j];
    const int of_x = f->index[x->part], of_y = f->index[y->part];
    if (of_x < 0 || of_y < 0)
        return;
    const double weight = x->share * y->share, own = i == j ? 1.0 : 0.0;
    const double local = own - imki_through_locals(&e->normal, x, y);
    const double *c = e->moved + i * g, *d = e->moved + j * g;
    if (!f->inverted) {
        const double through = imki_dot(g, c, e->seen + j * g);
        const double sum = weight * ((local - through) * (local - through) - through * through);
        f->f[of_x * f->parts + of_y] += sum;
        if (twice)
            f->f[of_y * f->parts + of_x] += sum;
        return;
    }
    const double factor = (twice ? 2.0 : 1.0) * weight * local * f->f[of_x * f->parts + of_y];
    for (size_t p = 0; factor != 0.0 && p < e->parameters; p++)
        f->more[p] += factor * c[p] * d[p];
}

/* Rows of two things, or of one with itself. */
static void add_pair(imki_estimator *e, size_t a, size_t b, information *f)
{
    const size_t place = a == b ? 0 : IMKI_ROWS_MAX;
    const int others = a == b ? 0 : take_rows(e, b, 1), rows = take_rows(e, a, 0);
    for (size_t i = 0; i < (size_t)rows; i++)
        for (size_t j = 0; j < (size_t)(a == b ? rows : others); j++)
            add_rows(e, i, place + j, a != b, f);
}

/* All pairs that have more in common than the globals; of turns, the neighbours. */
static void add_pairs(imki_estimator *e, information *f)
{
    for (size_t k = 0; k < imki_things(e); k++)
        add_pair(e, k, k, f);
    for (size_t i = 0; i < e->observations; i++)
        if (e->problem->observation[i].knowledge == IMK_INPUT_PLACED)
            add_pair(e, i, e->items + i, f);
    for (size_t t = 0; t < e->turns; t++) {
        const size_t from = (size_t)e->problem->turn[t].from, to = (size_t)e->problem->turn[t].to;
        add_pair(e, e->observations + t, from, f);
        add_pair(e, e->observations + t, to, f);
        add_pair(e, from, to, f);
    }
}

/* C sum phi b b^T of each part, in e->squares; and the shares of the parameters' variances. */
static void add_up(imki_estimator *e, information *f)
{
    const size_t g = e->globals;
    memset(e->squares, 0, (size_t)f->parts * g * g * sizeof *e->squares);
    for (size_t k = 0; k < imki_things(e); k++) {
        const int count = take_rows(e, k, 0);
        for (int i = 0; i < count; i++) {
            const int of = f->index[e->row[i].part];
            const double *seen = e->seen + (size_t)i * g, *moved = e->moved + (size_t)i * g;
            if (of < 0)
                continue;
            double *sum = e->squares + (size_t)of * g * g;
            for (size_t a = 0; a < g; a++)
                for (size_t b = 0; moved[a] != 0.0 && b < g; b++)
                    sum[a * g + b] += e->row[i].share * moved[a] * seen[b];
            for (size_t p = 0; p < e->parameters; p++)
                f->share[of][p] += e->row[i].share * moved[p] * moved[p];
        }
    }
}

/* The globals' part of F: traces of products. */
static void add_globals(const imki_estimator *e, information *f)
{
    const size_t g = e->globals;
    for (int x = 0; x < f->parts; x++)
        for (int y = 0; y < f->parts; y++) {
            const double *a = e->squares + (size_t)x * g * g, *b = e->squares + (size_t)y * g * g;
            for (size_t i = 0; i < g; i++)
                for (size_t j = 0; j < g; j++)
                    f->f[x * f->parts + y] += a[i * g + j] * b[j * g + i];
        }
}

/* The globals' part of the correction of a parameter. */
static double through_globals(const imki_estimator *e, const information *f, size_t p)
{
    const size_t g = e->globals;
    double sum = 0.0, right[IMKI_GLOBALS_MAX];
    for (int y = 0; y < f->parts; y++) {
        matrix_vector(g, e->squares + (size_t)y * g * g, e->normal.covariance + p * g, right);
        for (int x = 0; x < f->parts; x++) {
            const double *left = e->squares + (size_t)x * g * g + p * g;
            sum += f->f[x * f->parts + y] * imki_dot(g, left, right);
        }
    }
    return sum;
}

/* A part of the squares that is expected of slow noise, and taken off, scatters as well as the
 * rest. Where that is more than half, the least white factor keeps the whole from falling. */
static double widened(const imki_fit *fit, int part)
{
    return 1.0 + fmin(1.0, fit->slow_square[part] / fit->shared_redundancy[part]);
}

static imk_status invert(information *f)
{
    double value[IMKI_PARTS];
    const double *vector = f->vector;
    const int n = f->parts;
    const imk_status status = imk_symmetric_eigen((size_t)n, f->f, value, f->vector);
    memset(f->f, 0, (size_t)(n * n) * sizeof *f->f);
    for (int k = 0; status == IMK_OK && k < n; k++) {
        const double scale = 1.0 / fmax(value[k], least_information * value[n - 1]);
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++)
                f->f[i * n + j] += scale * vector[i * n + k] * vector[j * n + k];
    }
    f->inverted = true;
    return status;
}

void imki_freedoms(imki_estimator *e, const imki_fit *fit, double *variance, double *freedom)
{
    information f = {.f = e->information};
    memset(e->information, 0, INFORMATION * sizeof *e->information);
    f.vector = f.f + IMKI_PARTS * IMKI_PARTS;
    f.share = (double(*)[IMK_CORRELATED_MAX])(f.vector + IMKI_PARTS * IMKI_PARTS);
    for (int part = 0; part < IMKI_PARTS; part++)
        f.index[part] = fit->estimated[part] ? f.parts++ : -1;
    if (f.parts > 0) {
        add_up(e, &f);
        add_globals(e, &f);
        add_pairs(e, &f);
        if (invert(&f) != IMK_OK)
            f.parts = 0;
        else
            add_pairs(e, &f);
    }
    for (int part = 0; part < IMKI_PARTS; part++)
        for (size_t p = 0; f.index[part] >= 0 && p < e->parameters; p++)
            f.share[f.index[part]][p] *= widened(fit, part);
    for (size_t p = 0; p < e->parameters; p++) {
        const double v = e->normal.covariance[p * e->globals + p];
        double sum = 0.0;
        for (int x = 0; x < f.parts; x++)
            for (int y = 0; y < f.parts; y++)
                sum += f.f[x * f.parts + y] * f.share[x][p] * f.share[y][p];
        freedom[p] = sum > 1e-12 * v * v ? v * v / sum : (double)INFINITY;
        const double more = f.parts > 0 ? 4.0 * (f.more[p] - through_globals(e, &f, p)) : 0.0;
        variance[p] = v + fmax(0.0, fmin(more, largest_correction * v));
    }
}
