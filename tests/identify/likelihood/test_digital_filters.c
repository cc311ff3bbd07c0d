/* SPDX-License-Identifier: Apache-2.0 */
/* Behind a digital filter, which is of neither first nor second order, resonances describe the
 * shape. The interval of white noise covers what these have of it, but for 2 % where the shape is
 * described badly: the strength at half the sample rate, where white noise and the flicker of the
 * template are alike, moves it by as much. */
#include "check.h"
#include "identify/identify_values.h"
#include "imukit/noise.h"

enum { N = 60000, TAPS = 5, RUNS = 5 };

typedef struct filter {
    size_t taps;
    double tap[TAPS]; /* their sum is 1 */
} filter;

static const filter moving_average_2 = {2, {0.5, 0.5}};
static const filter moving_average_4 = {4, {0.25, 0.25, 0.25, 0.25}};
static const filter binomial = {3, {0.25, 0.5, 0.25}};
static const filter savitzky_golay = {5, {-3 / 35.0, 12 / 35.0, 17 / 35.0, 12 / 35.0, -3 / 35.0}};

/* White noise of strength 1 at 100 Hz behind the filter. */
static void make(const filter *f, uint32_t run, double *x)
{
    static double white[N + TAPS];
    imk_random_normals(imk_random_seeded(59), imk_stream(run, 1, 0, 0), 0, N + TAPS, white);
    for (size_t i = 0; i < N; i++) {
        x[i] = 0;
        for (size_t k = 0; k < f->taps; k++)
            x[i] += 10 * f->tap[k] * white[i + k];
    }
}

/* Intervals that hold, of RUNS; that they are narrow is checked. */
static int count_held(const filter *f)
{
    static double x[N];
    int held = 0;
    for (uint32_t run = 0; run < RUNS; run++) {
        make(f, run, x);
        const imk_identification r = identify_values(true, N, x);
        const imk_estimate *white = &r.term[IMK_NOISE_WHITE];
        assert_true(white->present);
        assert_true(white->upper < 1.2 && white->lower > 0.84);
        held += white->lower <= 1.02 && 0.98 <= white->upper;
    }
    return held;
}

static void test_white_noise(void **state)
{
    (void)state;
    static const filter *const filters[] = {&moving_average_2, &moving_average_4, &binomial,
                                            &savitzky_golay};
    for (size_t i = 0; i < sizeof filters / sizeof filters[0]; i++)
        if (!check_skips(i, 3))
            assert_true(count_held(filters[i]) >= RUNS - 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_white_noise)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
