/* SPDX-License-Identifier: Apache-2.0 */
/* The vibrating beam accelerometer by closed forms: what a designer computes, the reading of two
 * counted frequencies, and the error model. */
#include "vibrating_beam_internal.h"

#include <math.h>

typedef imk_vibrating_beam design_type;

/* What a small axial force does to the square of the frequency of the first mode: integral of
 * phi'^2 / (x^4 integral of phi^2) = 12.302619/500.563902 [TIMOSHENKO1974]. */
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
    const double inverse = IMKI_BEAM_ROOT / d->length;
    const double first = inverse * inverse / (2.0 * IMKI_PI) *
                         sqrt(imki_beam_bending_stiffness(d) / (d->density * area_of(d)));
    return beam == 0 ? first : first * (1.0 + d->frequency_mismatch);
}

/* Load n of the first beam, at T_0, per force [1/N]. */
double imki_beam_load_per_force(const imk_vibrating_beam *d)
{
    return d->length * d->length / imki_beam_bending_stiffness(d);
}

double imk_vibrating_beam_buckling(const imk_vibrating_beam *d)
{
    const double ratio = 1.0 + d->frequency_mismatch;
    return IMKI_BEAM_BUCKLING / imki_beam_load_per_force(d) *
           (d->arrangement == IMK_BEAM_PAIR && ratio < 1.0 ? ratio * ratio : 1.0);
}

double imki_beam_temperature(const imk_vibrating_beam *d, int beam)
{
    return d->frequency_temperature + (beam == 1 ? d->temperature_mismatch : 0.0);
}

double imki_beam_stiffness(const imk_vibrating_beam *d, int beam, double warm)
{
    const double ratio = beam == 1 ? 1.0 + d->frequency_mismatch : 1.0;
    const double grown = 1.0 + imki_beam_temperature(d, beam) * warm;
    return ratio * ratio * (grown > 0.01 ? grown : 0.01);
}

double imk_vibrating_beam_loaded(const imk_vibrating_beam *d, int beam, double force)
{
    const double stiffness = imki_beam_stiffness(d, beam, 0.0);
    const double load = imki_beam_load_per_force(d) * force / stiffness;
    return imk_vibrating_beam_frequency(d, beam) * sqrt(imki_beam_load_at(load).square);
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

static int beams_of(const design_type *d)
{
    return d->arrangement == IMK_BEAM_PAIR ? 2 : 1;
}

/* Nominal slope of one beam's f^2 or f [per m/s^2], and the sum of all. */
static double slope_of(const design_type *d, int beam)
{
    const double squares = imk_vibrating_beam_stiffening(d) * d->proof_mass;
    return d->readout == IMK_BEAM_SQUARES ? squares
                                          : 0.5 * squares / imk_vibrating_beam_frequency(d, beam);
}

static double nominal_of(const design_type *d)
{
    return slope_of(d, 0) + (beams_of(d) == 2 ? slope_of(d, 1) : 0.0);
}

double imki_beams_reading(const imk_vibrating_beam *d, double f1, double f2)
{
    const double f01 = imk_vibrating_beam_frequency(d, 0), f02 = imk_vibrating_beam_frequency(d, 1);
    const bool squares = d->readout == IMK_BEAM_SQUARES;
    double change = squares ? f1 * f1 - f01 * f01 : f1 - f01;
    if (beams_of(d) == 2)
        change -= squares ? f2 * f2 - f02 * f02 : f2 - f02;
    return change / nominal_of(d);
}

double imk_vibrating_beam_reading(const imk_vibrating_beam *d, double force)
{
    const double pull = d->proof_mass * force;
    return imki_beams_reading(d, imk_vibrating_beam_loaded(d, 0, pull),
                              imk_vibrating_beam_loaded(d, 1, -pull));
}

/* Both squares fall with temperature and with the square of the load: the load and the share of the
 * squares that temperature explains, first to first order, then by what is left of the squares. */
double imki_beams_warmth(const imk_vibrating_beam *d, const double *series, double f1, double f2)
{
    const double square = imk_vibrating_beam_frequency(d, 0) * imk_vibrating_beam_frequency(d, 0);
    const double e1 = imki_beam_stiffness(d, 0, 0.0), e2 = imki_beam_stiffness(d, 1, 0.0);
    double load = 0.0, share = 0.0;
    for (int i = 0; i < 4; i++) {
        const double grown = 1.0 + share > 0.01 ? 1.0 + share : 0.01;
        const double one = grown * e1, two = grown * e2;
        const double left1 = f1 * f1 / square - one * imki_load_series_at(series, load / one);
        const double left2 = f2 * f2 / square - two * imki_load_series_at(series, -load / two);
        load = imki_clamped(load + (left1 - left2) / (2.0 * clamped_force), IMKI_BEAM_LOAD_MAX);
        share += (left1 + left2) / (e1 + e2);
    }
    return share / d->frequency_temperature;
}

double imki_beam_mass(const imk_vibrating_beam *d)
{
    return modal_share * d->density * area_of(d) * d->length;
}

/* Thermal force across the motion turns the phase: k T/(Q m w x0^2), two-sided, of the angular
 * frequency of an oscillator of amplitude x0 [BLAQUIERE1966]. */
double imki_beam_phase_density(const imk_vibrating_beam *d, int beam)
{
    const double w = 2.0 * IMKI_PI * imk_vibrating_beam_frequency(d, beam);
    return IMKI_BOLTZMANN * d->temperature /
           (d->quality * imki_beam_mass(d) * w * d->amplitude * d->amplitude);
}

double imki_beam_edge(const imk_vibrating_beam *d, double frequency)
{
    return d->pickoff_noise / (2.0 * IMKI_PI * frequency * d->amplitude);
}

double imki_suspension_density(const imk_vibrating_beam *d)
{
    const double rate = 2.0 * d->suspension_damping * 2.0 * IMKI_PI * d->suspension_frequency;
    return 2.0 * IMKI_BOLTZMANN * d->temperature * rate / d->proof_mass;
}

/* ---- about no specific force ----------------------------------------------------------------- */

/* Share of one beam in the reading and its derivatives with respect to specific force x and
 * temperature, at x = 0 and T_0, under the force of the mount [m/s^2 …]. */
typedef struct beam_share {
    double frequency;            /* [Hz] */
    double per_frequency;        /* of the reading, of this beam's frequency [m/s^2/Hz] */
    double zero, xx, xxx, t, xt; /* zero: less its value without the mount */
    double excess;               /* of the first derivative over its nominal value, which are 1
                                    of all beams [1] */
} beam_share;

/* f^2 = F e l(n/e), e the stiffness with de/dT = e c, l the square of imki_beam_load: its
 * derivatives, and from these those of f. */
static beam_share share_of(const design_type *d, int beam)
{
    const double sign = beam == 0 ? 1.0 : -1.0, f0 = imk_vibrating_beam_frequency(d, 0);
    const double e = imki_beam_stiffness(d, beam, 0.0), c = imki_beam_temperature(d, beam);
    const double per_force = sign * imki_beam_load_per_force(d) / e;
    const double y = per_force * d->mount_force, heavier = 1.0 + d->proof_mass_error;
    const double k = per_force * d->proof_mass * heavier;
    const imki_beam_load l = imki_beam_load_at(y), free = imki_beam_load_at(0.0);
    const double scale = f0 * f0 * e, bent = sqrt(l.square), f = sqrt(scale) * bent;
    const double x = scale * l.first * k;
    beam_share s = {.frequency = f,
                    .per_frequency = 2.0 * f,
                    .zero = scale * (l.square - 1.0),
                    .xx = scale * l.second * k * k,
                    .xxx = scale * l.third * k * k * k,
                    .t = scale * c * (l.square - y * l.first),
                    .xt = -scale * c * k * y * l.second,
                    .excess = l.first / free.first * heavier - 1.0};
    if (d->readout == IMK_BEAM_FREQUENCIES) {
        const double half = 0.5 / f, fx = half * x;
        s.per_frequency = 1.0;
        s.zero = sqrt(scale) * (bent - 1.0);
        s.xx = half * (s.xx - 2.0 * fx * fx);
        s.xxx = half * (s.xxx - 6.0 * fx * s.xx);
        s.t *= half;
        s.xt = half * (s.xt - 2.0 * fx * s.t);
        s.excess = (1.0 + s.excess) / bent - 1.0;
    }
    double *const terms[] = {&s.per_frequency, &s.zero, &s.xx, &s.xxx, &s.t, &s.xt};
    for (size_t i = 0; i < IMKI_LENGTH(terms); i++)
        *terms[i] *= sign / nominal_of(d);
    s.excess *= slope_of(d, beam) / nominal_of(d);
    return s;
}

double imk_vibrating_beam_noise(const imk_vibrating_beam *d)
{
    double square = imki_suspension_density(d);
    for (int i = 0; i < beams_of(d); i++) {
        const double shows = share_of(d, i).per_frequency / (2.0 * IMKI_PI);
        square += shows * shows * imki_beam_phase_density(d, i);
    }
    return sqrt(square);
}

/* Late crossings of a time, 1 sigma, are cycles that are missing in the integral of a frequency. */
double imk_vibrating_beam_quantization(const imk_vibrating_beam *d)
{
    const double time = d->clock > 0.0 ? 1.0 / (d->clock * sqrt(12.0)) : 0.0;
    double square = 0.0;
    for (int i = 0; i < beams_of(d); i++) {
        const beam_share s = share_of(d, i);
        const double shows = s.per_frequency * s.frequency * time;
        square += shows * shows;
    }
    return sqrt(square);
}

double imk_vibrating_beam_reading_noise(const imk_vibrating_beam *d)
{
    double square = 0.0;
    for (int i = 0; i < beams_of(d); i++) {
        const beam_share s = share_of(d, i);
        const double shows = s.per_frequency * s.frequency * imki_beam_edge(d, s.frequency);
        square += shows * shows;
    }
    return sqrt(square);
}

void imki_vibrating_beam_reduce(const imk_vibrating_beam *d, imk_triad *t)
{
    const double zeta = d->suspension_damping;
    for (int i = 0; i < beams_of(d); i++) {
        const beam_share s = share_of(d, i);
        t->scale_factor.fixed.value[0] += s.excess;
        t->bias.fixed.value[0] += s.zero;
        t->bias.temperature.coefficient[0].value[0] += s.t;
        t->scale_factor.temperature.coefficient[0].value[0] += s.xt;
        t->nonlinearity.k2.value[0] += s.xx / 2.0;
        t->nonlinearity.k3.value[0] += s.xxx / 6.0;
    }
    /* a force on the beams is a specific force on the mass */
    const double shows =
        (1.0 + t->scale_factor.fixed.value[0]) / (d->proof_mass * (1.0 + d->proof_mass_error));
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
    t->noise.reading_noise.value[0] = imk_vibrating_beam_reading_noise(d);
    const double a = 1.0 - 2.0 * zeta * zeta;
    t->bandwidth.value[0] = d->suspension_frequency * sqrt(a + sqrt(a * a + 1.0));
    t->damping.value[0] = imki_model_damping(zeta);
    t->range.value[0] = d->range;
}
