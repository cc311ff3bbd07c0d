/* SPDX-License-Identifier: Apache-2.0 */
/* A log with a reference as tables: the mean reading of every stretch in which the reference is
 * constant. */
#include "evaluate_parts.h"

#include "imukit/reference_alignment.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Rates about other axes up to this part of the own ones, or this [rad/s], do not matter: the
 * Earth's is 7.3e-5. */
static const double across_part = 0.01, across_least = 2e-4;

/* The stretches in which the reference of one axis is constant: what the others do meanwhile, such
 * as the Earth's rate that turns round in them, does not matter. NULL after a message. */
static imk_reference_stretch *find_stretches(const evaluation *v, const bench_log *log,
                                             const imk_test_record *record, size_t *count,
                                             int *code)
{
    imk_error error;
    const calibrate_options *o = &v->options->bench;
    imk_procedure_settings settings = imk_procedure_default(IMK_PROCEDURE_RATE_TABLE);
    settings.trim = isfinite(o->trim) ? o->trim : settings.trim;
    settings.settle = isfinite(o->settle) ? o->settle : settings.settle;
    settings.minimum = isfinite(o->minimum) ? o->minimum : settings.minimum;
    const size_t size = imk_reference_stretches_workspace_size(record);
    const size_t most = record->count; /* they hold a sample each at least */
    void *workspace = malloc(size > 0 ? size : 1);
    imk_reference_stretch *stretch = NULL;
    imk_status status = imk_error_set(&error, IMK_ERROR_MEMORY, "", "", "");
    size_t capacity = 0;
    *count = 256;
    while (workspace && *count > capacity && capacity <= most) {
        capacity = *count;
        free(stretch);
        stretch = malloc(capacity * sizeof *stretch);
        status = stretch ? imk_reference_stretches(record, &settings, workspace, size, stretch,
                                                   capacity, count, &error)
                         : imk_error_set(&error, IMK_ERROR_MEMORY, "", "", "");
        if (status != IMK_OK)
            break;
    }
    free(workspace);
    *code = -1;
    if (status == IMK_OK && *count > 0)
        return stretch;
    free(stretch);
    *code = status == IMK_OK
                ? command_failed("%s: the reference never stays constant for %.3g s: figures need "
                                 "steps; imukit calibrate --procedure rate-table takes sines too",
                                 log->path, settings.minimum)
                : command_error(&error, log->path);
    return NULL;
}

/* The record with the reference of one axis alone; `zero` is a column of zeros. */
static imk_test_record record_of_axis(const imk_test_record *record, int sensor, int axis,
                                      const double *zero)
{
    imk_test_record own = *record;
    for (int k = 0; k < 3; k++) {
        own.reference_rate[k] = sensor != 0 ? NULL : k == axis ? record->reference_rate[k] : zero;
        own.reference_force[k] = sensor != 1 ? NULL : k == axis ? record->reference_force[k] : zero;
        own.reference_acceleration[k] = NULL;
    }
    return own;
}

static double input_of(const imk_reference_stretch *stretch, int sensor, int axis)
{
    return sensor == 0 ? stretch->rate[axis] : stretch->force[axis];
}

/* Largest |reference| of a column; NaN when it hardly changes. */
static double span(const imk_test_record *record, int sensor, int axis)
{
    const double *x = sensor == 0 ? record->reference_rate[axis] : record->reference_force[axis];
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (size_t k = 0; k < record->count; k++) {
        low = x[k] < low ? x[k] : low;
        high = x[k] > high ? x[k] : high;
    }
    const double least = sensor == 0 ? 10 * across_least : 0.1;
    return high - low > least ? fmax(fabs(low), fabs(high)) : (double)NAN;
}

/* A table that turns about another axis shows misalignment, not the figures of this one. A
 * component of gravity is always across an accelerometer. */
static bool about_axis(const imk_test_record *record, const imk_reference_stretch *stretch,
                       int sensor, int axis, double most)
{
    const double limit = fmax(across_part * most, across_least);
    for (int k = 0; sensor == 0 && k < 3; k++)
        for (size_t row = stretch->begin; k != axis && row < stretch->end; row++)
            if (!(fabs(record->reference_rate[k][row]) <= limit))
                return false;
    return true;
}

static imk_unit unit_of_input(int sensor)
{
    return imk_unit_of(sensor == 0 ? "deg/s" : "g");
}

static int add_stretches(evaluation *v, const bench_log *log, evaluate_channel *c, int sensor,
                         int axis, double most, size_t count, const imk_reference_stretch *stretch)
{
    const bool sections = v->options->bench.section != NULL;
    for (size_t k = 0; k < count; k++) {
        const imk_static_interval *r = &stretch[k].reading;
        const double mean = r->mean[sensor][axis], sigma = r->sigma[sensor][axis];
        const double input = input_of(&stretch[k], sensor, axis);
        const bool usable = about_axis(&log->record, &stretch[k], sensor, axis, most) &&
                            isfinite(mean) && isfinite(input);
        const int run = (int)v->run_count + (sections && r->section >= 0 ? r->section : 0);
        c->left_out += !usable;
        if (run >= IMK_EVALUATION_RUNS_MAX)
            return command_failed("%s: more than %d runs", log->path, IMK_EVALUATION_RUNS_MAX);
        if (usable && !evaluate_add(c, input, mean, sigma > 0 ? sigma : (double)NAN, 0, run))
            return command_failed("memory is exhausted");
    }
    return -1;
}

static int take_axis(evaluation *v, const bench_log *log, const double *zero, int sensor, int axis)
{
    static const char *const names[2] = {"gyro", "accel"};
    char name[EVALUATE_NAME];
    const double most = span(&log->record, sensor, axis);
    if (!isfinite(most))
        return -1;
    size_t count;
    int code;
    snprintf(name, sizeof name, "%s_%c", names[sensor], "xyz"[axis]);
    const imk_unit input = unit_of_input(sensor);
    const imk_test_record own = record_of_axis(&log->record, sensor, axis, zero);
    imk_reference_stretch *stretch = find_stretches(v, log, &own, &count, &code);
    if (!stretch)
        return code;
    evaluate_channel *c = evaluate_channel_of(
        v, name, input, log->record.counts[sensor] ? imk_unit_of("count") : input);
    code = c ? add_stretches(v, log, c, sensor, axis, most, count, stretch) : EXIT_FAILED;
    free(stretch);
    if (c)
        c->of_log = true;
    return code;
}

static int take_record(evaluation *v, const bench_log *log)
{
    const size_t channels = v->channel_count;
    if (!log->record.reference_rate[0] && !log->record.reference_force[0])
        return command_failed("%s says nothing about what the unit was exposed to: add --motion "
                              "PROGRAMME, or columns reference_rate_z [deg/s] … or table_rate "
                              "[deg/s] with --table-axis; of a unit at rest: --static %s",
                              log->path, log->path);
    double *zero = calloc(log->record.count, sizeof *zero);
    int code = zero ? -1 : command_failed("memory is exhausted");
    for (int sensor = 0; code < 0 && sensor < 2; sensor++) {
        const bool known = sensor == 0 ? log->record.reference_rate[0] != NULL
                                       : log->record.reference_force[0] != NULL;
        for (int axis = 0; code < 0 && known && axis < 3 && axis < log->record.axis_count[sensor];
             axis++)
            code = take_axis(v, log, zero, sensor, axis);
    }
    free(zero);
    v->run_count +=
        v->options->bench.section && log->record.section_count > 0 ? log->record.section_count : 1;
    if (code < 0 && channels == 0 && v->channel_count == 0)
        code = command_failed("%s: the reference of no axis changes from stretch to stretch: there "
                              "is nothing to compare",
                              log->path);
    return code;
}

int evaluate_load_log(evaluation *v, const char *path)
{
    imk_error error;
    bench *b = calloc(1, sizeof *b); /* holds models: 157 kB */
    bench_log log = {.path = path};
    int code = -1;
    if (!b)
        return command_failed("memory is exhausted");
    v->has_log = true;
    b->options = &v->options->bench;
    b->motion = v->motion;
    if (b->options->motion && !b->motion &&
        imk_motion_read(b->options->motion, NULL, NULL, 1, &b->motion, &error) != IMK_OK)
        code = command_error(&error, b->options->motion);
    if (code < 0)
        code = bench_load(b, &log);
    if (code < 0)
        code = bench_reference(b, &log);
    if (code < 0)
        code = take_record(v, &log);
    bench_log_free(&log);
    v->motion = b->motion;
    free(b);
    return code;
}
