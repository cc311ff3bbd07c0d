/* SPDX-License-Identifier: Apache-2.0 */
/* Monte Carlo of a drift in memory: batches of runs on the threads of the job. */
#include "drift_models_internal.h"

#include "base/refuse_internal.h"
#include "jobs/job_internal.h"

/* What all batches share. */
typedef struct campaign {
    const imk_drift_case *one;
    imk_drift_settings settings;
    uint64_t seed, runs, first; /* first of the batches that are computed at once */
    size_t run_values;          /* numbers of a run */
    double *errors;
    size_t size; /* of the workspace of a batch */
    unsigned char *workspace;
    imk_status *status;
    imk_error *error;
} campaign;

static void compute(void *context, size_t item)
{
    campaign *c = context;
    const uint64_t first = c->first + item * IMK_DRIFT_LANES, left = c->runs - first;
    const size_t count = left < IMK_DRIFT_LANES ? (size_t)left : IMK_DRIFT_LANES;
    c->status[item] = (c->settings.aid_count > 0 ? imk_drift_aided_runs : imk_drift_runs)(
        c->one->model, &c->settings, c->seed, (uint32_t)first, count,
        c->errors + first * c->run_values, c->workspace + item * c->size, c->size, &c->error[item]);
}

/* As many batches at once as there are threads. */
static imk_status run(campaign *c, size_t threads, const imk_job *job, imk_error *error)
{
    const uint64_t at_once = (uint64_t)threads * IMK_DRIFT_LANES;
    for (c->first = 0; c->first < c->runs; c->first += at_once) {
        const uint64_t left = c->runs - c->first, runs = left < at_once ? left : at_once;
        const size_t items = (size_t)((runs + IMK_DRIFT_LANES - 1) / IMK_DRIFT_LANES);
        imk_execute(job->executor, items, compute, c);
        for (size_t i = 0; i < items; i++) {
            if (c->status[i] != IMK_OK && error)
                *error = c->error[i];
            if (c->status[i] != IMK_OK)
                return c->status[i];
        }
        const imk_status status =
            imki_job_progress(job, "simulating", "runs", c->first + runs, c->runs, error);
        if (status != IMK_OK)
            return status;
    }
    return IMK_OK;
}

/* Errors of all runs, in memory of the result. */
static imk_status simulate(imk_drift_models *r, campaign *c, imki_arena *scratch,
                           const imk_job *job, imk_error *error)
{
    double time[IMK_DRIFT_ROWS_MAX];
    const size_t rows = r->times->row_count, threads = job->executor ? job->executor->threads : 1;
    for (size_t k = 0; k < rows; k++)
        time[k] = imki_drift_row_time(r, k);
    c->settings.time = time;
    c->settings.time_count = rows;
    c->size = (imk_drift_runs_workspace_size(c->one->model, &c->settings) + 63) / 64 * 64;
    c->workspace = imki_arena_room(scratch, threads * c->size);
    c->status = imki_arena_take(scratch, threads * sizeof *c->status);
    c->error = imki_arena_take(scratch, threads * sizeof *c->error);
    if (!c->workspace || !c->status || !c->error)
        return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    imk_status status = imki_job_progress(job, "simulating", "runs", 0, c->runs, error);
    if (status == IMK_OK)
        status = run(c, threads, job, error);
    const int degrees = c->settings.aid_count > 0 ? imk_drift_nees_degrees(&c->settings) : 0;
    return status == IMK_OK
               ? imk_drift_models_take_runs(r, (size_t)c->runs, degrees, c->errors, error)
               : status;
}

imk_status imk_drift_models_simulate(imk_drift_models *models, uint64_t seed, uint64_t runs,
                                     const imk_job *job, const double **errors, imk_error *error)
{
    if (!models || models->case_count == 0)
        return imk_error_set(error, IMK_ERROR_ARGUMENT, "models", NULL, "imk_drift_models_run()");
    if (runs == 0 || runs > UINT32_MAX)
        return imki_refuse(error, IMK_ERROR_RANGE, "runs", (double)runs, UINT32_MAX,
                           "1 to 4294967295");
    job = imki_job_of(job);
    campaign c = {.one = imki_drift_last_case(models), .seed = seed, .runs = runs};
    c.settings = c.one->settings;
    const size_t states = c.settings.aid_count > 0 ? IMK_DRIFT_AIDED_STATES : IMK_DRIFT_STATES;
    c.run_values = models->times->row_count * states;
    c.errors = runs <= SIZE_MAX / sizeof(double) / c.run_values
                   ? imki_drift_models_room(models, (size_t)runs * c.run_values * sizeof(double))
                   : NULL;
    if (!c.errors)
        return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    imki_arena scratch = {.allocator = job->allocator};
    const imk_status status = simulate(models, &c, &scratch, job, error);
    imki_arena_free(&scratch);
    if (status == IMK_OK && errors)
        *errors = c.errors;
    return status;
}
