/* SPDX-License-Identifier: Apache-2.0 */
/* The vibrating beam accelerometer: check values, levels, chain, limits. */
#include "vibrating_beam_designs.h"

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
                /* what comes after K3, by experiments/clamped_beam.py's digits at n = -12 … 12: of
                 * the square of one beam -4.5e-10 n^4, which is 1.25e-3 x^4, and of a frequency
                 * with the square root's 5/128 x^4 less than 0.05 x^4; a pair has only what the
                 * mismatch of 2 % leaves of it, and x^5 */
                const double one = readout == IMK_BEAM_SQUARES ? 1.3e-3 * 2451.7 : 0.05 * 4903.3;
                const double tolerance =
                    (arrangement == IMK_BEAM_SINGLE ? one : 0.2 * one) * x * x * x * x + 1e-9;
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

/* The error of a reading's integral is that of its last crossing less that of the one before, of
 * the variance r^2 + Q^2 each and independent, at any rate: neighbours correlate by -1/2, and sums
 * over ten samples scatter no more than single ones. 4000 samples: its root within 5 standard
 * deviations, 1.25 % (a sequence of differences: sqrt(3/4000)/2 each), sums of ten 4.5 % each. */
static void timing_is_the_same_at_any_rate(void **state)
{
    (void)state;
    enum { COUNT = 4000 };
    static double samples[COUNT];
    static const double rates[] = {10.0, 100.0, 1000.0, 100.0};
    imk_vibrating_beam d = imk_vibrating_beam_default();
    d.mount_force_instability = d.mount_force_repeatability = 0.0;
    for (int i = 0; i < 4; i++) {
        imk_physics_settings settings = imk_physics_default();
        const imk_exposure exposure = force_of(0.3);
        double mean = 0.0, square = 0.0, product = 0.0, tens = 0.0;
        settings.rate = rates[i];
        settings.level = i == 3 ? IMK_LEVEL_FULL : IMK_LEVEL_SLOW;
        const size_t count = i == 3 ? COUNT / 10 : COUNT;
        void *run_state = started(beam, &d, &settings);
        run(beam, run_state, &exposure, 10, 0, NULL);
        run(beam, run_state, &exposure, count, 0, samples);
        free(run_state);
        for (size_t k = 0; k < count; k++)
            mean += samples[k] / (double)count;
        for (size_t k = 0; k < count; k++) {
            samples[k] = (samples[k] - mean) / settings.rate;
            square += samples[k] * samples[k] / (double)count;
            product += k > 0 ? samples[k] * samples[k - 1] / (double)(count - 1) : 0.0;
        }
        for (size_t k = 0; k + 10 <= count; k += 10) {
            double sum = 0.0;
            for (size_t j = 0; j < 10; j++)
                sum += samples[k + j];
            tens += sum * sum * 10.0 / (double)count;
        }
        const double q =
            hypot(imk_vibrating_beam_quantization(&d), imk_vibrating_beam_reading_noise(&d));
        const double wide = i == 3 ? 3.2 : 1.0;
        CHECK_RELATIVE(sqrt(0.5 * square), q, 0.0625 * wide);
        CHECK_CLOSE(product / square, -0.5, 0.06 * wide);
        CHECK_RELATIVE(sqrt(0.5 * tens), q, 0.22 * wide);
    }
}

/* Two beams timed by ticks of 10 ns and edges of 3 nm/(w x0), by hand: 10/sqrt(12) and 11.94 ns,
 * and f0/(sqrt(2) s) of each. */
static void timing_is_of_ticks_and_edges(void **state)
{
    (void)state;
    imk_vibrating_beam d = imk_vibrating_beam_default();
    imk_model *model = malloc(sizeof *model);
    d.frequency_mismatch = d.mount_force = 0.0;
    const double edge = 3e-3 / (2.0 * 3.14159265358979324 * 40000.0), tick = 10e-9 / sqrt(12.0);
    const double turn = 40000.0 / (80.0 / G) / sqrt(2.0);
    CHECK_RELATIVE(edge, 11.94e-9, 1e-3);
    CHECK_RELATIVE(imk_vibrating_beam_quantization(&d), turn * tick, 1e-12);
    CHECK_RELATIVE(imk_vibrating_beam_reading_noise(&d), turn * edge, 1e-12);
    imk_vibrating_beam_reduce(&d, model);
    CHECK_RELATIVE(model->accel.noise.quantization.value[0], turn * tick, 1e-12);
    CHECK_RELATIVE(model->accel.noise.reading_noise.value[0], turn * edge, 1e-12);
    d.clock = d.pickoff_noise = 0.0;
    CHECK_CLOSE(imk_vibrating_beam_quantization(&d), 0.0, 0.0);
    CHECK_CLOSE(imk_vibrating_beam_reading_noise(&d), 0.0, 0.0);
    free(model);
}

/* Timing and the flicker of the mount at three rates; white noise beside them at the full level. */
static void records_identify_as_reduced(void **state)
{
    (void)state;
    imk_vibrating_beam d = imk_vibrating_beam_default();
    imk_physics_settings settings = imk_physics_default();
    const imk_exposure exposure = force_of(0.3);
    settings.seed = 5;
    settings.level = IMK_LEVEL_SLOW;
    for (settings.rate = 10.0; settings.rate <= 1000.0; settings.rate *= 10.0)
        check_chain(beam, &d, &settings, &exposure, 10, settings.rate < 100.0 ? 9000 : 18000);
    settings.rate = 100.0;
    settings.level = IMK_LEVEL_FULL;
    d.quality = 100.0;
    d.amplitude = 2e-9;
    d.pickoff_noise = 6e-12;
    check_chain(beam, &d, &settings, &exposure, 10, 1500);
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
    /* 80 Hz/g on 40 kHz buckle at 4 pi^2/load_per_g() = 242.57 g; nine tenths, less the mount's 5
     * mg and six times 0.505 mg, are 218.305 g */
    d.range = 218.306 * G;
    CHECK_STATUS(imk_vibrating_beam_validate(&d, &error), IMK_ERROR_CONFLICT);
    assert_string_equal(error.field, "proof_mass.range");
    CHECK_CLOSE(error.limit / G, 218.305, 1e-3);
    d.range = 218.304 * G;
    CHECK_OK(imk_vibrating_beam_validate(&d, &error));
    d.mount_force = -6.8; /* 0.9 x 7.5164 N */
    CHECK_STATUS(imk_vibrating_beam_validate(&d, &error), IMK_ERROR_CONFLICT);
    assert_string_equal(error.field, "mount.force");
    d = imk_vibrating_beam_default();
    d.pickoff_noise = 0.11e-6;
    CHECK_STATUS(imk_vibrating_beam_validate(&d, &error), IMK_ERROR_CONFLICT);
    assert_string_equal(error.field, "beam.pickoff_noise");
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

/* Only temperature brings a valid design to buckling: its frequencies then stay, and are finite. At
 * 2 % of the modulus 70 g is 11.4/0.02 of load, beyond both ends. */
static void beyond_buckling_frequencies_stay(void **state)
{
    (void)state;
    imk_vibrating_beam d = plain();
    d.frequency_temperature = 0.01;
    double signals[IMK_INSTRUMENT_SIGNALS_MAX];
    for (int level = 0; level < 2; level++) {
        imk_physics_settings settings = quiet(100.0);
        settings.level = (imk_level)level;
        void *run_state = started(beam, &d, &settings);
        for (double cold = 90.0; cold <= 1000.0; cold += 8.0) {
            double outputs[IMK_INSTRUMENT_OUTPUTS_MAX];
            imk_exposure exposure = force_of(cold < 195.0 ? 700.0 : -1e6);
            exposure.temperature = d.temperature - cold > 1.0 ? d.temperature - cold : 1.0;
            beam->step(run_state, &exposure, outputs);
            beam->observe(run_state, signals);
            for (size_t k = 0; k < beam->output_count; k++)
                assert_true(isfinite(outputs[k]));
            assert_true(outputs[1] > 0.0 && outputs[2] > 0.0 && fabs(outputs[0]) <= d.range);
        }
        imk_exposure exposure = force_of(700.0);
        exposure.temperature = d.temperature - 98.0;
        double outputs[IMK_INSTRUMENT_OUTPUTS_MAX];
        for (int i = 0; i < 20; i++)
            beam->step(run_state, &exposure, outputs);
        /* f01 sqrt(0.02 l), l at +-0.95 of Euler's load */
        const double end = 0.95 * 39.47841760435743;
        CHECK_RELATIVE(outputs[1], 40000.0 * sqrt(0.02 * imki_beam_load_at(end).square), 1e-9);
        CHECK_RELATIVE(outputs[2], 40000.0 * sqrt(0.02 * imki_beam_load_at(-end).square), 1e-9);
        free(run_state);
    }
}

/* A modulus that jumps between 1 % and three times its value makes the amplitude jump, and the
 * drive brings it back: any excess to 1.5 of the square in 55 cycles, the rest by e^-1 in each 50.
 */
static void jumps_of_the_modulus_die_out(void **state)
{
    (void)state;
    imk_vibrating_beam d = plain();
    d.frequency_temperature = -0.01;
    const imk_physics_settings settings = quiet(1e4);
    void *run_state = started(beam, &d, &settings);
    imk_exposure exposure = force_of(500.0);
    double outputs[IMK_INSTRUMENT_OUTPUTS_MAX], signals[IMK_INSTRUMENT_SIGNALS_MAX];
    for (int i = 0; i < 60; i++) {
        exposure.temperature = i % 2 == 0 ? 500.0 : 100.0;
        beam->step(run_state, &exposure, outputs);
        beam->observe(run_state, signals);
        assert_true(isfinite(outputs[0]) && isfinite(signals[3]) && isfinite(signals[4]));
    }
    exposure.temperature = d.temperature;
    run(beam, run_state, &exposure, 500, 0, NULL); /* 2000 cycles */
    beam->observe(run_state, signals);
    CHECK_RELATIVE(signals[3], d.amplitude, 1e-9);
    CHECK_RELATIVE(signals[4], d.amplitude, 1e-9);
    free(run_state);
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
        cmocka_unit_test(constant_forces_are_read_exactly),
        cmocka_unit_test(rotations_keep_the_energy),
        cmocka_unit_test(terms_are_as_reduced),
        cmocka_unit_test(the_sum_is_a_thermometer),
        cmocka_unit_test(levels_agree_in_frequency),
        cmocka_unit_test(noise_is_its_formula),
        cmocka_unit_test(timing_is_the_same_at_any_rate),
        cmocka_unit_test(timing_is_of_ticks_and_edges),
        cmocka_unit_test(records_identify_as_reduced),
        cmocka_unit_test(impossible_designs_are_refused),
        cmocka_unit_test(beyond_buckling_frequencies_stay),
        cmocka_unit_test(jumps_of_the_modulus_die_out),
        cmocka_unit_test(the_default_is_of_a_class_with_vibrating_beams),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
