/* SPDX-License-Identifier: Apache-2.0 */
/* Records with samples missing: the filling is the Gaussian conditional, and what is identified has
 * the intervals that it states. */
#include "check.h"

#include "identify/records/missing_internal.h"
#include "imukit/fourier.h"
#include "imukit/linear_algebra.h"

#include <string.h>

enum { SMALL = 96 };

/* The inverse transform undoes the transform: any length, also primes (Bluestein). */
static void test_cosine_inverse(void **state)
{
    (void)state;
    static const size_t lengths[] = {1, 2, 3, 4, 5, 6, 7, 16, 30, 31, 97, 1000, 1001, 1026};
    for (size_t i = 0; i < sizeof lengths / sizeof lengths[0]; i++) {
        const size_t n = lengths[i], size = imk_cosine_workspace_size(n);
        double *x = malloc(n * sizeof *x), *y = malloc(n * sizeof *y);
        void *workspace = malloc(size);
        imk_random_normals(imk_random_seeded(i), 1, 0, n, x);
        memcpy(y, x, n * sizeof *x);
        CHECK_STATUS(imk_cosine(n, y, workspace, size), IMK_OK);
        CHECK_STATUS(imk_cosine_inverse(n, y, workspace, size), IMK_OK);
        for (size_t j = 0; j < n; j++)
            CHECK_CLOSE(y[j], x[j], 1e-13); /* some hundred roundings of numbers near 1 */
        assert_int_equal(imk_cosine_inverse(n, y, workspace, size - 1), IMK_ERROR_WORKSPACE);
        free(x), free(y), free(workspace);
    }
}

typedef struct small_record {
    imki_fill fill;
    uint32_t index[SMALL];
    double variance[SMALL], samples[SMALL], vectors[4][SMALL];
    double precision[SMALL * SMALL];
    void *transform;
} small_record;

/* A steep spectrum, gaps of one sample and one of twenty; the precision by its definition. */
static small_record *small_make(uint64_t seed)
{
    small_record *r = calloc(1, sizeof *r);
    uint32_t word[SMALL];
    imk_random_words(imk_random_seeded(seed), 2, 0, SMALL, word);
    imk_random_normals(imk_random_seeded(seed), 1, 0, SMALL, r->samples);
    for (size_t i = 0; i < SMALL; i++) {
        if ((word[i] < 0x30000000 && i > 0) || (i >= 40 && i < 60))
            r->index[r->fill.missing++] = (uint32_t)i;
        r->variance[i] = 1000 / pow(1 + (double)(i * i), 1.5);
    }
    r->transform = malloc(imk_cosine_workspace_size(SMALL));
    r->fill.n = SMALL;
    r->fill.index = r->index;
    r->fill.variance = r->variance;
    r->fill.tolerance = 1e-9;
    r->fill.scratch = r->vectors[0];
    r->fill.solution = r->vectors[1];
    r->fill.residual = r->vectors[2];
    r->fill.direction = r->vectors[3];
    r->fill.transform = r->transform;
    r->fill.transform_size = imk_cosine_workspace_size(SMALL);
    for (size_t i = 0; i < SMALL; i++)
        for (size_t j = 0; j < SMALL; j++)
            for (size_t k = 1; k < SMALL; k++) {
                const double w = 3.14159265358979323846 * (double)k / SMALL;
                r->precision[i * SMALL + j] += 2.0 / SMALL * cos(w * ((double)i + 0.5)) *
                                               cos(w * ((double)j + 0.5)) / r->variance[k];
            }
    return r;
}

static void small_free(small_record *r)
{
    free(r->transform);
    free(r);
}

/* P_mm as a dense matrix, factored. */
static void small_factor(const small_record *r, double *matrix)
{
    const size_t m = r->fill.missing;
    for (size_t i = 0; i < m; i++)
        for (size_t j = 0; j < m; j++)
            matrix[i * m + j] = r->precision[r->index[i] * SMALL + r->index[j]];
    assert_int_equal(imk_cholesky_factor(m, matrix), IMK_OK);
}

/* The mean against a dense solution of the same equations, with both preconditioners. */
static void test_mean(void **state)
{
    (void)state;
    for (int bridged = 0; bridged < 2; bridged++) {
        small_record *r = small_make(7);
        const size_t m = r->fill.missing;
        double matrix[SMALL * SMALL], expected[SMALL] = {0}, samples[SMALL];
        r->fill.gap = bridged ? 20 : 1;
        for (size_t i = 0; i < m; i++)
            r->samples[r->index[i]] = 0;
        for (size_t i = 0; i < m; i++)
            for (size_t j = 0; j < SMALL; j++)
                expected[i] -= r->precision[r->index[i] * SMALL + j] * r->samples[j];
        small_factor(r, matrix);
        imk_cholesky_solve(m, matrix, expected);
        memcpy(samples, r->samples, sizeof samples);
        imki_fill_mean(&r->fill, samples);
        assert_true(r->fill.bridge == bridged);
        for (size_t i = 0; i < m; i++)
            CHECK_CLOSE(samples[r->index[i]], expected[i], 1e-5);
        small_free(r);
    }
}

/* Draws have the covariance P_mm^-1: e^T P_mm e is chi-square of m degrees each. Over 400 draws its
 * mean has the sd sqrt(2 m/400); five and a half of them are passed once in 4e7. And no coordinate
 * stands out: the first alone has the variance that it should, chi-square of 400. */
static void test_draws(void **state)
{
    (void)state;
    enum { DRAWS = 400 };
    small_record *r = small_make(8);
    const size_t m = r->fill.missing;
    double matrix[SMALL * SMALL], inverse[SMALL * SMALL], sum = 0, squares = 0;
    r->fill.gap = 1;
    for (uint64_t draw = 0; draw < DRAWS; draw++) {
        imki_fill_draw(&r->fill, imk_random_seeded(3), draw);
        for (size_t i = 0; i < m; i++)
            for (size_t j = 0; j < m; j++)
                sum += r->fill.solution[i] * r->fill.solution[j] *
                       r->precision[r->index[i] * SMALL + r->index[j]] / DRAWS;
        squares += r->fill.solution[0] * r->fill.solution[0];
    }
    CHECK_CLOSE(sum, (double)m, 5.5 * sqrt(2 * (double)m / DRAWS));
    small_factor(r, matrix);
    imk_cholesky_inverse(m, matrix, inverse);
    CHECK_CLOSE(squares / DRAWS / inverse[0], 1, 5.5 * sqrt(2.0 / DRAWS));
    small_free(r);
}

/* ---- identification -------------------------------------------------------------------------- */

static void add_noise(double *x, size_t n, double dt, uint64_t record, double white, double flicker,
                      double walk)
{
    const imk_random random = imk_random_seeded(1);
    const uint64_t stream = record << 8;
    imk_white_state w;
    imk_flicker_state f;
    imk_random_walk_state k;
    memset(x, 0, n * sizeof *x);
    imk_white_start(&w, white, dt, random, stream + 1);
    imk_white_add(&w, n, x);
    imk_flicker_start(&f, (imk_flicker){flicker, 0}, dt, random, stream + 2);
    imk_flicker_add(&f, n, x);
    imk_random_walk_start(&k, walk, dt, random, stream + 60);
    imk_random_walk_add(&k, n, x);
}

static void scatter_missing(double *x, size_t n, uint64_t record, double share)
{
    uint32_t *word = malloc(n * sizeof *word);
    imk_random_words(imk_random_seeded(2), record, 0, n, word);
    for (size_t i = 0; i < n; i++)
        x[i] = word[i] < share * 4294967296.0 ? (double)NAN : x[i];
    free(word);
}

static imk_identification identify(const double *x, size_t n, double dt, imk_status expected)
{
    imk_identify_settings settings = imk_identify_default();
    settings.dt = dt;
    const size_t size = imk_identify_workspace_size(n);
    void *workspace = malloc(size);
    imk_identification result;
    memset(&result, 0, sizeof result);
    imk_error error;
    CHECK_STATUS(imk_identify_channel(&settings, n, x, &result, workspace, size, &error), expected);
    free(workspace);
    return result;
}

/* A fifth missing at random. With 16 records a right 95 % interval covers fewer than 9 times in 16
 * with a probability below 1e-6; with 8 (a build that checks memory) fewer than 3 times. */
static void test_coverage(void **state)
{
    (void)state;
    enum { RECORDS = 16, N = 16000 };
    static double x[N];
    static const double truth[] = {1, 0.8, 0.08};
    static const int term[] = {IMK_NOISE_WHITE, IMK_NOISE_BIAS_INSTABILITY, IMK_NOISE_RANDOM_WALK};
    const uint32_t records = check_runs(RECORDS) == RECORDS ? RECORDS : 8;
    size_t covered[3] = {0}, misfits = 0;
    for (uint64_t record = 0; record < records; record++) {
        add_noise(x, N, 0.1, record, truth[0], truth[1], truth[2]);
        scatter_missing(x, N, record, 0.2);
        const imk_identification r = identify(x, N, 0.1, IMK_OK);
        for (size_t i = 0; i < 3; i++)
            covered[i] += r.term[term[i]].lower <= truth[i] && truth[i] <= r.term[term[i]].upper;
        assert_true(r.rounds > 1 && r.rounds <= 13);
        misfits += r.verdict & IMK_VERDICT_MISFIT ? 1 : 0;
    }
    for (size_t i = 0; i < 3; i++)
        assert_in_range(covered[i], records == RECORDS ? 9 : 3, records);
    /* The draw of the missing samples has the Allan deviation of the rest. */
    assert_in_range(misfits, 0, records / 3);
}

/* A hole of a twentieth and a tone that runs on behind it. */
static void test_hole_and_tone(void **state)
{
    (void)state;
    enum { N = 60000, FIRST = 20000, MISSING = 3000 };
    double *x = malloc(N * sizeof *x);
    imk_sinusoid_state tone;
    add_noise(x, N, 0.01, 3, 1e-2, 4e-3, 1e-4);
    imk_sinusoid_start(&tone, (imk_sinusoid){0.01, 7.3}, 0.01, imk_random_seeded(1), 99);
    imk_sinusoid_add(&tone, N, x);
    const imk_identification whole = identify(x, N, 0.01, IMK_OK);
    assert_int_equal(whole.rounds, 0);
    assert_int_equal(whole.missing, 0);
    for (size_t i = FIRST; i < FIRST + MISSING; i++)
        x[i] = (double)NAN;
    const imk_identification r = identify(x, N, 0.01, IMK_OK);
    assert_int_equal(r.missing, MISSING);
    CHECK_RELATIVE(r.largest_gap, 30, 1e-12);
    assert_int_equal(r.sinusoid_count, 1);
    /* sd of the amplitude is N sqrt(2/T) = 6e-4; five of them. */
    CHECK_CLOSE(r.sinusoid[0].amplitude, 0.01, 3e-3);
    CHECK_CLOSE(r.sinusoid[0].frequency, 7.3, 1e-3);
    /* A twentieth less moves an estimate by a fifth of its sd; five of these. */
    const imk_estimate *n = &r.term[IMK_NOISE_WHITE], *b = &r.term[IMK_NOISE_BIAS_INSTABILITY];
    CHECK_CLOSE(n->value, whole.term[IMK_NOISE_WHITE].value, 1.2 * n->sigma);
    CHECK_CLOSE(b->value, whole.term[IMK_NOISE_BIAS_INSTABILITY].value, 1.2 * b->sigma);
    /* Its sigma is that of the present samples. */
    CHECK_RELATIVE(n->sigma, whole.term[IMK_NOISE_WHITE].sigma * sqrt(1 / 0.95), 0.04);
    free(x);
}

/* A ramp through a fifth missing keeps its value and gets its wider interval. */
static void test_ramp(void **state)
{
    (void)state;
    enum { N = 40000 };
    double *x = malloc(N * sizeof *x);
    add_noise(x, N, 0.01, 4, 1e-3, 0, 0);
    imk_ramp_add(8e-6, 0.01, 0, N, x);
    scatter_missing(x, N, 4, 0.2);
    const imk_identification r = identify(x, N, 0.01, IMK_OK);
    const imk_estimate *e = &r.term[IMK_NOISE_RAMP];
    assert_true(e->present);
    CHECK_CLOSE(e->value, 8e-6, 5 * e->sigma);
    /* Least squares on what is there: N sqrt(12/(share T^3)). */
    CHECK_RELATIVE(e->sigma, 1e-3 * sqrt(12 / (0.8 * 400.0 * 400.0 * 400.0)), 0.15);
    free(x);
}

/* NaN at the ends is cut off: the same bits as without. */
static void test_ends(void **state)
{
    (void)state;
    enum { N = 5000, ENDS = 10 };
    double x[N + 2 * ENDS];
    add_noise(x + ENDS, N, 0.01, 5, 1e-3, 1e-3, 0);
    for (size_t i = 0; i < ENDS; i++)
        x[i] = x[N + ENDS + i] = (double)NAN;
    const imk_identification inner = identify(x + ENDS, N, 0.01, IMK_OK);
    const imk_identification all = identify(x, N + 2 * ENDS, 0.01, IMK_OK);
    assert_memory_equal(&inner, &all, sizeof inner);
}

static void test_refusals(void **state)
{
    (void)state;
    enum { N = 2000 };
    double x[N];
    imk_identify_settings settings = imk_identify_default();
    settings.dt = 0.01;
    const size_t size = imk_identify_workspace_size(N);
    void *workspace = malloc(size);
    imk_identification result;
    imk_error error;
    add_noise(x, N, 0.01, 6, 1, 0, 0);
    x[0] = (double)NAN;
    x[700] = HUGE_VAL;
    CHECK_STATUS(imk_identify_channel(&settings, N, x, &result, workspace, size, &error),
                 IMK_ERROR_NOT_FINITE);
    assert_int_equal(error.index, 700);
    for (size_t i = 1; i + 1 < N; i++)
        x[i] = i % 5 == 0 ? 1.0 * (double)i : (double)NAN;
    CHECK_STATUS(imk_identify_channel(&settings, N, x, &result, workspace, size, &error),
                 IMK_ERROR_TOO_SHORT);
    for (size_t i = 0; i < N; i++)
        x[i] = (double)NAN;
    CHECK_STATUS(imk_identify_channel(&settings, N, x, &result, workspace, size, &error),
                 IMK_ERROR_TOO_SHORT);
    for (size_t i = 0; i < N; i++)
        x[i] = i % 2 ? (double)NAN : 3;
    CHECK_STATUS(imk_identify_channel(&settings, N, x, &result, workspace, size, &error),
                 IMK_ERROR_CONSTANT);
    free(workspace);
}

/* Records that no sensor makes, with holes in them: something finite, or a refusal. */
static void test_odd_records(void **state)
{
    (void)state;
    enum { N = 512, KINDS = 7 };
    double x[N];
    for (size_t kind = 0; kind < KINDS; kind++) {
        imk_random_normals(imk_random_seeded(kind), 1, 0, N, x);
        for (size_t i = 0; i < N; i++) {
            const double k = (double)i;
            const double odd[KINDS] = {x[i] * 1e200, i == N / 2,   i > N / 2, k,
                                       x[i] > 0,     sin(0.7 * k), x[i] + 1e9};
            x[i] = i % 7 == 3 || (i > 300 && i < 400) ? (double)NAN : odd[kind];
        }
        imk_identify_settings settings = imk_identify_default();
        settings.dt = 0.01;
        const size_t size = imk_identify_workspace_size(N);
        void *workspace = malloc(size);
        imk_identification r;
        const imk_status status = imk_identify_channel(&settings, N, x, &r, workspace, size, NULL);
        assert_true(status == IMK_OK || status == IMK_ERROR_NO_CONVERGENCE);
        for (int term = 0; status == IMK_OK && term < IMK_NOISE_TERMS; term++)
            assert_true(isfinite(r.term[term].value) && isfinite(r.term[term].upper));
        free(workspace);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cosine_inverse), cmocka_unit_test(test_mean),
        cmocka_unit_test(test_draws),          cmocka_unit_test(test_coverage),
        cmocka_unit_test(test_hole_and_tone),  cmocka_unit_test(test_ramp),
        cmocka_unit_test(test_ends),           cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_odd_records)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
