/* SPDX-License-Identifier: Apache-2.0 */
/* What a run and its truth have in common. */
#ifndef IMUKI_SIMULATE_LOG_INTERNAL_H
#define IMUKI_SIMULATE_LOG_INTERNAL_H

#include "imukit/simulate_log.h"

/* A model, settings and a sink that can be used. */
imk_status imki_simulate_check(const imk_model *model, const imk_simulate_log_settings *settings,
                               const imk_record_sink *sink, imk_error *error);

#endif
