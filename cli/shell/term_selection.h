/* SPDX-License-Identifier: Apache-2.0 */
/* --only and --without: which terms of a model a verb uses. */
#ifndef IMUKIT_TERM_SELECTION_H
#define IMUKIT_TERM_SELECTION_H

#include "command.h"

#include "imukit/model.h"

typedef struct term_selection {
    const char *only, *without; /* "angle_random_walk,gyro.bias", or NULL */
} term_selection;

/* For the option tables of the verbs. */
enum { TERM_OPTIONS = 2 };
extern const option term_options[TERM_OPTIONS];

/* Switch the other terms of the model off. @return -1 or the exit code, the message printed */
int term_selection_apply(const term_selection *selection, imk_model *model);

#endif
