/* SPDX-License-Identifier: Apache-2.0 */
/* The maps of grades. */
#ifndef IMUKI_GRADE_SHOW_INTERNAL_H
#define IMUKI_GRADE_SHOW_INTERNAL_H

#include "report/show/show_internal.h"

/* One map, or IMK_GRADE_MAPS beside one another. */
void imki_show_grade_plot(const imk_graded_several *r, int map, imk_result *result);
/* Each with its sources, on the page. */
void imki_show_grade_maps(const imk_graded_several *r, imk_result *result);

#endif
