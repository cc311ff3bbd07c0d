/* SPDX-License-Identifier: Apache-2.0 */
/* The test whether a measured Allan deviation agrees with the identified model: its false alarms,
 * what it finds, and the degrees of freedom it takes from the model. */
#include "check.h"

#include "identify/allan/allan_fit_internal.h"
#include "identify/identify_values.h"
#include "identify/likelihood/identify_internal.h"
#include "imukit/allan.h"
#include "imukit/samples.h"

#include <stdlib.h>
#include <string.h>

/* Variance of one point as of the whole covariance matrix, for all kinds of terms. Half the nodes
 * are used: 3 %. */
static void test_variance_of_one(void **state)
{
    (void)state;
    static const size_t factors[] = {1, 4, 32, 1000}, length = 20000;
    const imk_allan_table table = {
        .dt = 0.01, .count = 4, .factors = factors, .record_count = 1, .lengths = &length};
    imk_allan_noise noise = {.term = {0.01, 1, 1, 0.2, 0.01},
                             .gauss_markov_count = 1,
                             .sinusoid_count = 1,
                             .resonance_count = 1};
    noise.gauss_markov[0] = (imk_gauss_markov){0.5, 3};
    noise.sinusoid[0] = (imk_sinusoid){1, 7};
    noise.resonance[0] = (imk_resonance){3, 20, 10};
    double covariance[16];
    const size_t size = imk_allan_covariance_workspace_size(4, 8);
    void *workspace = malloc(size);
    CHECK_STATUS(imk_allan_covariance(&table, &noise, covariance, workspace, size), IMK_OK);
    for (size_t i = 0; i < 4; i++)
        CHECK_RELATIVE(imki_allan_variance_of_one(&noise, 0.01, length, factors[i], 1),
                       covariance[5 * i], 0.03);
    free(workspace);
}

/* Records of white noise and random walk against the truth at n/9 and n/30: outside the range of
 * 1 in 1000 on each side are at most 2 in 1000. Of 10000 that is 20, standard deviation 4.5; the
 * limit is five of them off. A range that nothing leaves would be of no use: 2 at least, of an
 * expected 10 above. */
static void test_likely_range(void **state)
{
    (void)state;
    enum { N = 288, CASES = 4 };
    static const size_t factor[CASES] = {32, 9, 32, 9};
    const uint32_t records = check_runs(10000);
    size_t outside[CASES] = {0};
    double edf[CASES], expected[CASES], y[N], sums[N + 1];
    for (size_t i = 0; i < CASES; i++) {
        const imk_allan_noise noise = {.term = {0, i < 2, 0, i >= 2, 0}};
        expected[i] = imk_allan_noise_variance(&noise, 1, factor[i]);
        edf[i] =
            2 * expected[i] * expected[i] / imki_allan_variance_of_one(&noise, 1, N, factor[i], 1);
    }
    for (uint32_t record = 0; record < records; record++) {
        imk_random_normals(imk_random_seeded(31), record, 0, N, y);
        for (size_t i = 0; i < CASES; i++) {
            double walk = 0, variance;
            for (size_t j = 0; j < N && i == 2; j++)
                y[j] = walk += y[j];
            imk_allan_sums(N, y, sums, NULL);
            CHECK_STATUS(imk_allan_variances(IMK_ALLAN_OVERLAPPING, N, sums, 1, &factor[i],
                                             &variance, NULL, NULL),
                         IMK_OK);
            outside[i] += !imki_allan_is_likely(variance / expected[i], edf[i], 1e-3);
        }
    }
    for (size_t i = 0; i < CASES; i++) {
        CHECK_BELOW((double)outside[i], 2e-3 * records + 5 * sqrt(2e-3 * records));
        assert_true(check_quick() || outside[i] >= 2);
    }
}

/* White noise is no misfit, in memory and in one pass: less than one record in 10000, so that three
 * of 80 are one in 1e7. With a noise type that was found at few clusters, one of seven long records
 * was a misfit. */
static void test_white_noise_agrees(void **state)
{
    (void)state;
    enum { SHORT = 60000, LONG = IMK_IDENTIFY_RECORD_LEAST };
    double *x = malloc(LONG * sizeof *x);
    const uint32_t records = check_runs(40);
    size_t misfits = 0;
    for (uint32_t record = 0; record < records; record++) {
        imk_random_normals(imk_random_seeded(32), record, 0, LONG, x);
        imk_identification r = identify_values(false, SHORT, x);
        misfits += r.verdict & IMK_VERDICT_MISFIT ? 1 : 0;
        r = identify_values_in_one_pass(LONG, x);
        misfits += r.verdict & IMK_VERDICT_MISFIT ? 1 : 0;
    }
    assert_true(misfits < 3);
    free(x);
}

/* A resonance is none of the five terms. Where it is not looked for, the deviation is far off at
 * the times below its period, and right at long ones. */
static void test_resonance_disagrees(void **state)
{
    (void)state;
    enum { N = 60000 };
    static double x[N];
    imk_arma_state ringing;
    imk_random_normals(imk_random_seeded(33), 0, 0, N, x);
    CHECK_STATUS(
        imk_resonance_start(&ringing, (imk_resonance){1, 12, 20}, 0.01, imk_random_seeded(33), 7),
        IMK_OK);
    imk_arma_add(&ringing, N, x);
    const imk_identification without = identify_values(false, N, x),
                             with = identify_values(true, N, x);
    assert_true(without.verdict & IMK_VERDICT_MISFIT);
    assert_true(without.valid_from > 0.02);
    assert_false(with.verdict & IMK_VERDICT_MISFIT);
    assert_true(with.five_terms_from > 0.02);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_variance_of_one),
        cmocka_unit_test(test_likely_range),
        cmocka_unit_test(test_white_noise_agrees),
        cmocka_unit_test(test_resonance_disagrees),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
