/* SPDX-License-Identifier: Apache-2.0 */
/* --procedure repeatability: the logs, or the sections of one, are power cycles of a unit that was
 * not moved; how much bias differs from one to the next. */
#include "calibrate_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What is left out at both ends of a run, and the shortest run, unless told [s]. */
static const double usual_trim = 0.2, usual_minimum = 1.0;

static int take_runs(bench *b, const bench_log *log, imk_static_interval *run)
{
    imk_error error;
    size_t count = 0;
    const calibrate_options *o = b->options;
    const size_t room = IMK_RUNS_MAX - b->run_count;
    const imk_status status = imk_repeatability_runs(
        &log->record, isnan(o->trim) ? usual_trim : o->trim, isnan(o->settle) ? 0 : o->settle,
        isnan(o->minimum) ? usual_minimum : o->minimum, room, run + b->run_count, &count, &error);
    if (status != IMK_OK)
        return command_error(&error, log->path);
    if (count > room)
        return command_failed("these are more than %d runs", IMK_RUNS_MAX);
    b->run_count += count;
    return -1;
}

static int compare(bench *b, const imk_static_interval *run)
{
    imk_error error;
    const bool counts[2] = {b->log[0].record.counts[0], b->log[0].record.counts[1]};
    const double attitude = isnan(b->options->placement) ? 0 : b->options->placement;
    if (b->run_count < 2)
        return command_failed("%zu run: at least two are needed, better ten; give a log for each "
                              "power cycle, or one log with a column of texts that names the runs "
                              "(--section NAME)",
                              b->run_count);
    if (imk_repeatability_of_holds(&b->calibration->model, counts, b->run_count, run, attitude,
                                   0.95, b->runs, &error) == IMK_OK)
        return -1;
    return error.status == IMK_ERROR_UNIT_MISSING ? bench_observe_failed(b, &b->log[0], &error)
                                                  : command_error(&error, NULL);
}

int bench_compare_runs(bench *b)
{
    imk_static_interval *run = malloc(IMK_RUNS_MAX * sizeof *run);
    b->runs = calloc(1, sizeof *b->runs);
    int code = run && b->runs ? -1 : command_failed("memory is exhausted");
    for (size_t k = 0; code < 0 && k < b->log_count; k++)
        code = take_runs(b, &b->log[k], run);
    if (code < 0)
        code = compare(b, run);
    free(run);
    if (code >= 0)
        return code;
    /* Biases differ by some milli-g, which is as many milliradians; hardly by more. */
    if (b->runs->attitude > 10e-3 && isnan(b->options->placement))
        command_warn("attitude",
                     "the forces of the runs differ by up to %.3g mrad: was the unit moved? What a "
                     "change of attitude does to accelerometers looks like a change of bias; keep "
                     "it fixed, or state how well it is put back with --placement 0.1deg",
                     b->runs->attitude * 1e3);
    return -1;
}
