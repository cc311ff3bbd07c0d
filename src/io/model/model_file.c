/* SPDX-License-Identifier: Apache-2.0 */
/* Reading and writing model files: the public functions. */
#define _POSIX_C_SOURCE 200809L

#include "imukit/model_file.h"

#include "document_internal.h"
#include "io/file/text_file_internal.h"
#include "model_yaml_internal.h"

#include "imukit/names.h"
#include "imukit/utf8.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* ---- reading --------------------------------------------------------------------------------- */

imk_status imk_model_parse(const char *text, size_t size, imk_model *model, imk_document **document,
                           imk_error *error)
{
    imk_document *made = NULL;
    imk_status status = imki_document_open(text, size, true, &made, error);
    if (status != IMK_OK)
        return status;
    *model = made->model;
    if (document)
        *document = made;
    else
        imk_document_free(made);
    return IMK_OK;
}

imk_status imk_model_read(const char *path, imk_model *model, imk_document **document,
                          imk_error *error)
{
    char *bytes = NULL;
    size_t size = 0;
    imk_status status = imki_text_file_read(path, IMKI_DOCUMENT_SIZE_MAX, &bytes, &size, error);
    if (status == IMK_OK)
        status = imk_model_parse(bytes, size, model, document, error);
    free(bytes);
    return status;
}

bool imk_model_recognise(const char *path)
{
    return imki_is_script(path, "imukit:") || imki_is_script(path, "imukit\":");
}

/* ---- writing --------------------------------------------------------------------------------- */

static imk_status check_texts(const imk_model *model, imk_error *error)
{
    imki_item item;
    for (size_t i = 0; imki_item_at(i, &item); i++) {
        if (item.type != IMKI_ITEM_TEXT || imki_item_absent(&item, model))
            continue;
        const char *c = (const char *)model + item.offset;
        while (*c) {
            size_t length = imk_utf8_length(c);
            if (length == 0)
                return imk_error_set(error, IMK_ERROR_ARGUMENT, item.path, "", "a text in UTF-8");
            c += length;
        }
    }
    return IMK_OK;
}

static bool same_model(const imk_model *a, const imk_model *b)
{
    imki_item item;
    for (size_t i = 0; imki_item_at(i, &item); i++)
        if (!imki_item_equal(&item, a, b))
            return false;
    return true;
}

static imk_status copy_bytes(const char *bytes, size_t count, char **text, size_t *size,
                             imk_error *error)
{
    char *copy = malloc(count + 1);
    if (!copy)
        return imk_error_set(error, IMK_ERROR_MEMORY, "", "", "");
    memcpy(copy, bytes, count);
    copy[count] = '\0';
    *text = copy;
    *size = count;
    return IMK_OK;
}

static imk_status print(const imk_model *model, const imk_document *document, bool is_json,
                        bool keeps_layout, char **text, size_t *size, imk_error *error)
{
    imk_status status = imk_model_validate(model, error);
    if (status == IMK_OK)
        status = check_texts(model, error);
    if (status != IMK_OK)
        return status;
    if (document && keeps_layout) {
        if (same_model(&document->model, model))
            return copy_bytes(document->text, document->size, text, size, error);
        status = imki_edit_document(document, model, text, size);
        if (status != IMK_ERROR_UNSUPPORTED)
            return status == IMK_OK ? status : imk_error_set(error, status, "", "", "");
    }
    imki_writer writer = {
        .layout = is_json ? IMKI_LINES : IMKI_BLOCK, .is_json = is_json, .source = document};
    imki_write_model(&writer, model);
    if (writer.failed) {
        free(writer.bytes);
        return imk_error_set(error, IMK_ERROR_MEMORY, "", "", "");
    }
    *text = writer.bytes;
    *size = writer.size;
    return IMK_OK;
}

imk_status imk_model_print(const imk_model *model, const imk_document *document, char **text,
                           size_t *size, imk_error *error)
{
    return print(model, document, document && document->is_json, true, text, size, error);
}

imk_status imk_model_print_json(const imk_model *model, const imk_document *document, char **text,
                                size_t *size, imk_error *error)
{
    return print(model, document, true, document && document->is_json, text, size, error);
}

imk_status imk_model_write(const char *path, const imk_model *model, const imk_document *document,
                           imk_error *error)
{
    bool is_json = imk_has_ending(path, ".json");
    bool is_yaml = imk_has_ending(path, ".yaml") || imk_has_ending(path, ".yml");
    bool was_json = document && document->is_json;
    char *text = NULL;
    size_t size = 0;
    imk_status status = is_json   ? imk_model_print_json(model, document, &text, &size, error)
                        : is_yaml ? print(model, document, false, !was_json, &text, &size, error)
                                  : imk_model_print(model, document, &text, &size, error);
    if (status == IMK_OK)
        status = imki_text_file_write(path, text, size, error);
    free(text);
    return status;
}

/* ---- by name --------------------------------------------------------------------------------- */

static imk_status refuse_name(const char *name, imk_error *error)
{
    enum { NAMES_MAX = 128 };
    const char *names[NAMES_MAX];
    char expected[sizeof error->expected];
    size_t count = imk_device_count() < NAMES_MAX ? imk_device_count() : NAMES_MAX;
    for (size_t i = 0; i < count; i++)
        names[i] = imk_device_get(i)->name;
    size_t nearest = imk_nearest_name(name, count, names);
    if (nearest != SIZE_MAX) {
        size_t second;
        const char *first = names[nearest];
        names[nearest] = NULL;
        second = imk_nearest_name(name, count, names);
        snprintf(expected, sizeof expected, "did you mean \"%s\"%s%s%s?", first,
                 second != SIZE_MAX ? " or \"" : "", second != SIZE_MAX ? names[second] : "",
                 second != SIZE_MAX ? "\"" : "");
    } else {
        snprintf(expected, sizeof expected,
                 "a model file, or a name of the catalogue (imukit devices lists them)");
    }
    return imk_error_set(error, IMK_ERROR_NAME_UNKNOWN, "model", name, expected);
}

imk_status imk_model_open(const char *name, imk_model *model, imk_document **document,
                          imk_error *error)
{
    struct stat unused;
    bool is_file = strcmp(name, "-") == 0 || stat(name, &unused) == 0;
    const imk_device *device = is_file ? NULL : imk_device_find(name);
    bool looks_like_file = strchr(name, '/') || imk_is_script_name(name);
    if (is_file || (!device && looks_like_file))
        return imk_model_read(name, model, document, error);
    if (!device)
        return refuse_name(name, error);
    imk_device_model(device, model);
    if (document)
        *document = NULL;
    return IMK_OK;
}
