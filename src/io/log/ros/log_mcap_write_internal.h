/* SPDX-License-Identifier: Apache-2.0 */
/* The writer of MCAP files, as in imki_log_codec. */
#ifndef IMUKIT_LOG_MCAP_WRITE_INTERNAL_H
#define IMUKIT_LOG_MCAP_WRITE_INTERNAL_H

#include "log_ros_write_internal.h"

imk_status imki_mcap_create(imki_log_output *log, const char *path, imk_error *error);
void imki_mcap_begin(imki_log_output *log);
imk_status imki_mcap_write(imki_log_output *log, const char *bytes, size_t size, size_t rows);
imk_status imki_mcap_end(imki_log_output *log, imk_error *error);
void imki_mcap_discard(imki_log_output *log);

#endif
