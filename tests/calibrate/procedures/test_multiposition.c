/* SPDX-License-Identifier: Apache-2.0 */
/* The multi-position procedure: first values from counts, what it takes from a log and what it
 * leaves out, and whether the intervals hold the truth on simulated bench tests. Longer runs:
 * experiments/coverage_multiposition.c. */
#include "check.h"

#include "calibrate/multiposition_session.h"
#include "calibrate/procedures/multiposition_internal.h"

#include <string.h>

static multiposition_session *start(void)
{
    multiposition_session *b = session_start();
    if (!b)
        fail_msg("no bench");
    return b;
}

static imk_status observe_record(multiposition_session *b, const imk_procedure_settings *settings)
{
    imk_calibration *c = &b->calibration;
    imk_calibration_default(c);
    c->model = b->nominal;
    c->latitude = 0.7853981633974483;
    c->observation = b->observation;
    c->turn = b->turn;
    c->observation_capacity = c->turn_capacity = 4 * BENCH_POSES;
    return imk_procedure_observe(IMK_PROCEDURE_MULTIPOSITION, c, &b->record, settings, false,
                                 &b->findings, b->workspace, b->workspace_size, &b->error);
}

/* ---- first values ------------------------------------------------------------------------------
 */

/* Counts of a triad whose axes are off by up to 0.5 % and 8 mrad, on 20 sides. */
static void make_holds(size_t count, imk_static_interval *hold)
{
    memset(hold, 0, count * sizeof *hold);
    for (size_t k = 0; k < count; k++) {
        const double z = 1.0 - (2.0 * (double)k + 1.0) / (double)count, a = 2.4 * (double)k;
        const double f[3] = {9.8 * sqrt(1.0 - z * z) * cos(a), 9.8 * sqrt(1.0 - z * z) * sin(a),
                             9.8 * z};
        hold[k].mean[IMK_ACCEL][0] = 33000.0 + 415.0 * (f[0] + 0.008 * f[1] - 0.006 * f[2]);
        hold[k].mean[IMK_ACCEL][1] = 32500.0 + 410.0 * (f[1] + 0.005 * f[2]);
        hold[k].mean[IMK_ACCEL][2] = 31800.0 + 420.0 * f[2];
    }
}

static void test_first_accelerometers(void **state)
{
    (void)state;
    imk_static_interval hold[20];
    imki_scaling found;
    make_holds(20, hold);
    static const double zero[3] = {33000.0, 32500.0, 31800.0}, scale[3] = {415.0, 410.0, 420.0};
    for (int bad = 0; bad < 3; bad++) {
        assert_true(imki_start_accelerometers(20, hold, 9.8, &found));
        for (int i = 0; i < 3; i++) {
            /* Misalignments of 8 mrad move it by 8e-3 g at most, if all poses leaned one way. */
            CHECK_CLOSE(found.zero[i], zero[i], 0.004 * 9.8 * 415.0);
            CHECK_RELATIVE(1.0 / found.unit[i], scale[i], 0.004);
        }
        /* A pose in which the unit was pushed with a quarter of g, then another. */
        hold[3 + 7 * bad].mean[IMK_ACCEL][bad] += 1000.0;
    }
    assert_false(imki_start_accelerometers(5, hold, 9.8, &found));
    for (int k = 0; k < 20; k++)
        hold[k].mean[IMK_ACCEL][2] = 31800.0;
    assert_false(imki_start_accelerometers(20, hold, 9.8, &found));
}

/* Nothing known about the counts: the nominal values found are whole, four digits, and close enough
 * to go on from; the solution is the same as with the right ones. */
static void test_counts_without_sensitivity(void **state)
{
    (void)state;
    multiposition_session *b = start();
    CHECK_OK(session_simulate(b, 1, 0));
    CHECK_OK(session_observe(b));
    CHECK_OK(session_solve(b));
    const imk_model known = b->result.model;
    const imk_model nominal = b->nominal;
    imk_model_default(&b->nominal);
    CHECK_OK(session_observe(b));
    for (int i = 0; i < 3; i++) {
        const imk_triad *gyro = &b->calibration.model.gyro, *accel = &b->calibration.model.accel;
        /* Scale factors of 0.6 % and what the start cannot see: misalignments, and the vertical
         * shown by accelerometers during turns. */
        CHECK_RELATIVE(gyro->sensitivity.value[i], nominal.gyro.sensitivity.value[i], 0.02);
        CHECK_RELATIVE(accel->sensitivity.value[i], nominal.accel.sensitivity.value[i], 0.01);
        CHECK_CLOSE(gyro->sensitivity.value[i], round(gyro->sensitivity.value[i]), 0.0);
        CHECK_CLOSE(accel->zero_offset.value[i], round(accel->zero_offset.value[i]), 0.0);
    }
    CHECK_OK(session_solve(b));
    const imk_model *found = &b->result.model;
    for (int i = 0; i < 3; i++) {
        /* The same optimum in other parameters, to what the variance factors, iterated to 1e-3,
         * and the integration of turns, within a tenth of the tolerance, leave: 0.12 sigma seen. */
        CHECK_RELATIVE(
            found->gyro.sensitivity.value[i] * (1.0 + found->gyro.scale_factor.fixed.value[i]),
            known.gyro.sensitivity.value[i] * (1.0 + known.gyro.scale_factor.fixed.value[i]),
            0.3 * known.gyro.scale_factor.fixed.sigma[i]);
        CHECK_RELATIVE(
            found->accel.sensitivity.value[i] * (1.0 + found->accel.scale_factor.fixed.value[i]),
            known.accel.sensitivity.value[i] * (1.0 + known.accel.scale_factor.fixed.value[i]),
            0.3 * known.accel.scale_factor.fixed.sigma[i]);
    }
    session_stop(b);
}

/* ---- what is taken from a log ------------------------------------------------------------------
 */

static size_t free_of(const imk_calibration *c, int sensor, int term)
{
    size_t count = 0;
    for (size_t p = 0; p < c->parameter_count; p++)
        count += c->parameter[p].sensor == sensor && c->parameter[p].term == term;
    return count;
}

static void test_whole_session(void **state)
{
    (void)state;
    multiposition_session *b = start();
    CHECK_OK(session_simulate(b, 1, 0));
    CHECK_OK(session_observe(b));
    const imk_calibration *c = &b->calibration;
    assert_int_equal(c->observation_count, BENCH_POSES);
    assert_int_equal(c->turn_count, BENCH_POSES - 1);
    assert_int_equal(b->findings.observations, BENCH_POSES);
    assert_int_equal(b->findings.turns, BENCH_POSES - 1);
    assert_int_equal(free_of(c, IMK_ACCEL, IMK_MODEL_BIAS), 3);
    assert_int_equal(free_of(c, IMK_ACCEL, IMK_MODEL_SCALE_FACTOR), 3);
    assert_int_equal(free_of(c, IMK_ACCEL, IMK_MODEL_MISALIGNMENT), 3);
    assert_int_equal(free_of(c, IMK_GYRO, IMK_MODEL_BIAS), 3);
    assert_int_equal(free_of(c, IMK_GYRO, IMK_MODEL_SCALE_FACTOR), 3);
    assert_int_equal(free_of(c, IMK_GYRO, IMK_MODEL_MISALIGNMENT), 6);
    assert_int_equal(free_of(c, IMK_GYRO, IMK_MODEL_G_SENSITIVITY), 9);
    assert_int_equal(c->parameter_count, 30);
    /* Evenly spread: a third, less what 24 points leave. */
    CHECK_CLOSE(b->findings.spread, 1.0 / 3.0, 0.02);
    for (size_t t = 0; t < c->turn_count; t++) {
        const imk_turn *turn = &b->turn[t];
        assert_int_equal(turn->from + 1, turn->to);
        assert_int_equal(turn->begin, b->observation[turn->from].end);
        assert_int_equal(turn->end, b->observation[turn->to].begin);
        /* 0.005 deg/s/sqrt(Hz), and half the square of the Earth's rate at 45 deg; the noise is
         * estimated from two holds of some 2 s: 30 %. */
        const double duration = (double)(turn->end - turn->begin) / BENCH_RATE;
        const double noise = 0.005 * 0.017453292519943295;
        const double earth = 7.292115e-5 * duration;
        CHECK_RELATIVE(turn->sigma, sqrt(noise * noise * duration + 0.25 * earth * earth), 0.3);
    }
    session_stop(b);
}

/* Samples of some turns are missing, stuck out of range or not numbers; others stay. */
static void test_turns_left_out(void **state)
{
    (void)state;
    multiposition_session *b = start();
    CHECK_OK(session_simulate(b, 1, 0));
    CHECK_OK(session_observe(b));
    const imk_procedure_settings settings = imk_procedure_default(IMK_PROCEDURE_MULTIPOSITION);
    double *time = malloc(b->rows * sizeof *time);
    size_t middle[3];
    for (int i = 0; i < 3; i++)
        middle[i] = (b->turn[3 + 5 * i].begin + b->turn[3 + 5 * i].end) / 2;
    for (size_t k = 0; k < b->rows; k++)
        time[k] = (double)k / BENCH_RATE + (k >= middle[0] ? 0.3 : 0.0);
    b->record.time = time;
    CHECK_OK(observe_record(b, &settings));
    assert_int_equal(b->calibration.turn_count, BENCH_POSES - 2);
    b->value[1][middle[1]] = (double)NAN;
    CHECK_OK(observe_record(b, &settings));
    assert_int_equal(b->calibration.turn_count, BENCH_POSES - 3);
    /* 20 rad/s are beyond a range of 17; turns here reach 3. */
    for (int i = 0; i < 3; i++)
        b->nominal.gyro.range.value[i] = 17.0;
    b->value[2][middle[2]] = 20.0 * b->nominal.gyro.sensitivity.value[2];
    CHECK_OK(observe_record(b, &settings));
    assert_int_equal(b->calibration.turn_count, BENCH_POSES - 4);
    assert_int_equal(b->calibration.observation_count, BENCH_POSES);
    free(time);
    session_stop(b);
}

/* A long rest weighs like any other, not twelve times as much. */
static void test_long_rest(void **state)
{
    (void)state;
    multiposition_session *b = start();
    CHECK_OK(session_simulate(b, 1, 0));
    CHECK_OK(session_observe(b));
    const double sigma = b->observation[0].sigma[IMK_ACCEL][0];
    const size_t more = 3000, middle = (BENCH_TURN * 2 + BENCH_HOLD) * BENCH_RATE / 2;
    /* Half a minute more of the first hold, by repeating its own samples. */
    double *longer[6];
    for (int c = 0; c < 6; c++) {
        longer[c] = malloc((b->rows + more) * sizeof **longer);
        memcpy(longer[c], b->value[c], middle * sizeof **longer);
        for (size_t k = 0; k < more; k++)
            longer[c][middle + k] = b->value[c][middle - 120 + k % 240];
        memcpy(longer[c] + middle + more, b->value[c] + middle,
               (b->rows - middle) * sizeof **longer);
        b->record.reading[c / 3][c % 3] = longer[c];
    }
    b->record.count = b->rows + more;
    const imk_procedure_settings settings = imk_procedure_default(IMK_PROCEDURE_MULTIPOSITION);
    CHECK_OK(observe_record(b, &settings));
    assert_int_equal(b->calibration.observation_count, BENCH_POSES);
    assert_true(b->observation[0].end - b->observation[0].begin > more + 100);
    /* Half of the noise level is this hold's own estimate, from another stretch now. */
    CHECK_RELATIVE(b->observation[0].sigma[IMK_ACCEL][0], sigma, 0.25);
    for (int c = 0; c < 6; c++)
        free(longer[c]);
    session_stop(b);
}

static void test_what_is_missing(void **state)
{
    (void)state;
    multiposition_session *b = start();
    CHECK_OK(session_simulate(b, 1, 0));
    CHECK_OK(session_observe(b));
    imk_procedure_settings settings = imk_procedure_default(IMK_PROCEDURE_MULTIPOSITION);
    /* Seven poses, holds from 2 + 5 k to 5 + 5 k s. */
    b->record.count = 35 * BENCH_RATE;
    CHECK_STATUS(observe_record(b, &settings), IMK_ERROR_TOO_SHORT);
    assert_string_equal(b->error.field, "hold");
    CHECK_CLOSE(b->error.value, 7.0, 0.0);
    CHECK_CLOSE(b->error.limit, 12.0, 0.0);
    assert_int_equal(b->calibration.observation_count, 0);
    assert_int_equal(b->calibration.parameter_count, 0);
    b->record.count = b->rows;
    /* Gaps in most turns. */
    double *time = malloc(b->rows * sizeof *time);
    for (size_t k = 0; k < b->rows; k++)
        time[k] = (double)k / BENCH_RATE + 0.3 * (double)((k + 100) / 500);
    b->record.time = time;
    CHECK_STATUS(observe_record(b, &settings), IMK_ERROR_TOO_SHORT);
    assert_string_equal(b->error.field, "turn");
    /* Without turns only biases and g-sensitivity of the gyros are left. */
    settings.gyro_turns = false;
    CHECK_OK(observe_record(b, &settings));
    assert_int_equal(b->calibration.turn_count, 0);
    assert_int_equal(b->calibration.parameter_count, 21);
    b->record.time = NULL;
    free(time);
    /* No gyros, no accelerometers, no room. */
    b->record.axis_count[IMK_GYRO] = 0;
    settings.gyro_turns = true;
    CHECK_OK(observe_record(b, &settings));
    assert_int_equal(b->calibration.parameter_count, 9);
    CHECK_OK(session_solve(b));
    b->record.axis_count[IMK_GYRO] = 3;
    b->record.axis_count[IMK_ACCEL] = 0;
    CHECK_STATUS(observe_record(b, &settings), IMK_ERROR_KEY_MISSING);
    assert_string_equal(b->error.field, "accel");
    b->record.axis_count[IMK_ACCEL] = 3;
    b->calibration.observation_capacity = 20;
    CHECK_STATUS(imk_procedure_observe(IMK_PROCEDURE_MULTIPOSITION, &b->calibration, &b->record,
                                       &settings, false, &b->findings, b->workspace,
                                       b->workspace_size, &b->error),
                 IMK_ERROR_WORKSPACE);
    CHECK_CLOSE(b->error.value, BENCH_POSES, 0.0);
    CHECK_CLOSE(b->error.limit, 20.0, 0.0);
    session_stop(b);
}

/* ---- intervals ---------------------------------------------------------------------------------
 */

/* Limits for a false alarm of 1e-6 over 30 parameters, 3e-8 each: of n draws at 93 %, which is what
 * is asked for, so few within (binomial); mean of n values of Student's distribution, whose root
 * mean square is 1.1, beyond 0.2, likewise, by 5.6 * 1.1/sqrt(n). */
static void test_coverage(void **state)
{
    (void)state;
    const uint32_t benches = check_runs(48);
    multiposition_session *b = start();
    coverage_count count = {0};
    for (uint32_t run = 0; run < benches; run++)
        CHECK_OK(session_run(b, 1, run, 0, &count));
    for (size_t p = 0; p < count.parameter_count; p++) {
        assert_true(count.held[p] >= coverage_least_held(benches, 0.93, 3e-8));
        CHECK_BELOW(fabs(coverage_bias(&count, p)), 0.2 + 5.6 * 1.1 / sqrt((double)benches));
    }
    session_stop(b);
}

/* Poses that are off by 3 mm/s^2, noise of the axes 1 : 4 : 16 (0.6 mm/s^2 of a hold): in one bench
 * of twelve the turns look worse, and the accelerometers as good as stated; in four of these eight.
 * Fewer intervals of the accelerometers hold than 95 % of them do with a probability of 1e-3. */
static void test_poses_are_off_not_turns(void **state)
{
    (void)state;
    enum { FIRST = 97, BENCHES = 8, ACCEL = 9 };
    multiposition_session *b = start();
    coverage_count count = {0};
    size_t held = 0;
    b->push = 3e-3;
    for (int axis = 1; axis < 3; axis++)
        b->truth.accel.noise.white.value[axis] = 4.0 * b->truth.accel.noise.white.value[axis - 1];
    for (uint32_t run = 0; run < BENCHES; run++)
        CHECK_OK(session_run(b, 7, FIRST + run, 0, &count));
    for (size_t p = 0; p < ACCEL; p++)
        held += count.held[p];
    assert_true(held >= coverage_least_held((size_t)ACCEL * BENCHES, 0.95, 1e-3));
    assert_int_equal(count.doubted, 0);
    session_stop(b);
}

/* Two poses of 24 spoilt: no parameter is moved by a sigma in the mean, but for the chance of the
 * clean benches. */
static void test_bad_poses(void **state)
{
    (void)state;
    const uint32_t benches = check_quick() ? 2 : 24;
    multiposition_session *b = start();
    coverage_count count = {0};
    for (uint32_t run = 0; run < benches; run++)
        CHECK_OK(session_run(b, 1, run, 2, &count));
    for (size_t p = 0; p < count.parameter_count; p++)
        CHECK_BELOW(fabs(coverage_bias(&count, p)), 0.2 + 5.6 * 1.1 / sqrt((double)benches));
    session_stop(b);
}

/* Half-width of a parameter. */
static double half_width_of(const multiposition_session *b, imk_model_parameter parameter)
{
    for (size_t p = 0; p < b->result.parameter_count; p++)
        if (memcmp(&b->result.parameter[p], &parameter, sizeof parameter) == 0)
            return imk_calibration_half_width(&b->result, (int)p, 0.95);
    fail_msg("not estimated");
    return 0.0;
}

/* Flicker as large as the noise of a hold, which the model does not state: along y and z gravity
 * changes slowly from pose to pose. The intervals of the gyros' response to it are on the average
 * as wide as those of a model that states the noise; by the factor of all readings alone they would
 * be 8 % narrower. */
static void test_noise_not_stated(void **state)
{
    (void)state;
    const uint32_t benches = check_quick() ? 8 : 24;
    double ratio = 0.0;
    multiposition_session *b = start();
    session_poses(b, 12);
    for (uint32_t run = 0; run < benches; run++) {
        double width[2][6];
        CHECK_OK(session_simulate(b, 3, run));
        for (int stated = 0; stated < 2; stated++) {
            memset(&b->nominal.gyro.noise, 0, sizeof b->nominal.gyro.noise);
            if (stated)
                b->nominal.gyro.noise = b->truth.gyro.noise;
            CHECK_OK(session_observe(b));
            CHECK_OK(session_solve(b));
            for (int k = 0; k < 6; k++)
                width[stated][k] =
                    half_width_of(b, (imk_model_parameter){IMK_GYRO, IMK_MODEL_G_SENSITIVITY,
                                                           (uint8_t)(k / 2), (uint8_t)(1 + k % 2)});
        }
        for (int k = 0; k < 6; k++)
            ratio += width[0][k] / width[1][k] / (6.0 * benches);
    }
    CHECK_CLOSE(ratio, 1.0, check_quick() ? 0.1 : 0.05);
    session_stop(b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_first_accelerometers),
        cmocka_unit_test(test_counts_without_sensitivity),
        cmocka_unit_test(test_whole_session),
        cmocka_unit_test(test_turns_left_out),
        cmocka_unit_test(test_long_rest),
        cmocka_unit_test(test_what_is_missing),
        cmocka_unit_test(test_coverage),
        cmocka_unit_test(test_poses_are_off_not_turns),
        cmocka_unit_test(test_bad_poses),
        cmocka_unit_test(test_noise_not_stated),
    };
    return cmocka_run_group_tests_name("multiposition", tests, NULL, NULL);
}
