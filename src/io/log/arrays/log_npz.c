/* SPDX-License-Identifier: Apache-2.0 */
/* Logs as .npz files: zip files [ZIP] of .npy members [NPY], one array each, as numpy.savez()
 * writes them. Two members of texts are not arrays of samples: `columns` names, and `units` states
 * the units of, the arrays or the columns of the only matrix. */
#include "array_strips_internal.h"
#include "base/text_internal.h"
#include "column_store_internal.h"
#include "imukit/names.h"
#include "io/log/npy_internal.h"
#include "npz_write_internal.h"
#include "zip_directory_internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { HEADER_MAX = 65536, TEXTS = IMK_LOG_COLUMNS_MAX, TEXT_SIZE = 64, TEXT_BYTES = 1024 };

/* An array of texts. */
typedef struct texts {
    size_t count;
    char text[TEXTS][TEXT_SIZE];
} texts;

typedef struct reading {
    imk_log_reader *reader;
    texts columns, units;
} reading;

/* "<f8": @return false: it is none that is read as numbers */
static bool find_type(const imki_npy_array *npy, imki_array *array)
{
    static const struct {
        const char *name;
        imki_value_type type;
    } types[] = {{"f8", IMKI_FLOAT64}, {"f4", IMKI_FLOAT32}, {"i1", IMKI_INT8},
                 {"u1", IMKI_UINT8},   {"b1", IMKI_UINT8},   {"i2", IMKI_INT16},
                 {"u2", IMKI_UINT16},  {"i4", IMKI_INT32},   {"u4", IMKI_UINT32},
                 {"i8", IMKI_INT64},   {"u8", IMKI_UINT64},  {"M8", IMKI_INT64},
                 {"m8", IMKI_INT64}};
    static const char order[] =
#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
        "<";
#else
        ">";
#endif
    array->swapped = npy->type[0] == order[0];
    for (size_t i = 0; i < sizeof types / sizeof types[0] && npy->type[0]; i++) {
        const size_t length = strlen(types[i].name);
        const bool date = strchr("Mm", types[i].name[0]) != NULL;
        if (strncmp(npy->type + 1, types[i].name, length) != 0 ||
            (npy->type[1 + length] != '\0' && !date))
            continue;
        array->type = types[i].type;
        /* datetime64, timedelta64: "<M8[ns]", "<m8[ns]" */
        if (date)
            snprintf(array->unit, sizeof array->unit, "%.*s",
                     (int)strcspn(npy->type + 3 + (npy->type[3] == '['), "]"),
                     npy->type + 3 + (npy->type[3] == '['));
        return true;
    }
    return false;
}

/* The characters of numpy's texts as UTF-8: 4 bytes each, or 1 that is taken as it is. */
static void take_text(const unsigned char *at, size_t count, size_t width, bool swapped, char *text)
{
    size_t length = 0;
    for (size_t i = 0; i < count && length + 5 < TEXT_SIZE; i++, at += width) {
        uint32_t code = 0;
        for (size_t k = 0; k < width; k++)
            code |= (uint32_t)at[swapped ? width - 1 - k : k] << 8 * k;
        if (code == 0 || code > 0x10FFFF)
            break;
        if (width == 1 || code < 0x80) {
            text[length++] = (char)code;
            continue;
        }
        const int more = code < 0x800 ? 1 : code < 0x10000 ? 2 : 3;
        text[length++] = (char)((0xFF80u >> more & 0xFF) | (code >> 6 * more & 0x3F));
        for (int k = more - 1; k >= 0; k--)
            text[length++] = (char)(0x80 | (code >> 6 * k & 0x3F));
    }
    text[length] = '\0';
}

/* A member of texts. What is too long or too much for a log's columns is left out. */
static imk_status read_texts(imki_unpacking *part, const imki_npy_array *npy, texts *into,
                             imk_error *error)
{
    const bool wide = npy->type[1] == 'U';
    const long characters = strtol(npy->type[0] ? npy->type + 2 : "0", NULL, 10);
    const size_t width = wide ? 4 : 1;
    unsigned char bytes[TEXT_BYTES];
    *into = (texts){0};
    if ((!wide && npy->type[1] != 'S') || npy->dimensions != 1 || npy->shape[0] > TEXTS ||
        characters < 1 || (size_t)characters * width > TEXT_BYTES)
        return IMK_OK;
    const size_t size = (size_t)characters * width;
    imk_status status = IMK_OK;
    for (size_t i = 0; i < npy->shape[0] && status == IMK_OK; i++) {
        status = imki_packed_read(part, npy->header_size + i * size, bytes, size, error);
        if (status == IMK_OK)
            take_text(bytes, (size_t)characters, width, npy->type[0] == '>',
                      into->text[into->count++]);
    }
    return status;
}

/* Rows and columns, and where they are. @return false: it is no vector or matrix */
static bool find_extent(const imki_npy_array *npy, imki_array *array)
{
    const size_t size = imki_value_size(array->type);
    if (npy->dimensions > 2)
        return false;
    array->extent[0] = npy->dimensions > 0 ? npy->shape[0] : 1;
    array->extent[1] = npy->dimensions > 1 ? npy->shape[1] : 1;
    array->step[0] = npy->fortran_order ? size : size * array->extent[1];
    array->step[1] = npy->fortran_order ? size * array->extent[0] : size;
    array->place = npy->header_size;
    return true;
}

static imk_status check_size(const imki_zip_member *member, const imki_array *array,
                             imk_error *error)
{
    uint64_t count, bytes;
    if (!__builtin_mul_overflow(array->extent[0], array->extent[1], &count) &&
        !__builtin_mul_overflow(count, (uint64_t)imki_value_size(array->type), &bytes) &&
        bytes <= member->unpacked && member->unpacked - bytes >= array->place)
        return IMK_OK;
    char found[96];
    snprintf(found, sizeof found, "\"%.40s\" is shorter than its header says", member->name);
    return imk_error_set(error, IMK_ERROR_FORMAT, "", found, "copy the file again");
}

/* What is no array of numbers, but of texts, is none that a log would lack. */
static void note(imki_array_list *list, const imki_zip_member *member, const imki_npy_array *npy)
{
    char name[sizeof member->name], kind[64];
    const char type = npy->type[0] ? npy->type[1] : '\0';
    snprintf(name, sizeof name, "%.*s", (int)(strlen(member->name) - 4), member->name);
    if (type == 'c')
        snprintf(kind, sizeof kind, "NumPy array of complex numbers");
    else if (type && strchr("fiubM", type) && npy->dimensions > 2)
        snprintf(kind, sizeof kind, "NumPy array of %zu dimensions", npy->dimensions);
    else if (type)
        snprintf(kind, sizeof kind, "NumPy array of type %.14s", npy->type + (*npy->type == '|'));
    else
        snprintf(kind, sizeof kind, "record array");
    if (!type || !strchr("US", type))
        imki_array_note(list, name, kind);
}

static imk_status add_array(reading *r, const imki_zip_member *member, const imki_packed *packed,
                            const imki_npy_array *npy, imk_error *error)
{
    imki_array_strips *state = r->reader->state;
    imki_array array = {.source = state->source_count};
    char name[sizeof member->name];
    snprintf(name, sizeof name, "%.*s", (int)(strlen(member->name) - 4), member->name);
    /* "imu/gyro [rad/s]": the last slash before the unit. */
    char *slash = NULL;
    for (char *c = name; *c && *c != '[' && *c != '('; c++)
        slash = *c == '/' ? c : slash;
    if (slash) {
        *slash = '\0';
        imki_copy_text(array.group, sizeof array.group, name);
    }
    imki_copy_text(array.name, sizeof array.name, slash ? slash + 1 : name);
    if (!find_type(npy, &array) || !find_extent(npy, &array)) {
        note(&state->rows.list, member, npy);
        return IMK_OK;
    }
    imk_status status = check_size(member, &array, error);
    if (status == IMK_OK)
        status = imki_array_add(&state->rows.list, &array, error);
    if (status == IMK_OK)
        status = imki_array_source_add(state, packed, member->name, error);
    return status;
}

/* The header of a member. @param header  from malloc() */
static imk_status read_header(imki_unpacking *part, char **header, imki_npy_array *npy,
                              imk_error *error)
{
    char prefix[IMKI_NPY_PREFIX];
    imk_status status = imki_packed_read(part, 0, prefix, sizeof prefix, error);
    if (status != IMK_OK)
        return status;
    const size_t size = imki_npy_header_size(prefix);
    if (size < sizeof prefix || size > HEADER_MAX)
        return imk_error_set(error, IMK_ERROR_FORMAT, "",
                             "the header of a member of the .npz file is damaged",
                             "a file that numpy.savez() wrote");
    *header = malloc(size);
    if (!*header)
        return imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
    memcpy(*header, prefix, sizeof prefix);
    status =
        imki_packed_read(part, sizeof prefix, *header + sizeof prefix, size - sizeof prefix, error);
    return status == IMK_OK ? imki_npy_array_read(*header, size, npy, error) : status;
}

static imk_status visit(void *context, const imki_zip_member *member, imk_error *error)
{
    reading *r = context;
    if (!imk_has_ending(member->name, ".npy"))
        return IMK_OK;
    if (member->encrypted || (member->method != 0 && member->method != 8)) {
        imki_array_strips *state = r->reader->state;
        imki_array_note(&state->rows.list, member->name,
                        member->encrypted ? "member that is encrypted"
                                          : "member that is packed by another method");
        return IMK_OK;
    }
    const imki_packed packed = {.file = imki_input_file(r->reader->text.input),
                                .begin = member->begin,
                                .size = member->packed,
                                .packing = member->method == 0 ? IMKI_PLAIN : IMKI_DEFLATE,
                                .name = member->name,
                                .has_crc = true,
                                .crc = member->crc,
                                .unpacked = member->unpacked};
    imki_unpacking part;
    imki_npy_array npy;
    char *header = NULL;
    imk_status status = imki_packed_open(&packed, &part, error);
    if (status == IMK_OK)
        status = read_header(&part, &header, &npy, error);
    if (status == IMK_OK && strcmp(member->name, "columns.npy") == 0)
        status = read_texts(&part, &npy, &r->columns, error);
    else if (status == IMK_OK && strcmp(member->name, "units.npy") == 0)
        status = read_texts(&part, &npy, &r->units, error);
    if (status == IMK_OK)
        status = add_array(r, member, &packed, &npy, error);
    imki_packed_close(&part);
    free(header);
    return status;
}

/* Names and units go to the arrays of these names, or to the columns of a matrix that has as many.
 */
static void apply_texts(reading *r)
{
    imki_array_strips *state = r->reader->state;
    imki_array_list *list = &state->rows.list;
    if (r->units.count == r->columns.count)
        for (size_t i = 0; i < r->columns.count; i++)
            imki_array_unit(list, "", r->columns.text[i], r->units.text[i]);
    for (size_t i = 0; i < list->count; i++) {
        imki_array *array = &list->array[i];
        if (r->columns.count < 2 || array->group[0] ||
            (array->extent[0] != r->columns.count && array->extent[1] != r->columns.count))
            continue;
        for (size_t k = 0; k < r->columns.count; k++) {
            const bool has_unit = r->units.count == r->columns.count && r->units.text[k][0];
            imki_append_text(array->labels, sizeof array->labels, r->columns.text[k]);
            if (has_unit) {
                imki_append_text(array->labels, sizeof array->labels, " [");
                imki_append_text(array->labels, sizeof array->labels, r->units.text[k]);
                imki_append_text(array->labels, sizeof array->labels, "]");
            }
            imki_append_text(array->labels, sizeof array->labels, "\n");
        }
    }
}

/* The first member's name ends in .npy. */
static bool recognise(const char *begin, size_t size)
{
    if (size < 30 || memcmp(begin, "PK\3\4", 4) != 0)
        return false;
    const size_t length = (unsigned char)begin[26] + 256u * (unsigned char)begin[27];
    return length > 4 && 30 + length <= size && memcmp(begin + 30 + length - 4, ".npy", 4) == 0;
}

static imk_status open_npz(imk_log_reader *reader, imk_error *error)
{
    imk_status status = imki_array_strips_make(reader, '/', error);
    if (status != IMK_OK)
        return status;
    reading r = {.reader = reader};
    status = imki_zip_members(imki_input_file(reader->text.input), visit, &r, error);
    if (status != IMK_OK)
        return status;
    apply_texts(&r);
    return imki_array_strips_begin(reader, error);
}

const imki_log_codec imki_log_npz = {.recognise = recognise,
                                     .needs_file = true,
                                     .open = open_npz,
                                     .read = imki_array_rows_read,
                                     .close = imki_array_strips_close,
                                     .seek = imki_array_strips_seek,
                                     .progress = imki_array_rows_progress,
                                     .create = imki_column_store_create,
                                     .format = imki_log_format_matrix,
                                     .write = imki_column_store_write,
                                     .end = imki_npz_end,
                                     .discard = imki_column_store_discard};
