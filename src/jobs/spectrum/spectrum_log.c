/* SPDX-License-Identifier: Apache-2.0 */
/* Spectra of a record, channel by channel: densities, lines, and the noise parameters they show. */
#include "imukit/spectrum_log.h"

#include "base/refuse_internal.h"
#include "imukit/channel_units.h"
#include "jobs/arena_internal.h"
#include "jobs/job_internal.h"
#include "jobs/record/record_check_internal.h"

#include <math.h>

static const uint32_t settings_cookie = 0x53504531; /* "SPE1" */

imk_spectrum_log_settings imk_spectrum_log_default(void)
{
    return (imk_spectrum_log_settings){
        .cookie = settings_cookie, .confidence = 0.95, .false_alarm = 1e-3};
}

void imk_spectrum_log_free(imk_spectrum_log *result)
{
    if (!result)
        return;
    const imk_allocator allocator = result->record.log.allocator;
    for (size_t c = 0; c < IMK_LOG_COLUMNS_MAX; c++) {
        imki_resize(&allocator, result->channel[c].memory, 0);
        imki_resize(&allocator, result->channel[c].fine, 0);
    }
    imk_even_record_free(&result->record);
    imki_resize(&allocator, result, 0);
}

typedef struct spectrum_work {
    imk_spectrum_log *log;
    const imk_allocator *allocator;
    imk_status status[IMK_LOG_COLUMNS_MAX];
    imk_error error[IMK_LOG_COLUMNS_MAX];
} spectrum_work;

static imk_spectrum_settings settings_of(const imk_spectrum_log *log)
{
    const imk_spectrum_log_settings *s = &log->settings;
    imk_spectrum_settings settings = imk_spectrum_default();
    settings.method = s->method;
    settings.window = s->window;
    settings.overlap = s->window == 0 ? 0.5 : 0.66; /* narrower windows use less of a segment */
    settings.dt = log->record.dt;
    settings.resolution = s->resolution;
    settings.trend = s->trend;
    return settings;
}

/* An estimate with its arrays in `*memory`, from the allocator. */
static imk_status estimate(const imk_spectrum_settings *settings, size_t n, const double *samples,
                           const imk_allocator *allocator, imk_spectrum *spectrum, double **memory,
                           imk_error *error)
{
    const size_t count = imk_spectrum_count(settings, n);
    const size_t size = imk_spectrum_workspace_size(settings, n);
    *memory = imki_resize(allocator, NULL, (3 * count + 1) * sizeof **memory);
    void *workspace = imki_resize(allocator, NULL, size + 1);
    imk_status status = imk_error_set(error, IMK_ERROR_MEMORY, "", "", "");
    if (*memory && workspace)
        status = imk_spectrum_estimate(settings, n, samples, spectrum, *memory, *memory + count,
                                       *memory + 2 * count, workspace, size, error);
    imki_resize(allocator, workspace, 0);
    return status;
}

static imk_status find_lines(const imk_spectrum_log *log, imk_channel_spectrum *f,
                             const double *samples, const imk_allocator *allocator)
{
    const size_t rows = log->record.rows;
    const size_t size = imk_spectrum_lines_workspace_size(&f->spectrum, rows);
    void *workspace = imki_resize(allocator, NULL, size);
    if (!workspace)
        return IMK_ERROR_MEMORY;
    const imk_status status =
        imk_spectrum_lines(&f->spectrum, rows, samples, log->settings.false_alarm,
                           IMK_SPECTRUM_LINES_MAX, f->line, &f->line_count, workspace, size);
    imki_resize(allocator, workspace, 0);
    return status;
}

static imk_status make_bands(const imk_spectrum_log *log, imk_channel_spectrum *f,
                             const imk_allocator *allocator)
{
    enum { DECADES = 12 };
    const size_t fine = IMK_SPECTRUM_FINE * DECADES, coarse = IMK_SPECTRUM_COARSE * DECADES;
    const double confidence = log->settings.confidence;
    f->fine = imki_resize(allocator, NULL, (fine + coarse) * sizeof *f->fine);
    if (!f->fine)
        return IMK_ERROR_MEMORY;
    f->coarse = f->fine + fine;
    f->fine_count =
        imk_spectrum_bands(&f->spectrum, IMK_SPECTRUM_FINE, confidence, 0, NULL, fine, f->fine);
    f->coarse_count = imk_spectrum_bands(&f->spectrum, IMK_SPECTRUM_COARSE, confidence,
                                         f->line_count, f->line, coarse, f->coarse);
    return IMK_OK;
}

/* The parameters need the slow end more than the lines need averages: seven Hann segments, of at
 * most 2^22 samples. Lines keep their frequencies and get the bins of that spectrum. */
static void fit_parameters(const imk_spectrum_log *log, imk_channel_spectrum *f,
                           const double *samples, const imk_allocator *allocator)
{
    enum { SEGMENT_MAX = 1 << 22, PARTS = 4 };
    const imk_spectrum_log_settings *s = &log->settings;
    const size_t n = log->record.rows;
    const double length = fmin((double)n / PARTS, SEGMENT_MAX);
    imk_spectrum_settings settings = imk_spectrum_default();
    imk_spectrum fine;
    imk_spectrum_line line[IMK_SPECTRUM_LINES_MAX];
    double *memory = NULL;
    settings.dt = log->record.dt;
    settings.trend = s->trend;
    settings.resolution = 1.5 / (length * settings.dt);
    f->fit_status = estimate(&settings, n, samples, allocator, &fine, &memory, NULL);
    for (size_t i = 0; f->fit_status == IMK_OK && i < f->line_count; i++) {
        const double ratio = f->spectrum.step / fine.step;
        line[i] = f->line[i];
        line[i].first = (size_t)fmax(1, floor((double)line[i].first * ratio));
        line[i].last = (size_t)ceil((double)line[i].last * ratio);
    }
    if (f->fit_status == IMK_OK)
        f->fit_status = imk_spectrum_fit(&fine, f->line_count, line, s->from, s->to, s->confidence,
                                         0.01, &f->fit);
    imki_resize(allocator, memory, 0);
}

static void analyse(void *context, size_t channel)
{
    spectrum_work *work = context;
    imk_spectrum_log *log = work->log;
    imk_channel_spectrum *f = &log->channel[channel];
    const double *samples = imk_even_record_data(&log->record, channel);
    const imk_spectrum_settings settings = settings_of(log);
    imk_status status = estimate(&settings, log->record.rows, samples, work->allocator,
                                 &f->spectrum, &f->memory, &work->error[channel]);
    if (status == IMK_OK)
        status = find_lines(log, f, samples, work->allocator);
    if (status == IMK_OK)
        status = make_bands(log, f, work->allocator);
    if (status == IMK_OK)
        fit_parameters(log, f, samples, work->allocator);
    if (f->fit_status == IMK_ERROR_MEMORY) /* says nothing about the record */
        status = f->fit_status;
    work->status[channel] = status;
}

/* Why a channel could not be analysed. */
static imk_status explain(imk_spectrum_log *log, size_t channel, imk_status status,
                          const imk_error *why, imk_error *error)
{
    const char *name = imk_even_record_column(&log->record, channel)->name;
    const double rows = (double)log->record.rows, span = rows * log->record.dt;
    const bool welch = log->settings.method == 0;
    imk_findings *findings = &log->findings;
    if (status == IMK_ERROR_CONSTANT)
        return imki_fail(findings, error, status, "constant", name, IMKI_NUMBERS(rows));
    if (status == IMK_ERROR_TOO_SHORT)
        return imki_fail(findings, error, status, "too_few_for_spectrum", name, IMKI_NUMBERS(rows));
    if (status == IMK_ERROR_GAP)
        return imki_fail(findings, error, status, "segments_missing", name, 0, NULL);
    if (status == IMK_ERROR_RANGE && log->settings.resolution > 0) {
        imki_fail(findings, error, status, "resolution", why->found,
                  IMKI_NUMBERS(log->settings.resolution, span, 1 / log->record.dt,
                               (welch ? 1.5 : 8) / span, (welch ? 0.09 : 0.5) / log->record.dt));
        return imk_error_set(error, status, "resolution", why->found, NULL);
    }
    return imki_fail(findings, error, status, "column_failed", name, IMKI_NUMBERS(status));
}

static void warn(imk_spectrum_log *log, size_t channel)
{
    const imk_channel_spectrum *f = &log->channel[channel];
    const char *name = imk_even_record_column(&log->record, channel)->name;
    const double left_out = (double)f->spectrum.left_out;
    imk_findings *findings = &log->findings;
    if (left_out > 0)
        imki_find(findings, IMK_FINDING_WARNING, "gaps", name,
                  IMKI_NUMBERS(left_out, left_out + (double)f->spectrum.segments));
    if (f->line_count == IMK_SPECTRUM_LINES_MAX)
        imki_find(findings, IMK_FINDING_WARNING, "lines", name,
                  IMKI_NUMBERS(IMK_SPECTRUM_LINES_MAX));
    if (f->fit_status != IMK_OK)
        imki_find(findings, IMK_FINDING_WARNING, "fit", name, IMKI_NUMBERS(f->fit_status));
    else if (f->fit.misfit > 2)
        imki_find(findings, IMK_FINDING_WARNING, "misfit", name,
                  IMKI_NUMBERS(f->fit.misfit, f->fit.worst_frequency, f->fit.worst_ratio));
}

static imk_status compute(imk_spectrum_log *log, const imk_job *job, imk_error *error)
{
    const double half_rate = 0.5 / log->record.dt;
    imk_status status = IMK_OK;
    if (!(log->settings.from < half_rate))
        return imki_refuse(error, IMK_ERROR_RANGE, "from", log->settings.from, half_rate,
                           "below half the sampling rate");
    imki_arena scratch = {.allocator = job->allocator};
    spectrum_work *work = imki_arena_take(&scratch, sizeof *work);
    if (!work)
        return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    work->log = log;
    work->allocator = &job->allocator;
    imk_execute(job->executor, log->record.count, analyse, work);
    for (size_t c = 0; status == IMK_OK && c < log->record.count; c++)
        if (work->status[c] != IMK_OK)
            status = explain(log, c, work->status[c], &work->error[c], error);
    for (size_t c = 0; status == IMK_OK && c < log->record.count; c++)
        warn(log, c);
    imki_arena_free(&scratch);
    return status;
}

imk_spectrum_band imk_spectrum_log_band(const imk_spectrum_log *spectrum, size_t channel,
                                        const imk_spectrum_band *band)
{
    const imk_log_column *column = imk_even_record_column(&spectrum->record, channel);
    const double unit = imk_channel_plain_unit(column).scale;
    const double scale = (spectrum->settings.one_sided ? 2 : 1) / unit / unit;
    imk_spectrum_band shown = *band;
    shown.density *= scale;
    shown.lower *= scale;
    shown.upper *= scale;
    return shown;
}

static imk_status check(const imk_spectrum_log_settings *s, imk_error *error)
{
    imk_status status = imki_check_fraction("confidence", s->confidence, error);
    if (status == IMK_OK)
        status = imki_check_fraction("false_alarm", s->false_alarm, error);
    if (status != IMK_OK)
        return status;
    if (!(s->resolution >= 0))
        return imki_refuse(error, IMK_ERROR_RANGE, "resolution", s->resolution, 0, "at least 0 Hz");
    if (!(s->from >= 0))
        return imki_refuse(error, IMK_ERROR_RANGE, "from", s->from, 0, "at least 0 Hz");
    if (s->to != 0 && !(s->to > s->from))
        return imki_refuse(error, IMK_ERROR_RANGE, "to", s->to, s->from,
                           "a frequency above the lowest one of the fit, or 0 Hz for the highest");
    return IMK_OK;
}

imk_status imk_spectrum_log_run(const imk_record_source *source,
                                const imk_spectrum_log_settings *settings, const imk_job *job,
                                imk_spectrum_log **result, imk_error *error)
{
    imk_status status =
        imki_check_call(result, settings, settings_cookie, "imk_spectrum_log_default()", error);
    if (!result)
        return status;
    *result = NULL;
    job = imki_job_of(job);
    if (status == IMK_OK)
        status = check(settings, error);
    imk_spectrum_log *made = imki_result_new(job, sizeof *made, &status, error);
    if (!made)
        return status;
    made->settings = *settings;
    *result = made;
    status =
        imk_even_record_load(source, settings->gaps, job, &made->record, &made->findings, error);
    made->record.log.allocator = job->allocator;
    return status == IMK_OK ? compute(made, job, error) : status;
}
