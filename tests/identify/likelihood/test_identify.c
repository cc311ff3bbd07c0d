/* SPDX-License-Identifier: Apache-2.0 */
/* Identification: what was simulated comes back within its stated confidence, what was not there is
 * reported as absent. */
#include "check.h"

#include "imukit/fourier.h"
#include "imukit/identify.h"

#include <stdlib.h>
#include <string.h>

typedef struct truth {
    double white, bias_instability, random_walk, ramp, quantization;
    imk_sinusoid sinusoid;
    imk_resonance resonance;
    imk_low_pass filter;
    imk_gauss_markov gauss_markov[2];
} truth;

static double *make_record(const truth *t, size_t n, double dt, uint64_t seed, uint64_t axis)
{
    double *x = calloc(n, sizeof *x);
    const imk_random random = imk_random_seeded(seed);
    const uint64_t stream = axis << 40;
    if (t->white > 0 && t->filter.bandwidth > 0) {
        imk_arma_state state;
        assert_int_equal(
            imk_filtered_white_start(&state, t->white, t->filter, dt, random, stream + 1), IMK_OK);
        imk_arma_add(&state, n, x);
    } else if (t->white > 0) {
        imk_white_state state;
        assert_int_equal(imk_white_start(&state, t->white, dt, random, stream + 1), IMK_OK);
        imk_white_add(&state, n, x);
    }
    if (t->bias_instability > 0) {
        imk_flicker_state state;
        assert_int_equal(imk_flicker_start(&state, (imk_flicker){t->bias_instability, 0}, dt,
                                           random, stream + 2),
                         IMK_OK);
        imk_flicker_add(&state, n, x);
    }
    if (t->random_walk > 0) {
        imk_random_walk_state state;
        assert_int_equal(imk_random_walk_start(&state, t->random_walk, dt, random, stream + 3),
                         IMK_OK);
        imk_random_walk_add(&state, n, x);
    }
    if (t->resonance.sigma > 0) {
        imk_arma_state state;
        assert_int_equal(imk_resonance_start(&state, t->resonance, dt, random, stream + 4), IMK_OK);
        imk_arma_add(&state, n, x);
    }
    if (t->sinusoid.amplitude > 0) {
        imk_sinusoid_state state;
        assert_int_equal(imk_sinusoid_start(&state, t->sinusoid, dt, random, stream + 5), IMK_OK);
        imk_sinusoid_add(&state, n, x);
    }
    for (size_t i = 0; i < 2; i++)
        if (t->gauss_markov[i].sigma > 0) {
            imk_gauss_markov_state state;
            assert_int_equal(
                imk_gauss_markov_start(&state, t->gauss_markov[i], dt, random, stream + 64 + i),
                IMK_OK);
            imk_gauss_markov_add(&state, n, x);
        }
    imk_ramp_add(t->ramp, dt, 0, n, x);
    if (t->quantization > 0) {
        imk_quantization_state state;
        assert_int_equal(imk_quantization_start(&state, t->quantization, dt, random, stream + 6),
                         IMK_OK);
        imk_quantization_apply(&state, n, x);
    }
    return x;
}

static imk_identification identify(const double *x, size_t n, double dt)
{
    imk_identify_settings settings = imk_identify_default();
    settings.dt = dt;
    const size_t size = imk_identify_workspace_size(n);
    void *workspace = malloc(size);
    imk_identification result;
    memset(&result, 0, sizeof result);
    imk_error error;
    CHECK_STATUS(imk_identify_channel(&settings, n, x, &result, workspace, size, &error), IMK_OK);
    free(workspace);
    return result;
}

static imk_identification identify_truth(const truth *t, size_t n, double dt, uint64_t seed,
                                         uint64_t axis)
{
    double *x = make_record(t, n, dt, seed, axis);
    const imk_identification result = identify(x, n, dt);
    free(x);
    return result;
}

/* N, B, K of a small MEMS gyro, scaled so that three hours at 20 Hz tell all of them. With 40
 * records a right 95 % interval covers fewer than 30 times in 40 with a probability of 6e-7; with 8
 * fewer than 3 times with one of 4e-7. */
static void test_coverage(void **state)
{
    (void)state;
    enum { RECORDS = 40, N = 216000 };
    const truth t = {.white = 1.0, .bias_instability = 0.4, .random_walk = 0.012};
    const double dt = 0.05, values[] = {t.white, t.bias_instability, t.random_walk};
    const int terms[] = {IMK_NOISE_WHITE, IMK_NOISE_BIAS_INSTABILITY, IMK_NOISE_RANDOM_WALK};
    const uint32_t records = check_runs(RECORDS) == RECORDS ? RECORDS : 8;
    size_t covered[3] = {0}, false_terms = 0;
    double squares[3] = {0}, variances[3] = {0};
    for (uint64_t record = 0; record < records; record++) {
        const imk_identification r = identify_truth(&t, N, dt, 1, record);
        for (size_t i = 0; i < 3; i++) {
            const imk_estimate *e = &r.term[terms[i]];
            covered[i] += e->lower <= values[i] && values[i] <= e->upper;
            assert_true(e->lower <= e->value && e->value <= e->upper);
            assert_true(e->lower <= e->free_value && e->free_value <= e->upper);
            squares[i] += pow(e->free_value / values[i], 2);
            variances[i] += pow(2 * e->sigma / values[i], 2);
        }
        false_terms += r.term[IMK_NOISE_QUANTIZATION].present + r.term[IMK_NOISE_RAMP].present +
                       (r.filter.bandwidth > 0) + (size_t)r.sinusoid_count +
                       (size_t)r.resonance_count;
    }
    for (size_t i = 0; i < 3; i++)
        assert_in_range(covered[i], records == RECORDS ? 30 : 3, records);
    /* The squares are unbiased: their mean within five of its standard deviations, with a third
     * more for sigmas that take for known what was not called present. */
    for (size_t i = 0; i < 3; i++)
        CHECK_CLOSE(squares[i] / records, 1, 5 * 1.33 * sqrt(variances[i]) / records);
    /* Each record asks two such questions at 1 %: 80 trials; more than 9 has a chance below 1e-7.
     */
    assert_in_range(false_terms, 0, 9);
}

/* White noise only: everything else is absent, with a bound. */
static void test_white_only(void **state)
{
    (void)state;
    const truth t = {.white = 2.5e-3};
    const imk_identification r = identify_truth(&t, 200000, 0.01, 1, 1);
    const imk_estimate *n = &r.term[IMK_NOISE_WHITE];
    assert_true(n->present);
    /* sd of N is N/sqrt(2n) = 0.16 %; five of them. */
    CHECK_RELATIVE(n->value, t.white, 8e-3);
    CHECK_RELATIVE(n->sigma, t.white / sqrt(2 * 200000.0), 0.05);
    for (int term = 0; term < IMK_NOISE_TERMS; term++)
        if (term != IMK_NOISE_WHITE) {
            assert_false(r.term[term].present);
            assert_true(r.term[term].value == 0 && r.term[term].lower == 0);
            assert_true(r.term[term].upper > 0);
        }
    assert_true(r.valid_from == 0.01);
    assert_true(r.verdict & IMK_VERDICT_SHORT);
}

static void test_quantization(void **state)
{
    (void)state;
    const truth t = {.white = 1e-3, .quantization = 1.5e-5};
    const imk_identification r = identify_truth(&t, 200000, 0.01, 1, 2);
    const imk_estimate *q = &r.term[IMK_NOISE_QUANTIZATION];
    assert_true(q->present);
    /* Five stated sigmas. */
    CHECK_CLOSE(q->value, t.quantization, 5 * q->sigma);
    CHECK_CLOSE(r.term[IMK_NOISE_WHITE].value, t.white, 5 * r.term[IMK_NOISE_WHITE].sigma);
    assert_true(r.filter.bandwidth == 0);
}

/* Rounding errors and nothing else: the two at the ends of the record do not cancel, but are told
 * from white noise, of which they would make 2 Q/sqrt(T) = 0.063. */
static void test_quantization_ends(void **state)
{
    (void)state;
    enum { N = 100000 };
    double *x = malloc((N + 1) * sizeof *x);
    for (uint64_t record = 0; record < 4; record++) {
        imk_random_normals(imk_random_seeded(3), record << 40, 0, N + 1, x);
        for (size_t i = 0; i < N; i++)
            x[i] = (x[i + 1] - x[i]) / 0.01;
        const imk_identification r = identify(x, N, 0.01);
        /* sd of Q is Q/sqrt(2n) = 0.22 %; five of them. */
        CHECK_RELATIVE(r.term[IMK_NOISE_QUANTIZATION].value, 1, 0.011);
        for (int term = IMK_NOISE_WHITE; term < IMK_NOISE_TERMS; term++)
            assert_false(r.term[term].present);
        /* 4 pi^2 f^2 Q^2 reaches the square of that at the first of 2000 coefficients a hertz. */
        assert_true(r.term[IMK_NOISE_WHITE].upper < 0.02);
        assert_int_equal(r.gauss_markov_count, 0);
    }
    free(x);
}

/* Two Gauss-Markov terms, and neither bias instability nor a random walk in their place. */
static void test_gauss_markov(void **state)
{
    (void)state;
    const truth t = {.white = 1, .gauss_markov = {{1, 1}, {1.5, 100}}};
    const imk_identification r = identify_truth(&t, 262144, 0.05, 1, 7);
    assert_int_equal(r.gauss_markov_count, 2);
    assert_false(r.term[IMK_NOISE_BIAS_INSTABILITY].present);
    assert_false(r.term[IMK_NOISE_RANDOM_WALK].present);
    assert_false(r.term[IMK_NOISE_RAMP].present);
    assert_true(r.filter.bandwidth == 0);
    for (size_t i = 0; i < 2; i++) {
        const imk_estimate *sigma = &r.gauss_markov[i].sigma;
        const imk_estimate *time = &r.gauss_markov[i].correlation_time;
        CHECK_CLOSE(sigma->value, t.gauss_markov[i].sigma, 5 * sigma->sigma);
        CHECK_CLOSE(time->value, t.gauss_markov[i].correlation_time, 5 * time->sigma);
        assert_true(sigma->lower < sigma->value && sigma->value < sigma->upper);
        assert_true(time->lower < time->value && time->value < time->upper);
        /* Cramer and Rao allow 1.6 … 6.5 % and 5.7 … 16.5 %: the intervals are of that size. */
        assert_true(sigma->upper / sigma->lower < 1.5 && sigma->upper / sigma->lower > 1.03);
        assert_true(time->upper / time->lower < 2.5 && time->upper / time->lower > 1.1);
    }
}

/* A strong Gauss-Markov term of 20 samples looks like a low-pass: it is called what it is. */
static void test_fast_gauss_markov(void **state)
{
    (void)state;
    const truth t = {.white = 1, .gauss_markov = {{10, 0.2}}};
    const imk_identification r = identify_truth(&t, 200000, 0.01, 1, 9);
    assert_int_equal(r.gauss_markov_count, 1);
    assert_true(r.filter.bandwidth == 0);
    CHECK_CLOSE(r.gauss_markov[0].correlation_time.value, 0.2,
                5 * r.gauss_markov[0].correlation_time.sigma);
}

static void test_ramp(void **state)
{
    (void)state;
    for (int sign = -1; sign <= 1; sign += 2) {
        const truth t = {.white = 1e-3, .ramp = sign * 2e-6};
        const imk_identification r = identify_truth(&t, 100000, 0.01, 1, 3);
        const imk_estimate *e = &r.term[IMK_NOISE_RAMP];
        assert_true(e->present);
        CHECK_CLOSE(e->value, t.ramp, 5 * e->sigma);
        assert_true(e->lower < t.ramp && t.ramp < e->upper);
        /* Least squares on white noise: sigma = N sqrt(12/T^3). */
        CHECK_RELATIVE(e->sigma, t.white * sqrt(12.0 / 1e9), 0.05);
        assert_false(r.term[IMK_NOISE_RANDOM_WALK].present);
    }
}

/* A tone, a resonance and a filter are found for what they are and do not bend N, B. */
static void test_shapes(void **state)
{
    (void)state;
    const truth t = {.white = 1.0,
                     .bias_instability = 0.5,
                     .sinusoid = {0.3, 7.3},
                     .resonance = {10.0, 20.3, 16},
                     .filter = {45, 0.7}};
    const imk_identification r = identify_truth(&t, 400000, 0.01, 1, 4);
    assert_int_equal(r.sinusoid_count, 1);
    CHECK_CLOSE(r.sinusoid[0].frequency, 7.3, 1e-4);
    /* sd of the amplitude is sqrt(2 S/T) = 0.022; five of them. */
    CHECK_CLOSE(r.sinusoid[0].amplitude, 0.3, 0.11);
    assert_int_equal(r.resonance_count, 1);
    CHECK_RELATIVE(r.resonance[0].frequency, 20.3, 5e-3);
    CHECK_RELATIVE(r.resonance[0].q, 16, 0.1);
    CHECK_RELATIVE(r.resonance[0].sigma, 10.0, 0.03);
    CHECK_RELATIVE(r.filter.bandwidth, 45, 0.1);
    CHECK_RELATIVE(r.filter.damping, 0.7, 0.15);
    CHECK_CLOSE(r.term[IMK_NOISE_WHITE].value, 1.0, 5 * r.term[IMK_NOISE_WHITE].sigma + 0.01);
    const imk_estimate *b = &r.term[IMK_NOISE_BIAS_INSTABILITY];
    CHECK_CLOSE(b->value, 0.5, 5 * b->sigma);
    assert_false(r.term[IMK_NOISE_QUANTIZATION].present);
    assert_true(r.valid_from < 0.05);
    assert_true(r.five_terms_from > 0.05);
}

/* The skirts of a strong slow tone make a line of a hundred coefficients of it: it is a tone still,
 * and not a resonance. */
static void test_strong_slow_tone(void **state)
{
    (void)state;
    static const double frequencies[] = {0.0564, 0.5641, 1.6923};
    for (size_t k = 0; k < 3; k++) {
        const truth t = {.white = 0.1, .bias_instability = 0.05, .sinusoid = {1, frequencies[k]}};
        const imk_identification r = identify_truth(&t, 180000, 0.01, 5, k);
        assert_int_equal(r.sinusoid_count, 1);
        assert_int_equal(r.resonance_count, 0);
        /* by white noise sigmas of 1.5e-6 Hz and 0.0033; flicker noise doubles them at the first */
        CHECK_CLOSE(r.sinusoid[0].frequency, frequencies[k], 1.5e-5);
        CHECK_CLOSE(r.sinusoid[0].amplitude, 1, 0.03);
        assert_false(r.verdict & IMK_VERDICT_MISFIT);
    }
}

/* Filters well inside the band, where white noise looks like slow noise to a fit without a filter.
 */
static void test_strong_filters(void **state)
{
    (void)state;
    const imk_low_pass filters[] = {{5, 0.7}, {10, 0.7}, {20, 0.7}, {5, 0}, {10, 0}};
    for (size_t i = 0; i < sizeof filters / sizeof filters[0]; i++) {
        if (check_skips(i, 3)) /* one of each order stays */
            continue;
        const truth t = {.white = 1.0, .bias_instability = 0.4, .filter = filters[i]};
        const imk_identification r = identify_truth(&t, 200000, 0.01, 1, 20 + i);
        CHECK_RELATIVE(r.filter.bandwidth, filters[i].bandwidth, 0.05);
        /* Five stated sigmas, and 1 % for the filter's own uncertainty. */
        CHECK_CLOSE(r.term[IMK_NOISE_WHITE].value, 1.0, 5 * r.term[IMK_NOISE_WHITE].sigma + 0.01);
        CHECK_CLOSE(r.term[IMK_NOISE_BIAS_INSTABILITY].value, 0.4,
                    5 * r.term[IMK_NOISE_BIAS_INSTABILITY].sigma);
    }
}

/* Units scale through, a constant changes nothing. */
static void test_scale_and_offset(void **state)
{
    (void)state;
    enum { N = 50000 };
    const truth t = {.white = 1.0, .bias_instability = 1.0, .random_walk = 0.05};
    double *x = make_record(&t, N, 0.1, 5, 1);
    const imk_identification one = identify(x, N, 0.1);
    for (size_t i = 0; i < N; i++)
        x[i] = (x[i] + 1000) * 0x1p-20;
    const imk_identification two = identify(x, N, 0.1);
    for (int term = 0; term < IMK_NOISE_TERMS; term++) {
        assert_int_equal(one.term[term].present, two.term[term].present);
        /* The searches stop at 1e-4 of a step; adding 1000 costs 1e-13. */
        CHECK_CLOSE(two.term[term].value * 0x1p20, one.term[term].value,
                    1e-5 * one.term[term].value);
        CHECK_CLOSE(two.term[term].upper * 0x1p20, one.term[term].upper,
                    1e-3 * one.term[term].upper);
    }
    free(x);
}

/* The expected Allan variance of an identified model is the sum of its terms'. */
static void test_expected_variance(void **state)
{
    (void)state;
    imk_identification r;
    memset(&r, 0, sizeof r);
    r.term[IMK_NOISE_WHITE].value = 2;
    r.term[IMK_NOISE_RAMP].value = 0.5;
    r.gauss_markov_count = 1;
    r.gauss_markov[0].sigma.value = 3;
    r.gauss_markov[0].correlation_time.value = 10;
    const double tau = 5,
                 gauss_markov =
                     imk_gauss_markov_sampled_allan_variance((imk_gauss_markov){3, 10}, 0.1, 50);
    CHECK_RELATIVE(imk_identification_allan_variance(&r, 0.1, 50, -1),
                   4 / tau + 0.25 * tau * tau / 2 + gauss_markov, 1e-12);
    CHECK_RELATIVE(imk_identification_allan_variance(&r, 0.1, 50, IMK_NOISE_WHITE), 4 / tau, 1e-12);
}

static void test_record_checks(void **state)
{
    (void)state;
    enum { N = 20000 };
    const truth t = {.white = 0.1};
    double *x = make_record(&t, N, 0.01, 9, 1);
    double *y = malloc(N * sizeof *y);
    for (size_t i = 0; i < N; i++)
        y[i] = 0.25 * floor(x[i] / 0.25 + 0.5); /* noise of 1, step of 0.25 */
    imk_identification r = identify(y, N, 0.01);
    CHECK_RELATIVE(r.resolution, 0.25, 1e-12);
    assert_false(r.verdict & (IMK_VERDICT_COARSE | IMK_VERDICT_FROZEN | IMK_VERDICT_SATURATED));
    for (size_t i = 0; i < N; i++)
        y[i] = floor(x[i] / 4 + 0.1);
    r = identify(y, N, 0.01);
    assert_true(r.verdict & IMK_VERDICT_COARSE);
    for (size_t i = 0; i < N; i++)
        y[i] = x[i] > 1 ? 1 : x[i];
    r = identify(y, N, 0.01);
    assert_true(r.verdict & IMK_VERDICT_SATURATED);
    for (size_t i = 0; i < N; i++)
        y[i] = x[i - i % 4];
    r = identify(y, N, 0.01);
    assert_true(r.verdict & IMK_VERDICT_FROZEN);
    for (size_t i = 0; i < N; i++)
        y[i] = x[i] + 3 * exp(-(double)i / 1500);
    r = identify(y, N, 0.01);
    assert_true(r.verdict & IMK_VERDICT_WARM_UP);
    free(x), free(y);
}

/* Records that no sensor makes: whatever comes out is finite and a valid model, or a refusal. */
static void test_odd_records(void **state)
{
    (void)state;
    enum { KINDS = 10 };
    static const size_t sizes[] = {256, 257, 1000, 5003};
    static const double scales[] = {1, 1e-230, 1e210};
    static imk_model model;
    for (size_t trial = 0; trial < KINDS * 4 * 3; trial++) {
        const size_t n = sizes[trial / KINDS % 4];
        const double scale = scales[trial / KINDS / 4];
        if (scale != 1 && n >= (check_quick() ? 1000 : 5000))
            continue;
        double *x = malloc(n * sizeof *x);
        imk_random_normals(imk_random_seeded(trial), 1, 0, n, x);
        for (size_t i = 0; i < n; i++) {
            const double k = (double)i,
                         odd[KINDS] = {
                             x[i], i == n / 2,        i > n / 2,  sin(0.7 * k),    x[i] > 0,
                             k,    floor(0.3 * x[i]), x[i] + 1e9, (double)(i % 2), exp(-k / 20)};
            x[i] = odd[trial % KINDS] * scale;
        }
        imk_identify_settings settings = imk_identify_default();
        settings.dt = 0.01;
        const size_t size = imk_identify_workspace_size(n);
        void *workspace = malloc(size);
        imk_identification r;
        memset(&r, 0, sizeof r);
        imk_error error;
        const imk_status status =
            imk_identify_channel(&settings, n, x, &r, workspace, size, &error);
        /* A pure tone has no noise, at half the sample rate neither, nor has a pure decay: refused,
         * if nothing that looks like noise is found in rounding errors. The others do, or look as
         * if they had. */
        const size_t kind = trial % KINDS;
        if (status != IMK_ERROR_NO_CONVERGENCE || (kind != 3 && kind != 8 && kind != 9))
            CHECK_STATUS(status, IMK_OK);
        if (status == IMK_OK) {
            imk_model_default(&model);
            imk_identification_store(&r, &model, IMK_GYRO, 0);
            CHECK_STATUS(imk_model_validate(&model, &error), IMK_OK);
        }
        free(workspace);
        free(x);
    }
}

static void test_store(void **state)
{
    (void)state;
    const truth t = {.white = 1e-3, .bias_instability = 1e-3, .resonance = {0.05, 20, 10}};
    const imk_identification r = identify_truth(&t, 100000, 0.01, 2, 1);
    static imk_model model;
    imk_model_default(&model);
    for (int axis = 0; axis < 3; axis++) {
        imk_identification_store(&r, &model, IMK_GYRO, axis);
        imk_identification_store(&r, &model, IMK_ACCEL, axis);
    }
    imk_error error;
    CHECK_STATUS(imk_model_validate(&model, &error), IMK_OK);
    assert_true(model.accel.noise.white.value[2] == r.term[IMK_NOISE_WHITE].value);
    assert_int_equal(model.gyro.noise.resonance_count, 1);
    bool found = false;
    for (int i = 0; i < model.gyro_evidence.interval_count; i++) {
        const imk_interval *interval = &model.gyro_evidence.interval[i];
        if (strcmp(interval->key, "noise.rate_random_walk") == 0) {
            found = true;
            assert_true(interval->upper.value[1] == r.term[IMK_NOISE_RANDOM_WALK].upper);
        }
    }
    assert_true(found);
}

static void test_bad_arguments(void **state)
{
    (void)state;
    enum { N = 1000 };
    static double x[N];
    imk_identify_settings settings = imk_identify_default();
    settings.dt = 0.01;
    const size_t size = imk_identify_workspace_size(N);
    void *workspace = malloc(size);
    imk_identification result = {.mean = 42};
    imk_error error;
    CHECK_STATUS(imk_identify_channel(&settings, N, x, &result, workspace, size, &error),
                 IMK_ERROR_CONSTANT);
    CHECK_STATUS(imk_identify_channel(&settings, 255, x, &result, workspace, size, &error),
                 IMK_ERROR_TOO_SHORT);
    x[77] = HUGE_VAL;
    CHECK_STATUS(imk_identify_channel(&settings, N, x, &result, workspace, size, &error),
                 IMK_ERROR_NOT_FINITE);
    assert_int_equal(error.index, 77);
    x[77] = 1;
    CHECK_STATUS(imk_identify_channel(&settings, N, x, &result, workspace, size - 1, &error),
                 IMK_ERROR_WORKSPACE);
    settings.dt = 0;
    CHECK_STATUS(imk_identify_channel(&settings, N, x, &result, workspace, size, &error),
                 IMK_ERROR_RANGE);
    settings.cookie = 0;
    CHECK_STATUS(imk_identify_channel(&settings, N, x, &result, workspace, size, &error),
                 IMK_ERROR_UNINITIALISED);
    assert_true(result.mean == 42);
    free(workspace);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_coverage),
        cmocka_unit_test(test_white_only),
        cmocka_unit_test(test_quantization),
        cmocka_unit_test(test_quantization_ends),
        cmocka_unit_test(test_gauss_markov),
        cmocka_unit_test(test_fast_gauss_markov),
        cmocka_unit_test(test_ramp),
        cmocka_unit_test(test_shapes),
        cmocka_unit_test(test_strong_slow_tone),
        cmocka_unit_test(test_strong_filters),
        cmocka_unit_test(test_scale_and_offset),
        cmocka_unit_test(test_expected_variance),
        cmocka_unit_test(test_record_checks),
        cmocka_unit_test(test_odd_records),
        cmocka_unit_test(test_store),
        cmocka_unit_test(test_bad_arguments),
    };
    return cmocka_run_group_tests_name("identify", tests, NULL, NULL);
}
