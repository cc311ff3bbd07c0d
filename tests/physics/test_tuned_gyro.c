/* SPDX-License-Identifier: Apache-2.0 */
/* The dynamically tuned gyro: tuning, drag and nutation of the free rotor, the captured rotor
 * against closed forms and error model. */
#include "instrument_run.h"

#include "imukit/tuned_gyro.h"

static const imk_instrument *const gyro = &imk_tuned_gyro_instrument;
static const double pi = 3.14159265358979324;

static imk_physics_settings quiet(double rate, imk_level level)
{
    imk_physics_settings settings = imk_physics_default();
    settings.rate = rate;
    settings.level = level;
    settings.noise = false;
    return settings;
}

static imk_exposure turning(double x, double y, double z)
{
    imk_exposure exposure = imk_exposure_default();
    exposure.angular_rate[0] = x;
    exposure.angular_rate[1] = y;
    exposure.angular_rate[2] = z;
    return exposure;
}

/* A free rotor without error torques and damping. */
static imk_tuned_gyro free_rotor(void)
{
    imk_tuned_gyro d = imk_tuned_gyro_default();
    d.captured = false;
    d.torque = (imk_error_torque){0};
    d.hinge_damping = 0.0;
    d.pickoff_offset_x = d.pickoff_offset_y = 0.0;
    return d;
}

/* A loop so slow that it does not answer what the rotor does at 2N: the default one moves bias and
 * scale by 1e-4 of the springs and 1e-6. */
static imk_tuned_gyro slow_loop(void)
{
    imk_tuned_gyro d = imk_tuned_gyro_default();
    d.loop_frequency = 1.0;
    d.loop_damping = 1.0;
    d.loop_filter = 30.0;
    return d;
}

/* Mean tilt over a second: nutation and 2N, seen at whole turns, average out. */
static void mean_tilt(void *s, const imk_exposure *e, size_t samples, double tilt[2])
{
    double signals[IMK_INSTRUMENT_SIGNALS_MAX], out[IMK_INSTRUMENT_OUTPUTS_MAX];
    tilt[0] = tilt[1] = 0.0;
    for (size_t i = 0; i < samples; i++) {
        gyro->step(s, e, out);
        gyro->observe(s, signals);
        tilt[0] += signals[0] / (double)samples;
        tilt[1] += signals[1] / (double)samples;
    }
}

/* A started free rotor, tilted by turning the case away from it for 0.1 s. */
static void *tilted(const imk_tuned_gyro *d, const imk_physics_settings *settings)
{
    const imk_exposure away = turning(-0.01, 0, 0);
    void *s = started(gyro, d, settings);
    run(gyro, s, &away, (size_t)(0.1 * settings->rate), 0, NULL);
    return s;
}

/* ---- free rotor ------------------------------------------------------------------------------ */

static void test_closed_forms(void **state)
{
    (void)state;
    imk_tuned_gyro d = imk_tuned_gyro_default();
    CHECK_RELATIVE(imk_tuned_gyro_tuned_speed(&d), 400.0 * pi, 1e-14);
    CHECK_CLOSE(imk_tuned_gyro_residual_spring(&d), 0.0, 1e-15 * d.stiffness_x);
    CHECK_RELATIVE(imk_tuned_gyro_figure_of_merit(&d), 200.0, 1e-12);
    /* the textbook's N^2 = (kx + ky)/(Ag + Bg - Cg), J/(8 (2A - C)) = 0.42 % of N off the exact
     * one; in second order 1.7 % of that */
    CHECK_RELATIVE(imk_tuned_gyro_first_speed(&d), sqrt(2.0 * d.stiffness_x / 4e-8), 1e-14);
    CHECK_RELATIVE(400.0 * pi / imk_tuned_gyro_first_speed(&d) - 1.0, 4e-8 / (8.0 * 1.2e-6), 0.02);
    CHECK_RELATIVE(imk_tuned_gyro_momentum(&d, 400.0 * pi), 400.0 * pi * (8e-6 + 8e-8), 1e-4);
}

/* The full equations against the formula: tilt about x by a, and the rotor drifts about y with
 * -K a/H. Nutation left in the means over 1 s is at most 4.6e-6/100 rad of 1e-3, 5e-5 rad of
 * direction in 3 s; K and H are those of a rotor held still, and one that drifts is led by
 * J/(8 (2A - C)) = 0.4 % of it. */
static double drift_of_tilt(double speed_error)
{
    imk_tuned_gyro d = free_rotor();
    d.speed_error = speed_error;
    const imk_physics_settings settings = quiet(3333.0, IMK_LEVEL_FULL);
    const imk_exposure still = imk_exposure_default();
    double a[2], b[2];
    void *s = tilted(&d, &settings);
    mean_tilt(s, &still, 3333, a);
    run(gyro, s, &still, 6666, 0, NULL);
    mean_tilt(s, &still, 3333, b);
    free(s);
    return (atan2(b[1], b[0]) - atan2(a[1], a[0])) / 3.0;
}

static void test_tuning(void **state)
{
    (void)state;
    const double error[] = {-1e-2, -1e-3, 1e-3, 1e-2};
    CHECK_CLOSE(drift_of_tilt(0.0), 0.0, 3e-5);
    for (int i = 0; i < 4; i++) {
        imk_tuned_gyro d = free_rotor();
        d.speed_error = error[i];
        const double speed = imk_tuned_gyro_speed(&d);
        const double expected =
            -imk_tuned_gyro_residual_spring(&d) / imk_tuned_gyro_momentum(&d, speed);
        CHECK_CLOSE(drift_of_tilt(error[i]), expected, 3e-5 + 4e-3 * fabs(expected));
        /* the designer's rule: N dN/N over the figure of merit, good to 4 % */
        CHECK_RELATIVE(expected, speed * error[i] / imk_tuned_gyro_figure_of_merit(&d), 0.04);
    }
}

/* A free rotor that nutates: a jerk of the case, 1 rad/s within a sample, leaves it with a tilt and
 * a nutation of 1/(nutation frequency) = 4.6e-4 rad. */
static void *jerked(const imk_tuned_gyro *d, const imk_physics_settings *settings)
{
    imk_exposure jerk = imk_exposure_default();
    void *s = started(gyro, d, settings);
    jerk.angular_acceleration[0] = -settings->rate;
    run(gyro, s, &jerk, 1, 0, NULL);
    return s;
}

/* Exactly tuned and without damping, the rotor keeps its direction and its nutation for ever: in
 * 3.4e4 turns neither changes by 1e-9 a cycle. The nutation is measured as a standard deviation
 * over 10 s under Hann's window, behind which 3475 nutations leave the third power of their number.
 */
static double unrest(void *s, const imk_exposure *e, double tilt[2])
{
    enum { COUNT = 33330 };
    double signals[IMK_INSTRUMENT_SIGNALS_MAX], out[IMK_INSTRUMENT_OUTPUTS_MAX];
    double sum[2] = {0.0, 0.0}, square = 0.0;
    for (int i = 0; i < COUNT; i++) {
        const double weight = 1.0 - cos(2.0 * pi * (i + 0.5) / COUNT);
        gyro->step(s, e, out);
        gyro->observe(s, signals);
        for (int k = 0; k < 2; k++) {
            sum[k] += weight * signals[k];
            square += weight * signals[k] * signals[k];
        }
    }
    tilt[0] = sum[0] / COUNT;
    tilt[1] = sum[1] / COUNT;
    return sqrt(square / COUNT - tilt[0] * tilt[0] - tilt[1] * tilt[1]);
}

static void test_free_rotor_stays(void **state)
{
    (void)state;
    const imk_tuned_gyro d = free_rotor();
    const imk_physics_settings settings = quiet(3333.0, IMK_LEVEL_FULL);
    const imk_exposure still = imk_exposure_default();
    const double size = 1.0 / imk_tuned_gyro_nutation(&d);
    double a[2], b[2];
    void *s = jerked(&d, &settings);
    const double first = unrest(s, &still, a);
    run(gyro, s, &still, 3333 * 160, 0, NULL);
    const double last = unrest(s, &still, b);
    CHECK_RELATIVE(hypot(a[0], a[1]), size, 0.05);
    CHECK_RELATIVE(first, size, 0.05);
    CHECK_CLOSE(hypot(b[0] - a[0], b[1] - a[1]), 0.0, 1e-9 * 3.4e4 * size);
    CHECK_RELATIVE(last, first, 1e-9 * 3.4e4);
    free(s);
}

/* Nutation is counted by the tilt's crossings of its mean; H/(A + Ag/2) leaves out that the gimbal
 * follows about one axis of the shaft only, 1e-2. */
static void test_nutation(void **state)
{
    (void)state;
    const imk_tuned_gyro d = free_rotor();
    const imk_physics_settings settings = quiet(20000.0, IMK_LEVEL_FULL);
    const imk_exposure still = imk_exposure_default();
    double mean[2], signals[IMK_INSTRUMENT_SIGNALS_MAX], out[IMK_INSTRUMENT_OUTPUTS_MAX];
    void *s = jerked(&d, &settings);
    mean_tilt(s, &still, 20000, mean);
    int crossings = 0;
    double before = 0.0;
    for (int i = 0; i < 20000; i++) {
        gyro->step(s, &still, out);
        gyro->observe(s, signals);
        crossings += before < 0.0 && signals[0] >= mean[0];
        before = signals[0] - mean[0];
    }
    CHECK_RELATIVE(crossings, imk_tuned_gyro_nutation(&d) / (2.0 * pi), 0.01);
    free(s);
}

static void test_time_constant(void **state)
{
    (void)state;
    imk_tuned_gyro d = free_rotor();
    d.hinge_damping = 8e-7;
    const imk_physics_settings settings = quiet(100.0, IMK_LEVEL_FULL);
    const imk_exposure still = imk_exposure_default();
    double a[2], b[2];
    void *s = tilted(&d, &settings);
    mean_tilt(s, &still, 100, a);
    run(gyro, s, &still, 400, 0, NULL);
    mean_tilt(s, &still, 100, b);
    /* the formula leaves d out of the motion at 2N: J/(4 (2A - C)) = 1 % */
    CHECK_RELATIVE(5.0 / log(hypot(a[0], a[1]) / hypot(b[0], b[1])),
                   imk_tuned_gyro_time_constant(&d), 0.01);
    free(s);
}

/* ---- vibration at twice the speed ------------------------------------------------------------ */

static void test_vibration_at_2n(void **state)
{
    (void)state;
    imk_tuned_gyro d = free_rotor();
    d.captured = true;
    d.loop_frequency = 2.0;
    d.loop_damping = 1.0;
    d.loop_filter = 30.0;
    const imk_physics_settings settings = quiet(200.0 * 64.0, IMK_LEVEL_FULL);
    const double w = 2.0 * imk_tuned_gyro_speed(&d), amplitude = 1e-2, h = 1.0 / settings.rate;
    double drift[2][2];
    for (int quarter = 0; quarter < 2; quarter++) {
        double out[IMK_INSTRUMENT_OUTPUTS_MAX], sum[2] = {0.0, 0.0};
        const int count = 64 * 200 * 2;
        void *s = started(gyro, &d, &settings);
        for (int i = 0; i < count; i++) {
            /* means over the sample of a rate and its derivative */
            const double phase = w * (i + 0.5) * h + 0.5 * pi * quarter;
            const double smooth = sin(0.5 * w * h) / (0.5 * w * h);
            imk_exposure e = turning(amplitude * cos(phase) * smooth, 0, 0);
            e.angular_acceleration[0] = -w * amplitude * sin(phase) * smooth;
            gyro->step(s, &e, out);
            if (i >= count / 2)
                for (int k = 0; k < 2; k++)
                    sum[k] += out[k] / (count / 2);
        }
        for (int k = 0; k < 2; k++)
            drift[quarter][k] = sum[k];
        free(s);
    }
    /* J N/(8 H), in one direction or the other by the phase; the loop has settled to e^-25 after 2
     * s; held inputs cost (2 pi/32)^2/12 = 0.3 % */
    const double expected = amplitude * imk_tuned_gyro_vibration_drift(&d);
    CHECK_RELATIVE(imk_tuned_gyro_vibration_drift(&d), 1.0 / (8.0 * 200.0), 0.05);
    for (int quarter = 0; quarter < 2; quarter++)
        CHECK_RELATIVE(hypot(drift[quarter][0], drift[quarter][1]), expected, 0.01);
    CHECK_CLOSE(drift[0][0] * drift[1][0] + drift[0][1] * drift[1][1], 0.0,
                0.02 * expected * expected);
}

/* ---- captured rotor: level against level against error model --------------------------------- */

/* Settled reading: the double pole at 6.3 1/s has died to e^-120 after 20 s. Over whole turns. */
static double reading(const imk_tuned_gyro *d, imk_level level, const imk_exposure *exposure,
                      size_t output)
{
    const imk_physics_settings settings = quiet(100.0, level);
    return mean_of(gyro, d, &settings, exposure, level == IMK_LEVEL_FULL ? 2000 : 1, 100, output);
}

static void test_scale_bias_force(void **state)
{
    (void)state;
    imk_tuned_gyro d = slow_loop();
    d.speed_error = 1e-3; /* the speed is not a whole number of turns to a sample any more */
    d.torquer_error = -4e-4;
    d.torque.fixed = 1e-6;
    d.pickoff_offset_x = 2e-4;
    d.pickoff_offset_y = 3e-4;
    imk_model *model = malloc(sizeof *model);
    imk_tuned_gyro_reduce(&d, model);
    const imk_triad *t = &model->gyro;
    const double scale = 1.0 + t->scale_factor.fixed.value[0];
    /* H grows a little faster than the speed away from the tuned one: 1e-3 J/C */
    CHECK_CLOSE(scale, 1.001 / 0.9996, 5e-6);
    for (int level = IMK_LEVEL_FULL; level <= IMK_LEVEL_SLOW; level++) {
        /* what is left of the loop's answer at 2N */
        const double near = level == IMK_LEVEL_FULL ? 2e-7 : 1e-12;
        imk_exposure e = imk_exposure_default();
        const double bias = reading(&d, level, &e, 0), other = reading(&d, level, &e, 1);
        CHECK_CLOSE(bias, t->bias.fixed.value[0], near * 0.2);
        e.angular_rate[0] = 0.5;
        CHECK_CLOSE(reading(&d, level, &e, 0) - bias, 0.5 * scale, near);
        CHECK_CLOSE(reading(&d, level, &e, 1) - other, 0.0, 2.0 * near);
        e.angular_rate[0] = 0.0;
        e.angular_rate[1] = 0.5;
        CHECK_CLOSE(reading(&d, level, &e, 1) - other, 0.5 * scale, near);
        e.angular_rate[1] = 0.0;
        e.angular_rate[2] = 0.5;
        CHECK_CLOSE(reading(&d, level, &e, 0) - bias, 0.5 * t->misalignment.value[0][2],
                    10.0 * near);
        e = imk_exposure_default();
        for (int k = 0; k < 3; k++)
            e.specific_force[k] = 5.0 + k;
        CHECK_CLOSE(reading(&d, level, &e, 0) - bias,
                    5.0 * t->g_sensitivity.value[0][0] + 6.0 * t->g_sensitivity.value[0][1] +
                        35.0 * t->g2_sensitivity.value[0][5],
                    near * 0.01);
        e = imk_exposure_default();
        e.temperature += 10.0;
        e.angular_rate[0] = 0.5;
        /* 1/(1 + e + a dT) to second order: (2e-4)^2 */
        CHECK_CLOSE(reading(&d, level, &e, 0),
                    bias + 10.0 * t->bias.temperature.coefficient[0].value[0] +
                        0.5 * (scale + 10.0 * t->scale_factor.temperature.coefficient[0].value[0]),
                    1e-7);
    }
    free(model);
}

/* A steady state is steady: 10 s apart, to rounding (the sums of 16 steps a turn and the phase of
 * the shaft). */
static void test_steady_state(void **state)
{
    (void)state;
    const imk_tuned_gyro d = imk_tuned_gyro_default();
    const imk_physics_settings settings = quiet(100.0, IMK_LEVEL_FULL);
    const imk_exposure e = turning(0.3, -0.2, 0.0);
    double samples[2];
    void *s = started(gyro, &d, &settings);
    run(gyro, s, &e, 1000, 0, NULL);
    run(gyro, s, &e, 1, 0, samples);
    run(gyro, s, &e, 1000, 0, NULL);
    run(gyro, s, &e, 1, 0, samples + 1);
    CHECK_CLOSE(samples[1], samples[0], 1e-13);
    free(s);
}

/* The closed form leaves out nutation, the hold of a step (0.16 ms of 30 ms) and the motion at 2N:
 * 1 %. */
static void test_bandwidth(void **state)
{
    (void)state;
    const imk_tuned_gyro d = imk_tuned_gyro_default();
    imk_model *model = malloc(sizeof *model);
    imk_tuned_gyro_reduce(&d, model);
    const double f = model->gyro.bandwidth.value[0];
    const imk_physics_settings settings = quiet(50.0 * f, IMK_LEVEL_FULL);
    CHECK_RELATIVE(sine_gain(gyro, &d, &settings, 1e-3, f, 5000, 6, NULL), sqrt(0.5), 0.01);
    free(model);
}

/* A rotor that is not tuned is turned by its residual spring while the loop pulls. Where K/H =
 * 252 rad/s is above 2 z w0 = 126 rad/s, the slow root is about -w0^2 2 z w0/((2 z w0)^2 + (K/H)^2)
 * = -1 rad/s; 28 Hz fall to 0.6 Hz. */
static void test_bandwidth_of_a_rotor_out_of_tune(void **state)
{
    (void)state;
    imk_tuned_gyro d = imk_tuned_gyro_default();
    imk_model *model = malloc(sizeof *model);
    imk_tuned_gyro_reduce(&d, model);
    const double tuned = model->gyro.bandwidth.value[0];
    d.stiffness_x *= 100.0;
    imk_tuned_gyro_reduce(&d, model);
    const double f = model->gyro.bandwidth.value[0];
    const imk_physics_settings settings = quiet(200.0 * f, IMK_LEVEL_FULL);
    CHECK_BELOW(f, 0.03 * tuned);
    CHECK_RELATIVE(sine_gain(gyro, &d, &settings, 1e-3, f, 20000, 6, NULL), sqrt(0.5), 0.02);
    free(model);
}

static void test_saturation(void **state)
{
    (void)state;
    const imk_tuned_gyro d = imk_tuned_gyro_default();
    const imk_exposure e = turning(-2.5, 0, 0);
    imk_model *model = malloc(sizeof *model);
    imk_tuned_gyro_reduce(&d, model);
    for (int level = IMK_LEVEL_FULL; level <= IMK_LEVEL_SLOW; level++)
        CHECK_RELATIVE(reading(&d, level, &e, 0), -model->gyro.range.value[0], 1e-12);
    free(model);
}

/* ---- noise and interface --------------------------------------------------------------------- */

/* At 2 Hz, far below the bandwidth of the loop. */
static void test_chain(void **state)
{
    (void)state;
    imk_tuned_gyro d = imk_tuned_gyro_default();
    d.pickoff_noise = 0.0;
    imk_physics_settings settings = imk_physics_default();
    settings.rate = 2.0;
    settings.seed = 2;
    const imk_exposure exposure = imk_exposure_default();
    check_chain(gyro, &d, &settings, &exposure, 20, 12000);
}

static void test_copies_and_grade(void **state)
{
    (void)state;
    const imk_tuned_gyro d = imk_tuned_gyro_default();
    const imk_physics_settings settings = imk_physics_default();
    const imk_exposure e = turning(0.1, 0.2, 0.3);
    void *a = started(gyro, &d, &settings), *b = started(gyro, &d, &settings);
    double x[50], y[50];
    run(gyro, a, &e, 333, 1, NULL);
    memcpy(b, a, gyro->state_size);
    run(gyro, a, &e, 50, 1, x);
    run(gyro, b, &e, 50, 1, y);
    assert_memory_equal(x, y, sizeof x);
    free(a);
    free(b);
    imk_model *model = malloc(sizeof *model);
    imk_error error;
    imk_instrument_reduce(gyro, &d, model);
    CHECK_OK(imk_model_validate(model, &error));
    imk_model_three_axes(model);
    assert_int_equal(imk_grade_model(model).gyro, IMK_GRADE_TACTICAL);
    free(model);
}

static void refused(imk_tuned_gyro d, imk_status status, const char *field)
{
    imk_error error = {0};
    CHECK_STATUS(imk_tuned_gyro_validate(&d, &error), status);
    assert_string_equal(error.field, field);
}

static void test_refusals(void **state)
{
    (void)state;
    const imk_tuned_gyro good = imk_tuned_gyro_default();
    imk_tuned_gyro d = {0};
    refused(d, IMK_ERROR_UNINITIALISED, "design");
    d = good;
    d.gimbal_inertia_x = -1e-7;
    refused(d, IMK_ERROR_RANGE, "gimbal.inertia_x");
    d = good;
    d.axial_inertia = 9.3e-6;
    refused(d, IMK_ERROR_CONFLICT, "rotor.axial_inertia");
    d = good;
    d.axial_inertia = 4e-6;
    refused(d, IMK_ERROR_CONFLICT, "rotor.axial_inertia");
    d = good;
    d.gimbal_inertia_z = 2e-7; /* a thin ring: J = 0, no speed tunes it */
    refused(d, IMK_ERROR_CONFLICT, "gimbal.inertia_z");
    d = good;
    d.transverse_inertia = 4.005e-6; /* nutation at 2N */
    refused(d, IMK_ERROR_CONFLICT, "rotor.transverse_inertia");
    d = good;
    d.loop_frequency = 200.0;
    refused(d, IMK_ERROR_CONFLICT, "loop.frequency");
    d = good;
    d.loop_filter = 2000.0; /* lets the nutation through, which a proportional loop drives */
    refused(d, IMK_ERROR_CONFLICT, "loop.frequency");
    imk_physics_settings settings = quiet(10.0, IMK_LEVEL_FULL);
    imk_error error = {0};
    void *s = started(gyro, &good, &settings);
    settings.step = 0.7e-3; /* a turn of 5 ms has 8 of 0.625 ms */
    CHECK_STATUS(imk_instrument_init(gyro, &good, &settings, s, &error), IMK_ERROR_RANGE);
    assert_string_equal(error.field, "step");
    free(s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_closed_forms),
        cmocka_unit_test(test_tuning),
        cmocka_unit_test(test_free_rotor_stays),
        cmocka_unit_test(test_nutation),
        cmocka_unit_test(test_time_constant),
        cmocka_unit_test(test_vibration_at_2n),
        cmocka_unit_test(test_scale_bias_force),
        cmocka_unit_test(test_steady_state),
        cmocka_unit_test(test_bandwidth),
        cmocka_unit_test(test_bandwidth_of_a_rotor_out_of_tune),
        cmocka_unit_test(test_saturation),
        cmocka_unit_test(test_chain),
        cmocka_unit_test(test_copies_and_grade),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
