/* SPDX-License-Identifier: Apache-2.0 */
/* The covariance of an aided navigator: the filter of navigation_filter.h runs along the true
 * motion with perfect readings, and its gains say what it does with the true errors. */
#ifndef IMUKI_DRIFT_AIDED_INTERNAL_H
#define IMUKI_DRIFT_AIDED_INTERNAL_H

#include "drift_covariance_internal.h"

#include "imukit/navigation_filter.h"
#include "imukit/simulate.h"
#include "navigate/filter/navigation_filter_internal.h"

enum { IMKI_UPDATE_ROWS = 3 };

/* ---- drift_aid_sources.c ---- */

/* `part` of a column IMKI_COLUMN_AID. */
typedef enum imki_aid_error {
    IMKI_AID_WHITE,      /* independent from reading to reading: the size is the variance */
    IMKI_AID_CORRELATED, /* on axis `axis` of aid `sensor` */
    IMKI_AID_LEVER_ARM   /* along body axis `axis`, of aid `sensor` and those at the same point */
} imki_aid_error;

void imki_drift_aid_sources(imki_drift_plan *plan, const imk_drift_settings *settings);
/* The first of the aids that is at the same point of the body. */
size_t imki_aid_point(const imk_aid *aids, size_t aid);
/* A source "aid.NAME" made so many times as large. @return false: there is none */
bool imki_aid_scale(const char *name, double factor, size_t count, imk_aid *aids);
/* What an aid reads (imk_aid_reading.value) of a true state with an arm, `off` on its axes. */
void imki_aid_reading(const imk_aid *aid, const imk_motion_state *state, const double arm[3],
                      const double off[3], double value[3]);
/* What a unit of a column IMKI_COLUMN_AID is in prediction minus reading of an aid. */
double imki_aid_enters(const imki_drift_column *column, const imk_aid *aids, size_t aid, int axis,
                       const imki_drift_node *node);

/* ---- drift_feedback.c ---- */

/* An update of the filter: z = h (x, y) + v. */
typedef struct imki_drift_update {
    size_t aid, rows;
    int axis[IMKI_UPDATE_ROWS];
    double *h, *gain;                  /* rows x states, states x rows */
    double (*enter)[IMKI_UPDATE_ROWS]; /* [plan column]: v per unit of its driver */
} imki_drift_update;

/* What the filter does in a step and at its end. */
typedef struct imki_aided_step {
    size_t states, parts[2];
    double rate;        /* of the samples [Hz] */
    double gamma[9][6]; /* what constant errors of the readings do: gyro x, y, z, accelerometer */
    bool decays;        /* the estimates, at the end of this step */
    double *decay;      /* of each estimate */
    size_t update_count;
    imki_drift_update update[IMK_AIDS_MAX];
} imki_aided_step;

/* moved += what the estimates in x do; they decay. */
void imki_feed_vector(const imki_aided_step *step, double *x, double moved[9]);
/* The estimates' part in what a driver's states do, b being what they add to x. */
void imki_feed_states(size_t states, imki_drift_element *element, int driver_states, double b[2][9],
                      const imki_driver_step *driver, double *covariance);
/* P by phi, gamma and the decay. */
void imki_feed_covariance(size_t states, const imki_drift_step *step, double *covariance);
/* The updates at the end of a step. */
void imki_drift_update_part(const imki_drift_plan *plan, imki_drift_part *part,
                            const imki_aided_step *step);

/* ---- drift_loop.c ---- */

/* The filter in the loop. */
typedef struct imki_drift_loop {
    const imk_drift_settings *settings;
    const imk_trajectory *trajectory;
    double start; /* of navigation, in the time of the trajectory */
    imk_kernel kernel;
    imk_navigation_filter *filter;
    double time;                 /* of the filter, from the start of navigation [s] */
    uint64_t next[IMK_AIDS_MAX]; /* reading of each aid */
    double step;                 /* from one propagation of the filter to the next, at most [s] */
    double longest;              /* sample of the filter [s] */
    int bias_column[6];
    size_t states;
} imki_drift_loop;

/* The filter's description of model and aids, for its start at the true state. @param scratch of
 * imki_drift_filter_scratch() bytes */
size_t imki_drift_filter_scratch(void);
imk_status imki_drift_filter_settings(const imk_model *model, const imk_drift_settings *settings,
                                      const imki_drift_motion_of *motion,
                                      imk_navigation_filter_settings *filter, void *scratch,
                                      imk_error *error);
/* States of x at most, and bytes for the filter; nine and 0 without aids. */
size_t imki_drift_filter_states(const imk_model *model, const imk_drift_settings *settings,
                                size_t *filter_size);
/* Sample row at whose end reading k of an aid is used, from the start of navigation; UINT64_MAX:
 * there is none. */
uint64_t imki_aid_row(const imk_aid *aid, uint64_t k, double rate);
/* The body stands, so that a zero velocity is observed. */
bool imki_drift_stands(const imk_motion_state *state);

typedef struct imki_loop_memory {
    void *filter, *scratch; /* of filter_size, and of imki_drift_filter_scratch() bytes */
    size_t filter_size;
} imki_loop_memory;
imk_status imki_loop_start(imki_drift_loop *loop, const imk_model *model,
                           const imk_drift_settings *settings, imki_drift_walk *walk,
                           imki_drift_plan *plan, const imki_loop_memory *memory, imk_error *error);
/* Where the next step must end at the latest: where the filter propagates or an aid is read. */
double imki_loop_limit(const imki_drift_loop *loop, double time, double goal);
/* Run the filter over a step that has been chosen, with the updates at its end. `last`: the step
 * ends at imki_loop_limit(). */
void imki_loop_take(imki_drift_loop *loop, imki_drift_step *step, double end, bool last);
/* What needs the columns of the step. */
void imki_loop_fill(const imki_drift_loop *loop, const imki_drift_plan *plan,
                    const imki_drift_walk *walk, imki_drift_step *step);
/* The filter's own covariance. */
void imki_loop_believed(const imki_drift_loop *loop, const imki_drift_node *node,
                        imk_drift_moments *moments);

/* ---- drift_runs_aided.c ---- */

/* One run: its filter, and the errors of its aids. */
typedef struct imki_aided_run {
    void *memory; /* for the filter */
    size_t memory_size;
    const imk_drift_settings *settings;
    imk_navigation_filter *filter;
    imk_random random;
    uint32_t number;
    double arm[IMK_AIDS_MAX][3];  /* true */
    double slow[IMK_AIDS_MAX][3]; /* correlated errors */
    uint64_t next[IMK_AIDS_MAX];  /* reading of each aid */
} imki_aided_run;

/* @param r  with its memory */
imk_status imki_aided_run_start(imki_aided_run *r, const imk_drift_settings *settings,
                                const imk_navigation_filter_settings *filter,
                                const imk_navigation_state *start, imk_random random,
                                uint32_t number, imk_error *error);
/* Rows of a simulation, as drift_runs.c has them. */
typedef struct imki_aided_rows {
    const imk_trajectory *trajectory;
    const imk_simulator *simulator;
    double *const *column; /* rates and forces */
    double dt, start, interval;
    bool moves;
    double *height, *climb, *time; /* of rows; room, where the motion moves */
    uint64_t first, before;        /* row 0 of the columns; rows before the start of navigation */
} imki_aided_rows;
/* Take the rows from … to - 1. */
void imki_aided_run_take(imki_aided_run *run, const imki_aided_rows *rows, size_t from, size_t to);
/* Normalised error squared; NaN: the covariance is not one. */
double imki_aided_run_nees(imki_aided_run *r, const imk_navigation_state *truth);

#endif
