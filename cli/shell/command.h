/* SPDX-License-Identifier: Apache-2.0 */
/* What the verbs share: exit codes, messages, the list of verbs. */
#ifndef IMUKIT_COMMAND_H
#define IMUKIT_COMMAND_H

#include "options.h"
#include "told.h"

#include "imukit/decimal.h"
#include "imukit/executor.h"
#include "imukit/io.h"
#include "imukit/units.h"

enum { EXIT_DONE = 0, EXIT_FAILED = 1, EXIT_USAGE = 2 };

/* The verbs in the order of the help: NAME_verb of each is in a file of its own. A build with fewer
 * defines its own list. */
#ifndef COMMAND_VERBS
#define COMMAND_VERBS(VERB)                                                                        \
    VERB(info)                                                                                     \
    VERB(identify)                                                                                 \
    VERB(calibrate)                                                                                \
    VERB(evaluate)                                                                                 \
    VERB(simulate)                                                                                 \
    VERB(compensate)                                                                               \
    VERB(allan)                                                                                    \
    VERB(spectrum)                                                                                 \
    VERB(devices)                                                                                  \
    VERB(grade)                                                                                    \
    VERB(convert)                                                                                  \
    VERB(join)                                                                                     \
    VERB(physics)                                                                                  \
    VERB(drift)                                                                                    \
    VERB(tune)                                                                                     \
    VERB(navigate)                                                                                 \
    VERB(merge)
#endif

#define VERB(name) extern const verb name##_verb;
COMMAND_VERBS(VERB)
#undef VERB

/* Do what a line says: its words after the name of the command, of which argv[0] is one.
 * @return the exit code */
int command_obey(int argc, char **argv);

/* Remember which verb speaks; messages start with it. */
void command_begin(const char *verb_name);
/* NULL: none yet. */
const char *command_verb(void);

/* The command line as it can be typed again; kept by command_line_keep(). */
void command_line_keep(int argument_count, char **arguments);
const char *command_line(void);
/* The same with another verb, without these flags and these options with their values (NULL behind
 * the last). @return `line` */
const char *command_line_as(const char *name, const char *const *flags, const char *const *options,
                            size_t size, char *line);

/* "imukit allan: <message>" on standard error. Return the exit code, for `return failed(…)`. */
int command_failed(const char *format, ...) __attribute__((format(printf, 1, 2)));
/* The same where a program is to know why: the code of a finding, the error of the library and the
 * file it is about. Each may be NULL; without a code it is that of the error. */
int command_failed_by(const char *code, const imk_error *error, const char *file,
                      const char *format, ...) __attribute__((format(printf, 4, 5)));
int command_misused(const char *format, ...) __attribute__((format(printf, 1, 2)));
/* The message of a library error; source is the file it is about, or NULL. */
int command_error(const imk_error *error, const char *source);
/* End the command at once, from where there is no way back; unfinished output files are removed. */
_Noreturn void command_end(int code);
/* Memory for printed and drawn results: realloc() that ends the command when it fails, so that no
 * result is incomplete. */
void *command_memory(void *at, size_t size);
/* The same, zeroed. */
void *command_zeroed(size_t size);
/* New memory where a cache line begins, as states want it. */
void *command_aligned(size_t size);
/* The same of what the library reports: the status, unless it is that memory failed. */
imk_status command_unless_memory(imk_status status);
/* The name of a model that is made: the one given, or the file's without its endings. */
void command_model_name(const char *given, const char *path, char *name, size_t size);
/* Open a model file or a catalogue entry. @return -1 or the exit code, the message printed */
int command_model(const char *name, imk_model *model, imk_document **document);
/* The same for a log that cannot be read as it is; when an option would help, the whole command to
 * run next is shown. */
int command_log_error(const imk_error *error, const char *path);
/* Refuse a --plot that cannot be drawn before the work is done. @return -1 or the exit code */
int command_check_plot(const char *plot);

/* Text from files on its way to a terminal: control sequences and bytes that are not text become
 * "?", as in error messages. Line feeds stay. */
void command_clean(char *text);

/* Is it standard output, or a pipe or device that is there: nothing that has a format by its name?
 */
bool command_is_stream(const char *path);

/* "imukit drift: <message>" on standard error and into the JSON, each once: a note, which has no
 * label and tells what a person may want to know, or a warning. */
void command_note(const char *code, const char *format, ...) __attribute__((format(printf, 2, 3)));
void command_warn(const char *code, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Bold and colours of standard output or standard error ("" when it is no terminal or NO_COLOR is
 * set). */
const char *command_color(FILE *stream, const char *sequence);
#define COLOR_BOLD "\033[1m"
#define COLOR_RED "\033[1;31m"
#define COLOR_YELLOW "\033[33m"
#define COLOR_GREEN "\033[32m"
#define COLOR_RESET "\033[0m"

/* Flush standard output: EXIT_DONE, or EXIT_FAILED with the message (a full disk). */
int command_finish(int code);

/* The nearest candidate to a name, or NULL. */
const char *command_nearest(const char *name, size_t count, const char *const *candidates);

/* Print the first page a newcomer sees. */
void command_welcome(FILE *out);

#endif
