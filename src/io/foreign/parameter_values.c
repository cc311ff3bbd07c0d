/* SPDX-License-Identifier: Apache-2.0 */
/* Numbers of foreign parameter files: is the value possible in the unit the format has, and if not,
 * which unit does it look like? And the text and notes that go out. */
#include "model/model_schema_internal.h"
#include "parameter_internal.h"

#include "imukit/decimal.h"
#include "imukit/names.h"
#include "imukit/units.h"

#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- text ------------------------------------------------------------------------------------ */

void imki_text_numbers(imki_text *text, const double *values, int count, const char *separator)
{
    for (int i = 0; i < count; i++) {
        char number[IMK_DECIMAL_SIZE];
        /* Negative zero is of no use to anyone. */
        imk_decimal_shortest(values[i] == 0 ? 0 : values[i], number);
        imki_text_add(text, "%s%s", i > 0 ? separator : "", number);
    }
}

void imki_text_vector(imki_text *text, const double values[3])
{
    imki_text_add(text, "[");
    imki_text_numbers(text, values, 3, ", ");
    imki_text_add(text, "]");
}

void imki_text_matrix(imki_text *text, const char *indent, double matrix[3][3])
{
    for (int i = 0; i < 3; i++) {
        imki_text_add(text, "%s- ", indent);
        imki_text_vector(text, matrix[i]);
        imki_text_add(text, "\n");
    }
}

void imki_note(imki_parameters *p, bool lost, const char *format, ...)
{
    imk_parameter_notes *notes = p->notes;
    struct imk_parameter_note note = {.lost = lost};
    if (!notes)
        return;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(note.text, sizeof note.text, format, arguments);
    va_end(arguments);
    for (size_t i = 0; i < notes->count; i++)
        if (strcmp(notes->note[i].text, note.text) == 0)
            return;
    if (notes->count == IMK_PARAMETER_NOTES_MAX) {
        struct imk_parameter_note *last = &notes->note[IMK_PARAMETER_NOTES_MAX - 1];
        last->lost = last->lost || lost;
        snprintf(last->text, sizeof last->text, "there are more notes than can be kept");
        return;
    }
    notes->note[notes->count++] = note;
}

/* Room for six digits of a number with sign and exponent. */
enum { NUMBER_SIZE = 25 };

/* ---- plausible values ------------------------------------------------------------------------ */

imk_status imki_place_error(imki_parameters *p, imki_place place, imk_status status,
                            const char *found, const char *expected)
{
    imk_error_set(p->error, status, place.field, found, expected);
    if (p->error) {
        p->error->line = place.line;
        p->error->column = place.column;
    }
    return status;
}

/* Limits in SI, for what is not zero. They lie far outside what any instrument has (a gyro of
 * 0.1 rad/s/sqrt(Hz) shows 60 deg/s of noise at 100 Hz; a strategic one has 3e-8), so that the
 * inflated figures of filter settings pass; `usual` is where a value in the right unit lies, and
 * picks the unit it looks like. docs/other-formats.md has the table. */
static const struct limits {
    double minimum, maximum, usual_minimum, usual_maximum;
} limits[4][2] = {
    [IMKI_WHITE] = {{1e-11, 0.1, 1e-8, 5e-3}, {1e-9, 5, 1e-6, 0.05}},
    [IMKI_RANDOM_WALK] = {{1e-16, 0.1, 1e-12, 1e-3}, {1e-13, 2, 1e-10, 0.02}},
    [IMKI_BIAS] = {{0, 3.5, 0, 0.6}, {0, 30, 0, 3}},
    [IMKI_DRIFT] = {{0, 0.5, 0, 0.05}, {0, 5, 0, 0.5}},
};

/* Units in which such numbers are also written, the nearest to SI first. */
static const char *const other_units[4][2][6] = {
    [IMKI_WHITE] = {{"rad/s/sqrt(Hz)", "deg/s/sqrt(Hz)", "deg/sqrt(h)", "deg/h/sqrt(Hz)"},
                    {"m/s^2/sqrt(Hz)", "m/s/sqrt(h)", "mg/sqrt(Hz)", "ug/sqrt(Hz)"}},
    [IMKI_RANDOM_WALK] = {{"rad/s^2/sqrt(Hz)", "deg/s/sqrt(s)", "deg/s/sqrt(h)", "deg/h/sqrt(h)"},
                          {"m/s^3/sqrt(Hz)", "mg/sqrt(s)", "mg/sqrt(h)", "ug/sqrt(h)"}},
    [IMKI_BIAS] = {{"rad/s", "deg/s", "deg/h"}, {"m/s^2", "mg", "ug"}},
    [IMKI_DRIFT] = {{"rad/s", "deg/s", "deg/h"}, {"m/s^2", "mg", "ug"}},
};

/* The unit in which the number would be usual; NULL when there is none. */
static const char *unit_it_looks_like(int kind, imki_quantity quantity, double raw, imki_unit unit,
                                      double *scale)
{
    const struct limits *l = &limits[quantity][kind];
    for (int i = 0; i < 6 && other_units[quantity][kind][i]; i++) {
        const char *name = other_units[quantity][kind][i];
        *scale = imk_unit_of(name).scale;
        double si = fabs(raw) * *scale;
        bool same = *scale < 3 * unit.scale && unit.scale < 3 * *scale;
        if (!same && si >= l->usual_minimum && si <= l->usual_maximum)
            return name;
    }
    return NULL;
}

static imk_status refuse_value(imki_parameters *p, imki_place place, int kind,
                               imki_quantity quantity, double raw, imki_unit unit)
{
    char number[NUMBER_SIZE], right[NUMBER_SIZE], found[96], expected[160];
    double scale;
    imk_decimal_significant(raw, 6, number);
    const char *name = unit_it_looks_like(kind, quantity, raw, unit, &scale);
    if (name) {
        imk_decimal_significant(raw * scale / unit.scale, 6, right);
        snprintf(found, sizeof found, "\"%s\" cannot be in %.24s, it looks like %s", number,
                 unit.name, name);
        snprintf(expected, sizeof expected,
                 "this format has %.24s: write %s, or correct the value if it is wrong", unit.name,
                 right);
    } else {
        snprintf(found, sizeof found, "\"%s\" cannot be in %.24s", number, unit.name);
        imk_decimal_significant(limits[quantity][kind].minimum / unit.scale, 3, number);
        imk_decimal_significant(limits[quantity][kind].maximum / unit.scale, 3, right);
        snprintf(expected, sizeof expected, "a value between %s and %s, or 0", number, right);
    }
    imki_place_error(p, place, IMK_ERROR_RANGE, found, expected);
    if (p->error) {
        p->error->value = raw;
        p->error->limit = limits[quantity][kind].maximum / unit.scale;
    }
    return IMK_ERROR_RANGE;
}

imk_status imki_accept(imki_parameters *p, imki_place place, int kind, imki_quantity quantity,
                       const double raw[3], imki_unit unit, double si[3])
{
    for (int i = 0; i < 3; i++) {
        char number[NUMBER_SIZE];
        imk_decimal_significant(raw[i], 6, number);
        /* An infinite time is for the format to judge. */
        if (!(fabs(raw[i]) <= DBL_MAX) && !(quantity == IMKI_TIME && raw[i] > 0))
            return imki_place_error(p, place, IMK_ERROR_NOT_FINITE, number, "a finite number");
        bool signless = quantity != IMKI_BIAS && quantity != IMKI_PLAIN;
        if (signless && raw[i] < 0)
            return imki_place_error(p, place, IMK_ERROR_RANGE, number,
                                    "a number that is not negative");
        double value = raw[i] * unit.scale;
        if (quantity < IMKI_TIME && raw[i] != 0 &&
            !(fabs(value) >= limits[quantity][kind].minimum &&
              fabs(value) <= limits[quantity][kind].maximum))
            return refuse_value(p, place, kind, quantity, raw[i], unit);
        si[i] = value;
    }
    return IMK_OK;
}

bool imki_number(const char *begin, const char *end, double *value)
{
    while (begin < end && (*begin == ' ' || *begin == '\t' || *begin == '\r' || *begin == '\n'))
        begin++;
    while (end > begin && (end[-1] == ' ' || end[-1] == '\t' || end[-1] == '\r' || end[-1] == '\n'))
        end--;
    /* YAML writes an infinity with a point. */
    const char *digits = begin < end && (*begin == '+' || *begin == '-') ? begin + 1 : begin;
    if (end - digits == 4 && digits[0] == '.' && (digits[1] == 'i' || digits[1] == 'I')) {
        if (digits[2] != 'n' && digits[2] != 'N')
            return false;
        *value = *begin == '-' ? -INFINITY : INFINITY;
        return true;
    }
    return begin < end && imk_decimal_parse(begin, end, value) == end;
}

/* ---- nodes ----------------------------------------------------------------------------------- */

/* OpenCV's own YAML 1.0 begins with a line that is none to YAML 1.1, and marks its matrices. Both
 * become blanks, so that lines and columns stay. */
static void blank_opencv(char *text, size_t size)
{
    static const char tag[] = "!!opencv-matrix";
    if (size < 5 || memcmp(text, "%YAML", 5) != 0)
        return;
    for (size_t i = 0; i < size && text[i] != '\n'; i++)
        text[i] = ' ';
    for (char *at = strstr(text, tag); at; at = strstr(at, tag))
        memset(at, ' ', sizeof tag - 1);
}

imk_status imki_parameters_document(imki_parameters *p, imk_document **document)
{
    char *copy = malloc(p->size + 1);
    if (!copy)
        return imk_error_set(p->error, IMK_ERROR_MEMORY, "", "", "");
    memcpy(copy, p->text, p->size);
    copy[p->size] = '\0';
    blank_opencv(copy, p->size);
    imk_status status = imki_document_parse(copy, p->size, document, p->error);
    free(copy);
    return status;
}

imki_place imki_node_place(const imk_document *document, int node)
{
    const imki_node *n = &document->node[node];
    const char *field = n->key != IMKI_NONE ? document->node[n->key].text : n->text ? n->text : "";
    return (imki_place){field, n->line, n->column};
}

const char *imki_node_text(const imk_document *document, int node)
{
    bool is_scalar = node != IMKI_NONE && document->node[node].kind == IMKI_NODE_SCALAR;
    return is_scalar ? document->node[node].text : "";
}

static imk_status node_number(imki_parameters *p, const imk_document *document, int node,
                              double *value)
{
    const imki_node *n = &document->node[node];
    if (n->kind == IMKI_NODE_SCALAR && imki_number(n->text, n->text + n->length, value))
        return IMK_OK;
    return imki_document_error(document, node, IMK_ERROR_SYNTAX, imki_node_text(document, node),
                               "a number without a unit", p->error);
}

imk_status imki_node_numbers(imki_parameters *p, const imk_document *document, int node, int count,
                             double *values)
{
    const imki_node *n = &document->node[node];
    imk_status status = IMK_OK;
    if (n->kind == IMKI_NODE_SEQUENCE && n->count == count) {
        for (int i = 0, child = n->first; i < count && status == IMK_OK; i++) {
            status = node_number(p, document, child, &values[i]);
            child = document->node[child].next;
        }
        return status;
    }
    if (n->kind != IMKI_NODE_SCALAR) {
        char expected[64];
        snprintf(expected, sizeof expected, "a number, or a list of %d: [1, 2, 3]", count);
        return imki_document_error(document, node, IMK_ERROR_SYNTAX, "", expected, p->error);
    }
    status = node_number(p, document, node, &values[0]);
    for (int i = 1; i < count && status == IMK_OK; i++)
        values[i] = values[0];
    return status;
}

imk_status imki_node_matrix(imki_parameters *p, const imk_document *document, int node,
                            double matrix[3][3])
{
    const imki_node *n = &document->node[node];
    if (n->kind != IMKI_NODE_SEQUENCE || n->count != 3)
        return imki_document_error(document, node, IMK_ERROR_SYNTAX, "", "a list of three rows",
                                   p->error);
    imk_status status = IMK_OK;
    for (int i = 0, row = n->first; i < 3 && status == IMK_OK; i++) {
        if (document->node[row].kind != IMKI_NODE_SEQUENCE || document->node[row].count != 3)
            return imki_document_error(document, row, IMK_ERROR_SYNTAX, "",
                                       "a row of three numbers: [1, 0, 0]", p->error);
        double numbers[3] = {0};
        status = imki_node_numbers(p, document, row, 3, numbers);
        for (int j = 0; j < 3 && status == IMK_OK; j++) {
            matrix[i][j] = numbers[j];
            if (!(fabs(numbers[j]) <= 1e6))
                status = imki_document_error(document, row, IMK_ERROR_RANGE, "",
                                             "numbers of at most a million", p->error);
        }
        row = document->node[row].next;
    }
    return status;
}

imk_status imki_node_accept(imki_parameters *p, const imk_document *document, int mapping,
                            const char *key, int kind, imki_quantity quantity, imki_unit unit,
                            double si[3])
{
    int node = imki_document_value(document, mapping, key);
    double raw[3];
    if (node == IMKI_NONE)
        return IMK_OK;
    imk_status status = imki_node_numbers(p, document, node, 3, raw);
    return status == IMK_OK
               ? imki_accept(p, imki_node_place(document, node), kind, quantity, raw, unit, si)
               : status;
}

imk_status imki_foreign_key(imki_parameters *p, const imk_document *document, int key, size_t count,
                            const char *const *known)
{
    const char *name = document->node[key].text;
    size_t nearest = imk_nearest_name(name, count, known);
    if (nearest < count) {
        char expected[96];
        snprintf(expected, sizeof expected, "did you mean \"%.64s\"?", known[nearest]);
        return imki_document_error(document, key, IMK_ERROR_KEY_UNKNOWN, name, expected, p->error);
    }
    imki_note(p, true, "the key %.80s (line %zu) is not read", name, document->node[key].line);
    return IMK_OK;
}
