/* SPDX-License-Identifier: Apache-2.0 */
/* Bytes from a file, a pipe or memory, decompressed on the way.
 *
 * Files are read, not mapped: a map of a log that another program cuts short or starts anew while
 * we read it ends the process with SIGBUS, and which files are safe cannot be known. Reading costs
 * 0.05 ns/byte more than a map (measured: 0.19 against 0.14 with the file in the page cache),
 * against about 1 ns/byte for converting text to numbers. */
#ifndef IMUKIT_INPUT_STREAM_INTERNAL_H
#define IMUKIT_INPUT_STREAM_INTERNAL_H

#include "imukit/status.h"

#include <stdbool.h>

typedef struct imki_input imki_input;

/* Open a file; "-" is standard input. A .gz or .zst content is recognised by its first bytes, not
 * by its name, and decompressed.
 *
 * @return IMK_ERROR_OPEN (missing, not permitted, a directory; error.found is the system's
 *         reason), IMK_ERROR_EMPTY, IMK_ERROR_READ, IMK_ERROR_MEMORY; error.field is the path */
imk_status imki_input_open(const char *path, imki_input **input, imk_error *error);

/* The same for a file that is opened again, to be read by somebody else: one that cannot be
 * rewound, such as a pipe, is read to its end now, and its copy in TMPDIR is what this input and
 * the next opening read. Openings by imki_input_open() end the copy.
 *
 * @return IMK_ERROR_WRITE besides, when the copy cannot be written */
imk_status imki_input_open_kept(const char *path, imki_input **input, imk_error *error);

/* Are these the first bytes of an input that is read? */
typedef bool imki_known_bytes(const void *context, const char *begin, size_t size);
/* As imki_input_open_kept(), which copies texts, what is compressed and logs that their first bytes
 * tell; and what is `known` besides. */
imk_status imki_input_open_known(const char *path, imki_known_bytes *known, const void *context,
                                 imki_input **input, imk_error *error);

/* The same from memory, which must outlive the input; never decompressed. Empty is no error. */
imk_status imki_input_open_memory(const char *bytes, size_t size, imki_input **input);

/* The whole content when the input is memory, else NULL: then call imki_input_read(). */
const char *imki_input_mapped(const imki_input *input, size_t *size);

/* Up to `capacity` (> 0) bytes; fewer may come before the end. *got = 0 is the end, and stays so.
 *
 * @return IMK_ERROR_READ (error.found is the system's reason) or IMK_ERROR_COMPRESSED (error.found
 *         says what is wrong). What was decoded before the damage is delivered first. */
imk_status imki_input_read(imki_input *input, char *buffer, size_t capacity, size_t *got,
                           imk_error *error);

/* The file itself, where it is a plain file that can be read at any place by pread(); else -1: a
 * pipe, compressed, standard input, memory. It stays the input's. */
int imki_input_file(const imki_input *input);

/* Read on from this byte of a plain file (imki_input_file()) or of memory.
 * @return IMK_ERROR_READ; IMK_ERROR_UNSUPPORTED of other inputs */
imk_status imki_input_seek(imki_input *input, uint64_t place, imk_error *error);

/* Bytes of the file consumed (compressed ones, if it is) and its size, 0 when not known. */
void imki_input_progress(const imki_input *input, uint64_t *done, uint64_t *size);

/* NULL is allowed. */
void imki_input_close(imki_input *input);

#endif
