/* SPDX-License-Identifier: Apache-2.0 */
/* Aids as text: words with a quantity behind each. */
#include "imukit/aid_text.h"

#include "imukit/names.h"
#include "imukit/units.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

/* ---- words ---- */

typedef enum aid_word {
    POSITION = 0, /* to ZERO: an imk_aid_kind */
    ZERO = IMK_AID_ZERO_VELOCITY,
    CORRELATED,
    LEVER,
    AT,
    EVERY,
    FROM,
    UNTIL,
    HORIZONTAL,
    ARM,
    WORDS
} aid_word;

static const char *const words[WORDS] = {
    [IMK_AID_POSITION] = "position",
    [IMK_AID_VELOCITY] = "velocity",
    [IMK_AID_HEADING] = "heading",
    [IMK_AID_HEIGHT] = "height",
    [IMK_AID_ODOMETER] = "odometer",
    [ZERO] = "zero",
    [CORRELATED] = "correlated",
    [LEVER] = "lever",
    [AT] = "at",
    [EVERY] = "every",
    [FROM] = "from",
    [UNTIL] = "until",
    [HORIZONTAL] = "horizontal",
    [ARM] = "arm",
};

static const char *const names[] = {"gnss",    "gps",     "rtk",          "barometer",
                                    "baro",    "compass", "magnetometer", "wheel",
                                    "doppler", "dvl",     "radar",        "camera"};

/* A stretch of the text without blanks and commas; empty at the end. */
typedef struct token {
    const char *begin;
    size_t length;
    bool behind_comma;
} token;

static token next_token(const char **at)
{
    token t = {.behind_comma = false};
    for (*at += strspn(*at, " \t"); **at == ','; *at += strspn(*at, " \t")) {
        t.behind_comma = true;
        (*at)++;
    }
    t.begin = *at;
    t.length = strcspn(*at, " \t,");
    *at += t.length;
    return t;
}

static bool is(const token *t, const char *name)
{
    return strlen(name) == t->length && strncasecmp(t->begin, name, t->length) == 0;
}

static int word_of(const token *t)
{
    for (int w = 0; w < WORDS; w++)
        if (is(t, words[w]))
            return w;
    return -1;
}

/* ---- messages ---- */

static imk_status refuse(imk_error *error, imk_status status, const token *t, const char *clause,
                         const char *expected)
{
    char found[90];
    snprintf(found, sizeof found, "\"%.*s\" %s", (int)(t->length < 40 ? t->length : 40), t->begin,
             clause);
    return imk_error_set(error, status, "aid", found, expected);
}

static imk_status refuse_word(imk_error *error, const token *t)
{
    char given[24], expected[160];
    snprintf(given, sizeof given, "%.*s", (int)(t->length < 20 ? t->length : 20), t->begin);
    const size_t number = imk_nearest_name(given, WORDS, words);
    const char *nearest = number < WORDS ? words[number] : NULL;
    snprintf(expected, sizeof expected, "%s%s%s",
             nearest ? "did you mean " : "write, for example, ",
             nearest ? nearest : "\"gnss position 1 m, velocity 0.05 m/s at 1 Hz until 600 s\"",
             nearest ? "?" : "");
    return refuse(error, IMK_ERROR_SYNTAX, t, "is not a word of an aid", expected);
}

/* ---- quantities ---- */

typedef struct quantity {
    double value[3], sigma[3];
    size_t count;
} quantity;

/* What stands between a word and the next word or comma. */
static imk_status read_quantity(const token *behind, const char **at, const char *unit,
                                size_t numbers, quantity *q, imk_error *error)
{
    const char *begin = behind->begin + behind->length, *end = begin;
    for (;;) {
        const char *ahead = *at;
        const token t = next_token(&ahead);
        if (t.length == 0 || t.behind_comma || word_of(&t) >= 0)
            break;
        *at = ahead;
        end = t.begin + t.length;
    }
    const imk_dimension dimension = imk_unit_of(unit).dimension;
    imk_error reason;
    const imk_status status = imk_quantity_parse(begin, end, dimension, numbers, q->value, q->sigma,
                                                 &q->count, NULL, &reason);
    if (status == IMK_OK && (q->count == 1 || q->count == numbers))
        return IMK_OK;
    char expected[160];
    snprintf(expected, sizeof expected, "%s with a unit of %s, such as %s",
             numbers > 1 ? "one number or three" : "a number", imk_dimension_name(dimension),
             imk_dimension_examples(dimension));
    const token value = {begin, (size_t)(end - begin), false};
    if (value.length == 0)
        return refuse(error, IMK_ERROR_EMPTY, behind, "has no quantity behind it", expected);
    const token trimmed = {begin + strspn(begin, " \t"),
                           (size_t)(end - begin) - strspn(begin, " \t"), false};
    return refuse(error, status == IMK_OK ? IMK_ERROR_SYNTAX : status, &trimmed,
                  "is not understood", expected);
}

/* ---- aids ---- */

typedef struct reading {
    imk_aid *aid;
    size_t count;
    double correlation[IMK_AIDS_MAX]; /* of each; 0: none of its own */
    double interval, from, until, all;
    quantity arm;
    bool has_arm, horizontal;
} reading;

/* Words that belong together: "zero velocity", "lever arm". */
static bool take_second(const char **at, const char *second)
{
    const char *ahead = *at;
    const token t = next_token(&ahead);
    if (t.behind_comma || !is(&t, second))
        return false;
    *at = ahead;
    return true;
}

static imk_status add_aid(reading *r, int kind, token t, const char **at, imk_error *error)
{
    quantity q;
    if (kind == ZERO && !take_second(at, "velocity"))
        return refuse(error, IMK_ERROR_SYNTAX, &t, "is not a word of an aid", "\"zero velocity\"");
    if (kind == ZERO)
        t = (token){*at, 0, false};
    if (r->count == IMK_AIDS_MAX)
        return refuse(error, IMK_ERROR_RANGE, &t, "is one too many", "at most 8 aids");
    imk_aid *aid = &r->aid[r->count];
    *aid = imk_aid_default((imk_aid_kind)kind);
    const size_t axes = imk_aid_axes(aid->kind);
    const imk_status status = read_quantity(&t, at, imk_aid_unit(aid->kind), axes, &q, error);
    if (status != IMK_OK)
        return status;
    for (size_t i = 0; i < axes; i++)
        if (q.count > 1 || i == 0 || kind != IMK_AID_ODOMETER)
            aid->sigma[i] = q.value[q.count > 1 ? i : 0];
    if (r->horizontal && axes > 1)
        aid->sigma[2] = (double)INFINITY;
    r->horizontal = false;
    r->correlation[r->count++] = 0.0;
    return IMK_OK;
}

static imk_status take_word(reading *r, int word, token t, const char **at, imk_error *error)
{
    quantity q;
    imk_status status = IMK_OK;
    if (word <= ZERO)
        return add_aid(r, word, t, at, error);
    if (word == HORIZONTAL) {
        r->horizontal = true;
        return IMK_OK;
    }
    if (word == ARM)
        return refuse(error, IMK_ERROR_SYNTAX, &t, "is not a word of an aid", "\"lever arm\"");
    if (word == LEVER) {
        const token behind = take_second(at, "arm") ? (token){*at, 0, false} : t;
        r->has_arm = true;
        status = read_quantity(&behind, at, "m", 3, &r->arm, error);
        if (status == IMK_OK && r->arm.count != 3)
            status = refuse(error, IMK_ERROR_SYNTAX, &t, "has one number",
                            "three numbers: along body x, y and z");
        return status;
    }
    status = read_quantity(&t, at, word == AT ? "Hz" : "s", 1, &q, error);
    if (status == IMK_OK && !(q.value[0] > 0.0 && isfinite(q.value[0])))
        status = refuse(error, IMK_ERROR_RANGE, &t, "has no positive number", "a number above 0");
    if (status != IMK_OK)
        return status;
    if (word == AT)
        r->interval = 1.0 / q.value[0];
    else if (word == EVERY)
        r->interval = q.value[0];
    else if (word == FROM)
        r->from = q.value[0];
    else if (word == UNTIL)
        r->until = q.value[0];
    else if (t.behind_comma || r->count == 0)
        r->all = q.value[0];
    else
        r->correlation[r->count - 1] = q.value[0];
    return IMK_OK;
}

/* What is said of all of them. */
static imk_status finish(reading *r, imk_error *error)
{
    for (size_t k = 0; k < r->count; k++) {
        imk_aid *aid = &r->aid[k];
        const double time = r->correlation[k] > 0.0 ? r->correlation[k] : r->all;
        aid->interval = r->interval;
        aid->from = r->from > 0.0 ? r->from : r->interval;
        aid->until = r->until;
        aid->correlation_time = time;
        for (int i = 0; i < 3; i++) {
            if (time > 0.0 && isfinite(aid->sigma[i])) {
                aid->correlated_sigma[i] = aid->sigma[i];
                aid->sigma[i] *= IMK_AID_TEXT_WHITE;
            }
            aid->lever_arm[i] = r->has_arm ? r->arm.value[i] : 0.0;
            aid->lever_arm_sigma[i] = r->has_arm ? r->arm.sigma[i] : 0.0;
        }
        const imk_status status = imk_aid_validate(aid, error);
        if (status != IMK_OK)
            return status;
    }
    return IMK_OK;
}

static bool is_name(const token *t)
{
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        if (is(t, names[i]))
            return true;
    return false;
}

imk_status imk_aid_parse(const char *text, imk_aid aid[IMK_AIDS_MAX], size_t *count,
                         imk_error *error)
{
    reading r = {.aid = aid, .interval = 1.0, .until = (double)INFINITY};
    bool first = true;
    imk_status status = IMK_OK;
    for (const char *at = text; status == IMK_OK; first = false) {
        const token t = next_token(&at);
        const int word = word_of(&t);
        if (t.length == 0)
            break;
        if (first && is_name(&t))
            continue;
        status = word >= 0 ? take_word(&r, word, t, &at, error) : refuse_word(error, &t);
    }
    if (status == IMK_OK && r.count == 0)
        status = imk_error_set(error, IMK_ERROR_EMPTY, "aid", "no quantity is named",
                               "position, velocity, height, heading, odometer or zero velocity, "
                               "such as \"gnss position 1 m at 1 Hz\"");
    if (status == IMK_OK)
        status = finish(&r, error);
    *count = status == IMK_OK ? r.count : 0;
    return status;
}
