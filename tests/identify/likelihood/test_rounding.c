/* SPDX-License-Identifier: Apache-2.0 */
/* Estimates do not depend on rounding: a record whose samples are disturbed by their last bit, or
 * are in another unit, has the same estimates to 1e-9. A fit that stops where the likelihood no
 * longer tells steps apart has them to 1e-7. */
#include "check.h"
#include "identify/identify_values.h"

#include "imukit/random.h"

#include <string.h>

enum { N = 20000 };
static const double dt = 0.01; /* of identify_values() */
/* Of a value; where a term is next to nothing, of a standard deviation, which is then larger. */
static const double same = 1e-9;

typedef struct noise {
    double white, bias_instability, random_walk, ramp;
    imk_gauss_markov gauss_markov;
    imk_resonance resonance;
    imk_low_pass filter;
    double step; /* of the samples; 0: none */
} noise;

static void make(const noise *t, uint64_t seed, double *x)
{
    const imk_random random = imk_random_seeded(seed);
    memset(x, 0, N * sizeof *x);
    if (t->filter.bandwidth > 0) {
        imk_arma_state state;
        CHECK_STATUS(imk_filtered_white_start(&state, t->white, t->filter, dt, random, 1), IMK_OK);
        imk_arma_add(&state, N, x);
    } else {
        imk_white_state state;
        CHECK_STATUS(imk_white_start(&state, t->white, dt, random, 1), IMK_OK);
        imk_white_add(&state, N, x);
    }
    if (t->bias_instability > 0) {
        imk_flicker_state state;
        CHECK_STATUS(
            imk_flicker_start(&state, (imk_flicker){t->bias_instability, 0}, dt, random, 2),
            IMK_OK);
        imk_flicker_add(&state, N, x);
    }
    if (t->random_walk > 0) {
        imk_random_walk_state state;
        CHECK_STATUS(imk_random_walk_start(&state, t->random_walk, dt, random, 3), IMK_OK);
        imk_random_walk_add(&state, N, x);
    }
    if (t->resonance.sigma > 0) {
        imk_arma_state state;
        CHECK_STATUS(imk_resonance_start(&state, t->resonance, dt, random, 4), IMK_OK);
        imk_arma_add(&state, N, x);
    }
    if (t->gauss_markov.sigma > 0) {
        imk_gauss_markov_state state;
        CHECK_STATUS(imk_gauss_markov_start(&state, t->gauss_markov, dt, random, 5), IMK_OK);
        imk_gauss_markov_add(&state, N, x);
    }
    imk_ramp_add(t->ramp, dt, 0, N, x);
    for (size_t i = 0; t->step > 0 && i < N; i++)
        x[i] = t->step * round(x[i] / t->step);
}

static void compare_values(const char *name, double one, double other, double sigma)
{
    const double most = fmax(fmax(fabs(one), fabs(other)), sigma);
    if (one == other || fabs(one - other) <= same * most)
        return;
    print_error("%s: %.17g and %.17g\n", name, one, other);
    fail();
}

static void compare(const imk_estimate *one, const imk_estimate *other, double factor)
{
    assert_int_equal(one->present, other->present);
    const double sigma = fmax(one->sigma, 0.25 * (one->upper - one->lower));
    compare_values("value", one->value, other->value / factor, sigma);
    compare_values("sigma", one->sigma, other->sigma / factor, 0);
    compare_values("lower", one->lower, other->lower / factor, sigma);
    compare_values("upper", one->upper, other->upper / factor, sigma);
    compare_values("free value", one->free_value, other->free_value / factor, sigma);
}

static void compare_all(const imk_identification *one, const imk_identification *other,
                        double factor)
{
    assert_int_equal(one->verdict, other->verdict);
    assert_int_equal(one->ambiguous, other->ambiguous);
    assert_int_equal(one->gauss_markov_count, other->gauss_markov_count);
    assert_int_equal(one->resonance_count, other->resonance_count);
    for (int term = 0; term < IMK_NOISE_TERMS; term++)
        compare(&one->term[term], &other->term[term], factor);
    for (int i = 0; i < one->gauss_markov_count; i++) {
        compare(&one->gauss_markov[i].sigma, &other->gauss_markov[i].sigma, factor);
        compare(&one->gauss_markov[i].correlation_time, &other->gauss_markov[i].correlation_time,
                1);
    }
    for (int i = 0; i < one->resonance_count; i++) {
        const imk_resonance *a = &one->resonance[i], *b = &other->resonance[i];
        compare_values("resonance", a->sigma, b->sigma / factor, 0);
        compare_values("frequency", a->frequency, b->frequency, 0);
        compare_values("quality", a->q, b->q, 0);
    }
    compare_values("bandwidth", one->filter.bandwidth, other->filter.bandwidth, 0);
    compare_values("damping", one->filter.damping, other->filter.damping, 0);
}

static const noise noises[] = {
    {.white = 1e-3, .bias_instability = 3e-4, .random_walk = 2e-4},
    {.white = 1e-3, .bias_instability = 1e-3, .ramp = 1e-5},
    {.white = 1e-3, .random_walk = 1e-3, .step = 0.01},
    {.white = 1e-3, .gauss_markov = {2e-3, 3}},
    {.white = 1e-3, .bias_instability = 5e-4, .filter = {12, 0.7}},
    {.white = 1e-3, .random_walk = 3e-4, .resonance = {5e-3, 21, 4}},
};
enum { NOISES = sizeof noises / sizeof noises[0] };

/* In another unit every product and every sum is rounded otherwise. */
static void estimates_scale_with_the_unit(void **state)
{
    (void)state;
    static double x[N], y[N];
    const double factor = 57.29577951308232; /* degrees of a radian */
    for (size_t i = 0; i < NOISES; i++) {
        make(&noises[i], 1021 + i, x);
        for (size_t k = 0; k < N; k++)
            y[k] = factor * x[k];
        const imk_identification one = identify_values(true, N, x);
        const imk_identification other = identify_values(true, N, y);
        compare_all(&one, &other, factor);
    }
}

/* The last bit of each sample up or down; a record in steps would lose them. */
static void the_last_bit_does_not_matter(void **state)
{
    (void)state;
    static double x[N], y[N];
    for (size_t i = 0; i < NOISES; i++) {
        if (noises[i].step > 0)
            continue;
        make(&noises[i], 1121 + i, x);
        for (size_t k = 0; k < N; k++)
            y[k] = nextafter(x[k], k * k % 7 < 3 ? HUGE_VAL : -HUGE_VAL);
        const imk_identification one = identify_values(true, N, x);
        const imk_identification other = identify_values(true, N, y);
        compare_all(&one, &other, 1);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(estimates_scale_with_the_unit),
        cmocka_unit_test(the_last_bit_does_not_matter),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
