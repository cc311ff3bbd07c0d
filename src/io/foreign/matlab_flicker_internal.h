/* SPDX-License-Identifier: Apache-2.0 */
/* The filter by which MATLAB's imuSensor makes flicker noise. */
#ifndef IMUKI_MATLAB_FLICKER_INTERNAL_H
#define IMUKI_MATLAB_FLICKER_INTERNAL_H

#include "imukit/noise.h"

enum { IMKI_MATLAB_STAGES = 5 };

/* White noise of variance B^2 through this filter is flicker noise of B, whatever the rate. */
typedef struct imki_matlab_filter {
    double numerator[IMKI_MATLAB_STAGES];       /* of z^0, z^-1 … */
    double denominator[IMKI_MATLAB_STAGES + 1]; /* the same */
} imki_matlab_filter;
extern const imki_matlab_filter imki_matlab_flicker;

/* Largest relative error of its Allan deviation from 1 to IMKI_MATLAB_FARTHEST samples: 2.9 %
 * against ideal flicker noise, and what the model's is off. */
#define IMKI_MATLAB_ERROR 0.035
#define IMKI_MATLAB_FARTHEST 50000.0

/* Allan variance at n samples for B = 1, by the stages that the filter is the sum of. */
double imki_matlab_flicker_allan_variance(double n);
/* The largest n, IMKI_MATLAB_FARTHEST at most, up to which the error against this noise of the
 * model stays within IMKI_MATLAB_ERROR; 0: nowhere. */
double imki_matlab_flicker_range(imk_flicker flicker, double dt);

#endif
