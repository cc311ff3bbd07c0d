/* SPDX-License-Identifier: Apache-2.0 */
/* Runs of one sensor: one joint estimate of each channel, whether the runs agree with it, their
 * Allan deviations pooled, and how much the mean differs from run to run. */
#include "identify_several.h"

#include "imukit/distributions.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* By chance fewer than one comparison of all channels in a hundred finds a difference. */
static const double alarm = 0.01;

static int join_channel(several_logs *s, size_t channel, void *workspace,
                        imk_identification *single)
{
    const imk_spectral_summary *summaries[IMK_JOINT_RECORDS_MAX];
    for (size_t r = 0; r < s->count; r++) {
        summaries[r] = s->log[r]->found->summary[channel];
        single[r] = s->log[r]->found->result[channel];
    }
    imk_identify_settings settings = imk_identify_default();
    settings.dt = s->joint->found->record.dt;
    settings.confidence = s->options->confidence;
    settings.significance = s->options->significance;
    imk_error error;
    const imk_status status = imk_identify_joint(
        &settings, s->count, summaries, single, &s->joint->found->result[channel],
        &s->agreement[channel], workspace, imk_identify_joint_workspace_size(), &error);
    if (status == IMK_OK)
        return -1;
    if (!error.field[0])
        snprintf(error.field, sizeof error.field, "%s",
                 log_channel_column(&s->joint->found->record, channel)->name);
    return command_error(&error, s->path);
}

/* Variances of all runs at each factor, weighted by their degrees of freedom. */
static bool pool_curves(several_logs *s, size_t channel)
{
    const imk_allan_curve *longest = &s->log[0]->found->curve[channel];
    for (size_t r = 1; r < s->count; r++)
        if (s->log[r]->found->curve[channel].count > longest->count)
            longest = &s->log[r]->found->curve[channel];
    imk_allan_curve *pool = &s->joint->found->curve[channel];
    const size_t count = longest->count;
    pool->point = malloc(count * sizeof *pool->point);
    pool->tau = malloc(4 * count * sizeof *pool->tau);
    if (!pool->point || !pool->tau)
        return false;
    pool->count = count;
    pool->deviation = pool->tau + count;
    pool->lower = pool->deviation + count;
    pool->upper = pool->lower + count;
    const double tail = (1 - s->options->confidence) / 2;
    for (size_t k = 0; k < count; k++) {
        imk_allan_point *p = &pool->point[k];
        double sum = 0, edf = 0;
        *p = longest->point[k];
        p->count = 0;
        for (size_t r = 0; r < s->count; r++) {
            const imk_allan_curve *c = &s->log[r]->found->curve[channel];
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
        pool->tau[k] = longest->tau[k];
        pool->deviation[k] = p->deviation;
        pool->lower[k] = p->lower;
        pool->upper[k] = p->upper;
    }
    return true;
}

/* Means of runs that follow one another without a break differ by the Allan deviation at their
 * length; more than that is from run to run. */
static int compare_means(several_logs *s, size_t channel)
{
    double mean[IMK_JOINT_RECORDS_MAX], sigma[IMK_JOINT_RECORDS_MAX];
    for (size_t r = 0; r < s->count; r++) {
        const log_channels *channels = &s->log[r]->found->record;
        mean[r] = s->log[r]->found->result[channel].mean;
        sigma[r] = sqrt(imk_identification_allan_variance(&s->joint->found->result[channel],
                                                          channels->dt, channels->rows, -1));
    }
    imk_error error;
    if (imk_repeatability_estimate(s->count, mean, sigma, NULL, s->options->confidence,
                                   &s->bias[channel], &error) != IMK_OK)
        return command_error(&error, s->path);
    return -1;
}

static void judge_channel(several_logs *s, size_t channel)
{
    const imk_joint_agreement *a = &s->agreement[channel];
    const imk_log_column *column = log_channel_column(&s->joint->found->record, channel);
    char chance[40];
    several_chance(a->probability, chance, sizeof chance);
    if (a->record < 0 || a->term < 0) {
        identify_add_sentence(s->joint, VERDICT_WARNING, "runs_differ",
                              "%s: the logs do not have the same noise (chance %s): identify "
                              "them apart, or find what differed.",
                              column->name, chance);
        return;
    }
    const term_display display = identify_term(column, (imk_noise_term)a->term);
    const double scale = display.unit.scale;
    identify_add_sentence(
        s->joint, VERDICT_WARNING, "runs_differ",
        "%s: the logs do not have the same noise (chance %s); most of all in %s: %.4g ± %.2g %s "
        "in %s, %.4g together (%.1f sigmas). Identify them apart, or find what differed: "
        "temperature, mounting, settings, vibration.",
        column->name, chance, display.name, a->value[a->record][a->term] / scale,
        a->sigma[a->record][a->term] / scale, display.unit.text, s->label[a->record],
        s->joint->found->result[channel].term[a->term].value / scale, a->sigmas);
}

/* Neither of the slow terms is seen, all logs together. */
static void judge_length(several_logs *s)
{
    char list[300] = "";
    size_t used = 0;
    for (size_t c = 0; c < s->joint->found->record.count && used < sizeof list; c++) {
        const imk_identification *r = &s->joint->found->result[c];
        if (!r->term[IMK_NOISE_BIAS_INSTABILITY].present &&
            !r->term[IMK_NOISE_RANDOM_WALK].present && r->gauss_markov_count == 0)
            used += (size_t)snprintf(list + used, sizeof list - used, "%s%s", used ? ", " : "",
                                     log_channel_column(&s->joint->found->record, c)->name);
    }
    if (used > 0)
        identify_add_sentence(s->joint, VERDICT_WARNING, "short",
                              "%s: all logs together are too short for the slowest terms: they are "
                              "bounded, not measured; log for longer at a time.",
                              list);
}

static void judge(several_logs *s)
{
    identification *j = s->joint;
    char length[60];
    size_t differ = 0;
    for (size_t c = 0; c < j->found->record.count; c++)
        if (s->agreement[c].probability < alarm / (double)j->found->record.count) {
            judge_channel(s, c);
            differ++;
        }
    format_duration(j->found->duration, length, sizeof length);
    judge_length(s);
    if (differ == 0)
        identify_add_sentence(j, VERDICT_GOOD, "runs_agree",
                              "The %zu logs agree: one model explains them, %s together.", s->count,
                              length);
    for (size_t c = 0; c < j->found->record.count; c++) {
        const imk_repeatability *b = &s->bias[c];
        const imk_log_column *column = log_channel_column(&j->found->record, c);
        if (!(b->lower > 0))
            continue;
        const imk_unit unit = channel_readable_unit(column, b->value);
        identify_add_sentence(j, VERDICT_NOTE, "bias_differs",
                              "%s: the mean differs from run to run by %.3g %s (1 sigma, %g %%: "
                              "%.3g to %.3g), more than noise within a run does. That is the "
                              "bias repeatability, if the sensor was not moved in between.",
                              column->name, b->value / unit.scale, unit.text,
                              100 * s->options->confidence, b->lower / unit.scale,
                              b->upper / unit.scale);
    }
}

int several_join_runs(several_logs *s)
{
    void *workspace = malloc(imk_identify_joint_workspace_size());
    imk_identification *single = calloc(s->count, sizeof *single);
    int code = workspace && single ? -1 : command_failed("memory is exhausted");
    for (size_t c = 0; c < s->joint->found->record.count && code < 0; c++) {
        code = join_channel(s, c, workspace, single);
        if (code < 0 && !pool_curves(s, c))
            code = command_failed("memory is exhausted");
        if (code < 0)
            code = compare_means(s, c);
    }
    free(workspace);
    free(single);
    if (code < 0)
        judge(s);
    return code;
}
