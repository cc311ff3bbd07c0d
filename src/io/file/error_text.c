/* SPDX-License-Identifier: Apache-2.0 */
/* The message for an error:
 *
 *     source:line:column: field, axis x: finding; remedy
 *
 * Finding: with some statuses, error.found is what stood in the text and becomes the subject of a
 * clause (`"0.1 deg" has the wrong dimension`), unless the author wrote the whole clause, which
 * then begins with the quotation (`"0.1 deg/h" is a rate`). With the others it is a reason behind
 * the text of the status (`the file cannot be opened: Permission denied`), or a clause of its own
 * (`gnuplot is not installed`). Without error.found, the numbers of the error are used.
 *
 * Remedy: error.expected as it is when it says what to do (`add --rate 100Hz`), after "expected"
 * when it says what is due (`a positive number`), as a question when it is one word that may have
 * been meant. */
#include "imukit/decimal.h"
#include "imukit/io.h"
#include "imukit/utf8.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

/* ------------------------------------------------------------------------- text of limited size */

typedef struct message {
    char *text;
    size_t size, length;
    bool full; /* something did not fit; nothing is added after it */
} message;

/* Add text. What a terminal could take for a command, and bytes that are no text, become "?". */
static void add(message *s, const char *text)
{
    while (*text != '\0') {
        size_t length = imk_utf8_printable(text);
        const char *character = length > 0 ? text : "?";
        text += length > 0 ? length : 1;
        length = length > 0 ? length : 1;
        s->full = s->full || s->length + length >= s->size;
        if (s->full)
            return;
        memcpy(s->text + s->length, character, length);
        s->length += length;
    }
}

/* ------------------------------------------------------------------------------------- numbers */

static void add_count(message *s, size_t count)
{
    char text[24];
    size_t at = sizeof text;
    text[--at] = '\0';
    do
        text[--at] = (char)('0' + count % 10);
    while ((count /= 10) > 0);
    add(s, text + at);
}

/* Six digits are enough to read, unless the other number looks the same then. */
static void add_number(message *s, double number, double other)
{
    char text[IMK_DECIMAL_SIZE], other_text[IMK_DECIMAL_SIZE];
    imk_decimal_significant(number, 6, text);
    imk_decimal_significant(other, 6, other_text);
    if (number != other && strcmp(text, other_text) == 0)
        imk_decimal_shortest(number, text);
    add(s, text);
}

/* ------------------------------------------------------------------------------------- finding */

/* How error.found is worded. */
typedef struct wording {
    imk_status status;
    const char *quoted;  /* behind the quotation of what stood there */
    const char *numbers; /* behind error.value; the limit follows */
    const char *limit;   /* in front of error.limit */
} wording;

static const wording wordings[] = {
    {IMK_ERROR_NOT_FINITE, "is not finite", "is not finite", NULL},
    {IMK_ERROR_RANGE, "is outside its valid range", "is outside its valid range", "limit "},
    {IMK_ERROR_SYNTAX, "cannot be read", NULL, NULL},
    {IMK_ERROR_UNIT_MISSING, "has no unit", "has no unit", NULL},
    {IMK_ERROR_UNIT_UNKNOWN, "is not a known unit", NULL, NULL},
    {IMK_ERROR_DIMENSION, "has the wrong dimension", NULL, NULL},
    {IMK_ERROR_KEY_UNKNOWN, "is not a known key", NULL, NULL},
    {IMK_ERROR_KEY_DUPLICATE, "is given twice", NULL, NULL},
    {IMK_ERROR_KEY_MISSING, "is missing", NULL, NULL},
    {IMK_ERROR_VERSION, "is not a supported version", "is not a supported version", NULL},
    {IMK_ERROR_WORKSPACE, NULL, "bytes of workspace are too few", "needed: "},
    {IMK_ERROR_TOO_SHORT, NULL, "samples are too few", "needed: "},
    {IMK_ERROR_NAME_UNKNOWN, "is not a known name", NULL, NULL},
};

static const wording *wording_of(imk_status status)
{
    static const wording none = {IMK_OK, NULL, NULL, NULL};
    for (size_t i = 0; i < sizeof wordings / sizeof wordings[0]; i++)
        if (wordings[i].status == status)
            return &wordings[i];
    return &none;
}

/* Does a reason have its own verb, so that it stands alone? */
static bool is_clause(const char *text)
{
    static const char *const verbs[] = {
        " is ",    " are ",   " was ",    " has ",  " have ",  " does ",  " do ",      " cannot ",
        " failed", " follow", " exclude", " must ", " needs ", " stands", " contains", " holds "};
    for (size_t i = 0; i < sizeof verbs / sizeof verbs[0]; i++)
        if (strstr(text, verbs[i]))
            return true;
    return false;
}

static void add_found(message *s, const imk_error *error, const wording *w)
{
    const bool sentence = error->status == IMK_ERROR_NAME_UNKNOWN && is_clause(error->found);
    if (w->quoted && error->found[0] != '"' && !sentence) {
        add(s, "\"");
        add(s, error->found);
        add(s, "\" ");
        add(s, w->quoted);
        return;
    }
    if (!w->quoted && !is_clause(error->found)) {
        add(s, imk_status_text(error->status));
        add(s, ": ");
    }
    add(s, error->found);
}

/* `3 is outside its valid range (limit 2)`; a limit of 0 may be none, and error.expected says. */
static void add_numbers(message *s, const imk_error *error, const wording *w)
{
    add_number(s, error->value, error->limit);
    add(s, " ");
    add(s, w->numbers);
    if (!w->limit || error->limit == 0.0 || !isfinite(error->limit))
        return;
    add(s, " (");
    add(s, w->limit);
    add_number(s, error->limit, error->value);
    add(s, ")");
}

static void add_finding(message *s, const imk_error *error)
{
    const wording *w = wording_of(error->status);
    const bool numbers = error->value != 0.0 || error->limit != 0.0; /* also when not a number */
    if (error->found[0] != '\0') {
        add_found(s, error, w);
    } else if (numbers && w->numbers) {
        add_numbers(s, error, w);
    } else {
        add(s, imk_status_text(error->status));
        if (numbers && isfinite(error->value)) {
            add(s, " (");
            add_number(s, error->value, error->limit);
            if (error->limit != 0.0 && isfinite(error->limit)) {
                add(s, ", limit ");
                add_number(s, error->limit, error->value);
            }
            add(s, ")");
        }
    }
}

/* -------------------------------------------------------------------------------------- remedy */

static bool begins_with(const char *text, const char *beginning)
{
    return strncmp(text, beginning, strlen(beginning)) == 0;
}

/* Does it say what is due ("a positive number", "0 to 8 terms") and not what to do? */
static bool is_noun(const char *text)
{
    static const char *const beginnings[] = {"a ",     "an ",      "one ",    "two ",
                                             "three ", "at least", "at most", "more than",
                                             "fewer ", "between ", "a, ",     "\""};
    for (size_t i = 0; i < sizeof beginnings / sizeof beginnings[0]; i++)
        if (begins_with(text, beginnings[i]))
            return true;
    return text[0] >= '0' && text[0] <= '9';
}

static void add_remedy(message *s, const imk_error *error)
{
    const char *expected = error->expected;
    const bool unknown = error->status == IMK_ERROR_UNIT_UNKNOWN ||
                         error->status == IMK_ERROR_KEY_UNKNOWN ||
                         error->status == IMK_ERROR_NAME_UNKNOWN;
    if (expected[0] == '\0')
        return;
    add(s, "; ");
    if (unknown && !strchr(expected, ' ')) {
        add(s, "did you mean ");
        add(s, expected);
        add(s, "?");
        return;
    }
    if (is_noun(expected))
        add(s, "expected ");
    add(s, expected);
}

/* --------------------------------------------------------------------------------------- place */

/* `source:line:column: `, or `line 7, column 3: ` without a source. */
static void add_place(message *s, const imk_error *error, const char *source)
{
    if (!source && error->line == 0)
        return;
    if (source)
        add(s, strcmp(source, "-") == 0 ? "standard input" : source);
    if (error->line > 0) {
        add(s, source ? ":" : "line ");
        add_count(s, error->line);
        if (error->column > 0) {
            add(s, source ? ":" : ", column ");
            add_count(s, error->column);
        }
    }
    add(s, ": ");
}

/* The field of a file's error is the file; it is not said twice. */
static bool is_source(const imk_error *error, const char *source)
{
    if (!source)
        return false;
    if (strcmp(source, "-") == 0)
        return strcmp(error->field, "standard input") == 0;
    char shortened[sizeof error->field];
    imk_utf8_shorten(source, shortened, sizeof shortened);
    return strcmp(shortened, error->field) == 0;
}

/* `gyro.bias.fixed, axis x: `, `time, row 17: `, `gyro.noise.gauss_markov[2]: `. */
static void add_field(message *s, const imk_error *error, const char *source)
{
    const char *field = is_source(error, source) ? "" : error->field;
    const bool triad = begins_with(field, "gyro") || begins_with(field, "accel");
    add(s, field);
    if (error->index >= 0) {
        const char *comma = field[0] ? ", " : "";
        if (triad && error->index < 3) {
            add(s, ", axis ");
            add(s, error->index == 0 ? "x" : error->index == 1 ? "y" : "z");
        } else if (error->status == IMK_ERROR_TIME_ORDER || error->status == IMK_ERROR_GAP) {
            add(s, comma);
            add(s, "row ");
            add_count(s, (size_t)error->index);
        } else {
            add(s, field[0] ? "[" : "element ");
            add_count(s, (size_t)error->index);
            add(s, field[0] ? "]" : "");
        }
    }
    if (field[0] || error->index >= 0)
        add(s, ": ");
}

size_t imk_error_text(const imk_error *error, const char *source, char *text, size_t size)
{
    if (size == 0)
        return 0;
    message s = {text, size, 0, false};
    add_place(&s, error, source);
    add_field(&s, error, source);
    add_finding(&s, error);
    add_remedy(&s, error);
    text[s.length] = '\0';
    return s.length;
}
