/* SPDX-License-Identifier: Apache-2.0 */
/* How the gyros carry the vertical through a turn (calibration_turn.c): against exact motions with
 * known errors, and its derivatives against differences. */
#include "check.h"

#include "calibrate/estimator/calibration_internal.h"
#include "imukit/attitude.h"
#include "imukit/motion_script.h"

#include <stdlib.h>
#include <string.h>

#define DEGREE 0.017453292519943295

enum { RATE = 100, SAMPLES = 400, BEGIN = 90, END = 360 };

typedef struct session {
    imk_calibration calibration;
    imk_model model;
    imk_test_record record;
    imk_observation observation[2];
    imk_turn turn;
    double truth[6][SAMPLES], reading[6][SAMPLES], temperature[SAMPLES], time[SAMPLES];
    double start[3], end[3]; /* up, body axes */
} session;

static void up(const imk_trajectory *trajectory, double time, double direction[3])
{
    imk_motion_state state;
    imk_trajectory_state(trajectory, time, &state);
    for (int i = 0; i < 3; i++)
        direction[i] = -state.c_nb.m[2][i];
}

/* A second of rest, a turn about a skew axis, coning; no Earth. */
static void move(session *b)
{
    const imk_motion_step steps[] = {
        {.kind = IMK_STEP_HOLD, .duration = 1.0},
        {.kind = IMK_STEP_POSE, .duration = 1.0, .angle = {1.1, -0.6, 2.0}},
        {.kind = IMK_STEP_CONING, .axis = 1, .amount = 0.4, .frequency = 1.5, .duration = 1.4},
    };
    imk_motion_script script = imk_motion_script_default();
    script.earth = false;
    script.smoothing = 0.2;
    script.step = steps;
    script.step_count = 3;
    size_t pieces = 0;
    CHECK_OK(imk_motion_script_pieces(&script, &pieces, NULL));
    imk_trajectory_piece *piece = malloc(pieces * sizeof *piece);
    imk_trajectory trajectory;
    CHECK_OK(imk_motion_script_compile(&script, piece, pieces, &trajectory, NULL));
    double boundary[SAMPLES + 1];
    for (int k = 0; k <= SAMPLES; k++)
        boundary[k] = (double)(k - 1) / RATE;
    double *const rate[3] = {b->truth[0], b->truth[1], b->truth[2]};
    double *const force[3] = {b->truth[3], b->truth[4], b->truth[5]};
    imk_trajectory_means(&trajectory, IMK_KERNEL_SCALAR, SAMPLES, boundary, rate, NULL, force);
    up(&trajectory, boundary[BEGIN], b->start);
    up(&trajectory, boundary[END], b->end);
    /* Without Earth nothing is felt at rest: add gravity where it is, by the exact attitude. */
    for (int k = 0; k < SAMPLES; k++) {
        double direction[3];
        up(&trajectory, 0.5 * (boundary[k] + boundary[k + 1]), direction);
        for (int i = 0; i < 3; i++)
            b->truth[3 + i][k] += 9.8 * direction[i];
        b->time[k] = (double)k / RATE;
        b->temperature[k] = 300.0 + 0.01 * k;
    }
    free(piece);
}

/* Readings of the model, which has errors of every kind the turn knows. */
static void read_errors(session *b, const imk_model *truth)
{
    imk_distortion distortion;
    CHECK_OK(imk_distortion_start(&distortion, truth, NULL, IMK_KERNEL_SCALAR, NULL));
    double slope[SAMPLES];
    for (int k = 0; k < SAMPLES; k++)
        slope[k] = 0.01 * RATE;
    const imk_stimulus stimulus = {.angular_rate = {b->truth[0], b->truth[1], b->truth[2]},
                                   .specific_force = {b->truth[3], b->truth[4], b->truth[5]},
                                   .temperature = b->temperature,
                                   .temperature_rate = slope};
    for (int sensor = 0; sensor < 2; sensor++)
        for (int i = 0; i < 3; i++)
            imk_distort(&distortion, sensor, i, &stimulus, SAMPLES, b->reading[3 * sensor + i]);
}

static session *make_session(const imk_model *truth)
{
    session *b = calloc(1, sizeof *b);
    assert_non_null(b);
    move(b);
    read_errors(b, truth);
    b->record = (imk_test_record){
        .name = "bench", .count = SAMPLES, .dt = 1.0 / RATE, .time = b->time, .axis_count = {3, 3}};
    for (int i = 0; i < 3; i++) {
        b->record.reading[IMK_GYRO][i] = b->reading[i];
        b->record.reading[IMK_ACCEL][i] = b->reading[3 + i];
    }
    b->calibration.record[0] = &b->record;
    b->calibration.record_count = 1;
    b->calibration.observation = b->observation;
    b->turn = (imk_turn){.from = 0, .to = 1, .begin = BEGIN, .end = END, .sigma = 1e-3};
    b->model = *truth;
    return b;
}

static imk_model linear_errors(void)
{
    imk_model model;
    imk_model_default(&model);
    for (int i = 0; i < 3; i++) {
        model.gyro.bias.fixed.value[i] = 0.02 * (i - 1.4);
        model.gyro.scale_factor.fixed.value[i] = 0.01 * (1.3 - i);
        model.accel.bias.fixed.value[i] = 0.1 * (i - 0.7);
        model.accel.scale_factor.fixed.value[i] = 0.004 * (i + 1);
        for (int j = 0; j < 3; j++) {
            if (i != j) {
                model.gyro.misalignment.value[i][j] = 0.003 * (i + 1) - 0.004 * j;
                model.gyro.cross_axis.value[i][j] = 0.001 * (j - i);
                model.accel.misalignment.value[i][j] = 0.002 * (i - 2 * j);
            }
            model.gyro.g_sensitivity.value[i][j] = 1e-4 * (i - j + 0.5);
        }
    }
    return model;
}

static double distance(const double a[3], const double b[3])
{
    return hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
}

/* With the true model the vertical arrives where it is. What is left, 1.8e-6 rad, is the coning of
 * higher order that the attitude step cannot see; without its second-order term it is 5.4e-4. */
static void test_exact_motion(void **state)
{
    (void)state;
    const imk_model truth = linear_errors();
    session *b = make_session(&truth);
    imki_turn_prediction prediction;
    imki_turn_predict(&b->calibration, &truth, &b->turn, b->start, &prediction, NULL);
    CHECK_BELOW(distance(prediction.end, b->end), 3e-6);
    assert_true(distance(b->start, b->end) > 0.5);
    /* The same in counts, with a temperature, and without stamps. */
    imk_model counts = truth;
    for (int i = 0; i < 3; i++) {
        counts.gyro.bias.temperature = (imk_temperature_polynomial){
            .order = 2, .reference = 299.0, .minimum = 290.0, .maximum = 310.0};
        counts.gyro.sensitivity.value[i] = 4000.0 + 100.0 * i;
        counts.gyro.zero_offset.value[i] = 32000.0 + i;
        counts.accel.sensitivity.value[i] = 400.0 + 10.0 * i;
        counts.accel.zero_offset.value[i] = 32700.0 + i;
        for (int k = 0; k < SAMPLES; k++) {
            b->reading[i][k] = counts.gyro.zero_offset.value[i] +
                               counts.gyro.sensitivity.value[i] * b->reading[i][k];
            b->reading[3 + i][k] = counts.accel.zero_offset.value[i] +
                                   counts.accel.sensitivity.value[i] * b->reading[3 + i][k];
        }
    }
    b->record.counts[0] = b->record.counts[1] = true;
    b->record.time = NULL;
    imki_turn_prediction again;
    imki_turn_predict(&b->calibration, &counts, &b->turn, b->start, &again, NULL);
    /* Rounding of 32000 counts in 4000: 1e-16 * 8 per sample. */
    CHECK_BELOW(distance(prediction.end, again.end), 1e-12);
    free(b);
}

/* A turn of known angle about the vertical and across it. */
static void test_angle(void **state)
{
    (void)state;
    imk_model truth;
    imk_model_default(&truth);
    session *b = make_session(&truth);
    for (int k = 0; k < SAMPLES; k++) {
        b->reading[0][k] = b->reading[1][k] = 0.0;
        b->reading[2][k] = 0.7;
    }
    const double down[3] = {0.0, 0.0, 1.0}, ahead[3] = {1.0, 0.0, 0.0};
    imki_turn_prediction p;
    imki_turn_predict(&b->calibration, &truth, &b->turn, down, &p, NULL);
    const double angle = 0.7 * (END - BEGIN) / RATE;
    CHECK_CLOSE(p.angle, angle, 1e-13);
    CHECK_CLOSE(distance(p.end, down), 0.0, 1e-13);
    imki_turn_predict(&b->calibration, &truth, &b->turn, ahead, &p, NULL);
    /* Fixed in space, it goes backwards in the body. */
    CHECK_CLOSE(p.end[0], cos(angle), 1e-13);
    CHECK_CLOSE(p.end[1], -sin(angle), 1e-13);
    /* A step of 0.7 rad takes the other branch of the attitude step. */
    b->record.time = NULL;
    b->record.dt = 1.0;
    b->turn.begin = 0;
    b->turn.end = 3;
    imki_turn_predict(&b->calibration, &truth, &b->turn, ahead, &p, NULL);
    CHECK_CLOSE(p.end[0], cos(2.1), 1e-15 * 10);
    CHECK_CLOSE(p.end[1], -sin(2.1), 1e-15 * 10);
    free(b);
}

static void add_parameter(imk_calibration *c, int sensor, int term, int axis, int element)
{
    c->parameter[c->parameter_count++] =
        (imk_model_parameter){(uint8_t)sensor, (uint8_t)term, (uint8_t)axis, (uint8_t)element};
}

static double *value_at(imk_model *m, imk_model_parameter p)
{
    imk_triad *g = &m->gyro;
    switch (p.term) {
    case IMK_MODEL_BIAS:
        return &g->bias.fixed.value[p.axis];
    case IMK_MODEL_SCALE_FACTOR:
        return &g->scale_factor.fixed.value[p.axis];
    case IMK_MODEL_MISALIGNMENT:
        return &g->misalignment.value[p.axis][p.element];
    case IMK_MODEL_CROSS_AXIS:
        return &g->cross_axis.value[p.axis][p.element];
    case IMK_MODEL_K2:
        return &g->nonlinearity.k2.value[p.axis];
    case IMK_MODEL_KOQ:
        return &g->nonlinearity.koq.value[p.axis];
    case IMK_MODEL_K3:
        return &g->nonlinearity.k3.value[p.axis];
    case IMK_MODEL_ASYMMETRY:
        return &g->nonlinearity.asymmetry.value[p.axis];
    case IMK_MODEL_G_SENSITIVITY:
        return &g->g_sensitivity.value[p.axis][p.element];
    case IMK_MODEL_G2_SENSITIVITY:
        return &g->g2_sensitivity.value[p.axis][p.element];
    case IMK_MODEL_BIAS_TEMPERATURE:
        return &g->bias.temperature.coefficient[p.element].value[p.axis];
    case IMK_MODEL_SCALE_TEMPERATURE:
        return &g->scale_factor.temperature.coefficient[p.element].value[p.axis];
    default:
        return &g->bias.temperature_rate.value[p.axis];
    }
}

/* Columns of the jacobian and `turn` against central differences. Sums take the attitude in the
 * middle of a step as the mean of its ends and the rates as constant within it, which is off by
 * (w dt)^2/12, 2e-4 at 5 rad/s, of sums part of which cancels; terms that are not linear change the
 * slope of the readings too, by 1 % here, which the jacobian leaves out. */
static void compare_derivatives(session *b, const imk_model *model, double relative)
{
    imk_calibration *c = &b->calibration;
    double *jacobian = calloc(3 * c->parameter_count, sizeof *jacobian);
    imki_turn_prediction p, plus, minus;
    imki_turn_predict(c, model, &b->turn, b->start, &p, jacobian);
    for (size_t i = 0; i < c->parameter_count; i++) {
        const imk_model_parameter parameter = c->parameter[i];
        const double h = parameter.term == IMK_MODEL_G2_SENSITIVITY ? 1e-7 : 1e-5;
        imk_model moved = *model;
        double size = 0.0, error = 0.0;
        if (parameter.sensor == IMK_GYRO)
            *value_at(&moved, parameter) += h;
        imki_turn_predict(c, &moved, &b->turn, b->start, &plus, NULL);
        if (parameter.sensor == IMK_GYRO)
            *value_at(&moved, parameter) -= 2.0 * h;
        imki_turn_predict(c, &moved, &b->turn, b->start, &minus, NULL);
        for (int j = 0; j < 3; j++) {
            const double slope = (plus.end[j] - minus.end[j]) / (2.0 * h);
            size = fmax(size, fabs(slope));
            error = fmax(error, fabs(slope - jacobian[(size_t)j * c->parameter_count + i]));
        }
        if (error > relative * size)
            fail_msg("parameter %d %d %d: slope %g, off by %g", parameter.term, parameter.axis,
                     parameter.element, size, error);
        assert_true(parameter.sensor == IMK_ACCEL ? error == 0.0 : size > 0.0);
    }
    for (int j = 0; j < 3; j++) {
        double moved[3] = {b->start[0], b->start[1], b->start[2]};
        moved[j] += 1.0;
        imki_turn_predict(c, model, &b->turn, moved, &plus, NULL);
        for (int i = 0; i < 3; i++)
            CHECK_CLOSE(plus.end[i] - p.end[i], p.turn[3 * i + j], 1e-14);
    }
    free(jacobian);
}

static void test_derivatives(void **state)
{
    (void)state;
    imk_model truth = linear_errors();
    truth.gyro.bias.temperature = (imk_temperature_polynomial){
        .order = 2, .reference = 299.0, .minimum = 290.0, .maximum = 310.0};
    truth.gyro.scale_factor.temperature = truth.gyro.bias.temperature;
    session *b = make_session(&truth);
    b->record.temperature = b->temperature;
    imk_calibration *c = &b->calibration;
    add_parameter(c, IMK_ACCEL, IMK_MODEL_BIAS, 0, 0);
    for (int i = 0; i < 3; i++) {
        add_parameter(c, IMK_GYRO, IMK_MODEL_BIAS, i, 0);
        add_parameter(c, IMK_GYRO, IMK_MODEL_SCALE_FACTOR, i, 0);
        add_parameter(c, IMK_GYRO, IMK_MODEL_BIAS_TEMPERATURE, i, 1);
        add_parameter(c, IMK_GYRO, IMK_MODEL_SCALE_TEMPERATURE, i, 0);
        add_parameter(c, IMK_GYRO, IMK_MODEL_TEMPERATURE_RATE, i, 0);
        for (int j = 0; j < 3; j++) {
            if (i != j)
                add_parameter(c, IMK_GYRO, IMK_MODEL_MISALIGNMENT, i, j);
            add_parameter(c, IMK_GYRO, IMK_MODEL_G_SENSITIVITY, i, j);
        }
    }
    add_parameter(c, IMK_GYRO, IMK_MODEL_CROSS_AXIS, 1, 2);
    compare_derivatives(b, &truth, 4e-3);
    free(b);
}

/* Terms that are not linear: taken out of the rates, and their derivatives. */
static void test_nonlinear(void **state)
{
    (void)state;
    imk_model truth = linear_errors();
    for (int i = 0; i < 3; i++) {
        truth.gyro.nonlinearity.k2.value[i] = 1e-3 * (1.5 - i);
        truth.gyro.nonlinearity.koq.value[i] = 1e-3 * (i - 0.5);
        truth.gyro.nonlinearity.k3.value[i] = 3e-4;
        truth.gyro.nonlinearity.asymmetry.value[i] = 2e-3;
        for (int j = 0; j < 6; j++)
            truth.gyro.g2_sensitivity.value[i][j] = 1e-6 * (j - i);
    }
    session *b = make_session(&truth);
    imki_turn_prediction p;
    imki_turn_predict(&b->calibration, &truth, &b->turn, b->start, &p, NULL);
    /* As in test_exact_motion; the terms see the mean of a sample instead of each instant. */
    CHECK_BELOW(distance(p.end, b->end), 1e-5);
    imk_calibration *c = &b->calibration;
    for (int i = 0; i < 3; i++) {
        for (int term = IMK_MODEL_K2; term <= IMK_MODEL_ASYMMETRY; term++)
            add_parameter(c, IMK_GYRO, term, i, 0);
        for (int j = 0; j < 6; j++)
            add_parameter(c, IMK_GYRO, IMK_MODEL_G2_SENSITIVITY, i, j);
    }
    compare_derivatives(b, &truth, 0.06);
    free(b);
}

/* Four gyros, in the directions of a tetrahedron: least squares; and three in one plane, which no
 * solution can come from. */
static void test_redundant(void **state)
{
    (void)state;
    imk_model truth;
    imk_model_default(&truth);
    const double s = 1.0 / sqrt(3.0);
    const double direction[4][3] = {{s, s, s}, {s, -s, -s}, {-s, s, -s}, {-s, -s, s}};
    truth.gyro.axis_count = 4;
    memcpy(truth.gyro.direction, direction, sizeof direction);
    for (int i = 0; i < 4; i++) {
        truth.gyro.bias.fixed.value[i] = 0.01 * i;
        truth.gyro.scale_factor.fixed.value[i] = 0.002 * i;
        truth.gyro.misalignment.value[i][0] = 0.003;
    }
    session *b = make_session(&truth);
    double fourth[SAMPLES];
    imk_distortion distortion;
    CHECK_OK(imk_distortion_start(&distortion, &truth, NULL, IMK_KERNEL_SCALAR, NULL));
    const imk_stimulus stimulus = {.angular_rate = {b->truth[0], b->truth[1], b->truth[2]}};
    imk_distort(&distortion, IMK_GYRO, 3, &stimulus, SAMPLES, fourth);
    b->record.axis_count[IMK_GYRO] = 4;
    b->record.reading[IMK_GYRO][3] = fourth;
    imki_turn_prediction p;
    imki_turn_predict(&b->calibration, &truth, &b->turn, b->start, &p, NULL);
    CHECK_BELOW(distance(p.end, b->end), 3e-6);
    for (int i = 0; i < 4; i++) {
        add_parameter(&b->calibration, IMK_GYRO, IMK_MODEL_BIAS, i, 0);
        add_parameter(&b->calibration, IMK_GYRO, IMK_MODEL_SCALE_FACTOR, i, 0);
        add_parameter(&b->calibration, IMK_GYRO, IMK_MODEL_MISALIGNMENT, i, 0);
    }
    compare_derivatives(b, &truth, 5e-3);
    for (int i = 0; i < 4; i++) {
        truth.gyro.direction[i][2] = 0.0;
        truth.gyro.misalignment.value[i][2] = 0.0;
    }
    imki_turn_predict(&b->calibration, &truth, &b->turn, b->start, &p, NULL);
    assert_true(isnan(p.end[0]) && isnan(p.angle));
    free(b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_exact_motion), cmocka_unit_test(test_angle),
        cmocka_unit_test(test_derivatives),  cmocka_unit_test(test_nonlinear),
        cmocka_unit_test(test_redundant),
    };
    return cmocka_run_group_tests_name("turn", tests, NULL, NULL);
}
