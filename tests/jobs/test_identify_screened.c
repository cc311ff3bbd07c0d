/* SPDX-License-Identifier: Apache-2.0 */
/* Identification of a record in memory and of the same one in a single pass: the same faults are
 * found, and what is estimated without them is what a sound record gives. */
#include "check.h"

#include "imukit/identify_log.h"
#include "imukit/identify_record.h"
#include "imukit/noise.h"
#include "imukit/random.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Little more than is held in memory, 2^7 3^3 5^4: a length whose transform is quick. */
enum { ROWS = 2160000, SOUND = 0, FAULTY = 1 };
_Static_assert((int)ROWS > (int)IMK_IDENTIFY_RECORD_ADVISED, "identified in one pass");

static const double rate = 100;
static double *samples[2];

static int make_record(void **state)
{
    (void)state;
    const imk_random random = imk_random_seeded(4);
    imk_white_state white;
    imk_flicker_state flicker;
    for (int k = 0; k < 2; k++)
        samples[k] = calloc(ROWS, sizeof(double));
    CHECK_OK(imk_white_start(&white, 1e-3, 1 / rate, random, 1));
    imk_white_add(&white, ROWS, samples[SOUND]);
    CHECK_OK(imk_flicker_start(&flicker, (imk_flicker){2e-4, 0}, 1 / rate, random, 2));
    imk_flicker_add(&flicker, ROWS, samples[SOUND]);
    memcpy(samples[FAULTY], samples[SOUND], ROWS * sizeof(double));
    for (size_t i = 77777; i < ROWS; i += 200000)
        samples[FAULTY][i] += 5;
    return 0;
}

static int drop_record(void **state)
{
    (void)state;
    free(samples[0]);
    free(samples[1]);
    return 0;
}

static imk_identify_log *identify(const double *data, bool in_one_pass)
{
    const char *const name = "gyro_x";
    const imk_identify_log_settings settings = imk_identify_log_default();
    imk_array_source memory;
    imk_record_source source;
    imk_identify_log *log;
    CHECK_OK(imk_array_source_make(1, &name, &data, ROWS, rate, &memory, &source, NULL));
    if (!in_one_pass)
        source.rewind = NULL;
    CHECK_OK(imk_identify_log_run(&source, &settings, NULL, &log, NULL));
    assert_true((imk_even_record_data(&log->record, 0) == NULL) == in_one_pass);
    assert_true(log->screened);
    return log;
}

static void check_same(const imk_screen *a, const imk_screen *b)
{
    assert_int_equal(a->n, b->n);
    assert_int_equal(a->outliers.count, b->outliers.count);
    assert_int_equal(a->outliers.first, b->outliers.first);
    assert_int_equal(a->stuck.count, b->stuck.count);
    assert_int_equal(a->saturated.count, b->saturated.count);
    assert_int_equal(a->steps.count, b->steps.count);
    assert_int_equal(a->steps.first, b->steps.first);
    assert_true(a->warm_up == b->warm_up && a->heavy_tails == b->heavy_tails);
    assert_true(a->noise == b->noise && a->largest_step == b->largest_step);
    assert_true(a->interpolated == b->interpolated && a->sensor_rate[0] == b->sensor_rate[0]);
    assert_true(a->clipped_deviation == b->clipped_deviation && a->core == b->core);
}

/* What is estimated may differ by a part of its standard deviation (test_identify_record.c). */
static void check_white(const imk_identify_log *a, const imk_identify_log *b, double part)
{
    const imk_estimate *x = &a->result[0].term[IMK_NOISE_WHITE];
    const imk_estimate *y = &b->result[0].term[IMK_NOISE_WHITE];
    CHECK_CLOSE(x->value, y->value, part * y->sigma);
    CHECK_CLOSE(x->upper - x->lower, y->upper - y->lower, 0.1 * (y->upper - y->lower));
}

static void test_outliers(void **state)
{
    (void)state;
    imk_identify_log *sound = check_quick() ? NULL : identify(samples[SOUND], true);
    imk_identify_log *whole = check_quick() ? NULL : identify(samples[FAULTY], false);
    imk_identify_log *passing = identify(samples[FAULTY], true);
    assert_int_equal(passing->screen[0].outliers.count, 11);
    if (whole)
        check_same(&whole->screen[0], &passing->screen[0]);
    if (whole)
        check_white(whole, passing, 0.2);
    if (sound)
        check_white(passing, sound, 0.05);
    imk_identify_log_free(sound);
    imk_identify_log_free(whole);
    imk_identify_log_free(passing);
}

/* A jump, and the upper values cut off at two standard deviations of 0.01. */
static void test_jump_and_limit(void **state)
{
    (void)state;
    if (check_quick()) /* one pass is gone in the first test, records in memory in others */
        skip();
    double *x = samples[FAULTY];
    for (size_t i = 0; i < ROWS; i++) {
        const double y = samples[SOUND][i] + (i > 700000 ? 2e-3 : 0);
        x[i] = y > 0.02 ? 0.02 : y;
    }
    imk_identify_log *whole = identify(x, false), *passing = identify(x, true);
    const imk_screen *s = &passing->screen[0];
    check_same(&whole->screen[0], s);
    assert_int_equal(s->steps.count, 1);
    CHECK_CLOSE((double)s->steps.first, 700000, ROWS / 1024.0);
    assert_true(s->saturated.count > 10000 && s->saturation_high == 0.02);
    assert_true(passing->result[0].verdict & IMK_VERDICT_SATURATED);
    check_white(whole, passing, 0.2);
    const imk_estimate *white = &passing->result[0].term[IMK_NOISE_WHITE];
    CHECK_CLOSE(white->value, 1e-3, (white->upper - white->lower) / 2);
    imk_identify_log_free(whole);
    imk_identify_log_free(passing);
}

/* Many samples of four times the noise: kept, and estimated with them in one pass too. */
static void test_tails(void **state)
{
    (void)state;
    if (check_quick()) /* one pass is gone in the first test, records in memory in others */
        skip();
    double *x = samples[FAULTY], normal[64];
    for (size_t i = 0; i < ROWS; i++) {
        if (i % 64 == 0)
            imk_random_normals(imk_random_seeded(9), 0, i, 64, normal);
        x[i] = samples[SOUND][i] + (i * 2654435761u % 1000 < 60 ? 0.04 * normal[i % 64] : 0);
    }
    imk_identify_log *whole = identify(x, false), *passing = identify(x, true);
    assert_true(passing->screen[0].heavy_tails);
    check_same(&whole->screen[0], &passing->screen[0]);
    check_white(whole, passing, 0.2);
    /* sqrt(1 + 0.06 16) */
    const imk_estimate *white = &passing->result[0].term[IMK_NOISE_WHITE];
    CHECK_CLOSE(white->value, 1.4e-3, 4 * white->sigma);
    imk_identify_log_free(whole);
    imk_identify_log_free(passing);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_outliers),
        cmocka_unit_test(test_jump_and_limit),
        cmocka_unit_test(test_tails),
    };
    return cmocka_run_group_tests(tests, make_record, drop_record);
}
