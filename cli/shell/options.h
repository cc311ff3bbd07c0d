/* SPDX-License-Identifier: Apache-2.0 */
/* The option tables: one per group of options, each row read by the parser, --help, the man page,
 * the shell completion and "did you mean". */
#ifndef IMUKIT_OPTIONS_H
#define IMUKIT_OPTIONS_H

#include "imukit/model.h"
#include "imukit/units.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

typedef enum option_kind {
    OPTION_FLAG,     /* bool: true when given */
    OPTION_TEXT,     /* const char * */
    OPTION_TEXTS,    /* option_texts: may be given several times */
    OPTION_FILE,     /* const char *: completed as a file name */
    OPTION_INTO,     /* the same, of a file that --output adds to and may replace */
    OPTION_OUTPUT,   /* the same, of a file that is written: see file_clash.h */
    OPTION_INTEGER,  /* option_integer */
    OPTION_QUANTITY, /* double, SI: a number with a unit of the dimension of `unit` */
    OPTION_UNIT,     /* imk_unit: of the dimension of `unit`; NULL: of any */
    OPTION_FRACTION, /* double in (0, 1): "0.95" or "95%" */
    OPTION_CHOICE    /* int: position in `choices` */
} option_kind;

/* A whole number, and whether it was given: no value stands for that it was not. */
typedef struct option_integer {
    uint64_t value; /* the default otherwise */
    bool given;
} option_integer;

enum { OPTION_TEXTS_MAX = 8 };
typedef struct option_texts {
    size_t count;
    const char *text[OPTION_TEXTS_MAX];
} option_texts;

typedef struct option {
    const char *name; /* without the dashes */
    option_kind kind;
    size_t offset;       /* of the value in the settings of the group */
    char letter;         /* 0: none */
    const char *value;   /* what --help calls the value: "RATE" */
    const char *unit;    /* OPTION_QUANTITY: a unit of its dimension, used in messages;
                            OPTION_UNIT */
    const char *choices; /* OPTION_CHOICE: "octave|decade|all"; OPTION_INTEGER: "1-5", the least and
                            the most, NULL: any; OPTION_QUANTITY: the same as "-90..90" in `unit`,
                            or "positive", which refuses 0 and less, or "not negative";
                            OPTION_FRACTION: "0.1..0.9" */
    const char *help;    /* a clause; see `description` */
    const char *alone;   /* OPTION_TEXT: its value when none follows, only another option or
                            nothing; NULL: a value must follow */
} option;

typedef struct option_group {
    const char *title;
    size_t count;
    const option *options;
    size_t offset; /* of the group's settings in the verb's */
} option_group;

typedef struct example {
    const char *command, *meaning;
} example;

/* All options of a table as a group. */
#define OPTION_GROUP(title, table, offset)                                                         \
    {                                                                                              \
        title, sizeof(table) / sizeof(table)[0], table, offset                                     \
    }

/* OPTION_FRACTION of a confidence: beyond, its quantiles have no digits. */
#define CONFIDENCE_RANGE "0.001..0.999999999"

/* Options that several verbs have, each with its own words. */
#define PLOT_OPTION(at, text)                                                                      \
    {                                                                                              \
        "plot", OPTION_OUTPUT, at, .value = "FILE.svg|.png|.pdf|term", .help = text                \
    }
#define REPORT_OPTION(at, text)                                                                    \
    {                                                                                              \
        "report", OPTION_OUTPUT, at, .value = "FILE.html", .help = text                            \
    }
/* What a model does not state; 0: it stays unstated. */
#define ASSUME_CLASS_OPTION(at)                                                                    \
    {                                                                                              \
        "assume-class", OPTION_CHOICE, at,                                                         \
            .value = "CLASS", .choices = "none|own|strategic|navigation|tactical|AHRS|control",    \
            .help =                                                                                \
                "take typical values of a class for the terms that a model does not state, and "   \
                "name each; own: of the class that fits what it states; default none"              \
    }
/* The class of such a choice above 0; IMK_GRADE_NONE: the model's own. */
static inline imk_grade options_assumed_class(int choice)
{
    return choice > 1 ? (imk_grade)(choice - 2) : IMK_GRADE_NONE;
}
#define JSON_OPTION(at, text)                                                                      \
    {                                                                                              \
        "json", OPTION_FLAG, at, .help = text                                                      \
    }
#define STRICT_OPTION(at, text)                                                                    \
    {                                                                                              \
        "strict", OPTION_FLAG, at, .help = text                                                    \
    }
#define THREADS_OPTION(at, text)                                                                   \
    {                                                                                              \
        "threads", OPTION_INTEGER, at, .value = "N", .choices = "1-65536", .help = text            \
    }
#define SEED_OPTION(at, text)                                                                      \
    {                                                                                              \
        "seed", OPTION_INTEGER, at, .letter = 's', .value = "N", .help = text                      \
    }
#define CONFIDENCE_OPTION(at, text)                                                                \
    {                                                                                              \
        "confidence", OPTION_FRACTION, at, .value = "FRACTION", .choices = CONFIDENCE_RANGE,       \
                                           .help = text                                            \
    }
#define DECIMALS_OPTION(at)                                                                        \
    {                                                                                              \
        "decimals", OPTION_INTEGER, at,                                                            \
            .value = "N", .choices = "0-17",                                                       \
            .help = "digits after the point, 0 to 17; default: as many as the number needs"        \
    }
#define LATITUDE_OPTION(at, text) ANGLE_OPTION("latitude", "-90..90", at, text)
#define TURN_OPTION(name, at, text) ANGLE_OPTION(name, "-36000..36000", at, text)
#define ANGLE_OPTION(name, range, at, text)                                                        \
    {                                                                                              \
        name, OPTION_QUANTITY, at, .value = "ANGLE", .unit = "deg", .choices = range, .help = text \
    }
#define HEIGHT_OPTION(at)                                                                          \
    {                                                                                              \
        "height", OPTION_QUANTITY, at, .value = "LENGTH", .unit = "m",                             \
                                       .choices = "-10000..100000",                                \
                                       .help = "height above the ellipsoid; default 0m"            \
    }

/* OPERANDS_MAX is room for the operands of most verbs; one that takes more makes its own. */
enum { OPERANDS_MAX = 8, GROUPS_MAX = 5 };

/* One verb of the command. */
typedef struct verb {
    const char *name;
    const char *summary;  /* one line */
    const char *operands; /* "LOG" */
    size_t operands_minimum, operands_maximum;
    bool last_is_written;  /* the last operand is an output */
    bool all_are_evidence; /* one operand given twice would count as two */
    example examples[2];
    const char *description; /* paragraphs separated by blank lines; behind "CSV", "{ or logs}" and
                                "{, or written}" are the other formats of logs that are read, or
                                written, with these words before the last */
    option_group groups[GROUPS_MAX];
    int (*run)(int argument_count, char **arguments);
} verb;

/* Read the words after the verb.
 * @param settings  the verb's settings with their defaults
 * @param operands  room for v->operands_maximum texts; NULL where not given
 * @return -1 to go on; otherwise the exit code (help was printed, or the usage is wrong and a
 *         message was) */
int options_parse(const verb *v, int argument_count, char **arguments, void *settings,
                  const char **operands);

/* The name of an output: "-" for every name of standard output. */
const char *options_output_name(const char *name);

/* Does an output of the command line go to standard output? Tables for people then keep off it. */
bool options_stdout_taken(void);

/* Is the unit that an option gave of the dimension that is due? @return -1 or the exit code */
int options_check_unit(const char *name, const imk_unit *unit, imk_dimension due);

/* "--rate RATE", "-o, --output FILE": at most `size` bytes. */
void option_synopsis(const option *o, char *text, size_t size);

void options_help(const verb *v, FILE *out);
/* The man page of a verb in man(7) markup. */
void options_manual(const verb *v, FILE *out);
/* A bash completion script for all verbs. */
void options_completion(const verb *const *verbs, size_t count, FILE *out);

#endif
