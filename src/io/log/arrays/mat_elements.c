/* SPDX-License-Identifier: Apache-2.0 */
/* A MAT-file of version 5 [MAT5] is a head of 128 bytes and elements:
 *
 *     a tag        type and number of bytes, 4 bytes each; data; padding to 8 bytes
 *     a short tag  in its first 4 bytes, as one number: 2^16 times the number of bytes (1 ... 4),
 *                  plus the type; then the data
 *
 * At the top are arrays (miMATRIX), or one in zlib's compression (miCOMPRESSED, not padded). An
 * array consists of elements: flags, dimensions, name, and then what its class has. An object that
 * only MATLAB can read (opaque) has no dimensions, but its name, that of a system of types, and
 * that of its class. */
#include "mat_elements_internal.h"

#include <string.h>

static imk_status refuse(const char *what, imk_error *error)
{
    return imk_error_set(error, IMK_ERROR_FORMAT, "", what, "copy the file again");
}

uint32_t imki_mat_number(const unsigned char *at, bool swapped)
{
    uint32_t value;
    memcpy(&value, at, sizeof value);
    return swapped ? __builtin_bswap32(value) : value;
}

imk_status imki_mat_tag_read(imki_mat_bytes *bytes, uint64_t at, uint64_t end, imki_mat_tag *tag,
                             imk_error *error)
{
    if (at > end || end - at < sizeof tag->head)
        return refuse("the MAT-file is cut short within an array", error);
    const imk_status status =
        imki_packed_read(&bytes->part, at, tag->head, sizeof tag->head, error);
    if (status != IMK_OK)
        return status;
    const uint32_t first = imki_mat_number(tag->head, bytes->swapped);
    tag->is_short = first >> 16 != 0;
    tag->type = first & 0xFFFF;
    tag->size = tag->is_short ? first >> 16 : imki_mat_number(tag->head + 4, bytes->swapped);
    tag->data = at + (tag->is_short ? 4 : 8);
    if (tag->is_short && tag->size > 4)
        return refuse("an array of the MAT-file is damaged", error);
    if (tag->size > end - tag->data)
        return refuse("the MAT-file is cut short within an array", error);
    const uint64_t padding = tag->type == IMKI_MAT_COMPRESSED ? 0 : (8 - tag->size % 8) % 8;
    tag->next = tag->is_short ? at + 8 : tag->data + tag->size + padding;
    return IMK_OK;
}

imk_status imki_mat_data(imki_mat_bytes *bytes, const imki_mat_tag *tag, void *data, size_t size,
                         imk_error *error)
{
    if (tag->size < size)
        return refuse("an array of the MAT-file is damaged", error);
    if (tag->is_short) {
        memcpy(data, tag->head + 4, size);
        return IMK_OK;
    }
    return imki_packed_read(&bytes->part, tag->data, data, size, error);
}

/* A name of up to 63 bytes; what is longer is cut, as MATLAB cuts it. */
static imk_status read_name(imki_mat_bytes *bytes, uint64_t at, uint64_t end, char name[64],
                            uint64_t *next, imk_error *error)
{
    imki_mat_tag tag;
    imk_status status = imki_mat_tag_read(bytes, at, end, &tag, error);
    const size_t size = status == IMK_OK && tag.size < 63 ? (size_t)tag.size : 63;
    if (status == IMK_OK)
        status = imki_mat_data(bytes, &tag, name, size, error);
    if (status != IMK_OK)
        return status;
    name[size] = '\0';
    *next = tag.next;
    return IMK_OK;
}

/* Name, system of types, class. */
static imk_status read_opaque(imki_mat_bytes *bytes, uint64_t at, uint64_t end, imki_mat_head *head,
                              imk_error *error)
{
    char system[64], kind[64];
    imk_status status = read_name(bytes, at, end, head->name, &at, error);
    if (status == IMK_OK)
        status = read_name(bytes, at, end, system, &at, error);
    if (status == IMK_OK)
        status = read_name(bytes, at, end, kind, &at, error);
    head->content = end;
    if (status == IMK_OK)
        memcpy(head->type_name, kind, sizeof kind);
    return status;
}

static imk_status read_dimensions(imki_mat_bytes *bytes, uint64_t at, uint64_t end,
                                  imki_mat_head *head, uint64_t *next, imk_error *error)
{
    imki_mat_tag tag;
    unsigned char extent[8];
    imk_status status = imki_mat_tag_read(bytes, at, end, &tag, error);
    if (status == IMK_OK && (tag.type != IMKI_MAT_INT32 || tag.size % 4 != 0))
        status = refuse("an array of the MAT-file is damaged", error);
    if (status == IMK_OK) /* MATLAB writes two at least */
        status = imki_mat_data(bytes, &tag, extent, sizeof extent, error);
    if (status != IMK_OK)
        return status;
    head->dimensions = (size_t)(tag.size / 4);
    for (size_t i = 0; i < 2; i++)
        head->extent[i] = imki_mat_number(extent + 4 * i, bytes->swapped);
    if (head->extent[0] > INT32_MAX || head->extent[1] > INT32_MAX)
        return refuse("an array of the MAT-file is damaged", error);
    *next = tag.next;
    return IMK_OK;
}

imk_status imki_mat_head_read(imki_mat_bytes *bytes, uint64_t at, uint64_t end, imki_mat_head *head,
                              imk_error *error)
{
    imki_mat_tag tag;
    unsigned char flags[8];
    *head = (imki_mat_head){0};
    imk_status status = imki_mat_tag_read(bytes, at, end, &tag, error);
    if (status == IMK_OK && tag.type != IMKI_MAT_UINT32)
        status = refuse("an array of the MAT-file is damaged", error);
    if (status == IMK_OK)
        status = imki_mat_data(bytes, &tag, flags, sizeof flags, error);
    if (status != IMK_OK)
        return status;
    const uint32_t word = imki_mat_number(flags, bytes->swapped);
    head->array_class = word & 0xFF;
    head->complex = (word & 0x800) != 0;
    at = tag.next;
    if (head->array_class == IMKI_MAT_OPAQUE)
        return read_opaque(bytes, at, end, head, error);
    status = read_dimensions(bytes, at, end, head, &at, error);
    return status == IMK_OK ? read_name(bytes, at, end, head->name, &head->content, error) : status;
}
