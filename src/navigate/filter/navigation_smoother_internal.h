/* SPDX-License-Identifier: Apache-2.0 */
/* What the filter tells its smoother, if it has one. */
#ifndef IMUKIT_NAVIGATE_NAVIGATION_SMOOTHER_INTERNAL_H
#define IMUKIT_NAVIGATE_NAVIGATION_SMOOTHER_INTERNAL_H

#include "navigation_filter_internal.h"

#include "imukit/navigation_smoother.h"

/* A step of the covariance. @param held_up  upwards, where the vertical is held; else NULL */
void imki_smoother_step(imk_navigation_smoother *smoother, const imki_filter_step *by,
                        const double *decay, const imk_vector3 *held_up);
/* An update. @param inverse  of the covariance of its innovation */
void imki_smoother_update(imk_navigation_smoother *smoother, const imki_measurement *measurement,
                          const double *gain, double inverse[3][3]);

#endif
