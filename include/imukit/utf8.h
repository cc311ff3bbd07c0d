/* SPDX-License-Identifier: Apache-2.0 */
/** @file utf8.h
 *  Conversion of texts that may not be UTF-8, such as names of files, to valid UTF-8. */
#ifndef IMUKIT_UTF8_H
#define IMUKIT_UTF8_H

#include "imukit/status.h"

IMK_BEGIN_C

/** The replacement character U+FFFD. */
#define IMK_UTF8_REPLACEMENT "\xEF\xBF\xBD"

/** Number of bytes of the first character of a text, 1 … 4, in well-formed UTF-8 [RFC3629, 4]; 0
 *  when the text is empty or does not begin with a valid character. */
IMK_API size_t imk_utf8_length(const char *text);

/** As imk_utf8_length(), but also 0 for a control character, which a terminal could take for a
 *  command. */
IMK_API size_t imk_utf8_printable(const char *text);

/** Copy a text. Each byte that is not part of a valid character becomes IMK_UTF8_REPLACEMENT. A
 *  text that does not fit is cut between two characters.
 *  @param target  `size` bytes, always ended by a zero; NULL with size 0
 *  @return the length of the whole, as snprintf() */
IMK_API size_t imk_utf8_clean(const char *text, char *target, size_t size);

/** Copy a text. If it does not fit, its middle is replaced by …, because the end of a path is most
 *  useful.
 *  @param target  `size` (> 0) bytes, always ended by a zero */
IMK_API void imk_utf8_shorten(const char *text, char *target, size_t size);

IMK_END_C
#endif
