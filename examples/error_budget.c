/* SPDX-License-Identifier: Apache-2.0 */
/* How far off after an hour, and which term is to blame: of a catalogue device or a model file.
 *
 *     example_error_budget navigation
 *
 * Covariance analysis of a unit at rest, then eight whole runs of Monte Carlo beside it. */
#include "imukit/drift.h"
#include "imukit/io.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { TIMES = 3, RUNS = IMK_DRIFT_LANES };

static int fail(const imk_error *error, const char *source)
{
    char text[512];
    imk_error_text(error, source, text, sizeof text);
    fprintf(stderr, "%s\n", text);
    return EXIT_FAILURE;
}

/* All memory is the caller's. */
static void *memory_of(size_t size)
{
    void *memory = aligned_alloc(64, (size + 63) / 64 * 64);
    if (!memory)
        exit(EXIT_FAILURE);
    return memory;
}

static double horizontal(const imk_drift_moments *m)
{
    return sqrt(m->covariance[0][0] + m->covariance[1][1]);
}

static imk_status budget(const imk_model *model, const imk_drift_settings *settings,
                         imk_error *error)
{
    const size_t size = imk_drift_covariance_size(model, settings);
    void *memory = memory_of(size);
    imk_drift_analysis *analysis = NULL;
    imk_status status = imk_drift_covariance(model, settings, NULL, &analysis, memory, size, error);
    for (size_t t = 0; status == IMK_OK && t < TIMES; t++) {
        const imk_drift_figures figures = imk_drift_figures_of(&analysis->total[t]);
        printf("%6.0f s: half of all units within %.4g m, 95 %% within %.4g m\n", analysis->time[t],
               figures.cep, figures.r95);
    }
    for (size_t s = 0; status == IMK_OK && s < analysis->source_count; s++)
        printf("    %-36s %10.4g m\n", analysis->source[s].text,
               horizontal(&analysis->contribution[s * TIMES + TIMES - 1]));
    free(memory);
    return status;
}

static imk_status some_runs(const imk_model *model, const imk_drift_settings *settings,
                            imk_error *error)
{
    static double errors[RUNS][TIMES][IMK_DRIFT_STATES];
    const size_t size = imk_drift_runs_workspace_size(model, settings);
    void *memory = memory_of(size);
    imk_status status =
        imk_drift_runs(model, settings, 1, 0, RUNS, &errors[0][0][0], memory, size, error);
    for (int run = 0; status == IMK_OK && run < RUNS; run++)
        printf("run %d: %.4g m north, %.4g m east\n", run, errors[run][TIMES - 1][0],
               errors[run][TIMES - 1][1]);
    free(memory);
    return status;
}

int main(int argc, char **argv)
{
    if (argc != 2) {
        fprintf(stderr, "usage: %s MODEL\n", argv[0]);
        return 2;
    }
    static imk_model model; /* large: keep it off the stack */
    imk_error error;
    if (imk_model_open(argv[1], &model, NULL, &error) != IMK_OK)
        return fail(&error, NULL);

    static const double times[TIMES] = {60.0, 600.0, 3600.0};
    imk_drift_settings settings = imk_drift_default();
    settings.time = times;
    settings.time_count = TIMES;
    if (budget(&model, &settings, &error) != IMK_OK ||
        some_runs(&model, &settings, &error) != IMK_OK)
        return fail(&error, argv[1]);
    return EXIT_SUCCESS;
}
