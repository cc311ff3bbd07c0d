/* SPDX-License-Identifier: Apache-2.0 */
/* An evaluation without channels: its settings, its beginning and its end. */
#include "evaluate_job_internal.h"

#include "base/refuse_internal.h"

#include <math.h>

static const uint32_t settings_cookie = 0x45564131; /* "EVA1" */

imk_evaluate_log_settings imk_evaluate_log_default(void)
{
    const double none = (double)NAN;
    return (imk_evaluate_log_settings){.cookie = settings_cookie,
                                       .confidence = 0.95,
                                       .minimum = none,
                                       .trim = none,
                                       .settle = none};
}

/* NaN: the default of the procedures. */
static imk_status check_times(const imk_evaluate_log_settings *s, imk_error *error)
{
    if (s->minimum <= 0)
        return imki_refuse(error, IMK_ERROR_RANGE, "minimum", s->minimum, 0, "a time above 0");
    if (s->trim < 0)
        return imki_refuse(error, IMK_ERROR_RANGE, "trim", s->trim, 0, "0 or more seconds");
    if (s->settle < 0)
        return imki_refuse(error, IMK_ERROR_RANGE, "settle", s->settle, 0, "0 or more seconds");
    return IMK_OK;
}

imk_status imk_evaluate_log_create(const imk_evaluate_log_settings *settings, const imk_job *job,
                                   imk_evaluate_log **result, imk_error *error)
{
    imki_arena arena = {.allocator = imki_job_of(job)->allocator};
    *result = NULL;
    if (settings->cookie != settings_cookie)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, "settings", NULL,
                             "imk_evaluate_log_default()");
    const imk_status status = check_times(settings, error);
    if (status != IMK_OK)
        return status;
    imk_evaluate_log *made = imki_arena_take(&arena, sizeof *made);
    imki_arena *memory = imki_arena_take(&arena, sizeof *memory);
    if (arena.failed) {
        imki_arena_free(&arena);
        return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    }
    *memory = arena;
    made->settings = *settings;
    made->memory = memory;
    *result = made;
    return IMK_OK;
}

void imk_evaluate_log_free(imk_evaluate_log *result)
{
    if (result) {
        imki_arena memory = *(imki_arena *)result->memory;
        imki_arena_free(&memory);
    }
}
