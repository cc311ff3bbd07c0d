/* SPDX-License-Identifier: Apache-2.0 */
/* How figures stand to their limits. */
#include "imukit/evaluate_sheet.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static imk_status limit_value(const imk_evaluate_limit *limit, const imk_evaluate_row *row,
                              double *value, imk_error *error)
{
    double sigma;
    size_t count;
    const char *text = limit->text;
    return imk_quantity_parse(text, text + strlen(text), row->unit.dimension, 1, value, &sigma,
                              &count, NULL, error);
}

/* The limit of a figure: of its name and dimension, since gyros and accelerometers may have one
 * each. NULL: none */
static const imk_evaluate_limit *limit_of(size_t count, const imk_evaluate_limit *limits,
                                          const imk_evaluate_row *row, double *value)
{
    for (size_t k = 0; k < count; k++)
        if (strcmp(limits[k].key, row->key) == 0 &&
            limit_value(&limits[k], row, value, NULL) == IMK_OK)
            return &limits[k];
    return NULL;
}

/* How a figure stands to its limit. */
static void assess(size_t count, const imk_evaluate_limit *limits, imk_evaluate_row *row)
{
    double most;
    const imk_evaluate_limit *limit = limit_of(count, limits, row, &most);
    const imk_evaluation_figure *f = &row->figure;
    if (!limit)
        return;
    row->limit = limit->text;
    /* Not a number is not within. */
    const bool within = fabs(f->upper) <= most && (!row->is_signed || fabs(f->lower) <= most);
    if (within && !(fabs(f->value) > most))
        row->verdict = IMK_EVALUATE_MET;
    else if (!isfinite(f->value))
        row->verdict = IMK_EVALUATE_UNKNOWN;
    else
        row->verdict = fabs(f->value) > most ? IMK_EVALUATE_NOT_MET : IMK_EVALUATE_DOUBTFUL;
}

const char *imk_evaluate_verdict_text(imk_evaluate_verdict verdict)
{
    static const char *const texts[] = {"", "met", "met, not surely", "not met", "not determined"};
    return texts[verdict];
}

void imk_evaluate_assess(size_t count, imk_evaluate_limit *limits, const char *name,
                         imk_evaluate_row *row)
{
    double value;
    for (size_t k = 0; k < count; k++) {
        imk_evaluate_limit *limit = &limits[k];
        imk_error error = {.status = IMK_OK};
        if (strcmp(limit->key, row->key) != 0 || limit->used)
            continue;
        limit->used = limit_value(limit, row, &value, &error) == IMK_OK;
        snprintf(limit->refused_by, sizeof limit->refused_by, "%s", limit->used ? "" : name);
        limit->why = error;
    }
    assess(count, limits, row);
}
