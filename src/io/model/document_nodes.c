/* SPDX-License-Identifier: Apache-2.0 */
/* The nodes of a document: which one a path leads to, where one stands, and the error at one. */
#include "document_internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

imk_status imki_document_error(const imk_document *document, int node, imk_status status,
                               const char *found, const char *expected, imk_error *error)
{
    char path[sizeof error->field];
    imki_document_path(document, node, path, sizeof path);
    imk_error_set(error, status, path, found, expected);
    if (error) {
        error->line = document->node[node].line;
        error->column = document->node[node].column;
    }
    return status;
}

void imki_document_path(const imk_document *document, int node, char *text, size_t size)
{
    int chain[2 * IMKI_DOCUMENT_DEPTH_MAX], depth = 0;
    for (int i = node; i != IMKI_NONE && depth < 2 * IMKI_DOCUMENT_DEPTH_MAX;
         i = document->node[i].parent)
        chain[depth++] = i;
    size_t length = 0;
    text[0] = '\0';
    while (--depth >= 0 && length + 1 < size) {
        const imki_node *n = &document->node[chain[depth]];
        int written = 0;
        if (n->parent == IMKI_NONE)
            continue;
        if (n->key != IMKI_NONE) {
            written = snprintf(text + length, size - length, "%s%s", length > 0 ? "." : "",
                               document->node[n->key].text);
        } else if (document->node[n->parent].kind == IMKI_NODE_SEQUENCE) {
            int index = 0;
            for (int i = document->node[n->parent].first; i != chain[depth];
                 i = document->node[i].next)
                index++;
            written = snprintf(text + length, size - length, "[%d]", index);
        } else { /* a key itself */
            written =
                snprintf(text + length, size - length, "%s%s", length > 0 ? "." : "", n->text);
        }
        length += written > 0 ? (size_t)written : 0;
    }
}

int imki_document_value(const imk_document *document, int mapping, const char *key)
{
    if (mapping == IMKI_NONE || document->node[mapping].kind != IMKI_NODE_MAPPING)
        return IMKI_NONE;
    for (int i = document->node[mapping].first; i != IMKI_NONE;) {
        int value = document->node[i].next;
        if (strcmp(document->node[i].text, key) == 0)
            return value;
        i = value == IMKI_NONE ? IMKI_NONE : document->node[value].next;
    }
    return IMKI_NONE;
}

static int element(const imk_document *document, int sequence, long index)
{
    int child = IMKI_NONE;
    if (document->node[sequence].kind == IMKI_NODE_SEQUENCE)
        for (child = document->node[sequence].first; child != IMKI_NONE && index > 0; index--)
            child = document->node[child].next;
    return child;
}

int imki_document_find(const imk_document *document, int start, const char *path, bool *complete)
{
    int node = start;
    while (*path) {
        char key[64];
        int child;
        size_t length = strcspn(path, ".[");
        if (*path == '[') {
            char *end;
            child = element(document, node, strtol(path + 1, &end, 10));
            length = (size_t)(end - path) + 1;
        } else {
            snprintf(key, sizeof key, "%.*s", (int)length, path);
            child = imki_document_value(document, node, key);
        }
        if (child == IMKI_NONE)
            break;
        node = child;
        path += length;
        if (*path == '.')
            path++;
    }
    if (complete)
        *complete = *path == '\0';
    return node;
}

size_t imki_document_end(const imk_document *document, int node)
{
    while (document->node[node].kind != IMKI_NODE_SCALAR && !document->node[node].is_flow &&
           document->node[node].last != IMKI_NONE)
        node = document->node[node].last;
    return document->node[node].end;
}
