/* SPDX-License-Identifier: Apache-2.0 */
/* The rows of the sensitivities, as their sources print them. */
#ifndef IMUKI_DEVICE_SENSITIVITY_INTERNAL_H
#define IMUKI_DEVICE_SENSITIVITY_INTERNAL_H

#include "imukit/device_sensitivity.h"

typedef struct imki_sensitivity_row {
    const char *part;
    imk_count_kind kind;
    int bits;
    const char *range;  /* "" where the source states none, and for temperatures */
    const char *stated; /* for imk_count_scale_parse() */
    const char *source;
    double zero; /* temperature at count 0 [degC] */
} imki_sensitivity_row;

extern const imki_sensitivity_row imki_sensitivity_rows[];
extern const size_t imki_sensitivity_row_count;

/* Names of parts whose rows are those of another one. */
typedef struct imki_sensitivity_alias {
    const char *name, *part;
} imki_sensitivity_alias;

extern const imki_sensitivity_alias imki_sensitivity_aliases[];
extern const size_t imki_sensitivity_alias_count;

#endif
