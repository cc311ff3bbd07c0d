/* SPDX-License-Identifier: Apache-2.0 */
/* A short text file in memory. */
#ifndef IMUKI_TEXT_FILE_INTERNAL_H
#define IMUKI_TEXT_FILE_INTERNAL_H

#include "imukit/status.h"

#include <stdbool.h>

/* All bytes of a file ("-": standard input; compressed ones unpacked), but at most limit + 1, so
 * that the reader sees that it is too long, and a zero that does not count. *bytes is from malloc.
 * The errors of imki_input_open() and imki_input_read().
 * @param reopened  it is opened again after this */
imk_status imki_file_read(const char *path, bool reopened, size_t limit, char **bytes, size_t *size,
                          imk_error *error);
/* The same of a file that is no results file of a campaign. */
imk_status imki_text_file_read(const char *path, size_t limit, char **bytes, size_t *size,
                               imk_error *error);

/* Write all bytes of a file, which appears whole or not at all. The errors of
 * imk_output_file_open() and imk_output_file_commit(). */
imk_status imki_text_file_write(const char *path, const char *bytes, size_t size, imk_error *error);

/* No control characters but those between lines and words stand in a text. */
static inline bool imki_is_text(const char *bytes, size_t size)
{
    for (size_t i = 0; i < size; i++) {
        const unsigned char c = (unsigned char)bytes[i];
        if (c < 9 || (c > 13 && c < 32) || c == 127)
            return false;
    }
    return true;
}

/* By its name, or else by its content: does a line begin with this key? It is opened again after
 * this. */
bool imki_is_script(const char *path, const char *key);

#endif
