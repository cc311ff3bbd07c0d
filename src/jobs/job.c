/* SPDX-License-Identifier: Apache-2.0 */
/* What all jobs do: tell what they find, and how far they are. */
#include "arena_internal.h"
#include "job_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const imk_job *imki_job_of(const imk_job *job)
{
    static const imk_job alone = {.memory = 0};
    return job ? job : &alone;
}

imk_status imki_check_call(const void *result, const void *settings, uint32_t cookie,
                           const char *origin, imk_error *error)
{
    if (!result)
        return imk_error_set(error, IMK_ERROR_ARGUMENT, "result", NULL, "a place for the result");
    if (!settings)
        return imk_error_set(error, IMK_ERROR_ARGUMENT, "settings", NULL, origin);
    if (*(const uint32_t *)settings != cookie)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, "settings", NULL, origin);
    return IMK_OK;
}

void *imki_result_new(const imk_job *job, size_t size, imk_status *status, imk_error *error)
{
    if (*status != IMK_OK)
        return NULL;
    void *made = imki_resize(&job->allocator, NULL, size);
    if (!made)
        *status = imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    return made ? memset(made, 0, size) : NULL;
}

void imki_find(imk_findings *findings, imk_finding_level level, const char *code, const char *name,
               size_t count, const double *numbers)
{
    if (findings->count == IMK_FINDINGS_MAX) {
        if (level != IMK_FINDING_FAILURE)
            return;
        findings->count--;
    }
    imk_finding *made = &findings->item[findings->count++];
    *made = (imk_finding){.code = code, .level = level};
    snprintf(made->name, sizeof made->name, "%s", name ? name : "");
    for (size_t i = 0; i < count && i < IMK_FINDING_NUMBERS; i++)
        made->number[i] = numbers[i];
}

bool imki_find_temperature(imk_findings *findings, double temperature)
{
    const double zero = 273.15;
    if (isnan(temperature) || imki_is_of_sensors(temperature))
        return false;
    imki_find(findings, IMK_FINDING_WARNING, "temperature_of_no_sensor", NULL,
              IMKI_NUMBERS(temperature, temperature - zero, imki_is_of_sensors(temperature + zero),
                           imki_is_of_sensors(temperature - zero)));
    return true;
}

imk_status imki_fail(imk_findings *findings, imk_error *error, imk_status status, const char *code,
                     const char *name, size_t count, const double *numbers)
{
    char field[sizeof error->field];
    imki_find(findings, IMK_FINDING_FAILURE, code, name, count, numbers);
    snprintf(field, sizeof field, "%s", name ? name : "");
    field[strcspn(field, "\t")] = '\0';
    return imk_error_set(error, status, field, NULL, NULL);
}

imk_status imki_written(imk_findings *findings, imk_status status)
{
    if (status != IMK_OK)
        imki_find(findings, IMK_FINDING_FAILURE, "not_written", NULL, IMKI_NUMBERS(status));
    return status;
}

const imk_finding *imk_findings_failure(const imk_findings *findings)
{
    for (size_t i = findings->count; i-- > 0;)
        if (findings->item[i].level == IMK_FINDING_FAILURE)
            return &findings->item[i];
    return NULL;
}

imk_status imki_job_progress(const imk_job *job, const char *stage, const char *unit, uint64_t done,
                             uint64_t total, imk_error *error)
{
    if (!job->progress || job->progress(job->progress_context, stage, unit, done, total))
        return IMK_OK;
    return imk_error_set(error, IMK_ERROR_CANCELLED, NULL, NULL, NULL);
}
