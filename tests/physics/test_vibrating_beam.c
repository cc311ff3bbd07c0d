/* SPDX-License-Identifier: Apache-2.0 */
/* The vibrating beam accelerometer: check values, levels, chain, limits. */
#include "instrument_run.h"

#include "imukit/units.h"
#include "imukit/vibrating_beam.h"
#include "physics/vibrating_beam/vibrating_beam_internal.h"

#define G IMK_STANDARD_GRAVITY
static const imk_instrument *const beam = &imk_vibrating_beam_instrument;

/* Without anything but the beams. */
static imk_vibrating_beam plain(void)
{
    imk_vibrating_beam d = imk_vibrating_beam_default();
    d.mount_force = d.frequency_mismatch = d.temperature_mismatch = d.clock = 0.0;
    return d;
}

static imk_physics_settings quiet(double rate)
{
    imk_physics_settings settings = imk_physics_default();
    settings.rate = rate;
    settings.noise = false;
    return settings;
}

static imk_exposure force_of(double force)
{
    imk_exposure exposure = imk_exposure_default();
    exposure.specific_force[0] = force;
    return exposure;
}

static void the_default_has_its_figures(void **state)
{
    (void)state;
    const imk_vibrating_beam d = imk_vibrating_beam_default();
    imk_error error;
    CHECK_OK(imk_vibrating_beam_validate(&d, &error));
    CHECK_RELATIVE(imk_vibrating_beam_frequency(&d, 0), 40000.0, 1e-12);
    CHECK_RELATIVE(imk_vibrating_beam_slope(&d) * G, 80.0, 1e-12);
    /* the textbook's rounded coefficient, f^2 = f0^2 (1 + 0.02458 N L^2/(E I)) */
    const double stiffness = d.modulus * d.width * pow(d.thickness, 3.0) / 12.0;
    CHECK_RELATIVE(imk_vibrating_beam_stiffening(&d),
                   0.02458 * 40000.0 * 40000.0 * d.length * d.length / stiffness, 2e-4);
}

/* The exact frequency of a clamped beam under tension, by the determinant of its end conditions:
 * the law of squares is its tangent at no force. */
static double exact_ratio(double tension) /* N L^2/(E I) */
{
    double low = 4.0, high = 6.0;
    for (int i = 0; i < 100; i++) {
        const double k = 0.5 * (low + high); /* (w/w0)^2 x1^4 = k^4 */
        const double half = 0.5 * tension, root = sqrt(half * half + k * k * k * k);
        const double a = sqrt(root + half), b = sqrt(root - half);
        /* 2 a b (cosh a cos b - 1) - (a^2 - b^2) sinh a sin b = 0: 2 (1 - cosh a cos b) + … */
        const double value =
            2.0 * (1.0 - cosh(a) * cos(b)) + (a * a - b * b) / (a * b) * sinh(a) * sin(b);
        if (value > 0.0)
            low = k;
        else
            high = k;
    }
    const double k = 0.5 * (low + high) / 4.730040744862704;
    return k * k * k * k;
}

static void the_law_of_squares_is_a_clamped_beam(void **state)
{
    (void)state;
    /* second order in the tension: 1e-5 of it at N L^2/(E I) = 0.1 and a curvature of 1e-5 */
    for (int i = -4; i <= 4; i++) {
        const double tension = 0.05 * i;
        CHECK_CLOSE(exact_ratio(tension) - 1.0, 0.0245775186348646 * tension,
                    2e-5 * tension * tension + 1e-12);
    }
}

/* The mass that moves with the middle: of the mode cosh k x - cos k x - s (sinh k x - sin k x) of a
 * clamped beam, by Simpson's rule. */
static void the_modal_mass_is_that_of_the_shape(void **state)
{
    (void)state;
    const double k = 4.730040744862704, s = (cosh(k) - cos(k)) / (sinh(k) - sin(k));
    enum { PARTS = 1000 };
    double sum = 0.0, middle = 0.0;
    for (int i = 0; i <= PARTS; i++) {
        const double x = k * i / PARTS;
        const double shape = cosh(x) - cos(x) - s * (sinh(x) - sin(x));
        sum += (i == 0 || i == PARTS ? 1.0 : i % 2 ? 4.0 : 2.0) * shape * shape / (3.0 * PARTS);
        middle = i == PARTS / 2 ? shape : middle;
    }
    const imk_vibrating_beam d = plain();
    const double mass = d.density * d.length * d.width * d.thickness;
    CHECK_RELATIVE(imki_beam_mass(&d), mass * sum / (middle * middle), 1e-9);
}

/* 40 kHz, 80 Hz/g, +-50 g: a pair read by the difference of its frequencies deviates by 5090 ppm of
 * full scale from the slope at no force and by 2051 ppm from the best line; by squares not at all.
 */
static void nonlinearity_of_a_pair(void **state)
{
    (void)state;
    imk_vibrating_beam d = plain();
    const double full = 50.0 * G;
    d.readout = IMK_BEAM_FREQUENCIES;
    CHECK_CLOSE((imk_vibrating_beam_reading(&d, full) / full - 1.0) * 1e6, 5090.0, 0.5);
    /* the least-squares line over +-50 g, 2001 points: its largest distance is at the ends. (The
     * line of least largest distance comes within 1278 ppm.) */
    double product = 0.0, square = 0.0;
    for (int i = -1000; i <= 1000; i++) {
        const double f = full * i / 1000.0;
        product += f * imk_vibrating_beam_reading(&d, f);
        square += f * f;
    }
    const double end = imk_vibrating_beam_reading(&d, full) - product / square * full;
    CHECK_CLOSE(end / full * 1e6, 2051.0, 4.0);
    d.readout = IMK_BEAM_SQUARES;
    CHECK_CLOSE(imk_vibrating_beam_reading(&d, full) / full - 1.0, 0.0, 1e-13);
}

/* A single beam read by frequency: 1000 ug/g^2 of rectification; by squares none. By the full
 * dynamics at 20 Hz, 10 g rms, which the suspension of 1500 Hz amplifies by 2 (f/fs)^2, 0.04 %, and
 * the law's third order by 3/4 … of (2 s A/f0)^2, 0.2 %. */
static void a_single_beam_rectifies(void **state)
{
    (void)state;
    imk_vibrating_beam d = plain();
    d.arrangement = IMK_BEAM_SINGLE;
    const double amplitude = 10.0 * G * sqrt(2.0), rate = 640.0;
    for (int readout = 0; readout < 2; readout++) {
        double sum = 0.0, outputs[IMK_INSTRUMENT_OUTPUTS_MAX];
        const imk_physics_settings settings = quiet(rate);
        d.readout = readout;
        void *run_state = started(beam, &d, &settings);
        for (int i = 0; i < 96; i++) {
            const imk_exposure exposure =
                force_of(amplitude * cos(2.0 * 3.14159265358979324 * (i + 0.5) / 32.0));
            beam->step(run_state, &exposure, outputs);
            if (i >= 32)
                sum += outputs[0] / 64.0;
        }
        free(run_state);
        /* counting from crossing to crossing leaves 1/(cycles of a sample) of the change from one
         * sample to the next, which sums to the ends of the interval */
        CHECK_CLOSE(sum / (1e-3 * G), readout == IMK_BEAM_SQUARES ? 0.0 : -100.0, 3.0);
    }
}

static void constant_forces_are_read_exactly(void **state)
{
    (void)state;
    for (int readout = 0; readout < 2; readout++)
        for (int arrangement = 0; arrangement < 2; arrangement++)
            for (int level = 0; level < 2; level++) {
                imk_vibrating_beam d = plain();
                imk_physics_settings settings = quiet(100.0);
                const imk_exposure exposure = force_of(-312.5);
                d.readout = readout;
                d.arrangement = arrangement;
                settings.level = (imk_level)level;
                /* crossings are placed by an arc tangent: 1e-16 cycles of 400 */
                CHECK_RELATIVE(mean_of(beam, &d, &settings, &exposure, 5, 5, 0),
                               imk_vibrating_beam_reading(&d, -312.5), 1e-10);
            }
}

/* The drive pulls the amplitude back in 50 cycles: a rotation that lost a part q of it in a cycle
 * would leave it 50 q small, so that 1e-12 here is less than 1e-13 a cycle. */
static void rotations_keep_the_energy(void **state)
{
    (void)state;
    imk_vibrating_beam d = plain();
    const imk_physics_settings settings = quiet(1000.0);
    void *run_state = started(beam, &d, &settings);
    const imk_exposure exposure = force_of(0.0);
    double signals[5];
    run(beam, run_state, &exposure, 25000, 0, NULL); /* a million cycles */
    beam->observe(run_state, signals);
    CHECK_RELATIVE(signals[3], d.amplitude, 1e-12);
    free(run_state);
}

static void terms_are_as_reduced(void **state)
{
    (void)state;
    imk_model *model = malloc(sizeof *model);
    imk_error error;
    for (int readout = 0; readout < 2; readout++)
        for (int arrangement = 0; arrangement < 2; arrangement++) {
            imk_vibrating_beam d = imk_vibrating_beam_default();
            d.readout = readout;
            d.arrangement = arrangement;
            d.clock = 0.0;
            d.proof_mass_error = 3e-4;
            d.mount_force = 0.0;
            imk_vibrating_beam_reduce(&d, model);
            CHECK_OK(imk_model_validate(model, &error));
            const imk_triad *t = &model->accel;
            const imk_physics_settings settings = quiet(100.0);
            for (int i = -2; i <= 2; i++) {
                const imk_exposure exposure = force_of(100.0 * i);
                const double f = 100.0 * i, x = 0.0408 * f / 100.0;
                const double expected = f * (1.0 + t->scale_factor.fixed.value[0]) +
                                        t->nonlinearity.k2.value[0] * f * f +
                                        t->nonlinearity.k3.value[0] * f * f * f;
                /* sqrt(1 + x): 5/128 x^4 f0/slope, and the scale error's share of K2 */
                const double tolerance = readout == IMK_BEAM_SQUARES
                                             ? 1e-9
                                             : 0.05 * x * x * x * x * 4903.0 + 1e-7 * f * f;
                CHECK_CLOSE(mean_of(beam, &d, &settings, &exposure, 5, 5, 0), expected, tolerance);
            }
            imk_exposure exposure = force_of(0.0);
            exposure.temperature = d.temperature + 5.0;
            /* sqrt(1 - 1e-4) is a line within 2.5e-5 of the change */
            CHECK_CLOSE(mean_of(beam, &d, &settings, &exposure, 5, 5, 0),
                        5.0 * t->bias.temperature.coefficient[0].value[0], 1e-5);
        }
    /* the mount acts like a force */
    imk_vibrating_beam d = imk_vibrating_beam_default();
    const imk_physics_settings settings = quiet(100.0);
    const imk_exposure exposure = force_of(0.0);
    d.clock = 0.0;
    imk_vibrating_beam_reduce(&d, model);
    CHECK_RELATIVE(mean_of(beam, &d, &settings, &exposure, 5, 5, 0),
                   model->accel.bias.fixed.value[0], 1e-6);
    free(model);
}

/* A pair tells its temperature. */
static void the_sum_is_a_thermometer(void **state)
{
    (void)state;
    imk_vibrating_beam d = plain();
    const imk_physics_settings settings = quiet(100.0);
    imk_exposure exposure = force_of(200.0);
    exposure.temperature = d.temperature + 17.0;
    CHECK_CLOSE(mean_of(beam, &d, &settings, &exposure, 5, 5, 3), d.temperature + 17.0, 1e-4);
}

/* Sines: the suspension, and the counting, which takes the mean over the sample. */
static void levels_agree_in_frequency(void **state)
{
    (void)state;
    imk_vibrating_beam d = plain();
    d.suspension_frequency = 100.0;
    const double frequencies[] = {5.0, 50.0, 100.0, 160.0};
    for (int level = 0; level < 2; level++)
        for (int i = 0; i < 4; i++) {
            imk_physics_settings settings = quiet(4000.0);
            settings.level = (imk_level)level;
            const double gain =
                sine_gain(beam, &d, &settings, 50.0, frequencies[i], 2000, 10, NULL);
            const double r = frequencies[i] / d.suspension_frequency;
            const double expected = 1.0 / hypot(1.0 - r * r, 2.0 * d.suspension_damping * r);
            const double x = 3.14159265358979324 * frequencies[i] / 4000.0, sinc = sin(x) / x;
            /* the force is that at the end of each hold instead of the mean: half a sinc, 1e-3 */
            CHECK_RELATIVE(gain, expected * sinc * sinc, 2e-3);
        }
}

/* White noise of frequency, from beams of little energy: 4000 samples are 1.1 %, times five. */
static void noise_is_its_formula(void **state)
{
    (void)state;
    enum { COUNT = 4000 };
    static double samples[COUNT];
    imk_vibrating_beam d = plain();
    d.mount_force_instability = d.mount_force_repeatability = 0.0;
    d.quality = 100.0;
    d.amplitude = 1e-8;
    for (int arrangement = 0; arrangement < 2; arrangement++)
        for (int level = 0; level < 2; level++) {
            imk_physics_settings settings = imk_physics_default();
            const imk_exposure exposure = force_of(0.0);
            double sum = 0.0, mean = 0.0;
            settings.rate = 400.0;
            settings.level = (imk_level)level;
            d.arrangement = arrangement;
            void *run_state = started(beam, &d, &settings);
            run(beam, run_state, &exposure, 10, 0, NULL);
            run(beam, run_state, &exposure, COUNT, 0, samples);
            for (int i = 0; i < COUNT; i++)
                mean += samples[i] / COUNT;
            for (int i = 0; i < COUNT; i++)
                sum += (samples[i] - mean) * (samples[i] - mean) / COUNT;
            free(run_state);
            CHECK_RELATIVE(sqrt(sum / 400.0), imk_vibrating_beam_noise(&d), 0.06);
        }
}

/* Quantization by the clock and white noise in one record, at the full level; the flicker of the
 * mount in a long one of the slow level. */
static void records_identify_as_reduced(void **state)
{
    (void)state;
    imk_vibrating_beam d = imk_vibrating_beam_default();
    imk_physics_settings settings = imk_physics_default();
    const imk_exposure exposure = force_of(0.3);
    settings.rate = 100.0;
    settings.seed = 5;
    d.quality = 100.0;
    d.amplitude = 2e-9;
    check_chain(beam, &d, &settings, &exposure, 10, 1500);
    settings.level = IMK_LEVEL_SLOW;
    settings.rate = 20.0;
    d.suspension_frequency = 20.0;
    check_chain(beam, &d, &settings, &exposure, 10, 72000);
}

static void impossible_designs_are_refused(void **state)
{
    (void)state;
    imk_error error;
    imk_vibrating_beam d = imk_vibrating_beam_default();
    imk_physics_settings settings = imk_physics_default();
    void *memory = aligned_alloc(64, (beam->state_size + 63) / 64 * 64);
    d.quality = 0.4;
    CHECK_STATUS(imk_vibrating_beam_validate(&d, &error), IMK_ERROR_RANGE);
    assert_string_equal(error.field, "beam.quality");
    d = imk_vibrating_beam_default();
    d.length = -1e-3;
    CHECK_STATUS(imk_vibrating_beam_validate(&d, &error), IMK_ERROR_RANGE);
    assert_string_equal(error.field, "beam.length");
    d = imk_vibrating_beam_default();
    d.range = 240.0 * G; /* 80 Hz/g on 40 kHz buckle at 250 g */
    CHECK_STATUS(imk_vibrating_beam_validate(&d, &error), IMK_ERROR_CONFLICT);
    assert_string_equal(error.field, "proof_mass.range");
    d = imk_vibrating_beam_default();
    d.arrangement = 2;
    CHECK_STATUS(imk_vibrating_beam_validate(&d, &error), IMK_ERROR_RANGE);
    assert_string_equal(error.field, "arrangement");
    d = imk_vibrating_beam_default();
    settings.step = 1e-5;
    CHECK_STATUS(imk_instrument_init(beam, &d, &settings, memory, &error), IMK_ERROR_RANGE);
    assert_string_equal(error.field, "step");
    free(memory);
}

static void the_default_is_of_a_class_with_vibrating_beams(void **state)
{
    (void)state;
    const imk_vibrating_beam d = imk_vibrating_beam_default();
    imk_model *model = malloc(sizeof *model);
    imk_vibrating_beam_reduce(&d, model);
    imk_model_three_axes(model);
    const imk_grade_result grade = imk_grade_model(model);
    assert_int_equal(grade.accel, IMK_GRADE_TACTICAL);
    assert_non_null(strstr(imk_grade_table(grade.accel)->accel_technology, beam->technology));
    free(model);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_default_has_its_figures),
        cmocka_unit_test(the_modal_mass_is_that_of_the_shape),
        cmocka_unit_test(the_law_of_squares_is_a_clamped_beam),
        cmocka_unit_test(nonlinearity_of_a_pair),
        cmocka_unit_test(a_single_beam_rectifies),
        cmocka_unit_test(constant_forces_are_read_exactly),
        cmocka_unit_test(rotations_keep_the_energy),
        cmocka_unit_test(terms_are_as_reduced),
        cmocka_unit_test(the_sum_is_a_thermometer),
        cmocka_unit_test(levels_agree_in_frequency),
        cmocka_unit_test(noise_is_its_formula),
        cmocka_unit_test(records_identify_as_reduced),
        cmocka_unit_test(impossible_designs_are_refused),
        cmocka_unit_test(the_default_is_of_a_class_with_vibrating_beams),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
