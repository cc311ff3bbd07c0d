/* SPDX-License-Identifier: Apache-2.0 */
/* imukit info: what is in a log. */
#include "log/log_input.h"
#include "shell/job_progress.h"
#include "shell/show.h"

#include "imukit/info_log.h"
#include "imukit/show.h"

#include <stdlib.h>
#include <string.h>

typedef struct info_options {
    log_input log;
    bool full, json;
} info_options;

enum { STREAMS_MAX = 256 };

#define AT(field) offsetof(info_options, field)

static const option info_option_table[] = {
    {"full", OPTION_FLAG, AT(full),
     .help = "read every row of a long log, too; by default about 64 MB of it are read, and what "
             "follows from these only is marked"},
    JSON_OPTION(AT(json), "print the result as JSON instead of tables"),
};

/* The command to run next; NULL: none is sure to fit, or the log was a stream, which is gone. */
static const char *next_command(const imk_info_log *info, const char *path, char *text, size_t size)
{
    static const char *const own[] = {"--full", "--json", NULL}, *const none[] = {NULL};
    char line[2000];
    const imk_info_next next = info ? imk_info_log_next(info) : IMK_INFO_NEXT_NONE;
    if (command_is_stream(path))
        return NULL;
    if (next == IMK_INFO_NEXT_IDENTIFY)
        snprintf(text, size, "%s -o model.yaml",
                 command_line_as("identify", own, none, sizeof line, line));
    else if (next != IMK_INFO_NEXT_NONE)
        snprintf(text, size, "%s --procedure %s -o model.yaml",
                 command_line_as("calibrate", own, none, sizeof line, line),
                 next == IMK_INFO_NEXT_SIXPOSITION ? "sixposition" : "multiposition");
    else
        return NULL;
    return text;
}

/* @param whole  it was read without an error, so that others can read it, too */
static int show(const info_options *o, const imk_info_log *info, const imk_info_file *file,
                const char *path, bool whole)
{
    char next[2200];
    imk_result *result = show_begin("info");
    imk_show_info_log(info, file, path, whole ? next_command(info, path, next, sizeof next) : NULL,
                      result);
    const show_options options = {.json = o->json};
    return show_end(result, &options, EXIT_DONE);
}

/* What can be read is shown, also where something fails; the failure is the last that is read, but
 * JSON has to know it before.
 * @param lacking  what other commands would ask for; its status is IMK_OK: nothing */
static int look(const info_options *o, imk_log_reader *reader, imk_info_file *file,
                const char *path, const imk_error *lacking)
{
    imk_info_log_settings settings = imk_info_log_default();
    imk_info_log *info;
    imk_error error;
    settings.full = o->full;
    if (file->chosen && !file->chosen->estimated && o->log.file.after == 0 &&
        o->log.file.before == 0)
        settings.rows = file->chosen->samples;
    job_progress shown = job_progress_begin(path);
    const imk_job job = job_progress_job(&shown, NULL);
    const imk_record_source source = imk_log_source(reader);
    const imk_status status = imk_info_log_run(&source, &settings, &job, &info, &error);
    job_progress_end(&shown);
    const imk_findings none = {.count = 0};
    int code = EXIT_DONE;
    if (status == IMK_OK)
        (void)log_input_tell(path, &info->findings, IMK_OK, NULL);
    if (info && o->json) /* the text has them */
        log_input_note(path, &info->findings);
    const bool readable = info && info->rows_read > 0;
    if (readable && !o->json)
        code = show(o, info, file, path, status == IMK_OK);
    if (status != IMK_OK)
        code = log_input_tell(path, info ? &info->findings : &none, status, &error);
    else if (lacking->status != IMK_OK && code == EXIT_DONE)
        code = command_log_error(lacking, path);
    if (readable && o->json) {
        const int printed = show(o, info, file, path, status == IMK_OK);
        code = code == EXIT_DONE ? printed : code;
    }
    imk_info_log_free(info);
    return code;
}

static bool names_repeat(const imk_info_file *file)
{
    for (size_t i = 0; i < file->stream_count; i++)
        for (size_t j = i + 1; j < file->stream_count; j++)
            if (file->stream[i].readable && file->stream[j].readable &&
                strcmp(file->stream[i].name, file->stream[j].name) == 0)
                return true;
    return false;
}

/* None of the sensors is chosen, or none can be read: they are listed. What was asked for and is
 * not there remains an error. */
static int list(const info_options *o, const char *path, const imk_log_settings *settings,
                const imk_error *why, imk_info_file *file, imk_log_stream *stream)
{
    imk_error error;
    const imk_log_format *format;
    if (imk_log_streams(path, settings, STREAMS_MAX, stream, &file->stream_count, &format,
                        &error) != IMK_OK ||
        file->stream_count == 0)
        return command_log_error(why, path);
    file->format = format->title;
    file->stream_count = file->stream_count < STREAMS_MAX ? file->stream_count : STREAMS_MAX;
    const bool fails = settings->topic || settings->instance > 0 || why->status == IMK_ERROR_EMPTY;
    const int failed = fails && o->json ? command_log_error(why, path) : EXIT_DONE;
    const int code = show(o, NULL, file, path, false);
    if (fails)
        return o->json ? failed : command_log_error(why, path);
    if (!o->json)
        printf("Choose one: %s --topic TOPIC%s\n", command_line(),
               names_repeat(file) ? " --instance N" : "");
    return code;
}

/* A stream cannot be opened twice. */
static imk_status open_log(const char *path, const imk_log_settings *settings,
                           imk_log_reader **reader, imk_error *lacking, imk_error *error)
{
    *lacking = (imk_error){.status = IMK_OK};
    return command_is_stream(path)
               ? imk_log_open(path, settings, reader, error)
               : imk_log_open_first_look(path, settings, reader, lacking, error);
}

static int inspect(const info_options *o, const char *path)
{
    imk_log_reader *reader;
    imk_error error, lacking;
    const imk_log_settings settings = log_input_settings(&o->log);
    imk_log_stream *stream = command_memory(NULL, STREAMS_MAX * sizeof *stream);
    imk_info_file file = {.stream = stream};
    int code;
    const imk_status status = open_log(path, &settings, &reader, &lacking, &error);
    if (status == IMK_OK) {
        file.format = imk_log_format_read(reader)->title;
        file.stream_count = imk_log_stream_list(reader, STREAMS_MAX, stream);
        file.stream_count = file.stream_count < STREAMS_MAX ? file.stream_count : STREAMS_MAX;
        file.chosen = imk_log_stream_get(reader);
        code = look(o, reader, &file, path, &lacking);
        imk_log_close(reader);
    } else if (status == IMK_ERROR_NAME_UNKNOWN || status == IMK_ERROR_EMPTY) {
        code = list(o, path, &settings, &error, &file, stream);
    } else {
        code = command_log_error(&error, path);
    }
    free(stream);
    return code;
}

static int run(int count, char **words)
{
    info_options o = {.log = {.file = {.any_columns = true}}};
    const char *operands[OPERANDS_MAX];
    const int code = options_parse(&info_verb, count, words, &o, operands);
    return code < 0 ? inspect(&o, operands[0]) : code;
}

const verb info_verb = {
    .name = "info",
    .summary = "what is in a log: sensors, columns, units, rate, gaps, clipping, rest or motion",
    .operands = "LOG",
    .operands_minimum = 1,
    .operands_maximum = 1,
    .examples = {{"imukit info static.csv", "columns and their units, rate, gaps, ranges; is it at "
                                            "rest, and what to run next"},
                 {"imukit info static.csv --full --json", "every row is read; as JSON"}},
    .description =
        "LOG is CSV (also .gz, .zst){, or logs}; - is standard input.\n\nA log of up to 32 MB is "
        "read as a whole. Of a longer one the beginning, places within and the end are read: "
        "counts are then of the rows read, and what is estimated is marked with what it follows "
        "from. A log with several sensors is listed; --topic chooses one to look at.",
    .groups = {OPTION_GROUP("Options", info_option_table, 0),
               {"Reading the log", LOG_FORMAT_OPTIONS, log_input_options, AT(log)}},
    .run = run};
