/* SPDX-License-Identifier: Apache-2.0 */
/* The estimator: regressors against imk_distort(), solutions against an independent linear least
 * squares, coverage of its intervals, bad poses, and every way a problem can be undetermined. */
#include "check.h"

#include "calibrate/coverage.h"
#include "calibrate/estimator/axis_reading_internal.h"
#include "calibrate/estimator/calibration_internal.h"
#include "calibrate/estimator_session.h"

#include "imukit/distributions.h"
#include "imukit/linear_algebra.h"
#include "imukit/procedure.h"

/* ---- regressors -------------------------------------------------------------------------------
 */

/* Every term of a bench unit, all of like size in the reading. */
static imk_model crowded_model(session *b)
{
    static const double size[IMK_MODEL_TERMS] = {.1,   .01,  .01,  .01, 1e-3, 1e-3, 1e-4, .01,
                                                 1e-3, 1e-3, 1e-4, .05, 1e-3, 1e-4, .1};
    imk_model m;
    imk_model_default(&m);
    imk_temperature_polynomial *const polynomials[4] = {
        &m.gyro.bias.temperature, &m.gyro.scale_factor.temperature, &m.accel.bias.temperature,
        &m.accel.scale_factor.temperature};
    for (int k = 0; k < 4; k++) {
        polynomials[k]->order = 3;
        polynomials[k]->reference = 298.15;
        polynomials[k]->minimum = 253.15;
        polynomials[k]->maximum = 333.15;
    }
    for (int sensor = 0; sensor < 2; sensor++)
        for (int term = 0; term < IMK_MODEL_TERMS; term++)
            for (int axis = 0; axis < 3; axis++)
                for (int k = 0; k < imk_model_term_elements(sensor, term); k++) {
                    double *value =
                        imk_model_parameter_at(&m,
                                               (imk_model_parameter){(uint8_t)sensor, (uint8_t)term,
                                                                     (uint8_t)axis, (uint8_t)k},
                                               NULL);
                    const bool power =
                        term == IMK_MODEL_BIAS_TEMPERATURE || term == IMK_MODEL_SCALE_TEMPERATURE;
                    if (value && !(power && k >= 3))
                        *value = size[term] * session_normal(b) / (power ? pow(30.0, k) : 1.0);
                }
    return m;
}

static double reading_of(const imk_model *model, int sensor, int axis, const imki_input *x)
{
    imk_distortion distortion;
    imk_stimulus stimulus;
    double value;
    memset(&stimulus, 0, sizeof stimulus);
    for (int j = 0; j < 3; j++) {
        stimulus.angular_rate[j] = &x->rate[j];
        stimulus.specific_force[j] = &x->force[j];
        stimulus.angular_acceleration[j] = &x->angular_acceleration[j];
    }
    stimulus.temperature = isnan(x->temperature) ? NULL : &x->temperature;
    stimulus.temperature_rate = &x->temperature_rate;
    CHECK_OK(imk_distortion_start(&distortion, model, NULL, IMK_KERNEL_SCALAR, NULL));
    imk_distort(&distortion, sensor, axis, &stimulus, 1, &value);
    return value;
}

static imki_input random_input(session *b)
{
    imki_input x;
    for (int j = 0; j < 3; j++) {
        x.rate[j] = session_normal(b);
        x.force[j] = 8.0 * session_normal(b);
        x.angular_acceleration[j] = 3.0 * session_normal(b);
    }
    x.temperature = 298.15 + 25.0 * session_normal(b); /* also beyond the valid range */
    x.temperature_rate = 0.1 * session_normal(b);
    return x;
}

/* Central differences: what is left of third order is 1e-12 of the terms here, rounding 1e-16/step.
 */
static double slope(const imk_model *model, int sensor, int axis, imki_input x, double *of,
                    const imki_input *base)
{
    const size_t place = (size_t)((char *)of - (const char *)base);
    const double step = 1e-4;
    imki_input up = x, down = x;
    double value;
    memcpy(&value, (const char *)&x + place, sizeof value);
    const double high = value + step, low = value - step;
    memcpy((char *)&up + place, &high, sizeof high);
    memcpy((char *)&down + place, &low, sizeof low);
    return (reading_of(model, sensor, axis, &up) - reading_of(model, sensor, axis, &down)) /
           (high - low);
}

static void readings_are_those_of_distort(void **state)
{
    (void)state;
    session *b = session_new(1, 1);
    for (int round = 0; round < 40; round++) {
        const imk_model m = crowded_model(b);
        imki_input x = random_input(b);
        if (round % 5 == 4)
            x.temperature = (double)NAN;
        for (int sensor = 0; sensor < 2; sensor++)
            for (int axis = 0; axis < 3; axis++) {
                const imki_axis_reading y = imki_axis_read(&m, sensor, axis, &x);
                /* Sums of some 30 terms of up to 30 in another order. */
                CHECK_CLOSE(y.value, reading_of(&m, sensor, axis, &x), 1e-13);
                for (int j = 0; j < 3; j++) {
                    CHECK_CLOSE(y.by_rate[j], slope(&m, sensor, axis, x, &x.rate[j], &x), 1e-8);
                    CHECK_CLOSE(y.by_force[j], slope(&m, sensor, axis, x, &x.force[j], &x), 1e-8);
                    CHECK_CLOSE(y.by_angular_acceleration[j],
                                slope(&m, sensor, axis, x, &x.angular_acceleration[j], &x), 1e-8);
                }
            }
    }
    session_free(b);
}

static void regressors_are_the_slopes_of_distort(void **state)
{
    (void)state;
    session *b = session_new(2, 1);
    for (int round = 0; round < 20; round++) {
        imk_model m = crowded_model(b);
        const imki_input x = random_input(b);
        for (int sensor = 0; sensor < 2; sensor++)
            for (int term = 0; term < IMK_MODEL_TERMS; term++)
                for (int k = 0; k < imk_model_term_elements(sensor, term); k++) {
                    const int axis = round % 3;
                    const imk_model_parameter place[2] = {
                        {(uint8_t)sensor, (uint8_t)term, (uint8_t)axis, (uint8_t)k},
                        {(uint8_t)sensor, (uint8_t)term, (uint8_t)((axis + 1) % 3), (uint8_t)k}};
                    double *value = imk_model_parameter_at(&m, place[0], NULL), row[2];
                    const bool power =
                        term == IMK_MODEL_BIAS_TEMPERATURE || term == IMK_MODEL_SCALE_TEMPERATURE;
                    if (!value || (power && k >= 3))
                        continue;
                    imki_calibration_regressors(&m, 2, place, sensor, axis, x.rate, x.force,
                                                x.angular_acceleration, x.temperature,
                                                x.temperature_rate, row);
                    const double kept = *value, step = power ? 1e-3 / pow(30.0, k) : 1e-3;
                    *value = kept + step;
                    const double high = reading_of(&m, sensor, axis, &x);
                    *value = kept - step;
                    const double low = reading_of(&m, sensor, axis, &x);
                    *value = kept;
                    /* Linear, but products of lever arms: K3 makes them of third order, 1e-6
                     * of K3 and the squared rates in central differences. */
                    CHECK_CLOSE(row[0], (high - low) / (2.0 * step),
                                1e-10 * (1.0 + fabs(row[0])) / (power ? step : 1.0) +
                                    (term == IMK_MODEL_LEVER_ARM ? 1e-7 : 0.0));
                    assert_true(row[1] == 0.0); /* of another axis */
                }
    }
    session_free(b);
}

/* ---- solutions --------------------------------------------------------------------------------
 */

/* With known inputs the problem is linear: an independent QR of the design, axis by axis, gives the
 * values, and the covariance with the common factor of the three axes. */
static void known_inputs_are_linear_least_squares(void **state)
{
    (void)state;
    enum { ROWS = 20, COLUMNS = 7 };
    session *b = session_new(3, 1);
    b->calibration.robust = false;
    b->calibration.frame = IMK_FRAME_REFERENCE;
    session_free_term(b, IMK_GYRO, IMK_MODEL_BIAS, false);
    session_free_term(b, IMK_GYRO, IMK_MODEL_SCALE_FACTOR, false);
    session_free_term(b, IMK_GYRO, IMK_MODEL_MISALIGNMENT, false);
    session_free_term(b, IMK_GYRO, IMK_MODEL_G_SENSITIVITY, false);
    for (int i = 0; i < ROWS; i++)
        session_known(b);
    CHECK_OK(session_solve(b));
    double square = 0.0, x[3][COLUMNS], covariance[COLUMNS * COLUMNS];
    for (int axis = 0; axis < 3; axis++) {
        double a[ROWS * COLUMNS], beta[COLUMNS], y[ROWS];
        for (int i = 0; i < ROWS; i++) {
            const imk_observation *o = &b->observation[i];
            a[i * COLUMNS] = 1.0;
            memcpy(&a[i * COLUMNS + 1], o->rate, sizeof o->rate);
            memcpy(&a[i * COLUMNS + 4], o->force, sizeof o->force);
            y[i] = o->reading[IMK_GYRO][axis] - o->rate[axis];
        }
        CHECK_OK(imk_qr_factor(ROWS, COLUMNS, a, beta));
        CHECK_OK(imk_qr_solve(ROWS, COLUMNS, a, beta, y, x[axis]));
        CHECK_OK(imk_qr_covariance(ROWS, COLUMNS, a, covariance));
        for (int i = COLUMNS; i < ROWS; i++)
            square += y[i] * y[i] / (b->sigma[0] * b->sigma[0]);
    }
    const double factor = sqrt(square / (3.0 * (ROWS - COLUMNS)));
    CHECK_RELATIVE(b->result.group[IMK_GROUP_GYRO].factor, factor, 1e-9);
    CHECK_CLOSE(b->result.group[IMK_GROUP_GYRO].degrees_of_freedom, 3.0 * (ROWS - COLUMNS), 1e-6);
    for (size_t p = 0; p < b->result.parameter_count; p++) {
        const imk_model_parameter place = b->result.parameter[p];
        const int column = place.term == IMK_MODEL_BIAS            ? 0
                           : place.term == IMK_MODEL_SCALE_FACTOR  ? 1 + place.axis
                           : place.term == IMK_MODEL_G_SENSITIVITY ? 4 + place.element
                                                                   : 1 + place.element;
        const double sigma = b->sigma[0] * factor * sqrt(covariance[column * COLUMNS + column]);
        CHECK_CLOSE(b->result.value[p], x[place.axis][column], 1e-4 * sigma);
        CHECK_RELATIVE(b->result.sigma[p], sigma, 1e-6);
        /* One factor has 39 degrees, Student's t 2.0227; that each axis may have one of its own, of
         * 13, moves the interval: not below the normal one, not beyond t of 13 degrees. */
        const double half = imk_calibration_half_width(&b->result, (int)p, 0.95) / sigma;
        assert_true(half >= 1.959963984 && half <= 2.160368656462792);
    }
    session_free(b);
}

/* Without errors of the readings the truth comes back to the tolerance of the iteration. */
static void exact_readings_give_the_truth(void **state)
{
    (void)state;
    session *b = session_new(4, 1);
    b->sigma[0] = b->sigma[1] = 1e-12;
    b->calibration.earth_rate = 0.0;
    session_free_static(b);
    session_know_the_rest(b);
    for (int i = 0; i < 20; i++) {
        session_pose(b, 1.0);
        for (int sensor = 0; sensor < 2; sensor++)
            for (int axis = 0; axis < 3; axis++)
                b->observation[i].sigma[sensor][axis] = sensor == 0 ? 1e-6 : 1e-5;
    }
    CHECK_OK(session_solve(b));
    for (size_t p = 0; p < b->result.parameter_count; p++)
        CHECK_CLOSE(b->result.value[p], imk_model_parameter_get(&b->truth, b->result.parameter[p]),
                    1e-8);
    session_free(b);
}

/* A mounting off by 1 deg, known to 1 deg, is found; placements of a tenth of it are too. */
static void fixtures_and_placements_are_found(void **state)
{
    (void)state;
    session *b = session_new(5, 1);
    imk_calibration *c = &b->calibration;
    static const double mounting[3] = {.012, -.017, .009};
    c->frame = IMK_FRAME_REFERENCE;
    c->fixture_count = 1;
    c->fixture_sigma[0] = .0175;
    session_free_term(b, IMK_GYRO, IMK_MODEL_BIAS, false);
    session_free_term(b, IMK_GYRO, IMK_MODEL_SCALE_FACTOR, false);
    session_free_term(b, IMK_ACCEL, IMK_MODEL_BIAS, false);
    session_free_term(b, IMK_ACCEL, IMK_MODEL_SCALE_FACTOR, false);
    session_know_the_rest(b);
    for (int i = 0; i < 24; i++) {
        session_known(b); /* what the unit sees; its nominal axes are turned back by the mounting */
        imk_observation *o = &b->observation[i];
        const imk_matrix3 turn = imk_quaternion_to_matrix(imk_quaternion_from_rotation_vector(
            (imk_vector3){{mounting[0], mounting[1], mounting[2]}}));
        imk_vector3 rate, force;
        memcpy(rate.v, o->rate, sizeof o->rate);
        memcpy(force.v, o->force, sizeof o->force);
        rate = imk_matrix3_apply(turn, rate);
        force = imk_matrix3_apply(turn, force);
        for (int j = 0; j < 3; j++) {
            o->rate[j] = rate.v[j];
            o->force[j] = force.v[j];
        }
        o->fixture = 0;
        o->knowledge = i % 2 ? IMK_INPUT_PLACED : IMK_INPUT_KNOWN;
        o->placement_sigma = 1e-5;
    }
    CHECK_OK(session_solve(b));
    /* 24 forces of 8 m/s^2 an axis to 1e-3: 2e-5 rad; five times that. */
    for (int j = 0; j < 3; j++)
        CHECK_CLOSE(b->result.fixture[0][j], mounting[j], 1e-4);
    for (size_t p = 0; p < b->result.parameter_count; p++)
        CHECK_CLOSE(b->result.value[p], imk_model_parameter_get(&b->truth, b->result.parameter[p]),
                    6.0 * b->result.sigma[p]);
    session_free(b);
}

/* Stated sigmas enter by their ratios only. */
static void understated_sigmas_change_nothing(void **state)
{
    (void)state;
    session *a = session_new(6, 1), *b = session_new(6, 1);
    session *both[2] = {a, b};
    b->understated = 3.0;
    for (int k = 0; k < 2; k++) {
        both[k]->calibration.earth_rate = 0.0; /* whose part no factor multiplies */
        session_free_static(both[k]);
        session_know_the_rest(both[k]);
        for (int i = 0; i < 24; i++)
            session_pose(both[k], 1.0);
        CHECK_OK(session_solve(both[k]));
    }
    for (size_t p = 0; p < a->result.parameter_count; p++) {
        CHECK_CLOSE(a->result.value[p], b->result.value[p], 0.01 * a->result.sigma[p]);
        CHECK_RELATIVE(a->result.sigma[p], b->result.sigma[p], 3e-3);
    }
    CHECK_RELATIVE(b->result.group[IMK_GROUP_ACCEL].factor,
                   3.0 * a->result.group[IMK_GROUP_ACCEL].factor, 3e-3);
    CHECK_RELATIVE(b->result.chi_square, 9.0 * a->result.chi_square, 0.01);
    session_free(a);
    session_free(b);
}

/* The information at the solution is the inverse of its covariance, factors 1. */
static void information_is_the_inverse_covariance(void **state)
{
    (void)state;
    session *b = session_new(7, 1);
    imk_calibration *c = &b->calibration;
    c->fixture_count = 1;
    c->fixture_sigma[0] = 1e-3;
    c->frame = IMK_FRAME_REFERENCE;
    session_free_all(b);
    session_know_the_rest(b);
    for (int i = 0; i < 8; i++)
        session_known(b);
    for (int i = 0; i < 8; i++)
        b->observation[i].fixture = 0;
    for (int i = 0; i < 14; i++)
        session_pose(b, 1.0);
    CHECK_OK(session_solve(b));
    const size_t count = c->parameter_count, size = imk_calibration_workspace_size(c);
    c->model = b->result.model;
    for (size_t i = 0; i < c->observation_count; i++) {
        imk_observation *o = &b->observation[i];
        if (o->knowledge == IMK_INPUT_GRAVITY)
            for (int j = 0; j < 3; j++)
                o->force[j] = c->gravity * o->vertical[j];
        for (int sensor = 0; sensor < 2; sensor++)
            for (int axis = 0; axis < 3; axis++)
                o->sigma[sensor][axis] *=
                    b->result.group[sensor == IMK_GYRO ? IMK_GROUP_GYRO : IMK_GROUP_ACCEL].factor;
    }
    double *information = calloc(count * count, sizeof *information);
    void *workspace = malloc(size);
    CHECK_OK(imk_calibration_information(c, information, workspace, size, NULL));
    for (size_t p = 0; p < count; p++)
        for (size_t q = 0; q < count; q++) {
            double sum = 0.0;
            for (size_t k = 0; k < count; k++)
                sum += information[p * count + k] * b->result.covariance[k * count + q];
            /* The mounting found is not 0: its derivative differs by that, 1e-3. */
            CHECK_CLOSE(sum * b->result.sigma[p] / b->result.sigma[q], p == q ? 1.0 : 0.0, 0.02);
        }
    free(workspace);
    free(information);
    session_free(b);
}

/* ---- turns ------------------------------------------------------------------------------------
 */

enum { TURN_POSES = 16, TURN_SAMPLES = 200, HOLD = 20 };

/* Poses joined by turns at constant rates; exact readings. The true gyros are off by what the bench
 * has; their parameters come from the turns alone. */
static void turns_give_the_gyros(void **state)
{
    (void)state;
    session *b = session_new(8, 1);
    imk_calibration *c = &b->calibration;
    static double reading[2][3][TURN_POSES * (TURN_SAMPLES + HOLD)];
    const double dt = 0.01;
    c->earth_rate = 0.0;
    b->sigma[0] = b->sigma[1] = 1e-13;
    memset(&b->truth.gyro.g_sensitivity, 0, sizeof b->truth.gyro.g_sensitivity);
    session_free_static(b);
    c->parameter_count -= 9; /* g-sensitivity is left out */
    session_free_term(b, IMK_GYRO, IMK_MODEL_SCALE_FACTOR, false);
    session_free_term(b, IMK_GYRO, IMK_MODEL_MISALIGNMENT, false);
    session_know_the_rest(b);
    imk_test_record record = {.name = "turns", .dt = dt, .axis_count = {3, 3}};
    for (int s = 0; s < 2; s++)
        for (int i = 0; i < 3; i++)
            record.reading[s][i] = reading[s][i];
    double vertical[3];
    size_t k = 0;
    session_unit_vector(b, vertical);
    for (int pose = 0; pose < TURN_POSES; pose++) {
        static const double still[3] = {0.0, 0.0, 0.0};
        double force[3], axis[3];
        for (int j = 0; j < 3; j++)
            force[j] = c->gravity * vertical[j];
        imk_observation o = session_read(b, still, force, NULL, (double)NAN);
        o.knowledge = IMK_INPUT_GRAVITY;
        o.record = 0;
        o.begin = k;
        o.end = k + HOLD;
        memset(o.force, 0, sizeof o.force);
        for (int s = 0; s < 2; s++)
            for (int i = 0; i < 3; i++) {
                o.sigma[s][i] = s == 0 ? 1e-6 : 1e-5;
                for (size_t n = k; n < k + HOLD; n++)
                    reading[s][i][n] = o.reading[s][i];
            }
        k += HOLD;
        assert_int_equal(imk_calibration_observe(c, &o), pose);
        if (pose + 1 == TURN_POSES)
            break;
        session_unit_vector(b, axis);
        const double rate = 0.8 + 0.1 * pose;
        double w[3], back[3];
        for (int j = 0; j < 3; j++) {
            w[j] = rate * axis[j];
            back[j] = -w[j] * dt;
        }
        const imk_quaternion step =
            imk_quaternion_from_rotation_vector((imk_vector3){{back[0], back[1], back[2]}});
        c->turn[pose] = (imk_turn){
            .from = pose, .to = pose + 1, .begin = k, .end = k + TURN_SAMPLES, .sigma = 1e-5};
        for (int n = 0; n < TURN_SAMPLES; n++, k++) {
            const imk_observation turning = session_read(b, w, force, NULL, (double)NAN);
            imk_vector3 v = {{vertical[0], vertical[1], vertical[2]}};
            v = imk_quaternion_rotate(step, v);
            memcpy(vertical, v.v, sizeof vertical);
            for (int s = 0; s < 2; s++)
                for (int i = 0; i < 3; i++)
                    reading[s][i][k] = turning.reading[s][i];
        }
    }
    record.count = k;
    c->record[c->record_count++] = &record;
    c->turn_count = TURN_POSES - 1;
    CHECK_OK(session_solve(b));
    for (size_t p = 0; p < b->result.parameter_count; p++)
        CHECK_CLOSE(b->result.value[p], imk_model_parameter_get(&b->truth, b->result.parameter[p]),
                    1e-7);
    assert_int_equal(b->result.turns_refused, 0);
    CHECK_RELATIVE(c->turn[0].angle, 0.8 * TURN_SAMPLES * dt, 1e-6);

    /* One turn that something went wrong with is refused, alone. */
    c->turn[5].begin += TURN_SAMPLES / 10;
    for (int t = 0; t < TURN_POSES - 1; t++)
        c->turn[t].sigma = 1e-4;
    CHECK_OK(session_solve(b));
    assert_int_equal(b->result.turns_refused, 1);
    assert_int_equal(b->result.observations_refused, 0);
    assert_true(c->turn[5].weight == 0.0);
    session_free(b);
}

/* ---- statistics -------------------------------------------------------------------------------
 */

/* Limits for a false alarm of 1e-6 over some hundred parameters. */
static void check_coverage(const coverage_count *count)
{
    const double n = (double)count->benches;
    const size_t least = coverage_least_held(count->benches, 0.95, 1e-8);
    assert_int_equal(count->failed, 0);
    for (size_t p = 0; p < count->parameter_count; p++) {
        assert_true(count->held[p] >= least);
        /* The mean of n of Student's t with 12 degrees or more: 6 of its sigmas, 1.1/sqrt(n). */
        CHECK_CLOSE(coverage_bias(count, p), 0.0, 6.0 * 1.1 / sqrt(n));
    }
}

static void run_benches(uint32_t benches, int poses, int bad, int known, double understated)
{
    coverage_count count;
    size_t refused = 0;
    memset(&count, 0, sizeof count);
    for (uint32_t i = 0; i < benches; i++) {
        session *b = session_new(11, i);
        b->understated = understated;
        if (known > 0) {
            b->calibration.frame = IMK_FRAME_REFERENCE;
            session_free_all(b);
        } else {
            session_free_static(b);
        }
        session_know_the_rest(b);
        for (int k = 0; k < poses; k++)
            session_pose(b, k < bad ? 1.03 : 1.0);
        for (int k = 0; k < known; k++)
            session_known(b);
        if (session_solve(b) == IMK_OK)
            coverage_add(&count, &b->result, &b->truth, 0.95);
        else
            count.failed++;
        refused += b->result.observations_refused;
        session_free(b);
    }
    check_coverage(&count);
    /* Clean: one in a hundred benches loses one, by two groups two: of n benches a Poisson number
     * of mean 0.02 n, which is above 0.02 n + 8 sqrt(0.02 n) + 2 with a probability below 1e-7. All
     * the bad ones are found: 3 % are 300 sigma. */
    const double bad_ones = (double)bad * benches, lost = 0.02 * benches;
    CHECK_BELOW((double)refused, bad_ones + lost + 8.0 * sqrt(lost) + 2.0);
    if (bad > 0)
        CHECK_BELOW(bad_ones - (double)refused, lost);
}

static void intervals_hold_the_truth(void **state)
{
    (void)state;
    run_benches(check_runs(80), 24, 0, 0, 1.0);
}

static void intervals_hold_with_understated_sigmas(void **state)
{
    (void)state;
    run_benches(check_runs(50), 24, 0, 0, 2.5);
}

static void intervals_hold_with_bad_poses(void **state)
{
    (void)state;
    run_benches(check_runs(50), 24, 3, 0, 1.0);
}

static void intervals_hold_for_joint_logs(void **state)
{
    (void)state;
    run_benches(check_runs(50), 14, 0, 12, 1.0);
}

/* ---- what cannot be solved --------------------------------------------------------------------
 */

/* The result is as before, and says so by its first byte. */
static void expect_refusal(session *b, imk_status status, const char *field)
{
    memset(&b->result, 0x5a, sizeof b->result);
    CHECK_STATUS(session_solve(b), status);
    if (strstr(b->error.field, field) == NULL)
        fail_msg("field is %s, expected %s", b->error.field, field);
    for (size_t i = 0; i < sizeof b->result; i++)
        assert_int_equal(((const unsigned char *)&b->result)[i], 0x5a);
}

static void one_pose_again_and_again(void **state)
{
    (void)state;
    static const double up[3] = {0.0, 0.6, 0.8};
    session *b = session_new(21, 1);
    session_free_static(b);
    for (int i = 0; i < 24; i++)
        session_pose_along(b, up, 1.0);
    expect_refusal(b, IMK_ERROR_SINGULAR, "accel.");
    session_free(b);
}

/* All in the plane of x and y: what z does stays unknown. */
static void poses_in_a_plane(void **state)
{
    (void)state;
    session *b = session_new(22, 1);
    session_free_static(b);
    b->calibration.parameter_count -= 9; /* g-sensitivity */
    for (int i = 0; i < 24; i++) {
        const double v[3] = {cos(0.3 * i), sin(0.3 * i), 0.0};
        session_pose_along(b, v, 1.0);
    }
    expect_refusal(b, IMK_ERROR_SINGULAR, "z");
    session_free(b);
}

static void too_few_poses(void **state)
{
    (void)state;
    session *b = session_new(23, 1);
    session_free_static(b);
    for (int i = 0; i < 8; i++)
        session_pose(b, 1.0);
    expect_refusal(b, IMK_ERROR_TOO_SHORT, "accel");
    CHECK_CLOSE(b->error.value, 8.0, 0.0);
    CHECK_CLOSE(b->error.limit, 9.0, 0.0);
    session_free(b);
}

static void readings_that_are_no_numbers(void **state)
{
    (void)state;
    session *b = session_new(24, 1);
    session_free_static(b);
    for (int i = 0; i < 24; i++)
        session_pose(b, 1.0);
    b->observation[7].reading[IMK_ACCEL][1] = (double)INFINITY;
    expect_refusal(b, IMK_ERROR_NOT_FINITE, "observation");
    assert_int_equal(b->error.index, 7);
    /* NaN is an axis that was not observed: the pose serves with the others. */
    b->observation[7].reading[IMK_ACCEL][1] = (double)NAN;
    CHECK_OK(session_solve(b));
    assert_int_equal(b->result.group[IMK_GROUP_ACCEL].count, 71);
    assert_true(isnan(b->observation[7].residual[IMK_ACCEL][1]));
    for (int i = 0; i < 24; i++)
        for (int axis = 0; axis < 3; axis++)
            b->observation[i].reading[IMK_ACCEL][axis] = (double)NAN;
    expect_refusal(b, IMK_ERROR_TOO_SHORT, "accel");
    session_free(b);
}

static void frames_that_contradict(void **state)
{
    (void)state;
    session *b = session_new(25, 1);
    for (int i = 0; i < 24; i++)
        session_pose(b, 1.0);
    b->calibration.frame = IMK_FRAME_REFERENCE; /* which no pose knows */
    session_free_static(b);
    expect_refusal(b, IMK_ERROR_CONFLICT, "frame");
    b->calibration.frame = IMK_FRAME_UPPER; /* with all six free */
    expect_refusal(b, IMK_ERROR_CONFLICT, "frame");
    session_free(b);
}

static void problems_that_are_none(void **state)
{
    (void)state;
    session *b = session_new(26, 1);
    for (int i = 0; i < 24; i++)
        session_pose(b, 1.0);
    expect_refusal(b, IMK_ERROR_ARGUMENT, "parameters");
    session_free_static(b);
    b->observation[3].record = 0;
    expect_refusal(b, IMK_ERROR_ARGUMENT, "observation");
    b->observation[3].record = -1;
    imk_calibration_result *result = &b->result;
    CHECK_STATUS(imk_calibration_solve(&b->calibration, result, b->workspace, 100, NULL),
                 IMK_ERROR_WORKSPACE);
    b->calibration.cookie = 0;
    CHECK_STATUS(
        imk_calibration_solve(&b->calibration, result, b->workspace, b->workspace_size, NULL),
        IMK_ERROR_UNINITIALISED);
    session_free(b);
}

/* Counts without a sensitivity cannot be forces. */
static void counts_need_a_sensitivity(void **state)
{
    (void)state;
    session *b = session_new(27, 1);
    const imk_test_record record = {.count = 1, .dt = 0.01, .counts = {true, true}};
    b->calibration.record[0] = &record;
    b->calibration.record_count = 1;
    session_free_static(b);
    for (int i = 0; i < 24; i++) {
        session_pose(b, 1.0);
        b->observation[i].record = 0;
    }
    expect_refusal(b, IMK_ERROR_UNIT_MISSING, "gyro.sensitivity");
    for (int i = 0; i < 3; i++) {
        imk_triad *triads[2] = {&b->calibration.model.gyro, &b->calibration.model.accel};
        for (int s = 0; s < 2; s++) {
            triads[s]->sensitivity.value[i] = 400.0;
            triads[s]->zero_offset.value[i] = 1000.0;
        }
    }
    for (int i = 0; i < 24; i++)
        for (int s = 0; s < 2; s++)
            for (int axis = 0; axis < 3; axis++) {
                imk_observation *o = &b->observation[i];
                o->reading[s][axis] = 1000.0 + 400.0 * o->reading[s][axis];
                o->sigma[s][axis] *= 400.0;
            }
    CHECK_OK(session_solve(b));
    for (size_t p = 0; p < b->result.parameter_count; p++)
        CHECK_CLOSE(b->result.value[p], imk_model_parameter_get(&b->truth, b->result.parameter[p]),
                    8.0 * b->result.sigma[p]);
    session_free(b);
}

/* ---- diagnostics
 * -----------------------------------------------------------------------------------
 */

static bool doubted(session *b, imk_diagnostic kind)
{
    imk_diagnostic_finding found[32];
    const size_t count = imk_solution_diagnostics(&b->calibration, &b->result, 32, found);
    for (size_t i = 0; i < count; i++)
        if (found[i].kind == kind)
            return true;
    return false;
}

/* Eleven poses leave the accelerometers 33 - 9 - 22 = 2 degrees of freedom, too few for a factor,
 * and twelve poses 3. An axis of a tenth of the noise is told of the first. */
static void unequal_noise_is_doubted_where_nothing_tests_it(void **state)
{
    (void)state;
    for (int many = 0; many < 2; many++)
        for (int unequal = 0; unequal < 2; unequal++) {
            session *b = session_new(33, 1);
            session_free_static(b);
            session_know_the_rest(b);
            for (int i = 0; i < (many ? 12 : 11); i++) {
                session_pose(b, 1.0);
                b->observation[i].sigma[IMK_ACCEL][1] *= unequal ? 0.1 : 1.0;
            }
            CHECK_OK(session_solve(b));
            assert_int_equal(doubted(b, IMK_DIAGNOSTIC_UNEQUAL_AXES), unequal && !many);
            session_free(b);
        }
}

static void diagnostics_about_solutions(void **state)
{
    (void)state;
    session *b = session_new(31, 1);
    imk_diagnostic_finding found[4];
    session_free_static(b);
    session_know_the_rest(b);
    for (int i = 0; i < 24; i++)
        session_pose(b, 1.0);
    CHECK_OK(session_solve(b));
    assert_int_equal(imk_solution_diagnostics(&b->calibration, &b->result, 4, found), 0);
    for (int i = 0; i < 24; i++) /* sigmas ten times too small */
        for (int axis = 0; axis < 3; axis++)
            b->observation[i].sigma[IMK_ACCEL][axis] *= 0.1;
    CHECK_OK(session_solve(b));
    assert_true(doubted(b, IMK_DIAGNOSTIC_RESIDUALS));
    b->calibration.gravity /= 9.80665; /* g taken for m/s^2, or the reverse */
    CHECK_OK(session_solve(b));
    assert_true(doubted(b, IMK_DIAGNOSTIC_GRAVITY_UNIT));
    session_free(b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(readings_are_those_of_distort),
        cmocka_unit_test(regressors_are_the_slopes_of_distort),
        cmocka_unit_test(known_inputs_are_linear_least_squares),
        cmocka_unit_test(exact_readings_give_the_truth),
        cmocka_unit_test(fixtures_and_placements_are_found),
        cmocka_unit_test(understated_sigmas_change_nothing),
        cmocka_unit_test(information_is_the_inverse_covariance),
        cmocka_unit_test(turns_give_the_gyros),
        cmocka_unit_test(intervals_hold_the_truth),
        cmocka_unit_test(intervals_hold_with_understated_sigmas),
        cmocka_unit_test(intervals_hold_with_bad_poses),
        cmocka_unit_test(intervals_hold_for_joint_logs),
        cmocka_unit_test(one_pose_again_and_again),
        cmocka_unit_test(poses_in_a_plane),
        cmocka_unit_test(too_few_poses),
        cmocka_unit_test(readings_that_are_no_numbers),
        cmocka_unit_test(frames_that_contradict),
        cmocka_unit_test(problems_that_are_none),
        cmocka_unit_test(counts_need_a_sensitivity),
        cmocka_unit_test(unequal_noise_is_doubted_where_nothing_tests_it),
        cmocka_unit_test(diagnostics_about_solutions),
    };
    return cmocka_run_group_tests_name("calibration", tests, NULL, NULL);
}
