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
            command_note(imk_finding_code(f), "%s", text);
    }
    if (status == IMK_OK)
        return -1;
    if (!error->found[0]) /* a record that is too large has the message of its reader */
        (void)command_unless_memory(status);
    const imk_finding *failure = imk_findings_failure(&record->loaded);
    if (!failure)
        return command_log_error(error, record->path);
    return status == IMK_ERROR_ARGUMENT
               ? command_misused("%s", text)
               : command_failed_by(imk_finding_code(failure), error, record->path, "%s", text);
}

/* A log, or a table, which needs no times. */
static log_input input_of(const calibrate_options *o, bool table)
{
    log_input input = o->log;
    if (table)
        input.file.rate = 1;
    if (input.file.device) { /* the ranges are those of the device, too */
        input.file.gyro_range = o->range[0];
        input.file.accel_range = o->range[1];
    }
    return input;
}

/* A file without times may be a table of pose means: then the message says so.
 * @return the exit code; -1: nothing speaks for it */
static int suggest_means(const calibrate_options *o, const imk_calibrate_log_settings *settings,
                         const char *path, imk_procedure procedure)
{
    imk_error error;
    imk_log_reader *reader;
    imk_calibrate_record record = {.procedure = procedure};
    const log_input input = input_of(o, true);
    const imk_log_settings file = log_input_settings(&input);
    const bool calibrates = o->procedure && !settings->repeatability;
    if (!calibrates || !imk_procedure_takes_means(procedure) || command_is_stream(path) ||
        imk_log_open(path, &file, &reader, &error) != IMK_OK)
        return -1;
    const imk_record_source source = imk_log_source(reader);
    (void)imk_calibrate_record_load(settings, path, &source, NULL, &record, &error);
    imk_log_close(reader);
    const bool looks = imk_calibrate_looks_like_means(&record);
    const size_t rows = record.record.count;
    imk_calibrate_record_free(&record);
    if (!looks)
        return -1;
    return command_failed("%s has no time column, and most of its %zu rows are in another attitude "
                          "than the row before: if each row is the mean of a pose at rest, add "
                          "--pose-means; if it is a log, add --rate 100Hz (samples per second)",
                          path, rows);
}

int session_read(const calibrate_options *o, const imk_calibrate_log_settings *settings,
                 const char *path, imk_calibrate_record *record)
{
    imk_error error;
    imk_log_reader *reader;
    const log_input input =
        input_of(o, settings->pose_means && imk_procedure_takes_means(record->procedure));
    const imk_log_settings file = log_input_settings(&input);
    imk_status status = imk_log_open(path, &file, &reader, &error);
    if (status != IMK_OK) {
        const int code = status == IMK_ERROR_RATE_MISSING
                             ? suggest_means(o, settings, path, record->procedure)
                             : -1;
        return code < 0 ? command_log_error(&error, path) : code;
    }
    job_progress shown = job_progress_begin(path);
    const imk_job job = job_progress_job(&shown, NULL);
    const imk_record_source source = imk_log_source(reader);
    status = imk_calibrate_record_load(settings, path, &source, &job, record, &error);
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
