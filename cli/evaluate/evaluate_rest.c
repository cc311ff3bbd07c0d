/* SPDX-License-Identifier: Apache-2.0 */
/* --static: bias instability of a log at rest, fitted, with the Allan minimum beside it. */
#include "evaluate_parts.h"

#include "log/channel_units.h"

#include <stdlib.h>
#include <string.h>

static int identify(const log_channels *channels, size_t c, double confidence, void *workspace,
                    size_t size, evaluate_rest *rest)
{
    imk_error error;
    const imk_log_column *column = log_channel_column(channels, c);
    imk_identify_settings settings = imk_identify_default();
    settings.dt = channels->dt;
    settings.confidence = confidence;
    snprintf(rest->name, sizeof rest->name, "%s", column->name);
    const imk_status status =
        imk_identify_channel(&settings, channels->rows, log_channel_data(channels, c),
                             &rest->result, workspace, size, &error);
    rest->identified = status == IMK_OK;
    if (!rest->identified) {
        command_warn("static", "column %s of the log at rest: %s", column->name,
                     imk_status_text(status));
        return -1;
    }
    rest->unit = channel_readable_unit(column, rest->result.minimum_floor);
    return -1;
}

int evaluate_load_rest(evaluation *v)
{
    const evaluate_options *o = v->options;
    log_channels channels;
    if (!o->rest)
        return -1;
    int code = log_input_load(&o->bench.log, o->rest, &channels);
    if (code >= 0)
        return code;
    const size_t size = imk_identify_workspace_size(channels.rows);
    void *workspace = malloc(size > 0 ? size : 1);
    if (!workspace)
        code = command_failed("memory is exhausted");
    for (size_t c = 0; code < 0 && c < channels.count && v->rest_count < EVALUATE_CHANNELS; c++)
        code = identify(&channels, c, o->confidence, workspace, size, &v->rest[v->rest_count++]);
    free(workspace);
    log_channels_free(&channels);
    return code;
}
