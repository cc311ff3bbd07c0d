/* SPDX-License-Identifier: Apache-2.0 */
/* Where the verdicts on a record begin: repeated samples, and samples that pile up at a limit. */
#include "check.h"

#include "identify/records/screen_internal.h"
#include "imukit/identify.h"
#include "imukit/random.h"

enum { N = 2000 };

static double samples[N];

/* More than two in five samples repeat the one before. */
static void test_frozen(void **state)
{
    (void)state;
    for (int percent = 30; percent <= 50; percent += 2) {
        imk_random_normals(imk_random_seeded(3), 1, 0, N, samples);
        for (size_t i = 1; i < N; i++)
            if ((i * (size_t)percent) % 100 < (size_t)percent)
                samples[i] = samples[i - 1];
        const unsigned verdict = imki_record_verdict(N, samples, 0, 1);
        if (percent != 40)
            assert_int_equal((verdict & IMK_VERDICT_FROZEN) != 0, percent > 40);
    }
}

/* Ten samples on the extreme value and three for each on the next one, some of them in a row. */
static void test_piled_up(void **state)
{
    (void)state;
    const double step = 0.25;
    for (size_t beside = 0; beside < 20; beside++)
        for (size_t on = 3; on < 80; on++) {
            for (size_t i = 0; i < N; i++)
                samples[i] = i % 2 ? 0.0 : step;
            for (size_t i = 0; i < on; i++)
                samples[100 + i] = 2.0;
            for (size_t i = 0; i < beside; i++)
                samples[1000 + 3 * i] = 2.0 - 0.9 * step;
            assert_int_equal(imki_record_sticks(N, samples, 2.0, -1, step), on > 10 + 3 * beside);
        }
    /* One by one they are peaks, however many. */
    for (size_t i = 0; i < N; i++)
        samples[i] = i % 4 < 2 ? 2.0 : 0.0;
    assert_false(imki_record_sticks(N, samples, 2.0, -1, step));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_frozen),
        cmocka_unit_test(test_piled_up),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
