/* SPDX-License-Identifier: Apache-2.0 */
/* What an instrument reads, without noise, in rates, forces and temperatures of all kinds, against
 * what its reduced model reads there: every deterministic term of reduce, its sign and its size,
 * and that none is missing. One design error at a time is made so large that a wrong or absent term
 * shows. */
#include "instrument_run.h"

#include "imukit/distort.h"
#include "imukit/instrument.h"
#include "imukit/units.h"

enum { EXPOSURES = 17, CHANGES = 8 };

typedef struct change {
    const char *path;
    double value; /* in the unit of the field; the number of a choice */
} change;

/* `input`: along x; `force`, of a gyro, along all axes, [g]; `rate` of samples; `tolerance` of the
 * reading [rad/s, m/s^2]: why it is no smaller. */
typedef struct variant {
    const char *instrument;
    double input, force, rate, settle, dwell, tolerance;
    bool full_only;
    change changes[CHANGES];
} variant;

static void set_field(const imk_instrument *instrument, const change *c, void *design)
{
    for (size_t i = 0; i < instrument->field_count; i++) {
        const imk_design_field *f = &instrument->fields[i];
        char *place = (char *)design + f->offset;
        if (strcmp(f->path, c->path) != 0)
            continue;
        if (f->kind == IMK_DESIGN_NUMBER) {
            const imk_unit unit = imk_unit_of(f->unit);
            const double value = c->value * unit.scale + unit.offset;
            memcpy(place, &value, sizeof value);
        } else {
            const int value = (int)c->value;
            memcpy(place, &value, sizeof value);
        }
        return;
    }
    fail_msg("%s has no %s", instrument->name, c->path);
}

/* Nothing, along +-x, along +-y, +-z, mixtures; warm; growing warm. */
static imk_exposure exposure_number(const variant *v, int sensor, int number)
{
    static const signed char in[EXPOSURES][3] = {
        {0, 0, 0},  {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1},
        {0, 0, -1}, {1, 1, 0}, {1, 0, 1},  {0, 0, 0}, {0, 0, 0},  {0, 0, 0},
        {0, 0, 0},  {0, 0, 0}, {0, 0, 0},  {1, 0, 0}, {0, 0, 0}};
    static const signed char g[EXPOSURES][3] = {
        [9] = {1, 0, 0}, [10] = {0, 1, 0}, [11] = {0, 0, 1}, [12] = {1, 0, -1}, [13] = {0, 1, -1},
    };
    imk_exposure exposure = imk_exposure_default();
    for (int k = 0; k < 3; k++) {
        double *const here = sensor == IMK_GYRO ? exposure.angular_rate : exposure.specific_force;
        /* mixtures: errors of an accelerometer act along its true axis; a gyro's model has no
         * products of rates */
        const double part = number != 7 && number != 8 ? 1.0 : k == 0 ? 0.5 : 0.1;
        if (sensor == IMK_ACCEL || part != 0.1)
            here[k] = v->input * part * (double)in[number][k];
        if (sensor == IMK_GYRO)
            exposure.specific_force[k] = v->force * 9.80665 * (double)g[number][k];
        else
            exposure.specific_force[k] += 0.3 * v->input * (double)g[number][k];
    }
    if (number == 14 || number == 15)
        exposure.temperature += 5.0;
    if (number == 16)
        exposure.temperature_rate = 1e-2;
    return exposure;
}

static double predicted(const imk_distortion *distortion, int sensor, const imk_exposure *exposure)
{
    imk_stimulus stimulus = {0};
    double reading = 0.0;
    for (int k = 0; k < 3; k++) {
        stimulus.angular_rate[k] = &exposure->angular_rate[k];
        stimulus.specific_force[k] = &exposure->specific_force[k];
        stimulus.angular_acceleration[k] = &exposure->angular_acceleration[k];
    }
    stimulus.temperature = &exposure->temperature;
    stimulus.temperature_rate = &exposure->temperature_rate;
    imk_distort(distortion, sensor, 0, &stimulus, 1, &reading);
    return reading;
}

static double measured(const imk_instrument *instrument, const void *design,
                       const imk_physics_settings *settings, const variant *v,
                       const imk_exposure *exposure)
{
    void *state = started(instrument, design, settings);
    const size_t settle = (size_t)(v->settle * v->rate), count = (size_t)(v->dwell * v->rate);
    double outputs[IMK_INSTRUMENT_OUTPUTS_MAX], sum = 0.0;
    for (size_t i = 0; i < settle + count; i++) {
        imk_exposure now = *exposure; /* brought to speed over a fifth of the settling time */
        for (int k = 0; 5 * i < settle && k < 3; k++) {
            now.angular_rate[k] *= 5.0 * (double)i / (double)settle;
            now.specific_force[k] *= 5.0 * (double)i / (double)settle;
        }
        instrument->step(state, &now, outputs);
        if (i >= settle)
            sum += outputs[0];
    }
    free(state);
    return sum / (double)count;
}

static void check_variant(const variant *v)
{
    const imk_instrument *instrument = imk_instrument_find(v->instrument);
    void *design = calloc(1, instrument->design_size);
    imk_model *model = malloc(sizeof *model);
    imk_error error = {0};
    assert_true(design && model);
    instrument->set_default(design);
    for (int i = 0; i < CHANGES && v->changes[i].path; i++)
        set_field(instrument, &v->changes[i], design);
    if (imk_design_check(instrument, design, &error) != IMK_OK)
        fail_msg("%s: %s %s", v->instrument, error.field, error.expected);
    imk_instrument_reduce(instrument, design, model);
    CHECK_OK(imk_model_validate(model, &error));
    imk_distortion distortion;
    CHECK_OK(imk_distortion_start(&distortion, model, NULL, IMK_KERNEL_SCALAR, &error));
    for (int level = 0; level < (v->full_only ? 1 : 2); level++) {
        imk_physics_settings settings = imk_physics_default();
        settings.noise = false;
        settings.rate = v->rate;
        settings.level = (imk_level)level;
        for (int i = 0; i < EXPOSURES; i++) {
            const imk_exposure exposure = exposure_number(v, instrument->sensor, i);
            const double expected = predicted(&distortion, instrument->sensor, &exposure);
            const double found = measured(instrument, design, &settings, v, &exposure);
            if (!(fabs(found - expected) <= v->tolerance)) {
                print_error("%s with %s, level %d, exposure %d: reads %.10g, model %.10g, "
                            "difference %.3g\n",
                            v->instrument, v->changes[0].path ? v->changes[0].path : "defaults",
                            level, i, found, expected, found - expected);
                fail();
            }
        }
    }
    free(design);
    free(model);
}

#define DEGREE (3.14159265358979324 / 180.0)

/* Tolerances are half as large again as what was found, or less: terms of higher order, such as a
 * change with temperature of what is not linear, which an error model does not have. A term that
 * one of these designs makes large is thousands of times as large. */
static void spinning_mass(void **state)
{
    (void)state;
    static const variant variants[] = {
        /* (K3 w^2) times 0.5 % of temperature */
        {"rate_gyro",
         0.2,
         2.0,
         100.0,
         0.2,
         0.1,
         1e-5,
         false,
         {{"torque.fixed", 2e-5},
          {"wheel.momentum_error", 1e4},
          {"spring.error", 2e4},
          {"spring.temperature", 1e3}}},
        {"rate_integrating_gyro",
         0.1,
         5.0,
         100.0,
         4.0,
         0.5,
         1.2e-7,
         false,
         {{"torque.fixed", 1e-5},
          {"torquer.error", 1e4},
          {"torquer.temperature", 200.0},
          {"balance.offset_input", 100.0},
          {"balance.offset_spin", 200.0},
          {"balance.compliance_spin", 50.0}}},
        /* the loop answers a little to the tilt at twice the speed: parts in 1e6 */
        {"tuned_gyro",
         0.1,
         2.0,
         100.0,
         4.0,
         0.5,
         3e-7,
         false,
         {{"torque.fixed", 1e-6},
          {"torquer.error", 1e4},
          {"torquer.temperature", 200.0},
          {"wheel.speed_error", 1e3},
          {"rotor.axial_compliance", 300.0}}},
    };
    for (size_t i = 0; i < sizeof variants / sizeof variants[0]; i++)
        check_variant(&variants[i]);
}

static void optical(void **state)
{
    (void)state;
    static const variant variants[] = {
        {"fibre_optic",
         0.5,
         1.0,
         100.0,
         0.1,
         0.1,
         3e-7,
         false,
         {{"output.bits", 0.0},
          {"modulator.bits", 0.0},
          {"modulator.reset_error", 1e3},
          {"modulator.gain_error", 2e3},
          {"source.wavelength_error", 1e4},
          {"phase.fixed", 100.0},
          {"phase.temperature", 1.0},
          {"coil.winding_residual", 1.0}}},
        /* (K w)^5/120 of w at 0.02 rad/s */
        {"fibre_optic",
         0.02,
         1.0,
         100.0,
         0.1,
         0.1,
         2e-8,
         false,
         {{"loop.mode", 1.0},
          {"loop.range", 15.0},
          {"source.power_error", 10.0},
          {"modulator.depth_error", 5.0},
          {"source.wavelength_error", 1e4},
          {"phase.fixed", 3000.0},
          {"output.bits", 0.0}}},
        /* a count is 1.06 arcsec: over 0.5 s 1e-5 rad/s */
        {"ring_laser",
         1.0,
         1.0,
         100.0,
         0.05,
         0.5,
         2e-5,
         false,
         {{"null_shift.fixed", 100.0},
          {"null_shift.temperature", 20.0},
          {"scale_factor.error", 1e3},
          {"alignment.y", 5.0},
          {"alignment.z", -3.0},
          {"dither.randomness", 0.0},
          {"lock_in.rate", 1.0}}},
    };
    for (size_t i = 0; i < sizeof variants / sizeof variants[0]; i++)
        check_variant(&variants[i]);
}

static void vibratory(void **state)
{
    (void)state;
    static const variant variants[] = {
        {"shell_gyro",
         1.0,
         1.0,
         100.0,
         2.0,
         0.1,
         1e-4,
         false,
         {{"pickoff.gain_mismatch", 5e4},
          {"pickoff.misalignment", 30.0},
          {"forcer.misalignment", 20.0},
          {"control.phase_error", 3.0},
          {"forcer.limit", 0.0},
          {"anisotropy.frequency_split", 5.0},
          {"resonator.frequency_temperature", -1e-4}}},
        {"tuning_fork",
         0.5,
         1.0,
         100.0,
         0.3,
         0.1,
         1e-6,
         false,
         {{"drive.amplitude_error", 1e4},
          {"phase.error", 20.0},
          {"temperature.phase", 0.2},
          {"tines.asymmetry", 2e4}}},
        {"tuning_fork",
         0.5,
         1.0,
         100.0,
         0.3,
         0.1,
         1.2e-5,
         false,
         {{"arrangement", 1.0},
          {"sense.loop", 1.0},
          {"phase.error", 20.0},
          {"tines.asymmetry", 2e4}}},
    };
    for (size_t i = 0; i < sizeof variants / sizeof variants[0]; i++)
        check_variant(&variants[i]);
}

static void accelerometers(void **state)
{
    (void)state;
    static const variant variants[] = {
        {"mems_accelerometer",
         3.0,
         0.0,
         100.0,
         0.05,
         0.05,
         2e-5,
         false,
         {{"electrodes.plates", 1.0},
          {"bias.fixed", 20.0},
          {"bias.temperature", 1.0},
          {"electrodes.voltage_temperature", 200.0}}},
        {"mems_accelerometer",
         3.0,
         0.0,
         100.0,
         0.05,
         0.05,
         4e-5,
         false,
         {{"pickoff.kind", 1.0},
          {"electrodes.offset", 50.0},
          {"spring.quadratic", 2e4},
          {"spring.temperature", -500.0},
          {"spring.tilt_z", 20.0}}},
        {"mems_accelerometer",
         2.0,
         0.0,
         100.0,
         0.05,
         0.05,
         1e-5,
         false,
         {{"loop", 1.0},
          {"output.range", 2.0},
          {"analog.reset", 0.0},
          {"pickoff.offset", 30.0},
          {"bias.fixed", 10.0},
          {"electrodes.voltage_temperature", 100.0}}},
        {"mems_accelerometer",
         2.0,
         0.0,
         100.0,
         0.1,
         0.05,
         1e-5,
         false,
         {{"loop", 1.0},
          {"output.range", 2.0},
          {"pickoff.offset", 30.0},
          {"electrodes.offset", 30.0},
          {"bias.fixed", 10.0}}},
        {"pendulous_servo",
         50.0,
         0.0,
         100.0,
         0.2,
         0.05,
         2.5e-4,
         false,
         {{"hinge.torque", 1e-6},
          {"torquer.error", 5e4},
          {"torquer.temperature", 500.0},
          {"torquer.quadratic", -0.04},
          {"pendulum.misalignment_y", 5.0},
          {"pendulum.misalignment_z", -5.0}}},
        {"pendulous_servo",
         50.0,
         0.0,
         100.0,
         0.1,
         0.05,
         1.5e-5,
         true,
         {{"controller.integral", 0.0},
          {"hinge.torque", 1e-6},
          {"hinge.stiffness", 0.3},
          {"torquer.error", 5e4}}},
        /* K2 that 500 ppm between the beams' moduli make, 5 K above */
        {"vibrating_beam",
         50.0,
         0.0,
         100.0,
         0.05,
         0.05,
         1e-5,
         false,
         {{"clock", 0.0},
          {"mount.force", 0.01},
          {"proof_mass.error", 1e4},
          {"beam.temperature_mismatch", 100.0}}},
        {"vibrating_beam",
         50.0,
         0.0,
         100.0,
         0.05,
         0.05,
         5e-6,
         false,
         {{"clock", 0.0}, {"readout", 1.0}, {"mount.force", 0.01}, {"proof_mass.error", 1e4}}},
        {"vibrating_beam",
         20.0,
         0.0,
         100.0,
         0.05,
         0.05,
         2e-5,
         false,
         {{"clock", 0.0},
          {"readout", 1.0},
          {"arrangement", 1.0},
          {"mount.force", 0.01},
          {"proof_mass.error", 1e4}}},
    };
    for (size_t i = 0; i < sizeof variants / sizeof variants[0]; i++)
        check_variant(&variants[i]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(spinning_mass),
        cmocka_unit_test(optical),
        cmocka_unit_test(vibratory),
        cmocka_unit_test(accelerometers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
