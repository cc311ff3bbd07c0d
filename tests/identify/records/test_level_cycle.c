/* SPDX-License-Identifier: Apache-2.0 */
/* A level that goes up and down, and a jump that may be one: how often chance looks like them, and
 * how strong they must be, in records like half an hour with bias instability. */
#include "check.h"

#include "identify/screen/screener_internal.h"
#include "imukit/noise.h"
#include "imukit/random.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { M = 256, LONG = 1024, ROOM = 20000 };

static const double pi = 3.14159265358979324;
static double mean[LONG], room[ROOM];

/* Means with white noise of 1, flicker and walk. */
static void make(uint32_t run, size_t count, double flicker, double walk)
{
    static imk_white_state w;
    static imk_flicker_state f;
    static imk_random_walk_state k;
    const imk_random random = imk_random_seeded(8);
    memset(mean, 0, sizeof mean);
    imk_white_start(&w, 1, 1, random, imk_stream(run, 1, 0, 0));
    imk_white_add(&w, count, mean);
    imk_flicker_start(&f, (imk_flicker){flicker, 0}, 1, random, imk_stream(run, 2, 0, 0));
    imk_flicker_add(&f, count, mean);
    imk_random_walk_start(&k, walk, 1, random, imk_stream(run, 3, 0, 0));
    imk_random_walk_add(&k, count, mean);
}

static bool look(double significance, imki_cycle *cycle)
{
    assert_true(imki_cycle_room(M) <= ROOM);
    return imki_cycle_find(M, mean, 0, significance, room, cycle);
}

/* Of white noise, flicker, walk, all of them, and flicker with a ramp and with a jump, at most one
 * in twenty has a cycle at 5 %: of 600 more than 60 have a chance of 3e-7. At 1e-4 there is none:
 * one in 600 has a chance of 6 %, three of 3e-5. */
static void test_no_cycle(void **state)
{
    (void)state;
    static const double flicker[] = {0, 3, 0, 3, 3, 3}, walk[] = {0, 0, 1, 0.2, 0, 0};
    const uint32_t runs = check_runs(100);
    uint32_t often = 0, seldom = 0;
    for (uint32_t kind = 0; kind < 6; kind++)
        for (uint32_t run = 0; run < runs; run++) {
            imki_cycle cycle;
            make(run * 6 + kind, M, flicker[kind], walk[kind]);
            for (size_t i = 0; i < M; i++)
                mean[i] += kind == 4 ? 0.1 * (double)i : kind == 5 && i > M / 3 ? 9 : 0;
            often += look(0.05, &cycle);
            seldom += look(1e-4, &cycle);
        }
    assert_true(often <= 60 * runs / 100);
    assert_true(seldom < 3);
}

/* A cycle of five times the bias instability, three to twenty periods in the record. */
static void test_cycle(void **state)
{
    (void)state;
    enum { RUNS = 20 };
    static const double periods[] = {3, 5.3, 12, 20.6};
    for (uint32_t k = 0; k < 4; k++) {
        uint32_t found = 0;
        for (uint32_t run = 0; run < RUNS; run++) {
            imki_cycle cycle;
            make(1020 + run, M, 1, 0);
            for (size_t i = 0; i < M; i++)
                mean[i] += 5 * sin(2 * pi * periods[k] * ((double)i + 0.5) / M + 0.3 * run);
            if (!look(1e-3 / 3, &cycle))
                continue;
            found++;
            CHECK_CLOSE(cycle.periods, periods[k], 0.25);
            CHECK_CLOSE(cycle.amplitude, 5, 2.5);
        }
        assert_true(found >= 0.8 * RUNS);
    }
}

static imki_jump most_likely(void)
{
    size_t place[IMK_SCREEN_STEPS];
    double size[IMK_SCREEN_STEPS], gain;
    imki_jump possible;
    assert_true(imki_jumps_room(LONG) <= ROOM);
    imki_jumps_find(LONG, mean, 0, 1e-3 / 3, room, IMK_SCREEN_STEPS, place, size, &gain, &possible);
    return possible;
}

/* The most likely jump is above the 14 that are told in one sound record of ten, and in most with a
 * jump of three times the bias instability. */
static void test_possible_jump(void **state)
{
    (void)state;
    const uint32_t runs = check_runs(60);
    uint32_t sound = 0, jumps = 0;
    for (uint32_t run = 0; run < runs; run++) {
        make(run, LONG, 1, 0);
        sound += most_likely().square > 14;
        make(run, LONG, 1, 0);
        const size_t place = 300 + 7 * run;
        for (size_t i = place; i < LONG; i++)
            mean[i] += 4;
        const imki_jump jump = most_likely();
        jumps += jump.square > 14 || jump.place == 0;
    }
    assert_true(sound <= runs / 4); /* a tenth expected; more have a chance of 1e-4 */
    assert_true(jumps >= runs / 2);
}

/* Vibration of eight sigma that the means alias hides no jump, nor is it one. */
static void test_jump_and_tone(void **state)
{
    (void)state;
    for (uint32_t run = 0; run < 8; run++) {
        size_t place[IMK_SCREEN_STEPS] = {0};
        double size[IMK_SCREEN_STEPS], gain;
        imki_jump possible;
        make(run, LONG, 0, 0);
        for (size_t i = 0; i < LONG; i++)
            mean[i] += 9.8 + 8 * sin(2 * pi * (0.3 + 0.01 * run) * (double)i) +
                       (run < 6 && i >= 500 ? 5 : 0);
        const size_t count = imki_jumps_find(LONG, mean, 0, 1e-3, room, IMK_SCREEN_STEPS, place,
                                             size, &gain, &possible);
        assert_int_equal(count, run < 6);
        CHECK_CLOSE((double)place[0], run < 6 ? 500 : 0, 1);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_no_cycle),
        cmocka_unit_test(test_cycle),
        cmocka_unit_test(test_possible_jump),
        cmocka_unit_test(test_jump_and_tone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
