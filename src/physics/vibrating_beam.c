/* SPDX-License-Identifier: Apache-2.0 */
/* Vibrating beam accelerometer: the design and its closed forms, and the reading of two counted
 * frequencies. The oscillations are in vibrating_beam_dynamics.c. */
#include "physics/vibrating_beam_internal.h"

#include "imukit/units.h"

#include <math.h>
#include <string.h>

enum { COOKIE = 0x494D4B3C };

typedef imk_vibrating_beam design_type;

/* First root of cos(x) cosh(x) = 1, and what an axial force does to the square of the frequency of
 * that mode: integral of phi'^2 / (x^4 integral of phi^2) = 12.302619/500.563902 [TIMOSHENKO1974].
 */
static const double clamped_root = 4.730040744862704;
static const double clamped_force = 0.0245775186348646;

/* Share of a beam's mass that moves with its middle: integral of (phi/phi_middle)^2. */
static const double modal_share = 0.396477920160514;

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
                            .frequency_mismatch = 0.02,
                            .frequency_temperature = -20e-6,
                            .temperature_mismatch = 0.4e-6,
                            .suspension_frequency = 1500.0,
                            .suspension_damping = 0.4,
                            .clock = 40e6,
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

#define NUMBER(path, member, unit, minimum, maximum, open, help)                                   \
    {                                                                                              \
        path, IMK_DESIGN_NUMBER, offsetof(imk_vibrating_beam, member), unit, minimum, maximum,     \
            open, NULL, help                                                                       \
    }

static const imk_design_field fields[] = {
    {"arrangement", IMK_DESIGN_CHOICE, offsetof(imk_vibrating_beam, arrangement), "1", 0.0, 0.0,
     false, "pair|single", "one beam, or two of which one is pushed and one pulled"},
    {"readout", IMK_DESIGN_CHOICE, offsetof(imk_vibrating_beam, readout), "1", 0.0, 0.0, false,
     "squares|frequencies", "difference of squares, which is linear, or of frequencies"},
    NUMBER("beam.length", length, "mm", 0.0, 1.0, true, "between the clamps"),
    NUMBER("beam.width", width, "um", 0.0, 0.1, true, "across the bending"),
    NUMBER("beam.thickness", thickness, "um", 0.0, 0.1, true, "along the bending"),
    NUMBER("beam.modulus", modulus, "Pa", 0.0, 2e12, true, "Young's modulus"),
    NUMBER("beam.density", density, "kg/m^3", 0.0, 3e4, true, "of the material"),
    NUMBER("beam.quality", quality, "1", 0.5, 1e9, true,
           "quality factor: an oscillator has Q above 1/2"),
    NUMBER("beam.amplitude", amplitude, "um", 0.0, 1e-3, true, "of its middle, peak"),
    NUMBER("beam.frequency_mismatch", frequency_mismatch, "ppm", -0.2, 0.2, false,
           "second beam against the first, relative"),
    NUMBER("beam.frequency_temperature", frequency_temperature, "ppm/K", -0.01, 0.01, false,
           "relative change of the squared frequency"),
    NUMBER("beam.temperature_mismatch", temperature_mismatch, "ppm/K", -0.01, 0.01, false,
           "second beam less the first"),
    NUMBER("proof_mass.mass", proof_mass, "kg", 0.0, 1.0, true, "mass that a beam carries"),
    NUMBER("proof_mass.error", proof_mass_error, "ppm", -0.5, 0.5, false, "relative error of it"),
    NUMBER("proof_mass.frequency", suspension_frequency, "Hz", 0.0, 1e6, true,
           "of proof mass, flexure and beams"),
    NUMBER("proof_mass.damping", suspension_damping, "1", 0.0, 10.0, true, "ratio to critical"),
    NUMBER("proof_mass.range", range, "g", 0.0, 1e6, true, "stops of the proof mass"),
    NUMBER("mount.force", mount_force, "N", -100.0, 100.0, false,
           "stress that pulls the first beam"),
    NUMBER("mount.force_repeatability", mount_force_repeatability, "N", 0.0, 100.0, false,
           "1 sigma from run to run"),
    NUMBER("mount.force_instability", mount_force_instability, "N", 0.0, 100.0, false,
           "flicker B within a run"),
    NUMBER("clock", clock, "Hz", 0.0, 1e12, false, "times the cycles; 0: without rounding"),
    NUMBER("temperature", temperature, "degC", 1.0, 1000.0, false, "where errors are stated"),
};

/* ---- what a designer computes ---------------------------------------------------------------- */

static double area_of(const design_type *d)
{
    return d->width * d->thickness;
}

static double bending_stiffness(const design_type *d)
{
    return d->modulus * area_of(d) * d->thickness * d->thickness / 12.0;
}

double imk_vibrating_beam_frequency(const imk_vibrating_beam *d, int beam)
{
    const double inverse = clamped_root / d->length;
    const double first = inverse * inverse / (2.0 * IMKI_PI) *
                         sqrt(bending_stiffness(d) / (d->density * area_of(d)));
    return beam == 0 ? first : first * (1.0 + d->frequency_mismatch);
}

double imk_vibrating_beam_stiffening(const imk_vibrating_beam *d)
{
    const double f = imk_vibrating_beam_frequency(d, 0);
    return clamped_force * f * f * d->length * d->length / bending_stiffness(d);
}

double imk_vibrating_beam_slope(const imk_vibrating_beam *d)
{
    return 0.5 * imk_vibrating_beam_stiffening(d) * d->proof_mass /
           imk_vibrating_beam_frequency(d, 0);
}

/* The reading of two frequencies, by the nominal design. */
static double reading_of(const design_type *d, double f1, double f2)
{
    const double f01 = imk_vibrating_beam_frequency(d, 0), f02 = imk_vibrating_beam_frequency(d, 1);
    const double squares = imk_vibrating_beam_stiffening(d) * d->proof_mass;
    const bool pair = d->arrangement == IMK_BEAM_PAIR;
    if (d->readout == IMK_BEAM_SQUARES)
        return pair ? ((f1 * f1 - f2 * f2) - (f01 * f01 - f02 * f02)) / (2.0 * squares)
                    : (f1 * f1 - f01 * f01) / squares;
    const double s1 = 0.5 * squares / f01, s2 = 0.5 * squares / f02;
    return pair ? ((f1 - f2) - (f01 - f02)) / (s1 + s2) : (f1 - f01) / s1;
}

double imk_vibrating_beam_reading(const imk_vibrating_beam *d, double force)
{
    const double f01 = imk_vibrating_beam_frequency(d, 0), f02 = imk_vibrating_beam_frequency(d, 1);
    const double change = imk_vibrating_beam_stiffening(d) * d->proof_mass * force;
    return reading_of(d, sqrt(f01 * f01 + change), sqrt(f02 * f02 - change));
}

double imki_beam_mass(const imk_vibrating_beam *d)
{
    return modal_share * d->density * area_of(d) * d->length;
}

/* Two-sided density of the reading per density of one frequency [m/s^2/Hz]: beams independent. */
static double per_frequency(const design_type *d)
{
    const double slope = imk_vibrating_beam_slope(d);
    return d->arrangement == IMK_BEAM_PAIR ? 1.0 / (sqrt(2.0) * slope) : 1.0 / slope;
}

/* Thermal force across the motion turns the phase: k T/(Q m w x0^2), two-sided, of the angular
 * frequency of an oscillator of amplitude x0 [BLAQUIERE1966]. */
double imki_beam_phase_density(const imk_vibrating_beam *d)
{
    const double w = 2.0 * IMKI_PI * imk_vibrating_beam_frequency(d, 0);
    return IMKI_BOLTZMANN * d->temperature /
           (d->quality * imki_beam_mass(d) * w * d->amplitude * d->amplitude);
}

double imki_suspension_density(const imk_vibrating_beam *d)
{
    const double rate = 2.0 * d->suspension_damping * 2.0 * IMKI_PI * d->suspension_frequency;
    return 2.0 * IMKI_BOLTZMANN * d->temperature * rate / d->proof_mass;
}

double imk_vibrating_beam_noise(const imk_vibrating_beam *d)
{
    const double frequency = sqrt(imki_beam_phase_density(d)) / (2.0 * IMKI_PI);
    const double beams = frequency * per_frequency(d);
    return sqrt(beams * beams + imki_suspension_density(d));
}

double imk_vibrating_beam_quantization(const imk_vibrating_beam *d)
{
    if (d->clock <= 0.0)
        return 0.0;
    return imk_vibrating_beam_frequency(d, 0) / (d->clock * sqrt(12.0)) * per_frequency(d);
}

/* ---- checks ---------------------------------------------------------------------------------- */

imk_status imk_vibrating_beam_validate(const imk_vibrating_beam *d, imk_error *error)
{
    if (d->cookie != COOKIE)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, "vibrating_beam", NULL,
                             "a design made by imk_vibrating_beam_default()");
    const imk_status status = imk_design_check(&imk_vibrating_beam_instrument, d, error);
    if (status != IMK_OK)
        return status;
    const double f1 = imk_vibrating_beam_frequency(d, 0), f2 = imk_vibrating_beam_frequency(d, 1);
    const double least = f1 < f2 ? f1 : f2;
    const double load = d->proof_mass * (1.0 + fabs(d->proof_mass_error)) * d->range +
                        fabs(d->mount_force) + 6.0 * d->mount_force_repeatability;
    const double limit = 0.9 * least * least / imk_vibrating_beam_stiffening(d);
    if (!(load < limit))
        return imki_design_refuse(error, IMK_ERROR_CONFLICT, "proof_mass.range", load, limit,
                                  "a smaller force: a beam would come near buckling (forces in N)");
    return IMK_OK;
}

/* ---- reduction ------------------------------------------------------------------------------- */

void imk_vibrating_beam_reduce(const imk_vibrating_beam *d, imk_model *model)
{
    imk_triad *t = imki_reduction_begin(model, &imk_vibrating_beam_instrument);
    const double m = d->proof_mass, f01 = imk_vibrating_beam_frequency(d, 0);
    const double f02 = imk_vibrating_beam_frequency(d, 1), slope = imk_vibrating_beam_slope(d);
    const double squares = 2.0 * f01 * slope, zeta = d->suspension_damping;
    const bool pair = d->arrangement == IMK_BEAM_PAIR, linear = d->readout == IMK_BEAM_SQUARES;
    const double c1 = d->frequency_temperature, c2 = c1 + d->temperature_mismatch;
    t->bias.fixed.value[0] = d->mount_force / m;
    t->bias.repeatability.value[0] = d->mount_force_repeatability / m;
    t->noise.bias_instability.value[0] = d->mount_force_instability / m;
    t->scale_factor.fixed.value[0] = d->proof_mass_error;
    t->bias.temperature.order = 1;
    t->bias.temperature.reference = d->temperature;
    t->bias.temperature.minimum = d->temperature - 60.0;
    t->bias.temperature.maximum = d->temperature + 60.0;
    if (linear)
        t->bias.temperature.coefficient[0].value[0] =
            pair ? (f01 * f01 * c1 - f02 * f02 * c2) / (2.0 * squares) : f01 * f01 * c1 / squares;
    else
        t->bias.temperature.coefficient[0].value[0] =
            pair ? 0.5 * (f01 * c1 - f02 * c2) / (0.5 * squares / f01 + 0.5 * squares / f02)
                 : 0.5 * f01 * c1 / slope;
    if (!linear) {
        /* f = f0 sqrt(1 + 2 u) = f0 (1 + u - u^2/2 + u^3/2 …), u = +-squares a/(2 f0^2) */
        const double u1 = 0.5 * squares / (f01 * f01), u2 = 0.5 * squares / (f02 * f02);
        const double s = pair ? f01 * u1 + f02 * u2 : f01 * u1;
        t->nonlinearity.k2.value[0] = -0.5 * (f01 * u1 * u1 - (pair ? f02 * u2 * u2 : 0.0)) / s;
        t->nonlinearity.k3.value[0] =
            0.5 * (f01 * u1 * u1 * u1 + (pair ? f02 * u2 * u2 * u2 : 0.0)) / s;
    }
    t->noise.white.value[0] = imk_vibrating_beam_noise(d);
    t->noise.quantization.value[0] = imk_vibrating_beam_quantization(d);
    const double a = 1.0 - 2.0 * zeta * zeta;
    t->bandwidth.value[0] = d->suspension_frequency * sqrt(a + sqrt(a * a + 1.0));
    t->damping.value[0] = zeta;
    t->range.value[0] = d->range;
}

/* ---- the instrument -------------------------------------------------------------------------- */

static void set_default(void *design)
{
    *(design_type *)design = imk_vibrating_beam_default();
}

static imk_status validate(const void *design, imk_error *error)
{
    return imk_vibrating_beam_validate(design, error);
}

static void reduce(const void *design, imk_model *model)
{
    imk_vibrating_beam_reduce(design, model);
}

static void step(void *state, const imk_exposure *exposure, double *outputs)
{
    const design_type *d = imki_beams_design(state);
    double f[2];
    imki_beams_advance(state, exposure, f);
    const double f01 = imk_vibrating_beam_frequency(d, 0), f02 = imk_vibrating_beam_frequency(d, 1);
    const double both = f01 * f01 + f02 * f02;
    const double reading = reading_of(d, f[0], f[1]);
    outputs[0] = reading > d->range ? d->range : reading < -d->range ? -d->range : reading;
    outputs[1] = f[0];
    outputs[2] = f[1];
    outputs[3] = d->frequency_temperature != 0.0 && d->arrangement == IMK_BEAM_PAIR
                     ? d->temperature +
                           (f[0] * f[0] + f[1] * f[1] - both) / (both * d->frequency_temperature)
                     : d->temperature;
}

static const imk_signal outputs[] = {
    {"specific_force", "m/s^2", "m/s^2", "reading"},
    {"frequency_1", "Hz", "Hz", "of the first beam"},
    {"frequency_2", "Hz", "Hz", "of the second beam"},
    {"temperature", "K", "degC", "told by the sum of the squares of a pair"},
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
     .duration = 4e-4,
     .rate = 2e6,
     .settle = 0.01},
    {.title = "The force on the beams",
     .caption = "The suspension rings before the beams see a steady force.",
     .x = -1,
     .curve_count = 1,
     .y = {2},
     .duration = 0.004,
     .rate = 1e5},
    {.title = "The beat of the beams",
     .caption = "One displacement against the other: the figure turns with the "
                "difference of the frequencies.",
     .x = 0,
     .curve_count = 1,
     .y = {1},
     .duration = 3e-4,
     .rate = 2e6,
     .settle = 0.01},
};

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

const imk_instrument imk_vibrating_beam_instrument = {
    .name = "vibrating_beam",
    .title = "vibrating beam accelerometer",
    .technology = "vibrating beam",
    .source = "40 kHz, 80 Hz/g, 70 g of the RBA-500 family; the mechanics chosen to give them",
    .sensor = IMK_ACCEL,
    .design_size = sizeof(design_type),
    .state_size = sizeof(imki_beams),
    .field_count = COUNT(fields),
    .fields = fields,
    .output_count = COUNT(outputs),
    .outputs = outputs,
    .signal_count = COUNT(signals),
    .signals = signals,
    .view_count = COUNT(views),
    .views = views,
    .set_default = set_default,
    .validate = validate,
    .init = imki_beams_start,
    .step = step,
    .observe = imki_beams_observe,
    .reduce = reduce,
    .step_length = imki_beams_step_length,
};
