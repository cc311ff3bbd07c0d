/* SPDX-License-Identifier: Apache-2.0 */
/* The motion that a drift analysis is about. */
#ifndef IMUKI_DRIFT_SETTINGS_INTERNAL_H
#define IMUKI_DRIFT_SETTINGS_INTERNAL_H

#include "imukit/drift.h"

/* Plain data, but not to be moved: at rest the trajectory points to the piece. */
typedef struct imki_drift_motion_of {
    imk_trajectory trajectory;
    imk_trajectory_piece piece; /* at rest */
    double start;               /* of navigation in the time of the trajectory [s] */
} imki_drift_motion_of;

/* Of valid settings: their motion, or the standstill. */
imk_status imki_drift_motion(const imk_drift_settings *settings, imki_drift_motion_of *motion,
                             imk_error *error);

#endif
