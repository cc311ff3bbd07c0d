/* SPDX-License-Identifier: Apache-2.0 */
/* What the files of the model share beside the schema. */
#ifndef IMUKI_MODEL_INTERNAL_H
#define IMUKI_MODEL_INTERNAL_H

#include "imukit/model_parameter.h"

/* "IMK" and the number of the struct's layout: tells a model from uninitialised memory. */
#define IMKI_MODEL_COOKIE 0x494D4B01u
/* The same of the structs made from a model. */
#define IMKI_DISTORTION_COOKIE 0x494D4B11u
#define IMKI_CORRECTION_SETTINGS_COOKIE 0x494D4B12u
#define IMKI_CORRECTION_COOKIE 0x494D4B13u

/* The pendulous axis that the model states, or for a sensor along a body axis the one two places on
 * (distort.h), and the output axis o = p x e. @return false when there is neither */
bool imki_cross_axes(const imk_triad *triad, int axis, double p[3], double o[3]);

/* True when the model has such a number, or may have it when its sensor is present. */
bool imki_model_parameter_fits(const imk_model *model, imk_model_parameter parameter);

/* The interval of a key and instance, added when it is not there yet; NULL when the list is full.
 */
imk_interval *imki_evidence_interval(imk_evidence *evidence, const char *key, int instance);

#endif
