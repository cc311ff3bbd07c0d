/* SPDX-License-Identifier: Apache-2.0 */
/* From a model to a log: ten minutes at 100 Hz of a catalogue device or a model file.
 *
 *     example_simulate_model tactical log.csv
 *
 * The samples come in blocks, so a log of any length needs little memory. */
#include "imukit/io.h"
#include "imukit/simulate.h"

#include <stdio.h>
#include <stdlib.h>

enum { RATE = 100, ROWS = 600 * RATE, BLOCK = 4096, CHANNELS_MAX = 2 * IMK_AXES_MAX };

static int fail(const imk_error *error, const char *source)
{
    char text[512];
    imk_error_text(error, source, text, sizeof text);
    fprintf(stderr, "%s\n", text);
    return EXIT_FAILURE;
}

/* Time, then the channels in the simulator's order: gyro axes, then accelerometer axes. */
static size_t describe_columns(const imk_model *model, imk_log_column *column)
{
    static const char *const unit[] = {"rad/s", "m/s^2"};
    const int axes[] = {model->gyro.present ? model->gyro.axis_count : 0,
                        model->accel.present ? model->accel.axis_count : 0};
    size_t count = 0;
    column[count++] = (imk_log_column){
        .name = "time", .quantity = IMK_QUANTITY_TIME, .axis = -1, .unit = imk_unit_of("s")};
    for (int kind = 0; kind < 2; kind++) {
        for (int axis = 0; axis < axes[kind]; axis++) {
            imk_log_column *c = &column[count++];
            c->quantity = kind == 0 ? IMK_QUANTITY_ANGULAR_RATE : IMK_QUANTITY_SPECIFIC_FORCE;
            c->axis = axis;
            snprintf(c->name, sizeof c->name, "%s_%c", kind == 0 ? "gyro" : "accel",
                     axis < 3 ? 'x' + axis : '0' + axis);
            c->unit = imk_unit_of(unit[kind]);
        }
    }
    return count;
}

int main(int argc, char **argv)
{
    if (argc != 3) {
        fprintf(stderr, "usage: %s MODEL LOG.csv\n", argv[0]);
        return 2;
    }
    static imk_model model; /* large: keep it off the stack */
    imk_error error;
    if (imk_model_open(argv[1], &model, NULL, &error) != IMK_OK)
        return fail(&error, NULL);

    imk_simulation simulation = imk_simulation_default();
    simulation.rate = RATE;
    simulation.seed = 1;

    /* The simulator lives in memory of ours. */
    size_t size = (imk_simulator_size(&model, &simulation) + 63) / 64 * 64;
    void *memory = aligned_alloc(64, size);
    imk_simulator *simulator = NULL;
    if (!memory)
        return EXIT_FAILURE;
    if (imk_simulator_start(memory, size, &model, &simulation, &simulator, &error) != IMK_OK)
        return fail(&error, argv[1]);

    static imk_log_column column[1 + CHANNELS_MAX];
    static double data[1 + CHANNELS_MAX][BLOCK];
    double *block[1 + CHANNELS_MAX];
    for (size_t i = 0; i < 1 + CHANNELS_MAX; i++)
        block[i] = data[i];
    size_t columns = describe_columns(&model, column);
    imk_log_writer *writer = NULL;
    if (imk_log_create(argv[2], columns, column, IMK_LOG_SHORTEST, NULL, ROWS, &writer, &error) !=
        IMK_OK)
        return fail(&error, argv[2]);
    for (size_t row = 0; row < ROWS; row += BLOCK) {
        size_t count = ROWS - row < BLOCK ? ROWS - row : BLOCK;
        for (size_t i = 0; i < count; i++)
            data[0][i] = (double)(row + i) / RATE;
        imk_simulator_next(simulator, count, block + 1, NULL);
        imk_log_write(writer, count, (const double *const *)block, NULL);
    }
    /* An error of any write is kept until here; the file appears complete or not at all. */
    if (imk_log_commit(writer, &error) != IMK_OK)
        return fail(&error, argv[2]);
    free(memory);
    printf("%d rows of %zu columns in %s\n", ROWS, columns, argv[2]);
    return EXIT_SUCCESS;
}
