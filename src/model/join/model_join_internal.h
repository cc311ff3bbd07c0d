/* SPDX-License-Identifier: Apache-2.0 */
/* The parts of joining: notes, and a triad from three axes. */
#ifndef IMUKI_MODEL_JOIN_INTERNAL_H
#define IMUKI_MODEL_JOIN_INTERNAL_H

#include "imukit/model_join.h"

/* What is being joined. */
typedef struct imki_join {
    size_t count;
    const imk_join_part *part;
    imk_model *unit;
    imk_joined *joined;
} imki_join;

void imki_join_tell(imk_joined *joined, imk_join_note_kind kind, int sensor, int part,
                    const char *key);
/* Two parts of which only one can be right; `more` says what to do. */
imk_status imki_join_conflict(const imki_join *join, const char *field, int a, int b,
                              const char *more, imk_error *error);

imk_evidence *imki_join_evidence(imk_model *model, int sensor);
const imk_evidence *imki_join_evidence_of(const imk_model *model, int sensor);

/* model_join_axes.c: the row of a part that gives an axis, and by how many body axes it is
 * turned. */
imk_status imki_join_row(const imk_join_part *part, int sensor, int *row, int *turn,
                         imk_error *error);
/* The sensors of a kind and their evidence, from joined->from. */
imk_status imki_join_axes(const imki_join *join, int sensor, imk_error *error);

#endif
