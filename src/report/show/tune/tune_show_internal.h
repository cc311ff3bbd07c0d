/* SPDX-License-Identifier: Apache-2.0 */
/* Parts of the display of a filter's noise. */
#ifndef IMUKI_TUNE_SHOW_INTERNAL_H
#define IMUKI_TUNE_SHOW_INTERNAL_H

#include "../show_internal.h"

#include "imukit/tune_model.h"

/* What a column of numbers is called, and its unit. */
typedef struct imki_tune_unit {
    const char *name, *unit;
} imki_tune_unit;
extern const imki_tune_unit imki_tune_units[4]; /* N and K of gyros, of accelerometers */

/* NEES against time. */
void imki_tune_figure(const imk_tune_model *r, imk_result *result);

#endif
