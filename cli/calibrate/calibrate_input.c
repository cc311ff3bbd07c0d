/* SPDX-License-Identifier: Apache-2.0 */
/* Logs of bench tests, with rows and gaps as they are. */
#include "calibrate_parts.h"

#include "shell/job_progress.h"

#include <math.h>
#include <string.h>

/* The wanted column of texts is not there. */
static int no_section(const session_log *log, const char *wanted)
{
    const char *names[IMK_LOG_COLUMNS_MAX];
    size_t labels = 0;
    for (size_t c = 0; c < log->log.column_count; c++)
        if (log->log.column[c].label)
            names[labels++] = log->log.column[c].name;
    const char *nearest = command_nearest(wanted, labels, names);
    return command_failed("%s has no column \"%s\" of texts to divide it into sections%s%s%s",
                          log->path, wanted, nearest ? "; did you mean \"" : "",
                          nearest ? nearest : "", nearest ? "\"?" : "");
}

/* The log as a record of a test, and what was found in it. */
static int make_record(const session *b, session_log *log)
{
    imk_error error;
    char text[600];
    imk_findings findings = {.count = 0};
    const char *section = b->options->section;
    const imk_status status = imk_calibrate_record_make(log, section, &findings, &error);
    for (size_t k = 0; k < findings.count; k++) {
        const imk_finding *f = &findings.item[k];
        imk_finding_text(f, text, sizeof text);
        if (f->level == IMK_FINDING_WARNING)
            command_warn(strcmp(f->code, "readings_missing") == 0 ? "not_finite" : "time_order",
                         "%s: %s", log->path, text);
        else if (strcmp(f->code, "no_section") == 0)
            return no_section(log, section);
        else
            return command_failed("%s%s %s", log->path, strncmp(text, "has ", 4) == 0 ? "" : ":",
                                  text);
    }
    return command_unless_memory(status) == IMK_OK ? -1 : command_error(&error, log->path);
}

/* Long enough for what was asked. */
static int check_length(const calibrate_options *o, const session_log *log)
{
    const struct {
        const char *option;
        double value;
    } times[] = {{"initial-rest", o->initial_rest}, {"window", o->window}, {"minimum", o->minimum}};
    const double length = (double)log->record.count * log->record.dt;
    if (log->record.count < 2)
        return command_failed("%s has one row of data; a test takes thousands, some seconds of "
                              "each pose or step",
                              log->path);
    for (size_t k = 0; k < sizeof times / sizeof times[0]; k++)
        if (times[k].value > length)
            return command_misused("--%s %.6gs is longer than %s, which has %.4g s",
                                   times[k].option, times[k].value, log->path, length);
    return -1;
}

int session_load(session *b, session_log *log)
{
    imk_error error;
    const imk_log_settings settings = log_input_settings(&b->options->log);
    job_progress shown = job_progress_begin(log->path);
    const imk_job job = job_progress_job(&shown, NULL);
    const imk_status status = imk_log_load(log->path, &settings, &job, &log->log, &error);
    job_progress_end(&shown);
    if (status != IMK_OK)
        return command_log_error(&error, log->path);
    int code = make_record(b, log);
    return code < 0 ? check_length(b->options, log) : code;
}
