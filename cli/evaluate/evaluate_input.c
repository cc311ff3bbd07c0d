/* SPDX-License-Identifier: Apache-2.0 */
/* What is read: tables of references and readings; logs with a reference, as the mean reading of
 * every stretch in which it is constant; and the log at rest (--static), identified. */
#include "evaluate_parts.h"

#include "imukit/channel_units.h"

#include "imukit/reference_alignment.h"
#include "imukit/samples.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- channels -------------------------------------------------------------------------------- */

/* The channel of this name, made when there is none; NULL after a message. */
static imk_evaluate_channel *channel_of(evaluation *v, const char *name, imk_unit reference,
                                        imk_unit reading)
{
    for (size_t k = 0; k < v->channel_count; k++) {
        imk_evaluate_channel *c = &v->channel[k];
        if (strcmp(c->name, name) != 0)
            continue;
        if (imk_dimension_equal(c->reference_unit.dimension, reference.dimension) &&
            imk_dimension_equal(c->reading_unit.dimension, reading.dimension))
            return c;
        command_failed("%s is in %s over %s in one file and in %s over %s in another", name,
                       c->reading_unit.text, c->reference_unit.text, reading.text, reference.text);
        return NULL;
    }
    if (v->channel_count == IMK_EVALUATE_CHANNELS) {
        command_failed("there are more than %d columns of readings", IMK_EVALUATE_CHANNELS);
        return NULL;
    }
    imk_evaluate_channel *c = &v->channel[v->channel_count++];
    snprintf(c->name, sizeof c->name, "%s", name);
    c->reference_unit = reference;
    c->reading_unit = reading;
    return c;
}

static void add_reading(imk_evaluate_channel *c, double reference, double reading, double sigma,
                        int direction, int run)
{
    if (c->count == c->capacity) {
        const size_t capacity = c->capacity > 0 ? 2 * c->capacity : 64;
        c->reference = command_memory(c->reference, capacity * sizeof *c->reference);
        c->reading = command_memory(c->reading, capacity * sizeof *c->reading);
        c->sigma = command_memory(c->sigma, capacity * sizeof *c->sigma);
        c->direction = command_memory(c->direction, capacity * sizeof *c->direction);
        c->run = command_memory(c->run, capacity * sizeof *c->run);
        c->capacity = capacity;
    }
    c->reference[c->count] = reference;
    c->reading[c->count] = reading;
    c->sigma[c->count] = sigma;
    c->direction[c->count] = (signed char)direction;
    c->run[c->count++] = run;
}

/* ---- columns --------------------------------------------------------------------------------- */

/* Columns of a table; -1: none. */
typedef struct columns {
    int reference, direction, run, sigma;
} columns;

static int column_of(const imk_log *log, const char *name)
{
    for (size_t c = 0; c < log->column_count; c++)
        if (strcmp(log->column[c].name, name) == 0)
            return (int)c;
    return -1;
}

static bool is_reading(const imk_log_column *column)
{
    return strncmp(column->name, "reading", 7) == 0 && !column->label;
}

static int check_unit(const char *path, const imk_log_column *column)
{
    if (column->label)
        return command_failed("%s: column %s holds texts, expected numbers", path, column->name);
    if (!column->unit.text[0])
        return command_failed("%s: %s has no unit; write it into the header, such as %s [deg/s] or "
                              "%s [count]",
                              path, column->name, column->name, column->name);
    return -1;
}

/* "up", "down" or their like; a number's sign. */
static int read_direction(const imk_log *log, int column, size_t row, int *direction)
{
    const double value = log->data[column][row];
    *direction = value > 0 ? 1 : value < 0 ? -1 : 0;
    if (!log->column[column].label)
        return -1;
    const char *text =
        value >= 0 && value < (double)log->label_count ? log->label[(size_t)value] : "";
    *direction = strcmp(text, "up") == 0 ? 1 : strcmp(text, "down") == 0 ? -1 : 0;
    if (*direction == 0 && text[0] && strcmp(text, "-") != 0)
        return command_failed("row %zu: direction \"%s\"; expected up, down or -", row + 1, text);
    return -1;
}

/* ---- runs ------------------------------------------------------------------------------------ */

/* Values of the column run, and the number of each among all runs. */
typedef struct run_list {
    size_t count, first;
    double value[IMK_EVALUATION_RUNS_MAX];
} run_list;

static int run_number(run_list *runs, double value)
{
    for (size_t k = 0; k < runs->count; k++)
        if (runs->value[k] == value)
            return (int)(runs->first + k);
    if (runs->first + runs->count == IMK_EVALUATION_RUNS_MAX)
        return -1;
    runs->value[runs->count++] = value;
    return (int)(runs->first + runs->count - 1);
}

static int take_row(imk_evaluate_channel *c, const char *path, const imk_log *log,
                    const columns *at, int reading, size_t row, run_list *runs)
{
    int direction = 0;
    int code = at->direction >= 0 ? read_direction(log, at->direction, row, &direction) : -1;
    if (code >= 0)
        return code;
    const double reference = log->data[at->reference][row], value = log->data[reading][row];
    const double sigma = at->sigma >= 0 ? log->data[at->sigma][row] : (double)NAN;
    const int run = run_number(runs, at->run >= 0 ? log->data[at->run][row] : 0.0);
    if (run < 0)
        return command_failed("%s: more than %d runs", path, IMK_EVALUATION_RUNS_MAX);
    const bool referred = fabs(reference) <= IMK_READING_MAX;
    if (!referred || !(fabs(value) <= IMK_READING_MAX))
        return command_failed("%s: row %zu: %s is no number, or beyond 1e60; leave the row out",
                              path, row + 1, referred ? log->column[reading].name : "reference");
    if (at->sigma >= 0 && !(sigma > 0))
        return command_failed("%s: row %zu: sigma should be above 0", path, row + 1);
    add_reading(c, reference, value, sigma, direction, run);
    return -1;
}

static int take_table(evaluation *v, const char *path, const imk_log *log)
{
    const columns at = {column_of(log, "reference"), column_of(log, "direction"),
                        column_of(log, "run"), column_of(log, "sigma")};
    run_list runs = {.first = v->run_count};
    int code = check_unit(path, &log->column[at.reference]);
    for (size_t k = 0; code < 0 && k < log->column_count; k++) {
        const imk_log_column *column = &log->column[k];
        if (!is_reading(column))
            continue;
        const char *name = column->name[7] == '_' ? column->name + 8 : column->name;
        code = check_unit(path, column);
        imk_evaluate_channel *c =
            code < 0 ? channel_of(v, name, log->column[at.reference].unit, column->unit) : NULL;
        if (code < 0 && !c)
            return EXIT_FAILED;
        for (size_t row = 0; code < 0 && row < log->rows; row++)
            code = take_row(c, path, log, &at, (int)k, row, &runs);
    }
    v->run_count += runs.count;
    return code;
}

/* ---- logs ------------------------------------------------------------------------------------ */

/* Rates about other axes up to this part of the own ones, or this [rad/s], do not matter: the
 * Earth's is 7.3e-5. */
static const double across_part = 0.01, across_least = 2e-4;

/* The stretches in which the reference of one axis is constant: what the others do meanwhile, such
 * as the Earth's rate that turns round in them, does not matter. */
static int find_stretches(const calibrate_options *o, const bench_log *log,
                          const imk_test_record *record, imk_reference_stretch **stretch,
                          size_t *count)
{
    imk_error error;
    imk_procedure_settings settings = imk_procedure_default(IMK_PROCEDURE_RATE_TABLE);
    settings.trim = isfinite(o->trim) ? o->trim : settings.trim;
    settings.settle = isfinite(o->settle) ? o->settle : settings.settle;
    settings.minimum = isfinite(o->minimum) ? o->minimum : settings.minimum;
    const size_t size = imk_reference_stretches_workspace_size(record);
    const size_t most = record->count; /* they hold a sample each at least */
    void *workspace = command_memory(NULL, size);
    imk_status status = IMK_OK;
    *count = 256;
    for (size_t capacity = 0; status == IMK_OK && *count > capacity && capacity <= most;) {
        capacity = *count;
        *stretch = command_memory(*stretch, capacity * sizeof **stretch);
        status = imk_reference_stretches(record, &settings, workspace, size, *stretch, capacity,
                                         count, &error);
    }
    free(workspace);
    if (status != IMK_OK)
        return command_error(&error, log->path);
    return *count > 0
               ? -1
               : command_failed("%s: the reference never stays constant for %.3g s: figures need "
                                "steps; imukit calibrate --procedure rate-table takes sines too",
                                log->path, settings.minimum);
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

static int add_stretches(evaluation *v, const bench_log *log, imk_evaluate_channel *c, int sensor,
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
        if (usable)
            add_reading(c, input, mean, sigma > 0 ? sigma : (double)NAN, 0, run);
    }
    return -1;
}

static int take_axis(evaluation *v, const bench_log *log, const double *zero, int sensor, int axis)
{
    static const char *const names[2] = {"gyro", "accel"};
    char name[IMK_EVALUATE_NAME];
    const double most = span(&log->record, sensor, axis);
    if (!isfinite(most))
        return -1;
    size_t count;
    imk_reference_stretch *stretch = NULL;
    snprintf(name, sizeof name, "%s_%c", names[sensor], "xyz"[axis]);
    const imk_unit input = imk_unit_of(sensor == 0 ? "deg/s" : "g");
    const imk_test_record own = record_of_axis(&log->record, sensor, axis, zero);
    int code = find_stretches(&v->options->bench, log, &own, &stretch, &count);
    imk_evaluate_channel *c =
        code < 0
            ? channel_of(v, name, input, log->record.counts[sensor] ? imk_unit_of("count") : input)
            : NULL;
    if (code < 0)
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
    double *zero = command_zeroed(log->record.count * sizeof *zero);
    int code = -1;
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

static int load_log(evaluation *v, const char *path)
{
    imk_error error;
    bench *b = command_zeroed(sizeof *b); /* holds models: 157 kB */
    bench_log log = {.path = path};
    int code = -1;
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

/* ---- files ----------------------------------------------------------------------------------- */

static imk_log_settings table_settings(const evaluation *v)
{
    imk_log_settings settings = log_input_settings(&v->options->bench.log);
    if (!(settings.rate > 0))
        settings.rate = 1; /* a table has no time */
    settings.any_columns = true;
    return settings;
}

/* A table has the columns reference and reading. What cannot be opened is left to the reader of
 * logs, which says why. */
static bool is_table(const evaluation *v, const char *path)
{
    imk_log_reader *reader;
    imk_log_settings settings = table_settings(v);
    bool reference = false, reading = false;
    settings.reopened = true;
    if (command_unless_memory(imk_log_open(path, &settings, &reader, NULL)) != IMK_OK)
        return false;
    for (size_t k = 0; k < imk_log_column_count(reader); k++) {
        const imk_log_column *column = imk_log_column_get(reader, k);
        reference = reference || strcmp(column->name, "reference") == 0;
        reading = reading || is_reading(column);
    }
    imk_log_close(reader);
    return reference && reading;
}

static int load_table(evaluation *v, const char *path)
{
    imk_error error;
    imk_log log;
    const imk_log_settings settings = table_settings(v);
    if (imk_log_load(path, &settings, NULL, NULL, &log, &error) != IMK_OK)
        return command_log_error(&error, path);
    int code = -1;
    if (column_of(&log, "reference") < 0)
        code = command_failed("%s has no column reference and reading", path);
    else if (log.rows == 0)
        code = command_failed("%s: there is a header but no data row", path);
    else
        code = take_table(v, path, &log);
    imk_log_free(&log);
    return code;
}

int evaluate_load(evaluation *v)
{
    int code = -1;
    for (size_t k = 0; code < 0 && k < v->path_count; k++)
        code = is_table(v, v->path[k]) ? load_table(v, v->path[k]) : load_log(v, v->path[k]);
    return code;
}

/* ---- at rest --------------------------------------------------------------------------------- */

static void identify(const imk_even_record *channels, size_t c, double confidence, void *workspace,
                     size_t size, imk_evaluate_rest *rest)
{
    imk_error error;
    const imk_log_column *column = imk_even_record_column(channels, c);
    imk_identify_settings settings = imk_identify_default();
    settings.dt = channels->dt;
    settings.confidence = confidence;
    snprintf(rest->name, sizeof rest->name, "%s", column->name);
    const imk_status status =
        imk_identify_channel(&settings, channels->rows, imk_even_record_data(channels, c),
                             &rest->result, workspace, size, &error);
    rest->identified = status == IMK_OK;
    if (!rest->identified) {
        command_warn("static", "column %s of the log at rest: %s", column->name,
                     imk_status_text(status));
        return;
    }
    rest->unit = imk_channel_readable_unit(column, rest->result.minimum_floor);
    imk_evaluate_rest_figures(rest);
}

int evaluate_load_rest(evaluation *v)
{
    const evaluate_options *o = v->options;
    imk_even_record channels;
    if (!o->rest)
        return -1;
    const int code = log_input_load(&o->bench.log, o->rest, &channels);
    if (code >= 0)
        return code;
    const size_t size = imk_identify_workspace_size(channels.rows);
    void *workspace = command_memory(NULL, size);
    for (size_t c = 0; c < channels.count && v->rest_count < IMK_EVALUATE_CHANNELS; c++)
        identify(&channels, c, o->confidence, workspace, size, &v->rest[v->rest_count++]);
    free(workspace);
    imk_even_record_free(&channels);
    return -1;
}
