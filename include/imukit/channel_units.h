/* SPDX-License-Identifier: Apache-2.0 */
/** @file channel_units.h
 *  Names of channels, and the units in which their figures are shown. */
#ifndef IMUKIT_CHANNEL_UNITS_H
#define IMUKIT_CHANNEL_UNITS_H

#include "imukit/record.h"

IMK_BEGIN_C

/** Kind of the sensor of a column. */
typedef enum imk_channel_kind {
    IMK_CHANNEL_GYRO = 0,
    IMK_CHANNEL_ACCEL,
    IMK_CHANNEL_OTHER, /**< all others, including counts, whose physical unit is not known */
    IMK_CHANNEL_KINDS
} imk_channel_kind;

/** Kind of a column, by its quantity. */
IMK_API imk_channel_kind imk_channel_kind_of(const imk_log_column *column);
/** Name of a kind: "gyro", "accel", "channel". */
IMK_API const char *imk_channel_kind_name(imk_channel_kind kind);
/** Name of a column's axis: "x" … for the axes of a triad, else the name of the column. */
IMK_API const char *imk_channel_axis_name(const imk_log_column *column);

/** Unit of a column's figures in machine-readable output: SI for gyros and accelerometers, else the
 *  column's own ("1" without a unit). */
IMK_API imk_unit imk_channel_plain_unit(const imk_log_column *column);
/** Readable unit for a column's figures of this magnitude [SI]. */
IMK_API imk_unit imk_channel_readable_unit(const imk_log_column *column, double magnitude);

IMK_END_C
#endif
