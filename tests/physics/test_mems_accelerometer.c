/* SPDX-License-Identifier: Apache-2.0 */
/* The mass of the MEMS accelerometer: closed forms, noise, pull-in, invariants, and what its design
 * refuses. Its readings: test_mems_readings.c. */
#include "instrument_run.h"

#include "imukit/mems_accelerometer.h"
#include "imukit/units.h"

#define INSTRUMENT (&imk_mems_accelerometer_instrument)
#define GRAVITY IMK_STANDARD_GRAVITY
static const double pi = 3.14159265358979324;
static const double boltzmann = 1.380649e-23; /* exact, SI */

/* 1 ug of mass, 5 kHz, Q = 0.7 at 300 K without anything else; gap and area of the pull-in
 * check. */
static imk_mems_accelerometer bare_mass(void)
{
    imk_mems_accelerometer d = imk_mems_accelerometer_default();
    d.mass = 1e-9;
    d.frequency = 5000.0;
    d.quality = 0.7;
    d.temperature = 300.0;
    d.area = 1e-6;
    d.voltage = d.offset = d.tilt_y = d.pickoff_noise = d.output_bandwidth = d.range = 0.0;
    d.bias_repeatability = d.bias_instability = d.bias_temperature = d.gain_repeatability = 0.0;
    d.spring_temperature = 0.0;
    return d;
}

static void closed_forms(void **state)
{
    (void)state;
    imk_mems_accelerometer d = bare_mass();
    /* figures of the design sheet, to their last digit */
    CHECK_CLOSE(imk_mems_accelerometer_brownian(&d) / GRAVITY * 1e6, 87.93, 0.005);
    CHECK_CLOSE(imk_mems_accelerometer_sensitivity(&d) * GRAVITY * 1e9, 9.936, 0.0005);
    d.frequency = sqrt(1.0 / d.mass) / (2.0 * pi); /* 1 N/m */
    CHECK_CLOSE(imk_mems_accelerometer_pull_in(&d), 0.67213, 5e-6);
    d.voltage = 0.3;
    /* 2 eps A V^2/gap^3 */
    CHECK_RELATIVE(imk_mems_accelerometer_softening(&d),
                   2.0 * 8.8541878128e-12 * 1e-6 * 0.09 / 8e-18, 1e-14);
    CHECK_RELATIVE(imk_mems_accelerometer_sensitivity(&d),
                   d.mass / (1.0 - imk_mems_accelerometer_softening(&d)), 1e-14);
    d.plates = IMK_MEMS_SINGLE;
    CHECK_CLOSE(imk_mems_accelerometer_pull_in(&d), 0.517409, 5e-7);
    CHECK_RELATIVE(imk_mems_accelerometer_softening(&d), 8.8541878128e-12 * 1e-6 * 0.09 / 8e-18,
                   1e-14);
    CHECK_RELATIVE(imk_mems_accelerometer_damping(&d, 0.5e-6), 1.0, 0.0);
    d.squeeze_film = true;
    CHECK_RELATIVE(imk_mems_accelerometer_damping(&d, 0.5e-6), 1.0 / (0.75 * 0.75 * 0.75), 1e-14);
    d.plates = IMK_MEMS_DOUBLE; /* half the sum of 1/(1 -+ s)^3 */
    CHECK_RELATIVE(imk_mems_accelerometer_damping(&d, 0.5e-6),
                   0.5 / (0.75 * 0.75 * 0.75) + 0.5 / (1.25 * 1.25 * 1.25), 1e-14);
}

/* ---- noise ----------------------------------------------------------------------------------- */

/* White noise of 87.93 ug/sqrt(Hz)/sqrt(2), through the mass (damping 1/(2 Q)) and the mean over a
 * sample: the variance of the exact sequence. Of 8000 nearly independent samples the variance has
 * the relative deviation sqrt(2/8000) = 1.6 %; 5 times that fails once in two million seeds. */
static void brownian_noise_is_as_the_formula(void **state)
{
    (void)state;
    enum { COUNT = 8000 };
    static double samples[COUNT];
    const imk_mems_accelerometer d = bare_mass();
    imk_model *model = malloc(sizeof *model);
    imk_physics_settings settings = imk_physics_default();
    const imk_exposure rest = imk_exposure_default();
    imk_arma sequence;
    settings.rate = 500.0;
    assert_non_null(model);
    imk_mems_accelerometer_reduce(&d, model);
    const double density = imk_mems_accelerometer_brownian(&d) / sqrt(2.0);
    CHECK_RELATIVE(model->accel.noise.white.value[0], density, 1e-12);
    const imk_low_pass filter = {model->accel.bandwidth.value[0], model->accel.damping.value[0]};
    CHECK_RELATIVE(filter.damping, 0.5 / 0.7, 1e-6);
    CHECK_OK(imk_filtered_white_arma(density, filter, 1.0 / settings.rate, &sequence));
    for (int level = 0; level < 2; level++) {
        settings.level = (imk_level)level;
        void *run_state = started(INSTRUMENT, &d, &settings);
        run(INSTRUMENT, run_state, &rest, 10, 0, NULL);
        run(INSTRUMENT, run_state, &rest, COUNT, 0, samples);
        double variance = 0.0;
        for (int i = 0; i < COUNT; i++)
            variance += samples[i] * samples[i] / COUNT;
        CHECK_RELATIVE(variance, sequence.variance, 5.0 * sqrt(2.0 / COUNT));
        free(run_state);
    }
    free(model);
}

/* Equipartition: m v^2 = k T, and x dU/dx = k T also in the potential of springs and plates, with
 * the film's damping. A mass so small that it swings over a good part of its gap. The sums are of
 * nearly independent values, so that COUNT of them give 1 % with five standard deviations of
 * sqrt(2/COUNT) for v^2; x dU/dx likewise, of a distribution hardly wider. */
static void equipartition(void **state)
{
    (void)state;
    enum { COUNT = 500000 };
    imk_mems_accelerometer d = bare_mass();
    d.mass = 2e-16;
    d.area = 1e-9;
    d.voltage = 3e-3;
    d.stop = 0.95;
    d.restitution = 1.0;
    d.squeeze_film = true;
    d.quality = 0.6;
    imk_physics_settings settings = imk_physics_default();
    settings.rate = 2.0 * d.frequency;
    settings.step = 1.0 / (30.0 * d.frequency);
    void *run_state = started(INSTRUMENT, &d, &settings);
    const imk_exposure rest = imk_exposure_default();
    double outputs[IMK_INSTRUMENT_OUTPUTS_MAX], signals[IMK_INSTRUMENT_SIGNALS_MAX];
    const double k = d.mass * 4.0 * pi * pi * d.frequency * d.frequency, g = d.gap;
    const double c = 0.5 * 8.8541878128e-12 * d.area * d.voltage * d.voltage;
    double kinetic = 0.0, virial = 0.0, largest = 0.0;
    for (int i = 0; i < COUNT; i++) {
        INSTRUMENT->step(run_state, &rest, outputs);
        INSTRUMENT->observe(run_state, signals);
        const double x = signals[0], p = 1.0 / (g - x), m = 1.0 / (g + x);
        kinetic += d.mass * signals[1] * signals[1] / COUNT;
        virial += x * (k * x - c * (p * p - m * m)) / COUNT;
        largest = fabs(x) > largest ? fabs(x) : largest;
    }
    CHECK_RELATIVE(kinetic, boltzmann * d.temperature, 0.01);
    CHECK_RELATIVE(virial, boltzmann * d.temperature, 0.01);
    assert_true(largest > 0.3 * g && largest < 0.94 * g); /* it does swing, and meets no stop */
    free(run_state);
}

/* ---- invariants ------------------------------------------------------------------------------ */

static double energy(const imk_mems_accelerometer *d, const void *run_state)
{
    double s[IMK_INSTRUMENT_SIGNALS_MAX];
    INSTRUMENT->observe(run_state, s);
    const double w = 2.0 * pi * d->frequency, x = s[0] - d->offset;
    const double plates = 0.5 * 8.8541878128e-12 * d->area * d->voltage * d->voltage *
                          (1.0 / (d->gap - s[0]) + 1.0 / (d->gap + s[0]));
    return 0.5 * d->mass * (s[1] * s[1] + w * w * x * x) - plates;
}

/* Mean energy over `count` samples; *loss the mean of damping m v^2. */
static double mean_energy(const imk_mems_accelerometer *d, void *run_state, int count, double *loss)
{
    const double damping = 2.0 * pi * d->frequency / d->quality;
    const imk_exposure rest = imk_exposure_default();
    double sum = 0.0, outputs[IMK_INSTRUMENT_OUTPUTS_MAX], signals[IMK_INSTRUMENT_SIGNALS_MAX];
    *loss = 0.0;
    for (int i = 0; i < count; i++) {
        INSTRUMENT->step(run_state, &rest, outputs);
        INSTRUMENT->observe(run_state, signals);
        sum += energy(d, run_state);
        *loss += damping * d->mass * signals[1] * signals[1] / count;
    }
    return sum / count;
}

/* Ring with an amplitude of about `part` of the gap: a push over half a cycle, then rest. Returns
 * by how much the energy falls per cycle, relative, beyond what the damping
 * takes. */
static double numerical_loss(imk_mems_accelerometer d, double part, int cycles)
{
    imk_physics_settings settings = imk_physics_default();
    settings.noise = false;
    settings.rate = 1.9318 * d.frequency;
    imk_exposure push = imk_exposure_default();
    double outputs[IMK_INSTRUMENT_OUTPUTS_MAX];
    void *run_state = started(INSTRUMENT, &d, &settings);
    const double at_rest = energy(&d, run_state);
    push.specific_force[0] = 0.5 * part * d.gap / imk_mems_accelerometer_sensitivity(&d);
    INSTRUMENT->step(run_state, &push, outputs);
    /* an irrational ratio of sample and swing makes the mean one over all phases */
    const int window = 2000, samples = (int)(cycles * settings.rate / d.frequency);
    double loss;
    const double before = mean_energy(&d, run_state, window, &loss) - at_rest;
    mean_energy(&d, run_state, samples - window, &loss);
    const double after = mean_energy(&d, run_state, window, &loss) - at_rest;
    free(run_state);
    return (-log(after / before) * settings.rate / samples - loss / after) / d.frequency;
}

static void energy_is_kept(void **state)
{
    (void)state;
    imk_mems_accelerometer d = bare_mass();
    d.quality = 1e8;
    /* The energy lost per cycle, 6.3e-8 by the damping, is exact but for rounding; the mean of
     * v^2 over the window, cut within a cycle, is good to some 1e-3 of it. */
    CHECK_BELOW(fabs(numerical_loss(d, 0.2, 20000)), 5e-10);
    /* With plates, swinging over 0.4 of the gap: the energy wavers within a cycle and does not
     * drift. */
    d.voltage = 0.4 * imk_mems_accelerometer_pull_in(&d);
    CHECK_BELOW(fabs(numerical_loss(d, 0.4, 20000)), 5e-10);
}

/* Halving the step quarters the error of the splitting. */
static void splitting_is_of_second_order(void **state)
{
    (void)state;
    imk_mems_accelerometer d = bare_mass();
    d.quality = 30.0;
    d.voltage = 0.5 * imk_mems_accelerometer_pull_in(&d);
    d.squeeze_film = true;
    imk_physics_settings settings = imk_physics_default();
    settings.noise = false;
    settings.rate = 1000.0;
    imk_exposure push = imk_exposure_default();
    push.specific_force[0] = 0.15 * d.gap / imk_mems_accelerometer_sensitivity(&d);
    double at[4], signals[IMK_INSTRUMENT_SIGNALS_MAX];
    for (int i = 0; i < 4; i++) {
        settings.step = i == 3 ? 1e-7 : 1e-3 / (100 << i); /* the last stands for the truth */
        void *run_state = started(INSTRUMENT, &d, &settings);
        run(INSTRUMENT, run_state, &push, 2, 0, NULL);
        INSTRUMENT->observe(run_state, signals);
        at[i] = signals[0];
        free(run_state);
    }
    for (int i = 0; i < 2; i++) {
        const double ratio = (at[i] - at[3]) / (at[i + 1] - at[3]);
        CHECK_CLOSE(ratio, 4.0, 0.4);
    }
    CHECK_BELOW(fabs(at[1] - at[3]), 1e-4 * d.gap); /* the accuracy of 40 steps to a cycle */
}

/* ---- pull-in --------------------------------------------------------------------------------- */

/* Ramp the voltage from 0.9 of pull-in by 2 % per second; where is the mass at a voltage? */
static double position_at(imk_mems_accelerometer d, double pull_in, double part)
{
    imk_physics_settings settings = imk_physics_default();
    settings.noise = false;
    d.voltage = 0.97 * pull_in;
    d.voltage_rate = 0.5 * pull_in;
    const size_t count = (size_t)((part - 0.97) / 0.5 * 1000.0 + 0.5);
    settings.rate = 1000.0;
    const imk_exposure rest = imk_exposure_default();
    double signals[IMK_INSTRUMENT_SIGNALS_MAX];
    void *run_state = started(INSTRUMENT, &d, &settings);
    run(INSTRUMENT, run_state, &rest, count, 0, NULL);
    INSTRUMENT->observe(run_state, signals);
    CHECK_RELATIVE(signals[2], part * pull_in, 1e-9);
    free(run_state);
    return signals[0];
}

static void plates_pull_in(void **state)
{
    (void)state;
    imk_mems_accelerometer d = bare_mass();
    d.frequency = sqrt(1.0 / d.mass) / (2.0 * pi);
    d.quality = 0.5;
    d.stop = 0.9;
    d.restitution = 0.0;
    for (int plates = 0; plates < 2; plates++) {
        d.plates = (imk_mems_plates)plates;
        const double pull_in = imk_mems_accelerometer_pull_in(&d);
        /* statically: an equilibrium below, none above */
        imk_error error;
        d.voltage = pull_in * (1.0 - 1e-9);
        CHECK_OK(imk_mems_accelerometer_validate(&d, NULL));
        d.voltage = pull_in * (1.0 + 1e-9);
        CHECK_STATUS(imk_mems_accelerometer_validate(&d, &error), IMK_ERROR_CONFLICT);
        assert_string_equal(error.field, "electrodes.voltage");
        CHECK_RELATIVE(error.limit, pull_in, 1e-12);
    }
    /* dynamically, one plate: below a third of the gap up to pull-in, at the stop soon after. The
     * ramp takes 10 ms from 0.995 to 1, 50 cycles of the mass. */
    const double single = imk_mems_accelerometer_pull_in(&d);
    d.plates = IMK_MEMS_SINGLE;
    const double before = position_at(d, single, 0.996), after = position_at(d, single, 1.01);
    assert_true(before > 0.2 * d.gap && before < d.gap / 3.0);
    CHECK_RELATIVE(after, d.stop * d.gap, 1e-12);
    /* two plates: the middle stays an equilibrium, which a push of a picometre shows unstable */
    d.plates = IMK_MEMS_DOUBLE;
    d.offset = 1e-12;
    const double both = imk_mems_accelerometer_pull_in(&d);
    CHECK_BELOW(position_at(d, both, 0.998), 0.01 * d.gap);
    CHECK_RELATIVE(position_at(d, both, 1.02), d.stop * d.gap, 1e-12);
}

/* Voltage at which the mass of examples/instruments/pull_in.yaml is beyond the middle of the gap,
 * on a ramp that begins 2.5 % below pull-in and is sampled every 0.1 ms. */
static double pulled_in_at(double rate, double step)
{
    imk_mems_accelerometer d = imk_mems_accelerometer_default();
    imk_physics_settings settings = imk_physics_default();
    double signals[IMK_INSTRUMENT_SIGNALS_MAX] = {0.0};
    settings.noise = false;
    settings.rate = 1e4;
    settings.step = step;
    d.plates = IMK_MEMS_SINGLE;
    d.voltage = 4.9;
    d.voltage_rate = rate;
    d.range = 0.0;
    const imk_exposure rest = imk_exposure_default();
    void *run_state = started(INSTRUMENT, &d, &settings);
    for (int i = 0; i < 20000 && signals[0] < 0.5 * d.gap; i++) {
        run(INSTRUMENT, run_state, &rest, 1, 0, NULL);
        INSTRUMENT->observe(run_state, signals);
    }
    free(run_state);
    return signals[2];
}

/* The plate is nearer by the offset, 10 nm of 2 um: 0.75 % of the voltage. A ramp is passed later,
 * because the mass falls slowly where there is hardly a force: the excess goes with the rate to the
 * power 2/3, 0.2 % of the voltage at 1.2 V/s, and 0.04 % at 0.12 V/s. The default step moves it by
 * less than a tenth of that. */
static void ramp_pulls_in(void **state)
{
    (void)state;
    imk_mems_accelerometer d = imk_mems_accelerometer_default();
    d.plates = IMK_MEMS_SINGLE;
    const double near = imk_mems_accelerometer_pull_in(&d);
    d.offset = 0.0;
    CHECK_RELATIVE(near / imk_mems_accelerometer_pull_in(&d), pow(1.0 - 10e-9 / 2e-6, 1.5), 1e-12);
    const double fast = pulled_in_at(1.2, 0.0), slow = pulled_in_at(0.12, 0.0);
    assert_true(fast > 1.001 * near && fast < 1.0025 * near);
    assert_true(slow > 1.0001 * near && slow < 1.0006 * near);
    CHECK_RELATIVE(pulled_in_at(1.2, 1e-6), fast, 1.5e-4);
}

/* ---- refusals -------------------------------------------------------------------------------- */

static void refuse(const imk_mems_accelerometer *d, imk_status status, const char *field)
{
    imk_error error = {0};
    imk_mems_accelerometer_validate(d, &error);
    if (error.status != status)
        print_error("%s: %s\n", field, imk_status_name(error.status));
    assert_int_equal(error.status, status);
    assert_string_equal(error.field, field);
}

static void impossible_designs_are_refused(void **state)
{
    (void)state;
    const imk_mems_accelerometer open = imk_mems_accelerometer_default();
    const imk_mems_accelerometer analog = imk_mems_accelerometer_analog();
    const imk_mems_accelerometer bits = imk_mems_accelerometer_sigma_delta();
    imk_mems_accelerometer d = {0};
    CHECK_OK(imk_mems_accelerometer_validate(&open, NULL));
    CHECK_OK(imk_mems_accelerometer_validate(&analog, NULL));
    CHECK_OK(imk_mems_accelerometer_validate(&bits, NULL));
    refuse(&d, IMK_ERROR_UNINITIALISED, "design");
    d = open, d.mass = 0.0;
    refuse(&d, IMK_ERROR_RANGE, "proof_mass.mass");
    d = open, d.quality = (double)NAN;
    refuse(&d, IMK_ERROR_NOT_FINITE, "proof_mass.quality");
    d = open, d.stop = 1.0;
    refuse(&d, IMK_ERROR_RANGE, "electrodes.stop");
    d = open, d.offset = 1.2e-6;
    refuse(&d, IMK_ERROR_CONFLICT, "electrodes.offset");
    d = open, d.range = 20.0 * GRAVITY; /* the stops are at 12 g */
    refuse(&d, IMK_ERROR_CONFLICT, "output.range");
    d = analog, d.plates = IMK_MEMS_SINGLE;
    refuse(&d, IMK_ERROR_CONFLICT, "electrodes.plates");
    d = analog, d.feedback_voltage = 1.0;
    refuse(&d, IMK_ERROR_CONFLICT, "output.range");
    d = analog, d.pickoff_offset = 1.5e-6;
    refuse(&d, IMK_ERROR_CONFLICT, "pickoff.offset");
    d = analog, d.bandwidth = 1000.0; /* softer than the springs */
    refuse(&d, IMK_ERROR_CONFLICT, "analog.bandwidth");
    d = analog, d.amplifier = 2000.0; /* slower than the loop */
    refuse(&d, IMK_ERROR_CONFLICT, "analog.bandwidth");
    d = analog, d.reset = 50e3;
    refuse(&d, IMK_ERROR_CONFLICT, "analog.bandwidth");
    d = bits, d.lead = 0.0, d.quality = 100.0; /* nothing damps the loop */
    refuse(&d, IMK_ERROR_CONFLICT, "sigma_delta.lead");
    d = bits, d.integral = 1.0;
    refuse(&d, IMK_ERROR_CONFLICT, "sigma_delta.integral");
    d = bits, d.clock = 2e3;
    refuse(&d, IMK_ERROR_CONFLICT, "sigma_delta.clock");
    d = bits, d.feedback_voltage = 3.0;
    refuse(&d, IMK_ERROR_CONFLICT, "output.range");
}

static void refuse_settings(const imk_mems_accelerometer *d, const imk_physics_settings *settings,
                            const char *field)
{
    imk_error error = {0};
    void *memory = aligned_alloc(64, (INSTRUMENT->state_size + 63) / 64 * 64);
    assert_non_null(memory);
    CHECK_STATUS(imk_instrument_init(INSTRUMENT, d, settings, memory, &error), IMK_ERROR_RANGE);
    assert_string_equal(error.field, field);
    free(memory);
}

static void steps_that_would_be_wrong_are_refused(void **state)
{
    (void)state;
    const imk_mems_accelerometer open = imk_mems_accelerometer_default();
    const imk_mems_accelerometer bits = imk_mems_accelerometer_sigma_delta();
    imk_physics_settings settings = imk_physics_default();
    settings.step = 1.0 / (15.0 * open.frequency);
    refuse_settings(&open, &settings, "step");
    settings.step = 0.0;
    settings.rate = 200e3; /* faster than the clock */
    refuse_settings(&bits, &settings, "rate");
    settings.rate = 100.0;
    CHECK_RELATIVE(INSTRUMENT->step_length(&bits, &settings), 1e-5, 1e-15);
    CHECK_RELATIVE(INSTRUMENT->step_length(&open, &settings), 1.0 / (25.0 * open.frequency), 1e-15);
}

/* Every unit of the table and of the signals is known. */
static void units_are_known(void **state)
{
    (void)state;
    assert_true(imk_instrument_find("MEMS accelerometer") == INSTRUMENT);
    for (size_t i = 0; i < INSTRUMENT->field_count; i++)
        if (imk_unit_of(INSTRUMENT->fields[i].unit).scale == 0.0)
            fail_msg("%s: %s", INSTRUMENT->fields[i].path, INSTRUMENT->fields[i].unit);
    for (size_t i = 0; i < INSTRUMENT->signal_count; i++) {
        const imk_unit si = imk_unit_of(INSTRUMENT->signals[i].si);
        const imk_unit unit = imk_unit_of(INSTRUMENT->signals[i].unit);
        assert_true(si.scale == 1.0 && imk_dimension_equal(si.dimension, unit.dimension));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(closed_forms),
        cmocka_unit_test(brownian_noise_is_as_the_formula),
        cmocka_unit_test(equipartition),
        cmocka_unit_test(energy_is_kept),
        cmocka_unit_test(splitting_is_of_second_order),
        cmocka_unit_test(plates_pull_in),
        cmocka_unit_test(ramp_pulls_in),
        cmocka_unit_test(impossible_designs_are_refused),
        cmocka_unit_test(steps_that_would_be_wrong_are_refused),
        cmocka_unit_test(units_are_known),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
