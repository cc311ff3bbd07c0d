/* SPDX-License-Identifier: Apache-2.0 */
/* The floated rate-integrating gyro: float, loops and pulses against closed forms, error model
 * against the dynamics. */
#include "instrument_run.h"

#include "imukit/rate_integrating_gyro.h"

static const imk_instrument *const gyro = &imk_rate_integrating_gyro_instrument;

typedef imk_rate_integrating_gyro design_of;

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

static design_of balanced(imk_rebalance rebalance)
{
    design_of d = imk_rate_integrating_gyro_default();
    d.rebalance = rebalance;
    d.torque = (imk_error_torque){.noise = d.torque.noise};
    return d;
}

/* Settled reading: the loop's slow pole at 5 1/s has died to e^-50 after 10 s. */
static double reading(const design_of *d, imk_level level, const imk_exposure *exposure)
{
    const imk_physics_settings settings = quiet(100.0, level);
    return mean_of(gyro, d, &settings, exposure, 1000, 1, 0);
}

/* ---- open float ------------------------------------------------------------------------------ */

/* th = (H/C) w (t - T (1 - e^{-t/T})), T = I/C; the input axis turns away by th^2/2 < 1e-12. */
static void test_open_float(void **state)
{
    (void)state;
    const design_of d = balanced(IMK_REBALANCE_OPEN);
    const double w = 1e-5, lag = imk_rate_integrating_gyro_time_constant(&d);
    CHECK_RELATIVE(lag, 1.6e-3, 1e-15);
    CHECK_RELATIVE(imk_rate_integrating_gyro_gain(&d), 1.0, 1e-15);
    const imk_physics_settings settings = quiet(1000.0, IMK_LEVEL_FULL);
    const imk_exposure e = turning(w, 0, 0);
    double out, signals[IMK_INSTRUMENT_SIGNALS_MAX], angle = 0.0;
    void *s = started(gyro, &d, &settings);
    for (int i = 1; i <= 50; i++) {
        const double t = i / settings.rate;
        gyro->step(s, &e, &out);
        gyro->observe(s, signals);
        angle += out / settings.rate;
        CHECK_RELATIVE(signals[0], w * (t + lag * expm1(-t / lag)), 1e-11);
        CHECK_RELATIVE(angle, signals[0], 1e-12);
    }
    free(s);
}

/* I a' + C a = H w from any angle: (C th + I th')/H grows by exactly the angle of the case, less
 * (1 - cos th): angular momentum about the output axis. Uncounted angles of pulses likewise. */
static void test_angle_is_conserved(void **state)
{
    (void)state;
    const imk_rebalance kinds[] = {IMK_REBALANCE_TERNARY, IMK_REBALANCE_BINARY};
    for (int k = 0; k < 2; k++) {
        const design_of d = balanced(kinds[k]);
        const imk_physics_settings settings = quiet(100.0, IMK_LEVEL_FULL);
        const imk_exposure e = turning(0.123, 0, 0);
        double out, signals[IMK_INSTRUMENT_SIGNALS_MAX], angle = 0.0;
        const double pulse = imk_rate_integrating_gyro_pulse(&d);
        void *s = started(gyro, &d, &settings);
        for (int i = 1; i <= 500; i++) {
            gyro->step(s, &e, &out);
            gyro->observe(s, signals);
            angle += out / settings.rate;
            /* whole pulses, and what is left within half a unit and the rate of one period; cos th
             * costs (pulse gain)^2/2 = 1e-8 of the rate */
            CHECK_CLOSE(angle / pulse, nearbyint(angle / pulse), 1e-9 * i + 1e-9);
            CHECK_CLOSE(angle + signals[4], 0.123 * i / settings.rate, 1e-8 * 0.123 * i);
            CHECK_BELOW(fabs(signals[4]), pulse * (k == 0 ? 0.5 + 0.25 : 1.0 + 0.25));
        }
        free(s);
    }
}

/* ---- error model ----------------------------------------------------------------------------- */

static void test_scale_bias_force(void **state)
{
    (void)state;
    design_of d = imk_rate_integrating_gyro_default();
    d.momentum_error = 1e-3;
    d.torquer_error = -5e-4;
    d.torque.fixed = 1e-6;
    imk_model *model = malloc(sizeof *model);
    imk_rate_integrating_gyro_reduce(&d, model);
    const imk_triad *t = &model->gyro;
    CHECK_CLOSE(t->scale_factor.fixed.value[0], 1.001 / 0.9995 - 1.0, 1e-15);
    for (int level = IMK_LEVEL_FULL; level <= IMK_LEVEL_SLOW; level++) {
        imk_exposure e = imk_exposure_default();
        const double bias = reading(&d, level, &e);
        CHECK_RELATIVE(bias, t->bias.fixed.value[0], 1e-9);
        e.angular_rate[0] = 0.4;
        CHECK_CLOSE(reading(&d, level, &e) - bias, 0.4 * (1.0 + t->scale_factor.fixed.value[0]),
                    1e-12);
        e.temperature += 10.0;
        /* 1/(1 + e + a dT) to second order: (1e-4)^2 */
        CHECK_CLOSE(reading(&d, level, &e),
                    0.4 * (1.0 + t->scale_factor.fixed.value[0] +
                           10.0 * t->scale_factor.temperature.coefficient[0].value[0]) +
                        bias + 10.0 * t->bias.temperature.coefficient[0].value[0],
                    1e-8);
        e = imk_exposure_default();
        e.specific_force[0] = 9.0;
        e.specific_force[2] = 7.0;
        CHECK_RELATIVE(reading(&d, level, &e) - bias,
                       9.0 * t->g_sensitivity.value[0][0] + 7.0 * t->g_sensitivity.value[0][2] +
                           63.0 * t->g2_sensitivity.value[0][5],
                       1e-6);
        e = imk_exposure_default();
        e.angular_acceleration[1] = 3.0;
        CHECK_RELATIVE(reading(&d, level, &e) - bias,
                       -3.0 * (1.0 / 0.9995) * d.output_inertia / d.momentum, 1e-9);
    }
    free(model);
}

/* |G|^2 at the stated bandwidth is a half, and the response is that of
 * (K1 s + K2)/(I s^3 + C s^2 + K1 s + K2); 50 samples to a cycle, see test_rate_gyro.c. */
static void test_responses(void **state)
{
    (void)state;
    const design_of d = balanced(IMK_REBALANCE_ANALOG);
    imk_model *model = malloc(sizeof *model);
    imk_rate_integrating_gyro_reduce(&d, model);
    const double f = model->gyro.bandwidth.value[0], pi = 3.14159265358979324;
    imk_physics_settings settings = quiet(50.0 * f, IMK_LEVEL_FULL);
    CHECK_RELATIVE(sine_gain(gyro, &d, &settings, 1e-3, f, 5000, 4, NULL), sqrt(0.5), 2e-3);
    double k1, k2;
    imk_rate_integrating_gyro_loop(&d, &k1, &k2);
    CHECK_RELATIVE(k2, 4.0 * pi * pi * 16.0 * 0.04, 1e-14);
    const double w = 2.0 * pi * 10.0, re = k2 - d.damping * w * w,
                 im = (k1 - d.output_inertia * w * w) * w;
    settings.rate = 500.0;
    CHECK_RELATIVE(sine_gain(gyro, &d, &settings, 1e-3, 10.0, 2500, 4, NULL),
                   sqrt((k2 * k2 + k1 * k1 * w * w) / (re * re + im * im)), 2e-3);
    design_of open = balanced(IMK_REBALANCE_OPEN);
    imk_rate_integrating_gyro_reduce(&open, model);
    CHECK_RELATIVE(model->gyro.bandwidth.value[0], 1.0 / (2.0 * pi * 1.6e-3), 1e-12);
    settings.rate = 50.0 * model->gyro.bandwidth.value[0];
    CHECK_RELATIVE(sine_gain(gyro, &open, &settings, 1e-3, settings.rate / 50.0, 500, 4, NULL),
                   sqrt(0.5), 2e-3);
    free(model);
}

static void test_saturation(void **state)
{
    (void)state;
    const imk_rebalance kinds[] = {IMK_REBALANCE_ANALOG, IMK_REBALANCE_TERNARY,
                                   IMK_REBALANCE_BINARY};
    for (int k = 0; k < 3; k++) {
        const design_of d = balanced(kinds[k]);
        const double range = imk_rate_integrating_gyro_range(&d);
        const imk_physics_settings settings = quiet(100.0, IMK_LEVEL_FULL);
        CHECK_RELATIVE(range, 0.0215 / 0.04, 1e-15);
        imk_exposure e = turning(0.8, 0, 0);
        double samples[1000];
        void *s = started(gyro, &d, &settings);
        run(gyro, s, &e, 1000, 0, samples);
        CHECK_RELATIVE(samples[999], range, 1e-12);
        /* and comes back: no integral has wound up beyond the limit */
        e.angular_rate[0] = 0.1;
        run(gyro, s, &e, 1000, 0, samples);
        double sum = 0.0;
        for (int i = 900; i < 1000; i++)
            sum += samples[i] / 100.0;
        CHECK_CLOSE(sum, 0.1, 2.0 * imk_rate_integrating_gyro_pulse(&d));
        free(s);
    }
}

/* Angles left uncounted by a ternary loop under a rate that is no simple part of the pulse rate are
 * uniform over one pulse: Q = pulse/sqrt(12); over two in a binary loop. 20000 samples of a
 * quasi-periodic sequence; the variance of such fills to 1/n of its cycles, 1 %. */
static void test_quantization(void **state)
{
    (void)state;
    const imk_rebalance kinds[] = {IMK_REBALANCE_TERNARY, IMK_REBALANCE_BINARY};
    for (int k = 0; k < 2; k++) {
        design_of d = balanced(kinds[k]);
        imk_model *model = malloc(sizeof *model);
        imk_rate_integrating_gyro_reduce(&d, model);
        const double w = 0.0123456789;
        const imk_physics_settings settings = quiet(100.0, IMK_LEVEL_FULL);
        const imk_exposure e = turning(w, 0, 0);
        double out, angle = 0.0, sum = 0.0, square = 0.0;
        void *s = started(gyro, &d, &settings);
        const int count = 8000;
        for (int i = 1; i <= count; i++) {
            gyro->step(s, &e, &out);
            angle += (out - w) / settings.rate;
            sum += angle;
            square += angle * angle;
        }
        const double variance = square / count - sum / count * (sum / count);
        CHECK_RELATIVE(sqrt(variance), model->gyro.noise.quantization.value[0], 0.02);
        free(s);
        free(model);
    }
}

/* Without lead the lag of the float makes the loop hunt: the angle it leaves uncounted grows. */
static void test_hunting_without_lead(void **state)
{
    (void)state;
    design_of d = balanced(IMK_REBALANCE_BINARY);
    const imk_physics_settings settings = quiet(6400.0, IMK_LEVEL_FULL);
    const imk_exposure e = turning(1e-3, 0, 0);
    double out, signals[IMK_INSTRUMENT_SIGNALS_MAX], largest[2] = {0.0, 0.0};
    for (int lead = 0; lead < 2; lead++) {
        d.pulse_lead = lead ? 1.6e-3 : 0.0;
        void *s = started(gyro, &d, &settings);
        for (int i = 0; i < 4000; i++) {
            gyro->step(s, &e, &out);
            gyro->observe(s, signals);
            if (i > 2000 && fabs(signals[4]) > largest[lead])
                largest[lead] = fabs(signals[4]);
        }
        free(s);
    }
    CHECK_BELOW(largest[1], 1.01 * imk_rate_integrating_gyro_pulse(&d));
    assert_true(largest[0] > 3.0 * largest[1]);
}

/* ---- noise ----------------------------------------------------------------------------------- */

/* At 2 Hz, far below the bandwidth of the loop. */
static void test_chain_analog(void **state)
{
    (void)state;
    design_of d = imk_rate_integrating_gyro_default();
    d.pickoff_noise = 0.0;
    d.torque.instability = 3e-10;
    imk_physics_settings settings = imk_physics_default();
    settings.rate = 2.0;
    settings.step = 0.01;
    settings.seed = 3;
    const imk_exposure exposure = imk_exposure_default();
    check_chain(gyro, &d, &settings, &exposure, 10, 16000);
}

/* Noise of a pulse a sample makes the quantization random, as its term in the error model is. */
static void test_chain_pulses(void **state)
{
    (void)state;
    design_of d = imk_rate_integrating_gyro_default();
    d.rebalance = IMK_REBALANCE_TERNARY;
    d.pickoff_noise = 0.0;
    d.pulse_frequency = 800.0;
    d.torque.instability = 0.0;
    const double pulse = imk_rate_integrating_gyro_pulse(&d);
    d.torque.noise = 0.5 * pulse * sqrt(40.0) * d.momentum; /* half a pulse a sample */
    imk_physics_settings settings = imk_physics_default();
    settings.rate = 40.0;
    settings.seed = 4;
    const imk_exposure exposure = turning(0.0123, 0, 0);
    check_chain(gyro, &d, &settings, &exposure, 10, 20000);
}

/* ---- the interface --------------------------------------------------------------------------- */

static void test_copies_and_grade(void **state)
{
    (void)state;
    design_of d = imk_rate_integrating_gyro_default();
    imk_model *model = malloc(sizeof *model);
    imk_error error;
    for (int kind = IMK_REBALANCE_OPEN; kind <= IMK_REBALANCE_BINARY; kind++) {
        d.rebalance = (imk_rebalance)kind;
        imk_physics_settings settings = imk_physics_default();
        const imk_exposure e = turning(1e-3, 0.2, 0.3);
        void *a = started(gyro, &d, &settings), *b = started(gyro, &d, &settings);
        double x[50], y[50];
        run(gyro, a, &e, 333, 0, NULL);
        memcpy(b, a, gyro->state_size);
        run(gyro, a, &e, 50, 0, x);
        run(gyro, b, &e, 50, 0, y);
        assert_memory_equal(x, y, sizeof x);
        free(a);
        free(b);
        imk_instrument_reduce(gyro, &d, model);
        CHECK_OK(imk_model_validate(model, &error));
        imk_model_three_axes(model);
        assert_int_equal(imk_grade_model(model).gyro, IMK_GRADE_STRATEGIC);
    }
    free(model);
}

static void refused(design_of d, imk_status status, const char *field)
{
    imk_error error = {0};
    CHECK_STATUS(imk_rate_integrating_gyro_validate(&d, &error), status);
    assert_string_equal(error.field, field);
}

static void test_refusals(void **state)
{
    (void)state;
    const design_of good = imk_rate_integrating_gyro_default();
    design_of d = {0};
    refused(d, IMK_ERROR_UNINITIALISED, "design");
    d = good;
    d.damping = 0.0;
    refused(d, IMK_ERROR_RANGE, "float.damping");
    d = good;
    d.rebalance = (imk_rebalance)7;
    refused(d, IMK_ERROR_RANGE, "rebalance");
    d = good;
    d.output_inertia = 1.0;
    refused(d, IMK_ERROR_CONFLICT, "float.output_inertia");
    d = good;
    d.loop_frequency = 600.0; /* 2 z w < w^2 I/C from w = 5/1.6 ms, 497 Hz */
    refused(d, IMK_ERROR_CONFLICT, "loop.frequency");
    imk_error error = {0};
    imk_physics_settings settings = quiet(100.0, IMK_LEVEL_FULL);
    d = good;
    void *s = started(gyro, &d, &settings);
    settings.step = 0.026; /* a cycle of the loop has 10 of 25 ms */
    settings.rate = 10.0;
    CHECK_STATUS(imk_instrument_init(gyro, &d, &settings, s, &error), IMK_ERROR_RANGE);
    assert_string_equal(error.field, "step");
    d.rebalance = IMK_REBALANCE_BINARY;
    settings.step = 0.0;
    settings.rate = 300.0; /* 21.3 pulses to a sample */
    CHECK_STATUS(imk_instrument_init(gyro, &d, &settings, s, &error), IMK_ERROR_RANGE);
    assert_string_equal(error.field, "rate");
    free(s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_open_float),
        cmocka_unit_test(test_angle_is_conserved),
        cmocka_unit_test(test_scale_bias_force),
        cmocka_unit_test(test_responses),
        cmocka_unit_test(test_saturation),
        cmocka_unit_test(test_quantization),
        cmocka_unit_test(test_hunting_without_lead),
        cmocka_unit_test(test_chain_analog),
        cmocka_unit_test(test_chain_pulses),
        cmocka_unit_test(test_copies_and_grade),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
