/* SPDX-License-Identifier: Apache-2.0 */
/* The steps of scripts, "turn left 90 deg at 10 deg/s banked": a verb, quantities behind little
 * words, and words that stand for themselves. */
#ifndef IMUKI_STEP_TEXT_INTERNAL_H
#define IMUKI_STEP_TEXT_INTERNAL_H

#include "io/model/document_internal.h"

/* The quantities of a step, by the word in front; `bare` has none. */
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

/* A verb and the steps that can be made with it. */
typedef struct imki_verb {
    const char *name;
    int kind;                       /* for the reader of the step */
    unsigned words;                 /* that may stand in it */
    unsigned axes;                  /* of which exactly one must; or 0 */
    unsigned forms[IMKI_FORMS_MAX]; /* sets of parts, up to the first 0 */
    const char *usage;              /* "write hold 10 s" */
} imki_verb;

typedef struct imki_step_text {
    imki_reading *reading;
    int node; /* a scalar */
    const imki_verb *verb;
    struct {
        const char *begin, *end; /* in the node's text */
    } part[IMKI_PARTS];
    unsigned parts, words;
} imki_step_text;

/* Divide the text of a node and find its verb among `count`. `what` is "a step", for messages.
 * @return false when that fails */
bool imki_step_text_read(imki_reading *reading, int node, const char *what, size_t count,
                         const imki_verb *verbs, imki_step_text *step);

bool imki_step_text_has(const imki_step_text *step, imki_part part);

/* Number of the axis word: 0 … 2 x y z, 3 … 5 roll pitch yaw; -1 when there is none. */
int imki_step_text_axis(const imki_step_text *step);

/* Exactly `count` numbers of a part in the dimension of an SI unit. */
void imki_step_text_numbers(const imki_step_text *step, imki_part part, const char *si,
                            size_t count, double *values);
/* One; one that is above 0. What is returned after a failure is finite. */
double imki_step_text_number(const imki_step_text *step, imki_part part, const char *si);
double imki_step_text_positive(const imki_step_text *step, imki_part part, const char *si);

/* A failure at a part, found being its text; IMKI_PARTS: at the whole step. */
void imki_step_text_refuse(const imki_step_text *step, imki_part part, imk_status status,
                           const char *expected);

/* A number, as the value of a key; the value stays as it is where there is none. */
void imki_value_number(imki_reading *reading, int mapping, const char *key, const char *si,
                       double *value);
void imki_number_at(imki_reading *reading, int node, const char *si, double *value);

#endif
