/* SPDX-License-Identifier: Apache-2.0 */
/* Identifies a record: whole, or in one pass when it is long. */
#include "identify_log_internal.h"
#include "log_coherence_internal.h"

#include "jobs/allan/allan_curve_internal.h"
#include "jobs/arena_internal.h"
#include "jobs/job_internal.h"
#include "jobs/record/record_check_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const uint32_t settings_cookie = 0x49444531; /* "IDE1" */

imk_identify_log_settings imk_identify_log_default(void)
{
    return (imk_identify_log_settings){.cookie = settings_cookie,
                                       .gaps = IMK_GAPS_KEEP,
                                       .confidence = 0.95,
                                       .significance = 0.01,
                                       .take_out = IMK_SCREEN_ALL};
}

void imk_identify_log_free(imk_identify_log *result)
{
    if (!result)
        return;
    const imk_allocator allocator = result->record.log.allocator;
    for (size_t c = 0; c < IMK_LOG_COLUMNS_MAX; c++) {
        imk_allan_curve_free(&result->curve[c], &allocator);
        imki_resize(&allocator, result->summary[c], 0);
        imki_resize(&allocator, result->map[c], 0);
    }
    imk_even_record_free(&result->record);
    imki_resize(&allocator, result, 0);
}

void imk_identify_log_let_samples_go(imk_identify_log *result)
{
    imk_log *log = &result->record.log;
    for (size_t c = 0; c < IMK_LOG_COLUMNS_MAX; c++)
        log->data[c] = imki_resize(&log->allocator, log->data[c], 0);
    log->label = imki_resize(&log->allocator, log->label, 0);
    log->label_count = 0;
    result->record.temperature = NULL;
}

bool imki_identify_settings(imk_identify_log *log, size_t channel, const imk_allocator *allocator,
                            imk_identify_settings *settings)
{
    *settings = imk_identify_default();
    settings->dt = log->record.dt;
    settings->confidence = log->settings.confidence;
    settings->significance = log->settings.significance;
    if (!log->settings.summarise)
        return true;
    const size_t size = imk_spectral_summary_size();
    settings->summary = log->summary[channel] = imki_resize(allocator, NULL, size);
    if (settings->summary)
        memset(settings->summary, 0, size);
    return settings->summary != NULL;
}

imk_screen_settings imki_screen_settings(const imk_identify_log *log)
{
    imk_screen_settings settings = imk_screen_default();
    settings.dt = log->record.dt;
    settings.false_alarm /= (double)log->record.count;
    settings.significance /= (double)log->record.count;
    return settings;
}

/* Where the sensor rests behind a sample: up to the next stretch in which a channel was moved; the
 * sample itself, if it is in one. */
static size_t rest_behind(const imk_identify_log *log, size_t sample)
{
    size_t end = log->record.rows;
    for (size_t c = 0; c < log->record.count; c++) {
        const imk_screen *s = &log->screen[c];
        for (size_t k = 0; k < s->moved.runs; k++)
            if (s->move_end[k] > sample && s->move_first[k] < end)
                end = s->move_first[k] > sample ? s->move_first[k] : sample;
    }
    return end;
}

imk_identify_moves imk_identify_log_moves(const imk_identify_log *log)
{
    const double dt = log->record.dt;
    size_t first = SIZE_MAX, end = 0, still_first = 0, still_end = rest_behind(log, 0);
    for (size_t c = 0; c < log->record.count; c++) {
        const imk_screen *s = &log->screen[c];
        for (size_t k = 0; k < s->moved.runs; k++) {
            const size_t still = s->move_end[k], next = rest_behind(log, still);
            first = s->move_first[k] < first ? s->move_first[k] : first;
            end = still > end ? still : end;
            if (next - still > still_end - still_first) {
                still_first = still;
                still_end = next;
            }
        }
    }
    if (first == SIZE_MAX)
        return (imk_identify_moves){.moved = false};
    return (imk_identify_moves){.moved = true,
                                .first = (double)first * dt,
                                .end = (double)end * dt,
                                .still_first = ceil(10 * (double)still_first * dt) / 10,
                                .still_end = floor(10 * (double)still_end * dt) / 10};
}

/* What the screening saw in a channel that has no model. Codes of lost samples are many and far
 * off; a motion has noise, too, but no sum of terms describes it. */
static const char *why_no_model(const imk_screen *s, double numbers[3])
{
    const double far = 10, smooth = 0.3, normal = 0.2;
    if (s->outliers.count > 0 && s->largest_outlier > far * s->outlier_threshold) {
        numbers[0] = (double)s->outliers.count;
        numbers[1] = (double)s->n;
        numbers[2] = s->largest_outlier;
        return "no_model:outliers";
    }
    if (s->steps.count > 0) {
        numbers[0] = (double)s->steps.count;
        numbers[1] = fabs(s->largest_step);
        return "no_model:steps";
    }
    if (s->cycle_amplitude > smooth * s->deviation) {
        numbers[0] = s->cycle_amplitude;
        numbers[1] = s->cycle_period;
        return "no_model:cycle";
    }
    return s->noise > smooth * s->deviation && fabs(s->core - 1) < normal ? "no_model:motion"
                                                                          : "no_model:smooth";
}

static imk_status refuse_without_model(imk_identify_log *log, size_t channel, imk_error *error)
{
    const imk_log_column *column = imk_even_record_column(&log->record, channel);
    const double scale = column->unit.scale > 0 ? column->unit.scale : 1;
    double numbers[3] = {0};
    char name[sizeof log->findings.item[0].name];
    const char *code = why_no_model(&log->screen[channel], numbers);
    const int size = strcmp(code, "no_model:outliers") == 0 ? 2
                     : strcmp(code, "no_model:steps") == 0  ? 1
                                                            : 0;
    numbers[size] /= scale;
    snprintf(name, sizeof name, "%.60s\t%.30s", column->name, column->unit.text);
    return imki_fail(&log->findings, error, IMK_ERROR_NO_CONVERGENCE, code, name, 3, numbers);
}

static const double fewest_rows = 256; /* imk_identify_channel() */

imk_status imki_identify_explain(imk_identify_log *log, size_t channel, imk_status status,
                                 const imk_error *why, imk_error *error)
{
    const imk_even_record *record = &log->record;
    const char *name = imk_even_record_column(record, channel)->name;
    const double rows = (double)record->rows;
    if (status == IMK_ERROR_CONSTANT)
        return imki_fail(&log->findings, error, status, "constant_identify", name,
                         IMKI_NUMBERS(rows));
    /* A record taken block by block keeps no samples, and is long. */
    const bool kept = imk_even_record_data(record, channel) != NULL;
    const double finite = kept ? (double)imk_even_record_finite(record, channel) : rows;
    if (status == IMK_ERROR_TOO_SHORT)
        return imki_fail(&log->findings, error, status,
                         finite >= fewest_rows ? "too_few_changes"
                         : finite < rows       ? "too_few_values"
                                               : "too_few_to_identify",
                         name, IMKI_NUMBERS(finite, rows));
    const imk_identify_moves moves = imk_identify_log_moves(log);
    if (status == IMK_ERROR_NO_CONVERGENCE && moves.moved)
        return imki_fail(&log->findings, error, status, "moved", name,
                         IMKI_NUMBERS(moves.first, moves.end, moves.still_first, moves.still_end));
    if (status == IMK_ERROR_NO_CONVERGENCE)
        return refuse_without_model(log, channel, error);
    imk_error named = *why;
    if (!named.field[0])
        snprintf(named.field, sizeof named.field, "%s", name);
    if (error)
        *error = named;
    return status;
}

/* What the estimate allows for, and what moves no strength of a sensor at rest, is no warning here.
 */
static void allow_for(imk_findings *findings)
{
    static const char *const codes[] = {"missing", "not_finite", "unordered", "jitter"};
    for (size_t k = 0; k < findings->count; k++)
        for (size_t i = 0; i < sizeof codes / sizeof codes[0]; i++)
            if (strcmp(findings->item[k].code, codes[i]) == 0 &&
                findings->item[k].level == IMK_FINDING_WARNING)
                findings->item[k].level = IMK_FINDING_NOTE;
}

static imk_status tell_coherence(imk_identify_log *log, const imk_job *job, imk_error *error)
{
    const imk_even_record *record = &log->record;
    imki_arena scratch = {.allocator = job->allocator};
    imki_coherence *coherence = imki_arena_take(&scratch, sizeof *coherence);
    if (!coherence)
        return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    imki_coherence_start(coherence, record->count, record->column, record->log.column);
    imki_coherence_add(coherence, record->rows, record->log.data);
    imki_coherence_tell(coherence, record->log.column, &log->findings);
    imki_arena_free(&scratch);
    return IMK_OK;
}

static imk_status identify(imk_identify_log *log, const imk_record_source *source,
                           const imk_job *job, imk_error *error)
{
    bool taken = false;
    imk_status status = IMK_OK;
    if (source->rewind && source->progress && source->findings)
        status = imki_identify_long(log, source, job, &taken, error);
    if (status == IMK_OK && !taken)
        status = imk_even_record_load(source, log->settings.gaps, job, &log->record, &log->findings,
                                      error);
    if (status == IMK_OK && !taken)
        status = tell_coherence(log, job, error);
    if (status == IMK_OK && !taken)
        status = imki_identify_channels(log, job, error);
    if (status == IMK_OK && log->settings.from_allan)
        status = imki_identify_by_allan(log, job, error);
    log->screened = status == IMK_OK;
    for (size_t c = 0; log->screened && c < log->record.count; c++)
        imk_screen_adjust(&log->screen[c], log->settings.take_out, log->settings.confidence,
                          &log->result[c]);
    allow_for(&log->findings);
    return status;
}

imk_status imk_identify_log_run(const imk_record_source *source,
                                const imk_identify_log_settings *settings, const imk_job *job,
                                imk_identify_log **result, imk_error *error)
{
    imk_status status =
        imki_check_call(result, settings, settings_cookie, "imk_identify_log_default()", error);
    if (!result)
        return status;
    *result = NULL;
    job = imki_job_of(job);
    if (status == IMK_OK)
        status = imki_check_source(source, error);
    if (status == IMK_OK)
        status = imki_check_fraction("confidence", settings->confidence, error);
    imk_identify_log *made = imki_result_new(job, sizeof *made, &status, error);
    if (!made)
        return status;
    made->settings = *settings;
    *result = made;
    status = identify(made, source, job, error);
    made->record.log.allocator = job->allocator;
    made->duration = made->record.dt * (double)made->record.rows;
    return status;
}
