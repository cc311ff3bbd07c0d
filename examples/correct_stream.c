/* SPDX-License-Identifier: Apache-2.0 */
/* A loop as firmware has it: readings come one by one, are corrected, and are used.
 *
 *     example_correct_stream
 *
 * A unit with biases, scale factors and accelerometers beside its centre is turned on a table. Its
 * readings are simulated, and those of a perfect unit to compare with. */
#include "imukit/compensate.h"
#include "imukit/motion_script.h"
#include "imukit/simulate.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { RATE = 200, ROWS = 10 * RATE };

/* One array per axis: x, y, z of the gyros, then of the accelerometers. */
typedef struct record {
    double axis[6][ROWS]; /* [rad/s], [m/s^2] */
} record;

static int fail(const char *what, const imk_error *error)
{
    fprintf(stderr, "%s: %s: %s\n", what, error->field, imk_status_text(error->status));
    return EXIT_FAILURE;
}

/* What a calibration may have found. */
static void make_unit(imk_model *unit)
{
    imk_model_default(unit);
    for (int i = 0; i < 3; i++) {
        unit->gyro.bias.fixed.value[i] = 0.05; /* [rad/s] */
        unit->gyro.scale_factor.fixed.value[i] = 2e-3;
        unit->accel.bias.fixed.value[i] = 0.1;              /* [m/s^2] */
        unit->accel.lever_arm.value[i][(i + 1) % 3] = 0.02; /* [m] */
    }
}

static imk_status simulate(const imk_model *model, const imk_trajectory *trajectory, record *r,
                           imk_error *error)
{
    imk_simulation simulation = imk_simulation_default();
    simulation.rate = RATE;
    simulation.motion.trajectory = trajectory;
    double *column[6];
    for (int i = 0; i < 6; i++)
        column[i] = r->axis[i];
    size_t size = (imk_simulator_size(model, &simulation) + 63) / 64 * 64;
    void *memory = aligned_alloc(64, size);
    if (!memory)
        exit(EXIT_FAILURE);
    imk_simulator *simulator;
    imk_status status = imk_simulator_start(model, &simulation, &simulator, memory, size, error);
    if (status == IMK_OK)
        imk_simulator_next(simulator, ROWS, column, NULL);
    free(memory);
    return status;
}

/* Two turns about z with a nod in between. */
static imk_status make_motion(imk_trajectory_piece **piece, imk_trajectory *motion,
                              imk_error *error)
{
    const imk_motion_step steps[] = {
        {.kind = IMK_STEP_ROTATE, .axis = 2, .amount = 6.0, .rate = 3.0},
        {.kind = IMK_STEP_ROTATE, .axis = 1, .amount = 0.5, .rate = 1.0},
        {.kind = IMK_STEP_ROTATE, .axis = 2, .amount = -6.0, .rate = 3.0},
    };
    imk_motion_script script = imk_motion_script_default();
    script.step = steps;
    script.step_count = sizeof steps / sizeof steps[0];
    size_t count;
    imk_status status = imk_motion_script_pieces(&script, &count, error);
    if (status != IMK_OK)
        return status;
    *piece = malloc(count * sizeof **piece);
    if (!*piece)
        exit(EXIT_FAILURE);
    return imk_motion_script_compile(&script, *piece, count, motion, error);
}

/* What a navigator would do with a sample: here, remember how far it is from the truth. */
static void use(const imk_compensator_sample *sample, const record *truth, size_t row,
                double worst[2])
{
    for (int i = 0; i < 3; i++) {
        worst[0] = fmax(worst[0], fabs(sample->rate[i] - truth->axis[i][row]));
        worst[1] = fmax(worst[1], fabs(sample->force[i] - truth->axis[3 + i][row]));
    }
}

int main(void)
{
    /* Large: keep them off the stack. */
    static record readings, truth;
    static imk_model unit, perfect;
    static imk_compensator compensator;
    imk_error error;
    imk_trajectory motion;
    imk_trajectory_piece *piece = NULL;
    make_unit(&unit);
    imk_model_default(&perfect);
    if (make_motion(&piece, &motion, &error) != IMK_OK)
        return fail("motion", &error);
    if (simulate(&unit, &motion, &readings, &error) != IMK_OK ||
        simulate(&perfect, &motion, &truth, &error) != IMK_OK)
        return fail("simulation", &error);
    free(piece);
    if (imk_compensator_start(&compensator, &unit, 1.0 / RATE, NULL, &error) != IMK_OK)
        return fail("model", &error);

    /* With lever arms the output is one sample late: the angular acceleration needs the next one.
     */
    double worst[2] = {0.0, 0.0};
    size_t row = 0;
    imk_compensator_sample sample = {.temperature = (double)NAN};
    for (size_t k = 0; k < ROWS; k++) {
        for (int i = 0; i < 3; i++) {
            sample.reading[IMK_GYRO][i] = readings.axis[i][k];
            sample.reading[IMK_ACCEL][i] = readings.axis[3 + i][k];
        }
        if (imk_compensator_next(&compensator, &sample))
            use(&sample, &truth, row++, worst);
    }
    if (imk_compensator_finish(&compensator, &sample))
        use(&sample, &truth, row++, worst);
    printf("%zu samples; largest errors left: %.1e rad/s, %.1e m/s^2\n", row, worst[0], worst[1]);
    /* The difference of rates misses dt^2/6 of their third derivative, here 3 rad/s 60/(0.5 s)^3
     * where a ramp of 0.5 s begins, times 20 mm: 1.2e-4 m/s^2. */
    return worst[0] < 1e-12 && worst[1] < 1.2e-4 ? EXIT_SUCCESS : EXIT_FAILURE;
}
