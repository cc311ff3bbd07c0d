/* SPDX-License-Identifier: Apache-2.0 */
/* The columns of a simulated log. */
#include "simulate_parts.h"

#include <math.h>
#include <string.h>

static int parse_unit(const char *option_name, const char *text, const char *fallback,
                      imk_unit *unit)
{
    imk_error error;
    if (!text)
        text = fallback;
    if (imk_unit_parse(text, text + strlen(text), unit, &error) != IMK_OK)
        return command_misused("--%s %s: the unit is not known%s%s", option_name, text,
                               error.expected[0] ? "; " : "", error.expected);
    imk_dimension due = imk_unit_of(fallback).dimension;
    if (!imk_dimension_equal(unit->dimension, due))
        return command_misused("--%s %s: expected %s such as %s", option_name, text,
                               imk_dimension_name(due), imk_dimension_examples(due));
    return -1;
}

static void name_axis(imk_log_column *column, const char *sensor, int axis)
{
    static const char letters[] = "xyz";
    if (axis >= 0 && axis < 3)
        snprintf(column->name, sizeof column->name, "%s_%c", sensor, letters[axis]);
    else
        snprintf(column->name, sizeof column->name, "%s_%d", sensor, axis);
    column->axis = axis;
}

/* The body axis a sensor points along, or -1. */
static int body_axis(const double direction[3])
{
    for (int k = 0; k < 3; k++)
        if (direction[k] >= 1)
            return k;
    return -1;
}

/* Up to three sensors along body axes are called by them; others are numbered. */
static bool along_body_axes(const imk_triad *triad)
{
    bool taken[3] = {false};
    for (int axis = 0; axis < triad->axis_count; axis++) {
        int k = body_axis(triad->direction[axis]);
        if (k < 0 || taken[k])
            return false;
        taken[k] = true;
    }
    return true;
}

/* A kind of sensor as the options want it written. */
typedef struct sensor_columns {
    const char *name;
    imk_quantity quantity;
    imk_unit unit;
    double interval; /* of increments [s]; 0: rates */
} sensor_columns;

static void describe_triad(const imk_triad *triad, const sensor_columns *sensor, log_layout *layout)
{
    bool named = along_body_axes(triad);
    for (int axis = 0; triad->present && axis < triad->axis_count; axis++) {
        imk_log_column *column = &layout->column[layout->count];
        *column = (imk_log_column){.quantity = sensor->quantity, .unit = sensor->unit};
        layout->factor[layout->count] = 1;
        if (triad->sensitivity.value[axis] != 0) {
            column->unit = imk_unit_of("count");
        } else if (sensor->interval > 0) {
            column->increment = true;
            layout->factor[layout->count] = sensor->interval;
        }
        name_axis(column, sensor->name, named ? body_axis(triad->direction[axis]) : axis);
        layout->count++;
        layout->channels++;
    }
}

int time_decimals(double rate, double start)
{
    double scale = 1;
    for (int decimals = 0; decimals < 9; decimals++, scale *= 10)
        if (scale / rate == floor(scale / rate) && scale * start == floor(scale * start))
            return decimals;
    return 9;
}

/* Counts are of the rate, whatever unit is asked for. */
static int check_counts(const simulate_options *o, const imk_model *model)
{
    const bool gyro = model->gyro.present && model->gyro.sensitivity.value[0] != 0;
    const bool accel = model->accel.present && model->accel.sensitivity.value[0] != 0;
    if (o->increments && (gyro || accel))
        return command_misused("--increments: a model with a sensitivity makes counts, which are "
                               "rates; leave the option out");
    if (o->gyro_unit && gyro)
        return command_misused("--gyro-unit %s: the model's gyros have a sensitivity and make "
                               "counts; leave the option out",
                               o->gyro_unit);
    if (o->accel_unit && accel)
        return command_misused("--accel-unit %s: the model's accelerometers have a sensitivity "
                               "and make counts; leave the option out",
                               o->accel_unit);
    return -1;
}

int log_layout_make(const simulate_options *o, const imk_model *model, const scene *s,
                    log_layout *layout)
{
    const bool steps = o->increments;
    sensor_columns gyro = {.name = steps ? "dtheta" : "gyro",
                           .quantity = IMK_QUANTITY_ANGULAR_RATE};
    sensor_columns accel = {.name = steps ? "dvel" : "accel",
                            .quantity = IMK_QUANTITY_SPECIFIC_FORCE};
    gyro.interval = accel.interval = steps ? 1 / s->simulation.rate : 0;
    int code = parse_unit("gyro-unit", o->gyro_unit, steps ? "deg" : "deg/s", &gyro.unit);
    if (code < 0)
        code = parse_unit("accel-unit", o->accel_unit, steps ? "m/s" : "m/s^2", &accel.unit);
    if (code < 0)
        code = check_counts(o, model);
    if (code >= 0)
        return code;
    *layout = (log_layout){.count = 1, .temperature = s->simulation.temperature != NULL};
    layout->column[0] = (imk_log_column){
        .name = "time", .quantity = IMK_QUANTITY_TIME, .axis = -1, .unit = imk_unit_of("s")};
    layout->factor[0] = 1;
    describe_triad(&model->gyro, &gyro, layout);
    describe_triad(&model->accel, &accel, layout);
    if (layout->temperature) {
        layout->factor[layout->count] = 1;
        layout->column[layout->count++] = (imk_log_column){.name = "temperature",
                                                           .quantity = IMK_QUANTITY_TEMPERATURE,
                                                           .axis = -1,
                                                           .unit = imk_unit_of("degC")};
    }
    for (size_t c = 0; c < layout->count; c++)
        layout->decimals[c] =
            c == 0 ? time_decimals(s->simulation.rate, s->start) : (int)o->decimals.value;
    return -1;
}
