/* SPDX-License-Identifier: Apache-2.0 */
/* How an error of the readings enters the error equations at an instant: its column, by the
 * sensitivities of distort.h; and what it makes of a self-alignment. */
#include "drift_covariance_internal.h"

#include "base/algebra/vector_internal.h"
#include "imukit/distort.h"
#include "model/model_schema_internal.h"

#include <math.h>
#include <string.h>

/* ---- columns ----------------------------------------------------------------------------------
 */

/* alpha x r + w x (w x r) along the axis, for r of length 1 along body axis `part`. */
static double lever_effect(const imk_motion_state *state, int axis, int part)
{
    const imk_vector3 w = state->angular_rate;
    imk_vector3 r = {{0.0, 0.0, 0.0}};
    r.v[part] = 1.0;
    return imk_vector3_cross(state->angular_acceleration, r).v[axis] +
           imk_vector3_cross(w, imk_vector3_cross(w, r)).v[axis];
}

double imki_drift_factor(const imki_drift_column *column, const imk_motion_state *state)
{
    static const int second[6] = {0, 1, 2, 1, 2, 0}; /* fx^2 fy^2 fz^2 fx fy, fy fz, fz fx */
    const double *f = state->specific_force.v, *w = state->angular_rate.v;
    const bool gyro = column->sensor == IMK_GYRO;
    const int part = column->part;
    const double u = (gyro ? w : f)[column->axis];
    switch (column->kind) {
    case IMKI_COLUMN_RATE:
        return w[part];
    case IMKI_COLUMN_FORCE:
        return f[part];
    case IMKI_COLUMN_PRODUCT:
        return f[part % 3] * f[second[part]];
    case IMKI_COLUMN_POWER:
        return imki_power_at(&imki_input_powers[part], u);
    case IMKI_COLUMN_CROSS:
        return (part < 2 ? u : imki_dot3(column->pendulous, f)) *
               imki_dot3(part == 0 ? column->pendulous : column->output, f);
    case IMKI_COLUMN_LEVER:
        return lever_effect(state, column->axis, part);
    default:
        return 1.0;
    }
}

static void put(imk_matrix3 c, const double body[3], double g[3])
{
    for (int i = 0; i < 3; i++)
        g[i] = imki_dot3(c.m[i], body);
}

/* In body axes what a column carries, and in which part of x. */
static bool carried_in_body(const imki_drift_column *column, const imki_drift_node *node,
                            imk_vector3 *body, int *block)
{
    const bool gyro = column->sensor == IMK_GYRO && column->kind != IMKI_COLUMN_SKEW;
    const imk_vector3 input = gyro ? node->state.angular_rate : node->state.specific_force;
    *block = gyro ? 0 : 3;
    *body = (imk_vector3){{0.0, 0.0, 0.0}};
    switch (column->kind) {
    case IMKI_COLUMN_ROUNDING:
        body->v[column->axis] = 1.0;
        return true;
    case IMKI_COLUMN_DELAY:
        body->v[column->axis] = -input.v[column->axis];
        return true;
    case IMKI_COLUMN_SKEW:
        *body = imk_vector3_scale(input, -1.0);
        return true;
    default:
        return false;
    }
}

/* What the motion does in a second: attitude, velocity, position. */
static void put_motion(const imki_drift_node *node, double g[9])
{
    put(node->c_eb, node->rate_of_axes.v, g);
    memcpy(g + 3, node->acceleration.v, sizeof node->acceleration.v);
    memcpy(g + 6, node->state.velocity.v, sizeof node->state.velocity.v);
}

bool imki_drift_carried_at(const imki_drift_column *column, const imki_drift_node *node,
                           double c[9])
{
    imk_vector3 body;
    int block;
    double raw[9] = {0.0};
    const bool late = column->kind == IMKI_COLUMN_JITTER;
    const bool carried = late || carried_in_body(column, node, &body, &block);
    if (late) { /* the last sample ends so much after its time */
        put_motion(node, raw);
        for (int i = 0; i < 9; i++)
            raw[i] = -raw[i];
    } else if (carried)
        put(node->c_eb, body.v, raw + block);
    imki_matrix9_apply(&node->keep, raw, c);
    return carried;
}

/* F c - dc/dt, the size of c being constant: C turns with the body. */
static void carried_column(const imki_drift_column *column, const imki_drift_node *node,
                           double g[9])
{
    imk_vector3 body;
    int block;
    double c[9];
    carried_in_body(column, node, &body, &block);
    imki_drift_carried_at(column, node, c);
    imki_matrix9_apply(&node->f, c, g);
    const imk_vector3 turning =
        imk_matrix3_apply(node->c_eb, imk_vector3_cross(node->rate_of_axes, body));
    for (int i = 0; i < 3; i++)
        g[block + i] -= turning.v[i];
}

void imki_drift_column_at(const imki_drift_column *column, const imki_drift_node *node, double g[9])
{
    const imk_motion_state *state = &node->state;
    double raw[9] = {0.0}, body[3] = {0.0};
    switch (column->kind) {
    case IMKI_COLUMN_ROUNDING:
    case IMKI_COLUMN_DELAY:
    case IMKI_COLUMN_SKEW:
        carried_column(column, node, raw);
        break;
    case IMKI_COLUMN_GRAVITY:
        for (int i = 0; i < 3; i++)
            raw[3 + i] = -node->axes.m[i][column->axis];
        break;
    case IMKI_COLUMN_CLOCK: /* the truth goes slower than the samples */
        put_motion(node, raw);
        break;
    case IMKI_COLUMN_AID:
        break;
    case IMKI_COLUMN_JITTER: /* F c - dc/dt of what it carries */
        put(node->c_eb, state->angular_acceleration.v, raw);
        put(node->c_eb, node->force_slope.v, raw + 3);
        break;
    default:
        body[column->axis] = imki_drift_factor(column, state);
        put(node->c_eb, body, raw + (column->sensor == IMK_GYRO ? 0 : 3));
    }
    imki_matrix9_apply(&node->keep, raw, g);
}

/* ---- self-alignment ---------------------------------------------------------------------------
 *
 * The attitude found makes the mean force vertical and the mean rate lie in the meridian, so that
 * to first order, with g the force at rest, L the latitude and W the Earth's rate,
 *
 *     psi_north = -df_east/g,   psi_east = df_north/g,
 *     psi_down  = -dw_east/(W cos L) + tan L df_east/g
 *
 * of the mean errors in north-east-down axes. */

static void found_attitude(const imki_drift_node *node, const double g[9], double x[9])
{
    const imk_matrix3 c_ne = imk_matrix3_transpose(node->axes);
    const imk_vector3 dw = imk_matrix3_apply(c_ne, (imk_vector3){{g[0], g[1], g[2]}});
    const imk_vector3 df = imk_matrix3_apply(c_ne, (imk_vector3){{g[3], g[4], g[5]}});
    const double gravity = imk_vector3_norm(node->state.specific_force);
    const imk_vector3 earth = imk_earth_rate(node->state.place.latitude);
    const imk_vector3 psi = {{-df.v[1] / gravity, df.v[0] / gravity,
                              (-dw.v[1] - earth.v[2] * df.v[1] / gravity) / earth.v[0]}};
    const imk_vector3 turned = imk_matrix3_apply(node->axes, psi);
    memset(x, 0, 9 * sizeof *x);
    memcpy(x, turned.v, sizeof turned.v);
}

void imki_drift_alignment_step(const imki_drift_walk *walk, const imki_drift_plan *plan,
                               imki_drift_step *step)
{
    const imki_drift_node *node = &step->node[0];
    const double time = walk->settings->alignment_time;
    step->h = time;
    step->moments = 1;
    step->repeat = 1;
    imki_drift_gravity_step(walk->settings, true, step);
    memset(&step->phi, 0, sizeof step->phi);
    for (int i = 0; i < 9; i++) /* nothing is there yet that would move */
        step->phi.m[i][i] = 1.0;
    for (size_t i = 0; i < plan->column_count; i++) {
        double g[9] = {0.0}, x[9];
        imki_drift_column as_read = plan->column[i];
        if (as_read.kind == IMKI_COLUMN_ROUNDING) /* of a derivative: rounding_at_start() */
            as_read.kind = IMKI_COLUMN_ONE;
        /* At rest nothing comes too late. */
        if (as_read.kind != IMKI_COLUMN_DELAY && as_read.kind != IMKI_COLUMN_SKEW)
            imki_drift_column_at(&as_read, node, g);
        found_attitude(node, g, x);
        for (int j = 0; j < 9; j++)
            step->column[i][0][j] = x[j] / time;
    }
}
