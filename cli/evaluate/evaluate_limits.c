/* SPDX-License-Identifier: Apache-2.0 */
/* --limit: what the figures are held against. */
#include "evaluate_parts.h"

#include <ctype.h>
#include <string.h>

static int read_limit(evaluation *v, const char *item, size_t length)
{
    while (length > 0 && isspace((unsigned char)*item))
        item++, length--;
    size_t word = 0;
    while (word < length && !isspace((unsigned char)item[word]))
        word++;
    imk_evaluate_limit *limit = &v->limit[v->limit_count];
    if (v->limit_count == IMK_EVALUATE_LIMITS)
        return command_misused("--limit: more than %d limits", IMK_EVALUATE_LIMITS);
    if (word >= sizeof limit->key || length - word >= sizeof limit->text || word == length)
        return command_misused("--limit \"%.*s\": expected a figure and its limit, such as "
                               "\"linearity 0.05 %%\"",
                               (int)length, item);
    *limit = (imk_evaluate_limit){0};
    for (size_t k = 0; k < word; k++)
        limit->key[k] = item[k] == '-' ? '_' : item[k];
    while (word < length && isspace((unsigned char)item[word]))
        word++;
    memcpy(limit->text, item + word, length - word);
    const char *keys[IMK_EVALUATE_ROWS];
    const size_t key_count = imk_evaluate_limit_keys(keys);
    for (size_t k = 0; k < key_count; k++)
        if (strcmp(keys[k], limit->key) == 0) {
            v->limit_count++;
            return -1;
        }
    const char *nearest = command_nearest(limit->key, key_count, keys);
    return command_misused("--limit: there is no figure \"%s\"%s%s%s", limit->key,
                           nearest ? "; did you mean \"" : "", nearest ? nearest : "",
                           nearest ? "\"?" : "");
}

int evaluate_read_limits(evaluation *v)
{
    int code = -1;
    for (const char *item = v->options->limit; item && code < 0;) {
        const size_t length = strcspn(item, ",;");
        code = read_limit(v, item, length);
        if (!item[length])
            break;
        item += length + 1;
    }
    return code;
}

/* Warn of figures that are beyond their limits. */
static void check_row(evaluation *v, const char *name, imk_evaluate_row *row)
{
    imk_evaluate_assess(v->limit_count, v->limit, name, row);
    if (row->verdict == IMK_EVALUATE_NOT_MET || row->verdict == IMK_EVALUATE_UNKNOWN) {
        v->missed = true;
        command_warn("limit", "%s: %s %s (limit %s)", name, row->title,
                     row->verdict == IMK_EVALUATE_NOT_MET ? "is beyond its limit"
                                                          : "is not determined",
                     row->limit);
    }
}

/* A limit of nothing: of another dimension, or of a figure that is not there. */
static int refuse_limit(const imk_evaluate_limit *limit)
{
    char why[230];
    if (limit->refused_by[0]) {
        imk_error_text(&limit->why, NULL, why, sizeof why);
        return command_misused("--limit %s of %s: %s", limit->key, limit->refused_by, why);
    }
    const bool runs = strstr(limit->key, "repeatability") != NULL;
    const bool rest =
        strcmp(limit->key, "bias_instability") == 0 || strcmp(limit->key, "allan_minimum") == 0;
    return command_misused(
        "--limit %s: these files do not give this figure%s", limit->key,
        runs   ? "; it needs two runs: add a column run, or give a file for each run"
        : rest ? "; it needs a log at rest: add --static LOG"
               : "");
}

int evaluate_check_limits(evaluation *v)
{
    for (size_t k = 0; k < v->log->channel_count; k++)
        for (size_t i = 0; i < v->log->channel[k].sheet.count; i++)
            check_row(v, v->log->channel[k].name, &v->log->channel[k].sheet.row[i]);
    for (size_t k = 0; k < v->log->rest_count; k++)
        for (size_t i = 0; i < v->log->rest[k].sheet.count; i++)
            check_row(v, v->log->rest[k].name, &v->log->rest[k].sheet.row[i]);
    for (size_t k = 0; k < v->limit_count; k++)
        if (!v->limit[k].used)
            return refuse_limit(&v->limit[k]);
    return -1;
}
