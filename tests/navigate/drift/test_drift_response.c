/* SPDX-License-Identifier: Apache-2.0 */
/* The linear theory along a motion: what each known term does, against the simulator and the
 * mechanisation itself; noise against constants; and steps of any length. */
#include "car_profile.h"
#include "check.h"

#include "imukit/drift.h"
#include "imukit/navigate.h"
#include "imukit/simulate.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { RATE = 100, SECONDS = 600, ROWS = RATE * SECONDS, CHANNELS = 6 };

/* ---- the drive ----------------------------------------------------------------------------------
 */

typedef struct drive {
    imk_trajectory trajectory;
    imk_trajectory_piece *piece;
    double *height, *climb; /* at the ends of rows 1 … ROWS */
    double *column[CHANNELS];
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
    d->height = malloc(ROWS * sizeof(double));
    d->climb = malloc(ROWS * sizeof(double));
    assert_true(d->height && d->climb);
    for (size_t k = 0; k < ROWS; k++) {
        imk_motion_state state;
        imk_trajectory_state(&d->trajectory, (double)(k + 1) / RATE, &state);
        d->height[k] = state.place.height;
        d->climb[k] = -state.velocity_ned.v[2];
    }
    for (int i = 0; i < CHANNELS; i++) {
        d->column[i] = malloc((ROWS + 1) * sizeof(double));
        assert_non_null(d->column[i]);
    }
}

static void end_drive(drive *d)
{
    free(d->piece);
    free(d->height);
    free(d->climb);
    for (int i = 0; i < CHANNELS; i++)
        free(d->column[i]);
}

/* Rows 0 … ROWS of a unit on it. @return true time of the last row [s] */
static double simulate(drive *d, const imk_model *model)
{
    imk_simulation simulation = imk_simulation_default();
    simulation.rate = RATE;
    simulation.motion.trajectory = &d->trajectory;
    const size_t size = imk_simulator_size(model, &simulation);
    void *memory = aligned_alloc(64, (size + 63) / 64 * 64);
    imk_simulator *simulator = NULL;
    assert_non_null(memory);
    CHECK_OK(imk_simulator_start(model, &simulation, &simulator, memory, size, NULL));
    imk_simulator_next(simulator, ROWS + 1, d->column, NULL);
    const double last = imk_simulator_true_time(simulator, ROWS);
    free(memory);
    return last;
}

/* Errors of the mechanisation fed with these rows, as drift.h defines them. */
static void navigate(const drive *d, bool slaved, double last, double error[9])
{
    imk_motion_state truth;
    imk_trajectory_state(&d->trajectory, 0, &truth);
    const imk_navigation_state start = {0, truth.position, truth.velocity, truth.attitude};
    imk_strapdown strapdown = imk_strapdown_start(&start);
    strapdown.hold_height = slaved;
    for (size_t k = 1; k <= ROWS; k++) {
        imk_vector3 angle, velocity;
        for (int i = 0; i < 3; i++) {
            angle.v[i] = d->column[i][k] / RATE;
            velocity.v[i] = d->column[3 + i][k] / RATE;
        }
        strapdown.height = d->height[k - 1];
        strapdown.climb = d->climb[k - 1];
        imk_strapdown_step(&strapdown, 1.0 / RATE, angle, velocity);
    }
    imk_trajectory_state(&d->trajectory, last, &truth);
    const imk_matrix3 c_ne =
        imk_matrix3_transpose(imk_ned_axes(truth.place.latitude, truth.place.longitude));
    const imk_vector3 part[3] = {
        imk_vector3_subtract(strapdown.state.position, truth.position),
        imk_vector3_subtract(strapdown.state.velocity, truth.velocity),
        imk_quaternion_to_rotation_vector(imk_quaternion_multiply(
            strapdown.state.attitude, imk_quaternion_conjugate(truth.attitude)))};
    for (int i = 0; i < 3; i++) {
        const imk_vector3 ned = imk_matrix3_apply(c_ne, part[i]);
        memcpy(error + (ptrdiff_t)3 * i, ned.v, sizeof ned.v);
    }
}

static imk_drift_analysis *analyse(const imk_model *model, const imk_drift_settings *settings)
{
    const size_t size = imk_drift_covariance_size(model, settings);
    void *memory = aligned_alloc(64, size);
    imk_drift_analysis *analysis = NULL;
    assert_non_null(memory);
    CHECK_OK(imk_drift_covariance(model, settings, NULL, &analysis, memory, size, NULL));
    return analysis;
}

/* ---- known terms ------------------------------------------------------------------------------
 */

/* Everything a unit can have that is known, of sizes that make about a metre: what is not linear
 * is then 1e-6 of it. */
static imk_model known(void)
{
    imk_model model;
    imk_model_default(&model);
    imk_triad *gyro = &model.gyro, *accel = &model.accel;
    gyro->bias.warm_up_time.value = 100;
    accel->bias.warm_up_time.value = 40;
    for (int i = 0; i < 3; i++) {
        const double size = 1 - 0.4 * i;
        gyro->bias.fixed.value[i] = 2e-7 * size;
        gyro->bias.warm_up_amplitude.value[i] = 3e-7 * size;
        gyro->scale_factor.fixed.value[i] = 1e-5 * size;
        gyro->nonlinearity.k2.value[i] = 3e-5 * size;
        gyro->nonlinearity.koq.value[i] = -2e-5 * size;
        gyro->nonlinearity.k3.value[i] = 3e-4 * size;
        gyro->nonlinearity.asymmetry.value[i] = 1e-5 * size;
        gyro->noise.ramp.value[i] = 1e-9 * size;
        gyro->bandwidth.value[i] = 400;
        accel->bias.fixed.value[i] = 1e-5 * size;
        accel->bias.warm_up_amplitude.value[i] = 1e-4 * size;
        accel->scale_factor.fixed.value[i] = 1e-5 * size;
        accel->nonlinearity.k2.value[i] = 1e-5 * size;
        accel->nonlinearity.koq.value[i] = -2e-5 * size;
        accel->nonlinearity.k3.value[i] = 1e-6 * size;
        accel->nonlinearity.asymmetry.value[i] = 1e-4 * size;
        accel->noise.ramp.value[i] = 1e-7 * size;
        for (int j = 0; j < 3; j++) {
            const double other = j == i ? 0 : 1e-5 * (1 + i - 0.7 * j);
            gyro->misalignment.value[i][j] = other;
            accel->misalignment.value[i][j] = -other;
            gyro->cross_axis.value[i][j] = 0.5 * other;
            accel->cross_axis.value[i][j] = 0.7 * other;
            gyro->g_sensitivity.value[i][j] = 1e-8 * (1 + i - 0.6 * j);
            accel->nonlinearity.cross_products.value[i][j] = 1e-6 * (1 + j - 0.6 * i);
            accel->lever_arm.value[i][j] = 0.1 * (1 + i - 0.8 * j);
        }
        for (int j = 0; j < 6; j++)
            gyro->g2_sensitivity.value[i][j] = 1e-9 * (1 + i - 0.5 * j);
    }
    model.timing.rate_error.value = 1e-6;
    model.timing.skew.value = 1e-4;
    return model;
}

static double length(const double v[3])
{
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* Each term alone, simulated and navigated, against its mean by the linear theory: position,
 * velocity and attitude each to `tolerance` of its length. Below the floors is what the
 * mechanisation and the sampling leave: micrometres of position, and for attitude 1e-10 rad, as
 * much as the position error turns the axes. */
static void known_terms_do_what_the_mechanisation_does(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        bool slaved;
        double tolerance;
    } term[] = {
        {"gyro.bias.fixed", true, 1e-3},
        {"gyro.bias.fixed", false, 1e-3},
        {"gyro.warm_up", true, 1e-3},
        {"gyro.scale_factor.fixed", true, 1e-3},
        {"gyro.nonlinearity", true, 1e-3},
        {"gyro.misalignment", true, 1e-3},
        {"gyro.cross_axis", true, 1e-3},
        {"gyro.g_sensitivity", true, 1e-3},
        {"gyro.g2_sensitivity", true, 1e-3},
        {"gyro.rate_ramp", true, 1e-3},
        {"gyro.bandwidth", true, 1e-3},
        {"accel.bias.fixed", true, 1e-3},
        {"accel.bias.fixed", false, 1e-3},
        {"accel.warm_up", true, 1e-3},
        {"accel.scale_factor.fixed", true, 1e-3},
        {"accel.nonlinearity", true, 1e-3},
        {"accel.cross_products", false, 1e-3},
        {"accel.misalignment", true, 1e-3},
        {"accel.cross_axis", true, 1e-3},
        {"accel.acceleration_ramp", true, 1e-3},
        {"accel.lever_arm", true, 1e-3},
        {"timing.rate_error", false, 1e-3},
        {"timing.skew", true, 1e-3},
    };
    static const double floors[3] = {1e-5, 1e-7, 1e-10};
    const imk_model all = known();
    const double time = SECONDS;
    drive d;
    start_drive(&d);
    for (size_t i = 0; i < sizeof term / sizeof term[0]; i += check_quick() ? 3 : 1) {
        imk_model model = all;
        CHECK_OK(imk_model_select(&model, true, 1, &term[i].name, NULL));
        imk_drift_settings settings = imk_drift_default();
        settings.motion = &d.trajectory;
        settings.attitude_errors = IMK_ATTITUDE_EARTH;
        settings.vertical = term[i].slaved ? IMK_VERTICAL_SLAVED : IMK_VERTICAL_FREE;
        settings.time = &time;
        settings.time_count = 1;
        imk_drift_analysis *analysis = analyse(&model, &settings);
        double error[9];
        navigate(&d, term[i].slaved, simulate(&d, &model), error);
        for (int part = 0; part < 3; part++) {
            const double *mean = analysis->total->mean + (ptrdiff_t)3 * part;
            const double *found = error + (ptrdiff_t)3 * part;
            const double difference[3] = {found[0] - mean[0], found[1] - mean[1],
                                          found[2] - mean[2]};
            if (length(difference) > term[i].tolerance * length(mean) + floors[part])
                print_error("%s, part %d: %g %g %g, by theory %g %g %g\n", term[i].name, part,
                            found[0], found[1], found[2], mean[0], mean[1], mean[2]);
            CHECK_BELOW(length(difference), term[i].tolerance * length(mean) + floors[part]);
        }
        free(analysis);
    }
    end_drive(&d);
}

/* ---- noise ---- */

static imk_drift_moments at_end(const drive *d, const imk_model *model)
{
    const double time = SECONDS;
    imk_drift_settings settings = imk_drift_default();
    settings.motion = &d->trajectory;
    settings.time = &time;
    settings.time_count = 1;
    imk_drift_analysis *analysis = analyse(model, &settings);
    const imk_drift_moments moments = *analysis->total;
    free(analysis);
    return moments;
}

static void check_same(const imk_drift_moments *a, const imk_drift_moments *b, double tolerance)
{
    for (int i = 0; i < 9; i++)
        for (int j = 0; j < 9; j++)
            CHECK_CLOSE(a->covariance[i][j], b->covariance[i][j],
                        tolerance * sqrt(b->covariance[i][i] * b->covariance[j][j]));
}

/* Slow noise is a constant (to t/T), and fast noise white (to T/t and the samples' share, which
 * moves the density by (dt/2T)^2/3). So constants, which the mechanisation confirms above, confirm
 * noise. */
static void noise_has_its_limits_on_the_drive(void **state)
{
    (void)state;
    drive d;
    start_drive(&d);
    imk_model constant, slow, white, fast;
    imk_model_default(&constant);
    slow = white = fast = constant;
    slow.gyro.noise.gauss_markov_count = slow.accel.noise.gauss_markov_count = 1;
    fast.gyro.noise.gauss_markov_count = fast.accel.noise.gauss_markov_count = 1;
    for (int i = 0; i < 3; i++) {
        constant.gyro.bias.repeatability.value[i] = 1e-6 * (1 + i);
        constant.accel.bias.repeatability.value[i] = 1e-3 * (1 + i);
        slow.gyro.noise.gauss_markov[0].sigma.value[i] = 1e-6 * (1 + i);
        slow.accel.noise.gauss_markov[0].sigma.value[i] = 1e-3 * (1 + i);
        slow.gyro.noise.gauss_markov[0].correlation_time.value[i] = 1e10;
        slow.accel.noise.gauss_markov[0].correlation_time.value[i] = 1e10;
        const double time = 0.1;
        white.gyro.noise.white.value[i] = 1e-6 * (1 + i);
        white.accel.noise.white.value[i] = 1e-3 * (1 + i);
        fast.gyro.noise.gauss_markov[0].sigma.value[i] = 1e-6 * (1 + i) / sqrt(2 * time);
        fast.accel.noise.gauss_markov[0].sigma.value[i] = 1e-3 * (1 + i) / sqrt(2 * time);
        fast.gyro.noise.gauss_markov[0].correlation_time.value[i] = time;
        fast.accel.noise.gauss_markov[0].correlation_time.value[i] = time;
    }
    imk_drift_moments a = at_end(&d, &slow), b = at_end(&d, &constant);
    check_same(&a, &b, 1e-6);
    a = at_end(&d, &fast), b = at_end(&d, &white);
    check_same(&a, &b, 3e-3);
    end_drive(&d);
}

/* Delays and the clock's error do nothing to a unit that aligns itself at rest: the attitude at the
 * start is right, and all goes on as from a given one. */
static void delays_do_not_disturb_an_alignment(void **state)
{
    (void)state;
    static const char *const names[3] = {"gyro.bandwidth", "timing.skew", "timing.rate_error"};
    drive d;
    start_drive(&d);
    for (int i = 0; i < 3; i++) {
        imk_model model = known();
        CHECK_OK(imk_model_select(&model, true, 1, &names[i], NULL));
        const double time[2] = {1, SECONDS}; /* still at rest, and at the end */
        imk_drift_settings settings = imk_drift_default();
        settings.motion = &d.trajectory;
        settings.time = time;
        settings.time_count = 2;
        imk_drift_analysis *given = analyse(&model, &settings);
        settings.alignment = IMK_ALIGNED_SELF;
        imk_drift_analysis *self = analyse(&model, &settings);
        for (int state_number = 0; state_number < 9; state_number++) {
            CHECK_CLOSE(self->total[0].mean[state_number], 0, 1e-15);
            CHECK_CLOSE(self->total[1].mean[state_number], given->total[1].mean[state_number],
                        1e-12);
        }
        free(given);
        free(self);
    }
    end_drive(&d);
}

/* Where the results are looked at cuts the steps: 600 s at once, or at 1800 odd times. What the
 * steps leave out is then another thing. */
static void steps_are_short_enough(void **state)
{
    (void)state;
    enum { TIMES = 1800 };
    drive d;
    start_drive(&d);
    imk_model model;
    imk_device_model(imk_device_find("tactical"), &model);
    imk_drift_settings settings = imk_drift_default();
    static double time[TIMES];
    for (int i = 0; i < TIMES; i++)
        time[i] = SECONDS * (double)(i + 1) / TIMES;
    settings.motion = &d.trajectory;
    settings.alignment = IMK_ALIGNED_SELF;
    settings.time = time;
    settings.time_count = TIMES;
    imk_drift_analysis *many = analyse(&model, &settings);
    settings.time = time + TIMES - 1;
    settings.time_count = 1;
    imk_drift_analysis *one = analyse(&model, &settings);
    for (size_t i = 0; i < one->source_count; i++)
        check_same(&many->contribution[(i + 1) * TIMES - 1], &one->contribution[i], 2e-4);
    for (int i = 0; i < 9; i++)
        CHECK_CLOSE(many->total[TIMES - 1].mean[i], one->total->mean[i],
                    1e-5 * sqrt(one->total->covariance[i][i]));
    free(many);
    free(one);
    end_drive(&d);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(known_terms_do_what_the_mechanisation_does),
        cmocka_unit_test(noise_has_its_limits_on_the_drive),
        cmocka_unit_test(delays_do_not_disturb_an_alignment),
        cmocka_unit_test(steps_are_short_enough),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
