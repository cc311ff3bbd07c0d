/* SPDX-License-Identifier: Apache-2.0 */
/* The solution of a calibration, from start to result:
 *
 *     least squares with all items -> what is determined? -> items that do not belong are refused
 *     -> variance factors -> covariance, degrees of freedom -> slow noise -> frame
 *
 * Turns are integrated again until that changes nothing. */
#include "estimator_internal.h"

#include "base/algebra/vector_internal.h"
#include "imukit/linear_algebra.h"

#include <math.h>
#include <string.h>

enum { OUTER_ROUNDS = 20, STEPS = 60 };

size_t imk_calibration_workspace_size(const imk_calibration *calibration)
{
    return imki_estimator_size(calibration);
}

/* ---- enough? ----------------------------------------------------------------------------------
 */

/* What the observations of a sensor give, and what its parameters ask for. A direction of gravity
 * takes two from the accelerometers; a turn gives two to the gyros. */
static imk_status check_count(const imki_estimator *e, int sensor, imk_error *error)
{
    static const char *const names[2] = {"gyro", "accel"};
    const imk_calibration *c = e->problem;
    size_t wanted = 0, observations = 0, scalars = 0, axes = 0;
    for (size_t p = 0; p < e->parameters; p++)
        wanted += c->parameter[p].sensor == sensor && !(c->prior_sigma[p] > 0.0);
    for (size_t i = 0; i < e->observations; i++) {
        size_t seen = 0;
        for (int axis = 0; axis < IMK_AXES_MAX; axis++)
            seen += !isnan(e->reading[i][sensor][axis]);
        if (sensor == IMK_ACCEL && c->observation[i].knowledge == IMK_INPUT_GRAVITY &&
            e->turns == 0)
            seen -= seen > 2 ? 2 : seen;
        axes = seen > axes ? seen : axes;
        observations += seen > 0;
        scalars += seen;
    }
    if (sensor == IMK_GYRO)
        scalars += 2 * e->turns;
    if (scalars >= wanted)
        return IMK_OK;
    imk_error_set(error, IMK_ERROR_TOO_SHORT, names[sensor], NULL,
                  "add poses or inputs: there are too few readings for the parameters");
    if (error) {
        error->value = (double)observations;
        error->limit = axes > 0 ? ceil((double)wanted / (double)axes) : (double)wanted;
    }
    return IMK_ERROR_TOO_SHORT;
}

/* ---- solving ----------------------------------------------------------------------------------
 */

typedef struct halfway {
    double global[IMKI_GLOBALS_MAX];
    double cost;
} halfway;

/* Integrate the turns at the solution, and take back half of a step that made things worse. */
static double relinearise(imki_estimator *e, double tolerance, halfway *last)
{
    for (int halvings = 0; halvings < 12; halvings++) {
        const double change = imki_turns_linearise(e, tolerance);
        const double cost = imki_cost(e, &e->now);
        if (e->turns == 0 || cost <= last->cost * (1.0 + 1e-6) + 1.0 || halvings == 11) {
            last->cost = cost;
            memcpy(last->global, e->now.global, sizeof last->global);
            return change;
        }
        for (size_t g = 0; g < e->globals; g++)
            e->now.global[g] = 0.5 * (e->now.global[g] + last->global[g]);
    }
    return 0.0;
}

/* Least squares with the present weights to the end. */
static imk_status settle(imki_estimator *e, double tolerance, bool *converged)
{
    halfway last = {.cost = (double)INFINITY};
    imk_status status = IMK_OK;
    *converged = false;
    (void)relinearise(e, tolerance, &last);
    for (int round = 0; round < OUTER_ROUNDS && status == IMK_OK; round++) {
        status = imki_iterate(e, STEPS, converged);
        if (status != IMK_OK || (relinearise(e, tolerance, &last) <= tolerance && *converged))
            return status;
    }
    *converged = *converged && e->turns == 0;
    return status;
}

static imk_status solve(imki_estimator *e, imki_fit *fit, double *weakest, imk_error *error)
{
    bool converged;
    imk_status status = settle(e, 0.3, &converged);
    if (status == IMK_OK)
        status = imki_check_determined(e, weakest, error);
    if (status != IMK_OK)
        return status == IMK_ERROR_SINGULAR
                   ? status
                   : imk_error_set(error, status, NULL, NULL, "finite readings and inputs");
    status = e->problem->robust ? imki_refuse_outliers(e) : imki_variance_factors(e, 0.01, fit);
    if (status == IMK_OK && !e->problem->robust)
        status = imki_choose_scatter(e, fit);
    for (int round = 0; status == IMK_OK && round < OUTER_ROUNDS; round++) {
        status = imki_variance_factors(e, 1e-3, fit);
        if (status == IMK_OK && imki_turns_linearise(e, 0.01) <= 0.01)
            break;
    }
    if (status == IMK_OK)
        status = settle(e, 0.01, &converged);
    if (status == IMK_OK && !converged)
        return imk_error_set(error, IMK_ERROR_NO_CONVERGENCE, NULL, NULL,
                             "start from a model that is closer to the unit");
    if (status == IMK_OK || status == IMK_ERROR_SINGULAR)
        status = imki_check_determined(e, weakest, error);
    if (status == IMK_OK) {
        bool estimated[IMKI_PARTS];
        memcpy(estimated, fit->estimated, sizeof estimated);
        imki_fit_groups(e, fit);
        memcpy(fit->estimated, estimated, sizeof estimated);
    }
    return status;
}

/* ---- result -----------------------------------------------------------------------------------
 */

/* Of the result, which has one for all readings of a sensor. */
static int public_group(const imki_row *row)
{
    return row->sensor < 0           ? IMK_GROUP_TURN
           : row->sensor == IMK_GYRO ? IMK_GROUP_GYRO
                                     : IMK_GROUP_ACCEL;
}

static void fill_outputs(imki_estimator *e, imk_calibration_result *result)
{
    imk_calibration *c = e->problem;
    for (size_t item = 0; item < e->items; item++) {
        const int count = imki_item_rows(e, &e->now, item, e->row);
        /* A turn over samples that are no numbers has no rows. */
        const bool used = e->weight[item] >= 1.0 && (item < e->observations || count > 0);
        double square = 0.0;
        for (int i = 0; i < count; i++) {
            const imki_row *row = &e->row[i];
            imk_group_fit *group = &result->group[public_group(row)];
            square += row->residual * row->residual / imki_row_variance(e, row);
            group->count++;
            group->refused += !used;
            if (used) {
                group->chi_square += row->residual * row->residual / imki_stated_variance(e, row);
                group->rms += row->residual * row->residual;
            }
        }
        const double distance = count > 0 ? sqrt(square / count) : 0.0;
        if (item >= e->observations) {
            imk_turn *turn = &c->turn[item - e->observations];
            for (int i = 0; i < 2; i++)
                turn->residual[i] = count > 0 ? e->row[i].residual : (double)NAN;
            turn->angle = e->turn[item - e->observations].angle;
            turn->distance = distance;
            turn->weight = used ? 1.0 : 0.0;
            result->turns_refused += !used;
            continue;
        }
        imk_observation *o = &c->observation[item];
        for (int sensor = 0; sensor < 2; sensor++)
            for (int axis = 0; axis < IMK_AXES_MAX; axis++)
                o->residual[sensor][axis] = (double)NAN;
        for (int i = 0; i < count; i++)
            o->residual[e->row[i].sensor][e->row[i].axis] = e->row[i].residual;
        if (o->knowledge == IMK_INPUT_GRAVITY)
            memcpy(o->vertical, e->now.attitude[item], sizeof o->vertical);
        o->distance = distance;
        o->weight = used ? 1.0 : 0.0;
        result->observations_refused += !used;
    }
}

/* The factor of a group whose axes have their own, or that moves and holds still, is their mean by
 * redundancy. Those of the axes are of holds; where there are none, of what moves. */
static void fill_factors(const imki_estimator *e, const imki_fit *fit, int g, imk_group_fit *group)
{
    const int sensor = g == IMK_GROUP_GYRO ? IMK_GYRO : IMK_ACCEL;
    const bool readings = g != IMK_GROUP_TURN;
    const double added = readings ? e->added[sensor] : 0.0;
    double left = 0.0, square = 0.0, moving = 0.0;
    int part[IMK_AXES_MAX];
    for (int of = 0; of < (readings ? 2 : 1); of++) {
        const int parts = imki_group_parts(e, of ? imki_moving_group(sensor) : g, part);
        for (int i = 0; i < parts; i++) {
            const double factor = e->factor[part[i]];
            left += fit->redundancy[part[i]];
            moving += of * fit->redundancy[part[i]];
            square += fit->redundancy[part[i]] * factor * factor;
        }
    }
    for (int axis = 0; axis < IMK_AXES_MAX; axis++) {
        const bool moves = left > 0.0 && moving == left;
        const int of = !readings ? g
                       : moves   ? imki_moving_part(sensor, axis)
                                 : imki_part_of(e, sensor, axis);
        group->axis_factor[axis] = added > 0.0 ? 1.0 : e->factor[of];
        group->axis_added[axis] = added * e->factor[of];
    }
    if (added > 0.0)
        square = group->chi_square;
    group->degrees_of_freedom = left > 1e-9 ? left : 0.0;
    group->factor = left > 1e-9 ? sqrt(square / left) : group->axis_factor[0];
}

static void fill_noise(const imki_estimator *e, int sensor, imk_group_fit *group)
{
    for (int axis = 0; axis < IMK_AXES_MAX; axis++) {
        double square = 0.0, count = 0.0;
        for (size_t i = 0; i < e->observations; i++)
            if (!isnan(e->reading[i][sensor][axis]) && e->weight[i] >= 1.0) {
                square += e->sigma[i][sensor][axis] * e->sigma[i][sensor][axis];
                count += 1.0;
            }
        group->axis_noise[axis] = count > 0.0 ? sqrt(square / count) : 0.0;
    }
}

/* Fit of placements, or of terms, to what was assumed of them. */
static void fill_assumed(const imki_estimator *e, const imki_fit *fit, int part,
                         imk_group_fit *group)
{
    const double factor = e->factor[part], left = fit->redundancy[part];
    group->factor = factor;
    group->count = fit->count[part];
    group->chi_square = fit->square[part] * factor * factor;
    group->degrees_of_freedom = left > 1e-9 ? left : 0.0;
    group->rms = left > 1e-9 ? sqrt(fmax(0.0, fit->excess[part]) / left) : 0.0;
    for (int axis = 0; axis < IMK_AXES_MAX; axis++)
        group->axis_factor[axis] = factor;
}

static void fill_groups(const imki_estimator *e, const imki_fit *fit,
                        imk_calibration_result *result)
{
    for (int g = 0; g < IMK_GROUPS; g++) {
        imk_group_fit *group = &result->group[g];
        const size_t used = group->count - group->refused;
        fill_factors(e, fit, g, group);
        if (g != IMK_GROUP_TURN)
            fill_noise(e, g == IMK_GROUP_GYRO ? IMK_GYRO : IMK_ACCEL, group);
        group->rms = used > 0 ? sqrt(group->rms / (double)used) : 0.0;
        result->chi_square += group->chi_square;
        result->degrees_of_freedom += group->degrees_of_freedom;
    }
    fill_assumed(e, fit, IMKI_PART_PLACEMENT, &result->placement);
    result->turn_chi_square =
        fit->turn_square * result->placement.factor * result->placement.factor;
    result->turn_freedom = fit->turn_redundancy;
    fill_assumed(e, fit, IMKI_PART_TERMS, &result->assumed);
}

static bool is_hidden(const imk_calibration *c, size_t p)
{
    return c->hidden[p] && c->prior_sigma[p] > 0.0;
}

/* The parameters that are reported, and which of the estimator's each is; its number of parameters
 * where the frame has taken it. @return how many */
static size_t reported(const imki_estimator *e, const imk_calibration *calibration,
                       imk_model_parameter parameter[IMK_CORRELATED_MAX],
                       size_t from[IMK_CORRELATED_MAX])
{
    size_t count = 0;
    for (size_t p = 0; p < calibration->parameter_count; p++) {
        if (is_hidden(calibration, p))
            continue;
        from[count] = e->parameters;
        for (size_t q = 0; q < e->parameters; q++)
            if (memcmp(&e->problem->parameter[q], &calibration->parameter[p], sizeof *parameter) ==
                0)
                from[count] = q;
        parameter[count++] = calibration->parameter[p];
    }
    return count;
}

/* The parameters as the caller has them; a symmetric frame has the other halves of its pairs too,
 * which were held at 0. */
static imk_status fill_parameters(imki_estimator *e, const imk_calibration *calibration,
                                  const double *freedom, imk_calibration_result *result,
                                  double rotation[9])
{
    size_t from[IMK_CORRELATED_MAX];
    const size_t count = reported(e, calibration, result->parameter, from);
    result->parameter_count = count;
    for (size_t p = 0; p < count; p++) {
        for (size_t q = 0; q < count; q++)
            result->covariance[p * count + q] =
                from[p] < e->parameters && from[q] < e->parameters
                    ? e->normal.covariance[from[p] * e->globals + from[q]]
                    : 0.0;
        result->freedom[p] = from[p] < e->parameters ? freedom[from[p]] : 0.0;
    }
    result->model = e->problem->model;
    for (size_t p = 0; p < e->parameters; p++)
        if (is_hidden(e->problem, p))
            *imk_model_parameter_at(&result->model, e->problem->parameter[p], NULL) = e->start[p];
    if (calibration->frame == IMK_FRAME_SYMMETRIC) {
        const imk_status status =
            imk_triad_frame_convert(&result->model, IMK_FRAME_SYMMETRIC, count, result->parameter,
                                    result->covariance, rotation);
        if (status != IMK_OK)
            return status;
    }
    /* Half of a pair: the degrees of the other, which it is tied to. */
    for (size_t p = 0; p < count; p++)
        for (size_t q = 0; result->freedom[p] == 0.0 && q < count; q++)
            if (result->parameter[q].sensor == result->parameter[p].sensor &&
                result->parameter[q].term == result->parameter[p].term &&
                result->parameter[q].axis == result->parameter[p].element &&
                result->parameter[q].element == result->parameter[p].axis)
                result->freedom[p] = result->freedom[q];
    return IMK_OK;
}

static void fill_model(const imk_calibration *calibration, imk_calibration_result *result)
{
    const size_t count = result->parameter_count;
    imk_correlation *correlation = &result->model.correlation;
    bool rotated = false;
    double strongest = 0.9;
    memset(correlation, 0, sizeof *correlation);
    result->weakest_parameter[0] = result->weakest_parameter[1] = -1;
    correlation->count = (int)count;
    for (size_t p = 0; p < count; p++) {
        double *sigma;
        const double *value = imk_model_parameter_at(&result->model, result->parameter[p], &sigma);
        const double variance = result->covariance[p * count + p];
        result->value[p] = *value;
        result->sigma[p] = *sigma = variance > 0.0 ? sqrt(variance) : 0.0;
        correlation->parameter[p] = result->parameter[p];
        rotated = rotated || result->parameter[p].term == IMK_MODEL_MISALIGNMENT ||
                  result->parameter[p].term == IMK_MODEL_CROSS_AXIS;
    }
    for (size_t p = 1; p < count; p++)
        for (size_t q = 0; q < p; q++) {
            const double product = result->sigma[p] * result->sigma[q];
            double r = product > 0.0 ? result->covariance[p * count + q] / product : 0.0;
            r = r > 1.0 ? 1.0 : r < -1.0 ? -1.0 : r;
            correlation->value[p * (p - 1) / 2 + q] = (float)r;
            /* Pairs that the symmetric frame ties are one number. */
            if (fabs(r) > strongest && fabs(r) < 1.0 - 1e-9) {
                strongest = fabs(r);
                result->weakest_parameter[0] = (int)p;
                result->weakest_parameter[1] = (int)q;
            }
        }
    if (rotated) {
        const char *name = imk_triad_frame_name(calibration->frame);
        memset(result->model.gyro_evidence.frame, 0, sizeof result->model.gyro_evidence.frame);
        memset(result->model.accel_evidence.frame, 0, sizeof result->model.accel_evidence.frame);
        memcpy(result->model.gyro_evidence.frame, name, strlen(name));
        memcpy(result->model.accel_evidence.frame, name, strlen(name));
    }
}

/* Directions of gravity belong to the frame solved in; turn them with the model. */
static void turn_verticals(imk_calibration *calibration, const double rotation[9])
{
    for (size_t i = 0; i < calibration->observation_count; i++) {
        double *v = calibration->observation[i].vertical;
        const double old[3] = {v[0], v[1], v[2]};
        for (int j = 0; j < 3; j++)
            v[j] = imki_dot3(rotation + 3 * j, old);
    }
}

static bool all_finite(const imk_calibration_result *result)
{
    for (size_t p = 0; p < result->parameter_count; p++)
        if (!(fabs(result->value[p]) < HUGE_VAL) || !(result->sigma[p] < HUGE_VAL))
            return false;
    return true;
}

imk_status imk_calibration_solve(imk_calibration *calibration, imk_calibration_result *result,
                                 void *workspace, size_t workspace_size, imk_error *error)
{
    imki_estimator e;
    imki_fit fit;
    double freedom[IMK_CORRELATED_MAX], weakest = 0.0;
    double rotation[9] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
    if (!calibration || !workspace || !result)
        return imk_error_set(error, IMK_ERROR_ARGUMENT, "calibration", NULL, "see calibration.h");
    imk_status status =
        imki_estimator_start(&e, calibration, true, workspace, workspace_size, error);
    for (int sensor = 0; status == IMK_OK && sensor < 2; sensor++)
        status = check_count(&e, sensor, error);
    if (status == IMK_OK)
        status = solve(&e, &fit, &weakest, error);
    if (status != IMK_OK)
        return status;
    status = imki_scatter_freedoms(&e, &fit, freedom);
    if (status != IMK_OK)
        return status;
    imki_slow_noise_add(&e, freedom);
    imk_calibration_result *made = e.result;
    memset(made, 0, sizeof *made);
    made->iterations = e.iterations;
    made->weakest = weakest;
    status = fill_parameters(&e, calibration, freedom, made, rotation);
    if (status != IMK_OK)
        return imk_error_set(error, status, "frame", NULL,
                             "at least three axes that do not lie in one plane");
    fill_model(calibration, made);
    if (!all_finite(made))
        return imk_error_set(error, IMK_ERROR_NO_CONVERGENCE, NULL, NULL,
                             "check that the readings fit the model");
    fill_outputs(&e, made);
    fill_groups(&e, &fit, made);
    turn_verticals(calibration, rotation);
    for (size_t f = 0; f < calibration->fixture_count; f++)
        for (int j = 0; e.fixture_global[f] >= 0 && j < 3; j++)
            made->fixture[f][j] = e.now.global[e.fixture_global[f] + j];
    memcpy(result, made, sizeof *result);
    return IMK_OK;
}
