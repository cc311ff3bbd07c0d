/* SPDX-License-Identifier: Apache-2.0 */
/* Before the estimator iterates: checks, the frame it solves in, memory, and where it starts. */
#include "estimator_internal.h"

#include "base/algebra/vector_internal.h"
#include "base/workspace_internal.h"
#include "imukit/attitude.h"
#include "model/model_internal.h"

#include <math.h>
#include <string.h>

/* ---- memory ---------------------------------------------------------------------------------- */

static bool has_locals(const imk_observation *o)
{
    return o->knowledge == IMK_INPUT_GRAVITY ||
           (o->knowledge == IMK_INPUT_PLACED && o->placement_sigma > 0.0);
}

/* `rest`: of a rest under gravity, 2, or 4 with the Earth's horizontal rate. */
static size_t local_count(const imk_observation *o, size_t rest)
{
    return !has_locals(o) ? 0 : o->knowledge == IMK_INPUT_GRAVITY ? rest : 3;
}

static bool turn_is_valid(const imk_calibration *c, const imk_turn *turn)
{
    const int n = (int)c->observation_count;
    return turn->from >= 0 && turn->from < n && turn->to >= 0 && turn->to < n &&
           turn->from != turn->to && c->observation[turn->from].knowledge == IMK_INPUT_GRAVITY &&
           c->observation[turn->to].knowledge == IMK_INPUT_GRAVITY;
}

/* Farthest apart that two unknowns of one row are. */
static size_t band_width(const imk_calibration *c, size_t rest)
{
    size_t widest = 0;
    for (size_t i = 0; i < c->observation_count; i++) {
        const size_t own = local_count(&c->observation[i], rest);
        widest = own > widest + 1 ? own - 1 : widest;
    }
    for (size_t t = 0; t < c->turn_count; t++) {
        const imk_turn *turn = &c->turn[t];
        if (!turn_is_valid(c, turn))
            continue;
        const int first = turn->from < turn->to ? turn->from : turn->to;
        const int last = turn->from < turn->to ? turn->to : turn->from;
        size_t reach = local_count(&c->observation[last], rest) - 1;
        for (int i = first; i < last; i++)
            reach += local_count(&c->observation[i], rest);
        widest = reach > widest ? reach : widest;
    }
    return widest;
}

/* Does an observation have an offset in common with others of its record? */
static bool has_offset(const imk_calibration *c, const imk_observation *o)
{
    return o->offset_sigma > 0.0 && o->record >= 0 && o->record < (int)c->record_count &&
           o->record < IMK_TEST_RECORDS_MAX && c->record[o->record];
}

/* Gyros of the records with offsets, together. */
static size_t count_offsets(const imk_calibration *c)
{
    bool seen[IMK_TEST_RECORDS_MAX] = {false};
    size_t gyros = 0;
    for (size_t i = 0; i < c->observation_count; i++) {
        const imk_observation *o = &c->observation[i];
        if (!has_offset(c, o) || seen[o->record])
            continue;
        seen[o->record] = true;
        gyros += (size_t)c->record[o->record]->axis_count[IMK_GYRO];
    }
    return gyros;
}

static void lay_out(imki_estimator *e, const imk_calibration *c, imki_parts *a)
{
    const size_t n = c->observation_count, m = c->turn_count;
    const size_t rest = m > 0 && c->earth_rate != 0.0 ? 4 : 2; /* at most */
    size_t locals = 0;
    for (size_t i = 0; i < n; i++)
        locals += local_count(&c->observation[i], rest);
    const size_t globals =
        c->parameter_count + 3 * c->fixture_count + count_offsets(c) + 1; /* at most */
    const size_t band = locals * (band_width(c, rest) + 1);
    const size_t number = sizeof(double);
    e->problem = imki_take(a, sizeof *e->problem);
    e->result = imki_take(a, sizeof *e->result);
    e->local_first = imki_take(a, n * sizeof *e->local_first);
    e->turn_into = imki_take(a, n * sizeof *e->turn_into);
    e->sigma = imki_take(a, n * sizeof *e->sigma);
    e->known_variance = imki_take(a, n * sizeof *e->known_variance);
    e->reading = imki_take(a, n * sizeof *e->reading);
    e->weight = imki_take(a, (n + m) * number);
    e->turn = imki_take(a, m * sizeof *e->turn);
    e->turn_jacobian = imki_take(a, m * 3 * c->parameter_count * number);
    e->now.attitude = imki_take(a, n * sizeof *e->now.attitude);
    e->trial.attitude = imki_take(a, n * sizeof *e->trial.attitude);
    e->best.attitude = imki_take(a, n * sizeof *e->best.attitude);
    e->now.horizontal = imki_take(a, n * sizeof *e->now.horizontal);
    e->trial.horizontal = imki_take(a, n * sizeof *e->trial.horizontal);
    e->best.horizontal = imki_take(a, n * sizeof *e->best.horizontal);
    e->best_weight = imki_take(a, (n + m) * number);
    e->row = imki_take(a, 2 * IMKI_ROWS_MAX * sizeof *e->row);
    e->seen = imki_take(a, 2 * IMKI_ROWS_MAX * globals * number);
    e->moved = imki_take(a, 2 * IMKI_ROWS_MAX * globals * number);
    e->squares = imki_take(a, IMKI_PARTS * globals * globals * number);
    e->information = imki_take(a, imki_freedoms_room() * number);
    e->distance = imki_take(a, IMKI_GROUPS * (n + m) * number);
    e->sorted = imki_take(a, (n + m) * number);
    e->state = imki_take(a, n + m);
    e->earth = imki_take(a, n * sizeof *e->earth);
    e->slow.order = imki_take(a, n * sizeof *e->slow.order);
    e->slow.covariance = imki_take(a, globals * globals * number);
    e->slow.axis = imki_take(a, globals * globals * number);
    e->slow.sums = imki_take(a, imki_slow_noise_sums());
    imki_normal *normal = &e->normal;
    normal->band = imki_take(a, band * number);
    normal->factor = imki_take(a, band * number);
    normal->local_inverse = imki_take(a, band * number);
    normal->border = imki_take(a, locals * globals * number);
    normal->half = imki_take(a, locals * globals * number);
    normal->whole = imki_take(a, locals * globals * number);
    normal->local_gradient = imki_take(a, locals * number);
    normal->local_step = imki_take(a, locals * number);
    normal->core = imki_take(a, globals * globals * number);
    normal->schur = imki_take(a, globals * globals * number);
    normal->covariance = imki_take(a, globals * globals * number);
    normal->global_gradient = imki_take(a, globals * number);
    normal->global_step = imki_take(a, globals * number);
}

size_t imki_estimator_size(const imk_calibration *calibration)
{
    imki_estimator unused;
    imki_parts a = imki_parts_of(NULL);
    lay_out(&unused, calibration, &a);
    return imki_parts_size(&a);
}

/* ---- checks ---------------------------------------------------------------------------------- */

static imk_status refuse(imk_error *error, imk_status status, const char *field, size_t index,
                         const char *found, const char *expected)
{
    imk_error_set(error, status, field, found, expected);
    if (error)
        error->index = (int)index;
    return status;
}

static bool finite3(const double v[3])
{
    return fabs(v[0]) < HUGE_VAL && fabs(v[1]) < HUGE_VAL && fabs(v[2]) < HUGE_VAL;
}

static const imk_test_record *record_of(const imk_calibration *c, const imk_observation *o)
{
    return o->record < 0 ? NULL : c->record[o->record];
}

static imk_status check_readings(const imk_calibration *c, size_t index, imk_error *error)
{
    const imk_observation *o = &c->observation[index];
    const imk_triad *triads[2] = {&c->model.gyro, &c->model.accel};
    for (int sensor = 0; sensor < 2; sensor++)
        for (int axis = 0; axis < IMK_AXES_MAX; axis++) {
            const double reading = o->reading[sensor][axis];
            const imk_triad *triad = triads[sensor];
            if (isnan(reading) || !triad->present || axis >= triad->axis_count)
                continue;
            const double sigma = o->sigma[sensor][axis];
            if (!(fabs(reading) < HUGE_VAL) || !(sigma > 0.0) || !(sigma < HUGE_VAL))
                return refuse(error, IMK_ERROR_NOT_FINITE, "observation", index, NULL,
                              "use finite readings with sigmas above 0, and NaN for readings that "
                              "were not observed");
            const imk_test_record *record = record_of(c, o);
            if (record && record->counts[sensor] && triad->sensitivity.value[axis] == 0.0)
                return refuse(error, IMK_ERROR_UNIT_MISSING,
                              sensor == IMK_GYRO ? "gyro.sensitivity" : "accel.sensitivity",
                              (size_t)axis, "readings in counts",
                              "state the nominal sensitivity in the model");
        }
    return IMK_OK;
}

static imk_status check_observation(const imk_calibration *c, size_t index, imk_error *error)
{
    const imk_observation *o = &c->observation[index];
    if (o->record >= (int)c->record_count)
        return refuse(error, IMK_ERROR_ARGUMENT, "observation", index, NULL,
                      "a record that was added, or -1");
    if (o->fixture >= (int)c->fixture_count)
        return refuse(error, IMK_ERROR_ARGUMENT, "observation", index, NULL,
                      "a fixture that was added, or -1");
    bool spread = o->offset_sigma >= 0.0 && o->offset_sigma < HUGE_VAL &&
                  (o->offset_sigma == 0.0 || o->record >= 0);
    for (int axis = 0; axis < IMK_AXES_MAX; axis++)
        spread = spread && o->heading_variance[axis] >= 0.0 && o->heading_variance[axis] < HUGE_VAL;
    if (!spread)
        return refuse(
            error, IMK_ERROR_RANGE, "observation", index, NULL,
            "a heading_variance and an offset_sigma of 0 or more, the latter in a record");
    if (!finite3(o->force) || !finite3(o->rate) || !finite3(o->angular_acceleration) ||
        isinf(o->temperature) ||
        (!isnan(o->temperature) && !(fabs(o->temperature_rate) < HUGE_VAL)) ||
        (o->knowledge == IMK_INPUT_PLACED && !(o->placement_sigma < HUGE_VAL)))
        return refuse(error, IMK_ERROR_NOT_FINITE, "observation", index, NULL,
                      "use finite inputs, and NaN for an unknown temperature");
    return check_readings(c, index, error);
}

static imk_status check_numbers(const imk_calibration *c, imk_error *error)
{
    if (!(c->gravity > 0.0) || !(c->gravity < HUGE_VAL))
        return imk_error_set(error, IMK_ERROR_RANGE, "gravity", NULL, "above 0 m/s^2");
    if (!(c->earth_rate >= 0.0) || !(c->earth_rate < HUGE_VAL))
        return imk_error_set(error, IMK_ERROR_RANGE, "earth_rate", NULL, "0 or more rad/s");
    if (!isnan(c->latitude) && !(fabs(c->latitude) <= 1.5707963267948968))
        return imk_error_set(error, IMK_ERROR_RANGE, "latitude", NULL, "-90 to 90 deg, or NaN");
    if (c->fixture_count > IMK_FIXTURES_MAX || c->record_count > IMK_TEST_RECORDS_MAX ||
        c->parameter_count > IMK_CORRELATED_MAX || c->observation_count > 0x7fffffff)
        return imk_error_set(error, IMK_ERROR_RANGE, "calibration", NULL, "counts within limits");
    for (size_t f = 0; f < c->fixture_count; f++)
        if (!(c->fixture_sigma[f] >= 0.0) || !(c->fixture_sigma[f] < HUGE_VAL))
            return refuse(error, IMK_ERROR_RANGE, "fixture_sigma", f, NULL, "0 or more rad");
    for (size_t p = 0; p < c->parameter_count; p++)
        if (!(c->prior_sigma[p] >= 0.0) || !(c->prior_sigma[p] < HUGE_VAL))
            return refuse(error, IMK_ERROR_RANGE, "prior_sigma", p, NULL, "0 or more");
    for (size_t r = 0; r < c->record_count; r++)
        if (!c->record[r])
            return refuse(error, IMK_ERROR_ARGUMENT, "record", r, NULL, "a record");
    return count_offsets(c) <= IMK_OFFSETS_MAX
               ? IMK_OK
               : imk_error_set(error, IMK_ERROR_RANGE, "offset_sigma", NULL,
                               "at most 24 gyros in records of an attitude that is not known");
}

/* After the observations: they say which record. */
static imk_status check_turns(const imk_calibration *c, imk_error *error)
{
    for (size_t t = 0; t < c->turn_count; t++) {
        const imk_turn *turn = &c->turn[t];
        const imk_test_record *record =
            turn_is_valid(c, turn) ? record_of(c, &c->observation[turn->from]) : NULL;
        if (!record || c->observation[turn->to].record != c->observation[turn->from].record ||
            turn->begin >= turn->end || turn->end > record->count || !(turn->sigma > 0.0) ||
            !(turn->sigma < HUGE_VAL))
            return refuse(
                error, IMK_ERROR_ARGUMENT, "turn", t, NULL,
                "a stretch of samples between two observations under gravity in one record");
    }
    return IMK_OK;
}

/* ---- frame ----------------------------------------------------------------------------------- */

static bool is_row_term(imk_model_parameter p)
{
    return p.sensor == IMK_ACCEL &&
           (p.term == IMK_MODEL_MISALIGNMENT || p.term == IMK_MODEL_CROSS_AXIS);
}

static imk_status frame_conflict(imk_error *error, const char *found, const char *expected)
{
    return imk_error_set(error, IMK_ERROR_CONFLICT, "frame", found, expected);
}

static bool attitudes_are_given(const imk_calibration *c)
{
    for (size_t i = 0; i < c->observation_count; i++)
        for (int axis = 0; c->observation[i].knowledge != IMK_INPUT_GRAVITY && axis < IMK_AXES_MAX;
             axis++)
            if (!isnan(c->observation[i].reading[IMK_ACCEL][axis]))
                return true;
    return false;
}

static bool has_pair(const imk_calibration *c, imk_model_parameter place)
{
    const uint8_t axis = place.axis;
    place.axis = place.element;
    place.element = axis;
    for (size_t p = 0; p < c->parameter_count; p++)
        if (memcmp(&c->parameter[p], &place, sizeof place) == 0)
            return true;
    return false;
}

/* A frame that contradicts a free parameter. */
static imk_status check_frame(const imk_calibration *c, imk_error *error)
{
    for (size_t p = 0; p < c->parameter_count; p++) {
        const imk_model_parameter place = c->parameter[p];
        if (!is_row_term(place))
            continue;
        if (c->frame == IMK_FRAME_SYMMETRIC &&
            (place.term == IMK_MODEL_CROSS_AXIS || !has_pair(c, place)))
            return frame_conflict(error, "not all pairs of misalignments are free",
                                  "free both misalignments of each pair and no cross-axis terms, "
                                  "or choose another frame");
        if ((c->frame == IMK_FRAME_UPPER && place.element < place.axis) ||
            (c->frame == IMK_FRAME_LOWER && place.element > place.axis))
            return frame_conflict(
                error, "some of the free terms are held at 0 by the triangular frame",
                "choose the reference frame, or free only the terms of one triangle");
    }
    return IMK_OK;
}

/* Leave to the estimator what the frame leaves free, and start in that frame. */
static imk_status enter_frame(imk_calibration *c, imk_error *error)
{
    size_t kept = 0, rows = 0, held = 0;
    const imk_triad_frame frame = c->frame;
    if (c->model.accel.axis_count != 3)
        return IMK_OK;
    const imk_status status = check_frame(c, error);
    if (status != IMK_OK)
        return status;
    for (size_t p = 0; p < c->parameter_count; p++) {
        const imk_model_parameter place = c->parameter[p];
        const bool row = is_row_term(place);
        rows += row;
        held += row && c->prior_sigma[p] > 0.0;
        if (row && frame == IMK_FRAME_SYMMETRIC && place.element < place.axis)
            continue;
        c->prior_sigma[kept] = c->prior_sigma[p];
        c->prior_guessed[kept] = c->prior_guessed[p];
        c->hidden[kept] = c->hidden[p];
        c->parameter[kept++] = place;
    }
    c->parameter_count = kept;
    if (rows == 0)
        return IMK_OK;
    if (frame == IMK_FRAME_REFERENCE)
        return rows <= 3 || held > 0 || attitudes_are_given(c)
                   ? IMK_OK
                   : frame_conflict(
                         error, "no attitude is known",
                         "choose the frame upper-triangular, lower-triangular or symmetric");
    return imk_triad_frame_convert(&c->model,
                                   frame == IMK_FRAME_LOWER ? IMK_FRAME_LOWER : IMK_FRAME_UPPER, 0,
                                   NULL, NULL, NULL) == IMK_OK
               ? IMK_OK
               : imk_error_set(
                     error, IMK_ERROR_SINGULAR, "frame", NULL,
                     "a triad of accelerometers whose axes 1, 2, 3 are near body x, y, z");
}

/* ---- start ----------------------------------------------------------------------------------- */

static double si(const imk_calibration *c, const imk_observation *o, int sensor, int axis,
                 bool difference)
{
    const imk_triad *triad = imk_model_triad(&c->model, sensor);
    const imk_test_record *record = record_of(c, o);
    const double x = difference ? o->sigma[sensor][axis] : o->reading[sensor][axis];
    if (!record || !record->counts[sensor])
        return x;
    return (difference ? x : x - triad->zero_offset.value[axis]) / triad->sensitivity.value[axis];
}

/* Forces that the linear terms make of the readings, by least squares. @return false when the axes
 * do not span space */
static bool force_of_readings(const imki_estimator *e, size_t index, double force[3])
{
    const imk_model *model = &e->problem->model;
    const imk_observation *o = &e->problem->observation[index];
    const imki_input rest = {.temperature = o->temperature,
                             .temperature_rate = isnan(o->temperature) ? 0.0 : o->temperature_rate};
    imk_matrix3 normal = {{{0.0}}}, inverse;
    imk_vector3 right = {{0.0, 0.0, 0.0}};
    for (int axis = 0; axis < IMK_AXES_MAX; axis++) {
        if (isnan(e->reading[index][IMK_ACCEL][axis]))
            continue;
        const imki_axis_reading y = imki_axis_read(model, IMK_ACCEL, axis, &rest);
        for (int j = 0; j < 3; j++) {
            right.v[j] += y.by_seen[j] * (e->reading[index][IMK_ACCEL][axis] - y.value);
            for (int k = 0; k < 3; k++)
                normal.m[j][k] += y.by_seen[j] * y.by_seen[k];
        }
    }
    if (imk_matrix3_inverse(normal, &inverse) != IMK_OK)
        return false;
    memcpy(force, imk_matrix3_apply(inverse, right).v, 3 * sizeof *force);
    return true;
}

static void start_attitude(imki_estimator *e, size_t index, bool readings_matter)
{
    const imk_observation *o = &e->problem->observation[index];
    double *attitude = e->now.attitude[index], force[3];
    memset(attitude, 0, 3 * sizeof *attitude);
    if (o->knowledge != IMK_INPUT_GRAVITY)
        return;
    if (!readings_matter || !force_of_readings(e, index, force))
        memcpy(force, o->force, sizeof force);
    const double norm = imki_norm3(force);
    for (int j = 0; j < 3; j++)
        attitude[j] = norm > 0.0 ? force[j] / norm : j == 2;
}

static void start_readings(imki_estimator *e)
{
    const imk_calibration *c = e->problem;
    const imk_triad *triads[2] = {&c->model.gyro, &c->model.accel};
    for (size_t i = 0; i < e->observations; i++)
        for (int sensor = 0; sensor < 2; sensor++)
            for (int axis = 0; axis < IMK_AXES_MAX; axis++) {
                const imk_observation *o = &c->observation[i];
                const bool seen = triads[sensor]->present && axis < triads[sensor]->axis_count &&
                                  !isnan(o->reading[sensor][axis]);
                e->reading[i][sensor][axis] = seen ? si(c, o, sensor, axis, false) : (double)NAN;
                e->sigma[i][sensor][axis] = seen ? si(c, o, sensor, axis, true) : 0.0;
            }
}

static imk_status start_parameters(imki_estimator *e, imk_error *error)
{
    imk_calibration *c = e->problem;
    memset(e->axis_parameters, 0, sizeof e->axis_parameters);
    for (size_t p = 0; p < e->parameters; p++) {
        const imk_model_parameter place = c->parameter[p];
        const imk_triad *triad = imk_model_triad(&c->model, place.sensor);
        e->place[p] = imk_model_parameter_at(&c->model, place, NULL);
        const bool beyond = (place.term == IMK_MODEL_BIAS_TEMPERATURE &&
                             place.element >= triad->bias.temperature.order) ||
                            (place.term == IMK_MODEL_SCALE_TEMPERATURE &&
                             place.element >= triad->scale_factor.temperature.order);
        if (!e->place[p] || beyond)
            return refuse(error, IMK_ERROR_ARGUMENT, "parameters", p, NULL,
                          beyond ? "a power up to the order of the polynomial"
                                 : "a parameter that the model has");
        e->start[p] = e->now.global[p] = *e->place[p];
        const int k = e->axis_parameters[place.sensor][place.axis]++;
        e->axis_parameter[place.sensor][place.axis][k] = (uint8_t)p;
    }
    return IMK_OK;
}

static imk_status check(const imk_calibration *c, size_t workspace_size, imk_error *error)
{
    if (c->cookie != IMKI_CALIBRATION_COOKIE)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, "calibration", NULL,
                             "start from imk_calibration_default()");
    imk_status status = imk_model_validate(&c->model, error);
    if (status == IMK_OK)
        status = check_numbers(c, error);
    for (size_t i = 0; status == IMK_OK && i < c->observation_count; i++)
        status = check_observation(c, i, error);
    if (status == IMK_OK)
        status = check_turns(c, error);
    if (status == IMK_OK && c->parameter_count == 0)
        status = imk_error_set(error, IMK_ERROR_ARGUMENT, "parameters", "no parameter is free",
                               "at least one parameter to estimate");
    if (status == IMK_OK && workspace_size < imki_estimator_size(c))
        status = imk_error_set(error, IMK_ERROR_WORKSPACE, "workspace", NULL,
                               "imk_calibration_workspace_size() bytes");
    return status;
}

static void start_offsets(imki_estimator *e)
{
    for (size_t r = 0; r < IMK_TEST_RECORDS_MAX; r++) {
        e->offset_global[r] = -1;
        e->offset_sigma[r] = 0.0;
    }
    for (size_t i = 0; i < e->observations; i++) {
        const imk_observation *o = &e->problem->observation[i];
        if (!has_offset(e->problem, o))
            continue;
        e->offset_sigma[o->record] = fmax(e->offset_sigma[o->record], o->offset_sigma);
        if (e->offset_global[o->record] >= 0)
            continue;
        e->offset_global[o->record] = (int)e->globals;
        e->globals += (size_t)e->problem->record[o->record]->axis_count[IMK_GYRO];
    }
}

imk_status imki_estimator_start(imki_estimator *e, const imk_calibration *calibration,
                                bool readings_matter, void *workspace, size_t workspace_size,
                                imk_error *error)
{
    imk_status status = check(calibration, workspace_size, error);
    if (status != IMK_OK)
        return status;
    imki_parts a = imki_parts_of(workspace);
    memset(e, 0, sizeof *e);
    lay_out(e, calibration, &a);
    memcpy(e->problem, calibration, sizeof *calibration);
    status = enter_frame(e->problem, error);
    if (status != IMK_OK)
        return status;
    e->observations = calibration->observation_count;
    e->turns = calibration->turn_count;
    e->items = e->observations + e->turns;
    e->parameters = e->globals = e->problem->parameter_count;
    status = start_parameters(e, error);
    if (status != IMK_OK)
        return status;
    start_readings(e);
    for (size_t f = 0; f < e->problem->fixture_count; f++) {
        e->fixture_global[f] = e->problem->fixture_sigma[f] > 0.0 ? (int)e->globals : -1;
        e->globals += e->problem->fixture_sigma[f] > 0.0 ? 3 : 0;
    }
    start_offsets(e);
    const size_t rest = imki_earth_start(e) ? 4 : 2;
    e->normal.globals = e->globals;
    e->normal.width = band_width(calibration, rest);
    e->normal.locals = 0;
    for (size_t i = 0; i < e->observations; i++) {
        const size_t own = local_count(&calibration->observation[i], e->earth[i] ? rest : 2);
        e->local_first[i] = own > 0 ? (int)e->normal.locals : -1;
        e->normal.locals += own;
        memset(e->now.horizontal[i], 0, sizeof e->now.horizontal[i]);
        start_attitude(e, i, readings_matter);
    }
    imki_slow_noise_start(e);
    for (size_t item = 0; item < e->items; item++)
        e->weight[item] = 1.0;
    for (int part = 0; part < IMKI_PARTS; part++)
        e->factor[part] = 1.0;
    memset(e->turn_jacobian, 0, 3 * e->turns * e->parameters * sizeof *e->turn_jacobian);
    memcpy(e->turn_reference, e->now.global, sizeof e->turn_reference);
    for (size_t t = 0; t < e->turns; t++) {
        memset(&e->turn[t], 0, sizeof e->turn[t]);
        e->turn[t].usable = true;
    }
    imki_earth_spread(e);
    return IMK_OK;
}
