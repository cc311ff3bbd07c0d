/* SPDX-License-Identifier: Apache-2.0 */
/* Parts of the jobs of instruments. */
#ifndef IMUKI_PHYSICS_LOG_INTERNAL_H
#define IMUKI_PHYSICS_LOG_INTERNAL_H

#include "imukit/physics_log.h"

/* Settings with an instrument and a design of it.
 * @param result  the place of the result */
imk_status imki_physics_check(const void *result, const imk_physics_log_settings *settings,
                              imk_error *error);
/* The largest angular rate of an input, the sum of the axes [rad/s]. */
double imki_physics_turning(const imk_physics_input *input);
/* What can be known of a run that went wrong quietly. */
void imki_physics_warn(imk_physics_log *log);
/* "beat frequency [kHz]"; pure numbers have no unit. @param text  IMK_PHYSICS_LABEL bytes */
const char *imki_physics_label(char *text, const char *name, const char *unit);

#endif
