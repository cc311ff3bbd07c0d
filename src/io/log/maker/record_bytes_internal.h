/* SPDX-License-Identifier: Apache-2.0 */
/* Numbers in the bytes of binary records. */
#ifndef IMUKIT_RECORD_BYTES_INTERNAL_H
#define IMUKIT_RECORD_BYTES_INTERNAL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* A number of 1 … 8 bytes, the lowest first. */
static inline uint64_t imki_little(const void *bytes, size_t size)
{
    const unsigned char *at = bytes;
    uint64_t number = 0;
    for (size_t i = size; i > 0; i--)
        number = number << 8 | at[i - 1];
    return number;
}

/* A number of 1 … 8 bytes, the highest first. */
static inline uint64_t imki_big(const void *bytes, size_t size)
{
    const unsigned char *at = bytes;
    uint64_t number = 0;
    for (size_t i = 0; i < size; i++)
        number = number << 8 | at[i];
    return number;
}

/* The two's complement number in the lowest bits. @param bits  1 … 64 */
static inline int64_t imki_signed(uint64_t number, unsigned bits)
{
    const uint64_t sign = UINT64_C(1) << ((bits - 1) & 63);
    const uint64_t extended = bits < 64 ? ((number & (2 * sign - 1)) ^ sign) - sign : number;
    int64_t value;
    memcpy(&value, &extended, sizeof value);
    return value;
}

/* IEEE 754 numbers as their bits. */
static inline double imki_float(uint64_t bits)
{
    const uint32_t low = (uint32_t)bits;
    float value;
    memcpy(&value, &low, sizeof value);
    return (double)value;
}

static inline double imki_double(uint64_t bits)
{
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* A counter that begins again at 0 after its last number, as one that does not. */
typedef struct imki_counter {
    bool begun;
    uint64_t last;
    int64_t total;
} imki_counter;

/* The next number of it. A step beyond half of its range is one back: rows out of order.
 * @param bits  1 … 64 */
static inline int64_t imki_counter_unwrap(imki_counter *counter, uint64_t number, unsigned bits,
                                          bool is_signed)
{
    if (!counter->begun)
        counter->total = is_signed || bits == 64 ? imki_signed(number, bits) : (int64_t)number;
    else
        counter->total =
            (int64_t)((uint64_t)counter->total +
                      (uint64_t)imki_signed(number - counter->last, bits)); /* without overflow */
    counter->begun = true;
    counter->last = number;
    return counter->total;
}

#endif
