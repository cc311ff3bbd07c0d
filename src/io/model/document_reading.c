/* SPDX-License-Identifier: Apache-2.0 */
/* Values of a document as what they should be, and what is said of those that are not. */
#include "document_internal.h"

#include "base/nearest_name_internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void imki_value_refuse(imki_reading *r, int node, imk_status status, const char *found,
                       const char *expected)
{
    if (r->status == IMK_OK)
        r->status = imki_document_error(r->document, node, status, found, expected, r->error);
}

void imki_refuse_value(imki_reading *r, int node, imk_status status, const char *expected)
{
    const imki_node *n = &r->document->node[node];
    imki_value_refuse(r, node, status, n->kind == IMKI_NODE_SCALAR ? n->text : "", expected);
}

/* `did you mean "bias"?`, or all names that fit, with so much room behind them. */
static void expect_one_of(const char *name, size_t count, const char *const *names, size_t room,
                          char *expected, size_t size)
{
    const size_t nearest = imki_nearest_name(name, count, names);
    if (nearest != SIZE_MAX) {
        snprintf(expected, size, "did you mean \"%s\"?", names[nearest]);
        return;
    }
    size_t length = (size_t)snprintf(expected, size, "one of");
    for (size_t i = 0; i < count && length + strlen(names[i]) + room < size; i++)
        length +=
            (size_t)snprintf(expected + length, size - length, "%s %s", i > 0 ? "," : "", names[i]);
}

void imki_refuse_key(imki_reading *r, int key, size_t count, const char *const *names)
{
    char expected[sizeof r->error->expected];
    const char *name = r->document->node[key].text;
    expect_one_of(name, count, names, 8, expected, sizeof expected);
    imki_value_refuse(r, key, IMK_ERROR_KEY_UNKNOWN, name, expected);
}

void imki_refuse_name(imki_reading *r, int node, const char *name, const char *found, size_t count,
                      const char *const *names)
{
    char expected[sizeof r->error->expected];
    expect_one_of(name, count, names, 3, expected, sizeof expected);
    imki_value_refuse(r, node, IMK_ERROR_NAME_UNKNOWN, found, expected);
}

bool imki_value_require(imki_reading *r, int node, imki_node_kind kind, const char *expected)
{
    if (r->document->node[node].kind != kind)
        imki_refuse_value(r, node, IMK_ERROR_SYNTAX, expected);
    return r->status == IMK_OK;
}

void imki_value_text(imki_reading *r, int node, char *text, size_t size)
{
    text[0] = '\0';
    if (node == IMKI_NONE || !imki_value_require(r, node, IMKI_NODE_SCALAR, "a text"))
        return;
    const imki_node *n = &r->document->node[node];
    if (n->length >= size) {
        char expected[48];
        snprintf(expected, sizeof expected, "a text of at most %zu bytes", size - 1);
        imki_value_refuse(r, node, IMK_ERROR_RANGE, n->text, expected);
    } else {
        memcpy(text, n->text, n->length + 1);
    }
}

void imki_value_name(imki_reading *r, const char *key, char *text, size_t size)
{
    imki_value_text(r, imki_document_value(r->document, 0, key), text, size);
}

void imki_value_keys(imki_reading *r, int mapping, size_t count, const char *const *names)
{
    const imki_node *nodes = r->document->node;
    for (int key = nodes[mapping].first; key != IMKI_NONE && r->status == IMK_OK;
         key = nodes[nodes[key].next].next) {
        size_t i = 0;
        while (i < count && strcmp(names[i], nodes[key].text) != 0)
            i++;
        if (i == count)
            imki_refuse_key(r, key, count, names);
    }
}

void imki_value_version(imki_reading *r, const char *key)
{
    const int node = imki_document_value(r->document, 0, key);
    char expected[64];
    snprintf(expected, sizeof expected, "write %s: 1, the version of the format", key);
    if (node == IMKI_NONE)
        imki_value_refuse(r, 0, IMK_ERROR_KEY_MISSING, "", expected);
    else if (r->document->node[node].kind != IMKI_NODE_SCALAR ||
             strcmp(r->document->node[node].text, "1") != 0)
        imki_refuse_value(r, node, IMK_ERROR_VERSION, "version 1 of the format");
}

bool imki_value_find(imki_reading *r, int mapping, const char *key, const char *expected, int *node)
{
    *node = imki_document_value(r->document, mapping, key);
    if (*node == IMKI_NONE)
        imki_value_refuse(r, mapping, IMK_ERROR_KEY_MISSING, key, expected);
    return r->status == IMK_OK;
}

const char *const imki_yes_no[6] = {"yes", "true", "on", "no", "false", "off"};

void imki_value_choice(imki_reading *r, int node, const char *const words[6], const char *expected,
                       bool *value)
{
    if (!imki_value_require(r, node, IMKI_NODE_SCALAR, expected))
        return;
    for (int i = 0; i < 6; i++)
        if (words[i] && strcmp(words[i], r->document->node[node].text) == 0) {
            *value = i < 3;
            return;
        }
    imki_refuse_value(r, node, IMK_ERROR_SYNTAX, expected);
}

size_t imki_value_count(imki_reading *r, int node, size_t least, size_t most, const char *expected)
{
    const imki_node *n = &r->document->node[node];
    char *end = NULL;
    const bool digits = n->kind == IMKI_NODE_SCALAR && n->text[0] >= '1' && n->text[0] <= '9';
    const size_t count = digits ? strtoul(n->text, &end, 10) : 0;
    if (!digits || *end != '\0' || count < least || count > most)
        imki_refuse_value(r, node, IMK_ERROR_SYNTAX, expected);
    return count;
}
