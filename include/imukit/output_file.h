/* SPDX-License-Identifier: Apache-2.0 */
/** @file output_file.h
 *  Output files that appear complete or not at all. */
#ifndef IMUKIT_OUTPUT_FILE_H
#define IMUKIT_OUTPUT_FILE_H

#include "imukit/status.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct imk_output_file imk_output_file;

/** Open for writing. The bytes go to a new file beside `path`, renamed by imk_output_file_commit().
 *  "-" and NULL are standard output; an existing non-regular file (a pipe, /dev/null, /dev/full) is
 *  written directly. A path ending in .gz or .zst is compressed on the way.
 *  @return IMK_ERROR_OPEN (error.found: the system's reason) */
IMK_API imk_status imk_output_file_open(const char *path, imk_output_file **file, imk_error *error);

/** Add bytes; errors are kept and reported by commit as well. */
IMK_API imk_status imk_output_file_write(imk_output_file *file, const void *bytes, size_t size);
/** Formatted text, as printf; at most 4095 bytes a call. */
IMK_API imk_status imk_output_file_print(imk_output_file *file, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/** Flush, sync to the file system, rename, close and free. On any error nothing appears, and the
 *  temporary file is removed: IMK_ERROR_WRITE with the system's reason in error.found. */
IMK_API imk_status imk_output_file_commit(imk_output_file *file, imk_error *error);

/** Give up: remove the temporary file and free. NULL is allowed. */
IMK_API void imk_output_file_abandon(imk_output_file *file);

#ifdef __cplusplus
}
#endif
#endif
