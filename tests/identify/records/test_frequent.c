/* SPDX-License-Identifier: Apache-2.0 */
/* Values and differences that are more frequent than noise has them, and values that never come. */
enum { SCREENED_SAMPLES = 60000 };
#include "screened_noise.h"

#include <math.h>

static void round_to(double step)
{
    for (size_t i = 0; step > 0 && i < N; i++)
        rate[i] = step * nearbyint(rate[i] / step);
}

static bool is_sound(const imk_screen *found)
{
    return found->filled == 0 && found->held == 0 && found->straight == 0 && found->gap == 0;
}

/* Of every 16 samples one is the mean, or another value. */
static void test_filled(void **state)
{
    (void)state;
    static const double steps[] = {0, 0.05, 0.5}, value[] = {3.01, 3, 3.5};
    for (size_t k = 0; k < 3; k++) {
        make(k, 3, 0, 0.001);
        round_to(steps[k]);
        for (size_t i = 5; i < N; i += 16)
            rate[i] = value[k];
        const imk_screen found = screen();
        CHECK_CLOSE(found.filled, 0.0625, 0.02);
        assert_true(found.filled_value == value[k]);
        assert_true(found.held == 0 && found.straight == 0 && found.gap == 0);
    }
}

/* A value that lies beside the steps. */
static void test_beside(void **state)
{
    (void)state;
    make(7, 3, 0, 0);
    round_to(1);
    for (size_t i = 5; i < N; i += 16)
        rate[i] = 3.2;
    CHECK_CLOSE(screen().filled, 0.0625, 0.001);
}

/* Rates that are increments over times: equal ones differ in the last digits. */
static void test_increments(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 2; seed++) {
        make(40 + seed, 3, 0, 0);
        round_to(0.5);
        for (size_t i = 5; seed == 1 && i < N; i += 16)
            rate[i] = 3;
        for (size_t i = 0; i < N; i++)
            rate[i] *= 1 + 1e-12 * sin((double)i);
        const imk_screen found = screen();
        assert_true(found.gap == 0);
        CHECK_CLOSE(found.filled, seed == 1 ? 0.0625 : 0, 0.02);
    }
}

/* Of every ten samples one repeats the one before, or is the mean of its neighbours. */
static void test_serial(void **state)
{
    (void)state;
    static const double steps[] = {0, 0.1, 0.7};
    for (size_t k = 0; k < 3; k++)
        for (int mean = 0; mean < 2; mean++) {
            make(k, 3, 0, 0.001);
            round_to(steps[k]);
            for (size_t i = 10; i + 1 < N; i += 10)
                rate[i] = mean ? (rate[i - 1] + rate[i + 1]) / 2 : rate[i - 1];
            round_to(steps[k]);
            const imk_screen found = screen();
            /* those that do so by chance are no excess */
            CHECK_CLOSE(mean ? found.straight : found.held, 0.075, 0.03);
            assert_true(mean ? found.straight > found.held : found.held > found.straight);
        }
}

/* A bit of one standard deviation is always 0. */
static void test_gap(void **state)
{
    (void)state;
    make(3, 3.2, 0, 0.001);
    for (size_t i = 0; i < N; i++)
        rate[i] = (double)((int)lrint(rate[i] * 8) & ~8) / 8;
    CHECK_CLOSE(screen().gap, 1.125, 1e-9);
}

/* Rounded noise, also after an output filter, under a tone, and rounded twice. */
static void test_sound(void **state)
{
    (void)state;
    static const double steps[] = {0, 0.1, 0.32, 0.7, 1.2};
    for (size_t k = 0; k < sizeof steps / sizeof *steps; k++)
        for (int kind = 0; kind < 4; kind++) {
            make(20 + k, 0.17, 0, 0.003);
            for (size_t i = 1; i < N; i++)
                rate[i] += kind == 1 ? 0.6 * rate[i - 1] : kind == 2 ? 2 * sin(0.6 * (double)i) : 0;
            round_to(kind == 3 ? steps[k] / 1.6 : 0);
            round_to(steps[k]);
            const imk_screen found = screen();
            assert_true(is_sound(&found));
            assert_true(kind >= 2 || !found.uneven);
        }
}

/* Rounded to steps of 0.35 and then to the nearest of 0.3, which skips every seventh, or first to
 * steps of 0.2, of which two come to every second one. */
static void test_uneven(void **state)
{
    (void)state;
    for (int wide = 0; wide < 2; wide++) {
        make(30, 0.17, 0, 0.003);
        round_to(wide ? 0.35 : 0.2);
        round_to(0.3);
        assert_true(screen().uneven);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_filled), cmocka_unit_test(test_beside),
        cmocka_unit_test(test_serial), cmocka_unit_test(test_increments),
        cmocka_unit_test(test_gap),    cmocka_unit_test(test_sound),
        cmocka_unit_test(test_uneven),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
