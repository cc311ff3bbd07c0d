/* SPDX-License-Identifier: Apache-2.0 */
/* What was told on standard error, kept as data for --json. */
#ifndef IMUKIT_TOLD_H
#define IMUKIT_TOLD_H

#include "imukit/job.h"
#include "imukit/result.h"
#include "imukit/status.h"

#include <stdbool.h>
#include <stddef.h>

/* The command line has --json: an error is printed as JSON, too. */
void told_wants_json(void);

/* Forget what an earlier verb of this process has told. */
void told_begin(void);

/* A note or a warning. */
typedef struct told {
    imk_finding_level level;
    char *code, *message;
} told;

/* Keep a finding. @return false: it was told before */
bool told_finding(imk_finding_level level, const char *code, const char *message);
/* In the order in which they were told. */
size_t told_count(void);
const told *told_get(size_t index);
size_t told_warnings(void);

/* Code of an error: `code`, or that of the status of `error`, or "failed". */
void told_code(const char *code, const imk_error *error, size_t size, char *text);
/* Keep why the command fails; of several reasons the first.
 * @param code   NULL: that of the status of `error`, or "failed"
 * @param error  NULL: no details
 * @param file   the file it is about, or NULL */
void told_error(const char *code, const imk_error *error, const char *file, const char *message);
/* The command that is likely to work instead. */
void told_next(const char *line);

/* Add what was told to a result that will be printed as JSON: the array `findings`, and behind an
 * error the object `error`. */
void told_show(imk_result *result);
/* The command ends: print the error as JSON if that is due and no result has told it. */
void told_end(int code);

#endif
