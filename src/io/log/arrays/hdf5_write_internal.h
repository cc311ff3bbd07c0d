/* SPDX-License-Identifier: Apache-2.0 */
/* Logs written as HDF5 files. */
#ifndef IMUKIT_HDF5_WRITE_INTERNAL_H
#define IMUKIT_HDF5_WRITE_INTERNAL_H

#include "io/log/log_formats_internal.h"

/* As imki_log_codec.end. The rest is that of column_store_internal.h. */
imk_status imki_hdf5_end(imki_log_output *log, imk_error *error);

#endif
