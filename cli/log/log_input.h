/* SPDX-License-Identifier: Apache-2.0 */
/* Reading a log for analysis: the options every such verb takes, and loading with progress. */
#ifndef IMUKIT_LOG_INPUT_H
#define IMUKIT_LOG_INPUT_H

#include "shell/command.h"

#include "imukit/even_record.h"
#include "imukit/log.h"

/* What the options of log_input_options fill. */
typedef struct log_input {
    imk_log_settings file;
    option_integer instance;
    int gaps; /* imk_gap_policy; a verb that can do with missing samples begins with IMK_GAPS_KEEP
               */
    bool missing_allowed; /* it can: --gaps keep is no error */
} log_input;

/* How to read a file, and last what analysis does about gaps, which conversion leaves out. */
enum { LOG_INPUT_OPTIONS = 20, LOG_FORMAT_OPTIONS = LOG_INPUT_OPTIONS - 1 };
/* Without those of a sensor's ranges, for a verb that has them of its own. */
enum { LOG_RANGELESS_OPTIONS = LOG_FORMAT_OPTIONS - 2 };
extern const option log_input_options[LOG_INPUT_OPTIONS];
#define LOG_INPUT_GROUP(offset)                                                                    \
    {                                                                                              \
        "Reading the log", LOG_INPUT_OPTIONS, log_input_options, offset                            \
    }

imk_log_settings log_input_settings(const log_input *input);

/* Load a log and make its channels equally spaced by the policy on gaps. Messages are printed.
 * @return -1 or the exit code */
int log_input_load(const log_input *input, const char *path, imk_even_record *channels);

/* Refuse a policy on gaps that this verb does not have. @return -1 or the exit code */
int log_input_check(const log_input *input);
/* Open a log for a job. @param again  the job may rewind it. @return -1 or the exit code */
int log_input_open(const log_input *input, const char *path, bool again, imk_log_reader **reader);
/* Refuse a table, which is text, under a name of another format of logs. @param path  NULL: none
 * @return -1 or the exit code */
int log_table_check(const char *path);
/* What a job found, and why it failed: warnings and the error to standard error.
 * @return -1, or the exit code of a status that is no success */
int log_input_tell(const char *path, const imk_findings *findings, imk_status status,
                   const imk_error *error);
/* Notes of a job whose result does not show them. */
void log_input_note(const char *path, const imk_findings *findings);
/* The same as log_input_tell() of a job that has a model beside the record. */
int log_input_tell_model(const char *path, const char *model, const imk_findings *findings,
                         imk_status status, const imk_error *error);

#endif
