/* SPDX-License-Identifier: Apache-2.0 */
/* The answer to --want: what each term must become, and which devices of the catalogue would do. */
#include "drift_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct search {
    const drift_result *result;
    imk_drift_settings settings; /* of the one time */
    drift_candidate *candidate;
} search;

static bool states_bias(const imk_triad *triad)
{
    for (int i = 0; i < triad->axis_count; i++)
        if (triad->bias.repeatability.value[i] > 0)
            return true;
    return false;
}

/* Each device by itself, on one thread. One that has no complete triads is left unusable. */
static void try_device(void *context, size_t item)
{
    const search *s = context;
    drift_candidate *c = &s->candidate[item];
    imk_model *model = malloc(sizeof *model);
    void *memory = NULL;
    imk_drift_analysis *analysis;
    c->no_memory = !model;
    if (!model)
        return;
    imk_device_model(c->device, model);
    c->no_bias = !states_bias(&model->gyro) || !states_bias(&model->accel);
    if (imk_drift_validate(model, &s->settings, NULL) == IMK_OK) {
        const size_t size = imk_drift_covariance_size(model, &s->settings);
        memory = drift_memory(size);
        c->no_memory = !memory;
        if (memory && imk_drift_covariance(model, &s->settings, memory, size, NULL, &analysis,
                                           NULL) == IMK_OK) {
            c->figures = imk_drift_figures_of(&analysis->total[0]);
            c->usable = isfinite(imk_drift_wished(&c->figures, s->result->scene->want.figure));
        }
    }
    free(memory);
    free(model);
}

typedef struct ranked {
    double figure;
    drift_candidate candidate;
} ranked;

static int by_figure(const void *a, const void *b)
{
    const ranked *x = a, *y = b;
    if (x->figure != y->figure)
        return x->figure > y->figure ? 1 : -1;
    return strcmp(x->candidate.device->name, y->candidate.device->name);
}

static void sort_candidates(drift_answer *answer, imk_drift_wish wish)
{
    ranked *list = command_memory(NULL, (answer->candidate_count + 1) * sizeof *list);
    for (size_t i = 0; i < answer->candidate_count; i++) {
        const drift_candidate *c = &answer->candidate[i];
        list[i] = (ranked){c->usable ? imk_drift_wished(&c->figures, wish) : (double)INFINITY, *c};
    }
    qsort(list, answer->candidate_count, sizeof *list, by_figure);
    for (size_t i = 0; i < answer->candidate_count; i++)
        answer->candidate[i] = list[i].candidate;
    free(list);
}

/* Terms that must become better, the one that needs most first. */
static void order_terms(const imk_drift_analysis *a, drift_answer *answer)
{
    const imk_drift_requirement *need = &answer->requirement;
    size_t *order = answer->order;
    for (size_t k = 0; k < a->source_count; k++) {
        if (!(need->source[k] < DRIFT_SAME))
            continue;
        size_t i = answer->order_count++;
        for (; i > 0 && need->source[order[i - 1]] > need->source[k]; i--)
            order[i] = order[i - 1];
        order[i] = k;
        answer->alone = answer->alone || need->alone[k] > 0;
    }
}

int drift_answer_find(const drift_result *r, const imk_executor *executor, drift_answer *answer)
{
    const drift_case *one = drift_last_case(r);
    const drift_wished *want = &r->scene->want;
    imk_error error;
    *answer = (drift_answer){.candidate_count = imk_device_count()};
    if (imk_drift_require(one->analysis, one->time, want->figure, want->goal, &answer->requirement,
                          &error) != IMK_OK)
        return command_error(&error, one->name);
    order_terms(one->analysis, answer);
    answer->candidate = command_zeroed(answer->candidate_count * sizeof *answer->candidate);
    for (size_t i = 0; i < answer->candidate_count; i++)
        answer->candidate[i].device = imk_device_get(i);
    search s = {r, one->settings, answer->candidate};
    s.settings.time = &r->scene->time[one->time];
    s.settings.time_count = 1;
    imk_execute(executor, answer->candidate_count, try_device, &s);
    for (size_t i = 0; i < answer->candidate_count; i++)
        (void)command_unless_memory(answer->candidate[i].no_memory ? IMK_ERROR_MEMORY : IMK_OK);
    sort_candidates(answer, want->figure);
    return -1;
}

void drift_answer_free(drift_answer *answer)
{
    free(answer->candidate);
}

bool drift_would_do(const drift_result *r, const drift_candidate *c, bool preset)
{
    const drift_wished *want = &r->scene->want;
    return c->device->is_preset == preset && c->usable &&
           imk_drift_wished(&c->figures, want->figure) <= want->goal;
}
