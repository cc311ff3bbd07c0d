/* SPDX-License-Identifier: Apache-2.0 */
/* A log as an HDF5 file [HDF5]: a dataset of float64 in one piece for each column, with its unit in
 * the attribute `units`. libhdf5 makes all but the values in memory, where what belongs to datasets
 * and links stands in one block in front; so the values follow it, column after column, and are
 * written by ourselves. */
#include "hdf5_write_internal.h"

#include "column_store_internal.h"
#include "io/file/hdf5_image_internal.h"
#include "io/file/hdf5_use_internal.h"

#include <stdlib.h>
#include <string.h>

/* Bytes of the block in front: what a dataset with its attribute and link takes, and the rest. */
enum { BLOCK_OF_COLUMN = 1024, BLOCK_OF_FILE = 2048 };

typedef struct writing {
    const imki_log_output *log;
    imki_hdf5_image image;
    uint64_t place[IMK_LOG_COLUMNS_MAX]; /* of the values of each column */
    uint64_t front;                      /* bytes before the values */
    bool done;
} writing;

/* Its place is given at once, and nothing is written there. */
static hid_t dataset_properties(void)
{
    const hid_t list = H5Pcreate(H5P_DATASET_CREATE);
    if (H5Pset_obj_track_times(list, false) >= 0 && H5Pset_layout(list, H5D_CONTIGUOUS) >= 0 &&
        H5Pset_alloc_time(list, H5D_ALLOC_TIME_EARLY) >= 0 &&
        H5Pset_fill_time(list, H5D_FILL_TIME_NEVER) >= 0)
        return list;
    H5Pclose(list);
    return H5I_INVALID_HID;
}

/* Nothing that depends on when the file is made; links in the order of the columns. */
static hid_t file_properties(void)
{
    const hid_t list = H5Pcreate(H5P_FILE_CREATE);
    if (H5Pset_obj_track_times(list, false) >= 0 &&
        H5Pset_link_creation_order(list, H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED) >= 0)
        return list;
    H5Pclose(list);
    return H5I_INVALID_HID;
}

static bool put_columns(writing *w, hid_t file)
{
    const imki_column_store *store = w->log->state;
    const hsize_t rows = store->rows;
    const hid_t space = H5Screate_simple(1, &rows, NULL), how = dataset_properties();
    bool put = space >= 0 && how >= 0;
    for (size_t i = 0; i < store->columns && put; i++) {
        const char *unit = w->log->column[i].unit.text;
        const hid_t set =
            H5Dcreate2(file, store->name[i], H5T_IEEE_F64LE, space, H5P_DEFAULT, how, H5P_DEFAULT);
        put = set >= 0 && (!unit[0] || imki_hdf5_put_text(set, "units", unit));
        w->place[i] = H5Dget_offset(set);
        put = H5Dclose(set) >= 0 && put;
    }
    H5Pclose(how);
    H5Sclose(space);
    return put;
}

static void make(void *context)
{
    writing *w = context;
    const imki_column_store *store = w->log->state;
    const hid_t access = imki_hdf5_image_access(&w->image), creation = file_properties();
    const hsize_t block = BLOCK_OF_FILE + store->columns * BLOCK_OF_COLUMN;
    const bool ready = access >= 0 && creation >= 0 && H5Pset_meta_block_size(access, block) >= 0;
    const hid_t file =
        ready ? H5Fcreate(imki_hdf5_nowhere, H5F_ACC_TRUNC, creation, access) : H5I_INVALID_HID;
    hsize_t end = 0;
    if (file >= 0) {
        const bool put = put_columns(w, file) && H5Fget_filesize(file, &end) >= 0;
        w->done = H5Fclose(file) >= 0 && put;
    }
    H5Pclose(creation);
    H5Pclose(access);
    /* The values follow each other up to the end, behind all else. */
    w->front = store->rows > 0 ? w->place[0] : end;
    uint64_t place = w->front;
    w->done = w->done && w->image.size <= place;
    for (size_t i = 0; i < store->columns && store->rows > 0; i++, place += store->rows * 8)
        w->done = w->done && w->place[i] == place;
    w->done = w->done && end == place;
}

imk_status imki_hdf5_end(imki_log_output *log, imk_error *error)
{
    const imki_column_store *store = log->state;
    writing w = {.log = log};
    imk_status status = imki_column_store_end(log, error);
    if (status != IMK_OK)
        return status;
    imki_column_names(log, "");
    if (!imki_hdf5_use(make, &w))
        status = imk_error_set(error, IMK_ERROR_MEMORY, "", "", "");
    else if (!w.done)
        status = imk_error_set(error, IMK_ERROR_WRITE, "", "libhdf5 does not make such a file",
                               "make room in memory, or write a .npz");
    if (status == IMK_OK)
        status = imk_output_file_write(log->file, w.image.at, w.image.size);
    for (uint64_t i = w.image.size; i < w.front && status == IMK_OK; i++)
        status = imk_output_file_write(log->file, "", 1); /* what is left of the block */
    free(w.image.at);
    for (size_t i = 0; i < store->columns && status == IMK_OK; i++)
        status = imki_column_store_put(log, i, error);
    return status;
}
