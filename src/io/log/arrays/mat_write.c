/* SPDX-License-Identifier: Apache-2.0 */
/* A log as a MAT-file of version 5 [MAT5]: a column vector of doubles for each column, and a
 * structure `units`, whose fields have the same names and are texts. Nothing is compressed. */
#include "mat_write_internal.h"

#include "column_store_internal.h"
#include "io/file/file_bytes_internal.h"
#include "mat_elements_internal.h"

#include <stdio.h>
#include <string.h>

enum {
    FIELD_NAME = 64,           /* bytes, the last one zero */
    ROWS_MAX = (1 << 28) - 64, /* so that the bytes of a variable are less than 2^31 */
    HEAD_TEXT = 116
};

/* Elements that are made before their size is known, or their size before them. */
typedef struct bytes {
    unsigned char at[256];
    size_t size;
} bytes;

static size_t padded(size_t size)
{
    return (size + 7) / 8 * 8;
}

static void add_tag(bytes *b, uint32_t type, size_t size)
{
    imki_put_number(b->at + b->size, type, 4);
    imki_put_number(b->at + b->size + 4, size, 4);
    b->size += 8;
}

/* What has up to 4 bytes is in the tag: other programs take that for granted.
 * @param data  up to 64 bytes */
static void add_element(bytes *b, uint32_t type, const void *data, size_t size)
{
    const bool is_short = size > 0 && size <= 4;
    memset(b->at + b->size, 0, 8);
    if (is_short)
        imki_put_number(b->at + b->size, type | (uint32_t)size << 16, 4);
    else
        add_tag(b, type, size);
    b->size += is_short ? 4 : 0;
    const size_t room = is_short ? 4 : padded(size);
    memset(b->at + b->size, 0, room);
    memcpy(b->at + b->size, data, size);
    b->size += room;
}

/* Flags, dimensions, name. */
static void add_head(bytes *b, uint32_t array_class, uint64_t rows, uint64_t columns,
                     const char *name)
{
    unsigned char flags[8] = {(unsigned char)array_class}, extent[8];
    imki_put_number(extent, rows, 4);
    imki_put_number(extent + 4, columns, 4);
    add_element(b, IMKI_MAT_UINT32, flags, sizeof flags);
    add_element(b, IMKI_MAT_INT32, extent, sizeof extent);
    add_element(b, IMKI_MAT_INT8, name, strlen(name));
}

/* An array as a whole: its tag and its content, to which `behind` more bytes are added. */
static void put_array(imki_log_output *log, const bytes *content, size_t behind)
{
    bytes tag = {.size = 0};
    add_tag(&tag, IMKI_MAT_MATRIX, content->size + behind);
    imk_output_file_write(log->file, tag.at, tag.size);
    imk_output_file_write(log->file, content->at, content->size);
}

static size_t characters(const char *text)
{
    size_t count = 0;
    for (; *text; text++)
        count += ((unsigned char)*text & 0xC0) != 0x80;
    return count;
}

/* The text of a unit as an array without a name. */
static void make_unit(const imk_log_column *column, bytes *content)
{
    const char *text = column->unit.text;
    content->size = 0;
    add_head(content, IMKI_MAT_CHAR, 1, characters(text), "");
    add_element(content, IMKI_MAT_UTF8, text, strlen(text));
}

static void put_units(imki_log_output *log)
{
    const imki_column_store *store = log->state;
    static const unsigned char length[4] = {FIELD_NAME};
    bytes head = {.size = 0}, unit = {.size = 0}, names = {.size = 0};
    size_t count = 0, behind = 0;
    for (size_t i = 0; i < store->columns; i++) {
        if (!log->column[i].unit.text[0])
            continue;
        make_unit(&log->column[i], &unit);
        behind += 8 + unit.size;
        count++;
    }
    if (count == 0)
        return;
    add_head(&head, IMKI_MAT_STRUCT, 1, 1, "units");
    add_element(&head, IMKI_MAT_INT32, length, sizeof length);
    add_tag(&names, IMKI_MAT_INT8, count * FIELD_NAME);
    put_array(log, &head, names.size + count * FIELD_NAME + behind);
    imk_output_file_write(log->file, names.at, names.size);
    for (size_t i = 0; i < store->columns; i++)
        if (log->column[i].unit.text[0])
            imk_output_file_write(log->file, store->name[i], FIELD_NAME);
    for (size_t i = 0; i < store->columns; i++)
        if (log->column[i].unit.text[0]) {
            make_unit(&log->column[i], &unit);
            put_array(log, &unit, 0);
        }
}

static void put_head(imki_log_output *log)
{
    unsigned char head[IMKI_MAT_HEAD];
    memset(head, ' ', HEAD_TEXT);
    static const char text[] = "MATLAB 5.0 MAT-file, a log written by imukit";
    memcpy(head, text, sizeof text - 1);
    memset(head + HEAD_TEXT, 0, 8);
    imki_put_number(head + 124, 0x0100, 2);
    memcpy(head + 126, "IM", 2);
    imk_output_file_write(log->file, head, sizeof head);
}

static imk_status refuse_rows(uint64_t rows, imk_error *error)
{
    char found[96];
    snprintf(found, sizeof found, "%llu rows are more than a MAT-file of version 5 can hold",
             (unsigned long long)rows);
    return imk_error_set(error, IMK_ERROR_UNSUPPORTED, "", found,
                         "write a .h5, which MATLAB reads with h5read()");
}

imk_status imki_mat_create(imki_log_output *log, const char *path, imk_error *error)
{
    if (log->announced > ROWS_MAX)
        return refuse_rows(log->announced, error);
    return imki_column_store_create(log, path, error);
}

imk_status imki_mat_end(imki_log_output *log, imk_error *error)
{
    imki_column_store *store = log->state;
    imk_status status = imki_column_store_end(log, error);
    if (status == IMK_OK && store->rows > ROWS_MAX)
        status = refuse_rows(store->rows, error);
    if (status != IMK_OK)
        return status;
    imki_column_names(log, "units");
    put_head(log);
    for (size_t i = 0; i < store->columns && status == IMK_OK; i++) {
        bytes head = {.size = 0};
        add_head(&head, IMKI_MAT_DOUBLE_CLASS, store->rows, 1, store->name[i]);
        add_tag(&head, IMKI_MAT_DOUBLE, (size_t)store->rows * 8);
        put_array(log, &head, (size_t)store->rows * 8);
        status = imki_column_store_put(log, i, error);
    }
    put_units(log);
    return status;
}
