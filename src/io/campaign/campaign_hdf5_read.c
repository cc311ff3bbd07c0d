/* SPDX-License-Identifier: Apache-2.0 */
/* What a results file is about, read by libhdf5. Shapes and types must be those that are written,
 * and sizes are compared with that of the file before memory is asked for. */
#include "campaign_internal.h"

#include <hdf5.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { FORMAT_VERSION = 1 };

/* What is read, but for the values. */
enum { FORMAT, VERSION, SEED, RUN_COUNT, PARAMETERS, TIME, RUN, STATE, UNIT, PARTS };
typedef enum kind { REAL, INTEGER, TEXT } kind;
static const struct {
    const char *object, *attribute; /* NULL: the dataset itself */
    kind kind;
    int rank; /* 0: one; 1: a list */
} parts[PARTS] = {[FORMAT] = {"/", "imukit_format", INTEGER, 0},
                  [VERSION] = {"/", "imukit", TEXT, 0},
                  [SEED] = {"/", "seed", INTEGER, 0},
                  [RUN_COUNT] = {"/", "run_count", INTEGER, 0},
                  [PARAMETERS] = {"parameters", NULL, TEXT, 0},
                  [TIME] = {"time", NULL, REAL, 1},
                  [RUN] = {"run", NULL, INTEGER, 1},
                  [STATE] = {"error", "state", TEXT, 1},
                  [UNIT] = {"error", "unit", TEXT, 1}};

typedef struct part {
    void *at;    /* from malloc(); NULL: not as it must be */
    size_t size; /* bytes of one */
    uint64_t count;
} part;

typedef struct reading {
    const char *path;
    int number; /* of the open file that was verified */
    uint64_t size;
    part part[PARTS];
    uint64_t extent[3]; /* of the values */
    uint64_t values;    /* where they begin; 0: they are not as they must be */
    bool no_memory;
} reading;

/* @return false when there are not so many dimensions, or nothing in them */
static bool read_extent(hid_t space, int rank, uint64_t *extent)
{
    hsize_t found[3] = {0};
    if (H5Sget_simple_extent_type(space) != (rank > 0 ? H5S_SIMPLE : H5S_SCALAR) ||
        H5Sget_simple_extent_ndims(space) != rank ||
        H5Sget_simple_extent_dims(space, found, NULL) != rank)
        return false;
    for (int k = 0; k < rank; k++) {
        extent[k] = found[k];
        if (extent[k] == 0)
            return false;
    }
    return true;
}

static bool is_of_kind(hid_t type, kind wanted)
{
    switch (wanted) {
    case REAL:
        return H5Tequal(type, H5T_IEEE_F64LE) > 0;
    case INTEGER:
        return H5Tequal(type, H5T_STD_U64LE) > 0;
    case TEXT:
        break;
    }
    return H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) == 0;
}

/* Does the dataset lie in one piece within the file? */
static bool lies_within(const reading *r, hid_t set, uint64_t *place)
{
    const hid_t properties = H5Dget_create_plist(set);
    const bool in_one_piece = H5Pget_layout(properties) == H5D_CONTIGUOUS;
    H5Pclose(properties);
    *place = H5Dget_offset(set);
    return in_one_piece && *place <= r->size && H5Dget_storage_size(set) <= r->size - *place;
}

/* ---- parts ---- */

/* Texts end with a zero. */
static bool are_texts(const part *p)
{
    const char *text = p->at;
    for (uint64_t i = 1; i <= p->count; i++)
        if (text[i * p->size - 1] != '\0')
            return false;
    return true;
}

/* @param id  dataset or attribute */
static void read_values(reading *r, int index, hid_t id, hid_t type, hid_t space)
{
    const bool is_dataset = !parts[index].attribute;
    part *p = &r->part[index];
    uint64_t place;
    p->count = 1;
    p->size = H5Tget_size(type);
    if ((is_dataset && !lies_within(r, id, &place)) || !is_of_kind(type, parts[index].kind) ||
        !read_extent(space, parts[index].rank, &p->count) || p->size == 0 ||
        p->size > r->size / p->count)
        return;
    p->at = malloc(p->size * p->count);
    r->no_memory = r->no_memory || !p->at;
    if (!p->at)
        return;
    const herr_t status = is_dataset ? H5Dread(id, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, p->at)
                                     : H5Aread(id, type, p->at);
    if (status < 0 || (parts[index].kind == TEXT && !are_texts(p))) {
        free(p->at);
        p->at = NULL;
    }
}

static void read_part(reading *r, hid_t file, int index)
{
    const char *object = parts[index].object, *attribute = parts[index].attribute;
    const hid_t id = attribute ? H5Aopen_by_name(file, object, attribute, H5P_DEFAULT, H5P_DEFAULT)
                               : H5Dopen2(file, object, H5P_DEFAULT);
    if (id < 0)
        return;
    const hid_t type = attribute ? H5Aget_type(id) : H5Dget_type(id),
                space = attribute ? H5Aget_space(id) : H5Dget_space(id);
    read_values(r, index, id, type, space);
    H5Sclose(space);
    H5Tclose(type);
    if (attribute)
        H5Aclose(id);
    else
        H5Dclose(id);
}

/* Where the values are, which end the file. */
static void find_values(reading *r, hid_t file)
{
    const hid_t set = H5Dopen2(file, "error", H5P_DEFAULT);
    if (set < 0)
        return;
    const hid_t type = H5Dget_type(set), space = H5Dget_space(set);
    uint64_t place, size = sizeof(double);
    bool found =
        is_of_kind(type, REAL) && lies_within(r, set, &place) && read_extent(space, 3, r->extent);
    for (int k = 0; k < 3 && found; k++) {
        found = size <= r->size / r->extent[k];
        size *= r->extent[k];
    }
    if (found && place + size == r->size)
        r->values = place;
    H5Sclose(space);
    H5Tclose(type);
    H5Dclose(set);
}

/* ---- the file ---- */

/* Is the file that has been opened by its name the one that was verified? */
static bool is_verified(hid_t file, hid_t access, int number)
{
    void *handle = NULL;
    struct stat opened, verified;
    return H5Fget_vfd_handle(file, access, &handle) >= 0 && handle &&
           fstat(*(const int *)handle, &opened) == 0 && fstat(number, &verified) == 0 &&
           opened.st_dev == verified.st_dev && opened.st_ino == verified.st_ino;
}

static hid_t open_file(const reading *r, bool locked)
{
    const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    H5Pset_fapl_sec2(access); /* whatever the environment says: is_verified() knows this one */
#if H5_VERSION_GE(1, 12, 1) || (H5_VERSION_GE(1, 10, 7) && !H5_VERSION_GE(1, 12, 0))
    H5Pset_file_locking(access, locked, true);
#else
    (void)locked;
#endif
    hid_t file = H5Fopen(r->path, H5F_ACC_RDONLY, access);
    if (file >= 0 && !is_verified(file, access, r->number)) {
        H5Fclose(file);
        file = H5I_INVALID_HID;
    }
    H5Pclose(access);
    return file;
}

static void read_all(void *context)
{
    reading *r = context;
    /* Without locks, which not every file system has; unless the caller has it open with them. */
    hid_t file = open_file(r, false);
    if (file < 0)
        file = open_file(r, true);
    if (file < 0)
        return;
    for (int index = 0; index < PARTS; index++)
        read_part(r, file, index);
    find_values(r, file);
    H5Fclose(file);
}

static imk_status check_version(const reading *r, imk_error *error)
{
    char found[24];
    if (!r->part[FORMAT].at)
        return imki_record_refuse(error);
    const uint64_t version = *(const uint64_t *)r->part[FORMAT].at;
    if (version == FORMAT_VERSION)
        return IMK_OK;
    snprintf(found, sizeof found, "%llu", (unsigned long long)version);
    return imk_error_set(error, IMK_ERROR_VERSION, "format", found, "1; use a newer imukit");
}

/* The parts as a campaign and its runs. */
static imk_status make_record(const reading *r, imki_record *record, imk_error *error)
{
    for (int index = 0; index < PARTS; index++)
        if (!r->part[index].at)
            return imki_record_refuse(error);
    const uint64_t states = r->extent[2];
    if (r->values == 0 || r->part[RUN].count != r->extent[0] ||
        r->part[TIME].count != r->extent[1] || r->part[STATE].count != states ||
        r->part[UNIT].count != states)
        return imki_record_refuse(error);
    const char **texts = calloc(2 * states, sizeof *texts);
    if (!texts)
        return imk_error_set(error, IMK_ERROR_MEMORY, "", "", "");
    for (uint64_t i = 0; i < states; i++) {
        texts[i] = (const char *)r->part[STATE].at + i * r->part[STATE].size;
        texts[states + i] = (const char *)r->part[UNIT].at + i * r->part[UNIT].size;
    }
    const imk_campaign campaign = {.version = r->part[VERSION].at,
                                   .parameters = r->part[PARAMETERS].at,
                                   .seed = *(const uint64_t *)r->part[SEED].at,
                                   .run_count = *(const uint64_t *)r->part[RUN_COUNT].at,
                                   .time_count = (size_t)r->extent[1],
                                   .time = r->part[TIME].at,
                                   .state_count = (size_t)states,
                                   .state = texts,
                                   .unit = texts + states};
    imk_status status = imki_record_make(&campaign, r->extent[0], r->part[RUN].at, record, error);
    if (status == IMK_ERROR_RANGE)
        status = imki_record_refuse(error);
    free(texts);
    return status;
}

imk_status imki_hdf5_read(const char *path, int file, uint64_t file_size, imki_record *record,
                          uint64_t *values, imk_error *error)
{
    reading r = {.path = path, .number = file, .size = file_size};
    r.no_memory = !imki_hdf5_use(read_all, &r) || r.no_memory;
    imk_status status = r.no_memory ? imk_error_set(error, IMK_ERROR_MEMORY, path, "", "")
                                    : check_version(&r, error);
    if (status == IMK_OK)
        status = make_record(&r, record, error);
    for (int index = 0; index < PARTS; index++)
        free(r.part[index].at);
    *values = r.values;
    return status;
}
