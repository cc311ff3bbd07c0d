/* SPDX-License-Identifier: Apache-2.0 */
/* What an HDF5 file has beside its values, made by libhdf5 in memory, so that a full disk is never
 * met within it. All of this is called within imki_hdf5_use(). */
#ifndef IMUKIT_HDF5_IMAGE_INTERNAL_H
#define IMUKIT_HDF5_IMAGE_INTERNAL_H

#include <hdf5.h>
#include <stdbool.h>

/* From malloc(); to be freed. */
typedef struct imki_hdf5_image {
    unsigned char *at;
    size_t size;
} imki_hdf5_image;

/* A path at which no file can be, for libhdf5 looks first: nothing is in /dev/null. */
#define imki_hdf5_nowhere "/dev/null/imukit"

/* Properties of a file that lies in memory. @return H5I_INVALID_HID: not possible */
hid_t imki_hdf5_image_access(imki_hdf5_image *image);
/* @return H5I_INVALID_HID, which all that takes it refuses */
hid_t imki_hdf5_text_type(size_t size);
bool imki_hdf5_put_attribute(hid_t object, const char *name, hid_t type, hid_t space,
                             const void *values);
bool imki_hdf5_put_text(hid_t object, const char *name, const char *text);

#endif
