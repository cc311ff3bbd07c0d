/* SPDX-License-Identifier: Apache-2.0 */
/* The little of MATLAB's expressions that parameter files need:
 *
 *     expression = term {(+ | -) term}          term = factor {(* | / | .* | ./) factor}
 *     factor = [+ | -] (number | name | ones(1,3) | zeros(1,3) | sqrt(…) | (…) | [a b c])
 *
 * A value is one number or a row of three; one number joins a row element by element. The products
 * of matrices that MATLAB would form do not occur. In brackets a blank separates, unless the sign
 * behind it has a blank too: [3 -2] is two numbers, [3 - 2] one. */
#include "parameter_internal.h"

#include "imukit/decimal.h"

#include <math.h>
#include <string.h>

enum { DEPTH_MAX = 32 };

typedef struct value {
    int length;
    double x[3];
} value;

typedef struct reader {
    const char *at, *end;
    const imki_variables *variables;
    int depth;
    bool in_brackets;
} reader;

static bool read_expression(reader *r, value *result);

static void skip_blanks(reader *r)
{
    while (r->at < r->end && (*r->at == ' ' || *r->at == '\t'))
        r->at++;
}

static bool take(reader *r, const char *text)
{
    size_t length = strlen(text);
    if ((size_t)(r->end - r->at) < length || memcmp(r->at, text, length) != 0)
        return false;
    r->at += length;
    return true;
}

static value constant(double x, int length)
{
    return (value){length, {x, x, x}};
}

static bool combine(value *a, const value *b, char operation)
{
    int length = a->length > b->length ? a->length : b->length;
    for (int i = 0; i < 3; i++) {
        double x = a->x[i], y = b->x[i];
        a->x[i] = operation == '+'   ? x + y
                  : operation == '-' ? x - y
                  : operation == '*' ? x * y
                                     : x / y;
    }
    a->length = length;
    return true;
}

/* (expression), with the outer rules about blanks restored behind it. */
static bool read_parentheses(reader *r, value *result)
{
    bool outer = r->in_brackets;
    r->in_brackets = false;
    skip_blanks(r);
    bool good = take(r, "(") && read_expression(r, result);
    skip_blanks(r);
    good = good && take(r, ")");
    r->in_brackets = outer;
    return good;
}

static bool read_bracket(reader *r, value *result)
{
    bool outer = r->in_brackets;
    result->length = 0;
    r->in_brackets = true;
    for (;;) {
        value element;
        skip_blanks(r);
        if (take(r, "]"))
            break;
        if (result->length > 0)
            take(r, ",");
        if (result->length == 3 || !read_expression(r, &element) || element.length != 1)
            return false;
        result->x[result->length++] = element.x[0];
    }
    r->in_brackets = outer;
    if (result->length == 1)
        *result = constant(result->x[0], 1);
    return result->length == 1 || result->length == 3;
}

static bool read_count(reader *r, double *count)
{
    skip_blanks(r);
    const char *after = imk_decimal_parse(r->at, r->end, count);
    bool good = after != r->at;
    r->at = after;
    skip_blanks(r);
    return good;
}

/* Behind ones or zeros: (1,3), which is a row; also (3,1) and (1,1). */
static bool read_size(reader *r, int *length)
{
    double rows = 0, columns = 0;
    skip_blanks(r);
    bool good = take(r, "(") && read_count(r, &rows) && take(r, ",") && read_count(r, &columns) &&
                take(r, ")");
    *length = rows * columns == 3 ? 3 : 1;
    return good && (rows * columns == 3 || rows * columns == 1);
}

static bool read_name(reader *r, value *result)
{
    char name[32];
    size_t length = 0;
    const char *start = r->at;
    while (r->at < r->end &&
           ((*r->at >= 'a' && *r->at <= 'z') || (*r->at >= 'A' && *r->at <= 'Z') || *r->at == '_' ||
            (length > 0 && *r->at >= '0' && *r->at <= '9'))) {
        if (length + 1 == sizeof name)
            return false;
        name[length++] = *r->at++;
    }
    name[length] = '\0';
    if (strcmp(name, "pi") == 0) {
        *result = constant(3.14159265358979323846, 1);
        return true;
    }
    if (strcmp(name, "Inf") == 0 || strcmp(name, "inf") == 0) {
        *result = constant(INFINITY, 1);
        return true;
    }
    if (strcmp(name, "ones") == 0 || strcmp(name, "zeros") == 0) {
        int count = 1;
        bool good = read_size(r, &count);
        *result = constant(name[0] == 'o', count);
        return good;
    }
    if (strcmp(name, "sqrt") == 0) {
        bool good = read_parentheses(r, result);
        for (int i = 0; i < 3 && good; i++)
            result->x[i] = sqrt(result->x[i]);
        return good;
    }
    for (size_t i = 0; i < r->variables->count; i++)
        if (strcmp(name, r->variables->variable[i].name) == 0) {
            result->length = r->variables->variable[i].length;
            memcpy(result->x, r->variables->variable[i].value, sizeof result->x);
            return true;
        }
    r->at = start;
    return false;
}

static bool read_factor(reader *r, value *result)
{
    skip_blanks(r);
    double sign = 1;
    while (r->at < r->end && (*r->at == '+' || *r->at == '-'))
        sign = *r->at++ == '-' ? -sign : sign;
    if (r->at == r->end || ++r->depth > DEPTH_MAX)
        return false;
    bool good;
    if (*r->at == '(') {
        good = read_parentheses(r, result);
    } else if (*r->at == '[') {
        r->at++;
        good = read_bracket(r, result);
    } else if ((*r->at >= '0' && *r->at <= '9') || *r->at == '.') {
        double x = 0;
        const char *after = imk_decimal_parse(r->at, r->end, &x);
        good = after != r->at;
        r->at = after;
        *result = constant(x, 1);
    } else {
        good = read_name(r, result);
    }
    r->depth--;
    for (int i = 0; i < 3 && good; i++)
        result->x[i] *= sign;
    /* A transposed row holds the same three numbers. */
    while (good && r->at < r->end && *r->at == '\'')
        r->at++;
    return good;
}

static bool read_term(reader *r, value *result)
{
    if (!read_factor(r, result))
        return false;
    for (;;) {
        const char *before = r->at;
        value factor;
        skip_blanks(r);
        take(r, ".");
        char operation = r->at < r->end ? *r->at : '\0';
        if (operation != '*' && operation != '/') {
            r->at = before;
            return true;
        }
        r->at++;
        if (!read_factor(r, &factor) || !combine(result, &factor, operation))
            return false;
    }
}

static bool read_expression(reader *r, value *result)
{
    if (!read_term(r, result))
        return false;
    for (;;) {
        const char *before = r->at;
        value term;
        skip_blanks(r);
        char operation = r->at < r->end ? *r->at : '\0';
        bool blank_before = r->at > before;
        bool blank_behind = r->at + 1 < r->end && (r->at[1] == ' ' || r->at[1] == '\t');
        bool separates = r->in_brackets && blank_before && !blank_behind;
        if ((operation != '+' && operation != '-') || separates) {
            r->at = before;
            return true;
        }
        r->at++;
        if (!read_term(r, &term) || !combine(result, &term, operation))
            return false;
    }
}

bool imki_expression(const char *begin, const char *end, const imki_variables *variables,
                     int *length, double result[3], const char **stop)
{
    reader r = {begin, end, variables, 0, false};
    value v = {0, {0}};
    bool good = read_expression(&r, &v);
    skip_blanks(&r);
    *stop = r.at;
    *length = v.length;
    memcpy(result, v.x, sizeof v.x);
    return good && r.at == end;
}
