/* SPDX-License-Identifier: Apache-2.0 */
/* The covariance analysis as a whole: its memory, and the order of the work.
 *
 * Steps are chosen and looked at one after another, in blocks. Then the steps of a block, the
 * drivers over their lengths, and the sources over all of them are work items, each alone with its
 * own results: nothing depends on who does what when. */
#include "drift_aided_internal.h"
#include "drift_correlation_internal.h"

#include "base/workspace_internal.h"

#include <string.h>

/* ---- memory ------------------------------------------------------------------------------------
 */

typedef struct work {
    imki_drift_plan plan;
    imki_drift_walk walk;
    imki_drift_step step[IMKI_DRIFT_BLOCK];
    size_t step_count;
    imki_drift_loop loop;
    imki_aided_step aided[IMKI_DRIFT_BLOCK];
    imki_driver_step (*over)[IMKI_DRIFT_SLOTS]; /* [driver] */
    double slot_length[IMKI_DRIFT_SLOTS];       /* h; 0: free */
    int slot_moments[IMKI_DRIFT_SLOTS], slot_age[IMKI_DRIFT_SLOTS];
    int fresh[IMKI_DRIFT_SLOTS], fresh_count; /* slots that drivers have yet to fill */
    imki_drift_node report;                   /* the motion where the results are taken */
    bool reports;                             /* after this block */
    bool aids;
    size_t time; /* index of the result */
    imk_drift_moments *contribution, *believed;
    size_t time_count, cross_count;
    imk_drift_cross *cross;
    imk_drift_moments *cross_moments; /* [cross][time] */
} work;

typedef struct layout {
    imk_drift_analysis *analysis;
    work *work;
    imk_drift_source *source;
    imk_drift_moments *contribution, *total, *believed, *cross_moments;
    imk_drift_cross *cross;
    size_t cross_max;
    double *time;
    imki_drift_part *part;
    imki_drift_element *element;
    imki_drift_column *column;
    imki_drift_driver *driver;
    double *vector, *covariance;
    imki_driver_step (*over)[IMKI_DRIFT_SLOTS];
    double (*coefficient)[IMKI_DRIFT_COLUMNS][IMKI_DRIFT_MOMENTS][9]; /* [step] */
    size_t states;
    imki_loop_memory loop;
    double *decay, *update;
    double (*enter)[IMKI_DRIFT_COLUMNS][IMKI_UPDATE_ROWS];
    imki_parts memory;
} layout;

static void lay_out_loop(layout *l, const imk_drift_settings *settings)
{
    const size_t n = l->states, updates = IMKI_DRIFT_BLOCK * settings->aid_count;
    if (settings->aid_count == 0)
        return;
    l->loop.filter = imki_take(&l->memory, l->loop.filter_size);
    l->loop.scratch = imki_take(&l->memory, imki_drift_filter_scratch());
    l->decay = imki_take(&l->memory, IMKI_DRIFT_BLOCK * n * sizeof *l->decay);
    l->update = imki_take(&l->memory, updates * 2 * IMKI_UPDATE_ROWS * n * sizeof *l->update);
    l->enter = imki_take(&l->memory, updates * sizeof *l->enter);
}

static layout lay_out(const imk_model *model, const imk_drift_settings *settings, void *memory)
{
    layout l = {.memory = imki_parts_of(memory)};
    imki_drift_plan count = {.source_count = 0};
    imki_drift_sources(&count, model, settings, (imk_geodetic){0.0, 0.0, 0.0});
    const size_t sources = count.source_count, times = settings->time_count;
    const size_t drivers = imki_drift_drivers_max(model, settings);
    const size_t n = l.states = imki_drift_filter_states(model, settings, &l.loop.filter_size);
    l.analysis = imki_take(&l.memory, sizeof *l.analysis);
    l.source = imki_take(&l.memory, sources * sizeof *l.source);
    l.contribution = imki_take(&l.memory, sources * times * sizeof *l.contribution);
    l.cross_max = imki_drift_cross_max(model, settings);
    l.cross = imki_take(&l.memory, l.cross_max * sizeof *l.cross);
    l.cross_moments = imki_take(&l.memory, l.cross_max * times * sizeof *l.cross_moments);
    l.total = imki_take(&l.memory, times * sizeof *l.total);
    l.believed = imki_take(&l.memory, (settings->aid_count > 0 ? times : 0) * sizeof *l.believed);
    l.time = imki_take(&l.memory, times * sizeof *l.time);
    l.work = imki_take(&l.memory, sizeof *l.work);
    l.part = imki_take(&l.memory, sources * sizeof *l.part);
    /* One more, so that the array is there also for a model without errors. */
    l.element = imki_take(&l.memory, (count.element_count + 1) * sizeof *l.element);
    l.column = imki_take(&l.memory, IMKI_DRIFT_COLUMNS * sizeof *l.column);
    l.driver = imki_take(&l.memory, drivers * sizeof *l.driver);
    l.over = imki_take(&l.memory, drivers * sizeof *l.over);
    l.vector = imki_take(&l.memory, 3 * (count.element_count + 1) * n * sizeof *l.vector);
    l.covariance = imki_take(&l.memory, sources * n * n * sizeof *l.covariance);
    l.coefficient = imki_take(&l.memory, IMKI_DRIFT_BLOCK * sizeof *l.coefficient);
    lay_out_loop(&l, settings);
    return l;
}

size_t imk_drift_covariance_size(const imk_model *model, const imk_drift_settings *settings)
{
    const layout l = lay_out(model, settings, NULL);
    return imki_parts_size(&l.memory);
}

/* ---- work items --------------------------------------------------------------------------------
 */

static void fill_step(void *context, size_t item)
{
    work *w = context;
    imki_drift_fill_step(&w->walk, &w->plan, &w->step[item]);
    if (w->step[item].aided)
        imki_loop_fill(&w->loop, &w->plan, &w->walk, &w->step[item]);
}

static void fill_driver(void *context, size_t item)
{
    work *w = context;
    for (int i = 0; i < w->fresh_count; i++) {
        const int slot = w->fresh[i];
        imki_driver_over(&w->plan.driver[item], w->slot_length[slot], w->slot_moments[slot],
                         &w->over[item][slot]);
    }
}

static void begin_source(void *context, size_t item)
{
    work *w = context;
    imki_drift_begin(&w->plan, &w->plan.part[item], &w->step[0].node[0],
                     w->step_count > 0 ? &w->step[0] : NULL, w->over);
}

static void move_source(void *context, size_t item)
{
    work *w = context;
    for (size_t i = 0; i < w->step_count; i++)
        imki_drift_propagate(&w->plan, &w->plan.part[item], &w->step[i], w->over);
    if (w->reports)
        imki_drift_moments_at(&w->plan, &w->plan.part[item], &w->report,
                              &w->contribution[item * w->time_count + w->time]);
}

/* ---- blocks ------------------------------------------------------------------------------------
 */

/* Where drivers keep what they do over a step of this length: found again (report times computed
 * elsewhere differ by rounding), or in place of the one not used for longest. */
static int slot_of(work *w, double h, int moments)
{
    int slot = -1, oldest = 0;
    for (int i = 0; i < IMKI_DRIFT_SLOTS; i++) {
        const double difference = w->slot_length[i] - h;
        if (w->slot_moments[i] == moments && difference <= 1e-12 * h && difference >= -1e-12 * h)
            slot = i;
        if (w->slot_age[i] > w->slot_age[oldest])
            oldest = i;
    }
    if (slot < 0) {
        slot = oldest;
        w->slot_length[slot] = h;
        w->slot_moments[slot] = moments;
        w->fresh[w->fresh_count++] = slot;
    }
    for (int i = 0; i < IMKI_DRIFT_SLOTS; i++)
        w->slot_age[i]++;
    w->slot_age[slot] = 0;
    return slot;
}

static void run_block(work *w, imk_work source_work, const imk_executor *executor)
{
    if (w->fresh_count > 0)
        imk_execute(executor, w->plan.driver_count, fill_driver, w);
    imk_execute(executor, w->plan.source_count, source_work, w);
    for (size_t k = 0; k < w->cross_count && w->reports; k++)
        imki_drift_cross_at(&w->plan, &w->cross[k], &w->report,
                            &w->cross_moments[k * w->time_count + w->time]);
    w->fresh_count = 0;
    w->step_count = 0;
}

static void begin(work *w, const imk_executor *executor)
{
    imki_drift_step *step = &w->step[0];
    imki_drift_node_at(&w->walk, w->walk.motion.start, &step->node[0]);
    if (w->walk.settings->alignment == IMK_ALIGNED_SELF) {
        imki_drift_alignment_step(&w->walk, &w->plan, step);
        step->slot = slot_of(w, step->h, step->moments);
        w->step_count = 1;
    }
    run_block(w, begin_source, executor);
}

/* From one report to the next. @return false: to be ended */
static bool advance(work *w, double time, double goal, const imk_executor *executor)
{
    while (time < goal) {
        while (time < goal && w->step_count < IMKI_DRIFT_BLOCK) {
            const size_t number = w->step_count++;
            imki_drift_step *step = &w->step[number];
            const double limit = w->aids ? imki_loop_limit(&w->loop, time, goal) : goal;
            time = imki_drift_next_step(&w->walk, time, limit, step);
            step->slot = slot_of(w, step->h, step->moments);
            step->aided = w->aids ? &w->aided[number] : NULL;
            if (w->aids)
                imki_loop_take(&w->loop, step, time, !(time < limit));
        }
        w->reports = !(time < goal);
        if (w->reports) {
            imki_drift_node_at(&w->walk, w->walk.motion.start + (w->walk.rests ? 0.0 : goal),
                               &w->report);
            imki_drift_level(w->walk.earth, w->walk.settings->attitude_errors, &w->report);
            if (w->aids)
                imki_loop_believed(&w->loop, &w->report, &w->believed[w->time]);
        }
        imk_execute(executor, w->step_count, fill_step, w);
        run_block(w, move_source, executor);
        const imk_drift_settings *s = w->walk.settings;
        if (s->progress && !s->progress(s->progress_context, time))
            return false;
    }
    return true;
}

/* ---- all ---------------------------------------------------------------------------------------
 */

static void start_work(work *w, const layout *l, const imk_model *model,
                       const imk_drift_settings *settings, imki_drift_earth earth)
{
    memset(w, 0, sizeof *w);
    w->plan = (imki_drift_plan){.source = l->source,
                                .part = l->part,
                                .states = l->states,
                                .vector = l->vector,
                                .covariance = l->covariance,
                                .element = l->element,
                                .column = l->column,
                                .driver = l->driver,
                                .omitted = l->analysis->omitted};
    w->over = l->over;
    w->contribution = l->contribution;
    w->believed = l->believed;
    w->time_count = settings->time_count;
    for (int i = 0; i < IMKI_DRIFT_SLOTS; i++)
        w->slot_length[i] = -1.0;
    for (size_t i = 0; i < IMKI_DRIFT_BLOCK; i++)
        w->step[i].column = l->coefficient[i];
    w->walk.settings = settings;
    w->walk.earth = earth;
    w->walk.rests = settings->motion == NULL;
    imki_drift_motion(settings, &w->walk.motion, NULL);
    w->walk.motion.trajectory.line_count = 0;
    imk_motion_state state;
    imk_trajectory_state(&w->walk.motion.trajectory, w->walk.motion.start, &state);
    imki_drift_sources(&w->plan, model, settings, state.place);
    w->cross = l->cross;
    w->cross_moments = l->cross_moments;
    w->cross_count = imki_drift_cross_pairs(&w->plan, l->cross_max, l->cross);
    for (size_t k = 0; k < w->cross_count; k++)
        l->cross[k].moments = &l->cross_moments[k * w->time_count];
    for (size_t i = 0; i < w->plan.column_count; i++)
        w->walk.needs_slope = w->walk.needs_slope || l->column[i].kind == IMKI_COLUMN_JITTER;
}

/* The filter, and where its gains are kept. */
static imk_status start_loop(work *w, const layout *l, const imk_model *model,
                             const imk_drift_settings *settings, imk_error *error)
{
    w->aids = settings->aid_count > 0;
    if (!w->aids)
        return IMK_OK;
    const imk_status status =
        imki_loop_start(&w->loop, model, settings, &w->walk, &w->plan, &l->loop, error);
    const size_t n = w->loop.states, room = IMKI_UPDATE_ROWS * l->states;
    w->plan.states = n > 0 ? n : w->plan.states;
    if (status != IMK_OK)
        return status;
    for (size_t i = 0; i < IMKI_DRIFT_BLOCK; i++) {
        imki_aided_step *aided = &w->aided[i];
        *aided = (imki_aided_step){.states = n,
                                   .parts = {w->loop.filter->parts[0], w->loop.filter->parts[1]},
                                   .rate = settings->rate,
                                   .decay = l->decay + i * l->states};
        for (size_t k = 0; k < settings->aid_count; k++) {
            const size_t number = i * settings->aid_count + k;
            aided->update[k].h = l->update + 2 * number * room;
            aided->update[k].gain = aided->update[k].h + room;
            aided->update[k].enter = l->enter[number];
        }
    }
    return IMK_OK;
}

/* A range that the motion leaves, or comes near to, cuts the readings. */
static void omit_ranges(work *w, const imk_model *model)
{
    static const char *const names[2] = {"gyro.range", "accel.range"};
    const imk_triad *triad[2] = {&model->gyro, &model->accel};
    for (int sensor = 0; sensor < 2; sensor++) {
        bool left = false;
        for (int i = 0; i < 3; i++)
            left = left || (triad[sensor]->range.value[i] > 0.0 &&
                            w->walk.peak[sensor][i] > 0.95 * triad[sensor]->range.value[i]);
        if (left)
            imki_drift_omit(&w->plan, names[sensor]);
    }
}

static void add_moments(imk_drift_moments *total, const imk_drift_moments *part)
{
    for (int i = 0; i < 9; i++) {
        total->mean[i] += part->mean[i];
        for (int j = 0; j < 9; j++)
            total->covariance[i][j] += part->covariance[i][j];
    }
}

static void add_up(const layout *l, size_t sources, size_t times)
{
    for (size_t time = 0; time < times; time++) {
        imk_drift_moments *total = &l->total[time];
        memset(total, 0, sizeof *total);
        for (size_t source = 0; source < sources; source++)
            add_moments(total, &l->contribution[source * times + time]);
        for (size_t k = 0; k < l->work->cross_count; k++)
            add_moments(total, &l->cross_moments[k * times + time]);
        for (int i = 0; i < 9 && l->work->cross_count > 0; i++) /* rounding */
            if (!(total->covariance[i][i] > 0.0))
                total->covariance[i][i] = 0.0;
    }
}

imk_status imki_drift_covariance_on(imki_drift_earth earth, const imk_model *model,
                                    const imk_drift_settings *settings, void *memory, size_t size,
                                    const imk_executor *executor, imk_drift_analysis **analysis,
                                    imk_error *error)
{
    imk_status status = imk_drift_validate(model, settings, error);
    if (status != IMK_OK)
        return status;
    const layout l = lay_out(model, settings, memory);
    if (!l.analysis)
        return imk_error_set(error, IMK_ERROR_ARGUMENT, "memory", "", "memory");
    if (size < imki_parts_size(&l.memory))
        return imk_error_set(error, IMK_ERROR_WORKSPACE, "memory", "",
                             "imk_drift_covariance_size() bytes");
    memset(l.analysis, 0, sizeof *l.analysis);
    start_work(l.work, &l, model, settings, earth);
    status = start_loop(l.work, &l, model, settings, error);
    if (status != IMK_OK)
        return status;
    begin(l.work, executor);
    double time = 0.0;
    for (size_t i = 0; i < settings->time_count; i++) {
        l.work->time = i;
        l.time[i] = settings->time[i];
        if (!advance(l.work, time, settings->time[i], executor))
            return imk_error_set(error, IMK_ERROR_CANCELLED, NULL, NULL, NULL);
        time = settings->time[i];
    }
    omit_ranges(l.work, model);
    const size_t sources = l.work->plan.source_count;
    add_up(&l, sources, settings->time_count);
    l.analysis->source_count = sources;
    l.analysis->time_count = settings->time_count;
    l.analysis->source = l.source;
    l.analysis->contribution = l.contribution;
    l.analysis->total = l.total;
    l.analysis->cross_count = l.work->cross_count;
    l.analysis->cross = l.cross;
    l.analysis->believed = settings->aid_count > 0 ? l.believed : NULL;
    l.analysis->time = l.time;
    l.analysis->omitted_count = l.work->plan.omitted_count;
    *analysis = l.analysis;
    return IMK_OK;
}

imk_status imk_drift_covariance(const imk_model *model, const imk_drift_settings *settings,
                                const imk_executor *executor, imk_drift_analysis **analysis,
                                void *memory, size_t memory_size, imk_error *error)
{
    return imki_drift_covariance_on((imki_drift_earth){0.0, 0.0}, model, settings, memory,
                                    memory_size, executor, analysis, error);
}
