/* SPDX-License-Identifier: Apache-2.0 */
/* The magnetometer beside the other sensors: its means at rest with the vertical of the
 * accelerometers that the solution has found, or its readings while the unit is turned; then its
 * parameters as parameters of the result. */
#include "calibrate_internal.h"

#include "jobs/job_internal.h"

#include <math.h>
#include <string.h>

/* Readings in motion of one record: more tell nothing that a sensor's own drift leaves true. */
enum { READINGS_MAX = 16384, NEW_PARAMETERS = 12 };

static bool has_magnetometer(const imk_test_record *record)
{
    return record->mag[0] != NULL;
}

static bool is_rest(const imk_calibrate_log *b, const imk_observation *o)
{
    const imk_test_record *record = b->calibration->record[o->record];
    return o->knowledge == IMK_INPUT_GRAVITY && o->weight > 0 && has_magnetometer(record) &&
           record->axis_count[IMK_ACCEL] == 3;
}

static size_t capacity_of(const imk_calibrate_log *b)
{
    size_t capacity = 0;
    for (size_t k = 0; b->result && k < b->calibration->observation_count; k++)
        capacity += is_rest(b, &b->calibration->observation[k]);
    for (size_t k = 0; k < b->count; k++)
        if (b->record[k].procedure == IMK_PROCEDURE_MAGNETOMETER)
            capacity += READINGS_MAX;
    return capacity;
}

/* Tilt of the vertical by the noise of the accelerometers. */
static double tilt_of(const imk_calibrate_log *b, const imk_observation *o)
{
    double square = 0;
    for (int i = 0; i < 3; i++)
        square += o->sigma[IMK_ACCEL][i] * o->sigma[IMK_ACCEL][i] / 3;
    return sqrt(square) * b->result->group[IMK_GROUP_ACCEL].factor / b->calibration->gravity;
}

/* The rests of one record. */
static void add_rests(const imk_calibrate_log *b, const imk_calibrate_record *log,
                      imk_magnetometer *problem)
{
    imk_magnetometer_observation *first = problem->observation + problem->count;
    size_t count = 0;
    for (size_t k = 0; b->result && k < b->calibration->observation_count; k++) {
        const imk_observation *o = &b->calibration->observation[k];
        if (b->calibration->record[o->record] != &log->record || !is_rest(b, o) ||
            !imk_magnetometer_rest(&log->record, &log->mag, o->begin, o->end, &first[count]))
            continue;
        memcpy(first[count].up, o->vertical, sizeof first[count].up);
        first[count].up_sigma = tilt_of(b, o);
        first[count++].record = (int)(log - b->record);
    }
    imk_magnetometer_pool(count, first);
    problem->count += count;
}

static void add_motion(const imk_calibrate_log *b, const imk_calibrate_record *log,
                       imk_magnetometer *problem)
{
    imk_magnetometer_observation *first = problem->observation + problem->count;
    const size_t count = imk_magnetometer_motion(&log->record, READINGS_MAX, first);
    for (size_t k = 0; k < count; k++)
        first[k].record = (int)(log - b->record);
    problem->count += count;
    problem->series = true;
}

static void observe(const imk_calibrate_log *b, imk_magnetometer *problem)
{
    const imk_calibrate_log_settings *s = &b->settings;
    problem->frame = s->frame >= 0 ? (imk_triad_frame)s->frame : IMK_FRAME_SYMMETRIC;
    problem->field = s->field;
    problem->field_sigma = isnan(s->field_sigma) ? 0 : s->field_sigma;
    problem->robust = !s->least_squares;
    problem->accel = b->result;
    for (size_t k = 0; k < b->count; k++)
        if (b->record[k].procedure == IMK_PROCEDURE_MAGNETOMETER)
            add_motion(b, &b->record[k], problem);
        else if (has_magnetometer(&b->record[k].record))
            add_rests(b, &b->record[k], problem);
}

/* ---- as parameters of the result ------------------------------------------------------------- */

/* Place in the model of parameter p of magnetometer.h, and where it stands there. */
static imk_model_parameter place_of(int p)
{
    imk_model_parameter at = {IMK_MAG, IMK_MODEL_BIAS, (uint8_t)p, 0};
    if (p < IMK_MAGNETOMETER_RESPONSE)
        return at;
    const int row = (p - IMK_MAGNETOMETER_RESPONSE) / 3;
    const int column = (p - IMK_MAGNETOMETER_RESPONSE) % 3;
    at.term = row == column ? IMK_MODEL_SCALE_FACTOR : IMK_MODEL_CROSS_AXIS;
    at.axis = (uint8_t)row;
    at.element = row == column ? 0 : (uint8_t)column;
    return at;
}

static void set_model(const imk_magnetometer_result *r, imk_model *model)
{
    imk_triad *triad = &model->mag;
    imk_model perfect;
    imk_model_default(&perfect);
    if (!triad->present)
        *triad = perfect.accel; /* three axes without any error */
    triad->present = true;
    triad->axis_count = 3;
    memcpy(triad->direction, perfect.accel.direction, sizeof triad->direction);
    memset(&triad->misalignment, 0, sizeof triad->misalignment);
    for (int p = 0; p < NEW_PARAMETERS; p++) {
        double *sigma, *value = imk_model_parameter_at(model, place_of(p), &sigma);
        *value = r->value[p] - (place_of(p).term == IMK_MODEL_SCALE_FACTOR ? 1 : 0);
        *sigma = r->sigma[p];
    }
}

/* The parameters that were estimated: a frame has some elements of the matrix 0. */
typedef struct estimates {
    size_t count;
    int parameter[NEW_PARAMETERS];
} estimates;

static estimates estimates_of(const imk_magnetometer_result *r)
{
    estimates e = {0, {0}};
    for (int p = 0; p < NEW_PARAMETERS; p++)
        if (r->sigma[p] > 0)
            e.parameter[e.count++] = p;
    return e;
}

static double covariance_of(const imk_calibration_result *before, const imk_magnetometer_result *r,
                            const estimates *e, size_t i, size_t j)
{
    const size_t n = before->parameter_count;
    if (i < n && j < n)
        return before->covariance[i * n + j];
    if (i < n || j < n)
        return r->cross[e->parameter[(i < n ? j : i) - n]][i < n ? i : j];
    return r->covariance[e->parameter[i - n] * IMK_MAGNETOMETER_PARAMETERS + e->parameter[j - n]];
}

/* Those of the solution stay; the others join them. */
static void join(const imk_calibration_result *before, const imk_magnetometer_result *r,
                 imk_calibration_result *to)
{
    const estimates e = estimates_of(r);
    const size_t n = before->parameter_count, all = n + e.count;
    imk_correlation *correlation = &to->model.correlation;
    for (size_t i = 0; i < all; i++)
        for (size_t j = 0; j < all; j++)
            to->covariance[i * all + j] = covariance_of(before, r, &e, i, j);
    for (size_t p = n; p < all; p++) {
        to->parameter[p] = place_of(e.parameter[p - n]);
        to->value[p] = imk_model_parameter_get(&to->model, to->parameter[p]);
        to->sigma[p] = r->sigma[e.parameter[p - n]];
        to->freedom[p] = r->freedom;
    }
    to->parameter_count = all;
    correlation->count = (int)all;
    for (size_t i = n; i < all; i++) {
        correlation->parameter[i] = to->parameter[i];
        for (size_t j = 0; j < i; j++) {
            const double product = to->sigma[i] * to->sigma[j];
            const double rho = product > 0 ? to->covariance[i * all + j] / product : 0;
            correlation->value[i * (i - 1) / 2 + j] = (float)fmax(-1, fmin(1, rho));
        }
    }
}

/* A result without parameters, where the other sensors have none. */
static imk_calibration_result *empty_result(const imk_calibrate_log *b)
{
    imk_calibration_result *made = imki_arena_take(b->memory, sizeof *made);
    if (!made)
        return NULL;
    made->model = b->calibration->model;
    memset(&made->model.correlation, 0, sizeof made->model.correlation);
    made->weakest_parameter[0] = made->weakest_parameter[1] = -1;
    return made;
}

static imk_status take_result(imk_calibrate_log *b, imk_error *error)
{
    imk_calibration_result *before = b->result ? b->result : empty_result(b);
    imk_calibration_result *joined = imki_arena_take(b->memory, sizeof *joined);
    if (!before || !joined)
        return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    if (before->parameter_count + NEW_PARAMETERS > IMK_CORRELATED_MAX) {
        b->mag = NULL;
        imki_find(&b->findings, IMK_FINDING_WARNING, "mag_many", NULL,
                  IMKI_NUMBERS((double)before->parameter_count, IMK_CORRELATED_MAX));
        return IMK_OK;
    }
    *joined = *before;
    set_model(b->mag, &joined->model);
    join(before, b->mag, joined);
    b->result = joined;
    return IMK_OK;
}

/* ---- all of it ------------------------------------------------------------------------------- */

static imk_status no_solution(imk_calibrate_log *b, const imk_magnetometer_result *r,
                              imk_error *error)
{
    char where[96];
    const imk_error why = *error;
    imki_magnetometer_directions(r, where, sizeof where);
    if (why.status == IMK_ERROR_TOO_SHORT)
        return imki_magnetometer_useless(b, why.status, "mag_few", NULL,
                                         IMKI_NUMBERS((double)b->magnetometer->count), error);
    if (why.status == IMK_ERROR_SINGULAR)
        return imki_magnetometer_useless(b, why.status, "mag_coverage", where,
                                         IMKI_NUMBERS(r->spread), error);
    return why.status;
}

imk_status imki_calibrate_magnetometer(imk_calibrate_log *b, imk_error *error)
{
    const size_t capacity = capacity_of(b);
    if (!imki_magnetometer_records(b, error))
        return b->result ? IMK_OK : error->status;
    if (capacity == 0)
        return IMK_OK;
    if (b->settings.estimate) {
        imki_find(&b->findings, IMK_FINDING_NOTE, "mag_not_named", NULL, 0, NULL);
        return IMK_OK;
    }
    imk_magnetometer *problem = imki_arena_take(b->memory, sizeof *problem);
    imk_magnetometer_observation *observation =
        imki_arena_take(b->memory, capacity * sizeof *observation);
    double *scratch = imki_arena_room(b->memory, capacity * sizeof *scratch);
    imk_magnetometer_result *r = imki_arena_take(b->memory, sizeof *r);
    if (b->memory->failed)
        return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    *problem = imk_magnetometer_default();
    problem->observation = observation;
    b->magnetometer = problem;
    observe(b, problem);
    if (imk_magnetometer_solve(problem, r, scratch, error) != IMK_OK)
        return no_solution(b, r, error);
    b->mag = r;
    if (imki_magnetometer_result(b, error))
        return take_result(b, error);
    b->mag = NULL;
    return b->result ? IMK_OK : error->status;
}
