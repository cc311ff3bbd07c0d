/* SPDX-License-Identifier: Apache-2.0 */
/* Allan deviations of a record, channel by channel. Where samples are missing, the overlapping
 * deviation is taken of what is there; the other statistics need every sample. */
#include "allan_curve_internal.h"

#include "base/refuse_internal.h"
#include "jobs/arena_internal.h"
#include "jobs/job_internal.h"
#include "jobs/record/record_check_internal.h"

#include <math.h>

static const uint32_t settings_cookie = 0x414C4C31; /* "ALL1" */

imk_allan_log_settings imk_allan_log_default(void)
{
    return (imk_allan_log_settings){.cookie = settings_cookie,
                                    .gaps = IMK_GAPS_KEEP,
                                    .statistic_count = 1,
                                    .statistic = {IMK_ALLAN_OVERLAPPING},
                                    .confidence = 0.95,
                                    .grid = IMK_ALLAN_OCTAVE};
}

void imk_allan_log_free(imk_allan_log *result)
{
    if (!result)
        return;
    const imk_allocator allocator = result->record.log.allocator;
    for (size_t c = 0; c < IMK_LOG_COLUMNS_MAX; c++)
        for (size_t k = 0; k < IMK_ALLAN_STATISTICS; k++)
            imk_allan_curve_free(&result->curve[c][k], &allocator);
    imk_even_record_free(&result->record);
    imki_resize(&allocator, result, 0);
}

/* A column that never changes has no noise to analyse: almost always a wrong column. */
static imk_status check_varies(imk_allan_log *a, size_t channel, imk_error *error)
{
    const double *data = imk_even_record_data(&a->record, channel);
    const char *name = imk_even_record_column(&a->record, channel)->name;
    const size_t rows = a->record.rows;
    size_t first = 0;
    while (first < rows && !isfinite(data[first]))
        first++;
    if (first == rows)
        return imki_fail(&a->findings, error, IMK_ERROR_EMPTY, "no_value", name,
                         IMKI_NUMBERS((double)rows));
    for (size_t i = first; i < rows; i++)
        if (data[i] != data[first] && isfinite(data[i]))
            return IMK_OK;
    return imki_fail(&a->findings, error, IMK_ERROR_CONSTANT, "constant", name,
                     IMKI_NUMBERS((double)rows));
}

/* Factors of a statistic at the listed times: those in its range. With one statistic a time outside
 * is an error. */
static imk_status factors_of_times(imk_allan_log *a, imk_allan_statistic statistic, size_t n,
                                   size_t *count, size_t *factors, imk_error *error)
{
    const imk_allan_log_settings *s = &a->settings;
    size_t lowest, highest, step;
    imk_allan_range(statistic, n, &lowest, &highest, &step);
    const double dt = a->record.dt, unit = dt * (double)step * imk_allan_averaging(statistic, 1);
    *count = 0;
    for (size_t i = 0; i < s->time_count; i++) {
        const double place = floor(s->times[i] / unit + 0.5);
        const bool inside =
            place >= 1 && place <= (double)(highest / step) && (size_t)place * step >= lowest;
        if (!inside && s->statistic_count == 1)
            return imki_fail(&a->findings, error, IMK_ERROR_RANGE, "averaging_time", "",
                             IMKI_NUMBERS(s->times[i], dt * imk_allan_averaging(statistic, lowest),
                                          dt * imk_allan_averaging(statistic, highest)));
        if (inside && (*count == 0 || (size_t)place * step > factors[*count - 1]))
            factors[(*count)++] = (size_t)place * step;
    }
    return IMK_OK;
}

/* Averaging factors of one statistic, from the allocator. */
static imk_status choose_factors(imk_allan_log *a, imk_allan_statistic statistic, size_t n,
                                 const imk_allocator *allocator, size_t **factors, size_t *count,
                                 imk_error *error)
{
    const imk_allan_log_settings *s = &a->settings;
    *factors = s->time_count > 0
                   ? imki_resize(allocator, NULL, (s->time_count + 1) * sizeof **factors)
                   : imki_allan_factors(statistic, s->grid, n, allocator, count);
    if (!*factors)
        return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    return s->time_count > 0 ? factors_of_times(a, statistic, n, count, *factors, error) : IMK_OK;
}

static imk_status compute_curve(imk_allan_log *a, size_t channel, size_t k, size_t n, bool missing,
                                const imk_job *job, imk_error *error)
{
    const imk_allan_log_settings *s = &a->settings;
    const char *name = imk_even_record_column(&a->record, channel)->name;
    const double *data = imk_even_record_data(&a->record, channel), dt = a->record.dt;
    imk_allan_settings settings = imk_allan_default();
    settings.statistic = s->statistic[k];
    settings.confidence = s->confidence;
    settings.greenhall_riley = s->greenhall_riley;
    settings.bias = s->bias;
    size_t *factors, count = 0;
    imk_status status =
        choose_factors(a, settings.statistic, n, &job->allocator, &factors, &count, error);
    const bool chosen = status == IMK_OK;
    if (chosen && count == 0 && s->statistic_count == 1)
        status = IMK_ERROR_TOO_SHORT;
    else if (chosen && count > 0 && missing)
        status = imki_allan_curve_with_gaps(&settings, n, data, dt, count, factors, job,
                                            &a->curve[channel][k]);
    else if (chosen && count > 0)
        status = imki_allan_curve_compute(&settings, n, data, dt, count, factors, name, job,
                                          &a->curve[channel][k]);
    imki_resize(&job->allocator, factors, 0);
    if (chosen && status != IMK_OK)
        return imki_fail(&a->findings, error, status, "statistic_failed", name,
                         IMKI_NUMBERS(settings.statistic, status));
    return status;
}

/* The record as running sums, in place of the data. n is the number of rates. */
static void make_sums(const imk_allan_log *a, size_t channel, size_t n, const imk_job *job)
{
    double *data = imk_even_record_data(&a->record, channel);
    if (!a->settings.phase)
        imk_allan_sums(n, data, data, job->executor);
    else
        for (size_t i = 0; i <= n; i++)
            data[i] /= a->record.dt;
}

static imk_status compute_channel(imk_allan_log *a, size_t channel, size_t n, const imk_job *job,
                                  imk_error *error)
{
    const imk_allan_log_settings *s = &a->settings;
    const bool missing = imk_even_record_finite(&a->record, channel) < a->record.rows;
    imk_status status = IMK_OK;
    if (missing && (s->phase || s->statistic_count > 1 || s->statistic[0] != IMK_ALLAN_OVERLAPPING))
        return imki_fail(&a->findings, error, IMK_ERROR_GAP, "statistic_needs_all",
                         imk_even_record_column(&a->record, channel)->name, 0, NULL);
    if (!missing)
        make_sums(a, channel, n, job);
    for (size_t k = 0; status == IMK_OK && k < s->statistic_count; k++)
        status = compute_curve(a, channel, k, n, missing, job, error);
    return status;
}

static imk_status compute(imk_allan_log *a, const imk_job *job, imk_error *error)
{
    const imk_even_record *record = &a->record;
    const size_t n = a->settings.phase ? record->rows - 1 : record->rows;
    imk_status status = IMK_OK;
    for (size_t c = 0; status == IMK_OK && c < record->count; c++)
        status = check_varies(a, c, error);
    if (status == IMK_OK && n < 3)
        status = imki_fail(&a->findings, error, IMK_ERROR_TOO_SHORT, "too_few_for_allan", NULL,
                           IMKI_NUMBERS((double)record->rows));
    for (size_t c = 0; status == IMK_OK && c < record->count; c++)
        status = compute_channel(a, c, n, job, error);
    return status;
}

static imk_status check_lists(const imk_allan_log_settings *s, imk_error *error)
{
    if (s->statistic_count > IMK_ALLAN_STATISTICS)
        return imki_refuse(error, IMK_ERROR_RANGE, "statistic_count", (double)s->statistic_count,
                           IMK_ALLAN_STATISTICS, NULL);
    if (s->time_count > 0 && !s->times)
        return imk_error_set(error, IMK_ERROR_ARGUMENT, "times", NULL, "an array");
    return IMK_OK;
}

imk_status imk_allan_log_run(const imk_record_source *source,
                             const imk_allan_log_settings *settings, const imk_job *job,
                             imk_allan_log **result, imk_error *error)
{
    imk_status status =
        imki_check_call(result, settings, settings_cookie, "imk_allan_log_default()", error);
    if (!result)
        return status;
    *result = NULL;
    job = imki_job_of(job);
    if (status == IMK_OK)
        status = imki_check_fraction("confidence", settings->confidence, error);
    if (status == IMK_OK)
        status = check_lists(settings, error);
    imk_allan_log *made = imki_result_new(job, sizeof *made, &status, error);
    if (!made)
        return status;
    made->settings = *settings;
    *result = made;
    status =
        imk_even_record_load(source, settings->gaps, job, &made->record, &made->findings, error);
    made->record.log.allocator = job->allocator;
    return status == IMK_OK ? compute(made, job, error) : status;
}
