/* SPDX-License-Identifier: Apache-2.0 */
/* Screens and identifies the channels of a record, each a piece of work of its own. */
#include "identify_log_internal.h"

#include "jobs/allan/allan_curve_internal.h"
#include "jobs/arena_internal.h"
#include "jobs/job_internal.h"

#include <math.h>
#include <stdatomic.h>

typedef struct channel_work {
    imk_identify_log *log;
    const imk_job *job; /* without an executor: a channel has one thread */
    imk_status status[IMK_LOG_COLUMNS_MAX];
    imk_error error[IMK_LOG_COLUMNS_MAX];
    const size_t *factors;
    size_t factor_count;
    imk_job_progress progress;
    atomic_flag showing; /* one thread at a time tells, the others go on */
    atomic_size_t done;
    atomic_bool cancelled;
} channel_work;

/* The samples as they are, then without what is wrong with them. */
static imk_status screen(channel_work *work, size_t channel, imk_error *error)
{
    imk_identify_log *log = work->log;
    const size_t n = log->record.rows, size = imk_screen_workspace_size(n);
    imk_screen_settings settings = imki_screen_settings(log);
    settings.temperature = log->record.temperature;
    double *samples = imk_even_record_data(&log->record, channel);
    imk_screen *found = &log->screen[channel];
    const unsigned what = log->settings.take_out & ~(unsigned)IMK_SCREEN_SATURATED;
    size_t lost;
    void *workspace = imki_resize(&work->job->allocator, NULL, size);
    if (!workspace)
        return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    imk_status status = imk_screen_channel(&settings, n, samples, found, workspace, size, error);
    if (status == IMK_OK)
        status =
            imk_screen_apply(&settings, found, what, n, samples, &lost, workspace, size, error);
    imki_resize(&work->job->allocator, workspace, 0);
    return status;
}

static imk_status take_curve(channel_work *work, size_t channel)
{
    imk_identify_log *log = work->log;
    const size_t n = log->record.rows;
    const double *data = imk_even_record_data(&log->record, channel), dt = log->record.dt;
    imk_allan_settings settings = imk_allan_default();
    settings.confidence = log->settings.confidence;
    if (imk_even_record_finite(&log->record, channel) < n)
        return imki_allan_curve_with_gaps(&settings, n, data, dt, work->factor_count, work->factors,
                                          work->job, &log->curve[channel]);
    double *sums = imki_resize(&work->job->allocator, NULL, (n + 1) * sizeof *sums);
    if (!sums)
        return IMK_ERROR_MEMORY;
    imk_allan_sums(n, data, sums, NULL);
    const imk_status status =
        imki_allan_curve_compute(&settings, n, sums, dt, work->factor_count, work->factors, NULL,
                                 work->job, &log->curve[channel]);
    imki_resize(&work->job->allocator, sums, 0);
    return status;
}

static imk_status identify(channel_work *work, size_t channel, imk_error *error)
{
    imk_identify_log *log = work->log;
    const imk_allocator *allocator = &work->job->allocator;
    const size_t n = log->record.rows, size = imk_identify_workspace_size(n);
    void *workspace = imki_resize(allocator, NULL, size);
    imk_identify_settings settings;
    imk_status status = imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    if (workspace && imki_identify_settings(log, channel, allocator, &settings))
        status = screen(work, channel, error);
    if (status == IMK_OK)
        status = imk_identify_channel(&settings, n, imk_even_record_data(&log->record, channel),
                                      &log->result[channel], workspace, size, error);
    imki_resize(allocator, workspace, 0);
    if (status == IMK_OK)
        status = imki_identify_changes(log, channel, NULL, allocator, error);
    if (status != IMK_OK)
        return status;
    status = take_curve(work, channel);
    return status == IMK_OK ? status : imk_error_set(error, status, NULL, NULL, NULL);
}

static void identify_one(void *context, size_t channel)
{
    channel_work *work = context;
    imk_error *error = &work->error[channel];
    work->status[channel] = atomic_load(&work->cancelled)
                                ? imk_error_set(error, IMK_ERROR_CANCELLED, NULL, NULL, NULL)
                                : identify(work, channel, error);
    const size_t done = atomic_fetch_add(&work->done, 1) + 1;
    if (work->progress && !atomic_flag_test_and_set(&work->showing)) {
        if (!work->progress(work->job->progress_context, "identifying", "channels", done,
                            work->log->record.count))
            atomic_store(&work->cancelled, true);
        atomic_flag_clear(&work->showing);
    }
}

imk_status imki_identify_channels(imk_identify_log *log, const imk_job *job, imk_error *error)
{
    imk_job alone = *job;
    alone.executor = NULL;
    alone.progress = NULL;
    imki_arena scratch = {.allocator = job->allocator};
    channel_work *work = imki_arena_take(&scratch, sizeof *work);
    size_t count = 0, *factors = NULL;
    imk_status status = imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    if (work)
        factors = imki_allan_factors(IMK_ALLAN_OVERLAPPING, IMK_ALLAN_OCTAVE, log->record.rows,
                                     &job->allocator, &count);
    if (factors) {
        *work = (channel_work){.log = log,
                               .job = &alone,
                               .factors = factors,
                               .factor_count = count,
                               .progress = job->progress,
                               .showing = ATOMIC_FLAG_INIT};
        imk_execute(job->executor, log->record.count, identify_one, work);
        status = IMK_OK;
    }
    for (size_t c = 0; status == IMK_OK && c < log->record.count; c++)
        if (work->status[c] != IMK_OK)
            status = imki_identify_explain(log, c, work->status[c], &work->error[c], error);
    imki_resize(&job->allocator, factors, 0);
    imki_arena_free(&scratch);
    return status;
}
