/* SPDX-License-Identifier: Apache-2.0 */
/* Design files: the public functions. */
#define _POSIX_C_SOURCE 200809L

#include "design_file_internal.h"
#include "io/file/text_file_internal.h"

#include "imukit/names.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { INSTRUMENTS_MAX = 64 };

/* `did you mean "ring_laser"?`, or where the names are listed. */
static void expected_names(const char *name, char *expected, size_t size)
{
    const char *names[INSTRUMENTS_MAX];
    const size_t known = imk_instrument_count();
    const size_t count = known < INSTRUMENTS_MAX ? known : INSTRUMENTS_MAX;
    for (size_t i = 0; i < count; i++)
        names[i] = imk_instrument_get(i)->name;
    const size_t nearest = imk_nearest_name(name, count, names);
    if (nearest < count)
        snprintf(expected, size, "did you mean \"%s\"?", names[nearest]);
    else
        snprintf(expected, size, "a design file, or a name that imukit physics lists");
}

/* The kind that the document says. With `due`, it must be that one. */
static const imk_instrument *read_instrument(imki_reading *r, const imk_instrument *due)
{
    char expected[sizeof r->error->expected], found[sizeof r->error->found];
    int node;
    if (!imki_value_find(r, 0, "instrument",
                         "write instrument: NAME, with a name that imukit physics lists", &node) ||
        !imki_value_require(r, node, IMKI_NODE_SCALAR, "the name of an instrument"))
        return NULL;
    const char *name = r->document->node[node].text;
    const imk_instrument *instrument = due ? due : imk_instrument_find(name);
    if (!instrument) {
        expected_names(name, expected, sizeof expected);
        imki_value_refuse(r, node, IMK_ERROR_NAME_UNKNOWN, name, expected);
    } else if (due && strcmp(due->name, name) != 0) {
        snprintf(found, sizeof found, "\"%.30s\" is not \"%.30s\"", name, due->name);
        imki_value_refuse(r, node, IMK_ERROR_CONFLICT, found, "a design of this instrument");
    }
    return instrument;
}

static imk_status make(const imk_instrument *instrument, imk_design_file *file, imk_error *error)
{
    file->instrument = instrument;
    file->design = calloc(1, instrument->design_size);
    if (!file->design)
        return imk_error_set(error, IMK_ERROR_MEMORY, "", "", "");
    instrument->set_default(file->design);
    return IMK_OK;
}

static imk_status read_document(const imk_document *document, const imk_instrument *due,
                                imk_design_file *file, imk_error *error)
{
    imki_reading r = {.document = document, .error = error};
    imki_value_version(&r, "imukit");
    const imk_instrument *instrument = read_instrument(&r, due);
    imki_value_name(&r, "name", file->name, sizeof file->name);
    imki_value_name(&r, "description", file->description, sizeof file->description);
    if (r.status == IMK_OK)
        r.status = make(instrument, file, error);
    if (r.status == IMK_OK)
        imki_design_read_fields(&r, instrument, file->design);
    return r.status;
}

imk_status imk_design_parse_as(const imk_instrument *instrument, const char *text, size_t size,
                               imk_design_file *file, imk_error *error)
{
    imk_design_file made = {.design = NULL};
    imk_document *document = NULL;
    imk_status status = imki_document_parse_as("design", "imukit: 1 and instrument: NAME", text,
                                               size, &document, error);
    if (status == IMK_OK)
        status = read_document(document, instrument, &made, error);
    imk_document_free(document);
    if (status == IMK_OK)
        *file = made;
    else
        imk_design_file_free(&made);
    return status;
}

imk_status imk_design_parse(const char *text, size_t size, imk_design_file *file, imk_error *error)
{
    return imk_design_parse_as(NULL, text, size, file, error);
}

imk_status imk_design_read(const char *path, imk_design_file *file, imk_error *error)
{
    char *bytes = NULL;
    size_t size = 0;
    imk_status status = imki_text_file_read(path, IMKI_DOCUMENT_SIZE_MAX, &bytes, &size, error);
    if (status == IMK_OK)
        status = imk_design_parse(bytes, size, file, error);
    free(bytes);
    return status;
}

imk_status imk_design_open(const char *name, imk_design_file *file, imk_error *error)
{
    struct stat found;
    imk_design_file made = {.design = NULL};
    const bool is_file =
        strcmp(name, "-") == 0 || (stat(name, &found) == 0 && !S_ISDIR(found.st_mode));
    const imk_instrument *instrument = is_file ? NULL : imk_instrument_find(name);
    if (is_file || (!instrument && (strchr(name, '/') || imk_is_script_name(name))))
        return imk_design_read(name, file, error);
    if (!instrument) {
        char expected[sizeof error->expected];
        expected_names(name, expected, sizeof expected);
        return imk_error_set(error, IMK_ERROR_NAME_UNKNOWN, "instrument", name, expected);
    }
    const imk_status status = make(instrument, &made, error);
    if (status == IMK_OK)
        *file = made;
    return status;
}

void imk_design_file_free(imk_design_file *file)
{
    if (!file)
        return;
    free(file->design);
    file->design = NULL;
}

imk_status imk_design_write(const char *path, const imk_design_file *file, imk_error *error)
{
    char *text = NULL;
    size_t size = 0;
    imk_status status = imk_design_print(file, &text, &size, error);
    if (status == IMK_OK)
        status = imki_text_file_write(path, text, size, error);
    free(text);
    return status;
}
