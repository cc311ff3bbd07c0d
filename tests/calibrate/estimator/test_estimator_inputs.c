/* SPDX-License-Identifier: Apache-2.0 */
/* Problems at the edge of what the estimator takes: a refusal that says why, or a finite result;
 * never a crash, never a number that is none. */
#include "calibrate/estimator_session.h"
#include "check.h"

static void expect_finite(const session *b)
{
    const imk_calibration_result *r = &b->result;
    for (size_t p = 0; p < r->parameter_count; p++) {
        assert_true(isfinite(r->value[p]) && isfinite(r->sigma[p]) && r->sigma[p] > 0.0);
        assert_true(isfinite(imk_calibration_half_width(r, (int)p, 0.95)));
    }
    assert_true(isfinite(r->chi_square) && isfinite(r->degrees_of_freedom));
}

static session *poses(uint64_t seed, int count)
{
    session *b = session_new(seed, 1);
    session_free_static(b);
    session_know_the_rest(b);
    for (int i = 0; i < count; i++)
        session_pose(b, 1.0);
    return b;
}

/* A turn is looked at after the observations it is between: these say which record. */
static void turns_of_no_record(void **state)
{
    (void)state;
    static const double still[4] = {0.0};
    imk_test_record record = {.count = 4, .dt = 0.01, .axis_count = {3, 3}};
    for (int s = 0; s < 2; s++)
        for (int i = 0; i < 3; i++)
            record.reading[s][i] = still;
    const imk_test_record other = record;
    session *b = poses(51, 24);
    imk_calibration *c = &b->calibration;
    c->record_count = 2;
    c->record[0] = &record;
    c->record[1] = &other;
    c->turn[0] = (imk_turn){.from = 0, .to = 1, .begin = 0, .end = 4, .sigma = 1e-3};
    c->turn_count = 1;
    b->observation[0].record = b->observation[1].record = 77;
    CHECK_STATUS(session_solve(b), IMK_ERROR_ARGUMENT);
    assert_string_equal(b->error.field, "observation");
    b->observation[0].record = 0;
    b->observation[1].record = 1;
    CHECK_STATUS(session_solve(b), IMK_ERROR_ARGUMENT);
    assert_string_equal(b->error.field, "turn");
    b->observation[1].record = 0;
    c->turn[0].end = 0; /* of no length */
    CHECK_STATUS(session_solve(b), IMK_ERROR_ARGUMENT);
    c->turn[0].end = 5; /* beyond the record */
    CHECK_STATUS(session_solve(b), IMK_ERROR_ARGUMENT);
    c->record[1] = NULL;
    CHECK_STATUS(session_solve(b), IMK_ERROR_ARGUMENT);
    assert_string_equal(b->error.field, "record");
    session_free(b);
}

/* Samples that are missing: the turn says nothing, and counts as refused. */
static void turn_over_missing_samples(void **state)
{
    (void)state;
    static double none[4] = {0.0};
    none[2] = (double)NAN;
    imk_test_record record = {.count = 4, .dt = 0.01, .axis_count = {3, 3}};
    for (int s = 0; s < 2; s++)
        for (int i = 0; i < 3; i++)
            record.reading[s][i] = none;
    session *b = poses(52, 24);
    imk_calibration *c = &b->calibration;
    c->record_count = 1;
    c->record[0] = &record;
    c->turn[0] = (imk_turn){.from = 0, .to = 1, .begin = 0, .end = 4, .sigma = 1e-3};
    c->turn_count = 1;
    b->observation[0].record = b->observation[1].record = 0;
    for (int robust = 0; robust < 2; robust++) {
        c->robust = robust;
        if (robust) /* a bad pose: weights are given anew */
            b->observation[5].reading[IMK_ACCEL][0] += 1.0;
        CHECK_OK(session_solve(b));
        expect_finite(b);
        assert_int_equal(b->result.turns_refused, 1);
        assert_true(c->turn[0].weight == 0.0 && isnan(c->turn[0].residual[0]));
        assert_int_equal(b->result.group[IMK_GROUP_TURN].count, 0);
    }
    session_free(b);
}

static void numbers_beyond_reason(void **state)
{
    (void)state;
    static const double gravities[] = {0.0, -9.8, (double)NAN, (double)INFINITY};
    session *b = poses(53, 24);
    imk_calibration *c = &b->calibration;
    for (size_t i = 0; i < sizeof gravities / sizeof *gravities; i++) {
        c->gravity = gravities[i];
        CHECK_STATUS(session_solve(b), IMK_ERROR_RANGE);
        assert_string_equal(b->error.field, "gravity");
    }
    c->gravity = 9.8;
    c->latitude = 1.58;
    CHECK_STATUS(session_solve(b), IMK_ERROR_RANGE);
    c->latitude = -1.5707963267948966; /* the pole */
    CHECK_OK(session_solve(b));
    expect_finite(b);
    c->prior_sigma[0] = (double)NAN;
    CHECK_STATUS(session_solve(b), IMK_ERROR_RANGE);
    c->prior_sigma[0] = 0.0;
    c->fixture_count = 1;
    c->fixture_sigma[0] = -1.0;
    CHECK_STATUS(session_solve(b), IMK_ERROR_RANGE);
    c->fixture_sigma[0] = 1e6; /* nothing hangs on it */
    CHECK_OK(session_solve(b));
    expect_finite(b);
    /* Sigmas whose squares are no numbers. */
    for (int k = 0; k < 2; k++) {
        session *other = poses(53, 24);
        for (int i = 0; i < 24; i++)
            for (int s = 0; s < 2; s++)
                for (int axis = 0; axis < 3; axis++)
                    other->observation[i].sigma[s][axis] = k == 0 ? 1e-200 : 1e200;
        assert_int_not_equal(session_solve(other), IMK_OK);
        session_free(other);
    }
    /* All of one axis is missing: its bias has no observations. */
    for (int i = 0; i < 24; i++)
        b->observation[i].reading[IMK_ACCEL][2] = (double)NAN;
    assert_int_not_equal(session_solve(b), IMK_OK);
    session_free(b);
}

static void one_observation_more_than_there_is_room(void **state)
{
    (void)state;
    session *b = poses(54, 24);
    b->calibration.observation_capacity = 24;
    const imk_observation again = b->observation[0];
    assert_int_equal(imk_calibration_observe(&b->calibration, &again), -1);
    assert_int_equal(b->calibration.observation_count, 24);
    session_free(b);
}

/* Readings in counts of 1e9. */
static void large_counts(void **state)
{
    (void)state;
    session *b = poses(55, 24);
    const imk_test_record record = {.count = 1, .dt = 0.01, .counts = {true, true}};
    b->calibration.record[0] = &record;
    b->calibration.record_count = 1;
    imk_triad *triads[2] = {&b->calibration.model.gyro, &b->calibration.model.accel};
    for (int i = 0; i < 24; i++)
        for (int s = 0; s < 2; s++)
            for (int axis = 0; axis < 3; axis++) {
                triads[s]->sensitivity.value[axis] = 1e8;
                b->observation[i].record = 0;
                b->observation[i].reading[s][axis] *= 1e8;
                b->observation[i].sigma[s][axis] *= 1e8;
            }
    CHECK_OK(session_solve(b));
    expect_finite(b);
    for (size_t p = 0; p < b->result.parameter_count; p++)
        CHECK_CLOSE(b->result.value[p], imk_model_parameter_get(&b->truth, b->result.parameter[p]),
                    8.0 * b->result.sigma[p]);
    session_free(b);
}

/* Rates about each axis in two records, whose gyros are off by an offset each. */
static session *two_offsets(const imk_test_record *record, double offset_sigma)
{
    static const double off[2] = {2e-3, -3e-3}, force[3] = {0.0};
    session *b = session_new(57, 1);
    imk_calibration *c = &b->calibration;
    for (int axis = 0; axis < 3; axis++)
        CHECK_OK(imk_calibration_free(c, IMK_GYRO, IMK_MODEL_BIAS, axis, 0));
    for (int axis = 0; axis < 3; axis++)
        CHECK_OK(imk_calibration_free(c, IMK_GYRO, IMK_MODEL_SCALE_FACTOR, axis, 0));
    session_know_the_rest(b);
    for (int k = 0; k < 24; k++) {
        double rate[3] = {0.0};
        rate[k / 2 % 3] = k % 4 < 2 ? 1.0 : -1.0;
        imk_observation o = session_read(b, rate, force, NULL, (double)NAN);
        o.record = k % 2;
        o.offset_sigma = offset_sigma;
        for (int axis = 0; axis < 3; axis++) {
            o.reading[IMK_GYRO][axis] += off[k % 2];
            o.reading[IMK_ACCEL][axis] = (double)NAN;
        }
        assert_true(imk_calibration_observe(c, &o) >= 0);
    }
    c->frame = IMK_FRAME_REFERENCE;
    c->record_count = 2;
    c->record[0] = c->record[1] = record;
    return b;
}

/* The bias is between the records, as uncertain as their offsets, and scale factors are as certain
 * as though there were none. */
static void offsets_of_records(void **state)
{
    (void)state;
    const imk_test_record record = {.count = 1, .dt = 0.01, .axis_count = {3, 0}};
    const double sigma = 3e-3;
    session *b = two_offsets(&record, sigma);
    CHECK_OK(session_solve(b));
    assert_int_equal(b->result.parameter_count, 6);
    for (int axis = 0; axis < 3; axis++) {
        const double bias = b->truth.gyro.bias.fixed.value[axis] - 0.5e-3;
        CHECK_CLOSE(b->result.value[axis], bias, 6.0 * 3e-5 / sqrt(24.0));
        CHECK_RELATIVE(b->result.sigma[axis], sigma * sqrt(0.5), 1e-3);
        CHECK_CLOSE(b->result.value[3 + axis], b->truth.gyro.scale_factor.fixed.value[axis],
                    6.0 * 3e-5 / sqrt(8.0));
        CHECK_BELOW(b->result.sigma[3 + axis], 2.0 * 3e-5 / sqrt(8.0));
    }
    b->observation[3].offset_sigma = -1.0;
    CHECK_STATUS(session_solve(b), IMK_ERROR_RANGE);
    b->observation[3].offset_sigma = sigma;
    b->observation[3].heading_variance[1] = (double)NAN;
    CHECK_STATUS(session_solve(b), IMK_ERROR_RANGE);
    assert_int_equal(b->error.index, 3);
    session_free(b);
}

/* More records with offsets than there is room for. */
static void too_many_offsets(void **state)
{
    (void)state;
    const imk_test_record record = {.count = 1, .dt = 0.01, .axis_count = {3, 0}};
    session *b = two_offsets(&record, 3e-3);
    imk_calibration *c = &b->calibration;
    c->record_count = IMK_OFFSETS_MAX / 3 + 1;
    for (size_t k = 0; k < c->record_count; k++)
        c->record[k] = &record;
    for (size_t k = 0; k < c->observation_count; k++)
        b->observation[k].record = (int)(k % c->record_count);
    CHECK_STATUS(session_solve(b), IMK_ERROR_RANGE);
    assert_string_equal(b->error.field, "offset_sigma");
    session_free(b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(turns_of_no_record),
        cmocka_unit_test(turn_over_missing_samples),
        cmocka_unit_test(numbers_beyond_reason),
        cmocka_unit_test(one_observation_more_than_there_is_room),
        cmocka_unit_test(large_counts),
        cmocka_unit_test(offsets_of_records),
        cmocka_unit_test(too_many_offsets),
    };
    return cmocka_run_group_tests_name("estimator_inputs", tests, NULL, NULL);
}
