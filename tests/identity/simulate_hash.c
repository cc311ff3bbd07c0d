/* SPDX-License-Identifier: Apache-2.0 */
/* A simulated log without files: prints a hash of it, the same one on every machine.
 *
 * For processors that only an emulator runs here (tools/check_identity.sh); it needs libimukit and
 * a C library. Every term is present, and the samples are hashed as the decimal text a log has. */
#include "imukit/decimal.h"
#include "imukit/motion_script.h"
#include "imukit/simulate.h"

#include <stdio.h>
#include <stdlib.h>

enum { ROWS = 2000, CHANNELS = 6 };

static const double degree = 0.017453292519943295; /* pi/180 [rad] */

/* Three axes with different values, in the proportions 1 : -2 : 3 or 1 : 2 : 3. */
static void set(imk_axes *axes, double value, double sign)
{
    for (int axis = 0; axis < 3; axis++)
        axes->value[axis] = value * (axis + 1) * (axis == 1 ? sign : 1);
}

static void set_rows(imk_rows *rows, double value)
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            rows->value[i][j] = i == j ? 0 : value * (3 * i + j - 4);
}

/* Terms of a sensor whose signal has the size of `unit`. */
static void set_triad(imk_triad *triad, double unit)
{
    set(&triad->bias.fixed, 1e-3 * unit, -1);
    set(&triad->bias.repeatability, 2e-3 * unit, 1);
    set(&triad->scale_factor.fixed, 1e-4, -1);
    set(&triad->scale_factor.repeatability, 1e-4, 1);
    triad->bias.temperature =
        (imk_temperature_polynomial){.order = 2, .reference = 298, .minimum = 270, .maximum = 310};
    set(&triad->bias.temperature.coefficient[0], 1e-4 * unit, -1);
    set(&triad->bias.temperature.coefficient[1], 1e-6 * unit, 1);
    set(&triad->bias.temperature_rate, 1e-3 * unit, 1);
    set(&triad->bias.hysteresis, 1e-3 * unit, 1);
    set(&triad->bias.warm_up_amplitude, 1e-3 * unit, -1);
    triad->bias.warm_up_time.value = 5;
    set(&triad->nonlinearity.k2, 1e-5, -1);
    set(&triad->nonlinearity.asymmetry, 1e-4, 1);
    set_rows(&triad->misalignment, 2e-4);
    set_rows(&triad->cross_axis, 1e-3);
    imk_noise *noise = &triad->noise;
    set(&noise->white, 1e-3 * unit, 1);
    set(&noise->bias_instability, 1e-4 * unit, 1);
    set(&noise->random_walk, 1e-5 * unit, 1);
    set(&noise->ramp, 1e-7 * unit, -1);
    noise->gauss_markov_count = noise->sinusoid_count = noise->resonance_count = 1;
    set(&noise->gauss_markov[0].sigma, 1e-4 * unit, 1);
    set(&noise->gauss_markov[0].correlation_time, 3, 1);
    set(&noise->sinusoid[0].amplitude, 1e-3 * unit, 1);
    set(&noise->sinusoid[0].frequency, 0.564, 1);
    set(&noise->resonance[0].sigma, 1e-3 * unit, 1);
    set(&noise->resonance[0].frequency, 12.3, 1);
    set(&noise->resonance[0].q, 16, 1);
    set(&triad->bandwidth, 20, 1);
    set(&triad->damping, 0.6, 1);
    set(&triad->range, 10 * unit, 1);
}

/* FNV-1a, 64 bits [FOWLER1991]. */
static uint64_t add_text(uint64_t hash, const char *text, size_t length)
{
    for (size_t i = 0; i < length; i++)
        hash = (hash ^ (unsigned char)text[i]) * 0x100000001B3u;
    return hash;
}

/* A vehicle that starts, turns, and is shaken. */
static const imk_trajectory *make_motion(void)
{
    static const imk_motion_step step[] = {
        {.kind = IMK_STEP_ACCELERATE, .amount = 10, .rate = 3},
        {.kind = IMK_STEP_TURN, .amount = 1, .rate = 0.3, .banked = true},
        {.kind = IMK_STEP_CONING, .axis = 2, .amount = 0.02, .frequency = 3, .duration = 5},
        {.kind = IMK_STEP_HOLD, .duration = 10}};
    static const imk_vibration_line line = {2, 1e-4, 40, 0.3};
    static imk_trajectory trajectory;
    imk_motion_script script = imk_motion_script_default();
    script.step = step;
    script.step_count = sizeof step / sizeof step[0];
    size_t count;
    if (imk_motion_script_pieces(&script, &count, NULL) != IMK_OK)
        return NULL;
    imk_trajectory_piece *piece = malloc(count * sizeof *piece); /* stays till the end */
    if (!piece || imk_motion_script_compile(&script, piece, count, &trajectory, NULL) != IMK_OK)
        return NULL;
    trajectory.line = &line;
    trajectory.line_count = 1;
    return &trajectory;
}

int main(void)
{
    static imk_model model;
    imk_model_default(&model);
    set_triad(&model.gyro, degree);
    set_triad(&model.accel, 9.80665);
    set_rows(&model.gyro.g_sensitivity, 1e-7);
    set_rows(&model.accel.lever_arm, 0.01);
    set_rows(&model.accel.nonlinearity.cross_products, 1e-6);
    /* On one axis each: rounding would hide the last bits of the others. */
    model.gyro.noise.quantization.value[0] = 1e-7;
    model.accel.resolution.value[2] = 1e-4;

    imk_simulation simulation = imk_simulation_default();
    simulation.rate = 100;
    simulation.seed = 1;
    static const double time[] = {0, 10}, temperature[] = {280, 315};
    const imk_temperature_profile profile = {2, time, temperature, 3};
    simulation.motion.trajectory = make_motion();
    simulation.temperature = &profile;

    const size_t size = (imk_simulator_size(&model, &simulation) + 63) / 64 * 64;
    void *memory = aligned_alloc(64, size);
    imk_simulator *simulator = NULL;
    imk_error error;
    if (!memory ||
        imk_simulator_start(&model, &simulation, &simulator, memory, size, &error) != IMK_OK) {
        fprintf(stderr, "not started: %s %s\n", error.field, error.found);
        return EXIT_FAILURE;
    }
    static double sample[CHANNELS][ROWS];
    double *const column[CHANNELS] = {sample[0], sample[1], sample[2],
                                      sample[3], sample[4], sample[5]};
    imk_simulator_next(simulator, ROWS, column, NULL);
    free(memory);

    uint64_t hash = 0xCBF29CE484222325u;
    for (int channel = 0; channel < CHANNELS; channel++) {
        for (int row = 0; row < ROWS; row++) {
            char text[IMK_DECIMAL_SIZE];
            hash = add_text(hash, text, imk_decimal_shortest(sample[channel][row], text));
        }
    }
    printf("%016llx\n", (unsigned long long)hash);
    return EXIT_SUCCESS;
}
