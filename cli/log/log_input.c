/* SPDX-License-Identifier: Apache-2.0 */
/* The common options of verbs that read logs, and loading one. */
#include "log_input.h"

#include "shell/job_progress.h"

#include <stdlib.h>
#include <string.h>

#define AT(field) offsetof(log_input, field)

const option log_input_options[LOG_INPUT_OPTIONS] = {
    {"rate", OPTION_QUANTITY, AT(file.rate), .letter = 'r', .value = "RATE", .unit = "Hz",
     .choices = "1e-9..1e9", .help = "sampling rate, needed when the log has no time column"},
    {"format", OPTION_TEXT, AT(file.format), .value = "NAME",
     .help = "format of a log whose content does not tell it"},
    {"topic", OPTION_TEXT, AT(file.topic), .value = "NAME",
     .help = "which sensor of a log that holds several, such as /imu/data; imukit info LOG lists "
             "them"},
    {"instance", OPTION_INTEGER, AT(instance), .value = "N", .choices = "0-999",
     .help = "which of several sensors of one name"},
    {"columns", OPTION_TEXT, AT(file.columns), .value = "NAMES",
     .help = "names of the columns of a log without header, such as time,gyro_x,gyro_y,gyro_z; - "
             "skips a column"},
    {"map", OPTION_TEXT, AT(file.map), .value = "NAMES",
     .help = "columns by the names that the log has for them, such as gyro_x=wx,time=stamp; other "
             "columns are not read"},
    {"binary", OPTION_TEXT, AT(file.binary), .value = "LAYOUT",
     .help = "layout of the records of a binary file, such as 'u32 time us, 3 x i16 gyro 16.4 "
             "LSB/(deg/s), 3 x i16 accel 2048 LSB/g'"},
    {"gyro-unit", OPTION_TEXT, AT(file.gyro_unit), .value = "UNIT",
     .help = "unit of the gyro columns where the file has none, such as deg/s"},
    {"accel-unit", OPTION_TEXT, AT(file.accel_unit), .value = "UNIT",
     .help = "unit of the accelerometer columns where the file has none, such as g"},
    {"time-unit", OPTION_TEXT, AT(file.time_unit), .value = "UNIT",
     .help = "unit of the time column where the file has none, such as us"},
    {"temperature-unit", OPTION_TEXT, AT(file.temperature_unit), .value = "UNIT",
     .help = "unit of the temperature column where the file has none, such as degC"},
    {"axes", OPTION_TEXT, AT(file.axes), .value = "NAMES",
     .help = "directions of the log's x, y and z axes, such as right-forward-up; they are mapped "
             "to forward-right-down"},
    {"after", OPTION_QUANTITY, AT(file.after), .value = "TIME", .unit = "s", .choices = "0..1e9",
     .help = "leave out what is before this time from the start of the log, such as 30s in which "
             "the sensor was still handled"},
    {"before", OPTION_QUANTITY, AT(file.before), .value = "TIME", .unit = "s",
     .choices = "1e-9..1e9", .help = "leave out what is after this time from the start of the log"},
    {"gyro-scale", OPTION_TEXT, AT(file.gyro_scale), .value = "SCALE",
     .help = "what a count of the gyros is, such as \"16.4 LSB/(deg/s)\" or \"8.75 mdps/LSB\""},
    {"accel-scale", OPTION_TEXT, AT(file.accel_scale), .value = "SCALE",
     .help = "what a count of the accelerometers is, such as \"2048 LSB/g\" or \"0.061 mg/LSB\""},
    {"device", OPTION_TEXT, AT(file.device), .value = "PART",
     .help = "digital part whose counts these are, such as BMI088; imukit devices PART shows its "
             "sensitivities"},
    {"gyro-range", OPTION_TEXT, AT(file.gyro_range), .value = "RANGE",
     .help = "full scale of the gyros of --device, such as 2000deg/s"},
    {"accel-range", OPTION_TEXT, AT(file.accel_range), .value = "RANGE",
     .help = "full scale of the accelerometers of --device, such as 16g"},
    {"gaps", OPTION_CHOICE, AT(gaps), .value = "CHOICE", .choices = "refuse|bridge|longest|keep",
     .help = "what to do with rows that are missing, not finite or out of order: refuse the log "
             "(the default, but not of allan and identify; gaps of up to 0.1 % are bridged with a "
             "warning), bridge (interpolate over them), longest (use the longest clean stretch), "
             "or keep (leave gaps; the default of allan and identify)"},
};

imk_log_settings log_input_settings(const log_input *input)
{
    imk_log_settings settings = input->file;
    settings.cookie = imk_log_default().cookie;
    settings.instance = input->instance.given ? (int)input->instance.value + 1 : 0;
    return settings;
}

int log_input_check(const log_input *input)
{
    if (input->gaps == IMK_GAPS_KEEP && !input->missing_allowed)
        return command_misused(
            "--gaps keep: this verb needs every sample; use --gaps bridge or --gaps longest");
    return -1;
}

int log_table_check(const char *path)
{
    const imk_log_format *format = imk_log_format_of(path);
    return format == imk_log_format_get(0)
               ? -1
               : command_misused("-o %s: a table is written as text, not as %s: name it in .csv",
                                 path, format->title);
}

int log_input_open(const log_input *input, const char *path, bool again, imk_log_reader **reader)
{
    imk_error error;
    imk_log_settings settings = log_input_settings(input);
    settings.reopened = again;
    if (imk_log_open(path, &settings, reader, &error) != IMK_OK)
        return command_log_error(&error, path);
    return -1;
}

/* In memory that is to be freed. */
static char *message_of(const imk_finding *finding, const char *path, const char *model)
{
    const size_t size = imk_finding_message(finding, path, model, NULL, 0) + 1;
    char *text = command_memory(NULL, size);
    imk_finding_message(finding, path, model, text, size);
    return text;
}

void log_input_note(const char *path, const imk_findings *findings)
{
    for (size_t i = 0; i < findings->count; i++)
        if (findings->item[i].level == IMK_FINDING_NOTE) {
            char *text = message_of(&findings->item[i], path, "the model");
            command_note(imk_finding_code(&findings->item[i]), "%s", text);
            free(text);
        }
}

int log_input_tell_model(const char *path, const char *model, const imk_findings *findings,
                         imk_status status, const imk_error *error)
{
    const imk_finding *failure = status != IMK_OK ? imk_findings_failure(findings) : NULL;
    for (size_t i = 0; i < findings->count; i++) {
        const imk_finding *f = &findings->item[i];
        if (f->level != IMK_FINDING_WARNING)
            continue;
        char *text = message_of(f, path, model);
        command_warn(imk_finding_code(f), "%s", text);
        free(text);
    }
    if (status == IMK_OK)
        return -1;
    if (!failure)
        return command_log_error(error, path);
    char *text = message_of(failure, path, model);
    const int code = command_failed_by(imk_finding_code(failure), error, path, "%s", text);
    free(text);
    return code;
}

int log_input_tell(const char *path, const imk_findings *findings, imk_status status,
                   const imk_error *error)
{
    return log_input_tell_model(path, "the model", findings, status, error);
}

int log_input_load(const log_input *input, const char *path, imk_even_record *channels)
{
    imk_error error;
    imk_log_reader *reader;
    imk_findings findings = {.count = 0};
    memset(channels, 0, sizeof *channels);
    int code = log_input_check(input);
    if (code < 0)
        code = log_input_open(input, path, false, &reader);
    if (code >= 0)
        return code;
    job_progress shown = job_progress_begin(path);
    const imk_job job = job_progress_job(&shown, NULL);
    const imk_record_source source = imk_log_source(reader);
    const imk_status status = imk_even_record_load(&source, (imk_gap_policy)input->gaps, &job,
                                                   channels, &findings, &error);
    job_progress_end(&shown);
    imk_log_close(reader);
    code = log_input_tell(path, &findings, status, &error);
    log_input_note(path, &findings);
    if (code >= 0)
        imk_even_record_free(channels);
    return code;
}
