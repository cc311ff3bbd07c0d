/* SPDX-License-Identifier: Apache-2.0 */
/* A log that is interpolated from a slower sensor is found, with the rate of the sensor; sound logs
 * are not, whatever their spectrum is. */
#include "check.h"

#include "identify/screen/screener_internal.h"
#include "imukit/noise.h"
#include "imukit/random.h"

#include <math.h>
#include <string.h>

enum { N = 60000 };

static double sensor[N], rate[N];
static char workspace[1 << 20];

static imk_screen look(size_t count)
{
    imk_screen_settings settings = imk_screen_default();
    imk_screen found;
    settings.dt = 0.01;
    assert_true(imk_screen_workspace_size(count) <= sizeof workspace);
    CHECK_OK(imk_screen_channel(&settings, count, rate, &found, workspace, sizeof workspace, NULL));
    return found;
}

static void make(uint32_t run, double *out, size_t count, double flicker, double walk)
{
    static imk_white_state w;
    static imk_flicker_state f;
    static imk_random_walk_state k;
    const imk_random random = imk_random_seeded(2);
    memset(out, 0, count * sizeof *out);
    imk_white_start(&w, 1, 1, random, imk_stream(run, 1, 0, 0));
    imk_white_add(&w, count, out);
    imk_flicker_start(&f, (imk_flicker){flicker, 0}, 1, random, imk_stream(run, 2, 0, 0));
    imk_flicker_add(&f, count, out);
    imk_random_walk_start(&k, walk, 1, random, imk_stream(run, 3, 0, 0));
    imk_random_walk_add(&k, count, out);
}

/* On straight lines between the samples of a sensor of `ratio` times the rate, rounded to steps. */
static void interpolate(double ratio, double step, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const double at = (double)i * ratio, below = floor(at + 1e-9);
        const size_t k = (size_t)below;
        const double value = sensor[k] + (at - below) * (sensor[k + 1] - sensor[k]);
        rate[i] = step > 0 ? step * floor(value / step + 0.5) : value;
    }
}

/* From 5 % faster than the sensor up to seven times; fine values tell which of two rates it is. */
static void test_found(void **state)
{
    (void)state;
    static const double faster[] = {1.05, 1.1, 4.0 / 3, 1.5, 1.7, 1.93, 2, 2.2, 2.5, 3, 3.3, 4, 7};
    make(1, sensor, N, 0.2, 0.003);
    for (size_t i = 0; i < sizeof faster / sizeof faster[0]; i++) {
        interpolate(1 / faster[i], 1e-6, N - 2);
        const imk_screen s = look(N - 2);
        assert_true(s.interpolated);
        CHECK_RELATIVE(s.sensor_rate[0], 1 / faster[i], 2e-3); /* a third of a segment's bin */
        assert_true(s.sensor_rate[1] == 0);
    }
}

/* Steps of a standard deviation leave it open which rate it is; 1 % of the samples may be missing;
 * three chunks are enough. */
static void test_coarse_short_missing(void **state)
{
    (void)state;
    make(2, sensor, N, 0.2, 0.003);
    for (size_t k = 0; k < 4; k++) {
        static const double faster[] = {1.1, 1.5, 2, 3};
        const double ratio = 1 / faster[k];
        interpolate(ratio, 1, N - 2);
        imk_screen s = look(N - 2);
        assert_true(s.interpolated);
        assert_true(fabs(s.sensor_rate[0] - ratio) < 2e-3 || fabs(s.sensor_rate[1] - ratio) < 2e-3);
        interpolate(ratio, 1e-6, N - 2);
        for (size_t i = 0; i < N; i += 97 + i % 13)
            rate[i] = (double)NAN;
        assert_true(look(N - 2).interpolated);
        interpolate(ratio, 1e-6, N - 2);
        s = look(3 * IMKI_SCREEN_CHUNK);
        assert_true(s.interpolated);
        CHECK_RELATIVE(s.sensor_rate[0], ratio, 3e-3);
    }
}

/* Two sensors in turn, the one with twice the noise of the other, are no interpolated log; it is
 * the same if the values are those of two channels of a converter with 20 % more noise in one. */
static void test_alternating(void **state)
{
    (void)state;
    static const double stronger[] = {2, 1.2};
    for (size_t k = 0; k < 2; k++) {
        make(3, rate, N, 0.2, 0.003);
        for (size_t i = 0; i < N; i += 2)
            rate[i] *= stronger[k];
        const imk_screen s = look(N);
        assert_true(s.interpolated && s.sensor_rate[0] == 0);
    }
}

/* Kind 0 … 9 of sound records. */
static void make_sound(uint32_t kind, uint32_t run, size_t count)
{
    const double pi = 3.14159265358979324, d = kind == 1 ? 0.3 : 0, k = kind == 2 ? 0.1 : 0;
    double last = 0, before = 0;
    make(100 + run, rate, count, d, k);
    for (size_t i = 0; i < count; i++) {
        const double t = (double)i, x = rate[i];
        if (kind == 3) /* rounding */
            rate[i] = floor(x + 0.5);
        if (kind == 4) /* a fan with four harmonics, the first of six standard deviations */
            for (int n = 1; n <= 5; n++)
                rate[i] += 6 * sin(2 * pi * 0.1703 * n * t + n) / n;
        if (kind == 5) /* a resonance */
            rate[i] = x + 1.55 * last - 0.9025 * before;
        if (kind == 6) /* a low-pass filter */
            rate[i] = 0.2 * x + 1.5 * last - 0.6 * before;
        if (kind == 7) /* white noise of the angle */
            rate[i] = x - sensor[i];
        if (kind == 8) /* outliers */
            rate[i] += i % 1013 == 0 ? 100 : 0;
        if (kind == 9) /* noise that comes in bursts */
            rate[i] *= i % 5000 < 700 ? 4 : 1;
        sensor[i] = x;
        before = last;
        last = rate[i];
        if (kind == 7)
            sensor[i + 1] = x;
    }
}

/* The false alarm is 1e-4 a record; one of 100 would have a chance of 1 %, two of 5e-5, three of
 * 1.6e-7. */
static void test_sound(void **state)
{
    (void)state;
    const uint32_t runs = check_runs(10);
    int alarms = 0;
    for (uint32_t kind = 0; kind < 10; kind++)
        for (uint32_t run = 0; run < runs; run++) {
            make_sound(kind, 10 * run + kind, 20000);
            alarms += look(20000).interpolated;
        }
    assert_true(alarms <= 2);
}

/* The distribution where it matters most, in records of four segments: a threshold for one in
 * twenty is exceeded by no more. Of 600, 30 are due; more than 60 have a chance of 3e-7. */
static void test_false_alarm(void **state)
{
    (void)state;
    enum { ROWS = 4 * (IMKI_CYCLE_SEGMENT + 2), ROOM = 6 * IMKI_CYCLE_SEGMENT };
    static double room[ROOM];
    static imki_cycles cycles;
    const uint32_t runs = check_runs(600);
    uint32_t alarms = 0;
    double ratio[2];
    for (uint32_t run = 0; run < runs; run++) {
        memset(&cycles, 0, sizeof cycles);
        make(1000 + run, rate, ROWS, 0.2, 0);
        imki_cycles_begin(&cycles);
        imki_cycles_add(&cycles, 0, ROWS, rate, 0, room);
        CHECK_CLOSE(cycles.segments, 4, 0);
        alarms += imki_cycles_find(&cycles, 0.05, ratio);
    }
    assert_true(alarms <= runs / 10);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_found),       cmocka_unit_test(test_coarse_short_missing),
        cmocka_unit_test(test_alternating), cmocka_unit_test(test_sound),
        cmocka_unit_test(test_false_alarm),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
