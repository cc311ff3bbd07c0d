/* SPDX-License-Identifier: Apache-2.0 */
/* Foreign parameter files in YAML and JSON: the tree, and the numbers in its nodes. */
#include "parameter_internal.h"

#include "imukit/names.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* OpenCV's own YAML 1.0 begins with a line that is none to YAML 1.1, and marks its matrices. Both
 * become blanks, so that lines and columns stay. */
static void blank_opencv(char *text, size_t size)
{
    static const char tag[] = "!!opencv-matrix";
    if (size < 5 || memcmp(text, "%YAML", 5) != 0)
        return;
    for (size_t i = 0; i < size && text[i] != '\n'; i++)
        text[i] = ' ';
    for (char *at = strstr(text, tag); at; at = strstr(at, tag))
        memset(at, ' ', sizeof tag - 1);
}

/* GLIM's files of JSON have comments, which are none to YAML. Strings stay as they are. Other files
 * may begin with a slash, as those of ROS 2 with their "/ **" do. */
static void blank_comments(char *text, size_t size)
{
    const size_t first = strspn(text, " \t\r\n");
    bool in_string = false;
    if (text[first] != '{')
        return;
    for (size_t i = first; i < size; i++) {
        if (text[i] == '"')
            in_string = !in_string;
        if (in_string && text[i] == '\\')
            i++; /* what it escapes is no end of the string */
        if (in_string || text[i] != '/' || (text[i + 1] != '/' && text[i + 1] != '*'))
            continue;
        const char *stop = strstr(text + i + 2, text[i + 1] == '/' ? "\n" : "*/");
        const size_t end = !stop ? size : (size_t)(stop - text) + (text[i + 1] == '/' ? 0 : 2);
        for (; i < end; i++)
            if (text[i] != '\n')
                text[i] = ' ';
        i--;
    }
}

bool imki_parameters_document(imki_parameters *p)
{
    char *copy = malloc(p->size + 1);
    if (!copy) {
        imki_parameter_refuse(p, IMK_ERROR_MEMORY, "", "", "");
        return false;
    }
    memcpy(copy, p->text, p->size);
    copy[p->size] = '\0';
    blank_opencv(copy, p->size);
    blank_comments(copy, p->size);
    p->status = imki_document_parse(copy, p->size, &p->document, p->error);
    free(copy);
    return p->status == IMK_OK;
}

imki_place imki_node_place(const imki_parameters *p, int node)
{
    const imki_node *n = &p->document->node[node];
    const char *field = n->key != IMKI_NONE ? p->document->node[n->key].text
                        : n->text           ? n->text
                                            : "";
    return (imki_place){field, n->line, n->column};
}

bool imki_node_is(const imki_parameters *p, int node, imki_node_kind kind)
{
    return node != IMKI_NONE && p->document->node[node].kind == kind;
}

const char *imki_node_text(const imki_parameters *p, int node)
{
    return imki_node_is(p, node, IMKI_NODE_SCALAR) ? p->document->node[node].text : "";
}

int imki_node_value(const imki_parameters *p, int mapping, const char *key)
{
    return imki_document_value(p->document, mapping, key);
}

int imki_key_after(const imki_parameters *p, int key)
{
    return p->document->node[p->document->node[key].next].next;
}

void imki_refuse_node(imki_parameters *p, int node, imk_status status, const char *found,
                      const char *expected)
{
    if (p->status == IMK_OK)
        p->status = imki_document_error(p->document, node, status, found, expected, p->error);
}

static void node_number(imki_parameters *p, int node, double *value)
{
    const imki_node *n = &p->document->node[node];
    if (n->kind != IMKI_NODE_SCALAR || !imki_number(n->text, n->text + n->length, value))
        imki_refuse_node(p, node, IMK_ERROR_SYNTAX, imki_node_text(p, node),
                         "a number without a unit");
}

void imki_node_numbers(imki_parameters *p, int node, int count, double *values)
{
    const imki_node *n = &p->document->node[node];
    const bool list = n->kind == IMKI_NODE_SEQUENCE && n->count == count;
    if (!list && n->kind != IMKI_NODE_SCALAR) {
        char expected[64];
        snprintf(expected, sizeof expected, "a number, or a list of %d: [1, 2, 3]", count);
        imki_refuse_node(p, node, IMK_ERROR_SYNTAX, "", expected);
        return;
    }
    for (int i = 0, child = list ? n->first : node; i < count && p->status == IMK_OK; i++) {
        node_number(p, child, &values[i]);
        child = list ? p->document->node[child].next : node;
    }
}

void imki_node_matrix(imki_parameters *p, int node, double matrix[3][3])
{
    const imki_node *n = &p->document->node[node];
    if (n->kind != IMKI_NODE_SEQUENCE || n->count != 3) {
        imki_refuse_node(p, node, IMK_ERROR_SYNTAX, "", "a list of three rows");
        return;
    }
    for (int i = 0, row = n->first; i < 3; i++, row = p->document->node[row].next) {
        if (!imki_node_is(p, row, IMKI_NODE_SEQUENCE) || p->document->node[row].count != 3) {
            imki_refuse_node(p, row, IMK_ERROR_SYNTAX, "", "a row of three numbers: [1, 0, 0]");
            return;
        }
        imki_node_numbers(p, row, 3, matrix[i]);
        for (int j = 0; j < 3; j++)
            if (!(fabs(matrix[i][j]) <= 1e6))
                imki_refuse_node(p, row, IMK_ERROR_RANGE, "", "numbers of at most a million");
    }
}

void imki_node_accept(imki_parameters *p, int mapping, const char *key, int kind,
                      imki_quantity quantity, imki_unit unit, double si[3])
{
    const int node = imki_node_value(p, mapping, key);
    double raw[3] = {0};
    if (node == IMKI_NONE)
        return;
    imki_node_numbers(p, node, 3, raw);
    imki_accept(p, imki_node_place(p, node), kind, quantity, raw, unit, si);
}

bool imki_is_one_of(const char *name, size_t count, const char *const *names)
{
    for (size_t i = 0; i < count; i++)
        if (strcmp(name, names[i]) == 0)
            return true;
    return false;
}

void imki_foreign_key(imki_parameters *p, int key, size_t count, const char *const *known)
{
    const char *name = p->document->node[key].text;
    const size_t nearest = imk_nearest_name(name, count, known);
    if (nearest < count) {
        char expected[96];
        snprintf(expected, sizeof expected, "did you mean \"%.64s\"?", known[nearest]);
        imki_refuse_node(p, key, IMK_ERROR_KEY_UNKNOWN, name, expected);
    } else {
        imki_note(p, true, "the key %.80s (line %zu) is not read", name,
                  p->document->node[key].line);
    }
}

void imki_foreign_keys(imki_parameters *p, int mapping, size_t count, const char *const *known)
{
    for (int key = p->document->node[mapping].first; key != IMKI_NONE; key = imki_key_after(p, key))
        if (!imki_is_one_of(p->document->node[key].text, count, known))
            imki_foreign_key(p, key, count, known);
}

int imki_mapping_with(const imk_document *document, int from, size_t count, const char *const *keys)
{
    for (int node = from; node < document->node_count; node++)
        for (size_t i = 0; i < count && document->node[node].kind == IMKI_NODE_MAPPING; i++)
            if (imki_document_value(document, node, keys[i]) != IMKI_NONE)
                return node;
    return IMKI_NONE;
}

int imki_only_mapping_with(imki_parameters *p, size_t count, const char *const *keys)
{
    const int node = imki_mapping_with(p->document, 0, count, keys);
    if (node == IMKI_NONE) {
        char expected[96];
        snprintf(expected, sizeof expected, "a file with %.32s%s%.32s", keys[0],
                 count > 1 ? " or " : "", count > 1 ? keys[1] : "");
        imki_refuse_node(p, 0, IMK_ERROR_KEY_MISSING, keys[0], expected);
        return 0;
    }
    const int other = imki_mapping_with(p->document, node + 1, count, keys);
    if (other != IMKI_NONE)
        imki_refuse_node(p, other, IMK_ERROR_KEY_DUPLICATE, "",
                         "one place with these keys: the file has them in several");
    return node;
}

void imki_note_others(imki_parameters *p, int mapping, size_t count, const char *const *known)
{
    int others = 0;
    for (int key = p->document->node[mapping].first; key != IMKI_NONE; key = imki_key_after(p, key))
        others += p->document->node[key].text[0] != '_' && /* JSON has no other comments */
                  !imki_is_one_of(p->document->node[key].text, count, known);
    if (others > 0)
        imki_note(p, true, "%d other keys (cameras, estimator) are not parameters of the IMU",
                  others);
}
