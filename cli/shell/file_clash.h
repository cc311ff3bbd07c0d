/* SPDX-License-Identifier: Apache-2.0 */
/* The files of one run: none that is written may be one that is read, or another that is written,
 * however they are spelled. */
#ifndef IMUKIT_FILE_CLASH_H
#define IMUKIT_FILE_CLASH_H

#include "options.h"

/* Compare the operands, the OPTION_FILEs and the OPTION_OUTPUTs of a command line, and the files
 * that come with them (FILE.npy.columns); and, where each is evidence by itself, the
 * operands with each other.
 * @return -1, or the exit code when there is a clash, which was told */
int file_clash(const verb *v, const void *settings, const char *const *operands);

/* Is a file in a folder, or would it be, when neither need exist? */
bool file_is_in(const char *path, const char *folder);

#endif
