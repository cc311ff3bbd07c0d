/* SPDX-License-Identifier: Apache-2.0 */
/** @file output_file.h
 *  Output files that appear complete or not at all. */
#ifndef IMUKIT_OUTPUT_FILE_H
#define IMUKIT_OUTPUT_FILE_H

#include "imukit/status.h"

IMK_BEGIN_C

typedef struct imk_output_file imk_output_file;

/** Open a file for writing. The bytes go to a new file beside `path`, which
 *  imk_output_file_commit() renames.
 *
 *  - "-" and NULL are standard output (stdio's stdout is flushed first; the two must not be mixed
 *    afterwards). A stream that is open (/dev/stdout, /dev/fd/N, /proc/self/fd/N) and an existing
 *    file that is not regular (a pipe, /dev/null, /dev/full) are written directly.
 *  - A symbolic link stays a link: the file it points at is replaced.
 *  - A replaced file keeps its permissions; a new file has those that the umask allows. A file
 *    without write permission is refused, even if its directory allows replacing it.
 *  - A path ending in .gz (level 6, no time stamp, so that equal content gives equal bytes) or .zst
 *    (level 3, with checksum) is compressed.
 *
 *  One file belongs to one thread at a time.
 *  @return IMK_ERROR_OPEN (error.field: the path; error.found: the system's reason, or what is
 *          wrong with the folder), IMK_ERROR_MEMORY */
IMK_API imk_status imk_output_file_open(const char *path, imk_output_file **file, imk_error *error);

/** Add bytes. An error is remembered, and imk_output_file_commit() reports it, too. */
IMK_API imk_status imk_output_file_write(imk_output_file *file, const void *bytes, size_t size);
/** Add formatted text, as printf; at most 4095 bytes a call. */
IMK_API imk_status imk_output_file_print(imk_output_file *file, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/** Flush, sync to the file system, rename, close and free. On any error nothing appears, and the
 *  temporary file is removed: IMK_ERROR_WRITE with the path in error.field and the system's reason
 *  in error.found. */
IMK_API imk_status imk_output_file_commit(imk_output_file *file, imk_error *error);

/** Discard the file: remove the temporary file and free. NULL is allowed. */
IMK_API void imk_output_file_abandon(imk_output_file *file);

/** Remove the temporary files of all output files that are open, and nothing else: for a signal
 *  handler that ends the process afterwards (it calls only unlink() and atomics). Later commits of
 *  these files fail. The first 32 files open at a time are covered. */
IMK_API void imk_output_file_abandon_all(void);

IMK_END_C
#endif
