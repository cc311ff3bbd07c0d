/* SPDX-License-Identifier: Apache-2.0 */
/* What calibrate, drift, evaluate, grade, navigate and tune share: models with names, motions,
 * aids. */
#ifndef IMUKIT_EXTENSION_SCENE_H
#define IMUKIT_EXTENSION_SCENE_H

#include "extension.h"

#include "imukit/drift_models.h"
#include "imukit/motion_file.h"
#include "imukit/show.h"

enum { TERMS_MAX = 64 };

/** Which terms of models are used, and what is assumed. */
typedef struct model_terms {
    PyObject *only, *without; /* tuples of names; borrowed; NULL: none */
    bool assume;
    imk_grade grade; /* IMK_GRADE_NONE: of the class that fits */
} model_terms;
/** Of a tuple (only, without, assume_class); false with an exception. */
bool terms_take(PyObject *tuple, model_terms *terms);

/** Copies of models, which no one changes meanwhile. */
typedef struct model_list {
    model_terms terms;
    size_t count;
    imk_model *memory;
    const char *name[IMK_DRIFT_MODELS_MAX]; /* borrowed */
    imk_model *model[IMK_DRIFT_MODELS_MAX]; /* with the terms that are used */
    imk_model *whole[IMK_DRIFT_MODELS_MAX]; /* with all, whatever `only` and `without` say */
    imk_model *given[IMK_DRIFT_MODELS_MAX]; /* as it came */
    imk_unstated *assumed;                  /* of each */
} model_list;
/** Of a tuple of pairs (name, model); false with an exception, models_free() either way. */
bool models_take(PyObject *pairs, const model_terms *terms, model_list *list);
void models_free(model_list *list);
/** The models as texts on the page. */
void page_models(const model_list *list, imk_result *result);

/** A motion; borrowed. */
typedef struct motion_use {
    const imk_motion_file *file; /* NULL: at rest */
    const char *name;
} motion_use;
/** Of a pair (name, motion); false with an exception. */
bool motion_take(PyObject *pair, motion_use *use);

/** Aids of a tuple of texts (aid_text.h); false with an exception. */
bool aids_take(PyObject *texts, imk_aid aid[IMK_AIDS_MAX], size_t *count);

/** Settings of a calibration, or of reading a test; false with an exception.
 *  @param place  tuple of latitude [rad], longitude [rad], height [m]; None: not known */
bool calibrate_settings_read(PyObject *dictionary, PyObject *place,
                             imk_calibrate_log_settings *settings);
/** The procedure of a test by its name; IMK_PROCEDURES with an exception. */
imk_procedure procedure_of(PyObject *object);

/** Add to a list of findings; false with an exception. */
bool add_finding(PyObject *findings, imk_finding_level level, const char *code, const char *format,
                 ...) __attribute__((format(printf, 4, 5)));
bool add_verdict(PyObject *findings, const imk_verdict *verdict);
/** Numbers as bytes; NULL with an exception. */
PyObject *numbers_of(const double *number, size_t count);
/** The text of a model's file; NULL with an exception. */
PyObject *model_text_of(const imk_model *model);

#endif
