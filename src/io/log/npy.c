/* SPDX-License-Identifier: Apache-2.0 */
/* The head of a .npy file [NPY]:
 *
 *     \x93NUMPY  major minor  length  {'descr': '<f8', 'fortran_order': False, 'shape': (9, 7), }\n
 *
 * length has 2 bytes in version 1 and 4 in versions 2 and 3, least significant first. Blanks before
 * the line end make the whole a multiple of 64. */
#include "npy_internal.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

static const char magic[6] = "\x93NUMPY";

size_t imki_npy_header_size(const char *prefix)
{
    const unsigned char *byte = (const unsigned char *)prefix;
    if (memcmp(prefix, magic, sizeof magic) != 0)
        return 0;
    if (byte[6] == 1)
        return 10 + byte[8] + 256u * byte[9];
    if (byte[6] == 2 || byte[6] == 3)
        return 12 + byte[8] + ((size_t)byte[9] << 8) + ((size_t)byte[10] << 16) +
               ((size_t)byte[11] << 24);
    return 0;
}

/* A place in the dictionary; every reader below stays before end. */
typedef struct cursor {
    const char *at, *end;
} cursor;

static void skip_blanks(cursor *c)
{
    while (c->at < c->end && (*c->at == ' ' || *c->at == '\t' || *c->at == '\n'))
        c->at++;
}

static bool take(cursor *c, char wanted)
{
    skip_blanks(c);
    if (c->at == c->end || *c->at != wanted)
        return false;
    c->at++;
    return true;
}

/* A quoted string, in either kind of quotes. */
static bool take_string(cursor *c, char *text, size_t size)
{
    skip_blanks(c);
    if (c->at == c->end || (*c->at != '\'' && *c->at != '"'))
        return false;
    const char quote = *c->at++;
    const char *begin = c->at;
    while (c->at < c->end && *c->at != quote)
        c->at++;
    const size_t length = (size_t)(c->at - begin);
    if (c->at == c->end || length >= size)
        return false;
    memcpy(text, begin, length);
    text[length] = '\0';
    c->at++;
    return true;
}

static bool take_word(cursor *c, const char *word)
{
    const size_t length = strlen(word);
    skip_blanks(c);
    if ((size_t)(c->end - c->at) < length || memcmp(c->at, word, length) != 0)
        return false;
    c->at += length;
    return true;
}

static bool take_count(cursor *c, uint64_t *count)
{
    skip_blanks(c);
    const char *begin = c->at;
    uint64_t value = 0;
    for (; c->at < c->end && *c->at >= '0' && *c->at <= '9'; c->at++) {
        const uint64_t digit = (uint64_t)(*c->at - '0');
        if (value > (UINT64_MAX - digit) / 10)
            return false;
        value = 10 * value + digit;
    }
    if (c->at == begin)
        return false;
    *count = value;
    return true;
}

/* (9, 7) or (9,). @param dimensions  how many there are; only the first two are kept */
static bool take_shape(cursor *c, uint64_t shape[2], size_t *dimensions)
{
    if (!take(c, '('))
        return false;
    for (*dimensions = 0; !take(c, ')'); (*dimensions)++) {
        uint64_t count;
        if (*dimensions > 32 || !take_count(c, &count))
            return false;
        if (*dimensions < 2)
            shape[*dimensions] = count;
        if (!take(c, ',')) {
            (*dimensions)++;
            return take(c, ')');
        }
    }
    return true;
}

typedef struct dictionary {
    imki_npy_array array;
    bool has_descr, has_order, has_shape;
} dictionary;

/* The type: a text, or the list of the fields of records, which is passed over. */
static bool take_type(cursor *c, char *type, size_t size)
{
    if (take_string(c, type, size))
        return true;
    const char *begin = c->at;
    size_t depth = 0;
    do {
        char text[256];
        if (c->at == c->end)
            return false;
        if (*c->at == '\'' || *c->at == '"') {
            if (!take_string(c, text, sizeof text))
                return false;
            continue;
        }
        if (*c->at == '[' || *c->at == '(')
            depth++;
        else if ((*c->at == ']' || *c->at == ')') && depth > 0)
            depth--;
        else if (depth == 0)
            return false;
        c->at++;
    } while (depth > 0);
    type[0] = '\0';
    return c->at > begin;
}

static bool take_entry(cursor *c, dictionary *d)
{
    char key[32];
    if (!take_string(c, key, sizeof key) || !take(c, ':'))
        return false;
    if (strcmp(key, "descr") == 0)
        return d->has_descr = take_type(c, d->array.type, sizeof d->array.type);
    if (strcmp(key, "fortran_order") == 0) {
        d->array.fortran_order = take_word(c, "True");
        return d->has_order = d->array.fortran_order || take_word(c, "False");
    }
    if (strcmp(key, "shape") == 0)
        return d->has_shape = take_shape(c, d->array.shape, &d->array.dimensions);
    return false;
}

static bool take_dictionary(cursor *c, dictionary *d)
{
    if (!take(c, '{'))
        return false;
    while (!take(c, '}')) {
        if (!take_entry(c, d))
            return false;
        if (!take(c, ','))
            return take(c, '}') && d->has_descr && d->has_order && d->has_shape;
    }
    return d->has_descr && d->has_order && d->has_shape;
}

imk_status imki_npy_array_read(const char *header, size_t size, imki_npy_array *array,
                               imk_error *error)
{
    const size_t header_size = size >= IMKI_NPY_PREFIX ? imki_npy_header_size(header) : 0;
    if (header_size == 0 || header_size > size)
        return imk_error_set(error, IMK_ERROR_FORMAT, "", "the header of the .npy file is damaged",
                             "a file that numpy.save() wrote");
    cursor c = {header + (header[6] == 1 ? 10 : 12), header + header_size};
    dictionary d = {.array.header_size = header_size};
    if (!take_dictionary(&c, &d))
        return imk_error_set(error, IMK_ERROR_FORMAT, "",
                             "the dictionary of the .npy file is damaged",
                             "a file that numpy.save() wrote");
    *array = d.array;
    return IMK_OK;
}

imk_status imki_npy_header_read(const char *header, size_t size, imki_npy *npy, imk_error *error)
{
    imki_npy_array array;
    const imk_status status = imki_npy_array_read(header, size, &array, error);
    if (status != IMK_OK)
        return status;
    const bool float64 = strcmp(array.type, "<f8") == 0, float32 = strcmp(array.type, "<f4") == 0;
    if (!float64 && !float32) {
        char found[64];
        snprintf(found, sizeof found, "the array type '%s' is not supported",
                 array.type[0] ? array.type : "record");
        return imk_error_set(error, IMK_ERROR_UNSUPPORTED, "", found,
                             "save the array as float64: array.astype('<f8')");
    }
    if (array.fortran_order)
        return imk_error_set(error, IMK_ERROR_UNSUPPORTED, "", "the array is in Fortran order",
                             "save numpy.ascontiguousarray(array)");
    if (array.dimensions != 1 && array.dimensions != 2) {
        char found[64];
        snprintf(found, sizeof found, "the array has %zu dimensions", array.dimensions);
        return imk_error_set(error, IMK_ERROR_UNSUPPORTED, "", found,
                             "a matrix of samples by columns");
    }
    npy->rows = array.shape[0];
    npy->columns = array.dimensions == 2 ? array.shape[1] : 1;
    npy->value_size = float64 ? 8 : 4;
    npy->header_size = array.header_size;
    return IMK_OK;
}

/* @param text  the dictionary, at most 112 characters */
static void write_header(const char *text, char header[IMKI_NPY_HEADER_SIZE])
{
    memset(header, ' ', IMKI_NPY_HEADER_SIZE);
    memcpy(header, magic, sizeof magic);
    header[6] = 1;
    header[7] = 0;
    header[8] = IMKI_NPY_HEADER_SIZE - 10;
    header[9] = 0;
    memcpy(header + 10, text, strlen(text));
    header[IMKI_NPY_HEADER_SIZE - 1] = '\n';
}

void imki_npy_header_write(uint64_t rows, uint64_t columns, char header[IMKI_NPY_HEADER_SIZE])
{
    /* Two numbers of 20 digits make at most 95 characters, so every shape fits and can be patched
     * in place. */
    char text[112];
    snprintf(text, sizeof text, "{'descr': '<f8', 'fortran_order': False, 'shape': (%llu, %llu), }",
             (unsigned long long)rows, (unsigned long long)columns);
    write_header(text, header);
}

void imki_npy_list_header_write(const char *type, uint64_t count, char header[IMKI_NPY_HEADER_SIZE])
{
    char text[112];
    snprintf(text, sizeof text, "{'descr': '%.12s', 'fortran_order': False, 'shape': (%llu,), }",
             type, (unsigned long long)count);
    write_header(text, header);
}
