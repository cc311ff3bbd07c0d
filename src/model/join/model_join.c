/* SPDX-License-Identifier: Apache-2.0 */
/* One unit from models of its parts: which part gives what, and what the unit has once. Single axes
 * in model_join_axes.c. */
#include "model_join_internal.h"

#include "base/refuse_internal.h"
#include "base/text_internal.h"
#include "model/model_internal.h"
#include "model/model_schema_internal.h"

#include <string.h>

static const uint32_t settings_cookie = 0x494D4B1Au;

imk_join_settings imk_join_default(void)
{
    return (imk_join_settings){.cookie = settings_cookie,
                               .from = {IMK_JOIN_ANY, IMK_JOIN_ANY, IMK_JOIN_ANY},
                               .timing_from = IMK_JOIN_ANY,
                               .name = "joined"};
}

void imki_join_tell(imk_joined *joined, imk_join_note_kind kind, int sensor, int part,
                    const char *key)
{
    if (joined->note_count == IMK_JOIN_NOTES)
        return;
    imk_join_note *note = &joined->note[joined->note_count++];
    *note = (imk_join_note){.kind = kind, .sensor = sensor, .part = part};
    imki_copy_text(note->key, sizeof note->key, key);
}

imk_status imki_join_conflict(const imki_join *join, const char *field, int a, int b,
                              const char *more, imk_error *error)
{
    char found[200] = "both ";
    imki_append_text(found, 90, join->part[a].name);
    imki_append_text(found, 95, " and ");
    imki_append_text(found, 180, join->part[b].name);
    imki_append_text(found, sizeof found, " give it");
    return imk_error_set(error, IMK_ERROR_CONFLICT, field, found, more);
}

imk_evidence *imki_join_evidence(imk_model *model, int sensor)
{
    return sensor == IMK_GYRO    ? &model->gyro_evidence
           : sensor == IMK_ACCEL ? &model->accel_evidence
                                 : &model->mag_evidence;
}

const imk_evidence *imki_join_evidence_of(const imk_model *model, int sensor)
{
    return sensor == IMK_GYRO    ? &model->gyro_evidence
           : sensor == IMK_ACCEL ? &model->accel_evidence
                                 : &model->mag_evidence;
}

/* ---- which part gives what ------------------------------------------------------------------- */

static bool gives(const imki_join *join, int part, int sensor, bool whole)
{
    const imk_join_part *p = &join->part[part];
    return imk_model_triad(p->model, sensor)->present && (p->axis == IMK_JOIN_WHOLE) == whole;
}

static const char only_one[] = "one of them: choose which is to be taken";

/* The whole parts: at most one, or the chosen one. */
static imk_status choose_whole(const imki_join *join, int sensor, int chosen, int *from,
                               imk_error *error)
{
    *from = -1;
    for (int i = 0; i < (int)join->count; i++) {
        if (!gives(join, i, sensor, true) || (chosen != IMK_JOIN_ANY && chosen != i))
            continue;
        if (*from >= 0)
            return imki_join_conflict(join, imki_kind_names[sensor], *from, i, only_one, error);
        *from = i;
    }
    if (chosen != IMK_JOIN_ANY && *from < 0)
        return imk_error_set(error, IMK_ERROR_KEY_MISSING, imki_kind_names[sensor],
                             join->part[chosen].name, "a part that has such sensors");
    return IMK_OK;
}

static imk_status choose(const imki_join *join, int sensor, int chosen, imk_error *error)
{
    static const char *const axes[] = {"x", "y", "z"};
    int *from = join->joined->from[sensor], whole, given = 0, last = -1;
    imk_status status = choose_whole(join, sensor, chosen, &whole, error);
    for (int k = 0; k < 3; k++)
        from[k] = whole;
    for (int i = 0; i < (int)join->count && status == IMK_OK && chosen == IMK_JOIN_ANY; i++) {
        if (!gives(join, i, sensor, false))
            continue;
        int *axis = &from[join->part[i].axis];
        if (*axis >= 0)
            return imki_join_conflict(join, imki_kind_names[sensor], *axis, i, only_one, error);
        *axis = last = i;
        given++;
    }
    for (int k = 0; k < 3 && status == IMK_OK && given > 0; k++)
        if (from[k] < 0) {
            char expected[80] = "a part that gives axis ";
            imki_append_text(expected, sizeof expected, axes[k]);
            status = imk_error_set(error, IMK_ERROR_KEY_MISSING, imki_kind_names[sensor],
                                   join->part[last].name, expected);
        }
    return status;
}

static bool is_used(const imki_join *join, int part)
{
    for (int sensor = 0; sensor < IMK_KINDS; sensor++)
        for (int k = 0; k < 3; k++)
            if (join->joined->from[sensor][k] == part)
                return true;
    return false;
}

static void take_whole(const imki_join *join, int sensor)
{
    const imk_model *from = join->part[join->joined->from[sensor][0]].model;
    *imk_model_triad_to_set(join->unit, sensor) = *imk_model_triad(from, sensor);
    *imki_join_evidence(join->unit, sensor) = *imki_join_evidence_of(from, sensor);
}

static imk_status take_sensors(const imki_join *join, imk_error *error)
{
    imk_status status = IMK_OK;
    for (int sensor = 0; sensor < IMK_KINDS && status == IMK_OK; sensor++) {
        const int first = join->joined->from[sensor][0];
        imk_model_triad_to_set(join->unit, sensor)->present = false;
        if (first >= 0 && join->part[first].axis == IMK_JOIN_WHOLE)
            take_whole(join, sensor);
        else if (first >= 0)
            status = imki_join_axes(join, sensor, error);
    }
    return status;
}

/* ---- what the unit has once ------------------------------------------------------------------ */

static bool states_timing(const imk_timing *timing)
{
    static const imk_timing none;
    for (size_t i = 0; i < imki_timing_field_count; i++)
        if (!imki_numbers_equal(&imki_timing_fields[i], timing, &none, 1, true))
            return true;
    return false;
}

static bool equal_timings(const imk_timing *a, const imk_timing *b)
{
    for (size_t i = 0; i < imki_timing_field_count; i++)
        if (!imki_numbers_equal(&imki_timing_fields[i], a, b, 1, true))
            return false;
    return true;
}

static imk_status take_timing(const imki_join *join, int chosen, imk_error *error)
{
    int *from = &join->joined->timing_from;
    *from = chosen;
    for (int i = 0; i < (int)join->count && chosen == IMK_JOIN_ANY; i++) {
        const imk_timing *timing = &join->part[i].model->timing;
        if (!is_used(join, i) || !states_timing(timing))
            continue;
        if (*from >= 0 && !equal_timings(&join->part[*from].model->timing, timing))
            return imki_join_conflict(join, "timing", *from, i, only_one, error);
        *from = *from < 0 ? i : *from;
    }
    if (*from >= 0)
        join->unit->timing = join->part[*from].model->timing;
    return IMK_OK;
}

static void take_residual(const imki_join *join)
{
    const char *residual = NULL;
    bool differs = false;
    for (int i = 0; i < (int)join->count; i++)
        if (is_used(join, i)) {
            const char *of = join->part[i].model->residual_of;
            differs = differs || (residual && strcmp(of, residual) != 0);
            residual = of;
        }
    if (differs)
        imki_join_tell(join->joined, IMK_JOIN_RESIDUAL_LOST, -1, -1, "residual_of");
    else if (residual)
        imki_copy_text(join->unit->residual_of, sizeof join->unit->residual_of, residual);
}

/* Gyros and accelerometers, or these and magnetometers, of different parts. */
static void tell_parallel(const imki_join *join)
{
    int first = -1;
    for (int sensor = 0; sensor < IMK_KINDS; sensor++)
        for (int k = 0; k < 3 && join->joined->from[sensor][k] >= 0; k++) {
            if (first >= 0 && join->joined->from[sensor][k] != first && k == 0) {
                imki_join_tell(join->joined, IMK_JOIN_PARALLEL, sensor, -1, "");
                return;
            }
            first = join->joined->from[sensor][k];
        }
}

/* ---- correlations ---------------------------------------------------------------------------- */

/* Where a parameter of a part is in the unit. @return false: its sensor is not taken */
static bool moved(const imki_join *join, int part, imk_model_parameter *parameter)
{
    const imk_join_part *p = &join->part[part];
    const int *from = join->joined->from[parameter->sensor];
    int row, turn;
    if (p->axis == IMK_JOIN_WHOLE)
        return from[0] == part;
    if (from[p->axis] != part || imki_join_row(p, parameter->sensor, &row, &turn, NULL) != IMK_OK ||
        parameter->axis != row)
        return false;
    parameter->axis = (uint8_t)p->axis;
    parameter->element =
        (uint8_t)imki_turned_element(imki_term_field(parameter->term), parameter->element, turn);
    return true;
}

static float *value_at(imk_correlation *correlation, int i, int j)
{
    return &correlation->value[i * (i - 1) / 2 + j];
}

static void take_correlation(const imki_join *join, int part)
{
    const imk_correlation *from = &join->part[part].model->correlation;
    imk_correlation *to = &join->unit->correlation;
    int place[IMK_CORRELATED_MAX], count = to->count;
    imk_model_parameter parameter[IMK_CORRELATED_MAX];
    for (int i = 0; i < from->count; i++) {
        parameter[i] = from->parameter[i];
        place[i] = moved(join, part, &parameter[i]) ? count++ : -1;
    }
    if (count > IMK_CORRELATED_MAX) {
        imki_join_tell(join->joined, IMK_JOIN_CORRELATION_LOST, -1, part, "correlation");
        return;
    }
    for (int i = 0; i < from->count; i++) {
        if (place[i] < 0)
            continue;
        to->parameter[place[i]] = parameter[i];
        for (int j = 0; j < place[i]; j++)
            *value_at(to, place[i], j) = 0;
        for (int j = 0; j < i; j++)
            if (place[j] >= 0)
                *value_at(to, place[i], place[j]) = from->value[i * (i - 1) / 2 + j];
    }
    to->count = count;
}

/* ---- all ------------------------------------------------------------------------------------- */

static imk_status check_parts(size_t count, const imk_join_part *part,
                              const imk_join_settings *settings, imk_error *error)
{
    imk_status status = IMK_OK;
    if (count == 0 || !part)
        return imk_error_set(error, IMK_ERROR_EMPTY, "part", NULL, "models to join");
    if (count > IMK_JOIN_MAX)
        return imki_refuse(error, IMK_ERROR_RANGE, "count", (double)count, IMK_JOIN_MAX, NULL);
    for (size_t i = 0; i < count && status == IMK_OK; i++) {
        if (!part[i].model || !part[i].name)
            return imk_error_set(error, IMK_ERROR_ARGUMENT, "part", NULL, "a model and its name");
        if (part[i].axis < IMK_JOIN_WHOLE || part[i].axis > 2)
            return imki_refuse(error, IMK_ERROR_RANGE, "part.axis", part[i].axis, 2, NULL);
        status = imk_model_validate(part[i].model, error);
    }
    if (status != IMK_OK)
        return status;
    if (settings->cookie != settings_cookie)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, "settings", NULL,
                             "imk_join_default()");
    for (int k = 0; k <= IMK_KINDS; k++) {
        const int from = k < IMK_KINDS ? settings->from[k] : settings->timing_from;
        if (from < IMK_JOIN_ANY || from >= (int)count)
            return imki_refuse(error, IMK_ERROR_RANGE, "settings.from", from, (double)count, NULL);
    }
    return IMK_OK;
}

imk_status imk_model_join(size_t count, const imk_join_part *part,
                          const imk_join_settings *settings, imk_model *unit, imk_joined *joined,
                          imk_error *error)
{
    const imk_join_settings usual = imk_join_default();
    imk_joined unseen;
    const imki_join join = {count, part, unit, joined ? joined : &unseen};
    settings = settings ? settings : &usual;
    imk_status status = check_parts(count, part, settings, error);
    if (status != IMK_OK)
        return status;
    *join.joined = (imk_joined){.timing_from = -1};
    imk_model_default(unit);
    for (int sensor = 0; sensor < IMK_KINDS && status == IMK_OK; sensor++)
        status = choose(&join, sensor, settings->from[sensor], error);
    if (status == IMK_OK)
        status = take_sensors(&join, error);
    if (status == IMK_OK)
        status = take_timing(&join, settings->timing_from, error);
    if (status != IMK_OK)
        return status;
    imki_copy_text(unit->name, sizeof unit->name, settings->name ? settings->name : "joined");
    take_residual(&join);
    tell_parallel(&join);
    for (int i = 0; i < (int)count; i++)
        take_correlation(&join, i);
    return imk_model_validate(unit, error);
}
