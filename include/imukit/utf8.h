/* SPDX-License-Identifier: Apache-2.0 */
/** @file utf8.h
 *  Texts that may not be UTF-8, such as names of files, where UTF-8 is due. */
#ifndef IMUKIT_UTF8_H
#define IMUKIT_UTF8_H

#include "imukit/status.h"

IMK_BEGIN_C

/** U+FFFD. */
#define IMK_UTF8_REPLACEMENT "\xEF\xBF\xBD"

/** Bytes of the character that a text begins with, 1 … 4, as well-formed UTF-8 has it
 *  [RFC3629, 4]; 0 when it begins with none, or is empty. */
IMK_API size_t imk_utf8_length(const char *text);

/** The same, but 0 for a control character too, which a terminal could take for a command. */
IMK_API size_t imk_utf8_printable(const char *text);

/** Copy a text, every byte that is no part of a character as IMK_UTF8_REPLACEMENT, cut between two
 *  characters where it does not fit.
 *  @param target  `size` bytes, always ended by a zero; NULL with size 0
 *  @return the length of the whole, as snprintf() */
IMK_API size_t imk_utf8_clean(const char *text, char *target, size_t size);

/** Copy a text; of one that does not fit, the middle is left out, with … in its place, because the
 *  end of a path says most.
 *  @param target  `size` (> 0) bytes, always ended by a zero */
IMK_API void imk_utf8_shorten(const char *text, char *target, size_t size);

IMK_END_C
#endif
