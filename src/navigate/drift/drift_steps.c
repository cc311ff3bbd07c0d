/* SPDX-License-Identifier: Apache-2.0 */
/* The error equations along a motion, and their steps.
 *
 * In Earth-fixed axes, with C = C_eb, w the Earth's rate, f = C f_b, G the gradient of gravity
 * (centrifugal force in it) and u the vertical [BRITTING1971] [GROVES2013]:
 *
 *     psi' = -w x psi + C dw
 *     dv'  = -f x psi - 2 w x dv + G dr + C df
 *     dr'  = dv
 *
 * A slaved vertical leaves of dr what is horizontal, and makes the estimated velocity's component
 * along the estimated vertical the true climb: with U = du/dr,
 *
 *     u . dr = 0,   u . dv = -v . U dr.
 *
 * So the states kept are the horizontal ones, x <- keep x; the velocity that goes with them is
 * full x; and F is keep F full.
 *
 * Over a step phi is of fourth order (Runge and Kutta), columns are parabolas through their values
 * at both ends and in the middle, moved to the end of the step. Steps are powers of two of a
 * second, as long as Simpson's rule of attitude, rate and force is as good as that with twice the
 * points. A unit at rest has constant F: there phi is the matrix exponential and a column
 * F^k g, k < 6, with steps of at most a minute: (0.074)^4/360 = 1e-7 of a gyro's share of the
 * position is left out then, 0.074 being what the Schuler oscillation turns in a minute. */
#include "drift_covariance_internal.h"

#include "base/algebra/linear_system_internal.h"
#include "imukit/distort.h"

#include <math.h>
#include <string.h>

static const double rest_step = 60.0; /* see above */
/* Shortest and longest step 2^-10 and 2^3 s: nothing in a script builds up within less than 1 ms.
 */
enum { LEVEL_MIN = -10, LEVEL_MAX = 3, REST_MOMENTS = 6, MOTION_MOMENTS = 3 };

/* ---- small matrices ---- */

static void multiply(const imki_matrix9 *a, const imki_matrix9 *b, imki_matrix9 *product)
{
    for (int i = 0; i < 9; i++) {
        double row[9] = {0.0};
        for (int k = 0; k < 9; k++)
            for (int j = 0; j < 9; j++)
                row[j] += a->m[i][k] * b->m[k][j];
        memcpy(product->m[i], row, sizeof row);
    }
}

/* block of a += factor [v x] */
static void add_cross(imki_matrix9 *a, int row, int column, double factor, const double v[3])
{
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        a->m[row + i][column + j] -= factor * v[k];
        a->m[row + i][column + k] += factor * v[j];
    }
}

/* ---- the equations at an instant --------------------------------------------------------------
 */

static const double earth_rate[3] = {0.0, 0.0, IMK_EARTH_RATE};

/* Columns of the gradient of gravity by central differences: over 200 m either side the third
 * derivative leaves (200/6.4e6)^2 = 1e-9 of it, rounding 1e-15 g/400 m = 2e-12. */
static void gravity_gradient(const imki_drift_walk *walk, imk_vector3 position, imk_vector3 up,
                             double gradient[3][3])
{
    const double reach = 200.0;
    const imki_drift_earth *earth = &walk->earth;
    for (int j = 0; j < 3; j++) {
        imk_vector3 ahead = position, behind = position;
        ahead.v[j] += reach;
        behind.v[j] -= reach;
        const imk_vector3 change =
            imk_vector3_subtract(imk_gravity_ecef(ahead), imk_gravity_ecef(behind));
        for (int i = 0; i < 3; i++)
            gradient[i][j] = earth->radius > 0.0
                                 ? earth->gravity / earth->radius *
                                       (3.0 * up.v[i] * up.v[j] - (i == j ? 1.0 : 0.0))
                                 : change.v[i] / (2.0 * reach);
    }
}

/* How the vertical turns with the place: a unit vector along north over the radius of the meridian,
 * and so east. */
static void turn_of_vertical(const imki_drift_walk *walk, const imki_drift_node *node,
                             double turn[3][3])
{
    double radius[2];
    imk_curvature_radii(node->state.place.latitude, &radius[0], &radius[1]);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            turn[i][j] = 0.0;
            for (int k = 0; k < 2; k++)
                turn[i][j] += node->axes.m[i][k] * node->axes.m[j][k] /
                              (walk->earth.radius > 0.0 ? walk->earth.radius
                                                        : radius[k] + node->state.place.height);
        }
}

static void fill_keep(const imki_drift_walk *walk, imki_drift_node *node, imk_vector3 up)
{
    node->slaved = imk_drift_vertical(walk->settings) == IMK_VERTICAL_SLAVED;
    memset(&node->keep, 0, sizeof node->keep);
    for (int i = 0; i < 9; i++)
        node->keep.m[i][i] = 1.0;
    if (node->slaved)
        for (int block = 3; block < 9; block += 3)
            for (int i = 0; i < 3; i++)
                for (int j = 0; j < 3; j++)
                    node->keep.m[block + i][block + j] -= up.v[i] * up.v[j];
    node->full = node->keep;
    if (!node->slaved)
        return;
    double turn[3][3];
    turn_of_vertical(walk, node, turn);
    for (int j = 0; j < 3; j++) {
        node->climb[j] = 0.0;
        for (int k = 0; k < 3; k++)
            node->climb[j] -= node->state.velocity.v[k] * turn[k][j];
        for (int i = 0; i < 3; i++)
            node->full.m[3 + i][6 + j] += up.v[i] * node->climb[j];
    }
}

static void fill_equations(const imki_drift_walk *walk, imki_drift_node *node, imk_vector3 up)
{
    imki_matrix9 f = {{{0.0}}}, part;
    double gradient[3][3];
    const imk_vector3 force = imk_matrix3_apply(node->c_eb, node->state.specific_force);
    gravity_gradient(walk, node->state.position, up, gradient);
    add_cross(&f, 0, 0, -1.0, earth_rate);
    add_cross(&f, 3, 0, -1.0, force.v);
    add_cross(&f, 3, 3, -2.0, earth_rate);
    for (int i = 0; i < 3; i++) {
        f.m[6 + i][3 + i] = 1.0;
        for (int j = 0; j < 3; j++)
            f.m[3 + i][6 + j] = gradient[i][j];
    }
    multiply(&f, &node->full, &part);
    multiply(&node->keep, &part, &node->f);
}

/* On the sphere the force at rest holds against its gravity. */
static void rest_on_sphere(const imki_drift_walk *walk, imki_drift_node *node, imk_vector3 up)
{
    if (walk->earth.radius > 0.0)
        node->state.specific_force = imk_matrix3_apply(imk_matrix3_transpose(node->c_eb),
                                                       imk_vector3_scale(up, walk->earth.gravity));
}

/* By a difference over 2 ms, which smooths over the joints of the pieces; over 1 ms at the ends of
 * the motion, beyond which its accelerations are gone. */
static imk_vector3 force_slope_at(const imki_drift_walk *walk, double time)
{
    const double reach = 1e-3;
    double first, last;
    imk_motion_state ahead, behind;
    imk_trajectory_span(&walk->motion.trajectory, &first, &last);
    const double after = time + reach <= last ? time + reach : time;
    const double before = time - reach >= first ? time - reach : time;
    if (!(after > before))
        return (imk_vector3){{0.0, 0.0, 0.0}};
    imk_trajectory_state(&walk->motion.trajectory, after, &ahead);
    imk_trajectory_state(&walk->motion.trajectory, before, &behind);
    return imk_vector3_scale(imk_vector3_subtract(ahead.specific_force, behind.specific_force),
                             1.0 / (after - before));
}

void imki_drift_node_at(imki_drift_walk *walk, double time, imki_drift_node *node)
{
    imk_motion_state *state = &node->state;
    imk_trajectory_state(&walk->motion.trajectory, time, state);
    node->c_eb = imk_quaternion_to_matrix(state->attitude);
    node->axes = imk_ned_axes(state->place.latitude, state->place.longitude);
    const imk_vector3 up = {{-node->axes.m[0][2], -node->axes.m[1][2], -node->axes.m[2][2]}};
    const imk_vector3 earth = {{0.0, 0.0, IMK_EARTH_RATE}};
    rest_on_sphere(walk, node, up);
    node->rate_of_axes = imk_vector3_subtract(
        state->angular_rate, imk_matrix3_apply(imk_matrix3_transpose(node->c_eb), earth));
    node->acceleration =
        imk_vector3_subtract(imk_vector3_add(imk_matrix3_apply(node->c_eb, state->specific_force),
                                             imk_gravity_ecef(state->position)),
                             imk_vector3_scale(imk_vector3_cross(earth, state->velocity), 2.0));
    node->force_slope =
        walk->needs_slope ? force_slope_at(walk, time) : (imk_vector3){{0.0, 0.0, 0.0}};
    fill_keep(walk, node, up);
    fill_equations(walk, node, up);
    for (int i = 0; i < 3; i++) {
        walk->peak[IMK_GYRO][i] = fmax(walk->peak[IMK_GYRO][i], fabs(state->angular_rate.v[i]));
        walk->peak[IMK_ACCEL][i] = fmax(walk->peak[IMK_ACCEL][i], fabs(state->specific_force.v[i]));
    }
}

/* ---- choosing steps ---------------------------------------------------------------------------
 */

/* What the choice looks at: attitude, force in Earth-fixed axes, rate in body axes. */
enum { LOOKED_AT = 15, LOOKS_MAX = 17 };

static void look(const imki_drift_walk *walk, double time, double value[LOOKED_AT])
{
    imk_motion_state state;
    imk_trajectory_state(&walk->motion.trajectory, time, &state);
    const imk_matrix3 c = imk_quaternion_to_matrix(state.attitude);
    const imk_vector3 force = imk_matrix3_apply(c, state.specific_force);
    memcpy(value, c.m, sizeof c.m);
    memcpy(value + 9, force.v, sizeof force.v);
    memcpy(value + 12, state.angular_rate.v, sizeof state.angular_rate.v);
}

/* Simpson's rule with three points against that with `looks` of them: the means over the step may
 * differ by 2e-6 of the attitude, 2e-6 g of force, 1e-6 rad/s. Points are half a second apart at
 * most, so that nothing is passed over. */
static bool fits(const imki_drift_walk *walk, double time, double h)
{
    static const double allowed[3] = {2e-6, 2e-5, 1e-6};
    const int looks = h > 2.0 ? 2 * (int)ceil(h) + 1 : 5;
    double few[LOOKED_AT] = {0.0}, many[LOOKED_AT] = {0.0};
    for (int i = 0; i < looks; i++) {
        double value[LOOKED_AT];
        const bool end = i == 0 || i == looks - 1;
        look(walk, time + h * ((double)i / (double)(looks - 1)), value);
        for (int k = 0; k < LOOKED_AT; k++) {
            many[k] += value[k] * (end ? 1.0 : i % 2 ? 4.0 : 2.0);
            few[k] += value[k] * (end ? 1.0 : 2 * i == looks - 1 ? 4.0 : 0.0);
        }
    }
    for (int k = 0; k < LOOKED_AT; k++)
        if (!(fabs(many[k] / (3.0 * (double)(looks - 1)) - few[k] / 6.0) <= allowed[k < 9    ? 0
                                                                                    : k < 12 ? 1
                                                                                             : 2]))
            return false;
    return true;
}

static double power_of_two(int level)
{
    double power = 1.0;
    for (int i = level; i < 0; i++)
        power *= 0.5;
    for (int i = level; i > 0; i--)
        power *= 2.0;
    return power;
}

/* End of a step of a level: at a whole multiple of its length, or at the goal. */
static double end_of(double time, double goal, int level)
{
    const double length = power_of_two(level);
    double end = (floor(time / length) + 1.0) * length;
    if (end - time < 1e-6 * length)
        end += length;
    return end >= goal - 1e-6 * length ? goal : end;
}

static double end_on_motion(imki_drift_walk *walk, double time, double goal)
{
    int level = walk->level < LEVEL_MAX ? walk->level + 1 : LEVEL_MAX;
    double end = end_of(time, goal, level);
    while (level > LEVEL_MIN && !fits(walk, walk->motion.start + time, end - time))
        end = end_of(time, goal, --level);
    walk->level = level;
    return end;
}

double imki_drift_next_step(imki_drift_walk *walk, double time, double goal, imki_drift_step *step)
{
    step->repeat = 1;
    if (walk->rests) {
        const double count = ceil((goal - time) / rest_step * (1.0 - 1e-12));
        step->repeat = count > 1.0 ? (size_t)count : 1;
        step->h = (goal - time) / (double)step->repeat;
        step->moments = REST_MOMENTS;
        imki_drift_node_at(walk, walk->motion.start, &step->node[0]);
        return goal;
    }
    const double end = end_on_motion(walk, time, goal);
    step->h = end - time;
    step->moments = MOTION_MOMENTS;
    for (int i = 0; i < 5; i++)
        imki_drift_node_at(walk, walk->motion.start + time + step->h * (0.25 * i), &step->node[i]);
    return end;
}

/* ---- filling steps ----------------------------------------------------------------------------
 */

/* e <- phi of a step of h from a over b to c. */
static void runge_kutta(const imki_matrix9 *a, const imki_matrix9 *b, const imki_matrix9 *c,
                        double h, imki_matrix9 *e)
{
    imki_matrix9 k = *a, trial, sum;
    const double reach[3] = {0.5 * h, 0.5 * h, h}, weight[4] = {1.0, 2.0, 2.0, 1.0};
    for (int stage = 0; stage < 4; stage++) {
        for (int i = 0; i < 9; i++)
            for (int j = 0; j < 9; j++) {
                sum.m[i][j] = (stage == 0 ? 0.0 : sum.m[i][j]) + weight[stage] * k.m[i][j];
                trial.m[i][j] = (i == j ? 1.0 : 0.0) +
                                (stage < 3 ? reach[stage] * k.m[i][j] : h / 6.0 * sum.m[i][j]);
            }
        if (stage < 3)
            multiply(stage < 2 ? b : c, &trial, &k);
    }
    *e = trial;
}

static void fill_at_rest(const imki_drift_plan *plan, imki_drift_step *step)
{
    const imki_drift_node *node = &step->node[0];
    imki_matrix9 moved;
    imki_exponential(9, &node->f.m[0][0], step->h, &moved.m[0][0]);
    multiply(&node->keep, &moved, &step->phi);
    for (size_t i = 0; i < plan->column_count; i++) {
        imki_drift_column_at(&plan->column[i], node, step->column[i][0]);
        for (int k = 1; k < REST_MOMENTS; k++)
            imki_matrix9_apply(&node->f, step->column[i][k - 1], step->column[i][k]);
    }
}

static void fill_on_motion(const imki_drift_plan *plan, imki_drift_step *step)
{
    const imki_drift_node *node = step->node;
    imki_matrix9 first, second, last;
    runge_kutta(&node[0].f, &node[1].f, &node[2].f, 0.5 * step->h, &first);
    runge_kutta(&node[2].f, &node[3].f, &node[4].f, 0.5 * step->h, &last);
    multiply(&node[4].keep, &last, &second);
    multiply(&second, &first, &step->phi);
    const double slope = 1.0 / step->h, bend = 4.0 / (step->h * step->h);
    for (size_t i = 0; i < plan->column_count; i++) {
        double g[9], begin[9], middle[9], *a[3];
        for (int k = 0; k < 3; k++)
            a[k] = step->column[i][k];
        imki_drift_column_at(&plan->column[i], &node[0], g);
        imki_matrix9_apply(&step->phi, g, begin);
        imki_drift_column_at(&plan->column[i], &node[2], g);
        imki_matrix9_apply(&second, g, middle);
        imki_drift_column_at(&plan->column[i], &node[4], a[0]);
        for (int j = 0; j < 9; j++) {
            a[1][j] = slope * (4.0 * middle[j] - 3.0 * a[0][j] - begin[j]);
            a[2][j] = bend * (a[0][j] - 2.0 * middle[j] + begin[j]);
        }
    }
}

void imki_drift_fill_step(const imki_drift_walk *walk, const imki_drift_plan *plan,
                          imki_drift_step *step)
{
    imki_drift_gravity_step(walk->settings, walk->rests, step);
    if (walk->rests)
        fill_at_rest(plan, step);
    else
        fill_on_motion(plan, step);
}
