/* SPDX-License-Identifier: Apache-2.0 */
/* JSON as structs and arrays, as jsondecode() makes them: objects are structs; arrays of numbers,
 * columns; of columns of one length, matrices with a row for each; of objects of the same keys,
 * struct arrays; other arrays, cells. null is [], and NaN among numbers.
 *
 * Other than with jsondecode(), the array `points` of a curve is one struct of columns, as a script
 * uses it.
 *
 * The text is that of imk_result_to_json(), so nothing in it is unexpected. jsondecode() itself is
 * not used because that of Octave 7 does not round numbers correctly. */
#include "gateway.h"

#include "imukit/decimal.h"

#include <ctype.h>
#include <math.h>
#include <string.h>

enum { NAME_SIZE = 64 };

/* A value that is complete, or the members of an object. */
typedef struct node {
    mxArray *value; /* NULL: an object */
    int count;
    char (*name)[NAME_SIZE];
    mxArray **member;
} node;

static node read_node(const char **at);

static void skip(const char **at)
{
    *at += strspn(*at, " \n");
}

/* Is the next character this one? It is then passed. */
static bool pass(const char **at, char c)
{
    skip(at);
    if (**at != c)
        return false;
    ++*at;
    return true;
}

/* Room for one more of an array that grows by doubling. */
static void *more(void *array, size_t count, size_t size)
{
    if (count == 0)
        return mxMalloc(8 * size);
    return count >= 8 && (count & (count - 1)) == 0 ? mxRealloc(array, 2 * count * size) : array;
}

/* ---- values ---------------------------------------------------------------------------------- */

/* @return from mxMalloc() */
static char *read_text(const char **at)
{
    static const char letters[] = "bfnrt", meant[] = "\b\f\n\r\t";
    const char *c = *at + 1, *close = c;
    for (; *close != '"'; close++)
        close += *close == '\\';
    char *text = mxMalloc((size_t)(close - c) + 1), *end = text;
    for (; *c != '"'; c++) {
        const char *letter = *c == '\\' ? strchr(letters, c[1]) : NULL;
        if (*c != '\\') {
            *end++ = *c;
        } else if (c[1] == 'u') { /* a control character: below 0x20 */
            *end++ = (char)((c[4] - '0') * 16 + (isdigit(c[5]) ? c[5] - '0' : c[5] - 'A' + 10));
            c += 5;
        } else {
            *end++ = letter ? meant[letter - letters] : c[1];
            c++;
        }
    }
    *end = '\0';
    *at = c + 1;
    return text;
}

static mxArray *read_string(const char **at)
{
    char *text = read_text(at);
    mxArray *string = mxCreateString(text);
    mxFree(text);
    return string;
}

/* A number, or null as NaN. */
static bool read_number(const char **at, double *number)
{
    skip(at);
    if (strncmp(*at, "null", 4) == 0) {
        *number = (double)NAN;
        *at += 4;
        return true;
    }
    const char *end = *at + strcspn(*at, ", \n]}");
    if (!(isdigit((unsigned char)**at) || **at == '-'))
        return false;
    *at = imk_decimal_parse(*at, end, number);
    return true;
}

/* A key as the name of a field: letters, digits and _, a letter first. */
static void name_field(const char *key, char name[NAME_SIZE])
{
    snprintf(name, NAME_SIZE, "%s%s", isalpha((unsigned char)key[0]) ? "" : "x", key);
    for (char *c = name; *c; c++)
        if (!isalnum((unsigned char)*c))
            *c = '_';
}

static mxArray *column(const double *number, size_t count)
{
    mxArray *array = mxCreateDoubleMatrix(count, count > 0, mxREAL);
    if (count > 0)
        memcpy(mxGetPr(array), number, count * sizeof *number);
    return array;
}

/* A key and its colon. */
static void read_key(const char **at, char name[NAME_SIZE])
{
    skip(at);
    char *text = read_text(at);
    name_field(text, name);
    mxFree(text);
    (void)pass(at, ':');
}

/* ---- points of a curve ----------------------------------------------------------------------- */

enum { TABLE_COLUMNS_MAX = 16 };

/* A member of all points: numbers, which may have a unit, or texts. */
typedef struct table_column {
    char name[NAME_SIZE];
    double *number;
    mxArray **text; /* NULL: numbers */
    mxArray *unit;  /* NULL: none */
} table_column;

static void read_cell(const char **at, size_t row, table_column *c)
{
    char name[NAME_SIZE];
    skip(at);
    if (**at == '"') {
        c->text = more(c->text, row, sizeof(mxArray *));
        c->text[row] = read_string(at);
        return;
    }
    const bool quantity = pass(at, '{');
    c->number = more(c->number, row, sizeof *c->number);
    if (quantity)
        read_key(at, name);
    (void)read_number(at, &c->number[row]);
    if (!quantity)
        return;
    (void)pass(at, ',');
    read_key(at, name);
    skip(at);
    mxArray *unit = read_string(at); /* the same for all points */
    if (c->unit)
        mxDestroyArray(unit);
    else
        c->unit = unit;
    (void)pass(at, '}');
}

static void set_field(mxArray *array, const char *name, mxArray *value)
{
    mxSetFieldByNumber(array, 0, mxAddField(array, name), value);
}

/* The columns of `rows` points as a struct with a field for each, and their units in `units`. */
static mxArray *make_table(size_t rows, int count, const table_column *c)
{
    mxArray *table = mxCreateStructMatrix(1, 1, 0, NULL);
    mxArray *units = mxCreateStructMatrix(1, 1, 0, NULL);
    for (int i = 0; i < count; i++) {
        mxArray *value = c[i].text ? mxCreateCellMatrix(rows, 1) : column(c[i].number, rows);
        for (size_t k = 0; c[i].text && k < rows; k++)
            mxSetCell(value, k, c[i].text[k]);
        set_field(table, c[i].name, value);
        if (c[i].unit)
            set_field(units, c[i].name, c[i].unit);
    }
    set_field(table, "units", units);
    return table;
}

/* @return NULL: it is no array of objects, and *at has not moved */
static mxArray *read_points(const char **at)
{
    const char *c = *at;
    table_column columns[TABLE_COLUMNS_MAX] = {{.number = NULL}};
    int count = 0;
    size_t rows = 0;
    if (!pass(&c, '[') || !pass(&c, '{'))
        return NULL;
    do {
        count = 0;
        do {
            read_key(&c, columns[count].name);
            read_cell(&c, rows, &columns[count++]);
        } while (pass(&c, ','));
        (void)pass(&c, '}');
        rows++;
    } while (pass(&c, ',') && pass(&c, '{'));
    (void)pass(&c, ']');
    *at = c;
    return make_table(rows, count, columns);
}

/* ---- objects and arrays ---------------------------------------------------------------------- */

static void set_members(mxArray *array, size_t index, const node *n)
{
    for (int i = 0; i < n->count; i++)
        mxSetFieldByNumber(array, index, i, n->member[i]);
}

/* `count` objects of the same names. */
static mxArray *make_struct(const node *nodes, size_t count)
{
    const char **names = mxMalloc((size_t)(nodes->count + 1) * sizeof *names);
    for (int i = 0; i < nodes->count; i++)
        names[i] = nodes->name[i];
    mxArray *array = mxCreateStructMatrix(count, 1, nodes->count, names);
    for (size_t k = 0; k < count; k++)
        set_members(array, k, &nodes[k]);
    return array;
}

static mxArray *value_of(const node *n)
{
    return n->value ? n->value : make_struct(n, 1);
}

static node read_object(const char **at)
{
    node n = {.value = NULL};
    if (pass(at, '}'))
        return n;
    do {
        n.name = more(n.name, (size_t)n.count, sizeof *n.name);
        n.member = more(n.member, (size_t)n.count, sizeof(mxArray *));
        read_key(at, n.name[n.count]);
        mxArray *table = strcmp(n.name[n.count], "points") == 0 ? read_points(at) : NULL;
        if (!table) {
            const node member = read_node(at);
            table = value_of(&member);
        }
        n.member[n.count++] = table;
    } while (pass(at, ','));
    (void)pass(at, '}');
    return n;
}

static bool same_names(const node *a, const node *b)
{
    if (a->value || b->value || a->count != b->count)
        return false;
    for (int i = 0; i < a->count; i++)
        if (strcmp(a->name[i], b->name[i]) != 0)
            return false;
    return true;
}

/* A column of numbers as long as this one? */
static bool same_columns(const mxArray *a, const mxArray *b)
{
    return a && b && mxIsDouble(a) && mxIsDouble(b) && mxGetN(a) == 1 && mxGetN(b) == 1 &&
           mxGetM(a) == mxGetM(b);
}

static mxArray *make_matrix(const node *nodes, size_t rows)
{
    const size_t columns = mxGetM(nodes->value);
    mxArray *array = mxCreateDoubleMatrix(rows, columns, mxREAL);
    for (size_t i = 0; i < rows; i++)
        for (size_t j = 0; j < columns; j++)
            mxGetPr(array)[j * rows + i] = mxGetPr(nodes[i].value)[j];
    return array;
}

static mxArray *make_array(const node *nodes, size_t count)
{
    bool objects = !nodes->value, rows = same_columns(nodes->value, nodes->value);
    bool flags = nodes->value && mxIsLogical(nodes->value);
    for (size_t k = 1; k < count; k++) {
        objects = objects && same_names(nodes, &nodes[k]);
        rows = rows && same_columns(nodes->value, nodes[k].value);
        flags = flags && nodes[k].value && mxIsLogical(nodes[k].value);
    }
    if (objects)
        return make_struct(nodes, count);
    if (rows)
        return make_matrix(nodes, count);
    mxArray *array = flags ? mxCreateLogicalMatrix(count, 1) : mxCreateCellMatrix(count, 1);
    for (size_t k = 0; k < count; k++)
        if (flags)
            mxGetLogicals(array)[k] = mxIsLogicalScalarTrue(nodes[k].value);
        else
            mxSetCell(array, k, value_of(&nodes[k]));
    return array;
}

/* Numbers only, which may be many. @return NULL: there is something else, and *at has not moved */
static mxArray *read_numbers(const char **at)
{
    const char *c = *at;
    double *number = NULL, next;
    size_t count = 0;
    if (pass(&c, ']')) {
        *at = c;
        return column(NULL, 0);
    }
    do {
        if (!read_number(&c, &next))
            return NULL;
        number = more(number, count, sizeof *number);
        number[count++] = next;
    } while (pass(&c, ','));
    (void)pass(&c, ']');
    *at = c;
    return column(number, count);
}

static mxArray *read_array(const char **at)
{
    node *nodes = NULL;
    size_t count = 0;
    mxArray *numbers = read_numbers(at);
    if (numbers)
        return numbers;
    do {
        nodes = more(nodes, count, sizeof *nodes);
        nodes[count++] = read_node(at);
    } while (pass(at, ','));
    (void)pass(at, ']');
    return make_array(nodes, count);
}

static node read_node(const char **at)
{
    double number;
    node n = {.value = NULL};
    if (pass(at, '{'))
        return read_object(at);
    if (pass(at, '['))
        n.value = read_array(at);
    else if (**at == '"')
        n.value = read_string(at);
    else if (strncmp(*at, "null", 4) == 0)
        n.value = mxCreateDoubleMatrix(0, 0, mxREAL);
    else if (**at == 't' || **at == 'f')
        n.value = mxCreateLogicalScalar(**at == 't');
    else if (read_number(at, &number))
        n.value = mxCreateDoubleScalar(number);
    *at += strcspn(*at, ",]}\n "); /* behind null, true and false */
    return n;
}

mxArray *gateway_value(const char *json)
{
    const node n = read_node(&json);
    return value_of(&n);
}
