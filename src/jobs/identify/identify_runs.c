/* SPDX-License-Identifier: Apache-2.0 */
/* Runs of one sensor: one joint estimate of each channel, whether the runs agree with it, their
 * Allan deviations pooled, and how much the mean differs from run to run. */
#include "identify_several_internal.h"

#include "jobs/allan/allan_curve_internal.h"
#include "jobs/arena_internal.h"

#include "imukit/distributions.h"
#include "imukit/noise.h"

#include <math.h>
#include <stdio.h>

/* By chance fewer than one comparison of all channels in a hundred finds a difference. */
static const double alarm = 0.01;

static imk_status join_channel(imk_identify_several *s, size_t channel, imki_arena *scratch,
                               imk_error *error)
{
    const size_t size = imk_identify_joint_workspace_size();
    void *workspace = imki_arena_room(scratch, size);
    imk_identification *single = imki_arena_take(scratch, s->count * sizeof *single);
    if (!workspace || !single)
        return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    const imk_spectral_summary *summaries[IMK_JOINT_RECORDS_MAX];
    for (size_t r = 0; r < s->count; r++) {
        summaries[r] = s->log[r]->summary[channel];
        single[r] = s->log[r]->result[channel];
    }
    imk_identify_settings settings = imk_identify_default();
    settings.dt = s->joint.record.dt;
    settings.confidence = s->joint.settings.confidence;
    settings.significance = s->joint.settings.significance;
    return imk_identify_joint(&settings, s->count, summaries, single, &s->joint.result[channel],
                              &s->agreement[channel], workspace, size, error);
}

/* Variances of all runs at each factor, weighted by their degrees of freedom. */
static imk_status pool_curves(imk_identify_several *s, size_t channel, imki_arena *scratch)
{
    const imk_identify_log *longest = s->log[0];
    for (size_t r = 1; r < s->count; r++)
        if (s->log[r]->curve[channel].count > longest->curve[channel].count)
            longest = s->log[r];
    const size_t count = longest->curve[channel].count;
    const double tail = (1 - s->joint.settings.confidence) / 2;
    imk_allan_point *point = imki_arena_take(scratch, (count + 1) * sizeof *point);
    if (!point)
        return IMK_ERROR_MEMORY;
    for (size_t k = 0; k < count; k++) {
        imk_allan_point *p = &point[k];
        double sum = 0, edf = 0;
        *p = longest->curve[channel].point[k];
        p->count = 0;
        for (size_t r = 0; r < s->count; r++) {
            const imk_allan_curve *c = &s->log[r]->curve[channel];
            if (k >= c->count || c->point[k].m != p->m || !(c->point[k].edf > 0))
                continue;
            edf += c->point[k].edf;
            sum += c->point[k].edf * c->point[k].deviation * c->point[k].deviation;
            p->count += c->point[k].count;
        }
        p->edf = edf;
        p->deviation = sqrt(sum / edf);
        p->lower = sqrt(sum / imk_chi_square_quantile(1 - tail, edf));
        p->upper = sqrt(sum / imk_chi_square_quantile(tail, edf));
    }
    return imki_allan_curve_of(count, point, longest->record.dt, &scratch->allocator,
                               &s->joint.curve[channel]);
}

/* What noise makes of the mean of a run: the Allan deviation at its length, and of flicker noise
 * also what is slower, since it differs from run to run by itself, as the simulator draws it. */
static double mean_variance(const imk_identification *model, double dt, size_t n)
{
    const imk_flicker flicker = {model->term[IMK_NOISE_BIAS_INSTABILITY].value, 0};
    return imk_identification_allan_variance(model, dt, n, -1) +
           imk_flicker_mean_variance(flicker, dt, n) -
           imk_identification_allan_variance(model, dt, n, IMK_NOISE_BIAS_INSTABILITY);
}

/* More than that is from run to run. */
static imk_status compare_means(imk_identify_several *s, size_t channel, imk_error *error)
{
    double mean[IMK_JOINT_RECORDS_MAX], sigma[IMK_JOINT_RECORDS_MAX];
    for (size_t r = 0; r < s->count; r++) {
        const imk_even_record *record = &s->log[r]->record;
        mean[r] = s->log[r]->result[channel].mean;
        sigma[r] = sqrt(mean_variance(&s->joint.result[channel], record->dt, record->rows));
    }
    return imk_repeatability_estimate(s->count, mean, sigma, NULL, s->joint.settings.confidence,
                                      &s->bias[channel], error);
}

static imk_status compare_channel(imk_identify_several *s, size_t channel, imki_arena *scratch,
                                  imk_error *error)
{
    imk_status status = join_channel(s, channel, scratch, error);
    if (status == IMK_OK && pool_curves(s, channel, scratch) != IMK_OK)
        status = imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    if (status == IMK_OK)
        status = compare_means(s, channel, error);
    s->differs[channel] = s->agreement[channel].probability < alarm / (double)s->joint.record.count;
    if (status != IMK_OK && status != IMK_ERROR_MEMORY && error && !error->field[0])
        snprintf(error->field, sizeof error->field, "%s",
                 imk_even_record_column(&s->joint.record, channel)->name);
    return status;
}

imk_status imk_identify_runs(size_t count, const imk_identify_log *const *logs, const imk_job *job,
                             imk_identify_several **result, imk_error *error)
{
    imk_error own = {.status = IMK_OK};
    imk_identify_several *s = imki_several_begin(true, count, logs, job, &own);
    imk_status status = own.status;
    size_t other = 1;
    while (s && other < count &&
           imk_identify_comparable(logs[0], logs[other], true, NULL) == IMK_OK)
        other++;
    if (s && other < count)
        status = imki_compare_rates(s, other, &own);
    for (size_t c = 0; s && !s->rates && status == IMK_OK && c < s->joint.record.count; c++) {
        imki_arena scratch = {.allocator = s->joint.record.log.allocator};
        status = compare_channel(s, c, &scratch, &own);
        imki_arena_free(&scratch);
    }
    if (status != IMK_OK) {
        imk_identify_several_free(s);
        s = NULL;
    }
    if (error)
        *error = own;
    *result = s;
    return status;
}
