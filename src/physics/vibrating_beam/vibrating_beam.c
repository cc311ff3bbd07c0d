/* SPDX-License-Identifier: Apache-2.0 */
/* Vibrating beam accelerometer: design, checks and description. Equations:
 * vibrating_beam_formulas.c; the oscillations: vibrating_beam_dynamics.c. */
#include "vibrating_beam_internal.h"

#include "imukit/units.h"
#include "physics/design_rows_internal.h"

#include <math.h>

enum { COOKIE = 0x494D4B3C };

typedef imk_vibrating_beam design_type;

imk_vibrating_beam imk_vibrating_beam_default(void)
{
    imk_vibrating_beam d = {.cookie = COOKIE,
                            .arrangement = IMK_BEAM_PAIR,
                            .readout = IMK_BEAM_SQUARES,
                            .length = 4.8e-3,
                            .width = 150e-6,
                            .thickness = 165e-6,
                            .modulus = 78e9,
                            .density = 2650.0,
                            .quality = 10000.0,
                            .amplitude = 1e-6,
                            .pickoff_noise = 3.0 * 1e-9,
                            .frequency_mismatch = 0.02,
                            .frequency_temperature = -20.0 * 1e-6,
                            .temperature_mismatch = 0.4e-6,
                            .suspension_frequency = 1500.0,
                            .suspension_damping = 0.4,
                            .clock = 100e6,
                            .range = 70.0 * IMK_STANDARD_GRAVITY,
                            .temperature = 293.15};
    /* the mass that makes 80 Hz/g, the length that makes 40 kHz */
    d.length *= sqrt(imk_vibrating_beam_frequency(&d, 0) / 40000.0);
    d.proof_mass =
        2.0 * 40000.0 * (80.0 / IMK_STANDARD_GRAVITY) / imk_vibrating_beam_stiffening(&d);
    const double milli_g = 1e-3 * IMK_STANDARD_GRAVITY * d.proof_mass;
    d.mount_force = 5.0 * milli_g;
    d.mount_force_repeatability = 0.5 * milli_g;
    d.mount_force_instability = 0.005 * milli_g;
    return d;
}

#define DESIGN imk_vibrating_beam
static const imk_design_field fields[] = {
    CHOICE("arrangement", arrangement, "pair|single",
           "one beam, or two of which one is pushed and one pulled"),
    CHOICE("readout", readout, "squares|frequencies",
           "difference of squares, which is nearly linear, or of frequencies"),
    NUMBER("beam.length", length, "mm", 1e-6, 1.0, "between the clamps"),
    NUMBER("beam.width", width, "um", 1e-8, 0.1, "across the bending"),
    NUMBER("beam.thickness", thickness, "um", 1e-8, 0.1, "along the bending"),
    NUMBER("beam.modulus", modulus, "GPa", 1e6, 2e12, "Young's modulus"),
    NUMBER("beam.density", density, "kg/m^3", 1.0, 3e4, "of the material"),
    ABOVE("beam.quality", quality, "1", 0.5, 1e9, "quality factor: an oscillator has Q above 1/2"),
    ABOVE("beam.amplitude", amplitude, "um", 0.0, 1e-3, "of its middle, peak"),
    NUMBER("beam.pickoff_noise", pickoff_noise, "nm", 0.0, 1e-3,
           "rms of what the comparator gets beside the motion"),
    NUMBER("beam.frequency_mismatch", frequency_mismatch, "ppm", -0.2, 0.2,
           "second beam against the first, relative"),
    NUMBER("beam.frequency_temperature", frequency_temperature, "ppm/K", -0.01, 0.01,
           "relative change of the squared frequency"),
    NUMBER("beam.temperature_mismatch", temperature_mismatch, "ppm/K", -0.01, 0.01,
           "second beam less the first"),
    NUMBER("proof_mass.mass", proof_mass, "kg", 1e-12, 1.0, "mass that a beam carries"),
    NUMBER("proof_mass.error", proof_mass_error, "ppm", -0.5, 0.5, "relative error of it"),
    NUMBER("proof_mass.frequency", suspension_frequency, "Hz", 1e-3, 1e6,
           "of proof mass, flexure and beams"),
    ABOVE("proof_mass.damping", suspension_damping, "1", 0.0, 10.0, "ratio to critical"),
    ABOVE("proof_mass.range", range, "g", 0.0, 1e6, "stops of the proof mass"),
    NUMBER("mount.force", mount_force, "N", -100.0, 100.0, "stress that pulls the first beam"),
    NUMBER("mount.force_repeatability", mount_force_repeatability, "N", 0.0, 100.0,
           "1 sigma from run to run"),
    NUMBER("mount.force_instability", mount_force_instability, "N", 0.0, 100.0,
           "flicker B within a run"),
    NUMBER("clock", clock, "MHz", 0.0, 1e12, "times the cycles; 0: without rounding"),
    NUMBER("temperature", temperature, "degC", 1.0, 1000.0, "where errors are stated"),
};

/* ---- checks ---------------------------------------------------------------------------------- */

/* What the equations suppose: a slender beam, a clock that tells two crossings apart, and an
 * amplitude that neither thermal motion, sqrt(kT/m)/w, nor the pickoff's noise hides. */
static imk_status check_beam(const design_type *d, imk_error *error)
{
    const double f1 = imk_vibrating_beam_frequency(d, 0), f2 = imk_vibrating_beam_frequency(d, 1);
    const double highest = 1.4 * (f1 > f2 ? f1 : f2); /* at the limit of the load */
    if (!(d->thickness <= 0.2 * d->length))
        return imki_conflict(error, "beam.thickness", d->thickness, 0.2 * d->length,
                             "at most a fifth of the length: a beam is slender");
    if (d->clock > 0.0 && !(d->clock >= 4.0 * highest))
        return imki_conflict(error, "clock", d->clock, 4.0 * highest,
                             "0, or at least four ticks to a cycle of the beams");
    const double thermal = sqrt(IMKI_BOLTZMANN * d->temperature / imki_beam_mass(d)) /
                           (2.0 * IMKI_PI * (f1 < f2 ? f1 : f2));
    if (!(d->amplitude >= 10.0 * thermal))
        return imki_conflict(error, "beam.amplitude", d->amplitude, 10.0 * thermal,
                             "at least ten times the thermal motion");
    if (!(d->amplitude >= 10.0 * d->pickoff_noise))
        return imki_conflict(error, "beam.pickoff_noise", d->pickoff_noise, 0.1 * d->amplitude,
                             "at most a tenth of the amplitude, or crossings are counted twice");
    return IMK_OK;
}

/* Mount and mass push one beam; nine tenths of the buckling load leave room for temperature. */
static imk_status check(const void *given, imk_error *error)
{
    const imk_vibrating_beam *d = given;
    imk_status status = check_beam(d, error);
    if (status != IMK_OK)
        return status;
    const double limit = 0.9 * imk_vibrating_beam_buckling(d);
    const double mount =
        fabs(d->mount_force) + 6.0 * (d->mount_force_repeatability + d->mount_force_instability);
    if (!(mount < limit))
        return imki_conflict(error, "mount.force", mount, limit,
                             "a smaller force with six of its sigmas: nine tenths of what buckles "
                             "a beam");
    const double most = (limit - mount) / (d->proof_mass * (1.0 + fabs(d->proof_mass_error)));
    if (!(d->range < most))
        return imki_conflict(error, "proof_mass.range", d->range, most,
                             "less: mass times range and the mount's force come to nine tenths of "
                             "what buckles a beam");
    return IMK_OK;
}

/* ---- the instrument -------------------------------------------------------------------------- */

static void step(void *state, const imk_exposure *exposure, double *outputs)
{
    const imki_beams *s = state;
    const design_type *d = &s->d;
    double f[2];
    imki_beams_advance(state, exposure, f);
    outputs[0] = imki_clamped(imki_beams_reading(d, f[0], f[1]), d->range);
    outputs[1] = f[0];
    outputs[2] = f[1];
    outputs[3] = d->temperature;
    if (d->frequency_temperature != 0.0 && d->arrangement == IMK_BEAM_PAIR)
        outputs[3] += imki_beams_warmth(d, s->series, f[0], f[1]);
}

static const imk_signal outputs[] = {
    {"specific_force", "m/s^2", "m/s^2", "reading"},
    {"frequency_1", "Hz", "Hz", "of the first beam"},
    {"frequency_2", "Hz", "Hz", "of the second beam"},
    {"temperature", "K", "degC", "told by both frequencies of a pair"},
};
static const imk_signal signals[] = {
    {"displacement_1", "m", "um", "of the middle of the first beam"},
    {"displacement_2", "m", "um", "of the middle of the second beam"},
    {"force", "N", "mN", "axial force on the first beam"},
    {"amplitude_1", "m", "um", "of the first beam"},
    {"amplitude_2", "m", "um", "of the second beam"},
};
static const imk_view views[] = {
    {.title = "Two beams drift apart",
     .caption =
         "Both beams vibrate with their own frequency; the force pulls one up and the other down.",
     .x = -1,
     .curve_count = 2,
     .y = {0, 1},
     .duration = 2e-4,
     .rate = 4e6,
     .settle = 0.01,
     .input = 10.0 * IMK_STANDARD_GRAVITY},
    {.title = "The force on the beams",
     .caption = "The suspension rings before the beams see a steady force.",
     .x = -1,
     .curve_count = 1,
     .y = {2},
     .duration = 0.004,
     .rate = 1e5,
     .input = 10.0 * IMK_STANDARD_GRAVITY},
    {.title = "The beat of the beams",
     .caption = "One displacement against the other: the figure turns with the "
                "difference of the frequencies.",
     .x = 0,
     .curve_count = 1,
     .y = {1},
     .duration = 3e-4,
     .rate = 2e6,
     .settle = 0.01,
     .input = 10.0 * IMK_STANDARD_GRAVITY},
};

IMKI_DESIGN_FUNCTIONS(vibrating_beam);

const imk_instrument imk_vibrating_beam_instrument = {
    IMKI_DESCRIBED(vibrating_beam),
    .title = "vibrating beam accelerometer",
    .technology = "vibrating beam",
    .source = "40 kHz, 80 Hz/g, 70 g of the RBA-500 family; the mechanics chosen to give them",
    .sensor = IMK_ACCEL,
    .cookie = COOKIE,
    .state_size = sizeof(imki_beams),
    .init = imki_beams_start,
    .step = step,
    .observe = imki_beams_observe,
    .step_length = imki_beams_step_length,
};
