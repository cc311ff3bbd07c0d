/* SPDX-License-Identifier: Apache-2.0 */
/* Covariance of an aided navigator: textbook filters in closed form, the Riccati equation of SciPy,
 * the filter's own covariance where it knows the truth, and what it does not know. */
#include "car_profile.h"
#include "check.h"
#include "navigate/drift/drift_aided_internal.h"

#include "aided_riccati.inc"

#include "imukit/drift.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double degree = 3.14159265358979323846 / 180.0;

/* ---- a filter of constant gain ----------------------------------------------------------------
 *
 * Position and velocity along one axis, predicted over T = 1 and corrected by a and b times what a
 * reading of the position differs (alpha-beta filter). White noise of the readings of variance 1
 * leaves after the correction, in steady state (the fixed point of X <- A X A^T + Q, by hand),
 *
 *     position  (2 a^2 + b (2 - 3 a))/(a (4 - 2 a - b)),     velocity  2 b^2/(a (4 - 2 a - b)).
 *
 * A constant error e of the readings ends as e in the position and as 0 in the velocity. */

static const double alpha = 0.4, beta = 0.1;

typedef struct constant_gain {
    imki_drift_plan plan;
    imk_drift_source source[2];
    imki_drift_part part[2];
    imki_drift_element element[2];
    imki_drift_column column[1];
    imki_drift_driver driver[2];
    double vector[2 * 3 * 9], covariance[2 * 81];
    imki_driver_step over[2][IMKI_DRIFT_SLOTS];
    double h[9], gain[9], enter[1][IMKI_UPDATE_ROWS], decay[1];
    double coefficient[1][IMKI_DRIFT_MOMENTS][9];
    imki_aided_step aided;
    imki_drift_step step;
} constant_gain;

static void start_constant_gain(constant_gain *c)
{
    memset(c, 0, sizeof *c);
    c->plan = (imki_drift_plan){.states = 9,
                                .vector = c->vector,
                                .covariance = c->covariance,
                                .source = c->source,
                                .part = c->part,
                                .element = c->element,
                                .column = c->column,
                                .driver = c->driver};
    const imki_drift_column column = imki_drift_column_of(IMKI_COLUMN_AID, 0, 0, IMKI_AID_WHITE);
    const imki_drift_driver white = imki_driver_white(), constant = imki_driver_constant();
    imki_drift_add_source(&c->plan, "aid", "white", "", "");
    imki_drift_add_noise(&c->plan, IMKI_ELEMENT_NOISE, &column, &white, 1.0);
    imki_drift_add_source(&c->plan, "aid", "constant", "", "");
    imki_drift_add_constant(&c->plan, IMKI_ELEMENT_SIZE, &column, &constant, 3.0, 0.0);
    for (int i = 0; i < 9; i++)
        c->step.phi.m[i][i] = 1.0;
    c->step.phi.m[6][3] = 1.0;
    c->step.h = 1.0;
    c->step.moments = 1;
    c->step.repeat = 1;
    c->step.column = c->coefficient;
    c->step.aided = &c->aided;
    for (int d = 0; d < 2; d++)
        imki_driver_over(&c->driver[d], 1.0, 1, &c->over[d][0]);
    c->h[6] = 1.0;
    c->gain[6] = alpha;
    c->gain[3] = beta;
    c->enter[0][0] = -1.0;
    c->aided = (imki_aided_step){.states = 9, .rate = 1.0, .decay = c->decay, .update_count = 1};
    c->aided.update[0] =
        (imki_drift_update){.rows = 1, .h = c->h, .gain = c->gain, .enter = c->enter};
}

static void test_constant_gain(void **state)
{
    (void)state;
    constant_gain c;
    start_constant_gain(&c);
    for (int k = 0; k < 500; k++)
        for (int source = 0; source < 2; source++)
            imki_drift_propagate(&c.plan, &c.part[source], &c.step, c.over);
    const double below = alpha * (4.0 - 2.0 * alpha - beta);
    const double *p = c.part[0].covariance;
    CHECK_RELATIVE(p[6 * 9 + 6], (2.0 * alpha * alpha + beta * (2.0 - 3.0 * alpha)) / below, 1e-12);
    CHECK_RELATIVE(p[3 * 9 + 3], 2.0 * beta * beta / below, 1e-12);
    CHECK_RELATIVE(c.element[1].x[6], 3.0, 1e-12);
    CHECK_CLOSE(c.element[1].x[3], 0.0, 1e-12);
}

/* Readings whose error is a Gauss-Markov process of variance 1 and time 5: the covariance of
 * position, velocity and error together is the fixed point of X <- A X A^T + Q, with A the filter
 * behind the process; found here by running that through. */
static void test_constant_gain_correlated(void **state)
{
    (void)state;
    constant_gain c;
    start_constant_gain(&c);
    const double left = exp(-0.2);
    c.driver[0] = imki_driver_gauss_markov(5.0);
    imki_driver_over(&c.driver[0], 1.0, 1, &c.over[0][0]);
    c.element[0].covariance[0][0] = 1.0;
    const double a[3][3] = {{1.0 - alpha, 1.0 - alpha, alpha * left},
                            {-beta, 1.0 - beta, beta * left},
                            {0.0, 0.0, left}};
    const double g[3] = {alpha, beta, 1.0}, variance = 1.0 - left * left;
    double x[3][3] = {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}};
    for (int k = 0; k < 300; k++) {
        double next[3][3];
        imki_drift_propagate(&c.plan, &c.part[0], &c.step, c.over);
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) {
                next[i][j] = variance * g[i] * g[j];
                for (int m = 0; m < 3; m++)
                    for (int n = 0; n < 3; n++)
                        next[i][j] += a[i][m] * x[m][n] * a[j][n];
            }
        memcpy(x, next, sizeof x);
    }
    CHECK_RELATIVE(c.part[0].covariance[6 * 9 + 6], x[0][0], 1e-12);
    CHECK_RELATIVE(c.part[0].covariance[3 * 9 + 3], x[1][1], 1e-12);
    CHECK_RELATIVE(c.part[0].covariance[6 * 9 + 3], x[0][1], 1e-12);
    CHECK_RELATIVE(c.element[0].cross[0][6], x[0][2], 1e-12);
}

/* ---- analyses ---------------------------------------------------------------------------------
 */

/* The caller frees what the analysis stands in: itself. */
static imk_drift_analysis *analyse(const imk_model *model, const imk_drift_settings *settings)
{
    const size_t size = imk_drift_covariance_size(model, settings);
    void *memory = aligned_alloc(64, (size + 63) / 64 * 64);
    imk_drift_analysis *analysis = NULL;
    imk_error error;
    assert_non_null(memory);
    CHECK_OK(imk_drift_covariance(model, settings, NULL, &analysis, memory, size, &error));
    assert_ptr_equal(analysis, memory);
    return analysis;
}

static void add_gauss_markov(imk_triad *triad, double sigma, double time)
{
    struct imk_gauss_markov_term *term = &triad->noise.gauss_markov[0];
    triad->noise.gauss_markov_count = 1;
    for (int i = 0; i < 3; i++) {
        term->sigma.value[i] = sigma;
        term->correlation_time.value[i] = time;
    }
}

static void set_white(imk_model *model, double gyro, double accel)
{
    imk_model_default(model);
    for (int i = 0; i < 3; i++) {
        model->gyro.noise.white.value[i] = gyro;
        model->accel.noise.white.value[i] = accel;
    }
}

static imk_aid aid_of(imk_aid_kind kind, double sigma)
{
    imk_aid aid = imk_aid_default(kind);
    for (size_t i = 0; i < imk_aid_axes(kind); i++)
        aid.sigma[i] = sigma;
    return aid;
}

static double one_sigma(const imk_drift_moments *m, int state)
{
    return sqrt(m->covariance[state][state]);
}

/* ---- the Riccati equation ---------------------------------------------------------------------
 */

/* The numbers are those of aided_riccati.py. What the filter believes is the discrete equation
 * itself; the errors have the gradient of gravity on the ellipsoid and biases that change within
 * half a second. */
static void test_riccati(void **state)
{
    (void)state;
    imk_model model;
    set_white(&model, 1e-4, 1e-3);
    add_gauss_markov(&model.gyro, 2e-5, 40.0);
    add_gauss_markov(&model.accel, 1e-2, 20.0);
    const imk_aid aid[3] = {aid_of(IMK_AID_POSITION, 1.0), aid_of(IMK_AID_VELOCITY, 0.05),
                            aid_of(IMK_AID_HEADING, 0.01)};
    const double time = 1000.0;
    imk_drift_settings settings = imk_drift_default();
    settings.aid = aid;
    settings.aid_count = 3;
    settings.time = &time;
    settings.time_count = 1;
    settings.attitude_errors = IMK_ATTITUDE_EARTH;
    imk_drift_analysis *analysis = analyse(&model, &settings);
    for (int i = 0; i < 9; i++) {
        CHECK_RELATIVE(one_sigma(&analysis->believed[0], i), riccati_after[i], 1e-9);
        CHECK_RELATIVE(one_sigma(&analysis->total[0], i), riccati_after[i], 5e-4);
    }
    free(analysis);
}

/* ---- the filter knows the truth ----------------------------------------------------------------
 */

typedef struct drive {
    imk_trajectory trajectory;
    imk_trajectory_piece *piece;
} drive;

static void start_drive(drive *d)
{
    imk_motion_script script;
    static imk_motion_step step[CAR_PROFILE_STEPS];
    size_t count = 0;
    car_profile(&script, step);
    CHECK_OK(imk_motion_script_pieces(&script, &count, NULL));
    d->piece = malloc(count * sizeof *d->piece);
    assert_non_null(d->piece);
    CHECK_OK(imk_motion_script_compile(&script, d->piece, count, &d->trajectory, NULL));
}

/* Every kind of error that the filter has a state for: constants that walk, Gauss-Markov processes,
 * a lever arm, correlated errors of aids. */
static void known_model(imk_model *model)
{
    set_white(model, 3e-5, 1e-3);
    add_gauss_markov(&model->gyro, 3e-6, 300.0);
    add_gauss_markov(&model->accel, 5e-4, 100.0);
    for (int i = 0; i < 3; i++) {
        model->gyro.bias.repeatability.value[i] = 5e-6;
        model->accel.bias.repeatability.value[i] = 1e-2;
        model->gyro.noise.random_walk.value[i] = 2e-7;
    }
}

static void know_aids(imk_aid aid[3])
{
    aid[0] = aid_of(IMK_AID_POSITION, 1.0);
    aid[1] = aid_of(IMK_AID_VELOCITY, 0.05);
    aid[2] = aid_of(IMK_AID_ODOMETER, 0.1);
    aid[0].correlation_time = 60.0;
    aid[2].interval = 0.5;
    for (int i = 0; i < 3; i++) {
        aid[0].correlated_sigma[i] = 2.0;
        aid[0].lever_arm[i] = aid[1].lever_arm[i] = 1.0 + i;
        aid[0].lever_arm_sigma[i] = aid[1].lever_arm_sigma[i] = 0.1;
    }
    for (int k = 0; k < 3; k++)
        aid[k].until = 300.0;
}

/* Errors and covariance of the filter agree where it is told the truth, while it is aided and in
 * the outage after it; the sources add up. */
static void check_known(const imk_drift_settings *settings, const imk_model *model,
                        double tolerance)
{
    imk_drift_analysis *analysis = analyse(model, settings);
    for (size_t t = 0; t < settings->time_count; t++)
        for (int i = 0; i < 9; i++) {
            if (imk_drift_vertical(settings) == IMK_VERTICAL_SLAVED && (i == 2 || i == 5))
                continue;
            CHECK_RELATIVE(one_sigma(&analysis->total[t], i), one_sigma(&analysis->believed[t], i),
                           tolerance);
            double sum = 0.0;
            for (size_t k = 0; k < analysis->source_count; k++)
                sum += analysis->contribution[k * settings->time_count + t].covariance[i][i];
            CHECK_RELATIVE(analysis->total[t].covariance[i][i], sum, 1e-12);
        }
    free(analysis);
}

static void test_known_to_the_filter(void **state)
{
    (void)state;
    imk_model model;
    imk_aid aid[3];
    drive d;
    known_model(&model);
    know_aids(aid);
    start_drive(&d);
    const double time[4] = {20.0, 300.0, 360.0, 500.0};
    imk_drift_settings settings = imk_drift_default();
    settings.aid = aid;
    settings.aid_count = 3;
    settings.time = time;
    settings.time_count = 4;
    for (int i = 0; i < 3; i++) {
        settings.initial_sigma[i] = 5.0;
        settings.initial_sigma[3 + i] = 0.1;
        settings.initial_sigma[6 + i] = 0.01;
    }
    check_known(&settings, &model, 5e-4);
    settings.motion = &d.trajectory;
    check_known(&settings, &model, 5e-4);
    settings.alignment = IMK_ALIGNED_SELF;
    check_known(&settings, &model, 5e-4);
    /* The vertical follows the truth when no aid gives the height. */
    settings.aid = aid + 1;
    settings.aid_count = 2;
    settings.time_count = 3;
    check_known(&settings, &model, 5e-4);
    free(d.piece);
}

/* ---- what the filter does not know -------------------------------------------------------------
 */

/* At rest a filter that takes correlated errors of the position for white believes in a position
 * far better than it has; told, it believes what is. */
static void test_unknown_correlation(void **state)
{
    (void)state;
    imk_model model;
    set_white(&model, 1e-5, 1e-4);
    imk_aid truth = aid_of(IMK_AID_POSITION, 0.1), told = aid_of(IMK_AID_POSITION, 2.0);
    truth.correlation_time = 200.0;
    for (int i = 0; i < 3; i++)
        truth.correlated_sigma[i] = 2.0;
    const double time = 300.0;
    imk_drift_settings settings = imk_drift_default();
    settings.aid = &truth;
    settings.aid_count = 1;
    settings.filter_aid = &told;
    settings.time = &time;
    settings.time_count = 1;
    settings.initial_sigma[0] = settings.initial_sigma[1] = settings.initial_sigma[2] = 10.0;
    imk_drift_analysis *analysis = analyse(&model, &settings);
    const double ratio = one_sigma(&analysis->total[0], 0) / one_sigma(&analysis->believed[0], 0);
    assert_true(ratio > 3.0);
    free(analysis);
    settings.filter_aid = NULL;
    check_known(&settings, &model, 1e-3);
}

/* A filter that believes in better gyros than there are is worse than one that knows them, and one
 * that believes in worse ones, too. */
static void test_model_of_the_filter(void **state)
{
    (void)state;
    imk_model model, other;
    double heading[3];
    const imk_aid aid[2] = {aid_of(IMK_AID_VELOCITY, 0.1), aid_of(IMK_AID_HEADING, 0.01)};
    const double time = 200.0, factor[3] = {0.1, 1.0, 10.0};
    set_white(&model, 1e-4, 1e-3);
    imk_drift_settings settings = imk_drift_default();
    settings.aid = aid;
    settings.aid_count = 2;
    settings.time = &time;
    settings.time_count = 1;
    settings.initial_sigma[8] = 0.1;
    settings.filter_model = &other;
    for (int k = 0; k < 3; k++) {
        set_white(&other, 1e-4 * factor[k], 1e-3);
        imk_drift_analysis *analysis = analyse(&model, &settings);
        heading[k] = one_sigma(&analysis->total[0], 8);
        const double ratio = heading[k] / one_sigma(&analysis->believed[0], 8);
        assert_true(k == 0 ? ratio > 1.5 : k == 2 ? ratio < 0.8 : fabs(ratio - 1.0) < 1e-4);
        free(analysis);
    }
    assert_true(heading[0] > 1.05 * heading[1] && heading[2] > 1.2 * heading[1]);
}

/* Zero velocity is read where the motion stands, and nowhere else. */
static void test_zero_velocity_on_a_drive(void **state)
{
    (void)state;
    imk_model model;
    drive d;
    known_model(&model);
    start_drive(&d);
    const imk_aid aid = aid_of(IMK_AID_ZERO_VELOCITY, 0.01);
    const double time[2] = {29.0, 60.0};
    imk_drift_settings settings = imk_drift_default();
    settings.motion = &d.trajectory;
    settings.aid = &aid;
    settings.aid_count = 1;
    settings.time = time;
    settings.time_count = 2;
    settings.initial_sigma[6] = settings.initial_sigma[7] = 1.0 * degree;
    imk_drift_analysis *analysis = analyse(&model, &settings);
    const imk_drift_figures stands = imk_drift_figures_of(&analysis->total[0]),
                            drives = imk_drift_figures_of(&analysis->total[1]);
    CHECK_BELOW(stands.velocity, 0.015);
    assert_true(drives.velocity > 0.02);
    free(analysis);
    free(d.piece);
}

static void test_refusals(void **state)
{
    (void)state;
    imk_model model;
    imk_error error;
    set_white(&model, 1e-4, 1e-3);
    const double time = 10.0;
    imk_aid aid = aid_of(IMK_AID_POSITION, 1.0), other = aid_of(IMK_AID_VELOCITY, 1.0);
    imk_drift_settings settings = imk_drift_default();
    settings.aid = &aid;
    settings.aid_count = 1;
    settings.time = &time;
    settings.time_count = 1;
    CHECK_OK(imk_drift_validate(&model, &settings, &error));
    aid.interval = 0.001;
    CHECK_STATUS(imk_drift_validate(&model, &settings, &error), IMK_ERROR_RANGE);
    assert_string_equal(error.field, "aid.interval");
    aid.interval = 1.0;
    aid.sigma[0] = -1.0;
    CHECK_STATUS(imk_drift_validate(&model, &settings, &error), IMK_ERROR_RANGE);
    aid.sigma[0] = 1.0;
    settings.filter_aid = &other;
    CHECK_STATUS(imk_drift_validate(&model, &settings, &error), IMK_ERROR_CONFLICT);
    settings.filter_aid = NULL;
    settings.aid_count = IMK_AIDS_MAX + 1;
    CHECK_STATUS(imk_drift_validate(&model, &settings, &error), IMK_ERROR_RANGE);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_constant_gain),
        cmocka_unit_test(test_constant_gain_correlated),
        cmocka_unit_test(test_riccati),
        cmocka_unit_test(test_known_to_the_filter),
        cmocka_unit_test(test_unknown_correlation),
        cmocka_unit_test(test_model_of_the_filter),
        cmocka_unit_test(test_zero_velocity_on_a_drive),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
