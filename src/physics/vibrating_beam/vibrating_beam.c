/* SPDX-License-Identifier: Apache-2.0 */
/* Vibrating beam accelerometer: the design and its closed forms, and the reading of two counted
 * frequencies. The oscillations are in vibrating_beam_dynamics.c. */
#include "vibrating_beam_internal.h"

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
                            .frequency_temperature = -20.0 * 1e-6,
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
    NUMBER("beam.length", length, "mm", 1e-6, 1.0, false, "between the clamps"),
    NUMBER("beam.width", width, "um", 1e-8, 0.1, false, "across the bending"),
    NUMBER("beam.thickness", thickness, "um", 1e-8, 0.1, false, "along the bending"),
    NUMBER("beam.modulus", modulus, "GPa", 1e6, 2e12, false, "Young's modulus"),
    NUMBER("beam.density", density, "kg/m^3", 1.0, 3e4, false, "of the material"),
    NUMBER("beam.quality", quality, "1", 0.5, 1e9, true,
           "quality factor: an oscillator has Q above 1/2"),
    NUMBER("beam.amplitude", amplitude, "um", 0.0, 1e-3, true, "of its middle, peak"),
    NUMBER("beam.frequency_mismatch", frequency_mismatch, "ppm", -0.2, 0.2, false,
           "second beam against the first, relative"),
    NUMBER("beam.frequency_temperature", frequency_temperature, "ppm/K", -0.01, 0.01, false,
           "relative change of the squared frequency"),
    NUMBER("beam.temperature_mismatch", temperature_mismatch, "ppm/K", -0.01, 0.01, false,
           "second beam less the first"),
    NUMBER("proof_mass.mass", proof_mass, "kg", 1e-12, 1.0, false, "mass that a beam carries"),
    NUMBER("proof_mass.error", proof_mass_error, "ppm", -0.5, 0.5, false, "relative error of it"),
    NUMBER("proof_mass.frequency", suspension_frequency, "Hz", 1e-3, 1e6, false,
           "of proof mass, flexure and beams"),
    NUMBER("proof_mass.damping", suspension_damping, "1", 0.0, 10.0, true, "ratio to critical"),
    NUMBER("proof_mass.range", range, "g", 0.0, 1e6, true, "stops of the proof mass"),
    NUMBER("mount.force", mount_force, "N", -100.0, 100.0, false,
           "stress that pulls the first beam"),
    NUMBER("mount.force_repeatability", mount_force_repeatability, "N", 0.0, 100.0, false,
           "1 sigma from run to run"),
    NUMBER("mount.force_instability", mount_force_instability, "N", 0.0, 100.0, false,
           "flicker B within a run"),
    NUMBER("clock", clock, "MHz", 0.0, 1e12, false, "times the cycles; 0: without rounding"),
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

/* What the equations suppose: a slender beam, a clock that tells two crossings apart, and an
 * amplitude that thermal motion, sqrt(kT/m)/w, does not hide. */
static imk_status check_beam(const design_type *d, imk_error *error)
{
    const double f1 = imk_vibrating_beam_frequency(d, 0), f2 = imk_vibrating_beam_frequency(d, 1);
    const double highest = 1.4 * (f1 > f2 ? f1 : f2); /* at the limit of the load */
    if (!(d->thickness <= 0.2 * d->length))
        return imki_design_refuse(error, IMK_ERROR_CONFLICT, "beam.thickness", d->thickness,
                                  0.2 * d->length,
                                  "at most a fifth of the length: a beam is slender");
    if (d->clock > 0.0 && !(d->clock >= 4.0 * highest))
        return imki_design_refuse(error, IMK_ERROR_CONFLICT, "clock", d->clock, 4.0 * highest,
                                  "0, or at least four ticks to a cycle of the beams");
    const double thermal = sqrt(IMKI_BOLTZMANN * d->temperature / imki_beam_mass(d)) /
                           (2.0 * IMKI_PI * (f1 < f2 ? f1 : f2));
    if (!(d->amplitude >= 10.0 * thermal))
        return imki_design_refuse(error, IMK_ERROR_CONFLICT, "beam.amplitude", d->amplitude,
                                  10.0 * thermal, "at least ten times the thermal motion");
    return IMK_OK;
}

imk_status imk_vibrating_beam_validate(const imk_vibrating_beam *d, imk_error *error)
{
    if (d->cookie != COOKIE)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, "vibrating_beam", NULL,
                             "a design made by imk_vibrating_beam_default()");
    imk_status status = imk_design_check(&imk_vibrating_beam_instrument, d, error);
    if (status == IMK_OK)
        status = check_beam(d, error);
    if (status != IMK_OK)
        return status;
    const double f1 = imk_vibrating_beam_frequency(d, 0), f2 = imk_vibrating_beam_frequency(d, 1);
    const double least = f1 < f2 ? f1 : f2;
    const double load = d->proof_mass * (1.0 + fabs(d->proof_mass_error)) * d->range +
                        fabs(d->mount_force) +
                        6.0 * (d->mount_force_repeatability + d->mount_force_instability);
    const double limit = 0.9 * least * least / imk_vibrating_beam_stiffening(d);
    if (!(load < limit))
        return imki_design_refuse(error, IMK_ERROR_CONFLICT, "proof_mass.range", load, limit,
                                  "a smaller force: a beam would come near buckling (forces in N)");
    return IMK_OK;
}

/* ---- reduction ------------------------------------------------------------------------------- */

/* The difference of squares is linear in the force, with and without a mount that stresses it. */
static double reduce_squares(const design_type *d, imk_triad *t)
{
    const double f01 = imk_vibrating_beam_frequency(d, 0), f02 = imk_vibrating_beam_frequency(d, 1);
    const double squares = imk_vibrating_beam_stiffening(d) * d->proof_mass;
    const double c1 = d->frequency_temperature, c2 = c1 + d->temperature_mismatch;
    const double one = f01 * f01 * c1, two = f02 * f02 * c2;
    t->bias.fixed.value[0] = d->mount_force / d->proof_mass;
    t->scale_factor.fixed.value[0] = d->proof_mass_error;
    t->bias.temperature.coefficient[0].value[0] =
        d->arrangement == IMK_BEAM_PAIR ? 0.5 * (one - two) / squares : one / squares;
    return 1.0 / d->proof_mass;
}

/* f^2 = r^2 + 2 r^2 u, r the frequency under the mount's force:
 *
 *     f = r (1 + u - u^2/2 + u^3/2 …),   u = +-(k m a)/(2 r^2),   dr = f0^2 c dT/(2 r)
 *
 * and the slope r u falls with 1/r. */
static double reduce_frequencies(const design_type *d, imk_triad *t)
{
    const double stiffening = imk_vibrating_beam_stiffening(d);
    const double mass = d->proof_mass * (1.0 + d->proof_mass_error);
    const int beams = d->arrangement == IMK_BEAM_PAIR ? 2 : 1;
    double nominal = 0.0, slope = 0.0;
    for (int i = 0; i < beams; i++) {
        const double sign = i == 0 ? 1.0 : -1.0, f0 = imk_vibrating_beam_frequency(d, i);
        const double r = sqrt(f0 * f0 + sign * stiffening * d->mount_force);
        const double u = 0.5 * stiffening * mass / (r * r); /* per acceleration */
        const double c = d->frequency_temperature + (i == 1 ? d->temperature_mismatch : 0.0);
        const double growth = 0.5 * f0 * f0 * c / r; /* dr/dT */
        nominal += 0.5 * stiffening * d->proof_mass / f0;
        slope += r * u;
        t->bias.fixed.value[0] += sign * (r - f0);
        t->bias.temperature.coefficient[0].value[0] += sign * growth;
        t->scale_factor.temperature.coefficient[0].value[0] -= u * growth;
        t->nonlinearity.k2.value[0] -= 0.5 * sign * r * u * u;
        t->nonlinearity.k3.value[0] += 0.5 * r * u * u * u;
    }
    t->scale_factor.fixed.value[0] = slope / nominal - 1.0;
    double *const terms[] = {&t->bias.fixed.value[0], &t->bias.temperature.coefficient[0].value[0],
                             &t->scale_factor.temperature.coefficient[0].value[0],
                             &t->nonlinearity.k2.value[0], &t->nonlinearity.k3.value[0]};
    for (size_t i = 0; i < sizeof terms / sizeof terms[0]; i++)
        *terms[i] /= nominal;
    return slope / (nominal * mass);
}

void imk_vibrating_beam_reduce(const imk_vibrating_beam *d, imk_model *model)
{
    imk_triad *t = imki_reduction_begin(model, &imk_vibrating_beam_instrument);
    const double zeta = d->suspension_damping;
    double shows; /* reading per force on the beams [1/kg] */
    if (d->readout == IMK_BEAM_SQUARES)
        shows = reduce_squares(d, t);
    else
        shows = reduce_frequencies(d, t);
    t->bias.repeatability.value[0] = shows * d->mount_force_repeatability;
    t->noise.bias_instability.value[0] = shows * d->mount_force_instability;
    t->bias.temperature.order = 1;
    imki_temperature_range(&t->bias.temperature, d->temperature);
    if (t->scale_factor.temperature.coefficient[0].value[0] != 0.0) {
        t->scale_factor.temperature.order = 1;
        imki_temperature_range(&t->scale_factor.temperature, d->temperature);
    }
    t->noise.white.value[0] = imk_vibrating_beam_noise(d);
    t->noise.quantization.value[0] = imk_vibrating_beam_quantization(d);
    const double a = 1.0 - 2.0 * zeta * zeta;
    t->bandwidth.value[0] = d->suspension_frequency * sqrt(a + sqrt(a * a + 1.0));
    t->damping.value[0] = imki_model_damping(zeta);
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

const imk_instrument imk_vibrating_beam_instrument = {
    .name = "vibrating_beam",
    .title = "vibrating beam accelerometer",
    .technology = "vibrating beam",
    .source = "40 kHz, 80 Hz/g, 70 g of the RBA-500 family; the mechanics chosen to give them",
    .sensor = IMK_ACCEL,
    .design_size = sizeof(design_type),
    .state_size = sizeof(imki_beams),
    IMKI_TABLES,
    .set_default = set_default,
    .validate = validate,
    .init = imki_beams_start,
    .step = step,
    .observe = imki_beams_observe,
    .reduce = reduce,
    .step_length = imki_beams_step_length,
};
