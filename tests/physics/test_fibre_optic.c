/* SPDX-License-Identifier: Apache-2.0 */
/* The fibre-optic gyro: closed forms against published numbers and arithmetic done elsewhere, the
 * transit-by-transit dynamics against them, the slow level against both, and the error model
 * against all. Expected values without a source were computed by hand from the equation of the
 * header with c = 299792458 m/s. */
#define _POSIX_C_SOURCE 200809L /* setenv */
#include "instrument_run.h"

#include "imukit/distort.h"
#include "imukit/distributions.h"
#include "imukit/fibre_optic.h"

static const double pi = 3.14159265358979324;
static const double degree = 3.14159265358979324 / 180.0;
static const double degree_per_hour = 3.14159265358979324 / 180.0 / 3600.0;
static const imk_instrument *const fog = &imk_fibre_optic_instrument;

/* The coil of the check values: 1 km on 10 cm at 1550 nm, 40 uW on the detector, depth pi/2, and
 * nothing imperfect. */
static imk_fibre_optic ideal(void)
{
    imk_fibre_optic design = imk_fibre_optic_default();
    design.coil_diameter = 0.1;
    design.coil_attenuation = design.optics_loss = 0.0;
    design.source_power = 40e-6;
    design.visibility = 1.0;
    design.modulation_depth = 0.5 * pi;
    design.winding_residual = 0.0;
    design.coil_expansion = design.wavelength_temperature = 0.0;
    design.wavelength_repeatability = design.phase_repeatability = 0.0;
    design.phase_instability = design.phase_temperature = 0.0;
    design.ramp_bits = design.converter_bits = design.output_bits = 0;
    design.converter_range = 0.0;
    design.range = 265.0 * degree;
    return design;
}

static imk_fibre_optic ideal_open(void)
{
    imk_fibre_optic design = ideal();
    design.loop = IMK_FIBRE_OPTIC_OPEN;
    design.range = 66.0 * degree;
    return design;
}

static imk_physics_settings quiet(double rate)
{
    imk_physics_settings settings = imk_physics_default();
    settings.noise = false;
    settings.rate = rate;
    return settings;
}

static double reading(const imk_fibre_optic *design, const imk_physics_settings *settings,
                      imk_exposure exposure, size_t settle, size_t count)
{
    return mean_of(fog, design, settings, &exposure, settle, count, 0);
}

static imk_exposure turning(double rate)
{
    imk_exposure exposure = imk_exposure_default();
    exposure.angular_rate[0] = rate;
    return exposure;
}

/* Relative tolerances: half a unit of the last digit printed. */
static void test_closed_forms(void **state)
{
    (void)state;
    imk_fibre_optic design = ideal();
    const double scale = imk_fibre_optic_scale(&design);
    CHECK_CLOSE(scale, 1.352158, 5e-7);
    CHECK_CLOSE(0.5 * imk_fibre_optic_fringe_rate(&design) / degree, 133.12, 5e-3);
    CHECK_CLOSE(scale * 7.292115e-5, 98.601e-6, 5e-10);
    CHECK_CLOSE(imk_fibre_optic_proper_frequency(&design), 103377.0, 0.5);
    CHECK_CLOSE(imk_fibre_optic_reset_angle(&design) / degree * 3600.0, 4.6358, 5e-5);
    CHECK_CLOSE(degree / imk_fibre_optic_reset_angle(&design), 776.56, 5e-3);
    CHECK_CLOSE(1e-6 / scale / degree_per_hour, 0.15254, 5e-6);
    CHECK_CLOSE(imk_fibre_optic_turns(&design), 3183.1, 0.05);
    CHECK_CLOSE(imk_fibre_optic_loop_pole(&design), 1733.5, 0.05);
    design.loop_gain = 1e-6; /* g -> 0: g/(4 pi tau) of g = 0.1 is 1645 Hz */
    CHECK_CLOSE(imk_fibre_optic_loop_pole(&design) * 1e5, 1645.0, 0.5);
    CHECK_RELATIVE(imk_fibre_optic_bandwidth(&design), imk_fibre_optic_loop_pole(&design), 1e-6);
    /* the angle between resets is the fringe rate times the transit time */
    CHECK_RELATIVE(imk_fibre_optic_reset_angle(&design),
                   imk_fibre_optic_fringe_rate(&design) * imk_fibre_optic_transit_time(&design),
                   1e-14);
}

static void test_shupe(void **state)
{
    (void)state;
    imk_fibre_optic design = ideal();
    const double half[] = {1e-3, 0.0}, even[] = {1e-3, 1e-3}, quarters[] = {1e-3, 1e-3, 0, 0};
    CHECK_CLOSE(imk_fibre_optic_shupe_rate(&design, 2, half) / degree_per_hour, 7.477, 5e-4);
    CHECK_CLOSE(imk_fibre_optic_shupe_rate(&design, 2, even), 0.0, 1e-18);
    CHECK_RELATIVE(imk_fibre_optic_shupe_rate(&design, 4, quarters),
                   imk_fibre_optic_shupe_rate(&design, 2, half), 1e-14);
    design.winding_residual = 1.0;
    CHECK_RELATIVE(imk_fibre_optic_shupe_coefficient(&design) * 1e-3,
                   imk_fibre_optic_shupe_rate(&design, 2, half), 1e-14);
}

/* Shot noise alone, then all three against the form with the cotangent. */
static void test_noise_formula(void **state)
{
    (void)state;
    const double q = 1.602176634e-19, k = 1.380649e-23;
    imk_fibre_optic design = ideal();
    design.intensity_noise = 1e-30;
    design.load_resistance = 1e12;
    CHECK_CLOSE(imk_fibre_optic_angle_random_walk(&design) / degree * 60.0, 2.399e-4, 5e-8);
    design.load_resistance = 5e4;
    design.intensity_noise = 3e-13;
    for (int i = 1; i < 6; i++) {
        const double b = design.modulation_depth = 0.5 * i;
        const double power = 20e-6 * (1.0 + cos(b)), current = 0.9 * power;
        const double expected =
            sqrt(2.0 * q / current + 3e-13 + 4.0 * k * 293.15 / (5e4 * current * current)) /
            tan(0.5 * b);
        CHECK_RELATIVE(imk_fibre_optic_phase_noise(&design), expected, 1e-13);
    }
    /* 1 nm at 1550 nm is 124.78 GHz */
    design.intensity_noise = 0.0;
    design.linewidth = 1e-9;
    CHECK_RELATIVE(imk_fibre_optic_intensity_noise(&design), 2.0 / 124.7835e9, 1e-6);
}

/* A sample of 2 tau: each is one update of the loop. The error decays by 1 - g per update, to
 * sin x = x (1 - x^2/6) at x below 1e-5. */
static void test_loop_pole(void **state)
{
    (void)state;
    const imk_fibre_optic design = ideal();
    const imk_physics_settings settings = quiet(imk_fibre_optic_proper_frequency(&design));
    const imk_exposure exposure = turning(1e-5 / imk_fibre_optic_scale(&design));
    double signals[IMK_INSTRUMENT_SIGNALS_MAX];
    void *gyro = started(fog, &design, &settings);
    run(fog, gyro, &exposure, 4, 0, NULL);
    fog->observe(gyro, signals);
    const double before = signals[2];
    run(fog, gyro, &exposure, 20, 0, NULL);
    fog->observe(gyro, signals);
    assert_true(before > 1e-6);
    CHECK_RELATIVE(signals[2] / before, pow(0.9, 20), 1e-8);
    free(gyro);
}

/* The stated -3 dB point is the loop's; holding the input for a sample adds 0.2 %. */
static void test_bandwidth(void **state)
{
    (void)state;
    imk_fibre_optic design = ideal();
    for (int level = 0; level < 2; level++) {
        imk_physics_settings settings = quiet(60000.0);
        settings.level = level ? IMK_LEVEL_SLOW : IMK_LEVEL_FULL;
        const double gain = sine_gain(fog, &design, &settings, 0.01,
                                      imk_fibre_optic_bandwidth(&design), 2000, 100, NULL);
        CHECK_RELATIVE(gain, sqrt(0.5), 6e-3);
    }
    /* a fast loop still has its -3 dB point; one with g = 0.9 has none */
    design.loop_gain = 0.9;
    CHECK_CLOSE(imk_fibre_optic_bandwidth(&design), 0.0, 0.0);
}

/* Switched on at 300 deg/s the loop finds the nearest fringe, 266.24 deg/s low. */
static void test_wrong_fringe(void **state)
{
    (void)state;
    const imk_fibre_optic design = ideal();
    for (int level = 0; level < 2; level++) {
        imk_physics_settings settings = quiet(100.0);
        settings.level = level ? IMK_LEVEL_SLOW : IMK_LEVEL_FULL;
        CHECK_CLOSE(reading(&design, &settings, turning(300.0 * degree), 10, 10) / degree,
                    300.0 - 266.24, 5e-3);
        CHECK_CLOSE(reading(&design, &settings, turning(100.0 * degree), 10, 10) / degree, 100.0,
                    1e-6);
    }
}

/* Beyond its range the gyro reads the end of it. An amplifier that saturates at a fortieth of the
 * fringe slows the lock from 2.4 rad down (0.0025 rad per update), and changes nothing else. */
static void test_saturation(void **state)
{
    (void)state;
    imk_fibre_optic design = ideal();
    design.converter_range = 0.5e-6;
    const imk_physics_settings settings = quiet(100.0);
    CHECK_CLOSE(reading(&design, &settings, turning(100.0 * degree), 0, 1) / degree, 54.0, 6.0);
    CHECK_CLOSE(reading(&design, &settings, turning(100.0 * degree), 10, 10) / degree, 100.0, 1e-6);
    design.range = 80.0 * degree;
    for (int level = 0; level < 2; level++) {
        imk_physics_settings limited = settings;
        limited.level = level ? IMK_LEVEL_SLOW : IMK_LEVEL_FULL;
        CHECK_CLOSE(reading(&design, &limited, turning(-100.0 * degree), 10, 10) / degree, -80.0,
                    1e-9);
    }
}

/* Resets come at W/(angle of a reset); in 0.5 s one may be missing. */
static void test_resets(void **state)
{
    (void)state;
    const imk_fibre_optic design = ideal();
    const imk_physics_settings settings = quiet(1000.0);
    const imk_exposure exposure = turning(-10.0 * degree);
    const double resets = mean_of(fog, &design, &settings, &exposure, 10, 500, 1);
    CHECK_CLOSE(resets, 7765.6, 2.1);
}

/* A wrong half-wave voltage leaves the mean reading alone, since each reset takes back what the
 * steps had too much; a wrong reset is a scale-factor error. Third order of the glitch of 2 pi 0.01
 * at a reset: 0.063^2/6 of its effect of 1 %, 7 ppm; unfinished fringes: 1 % of 1/40000. */
static void test_ramp_errors(void **state)
{
    (void)state;
    imk_fibre_optic design = ideal();
    const imk_physics_settings settings = quiet(100.0);
    design.gain_error = 0.01;
    const double rate = 100.0 * degree;
    CHECK_RELATIVE(reading(&design, &settings, turning(rate), 10, 50), rate, 1e-5);
    design.gain_error = 0.0;
    design.reset_error = 1e-3;
    imk_model *model = malloc(sizeof *model);
    assert_non_null(model);
    imk_fibre_optic_reduce(&design, model);
    CHECK_CLOSE(model->gyro.scale_factor.fixed.value[0], 1e-3, 1e-15);
    CHECK_RELATIVE(reading(&design, &settings, turning(rate), 10, 50), rate * 1.001, 1e-6);
    /* the converter of the ramp has no dead zone: 1e-3 of its step per transit is read */
    design.reset_error = 0.0;
    design.ramp_bits = 10;
    const double slow = 2.0 * pi / 1024.0 * 1e-3 / imk_fibre_optic_scale(&design);
    CHECK_RELATIVE(reading(&design, &settings, turning(slow), 10, 100), slow, 0.02);
    free(model);
}

/* Both levels, both loops, against the error model, at 45 degC, warming. The model leaves out the
 * second order of the departures, (1.3e-4)^2 of 0.02 rad/s, and of the open loop what the cubic
 * does to the bias of 4e-5 rad/s: (K 0.02)^2/2 of it, 1.5e-8 rad/s. */
static void test_reduced_terms(void **state)
{
    (void)state;
    imk_model *model = malloc(sizeof *model);
    imk_error error;
    assert_non_null(model);
    for (int form = 0; form < 4; form++) {
        imk_fibre_optic design = form & 2 ? ideal_open() : ideal();
        design.wavelength_error = 100e-6;
        design.wavelength_temperature = 5e-6;
        design.coil_expansion = 1e-6;
        design.winding_residual = 0.1;
        design.phase_fixed = 3e-6;
        design.phase_temperature = 1e-7;
        design.power_error = form & 2 ? 0.03 : 0.0;
        design.depth_error = form & 2 ? 0.02 : 0.0;
        design.demodulation_error = form & 2 ? -0.01 : 0.0;
        imk_fibre_optic_reduce(&design, model);
        CHECK_OK(imk_model_validate(model, &error));
        imk_exposure exposure = turning(0.02);
        exposure.temperature = 318.15;
        exposure.temperature_rate = 0.01;
        imk_distortion distortion;
        double expected;
        const double *const rate[] = {&exposure.angular_rate[0], &exposure.angular_rate[1],
                                      &exposure.angular_rate[2]};
        imk_stimulus stimulus = {.temperature = &exposure.temperature,
                                 .temperature_rate = &exposure.temperature_rate};
        for (int i = 0; i < 3; i++)
            stimulus.angular_rate[i] = rate[i];
        CHECK_OK(imk_distortion_start(&distortion, model, NULL, IMK_KERNEL_SCALAR, &error));
        imk_distort(&distortion, IMK_GYRO, 0, &stimulus, 1, &expected);
        imk_physics_settings settings = quiet(100.0);
        settings.level = form & 1 ? IMK_LEVEL_SLOW : IMK_LEVEL_FULL;
        const double actual = reading(&design, &settings, exposure, 10, 20);
        assert_true(fabs(expected - 0.02) > 1e-6);
        CHECK_CLOSE(actual, expected, form & 2 ? 2e-8 : 1e-9);
    }
    free(model);
}

/* sin(K W)/K: -1666 ppm at 0.1 rad, and the cubic of the error model within x^5/120. */
static void test_open_loop(void **state)
{
    (void)state;
    const imk_fibre_optic design = ideal_open();
    const imk_physics_settings settings = quiet(1000.0);
    const double scale = imk_fibre_optic_scale(&design);
    imk_model *model = malloc(sizeof *model);
    assert_non_null(model);
    imk_fibre_optic_reduce(&design, model);
    const double k3 = model->gyro.nonlinearity.k3.value[0];
    CHECK_CLOSE(reading(&design, &settings, turning(0.1 / scale), 2, 4) * scale / 0.1 - 1.0,
                -1666e-6, 5e-7);
    for (int i = -3; i <= 3; i++) {
        const double rate = 0.1 * i / scale;
        const double actual = reading(&design, &settings, turning(rate), 2, 4);
        CHECK_CLOSE(actual * scale, sin(0.1 * i), 1e-9); /* J15 of the 16 instants */
        CHECK_CLOSE(actual, rate + k3 * rate * rate * rate,
                    pow(fabs(0.1 * i), 5) / 110.0 / scale + 1e-9);
    }
    free(model);
}

/* Crosstalk of 1 mrad: nothing is read below 1 mrad/K, and the square root of the squares'
 * difference above, to some percent: the loop's lag against the ramp, and unfinished fringes. */
static void test_dead_zone(void **state)
{
    (void)state;
    imk_fibre_optic design = ideal();
    design.crosstalk = 1e-3;
    imk_model *model = malloc(sizeof *model);
    assert_non_null(model);
    imk_fibre_optic_reduce(&design, model);
    const double dead = model->gyro.dead_band.value[0];
    CHECK_RELATIVE(dead, 1e-3 / imk_fibre_optic_scale(&design), 1e-14);
    for (int level = 0; level < 2; level++) {
        imk_physics_settings settings = quiet(100.0);
        settings.level = level ? IMK_LEVEL_SLOW : IMK_LEVEL_FULL;
        CHECK_CLOSE(reading(&design, &settings, turning(0.7 * dead), 10, 20), 0.0, 1e-6 * dead);
        CHECK_RELATIVE(reading(&design, &settings, turning(2.0 * dead), 10, 100), sqrt(3.0) * dead,
                       0.02);
    }
    free(model);
}

/* Angle does not depend on where samples end: 0.02 s at 1 kHz, or at 999 983 Hz where samples end
 * within transits. The loops see the same phase throughout; rounding of 20000 sums, and the last
 * sample's end of 1e-6 s. */
static void test_sample_ends(void **state)
{
    (void)state;
    const imk_fibre_optic design = ideal();
    const imk_physics_settings coarse = quiet(1000.0), fine = quiet(999983.0);
    const imk_exposure exposure = turning(0.5);
    const double one = mean_of(fog, &design, &coarse, &exposure, 0, 20, 0) * 0.02;
    const double many = mean_of(fog, &design, &fine, &exposure, 0, 20000, 0) * 20000.0 / 999983.0;
    CHECK_CLOSE(many - 0.5 * 20000.0 / 999983.0, one - 0.5 * 0.02, 1e-9);
}

/* Mean square of the differences of neighbouring samples against the exact Allan variance of white
 * noise through the loop, half of it. 20000 differences of noise with neighbours correlated by 1/2
 * have a relative deviation of at most sqrt(3/20000) = 1.2 %: 5 sigma is 6 %. */
static void check_noise(const imk_fibre_optic *design, imk_level level, double rate)
{
    enum { COUNT = 20000 };
    imk_physics_settings settings = imk_physics_default();
    settings.rate = rate;
    settings.level = level;
    settings.seed = 7;
    double *samples = malloc(COUNT * sizeof *samples), sum = 0.0;
    assert_non_null(samples);
    void *gyro = started(fog, design, &settings);
    const imk_exposure exposure = imk_exposure_default();
    run(fog, gyro, &exposure, 200, 0, NULL);
    run(fog, gyro, &exposure, COUNT, 0, samples);
    for (int i = 1; i < COUNT; i++)
        sum += (samples[i] - samples[i - 1]) * (samples[i] - samples[i - 1]);
    const bool open = design->loop == IMK_FIBRE_OPTIC_OPEN;
    const double density = imk_fibre_optic_angle_random_walk(design) *
                           (open ? imk_fibre_optic_harmonic_gain(design) : 1.0);
    const imk_low_pass filter = {imk_fibre_optic_bandwidth(design), 0.0};
    const double expected =
        imk_filtered_white_sampled_allan_variance(density, filter, 1.0 / rate, 1);
    CHECK_RELATIVE(sum / (2.0 * (COUNT - 1)), expected, 0.06);
    free(gyro);
    free(samples);
}

static void test_noise(void **state)
{
    (void)state;
    imk_fibre_optic design = ideal();
    design.load_resistance = 3000.0; /* a third of the variance */
    design.linewidth = 1e-7;         /* intensity noise like shot noise */
    design.converter_range = 2e-6;
    design.converter_bits = 11;
    CHECK_OK(imk_fibre_optic_validate(&design, NULL));
    check_noise(&design, IMK_LEVEL_FULL, 2000.0);
    check_noise(&design, IMK_LEVEL_SLOW, 2000.0);
    design.modulation_depth = 2.5;
    check_noise(&design, IMK_LEVEL_FULL, 5000.0);
    imk_fibre_optic open = ideal_open();
    open.intensity_noise = 1e-13;
    open.modulation_depth = 2.0;
    open.power_error = 0.2;
    open.converter_range = 50e-6;
    open.converter_bits = 16;
    CHECK_OK(imk_fibre_optic_validate(&open, NULL));
    check_noise(&open, IMK_LEVEL_FULL, 2000.0); /* a reading is held for 1/50 of a sample */
    check_noise(&open, IMK_LEVEL_SLOW, 2000.0);
}

/* The default's constants of the run: 400 runs, phases of N(0, repeatability) and wavelengths;
 * variance by chi-square at 1e-6. A sample of 1000 s has no noise to speak of (0.4 % of the
 * variance). */
static void test_repeatability(void **state)
{
    (void)state;
    enum { RUNS = 400 };
    imk_fibre_optic design = imk_fibre_optic_default();
    design.phase_instability = 0.0;
    design.output_bits = 0;
    imk_physics_settings settings = imk_physics_default();
    settings.rate = 1e-3;
    settings.level = IMK_LEVEL_SLOW;
    imk_model *model = malloc(sizeof *model);
    assert_non_null(model);
    imk_fibre_optic_reduce(&design, model);
    double bias = 0.0, scale = 0.0;
    for (uint32_t i = 0; i < RUNS; i++) {
        settings.run = i;
        const double still = reading(&design, &settings, turning(0.0), 1, 1);
        const double fast = reading(&design, &settings, turning(0.5), 1, 1);
        bias += still * still;
        scale += (fast - still - 0.5) * (fast - still - 0.5) / 0.25;
    }
    const double low = imk_chi_square_quantile(5e-7, RUNS) / RUNS,
                 high = imk_chi_square_quantile(1.0 - 5e-7, RUNS) / RUNS;
    const double bias_ratio = bias / RUNS / pow(model->gyro.bias.repeatability.value[0], 2);
    const double scale_ratio =
        scale / RUNS / pow(model->gyro.scale_factor.repeatability.value[0], 2);
    assert_true(bias_ratio > low && bias_ratio < high * 1.01);
    assert_true(scale_ratio > low && scale_ratio < high * 1.01);
    free(model);
}

/* The default design as it is. */
static void test_preset(void **state)
{
    (void)state;
    const imk_fibre_optic design = imk_fibre_optic_default();
    imk_model *model = malloc(sizeof *model);
    imk_error error;
    assert_non_null(model);
    CHECK_OK(imk_fibre_optic_validate(&design, &error));
    CHECK_RELATIVE(imk_fibre_optic_angle_random_walk(&design) / degree * 60.0, 3.2e-4, 5e-3);
    /* 14 dB of 1 mW */
    CHECK_RELATIVE(imk_fibre_optic_detector_power(&design), 39.81e-6, 1e-4);
    imk_fibre_optic_reduce(&design, model);
    CHECK_OK(imk_model_validate(model, &error));
    imk_model_three_axes(model);
    CHECK_OK(imk_model_validate(model, &error));
    const imk_grade_result grade = imk_grade_model(model);
    assert_int_equal(grade.gyro, IMK_GRADE_TACTICAL);
    assert_non_null(strstr(imk_grade_table(grade.gyro)->gyro_technology, fog->technology));
    free(model);
}

/* Design -> log -> identification. At 200 Hz the noise of a sample is as large as a count of the
 * angle, so that the counts' rounding is white; the loop's pole is far beyond. */
static void test_chain(void **state)
{
    (void)state;
    imk_fibre_optic design = imk_fibre_optic_default();
    imk_physics_settings settings = imk_physics_default();
    const imk_exposure exposure = turning(0.1);
    settings.rate = 200.0;
    settings.seed = 3;
    check_chain(fog, &design, &settings, &exposure, 100, 8000);
    settings.level = IMK_LEVEL_SLOW;
    design.phase_instability = 3e-6; /* 0.15 deg/h: seen within minutes */
    check_chain(fog, &design, &settings, &exposure, 100, 40000);
}

static void test_same_bits(void **state)
{
    (void)state;
    enum { COUNT = 400 };
    const imk_fibre_optic design = imk_fibre_optic_default();
    imk_physics_settings settings = imk_physics_default();
    settings.rate = 3333.0;
    const imk_exposure exposure = turning(0.3);
    double first[COUNT], second[COUNT];
    void *gyro = started(fog, &design, &settings), *copy = started(fog, &design, &settings);
    run(fog, gyro, &exposure, 77, 0, NULL);
    memcpy(copy, gyro, fog->state_size);
    run(fog, gyro, &exposure, COUNT, 0, first);
    run(fog, copy, &exposure, COUNT, 0, second);
    assert_memory_equal(first, second, sizeof first);
    free(copy);
    assert_int_equal(setenv("IMUKIT_ISA", "scalar", 1), 0);
    copy = started(fog, &design, &settings);
    unsetenv("IMUKIT_ISA");
    run(fog, copy, &exposure, 77, 0, NULL);
    run(fog, copy, &exposure, COUNT, 0, second);
    assert_memory_equal(first, second, sizeof first);
    free(copy);
    free(gyro);
}

static void check_refused(const imk_fibre_optic *design, imk_status status, const char *field)
{
    imk_error error;
    CHECK_STATUS(imk_fibre_optic_validate(design, &error), status);
    assert_string_equal(error.field, field);
    assert_true(error.expected[0] != '\0' || status == IMK_ERROR_NOT_FINITE);
}

static void test_refusals(void **state)
{
    (void)state;
    imk_fibre_optic design = {0};
    CHECK_STATUS(imk_fibre_optic_validate(&design, NULL), IMK_ERROR_UNINITIALISED);
    design = ideal();
    design.coil_length = 0.3;
    check_refused(&design, IMK_ERROR_CONFLICT, "coil.length");
    design.coil_length = (double)NAN;
    check_refused(&design, IMK_ERROR_NOT_FINITE, "coil.length");
    design = ideal();
    design.modulation_depth = 3.2;
    check_refused(&design, IMK_ERROR_RANGE, "modulator.depth");
    design = ideal();
    design.loop_gain = 1.5;
    design.demodulation_error = 0.5;
    check_refused(&design, IMK_ERROR_CONFLICT, "loop.gain");
    design = ideal();
    design.range = 267.0 * degree;
    check_refused(&design, IMK_ERROR_CONFLICT, "loop.range");
    design = ideal_open();
    design.range = 67.0 * degree;
    check_refused(&design, IMK_ERROR_CONFLICT, "loop.range");
    design = ideal_open();
    design.converter_range = 5e-6; /* the harmonic reaches 22 uW */
    design.converter_bits = 16;
    check_refused(&design, IMK_ERROR_CONFLICT, "detector.converter_range");
    design = ideal();
    design.source_power = 1e-12;
    check_refused(&design, IMK_ERROR_CONFLICT, "source.power");
    design = ideal();
    design.converter_range = 10e-6;
    design.converter_bits = 6;
    check_refused(&design, IMK_ERROR_CONFLICT, "detector.converter_bits");
    design.converter_range = 0.0;
    check_refused(&design, IMK_ERROR_CONFLICT, "detector.converter_range");
    design = ideal();
    design.linewidth = 2e-6;
    check_refused(&design, IMK_ERROR_CONFLICT, "source.linewidth");

    design = ideal();
    imk_physics_settings settings = imk_physics_default();
    imk_error error;
    void *gyro = started(fog, &design, &settings);
    settings.step = 5e-6; /* the transit takes 4.84 us */
    CHECK_STATUS(imk_instrument_init(fog, &design, &settings, gyro, &error), IMK_ERROR_RANGE);
    assert_string_equal(error.field, "step");
    settings.step = 4e-6;
    CHECK_OK(imk_instrument_init(fog, &design, &settings, gyro, &error));
    settings.rate = 0.0;
    CHECK_STATUS(imk_instrument_init(fog, &design, &settings, gyro, &error), IMK_ERROR_RANGE);
    free(gyro);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_closed_forms),  cmocka_unit_test(test_shupe),
        cmocka_unit_test(test_noise_formula), cmocka_unit_test(test_loop_pole),
        cmocka_unit_test(test_bandwidth),     cmocka_unit_test(test_wrong_fringe),
        cmocka_unit_test(test_saturation),    cmocka_unit_test(test_resets),
        cmocka_unit_test(test_ramp_errors),   cmocka_unit_test(test_reduced_terms),
        cmocka_unit_test(test_open_loop),     cmocka_unit_test(test_dead_zone),
        cmocka_unit_test(test_sample_ends),   cmocka_unit_test(test_noise),
        cmocka_unit_test(test_repeatability), cmocka_unit_test(test_preset),
        cmocka_unit_test(test_chain),         cmocka_unit_test(test_same_bits),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
