/* SPDX-License-Identifier: Apache-2.0 */
/* What the jobs of several records begin with. */
#ifndef IMUKI_IDENTIFY_SEVERAL_INTERNAL_H
#define IMUKI_IDENTIFY_SEVERAL_INTERNAL_H

#include "imukit/identify_several.h"

/* Everything but the comparison; NULL, with the error, where the records cannot be compared. */
imk_identify_several *imki_several_begin(bool runs, size_t count,
                                         const imk_identify_log *const *logs, const imk_job *job,
                                         imk_error *error);

#endif
