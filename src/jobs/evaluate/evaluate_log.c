/* SPDX-License-Identifier: Apache-2.0 */
/* Readings as channels: of tables as they stand, and of records of bench tests as the mean of every
 * stretch in which the reference is constant. */
#include "evaluate_job_internal.h"

#include "imukit/channel_units.h"
#include "imukit/reference_alignment.h"
#include "imukit/samples.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- channels -------------------------------------------------------------------------------- */

/* The channel of this name, made when there is none. */
static imk_status channel_of(imk_evaluate_log *v, const char *name, imk_unit reference,
                             imk_unit reading, imk_evaluate_channel **channel, imk_error *error)
{
    for (size_t k = 0; k < v->channel_count; k++) {
        imk_evaluate_channel *c = *channel = &v->channel[k];
        char units[256];
        if (strcmp(c->name, name) != 0)
            continue;
        if (imk_dimension_equal(c->reference_unit.dimension, reference.dimension) &&
            imk_dimension_equal(c->reading_unit.dimension, reading.dimension))
            return IMK_OK;
        snprintf(units, sizeof units, "%s\t%s over %s in one file and in %s over %s", name,
                 c->reading_unit.text, c->reference_unit.text, reading.text, reference.text);
        return imki_fail(&v->findings, error, IMK_ERROR_DIMENSION, "two_units", units, 0, NULL);
    }
    if (v->channel_count == IMK_EVALUATE_CHANNELS)
        return imki_fail(&v->findings, error, IMK_ERROR_RANGE, "too_many_readings", NULL,
                         IMKI_NUMBERS(IMK_EVALUATE_CHANNELS));
    imk_evaluate_channel *c = *channel = &v->channel[v->channel_count++];
    snprintf(c->name, sizeof c->name, "%s", name);
    c->reference_unit = reference;
    c->reading_unit = reading;
    return IMK_OK;
}

static imk_status add_reading(imk_evaluate_log *v, imk_evaluate_channel *c, double reference,
                              double reading, double sigma, int direction, int run,
                              imk_error *error)
{
    imki_arena *memory = v->memory;
    c->reference = imki_arena_extend(memory, c->reference, c->count, sizeof *c->reference);
    c->reading = imki_arena_extend(memory, c->reading, c->count, sizeof *c->reading);
    c->sigma = imki_arena_extend(memory, c->sigma, c->count, sizeof *c->sigma);
    c->direction = imki_arena_extend(memory, c->direction, c->count, sizeof *c->direction);
    c->run = imki_arena_extend(memory, c->run, c->count, sizeof *c->run);
    if (memory->failed)
        return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    c->reference[c->count] = reference;
    c->reading[c->count] = reading;
    c->sigma[c->count] = sigma;
    c->direction[c->count] = (signed char)direction;
    c->run[c->count++] = run;
    return IMK_OK;
}

static imk_status too_many_runs(imk_evaluate_log *v, imk_error *error)
{
    return imki_fail(&v->findings, error, IMK_ERROR_RANGE, "too_many_runs", NULL,
                     IMKI_NUMBERS(IMK_EVALUATION_RUNS_MAX));
}

/* ---- tables ---------------------------------------------------------------------------------- */

/* A table with its columns; -1: none. */
typedef struct readings {
    imk_evaluate_log *v;
    const imk_log *log;
    int reference, direction, run, sigma;
    size_t run_count; /* values of the column run, each a run */
    double run_value[IMK_EVALUATION_RUNS_MAX];
} readings;

static int column_of(size_t count, const imk_log_column *columns, const char *name)
{
    for (size_t c = 0; c < count; c++)
        if (strcmp(columns[c].name, name) == 0)
            return (int)c;
    return -1;
}

static bool is_reading(const imk_log_column *column)
{
    return strncmp(column->name, "reading", 7) == 0 && !column->label;
}

bool imk_evaluate_is_table(size_t column_count, const imk_log_column *columns)
{
    bool reading = false;
    for (size_t k = 0; k < column_count; k++)
        reading = reading || is_reading(&columns[k]);
    return reading && column_of(column_count, columns, "reference") >= 0;
}

static imk_status check_unit(imk_evaluate_log *v, const imk_log_column *column, imk_error *error)
{
    if (column->label)
        return imki_fail(&v->findings, error, IMK_ERROR_SYNTAX, "texts", column->name, 0, NULL);
    if (!column->unit.text[0])
        return imki_fail(&v->findings, error, IMK_ERROR_UNIT_MISSING, "no_unit", column->name, 0,
                         NULL);
    return IMK_OK;
}

/* "up", "down" or their like; a number's sign. */
static imk_status read_direction(const readings *r, size_t row, int *direction, imk_error *error)
{
    const imk_log *log = r->log;
    *direction = 0;
    if (r->direction < 0)
        return IMK_OK;
    const double value = log->data[r->direction][row];
    *direction = value > 0 ? 1 : value < 0 ? -1 : 0;
    if (!log->column[r->direction].label)
        return IMK_OK;
    const char *text =
        value >= 0 && value < (double)log->label_count ? log->label[(size_t)value] : "";
    *direction = strcmp(text, "up") == 0 ? 1 : strcmp(text, "down") == 0 ? -1 : 0;
    if (*direction == 0 && text[0] && strcmp(text, "-") != 0)
        return imki_fail(&r->v->findings, error, IMK_ERROR_SYNTAX, "direction", text,
                         IMKI_NUMBERS((double)row + 1));
    return IMK_OK;
}

/* The number of a run among all; -1: there is no room. */
static int run_number(readings *r, double value)
{
    const size_t first = r->v->run_count;
    for (size_t k = 0; k < r->run_count; k++)
        if (r->run_value[k] == value)
            return (int)(first + k);
    if (first + r->run_count == IMK_EVALUATION_RUNS_MAX)
        return -1;
    r->run_value[r->run_count++] = value;
    return (int)(first + r->run_count - 1);
}

static imk_status take_row(readings *r, imk_evaluate_channel *c, size_t reading, size_t row,
                           imk_error *error)
{
    const imk_log *log = r->log;
    imk_findings *findings = &r->v->findings;
    int direction;
    const imk_status status = read_direction(r, row, &direction, error);
    if (status != IMK_OK)
        return status;
    const double reference = log->data[r->reference][row], value = log->data[reading][row];
    const double sigma = r->sigma >= 0 ? log->data[r->sigma][row] : (double)NAN;
    const int run = run_number(r, r->run >= 0 ? log->data[r->run][row] : 0.0);
    if (run < 0)
        return too_many_runs(r->v, error);
    const bool referred = fabs(reference) <= IMK_READING_MAX;
    if (!referred || !(fabs(value) <= IMK_READING_MAX))
        return imki_fail(findings, error, IMK_ERROR_NOT_FINITE, "no_reading",
                         referred ? log->column[reading].name : "reference",
                         IMKI_NUMBERS((double)row + 1));
    if (r->sigma >= 0 && !(sigma > 0))
        return imki_fail(findings, error, IMK_ERROR_RANGE, "no_sigma", NULL,
                         IMKI_NUMBERS((double)row + 1));
    return add_reading(r->v, c, reference, value, sigma, direction, run, error);
}

static imk_status take_column(readings *r, size_t k, imk_error *error)
{
    const imk_log_column *column = &r->log->column[k];
    const char *name = column->name[7] == '_' ? column->name + 8 : column->name;
    imk_evaluate_channel *c = NULL;
    imk_status status = check_unit(r->v, column, error);
    if (status == IMK_OK)
        status = channel_of(r->v, name, r->log->column[r->reference].unit, column->unit, &c, error);
    for (size_t row = 0; status == IMK_OK && row < r->log->rows; row++)
        status = take_row(r, c, k, row, error);
    return status;
}

imk_status imk_evaluate_table(imk_evaluate_log *evaluation, const imk_log *table, imk_error *error)
{
    const size_t count = table->column_count;
    readings r = {.v = evaluation,
                  .log = table,
                  .reference = column_of(count, table->column, "reference"),
                  .direction = column_of(count, table->column, "direction"),
                  .run = column_of(count, table->column, "run"),
                  .sigma = column_of(count, table->column, "sigma")};
    if (r.reference < 0)
        return imki_fail(&evaluation->findings, error, IMK_ERROR_COLUMN, "no_readings", NULL, 0,
                         NULL);
    if (table->rows == 0)
        return imki_fail(&evaluation->findings, error, IMK_ERROR_EMPTY, "no_rows", NULL, 0, NULL);
    imk_status status = check_unit(evaluation, &table->column[r.reference], error);
    for (size_t k = 0; status == IMK_OK && k < count; k++)
        if (is_reading(&table->column[k]))
            status = take_column(&r, k, error);
    evaluation->run_count += r.run_count;
    return status;
}

/* ---- records --------------------------------------------------------------------------------- */

/* Rates about other axes up to this part of the own ones, or this [rad/s], do not matter: the
 * Earth's is 7.3e-5. */
static const double across_part = 0.01, across_least = 2e-4;

/* The stretches in which the reference of one axis is constant: what the others do meanwhile, such
 * as the Earth's rate that turns round in them, does not matter. */
static imk_status find_stretches(imk_evaluate_log *v, const imk_test_record *record,
                                 imki_arena *scratch, imk_reference_stretch **stretch,
                                 size_t *count, imk_error *error)
{
    const imk_evaluate_log_settings *s = &v->settings;
    imk_procedure_settings settings = imk_procedure_default(IMK_PROCEDURE_RATE_TABLE);
    settings.trim = isfinite(s->trim) ? s->trim : settings.trim;
    settings.settle = isfinite(s->settle) ? s->settle : settings.settle;
    settings.minimum = isfinite(s->minimum) ? s->minimum : settings.minimum;
    const size_t size = imk_reference_stretches_workspace_size(record);
    const size_t most = record->count; /* they hold a sample each at least */
    void *workspace = imki_arena_take(scratch, size);
    imk_status status = IMK_OK;
    *count = 256;
    for (size_t capacity = 0; status == IMK_OK && *count > capacity && capacity <= most;) {
        capacity = *count;
        *stretch = imki_arena_take(scratch, capacity * sizeof **stretch);
        status = scratch->failed ? imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL)
                                 : imk_reference_stretches(record, &settings, *stretch, capacity,
                                                           count, workspace, size, error);
    }
    if (status == IMK_OK && *count == 0)
        status = imki_fail(&v->findings, error, IMK_ERROR_EMPTY, "no_steps", NULL,
                           IMKI_NUMBERS(settings.minimum));
    return status;
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

static imk_status add_stretches(imk_evaluate_log *v, const imk_test_record *record,
                                imk_evaluate_channel *c, int sensor, int axis, double most,
                                size_t count, const imk_reference_stretch *stretch,
                                imk_error *error)
{
    imk_status status = IMK_OK;
    for (size_t k = 0; k < count && status == IMK_OK; k++) {
        const imk_static_interval *r = &stretch[k].reading;
        const double mean = r->mean[sensor][axis], sigma = r->sigma[sensor][axis];
        const double input = input_of(&stretch[k], sensor, axis);
        const bool usable = about_axis(record, &stretch[k], sensor, axis, most) && isfinite(mean) &&
                            isfinite(input);
        const int section = v->settings.sections && r->section >= 0 ? r->section : 0;
        const int run = (int)v->run_count + section;
        c->left_out += !usable;
        if (run >= IMK_EVALUATION_RUNS_MAX)
            return too_many_runs(v, error);
        if (usable)
            status = add_reading(v, c, input, mean, sigma > 0 ? sigma : (double)NAN, 0, run, error);
    }
    return status;
}

static imk_status take_axis(imk_evaluate_log *v, const imk_test_record *record, const double *zero,
                            int sensor, int axis, imk_error *error)
{
    char name[IMK_EVALUATE_NAME];
    const double most = span(record, sensor, axis);
    if (!isfinite(most))
        return IMK_OK;
    size_t count;
    imk_reference_stretch *stretch = NULL;
    imk_evaluate_channel *c;
    imk_axis_name(sensor == 0 ? "gyro" : "accel", axis, name);
    const imk_unit input = imk_unit_of(sensor == 0 ? "deg/s" : "g");
    const imk_unit reading = record->counts[sensor] ? imk_unit_of("count") : input;
    const imk_test_record own = record_of_axis(record, sensor, axis, zero);
    imki_arena scratch = {.allocator = ((imki_arena *)v->memory)->allocator};
    imk_status status = find_stretches(v, &own, &scratch, &stretch, &count, error);
    if (status == IMK_OK)
        status = channel_of(v, name, input, reading, &c, error);
    if (status == IMK_OK) {
        c->of_log = true;
        status = add_stretches(v, record, c, sensor, axis, most, count, stretch, error);
    }
    imki_arena_free(&scratch);
    return status;
}

/* The record with each axis at its place among x, y, z; `zero` stands for those that are missing.
 */
static imk_test_record placed(const imk_calibrate_record *log, const double *zero)
{
    imk_test_record record = log->record;
    for (int sensor = 0; sensor < 2; sensor++) {
        const int count = log->record.axis_count[sensor];
        for (int axis = 0; axis < 3 && count > 0 && count <= 3; axis++)
            record.reading[sensor][axis] = zero;
        for (int i = 0; i < count && count <= 3; i++) {
            /* A record that was not loaded states no axes: they are in order. */
            const int *axis = log->body_axis[sensor];
            const int place = i > 0 && axis[i] <= axis[i - 1] ? i : axis[i];
            record.reading[sensor][place] = log->record.reading[sensor][i];
            record.axis_count[sensor] = place + 1;
        }
    }
    return record;
}

imk_status imk_evaluate_record(imk_evaluate_log *evaluation, const imk_calibrate_record *log,
                               imk_error *error)
{
    imk_evaluate_log *v = evaluation;
    const bool known[2] = {log->record.reference_rate[0] != NULL,
                           log->record.reference_force[0] != NULL};
    if (!known[0] && !known[1])
        return imki_fail(&v->findings, error, IMK_ERROR_KEY_MISSING, "no_reference", NULL, 0, NULL);
    imki_arena scratch = {.allocator = ((imki_arena *)v->memory)->allocator};
    const double *zero = imki_arena_take(&scratch, log->record.count * sizeof *zero);
    imk_test_record record = placed(log, zero);
    imk_status status = zero ? imki_evaluate_align(v, log, &scratch, &record, error)
                             : imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    for (int sensor = 0; sensor < 2; sensor++)
        for (int axis = 0;
             status == IMK_OK && known[sensor] && axis < 3 && axis < record.axis_count[sensor];
             axis++)
            if (record.reading[sensor][axis] != zero)
                status = take_axis(v, &record, zero, sensor, axis, error);
    imki_arena_free(&scratch);
    v->record_count++;
    v->run_count += v->settings.sections && record.section_count > 0 ? record.section_count : 1;
    if (status == IMK_OK && v->channel_count == 0)
        status = imki_fail(&v->findings, error, IMK_ERROR_EMPTY, "no_change", NULL, 0, NULL);
    return status;
}

/* ---- at rest --------------------------------------------------------------------------------- */

imk_status imk_evaluate_at_rest(imk_evaluate_log *evaluation, const imk_even_record *record,
                                imk_error *error)
{
    imki_arena scratch = {.allocator = ((imki_arena *)evaluation->memory)->allocator};
    const size_t size = imk_identify_workspace_size(record->rows);
    void *workspace = imki_arena_take(&scratch, size);
    imk_identify_settings settings = imk_identify_default();
    settings.dt = record->dt;
    settings.confidence = evaluation->settings.confidence;
    for (size_t c = 0;
         workspace && c < record->count && evaluation->rest_count < IMK_EVALUATE_CHANNELS; c++) {
        const imk_log_column *column = imk_even_record_column(record, c);
        imk_evaluate_rest *rest = &evaluation->rest[evaluation->rest_count++];
        snprintf(rest->name, sizeof rest->name, "%s", column->name);
        const imk_status status =
            imk_identify_channel(&settings, record->rows, imk_even_record_data(record, c),
                                 &rest->result, workspace, size, NULL);
        rest->identified = status == IMK_OK;
        if (rest->identified) {
            rest->unit = imk_channel_readable_unit(column, rest->result.minimum_floor);
            imk_evaluate_rest_figures(rest);
        } else {
            imki_find(&evaluation->findings, IMK_FINDING_WARNING, "static", column->name,
                      IMKI_NUMBERS(status));
        }
    }
    imki_arena_free(&scratch);
    return workspace ? IMK_OK : imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
}

/* ---- figures --------------------------------------------------------------------------------- */

void imk_evaluate_scale(imk_evaluate_channel *channel, double sensitivity, double zero)
{
    for (size_t k = 0; k < channel->count; k++) {
        channel->reading[k] = (channel->reading[k] - zero) / sensitivity;
        channel->sigma[k] /= sensitivity;
    }
    channel->reading_unit = channel->reference_unit;
}

void imk_evaluate_channel_settings(const imk_evaluate_log *evaluation,
                                   imk_evaluate_channel *channel)
{
    double largest = 0;
    channel->settings = imk_evaluation_default();
    channel->settings.confidence = evaluation->settings.confidence;
    channel->settings.same_unit =
        imk_dimension_equal(channel->reading_unit.dimension, channel->reference_unit.dimension);
    for (size_t k = 0; k < channel->count; k++)
        largest = fmax(largest, fabs(channel->reference[k]));
    if (channel->of_log)
        channel->settings.level_width = 1e-5 * largest;
}

imk_status imk_evaluate_channel_run(imk_evaluate_log *evaluation, imk_evaluate_channel *channel,
                                    imk_error *error)
{
    imk_evaluate_channel *c = channel;
    bool known = true, directed = false;
    for (size_t k = 0; k < c->count; k++) {
        known = known && isfinite(c->sigma[k]);
        directed = directed || c->direction[k] != 0;
    }
    const imk_evaluation_table table = {.count = c->count,
                                        .reference = c->reference,
                                        .reading = c->reading,
                                        .sigma = known ? c->sigma : NULL,
                                        .direction = directed ? c->direction : NULL,
                                        .run = c->run};
    imki_arena scratch = {.allocator = ((imki_arena *)evaluation->memory)->allocator};
    const size_t size = imk_evaluation_workspace_size(&table);
    void *workspace = imki_arena_take(&scratch, size);
    c->level = imki_arena_take(evaluation->memory, c->count * sizeof *c->level);
    const imk_status status = workspace && c->level
                                  ? imk_evaluate(&table, &c->settings, c->level, c->count,
                                                 &c->result, workspace, size, error)
                                  : imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    imki_arena_free(&scratch);
    if (status == IMK_OK)
        imk_evaluate_channel_figures(c);
    return status;
}
