/* SPDX-License-Identifier: Apache-2.0 */
/* The vibrating beam accelerometer by closed forms: what a designer computes, the reading of two
 * counted frequencies, and the error model. */
#include "vibrating_beam_internal.h"

#include <math.h>

typedef imk_vibrating_beam design_type;

/* First root of cos(x) cosh(x) = 1, and what an axial force does to the square of the frequency of
 * that mode: integral of phi'^2 / (x^4 integral of phi^2) = 12.302619/500.563902 [TIMOSHENKO1974].
 */
static const double clamped_root = 4.730040744862704;
static const double clamped_force = 0.0245775186348646;

/* Share of a beam's mass that moves with its middle: integral of (phi/phi_middle)^2. */
static const double modal_share = 0.396477920160514;

static double area_of(const design_type *d)
{
    return d->width * d->thickness;
}

double imki_beam_bending_stiffness(const design_type *d)
{
    return d->modulus * area_of(d) * d->thickness * d->thickness / 12.0;
}

double imk_vibrating_beam_frequency(const imk_vibrating_beam *d, int beam)
{
    const double inverse = clamped_root / d->length;
    const double first = inverse * inverse / (2.0 * IMKI_PI) *
                         sqrt(imki_beam_bending_stiffness(d) / (d->density * area_of(d)));
    return beam == 0 ? first : first * (1.0 + d->frequency_mismatch);
}

double imk_vibrating_beam_stiffening(const imk_vibrating_beam *d)
{
    const double f = imk_vibrating_beam_frequency(d, 0);
    return clamped_force * f * f * d->length * d->length / imki_beam_bending_stiffness(d);
}

double imk_vibrating_beam_slope(const imk_vibrating_beam *d)
{
    return 0.5 * imk_vibrating_beam_stiffening(d) * d->proof_mass /
           imk_vibrating_beam_frequency(d, 0);
}

double imki_beams_reading(const imk_vibrating_beam *d, double f1, double f2)
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
    return imki_beams_reading(d, sqrt(f01 * f01 + change), sqrt(f02 * f02 - change));
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

void imki_vibrating_beam_reduce(const imk_vibrating_beam *d, imk_triad *t)
{
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
