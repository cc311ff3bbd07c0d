/* SPDX-License-Identifier: Apache-2.0 */
/* The library's name under the one that verbs use. */
#ifndef IMUKIT_COMMAND_CHANNEL_UNITS_H
#define IMUKIT_COMMAND_CHANNEL_UNITS_H

#include "imukit/channel_units.h"

#define channel_readable_unit imk_channel_readable_unit

#endif
