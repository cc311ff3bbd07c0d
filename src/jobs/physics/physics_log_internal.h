/* SPDX-License-Identifier: Apache-2.0 */
/* Parts of the jobs of instruments. */
#ifndef IMUKI_PHYSICS_LOG_INTERNAL_H
#define IMUKI_PHYSICS_LOG_INTERNAL_H

#include "imukit/physics_log.h"

/* What can be known of a run that went wrong quietly. */
void imki_physics_warn(imk_physics_log *log);
/* "beat frequency [kHz]"; pure numbers have no unit. @param text  IMK_PHYSICS_LABEL bytes */
const char *imki_physics_label(char *text, const char *name, const char *unit);

#endif
