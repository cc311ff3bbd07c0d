/* SPDX-License-Identifier: Apache-2.0 */
/* The evaluation of a table from end to end: what is asked for is checked, the workspace is
 * divided, and the figures are made one after the other. */
#include "evaluate_internal.h"

#include "base/refuse_internal.h"
#include "base/workspace_internal.h"
#include "imukit/distributions.h"
#include "imukit/random.h"
#include "imukit/samples.h"

#include <string.h>

static const uint32_t cookie = 0x4556414c; /* "EVAL" */
/* Numbers of the simulation behind the intervals: always the same. */
static const uint64_t seed = 0x696d756b6974;

imk_evaluation_settings imk_evaluation_default(void)
{
    return (imk_evaluation_settings){.cookie = cookie, .confidence = 0.95, .same_unit = true};
}

/* ---- checks ---------------------------------------------------------------------------------- */

static imk_status check_rows(const imk_evaluation_table *table, imk_error *error)
{
    for (size_t row = 0; row < table->count; row++) {
        if (!(fabs(table->reference[row]) <= IMK_READING_MAX))
            return imki_refuse_at(error, IMK_ERROR_NOT_FINITE, "reference", row, 0.0, 0.0,
                                  "a number up to 1e60");
        if (!(fabs(table->reading[row]) <= IMK_READING_MAX))
            return imki_refuse_at(error, IMK_ERROR_NOT_FINITE, "reading", row, 0.0, 0.0,
                                  "a number up to 1e60");
        if (table->sigma && !(table->sigma[row] > 0.0 && table->sigma[row] < HUGE_VAL))
            return imki_refuse_at(error, IMK_ERROR_RANGE, "sigma", row, 0.0, 0.0, "above 0");
        if (table->direction && (table->direction[row] < -1 || table->direction[row] > 1))
            return imki_refuse_at(error, IMK_ERROR_RANGE, "direction", row, 0.0, 0.0, "-1, 0 or 1");
        if (table->run && (table->run[row] < 0 || table->run[row] >= IMK_EVALUATION_RUNS_MAX))
            return imki_refuse_at(error, IMK_ERROR_RANGE, "run", row, 0.0, 0.0,
                                  "a number from 0 to 63");
    }
    return IMK_OK;
}

static imk_status check(const imk_evaluation_table *table, const imk_evaluation_settings *settings,
                        imk_error *error)
{
    if (settings->cookie != cookie)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, "settings", NULL, NULL);
    if (!(settings->confidence > 0.0 && settings->confidence < 1.0))
        return imk_error_set(error, IMK_ERROR_RANGE, "confidence", NULL, "between 0 and 1");
    if (!(settings->full_scale >= 0.0 && settings->full_scale < HUGE_VAL))
        return imk_error_set(error, IMK_ERROR_RANGE, "full_scale", NULL, "0 or more");
    if (!(settings->level_width >= 0.0 && settings->level_width < HUGE_VAL))
        return imk_error_set(error, IMK_ERROR_RANGE, "level_width", NULL, "0 or more");
    if (table->count < 2) {
        return imki_refuse(error, IMK_ERROR_TOO_SHORT, "readings", (double)table->count, 2,
                           "at least two readings");
    }
    return check_rows(table, error);
}

/* ---- workspace ------------------------------------------------------------------------------- */

static size_t draws_for(size_t rows)
{
    const size_t draws = IMKI_DRAWS_ALL / (rows > 0 ? rows : 1);
    return draws > IMKI_DRAWS_MAX   ? IMKI_DRAWS_MAX
           : draws < IMKI_DRAWS_MIN ? IMKI_DRAWS_MIN
                                    : draws;
}

static void lay_out(imki_evaluation *e, imki_parts *a)
{
    const size_t n = e->rows, runs = e->table->run ? 2 * (size_t)IMK_EVALUATION_RUNS_MAX : 0;
    e->level_of = imki_take(a, n * sizeof *e->level_of);
    e->side = imki_take(a, n * sizeof *e->side);
    e->reading = imki_take(a, n * sizeof *e->reading);
    e->order = imki_take(a, n * sizeof *e->order);
    e->reference = imki_take(a, n * sizeof *e->reference);
    e->cell = imki_take(a, n * IMKI_CELLS * sizeof *e->cell);
    e->level_sigma = imki_take(a, n * sizeof *e->level_sigma);
    e->pattern = imki_take(a, n * sizeof *e->pattern);
    e->noise = imki_take(a, n * sizeof *e->noise);
    e->shifted = imki_take(a, n * sizeof *e->shifted);
    e->trial = imki_take(a, n * sizeof *e->trial);
    e->weight = imki_take(a, n * sizeof *e->weight);
    e->moment = imki_take(a, n * sizeof *e->moment);
    e->centred = imki_take(a, n * sizeof *e->centred);
    e->factor = imki_take(a, e->draws * sizeof *e->factor);
    e->sorted = imki_take(a, e->draws * sizeof *e->sorted);
    e->none = imki_take(a, e->draws * sizeof *e->none);
    e->near = imki_take(a, e->draws * sizeof *e->near);
    e->draw = imki_take(a, e->draws * n * sizeof *e->draw);
    e->hull = imki_take(a, 2 * n * sizeof *e->hull);
    e->matrix = runs > 0 ? imki_take(a, runs * (runs + 1) * sizeof *e->matrix) : NULL;
}

size_t imk_evaluation_workspace_size(const imk_evaluation_table *table)
{
    imki_evaluation e = {.table = table, .rows = table->count, .draws = draws_for(table->count)};
    imki_parts a = imki_parts_of(NULL);
    lay_out(&e, &a);
    return imki_parts_size(&a);
}

/* ---- the whole ------------------------------------------------------------------------------- */

static void clear(imki_evaluation *e)
{
    const double none = (double)NAN;
    imk_evaluation *r = e->result;
    memset(r, 0, sizeof *r);
    r->precision = r->sensitivity = r->zero = r->accuracy = r->coverage = imki_unknown();
    r->linearity = r->linearity_best = r->hysteresis = r->asymmetry = imki_unknown();
    r->resolution = r->threshold = imki_unknown();
    r->smallest_step = r->smallest_input = none;
    r->line = r->best = (imk_evaluation_line){none, none, none};
    r->accuracy_level = r->linearity_level = r->hysteresis_level = -1;
    for (int k = 0; k < 3; k++)
        r->alternation[k] = -1;
    for (int run = 0; run < IMK_EVALUATION_RUNS_MAX; run++)
        r->run_line[run][0] = r->run_line[run][1] = none;
}

static void measure(imki_evaluation *e)
{
    double largest = 0.0;
    e->runs = 1;
    for (size_t row = 0; row < e->rows; row++) {
        largest = fmax(largest, fabs(e->table->reference[row]));
        const int run = imki_run_of(e, row);
        e->runs = run + 1 > e->runs ? run + 1 : e->runs;
    }
    const double given = e->settings->full_scale, width = e->settings->level_width;
    e->scale = given > 0.0 ? given : largest;
    e->width = width > 0.0 ? width : 1e-9 * e->scale;
    e->result->full_scale = e->scale;
}

/* Student's quantile of the intervals, and the draws that stand for noise: normals, and by how much
 * the true sigma may differ from the estimated one. */
static void prepare_intervals(imki_evaluation *e)
{
    const imk_random source = imk_random_seeded(seed);
    const double freedom = e->result->freedom;
    e->student = (double)NAN;
    if (e->result->source == IMK_SCATTER_NONE)
        return;
    e->student = imk_student_quantile(0.5 + 0.5 * e->settings->confidence, freedom);
    if (e->result->source == IMK_SCATTER_RESIDUALS)
        return;
    imk_random_normals(source, 0, 0, e->draws, e->factor);
    for (size_t b = 0; b < e->draws; b++) {
        const double p = imk_normal_probability(e->factor[b]);
        e->factor[b] =
            freedom < HUGE_VAL ? sqrt(freedom / imk_chi_square_quantile(p, freedom)) : 1.0;
    }
    imk_random_normals(source, 1, 0, e->draws * e->levels, e->draw);
}

static void put_levels(const imki_evaluation *e, imk_evaluation_level *level, size_t capacity)
{
    const imk_evaluation_line *line = &e->result->line, *best = &e->result->best;
    for (size_t k = 0; k < e->levels && k < capacity; k++) {
        const imki_cell *cell = &e->cell[k * IMKI_CELLS];
        double variance;
        const double mean = imki_level_mean(e, k, &variance), x = e->reference[k];
        level[k] =
            (imk_evaluation_level){.reference = x,
                                   .reading = mean,
                                   .sigma = sqrt(variance),
                                   .up = cell[2].count > 0 ? cell[2].mean : (double)NAN,
                                   .down = cell[0].count > 0 ? cell[0].mean : (double)NAN,
                                   .deviation = mean - line->zero - line->sensitivity * x,
                                   .deviation_best = mean - best->zero - best->sensitivity * x,
                                   .count = cell[0].count + cell[1].count + cell[2].count};
    }
}

static void evaluate(imki_evaluation *e)
{
    measure(e);
    imki_divide(e);
    imki_cell_means(e);
    imki_least_squares_line(e);
    imki_to_level_references(e);
    imki_cell_means(e);
    imki_least_squares_line(e);
    imki_scatter(e);
    imki_least_squares_line(e);
    prepare_intervals(e);
    imki_line_intervals(e);
    imki_asymmetry(e);
    imki_run_lines(e);
    imki_extremes(e);
    imki_steps(e);
}

imk_status imk_evaluate(const imk_evaluation_table *table, const imk_evaluation_settings *settings,
                        imk_evaluation_level *level, size_t capacity, imk_evaluation *result,
                        void *workspace, size_t workspace_size, imk_error *error)
{
    const imk_status status = check(table, settings, error);
    if (status != IMK_OK)
        return status;
    if (workspace_size < imk_evaluation_workspace_size(table))
        return imk_error_set(error, IMK_ERROR_WORKSPACE, "workspace", NULL, NULL);
    imki_parts a = imki_parts_of(workspace);
    imki_evaluation e = {.table = table,
                         .settings = settings,
                         .result = result,
                         .rows = table->count,
                         .draws = draws_for(table->count)};
    lay_out(&e, &a);
    clear(&e);
    evaluate(&e);
    put_levels(&e, level, capacity);
    return IMK_OK;
}
