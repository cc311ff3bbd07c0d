/* SPDX-License-Identifier: Apache-2.0 */
/* Errors of position that make the class by performance, by covariance (drift.h): what limits a
 * model, and what the next better class needs. */
#include "grade_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const double grade_time[GRADE_TIMES] = {60, 3600, 86400};

const char *grade_name(imk_grade grade)
{
    const imk_grade_row *row = imk_grade_table(grade);
    return row ? row->name : "below every class";
}

const char *grade_length(double metres, char text[DRIFT_TEXT])
{
    const imk_unit mile = imk_unit_of("nmi");
    if (isfinite(metres) && metres >= 0.1 * mile.scale)
        return drift_in_unit(metres, &mile, text);
    return drift_length(metres, text);
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

static void keep_figures(const imk_drift_analysis *a, grade_position *p)
{
    for (size_t t = 0; t < GRADE_TIMES; t++) {
        p->figures[t] = imk_drift_figures_of(&a->total[t]);
        p->validity[t] = drift_validity_of(&p->figures[t]);
        p->cep[t] = p->validity[t] == DRIFT_LOST ? (double)NAN : p->figures[t].cep;
    }
    p->grade = imk_grade_of_position(p->cep[GRADE_HOUR], p->cep[GRADE_DAY]);
}

static double variance(const imk_drift_moments *m)
{
    return m->covariance[0][0] + m->covariance[1][1];
}

/* ---- what limits it ---- */

/* Insert by size, the largest first; `count` grows to GRADE_SHARES at most.
 * @return false when it was too small to stay */
static bool insert(grade_share *list, size_t *count, const char *text, double value)
{
    size_t place = *count;
    while (place > 0 && list[place - 1].value < value)
        place--;
    if (place >= GRADE_SHARES)
        return false;
    if (*count < GRADE_SHARES)
        (*count)++;
    memmove(&list[place + 1], &list[place], (*count - place - 1) * sizeof *list);
    snprintf(list[place].text, sizeof list[place].text, "%s", text);
    list[place].value = value;
    return true;
}

static void find_shares(grade_case *one, const imk_drift_analysis *a)
{
    const imk_drift_moments *hour = &a->total[GRADE_HOUR];
    const double total = variance(hour), visible = 0.02;
    one->shifted = hour->mean[0] * hour->mean[0] + hour->mean[1] * hour->mean[1] > total;
    for (size_t k = 0; k < a->source_count && total > 0; k++) {
        const double share = variance(&a->contribution[k * a->time_count + GRADE_HOUR]) / total;
        if (share >= visible)
            insert(one->share, &one->share_count, a->source[k].text, share);
    }
}

/* ---- what the next class needs ---- */

static void find_needs(grade_case *one, const imk_drift_analysis *a)
{
    imk_drift_requirement *need = command_memory(NULL, sizeof *need);
    const imk_grade present = one->way[GRADE_GIVEN].grade;
    one->next = present > IMK_GRADE_TACTICAL    ? IMK_GRADE_TACTICAL
                : present > IMK_GRADE_STRATEGIC ? (imk_grade)(present - 1)
                                                : IMK_GRADE_NONE;
    const imk_grade_row *row = imk_grade_table(one->next);
    const bool open = row && isinf(row->position_limit);
    const size_t time = one->next == IMK_GRADE_STRATEGIC ? GRADE_DAY : GRADE_HOUR;
    /* A class whose claim has no upper end wants an error that is a position still. */
    if (row && imk_drift_require(a, time, open ? IMK_WISH_DRMS : IMK_WISH_CEP,
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
    free(need);
}

/* ---- all ---- */

static int analyse_way(grade_case *one, int way)
{
    imk_error error;
    imk_drift_settings settings = imk_drift_default();
    imk_drift_analysis *analysis;
    settings.alignment =
        way == GRADE_SELF || way == GRADE_SELF_COMPENSATED ? IMK_ALIGNED_SELF : IMK_ALIGNED_GIVEN;
    settings.compensated = way >= GRADE_GIVEN_COMPENSATED;
    settings.time_count = GRADE_TIMES;
    settings.time = grade_time;
    if (imk_drift_validate(one->model, &settings, &error) != IMK_OK)
        return command_error(&error, one->operand);
    const size_t size = imk_drift_covariance_size(one->model, &settings);
    void *memory = command_aligned(size);
    if (imk_drift_covariance(one->model, &settings, memory, size, NULL, &analysis, &error) !=
        IMK_OK) {
        free(memory);
        return command_error(&error, one->operand);
    }
    keep_figures(analysis, &one->way[way]);
    if (way == GRADE_GIVEN) {
        find_shares(one, analysis);
        find_needs(one, analysis);
        for (size_t i = 0; i < analysis->omitted_count; i++)
            list_add_item(&one->omitted, "%s", analysis->omitted[i]);
    }
    free(memory);
    return -1;
}

/* A position needs three of each along body x, y, z: imk_drift_validate() knows. */
static bool can_navigate(grade_case *one)
{
    const double soon = 1;
    imk_error error;
    imk_drift_settings settings = imk_drift_default();
    settings.time_count = 1;
    settings.time = &soon;
    if (!one->model->gyro.present || !one->model->accel.present)
        snprintf(one->no_position, sizeof one->no_position, "the model has no %s",
                 one->model->gyro.present ? "accelerometers" : "gyros");
    else if (imk_drift_validate(one->model, &settings, &error) == IMK_ERROR_UNSUPPORTED)
        snprintf(one->no_position, sizeof one->no_position,
                 "it takes three gyros and three accelerometers along x, y and z");
    return !one->no_position[0];
}

int grade_analyse(grade_case *one)
{
    int code = -1;
    one->table = imk_grade_model(one->model);
    one->gyro_scale = scale_stability(&one->model->gyro);
    one->accel_scale = scale_stability(&one->model->accel);
    one->next = IMK_GRADE_NONE;
    one->has_position = can_navigate(one);
    for (int way = 0; one->has_position && way < GRADE_WAYS && code < 0; way++)
        code = analyse_way(one, way);
    for (size_t t = 0; one->has_position && t < GRADE_TIMES; t++)
        for (int way = GRADE_GIVEN; way <= GRADE_SELF; way++)
            one->compensation_matters =
                one->compensation_matters ||
                one->way[way].figures[t].cep != one->way[way + 2].figures[t].cep;
    return code;
}
