/* SPDX-License-Identifier: Apache-2.0 */
/** @file channel_units.h
 *  What a channel is called, and in which units its figures are shown. */
#ifndef IMUKIT_CHANNEL_UNITS_H
#define IMUKIT_CHANNEL_UNITS_H

#include "imukit/record.h"

IMK_BEGIN_C

/** What kind of sensor a column is of. */
typedef enum imk_channel_kind {
    IMK_CHANNEL_GYRO = 0,
    IMK_CHANNEL_ACCEL,
    IMK_CHANNEL_OTHER, /**< counts too: no rate and no force until somebody says what a count is */
    IMK_CHANNEL_KINDS
} imk_channel_kind;

/** By the column's quantity. */
IMK_API imk_channel_kind imk_channel_kind_of(const imk_log_column *column);
/** "gyro", "accel", "channel" */
IMK_API const char *imk_channel_kind_name(imk_channel_kind kind);
/** "x" … for the axes of a triad, the column's name otherwise. */
IMK_API const char *imk_channel_axis_name(const imk_log_column *column);

/** Unit in which machine-readable figures of a column are written: SI for gyros and accelerometers,
 *  the column's own otherwise ("1" when it has none). */
IMK_API imk_unit imk_channel_plain_unit(const imk_log_column *column);
/** Unit a person reads figures of this size in [SI]. */
IMK_API imk_unit imk_channel_readable_unit(const imk_log_column *column, double magnitude);

IMK_END_C
#endif
