/* SPDX-License-Identifier: Apache-2.0 */
/* The streaming Allan variances against their definition, shards against one pass, and what they
 * keep of the degrees of freedom. */
#include "check.h"

#include "imukit/allan.h"
#include "imukit/allan_stream.h"
#include "imukit/random.h"

#include <stdlib.h>
#include <string.h>

enum { SAMPLES = 20000 };
static double record[SAMPLES];

/* Anything below `limit`, the same on every machine. */
static size_t draw(uint64_t *place, size_t limit)
{
    uint32_t word;
    imk_random_words(imk_random_seeded(5), 9, (*place)++, 1, &word);
    return (size_t)(word % limit);
}

/* The definition, windows at multiples of the stride from the start of the record's count. */
static long double definition(size_t first, size_t n, const double *x, size_t m, size_t *count)
{
    const size_t stride = m > 4 ? m / 4 : 1;
    long double sum = 0;
    *count = 0;
    for (size_t start = (first + stride - 1) / stride * stride; start + 2 * m <= first + n;
         start += stride) {
        long double d = 0;
        for (size_t i = 0; i < m; i++)
            d += (long double)x[start - first + m + i] - (long double)x[start - first + i];
        sum += d * d;
        ++*count;
    }
    return sum / (2.0L * m * m * *count);
}

static void test_definition(void **state)
{
    (void)state;
    uint64_t place = 0;
    imk_random_normals(imk_random_seeded(1), 1, 0, SAMPLES, record);
    for (size_t trial = 0; trial < 40; trial++) {
        const size_t n = 2 + draw(&place, 3000), first = draw(&place, 700);
        imk_allan_stream stream;
        imk_allan_stream_point points[IMK_ALLAN_STREAM_FACTORS];
        imk_allan_stream_start(&stream, first);
        for (size_t i = 0; i < n;) { /* in pieces of any size */
            const size_t piece = draw(&place, 200), some = piece < n - i ? piece : n - i;
            imk_allan_stream_add(&stream, some, record + i);
            i += some;
        }
        const size_t count = imk_allan_stream_points(&stream, points);
        assert_true(count >= 1);
        for (size_t k = 0; k < count; k++) {
            size_t windows;
            const long double expected = definition(first, n, record, points[k].m, &windows);
            assert_int_equal(points[k].count, windows);
            assert_int_equal(points[k].stride, points[k].m > 4 ? points[k].m / 4 : 1);
            CHECK_RELATIVE(points[k].variance, (double)expected, 1e-12);
        }
    }
}

/* The same statistics to the last digit: rounding carried along makes the sums independent of the
 * grouping but for cases of one in 1e15. */
static void check_same(const imk_allan_stream *a, const imk_allan_stream *b)
{
    imk_allan_stream_point p[IMK_ALLAN_STREAM_FACTORS], q[IMK_ALLAN_STREAM_FACTORS];
    const size_t count = imk_allan_stream_points(a, p);
    assert_int_equal(count, imk_allan_stream_points(b, q));
    for (size_t k = 0; k < count; k++) {
        assert_int_equal(p[k].count, q[k].count);
        CHECK_RELATIVE(p[k].variance, q[k].variance, 2.3e-16);
    }
    assert_int_equal(a->present, b->present);
    assert_int_equal(a->missing, b->missing);
    assert_int_equal(a->next, b->next);
    CHECK_RELATIVE(a->minimum, b->minimum, 0);
    CHECK_RELATIVE(a->maximum, b->maximum, 0);
    CHECK_CLOSE(a->sum + a->sum_error, b->sum + b->sum_error,
                1e-15 * (1 + fabs(a->sum + a->sum_error)));
}

static void test_shards(void **state)
{
    (void)state;
    enum { PARTS = 6 };
    uint64_t place = 100000;
    for (size_t trial = 0; trial < 300; trial++) {
        imk_random_normals(imk_random_seeded(2), trial, 0, 4000, record);
        const size_t first = draw(&place, 5000);
        size_t n = 0, length[PARTS];
        for (size_t p = 0; p < PARTS; p++)
            n += length[p] = draw(&place, trial % 3 == 0 ? 12 : 600);
        if (trial % 2 && n > 0)
            for (int i = 0; i < 4; i++)
                record[draw(&place, n)] = NAN;
        imk_allan_stream one, part[PARTS];
        imk_allan_stream_start(&one, first);
        imk_allan_stream_add(&one, n, record);
        for (size_t p = 0, at = 0; p < PARTS; at += length[p++]) {
            imk_allan_stream_start(&part[p], first + at);
            imk_allan_stream_add(&part[p], length[p], record + at);
        }
        for (size_t left = PARTS; left > 1; left--) { /* in any grouping */
            const size_t p = draw(&place, left - 1);
            CHECK_STATUS(imk_allan_stream_join(&part[p], &part[p + 1]), IMK_OK);
            memmove(&part[p + 1], &part[p + 2], (left - p - 2) * sizeof part[0]);
        }
        check_same(&part[0], &one);
        imk_allan_stream_add(&one, 900, record + 3000); /* the joined one goes on like the other */
        imk_allan_stream_add(&part[0], 900, record + 3000);
        check_same(&part[0], &one);
    }
}

static void test_join_refuses(void **state)
{
    (void)state;
    imk_allan_stream a, b;
    imk_allan_stream_start(&a, 0);
    imk_allan_stream_add(&a, 10, record);
    imk_allan_stream_start(&b, 11);
    CHECK_STATUS(imk_allan_stream_join(&a, &b), IMK_ERROR_ARGUMENT);
    assert_int_equal(a.next, 10);
    imk_allan_stream_start(&b, 10);
    imk_allan_stream_add(&b, 10, record);
    imk_allan_stream_pool(&a, &b);
    assert_int_equal(a.squares[0].count, 18); /* none across */
    assert_int_equal(a.present, 20);
    CHECK_STATUS(imk_allan_stream_join(&a, &b), IMK_ERROR_ARGUMENT);
}

/* An accelerometer at 9.8 m/s^2 with 1e-7 of noise: a growing integral would lose it. */
static void test_gravity_costs_nothing(void **state)
{
    (void)state;
    enum { REPEATS = 400 };
    imk_allan_stream with, without;
    imk_allan_stream_start(&with, 0);
    imk_allan_stream_start(&without, 0);
    double *heavy = malloc(SAMPLES * sizeof *heavy);
    for (size_t r = 0; r < REPEATS; r++) {
        imk_random_normals(imk_random_seeded(3), r, 0, SAMPLES, record);
        for (size_t i = 0; i < SAMPLES; i++) {
            heavy[i] = 9.80665 + 1e-7 * record[i];
            record[i] = heavy[i] - 9.80665; /* exact: both are multiples of 2^-49 */
        }
        imk_allan_stream_add(&with, SAMPLES, heavy);
        imk_allan_stream_add(&without, SAMPLES, record);
    }
    imk_allan_stream_point p[IMK_ALLAN_STREAM_FACTORS], q[IMK_ALLAN_STREAM_FACTORS];
    const size_t count = imk_allan_stream_points(&with, p);
    assert_int_equal(count, imk_allan_stream_points(&without, q));
    assert_true(count >= 22);
    /* A block sum of 2^20 samples is rounded to 2^-30, its mean to 2e-15 of gravity, against 1e-10
     * of noise left in it. */
    for (size_t k = 0; k < count; k++)
        CHECK_RELATIVE(p[k].variance, q[k].variance, p[k].m > 4096 ? 1e-4 : 1e-6);
    CHECK_CLOSE(imk_allan_stream_mean(&with), 9.80665, 5e-10); /* 1e-7/sqrt(8e6), 14 sigma */
    free(heavy);
}

/* Rare drops leave the variances as they are: 1 % missing raises white noise by 1 to 2 %. */
static void test_missing(void **state)
{
    (void)state;
    imk_allan_stream whole, holed;
    imk_allan_stream_start(&whole, 0);
    imk_allan_stream_start(&holed, 0);
    uint64_t place = 200000;
    size_t dropped = 0;
    for (size_t r = 0; r < 50; r++) {
        imk_random_normals(imk_random_seeded(4), r, 0, SAMPLES, record);
        imk_allan_stream_add(&whole, SAMPLES, record);
        for (size_t i = 0; i < SAMPLES / 100; i++)
            record[draw(&place, SAMPLES)] = i % 2 ? NAN : INFINITY;
        for (size_t i = 0; i < SAMPLES; i++)
            dropped += !(fabs(record[i]) < HUGE_VAL);
        imk_allan_stream_add(&holed, SAMPLES, record);
    }
    assert_int_equal(holed.missing, dropped);
    assert_int_equal(holed.present + dropped, 50 * SAMPLES);
    imk_allan_stream_point p[IMK_ALLAN_STREAM_FACTORS], q[IMK_ALLAN_STREAM_FACTORS];
    const size_t count = imk_allan_stream_points(&whole, p);
    assert_int_equal(count, imk_allan_stream_points(&holed, q));
    for (size_t k = 0; k < count; k++) {
        /* The same samples but for 1 %: what differs is small beside the scatter of either. */
        if (p[k].count > 1000)
            CHECK_CLOSE(q[k].variance / p[k].variance, 1.01, 0.04);
        assert_true(q[k].count <= p[k].count);
    }
}

/* Relative variance of the estimates of white noise: 2/edf with the kept part of the degrees that
 * full overlap has. 1500 records tell it to 3.7 % (one sigma), 20 % is 5.4. */
static void test_degrees_of_freedom(void **state)
{
    (void)state;
    enum { LENGTH = 2048, M = 64 };
    const size_t runs = check_runs(1500);
    double sum = 0, squares = 0;
    for (size_t r = 0; r < runs; r++) {
        imk_random_normals(imk_random_seeded(6), r, 0, LENGTH, record);
        imk_allan_stream s;
        imk_allan_stream_point p[IMK_ALLAN_STREAM_FACTORS];
        imk_allan_stream_start(&s, 0);
        imk_allan_stream_add(&s, LENGTH, record);
        imk_allan_stream_points(&s, p);
        assert_int_equal(p[6].m, M);
        const double v = p[6].variance * M;
        sum += v;
        squares += v * v;
    }
    const double mean = sum / (double)runs, variance = squares / (double)runs - mean * mean;
    const double full = imk_allan_edf_exact(IMK_ALLAN_OVERLAPPING, IMK_WHITE_RATE, LENGTH, M);
    const double scatter = 5.4 * sqrt(2 / (double)runs);
    CHECK_CLOSE(mean, 1, 5 * sqrt(2 / full / (double)runs));
    CHECK_CLOSE(2 / (variance * full * 0.928), 1, scatter);
}

static void test_size(void **state)
{
    (void)state;
    assert_true(sizeof(imk_allan_stream) < 4096);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_definition),   cmocka_unit_test(test_shards),
        cmocka_unit_test(test_join_refuses), cmocka_unit_test(test_gravity_costs_nothing),
        cmocka_unit_test(test_missing),      cmocka_unit_test(test_degrees_of_freedom),
        cmocka_unit_test(test_size),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
