/* SPDX-License-Identifier: Apache-2.0 */
/* The design of a MEMS accelerometer: its table, presets and checks. */
#include "imukit/mems_accelerometer.h"

#include "imukit/units.h"
#include "mems_accelerometer_internal.h"
#include "physics/design_rows_internal.h"

#include <math.h>

enum { DESIGN_COOKIE = 0x494D4B41, CYCLE_HALF_MAX = 8 };

#define MICRO_G (IMK_STANDARD_GRAVITY * 1e-6)

/* ---- presets --------------------------------------------------------------------------------- */

imk_mems_accelerometer imk_mems_accelerometer_default(void)
{
    return (imk_mems_accelerometer){.cookie = DESIGN_COOKIE,
                                    .loop = IMK_MEMS_OPEN,
                                    .temperature = 293.15,
                                    .mass = 1.2e-6,
                                    .frequency = 1800.0,
                                    .quality = 0.7,
                                    .spring_temperature = -64e-6,
                                    .tilt_y = 5e-3,
                                    .plates = IMK_MEMS_DOUBLE,
                                    .area = 1.6e-6,
                                    .gap = 2e-6,
                                    .offset = 10e-9,
                                    .stop = 0.5,
                                    .restitution = 0.3,
                                    .voltage = 1.0,
                                    .pickoff = IMK_MEMS_RATIO,
                                    .pickoff_noise = 1.33e-12,
                                    .feedback_voltage = 5.0,
                                    .bandwidth = 4000.0,
                                    .damping = 0.7,
                                    .reset = 100.0,
                                    .amplifier = 100e3,
                                    .clock = 100e3,
                                    .lead = 4.0,
                                    .output_bandwidth = 200.0,
                                    .range = 5e6 * MICRO_G,
                                    .gain_repeatability = 120.0 * 1e-6,
                                    .bias_repeatability = 600.0 * MICRO_G,
                                    .bias_instability = 7.5 / 0.664 * MICRO_G,
                                    .bias_temperature = 0.1 * (IMK_STANDARD_GRAVITY * 1e-3)};
}

imk_mems_accelerometer imk_mems_accelerometer_analog(void)
{
    imk_mems_accelerometer design = imk_mems_accelerometer_default();
    design.loop = IMK_MEMS_ANALOG;
    design.voltage = 4.0;
    return design;
}

imk_mems_accelerometer imk_mems_accelerometer_sigma_delta(void)
{
    imk_mems_accelerometer design = imk_mems_accelerometer_default();
    design.loop = IMK_MEMS_SIGMA_DELTA;
    design.feedback_voltage = 7.0;
    design.integral = 0.02;
    return design;
}

/* ---- table ----------------------------------------------------------------------------------- */

#define DESIGN imk_mems_accelerometer
static const imk_design_field fields[] = {
    CHOICE("loop", loop, "open|analog|sigma_delta", "what holds the mass"),
    ABOVE("temperature", temperature, "degC", 100.0, 600.0, "temperature of calibration"),
    ABOVE("proof_mass.mass", mass, "kg", 0.0, 1e-3, "mass, above 0"),
    ABOVE("proof_mass.frequency", frequency, "Hz", 0.0, 1e6,
          "frequency of the mass on its springs alone"),
    NUMBER("proof_mass.quality", quality, "1", 1e-2, 1e8,
           "quality factor in the middle of the gap"),
    SWITCH("proof_mass.squeeze_film", squeeze_film, "damping grows with the displacement"),
    NUMBER("spring.quadratic", spring_quadratic, "1/m", -1e6, 1e6,
           "relative stiffening, even: q of k x (1 + q x + r x^2)"),
    NUMBER("spring.cubic", spring_cubic, "1/m^2", -1e12, 1e12,
           "relative stiffening, odd: r of k x (1 + q x + r x^2)"),
    NUMBER("spring.temperature", spring_temperature, "ppm/K", -1e-2, 1e-2,
           "change of the stiffness with temperature"),
    NUMBER("spring.tilt_y", tilt_y, "mrad", -0.2, 0.2, "tilt of the compliant axis towards y"),
    NUMBER("spring.tilt_z", tilt_z, "mrad", -0.2, 0.2, "tilt of the compliant axis towards z"),
    CHOICE("electrodes.plates", plates, "double|single", "plates on both sides, or one"),
    ABOVE("electrodes.area", area, "mm^2", 0.0, 1e-3, "area of one plate, above 0"),
    ABOVE("electrodes.gap", gap, "um", 0.0, 1e-3, "gap at rest, above 0"),
    NUMBER("electrodes.offset", offset, "nm", -1e-4, 1e-4,
           "distance of the springs' rest from the middle of the gap"),
    NUMBER("electrodes.stop", stop, "1", 1e-3, 0.99, "place of the stops, part of the gap"),
    NUMBER("electrodes.restitution", restitution, "1", 0.0, 1.0, "of an impact on a stop"),
    NUMBER("electrodes.voltage", voltage, "V", 0.0, 1e4, "voltage of the sensing carrier, rms"),
    NUMBER("electrodes.voltage_rate", voltage_rate, "V/s", 0.0, 1e6,
           "growth of the voltage, to watch pull-in"),
    NUMBER("electrodes.voltage_temperature", voltage_temperature, "ppm/K", -1e-2, 1e-2,
           "change of all voltages with temperature"),
    CHOICE("pickoff.kind", pickoff, "ratio|difference", "of the two capacitances"),
    NUMBER("pickoff.noise", pickoff_noise, "pm/sqrt(Hz)", 0.0, 1e-6,
           "one-sided noise density, as displacement"),
    NUMBER("pickoff.offset", pickoff_offset, "nm", -1e-4, 1e-4,
           "displacement at which a loop finds its zero"),
    NUMBER("feedback.voltage", feedback_voltage, "V", 0.0, 1e4,
           "largest control voltage, or voltage of a bit"),
    ABOVE("analog.bandwidth", bandwidth, "Hz", 0.0, 1e7, "natural frequency of the loop"),
    ABOVE("analog.damping", damping, "1", 0.0, 10.0, "damping of the loop"),
    NUMBER("analog.reset", reset, "Hz", 0.0, 1e6, "corner of the integral part, 0: none"),
    ABOVE("analog.amplifier", amplifier, "Hz", 0.0, 1e9, "bandwidth of each amplifier stage"),
    ABOVE("sigma_delta.clock", clock, "kHz", 0.0, 1e9, "clock of the bits"),
    NUMBER("sigma_delta.lead", lead, "1", 0.0, 1e3, "lead of the compensator, in clocks"),
    NUMBER("sigma_delta.integral", integral, "1", 0.0, 1.0, "integral term of the compensator"),
    NUMBER("output.bandwidth", output_bandwidth, "Hz", 0.0, 1e7, "of the output filter, 0: none"),
    NUMBER("output.range", range, "g", 0.0, 1e7, "where the output is clipped, 0: nowhere"),
    NUMBER("output.resolution", resolution, "ug", 0.0, 1e5, "step of the output, 0: none"),
    NUMBER("output.gain_repeatability", gain_repeatability, "ppm", 0.0, 0.1,
           "1 sigma of the gain from run to run"),
    NUMBER("bias.fixed", bias, "mg", -1e4, 1e4, "force on the mass, as specific force"),
    NUMBER("bias.repeatability", bias_repeatability, "mg", 0.0, 1e3, "1 sigma from run to run"),
    NUMBER("bias.instability", bias_instability, "ug", 0.0, 1e3, "flicker noise B"),
    NUMBER("bias.temperature", bias_temperature, "mg/K", -10.0, 10.0, "change with temperature"),
};

static const imk_signal outputs[] = {
    {"specific_force", "m/s^2", "mg", "measured specific force, mean over the sample"}};

enum { DISPLACEMENT, VELOCITY, VOLTAGE, CONTROL, FEEDBACK, BIT, COMPENSATED };
static const imk_signal signals[] = {
    {"displacement", "m", "nm", "of the mass from the middle of the gap"},
    {"velocity", "m/s", "mm/s", "of the mass"},
    {"voltage", "V", "V", "of the sensing carrier"},
    {"control_voltage", "V", "V", "on the mass, in an analog loop"},
    {"feedback", "m/s^2", "g", "acceleration by the loop's force"},
    {"bit", "1", "1", "of a sigma-delta loop"},
    {"compensated_position", "m", "nm", "what a bit is decided by"},
};

static const imk_view views[] = {
    {.title = "Response to a step",
     .caption = "The proof mass after a step of the input: its own response, or held by the loop.",
     .x = -1,
     .curve_count = 1,
     .y = {DISPLACEMENT},
     .duration = 3e-3,
     .rate = 100e3,
     .input = IMK_STANDARD_GRAVITY},
    {.title = "Bits of the loop",
     .caption = "The force of a sigma-delta loop, clock by clock: its mean is the reading.",
     .x = -1,
     .curve_count = 1,
     .y = {FEEDBACK},
     .duration = 5e-4,
     .rate = 100e3,
     .settle = 0.02},
    {.title = "Limit cycle",
     .caption =
         "The compensated position of a sigma-delta loop in its limit cycle, and the mass that "
         "swings in it. The loop does not see an input that is too small to change a sign.",
     .x = -1,
     .curve_count = 2,
     .y = {COMPENSATED, DISPLACEMENT},
     .duration = 5e-4,
     .rate = 100e3,
     .settle = 0.02},
    {.title = "Pull-in",
     .caption = "Displacement against the voltage of the plates while it grows "
                "(electrodes.voltage_rate): beyond pull-in there is no equilibrium.",
     .x = VOLTAGE,
     .curve_count = 1,
     .y = {DISPLACEMENT},
     .duration = 1.0,
     .rate = 1000.0},
};

/* ---- checks ---------------------------------------------------------------------------------- */

static imk_status check_rest(const imk_mems_accelerometer *d, imk_error *error)
{
    const double end = d->stop * d->gap, pull_in = imk_mems_accelerometer_pull_in(d);
    if (!(fabs(d->offset) < end))
        return imki_conflict(error, "electrodes.offset", d->offset, end,
                             "an offset between the stops");
    imk_mems_accelerometer open = *d;
    open.loop = IMK_MEMS_OPEN;
    if (!imki_mems_operating_point(&open).exists)
        return imki_conflict(error, "electrodes.voltage", d->voltage, pull_in,
                             "a voltage below pull-in, with an equilibrium between the stops");
    if (d->loop != IMK_MEMS_OPEN && d->plates == IMK_MEMS_SINGLE)
        return imki_conflict(error, "electrodes.plates", (double)d->plates, (double)IMK_MEMS_DOUBLE,
                             "use plates on both sides: one plate can only pull");
    if (d->loop != IMK_MEMS_OPEN && !(fabs(d->pickoff_offset) < end))
        return imki_conflict(error, "pickoff.offset", d->pickoff_offset, end,
                             "a null between the stops");
    return IMK_OK;
}

static imk_status check_force(const imk_mems_accelerometer *d, imk_error *error)
{
    const double limit = imk_mems_accelerometer_limit(d);
    if (!(limit > 0.0) || d->range > limit)
        return imki_conflict(error, "output.range", d->range, limit,
                             d->loop == IMK_MEMS_OPEN
                                 ? "a range within the travel of the mass"
                                 : "a range that the force of the loop can balance");
    const double bias = fabs(d->bias) + 6.0 * d->bias_repeatability;
    if (!(bias < limit))
        return imki_conflict(error, "bias.fixed", bias, limit,
                             "a bias (and six times its repeatability) below the largest input of "
                             "the mass or the loop");
    return IMK_OK;
}

/* The control voltage at full scale softens the springs further. */
static imk_status check_analog(const imk_mems_accelerometer *d, imk_error *error)
{
    const imk_mems_gains gains = imk_mems_accelerometer_gains(d);
    const imki_mems_point p = imki_mems_operating_point(d);
    const double stiffness = imki_mems_stiffness(d);
    const double force = d->range > 0.0 ? d->range : imk_mems_accelerometer_limit(d);
    const double u = force / imk_mems_accelerometer_limit(d) * d->feedback_voltage;
    const double at_full_scale = stiffness - imki_mems_attraction(d, u * u, u * u, 0.0).first;
    if (!p.exists)
        return imki_conflict(error, "pickoff.offset", d->pickoff_offset, d->offset,
                             "a null at which the plates can hold the mass");
    if (!(gains.proportional > 0.0))
        return imki_conflict(error, "analog.bandwidth", d->bandwidth,
                             sqrt(stiffness) / (2.0 * IMKI_PI),
                             "a loop stiffer than the softened springs");
    if (!imki_mems_loop_stable(d, stiffness) || !imki_mems_loop_stable(d, p.a1))
        return imki_conflict(
            error, "analog.bandwidth", d->bandwidth, d->amplifier,
            "a stable loop: use a lower bandwidth or reset, or a faster amplifier");
    if (!imki_mems_loop_stable(d, at_full_scale))
        return imki_conflict(error, "analog.bandwidth", d->bandwidth, u,
                             "a loop that is stable at full scale too, where the control "
                             "voltage softens the springs");
    return IMK_OK;
}

static imk_status check_sigma_delta(const imk_mems_accelerometer *d, imk_error *error)
{
    const imki_mems_point p = imki_mems_operating_point(d);
    if (!(fabs(p.rest) < p.unit))
        return imki_conflict(error, "feedback.voltage", d->feedback_voltage, 0.0,
                             "a force of either sign at the null of the loop");
    const imk_mems_limit_cycle cycle = imk_mems_accelerometer_limit_cycle(d);
    if (cycle.half_period == 0 || cycle.half_period > CYCLE_HALF_MAX)
        return imki_conflict(error, "sigma_delta.lead", d->lead, 0.0,
                             "use more lead: the loop has no limit cycle of 16 clocks or less, and "
                             "its swing keeps growing");
    if (!(cycle.amplitude < 0.5 * d->stop * d->gap))
        return imki_conflict(error, "sigma_delta.clock", d->clock, 0.0,
                             "a clock whose limit cycle stays within half the stops");
    const imk_mems_quantizer quantizer = imk_mems_accelerometer_quantizer(d);
    if (!isfinite(quantizer.velocity) || !(quantizer.deviation < 0.5 * d->stop * d->gap))
        return imki_refuse(error, IMK_ERROR_CONFLICT,
                           d->integral > 0.0 ? "sigma_delta.integral" : "sigma_delta.clock",
                           d->integral > 0.0 ? d->integral : d->clock, quantizer.deviation,
                           "a faster clock, a smaller integral term or less noise: the "
                           "compensated position swings as far as half the stops");
    return IMK_OK;
}

static imk_status check(const void *given, imk_error *error)
{
    const imk_mems_accelerometer *d = given;
    imk_status status = check_rest(d, error);
    if (status == IMK_OK)
        status = check_force(d, error);
    if (status == IMK_OK && d->loop == IMK_MEMS_ANALOG)
        status = check_analog(d, error);
    if (status == IMK_OK && d->loop == IMK_MEMS_SIGMA_DELTA)
        status = check_sigma_delta(d, error);
    if (status == IMK_OK)
        status = imki_check_bias(&imk_mems_accelerometer_instrument, d, "output.range", error);
    return status;
}

/* ---- the instrument -------------------------------------------------------------------------- */

IMKI_DESIGN_FUNCTIONS(mems_accelerometer);

const imk_instrument imk_mems_accelerometer_instrument = {
    IMKI_DESCRIBED(mems_accelerometer),
    .title = "MEMS accelerometer",
    .technology = "MEMS",
    .source = "Safran Colibrys MS1000 datasheet, MS1005 (2016); mass, plates and voltages chosen",
    .sensor = IMK_ACCEL,
    .cookie = DESIGN_COOKIE,
    .state_size = sizeof(imki_mems_state),
    .init = imki_mems_init,
    .step = imki_mems_step,
    .observe = imki_mems_observe,
    .step_length = imki_mems_step_length,
};
