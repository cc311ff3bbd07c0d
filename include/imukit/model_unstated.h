/* SPDX-License-Identifier: Apache-2.0 */
/** @file model_unstated.h
 *  What a model does not state. A term that is left out is simulated as zero, but the sensor has it
 *  all the same: an error budget without the run-to-run bias is a lower bound, and no class.
 *
 *  A term is stated by a number, or by a zero that is stated to be one (`repeatability: 0 deg/h` in
 *  a model file). What is not stated can be assumed to be typical of a class: the values of the
 *  grade presets (imk_device), but not more than the evidence allows, where the term was looked for
 *  and not found. */
#ifndef IMUKIT_MODEL_UNSTATED_H
#define IMUKIT_MODEL_UNSTATED_H

#include "imukit/model.h"

IMK_BEGIN_C

/** A term that every sensor has, and its typical value. */
typedef struct imk_unstated_term {
    int sensor;       /**< IMK_GYRO or IMK_ACCEL */
    const char *key;  /**< key of the typical value below the sensor: "bias.repeatability" */
    const char *text; /**< in words: "gyro run-to-run bias" */
    imk_grade grade;  /**< class of which the value is typical */
    double typical;   /**< value typical of the class, or the bound of the evidence if it is
                           smaller [SI]; 0: the class has no such term */
    const char *unit; /**< unit in which it is read best: "deg/h" */
    const char *si;   /**< SI unit: "rad/s" */
} imk_unstated_term;

enum { IMK_UNSTATED_MAX = 32 };

/** Terms, the gyros' first. */
typedef struct imk_unstated {
    size_t count;
    imk_unstated_term term[IMK_UNSTATED_MAX];
} imk_unstated;

/** Terms of gyros and accelerometers that a model does not state: the run-to-run bias, white noise,
 *  bias instability, random walk, scale factor, misalignment, the gyros' sensitivities to force,
 *  the accelerometers' response to its square. Their typical values are of the class that
 *  imk_model_class() finds.
 *
 *  The run-to-run bias is stated by bias.repeatability. A 1 sigma of bias.fixed says how well the
 *  bias was known when it was measured, not how it is after the next power-on; it counts only in a
 *  model that is the residual of a compensation (residual_of). A Gauss-Markov process counts as a
 *  bias instability, a cross-axis response as a misalignment.
 *  A sensor that is not present lacks all of them. */
IMK_API void imk_model_unstated(const imk_model *model, imk_unstated *unstated);

/** The class whose preset is nearest to the noise, run-to-run bias and scale factor that a sensor
 *  states, by the mean square of the logarithms of the ratios. Unlike imk_grade_model(), it needs
 *  no biases. Without any of these numbers it is the class of the other kind of sensor;
 *  IMK_GRADE_NONE when that one states nothing either. */
IMK_API imk_grade imk_model_class(const imk_model *model, int sensor);

/** Give all terms that are not stated their typical values. Gyros or accelerometers that are not
 *  present are added, with three axes along x, y and z.
 *  @param grade    class to assume; IMK_GRADE_NONE: for each kind of sensor the one of
 *                  imk_model_class(), or control when there is none
 *  @param assumed  set to the terms that were given a value; NULL: not wanted */
IMK_API void imk_model_assume_class(imk_model *model, imk_grade grade, imk_unstated *assumed);

/** True when a number under this key ("bias.repeatability", "noise.gauss_markov") is stated: it is
 *  not 0, or it is 0 and stated to be. False for a key that the sensor does not have. */
IMK_API bool imk_model_states(const imk_model *model, int sensor, const char *key);
/** State that a term is 0. It has no effect while the term has a number that is not 0.
 *  @return IMK_ERROR_NAME_UNKNOWN: the sensor has no such key, or it is a list, a polynomial or a
 *          direction */
IMK_API imk_status imk_model_state_zero(imk_model *model, int sensor, const char *key,
                                        imk_error *error);

IMK_END_C
#endif
