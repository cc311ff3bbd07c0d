/* SPDX-License-Identifier: Apache-2.0 */
/** @file names.h
 *  Names that are the same but for case, blanks and hyphens; the nearest of a list of names, for
 *  "did you mean …?"; and kinds of files by the ending of their names. */
#ifndef IMUKIT_NAMES_H
#define IMUKIT_NAMES_H

#include "imukit/status.h"

#include <stdbool.h>

IMK_BEGIN_C

/** Index of the candidate nearest to `name`, by the number of letters changed, added, left out or
 *  exchanged with a neighbour [DAMERAU1964]; ASCII case, blanks, '-' and '_' do not count. Of
 *  equals, the first is taken.
 *  @param candidates  `count` names; NULL entries are skipped
 *  @return SIZE_MAX when no candidate is near: more than a third of the letters differ, or the name
 *          is longer than 63 bytes. The time for each candidate grows with the product of the
 *          lengths. */
IMK_API size_t imk_nearest_name(const char *name, size_t count, const char *const *candidates);

/** True when two names are the same; ASCII case, blanks, '-' and '_' do not count. Names without
 *  other characters, or with more than 63 of them, are like no name. */
IMK_API bool imk_name_equal(const char *a, const char *b);

/** True when `part` occurs in `name`, by the same rules. */
IMK_API bool imk_name_within(const char *part, const char *name);

/** True when a name ends in `ending`, such as ".csv". Case matters. @param name  may be NULL, which
 *  has no ending */
IMK_API bool imk_has_ending(const char *name, const char *ending);

/** True when a file is a script by its name, such as a model or a motion: .yaml, .yml, .json. */
IMK_API bool imk_is_script_name(const char *path);

IMK_END_C
#endif
