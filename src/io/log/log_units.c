/* SPDX-License-Identifier: Apache-2.0 */
/* Units of the columns of a log. People write "Deg/Sec", "M/S2", "msec", "C": what is not known as
 * it stands, or is of another quantity, is read as the same words at the end of a name would be. A
 * unit is suggested only if the column can have it and its multiple is the one that was written. */
#include "log_columns_internal.h"

#include "base/text_internal.h"

#include <stdio.h>
#include <string.h>

static void trim(imki_log_piece *piece)
{
    while (piece->begin < piece->end && (*piece->begin == ' ' || *piece->begin == '\t'))
        piece->begin++;
    while (piece->end > piece->begin && (piece->end[-1] == ' ' || piece->end[-1] == '\t'))
        piece->end--;
}

void imki_log_piece_copy(char *target, size_t size, imki_log_piece piece)
{
    size_t length = (size_t)(piece.end - piece.begin);
    if (length >= size) {
        length = size - 1;
        while (length > 0 && ((unsigned char)piece.begin[length] & 0xC0) == 0x80)
            length--;
    }
    memcpy(target, piece.begin, length);
    target[length] = '\0';
}

/* "[0]" is an index and no unit. */
static bool is_index(imki_log_piece inside)
{
    return inside.end - inside.begin == 1 && *inside.begin >= '0' && *inside.begin <= '9';
}

/* The bracket that the one at the end closes; NULL: none. */
static const char *opening(imki_log_piece name)
{
    const char close = name.end[-1], open = close == ']' ? '[' : '(';
    size_t depth = 0;
    for (const char *p = name.end; p > name.begin;) {
        p--;
        depth += *p == close;
        if (*p == open && --depth == 0)
            return p;
    }
    return NULL;
}

void imki_log_unit_split(imki_log_piece *name, imki_log_piece *unit)
{
    trim(name);
    *unit = (imki_log_piece){name->end, name->end};
    if (name->begin == name->end || (name->end[-1] != ']' && name->end[-1] != ')'))
        return;
    const char *open = opening(*name);
    if (!open || is_index((imki_log_piece){open + 1, name->end - 1}))
        return;
    *unit = (imki_log_piece){open + 1, name->end - 1};
    name->end = open;
    trim(name);
    trim(unit);
}

imki_log_piece imki_log_unit_of_name(imki_log_piece name)
{
    char text[48];
    imki_log_piece_copy(text, sizeof text, name);
    const char *unit = imki_log_name_of(text).unit;
    return unit ? (imki_log_piece){unit, unit + strlen(unit)}
                : (imki_log_piece){name.end, name.end};
}

const char *imki_log_unit_setting(imk_quantity quantity, const imk_log_settings *settings)
{
    switch (quantity) {
    case IMK_QUANTITY_TIME:
        return settings->time_unit;
    case IMK_QUANTITY_ANGULAR_RATE:
        return settings->gyro_unit;
    case IMK_QUANTITY_SPECIFIC_FORCE:
        return settings->accel_unit;
    case IMK_QUANTITY_TEMPERATURE:
        return settings->temperature_unit;
    case IMK_QUANTITY_MAGNETIC:
    case IMK_QUANTITY_OTHER:
        break;
    }
    return NULL;
}

bool imki_log_unit_fits(const imki_log_kind *kind, const imk_unit *unit)
{
    return imk_dimension_equal(unit->dimension, imk_unit_of(kind->unit).dimension) ||
           (kind->quantity != IMK_QUANTITY_TIME &&
            imk_dimension_equal(unit->dimension, imk_unit_of("count").dimension));
}

imk_status imki_log_unit_refuse(const imki_log_kind *kind, const imk_unit *unit, const char *field,
                                imk_error *error)
{
    const imk_dimension due = imk_unit_of(kind->unit).dimension;
    char found[96], expected[160];
    snprintf(found, sizeof found, "\"%.47s\" is %.40s", unit->text,
             imk_dimension_name(unit->dimension));
    snprintf(expected, sizeof expected, "%.60s, such as %.80s", imk_dimension_name(due),
             imk_dimension_examples(due));
    return imk_error_set(error, IMK_ERROR_DIMENSION, field, found, expected);
}

/* Is it one word? "deg s" is a product, and no rate. */
static bool is_one_word(imki_log_piece text)
{
    for (const char *c = text.begin; c < text.end; c++)
        if (*c == ' ' || *c == '*')
            return false;
    return true;
}

/* The text with the part that is not known replaced by the nearest one that is, if a column of the
 * kind can have that unit: of four letters or more, and the first of them the same, since it is
 * that of the multiple. */
static bool suggest(imki_log_piece text, const imki_log_kind *kind, imk_error *why)
{
    char whole[64], other[160];
    imk_unit unit;
    imki_log_piece_copy(whole, sizeof whole, text);
    const char *place = why->found[0] ? strstr(whole, why->found) : NULL;
    if (!place || strlen(why->found) < 4 || strchr(why->expected, ' ') ||
        imki_lower(why->found[0]) != imki_lower(why->expected[0]))
        return false;
    snprintf(other, sizeof other, "%.*s%.40s%s", (int)(place - whole), whole, why->expected,
             place + strlen(why->found));
    if (imk_unit_parse(other, other + strlen(other), &unit, NULL) != IMK_OK ||
        !imki_log_unit_fits(kind, &unit))
        return false;
    snprintf(why->expected, sizeof why->expected, "%s", other);
    return true;
}

imk_status imki_log_unit_read(imki_log_piece text, const imki_log_kind *kind, imk_unit *unit,
                              imk_error *error)
{
    imk_error why = {.status = IMK_OK};
    char words[64];
    const imk_status status = imk_unit_parse(text.begin, text.end, unit, &why);
    if (status == IMK_OK && imki_log_unit_fits(kind, unit))
        return IMK_OK;
    imki_log_piece_copy(words, sizeof words, text);
    const char *same = status == IMK_ERROR_UNIT_UNKNOWN || (status == IMK_OK && is_one_word(text))
                           ? imki_log_unit_of_words(words, kind)
                           : NULL;
    if (same) {
        *unit = imk_unit_of(same);
        return IMK_OK;
    }
    if (status == IMK_ERROR_UNIT_UNKNOWN && !suggest(text, kind, &why))
        snprintf(why.expected, sizeof why.expected, "a unit such as %s",
                 kind->examples ? kind->examples : "uT, nT, gauss");
    if (status != IMK_OK && error)
        *error = why;
    return status;
}

static imk_status read_any(imki_log_piece text, const imki_log_kind *kind, imk_unit *unit)
{
    return kind ? imki_log_unit_read(text, kind, unit, NULL)
                : imk_unit_parse(text.begin, text.end, unit, NULL);
}

imk_status imki_log_units_agree(const char *field, const imki_log_kind *kind, imki_log_piece name,
                                imki_log_piece mapped, imki_log_piece own, imk_error *error)
{
    imk_unit a, b;
    char found[96], first[16], second[16];
    if (mapped.begin == mapped.end || own.begin == own.end)
        return IMK_OK;
    /* One that is not known says nothing. */
    const imk_status known = read_any(own, kind, &b);
    if (known == IMK_ERROR_UNIT_UNKNOWN || known == IMK_ERROR_SYNTAX ||
        (known == IMK_OK && read_any(mapped, kind, &a) == IMK_OK &&
         imk_dimension_equal(a.dimension, b.dimension) && a.scale == b.scale &&
         a.offset == b.offset))
        return IMK_OK;
    imki_log_piece_copy(first, sizeof first, mapped);
    imki_log_piece_copy(second, sizeof second, own);
    snprintf(found, sizeof found, "[%s] does not agree with the file, which says [%s] for %.*s",
             first, second, (int)(name.end - name.begin < 24 ? name.end - name.begin : 24),
             name.begin);
    return imk_error_set(error, IMK_ERROR_CONFLICT, field, found,
                         "leave the unit out, or correct the header if it is wrong");
}
