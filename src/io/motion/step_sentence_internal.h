/* SPDX-License-Identifier: Apache-2.0 */
/* The sentences of scripts, "turn left 90 deg at 10 deg/s banked": a verb, quantities behind little
 * words, and words that stand for themselves. */
#ifndef IMUKI_STEP_SENTENCE_INTERNAL_H
#define IMUKI_STEP_SENTENCE_INTERNAL_H

#include "io/model/document_internal.h"

/* The quantities of a sentence, by the word in front; `bare` has none. */
typedef enum imki_part {
    IMKI_PART_BARE,
    IMKI_PART_TO,
    IMKI_PART_AT,
    IMKI_PART_FOR,
    IMKI_PART_IN,
    IMKI_PART_FROM,
    IMKI_PART_PHASE,
    IMKI_PARTS
} imki_part;

/* Sets of parts. */
enum {
    IMKI_BARE_BIT = 1 << IMKI_PART_BARE,
    IMKI_TO_BIT = 1 << IMKI_PART_TO,
    IMKI_AT_BIT = 1 << IMKI_PART_AT,
    IMKI_FOR_BIT = 1 << IMKI_PART_FOR,
    IMKI_IN_BIT = 1 << IMKI_PART_IN,
    IMKI_FROM_BIT = 1 << IMKI_PART_FROM,
    IMKI_PHASE_BIT = 1 << IMKI_PART_PHASE
};

/* Sets of words that stand for themselves. */
enum {
    IMKI_WORD_X = 1 << 0,
    IMKI_WORD_Y = 1 << 1,
    IMKI_WORD_Z = 1 << 2,
    IMKI_WORDS_XYZ = IMKI_WORD_X | IMKI_WORD_Y | IMKI_WORD_Z,
    IMKI_WORD_ROLL = 1 << 3,
    IMKI_WORD_PITCH = 1 << 4,
    IMKI_WORD_YAW = 1 << 5,
    IMKI_WORDS_AXES = IMKI_WORDS_XYZ | IMKI_WORD_ROLL | IMKI_WORD_PITCH | IMKI_WORD_YAW,
    IMKI_WORD_LEFT = 1 << 6,
    IMKI_WORD_RIGHT = 1 << 7,
    IMKI_WORD_BANKED = 1 << 8
};

enum { IMKI_FORMS_MAX = 6 };

/* A verb and the sentences that can be made with it. */
typedef struct imki_verb {
    const char *name;
    int kind;                       /* for the reader of the sentence */
    unsigned words;                 /* that may stand in it */
    unsigned axes;                  /* of which exactly one must; or 0 */
    unsigned forms[IMKI_FORMS_MAX]; /* sets of parts, up to the first 0 */
    const char *usage;              /* "write hold 10 s" */
} imki_verb;

/* A document that is read, and the first failure: what comes after it counts for nothing. */
typedef struct imki_reading {
    const imk_document *document;
    imk_error *error; /* may be NULL */
    imk_status status;
} imki_reading;

/* A failure at a node, unless there was one before. */
void imki_value_refuse(imki_reading *reading, int node, imk_status status, const char *found,
                       const char *expected);
/* The same, found being the node's text. */
void imki_refuse_value(imki_reading *reading, int node, imk_status status, const char *expected);
/* "did you mean" the nearest of the names, or all of them. `found` is the name, or more. */
void imki_refuse_word(imki_reading *reading, int node, const char *name, const char *found,
                      size_t count, const char *const *names);

typedef struct imki_sentence {
    imki_reading *reading;
    int node; /* a scalar */
    const imki_verb *verb;
    struct {
        const char *begin, *end; /* in the node's text */
    } part[IMKI_PARTS];
    unsigned parts, words;
} imki_sentence;

/* Divide the text of a node and find its verb among `count`. `what` is "a step", for messages.
 * @return false when that fails */
bool imki_sentence_read(imki_reading *reading, int node, const char *what, size_t count,
                        const imki_verb *verbs, imki_sentence *sentence);

bool imki_sentence_has(const imki_sentence *sentence, imki_part part);

/* Number of the axis word: 0 … 2 x y z, 3 … 5 roll pitch yaw; -1 when there is none. */
int imki_sentence_axis(const imki_sentence *sentence);

/* Exactly `count` numbers of a part in the dimension of an SI unit. */
void imki_sentence_numbers(const imki_sentence *sentence, imki_part part, const char *si,
                           size_t count, double *values);
/* One; one that is above 0. What is returned after a failure is finite. */
double imki_sentence_number(const imki_sentence *sentence, imki_part part, const char *si);
double imki_sentence_positive(const imki_sentence *sentence, imki_part part, const char *si);

/* A failure at a part, found being its text; IMKI_PARTS: at the whole sentence. */
void imki_sentence_refuse(const imki_sentence *sentence, imki_part part, imk_status status,
                          const char *expected);

/* A number, as the value of a key; the value stays as it is where there is none. */
void imki_value_number(imki_reading *reading, int mapping, const char *key, const char *si,
                       double *value);
void imki_number_at(imki_reading *reading, int node, const char *si, double *value);

/* IMK_ERROR_SYNTAX unless the node is of this kind. @return false after any failure */
bool imki_value_require(imki_reading *reading, int node, imki_node_kind kind, const char *expected);

/* Text of a key of the root, shorter than `size`; "" when it is not there. */
void imki_value_name(imki_reading *reading, const char *key, char *text, size_t size);

/* All keys of a mapping are among these; the version key of the root says 1. */
void imki_value_keys(imki_reading *reading, int mapping, size_t count, const char *const *names);
void imki_value_version(imki_reading *reading, const char *key);
/* A key that must be there. @return false after any failure */
bool imki_value_find(imki_reading *reading, int mapping, const char *key, const char *expected,
                     int *node);
/* "yes" and "no" as YAML has them; or other words, of which the first three mean true. */
extern const char *const imki_yes_no[6];
void imki_value_choice(imki_reading *reading, int node, const char *const words[6],
                       const char *expected, bool *value);
/* Digits only, from `least` to `most`. */
size_t imki_value_count(imki_reading *reading, int node, size_t least, size_t most,
                        const char *expected);

#endif
