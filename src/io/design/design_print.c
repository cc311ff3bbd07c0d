/* SPDX-License-Identifier: Apache-2.0 */
/* A design as YAML: nested by the dots of the paths, a comment with the help behind each value. */
#include "design_file_internal.h"
#include "io/model/model_yaml_internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { COMMENT_COLUMN = 39, LINE_WIDTH = 96 };

/* A comment of its own, filled into lines. */
static void put_comment(imki_writer *w, const char *text)
{
    size_t column = 0;
    while (*text) {
        const size_t length = strcspn(text, " \n");
        if (column > 0 && column + 1 + length > LINE_WIDTH) {
            imki_write_text(w, "\n");
            column = 0;
        }
        imki_write_text(w, column > 0 ? " " : "# ");
        imki_write_bytes(w, text, length);
        column += length + (column > 0 ? 1 : 2);
        text += length;
        text += strspn(text, " \n");
    }
    imki_write_text(w, "\n");
}

static void put_choices(imki_writer *w, const char *choices)
{
    imki_write_text(w, ": ");
    for (const char *at = choices; *at;) {
        const size_t length = strcspn(at, "|");
        imki_write_bytes(w, at, length);
        at += length;
        if (*at == '|') {
            at++;
            imki_write_text(w, strchr(at, '|') ? ", " : " or ");
        }
    }
}

/* `key: value    # help` */
static void put_field(imki_writer *w, const imk_design_field *field, const char *key,
                      const void *design)
{
    char value[IMKI_DESIGN_TEXT_SIZE] = "";
    const size_t begin = w->size;
    (void)imk_design_field_text(field, design, 0, value, sizeof value);
    imki_write_indent(w);
    imki_write_key(w, key);
    imki_write_text(w, " ");
    imki_write_text(w, value);
    for (size_t column = w->size - begin; column < COMMENT_COLUMN; column++)
        imki_write_text(w, " ");
    imki_write_text(w, " # ");
    imki_write_text(w, field->help);
    if (field->kind == IMK_DESIGN_CHOICE)
        put_choices(w, field->choices);
    imki_write_text(w, "\n");
}

/* Was the group of this component opened by a field before this one? */
static bool is_open(const imk_instrument *instrument, size_t index, const char *prefix,
                    const char *component, size_t length)
{
    for (size_t i = 0; i < index; i++) {
        const char *other;
        size_t other_length;
        if (imki_design_component(instrument->fields[i].path, prefix, &other_length, &other) &&
            other_length == length && memcmp(other, component, length) == 0)
            return true;
    }
    return false;
}

static void put_group(imki_writer *w, const imk_instrument *instrument, const char *prefix,
                      const void *design)
{
    for (size_t i = 0; i < instrument->field_count; i++) {
        const imk_design_field *field = &instrument->fields[i];
        char path[IMKI_DESIGN_TEXT_SIZE], key[64];
        const char *component;
        size_t length;
        if (!imki_design_component(field->path, prefix, &length, &component))
            continue;
        snprintf(key, sizeof key, "%.*s", (int)length, component);
        if (component[length] == '\0') {
            put_field(w, field, key, design);
        } else if (!is_open(instrument, i, prefix, component, length)) {
            snprintf(path, sizeof path, "%.60s%s.", prefix, key);
            imki_open_group(w, key);
            put_group(w, instrument, path, design);
            imki_close_group(w);
        }
    }
}

static void put_head(imki_writer *w, const imk_design_file *file)
{
    const imk_instrument *instrument = file->instrument;
    char text[600];
    snprintf(text, sizeof text, "%s. Default design: %s", instrument->title, instrument->source);
    put_comment(w, text);
    imki_write_text(w, "imukit: 1\ninstrument: ");
    imki_write_text(w, instrument->name);
    imki_write_text(w, "\n");
    if (file->name[0]) {
        imki_write_text(w, "name: ");
        imki_write_text_value(w, file->name);
        imki_write_text(w, "\n");
    }
    if (file->description[0]) {
        imki_write_text(w, "description: ");
        imki_write_text_value(w, file->description);
        imki_write_text(w, "\n");
    }
}

imk_status imk_design_print(const imk_design_file *file, char **text, size_t *size,
                            imk_error *error)
{
    imki_writer writer = {.layout = IMKI_BLOCK};
    const imk_status status = imk_design_check(file->instrument, file->design, error);
    if (status != IMK_OK) {
        imk_design_error_in_units(file->instrument, file->design, error);
        return status;
    }
    put_head(&writer, file);
    put_group(&writer, file->instrument, "", file->design);
    if (writer.failed) {
        free(writer.bytes);
        return imk_error_set(error, IMK_ERROR_MEMORY, "", "", "");
    }
    *text = writer.bytes;
    *size = writer.size;
    return IMK_OK;
}
