/* SPDX-License-Identifier: Apache-2.0 */
/* What the two ways of the thermal procedure share. */
#include "thermal_procedure_internal.h"

#include "base/refuse_internal.h"

#include <math.h>
#include <string.h>

bool imki_thermal_is_free(const imk_calibration *calibration, int sensor, int term)
{
    for (size_t p = 0; p < calibration->parameter_count; p++)
        if (calibration->parameter[p].sensor == sensor && calibration->parameter[p].term == term)
            return true;
    return false;
}

void imki_thermal_set_range(imk_temperature_polynomial *polynomial, int order, double reference,
                            double minimum, double maximum, bool earlier)
{
    if (!earlier || polynomial->order == 0) {
        memset(polynomial, 0, sizeof *polynomial);
        polynomial->reference = reference;
        polynomial->minimum = minimum;
        polynomial->maximum = maximum;
    }
    polynomial->order = order > polynomial->order ? order : polynomial->order;
    polynomial->minimum = fmin(polynomial->minimum, minimum);
    polynomial->maximum = fmax(polynomial->maximum, maximum);
}

imk_status imki_thermal_add(const imki_procedure_call *call, const imk_observation *observation)
{
    if (imk_calibration_observe(call->calibration, observation) >= 0)
        return IMK_OK;
    return imki_refuse(call->error, IMK_ERROR_WORKSPACE, "observations",
                       (double)call->calibration->observation_count + 1.0,
                       (double)call->calibration->observation_capacity,
                       "provide room for more observations");
}
