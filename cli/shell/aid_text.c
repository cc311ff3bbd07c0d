/* SPDX-License-Identifier: Apache-2.0 */
/* Aids of a navigator as texts: "position 1 1 2 m, velocity 0.05 m/s". */
#include "aid_text.h"

#include <ctype.h>
#include <math.h>
#include <string.h>

#define EXAMPLE "such as \"position 1 m, velocity 0.05 m/s\""

static const struct {
    const char *word;
    imk_aid_kind kind;
} words[] = {{"position", IMK_AID_POSITION}, {"velocity", IMK_AID_VELOCITY},
             {"heading", IMK_AID_HEADING},   {"height", IMK_AID_HEIGHT},
             {"odometer", IMK_AID_ODOMETER}, {"speed", IMK_AID_ODOMETER}};

/* A piece of a text, without blanks around it. */
typedef struct piece {
    const char *begin, *end;
} piece;

static piece trim(const char *begin, const char *end)
{
    while (begin < end && isspace((unsigned char)*begin))
        begin++;
    while (end > begin && isspace((unsigned char)end[-1]))
        end--;
    return (piece){begin, end};
}

static bool take_word(piece *p, const char *word)
{
    const size_t length = strlen(word);
    if ((size_t)(p->end - p->begin) < length || strncmp(p->begin, word, length) != 0 ||
        (p->begin + length < p->end && !isspace((unsigned char)p->begin[length])))
        return false;
    *p = trim(p->begin + length, p->end);
    return true;
}

/* Where a word stands in a piece, blanks around it; the end if it does not. */
static const char *find_word(piece p, const char *word)
{
    for (const char *at = p.begin; at < p.end; at++) {
        piece rest = {at, p.end};
        if ((at == p.begin || isspace((unsigned char)at[-1])) && take_word(&rest, word))
            return at;
    }
    return p.end;
}

static bool read_quantity(piece p, const char *unit, size_t most, double *values, size_t *count)
{
    double sigmas[3];
    imk_error error;
    if (imk_quantity_parse(p.begin, p.end, imk_unit_of(unit).dimension, most, values, sigmas, count,
                           NULL, &error) != IMK_OK)
        return false;
    for (size_t i = 0; i < *count; i++)
        if (!(values[i] > 0.0) || sigmas[i] > 0.0)
            return false;
    return true;
}

/* One number for all axes; two: for the horizontal and the vertical, or for the way ahead and the
 * others. */
static void spread(imk_aid_kind kind, size_t count, double v[3])
{
    if (imk_aid_axes(kind) == 1)
        return;
    if (count == 1)
        v[1] = v[2] = kind == IMK_AID_ODOMETER ? (double)INFINITY : v[0];
    if (count == 2 && kind == IMK_AID_ODOMETER)
        v[2] = v[1];
    if (count == 2 && kind != IMK_AID_ODOMETER) {
        v[2] = v[1];
        v[1] = v[0];
    }
}

/* "correlated 2 m over 60 s" */
static bool read_correlation(piece p, imk_aid *aid)
{
    if (p.begin == p.end)
        return true;
    size_t count;
    const char *unit = imk_aid_unit(aid->kind);
    const char *over = find_word(p, "over");
    piece size = trim(p.begin, over), time = trim(over, p.end);
    if (!take_word(&size, "correlated") || !take_word(&time, "over") ||
        !read_quantity(size, unit, imk_aid_axes(aid->kind), aid->correlated_sigma, &count) ||
        !read_quantity(time, "s", 1, &aid->correlation_time, &(size_t){0}))
        return false;
    spread(aid->kind, count, aid->correlated_sigma);
    for (int i = 0; i < 3; i++)
        if (isinf(aid->correlated_sigma[i]))
            aid->correlated_sigma[i] = 0.0;
    return true;
}

static bool read_item(piece p, imk_aid *aid)
{
    for (size_t k = 0; k < sizeof words / sizeof *words; k++) {
        if (!take_word(&p, words[k].word))
            continue;
        *aid = imk_aid_default(words[k].kind);
        const char *correlated = find_word(p, "correlated");
        size_t count = 0;
        if (!read_quantity(trim(p.begin, correlated), imk_aid_unit(aid->kind),
                           imk_aid_axes(aid->kind), aid->sigma, &count) ||
            !read_correlation(trim(correlated, p.end), aid))
            return false;
        spread(aid->kind, count, aid->sigma);
        return true;
    }
    return false;
}

int aid_text_parse(const char *name, const char *text, size_t *aid_count, imk_aid *aids)
{
    const char *at = text;
    for (bool more = true; more;) {
        const size_t length = strcspn(at, ",");
        imk_aid aid;
        if (!read_item(trim(at, at + length), &aid))
            return command_misused(
                "--%s \"%s\": \"%.*s\" is not position, velocity, heading, height or "
                "odometer "
                "with its 1 sigma, " EXAMPLE
                "; one number is for all axes, three are for north, east and down, and for an "
                "odometer forward, sideways and down; \"correlated 2 m over 60 s\" "
                "may follow",
                name, text, (int)length, at);
        for (size_t k = 0; k < *aid_count; k++)
            if (aids[k].kind == aid.kind)
                return command_misused("--%s \"%s\": the %s is stated twice", name, text,
                                       imk_aid_kind_name(aid.kind));
        aids[(*aid_count)++] = aid;
        more = at[length] == ',';
        at += length + more;
    }
    return -1;
}

int aid_arm_parse(const char *name, const char *text, double arm[3], double *sigma)
{
    double sigmas[3] = {0};
    size_t count = 0;
    imk_error error;
    if (imk_quantity_parse(text, text + strlen(text), imk_unit_of("m").dimension, 3, arm, sigmas,
                           &count, NULL, &error) != IMK_OK ||
        count != 3)
        return command_misused("--%s \"%s\": expected three lengths, forward, right and down from "
                               "the unit, such as \"0.2 -0.5 -1.1 m\"%s",
                               name, text, sigma ? ", with their 1 sigma after +- if known" : "");
    for (int i = 0; i < 3; i++) {
        if (!(fabs(arm[i]) <= 1e6))
            return command_misused("--%s \"%s\": not a length on a vehicle", name, text);
        if (sigma)
            sigma[i] = sigmas[i];
        else if (sigmas[i] > 0.0)
            return command_misused("--%s \"%s\" takes no uncertainty; leave out its +-", name,
                                   text);
    }
    return -1;
}
