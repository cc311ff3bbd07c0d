/* SPDX-License-Identifier: Apache-2.0 */
/* Which column of a log is which axis of a model, and what the corrected log looks like. */
#include "compensate_parts.h"
#include "log/log_units.h"

#include "imukit/simulate_log.h"

#include <string.h>

static const imk_quantity quantities[2] = {IMK_QUANTITY_ANGULAR_RATE, IMK_QUANTITY_SPECIFIC_FORCE};
static const char *const sensors[2] = {"gyro", "accel"};

static bool in_counts(const imk_log_column *column)
{
    return imk_dimension_equal(column->unit.dimension, imk_unit_of("count").dimension);
}

static size_t columns_of(const imk_log_reader *reader, int sensor)
{
    size_t found = 0;
    for (size_t k = 0; k < imk_log_column_count(reader); k++)
        found += imk_log_column_get(reader, k)->quantity == quantities[sensor];
    return found;
}

/* A reading is in counts when the model has a sensitivity, and only then. */
static int check_unit(const imk_log_column *column, const imk_triad *triad, int sensor,
                      const compensate_options *o, const char *log, const char *name)
{
    bool counts = triad->sensitivity.value[0] != 0;
    if (counts && !in_counts(column))
        return command_failed("%s: %s is in %s, but %s makes counts (%s.sensitivity): these are "
                              "not the readings it describes",
                              log, column->name, column->unit.text, name, sensors[sensor]);
    if (!counts && in_counts(column))
        return command_failed("%s: %s is in counts, but %s does not say what a count is: add "
                              "%s.sensitivity to it",
                              log, column->name, name, sensors[sensor]);
    if (counts && column->increment)
        return command_failed("%s: %s holds increments in counts; expected counts of %s", log,
                              column->name, sensor == IMK_GYRO ? "rate" : "specific force");
    if (counts && o->log.axes)
        return command_misused("--axes turns numbers round, and counts have a zero offset: "
                               "compensate first, then imukit convert --axes");
    return -1;
}

static int match_sensor(const compensate_options *o, const imk_log_reader *reader, const char *log,
                        const char *name, const imk_triad *triad, int sensor,
                        compensate_columns *columns)
{
    int axis[IMK_AXES_MAX], code = -1;
    char label[48];
    imk_triad_axes(triad, axis);
    for (int i = 0; i < triad->axis_count && code < 0; i++) {
        int column = imk_log_column_find(reader, quantities[sensor], axis[i]);
        imk_axis_name(sensors[sensor], axis[i], label);
        columns->axis[sensor][i] = column;
        if (column < 0)
            code = command_failed("%s has no column %s: %s describes %d %s axes, which are all "
                                  "needed",
                                  log, label, name, triad->axis_count, sensors[sensor]);
        else
            code =
                check_unit(imk_log_column_get(reader, (size_t)column), triad, sensor, o, log, name);
    }
    size_t there = columns_of(reader, sensor);
    if (code < 0 && there != (size_t)triad->axis_count)
        code =
            command_failed("%s has %zu %s columns, %s describes %d: they cannot be matched; name "
                           "the log's columns with --columns, - for one to skip",
                           log, there, sensors[sensor], name, triad->axis_count);
    return code;
}

/* The term of the other sensor that needs this one, or NULL. */
static const char *needed_for(const imk_model *model, int sensor)
{
    static const char *const needs[2][2] = {{"accel.lever_arm", ""},
                                            {"gyro.g_sensitivity", "gyro.g2_sensitivity"}};
    const imk_firmware_keys list = compensate_taken_out(model);
    for (int i = 0; i < list.count; i++)
        for (size_t k = 0; k < 2; k++)
            if (strcmp(list.key[i], needs[sensor][k]) == 0)
                return needs[sensor][k];
    return NULL;
}

int compensate_match(const compensate_options *o, const imk_log_reader *reader, const char *log,
                     const char *name, imk_model *model, compensate_columns *columns)
{
    imk_triad *triads[2] = {&model->gyro, &model->accel};
    bool had[2] = {model->gyro.present, model->accel.present};
    int code = -1;
    columns->time = imk_log_column_find(reader, IMK_QUANTITY_TIME, -1);
    columns->temperature = imk_log_column_find(reader, IMK_QUANTITY_TEMPERATURE, -1);
    if (columns_of(reader, 0) + columns_of(reader, 1) == 0)
        return command_failed("%s has no gyro and no accel column: name them with --columns", log);
    for (int sensor = 0; sensor < 2 && code < 0; sensor++) {
        size_t there = columns_of(reader, sensor);
        const char *term = there == 0 && had[sensor] ? needed_for(model, sensor) : NULL;
        if (term)
            return command_failed("%s has no %s columns, which %s of %s needs", log,
                                  sensors[sensor], term, name);
        if (there > 0 && had[sensor])
            code = match_sensor(o, reader, log, name, triads[sensor], sensor, columns);
        else if (there > 0)
            command_warn("not_in_model", "%s describes no %s: these columns are copied as they are",
                         name, sensor == IMK_GYRO ? "gyros" : "accelerometers");
    }
    if (code >= 0)
        return code;
    for (int sensor = 0; sensor < 2; sensor++)
        triads[sensor]->present = had[sensor] && columns_of(reader, sensor) > 0;
    if (!model->gyro.present && !model->accel.present)
        return command_failed("%s describes none of the sensors in %s", name, log);
    return -1;
}

/* Units as read; of counts and increments SI and the usual ones of rates. */
static int choose_unit(const compensate_options *o, int sensor, imk_log_column *column)
{
    const imk_unit due = imk_unit_of(sensor == IMK_GYRO ? "rad/s" : "m/s^2");
    if (in_counts(column))
        column->unit = due;
    else if (column->increment)
        column->unit = sensor == IMK_GYRO ? imk_unit_of("deg/s") : due;
    column->increment = false;
    return sensor == IMK_GYRO ? log_unit_asked("to-gyro-unit", o->to_gyro_unit, &column->unit)
                              : log_unit_asked("to-accel-unit", o->to_accel_unit, &column->unit);
}

/* Axis of the model that a column holds, with its sensor; -1 when it is none. */
static int axis_of(const imk_compensator *c, const compensate_columns *columns, int column,
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
static int add_corrected(const compensate_options *o, const imk_compensator *c, int sensor,
                         int axis, const imk_log_column *source, compensate_columns *columns)
{
    bool solved = c->correction.solves[sensor];
    if (solved && source->axis > 2)
        return -1;
    imk_log_column *column = &columns->column[columns->count];
    *column = *source;
    imk_axis_name(sensors[sensor], source->axis, column->name);
    columns->content[columns->count].source = -1;
    columns->content[columns->count].sensor = sensor;
    columns->content[columns->count].component = solved ? source->axis : axis;
    columns->count++;
    return choose_unit(o, sensor, column);
}

/* Increments became rates on reading. */
static int add_copied(const compensate_options *o, const imk_log_column *source, int index,
                      compensate_columns *columns)
{
    imk_log_column *column = &columns->column[columns->count];
    int sensor = source->quantity == IMK_QUANTITY_ANGULAR_RATE ? IMK_GYRO : IMK_ACCEL;
    *column = *source;
    columns->content[columns->count++].source = index;
    if (!source->increment)
        return -1;
    imk_axis_name(sensors[sensor], source->axis, column->name);
    return choose_unit(o, sensor, column);
}

int compensate_describe(const compensate_options *o, const imk_log_reader *reader,
                        const imk_compensator *compensator, compensate_columns *columns)
{
    int code = -1;
    columns->count = 0;
    for (size_t k = 0; k < imk_log_column_count(reader) && code < 0; k++) {
        const imk_log_column *source = imk_log_column_get(reader, k);
        int sensor, axis = axis_of(compensator, columns, (int)k, &sensor);
        code = axis >= 0 ? add_corrected(o, compensator, sensor, axis, source, columns)
                         : add_copied(o, source, (int)k, columns);
    }
    if (code < 0 && o->flags && columns->count == IMK_LOG_COLUMNS_MAX)
        return command_failed("there is no room for a column of flags beside %d others",
                              IMK_LOG_COLUMNS_MAX);
    if (code < 0 && o->flags) {
        columns->column[columns->count] = (imk_log_column){.name = "flags", .axis = -1};
        columns->column[columns->count].unit.scale = 1;
        columns->content[columns->count].source = -1;
        columns->content[columns->count].sensor = 2;
        columns->count++;
    }
    return code;
}
