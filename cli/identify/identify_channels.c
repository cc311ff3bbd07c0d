/* SPDX-License-Identifier: Apache-2.0 */
/* Identifies the channels of a log, each a piece of work of its own. */
#include "identify_parts.h"

#include "shell/progress.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

typedef struct channel_work {
    identification *all;
    imk_status status[IMK_LOG_COLUMNS_MAX];
    imk_error error[IMK_LOG_COLUMNS_MAX];
    const size_t *factors;
    size_t factor_count;
    progress *shown;
    atomic_flag showing; /* one thread at a time draws the line, the others go on */
    atomic_size_t done;
} channel_work;

bool identify_settings_for(identification *i, size_t channel, imk_identify_settings *settings)
{
    *settings = imk_identify_default();
    settings->dt = i->channels.dt;
    settings->confidence = i->options->confidence;
    settings->significance = i->options->significance;
    if (i->summarised)
        settings->summary = i->summary[channel] = calloc(1, imk_spectral_summary_size());
    return !i->summarised || settings->summary;
}

void identify_free(identification *i)
{
    for (size_t c = 0; c < IMK_LOG_COLUMNS_MAX; c++) {
        allan_curve_free(&i->curve[c]);
        allan_curve_free(&i->twin[c]);
        free(i->summary[c]);
    }
    log_channels_free(&i->channels);
}

static imk_status take_allan_curve(channel_work *work, size_t channel)
{
    identification *all = work->all;
    size_t n = all->channels.rows;
    const double *data = log_channel_data(&all->channels, channel);
    imk_allan_settings settings = imk_allan_default();
    settings.confidence = all->options->confidence;
    size_t present = 0;
    while (present < n && isfinite(data[present]))
        present++;
    if (present < n)
        return allan_curve_with_gaps(&settings, n, data, all->channels.dt, work->factor_count,
                                     work->factors, NULL, &all->curve[channel]);
    double *sums = malloc((n + 1) * sizeof *sums);
    if (!sums)
        return IMK_ERROR_MEMORY;
    imk_allan_sums(n, data, sums, NULL);
    imk_status status =
        allan_curve_compute(&settings, n, sums, all->channels.dt, work->factor_count, work->factors,
                            NULL, NULL, &all->curve[channel]);
    free(sums);
    return status;
}

static void identify_one(void *context, size_t channel)
{
    channel_work *work = context;
    identification *all = work->all;
    size_t n = all->channels.rows, size = imk_identify_workspace_size(n);
    void *workspace = malloc(size);
    imk_error *error = &work->error[channel];
    imk_identify_settings settings;
    imk_status status = IMK_ERROR_MEMORY;
    imk_error_set(error, status, NULL, NULL, NULL);
    if (workspace && identify_settings_for(all, channel, &settings))
        status = identify_screen_channel(all, channel, error);
    if (status == IMK_OK)
        status = imk_identify_channel(&settings, n, log_channel_data(&all->channels, channel),
                                      &all->result[channel], workspace, size, error);
    free(workspace);
    if (status == IMK_OK) {
        status = take_allan_curve(work, channel);
        if (status != IMK_OK)
            imk_error_set(error, status, NULL, NULL, NULL);
    }
    work->status[channel] = status;
    size_t done = atomic_fetch_add(&work->done, 1) + 1;
    if (!atomic_flag_test_and_set(&work->showing)) {
        progress_update(work->shown, done, all->channels.count);
        atomic_flag_clear(&work->showing);
    }
}

int identify_explain(const identification *i, size_t channel, imk_status status,
                     const imk_error *error)
{
    const char *name = log_channel_column(&i->channels, channel)->name;
    if (status == IMK_ERROR_CONSTANT)
        return command_failed("%s: column %s is constant in all %zu rows: there is no noise to "
                              "identify; leave it out with --columns, or check the log",
                              i->path, name, i->channels.rows);
    /* A log read block by block keeps no samples, and is long. */
    const bool kept = log_channel_data(&i->channels, channel) != NULL;
    const size_t finite = kept ? log_channel_finite(&i->channels, channel) : i->channels.rows;
    if (status == IMK_ERROR_TOO_SHORT && finite < i->channels.rows)
        return command_failed("%s: column %s has %zu finite values in %zu rows: at least 256 are "
                              "needed to identify noise; leave it out with --columns, or check the "
                              "log",
                              i->path, name, finite, i->channels.rows);
    if (status == IMK_ERROR_TOO_SHORT)
        return command_failed("%s: %zu rows are too few to identify noise: at least 256 are "
                              "needed, and minutes to hours are useful",
                              i->path, i->channels.rows);
    imk_error named = *error;
    if (!named.field[0])
        snprintf(named.field, sizeof named.field, "%s", name);
    return command_error(&named, i->path);
}

int identify_channels(identification *i, const imk_executor *executor)
{
    channel_work *work = calloc(1, sizeof *work);
    size_t *factors =
        work ? allan_factors_of_grid(IMK_ALLAN_OCTAVE, i->channels.rows, &work->factor_count)
             : NULL;
    if (!factors) {
        free(work);
        return command_failed("memory is exhausted");
    }
    progress shown = progress_begin("identifying", "channels", 1);
    atomic_flag_clear(&work->showing);
    work->all = i;
    work->factors = factors;
    work->shown = &shown;
    i->screened = true;
    imk_execute(executor, i->channels.count, identify_one, work);
    progress_end(&shown);
    int code = -1;
    for (size_t c = 0; c < i->channels.count && code < 0; c++)
        if (work->status[c] != IMK_OK)
            code = identify_explain(i, c, work->status[c], &work->error[c]);
    free(factors);
    free(work);
    return code;
}
