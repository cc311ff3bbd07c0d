/* SPDX-License-Identifier: Apache-2.0 */
/* The arrays of a MAT-file [MAT5]. Numbers of an array follow its head, column after column, and
 * may be stored in a smaller type than their class. A structure has the length of its field names,
 * the names, each of that length, and an array for each field of each of its elements. Cells,
 * texts, sparse and complex arrays are no samples. */
#define _POSIX_C_SOURCE 200809L
#include "mat_elements_internal.h"

#include "base/text_internal.h"
#include "io/file/system_error_internal.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum {
    FIELDS_MAX = 1024,
    ELEMENTS_MAX = 65536, /* arrays of all kinds; a log has a few */
    UNITS_MAX = 256
};

/* A text of a structure `units`. */
typedef struct unit_text {
    char group[96], name[64], unit[40];
} unit_text;

typedef struct reading {
    imki_array_strips *state;
    imki_mat_bytes bytes;
    size_t source; /* of the bytes */
    size_t elements;
    unit_text *units; /* of UNITS_MAX */
    size_t unit_count;
} reading;

/* Where an array is: its group and the name of its field; "" for those at the top, which have their
 * own name. */
typedef struct position {
    const char *group, *name;
    int depth;
} position;

static imk_status refuse(const char *what, imk_error *error)
{
    return imk_error_set(error, IMK_ERROR_FORMAT, "", what, "copy the file again");
}

static imk_status refuse_many(imk_error *error)
{
    return imk_error_set(error, IMK_ERROR_UNSUPPORTED, "", "the file holds more than 65536 arrays",
                         "a file of one log: an array for each sensor or axis");
}

/* @return false: no type of numbers */
static bool find_type(uint32_t type, imki_value_type *found)
{
    static const struct {
        uint32_t type;
        imki_value_type found;
    } types[] = {{IMKI_MAT_INT8, IMKI_INT8},      {IMKI_MAT_UINT8, IMKI_UINT8},
                 {IMKI_MAT_INT16, IMKI_INT16},    {IMKI_MAT_UINT16, IMKI_UINT16},
                 {IMKI_MAT_INT32, IMKI_INT32},    {IMKI_MAT_UINT32, IMKI_UINT32},
                 {IMKI_MAT_SINGLE, IMKI_FLOAT32}, {IMKI_MAT_DOUBLE, IMKI_FLOAT64},
                 {IMKI_MAT_INT64, IMKI_INT64},    {IMKI_MAT_UINT64, IMKI_UINT64}};
    for (size_t i = 0; i < sizeof types / sizeof types[0]; i++)
        if (types[i].type == type) {
            *found = types[i].found;
            return true;
        }
    return false;
}

static void note(reading *r, const position *at, const char *kind)
{
    char name[96];
    snprintf(name, sizeof name, "%.47s%s%.47s", at->group, at->group[0] ? "." : "", at->name);
    imki_array_note(&r->state->rows.list, name, kind);
}

static imk_status add_numbers(reading *r, const position *at, const imki_mat_head *head,
                              uint64_t end, imk_error *error)
{
    imki_mat_tag tag;
    imki_array array = {.source = r->source, .swapped = r->bytes.swapped};
    imk_status status = imki_mat_tag_read(&r->bytes, head->content, end, &tag, error);
    if (status != IMK_OK)
        return status;
    const uint64_t count = head->extent[0] * head->extent[1]; /* each below 2^31 */
    if (count == 0)
        return IMK_OK;
    if (head->dimensions != 2 || head->complex) {
        char kind[64] = "MATLAB array of complex numbers";
        if (!head->complex)
            snprintf(kind, sizeof kind, "MATLAB array of %zu dimensions", head->dimensions);
        note(r, at, kind);
        return IMK_OK;
    }
    if (!find_type(tag.type, &array.type) || tag.size / imki_value_size(array.type) < count)
        return refuse("an array of the MAT-file is damaged", error);
    imki_copy_text(array.group, sizeof array.group, at->group);
    imki_copy_text(array.name, sizeof array.name, at->name);
    array.place = tag.data;
    for (size_t i = 0; i < 2; i++)
        array.extent[i] = head->extent[i];
    array.step[0] = imki_value_size(array.type);
    array.step[1] = array.step[0] * array.extent[0];
    return imki_array_add(&r->state->rows.list, &array, error);
}

/* A text in a structure `units`: ASCII, in characters of 1 or 2 bytes. */
static imk_status add_unit(reading *r, const position *at, const imki_mat_head *head, uint64_t end,
                           imk_error *error)
{
    static const char units[] = "units";
    const size_t length = strlen(at->group), own = sizeof units - 1;
    const size_t before = length >= own ? length - own : 0; /* what stands before "units" */
    imki_mat_tag tag = {.type = 0};
    unsigned char text[80] = {0};
    if (strcmp(at->group + before, units) != 0 || r->unit_count == UNITS_MAX ||
        (before > 0 && at->group[before - 1] != '.'))
        return IMK_OK;
    imk_status status = imki_mat_tag_read(&r->bytes, head->content, end, &tag, error);
    const bool wide = tag.type == IMKI_MAT_UINT16 || tag.type == IMKI_MAT_UTF16;
    const size_t width = status == IMK_OK && wide ? 2 : 1;
    if (status == IMK_OK && tag.size <= sizeof text)
        status = imki_mat_data(&r->bytes, &tag, text, (size_t)tag.size, error);
    if (status != IMK_OK || tag.size > sizeof text)
        return status;
    unit_text *unit = &r->units[r->unit_count++];
    *unit = (unit_text){.unit = ""};
    imki_copy_text(unit->name, sizeof unit->name, at->name);
    if (before > 0)
        snprintf(unit->group, sizeof unit->group, "%.*s", (int)before - 1, at->group);
    for (size_t i = 0; i < tag.size / width && i + 1 < sizeof unit->unit; i++)
        unit->unit[i] = (char)text[width * i + (width == 2 && r->bytes.swapped)];
    return IMK_OK;
}

static imk_status read_array(reading *r, position at, uint64_t from, uint64_t end,
                             imk_error *error);

/* The names of a structure's fields. @param names  receives them, from malloc() */
static imk_status read_names(reading *r, uint64_t *at, uint64_t end, char **names, size_t *length,
                             size_t *count, imk_error *error)
{
    imki_mat_tag tag;
    unsigned char number[4];
    imk_status status = imki_mat_tag_read(&r->bytes, *at, end, &tag, error);
    if (status == IMK_OK)
        status = imki_mat_data(&r->bytes, &tag, number, sizeof number, error);
    if (status != IMK_OK)
        return status;
    *length = imki_mat_number(number, r->bytes.swapped);
    status = imki_mat_tag_read(&r->bytes, tag.next, end, &tag, error);
    if (status != IMK_OK)
        return status;
    if (*length < 1 || *length > 64 || tag.size % *length != 0)
        return refuse("a structure of the MAT-file is damaged", error);
    *count = (size_t)(tag.size / *length < FIELDS_MAX ? tag.size / *length : FIELDS_MAX + 1);
    if (*count > FIELDS_MAX)
        return imk_error_set(error, IMK_ERROR_UNSUPPORTED, "",
                             "a structure has more than 1024 fields",
                             "a file of one log: an array for each sensor or axis");
    *names = malloc(*length * *count + 1);
    if (!*names)
        return imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
    *at = tag.next;
    return imki_mat_data(&r->bytes, &tag, *names, *length * *count, error);
}

/* The fields of one element. */
static imk_status read_fields(reading *r, const char *group, int depth, const char *names,
                              size_t length, size_t count, uint64_t *at, uint64_t end,
                              imk_error *error)
{
    imk_status status = IMK_OK;
    for (size_t i = 0; i < count && status == IMK_OK; i++) {
        imki_mat_tag tag;
        char name[65];
        if (++r->elements > ELEMENTS_MAX)
            return refuse_many(error);
        snprintf(name, sizeof name, "%.*s", (int)strnlen(names + i * length, length),
                 names + i * length);
        status = imki_mat_tag_read(&r->bytes, *at, end, &tag, error);
        if (status == IMK_OK && tag.type != IMKI_MAT_MATRIX)
            status = refuse("a structure of the MAT-file is damaged", error);
        if (status == IMK_OK && tag.size > 0) /* an empty one has nothing at all */
            status =
                read_array(r, (position){group, name, depth}, tag.data, tag.data + tag.size, error);
        *at = status == IMK_OK ? tag.next : *at;
    }
    return status;
}

static imk_status read_structure(reading *r, const position *at, const imki_mat_head *head,
                                 uint64_t end, imk_error *error)
{
    char *names = NULL, group[96];
    size_t length = 0, count = 0;
    uint64_t place = head->content;
    const uint64_t elements = head->extent[0] * head->extent[1];
    if (at->depth >= IMKI_ARRAY_DEPTH || head->dimensions != 2)
        return IMK_OK;
    imk_status status = read_names(r, &place, end, &names, &length, &count, error);
    for (uint64_t i = 0; i < elements && count > 0 && status == IMK_OK; i++) {
        char number[24] = "";
        if (elements > 1)
            snprintf(number, sizeof number, "%llu", (unsigned long long)i + 1);
        snprintf(group, sizeof group, "%.40s%s%.40s%.10s", at->group, at->group[0] ? "." : "",
                 at->name, number);
        status = read_fields(r, group, at->depth + 1, names, length, count, &place, end, error);
    }
    free(names);
    return status;
}

/* Tables and the like. */
static void note_opaque(reading *r, const position *at, const imki_mat_head *head)
{
    char kind[64];
    snprintf(kind, sizeof kind, "MATLAB %.40s", head->type_name);
    note(r, at, kind);
}

/* Cells and sparse matrices hold what is no sample, unless they are called like a sensor. */
static void note_sensor(reading *r, const position *at, const imki_mat_head *head)
{
    if (imki_array_is_sensor(at->name) && head->array_class == IMKI_MAT_CELL)
        note(r, at, "MATLAB cell array");
    if (imki_array_is_sensor(at->name) && head->array_class == IMKI_MAT_SPARSE)
        note(r, at, "MATLAB array that is sparse");
}

/* The array whose data are from `from` to `end`. */
static imk_status read_array(reading *r, position at, uint64_t from, uint64_t end, imk_error *error)
{
    imki_mat_head head;
    if (++r->elements > ELEMENTS_MAX)
        return refuse_many(error);
    const imk_status status = imki_mat_head_read(&r->bytes, from, end, &head, error);
    if (status != IMK_OK)
        return status;
    at.name = at.name ? at.name : head.name;
    if (head.array_class == IMKI_MAT_OPAQUE && at.name[0])
        note_opaque(r, &at, &head);
    note_sensor(r, &at, &head);
    if (head.array_class == IMKI_MAT_STRUCT)
        return read_structure(r, &at, &head, end, error);
    if (head.array_class == IMKI_MAT_CHAR)
        return add_unit(r, &at, &head, end, error);
    if (head.array_class >= IMKI_MAT_DOUBLE_CLASS && head.array_class <= IMKI_MAT_UINT64_CLASS)
        return add_numbers(r, &at, &head, end, error);
    return IMK_OK;
}

/* A compressed element, which is one array. */
static imk_status read_compressed(reading *r, const imki_packed *file, const imki_mat_tag *tag,
                                  imk_error *error)
{
    const imki_packed packed = {.file = file->file,
                                .begin = file->begin + tag->data,
                                .size = tag->size,
                                .packing = IMKI_ZLIB};
    reading inner = *r;
    imki_mat_tag whole;
    inner.source = r->state->source_count;
    imk_status status = imki_array_source_add(r->state, &packed, NULL, error);
    if (status == IMK_OK)
        status = imki_packed_open(&packed, &inner.bytes.part, error);
    if (status != IMK_OK)
        return status;
    status = imki_mat_tag_read(&inner.bytes, 0, UINT64_MAX, &whole, error);
    if (status == IMK_OK)
        r->state->source[inner.source].unpacked = inner.bytes.part.packed.unpacked =
            whole.data + whole.size;
    const size_t arrays = r->state->rows.list.count;
    if (status == IMK_OK && whole.type == IMKI_MAT_MATRIX)
        status =
            read_array(&inner, (position){"", NULL, 0}, whole.data, whole.data + whole.size, error);
    /* The checksum of an array is compared when its numbers are read; units are taken here. */
    if (status == IMK_OK && inner.unit_count > r->unit_count && r->state->rows.list.count == arrays)
        status = imki_packed_end(&inner.bytes.part, error);
    imki_packed_close(&inner.bytes.part);
    r->elements = inner.elements;
    r->unit_count = inner.unit_count;
    return status;
}

static imk_status read_top(reading *r, const imki_packed *file, imk_error *error)
{
    uint64_t at = IMKI_MAT_HEAD;
    imk_status status = IMK_OK;
    while (status == IMK_OK && at < file->size) {
        imki_mat_tag tag;
        status = imki_mat_tag_read(&r->bytes, at, file->size, &tag, error);
        if (status == IMK_OK && tag.type == IMKI_MAT_COMPRESSED)
            status = read_compressed(r, file, &tag, error);
        else if (status == IMK_OK && tag.type == IMKI_MAT_MATRIX)
            status = read_array(r, (position){"", NULL, 0}, tag.data, tag.data + tag.size, error);
        else if (status == IMK_OK)
            status = refuse("the MAT-file is damaged", error);
        at = status == IMK_OK ? tag.next : at;
    }
    return status;
}

imk_status imki_mat_list(imk_log_reader *reader, bool swapped, imk_error *error)
{
    struct stat about;
    const int number = imki_input_file(reader->text.input);
    if (fstat(number, &about) != 0)
        return imki_system_error(error, IMK_ERROR_READ, "", errno);
    const imki_packed file = {.file = number, .size = (uint64_t)about.st_size};
    reading r = {.state = reader->state,
                 .bytes = {.swapped = swapped},
                 .units = calloc(UNITS_MAX, sizeof(unit_text))};
    imk_status status = r.units ? imki_array_source_add(r.state, &file, NULL, error)
                                : imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
    if (status == IMK_OK)
        status = imki_packed_open(&file, &r.bytes.part, error);
    if (status == IMK_OK)
        status = read_top(&r, &file, error);
    for (size_t i = 0; i < r.unit_count && status == IMK_OK; i++)
        imki_array_unit(&r.state->rows.list, r.units[i].group, r.units[i].name, r.units[i].unit);
    free(r.units);
    return status;
}
