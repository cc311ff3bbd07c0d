/* SPDX-License-Identifier: Apache-2.0 */
/* Slow noise that an automatic zero took away is missed, and sound records are not doubted. */
#include "check.h"
#include "identify/identify_values.h"
#include "imukit/noise.h"

#include <stdlib.h>

enum { N = 16384, LONG = IMK_IDENTIFY_RECORD_LEAST };

static const double DT = 0.01;

/* White noise of strength 1 at 100 Hz and flicker noise. */
static void make(uint32_t run, double instability, size_t n, double *x)
{
    static imk_flicker_state f;
    const imk_random random = imk_random_seeded(41);
    imk_random_normals(random, imk_stream(run, 1, 0, 0), 0, n, x);
    for (size_t i = 0; i < n; i++)
        x[i] *= 10; /* 1/sqrt(dt) */
    CHECK_STATUS(
        imk_flicker_start(&f, (imk_flicker){instability, 0}, DT, random, imk_stream(run, 2, 0, 0)),
        IMK_OK);
    imk_flicker_add(&f, n, x);
}

/* The mean of each stretch becomes zero. */
static void zero(size_t stretch, size_t n, double *x)
{
    for (size_t first = 0; first < n; first += stretch) {
        const size_t end = first + stretch < n ? first + stretch : n;
        double mean = 0;
        for (size_t i = first; i < end; i++)
            mean += x[i] / (double)(end - first);
        for (size_t i = first; i < end; i++)
            x[i] -= mean;
    }
}

static bool is_low(const imk_identification *r)
{
    return imk_level_loss(1, &r).degrees > 0;
}

/* A record is called low with a chance of 2e-5. Also with angles that are rounded to steps of two
 * standard deviations. */
static void test_sound(void **state)
{
    (void)state;
    double x[N];
    for (uint32_t run = 0; run < 12; run++) {
        make(run, run % 3, N, x);
        double angle = 0, before = 0;
        for (size_t i = 0; i < N && run % 4 == 3; i++) {
            angle += x[i] * DT;
            const double rounded = floor(angle / 0.2 + 0.5) * 0.2;
            x[i] = (rounded - before) / DT;
            before = rounded;
        }
        const imk_identification r = identify_values(false, N, x);
        assert_false(is_low(&r));
        CHECK_CLOSE(r.level[0].degrees, 8, 0.01);
        CHECK_RELATIVE(r.level[0].period, 2 * N * DT / 8, 1e-9);
    }
}

/* Zero every 2.5 s: the lowest 64 of 16384 coefficients, of periods above 5 s, are nearly gone. */
static void test_zeroed(void **state)
{
    (void)state;
    double x[N];
    make(20, 3, N, x);
    zero(250, N, x);
    const imk_identification r = identify_values(false, N, x), *one = &r;
    const imk_level_sum low = imk_level_loss(1, &one);
    assert_true(low.degrees >= 8);
    CHECK_BELOW(low.power, 0.5 * low.degrees);
}

/* What one channel does not show, six do. */
static void test_together(void **state)
{
    (void)state;
    enum { COUNT = 6 };
    static imk_identification r[COUNT];
    const imk_identification *all[COUNT];
    double x[N];
    for (uint32_t c = 0; c < COUNT; c++) {
        make(30 + c, 3, N, x);
        zero(2000, N, x);
        r[c] = identify_values(false, N, x);
        all[c] = &r[c];
        assert_false(is_low(&r[c]));
    }
    assert_true(imk_level_loss(COUNT, all).degrees > 0);
}

static void test_one_pass(void **state)
{
    (void)state;
    double *x = malloc(LONG * sizeof *x);
    make(40, 3, LONG, x);
    imk_identification r = identify_values_in_one_pass(LONG, x);
    assert_false(is_low(&r));
    zero(2000, LONG, x);
    r = identify_values_in_one_pass(LONG, x);
    assert_true(is_low(&r));
    free(x);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_sound), cmocka_unit_test(test_zeroed),
                                       cmocka_unit_test(test_together),
                                       cmocka_unit_test(test_one_pass)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
