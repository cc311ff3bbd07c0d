/* SPDX-License-Identifier: Apache-2.0 */
/* The tuning fork gyro: closed forms against the check values, the exact frame against thermal
 * equilibrium, the levels against each other, the chain to an identified model, refusals. */
#define _POSIX_C_SOURCE 200809L /* setenv */

#include "instrument_run.h"

#include "imukit/random.h"
#include "imukit/tuning_fork.h"
#include "physics/tuning_fork/tuning_fork_internal.h"

#include <stdio.h>

#define PI 3.14159265358979324
#define DEGREE (PI / 180.0)
#define PER_ROOT_HOUR (DEGREE / 60.0) /* deg/sqrt(h) */

static const imk_instrument *const gyro = &imk_tuning_fork_instrument;

/* The design of the check values: 1e-8 kg, 15 kHz, Q 1000, 5 um, split 100 Hz; nothing else. */
static imk_tuning_fork checked(void)
{
    imk_tuning_fork design = imk_tuning_fork_default();
    design.mass = 1e-8;
    design.drive.frequency = 15e3;
    design.drive.q = design.sense.q = 1000.0;
    design.sense.split = 100.0;
    design.drive.loop_bandwidth = 50.0;
    design.drive.force_angle = design.tines.asymmetry = 0.0;
    design.drive.amplitude_repeatability = design.drive.pickoff_noise = 0.0;
    design.sense.pickoff_noise = 0.0;
    design.quadrature = design.damping_coupling = 0.0;
    design.phase.error = design.phase.repeatability = design.phase.instability = 0.0;
    design.output.bandwidth = design.output.range = 0.0;
    return design;
}

/* The same at a tenth of the carrier: ten times as fast to run. */
static imk_tuning_fork slower(void)
{
    imk_tuning_fork design = checked();
    design.drive.frequency = 1500.0;
    design.drive.q = design.sense.q = 50.0;
    design.sense.split = 60.0;
    design.drive.loop_bandwidth = 40.0;
    return design;
}

static imk_physics_settings settings_of(double rate, imk_level level, bool noise)
{
    imk_physics_settings settings = imk_physics_default();
    settings.rate = rate;
    settings.level = level;
    settings.noise = noise;
    settings.seed = 20;
    return settings;
}

/* ---- closed forms ---------------------------------------------------------------------------- */

static void test_check_values(void **unused)
{
    (void)unused;
    imk_tuning_fork design = checked();
    /* five and four figures of the design sheet, which were computed apart */
    CHECK_CLOSE(imk_tuning_fork_response(&design) * DEGREE * 1e12, 138.04, 0.005);
    CHECK_CLOSE(imk_tuning_fork_brownian_noise(&design, 300.0) / PER_ROOT_HOUR,
                0.04558 * sqrt(15100.0 / 15e3), 5e-6); /* the sheet has wd for ws: 0.3 % */
    design.sense.split = -100.0;
    CHECK_CLOSE(imk_tuning_fork_response(&design) * DEGREE * 1e12, 138.97, 0.005);
    design.sense.split = 0.0;
    CHECK_CLOSE(imk_tuning_fork_brownian_noise(&design, 300.0) / PER_ROOT_HOUR, 0.04558, 5e-6);
    /* the damping coupling of a hemisphere: k = 0.554, D = 0.004, 0.3 rad */
    CHECK_CLOSE(imk_tuning_fork_coupling(0.004, 0.3, 0.554), 2.03842e-3, 5e-9);
    /* matched: G = g/(s + g), g = ws/2Q but for 1/8Q^2 of the carrier */
    CHECK_RELATIVE(imk_tuning_fork_bandwidth(&design), 15e3 / 2000.0, 1e-5);
    /* no damping: G = D^2/(D^2 - w^2) reaches sqrt(2) at D sqrt(1 - 1/sqrt(2)) = 0.5412 D */
    design.sense.split = -100.0;
    design.sense.q = 1e9;
    CHECK_RELATIVE(imk_tuning_fork_bandwidth(&design), 54.1196, 1e-5);
    CHECK_RELATIVE(imk_tuning_fork_gain(&design, 54.1196), sqrt(2.0), 1e-5);
    CHECK_RELATIVE(imk_tuning_fork_drive_force(&design),
                   1e-8 * pow(2.0 * PI * 15e3, 2) * 5e-6 / 1000.0, 1e-13);
}

static void test_default_is_what_it_says(void **unused)
{
    (void)unused;
    const imk_tuning_fork design = imk_tuning_fork_default();
    imk_model *model = malloc(sizeof *model);
    assert_non_null(model);
    CHECK_OK(imk_tuning_fork_validate(&design, NULL));
    imk_tuning_fork_reduce(&design, model);
    CHECK_OK(imk_model_validate(model, NULL));
    /* the data sheet's figures, to the digits in which the design's numbers are written */
    CHECK_RELATIVE(model->gyro.noise.white.value[0] * sqrt(2.0), 0.05 * DEGREE, 2e-3);
    CHECK_RELATIVE(model->gyro.noise.bias_instability.value[0] * 0.664, 50.0 * DEGREE / 3600.0,
                   2e-3);
    CHECK_RELATIVE(model->gyro.g_sensitivity.value[0][1], 0.2 * DEGREE / 9.80665, 1e-3);
    CHECK_RELATIVE(model->gyro.bandwidth.value[0], 40.0, 0.01);
    CHECK_CLOSE(model->gyro.range.value[0], 150.0 * DEGREE, 1e-15);
    imk_model_three_axes(model);
    assert_int_equal(imk_grade_model(model).gyro, IMK_GRADE_CONTROL);
    assert_non_null(strstr(imk_grade_table(IMK_GRADE_CONTROL)->gyro_technology, gyro->technology));
    free(model);
}

/* ---- the frame ------------------------------------------------------------------------------- */

enum { ROWS = IMKI_FORK_ROWS };

/* Covariance of thermal equilibrium: kB T/m K^-1 of the displacements, kB T/m of the velocities,
 * whatever the damping and the rate. */
static void equilibrium(const imk_tuning_fork *design, double p[16])
{
    const imki_fork_point point = imki_fork_at(design, IMKI_DESIGN_TEMPERATURE);
    const double heat = 1.380649e-23 * IMKI_DESIGN_TEMPERATURE / design->mass;
    const double xx = point.drive * point.drive, yy = point.sense * point.sense;
    const double xy =
        4.0 * PI * design->angular_gain * design->drive.frequency * design->quadrature;
    const double determinant = xx * yy - xy * xy;
    memset(p, 0, 16 * sizeof *p);
    p[0] = heat * yy / determinant;
    p[10] = heat * xx / determinant;
    p[2] = p[8] = -heat * xy / determinant;
    p[5] = p[15] = heat;
}

static imki_fork_frame *warm_frame(const imk_tuning_fork *design, double rate, double cycles)
{
    const imki_fork_condition condition = {rate, 0.0, IMKI_DESIGN_TEMPERATURE};
    const int steps = 18;
    imki_fork_frame *frame = malloc(sizeof *frame);
    assert_non_null(frame);
    imki_fork_frame_design(design, &condition, cycles / design->drive.frequency / steps, steps,
                           true, frame);
    return frame;
}

/* Rows r and s of M P M^T + R R^T, M and R the frame's matrix for the state and the normals. */
static double next_covariance(const imki_fork_frame *frame, const double p[16], int r, int s)
{
    double sum = 0.0;
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++)
            sum += frame->column[i][r] * p[4 * i + j] * frame->column[j][s];
    for (int k = IMKI_FORK_INPUTS; k < IMKI_FORK_COLUMNS; k++)
        sum += frame->column[k][r] * frame->column[k][s];
    return sum;
}

static void test_frame_keeps_equilibrium(void **unused)
{
    (void)unused;
    imk_tuning_fork design = slower();
    design.sense.q = 30.0;
    design.quadrature = 2.0;
    design.damping_coupling = 5.0;
    const double rates[] = {0.0, -20.0};
    for (int k = 0; k < 2; k++) {
        double p[16];
        imki_fork_frame *frame = warm_frame(&design, rates[k], 0.93);
        equilibrium(&design, p);
        for (int i = 0; i < 4; i++)
            for (int j = 0; j < 4; j++) /* rounding of 18 steps' products */
                CHECK_CLOSE(next_covariance(frame, p, i, j), p[4 * i + j],
                            1e-11 * sqrt(p[5 * i] * p[5 * j]));
        free(frame);
    }
}

/* Autocovariance of one mode in equilibrium: sigma^2 e^{-g t} (cos w t + g/w sin w t). */
static double autocovariance(double sigma2, double w0, double q, double time)
{
    const double g = 0.5 * w0 / q, w = sqrt(w0 * w0 - g * g), t = fabs(time);
    return sigma2 * exp(-g * t) * (cos(w * t) + g / w * sin(w * t));
}

/* The noise of the phasors, and its covariance with the motion at the end, by the autocovariance
 * instead of step by step; the pickoff's by independent readings. */
static void test_frame_phasor_noise(void **unused)
{
    (void)unused;
    imk_tuning_fork design = slower();
    const double pickoff = 3e-11;
    design.sense.pickoff_noise = pickoff;
    imki_fork_frame *frame = warm_frame(&design, 0.0, 0.93);
    const int n = frame->steps;
    const double w0 = 2.0 * PI * 1560.0, a = 2.0 * PI * 0.93 / n, h = a / (2.0 * PI * 1500.0);
    const double heat = 1.380649e-23 * IMKI_DESIGN_TEMPERATURE / design.mass;
    const double ripple = sin(n * a) / sin(a), mean = sin(0.5 * n * a) / (n * sin(0.5 * a));
    const double c = 0.5 * (n + ripple) - n * mean * mean;
    double p[16], whole[2] = {0.0, 0.0}, with_end = 0.0, readings = 0.0;
    equilibrium(&design, p);
    for (int i = 0; i < n; i++) {
        const double ti = (i + 1 - 0.5 * (n + 1)) * a;
        const double ci = (cos(ti) - mean) / c, si = -sin(ti) * 2.0 / (n - ripple);
        with_end += ci * autocovariance(heat / (w0 * w0), w0, 50.0, (n - 1 - i) * h);
        readings += ci * ci * pickoff * pickoff / (2.0 * h);
        for (int j = 0; j < n; j++) {
            const double tj = (j + 1 - 0.5 * (n + 1)) * a;
            const double r = autocovariance(heat / (w0 * w0), w0, 50.0, (i - j) * h);
            whole[0] += ci * (cos(tj) - mean) / c * r;
            whole[1] -= si * sin(tj) * 2.0 / (n - ripple) * r;
        }
    }
    CHECK_RELATIVE(next_covariance(frame, p, 6, 6), whole[0] + readings, 1e-10);
    CHECK_RELATIVE(next_covariance(frame, p, 7, 7) - next_covariance(frame, p, 6, 6) + readings +
                       whole[0] - whole[1],
                   pickoff * pickoff / h / (n - ripple), 1e-6);
    CHECK_CLOSE(next_covariance(frame, p, 6, 2), with_end, 1e-10 * heat / (w0 * w0));
    free(frame);
}

/* Equipartition by simulation: the mean of m wd^2 x^2, m x'^2 … over frames of a fork of Q 5, which
 * forgets in a frame. 3e5 frames of one chi-square degree each and a correlation of at most
 * e^{-2 pi/5}: the mean has a standard deviation below sqrt(2 (1 + 2 e^{-1.26}/(1 -
 * e^{-1.26}))/3e5) = 0.35 %; 5 of them, 6e-7. */
static void test_equipartition(void **unused)
{
    (void)unused;
    enum { FRAMES = 300000 };
    imk_tuning_fork design = slower();
    design.drive.q = design.sense.q = 5.0;
    imki_fork_frame *frame = warm_frame(&design, 3.0, 1.0);
    double p[16], sum[4] = {0.0}, normal[ROWS * 500];
    double input[IMKI_FORK_COLUMNS] = {0.0}, out[ROWS];
    equilibrium(&design, p);
    for (int f = -1000; f < FRAMES; f++) {
        const int at = (f + 1000) % 500;
        if (at == 0)
            imk_random_normals(imk_random_seeded(11), 5, (uint64_t)(f + 1000) * ROWS, 500 * ROWS,
                               normal);
        memcpy(input + IMKI_FORK_INPUTS, normal + ROWS * at, ROWS * sizeof *normal);
        imki_fork_apply(frame->column[0], IMKI_FORK_COLUMNS, input, out);
        memcpy(input, out, 4 * sizeof *out);
        for (int i = 0; f >= 0 && i < 4; i++)
            sum[i] += out[i] * out[i];
    }
    for (int i = 0; i < 4; i++)
        CHECK_RELATIVE(sum[i] / FRAMES, p[5 * i], 0.0175);
    free(frame);
}

/* The energy falls as e^{-w t/Q}, also with quadrature and rate: the Coriolis force does no work.
 * At Q = 1e12 that is 6e-7 in 1e5 cycles, so a numerical damping of 1e-14 per cycle would show. */
static void test_no_numerical_damping(void **unused)
{
    (void)unused;
    enum { FRAMES = 100000 };
    imk_tuning_fork design = checked();
    design.drive.q = design.sense.q = 1e12;
    design.quadrature = 2.0;
    imki_fork_frame *frame = warm_frame(&design, 5.0, 1.01);
    const imki_fork_point point = imki_fork_at(&design, IMKI_DESIGN_TEMPERATURE);
    double input[IMKI_FORK_COLUMNS] = {5e-6, 0.0, 1e-6, 0.1}, out[ROWS], energy[2] = {0.0, 0.0};
    for (int f = 0; f <= FRAMES; f++) {
        if (f == 0 || f == FRAMES)
            energy[f / FRAMES] = input[1] * input[1] + input[3] * input[3] +
                                 pow(point.drive * input[0], 2) + pow(point.sense * input[2], 2) +
                                 8.0 * PI * 15e3 * design.quadrature * input[0] * input[2];
        imki_fork_apply(frame->column[0], IMKI_FORK_INPUTS, input, out);
        memcpy(input, out, 4 * sizeof *out);
    }
    CHECK_CLOSE(energy[1] / energy[0], exp(-2.0 * PI * 1.01e-12 * FRAMES), 1e-14 * FRAMES);
    free(frame);
}

/* ---- levels ---------------------------------------------------------------------------------- */

/* A design with every deterministic error, at a carrier that runs fast. */
static imk_tuning_fork imperfect(imk_tuning_fork_loop loop)
{
    imk_tuning_fork design = slower();
    design.sense.loop = loop;
    design.sense.bandwidth = 30.0;
    design.drive.amplitude_error = 2e-3;
    design.drive.force_angle = 2e-4;
    design.tines.asymmetry = 4e-3;
    design.quadrature = 20.0 * DEGREE;
    design.damping_coupling = -0.4 * DEGREE;
    design.phase.error = 0.02;
    design.temperature.split = 0.01;
    return design;
}

/* Steady readings of both levels are those of the formula. Full: held forces have harmonics, which
 * the readings alias: of the order 1/(15 * 15^2), 3e-5 of what they hold; and the open loop's cubic
 * term is known. Slow: rounding. */
static void test_steady_readings(void **unused)
{
    (void)unused;
    for (int i = 0; i < 8; i++) {
        const imk_tuning_fork_loop loop = i & 1 ? IMK_TUNING_FORK_CLOSED : IMK_TUNING_FORK_OPEN;
        imk_tuning_fork design = imperfect(loop);
        imk_exposure exposure = imk_exposure_default();
        exposure.angular_rate[0] = i & 2 ? -1.5 : 0.3;
        exposure.temperature = i & 2 ? 333.0 : 263.0;
        exposure.specific_force[i & 4 ? 2 : 1] = i & 2 ? 50.0 : -20.0;
        design.arrangement = i & 4 ? IMK_TUNING_FORK_OUT_OF_PLANE : IMK_TUNING_FORK_IN_PLANE;
        const double rate = exposure.angular_rate[0];
        const double cubic =
            loop == IMK_TUNING_FORK_OPEN ? imk_tuning_fork_cubic(&design) * pow(rate, 3) : 0.0;
        const double expected =
            imk_tuning_fork_reading(&design, rate, i & 2 ? 50.0 : -20.0, exposure.temperature);
        imk_physics_settings settings = settings_of(100.0, IMK_LEVEL_FULL, false);
        CHECK_CLOSE(mean_of(gyro, &design, &settings, &exposure, 100, 1, 0), expected + cubic,
                    6e-5 * (fabs(rate) + design.quadrature));
        settings.level = IMK_LEVEL_SLOW;
        CHECK_CLOSE(mean_of(gyro, &design, &settings, &exposure, 300, 1, 0), expected, 1e-12);
    }
}

/* A pure quadrature signal: what of it gets into the rate is the phase error of the computation, of
 * held forces and demodulation. */
static void test_no_phase_of_its_own(void **unused)
{
    (void)unused;
    imk_tuning_fork design = checked();
    design.quadrature = 0.1; /* its pull on the drive goes with the square */
    const imk_exposure exposure = imk_exposure_default();
    for (int loop = 0; loop < 2; loop++)
        for (int steps = 16; steps <= 64; steps *= 2) {
            imk_physics_settings settings = settings_of(100.0, IMK_LEVEL_FULL, false);
            settings.step = 1.0 / (15e3 * steps);
            design.sense.loop = (imk_tuning_fork_loop)loop;
            const double leak = mean_of(gyro, &design, &settings, &exposure, 40, 1, 0);
            CHECK_BELOW(fabs(leak) / design.quadrature, 1e-6);
        }
}

/* 1 deg/s makes the mass move 138.04 pm: 32 samples a cycle over eight cycles, behind ten time
 * constants of the sense mode, Q/(pi f) = 21 ms. */
static void test_motion_of_the_mass(void **unused)
{
    (void)unused;
    const imk_tuning_fork design = checked();
    const imk_physics_settings settings = settings_of(480e3, IMK_LEVEL_FULL, false);
    imk_exposure exposure = imk_exposure_default();
    exposure.angular_rate[0] = DEGREE;
    void *state = started(gyro, &design, &settings);
    double outputs[2], signals[IMK_INSTRUMENT_SIGNALS_MAX], c[2] = {0.0}, s[2] = {0.0};
    run(gyro, state, &exposure, 120000, 0, NULL);
    for (int i = 0; i < 256; i++) {
        gyro->step(state, &exposure, outputs);
        gyro->observe(state, signals);
        for (int k = 0; k < 2; k++) {
            c[k] += signals[k] * cos(2.0 * PI * i / 32) / 128.0;
            s[k] += signals[k] * sin(2.0 * PI * i / 32) / 128.0;
        }
    }
    CHECK_RELATIVE(hypot(c[0], s[0]), 5e-6, 1e-4);
    CHECK_RELATIVE(hypot(c[1], s[1]), 138.04e-12, 1e-4);
    /* y = |y| sin(wd t - lag of the sense mode), as atan2 of a cosine's and a sine's coefficients
     */
    const double lag = atan2(s[1], c[1]) - atan2(s[0], c[0]);
    const double resonance = atan(1.0 / (1000.0 * (15100.0 / 15e3 - 15e3 / 15100.0)));
    CHECK_CLOSE(remainder(lag - 0.5 * PI - resonance, 2.0 * PI), 0.0, 1e-4);
    free(state);
}

/* The drive from rest, with loops as fast as allowed: amplitude, frequency and force find what they
 * should, also 40 K warmer. */
static void test_drive_loops(void **unused)
{
    (void)unused;
    imk_tuning_fork design = imk_tuning_fork_default();
    design.quadrature = 0.0;
    design.drive.loop_bandwidth = 700.0;
    design.drive.force_limit = 5e-6;
    const imk_physics_settings settings = settings_of(7000.0, IMK_LEVEL_FULL, false);
    imk_exposure exposure = imk_exposure_default();
    double signals[IMK_INSTRUMENT_SIGNALS_MAX];
    void *state = started(gyro, &design, &settings);
    run(gyro, state, &exposure, 1, 0, NULL);
    gyro->observe(state, signals);
    CHECK_RELATIVE(signals[4], design.drive.force_limit, 1e-15); /* still at full force */
    run(gyro, state, &exposure, 700, 0, NULL);
    gyro->observe(state, signals);
    CHECK_RELATIVE(signals[2], 5e-6, 1e-8);
    CHECK_CLOSE(signals[3], 14e3, 1e-3); /* 7e-8: the harmonics of the held force */
    CHECK_RELATIVE(signals[4], imk_tuning_fork_drive_force(&design), 1e-5);
    exposure.temperature += 40.0;
    run(gyro, state, &exposure, 700, 0, NULL);
    gyro->observe(state, signals);
    CHECK_RELATIVE(signals[2], 5e-6 * 1.004, 1e-8);
    CHECK_CLOSE(signals[3], 14e3 * (1.0 - 1200e-6), 1e-3);
    free(state);
}

/* The drive frequency is pulled by the Coriolis force of the sense motion: at 40 rad/s the reading
 * is 1 % low; the next order is the square of that. */
static void test_cubic(void **unused)
{
    (void)unused;
    imk_tuning_fork design = slower();
    const imk_physics_settings settings = settings_of(100.0, IMK_LEVEL_FULL, false);
    imk_exposure exposure = imk_exposure_default();
    exposure.angular_rate[0] = 40.0;
    const double cubic = imk_tuning_fork_cubic(&design) * 40.0 * 40.0;
    const double reading = mean_of(gyro, &design, &settings, &exposure, 100, 1, 0) / 40.0 - 1.0;
    CHECK_BELOW(cubic, -5e-3);
    CHECK_CLOSE(reading, cubic, 2.0 * cubic * cubic + 6e-5);
}

/* The gain at a frequency, of a rate held over samples of 1/3000 s: the hold and the mean over a
 * sample are sinc(f/3000) each, 1 - 1.3e-3 at 60 Hz. What is left are the images at 3000 Hz - f
 * and, of the full level, the delay of two frames in a closed loop: 2 w/15 kHz of its bandwidth w,
 * and terms of the order f/fd that the average leaves out. */
static void check_gain(const imk_tuning_fork *design, imk_level level, double frequency,
                       double expected)
{
    const imk_physics_settings settings = settings_of(3000.0, level, false);
    CHECK_RELATIVE(sine_gain(gyro, design, &settings, 0.5, frequency, 900, 5, NULL), expected,
                   level == IMK_LEVEL_FULL ? 0.015 : 2e-3);
}

static void test_frequency_response(void **unused)
{
    (void)unused;
    imk_model *model = malloc(sizeof *model);
    assert_non_null(model);
    for (int level = 0; level < 2; level++) {
        imk_tuning_fork design = checked();
        design.sense.q = 500.0;
        design.sense.split = 60.0;
        check_gain(&design, (imk_level)level, 30.0, imk_tuning_fork_gain(&design, 30.0));
        check_gain(&design, (imk_level)level, 60.0, imk_tuning_fork_gain(&design, 60.0));
        design.sense.loop = IMK_TUNING_FORK_CLOSED;
        design.sense.bandwidth = 20.0;
        check_gain(&design, (imk_level)level, 20.0, sqrt(0.5));
        design.sense.bandwidth = 70.0;
        design.output.bandwidth = 10.0;
        design.output.damping = 0.7;
        check_gain(&design, (imk_level)level, 10.0, 1.0 / sqrt(2.0 * (1.0 + 1.0 / 49.0)));
        imk_tuning_fork_reduce(&design, model);
        check_gain(&design, (imk_level)level, model->gyro.bandwidth.value[0], sqrt(0.5));
    }
    free(model);
}

/* ---- the error model ------------------------------------------------------------------------- */

/* Bias and scale factor of the model at any temperature are those of the reading: what a polynomial
 * of fifth degree leaves of 20 deg/s of quadrature. */
static void test_temperature_polynomials(void **unused)
{
    (void)unused;
    imk_model *model = malloc(sizeof *model);
    assert_non_null(model);
    for (int loop = 0; loop < 2; loop++) {
        imk_tuning_fork design = imk_tuning_fork_default();
        design.sense.loop = (imk_tuning_fork_loop)loop;
        design.temperature.split = 0.5;
        imk_tuning_fork_reduce(&design, model);
        for (double t = 233.15; t < 398.15; t += 7.0) {
            double bias = model->gyro.bias.fixed.value[0];
            double scale = model->gyro.scale_factor.fixed.value[0];
            for (int i = 0; i < IMK_TEMPERATURE_ORDER_MAX; i++) {
                const double power = pow(t - 293.15, i + 1);
                bias += model->gyro.bias.temperature.coefficient[i].value[0] * power;
                scale += model->gyro.scale_factor.temperature.coefficient[i].value[0] * power;
            }
            const double zero = imk_tuning_fork_reading(&design, 0.0, 0.0, t);
            CHECK_CLOSE(bias, zero, 1e-5 * design.quadrature);
            CHECK_CLOSE(1.0 + scale, imk_tuning_fork_reading(&design, 1.0, 0.0, t) - zero, 1e-5);
        }
    }
    free(model);
}

/* Sum of squares of `count` means of `length` samples about zero, over their expected variance
 * N^2/(length dt): chi-square. 6 sigma of its normal approximation, 2e-9 per side; the
 * approximation makes that 1e-7 at 400 degrees. */
static void check_white(const imk_tuning_fork *design, double rate, imk_level level, size_t settle,
                        size_t length, size_t count, double density)
{
    const imk_physics_settings settings = settings_of(rate, level, true);
    const imk_exposure exposure = imk_exposure_default();
    void *state = started(gyro, design, &settings);
    double *samples = malloc(length * sizeof *samples), sum = 0.0;
    assert_non_null(samples);
    run(gyro, state, &exposure, settle, 0, NULL);
    for (size_t i = 0; i < count; i++) {
        double mean = 0.0;
        run(gyro, state, &exposure, length, 0, samples);
        for (size_t k = 0; k < length; k++)
            mean += samples[k] / (double)length;
        sum += mean * mean;
    }
    const double expected = density * density * rate / (double)length;
    CHECK_RELATIVE(sum / (double)count, expected, 6.0 * sqrt(2.0 / (double)count));
    free(samples);
    free(state);
}

/* The design's angle random walk, as measured. Means over 0.2 s, at frequencies of some Hz, where
 * the gain of the split has not yet risen (60 Hz, 5 Hz: 0.7 %). */
static void test_angle_random_walk(void **unused)
{
    (void)unused;
    for (int loop = 0; loop < 2; loop++) {
        imk_tuning_fork design = slower();
        design.sense.loop = (imk_tuning_fork_loop)loop;
        design.sense.bandwidth = 30.0;
        const double brownian = imk_tuning_fork_brownian_noise(&design, 293.15);
        check_white(&design, 100.0, IMK_LEVEL_FULL, 100, 20, 500, brownian);
        check_white(&design, 100.0, IMK_LEVEL_SLOW, 100, 20, 10000, brownian);
        design.sense.pickoff_noise = 2.0 * brownian * imk_tuning_fork_response(&design);
        CHECK_RELATIVE(imk_tuning_fork_pickoff_noise(&design), 2.0 * brownian, 1e-14);
        check_white(&design, 100.0, IMK_LEVEL_FULL, 100, 20, 500, sqrt(5.0) * brownian);
        check_white(&design, 100.0, IMK_LEVEL_SLOW, 100, 20, 10000, sqrt(5.0) * brownian);
    }
    /* the check value: 0.04558 deg/sqrt(h) matched at 300 K; here 293.15 K */
    imk_tuning_fork design = checked();
    check_white(&design, 100.0, IMK_LEVEL_FULL, 40, 10, 100,
                0.04558 * PER_ROOT_HOUR * sqrt(15100.0 / 15e3 * 293.15 / 300.0));
}

/* The run's constants: the spread of the mean over 400 runs, 6 sigma as above. */
static void test_repeatability(void **unused)
{
    (void)unused;
    enum { RUNS = 400 };
    imk_tuning_fork design = slower();
    design.mass = 1.0; /* no Brownian motion to speak of */
    design.drive.force_limit = 1e3;
    design.quadrature = 0.5;
    design.phase.repeatability = 2e-3;
    imk_exposure exposure = imk_exposure_default();
    double sum = 0.0;
    for (uint32_t r = 0; r < RUNS; r++) {
        imk_physics_settings settings = settings_of(10.0, IMK_LEVEL_SLOW, true);
        settings.run = r;
        sum += pow(mean_of(gyro, &design, &settings, &exposure, 10, 1, 0), 2);
    }
    CHECK_RELATIVE(sum / RUNS, pow(0.5 * 2e-3, 2), 6.0 * sqrt(2.0 / RUNS));
}

/* Design -> log of the full level -> identified model. */
static void test_chain(void **unused)
{
    (void)unused;
    imk_tuning_fork design = slower();
    design.sense.pickoff_noise = 1e-12;
    design.quadrature = 20.0 * DEGREE;
    design.phase.instability = 5e-3;
    design.phase.repeatability = 5e-3;
    imk_physics_settings settings = settings_of(10.0, IMK_LEVEL_FULL, true);
    const imk_exposure exposure = imk_exposure_default();
    check_chain(gyro, &design, &settings, &exposure, 10, 6000);
    settings.level = IMK_LEVEL_SLOW;
    check_chain(gyro, &design, &settings, &exposure, 10, 60000);
    /* White noise alone, whose interval is then +-3.2 %. Towards the split, 60 Hz, the pickoff's
     * noise grows against a rate: in means of 0.1 s it is 6 % more, of 1 s below 1 %. */
    design.phase.instability = design.phase.repeatability = 0.0;
    settings.rate = 1.0;
    check_chain(gyro, &design, &settings, &exposure, 10, 12000);
}

/* ---- the interface --------------------------------------------------------------------------- */

static void test_output_stage(void **unused)
{
    (void)unused;
    imk_tuning_fork design = slower();
    design.output.range = 1.0;
    design.output.resolution = 0.03;
    imk_exposure exposure = imk_exposure_default();
    for (int i = 0; i < 4; i++) {
        const imk_physics_settings settings = settings_of(100.0, (imk_level)(i & 1), false);
        design.sense.loop = (imk_tuning_fork_loop)(i / 2);
        design.sense.bandwidth = 30.0;
        exposure.angular_rate[0] = 3.0;
        CHECK_CLOSE(mean_of(gyro, &design, &settings, &exposure, 100, 1, 0), 0.99, 1e-12);
        exposure.angular_rate[0] = -0.31;
        CHECK_CLOSE(mean_of(gyro, &design, &settings, &exposure, 100, 1, 0), -0.30, 1e-12);
    }
}

/* A copy of the state goes on with the same bits; so does the scalar kernel of the normals. */
static void test_same_bits(void **unused)
{
    (void)unused;
    enum { COUNT = 200 };
    imk_tuning_fork design = imk_tuning_fork_default();
    imk_exposure exposure = imk_exposure_default();
    exposure.angular_rate[0] = 0.1;
    for (int level = 0; level < 2; level++) {
        const imk_physics_settings settings = settings_of(1000.0, (imk_level)level, true);
        double first[COUNT], second[COUNT], scalar[2 * COUNT];
        void *state = started(gyro, &design, &settings);
        void *copy = aligned_alloc(64, (gyro->state_size + 63) / 64 * 64);
        assert_non_null(copy);
        run(gyro, state, &exposure, COUNT, 0, NULL);
        memcpy(copy, state, gyro->state_size);
        run(gyro, state, &exposure, COUNT, 0, first);
        run(gyro, copy, &exposure, COUNT, 0, second);
        assert_memory_equal(first, second, sizeof first);
        free(copy);
        free(state);
        const char *before = getenv("IMUKIT_ISA");
        char kept[32] = "";
        snprintf(kept, sizeof kept, "%s", before ? before : "");
        setenv("IMUKIT_ISA", "scalar", 1);
        state = started(gyro, &design, &settings);
        if (before)
            setenv("IMUKIT_ISA", kept, 1);
        else
            unsetenv("IMUKIT_ISA");
        run(gyro, state, &exposure, (size_t)2 * COUNT, 0, scalar);
        assert_memory_equal(first, scalar + COUNT, sizeof first);
        free(state);
    }
}

static void check_refused(const imk_tuning_fork *design, imk_status status, const char *field)
{
    imk_error error = {0};
    CHECK_STATUS(imk_tuning_fork_validate(design, &error), status);
    assert_string_equal(error.field, field);
}

static void test_refused_designs(void **unused)
{
    (void)unused;
    const imk_tuning_fork good = imk_tuning_fork_default();
    imk_tuning_fork design = good;
    design.cookie = 0;
    CHECK_STATUS(imk_tuning_fork_validate(&design, NULL), IMK_ERROR_UNINITIALISED);
#define REFUSED(member, value, status, field)                                                      \
    do {                                                                                           \
        design = good;                                                                             \
        design.member = value;                                                                     \
        check_refused(&design, status, field);                                                     \
    } while (0)
    REFUSED(sense.q, 0.5, IMK_ERROR_RANGE, "sense.q");
    REFUSED(drive.q, 0.4, IMK_ERROR_RANGE, "drive.q");
    REFUSED(mass, 0.0, IMK_ERROR_RANGE, "mass");
    REFUSED(mass, (double)NAN, IMK_ERROR_NOT_FINITE, "mass");
    REFUSED(angular_gain, 1.1, IMK_ERROR_RANGE, "angular_gain");
    REFUSED(sense.split, -14e3, IMK_ERROR_CONFLICT, "sense.split");
    REFUSED(drive.force_limit, 3.5e-6, IMK_ERROR_CONFLICT, "drive.force_limit");
    REFUSED(drive.loop_bandwidth, 701.0, IMK_ERROR_RANGE, "drive.loop_bandwidth");
    REFUSED(output.bandwidth, 2000.0, IMK_ERROR_RANGE, "output.bandwidth");
    REFUSED(output.damping, 0.01, IMK_ERROR_RANGE, "output.damping");
    REFUSED(temperature.q, -0.01, IMK_ERROR_CONFLICT, "temperature.q");
    REFUSED(arrangement, (imk_tuning_fork_arrangement)2, IMK_ERROR_RANGE, "arrangement");
    /* feeds motions: 2 k Wc above sqrt(wd ws/(Qd Qs)) = 2025 1/s; the table alone allows 17 rad/s
     */
    design = good;
    design.drive.q = design.sense.q = 1e5;
    design.damping_coupling = 1.0;
    check_refused(&design, IMK_ERROR_CONFLICT, "damping_coupling");
    design = good;
    design.sense.loop = IMK_TUNING_FORK_CLOSED;
    design.sense.bandwidth = 701.0;
    check_refused(&design, IMK_ERROR_RANGE, "sense.bandwidth");
    design.sense.bandwidth = 300.0;
    design.sense.split = -1101.0;
    check_refused(&design, IMK_ERROR_CONFLICT, "sense.split");
#undef REFUSED
    design = good;
    design.sense.split = -1000.0; /* below the drive: allowed */
    CHECK_OK(imk_tuning_fork_validate(&design, NULL));
}

static void test_refused_steps(void **unused)
{
    (void)unused;
    const imk_tuning_fork design = imk_tuning_fork_default();
    imk_physics_settings settings = imk_physics_default();
    imk_error error = {0};
    void *state = aligned_alloc(64, (gyro->state_size + 63) / 64 * 64);
    assert_non_null(state);
    settings.step = 1.0 / (15.0 * 14e3);
    CHECK_STATUS(imk_instrument_init(gyro, &design, &settings, state, &error), IMK_ERROR_RANGE);
    assert_string_equal(error.field, "step");
    settings.step = 1.0 / (200.0 * 14e3);
    CHECK_STATUS(imk_instrument_init(gyro, &design, &settings, state, &error), IMK_ERROR_RANGE);
    assert_string_equal(error.field, "step");
    settings.step = 0.0;
    settings.rate = 200.0 * 14e3;
    CHECK_STATUS(imk_instrument_init(gyro, &design, &settings, state, &error), IMK_ERROR_RANGE);
    assert_string_equal(error.field, "rate");
    settings.rate = 100.0;
    CHECK_OK(imk_instrument_init(gyro, &design, &settings, state, &error));
    CHECK_RELATIVE(gyro->step_length(&design, &settings), 1.0 / (16.0 * 14e3), 1e-12);
    free(state);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_check_values),
        cmocka_unit_test(test_default_is_what_it_says),
        cmocka_unit_test(test_frame_keeps_equilibrium),
        cmocka_unit_test(test_frame_phasor_noise),
        cmocka_unit_test(test_equipartition),
        cmocka_unit_test(test_no_numerical_damping),
        cmocka_unit_test(test_steady_readings),
        cmocka_unit_test(test_no_phase_of_its_own),
        cmocka_unit_test(test_motion_of_the_mass),
        cmocka_unit_test(test_drive_loops),
        cmocka_unit_test(test_cubic),
        cmocka_unit_test(test_frequency_response),
        cmocka_unit_test(test_temperature_polynomials),
        cmocka_unit_test(test_angle_random_walk),
        cmocka_unit_test(test_repeatability),
        cmocka_unit_test(test_chain),
        cmocka_unit_test(test_output_stage),
        cmocka_unit_test(test_same_bits),
        cmocka_unit_test(test_refused_designs),
        cmocka_unit_test(test_refused_steps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
