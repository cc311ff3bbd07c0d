/* SPDX-License-Identifier: Apache-2.0 */
/* The shape of one line of a spectrum: a resonance has its frequency, quality and power, and what
 * cannot be one has none. */
#include "check.h"

#include "identify/likelihood/identify_internal.h"

enum { N = 1 << 14 };
static const double DT = 0.01;
static double cumulative[N + 1];

/* The spectrum of a resonance, on white noise of density `white`, as the transform would see it. */
static void make_spectrum(imk_resonance resonance, double white)
{
    for (int k = 1; k < N; k++)
        cumulative[k + 1] =
            cumulative[k] + white +
            imk_resonance_sampled_spectrum(resonance, DT, (double)k / (2.0 * N * DT));
}

/* The spectrum is exact; what is left is its width in bands, of a fortieth of that of the line. */
static void test_resonance(void **state)
{
    (void)state;
    const imk_resonance made = {3, 12, 8};
    make_spectrum(made, 1e-3);
    imk_resonance found = {0, 12.4, 5};
    assert_true(imki_shape_resonance(&found, 9, N, DT, cumulative));
    CHECK_CLOSE(found.frequency, 12, 0.01);
    CHECK_CLOSE(found.q, 8, 0.1);
    CHECK_CLOSE(found.sigma, 3, 0.02);
}

/* What lies on the stack is not 0 when the next function begins. */
static void fill_stack(void)
{
    volatile double filled[4096];
    for (int i = 0; i < 4096; i++)
        filled[i] = i;
    (void)filled[7];
}

/* A line of ten million samples that is three coefficients wide seems to have a quality above 1e6,
 * the most that a resonance has: it has no power as one, and is none. */
static void test_too_narrow(void **state)
{
    (void)state;
    make_spectrum((imk_resonance){1, 40, 100}, 1);
    imk_resonance found = {5, 40, 4e6};
    fill_stack();
    assert_false(imki_shape_resonance(&found, 4, N, DT, cumulative));
    assert_true(found.q > 1e6);
    assert_true(found.sigma == 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_resonance),
        cmocka_unit_test(test_too_narrow),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
