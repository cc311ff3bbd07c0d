/* SPDX-License-Identifier: Apache-2.0 */
/* The shell gyro without noise: closed forms, full dynamics against them, slow against full
 * dynamics, error model against both; refusals. */
#define _POSIX_C_SOURCE 200809L /* setenv */

#include "shell_gyro_designs.h"

#include "imukit/design_file.h"

/* Steady reading under a rate. */
static inline double steady(const imk_shell_gyro *design, imk_level level, double rate)
{
    const imk_physics_settings settings = quiet(level, 10.0);
    const imk_exposure exposure = turning(rate);
    return mean_of(shell, design, &settings, &exposure, 15, 2, 0);
}

/* ---- closed forms ---------------------------------------------------------------------------- */

static void test_closed_forms(void **unused)
{
    (void)unused;
    imk_shell_gyro design = perfect(IMK_SHELL_FREE);
    CHECK_CLOSE(imk_shell_gyro_modal_gain(&design), 0.554, 1e-15); /* hemisphere */
    design.resonator.shape = IMK_SHELL_RING;
    CHECK_CLOSE(imk_shell_gyro_angular_gain(&design), 0.4, 1e-15);
    CHECK_CLOSE(imk_shell_gyro_modal_gain(&design), 0.8, 1e-15);
    design.resonator.mode_number = 3;
    CHECK_CLOSE(imk_shell_gyro_modal_gain(&design), 0.6, 1e-15); /* 3 * 2/10 */

    /* Design sheet: D = .004, theta_d = .3, theta = .5 and, at theta = 0 with k = .554, the bias.
     * Six digits were given. */
    design = perfect(IMK_SHELL_FREE);
    design.anisotropy.damping_difference = 0.004;
    design.anisotropy.damping_angle = 0.3;
    CHECK_CLOSE(imk_shell_gyro_precession(&design, 0.0, 0.5), 7.78837e-4, 5e-10);
    CHECK_CLOSE(imk_shell_gyro_damping_bias(&design, 0.0), 2.03842e-3, 5e-9);
    CHECK_CLOSE(imk_shell_gyro_precession(&design, 2.0, 0.3), -2.0 * 0.554, 1e-15);

    /* 1e-8 kg, 15 kHz, Q = 1000, 5 um, 300 K, k = 1: .04558 deg/sqrt(h), four digits given. */
    design.resonator.shape = IMK_SHELL_OTHER;
    design.resonator.angular_gain = 0.5;
    design.resonator.mass = 1e-8;
    design.resonator.frequency = 15000.0;
    CHECK_CLOSE(imk_shell_gyro_thermal_random_walk(&design, 300.0) * 180.0 / pi * 60.0, 0.04558,
                5e-6);
    CHECK_RELATIVE(imk_shell_gyro_decay_time(&design), 1000.0 / (pi * 15000.0), 1e-15);
}

/* ---- free pattern ---------------------------------------------------------------------------- */

/* theta' = (D/2) sin 2(theta - theta_d) has the solution tan(theta - theta_d) ~ e^(D t); its mean
 * over the first second from .5 is 7.8027e-4 rad/s. The averaged equation neglects (D/w)^2; the
 * ellipse of an instant differs from that of a cycle by D/w, alike at both ends to D^2 t/w. */
static void test_damping_turns_a_free_pattern(void **unused)
{
    (void)unused;
    imk_shell_gyro design = perfect(IMK_SHELL_FREE);
    design.resonator.quality = 5e5; /* 2/tau = .0126 */
    design.anisotropy.damping_difference = 0.004;
    design.anisotropy.damping_angle = 0.3;
    design.pattern.angle = 0.5;
    const imk_physics_settings settings = quiet(IMK_LEVEL_FULL, 1.0);
    const imk_exposure exposure = imk_exposure_default();
    void *state = started(shell, &design, &settings);
    const double begin = signal_of(state, MODAL_ANGLE);
    run(shell, state, &exposure, 1, 0, NULL);
    const double turned = signal_of(state, MODAL_ANGLE) - begin;
    CHECK_CLOSE(turned, 7.8027e-4, 1e-8); /* as printed */
    CHECK_CLOSE(turned, atan(tan(0.2) * exp(0.004)) - 0.2, 3e-9);
    free(state);
}

/* Bryan's effect, exactly: without damping and anisotropy the complex x + iy is e^(-i k W t) times
 * a sum of e^(+-i t sqrt(w^2 + k^2 W^2)). The pattern was started at rest in the case, so it is an
 * ellipse of axes 1 and k W/w. Amplitude and quadrature (Lynch's E and Q) stay; nothing is lost to
 * arithmetic: 2e4 cycles at less than 1e-12 each. */
static void test_free_pattern_keeps_its_integrals(void **unused)
{
    (void)unused;
    imk_shell_gyro design = perfect(IMK_SHELL_FREE);
    design.resonator.quality = 1e12;
    const imk_physics_settings settings = quiet(IMK_LEVEL_FULL, 2.0);
    const double rate = 1.0, gain = 0.554, seconds = 20.0;
    const imk_exposure exposure = turning(rate);
    void *state = started(shell, &design, &settings);
    run(shell, state, &exposure, (size_t)(seconds * settings.rate), 0, NULL);
    /* what Q = 1e12 takes itself in 2e4 cycles: 6e-8 */
    const double decay = exp(-seconds / imk_shell_gyro_decay_time(&design));
    /* an instant's ellipse, of velocities in the case, has axes off by up to k W/w a = 9e-5, the
     * angle by up to its square */
    CHECK_RELATIVE(signal_of(state, AMPLITUDE), design.pattern.amplitude * decay, 1e-8);
    CHECK_CLOSE(signal_of(state, QUADRATURE) / design.pattern.amplitude, 0.0,
                2.0 * gain * rate / (2.0 * pi * 1000.0));
    CHECK_CLOSE(signal_of(state, MODAL_ANGLE), -gain * rate * seconds, 1e-7);
    free(state);

    /* With the case at rest they stay exactly. */
    const imk_exposure still = imk_exposure_default();
    state = started(shell, &design, &settings);
    run(shell, state, &still, (size_t)(seconds * settings.rate), 0, NULL);
    CHECK_RELATIVE(signal_of(state, AMPLITUDE), design.pattern.amplitude * decay, 2e4 * 1e-14);
    CHECK_CLOSE(signal_of(state, MODAL_ANGLE), 0.0, 1e-14);
    CHECK_CLOSE(signal_of(state, QUADRATURE), 0.0, 1e-12 * design.pattern.amplitude);
    free(state);
}

/* Anisoelasticity makes a linear pattern an ellipse: q' = (dw/2) a sin 2(theta - theta_w) at first,
 * a^2 + q^2 and (along the principal axes) each mode's energy constant: in exact beats,
 * a q = (A^2/2) sin(dw t) sin(2 theta_w) for a pattern started at theta = 0. */
static void test_split_opens_an_ellipse(void **unused)
{
    (void)unused;
    imk_shell_gyro design = perfect(IMK_SHELL_FREE);
    design.resonator.quality = 1e12;
    design.anisotropy.frequency_split = 0.1;
    design.anisotropy.stiffness_angle = 0.4;
    const imk_physics_settings settings = quiet(IMK_LEVEL_FULL, 4.0);
    const imk_exposure still = imk_exposure_default();
    void *state = started(shell, &design, &settings);
    run(shell, state, &still, 4, 0, NULL);
    const double a = signal_of(state, AMPLITUDE), q = signal_of(state, QUADRATURE);
    const double start = design.pattern.amplitude;
    /* to the split itself, 1e-4 of the frequency */
    CHECK_RELATIVE(a * a + q * q, start * start, 1e-4);
    CHECK_RELATIVE(a * q, -0.5 * start * start * sin(0.2 * pi) * sin(0.8), 2e-4);
    free(state);
}

/* ---- force to rebalance ---------------------------------------------------------------------- */

static void test_rebalance_bias_and_force(void **unused)
{
    (void)unused;
    imk_shell_gyro design = perfect(IMK_SHELL_REBALANCE);
    design.anisotropy.damping_difference = 0.004;
    design.anisotropy.damping_angle = 0.3;
    /* Full dynamics have terms of the order of D/w = 6e-7 that averaging leaves out. */
    CHECK_RELATIVE(steady(&design, IMK_LEVEL_FULL, 0.0), 2.03842e-3, 3e-6);
    CHECK_RELATIVE(steady(&design, IMK_LEVEL_SLOW, 0.0), 2.03842e-3, 3e-6);
    /* The force is 2 m w a k W. */
    design.anisotropy.damping_difference = 0.0;
    const imk_physics_settings settings = quiet(IMK_LEVEL_FULL, 10.0);
    const imk_exposure exposure = turning(0.5);
    void *state = started(shell, &design, &settings);
    run(shell, state, &exposure, 30, 0, NULL);
    CHECK_RELATIVE(signal_of(state, REBALANCE_FORCE), imk_shell_gyro_rebalance_force(&design, 0.5),
                   1e-6);
    free(state);
}

/* Quadrature leaks by the sine of the phase error. The whole bias is tested below; here the sign
 * and factor alone, to the averaging's (dw/w) and to what the integral of the loop has not yet
 * removed. */
static void test_quadrature_leaks_by_the_phase_error(void **unused)
{
    (void)unused;
    imk_shell_gyro design = perfect(IMK_SHELL_REBALANCE);
    design.anisotropy.frequency_split = 0.05;
    design.anisotropy.stiffness_angle = 0.6;
    design.control.phase_error = 0.02;
    const double leak = pi * 0.05 * sin(1.2) / 0.554 * sin(0.02);
    CHECK_RELATIVE(imk_shell_gyro_quadrature_rate(&design, 0.0) * sin(0.02), leak, 1e-12);
    CHECK_RELATIVE(steady(&design, IMK_LEVEL_FULL, 0.0), leak, 2e-4);
    CHECK_RELATIVE(steady(&design, IMK_LEVEL_SLOW, 0.0), leak, 1e-9);
    design.control.phase_error = 0.0;
    CHECK_CLOSE(steady(&design, IMK_LEVEL_FULL, 0.0), 0.0, 2e-4 * leak);
}

/* All errors at once: full and slow dynamics read what the error model says, at rest, turning, and
 * warm. The electronics' errors are of the order of 1e-3, and the decay time that the loops cancel
 * is that of 20 degC. */
static void test_error_model_of_a_ring(void **unused)
{
    (void)unused;
    imk_shell_gyro design = imk_shell_gyro_default();
    design.resonator.frequency = 2000.0;
    design.resonator.quality = 700.0;
    design.control.rebalance_bandwidth = 30.0;
    design.control.support_bandwidth = 30.0;
    design.anisotropy.frequency_split = 0.1;
    design.forcer.limit = 0.0;
    imk_model model;
    imk_instrument_reduce(shell, &design, &model);
    CHECK_OK(imk_model_validate(&model, NULL));
    const imk_triad *gyro = &model.gyro;
    const double bias = gyro->bias.fixed.value[0], scale = gyro->scale_factor.fixed.value[0];
    const double full[3] = {steady(&design, IMK_LEVEL_FULL, -1.0),
                            steady(&design, IMK_LEVEL_FULL, 0.0),
                            steady(&design, IMK_LEVEL_FULL, 1.0)};
    const double slow[2] = {steady(&design, IMK_LEVEL_SLOW, 0.0),
                            steady(&design, IMK_LEVEL_SLOW, 1.0)};
    assert_true(fabs(bias) > 0.01 && fabs(scale) > 1e-4); /* something to see */
    CHECK_CLOSE(full[1], bias, 3e-5 * fabs(bias));
    CHECK_CLOSE(slow[0], bias, 1e-12);
    CHECK_CLOSE(0.5 * (full[2] - full[0]) - 1.0, scale, 3e-5);
    CHECK_CLOSE(0.5 * (full[2] + full[0]), bias, 1e-5); /* no asymmetry */
    CHECK_CLOSE(slow[1] - slow[0] - 1.0, scale, 1e-12);

    /* At 60 degC, about all three axes. */
    const imk_physics_settings settings = quiet(IMK_LEVEL_FULL, 10.0);
    imk_exposure warm = turning(0.7);
    warm.temperature = 333.15;
    warm.angular_rate[1] = 2.0;
    warm.angular_rate[2] = -1.0;
    double expected = bias + 0.7 * (1.0 + scale) + 2.0 * gyro->misalignment.value[0][1] -
                      gyro->misalignment.value[0][2];
    const double input = 0.7 + 2.0 * design.package.misalignment_y - design.package.misalignment_z;
    for (int i = 0; i < gyro->bias.temperature.order; i++)
        expected += gyro->bias.temperature.coefficient[i].value[0] * pow(40.0, i + 1);
    for (int i = 0; i < gyro->scale_factor.temperature.order; i++)
        expected +=
            input * gyro->scale_factor.temperature.coefficient[i].value[0] * pow(40.0, i + 1);
    CHECK_CLOSE(mean_of(shell, &design, &settings, &warm, 15, 2, 0), expected, 1e-4);
}

/* The loop's -3 dB point is where the closed form says, at both levels. The slow form is a filter
 * of first order with the design's bandwidth; the full loop has its delay beside it. */
static void test_bandwidth(void **unused)
{
    (void)unused;
    imk_shell_gyro design = perfect(IMK_SHELL_REBALANCE);
    imk_model model;
    imk_instrument_reduce(shell, &design, &model);
    const double bandwidth = model.gyro.bandwidth.value[0];
    /* the delay of an update, a twelfth of 1/20 s, takes an eighth of it */
    CHECK_CLOSE(bandwidth, 20.0, 0.15 * 20.0);
    imk_physics_settings settings = quiet(IMK_LEVEL_FULL, 64.0 * bandwidth);
    /* 0.3 %: the loop's mean over an update, T w/2 squared over 6, on either side */
    CHECK_RELATIVE(sine_gain(shell, &design, &settings, 0.1, bandwidth, 2000, 20, NULL), sqrt(0.5),
                   5e-3);
    CHECK_RELATIVE(sine_gain(shell, &design, &settings, 0.1, bandwidth / 8.0, 2048, 2, NULL), 1.0,
                   1e-2);
    settings.level = IMK_LEVEL_SLOW;
    settings.rate = 64.0 * 20.0;
    CHECK_RELATIVE(sine_gain(shell, &design, &settings, 0.1, 20.0, 640, 20, NULL), sqrt(0.5), 1e-3);
}

/* ---- whole angle ----------------------------------------------------------------------------- */

/* A turning pattern with all errors of electronics and damping: the angle of full and slow
 * dynamics. The readings of the full dynamics lag by an update and a half. */
static void test_whole_angle_levels_agree(void **unused)
{
    (void)unused;
    imk_shell_gyro design = perfect(IMK_SHELL_WHOLE_ANGLE);
    design.anisotropy.damping_difference = 0.05;
    design.anisotropy.damping_angle = 0.3;
    design.pickoff.gain_mismatch = 2e-3;
    design.pickoff.misalignment = -1e-3;
    design.pattern.angle = 0.4;
    for (int drive = 0; drive < 2; drive++) {
        design.forcer.drive = (imk_shell_drive)drive;
        design.forcer.gain_mismatch = drive ? 1e-3 : 0.0;
        const imk_physics_settings full = quiet(IMK_LEVEL_FULL, 50.0);
        const imk_physics_settings slow = quiet(IMK_LEVEL_SLOW, 50.0);
        void *a = started(shell, &design, &full), *b = started(shell, &design, &slow);
        double largest = 0.0;
        for (int i = 0; i < 150; i++) {
            const imk_exposure exposure = turning(i < 100 ? 0.9 : -0.4);
            run(shell, a, &exposure, 1, 0, NULL);
            run(shell, b, &exposure, 1, 0, NULL);
            largest = fmax(largest, fabs(signal_of(a, MODAL_ANGLE) - signal_of(b, MODAL_ANGLE)));
        }
        /* the path is 1.2 rad long and D moves it by 0.1; (D h)^2 and k W/w remain */
        CHECK_BELOW(largest, 2e-4);
        free(a);
        free(b);
    }
}

/* The hemispherical gyro at Earth rate and at 1 rad/s: scale factor exact (k is geometry), bias as
 * reduced. */
static void test_hemispherical_gyro(void **unused)
{
    (void)unused;
    const imk_shell_gyro design = hemispherical();
    imk_model model;
    imk_instrument_reduce(shell, &design, &model);
    CHECK_OK(imk_model_validate(&model, NULL));
    /* the published figures: .00025 deg/sqrt(h) and .005 deg/h (1 sigma) within 10 % */
    CHECK_RELATIVE(model.gyro.noise.white.value[0] * 180.0 / pi * 60.0, 2.5e-4, 0.1);
    CHECK_RELATIVE(model.gyro.bias.repeatability.value[0] * 180.0 / pi * 3600.0, 5e-3, 0.1);
    const imk_physics_settings full = quiet(IMK_LEVEL_FULL, 5.0);
    const imk_physics_settings slow = quiet(IMK_LEVEL_SLOW, 5.0);
    const double rate = 7.292115e-5;
    const imk_exposure exposure = turning(rate);
    const double bias = model.gyro.bias.fixed.value[0];
    /* bias 2e-8; 2e-10 is what rounding makes of the angle, 1e-10 rad */
    CHECK_CLOSE(mean_of(shell, &design, &full, &exposure, 1, 10, 0), rate + bias, 1e-9);
    /* the pickoff's mismatch changes the scale by -5 ppm at theta = 0 (and + 5 ppm at 90 degrees)
     */
    CHECK_CLOSE(mean_of(shell, &design, &slow, &exposure, 1, 10, 0), rate * (1.0 - 5e-6) + bias,
                1e-11);
    const imk_exposure fast = turning(1.0);
    /* the pickoff's errors are periodic: 5 ppm of half a radian in two seconds */
    CHECK_CLOSE(mean_of(shell, &design, &slow, &fast, 1, 10, 0), 1.0, 5e-6);
    CHECK_CLOSE(mean_of(shell, &design, &full, &fast, 5, 10, 0),
                mean_of(shell, &design, &slow, &fast, 5, 10, 0), 2e-6);
}

/* ---- the rest -------------------------------------------------------------------------------- */

static void test_range(void **unused)
{
    (void)unused;
    imk_shell_gyro design = perfect(IMK_SHELL_REBALANCE);
    design.forcer.limit = imk_shell_gyro_rebalance_force(&design, 2.0);
    imk_model model;
    imk_instrument_reduce(shell, &design, &model);
    CHECK_RELATIVE(model.gyro.range.value[0], 2.0, 1e-12);
    CHECK_RELATIVE(steady(&design, IMK_LEVEL_FULL, 1.9), 1.9, 1e-5);
    CHECK_RELATIVE(steady(&design, IMK_LEVEL_FULL, 3.0), 2.0, 1e-12);
    CHECK_RELATIVE(steady(&design, IMK_LEVEL_SLOW, -3.0), -2.0, 1e-12);
}

/* The same bits from a copy of the state, and with scalar random numbers. */
static void test_same_bits(void **unused)
{
    (void)unused;
    const imk_shell_gyro designs[2] = {imk_shell_gyro_default(), hemispherical()};
    for (int i = 0; i < 4; i++) {
        imk_physics_settings settings = imk_physics_default();
        settings.level = (imk_level)(i % 2);
        const imk_exposure exposure = turning(0.1);
        double samples[3][40];
        void *state = started(shell, &designs[i / 2], &settings);
        const size_t size = (shell->state_size + 63) / 64 * 64;
        void *copy = aligned_alloc(64, size);
        assert_non_null(copy);
        run(shell, state, &exposure, 7, 0, NULL);
        memcpy(copy, state, shell->state_size);
        run(shell, state, &exposure, 40, 0, samples[0]);
        run(shell, copy, &exposure, 40, 0, samples[1]);
        free(state);
        free(copy);
        const char *before = getenv("IMUKIT_ISA");
        char saved[16] = "";
        if (before)
            strncpy(saved, before, sizeof saved - 1);
        setenv("IMUKIT_ISA", "scalar", 1);
        state = started(shell, &designs[i / 2], &settings);
        run(shell, state, &exposure, 7, 0, NULL);
        run(shell, state, &exposure, 40, 0, samples[2]);
        free(state);
        if (before)
            setenv("IMUKIT_ISA", saved, 1);
        else
            unsetenv("IMUKIT_ISA");
        assert_memory_equal(samples[0], samples[1], sizeof samples[0]);
        assert_memory_equal(samples[0], samples[2], sizeof samples[0]);
    }
}

static void test_preset(void **unused)
{
    (void)unused;
    const imk_shell_gyro design = imk_shell_gyro_default();
    imk_model model;
    CHECK_OK(imk_shell_gyro_validate(&design, NULL));
    imk_instrument_reduce(shell, &design, &model);
    CHECK_OK(imk_model_validate(&model, NULL));
    imk_model_three_axes(&model);
    const imk_grade_result grade = imk_grade_model(&model);
    assert_int_equal(grade.gyro, IMK_GRADE_CONTROL);
    assert_non_null(strstr(imk_grade_table(grade.gyro)->gyro_technology, shell->technology));
    /* what the header says it was chosen for */
    const double degree = pi / 180.0;
    CHECK_RELATIVE(model.gyro.noise.white.value[0], 0.1 * degree / 60.0, 0.05);
    CHECK_RELATIVE(model.gyro.noise.bias_instability.value[0], 5.0 * degree / 3600.0, 0.05);
    CHECK_RELATIVE(model.gyro.bias.repeatability.value[0], 200.0 * degree / 3600.0, 0.05);
    CHECK_RELATIVE(model.gyro.bandwidth.value[0], 55.0, 0.05);
}

/* The example file is the design of these tests: the same error model, to rounding of its units. */
static void test_example_file(void **unused)
{
    (void)unused;
    imk_design_file file = {0};
    imk_model read, expected;
    const imk_shell_gyro design = hemispherical();
    CHECK_OK(
        imk_design_read(SOURCE_DIRECTORY "/examples/instruments/hemispherical.yaml", &file, NULL));
    assert_ptr_equal(file.instrument, shell);
    imk_instrument_reduce(shell, file.design, &read);
    imk_instrument_reduce(shell, &design, &expected);
    const imk_triad *a = &read.gyro, *b = &expected.gyro;
    CHECK_RELATIVE(a->bias.fixed.value[0], b->bias.fixed.value[0], 1e-9);
    CHECK_RELATIVE(a->bias.repeatability.value[0], b->bias.repeatability.value[0], 1e-12);
    CHECK_RELATIVE(a->scale_factor.fixed.value[0], b->scale_factor.fixed.value[0], 1e-8);
    CHECK_RELATIVE(a->noise.white.value[0], b->noise.white.value[0], 1e-12);
    CHECK_RELATIVE(a->noise.quantization.value[0], b->noise.quantization.value[0], 1e-12);
    CHECK_RELATIVE(a->misalignment.value[0][1], b->misalignment.value[0][1], 1e-9);
    imk_design_file_free(&file);
}

static void check_refused(const imk_shell_gyro *design, imk_status status, const char *field)
{
    imk_error error = {0};
    CHECK_STATUS(imk_shell_gyro_validate(design, &error), status);
    assert_string_equal(error.field, field);
}

static void test_refused_designs(void **unused)
{
    (void)unused;
    const imk_shell_gyro good = imk_shell_gyro_default();
    imk_shell_gyro design = good;
#define REFUSED(member, amount, status, field)                                                     \
    do {                                                                                           \
        design = good;                                                                             \
        design.member = (amount);                                                                  \
        check_refused(&design, status, field);                                                     \
    } while (0)
    REFUSED(cookie, 0, IMK_ERROR_UNINITIALISED, "design");
    REFUSED(resonator.mass, -1e-6, IMK_ERROR_RANGE, "resonator.mass");
    REFUSED(resonator.mass, (double)NAN, IMK_ERROR_NOT_FINITE, "resonator.mass");
    REFUSED(resonator.quality, 0.4, IMK_ERROR_RANGE, "resonator.quality");
    REFUSED(resonator.mode_number, 1, IMK_ERROR_RANGE, "resonator.mode_number");
    REFUSED(mode, (imk_shell_mode)3, IMK_ERROR_RANGE, "mode");
    REFUSED(pattern.amplitude, 0.0, IMK_ERROR_RANGE, "pattern.amplitude");
    REFUSED(anisotropy.damping_difference, 20.0, IMK_ERROR_CONFLICT,
            "anisotropy.damping_difference");
    REFUSED(anisotropy.frequency_split, 200.0, IMK_ERROR_CONFLICT, "anisotropy.frequency_split");
    REFUSED(control.cycles, 500, IMK_ERROR_CONFLICT, "control.cycles");
    REFUSED(control.rebalance_bandwidth, 400.0, IMK_ERROR_CONFLICT, "control.rebalance_bandwidth");
    REFUSED(control.support_bandwidth, 400.0, IMK_ERROR_CONFLICT, "control.support_bandwidth");
    REFUSED(forcer.limit, 1e-9, IMK_ERROR_CONFLICT, "forcer.limit");
    design = good;
    design.resonator.shape = IMK_SHELL_HEMISPHERE;
    design.resonator.mode_number = 3;
    check_refused(&design, IMK_ERROR_CONFLICT, "resonator.mode_number");
#undef REFUSED
}

static void check_not_started(const imk_shell_gyro *design, const imk_physics_settings *settings,
                              imk_status status, const char *field)
{
    imk_error error = {0};
    const size_t size = (shell->state_size + 63) / 64 * 64;
    void *state = aligned_alloc(64, size);
    assert_non_null(state);
    CHECK_STATUS(imk_instrument_init(shell, design, settings, state, &error), status);
    assert_string_equal(error.field, field);
    free(state);
}

static void test_refused_settings(void **unused)
{
    (void)unused;
    imk_shell_gyro design = imk_shell_gyro_default();
    imk_physics_settings settings = imk_physics_default();
    /* 14 kHz at 16 steps a cycle */
    CHECK_BELOW(shell->step_length(&design, &settings), 1.0 / (16.0 * 14000.0));
    settings.step = 1.0 / (15.0 * 14000.0);
    check_not_started(&design, &settings, IMK_ERROR_RANGE, "step");
    settings.step = 0.0;
    settings.level = IMK_LEVEL_SLOW;
    design.mode = IMK_SHELL_FREE;
    check_not_started(&design, &settings, IMK_ERROR_UNSUPPORTED, "level");
    design.mode = IMK_SHELL_WHOLE_ANGLE;
    settings.rate = 4000.0; /* updates come at 3.5 kHz */
    check_not_started(&design, &settings, IMK_ERROR_RANGE, "rate");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_closed_forms),
        cmocka_unit_test(test_damping_turns_a_free_pattern),
        cmocka_unit_test(test_free_pattern_keeps_its_integrals),
        cmocka_unit_test(test_split_opens_an_ellipse),
        cmocka_unit_test(test_rebalance_bias_and_force),
        cmocka_unit_test(test_quadrature_leaks_by_the_phase_error),
        cmocka_unit_test(test_error_model_of_a_ring),
        cmocka_unit_test(test_bandwidth),
        cmocka_unit_test(test_whole_angle_levels_agree),
        cmocka_unit_test(test_hemispherical_gyro),
        cmocka_unit_test(test_range),
        cmocka_unit_test(test_same_bits),
        cmocka_unit_test(test_preset),
        cmocka_unit_test(test_example_file),
        cmocka_unit_test(test_refused_designs),
        cmocka_unit_test(test_refused_settings),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
