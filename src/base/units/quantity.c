/* SPDX-License-Identifier: Apache-2.0 */
/* Reading a quantity of the model file: numbers, ± and their 1-sigma values, and a unit. */
#include "imukit/units.h"

#include "base/text_internal.h"
#include "imukit/decimal.h"
#include "unit_table_internal.h"

#include <math.h>
#include <string.h>

typedef struct source {
    const char *begin, *end; /* the whole text without blanks around it */
    imk_error *error;
} source;

/* Error about the whole text: `"0.1 deg/h" <clause>`; without the numbers when it is long. */
static imk_status refuse(const source *s, imk_status status, const char *begin, const char *clause,
                         const char *expected)
{
    char found[sizeof s->error->found];
    size_t used = 0;
    const size_t room = sizeof found - strlen(clause) - 4;
    size_t length = (size_t)(s->end - begin);
    found[used++] = '"';
    if (length > room) {
        for (length = room - 3; length > 0 && ((unsigned char)begin[length] & 0xC0) == 0x80;)
            length--;
    }
    memcpy(found + used, begin, length);
    used += length;
    if (length < (size_t)(s->end - begin)) {
        memcpy(found + used, "…", sizeof "…" - 1);
        used += sizeof "…" - 1;
    }
    found[used++] = '"';
    found[used++] = ' ';
    memcpy(found + used, clause, strlen(clause) + 1);
    return imk_error_set(s->error, status, "", found, expected);
}

/* Text to compose in an imk_error, cut where it ends. */
static void append_examples(imk_error *text, const char *before, imk_dimension dimension)
{
    imki_append_text(text->expected, sizeof text->expected, before);
    imki_append_text(text->expected, sizeof text->expected, imk_dimension_examples(dimension));
}

static imk_status refuse_dimension(const source *s, const char *unit_begin, imk_dimension found,
                                   imk_dimension expected)
{
    imk_error text;
    char si[IMKI_SI_TEXT_SIZE];
    (void)imk_error_set(&text, IMK_ERROR_DIMENSION, "", "is ", imk_dimension_name(expected));
    if (imki_dimension_known(found)) {
        imki_append_text(text.found, sizeof text.found, imk_dimension_name(found));
    } else {
        imki_unit_si_text(found, false, si);
        imki_append_text(text.found, sizeof text.found, "in ");
        imki_append_text(text.found, sizeof text.found, si);
    }
    append_examples(&text, " like ", expected);
    /* The unit alone is to blame when the numbers take too much room. */
    const size_t room = sizeof text.found - strlen(text.found) - 4;
    const bool fits = (size_t)(s->end - s->begin) <= room;
    return refuse(s, IMK_ERROR_DIMENSION, fits ? s->begin : unit_begin, text.found, text.expected);
}

static imk_status refuse_without_unit(const source *s, imk_dimension expected)
{
    imk_error text;
    (void)imk_error_set(&text, IMK_ERROR_UNIT_MISSING, "", "", "");
    append_examples(&text, "a unit such as ", expected);
    return refuse(s, IMK_ERROR_UNIT_MISSING, s->begin, "has no unit", text.expected);
}

static const char *match_plus_minus(const char *at, const char *end)
{
    static const char *const spellings[] = {"±", "+/-", "+-"};
    for (size_t i = 0; i < sizeof spellings / sizeof spellings[0]; i++) {
        const char *next = imki_match(at, end, spellings[i]);
        if (next)
            return next;
    }
    return NULL;
}

/* A "1" that is no number but the unit or its numerator, as in "0.5 1" and "3 1/s". It needs a
 * number before it, and behind it the end or a division. */
static bool is_unit_one(const char *at, const char *end)
{
    const char *next = imki_skip_blanks(at + 1, end);
    return *at == '1' && (next == end || *next == '/');
}

static bool is_letter(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

/* A number as imk_decimal_parse() reads it, but no beginning of a longer word: the unit nanogram is
 * no nan. */
static const char *read_number(const char *at, const char *end, double *number)
{
    const char *next = imk_decimal_parse(at, end, number);
    return next > at && is_letter(next[-1]) && next < end && is_letter(*next) ? at : next;
}

/* Numbers from `at` to the first thing that is none. @return where that is */
static const char *read_numbers(const char *at, const char *end, size_t max_count, double *numbers,
                                size_t *count, bool *too_many)
{
    size_t read = 0;
    *too_many = false;
    for (;;) {
        at = imki_skip_blanks(at, end);
        if (at == end || match_plus_minus(at, end) || (read > 0 && is_unit_one(at, end)))
            break;
        double number;
        const char *next = read_number(at, end, &number);
        if (next == at)
            break;
        if (read == max_count) {
            *too_many = true;
            break;
        }
        numbers[read++] = number;
        at = next;
    }
    *count = read;
    return at;
}

/* Make SI values; sigmas have no offset. */
static imk_status convert(const source *s, const imk_unit *unit, size_t count, double *values,
                          size_t sigma_count, double *sigmas)
{
    for (size_t i = 0; i < count; i++) {
        values[i] *= unit->scale;
        if (unit->offset != 0.0) /* adding 0 would lose the sign of -0 */
            values[i] += unit->offset;
        if (!isfinite(values[i]))
            return refuse(s, IMK_ERROR_NOT_FINITE, s->begin, "is not finite", "a finite number");
    }
    for (size_t i = 0; i < sigma_count; i++) {
        sigmas[i] = sigmas[i] * unit->scale + 0.0; /* -0 is 0 */
        if (!isfinite(sigmas[i]))
            return refuse(s, IMK_ERROR_NOT_FINITE, s->begin, "is not finite", "a finite number");
        if (!(sigmas[i] >= 0.0))
            return refuse(s, IMK_ERROR_RANGE, s->begin, "has a negative uncertainty",
                          "a 1-sigma value of 0 or more behind ±");
    }
    return IMK_OK;
}

/* With the dimension known, better examples than imk_unit_parse() could give. */
static imk_status refuse_unit(imk_status status, imk_dimension expected, imk_error *error)
{
    if (error && status == IMK_ERROR_UNIT_UNKNOWN && strchr(error->expected, ' ')) {
        error->expected[0] = '\0';
        append_examples(error, "a unit such as ", expected);
    }
    return status;
}

enum { NUMBERS_MAX = 64 };

static imk_status refuse_too_many(const source *s, size_t max_count)
{
    return refuse(s, IMK_ERROR_SYNTAX, s->begin, "has too many numbers",
                  max_count == 1 ? "one number and a unit"
                                 : "one number, or one for each element, and a unit");
}

imk_status imk_quantity_parse(const char *begin, const char *end, imk_dimension expected,
                              size_t max_count, double *values, double *sigmas, size_t *count,
                              imk_unit *unit, imk_error *error)
{
    double numbers[NUMBERS_MAX], uncertainties[NUMBERS_MAX];
    size_t number_count = 0, sigma_count = 0;
    bool too_many;
    begin = imki_skip_blanks(begin, end);
    while (end > begin && (end[-1] == ' ' || end[-1] == '\t'))
        end--;
    const source s = {begin, end, error};
    if (max_count == 0 || max_count > NUMBERS_MAX)
        return imk_error_set(error, IMK_ERROR_ARGUMENT, "max_count", "", "1 to 64");
    if (begin == end)
        return imk_error_set(error, IMK_ERROR_EMPTY, "", "", "a number and its unit");
    const char *at = read_numbers(begin, end, max_count, numbers, &number_count, &too_many);
    if (too_many)
        return refuse_too_many(&s, max_count);
    if (number_count == 0)
        return refuse(&s, IMK_ERROR_SYNTAX, begin, "does not start with a number",
                      "a number and its unit");
    const char *sigma_begin = match_plus_minus(at, end);
    if (sigma_begin) {
        at = read_numbers(sigma_begin, end, max_count, uncertainties, &sigma_count, &too_many);
        if (too_many || (sigma_count != 1 && sigma_count != number_count))
            return refuse(&s, IMK_ERROR_SYNTAX, begin, "has no 1-sigma value for each number",
                          "one 1-sigma value behind ±, or as many as numbers before it");
    }
    if (at == end)
        return refuse_without_unit(&s, expected);
    imk_unit found;
    imk_status status = imk_unit_parse(at, end, &found, error);
    if (status != IMK_OK)
        return refuse_unit(status, expected, error);
    if (!imk_dimension_equal(found.dimension, expected)) {
        /* "0 0 1" is three numbers where a rate is due, not two of unit 1. */
        if (strcmp(found.text, "1") == 0)
            return refuse_without_unit(&s, expected);
        return refuse_dimension(&s, at, found.dimension, expected);
    }
    status = convert(&s, &found, number_count, numbers, sigma_count, uncertainties);
    if (status != IMK_OK)
        return status;
    for (size_t i = 0; i < number_count; i++) {
        values[i] = numbers[i];
        sigmas[i] = sigma_count == 0 ? 0.0 : sigma_count == 1 ? uncertainties[0] : uncertainties[i];
    }
    *count = number_count;
    if (unit)
        *unit = found;
    return IMK_OK;
}
