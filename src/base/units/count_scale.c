/* SPDX-License-Identifier: Apache-2.0 */
/* What a count of a digital sensor is, as data sheets write it: counts per unit or units per
 * count. */
#include "imukit/units.h"

#include "base/text_internal.h"
#include "imukit/decimal.h"
#include "unit_table_internal.h"

#include <math.h>
#include <string.h>

typedef struct written {
    char text[96]; /* the whole text, shortened */
    imk_dimension quantity;
    imk_error *error;
} written;

/* What is expected of the usual quantities; others are named by their SI units. */
static void describe_expected(imk_dimension quantity, char *text, size_t size)
{
    static const struct {
        const char *unit, *text;
    } usual[] = {
        {"rad/s", "a number of counts per angular rate like 16.4 LSB/(deg/s), or an angular rate "
                  "per count like 8.75 mdps/LSB"},
        {"m/s^2", "a number of counts per acceleration like 2048 LSB/g, or an acceleration per "
                  "count like 0.061 mg/LSB"},
        {"K", "a number of counts per kelvin like 132.48 LSB/degC, or kelvins per count like 0.125 "
              "K/LSB"},
    };
    text[0] = '\0';
    for (size_t i = 0; i < sizeof usual / sizeof usual[0]; i++)
        if (imk_dimension_equal(quantity, imk_unit_of(usual[i].unit).dimension)) {
            imki_append_text(text, size, usual[i].text);
            return;
        }
    char si[IMKI_SI_TEXT_SIZE];
    imki_unit_si_text(quantity, false, si);
    imki_append_text(text, size, "a number with a unit of LSB/(");
    imki_append_text(text, size, si);
    imki_append_text(text, size, ") or the reverse");
}

static imk_status refuse(const written *w, imk_status status, const char *clause)
{
    char found[sizeof w->error->found], expected[sizeof w->error->expected];
    /* Two quotes, a blank and the end; of a long clause the text is cut to what tells it apart. */
    const size_t taken = strlen(clause) + 4, least = 24;
    const size_t room = taken + least < sizeof found ? sizeof found - taken : least;
    found[0] = '\0';
    imki_append_text(found, sizeof found, "\"");
    imki_append_text(found, room + 2, w->text);
    imki_append_text(found, sizeof found, "\" ");
    imki_append_text(found, sizeof found, clause);
    describe_expected(w->quantity, expected, sizeof expected);
    return imk_error_set(w->error, status, "", found, expected);
}

static imk_status refuse_dimension(const written *w, imk_dimension found)
{
    char clause[sizeof w->error->found] = "is ", si[IMKI_SI_TEXT_SIZE];
    imki_unit_si_text(found, false, si);
    if (!imki_dimension_known(found))
        imki_append_text(clause, sizeof clause, "in ");
    imki_append_text(clause, sizeof clause,
                     imki_dimension_known(found) ? imk_dimension_name(found) : si);
    return refuse(w, IMK_ERROR_DIMENSION, clause);
}

/* Counts to the power `count` of the quantity to the power `power`. */
static bool has_dimension(imk_dimension found, imk_dimension quantity, int count, int power)
{
    for (int i = 0; i < IMKI_DIMENSIONS; i++)
        if (found.half[i] != power * quantity.half[i] + (i == IMK_COUNT ? 2 * count : 0))
            return false;
    return true;
}

imk_status imk_count_scale_parse(const char *begin, const char *end, imk_dimension quantity,
                                 double *per_count, imk_error *error)
{
    imk_error own;
    written w = {.quantity = quantity, .error = error ? error : &own};
    double number;
    imk_unit unit;
    begin = imki_skip_blanks(begin, end);
    while (end > begin && (end[-1] == ' ' || end[-1] == '\t'))
        end--;
    char whole[2 * sizeof w.text] = ""; /* imki_copy_text() shortens it between characters */
    size_t length = (size_t)(end - begin);
    if (length >= sizeof whole)
        length = sizeof whole - 1;
    memcpy(whole, begin, length);
    whole[length] = '\0';
    imki_copy_text(w.text, sizeof w.text, whole);
    const char *at = imk_decimal_parse(begin, end, &number);
    if (at == begin)
        return refuse(&w, IMK_ERROR_SYNTAX, "does not start with a number");
    if (!(number > 0) || !isfinite(number))
        return refuse(&w, IMK_ERROR_RANGE, "is not above 0");
    at = imki_skip_blanks(at, end);
    if (at == end)
        return refuse(&w, IMK_ERROR_UNIT_MISSING, "has no unit");
    const imk_status status = imk_unit_parse(at, end, &unit, w.error);
    if (status != IMK_OK)
        return status;
    double value = number * unit.scale;
    if (has_dimension(unit.dimension, quantity, 1, -1))
        value = 1 / value;
    else if (!has_dimension(unit.dimension, quantity, -1, 1))
        return refuse_dimension(&w, unit.dimension);
    if (!(value > 0) || !isfinite(value))
        return refuse(&w, IMK_ERROR_RANGE, "is beyond what a number can hold");
    *per_count = value;
    return IMK_OK;
}
