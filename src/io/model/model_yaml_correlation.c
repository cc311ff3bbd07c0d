/* SPDX-License-Identifier: Apache-2.0 */
/* The correlation of a model file: which parameters, and the lower triangle of their correlations
 * row by row.
 *
 * Correlations are written to six decimals. The covariance they give with the sigmas then differs
 * from the one estimated by less than 1e-6 of the sigmas, far less than a covariance is ever known
 * to, and stays positive definite unless parameters were told apart by less than that. */
#include "model_yaml_internal.h"

#include "imukit/decimal.h"
#include "imukit/model_parameter.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { DECIMALS = 6, NUMBER_SIZE = 16, ROW_SIZE = IMK_CORRELATED_MAX * NUMBER_SIZE };

static double written_value(float value)
{
    return floor(fabs((double)value) * 1e6 + 0.5) * (value < 0 ? -1.0 : 1.0);
}

bool imki_correlation_equal(const imk_correlation *a, const imk_correlation *b)
{
    if (a->count != b->count ||
        memcmp(a->parameter, b->parameter, (size_t)a->count * sizeof *a->parameter) != 0)
        return false;
    for (int k = 0; k < a->count * (a->count - 1) / 2; k++)
        if (written_value(a->value[k]) != written_value(b->value[k]))
            return false;
    return true;
}

/* ---- reading --------------------------------------------------------------------------------- */

static const imki_node *node_at(const imk_document *document, int node)
{
    return &document->node[node];
}

static imk_status fail(const imk_document *document, int node, imk_status status,
                       const char *expected, imk_error *error)
{
    const imki_node *n = node_at(document, node);
    return imki_document_error(document, node, status, n->kind == IMKI_NODE_SCALAR ? n->text : "",
                               expected, error);
}

static imk_status read_parameters(const imk_document *document, int node, imk_correlation *into,
                                  imk_error *error)
{
    const imki_node *list = node_at(document, node);
    if (list->kind != IMKI_NODE_SEQUENCE || list->count < 1 || list->count > IMK_CORRELATED_MAX)
        return fail(document, node, IMK_ERROR_SYNTAX,
                    "a list of 1 to 64 parameters, like accel.bias.fixed.x", error);
    for (int child = list->first; child != IMKI_NONE; child = node_at(document, child)->next) {
        const imki_node *name = node_at(document, child);
        if (name->kind != IMKI_NODE_SCALAR ||
            imk_model_parameter_parse(name->text, &into->parameter[into->count]) != IMK_OK)
            return fail(document, child, IMK_ERROR_KEY_UNKNOWN,
                        "a number of the model: sensor, key and axis, like accel.bias.fixed.x or "
                        "gyro.misalignment.x.y",
                        error);
        into->count++;
    }
    return IMK_OK;
}

/* One row: `count` numbers separated by blanks. */
static imk_status read_row(const imk_document *document, int node, int count, float *value,
                           imk_error *error)
{
    char expected[96];
    snprintf(expected, sizeof expected, "a row of %d number%s, with the parameters before it",
             count, count == 1 ? "" : "s");
    const imki_node *row = node_at(document, node);
    if (row->kind != IMKI_NODE_SCALAR)
        return fail(document, node, IMK_ERROR_SYNTAX, expected, error);
    const char *text = row->text, *end = row->text + row->length;
    for (int k = 0; k < count; k++) {
        double number;
        while (*text == ' ')
            text++;
        const char *behind = imk_decimal_parse(text, end, &number);
        if (behind == text || (behind < end && *behind != ' '))
            return fail(document, node, IMK_ERROR_SYNTAX, expected, error);
        value[k] = (float)number;
        text = behind;
    }
    while (*text == ' ')
        text++;
    return text == end ? IMK_OK : fail(document, node, IMK_ERROR_SYNTAX, expected, error);
}

static imk_status read_values(const imk_document *document, int node, imk_correlation *into,
                              imk_error *error)
{
    const imki_node *list = node_at(document, node);
    if (list->kind != IMKI_NODE_SEQUENCE || list->count != into->count - 1)
        return fail(document, node, IMK_ERROR_SYNTAX,
                    "a list with a row for each parameter but the first", error);
    int child = list->first;
    for (int i = 1; i < into->count; i++, child = node_at(document, child)->next) {
        imk_status status = read_row(document, child, i, &into->value[i * (i - 1) / 2], error);
        if (status != IMK_OK)
            return status;
    }
    return IMK_OK;
}

imk_status imki_read_correlation(const imk_document *document, imk_correlation *correlation,
                                 imk_error *error)
{
    static const char *const names[] = {"parameters", "values"};
    static const char what[] = "a mapping with parameters and values";
    const int node = imki_document_value(document, 0, "correlation");
    if (node == IMKI_NONE)
        return IMK_OK;
    if (node_at(document, node)->kind != IMKI_NODE_MAPPING)
        return fail(document, node, IMK_ERROR_SYNTAX, what, error);
    for (int key = node_at(document, node)->first; key != IMKI_NONE;
         key = node_at(document, node_at(document, key)->next)->next)
        if (strcmp(node_at(document, key)->text, names[0]) != 0 &&
            strcmp(node_at(document, key)->text, names[1]) != 0)
            return imki_refuse_name(document, key, 2, names, error);
    const int parameters = imki_document_value(document, node, names[0]);
    const int values = imki_document_value(document, node, names[1]);
    if (parameters == IMKI_NONE || values == IMKI_NONE)
        return imki_document_error(document, node, IMK_ERROR_KEY_MISSING,
                                   names[parameters != IMKI_NONE], what, error);
    imk_correlation read = {.count = 0};
    imk_status status = read_parameters(document, parameters, &read, error);
    if (status == IMK_OK)
        status = read_values(document, values, &read, error);
    if (status == IMK_OK)
        *correlation = read;
    return status;
}

/* ---- writing --------------------------------------------------------------------------------- */

/* "0.12", "-1", "0": without zeros at the end. */
static size_t format_number(float value, char *text)
{
    size_t length = imk_decimal_fixed(written_value(value) / 1e6, DECIMALS, text);
    while (text[length - 1] == '0')
        length--;
    if (text[length - 1] == '.')
        length--;
    text[length] = '\0';
    return length;
}

static void format_row(const imk_correlation *correlation, int i, char text[ROW_SIZE])
{
    size_t length = 0;
    for (int j = 0; j < i; j++) {
        char number[IMK_DECIMAL_SIZE];
        format_number(correlation->value[i * (i - 1) / 2 + j], number);
        length += (size_t)snprintf(text + length, ROW_SIZE - length, "%s%.12s", j > 0 ? " " : "",
                                   strcmp(number, "-0") == 0 ? "0" : number);
    }
}

/* Entry `i` of one of the two lists. */
static void write_entry(imki_writer *writer, const imk_correlation *correlation, bool is_name,
                        int i)
{
    char text[ROW_SIZE], name[IMK_MODEL_PARAMETER_NAME];
    if (is_name) {
        (void)imk_model_parameter_name(correlation->parameter[i], name);
        imki_write_text_value(writer, name);
        return;
    }
    format_row(correlation, i, text);
    if (writer->is_json && i > 1)
        imki_write_quoted(writer, text);
    else
        imki_write_text(writer, text);
}

void imki_write_correlation(imki_writer *writer, const imk_correlation *correlation)
{
    imki_write_text(writer, "{");
    for (int list = 0; list < 2; list++) {
        const int first = list;
        imki_write_text(writer, list > 0 ? ", " : "");
        imki_write_key(writer, list == 0 ? "parameters" : "values");
        imki_write_text(writer, " [");
        for (int i = first; i < correlation->count; i++) {
            imki_write_text(writer, i > first ? ", " : "");
            write_entry(writer, correlation, list == 0, i);
        }
        imki_write_text(writer, "]");
    }
    imki_write_text(writer, "}");
}

void imki_write_correlation_block(imki_writer *writer, const imk_correlation *correlation)
{
    imki_write_text(writer, "\n");
    writer->indent += 2;
    for (int list = 0; list < 2; list++) {
        imki_write_indent(writer);
        imki_write_key(writer, list == 0 ? "parameters" : "values");
        imki_write_text(writer, list == 1 && correlation->count == 1 ? " []\n" : "\n");
        for (int i = list; i < correlation->count; i++) {
            imki_write_indent(writer);
            imki_write_text(writer, "  - ");
            write_entry(writer, correlation, list == 0, i);
            imki_write_text(writer, "\n");
        }
    }
    writer->indent -= 2;
}
