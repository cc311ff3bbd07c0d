/* SPDX-License-Identifier: Apache-2.0 */
/* The maps of grades: where a model stands on each, what is said about it there, and the data. */
#ifndef IMUKI_GRADE_SHOW_INTERNAL_H
#define IMUKI_GRADE_SHOW_INTERNAL_H

#include "report/show/show_internal.h"

/* An axis of a map: the unit it is drawn in, and its limits in this unit. */
typedef struct imki_map_axis {
    const char *label, *unit; /* "1": dollars */
    const char *quantity;     /* "scale factor" */
    double low, high;
} imki_map_axis;

typedef struct imki_grade_map {
    const char *key, *title, *caption, *note;
    imki_map_axis x, y;
} imki_grade_map;
const imki_grade_map *imki_grade_map_of(int map);

/* Along one axis: the value as stated, and where it is drawn. */
typedef enum imki_placing {
    IMKI_PLACED = 0,
    IMKI_UNSTATED, /* the model has no value: a line across the map, which means nothing */
    IMKI_OUTSIDE   /* beyond the map: drawn at its edge */
} imki_placing;

typedef struct imki_grade_place {
    double x, y;         /* SI; NaN: not stated */
    double at[2];        /* where it is drawn, in the units of the map; NaN: a line */
    imki_placing how[2]; /* along x, along y */
} imki_grade_place;
imki_grade_place imki_grade_place_of(const imk_graded *one, int map);
/* Is it drawn? A model that states neither of the two values is not. On a map of prices no model
 * has a price, and its bias is enough. */
bool imki_grade_is_drawn(const imki_grade_place *place);

/* What the map says below its axis: its own note, and where the place of a model means nothing. */
void imki_grade_note(const imk_graded_several *r, int map, imki_text *note);

/* "DTG", "RLG, navigation" */
const char *imki_region_name(const imk_map_region *region, char text[IMKI_WORDS]);

/* One map, or IMK_GRADE_MAPS beside one another. */
void imki_show_grade_plot(const imk_graded_several *r, int map, imk_result *result);
/* Each with its sources, on the page. */
void imki_show_grade_maps(const imk_graded_several *r, imk_result *result);
/* The Allan deviations of their noise; nothing when none states any. */
void imki_show_grade_noise(const imk_graded_several *r, imk_result *result);
/* As data: all regions; where a model stands. */
void imki_show_map_data(imk_result *result);
void imki_show_place_data(const imk_graded *one, imk_result *result);

/* grade_judgement.c: in the object of the data that is open. */
void imki_judge_grade(const imk_graded_several *r, imk_result *result);

#endif
