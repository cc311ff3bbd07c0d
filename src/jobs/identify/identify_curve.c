/* SPDX-License-Identifier: Apache-2.0 */
/* A noise model from a table of Allan deviations. */
#include "imukit/identify_curve.h"

#include "identify_log_internal.h"

#include "base/refuse_internal.h"
#include "jobs/allan/allan_curve_internal.h"
#include "jobs/arena_internal.h"
#include "jobs/job_internal.h"
#include "jobs/record/even_record_internal.h"
#include "jobs/record/record_check_internal.h"

#include "imukit/distributions.h"
#include "imukit/samples.h"

#include <math.h>
#include <string.h>

static const uint32_t settings_cookie = 0x49444331; /* "IDC1" */

/* Neighbours closer than this ratio hold next to nothing new, and make the covariance singular. */
static const double least_ratio = 1.1;

/* Below this chance the terms do not explain the curve. */
static const double misfit_chance = 0.001;

/* Errors of each deviation that are tried where none is stated, from none to those of a sketch, and
 * the chance at which one is enough. */
static const double tolerances[] = {0, 0.005, 0.01, 0.02, 0.03, 0.05, 0.07, 0.1, 0.15, 0.2};
static const double tolerance_chance = 0.05;

/* A curve that needs more than this was read badly, or its record holds other terms. */
static const double tolerance_told = 0.05;

/* The tau in the table that are used. */
typedef struct used_rows {
    size_t count, row[IMK_ALLAN_FIT_FACTORS_MAX], factor[IMK_ALLAN_FIT_FACTORS_MAX];
    double tau[IMK_ALLAN_FIT_FACTORS_MAX];
} used_rows;

imk_identify_curve_settings imk_identify_curve_default(void)
{
    return (imk_identify_curve_settings){.cookie = settings_cookie,
                                         .confidence = 0.95,
                                         .significance = 0.01,
                                         .tolerance = (double)NAN};
}

static int find_column(const imk_log *log, const char *name)
{
    for (size_t c = 0; c < log->column_count; c++)
        if (strcmp(log->column[c].name, name) == 0)
            return (int)c;
    return -1;
}

/* Rows whose tau is a multiple of the sample interval, within 1 %, in steps of at least a ratio. */
static void choose_rows(const imk_identify_curve_settings *s, const double *tau, size_t rows,
                        used_rows *used)
{
    const double n = floor(s->duration * s->rate + 0.5);
    for (double ratio = least_ratio;; ratio *= 1.1) {
        double last = 0;
        used->count = 0;
        for (size_t k = 0; k < rows; k++) {
            const double m = floor(tau[k] * s->rate + 0.5);
            if (!(m >= 1) || 2 * m > n || fabs(m / (tau[k] * s->rate) - 1) > 0.01 ||
                (used->count > 0 && m < ratio * last))
                continue;
            last = m;
            if (used->count < IMK_ALLAN_FIT_FACTORS_MAX) {
                used->row[used->count] = k;
                used->factor[used->count] = (size_t)m;
                used->tau[used->count] = m / s->rate;
            }
            used->count++;
        }
        if (used->count <= IMK_ALLAN_FIT_FACTORS_MAX)
            return;
    }
}

/* The channels beside tau, and the rows. */
static imk_status choose(imk_identify_log *log, const imk_identify_curve_settings *s,
                         used_rows *used, imk_error *error)
{
    imk_even_record *record = &log->record;
    imk_even_record_choose(record);
    int tau = find_column(&record->log, "tau");
    if (tau < 0)
        tau = find_column(&record->log, "tau_s");
    if (find_column(&record->log, "edf") >= 0)
        return imki_fail(&log->findings, error, IMK_ERROR_FORMAT, "long_table", NULL, 0, NULL);
    size_t kept = 0;
    for (size_t c = 0; c < record->count; c++)
        if (record->column[c] != tau)
            record->column[kept++] = record->column[c];
    record->count = kept;
    if (tau < 0 || kept == 0)
        return imki_fail(&log->findings, error, IMK_ERROR_FORMAT, "no_curve", NULL, 0, NULL);
    choose_rows(s, record->log.data[tau], record->log.rows, used);
    if (used->count < 4)
        return imki_fail(&log->findings, error, IMK_ERROR_TOO_SHORT, "too_few_tau", NULL,
                         IMKI_NUMBERS((double)used->count, s->rate, s->duration));
    record->dt = 1 / s->rate;
    record->rows = imk_samples_in(s->duration, record->dt);
    return IMK_OK;
}

static void store(imk_identification *result, const imk_allan_fit *fit, const double *deviation,
                  const used_rows *used)
{
    result->mean = result->deviation = (double)NAN; /* not in a table */
    imki_store_fit(result, fit);
    double least = deviation[0];
    for (size_t k = 1; k < used->count; k++)
        least = fmin(least, deviation[k]);
    result->minimum_floor = least / 0.6642824702679600; /* sqrt(2 ln 2/pi) */
    result->valid_from = result->five_terms_from = used->tau[fit->first];
    result->valid_to = result->longest = used->tau[used->count - 1];
}

/* The deviations as points of a plot: each has the degrees of freedom that the model gives it. */
static imk_status keep_curve(imk_identify_log *log, size_t channel, const imk_allan_fit *fit,
                             const double *deviation, const used_rows *used,
                             const imk_allocator *allocator)
{
    const double tail = (1 - log->settings.confidence) / 2;
    imk_allan_point point[IMK_ALLAN_FIT_FACTORS_MAX] = {0};
    for (size_t k = 0; k < used->count; k++) {
        imk_allan_point *p = &point[k];
        const double ratio = fit->expected[k] / fit->sigma[k];
        p->m = used->factor[k];
        p->edf = 2 * ratio * ratio;
        p->deviation = deviation[k];
        p->lower = p->deviation * sqrt(p->edf / imk_chi_square_quantile(1 - tail, p->edf));
        p->upper = p->deviation * sqrt(p->edf / imk_chi_square_quantile(tail, p->edf));
    }
    return imki_allan_curve_of(used->count, point, log->record.dt, allocator, &log->curve[channel]);
}

static void tell_fit(imk_identify_log *log, size_t channel, const imk_allan_fit *fit,
                     const used_rows *used, double found)
{
    static const char *const codes[2][2] = {{"curve", "curve_from"},
                                            {"curve_misfit", "curve_misfit_from"}};
    const char *name = imk_even_record_column(&log->record, channel)->name;
    const bool bad = fit->probability < misfit_chance;
    imki_find(&log->findings, bad ? IMK_FINDING_NOTE : IMK_FINDING_GOOD, codes[bad][fit->first > 0],
              name,
              IMKI_NUMBERS(fit->chi_square, (double)fit->degrees, fit->probability,
                           used->tau[fit->first]));
    if (found > 0)
        imki_find(&log->findings, found > tolerance_told ? IMK_FINDING_WARNING : IMK_FINDING_NOTE,
                  "curve_tolerance", name, IMKI_NUMBERS(100 * found));
}

/* Fit with the smallest error of the deviations that makes the terms explain the curve and leaves
 * out few of its tau. Errors of reading are many times the statistical ones at short tau: without
 * them a fit fails, or leaves out the tau that tell the white noise. A curve that no error mends
 * but leaving out does (an output filter shapes the short tau of a computed one) is fitted so.
 * @param found  set to the error taken */
static imk_status fit_within(imk_allan_fit_settings *settings, const imk_allan_table *table,
                             imk_allan_fit *fit, imk_allan_fit *other, double *found,
                             void *workspace, size_t size)
{
    enum { COUNT = sizeof tolerances / sizeof tolerances[0] };
    const size_t few = 3 + table->count / 16;
    bool kept = false;
    imk_status status = IMK_OK;
    for (size_t k = 0; k < COUNT; k++) {
        settings->tolerance = tolerances[k];
        const imk_status now = imk_allan_fit_table(settings, table, other, workspace, size, NULL);
        const double enough = k == 0 ? misfit_chance : tolerance_chance;
        const bool explained = now == IMK_OK && other->probability >= enough;
        if (explained && other->first <= few) {
            *fit = *other;
            *found = tolerances[k];
            return IMK_OK;
        }
        if (explained && !kept) {
            *fit = *other;
            *found = tolerances[k];
            kept = true;
        }
        status = now;
    }
    if (kept)
        return IMK_OK;
    *fit = *other;
    *found = tolerances[COUNT - 1];
    return status;
}

static imk_status fit_channel(imk_identify_log *log, size_t channel,
                              const imk_identify_curve_settings *s, const used_rows *used,
                              imki_arena *scratch)
{
    const double *data = imk_even_record_data(&log->record, channel);
    double deviations[IMK_ALLAN_FIT_FACTORS_MAX] = {0}, variances[IMK_ALLAN_FIT_FACTORS_MAX];
    for (size_t k = 0; k < used->count; k++) {
        deviations[k] = data[used->row[k]];
        variances[k] = deviations[k] * deviations[k];
    }
    const imk_allan_table table = {.dt = log->record.dt,
                                   .count = used->count,
                                   .factors = used->factor,
                                   .variances = variances,
                                   .strides = s->plain ? used->factor : NULL,
                                   .record_count = 1,
                                   .lengths = &log->record.rows};
    imk_allan_fit_settings settings = imk_allan_fit_default();
    settings.confidence = s->confidence;
    settings.significance = s->significance;
    settings.tolerance = s->tolerance;
    settings.gauss_markov_max = s->gauss_markov_max;
    const size_t size = imk_allan_fit_workspace_size(&settings, used->count, 0);
    void *workspace = imki_arena_room(scratch, size);
    imk_allan_fit *fit = imki_arena_take(scratch, 2 * sizeof *fit);
    if (!workspace || !fit)
        return IMK_ERROR_MEMORY;
    double found = 0;
    imk_status status = isnan(s->tolerance)
                            ? fit_within(&settings, &table, fit, fit + 1, &found, workspace, size)
                            : imk_allan_fit_table(&settings, &table, fit, workspace, size, NULL);
    if (status == IMK_OK)
        status = keep_curve(log, channel, fit, deviations, used, &scratch->allocator);
    if (status == IMK_OK) {
        store(&log->result[channel], fit, deviations, used);
        tell_fit(log, channel, fit, used, found);
    }
    return status;
}

static imk_status fit_all(imk_identify_log *log, const imk_record_source *source,
                          const imk_identify_curve_settings *s, const imk_job *job,
                          imk_error *error)
{
    used_rows used = {.count = 0};
    imk_status status = imki_record_load(source, job, &log->record.log, error);
    if (status == IMK_OK) {
        imki_tell_damage(source, &log->findings);
        status = choose(log, s, &used, error);
    }
    for (size_t c = 0; status == IMK_OK && c < log->record.count; c++) {
        imki_arena scratch = {.allocator = job->allocator};
        status = fit_channel(log, c, s, &used, &scratch);
        imki_arena_free(&scratch);
        if (status == IMK_ERROR_MEMORY)
            imk_error_set(error, status, NULL, NULL, NULL);
        else if (status != IMK_OK)
            imki_fail(&log->findings, error, status, "curve_failed",
                      imk_even_record_column(&log->record, c)->name, IMKI_NUMBERS(status));
    }
    return status;
}

static imk_status check_settings(const imk_identify_curve_settings *s, imk_error *error)
{
    if (!(s->rate > 0))
        return imki_refuse(error, IMK_ERROR_RANGE, "rate", s->rate, 0, "a rate above 0 Hz");
    if (!(s->duration > 0))
        return imki_refuse(error, IMK_ERROR_RANGE, "duration", s->duration, 0, "a time above 0 s");
    if (!isnan(s->tolerance) && !(s->tolerance >= 0 && s->tolerance <= 0.5))
        return imki_refuse(error, IMK_ERROR_RANGE, "tolerance", s->tolerance, 0.5,
                           "a fraction from 0 to 0.5");
    return imki_check_fraction("confidence", s->confidence, error);
}

imk_status imk_identify_curve_run(const imk_record_source *source,
                                  const imk_identify_curve_settings *settings, const imk_job *job,
                                  imk_identify_log **result, imk_error *error)
{
    imk_status status =
        imki_check_call(result, settings, settings_cookie, "imk_identify_curve_default()", error);
    if (!result)
        return status;
    *result = NULL;
    job = imki_job_of(job);
    if (status == IMK_OK)
        status = check_settings(settings, error);
    imk_identify_log *made = imki_result_new(job, sizeof *made, &status, error);
    if (!made)
        return status;
    made->settings = imk_identify_log_default();
    made->settings.confidence = settings->confidence;
    made->settings.significance = settings->significance;
    made->settings.from_allan = true;
    made->origin = IMK_IDENTIFY_CURVE;
    made->duration = settings->duration;
    *result = made;
    status = fit_all(made, source, settings, job, error);
    made->record.log.allocator = job->allocator;
    return status;
}
