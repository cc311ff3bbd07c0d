/* SPDX-License-Identifier: Apache-2.0 */
/* imukit identify --plan: how well a record will tell each term of a model's noise, and how long it
 * must be for a wish. */
#ifndef IMUKIT_IDENTIFY_PLAN_PARTS_H
#define IMUKIT_IDENTIFY_PLAN_PARTS_H

#include "imukit/identify_log.h"
#include "imukit/identify_plan.h"
#include "imukit/units.h"

typedef struct identify_plan_request {
    const char *model;   /* file or catalogue name */
    const char *want;    /* "bias_instability 5%, gyro.rate_random_walk detected 95%"; NULL: none */
    const char *plot;    /* NULL: none */
    double rate;         /* of the record [Hz]; 0: not given, which is refused */
    double duration;     /* planned [s]; 0: what the wishes need */
    double significance; /* as of identify; 0.01 */
    bool json;
    bool strict; /* exit with 1 when a wish is beyond any record, or longer than the duration */
} identify_plan_request;

/* Prints the tables or JSON, and draws. @return the exit code */
int identify_plan_run(const identify_plan_request *request);

/* ---- parts shared by identify_plan.c, identify_wish.c and identify_plan_output.c ---------------
 */

enum { PLAN_ROWS_MAX = 2 * (IMK_NOISE_TERMS + 2 * IMK_TERMS_MAX), PLAN_WISHES_MAX = 16 };

/* A parameter of the gyros or of the accelerometers. */
typedef struct plan_row {
    bool accel, time;
    int term; /* imk_noise_term; IMK_NOISE_TERMS + i: Gauss-Markov term i */
    char key[48];
    imk_unit unit;
    double low, high; /* over the axes that have it */
} plan_row;

typedef struct plan_wish {
    char text[96];
    size_t row;
    double relative, detection;
    double duration; /* of the axis that needs the longest [s]; infinite: none is enough */
} plan_wish;

/* What a record tells of a row: the worst of the axes. */
typedef struct plan_cell {
    double relative, detection;
} plan_cell;

typedef struct identify_plan {
    const identify_plan_request *request;
    imk_model model;
    imk_bounds_settings settings;
    size_t row_count, wish_count;
    plan_row row[PLAN_ROWS_MAX];
    plan_wish wish[PLAN_WISHES_MAX];
    double duration; /* planned [s]; 0: none */
    void *workspace;
} identify_plan;

/* identify_plan.c: cells of all rows for a duration. False when the record is too short or too long
 * for any statement. */
bool identify_plan_cells(identify_plan *p, double duration, plan_cell *cell);

/* identify_wish.c: request->want. @return -1 or the exit code */
int identify_wish_parse(identify_plan *p);

/* identify_plan_output.c. @return -1 or the exit code */
void identify_plan_print(identify_plan *p);
int identify_plan_json(identify_plan *p, int code);
int identify_plan_draw(identify_plan *p);

#endif
