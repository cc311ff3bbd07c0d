/* SPDX-License-Identifier: Apache-2.0 */
/** @file model_parameter.h
 *  Access to single numbers of a model by their place. Calibration estimates such numbers, and
 *  covariances refer to them. */
#ifndef IMUKIT_MODEL_PARAMETER_H
#define IMUKIT_MODEL_PARAMETER_H

#include "imukit/model.h"

IMK_BEGIN_C

/** How many numbers a term has per axis: 1, 3, 5 or 6; 0 when the sensor does not have the term. A
 *  temperature term has the largest possible number, whatever the order of its polynomial. */
IMK_API int imk_model_term_elements(int sensor, int term);
/** Address of a value in a model. If you set a temperature coefficient, set the order of the
 *  polynomial, too.
 *  @param sigma  set to the address of its sigma; NULL: not wanted
 *  @return NULL when there is no such number: the sensor is not present, the axis is beyond
 *          axis_count, or it is on the diagonal of the misalignment or cross_axis of three axes */
IMK_API double *imk_model_parameter_at(imk_model *model, imk_model_parameter parameter,
                                       double **sigma);
/** Value of a parameter; NaN when there is no such number. */
IMK_API double imk_model_parameter_get(const imk_model *model, imk_model_parameter parameter);

/** Size of the longest name [bytes], terminating zero included. */
enum { IMK_MODEL_PARAMETER_NAME = 48 };
/** Dotted name, as in the model file: "accel.bias.fixed.x", "gyro.misalignment.x.y" (row x, column
 *  y), "accel.cross_products.z.ip", "gyro.g2_sensitivity.x.yz", "accel.bias.temperature.x.2" (power
 *  2). The first three axes are x, y, z, further ones 3 … 7.
 *  @return IMK_ERROR_ARGUMENT when there is no such number */
IMK_API imk_status imk_model_parameter_name(imk_model_parameter parameter,
                                            char name[IMK_MODEL_PARAMETER_NAME]);
/** Find a parameter by its dotted name; axes 0, 1, 2 are also accepted for x, y, z.
 *  @return IMK_ERROR_NAME_UNKNOWN */
IMK_API imk_status imk_model_parameter_parse(const char *name, imk_model_parameter *parameter);
/** SI unit of a parameter as the model file writes it: "rad/s", "1", "rad", "1/(m/s^2)",
 *  "rad/s/(m/s^2)" … */
IMK_API const char *imk_model_parameter_unit(imk_model_parameter parameter);

IMK_END_C
#endif
