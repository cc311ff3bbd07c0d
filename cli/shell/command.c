/* SPDX-License-Identifier: Apache-2.0 */
/* Messages of the command: everything a person reads beside results comes through here. */
#define _POSIX_C_SOURCE 200809L
#include "command.h"
#include "told.h"
#include "voice.h"

#include "imukit/names.h"
#include "imukit/output_file.h"
#include "imukit/utf8.h"

#include <errno.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char *current_verb;

enum { MESSAGE_SIZE = 1 << 14 };

static int kept_count;
static char **kept_arguments;

void command_line_keep(int argument_count, char **arguments)
{
    kept_count = argument_count;
    kept_arguments = arguments;
}

static void append(char *line, size_t size, const char *text)
{
    size_t used = strlen(line);
    snprintf(line + used, size - used, "%s", text);
}

/* A word in single quotes when the shell would not take it as it is. */
static void append_word(char *line, size_t size, const char *word)
{
    static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                                "_-./,:=+@%^";
    bool quoted = !*word || word[strspn(word, plain)];
    append(line, size, quoted ? " '" : " ");
    for (; *word; word++) {
        const char letter[] = {*word, '\0'};
        append(line, size, *word == '\'' ? "'\\''" : letter);
    }
    append(line, size, quoted ? "'" : "");
}

const char *command_line(void)
{
    static char line[2000];
    snprintf(line, sizeof line, "imukit");
    for (int i = 1; i < kept_count; i++)
        append_word(line, sizeof line, kept_arguments[i]);
    return line;
}

/* Is a word one of these, up to its "=" or its end? */
static bool is_among(const char *const *list, const char *word, size_t length)
{
    for (; *list; list++)
        if (strlen(*list) == length && strncmp(*list, word, length) == 0)
            return true;
    return false;
}

const char *command_line_as(const char *name, const char *const *flags, const char *const *options,
                            size_t size, char *line)
{
    snprintf(line, size, "imukit %s", name);
    for (int i = 2; i < kept_count; i++) {
        const char *word = kept_arguments[i];
        const size_t length = strcspn(word, "=");
        if (is_among(options, word, length))
            i += word[length] == '\0';
        else if (!is_among(flags, word, strlen(word)))
            append_word(line, size, word);
    }
    return line;
}

static bool has_said_why; /* a message was an error's */

void command_begin(const char *verb_name)
{
    current_verb = verb_name;
    has_said_why = false;
    told_begin();
}

const char *command_verb(void)
{
    return current_verb;
}

const char *command_color(FILE *stream, const char *sequence)
{
    const char *no_color = getenv("NO_COLOR");
    if (no_color && *no_color)
        return "";
    return isatty(fileno(stream)) ? sequence : "";
}

void command_clean(char *text)
{
    char *end = text;
    while (*text) {
        const size_t printable = imk_utf8_printable(text), length = imk_utf8_length(text);
        if (printable > 0 || *text == '\n') {
            memmove(end, text, length);
            end += length;
        } else {
            *end++ = '?';
        }
        text += length > 0 ? length : 1;
    }
    *end = '\0';
}

static void fail(const char *code, const imk_error *error, const char *file, const char *format,
                 va_list arguments) __attribute__((format(printf, 4, 0)));

/* The file of an error that names it in its field: the word of the command line of which the field
 * is the shortened form, else the field. */
static const char *file_of(const imk_error *error)
{
    if (error->status != IMK_ERROR_OPEN && error->status != IMK_ERROR_READ &&
        error->status != IMK_ERROR_WRITE)
        return NULL;
    for (int i = 1; i < kept_count; i++) {
        const char *word = kept_arguments[i], *value = strchr(word, '=');
        char name[sizeof error->field];
        if (strncmp(word, "--", 2) == 0)
            word = value ? value + 1 : word;
        else if (word[0] == '-' && word[1] != '\0')
            word += 2; /* -oFILE */
        imk_utf8_shorten(word, name, sizeof name);
        if (strcmp(name, error->field) == 0)
            return word;
    }
    return error->field;
}

static void fail(const char *code, const imk_error *error, const char *file, const char *format,
                 va_list arguments)
{
    char text[MESSAGE_SIZE];
    vsnprintf(text, sizeof text, format, arguments);
    command_clean(text);
    has_said_why = true;
    char word[48];
    told_code(code, error, sizeof word, word);
    voice_say(VOICE_FAILURE, current_verb, word, text);
    told_error(code, error, file || !error ? file : file_of(error), text);
}

int command_failed(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    fail("failed", NULL, NULL, format, arguments);
    va_end(arguments);
    return EXIT_FAILED;
}

int command_failed_by(const char *code, const imk_error *error, const char *file,
                      const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    fail(code, error, file, format, arguments);
    va_end(arguments);
    return EXIT_FAILED;
}

int command_misused(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    fail("usage", NULL, NULL, format, arguments);
    va_end(arguments);
    voice_advise("Try: imukit%s%s --help", current_verb ? " " : "",
                 current_verb ? current_verb : "");
    return EXIT_USAGE;
}

int command_error(const imk_error *error, const char *source)
{
    char text[900];
    imk_error_text(error, source, text, sizeof text);
    return command_failed_by(NULL, error, source, "%s", text);
}

void command_end(int code)
{
    imk_output_file_abandon_all();
    told_end(code);
    voice_end(code);
}

imk_status command_unless_memory(imk_status status)
{
    if (status == IMK_ERROR_MEMORY)
        command_end(command_failed_by("memory", NULL, NULL, "memory is exhausted"));
    return status;
}

void *command_memory(void *at, size_t size)
{
    void *memory = realloc(at, size);
    (void)command_unless_memory(memory ? IMK_OK : IMK_ERROR_MEMORY);
    return memory;
}

void *command_zeroed(size_t size)
{
    void *memory = calloc(1, size);
    (void)command_unless_memory(memory ? IMK_OK : IMK_ERROR_MEMORY);
    return memory;
}

void *command_aligned(size_t size)
{
    void *memory = aligned_alloc(64, (size + 63) / 64 * 64);
    (void)command_unless_memory(memory ? IMK_OK : IMK_ERROR_MEMORY);
    return memory;
}

/* The remedy of the log reader is "add --option value … (why)": the options are what stands
 * between.
 * "--columns with 7 names" asks for what only the user knows. */
/* Does a text have this option of a command line, "--topic" or "--topic=NAME"? */
static bool has_option(const char *text, const char *word)
{
    const size_t length = strcspn(word, "=");
    if (strncmp(word, "--", 2) != 0 || length == 2)
        return false;
    for (const char *at = text; (at = strstr(at, "--")) != NULL; at += 2)
        if (strncmp(at, word, length) == 0 && (at[length] == ' ' || at[length] == '\0'))
            return true;
    return false;
}

/* A topic that is named anew has an instance of its own, or none. */
static bool is_replaced(const char *options, const char *word)
{
    return has_option(options, word) ||
           (has_option("--instance ", word) && has_option(options, "--topic"));
}

/* The command line without the options that these replace, which have a value each. */
static const char *command_line_but(const char *options, size_t size, char *line)
{
    snprintf(line, size, "imukit");
    for (int i = 1; i < kept_count; i++) {
        if (!is_replaced(options, kept_arguments[i]))
            append_word(line, size, kept_arguments[i]);
        else if (!strchr(kept_arguments[i], '='))
            i++;
    }
    return line;
}

int command_log_error(const imk_error *error, const char *path)
{
    int code = command_error(error, path);
    const char *options = error->expected;
    if (strncmp(options, "add --", 6) != 0 || strstr(options, " with "))
        return code;
    options += 4;
    char added[sizeof error->expected], line[2000];
    const char *reason = strstr(options, " (");
    snprintf(added, sizeof added, "%.*s", (int)(reason ? reason - options : (long)strlen(options)),
             options);
    char next[sizeof line + sizeof added];
    snprintf(next, sizeof next, "%s %s", command_line_but(added, sizeof line, line), added);
    voice_advise("Next: %s", next);
    told_next(next);
    return code;
}

void command_model_name(const char *given, const char *path, char *name, size_t size)
{
    const char *slash = strrchr(path, '/');
    const char *base = slash ? slash + 1 : path;
    char stem[256]; /* no file has a longer name */
    snprintf(stem, sizeof stem, "%.*s", (int)strcspn(base, "."), base);
    imk_utf8_clean(given ? given : stem, name, size);
}

int command_model(const char *name, imk_model *model, imk_document **document)
{
    imk_error error;
    imk_status status = imk_model_open(name, model, document, &error);
    if (status == IMK_OK)
        return -1;
    if (status == IMK_ERROR_KEY_UNKNOWN && strcmp(error.found, "instrument") == 0)
        return command_failed_by(
            "design_not_model", &error, name,
            "%s is the design of an instrument, not a model; its error model:\n"
            "  imukit physics %s --reduce -o MODEL.yaml",
            name, name);
    if (status == IMK_ERROR_NAME_UNKNOWN && imk_instrument_find(name))
        return command_failed_by("design_not_model", &error, name,
                                 "%s is an instrument, not a model; the error model of its default "
                                 "design:\n  imukit physics %s --reduce -o MODEL.yaml",
                                 name, name);
    return command_error(&error, status == IMK_ERROR_NAME_UNKNOWN ? NULL : name);
}

int command_check_plot(const char *plot)
{
    if (!plot || strcmp(plot, "term") == 0 || imk_has_ending(plot, ".svg") ||
        imk_has_ending(plot, ".png") || imk_has_ending(plot, ".pdf"))
        return -1;
    return command_misused("--plot %s: expected a name ending in .svg, .png or .pdf, or the word "
                           "term",
                           plot);
}

bool command_is_stream(const char *path)
{
    struct stat about;
    return strcmp(path, "-") == 0 ||
           (stat(path, &about) == 0 && !S_ISREG(about.st_mode) && !S_ISDIR(about.st_mode));
}

static void tell(imk_finding_level level, const char *code, const char *format, va_list arguments)
    __attribute__((format(printf, 3, 0)));

static void tell(imk_finding_level level, const char *code, const char *format, va_list arguments)
{
    char text[MESSAGE_SIZE];
    vsnprintf(text, sizeof text, format, arguments);
    command_clean(text);
    if (!told_finding(level, code, text))
        return;
    voice_say(level == IMK_FINDING_WARNING ? VOICE_WARNING : VOICE_NOTE, current_verb, code, text);
}

void command_note(const char *code, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    tell(IMK_FINDING_NOTE, code, format, arguments);
    va_end(arguments);
}

void command_warn(const char *code, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    tell(IMK_FINDING_WARNING, code, format, arguments);
    va_end(arguments);
}

int command_finish(int code)
{
    told_end(code);
    const int number = fflush(stdout) != 0 ? errno : 0;
    if (number == 0 && !ferror(stdout))
        return code;
    /* An error before this flush has left no reason here; it may have been reported already. */
    if (!has_said_why)
        command_failed("standard output: %s",
                       number != 0 ? strerror(number) : "not all of it could be written");
    return code == EXIT_DONE ? EXIT_FAILED : code;
}

const char *command_nearest(const char *name, size_t count, const char *const *candidates)
{
    size_t nearest = imk_nearest_name(name, count, candidates);
    return nearest < count ? candidates[nearest] : NULL;
}
