/* SPDX-License-Identifier: Apache-2.0 */
/** @file names.h
 *  "Did you mean …?": the nearest of a list of names. What a file is by the ending of its name. */
#ifndef IMUKIT_NAMES_H
#define IMUKIT_NAMES_H

#include "imukit/status.h"

#include <stdbool.h>

IMK_BEGIN_C

/** Index of the candidate nearest to `name`, counting letters changed, added, left out and
 *  neighbours exchanged [DAMERAU1964]; ASCII case, blanks, '-' and '_' do not count. The first one
 *  wins among equals.
 *  @param candidates  `count` names; NULL entries are skipped
 *  @return SIZE_MAX when nothing is near: more than a third of the letters differ. Names longer
 *          than 63 bytes are near to nothing. Cost: product of the lengths for each candidate. */
IMK_API size_t imk_nearest_name(const char *name, size_t count, const char *const *candidates);

/** Does the name end in `ending`, such as ".csv"? Case counts. @param name  NULL has no ending */
IMK_API bool imk_has_ending(const char *name, const char *ending);

/** Is it a script by its name, such as a model or a motion: .yaml, .yml, .json? */
IMK_API bool imk_is_script_name(const char *path);

IMK_END_C
#endif
