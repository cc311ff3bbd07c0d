/* SPDX-License-Identifier: Apache-2.0 */
/* The parts of the Monte Carlo of drift.h: what calibration left, the truth, and the runs. */
#ifndef IMUKIT_DRIFT_RUNS_INTERNAL_H
#define IMUKIT_DRIFT_RUNS_INTERNAL_H

#include "imukit/drift.h"
#include "imukit/navigate.h"
#include "imukit/random.h"

/* ---- drift_residual.c ---- */

/* Put in place of every known value of the model what calibration left of it in this run: its sigma
 * times a normal. What needs a temperature profile becomes zero.
 * @param factor  of the model's correlations (imki_correlation_factor()); NULL where it has none */
void imki_drift_residual(imk_model *model, const double *factor, imk_random random, uint32_t run);

/* ---- drift_gravity.c ---- */

/* What the deflection of gravity is read by in a row. */
typedef struct imki_gravity_row {
    double north[3], east[3]; /* in body axes */
    double keep;              /* of the deflection in the row before */
} imki_gravity_row;

/* Rows first … of a simulation whose row 0 ends at `start` of the trajectory. */
void imki_gravity_rows(const imk_drift_settings *settings, const imk_trajectory *trajectory,
                       double start, double interval, uint64_t first, size_t count,
                       imki_gravity_row *row);
/* Put it into the forces of these rows. @param deflection  north and east after the row before */
void imki_gravity_deflect(const imk_drift_settings *settings, imk_random random, uint32_t run,
                          uint64_t first, size_t count, const imki_gravity_row *row,
                          double deflection[2], double *const force[3]);

/* ---- drift_truth.c ---- */

/* Height above the ellipsoid [m] and upward velocity [m/s] at `count` increasing times: time k
 * gives element row[k]. */
void imki_drift_heights(const imk_trajectory *trajectory, size_t count, const size_t *row,
                        const double *time, double *height, double *climb);

/* Truth at a time, as a state of navigation (whose time is `stamp`). */
imk_navigation_state imki_drift_truth(const imk_trajectory *trajectory, double time, double stamp);

/* Truth with the initial errors of a run: position and velocity, and attitude where it is given.
 * With a slaved vertical they are horizontal. */
imk_navigation_state imki_drift_displaced(const imk_navigation_state *truth,
                                          const imk_drift_settings *settings, imk_random random,
                                          uint32_t run);

/* The nine errors of an estimate, in north-east-down axes at the true place. */
void imki_drift_errors(const imk_navigation_state *estimate, const imk_navigation_state *truth,
                       imk_attitude_errors stated, double errors[IMK_DRIFT_STATES]);

#endif
