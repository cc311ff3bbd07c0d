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

static void read_parameters(imki_reading *r, int node, imk_correlation *into)
{
    const imki_node *nodes = r->document->node, *list = &nodes[node];
    if (list->kind != IMKI_NODE_SEQUENCE || list->count < 1 || list->count > IMK_CORRELATED_MAX) {
        imki_refuse_value(r, node, IMK_ERROR_SYNTAX,
                          "a list of 1 to 64 parameters, like accel.bias.fixed.x");
        return;
    }
    for (int child = list->first; child != IMKI_NONE; child = nodes[child].next, into->count++)
        if (nodes[child].kind != IMKI_NODE_SCALAR ||
            imk_model_parameter_parse(nodes[child].text, &into->parameter[into->count]) != IMK_OK)
            imki_refuse_value(r, child, IMK_ERROR_KEY_UNKNOWN,
                              "a number of the model: sensor, key and axis, like "
                              "accel.bias.fixed.x or gyro.misalignment.x.y");
}

/* `count` numbers separated by blanks, and nothing else. */
static bool parse_row(const imki_node *row, int count, float *value)
{
    const char *text = row->text, *end = row->text + row->length;
    for (int k = 0; k < count; k++) {
        double number;
        text += strspn(text, " ");
        const char *behind = imk_decimal_parse(text, end, &number);
        if (behind == text || (behind < end && *behind != ' '))
            return false;
        value[k] = (float)number;
        text = behind;
    }
    return text + strspn(text, " ") == end;
}

static void read_values(imki_reading *r, int node, imk_correlation *into)
{
    const imki_node *nodes = r->document->node, *list = &nodes[node];
    if (list->kind != IMKI_NODE_SEQUENCE || list->count != into->count - 1) {
        imki_refuse_value(r, node, IMK_ERROR_SYNTAX,
                          "a list with a row for each parameter but the first");
        return;
    }
    for (int i = 1, child = list->first; i < into->count; i++, child = nodes[child].next) {
        char expected[96];
        snprintf(expected, sizeof expected,
                 "a row of %d number%s: the correlations with the parameters before it", i,
                 i == 1 ? "" : "s");
        if (nodes[child].kind != IMKI_NODE_SCALAR ||
            !parse_row(&nodes[child], i, &into->value[i * (i - 1) / 2]))
            imki_refuse_value(r, child, IMK_ERROR_SYNTAX, expected);
    }
}

void imki_read_correlation(imki_reading *r, imk_correlation *correlation)
{
    static const char *const names[] = {"parameters", "values"};
    static const char what[] = "a mapping with parameters and values";
    const int node = imki_document_value(r->document, 0, "correlation");
    int parameters, values;
    if (node == IMKI_NONE || !imki_value_require(r, node, IMKI_NODE_MAPPING, what))
        return;
    imki_value_keys(r, node, 2, names);
    if (!imki_value_find(r, node, names[0], what, &parameters) ||
        !imki_value_find(r, node, names[1], what, &values))
        return;
    imk_correlation read = {.count = 0};
    read_parameters(r, parameters, &read);
    read_values(r, values, &read);
    if (r->status == IMK_OK)
        *correlation = read;
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
