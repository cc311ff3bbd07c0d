/* SPDX-License-Identifier: Apache-2.0 */
/* Shared by the two ways of the thermal procedure. */
#ifndef IMUKIT_THERMAL_PROCEDURE_INTERNAL_H
#define IMUKIT_THERMAL_PROCEDURE_INTERNAL_H

#include "calibrate/procedures/procedure_internal.h"

/* True when a term of a sensor is free on any axis. */
bool imki_thermal_is_free(const imk_calibration *calibration, int sensor, int term);
/* The polynomial of a model becomes one about this reference, over this range; what a model had
 * before belongs to another one. An earlier log's range is widened. */
void imki_thermal_set_range(imk_temperature_polynomial *polynomial, int order, double reference,
                            double minimum, double maximum, bool earlier);
/* Add an observation, or say how many there would have to be room for. */
imk_status imki_thermal_add(const imki_procedure_call *call, const imk_observation *observation);

/* thermal_poses.c */
imk_status imki_thermal_observe_poses(const imki_procedure_call *call);
size_t imki_thermal_poses_workspace(const imk_test_record *record,
                                    const imk_procedure_settings *settings);

#endif
