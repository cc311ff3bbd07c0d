/* SPDX-License-Identifier: Apache-2.0 */
/* Scales of counts as data sheets state them. */
#include "description_internal.h"

#include "base/text_internal.h"
#include "imukit/decimal.h"
#include "imukit/units.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

typedef struct piece {
    const char *begin, *end;
} piece;

/* What data sheets call one step of a digital output. */
static const char *const steps[] = {"lsb", "counts", "count", "digits", "digit"};
enum { STEPS = sizeof steps / sizeof steps[0] };

static piece trim(piece p)
{
    while (p.begin < p.end && (*p.begin == ' ' || *p.begin == '\t'))
        p.begin++;
    while (p.end > p.begin && (p.end[-1] == ' ' || p.end[-1] == '\t'))
        p.end--;
    return p;
}

static size_t length_of(piece p)
{
    return (size_t)(p.end - p.begin);
}

/* `word` in lower case. */
static bool begins_with(piece p, const char *word)
{
    const size_t length = strlen(word);
    if (length_of(p) < length)
        return false;
    for (size_t i = 0; i < length; i++)
        if (imki_lower(p.begin[i]) != word[i])
            return false;
    return true;
}

/* "LSB/(deg/s)": what stands behind the slash. */
static bool is_per_unit(piece p, piece *unit)
{
    for (size_t i = 0; i < STEPS; i++) {
        if (!begins_with(p, steps[i]))
            continue;
        const piece rest = trim((piece){p.begin + strlen(steps[i]), p.end});
        if (length_of(rest) == 0 || *rest.begin != '/')
            continue;
        *unit = trim((piece){rest.begin + 1, rest.end});
        return true;
    }
    return false;
}

/* "mg/LSB": what stands before the slash. */
static bool is_per_step(piece p, piece *unit)
{
    for (size_t i = 0; i < STEPS; i++) {
        const size_t length = strlen(steps[i]);
        if (length_of(p) <= length || !begins_with((piece){p.end - length, p.end}, steps[i]))
            continue;
        const piece rest = trim((piece){p.begin, p.end - length});
        if (length_of(rest) == 0 || rest.end[-1] != '/')
            continue;
        *unit = trim((piece){rest.begin, rest.end - 1});
        return true;
    }
    return false;
}

static bool is_step(piece p)
{
    for (size_t i = 0; i < STEPS; i++)
        if (strlen(steps[i]) == length_of(p) && begins_with(p, steps[i]))
            return true;
    return false;
}

/* The unit, of which brackets around all are taken off. */
static bool take_unit(piece p, imki_count_scale *scale, imk_unit *unit, size_t size, char *wrong)
{
    if (length_of(p) > 2 && *p.begin == '(' && p.end[-1] == ')' &&
        !memchr(p.begin + 1, '(', length_of(p) - 1))
        p = trim((piece){p.begin + 1, p.end - 1});
    if (is_step(p))
        p = (piece){steps[2], steps[2] + strlen(steps[2])};
    imk_error error;
    if (imk_unit_parse(p.begin, p.end, unit, &error) != IMK_OK) {
        if (length_of(p) == 0)
            snprintf(wrong, size, "a number has no unit");
        else
            snprintf(wrong, size, "\"%.24s\" is no unit", error.found);
        return false;
    }
    snprintf(scale->unit, sizeof scale->unit, "%.*s", (int)length_of(p), p.begin);
    return true;
}

/* A number that a scale can be. */
static bool take_number(piece *p, double *value, size_t size, char *wrong)
{
    const char *behind = imk_decimal_parse(p->begin, p->end, value);
    if (behind == p->begin)
        return false;
    if (!isfinite(*value)) {
        snprintf(wrong, size, "a number is not finite");
        return false;
    }
    *p = trim((piece){behind, p->end});
    return true;
}

static bool take_offset(piece p, const imk_unit *due, imki_count_scale *scale, size_t size,
                        char *wrong)
{
    imki_count_scale stated;
    imk_unit unit;
    if (!take_number(&p, &scale->offset, size, wrong)) {
        if (wrong[0] == '\0')
            snprintf(wrong, size, "no number follows \"offset\"");
        return false;
    }
    if (!take_unit(p, &stated, &unit, size, wrong))
        return false;
    if (!imk_dimension_equal(unit.dimension, due->dimension) || unit.scale != due->scale ||
        unit.offset != due->offset) {
        snprintf(wrong, size, "the offset is in %.16s, not in %.16s", stated.unit, scale->unit);
        return false;
    }
    return true;
}

/* The place of the word "offset"; the end when there is none. */
static const char *find_offset(piece p)
{
    for (const char *at = p.begin; at < p.end; at++)
        if ((at == p.begin || at[-1] == ' ' || at[-1] == '\t') &&
            begins_with((piece){at, p.end}, "offset"))
            return at;
    return p.end;
}

bool imki_count_scale_read(const char *begin, const char *end, imki_count_scale *scale, size_t size,
                           char *wrong)
{
    const piece whole = trim((piece){begin, end});
    const char *offset = find_offset(whole);
    piece p = trim((piece){whole.begin, offset}), unit_text;
    imk_unit unit;
    double number = 1.0;
    *scale = (imki_count_scale){.divisor = 1.0, .factor = 1.0};
    wrong[0] = '\0';
    if (length_of(whole) == 0)
        return true;
    const bool stated = take_number(&p, &number, size, wrong);
    if (wrong[0] != '\0')
        return false;
    if (stated && number == 0.0) {
        snprintf(wrong, size, "a scale of 0 leaves nothing");
        return false;
    }
    if (is_per_unit(p, &unit_text)) {
        scale->divisor = number;
    } else if (is_per_step(p, &unit_text)) {
        scale->factor = number;
    } else {
        unit_text = p;
        scale->factor = number;
    }
    if (!stated && unit_text.begin != p.begin) {
        snprintf(wrong, size, "no number is before \"%.24s\"", p.begin);
        return false;
    }
    return take_unit(unit_text, scale, &unit, size, wrong) &&
           (offset == whole.end || take_offset(trim((piece){offset + strlen("offset"), whole.end}),
                                               &unit, scale, size, wrong));
}
