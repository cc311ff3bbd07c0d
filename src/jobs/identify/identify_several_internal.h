/* SPDX-License-Identifier: Apache-2.0 */
/* What the jobs of several records begin with. */
#ifndef IMUKI_IDENTIFY_SEVERAL_INTERNAL_H
#define IMUKI_IDENTIFY_SEVERAL_INTERNAL_H

#include "imukit/identify_several.h"

/* Everything but the comparison; NULL, with the error, where the records do not have the same
 * channels, or have the same readings. */
imk_identify_several *imki_several_begin(bool runs, size_t count,
                                         const imk_identify_log *const *logs, const imk_job *job,
                                         imk_error *error);

/* Square of a term's strength in one record, which is known even if the term is absent. */
imk_device_strength imki_strength_of(const imk_estimate *estimate, double confidence);

/* identify_rates.c: runs at several rates, of which the first that differs from the first one is
 * `other`. */
imk_status imki_compare_rates(imk_identify_several *s, size_t other, imk_error *error);

#endif
