/* SPDX-License-Identifier: Apache-2.0 */
/* Which column of a record is which axis of a model, and what the corrected record looks like. */
#include "compensate_internal.h"

#include "jobs/job_internal.h"

#include "imukit/simulate_log.h"

#include <stdio.h>
#include <string.h>

static const imk_quantity quantities[2] = {IMK_QUANTITY_ANGULAR_RATE, IMK_QUANTITY_SPECIFIC_FORCE};
static const char *const sensors[2] = {"gyro", "accel"};

static bool in_counts(const imk_log_column *column)
{
    return imk_dimension_equal(column->unit.dimension, imk_unit_of("count").dimension);
}

static size_t columns_of(const imk_record_source *source, int sensor)
{
    size_t found = 0;
    for (size_t k = 0; k < source->column_count; k++)
        found += source->columns[k].quantity == quantities[sensor];
    return found;
}

/* A reading is in counts when the model has a sensitivity, and only then. */
static imk_status check_unit(const imk_record_source *source, int index, const imk_triad *triad,
                             int sensor, imk_findings *findings, imk_error *error)
{
    const imk_log_column *column = &source->columns[index];
    const bool counts = triad->sensitivity.value[0] != 0;
    char name[112];
    if (counts && !in_counts(column)) {
        snprintf(name, sizeof name, "%s is in %s", column->name, column->unit.text);
        return imki_fail(findings, error, IMK_ERROR_DIMENSION, "no_counts", name,
                         IMKI_NUMBERS(sensor));
    }
    if (!counts && in_counts(column))
        return imki_fail(findings, error, IMK_ERROR_UNIT_MISSING, "counts", column->name,
                         IMKI_NUMBERS(sensor));
    if (counts && column->increment)
        return imki_fail(findings, error, IMK_ERROR_DIMENSION, "increments_in_counts", column->name,
                         IMKI_NUMBERS(sensor));
    if (counts && source->axes_turned) /* wrong signs, because of the zero offset */
        return imki_fail(findings, error, IMK_ERROR_CONFLICT, "compensate:axes_of_counts", NULL, 0,
                         NULL);
    return IMK_OK;
}

static imk_status match_sensor(const imk_record_source *source, const imk_triad *triad, int sensor,
                               imki_compensate_columns *columns, imk_findings *findings,
                               imk_error *error)
{
    const size_t there = columns_of(source, sensor);
    int axis[IMK_AXES_MAX];
    char label[48];
    imk_status status = IMK_OK;
    imk_triad_axes(triad, axis);
    for (int i = 0; i < triad->axis_count && status == IMK_OK; i++) {
        const int column = imk_record_find(source, quantities[sensor], axis[i]);
        imk_axis_name(sensors[sensor], axis[i], label);
        columns->axis[sensor][i] = column;
        status = column < 0 ? imki_fail(findings, error, IMK_ERROR_COLUMN, "no_axis", label,
                                        IMKI_NUMBERS(triad->axis_count, sensor))
                            : check_unit(source, column, triad, sensor, findings, error);
    }
    if (status == IMK_OK && there != (size_t)triad->axis_count)
        status = imki_fail(findings, error, IMK_ERROR_COLUMN, "axes_do_not_match", NULL,
                           IMKI_NUMBERS((double)there, sensor, triad->axis_count));
    return status;
}

/* The term of the other sensor that needs this one, or NULL. */
static const char *needed_for(const imk_model *model, int sensor)
{
    static const char *const needs[2][2] = {{"accel.lever_arm", ""},
                                            {"gyro.g_sensitivity", "gyro.g2_sensitivity"}};
    const imk_term_keys list = imki_taken_out(model);
    for (int i = 0; i < list.count; i++)
        for (size_t k = 0; k < 2; k++)
            if (strcmp(list.key[i], needs[sensor][k]) == 0)
                return needs[sensor][k];
    return NULL;
}

imk_status imki_compensate_match(const imk_record_source *source, imk_compensate_log *log,
                                 imki_compensate_columns *columns, imk_error *error)
{
    imk_triad *triads[2] = {&log->model.gyro, &log->model.accel};
    imk_findings *findings = &log->findings;
    const size_t there[2] = {columns_of(source, 0), columns_of(source, 1)};
    imk_status status = IMK_OK;
    columns->time = imk_record_find(source, IMK_QUANTITY_TIME, -1);
    columns->temperature = imk_record_find(source, IMK_QUANTITY_TEMPERATURE, -1);
    if (there[0] + there[1] == 0 && !log->model.mag.present)
        return imki_fail(findings, error, IMK_ERROR_COLUMN, "compensate:no_sensor", NULL, 0, NULL);
    for (int sensor = 0; sensor < 2 && status == IMK_OK; sensor++) {
        const bool had = triads[sensor]->present;
        const char *term = there[sensor] == 0 && had ? needed_for(&log->model, sensor) : NULL;
        if (term)
            return imki_fail(findings, error, IMK_ERROR_COLUMN, "sensor_needed", term,
                             IMKI_NUMBERS(sensor));
        if (there[sensor] > 0 && had)
            status = match_sensor(source, triads[sensor], sensor, columns, findings, error);
        else if (there[sensor] > 0)
            imki_find(findings, IMK_FINDING_WARNING, "not_in_model", NULL, IMKI_NUMBERS(sensor));
    }
    if (status != IMK_OK)
        return status;
    for (int sensor = 0; sensor < 2; sensor++)
        triads[sensor]->present = triads[sensor]->present && there[sensor] > 0;
    if (!triads[0]->present && !triads[1]->present && !log->model.mag.present)
        return imki_fail(findings, error, IMK_ERROR_COLUMN, "no_sensor_in_model", NULL, 0, NULL);
    return IMK_OK;
}

/* Units as asked, or as read; of counts and increments SI and the usual ones of rates. */
static void choose_unit(const imk_compensate_log_settings *settings, int sensor,
                        imk_log_column *column)
{
    const imk_unit *asked = sensor == IMK_GYRO ? &settings->gyro_unit : &settings->accel_unit;
    if (asked->scale > 0)
        column->unit = *asked;
    else if (in_counts(column))
        column->unit = imk_unit_of(sensor == IMK_GYRO ? "rad/s" : "m/s^2");
    else if (column->increment)
        column->unit = imk_unit_of(sensor == IMK_GYRO ? "deg/s" : "m/s^2");
    column->increment = false;
}

/* Axis of the model that a column holds, with its sensor; -1 when it is none. */
static int axis_of(const imk_compensator *c, const imki_compensate_columns *columns, int column,
                   int *sensor)
{
    for (*sensor = 0; *sensor < 2; ++*sensor)
        for (int i = 0; i < c->correction.distortion.axis_count[*sensor]; i++)
            if (columns->axis[*sensor][i] == column)
                return i;
    return -1;
}

/* A column of corrected values: of a body axis where three are solved for, else of the axis itself.
 * The fourth and further of redundant sensors have no place in the result. */
static void add_corrected(const imk_compensate_log *log, int sensor, int axis,
                          const imk_log_column *source, imki_compensate_columns *columns)
{
    const bool solved = log->compensator.correction.solves[sensor];
    if (solved && source->axis > 2)
        return;
    imk_log_column *column = &columns->column[columns->count];
    *column = *source;
    imk_axis_name(sensors[sensor], source->axis, column->name);
    columns->content[columns->count].source = -1;
    columns->content[columns->count].sensor = sensor;
    columns->content[columns->count].component = solved ? source->axis : axis;
    columns->count++;
    choose_unit(&log->settings, sensor, column);
}

/* Increments became rates on reading. */
static void add_copied(const imk_compensate_log_settings *settings, const imk_log_column *source,
                       int index, imki_compensate_columns *columns)
{
    imk_log_column *column = &columns->column[columns->count];
    const int sensor = source->quantity == IMK_QUANTITY_ANGULAR_RATE ? IMK_GYRO : IMK_ACCEL;
    *column = *source;
    columns->content[columns->count++].source = index;
    if (!source->increment)
        return;
    imk_axis_name(sensors[sensor], source->axis, column->name);
    choose_unit(settings, sensor, column);
}

imk_status imki_compensate_describe(const imk_record_source *source, imk_compensate_log *log,
                                    imki_compensate_columns *columns, imk_error *error)
{
    columns->count = 0;
    for (size_t k = 0; k < source->column_count; k++) {
        int sensor, axis = axis_of(&log->compensator, columns, (int)k, &sensor);
        if (axis >= 0)
            add_corrected(log, sensor, axis, &source->columns[k], columns);
        else
            add_copied(&log->settings, &source->columns[k], (int)k, columns);
    }
    if (log->settings.flags && columns->count == IMK_LOG_COLUMNS_MAX)
        return imki_fail(&log->findings, error, IMK_ERROR_COLUMN, "no_room_for_flags", NULL,
                         IMKI_NUMBERS(IMK_LOG_COLUMNS_MAX));
    if (log->settings.flags) {
        columns->column[columns->count] = (imk_log_column){.name = "flags", .axis = -1};
        columns->column[columns->count].unit.scale = 1;
        columns->content[columns->count].source = -1;
        columns->content[columns->count].sensor = 2;
        columns->count++;
    }
    return IMK_OK;
}
