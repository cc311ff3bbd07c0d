/* SPDX-License-Identifier: Apache-2.0 */
/* The figure of `imukit spectrum`. */
#ifndef IMUKIT_SPECTRUM_FIGURE_H
#define IMUKIT_SPECTRUM_FIGURE_H

#include "spectrum_output.h"

#include "imukit/report.h"

typedef struct spectrum_figure spectrum_figure;

/* NULL when memory is exhausted. It refers to texts of the result. */
spectrum_figure *spectrum_figure_make(const spectrum_result *result);
const imk_figure *spectrum_figure_get(const spectrum_figure *figure);
void spectrum_figure_free(spectrum_figure *figure);

#endif
