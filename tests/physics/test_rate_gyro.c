/* SPDX-License-Identifier: Apache-2.0 */
/* The spring-restrained rate gyro: closed forms, dynamics against them, error model against the
 * dynamics. */
#include "instrument_run.h"

#include "imukit/rate_gyro.h"

static const imk_instrument *const gyro = &imk_rate_gyro_instrument;
static const double pi = 3.14159265358979324, deg_per_hour = 3.14159265358979324 / 180 / 3600;

static imk_physics_settings quiet(double rate, imk_level level)
{
    imk_physics_settings settings = imk_physics_default();
    settings.rate = rate;
    settings.level = level;
    settings.noise = false;
    return settings;
}

/* Reading after it has settled: at 100 Hz the default gyro's e-folding time is 7.6 ms, and 1 s
 * leaves 1e-57. */
static double reading(const imk_rate_gyro *design, imk_level level, const imk_exposure *exposure)
{
    const imk_physics_settings settings = quiet(100.0, level);
    return mean_of(gyro, design, &settings, exposure, 100, 1, 0);
}

static imk_exposure turning(double x, double y, double z)
{
    imk_exposure exposure = imk_exposure_default();
    exposure.angular_rate[0] = x;
    exposure.angular_rate[1] = y;
    exposure.angular_rate[2] = z;
    return exposure;
}

/* ---- closed forms ---------------------------------------------------------------------------- */

static void test_closed_forms(void **state)
{
    (void)state;
    const imk_rate_gyro d = imk_rate_gyro_default();
    CHECK_RELATIVE(imk_rate_gyro_sensitivity(&d), 0.0125, 1e-15);
    /* sqrt(.08/2.25e-6) and 5.94e-4/(2 sqrt(.08 * 2.25e-6)), by hand */
    CHECK_RELATIVE(imk_rate_gyro_natural_frequency(&d), 188.5618083164, 1e-12);
    CHECK_RELATIVE(imk_rate_gyro_damping_ratio(&d), 0.7000357133746, 1e-12);
    /* .1 kg, 1 nm, H = .1: 2.02e-3 deg/h/g; 1 nm/N at 45 deg: 9.9e-4 deg/h/g^2; printed digits */
    CHECK_CLOSE(imk_unbalance_drift(0.1, 1e-9, 0.1) * 9.80665 / deg_per_hour, 2.02e-3, 5e-6);
    CHECK_CLOSE(imk_anisoelastic_drift(0.1, 1e-9, 0.1) * 0.5 * 9.80665 * 9.80665 / deg_per_hour,
                9.9e-4, 5e-6);
    /* sqrt(2 * 1.380649e-23 * 293.15 * 1) */
    CHECK_RELATIVE(imk_thermal_torque(1.0), 8.99708e-11, 1e-6);
}

/* From rest under a small rate: th = s w (1 - e^{-z w0 t} (cos wd t + z/sqrt(1-z^2) sin wd t)). The
 * nonlinear part is s w of it, 1e-8; the signal is the angle itself. */
static void test_transient_is_exact(void **state)
{
    (void)state;
    imk_rate_gyro d = imk_rate_gyro_default();
    d.torque = (imk_error_torque){0};
    d.damping = 2e-4;
    const double w0 = imk_rate_gyro_natural_frequency(&d), z = imk_rate_gyro_damping_ratio(&d);
    const double wd = w0 * sqrt(1.0 - z * z), rate = 1e-6;
    const imk_physics_settings settings = quiet(1000.0, IMK_LEVEL_FULL);
    const imk_exposure exposure = turning(rate, 0, 0);
    double signals[IMK_INSTRUMENT_SIGNALS_MAX], out;
    void *s = started(gyro, &d, &settings);
    for (int i = 1; i <= 100; i++) {
        const double t = i / settings.rate;
        gyro->step(s, &exposure, &out);
        gyro->observe(s, signals);
        const double expected =
            0.0125 * rate *
            (1.0 - exp(-z * w0 * t) * (cos(wd * t) + z / sqrt(1.0 - z * z) * sin(wd * t)));
        CHECK_CLOSE(signals[0], expected, 1e-11 * 0.0125 * rate);
    }
    free(s);
}

/* ---- invariants ------------------------------------------------------------------------------ */

/* Without a damper the energy I th'^2/2 + k th^2/2 - H r - (Iz - Ix) r^2/2 stays, r the rate about
 * the wheel's axis (its derivative by th is p). The scheme is symmetric in time: the energy ripples
 * with the step, by 1e-5, and does not drift. */
static double mean_energy(void *s, const imk_rate_gyro *d, const imk_exposure *e, size_t steps)
{
    double sum = 0.0, x[IMK_INSTRUMENT_SIGNALS_MAX], out;
    for (size_t i = 0; i < steps; i++) {
        gyro->step(s, e, &out);
        gyro->observe(s, x);
        const double r = e->angular_rate[0] * sin(x[0]) + e->angular_rate[2] * cos(x[0]);
        const double still = e->angular_rate[2];
        sum += 0.5 * d->output_inertia * x[1] * x[1] + 0.5 * d->stiffness * x[0] * x[0] -
               d->momentum * (r - still) -
               0.5 * (d->spin_inertia - d->input_inertia) * (r * r - still * still);
    }
    return sum / (double)steps;
}

static void test_no_numerical_damping(void **state)
{
    (void)state;
    imk_rate_gyro d = imk_rate_gyro_default();
    d.damping = 0.0;
    d.torque = (imk_error_torque){0};
    d.balance = (imk_balance){.mass = 0.01};
    const size_t cycles = 5000, part = 64 * 50;
    const double cycle = 2.0 * pi / imk_rate_gyro_natural_frequency(&d);
    const imk_physics_settings settings = quiet(64.0 / cycle, IMK_LEVEL_FULL);
    const imk_exposure exposure = turning(1.5, 0.0, 2.0);
    void *s = started(gyro, &d, &settings);
    run(gyro, s, &exposure, 1, 0, NULL);
    /* swings between 0 and 2 s w: amplitude s w, energy k (s w)^2/2 */
    const double swing = 0.5 * d.stiffness * 0.0125 * 0.0125 * 1.5 * 1.5;
    const double first = mean_energy(s, &d, &exposure, part);
    run(gyro, s, &exposure, 64 * cycles, 0, NULL);
    const double last = mean_energy(s, &d, &exposure, part);
    /* 1e-9 of the amplitude a cycle is 2e-9 of the energy; the means over 50 cycles see the ripple
     * (1e-5) at different phases, 1e-5/50 */
    CHECK_CLOSE(last, first, swing * (2e-9 * (double)cycles));
    free(s);
}

/* k <th^2> = k_B T, from 6e5 angles 12.5 ms apart (their squares are correlated by 4 %): a standard
 * deviation of sqrt(2/6e5 * 1.1) = 0.19 %, so that 1 % is 5.2 sigma. */
static void test_equipartition(void **state)
{
    (void)state;
    imk_rate_gyro d = imk_rate_gyro_default();
    d.torque = (imk_error_torque){0};
    imk_physics_settings settings = imk_physics_default();
    settings.rate = 80.0;
    settings.step = 1.0 / 320.0;
    const imk_exposure exposure = imk_exposure_default();
    const size_t count = 600000;
    double sum = 0.0, out, signals[IMK_INSTRUMENT_SIGNALS_MAX];
    void *s = started(gyro, &d, &settings);
    run(gyro, s, &exposure, 20, 0, NULL);
    for (size_t i = 0; i < count; i++) {
        gyro->step(s, &exposure, &out);
        gyro->observe(s, signals);
        sum += signals[0] * signals[0];
    }
    CHECK_RELATIVE(d.stiffness * sum / (double)count, 1.380649e-23 * 293.15, 0.01);
    free(s);
}

/* ---- level against level against error model ------------------------------------------------- */

static imk_rate_gyro imperfect(void)
{
    imk_rate_gyro d = imk_rate_gyro_default();
    d.momentum_error = 3e-3;
    d.stiffness_error = -2e-3;
    return d;
}

/* Reading minus reading at rest of the opposite rates: odd part scale and k3, even part k2. What is
 * left is of the order (s w)^4, s w = 0.025 at 2 rad/s, or th0 (s w)^3. */
static void test_scale_and_nonlinearity(void **state)
{
    (void)state;
    imk_rate_gyro d = imperfect();
    d.torque.fixed = 1e-5;
    imk_model *model = malloc(sizeof *model);
    imk_rate_gyro_reduce(&d, model);
    const imk_triad *t = &model->gyro;
    const double gain = 1.003 / 0.998, w = 2.0;
    CHECK_CLOSE(t->scale_factor.fixed.value[0], gain - 1.0, 1e-15);
    for (int level = IMK_LEVEL_FULL; level <= IMK_LEVEL_SLOW; level++) {
        const imk_exposure none = turning(0, 0, 0), plus = turning(w, 0, 0),
                           minus = turning(-w, 0, 0);
        const double y0 = reading(&d, level, &none), y1 = reading(&d, level, &plus),
                     y2 = reading(&d, level, &minus);
        CHECK_RELATIVE(y0, t->bias.fixed.value[0], 1e-12);
        CHECK_CLOSE(0.5 * (y1 - y2), gain * w + t->nonlinearity.k3.value[0] * w * w * w, w * 2e-7);
        CHECK_RELATIVE(0.5 * (y1 + y2) - y0, t->nonlinearity.k2.value[0] * w * w, 2e-3);
    }
    free(model);
}

static void test_both_levels_agree(void **state)
{
    (void)state;
    const imk_rate_gyro d = imperfect();
    imk_exposure e = turning(2.5, 1.0, -3.0);
    e.specific_force[0] = 20.0;
    e.specific_force[2] = -30.0;
    e.angular_acceleration[1] = 5.0;
    e.temperature = 320.0;
    CHECK_RELATIVE(reading(&d, IMK_LEVEL_FULL, &e), reading(&d, IMK_LEVEL_SLOW, &e), 1e-12);
}

/* -th w_z, (Iz - Ix)/H w_x w_z, -(I/H) a_y: small signals, so that the next order is 1e-4. */
static void test_cross_terms(void **state)
{
    (void)state;
    imk_rate_gyro d = imk_rate_gyro_default();
    d.torque = (imk_error_torque){0};
    const double w = 0.01, z = 0.5;
    imk_exposure e = turning(w, 0.0, z);
    CHECK_RELATIVE(reading(&d, IMK_LEVEL_FULL, &e) - w, w * z * (3e-7 / 1e-3 - 0.0125), 0.01);
    e = turning(0, 0, 0);
    e.angular_acceleration[1] = 2.0;
    CHECK_RELATIVE(reading(&d, IMK_LEVEL_FULL, &e), -2.25e-3 * 2.0, 1e-4);
}

static void test_force_and_temperature(void **state)
{
    (void)state;
    const imk_rate_gyro d = imperfect();
    imk_model *model = malloc(sizeof *model);
    imk_rate_gyro_reduce(&d, model);
    const imk_triad *t = &model->gyro;
    imk_exposure e = imk_exposure_default();
    const double bias = reading(&d, IMK_LEVEL_FULL, &e);
    /* the mass torques at the angle of the gimbal, 1e-4 rad: second order */
    e.specific_force[0] = 9.8;
    const double by_x = reading(&d, IMK_LEVEL_FULL, &e) - bias;
    CHECK_RELATIVE(by_x, 9.8 * t->g_sensitivity.value[0][0], 1e-3);
    assert_true(by_x < 0.0);
    e.specific_force[0] = 0.0;
    e.specific_force[2] = 9.8;
    const double by_z = reading(&d, IMK_LEVEL_FULL, &e) - bias;
    CHECK_RELATIVE(by_z, 9.8 * t->g_sensitivity.value[0][2], 1e-3);
    e.specific_force[0] = 9.8;
    CHECK_RELATIVE(reading(&d, IMK_LEVEL_FULL, &e) - bias - by_x - by_z,
                   9.8 * 9.8 * t->g2_sensitivity.value[0][5], 1e-2);
    e = imk_exposure_default();
    e.temperature += 20.0;
    const double warm = reading(&d, IMK_LEVEL_FULL, &e);
    /* stiffer by 4e-3, so that the bias changes by as much more */
    CHECK_RELATIVE(warm - bias, 20.0 * t->bias.temperature.coefficient[0].value[0], 0.02);
    e.angular_rate[0] = 0.1;
    /* 1/(1 + 4e-3) against 1 - 4e-3 */
    CHECK_RELATIVE(reading(&d, IMK_LEVEL_FULL, &e) - warm,
                   0.1 * (1.0 + t->scale_factor.fixed.value[0] +
                          20.0 * t->scale_factor.temperature.coefficient[0].value[0]),
                   2e-5);
    free(model);
}

/* The stated -3 dB frequency: 1/sqrt(2) of the amplitude. A sample of 1/50 cycle averages input
 * and output alike; a held input, straight in reality, costs (2 pi/50)^2/12 = 1.3e-3 at most. */
static void test_bandwidth(void **state)
{
    (void)state;
    const imk_rate_gyro d = imk_rate_gyro_default();
    const double f = imk_rate_gyro_bandwidth(&d);
    const imk_physics_settings settings = quiet(50.0 * f, IMK_LEVEL_FULL);
    CHECK_RELATIVE(sine_gain(gyro, &d, &settings, 1e-3, f, 1000, 4, NULL), sqrt(0.5), 2e-3);
}

/* ---- friction and stops ---------------------------------------------------------------------- */

static void test_friction(void **state)
{
    (void)state;
    imk_rate_gyro d = imk_rate_gyro_default();
    imk_model *model = malloc(sizeof *model);
    d.torque = (imk_error_torque){0};
    d.friction = 1e-6; /* 1e-3 rad/s */
    imk_rate_gyro_reduce(&d, model);
    CHECK_RELATIVE(model->gyro.dead_band.value[0], 1e-3, 1e-12);
    for (int level = IMK_LEVEL_FULL; level <= IMK_LEVEL_SLOW; level++) {
        imk_exposure e = turning(0.99e-3, 0, 0);
        assert_true(reading(&d, level, &e) == 0.0);
        /* beyond, the gimbal stops where it first stands and the torque on it is within friction;
         * k3 of 0.05 rad/s is 1e-8 */
        e = turning(0.05, 0, 0);
        CHECK_CLOSE(reading(&d, level, &e), 0.05, 1e-3 + 2e-8);
    }
    /* Just beyond, the overdamped gimbal creeps to where friction balances: w - friction/H. */
    d.damping = 2e-3;
    const imk_exposure e = turning(2e-3, 0, 0);
    CHECK_CLOSE(reading(&d, IMK_LEVEL_FULL, &e), 1e-3, 2e-6);
    free(model);
}

static void test_stops(void **state)
{
    (void)state;
    const imk_rate_gyro d = imk_rate_gyro_default();
    const imk_exposure e = turning(-20.0, 0, 0);
    for (int level = IMK_LEVEL_FULL; level <= IMK_LEVEL_SLOW; level++)
        CHECK_RELATIVE(reading(&d, level, &e), -80.0 * d.stop, 1e-12);
}

/* ---- noise ----------------------------------------------------------------------------------- */

/* At 5 Hz, far below the bandwidth: what the gimbal's 30 Hz take from the white noise of a sample
 * is then less than the interval. (At 100 Hz the noise of the pickoff, which the gimbal does not
 * filter, is seen beside the noise of the torque, and no low-pass filter stands for both.) */
static void test_chain(void **state)
{
    (void)state;
    imk_rate_gyro d = imk_rate_gyro_default();
    d.torque.instability /= 8.0; /* so that 5 Hz still show the white noise */
    imk_physics_settings settings = imk_physics_default();
    settings.rate = 5.0;
    settings.step = 1.0 / 320.0;
    settings.seed = 6;
    const imk_exposure exposure = imk_exposure_default();
    check_chain(gyro, &d, &settings, &exposure, 40, 20000);
}

/* ---- the interface --------------------------------------------------------------------------- */

static void test_copies_and_grade(void **state)
{
    (void)state;
    imk_rate_gyro d = imk_rate_gyro_default();
    d.pickoff_resolution = 1e-6;
    imk_physics_settings settings = imk_physics_default();
    const imk_exposure e = turning(0.1, 0.2, 0.3);
    void *a = started(gyro, &d, &settings), *b = started(gyro, &d, &settings);
    double x[50], y[50];
    run(gyro, a, &e, 777, 0, NULL);
    memcpy(b, a, gyro->state_size);
    run(gyro, a, &e, 50, 0, x);
    run(gyro, b, &e, 50, 0, y);
    assert_memory_equal(x, y, sizeof x);
    free(a);
    free(b);
    imk_model *model = malloc(sizeof *model);
    imk_error error;
    imk_instrument_reduce(gyro, &d, model);
    CHECK_OK(imk_model_validate(model, &error));
    imk_model_three_axes(model);
    assert_int_equal(imk_grade_model(model).gyro, IMK_GRADE_CONTROL);
    free(model);
}

static void refused(imk_rate_gyro d, imk_status status, const char *field)
{
    imk_error error = {0};
    CHECK_STATUS(imk_rate_gyro_validate(&d, &error), status);
    assert_string_equal(error.field, field);
}

static void test_refusals(void **state)
{
    (void)state;
    const imk_rate_gyro good = imk_rate_gyro_default();
    imk_rate_gyro d = {0};
    refused(d, IMK_ERROR_UNINITIALISED, "design");
    d = good;
    d.output_inertia = -1e-6;
    refused(d, IMK_ERROR_RANGE, "gimbal.output_inertia");
    d = good;
    d.stiffness = NAN;
    refused(d, IMK_ERROR_NOT_FINITE, "spring.stiffness");
    d = good;
    d.output_inertia = 1e-5;
    refused(d, IMK_ERROR_CONFLICT, "gimbal.output_inertia");
    d = good;
    d.spin_inertia = 4.4e-6;
    d.momentum = 3e-6;
    refused(d, IMK_ERROR_CONFLICT, "spring.stiffness");
    imk_physics_settings settings = quiet(10.0, IMK_LEVEL_FULL);
    imk_error error = {0};
    void *s = started(gyro, &good, &settings);
    settings.step = 0.005; /* a cycle of 33 ms has 8 of 4.2 ms */
    CHECK_STATUS(imk_instrument_init(gyro, &good, &settings, s, &error), IMK_ERROR_RANGE);
    assert_string_equal(error.field, "step");
    free(s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_closed_forms),
        cmocka_unit_test(test_transient_is_exact),
        cmocka_unit_test(test_no_numerical_damping),
        cmocka_unit_test(test_equipartition),
        cmocka_unit_test(test_scale_and_nonlinearity),
        cmocka_unit_test(test_both_levels_agree),
        cmocka_unit_test(test_cross_terms),
        cmocka_unit_test(test_force_and_temperature),
        cmocka_unit_test(test_bandwidth),
        cmocka_unit_test(test_friction),
        cmocka_unit_test(test_stops),
        cmocka_unit_test(test_chain),
        cmocka_unit_test(test_copies_and_grade),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
