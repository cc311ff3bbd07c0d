/* SPDX-License-Identifier: Apache-2.0 */
/* A magnetometer in the simulator: it sees the field in body axes through hard and soft iron, and
 * changes no other channel. */
#include "check.h"

#include "imukit/motion.h"
#include "imukit/simulate.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CHANNELS = 9, ROWS = 4096 };

static const double field[3] = {20e-6, 1e-6, 43e-6}; /* north, east, down */

static double samples[CHANNELS][ROWS];

static void iron(imk_model *model)
{
    static const double bias[3] = {12e-6, -8e-6, 30e-6}, scale[3] = {0.02, -0.03, 0.05};
    imk_model_default(model);
    model->mag.present = true;
    for (int i = 0; i < 3; i++) {
        model->mag.bias.fixed.value[i] = bias[i];
        model->mag.scale_factor.fixed.value[i] = scale[i];
        for (int j = 0; j < 3; j++)
            model->mag.cross_axis.value[i][j] = i == j ? 0 : 0.01 * (i - 2 * j + 1);
    }
}

static imk_status run(const imk_model *model, const imk_simulation *simulation, size_t *channels)
{
    const size_t size = imk_simulator_size(model, simulation);
    void *memory = malloc(size);
    imk_simulator *simulator;
    imk_error error;
    double *columns[CHANNELS];
    for (int c = 0; c < CHANNELS; c++)
        columns[c] = samples[c];
    const imk_status status =
        imk_simulator_start(model, simulation, &simulator, memory, size, &error);
    if (status == IMK_OK) {
        *channels = imk_simulator_channels(simulator);
        imk_simulator_next(simulator, ROWS, columns, NULL);
    }
    free(memory);
    return status;
}

static imk_simulation magnetic(void)
{
    imk_simulation simulation = imk_simulation_default();
    memcpy(simulation.field, field, sizeof field);
    return simulation;
}

/* bias + (I + S) C^T field, with the attitude by hand. */
static void check_reading(const imk_model *model, const double body[3], size_t row,
                          double tolerance)
{
    for (int i = 0; i < 3; i++) {
        double due =
            model->mag.bias.fixed.value[i] + (1 + model->mag.scale_factor.fixed.value[i]) * body[i];
        for (int j = 0; j < 3; j++)
            due += model->mag.cross_axis.value[i][j] * body[j];
        CHECK_CLOSE(samples[6 + i][row], due, tolerance);
    }
}

static void test_rest(void **state)
{
    (void)state;
    imk_model model;
    size_t channels;
    iron(&model);
    imk_simulation simulation = magnetic();
    CHECK_OK(run(&model, &simulation, &channels));
    assert_int_equal(channels, 9);
    check_reading(&model, field, 0, 1e-18);
    /* Turned to the east, x looks where y did. */
    simulation.yaw = 1.5707963267948966;
    CHECK_OK(run(&model, &simulation, &channels));
    check_reading(&model, (double[3]){field[1], -field[0], field[2]}, 7, 1e-18);
    /* On its back: y and z are turned round. */
    simulation.yaw = 0;
    simulation.roll = 3.141592653589793;
    CHECK_OK(run(&model, &simulation, &channels));
    check_reading(&model, (double[3]){field[0], -field[1], -field[2]}, ROWS - 1, 1e-18);
}

/* A turn about the vertical without Earth, by the angle 2 atan(t/20 s): the field turns back. Row k
 * covers (k - 1)/100 s to k/100 s, and the field is taken in the middle. */
static void test_turning(void **state)
{
    (void)state;
    imk_model model;
    size_t channels;
    iron(&model);
    imk_simulation simulation = magnetic();
    imk_trajectory_piece piece;
    imk_trajectory trajectory;
    CHECK_OK(imk_trajectory_standstill((imk_geodetic){0, 0, 0}, (double[3]){0, 0, 0}, false, &piece,
                                       &trajectory, NULL));
    piece.quaternion[3][1] = 0.05;
    piece.length = 100;
    simulation.motion.trajectory = &trajectory;
    simulation.earth = false;
    CHECK_OK(run(&model, &simulation, &channels));
    for (size_t row = 1; row < ROWS; row += 97) { /* 41 s, 2.2 rad */
        const double angle = 2 * atan(((double)row - 0.5) / 2000), c = cos(angle), s = sin(angle);
        check_reading(
            &model, (double[3]){c * field[0] + s * field[1], c * field[1] - s * field[0], field[2]},
            row, 1e-15);
    }
}

static void test_noise(void **state)
{
    (void)state;
    imk_model model;
    size_t channels;
    iron(&model);
    const imk_simulation simulation = magnetic();
    for (int i = 0; i < 3; i++)
        model.mag.noise.white.value[i] = 1e-8;
    CHECK_OK(run(&model, &simulation, &channels));
    for (int c = 6; c < 9; c++) {
        double sum = 0, squares = 0;
        for (size_t k = 0; k < ROWS; k++) {
            const double x = samples[c][k] - samples[c][0];
            sum += x;
            squares += x * x;
        }
        const double variance = squares / ROWS - sum / ROWS * (sum / ROWS);
        /* N^2 rate; its estimate is known to sqrt(2/4096): five of them */
        CHECK_RELATIVE(variance, 1e-16 * 100, 5 * sqrt(2.0 / ROWS));
    }
}

/* The other channels are the same bytes with a magnetometer and without. */
static void test_others_unchanged(void **state)
{
    (void)state;
    static double before[6][ROWS];
    imk_model model;
    size_t channels;
    iron(&model);
    for (int i = 0; i < 3; i++)
        model.gyro.noise.white.value[i] = model.accel.noise.white.value[i] = 1e-3;
    imk_simulation simulation = imk_simulation_default();
    CHECK_OK(run(&model, &simulation, &channels));
    assert_int_equal(channels, 6);
    memcpy(before, samples, sizeof before);
    simulation = magnetic();
    CHECK_OK(run(&model, &simulation, &channels));
    assert_memory_equal(before, samples, sizeof before);
}

static void test_refusals(void **state)
{
    (void)state;
    imk_model model;
    size_t channels;
    double zero[ROWS] = {0};
    iron(&model);
    imk_simulation simulation = magnetic();
    const imk_recorded_motion recorded = {.rate = 100,
                                          .count = ROWS,
                                          .angular_rate = {zero, zero, zero},
                                          .specific_force = {zero, zero, zero}};
    simulation.motion.recorded = &recorded;
    CHECK_STATUS(run(&model, &simulation, &channels), IMK_ERROR_CONFLICT);
    simulation.motion.recorded = NULL;
    simulation.field[1] = 2;
    CHECK_STATUS(run(&model, &simulation, &channels), IMK_ERROR_RANGE);
    model.mag.lever_arm.value[0][0] = 1;
    simulation = magnetic();
    CHECK_STATUS(run(&model, &simulation, &channels), IMK_ERROR_CONFLICT);
}

/* At 45 deg the dipole points twice as steeply down as north, and is sqrt(2.5) of the equator's. */
static void test_dipole(void **state)
{
    (void)state;
    double at[3];
    imk_dipole_field(0.78539816339744831, at);
    CHECK_RELATIVE(at[2] / at[0], 2, 1e-12);
    CHECK_RELATIVE(sqrt(at[0] * at[0] + at[2] * at[2]), 29.35e-6 * sqrt(2.5), 1e-12);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rest),   cmocka_unit_test(test_turning),
        cmocka_unit_test(test_noise),  cmocka_unit_test(test_others_unchanged),
        cmocka_unit_test(test_dipole), cmocka_unit_test(test_refusals)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
