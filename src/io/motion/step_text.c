/* SPDX-License-Identifier: Apache-2.0 */
/* Dividing the steps of scripts, and the values of their keys. */
#include "step_text_internal.h"

#include "imukit/names.h"
#include "imukit/units.h"
#include "io/model/model_yaml_internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NUMBERS_MAX = 8, VERBS_MAX = 16, TEXT_SIZE = 128 };

/* ---- errors ---------------------------------------------------------------------------------- */

/* Move the error from the node's beginning to a place in its text, where the file spells the text
 * as it is (no escapes, no folded lines). Columns count characters. */
static void point_at(const imk_document *document, int node, const char *at, imk_error *error)
{
    const imki_node *n = &document->node[node];
    const size_t quote = n->is_plain ? 0 : 1, offset = (size_t)(at - n->text);
    if (!error || n->begin + quote + offset > n->end ||
        memcmp(document->text + n->begin + quote, n->text, offset) != 0)
        return;
    error->column = n->column + quote;
    for (const char *p = n->text; p < at; p++)
        error->column += ((unsigned char)*p & 0xC0) != 0x80;
}

/* For imk_error_set(), which shortens it between characters. */
static void copy_text(char text[TEXT_SIZE], const char *begin, const char *end)
{
    const size_t length = (size_t)(end - begin) < TEXT_SIZE ? (size_t)(end - begin) : TEXT_SIZE - 1;
    memcpy(text, begin, length);
    text[length] = '\0';
}

void imki_step_text_refuse(const imki_step_text *s, imki_part part, imk_status status,
                           const char *expected)
{
    imki_reading *r = s->reading;
    char found[TEXT_SIZE];
    const imki_node *n = &r->document->node[s->node];
    const char *begin = n->text, *end = n->text + n->length;
    if (r->status != IMK_OK)
        return;
    if (part < IMKI_PARTS && s->part[part].begin) {
        begin = s->part[part].begin;
        end = s->part[part].end;
    }
    copy_text(found, begin, end);
    imki_value_refuse(r, s->node, status, found, expected);
    point_at(r->document, s->node, begin, r->error);
}

/* ---- words ----------------------------------------------------------------------------------- */

typedef struct word {
    const char *begin;
    size_t length;
} word;

static bool next_word(const char **at, word *w)
{
    while (**at == ' ' || **at == '\t' || **at == '\n')
        (*at)++;
    w->begin = *at;
    while (**at != '\0' && **at != ' ' && **at != '\t' && **at != '\n')
        (*at)++;
    w->length = (size_t)(*at - w->begin);
    return w->length > 0;
}

static bool is_word(word w, const char *text)
{
    return strlen(text) == w.length && memcmp(text, w.begin, w.length) == 0;
}

static int find_word(word w, size_t count, const char *const *names)
{
    for (size_t i = 0; i < count; i++)
        if (is_word(w, names[i]))
            return (int)i;
    return -1;
}

/* Everything behind the verb. False for a text that no step has: a word twice, or more text
 * behind a word that stands for itself. */
static bool divide(imki_step_text *s, const char *at)
{
    static const char *const parts[] = {"to", "at", "for", "in", "from", "phase"};
    static const char *const words[] = {"x",   "y",    "z",     "roll",  "pitch",
                                        "yaw", "left", "right", "banked"};
    int part = IMKI_PART_BARE; /* being read; IMKI_PARTS: none may follow */
    unsigned seen = 0;
    word w;
    while (next_word(&at, &w)) {
        const int new_part = find_word(w, sizeof parts / sizeof parts[0], parts);
        const int new_word = find_word(w, sizeof words / sizeof words[0], words);
        if (new_part >= 0) {
            part = new_part + 1;
            if (seen & 1u << part)
                return false;
            seen |= 1u << part;
        } else if (new_word >= 0) {
            if (s->words & 1u << new_word)
                return false;
            s->words |= 1u << new_word;
            if (part != IMKI_PARTS && s->part[part].begin)
                part = IMKI_PARTS;
        } else if (part == IMKI_PARTS) {
            return false;
        } else {
            if (!s->part[part].begin)
                s->part[part].begin = w.begin;
            s->part[part].end = w.begin + w.length;
            s->parts |= 1u << part;
        }
    }
    return true;
}

static bool has_form(const imki_step_text *s)
{
    const unsigned axes = s->words & s->verb->axes;
    if ((s->words & ~(s->verb->words | s->verb->axes)) != 0)
        return false;
    if (s->verb->axes != 0 && (axes == 0 || (axes & (axes - 1)) != 0))
        return false;
    for (int i = 0; i < IMKI_FORMS_MAX && s->verb->forms[i] != 0; i++)
        if (s->parts == s->verb->forms[i])
            return true;
    return false;
}

bool imki_step_text_read(imki_reading *reading, int node, const char *what, size_t count,
                         const imki_verb *verbs, imki_step_text *step)
{
    const char *names[VERBS_MAX];
    imki_step_text s = {.reading = reading, .node = node};
    const char *at = reading->document->node[node].text;
    char name[64], found[128];
    word verb;
    for (size_t i = 0; i < count; i++)
        names[i] = verbs[i].name;
    if (!next_word(&at, &verb)) {
        imki_value_refuse(reading, node, IMK_ERROR_SYNTAX, "", verbs[0].usage);
        return false;
    }
    const int index = find_word(verb, count, names);
    if (index < 0) {
        snprintf(name, sizeof name, "%.*s", (int)(verb.length < 40 ? verb.length : 40), verb.begin);
        snprintf(found, sizeof found, "\"%s\" is not %s", name, what);
        imki_refuse_name(reading, node, name, found, count, names);
        return false;
    }
    s.verb = &verbs[index];
    if (!divide(&s, at) || !has_form(&s))
        imki_step_text_refuse(&s, IMKI_PARTS, IMK_ERROR_SYNTAX, s.verb->usage);
    *step = s;
    return reading->status == IMK_OK;
}

bool imki_step_text_has(const imki_step_text *s, imki_part part)
{
    return (s->parts & 1u << part) != 0;
}

int imki_step_text_axis(const imki_step_text *s)
{
    for (int i = 0; i < 6; i++)
        if (s->words & 1u << i)
            return i;
    return -1;
}

/* ---- numbers --------------------------------------------------------------------------------- */

/* A motion is what it is: it has no uncertainty. */
static imk_status parse_exactly(const char *begin, const char *end, const char *si, size_t count,
                                double *values, imk_error *error)
{
    double numbers[NUMBERS_MAX], sigmas[NUMBERS_MAX];
    size_t found;
    const imk_status status = imk_quantity_parse(begin, end, imk_unit_of(si).dimension, count,
                                                 numbers, sigmas, &found, NULL, error);
    if (status != IMK_OK)
        return status;
    char text[TEXT_SIZE];
    copy_text(text, begin, end);
    for (size_t i = 0; i < found; i++)
        if (sigmas[i] != 0.0)
            return imk_error_set(error, IMK_ERROR_SYNTAX, "", text,
                                 "a quantity without uncertainty");
    if (found != count)
        return imk_error_set(error, IMK_ERROR_SYNTAX, "", text, "three numbers and a unit");
    memcpy(values, numbers, count * sizeof values[0]);
    return IMK_OK;
}

/* Numbers of a text of a node, whose place an error gets. */
static void read_exactly(imki_reading *r, int node, const char *begin, const char *end,
                         const char *si, size_t count, double *values)
{
    if (r->status != IMK_OK)
        return;
    r->status = parse_exactly(begin, end, si, count, values, r->error);
    if (r->status == IMK_OK || !r->error)
        return;
    imki_document_path(r->document, node, r->error->field, sizeof r->error->field);
    r->error->line = r->document->node[node].line;
    r->error->column = r->document->node[node].column;
}

/* The last word of a part when the part can be read without it, as "fast" in "10 deg/s fast". */
static bool last_word_is_foreign(const imki_step_text *s, imki_part part, const char *si,
                                 size_t count, const char **last)
{
    double unused[NUMBERS_MAX];
    const char *begin = s->part[part].begin, *at = s->part[part].end;
    while (at > begin && at[-1] != ' ' && at[-1] != '\t' && at[-1] != '\n')
        at--;
    *last = at;
    return at > begin && parse_exactly(begin, at, si, count, unused, NULL) == IMK_OK;
}

void imki_step_text_numbers(const imki_step_text *s, imki_part part, const char *si, size_t count,
                            double *values)
{
    imki_reading *r = s->reading;
    const char *begin = s->part[part].begin, *last;
    if (r->status != IMK_OK)
        return;
    read_exactly(r, s->node, begin, s->part[part].end, si, count, values);
    if (r->status == IMK_OK)
        return;
    if (last_word_is_foreign(s, part, si, count, &last)) {
        imki_step_text foreign = *s;
        foreign.part[part].begin = last;
        r->status = IMK_OK;
        imki_step_text_refuse(&foreign, part, IMK_ERROR_SYNTAX, s->verb->usage);
    } else {
        point_at(r->document, s->node, begin, r->error);
    }
}

double imki_step_text_number(const imki_step_text *s, imki_part part, const char *si)
{
    double number = 0.0;
    imki_step_text_numbers(s, part, si, 1, &number);
    return number;
}

double imki_step_text_positive(const imki_step_text *s, imki_part part, const char *si)
{
    const double number = imki_step_text_number(s, part, si);
    if (!(number > 0.0))
        imki_step_text_refuse(s, part, IMK_ERROR_RANGE, "a number above 0");
    return number;
}

/* ---- values of keys -------------------------------------------------------------------------- */

void imki_number_at(imki_reading *r, int node, const char *si, double *value)
{
    const imki_node *n = &r->document->node[node];
    if (imki_value_require(r, node, IMKI_NODE_SCALAR, "a number and its unit, as one text"))
        read_exactly(r, node, n->text, n->text + n->length, si, 1, value);
}

void imki_value_number(imki_reading *r, int mapping, const char *key, const char *si, double *value)
{
    const int node = imki_document_value(r->document, mapping, key);
    if (node != IMKI_NONE)
        imki_number_at(r, node, si, value);
}
