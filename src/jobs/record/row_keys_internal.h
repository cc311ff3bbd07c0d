/* SPDX-License-Identifier: Apache-2.0 */
/* One number for the values of a row, to find rows that are alike. */
#ifndef IMUKI_ROW_KEYS_INTERNAL_H
#define IMUKI_ROW_KEYS_INTERNAL_H

#include <stddef.h>
#include <stdint.h>

/* Keys of rows first … first + rows - 1: equal where all channels are; those of other rows are as
 * random. 0: a sample is missing.
 * @param column  the channels, as indices into `columns` */
void imki_row_keys(size_t channels, const int *column, size_t rows, double *const *columns,
                   size_t first, uint64_t *key);

#endif
