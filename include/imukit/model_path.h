/* SPDX-License-Identifier: Apache-2.0 */
/** @file model_path.h
 *  The numbers of a model by their path in the model file, such as "gyro.noise.angle_random_walk".
 *  A program that does not know the structs, or is written in another language, reads every number
 *  with it. */
#ifndef IMUKIT_MODEL_PATH_H
#define IMUKIT_MODEL_PATH_H

#include "imukit/model.h"

IMK_BEGIN_C

enum { IMK_MODEL_PATH = 96, IMK_MODEL_NUMBERS = 6 * IMK_AXES_MAX };

/** The numbers at a path: number k of axis i is at [i * columns + k]. */
typedef struct imk_model_numbers {
    /** Of the numbers: "rad/sqrt(s)"; SI but for "count/uT". "" for pure numbers that the file has
     *  without a unit, such as damping. */
    const char *unit;
    int axes;    /**< 1 … IMK_AXES_MAX; 0: what the path names is not of an axis */
    int columns; /**< numbers of each axis, or of the whole; 1 … 6 */
    double value[IMK_MODEL_NUMBERS];
    double sigma[IMK_MODEL_NUMBERS]; /**< 1 sigma; 0: not stated */
} imk_model_numbers;

/** Read the numbers at a path: keys of the model file between dots, elements of lists counted from
 *  0 ("gyro.noise.gauss_markov[0].sigma", "accel.bias.temperature.coefficients[1]",
 *  "timing.jitter"). A term that is not stated has zeros. The rows of a misalignment have their
 *  diagonal. The columns of "gyro.evidence.interval_95.noise.bias_instability" are the lower and
 *  the upper end.
 *  @param numbers  untouched on error
 *  @return IMK_ERROR_NAME_UNKNOWN (error.expected: the nearest path), IMK_ERROR_KEY_MISSING (the
 *          model has no such sensor, element or interval) */
IMK_API imk_status imk_model_numbers_get(const imk_model *model, const char *path,
                                         imk_model_numbers *numbers, imk_error *error);

/** SI unit of the numbers at a path, as in imk_model_numbers, whether or not a model has them;
 * NULL: no numbers have this path. */
IMK_API const char *imk_model_path_unit(const char *path);

/** Path number `index` of all those that have numbers, in the order of the model file, with "[]"
 *  for the elements of a list; evidence is left out.
 *  @param path  receives the path
 *  @return false beyond the last path */
IMK_API bool imk_model_path(size_t index, char path[IMK_MODEL_PATH]);

IMK_END_C
#endif
