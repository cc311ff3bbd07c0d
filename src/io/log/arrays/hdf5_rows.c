/* SPDX-License-Identifier: Apache-2.0 */
/* Rows of an HDF5 file, as they are asked for. All columns of a dataset are read at once, because
 * its chunks are unpacked as a whole: so a dataset's cache holds a row of its chunks. */
#define _POSIX_C_SOURCE 200809L
#include "child_process_internal.h"
#include "hdf5_reader_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { VALUE = 8, ROWS_MAX = 1 << 14 };
static const size_t cache_usual = 1 << 20, cache_most = (size_t)256 << 20; /* bytes */

/* A column that is asked for. */
typedef struct column {
    const imki_hdf5_array *array;
    uint32_t part;
    size_t source;
    size_t offset; /* in a record */
} column;

/* A dataset with what is read of it. */
typedef struct source {
    const imki_hdf5_array *array; /* its first */
    hid_t dataset, type;          /* the type in memory */
    bool along_second;            /* its rows are along the second dimension */
    size_t record;                /* bytes of a row in memory */
    hsize_t parts;                /* columns of a matrix; 1 of records */
    unsigned char *bytes;
} source;

typedef struct service {
    const imki_hdf5_list *list;
    column column[IMK_LOG_COLUMNS_MAX];
    source source[IMK_LOG_COLUMNS_MAX];
    size_t count, sources;
    uint64_t rows;
    unsigned char *values; /* column after column */
} service;

void imki_hdf5_fail(int socket, const char *found, const char *expected)
{
    imki_array_other said;
    const imki_message message = {.kind = IMKI_MESSAGE_FAILED, .size = sizeof said};
    memset(&said, 0, sizeof said);
    snprintf(said.name, sizeof said.name, "%s", found);
    snprintf(said.kind, sizeof said.kind, "%s", expected);
    if (imki_socket_send(socket, &message, sizeof message))
        imki_socket_send(socket, &said, sizeof said);
}

hid_t imki_hdf5_memory_type(imki_value_type type)
{
    return type == IMKI_INT64    ? H5T_NATIVE_INT64
           : type == IMKI_UINT64 ? H5T_NATIVE_UINT64
                                 : H5T_NATIVE_DOUBLE;
}

/* Bytes of the chunks that the rows of a block are in: one behind the other along the columns. */
static size_t cache_of(const imki_hdf5_array *array, hid_t how, size_t value)
{
    const uint64_t extent[2] = {array->extent[array->flipped], array->extent[!array->flipped]};
    const int across = extent[0] >= extent[1];
    hsize_t chunk[2] = {1, 1};
    if (H5Pget_layout(how) != H5D_CHUNKED || H5Pget_chunk(how, 2, chunk) < 1)
        return 0;
    const double chunks = ceil((double)extent[across] / (double)chunk[across]);
    const double bytes = (double)chunk[0] * (double)chunk[1] * (double)value * chunks;
    return bytes < (double)cache_most ? (size_t)bytes : cache_most;
}

static hid_t open_dataset(const service *s, const imki_hdf5_array *array)
{
    const hid_t first = H5Dopen2(s->list->file, array->path, H5P_DEFAULT);
    if (first < 0)
        return first;
    const hid_t how = H5Dget_create_plist(first), type = H5Dget_type(first);
    const hid_t access = H5Pcreate(H5P_DATASET_ACCESS);
    const size_t cache = cache_of(array, how, H5Tget_size(type));
    if (cache > cache_usual)
        H5Pset_chunk_cache(access, H5D_CHUNK_CACHE_NSLOTS_DEFAULT, cache, 1.0);
    H5Dclose(first);
    const hid_t dataset = H5Dopen2(s->list->file, array->path, access);
    H5Pclose(access);
    H5Tclose(type);
    H5Pclose(how);
    return dataset;
}

/* Add a member of the records to what is read of them. @return its place in a record */
static bool add_member(source *from, const imki_hdf5_array *array, size_t *offset)
{
    const hid_t whole = H5Dget_type(from->dataset);
    char *name = H5Tget_member_name(whole, (unsigned)array->member);
    const hsize_t parts = array->extent[1];
    const hid_t value = parts > 1 ? H5Tarray_create2(imki_hdf5_memory_type(array->type), 1, &parts)
                                  : H5Tcopy(imki_hdf5_memory_type(array->type));
    bool added = true;
    const int there = name ? H5Tget_member_index(from->type, name) : -1;
    if (there >= 0)
        *offset = H5Tget_member_offset(from->type, (unsigned)there);
    else {
        *offset = from->record;
        from->record += (size_t)parts * VALUE;
        added = name && H5Tset_size(from->type, from->record) >= 0 &&
                H5Tinsert(from->type, name, *offset, value) >= 0;
    }
    H5Tclose(value);
    H5free_memory(name);
    H5Tclose(whole);
    return added;
}

/* The dataset of a column. @return false: it cannot be read */
static bool find_source(service *s, column *c)
{
    const imki_hdf5_array *array = c->array;
    size_t i = 0;
    while (i < s->sources && strcmp(s->source[i].array->path, array->path) != 0)
        i++;
    source *from = &s->source[i];
    if (i == s->sources) {
        *from = (source){.array = array, .dataset = open_dataset(s, array), .parts = 1};
        from->type = array->member >= 0 ? H5Tcreate(H5T_COMPOUND, 1)
                                        : H5Tcopy(imki_hdf5_memory_type(array->type));
        s->sources++;
        if (from->dataset < 0 || from->type < 0)
            return false;
        if (array->member < 0) {
            const int along = array->extent[0] != s->rows;
            from->parts = array->extent[!along];
            from->along_second = (along != 0) != array->flipped;
            from->record = (size_t)from->parts * VALUE;
        }
    }
    c->source = i;
    c->offset = 0;
    return array->member < 0 || add_member(from, array, &c->offset);
}

/* Both sides know the arrays, and how long they are. */
static bool receive_columns(service *s)
{
    uint32_t head[2];
    uint64_t rows;
    const int socket = s->list->socket;
    if (!imki_socket_receive(socket, &head[0], sizeof head[0]) ||
        !imki_socket_receive(socket, &rows, sizeof rows) || head[0] > IMK_LOG_COLUMNS_MAX)
        return false;
    s->count = head[0];
    s->rows = rows;
    for (size_t i = 0; i < s->count; i++) {
        if (!imki_socket_receive(socket, head, sizeof head) || head[0] >= s->list->count)
            return false;
        s->column[i] = (column){.array = &s->list->array[head[0]], .part = head[1]};
        if (!find_source(s, &s->column[i])) {
            imki_hdf5_fail(socket, "a dataset cannot be opened", "copy the file again");
            return false;
        }
    }
    bool enough = (s->values = malloc(s->count * ROWS_MAX * VALUE + 1)) != NULL;
    for (size_t i = 0; i < s->sources; i++)
        enough =
            (s->source[i].bytes = malloc(ROWS_MAX * s->source[i].record + 1)) != NULL && enough;
    if (!enough)
        imki_hdf5_fail(socket, "", "");
    return enough;
}

static bool read_source(const source *from, uint64_t first, uint32_t count)
{
    const int rank = from->array->rank;
    hsize_t begin[2] = {first, 0}, size[2] = {count, from->parts};
    if (rank == 2 && from->along_second) {
        begin[0] = 0;
        begin[1] = first;
        size[0] = from->parts;
        size[1] = count;
    }
    const hid_t space = H5Dget_space(from->dataset);
    const hid_t here = rank > 0 ? H5Screate_simple(rank, size, NULL) : H5Screate(H5S_SCALAR);
    const bool read =
        (rank == 0 || H5Sselect_hyperslab(space, H5S_SELECT_SET, begin, NULL, size, NULL) >= 0) &&
        H5Dread(from->dataset, from->type, here, space, H5P_DEFAULT, from->bytes) >= 0;
    H5Sclose(here);
    H5Sclose(space);
    return read;
}

/* The values of a column out of the rows of its dataset. */
static void take_column(const service *s, size_t index, uint32_t count)
{
    const column *c = &s->column[index];
    const source *from = &s->source[c->source];
    unsigned char *to = s->values + index * count * VALUE;
    const size_t step = from->along_second ? VALUE : from->record;
    const unsigned char *at =
        from->bytes + c->offset + c->part * (from->along_second ? count * (size_t)VALUE : VALUE);
    for (uint32_t i = 0; i < count; i++)
        memcpy(to + i * VALUE, at + i * step, VALUE);
}

void imki_hdf5_give_rows(const imki_hdf5_list *list)
{
    service *s = calloc(1, sizeof *s);
    imki_rows_request request;
    if (!s) {
        imki_hdf5_fail(list->socket, "", "");
        return;
    }
    s->list = list;
    bool good = receive_columns(s);
    while (good && imki_socket_receive(list->socket, &request, sizeof request)) {
        if (request.count > ROWS_MAX || request.first > s->rows ||
            request.count > s->rows - request.first)
            break;
        imki_child_continue();
        for (size_t i = 0; i < s->sources && good; i++)
            good = read_source(&s->source[i], request.first, request.count);
        if (!good) {
            imki_hdf5_fail(list->socket, "the values of a dataset cannot be read",
                           "copy the file again; chunks beyond 1 GiB are not read");
            break;
        }
        const imki_message message = {.kind = IMKI_MESSAGE_ROWS,
                                      .size = (uint32_t)(s->count * request.count * VALUE)};
        for (size_t i = 0; i < s->count; i++)
            take_column(s, i, request.count);
        good = imki_socket_send(list->socket, &message, sizeof message) &&
               imki_socket_send(list->socket, s->values, message.size);
    }
    for (size_t i = 0; i < s->sources; i++)
        free(s->source[i].bytes);
    free(s->values);
    free(s);
}

/* The usual driver of libhdf5 asks for the real path, which the copy of a pipe does not have. */
static hid_t open_file(int number)
{
    char path[32];
    struct stat about;
    const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    if (fstat(number, &about) == 0 && about.st_nlink == 0)
        H5Pset_fapl_stdio(access);
    snprintf(path, sizeof path, "/dev/fd/%d", number);
#if H5_VERSION_GE(1, 10, 7)
    H5Pset_file_locking(access, false, true);
#endif
    const hid_t file = H5Fopen(path, H5F_ACC_RDONLY, access);
    H5Pclose(access);
    return file;
}

void imki_hdf5_serve(int file, int socket)
{
    imki_hdf5_list list = {.socket = socket,
                           .array = calloc(IMKI_ARRAYS_MAX, sizeof(imki_hdf5_array))};
    H5PLset_loading_state(0); /* no filters from folders of others */
    list.file = open_file(file);
    if (!list.array)
        imki_hdf5_fail(socket, "", "");
    else if (list.file < 0)
        imki_hdf5_fail(socket, "the HDF5 file is damaged or cut short", "copy the file again");
    else if (imki_hdf5_list_all(&list))
        imki_hdf5_give_rows(&list);
    free(list.array);
}
