/* SPDX-License-Identifier: Apache-2.0 */
/* --limit: what the figures are held against. A limit is surely met when the whole interval is
 * within it, as conformity is decided with measurement uncertainty [JCGM106]. */
#include "evaluate_parts.h"

#include <ctype.h>
#include <math.h>
#include <string.h>

static int read_limit(evaluation *v, const char *item, size_t length)
{
    while (length > 0 && isspace((unsigned char)*item))
        item++, length--;
    size_t word = 0;
    while (word < length && !isspace((unsigned char)item[word]))
        word++;
    evaluate_limit *limit = &v->limit[v->limit_count];
    if (v->limit_count == EVALUATE_LIMITS)
        return command_misused("--limit: more than %d limits", EVALUATE_LIMITS);
    if (word >= sizeof limit->key || length - word >= sizeof limit->text || word == length)
        return command_misused("--limit \"%.*s\": expected a figure and its limit, such as "
                               "\"linearity 0.05 %%\"",
                               (int)length, item);
    *limit = (evaluate_limit){0};
    for (size_t k = 0; k < word; k++)
        limit->key[k] = item[k] == '-' ? '_' : item[k];
    while (word < length && isspace((unsigned char)item[word]))
        word++;
    memcpy(limit->text, item + word, length - word);
    const char *keys[EVALUATE_ROWS];
    const size_t key_count = evaluate_limit_keys(keys);
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

static imk_status limit_value(const evaluate_limit *limit, const evaluate_row *row, double *value,
                              imk_error *error)
{
    double sigma;
    size_t count;
    const char *text = limit->text;
    return imk_quantity_parse(text, text + strlen(text), row->unit.dimension, 1, value, &sigma,
                              &count, NULL, error);
}

/* The limit of a figure: of its name and dimension, since gyros and accelerometers may have one
 * each. NULL: none */
static const evaluate_limit *limit_of(const evaluation *v, const evaluate_row *row, double *value)
{
    for (size_t k = 0; k < v->limit_count; k++)
        if (strcmp(v->limit[k].key, row->key) == 0 &&
            limit_value(&v->limit[k], row, value, NULL) == IMK_OK)
            return &v->limit[k];
    return NULL;
}

/* How a figure stands to its limit. */
static void judge(const evaluation *v, evaluate_row *row)
{
    double most;
    const evaluate_limit *limit = limit_of(v, row, &most);
    const imk_evaluation_figure *f = &row->figure;
    if (!limit)
        return;
    row->limit = limit->text;
    if (!isfinite(f->value))
        row->verdict = VERDICT_UNKNOWN;
    else if (fabs(f->value) > most)
        row->verdict = VERDICT_NOT_MET;
    else /* not a number is not within */
        row->verdict = fabs(f->upper) <= most && (!row->is_signed || fabs(f->lower) <= most)
                           ? VERDICT_MET
                           : VERDICT_DOUBTFUL;
}

const char *evaluate_verdict_text(evaluate_verdict verdict)
{
    static const char *const texts[] = {"", "met", "met, not surely", "not met", "not determined"};
    return texts[verdict];
}

/* Remember which limits apply; warn of those that are not met. */
static void check_row(evaluation *v, const char *name, evaluate_row *row)
{
    double value;
    for (size_t k = 0; k < v->limit_count; k++) {
        evaluate_limit *limit = &v->limit[k];
        imk_error error;
        if (strcmp(limit->key, row->key) != 0 || limit->used)
            continue;
        limit->used = limit_value(limit, row, &value, &error) == IMK_OK;
        limit->problem[0] = '\0';
        if (!limit->used) {
            const int used = snprintf(limit->problem, sizeof limit->problem, " of %s: ", name);
            imk_error_text(&error, NULL, limit->problem + used, sizeof limit->problem - used);
        }
    }
    judge(v, row);
    if (row->verdict == VERDICT_NOT_MET || row->verdict == VERDICT_UNKNOWN) {
        v->missed = true;
        command_warn("limit", "%s: %s %s (limit %s)", name, row->title,
                     row->verdict == VERDICT_NOT_MET ? "is beyond its limit" : "is not determined",
                     row->limit);
    }
}

/* A limit of nothing: of another dimension, or of a figure that is not there. */
static int refuse_limit(const evaluate_limit *limit)
{
    if (limit->problem[0])
        return command_misused("--limit %s%s", limit->key, limit->problem);
    const bool runs = strstr(limit->key, "repeatability") != NULL;
    const bool rest =
        strcmp(limit->key, "bias_instability") == 0 || strcmp(limit->key, "allan_minimum") == 0;
    return command_misused("--limit %s: there is no such figure of these files%s", limit->key,
                           runs   ? "; it takes two runs: a column run, or a file for each"
                           : rest ? "; it takes a log at rest: --static LOG"
                                  : "");
}

int evaluate_check_limits(evaluation *v)
{
    for (size_t k = 0; k < v->channel_count; k++)
        for (size_t i = 0; i < v->channel[k].sheet.count; i++)
            check_row(v, v->channel[k].name, &v->channel[k].sheet.row[i]);
    for (size_t k = 0; k < v->rest_count; k++)
        for (size_t i = 0; i < v->rest[k].sheet.count; i++)
            check_row(v, v->rest[k].name, &v->rest[k].sheet.row[i]);
    for (size_t k = 0; k < v->limit_count; k++)
        if (!v->limit[k].used)
            return refuse_limit(&v->limit[k]);
    return -1;
}
