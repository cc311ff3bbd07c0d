/* SPDX-License-Identifier: Apache-2.0 */
/* The calibration as a whole: made from settings and procedures, its records loaded and observed,
 * all solved together, the model made. */
#include "calibrate_internal.h"

#include "jobs/job_internal.h"

/* ---- life ------------------------------------------------------------------------------------ */

static imk_calibrate_log *new_session(size_t count, const imk_job *job)
{
    imki_arena arena = {.allocator = job->allocator};
    imk_calibrate_log *made = imki_arena_take(&arena, sizeof *made);
    imk_calibrate_record *record = imki_arena_take(&arena, count * sizeof *record);
    imk_calibration *calibration = imki_arena_take(&arena, sizeof *calibration);
    imk_model *before = imki_arena_take(&arena, sizeof *before);
    imki_arena *memory = imki_arena_take(&arena, sizeof *memory);
    if (arena.failed) {
        imki_arena_free(&arena);
        return NULL;
    }
    *made = (imk_calibrate_log){.job = *job,
                                .count = count,
                                .failed = count,
                                .record = record,
                                .calibration = calibration,
                                .before = before,
                                .memory = memory};
    *memory = arena;
    return made;
}

imk_status imk_calibrate_log_create(size_t count, const imk_procedure *procedure,
                                    const imk_calibrate_log_settings *settings, const imk_job *job,
                                    imk_calibrate_log **b, imk_error *error)
{
    const uint32_t cookie = imk_calibrate_log_default().cookie;
    imk_status status = imki_check_call(b, settings, cookie, "imk_calibrate_log_default()", error);
    if (!b)
        return status;
    *b = NULL;
    if (status != IMK_OK)
        return status;
    if (!procedure)
        return imk_error_set(error, IMK_ERROR_ARGUMENT, "procedure", NULL, "one for each record");
    if (count == 0 || count > IMK_TEST_RECORDS_MAX)
        return imk_error_set(error, IMK_ERROR_RANGE, "count", NULL, NULL);
    imk_calibrate_log *made = new_session(count, imki_job_of(job));
    if (!made)
        return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    made->settings = *settings;
    status = imki_calibrate_set_up(made, procedure, error);
    if (status != IMK_OK)
        imk_calibrate_log_free(made);
    else
        *b = made;
    return status;
}

void imk_calibrate_log_free(imk_calibrate_log *b)
{
    if (!b)
        return;
    for (size_t k = 0; k < b->count; k++)
        imk_calibrate_record_free(&b->record[k]);
    imki_resize(&b->job.allocator, b->calibration->observation, 0);
    imki_resize(&b->job.allocator, b->calibration->turn, 0);
    imki_arena arena = *b->memory;
    imki_arena_free(&arena);
}

/* ---- work ------------------------------------------------------------------------------------ */

imk_status imk_calibrate_log_load(imk_calibrate_log *b, size_t index, const char *name,
                                  const imk_record_source *source, imk_error *error)
{
    if (index >= b->count)
        return imk_error_set(error, IMK_ERROR_RANGE, "index", NULL, NULL);
    b->failed = index;
    return imk_calibrate_record_load(&b->settings, name, source, &b->job, &b->record[index], error);
}

/* Observe each record, and solve all of them together. */
static imk_status calibrate(imk_calibrate_log *b, imk_error *error)
{
    imk_status status = IMK_OK;
    bool others = false; /* than magnetometers */
    for (size_t k = 0; status == IMK_OK && k < b->count; k++) {
        b->failed = k;
        status = imki_job_progress(&b->job, "observing", "logs", k, b->count, error);
        if (status != IMK_OK || b->record[k].procedure == IMK_PROCEDURE_MAGNETOMETER)
            continue;
        others = true;
        status = imki_observe(b, &b->record[k], error);
    }
    if (status != IMK_OK)
        return status;
    b->failed = b->count;
    status = others ? imki_solve(b, error) : IMK_OK;
    return status == IMK_OK ? imki_calibrate_magnetometer(b, error) : status;
}

/* @param error  not NULL: observing looks at it */
static imk_status run(imk_calibrate_log *b, imk_error *error)
{
    for (b->failed = 0; b->failed < b->count; b->failed++)
        if (b->record[b->failed].record.count == 0)
            return imk_error_set(error, IMK_ERROR_EMPTY, "record", NULL,
                                 "imk_calibrate_log_load()");
    imk_status status = imki_know_before(b, error);
    if (status == IMK_OK && b->settings.estimate)
        status = imki_free_terms(b, error);
    if (status != IMK_OK)
        return status;
    b->failed = b->count;
    status = b->settings.repeatability ? imki_compare_runs(b, error)
             : b->settings.closed_form ? imki_closed_form(b, error)
                                       : calibrate(b, error);
    if (status == IMK_OK)
        imki_calibrate_model(b);
    return status;
}

imk_status imk_calibrate_log_run(imk_calibrate_log *b, imk_error *error)
{
    imk_error own;
    return run(b, error ? error : &own);
}

imk_status imk_calibrate_logs(size_t count, const imk_calibrate_input *input,
                              const imk_calibrate_log_settings *settings, const imk_job *job,
                              imk_calibrate_log **session, imk_error *error)
{
    imk_procedure procedure[IMK_TEST_RECORDS_MAX] = {IMK_PROCEDURE_MULTIPOSITION};
    for (size_t k = 0; input && k < count && k < IMK_TEST_RECORDS_MAX; k++)
        procedure[k] = input[k].procedure;
    imk_status status =
        imk_calibrate_log_create(count, input ? procedure : NULL, settings, job, session, error);
    for (size_t k = 0; status == IMK_OK && k < count; k++)
        status = imk_calibrate_log_load(*session, k, input[k].name, input[k].source, error);
    return status == IMK_OK ? imk_calibrate_log_run(*session, error) : status;
}
