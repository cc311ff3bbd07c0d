/* SPDX-License-Identifier: Apache-2.0 */
/* Reading a unit:
 *
 *     unit     = factor { ("*" | "·" | "/" | blank) factor }, from left to right: a/b/c = a/(b c)
 *     factor   = primary [exponent] | "1"
 *     primary  = name | "(" unit ")" | root (name | "(" unit ")")
 *     root     = "√" | "sqrt" | "rt-" | "rt" | "root-"
 *     exponent = "^" number | "^(" number ")" | "²" | "³" | "½" | "⁻¹" | "⁻²" | "2" | "3"
 *     number   = [sign] (digits ["." digits] | digits "/2" | "½")
 *
 * A blank multiplies, but not behind a "/": a/b c has been read both ways. */
#include "imukit/units.h"

#include "unit_table_internal.h"

#include <math.h>
#include <string.h>

enum { BRACKETS_MAX = 8, HALF_EXPONENT_MAX = 60 };

/* A product on its way. `hertz_halves` is the exponent of Hz in it, in halves: odd means that a
 * root of Hz was written. */
typedef struct product {
    double scale;
    double offset;
    int half[IMKI_DIMENSIONS];
    int hertz_halves;
} product;

typedef struct reader {
    const char *at, *end;
    int brackets;
    imk_error *error;
    const char *whole; /* start of the text, for messages */
} reader;

static bool read_product(reader *r, product *result);

const char *imki_match(const char *at, const char *end, const char *text)
{
    const size_t length = strlen(text);
    return (size_t)(end - at) >= length && memcmp(at, text, length) == 0 ? at + length : NULL;
}

/* Step over one of the texts when it stands here. */
static bool take(reader *r, const char *text)
{
    const char *next = imki_match(r->at, r->end, text);
    if (next)
        r->at = next;
    return next != NULL;
}

static void fail(reader *r, imk_status status, const char *begin, const char *end,
                 const char *expected)
{
    char found[2 * sizeof r->error->found]; /* imk_error_set() shortens it between characters */
    size_t length = (size_t)(end - begin);
    if (length >= sizeof found)
        length = sizeof found - 1;
    memcpy(found, begin, length);
    found[length] = '\0';
    (void)imk_error_set(r->error, status, "", found, expected);
}

static bool fail_syntax(reader *r, const char *expected)
{
    fail(r, IMK_ERROR_SYNTAX, r->whole, r->end, expected);
    return false;
}

/* result *= factor^(halves/2). Negative powers divide, so that h^-1 has the bits of /h. */
static bool multiply(reader *r, product *result, const product *factor, int halves)
{
    const int size = halves < 0 ? -halves : halves;
    double power = 1.0;
    for (int i = 0; i < size / 2; i++)
        power *= factor->scale;
    if (size % 2 == 1)
        power *= sqrt(factor->scale);
    result->scale = halves < 0 ? result->scale / power : result->scale * power;
    result->offset = 0.0; /* only a temperature by itself has its zero shifted */
    result->hertz_halves += factor->hertz_halves * halves / 2;
    for (int i = 0; i < IMKI_DIMENSIONS; i++) {
        const int change = factor->half[i] * halves;
        result->half[i] += change / 2;
        if (change % 2 != 0 || result->half[i] > HALF_EXPONENT_MAX ||
            result->half[i] < -HALF_EXPONENT_MAX)
            return fail_syntax(r, "a unit whose exponents are multiples of one half");
    }
    if (!isfinite(result->scale) || !(result->scale > 0.0))
        return fail_syntax(r, "a unit of a size that a number can hold");
    return true;
}

static const product one = {.scale = 1.0};

static bool is_digit(const reader *r)
{
    return r->at < r->end && *r->at >= '0' && *r->at <= '9';
}

/* A number of an exponent, in halves. */
static bool read_halves(reader *r, int *halves)
{
    const char *expected = "an exponent such as 2, -1, 0.5 or 1/2";
    const int sign = take(r, "-") || take(r, "−") ? -1 : 1;
    (void)(sign == 1 && take(r, "+"));
    if (take(r, "½")) {
        *halves = sign;
        return true;
    }
    int whole = 0;
    if (!is_digit(r))
        return fail_syntax(r, expected);
    for (; is_digit(r); r->at++) {
        whole = 10 * whole + (*r->at - '0');
        if (whole > HALF_EXPONENT_MAX)
            return fail_syntax(r, expected);
    }
    const char *fraction = imki_match(r->at, r->end, "/2");
    *halves = 2 * sign * whole;
    if (fraction && whole % 2 == 1 && (fraction == r->end || *fraction < '0' || *fraction > '9')) {
        r->at = fraction;
        *halves = sign * whole;
    } else if (take(r, ".")) {
        if (!is_digit(r))
            return fail_syntax(r, expected);
        const bool half = *r->at == '5';
        if (*r->at != '0' && *r->at != '5')
            return fail_syntax(r, expected);
        for (r->at++; is_digit(r); r->at++) {
            if (*r->at != '0')
                return fail_syntax(r, expected);
        }
        *halves += half ? sign : 0;
    }
    return true;
}

/* The exponent behind a factor, in halves; 2 (that is, 1) when there is none. */
static bool read_exponent(reader *r, int *halves)
{
    static const struct {
        const char *text;
        int halves;
    } superscripts[] = {{"²", 4}, {"³", 6}, {"½", 1},   {"⁻¹", -2}, {"⁻²", -4}, {"⁻³", -6},
                        {"2", 4}, {"3", 6}, {"-1", -2}, {"-2", -4}, {"-3", -6}};
    *halves = 2;
    if (take(r, "^") || take(r, "**")) {
        const bool bracket = take(r, "(");
        if (!read_halves(r, halves))
            return false;
        return !bracket || take(r, ")") || fail_syntax(r, "a closing bracket");
    }
    for (size_t i = 0; i < sizeof superscripts / sizeof superscripts[0]; i++) {
        if (take(r, superscripts[i].text)) {
            *halves = superscripts[i].halves;
            break;
        }
    }
    return true;
}

/* Bytes of the character here when it belongs to a name, else 0. */
static size_t name_character(const reader *r)
{
    static const char *const others[] = {"√", "·", "⋅", "×", "²", "³", "½", "⁻", "¹", "±", "−"};
    const unsigned char c = (unsigned char)*r->at;
    if ((c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '%' || c == '_')
        return 1;
    if (c == '-' && r->at + 1 < r->end) {
        const char next = r->at[1];
        return (next >= 'A' && next <= 'Z') || (next >= 'a' && next <= 'z');
    }
    if (c < 0x80)
        return 0;
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
        if (imki_match(r->at, r->end, others[i]))
            return 0;
    }
    size_t length = 1;
    while (r->at + length < r->end && ((unsigned char)r->at[length] & 0xC0) == 0x80)
        length++;
    return length;
}

/* Read a name, with µ (both code points) as u and degree signs as deg; both signs also as the
 * single bytes that editors of Windows write. */
static bool read_name(reader *r, char name[IMKI_UNIT_NAME_SIZE])
{
    static const char *const spellings[][2] = {
        {"µ", "u"},      {"μ", "u"},   {"°", "deg"}, {"º", "deg"},  {"℃", "degC"},  {"″", "arcsec"},
        {"′", "arcmin"}, {"Ω", "ohm"}, {"Ω", "ohm"}, {"\xb5", "u"}, {"\xb0", "deg"}};
    size_t length = 0;
    for (size_t bytes; r->at < r->end && (bytes = name_character(r)) > 0; r->at += bytes) {
        const char *source = r->at;
        size_t count = bytes;
        for (size_t i = 0; i < sizeof spellings / sizeof spellings[0]; i++) {
            if (imki_match(r->at, r->end, spellings[i][0])) {
                source = spellings[i][1];
                count = strlen(source);
            }
        }
        if (length + count >= IMKI_UNIT_NAME_SIZE)
            return false;
        memcpy(name + length, source, count);
        length += count;
    }
    name[length] = '\0';
    return length > 0;
}

/* A name, or a name behind a spelled-out root. */
static bool read_named(reader *r, product *result, bool *rooted)
{
    static const char *const roots[] = {"sqrt-", "sqrt", "rt-", "rt", "root-", "root"};
    char name[IMKI_UNIT_NAME_SIZE];
    const char *begin = r->at;
    const bool read = read_name(r, name);
    const imki_named_unit *unit = read ? imki_unit_find(name) : NULL;
    *rooted = false;
    for (size_t i = 0; read && !unit && i < sizeof roots / sizeof roots[0]; i++) {
        const char *rest = imki_match(name, name + strlen(name), roots[i]);
        unit = rest ? imki_unit_find(rest) : NULL;
        *rooted = unit != NULL;
    }
    if (!unit && r->at == begin)
        return fail_syntax(r, "a unit such as deg/h, deg/sqrt(h) or m/s^2");
    if (!unit) {
        const char *nearest = read ? imki_unit_nearest(name) : NULL;
        fail(r, IMK_ERROR_UNIT_UNKNOWN, begin, r->at,
             nearest ? nearest : "a unit such as deg/h, mg or s");
        return false;
    }
    *result = (product){
        .scale = unit->scale, .offset = unit->offset, .hertz_halves = unit->is_hertz ? 2 : 0};
    for (int i = 0; i < IMKI_DIMENSIONS; i++)
        result->half[i] = unit->dimension.half[i];
    return true;
}

static bool read_primary(reader *r, product *result)
{
    bool rooted = take(r, "√");
    if (!rooted && r->at < r->end) {
        const char *next = imki_match(r->at, r->end, "sqrt");
        next = next ? imki_skip_blanks(next, r->end) : NULL;
        rooted = next && next < r->end && *next == '(';
        r->at = rooted ? next : r->at;
    }
    r->at = imki_skip_blanks(r->at, r->end);
    product inner = one;
    bool rooted_by_name = false;
    if (take(r, "(")) {
        if (++r->brackets > BRACKETS_MAX)
            return fail_syntax(r, "fewer brackets");
        if (!read_product(r, &inner))
            return false;
        if (!take(r, ")"))
            return fail_syntax(r, "a closing bracket");
        r->brackets--;
    } else if (r->at < r->end && *r->at == '1' && !rooted) {
        r->at++;
        /* Only by itself or as a numerator: "1 Hz" is a quantity. */
        const char *next = imki_skip_blanks(r->at, r->end);
        if (next < r->end && *next != '/' && *next != ')')
            return fail_syntax(r, "a unit without a number");
    } else if (!read_named(r, &inner, &rooted_by_name)) {
        return false;
    }
    *result = inner;
    if (rooted || rooted_by_name) {
        *result = one;
        return multiply(r, result, &inner, 1);
    }
    return true;
}

static bool read_factor(reader *r, product *result)
{
    product base;
    int halves;
    if (!read_primary(r, &base) || !read_exponent(r, &halves))
        return false;
    if (halves == 2) {
        *result = base;
        return true;
    }
    *result = one;
    return multiply(r, result, &base, halves);
}

static bool read_product(reader *r, product *result)
{
    bool divided = false;
    r->at = imki_skip_blanks(r->at, r->end);
    if (!read_factor(r, result))
        return false;
    for (;;) {
        const char *before = r->at;
        r->at = imki_skip_blanks(r->at, r->end);
        if (r->at == r->end || *r->at == ')')
            return true;
        const bool divide = take(r, "/") || take(r, "⁄");
        const bool times =
            !divide && (take(r, "*") || take(r, "·") || take(r, "⋅") || take(r, "×"));
        if (!divide && !times && (before == r->at || divided))
            return fail_syntax(r, divided ? "write brackets, or a / before each divisor"
                                          : "one of * / ^ between units");
        divided = divided || divide;
        r->at = imki_skip_blanks(r->at, r->end);
        product factor;
        if (!read_factor(r, &factor) || !multiply(r, result, &factor, divide ? -2 : 2))
            return false;
    }
}

/* The text of a unit; the single bytes that read_name() takes become UTF-8. */
static void put_text(const char *begin, const char *end, size_t size, char *text)
{
    size_t length = 0;
    for (const char *at = begin; at < end && length + 1 < size; at++) {
        const bool is_sign = *at == '\xb0' || *at == '\xb5';
        const bool is_alone = at == begin || ((unsigned char)at[-1] & 0x80) == 0;
        if (is_sign && is_alone && length + 2 < size)
            text[length++] = '\xc2';
        text[length++] = *at;
    }
}

imk_status imk_unit_parse(const char *begin, const char *end, imk_unit *unit, imk_error *error)
{
    imk_error own;
    begin = imki_skip_blanks(begin, end);
    while (end > begin && (end[-1] == ' ' || end[-1] == '\t'))
        end--;
    reader r = {.at = begin, .end = end, .error = error ? error : &own, .whole = begin};
    product result;
    if (begin == end)
        return imk_error_set(error, IMK_ERROR_UNIT_MISSING, "", "", "a unit");
    if ((size_t)(end - begin) >= sizeof unit->text) {
        (void)fail_syntax(&r, "a unit of at most 47 bytes");
        return r.error->status;
    }
    if (!read_product(&r, &result))
        return r.error->status;
    if (r.at != end) { /* a bracket closed that was never opened */
        (void)fail_syntax(&r, "an opening bracket for each closing bracket");
        return r.error->status;
    }
    imk_unit parsed = {.scale = result.scale,
                       .offset = result.offset,
                       .per_root_hertz = result.hertz_halves % 2 != 0};
    for (int i = 0; i < IMKI_DIMENSIONS; i++)
        parsed.dimension.half[i] = (int8_t)result.half[i];
    put_text(begin, end, sizeof parsed.text, parsed.text);
    *unit = parsed;
    return IMK_OK;
}

imk_unit imk_unit_of(const char *text)
{
    imk_unit unit = {.scale = 0.0};
    (void)imk_unit_parse(text, text + strlen(text), &unit, NULL);
    return unit;
}
