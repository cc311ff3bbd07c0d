/* SPDX-License-Identifier: Apache-2.0 */
/* Findings and progress of a job. */
#ifndef IMUKI_JOB_INTERNAL_H
#define IMUKI_JOB_INTERNAL_H

#include "imukit/job.h"

/* Add a finding; beyond IMK_FINDINGS_MAX it is lost, but for a failure. `numbers` has `count`. */
void imki_find(imk_findings *findings, imk_finding_level level, const char *code, const char *name,
               size_t count, const double *numbers);

/* Does an inertial sensor work at this temperature [K]? Military ranges begin at -55 degC; sensors
 * for drill holes end at 150 to 200 degC. */
static inline bool imki_is_of_sensors(double temperature)
{
    return temperature > 273.15 - 100 && temperature < 273.15 + 200;
}

/* A warning if no sensor works at the temperature that is given [K]: most often it is in the other
 * unit. @return true if it was given */
bool imki_find_temperature(imk_findings *findings, double temperature);

/* A failure: adds it and fills the error, whose field is the name up to a tab. @return status */
imk_status imki_fail(imk_findings *findings, imk_error *error, imk_status status, const char *code,
                     const char *name, size_t count, const double *numbers);

/* What a sink returned: a failure is told. @return it */
imk_status imki_written(imk_findings *findings, imk_status status);

/* The numbers of a finding: IMKI_NUMBERS(rows, 100 * share) */
#define IMKI_NUMBERS(...)                                                                          \
    sizeof((const double[]){__VA_ARGS__}) / sizeof(double), (const double[])                       \
    {                                                                                              \
        __VA_ARGS__                                                                                \
    }

/* The job, or, of NULL, one of zeros. */
const imk_job *imki_job_of(const imk_job *job);

/* A place for the result, and settings from their _default function.
 * @param settings  begin with their cookie
 * @param origin    the function that makes them */
imk_status imki_check_call(const void *result, const void *settings, uint32_t cookie,
                           const char *origin, imk_error *error);

/* Zeroed memory of a result, where `status` is IMK_OK; else NULL.
 * @return NULL with the status, and the error where memory is exhausted */
void *imki_result_new(const imk_job *job, size_t size, imk_status *status, imk_error *error);

/* Tell of progress. @return IMK_ERROR_CANCELLED where the caller gives up */
imk_status imki_job_progress(const imk_job *job, const char *stage, const char *unit, uint64_t done,
                             uint64_t total, imk_error *error);

#endif
