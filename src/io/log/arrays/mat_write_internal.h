/* SPDX-License-Identifier: Apache-2.0 */
/* Logs written as MAT-files of version 5. */
#ifndef IMUKIT_MAT_WRITE_INTERNAL_H
#define IMUKIT_MAT_WRITE_INTERNAL_H

#include "io/log/log_formats_internal.h"

/* As imki_log_codec.create and .end. The rest is that of column_store_internal.h. */
imk_status imki_mat_create(imki_log_output *log, const char *path, imk_error *error);
imk_status imki_mat_end(imki_log_output *log, imk_error *error);

#endif
