/* SPDX-License-Identifier: Apache-2.0 */
/* --limit: what the figures are held against. */
#include "evaluate_parts.h"

int evaluate_read_limits(evaluation *v)
{
    imk_error error;
    switch (imk_evaluate_limits_parse(v->options->limit, v->limit, &v->limit_count, &error)) {
    case IMK_OK:
        return -1;
    case IMK_ERROR_WORKSPACE:
        return command_misused("--limit: more than %d limits", IMK_EVALUATE_LIMITS);
    case IMK_ERROR_NAME_UNKNOWN:
        return command_misused("--limit: there is no figure \"%s\"%s%s%s", error.found,
                               error.expected[0] ? "; did you mean \"" : "", error.expected,
                               error.expected[0] ? "\"?" : "");
    default:
        return command_misused("--limit \"%s\": expected %s", error.found, error.expected);
    }
}

/* Warn of figures that are beyond their limits. */
static void warn(const char *name, const imk_evaluate_sheet *sheet)
{
    char text[400];
    for (size_t i = 0; i < sheet->count; i++)
        if (imk_evaluate_missed(&sheet->row[i])) {
            imk_evaluate_missed_text(name, &sheet->row[i], text, sizeof text);
            command_warn("limit", "%s", text);
        }
}

int evaluate_check_limits(evaluation *v)
{
    char why[230];
    imk_error error;
    size_t missed;
    const imk_status status =
        imk_evaluate_limits_check(v->log, v->limit_count, v->limit, &missed, &error);
    v->missed = missed > 0;
    for (size_t k = 0; k < v->log->channel_count; k++)
        warn(v->log->channel[k].name, &v->log->channel[k].sheet);
    for (size_t k = 0; k < v->log->rest_count; k++)
        warn(v->log->rest[k].name, &v->log->rest[k].sheet);
    if (status == IMK_OK)
        return -1;
    const imk_evaluate_limit *limit = &v->limit[error.index];
    if (limit->refused_by[0]) {
        imk_error_text(&limit->why, NULL, why, sizeof why);
        return command_misused("--limit %s of %s: %s", limit->key, limit->refused_by, why);
    }
    return command_misused("--limit %s: %s%s%s", limit->key, error.found,
                           error.expected[0] ? "; " : "", error.expected);
}
