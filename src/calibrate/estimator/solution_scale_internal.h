/* SPDX-License-Identifier: Apache-2.0 */
/* A part of imk_solution_diagnostics(). */
#ifndef IMUKIT_SOLUTION_SCALE_INTERNAL_H
#define IMUKIT_SOLUTION_SCALE_INTERNAL_H

#include "imukit/calibration.h"
#include "imukit/procedure.h"

/* Append scale factors beyond 15 %, or else beyond 5 %, to `count` diagnostics. @return the new
 * count */
size_t imki_solution_scales(const imk_calibration_result *result, size_t count, size_t capacity,
                            imk_diagnostic_finding *diagnostic);

#endif
