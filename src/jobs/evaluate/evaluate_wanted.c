/* SPDX-License-Identifier: Apache-2.0 */
/* Limits as they are written, and all figures against them. */
#include "evaluate_job_internal.h"

#include "imukit/names.h"

#include <stdio.h>
#include <string.h>

static bool blank(char c)
{
    return c == ' ' || (c >= '\t' && c <= '\r');
}

static imk_status parse_limit(const char *item, size_t length, imk_evaluate_limit *limit,
                              imk_error *error)
{
    const char *keys[IMK_EVALUATE_ROWS];
    const size_t key_count = imk_evaluate_limit_keys(keys);
    char given[96];
    while (length > 0 && blank(*item))
        item++, length--;
    size_t word = 0;
    while (word < length && !blank(item[word]))
        word++;
    *limit = (imk_evaluate_limit){0};
    snprintf(given, sizeof given, "%.*s", (int)(length < 95 ? length : 95), item);
    if (word >= sizeof limit->key || length - word >= sizeof limit->text || word == length)
        return imk_error_set(error, IMK_ERROR_SYNTAX, "limit", given,
                             "a figure and its limit, such as \"linearity 0.05 %\"");
    for (size_t k = 0; k < word; k++)
        limit->key[k] = item[k] == '-' ? '_' : item[k];
    while (word < length && blank(item[word]))
        word++;
    memcpy(limit->text, item + word, length - word);
    for (size_t k = 0; k < key_count; k++)
        if (strcmp(keys[k], limit->key) == 0)
            return IMK_OK;
    const size_t nearest = imk_nearest_name(limit->key, key_count, keys);
    return imk_error_set(error, IMK_ERROR_NAME_UNKNOWN, "limit", limit->key,
                         nearest < key_count ? keys[nearest] : NULL);
}

imk_status imk_evaluate_limits_parse(const char *text, imk_evaluate_limit *limits, size_t *count,
                                     imk_error *error)
{
    imk_status status = IMK_OK;
    *count = 0;
    for (const char *item = text; item && status == IMK_OK;) {
        const size_t length = strcspn(item, ",;");
        if (*count == IMK_EVALUATE_LIMITS)
            return imk_error_set(error, IMK_ERROR_WORKSPACE, "limit", NULL, "fewer limits");
        status = parse_limit(item, length, &limits[*count], error);
        *count += status == IMK_OK;
        item = item[length] ? item + length + 1 : NULL;
    }
    return status;
}

static size_t assess(imk_evaluate_sheet *sheet, const char *name, size_t count,
                     imk_evaluate_limit *limits)
{
    size_t missed = 0;
    for (size_t i = 0; i < sheet->count; i++) {
        imk_evaluate_assess(count, limits, name, &sheet->row[i]);
        missed += imk_evaluate_missed(&sheet->row[i]);
    }
    return missed;
}

bool imk_evaluate_missed(const imk_evaluate_row *row)
{
    return row->verdict == IMK_EVALUATE_NOT_MET || row->verdict == IMK_EVALUATE_UNKNOWN;
}

size_t imk_evaluate_missed_text(const char *name, const imk_evaluate_row *row, char *text,
                                size_t size)
{
    const int length =
        snprintf(text, size, "%s: %s %s (limit %s)", name, row->title,
                 row->verdict == IMK_EVALUATE_NOT_MET ? "is beyond its limit" : "is not determined",
                 row->limit);
    return length > 0 ? (size_t)length : 0;
}

/* A limit of nothing: of another dimension, or of a figure that is not there. */
static imk_status refuse(const imk_evaluate_limit *limit, imk_error *error)
{
    if (limit->refused_by[0]) {
        if (error)
            *error = limit->why;
        return limit->why.status;
    }
    const bool runs = strstr(limit->key, "repeatability") != NULL;
    const bool rest =
        strcmp(limit->key, "bias_instability") == 0 || strcmp(limit->key, "allan_minimum") == 0;
    return imk_error_set(error, IMK_ERROR_CONFLICT, limit->key,
                         "these files do not give this figure",
                         runs   ? "it needs two runs: add a column run, or give a file for each run"
                         : rest ? "it needs a log at rest: add --static LOG"
                                : NULL);
}

imk_status imk_evaluate_limits_check(imk_evaluate_log *evaluation, size_t count,
                                     imk_evaluate_limit *limits, size_t *missed, imk_error *error)
{
    *missed = 0;
    for (size_t k = 0; k < evaluation->channel_count; k++)
        *missed +=
            assess(&evaluation->channel[k].sheet, evaluation->channel[k].name, count, limits);
    for (size_t k = 0; k < evaluation->rest_count; k++)
        *missed += assess(&evaluation->rest[k].sheet, evaluation->rest[k].name, count, limits);
    for (size_t k = 0; k < count; k++)
        if (!limits[k].used) {
            const imk_status status = refuse(&limits[k], error);
            if (error)
                error->index = (int)k;
            return status;
        }
    return IMK_OK;
}
