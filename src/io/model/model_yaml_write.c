/* SPDX-License-Identifier: Apache-2.0 */
/* Writing models in their layouts: YAML by indentation, one line in braces, JSON. */
#include "model_yaml_internal.h"

#include <stdio.h>
#include <string.h>

enum { KEY_SIZE = 64 };

/* What stands before an entry. */
static void begin_entry(imki_writer *writer)
{
    if (writer->layout == IMKI_LINE)
        imki_write_text(writer, writer->is_first ? "" : ", ");
    if (writer->layout == IMKI_LINES)
        imki_write_text(writer, writer->is_first ? "\n" : ",\n");
    if (writer->layout != IMKI_LINE)
        imki_write_indent(writer);
    writer->is_first = false;
}

void imki_open_group(imki_writer *writer, const char *key)
{
    begin_entry(writer);
    imki_write_key(writer, key);
    imki_write_text(writer, writer->layout == IMKI_BLOCK ? "\n" : " {");
    writer->indent += 2;
    writer->is_first = true;
}

void imki_close_group(imki_writer *writer)
{
    writer->indent -= 2;
    if (writer->layout == IMKI_LINES) {
        imki_write_text(writer, "\n");
        imki_write_indent(writer);
    }
    if (writer->layout != IMKI_BLOCK)
        imki_write_text(writer, "}");
    writer->is_first = false;
}

static const char *last_component(const char *path)
{
    const char *dot = strrchr(path, '.');
    return dot ? dot + 1 : path;
}

/* Lists of terms and intervals, one a line below their key. */
static void write_block_list(imki_writer *writer, const imki_item *item, const imk_model *model)
{
    const imk_triad *triad = imk_model_triad(model, item->kind);
    bool is_list = item->type == IMKI_ITEM_FIELD;
    const imk_evidence *evidence = imki_evidence_of(model, item->kind);
    int count = is_list ? imki_list_count(item->field, triad) : evidence->interval_count;
    imki_write_text(writer, "\n");
    writer->indent += 2;
    for (int i = 0; i < count; i++) {
        if (!is_list && imki_is_bound(&evidence->interval[i], triad->axis_count) != item->is_bound)
            continue;
        imki_write_indent(writer);
        if (is_list) {
            imki_write_text(writer, "- ");
            imki_write_element(writer, item->field, item->kind, triad, i);
        } else {
            imki_write_interval(writer, &evidence->interval[i], item->kind, triad, item->is_bound);
        }
        imki_write_text(writer, "\n");
    }
    writer->indent -= 2;
}

void imki_write_item(imki_writer *writer, const imki_item *item, const imk_model *model)
{
    bool is_list = item->type == IMKI_ITEM_INTERVALS ||
                   (item->type == IMKI_ITEM_FIELD && item->field->shape == IMKI_LIST);
    begin_entry(writer);
    imki_write_key(writer, last_component(item->path));
    if (is_list && writer->layout == IMKI_BLOCK) {
        write_block_list(writer, item, model);
        return;
    }
    if (item->type == IMKI_ITEM_CORRELATION && writer->layout == IMKI_BLOCK) {
        imki_write_correlation_block(writer, &model->correlation);
        return;
    }
    imki_write_text(writer, " ");
    imki_write_item_value(writer, item, model);
    if (writer->layout == IMKI_BLOCK)
        imki_write_text(writer, "\n");
}

/* Length of the first `components` components of a path, without the dot behind. */
static size_t prefix_length(const char *path, size_t components)
{
    size_t length = 0;
    for (; path[length]; length++)
        if (path[length] == '.' && --components == 0)
            break;
    return length;
}

static size_t component_count(const char *path)
{
    size_t count = 1;
    for (; *path; path++)
        count += *path == '.';
    return count;
}

/* Close and open groups so that an item of `path` can be written; returns how many are open. */
static size_t change_groups(imki_writer *writer, const char *from, size_t open, const char *path,
                            size_t always_open)
{
    size_t wanted = component_count(path) - 1, common = open;
    while (common > always_open) {
        size_t length = prefix_length(from, common);
        bool same = common <= wanted && prefix_length(path, common) == length &&
                    strncmp(from, path, length) == 0;
        if (same)
            break;
        common--;
        imki_close_group(writer);
    }
    for (size_t i = common; i < wanted; i++) {
        size_t begin = i > 0 ? prefix_length(path, i) + 1 : 0;
        char key[KEY_SIZE];
        snprintf(key, sizeof key, "%.*s", (int)(prefix_length(path, i + 1) - begin), path + begin);
        imki_open_group(writer, key);
    }
    return wanted > common ? wanted : common;
}

/* True when a sensor that is there has nothing to say. */
static bool is_perfect(const imki_item *sensor, size_t index, const imk_model *model)
{
    imki_item item;
    for (size_t i = index + 1; imki_item_at(i, &item) && item.kind == sensor->kind &&
                               item.type != IMKI_ITEM_TIMING && item.type != IMKI_ITEM_SENSOR;
         i++)
        if (!imki_item_absent(&item, model))
            return false;
    return true;
}

void imki_write_items(imki_writer *writer, const imk_model *model, size_t first, size_t last,
                      size_t open_components)
{
    imki_item item;
    char open_path[sizeof item.path] = "";
    size_t open = open_components;
    for (size_t i = first; i < last && imki_item_at(i, &item); i++) {
        if (imki_item_absent(&item, model) ||
            (item.type == IMKI_ITEM_SENSOR && !is_perfect(&item, i, model)))
            continue;
        open = change_groups(writer, open_path, open, item.path, open_components);
        imki_write_item(writer, &item, model);
        memcpy(open_path, item.path, sizeof open_path);
    }
    while (open-- > open_components)
        imki_close_group(writer);
}

void imki_write_model(imki_writer *writer, const imk_model *model)
{
    if (writer->layout != IMKI_BLOCK) {
        imki_write_text(writer, "{");
        writer->indent += 2;
    }
    writer->is_first = true;
    begin_entry(writer);
    imki_write_key(writer, "imukit");
    imki_write_text(writer, writer->layout == IMKI_BLOCK ? " 1\n" : " 1");
    imki_write_items(writer, model, 0, SIZE_MAX, 0);
    if (writer->layout != IMKI_BLOCK) {
        writer->indent -= 2;
        imki_write_text(writer, writer->layout == IMKI_LINES ? "\n}\n" : "}");
    }
}
