/* SPDX-License-Identifier: Apache-2.0 */
/* The map of Haar differences: against its definition, however samples are handed over. */
#include "check.h"
#include "imukit/distributions.h"
#include "imukit/noise_map.h"
#include "imukit/random.h"

#include <string.h>

enum { N = 100003 };

static double samples[N];
static imk_noise_map map, other;

static void make(uint64_t stream)
{
    imk_random_normals(imk_random_seeded(5), stream, 0, N, samples);
    for (size_t i = 0; i < N; i++)
        samples[i] += 9.81;
}

static void fill(imk_noise_map *m, size_t count, size_t part)
{
    imk_noise_map_begin(m);
    for (size_t i = 0; i < count; i += part)
        imk_noise_map_add(m, count - i < part ? count - i : part, samples + i);
    imk_noise_map_end(m);
}

static double mean_of(size_t first, size_t count)
{
    double sum = 0;
    for (size_t i = first; i < first + count; i++)
        sum += samples[i];
    return sum / (double)count;
}

/* Means of two neighbouring clusters, each pair apart from the next: the same sums. */
static void test_definition(void **state)
{
    (void)state;
    make(1);
    fill(&map, N, N);
    assert_int_equal(map.block, 1024); /* 100003 samples in at most 128 columns */
    assert_int_equal(imk_noise_map_blocks(&map), 98);
    for (size_t j = 0; j < 14; j++) {
        const size_t m = (size_t)1 << j;
        double square = 0, count = 0;
        for (size_t i = 0; i + 2 * m <= N; i += 2 * m, count++)
            square += pow(mean_of(i + m, m) - mean_of(i, m), 2);
        const imk_estimate e = imk_noise_map_deviation(&map, j, 0, 128, 0.95);
        /* Sums of some 1e5 terms, with a mean ten times their size. */
        CHECK_RELATIVE(e.value, sqrt(0.5 * square / count), 1e-10);
        CHECK_RELATIVE(e.upper / e.value, sqrt(count / imk_chi_square_quantile(0.025, count)),
                       1e-12);
        CHECK_RELATIVE(e.lower / e.value, sqrt(count / imk_chi_square_quantile(0.975, count)),
                       1e-12);
    }
    assert_int_equal(imk_noise_map_octaves(&map), 12); /* 100003/2^12 = 24 differences, then 12 */
    assert_false(imk_noise_map_deviation(&map, 20, 0, 128, 0.95).present);
}

static void test_columns(void **state)
{
    (void)state;
    make(1);
    fill(&map, N, N);
    double square = 0;
    for (size_t i = 3 * 1024; i < 5 * 1024; i += 2)
        square += pow(samples[i + 1] - samples[i], 2);
    CHECK_RELATIVE(imk_noise_map_deviation(&map, 0, 3, 5, 0.95).value, sqrt(square / 2048), 1e-10);
    /* A difference that is longer than a column stands where it begins. */
    CHECK_RELATIVE(imk_noise_map_deviation(&map, 10, 4, 5, 0.95).value,
                   fabs(mean_of(5 * 1024, 1024) - mean_of(4 * 1024, 1024)) / sqrt(2), 1e-9);
    assert_false(imk_noise_map_deviation(&map, 10, 5, 6, 0.95).present);
}

/* Chunks have the same places, so every bit is the same. */
static void test_any_calls(void **state)
{
    (void)state;
    make(2);
    fill(&map, N, N);
    fill(&other, N, 77);
    assert_memory_equal(map.cell, other.cell, sizeof map.cell);
    fill(&other, N, 1024);
    assert_memory_equal(map.cell, other.cell, sizeof map.cell);
}

static void test_rescale(void **state)
{
    (void)state;
    make(3);
    fill(&map, N, N);
    const imk_estimate before = imk_noise_map_deviation(&map, 3, 0, 128, 0.95);
    imk_noise_map_rescale(&map, 8);
    CHECK_RELATIVE(imk_noise_map_deviation(&map, 3, 0, 128, 0.95).value, 8 * before.value, 1e-15);
}

/* Missing samples do not change the deviation of white noise: of each octave within 5 standard
 * deviations, false alarm 14 * 6e-7. */
static void test_missing(void **state)
{
    (void)state;
    make(4);
    for (size_t i = 0; i < N; i++)
        if (i * 2654435761u % 4294967296u < 429496730u || (i > 30000 && i < 33000))
            samples[i] = (double)NAN;
    fill(&map, N, 500);
    for (size_t j = 0; j < 10; j++) {
        const imk_estimate e = imk_noise_map_deviation(&map, j, 0, 128, 0.95);
        assert_true(e.present);
        CHECK_CLOSE(e.value * sqrt((double)((size_t)1 << j)), 1,
                    5 * e.sigma * sqrt((double)((size_t)1 << j)));
    }
}

/* Nothing but holes, and nothing at all. */
static void test_empty(void **state)
{
    (void)state;
    for (size_t i = 0; i < N; i++)
        samples[i] = (double)NAN;
    fill(&map, N, N);
    assert_int_equal(imk_noise_map_octaves(&map), 0);
    fill(&map, 0, 1);
    assert_int_equal(imk_noise_map_blocks(&map), 0);
    assert_int_equal(imk_noise_map_octaves(&map), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_definition), cmocka_unit_test(test_columns),
        cmocka_unit_test(test_any_calls),  cmocka_unit_test(test_rescale),
        cmocka_unit_test(test_missing),    cmocka_unit_test(test_empty)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
