/* SPDX-License-Identifier: Apache-2.0 */
/* What one axis reads at one input, and the derivatives of that: distort.h for single points. */
#ifndef IMUKIT_AXIS_READING_INTERNAL_H
#define IMUKIT_AXIS_READING_INTERNAL_H

#include "imukit/model_parameter.h"

/* A point: what the body is exposed to. */
typedef struct imki_input {
    double rate[3], force[3], angular_acceleration[3];
    double temperature; /* NaN: not known, the polynomials vanish */
    double temperature_rate;
} imki_input;

typedef struct imki_axis_reading {
    double value;
    double by_rate[3], by_force[3], by_angular_acceleration[3];
    /* What the derivatives by parameters are made of: the vector the axis sees, its component along
     * the axis, and the derivative by the vector. */
    double seen[3], along, by_seen[3];
    const imk_triad *triad;
} imki_axis_reading;

/* Reading of an axis [unit], as imk_distort() gives it without warm-up and hysteresis. */
imki_axis_reading imki_axis_read(const imk_model *model, int sensor, int axis,
                                 const imki_input *input);

/* A polynomial and a power of the temperature, clipped, above the reference. NaN: 0 */
double imki_polynomial_at(const imk_temperature_polynomial *polynomial, int axis,
                          double temperature);
double imki_power_of_warmth(const imk_temperature_polynomial *polynomial, double temperature,
                            int power);

/* d reading/d parameter, of a parameter of this axis. */
double imki_axis_regressor(const imki_axis_reading *y, const imki_input *input,
                           imk_model_parameter parameter);

#endif
