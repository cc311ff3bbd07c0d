/* SPDX-License-Identifier: Apache-2.0 */
/* What `imukit grade` is made of: figures of each model, computed errors of position, and the maps
 * on which the models stand. */
#ifndef IMUKIT_GRADE_PARTS_H
#define IMUKIT_GRADE_PARTS_H

#include "drift/drift_parts.h"
#include "shell/growing_list.h"
#include "shell/show.h"

enum { GRADE_MODELS_MAX = 8 };

/* ---- grade_position.c ---- */

/* When it is looked at: a minute, an hour, a day. */
enum { GRADE_MINUTE, GRADE_HOUR, GRADE_DAY, GRADE_TIMES };
extern const double grade_time[GRADE_TIMES];

/* How it is navigated. */
enum { GRADE_GIVEN, GRADE_SELF, GRADE_GIVEN_COMPENSATED, GRADE_SELF_COMPENSATED, GRADE_WAYS };

/* Errors at those times. */
typedef struct grade_position {
    imk_drift_figures figures[GRADE_TIMES];
    drift_validity validity[GRADE_TIMES];
    double cep[GRADE_TIMES]; /* NaN: no longer a position */
    imk_grade grade;
} grade_position;

/* A source and the factor that says how good it must become. */
typedef struct grade_share {
    char text[64];
    double value;
} grade_share;

enum { GRADE_SHARES = 4 };

typedef struct grade_case {
    const char *operand;
    imk_model *model;
    imk_grade_result table;         /* by the rows of the table */
    double gyro_scale, accel_scale; /* what stays of the scale factors, worst axis; NaN: not
                                       stated */
    /* The rest: where there are three gyros and three accelerometers. */
    bool has_position;
    char no_position[200]; /* why not */
    grade_position way[GRADE_WAYS];
    bool compensation_matters;
    size_t share_count;
    grade_share share[GRADE_SHARES]; /* the largest shares of the horizontal variance after an
                                        hour, 0 … 1 */
    bool shifted;                    /* known values make most of that */
    imk_grade next;                  /* the next better class; IMK_GRADE_NONE: it is the best */
    double next_all;                 /* every source times this is enough for it */
    size_t need_count;
    grade_share need[GRADE_SHARES]; /* or these alone, each so many times better, the most first */
    size_t need_more;               /* and so many others */
    growing_list omitted;           /* what the linear figures leave out */
} grade_case;

typedef struct grade_result {
    size_t count;
    grade_case cases[GRADE_MODELS_MAX];
} grade_result;

/* "tactical", or "below every class". */
const char *grade_name(imk_grade grade);
/* @return -1 or the exit code, the message printed */
int grade_analyse(grade_case *one);
/* Nautical miles, as claims are, from a tenth of one; else metres. */
const char *grade_length(double metres, char text[DRIFT_TEXT]);

/* ---- grade_maps.c ---- */

enum { GRADE_MAP_GYRO, GRADE_MAP_ACCEL, GRADE_MAP_COST, GRADE_MAPS /* all of them */ };

/* Does a model stand on a map, or on any of GRADE_MAPS? */
bool grade_stands(const grade_result *result, int map);
/* One map, or GRADE_MAPS beside one another. */
void grade_show_plot(const grade_result *r, int map, imk_result *result);
/* Each with its sources, on the page. */
void grade_show_maps(const grade_result *r, imk_result *result);

/* ---- grade_show.c ---- */

/* @param map  for the plot */
void grade_show(const grade_result *r, int map, imk_result *result);

#endif
