/* SPDX-License-Identifier: Apache-2.0 */
/* The tuning of a filter as a whole: its memory, and the order of the work. Windows are computed a
 * few at a time, each alone in a lane, and added in their order: nothing depends on who does what
 * when. */
#include "tuning_internal.h"

#include "base/workspace_internal.h"

#include <math.h>
#include <string.h>

typedef struct layout {
    imk_filter_tuning *tuning;
    double *time;
    imk_drift_source *source;
    imki_tuning_totals totals;
    imki_tuning_arrays arrays;
    imki_tuning_plan *plan;
    imki_tuning_grid *grid;
    imk_filter_tuning_settings *settings;
    imki_tuning_lane *lane; /* [IMKI_TUNING_LANES] */
    imki_parts memory;
} layout;

static void take_lane(imki_parts *memory, imki_tuning_lane *lane, size_t elements, size_t sources,
                      size_t times)
{
    imki_tuning_lane made = {.motion = 0};
    made.perfect = imki_take(memory, sizeof *made.perfect);
    made.scene_memory = imki_take(memory, IMKI_SCENE_SIZE + 2 * IMKI_ALIGNMENT_SLACK);
    made.part_state = imki_take(memory, IMK_SUBSTEPS_MAX * sizeof *made.part_state);
    made.value = imki_take(memory, elements * sizeof *made.value);
    made.driver = imki_take(memory, elements * sizeof *made.driver);
    made.offset = imki_take(memory, elements * sizeof *made.offset);
    made.learned = imki_take(memory, elements * sizeof *made.learned);
    made.sum = imki_take(memory, elements * sizeof *made.sum);
    made.limit = imki_take(memory, elements * sizeof *made.limit);
    made.size = imki_take(memory, elements * sizeof *made.size);
    made.cross = imki_take(memory, elements * sizeof *made.cross);
    made.states = imki_take(memory, elements * sizeof *made.states);
    made.mean = imki_take(memory, sources * sizeof *made.mean);
    made.covariance = imki_take(memory, sources * sizeof *made.covariance);
    made.increments = imki_take(memory, times * sizeof *made.increments);
    made.total = imki_take(memory, times * sizeof *made.total);
    made.shift = imki_take(memory, times * sizeof *made.shift);
    made.part = imki_take(memory, sources * times * sizeof *made.part);
    made.basis = imki_take(memory, IMKI_BASES * times * sizeof *made.basis);
    if (lane)
        *lane = made;
}

static void take_totals(layout *l, const imk_filter_tuning_settings *s, size_t sources,
                        size_t times)
{
    imki_tuning_totals *t = &l->totals;
    imki_tuning_arrays *a = &l->arrays;
    imki_parts *memory = &l->memory;
    const size_t answers = IMK_FILTER_ANSWERS;
    t->times = times;
    t->sources = sources;
    t->windows = s->motion_count * s->window_count;
    t->per_axis = s->per_axis;
    t->bases = s->per_axis ? IMKI_BASES : 2 * IMKI_KINDS_OF_BASIS;
    t->truth = imki_take(memory, times * sizeof *t->truth);
    t->source = imki_take(memory, sources * times * sizeof *t->source);
    t->basis = imki_take(memory, IMKI_BASES * times * sizeof *t->basis);
    t->increments = imki_take(memory, t->windows * times * sizeof *t->increments);
    t->window_total = imki_take(memory, t->windows * times * sizeof *t->window_total);
    t->window_shift = imki_take(memory, t->windows * times * sizeof *t->window_shift);
    t->window_basis = imki_take(memory, t->windows * t->bases * times * sizeof *t->window_basis);
    a->consistency = imki_take(memory, answers * times * sizeof *a->consistency);
    a->covariance = imki_take(memory, answers * times * sizeof *a->covariance);
    a->share = imki_take(memory, answers * sources * times * sizeof *a->share);
    a->fixed = imki_take(memory, times * sizeof *a->fixed);
    a->basis = imki_take(memory, IMKI_PARAMETERS_MAX * times * sizeof *a->basis);
}

static layout lay_out(const imk_model *model, const imk_filter_tuning_settings *settings,
                      void *memory)
{
    layout l = {.memory = imki_parts_of(memory)};
    const imk_drift_settings drift = imk_drift_default();
    imki_tuning_grid grid;
    size_t sources, elements;
    imki_tuning_grid_of(model, settings, &grid);
    imki_tuning_plan_size(model, settings, &sources, &elements);
    elements++; /* so that the arrays are there also for a model without errors */
    l.tuning = imki_take(&l.memory, sizeof *l.tuning);
    l.grid = imki_take(&l.memory, sizeof *l.grid);
    l.settings = imki_take(&l.memory, sizeof *l.settings);
    l.time = imki_take(&l.memory, grid.time_count * sizeof *l.time);
    l.source = imki_take(&l.memory, sources * sizeof *l.source);
    take_totals(&l, settings, sources, grid.time_count);
    imki_tuning_plan plan = {.h = 0.0};
    l.plan = imki_take(&l.memory, sizeof *l.plan);
    plan.drift.source = l.source;
    plan.drift.part = imki_take(&l.memory, sources * sizeof *plan.drift.part);
    plan.drift.element = imki_take(&l.memory, elements * sizeof *plan.drift.element);
    plan.drift.states = IMK_DRIFT_STATES;
    plan.drift.covariance = imki_take(&l.memory, sources * sizeof(imki_matrix9));
    plan.drift.vector = imki_take(&l.memory, 3 * elements * IMK_DRIFT_STATES * sizeof(double));
    plan.drift.column = imki_take(&l.memory, IMKI_DRIFT_COLUMNS * sizeof *plan.drift.column);
    plan.drift.driver =
        imki_take(&l.memory, imki_drift_drivers_max(model, &drift) * sizeof *plan.drift.driver);
    plan.element = imki_take(&l.memory, elements * sizeof *plan.element);
    l.lane = imki_take(&l.memory, IMKI_TUNING_LANES * sizeof *l.lane);
    for (size_t i = 0; i < IMKI_TUNING_LANES; i++)
        take_lane(&l.memory, memory ? &l.lane[i] : NULL, elements, sources, grid.time_count);
    if (memory) {
        *l.plan = plan;
        *l.grid = grid;
        *l.settings = *settings;
    }
    return l;
}

size_t imk_filter_tuning_size(const imk_model *model, const imk_filter_tuning_settings *settings)
{
    const layout l = lay_out(model, settings, NULL);
    return imki_parts_size(&l.memory);
}

/* ---- windows ---- */

static void run_lane(void *context, size_t item)
{
    imki_tuning_lane *lane = context;
    imki_tuning_window_run(&lane[item]);
}

static void add_packed(double sum[9][9], const double *packed, double weight)
{
    double p[9][9];
    imki_unpack(packed, p);
    for (int i = 0; i < 9; i++)
        for (int j = 0; j < 9; j++)
            sum[i][j] += weight * p[i][j];
}

static void keep_window(layout *l, const imki_tuning_lane *lane, size_t window)
{
    imki_tuning_totals *t = &l->totals;
    const double weight = 1.0 / (double)t->windows;
    for (size_t time = 0; time < t->times; time++) {
        const size_t at = window * t->times + time;
        memcpy(t->increments[at], lane->increments[time], sizeof lane->increments[time]);
        memcpy(t->window_total[at], lane->total[time], sizeof lane->total[time]);
        memcpy(t->window_shift[at], lane->shift[time], sizeof lane->shift[time]);
        for (size_t s = 0; s < t->sources; s++)
            add_packed(t->source[s * t->times + time], lane->part[s * t->times + time], weight);
        for (int kind = 0; kind < IMKI_KINDS_OF_BASIS; kind++)
            for (int j = 0; j < 6; j++) {
                const size_t base = (size_t)imki_basis(kind, j / 3, j % 3) * t->times + time;
                const size_t kept = imki_kept_basis(t->per_axis, kind, j / 3, j % 3);
                double *own = t->window_basis[(window * t->bases + kept) * t->times + time];
                add_packed(t->basis[base], lane->basis[base], weight);
                for (int i = 0; i < IMKI_PACKED; i++)
                    own[i] += lane->basis[base][i];
            }
    }
}

static imk_status run_windows(layout *l, const imk_model *model, const imk_executor *executor,
                              double peak[2][3], imk_error *error)
{
    const size_t windows = l->totals.windows, each = l->settings->window_count;
    for (size_t first = 0; first < windows; first += IMKI_TUNING_LANES) {
        const size_t left = windows - first,
                     now = left < IMKI_TUNING_LANES ? left : IMKI_TUNING_LANES;
        for (size_t i = 0; i < now; i++) {
            imki_tuning_lane *lane = &l->lane[i];
            lane->plan = l->plan;
            lane->settings = l->settings;
            lane->grid = l->grid;
            lane->model = model;
            lane->motion = (first + i) / each;
            lane->window = (first + i) % each;
        }
        imk_execute(executor, now, run_lane, l->lane);
        for (size_t i = 0; i < now; i++) {
            if (l->lane[i].status != IMK_OK) {
                if (error)
                    *error = l->lane[i].error;
                return l->lane[i].status;
            }
            keep_window(l, &l->lane[i], first + i);
            for (int j = 0; j < 6; j++)
                peak[j / 3][j % 3] = fmax(peak[j / 3][j % 3], l->lane[i].peak[j / 3][j % 3]);
        }
    }
    return IMK_OK;
}

/* ---- the bias that is known ---- */

/* Allan deviation of the worst axis at 100 s. */
static double stated_bias(const imk_model *model, int sensor, double rate)
{
    const double time = 100.0;
    imki_term_place place = {imk_model_triad(model, sensor), 0, 0};
    double most = 0.0;
    for (place.axis = 0; place.axis < 3; place.axis++) {
        double sum = 0.0;
        for (int t = 0; t < IMKI_NOISE_TERMS; t++)
            for (place.instance = 0;
                 place.instance < imki_term_count(imki_noise_terms[t], &place.triad->noise);
                 place.instance++)
                if (imki_noise_terms[t]->strength(place) != 0.0)
                    sum += imki_noise_terms[t]->mean_variance(place, 1.0 / rate, time);
        place.instance = 0;
        most = fmax(most, sum);
    }
    return sqrt(most);
}

/* ---- all ---- */

/* A range that the motion comes near to cuts the readings, as in the drift. */
static void omit_ranges(layout *l, const imk_model *model, double peak[2][3])
{
    static const char *const names[2] = {"gyro.range", "accel.range"};
    for (int sensor = 0; sensor < 2; sensor++) {
        bool left = false;
        for (int i = 0; i < 3; i++) {
            const double range = imk_model_triad(model, sensor)->range.value[i];
            left = left || (range > 0.0 && peak[sensor][i] > 0.95 * range);
        }
        if (left)
            imki_drift_omit(&l->plan->drift, names[sensor]);
    }
}

static void fill_result(layout *l)
{
    imk_filter_tuning *tuning = l->tuning;
    const imki_tuning_grid *grid = l->grid;
    tuning->time_count = grid->time_count;
    tuning->short_count = grid->short_count;
    tuning->long_count = grid->long_count;
    tuning->window_count = l->totals.windows;
    tuning->samples = grid->samples;
    tuning->time = l->time;
    for (size_t t = 0; t < grid->time_count; t++)
        l->time[t] = (double)grid->samples[t] / l->settings->rate;
    tuning->source_count = l->totals.sources;
    tuning->source = l->source;
    tuning->increments = (const double(*)[15])l->totals.increments;
    tuning->truth = (const double(*)[9][9])l->totals.truth;
    for (size_t t = 0; t < l->totals.times; t++)
        for (size_t s = 0; s < l->totals.sources; s++)
            for (int i = 0; i < 81; i++)
                l->totals.truth[t][i / 9][i % 9] +=
                    l->totals.source[s * l->totals.times + t][i / 9][i % 9];
}

static imk_status refuse_perfect(imk_error *error)
{
    return imk_error_set(error, IMK_ERROR_SINGULAR, "model", "",
                         "noise in gyros and accelerometers: without it no noise of a filter fits "
                         "the errors best");
}

imk_status imk_filter_tuning_run(const imk_model *model, const imk_filter_tuning_settings *settings,
                                 const imk_executor *executor, imk_filter_tuning **tuning,
                                 void *memory, size_t memory_size, imk_error *error)
{
    imk_status status = imk_filter_tuning_validate(model, settings, error);
    if (status != IMK_OK)
        return status;
    if (!memory)
        return imk_error_set(error, IMK_ERROR_ARGUMENT, "memory", "", "memory");
    if (memory_size < imk_filter_tuning_size(model, settings))
        return imk_error_set(error, IMK_ERROR_WORKSPACE, "memory", "",
                             "imk_filter_tuning_size() bytes");
    imki_parts whole = imki_parts_of(memory);
    memset(whole.memory, 0, imk_filter_tuning_size(model, settings) - IMKI_ALIGNMENT_SLACK);
    layout l = lay_out(model, settings, memory);
    double peak[2][3] = {{0.0}};
    for (int sensor = 0; sensor < 2; sensor++) {
        if (settings->bias_sigma[sensor] < 0.0)
            l.settings->bias_sigma[sensor] = stated_bias(model, sensor, settings->rate);
        l.tuning->bias_sigma[sensor] = l.settings->bias_sigma[sensor];
    }
    l.plan->drift.omitted = l.tuning->omitted;
    status = imki_tuning_plan_make(l.plan, model, l.settings, l.grid, error);
    if (status == IMK_OK && l.plan->drift.element_count == 0)
        return refuse_perfect(error);
    if (status == IMK_OK)
        status = run_windows(&l, model, executor, peak, error);
    if (status != IMK_OK)
        return status;
    omit_ranges(&l, model, peak);
    l.tuning->omitted_count = l.plan->drift.omitted_count;
    fill_result(&l);
    if (!imki_tuning_answers(&l.totals, &l.arrays, model, l.settings, l.tuning))
        return refuse_perfect(error);
    *tuning = l.tuning;
    return IMK_OK;
}
