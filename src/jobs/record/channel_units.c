/* SPDX-License-Identifier: Apache-2.0 */
/* Names and units of the channels of a log. */
#include "imukit/channel_units.h"

#include <string.h>

/* Counts are no rate and no force until somebody says what a count is. */
static bool in_counts(const imk_log_column *column)
{
    return imk_dimension_equal(column->unit.dimension, imk_unit_of("count").dimension);
}

imk_channel_kind imk_channel_kind_of(const imk_log_column *column)
{
    if (in_counts(column))
        return IMK_CHANNEL_OTHER;
    if (column->quantity == IMK_QUANTITY_ANGULAR_RATE)
        return IMK_CHANNEL_GYRO;
    return column->quantity == IMK_QUANTITY_SPECIFIC_FORCE ? IMK_CHANNEL_ACCEL : IMK_CHANNEL_OTHER;
}

const char *imk_channel_kind_name(imk_channel_kind kind)
{
    static const char *const names[] = {"gyro", "accel", "channel"};
    return names[kind];
}

const char *imk_channel_axis_name(const imk_log_column *column)
{
    static const char *const names[] = {"x", "y", "z"};
    if (imk_channel_kind_of(column) != IMK_CHANNEL_OTHER && column->axis >= 0 && column->axis < 3)
        return names[column->axis];
    return column->name;
}

imk_unit imk_channel_plain_unit(const imk_log_column *column)
{
    if (imk_channel_kind_of(column) == IMK_CHANNEL_GYRO)
        return imk_unit_of("rad/s");
    if (imk_channel_kind_of(column) == IMK_CHANNEL_ACCEL)
        return imk_unit_of("m/s^2");
    imk_unit unit = column->unit;
    if (!(unit.scale > 0) || !unit.text[0]) {
        unit = imk_unit_of("1");
        strcpy(unit.text, "1");
    }
    return unit;
}

imk_unit imk_channel_readable_unit(const imk_log_column *column, double magnitude)
{
    imk_unit plain = imk_channel_plain_unit(column);
    if (imk_channel_kind_of(column) == IMK_CHANNEL_OTHER)
        return plain;
    return imk_unit_readable(plain.dimension, magnitude);
}
