/* SPDX-License-Identifier: Apache-2.0 */
/** @file model_parameter.h
 *  One number of a model by its place: what calibration estimates, what a covariance is about. */
#ifndef IMUKIT_MODEL_PARAMETER_H
#define IMUKIT_MODEL_PARAMETER_H

#include "imukit/model.h"

IMK_BEGIN_C

/** Numbers of a term per axis: 1, 3, 5 or 6; 0 when the sensor does not have it. Of a temperature
 *  term as many as a polynomial can have, whatever its order in a model. */
IMK_API int imk_model_term_elements(int sensor, int term);
/** Where the value is in a model, and, when sigma is not NULL, where its sigma is. NULL when there
 *  is no such number: a sensor that is not present, an axis beyond axis_count, the diagonal of the
 *  misalignment or cross_axis of three axes. Whoever sets a temperature coefficient sets the order
 *  too. */
IMK_API double *imk_model_parameter_at(imk_model *model, imk_model_parameter parameter,
                                       double **sigma);
/** The value; NaN when there is no such number. */
IMK_API double imk_model_parameter_get(const imk_model *model, imk_model_parameter parameter);

/** Longest name, its end included. */
enum { IMK_MODEL_PARAMETER_NAME = 48 };
/** Dotted name, as in the model file: "accel.bias.fixed.x", "gyro.misalignment.x.y" (row x, column
 *  y), "accel.cross_products.z.ip", "gyro.g2_sensitivity.x.yz", "accel.bias.temperature.x.2" (power
 *  2). The first three axes are x, y, z, further ones 3 … 7.
 *  @return IMK_ERROR_ARGUMENT when there is no such number */
IMK_API imk_status imk_model_parameter_name(imk_model_parameter parameter,
                                            char name[IMK_MODEL_PARAMETER_NAME]);
/** The inverse; 0, 1, 2 are read for x, y, z too. @return IMK_ERROR_NAME_UNKNOWN */
IMK_API imk_status imk_model_parameter_parse(const char *name, imk_model_parameter *parameter);
/** SI unit as the model file writes it: "rad/s", "1", "rad", "1/(m/s^2)", "rad/s/(m/s^2)" … */
IMK_API const char *imk_model_parameter_unit(imk_model_parameter parameter);

IMK_END_C
#endif
