/* SPDX-License-Identifier: Apache-2.0 */
/* The library's names of channels under the names that verbs use. */
#ifndef IMUKIT_COMMAND_CHANNEL_UNITS_H
#define IMUKIT_COMMAND_CHANNEL_UNITS_H

#include "imukit/channel_units.h"

typedef imk_channel_kind channel_kind;
#define CHANNEL_GYRO IMK_CHANNEL_GYRO
#define CHANNEL_ACCEL IMK_CHANNEL_ACCEL
#define CHANNEL_OTHER IMK_CHANNEL_OTHER
#define CHANNEL_KINDS IMK_CHANNEL_KINDS
#define channel_kind_of imk_channel_kind_of
#define channel_kind_name imk_channel_kind_name
#define channel_axis_name imk_channel_axis_name
#define channel_plain_unit imk_channel_plain_unit
#define channel_readable_unit imk_channel_readable_unit

#endif
