/* SPDX-License-Identifier: Apache-2.0 */
/* The aids of a navigation, as part of its display. */
#ifndef IMUKI_NAVIGATE_AIDS_SHOW_INTERNAL_H
#define IMUKI_NAVIGATE_AIDS_SHOW_INTERNAL_H

#include "show_internal.h"

/* An array "aids". */
void imki_show_aids_data(const imk_navigate_log *n, imk_result *result);
/* A table, and what an outage cost; nothing without aids. */
void imki_show_aids_table(const imk_navigate_log *n, imk_result *result);
/* Panels of innovations against time. */
void imki_show_aids_panels(const imk_navigate_log *n, imk_figure_builder *figure);

/* navigate_judgement.c: in the object of the data that is open. */
void imki_judge_navigation(const imk_navigate_log *n, imk_result *result);

#endif
