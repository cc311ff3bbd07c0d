/* SPDX-License-Identifier: Apache-2.0 */
/* The fibre-optic gyro as an instrument: its design table, default design, checks, signals and
 * views. Equations: fibre_optic_formulas.c; dynamics: fibre_optic_dynamics.c. */
#include "imukit/fibre_optic.h"

#include "fibre_optic_internal.h"
#include "imukit/elementary.h"
#include "physics/design_rows_internal.h"

#include <math.h>

enum { COOKIE = 0x494D4B31 };

/* The numbers as a design file has them, so that they are printed as they stand here. */
#define DECIBEL 0.23025850929940458 /* ln(10)/10, as an exponent of power */
#define PARTS_PER_MILLION 1e-6
#define MICRO 1e-6
#define NANO 1e-9

imk_fibre_optic imk_fibre_optic_default(void)
{
    return (imk_fibre_optic){
        .cookie = COOKIE,
        .loop = IMK_FIBRE_OPTIC_CLOSED,
        .coil_length = 1000.0,
        .coil_diameter = 0.32,
        .coil_index = 1.45, /* silica near 1550 nm */
        .coil_attenuation = 1 * (DECIBEL / 1000.0),
        .coil_expansion = 1 * PARTS_PER_MILLION,
        .thermo_optic = 1e-5,
        .winding_residual = 0.01,
        .source_power = 1e-3,
        .wavelength = 1550 * NANO,
        .wavelength_repeatability = 11 * PARTS_PER_MILLION,
        .wavelength_temperature = 5 * PARTS_PER_MILLION,
        .linewidth = 19.35 * NANO,
        .optics_loss = 13 * DECIBEL, /* with the coil 14 dB */
        .visibility = 0.98,
        .modulation_depth = 120 * IMKI_DEGREE, /* 120 deg: less noise than 90 deg when the source's
                                          intensity noise dominates [LEFEVRE2014] */
        .ramp_bits = 12,
        .responsivity = 0.9,
        .load_resistance = 1e5,
        .converter_range = 32 * MICRO, /* the whole fringe: with less, it does not lock when it is
                                          switched on at a high rate */
        .converter_bits = 15,
        .loop_gain = 0.1,
        .range = 80 * IMKI_DEGREE, /* a fringe is 83.2 deg/s */
        .output_bits = 10,
        .phase_temperature = 0.005 * MICRO,
        .phase_repeatability = 0.21 * MICRO, /* 0.01 deg/h */
        .phase_instability = 0.06 * MICRO,   /* 0.003 deg/h */
    };
}

/* ---- the design table ------------------------------------------------------------------------ */

#define DESIGN imk_fibre_optic
static const imk_design_field fields[] = {
    CHOICE("loop.mode", loop, "closed|open", "how the phase is read"),
    ABOVE("loop.gain", loop_gain, "1", 0, 2,
          "share of the phase error that each step of the loop takes away"),
    NUMBER("loop.crosstalk", crosstalk, "urad", 0, 1,
           "phase error in step with the ramp: makes a dead zone"),
    ABOVE("loop.range", range, "deg/s", 0, 1e3, "largest rate that is read"),
    ABOVE("coil.length", coil_length, "m", 0, 1e6, "length of the fibre"),
    ABOVE("coil.diameter", coil_diameter, "mm", 0, 1e3, "mean diameter of the coil"),
    NUMBER("coil.index", coil_index, "1", 1, 3, "group index of the fibre"),
    NUMBER("coil.attenuation", coil_attenuation, "dB/km", 0, 1, "loss of the fibre"),
    NUMBER("coil.expansion", coil_expansion, "ppm/K", -1e-3, 1e-3,
           "growth of length times diameter"),
    NUMBER("coil.thermo_optic", thermo_optic, "1/K", -1e-3, 1e-3, "dn/dT of the fibre"),
    NUMBER("coil.winding_residual", winding_residual, "1", -1, 1,
           "share of the Shupe effect that the winding leaves"),
    ABOVE("source.power", source_power, "mW", 0, 10, "power of the light source"),
    NUMBER("source.power_error", power_error, "%", -0.9, 10, "departure of the power"),
    ABOVE("source.wavelength", wavelength, "nm", 1e-7, 1e-4, "mean wavelength in vacuum"),
    NUMBER("source.wavelength_error", wavelength_error, "ppm", -0.1, 0.1,
           "departure of the wavelength"),
    NUMBER("source.wavelength_repeatability", wavelength_repeatability, "ppm", 0, 0.01,
           "1 sigma of the wavelength from run to run"),
    NUMBER("source.wavelength_temperature", wavelength_temperature, "ppm/K", -1e-3, 1e-3,
           "change of the wavelength with temperature"),
    ABOVE("source.linewidth", linewidth, "nm", 0, 1e-5, "equivalent width of the spectrum"),
    NUMBER("source.intensity_noise", intensity_noise, "1/Hz", 0, 1e-3,
           "relative intensity noise, one-sided; 0: that of thermal light of this linewidth"),
    NUMBER("optics.loss", optics_loss, "dB", 0, 50, "loss of everything but the fibre"),
    NUMBER("optics.visibility", visibility, "1", 1e-6, 1, "contrast of the fringes"),
    ABOVE("modulator.depth", modulation_depth, "deg", 0, 3.1, "phase modulation at the detector"),
    NUMBER("modulator.depth_error", depth_error, "%", -0.5, 0.5, "departure of the depth"),
    NUMBER("modulator.gain_error", gain_error, "ppm", -0.1, 0.1, "error of the ramp's phase"),
    NUMBER("modulator.reset_error", reset_error, "ppm", -0.1, 0.1,
           "departure of the ramp's reset from 2 pi"),
    COUNT("modulator.bits", ramp_bits, 0, 30, "of the ramp's converter, to 2 pi; 0: continuous"),
    ABOVE("detector.responsivity", responsivity, "A/W", 0, 10, "current per power"),
    ABOVE("detector.load", load_resistance, "ohm", 0, 1e12, "resistor that the current flows into"),
    NUMBER("detector.converter_range", converter_range, "uW", 0, 10,
           "departure from the operating point that saturates the amplifier; 0: none"),
    COUNT("detector.converter_bits", converter_bits, 0, 30, "to both sides of it; 0: continuous"),
    NUMBER("detector.demodulation_error", demodulation_error, "%", -0.9, 10,
           "departure of the demodulator's gain"),
    COUNT("output.bits", output_bits, 0, 30, "counts of the angle to a fringe; 0: not rounded"),
    NUMBER("phase.fixed", phase_fixed, "urad", -1, 1, "nonreciprocal phase"),
    NUMBER("phase.temperature", phase_temperature, "urad/K", -1e-2, 1e-2,
           "change of that phase with temperature"),
    NUMBER("phase.repeatability", phase_repeatability, "urad", 0, 1,
           "1 sigma of that phase from run to run"),
    NUMBER("phase.instability", phase_instability, "urad", 0, 0.1,
           "flicker of that phase within a run"),
};

/* ---- checks ---------------------------------------------------------------------------------- */

static imk_status check_optics(const imk_fibre_optic *design, imk_error *error)
{
    const double turn = IMKI_PI * design->coil_diameter;
    if (!(design->coil_length >= turn))
        return imki_conflict(error, "coil.length", design->coil_length, turn,
                             "a length of at least one turn, pi times the diameter");
    if (!(design->linewidth < design->wavelength))
        return imki_conflict(error, "source.linewidth", design->linewidth, design->wavelength,
                             "a linewidth below the wavelength");
    const imki_fibre_optic_point point = imki_fibre_optic_operate(design);
    if (!(point.half_power > 0.0))
        return imki_conflict(error, "optics.loss", design->optics_loss, 0.0,
                             "a loss that leaves some light on the detector");
    if (!(point.depth < 3.1))
        return imki_conflict(error, "modulator.depth_error", design->depth_error, 3.1,
                             "a depth that stays below 3.1 rad");
    if (design->converter_bits > 0 && !(design->converter_range > 0.0))
        return imki_conflict(error, "detector.converter_range", design->converter_range, 0.0,
                             "a range above 0 for a converter that has bits");
    return IMK_OK;
}

/* Noise of one reading (of a transit; open loop, of a period) dithers the converter: a step of two
 * standard deviations leaves 0.2 % of a step of error, e^(-pi^2/2)/pi, one of four 20 %. */
static imk_status check_converter(const imk_fibre_optic *design, imk_error *error)
{
    const imki_fibre_optic_point point = imki_fibre_optic_operate(design);
    const double transits = design->loop == IMK_FIBRE_OPTIC_OPEN ? 2.0 : 1.0;
    const double sigma = sqrt(imki_fibre_optic_demodulated_noise(design, &point) /
                              (2.0 * transits * imk_fibre_optic_transit_time(design)));
    if (point.count > 2.0 * sigma)
        return imki_conflict(error, "detector.converter_bits", point.count, 2.0 * sigma,
                             "use more bits: a step must be below two standard deviations of the "
                             "noise, which serves as dither");
    return IMK_OK;
}

static imk_status check_open_range(const imk_fibre_optic *design, double phase, imk_error *error)
{
    if (!(phase <= 0.5 * IMKI_PI * (1.0 + 1e-9)))
        return imki_conflict(
            error, "loop.range", phase, 0.5 * IMKI_PI,
            "a range up to a phase of pi/2, beyond which the open loop's reading decreases");
    const double harmonic = imki_fibre_optic_operate(design).slope * imk_sin(phase);
    if (design->converter_range > 0.0 && !(design->converter_range >= harmonic))
        return imki_conflict(error, "detector.converter_range", design->converter_range, harmonic,
                             "a range that includes the harmonic at the end of loop.range");
    return IMK_OK;
}

static imk_status check_loop(const imk_fibre_optic *design, imk_error *error)
{
    const bool open = design->loop == IMK_FIBRE_OPTIC_OPEN;
    const double phase = design->range * imk_fibre_optic_scale(design);
    if (open)
        return check_open_range(design, phase, error);
    if (!(phase < 2.0 * IMKI_PI))
        return imki_conflict(error, "loop.range", phase, 2.0 * IMKI_PI,
                             "a range below one fringe, 2 pi per transit of the ramp");
    const double gain = imk_fibre_optic_effective_gain(design);
    if (!(gain < 2.0))
        return imki_conflict(error, "loop.gain", gain, 2.0,
                             "an effective gain below 2: beyond it the loop's error grows");
    /* The noise of a pair of transits, through the loop: variance times g/(2 - g). At 0.3 rad a
     * slip of a fringe, pi away, is a 10 sigma event. */
    const double noise = imk_fibre_optic_phase_noise(design);
    const double deviation =
        noise * sqrt(gain / (2.0 - gain) / (4.0 * imk_fibre_optic_transit_time(design)));
    if (!(deviation < 0.3))
        return imki_conflict(error, "source.power", deviation, 0.3,
                             "use more light: the loop's phase noise must stay below 0.3 rad, or "
                             "the loop slips fringes");
    return IMK_OK;
}

static imk_status check(const void *given, imk_error *error)
{
    const imk_fibre_optic *design = given;
    imk_status status = check_optics(design, error);
    if (status == IMK_OK)
        status = check_converter(design, error);
    if (status == IMK_OK)
        status = check_loop(design, error);
    if (status == IMK_OK)
        status = imki_check_bias(&imk_fibre_optic_instrument, design, "loop.range", error);
    return status;
}

/* ---- the instrument -------------------------------------------------------------------------- */

static const imk_signal outputs[] = {
    {"angular_rate", "rad/s", "deg/s", "measured rate about the coil's axis"},
    {"reset_rate", "Hz", "kHz", "resets of the ramp per second, up less down"},
};

static const imk_signal signals[IMKI_FIBRE_OPTIC_SIGNALS] = {
    {"input_rate", "rad/s", "deg/s", "rate that the coil turns with"},
    {"feedback_rate", "rad/s", "deg/s", "rate that the loop, or the harmonic, stands for"},
    {"phase_error", "rad", "rad", "phase between the waves without the modulation"},
    {"phase", "rad", "rad", "phase between the waves, modulation included"},
    {"detector_power", "W", "uW", "power on the detector"},
    {"ramp", "rad", "rad", "phase of the digital ramp"},
    {"nonreciprocal_phase", "rad", "urad", "phase of imperfections, Shupe effect included"},
    {"scale_factor_error", "1", "ppm", "departure of the phase per rate"},
};

static const imk_view views[] = {
    {.title = "Light on the fringe",
     .caption =
         "Power on the detector against the phase between the two waves, from switching on. The "
         "modulation moves the phase from one side of the fringe to the other, and the loop shifts "
         "both points until they are equally bright. Resets of the ramp lead to the next fringes.",
     .x = IMKI_FIBRE_OPTIC_DIFFERENCE,
     .curve_count = 1,
     .y = {IMKI_FIBRE_OPTIC_POWER},
     .duration = 600e-6,
     .rate = 1e6,
     .input = 25.0 * IMKI_DEGREE,
     .points = true,
     .law = imki_fibre_optic_fringe,
     .law_name = "fringe"},
    {.title = "The ramp and its resets",
     .caption = "The phase of the digital ramp: its slope cancels the rotation, and it falls back "
                "by 2 pi.",
     .x = -1,
     .curve_count = 1,
     .y = {IMKI_FIBRE_OPTIC_RAMP},
     .duration = 400e-6,
     .rate = 1e6,
     .settle = 2e-3,
     .input = 10.0 * IMKI_DEGREE},
    {.title = "The loop locks",
     .caption = "Rate of the coil, and rate that the feedback represents, from switching on.",
     .x = -1,
     .curve_count = 2,
     .y = {IMKI_FIBRE_OPTIC_FEEDBACK, IMKI_FIBRE_OPTIC_INPUT},
     .duration = 1e-3,
     .rate = 400e3,
     .input = 10.0 * IMKI_DEGREE},
    {.title = "What the detector sees",
     .caption = "Power on the detector, transit by transit: square waves while the loop is not "
                "locked, noise "
                "when it is.",
     .x = -1,
     .curve_count = 1,
     .y = {IMKI_FIBRE_OPTIC_POWER},
     .duration = 400e-6,
     .rate = 1e6,
     .input = 10.0 * IMKI_DEGREE},
};

IMKI_DESIGN_FUNCTIONS(fibre_optic);

const imk_instrument imk_fibre_optic_instrument = {
    IMKI_DESCRIBED(fibre_optic),
    .title = "fibre-optic gyro",
    .technology = "FOG",
    .source = "coil, loss, noise, bias and scale factor of Moeller, Burns, Frigo, J. Lightwave "
              "Technol. 7 (1989) 262, doi:10.1109/50.17765; closed loop and electronics chosen",
    .sensor = IMK_GYRO,
    .cookie = COOKIE,
    .state_size = sizeof(imki_fibre_optic_state),
    .init = imki_fibre_optic_init,
    .step = imki_fibre_optic_step,
    .observe = imki_fibre_optic_observe,
    .step_length = imki_fibre_optic_step_length,
};
