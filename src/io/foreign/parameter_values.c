/* SPDX-License-Identifier: Apache-2.0 */
/* Numbers of foreign parameter files: is the value possible in the unit the format has, and if not,
 * which unit does it look like? And the text and notes that go out. */
#include "parameter_internal.h"

#include "imukit/names.h"
#include "imukit/units.h"

#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- text ------------------------------------------------------------------------------------ */

imki_decimal imki_shortest(double value)
{
    imki_decimal number;
    imk_decimal_shortest(value == 0 ? 0 : value, number.text);
    return number;
}

void imki_text_numbers(imki_text *text, const double *values, int count, const char *separator)
{
    for (int i = 0; i < count; i++)
        imki_text_add(text, "%s%s", i > 0 ? separator : "", imki_shortest(values[i]).text);
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

void imki_parameter_refuse(imki_parameters *p, imk_status status, const char *field,
                           const char *found, const char *expected)
{
    if (p->status == IMK_OK)
        p->status = imk_error_set(p->error, status, field, found, expected);
}

void imki_choice_add(const imki_parameters *p, imki_choice *choice, const char *name, int chosen)
{
    const size_t length = strlen(choice->names);
    snprintf(choice->names + length, sizeof choice->names - length, "%s%.30s",
             choice->count++ > 0 ? ", " : "", name);
    if (!p->settings->sensor || strcmp(p->settings->sensor, name) == 0) {
        choice->chosen = chosen;
        choice->found++;
    }
}

void imki_choice_end(imki_parameters *p, int found, const char *names, const char *placeholder,
                     const char *several)
{
    const char *wanted = p->settings->sensor;
    char missing[80], expected[140];
    if (found == 1)
        return;
    snprintf(missing, sizeof missing, "\"sensor\" is missing: %s", several);
    snprintf(expected, sizeof expected, "add --sensor %s with one of %s", placeholder, names);
    imki_parameter_refuse(p, wanted ? IMK_ERROR_NAME_UNKNOWN : IMK_ERROR_KEY_MISSING, "sensor",
                          wanted ? wanted : missing, expected);
}

/* Room for six digits of a number with sign and exponent. */
enum { NUMBER_SIZE = 25 };

/* ---- plausible values ------------------------------------------------------------------------ */

void imki_parameter_refuse_at(imki_parameters *p, imki_place place, imk_status status,
                              const char *found, const char *expected)
{
    const bool first = p->status == IMK_OK;
    imki_parameter_refuse(p, status, place.field, found, expected);
    if (first && p->error) {
        p->error->line = place.line;
        p->error->column = place.column;
    }
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

static void refuse_value(imki_parameters *p, imki_place place, int kind, imki_quantity quantity,
                         double raw, imki_unit unit)
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
                 "this format uses %.24s: write %s, or correct the value if it is wrong", unit.name,
                 right);
    } else {
        snprintf(found, sizeof found, "\"%s\" cannot be in %.24s", number, unit.name);
        imk_decimal_significant(limits[quantity][kind].minimum / unit.scale, 3, number);
        imk_decimal_significant(limits[quantity][kind].maximum / unit.scale, 3, right);
        snprintf(expected, sizeof expected, "a value between %s and %s, or 0", number, right);
    }
    const bool first = p->status == IMK_OK;
    imki_parameter_refuse_at(p, place, IMK_ERROR_RANGE, found, expected);
    if (first && p->error) {
        p->error->value = raw;
        p->error->limit = limits[quantity][kind].maximum / unit.scale;
    }
}

void imki_accept(imki_parameters *p, imki_place place, int kind, imki_quantity quantity,
                 const double raw[3], imki_unit unit, double si[3])
{
    for (int i = 0; i < 3; i++) {
        char number[NUMBER_SIZE];
        imk_decimal_significant(raw[i], 6, number);
        const double value = raw[i] * unit.scale;
        const bool signless = quantity != IMKI_BIAS && quantity != IMKI_PLAIN;
        /* An infinite time is for the format to assess. */
        if (!(fabs(raw[i]) <= DBL_MAX) && !(quantity == IMKI_TIME && raw[i] > 0))
            imki_parameter_refuse_at(p, place, IMK_ERROR_NOT_FINITE, number, "a finite number");
        else if (signless && raw[i] < 0)
            imki_parameter_refuse_at(p, place, IMK_ERROR_RANGE, number,
                                     "a number that is not negative");
        else if (quantity < IMKI_TIME && raw[i] != 0 &&
                 !(fabs(value) >= limits[quantity][kind].minimum &&
                   fabs(value) <= limits[quantity][kind].maximum))
            refuse_value(p, place, kind, quantity, raw[i], unit);
        else
            si[i] = value;
    }
}

bool imki_any(const double values[3])
{
    return values[0] != 0 || values[1] != 0 || values[2] != 0;
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

/* ---- lines ----------------------------------------------------------------------------------- */

void imki_each_line(imki_parameters *p, imki_line_function *take, void *context)
{
    const char *end = p->text + p->size;
    size_t number = 1;
    for (const char *line = p->text; line < end && p->status == IMK_OK; number++) {
        const char *line_end = memchr(line, '\n', (size_t)(end - line));
        if (!line_end)
            line_end = end;
        take(p, context, line, line_end, number);
        line = line_end < end ? line_end + 1 : end;
    }
}

/* The next word of a line. */
static const char *next_word(const char *at, const char *end, const char *separators,
                             const char **word_end)
{
    while (at < end && *at && strchr(separators, *at))
        at++;
    const char *stop = at;
    while (stop < end && !(*stop && strchr(separators, *stop)))
        stop++;
    *word_end = stop;
    return at;
}

static void take_assignment(imki_parameters *p, void *context, const char *line, const char *end,
                            size_t number)
{
    const imki_assignments *a = context;
    char name[32], found[32];
    const char *stop, *word = next_word(line, end, a->separators, &stop);
    for (int i = 0; i < a->numbers && stop > word && *word >= '0' && *word <= '9'; i++)
        word = next_word(stop, end, a->separators, &stop);
    if (stop == word || *word == '#' || stop - word >= (ptrdiff_t)sizeof name)
        return;
    snprintf(name, sizeof name, "%.*s", (int)(stop - word), word);
    double *target = a->target_of(a->context, name, number);
    word = next_word(stop, end, a->separators, &stop);
    if (!target || (imki_number(word, stop, target) && isfinite(*target)))
        return;
    snprintf(found, sizeof found, "%.*s", (int)(stop - word > 30 ? 30 : stop - word), word);
    imki_parameter_refuse_at(p, (imki_place){name, number, (size_t)(word - line) + 1},
                             IMK_ERROR_SYNTAX, found, "a finite number");
}

void imki_read_assignments(imki_parameters *p, imki_assignments *assignments)
{
    imki_each_line(p, take_assignment, assignments);
}
