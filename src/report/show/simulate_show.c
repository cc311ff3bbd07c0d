/* SPDX-License-Identifier: Apache-2.0 */
/* What was simulated, and the logs that were written: data without text. */
#include "show_internal.h"

static void show_place(const imk_simulation *simulation, imk_result *result)
{
    const bool moves = simulation->motion.trajectory || simulation->motion.recorded;
    if (!imki_begin_object(result, "rest", !moves))
        return;
    imk_result_quantity(result, "latitude", simulation->latitude, "rad");
    imk_result_quantity(result, "height", simulation->height, "m");
    imk_result_quantity(result, "roll", simulation->roll, "rad");
    imk_result_quantity(result, "pitch", simulation->pitch, "rad");
    imk_result_quantity(result, "yaw", simulation->yaw, "rad");
    imk_result_end(result);
}

void imk_show_simulate_inputs(const imk_simulate_log_settings *settings, const char *model,
                              const char *motion, const char *temperature, uint64_t runs,
                              imk_result *result)
{
    const imk_simulation *simulation = &settings->simulation;
    imk_result_object(result, "inputs");
    imk_result_text(result, "model", model);
    imk_result_text(result, "motion", motion);
    imk_result_text(result, "temperature", temperature);
    imk_result_quantity(result, "rate", simulation->rate, "Hz");
    imk_result_quantity(result, "duration", (double)settings->rows / simulation->rate, "s");
    imk_result_count(result, "seed", (long long)simulation->seed);
    imk_result_count(result, "run", simulation->run);
    imk_result_count(result, "runs", (long long)runs);
    imk_result_flag(result, "earth", simulation->earth);
    show_place(simulation, result);
    imk_result_end(result);
}

void imk_show_file(const char *file, uint64_t rows, size_t column_count,
                   const imk_log_column *columns, imk_result *result)
{
    imk_result_text(result, "file", file);
    imk_result_count(result, "rows", (long long)rows);
    imk_result_array(result, "columns");
    for (size_t i = 0; i < column_count; i++) {
        imk_result_object(result, NULL);
        imk_result_text(result, "name", columns[i].name);
        imk_result_text(result, "unit", columns[i].label ? NULL : columns[i].unit.text);
        imk_result_end(result);
    }
    imk_result_end(result);
}

void imk_show_written(const char *key, const char *file, uint64_t rows, size_t column_count,
                      const imk_log_column *columns, imk_result *result)
{
    imk_result_object(result, key);
    imk_show_file(file, rows, column_count, columns, result);
    imk_result_end(result);
}
