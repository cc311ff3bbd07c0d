/* SPDX-License-Identifier: Apache-2.0 */
/* How good the terms must become if the filter of an aided navigator is made anew for them.
 *
 * A filter that knows of better sensors has other gains, so that the errors are no longer those of
 * each term times its factor: an analysis for each trial. The terms are still reduced to a common
 * ceiling of what each contributes now (drift_requirement.c), or all by one factor; the ceiling, or
 * the factor, is found by bisection of its logarithm. */
#include "drift_models_internal.h"

#include <math.h>
#include <string.h>

/* A part of the goal that is near enough, and the most trials: the interval is then 1e-6 of the
 * first. */
static const double near_enough = 1e-3, least_part = 1e-6;
enum { TRIALS = 24 };

typedef struct search {
    const imk_drift_case *one;
    const imk_drift_wanted *want;
    const imk_executor *executor;
    imk_model *model, *filter_model;
    void *memory;
    size_t size;
    double time;
    double present[IMK_DRIFT_SOURCES_MAX]; /* figure of each source alone */
    double factor[IMK_DRIFT_SOURCES_MAX];
} search;

/* The figure with the present factors. */
static imk_status figure_of(search *s, double *figure, imk_error *error)
{
    const imk_drift_analysis *before = s->one->analysis;
    imk_drift_settings settings = s->one->settings, other = settings;
    imk_aid aid[IMK_AIDS_MAX], told[IMK_AIDS_MAX];
    imk_drift_analysis *analysis;
    *s->model = *s->one->model;
    if (settings.filter_model)
        *s->filter_model = *settings.filter_model;
    for (size_t k = 0; k < settings.aid_count; k++) {
        aid[k] = settings.aid[k];
        told[k] = settings.filter_aid ? settings.filter_aid[k] : aid[k];
    }
    for (size_t k = 0; k < before->source_count; k++) {
        const char *name = before->source[k].name;
        imk_drift_scale_source(name, s->factor[k], s->model, &settings, aid);
        imk_drift_scale_source(name, s->factor[k], s->filter_model, &other, told);
    }
    settings.aid = aid;
    settings.filter_aid = settings.filter_aid ? told : NULL;
    settings.filter_model = settings.filter_model ? s->filter_model : NULL;
    settings.time = &s->time;
    settings.time_count = 1;
    const imk_status status = imk_drift_covariance(s->model, &settings, s->executor, &analysis,
                                                   s->memory, s->size, error);
    if (status == IMK_OK) {
        const imk_drift_figures figures = imk_drift_figures_of(&analysis->total[0]);
        *figure = imk_drift_required(&figures, s->want->figure);
    }
    return status;
}

/* Factors of a trial: every source under a ceiling, or all by one factor. */
static void set_factors(search *s, bool ceiling, double x)
{
    for (size_t k = 0; k < s->one->analysis->source_count; k++)
        s->factor[k] = !ceiling ? x : s->present[k] > x ? x / s->present[k] : 1.0;
}

/* The largest x up to `high` with which the goal is met. The factors are then set. */
static imk_status find(search *s, bool ceiling, double high, double *x, double *reached,
                       imk_error *error)
{
    *reached = (double)INFINITY;
    double good = high * least_part, bad = high;
    imk_status status;
    set_factors(s, ceiling, good);
    status = figure_of(s, reached, error);
    for (int trial = 0; trial < TRIALS && status == IMK_OK && *reached <= s->want->goal; trial++) {
        if (*reached >= (1.0 - near_enough) * s->want->goal)
            break;
        double figure;
        const double middle = sqrt(good * bad);
        set_factors(s, ceiling, middle);
        status = figure_of(s, &figure, error);
        if (status == IMK_OK && figure <= s->want->goal) {
            good = middle;
            *reached = figure;
        } else {
            bad = middle;
        }
    }
    set_factors(s, ceiling, good);
    *x = good;
    return status;
}

static imk_status take(search *s, imk_drift_answer *answer, imk_error *error)
{
    imk_drift_allocation *need = &answer->allocation;
    const imk_drift_analysis *a = s->one->analysis;
    double highest = 0.0, x = 0.0, reached = (double)INFINITY;
    if (need->present <= s->want->goal) {
        answer->reached = need->present;
        return IMK_OK;
    }
    for (size_t k = 0; k < a->source_count; k++) {
        const imk_drift_figures figures =
            imk_drift_figures_of(&a->contribution[k * a->time_count + s->one->time]);
        s->present[k] = imk_drift_required(&figures, s->want->figure);
        highest = fmax(highest, s->present[k]);
    }
    imk_status status = find(s, false, 1.0, &x, &reached, error);
    if (status != IMK_OK)
        return status;
    need->all = reached <= s->want->goal ? x : 0.0;
    status = find(s, true, highest, &x, &answer->reached, error);
    for (size_t k = 0; k < a->source_count && status == IMK_OK; k++) {
        need->source[k] = answer->reached <= s->want->goal ? s->factor[k] : 0.0;
        need->alone[k] = 0.0;
    }
    return status;
}

imk_status imki_drift_retune(imk_drift_models *r, imki_arena *arena, const imk_executor *executor,
                             imk_error *error)
{
    const imk_drift_case *one = imki_drift_last_case(r);
    search *s = imki_arena_take(arena, sizeof *s);
    imk_drift_settings settings = one->settings;
    settings.time_count = 1;
    if (!s)
        return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    s->one = one;
    s->want = &r->settings.want;
    s->executor = executor;
    s->time = r->times->time[one->time];
    s->size = imk_drift_covariance_size(one->model, &settings);
    s->memory = imki_arena_room(arena, s->size);
    s->model = imki_arena_take(arena, sizeof *s->model);
    s->filter_model = imki_arena_take(arena, sizeof *s->filter_model);
    if (!s->memory || !s->model || !s->filter_model)
        return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    return take(s, r->answer, error);
}
