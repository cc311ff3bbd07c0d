/* SPDX-License-Identifier: Apache-2.0 */
/* Refusals of the operating system as imk_error. */
#ifndef IMUKIT_SYSTEM_ERROR_INTERNAL_H
#define IMUKIT_SYSTEM_ERROR_INTERNAL_H

#include "imukit/status.h"

/* Fill an error about a file: field is `path` ("standard input" and the like for a stream), found
 * the system's text for the errno value `number`, expected what to do, or "". @return status */
imk_status imki_system_error(imk_error *error, imk_status status, const char *path, int number);

#endif
