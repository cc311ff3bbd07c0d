/* SPDX-License-Identifier: Apache-2.0 */
/* A noise model from a table of Allan deviations: a data sheet's, a publication's, another tool's.
 * Only the curve being known, the fit is generalised least squares over all its tau
 * (imk_allan_fit_table()) instead of the likelihood of the record. */
#include "identify_curve.h"

#include "imukit/allan_fit.h"
#include "imukit/distributions.h"
#include "imukit/samples.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Neighbours closer than this ratio hold next to nothing new, and make the covariance singular. */
static const double LEAST_RATIO = 1.1;

/* What the fits say beside the terms. */
typedef struct identify_curve_fits {
    size_t count; /* tau in the table that were used */
    double tau[IMK_ALLAN_FIT_FACTORS_MAX];
    double deviation[IMK_LOG_COLUMNS_MAX][IMK_ALLAN_FIT_FACTORS_MAX];
    imk_allan_fit fit[IMK_LOG_COLUMNS_MAX];
} identify_curve_fits;

static int find_column(const imk_log *log, const char *name)
{
    for (size_t c = 0; c < log->column_count; c++)
        if (strcmp(log->column[c].name, name) == 0)
            return (int)c;
    return -1;
}

static int find_tau(const imk_log *log)
{
    const int tau = find_column(log, "tau");
    return tau >= 0 ? tau : find_column(log, "tau_s");
}

/* Rows whose tau is a multiple of the sample interval, within 1 %, in steps of at least a ratio. */
static size_t take_rows(const double *tau, size_t rows, const identify_curve_input *input,
                        size_t *row, size_t *factor)
{
    size_t count = 0;
    double ratio = LEAST_RATIO;
    const double n = floor(input->duration * input->rate + 0.5);
    for (;;) {
        size_t last = 0;
        count = 0;
        for (size_t k = 0; k < rows; k++) {
            const double m = floor(tau[k] * input->rate + 0.5);
            if (!(m >= 1) || 2 * m > n || fabs(m / (tau[k] * input->rate) - 1) > 0.01 ||
                (count > 0 && m < ratio * (double)last))
                continue;
            last = (size_t)m;
            if (count < IMK_ALLAN_FIT_FACTORS_MAX) {
                row[count] = k;
                factor[count] = last;
            }
            count++;
        }
        if (count <= IMK_ALLAN_FIT_FACTORS_MAX)
            return count;
        ratio *= 1.1;
    }
}

static void store(imk_identification *result, const imk_allan_fit *fit, const double *deviation,
                  const identify_curve_fits *fits)
{
    memset(result, 0, sizeof *result);
    result->mean = result->deviation = (double)NAN; /* not in a table */
    memcpy(result->term, fit->term, sizeof result->term);
    memcpy(result->correlation, fit->correlation, sizeof result->correlation);
    result->gauss_markov_count = fit->gauss_markov_count;
    for (int k = 0; k < fit->gauss_markov_count; k++) {
        result->gauss_markov[k].sigma = fit->gauss_markov[k].sigma;
        result->gauss_markov[k].correlation_time = fit->gauss_markov[k].correlation_time;
    }
    double least = deviation[0];
    for (size_t k = 1; k < fits->count; k++)
        least = fmin(least, deviation[k]);
    result->minimum_floor = least / 0.6642824702679600; /* sqrt(2 ln 2/pi) */
    result->valid_from = result->five_terms_from = fits->tau[fit->first];
    result->valid_to = result->longest = fits->tau[fits->count - 1];
}

static int fit_channel(identification *i, size_t channel, const imk_allan_fit_settings *settings,
                       imk_allan_table *table, const size_t *row, identify_curve_fits *fits)
{
    double variances[IMK_ALLAN_FIT_FACTORS_MAX];
    const double *data = log_channel_data(&i->found->record, channel);
    for (size_t k = 0; k < table->count; k++) {
        fits->deviation[channel][k] = data[row[k]];
        variances[k] = data[row[k]] * data[row[k]];
    }
    table->variances = variances;
    const size_t size = imk_allan_fit_workspace_size(settings, table->count, 0);
    void *workspace = malloc(size);
    if (!workspace)
        return command_failed("memory is exhausted");
    imk_error error;
    const imk_status status =
        imk_allan_fit_table(settings, table, &fits->fit[channel], workspace, size, &error);
    free(workspace);
    if (status != IMK_OK)
        return command_failed("%s: column %s: %s", i->path,
                              log_channel_column(&i->found->record, channel)->name,
                              imk_status_text(status));
    store(&i->found->result[channel], &fits->fit[channel], fits->deviation[channel], fits);
    return -1;
}

/* The deviations as points of a plot: each has the degrees of freedom that the model gives it. */
static bool keep_curve(identification *i, size_t channel, const identify_curve_fits *fits,
                       const size_t *factor)
{
    const imk_allan_fit *fit = &fits->fit[channel];
    const size_t count = fits->count;
    imk_allan_curve *curve = &i->found->curve[channel];
    curve->point = calloc(count, sizeof *curve->point);
    curve->tau = malloc(4 * count * sizeof *curve->tau);
    if (!curve->point || !curve->tau)
        return false;
    curve->count = count;
    curve->deviation = curve->tau + count;
    curve->lower = curve->deviation + count;
    curve->upper = curve->lower + count;
    const double tail = (1 - i->options->confidence) / 2;
    for (size_t k = 0; k < count; k++) {
        imk_allan_point *p = &curve->point[k];
        const double ratio = fit->expected[k] / fit->sigma[k];
        p->m = factor[k];
        p->edf = 2 * ratio * ratio;
        p->deviation = fits->deviation[channel][k];
        p->lower = p->deviation * sqrt(p->edf / imk_chi_square_quantile(1 - tail, p->edf));
        p->upper = p->deviation * sqrt(p->edf / imk_chi_square_quantile(tail, p->edf));
        curve->tau[k] = fits->tau[k];
        curve->deviation[k] = p->deviation;
        curve->lower[k] = p->lower;
        curve->upper[k] = p->upper;
    }
    return true;
}

static void judge_curve(identification *i, size_t channel, const identify_curve_fits *fits)
{
    const imk_allan_fit *fit = &fits->fit[channel];
    const char *name = log_channel_column(&i->found->record, channel)->name;
    char left_out[120] = "";
    if (fit->first > 0)
        snprintf(left_out, sizeof left_out,
                 "; tau below %.3g s are left out: the terms do not explain them",
                 fits->tau[fit->first]);
    const bool bad = fit->probability < 0.001;
    identify_add_sentence(i, bad ? VERDICT_WARNING : VERDICT_GOOD, bad ? "misfit" : "curve",
                          "%s: chi-square %.1f for %d degrees of freedom (%.2g by chance)%s.%s",
                          name, fit->chi_square, fit->degrees, fit->probability, left_out,
                          bad ? " The terms do not explain the curve, or it is not what was said: "
                                "do its clusters overlap (--plain)? Was it read from a page "
                                "(--tolerance)? Do not trust the intervals."
                              : "");
}

static int fit_curves(identification *i, const identify_curve_input *input,
                      identify_curve_fits *fits)
{
    if (!(input->rate > 0) || !(input->duration > 0))
        return command_misused("a curve does not say how long and how fast was recorded: give "
                               "--rate and --duration, such as --rate 100Hz --duration 3h");
    imk_log_settings reading = log_input_settings(&i->options->log);
    imk_error error;
    reading.any_columns = true;
    reading.rate = input->rate;
    if (imk_log_load(i->path, &reading, NULL, NULL, &i->found->record.log, &error) != IMK_OK)
        return command_log_error(&error, i->path);
    log_choose_channels(&i->found->record);
    const int tau = find_tau(&i->found->record.log);
    if (find_column(&i->found->record.log, "edf") >= 0)
        return command_failed("%s looks like the long table of imukit allan; a curve has a column "
                              "for each channel, such as tau [s],gyro_x [deg/s]. From the log "
                              "itself, --method allan does the same, and needs no table",
                              i->path);
    size_t kept = 0;
    for (size_t c = 0; c < i->found->record.count; c++)
        if (i->found->record.column[c] != tau)
            i->found->record.column[kept++] = i->found->record.column[c];
    i->found->record.count = kept;
    if (tau < 0 || kept == 0)
        return command_failed("%s: a table of Allan deviations has a column tau [s] and columns "
                              "such as gyro_x [deg/s]",
                              i->path);
    size_t row[IMK_ALLAN_FIT_FACTORS_MAX], factor[IMK_ALLAN_FIT_FACTORS_MAX];
    memset(fits, 0, sizeof *fits);
    fits->count =
        take_rows(i->found->record.log.data[tau], i->found->record.log.rows, input, row, factor);
    if (fits->count < 4)
        return command_failed("%s: %zu tau are multiples of 1/%g s and at most half of %g s; a fit "
                              "needs 4",
                              i->path, fits->count, input->rate, input->duration);
    for (size_t k = 0; k < fits->count; k++)
        fits->tau[k] = (double)factor[k] / input->rate;
    const size_t length = imk_samples_in(input->duration, 1 / input->rate);
    imk_allan_table table = {.dt = 1 / input->rate,
                             .count = fits->count,
                             .factors = factor,
                             .strides = input->plain ? factor : NULL,
                             .record_count = 1,
                             .lengths = &length};
    imk_allan_fit_settings settings = imk_allan_fit_default();
    settings.confidence = i->options->confidence;
    settings.significance = i->options->significance;
    settings.tolerance = input->tolerance;
    settings.gauss_markov_max = (int)input->gauss_markov;
    i->found->record.dt = table.dt;
    i->found->record.rows = length;
    int code = -1;
    for (size_t c = 0; c < i->found->record.count && code < 0; c++)
        code = fit_channel(i, c, &settings, &table, row, fits);
    for (size_t c = 0; c < i->found->record.count && code < 0; c++) {
        if (!keep_curve(i, c, fits, factor))
            code = command_failed("memory is exhausted");
        else
            judge_curve(i, c, fits);
    }
    return code;
}

int identify_curve(identification *i, const identify_curve_input *input)
{
    i->found = command_memory(NULL, sizeof *i->found);
    memset(i->found, 0, sizeof *i->found);
    i->found->settings = imk_identify_log_default();
    i->found->settings.confidence = i->options->confidence;
    i->found->settings.from_allan = true;
    i->found->duration = input->duration;
    identify_curve_fits *fits = calloc(1, sizeof *fits);
    const int code = fits ? fit_curves(i, input, fits) : command_failed("memory is exhausted");
    free(fits);
    return code;
}
