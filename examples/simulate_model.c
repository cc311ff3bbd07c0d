/* SPDX-License-Identifier: Apache-2.0 */
/* From a model to a log: ten minutes at 100 Hz of a catalogue device or a model file.
 *
 *     example_simulate_model tactical log.csv
 *
 * The rows go to the log as they are made, so one of any length needs little memory. */
#include "imukit/io.h"
#include "imukit/jobs.h"

#include <stdio.h>
#include <stdlib.h>

static imk_status simulate(const imk_model *model, const char *path, imk_error *error)
{
    imk_simulate_log_settings settings = imk_simulate_log_default();
    settings.simulation.rate = 100;
    settings.simulation.seed = 1;
    settings.rows = 60000;
    imk_log_sink log = {.path = path};
    const imk_record_sink sink = imk_log_sink_of(&log);
    const imk_status status =
        imk_simulate_log_run(model, &settings, &sink, "simulating", NULL, error);
    return imk_log_sink_end(&log, status, error);
}

int main(int argc, char **argv)
{
    if (argc != 3) {
        fprintf(stderr, "usage: %s MODEL LOG.csv\n", argv[0]);
        return 2;
    }
    static imk_model model; /* large: keep it off the stack */
    imk_error error;
    imk_status status = imk_model_open(argv[1], &model, NULL, &error);
    if (status == IMK_OK)
        status = simulate(&model, argv[2], &error);
    if (status != IMK_OK) {
        char text[512];
        imk_error_text(&error, NULL, text, sizeof text);
        fprintf(stderr, "%s\n", text);
        return EXIT_FAILURE;
    }
    printf("%s: ten minutes of %s\n", argv[2], model.name);
    return 0;
}
