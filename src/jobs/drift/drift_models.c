/* SPDX-License-Identifier: Apache-2.0 */
/* Covariance of each model, its figures, and the budget of its terms. */
#include "drift_models_internal.h"

#include "base/refuse_internal.h"
#include "jobs/job_internal.h"
#include "jobs/record/record_check_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const uint32_t settings_cookie = 0x44524d31; /* "DRM1" */

/* The result and its memory. */
typedef struct holder {
    imk_drift_models models;
    imki_arena arena;
} holder;

imk_drift_models_settings imk_drift_models_default(void)
{
    return (imk_drift_models_settings){.cookie = settings_cookie, .drift = imk_drift_default()};
}

/* ---- the budget ---- */

static size_t budget_time(const imk_drift_models *r, const imk_drift_case *one)
{
    const imk_drift_times *times = r->times;
    size_t chosen = times->row[0];
    for (size_t k = 0; k < times->row_count; k++) {
        const size_t t = times->row[k];
        if (r->settings.want.asked ? fabs(times->time[t] - r->settings.want.time) <
                                         fabs(times->time[chosen] - r->settings.want.time)
                                   : imk_drift_validity_of(&one->figures[t]) != IMK_DRIFT_LOST)
            chosen = t;
    }
    return chosen;
}

/* States whose squares make a figure. */
static void states_of(imk_drift_requirement requirement, int *first, int *last)
{
    static const int of[][2] = {{0, 1}, {0, 1}, {0, 1}, {2, 2}, {3, 4}, {6, 7}, {8, 8}};
    *first = of[requirement][0];
    *last = of[requirement][1];
}

double imki_drift_variance(const imk_drift_moments *m, imk_drift_requirement requirement)
{
    int first, last;
    double sum = 0;
    states_of(requirement, &first, &last);
    for (int i = first; i <= last; i++)
        sum += m->covariance[i][i];
    return sum;
}

double imki_drift_shift(const imk_drift_moments *m, imk_drift_requirement requirement)
{
    int first, last;
    double sum = 0;
    states_of(requirement, &first, &last);
    for (int i = first; i <= last; i++)
        sum += m->mean[i] * m->mean[i];
    return sqrt(sum);
}

static int by_share(const void *a, const void *b)
{
    const imk_drift_share *x = a, *y = b;
    if (x->share != y->share)
        return x->share < y->share ? 1 : -1;
    if (x->shift != y->shift)
        return x->shift < y->shift ? 1 : -1;
    return (x->source > y->source) - (x->source < y->source);
}

static bool find_budget(const imk_drift_models *r, imk_drift_case *one, imki_arena *arena)
{
    const imk_drift_requirement requirement = imki_drift_looked_at(r);
    const imk_drift_analysis *a = one->analysis;
    one->time = budget_time(r, one);
    one->share = imki_arena_take(arena, (a->source_count + 1) * sizeof *one->share);
    if (!one->share)
        return false;
    const double total = imki_drift_variance(&a->total[one->time], requirement);
    for (size_t k = 0; k < a->source_count; k++) {
        imk_drift_moments m = a->contribution[k * a->time_count + one->time];
        imk_drift_share s = {.source = k, .shift = imki_drift_shift(&m, requirement)};
        s.share = total > 0 ? imki_drift_variance(&m, requirement) / total : 0;
        if (!(s.share > 0) && !(s.shift > 0))
            continue;
        s.whole = imk_drift_figures_of(&m);
        for (int i = 0; i < IMK_DRIFT_STATES; i++)
            m.mean[i] = 0;
        s.random = imk_drift_figures_of(&m);
        one->share[one->share_count++] = s;
    }
    for (size_t k = 0; k < a->cross_count && total > 0; k++)
        one->correlation_share +=
            imki_drift_variance(&a->cross[k].moments[one->time], requirement) / total;
    qsort(one->share, one->share_count, sizeof *one->share, by_share);
    return true;
}

/* ---- what is not stated ---- */

/* A table shows all of these; a requirement is about one. */
static unsigned figures_shown(const imk_drift_models *r)
{
    const bool is_free = r->settings.drift.vertical == IMK_VERTICAL_FREE;
    return 1U << IMK_REQUIRED_DRMS | 1U << IMK_REQUIRED_VELOCITY | 1U << IMK_REQUIRED_TILT |
           1U << IMK_REQUIRED_HEADING | (is_free ? 1U << IMK_REQUIRED_HEIGHT : 0U);
}

static imk_status find_missing(const imk_drift_models *r, imk_drift_case *one,
                               const imk_executor *executor, imk_error *error)
{
    double time[IMK_DRIFT_ROWS_MAX];
    imki_arena scratch = {.allocator = r->times->allocator};
    imk_drift_settings settings = one->settings;
    const bool asked = r->settings.want.asked;
    settings.time_count = asked ? 1 : r->times->row_count;
    for (size_t k = 0; k < settings.time_count; k++)
        time[k] = asked ? r->times->time[one->time] : imki_drift_row_time(r, k);
    settings.time = time;
    const unsigned figures = asked ? 1U << imki_drift_looked_at(r) : figures_shown(r);
    const imk_status status = imki_drift_missing(one->model, &settings, figures, executor, &scratch,
                                                 one->missing, &one->missing_count, error);
    imki_arena_free(&scratch);
    return status;
}

/* ---- all ---- */

/* How far the analyses are. With aids one of them takes a second for each hour. */
typedef struct analyses {
    const imk_job *job;
    double each, before; /* of a case, of those before this one [s] */
    double all;
} analyses;

static bool tell(void *context, double time)
{
    const analyses *a = context;
    return imki_job_progress(a->job, "analysing", "min", (uint64_t)((a->before + time) / 60),
                             (uint64_t)ceil(a->all / 60), NULL) == IMK_OK;
}

static imk_status analyse(const imk_drift_models *r, imk_drift_case *one, imki_arena *arena,
                          analyses *told, imk_error *error)
{
    const imk_executor *executor = told->job->executor;
    imk_status status = imk_drift_validate(one->model, &one->settings, error);
    if (status != IMK_OK)
        return status;
    const size_t size = imk_drift_covariance_size(one->model, &one->settings);
    void *memory = imki_arena_room(arena, size);
    one->figures = imki_arena_take(arena, one->settings.time_count * sizeof *one->figures);
    if (!memory || !one->figures)
        return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    imk_drift_settings watched = one->settings; /* others work on several threads */
    watched.progress = tell;
    watched.progress_context = told;
    status =
        imk_drift_covariance(one->model, &watched, executor, &one->analysis, memory, size, error);
    told->before += told->each;
    if (status != IMK_OK)
        return status;
    for (size_t t = 0; t < one->analysis->time_count; t++)
        one->figures[t] = imk_drift_figures_of(&one->analysis->total[t]);
    return find_budget(r, one, arena) ? find_missing(r, one, executor, error)
                                      : imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
}

static imk_status add_case(holder *h, size_t model, bool compensated, const char *label,
                           analyses *told, imk_error *error)
{
    imk_drift_models *r = &h->models;
    imk_drift_case *one = &r->cases[r->case_count++];
    one->name = r->name[model];
    one->model = r->model[model];
    one->settings = r->settings.drift;
    one->settings.compensated = compensated;
    if (!one->settings.filter_model && one->settings.aid_count > 0 && r->settings.filter_models)
        one->settings.filter_model = r->settings.filter_models[model];
    snprintf(one->label, sizeof one->label, "%.90s%s", r->name[model], label);
    return analyse(r, one, &h->arena, told, error);
}

/* A requirement is of a time of the table, which is on a sample. */
static imk_status check_wanted(const imk_drift_models_settings *s, const imk_drift_times *times,
                               imk_error *error)
{
    double nearest = times->time[times->row[0]];
    for (size_t k = 1; k < times->row_count; k++)
        if (fabs(times->time[times->row[k]] - s->want.time) < fabs(nearest - s->want.time))
            nearest = times->time[times->row[k]];
    if (fabs(nearest - s->want.time) <= 1 / s->drift.rate)
        return IMK_OK;
    return imki_refuse(error, IMK_ERROR_RANGE, "want.time", s->want.time, nearest,
                       "a time of the table");
}

static imk_status check_handed(size_t count, const imk_model *const *models,
                               const char *const *names, const imk_drift_times *times,
                               const imk_drift_models_settings *s, imk_error *error)
{
    imk_status status = IMK_OK;
    if (!times || (count > 0 && (times->count == 0 || times->row_count == 0)))
        return imk_error_set(error, IMK_ERROR_ARGUMENT, "times", NULL, "imk_drift_times_choose()");
    if (count > IMK_DRIFT_MODELS_MAX)
        return imki_refuse(error, IMK_ERROR_RANGE, "count", (double)count, IMK_DRIFT_MODELS_MAX,
                           NULL);
    for (size_t m = 0; m < count && status == IMK_OK; m++) {
        if (!models || !names || !names[m])
            return imk_error_set(error, IMK_ERROR_ARGUMENT, models ? "names" : "models", NULL,
                                 "one for each model");
        status = imki_check_model(models[m], error);
    }
    if (status == IMK_OK && count > 0 && s->want.asked)
        status = check_wanted(s, times, error);
    return status;
}

imk_status imk_drift_models_run(size_t count, const imk_model *const *models,
                                const char *const *names, const imk_drift_times *times,
                                const imk_drift_models_settings *settings, const imk_job *job,
                                imk_drift_models **result, imk_error *error)
{
    imk_status status =
        imki_check_call(result, settings, settings_cookie, "imk_drift_models_default()", error);
    if (!result)
        return status;
    *result = NULL;
    job = imki_job_of(job);
    if (status == IMK_OK)
        status = check_handed(count, models, names, times, settings, error);
    holder *h = imki_result_new(job, sizeof *h, &status, error);
    if (!h)
        return status;
    h->arena.allocator = job->allocator;
    imk_drift_models *r = &h->models;
    *result = r;
    r->settings = *settings;
    r->settings.drift.time = times->time;
    r->settings.drift.time_count = times->count;
    r->times = times;
    r->model_count = count;
    for (size_t m = 0; m < count; m++) {
        r->model[m] = models[m];
        r->name[m] = names[m];
    }
    const bool after = settings->calibrated;
    const size_t cases = after && count == 1 ? 2 : count;
    analyses told = {.job = job, .each = count > 0 ? times->time[times->count - 1] : 0};
    told.all = (double)cases * told.each;
    if (status == IMK_OK && !tell(&told, 0))
        status = imk_error_set(error, IMK_ERROR_CANCELLED, NULL, NULL, NULL);
    if (status == IMK_OK && cases > count)
        status = add_case(h, 0, false, "", &told, error);
    for (size_t m = 0; m < count && status == IMK_OK; m++)
        status = add_case(h, m, after, after ? ", compensated" : "", &told, error);
    if (status == IMK_OK && count > 0 && settings->want.asked)
        status = imki_drift_answer(r, &h->arena, job->executor, error);
    return status;
}

void *imki_drift_models_room(imk_drift_models *models, size_t size)
{
    return imki_arena_room(&((holder *)models)->arena, size);
}

/* Mean of the runs that are numbers. */
static double mean_square(size_t runs, size_t stride, const double *square)
{
    double sum = 0.0;
    size_t count = 0;
    for (size_t k = 0; k < runs; k++)
        if (isfinite(square[k * stride])) {
            sum += square[k * stride];
            count++;
        }
    return count > 0 ? sum / (double)count : (double)NAN;
}

imk_status imk_drift_models_take_runs(imk_drift_models *r, size_t runs, int degrees,
                                      const double *errors, imk_error *error)
{
    imki_arena *arena = &((holder *)r)->arena;
    const size_t rows = r->times->row_count;
    const size_t states = degrees > 0 ? IMK_DRIFT_AIDED_STATES : IMK_DRIFT_STATES;
    double *workspace = imki_resize(&arena->allocator, NULL, (runs + 1) * sizeof *workspace);
    r->run_count = runs;
    r->nees_degrees = degrees;
    r->low = imki_arena_take(arena, rows * sizeof *r->low);
    r->high = imki_arena_take(arena, rows * sizeof *r->high);
    r->used = imki_arena_take(arena, rows * sizeof *r->used);
    r->nees = imki_arena_take(arena, rows * sizeof *r->nees);
    r->found = imki_arena_take(arena, rows * sizeof *r->found);
    const bool there = workspace && r->low && r->high && r->used && r->found && r->nees;
    for (size_t k = 0; k < rows && there; k++) {
        const double *row = errors + k * states;
        r->found[k] = imk_drift_figures_of_runs(runs, rows * states, row, workspace, &r->low[k],
                                                &r->high[k], &r->used[k]);
        r->nees[k] = degrees > 0 ? mean_square(runs, rows * states, row + IMK_DRIFT_STATES) : 0.0;
    }
    imki_resize(&arena->allocator, workspace, 0);
    return there ? IMK_OK : imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
}

void imk_drift_models_free(imk_drift_models *result)
{
    if (!result)
        return;
    imki_arena arena = ((holder *)result)->arena;
    imki_arena_free(&arena);
    imki_resize(&arena.allocator, result, 0);
}
