/* SPDX-License-Identifier: Apache-2.0 */
/* Designs moved at random from the default ones, as the experiment `designs` tries thousands of:
 * refused in words, or run, reduced and swept. And designs that it found. */
#include "check.h"

#include "../../experiments/random_designs.h"

#include "imukit/design_file.h"

enum { DESIGNS = 16, SEED = 2 };

/* One design in three is swept here, and none whose sweep takes more internal steps. */
static const double steps_allowed = 2e5;

/* A figure that differs from its closed form, and neither smaller inputs nor more time nor the
 * model itself says why. */
static bool is_unexplained(const design_outcome *outcome)
{
    return outcome->end == DESIGN_SWEPT && outcome->differs && outcome->says == SAYS_NOTHING;
}

/* @return how many were swept */
static int try_moved(const imk_instrument *instrument, int move, void *design)
{
    const int count = (int)check_runs(DESIGNS);
    int refused = 0, swept = 0;
    for (int number = 0; number < count; number++) {
        design_outcome outcome;
        random_design(instrument, move, number, SEED, design);
        try_design(instrument, design,
                   number % 3 != 0 || check_skips((size_t)number, 2) ? 0.0 : steps_allowed,
                   &outcome);
        refused += outcome.end == DESIGN_REFUSED;
        swept += outcome.end == DESIGN_SWEPT;
        if (outcome.end == DESIGN_WRONG || is_unexplained(&outcome))
            fail_msg("build/experiments/designs 1 %d %s %s %d: %s %s", SEED, instrument->name,
                     move_names[move], number, outcome.wrong,
                     outcome.differs ? "a figure differs from its closed form" : "");
    }
    CHECK_BELOW(refused, 3 * count / 4); /* the test is of designs, not of refusals */
    return swept;
}

static void moved_designs_are_refused_in_words_or_agree(void **state)
{
    int swept = 0;
    (void)state;
    for (size_t n = 0; n < imk_instrument_count(); n++) {
        const imk_instrument *instrument = imk_instrument_get(n);
        void *design = malloc(instrument->design_size);
        assert_non_null(design);
        for (int move = 0; move < MOVES; move++)
            swept += try_moved(instrument, move, design);
        free(design);
    }
    CHECK_BELOW(30, swept);
}

/* Their readings would be at the end of the range at rest, where no figure of the error model
 * holds. By hand: the coupling of the fork reads as itself, 326.8 of 150 deg/s; the accelerometer's
 * bias is 5.1 of 5 g; 0.9 rad of phase are more than 1e-3 deg/s; a spring of 9.76e-5 N m/rad
 * balances 5.11e-6 N m at the stop of 3 deg; torquers of 9e-5 N m do not balance 1e-4 N m. A phase
 * of 2 rad is beyond the table of fields. */
static void designs_at_the_end_of_their_range_are_refused(void **state)
{
    static const struct {
        const char *text, *field;
    } cases[] = {
        {"instrument: tuning_fork\ndamping_coupling: -326.8 deg/s", "output.range"},
        {"instrument: mems_accelerometer\nbias: {fixed: 5.1 g}", "output.range"},
        {"instrument: fibre_optic\nphase: {fixed: 2 rad}\nloop: {range: 1e-3 deg/s}",
         "phase.fixed"},
        {"instrument: fibre_optic\nphase: {fixed: 0.9 rad}\nloop: {range: 1e-3 deg/s}",
         "loop.range"},
        {"instrument: rate_gyro\ntorque: {fixed: 4.8e-5 N m}\nspring: {stiffness: 9.76e-5 N m/rad}",
         "torque.fixed"},
        {"instrument: rate_integrating_gyro\nrebalance: analog\ntorque: {fixed: 1e-4 N m}\n"
         "torquer: {limit: 9e-5 N m}",
         "torque.fixed"},
        {"instrument: tuned_gyro\ntorque: {fixed: 1e-4 N m}\ntorquer: {limit: 9e-5 N m}",
         "torque.fixed"},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[300];
        imk_design_file file = {0};
        imk_error error = {0};
        const int length = snprintf(text, sizeof text, "imukit: 1\n%s\n", cases[i].text);
        assert_true(imk_design_parse(text, (size_t)length, &file, &error) != IMK_OK);
        assert_string_equal(error.field, cases[i].field);
        assert_true(error.expected[0] != '\0');
        imk_design_file_free(&file);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(moved_designs_are_refused_in_words_or_agree),
        cmocka_unit_test(designs_at_the_end_of_their_range_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
