/* SPDX-License-Identifier: Apache-2.0 */
/* Rests and turns of a log of gyros: by the labels of sections, or by the times at rest.
 *
 * A label names a turn when it states an angle ("z -90deg"), says so ("x rot"), or names an axis
 * and neither up nor down ("y"); every other label is a rest. Where no label is a rest, and where
 * there are no labels, rests are detected. Without labels a turn is a move from one rest to the
 * next about one axis, by the angle stated. What the gyros read between is taken less the mean of
 * the rests before and after, so that neither a bias nor the Earth nor a g-sensitivity has a part
 * in it. */
#include "turns_internal.h"

#include "base/refuse_internal.h"
#include "base/workspace_internal.h"
#include "calibrate/standstill/static_internal.h"
#include "imukit/samples.h"
#include "imukit/units.h"

#include <math.h>
#include <string.h>

enum { DETECTED_MAX = 512 };

/* As of a turn of ferraris: misalignment and the tilt of a hand are less. */
static const double slack = 0.3;
/* Moves that are told although they are none of the turns: about half of the angle, or more. */
static const double half_least = 0.4, half_most = 0.6;
/* A gyro this near to the end of its range is beyond it in some samples. */
static const double of_range = 0.999;

/* ---- labels ----------------------------------------------------------------------------------
 */

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

static bool is_letter(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (unsigned char)c > 0x7f;
}

/* Behind a number and its unit. */
static const char *end_of_quantity(const char *c)
{
    while (is_digit(*c) || *c == '.')
        c++;
    while (*c == ' ')
        c++;
    while (is_letter(*c))
        c++;
    return c;
}

/* "-90deg" in "z -90deg". In "z-90deg" the sign may be a hyphen.
 * @param sign  -1 or 1; 0: not stated
 * @return size of the angle [rad]; NaN: there is none with a unit */
static double angle_of_label(const char *text, int *sign)
{
    const imk_dimension of_angle = imk_unit_of("rad").dimension;
    double angle, sigma;
    size_t count;
    *sign = 0;
    for (const char *c = text; *c; c++) {
        const char before = c > text ? c[-1] : ' ', further = c > text + 1 ? c[-2] : ' ';
        if (!is_digit(*c) || is_digit(before) || before == '.' ||
            imk_quantity_parse(c, end_of_quantity(c), of_angle, 1, &angle, &sigma, &count, NULL,
                               NULL) != IMK_OK)
            continue;
        if (!is_letter(further) && !is_digit(further))
            *sign = before == '-' ? -1 : before == '+' ? 1 : 0;
        return angle;
    }
    return (double)NAN;
}

typedef struct label {
    bool turn, other;
    int axis;
    double angle; /* with sign, where it is stated */
    bool stated;  /* the direction */
} label;

static label label_of(const imk_test_record *record, size_t k, double usual)
{
    const int s = record->section[k];
    label l = {.axis = -1, .angle = usual};
    int sign;
    const char *text = (size_t)s < record->section_count ? record->section_name[s] : NULL;
    if (!text)
        return l;
    const imki_label read = imki_label_parse(text);
    const double angle = angle_of_label(text, &sign);
    if (sign == 0)
        sign = read.sense;
    l.other = read.kind == IMKI_LABEL_OTHER;
    l.turn = !l.other &&
             (!isnan(angle) || read.kind == IMKI_LABEL_TURN || (read.axis >= 0 && read.sense == 0));
    l.axis = read.axis;
    l.stated = sign != 0;
    l.angle = (sign < 0 ? -1.0 : 1.0) * (isnan(angle) ? usual : angle);
    return l;
}

static bool labels_name_turns(const imk_test_record *record)
{
    for (size_t i = 0; record->section && i < record->section_count; i++) {
        const int index = (int)i;
        const imk_test_record one = {.section = &index,
                                     .section_count = record->section_count,
                                     .section_name = record->section_name};
        if (label_of(&one, 0, 1.0).turn)
            return true;
    }
    return false;
}

static size_t end_of_section(const imk_test_record *record, size_t begin)
{
    size_t end = begin + 1;
    while (end < record->count && record->section[end] == record->section[begin])
        end++;
    return end;
}

static size_t section_runs(const imk_test_record *record)
{
    size_t runs = 0;
    for (size_t k = 0; k < record->count; k = end_of_section(record, k))
        runs += record->section[k] >= 0;
    return runs;
}

/* ---- memory ----------------------------------------------------------------------------------
 */

static imk_test_record without_accelerometers(const imk_test_record *record)
{
    imk_test_record gyros = *record;
    gyros.axis_count[IMK_ACCEL] = 0;
    return gyros;
}

static char *lay_out(const imk_test_record *record, imki_parts *parts, imki_turn_list *list)
{
    const size_t runs = labels_name_turns(record) ? section_runs(record) : 0;
    list->rest_capacity = DETECTED_MAX + runs;
    list->turn_capacity = DETECTED_MAX + runs;
    list->rest = imki_take(parts, list->rest_capacity * sizeof *list->rest);
    list->turn = imki_take(parts, list->turn_capacity * sizeof *list->turn);
    list->repeat = imki_take(parts, list->turn_capacity * sizeof *list->repeat);
    return imki_take(parts, 0);
}

size_t imki_turn_list_workspace(const imk_test_record *record,
                                const imk_procedure_settings *settings)
{
    const imk_test_record gyros = without_accelerometers(record);
    imki_turn_list unused;
    imki_parts parts = imki_parts_of(NULL);
    (void)lay_out(record, &parts, &unused);
    return imki_parts_size(&parts) + IMKI_ALIGNMENT_SLACK +
           imk_static_workspace_size(&gyros, &settings->stationary);
}

/* ---- rests -----------------------------------------------------------------------------------
 */

static imk_status detect_rests(const imki_procedure_call *call, imki_turn_list *list, char *memory,
                               size_t size)
{
    size_t count = 0;
    const imk_status status = imk_static_detect(
        &list->record, &call->settings->stationary, &call->calibration->model, list->rest,
        DETECTED_MAX, &count, NULL, &call->findings->stationary, memory, size, call->error);
    list->rest_count = count < DETECTED_MAX ? count : DETECTED_MAX;
    call->findings->intervals += count;
    return status;
}

/* Sections that are rests, less their ends. */
static void label_rests(const imki_procedure_call *call, imki_turn_list *list)
{
    const imk_procedure_settings *s = call->settings;
    const imk_test_record *record = &list->record;
    const size_t tail = imk_samples_in(s->trim, record->dt),
                 head = imk_samples_in(s->trim + s->settle, record->dt),
                 least = imk_samples_in(s->minimum, record->dt);
    for (size_t k = 0, end; k < record->count; k = end) {
        end = end_of_section(record, k);
        if (record->section[k] < 0)
            continue;
        const label l = label_of(record, k, s->turn_angle);
        if (l.turn || l.other)
            continue;
        call->findings->intervals++;
        imk_static_interval rest = {.begin = 0};
        if (end - k >= head + tail + least)
            rest = imk_static_summary(record, k + head, end - tail);
        bool finite = rest.end > rest.begin;
        for (int i = 0; i < record->axis_count[IMK_GYRO]; i++)
            finite = finite && isfinite(rest.mean[IMK_GYRO][i]);
        if (finite)
            list->rest[list->rest_count++] = rest;
        else
            call->findings->left_out++;
    }
}

/* ---- turns -----------------------------------------------------------------------------------
 */

static double mean_at(const imki_turn_list *list, size_t rest, int axis)
{
    return list->rest[rest].mean[IMK_GYRO][axis];
}

/* Rests around a turn; a label may begin and end in them. @return false: there is none */
static bool find_rests(const imki_turn_list *list, imki_known_turn *turn)
{
    const size_t none = list->rest_count, middle = turn->begin + (turn->end - turn->begin) / 2;
    turn->before = turn->after = none;
    for (size_t r = 0; r < list->rest_count; r++) {
        if (list->rest[r].end <= middle)
            turn->before = r;
        if (list->rest[r].begin >= middle && turn->after == none)
            turn->after = r;
    }
    if (turn->before == none)
        turn->before = turn->after;
    if (turn->after == none)
        turn->after = turn->before;
    return turn->before != none;
}

/* What the gyros read in it. @return false: a gap, or not a number */
static bool measure(const imki_turn_list *list, imki_known_turn *turn)
{
    const imki_turn_means means = imki_turn_mean(&list->record, turn->begin, turn->end);
    turn->duration = means.duration;
    turn->temperature = means.temperature;
    for (int i = 0; i < list->record.axis_count[IMK_GYRO]; i++) {
        const double before = mean_at(list, turn->before, i), after = mean_at(list, turn->after, i);
        turn->read[i] = means.reading[IMK_GYRO][i] - 0.5 * (before + after);
        turn->drift[i] = after - before;
    }
    return isfinite(means.duration);
}

/* Angle that a gyro reads, about its body axis. */
static double angle_read(const imki_turn_list *list, const imki_known_turn *turn, int axis)
{
    return turn->read[axis] * turn->duration / list->unit[axis] * list->sign[axis];
}

/* The gyro that reads the largest angle. @return false: others read much of it too */
static bool about_one_axis(const imki_turn_list *list, const imki_known_turn *turn, int *axis)
{
    bool one = true;
    *axis = 0;
    for (int i = 1; i < list->record.axis_count[IMK_GYRO]; i++)
        if (fabs(angle_read(list, turn, i)) > fabs(angle_read(list, turn, *axis)))
            *axis = i;
    const double most = fabs(angle_read(list, turn, *axis));
    for (int i = 0; i < list->record.axis_count[IMK_GYRO]; i++)
        one = one && (i == *axis || fabs(angle_read(list, turn, i)) < slack * most);
    return one;
}

/* Readings beyond which a gyro is saturated. @return false: there is no telling */
static bool ends_of_range(const imki_procedure_call *call, const imki_turn_list *list, int axis,
                          double *low, double *high)
{
    const imk_triad *gyro = &call->calibration->model.gyro;
    const imk_test_record *record = &list->record;
    const double *x = record->reading[IMK_GYRO][axis];
    if (gyro->range.value[axis] > 0.0 && list->known) {
        const double zero = record->counts[IMK_GYRO] ? gyro->zero_offset.value[axis] : 0.0;
        const double range = of_range * gyro->range.value[axis] * fabs(list->unit[axis]);
        *low = zero - range;
        *high = zero + range;
        return true;
    }
    const double step = imki_static_step(x, 0, record->count < 4096 ? record->count : 4096);
    if (step == 0.0 || !(list->rest[0].scatter[IMK_GYRO][axis] > step))
        return false;
    *low = HUGE_VAL;
    *high = -HUGE_VAL;
    for (size_t k = 0; k < record->count; k++) {
        *low = x[k] < *low ? x[k] : *low;
        *high = x[k] > *high ? x[k] : *high;
    }
    return true;
}

/* Three samples in a row at the end of what a gyro reads. */
static bool is_saturated(const imki_procedure_call *call, const imki_turn_list *list,
                         const imki_known_turn *turn)
{
    enum { IN_A_ROW = 3 };
    for (int i = 0; i < list->record.axis_count[IMK_GYRO]; i++) {
        const double *x = list->record.reading[IMK_GYRO][i];
        double low, high;
        int run = 0;
        if (!ends_of_range(call, list, i, &low, &high))
            continue;
        for (size_t k = turn->begin; k < turn->end; k++) {
            run = x[k] <= low || x[k] >= high ? run + 1 : 0;
            if (run == IN_A_ROW)
                return true;
        }
    }
    return false;
}

/* @param body  -1: about no one axis, or not that of the label */
static void tell_other(const imki_procedure_call *call, size_t begin, int body, double angle)
{
    imk_turns_findings *f = &call->findings->known_turns;
    if (f->other_moves++ > 0)
        return;
    f->other_begin = begin;
    f->other_axis = body;
    f->other_angle = angle;
}

static void keep(const imki_procedure_call *call, imki_turn_list *list, const imki_known_turn *turn)
{
    if (is_saturated(call, list, turn)) {
        call->findings->known_turns.saturated++;
        call->findings->left_out++;
        return;
    }
    if (list->turn_count < list->turn_capacity)
        list->turn[list->turn_count++] = *turn;
}

static void label_turns(const imki_procedure_call *call, imki_turn_list *list)
{
    const imk_test_record *record = &list->record;
    for (size_t k = 0, end; k < record->count; k = end) {
        end = end_of_section(record, k);
        if (record->section[k] < 0)
            continue;
        const label l = label_of(record, k, call->settings->turn_angle);
        imki_known_turn turn = {.begin = k, .end = end, .angle = l.angle, .stated = l.stated};
        if (!l.turn)
            continue;
        int axis;
        if (!find_rests(list, &turn) || !measure(list, &turn) || turn.angle == 0.0) {
            call->findings->known_turns.missing++;
            call->findings->left_out++;
            continue;
        }
        const bool one = about_one_axis(list, &turn, &axis);
        const double size = fabs(angle_read(list, &turn, axis));
        turn.body = list->body[axis];
        if (!one || (l.axis >= 0 && l.axis != turn.body) ||
            (list->known && size < slack * fabs(turn.angle))) {
            tell_other(call, k, one && l.axis == turn.body ? turn.body : -1,
                       angle_read(list, &turn, axis));
            if (one && l.axis >= 0 && l.axis != turn.body)
                call->findings->known_turns.other_gyro[l.axis][turn.body]++;
            call->findings->left_out++;
            continue;
        }
        if (!turn.stated && angle_read(list, &turn, axis) < 0.0)
            turn.angle = -turn.angle;
        keep(call, list, &turn);
    }
}

/* Moves between neighbouring rests; their angles are those read, their body axis is -1 where they
 * are about no one axis. */
static void list_moves(const imki_procedure_call *call, imki_turn_list *list)
{
    for (size_t r = 0; r + 1 < list->rest_count; r++) {
        imki_known_turn move = {.begin = list->rest[r].end,
                                .end = list->rest[r + 1].begin,
                                .before = r,
                                .after = r + 1};
        int axis;
        if (move.end <= move.begin)
            continue;
        if (!measure(list, &move)) {
            call->findings->known_turns.missing++;
            call->findings->left_out++;
            continue;
        }
        move.body = about_one_axis(list, &move, &axis) ? list->body[axis] : -1;
        move.angle = angle_read(list, &move, axis);
        list->turn[list->turn_count++] = move;
    }
}

static bool is_near(const imki_known_turn *move, double full)
{
    return move->body >= 0 && fabs(fabs(move->angle) - full) < slack * full;
}

static size_t moves_near(const imki_turn_list *list, double full)
{
    size_t count = 0;
    for (size_t k = 0; k < list->turn_count; k++)
        count += is_near(&list->turn[k], full);
    return count;
}

/* What gyros read in a turn: the angle stated; where no move is near it, or the unit is not known,
 * that which most moves about one axis share, and of these the largest. */
static double angle_of_turns(const imki_turn_list *list, double stated)
{
    double full = stated;
    size_t most = list->known ? moves_near(list, stated) : 0;
    for (size_t k = 0; k < list->turn_count && !(list->known && full == stated && most > 0); k++) {
        const double size = fabs(list->turn[k].angle);
        const size_t count = list->turn[k].body < 0 ? 0 : moves_near(list, size);
        if (count > most || (count == most && count > 0 && size > full)) {
            most = count;
            full = size;
        }
    }
    return full;
}

static void detect_turns(const imki_procedure_call *call, imki_turn_list *list)
{
    const double stated = call->settings->turn_angle;
    list_moves(call, list);
    const double full = angle_of_turns(list, stated), unit = list->known ? 1.0 : stated / full;
    const size_t moves = list->turn_count;
    list->turn_count = 0;
    for (size_t k = 0; k < moves; k++) {
        imki_known_turn move = list->turn[k];
        const double size = fabs(move.angle);
        const bool half = size > half_least * full && size < half_most * full;
        if (is_near(&move, full)) {
            move.angle = move.angle < 0.0 ? -stated : stated;
            keep(call, list, &move);
        } else if (size >= (1.0 - slack) * full || (move.body >= 0 && half)) {
            tell_other(call, move.begin, move.body, unit * move.angle);
        }
    }
}

/* ---- all of it -------------------------------------------------------------------------------
 */

static imk_status start(const imki_procedure_call *call, imki_turn_list *list)
{
    const imk_model *model = &call->calibration->model;
    const imk_test_record *record = call->calibration->record[call->record];
    const int axes = record->axis_count[IMK_GYRO];
    list->record = without_accelerometers(record);
    if (axes == 0)
        return imk_error_set(call->error, IMK_ERROR_KEY_MISSING, "gyro", NULL, "gyros");
    list->known = imki_unit_known(model, record, IMK_GYRO);
    for (int i = 0; i < axes; i++) {
        const double *direction = model->gyro.direction[i];
        list->unit[i] = list->known ? imki_counts_per_unit(model, record, IMK_GYRO, i) : 1.0;
        for (int j = 1; j < 3; j++)
            if (fabs(direction[j]) > fabs(direction[list->body[i]]))
                list->body[i] = j;
        list->sign[i] = direction[list->body[i]] < 0.0 ? -1 : 1;
        bool along = fabs(direction[list->body[i]]) > 0.999;
        for (int k = 0; k < i; k++)
            along = along && list->body[k] != list->body[i];
        if (!along)
            return imk_error_set(call->error, IMK_ERROR_UNSUPPORTED, "gyro.direction", NULL,
                                 "one to three gyros, each along another of the axes x, y, z");
    }
    return IMK_OK;
}

imk_status imki_turn_list_make(const imki_procedure_call *call, imki_turn_list *list)
{
    memset(list, 0, sizeof *list);
    imk_status status = start(call, list);
    if (status != IMK_OK)
        return status;
    const imk_test_record *record = &list->record;
    const bool labelled = labels_name_turns(record);
    imki_parts parts = imki_parts_of(call->workspace);
    char *memory = lay_out(record, &parts, list);
    const size_t used = (size_t)(memory - (char *)call->workspace);
    if (call->workspace_size < imki_turn_list_workspace(record, call->settings))
        return imk_error_set(call->error, IMK_ERROR_WORKSPACE, "workspace", NULL,
                             "imk_procedure_workspace_size() bytes");
    if (labelled)
        label_rests(call, list);
    if (list->rest_count == 0)
        status = detect_rests(call, list, memory, call->workspace_size - used);
    if (status != IMK_OK)
        return status;
    if (list->rest_count < (labelled ? 1 : 2))
        return imki_refuse(
            call->error, IMK_ERROR_TOO_SHORT, "hold", (double)list->rest_count, 2.0,
            "turn the unit, and let it rest for 3 s or more before and after each turn");
    if (labelled)
        label_turns(call, list);
    else
        detect_turns(call, list);
    if (list->turn_count > 0)
        return IMK_OK;
    return imki_refuse(call->error, IMK_ERROR_TOO_SHORT, "turn", 0.0, 1.0,
                       call->findings->known_turns.saturated > 0
                           ? "turn more slowly: a gyro is at the end of its range in every turn"
                           : "turn the unit about one of its axes, by the angle stated "
                             "(--turn-angle, or labels), from one rest to the next; check the unit "
                             "of the gyro columns");
}
