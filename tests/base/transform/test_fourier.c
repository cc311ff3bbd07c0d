/* SPDX-License-Identifier: Apache-2.0 */
/* Fourier and cosine transforms against the defining sums in long double, and against their own
 * inverses and Parseval's identity where the sums would take too long.
 *
 * Rounding errors of a fast transform grow as sqrt(log n) times a few 1e-16 of the norm
 * [VANLOAN1992, sec. 1.4]; Bluestein's method has three transforms of more than twice the length.
 */
#include "check.h"

#include "imukit/fourier.h"

#include <stdlib.h>
#include <string.h>

static const long double pi = 3.14159265358979323846264338327950288L;

/* Uniform numbers in (-1/2, 1/2), the same in every run [MARSAGLIA2003]. */
static double next_number(uint64_t *state)
{
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    return (double)(*state >> 11) * 0x1p-53 - 0.5;
}

static double *random_numbers(size_t count, uint64_t seed)
{
    double *x = malloc(count * sizeof *x);
    assert_non_null(x);
    uint64_t state = 0x9E3779B97F4A7C15u + seed;
    for (size_t i = 0; i < count; i++)
        x[i] = next_number(&state);
    return x;
}

static void transform(size_t n, double *data, int inverse)
{
    const size_t size = imk_fourier_workspace_size(n);
    void *workspace = malloc(size);
    assert_non_null(workspace);
    CHECK_OK(imk_fourier(n, data, inverse, workspace, size));
    free(workspace);
}

static void cosine(size_t n, double *data)
{
    const size_t size = imk_cosine_workspace_size(n);
    void *workspace = malloc(size);
    assert_non_null(workspace);
    CHECK_OK(imk_cosine(n, data, workspace, size));
    free(workspace);
}

/* Error of the transform of random numbers, relative to its norm. Every `stride`-th output is
 * compared. */
static double fourier_error(size_t n, size_t stride)
{
    double *x = random_numbers(2 * n, n);
    double *y = malloc(2 * n * sizeof *y);
    long double *root = malloc(2 * n * sizeof *root);
    assert_non_null(y);
    assert_non_null(root);
    memcpy(y, x, 2 * n * sizeof *y);
    transform(n, y, 0);
    for (size_t k = 0; k < n; k++) {
        root[2 * k] = cosl(2.0L * pi * (long double)k / (long double)n);
        root[2 * k + 1] = -sinl(2.0L * pi * (long double)k / (long double)n);
    }
    long double error = 0.0L, norm = 0.0L;
    for (size_t k = 0; k < n; k += stride) {
        long double re = 0.0L, im = 0.0L;
        for (size_t j = 0, power = 0; j < n; j++) {
            const long double *w = root + 2 * power;
            re += x[2 * j] * w[0] - x[2 * j + 1] * w[1];
            im += x[2 * j] * w[1] + x[2 * j + 1] * w[0];
            power = power + k < n ? power + k : power + k - n;
        }
        error += (re - y[2 * k]) * (re - y[2 * k]) + (im - y[2 * k + 1]) * (im - y[2 * k + 1]);
        norm += re * re + im * im;
    }
    free(x);
    free(y);
    free(root);
    return (double)sqrtl(error / norm);
}

static double cosine_error(size_t n, size_t stride)
{
    double *x = random_numbers(n, n);
    double *y = malloc(n * sizeof *y);
    long double *wave = malloc(4 * n * sizeof *wave);
    assert_non_null(y);
    assert_non_null(wave);
    memcpy(y, x, n * sizeof *y);
    cosine(n, y);
    for (size_t k = 0; k < 4 * n; k++)
        wave[k] = cosl(pi * (long double)k / (2.0L * (long double)n));
    long double error = 0.0L, norm = 0.0L;
    for (size_t k = 0; k < n; k += stride) {
        long double sum = 0.0L;
        for (size_t j = 0; j < n; j++)
            sum += x[j] * wave[k * (2 * j + 1) % (4 * n)];
        sum *= sqrtl((k == 0 ? 1.0L : 2.0L) / (long double)n);
        error += (sum - y[k]) * (sum - y[k]);
        norm += sum * sum;
    }
    free(x);
    free(y);
    free(wave);
    return (double)sqrtl(error / norm);
}

static void every_short_length_agrees_with_the_sum(void **state)
{
    (void)state;
    for (size_t n = 1; n <= 300; n++)
        CHECK_BELOW(fourier_error(n, 1), 1e-15);
}

/* Powers of each radix, mixed radices, sweeps with partly filled lanes, primes, and products of a
 * large prime. */
static void longer_lengths_agree_with_the_sum(void **state)
{
    (void)state;
    const size_t lengths[] = {343,  512,  625,  729,  1000, 1001, 1009, 1024, 1331, 2048,
                              2187, 2197, 2310, 2401, 3125, 4095, 4096, 4099, 5040, 7 * 509};
    for (size_t i = 0; i < sizeof lengths / sizeof lengths[0]; i++)
        CHECK_BELOW(fourier_error(lengths[i], 7), 1e-15);
    CHECK_BELOW(fourier_error(100000, 4999), 1e-15);
    CHECK_BELOW(fourier_error(65536, 4999), 1e-15);
    CHECK_BELOW(fourier_error(65537, 4999), 1e-15);
}

/* Inverse, and Parseval's sum |X|^2 = n sum |x|^2, where the direct sum would take minutes. */
static void long_lengths_invert_and_keep_the_energy(void **state)
{
    (void)state;
    const size_t lengths[] = {262144, 1000000, 360360, 100003};
    for (size_t i = 0; i < sizeof lengths / sizeof lengths[0]; i++) {
        const size_t n = lengths[i];
        double *x = random_numbers(2 * n, n);
        double *y = malloc(2 * n * sizeof *y);
        assert_non_null(y);
        memcpy(y, x, 2 * n * sizeof *y);
        transform(n, y, 0);
        long double before = 0.0L, after = 0.0L, error = 0.0L;
        for (size_t j = 0; j < 2 * n; j++) {
            before += (long double)x[j] * x[j];
            after += (long double)y[j] * y[j];
        }
        CHECK_RELATIVE((double)(after / (long double)n), (double)before, 1e-14);
        transform(n, y, 1);
        for (size_t j = 0; j < 2 * n; j++)
            error += ((long double)y[j] - x[j]) * ((long double)y[j] - x[j]);
        CHECK_BELOW((double)sqrtl(error / before), 2e-15);
        free(x);
        free(y);
    }
}

/* A line on bin k of a long transform: everything else is rounding. */
static void a_pure_tone_has_one_line(void **state)
{
    (void)state;
    const size_t n = 1 << 18, bin = 77777;
    double *x = malloc(2 * n * sizeof *x);
    assert_non_null(x);
    for (size_t j = 0; j < n; j++) {
        const long double angle = 2.0L * pi * (long double)(j * bin % n) / (long double)n;
        x[2 * j] = (double)cosl(angle);
        x[2 * j + 1] = (double)sinl(angle);
    }
    transform(n, x, 0);
    CHECK_RELATIVE(x[2 * bin], (double)n, 1e-14);
    double rest = 0.0;
    for (size_t k = 0; k < n; k++) {
        if (k != bin)
            rest += x[2 * k] * x[2 * k] + x[2 * k + 1] * x[2 * k + 1];
    }
    CHECK_BELOW(sqrt(rest), 1e-15 * (double)n);
    free(x);
}

static void cosine_transform_agrees_with_the_sum(void **state)
{
    (void)state;
    for (size_t n = 1; n <= 130; n++)
        CHECK_BELOW(cosine_error(n, 1), 1e-15);
    const size_t lengths[] = {1000, 1024, 1026, 1999, 2000, 2002, 4097, 6561};
    for (size_t i = 0; i < sizeof lengths / sizeof lengths[0]; i++)
        CHECK_BELOW(cosine_error(lengths[i], 13), 1e-15);
    CHECK_BELOW(cosine_error(200000, 59999), 1.5e-15);
    CHECK_BELOW(cosine_error(99999, 29989), 1.5e-15);
}

/* It is orthonormal, so the energy stays; and a constant has only c[0] = sqrt(n). */
static void cosine_transform_keeps_the_energy(void **state)
{
    (void)state;
    const size_t n = 1000000;
    double *x = random_numbers(n, 5);
    long double before = 0.0L, after = 0.0L;
    for (size_t j = 0; j < n; j++)
        before += (long double)x[j] * x[j];
    cosine(n, x);
    for (size_t j = 0; j < n; j++)
        after += (long double)x[j] * x[j];
    CHECK_RELATIVE((double)after, (double)before, 1e-14);
    for (size_t j = 0; j < n; j++)
        x[j] = 1.0;
    cosine(n, x);
    CHECK_RELATIVE(x[0], sqrt((double)n), 1e-14);
    double rest = 0.0;
    for (size_t k = 1; k < n; k++)
        rest += x[k] * x[k];
    CHECK_BELOW(sqrt(rest), 1e-15 * sqrt((double)n));
    free(x);
}

static void bad_calls_are_refused_and_leave_the_data(void **state)
{
    (void)state;
    double data[4] = {1.0, 2.0, 3.0, 4.0};
    double workspace[64];
    assert_int_equal(imk_fourier_workspace_size(0), 0);
    assert_int_equal(imk_cosine_workspace_size(0), 0);
    assert_int_equal(imk_fourier_workspace_size(SIZE_MAX), 0);
    assert_int_equal(imk_cosine_workspace_size(SIZE_MAX), 0);
    assert_int_equal(imk_cosine_workspace_size(SIZE_MAX / 2), 0);
    CHECK_STATUS(imk_fourier(0, data, 0, workspace, sizeof workspace), IMK_ERROR_ARGUMENT);
    CHECK_STATUS(imk_fourier(2, NULL, 0, workspace, sizeof workspace), IMK_ERROR_ARGUMENT);
    CHECK_STATUS(imk_fourier(2, data, 0, NULL, 0), IMK_ERROR_ARGUMENT);
    CHECK_STATUS(imk_fourier(2, data, 0, workspace, imk_fourier_workspace_size(2) - 1),
                 IMK_ERROR_WORKSPACE);
    CHECK_STATUS(imk_cosine(4, data, workspace, imk_cosine_workspace_size(4) - 1),
                 IMK_ERROR_WORKSPACE);
    CHECK_STATUS(imk_cosine(0, data, workspace, sizeof workspace), IMK_ERROR_ARGUMENT);
    for (int i = 0; i < 4; i++)
        CHECK_CLOSE(data[i], 1.0 + i, 0.0);
}

/* A workspace at any address, and no byte written beyond the size asked for. */
static void the_workspace_is_enough_and_may_be_unaligned(void **state)
{
    (void)state;
    const size_t lengths[] = {1, 2, 7, 17, 100, 256, 257, 260, 289, 1013, 3000};
    for (size_t i = 0; i < sizeof lengths / sizeof lengths[0]; i++) {
        const size_t n = lengths[i];
        const size_t size = imk_fourier_workspace_size(n), wave_size = imk_cosine_workspace_size(n);
        const size_t largest = size > wave_size ? size : wave_size;
        unsigned char *memory = malloc(largest + 16);
        double *x = random_numbers(2 * n, 3);
        assert_non_null(memory);
        for (size_t shift = 0; shift < 8; shift += 3) {
            memset(memory, 0xA5, largest + 16);
            CHECK_OK(imk_fourier(n, x, 0, memory + shift, size));
            for (size_t b = 0; b < 8; b++)
                assert_int_equal(memory[shift + size + b], 0xA5);
            memset(memory, 0xA5, largest + 16);
            CHECK_OK(imk_cosine(n, x, memory + shift, wave_size));
            for (size_t b = 0; b < 8; b++)
                assert_int_equal(memory[shift + wave_size + b], 0xA5);
        }
        free(memory);
        free(x);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_short_length_agrees_with_the_sum),
        cmocka_unit_test(longer_lengths_agree_with_the_sum),
        cmocka_unit_test(long_lengths_invert_and_keep_the_energy),
        cmocka_unit_test(a_pure_tone_has_one_line),
        cmocka_unit_test(cosine_transform_agrees_with_the_sum),
        cmocka_unit_test(cosine_transform_keeps_the_energy),
        cmocka_unit_test(bad_calls_are_refused_and_leave_the_data),
        cmocka_unit_test(the_workspace_is_enough_and_may_be_unaligned),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
