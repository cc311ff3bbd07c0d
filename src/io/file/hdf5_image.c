/* SPDX-License-Identifier: Apache-2.0 */
/* libhdf5 keeps the file in memory (its core driver) and extends that through our callbacks, by
 * which the bytes are had after it has closed the file. */
#include "hdf5_image_internal.h"

#include <stdlib.h>
#include <string.h>

static void *extend(void *at, size_t size, H5FD_file_image_op_t operation, void *context)
{
    imki_hdf5_image *i = context;
    unsigned char *more = realloc(at, size);
    (void)operation;
    if (more)
        *i = (imki_hdf5_image){more, size};
    return more;
}

static void *begin(size_t size, H5FD_file_image_op_t operation, void *context)
{
    return extend(NULL, size, operation, context);
}

/* The bytes are ours. */
static herr_t keep(void *at, H5FD_file_image_op_t operation, void *context)
{
    (void)at;
    (void)operation;
    (void)context;
    return 0;
}

static void *share(void *context)
{
    return context;
}

static herr_t unshare(void *context)
{
    (void)context;
    return 0;
}

/* Every piece where the one before ends, from a multiple of 8 bytes on: numbers may be used where
 * they lie, and nothing is left open behind the last. Without a sieve buffer no more of the values
 * is written than those that are given. */
hid_t imki_hdf5_image_access(imki_hdf5_image *image)
{
    H5FD_file_image_callbacks_t callbacks = {begin, NULL, extend, keep, share, unshare, image};
    const hid_t list = H5Pcreate(H5P_FILE_ACCESS);
    if (H5Pset_fapl_core(list, 1, 0) >= 0 && H5Pset_file_image_callbacks(list, &callbacks) >= 0 &&
        H5Pset_libver_bounds(list, H5F_LIBVER_V110, H5F_LIBVER_V110) >= 0 &&
        H5Pset_meta_block_size(list, 0) >= 0 && H5Pset_small_data_block_size(list, 0) >= 0 &&
        H5Pset_sieve_buf_size(list, 1) >= 0 && H5Pset_alignment(list, 1, 8) >= 0)
        return list;
    H5Pclose(list);
    return H5I_INVALID_HID;
}

hid_t imki_hdf5_text_type(size_t size)
{
    const hid_t type = H5Tcopy(H5T_C_S1);
    if (H5Tset_size(type, size) >= 0 && H5Tset_cset(type, H5T_CSET_UTF8) >= 0)
        return type;
    H5Tclose(type);
    return H5I_INVALID_HID;
}

bool imki_hdf5_put_attribute(hid_t object, const char *name, hid_t type, hid_t space,
                             const void *values)
{
    const hid_t attribute = H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
    const bool put = H5Awrite(attribute, type, values) >= 0;
    return H5Aclose(attribute) >= 0 && put;
}

bool imki_hdf5_put_text(hid_t object, const char *name, const char *text)
{
    const hid_t type = imki_hdf5_text_type(strlen(text) + 1), space = H5Screate(H5S_SCALAR);
    const bool put = imki_hdf5_put_attribute(object, name, type, space, text);
    return H5Sclose(space) >= 0 && H5Tclose(type) >= 0 && put;
}
