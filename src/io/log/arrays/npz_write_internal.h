/* SPDX-License-Identifier: Apache-2.0 */
/* Logs written as .npz files. */
#ifndef IMUKIT_NPZ_WRITE_INTERNAL_H
#define IMUKIT_NPZ_WRITE_INTERNAL_H

#include "io/log/log_formats_internal.h"

/* As imki_log_codec.end. The rest is that of column_store_internal.h. */
imk_status imki_npz_end(imki_log_output *log, imk_error *error);

#endif
