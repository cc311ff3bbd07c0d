/* SPDX-License-Identifier: Apache-2.0 */
#include "row_keys_internal.h"

#include <stdbool.h>
#include <string.h>

/* Odd, with bits as those of a random number. */
static const uint64_t spread = 0x9e3779b97f4a7c15;

static void add_channel(size_t rows, const double *x, uint64_t *key)
{
    for (size_t i = 0; i < rows; i++) {
        uint64_t bits;
        memcpy(&bits, x + i, sizeof bits);
        key[i] = (key[i] ^ bits) * spread;
        key[i] ^= key[i] >> 29;
    }
}

static bool has_missing(size_t rows, const double *x)
{
    int missing = 0;
    for (size_t i = 0; i < rows; i++)
        missing |= x[i] != x[i];
    return missing != 0;
}

void imki_row_keys(size_t channels, const int *column, size_t rows, double *const *columns,
                   size_t first, uint64_t *key)
{
    for (size_t i = 0; i < rows; i++)
        key[i] = spread;
    for (size_t c = 0; c < channels; c++)
        add_channel(rows, columns[column[c]] + first, key);
    for (size_t c = 0; c < channels; c++) {
        const double *x = columns[column[c]] + first;
        const size_t marked = has_missing(rows, x) ? rows : 0;
        for (size_t i = 0; i < marked; i++)
            key[i] = x[i] == x[i] ? key[i] : 0;
    }
}
