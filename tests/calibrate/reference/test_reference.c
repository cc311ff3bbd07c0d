/* SPDX-License-Identifier: Apache-2.0 */
/* Procedures with a reference: rate table, tumble, centrifuge, spin. Units are simulated, so the
 * truth is known; what is refused is refused with the field and numbers that help. */
#include "calibrate/coverage.h"
#include "calibrate/reference_session.h"
#include "check.h"

#include "imukit/motion_script.h"
#include "imukit/reference_alignment.h"

static session *shared;

static void start(imk_procedure procedure, void (*programme)(session *))
{
    free(shared->workspace);
    session_start(shared, procedure, programme);
}

static int set_up(void **state)
{
    (void)state;
    shared = calloc(1, sizeof *shared);
    return shared ? 0 : -1;
}

static int tear_down(void **state)
{
    (void)state;
    free(shared->workspace);
    free(shared);
    return 0;
}

static double estimate(const session *b, const char *name)
{
    imk_model_parameter wanted;
    CHECK_OK(imk_model_parameter_parse(name, &wanted));
    for (size_t p = 0; p < b->result.parameter_count; p++)
        if (memcmp(&b->result.parameter[p], &wanted, sizeof wanted) == 0)
            return b->result.value[p];
    fail_msg("%s was not estimated", name);
    return (double)NAN;
}

static bool was_left_out(const session *b, const char *name)
{
    imk_model_parameter wanted;
    CHECK_OK(imk_model_parameter_parse(name, &wanted));
    for (size_t i = 0; i < b->findings.undetermined_count; i++)
        if (memcmp(&b->findings.undetermined[i], &wanted, sizeof wanted) == 0)
            return true;
    return false;
}

/* ---- stretches -------------------------------------------------------------------------------
 */

static size_t stretches_of(session *b, imk_reference_stretch *stretch, size_t capacity)
{
    size_t count = 0;
    const size_t size = imk_reference_stretches_workspace_size(&b->record);
    void *memory = malloc(size);
    CHECK_OK(imk_reference_stretches(&b->record, &b->settings, stretch, capacity, &count, memory,
                                     size, NULL));
    free(memory);
    return count;
}

/* Every hold of the programme is found, within it and nearly as long, with its rate and force, by
 * an encoder whose single rates are off by 2e-5 rad/s. */
static void test_stretches(void **state)
{
    (void)state;
    static imk_reference_stretch stretch[BENCH_HOLDS];
    start(IMK_PROCEDURE_RATE_TABLE, session_rate_steps);
    session_log(shared, 3, 0.0);
    const size_t count = stretches_of(shared, stretch, BENCH_HOLDS);
    assert_int_equal(count, shared->holds);
    const size_t trim = (size_t)(shared->settings.trim * session_rate);
    for (size_t i = 0; i < count; i++) {
        const size_t middle = (shared->hold_begin[i] + shared->hold_end[i]) / 2;
        /* The ramps' ends creep: 1e-4 rad/s of 3 are reached 0.02 s early. Before the first hold
         * there is none. */
        assert_true(i == 0 || stretch[i].begin + 10 >= shared->hold_begin[i] + trim);
        assert_true(stretch[i].end <= shared->hold_end[i] - trim + 10);
        assert_true(stretch[i].end - stretch[i].begin >=
                    shared->hold_end[i] - shared->hold_begin[i] - 2 * trim - 20);
        for (int j = 0; j < 3; j++) {
            /* Two rounded angles over at least 2 s, and steady_rate. */
            CHECK_CLOSE(stretch[i].rate[j], shared->rate[j][middle], 1e-5);
            CHECK_CLOSE(stretch[i].force[j], shared->force[j][middle], 1e-6);
        }
    }
    /* The count does not depend on the room. */
    assert_int_equal(stretches_of(shared, stretch, 5), count);
}

/* A gap in time and a reference that is not a number end a stretch; a sine has none. */
static void test_broken_stretches(void **state)
{
    (void)state;
    static imk_reference_stretch stretch[BENCH_HOLDS];
    static double time[BENCH_SAMPLES];
    start(IMK_PROCEDURE_RATE_TABLE, session_rate_steps);
    session_log(shared, 4, 0.0);
    const size_t holds = shared->holds;
    const size_t middle = (shared->hold_begin[2] + shared->hold_end[2]) / 2;
    for (size_t k = 0; k < shared->count; k++)
        time[k] = (double)k / session_rate + (k >= middle ? 0.1 : 0.0);
    shared->record.time = time;
    assert_int_equal(stretches_of(shared, stretch, BENCH_HOLDS), holds + 1);
    shared->record.time = NULL;
    shared->encoder[1][middle] = (double)NAN;
    assert_int_equal(stretches_of(shared, stretch, BENCH_HOLDS), holds + 1);

    start(IMK_PROCEDURE_RATE_TABLE, session_rate_sine);
    session_log(shared, 5, 0.0);
    const size_t count = stretches_of(shared, stretch, BENCH_HOLDS);
    for (size_t i = 0; i < count; i++)
        for (int j = 0; j < 3; j++)
            CHECK_CLOSE(stretch[i].rate[j], 0.0, 1e-4);
}

/* Rates at which any time is more samples than an integer holds: nothing is found in so short a
 * record, and nothing divided by what overflowed to 0. */
static void test_absurd_rates(void **state)
{
    (void)state;
    static imk_reference_stretch stretch[4];
    static const double rates[] = {1e18, 1e20, 1e160, 1e300};
    for (size_t i = 0; i < sizeof rates / sizeof rates[0]; i++) {
        start(IMK_PROCEDURE_RATE_TABLE, session_rate_steps);
        session_log(shared, 4, 0.0);
        shared->record.dt = 1.0 / rates[i];
        assert_int_equal(stretches_of(shared, stretch, 4), 0);
        assert_true(imk_procedure_workspace_size(IMK_PROCEDURE_RATE_TABLE, &shared->record,
                                                 &shared->settings) > 0);
    }
}

static void test_without_reference(void **state)
{
    (void)state;
    static imk_reference_stretch stretch[4];
    size_t count;
    double memory[8192];
    imk_error error;
    start(IMK_PROCEDURE_RATE_TABLE, session_rate_steps);
    session_log(shared, 6, 0.0);
    for (int j = 0; j < 3; j++)
        shared->record.reference_rate[j] = shared->record.reference_force[j] = NULL;
    CHECK_STATUS(imk_reference_stretches(&shared->record, &shared->settings, stretch, 4, &count,
                                         memory, sizeof memory, &error),
                 IMK_ERROR_KEY_MISSING);
    CHECK_STATUS(session_solve(shared, &error), IMK_ERROR_KEY_MISSING);
    assert_string_equal(error.field, "reference_rate");
    assert_int_equal(shared->calibration.observation_count, 0);
    assert_int_equal(shared->calibration.record_count, 0);
}

/* ---- offset ----------------------------------------------------------------------------------
 */

/* The log begins 12.4 samples before its reference: its rows are shifted by whole samples, its
 * signals by parts of one, made by a straight line between neighbours of a smooth motion. */
static void shift_log(session *b, double samples)
{
    static double copy[BENCH_SAMPLES];
    for (int c = 0; c < 6; c++) {
        memcpy(copy, b->log[c], b->count * sizeof *copy);
        for (size_t k = 0; k < b->count; k++) {
            const double at = fmin(fmax((double)k - samples, 0.0), (double)b->count - 1.001);
            const size_t whole = (size_t)at;
            b->log[c][k] = copy[whole] + (at - (double)whole) * (copy[whole + 1] - copy[whole]);
        }
    }
}

static imk_reference_shift offset_of(session *b, double max_shift)
{
    imk_reference_shift shift;
    const size_t size = imk_reference_offset_workspace_size(&b->record, max_shift);
    void *memory = malloc(size);
    CHECK_OK(imk_reference_offset(&b->record, max_shift, &shift, memory, size, NULL));
    free(memory);
    return shift;
}

static void test_offset(void **state)
{
    (void)state;
    static const double samples[] = {0.0, 12.4, -250.7, 77.0};
    for (size_t i = 0; i < 4; i++) {
        if (check_skips(i, 2))
            continue;
        start(IMK_PROCEDURE_RATE_TABLE, session_rate_steps);
        session_log(shared, 10 + i, 0.0);
        shift_log(shared, samples[i]);
        imk_reference_shift shift = offset_of(shared, 5.0);
        /* Six sigmas (2e-9 two-sided), and what shifting by straight lines bends. */
        CHECK_CLOSE(shift.offset, samples[i] / session_rate, 6.0 * shift.sigma + 2e-5);
        CHECK_BELOW(shift.sigma, 1e-4);
        CHECK_BELOW(0.99, shift.correlation);
        /* Steps of different heights: no other shift comes near. */
        CHECK_BELOW(shift.rival, 0.9 * shift.correlation);
        /* Exchanged and reversed axes, and other units, are as good. */
        shared->record.reading[0][0] = shared->log[2];
        shared->record.reading[0][2] = shared->log[0];
        for (size_t k = 0; k < shared->count; k++)
            shared->log[1][k] *= -57.3;
        const imk_reference_shift again = offset_of(shared, 5.0);
        CHECK_CLOSE(again.offset, shift.offset, 1e-7);
    }
}

/* A sine is as good half a period later, but for where it begins and ends. */
static void test_ambiguous_offset(void **state)
{
    (void)state;
    start(IMK_PROCEDURE_RATE_TABLE, session_rate_sine);
    session_log(shared, 20, 0.0);
    for (int j = 0; j < 3; j++)
        shared->record.reference_force[j] = NULL;
    const imk_reference_shift shift = offset_of(shared, 3.0);
    CHECK_CLOSE(shift.offset, 0.0, 6.0 * shift.sigma + 1e-5);
    /* One second of the twenty in each run is compared with rest. */
    CHECK_BELOW(0.8 * shift.correlation, shift.rival);
    CHECK_CLOSE(remainder(shift.rival_offset, 1.0), 0.0, 0.05);
}

static void test_offset_refused(void **state)
{
    (void)state;
    imk_reference_shift shift;
    imk_error error;
    start(IMK_PROCEDURE_TUMBLE, session_tumble);
    session_log(shared, 21, 0.0);
    const size_t size = imk_reference_offset_workspace_size(&shared->record, 5.0);
    void *memory = malloc(size);
    CHECK_STATUS(imk_reference_offset(&shared->record, 60.0, &shift, memory, size, &error),
                 IMK_ERROR_TOO_SHORT);
    CHECK_STATUS(imk_reference_offset(&shared->record, 5.0, &shift, memory, 8, &error),
                 IMK_ERROR_WORKSPACE);
    for (int j = 0; j < 3; j++)
        shared->record.reference_rate[j] = NULL;
    CHECK_OK(imk_reference_offset(&shared->record, 5.0, &shift, memory, size, &error));
    assert_int_equal(shift.sensor, IMK_ACCEL);
    for (size_t k = 0; k < shared->count; k++)
        for (int j = 0; j < 3; j++)
            shared->force[j][k] = 1.0;
    CHECK_STATUS(imk_reference_offset(&shared->record, 5.0, &shift, memory, size, &error),
                 IMK_ERROR_CONSTANT);
    for (int j = 0; j < 3; j++)
        shared->record.reference_force[j] = NULL;
    CHECK_STATUS(imk_reference_offset(&shared->record, 5.0, &shift, memory, size, &error),
                 IMK_ERROR_KEY_MISSING);
    free(memory);
}

/* ---- coverage --------------------------------------------------------------------------------
 */

/* Benches of raw samples: of n the 95 % interval holds the truth in about 0.95 n. What is checked
 * are all parameters together, which share a log and are not independent of each other: their
 * number counts as a tenth. A false alarm has the probability 1e-6 for the share (normal quantile
 * 4.9) and for the bias of each parameter. Under the sanitizers two benches will do. */
static void cover(imk_procedure procedure, void (*programme)(session *), uint32_t full, double bad)
{
    coverage_count count = {0};
    imk_error error;
    const uint32_t benches = check_quick() ? 2 : full;
    start(procedure, programme);
    if (procedure == IMK_PROCEDURE_TUMBLE)
        shared->settings.nonlinear = true;
    shared->settings.sine_block = 0.05;
    for (size_t i = 0; i < benches; i++) {
        session_log(shared, 5000 + i, bad);
        CHECK_OK(session_solve(shared, &error));
        coverage_add(&count, &shared->result, &shared->truth, 0.95);
    }
    assert_int_equal(shared->findings.undetermined_count,
                     programme == session_rate_upright ? 9 : 0);
    double held = 0.0;
    for (size_t p = 0; p < count.parameter_count; p++) {
        held += coverage_share(&count, p) / (double)count.parameter_count;
        /* 1e-6 over 45 parameters: normal quantile 5.6; slow noise adds a fifth */
        CHECK_BELOW(fabs(coverage_bias(&count, p)), 0.2 + 5.6 * 1.2 / sqrt((double)benches));
    }
    const double independent = (double)benches * (double)count.parameter_count / 10.0;
    const double margin = 4.9 * sqrt(0.95 * 0.05 / independent);
    CHECK_BELOW(0.93 - margin, held);
    CHECK_BELOW(held, 0.97 + margin);
}

static void test_rate_table(void **state)
{
    (void)state;
    cover(IMK_PROCEDURE_RATE_TABLE, session_rate_steps, 24, 0.0);
    assert_int_equal(shared->result.parameter_count, 33);
    assert_int_equal(shared->findings.intervals, shared->holds);
    assert_int_equal(shared->calibration.frame, IMK_FRAME_REFERENCE);
    cover(IMK_PROCEDURE_RATE_TABLE, session_rate_steps, 12, 0.1);
}

static void test_sine(void **state)
{
    (void)state;
    cover(IMK_PROCEDURE_RATE_TABLE, session_rate_sine, 2, 0.0);
    assert_int_equal(shared->result.parameter_count, 33);
    CHECK_CLOSE(shared->findings.lag, 0.0, 6.0 * shared->findings.lag_sigma + 1e-7);
    CHECK_BELOW(1e-9, shared->findings.lag_sigma);
}

static void test_tumble(void **state)
{
    (void)state;
    cover(IMK_PROCEDURE_TUMBLE, session_tumble, 24, 0.0);
    assert_int_equal(shared->result.parameter_count, 36 + 3);
    cover(IMK_PROCEDURE_TUMBLE, session_tumble, 12, 0.1);
}

static void test_centrifuge(void **state)
{
    (void)state;
    cover(IMK_PROCEDURE_CENTRIFUGE, session_centrifuge, 20, 0.0);
    cover(IMK_PROCEDURE_CENTRIFUGE, session_centrifuge, 10, 0.1);
}

/* Units of 20 deg/h/g, in three attitudes: the intervals of the biases hold the truth all the same,
 * whether g-sensitivity is estimated or left out; when left out it is not reported, and a sigma of
 * 0 says that it is not there. */
static void test_upright_only(void **state)
{
    (void)state;
    cover(IMK_PROCEDURE_RATE_TABLE, session_rate_upright, 40, 0.0);
    imk_error error;
    start(IMK_PROCEDURE_RATE_TABLE, session_rate_upright);
    session_log(shared, 77, 0.0);
    CHECK_OK(session_solve(shared, &error));
    const size_t count = shared->result.parameter_count;
    const double sigma = shared->result.sigma[0];
    CHECK_CLOSE(shared->result.assumed.degrees_of_freedom, 6.0, 0.5);
    shared->settings.g_sensitivity = false;
    CHECK_OK(session_solve(shared, &error));
    assert_int_equal(shared->result.parameter_count, count - 9);
    CHECK_RELATIVE(shared->result.sigma[0], sigma, 1e-6);
    CHECK_CLOSE(shared->result.model.gyro.g_sensitivity.value[0][0], 0.0, 0.0);
    shared->settings.g_sensitivity_sigma = 0.0;
    CHECK_OK(session_solve(shared, &error));
    assert_int_equal(shared->result.parameter_count, count - 9);
    assert_true(shared->result.sigma[0] < 0.5 * sigma);
}

/* ---- the Earth ---- */

/* How many intervals of the parameters of gyros with this term hold the truth; of g-sensitivity
 * those of each axis along itself. */
static double gyro_share(const coverage_count *count, int term)
{
    double held = 0.0, all = 0.0;
    for (size_t p = 0; p < count->parameter_count; p++) {
        const imk_model_parameter q = count->parameter[p];
        const bool own = term != IMK_MODEL_G_SENSITIVITY || q.axis == q.element;
        if (q.sensor != IMK_GYRO || q.term != term || !own)
            continue;
        held += (double)count->held[p];
        all += (double)count->benches;
    }
    assert_true(all > 0.0);
    return held / all;
}

static void run_on_earth(session_earth earth, imk_procedure procedure, void (*programme)(session *),
                         double push, uint32_t benches, coverage_count *count)
{
    imk_error error;
    start(procedure, programme);
    shared->earth = earth;
    shared->push[0] = push;
    memset(count, 0, sizeof *count);
    for (uint32_t i = 0; i < (check_quick() ? 2 : benches); i++) {
        session_log(shared, 6000 + i, 0.0);
        CHECK_OK(session_solve(shared, &error));
        coverage_add(count, &shared->result, &shared->truth, 0.95);
    }
}

/* A dividing head at one heading that is not known, holds that are off by 20 deg/h: the Earth's
 * rate is stated beside the noise, so what the factor tells of the holds is not lost in it. When
 * the factor multiplied both, biases and g-sensitivity along the axes held in 60 to 67 %. */
static void test_unknown_heading(void **state)
{
    (void)state;
    static coverage_count count;
    const double level = session_earth_rate * cos(session_latitude);
    run_on_earth(SESSION_ONE_HEADING, IMK_PROCEDURE_TUMBLE, session_tumble, 1e-4, 20, &count);
    CHECK_BELOW(0.85, gyro_share(&count, IMK_MODEL_BIAS));
    CHECK_BELOW(0.85, gyro_share(&count, IMK_MODEL_G_SENSITIVITY));
    for (size_t k = 0; k < shared->calibration.observation_count; k++) {
        const imk_observation *o = &shared->observation[k];
        assert_true(o->heading_depends);
        for (int i = 0; i < 3; i++) {
            const double up = o->force[i] / session_gravity;
            CHECK_CLOSE(o->heading_variance[i], 18.0 * level * level * (1.0 - up * up), 1e-12);
            CHECK_BELOW(o->sigma[IMK_GYRO][i], level);
        }
    }
    /* Holds 20 deg/h off, of which a reading along the force tells alone. */
    CHECK_BELOW(2.0, shared->result.group[IMK_GROUP_GYRO].factor);
}

/* Gyros alone on a table that tells its rates: the bias contains g-sensitivity and the Earth's
 * rate, as much as the sigma says; a sigma of 0 and no Earth leave the noise. */
static void test_rate_of_table(void **state)
{
    (void)state;
    static coverage_count count;
    const double sensed = imk_procedure_default(IMK_PROCEDURE_RATE_TABLE).g_sensitivity_sigma;
    run_on_earth(SESSION_TABLE, IMK_PROCEDURE_RATE_TABLE, session_rate_one, 0.0, 40, &count);
    CHECK_BELOW(0.85, gyro_share(&count, IMK_MODEL_BIAS));
    assert_int_equal(shared->result.parameter[0].term, IMK_MODEL_BIAS);
    CHECK_RELATIVE(shared->result.sigma[0],
                   sqrt(sensed * sensed * session_gravity * session_gravity +
                        session_earth_rate * session_earth_rate / 3.0),
                   0.01);
    imk_error error;
    shared->settings.g_sensitivity_sigma = 0.0;
    CHECK_OK(session_solve(shared, &error));
    const double with_earth = shared->result.sigma[0];
    shared->record.reference_on_ground = false;
    CHECK_OK(session_solve(shared, &error));
    const double noise = shared->result.sigma[0], earth = session_earth_rate / sqrt(3.0);
    CHECK_BELOW(noise, 0.4 * session_earth_rate);
    CHECK_RELATIVE(with_earth, sqrt(earth * earth + noise * noise), 0.01);
}

static void test_spin(void **state)
{
    (void)state;
    cover(IMK_PROCEDURE_SPIN, session_spin, 10, 0.0);
}

/* One bench, every hold off by twenty times and more of what its noise explains, or a unit mounted
 * worse than exactly: every parameter is within what its interval says with a probability of 1e-5.
 */
static void holds_truth(imk_procedure procedure, void (*programme)(session *), double push,
                        double mounting)
{
    imk_error error;
    start(procedure, programme);
    shared->settings.sine_block = 0.1;
    shared->push[0] = 0.05 * push;
    shared->push[1] = push;
    shared->mounting = mounting;
    shared->stated = 1.0;
    session_log(shared, 5000, 0.0);
    CHECK_OK(session_solve(shared, &error));
    const imk_calibration_result *r = &shared->result;
    for (size_t p = 0; p < r->parameter_count; p++)
        CHECK_BELOW(fabs(r->value[p] - imk_model_parameter_get(&shared->truth, r->parameter[p])),
                    imk_calibration_half_width(r, (int)p, 1.0 - 1e-5));
}

/* Errors of holds are none of the many short blocks between them, which tell a bias as well as
 * before: by 4.4e-4 rad/s a sample over 120 s, and by 4.9e-3 m/s^2 a sample over 5 s, less what
 * lever arms take. */
static void test_errors_of_holds(void **state)
{
    (void)state;
    holds_truth(IMK_PROCEDURE_RATE_TABLE, session_rate_sine, 2e-2, 0.0);
    CHECK_RELATIVE(shared->result.sigma[0], 4.4e-5 / sqrt(120.0), 0.4);
    holds_truth(IMK_PROCEDURE_SPIN, session_spin, 2e-2, 0.0);
    CHECK_BELOW(2e-4, shared->result.sigma[0]);
    CHECK_BELOW(shared->result.sigma[0], 1e-3);
}

/* The least cost may be where an axis is across the rate, at the kink of its asymmetry. */
static void test_mounting(void **state)
{
    (void)state;
    holds_truth(IMK_PROCEDURE_RATE_TABLE, session_rate_steps, 0.0, 2e-3);
}

/* ---- what the log does not determine ---------------------------------------------------------
 */

static void only_about_z(session *b)
{
    static const double level[] = {0.0, 1.0, -1.0, 2.0, -2.0};
    const double force[3] = {0.0, 0.0, -session_gravity};
    for (int i = 0; i < 5; i++) {
        const double rate[3] = {0.0, 0.0, level[i]};
        session_go(b, rate, force, 0.5, 3.0);
    }
}

/* A table about z alone, with three levels of |rate|: of z scale factor, asymmetry, K2 and one odd
 * power; of x and y what z does to them. Nothing of g: the force never changes. */
static void test_undetermined(void **state)
{
    (void)state;
    imk_error error;
    start(IMK_PROCEDURE_RATE_TABLE, only_about_z);
    session_log(shared, 30, 0.0);
    CHECK_OK(session_solve(shared, &error));
    estimate(shared, "gyro.bias.fixed.x");
    estimate(shared, "gyro.misalignment.x.z");
    estimate(shared, "gyro.misalignment.y.z");
    estimate(shared, "gyro.scale_factor.fixed.z");
    estimate(shared, "gyro.nonlinearity.k3.z");
    static const char *const out[] = {"gyro.scale_factor.fixed.x",    "gyro.misalignment.x.y",
                                      "gyro.misalignment.z.x",        "gyro.nonlinearity.koq.z",
                                      "gyro.nonlinearity.k2.x",       "gyro.g_sensitivity.z.z",
                                      "gyro.nonlinearity.asymmetry.y"};
    for (size_t i = 0; i < sizeof out / sizeof *out; i++)
        if (!was_left_out(shared, out[i]))
            fail_msg("%s", out[i]);
    assert_int_equal(shared->result.parameter_count + shared->findings.undetermined_count, 33);
    /* A caller's own choice is kept, and the solver refuses it by name. */
    imk_calibration_default(&shared->calibration);
    shared->calibration.frame = IMK_FRAME_REFERENCE;
    shared->calibration.observation = shared->observation;
    shared->calibration.observation_capacity = BENCH_OBSERVATIONS;
    CHECK_OK(imk_calibration_free(&shared->calibration, IMK_GYRO, IMK_MODEL_BIAS, 0, 0));
    CHECK_OK(imk_calibration_free(&shared->calibration, IMK_GYRO, IMK_MODEL_SCALE_FACTOR, 0, 0));
    CHECK_OK(imk_procedure_observe(shared->procedure, &shared->calibration, &shared->record,
                                   &shared->settings, true, &shared->findings, shared->workspace,
                                   shared->workspace_size, &error));
    assert_int_equal(shared->calibration.parameter_count, 2);
    const size_t size = imk_calibration_workspace_size(&shared->calibration);
    void *memory = malloc(size);
    CHECK_STATUS(imk_calibration_solve(&shared->calibration, &shared->result, memory, size, &error),
                 IMK_ERROR_SINGULAR);
    assert_string_equal(error.field, "gyro.scale_factor.fixed.x");
    free(memory);
}

static void three_attitudes(session *b)
{
    for (int axis = 0; axis < 3; axis++)
        for (int i = -2; i <= 2; i++) {
            double rate[3], force[3];
            session_along(axis, i, rate);
            session_along(axis, session_gravity, force);
            session_go(b, rate, force, 0.5, 3.0);
        }
}

/* Upright on each axis but never upside down: the sum of the forces is one with the bias, so no
 * component of g-sensitivity may be stated. */
static void test_three_attitudes(void **state)
{
    (void)state;
    imk_error error;
    start(IMK_PROCEDURE_RATE_TABLE, three_attitudes);
    session_log(shared, 31, 0.0);
    CHECK_OK(session_solve(shared, &error));
    assert_true(was_left_out(shared, "gyro.g_sensitivity.x.x"));
    assert_true(was_left_out(shared, "gyro.g_sensitivity.x.y"));
    assert_true(was_left_out(shared, "gyro.g_sensitivity.x.z"));
}

/* ---- units, signs ----------------------------------------------------------------------------
 */

/* Counts without a sensitivity: a nominal one is found, and the estimates are relative to it. */
static void test_counts(void **state)
{
    (void)state;
    imk_error error;
    for (int sine = 0; sine < 2; sine++) {
        start(IMK_PROCEDURE_RATE_TABLE, sine ? session_rate_sine : session_rate_steps);
        shared->settings.sine_block = 0.1;
        session_log(shared, 32, 0.0);
        shared->record.counts[0] = true;
        for (int c = 0; c < 3; c++)
            for (size_t k = 0; k < shared->count; k++)
                shared->log[c][k] = floor(32768.0 + 50.0 * c + 5000.0 * shared->log[c][k] + 0.5);
        CHECK_OK(session_solve(shared, &error));
        const imk_triad *nominal = &shared->calibration.model.gyro;
        const imk_triad *found = &shared->result.model.gyro;
        for (int i = 0; i < 3; i++) {
            /* Nonlinear terms of the unit bend the line by some 1e-3. */
            CHECK_RELATIVE(nominal->sensitivity.value[i],
                           5000.0 * (1.0 + shared->truth.gyro.scale_factor.fixed.value[i]), 3e-3);
            const double counts =
                nominal->sensitivity.value[i] * (1.0 + found->scale_factor.fixed.value[i]);
            CHECK_RELATIVE(counts, 5000.0 * (1.0 + shared->truth.gyro.scale_factor.fixed.value[i]),
                           7.0 * found->scale_factor.fixed.sigma[i] + (sine ? 2e-4 : 0.0));
        }
    }
    /* Others refuse. */
    start(IMK_PROCEDURE_TUMBLE, session_tumble);
    session_log(shared, 33, 0.0);
    shared->record.counts[1] = true;
    CHECK_STATUS(session_solve(shared, &error), IMK_ERROR_UNIT_MISSING);
    assert_string_equal(error.field, "accel.sensitivity");
}

static void test_wrong_units(void **state)
{
    (void)state;
    imk_error error;
    start(IMK_PROCEDURE_RATE_TABLE, session_rate_steps);
    session_log(shared, 34, 0.0);
    for (size_t k = 0; k < shared->count; k++)
        shared->log[1][k] *= -1.0;
    CHECK_STATUS(session_solve(shared, &error), IMK_ERROR_CONFLICT);
    assert_string_equal(error.field, "gyro");
    assert_int_equal(error.index, 1);
    CHECK_CLOSE(error.value, -1.0, 0.02);
    start(IMK_PROCEDURE_CENTRIFUGE, session_centrifuge);
    session_log(shared, 35, 0.0);
    for (int c = 3; c < 6; c++)
        for (size_t k = 0; k < shared->count; k++)
            shared->log[c][k] /= session_gravity;
    CHECK_STATUS(session_solve(shared, &error), IMK_ERROR_CONFLICT);
    assert_string_equal(error.field, "accel");
    CHECK_CLOSE(error.value, 1.0 / session_gravity, 0.02);
}

/* Stretches in which a sensor is at its range, or that lack numbers, are left out and counted. */
static void test_saturated(void **state)
{
    (void)state;
    imk_error error;
    start(IMK_PROCEDURE_RATE_TABLE, session_rate_steps);
    session_log(shared, 36, 0.0);
    shared->log[2][(shared->hold_begin[4] + shared->hold_end[4]) / 2] = (double)NAN;
    imk_calibration_default(&shared->calibration);
    shared->calibration.observation = shared->observation;
    shared->calibration.observation_capacity = BENCH_OBSERVATIONS;
    for (int i = 0; i < 3; i++)
        shared->calibration.model.gyro.range.value[i] = 2.9;
    CHECK_OK(imk_procedure_observe(shared->procedure, &shared->calibration, &shared->record,
                                   &shared->settings, false, &shared->findings, shared->workspace,
                                   shared->workspace_size, &error));
    /* 3 rad/s of both signs in six runs, and the one without a number */
    assert_int_equal(shared->findings.left_out, 2 * 6 + 1);
    assert_int_equal(shared->findings.observations, shared->holds - 13);
    shared->calibration.observation_capacity = shared->calibration.observation_count + 10;
    CHECK_STATUS(imk_procedure_observe(shared->procedure, &shared->calibration, &shared->record,
                                       &shared->settings, false, &shared->findings,
                                       shared->workspace, shared->workspace_size, &error),
                 IMK_ERROR_WORKSPACE);
    assert_int_equal(shared->calibration.record_count, 1);
}

/* ---- lag of a filter ---------------------------------------------------------------------------
 */

/* Readings that come 2.3 samples late: the lag is found, and the scale factor is as without it. */
static void test_lag(void **state)
{
    (void)state;
    imk_error error;
    start(IMK_PROCEDURE_RATE_TABLE, session_rate_sine);
    shared->settings.sine_block = 0.05;
    session_log(shared, 37, 0.0);
    CHECK_OK(session_solve(shared, &error));
    const double scale = estimate(shared, "gyro.scale_factor.fixed.y");
    shift_log(shared, 2.3);
    CHECK_OK(session_solve(shared, &error));
    CHECK_CLOSE(shared->findings.lag, 0.023, 6.0 * shared->findings.lag_sigma + 1e-6);
    /* A straight line between samples loses (pi/100)^2/8 of a sine of 0.5 Hz at most, 1.2e-4. */
    CHECK_CLOSE(estimate(shared, "gyro.scale_factor.fixed.y"), scale, 1.5e-4);
}

/* ---- spin without a reference ------------------------------------------------------------------
 */

/* Lever arms from the unit's own gyros, about the vertical, with rests between: the components that
 * a steady rotation shows within six of their sigmas and what the rate's noise leaves. */
static void test_spin_alone(void **state)
{
    (void)state;
    imk_error error;
    start(IMK_PROCEDURE_SPIN, session_spin);
    session_log(shared, 38, 0.0);
    for (int j = 0; j < 3; j++)
        shared->record.reference_rate[j] = shared->record.reference_force[j] = NULL;
    CHECK_OK(session_solve(shared, &error));
    const char *const names[] = {"accel.lever_arm.x.x", "accel.lever_arm.y.y",
                                 "accel.lever_arm.z.z"};
    for (int i = 0; i < 3; i++) {
        const double truth = shared->truth.accel.lever_arm.value[i][i];
        const imk_triad *found = &shared->result.model.accel;
        /* The gyros' bias of 0.005 rad/s is not known: 2 x 0.005/15 of the effect, which the two
         * senses of rotation share out between them. */
        CHECK_CLOSE(estimate(shared, names[i]), truth,
                    6.0 * found->lever_arm.sigma[i][i] + 1e-3 * fabs(truth));
    }
    /* With the rates known but not the forces the rests stand for these. */
    for (int j = 0; j < 3; j++)
        shared->record.reference_rate[j] = shared->encoder[j];
    CHECK_OK(session_solve(shared, &error));
    for (int i = 0; i < 9; i++) {
        const imk_triad *found = &shared->result.model.accel;
        CHECK_CLOSE(found->lever_arm.value[i / 3][i % 3],
                    shared->truth.accel.lever_arm.value[i / 3][i % 3],
                    6.0 * found->lever_arm.sigma[i / 3][i % 3] + 1e-7);
    }
}

/* ---- a whole rate table, from a script ---------------------------------------------------------
 */

enum { STEPS = 64 };

/* Each axis to be turned about down, then up: a hold and six rates. */
static size_t table_steps(imk_motion_step step[STEPS])
{
    static const double level[] = {20.0, -20.0, 60.0, -60.0, 120.0, -120.0};
    const double half = 0.5 * session_pi, degree = session_pi / 180.0;
    const double roll[3][2] = {{0.0, 0.0}, {half, -half}, {0.0, session_pi}};
    const double pitch[3][2] = {{-half, half}, {0.0, 0.0}, {0.0, 0.0}};
    size_t count = 0;
    for (int run = 0; run < 6; run++) {
        step[count++] =
            (imk_motion_step){.kind = IMK_STEP_POSE,
                              .duration = 4.0,
                              .angle = {roll[run / 2][run % 2], pitch[run / 2][run % 2], 0.0}};
        step[count++] = (imk_motion_step){.kind = IMK_STEP_HOLD, .duration = 3.0};
        for (int i = 0; i < 6; i++)
            step[count++] = (imk_motion_step){.kind = IMK_STEP_ROTATE,
                                              .axis = run / 2,
                                              .rate = fabs(level[i]) * degree,
                                              .amount = 3.0 * level[i] * degree};
    }
    return count;
}

/* Log and reference of unit 40 on the trajectory of a script. */
static void record_script(session *b, const imk_motion_script *script)
{
    size_t pieces;
    CHECK_OK(imk_motion_script_pieces(script, &pieces, NULL));
    imk_trajectory_piece *piece = malloc(pieces * sizeof *piece);
    imk_trajectory trajectory;
    CHECK_OK(imk_motion_script_compile(script, piece, pieces, &trajectory, NULL));
    double length = 0.0;
    for (size_t i = 0; i < script->step_count; i++)
        length += imk_motion_step_duration(script, i);
    b->record.count = b->count = (size_t)(length * session_rate);
    assert_true(b->count < BENCH_SAMPLES);
    double *boundary = malloc((b->count + 1) * sizeof *boundary);
    for (size_t k = 0; k <= b->count; k++)
        boundary[k] = ((double)k - 1.0) / session_rate;
    double *const rate[3] = {b->encoder[0], b->encoder[1], b->encoder[2]};
    double *const force[3] = {b->force[0], b->force[1], b->force[2]};
    imk_trajectory_means(&trajectory, IMK_KERNEL_SCALAR, b->count, boundary, rate, NULL, force);
    b->truth = session_unit(b->procedure, 40);
    imk_simulation simulation = imk_simulation_default();
    simulation.motion.trajectory = &trajectory;
    simulation.seed = 40;
    double *columns[6];
    for (int c = 0; c < 6; c++)
        columns[c] = b->log[c];
    const size_t size = (imk_simulator_size(&b->truth, &simulation) + 63) / 64 * 64;
    void *memory = aligned_alloc(64, size);
    imk_simulator *simulator;
    CHECK_OK(imk_simulator_start(&b->truth, &simulation, &simulator, memory, size, NULL));
    imk_simulator_next(simulator, b->count, columns, NULL);
    free(memory);
    free(boundary);
    free(piece);
}

/* The command's way: a script compiled into a trajectory over the turning Earth, the reference its
 * means, the log from the same trajectory. The Earth's rate is in both. */
static void test_script(void **state)
{
    (void)state;
    imk_motion_step step[STEPS];
    imk_motion_script script = imk_motion_script_default();
    script.step_count = table_steps(step);
    script.step = step;
    start(IMK_PROCEDURE_RATE_TABLE, only_about_z);
    session *b = shared;
    record_script(b, &script);
    free(b->workspace);
    b->workspace_size = imk_procedure_workspace_size(b->procedure, &b->record, &b->settings);
    b->workspace = malloc(b->workspace_size);
    imk_error error;
    CHECK_OK(session_solve(b, &error));
    /* Six runs of a hold and six rates; the poses between turn and are none. */
    assert_int_equal(b->findings.observations, 42);
    assert_int_equal(b->result.parameter_count + b->findings.undetermined_count, 33);
    for (size_t p = 0; p < b->result.parameter_count; p++) {
        const imk_model_parameter place = b->result.parameter[p];
        const double instability = 0.5 / 3600.0 * session_pi / 180.0;
        /* Seven sigmas: 3e-12 for the normal distribution, 1e-7 at 30 degrees of freedom; the bias
         * also has what its instability has come to since long ago, 2.7 of it. */
        const double slow = place.term == IMK_MODEL_BIAS ? 7.0 * 2.7 * instability : 0.0;
        CHECK_CLOSE(b->result.value[p], imk_model_parameter_get(&b->truth, place),
                    7.0 * b->result.sigma[p] + slow);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_stretches),
        cmocka_unit_test(test_broken_stretches),
        cmocka_unit_test(test_absurd_rates),
        cmocka_unit_test(test_without_reference),
        cmocka_unit_test(test_offset),
        cmocka_unit_test(test_ambiguous_offset),
        cmocka_unit_test(test_offset_refused),
        cmocka_unit_test(test_rate_table),
        cmocka_unit_test(test_sine),
        cmocka_unit_test(test_tumble),
        cmocka_unit_test(test_centrifuge),
        cmocka_unit_test(test_unknown_heading),
        cmocka_unit_test(test_rate_of_table),
        cmocka_unit_test(test_spin),
        cmocka_unit_test(test_errors_of_holds),
        cmocka_unit_test(test_mounting),
        cmocka_unit_test(test_upright_only),
        cmocka_unit_test(test_undetermined),
        cmocka_unit_test(test_three_attitudes),
        cmocka_unit_test(test_counts),
        cmocka_unit_test(test_wrong_units),
        cmocka_unit_test(test_saturated),
        cmocka_unit_test(test_lag),
        cmocka_unit_test(test_spin_alone),
        cmocka_unit_test(test_script),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
