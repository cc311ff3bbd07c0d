/* SPDX-License-Identifier: Apache-2.0 */
/* What a results file has in front of its values, made by libhdf5 in memory.
 *
 * libhdf5 keeps the file in memory (its core driver) and extends that through our callbacks, by
 * which the bytes are had after it has closed the file. The dataset `error` is made last, and one
 * number of it is written, so that it gets its place: behind everything else. The memory ends
 * there, however large the dataset; the values are written to the file on disk by ourselves. So a
 * full disk is never met within libhdf5, which could not let go of a file that it cannot complete.
 */
#include "campaign_internal.h"
#include "io/file/hdf5_image_internal.h"

#include <hdf5.h>
#include <stdlib.h>
#include <string.h>

enum { FORMAT_VERSION = 1 };

typedef struct writing {
    const imki_record *record;
    imki_hdf5_image image;
    hid_t file, scalar, contiguous; /* the file, and how everything in it is */
    uint64_t values;                /* where they begin */
    bool done;
} writing;

/* ---- parts ---- */

static bool put_integer(const writing *w, const char *name, uint64_t number)
{
    return imki_hdf5_put_attribute(w->file, name, H5T_STD_U64LE, w->scalar, &number);
}

/* Texts of equal size, in one attribute. */
static bool put_texts(hid_t object, const char *name, size_t count, const char *const *texts)
{
    const hsize_t extent = count;
    size_t size = 1;
    for (size_t i = 0; i < count; i++)
        if (strlen(texts[i]) + 1 > size)
            size = strlen(texts[i]) + 1;
    char *values = count > 0 ? calloc(count, size) : NULL;
    if (!values)
        return false;
    for (size_t i = 0; i < count; i++)
        memcpy(values + i * size, texts[i], strlen(texts[i]));
    const hid_t type = imki_hdf5_text_type(size), space = H5Screate_simple(1, &extent, NULL);
    const bool put = imki_hdf5_put_attribute(object, name, type, space, values);
    free(values);
    return H5Sclose(space) >= 0 && H5Tclose(type) >= 0 && put;
}

static hid_t make_dataset(const writing *w, const char *name, hid_t type, hid_t space)
{
    return H5Dcreate2(w->file, name, type, space, H5P_DEFAULT, w->contiguous, H5P_DEFAULT);
}

static bool put_dataset(const writing *w, const char *name, hid_t type, hid_t space,
                        const char *unit, const void *values)
{
    const hid_t set = make_dataset(w, name, type, space);
    const bool put = (!unit || imki_hdf5_put_text(set, "unit", unit)) &&
                     H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0;
    return H5Dclose(set) >= 0 && put;
}

static bool put_list(const writing *w, const char *name, hid_t type, size_t count, const char *unit,
                     const void *values)
{
    const hsize_t extent = count;
    const hid_t space = H5Screate_simple(1, &extent, NULL);
    const bool put = put_dataset(w, name, type, space, unit, values);
    return H5Sclose(space) >= 0 && put;
}

static bool put_small_parts(const writing *w)
{
    const imk_campaign *c = &w->record->campaign;
    const hid_t type = imki_hdf5_text_type(strlen(c->parameters) + 1);
    const bool put = put_integer(w, "imukit_format", FORMAT_VERSION) &&
                     imki_hdf5_put_text(w->file, "imukit", c->version) &&
                     put_integer(w, "seed", c->seed) && put_integer(w, "run_count", c->run_count) &&
                     put_dataset(w, "parameters", type, w->scalar, NULL, c->parameters) &&
                     put_list(w, "time", H5T_IEEE_F64LE, c->time_count, "s", c->time) &&
                     put_list(w, "run", H5T_STD_U64LE, w->record->runs, NULL, w->record->run);
    return H5Tclose(type) >= 0 && put;
}

/* The dataset of the values, with the first of them only. */
static bool put_error(writing *w)
{
    const imk_campaign *c = &w->record->campaign;
    const hsize_t extent[3] = {w->record->runs, c->time_count, c->state_count}, first[3] = {0};
    const double value = 0.0;
    const hid_t space = H5Screate_simple(3, extent, NULL),
                set = make_dataset(w, "error", H5T_IEEE_F64LE, space);
    const bool put = put_texts(set, "state", c->state_count, c->state) &&
                     put_texts(set, "unit", c->state_count, c->unit) &&
                     H5Sselect_elements(space, H5S_SELECT_SET, 1, first) >= 0 &&
                     H5Dwrite(set, H5T_IEEE_F64LE, w->scalar, space, H5P_DEFAULT, &value) >= 0;
    w->values = H5Dget_offset(set);
    return H5Dclose(set) >= 0 && H5Sclose(space) >= 0 && put;
}

/* ---- the file ---- */

/* Nothing that depends on when the file is made. */
static hid_t creation_properties(void)
{
    const hid_t list = H5Pcreate(H5P_FILE_CREATE);
    if (H5Pset_userblock(list, IMKI_SEAL_SIZE) >= 0 && H5Pset_obj_track_times(list, false) >= 0)
        return list;
    H5Pclose(list);
    return H5I_INVALID_HID;
}

/* In one piece, which gets its place when something is first written to it. */
static hid_t dataset_properties(void)
{
    const hid_t list = H5Pcreate(H5P_DATASET_CREATE);
    if (H5Pset_obj_track_times(list, false) >= 0 && H5Pset_layout(list, H5D_CONTIGUOUS) >= 0 &&
        H5Pset_alloc_time(list, H5D_ALLOC_TIME_LATE) >= 0 &&
        H5Pset_fill_time(list, H5D_FILL_TIME_NEVER) >= 0)
        return list;
    H5Pclose(list);
    return H5I_INVALID_HID;
}

static void make(void *context)
{
    writing *w = context;
    const uint64_t size = w->record->runs * imki_run_size(&w->record->campaign);
    const hid_t access = imki_hdf5_image_access(&w->image), creation = creation_properties();
    hsize_t end = 0;
    w->scalar = H5Screate(H5S_SCALAR);
    w->contiguous = dataset_properties();
    w->file = access < 0 || creation < 0
                  ? H5I_INVALID_HID
                  : H5Fcreate(imki_hdf5_nowhere, H5F_ACC_TRUNC, creation, access);
    if (w->file >= 0 && w->scalar >= 0 && w->contiguous >= 0) {
        const bool put = put_small_parts(w) && put_error(w) && H5Fget_filesize(w->file, &end) >= 0;
        w->done = H5Fclose(w->file) >= 0 && put;
    }
    H5Pclose(w->contiguous);
    H5Sclose(w->scalar);
    H5Pclose(creation);
    H5Pclose(access);
    /* The values come last. */
    w->done = w->done && end == w->values + size && w->image.size >= w->values;
}

imk_status imki_hdf5_write(const imki_record *record, const char *path, unsigned char **bytes,
                           size_t *size, imk_error *error)
{
    writing w = {.record = record};
    if (!imki_hdf5_use(make, &w))
        return imk_error_set(error, IMK_ERROR_MEMORY, path, "", "");
    if (!w.done) {
        free(w.image.at);
        return imk_error_set(error, IMK_ERROR_WRITE, path, "libhdf5 does not make such a file",
                             "make room in memory");
    }
    memset(w.image.at, 0, IMKI_SEAL_SIZE);
    *bytes = w.image.at;
    *size = (size_t)w.values;
    return IMK_OK;
}
