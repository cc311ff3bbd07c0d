/* SPDX-License-Identifier: Apache-2.0 */
/* Covariance of each model, its figures, and the budget of its terms. */
#define _POSIX_C_SOURCE 200809L
#include "drift_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void *drift_memory(size_t size)
{
    void *memory = NULL;
    return posix_memalign(&memory, 64, size) == 0 ? memory : NULL;
}

/* ---- the budget ---- */

static size_t budget_time(const drift_result *r, const drift_case *one)
{
    const drift_scene *scene = r->scene;
    size_t chosen = scene->row[0];
    for (size_t k = 0; k < scene->row_count; k++) {
        const size_t t = scene->row[k];
        if (scene->want.asked ? fabs(scene->time[t] - scene->want.time) <
                                    fabs(scene->time[chosen] - scene->want.time)
                              : imk_drift_validity_of(&one->figures[t]) != IMK_DRIFT_LOST)
            chosen = t;
    }
    return chosen;
}

/* States whose squares make a figure. */
static void states_of(imk_drift_wish wish, int *first, int *last)
{
    static const int of[][2] = {{0, 1}, {0, 1}, {0, 1}, {2, 2}, {3, 4}, {6, 7}, {8, 8}};
    *first = of[wish][0];
    *last = of[wish][1];
}

static double variance_of(const imk_drift_moments *m, imk_drift_wish wish)
{
    int first, last;
    double sum = 0;
    states_of(wish, &first, &last);
    for (int i = first; i <= last; i++)
        sum += m->covariance[i][i];
    return sum;
}

static double shift_of(const imk_drift_moments *m, imk_drift_wish wish)
{
    int first, last;
    double sum = 0;
    states_of(wish, &first, &last);
    for (int i = first; i <= last; i++)
        sum += m->mean[i] * m->mean[i];
    return sqrt(sum);
}

static int by_share(const void *a, const void *b)
{
    const drift_share *x = a, *y = b;
    if (x->share != y->share)
        return x->share < y->share ? 1 : -1;
    if (x->shift != y->shift)
        return x->shift < y->shift ? 1 : -1;
    return (x->source > y->source) - (x->source < y->source);
}

static void find_budget(const drift_result *r, drift_case *one)
{
    const imk_drift_wish wish = drift_looked_at(r);
    const imk_drift_analysis *a = one->analysis;
    one->time = budget_time(r, one);
    one->share = command_memory(NULL, (a->source_count + 1) * sizeof *one->share);
    const double total = variance_of(&a->total[one->time], wish);
    for (size_t k = 0; k < a->source_count; k++) {
        imk_drift_moments m = a->contribution[k * a->time_count + one->time];
        drift_share s = {.source = k, .shift = shift_of(&m, wish)};
        s.share = total > 0 ? variance_of(&m, wish) / total : 0;
        if (!(s.share > 0) && !(s.shift > 0))
            continue;
        s.whole = imk_drift_figures_of(&m);
        for (int i = 0; i < IMK_DRIFT_STATES; i++)
            m.mean[i] = 0;
        s.random = imk_drift_figures_of(&m);
        one->share[one->share_count++] = s;
    }
    qsort(one->share, one->share_count, sizeof *one->share, by_share);
}

/* ---- all ---- */

/* A sentence about the model names it; one about the settings does not. */
static int refuse(const drift_case *one, const imk_error *error)
{
    const bool of_model = strncmp(error->field, "gyro", 4) == 0 ||
                          strncmp(error->field, "accel", 5) == 0 ||
                          strncmp(error->field, "timing", 6) == 0;
    return command_error(error, of_model ? one->name : NULL);
}

static int analyse(const drift_result *r, drift_case *one, const imk_executor *executor)
{
    imk_error error;
    if (imk_drift_validate(one->model, &one->settings, &error) != IMK_OK)
        return refuse(one, &error);
    const size_t size = imk_drift_covariance_size(one->model, &one->settings);
    one->memory = command_aligned(size);
    one->figures = command_memory(NULL, one->settings.time_count * sizeof *one->figures);
    if (imk_drift_covariance(one->model, &one->settings, one->memory, size, executor,
                             &one->analysis, &error) != IMK_OK)
        return refuse(one, &error);
    for (size_t t = 0; t < one->analysis->time_count; t++)
        one->figures[t] = imk_drift_figures_of(&one->analysis->total[t]);
    find_budget(r, one);
    return -1;
}

static void add_case(drift_result *r, size_t model, bool compensated, const char *label)
{
    drift_case *one = &r->cases[r->case_count++];
    one->name = r->name[model];
    one->model = r->model[model];
    one->settings = r->scene->settings;
    one->settings.compensated = compensated;
    snprintf(one->label, sizeof one->label, "%.90s%s", r->name[model], label);
}

int drift_analyse(drift_result *r, const imk_executor *executor)
{
    const bool compensated = r->options->compensated;
    if (compensated && r->model_count == 1)
        add_case(r, 0, false, "");
    for (size_t m = 0; m < r->model_count; m++)
        add_case(r, m, compensated, compensated ? ", compensated" : "");
    int code = -1;
    for (size_t c = 0; c < r->case_count && code < 0; c++)
        code = analyse(r, &r->cases[c], executor);
    return code;
}

void drift_result_free(drift_result *r)
{
    for (size_t c = 0; c < r->case_count; c++) {
        free(r->cases[c].memory);
        free(r->cases[c].figures);
        free(r->cases[c].share);
    }
    for (size_t m = 0; m < r->model_count; m++)
        free(r->model[m]);
    free(r->found);
    free(r->low);
    free(r->high);
    free(r->used);
}
