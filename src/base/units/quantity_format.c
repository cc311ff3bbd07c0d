/* SPDX-License-Identifier: Apache-2.0 */
/* Writing a quantity so that it reads back to the same doubles. The reader computes
 *
 *     value = x * scale + offset
 *
 * for the decimal x; here x near (value - offset)/scale is searched for which this gives `value`
 * itself. Where the scale's mantissa is large there may be none: then SI units are used. */
#include "imukit/units.h"

#include "imukit/decimal.h"
#include "unit_table_internal.h"

#include <math.h>
#include <string.h>

/* Neighbours tried on each side: the quotient is off by the roundings of a division and two
 * operations, each half an ulp of numbers of nearly the same size. */
enum { NEIGHBOURS = 3 };

/* With an offset (degC) many x give the same value: the one of fewest digits near the difference.
 */
static size_t shortest_with_offset(double value, double scale, double offset, char *text)
{
    const double x = (value - offset) / scale;
    for (int digits = 1; digits <= 17; digits++) {
        double rounded = 0.0;
        const size_t length = imk_decimal_significant(x, digits, text);
        (void)imk_decimal_parse(text, text + length, &rounded);
        if (rounded * scale + offset == value)
            return imk_decimal_shortest(rounded, text);
    }
    return 0;
}

/* The shortest decimal that reads back to `value`; length 0 when there is none. */
static size_t shortest_in_unit(double value, double scale, char *text)
{
    char trial[IMK_DECIMAL_SIZE];
    size_t best = 0;
    double x = value / scale;
    if (value == 0.0) /* its neighbours would also give it */
        return imk_decimal_shortest(value, text);
    for (int i = 0; i < NEIGHBOURS; i++)
        x = nextafter(x, -(double)INFINITY);
    for (int i = -NEIGHBOURS; i <= NEIGHBOURS; i++, x = nextafter(x, (double)INFINITY)) {
        const double back = x * scale;
        if (back != value || signbit(back) != signbit(value) || !isfinite(x))
            continue;
        const size_t length = imk_decimal_shortest(x, trial);
        if (best == 0 || length < best) {
            memcpy(text, trial, length + 1);
            best = length;
        }
    }
    return best;
}

typedef struct writer {
    char *text;
    size_t size, length;
    bool full;
} writer;

static void put(writer *w, const char *text)
{
    const size_t length = strlen(text);
    if (w->full || w->length + length >= w->size) {
        w->full = true;
        return;
    }
    memcpy(w->text + w->length, text, length + 1);
    w->length += length;
}

/* Numbers with blanks between; false when one cannot be written in this unit. */
static bool put_numbers(writer *w, const double *numbers, size_t count, double scale, double offset)
{
    char text[IMK_DECIMAL_SIZE];
    for (size_t i = 0; i < count; i++) {
        if (!isfinite(numbers[i]) && scale == 1.0)
            (void)imk_decimal_shortest(numbers[i], text);
        else if ((offset != 0.0 ? shortest_with_offset(numbers[i], scale, offset, text)
                                : shortest_in_unit(numbers[i], scale, text)) == 0)
            return false;
        put(w, i > 0 ? " " : "");
        put(w, text);
    }
    return true;
}

static bool put_quantity(writer *w, const double *values, const double *sigmas, size_t count,
                         double scale, double offset, const char *unit)
{
    bool stated = false, equal = true;
    for (size_t i = 0; sigmas && i < count; i++) {
        stated = stated || sigmas[i] != 0.0;
        equal = equal && sigmas[i] == sigmas[0];
    }
    if (!put_numbers(w, values, count, scale, offset))
        return false;
    if (stated) {
        put(w, " ± ");
        if (!put_numbers(w, sigmas, equal ? 1 : count, scale, 0.0))
            return false;
    }
    put(w, " ");
    put(w, unit);
    return true;
}

size_t imk_quantity_format(const double *values, const double *sigmas, size_t count,
                           const imk_unit *unit, char *text, size_t text_size)
{
    writer w = {.text = text, .size = text_size};
    if (text_size == 0 || count == 0)
        return 0;
    if (!put_quantity(&w, values, sigmas, count, unit->scale, unit->offset, unit->text)) {
        char si[IMKI_SI_TEXT_SIZE];
        imki_unit_si_text(unit->dimension, unit->per_root_hertz, si);
        w = (writer){.text = text, .size = text_size};
        (void)put_quantity(&w, values, sigmas, count, 1.0, 0.0, si);
    }
    return w.full ? 0 : w.length;
}
