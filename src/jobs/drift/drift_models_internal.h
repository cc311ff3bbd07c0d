/* SPDX-License-Identifier: Apache-2.0 */
/* Models that are analysed, and the answer to what is wanted. */
#ifndef IMUKI_DRIFT_MODELS_INTERNAL_H
#define IMUKI_DRIFT_MODELS_INTERNAL_H

#include "imukit/drift_models.h"

#include "jobs/arena_internal.h"

/* What budgets are of: the figure that is wanted, or CEP. */
static inline imk_drift_requirement imki_drift_looked_at(const imk_drift_models *r)
{
    return r->settings.want.asked ? r->settings.want.figure : IMK_REQUIRED_CEP;
}

static inline const imk_drift_case *imki_drift_last_case(const imk_drift_models *r)
{
    return &r->cases[r->case_count - 1];
}

/* Time of a row of the table. */
static inline double imki_drift_row_time(const imk_drift_models *r, size_t row)
{
    return r->times->time[r->times->row[row]];
}

/* Does it meet the requirement, and is it a grade preset, or none? */
bool imki_drift_would_do(const imk_drift_models *r, const imk_drift_candidate *candidate,
                         bool preset);
/* Sum of the squares of the states that make a figure: of a covariance and a mean. */
double imki_drift_variance(const imk_drift_moments *m, imk_drift_requirement requirement);
double imki_drift_shift(const imk_drift_moments *m, imk_drift_requirement requirement);

/* Memory that lives as long as the result; NULL when memory is exhausted. */
void *imki_drift_models_room(imk_drift_models *models, size_t size);

/* What a model does not state and that would matter (imk_drift_missing) for the figures of a mask
 * (1 << imk_drift_requirement) at the times of the settings; by a second analysis, if the model
 * leaves out anything.
 * @param missing  IMK_UNSTATED_MAX of them, the largest share first */
imk_status imki_drift_missing(const imk_model *model, const imk_drift_settings *settings,
                              unsigned figures, const imk_executor *executor, imki_arena *scratch,
                              imk_drift_missing *missing, size_t *count, imk_error *error);

/* Fill r->answer. */
imk_status imki_drift_answer(imk_drift_models *r, imki_arena *arena, const imk_executor *executor,
                             imk_error *error);
/* The same with a filter that is made anew for what is improved: other factors in the allocation of
 * the answer, none of which is for a term alone. */
imk_status imki_drift_retune(imk_drift_models *r, imki_arena *arena, const imk_executor *executor,
                             imk_error *error);

#endif
