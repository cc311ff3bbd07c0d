/* SPDX-License-Identifier: Apache-2.0 */
/* Changes of the noise are found where they are, and sound noise is left alone. */
#include "check.h"
#include "imukit/noise.h"
#include "imukit/noise_map.h"

#include <string.h>

enum { N = 65536 };

static const double DT = 0.01;
static double samples[N], white[N];
static imk_noise_map map;
static imk_noise_changes changes;

/* What an identification of the record would be. */
static imk_identification model_of(double n, double b, double k)
{
    static imk_identification r;
    const double value[IMK_NOISE_TERMS] = {0, n, b, k, 0};
    memset(&r, 0, sizeof r);
    for (int term = 0; term < IMK_NOISE_TERMS; term++) {
        imk_estimate *e = &r.term[term];
        *e = (imk_estimate){value[term] > 0,     value[term],         0.003 * value[term],
                            0.994 * value[term], 1.006 * value[term], value[term]};
    }
    return r;
}

/* White noise of strength 1 in `white`, slow noise in `samples`. */
static void make(uint32_t run, double b, double k)
{
    static imk_flicker_state f;
    static imk_random_walk_state w;
    const imk_random random = imk_random_seeded(17);
    memset(samples, 0, sizeof samples);
    imk_random_normals(random, imk_stream(run, 1, 0, 0), 0, N, white);
    for (size_t i = 0; i < N; i++)
        white[i] *= 10; /* 1/sqrt(dt) */
    imk_flicker_start(&f, (imk_flicker){b, 0}, DT, random, imk_stream(run, 2, 0, 0));
    imk_flicker_add(&f, N, samples);
    imk_random_walk_start(&w, k, DT, random, imk_stream(run, 3, 0, 0));
    imk_random_walk_add(&w, N, samples);
}

static void find(const imk_identification *model)
{
    imk_noise_changes_settings settings = imk_noise_changes_default();
    settings.dt = DT;
    imk_noise_map_begin(&map);
    for (size_t i = 0; i < N; i++)
        samples[i] += white[i];
    imk_noise_map_add(&map, N, samples);
    imk_noise_map_end(&map);
    CHECK_STATUS(imk_noise_changes_find(&settings, &map, model, &changes, NULL), IMK_OK);
}

static void scale(size_t first, size_t end, double factor)
{
    for (size_t i = first; i < end; i++)
        white[i] *= factor;
}

/* Changes, bursts and tails each appear in at most 1e-3 of sound records: of 60 records 6 or more
 * have one with probability 1e-6 if all three do. Three kinds of noise, from white to random walk.
 */
static void test_sound(void **state)
{
    (void)state;
    static const double slow[3][2] = {{0, 0}, {3, 0}, {3, 2}};
    size_t alarms = 0;
    for (uint32_t run = 0; run < 60; run++) {
        const double *s = slow[run % 3];
        const imk_identification model = model_of(1, s[0], s[1]);
        make(run, s[0], s[1]);
        find(&model);
        alarms += changes.changed != 0 || changes.bursts || changes.heavy_tails;
        assert_false(changes.light_tails);
        assert_int_equal(changes.changed != 0, changes.segment_count > 1);
    }
    assert_in_range(alarms, 0, 5);
}

static void test_doubled(void **state)
{
    (void)state;
    const imk_identification model = model_of(sqrt(2.5), 0.3, 0);
    make(100, 0.3, 0);
    scale(N / 2, N, 2);
    find(&model);
    assert_true(changes.matters);
    assert_int_equal(changes.term, IMK_NOISE_WHITE);
    assert_int_equal(changes.segment_count, 2);
    /* A column has 512 samples. */
    CHECK_CLOSE((double)changes.segment[0].end, N / 2, 1024);
    assert_int_equal(changes.segment[0].end, changes.segment[1].first);
    assert_int_equal(changes.segment[1].end, N);
    assert_true((changes.changed & 15) == 15); /* all short averaging times */
    for (size_t k = 0; k < 2; k++) {
        const imk_estimate *e = &changes.segment[k].white;
        /* Known to 0.5 %, and 1 % from the column with the change: five times that. */
        CHECK_RELATIVE(e->value, (double)(k + 1), 0.03);
        assert_true(e->lower < e->value && e->value < e->upper);
        CHECK_RELATIVE(e->upper - e->lower, 4 * e->sigma, 0.05); /* 2 * 1.96 */
    }
    assert_true(changes.probability < 1e-6);
}

static void test_tenth(void **state)
{
    (void)state;
    const imk_identification model = model_of(1.02, 0.3, 0);
    make(101, 0.3, 0);
    scale(6 * N / 10, 7 * N / 10, 1.2);
    find(&model);
    assert_true(changes.matters);
    assert_int_equal(changes.segment_count, 3);
    CHECK_CLOSE((double)changes.segment[1].first, 6 * N / 10, 1600);
    CHECK_CLOSE((double)changes.segment[1].end, 7 * N / 10, 1600);
    CHECK_CLOSE(changes.ratio, 1.2 / 1.02, 0.06);
}

static void test_growth(void **state)
{
    (void)state;
    const imk_identification model = model_of(1.15, 0.3, 0);
    make(102, 0.3, 0);
    for (size_t i = 0; i < N; i++)
        white[i] *= 1 + 0.3 * (double)i / N;
    find(&model);
    assert_true(changes.matters && changes.segment_count > 1);
    for (size_t k = 1; k < changes.segment_count; k++)
        assert_true(changes.segment[k].white.value > changes.segment[k - 1].white.value);
}

static void test_flicker(void **state)
{
    (void)state;
    const imk_identification model = model_of(0.1, 3, 0);
    make(103, 2, 0);
    scale(0, N, 0.1);
    const double level = samples[N / 2];
    for (size_t i = N / 2; i < N; i++)
        samples[i] = level + 2 * (samples[i] - level);
    find(&model);
    assert_true(changes.matters);
    assert_int_equal(changes.term, IMK_NOISE_BIAS_INSTABILITY);
    const imk_noise_segment *last = &changes.segment[changes.segment_count - 1];
    CHECK_RELATIVE(last->bias_instability.value / changes.segment[0].bias_instability.value, 2,
                   0.1);
}

/* Flicker noise below white noise up to some 10 s, 2.4 times as strong in the second half: no
 * octave alone shows it in records of 11 minutes, but all slow ones together do in most. */
static void test_weak_flicker(void **state)
{
    (void)state;
    enum { RUNS = 12 };
    const imk_identification model = model_of(1, 0.8, 0);
    size_t found = 0;
    for (uint32_t run = 0; run < RUNS; run++) {
        make(200 + run, 0.5, 0);
        const double level = samples[N / 2];
        for (size_t i = N / 2; i < N; i++)
            samples[i] = level + 2.4 * (samples[i] - level);
        find(&model);
        found += changes.matters && changes.term != IMK_NOISE_WHITE;
    }
    print_message("%zu of %d\n", found, RUNS);
    assert_in_range(found, 8, RUNS);
}

/* A tone for a part changes a band, not N. */
static void test_band(void **state)
{
    (void)state;
    const imk_identification model = model_of(1, 0.3, 0);
    make(104, 0.3, 0);
    for (size_t i = N / 2; i < 3 * N / 4; i++)
        white[i] += 20 * sin(0.7 * (double)i);
    find(&model);
    assert_true(changes.matters);
    assert_int_equal(changes.term, IMK_NOISE_TERMS);
    CHECK_CLOSE((double)changes.segment[1].first, N / 2, 1024);
}

/* A tone that the model has, and whose differences come back to the same phase, is no change. */
static void test_tone(void **state)
{
    (void)state;
    imk_identification model = model_of(1, 0.3, 0);
    model.sinusoid_count = 1;
    model.sinusoid[0] = (imk_sinusoid){10, 12.5005};
    for (uint32_t run = 0; run < 10; run++) {
        make(110 + run, 0.3, 0);
        for (size_t i = 0; i < N; i++)
            white[i] += 10 * sin(2 * 3.14159265358979 * 12.5005 * DT * (double)i + run);
        find(&model);
        assert_int_equal(changes.changed, 0);
        assert_false(changes.bursts);
    }
    assert_false(changes.tested & 1 << 2); /* differences of 4 + 4 samples: one turn */
    assert_true(changes.tested & 1);
}

static void test_bursts(void **state)
{
    (void)state;
    const imk_identification model = model_of(1, 0.3, 0);
    make(105, 0.3, 0);
    for (size_t i = 0; i < N; i++)
        white[i] *= i / 200 * 2654435761u % 4294967296u < 430000000u ? 2 : 1;
    find(&model);
    assert_true(changes.bursts);
    assert_true(changes.scatter > 1.5);
}

/* Bursts that come several times in each column of the map, which all have the same strength; heavy
 * tails of independent samples are none. */
static void test_short_bursts(void **state)
{
    (void)state;
    const imk_identification model = model_of(1.15, 0.3, 0);
    for (uint32_t run = 0; run < 8; run++) {
        const bool bursts = run % 2;
        make(300 + run, 0.3, 0);
        for (size_t i = 0; i < N; i++) {
            const size_t turn = bursts ? i / 60 : i;
            white[i] *= turn * 2654435761u % 4294967296u < 430000000u ? 2 : 1;
        }
        find(&model);
        assert_int_equal(changes.changed, 0);
        assert_true(changes.heavy_tails);
        assert_int_equal(changes.bursts, bursts);
    }
}

/* A tenth of the samples at twice the strength: excess kurtosis 3 (0.9 + 1.6)/(0.9 + 0.4)^2 - 3.
 * The estimate, of N/2 differences of two samples, has a standard deviation of 2 sqrt(24/(N/2)) =
 * 0.054 in Gaussian noise, here twice that. */
static void test_tails(void **state)
{
    (void)state;
    imk_identification model = model_of(1, 0.3, 0);
    static uint32_t word[N];
    make(106, 0.3, 0);
    imk_random_words(imk_random_seeded(18), 1, 0, N, word);
    for (size_t i = 0; i < N; i++)
        white[i] *= (word[i] < 429496730u ? 2 : 1) / sqrt(1.3);
    find(&model);
    assert_true(changes.gaussian_tested && changes.heavy_tails);
    assert_false(changes.bursts);
    assert_int_equal(changes.changed, 0);
    CHECK_CLOSE(changes.kurtosis, 3 * 2.5 / 1.69 - 3, 0.5);
    CHECK_RELATIVE(changes.kurtosis_sigma, 2 * sqrt(24.0 / (N / 2)), 0.02); /* 2/share^2 */
    const imk_estimate before = model.term[IMK_NOISE_WHITE];
    imk_noise_changes_widen(&changes, N, &model);
    const imk_estimate *after = &model.term[IMK_NOISE_WHITE];
    CHECK_RELATIVE(after->sigma, sqrt(before.sigma * before.sigma + changes.kurtosis / (4.0 * N)),
                   1e-12);
    CHECK_RELATIVE((after->upper - after->lower) / (before.upper - before.lower),
                   after->sigma / before.sigma, 1e-9);
}

/* Where a stage saturates softly, y = 3 tanh(x/3), tails are light: by quadrature over x, excess
 * kurtosis -0.54. Rounding to steps of a standard deviation has -0.6 (1/13)^2 * 2 = -0.007. */
static void test_light_tails(void **state)
{
    (void)state;
    imk_identification model = model_of(1, 0.3, 0);
    make(107, 0.3, 0);
    for (size_t i = 0; i < N; i++)
        white[i] = 30 * tanh(white[i] / 30);
    find(&model);
    assert_true(changes.gaussian_tested && changes.light_tails && !changes.heavy_tails);
    CHECK_CLOSE(changes.kurtosis, -0.54, 0.15);
    make(108, 0.3, 0);
    for (size_t i = 0; i < N; i++)
        white[i] = 10 * floor(white[i] / 10 + 0.5);
    model.resolution = 10;
    find(&model);
    assert_true(changes.gaussian_tested && !changes.light_tails);
}

static void test_refusals(void **state)
{
    (void)state;
    const imk_identification model = model_of(1, 0, 0);
    imk_noise_changes_settings settings = {0};
    imk_noise_map_begin(&map);
    CHECK_STATUS(imk_noise_changes_find(&settings, &map, &model, &changes, NULL),
                 IMK_ERROR_UNINITIALISED);
    settings = imk_noise_changes_default();
    CHECK_STATUS(imk_noise_changes_find(&settings, &map, &model, &changes, NULL), IMK_ERROR_RANGE);
    settings.dt = DT;
    settings.significance = (double)NAN;
    CHECK_STATUS(imk_noise_changes_find(&settings, &map, &model, &changes, NULL), IMK_ERROR_RANGE);
    /* Nothing in it: nothing to find. */
    settings.significance = 1e-3;
    CHECK_STATUS(imk_noise_changes_find(&settings, &map, &model, &changes, NULL), IMK_OK);
    assert_int_equal(changes.changed, 0);
    assert_int_equal(changes.segment_count, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sound),   cmocka_unit_test(test_doubled),
        cmocka_unit_test(test_tenth),   cmocka_unit_test(test_growth),
        cmocka_unit_test(test_flicker), cmocka_unit_test(test_weak_flicker),
        cmocka_unit_test(test_band),    cmocka_unit_test(test_tone),
        cmocka_unit_test(test_bursts),  cmocka_unit_test(test_short_bursts),
        cmocka_unit_test(test_tails),   cmocka_unit_test(test_light_tails),
        cmocka_unit_test(test_refusals)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
