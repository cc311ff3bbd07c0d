/* SPDX-License-Identifier: Apache-2.0 */
/* Numbers of little-endian records, at any address. */
#ifndef IMUKIT_ROS_BYTES_INTERNAL_H
#define IMUKIT_ROS_BYTES_INTERNAL_H

#include <stdint.h>
#include <string.h>

static inline uint16_t imki_get_u16(const uint8_t *at)
{
    return (uint16_t)(at[0] | at[1] << 8);
}

static inline uint32_t imki_get_u32(const uint8_t *at)
{
    return at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

static inline uint64_t imki_get_u64(const uint8_t *at)
{
    return imki_get_u32(at) | (uint64_t)imki_get_u32(at + 4) << 32;
}

static inline double imki_get_f64(const uint8_t *at)
{
    const uint64_t bits = imki_get_u64(at);
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static inline uint8_t *imki_put_u16(uint8_t *at, uint16_t value)
{
    at[0] = (uint8_t)value;
    at[1] = (uint8_t)(value >> 8);
    return at + 2;
}

static inline uint8_t *imki_put_u32(uint8_t *at, uint32_t value)
{
    for (int i = 0; i < 4; i++)
        at[i] = (uint8_t)(value >> 8 * i);
    return at + 4;
}

static inline uint8_t *imki_put_u64(uint8_t *at, uint64_t value)
{
    for (int i = 0; i < 8; i++)
        at[i] = (uint8_t)(value >> 8 * i);
    return at + 8;
}

static inline uint8_t *imki_put_f64(uint8_t *at, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return imki_put_u64(at, bits);
}

#endif
