/* SPDX-License-Identifier: Apache-2.0 */
/* Levels, sides and cells of a table, and their means. */
#include "evaluate_internal.h"

/* ---- order ----------------------------------------------------------------------------------- */

/* By reference; rows of equal reference in their own order, so that nothing depends on the sort. */
static bool before(const double *reference, size_t a, size_t b)
{
    return reference[a] < reference[b] || (reference[a] == reference[b] && a < b);
}

static void sift(const double *reference, size_t *order, size_t root, size_t count)
{
    for (;;) {
        size_t child = 2 * root + 1;
        if (child >= count)
            return;
        if (child + 1 < count && before(reference, order[child], order[child + 1]))
            child++;
        if (!before(reference, order[root], order[child]))
            return;
        const size_t swap = order[root];
        order[root] = order[child];
        order[child] = swap;
        root = child;
    }
}

static void sort_rows(const double *reference, size_t count, size_t *order)
{
    for (size_t k = 0; k < count; k++)
        order[k] = k;
    for (size_t root = count / 2; root-- > 0;)
        sift(reference, order, root, count);
    for (size_t last = count; last-- > 1;) {
        const size_t swap = order[0];
        order[0] = order[last];
        order[last] = swap;
        sift(reference, order, 0, last);
    }
}

/* ---- levels and sides ------------------------------------------------------------------------ */

/* The side from which each level was reached: the last change of level within the run tells it. */
static void infer_sides(imki_evaluation *e)
{
    int level[IMK_EVALUATION_RUNS_MAX];
    signed char side[IMK_EVALUATION_RUNS_MAX];
    for (int run = 0; run < IMK_EVALUATION_RUNS_MAX; run++)
        level[run] = -1, side[run] = 1;
    for (size_t row = 0; row < e->rows; row++) {
        const int run = imki_run_of(e, row), here = e->level_of[row];
        if (level[run] >= 0 && here != level[run])
            side[run] = here > level[run] ? 2 : 0;
        level[run] = here;
        e->side[row] = side[run];
    }
}

void imki_divide(imki_evaluation *e)
{
    const double *reference = e->table->reference;
    sort_rows(reference, e->rows, e->order);
    size_t first = 0;
    for (size_t k = 0; k < e->rows; k++) {
        const size_t row = e->order[k];
        if (k == 0 || reference[row] - reference[e->order[first]] > e->width) {
            first = k;
            e->reference[e->levels++] = 0.0;
        }
        e->level_of[row] = (int)e->levels - 1;
        /* Running mean: equal references stay what they are. */
        e->reference[e->levels - 1] +=
            (reference[row] - e->reference[e->levels - 1]) / (double)(k - first + 1);
    }
    e->result->levels = e->levels;
    infer_sides(e);
    bool seen[IMK_EVALUATION_RUNS_MAX] = {false};
    for (size_t row = 0; row < e->rows; row++) {
        if (e->table->direction)
            e->side[row] = (signed char)(e->table->direction[row] + 1);
        e->reading[row] = e->table->reading[row];
        e->result->runs += !seen[imki_run_of(e, row)];
        seen[imki_run_of(e, row)] = true;
    }
}

void imki_cell_means(imki_evaluation *e)
{
    for (size_t c = 0; c < e->levels * IMKI_CELLS; c++)
        e->cell[c] = (imki_cell){0, 0.0, 0.0};
    e->result->cells = 0;
    for (size_t row = 0; row < e->rows; row++) {
        imki_cell *cell = imki_cell_of(e, row);
        e->result->cells += cell->count == 0;
        cell->count++;
        cell->mean += (e->reading[row] - cell->mean) / (double)cell->count;
    }
}

void imki_to_level_references(imki_evaluation *e)
{
    const double slope = e->result->line.sensitivity;
    for (size_t row = 0; row < e->rows; row++) {
        const double distance = e->table->reference[row] - e->reference[e->level_of[row]];
        if (distance != 0.0 && isfinite(slope))
            e->reading[row] -= slope * distance;
    }
}

double imki_level_mean(const imki_evaluation *e, size_t level, double *variance)
{
    const imki_cell *cell = &e->cell[level * IMKI_CELLS];
    if (cell[0].count > 0 && cell[2].count > 0) {
        *variance = 0.25 * (cell[0].variance + cell[2].variance);
        return 0.5 * (cell[0].mean + cell[2].mean);
    }
    double count = 0.0, mean = 0.0;
    *variance = 0.0;
    for (int s = 0; s < IMKI_CELLS; s++)
        count += (double)cell[s].count;
    for (int s = 0; s < IMKI_CELLS; s++) {
        const double weight = (double)cell[s].count / count;
        mean += weight * cell[s].mean;
        *variance += weight * weight * cell[s].variance;
    }
    return mean;
}
