/* SPDX-License-Identifier: Apache-2.0 */
/* What `imukit grade` is made of: figures of each model, computed errors of position, and the maps
 * on which the models stand. */
#ifndef IMUKIT_GRADE_PARTS_H
#define IMUKIT_GRADE_PARTS_H

#include "drift/drift_parts.h"
#include "shell/command.h"

#include "imukit/report.h"

enum { GRADE_MODELS_MAX = 8 };

typedef struct grade_options {
    bool json;
    const char *plot, *report;
    int map; /* in the order of the choices */
} grade_options;

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
    char omitted[300];              /* what the linear figures leave out */
} grade_case;

typedef struct grade_result {
    const grade_options *options;
    size_t count;
    grade_case cases[GRADE_MODELS_MAX];
} grade_result;

/* "tactical", or "below every class". */
const char *grade_name(imk_grade grade);
/* @return -1 or the exit code, the message printed */
int grade_analyse(grade_case *one);
/* Nautical miles, as claims are, from a tenth of one; else metres. */
const char *grade_length(double metres, char text[DRIFT_TEXT]);

/* ---- grade_tables.c ---- */

text_table grade_class_table(const grade_case *one);
text_table grade_position_table(const grade_case *one);
text_table grade_comparison_table(const grade_result *result);
/* Sentences, each of at most `size` bytes; "" where there is nothing to say. */
void grade_bias_sentence(const grade_case *one, bool gyro, char *text, size_t size);
void grade_position_sentence(const grade_case *one, char *text, size_t size);
void grade_share_sentence(const grade_case *one, char *text, size_t size);
void grade_need_sentence(const grade_case *one, char *text, size_t size);
void grade_flattery_sentence(const grade_case *one, char *text, size_t size);
extern const char grade_assumption[];
void grade_print(const grade_result *result);

/* ---- grade_regions.c: what is published about classes and applications ---- */

typedef struct grade_region {
    imk_region region;  /* in the units of its map */
    const char *source; /* key of docs/references.md and the place in it */
} grade_region;

enum { GRADE_MAP_GYRO, GRADE_MAP_ACCEL, GRADE_MAP_COST, GRADE_MAPS };

const grade_region *grade_regions(int map, size_t *count);

/* ---- grade_map.c ---- */

enum { GRADE_REGIONS_MAX = 12 };

typedef struct grade_map {
    imk_panel panel;
    imk_region region[GRADE_REGIONS_MAX];
    imk_curve curve[GRADE_MODELS_MAX + 1];
    double x[GRADE_MODELS_MAX][2], y[GRADE_MODELS_MAX][2];
    char label[GRADE_MODELS_MAX][120];
    double preset_x[5], preset_y[5];
} grade_map;

/* Not to be moved: the panel points into it. @return false: no model stands on it */
bool grade_map_make(const grade_result *result, int map, grade_map *made);
/* @return -1 or the exit code */
int grade_draw(const grade_result *result, const char *path);

/* ---- grade_output.c ---- */

int grade_print_json(const grade_result *result);
int grade_report(const grade_result *result, const char *path);

#endif
