/* SPDX-License-Identifier: Apache-2.0 */
/* The tree of a model file or a script, built from libyaml's events, so that anchors, aliases, tags
 * and duplicate keys, which a loader would resolve silently, are refused where they stand. */
#include "document_internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <yaml.h>

/* What is needed while the events come in. */
typedef struct builder {
    imk_document *document;
    imk_error *error;
    const char *what; /* "model" */
    size_t *offset;   /* byte of each character: libyaml's marks count characters */
    size_t character_count;
    int capacity, nodes_max;
    int open[IMKI_DOCUMENT_DEPTH_MAX];
    int depth;
} builder;

static imk_status place_error(imk_error *error, imk_status status, size_t line, size_t column,
                              const char *found, const char *expected)
{
    imk_error_set(error, status, "", found, expected);
    if (error) {
        error->line = line;
        error->column = column;
    }
    return status;
}

/* What files of this kind do not have. */
static imk_status kind_error(builder *b, yaml_mark_t mark, const char *found, const char *before,
                             const char *after)
{
    char expected[sizeof b->error->expected];
    snprintf(expected, sizeof expected, "%s%s%s", before, b->what, after);
    return place_error(b->error, IMK_ERROR_UNSUPPORTED, mark.line + 1, mark.column + 1, found,
                       expected);
}

static imk_status mark_error(builder *b, yaml_mark_t mark, imk_status status, const char *found,
                             const char *expected)
{
    return place_error(b->error, status, mark.line + 1, mark.column + 1, found, expected);
}

static size_t byte_of(const builder *b, size_t character)
{
    return b->offset[character < b->character_count ? character : b->character_count];
}

/* Length of the byte order mark that some editors put first; libyaml would count it as a column. */
static size_t mark_length(const imk_document *document)
{
    return document->size >= 3 && memcmp(document->text, "\xEF\xBB\xBF", 3) == 0 ? 3 : 0;
}

/* Byte offset of every character behind the byte order mark, and of the end. */
static imk_status index_characters(builder *b)
{
    const char *text = b->document->text;
    size_t size = b->document->size;
    b->offset = malloc((size + 1) * sizeof *b->offset);
    if (!b->offset)
        return imk_error_set(b->error, IMK_ERROR_MEMORY, "", "", "");
    for (size_t i = mark_length(b->document); i < size; i++)
        if (((unsigned char)text[i] & 0xC0) != 0x80)
            b->offset[b->character_count++] = i;
    b->offset[b->character_count] = size;
    return IMK_OK;
}

static imk_status check_key(builder *b, int key, yaml_mark_t mark)
{
    imk_document *document = b->document;
    const imki_node *node = &document->node[key];
    if (node->kind != IMKI_NODE_SCALAR || node->length == 0)
        return mark_error(b, mark, IMK_ERROR_SYNTAX, "", "a key before the colon");
    for (int i = document->node[node->parent].first; i != key;) {
        const imki_node *other = &document->node[i];
        if (other->length == node->length && memcmp(other->text, node->text, node->length) == 0) {
            char expected[64];
            snprintf(expected, sizeof expected, "the first one is in line %zu", other->line);
            return imki_document_error(document, key, IMK_ERROR_KEY_DUPLICATE, node->text, expected,
                                       b->error);
        }
        i = document->node[other->next].next;
    }
    return IMK_OK;
}

/* Append a node to the innermost open collection. */
static imk_status add_node(builder *b, const yaml_event_t *event, imki_node_kind kind, int *index)
{
    imk_document *document = b->document;
    if (document->node_count == b->nodes_max) {
        char after[48];
        snprintf(after, sizeof after, " file of at most %d values", b->nodes_max);
        return kind_error(b, event->start_mark, "too many values", "a ", after);
    }
    if (document->node_count == b->capacity) {
        int capacity = b->capacity ? 2 * b->capacity : 64;
        imki_node *grown = realloc(document->node, (size_t)capacity * sizeof *grown);
        if (!grown)
            return imk_error_set(b->error, IMK_ERROR_MEMORY, "", "", "");
        document->node = grown;
        b->capacity = capacity;
    }
    int new_node = document->node_count++;
    imki_node *node = &document->node[new_node];
    *node = (imki_node){.kind = kind,
                        .begin = byte_of(b, event->start_mark.index),
                        .end = byte_of(b, event->end_mark.index),
                        .line = event->start_mark.line + 1,
                        .column = event->start_mark.column + 1,
                        .parent = b->depth > 0 ? b->open[b->depth - 1] : IMKI_NONE,
                        .key = IMKI_NONE,
                        .first = IMKI_NONE,
                        .last = IMKI_NONE,
                        .next = IMKI_NONE};
    *index = new_node;
    if (node->parent == IMKI_NONE)
        return IMK_OK;
    imki_node *parent = &document->node[node->parent];
    if (parent->kind == IMKI_NODE_MAPPING && parent->count % 2 == 1)
        node->key = parent->last;
    if (parent->last == IMKI_NONE)
        parent->first = new_node;
    else
        document->node[parent->last].next = new_node;
    parent->last = new_node;
    parent->count++;
    return IMK_OK;
}

static imk_status refuse_extras(builder *b, const yaml_event_t *event, const yaml_char_t *anchor,
                                const yaml_char_t *tag)
{
    if (anchor)
        return kind_error(b, event->start_mark, "an anchor (&)",
                          "write every value out: ", " files have no anchors and aliases");
    if (tag)
        return kind_error(b, event->start_mark, (const char *)tag,
                          "remove the tag: ", " files have none");
    return IMK_OK;
}

static bool is_key_due(const builder *b)
{
    if (b->depth == 0)
        return false;
    const imki_node *parent = &b->document->node[b->open[b->depth - 1]];
    return parent->kind == IMKI_NODE_MAPPING && parent->count % 2 == 0;
}

static imk_status add_scalar(builder *b, const yaml_event_t *event)
{
    imk_status status = refuse_extras(b, event, event->data.scalar.anchor, event->data.scalar.tag);
    bool is_key = is_key_due(b);
    int index = IMKI_NONE;
    if (status == IMK_OK)
        status = add_node(b, event, IMKI_NODE_SCALAR, &index);
    if (status != IMK_OK)
        return status;
    imki_node *node = &b->document->node[index];
    node->length = event->data.scalar.length;
    node->is_plain = event->data.scalar.style == YAML_PLAIN_SCALAR_STYLE;
    node->text = malloc(node->length + 1);
    if (!node->text)
        return imk_error_set(b->error, IMK_ERROR_MEMORY, "", "", "");
    memcpy(node->text, event->data.scalar.value, node->length);
    node->text[node->length] = '\0';
    if (memchr(node->text, '\0', node->length))
        return mark_error(b, event->start_mark, IMK_ERROR_SYNTAX, "a zero character",
                          "a text without zero characters");
    return is_key ? check_key(b, index, event->start_mark) : IMK_OK;
}

static imk_status open_collection(builder *b, const yaml_event_t *event, imki_node_kind kind)
{
    bool is_mapping = kind == IMKI_NODE_MAPPING;
    imk_status status = is_mapping ? refuse_extras(b, event, event->data.mapping_start.anchor,
                                                   event->data.mapping_start.tag)
                                   : refuse_extras(b, event, event->data.sequence_start.anchor,
                                                   event->data.sequence_start.tag);
    if (status != IMK_OK)
        return status;
    if (is_key_due(b))
        return mark_error(b, event->start_mark, IMK_ERROR_SYNTAX, "", "a key before the colon");
    if (b->depth == IMKI_DOCUMENT_DEPTH_MAX)
        return mark_error(b, event->start_mark, IMK_ERROR_UNSUPPORTED, "nested too deeply",
                          "at most 16 levels");
    int index = IMKI_NONE;
    status = add_node(b, event, kind, &index);
    if (status != IMK_OK)
        return status;
    b->document->node[index].is_flow =
        is_mapping ? event->data.mapping_start.style == YAML_FLOW_MAPPING_STYLE
                   : event->data.sequence_start.style == YAML_FLOW_SEQUENCE_STYLE;
    b->open[b->depth++] = index;
    return IMK_OK;
}

static imk_status take_event(builder *b, const yaml_event_t *event)
{
    switch (event->type) {
    case YAML_SCALAR_EVENT:
        return add_scalar(b, event);
    case YAML_SEQUENCE_START_EVENT:
        return open_collection(b, event, IMKI_NODE_SEQUENCE);
    case YAML_MAPPING_START_EVENT:
        return open_collection(b, event, IMKI_NODE_MAPPING);
    case YAML_SEQUENCE_END_EVENT:
    case YAML_MAPPING_END_EVENT:
        if (b->depth > 0) /* as many end as begin */
            b->document->node[b->open[--b->depth]].end = byte_of(b, event->end_mark.index);
        return IMK_OK;
    case YAML_ALIAS_EVENT:
        return kind_error(b, event->start_mark, "an alias (*)",
                          "write every value out: ", " files have no anchors and aliases");
    case YAML_DOCUMENT_START_EVENT:
        if (b->document->node_count > 0)
            return kind_error(b, event->start_mark, "a second document (---)", "put one ",
                              " in a file");
        return IMK_OK;
    default:
        return IMK_OK;
    }
}

static imk_status parser_error(builder *b, const yaml_parser_t *parser)
{
    if (parser->error == YAML_MEMORY_ERROR)
        return imk_error_set(b->error, IMK_ERROR_MEMORY, "", "", "");
    const imk_document *document = b->document;
    if (parser->error == YAML_READER_ERROR) {
        size_t line = 1, column = 1;
        for (size_t i = 0; i < parser->problem_offset + mark_length(document) && i < document->size;
             i++) {
            column = document->text[i] == '\n' ? 1 : column + 1;
            line += document->text[i] == '\n';
        }
        return place_error(b->error, IMK_ERROR_SYNTAX, line, column, "", "a text file in UTF-8");
    }
    size_t byte = byte_of(b, parser->problem_mark.index);
    bool is_tab = byte < document->size && document->text[byte] == '\t';
    return mark_error(b, parser->problem_mark, IMK_ERROR_SYNTAX, "",
                      is_tab ? "indent with blanks, not tabs" : parser->problem);
}

static imk_status build(builder *b)
{
    yaml_parser_t parser;
    if (!yaml_parser_initialize(&parser))
        return imk_error_set(b->error, IMK_ERROR_MEMORY, "", "", "");
    size_t skipped = mark_length(b->document);
    yaml_parser_set_encoding(&parser, YAML_UTF8_ENCODING);
    yaml_parser_set_input_string(&parser, (const unsigned char *)b->document->text + skipped,
                                 b->document->size - skipped);
    imk_status status = IMK_OK;
    for (bool done = false; status == IMK_OK && !done;) {
        yaml_event_t event;
        if (!yaml_parser_parse(&parser, &event)) {
            status = parser_error(b, &parser);
            break;
        }
        done = event.type == YAML_STREAM_END_EVENT;
        status = take_event(b, &event);
        yaml_event_delete(&event);
    }
    yaml_parser_delete(&parser);
    return status;
}

static bool has_quoted_keys(const imk_document *document)
{
    const imki_node *root = &document->node[0];
    return root->is_flow && root->first != IMKI_NONE && !document->node[root->first].is_plain;
}

/* What stands at the head of the file that is due. */
static imk_status check_root(const builder *b, const char *head)
{
    const imk_document *document = b->document;
    char expected[sizeof b->error->expected];
    if (document->node_count == 0) {
        snprintf(expected, sizeof expected, "a %s, beginning with %s", b->what, head);
        return imk_error_set(b->error, IMK_ERROR_EMPTY, "", "", expected);
    }
    if (document->node[0].kind == IMKI_NODE_MAPPING)
        return IMK_OK;
    snprintf(expected, sizeof expected, "a %s file: keys and values, beginning with %s", b->what,
             head);
    return place_error(b->error, IMK_ERROR_FORMAT, document->node[0].line, document->node[0].column,
                       "", expected);
}

imk_status imki_document_parse_as(const char *what, const char *head, const char *text, size_t size,
                                  imk_document **document, imk_error *error)
{
    return imki_document_parse_large(what, head, 1, text, size, document, error);
}

imk_status imki_document_parse_large(const char *what, const char *head, int times,
                                     const char *text, size_t size, imk_document **document,
                                     imk_error *error)
{
    char found[64], expected[64];
    snprintf(expected, sizeof expected, "a %s file", what);
    if (size > (size_t)times * IMKI_DOCUMENT_SIZE_MAX) {
        snprintf(found, sizeof found, "the file is longer than %d MiB", times);
        return imk_error_set(error, IMK_ERROR_UNSUPPORTED, "", found, expected);
    }
    imk_document *made = calloc(1, sizeof *made);
    if (made)
        made->text = malloc(size + 1);
    if (!made || !made->text) {
        imk_document_free(made);
        return imk_error_set(error, IMK_ERROR_MEMORY, "", "", "");
    }
    if (size > 0)
        memcpy(made->text, text, size);
    made->text[size] = '\0';
    made->size = size;
    builder b = {.document = made,
                 .error = error,
                 .what = what,
                 .nodes_max = times * IMKI_DOCUMENT_NODES_MAX};
    imk_status status = index_characters(&b);
    if (status == IMK_OK)
        status = build(&b);
    free(b.offset);
    if (status == IMK_OK)
        status = check_root(&b, head);
    if (status != IMK_OK) {
        imk_document_free(made);
        return status;
    }
    made->is_json = has_quoted_keys(made);
    *document = made;
    return IMK_OK;
}

imk_status imki_document_parse(const char *text, size_t size, imk_document **document,
                               imk_error *error)
{
    return imki_document_parse_as("model", "imukit: 1", text, size, document, error);
}

void imk_document_free(imk_document *document)
{
    if (!document)
        return;
    for (int i = 0; i < document->node_count; i++)
        free(document->node[i].text);
    free(document->node);
    free(document->text);
    free(document);
}
