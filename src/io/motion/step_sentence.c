/* SPDX-License-Identifier: Apache-2.0 */
/* Dividing the sentences of scripts, and the values of their keys. */
#include "step_sentence_internal.h"

#include "imukit/names.h"
#include "imukit/units.h"
#include "io/model/model_yaml_internal.h"

#include <stdio.h>
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

imk_status imki_sentence_refuse(const imki_sentence *s, imki_part part, imk_status status,
                                const char *expected)
{
    char found[TEXT_SIZE];
    const imki_node *n = &s->document->node[s->node];
    const char *begin = n->text, *end = n->text + n->length;
    if (part < IMKI_PARTS && s->part[part].begin) {
        begin = s->part[part].begin;
        end = s->part[part].end;
    }
    copy_text(found, begin, end);
    imki_document_error(s->document, s->node, status, found, expected, s->error);
    point_at(s->document, s->node, begin, s->error);
    return status;
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

/* Everything behind the verb. False for a text that no sentence has: a word twice, or more text
 * behind a word that stands for itself. */
static bool divide(imki_sentence *s, const char *at)
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

static bool has_form(const imki_sentence *s)
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

static imk_status refuse_verb(const imki_sentence *s, word w, const char *what, size_t count,
                              const char *const *names)
{
    char verb[64], found[128], expected[sizeof s->error->expected];
    snprintf(verb, sizeof verb, "%.*s", (int)(w.length < 40 ? w.length : 40), w.begin);
    snprintf(found, sizeof found, "\"%s\" is not %s", verb, what);
    const size_t nearest = imk_nearest_name(verb, count, names);
    if (nearest != SIZE_MAX) {
        snprintf(expected, sizeof expected, "did you mean \"%s\"?", names[nearest]);
    } else {
        size_t length = (size_t)snprintf(expected, sizeof expected, "one of");
        for (size_t i = 0; i < count && length + strlen(names[i]) + 3 < sizeof expected; i++)
            length += (size_t)snprintf(expected + length, sizeof expected - length, "%s %s",
                                       i > 0 ? "," : "", names[i]);
    }
    return imki_document_error(s->document, s->node, IMK_ERROR_NAME_UNKNOWN, found, expected,
                               s->error);
}

imk_status imki_sentence_read(const imk_document *document, int node, const char *what,
                              size_t count, const imki_verb *verbs, imki_sentence *sentence,
                              imk_error *error)
{
    const char *names[VERBS_MAX];
    imki_sentence s = {.document = document, .node = node, .error = error};
    const char *at = document->node[node].text;
    word verb;
    for (size_t i = 0; i < count; i++)
        names[i] = verbs[i].name;
    if (!next_word(&at, &verb))
        return imki_document_error(document, node, IMK_ERROR_SYNTAX, "", verbs[0].usage, error);
    const int index = find_word(verb, count, names);
    if (index < 0)
        return refuse_verb(&s, verb, what, count, names);
    s.verb = &verbs[index];
    if (!divide(&s, at) || !has_form(&s))
        return imki_sentence_refuse(&s, IMKI_PARTS, IMK_ERROR_SYNTAX, s.verb->usage);
    *sentence = s;
    return IMK_OK;
}

bool imki_sentence_has(const imki_sentence *s, imki_part part)
{
    return (s->parts & 1u << part) != 0;
}

int imki_sentence_axis(const imki_sentence *s)
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

static void place_error(const imk_document *document, int node, imk_error *error)
{
    if (!error)
        return;
    imki_document_path(document, node, error->field, sizeof error->field);
    error->line = document->node[node].line;
    error->column = document->node[node].column;
}

/* The last word of a part when the part can be read without it, as "fast" in "10 deg/s fast". */
static bool last_word_is_foreign(const imki_sentence *s, imki_part part, const char *si,
                                 size_t count, const char **last)
{
    double unused[NUMBERS_MAX];
    const char *begin = s->part[part].begin, *at = s->part[part].end;
    while (at > begin && at[-1] != ' ' && at[-1] != '\t' && at[-1] != '\n')
        at--;
    *last = at;
    return at > begin && parse_exactly(begin, at, si, count, unused, NULL) == IMK_OK;
}

imk_status imki_sentence_numbers(const imki_sentence *s, imki_part part, const char *si,
                                 size_t count, double *values)
{
    const char *last;
    const imk_status status =
        parse_exactly(s->part[part].begin, s->part[part].end, si, count, values, s->error);
    if (status == IMK_OK)
        return IMK_OK;
    if (last_word_is_foreign(s, part, si, count, &last)) {
        imki_sentence foreign = *s;
        foreign.part[part].begin = last;
        return imki_sentence_refuse(&foreign, part, IMK_ERROR_SYNTAX, s->verb->usage);
    }
    place_error(s->document, s->node, s->error);
    point_at(s->document, s->node, s->part[part].begin, s->error);
    return status;
}

imk_status imki_sentence_positive(const imki_sentence *s, imki_part part, const char *si,
                                  double *value)
{
    double number;
    const imk_status status = imki_sentence_numbers(s, part, si, 1, &number);
    if (status != IMK_OK)
        return status;
    if (!(number > 0.0))
        return imki_sentence_refuse(s, part, IMK_ERROR_RANGE, "a number above 0");
    *value = number;
    return IMK_OK;
}

/* ---- values of keys -------------------------------------------------------------------------- */

imk_status imki_value_require(const imk_document *document, int node, imki_node_kind kind,
                              const char *expected, imk_error *error)
{
    const imki_node *n = &document->node[node];
    return n->kind == kind
               ? IMK_OK
               : imki_document_error(document, node, IMK_ERROR_SYNTAX,
                                     n->kind == IMKI_NODE_SCALAR ? n->text : "", expected, error);
}

imk_status imki_value_numbers(const imk_document *document, int node, const char *si, size_t count,
                              double *values, imk_error *error)
{
    imk_status status = imki_value_require(document, node, IMKI_NODE_SCALAR,
                                           "a number and its unit, as one text", error);
    if (status != IMK_OK)
        return status;
    const imki_node *n = &document->node[node];
    status = parse_exactly(n->text, n->text + n->length, si, count, values, error);
    if (status != IMK_OK)
        place_error(document, node, error);
    return status;
}

imk_status imki_value_name(const imk_document *document, const char *key, char *text, size_t size,
                           imk_error *error)
{
    const int node = imki_document_value(document, 0, key);
    text[0] = '\0';
    if (node == IMKI_NONE)
        return IMK_OK;
    const imk_status status = imki_value_require(document, node, IMKI_NODE_SCALAR, "a text", error);
    if (status != IMK_OK)
        return status;
    const imki_node *n = &document->node[node];
    if (n->length >= size) {
        char expected[48];
        snprintf(expected, sizeof expected, "a text of at most %zu bytes", size - 1);
        return imki_document_error(document, node, IMK_ERROR_RANGE, n->text, expected, error);
    }
    memcpy(text, n->text, n->length + 1);
    return IMK_OK;
}

imk_status imki_value_keys(const imk_document *document, int mapping, size_t count,
                           const char *const *names, imk_error *error)
{
    for (int key = document->node[mapping].first; key != IMKI_NONE;
         key = document->node[document->node[key].next].next) {
        const word w = {document->node[key].text, document->node[key].length};
        if (find_word(w, count, names) < 0)
            return imki_refuse_name(document, key, count, names, error);
    }
    return IMK_OK;
}

imk_status imki_value_version(const imk_document *document, const char *key, imk_error *error)
{
    const int node = imki_document_value(document, 0, key);
    if (node == IMKI_NONE) {
        char expected[64];
        snprintf(expected, sizeof expected, "write %s: 1, the version of the format", key);
        return imki_document_error(document, 0, IMK_ERROR_KEY_MISSING, "", expected, error);
    }
    const imki_node *n = &document->node[node];
    if (n->kind != IMKI_NODE_SCALAR || strcmp(n->text, "1") != 0)
        return imki_document_error(document, node, IMK_ERROR_VERSION,
                                   n->kind == IMKI_NODE_SCALAR ? n->text : "",
                                   "version 1 of the format", error);
    return IMK_OK;
}
