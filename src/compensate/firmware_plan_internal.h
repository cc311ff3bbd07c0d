/* SPDX-License-Identifier: Apache-2.0 */
/* The two halves of planning: the frame (firmware_plan.c) and the operations (firmware_build.c). */
#ifndef IMUKI_FIRMWARE_PLAN_INTERNAL_H
#define IMUKI_FIRMWARE_PLAN_INTERNAL_H

#include "firmware_internal.h"

#include "model/correct_internal.h"

/* All operations. `reserve`: bits by which the outputs' scale is coarser than the first step would
 * allow. left: what leaving out the difference of J+ J from the unit matrix does to the outputs.
 * @return false when something did not fit */
bool imki_firmware_build(imki_builder *builder, int reserve, double left[2]);

/* The largest |polynomial| of the bias of an axis. */
double imki_firmware_bias_reach(const imk_axis_response *axis);

#endif
