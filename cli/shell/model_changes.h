/* SPDX-License-Identifier: Apache-2.0 */
/* What --into changes in a model file. */
#ifndef IMUKIT_MODEL_CHANGES_H
#define IMUKIT_MODEL_CHANGES_H

#include "imukit/model_file.h"

/* Print the lines of the file that go and that come to standard error. */
void model_print_changes(const char *path, const imk_model *before, const imk_model *after,
                         const imk_document *document);

#endif
