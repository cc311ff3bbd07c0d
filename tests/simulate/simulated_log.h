/* SPDX-License-Identifier: Apache-2.0 */
/* Simulating short logs in tests. Include after check.h. */
#ifndef IMUKIT_TESTS_SIMULATED_LOG_H
#define IMUKIT_TESTS_SIMULATED_LOG_H

#include "imukit/simulate.h"

#include <stdlib.h>

static inline imk_axes axes(double x, double y, double z)
{
    return (imk_axes){.value = {x, y, z}};
}

/* A simulator in memory that begins with it: free() ends it. */
static inline imk_simulator *start_simulator(const imk_model *model,
                                             const imk_simulation *simulation)
{
    const size_t size = imk_simulator_size(model, simulation);
    void *memory = aligned_alloc(64, (size + 63) / 64 * 64);
    assert_non_null(memory);
    imk_simulator *simulator = NULL;
    imk_error error;
    const imk_status status =
        imk_simulator_start(model, simulation, &simulator, memory, size, &error);
    if (status != IMK_OK)
        fail_msg("not started: %s: %s", imk_status_name(status), error.field);
    return simulator;
}

/* `rows` rows of every channel: column c at values[c * rows]; free() it. */
static inline double *simulate_rows(const imk_model *model, const imk_simulation *simulation,
                                    size_t rows)
{
    imk_simulator *simulator = start_simulator(model, simulation);
    const size_t channels = imk_simulator_channels(simulator);
    double *values = malloc(channels * rows * sizeof *values);
    double *columns[2 * IMK_AXES_MAX];
    assert_non_null(values);
    for (size_t c = 0; c < channels; c++)
        columns[c] = values + c * rows;
    imk_simulator_next(simulator, rows, columns, NULL);
    free(simulator);
    return values;
}

#endif
