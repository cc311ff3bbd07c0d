/* SPDX-License-Identifier: Apache-2.0 */
/* The fast end of the spectrum: resonances whose shape no single one has, and none where none is.
 * `experiments/spurious_resonances.c` and `experiments/twin_envelope.c` do the same at length. */
#include "check.h"

#include "imukit/identify.h"

#include <stdlib.h>

static const double DT = 0.01;
enum { N = 1 << 17 };

/* White noise of density 1 through a filter, bias instability, and resonances. */
static double *make_record(size_t n, uint64_t seed, imk_low_pass filter, double instability,
                           size_t count, const imk_resonance *resonances)
{
    double *x = calloc(n, sizeof *x);
    const imk_random random = imk_random_seeded(seed);
    imk_arma_state state;
    assert_int_equal(imk_filtered_white_start(&state, 1, filter, DT, random, (uint64_t)1 << 40),
                     IMK_OK);
    imk_arma_add(&state, n, x);
    imk_flicker_state *flicker = malloc(sizeof *flicker);
    assert_int_equal(
        imk_flicker_start(flicker, (imk_flicker){instability, 0}, DT, random, (uint64_t)2 << 40),
        IMK_OK);
    imk_flicker_add(flicker, n, x);
    free(flicker);
    for (size_t i = 0; i < count; i++) {
        assert_int_equal(
            imk_resonance_start(&state, resonances[i], DT, random, (uint64_t)(3 + i) << 40),
            IMK_OK);
        imk_arma_add(&state, n, x);
    }
    return x;
}

static imk_identification identify(size_t n, double *x)
{
    imk_identify_settings settings = imk_identify_default();
    settings.dt = DT;
    const size_t size = imk_identify_workspace_size(n);
    void *workspace = malloc(size);
    imk_identification r;
    CHECK_STATUS(imk_identify_channel(&settings, n, x, &r, workspace, size, NULL), IMK_OK);
    free(workspace);
    free(x);
    return r;
}

/* Two resonances whose half-power widths overlap, 24 and 13 times the white noise at their peaks:
 * the model's spectrum is right everywhere, which one resonance and a filter are not. The measured
 * mean over an octave, some 2e4 coefficients, has a standard deviation of 1 %, the model's is less:
 * 6 % is more than five. */
static void test_overlapping(void **state)
{
    (void)state;
    const imk_resonance truth[2] = {{5, 19, 20}, {5, 21.5, 12}};
    const imk_low_pass filter = {60, 0};
    const imk_identification r = identify(N, make_record(N, 1, filter, 0.5, 2, truth));
    assert_true(r.resonance_count >= 2);
    assert_true(r.verdict & IMK_VERDICT_RESONANCE);
    for (double f = 2; f < 49; f *= 1.04) {
        double expected = imk_filtered_white_sampled_spectrum(1, filter, DT, f) +
                          imk_flicker_sampled_spectrum((imk_flicker){0.5, 0}, DT, f);
        double found =
            imk_filtered_white_sampled_spectrum(r.term[IMK_NOISE_WHITE].value, r.filter, DT, f) +
            imk_flicker_sampled_spectrum((imk_flicker){r.term[IMK_NOISE_BIAS_INSTABILITY].value, 0},
                                         DT, f);
        for (int i = 0; i < 2; i++)
            expected += imk_resonance_sampled_spectrum(truth[i], DT, f);
        for (int i = 0; i < r.resonance_count; i++)
            found += imk_resonance_sampled_spectrum(r.resonance[i], DT, f);
        /* Around the peaks a few hundred coefficients decide. */
        CHECK_RELATIVE(found, expected, f > 17 && f < 24 ? 0.2 : 0.06);
    }
    /* Intervals hold with a filter and resonances beside the white noise: 2 widths of 95 % are
     * nearly four sigmas, and the seed is fixed. */
    const imk_estimate *white = &r.term[IMK_NOISE_WHITE];
    CHECK_CLOSE(white->value, 1, white->upper - white->lower);
}

/* Nothing is added to white noise, flicker and a filter, nor to one resonance. By chance a
 * resonance comes up once in 1e4 records or less (experiments/spurious_resonances.c: none in
 * thousands): two in these 16 would not be chance. */
static void test_nothing_added(void **state)
{
    (void)state;
    const imk_resonance one = {5, 20, 16};
    int spurious = 0;
    for (uint64_t seed = 1; seed <= (check_quick() ? 4 : 8); seed++)
        for (size_t there = 0; there < 2; there++) {
            const size_t n = N / 4;
            const imk_low_pass filter = {61, 0};
            const imk_identification r = identify(n, make_record(n, seed, filter, 1, there, &one));
            spurious += r.resonance_count != (int)there;
        }
    assert_true(spurious < 2);
}

/* The interval of white noise behind a second-order filter knows that the filter's two parameters
 * were fitted: of 16 intervals of 95 % five or more miss once in 1e3 fixed seeds' worth, which were
 * not chosen; with the filter held, a quarter of all missed. */
static void test_interval_with_filter(void **state)
{
    (void)state;
    int held = 0;
    const imk_low_pass filter = {40, 0.7};
    for (uint64_t seed = 101; seed <= 116; seed++) {
        const size_t n = N / 4;
        const imk_identification r = identify(n, make_record(n, seed, filter, 0.5, 0, NULL));
        const imk_estimate *white = &r.term[IMK_NOISE_WHITE];
        held += white->lower <= 1 && white->upper >= 1;
    }
    assert_true(held >= 11);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_overlapping),
        cmocka_unit_test(test_nothing_added),
        cmocka_unit_test(test_interval_with_filter),
    };
    return cmocka_run_group_tests_name("fast_shape", tests, NULL, NULL);
}
