/* SPDX-License-Identifier: Apache-2.0 */
/* A turn between two rests: the gyros carry the vertical, and by how much each parameter moves it.
 *
 * A direction v that is fixed in space moves in body axes as v' = -w x v, so that
 *
 *     v(end) = D v(start),   D = product of the steps' rotations, transposed
 *
 * The rates w are the readings y taken through the inverse of the linear terms,
 *
 *     w = P (y - b - G f - n(w)),   P = (J^T J)^-1 J^T,   row i of J = (1 + s_i) e_i + (A + X)_i
 *
 * A parameter p of axis i adds  p phi(w, f)  to its reading, phi one of a few basis functions: 1
 * (bias), a component of w (scale factor, misalignment), of f (g-sensitivity), a product. It moves
 * the rates by -P_i phi dp, and the end by
 *
 *     d end = D ((S_phi P_i) x v(start)) dp,   S_phi = integral of C(t) phi dt,
 *
 * C(t) from the body axes at t to those at the start. So one 3 x 3 sum per basis function is
 * gathered sample by sample, whatever the number of parameters, and mapped to these at the end.
 *
 * Samples are means over their intervals; the rotation vector of an interval is theta + (theta of
 * the one before x theta)/12, which takes out coning to second order [SAVAGE1998a]. Sums take C at
 * the middle of a step as the mean of both ends: their relative error is (w dt)^2/12, which only
 * slows the solver's last steps.
 *
 * The Earth turns below the gyros. The vertical part of its rate turns about the direction carried
 * and does not move it; the horizontal part, of unknown heading, belongs to the turn's sigma
 * (multiposition_sigma.c), or is one of the solver's unknowns (calibration_earth.c). */
#include "axis_reading_internal.h"
#include "calibration_internal.h"

#include "base/algebra/vector_internal.h"
#include "model/model_schema_internal.h"

#include "imukit/attitude.h"
#include "imukit/elementary.h"

#include <math.h>
#include <string.h>

/* Sums of the basis functions: 1, w, f, then what few problems need. */
enum {
    SUM_ONE = 0,
    SUM_RATE = 1,
    SUM_FORCE = 4,
    SUM_LINEAR = 7,  /* as many until here */
    SUM_PRODUCT = 7, /* fx^2, fy^2, fz^2, fx fy, fy fz, fz fx */
    SUM_AXIS = 13,   /* powers of u of each axis: imki_input_powers */
    SUM_OF_AXIS = IMKI_POWERS_MAX,
    SUMS = SUM_AXIS + SUM_OF_AXIS * IMK_AXES_MAX
};

/* From the readings of a sensor to the three components: value = weight (reading - zero). */
typedef struct inverse {
    int count;
    double weight[3][IMK_AXES_MAX]; /* P, by what a unit of the reading is */
    double p[3][IMK_AXES_MAX];      /* P for readings in SI */
    double constant[3];             /* P times what a reading is at rest */
} inverse;

typedef struct turn_model {
    const imk_model *model;
    const imk_test_record *record;
    inverse gyro, accel;
    bool forces;        /* are needed */
    bool force_changes; /* ... also the rates */
    bool force_products, nonlinear;
    double forces_of[IMK_AXES_MAX][3], squares_of[IMK_AXES_MAX][6]; /* G and its like */
    double force_to_rate[3][3];                                     /* P G */
    double temperature, temperature_rate;
} turn_model;

/* P of a triad, scaled for the record's readings. Not a number when its axes span no space. */
static inverse invert(const turn_model *turn, int sensor, const imk_triad *triad)
{
    const imk_test_record *record = turn->record;
    const int count = record->axis_count[sensor];
    double row[IMK_AXES_MAX][3], offset[IMK_AXES_MAX], unit[IMK_AXES_MAX];
    imk_matrix3 normal = {{{0.0}}}, inverse_normal;
    for (int i = 0; i < count; i++) {
        const double s = triad->scale_factor.fixed.value[i] +
                         imki_polynomial_at(&triad->scale_factor.temperature, i, turn->temperature);
        const bool counts = record->counts[sensor] && triad->sensitivity.value[i] != 0.0;
        unit[i] = counts ? 1.0 / triad->sensitivity.value[i] : 1.0;
        offset[i] = triad->bias.fixed.value[i] +
                    imki_polynomial_at(&triad->bias.temperature, i, turn->temperature) +
                    triad->bias.temperature_rate.value[i] * turn->temperature_rate +
                    (counts ? triad->zero_offset.value[i] * unit[i] : 0.0);
        for (int j = 0; j < 3; j++)
            row[i][j] = (1.0 + s) * triad->direction[i][j];
        imki_add_rows(triad, i, IMKI_FORM_SEEN, row[i]);
        for (int j = 0; j < 3; j++)
            for (int k = 0; k < 3; k++)
                normal.m[j][k] += row[i][j] * row[i][k];
    }
    inverse out = {.count = count};
    const bool spans = imk_matrix3_inverse(normal, &inverse_normal) == IMK_OK;
    for (int j = 0; j < 3; j++)
        for (int i = 0; i < count; i++) {
            out.p[j][i] = !spans ? (double)NAN : imki_dot3(inverse_normal.m[j], row[i]);
            out.weight[j][i] = out.p[j][i] * unit[i];
            out.constant[j] += out.p[j][i] * offset[i];
        }
    return out;
}

/* Find the responses of an axis to force. @return true when it is not linear */
static bool take_axis(turn_model *turn, const imk_triad *gyro, int i)
{
    bool any = false;
    memset(turn->forces_of[i], 0, sizeof turn->forces_of[i]);
    memset(turn->squares_of[i], 0, sizeof turn->squares_of[i]);
    imki_add_rows(gyro, i, IMKI_FORM_FORCE, turn->forces_of[i]);
    imki_add_rows(gyro, i, IMKI_FORM_PRODUCT, turn->squares_of[i]);
    for (size_t k = 0; k < imki_input_power_count; k++)
        any = any || imki_term_values(imki_input_powers[k].term, gyro)[i] != 0.0;
    for (int j = 0; j < 6; j++)
        any = any || turn->squares_of[i][j] != 0.0;
    return any;
}

/* Mean temperature over the turn, and its slope. */
static void find_temperature(turn_model *turn, size_t begin, size_t end)
{
    const imk_test_record *record = turn->record;
    turn->temperature = (double)NAN;
    turn->temperature_rate = 0.0;
    if (!record->temperature)
        return;
    double sum = 0.0;
    for (size_t k = begin; k < end; k++)
        sum += record->temperature[k];
    turn->temperature = sum / (double)(end - begin);
    if (end - begin > 1)
        turn->temperature_rate = (record->temperature[end - 1] - record->temperature[begin]) /
                                 ((double)(end - begin - 1) * record->dt);
}

static void prepare(turn_model *turn, const imk_calibration *calibration, const imk_model *model,
                    const imk_turn *which)
{
    turn->model = model;
    turn->record = calibration->record[calibration->observation[which->from].record];
    find_temperature(turn, which->begin, which->end);
    turn->gyro = invert(turn, IMK_GYRO, &model->gyro);
    turn->nonlinear = turn->forces = turn->force_changes = turn->force_products = false;
    for (size_t p = 0; p < calibration->parameter_count; p++) {
        const imk_model_parameter parameter = calibration->parameter[p];
        if (parameter.sensor != IMK_GYRO)
            continue;
        const imki_form form = imki_terms[parameter.term].form;
        turn->forces = turn->forces || form == IMKI_FORM_FORCE || form == IMKI_FORM_PRODUCT;
        turn->force_products = turn->force_products || form == IMKI_FORM_PRODUCT;
        turn->nonlinear = turn->nonlinear || form == IMKI_FORM_POWER;
    }
    for (int i = 0; i < turn->gyro.count; i++)
        turn->nonlinear = take_axis(turn, &model->gyro, i) || turn->nonlinear;
    for (int j = 0; j < 3; j++)
        for (int k = 0; k < 3; k++) {
            turn->force_to_rate[j][k] = 0.0;
            for (int i = 0; i < turn->gyro.count; i++)
                turn->force_to_rate[j][k] += turn->gyro.p[j][i] * turn->forces_of[i][k];
            turn->force_changes = turn->force_changes || turn->force_to_rate[j][k] != 0.0;
        }
    /* A record without accelerometers leaves g-sensitivity out. */
    turn->forces = (turn->forces || turn->force_changes || turn->nonlinear) &&
                   turn->record->axis_count[IMK_ACCEL] >= 3;
    if (turn->forces)
        turn->accel = invert(turn, IMK_ACCEL, &model->accel);
    turn->force_changes = turn->force_changes && turn->forces;
    turn->nonlinear = turn->nonlinear || (turn->forces && turn->force_products);
}

static inline void components(const inverse *from, const double *const *reading, size_t k,
                              double v[3])
{
    v[0] = -from->constant[0];
    v[1] = -from->constant[1];
    v[2] = -from->constant[2];
    for (int i = 0; i < from->count; i++) {
        const double y = reading[i][k];
        v[0] += from->weight[0][i] * y;
        v[1] += from->weight[1][i] * y;
        v[2] += from->weight[2][i] * y;
    }
}

static void products_of(const double f[3], double q[6])
{
    q[0] = f[0] * f[0];
    q[1] = f[1] * f[1];
    q[2] = f[2] * f[2];
    q[3] = f[0] * f[1];
    q[4] = f[1] * f[2];
    q[5] = f[2] * f[0];
}

/* Take the terms that are not linear out of the rates, and say what they were. The fixed point
 * contracts by the slope of the terms, some 1e-3 at most: six rounds reach rounding. */
static void solve_nonlinear(const turn_model *turn, const double f[3], double w[3],
                            double product[6], double power[IMK_AXES_MAX][SUM_OF_AXIS])
{
    const imk_triad *gyro = &turn->model->gyro;
    const double linear[3] = {w[0], w[1], w[2]};
    products_of(f, product);
    for (int round = 0; round < 6; round++) {
        double sum[3] = {0.0, 0.0, 0.0};
        for (int i = 0; i < turn->gyro.count; i++) {
            const double *e = gyro->direction[i];
            const double u = imki_dot3(e, w);
            double n = 0.0;
            for (size_t k = 0; k < imki_input_power_count; k++) {
                power[i][k] = imki_power_at(&imki_input_powers[k], u);
                n += imki_term_values(imki_input_powers[k].term, gyro)[i] * power[i][k];
            }
            for (int j = 0; j < 6; j++)
                n += turn->squares_of[i][j] * product[j];
            for (int j = 0; j < 3; j++)
                sum[j] += turn->gyro.p[j][i] * n;
        }
        for (int j = 0; j < 3; j++)
            w[j] = linear[j] - sum[j];
    }
}

/* C <- C Exp([phi x]), Exp = I + a [phi x] + b [phi x]^2, a = sin(p)/p, b = (1 - cos p)/p^2: series
 * below half a radian, whose first terms left out are below 1e-13. */
static inline void step_rotation(double c[9], double x, double y, double z)
{
    const double s = x * x + y * y + z * z;
    double a, b;
    if (s < 0.25) {
        /* 1/3!, 1/5! ... and 1/2!, 1/4! ..., alternating. */
        const double s2 = s * s, s4 = s2 * s2;
        a = (1.0 - s * (1.0 / 6.0)) + s2 * (1.0 / 120.0 - s * (1.0 / 5040.0)) +
            s4 * (1.0 / 362880.0 - s * (1.0 / 39916800.0));
        b = (0.5 - s * (1.0 / 24.0)) + s2 * (1.0 / 720.0 - s * (1.0 / 40320.0)) +
            s4 * (1.0 / 3628800.0 - s * (1.0 / 479001600.0));
    } else {
        const double angle = sqrt(s);
        const double half = imk_sin(0.5 * angle);
        a = imk_sin(angle) / angle;
        b = 2.0 * half * half / s;
    }
    const double xx = x * x, yy = y * y, zz = z * z;
    const double bxy = b * x * y, bxz = b * x * z, byz = b * y * z;
    const double ax = a * x, ay = a * y, az = a * z;
    const double m00 = 1.0 - b * (yy + zz), m01 = bxy - az, m02 = bxz + ay;
    const double m10 = bxy + az, m11 = 1.0 - b * (xx + zz), m12 = byz - ax;
    const double m20 = bxz - ay, m21 = byz + ax, m22 = 1.0 - b * (xx + yy);
    for (int i = 0; i < 9; i += 3) {
        const double c0 = c[i], c1 = c[i + 1], c2 = c[i + 2];
        c[i] = c0 * m00 + c1 * m10 + c2 * m20;
        c[i + 1] = c0 * m01 + c1 * m11 + c2 * m21;
        c[i + 2] = c0 * m02 + c1 * m12 + c2 * m22;
    }
}

static inline double interval(const imk_test_record *record, size_t k)
{
    return record->time && k > 0 ? record->time[k] - record->time[k - 1] : record->dt;
}

static void gather_others(double sum[SUMS][9], const double h[9], const double product[6],
                          const double power[IMK_AXES_MAX][SUM_OF_AXIS], int axes)
{
    for (int j = 0; j < 6; j++)
        for (int m = 0; m < 9; m++)
            sum[SUM_PRODUCT + j][m] += h[m] * product[j];
    for (int i = 0; i < axes; i++)
        for (size_t j = 0; j < imki_input_power_count; j++)
            for (int m = 0; m < 9; m++)
                sum[SUM_AXIS + SUM_OF_AXIS * i + (int)j][m] += h[m] * power[i][j];
}

/* The loop over the samples: c from the body axes at the end to those at the start. */
static void integrate(const turn_model *turn, size_t begin, size_t end, bool sums, double c[9],
                      double sum[SUMS][9])
{
    const imk_test_record *record = turn->record;
    double before[3] = {0.0, 0.0, 0.0}, f[3] = {0.0, 0.0, 0.0};
    double product[6], power[IMK_AXES_MAX][SUM_OF_AXIS];
    for (size_t k = begin; k < end; k++) {
        const double dt = interval(record, k);
        double w[3];
        components(&turn->gyro, record->reading[IMK_GYRO], k, w);
        if (turn->forces)
            components(&turn->accel, record->reading[IMK_ACCEL], k, f);
        if (turn->force_changes)
            for (int j = 0; j < 3; j++)
                w[j] -= imki_dot3(turn->force_to_rate[j], f);
        if (turn->nonlinear)
            solve_nonlinear(turn, f, w, product, power);
        const double x = w[0] * dt, y = w[1] * dt, z = w[2] * dt;
        const double twelfth = 1.0 / 12.0;
        double h[9];
        for (int m = 0; m < 9; m++)
            h[m] = c[m];
        step_rotation(c, x + twelfth * (before[1] * z - before[2] * y),
                      y + twelfth * (before[2] * x - before[0] * z),
                      z + twelfth * (before[0] * y - before[1] * x));
        before[0] = x;
        before[1] = y;
        before[2] = z;
        if (!sums)
            continue;
        for (int m = 0; m < 9; m++) {
            h[m] = 0.5 * dt * (h[m] + c[m]);
            sum[SUM_ONE][m] += h[m];
        }
        for (int j = 0; j < 3; j++)
            for (int m = 0; m < 9; m++)
                sum[SUM_RATE + j][m] += h[m] * w[j];
        if (turn->forces)
            for (int j = 0; j < 3; j++)
                for (int m = 0; m < 9; m++)
                    sum[SUM_FORCE + j][m] += h[m] * f[j];
        if (turn->nonlinear)
            gather_others(sum, h, product, (const double(*)[SUM_OF_AXIS])power, turn->gyro.count);
    }
}

/* factor S_phi of a parameter's basis function; false when it does not act on the gyros. */
static bool basis(const turn_model *turn, imk_model_parameter parameter, const double sum[SUMS][9],
                  double s[9])
{
    const imk_triad *gyro = &turn->model->gyro;
    const int axis = parameter.axis, element = parameter.element;
    double factor = 1.0;
    int which = SUM_ONE;
    switch (imki_terms[parameter.term].form) {
    case IMKI_FORM_ONE:
        break;
    case IMKI_FORM_WARMTH:
        factor = imki_power_of_warmth(&gyro->bias.temperature, turn->temperature, element + 1);
        break;
    case IMKI_FORM_WARMING:
        factor = turn->temperature_rate;
        break;
    case IMKI_FORM_WARM_INPUT:
        factor =
            imki_power_of_warmth(&gyro->scale_factor.temperature, turn->temperature, element + 1);
        which = -1;
        break;
    case IMKI_FORM_INPUT:
        which = -1;
        break;
    case IMKI_FORM_SEEN:
        which = SUM_RATE + element;
        break;
    case IMKI_FORM_FORCE:
        which = SUM_FORCE + element;
        break;
    case IMKI_FORM_PRODUCT:
        which = SUM_PRODUCT + element;
        break;
    case IMKI_FORM_POWER:
        which = SUM_AXIS + SUM_OF_AXIS * axis + imki_power_of(parameter.term);
        break;
    default:
        return false;
    }
    const double *e = gyro->direction[axis];
    for (int m = 0; m < 9; m++)
        s[m] = factor * (which >= 0 ? sum[which][m]
                                    : e[0] * sum[SUM_RATE][m] + e[1] * sum[SUM_RATE + 1][m] +
                                          e[2] * sum[SUM_RATE + 2][m]);
    return true;
}

/* Columns of the jacobian: D ((S P_i) x start). */
static void map_parameters(const turn_model *turn, const imk_calibration *calibration,
                           const double start[3], const double d[9], const double sum[SUMS][9],
                           double *jacobian)
{
    const size_t count = calibration->parameter_count;
    for (size_t p = 0; p < count; p++) {
        const imk_model_parameter parameter = calibration->parameter[p];
        double s[9], v[3], moved[3] = {0.0, 0.0, 0.0};
        if (parameter.sensor == IMK_GYRO && parameter.axis < turn->gyro.count &&
            basis(turn, parameter, sum, s)) {
            for (int j = 0; j < 3; j++)
                v[j] = s[3 * j] * turn->gyro.p[0][parameter.axis] +
                       s[3 * j + 1] * turn->gyro.p[1][parameter.axis] +
                       s[3 * j + 2] * turn->gyro.p[2][parameter.axis];
            imki_cross3(v, start, moved);
        }
        for (int j = 0; j < 3; j++)
            jacobian[(size_t)j * count + p] = imki_dot3(d + 3 * j, moved);
    }
}

void imki_turn_predict(const imk_calibration *calibration, const imk_model *model,
                       const imk_turn *turn, const double start[3],
                       imki_turn_prediction *prediction, double *jacobian)
{
    turn_model prepared;
    prepare(&prepared, calibration, model, turn);
    double c[9] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
    double sum[SUMS][9];
    const int used = !jacobian ? 0 : prepared.nonlinear ? SUMS : SUM_LINEAR;
    for (int i = 0; i < used; i++)
        for (int m = 0; m < 9; m++)
            sum[i][m] = 0.0;
    integrate(&prepared, turn->begin, turn->end, jacobian != NULL, c, sum);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            prediction->turn[3 * i + j] = c[3 * j + i];
    for (int i = 0; i < 3; i++)
        prediction->end[i] = prediction->turn[3 * i] * start[0] +
                             prediction->turn[3 * i + 1] * start[1] +
                             prediction->turn[3 * i + 2] * start[2];
    const double sx = c[7] - c[5], sy = c[2] - c[6], sz = c[3] - c[1];
    prediction->duration = 0.0;
    for (size_t k = turn->begin; k < turn->end; k++)
        prediction->duration += interval(prepared.record, k);
    prediction->angle = imk_atan2(sqrt(sx * sx + sy * sy + sz * sz), c[0] + c[4] + c[8] - 1.0);
    if (jacobian)
        map_parameters(&prepared, calibration, start, prediction->turn, (const double(*)[9])sum,
                       jacobian);
}
