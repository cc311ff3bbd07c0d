/* SPDX-License-Identifier: Apache-2.0 */
/* Correlated noise of the means over blocks: white, flicker and random walk,
 *
 *     V = s^2 (D + lambda F + mu R)
 *
 * D from the number of samples. F and R are double integrals of the generalised covariances
 * -ln|t| (spectrum 1/f) and min(t, t') (1/f^2), t in units of the log's length, over two blocks:
 *
 *     F_ij = -[G(e_i - b_j) - G(e_i - e_j) - G(b_i - b_j) + G(b_i - e_j)]/(h_i h_j),
 *     G(x) = x^2/2 ln|x| - 3 x^2/4,       G'' = ln|x|
 *
 * Flicker has no covariance of its own, but one of all differences; the fit always contains a
 * constant, so only these matter [MATHERON1973]. On an interval shorter than 4 -ln|t| is positive
 * definite (the logarithmic capacity of a unit interval is 1/4). A flicker of instability B, two-
 * sided density B^2/(2 pi f), has the covariance -B^2/pi ln|t|.
 *
 * lambda and mu run over a grid; each point gets the restricted likelihood [PATTERSON1971]
 *
 *     ln L = -1/2 [ln|V| + ln|X^T V^-1 X| + (n - q) ln RSS]
 *
 * of the fullest fit, s integrated out. The variances of the three kinds are averages over the
 * points, each with its likelihood as weight. A log has few periods of its own length, so how
 * strong its slow noise is can not be known well; the best point alone is without any in many a log
 * that has it. */
#include "base/algebra/vector_internal.h"
#include "imukit/distributions.h"
#include "imukit/elementary.h"
#include "imukit/linear_algebra.h"
#include "thermal_internal.h"

#include <math.h>
#include <string.h>

#define PI 3.14159265358979323846

/* From nothing to so much that the white noise no longer matters: a block against its neighbour
 * differs by 2 + 2.8 lambda + mu/72 (96 blocks), the first half of the log against the second by
 * 0.04 + 2.8 lambda + 0.7 mu. */
static const double flickers[IMKI_THERMAL_FLICKERS] = {0.0, 0.03, 0.1,  0.3,   1.0,
                                                       3.0, 10.0, 30.0, 100.0, 300.0};
static const double walks[IMKI_THERMAL_WALKS] = {0.0, 0.01, 0.1, 1.0, 10.0, 100.0, 1000.0};

static double flicker_of(int point)
{
    return flickers[point / IMKI_THERMAL_WALKS];
}

static double walk_of(int point)
{
    return walks[point % IMKI_THERMAL_WALKS];
}

static double g(double x)
{
    return x == 0.0 ? 0.0 : x * x * (0.5 * imk_ln(fabs(x)) - 0.75);
}

/* Means of min(t, t') over two blocks that do not overlap, and over one with itself. */
static double walk_mean(double begin_i, double end_i, double begin_j, double end_j)
{
    if (begin_i == begin_j)
        return begin_i + (end_i - begin_i) / 3.0;
    return begin_i < begin_j ? 0.5 * (begin_i + end_i) : 0.5 * (begin_j + end_j);
}

static void fill_kernels(imki_thermal_work *work)
{
    const imki_thermal_blocks *blocks = &work->blocks;
    const size_t n = blocks->count;
    const double start = blocks->begin[0], length = blocks->end[n - 1] - start;
    double begin[IMKI_THERMAL_BLOCKS], end[IMKI_THERMAL_BLOCKS];
    for (size_t i = 0; i < n; i++) {
        begin[i] = (blocks->begin[i] - start) / length;
        end[i] = (blocks->end[i] - start) / length;
        /* A block does not reach back into the one before it, whatever the time stamps say. */
        if (i > 0 && begin[i] < end[i - 1])
            begin[i] = end[i - 1];
    }
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j <= i; j++) {
            const double area = (end[i] - begin[i]) * (end[j] - begin[j]);
            const double f = -(g(end[i] - begin[j]) - g(end[i] - end[j]) - g(begin[i] - begin[j]) +
                               g(begin[i] - end[j])) /
                             area;
            const double r = walk_mean(begin[i], end[i], begin[j], end[j]);
            work->flicker[i * n + j] = work->flicker[j * n + i] = f;
            work->walk[i * n + j] = work->walk[j * n + i] = r;
        }
}

static void covariance(const imki_thermal_work *work, int point, double *v)
{
    const size_t n = work->blocks.count;
    const double lambda = flicker_of(point), mu = walk_of(point);
    for (size_t k = 0; k < n * n; k++)
        v[k] = lambda * work->flicker[k] + mu * work->walk[k];
    for (size_t i = 0; i < n; i++)
        v[i * n + i] += work->blocks.per_block / work->blocks.size[i];
}

/* Lower factor, column by column so that the compiler can vectorise: the inner loop runs along a
 * row of the transposed factor, which is what is stored: factor[k n + i] = L_ik, i >= k. V is
 * positive definite by construction: D alone has elements about 1. */
void imki_thermal_factor(imki_thermal_work *work, int point)
{
    const size_t n = work->blocks.count;
    double *u = work->factor;
    if (work->factor_of == point)
        return;
    covariance(work, point, u);
    for (size_t k = 0; k < n; k++) {
        double *row = u + k * n;
        const double pivot = 1.0 / sqrt(row[k]);
        for (size_t i = k; i < n; i++)
            row[i] *= pivot;
        for (size_t j = k + 1; j < n; j++) {
            const double l = row[j];
            double *below = u + j * n;
            for (size_t i = j; i < n; i++)
                below[i] -= l * row[i];
        }
    }
    work->factor_of = point;
}

void imki_thermal_whiten(const imki_thermal_work *work, double *x)
{
    const size_t n = work->blocks.count;
    for (size_t k = 0; k < n; k++) {
        const double *row = work->factor + k * n;
        x[k] /= row[k];
        for (size_t i = k + 1; i < n; i++)
            x[i] -= row[i] * x[k];
    }
}

static void fill_moments(imki_thermal_work *work, int point)
{
    const imki_thermal_blocks *blocks = &work->blocks;
    const size_t n = blocks->count;
    imki_thermal_moments *m = &work->moments[point];
    double x[IMKI_THERMAL_COLUMNS][IMKI_THERMAL_BLOCKS], y[IMKI_THERMAL_BLOCKS];
    imki_thermal_factor(work, point);
    m->log_determinant = 0.0;
    for (size_t i = 0; i < n; i++)
        m->log_determinant += 2.0 * imk_ln(work->factor[i * n + i]);
    for (int c = 0; c < IMKI_THERMAL_COLUMNS; c++) {
        memcpy(x[c], blocks->column[c], n * sizeof **x);
        imki_thermal_whiten(work, x[c]);
        for (int d = 0; d <= c; d++)
            m->xx[c * IMKI_THERMAL_COLUMNS + d] = m->xx[d * IMKI_THERMAL_COLUMNS + c] =
                imki_dot(n, x[c], x[d]);
    }
    for (int a = 0; a < IMKI_THERMAL_AXES; a++) {
        if (!blocks->used[a])
            continue;
        memcpy(y, blocks->reading[a], n * sizeof *y);
        imki_thermal_whiten(work, y);
        m->yy[a] = imki_dot(n, y, y);
        for (int c = 0; c < IMKI_THERMAL_COLUMNS; c++)
            m->xy[a][c] = imki_dot(n, x[c], y);
    }
}

/* Columns the log tells apart: what is left of each, the ones before it taken out, against what it
 * was. Order 5 over an even sweep leaves 1e-4. */
static unsigned independent(const imki_thermal_work *work, unsigned wanted)
{
    enum { N = IMKI_THERMAL_COLUMNS };
    const double least = 1e-7;
    double a[N * N];
    unsigned mask = 0;
    memcpy(a, work->square_moment, sizeof a);
    for (int c = 0; c < N; c++) {
        const double left = a[c * N + c];
        if (!(wanted >> c & 1u) || !(left > least * work->square_moment[c * N + c]))
            continue;
        mask |= 1u << c;
        for (int i = c + 1; i < N; i++)
            for (int j = c + 1; j < N; j++)
                a[i * N + j] -= a[i * N + c] * a[c * N + j] / left;
    }
    return mask;
}

double imki_thermal_weighted_rss(const imki_thermal_work *work, int axis, unsigned mask, int point,
                                 double *information)
{
    enum { N = IMKI_THERMAL_COLUMNS };
    const imki_thermal_moments *m = &work->moments[point];
    int index[N];
    double a[N * N], b[N], c[N];
    const size_t q = imki_thermal_list(mask & work->available, index);
    for (size_t i = 0; i < q; i++) {
        for (size_t j = 0; j < q; j++)
            a[i * q + j] = m->xx[index[i] * N + index[j]];
        c[i] = b[i] = m->xy[axis][index[i]];
    }
    if (imk_cholesky_factor(q, a) != IMK_OK)
        return (double)INFINITY;
    imk_cholesky_solve(q, a, b);
    if (information)
        *information = imk_cholesky_log_determinant(q, a);
    /* Of readings without noise rounding is left. */
    return fmax(m->yy[axis] - imki_dot(q, b, c), 1e-15 * m->yy[axis]);
}

/* Flicker every sensor has; a random walk besides is the exception over hours: three quarters of
 * the weight beforehand are with none. */
static const double walk_share = 1.0 / (3.0 * (IMKI_THERMAL_WALKS - 1));

/* Weights of the points, and from them the variances. */
static void weigh_axis(imki_thermal_work *work, int axis)
{
    double weight[IMKI_THERMAL_GRID], rss[IMKI_THERMAL_GRID], best = -(double)INFINITY, sum = 0.0;
    const size_t n = work->blocks.count;
    int unused[IMKI_THERMAL_COLUMNS];
    const double freedom = (double)n * (1.0 - work->blocks.refused[axis]) -
                           (double)imki_thermal_list(work->available, unused);
    imki_thermal_variance *v = &work->variance[axis];
    work->best[axis] = 0;
    for (int p = 0; p < IMKI_THERMAL_GRID; p++) {
        double information = 0.0;
        rss[p] = imki_thermal_weighted_rss(work, axis, work->available, p, &information);
        /* A constant reading has no noise to weigh. */
        weight[p] =
            rss[p] > 0.0 && isfinite(rss[p])
                ? -0.5 * (work->moments[p].log_determinant + information + freedom * imk_ln(rss[p]))
                : -(double)INFINITY;
        if (weight[p] > best) {
            best = weight[p];
            work->best[axis] = p;
        }
    }
    *v = (imki_thermal_variance){.freedom = freedom};
    if (!isfinite(best))
        return;
    for (int p = 0; p < IMKI_THERMAL_GRID; p++) {
        weight[p] = imk_exp(weight[p] - best) * (walk_of(p) > 0.0 ? walk_share : 1.0);
        sum += weight[p];
    }
    /* What was replaced tells nothing, and what stands for it has the error of its neighbours,
     * which thereby count for more. */
    const double kept = 1.0 - work->blocks.refused[axis];
    for (int p = 0; p < IMKI_THERMAL_GRID; p++) {
        work->weight[axis][p] = weight[p] / sum;
        work->level[axis][p] = weight[p] > 0.0 ? rss[p] / (freedom * kept * kept) : 0.0;
        const double variance = work->weight[axis][p] * work->level[axis][p];
        v->white += variance;
        v->flicker += variance * flicker_of(p);
        v->walk += variance * walk_of(p);
    }
}

/* How strong the slow noise is, is not known well, so a value is not normal about 0: its tails are
 * those of the mixture over the points. */
double imki_thermal_chance(const imki_thermal_work *work, int axis, double square, double white,
                           double flicker, double walk)
{
    double chance = 0.0;
    for (int p = 0; p < IMKI_THERMAL_GRID; p++) {
        const double variance =
            work->level[axis][p] * (white + flicker_of(p) * flicker + walk_of(p) * walk);
        if (variance > 0.0)
            chance += work->weight[axis][p] * imk_gamma_upper(0.5, 0.5 * square / variance);
    }
    return chance;
}

/* Moments for fits with equal weights. */
static void fill_equal(imki_thermal_work *work)
{
    enum { N = IMKI_THERMAL_COLUMNS };
    const imki_thermal_blocks *blocks = &work->blocks;
    const size_t n = blocks->count;
    double fx[IMKI_THERMAL_BLOCKS], rx[IMKI_THERMAL_BLOCKS], dx[IMKI_THERMAL_BLOCKS];
    for (int c = 0; c < N; c++) {
        const double *x = blocks->column[c];
        for (size_t i = 0; i < n; i++) {
            fx[i] = imki_dot(n, work->flicker + i * n, x);
            rx[i] = imki_dot(n, work->walk + i * n, x);
            dx[i] = blocks->per_block / blocks->size[i] * x[i];
        }
        for (int d = 0; d < N; d++) {
            work->square_moment[d * N + c] = imki_dot(n, blocks->column[d], x);
            work->white_moment[d * N + c] = imki_dot(n, blocks->column[d], dx);
            work->flicker_moment[d * N + c] = imki_dot(n, blocks->column[d], fx);
            work->walk_moment[d * N + c] = imki_dot(n, blocks->column[d], rx);
        }
        for (int a = 0; a < IMKI_THERMAL_AXES; a++)
            work->reading_moment[a][c] = imki_dot(n, x, blocks->reading[a]);
    }
}

void imki_thermal_weigh(imki_thermal_work *work, int order_max, bool both_directions)
{
    const unsigned causes = 1u << IMKI_THERMAL_RATE | 1u << IMKI_THERMAL_STATE;
    work->factor_of = -1;
    fill_kernels(work);
    fill_equal(work);
    work->available =
        independent(work, imki_thermal_powers(order_max) | (both_directions ? causes : 0u));
    for (int p = 0; p < IMKI_THERMAL_GRID; p++)
        fill_moments(work, p);
    for (int a = 0; a < IMKI_THERMAL_AXES; a++)
        if (work->blocks.used[a])
            weigh_axis(work, a);
}
