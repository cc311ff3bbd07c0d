/* SPDX-License-Identifier: Apache-2.0 */
/* Reading the values of a model file: quantities, then each shape of field.
 *
 * A one-sided density d and IEEE's two-sided N:  N = d/sqrt(2);  the floor of the Allan deviation
 * and B:  B = floor/sqrt(2 ln 2/pi)  [IEEE952]. */
#include "model_reader_internal.h"

#include "base/algebra/vector_internal.h"
#include "base/nearest_name_internal.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { NUMBERS_MAX = 8 };

/* One quantity: up to NUMBERS_MAX numbers with their sigmas. */
typedef struct quantity {
    double value[NUMBERS_MAX], sigma[NUMBERS_MAX];
    size_t count;
} quantity;

/* ---- quantities ------------------------------------------------------------------------------ */

imk_status imki_parse_quantity(const char *text, size_t length, const char *si, unsigned flags,
                               size_t max_count, double *values, double *sigmas, size_t *count,
                               imk_unit *unit, imk_error *error)
{
    imk_dimension due = imk_unit_of(si).dimension;
    char with_unit[1024];
    /* The last number of "0 0 1" is not a unit: first try with a unit behind it. */
    if ((flags & IMKI_BARE) && length + 3 < sizeof with_unit) {
        size_t size = (size_t)snprintf(with_unit, sizeof with_unit, "%s 1", text);
        if (imk_quantity_parse(with_unit, with_unit + size, due, max_count, values, sigmas, count,
                               unit, NULL) == IMK_OK)
            return IMK_OK;
    }
    return imk_quantity_parse(text, text + length, due, max_count, values, sigmas, count, unit,
                              error);
}

static bool says_infinite(const char *text)
{
    while (*text == '.' || *text == '+' || *text == '-' || *text == ' ')
        text++;
    return tolower((unsigned char)text[0]) == 'i' && tolower((unsigned char)text[1]) == 'n' &&
           tolower((unsigned char)text[2]) == 'f';
}

/* A failure of which the text of the node is to be seen. */
static void fail(const imki_reader *r, int node, const char *expected)
{
    imki_refuse_value(r->reading, node, IMK_ERROR_SYNTAX, expected);
}

/* A text that is no quantity of such a unit, and why. */
static void refuse_quantity(const imki_reader *r, int node, const char *si, imk_status status,
                            const imk_error *error)
{
    char expected[sizeof error->expected];
    const char *text = imki_reader_node(r, node)->text;
    snprintf(expected, sizeof expected, "a unit behind the number, like %s",
             imk_dimension_examples(imk_unit_of(si).dimension));
    if (status == IMK_ERROR_UNIT_MISSING)
        imki_value_refuse(r->reading, node, status, text, expected);
    else
        imki_value_refuse(r->reading, node, status, error->found[0] ? error->found : text,
                          error->expected);
}

/* What stands in the file, as two-sided SI values; zeros after a failure. */
static quantity read_quantity(imki_reader *r, int node, const char *si, unsigned flags,
                              size_t max_count)
{
    quantity q = {.count = 0};
    imk_error error;
    imk_unit unit = {.scale = 0};
    if (!imki_value_require(r->reading, node, IMKI_NODE_SCALAR,
                            "one or more numbers and their unit"))
        return q;
    const imki_node *n = imki_reader_node(r, node);
    if (says_infinite(n->text)) {
        bool is_time = imki_reader_node(r, n->key != IMKI_NONE ? n->key : node)->text[0] == 'c';
        static const char *const walks[IMK_KINDS] = {
            "a finite time; for an infinite one, use rate_random_walk",
            "a finite time; for an infinite one, use acceleration_random_walk",
            "a finite time; for an infinite one, use random_walk"};
        imki_refuse_value(r->reading, node, IMK_ERROR_NOT_FINITE,
                          is_time ? walks[r->kind] : "a finite number");
        return q;
    }
    const imk_status status = imki_parse_quantity(n->text, n->length, si, flags, max_count, q.value,
                                                  q.sigma, &q.count, &unit, &error);
    if (status != IMK_OK) {
        refuse_quantity(r, node, si, status, &error);
        return (quantity){.count = 0};
    }
    if (unit.per_root_hertz && r->density == IMK_DENSITY_UNSTATED)
        imki_value_refuse(r->reading, node, IMK_ERROR_KEY_MISSING, "density",
                          "add density: two-sided (IEEE's N) or density: one-sided (most data "
                          "sheets) to noise: /sqrt(Hz) alone does not say which");
    for (size_t i = 0; unit.per_root_hertz && r->density == IMK_DENSITY_ONE_SIDED && i < q.count;
         i++) {
        q.value[i] /= sqrt(2.0);
        q.sigma[i] /= sqrt(2.0);
    }
    return q;
}

/* One number for all axes, or one for each. */
void imki_read_per_axis(imki_reader *r, int node, const char *si, unsigned flags, double *values,
                        double *sigmas)
{
    const size_t axes = (size_t)r->triad->axis_count;
    const quantity q = read_quantity(r, node, si, flags, axes);
    if (q.count != 1 && q.count != axes)
        fail(r, node, "one number for all axes, or one for each");
    for (size_t i = 0; i < axes; i++) {
        values[i] = q.value[q.count == 1 ? 0 : i];
        if (sigmas)
            sigmas[i] = q.sigma[q.count == 1 ? 0 : i];
    }
}

/* ---- fields ---------------------------------------------------------------------------------- */

static double *values_of(const imki_field *field, void *base)
{
    return (double *)(void *)((char *)base +
                              ((const char *)imki_field_values(field, base) - (const char *)base));
}

static double *sigmas_of(const imki_field *field, void *base)
{
    return (double *)(void *)((char *)base +
                              ((const char *)imki_field_sigmas(field, base) - (const char *)base));
}

/* Six numbers or one: xy xz yx yz zx zy. */
static void read_off_diagonal(imki_reader *r, const imki_field *field, int node)
{
    const quantity q = read_quantity(r, node, field->si[r->kind], field->flags, 6);
    if (r->triad->axis_count != 3 || (q.count != 1 && q.count != 6)) {
        fail(r, node,
             r->triad->axis_count == 3
                 ? "one number, six (xy xz yx yz zx zy), or a list of three rows"
                 : "a list with a row x y z for each axis");
        return;
    }
    imk_rows *rows = (imk_rows *)(void *)((char *)r->triad + field->offset);
    int k = 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            bool diagonal = i == j;
            rows->value[i][j] = diagonal ? 0 : q.value[q.count == 1 ? 0 : k];
            rows->sigma[i][j] = diagonal ? 0 : q.sigma[q.count == 1 ? 0 : k];
            k += !diagonal;
        }
}

static void read_rows(imki_reader *r, const imki_field *field, int node)
{
    const imki_node *list = imki_reader_node(r, node);
    if (field->shape == IMKI_OFF_DIAGONAL && list->kind == IMKI_NODE_SCALAR) {
        read_off_diagonal(r, field, node);
        return;
    }
    int length = imki_row_length(field->shape), axes = r->triad->axis_count;
    if (list->kind != IMKI_NODE_SEQUENCE || list->count != axes) {
        fail(r, node,
             axes == 3 ? "a list of three rows, one for each axis"
                       : "a list with a row for each axis");
        return;
    }
    double *values = values_of(field, r->triad), *sigmas = sigmas_of(field, r->triad);
    int child = list->first;
    for (int i = 0; i < axes; i++, child = imki_reader_node(r, child)->next) {
        const quantity q =
            read_quantity(r, child, field->si[r->kind], field->flags, (size_t)length);
        if ((int)q.count != length)
            fail(r, child,
                 length == 3 ? "a row of three numbers: x y z"
                             : "a row of six numbers: xx yy zz xy yz zx");
        memcpy(values + i * length, q.value, (size_t)length * sizeof *values);
        memcpy(sigmas + i * length, q.sigma, (size_t)length * sizeof *sigmas);
    }
}

/* One row of any length, brought to unit length; where zeros are allowed they stay. */
static void read_unit_row(imki_reader *r, int node, bool may_be_zero, double row[3])
{
    const quantity q = read_quantity(r, node, "1", IMKI_BARE, 3);
    double square = imki_dot3(q.value, q.value);
    bool is_zero = q.count == 3 && q.value[0] == 0 && q.value[1] == 0 && q.value[2] == 0;
    if (q.count != 3 || !((square > 1e-12 && square < 1e12) || (may_be_zero && is_zero)))
        fail(r, node,
             may_be_zero ? "a direction: three numbers x y z"
                         : "a direction: three numbers x y z, not all 0");
    if (q.sigma[0] != 0 || q.sigma[1] != 0 || q.sigma[2] != 0)
        fail(r, node, "a direction without 1-sigma; uncertain directions are a misalignment");
    /* Rows of unit length to rounding stay as they are, so that reading what was written changes
     * nothing. */
    double norm = is_zero || fabs(square - 1) < 1e-14 ? 1 : sqrt(square);
    for (int j = 0; j < 3; j++)
        row[j] = q.value[j] / norm;
}

static void read_unit_rows(imki_reader *r, int node, bool may_be_zero, double (*row)[3])
{
    int child = imki_reader_node(r, node)->first;
    for (int i = 0; i < r->triad->axis_count; i++, child = imki_reader_node(r, child)->next)
        read_unit_row(r, child, may_be_zero, row[i]);
}

/* The number of rows is that of the axes. */
void imki_read_direction(imki_reader *r, int node)
{
    const imki_node *list = imki_reader_node(r, node);
    if (list->kind != IMKI_NODE_SEQUENCE || list->count < 1 || list->count > IMK_AXES_MAX) {
        fail(r, node, "a list of 1 to 8 rows x y z, one for each axis");
        return;
    }
    r->triad->axis_count = list->count;
    memset(r->triad->direction, 0, sizeof r->triad->direction);
    read_unit_rows(r, node, false, r->triad->direction);
}

static void read_pendulous(imki_reader *r, int node)
{
    const imki_node *list = imki_reader_node(r, node);
    if (list->kind != IMKI_NODE_SEQUENCE || list->count != r->triad->axis_count)
        fail(r, node, "a list with a row x y z for each axis, 0 0 0 for the default");
    else
        read_unit_rows(r, node, true, r->triad->nonlinearity.pendulous_axis);
}

void imki_read_density(imki_reader *r, int node)
{
    if (!imki_value_require(r->reading, node, IMKI_NODE_SCALAR,
                            "either density: one-sided or density: two-sided"))
        return;
    const char *text = imki_reader_node(r, node)->text;
    if (strcmp(text, "one-sided") == 0)
        r->density = IMK_DENSITY_ONE_SIDED;
    else if (strcmp(text, "two-sided") == 0)
        r->density = IMK_DENSITY_TWO_SIDED;
    else
        fail(r, node, "either one-sided or two-sided");
    r->triad->noise.density = r->density;
}

/* Keys of a mapping, all of which must be there; nodes in the order of the names.
 * @return false when they are not */
static bool take_keys(imki_reader *r, int node, size_t count, const char *const *names, int *nodes)
{
    char expected[128] = "a mapping with";
    for (size_t i = 0; i < count; i++) {
        size_t length = strlen(expected);
        snprintf(expected + length, sizeof expected - length, "%s %s", i > 0 ? "," : "", names[i]);
    }
    if (!imki_value_require(r->reading, node, IMKI_NODE_MAPPING, expected))
        return false;
    for (int key = imki_reader_node(r, node)->first; key != IMKI_NONE;
         key = imki_reader_node(r, imki_reader_node(r, key)->next)->next) {
        const char *text = imki_reader_node(r, key)->text;
        size_t i = 0;
        while (i < count && strcmp(text, names[i]) != 0)
            i++;
        if (i < count)
            continue;
        const size_t nearest = imki_nearest_name(text, count, names);
        if (nearest != SIZE_MAX)
            snprintf(expected, sizeof expected, "did you mean \"%s\"?", names[nearest]);
        imki_refuse_value(r->reading, key, IMK_ERROR_KEY_UNKNOWN, expected);
    }
    for (size_t i = 0; i < count; i++)
        if (!imki_value_find(r->reading, node, names[i], expected, &nodes[i]))
            return false;
    return true;
}

static void read_coefficients(imki_reader *r, const imki_field *field, int node,
                              imk_temperature_polynomial *polynomial)
{
    const imki_node *list = imki_reader_node(r, node);
    bool single = list->kind == IMKI_NODE_SCALAR;
    int order = single ? 1 : list->count;
    if (list->kind == IMKI_NODE_MAPPING || order < 1 || order > IMK_TEMPERATURE_ORDER_MAX) {
        fail(r, node, "a list of 1 to 5 coefficients, of T, T^2, … (T less the reference)");
        return;
    }
    int child = single ? node : list->first;
    for (int i = 0; i < order; i++, child = single ? child : imki_reader_node(r, child)->next)
        imki_read_per_axis(r, child, imki_polynomial_si(field, r->kind, i + 1), 0,
                           polynomial->coefficient[i].value, polynomial->coefficient[i].sigma);
    polynomial->order = order;
}

static void read_polynomial(imki_reader *r, const imki_field *field, int node)
{
    static const char *const names[] = {"reference_temperature", "valid_range", "coefficients"};
    imk_temperature_polynomial *polynomial =
        (imk_temperature_polynomial *)(void *)((char *)r->triad + field->offset);
    int nodes[3];
    if (!take_keys(r, node, 3, names, nodes))
        return;
    polynomial->reference = read_quantity(r, nodes[0], "K", 0, 1).value[0];
    const quantity range = read_quantity(r, nodes[1], "K", 0, 2);
    if (range.count != 2)
        fail(r, nodes[1], "two temperatures, from the lower to the higher, like -40 85 degC");
    polynomial->minimum = range.value[0];
    polynomial->maximum = range.value[1];
    read_coefficients(r, field, nodes[2], polynomial);
}

static void read_list(imki_reader *r, const imki_field *field, int node)
{
    imki_list list = imki_list_of(field);
    const imki_node *sequence = imki_reader_node(r, node);
    if (sequence->kind != IMKI_NODE_SEQUENCE || sequence->count > IMK_TERMS_MAX) {
        fail(r, node, "a list of at most 8 terms: [{…}, {…}]");
        return;
    }
    const char *names[4];
    int nodes[4], child = sequence->first;
    for (size_t j = 0; j < list.field_count; j++)
        names[j] = list.field[j].path[r->kind];
    for (int i = 0; i < sequence->count; i++, child = imki_reader_node(r, child)->next) {
        char *element = (char *)r->triad + field->offset + (size_t)i * list.size;
        if (!take_keys(r, child, list.field_count, names, nodes))
            return;
        for (size_t j = 0; j < list.field_count; j++) {
            const imki_field *of = &list.field[j];
            imki_read_per_axis(r, nodes[j], of->si[r->kind], of->flags, values_of(of, element),
                               sigmas_of(of, element));
        }
    }
    memcpy((char *)r->triad + field->count_offset, &sequence->count, sizeof sequence->count);
}

/* Floor of the Allan deviation: B = floor / sqrt(2 ln 2/pi). */
static void read_floor(imki_reader *r, const imki_field *field, int node)
{
    const imk_document *document = r->reading->document;
    int noise = imki_document_value(document, r->sensor, "noise");
    if (imki_document_value(document, noise, "bias_instability") != IMKI_NONE)
        imki_value_refuse(r->reading, node, IMK_ERROR_CONFLICT,
                          "bias_instability and allan_floor exclude each other",
                          "keep one of them: the floor is 0.664 of the instability");
    double *values = values_of(field, r->triad), *sigmas = sigmas_of(field, r->triad);
    imki_read_per_axis(r, node, field->si[r->kind], field->flags, values, sigmas);
    for (int i = 0; i < r->triad->axis_count; i++) {
        values[i] /= IMKI_ALLAN_FLOOR;
        sigmas[i] /= IMKI_ALLAN_FLOOR;
    }
}

void imki_read_scalar(imki_reader *r, const imki_field *field, void *base, int node)
{
    const quantity q = read_quantity(r, node, field->si[0], field->flags, 1);
    values_of(field, base)[0] = q.value[0];
    sigmas_of(field, base)[0] = q.sigma[0];
}

void imki_read_field(imki_reader *r, const imki_field *field, int node)
{
    switch (field->shape) {
    case IMKI_DIRECTION: /* these two were read before */
    case IMKI_DENSITY:
        break;
    case IMKI_SCALAR:
        imki_read_scalar(r, field, r->triad, node);
        break;
    case IMKI_AXES:
        if (field->flags & IMKI_FLOOR)
            read_floor(r, field, node);
        else
            imki_read_per_axis(r, node, field->si[r->kind], field->flags,
                               values_of(field, r->triad), sigmas_of(field, r->triad));
        break;
    case IMKI_PENDULOUS:
        read_pendulous(r, node);
        break;
    case IMKI_POLYNOMIAL:
        read_polynomial(r, field, node);
        break;
    case IMKI_LIST:
        read_list(r, field, node);
        break;
    default:
        read_rows(r, field, node);
    }
}
