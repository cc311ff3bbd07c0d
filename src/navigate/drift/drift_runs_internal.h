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
