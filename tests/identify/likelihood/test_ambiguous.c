/* SPDX-License-Identifier: Apache-2.0 */
/* What a record cannot tell: terms that stand for each other, steps of the output, terms that are
 * hardly known. `experiments/coverage_mixtures.c` measures the rates; here few records with fixed
 * seeds must not contradict them. */
#include "check.h"

#include "imukit/fourier.h"
#include "imukit/identify.h"

#include <stdlib.h>
#include <string.h>

static const double DT = 0.01;
enum { N = 1 << 15, RECORDS = 8 };

typedef struct truth {
    double quantization, white, bias_instability, random_walk, ramp, mean;
    imk_gauss_markov slow, slower;
    imk_low_pass filter;
    imk_resonance resonance;
    double step, angle_step;
} truth;

/* Flicker noise by fractional differences [HOSKING1981], which the library does not use:
 * h_k = h_k-1 (k - 1/2)/k. */
static void add_flicker(double strength, imk_random random, double *x)
{
    enum { PADDED = 4 * N };
    const size_t size = imk_fourier_workspace_size(PADDED);
    double *a = calloc(2 * PADDED, sizeof *a), *h = calloc(2 * PADDED, sizeof *h);
    double *normals = malloc(2 * N * sizeof *normals);
    void *workspace = malloc(size);
    imk_random_normals(random, 2, 0, 2 * N, normals);
    for (size_t k = 0; k < 2 * N; k++) {
        a[2 * k] = strength * normals[k];
        h[2 * k] = k == 0 ? 1 : h[2 * k - 2] * ((double)k - 0.5) / (double)k;
    }
    imk_fourier(PADDED, a, 0, workspace, size);
    imk_fourier(PADDED, h, 0, workspace, size);
    for (size_t k = 0; k < PADDED; k++) {
        const double real = a[2 * k] * h[2 * k] - a[2 * k + 1] * h[2 * k + 1];
        a[2 * k + 1] = a[2 * k] * h[2 * k + 1] + a[2 * k + 1] * h[2 * k];
        a[2 * k] = real;
    }
    imk_fourier(PADDED, a, 1, workspace, size);
    for (size_t i = 0; i < N; i++)
        x[i] += a[2 * (N + i)];
    free(a), free(h), free(normals), free(workspace);
}

static void add_quantization(double q, imk_random random, double *x)
{
    double *error = malloc((N + 1) * sizeof *error);
    imk_random_normals(random, 5, 0, N + 1, error);
    for (size_t i = 0; i < N; i++)
        x[i] += q / DT * (error[i + 1] - error[i]);
    free(error);
}

static void round_output(const truth *t, double *x)
{
    double angle = 0, before = 0;
    for (size_t i = 0; t->step > 0 && i < N; i++)
        x[i] = t->step * floor(x[i] / t->step + 0.5);
    for (size_t i = 0; t->angle_step > 0 && i < N; i++) {
        angle += x[i] * DT;
        const double steps = floor(angle / t->angle_step + 0.5);
        x[i] = (steps - before) * t->angle_step / DT;
        before = steps;
    }
}

/* Of `full` records a half under the sanitizers. */
static uint64_t records_of(uint64_t full)
{
    return check_quick() ? full / 2 : full;
}

static imk_identification identify(const truth *t, uint64_t seed)
{
    double *x = calloc(N, sizeof *x);
    const imk_random random = imk_random_seeded(seed);
    imk_arma_state arma;
    imk_random_walk_state walk;
    imk_gauss_markov_state slow;
    imk_filtered_white_start(&arma, t->white, t->filter, DT, random, 1);
    imk_arma_add(&arma, N, x);
    if (t->bias_instability > 0)
        add_flicker(t->bias_instability, random, x);
    if (imk_random_walk_start(&walk, t->random_walk, DT, random, 3) == IMK_OK)
        imk_random_walk_add(&walk, N, x);
    if (t->slow.sigma > 0 && imk_gauss_markov_start(&slow, t->slow, DT, random, 4) == IMK_OK)
        imk_gauss_markov_add(&slow, N, x);
    if (t->slower.sigma > 0 && imk_gauss_markov_start(&slow, t->slower, DT, random, 7) == IMK_OK)
        imk_gauss_markov_add(&slow, N, x);
    if (t->resonance.sigma > 0 && imk_resonance_start(&arma, t->resonance, DT, random, 6) == IMK_OK)
        imk_arma_add(&arma, N, x);
    if (t->quantization > 0)
        add_quantization(t->quantization, random, x);
    imk_ramp_add(t->ramp, DT, 0, N, x);
    for (size_t i = 0; i < N; i++)
        x[i] += t->mean;
    round_output(t, x);
    imk_identify_settings settings = imk_identify_default();
    settings.dt = DT;
    const size_t size = imk_identify_workspace_size(N);
    void *workspace = malloc(size);
    imk_identification r;
    CHECK_STATUS(imk_identify_channel(&settings, N, x, &r, workspace, size, NULL), IMK_OK);
    free(workspace), free(x);
    return r;
}

static bool holds(const imk_estimate *e, double value)
{
    return e->lower <= value && value <= e->upper;
}

/* A bit for each term whose interval begins at 0 though it is called present, and no other. */
static void check_bits(const imk_identification *r)
{
    for (int term = IMK_NOISE_BIAS_INSTABILITY; term < IMK_NOISE_TERMS; term++) {
        const imk_estimate *e = &r->term[term];
        assert_int_equal(r->ambiguous >> term & 1, e->present && e->lower <= 0 && e->upper >= 0);
        if (r->instead >> term & 1)
            assert_false(e->present);
    }
    if (!r->ambiguous)
        assert_int_equal(r->instead, 0);
}

/* A ramp beside flicker noise is called a random walk in one record of five; without an alternative
 * in one of 200: none in eight records has 4 % of failing, and the seeds are fixed. */
static void test_ramp_or_walk(void **state)
{
    (void)state;
    const truth t = {.white = 1, .bias_instability = 1, .ramp = 0.025};
    size_t walks = 0;
    for (uint64_t seed = 1; seed <= records_of(RECORDS); seed++) {
        const imk_identification r = identify(&t, seed);
        const imk_estimate *k = &r.term[IMK_NOISE_RANDOM_WALK];
        check_bits(&r);
        walks += k->present;
        if (k->present) {
            assert_true(r.ambiguous & 1u << IMK_NOISE_RANDOM_WALK);
            assert_true(r.instead != 0);
        }
        assert_true(holds(k, 0));
        assert_true(holds(&r.term[IMK_NOISE_RAMP], t.ramp));
    }
    assert_true(walks > 0);
}

/* Gauss-Markov noise that is called bias instability: B, which is not there, may be 0. */
static void test_flicker_or_gauss_markov(void **state)
{
    (void)state;
    const truth t = {.white = 1, .slow = {0.7, 5}};
    size_t called = 0, wrong = 0;
    for (uint64_t seed = 1; seed <= records_of(RECORDS); seed++) {
        const imk_identification r = identify(&t, seed);
        const imk_estimate *b = &r.term[IMK_NOISE_BIAS_INSTABILITY];
        check_bits(&r);
        called += b->present;
        wrong += !holds(b, 0);
        if (r.ambiguous & 1u << IMK_NOISE_BIAS_INSTABILITY)
            assert_true(r.instead & (IMK_AMBIGUOUS_GAUSS_MARKOV | 1u << IMK_NOISE_RANDOM_WALK));
    }
    assert_true(called > 0);
    assert_true(wrong <= 1); /* 3 % of records: two or more of eight in 2 % */
}

/* Two Gauss-Markov terms that are called bias instability: one of them alone does not replace it,
 * so that the set with both was not met, and 8 of 32 intervals of B did not reach 0. */
static void test_flicker_or_two_gauss_markov(void **state)
{
    (void)state;
    if (check_quick()) /* the statistics are others' */
        skip();
    const truth t = {.white = 1, .slow = {1.2, 0.5}, .slower = {0.7, 15}};
    size_t called = 0, wrong = 0;
    for (uint64_t seed = 1; seed <= 2 * RECORDS; seed++) {
        const imk_identification r = identify(&t, seed);
        const imk_estimate *b = &r.term[IMK_NOISE_BIAS_INSTABILITY];
        called += b->present;
        wrong += !holds(b, 0);
    }
    assert_true(called > 0);
    assert_true(wrong <= 2); /* 3 of 32 do not now */
}

/* A resonance of q = 3, wider than those that are tried, leaves over what looks like a Gauss-Markov
 * term of some samples, in one record of four: that it is there is not certain, and bias
 * instability can be what it is without that term. */
static void test_widest_resonance(void **state)
{
    (void)state;
    const truth t = {.white = 1, .bias_instability = 1, .resonance = {4, 5, 3}};
    size_t called = 0;
    for (uint64_t seed = 1; seed <= records_of(2 * RECORDS); seed++) {
        const imk_identification r = identify(&t, seed);
        for (int i = 0; i < r.gauss_markov_count; i++)
            assert_true(r.gauss_markov[i].sigma.lower == 0);
        called += r.gauss_markov_count > 0;
        assert_true(r.gauss_markov_count == 0 || holds(&r.term[IMK_NOISE_BIAS_INSTABILITY], 1));
        assert_int_equal((r.ambiguous & IMK_AMBIGUOUS_GAUSS_MARKOV) != 0, r.gauss_markov_count > 0);
    }
    assert_true(called > 0);
}

/* Quantization of two of its standard deviations is found in a third of the records; in the others
 * its part is in the white noise, which must reach down to what it is without. N is 2.7 of its own
 * standard deviations too large there, and its interval held in 91 %. */
static void test_hidden_quantization(void **state)
{
    (void)state;
    if (check_quick()) /* the statistics are others' */
        skip();
    const truth t = {.white = 1, .bias_instability = 1, .angle_step = 0.036, .mean = 2};
    size_t hidden = 0, wrong = 0;
    for (uint64_t seed = 1; seed <= 5 * RECORDS; seed++) {
        const imk_identification r = identify(&t, seed);
        hidden += !r.term[IMK_NOISE_QUANTIZATION].present;
        wrong += !holds(&r.term[IMK_NOISE_WHITE], 1);
    }
    assert_true(hidden > 0);
    assert_true(wrong <= 3); /* 5 % of records: four or more of 40 in 14 %; the seeds are fixed */
}

/* Where a term is clear, it stays so: flicker noise six times above white noise at 1 s. */
static void test_clear(void **state)
{
    (void)state;
    const truth t = {.white = 1, .bias_instability = 4};
    size_t clear = 0;
    for (uint64_t seed = 1; seed <= records_of(RECORDS); seed++) {
        const imk_identification r = identify(&t, seed);
        check_bits(&r);
        clear += r.term[IMK_NOISE_BIAS_INSTABILITY].lower > 0;
    }
    assert_int_equal(clear, records_of(RECORDS));
}

/* Steps in standard deviations of a sample up to which rounding errors are white: 1.6 for the rate,
 * 2.1 for the angle. White noise is right up to there (2.5 half-widths: one in 1e6), and a doubt
 * appears beyond. */
static void test_steps(void **state)
{
    (void)state;
    const struct {
        double step, angle_step;
        bool coarse;
    } cases[] = {{15, 0, false}, {20, 0, true}, {0, 0.2, false}, {0, 0.25, true}, {0, 1, true}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const truth t = {.white = 1,
                         .bias_instability = 1,
                         .mean = 3,
                         .step = cases[i].step,
                         .angle_step = cases[i].angle_step};
        const imk_identification r = identify(&t, 21);
        const imk_estimate *n = &r.term[IMK_NOISE_WHITE];
        assert_int_equal((r.verdict & IMK_VERDICT_COARSE) != 0, cases[i].coarse);
        if (!cases[i].coarse)
            CHECK_CLOSE(n->value, sqrt(1 + t.step * t.step / 12 * DT),
                        1.25 * (n->upper - n->lower));
    }
}

/* Rounding after a filter: a floor under the filtered noise, which is no term's. Without it N came
 * out a sixth too small, and the Allan deviation at one sample disagreed with the model. */
static void test_filter_and_steps(void **state)
{
    (void)state;
    const truth t = {.white = 1, .filter = {5, 0}, .step = 2, .mean = 0.7};
    for (uint64_t seed = 1; seed <= records_of(RECORDS); seed++) {
        const imk_identification r = identify(&t, seed);
        const imk_estimate *n = &r.term[IMK_NOISE_WHITE];
        CHECK_CLOSE(n->value, 1, 1.25 * (n->upper - n->lower));
        assert_true(n->upper < 1.5 * n->lower);
        CHECK_RELATIVE(r.filter.bandwidth, 5, 0.1);
        CHECK_RELATIVE(r.rounding, 2 / sqrt(12) * sqrt(DT), 1e-9);
        assert_false(r.verdict & (IMK_VERDICT_COARSE | IMK_VERDICT_MISFIT));
        imk_model model = {0};
        imk_identification_store(&r, &model, IMK_GYRO, 0);
        CHECK_RELATIVE(model.gyro.resolution.value[0], 2, 1e-9);
    }
}

/* A resonance inside the band of a filter does not take white noise from it, nor bring Gauss-Markov
 * noise. */
static void test_filter_and_resonance(void **state)
{
    (void)state;
    const truth t = {.white = 1, .bias_instability = 1, .filter = {20, 0}, .resonance = {6, 20, 8}};
    double sum = 0;
    for (uint64_t seed = 1; seed <= records_of(RECORDS); seed++) {
        const imk_identification r = identify(&t, seed);
        const imk_estimate *n = &r.term[IMK_NOISE_WHITE];
        CHECK_CLOSE(n->value, 1, 1.25 * (n->upper - n->lower));
        assert_int_equal(r.gauss_markov_count, 0);
        sum += n->value / (double)records_of(RECORDS);
    }
    CHECK_CLOSE(sum, 1, 0.015); /* the mean scatters by 0.4 % */
}

/* White noise far below quantization, present or not by chance: a doubt or ambiguous if and only if
 * the interval of what is called present spans a factor of nine. */
static void test_undetermined(void **state)
{
    (void)state;
    const truth t = {.quantization = 100, .white = 1};
    size_t doubts = 0;
    for (uint64_t seed = 1; seed <= records_of(2 * RECORDS); seed++) {
        const imk_identification r = identify(&t, seed);
        bool wide = false;
        for (int term = IMK_NOISE_QUANTIZATION; term <= IMK_NOISE_WHITE; term++)
            wide =
                wide || (r.term[term].present && !(r.term[term].upper <= 9 * r.term[term].lower));
        const bool doubt = r.verdict & IMK_VERDICT_UNDETERMINED;
        assert_true(wide ? doubt || (r.ambiguous >> IMK_NOISE_WHITE & 1) : !doubt);
        doubts += doubt;
    }
    assert_true(doubts > 0);
}

/* White noise that quantization hides above a quarter of a hertz: where Gauss-Markov
 * noise can take its place this is ambiguous, as of the other terms, and no doubt. */
static void test_hidden_white_noise(void **state)
{
    (void)state;
    if (check_quick()) /* the statistics are others' */
        skip();
    const truth t = {.quantization = 0.6, .white = 1, .bias_instability = 0.6};
    size_t ambiguous = 0;
    for (uint64_t seed = 1; seed <= 2 * RECORDS; seed++) {
        const imk_identification r = identify(&t, seed);
        const imk_estimate *n = &r.term[IMK_NOISE_WHITE];
        ambiguous += n->lower <= 0;
        assert_true(n->present && n->upper < 1.5);
        assert_false(r.verdict & IMK_VERDICT_UNDETERMINED);
        assert_int_equal(r.ambiguous >> IMK_NOISE_WHITE & 1, n->lower <= 0);
    }
    assert_true(ambiguous > 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_hidden_white_noise),
        cmocka_unit_test(test_ramp_or_walk),
        cmocka_unit_test(test_flicker_or_gauss_markov),
        cmocka_unit_test(test_flicker_or_two_gauss_markov),
        cmocka_unit_test(test_widest_resonance),
        cmocka_unit_test(test_hidden_quantization),
        cmocka_unit_test(test_clear),
        cmocka_unit_test(test_steps),
        cmocka_unit_test(test_filter_and_steps),
        cmocka_unit_test(test_filter_and_resonance),
        cmocka_unit_test(test_undetermined),
    };
    return cmocka_run_group_tests_name("ambiguous", tests, NULL, NULL);
}
