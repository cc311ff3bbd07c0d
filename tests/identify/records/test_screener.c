/* SPDX-License-Identifier: Apache-2.0 */
/* Screening of a record that passes by: the same as of a record in memory, however it is handed
 * over; jumps of the level beside holes; clipped noise; noise whose tails are its own. */
#include "check.h"

#include "identify/screen/screener_internal.h"
#include "imukit/noise.h"

#include <string.h>

enum { N = 100000 };

static double rate[N], temperature[N], out_loose[N], out_clean[N];
static char memory[1 << 20];
static size_t passed;

static void take(void *context, size_t count, const double *loose, const double *clean)
{
    (void)context;
    memcpy(out_loose + passed, loose, count * sizeof *loose);
    memcpy(out_clean + passed, clean, count * sizeof *clean);
    passed += count;
}

static imk_screen pass(size_t count, size_t part, const double *warm)
{
    imk_screen_settings settings = imk_screen_default();
    settings.dt = 0.01;
    imk_screener *screener;
    imk_screen found;
    passed = 0;
    assert_true(imk_screener_size() <= sizeof memory);
    CHECK_OK(imk_screener_begin(&settings, IMK_SCREEN_OUTLIERS | IMK_SCREEN_STUCK, take, NULL,
                                &screener, memory, sizeof memory, NULL));
    for (size_t i = 0; i < count; i += part)
        imk_screener_add(screener, count - i < part ? count - i : part, rate + i,
                         warm ? warm + i : NULL);
    CHECK_OK(imk_screener_finish(screener, &found, NULL));
    assert_int_equal(passed, count);
    return found;
}

static void make(uint64_t seed, double white, double flicker, double walk)
{
    static imk_white_state w;
    static imk_flicker_state f;
    static imk_random_walk_state k;
    const imk_random random = imk_random_seeded(seed);
    memset(rate, 0, sizeof rate);
    imk_white_start(&w, white, 1, random, 1);
    imk_white_add(&w, N, rate);
    imk_flicker_start(&f, (imk_flicker){flicker, 0}, 1, random, 2);
    imk_flicker_add(&f, N, rate);
    imk_random_walk_start(&k, walk, 1, random, 3);
    imk_random_walk_add(&k, N, rate);
}

/* A third of the record is missing, in holes of very different lengths, some with a few samples
 * left in them. */
static void make_holes(void)
{
    static const size_t from[] = {3000, 20000, 41000, 77777, 99000};
    static const size_t length[] = {40, 9000, 700, 20000, 300};
    for (size_t h = 0; h < 5; h++)
        for (size_t i = from[h]; i < from[h] + length[h]; i++)
            rate[i] = i % 997 > 3 ? (double)NAN : rate[i];
}

static void put_faults(void)
{
    make(5, 1, 0.2, 0.003);
    for (size_t i = 0; i < N; i++) {
        temperature[i] = 25 + 3 * sin((double)i / 9000);
        rate[i] += 9.8 + 0.5 * (temperature[i] - 25) + (i > 50000 ? 5 : 0);
    }
    for (size_t i = 100; i < N; i += 5000)
        rate[i] += 40;
    for (size_t i = 8190; i < 8196; i++) /* across chunks */
        rate[i] += 60;
    for (size_t i = 16380; i < 17000; i++)
        rate[i] = rate[16380];
    make_holes();
    rate[12345] = (double)INFINITY;
    temperature[777] = (double)NAN;
}

static void check_same(const imk_screen *a, const imk_screen *b)
{
    const imk_screen_count *const counts[][2] = {{&a->missing, &b->missing},
                                                 {&a->outliers, &b->outliers},
                                                 {&a->stuck, &b->stuck},
                                                 {&a->saturated, &b->saturated},
                                                 {&a->steps, &b->steps}};
    for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++) {
        assert_int_equal(counts[i][0]->count, counts[i][1]->count);
        assert_int_equal(counts[i][0]->runs, counts[i][1]->runs);
        assert_int_equal(counts[i][0]->first, counts[i][1]->first);
    }
    assert_true(a->n == b->n && a->present == b->present && a->noise == b->noise);
    assert_true(a->deviation == b->deviation && a->core == b->core);
    assert_true(a->outlier_threshold == b->outlier_threshold);
    assert_true(a->temperature_slope == b->temperature_slope);
    assert_true(a->warm_up_probability == b->warm_up_probability);
    assert_true(a->interpolated == b->interpolated);
    assert_true(a->sensor_rate[0] == b->sensor_rate[0]);
    assert_memory_equal(a->step_place, b->step_place, a->steps.count * sizeof *a->step_place);
    assert_memory_equal(a->step_size, b->step_size, a->steps.count * sizeof *a->step_size);
}

/* However it is handed over, at lengths about a chunk and with faults on its borders. */
static void test_division(void **state)
{
    (void)state;
    static const size_t lengths[] = {70, 8191, 8192, 8193, 16384, 16500, 24576, 90001, N};
    static const size_t parts[] = {1, 777, 8192, 8193, 65537};
    static double clean[N];
    imk_screen_settings settings = imk_screen_default();
    settings.dt = 0.01;
    settings.temperature = temperature;
    put_faults();
    for (size_t l = 0; l < sizeof lengths / sizeof lengths[0]; l++) {
        imk_screen whole, found;
        const size_t n = lengths[l];
        size_t lost;
        CHECK_OK(imk_screen_channel(&settings, n, rate, &whole, memory, sizeof memory, NULL));
        memcpy(clean, rate, sizeof clean);
        const unsigned what = IMK_SCREEN_OUTLIERS | IMK_SCREEN_STUCK;
        CHECK_OK(imk_screen_apply(&settings, &whole, what, n, clean, &lost, memory, sizeof memory,
                                  NULL));
        assert_int_equal(lost, whole.outliers.count + whole.stuck.count);
        for (size_t p = 0; p < sizeof parts / sizeof parts[0]; p++) {
            found = pass(n, parts[p], temperature);
            check_same(&whole, &found);
            for (size_t i = 0; i < n; i++)
                assert_true(out_clean[i] == clean[i] ||
                            (isnan(out_clean[i]) && !isfinite(clean[i])));
        }
    }
    const imk_screen s = pass(N, N, temperature);
    assert_int_equal(s.outliers.count, 14 + 6); /* six of twenty lie in holes */
    assert_int_equal(s.stuck.count, 619);
    assert_int_equal(s.longest_stuck, 620);
    assert_int_equal(s.steps.count, 1);
    CHECK_CLOSE((double)s.steps.first, 50000, N / 1024.0);
    CHECK_CLOSE(s.largest_step, 5, 0.5);
    assert_true(s.temperature_degree > 0 && !s.warm_up);
    CHECK_CLOSE(s.temperature_slope, 0.5, 5 * s.temperature_slope_sigma);
}

/* Holes are no jumps: 40 records of white noise, flicker, walks and all of them, 1e-3 each: 4 or
 * more with probability 9e-8. Beside them a jump of 10 B is found. */
static void test_jumps_and_holes(void **state)
{
    (void)state;
    size_t called = 0, found = 0;
    for (uint64_t run = 0; run < 40; run++) {
        const double white = run % 4 == 2 ? 0 : 1, flicker = run % 4 == 1 ? 0.3 : 0.1;
        make(100 + run, white, run % 2 ? flicker : 0, run % 4 > 1 ? 0.02 : 0);
        make_holes();
        called += pass(N, N, NULL).steps.count > 0;
        if (run % 4 == 1) {
            for (size_t i = 60000; i < N; i++)
                rate[i] += 3;
            found += pass(N, N, NULL).steps.count == 1;
        }
    }
    assert_true(called < 4);
    assert_int_equal(found, 10);
}

static imk_screen clipped(double low, double high, double step)
{
    for (size_t i = 0; i < N; i++) {
        rate[i] = rate[i] < low ? low : rate[i] > high ? high : rate[i];
        rate[i] = step > 0 ? step * floor(rate[i] / step + 0.5) : rate[i];
    }
    return pass(N, N, NULL);
}

/* Clipped normal noise on both sides or one, of fine or coarse values: its deviation is known to 2
 * % (a tenth of what clipping takes, and the scatter of the shares), and to the stated misfit.
 * Sound noise is not clipped: 20 records, a coarse grid on half of them. */
static void test_clipped(void **state)
{
    (void)state;
    static const struct {
        double low, high, step;
    } cases[] = {{-2, 2, 0},        {-3, 3, 0},     {-HUGE_VAL, 2, 0},      {-HUGE_VAL, 1, 0},
                 {-1.5, 2.5, 0.01}, {-2, 2, 0.5},   {-HUGE_VAL, 2.5, 0.25}, {-3, 3, 0.1},
                 {-0.5, 0.5, 0},    {-2, 2, 0.0005}};
    for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++) {
        make(200 + c, 1, 0.02, 0);
        const imk_screen s = clipped(cases[c].low, cases[c].high, cases[c].step);
        assert_true(s.saturated.count > 100);
        assert_true((s.saturation_low > -HUGE_VAL) == (cases[c].low > -HUGE_VAL));
        CHECK_CLOSE(s.deviation * s.clipped_deviation, 1, 0.02);
        CHECK_BELOW(s.clipped_misfit, 0.02);
        assert_int_equal(s.outliers.count, 0);
        assert_int_equal(s.stuck.count, 0);
    }
    for (uint64_t run = 0; run < 20; run++) {
        make(300 + run, 1, run % 3 ? 0 : 0.3, run % 5 ? 0 : 0.05);
        const double steps[] = {0, 0.1, 0.3, 1, 2};
        const imk_screen s = clipped(-HUGE_VAL, HUGE_VAL, run % 2 ? steps[run / 2 % 5] : 0);
        assert_int_equal(s.saturated.count, 0);
        assert_true(s.clipped_deviation == 1);
    }
}

/* A tenth of the samples with four times the noise: its own tails. Outliers of 30 sigma in a
 * thousandth: faults. */
static void test_tails(void **state)
{
    (void)state;
    static double more[N];
    static uint32_t chance[N];
    make(7, 1, 0, 0);
    imk_random_normals(imk_random_seeded(8), 0, 0, N, more);
    imk_random_words(imk_random_seeded(9), 0, 0, N, chance);
    for (size_t i = 0; i < N; i++)
        rate[i] += chance[i] < 0.1 * 0x1p32 ? 4 * more[i] : 0;
    imk_screen s = pass(N, N, NULL);
    assert_true(s.heavy_tails && s.outliers.count > 0);
    CHECK_BELOW(s.core, 0.75);
    /* (kurtosis - 1)/n is the variance of the mean square of n independent samples: 13/1e5. With 97
     * batches the scatter is known to some tenths of it. */
    CHECK_RELATIVE(s.noise_scatter, sqrt(13.0 / N), 0.5);
    make(7, 1, 0, 0);
    for (size_t i = 0; i < N; i++)
        rate[i] += chance[i] < 0.001 * 0x1p32 ? 30 : 0;
    s = pass(N, N, NULL);
    assert_false(s.heavy_tails);
    CHECK_CLOSE(s.core, 0.77,
                0.05); /* 1/sqrt(1 + 0.9/1.3), about: the outliers are in the variance */
    make(7, 1, 0, 0);
    s = pass(N, N, NULL);
    assert_false(s.heavy_tails);
    CHECK_CLOSE(s.core, 1, 0.02); /* a median of 3125, known to 1.3 % over the root of 12 */
}

/* Spikes of about 8 or 10 sigma are a cluster far off, although the threshold divides them. The
 * tails of Laplace's density go on evenly. */
static void test_clustered(void **state)
{
    (void)state;
    static double more[N];
    static uint32_t chance[N];
    imk_random_normals(imk_random_seeded(18), 0, 0, N, more);
    imk_random_words(imk_random_seeded(19), 0, 0, N, chance);
    for (int size = 8; size <= 10; size += 2) {
        make(17, 1, 0, 0);
        for (size_t i = 0; i < N; i++)
            rate[i] += chance[i] < 0.004 * 0x1p32 ? size + more[i] : 0;
        const imk_screen s = pass(N, N, NULL);
        assert_true(s.heavy_tails && s.clustered);
    }
    for (size_t i = 0; i < N; i++)
        rate[i] = (chance[i] & 1 ? 1 : -1) * log((chance[i] + 0.5) * 0x1p-32);
    const imk_screen s = pass(N, N, NULL);
    assert_false(s.clustered);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_division),  cmocka_unit_test(test_jumps_and_holes),
        cmocka_unit_test(test_clipped),   cmocka_unit_test(test_tails),
        cmocka_unit_test(test_clustered),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
