/* SPDX-License-Identifier: Apache-2.0 */
/* Writing the values of a model: every one in its readable unit as the shortest decimals that read
 * back to the same doubles.
 *
 * Each value is read back before it is accepted; where no decimal in the unit gives the same
 * double (a one-sided density is divided by sqrt(2) on reading), the SI unit is taken, whose scale
 * is 1. */
#include "model_yaml_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { VALUE_SIZE = 1024, KEY_SIZE = 64 };

/* ---- quantities ------------------------------------------------------------------------------ */

/* Numbers to write: `count` equal to the axes, or to the row. */
typedef struct numbers {
    const double *values, *sigmas;
    size_t count;
    bool broadcasts; /* one number stands for all when they are equal */
    const char *si;
    unsigned flags;
    imk_density density;
} numbers;

static bool reads_back(const char *text, const numbers *n, size_t count)
{
    double values[IMK_AXES_MAX], sigmas[IMK_AXES_MAX];
    size_t found;
    imk_unit unit;
    if (imki_parse_quantity(text, strlen(text), n->si, n->flags, IMK_AXES_MAX, values, sigmas,
                            &found, &unit, NULL) != IMK_OK ||
        found != count || (unit.per_root_hertz && n->density == IMK_DENSITY_UNSTATED))
        return false;
    double divisor = unit.per_root_hertz && n->density == IMK_DENSITY_ONE_SIDED ? sqrt(2.0) : 1.0;
    for (size_t i = 0; i < count; i++)
        if (!(values[i] / divisor == n->values[i]) ||
            !(sigmas[i] / divisor == (n->sigmas ? n->sigmas[i] : 0)))
            return false;
    return true;
}

/* True when the text reads back to the numbers. */
static bool format_in(const imk_unit *unit, const numbers *n, size_t count, char *text)
{
    double values[IMK_AXES_MAX], sigmas[IMK_AXES_MAX];
    bool has_sigmas = false;
    double factor = unit->per_root_hertz && n->density == IMK_DENSITY_ONE_SIDED ? sqrt(2.0) : 1.0;
    for (size_t i = 0; i < count; i++) {
        values[i] = n->values[i] * factor;
        sigmas[i] = n->sigmas ? n->sigmas[i] * factor : 0;
        has_sigmas = has_sigmas || sigmas[i] != 0;
    }
    size_t length = unit->scale != 0 ? imk_quantity_format(values, has_sigmas ? sigmas : NULL,
                                                           count, unit, text, VALUE_SIZE)
                                     : 0;
    if (length == 0)
        return false;
    if ((n->flags & IMKI_BARE) && length > 2 && strcmp(text + length - 2, " 1") == 0)
        text[length - 2] = '\0';
    return reads_back(text, n, count);
}

static void format_numbers(const imki_writer *writer, const numbers *n, const char *unit_text,
                           char *text)
{
    bool equal = n->broadcasts;
    for (size_t i = 1; i < n->count; i++)
        equal =
            equal && n->values[i] == n->values[0] && (!n->sigmas || n->sigmas[i] == n->sigmas[0]);
    size_t count = equal ? 1 : n->count;
    imk_unit usual = imk_unit_of(unit_text), si = imk_unit_of(n->si);
    text[0] = '\0';
    bool done = writer->unit && imk_dimension_equal(writer->unit->dimension, si.dimension) &&
                format_in(writer->unit, n, count, text);
    if (!done && !format_in(&usual, n, count, text))
        format_in(&si, n, count, text);
}

/* JSON's numbers stand without quotes. */
static bool is_number(const char *text)
{
    return text[0] != '\0' && strspn(text, "0123456789.eE+-") == strlen(text);
}

static void write_quantity(imki_writer *writer, const char *text)
{
    if (writer->is_json && !is_number(text))
        imki_write_quoted(writer, text);
    else
        imki_write_text(writer, text);
}

/* The file's own text for this item, when it is a quantity that says the model's values. */
static const char *kept_text(const imki_writer *writer, const imki_item *item,
                             const imk_model *model)
{
    const imk_document *source = writer->source;
    bool complete;
    if (!source || !imki_item_equal(item, &source->model, model) ||
        imk_model_triad(&source->model, item->kind)->axis_count !=
            imk_model_triad(model, item->kind)->axis_count ||
        imk_model_triad(&source->model, item->kind)->noise.density !=
            imk_model_triad(model, item->kind)->noise.density)
        return NULL;
    int node = imki_document_find(source, 0, item->path, &complete);
    if (!complete || source->node[node].kind != IMKI_NODE_SCALAR)
        return NULL;
    for (const char *c = source->node[node].text; *c; c++)
        if ((unsigned char)*c < 0x20)
            return NULL;
    return source->node[node].text;
}

/* ---- values ---------------------------------------------------------------------------------- */

static const char *usual_unit(const imki_field *field, int kind, imk_density density)
{
    const char *with_density = field->density[kind];
    return with_density && density != IMK_DENSITY_UNSTATED ? with_density : field->unit[kind];
}

/* The numbers of a field of shape scalar or axes. */
static void write_axes(imki_writer *writer, const imki_field *field, int kind, const void *base,
                       const imk_triad *triad)
{
    char text[VALUE_SIZE];
    numbers n = {imki_field_values(field, base),
                 imki_field_sigmas(field, base),
                 (size_t)imki_field_rows(field, triad->axis_count),
                 true,
                 field->si[kind],
                 field->flags,
                 triad->noise.density};
    format_numbers(writer, &n, usual_unit(field, kind, triad->noise.density), text);
    write_quantity(writer, text);
}

static void write_off_diagonal(imki_writer *writer, const imki_field *field, int kind,
                               const imk_triad *triad)
{
    const double *from = imki_field_values(field, triad), *of = imki_field_sigmas(field, triad);
    double values[6], sigmas[6];
    char text[VALUE_SIZE];
    for (int i = 0, k = 0; i < 9; i++)
        if (i % 4 != 0) {
            values[k] = from[i];
            sigmas[k++] = of[i];
        }
    numbers n = {values, sigmas, 6, true, field->si[kind], field->flags, IMK_DENSITY_UNSTATED};
    format_numbers(writer, &n, field->unit[kind], text);
    write_quantity(writer, text);
}

static void write_rows(imki_writer *writer, const imki_field *field, int kind,
                       const imk_triad *triad)
{
    bool is_direction = field->shape == IMKI_DIRECTION || field->shape == IMKI_PENDULOUS;
    int length = imki_row_length(field->shape);
    const double *values = imki_field_values(field, triad);
    const double *sigmas = is_direction ? NULL : imki_field_sigmas(field, triad);
    imki_write_text(writer, "[");
    for (int i = 0; i < triad->axis_count; i++) {
        char text[VALUE_SIZE];
        numbers n = {values + i * length, sigmas ? sigmas + i * length : NULL,
                     (size_t)length,      false,
                     field->si[kind],     field->flags,
                     IMK_DENSITY_UNSTATED};
        format_numbers(writer, &n, field->unit[kind], text);
        imki_write_text(writer, i > 0 ? ", " : "");
        write_quantity(writer, text);
    }
    imki_write_text(writer, "]");
}

static void write_temperatures(imki_writer *writer, const char *key, const double *values,
                               size_t count)
{
    char text[VALUE_SIZE];
    numbers n = {values, NULL, count, false, "K", 0, IMK_DENSITY_UNSTATED};
    format_numbers(writer, &n, "degC", text);
    imki_write_key(writer, key);
    imki_write_text(writer, " ");
    write_quantity(writer, text);
    imki_write_text(writer, ", ");
}

static void write_polynomial(imki_writer *writer, const imki_field *field, int kind,
                             const imk_triad *triad)
{
    const imk_temperature_polynomial *polynomial =
        (const imk_temperature_polynomial *)(const void *)((const char *)triad + field->offset);
    const double range[2] = {polynomial->minimum, polynomial->maximum};
    imki_write_text(writer, "{");
    write_temperatures(writer, "reference_temperature", &polynomial->reference, 1);
    write_temperatures(writer, "valid_range", range, 2);
    imki_write_key(writer, "coefficients");
    for (int i = 0; i < polynomial->order; i++) {
        char text[VALUE_SIZE];
        numbers n = {polynomial->coefficient[i].value,
                     polynomial->coefficient[i].sigma,
                     (size_t)triad->axis_count,
                     true,
                     imki_polynomial_si(field, kind, i + 1),
                     0,
                     IMK_DENSITY_UNSTATED};
        format_numbers(writer, &n, imki_polynomial_unit(field, kind, i + 1), text);
        imki_write_text(writer, i > 0 ? ", " : " [");
        write_quantity(writer, text);
    }
    imki_write_text(writer, "]}");
}

void imki_write_element(imki_writer *writer, const imki_field *field, int kind,
                        const imk_triad *triad, int index)
{
    imki_list list = imki_list_of(field);
    const void *element = imki_list_element(field, triad, index);
    imki_write_text(writer, "{");
    for (size_t j = 0; j < list.field_count; j++) {
        imki_write_text(writer, j > 0 ? ", " : "");
        imki_write_key(writer, list.field[j].path[kind]);
        imki_write_text(writer, " ");
        write_axes(writer, &list.field[j], kind, element, triad);
    }
    imki_write_text(writer, "}");
}

static void write_list(imki_writer *writer, const imki_field *field, int kind,
                       const imk_triad *triad)
{
    int count = imki_list_count(field, triad);
    imki_write_text(writer, "[");
    for (int i = 0; i < count; i++) {
        imki_write_text(writer, i > 0 ? ", " : "");
        imki_write_element(writer, field, kind, triad, i);
    }
    imki_write_text(writer, "]");
}

static void write_interval_numbers(imki_writer *writer, const imki_field *field, int kind,
                                   const imk_axes *axes, const imk_triad *triad)
{
    char text[VALUE_SIZE];
    numbers n = {axes->value,     NULL,         (size_t)triad->axis_count, true,
                 field->si[kind], field->flags, triad->noise.density};
    format_numbers(writer, &n, usual_unit(field, kind, triad->noise.density), text);
    write_quantity(writer, text);
}

/* "noise.gauss_markov.sigma", instance 1: "noise.gauss_markov[1].sigma". */
static void interval_key(const imk_interval *interval, const imki_field *list, char *key)
{
    const char *last = list ? strrchr(interval->key, '.') : NULL;
    if (last)
        snprintf(key, KEY_SIZE, "%.*s[%d]%s", (int)(last - interval->key), interval->key,
                 interval->instance, last);
    else
        snprintf(key, KEY_SIZE, "%s", interval->key);
}

/* Key and interval of one entry of interval_95 or upper_bound. */
void imki_write_interval(imki_writer *writer, const imk_interval *interval, int kind,
                         const imk_triad *triad, bool is_bound)
{
    char key[KEY_SIZE];
    const imki_field *list;
    const imki_field *field = imki_field_find(interval->key, kind, &list);
    interval_key(interval, list, key);
    imki_write_key(writer, key);
    imki_write_text(writer, is_bound ? " " : " [");
    if (!is_bound) {
        write_interval_numbers(writer, field, kind, &interval->lower, triad);
        imki_write_text(writer, ", ");
    }
    write_interval_numbers(writer, field, kind, &interval->upper, triad);
    imki_write_text(writer, is_bound ? "" : "]");
}

static void write_intervals(imki_writer *writer, const imki_item *item, const imk_model *model)
{
    const imk_evidence *evidence = imki_evidence_of(model, item->kind);
    const imk_triad *triad = imk_model_triad(model, item->kind);
    bool is_first = true;
    imki_write_text(writer, "{");
    for (int i = 0; i < evidence->interval_count; i++) {
        const imk_interval *interval = &evidence->interval[i];
        if (imki_is_bound(interval, triad->axis_count) != item->is_bound)
            continue;
        imki_write_text(writer, is_first ? "" : ", ");
        imki_write_interval(writer, interval, item->kind, triad, item->is_bound);
        is_first = false;
    }
    imki_write_text(writer, "}");
}

static void write_field_value(imki_writer *writer, const imki_item *item, const imk_model *model)
{
    const imki_field *field = item->field;
    const imk_triad *triad = imk_model_triad(model, item->kind);
    switch (field->shape) {
    case IMKI_DENSITY:
        imki_write_text_value(writer, triad->noise.density == IMK_DENSITY_ONE_SIDED ? "one-sided"
                                                                                    : "two-sided");
        break;
    case IMKI_POLYNOMIAL:
        write_polynomial(writer, field, item->kind, triad);
        break;
    case IMKI_LIST:
        write_list(writer, field, item->kind, triad);
        break;
    case IMKI_SCALAR:
    case IMKI_AXES:
        write_axes(writer, field, item->kind, triad, triad);
        break;
    case IMKI_OFF_DIAGONAL:
        if (triad->axis_count == 3) {
            write_off_diagonal(writer, field, item->kind, triad);
            break;
        }
        /* fall through */
    default:
        write_rows(writer, field, item->kind, triad);
        break;
    }
}

void imki_write_item_value(imki_writer *writer, const imki_item *item, const imk_model *model)
{
    bool is_quantity = item->type == IMKI_ITEM_FIELD || item->type == IMKI_ITEM_TIMING;
    const char *kept = is_quantity ? kept_text(writer, item, model) : NULL;
    if (kept) {
        write_quantity(writer, kept);
        return;
    }
    switch (item->type) {
    case IMKI_ITEM_TEXT:
        imki_write_text_value(writer, (const char *)model + item->offset);
        break;
    case IMKI_ITEM_SENSOR:
        imki_write_text(writer, "{}");
        break;
    case IMKI_ITEM_CORRELATION:
        imki_write_correlation(writer, &model->correlation);
        break;
    case IMKI_ITEM_INTERVALS:
        write_intervals(writer, item, model);
        break;
    case IMKI_ITEM_TIMING: {
        const imk_triad one_axis = {.axis_count = 1};
        write_axes(writer, item->field, 0, &model->timing, &one_axis);
        break;
    }
    default:
        write_field_value(writer, item, model);
        break;
    }
}
