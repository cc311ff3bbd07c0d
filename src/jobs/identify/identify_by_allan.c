/* SPDX-License-Identifier: Apache-2.0 */
/* The terms of a record from its Allan deviations, by generalised least squares with their full
 * covariance (imukit/allan_fit.h), beside the lines, resonances and the filter that the spectrum
 * showed. It loses a little against the likelihood of the spectrum, and shows what the plot holds.
 */
#include "identify_log_internal.h"

#include "jobs/arena_internal.h"
#include "jobs/job_internal.h"

#include <math.h>
#include <string.h>

/* What the spectrum found stays. */
static imk_allan_fit_settings settings_of(const imk_identify_log_settings *s,
                                          const imk_identification *r)
{
    imk_allan_fit_settings settings = imk_allan_fit_default();
    settings.confidence = s->confidence;
    settings.significance = s->significance;
    settings.tolerance = s->tolerance;
    settings.gauss_markov_max = s->gauss_markov_max;
    settings.filter = r->filter;
    settings.sinusoid_count = r->sinusoid_count;
    for (int k = 0; k < r->sinusoid_count; k++)
        settings.sinusoid[k] = r->sinusoid[k];
    settings.resonance_count = r->resonance_count;
    for (int k = 0; k < r->resonance_count; k++)
        settings.resonance[k] = r->resonance[k];
    return settings;
}

void imki_store_fit(imk_identification *r, const imk_allan_fit *fit)
{
    memcpy(r->term, fit->term, sizeof r->term);
    memcpy(r->correlation, fit->correlation, sizeof r->correlation);
    r->gauss_markov_count = fit->gauss_markov_count;
    for (int k = 0; k < fit->gauss_markov_count; k++) {
        r->gauss_markov[k].sigma = fit->gauss_markov[k].sigma;
        r->gauss_markov[k].correlation_time = fit->gauss_markov[k].correlation_time;
    }
}

static imk_status fit_channel(imk_identify_log *log, size_t channel, const char *name,
                              const imk_job *job, imk_error *error)
{
    imk_identification *r = &log->result[channel];
    const imk_allan_curve *curve = &log->curve[channel];
    size_t factor[IMK_ALLAN_FIT_FACTORS_MAX], count = 0;
    double variance[IMK_ALLAN_FIT_FACTORS_MAX];
    for (size_t k = 0; k < curve->count && count < IMK_ALLAN_FIT_FACTORS_MAX; k++) {
        factor[count] = curve->point[k].m;
        variance[count++] = curve->point[k].deviation * curve->point[k].deviation;
    }
    const imk_allan_table table = {.dt = log->record.dt,
                                   .count = count,
                                   .factors = factor,
                                   .variances = variance,
                                   .record_count = 1,
                                   .lengths = &log->record.rows};
    const imk_allan_fit_settings settings = settings_of(&log->settings, r);
    const size_t size = imk_allan_fit_workspace_size(&settings, count, 0);
    imki_arena scratch = {.allocator = job->allocator};
    void *workspace = imki_arena_room(&scratch, size);
    imk_allan_fit *fit = imki_arena_take(&scratch, sizeof *fit);
    imk_status status = IMK_ERROR_MEMORY;
    if (workspace && fit)
        status = imk_allan_fit_table(&settings, &table, fit, workspace, size, NULL);
    if (status == IMK_OK) {
        imki_store_fit(r, fit);
        r->valid_from = fmax(r->valid_from, curve->tau[fit->first]);
        imki_find(&log->findings, IMK_FINDING_NOTE, "allan_fit", name,
                  IMKI_NUMBERS(curve->tau[fit->first], curve->tau[count - 1], fit->chi_square,
                               (double)fit->degrees, fit->probability));
    }
    imki_arena_free(&scratch);
    return status == IMK_OK ? status
                            : imki_fail(&log->findings, error, status, "column_failed", name,
                                        IMKI_NUMBERS(status));
}

imk_status imki_identify_by_allan(imk_identify_log *log, const imk_job *job, imk_error *error)
{
    imk_status status = IMK_OK;
    for (size_t c = 0; c < log->record.count && status == IMK_OK; c++) {
        const char *name = imk_even_record_column(&log->record, c)->name;
        if (log->result[c].missing > 0)
            return imki_fail(&log->findings, error, IMK_ERROR_GAP, "allan_needs_all", name,
                             IMKI_NUMBERS((double)log->result[c].missing));
        status = fit_channel(log, c, name, job, error);
    }
    return status;
}
