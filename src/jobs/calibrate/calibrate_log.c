/* SPDX-License-Identifier: Apache-2.0 */
/* The calibration as a whole: each log observed, all solved together, the model made. */
#include "calibrate_internal.h"

#include "jobs/job_internal.h"

#include <math.h>
#include <string.h>

static const uint32_t settings_cookie = 0x43414C31; /* "CAL1" */

imk_calibrate_log_settings imk_calibrate_log_default(void)
{
    const double none = (double)NAN;
    return (imk_calibrate_log_settings){.cookie = settings_cookie,
                                        .gravity = none,
                                        .placement = none,
                                        .minimum = none,
                                        .trim = none,
                                        .settle = none};
}

imk_status imk_calibrate_log_create(size_t count, const imk_calibrate_log_settings *settings,
                                    const imk_job *job, imk_calibrate_log **b, imk_error *error)
{
    const imk_job alone = {.memory = 0};
    imki_arena arena = {.allocator = (job ? job : &alone)->allocator};
    *b = NULL;
    if (settings->cookie != settings_cookie)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, "settings", NULL,
                             "imk_calibrate_log_default()");
    if (count == 0 || count > IMK_TEST_RECORDS_MAX)
        return imk_error_set(error, IMK_ERROR_RANGE, "count", NULL, NULL);
    imk_calibrate_log *made = imki_arena_take(&arena, sizeof *made);
    imk_calibrate_record *record = imki_arena_take(&arena, count * sizeof *record);
    imk_calibration *calibration = imki_arena_take(&arena, sizeof *calibration);
    imki_arena *memory = imki_arena_take(&arena, sizeof *memory);
    if (arena.failed) {
        imki_arena_free(&arena);
        return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    }
    imk_calibration_default(calibration);
    *made = (imk_calibrate_log){.settings = *settings,
                                .job = job ? *job : alone,
                                .count = count,
                                .record = record,
                                .calibration = calibration,
                                .memory = memory};
    *memory = arena;
    *b = made;
    return IMK_OK;
}

void imk_calibrate_log_free(imk_calibrate_log *b)
{
    if (!b)
        return;
    imki_resize(&b->job.allocator, b->calibration->observation, 0);
    imki_resize(&b->job.allocator, b->calibration->turn, 0);
    imki_arena arena = *b->memory;
    imki_arena_free(&arena);
}

imk_status imk_calibrate_log_run(imk_calibrate_log *b, imk_error *error)
{
    imk_status status = IMK_OK;
    b->failed = b->count;
    if (b->settings.repeatability)
        status = imki_compare_runs(b, error);
    else if (b->settings.closed_form)
        status = imki_closed_form(b, error);
    for (size_t k = 0; !b->runs && !b->ferraris && status == IMK_OK && k < b->count; k++) {
        b->failed = k;
        status = imki_job_progress(&b->job, "observing", "logs", k, b->count, error);
        if (status == IMK_OK)
            status = imki_observe(b, &b->record[k], error);
    }
    if (!b->runs && !b->ferraris && status == IMK_OK) {
        b->failed = b->count;
        status = imki_solve(b, error);
    }
    if (status == IMK_OK)
        imki_calibrate_model(b);
    return status;
}
