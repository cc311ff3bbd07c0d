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
/* Fill r->answer. */
imk_status imki_drift_answer(imk_drift_models *r, imki_arena *arena, const imk_executor *executor,
                             imk_error *error);
/* The same with a filter that is made anew for what is improved: other factors in the allocation of
 * the answer, none of which is for a term alone. */
imk_status imki_drift_retune(imk_drift_models *r, imki_arena *arena, const imk_executor *executor,
                             imk_error *error);

#endif
