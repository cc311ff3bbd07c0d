/* SPDX-License-Identifier: Apache-2.0 */
/* The parts of the reader and writer of design files. */
#ifndef IMUKI_DESIGN_FILE_INTERNAL_H
#define IMUKI_DESIGN_FILE_INTERNAL_H

#include "io/motion/step_text_internal.h"

#include "imukit/design_file.h"

enum { IMKI_DESIGN_FIELDS_MAX = 256, IMKI_DESIGN_TEXT_SIZE = 128 };

/* design_read.c: the parameters that the document gives, and the validation of the design.
 * @param design  the default on entry */
void imki_design_read_fields(imki_reading *reading, const imk_instrument *instrument, void *design);

/* Is `name` the component of `path` behind `prefix` (which ends with a dot, or is empty)? `rest` is
 * what follows: "" for the field itself, ".…" within a group. */
bool imki_design_component(const char *path, const char *prefix, size_t *length,
                           const char **component);

#endif
