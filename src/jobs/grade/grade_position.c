/* SPDX-License-Identifier: Apache-2.0 */
/* Errors of position that make the class by performance, by covariance (drift.h): what limits a
 * model, and what the next better class needs. */
#include "imukit/grade_position.h"

#include "jobs/drift/drift_models_internal.h"
#include "jobs/job_internal.h"
#include "jobs/record/record_check_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double times[IMK_GRADE_TIMES] = {60, 3600, 86400};

double imk_grade_time(size_t time)
{
    return times[time];
}

/* What stays of the scale factor after calibration, worst axis. */
static double scale_stability(const imk_triad *triad)
{
    double worst = 0;
    for (int i = 0; triad->present && i < triad->axis_count; i++)
        worst = fmax(worst, hypot(triad->scale_factor.repeatability.value[i],
                                  triad->scale_factor.fixed.sigma[i]));
    return worst > 0 ? worst : (double)NAN;
}

static void keep_figures(const imk_drift_analysis *a, imk_grade_way *p)
{
    for (size_t t = 0; t < IMK_GRADE_TIMES; t++) {
        p->figures[t] = imk_drift_figures_of(&a->total[t]);
        p->validity[t] = imk_drift_validity_of(&p->figures[t]);
        p->cep[t] = p->validity[t] == IMK_DRIFT_LOST ? (double)NAN : p->figures[t].cep;
    }
    p->grade = imk_grade_of_position(p->cep[IMK_GRADE_HOUR], p->cep[IMK_GRADE_DAY]);
}

static double variance(const imk_drift_moments *m)
{
    return m->covariance[0][0] + m->covariance[1][1];
}

/* ---- what limits it ---- */

/* Insert by size, the largest first; `count` grows to IMK_GRADE_SHARES at most.
 * @return false when it was too small to stay */
static bool insert(imk_grade_share *list, size_t *count, const char *text, double value)
{
    size_t place = *count;
    while (place > 0 && list[place - 1].value < value)
        place--;
    if (place >= IMK_GRADE_SHARES)
        return false;
    if (*count < IMK_GRADE_SHARES)
        (*count)++;
    memmove(&list[place + 1], &list[place], (*count - place - 1) * sizeof *list);
    snprintf(list[place].text, sizeof list[place].text, "%s", text);
    list[place].value = value;
    return true;
}

static void find_shares(imk_graded *one, const imk_drift_analysis *a)
{
    const imk_drift_moments *hour = &a->total[IMK_GRADE_HOUR];
    const double total = variance(hour), visible = 0.02;
    one->shifted = hour->mean[0] * hour->mean[0] + hour->mean[1] * hour->mean[1] > total;
    for (size_t k = 0; k < a->source_count && total > 0; k++) {
        const double share = variance(&a->contribution[k * a->time_count + IMK_GRADE_HOUR]) / total;
        if (share >= visible)
            insert(one->share, &one->share_count, a->source[k].text, share);
    }
}

/* ---- what the next class needs ---- */

static imk_status find_needs(imk_graded *one, const imk_drift_analysis *a, imki_arena *scratch,
                             imk_error *error)
{
    imk_drift_allocation *need = imki_arena_take(scratch, sizeof *need);
    if (!need)
        return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    const imk_grade present = one->way[IMK_GRADE_GIVEN].grade;
    one->next = present > IMK_GRADE_TACTICAL    ? IMK_GRADE_TACTICAL
                : present > IMK_GRADE_STRATEGIC ? (imk_grade)(present - 1)
                                                : IMK_GRADE_NONE;
    const imk_grade_row *row = imk_grade_table(one->next);
    const bool open = row && isinf(row->position_limit);
    const size_t time = one->next == IMK_GRADE_STRATEGIC ? IMK_GRADE_DAY : IMK_GRADE_HOUR;
    /* A class whose claim has no upper end wants an error that is a position still. */
    if (row && imk_drift_require(a, time, open ? IMK_REQUIRED_DRMS : IMK_REQUIRED_CEP,
                                 open ? IMK_DRIFT_DISTANCE_MAX : row->position_limit, need,
                                 NULL) == IMK_OK) {
        size_t wanting = 0;
        one->next_all = need->all;
        for (size_t k = 0; k < a->source_count; k++) {
            if (!(need->source[k] > 0 && need->source[k] < 1))
                continue;
            wanting++;
            insert(one->need, &one->need_count, a->source[k].text, 1 / need->source[k]);
        }
        one->need_more = wanting - one->need_count;
    }
    return IMK_OK;
}

/* ---- all ---- */

static imk_status analyse_way(imk_graded *one, int way, const imk_job *job, imki_arena *scratch,
                              imk_error *error)
{
    imk_drift_settings settings = imk_drift_default();
    imk_drift_analysis *analysis;
    settings.alignment = way == IMK_GRADE_SELF || way == IMK_GRADE_SELF_COMPENSATED
                             ? IMK_ALIGNED_SELF
                             : IMK_ALIGNED_GIVEN;
    settings.compensated = way >= IMK_GRADE_GIVEN_COMPENSATED;
    settings.time_count = IMK_GRADE_TIMES;
    settings.time = times;
    imk_status status = imk_drift_validate(one->model, &settings, error);
    if (status != IMK_OK)
        return status;
    const size_t size = imk_drift_covariance_size(one->model, &settings);
    void *memory = imki_arena_room(scratch, size);
    status = memory ? imk_drift_covariance(one->model, &settings, job->executor, &analysis, memory,
                                           size, error)
                    : imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    if (status != IMK_OK)
        return status;
    keep_figures(analysis, &one->way[way]);
    if (way != IMK_GRADE_GIVEN)
        return IMK_OK;
    find_shares(one, analysis);
    one->omitted_count = analysis->omitted_count;
    memcpy(one->omitted, analysis->omitted, sizeof one->omitted);
    settings.time_count = IMK_GRADE_TIMES - IMK_GRADE_HOUR;
    settings.time = &times[IMK_GRADE_HOUR];
    status = imki_drift_missing(one->model, &settings, 1U << IMK_REQUIRED_CEP, job->executor,
                                scratch, one->missing, &one->missing_count, error);
    return status == IMK_OK ? find_needs(one, analysis, scratch, error) : status;
}

/* A position needs three of each along body x, y, z: imk_drift_validate() knows. */
static const char *why_no_position(const imk_model *model)
{
    const double soon = 1;
    imk_drift_settings settings = imk_drift_default();
    settings.time_count = 1;
    settings.time = &soon;
    if (!model->gyro.present || !model->accel.present)
        return model->gyro.present ? "the model has no accelerometers" : "the model has no gyros";
    return imk_drift_validate(model, &settings, NULL) == IMK_ERROR_UNSUPPORTED
               ? "a position needs three gyros and three accelerometers along x, y and z"
               : NULL;
}

static imk_status find_position(imk_graded *one, const imk_job *job, imk_error *error)
{
    imk_status status = IMK_OK;
    for (int way = 0; way < IMK_GRADE_WAYS && status == IMK_OK; way++) {
        imki_arena scratch = {.allocator = job->allocator};
        status = analyse_way(one, way, job, &scratch, error);
        imki_arena_free(&scratch);
        if (status == IMK_OK)
            status =
                imki_job_progress(job, "grading", "ways", (uint64_t)way + 1, IMK_GRADE_WAYS, error);
    }
    for (size_t t = 0; t < IMK_GRADE_TIMES; t++)
        for (int way = IMK_GRADE_GIVEN; way <= IMK_GRADE_SELF; way++)
            one->compensation_matters =
                one->compensation_matters ||
                one->way[way].figures[t].cep != one->way[way + 2].figures[t].cep;
    return status;
}

bool imk_grade_possible(const imk_model *model)
{
    return !why_no_position(model) || *imk_grade_model(model).limiting;
}

imk_status imk_grade_run(const imk_model *model, const imk_job *job, imk_graded **result,
                         imk_error *error)
{
    if (!result)
        return imk_error_set(error, IMK_ERROR_ARGUMENT, "result", NULL, "a place for the result");
    job = imki_job_of(job);
    *result = NULL;
    imk_status status = imki_check_model(model, error);
    imk_graded *one = imki_result_new(job, sizeof *one, &status, error);
    if (!one)
        return status;
    *result = one;
    one->model = model;
    one->allocator = job->allocator;
    one->next = IMK_GRADE_NONE;
    one->table = imk_grade_model(model);
    one->gyro_scale = scale_stability(&model->gyro);
    one->accel_scale = scale_stability(&model->accel);
    one->no_position = why_no_position(model);
    if (!one->no_position)
        return find_position(one, job, error);
    if (*one->table.limiting)
        return IMK_OK;
    return imki_fail(&one->findings, error, IMK_ERROR_EMPTY, "nothing_to_grade", NULL, 0, NULL);
}

void imk_graded_free(imk_graded *result)
{
    if (!result)
        return;
    const imk_allocator allocator = result->allocator;
    imki_resize(&allocator, result, 0);
}
