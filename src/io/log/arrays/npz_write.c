/* SPDX-License-Identifier: Apache-2.0 */
/* A log as a .npz [NPY]: a zip of stored members [ZIP], columns.npy and units.npy with the names
 * and units as texts, then a vector of float64 for each column. All sizes are known before anything
 * is written. Members carry the first date that zip has, so that equal logs are equal bytes. */
#include "npz_write_internal.h"

#include "column_store_internal.h"
#include "io/file/file_bytes_internal.h"
#include "io/log/npy_internal.h"

#include <stdio.h>
#include <string.h>
#include <zlib.h>

enum {
    CHARACTERS = 64,            /* of a text, 4 bytes each */
    TEXT_SIZE = 4 * CHARACTERS, /* bytes */
    MEMBERS = IMK_LOG_COLUMNS_MAX + 2
};

static const uint32_t large = 0xFFFFFFFF; /* "it is in the extra field" */

typedef struct member {
    char name[72];
    uint64_t size, place;
    uint32_t crc;
} member;

typedef struct archive {
    imki_log_output *log;
    member member[MEMBERS];
    size_t count;
    uint64_t place; /* bytes written */
} archive;

static void put(archive *a, const void *bytes, size_t size)
{
    imk_output_file_write(a->log->file, bytes, size);
    a->place += size;
}

/* The extra field with sizes and place. @return its bytes; 0: none of them is large */
static size_t make_extra(const member *m, bool local, unsigned char extra[28])
{
    const bool sizes = m->size >= large, place = !local && m->place >= large;
    size_t at = 4;
    for (int i = 0; i < 2 && sizes; i++, at += 8)
        imki_put_number(extra + at, m->size, 8);
    if (place) {
        imki_put_number(extra + at, m->place, 8);
        at += 8;
    }
    imki_put_number(extra, 1, 2);
    imki_put_number(extra + 2, at - 4, 2);
    return sizes || place ? at : 0;
}

/* What the local head and the entry of the directory have in common: from the version that is
 * needed to the length of the extra field, 26 bytes. */
static void make_common(const member *m, size_t extra, unsigned char at[26])
{
    const uint32_t size = m->size >= large ? large : (uint32_t)m->size;
    memset(at, 0, 26);
    imki_put_number(at, extra > 0 ? 45 : 20, 2);
    imki_put_number(at + 2, 0x0800, 2); /* names in UTF-8 */
    imki_put_number(at + 8, 0x21, 2);   /* 1980-01-01 */
    imki_put_number(at + 10, m->crc, 4);
    imki_put_number(at + 14, size, 4);
    imki_put_number(at + 18, size, 4);
    imki_put_number(at + 22, strlen(m->name), 2);
    imki_put_number(at + 24, extra, 2);
}

static void put_local(archive *a, member *m)
{
    unsigned char head[30] = "PK\3\4", extra[28];
    m->place = a->place;
    const size_t size = make_extra(m, true, extra);
    make_common(m, size, head + 4);
    put(a, head, sizeof head);
    put(a, m->name, strlen(m->name));
    put(a, extra, size);
}

static void put_entry(archive *a, const member *m)
{
    unsigned char entry[46] = "PK\1\2", extra[28];
    const size_t size = make_extra(m, false, extra);
    imki_put_number(entry + 4, 45, 2);
    make_common(m, size, entry + 6);
    imki_put_number(entry + 42, m->place >= large ? large : (uint32_t)m->place, 4);
    put(a, entry, sizeof entry);
    put(a, m->name, strlen(m->name));
    put(a, extra, size);
}

/* The directory, and what says where it is. */
static void put_directory(archive *a)
{
    const uint64_t begin = a->place;
    for (size_t i = 0; i < a->count; i++)
        put_entry(a, &a->member[i]);
    const uint64_t size = a->place - begin, end64 = a->place;
    unsigned char record[56] = "PK\6\6", locator[20] = "PK\6\7", end[22] = "PK\5\6";
    if (begin >= large) {
        imki_put_number(record + 4, sizeof record - 12, 8);
        imki_put_number(record + 12, 45, 2);
        imki_put_number(record + 14, 45, 2);
        imki_put_number(record + 24, a->count, 8);
        imki_put_number(record + 32, a->count, 8);
        imki_put_number(record + 40, size, 8);
        imki_put_number(record + 48, begin, 8);
        imki_put_number(locator + 8, end64, 8);
        imki_put_number(locator + 16, 1, 4);
        put(a, record, sizeof record);
        put(a, locator, sizeof locator);
    }
    imki_put_number(end + 8, a->count, 2);
    imki_put_number(end + 10, a->count, 2);
    imki_put_number(end + 12, size, 4);
    imki_put_number(end + 16, begin >= large ? large : (uint32_t)begin, 4);
    put(a, end, sizeof end);
}

/* Characters of 4 bytes. */
static void make_text(const char *text, unsigned char characters[TEXT_SIZE])
{
    memset(characters, 0, TEXT_SIZE);
    for (size_t i = 0; i < CHARACTERS && *text; i++) {
        const unsigned char first = (unsigned char)*text++;
        uint32_t code = first < 0x80   ? first
                        : first < 0xE0 ? first & 31u
                        : first < 0xF0 ? first & 15u
                                       : first & 7u;
        while (((unsigned char)*text & 0xC0) == 0x80)
            code = code << 6 | ((unsigned char)*text++ & 0x3F);
        imki_put_number(characters + 4 * i, code, 4);
    }
}

/* A member of the names or units of all columns. */
static void put_texts(archive *a, const char *name, bool units)
{
    const imki_column_store *store = a->log->state;
    char type[8], header[IMKI_NPY_HEADER_SIZE];
    unsigned char text[TEXT_SIZE];
    member *m = &a->member[a->count++];
    snprintf(m->name, sizeof m->name, "%s", name);
    snprintf(type, sizeof type, "<U%d", CHARACTERS);
    imki_npy_list_header_write(type, store->columns, header);
    m->size = sizeof header + store->columns * TEXT_SIZE;
    for (int pass = 0; pass < 2; pass++) { /* the checksum stands before the bytes */
        if (pass == 0)
            m->crc = imki_crc(0, header, sizeof header);
        else {
            put_local(a, m);
            put(a, header, sizeof header);
        }
        for (size_t i = 0; i < store->columns; i++) {
            make_text(units ? a->log->column[i].unit.text : store->name[i], text);
            if (pass == 0)
                m->crc = imki_crc(m->crc, text, sizeof text);
            else
                put(a, text, sizeof text);
        }
    }
}

static imk_status put_column(archive *a, size_t column, imk_error *error)
{
    const imki_column_store *store = a->log->state;
    char header[IMKI_NPY_HEADER_SIZE];
    member *m = &a->member[a->count++];
    const uint64_t size = store->rows * 8;
    snprintf(m->name, sizeof m->name, "%s.npy", store->name[column]);
    imki_npy_list_header_write("<f8", store->rows, header);
    m->size = sizeof header + size;
    m->crc = (uint32_t)crc32_combine(imki_crc(0, header, sizeof header), store->crc[column],
                                     (z_off_t)size);
    put_local(a, m);
    put(a, header, sizeof header);
    a->place += size;
    return imki_column_store_put(a->log, column, error);
}

imk_status imki_npz_end(imki_log_output *log, imk_error *error)
{
    const imki_column_store *store = log->state;
    archive a = {.log = log};
    imk_status status = imki_column_store_end(log, error);
    if (status != IMK_OK)
        return status;
    imki_column_names(log, "units");
    put_texts(&a, "columns.npy", false);
    put_texts(&a, "units.npy", true);
    for (size_t i = 0; i < store->columns && status == IMK_OK; i++)
        status = put_column(&a, i, error);
    put_directory(&a);
    return status;
}
