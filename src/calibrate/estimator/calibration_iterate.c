/* SPDX-License-Identifier: Apache-2.0 */
/* Least squares at given weights: Gauss-Newton steps, damped by growing parts of the diagonal when
 * a step does not lower the cost, with the turns linearised. Integrating the turns is what costs
 * time; so the solution is iterated to the end with the linearisation at hand, and the turns are
 * integrated again at the solution. */
#include "estimator_internal.h"

#include "base/algebra/vector_internal.h"

#include <math.h>
#include <string.h>

/* Of a global that is an offset of a record; 0: it is none. */
static double offset_sigma(const imki_estimator *e, size_t global)
{
    for (size_t r = 0; r < e->problem->record_count; r++) {
        const int first = e->offset_global[r], axes = e->problem->record[r]->axis_count[IMK_GYRO];
        if (first >= 0 && (int)global >= first && (int)global < first + axes)
            return e->offset_sigma[r];
    }
    return 0.0;
}

/* What is known before: parameters, fixtures, offsets, the Earth's rate; sums into the normal
 * equations when `build`. */
static double prior_cost(imki_estimator *e, const imki_point *point, bool build)
{
    const imk_calibration *problem = e->problem;
    double cost = 0.0;
    for (size_t g = 0; g < e->globals; g++) {
        double sigma = offset_sigma(e, g), from = 0.0;
        if (g < e->parameters) {
            sigma = problem->prior_sigma[g] *
                    (problem->prior_guessed[g] ? e->factor[IMKI_PART_TERMS] : 1.0);
            from = e->start[g];
        } else if ((int)g == e->vertical_global) {
            sigma = e->vertical_sigma;
        } else {
            for (size_t f = 0; f < problem->fixture_count; f++)
                if (e->fixture_global[f] >= 0 && (int)g >= e->fixture_global[f] &&
                    (int)g < e->fixture_global[f] + 3)
                    sigma = problem->fixture_sigma[f];
        }
        if (!(sigma > 0.0))
            continue;
        const double off = (from - point->global[g]) / sigma;
        cost += off * off;
        if (build) {
            e->normal.core[g * e->globals + g] += 1.0 / (sigma * sigma);
            e->normal.global_gradient[g] += off / sigma;
        }
    }
    cost += imki_earth_cost(e, point, build);
    for (size_t i = 0; i < e->observations; i++) {
        const imk_observation *o = &problem->observation[i];
        if (o->knowledge != IMK_INPUT_PLACED || e->local_first[i] < 0)
            continue;
        const double sigma = o->placement_sigma * e->factor[IMKI_PART_PLACEMENT];
        for (size_t k = 0; k < 3; k++) {
            const size_t local = (size_t)e->local_first[i] + k;
            const double off = -point->attitude[i][k] / sigma;
            cost += off * off;
            if (build) {
                e->normal.band[local * (e->normal.width + 1) + e->normal.width] +=
                    1.0 / (sigma * sigma);
                e->normal.local_gradient[local] += off / sigma;
            }
        }
    }
    return cost;
}

static double pass(imki_estimator *e, const imki_point *point, bool build)
{
    if (build)
        imki_normal_clear(&e->normal);
    imki_point_apply(e, point);
    double cost = prior_cost(e, point, build);
    for (size_t item = 0; item < e->items; item++) {
        const int count = imki_item_rows(e, point, item, e->row);
        for (int i = 0; i < count; i++) {
            const double information = e->weight[item] / imki_row_variance(e, &e->row[i]);
            cost += information * e->row[i].residual * e->row[i].residual;
            if (build)
                imki_normal_add(&e->normal, &e->row[i], information);
        }
    }
    return cost;
}

double imki_build(imki_estimator *e, const imki_point *point)
{
    return pass(e, point, true);
}

double imki_cost(imki_estimator *e, const imki_point *point)
{
    return pass(e, point, false);
}

void imki_point_copy(const imki_estimator *e, const imki_point *from, imki_point *to)
{
    memcpy(to->global, from->global, sizeof to->global);
    memcpy(to->attitude, from->attitude, e->observations * sizeof *to->attitude);
    memcpy(to->horizontal, from->horizontal, e->observations * sizeof *to->horizontal);
}

/* The trial point: the present one and the step. */
static void move(imki_estimator *e)
{
    imki_point_copy(e, &e->now, &e->trial);
    for (size_t g = 0; g < e->globals; g++)
        e->trial.global[g] += e->normal.global_step[g];
    for (size_t i = 0; i < e->observations; i++) {
        if (e->local_first[i] < 0)
            continue;
        const double *step = e->normal.local_step + e->local_first[i];
        double *attitude = e->trial.attitude[i];
        if (e->problem->observation[i].knowledge != IMK_INPUT_GRAVITY) {
            for (int j = 0; j < 3; j++)
                attitude[j] += step[j];
            continue;
        }
        double a[3], b[3], square = 0.0;
        imki_across(attitude, a, b);
        for (int j = 0; j < 3; j++) {
            attitude[j] += a[j] * step[0] + b[j] * step[1];
            square += attitude[j] * attitude[j];
        }
        for (int j = 0; j < 3; j++)
            attitude[j] /= sqrt(square);
        if (e->earth[i])
            imki_earth_move(attitude, a, b, step + 2, e->trial.horizontal[i]);
    }
}

/* By how much the linear problem says the cost falls. */
static double predicted_fall(const imki_normal *n)
{
    double sum = 0.0;
    for (size_t i = 0; i < n->locals; i++)
        sum += n->local_step[i] * n->local_gradient[i];
    for (size_t i = 0; i < n->globals; i++)
        sum += n->global_step[i] * n->global_gradient[i];
    return sum;
}

/* The size of the rate in an asymmetry has a kink where an axis is across the rate, and with a
 * mounting that is free the least cost may be there: no step helps, though the slope on one side
 * foretells a fall, of a third of a sigma at most. */
static const double kink = 0.1;

imk_status imki_iterate(imki_estimator *e, int steps, bool *converged)
{
    double damping = 0.0, undamped = HUGE_VAL;
    bool rose = false; /* by a step with less damping */
    *converged = false;
    e->cost = imki_build(e, &e->now);
    if (!(e->cost < HUGE_VAL))
        return IMK_ERROR_NOT_FINITE;
    for (int i = 0; i < steps && !*converged; i++) {
        e->iterations++;
        double fall = 0.0, cost = (double)INFINITY;
        bool stepped = false; /* the normal equations are those of the trial */
        if (imki_normal_factor(&e->normal, damping) == IMK_OK) {
            imki_normal_solve(&e->normal);
            fall = predicted_fall(&e->normal);
            undamped = damping == 0.0 ? fall : undamped;
            move(e);
            cost = imki_build(e, &e->trial);
            stepped = true;
        }
        /* A step of a thousandth of a sigma is none; nor is one in the rounding of the cost. */
        const double negligible = 1e-6 + 1e-12 * e->cost;
        if (cost < HUGE_VAL && fall <= negligible && cost <= e->cost + 10.0 * negligible) {
            imki_point_copy(e, &e->trial, &e->now);
            *converged = damping == 0.0 || fall <= 1e-3 * negligible || (rose && undamped < kink);
            rose = false;
            damping = *converged ? damping : 0.1 * damping;
            e->cost = cost;
        } else if (cost < e->cost) {
            imki_point_copy(e, &e->trial, &e->now);
            damping = damping > 1e-8 ? 0.1 * damping : 0.0;
            rose = false;
            e->cost = cost;
        } else if (damping > 1e8) {
            if (stepped)
                (void)imki_build(e, &e->now);
            break; /* no step however short helps */
        } else {
            damping = damping > 0.0 ? 10.0 * damping : 1e-6;
            rose = true;
            if (stepped)
                (void)imki_build(e, &e->now);
        }
    }
    imki_point_apply(e, &e->now);
    return IMK_OK;
}

/* ---- turns ------------------------------------------------------------------------------------
 */

static bool all_finite(size_t count, const double *x)
{
    for (size_t i = 0; i < count; i++)
        if (!(fabs(x[i]) < HUGE_VAL))
            return false;
    return true;
}

/* What the linearisation moves the end of a turn by since it was made. */
static void moved_by(const imki_estimator *e, size_t turn, double moved[3])
{
    const double *jacobian = e->turn_jacobian + turn * 3 * e->parameters;
    for (size_t j = 0; j < 3; j++) {
        moved[j] = 0.0;
        for (size_t p = 0; p < e->parameters; p++)
            moved[j] += jacobian[j * e->parameters + p] * (e->now.global[p] - e->turn_reference[p]);
    }
}

/* What it leaves out is of second order: the square of the movement, and its product with the
 * change of the direction it starts from, for which a hundredth is taken. */
static double left_out(const imki_estimator *e)
{
    double largest = 0.0;
    for (size_t t = 0; t < e->turns; t++) {
        double moved[3];
        if (!e->turn[t].usable)
            continue;
        moved_by(e, t, moved);
        const double size = imki_norm3(moved);
        largest = fmax(largest, size * (size + 0.01) / e->turn[t].sigma);
    }
    return largest;
}

double imki_turns_linearise(imki_estimator *e, double tolerance)
{
    double largest = 0.0;
    if (e->turns == 0)
        return 0.0;
    if (e->turns_known && left_out(e) < 0.1 * tolerance)
        return 0.0;
    imki_point_apply(e, &e->now);
    for (size_t t = 0; t < e->turns; t++) {
        const imk_turn *turn = &e->problem->turn[t];
        imki_linear_turn *linear = &e->turn[t];
        double *jacobian = e->turn_jacobian + t * 3 * e->parameters;
        const double *start = e->now.attitude[turn->from];
        if (!linear->usable)
            continue;
        double before[3];
        moved_by(e, t, before);
        for (int j = 0; j < 3; j++)
            before[j] += imki_dot3(linear->turn + 3 * j, start);
        imki_turn_prediction prediction;
        imki_turn_predict(e->problem, &e->problem->model, turn, start, &prediction, jacobian);
        memcpy(linear->turn, prediction.turn, sizeof linear->turn);
        linear->angle = prediction.angle;
        linear->duration = prediction.duration;
        linear->usable = all_finite(3, prediction.end) && all_finite(9, prediction.turn) &&
                         all_finite(3 * e->parameters, jacobian);
        if (!linear->usable) {
            e->weight[e->observations + t] = 0.0;
            continue;
        }
        for (int j = 0; j < 3; j++) {
            const double change = fabs(prediction.end[j] - before[j]) / linear->sigma;
            if (!(change <= largest))
                largest = change;
        }
    }
    memcpy(e->turn_reference, e->now.global, e->parameters * sizeof *e->turn_reference);
    e->turns_known = true;
    return largest;
}
