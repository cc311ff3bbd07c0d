/* SPDX-License-Identifier: Apache-2.0 */
/* How large the noise of a reading is, from readings of one cell. In several runs a reading is
 *
 *     y = mean of the cell + u_run + k_run x + e :
 *
 * runs differ by bias and scale factor, which is repeatability, not precision. Cells are eliminated
 * first: with n_cr readings of run r in cell c, n_c in all,
 *
 *     M_c = diag(n_cr) - n_c. n_c.^T/n_c,   normal matrix = sum over c of [1 x; x x^2] M_c,
 *
 * whose rank (differences only are seen) is that of a Gauss-Jordan elimination. */
#include "evaluate_internal.h"

#include "imukit/distributions.h"

/* A pivot below this part of its column's own square is nothing but rounding. */
static const double dependent = 1e-10;

/* ---- runs ------------------------------------------------------------------------------------ */

/* Add a cell to the normal equations: rows order[begin …) of this side. */
static void add_cell(imki_evaluation *e, size_t begin, size_t end, int side)
{
    const int runs = e->runs, stride = 2 * runs + 1;
    double count[IMK_EVALUATION_RUNS_MAX] = {0.0}, sum[IMK_EVALUATION_RUNS_MAX] = {0.0}, all = 0.0;
    for (size_t k = begin; k < end; k++) {
        const size_t row = e->order[k];
        if (e->side[row] != side)
            continue;
        const int run = imki_run_of(e, row);
        count[run] += 1.0;
        all += 1.0;
        sum[run] += e->reading[row] - imki_cell_of(e, row)->mean;
    }
    if (all == 0.0)
        return;
    const double x = e->reference[e->level_of[e->order[begin]]] / e->scale;
    for (int r = 0; r < runs; r++) {
        double *zero = &e->matrix[r * stride], *slope = &e->matrix[(runs + r) * stride];
        for (int q = 0; q < runs; q++) {
            const double m = (r == q ? count[r] : 0.0) - count[r] * count[q] / all;
            zero[q] += m;
            zero[runs + q] += x * m;
            slope[q] += x * m;
            slope[runs + q] += x * x * m;
        }
        zero[2 * runs] += sum[r];
        slope[2 * runs] += x * sum[r];
    }
}

/* Solve in place; effects that are not determined stay 0. @return the rank */
static int eliminate(double *matrix, int size, double *effect)
{
    const int stride = size + 1;
    double own[2 * IMK_EVALUATION_RUNS_MAX];
    bool used[2 * IMK_EVALUATION_RUNS_MAX];
    int rank = 0;
    for (int k = 0; k < size; k++)
        own[k] = matrix[k * stride + k];
    for (int k = 0; k < size; k++) {
        const double pivot = matrix[k * stride + k];
        used[k] = pivot > dependent * own[k];
        if (!used[k])
            continue;
        rank++;
        for (int i = 0; i < size; i++) {
            const double ratio = matrix[i * stride + k] / pivot;
            for (int j = 0; i != k && j <= size; j++)
                matrix[i * stride + j] -= ratio * matrix[k * stride + j];
        }
    }
    for (int k = 0; k < size; k++)
        effect[k] = used[k] ? matrix[k * stride + size] / matrix[k * stride + k] : 0.0;
    return rank;
}

/* Bring the readings of all runs to what their mean would have read. @return the rank */
static int level_runs(imki_evaluation *e)
{
    double effect[2 * IMK_EVALUATION_RUNS_MAX] = {0.0}, share[IMK_EVALUATION_RUNS_MAX] = {0.0};
    const int runs = e->runs, size = 2 * runs;
    double zero = 0.0, slope = 0.0;
    for (int k = 0; k < size * (size + 1); k++)
        e->matrix[k] = 0.0;
    for (size_t begin = 0, end; begin < e->rows; begin = end) {
        const int level = e->level_of[e->order[begin]];
        for (end = begin; end < e->rows && e->level_of[e->order[end]] == level; end++) {
        }
        for (int side = 0; side < IMKI_CELLS; side++)
            add_cell(e, begin, end, side);
    }
    const int rank = eliminate(e->matrix, size, effect);
    for (size_t row = 0; row < e->rows; row++)
        share[imki_run_of(e, row)] += 1.0 / (double)e->rows;
    for (int r = 0; r < runs; r++) {
        zero += share[r] * effect[r];
        slope += share[r] * effect[runs + r];
    }
    for (size_t row = 0; row < e->rows; row++) {
        const int run = imki_run_of(e, row);
        const double x = e->reference[e->level_of[row]] / e->scale;
        e->reading[row] -= effect[run] - zero + (effect[runs + run] - slope) * x;
    }
    imki_cell_means(e);
    return rank;
}

/* ---- noise ----------------------------------------------------------------------------------- */

static double replicate_squares(const imki_evaluation *e)
{
    double squares = 0.0;
    for (size_t row = 0; row < e->rows; row++) {
        const double d = e->reading[row] - imki_cell_of(e, row)->mean;
        squares += d * d;
    }
    return squares;
}

static double residual_squares(const imki_evaluation *e)
{
    const imk_evaluation_line *line = &e->result->line;
    double squares = 0.0;
    for (size_t row = 0; row < e->rows; row++) {
        const double d =
            e->reading[row] - line->zero - line->sensitivity * e->reference[e->level_of[row]];
        squares += d * d;
    }
    return squares;
}

/* s sqrt(v/chi-square quantile): exact for normal noise. */
static void put_precision(imki_evaluation *e, double sigma, double freedom)
{
    const double tail = 0.5 - 0.5 * e->settings->confidence;
    e->result->precision = (imk_evaluation_figure){
        sigma, sigma * sqrt(freedom / imk_chi_square_quantile(1.0 - tail, freedom)),
        sigma * sqrt(freedom / imk_chi_square_quantile(tail, freedom))};
}

/* Variances of the means of cells and levels. */
static void spread_variance(imki_evaluation *e)
{
    for (size_t row = 0; row < e->rows; row++) {
        imki_cell *cell = imki_cell_of(e, row);
        cell->variance +=
            imki_reading_variance(e, row) / ((double)cell->count * (double)cell->count);
    }
    for (size_t k = 0; k < e->levels; k++) {
        double variance;
        imki_level_mean(e, k, &variance);
        e->level_sigma[k] = sqrt(variance);
    }
}

void imki_scatter(imki_evaluation *e)
{
    imk_evaluation *r = e->result;
    const int rank = e->matrix && r->runs > 1 && e->scale > 0.0 ? level_runs(e) : 0;
    const double replicates = (double)e->rows - (double)r->cells - (double)rank;
    const double residuals = e->levels > 1 ? (double)e->rows - 2.0 : 0.0;
    if (replicates >= 1.0)
        put_precision(e, sqrt(replicate_squares(e) / replicates), replicates);
    r->freedom = HUGE_VAL;
    if (replicates >= 3.0 || (replicates >= 1.0 && !e->table->sigma)) {
        r->source = IMK_SCATTER_REPLICATES;
        r->freedom = replicates;
        e->sigma = r->precision.value;
    } else if (e->table->sigma) {
        r->source = IMK_SCATTER_STATED;
    } else if (residuals >= 1.0) {
        r->source = IMK_SCATTER_RESIDUALS;
        r->freedom = residuals;
        e->sigma = sqrt(residual_squares(e) / residuals);
    } else {
        r->source = IMK_SCATTER_NONE;
    }
    spread_variance(e);
}
