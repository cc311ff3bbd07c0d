/* SPDX-License-Identifier: Apache-2.0 */
/* Names and units of the channels of a log. */
#include "channel_units.h"

#include <string.h>

/* Counts are no rate and no force until somebody says what a count is. */
static bool in_counts(const imk_log_column *column)
{
    return imk_dimension_equal(column->unit.dimension, imk_unit_of("count").dimension);
}

channel_kind channel_kind_of(const imk_log_column *column)
{
    if (in_counts(column))
        return CHANNEL_OTHER;
    if (column->quantity == IMK_QUANTITY_ANGULAR_RATE)
        return CHANNEL_GYRO;
    return column->quantity == IMK_QUANTITY_SPECIFIC_FORCE ? CHANNEL_ACCEL : CHANNEL_OTHER;
}

const char *channel_kind_name(channel_kind kind)
{
    static const char *const names[] = {"gyro", "accel", "channel"};
    return names[kind];
}

const char *channel_axis_name(const imk_log_column *column)
{
    static const char *const names[] = {"x", "y", "z"};
    if (channel_kind_of(column) != CHANNEL_OTHER && column->axis >= 0 && column->axis < 3)
        return names[column->axis];
    return column->name;
}

imk_unit channel_plain_unit(const imk_log_column *column)
{
    if (channel_kind_of(column) == CHANNEL_GYRO)
        return imk_unit_of("rad/s");
    if (channel_kind_of(column) == CHANNEL_ACCEL)
        return imk_unit_of("m/s^2");
    imk_unit unit = column->unit;
    if (!(unit.scale > 0) || !unit.text[0]) {
        unit = imk_unit_of("1");
        strcpy(unit.text, "1");
    }
    return unit;
}

imk_unit channel_readable_unit(const imk_log_column *column, double magnitude)
{
    imk_unit plain = channel_plain_unit(column);
    if (channel_kind_of(column) == CHANNEL_OTHER)
        return plain;
    return imk_unit_readable(plain.dimension, magnitude);
}
