/* SPDX-License-Identifier: Apache-2.0 */
/* Between the parts of the multi-position procedure. */
#ifndef IMUKIT_MULTIPOSITION_INTERNAL_H
#define IMUKIT_MULTIPOSITION_INTERNAL_H

#include "imukit/calibration.h"
#include "imukit/static_detection.h"

/* Nominal value of a reading in SI: (reading - zero) unit. */
typedef struct imki_scaling {
    double unit[IMK_AXES_MAX], zero[IMK_AXES_MAX];
} imki_scaling;

/* ---- multiposition_start.c: what counts stand for, from the log ---- */

/* Scaling of three accelerometers from the means of holds, of which only |force| = gravity is
 * known. false: they do not determine an ellipsoid. */
bool imki_start_accelerometers(size_t count, const imk_static_interval *hold, double gravity,
                               imki_scaling *accel);

/* Units of three gyros from turns of a record, given their zeros and the scaling of the
 * accelerometers. false: the turns do not determine them. */
bool imki_start_gyros(const imk_test_record *record, const imki_scaling *accel, size_t turn_count,
                      const imk_turn *turn, imki_scaling *gyro);

/* ---- multiposition_sigma.c: how well holds and turns are known ---- */

typedef struct imki_hold_noise {
    double level[2][IMK_AXES_MAX]; /* variance of a mean times its samples, common to the holds */
    double typical;                /* length of a hold [samples] */
    double holds;                  /* their number */
    double rounding[2][IMK_AXES_MAX]; /* rms over the holds of what it leaves in a mean */
} imki_hold_noise;

void imki_hold_noise_find(const imk_test_record *record, size_t count,
                          const imk_static_interval *hold, imki_hold_noise *noise);

/* Of the mean of a hold, in the unit of the reading; `step` of the reading, 0: not known. */
double imki_hold_sigma(const imki_hold_noise *noise, const imk_static_interval *hold, int sensor,
                       int axis, double step);

/* What is common to the turns of a record. */
typedef struct imki_turn_surroundings {
    int axis_count;
    double unit[IMK_AXES_MAX], step[IMK_AXES_MAX]; /* of the gyros' readings */
    double dt, latitude, earth_rate;
} imki_turn_surroundings;

/* Of the angle of a turn, about each axis across the vertical [rad]; and the Earth's part of it. */
double imki_turn_sigma(const imki_turn_surroundings *around, const imki_hold_noise *noise,
                       double duration, double *earth_sigma);

#endif
