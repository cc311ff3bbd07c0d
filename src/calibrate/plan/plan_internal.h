/* SPDX-License-Identifier: Apache-2.0 */
/* The parts of experiment design (calibration_plan.h). */
#ifndef IMUKIT_PLAN_INTERNAL_H
#define IMUKIT_PLAN_INTERNAL_H

#include "imukit/calibration_plan.h"

enum { IMKI_PLAN_COOKIE = 0x504C4131, IMKI_PLAN_CANDIDATES_MAX = 128, IMKI_PLAN_TURN_SAMPLES = 32 };

/* What works on a plan: the calibration at work, whose observations are those of the programme, and
 * synthetic readings of its turns. */
typedef struct imki_plan {
    const imk_plan_settings *settings;
    imk_calibration *calibration; /* observations and turns from 0: only those of the programme */
    imk_test_record record;       /* of the turns */
    double *reading[6];
    void *solver;
    size_t solver_size;
} imki_plan;

/* ---- plan_candidates.c ---- */

/* Steps a procedure offers. */
size_t imki_plan_candidates(const imk_plan_settings *settings, const imk_model *model,
                            double gravity, imk_plan_step step[IMKI_PLAN_CANDIDATES_MAX]);
/* True when the steps are taken as they are listed, all of them, rather than the best of them. */
bool imki_plan_is_list(imk_procedure procedure);
/* Make free what the procedure estimates. */
imk_status imki_plan_free(const imk_plan_settings *settings, imk_calibration *calibration,
                          imk_error *error);
/* Roll and pitch of a pose with the specific force along `up` (unit, body axes). */
void imki_plan_attitude(const double up[3], double *roll, double *pitch);
/* Direction of the specific force in a pose, body axes. */
void imki_plan_up(const double angle[3], double up[3]);
/* `count` of the 26 directions to faces, edges and corners of a cube: number `index`. */
void imki_plan_direction(size_t index, double direction[3]);

/* ---- plan_noise.c ---- */

/* Variance of the mean of an axis over a time, by the noise of the model. */
double imki_plan_mean_variance(const imk_triad *triad, int axis, double dt, double time);
/* Variance of what no test lowers: instability and repeatability of a parameter. */
double imki_plan_floor_variance(const imk_model *model, imk_model_parameter parameter);

/* ---- plan_steps.c ---- */

/* Time of the turn from a pose to the next [s]. */
double imki_plan_turn_time(const imk_plan_settings *settings, const imk_model *model,
                           const double from[3], const double to[3]);
/* A turn of ferraris or turns. */
bool imki_plan_is_whole_turn(const imk_plan_settings *settings, const imk_plan_step *step);
/* How long a step is measured: a whole turn as long as it takes, others for `hold` seconds. */
double imki_plan_measured(const imk_plan_settings *settings, const imk_plan_step *step,
                          double hold);
/* Do all steps share a mounting on a fixture that is not known exactly? */
bool imki_plan_has_fixture(const imk_plan_settings *settings);
/* 1 sigma of this mounting. How square the axes of turns are, repetitions do not show: of these the
 * placement counts as one. [rad] */
double imki_plan_fixture(const imk_plan_settings *settings);
/* Forget the programme. */
void imki_plan_clear(imki_plan *plan);
/* Append a step, measured for `hold` seconds; `from`: the step before, for procedures in which
 * turns are measured, or NULL. */
void imki_plan_append(imki_plan *plan, const imk_plan_step *from, const imk_plan_step *step,
                      double hold);
/* Information of the programme, parameter_count^2. */
imk_status imki_plan_information(imki_plan *plan, double *information, imk_error *error);

/* ---- plan_criterion.c: what information is worth ---- */

/* A little is known of every parameter, so that determinants exist: 1e-8 of `most`, the largest
 * information on it that a step has. */
void imki_plan_regularise(size_t n, const double *most, double *regular);
/* log det of information + regular, both scaled by regular; `work`: n^2. */
double imki_plan_log_determinant(size_t n, const double *information, const double *regular,
                                 double *work);
/* Sigma of each parameter; NaN where the information does not determine it. `work`: 2 n^2. */
void imki_plan_sigmas(size_t n, const double *information, const double *regular, double *work,
                      double *sigma);

#endif
