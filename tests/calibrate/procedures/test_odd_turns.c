/* SPDX-License-Identifier: Apache-2.0 */
/* Turns by another angle than stated are found where the others tell, and sound ones are kept. */
#include "check.h"

#include "../turns_session.h"

static const double degree = 0.017453292519943295;

static double sigma_of_scale(const session *b, int axis)
{
    for (size_t p = 0; p < b->result.parameter_count; p++)
        if (b->result.parameter[p].term == IMK_MODEL_SCALE_FACTOR &&
            b->result.parameter[p].axis == axis)
            return b->result.sigma[p];
    fail_msg("no scale factor %d", axis);
    return 0.0;
}

/* Sound benches of which something is told. */
static uint32_t told(const turns_plan *plan, uint64_t seed, uint32_t benches)
{
    session *b = session_new();
    uint32_t count = 0;
    for (uint32_t n = 0; n < benches; n++) {
        imk_error error;
        assert_true(turns_run(b, plan, seed, n, &error));
        const imk_turns_findings *f = &b->findings.known_turns;
        count += f->odd > 0 || f->torn[0] + f->torn[1] + f->torn[2] > 0.0;
    }
    session_free(b);
    return count;
}

/* One in 1000 at most, where the placements are as stated; of those that are five times worse, 3
 * in 1000 (turns_odd.c): so many that more have a probability below 1e-6. */
static void test_sound_turns_are_kept(void **state)
{
    (void)state;
    static const turns_plan plans[] = {
        {.pairs = 2, .angle = BENCH_TURN, .placement = 1.7e-3},
        {.pairs = 1, .angle = BENCH_TURN, .placement = 1.7e-3},
        {.pairs = 2, .angle = BENCH_TURN, .placement = 8.5e-3, .stated = 0.2},
        {.pairs = 2, .angle = BENCH_TURN, .placement = 1.7e-3, .one_gyro = true}};
    static const uint32_t most[] = {4, 4, 6, 4};
    for (size_t k = 0; k < sizeof plans / sizeof plans[0]; k++)
        assert_in_range(told(&plans[k], 40 + k, check_runs(160)), 0, most[k]);
    assert_int_equal(told(&plans[0], 3, check_runs(160)), 0);
}

/* 350 deg for the third turn about z: found, named, left out. The scale factors are held as if it
 * had not been made: within 5 sigmas, which are those of 4 and 3 turns of 0.1 deg, and of few
 * degrees of freedom. */
static void test_wrong_turn_is_named(void **state)
{
    (void)state;
    const turns_plan plan = {.pairs = 2,
                             .angle = BENCH_TURN,
                             .placement = 1.7e-3,
                             .off = {{0.0}, {0.0}, {0.0, 0.0, -10.0 * degree}}};
    session *b = session_new();
    for (uint32_t n = 0; n < check_runs(40); n++) {
        imk_error error;
        assert_true(turns_run(b, &plan, 5, n, &error));
        const imk_turns_findings *f = &b->findings.known_turns;
        assert_int_equal(f->odd, 1);
        assert_int_equal(f->odd_turn[0].axis, 2);
        assert_int_equal(f->odd_turn[0].number, 3);
        CHECK_CLOSE(fabs(f->odd_turn[0].angle), BENCH_TURN, 1e-12);
        CHECK_CLOSE(fabs(f->odd_turn[0].read), 350.0 * degree, 6 * 1.7e-3 * sqrt(4.0 / 3.0));
        CHECK_CLOSE(f->freedom, 8.0, 0.0);
        for (int i = 0; i < 3; i++)
            CHECK_BELOW(sigma_of_scale(b, i), 3.0 * 1.7e-3 / BENCH_TURN / sqrt(3.0));
    }
    session_free(b);
}

/* Two of them do not hide each other. */
static void test_two_wrong_turns(void **state)
{
    (void)state;
    const turns_plan plan = {.pairs = 2,
                             .angle = BENCH_TURN,
                             .placement = 1.7e-3,
                             .off = {{10.0 * degree}, {0.0}, {0.0, 0.0, -10.0 * degree}}};
    session *b = session_new();
    imk_error error;
    assert_true(turns_run(b, &plan, 5, 0, &error));
    const imk_turns_findings *f = &b->findings.known_turns;
    assert_int_equal(f->odd, 2);
    assert_int_equal(f->odd_turn[0].axis, 0);
    assert_int_equal(f->odd_turn[0].number, 1);
    assert_int_equal(f->odd_turn[1].axis, 2);
    session_free(b);
}

/* Of two turns, or of two and two, none is known to be the wrong one. */
static void test_too_few_to_tell(void **state)
{
    (void)state;
    const double off = -10.0 * degree;
    const turns_plan plans[] = {
        {.pairs = 1, .angle = BENCH_TURN, .placement = 1.7e-3, .off = {{0.0}, {0.0}, {off}}},
        {.pairs = 2, .angle = BENCH_TURN, .placement = 1.7e-3, .off = {{0.0}, {0.0}, {off, off}}}};
    for (int k = 0; k < 2; k++) {
        session *b = session_new();
        imk_error error;
        assert_true(turns_run(b, &plans[k], 5, 0, &error));
        const imk_turns_findings *f = &b->findings.known_turns;
        assert_int_equal(f->odd, 0);
        CHECK_CLOSE(f->torn[2], -off, 0.02);
        CHECK_CLOSE(f->torn[0] + f->torn[1], 0.0, 0.0);
        session_free(b);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sound_turns_are_kept), cmocka_unit_test(test_wrong_turn_is_named),
        cmocka_unit_test(test_two_wrong_turns), cmocka_unit_test(test_too_few_to_tell)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
