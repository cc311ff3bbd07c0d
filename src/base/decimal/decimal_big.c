/* SPDX-License-Identifier: Apache-2.0 */
/* Big natural numbers of fixed room: the exact comparison behind decimal reading and writing, for
 * the few numbers where 128 bits do not decide. */
#include "decimal_internal.h"

static void trim(imki_big *big)
{
    while (big->count > 0 && big->limb[big->count - 1] == 0)
        big->count--;
}

void imki_big_set(imki_big *big, uint64_t value)
{
    big->limb[0] = (uint32_t)value;
    big->limb[1] = (uint32_t)(value >> 32);
    big->count = 2;
    trim(big);
}

void imki_big_multiply_add(imki_big *big, uint32_t factor, uint32_t addend)
{
    uint64_t carry = addend;
    for (int i = 0; i < big->count; i++) {
        carry += (uint64_t)big->limb[i] * factor;
        big->limb[i] = (uint32_t)carry;
        carry >>= 32;
    }
    if (carry > 0 && big->count < IMKI_BIG_LIMBS)
        big->limb[big->count++] = (uint32_t)carry;
}

void imki_big_multiply_power_of_five(imki_big *big, int exponent)
{
    for (; exponent >= 13; exponent -= 13)
        imki_big_multiply_add(big, 1220703125, 0); /* 5^13, the largest below 2^32 */
    for (; exponent > 0; exponent--)
        imki_big_multiply_add(big, 5, 0);
}

void imki_big_shift_left(imki_big *big, int bits)
{
    const int limbs = bits / 32;
    if (big->count == 0 || limbs + big->count > IMKI_BIG_LIMBS)
        return;
    memmove(big->limb + limbs, big->limb, (size_t)big->count * sizeof big->limb[0]);
    memset(big->limb, 0, (size_t)limbs * sizeof big->limb[0]);
    big->count += limbs;
    imki_big_multiply_add(big, UINT32_C(1) << bits % 32, 0);
}

uint32_t imki_big_divide_by_billion(imki_big *big)
{
    uint64_t remainder = 0;
    for (int i = big->count - 1; i >= 0; i--) {
        remainder = remainder << 32 | big->limb[i];
        big->limb[i] = (uint32_t)(remainder / 1000000000);
        remainder %= 1000000000;
    }
    trim(big);
    return (uint32_t)remainder;
}

static int compare(const imki_big *a, const imki_big *b)
{
    if (a->count != b->count)
        return a->count > b->count ? 1 : -1;
    for (int i = a->count - 1; i >= 0; i--)
        if (a->limb[i] != b->limb[i])
            return a->limb[i] > b->limb[i] ? 1 : -1;
    return 0;
}

int imki_big_compare_scaled(imki_big *a, int a_binary, int a_decimal, imki_big *b, int b_binary)
{
    /* 10^e = 2^e 5^e; a negative power of five goes to the other side. */
    if (a_decimal >= 0)
        imki_big_multiply_power_of_five(a, a_decimal);
    else
        imki_big_multiply_power_of_five(b, -a_decimal);
    const int left = a_binary + a_decimal - b_binary;
    if (left >= 0)
        imki_big_shift_left(a, left);
    else
        imki_big_shift_left(b, -left);
    return compare(a, b);
}
