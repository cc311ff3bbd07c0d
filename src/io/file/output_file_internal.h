/* SPDX-License-Identifier: Apache-2.0 */
/* What the writers of logs and of results need of an output file beyond output_file.h. */
#ifndef IMUKIT_OUTPUT_FILE_INTERNAL_H
#define IMUKIT_OUTPUT_FILE_INTERNAL_H

#include "imukit/output_file.h"

#include <stdbool.h>

/* Refuse a path that imk_output_file_open() would, before hours are spent on what is to be written
 * there. */
imk_status imki_output_file_check(const char *path, imk_error *error);

/* Can bytes written before be replaced? Only in an uncompressed regular file. */
bool imki_output_file_can_replace(const imk_output_file *file);

/* Replace bytes from `offset` on, all of which were written before. */
imk_status imki_output_file_replace(imk_output_file *file, uint64_t offset, const void *bytes,
                                    size_t size);

/* The file that holds the bytes until it gets its name, for a library that writes it itself; NULL
 * if there is none. */
const char *imki_output_file_temporary(const imk_output_file *file);

/* The part of commit that can well fail: flush, end the compression, sync to the disk. Commit then
 * only renames, so that several files can be prepared first and appear together. On error the file
 * is abandoned and freed. */
imk_status imki_output_file_prepare(imk_output_file *file, imk_error *error);

#endif
