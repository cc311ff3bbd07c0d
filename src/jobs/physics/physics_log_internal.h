/* SPDX-License-Identifier: Apache-2.0 */
/* What can be known of a run that went wrong quietly. */
#ifndef IMUKI_PHYSICS_LOG_INTERNAL_H
#define IMUKI_PHYSICS_LOG_INTERNAL_H

#include "imukit/physics_log.h"

void imki_physics_warn(imk_physics_log *log);

#endif
