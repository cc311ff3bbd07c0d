/* SPDX-License-Identifier: Apache-2.0 */
/* Changing a model file so that it says another model, touching nothing else: find the first item
 * that differs, exchange, add or remove its text, read the result again, and so on until nothing
 * differs. Reading again after each step costs little and keeps every step simple. What this
 * cannot do (another number of axes, unusual layouts) is left to writing the file anew. */
#include "model_yaml_internal.h"

#include <stdlib.h>
#include <string.h>

enum { STEPS_MAX = 500 };

/* Replace bytes [begin, end) of the document's text. */
static imk_status splice(const imk_document *document, size_t begin, size_t end,
                         const imki_writer *insert, char **text, size_t *size)
{
    if (insert->failed)
        return IMK_ERROR_MEMORY;
    char *made = malloc(document->size - (end - begin) + insert->size + 1);
    if (!made)
        return IMK_ERROR_MEMORY;
    memcpy(made, document->text, begin);
    if (insert->size > 0)
        memcpy(made + begin, insert->bytes, insert->size);
    memcpy(made + begin + insert->size, document->text + end, document->size - end);
    *size = document->size - (end - begin) + insert->size;
    made[*size] = '\0';
    *text = made;
    return IMK_OK;
}

static const imki_node *node_at(const imk_document *document, int node)
{
    return &document->node[node];
}

/* Beginning of the line, when only blanks stand before `begin`; SIZE_MAX otherwise. */
static size_t line_start(const imk_document *document, size_t begin)
{
    while (begin > 0 && document->text[begin - 1] == ' ')
        begin--;
    return begin == 0 || document->text[begin - 1] == '\n' ? begin : SIZE_MAX;
}

/* Beginning of the line after the node, comments behind it skipped. */
static size_t next_line(const imk_document *document, int node)
{
    size_t end = imki_document_end(document, node);
    if (end > 0 && end > node_at(document, node)->begin && document->text[end - 1] == '\n')
        return end; /* a text block: its end is the line's */
    const char *newline = memchr(document->text + end, '\n', document->size - end);
    return newline ? (size_t)(newline - document->text) + 1 : document->size;
}

/* ---- removing -------------------------------------------------------------------------------- */

static int previous_value(const imk_document *document, int key)
{
    int value = IMKI_NONE;
    for (int i = node_at(document, node_at(document, key)->parent)->first; i != key;
         i = node_at(document, value)->next)
        value = node_at(document, i)->next;
    return value;
}

static imk_status remove_entry(const imk_document *document, int value, char **text, size_t *size)
{
    const imki_writer nothing = {.bytes = NULL};
    int key = node_at(document, value)->key;
    if (key == IMKI_NONE)
        return IMK_ERROR_UNSUPPORTED;
    int parent = node_at(document, value)->parent;
    const imki_node *mapping = node_at(document, parent);
    if (mapping->count == 2) {
        bool is_sensor = mapping->parent == 0;
        if (!is_sensor)
            return remove_entry(document, parent, text, size);
        imki_writer braces = {.bytes = NULL};
        imki_write_text(&braces, "{}");
        size_t end = mapping->is_flow ? mapping->end : imki_document_end(document, parent);
        imk_status status = splice(document, mapping->begin, end, &braces, text, size);
        free(braces.bytes);
        return status;
    }
    if (!mapping->is_flow) {
        size_t begin = line_start(document, node_at(document, key)->begin);
        if (begin == SIZE_MAX)
            return IMK_ERROR_UNSUPPORTED;
        return splice(document, begin, next_line(document, value), &nothing, text, size);
    }
    int next_key = node_at(document, value)->next;
    if (next_key != IMKI_NONE)
        return splice(document, node_at(document, key)->begin, node_at(document, next_key)->begin,
                      &nothing, text, size);
    return splice(document, imki_document_end(document, previous_value(document, key)),
                  imki_document_end(document, value), &nothing, text, size);
}

/* ---- adding ---------------------------------------------------------------------------------- */

/* Place of a path in the order of writing. */
static size_t rank_of(const char *path)
{
    imki_item item;
    size_t length = strlen(path);
    for (size_t i = 0; imki_item_at(i, &item); i++)
        if (strncmp(item.path, path, length) == 0 &&
            (item.path[length] == '\0' || item.path[length] == '.'))
            return i;
    return 0; /* imukit: 1 and whatever else comes first */
}

/* Last entry of a mapping that comes before an item of this rank; IMKI_NONE when none does. */
static int entry_before(const imk_document *document, int mapping, size_t rank)
{
    int before = IMKI_NONE;
    for (int key = node_at(document, mapping)->first; key != IMKI_NONE;) {
        char path[96];
        int value = node_at(document, key)->next;
        imki_document_path(document, value, path, sizeof path);
        if (rank_of(path) < rank || strcmp(path, "imukit") == 0)
            before = value;
        key = node_at(document, value)->next;
    }
    return before;
}

/* The item with the groups that are missing around it, as an entry of `mapping`. */
static void write_entry(imki_writer *writer, const imk_document *document, int mapping,
                        size_t index, const imki_item *item, const imk_model *model)
{
    char path[96];
    imki_document_path(document, mapping, path, sizeof path);
    size_t components = path[0] ? 1 : 0;
    for (const char *c = path; *c; c++)
        components += *c == '.';
    size_t last = index + 1;
    if (item->type == IMKI_ITEM_SENSOR) { /* with everything that is in it */
        imki_item other;
        while (imki_item_at(last, &other) && other.kind == item->kind &&
               other.type != IMKI_ITEM_SENSOR && other.type != IMKI_ITEM_TIMING)
            last++;
    }
    imki_write_items(writer, model, index, last, components);
}

static imk_status add_to_block(const imk_document *document, int mapping, int before,
                               imki_writer *entry, char **text, size_t *size)
{
    size_t place = before == IMKI_NONE ? line_start(document, node_at(document, mapping)->begin)
                                       : next_line(document, before);
    if (place == SIZE_MAX)
        return IMK_ERROR_UNSUPPORTED;
    bool line_is_open = place > 0 && document->text[place - 1] != '\n';
    imki_writer insert = {.bytes = NULL};
    imki_write_text(&insert, line_is_open ? "\n" : "");
    imki_write_bytes(&insert, entry->bytes, entry->size);
    imk_status status = splice(document, place, place, &insert, text, size);
    free(insert.bytes);
    return status;
}

static imk_status add_to_flow(const imk_document *document, int mapping, int before,
                              imki_writer *entry, char **text, size_t *size)
{
    const imki_node *node = node_at(document, mapping);
    size_t place = before != IMKI_NONE ? imki_document_end(document, before)
                   : node->count > 0   ? node_at(document, node->first)->begin
                                       : node->begin + 1;
    imki_writer insert = {.bytes = NULL};
    imki_write_text(&insert, before != IMKI_NONE ? ", " : "");
    imki_write_bytes(&insert, entry->bytes, entry->size);
    imki_write_text(&insert, before == IMKI_NONE && node->count > 0 ? ", " : "");
    imk_status status = splice(document, place, place, &insert, text, size);
    free(insert.bytes);
    return status;
}

static imk_status add_item(const imk_document *document, int mapping, size_t index,
                           const imki_item *item, const imk_model *model, char **text, size_t *size)
{
    const imki_node *node = node_at(document, mapping);
    if (node->kind != IMKI_NODE_MAPPING)
        return IMK_ERROR_UNSUPPORTED;
    imki_writer entry = {.layout = node->is_flow ? IMKI_LINE : IMKI_BLOCK,
                         .is_json = document->is_json,
                         .is_first = true};
    if (!node->is_flow)
        entry.indent = (int)node_at(document, node->first)->column - 1;
    write_entry(&entry, document, mapping, index, item, model);
    int before = entry_before(document, mapping, index);
    imk_status status = entry.failed ? IMK_ERROR_MEMORY
                        : node->is_flow
                            ? add_to_flow(document, mapping, before, &entry, text, size)
                            : add_to_block(document, mapping, before, &entry, text, size);
    free(entry.bytes);
    return status;
}

/* ---- exchanging ------------------------------------------------------------------------------ */

/* Unit in which the value stands in the file, of its first row if it has several. */
static bool unit_in_file(const imk_document *document, int node, const imki_item *item,
                         imk_unit *unit)
{
    while (node != IMKI_NONE && node_at(document, node)->kind == IMKI_NODE_SEQUENCE)
        node = node_at(document, node)->first;
    if (node == IMKI_NONE || node_at(document, node)->kind != IMKI_NODE_SCALAR || !item->field ||
        !item->field->si[item->kind])
        return false;
    double values[IMK_AXES_MAX], sigmas[IMK_AXES_MAX];
    size_t count;
    return imki_parse_quantity(node_at(document, node)->text, node_at(document, node)->length,
                               item->field->si[item->kind], item->field->flags, IMK_AXES_MAX,
                               values, sigmas, &count, unit, NULL) == IMK_OK;
}

static imk_status exchange_value(const imk_document *document, int node, const imki_item *item,
                                 const imk_model *model, char **text, size_t *size)
{
    imk_unit unit;
    imki_writer value = {.layout = IMKI_LINE, .is_json = document->is_json, .is_first = true};
    if (unit_in_file(document, node, item, &unit))
        value.unit = &unit;
    imki_write_item_value(&value, item, model);
    imk_status status = splice(document, node_at(document, node)->begin,
                               node_at(document, node)->end, &value, text, size);
    free(value.bytes);
    return status;
}

/* The entry that states bias_instability by its other name. */
static int floor_entry(const imk_document *document, const imki_item *item)
{
    static const char *const paths[IMK_KINDS] = {
        "gyro.noise.allan_floor", "accel.noise.allan_floor", "mag.noise.allan_floor"};
    bool complete = false;
    bool is_instability = item->type == IMKI_ITEM_FIELD &&
                          strcmp(item->field->path[item->kind], "noise.bias_instability") == 0;
    int node = imki_document_find(document, 0, paths[item->kind], &complete);
    return is_instability && complete ? node : IMKI_NONE;
}

/* One step towards the model. */
static imk_status change_item(const imk_document *document, size_t index, const imki_item *item,
                              const imk_model *model, char **text, size_t *size)
{
    bool complete, is_absent = imki_item_absent(item, model);
    int node = imki_document_find(document, 0, item->path, &complete);
    int other_name = floor_entry(document, item);
    if (other_name != IMKI_NONE)
        return remove_entry(document, other_name, text, size);
    if (!complete)
        return is_absent ? IMK_ERROR_UNSUPPORTED
                         : add_item(document, node, index, item, model, text, size);
    const imki_node *n = node_at(document, node);
    if (is_absent || (n->kind != IMKI_NODE_SCALAR && !n->is_flow))
        return remove_entry(document, node, text, size);
    return exchange_value(document, node, item, model, text, size);
}

static bool first_difference(const imk_model *a, const imk_model *b, size_t *index, imki_item *item)
{
    for (*index = 0; imki_item_at(*index, item); ++*index)
        if (!imki_item_equal(item, a, b))
            return true;
    return false;
}

static bool same_axes(const imk_model *a, const imk_model *b)
{
    for (int kind = 0; kind < IMK_KINDS; kind++) {
        const imk_triad *x = imk_model_triad(a, kind), *y = imk_model_triad(b, kind);
        if (x->present && y->present && x->axis_count != y->axis_count)
            return false;
    }
    return true;
}

imk_status imki_edit_document(const imk_document *document, const imk_model *model, char **text,
                              size_t *size)
{
    imk_document *made = NULL;
    const imk_document *current = document;
    imki_item item;
    size_t index;
    imk_status status = same_axes(&document->model, model) ? IMK_OK : IMK_ERROR_UNSUPPORTED;
    int steps = 0;
    while (status == IMK_OK && first_difference(&current->model, model, &index, &item)) {
        char *step_text = NULL;
        size_t step_size = 0;
        imk_document *next = NULL;
        status = steps++ < STEPS_MAX
                     ? change_item(current, index, &item, model, &step_text, &step_size)
                     : IMK_ERROR_UNSUPPORTED;
        if (status == IMK_OK)
            status = imki_document_open(step_text, step_size, false, &next, NULL);
        free(step_text);
        if (status != IMK_OK)
            break;
        imk_document_free(made);
        made = next;
        current = made;
    }
    if (status == IMK_OK) {
        const imki_writer nothing = {.bytes = NULL};
        status = splice(current, 0, 0, &nothing, text, size);
    }
    imk_document_free(made);
    return status == IMK_OK || status == IMK_ERROR_MEMORY ? status : IMK_ERROR_UNSUPPORTED;
}
