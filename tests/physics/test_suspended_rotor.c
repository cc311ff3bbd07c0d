/* SPDX-License-Identifier: Apache-2.0 */
/* The electrostatically suspended gyro: closed forms, invariants, drift, levels, noise, chain.
 *
 * Statistical tests have a fixed seed and limits of five standard deviations (false alarms 6e-7).
 */
#define _POSIX_C_SOURCE 200809L /* setenv */
#include "instrument_run.h"

#include "imukit/attitude.h"
#include "imukit/suspended_rotor.h"

static const double pi = 3.14159265358979324;
static const double degree_per_hour = 3.14159265358979324 / 180.0 / 3600.0;
static const double gravity = 9.80665;
static const imk_instrument *const gyro = &imk_suspended_rotor_instrument;

/* Signals by place. */
enum { AXIS_X, AXIS_Y, AXIS_Z, DRIFT, WOBBLE };

/* No error but those of shape, unbalance and preload. */
static imk_suspended_rotor quiet(void)
{
    imk_suspended_rotor d = imk_suspended_rotor_default();
    d.torque_temperature = d.torque_repeatability = d.torque_instability = d.torque_noise = 0.0;
    d.readout_resolution = d.readout_noise = 0.0;
    return d;
}

static imk_suspended_rotor perfect(void)
{
    imk_suspended_rotor d = quiet();
    d.unbalance = d.oblateness = d.pear = 0.0;
    return d;
}

static imk_physics_settings settings_of(imk_level level, double rate, bool noise)
{
    imk_physics_settings settings = imk_physics_default();
    settings.level = level;
    settings.rate = rate;
    settings.noise = noise;
    settings.seed = 1;
    return settings;
}

static void axis_of(const void *state, double axis[3])
{
    double signals[IMK_INSTRUMENT_SIGNALS_MAX];
    gyro->observe(state, signals);
    memcpy(axis, signals, 3 * sizeof *axis);
}

/* ---- closed forms ---------------------------------------------------------------------------- */

/* By hand: 1 cm of beryllium is 0.96761 g; 2/5 m r^2 = 9.6761e-9 kg m^2; at 2500 rev/s 1.51992e-4 N
 * m s, which C = 3 1.02/3.02 of it raises by 1.3245 %; 1 nm of unbalance drifts 0.01271 deg/h/g. */
static void numbers_of_the_ball(void **unused)
{
    (void)unused;
    imk_suspended_rotor d = imk_suspended_rotor_default();
    CHECK_RELATIVE(imk_suspended_rotor_mass(&d), 0.96761e-3, 1e-5);
    CHECK_RELATIVE(imk_suspended_rotor_momentum(&d), 1.51992e-4 * 1.013245, 1e-5);
    CHECK_RELATIVE(imk_suspended_rotor_wobble(&d), 2550.0, 1e-14);
    d.hollow = 0.005; /* a hollow of half the diameter has 1/8 of the volume, 1/32 of the inertia */
    CHECK_RELATIVE(imk_suspended_rotor_mass(&d), 0.96761e-3 * 7.0 / 8.0, 1e-5);
    CHECK_RELATIVE(imk_suspended_rotor_momentum(&d), 1.51992e-4 * 1.013245 * 31.0 / 32.0, 1e-5);
    d = perfect();
    d.unbalance = 1e-9;
    const double z[3] = {0.0, 0.0, 1.0}, x[3] = {gravity, 0.0, 0.0};
    double drift[3];
    imk_suspended_rotor_drift(&d, z, x, drift);
    CHECK_CLOSE(fabs(drift[1]) / degree_per_hour, 0.012709, 1e-6);
    CHECK_CLOSE(drift[0], 0.0, 1e-30);
    CHECK_CLOSE(drift[2], 0.0, 1e-30);
}

/* The work G of the fields, differentiated by differences along the drift's own directions, gives
 * the drift; equal preloads do not turn an oblate ball (P2 over three perpendicular axes adds up to
 * nothing), unequal ones do. */
static double work(const imk_suspended_rotor *d, const double s[3], const double f[3])
{
    const double m = imk_suspended_rotor_mass(d), rest = 0.5 * m * d->limit;
    double sum = 0.0;
    for (int k = 0; k < 3; k++) {
        const double x = s[k], carried = m * f[k];
        const double pull = rest * (1.0 + d->preload_error[k]) + carried * carried / (4.0 * rest);
        sum += -m * d->unbalance * f[k] * x +
               d->pear * carried * 0.5 * (5.0 * x * x * x - 3.0 * x) +
               d->oblateness * pull * 0.5 * (3.0 * x * x - 1.0);
    }
    return sum;
}

static void drift_is_gradient_of_work(void **unused)
{
    (void)unused;
    imk_suspended_rotor d = quiet();
    const double s[3] = {0.48, 0.6, 0.64}, f[3] = {7.0, -12.0, 5.0};
    double drift[3], gradient[3];
    d.pear = 3e-9;
    imk_suspended_rotor_drift(&d, s, f, drift);
    for (int k = 0; k < 3; k++) {
        double up[3] = {s[0], s[1], s[2]}, down[3] = {s[0], s[1], s[2]};
        up[k] += 1e-4;
        down[k] -= 1e-4;
        gradient[k] = (work(&d, up, f) - work(&d, down, f)) / 2e-4;
    }
    const double h = imk_suspended_rotor_momentum(&d);
    const double size = sqrt(drift[0] * drift[0] + drift[1] * drift[1] + drift[2] * drift[2]);
    for (int k = 0; k < 3; k++) {
        const int l = (k + 1) % 3, m = (k + 2) % 3;
        CHECK_CLOSE(drift[k], (s[l] * gradient[m] - s[m] * gradient[l]) / h, 1e-6 * size);
    }
    const double nothing[3] = {0.0, 0.0, 0.0};
    for (int k = 0; k < 3; k++)
        d.preload_error[k] = 0.2;
    imk_suspended_rotor_drift(&d, s, nothing, drift);
    for (int k = 0; k < 3; k++)
        CHECK_CLOSE(drift[k], 0.0, 1e-18);
    d.preload_error[0] = 0.1;
    imk_suspended_rotor_drift(&d, s, nothing, drift);
    assert_true(fabs(drift[1]) > 1e-8);
}

/* ---- invariants ------------------------------------------------------------------------------ */

/* A perfect ball keeps its axis in inertial space while the case tumbles for 200 s about axes that
 * change, and what it reads is the case's rate but for the part along its axis. 20 000 turns round
 * to 2e-16 each: 1e-13 is expected. */
static void axis_stays_in_space(void **unused)
{
    (void)unused;
    const imk_suspended_rotor d = perfect();
    for (int level = 0; level < 2; level++) {
        const imk_physics_settings settings = settings_of((imk_level)level, 100.0, false);
        void *state = started(gyro, &d, &settings);
        imk_quaternion attitude = imk_quaternion_identity();
        double out[IMK_INSTRUMENT_OUTPUTS_MAX], axis[3], after[3];
        for (int i = 0; i < 20000; i++) {
            imk_exposure x = imk_exposure_default();
            const double t = 0.01 * i;
            axis_of(state, axis);
            for (int k = 0; k < 3; k++)
                x.angular_rate[k] = 3.0 * sin((1.0 + 0.3 * k) * t + k);
            gyro->step(state, &x, out);
            const imk_vector3 turn = {
                {0.01 * x.angular_rate[0], 0.01 * x.angular_rate[1], 0.01 * x.angular_rate[2]}};
            attitude = imk_quaternion_multiply(attitude, imk_quaternion_from_rotation_vector(turn));
            axis_of(state, after);
            double along = 0.0;
            for (int k = 0; k < 3; k++) {
                axis[k] = 0.5 * (axis[k] + after[k]);
                along += axis[k] * x.angular_rate[k];
            }
            /* the axis goes an arc of a small circle, not of a great one: (w dt)^2/12 of the rate
             * of at most 5 rad/s, and the mean of its ends as much */
            CHECK_CLOSE(out[0], x.angular_rate[0] - axis[0] * along, 2e-3);
        }
        axis_of(state, axis);
        const imk_vector3 seen = {{axis[0], axis[1], axis[2]}};
        const imk_vector3 fixed = imk_quaternion_rotate(imk_quaternion_normalise(attitude), seen);
        CHECK_CLOSE(fixed.v[0], 0.0, 1e-12);
        CHECK_CLOSE(fixed.v[1], 0.0, 1e-12);
        CHECK_CLOSE(imk_vector3_norm(seen), 1.0, 4e-16);
        free(state);
    }
}

/* A turn across the axis is read exactly, through any angle; one along the axis not at all. */
static void reads_the_rate(void **unused)
{
    (void)unused;
    imk_suspended_rotor d = perfect();
    imk_exposure x = imk_exposure_default();
    double out[IMK_INSTRUMENT_OUTPUTS_MAX];
    const imk_physics_settings settings = settings_of(IMK_LEVEL_FULL, 10.0, false);
    x.angular_rate[0] = 2.0;
    void *state = started(gyro, &d, &settings);
    for (int i = 0; i < 100; i++) {
        gyro->step(state, &x, out);
        CHECK_CLOSE(out[0], 2.0, 1e-13);
        CHECK_CLOSE(out[1], 0.0, 1e-13);
    }
    free(state);
    x.angular_rate[0] = 0.0;
    x.angular_rate[1] = -1.0;
    CHECK_CLOSE(mean_of(gyro, &d, &settings, &x, 0, 10, 1), -1.0, 1e-13);
    x.angular_rate[1] = 0.0;
    x.angular_rate[2] = 3.0;
    CHECK_CLOSE(mean_of(gyro, &d, &settings, &x, 0, 10, 0), 0.0, 1e-13);
    d.start_tilt = 0.5 * pi; /* along x */
    x.angular_rate[2] = 0.0;
    x.angular_rate[0] = 1.0;
    CHECK_CLOSE(mean_of(gyro, &d, &settings, &x, 0, 10, 0), 0.0, 1e-13);
    double phase;
    d = perfect();
    const imk_physics_settings fast = settings_of(IMK_LEVEL_FULL, 1000.0, false);
    CHECK_CLOSE(sine_gain(gyro, &d, &fast, 0.1, 200.0, 0, 20, &phase), 1.0, 1e-9);
    CHECK_CLOSE(phase, 0.0, 1e-9);
}

/* ---- levels and the error model -------------------------------------------------------------- */

static double reading_under(const imk_suspended_rotor *d, imk_level level, const double rate[3],
                            const double force[3])
{
    const imk_physics_settings settings = settings_of(level, 10.0, false);
    imk_exposure x = imk_exposure_default();
    for (int k = 0; k < 3; k++) {
        x.angular_rate[k] = rate[k];
        x.specific_force[k] = force[k];
    }
    return mean_of(gyro, d, &settings, &x, 0, 2, 0);
}

/* What reduce states is what both levels read, term by term, with an axis along none of the case's.
 * A tenth of a second's drift changes the geometry by 1e-8. */
static void levels_agree_with_model(void **unused)
{
    (void)unused;
    imk_suspended_rotor d = quiet();
    const double none[3] = {0.0, 0.0, 0.0};
    d.start_tilt = 0.7;
    d.start_azimuth = 0.9;
    d.pear = 5e-10;
    d.torque[0] = 1e-12;
    d.torque[1] = -2e-12;
    d.torque[2] = 3e-12;
    imk_model *model = malloc(sizeof *model);
    imk_instrument_reduce(gyro, &d, model);
    const imk_triad *g = &model->gyro;
    CHECK_OK(imk_model_validate(model, NULL));
    const double size = fabs(g->g_sensitivity.value[0][0]) * gravity; /* 5e-8 rad/s */
    for (int level = 0; level < 2; level++) {
        const double bias = reading_under(&d, (imk_level)level, none, none);
        CHECK_CLOSE(bias, g->bias.fixed.value[0], 1e-6 * size);
        for (int k = 0; k < 3; k++) {
            double rate[3] = {0.0, 0.0, 0.0}, force[3] = {0.0, 0.0, 0.0};
            rate[k] = 1e-5;
            const double gain = (reading_under(&d, (imk_level)level, rate, none) - bias) / rate[k];
            CHECK_CLOSE(gain,
                        (k == 0 ? 1.0 + g->scale_factor.fixed.value[0] : 0.0) +
                            g->misalignment.value[0][k],
                        1e-5);
            force[k] = gravity;
            const double up = reading_under(&d, (imk_level)level, none, force) - bias;
            force[k] = -gravity;
            const double down = reading_under(&d, (imk_level)level, none, force) - bias;
            CHECK_CLOSE(0.5 * (up - down), g->g_sensitivity.value[0][k] * gravity, 1e-6 * size);
            CHECK_CLOSE(0.5 * (up + down), g->g2_sensitivity.value[0][k] * gravity * gravity,
                        1e-6 * size);
            CHECK_CLOSE(g->g2_sensitivity.value[0][3 + k], 0.0, 0.0); /* no products in the work */
        }
    }
    imk_suspended_rotor warm = d;
    warm.torque_temperature = 1e-13;
    imk_instrument_reduce(gyro, &warm, model);
    imk_exposure x = imk_exposure_default();
    x.temperature += 20.0;
    const imk_physics_settings settings = settings_of(IMK_LEVEL_SLOW, 10.0, false);
    CHECK_RELATIVE(mean_of(gyro, &warm, &settings, &x, 0, 2, 0) - g->bias.fixed.value[0],
                   20.0 * g->bias.temperature.coefficient[0].value[0], 1e-5);
    free(model);
}

/* Where the axis goes in an hour of force and turning does not depend on the step: second order, so
 * that 10 ms differs from 2.5 ms by (w h)^2/12 of the drift, 1e-5 of it, at most. */
static void step_does_not_matter(void **unused)
{
    (void)unused;
    imk_suspended_rotor d = quiet();
    d.unbalance = 1e-6; /* 13 deg/h/g */
    double axis[2][3];
    for (int fine = 0; fine < 2; fine++) {
        const imk_physics_settings settings =
            settings_of(IMK_LEVEL_FULL, fine ? 400.0 : 100.0, false);
        imk_exposure x = imk_exposure_default();
        x.angular_rate[0] = 0.5;
        x.angular_rate[1] = 1.0;
        x.specific_force[0] = 5.0;
        x.specific_force[2] = -gravity;
        void *state = started(gyro, &d, &settings);
        run(gyro, state, &x, fine ? 24000 : 6000, 0, NULL);
        axis_of(state, axis[fine]);
        free(state);
    }
    for (int k = 0; k < 3; k++)
        CHECK_CLOSE(axis[0][k], axis[1][k], 60.0 * 13.0 * degree_per_hour * 1e-5);
}

/* The axis of figure goes round the angular momentum 2550 times a second on a cone that decays; the
 * readings at 10 kHz show it, and the mean over a turn is the momentum's. */
static void wobble(void **unused)
{
    (void)unused;
    imk_suspended_rotor d = perfect();
    d.start_wobble = 1e-3;
    d.wobble_time = 0.05;
    const imk_physics_settings settings = settings_of(IMK_LEVEL_FULL, 10000.0, false);
    const imk_exposure x = imk_exposure_default();
    double out[IMK_INSTRUMENT_OUTPUTS_MAX], axis[3], signals[IMK_INSTRUMENT_SIGNALS_MAX];
    void *state = started(gyro, &d, &settings);
    double real = 0.0, imaginary = 0.0;
    for (int i = 1; i <= 1000; i++) {
        gyro->step(state, &x, out);
        const double t = i / 10000.0, angle = 2.0 * pi * 2550.0 * t;
        CHECK_CLOSE(hypot(out[2], out[3]), sin(1e-3 * exp(-t / 0.05)), 1e-15);
        /* against a turn at 2550 Hz the direction stands still */
        const double c = cos(angle), s = sin(angle), length = hypot(out[2], out[3]);
        real += (out[2] * c + out[3] * s) / length;
        imaginary += (out[3] * c - out[2] * s) / length;
    }
    CHECK_RELATIVE(hypot(real, imaginary), 1000.0, 1e-9);
    axis_of(state, axis);
    CHECK_CLOSE(axis[0], 0.0, 1e-15);
    gyro->observe(state, signals);
    CHECK_RELATIVE(signals[WOBBLE], 1e-3 * exp(-0.1 / 0.05), 1e-12);
    free(state);
}

/* ---- noise ----------------------------------------------------------------------------------- */

/* Variance of the readings of either level against N^2/dt, 20 000 samples: 1 %, 5 sigma. */
static void angle_random_walk(void **unused)
{
    (void)unused;
    imk_suspended_rotor d = perfect();
    d.torque_noise = 1e-11;
    d.start_tilt = 0.5;
    imk_model *model = malloc(sizeof *model);
    imk_instrument_reduce(gyro, &d, model);
    const double n = model->gyro.noise.white.value[0];
    const imk_exposure x = imk_exposure_default();
    for (int level = 0; level < 2; level++) {
        const imk_physics_settings settings = settings_of((imk_level)level, 100.0, true);
        void *state = started(gyro, &d, &settings);
        static double out[20000];
        double square = 0.0;
        run(gyro, state, &x, 20000, 0, out);
        for (int i = 0; i < 20000; i++)
            square += out[i] * out[i] / 20000.0;
        CHECK_RELATIVE(square * 0.01, n * n, 0.05);
        free(state);
    }
    free(model);
}

/* White noise, flicker and quantization of the default, at 1 Hz for six hours, with a torque noise
 * and instability that a record of that length shows. */
static void chain(void **unused)
{
    (void)unused;
    imk_suspended_rotor d = imk_suspended_rotor_default();
    d.torque_noise *= 20.0;
    d.torque_instability *= 100.0;
    imk_physics_settings settings = settings_of(IMK_LEVEL_FULL, 1.0, true);
    settings.step = 0.1;
    const imk_exposure x = imk_exposure_default();
    check_chain(gyro, &d, &settings, &x, 10, 20000);
    /* white torque alone, whose interval is then +-5.5 % */
    d.torque_repeatability = d.torque_instability = d.readout_resolution = d.readout_noise = 0.0;
    check_chain(gyro, &d, &settings, &x, 10, 4000);
}

/* Strategic, and the table's row of that class names the technology. */
static void grade(void **unused)
{
    (void)unused;
    const imk_suspended_rotor d = imk_suspended_rotor_default();
    imk_model *model = malloc(sizeof *model);
    imk_instrument_reduce(gyro, &d, model);
    imk_model_three_axes(model);
    CHECK_OK(imk_model_validate(model, NULL));
    const imk_grade found = imk_grade_model(model).gyro;
    assert_int_equal(found, IMK_GRADE_STRATEGIC);
    assert_non_null(strstr(imk_grade_table(found)->gyro_technology, gyro->technology));
    free(model);
}

/* ---- refusals, bits -------------------------------------------------------------------------- */

static void refused(const imk_suspended_rotor *d, imk_status status, const char *field)
{
    imk_error error = {0};
    CHECK_STATUS(imk_design_check(gyro, d, &error), status);
    assert_string_equal(error.field, field);
}

static void refusals(void **unused)
{
    (void)unused;
    imk_suspended_rotor d = {0};
    CHECK_STATUS(imk_design_check(gyro, &d, NULL), IMK_ERROR_UNINITIALISED);
    const imk_suspended_rotor good = imk_suspended_rotor_default();
    CHECK_OK(imk_design_check(gyro, &good, NULL));
    d = good;
    d.density = (double)NAN;
    refused(&d, IMK_ERROR_NOT_FINITE, "ball.density");
    d = good;
    d.inertia_difference = 0.0;
    refused(&d, IMK_ERROR_RANGE, "ball.inertia_difference");
    d = good;
    d.hollow = d.diameter;
    refused(&d, IMK_ERROR_CONFLICT, "ball.hollow");
    d = good;
    d.clearance = d.gap;
    refused(&d, IMK_ERROR_CONFLICT, "suspension.clearance");
    d = good;
    d.limit = 1e6; /* 2 limit/gap = 2e12/s^2 with a micrometre */
    d.gap = 1e-6;
    d.clearance = 5e-7;
    refused(&d, IMK_ERROR_CONFLICT, "suspension.gap");
    d = good;
    d.oblateness = 6e-6;
    refused(&d, IMK_ERROR_CONFLICT, "ball.oblateness");
    imk_physics_settings settings = settings_of(IMK_LEVEL_SLOW, 1.0, true);
    imk_error error = {0};
    void *state = started(gyro, &good, &settings);
    settings.step = 0.2;
    CHECK_STATUS(imk_instrument_init(gyro, &good, &settings, state, &error), IMK_ERROR_RANGE);
    assert_string_equal(error.field, "step");
    settings.step = 0.0;
    CHECK_CLOSE(gyro->step_length(&good, &settings), 0.01, 0.0);
    free(state);
}

/* A copy goes on with the same bits; so does another instruction set. */
static void same_bits(void **unused)
{
    (void)unused;
    imk_suspended_rotor d = imk_suspended_rotor_default();
    imk_exposure x = imk_exposure_default();
    double first[IMK_INSTRUMENT_OUTPUTS_MAX], second[IMK_INSTRUMENT_OUTPUTS_MAX];
    x.angular_rate[0] = 0.1;
    x.angular_rate[1] = 0.2;
    x.specific_force[2] = -gravity;
    d.start_wobble = 1e-5;
    const imk_physics_settings settings = settings_of(IMK_LEVEL_FULL, 100.0, true);
    void *state = started(gyro, &d, &settings), *copy = started(gyro, &d, &settings);
    run(gyro, state, &x, 150, 0, NULL);
    memcpy(copy, state, gyro->state_size);
    run(gyro, state, &x, 150, 0, NULL);
    gyro->step(state, &x, first);
    run(gyro, copy, &x, 150, 0, NULL);
    gyro->step(copy, &x, second);
    assert_memory_equal(first, second, gyro->output_count * sizeof *first);
    free(copy);
    setenv("IMUKIT_ISA", "scalar", 1);
    copy = started(gyro, &d, &settings);
    unsetenv("IMUKIT_ISA");
    run(gyro, copy, &x, 300, 0, NULL);
    gyro->step(copy, &x, second);
    assert_memory_equal(first, second, gyro->output_count * sizeof *first);
    free(copy);
    free(state);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_of_the_ball),
        cmocka_unit_test(drift_is_gradient_of_work),
        cmocka_unit_test(axis_stays_in_space),
        cmocka_unit_test(reads_the_rate),
        cmocka_unit_test(levels_agree_with_model),
        cmocka_unit_test(step_does_not_matter),
        cmocka_unit_test(wobble),
        cmocka_unit_test(angle_random_walk),
        cmocka_unit_test(chain),
        cmocka_unit_test(grade),
        cmocka_unit_test(refusals),
        cmocka_unit_test(same_bits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
