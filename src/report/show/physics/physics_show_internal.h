/* SPDX-License-Identifier: Apache-2.0 */
/* Parts of what instruments are shown by. */
#ifndef IMUKI_PHYSICS_SHOW_INTERNAL_H
#define IMUKI_PHYSICS_SHOW_INTERNAL_H

#include "imukit/show.h"

/* The name of the design, or what the instrument is. */
const char *imki_physics_name(const imk_physics_shown *p);
/* "" of pure numbers. */
const char *imki_unit_text(const char *unit);

/* physics_design_show.c: the instrument, one design. */
void imki_instrument_data(const imk_instrument *instrument, const char *key, imk_result *result);
void imki_design_data(const imk_physics_shown *p, imk_result *result);
void imki_show_design(const imk_physics_shown *p, imk_result *result);
void imki_show_overview(const imk_physics_shown *p, imk_result *result);

/* physics_schematic_show.c: the schematic in motion; nothing of an instrument without one. */
void imki_show_schematic(const imk_physics_shown *p, imk_result *result);

/* physics_derived_show.c: what follows from the parts of the design. */
void imki_show_derived(const imk_physics_shown *p, imk_result *result);
void imki_derived_data(const imk_physics_shown *p, imk_result *result);

/* physics_model_show.c: the stated parameters of a model of one axis, with extras such as
 * repeatability; and the results of experiments. */
void imki_show_reduced(const imk_model *model, int sensor, imk_result *result);
void imki_reduced_data(const imk_model *model, int sensor, imk_result *result);
void imki_show_sweep(const imk_physics_sweep *l, imk_result *result);
void imki_sweep_data(const imk_physics_sweep *l, int sensor, imk_result *result);

/* physics_figure_show.c: the outputs of a run against time, and against the input when that is a
 * sine; what a laboratory found. */
void imki_show_physics_run(const imk_physics_shown *p, imk_result *result);
void imki_show_sweep_figure(const imk_physics_shown *p, imk_result *result);

/* physics_judgement.c: in the object of the data that is open. */
void imki_judge_physics(const imk_physics_shown *p, imk_result *result);

#endif
