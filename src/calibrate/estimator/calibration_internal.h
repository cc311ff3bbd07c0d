/* SPDX-License-Identifier: Apache-2.0 */
/* Between the parts of the estimator (calibration.h). */
#ifndef IMUKIT_CALIBRATION_INTERNAL_H
#define IMUKIT_CALIBRATION_INTERNAL_H

#include "imukit/calibration.h"

enum { IMKI_CALIBRATION_COOKIE = 0x43414C31 };

/* ---- calibration_regressors.c: what the parameters do to one axis
 * -------------------------------- */

/* d(reading [unit])/d(parameter) of every free parameter at an input; those of other axes are 0.
 * For accelerometers with lever arms to first order in these. */
void imki_calibration_regressors(const imk_model *model, size_t count,
                                 const imk_model_parameter *parameter, int sensor, int axis,
                                 const double rate[3], const double force[3],
                                 const double angular_acceleration[3], double temperature,
                                 double temperature_rate, double *row);

/* ---- calibration_turn.c: how the gyros carry a direction
 * ------------------------------------------ */

/* Integrate the gyros of a record over samples begin … end - 1, corrected by the model, and carry
 * the direction `start` (unit, body axes at the beginning) to the end:
 *
 *     end = C^T start,   C from the corrected rates; the vertical part of the Earth's rate turns
 *                        about the direction carried and does not move it
 *
 * and its derivatives by the free parameters (3 x count, column p of row-major jacobian[3*count])
 * and by a small rotation of `start`: d end = turn * d start (3 x 3). Forces for g-sensitivity are
 * the accelerometers' readings, corrected by the model. `angle` is the angle turned by. */
typedef struct imki_turn_prediction {
    double end[3];
    double turn[9];
    double angle;
    double duration; /* [s] */
} imki_turn_prediction;
void imki_turn_predict(const imk_calibration *calibration, const imk_model *model,
                       const imk_turn *turn, const double start[3],
                       imki_turn_prediction *prediction, double *jacobian);

/* ---- triad_frames.c ---------------------------------------------------------------------------
 */

/* Turn all of a model's body axes: v' = c v. false when an axis of a triad would lie across the
 * body axis of its number. */
bool imki_turn_model(imk_model *model, const double c[3][3]);

/* The rotation C (a rotation and reflection, where r is left-handed) with r = form C, the form that
 * of a frame. false: r is singular. */
bool imki_frame_rotation(const double r[3][3], imk_triad_frame frame, double c[3][3]);

#endif
