/* SPDX-License-Identifier: Apache-2.0 */
/* A long record in one pass: the same answer as from the whole record, however it is handed over;
 * what is missing, wrong or too short is said. Records here are short, with segments of 16384
 * samples, so that the whole-record transform is at hand to compare with. */
#include "check.h"

#include "identify/records/long_record_internal.h"

#include <stdlib.h>
#include <string.h>

enum { N = 1 << 19, SEGMENT = 1 << 14, CAPACITY = 1 << 14 };
static const double dt = 0.01;

typedef struct truth {
    double white, bias_instability, random_walk, quantization;
    imk_sinusoid sinusoid;
    imk_resonance resonance;
    imk_low_pass filter;
} truth;

static const truth usual = {.white = 1, .bias_instability = 0.4, .random_walk = 0.03};

/* About 9.8, as an accelerometer reads. */
static double *make_record(const truth *t, size_t n, uint64_t seed)
{
    double *x = calloc(n, sizeof *x);
    const imk_random random = imk_random_seeded(seed);
    if (t->filter.bandwidth > 0) {
        imk_arma_state state;
        CHECK_OK(imk_filtered_white_start(&state, t->white, t->filter, dt, random, 1));
        imk_arma_add(&state, n, x);
    } else {
        imk_white_state state;
        CHECK_OK(imk_white_start(&state, t->white, dt, random, 1));
        imk_white_add(&state, n, x);
    }
    if (t->bias_instability > 0) {
        imk_flicker_state state;
        CHECK_OK(imk_flicker_start(&state, (imk_flicker){t->bias_instability, 0}, dt, random, 2));
        imk_flicker_add(&state, n, x);
    }
    if (t->random_walk > 0) {
        imk_random_walk_state state;
        CHECK_OK(imk_random_walk_start(&state, t->random_walk, dt, random, 3));
        imk_random_walk_add(&state, n, x);
    }
    if (t->resonance.sigma > 0) {
        imk_arma_state state;
        CHECK_OK(imk_resonance_start(&state, t->resonance, dt, random, 4));
        imk_arma_add(&state, n, x);
    }
    if (t->sinusoid.amplitude > 0) {
        imk_sinusoid_state state;
        CHECK_OK(imk_sinusoid_start(&state, t->sinusoid, dt, random, 5));
        imk_sinusoid_add(&state, n, x);
    }
    if (t->quantization > 0) {
        imk_quantization_state state;
        CHECK_OK(imk_quantization_start(&state, t->quantization, dt, random, 6));
        imk_quantization_apply(&state, n, x);
    }
    for (size_t i = 0; i < n; i++)
        x[i] += 9.8;
    return x;
}

static imk_identification identify_whole(const double *x, size_t n)
{
    imk_identify_settings settings = imk_identify_default();
    settings.dt = dt;
    const size_t size = imk_identify_workspace_size(n);
    void *workspace = malloc(size);
    imk_identification result;
    memset(&result, 0, sizeof result);
    CHECK_OK(imk_identify_channel(&settings, n, x, &result, workspace, size, NULL));
    free(workspace);
    return result;
}

/* A record in parts of `part` samples; its curve if wanted. */
static imk_status pass(const double *x, size_t n, size_t part, imk_identification *result,
                       imk_allan_point *curve, size_t *curve_count, imk_error *error)
{
    const imki_record_sizes sizes = {SEGMENT, CAPACITY};
    void *memory = malloc(imki_record_memory(&sizes));
    imk_identify_record *record = imki_record_start(&sizes, memory);
    imk_status status = IMK_OK;
    for (size_t i = 0; i < n && status == IMK_OK; i += part)
        status = imk_identify_record_add(record, n - i < part ? n - i : part, x + i, error);
    imk_identify_settings settings = imk_identify_default();
    settings.dt = dt;
    const size_t size = imk_identify_record_workspace_size(record);
    void *workspace = malloc(size);
    if (status == IMK_OK)
        status = imk_identify_record_finish(record, &settings, result, workspace, size, error);
    if (curve) {
        const imk_allan_point *points = imk_identify_record_curve(record, curve_count);
        memcpy(curve, points, *curve_count * sizeof *points);
    }
    free(workspace);
    free(memory);
    return status;
}

static imk_identification identify_passing(const double *x, size_t n)
{
    imk_identification result;
    memset(&result, 0, sizeof result);
    CHECK_OK(pass(x, n, n, &result, NULL, NULL, NULL));
    return result;
}

/* Both spectra hold the same noise, but coefficients near f_c are not the same ones: estimates may
 * differ by a part of their standard deviation, 0.2 of it as a limit; that is a property of these
 * records, not of chance. Another set of terms may be just within reach of one and out of reach of
 * the other: then a term is ambiguous in one only, and its interval begins at 0 there.
 * @return how many are */
static size_t check_alike(const truth *t, uint64_t seed)
{
    double *x = make_record(t, N, seed);
    const imk_identification whole = identify_whole(x, N), passing = identify_passing(x, N);
    free(x);
    size_t edges = 0;
    for (int term = 0; term < IMK_NOISE_TERMS; term++) {
        const imk_estimate *a = &whole.term[term], *b = &passing.term[term];
        const double sigma = a->present ? (a->upper - a->lower) / 3.92 : a->upper / 1.96;
        assert_int_equal(a->present, b->present);
        CHECK_CLOSE(b->value, a->value, 0.2 * sigma);
        if ((whole.ambiguous ^ passing.ambiguous) >> term & 1)
            edges++;
        else
            CHECK_CLOSE(b->lower, a->lower, 0.3 * sigma);
        CHECK_CLOSE(b->upper, a->upper, 0.3 * sigma);
    }
    CHECK_RELATIVE(passing.mean, whole.mean, 1e-10);
    CHECK_RELATIVE(passing.deviation, whole.deviation, 1e-9);
    CHECK_RELATIVE(passing.minimum_floor, whole.minimum_floor, 0.02);
    assert_int_equal(passing.resonance_count, whole.resonance_count);
    assert_int_equal(passing.sinusoid_count, whole.sinusoid_count);
    assert_int_equal(passing.gauss_markov_count, whole.gauss_markov_count);
    assert_int_equal(passing.verdict, whole.verdict);
    if (whole.filter.bandwidth > 0)
        CHECK_RELATIVE(passing.filter.bandwidth, whole.filter.bandwidth, 0.05);
    for (int i = 0; i < whole.resonance_count; i++) {
        CHECK_RELATIVE(passing.resonance[i].frequency, whole.resonance[i].frequency, 0.01);
        CHECK_RELATIVE(passing.resonance[i].sigma, whole.resonance[i].sigma, 0.05);
    }
    return edges;
}

static void test_like_the_whole(void **state)
{
    (void)state;
    size_t edges = check_alike(&usual, 2) + check_alike(&usual, 3);
    truth t = usual;
    t.filter = (imk_low_pass){12, 0.6};
    edges += check_alike(&t, 4);
    t = usual;
    t.resonance = (imk_resonance){2, 20, 15};
    edges += check_alike(&t, 5);
    t = (truth){.white = 1, .bias_instability = 0.2, .quantization = 0.05};
    edges += check_alike(&t, 6);
    assert_true(edges <= 1);
}

/* Stated: the amplitude to some per cent, the frequency to a quarter of the distance of a segment's
 * coefficients. */
static void test_tone(void **state)
{
    (void)state;
    static const double amplitudes[] = {0.6, 3, 30};
    for (size_t i = 0; i < 3; i++) {
        if (check_skips(i, 3))
            continue;
        truth t = usual;
        t.sinusoid = (imk_sinusoid){.amplitude = amplitudes[i], .frequency = 17.3041};
        double *x = make_record(&t, N, 7);
        const imk_identification r = identify_passing(x, N);
        free(x);
        assert_int_equal(r.sinusoid_count, 1);
        assert_int_equal(r.resonance_count, 0);
        CHECK_RELATIVE(r.sinusoid[0].amplitude, amplitudes[i], 0.05);
        CHECK_CLOSE(r.sinusoid[0].frequency, 17.3041, 0.25 / (2 * SEGMENT * dt));
        for (int term = IMK_NOISE_WHITE; term <= IMK_NOISE_RANDOM_WALK; term++) {
            const double value[] = {0, t.white, t.bias_instability, t.random_walk};
            const imk_estimate *e = &r.term[term];
            CHECK_CLOSE(e->present ? e->value : e->upper, value[term],
                        (e->upper - e->lower) / 3.92 * 4.8);
        }
    }
}

/* A tone beside a multiple of 1/(M dt) folds to the slow spectrum, where it is no line of its own:
 * 3.125 Hz and 0.02 Hz above, at M = 32. */
static void test_folded_tone(void **state)
{
    (void)state;
    truth t = usual;
    t.sinusoid = (imk_sinusoid){.amplitude = 20, .frequency = 3.145};
    double *x = make_record(&t, N, 8);
    const imk_identification r = identify_passing(x, N);
    free(x);
    assert_int_equal(r.sinusoid_count, 1);
    CHECK_CLOSE(r.sinusoid[0].frequency, 3.145, 0.25 / (2 * SEGMENT * dt));
}

static void test_division(void **state)
{
    (void)state;
    double *x = make_record(&usual, N + 12345, 9);
    for (size_t i = 0; i < N; i += 1777)
        x[i] = (double)NAN;
    imk_identification at_once, result;
    imk_allan_point first[IMKI_OCTAVES], again[IMKI_OCTAVES];
    memset(&at_once, 0, sizeof at_once);
    size_t count, count_again;
    CHECK_OK(pass(x, N + 12345, N + 12345, &at_once, first, &count, NULL));
    static const size_t parts[] = {1, 777, 8192, 65537};
    for (size_t i = 0; i < 4; i++) {
        if (check_skips(i, 2))
            continue;
        memset(&result, 0, sizeof result);
        CHECK_OK(pass(x, N + 12345, parts[i], &result, again, &count_again, NULL));
        assert_memory_equal(&result, &at_once, sizeof result);
        assert_int_equal(count_again, count);
        assert_memory_equal(again, first, count * sizeof *first);
    }
    free(x);
}

/* Short factors use every window: the deviations of the whole record to rounding. Long ones leave
 * windows out, which moves them by a part of their standard deviation. */
static void test_curve(void **state)
{
    (void)state;
    double *x = make_record(&usual, N + 4321, 10), *sums = malloc((N + 4322) * sizeof *sums);
    const size_t n = N + 4321;
    imk_identification result;
    imk_allan_point curve[IMKI_OCTAVES], whole[IMKI_OCTAVES];
    size_t count, factors[IMKI_OCTAVES];
    CHECK_OK(pass(x, n, n, &result, curve, &count, NULL));
    imk_allan_sums(n, x, sums, NULL);
    const size_t expected = imk_allan_factors(IMK_ALLAN_OCTAVE, n, factors);
    const imk_allan_settings settings = imk_allan_default();
    CHECK_OK(imk_allan_points(&settings, n, sums, expected, factors, whole, NULL));
    free(x);
    free(sums);
    assert_int_equal(count, expected);
    for (size_t i = 0; i < count; i++) {
        assert_int_equal(curve[i].m, factors[i]);
        if (factors[i] < IMKI_STRIDE_ONE) {
            CHECK_RELATIVE(curve[i].deviation, whole[i].deviation, 1e-10);
            assert_int_equal(curve[i].count, whole[i].count);
        } else {
            CHECK_CLOSE(curve[i].deviation, whole[i].deviation,
                        0.2 * (whole[i].upper - whole[i].lower) / 3.92);
        }
        CHECK_RELATIVE(curve[i].lower, whole[i].lower, 0.03);
        CHECK_RELATIVE(curve[i].edf, whole[i].edf, curve[i].type == whole[i].type ? 0.05 : 1);
    }
}

/* N, B, K in their 95 % intervals: of 16 records a right one misses more than 7 with a chance of
 * 3e-7. */
static void test_coverage(void **state)
{
    (void)state;
    const uint32_t records = check_quick() ? 3 : 16;
    const double value[] = {usual.white, usual.bias_instability, usual.random_walk};
    size_t missed[3] = {0};
    for (uint32_t record = 0; record < records; record++) {
        double *x = make_record(&usual, N / 2, 100 + record);
        const imk_identification r = identify_passing(x, N / 2);
        free(x);
        for (int i = 0; i < 3; i++) {
            const imk_estimate *e = &r.term[IMK_NOISE_WHITE + i];
            missed[i] += !(e->lower <= value[i] && value[i] <= e->upper);
        }
    }
    for (int i = 0; i < 3; i++)
        assert_in_range(missed[i], 0, 7);
}

/* Half a per cent at random and a hole of ten seconds: the estimates stay within half a standard
 * deviation of those of the complete record. */
static void test_missing(void **state)
{
    (void)state;
    double *x = make_record(&usual, N, 11);
    const imk_identification complete = identify_passing(x, N);
    const imk_random random = imk_random_seeded(12);
    double normal[2];
    for (size_t i = 0; i < N; i++) {
        imk_random_normals(random, 0, 2 * i, 2, normal);
        if (normal[0] * normal[0] + normal[1] * normal[1] < 0.01) /* chi-square, 2 degrees: 0.5 % */
            x[i] = (double)NAN;
    }
    for (size_t i = 200000; i < 201000; i++)
        x[i] = (double)NAN;
    const imk_identification r = identify_passing(x, N);
    for (int term = IMK_NOISE_WHITE; term <= IMK_NOISE_RANDOM_WALK; term++) {
        const imk_estimate *a = &complete.term[term], *b = &r.term[term];
        CHECK_CLOSE(b->value, a->value, 0.5 * (a->upper - a->lower) / 3.92);
    }
    /* A tenth of everything is too much. */
    for (size_t i = 0; i < N; i += 10)
        x[i] = (double)NAN;
    imk_identification result;
    imk_error error;
    CHECK_STATUS(pass(x, N, N, &result, NULL, NULL, &error), IMK_ERROR_GAP);
    free(x);
}

static void test_faults(void **state)
{
    (void)state;
    enum { HALF = N / 2 };
    imk_identification result;
    imk_error error;
    double *x = make_record(&usual, HALF, 13);
    CHECK_STATUS(pass(x, 7 * SEGMENT, HALF, &result, NULL, NULL, &error), IMK_ERROR_TOO_SHORT);
    x[123456] = (double)INFINITY;
    CHECK_STATUS(pass(x, HALF, 1000, &result, NULL, NULL, &error), IMK_ERROR_NOT_FINITE);
    assert_int_equal(error.index, 123456);
    /* The same verdict as on the whole record: cut at 1.5 deviations, repeated, in coarse steps. */
    x[123456] = 9.8;
    for (size_t i = 0; i < HALF; i++)
        x[i] = x[i] > 9.8 + 15 ? 9.8 + 15 : x[i];
    const unsigned verdict = identify_passing(x, HALF).verdict;
    assert_int_equal(verdict, identify_whole(x, HALF).verdict);
    assert_true(verdict & IMK_VERDICT_SATURATED);
    for (size_t i = 0; i < HALF; i++)
        x[i] = x[i / 2 * 2];
    assert_true(identify_passing(x, HALF).verdict & IMK_VERDICT_FROZEN);
    for (size_t i = 0; i < HALF; i++)
        x[i] = 30 * floor(x[i] / 30);
    const imk_identification coarse = identify_passing(x, HALF);
    assert_true(coarse.verdict & IMK_VERDICT_COARSE);
    CHECK_RELATIVE(coarse.resolution, 30, 1e-9);
    for (size_t i = 0; i < HALF; i++)
        x[i] = 3;
    CHECK_STATUS(pass(x, HALF, HALF, &result, NULL, NULL, &error), IMK_ERROR_CONSTANT);
    CHECK_CLOSE(error.value, 3, 0);
    free(x);
}

/* Values of any size: powers of two change nothing but the unit. */
static void test_scale(void **state)
{
    (void)state;
    double *x = make_record(&usual, N / 2, 14), *y = malloc(N / 2 * sizeof *y);
    const imk_identification plain = identify_passing(x, N / 2);
    static const int exponents[] = {-600, 600};
    for (size_t e = 0; e < 2; e++) {
        if (check_skips(e, 2))
            continue;
        for (size_t i = 0; i < N / 2; i++)
            y[i] = ldexp(x[i], exponents[e]);
        const imk_identification r = identify_passing(y, N / 2);
        for (int term = 0; term < IMK_NOISE_TERMS; term++) {
            CHECK_CLOSE(r.term[term].value, ldexp(plain.term[term].value, exponents[e]), 0);
            CHECK_CLOSE(r.term[term].upper, ldexp(plain.term[term].upper, exponents[e]), 0);
        }
    }
    free(x);
    free(y);
}

/* The public way in: sizes are asked for, and too little is refused. */
static void test_memory(void **state)
{
    (void)state;
    imk_identify_record *record;
    imk_error error;
    const size_t size = imk_identify_record_size(0);
    CHECK_BELOW((double)size, 12e6);
    CHECK_BELOW((double)imk_identify_record_size(86400000), 12e6);
    void *memory = malloc(size);
    CHECK_STATUS(imk_identify_record_begin(0, &record, memory, size - 1, &error),
                 IMK_ERROR_WORKSPACE);
    CHECK_OK(imk_identify_record_begin(0, &record, (char *)memory, size, &error));
    imk_identification result;
    imk_identify_settings settings = imk_identify_default();
    CHECK_STATUS(imk_identify_record_finish(record, &settings, &result, NULL, 0, &error),
                 IMK_ERROR_RANGE);
    settings.dt = dt;
    CHECK_STATUS(imk_identify_record_finish(record, &settings, &result, NULL, 0, &error),
                 IMK_ERROR_TOO_SHORT);
    free(memory);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_like_the_whole), cmocka_unit_test(test_tone),
        cmocka_unit_test(test_folded_tone),    cmocka_unit_test(test_division),
        cmocka_unit_test(test_curve),          cmocka_unit_test(test_coverage),
        cmocka_unit_test(test_missing),        cmocka_unit_test(test_faults),
        cmocka_unit_test(test_scale),          cmocka_unit_test(test_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
