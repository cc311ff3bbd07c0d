/* SPDX-License-Identifier: Apache-2.0 */
/* Motions that end, or begin, under way: whatever their steps, the rate and the clock, no row has
 * another velocity than the motion, neither in the truth nor in Monte Carlo, whose errors are those
 * of the covariance. */
#include "check.h"

#include "imukit/drift.h"
#include "imukit/drift_models.h"
#include "imukit/motion_script.h"
#include "imukit/random.h"
#include "imukit/simulate_log.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { STEPS_MAX = 40, COLUMNS = 17, ROWS_MAX = 30000, STATES = IMK_DRIFT_STATES };

#define SPEED 20.0

typedef struct cruise {
    imk_motion_script script;
    imk_motion_step step[STEPS_MAX];
    imk_trajectory_piece piece[2 * STEPS_MAX];
    imk_trajectory trajectory;
    double length; /* as the steps add up */
} cruise;

/* Lengths as people write them: `decimals` places. */
static void hold_on(cruise *c, size_t steps, int decimals, uint64_t number)
{
    const imk_random random = imk_random_seeded(224);
    const double places = pow(10.0, decimals);
    memset(c, 0, sizeof *c);
    c->script = imk_motion_script_default();
    c->script.speed = SPEED;
    c->script.step = c->step;
    c->script.step_count = steps;
    for (size_t i = 0; i < steps; i++) {
        uint32_t word;
        imk_random_words(random, number, i, 1, &word);
        c->step[i] =
            (imk_motion_step){.kind = IMK_STEP_HOLD,
                              .duration = (1.0 + floor(word % 4000 * places / 1000.0)) / places};
        c->length += c->step[i].duration;
    }
    CHECK_OK(imk_motion_script_compile(&c->script, c->piece, sizeof c->piece / sizeof *c->piece,
                                       &c->trajectory, NULL));
}

/* The truth of every row to the one at the end. */
static void check_truth(const cruise *c, const imk_model *model, double rate, uint32_t run)
{
    static double memory[COLUMNS][ROWS_MAX];
    double *data[COLUMNS];
    for (int i = 0; i < COLUMNS; i++)
        data[i] = memory[i];
    imk_array_sink array = {.column_count = COLUMNS, .capacity = ROWS_MAX, .data = data};
    const imk_record_sink sink = imk_array_sink_of(&array);
    imk_simulate_log_settings settings = imk_simulate_log_default();
    settings.simulation.motion.trajectory = &c->trajectory;
    settings.simulation.rate = rate;
    settings.simulation.run = run;
    settings.rows = (uint64_t)floor(c->length * rate + 1e-6) + 1;
    assert_true(settings.rows <= ROWS_MAX);
    CHECK_OK(imk_simulate_truth_run(model, &settings, &sink, NULL, NULL));
    for (size_t k = 0; k < array.rows; k++) {
        CHECK_CLOSE(hypot(memory[4][k], memory[5][k]), SPEED, 1e-6);
        /* north along a meridian: level, and gravity less v^2/R; the rate is v/R about -east */
        CHECK_CLOSE(memory[16][k], memory[16][0], 1e-4);
        CHECK_CLOSE(memory[12][k], memory[12][0], 1e-9);
    }
}

static imk_model clock_model(double rate_error, double jitter)
{
    imk_model model;
    imk_model_default(&model);
    model.timing.rate_error.value = rate_error;
    model.timing.jitter.value = jitter;
    return model;
}

static void test_truth_keeps_its_velocity(void **state)
{
    (void)state;
    static cruise c;
    static const double rates[] = {100.0, 1000.0 / 3.0, 7.0, 128.0, 0.9, 250.0};
    const imk_model perfect = clock_model(0.0, 0.0), odd = clock_model(-2e-4, 1e-5);
    size_t past = 0;
    for (uint64_t number = 0; number < 300; number++) {
        const double rate = rates[number % 6];
        hold_on(&c, 1 + number % 12, 1 + (int)(number / 6 % 3), number);
        check_truth(&c, &perfect, rate, 0);
        if (number % 10 == 0)
            check_truth(&c, &odd, rate, 1 + (uint32_t)number);
        double first, last;
        imk_trajectory_span(&c.trajectory, &first, &last);
        past += floor(c.length * rate + 1e-6) / rate > last;
    }
    assert_true(past >= 5); /* what it is about */
}

/* The steps that showed it: 0.1 s, 0.2 s and 3.3 s end an ulp before row 360 at 100 Hz; and the
 * same with a clock that runs past the end, and begins before the start. Accelerometers alone are
 * not perfect: a bias of 1 mm/s^2 in all runs. */
static void test_runs_keep_their_velocity(void **state)
{
    (void)state;
    static cruise c;
    static const double steps[] = {0.1, 0.2, 3.3};
    hold_on(&c, 3, 1, 0);
    for (int i = 0; i < 3; i++)
        c.step[i].duration = steps[i];
    CHECK_OK(imk_motion_script_compile(&c.script, c.piece, 6, &c.trajectory, NULL));
    double first, last;
    imk_trajectory_span(&c.trajectory, &first, &last);
    assert_true(3.6 > last); /* the case is as stated */
    for (int i = 0; i < 3; i++) {
        imk_model model = clock_model(i == 1 ? -1e-4 : 0.0, i == 2 ? 1e-5 : 0.0);
        model.accel.bias.fixed.value[0] = 1e-3;
        imk_drift_settings settings = imk_drift_default();
        const double time = 3.6;
        double errors[8][STATES];
        settings.motion = &c.trajectory;
        settings.rate = 100.0;
        settings.time = &time;
        settings.time_count = 1;
        const size_t size = imk_drift_runs_workspace_size(&model, &settings);
        void *memory = malloc(size);
        assert_non_null(memory);
        CHECK_OK(imk_drift_runs(&model, &settings, 5, 0, 8, errors[0], memory, size, NULL));
        free(memory);
        for (int run = 0; run < 8; run++) {
            /* 1e-4 of the way and 20 m/s over jitter of 10 us; 3.6 mm/s from the bias */
            CHECK_CLOSE(errors[run][0], 0.5 * 1e-3 * 3.6 * 3.6 + (i == 1 ? -20.0 * 3.6e-4 : 0.0),
                        2e-3);
            CHECK_CLOSE(errors[run][3], 3.6e-3, 1e-5);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_truth_keeps_its_velocity),
        cmocka_unit_test(test_runs_keep_their_velocity),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
