/* SPDX-License-Identifier: Apache-2.0 */
/* What is read: tables of references and readings, logs with a reference, and the log at rest
 * (--static). */
#include "evaluate_parts.h"

#include <stdlib.h>
#include <string.h>

/* Warnings, and why a file was refused; some of that is not about the file alone. */
static int tell(const evaluation *v, const char *path, imk_status status, const imk_error *error)
{
    static const char *const of_several[] = {"two_units", "too_many_readings", "direction"};
    const imk_finding *failure = status != IMK_OK ? imk_findings_failure(&v->log->findings) : NULL;
    for (size_t k = 0; failure && k < sizeof of_several / sizeof of_several[0]; k++)
        if (strcmp(failure->code, of_several[k]) == 0) {
            char text[400];
            imk_finding_text(failure, text, sizeof text);
            return command_failed_by(imk_finding_code(failure), error, NULL, "%s", text);
        }
    return log_input_tell(path, &v->log->findings, status, error);
}

static int load_log(evaluation *v, const char *path)
{
    imk_error error;
    const calibrate_options *o = &v->options->session;
    imk_calibrate_record *record = command_zeroed(sizeof *record);
    imk_calibrate_log_settings settings = o->settings;
    int code = session_motion(o, NULL, &v->motion, &settings);
    if (code < 0)
        code = session_read(o, &settings, path, record);
    if (code < 0)
        code = tell(v, path, imk_evaluate_record(v->log, record, &error), &error);
    imk_calibrate_record_free(record);
    free(record);
    return code;
}

static imk_log_settings table_settings(const evaluation *v)
{
    imk_log_settings settings = log_input_settings(&v->options->session.log);
    if (!(settings.rate > 0))
        settings.rate = 1; /* a table has no time */
    settings.any_columns = true;
    return settings;
}

/* What cannot be opened is left to the reader of logs, which says why. */
static bool is_table(const evaluation *v, const char *path)
{
    imk_log_reader *reader;
    imk_log_settings settings = table_settings(v);
    settings.reopened = true;
    if (command_unless_memory(imk_log_open(path, &settings, &reader, NULL)) != IMK_OK)
        return false;
    const imk_record_source source = imk_log_source(reader);
    const bool is = imk_evaluate_is_table(source.column_count, source.columns);
    imk_log_close(reader);
    return is;
}

static int load_table(evaluation *v, const char *path)
{
    imk_error error;
    imk_log log;
    const imk_log_settings settings = table_settings(v);
    if (imk_log_load(path, &settings, NULL, &log, &error) != IMK_OK)
        return command_log_error(&error, path);
    const int code = tell(v, path, imk_evaluate_table(v->log, &log, &error), &error);
    imk_log_free(&log);
    return code;
}

int evaluate_load(evaluation *v)
{
    int code = -1;
    for (size_t k = 0; code < 0 && k < v->path_count; k++)
        code = is_table(v, v->path[k]) ? load_table(v, v->path[k]) : load_log(v, v->path[k]);
    return code;
}

int evaluate_load_rest(evaluation *v)
{
    const char *path = v->options->rest;
    imk_error error;
    imk_even_record record;
    int code = path ? log_input_load(&v->options->session.log, path, &record) : -1;
    if (!path || code >= 0)
        return code;
    code = tell(v, path, imk_evaluate_at_rest(v->log, &record, &error), &error);
    imk_even_record_free(&record);
    return code;
}
