/* SPDX-License-Identifier: Apache-2.0 */
/* The parts of the plan of a record. */
#ifndef IMUKI_RECORD_PLAN_INTERNAL_H
#define IMUKI_RECORD_PLAN_INTERNAL_H

#include "imukit/record_plan.h"

/* The requirements of settings.want, of the parameters listed before. */
imk_status imki_plan_requirements(imk_record_plan *plan, imk_error *error);

#endif
