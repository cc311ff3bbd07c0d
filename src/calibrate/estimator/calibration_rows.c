/* SPDX-License-Identifier: Apache-2.0 */
/* What is observed, less what a point of the unknowns predicts, with its derivatives.
 *
 * An input known by nominal axes reaches the unit turned by the mounting on the fixture, F, and the
 * placement, P, both rotation vectors: x = Exp(-P) Exp(-F) x_nominal. By a change d of either
 *
 *     dx = x x (B d),   B = J_r(P), or Exp(-P) J_r(F),   J_r(a) = I - [a x]/2 + [a x]^2/6 - …
 *
 * At rest on Earth in an unknown attitude, with the unit vector n of the vertical in body axes,
 *
 *     force = g n,   rate = (Earth's vertical rate) n,   n' = n + a d1 + b d2, normalised.
 *
 * and where turns join rests, the horizontal rate h besides (calibration_earth.c).
 *
 * A turn carries the vertical n of one rest to e; across the vertical m of the next, with unit
 * vectors a and b, the residual is minus (angle between e and m) (a.e, b.e)/sin(angle). */
#include "estimator_internal.h"

#include "base/algebra/vector_internal.h"
#include "imukit/attitude.h"
#include "imukit/elementary.h"

#include <math.h>
#include <string.h>

static void add_cross(const double a[3], const double b[3], double out[3])
{
    out[0] += a[1] * b[2] - a[2] * b[1];
    out[1] += a[2] * b[0] - a[0] * b[2];
    out[2] += a[0] * b[1] - a[1] * b[0];
}

void imki_across(const double n[3], double a[3], double b[3])
{
    int least = 0;
    for (int j = 1; j < 3; j++)
        least = fabs(n[j]) < fabs(n[least]) ? j : least;
    /* The body axis farthest from n, made perpendicular. */
    const double scale = 1.0 / sqrt(1.0 - n[least] * n[least]);
    for (int j = 0; j < 3; j++)
        a[j] = ((j == least) - n[least] * n[j]) * scale;
    b[0] = n[1] * a[2] - n[2] * a[1];
    b[1] = n[2] * a[0] - n[0] * a[2];
    b[2] = n[0] * a[1] - n[1] * a[0];
}

void imki_point_apply(imki_estimator *e, const imki_point *point)
{
    for (size_t p = 0; p < e->parameters; p++)
        *e->place[p] = point->global[p];
}

/* Exp(-a). */
static imk_matrix3 turned_back(const double a[3])
{
    return imk_quaternion_to_matrix(
        imk_quaternion_from_rotation_vector((imk_vector3){{-a[0], -a[1], -a[2]}}));
}

/* J_r(a), to the second power: the third is below 1e-4 of it at 0.1 rad, and only slows the
 * iteration. */
static imk_matrix3 right_jacobian(const double a[3])
{
    const imk_matrix3 k = {{{0.0, -a[2], a[1]}, {a[2], 0.0, -a[0]}, {-a[1], a[0], 0.0}}};
    const imk_matrix3 square = imk_matrix3_multiply(k, k);
    imk_matrix3 j = imk_matrix3_identity();
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
            j.m[r][c] += square.m[r][c] / 6.0 - 0.5 * k.m[r][c];
    return j;
}

/* Where an observation's input comes from at a point. */
typedef struct exposure {
    imki_input input;
    bool gravity;
    double a[3], b[3]; /* across the vertical */
    double vertical[3];
    int fixture; /* first global; -1: none */
    imk_matrix3 by_placement, by_fixture;
    double turned[3]; /* rate by an angle of the placement: along the rate, over the time */
} exposure;

/* The end of a turn is placed: its angle, about the rate, is off. */
static void end_of_turn(const imki_estimator *e, const imk_observation *o,
                        const double placement[3], size_t index, exposure *x, double rate[3])
{
    const double size = imki_norm3(o->rate);
    memset(x->turned, 0, sizeof x->turned);
    if (!(o->turn_time > 0.0) || !(size > 0.0) || e->local_first[index] < 0)
        return;
    const double angle = imki_dot3(o->rate, placement) / size;
    for (int j = 0; j < 3; j++) {
        x->turned[j] = o->rate[j] / size;
        rate[j] += x->turned[j] * angle / o->turn_time;
        x->turned[j] /= sqrt(o->turn_time);
    }
}

static void expose(const imki_estimator *e, const imki_point *point, size_t index, exposure *x)
{
    const imk_observation *o = &e->problem->observation[index];
    const double *attitude = point->attitude[index];
    x->input.temperature = o->temperature;
    x->input.temperature_rate = isnan(o->temperature) ? 0.0 : o->temperature_rate;
    x->gravity = o->knowledge == IMK_INPUT_GRAVITY;
    x->fixture = -1;
    if (x->gravity) {
        const double rate =
            e->vertical_rate + (e->vertical_global < 0 ? 0.0 : point->global[e->vertical_global]);
        memset(x->input.angular_acceleration, 0, sizeof x->input.angular_acceleration);
        for (int j = 0; j < 3; j++) {
            x->vertical[j] = attitude[j];
            x->input.force[j] = e->problem->gravity * attitude[j];
            x->input.rate[j] = rate * attitude[j];
            if (e->earth[index])
                x->input.rate[j] += point->horizontal[index][j];
        }
        imki_across(attitude, x->a, x->b);
        return;
    }
    imk_vector3 vector[3];
    memcpy(vector[0].v, o->rate, sizeof o->rate);
    memcpy(vector[1].v, o->force, sizeof o->force);
    memcpy(vector[2].v, o->angular_acceleration, sizeof o->angular_acceleration);
    x->fixture = o->fixture < 0 ? -1 : e->fixture_global[o->fixture];
    imk_matrix3 total = imk_matrix3_identity();
    if (e->local_first[index] >= 0) {
        total = turned_back(attitude);
        x->by_placement = right_jacobian(attitude);
    }
    if (x->fixture >= 0) {
        const double *angles = point->global + x->fixture;
        x->by_fixture = imk_matrix3_multiply(total, right_jacobian(angles));
        total = imk_matrix3_multiply(total, turned_back(angles));
    }
    if (e->local_first[index] >= 0 || x->fixture >= 0)
        for (int j = 0; j < 3; j++)
            vector[j] = imk_matrix3_apply(total, vector[j]);
    end_of_turn(e, o, attitude, index, x, vector[0].v);
    memcpy(x->input.rate, vector[0].v, sizeof vector[0].v);
    memcpy(x->input.force, vector[1].v, sizeof vector[1].v);
    memcpy(x->input.angular_acceleration, vector[2].v, sizeof vector[2].v);
}

static void add_local(imki_row *row, size_t local, double value)
{
    row->local[row->locals] = local;
    row->by_local[row->locals++] = value;
}

static void add_global(imki_row *row, int global, double value)
{
    row->global[row->globals] = global;
    row->by_global[row->globals++] = value;
}

/* Derivatives by the angles of a known input. */
static void by_rotations(const exposure *x, const imki_axis_reading *y, int first, imki_row *row)
{
    double lever[3] = {0.0, 0.0, 0.0};
    add_cross(y->by_rate, x->input.rate, lever);
    add_cross(y->by_force, x->input.force, lever);
    add_cross(y->by_angular_acceleration, x->input.angular_acceleration, lever);
    const double along = imki_dot3(y->by_rate, x->turned);
    for (int k = 0; first >= 0 && k < 3; k++)
        add_local(row, (size_t)first + (size_t)k,
                  along * x->turned[k] + lever[0] * x->by_placement.m[0][k] +
                      lever[1] * x->by_placement.m[1][k] + lever[2] * x->by_placement.m[2][k]);
    for (int k = 0; x->fixture >= 0 && k < 3; k++)
        add_global(row, x->fixture + k,
                   lever[0] * x->by_fixture.m[0][k] + lever[1] * x->by_fixture.m[1][k] +
                       lever[2] * x->by_fixture.m[2][k]);
}

/* Prediction of a reading and its derivatives by the parameters; of a relative one the difference
 * to what the axis reads at rest. */
static void predict(const imki_estimator *e, const imk_observation *o, const exposure *x,
                    const imki_axis_reading *y, double reading, imki_row *row)
{
    const imk_calibration *problem = e->problem;
    imki_input still = x->input;
    memset(still.rate, 0, sizeof still.rate);
    imki_axis_reading rest = {.value = 0.0};
    if (o->relative)
        rest = imki_axis_read(&problem->model, row->sensor, row->axis, &still);
    row->residual = reading - (y->value - rest.value);
    for (int k = 0; k < e->axis_parameters[row->sensor][row->axis]; k++) {
        const int p = e->axis_parameter[row->sensor][row->axis][k];
        double by = imki_axis_regressor(y, &x->input, problem->parameter[p]);
        if (o->relative)
            by -= imki_axis_regressor(&rest, &still, problem->parameter[p]);
        add_global(row, p, by);
    }
}

static int observation_rows(const imki_estimator *e, const imki_point *point, size_t index,
                            imki_row *rows)
{
    const imk_calibration *problem = e->problem;
    const imk_observation *observation = &problem->observation[index];
    const int first = e->local_first[index];
    const bool moving = observation->moving;
    exposure x;
    int count = 0;
    expose(e, point, index, &x);
    for (int sensor = 0; sensor < 2; sensor++)
        for (int axis = 0; axis < IMK_AXES_MAX; axis++) {
            const double reading = e->reading[index][sensor][axis];
            if (isnan(reading))
                continue;
            const imki_axis_reading y = imki_axis_read(&problem->model, sensor, axis, &x.input);
            imki_row *row = &rows[count++];
            row->group = moving               ? imki_moving_group(sensor)
                         : sensor == IMK_GYRO ? IMK_GROUP_GYRO
                                              : IMK_GROUP_ACCEL;
            row->part = moving ? imki_moving_part(sensor, axis) : imki_part_of(e, sensor, axis);
            row->sensor = sensor;
            row->axis = axis;
            row->sigma = e->sigma[index][sensor][axis];
            row->known_variance = sensor == IMK_GYRO ? e->known_variance[index][axis] : 0.0;
            row->at_most = sensor == IMK_GYRO && observation->heading_depends
                               ? observation->heading_variance[axis]
                               : 0.0;
            if (e->added[sensor] > 0.0 && !moving) {
                row->known_variance += row->sigma * row->sigma;
                row->sigma = e->added[sensor];
            }
            row->locals = row->globals = 0;
            predict(e, observation, &x, &y, reading, row);
            if (sensor == IMK_GYRO && observation->offset_sigma > 0.0) {
                const int offset = e->offset_global[observation->record] + axis;
                row->residual -= point->global[offset];
                add_global(row, offset, 1.0);
            }
            if (!x.gravity) {
                by_rotations(&x, &y, first, row);
                continue;
            }
            const double rate = imki_dot3(x.input.rate, x.vertical);
            double by[3]; /* the vertical */
            for (int j = 0; j < 3; j++)
                by[j] = y.by_force[j] * problem->gravity + y.by_rate[j] * rate;
            add_local(row, (size_t)first, imki_dot3(by, x.a));
            add_local(row, (size_t)first + 1, imki_dot3(by, x.b));
            if (sensor == IMK_GYRO && e->earth[index]) {
                add_local(row, (size_t)first + 2, imki_dot3(y.by_rate, x.a));
                add_local(row, (size_t)first + 3, imki_dot3(y.by_rate, x.b));
            }
            if (e->vertical_global >= 0)
                add_global(row, e->vertical_global, imki_dot3(y.by_rate, x.vertical));
        }
    return count;
}

static int turn_rows(const imki_estimator *e, const imki_point *point, size_t index, imki_row *rows)
{
    const imk_turn *turn = &e->problem->turn[index];
    const imki_linear_turn *linear = &e->turn[index];
    const double *jacobian = e->turn_jacobian + index * 3 * e->parameters;
    const double *from = point->attitude[turn->from], *to = point->attitude[turn->to];
    double end[3], across[2][3], start[2][3];
    const bool earth = e->earth[turn->from];
    if (!linear->usable)
        return 0;
    for (int j = 0; j < 3; j++) {
        end[j] = imki_dot3(linear->turn + 3 * j, from);
        for (size_t p = 0; p < e->parameters; p++)
            end[j] +=
                jacobian[(size_t)j * e->parameters + p] * (point->global[p] - e->turn_reference[p]);
    }
    if (earth) {
        double moved[3] = {0.0, 0.0, 0.0};
        add_cross(point->horizontal[turn->from], from, moved);
        for (int j = 0; j < 3; j++)
            end[j] += linear->duration * imki_dot3(linear->turn + 3 * j, moved);
    }
    imki_across(to, across[0], across[1]);
    imki_across(from, start[0], start[1]);
    const double u = imki_dot3(across[0], end), v = imki_dot3(across[1], end),
                 s = sqrt(u * u + v * v);
    const double along = imki_dot3(to, end), angle = imk_atan2(s, along);
    const double stretch = s > 1e-9 ? angle / s : 1.0;
    for (int i = 0; i < 2; i++) {
        imki_row *row = &rows[i];
        *row = (imki_row){.group = IMK_GROUP_TURN,
                          .part = IMK_GROUP_TURN,
                          .sensor = -1,
                          .axis = i,
                          .residual = -stretch * imki_dot3(across[i], end),
                          .sigma = linear->sigma};
        const size_t a = (size_t)e->local_first[turn->from], b = (size_t)e->local_first[turn->to];
        for (size_t k = 0; k < 2; k++) {
            double moved[3];
            for (int j = 0; j < 3; j++)
                moved[j] = imki_dot3(linear->turn + 3 * j, start[k]);
            add_local(row, a + k, stretch * imki_dot3(across[i], moved));
        }
        add_local(row, b + (size_t)i, -1.0);
        for (size_t k = 0; earth && k < 2; k++) {
            double by_rate[3] = {0.0, 0.0, 0.0}, moved[3];
            add_cross(start[k], from, by_rate);
            for (int j = 0; j < 3; j++)
                moved[j] = linear->duration * imki_dot3(linear->turn + 3 * j, by_rate);
            add_local(row, a + 2 + k, stretch * imki_dot3(across[i], moved));
        }
        for (size_t p = 0; p < e->parameters; p++) {
            if (e->problem->parameter[p].sensor != IMK_GYRO)
                continue;
            double by = 0.0;
            for (size_t j = 0; j < 3; j++)
                by += across[i][j] * jacobian[j * e->parameters + p];
            add_global(row, (int)p, stretch * by);
        }
    }
    return 2;
}

int imki_item_rows(imki_estimator *e, const imki_point *point, size_t item, imki_row *row)
{
    return item < e->observations ? observation_rows(e, point, item, row)
                                  : turn_rows(e, point, item - e->observations, row);
}

int imki_placement_rows(const imki_estimator *e, const imki_point *point, size_t index,
                        imki_row *row)
{
    const imk_observation *o = &e->problem->observation[index];
    if (o->knowledge != IMK_INPUT_PLACED || e->local_first[index] < 0)
        return 0;
    for (int k = 0; k < 3; k++) {
        row[k] = (imki_row){.part = IMKI_PART_PLACEMENT,
                            .sensor = -1,
                            .axis = k,
                            .residual = -point->attitude[index][k],
                            .sigma = o->placement_sigma};
        add_local(&row[k], (size_t)e->local_first[index] + (size_t)k, 1.0);
    }
    return 3;
}

int imki_term_row(const imki_estimator *e, const imki_point *point, size_t p, imki_row *row)
{
    if (!(e->problem->prior_sigma[p] > 0.0) || !e->problem->prior_guessed[p])
        return 0;
    *row = (imki_row){.part = IMKI_PART_TERMS,
                      .sensor = -1,
                      .residual = e->start[p] - point->global[p],
                      .sigma = e->problem->prior_sigma[p]};
    add_global(row, (int)p, 1.0);
    return 1;
}

void imki_whiten(const imki_estimator *e, int count, imki_row *rows)
{
    for (int i = 0; i < count; i++) {
        imki_row *row = &rows[i];
        const double total = imki_row_variance(e, row), scale = 1.0 / sqrt(total);
        const double scaled = row->sigma * e->factor[row->part];
        row->share = scaled * scaled / total;
        row->residual *= scale;
        for (int k = 0; k < row->locals; k++)
            row->by_local[k] *= scale;
        for (int k = 0; k < row->globals; k++)
            row->by_global[k] *= scale;
    }
}

int imki_whitened_rows(imki_estimator *e, size_t item)
{
    const int count = imki_item_rows(e, &e->now, item, e->row);
    imki_whiten(e, count, e->row);
    return count;
}
