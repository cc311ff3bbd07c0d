/* SPDX-License-Identifier: Apache-2.0 */
/* The picture of a drift result. */
#ifndef IMUKIT_DRIFT_FIGURE_H
#define IMUKIT_DRIFT_FIGURE_H

#include "drift_parts.h"

#include "imukit/report.h"

enum { DRIFT_BANDS = 8, DRIFT_PANELS = 3 };

/* Not to be moved: the figure points into it. */
typedef struct drift_figure {
    imk_figure figure;
    imk_panel panel[DRIFT_PANELS];
    size_t times, growth_count;
    const double *time;
    const char *time_label;
    double unit, length; /* of the axes [s], [m] */
    imk_curve growth[DRIFT_MODELS_MAX + 3];
    imk_curve share[2][DRIFT_BANDS];
    char share_title[2][60];
    double *memory;
} drift_figure;

/* False when memory is exhausted. */
void drift_figure_make(const drift_result *r, drift_figure *d);
void drift_figure_free(drift_figure *figure);

#endif
