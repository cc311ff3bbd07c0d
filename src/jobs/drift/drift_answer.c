/* SPDX-License-Identifier: Apache-2.0 */
/* The answer to what is wanted: what each term must become, and which devices of the catalogue
 * would do. */
#include "drift_models_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct search {
    imk_drift_requirement figure;
    const imk_allocator *allocator;
    imk_drift_settings settings; /* of the one time */
    bool assume;
    imk_grade grade;
    imk_drift_candidate *candidate;
} search;

/* Each device by itself, on one thread. One that has no complete triads is left unusable. */
static void try_device(void *context, size_t item)
{
    const search *s = context;
    imk_drift_candidate *c = &s->candidate[item];
    imki_arena scratch = {.allocator = *s->allocator};
    imk_model *model = imki_arena_take(&scratch, sizeof *model);
    imk_drift_analysis *analysis;
    c->no_memory = !model;
    if (!model)
        return;
    imk_device_model(c->device, model);
    if (s->assume && model->gyro.present && model->accel.present)
        imk_model_assume_class(model, s->grade, NULL);
    if (imk_drift_validate(model, &s->settings, NULL) == IMK_OK) {
        const size_t size = imk_drift_covariance_size(model, &s->settings);
        void *memory = imki_arena_room(&scratch, size);
        c->no_memory = !memory;
        if (memory && imk_drift_covariance(model, &s->settings, NULL, &analysis, memory, size,
                                           NULL) == IMK_OK) {
            c->figures = imk_drift_figures_of(&analysis->total[0]);
            c->usable = isfinite(imk_drift_required(&c->figures, s->figure));
            c->no_memory =
                imki_drift_missing(model, &s->settings, 1U << s->figure, NULL, &scratch, c->missing,
                                   &c->missing_count, NULL) == IMK_ERROR_MEMORY;
        }
    }
    imki_arena_free(&scratch);
}

typedef struct ranked {
    double figure;
    imk_drift_candidate candidate;
} ranked;

static int by_figure(const void *a, const void *b)
{
    const ranked *x = a, *y = b;
    if (x->figure != y->figure)
        return x->figure > y->figure ? 1 : -1;
    return strcmp(x->candidate.device->name, y->candidate.device->name);
}

static bool sort_candidates(imk_drift_answer *answer, imk_drift_requirement requirement,
                            imki_arena *arena)
{
    ranked *list = imki_arena_take(arena, (answer->candidate_count + 1) * sizeof *list);
    if (!list)
        return false;
    for (size_t i = 0; i < answer->candidate_count; i++) {
        const imk_drift_candidate *c = &answer->candidate[i];
        list[i] = (ranked){
            c->usable ? imk_drift_required(&c->figures, requirement) : (double)INFINITY, *c};
    }
    qsort(list, answer->candidate_count, sizeof *list, by_figure);
    for (size_t i = 0; i < answer->candidate_count; i++)
        answer->candidate[i] = list[i].candidate;
    return true;
}

/* Terms that must become better, the one that needs most first. */
static void order_terms(const imk_drift_analysis *a, imk_drift_answer *answer)
{
    const imk_drift_allocation *need = &answer->allocation;
    size_t *order = answer->order;
    for (size_t k = 0; k < a->source_count; k++) {
        if (!(need->source[k] < IMK_DRIFT_SAME))
            continue;
        size_t i = answer->order_count++;
        for (; i > 0 && need->source[order[i - 1]] > need->source[k]; i--)
            order[i] = order[i - 1];
        order[i] = k;
        answer->alone = answer->alone || need->alone[k] > 0;
    }
}

imk_status imki_drift_answer(imk_drift_models *r, imki_arena *arena, const imk_executor *executor,
                             imk_error *error)
{
    const imk_drift_case *one = imki_drift_last_case(r);
    const imk_drift_wanted *want = &r->settings.want;
    imk_drift_answer *answer = r->answer = imki_arena_take(arena, sizeof *answer);
    const size_t count = imk_device_count();
    if (!answer)
        return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    const imk_status status = imk_drift_require(one->analysis, one->time, want->figure, want->goal,
                                                &answer->allocation, error);
    if (status != IMK_OK)
        return status;
    if (want->retuned && one->settings.aid_count > 0) {
        const imk_status retuned = imki_drift_retune(r, arena, executor, error);
        if (retuned != IMK_OK)
            return retuned;
    }
    order_terms(one->analysis, answer);
    answer->candidate = imki_arena_take(arena, count * sizeof *answer->candidate);
    answer->candidate_count = answer->candidate ? count : 0;
    for (size_t i = 0; i < answer->candidate_count; i++)
        answer->candidate[i].device = imk_device_get(i);
    search s = {.figure = want->figure,
                .allocator = &arena->allocator,
                .settings = one->settings,
                .candidate = answer->candidate,
                .assume = r->settings.assume,
                .grade = r->settings.assumed_class};
    s.settings.time = &r->times->time[one->time];
    s.settings.time_count = 1;
    imk_execute(executor, answer->candidate_count, try_device, &s);
    bool there = answer->candidate && sort_candidates(answer, want->figure, arena);
    for (size_t i = 0; i < answer->candidate_count; i++)
        there = there && !answer->candidate[i].no_memory;
    return there ? IMK_OK : imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
}

bool imki_drift_would_do(const imk_drift_models *r, const imk_drift_candidate *c, bool preset)
{
    const imk_drift_wanted *want = &r->settings.want;
    return c->device->is_preset == preset && c->usable &&
           imk_drift_required(&c->figures, want->figure) <= want->goal;
}
