/* SPDX-License-Identifier: Apache-2.0 */
/* Logs of bench tests, with rows and gaps as they are. */
#include "calibrate_parts.h"

#include "shell/job_progress.h"

/* What was found on the way. @return as the status says */
static int tell(const imk_calibrate_record *record, imk_status status, const imk_error *error)
{
    char text[600];
    for (size_t k = 0; k < record->loaded.count; k++) {
        const imk_finding *f = &record->loaded.item[k];
        imk_finding_message(f, record->path, "the model", text, sizeof text);
        if (f->level == IMK_FINDING_WARNING)
            command_warn(imk_finding_code(f), "%s", text);
        else if (f->level == IMK_FINDING_NOTE)
            command_note("%s", text);
    }
    if (status == IMK_OK)
        return -1;
    if (!error->found[0]) /* a record that is too large has the message of its reader */
        (void)command_unless_memory(status);
    if (!imk_findings_failure(&record->loaded))
        return command_log_error(error, record->path);
    return status == IMK_ERROR_ARGUMENT ? command_misused("%s", text) : command_failed("%s", text);
}

int session_read(const calibrate_options *o, const imk_calibrate_log_settings *settings,
                 const char *path, imk_calibrate_record *record)
{
    imk_error error;
    imk_log_reader *reader;
    const int code = log_input_open(&o->log, path, false, &reader);
    if (code >= 0)
        return code;
    job_progress shown = job_progress_begin(path);
    const imk_job job = job_progress_job(&shown, NULL);
    const imk_record_source source = imk_log_source(reader);
    const imk_status status =
        imk_calibrate_record_load(settings, path, &source, &job, record, &error);
    job_progress_end(&shown);
    imk_log_close(reader);
    return tell(record, status, &error);
}

int session_load(session *b)
{
    int code = session_motion(b->options, b->settings.place_known ? &b->settings.place : NULL,
                              &b->motion, &b->found->settings);
    for (size_t k = 0; code < 0 && k < b->count; k++)
        code = session_read(b->options, &b->found->settings, b->path[k], &b->found->record[k]);
    return code < 0 ? session_known_before(b) : code;
}
