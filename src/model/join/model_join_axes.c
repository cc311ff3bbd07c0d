/* SPDX-License-Identifier: Apache-2.0 */
/* Three sensors along x, y and z from three models. Numbers of an axis go over as they are; what a
 * triad has once (time of a warm-up, reference of a polynomial) has to agree. */
#include "model_join_internal.h"

#include "base/text_internal.h"
#include "model/model_internal.h"
#include "model/model_schema_internal.h"

#include "imukit/model_unstated.h"

#include <stddef.h>
#include <string.h>

/* The sensor that an axis comes from. */
typedef struct origin {
    const imk_triad *triad;
    int part, axis, row, turn;
} origin;

/* The body axis along which it is; -1: none. */
static int along(const double e[3])
{
    for (int k = 0; k < 3; k++)
        if (e[k] == 1 && e[(k + 1) % 3] == 0 && e[(k + 2) % 3] == 0)
            return k;
    return -1;
}

imk_status imki_join_row(const imk_join_part *part, int sensor, int *row, int *turn,
                         imk_error *error)
{
    const imk_triad *triad = imk_model_triad(part->model, sensor);
    bool fits = triad->axis_count == 1 || triad->axis_count == 3;
    for (int i = 0; fits && i < triad->axis_count; i++)
        fits = triad->axis_count == 1 ? along(triad->direction[i]) >= 0
                                      : along(triad->direction[i]) == i;
    if (!fits)
        return imk_error_set(error, IMK_ERROR_UNSUPPORTED, imki_kind_names[sensor], part->name,
                             "a model of one sensor along a body axis, or of three along x, y and "
                             "z, to take an axis from");
    *row = triad->axis_count == 1 ? 0 : part->axis;
    *turn = triad->axis_count == 1 ? (part->axis + 3 - along(triad->direction[0])) % 3 : 0;
    return IMK_OK;
}

/* ---- fields ---------------------------------------------------------------------------------- */

static void copy_numbers(const imki_field *field, void *to, const void *from, const origin *o)
{
    const int length = imki_row_length(field->shape);
    double *value = (double *)(void *)((char *)to + field->offset);
    const double *given = imki_field_values(field, from);
    for (int k = 0; k < length; k++) {
        const int at = o->axis * length + imki_turned_element(field, k, o->turn);
        value[at] = given[o->row * length + k];
        if (field->shape != IMKI_PENDULOUS) /* the sigmas stand behind the values */
            value[IMK_AXES_MAX * length + at] = given[(IMK_AXES_MAX + o->row) * length + k];
    }
}

static void copy_list(const imki_field *field, imk_triad *to, const origin *o)
{
    const imki_list list = imki_list_of(field);
    const int count = imki_list_count(field, o->triad);
    for (int i = 0; i < count; i++)
        for (size_t j = 0; j < list.field_count; j++)
            copy_numbers(&list.field[j], (char *)to + field->offset + (size_t)i * list.size,
                         imki_list_element(field, o->triad, i), o);
    if (count > imki_list_count(field, to))
        memcpy((char *)to + field->count_offset, &count, sizeof count);
}

static bool has_any(const imk_temperature_polynomial *polynomial, int row)
{
    for (int k = 0; k < polynomial->order; k++)
        if (polynomial->coefficient[k].value[row] != 0 ||
            polynomial->coefficient[k].sigma[row] != 0)
            return true;
    return false;
}

/* @param first  the part that has given the polynomial's reference; -1: none yet */
static imk_status copy_polynomial(const imki_join *join, const imki_field *field, int sensor,
                                  imk_triad *to, const origin *o, int *first, imk_error *error)
{
    const imk_temperature_polynomial *from = (const void *)((const char *)o->triad + field->offset);
    imk_temperature_polynomial *polynomial = (void *)((char *)to + field->offset);
    const bool binds = has_any(from, o->row);
    if (!binds && (*first >= 0 || from->order == 0))
        return IMK_OK;
    if (*first < 0) { /* of an axis without numbers only while no other has any */
        *first = binds ? o->part : -1;
        polynomial->reference = from->reference;
        polynomial->minimum = from->minimum;
        polynomial->maximum = from->maximum;
    } else if (polynomial->reference != from->reference ||
               !(fmax(polynomial->minimum, from->minimum) <
                 fmin(polynomial->maximum, from->maximum))) {
        return imki_join_conflict(join, field->path[sensor], *first, o->part,
                                  "the same reference_temperature, and ranges that overlap", error);
    } else if (polynomial->minimum != from->minimum || polynomial->maximum != from->maximum) {
        imki_join_tell(join->joined, IMK_JOIN_RANGE_NARROWED, sensor, -1, field->path[sensor]);
        polynomial->minimum = fmax(polynomial->minimum, from->minimum);
        polynomial->maximum = fmin(polynomial->maximum, from->maximum);
    }
    polynomial->order = from->order > polynomial->order ? from->order : polynomial->order;
    for (int k = 0; k < from->order; k++) {
        polynomial->coefficient[k].value[o->axis] = from->coefficient[k].value[o->row];
        polynomial->coefficient[k].sigma[o->axis] = from->coefficient[k].sigma[o->row];
    }
    return IMK_OK;
}

/* A time that the triad has once, of the term to which it belongs: it binds where an axis has this
 * term. */
static imk_status copy_time(const imki_join *join, const imki_field *field, int sensor,
                            imk_triad *to, const origin *o, int *first, imk_error *error)
{
    const bool warm_up = field->offset == offsetof(imk_triad, bias.warm_up_time);
    const imk_axes *size =
        warm_up ? &o->triad->bias.warm_up_amplitude : &o->triad->noise.bias_instability;
    const imk_scalar *time = (const void *)((const char *)o->triad + field->offset);
    imk_scalar *joined = (void *)((char *)to + field->offset);
    const bool binds = size->value[o->row] != 0 || size->sigma[o->row] != 0;
    if (!binds && (*first >= 0 || time->value == 0))
        return IMK_OK;
    if (*first >= 0 && joined->value != time->value)
        return imki_join_conflict(join, field->path[sensor], *first, o->part,
                                  "one time for all axes: it is one number of a model", error);
    *first = binds ? o->part : -1;
    *joined = *time;
    return IMK_OK;
}

static imk_status copy_field(const imki_join *join, const imki_field *field, int sensor,
                             imk_triad *to, const origin origins[3], imk_error *error)
{
    imk_status status = IMK_OK;
    int first = -1;
    for (int axis = 0; axis < 3 && status == IMK_OK; axis++) {
        const origin *o = &origins[axis];
        switch (field->shape) {
        case IMKI_DIRECTION:
            to->direction[axis][axis] = 1;
            break;
        case IMKI_DENSITY:
            to->noise.density = axis == 0 || o->triad->noise.density == to->noise.density
                                    ? o->triad->noise.density
                                    : IMK_DENSITY_UNSTATED;
            break;
        case IMKI_SCALAR:
            status = copy_time(join, field, sensor, to, o, &first, error);
            break;
        case IMKI_POLYNOMIAL:
            status = copy_polynomial(join, field, sensor, to, o, &first, error);
            break;
        case IMKI_LIST:
            copy_list(field, to, o);
            break;
        default:
            copy_numbers(field, to, o->triad, o);
        }
    }
    return status;
}

/* ---- what is said about them ----------------------------------------------------------------- */

static bool lacks(const imk_unstated *unstated, int sensor, const char *key)
{
    for (size_t i = 0; i < unstated->count; i++)
        if (unstated->term[i].sensor == sensor && strcmp(unstated->term[i].key, key) == 0)
            return true;
    return false;
}

/* A term that one axis states and another does not would look like a zero of that one. */
static void tell_unstated(const imki_join *join, int sensor, const origin origins[3])
{
    imk_unstated of[3];
    for (int axis = 0; axis < 3; axis++)
        imk_model_unstated(join->part[origins[axis].part].model, &of[axis]);
    for (int axis = 0; axis < 3; axis++)
        for (size_t i = 0; i < of[axis].count; i++) {
            const char *key = of[axis].term[i].key;
            const bool other = !lacks(&of[(axis + 1) % 3], sensor, key) ||
                               !lacks(&of[(axis + 2) % 3], sensor, key);
            if (of[axis].term[i].sensor == sensor && other)
                imki_join_tell(join->joined, IMK_JOIN_AXIS_UNSTATED, sensor, origins[axis].part,
                               key);
        }
}

static const imk_interval *interval_of(const imk_evidence *evidence, const imk_interval *like)
{
    for (int i = 0; i < evidence->interval_count; i++)
        if (evidence->interval[i].instance == like->instance &&
            strcmp(evidence->interval[i].key, like->key) == 0)
            return &evidence->interval[i];
    return NULL;
}

static void join_intervals(const imki_join *join, int sensor, const origin origins[3],
                           const imk_evidence *const evidence[3], imk_evidence *to)
{
    for (int axis = 0; axis < 3; axis++)
        for (int i = 0; i < evidence[axis]->interval_count; i++) {
            const imk_interval *like = &evidence[axis]->interval[i], *of[3];
            bool all = true;
            for (int k = 0; k < 3; k++) {
                of[k] = interval_of(evidence[k], like);
                all = all && of[k];
            }
            if (all && axis > 0)
                continue; /* it is there */
            imk_interval *added =
                all ? imki_evidence_interval(to, like->key, like->instance) : NULL;
            if (!added)
                imki_join_tell(join->joined, IMK_JOIN_INTERVAL_LOST, sensor, -1, like->key);
            for (int k = 0; k < 3 && added; k++) {
                added->lower.value[k] = of[k]->lower.value[origins[k].row];
                added->upper.value[k] = of[k]->upper.value[origins[k].row];
            }
        }
}

/* The text that all have, or "x: …; y: …; z: …" as far as there is room. */
static void join_texts(const char *const text[3], char *to, size_t size)
{
    static const char *const axes[] = {"x: ", "; y: ", "; z: "};
    to[0] = '\0';
    if (strcmp(text[0], text[1]) == 0 && strcmp(text[0], text[2]) == 0) {
        imki_copy_text(to, size, text[0]);
        return;
    }
    for (int k = 0; k < 3; k++) {
        imki_append_text(to, size, axes[k]);
        imki_append_text(to, size, text[k][0] ? text[k] : "not stated");
    }
}

static void join_evidence(const imki_join *join, int sensor, const origin origins[3])
{
    const imk_evidence *evidence[3];
    imk_evidence *to = imki_join_evidence(join->unit, sensor);
    const char *source[3], *method[3];
    for (int k = 0; k < 3; k++) {
        evidence[k] = imki_join_evidence_of(join->part[origins[k].part].model, sensor);
        source[k] = evidence[k]->source;
        method[k] = evidence[k]->method;
    }
    join_texts(source, to->source, sizeof to->source);
    join_texts(method, to->method, sizeof to->method);
    if (strcmp(evidence[0]->frame, evidence[1]->frame) == 0 &&
        strcmp(evidence[0]->frame, evidence[2]->frame) == 0)
        imki_copy_text(to->frame, sizeof to->frame, evidence[0]->frame);
    else
        imki_join_tell(join->joined, IMK_JOIN_FRAME_LOST, sensor, -1, "");
    join_intervals(join, sensor, origins, evidence, to);
}

imk_status imki_join_axes(const imki_join *join, int sensor, imk_error *error)
{
    imk_triad *to = imk_model_triad_to_set(join->unit, sensor);
    origin origins[3];
    imk_status status = IMK_OK;
    memset(to, 0, sizeof *to);
    to->present = true;
    to->axis_count = 3;
    to->stated_zero = UINT64_MAX;
    for (int axis = 0; axis < 3 && status == IMK_OK; axis++) {
        origin *o = &origins[axis];
        *o = (origin){.part = join->joined->from[sensor][axis], .axis = axis};
        o->triad = imk_model_triad(join->part[o->part].model, sensor);
        status = imki_join_row(&join->part[o->part], sensor, &o->row, &o->turn, error);
        to->stated_zero &= o->triad->stated_zero;
    }
    for (size_t i = 0; i < imki_triad_field_count && status == IMK_OK; i++)
        if (!(imki_triad_fields[i].flags & IMKI_FLOOR))
            status = copy_field(join, &imki_triad_fields[i], sensor, to, origins, error);
    if (status != IMK_OK)
        return status;
    if (sensor != IMK_MAG)
        tell_unstated(join, sensor, origins);
    join_evidence(join, sensor, origins);
    return IMK_OK;
}
