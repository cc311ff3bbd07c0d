/* SPDX-License-Identifier: Apache-2.0 */
/* What is said about a dataset of an HDF5 file: texts in attributes, and where its values are. */
#define _POSIX_C_SOURCE 200809L
#include "base/text_internal.h"
#include "hdf5_reader_internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TEXTS_MAX = IMK_LOG_COLUMNS_MAX, TEXT_MAX = 256, RATIO = 1100 /* zlib packs 1032 to 1 */ };

/* A text of fixed size, without what fills it up, becomes a line. */
static void add_line(const char *from, size_t most, size_t size, char *texts)
{
    char line[TEXT_MAX];
    size_t length = strnlen(from, most < sizeof line ? most : sizeof line - 1);
    while (length > 0 && from[length - 1] == ' ')
        length--;
    memcpy(line, from, length);
    line[length] = '\0';
    for (char *c = line; *c; c++)
        *c = *c == '\n' ? ' ' : *c;
    imki_append_text(texts, size, line);
    imki_append_text(texts, size, "\n");
}

/* Texts whose lengths differ are in memory of libhdf5. */
static bool read_pointers(hid_t attribute, hid_t space, size_t count, size_t size, char *texts)
{
    char *text[TEXTS_MAX] = {NULL};
    const hid_t type = H5Tcopy(H5T_C_S1);
    const hid_t own = H5Aget_type(attribute);
    const bool read = H5Tset_size(type, H5T_VARIABLE) >= 0 &&
                      H5Tset_cset(type, H5Tget_cset(own)) >= 0 &&
                      H5Aread(attribute, type, text) >= 0;
    for (size_t i = 0; i < count && read; i++)
        add_line(text[i] ? text[i] : "", TEXT_MAX, size, texts);
    if (read)
        H5Dvlen_reclaim(type, space, H5P_DEFAULT, text);
    H5Tclose(own);
    H5Tclose(type);
    return read;
}

static bool read_fixed(hid_t attribute, hid_t type, size_t count, size_t size, char *texts)
{
    const size_t width = H5Tget_size(type);
    char *bytes = width > 0 && width <= TEXT_MAX ? calloc(count, width) : NULL;
    const bool read = bytes && H5Aread(attribute, type, bytes) >= 0;
    for (size_t i = 0; i < count && read; i++)
        add_line(bytes + i * width, width, size, texts);
    free(bytes);
    return read;
}

static size_t read_texts(hid_t attribute, size_t size, char *texts)
{
    const hid_t type = H5Aget_type(attribute), space = H5Aget_space(attribute);
    const hssize_t count = H5Sget_simple_extent_npoints(space);
    bool read = false;
    texts[0] = '\0';
    if (H5Tget_class(type) == H5T_STRING && count > 0 && count <= TEXTS_MAX)
        read = H5Tis_variable_str(type) > 0
                   ? read_pointers(attribute, space, (size_t)count, size, texts)
                   : read_fixed(attribute, type, (size_t)count, size, texts);
    H5Sclose(space);
    H5Tclose(type);
    return read ? (size_t)count : 0;
}

size_t imki_hdf5_texts(hid_t object, const char *const *names, size_t size, char *texts)
{
    size_t count = 0;
    texts[0] = '\0';
    for (; *names && count == 0; names++) {
        if (H5Aexists(object, *names) <= 0)
            continue;
        const hid_t attribute = H5Aopen(object, *names, H5P_DEFAULT);
        if (attribute >= 0) {
            count = read_texts(attribute, size, texts);
            H5Aclose(attribute);
        }
    }
    return count;
}

const char *imki_hdf5_obstacle(hid_t dataset, uint64_t values, uint64_t file_size)
{
    const char *obstacle = NULL;
    const hid_t how = H5Dget_create_plist(dataset);
    const int filters = H5Pget_nfilters(how);
    if (H5Pget_layout(how) == H5D_VIRTUAL || H5Pget_external_count(how) > 0)
        obstacle = "dataset with values in another file";
    for (int i = 0; i < filters && !obstacle; i++) {
        unsigned flags, settings;
        size_t count = 0;
        const H5Z_filter_t filter =
            H5Pget_filter2(how, (unsigned)i, &flags, &count, NULL, 0, NULL, &settings);
        if (filter >= 0 && H5Zfilter_avail(filter) <= 0)
            obstacle = "dataset of a compression libhdf5 lacks";
    }
    H5Pclose(how);
    if (!obstacle && values / RATIO > file_size)
        obstacle = "dataset that is larger than its file can hold";
    return obstacle;
}
