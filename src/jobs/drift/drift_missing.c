/* SPDX-License-Identifier: Apache-2.0 */
/* Terms that a model does not state and that would matter: every term that is not stated is given
 * the value typical of its class, and those that then make a material part of a figure are missing.
 * So a scale factor is missing where the motion turns, and not at rest. */
#include "drift_models_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The source of a term in an analysis; source_count: none. */
static size_t source_of(const imk_drift_analysis *a, const imk_unstated_term *term)
{
    const char *sensor = term->sensor == IMK_GYRO ? "gyro." : "accel.";
    const size_t length = strlen(sensor);
    size_t k = 0;
    while (k < a->source_count && !(strncmp(a->source[k].name, sensor, length) == 0 &&
                                    strcmp(a->source[k].name + length, term->key) == 0))
        k++;
    return k;
}

/* A typical value has no sign. With either sign, the mean of the total's square is that of the
 * other terms and that of the part: their product, by which known values cancel or add, has mean 0.
 */
static double share_of(const imk_drift_moments *part, const imk_drift_moments *all,
                       imk_drift_requirement figure)
{
    imk_drift_moments others = *all;
    for (int i = 0; i < IMK_DRIFT_STATES; i++)
        others.mean[i] -= part->mean[i];
    const double shift = imki_drift_shift(part, figure), rest = imki_drift_shift(&others, figure);
    const double random = imki_drift_variance(part, figure);
    const double square = random + shift * shift;
    /* Less than 0 only if the part is correlated with others, which then cancel it. */
    const double beside = fmax(0, imki_drift_variance(all, figure) - random) + rest * rest;
    return square > 0 ? square / (square + beside) : 0;
}

static imk_drift_missing largest(const imk_drift_analysis *a, const imk_unstated_term *term,
                                 unsigned figures)
{
    imk_drift_missing found = {.term = *term};
    const size_t k = source_of(a, term);
    for (size_t t = 0; k < a->source_count && t < a->time_count; t++)
        for (int f = IMK_REQUIRED_CEP; f <= IMK_REQUIRED_HEADING; f++) {
            const double share = (figures >> f & 1U) == 0
                                     ? 0
                                     : share_of(&a->contribution[k * a->time_count + t],
                                                &a->total[t], (imk_drift_requirement)f);
            if (share > found.share) {
                found.share = share;
                found.time = a->time[t];
                found.figure = (imk_drift_requirement)f;
            }
        }
    return found;
}

static int by_share(const void *a, const void *b)
{
    const imk_drift_missing *x = a, *y = b;
    return x->share != y->share ? (x->share < y->share ? 1 : -1)
                                : strcmp(x->term.text, y->term.text);
}

imk_status imki_drift_missing(const imk_model *model, const imk_drift_settings *settings,
                              unsigned figures, const imk_executor *executor, imki_arena *scratch,
                              imk_drift_missing *missing, size_t *count, imk_error *error)
{
    imk_unstated unstated;
    imk_drift_analysis *analysis;
    imk_drift_settings held = *settings;
    *count = 0;
    imk_model_unstated(model, &unstated);
    if (unstated.count == 0)
        return IMK_OK;
    imk_model *whole = imki_arena_room(scratch, sizeof *whole);
    if (!whole)
        return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    *whole = *model;
    imk_model_assume_class(whole, IMK_GRADE_NONE, &unstated);
    /* A share is of errors in the same filter: one that knew of the added terms would have other
     * gains. */
    if (held.aid_count > 0 && !held.filter_model)
        held.filter_model = model;
    const size_t size = imk_drift_covariance_size(whole, &held);
    void *memory = imki_arena_room(scratch, size);
    if (!memory)
        return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    const imk_status status =
        imk_drift_covariance(whole, &held, executor, &analysis, memory, size, error);
    for (size_t i = 0; status == IMK_OK && i < unstated.count; i++) {
        const imk_drift_missing found = largest(analysis, &unstated.term[i], figures);
        if (found.share > IMK_DRIFT_MATERIAL)
            missing[(*count)++] = found;
    }
    qsort(missing, *count, sizeof *missing, by_share);
    return status;
}
