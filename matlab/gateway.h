/* SPDX-License-Identifier: Apache-2.0 */
/* The gateway from MATLAB and Octave to the verbs of the command: arguments become the words of a
 * command line, the verb runs, and its JSON becomes a struct. Options, messages and numbers are
 * those of the command because its own code makes them.
 *
 * Functions of mex.h leave by a jump when they fail. So nothing that has to be given back is held
 * in local variables: all is in the call, which the next call clears. */
#ifndef IMUKIT_GATEWAY_H
#define IMUKIT_GATEWAY_H

#include "shell/options.h"
#include "shell/voice.h"

#include <mex.h>

enum { GATEWAY_WORDS_MAX = 256, GATEWAY_WARNINGS_MAX = 128, GATEWAY_TEXT_SIZE = 4096 };

#define GATEWAY_LOG "log.npy"

/* A warning of the verb. */
typedef struct gateway_warning {
    char code[40], *text;
} gateway_warning;

/* One call of the gateway. */
typedef struct gateway_call {
    const verb *verb;
    int count;
    char *word[GATEWAY_WORDS_MAX]; /* of the command line, "imukit" first */
    char folder[256];              /* of temporary files; "": there is none */
    bool log_due;                  /* the verb writes a log, which is returned */
    bool named_columns;            /* of an array */
    bool rate_taken;               /* behind an array */
    size_t warning_count;
    gateway_warning warning[GATEWAY_WARNINGS_MAX];
    char *json, *model;                             /* what the verb made; NULL: nothing */
    char failed_by[40], failure[GATEWAY_TEXT_SIZE]; /* "usage", "failed" or "cancelled"; why */
} gateway_call;

/* The present call (gateway_voice.c). */
gateway_call *gateway_now(void);
/* Forget it, with its memory and its temporary files. */
void gateway_clear(void);
/* Its failure: only the first counts. @return false */
bool gateway_refuse(const char *format, ...) __attribute__((format(printf, 1, 2)));
/* Memory of the call; ends it where there is none. */
char *gateway_copy(const char *text);

/* The arguments behind the name of the verb as words (gateway_words.c). @return false: refused */
bool gateway_take(int count, const mxArray *const *arguments);
/* A text or a cell array of texts, which are joined. @return from mxMalloc(); NULL: it is neither
 */
char *gateway_text(const mxArray *value);

/* A file in the temporary folder, which is made where it is not there (gateway_files.c).
 * @return its path, in memory of the call; NULL: refused */
char *gateway_file(const char *name);
/* Names of columns, separated by commas, with a unit for each sensor and three for "gyro".
 * @param count  how many they are. @return memory of the caller */
char *gateway_column_names(const char *names, size_t *count);
/* An array of so many named columns as a log of this name. @return path, or NULL: refused */
char *gateway_write_array(const char *name, const mxArray *array, size_t named);
/* A text as a file. @return path, or NULL */
char *gateway_write_text(const char *name, const char *text);
/* Take the temporary folder out of a text, which shall speak of "array.npy". */
void gateway_without_folder(char *text);
/* Is there room for so many bytes in the temporary folder? @return false: refused */
bool gateway_has_room(double bytes);
void gateway_remove_files(void);

/* JSON as the struct that jsondecode() makes of it (gateway_value.c). */
mxArray *gateway_value(const char *json);

/* The log of a simulation, which is GATEWAY_LOG in the temporary folder, read back: names of
 * columns and a matrix, SI (gateway_log.c).
 * @return false: refused */
bool gateway_read_log(mxArray **columns, mxArray **data);

#endif
