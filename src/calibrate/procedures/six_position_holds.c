/* SPDX-License-Identifier: Apache-2.0 */
/* Holds of a log, and which axis points up or down in each.
 *
 * A hold shows the face whose axis carries nearly all of the force. Where counts have no known
 * sensitivity, the middle and half the distance of each axis's extremes stand for its zero and for
 * gravity, as they are when every face was held:
 *
 *     u_i = (reading_i - (max_i + min_i)/2) / ((max_i - min_i)/2) */
#include "base/refuse_internal.h"
#include "base/text_internal.h"
#include "base/workspace_internal.h"
#include "six_position_internal.h"

#include "imukit/attitude.h"
#include "imukit/samples.h"

#include <math.h>
#include <string.h>

enum { DETECTED_MAX = 512, TURNS_MAX = DETECTED_MAX, FACES = 6 };

/* cos 37 deg: between a face and an edge of the cube, which is at 45 deg. */
static const double face_share = 0.8;
/* An axis whose extremes are this much closer than the widest was not held both ways. */
static const double both_ways = 0.7;
/* A mean this near to the end of the range has samples beyond it. */
static const double of_range = 0.999;

/* ---- stretches --------------------------------------------------------------------------------
 */

static size_t section_runs(const imk_test_record *record)
{
    size_t runs = 0;
    for (size_t k = 0; record->section && k < record->count; k++)
        runs += record->section[k] >= 0 &&
                (k == 0 || record->means || record->section[k] != record->section[k - 1]);
    return runs;
}

static const char *label_of(const imk_test_record *record, size_t k)
{
    const int s = record->section[k];
    return s >= 0 && (size_t)s < record->section_count ? record->section_name[s] : NULL;
}

/* Sections are used when their labels say something about axes, or are many enough to be holds. */
static bool sections_tell(const imk_test_record *record)
{
    if (!record->section)
        return false;
    for (size_t i = 0; i < record->section_count; i++)
        if (record->section_name[i] && imki_label_parse(record->section_name[i]).axis >= 0)
            return true;
    return section_runs(record) >= FACES;
}

static size_t list_capacity(const imk_test_record *record)
{
    return sections_tell(record) ? section_runs(record) : DETECTED_MAX + TURNS_MAX;
}

size_t imki_stretches_workspace(const imk_test_record *record,
                                const imk_procedure_settings *settings)
{
    size_t size = IMKI_ALIGNMENT_SLACK + list_capacity(record) * sizeof(imki_session_stretch);
    if (!sections_tell(record))
        size += DETECTED_MAX * sizeof(imk_static_interval) + IMKI_ALIGNMENT_SLACK +
                imk_static_workspace_size(record, &settings->stationary);
    return size;
}

/* A section as a stretch: holds without what is trimmed. @return false: left out */
static bool section_stretch(const imk_test_record *record, const imk_procedure_settings *settings,
                            size_t begin, size_t end, imki_session_stretch *stretch)
{
    const char *text = label_of(record, begin);
    const imki_label label = imki_label_parse(text ? text : "");
    if (label.kind == IMKI_LABEL_OTHER)
        return false;
    const bool turn = label.kind == IMKI_LABEL_TURN;
    if (turn && record->means)
        return false;
    if (!turn && !record->means) {
        const size_t tail = imk_samples_in(settings->trim, record->dt);
        const size_t head = imk_samples_in(settings->trim + settings->settle, record->dt);
        if ((double)(end - begin) * record->dt <
            settings->minimum + 2.0 * settings->trim + settings->settle)
            return false;
        begin += head;
        end -= tail;
    }
    if (begin >= end)
        return false;
    memset(stretch, 0, sizeof *stretch);
    stretch->at = (imk_ferraris_stretch){turn, begin, end, label.axis,
                                         turn && label.sense == 0 ? 1 : label.sense};
    stretch->label = text;
    stretch->summary = imk_static_summary(record, begin, end);
    return true;
}

static void list_sections(const imk_test_record *record, const imk_procedure_settings *settings,
                          imki_session_stretches *list)
{
    for (size_t k = 0; k < record->count;) {
        size_t end = k + 1;
        while (!record->means && end < record->count && record->section[end] == record->section[k])
            end++;
        if (record->section[k] >= 0) {
            list->found++;
            if (section_stretch(record, settings, k, end, &list->stretch[list->count]))
                list->count++;
            else
                list->left_out++;
        }
        k = end;
    }
}

static imk_status list_detected(const imk_test_record *record,
                                const imk_procedure_settings *settings, const imk_model *model,
                                char *workspace, size_t size, imki_session_stretches *list,
                                imk_static_findings *stationary, imk_error *error)
{
    imk_static_interval *interval = (imk_static_interval *)(void *)workspace;
    size_t count = 0;
    const size_t used = DETECTED_MAX * sizeof *interval;
    const imk_status status =
        imk_static_detect(record, &settings->stationary, model, interval, DETECTED_MAX, &count,
                          NULL, stationary, workspace + used, size - used, error);
    if (status != IMK_OK)
        return status;
    list->detected = true;
    list->found = count;
    if (count > DETECTED_MAX)
        count = DETECTED_MAX;
    for (size_t i = 0; i < count; i++) {
        imki_session_stretch *stretch = &list->stretch[list->count++];
        memset(stretch, 0, sizeof *stretch);
        stretch->at = (imk_ferraris_stretch){false, interval[i].begin, interval[i].end, -1, 0};
        stretch->summary = interval[i];
    }
    return IMK_OK;
}

/* ---- faces --------------------------------------------------------------------------------------
 */

static const char *const face_names[FACES] = {"x up", "x down", "y up", "y down", "z up", "z down"};

static int face_number(int axis, int sense)
{
    return 2 * axis + (sense < 0);
}

/* What turns the readings of a hold into a direction. */
typedef struct yardstick {
    bool known;                /* readings have a unit */
    imk_matrix3 from_axes;     /* body components from what the axes sense */
    double middle[3], half[3]; /* of the extremes; half 0: not held both ways */
    const imk_test_record *record;
    const imk_model *model;
} yardstick;

/* Unit vector along the force. @return false: not a number, or, where an axis was not held both
 * ways, what is left without it */
static bool direction_of(const yardstick *y, const imki_session_stretch *hold, double u[3])
{
    imk_vector3 sensed;
    for (int i = 0; i < 3; i++) {
        const double mean = hold->summary.mean[IMK_ACCEL][i];
        if (y->known)
            sensed.v[i] = imki_reading_si(y->model, y->record, IMK_ACCEL, i, mean);
        else
            sensed.v[i] = y->half[i] > 0.0 ? (mean - y->middle[i]) / y->half[i] : 0.0;
    }
    const imk_vector3 body = imk_matrix3_apply(y->from_axes, sensed);
    const double norm = imk_vector3_norm(body);
    for (int i = 0; i < 3; i++)
        u[i] = body.v[i] / norm;
    return norm > (y->known ? 0.0 : face_share) && isfinite(norm);
}

static void measure_extremes(yardstick *y, const imki_session_stretches *list)
{
    double low[3], high[3], widest = 0.0;
    for (int i = 0; i < 3; i++) {
        low[i] = (double)INFINITY;
        high[i] = -(double)INFINITY;
        for (size_t k = 0; k < list->count; k++)
            if (!list->stretch[k].at.turn) {
                low[i] = fmin(low[i], list->stretch[k].summary.mean[IMK_ACCEL][i]);
                high[i] = fmax(high[i], list->stretch[k].summary.mean[IMK_ACCEL][i]);
            }
        y->middle[i] = 0.5 * (high[i] + low[i]);
        y->half[i] = isfinite(high[i] - low[i]) ? 0.5 * (high[i] - low[i]) : 0.0;
        widest = fmax(widest, y->half[i]);
    }
    for (int i = 0; i < 3; i++)
        if (!(y->half[i] > both_ways * widest))
            y->half[i] = 0.0;
}

/* Nominal sensitivity and zero from the extremes. One number for three axes of a part; the zero
 * stays 0 unless readings are plainly offset, as those of unsigned converters are. */
static void nominal_counts(const yardstick *y, double gravity, imki_session_stretches *list)
{
    double sum = 0.0;
    bool offset = false;
    int axes = 0;
    for (int i = 0; i < 3; i++) {
        sum += y->half[i] / gravity;
        axes += y->half[i] > 0.0;
        offset = offset || fabs(y->middle[i]) > y->half[i];
    }
    for (int i = 0; i < 3; i++) {
        list->sensitivity[i] = axes > 0 ? imki_round_digits(sum / axes, 3) : 0.0;
        list->zero_offset[i] = offset ? rint(y->middle[i]) : 0.0;
    }
}

static bool saturated(const yardstick *y, const imki_session_stretch *hold)
{
    const double *range = y->model->accel.range.value;
    for (int i = 0; y->known && i < 3; i++)
        if (range[i] > 0.0 &&
            fabs(imki_reading_si(y->model, y->record, IMK_ACCEL, i,
                                 hold->summary.mean[IMK_ACCEL][i])) >= of_range * range[i])
            return true;
    return false;
}

static void count_contradiction(imki_session_stretches *list, const imki_session_stretch *hold,
                                int axis, int sense)
{
    if (list->contradictions++ > 0)
        return;
    list->contradicted = *hold;
    list->contradicted.at.axis = axis;
    list->contradicted.at.sense = sense;
}

/* Give a hold its face. What the label says stands, unless the readings show another.
 * @return false: it shows none, or the label contradicts, which is counted */
static bool settle_face(const yardstick *y, imki_session_stretch *hold,
                        imki_session_stretches *list)
{
    double u[3];
    const bool seen = direction_of(y, hold, u);
    for (int i = 0; i < 3; i++)
        if (!isfinite(hold->summary.mean[IMK_ACCEL][i]))
            return false;
    if (saturated(y, hold))
        return false;
    int axis = 0;
    for (int i = 1; i < 3; i++)
        if (fabs(u[i]) > fabs(u[axis]))
            axis = i;
    const int sense = u[axis] > 0.0 ? 1 : -1;
    const bool plain = seen && fabs(u[axis]) >= face_share;
    imk_ferraris_stretch *at = &hold->at;
    if (plain && ((at->axis >= 0 && at->axis != axis) || (at->sense != 0 && at->sense != sense))) {
        count_contradiction(list, hold, axis, sense);
        return false;
    }
    if (!plain && (at->axis < 0 || at->sense == 0))
        return false;
    if (at->axis < 0 || at->sense == 0) {
        at->axis = axis;
        at->sense = sense;
    }
    return true;
}

/* Labels of more than a quarter of the holds say something else than the readings: it is not the
 * odd mistake, but axes that are swapped or turned round, or another meaning of the words. */
static imk_status contradicted(const imki_session_stretches *list, size_t holds, imk_error *error)
{
    const imk_ferraris_stretch *at = &list->contradicted.at;
    const imk_status status = imk_error_set(
        error, IMK_ERROR_CONFLICT, "section", list->contradicted.label,
        "label each hold by the axis that reads gravity (x_up where accel_x is largest), or, if "
        "columns are swapped or inverted, map them with --axes");
    if (error) {
        error->index = face_number(at->axis, at->sense);
        error->value = (double)list->contradictions;
        error->limit = (double)holds;
    }
    return status;
}

static imk_status settle_faces(const yardstick *y, imki_session_stretches *list, imk_error *error)
{
    size_t kept = 0, holds = 0;
    for (size_t k = 0; k < list->count; k++) {
        imki_session_stretch stretch = list->stretch[k];
        holds += !stretch.at.turn;
        if (stretch.at.turn || settle_face(y, &stretch, list))
            list->stretch[kept++] = stretch;
        else
            list->left_out++;
    }
    list->count = kept;
    return 4 * list->contradictions > holds ? contradicted(list, holds, error) : IMK_OK;
}

static imk_status yardstick_of(yardstick *y, const imk_test_record *record, const imk_model *model,
                               imk_error *error)
{
    const imk_triad *accel = &model->accel;
    *y = (yardstick){.known = imki_unit_known(model, record, IMK_ACCEL),
                     .from_axes = imk_matrix3_identity(),
                     .record = record,
                     .model = model};
    if (record->axis_count[IMK_ACCEL] == 0)
        return imk_error_set(error, IMK_ERROR_KEY_MISSING, "accel", NULL, "three accelerometers");
    if (record->axis_count[IMK_ACCEL] != 3 || (accel->present && accel->axis_count != 3))
        return imk_error_set(error, IMK_ERROR_UNSUPPORTED, "accel", NULL,
                             "three accelerometers; use multiposition or tumble for other sets");
    if (accel->present) {
        imk_matrix3 directions;
        memcpy(directions.m, accel->direction, sizeof directions.m);
        if (imk_matrix3_inverse(directions, &y->from_axes) != IMK_OK)
            return imk_error_set(error, IMK_ERROR_SINGULAR, "accel.direction", NULL,
                                 "three directions that do not lie in one plane");
    }
    return IMK_OK;
}

imk_status imki_stretches_find(const imk_test_record *record,
                               const imk_procedure_settings *settings, const imk_model *model,
                               double gravity, void *workspace, size_t workspace_size,
                               imki_session_stretches *list, imk_static_findings *stationary,
                               imk_error *error)
{
    yardstick y;
    imk_status status = yardstick_of(&y, record, model, error);
    if (status != IMK_OK)
        return status;
    const size_t needed = imki_stretches_workspace(record, settings);
    if (workspace_size < needed) {
        return imki_refuse(error, IMK_ERROR_WORKSPACE, "workspace", (double)needed,
                           (double)workspace_size, NULL);
    }
    char *aligned = (char *)imki_align(workspace);
    memset(list, 0, sizeof *list);
    list->capacity = list_capacity(record);
    list->stretch = (imki_session_stretch *)(void *)aligned;
    const size_t used = list->capacity * sizeof *list->stretch;
    if (sections_tell(record))
        list_sections(record, settings, list);
    else
        status = list_detected(record, settings, model, aligned + used,
                               workspace_size - used - (size_t)(aligned - (char *)workspace), list,
                               stationary, error);
    if (status != IMK_OK)
        return status;
    if (!y.known) {
        measure_extremes(&y, list);
        nominal_counts(&y, gravity, list);
    }
    return settle_faces(&y, list, error);
}

/* ---- all six? ---------------------------------------------------------------------------------
 */

imk_status imki_faces_complete(const imki_session_stretches *list, imk_error *error)
{
    bool seen[FACES] = {false};
    int faces = 0;
    for (size_t k = 0; k < list->count; k++) {
        const imk_ferraris_stretch *at = &list->stretch[k].at;
        if (!at->turn)
            seen[face_number(at->axis, at->sense)] = true;
    }
    char missing[160] = "add a hold with ";
    bool first = true;
    for (int f = 0; f < FACES; f++) {
        faces += seen[f];
        if (seen[f])
            continue;
        imki_append_text(missing, sizeof missing, first ? "" : ", ");
        imki_append_text(missing, sizeof missing, face_names[f]);
        first = false;
    }
    if (faces == FACES)
        return IMK_OK;
    if (list->contradictions > 0) {
        const imk_ferraris_stretch *at = &list->contradicted.at;
        imki_append_text(missing, sizeof missing, ", or correct the label ");
        imki_append_text(missing, sizeof missing, list->contradicted.label);
        imki_append_text(missing, sizeof missing, " of a hold that reads ");
        imki_append_text(missing, sizeof missing, face_names[face_number(at->axis, at->sense)]);
    }
    return imki_refuse(error, IMK_ERROR_TOO_SHORT, "hold", faces, FACES, missing);
}
