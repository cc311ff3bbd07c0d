/* SPDX-License-Identifier: Apache-2.0 */
/* Screening: what is wrong is found where it is, what is sound is left alone. */
#include "check.h"
#include "imukit/noise.h"
#include "imukit/record_screen.h"

#include <string.h>

enum { N = 20000 };

static double rate[N], before[N], temperature[N];
static char workspace[1 << 20];

static imk_screen_settings settings_of(void)
{
    imk_screen_settings settings = imk_screen_default();
    settings.dt = 0.01;
    return settings;
}

static imk_screen look(const imk_screen_settings *settings)
{
    imk_screen found;
    assert_true(imk_screen_workspace_size(N) <= sizeof workspace);
    memcpy(before, rate, sizeof rate);
    assert_int_equal(
        imk_screen_channel(settings, N, rate, &found, workspace, sizeof workspace, NULL), IMK_OK);
    assert_memory_equal(before, rate, sizeof rate);
    return found;
}

static size_t apply(const imk_screen_settings *settings, const imk_screen *found, unsigned what)
{
    size_t lost = SIZE_MAX;
    CHECK_OK(
        imk_screen_apply(settings, found, what, N, rate, &lost, workspace, sizeof workspace, NULL));
    return lost;
}

static void make(uint32_t run, double white, double flicker, double walk)
{
    static imk_white_state w;
    static imk_flicker_state f;
    static imk_random_walk_state k;
    const imk_random random = imk_random_seeded(11);
    memset(rate, 0, sizeof rate);
    imk_white_start(&w, white, 1, random, imk_stream(run, 1, 0, 0));
    imk_white_add(&w, N, rate);
    imk_flicker_start(&f, (imk_flicker){flicker, 0}, 1, random, imk_stream(run, 2, 0, 0));
    imk_flicker_add(&f, N, rate);
    imk_random_walk_start(&k, walk, 1, random, imk_stream(run, 3, 0, 0));
    imk_random_walk_add(&k, N, rate);
}

/* Sound records: white, coarse steps, a line, a walk, a step of the level. Chance makes an outlier
 * in 1e-3 of them, the same for steps and trends: of 60 records 5 or more with probability 6e-9. */
static void test_sound_records(void **state)
{
    (void)state;
    size_t outliers = 0, steps = 0, warm = 0;
    const imk_screen_settings settings = settings_of();
    for (uint32_t run = 0; run < (check_quick() ? 12 : 60); run++) {
        make(run, run % 6 == 3 ? 0.01 : 1, run % 6 == 5 ? 1 : 0, run % 6 == 3 ? 1 : 0);
        for (size_t i = 0; i < N; i++) {
            if (run % 6 == 1)
                rate[i] = 3 * floor(rate[i] / 3 + 0.5);
            if (run % 6 == 2)
                rate[i] += 40 * sin(0.7 * (double)i);
            if (run % 6 == 4 && i > N / 3)
                rate[i] += 30;
        }
        const imk_screen s = look(&settings);
        outliers += s.outliers.count > 0;
        assert_int_equal(s.stuck.count, 0);
        assert_int_equal(s.saturated.count, 0);
        assert_int_equal(s.missing.count, 0);
        if (run % 6 != 4) {
            steps += s.steps.count > 0;
            warm += s.warm_up;
        } else {
            /* The step is found within half a block of N/1250 samples of where it is. */
            assert_int_equal(s.steps.count, 1);
            CHECK_CLOSE((double)s.steps.first, N / 3.0, 17);
            CHECK_CLOSE(s.largest_step, 30, 5);
        }
        CHECK_CLOSE(s.resolution, run % 6 == 1 ? 3 : 0, 1e-9);
    }
    assert_true(outliers < 5);
    assert_true(steps < 5);
    assert_true(warm < 5);
}

/* Single ones of either sign and a burst of ten, on noise that wanders and is rounded. */
static void test_outliers(void **state)
{
    (void)state;
    static const size_t place[] = {0, 500, 501, 7000, 12345, N - 1};
    const imk_screen_settings settings = settings_of();
    make(1, 1, 0.3, 0.03);
    for (size_t i = 0; i < N; i++)
        rate[i] = 0.25 * floor(rate[i] * 4 + 0.5);
    for (size_t i = 0; i < 6; i++)
        rate[place[i]] += i % 2 ? 50 : -50;
    for (size_t i = 15000; i < 15010; i++)
        rate[i] += 50;
    rate[3000] = NAN;
    const imk_screen s = look(&settings);
    assert_int_equal(s.outliers.count, 16);
    assert_int_equal(s.outliers.runs, 6);
    assert_int_equal(s.outliers.first, 0);
    assert_int_equal(s.missing.count, 1);
    assert_true(s.largest_outlier > 45 && s.largest_outlier < 56);
    assert_int_equal(apply(&settings, &s, IMK_SCREEN_ALL), 16);
    for (size_t i = 0; i < N; i++) {
        bool out = i == 3000 || (i >= 15000 && i < 15010);
        for (size_t k = 0; k < 6; k++)
            out = out || i == place[k];
        assert_int_equal(out, isnan(rate[i]));
        assert_true(out || rate[i] == before[i]);
    }
}

/* Three values in turn, -half, 0 and half, around sample `middle`: 1.4826 half of spread. */
static void put_stretch(size_t middle, double half)
{
    for (size_t i = middle - 30; i <= middle + 30; i++)
        rate[i] = (double)(i % 3) * half - half;
}

/* Far from what is around it is beyond nine times its spread, and beyond the scatter of its chunk:
 * 7.13 sigma by a false alarm of 1e-3 in 1e9 normals, and 0.6/16 more; the scatter of a chunk is
 * found to 1.3 %, of which the cases leave four. */
static void test_what_is_far(void **state)
{
    (void)state;
    static const struct {
        double half, value;
        size_t outliers;
    } cases[] = {{5.0, 60.0, 0}, {5.0, 73.0, 1}, {0.3, 6.7, 0}, {0.3, 7.9, 1}, {0.3, -7.9, 1}};
    const imk_screen_settings settings = settings_of();
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        make(7, 1, 0, 0);
        put_stretch(9000, cases[i].half);
        rate[9000] = cases[i].value;
        const imk_screen s = look(&settings);
        assert_int_equal(s.outliers.count, cases[i].outliers);
    }
}

/* An outlier whose square overflows is one like any other, and no reason to call the record
 * constant; nor are readings whose squares vanish. */
static void test_extreme_sizes(void **state)
{
    (void)state;
    const imk_screen_settings settings = settings_of();
    make(5, 1, 0, 0);
    rate[700] = 1e160;
    imk_screen s = look(&settings);
    CHECK_RELATIVE(s.deviation, 1e160 / sqrt(N), 1e-4);
    assert_int_equal(s.outliers.count, 1);
    assert_int_equal(s.outliers.first, 700);
    assert_true(s.resolution == 0);
    make(5, 1e-4, 0, 0);
    rate[1] = 4294967295.0; /* 2^32 - 1 where a driver had nothing to say: no step of the output */
    s = look(&settings);
    assert_true(s.resolution == 0);
    assert_int_equal(s.outliers.count, 1);
    assert_int_equal(s.outliers.first, 1);
    make(5, 1, 0, 0);
    const double deviation = look(&settings).deviation;
    for (size_t i = 0; i < N; i++)
        rate[i] = ldexp(rate[i], -700);
    CHECK_RELATIVE(look(&settings).deviation, ldexp(deviation, -700), 1e-14);
    for (size_t i = 0; i < N; i++)
        rate[i] = i == 700 ? 1 : 1e-300;
    assert_true(look(&settings).deviation > 0);
}

static void test_stuck_saturated_missing(void **state)
{
    (void)state;
    const imk_screen_settings settings = settings_of();
    make(2, 1, 0, 0);
    for (size_t i = 1000; i < 1100; i++)
        rate[i] = rate[1000];
    for (size_t i = 0; i < N; i++)
        rate[i] = rate[i] > 2 ? 2 : rate[i];
    for (size_t i = 5000; i < 5003; i++)
        rate[i] = 2;
    for (size_t i = 9000; i < 9500; i++)
        rate[i] = i % 2 ? (double)INFINITY : (double)NAN;
    rate[12000] = NAN;
    size_t high = 0;
    for (size_t i = 0; i < N; i++)
        high += rate[i] == 2;
    const imk_screen s = look(&settings);
    assert_int_equal(s.missing.count, 501);
    assert_int_equal(s.missing.runs, 2);
    assert_int_equal(s.missing.first, 9000);
    assert_int_equal(s.longest_hole, 500);
    assert_int_equal(s.stuck.count, 99);
    assert_int_equal(s.stuck.first, 1001);
    assert_int_equal(s.longest_stuck, 100);
    assert_true(s.saturation_high == 2 && s.saturation_low == -HUGE_VAL);
    assert_int_equal(s.saturated.count, high);
    assert_int_equal(apply(&settings, &s, IMK_SCREEN_STUCK), 99);
    assert_true(isfinite(rate[1000]) && isnan(rate[1001]) && isnan(rate[1099]));
    assert_int_equal(apply(&settings, &s, IMK_SCREEN_SATURATED), high);
}

/* A repeated sample in groups of four is no stuck sensor, but told. */
static void test_repeated(void **state)
{
    (void)state;
    const imk_screen_settings settings = settings_of();
    make(3, 1, 0, 0);
    for (size_t i = 0; i < N; i++)
        rate[i] = rate[i / 4 * 4];
    const imk_screen s = look(&settings);
    assert_int_equal(s.stuck.count, 0);
    CHECK_CLOSE(s.repeated, 0.75, 1e-3);
}

/* Slow noise is no warm-up: 60 records of walk and flicker, 5 found by chance with probability
 * 6e-9. A true one is found, with its amplitude and time within 5 stated sigma (6e-7 each), and
 * what is left when it is subtracted has none. */
static void test_warm_up(void **state)
{
    (void)state;
    const imk_screen_settings settings = settings_of();
    size_t called = 0;
    for (uint32_t run = 0; run < (check_quick() ? 12 : 60); run++) {
        make(100 + run, 1, run % 2 ? 0.2 : 0, run % 3 ? 0.02 : 0.3);
        called += look(&settings).warm_up;
    }
    assert_true(called < 5);
    for (uint32_t run = 0; run < 5; run++) {
        make(200 + run, 1, 0.1, 0.0005);
        for (size_t i = 0; i < N; i++)
            rate[i] += 9.8 + 5 * exp(-(double)i / 1500);
        const imk_screen s = look(&settings);
        assert_true(s.warm_up && s.degrees_taken == 2);
        CHECK_CLOSE(s.warm_up_amplitude, 5, 5 * s.warm_up_amplitude_sigma);
        CHECK_CLOSE(s.warm_up_time, 15, 5 * s.warm_up_time_sigma);
        CHECK_BELOW(s.warm_up_amplitude_sigma, 1);
        CHECK_BELOW(s.warm_up_time_sigma, 3);
        apply(&settings, &s, IMK_SCREEN_WARM_UP);
        assert_false(look(&settings).warm_up);
        const double expected = s.warm_up_amplitude * exp(-1000 / (s.warm_up_time * 100));
        CHECK_CLOSE(before[1000], rate[1000], 0);
        make(200 + run, 1, 0.1, 0.0005);
        CHECK_CLOSE(before[1000], rate[1000] + 9.8 + 5 * exp(-1000.0 / 1500) - expected, 1e-9);
    }
}

/* The slope within 5 stated sigma; nothing where there is none. */
static void test_temperature(void **state)
{
    (void)state;
    imk_screen_settings settings = settings_of();
    settings.temperature = temperature;
    size_t called = 0;
    for (size_t i = 0; i < N; i++)
        temperature[i] = 25 + 3 * sin((double)i / 2000) + 5 * (double)i / N;
    for (uint32_t run = 0; run < (check_quick() ? 8 : 40); run++) {
        make(300 + run, 1, run % 2 ? 0.5 : 0.1, run % 4 == 3 ? 0.05 : 0);
        called += look(&settings).temperature_degree > 0;
    }
    /* 1e-3 for each of two degrees: 5 of 40 with probability 2e-8. */
    assert_true(called < 5);
    make(350, 1, 0.1, 0);
    for (size_t i = 0; i < N; i++)
        rate[i] += 2 * (temperature[i] - 25);
    temperature[77] = NAN;
    const imk_screen s = look(&settings);
    assert_true(s.temperature_degree >= 1);
    CHECK_CLOSE(s.temperature_slope, 2, 5 * s.temperature_slope_sigma);
    CHECK_BELOW(s.temperature_slope_sigma, 0.2);
    assert_int_equal(apply(&settings, &s, IMK_SCREEN_TEMPERATURE), 1);
    assert_true(isnan(rate[77]));
    assert_int_equal(look(&settings).temperature_degree, 0);
}

static void test_refusals(void **state)
{
    (void)state;
    imk_screen_settings settings = settings_of();
    imk_screen s;
    make(1, 1, 0, 0);
    assert_int_equal(imk_screen_channel(&settings, N, rate, &s, workspace, 10, NULL),
                     IMK_ERROR_WORKSPACE);
    settings.dt = 0;
    assert_int_equal(imk_screen_channel(&settings, N, rate, &s, workspace, sizeof workspace, NULL),
                     IMK_ERROR_RANGE);
    settings.cookie = 1;
    assert_int_equal(imk_screen_channel(&settings, N, rate, &s, workspace, sizeof workspace, NULL),
                     IMK_ERROR_UNINITIALISED);
    settings = settings_of();
    for (size_t i = 63; i < N; i++)
        rate[i] = NAN;
    assert_int_equal(imk_screen_channel(&settings, N, rate, &s, workspace, sizeof workspace, NULL),
                     IMK_ERROR_TOO_SHORT);
    for (size_t i = 0; i < N; i++)
        rate[i] = 3;
    assert_int_equal(imk_screen_channel(&settings, N, rate, &s, workspace, sizeof workspace, NULL),
                     IMK_ERROR_CONSTANT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sound_records),
        cmocka_unit_test(test_outliers),
        cmocka_unit_test(test_what_is_far),
        cmocka_unit_test(test_extreme_sizes),
        cmocka_unit_test(test_stuck_saturated_missing),
        cmocka_unit_test(test_repeated),
        cmocka_unit_test(test_warm_up),
        cmocka_unit_test(test_temperature),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
