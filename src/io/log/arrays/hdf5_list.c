/* SPDX-License-Identifier: Apache-2.0 */
/* The arrays of an HDF5 file [HDF5], in all of its groups: datasets of numbers of up to two
 * dimensions, and the members of records (tables), which are numbers or lists of them. Links that
 * lead elsewhere are not followed. Files of MATLAB 7.3 say in the attribute MATLAB_class what the
 * numbers are; their dimensions are in the other order. */
#define _POSIX_C_SOURCE 200809L
#include "base/text_internal.h"
#include "child_process_internal.h"
#include "hdf5_reader_internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { OBJECTS_MAX = 4096, UNITS_MAX = 64 };

typedef struct object_key {
    unsigned char byte[16];
} object_key;

/* What is kept while the groups are gone through. */
typedef struct walk {
    imki_hdf5_list *list;
    hsize_t file_size;
    object_key seen[OBJECTS_MAX]; /* groups, which may contain each other */
    size_t seen_count, objects;
    imki_array_message unit[UNITS_MAX]; /* texts of MATLAB's structures `units` */
    size_t unit_count;
    bool gone; /* the parent, or too many objects */
} walk;

static const char *const unit_names[] = {"units", "unit", "Units", "Unit", NULL};
static const char *const label_names[] = {"columns", "column_names", "names",
                                          "fields",  "labels",       NULL};
static const char *const class_names[] = {"MATLAB_class", NULL};

static void say(walk *w, uint32_t kind, const void *content, size_t size)
{
    const imki_message message = {.kind = kind, .size = (uint32_t)size};
    w->gone = w->gone || !imki_socket_send(w->list->socket, &message, sizeof message) ||
              !imki_socket_send(w->list->socket, content, size);
}

static void note(walk *w, const char *path, const char *kind)
{
    imki_array_other other;
    memset(&other, 0, sizeof other);
    imki_copy_text(other.name, sizeof other.name, path);
    imki_copy_text(other.kind, sizeof other.kind, kind);
    say(w, IMKI_MESSAGE_OTHER, &other, sizeof other);
}

bool imki_hdf5_type(hid_t type, imki_value_type *found)
{
    const H5T_class_t class = H5Tget_class(type);
    if (class != H5T_FLOAT && class != H5T_INTEGER)
        return false;
    *found = class == H5T_FLOAT                  ? IMKI_FLOAT64
             : H5Tget_sign(type) == H5T_SGN_NONE ? IMKI_UINT64
                                                 : IMKI_INT64;
    return true;
}

static void send_array(walk *w, const imki_hdf5_array *array, imki_array_message *message)
{
    if (w->list->count == IMKI_ARRAYS_MAX) {
        imki_hdf5_fail(w->list->socket, "the file holds more than 1024 arrays",
                       "a file of one log: an array for each sensor or axis");
        w->gone = true;
        return;
    }
    w->list->array[w->list->count++] = *array;
    message->type = (uint32_t)array->type;
    message->extent[0] = array->extent[0];
    message->extent[1] = array->extent[1];
    say(w, IMKI_MESSAGE_ARRAY, message, sizeof *message);
}

/* @return false: how its values are coded cannot be read, which is noted */
static bool find_coding(walk *w, hid_t dataset, const imki_hdf5_array *array, bool *coded,
                        imki_coding *coding)
{
    char obstacle[64];
    *coded = imki_hdf5_coding(dataset, array, coding, sizeof obstacle, obstacle);
    if (obstacle[0])
        note(w, array->path, obstacle);
    return obstacle[0] == '\0';
}

/* Line `index` of texts. */
static void take_line(const char *texts, size_t index, size_t size, char *line)
{
    for (size_t i = 0; i < index && texts; i++) {
        texts = strchr(texts, '\n');
        texts = texts ? texts + 1 : NULL;
    }
    const size_t length = texts ? strcspn(texts, "\n") : 0;
    snprintf(line, size, "%.*s", (int)length, texts ? texts : "");
}

/* A unit of line `index`. netCDF counts times from a date, "seconds since 2024-05-01" [CF, 4.4]. */
static void take_unit(const char *texts, size_t index, size_t size, char *unit)
{
    take_line(texts, index, size, unit);
    char *since = strstr(unit, " since ");
    if (since)
        *since = '\0';
}

/* Numbers of a dataset: its unit, or names and units of its columns. */
static void send_numbers(walk *w, hid_t dataset, const imki_hdf5_array *array,
                         imki_array_message *message)
{
    char units[IMKI_ARRAY_LABELS], names[IMKI_ARRAY_LABELS], name[64], unit[40];
    imki_coding coding;
    bool coded;
    if (!find_coding(w, dataset, array, &coded, &coding))
        return;
    const size_t count = imki_hdf5_texts(dataset, unit_names, sizeof units, units);
    const size_t named = imki_hdf5_texts(dataset, label_names, sizeof names, names);
    if (count == 1)
        take_unit(units, 0, sizeof message->unit, message->unit);
    for (size_t i = 0; i < named && named > 1; i++) {
        take_line(names, i, sizeof name, name);
        take_unit(units, count == named ? i : 0, sizeof unit, unit);
        imki_append_text(message->labels, sizeof message->labels, name);
        if ((count == named || count == 1) && unit[0] && !strpbrk(name, "[(")) {
            imki_append_text(message->labels, sizeof message->labels, " [");
            imki_append_text(message->labels, sizeof message->labels, unit);
            imki_append_text(message->labels, sizeof message->labels, "]");
        }
        imki_append_text(message->labels, sizeof message->labels, "\n");
    }
    send_array(w, array, message);
    if (coded)
        say(w, IMKI_MESSAGE_CODING, &coding, sizeof coding);
}

/* The members of records. */
static void send_members(walk *w, hid_t dataset, hid_t type, imki_hdf5_array *array,
                         const char *path)
{
    char units[IMKI_ARRAY_LABELS];
    imki_coding coding;
    bool coded;
    const int members = H5Tget_nmembers(type);
    const size_t count = imki_hdf5_texts(dataset, unit_names, sizeof units, units);
    array->member = 0;
    if (!find_coding(w, dataset, array, &coded, &coding))
        return;
    for (int i = 0; i < members && !w->gone; i++) {
        imki_array_message message;
        memset(&message, 0, sizeof message);
        const hid_t member = H5Tget_member_type(type, (unsigned)i);
        const bool list = H5Tget_class(member) == H5T_ARRAY;
        const hid_t value = list ? H5Tget_super(member) : H5Tcopy(member);
        hsize_t parts = 1;
        const bool simple =
            !list || (H5Tget_array_ndims(member) == 1 && H5Tget_array_dims2(member, &parts) >= 0);
        char *name = H5Tget_member_name(type, (unsigned)i);
        if (simple && name && imki_hdf5_type(value, &array->type)) {
            imki_copy_text(message.group, sizeof message.group, path);
            imki_copy_text(message.name, sizeof message.name, name);
            if (count == (size_t)members)
                take_unit(units, (size_t)i, sizeof message.unit, message.unit);
            array->member = i;
            array->extent[1] = parts;
            send_array(w, array, &message);
        }
        H5free_memory(name);
        H5Tclose(value);
        H5Tclose(member);
    }
}

/* A text in a structure `units` of MATLAB: characters as numbers. */
static void keep_unit(walk *w, hid_t dataset, const imki_array_message *at, uint64_t length)
{
    static const char units[] = "/units";
    const size_t group = strlen(at->group), own = sizeof units - 1;
    unsigned short characters[sizeof at->unit] = {0};
    if (w->unit_count == UNITS_MAX || length >= sizeof at->unit || group < own ||
        strcmp(at->group + group - own, units) != 0 ||
        H5Dread(dataset, H5T_NATIVE_USHORT, H5S_ALL, H5S_ALL, H5P_DEFAULT, characters) < 0)
        return;
    imki_array_message *unit = &w->unit[w->unit_count++];
    *unit = *at;
    unit->group[group - own] = '\0';
    for (size_t i = 0; i < length; i++)
        unit->unit[i] = (char)(characters[i] < 128 ? characters[i] : '?');
}

/* @return false: it is none of numbers, by what MATLAB says */
static bool is_numbers_of_matlab(walk *w, hid_t dataset, const char *path, const char *class,
                                 const imki_array_message *at, uint64_t values)
{
    static const char *const numbers[] = {"double", "single", "int8",  "uint8",  "int16",  "uint16",
                                          "int32",  "uint32", "int64", "uint64", "logical"};
    static const char *const silent[] = {"cell", "struct", "function_handle"};
    char kind[64];
    if (H5Aexists(dataset, "MATLAB_empty") > 0)
        return false;
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++)
        if (strcmp(class, numbers[i]) == 0)
            return true;
    if (strcmp(class, "char") == 0) {
        keep_unit(w, dataset, at, values);
        return false;
    }
    for (size_t i = 0; i < sizeof silent / sizeof silent[0]; i++)
        if (strcmp(class, silent[i]) == 0)
            return false;
    snprintf(kind, sizeof kind, "MATLAB %.40s", class);
    note(w, path, kind);
    return false;
}

/* Records of a real and an imaginary part, as h5py writes complex numbers. */
static bool is_complex(hid_t type)
{
    bool parts = H5Tget_class(type) == H5T_COMPOUND && H5Tget_nmembers(type) == 2;
    for (unsigned i = 0; i < 2 && parts; i++) {
        char *name = H5Tget_member_name(type, i);
        parts = name && (strcmp(name, i == 0 ? "r" : "i") == 0 ||
                         strcmp(name, i == 0 ? "real" : "imag") == 0);
        H5free_memory(name);
    }
    return parts;
}

/* What a dataset is whose values are none that are read; texts are none that a log would lack.
 * @return false: there is nothing to say */
static bool find_kind(hid_t type, int rank, size_t size, char *kind)
{
    const H5T_class_t class = H5Tget_class(type);
    if (is_complex(type))
        snprintf(kind, size, "dataset of complex numbers");
    else if (class == H5T_COMPOUND)
        snprintf(kind, size, "dataset of records, %d dimensions", rank);
    else if (class == H5T_FLOAT || class == H5T_INTEGER)
        snprintf(kind, size, "dataset of %d dimensions", rank);
    else if (class == H5T_ENUM || class == H5T_ARRAY || class == H5T_BITFIELD)
        snprintf(kind, size, "dataset of lists, words or bits");
    else if (class == H5T_VLEN)
        snprintf(kind, size, "dataset of lists of any length");
    else
        return false;
    return true;
}

static void visit_dataset(walk *w, hid_t dataset, const char *path)
{
    char class[IMKI_ARRAY_LABELS];
    imki_array_message message;
    hsize_t extent[2] = {1, 1};
    imki_hdf5_array array = {.member = -1};
    const hid_t space = H5Dget_space(dataset), type = H5Dget_type(dataset);
    array.rank = H5Sget_simple_extent_ndims(space);
    const bool fits = array.rank >= 0 && array.rank <= 2 && strlen(path) < sizeof array.path &&
                      H5Sget_simple_extent_dims(space, extent, NULL) >= 0;
    memset(&message, 0, sizeof message);
    const char *slash = strrchr(path, '/');
    snprintf(message.group, sizeof message.group, "%.*s", (int)(slash - path), path);
    imki_copy_text(message.name, sizeof message.name, slash + 1);
    imki_copy_text(array.path, sizeof array.path, path);
    const uint64_t values = fits && extent[1] > 0 && extent[0] <= UINT64_MAX / extent[1]
                                ? extent[0] * extent[1]
                                : UINT64_MAX;
    bool numbers = fits && H5Sget_simple_extent_type(space) != H5S_NULL;
    if (numbers && imki_hdf5_texts(dataset, class_names, sizeof class, class) > 0) {
        class[strcspn(class, "\n")] = '\0';
        numbers = is_numbers_of_matlab(w, dataset, path, class, &message, values);
        array.flipped = array.rank == 2;
    }
    array.extent[0] = extent[array.flipped];
    array.extent[1] = extent[!array.flipped];
    const bool records = H5Tget_class(type) == H5T_COMPOUND && array.rank == 1 && !is_complex(type);
    const bool unread = !fits || (numbers && !records && !imki_hdf5_type(type, &array.type));
    char kind[64];
    const char *obstacle = numbers && (records || imki_hdf5_type(type, &array.type))
                               ? imki_hdf5_obstacle(dataset, values, w->file_size)
                               : NULL;
    if (obstacle)
        note(w, path, obstacle);
    else if (unread && array.rank >= 0 && find_kind(type, array.rank, sizeof kind, kind))
        note(w, path, kind);
    else if (numbers && records)
        send_members(w, dataset, type, &array, path);
    else if (numbers && imki_hdf5_type(type, &array.type))
        send_numbers(w, dataset, &array, &message);
    H5Tclose(type);
    H5Sclose(space);
}

/* What an object is known by. */
#if H5_VERSION_GE(1, 12, 0)
static bool find_key(hid_t object, object_key *key)
{
    H5O_info2_t about;
    const bool found = H5Oget_info3(object, &about, H5O_INFO_BASIC) >= 0;
    memset(key, 0, sizeof *key);
    memcpy(key, &about.token, found ? sizeof about.token : 0);
    return found;
}
#else
static bool find_key(hid_t object, object_key *key)
{
    H5O_info_t about;
    const bool found = H5Oget_info(object, &about) >= 0;
    memset(key, 0, sizeof *key);
    memcpy(key, &about.addr, found ? sizeof about.addr : 0);
    return found;
}
#endif

static bool is_new(walk *w, hid_t group)
{
    object_key key;
    if (!find_key(group, &key) || w->seen_count == OBJECTS_MAX)
        return false;
    for (size_t i = 0; i < w->seen_count; i++)
        if (memcmp(&w->seen[i], &key, sizeof key) == 0)
            return false;
    w->seen[w->seen_count++] = key;
    return true;
}

static void visit_group(walk *w, hid_t group, const char *path, int depth);

/* What a link leads to. */
static void visit_link(walk *w, hid_t group, const char *path, const char *name, int depth)
{
    char whole[IMKI_HDF5_PATH];
    H5L_info_t link;
    if (H5Lget_info(group, name, &link, H5P_DEFAULT) < 0 || name[0] == '#' ||
        snprintf(whole, sizeof whole, "%s/%s", path, name) >= (int)sizeof whole)
        return; /* names with # are MATLAB's own */
    if (link.type == H5L_TYPE_EXTERNAL)
        note(w, whole, "link to another file");
    if (link.type == H5L_TYPE_SOFT && imki_array_is_sensor(name)) /* others are shortcuts */
        note(w, whole, "soft link");
    const hid_t object =
        link.type == H5L_TYPE_HARD ? H5Oopen(group, name, H5P_DEFAULT) : H5I_INVALID_HID;
    if (object < 0)
        return;
    const H5I_type_t type = H5Iget_type(object);
    if (type == H5I_GROUP && depth < IMKI_ARRAY_DEPTH && is_new(w, object))
        visit_group(w, object, whole, depth + 1);
    else if (type == H5I_DATASET)
        visit_dataset(w, object, whole);
    H5Oclose(object);
}

/* In the order in which the links were made, where the group knows it. */
static void visit_group(walk *w, hid_t group, const char *path, int depth)
{
    H5G_info_t about;
    unsigned order = 0;
    const hid_t how = H5Gget_create_plist(group);
    if (H5Pget_link_creation_order(how, &order) < 0)
        order = 0;
    H5Pclose(how);
    if (H5Gget_info(group, &about) < 0)
        return;
    const H5_index_t index = order & H5P_CRT_ORDER_INDEXED ? H5_INDEX_CRT_ORDER : H5_INDEX_NAME;
    for (hsize_t i = 0; i < about.nlinks && !w->gone && w->objects < OBJECTS_MAX; i++) {
        char name[256];
        const ssize_t length =
            H5Lget_name_by_idx(group, ".", index, H5_ITER_INC, i, name, sizeof name, H5P_DEFAULT);
        w->objects++;
        if (length > 0 && (size_t)length < sizeof name)
            visit_link(w, group, path, name, depth);
    }
}

bool imki_hdf5_list_all(imki_hdf5_list *list)
{
    walk *w = calloc(1, sizeof *w);
    const hid_t top = w ? H5Gopen2(list->file, "/", H5P_DEFAULT) : H5I_INVALID_HID;
    if (!w) {
        imki_hdf5_fail(list->socket, "", "");
        return false;
    }
    w->list = list;
    if (H5Fget_filesize(list->file, &w->file_size) < 0 || top < 0) {
        imki_hdf5_fail(list->socket, "the HDF5 file is damaged", "copy the file again");
        free(w);
        return false;
    }
    if (is_new(w, top))
        visit_group(w, top, "", 0);
    for (size_t i = 0; i < w->unit_count; i++)
        say(w, IMKI_MESSAGE_UNIT, &w->unit[i], sizeof w->unit[i]);
    say(w, IMKI_MESSAGE_LISTED, NULL, 0);
    const bool gone = w->gone;
    free(w);
    H5Gclose(top);
    return !gone;
}
