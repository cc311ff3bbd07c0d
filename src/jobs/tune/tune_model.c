/* SPDX-License-Identifier: Apache-2.0 */
/* The noise of a filter on motions, and a Monte Carlo of its NEES. */
#include "imukit/tune_model.h"
#include "base/refuse_internal.h"
#include "base/text_internal.h"
#include "imukit/distributions.h"
#include "jobs/arena_internal.h"
#include "jobs/job_internal.h"
#include "jobs/record/record_check_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const uint32_t settings_cookie = 0x54554e31; /* "TUN1" */

/* The result and its memory. */
typedef struct holder {
    imk_tune_model tune;
    imki_arena arena;
} holder;

imk_tune_model_settings imk_tune_model_default(void)
{
    return (imk_tune_model_settings){
        .cookie = settings_cookie, .tuning = imk_filter_tuning_default(), .seed = 1};
}

/* ---- what is asked ---- */

imk_status imk_tune_model_rate(double stated, imk_filter_tuning_settings *tuning, imk_error *error)
{
    double rate = stated;
    bool other = false;
    if (!tuning || tuning->motion_count > IMK_TUNING_MOTIONS_MAX)
        return imk_error_set(error, IMK_ERROR_ARGUMENT, "tuning", NULL, NULL);
    for (size_t m = 0; m < tuning->motion_count; m++) {
        const imk_recorded_motion *recorded = tuning->motion[m].recorded;
        if (!recorded)
            continue;
        if (rate != 0 && !(fabs(recorded->rate - rate) <= 1e-6 * rate)) {
            (void)imk_error_set(error, IMK_ERROR_CONFLICT, "rate",
                                other ? "another motion has another rate"
                                      : "a motion has another rate",
                                "recorded rates and forces are taken at their own rate");
            if (error) {
                error->index = (int)m;
                error->value = recorded->rate;
                error->limit = rate;
            }
            return IMK_ERROR_CONFLICT;
        }
        rate = recorded->rate;
        other = true;
    }
    if (rate != 0)
        tuning->rate = rate;
    return IMK_OK;
}

void imk_tune_model_unstated(const imk_model *model, imk_unstated *unstated)
{
    imk_unstated all;
    imk_model_unstated(model, &all);
    unstated->count = 0;
    for (size_t i = 0; i < all.count; i++)
        if (strcmp(all.term[i].key, "bias.repeatability") != 0)
            unstated->term[unstated->count++] = all.term[i];
}

/* ---- runs ---- */

/* Sums over the runs, in the result until they are all there. */
static imk_status add_run(const imk_tune_model *tune, uint32_t run, double *errors, void *workspace,
                          size_t size, imk_tune_found *sums, imk_error *error)
{
    const imk_filter_tuning *t = tune->tuning;
    double nees[IMK_TUNING_TIMES_MAX];
    const imk_status status =
        imk_filter_tuning_simulate(tune->model, &tune->settings.tuning, t, tune->settings.seed, run,
                                   errors, workspace, size, error);
    for (int kind = 0; kind < IMK_FILTER_ANSWERS && status == IMK_OK; kind++) {
        if (!t->answer[kind].found)
            continue;
        imk_filter_tuning_nees(t, (imk_filter_answer_kind)kind, errors, nees);
        for (size_t i = 0; i < t->time_count; i++) {
            imk_tune_found *sum = &sums[(size_t)kind * t->time_count + i];
            sum->nees += nees[i];
            sum->upper += nees[i] * nees[i];
        }
    }
    return status;
}

static void finish_runs(const imk_tune_model *tune, imk_tune_found *sums)
{
    const size_t times = tune->tuning->time_count;
    const double n = tune->settings.run_count;
    const double reach = imk_student_quantile(1.0 - 0.005 / (double)times, n - 1.0);
    for (size_t i = 0; i < IMK_FILTER_ANSWERS * times; i++) {
        const double mean = sums[i].nees / n;
        const double variance = fmax(sums[i].upper / n - mean * mean, 0.0) / (n - 1.0);
        sums[i] =
            (imk_tune_found){mean, mean - reach * sqrt(variance), mean + reach * sqrt(variance)};
    }
}

static imk_status simulate(holder *h, const imk_job *job, imk_error *error)
{
    imk_tune_model *tune = &h->tune;
    const imk_filter_tuning *t = tune->tuning;
    const imk_tune_model_settings *s = &tune->settings;
    const size_t size = imk_filter_tuning_runs_workspace_size(tune->model, &s->tuning);
    imk_tune_found *found =
        imki_arena_take(&h->arena, IMK_FILTER_ANSWERS * t->time_count * sizeof *found);
    double *errors = imki_arena_room(&h->arena, t->window_count * t->time_count *
                                                    IMK_TUNING_STATES * sizeof *errors);
    void *workspace = imki_resize(&h->arena.allocator, NULL, size);
    imk_status status = found && errors && workspace
                            ? IMK_OK
                            : imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    for (uint32_t run = 0; run < s->run_count && status == IMK_OK; run++) {
        status = imki_job_progress(job, "simulating", "runs", run, s->run_count, error);
        if (status == IMK_OK)
            status = add_run(tune, run, errors, workspace, size, found, error);
    }
    imki_resize(&h->arena.allocator, workspace, 0);
    if (status != IMK_OK)
        return status;
    finish_runs(tune, found);
    tune->found = found;
    return imki_job_progress(job, "simulating", "runs", s->run_count, s->run_count, error);
}

/* ---- all ---- */

static imk_status tune_filter(holder *h, const imk_job *job, imk_error *error)
{
    imk_tune_model *tune = &h->tune;
    const imk_filter_tuning_settings *s = &tune->settings.tuning;
    imk_filter_tuning *tuning;
    imk_status status = imk_filter_tuning_validate(tune->model, s, error);
    if (status == IMK_OK)
        status = imki_job_progress(job, "tuning", "models", 0, 1, error);
    if (status != IMK_OK)
        return status;
    const size_t size = imk_filter_tuning_size(tune->model, s);
    void *memory = imki_arena_room(&h->arena, size);
    if (!memory)
        return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    status = imk_filter_tuning_run(tune->model, s, job->executor, &tuning, memory, size, error);
    if (status != IMK_OK)
        return status;
    tune->tuning = tuning;
    return imki_job_progress(job, "tuning", "models", 1, 1, error);
}

imk_status imk_tune_model_run(const imk_model *model, const char *name,
                              const imk_tune_model_settings *settings, const imk_job *job,
                              imk_tune_model **result, imk_error *error)
{
    imk_status status =
        imki_check_call(result, settings, settings_cookie, "imk_tune_model_default()", error);
    if (!result)
        return status;
    *result = NULL;
    job = imki_job_of(job);
    if (status == IMK_OK && !name)
        status = imk_error_set(error, IMK_ERROR_ARGUMENT, "name", NULL, "a name of the model");
    if (status == IMK_OK)
        status = imki_check_model(model, error);
    if (status == IMK_OK && settings->run_count > 0 && settings->run_count < 3)
        status = imki_refuse(error, IMK_ERROR_RANGE, "run_count", settings->run_count, 3.0,
                             "three runs or more: fewer have no interval");
    holder *h = imki_result_new(job, sizeof *h, &status, error);
    if (!h)
        return status;
    h->arena.allocator = job->allocator;
    *result = &h->tune;
    h->tune.settings = *settings;
    h->tune.model = model;
    h->tune.name = name;
    status = tune_filter(h, job, error);
    if (status == IMK_OK && settings->run_count > 0)
        status = simulate(h, job, error);
    return status;
}

void imk_tune_model_free(imk_tune_model *result)
{
    if (!result)
        return;
    imki_arena arena = ((holder *)result)->arena;
    imki_arena_free(&arena);
    imki_resize(&arena.allocator, result, 0);
}

/* ---- a file of it ---- */

imk_status imk_tune_model_answer(const imk_tune_model *tune, imk_filter_answer_kind kind,
                                 imk_model *made, imk_error *error)
{
    const bool known = (unsigned)kind < IMK_FILTER_ANSWERS;
    if (!known || !tune->tuning || !tune->tuning->answer[kind].found)
        return imk_error_set(error, IMK_ERROR_EMPTY, "answer",
                             known ? imk_filter_answer_name(kind) : NULL,
                             "an answer that was found");
    const imk_filter_parameters *p = &tune->tuning->answer[kind].parameters;
    imk_model_default(made);
    snprintf(made->name, sizeof made->name, "%.60s, filter (%s)", tune->name,
             imk_filter_answer_name(kind));
    imki_copy_text(made->description, sizeof made->description,
                   "noise of a filter, not of a sensor");
    for (int sensor = 0; sensor < 2; sensor++) {
        imk_triad *triad = imk_model_triad_to_set(made, sensor);
        triad->noise.density = IMK_DENSITY_TWO_SIDED;
        for (int axis = 0; axis < 3; axis++) {
            triad->noise.white.value[axis] = p->white[sensor][axis];
            if (p->correlation_time > 0.0) {
                triad->noise.gauss_markov_count = 1;
                triad->noise.gauss_markov[0].sigma.value[axis] =
                    p->walk[sensor][axis] * sqrt(0.5 * p->correlation_time);
                triad->noise.gauss_markov[0].correlation_time.value[axis] = p->correlation_time;
            } else
                triad->noise.random_walk.value[axis] = p->walk[sensor][axis];
            triad->bias.repeatability.value[axis] = p->bias_sigma[sensor];
            triad->scale_factor.repeatability.value[axis] = p->scale_factor[sensor][axis];
        }
    }
    return imk_model_validate(made, error);
}
