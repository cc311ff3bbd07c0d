/* SPDX-License-Identifier: Apache-2.0 */
/* What a channel is called and in which units its figures are shown. */
#ifndef IMUKIT_CHANNEL_UNITS_H
#define IMUKIT_CHANNEL_UNITS_H

#include "shell/command.h"

#include "imukit/log.h"

/* What kind of sensor a column is of. */
typedef enum channel_kind {
    CHANNEL_GYRO = 0,
    CHANNEL_ACCEL,
    CHANNEL_OTHER,
    CHANNEL_KINDS
} channel_kind;

channel_kind channel_kind_of(const imk_log_column *column);
/* "gyro", "accel", "channel" */
const char *channel_kind_name(channel_kind kind);
/* "x" … for the axes of a triad, the column's name otherwise. */
const char *channel_axis_name(const imk_log_column *column);

/* Unit in which machine-readable figures of a column are written: SI for gyros and accelerometers,
 * the column's own otherwise ("1" when it has none). */
imk_unit channel_plain_unit(const imk_log_column *column);
/* Unit a person reads figures of this size in [SI]. */
imk_unit channel_readable_unit(const imk_log_column *column, double magnitude);

#endif
