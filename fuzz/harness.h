/* SPDX-License-Identifier: Apache-2.0 */
/* What the fuzz entry points have in common. */
#ifndef IMUKIT_FUZZ_HARNESS_H
#define IMUKIT_FUZZ_HARNESS_H

#include "imukit/log.h"
#include "imukit/status.h"

#include <stdbool.h>
#include <stdlib.h>

/* Called by libFuzzer, and by replay.c. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* What must hold whatever the bytes are. */
static inline void require(bool condition)
{
    if (!condition)
        abort();
}

/* A refusal carries its status and makes a message; what was read left the error alone. The error
 * is begun as (imk_error){.status = IMK_OK}. */
void require_told(imk_status status, const imk_error *error);

/* Open a log, and read it in pieces of up to 64 rows: it is read or refused, told, and counted. */
void read_log(const char *path, const imk_log_settings *settings, size_t piece);

/* A number that chooses settings: the sum of the bytes, so that a file as it is can be an input. */
uint32_t choice_of(const uint8_t *data, size_t size);

/* Where the files below are; cmake/fuzz.cmake says it, but not to tools that look at one file. */
#ifndef FUZZ_FILES
#define FUZZ_FILES "."
#endif

/* The bytes as files, for readers that take a path: in memory, one for each name. */
typedef enum input_file {
    INPUT_TABLE,         /* table: a log, compressed or not */
    INPUT_SCRIPT,        /* script.yaml */
    INPUT_MATRIX,        /* matrix.npy */
    INPUT_MATRIX_NAMES,  /* matrix.npy.columns */
    INPUT_CAMPAIGN_PART, /* campaign.h5.part */
    INPUT_FILES
} input_file;

/* Put the bytes into a file, in the place of those before. @return its path */
const char *input_file_put(input_file file, const uint8_t *data, size_t size);

#endif
