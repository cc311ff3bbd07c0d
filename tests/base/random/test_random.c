/* SPDX-License-Identifier: Apache-2.0 */
/* Random words and normals: published answers, the documented layout, and the same bits from every
 * kernel and for every division of the work. The distribution is in test_normals.c. */
#define _POSIX_C_SOURCE 200809L /* setenv */
#include "check.h"

#include "imukit/random.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { KERNELS = 4, GROUP = 32 };

static const char *isa_before; /* IMUKIT_ISA of the caller, kept by main */

static void restore_isa(void)
{
    if (isa_before)
        setenv("IMUKIT_ISA", isa_before, 1);
    else
        unsetenv("IMUKIT_ISA");
}

/* The kernels of this machine: those that IMUKIT_ISA can force. */
static size_t kernels_here(imk_kernel kernels[KERNELS])
{
    size_t count = 0;
    for (int i = 0; i < KERNELS; i++) {
        setenv("IMUKIT_ISA", imk_kernel_name((imk_kernel)i), 1);
        if (imk_random_seeded(0).kernel == (imk_kernel)i)
            kernels[count++] = (imk_kernel)i;
    }
    restore_isa();
    return count;
}

/* Random123 1.14, tests/kat_vectors, "philox4x32 10": zeros, ones, digits of pi. */
static void philox_known_answers(void **state)
{
    (void)state;
    static const struct {
        uint32_t counter[4], key[2], expected[4];
    } cases[] = {
        {{0, 0, 0, 0}, {0, 0}, {0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}},
        {{0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff},
         {0xffffffff, 0xffffffff},
         {0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}},
        {{0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344},
         {0xa4093822, 0x299f31d0},
         {0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        uint32_t out[4];
        imk_philox4x32(cases[i].counter, cases[i].key, out);
        assert_memory_equal(out, cases[i].expected, sizeof out);
        memcpy(out, cases[i].counter, sizeof out);
        imk_philox4x32(out, cases[i].key, out); /* in place */
        assert_memory_equal(out, cases[i].expected, sizeof out);
    }
}

static void words_are_philox_blocks(void **state)
{
    (void)state;
    const imk_random source = imk_random_seeded(UINT64_C(0x299f31d0a4093822));
    const uint64_t stream = UINT64_C(0x0370734413198a2e), block = UINT64_C(0x05a308d3243f6a88);
    const uint32_t counter[4] = {0x243f6a88, 0x05a308d3, 0x13198a2e, 0x03707344};
    const uint32_t key[2] = {0xa4093822, 0x299f31d0};
    uint32_t expected[4], words[4];
    imk_philox4x32(counter, key, expected);
    imk_random_words(source, stream, 4 * block, 4, words);
    assert_memory_equal(words, expected, sizeof words);
}

static void words_do_not_depend_on_the_division(void **state)
{
    (void)state;
    enum { COUNT = 100 };
    const imk_random source = imk_random_seeded(3);
    const uint64_t first = (UINT64_C(1) << 34) - 50; /* block number passes 2^32 */
    uint32_t whole[COUNT], part[COUNT];
    imk_random_words(source, 9, first, COUNT, whole);
    for (size_t start = 0; start < COUNT; start++)
        for (size_t count = 0; start + count <= COUNT; count++) {
            memset(part, 0, sizeof part);
            imk_random_words(source, 9, first + start, count, part);
            assert_memory_equal(part, whole + start, count * sizeof *part);
            assert_true(count == COUNT || part[count] == 0);
        }
}

static void streams_are_packed_as_documented(void **state)
{
    (void)state;
    assert_int_equal(imk_stream(0x89abcdef, 0x4567, 0x23, 0x01), UINT64_C(0x89abcdef45672301));
}

static void environment_forces_a_kernel(void **state)
{
    (void)state;
    imk_kernel kernels[KERNELS];
    const size_t count = kernels_here(kernels);
    assert_true(count >= 1 && kernels[0] == IMK_KERNEL_SCALAR);
    setenv("IMUKIT_ISA", "abacus", 1);
    const imk_random fastest = imk_random_seeded(5);
    assert_int_equal(fastest.seed, 5);
    assert_int_equal(fastest.kernel, kernels[count - 1]);
    restore_isa();
}

/* One normal as random.h defines it, in long double. */
static double exact_normal(imk_random source, uint64_t stream, uint64_t index)
{
    const uint64_t block = index / GROUP * 8 + index % 8;
    const unsigned part = index / 8 % 4;
    uint32_t word[2];
    imk_random_words(source, stream, 4 * block + part / 2 * 2, 2, word);
    const uint64_t n = (uint64_t)word[0] << 32 | word[1];
    const uint64_t k = n >> 23 & ((UINT64_C(1) << 40) - 1);
    const uint64_t j = n >> 1 & ((UINT64_C(1) << 22) - 1);
    const long double r = sqrtl(-2.0L * logl(ldexpl((long double)(2 * k + 1), -41)));
    const long double angle = ldexpl((long double)(2 * j + 1), -24) * 3.14159265358979323846264L;
    const long double size = part % 2 ? r * sinl(angle) : r * cosl(angle);
    const uint64_t minus = part % 2 ? n & 1 : n >> 63;
    return (double)(minus ? -size : size);
}

static void normals_are_as_documented(void **state)
{
    (void)state;
    enum { COUNT = 20000 };
    static double normals[COUNT];
    imk_kernel kernels[KERNELS];
    const size_t count = kernels_here(kernels);
    for (size_t i = 0; i < count; i++) {
        const imk_random source = {UINT64_C(0xfedcba9876543210), kernels[i]};
        const uint64_t first = UINT64_C(123456789012345);
        imk_random_normals(source, 77, first, COUNT, normals);
        for (size_t k = 0; k < COUNT; k++)
            CHECK_CLOSE(normals[k], exact_normal(source, 77, first + k), 4e-13);
    }
}

/* Inverse of an odd number modulo 2^32; each Newton step doubles the right bits, 3 at first. */
static uint32_t inverse(uint32_t odd)
{
    uint32_t x = odd;
    for (int i = 0; i < 4; i++)
        x *= 2 - odd * x;
    return x;
}

/* Counter whose Philox block is `out`: Philox is a permutation of the counters. This lets the test
 * choose the bits that normals are made of. */
static void philox_inverse(const uint32_t out[4], const uint32_t key[2], uint32_t counter[4])
{
    uint32_t w[4] = {out[0], out[1], out[2], out[3]};
    for (uint32_t round = 10; round-- > 0;) {
        const uint32_t key0 = key[0] + round * 0x9E3779B9, key1 = key[1] + round * 0xBB67AE85;
        const uint32_t w2 = w[1] * inverse(0xCD9E8D57), w0 = w[3] * inverse(0xD2511F53);
        w[1] = w[0] ^ key0 ^ (uint32_t)((uint64_t)w2 * 0xCD9E8D57 >> 32);
        w[3] = w[2] ^ key1 ^ (uint32_t)((uint64_t)w0 * 0xD2511F53 >> 32);
        w[0] = w0;
        w[2] = w2;
    }
    memcpy(counter, w, sizeof w);
}

/* Compare all kernels with the scalar one and the definition where the number n is drawn. */
static void check_number(const imk_kernel *kernels, size_t count, uint64_t n)
{
    const uint32_t key[2] = {1, 0};
    uint32_t counter[4];
    /* Block numbers end at 2^62: try other second numbers until the block is one. */
    uint32_t out[4] = {(uint32_t)(n >> 32), (uint32_t)n, 0, 0};
    do {
        out[2]++;
        philox_inverse(out, key, counter);
    } while (counter[1] >> 29 != 0);
    const uint64_t block = (uint64_t)counter[1] << 32 | counter[0];
    const uint64_t stream = (uint64_t)counter[3] << 32 | counter[2];
    const uint64_t first = block / 8 * GROUP + block % 8;
    for (uint64_t part = 0; part < 2; part++) {
        double scalar, other;
        imk_random_normals((imk_random){1, IMK_KERNEL_SCALAR}, stream, first + 8 * part, 1,
                           &scalar);
        CHECK_CLOSE(scalar,
                    exact_normal((imk_random){1, IMK_KERNEL_SCALAR}, stream, first + 8 * part),
                    4e-13);
        CHECK_BELOW(fabs(scalar), 7.54);
        for (size_t i = 0; i < count; i++) {
            imk_random_normals((imk_random){1, kernels[i]}, stream, first + 8 * part, 1, &other);
            assert_memory_equal(&other, &scalar, sizeof other);
        }
    }
}

static void normals_of_extreme_bits(void **state)
{
    (void)state;
    imk_kernel kernels[KERNELS];
    const size_t count = kernels_here(kernels);
    const uint64_t j_last = (UINT64_C(1) << 22) - 1, k_last = (UINT64_C(1) << 40) - 1;
    const uint64_t j[] = {0, 1, j_last / 2, j_last / 2 + 1, j_last - 1, j_last};
    for (int power = 0; power <= 40; power++) {
        /* Around the steps of the exponent (3/4 of a power of two) and of the double (a power). */
        const uint64_t one = UINT64_C(1) << power;
        const uint64_t centres[] = {one, one / 4 * 3};
        for (size_t i = 0; i < 2; i++)
            for (uint64_t k = centres[i] < 3 ? 0 : centres[i] - 3; k <= centres[i] + 3; k++) {
                if (k > k_last)
                    break;
                const size_t pick = (size_t)(k + (uint64_t)power) % 6;
                const uint64_t signs = k % 4;
                check_number(kernels, count,
                             signs >> 1 << 63 | k << 23 | j[pick] << 1 | (signs & 1));
            }
    }
    for (size_t i = 0; i < 6; i++)
        for (uint64_t signs = 0; signs < 4; signs++) {
            check_number(kernels, count, signs >> 1 << 63 | j[i] << 1 | (signs & 1));
            check_number(kernels, count, signs >> 1 << 63 | k_last << 23 | j[i] << 1 | (signs & 1));
        }
}

static void kernels_make_the_same_bits(void **state)
{
    (void)state;
    enum { COUNT = 320000 };
    static double scalar[COUNT], other[COUNT];
    /* The second range passes block number 2^32, the last one ends at the last block there is. */
    const uint64_t firsts[] = {0, (UINT64_C(1) << 34) - COUNT / 2 + 5, UINT64_C(0) - COUNT};
    imk_kernel kernels[KERNELS];
    const size_t count = kernels_here(kernels);
    for (uint64_t i = 0; i < 3; i++) {
        const uint64_t seed = i * UINT64_C(0x123456789abcdef), stream = ~i;
        imk_random_normals((imk_random){seed, IMK_KERNEL_SCALAR}, stream, firsts[i], COUNT, scalar);
        for (size_t k = 1; k < count; k++) {
            imk_random_normals((imk_random){seed, kernels[k]}, stream, firsts[i], COUNT, other);
            assert_memory_equal(other, scalar, sizeof other);
        }
    }
}

static void normals_do_not_depend_on_the_division(void **state)
{
    (void)state;
    enum { COUNT = 200 };
    imk_kernel kernels[KERNELS];
    const size_t kernel_count = kernels_here(kernels);
    const uint64_t first = (UINT64_C(1) << 34) - 101;
    const double untouched = 99.0;
    double whole[COUNT], part[COUNT + 1];
    for (size_t i = 0; i < kernel_count; i++) {
        const imk_random source = {11, kernels[i]};
        imk_random_normals(source, 4, first, COUNT, whole);
        for (size_t start = 0; start < COUNT; start += 1 + start / 40)
            for (size_t count = 0; start + count <= COUNT; count++) {
                part[count] = untouched;
                imk_random_normals(source, 4, first + start, count, part);
                assert_memory_equal(part, whole + start, count * sizeof *part);
                assert_true(part[count] == untouched);
            }
    }
}

/* FNV-1a of the first million normals of seed 1, stream 1. Made by this library once, and its
 * promise from then on; that they are right is what the other tests say. */
static void bits_never_change(void **state)
{
    (void)state;
    enum { COUNT = 1000000, PART = 4000 };
    imk_kernel kernels[KERNELS];
    const size_t count = kernels_here(kernels);
    for (size_t i = 0; i < count; i++) {
        uint64_t hash = UINT64_C(0xcbf29ce484222325);
        for (uint64_t first = 0; first < COUNT; first += PART) {
            uint64_t bits[PART];
            double normals[PART];
            imk_random_normals((imk_random){1, kernels[i]}, 1, first, PART, normals);
            memcpy(bits, normals, sizeof bits);
            for (size_t k = 0; k < PART; k++)
                for (int shift = 0; shift < 64; shift += 8)
                    hash = (hash ^ (bits[k] >> shift & 0xff)) * UINT64_C(0x100000001b3);
        }
        assert_int_equal(hash, UINT64_C(0x1f824a45b6823ddd));
    }
}

int main(void)
{
    static char copy[16];
    const char *isa = getenv("IMUKIT_ISA");
    if (isa)
        isa_before = strncpy(copy, isa, sizeof copy - 1);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(philox_known_answers),
        cmocka_unit_test(words_are_philox_blocks),
        cmocka_unit_test(words_do_not_depend_on_the_division),
        cmocka_unit_test(streams_are_packed_as_documented),
        cmocka_unit_test(environment_forces_a_kernel),
        cmocka_unit_test(normals_are_as_documented),
        cmocka_unit_test(normals_of_extreme_bits),
        cmocka_unit_test(kernels_make_the_same_bits),
        cmocka_unit_test(normals_do_not_depend_on_the_division),
        cmocka_unit_test(bits_never_change),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
