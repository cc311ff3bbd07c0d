/* SPDX-License-Identifier: Apache-2.0 */
/* Compressing what is written to a file whose name ends in .gz or .zst. */
#ifndef IMUKIT_OUTPUT_PACKING_INTERNAL_H
#define IMUKIT_OUTPUT_PACKING_INTERNAL_H

#include "imukit/status.h"

#include <stdbool.h>
#include <stddef.h>

typedef struct imki_packing imki_packing;

/* Begin for a name; *packing is NULL for all other endings. */
imk_status imki_packing_start(const char *path, imki_packing **packing, imk_error *error);

/* Pack bytes into `room`, of `room_size` bytes of which *used are taken, as far as they fit.
 * Advances *bytes, *size and *used. last: nothing follows. Call again, with more room, while *more.
 * @return 0, or errno */
int imki_packing_step(imki_packing *packing, const unsigned char **bytes, size_t *size, bool last,
                      unsigned char *room, size_t room_size, size_t *used, bool *more);

void imki_packing_free(imki_packing *packing);

#endif
