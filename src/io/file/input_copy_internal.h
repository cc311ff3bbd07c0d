/* SPDX-License-Identifier: Apache-2.0 */
/* Copies of inputs that cannot be read twice: pipes, terminals, sockets. Whoever looks into a file
 * before another reads it leaves the other a copy. */
#ifndef IMUKIT_INPUT_COPY_INTERNAL_H
#define IMUKIT_INPUT_COPY_INTERNAL_H

#include "imukit/status.h"
#include "input_stream_internal.h"

#include <stdbool.h>
#include <sys/stat.h>

/* Copy all that the stream `file` still gives to a temporary file in TMPDIR, and keep that for the
 * input `about`.
 * @param known  as of imki_input_open_known(); may be NULL
 * @return IMK_ERROR_READ, _WRITE, _MEMORY, with `path` in error.field */
imk_status imki_copy_make(const struct stat *about, int file, const char *path,
                          imki_known_bytes *known, const void *context, imk_error *error);

/* The copy of an input: a descriptor that the caller closes and reads by pread(), -1 when there is
 * none.
 * @param kept  for the next one who asks, too
 * @return why the copy could not be made when it was tried */
imk_status imki_copy_open(const struct stat *about, bool kept, int *file, imk_error *error);

/* Add bytes to it. @param file  of imki_open_nameless(), just so: errno tells why there is none
 * @return IMK_ERROR_WRITE, with `path`, of what is copied, in error.field */
imk_status imki_nameless_write(int file, const char *bytes, size_t size, const char *path,
                               imk_error *error);

#endif
