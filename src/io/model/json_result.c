/* SPDX-License-Identifier: Apache-2.0 */
/* JSON that is there already, such as that of a model, as data of a result. */
#include "document_internal.h"

#include "report/result_internal.h"

#include "imukit/decimal.h"
#include "imukit/model_file.h"

#include <stdlib.h>
#include <string.h>

static void add_scalar(imk_result *result, const char *key, const imki_node *node)
{
    const char *end = node->text + node->length, *stop;
    const bool integer = node->text[strspn(node->text, "-0123456789")] == '\0';
    double value;
    if (!node->is_plain)
        imk_result_text(result, key, node->text);
    else if (strcmp(node->text, "true") == 0 || strcmp(node->text, "false") == 0)
        imk_result_flag(result, key, node->text[0] == 't');
    else if (stop = imk_decimal_parse(node->text, end, &value), stop != end || node->length == 0)
        imk_result_null(result, key);
    else if (integer && value > -9e15 && value < 9e15)
        imk_result_count(result, key, (long long)value);
    else
        imk_result_number(result, key, value);
}

/* A document is 16 levels deep at most. */
static void add_node(imk_result *result, const char *key, const imk_document *document, int index)
{
    const imki_node *node = &document->node[index];
    if (node->kind == IMKI_NODE_SCALAR) {
        add_scalar(result, key, node);
        return;
    }
    const bool object = node->kind == IMKI_NODE_MAPPING;
    if (object)
        imk_result_object(result, key);
    else
        imk_result_array(result, key);
    for (int i = node->first; i != IMKI_NONE; i = document->node[i].next) {
        const char *name = NULL;
        if (object) {
            name = imki_arena_text(&result->arena, document->node[i].text);
            i = document->node[i].next;
        }
        add_node(result, name, document, i);
    }
    imk_result_end(result);
}

bool imk_result_json(imk_result *result, const char *key, const char *text)
{
    imk_document *document;
    imk_error error;
    if (!result)
        return true;
    const imk_status status =
        imki_document_parse_as("JSON", "{", text, strlen(text), &document, &error);
    if (status == IMK_ERROR_MEMORY)
        result->arena.failed = true;
    if (status != IMK_OK) {
        imk_result_null(result, key);
        return status == IMK_ERROR_MEMORY;
    }
    add_node(result, key, document, 0);
    imk_document_free(document);
    return true;
}
