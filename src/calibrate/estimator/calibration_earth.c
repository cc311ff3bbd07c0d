/* SPDX-License-Identifier: Apache-2.0 */
/* The Earth's rate at rest in an unknown attitude. Along the vertical it is known by the latitude,
 * or is one more unknown, 0 +- Omega/sqrt(3) over a sphere. Across, only its size is known, the
 * heading is not: (Omega cos(latitude))^2/2 along each direction. Two forms of that:
 *
 *   as a variance   of each gyro reading, and of each turn, as though the headings of all rests
 *                   were unknown by themselves;
 *   as a chain      two unknowns h of each rest that turns join. Gyros at rest read them; a turn of
 *                   length T carries the vertical n from there to D (n + T h x n); and at its end
 *                   they are  h' = D h,  to some hundredths by the gyros' own errors. Only where no
 *                   turn leads to is (Omega cos(latitude))^2/2 all that is known.
 *
 * The first costs nothing, the second four local unknowns a rest in place of two. It is taken when
 * the first would leave out what matters: when the variance of the heading is above 2 % of the
 * median variance stated for gyro readings at rest. Below that the share that readings and turns
 * have in common is 2 % of a variance at most, 1 % of a sigma, and less where white noise of the
 * turns counts. Above, g-sensitivity, which both tell of, would be stated too well. */
#include "estimator_internal.h"

#include "base/algebra/vector_internal.h"
#include "imukit/elementary.h"

#include <math.h>
#include <string.h>

static const double negligible_share = 0.02;

/* What a turn leaves unknown of the Earth's horizontal rate, over its size: errors of scale and
 * misalignment from which the solution starts, 1 or 2 % of a turn of 90 to 180 deg. */
static const double carried = 0.03;

/* ---- start ------------------------------------------------------------------------------------
 */

static bool sees_rate(const imki_estimator *e, size_t index)
{
    bool any = false;
    for (int axis = 0; axis < IMK_AXES_MAX; axis++)
        any = any || !isnan(e->reading[index][IMK_GYRO][axis]);
    return any && e->problem->observation[index].knowledge == IMK_INPUT_GRAVITY;
}

/* More than half of the gyro readings at rest are so good that the heading matters: the median. */
static bool heading_matters(const imki_estimator *e)
{
    const double limit = e->horizontal_variance / negligible_share;
    size_t readings = 0, better = 0;
    for (size_t i = 0; i < e->observations; i++)
        for (int axis = 0; sees_rate(e, i) && axis < IMK_AXES_MAX; axis++) {
            const double sigma = e->sigma[i][IMK_GYRO][axis];
            if (isnan(e->reading[i][IMK_GYRO][axis]))
                continue;
            readings++;
            better += sigma * sigma < limit;
        }
    return 2 * better > readings;
}

static void start_rates(imki_estimator *e)
{
    const imk_calibration *c = e->problem;
    const double rate = c->earth_rate;
    bool needed = false;
    for (size_t i = 0; i < e->observations; i++)
        needed = needed || sees_rate(e, i);
    e->vertical_global = -1;
    e->vertical_rate = e->vertical_sigma = e->horizontal_variance = 0.0;
    if (!needed || rate == 0.0)
        return;
    if (isnan(c->latitude)) {
        e->vertical_sigma = rate / sqrt(3.0);
        e->vertical_global = (int)e->globals++;
        e->horizontal_variance = rate * rate / 3.0;
        return;
    }
    const double horizontal = rate * imk_cos(c->latitude);
    e->vertical_rate = rate * imk_sin(c->latitude);
    e->horizontal_variance = 0.5 * horizontal * horizontal;
}

bool imki_earth_start(imki_estimator *e)
{
    bool chained = false;
    start_rates(e);
    for (size_t i = 0; i < e->observations; i++) {
        e->earth[i] = false;
        e->turn_into[i] = -1;
    }
    if (!(e->horizontal_variance > 0.0) || !heading_matters(e))
        return false;
    for (size_t t = 0; t < e->turns; t++) {
        const size_t from = (size_t)e->problem->turn[t].from, to = (size_t)e->problem->turn[t].to;
        if (!sees_rate(e, from) || !sees_rate(e, to))
            continue;
        e->earth[from] = e->earth[to] = chained = true;
        /* Backwards a chain might close on itself, and nothing be known of it. */
        if (from < to && e->turn_into[to] < 0)
            e->turn_into[to] = (int)t;
    }
    return chained;
}

void imki_earth_spread(imki_estimator *e)
{
    for (size_t i = 0; i < e->observations; i++)
        for (int axis = 0; axis < IMK_AXES_MAX; axis++) {
            e->known_variance[i][axis] = e->problem->observation[i].heading_variance[axis];
            if (e->problem->observation[i].knowledge != IMK_INPUT_GRAVITY || e->earth[i] ||
                isnan(e->reading[i][IMK_GYRO][axis]))
                continue;
            const double *n = e->now.attitude[i], *d = e->problem->model.gyro.direction[axis];
            const double along = imki_dot3(n, d);
            e->known_variance[i][axis] = e->horizontal_variance * fmax(0.0, 1.0 - along * along);
        }
    for (size_t t = 0; t < e->turns; t++) {
        const imk_turn *turn = &e->problem->turn[t];
        e->turn[t].sigma = turn->sigma;
        if (e->earth[turn->from] && turn->earth_sigma > 0.0)
            e->turn[t].sigma =
                sqrt((turn->sigma - turn->earth_sigma) * (turn->sigma + turn->earth_sigma));
    }
}

/* ---- the chain --------------------------------------------------------------------------------
 */

/* The turn in use that ends at a rest; NULL: none. */
static const imk_turn *turn_into(const imki_estimator *e, size_t index)
{
    const int turn = e->turn_into[index];
    return turn >= 0 && e->turns_known && e->turn[turn].usable &&
                   e->weight[e->observations + (size_t)turn] > 0.5
               ? &e->problem->turn[turn]
               : NULL;
}

/* A component of what is known of h at a rest: 0, or what was carried there. */
static void horizontal_row(const imki_estimator *e, const imki_point *point, size_t index,
                           const imk_turn *turn, const double across[3], size_t k, imki_row *row)
{
    *row = (imki_row){.residual = -imki_dot3(across, point->horizontal[index]),
                      .sigma = sqrt(e->horizontal_variance),
                      .locals = 1,
                      .local = {(size_t)e->local_first[index] + 2 + k},
                      .by_local = {1.0}};
    if (!turn)
        return;
    const size_t from = (size_t)turn->from;
    const double *d = e->turn[e->turn_into[index]].turn;
    double start[2][3];
    row->sigma *= carried;
    imki_across(point->attitude[from], start[0], start[1]);
    for (size_t j = 0; j < 3; j++)
        row->residual += across[j] * imki_dot3(d + 3 * j, point->horizontal[from]);
    for (size_t l = 0; l < 2; l++) {
        double by = 0.0;
        for (size_t j = 0; j < 3; j++)
            by -= across[j] * imki_dot3(d + 3 * j, start[l]);
        row->local[row->locals] = (size_t)e->local_first[from] + 2 + l;
        row->by_local[row->locals++] = by;
    }
}

double imki_earth_cost(imki_estimator *e, const imki_point *point, bool build)
{
    double cost = 0.0;
    for (size_t i = 0; i < e->observations; i++) {
        if (!e->earth[i])
            continue;
        const imk_turn *turn = turn_into(e, i);
        double across[2][3];
        imki_across(point->attitude[i], across[0], across[1]);
        for (size_t k = 0; k < 2; k++) {
            imki_row *row = &e->row[0];
            horizontal_row(e, point, i, turn, across[k], k, row);
            const double information = 1.0 / (row->sigma * row->sigma);
            cost += information * row->residual * row->residual;
            if (build)
                imki_normal_add(&e->normal, row, information);
        }
    }
    return cost;
}

void imki_earth_move(const double n[3], const double a[3], const double b[3], const double step[2],
                     double horizontal[3])
{
    double along = 0.0;
    for (int j = 0; j < 3; j++) {
        horizontal[j] += a[j] * step[0] + b[j] * step[1];
        along += n[j] * horizontal[j];
    }
    for (int j = 0; j < 3; j++)
        horizontal[j] -= along * n[j];
}
