/* SPDX-License-Identifier: Apache-2.0 */
/* What a MEMS accelerometer reads, open and in both loops: the full dynamics against the slow
 * response and against the error model that `reduce` computes. */
#define _POSIX_C_SOURCE 200809L /* setenv */
#include "instrument_run.h"

#include "imukit/mems_accelerometer.h"
#include "imukit/units.h"

#define INSTRUMENT (&imk_mems_accelerometer_instrument)
#define GRAVITY IMK_STANDARD_GRAVITY

static imk_model *reduced(const imk_mems_accelerometer *d)
{
    imk_model *model = malloc(sizeof *model);
    assert_non_null(model);
    CHECK_OK(imk_mems_accelerometer_validate(d, NULL));
    imk_mems_accelerometer_reduce(d, model);
    CHECK_OK(imk_model_validate(model, NULL));
    return model;
}

static imk_physics_settings quiet(imk_level level)
{
    imk_physics_settings settings = imk_physics_default();
    settings.noise = false;
    settings.level = level;
    return settings;
}

static double reading(const imk_mems_accelerometer *d, imk_level level, double force,
                      double temperature)
{
    const imk_physics_settings settings = quiet(level);
    imk_exposure exposure = imk_exposure_default();
    exposure.specific_force[0] = force;
    exposure.temperature = temperature;
    return mean_of(INSTRUMENT, d, &settings, &exposure, 10, 2, 0);
}

static imk_mems_accelerometer bent_design(void)
{
    imk_mems_accelerometer d = imk_mems_accelerometer_default();
    d.spring_quadratic = 1e3;
    d.spring_cubic = 1e10;
    d.offset = 50e-9;
    d.pickoff = IMK_MEMS_DIFFERENCE;
    d.bias = 0.02;
    d.voltage_temperature = 200e-6;
    return d;
}

/* K2, K3 and scale factor of the full level from its readings at +-u and +-2u: with e the error of
 * a reading and its even and odd parts, K2 = e_even/u^2 (the fourth order cancelled), and so on.
 * The fifth order and the splitting leave some 1e-4 of full scale at most. */
static void check_nonlinearity(const imk_mems_accelerometer *d)
{
    imk_model *model = reduced(d);
    const imk_triad *t = &model->accel;
    const double u = 0.5 * GRAVITY, zero = reading(d, IMK_LEVEL_FULL, 0.0, 293.15);
    double even[2], odd[2];
    const double b0 = t->bias.fixed.value[0];
    CHECK_CLOSE(zero, b0, 1e-7);
    for (int i = 0; i < 2; i++) {
        const double a = u * (1 + i);
        const double up = reading(d, IMK_LEVEL_FULL, a, 293.15);
        const double down = reading(d, IMK_LEVEL_FULL, -a, 293.15);
        even[i] = (0.5 * (up + down) - zero) / (a * a);
        odd[i] = (0.5 * (up - down) - a) / a;
    }
    const double scale = t->scale_factor.fixed.value[0], k2 = t->nonlinearity.k2.value[0];
    const double k3 = t->nonlinearity.k3.value[0];
    const double found_k2 = (4.0 * even[0] - even[1]) / 3.0;
    const double found_k3 = (odd[1] - odd[0]) / (3.0 * u * u);
    const double found_scale = (4.0 * odd[0] - odd[1]) / 3.0;
    CHECK_CLOSE(found_k2, k2, 0.01 * fabs(k2) + 1e-9);
    CHECK_CLOSE(found_k3, k3, 0.05 * fabs(k3) + 1e-10);
    CHECK_CLOSE(found_scale, scale, 1e-6);
    /* the slow level has these terms, and no others */
    for (int i = -1; i <= 1; i++) {
        const double a = i * 2.0 * GRAVITY;
        const double stated = b0 + a * (1.0 + scale + a * (k2 + a * k3));
        CHECK_CLOSE(reading(d, IMK_LEVEL_SLOW, a, 293.15), stated, 1e-9);
    }
    free(model);
}

static void readings_bend_as_reduced(void **state)
{
    (void)state;
    imk_mems_accelerometer d = bent_design();
    check_nonlinearity(&d);
    d.plates = IMK_MEMS_SINGLE;
    check_nonlinearity(&d);
    d.pickoff = IMK_MEMS_RATIO;
    check_nonlinearity(&d);
    d = imk_mems_accelerometer_analog();
    d.pickoff_offset = 40e-9;
    check_nonlinearity(&d);
    d = imk_mems_accelerometer_default();
    check_nonlinearity(&d);
}

/* Scale factor and bias 20 K warmer, against the polynomials; 1 % for their second order. */
static void check_temperature(const imk_mems_accelerometer *d, double tolerance)
{
    imk_model *model = reduced(d);
    const double warmer = 20.0, a = GRAVITY,
                 scale = model->accel.scale_factor.temperature.coefficient[0].value[0],
                 bias = model->accel.bias.temperature.coefficient[0].value[0];
    for (int level = 0; level < 2; level++) {
        double r[4];
        for (int i = 0; i < 4; i++)
            r[i] = reading(d, (imk_level)level, i % 2 ? -a : a, 293.15 + (i < 2 ? 0.0 : warmer));
        CHECK_CLOSE((r[2] + r[3] - r[0] - r[1]) / 2.0 / warmer, bias,
                    1e-2 * fabs(bias) + tolerance);
        CHECK_CLOSE((r[2] - r[3] - r[0] + r[1]) / (2.0 * a) / warmer, scale,
                    1e-2 * fabs(scale) + tolerance);
    }
    free(model);
}

static void readings_drift_with_temperature_as_reduced(void **state)
{
    (void)state;
    imk_mems_accelerometer d = bent_design();
    d.bias = d.spring_quadratic = d.spring_cubic = 0.0;
    d.pickoff = IMK_MEMS_RATIO;
    d.offset = 20e-9;
    check_temperature(&d, 2e-6);
    d = imk_mems_accelerometer_analog();
    d.voltage_temperature = 150e-6;
    check_temperature(&d, 2e-6);
    d = imk_mems_accelerometer_sigma_delta();
    d.voltage_temperature = 150e-6;
    check_temperature(&d, 2e-5); /* the bits of a tenth of a second resolve 1e-4 m/s^2 */
}

static void tilt_shows_the_other_axes(void **state)
{
    (void)state;
    imk_mems_accelerometer d = imk_mems_accelerometer_default();
    d.tilt_y = 5e-3;
    d.tilt_z = -3e-3;
    const imk_physics_settings settings = quiet(IMK_LEVEL_FULL);
    imk_model *model = reduced(&d);
    for (int k = 1; k < 3; k++) {
        imk_exposure exposure = imk_exposure_default();
        exposure.specific_force[k] = GRAVITY;
        const double r = mean_of(INSTRUMENT, &d, &settings, &exposure, 10, 2, 0);
        CHECK_CLOSE(r / GRAVITY, model->accel.cross_axis.value[0][k], 1e-7);
    }
    free(model);
}

/* ---- frequency response ---------------------------------------------------------------------- */

/* Gain at half the reduced bandwidth, at it and at twice it, against the second-order filter of the
 * model. sine_gain holds the input over a sample; at 16 and more samples to a cycle the images of
 * that are below 1e-3. */
static void check_bandwidth(const imk_mems_accelerometer *d, double tolerance)
{
    imk_model *model = reduced(d);
    const double f = model->accel.bandwidth.value[0], zeta = model->accel.damping.value[0];
    const double b = 1.0 - 2.0 * zeta * zeta, ratio = sqrt(b + sqrt(b * b + 1.0));
    for (int level = 0; level < 2; level++)
        for (int i = -1; i <= 1; i++) {
            imk_physics_settings settings = quiet((imk_level)level);
            const double at = f * (i < 0 ? 0.5 : i > 0 ? 2.0 : 1.0);
            settings.rate = 40.0 * at;
            const double gain =
                sine_gain(INSTRUMENT, d, &settings, 0.5 * GRAVITY, at, 400, 20, NULL);
            const double r = at / f * ratio;
            const double expected =
                1.0 / sqrt((1.0 - r * r) * (1.0 - r * r) + 4.0 * zeta * zeta * r * r);
            CHECK_CLOSE(gain, expected, i > 0 ? 3.0 * tolerance : tolerance);
        }
    free(model);
}

static void bandwidth_is_as_reduced(void **state)
{
    (void)state;
    imk_mems_accelerometer d = imk_mems_accelerometer_default();
    check_bandwidth(&d, 3e-3);
    d.output_bandwidth = 0.0;
    d.voltage = 3.0; /* of the softened mass */
    check_bandwidth(&d, 3e-3);
    d = imk_mems_accelerometer_analog();
    d.output_bandwidth = 0.0;
    d.reset = 0.0;
    check_bandwidth(&d, 0.25); /* finite gain, and a fifth-order loop: only roughly */
}

static void full_and_slow_loops_respond_alike(void **state)
{
    (void)state;
    imk_mems_accelerometer d = imk_mems_accelerometer_analog();
    d.output_bandwidth = 0.0;
    for (double f = 50.0; f < 5000.0; f *= 4.0) {
        double phase[2], gain[2];
        for (int level = 0; level < 2; level++) {
            imk_physics_settings settings = quiet((imk_level)level);
            settings.rate = 40.0 * f;
            gain[level] =
                sine_gain(INSTRUMENT, &d, &settings, 0.1 * GRAVITY, f, 800, 10, &phase[level]);
        }
        /* the loop's plates are nearly linear at a tenth of a g */
        CHECK_RELATIVE(gain[0], gain[1], 1e-3);
        CHECK_CLOSE(phase[0], phase[1], 1e-3);
    }
}

/* ---- vibration, overload --------------------------------------------------------------------- */

/* Bias under a vibration of 2 g peak at 100 Hz: K2 |H|^2 a^2/2. */
static void vibration_is_rectified(void **state)
{
    (void)state;
    imk_mems_accelerometer d = bent_design();
    d.bias = 0.0;
    d.output_bandwidth = 0.0;
    for (double f = 100.0; f < 2000.0; f *= 10.0) {
        imk_physics_settings settings = quiet(IMK_LEVEL_FULL);
        settings.rate = 50.0 * f;
        void *run_state = started(INSTRUMENT, &d, &settings);
        double sum = 0.0, outputs[IMK_INSTRUMENT_OUTPUTS_MAX], square = 0.0;
        for (int i = 0; i < 1500; i++) {
            imk_exposure exposure = imk_exposure_default();
            exposure.specific_force[0] = 2.0 * GRAVITY * sin(6.283185307179586 * i / 50.0);
            INSTRUMENT->step(run_state, &exposure, outputs);
            sum += i < 500 ? 0.0 : outputs[0] / 1000.0;
            square +=
                i < 500 ? 0.0 : exposure.specific_force[0] * exposure.specific_force[0] / 1000.0;
        }
        free(run_state);
        /* the fourth order of the nonlinearity adds a few per cent of 2 g squared */
        CHECK_RELATIVE(sum, imk_mems_accelerometer_rectification(&d, f) * square, 0.03);
    }
}

/* A shock of 20 g: clipped while it lasts, on the stops in the open loop, and gone 30 ms later. */
static void overload_clips_and_is_forgotten(void **state)
{
    (void)state;
    const imk_mems_accelerometer designs[3] = {imk_mems_accelerometer_default(),
                                               imk_mems_accelerometer_analog(),
                                               imk_mems_accelerometer_sigma_delta()};
    for (int i = 0; i < 3; i++) {
        imk_physics_settings settings = quiet(IMK_LEVEL_FULL);
        settings.rate = 1000.0;
        imk_exposure shock = imk_exposure_default();
        const imk_exposure rest = imk_exposure_default();
        double signals[IMK_INSTRUMENT_SIGNALS_MAX], samples[60];
        shock.specific_force[0] = 20.0 * GRAVITY;
        void *run_state = started(INSTRUMENT, &designs[i], &settings);
        run(INSTRUMENT, run_state, &shock, 20, 0, samples);
        CHECK_RELATIVE(samples[19], 5.0 * GRAVITY, 1e-12);
        INSTRUMENT->observe(run_state, signals);
        CHECK_RELATIVE(signals[0], -designs[i].stop * designs[i].gap, 1e-9);
        run(INSTRUMENT, run_state, &rest, 60, 0, samples);
        CHECK_CLOSE(samples[59], 0.0, i == 2 ? 0.02 : 1e-3);
        free(run_state);
    }
}

/* ---- sigma-delta ----------------------------------------------------------------------------- */

static imk_mems_accelerometer second_order(void)
{
    imk_mems_accelerometer d = imk_mems_accelerometer_sigma_delta();
    d.integral = 0.0;
    d.offset = 0.0;
    d.output_bandwidth = 0.0;
    return d;
}

/* The bits go by twos, and an input within the dead zone changes none of them. */
static void limit_cycle_hides_small_inputs(void **state)
{
    (void)state;
    const imk_mems_accelerometer d = second_order();
    const imk_mems_limit_cycle cycle = imk_mems_accelerometer_limit_cycle(&d);
    assert_int_equal(cycle.half_period, 2);
    for (int sign = -1; sign <= 1; sign += 2) {
        CHECK_CLOSE(reading(&d, IMK_LEVEL_FULL, 0.98 * sign * cycle.dead_zone, 293.15), 0.0, 1e-9);
        assert_true(sign * reading(&d, IMK_LEVEL_FULL, 1.1 * sign * cycle.dead_zone, 293.15) >
                    0.2 * cycle.dead_zone);
    }
    imk_physics_settings settings = quiet(IMK_LEVEL_FULL);
    settings.rate = d.clock;
    const imk_exposure rest = imk_exposure_default();
    double signals[IMK_INSTRUMENT_SIGNALS_MAX], largest = 0.0;
    int changes = 0, last = 0;
    void *run_state = started(INSTRUMENT, &d, &settings);
    run(INSTRUMENT, run_state, &rest, 1000, 0, NULL);
    for (int i = 0; i < 400; i++) {
        run(INSTRUMENT, run_state, &rest, 1, 0, NULL);
        INSTRUMENT->observe(run_state, signals);
        changes += i > 0 && last != (int)signals[5];
        last = (int)signals[5];
        largest = fabs(signals[0]) > largest ? fabs(signals[0]) : largest;
    }
    assert_in_range(changes, 199, 200); /* pairs in 400 clocks, cut anywhere */
    CHECK_RELATIVE(largest, cycle.amplitude, 1e-4);
    free(run_state);
    imk_model *model = reduced(&d);
    CHECK_RELATIVE(model->accel.dead_band.value[0], cycle.dead_zone, 1e-12);
    free(model);
}

/* Noise breaks the cycle: the quantizer becomes a gain with noise. Deviation of the compensated
 * position and of the velocity within 15 %, the loss of scale within a fifth of itself: the theory
 * takes for normal what is not quite. */
static void noise_breaks_the_limit_cycle(void **state)
{
    (void)state;
    imk_mems_accelerometer d = second_order();
    d.pickoff_noise = 40e-12;
    const imk_mems_quantizer theory = imk_mems_accelerometer_quantizer(&d);
    imk_model *model = reduced(&d);
    CHECK_CLOSE(model->accel.dead_band.value[0], 0.0, 0.0);
    imk_physics_settings settings = imk_physics_default();
    settings.rate = d.clock;
    d.bias_repeatability = d.bias_instability = d.gain_repeatability = 0.0;
    imk_exposure exposure = imk_exposure_default();
    double signals[IMK_INSTRUMENT_SIGNALS_MAX], y2 = 0.0, v2 = 0.0;
    void *run_state = started(INSTRUMENT, &d, &settings);
    for (int i = 0; i < 50000; i++) {
        run(INSTRUMENT, run_state, &exposure, 1, 0, NULL);
        INSTRUMENT->observe(run_state, signals);
        y2 += signals[6] * signals[6] / 50000;
        v2 += signals[1] * signals[1] / 50000;
    }
    CHECK_RELATIVE(sqrt(y2), theory.deviation, 0.15);
    CHECK_RELATIVE(sqrt(v2), theory.velocity, 0.15);
    free(run_state);
    settings.rate = 10.0;
    exposure.specific_force[0] = GRAVITY;
    const double read = mean_of(INSTRUMENT, &d, &settings, &exposure, 1, 20, 0);
    const double scale = model->accel.scale_factor.fixed.value[0];
    CHECK_RELATIVE(read / GRAVITY - 1.0, scale, 0.25);
    free(model);
}

/* With an integral term the reading is the input; its noise without output filter is that of the
 * mass's velocity at the ends of a sample, sqrt(2) Q/dt. */
static void integral_term_removes_the_dead_zone(void **state)
{
    (void)state;
    imk_mems_accelerometer d = imk_mems_accelerometer_sigma_delta();
    for (double a = -4.0; a <= 4.5; a += 1.6)
        CHECK_CLOSE(reading(&d, IMK_LEVEL_FULL, a * GRAVITY, 293.15), a * GRAVITY, 5e-3);
    d.output_bandwidth = 0.0;
    imk_model *model = reduced(&d);
    imk_physics_settings settings = imk_physics_default();
    settings.rate = 1000.0;
    enum { COUNT = 10000 };
    static double samples[COUNT];
    const imk_exposure rest = imk_exposure_default();
    void *run_state = started(INSTRUMENT, &d, &settings);
    run(INSTRUMENT, run_state, &rest, 50, 0, NULL);
    run(INSTRUMENT, run_state, &rest, COUNT, 0, samples);
    double mean = 0.0, variance = 0.0;
    for (int i = 0; i < COUNT; i++)
        mean += samples[i] / COUNT;
    for (int i = 0; i < COUNT; i++)
        variance += (samples[i] - mean) * (samples[i] - mean) / COUNT;
    CHECK_RELATIVE(sqrt(variance / 2.0) / settings.rate, model->accel.noise.reading_noise.value[0],
                   0.15);
    free(run_state);
    free(model);
}

/* ---- the chain ------------------------------------------------------------------------------- */

static void identified_noise_is_as_reduced(void **state)
{
    (void)state;
    const imk_exposure rest = imk_exposure_default();
    imk_physics_settings settings = imk_physics_default();
    imk_mems_accelerometer d = imk_mems_accelerometer_default();
    /* at 100 Hz a filter of 200 Hz is neither seen nor negligible; nor is flicker in a minute */
    d.output_bandwidth = d.bias_instability = 0.0;
    check_chain(INSTRUMENT, &d, &settings, &rest, 100, 8000);
    d = imk_mems_accelerometer_analog();
    d.output_bandwidth = d.bias_instability = 0.0;
    check_chain(INSTRUMENT, &d, &settings, &rest, 100, 4000);
    settings.level = IMK_LEVEL_SLOW;
    settings.rate = 5.0;
    d = imk_mems_accelerometer_default();
    d.bias_instability *= 2.0; /* so that an hour and a half shows it */
    check_chain(INSTRUMENT, &d, &settings, &rest, 100, 30000);
    d = imk_mems_accelerometer_sigma_delta();
    d.bias_instability *= 2.0;
    check_chain(INSTRUMENT, &d, &settings, &rest, 100, 30000);
}

static void default_design_has_its_grade(void **state)
{
    (void)state;
    const imk_mems_accelerometer d = imk_mems_accelerometer_default();
    imk_model *model = reduced(&d);
    imk_model_three_axes(model);
    CHECK_OK(imk_model_validate(model, NULL));
    const imk_grade_result grade = imk_grade_model(model);
    assert_int_equal(grade.accel, IMK_GRADE_TACTICAL);
    assert_non_null(strstr(imk_grade_table(grade.accel)->accel_technology, INSTRUMENT->technology));
    /* 17 ug/sqrt(Hz), one-sided [MS1000]; the last figure */
    CHECK_CLOSE(model->accel.noise.white.value[0] * sqrt(2.0) / GRAVITY * 1e6, 17.0, 0.5);
    free(model);
}

/* Copies of a state go on alike, and the bits do not depend on the instruction set. */
static void bits_are_reproduced(void **state)
{
    (void)state;
    enum { COUNT = 40 };
    const imk_mems_accelerometer designs[3] = {imk_mems_accelerometer_default(),
                                               imk_mems_accelerometer_analog(),
                                               imk_mems_accelerometer_sigma_delta()};
    char before[32] = "";
    if (getenv("IMUKIT_ISA"))
        strncpy(before, getenv("IMUKIT_ISA"), sizeof before - 1);
    for (int i = 0; i < 6; i++) {
        imk_physics_settings settings = imk_physics_default();
        settings.level = (imk_level)(i / 3);
        imk_mems_accelerometer d = designs[i % 3];
        d.squeeze_film = true;
        d.pickoff = IMK_MEMS_DIFFERENCE;
        imk_exposure exposure = imk_exposure_default();
        exposure.specific_force[0] = 3.0;
        double one[COUNT], two[COUNT], three[COUNT];
        void *run_state = started(INSTRUMENT, &d, &settings);
        run(INSTRUMENT, run_state, &exposure, 7, 0, NULL);
        void *copy = aligned_alloc(64, (INSTRUMENT->state_size + 63) / 64 * 64);
        assert_non_null(copy);
        memcpy(copy, run_state, INSTRUMENT->state_size);
        run(INSTRUMENT, run_state, &exposure, COUNT, 0, one);
        run(INSTRUMENT, copy, &exposure, COUNT, 0, two);
        assert_int_equal(setenv("IMUKIT_ISA", "scalar", 1), 0);
        void *scalar = started(INSTRUMENT, &d, &settings);
        assert_int_equal(before[0] ? setenv("IMUKIT_ISA", before, 1) : unsetenv("IMUKIT_ISA"), 0);
        run(INSTRUMENT, scalar, &exposure, 7, 0, NULL);
        run(INSTRUMENT, scalar, &exposure, COUNT, 0, three);
        assert_memory_equal(one, two, sizeof one);
        assert_memory_equal(one, three, sizeof one);
        free(run_state);
        free(copy);
        free(scalar);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(readings_bend_as_reduced),
        cmocka_unit_test(readings_drift_with_temperature_as_reduced),
        cmocka_unit_test(tilt_shows_the_other_axes),
        cmocka_unit_test(bandwidth_is_as_reduced),
        cmocka_unit_test(full_and_slow_loops_respond_alike),
        cmocka_unit_test(vibration_is_rectified),
        cmocka_unit_test(overload_clips_and_is_forgotten),
        cmocka_unit_test(limit_cycle_hides_small_inputs),
        cmocka_unit_test(noise_breaks_the_limit_cycle),
        cmocka_unit_test(integral_term_removes_the_dead_zone),
        cmocka_unit_test(identified_noise_is_as_reduced),
        cmocka_unit_test(default_design_has_its_grade),
        cmocka_unit_test(bits_are_reproduced),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
