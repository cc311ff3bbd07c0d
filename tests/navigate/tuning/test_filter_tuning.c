/* SPDX-License-Identifier: Apache-2.0 */
/* Noise that makes a filter consistent: errors that a filter can describe give back their own
 * numbers; closed forms of increments at rest; a model with everything against simulated readings;
 * what no constant noise describes; a recorded motion; the same bits in any order; refusals. */
#include "check.h"

#include "imukit/distributions.h"
#include "imukit/filter_tuning.h"

#include <stdlib.h>
#include <string.h>

enum { STATES = IMK_TUNING_STATES };

static const double pi = 3.14159265358979323846;

/* ---- set-up ---- */

typedef struct scene {
    imk_model model;
    imk_trajectory_piece piece;
    imk_trajectory trajectory;
    imk_vibration_line line[4];
    imk_filter_tuning_settings settings;
    imk_filter_tuning *tuning;
    void *memory;
} scene;

/* At rest and level, without the Earth's rotation or with it. */
static void stand(scene *s, bool earth, double rate)
{
    const double level[3] = {0.0, 0.0, 0.0};
    const imk_geodetic place = {0.25 * pi, 0.0, 0.0};
    memset(s, 0, sizeof *s);
    imk_model_default(&s->model);
    CHECK_OK(imk_trajectory_standstill(place, level, earth, &s->piece, &s->trajectory, NULL));
    s->settings = imk_filter_tuning_default();
    s->settings.motion_count = 1;
    s->settings.motion[0].trajectory = &s->trajectory;
    s->settings.duration[0] = 20.0;
    s->settings.rate = rate;
    s->settings.window_count = 3;
    s->settings.bias_sigma[0] = s->settings.bias_sigma[1] = 0.0;
}

static void tune(scene *s, const imk_executor *executor)
{
    const size_t size = imk_filter_tuning_size(&s->model, &s->settings);
    s->memory = malloc(size);
    assert_non_null(s->memory);
    CHECK_OK(imk_filter_tuning_run(&s->model, &s->settings, executor, &s->tuning, s->memory, size,
                                   NULL));
}

static void set_all(imk_axes *axes, double value)
{
    for (int i = 0; i < 3; i++)
        axes->value[i] = value;
}

/* It turns and shakes about all axes: no two directions are alike. */
static void shake(scene *s)
{
    static const imk_vibration_line lines[4] = {
        {3, 0.04, 0.7, 0.0}, {4, 0.025, 1.3, 0.3}, {5, 0.045, 0.4, 0.6}, {2, 0.03, 2.1, 0.1}};
    memcpy(s->line, lines, sizeof lines);
    s->trajectory.line_count = 4;
    s->trajectory.line = s->line;
}

/* ---- what a filter can describe ---- */

/* White noise and walks alike on the axes are in the family: the fit is the model, and so is the
 * safe answer, which is not below the sensor's own noise though 1/1.05 of it would do. */
static void test_own_numbers(void **state)
{
    (void)state;
    const double numbers[2][2] = {{2e-3, 3e-4}, {1e-2, 4e-3}};
    scene s;
    stand(&s, true, 100.0);
    shake(&s);
    s.settings.bias_time = 0.0;
    s.settings.to = 5.0;
    set_all(&s.model.gyro.noise.white, numbers[0][0]);
    set_all(&s.model.gyro.noise.random_walk, numbers[0][1]);
    set_all(&s.model.accel.noise.white, numbers[1][0]);
    set_all(&s.model.accel.noise.random_walk, numbers[1][1]);
    tune(&s, NULL);
    /* 0.01 s is one sample; 0.018, 0.032 … 3.2 s, 5 s being beside the grid. */
    assert_int_equal(s.tuning->short_count, 1);
    assert_int_equal(s.tuning->time_count, 10);
    assert_int_equal(s.tuning->samples[0], 2);
    for (int sensor = 0; sensor < 2; sensor++) {
        const imk_filter_parameters *fit = &s.tuning->answer[IMK_FILTER_FIT].parameters;
        const imk_filter_parameters *safe = &s.tuning->answer[IMK_FILTER_SAFE].parameters;
        CHECK_RELATIVE(s.tuning->answer[IMK_FILTER_STATED].parameters.white[sensor][0],
                       numbers[sensor][0], 1e-12);
        CHECK_RELATIVE(fit->white[sensor][0], numbers[sensor][0], 2e-3);
        CHECK_RELATIVE(fit->walk[sensor][0], numbers[sensor][1], 2e-3);
        CHECK_RELATIVE(safe->white[sensor][0], numbers[sensor][0], 1e-6);
        CHECK_RELATIVE(safe->walk[sensor][0], numbers[sensor][1], 1e-6);
        assert_true(safe->white[sensor][0] >= (1.0 - 1e-12) * numbers[sensor][0]);
        assert_true(safe->walk[sensor][0] >= (1.0 - 1e-12) * numbers[sensor][1]);
    }
    /* What is left out of coning is deterministic and no part of the family. */
    CHECK_CLOSE(s.tuning->answer[IMK_FILTER_FIT].mean_nees, 1.0, 1e-6);
    CHECK_CLOSE(s.tuning->answer[IMK_FILTER_FIT].consistency[3].beyond, 0.05, 2e-3);
    assert_false(s.tuning->inconstant);
    CHECK_RELATIVE(s.tuning->answer[IMK_FILTER_TENFOLD].mean_nees,
                   0.01 * s.tuning->answer[IMK_FILTER_STATED].mean_nees, 1e-9);
    free(s.memory);
}

/* A Gauss-Markov process that is known at the beginning, of a correlation time much longer than the
 * window: driving noise sigma sqrt(2/T), and (t/T)/2 less than a random walk. */
static void test_gauss_markov(void **state)
{
    (void)state;
    scene s;
    stand(&s, true, 50.0);
    shake(&s);
    s.settings.bias_time = 0.0;
    s.settings.correlation_time = 200.0;
    set_all(&s.model.gyro.noise.white, 2e-3);
    set_all(&s.model.accel.noise.white, 1e-2);
    s.model.gyro.noise.gauss_markov_count = s.model.accel.noise.gauss_markov_count = 1;
    set_all(&s.model.gyro.noise.gauss_markov[0].sigma, 3e-3);
    set_all(&s.model.gyro.noise.gauss_markov[0].correlation_time, 200.0);
    set_all(&s.model.accel.noise.gauss_markov[0].sigma, 2e-2);
    set_all(&s.model.accel.noise.gauss_markov[0].correlation_time, 200.0);
    tune(&s, NULL);
    const imk_filter_parameters *fit = &s.tuning->answer[IMK_FILTER_FIT].parameters;
    /* The known bias decays in the model and is held in the filter: sigma^2 (t/T)^2 of 2 t/T. */
    CHECK_RELATIVE(fit->walk[0][0], 3e-3 * sqrt(2.0 / 200.0), 0.02);
    CHECK_RELATIVE(fit->walk[1][0], 2e-2 * sqrt(2.0 / 200.0), 0.02);
    CHECK_RELATIVE(fit->white[0][0], 2e-3, 5e-3);
    CHECK_CLOSE(fit->correlation_time, 200.0, 0.0);
    free(s.memory);
}

/* Of white noise at rest, n samples of h, with force g along z: attitude N^2 t, horizontal velocity
 * g^2 N^2 t^3/3, position g^2 N^2 t^5/20, as continuous time has them. */
static void test_closed_forms(void **state)
{
    (void)state;
    const double n = 1e-4, a = 1e-3;
    scene s;
    stand(&s, true, 100.0);
    set_all(&s.model.gyro.noise.white, n);
    set_all(&s.model.accel.noise.white, a);
    tune(&s, NULL);
    const size_t last = s.tuning->time_count - 1;
    const double t = s.tuning->time[last];
    const double(*p)[STATES] = s.tuning->truth[last];
    imk_motion_state at;
    imk_trajectory_state(&s.trajectory, 0.0, &at);
    const double g = -at.specific_force.v[2];
    CHECK_CLOSE(t, 10.0, 1e-12);
    /* The Earth turns the axes by 7e-4 within the window. */
    CHECK_RELATIVE(p[0][0], n * n * t, 1e-9);
    CHECK_RELATIVE(p[3][3], a * a * t + g * g * n * n * t * t * t / 3.0, 1e-5);
    CHECK_RELATIVE(p[5][5], a * a * t, 1e-4);
    CHECK_RELATIVE(p[6][6], a * a * t * t * t / 3.0 + g * g * n * n * pow(t, 5.0) / 20.0, 1e-5);
    free(s.memory);
}

/* ---- a model with everything ---- */

static void make_lively(imk_model *model)
{
    imk_triad *triad[2] = {&model->gyro, &model->accel};
    for (int sensor = 0; sensor < 2; sensor++) {
        const double unit = sensor == IMK_GYRO ? 1e-3 : 1e-2;
        imk_triad *x = triad[sensor];
        set_all(&x->bias.fixed, 3.0 * unit);
        set_all(&x->bias.repeatability, 5.0 * unit);
        set_all(&x->bias.warm_up_amplitude, 2.0 * unit);
        x->bias.warm_up_time.value = 3.0;
        set_all(&x->scale_factor.repeatability, 2e-3);
        set_all(&x->scale_factor.fixed, -1e-3);
        for (int i = 0; i < 3; i++)
            x->misalignment.value[i][(i + 1) % 3] = 2e-3 * (i - 1.5);
        set_all(&x->noise.white, 0.3 * unit);
        set_all(&x->noise.bias_instability, 0.2 * unit);
        set_all(&x->noise.random_walk, 0.2 * unit);
        set_all(&x->noise.ramp, 0.05 * unit);
        set_all(&x->noise.quantization, 0.01 * unit);
        set_all(&x->noise.reading_noise, 0.01 * unit);
        x->noise.gauss_markov_count = x->noise.sinusoid_count = x->noise.resonance_count = 1;
        set_all(&x->noise.gauss_markov[0].sigma, 0.3 * unit);
        set_all(&x->noise.gauss_markov[0].correlation_time, 0.5);
        set_all(&x->noise.sinusoid[0].amplitude, 0.3 * unit);
        set_all(&x->noise.sinusoid[0].frequency, 1.7);
        set_all(&x->noise.resonance[0].sigma, 0.5 * unit);
        set_all(&x->noise.resonance[0].frequency, 9.0);
        set_all(&x->noise.resonance[0].q, 8.0);
        set_all(&x->bandwidth, 12.0);
        set_all(&x->damping, 0.7);
    }
    set_all(&model->accel.nonlinearity.k2, 1e-4);
    for (int i = 0; i < 3; i++) {
        model->gyro.g_sensitivity.value[i][i] = 1e-4;
        model->accel.lever_arm.value[i][i] = 0.02;
    }
    model->timing.rate_error.value = 2e-5;
    model->timing.jitter.value = 2e-4;
    model->timing.skew.value = 3e-4;
}

/* Means of the runs against the prediction: the largest of all differences in standard errors is
 * beyond the limit in one of 1000 sets of runs. */
static void check_runs_of(bool learned)
{
    const uint32_t runs = check_runs(250);
    scene s;
    stand(&s, true, 50.0);
    shake(&s);
    make_lively(&s.model);
    s.settings.duration[0] = 6.0;
    s.settings.window_count = 4;
    s.settings.from = 0.04;
    s.settings.to = 2.0;
    s.settings.per_decade = 2;
    s.settings.bias_time = 0.5;
    s.settings.learned = learned;
    s.settings.bias_sigma[0] = 1e-3;
    s.settings.bias_sigma[1] = 1e-2;
    tune(&s, NULL);
    const size_t times = s.tuning->time_count;
    const size_t size = imk_filter_tuning_runs_workspace_size(&s.model, &s.settings);
    void *workspace = malloc(size);
    double *errors = malloc(s.tuning->window_count * times * STATES * sizeof *errors);
    double sum[IMK_TUNING_TIMES_MAX] = {0.0}, squares[IMK_TUNING_TIMES_MAX] = {0.0};
    for (uint32_t r = 0; r < runs; r++) {
        double nees[IMK_TUNING_TIMES_MAX];
        CHECK_OK(imk_filter_tuning_simulate(&s.model, &s.settings, s.tuning, 7, r, errors,
                                            workspace, size, NULL));
        imk_filter_tuning_nees(s.tuning, IMK_FILTER_FIT, errors, nees);
        for (size_t t = 0; t < times; t++) {
            sum[t] += nees[t];
            squares[t] += nees[t] * nees[t];
        }
    }
    const double n = (double)runs;
    const double limit = imk_student_quantile(1.0 - 0.0005 / (double)times, n - 1.0);
    for (size_t t = 0; t < times; t++) {
        const double mean = sum[t] / n;
        const double error = sqrt((squares[t] / n - mean * mean) / (n - 1.0));
        CHECK_CLOSE(mean, s.tuning->answer[IMK_FILTER_FIT].consistency[t].nees, limit * error);
    }
    free(errors);
    free(workspace);
    free(s.memory);
}

static void test_runs(void **state)
{
    (void)state;
    check_runs_of(false);
}

static void test_learned_runs(void **state)
{
    (void)state;
    check_runs_of(true);
}

/* ---- what no constant noise describes ---- */

/* A scale factor on a swing: its error comes and goes. */
static void test_inconstant(void **state)
{
    (void)state;
    scene s;
    stand(&s, true, 50.0);
    s.line[0] = (imk_vibration_line){3, 0.1, 0.5, 0.0};
    s.trajectory.line_count = 1;
    s.trajectory.line = s.line;
    s.settings.window_count = 16;
    set_all(&s.model.gyro.noise.white, 1e-5);
    set_all(&s.model.accel.noise.white, 2e-3);
    set_all(&s.model.gyro.scale_factor.repeatability, 0.01);
    tune(&s, NULL);
    assert_true(s.tuning->inconstant);
    assert_string_equal(s.tuning->source[s.tuning->worst_source].name,
                        "gyro.scale_factor.repeatability");
    const imk_filter_answer *scaled = &s.tuning->answer[IMK_FILTER_FIT_SCALED];
    CHECK_RELATIVE(scaled->parameters.scale_factor[0][0], 0.01, 0.02);
    CHECK_RELATIVE(scaled->parameters.white[0][0], 1e-5, 0.02);
    for (size_t t = 0; t < s.tuning->time_count; t++) {
        double sum = 0.0;
        for (size_t k = 0; k < s.tuning->source_count; k++)
            sum += scaled->share[k * s.tuning->time_count + t];
        CHECK_CLOSE(sum, 1.0, 1e-9);
        CHECK_CLOSE(scaled->consistency[t].nees, 1.0, 0.02);
        CHECK_BELOW(s.tuning->answer[IMK_FILTER_SAFE].consistency[t].largest, 1.05);
    }
    free(s.memory);
}

/* ---- other motions, other orders ---- */

/* Items from the last to the first. */
static void backwards(void *context, size_t count, imk_work work, void *work_context)
{
    (void)context;
    while (count > 0)
        work(work_context, --count);
}

/* Numbers of each axis: what each has. */
static void test_axes(void **state)
{
    (void)state;
    const imk_executor executor = {backwards, NULL, 2};
    scene s, other;
    stand(&s, true, 20.0);
    s.settings.per_axis = true;
    s.settings.from = 0.1;
    for (int i = 0; i < 3; i++) {
        s.model.gyro.noise.white.value[i] = 1e-4 * (1 + i);
        s.model.accel.noise.white.value[i] = 1e-3 * (1 + i);
    }
    other = s;
    other.settings.motion[0].trajectory = &s.trajectory;
    tune(&s, NULL);
    tune(&other, &executor);
    const imk_filter_parameters *fit = &s.tuning->answer[IMK_FILTER_FIT].parameters;
    for (int i = 0; i < 3; i++) {
        CHECK_RELATIVE(fit->white[0][i], 1e-4 * (1 + i), 1e-3);
        CHECK_RELATIVE(fit->white[1][i], 1e-3 * (1 + i), 1e-3);
    }
    assert_true(s.tuning->answer[IMK_FILTER_FIT].unused[0][1]);
    assert_false(s.tuning->answer[IMK_FILTER_FIT].unused[0][0]);
    assert_memory_equal(s.tuning->truth, other.tuning->truth,
                        s.tuning->time_count * sizeof *s.tuning->truth);
    assert_memory_equal(fit, &other.tuning->answer[IMK_FILTER_FIT].parameters, sizeof *fit);
    free(s.memory);
    free(other.memory);
}

/* The readings of perfect sensors at rest are the motion at rest. */
static void test_recorded(void **state)
{
    (void)state;
    enum { ROWS = 301 };
    static double still[3][ROWS], force[3][ROWS];
    scene s, other;
    stand(&s, false, 20.0);
    set_all(&s.model.gyro.noise.white, 1e-4);
    set_all(&s.model.accel.noise.white, 1e-3);
    set_all(&s.model.accel.scale_factor.repeatability, 1e-3);
    s.settings.duration[0] = 15.0;
    other = s;
    const imk_recorded_motion recorded = {.count = ROWS,
                                          .rate = 20.0,
                                          .angular_rate = {still[0], still[1], still[2]},
                                          .specific_force = {force[0], force[1], force[2]}};
    other.settings.motion[0] = (imk_motion){.recorded = &recorded};
    s.settings.motion[0].trajectory = &s.trajectory;
    tune(&s, NULL);
    tune(&other, NULL);
    assert_int_equal(s.tuning->time_count, other.tuning->time_count);
    for (size_t t = 0; t < s.tuning->time_count; t++)
        for (int i = 0; i < STATES; i++)
            CHECK_RELATIVE(other.tuning->truth[t][i][i], s.tuning->truth[t][i][i], 1e-12);
    free(s.memory);
    free(other.memory);
}

static void test_refusals(void **state)
{
    (void)state;
    scene s;
    imk_error error;
    stand(&s, true, 50.0);
    imk_filter_tuning_settings good = s.settings, bad = good;
    CHECK_OK(imk_filter_tuning_validate(&s.model, &good, &error));
    bad.cookie = 0;
    CHECK_STATUS(imk_filter_tuning_validate(&s.model, &bad, &error), IMK_ERROR_UNINITIALISED);
    bad = good;
    bad.motion_count = 0;
    CHECK_STATUS(imk_filter_tuning_validate(&s.model, &bad, &error), IMK_ERROR_EMPTY);
    bad = good;
    bad.rate = (double)NAN;
    CHECK_STATUS(imk_filter_tuning_validate(&s.model, &bad, &error), IMK_ERROR_NOT_FINITE);
    bad = good;
    bad.duration[0] = 1.0; /* no longer than the bias is known over */
    CHECK_STATUS(imk_filter_tuning_validate(&s.model, &bad, &error), IMK_ERROR_TOO_SHORT);
    /* Without noise nothing is to be fitted. */
    const size_t size = imk_filter_tuning_size(&s.model, &good);
    void *memory = malloc(size);
    imk_filter_tuning *tuning;
    CHECK_STATUS(imk_filter_tuning_run(&s.model, &good, NULL, &tuning, memory, size, &error),
                 IMK_ERROR_SINGULAR);
    CHECK_STATUS(imk_filter_tuning_run(&s.model, &good, NULL, &tuning, memory, size - 1, &error),
                 IMK_ERROR_WORKSPACE);
    free(memory);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_own_numbers),  cmocka_unit_test(test_gauss_markov),
        cmocka_unit_test(test_closed_forms), cmocka_unit_test(test_runs),
        cmocka_unit_test(test_learned_runs), cmocka_unit_test(test_inconstant),
        cmocka_unit_test(test_axes),         cmocka_unit_test(test_recorded),
        cmocka_unit_test(test_refusals)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
