/* SPDX-License-Identifier: Apache-2.0 */
/* The formats of the messages of a ULog: "name:type field;type[3] field;", where a type is that of
 * a number or the name of another format [ULOG, F]. */
#include "ulog_internal.h"

#include <stdlib.h>
#include <string.h>

/* PX4 has some 250 formats of up to some 100 fields. */
enum { FORMATS_MOST = 1024, FIELDS_MOST = 512, SIZE_MOST = 65535 };

static uint32_t hash_of(const char *name, size_t size) /* FNV-1a */
{
    uint32_t hash = 2166136261u;
    for (size_t i = 0; i < size; i++)
        hash = (hash ^ (unsigned char)name[i]) * 16777619u;
    return hash;
}

imki_ulog_format *imki_ulog_format_find(imki_ulog_formats *formats, const char *name, size_t size)
{
    const uint32_t hash = hash_of(name, size);
    for (size_t i = 0; i < formats->count; i++) {
        imki_ulog_format *format = &formats->item[i];
        if (format->hash == hash && strlen(format->text) == size &&
            memcmp(format->text, name, size) == 0)
            return format;
    }
    return NULL;
}

bool imki_ulog_format_add(imki_ulog_formats *formats, const char *text, size_t size, bool *memory)
{
    const char *colon = memchr(text, ':', size);
    *memory = true;
    if (!colon || colon == text || memchr(text, '\0', size))
        return false;
    const size_t name = (size_t)(colon - text);
    if (imki_ulog_format_find(formats, text, name))
        return true;
    if (formats->count == FORMATS_MOST)
        return false;
    if (formats->count == formats->room) {
        const size_t room = formats->room > 0 ? 2 * formats->room : 128;
        imki_ulog_format *larger = realloc(formats->item, room * sizeof *larger);
        if (!larger)
            return *memory = false;
        formats->item = larger;
        formats->room = room;
    }
    char *copy = malloc(size + 1);
    if (!copy)
        return *memory = false;
    memcpy(copy, text, size);
    copy[size] = copy[name] = '\0';
    formats->item[formats->count++] =
        (imki_ulog_format){.text = copy, .fields = copy + name + 1, .hash = hash_of(text, name)};
    return true;
}

void imki_ulog_formats_free(imki_ulog_formats *formats)
{
    for (size_t i = 0; i < formats->count; i++)
        free(formats->item[i].text);
    free(formats->item);
}

static imki_flight_type type_of(const char *name, size_t size)
{
    static const struct {
        const char *name;
        imki_flight_type type;
    } types[] = {{"int8_t", IMKI_FLIGHT_INT8},   {"uint8_t", IMKI_FLIGHT_UINT8},
                 {"int16_t", IMKI_FLIGHT_INT16}, {"uint16_t", IMKI_FLIGHT_UINT16},
                 {"int32_t", IMKI_FLIGHT_INT32}, {"uint32_t", IMKI_FLIGHT_UINT32},
                 {"int64_t", IMKI_FLIGHT_INT64}, {"uint64_t", IMKI_FLIGHT_UINT64},
                 {"float", IMKI_FLIGHT_FLOAT},   {"double", IMKI_FLIGHT_DOUBLE},
                 {"bool", IMKI_FLIGHT_UINT8},    {"char", IMKI_FLIGHT_UINT8}};
    for (size_t i = 0; i < sizeof types / sizeof types[0]; i++)
        if (strlen(types[i].name) == size && memcmp(types[i].name, name, size) == 0)
            return types[i].type;
    return IMKI_FLIGHT_NONE;
}

/* A field as it stands in the text. */
typedef struct piece {
    const char *type, *name;
    size_t type_size, name_size, count;
} piece;

/* Take "type[count] name;" from the text. @return whether it is such */
static bool take(const char **text, piece *field)
{
    const char *end = *text + strcspn(*text, ";"), *blank = memchr(*text, ' ', strcspn(*text, ";"));
    if (!blank || blank == *text || blank + 1 == end)
        return false;
    *field = (piece){*text, blank + 1, (size_t)(blank - *text), (size_t)(end - blank) - 1, 1};
    const char *bracket = memchr(*text, '[', field->type_size);
    if (bracket) {
        field->count = 0;
        const char *digit = bracket + 1;
        while (*digit >= '0' && *digit <= '9' && field->count <= SIZE_MOST)
            field->count = 10 * field->count + (size_t)(*digit++ - '0');
        if (digit == bracket + 1 || *digit != ']' || digit + 1 != blank || field->count > SIZE_MOST)
            return false;
        field->type_size = (size_t)(bracket - *text);
    }
    *text = *end == ';' ? end + 1 : end;
    return true;
}

/* Formats that contain each other in a circle have no size, and neither have those that contain
 * what is not there or that are larger than a message. */
static void measure(imki_ulog_formats *formats, imki_ulog_format *format, int depth)
{
    const char *text = format->fields;
    size_t size = 0, smallest = 0, fields = 0;
    format->state = 1;
    while (*text) {
        piece field;
        if (++fields > FIELDS_MOST || !take(&text, &field)) {
            format->state = 2;
            return;
        }
        size_t one = imki_flight_size(type_of(field.type, field.type_size));
        imki_ulog_format *inner =
            one == 0 ? imki_ulog_format_find(formats, field.type, field.type_size) : NULL;
        if (inner && inner->state == 0 && depth < 16)
            measure(formats, inner, depth + 1);
        if (inner && inner->state == 2)
            one = inner->size;
        if (one == 0 || one * field.count > SIZE_MOST - size) {
            format->state = 2;
            return;
        }
        size += one * field.count;
        if (field.name_size < 8 || memcmp(field.name, "_padding", 8) != 0)
            smallest = size;
    }
    *format = (imki_ulog_format){format->text, format->fields, format->hash, 2, size, smallest};
}

void imki_ulog_format_measure(imki_ulog_formats *formats, imki_ulog_format *format)
{
    if (format->state == 0)
        measure(formats, format, 0);
}

imki_flight_field imki_ulog_field(imki_ulog_formats *formats, imki_ulog_format *format,
                                  const char *name)
{
    const size_t length = strcspn(name, "[");
    const size_t index = name[length] == '[' ? strtoul(name + length + 1, NULL, 10) : 0;
    const char *text = format->fields;
    size_t place = 0;
    imki_ulog_format_measure(formats, format);
    while (*text && format->size > 0) {
        piece field;
        if (!take(&text, &field))
            break;
        const imki_flight_type type = type_of(field.type, field.type_size);
        size_t one = imki_flight_size(type);
        if (field.name_size == length && memcmp(field.name, name, length) == 0) {
            if (index >= field.count || one == 0)
                break;
            return (imki_flight_field){type, place + index * one, field.count - index};
        }
        if (one == 0)
            one = imki_ulog_format_find(formats, field.type, field.type_size)->size;
        place += one * field.count;
    }
    return (imki_flight_field){IMKI_FLIGHT_NONE, 0, 0};
}
