/* SPDX-License-Identifier: Apache-2.0 */
/* The fibre-optic gyro by closed forms: Sagnac phase, noise, loop, Shupe effect, and the error
 * model they add up to. */
#include "base/distributions/bessel_internal.h"
#include "fibre_optic_internal.h"
#include "imukit/elementary.h"

#include <math.h>

static double after_losses(const imk_fibre_optic *design, double power)
{
    return power * imk_exp(-design->optics_loss - design->coil_attenuation * design->coil_length);
}

double imk_fibre_optic_turns(const imk_fibre_optic *design)
{
    return design->coil_length / (IMKI_PI * design->coil_diameter);
}

double imk_fibre_optic_scale(const imk_fibre_optic *design)
{
    return 2.0 * IMKI_PI * design->coil_length * design->coil_diameter /
           (design->wavelength * IMKI_LIGHT_SPEED);
}

double imk_fibre_optic_transit_time(const imk_fibre_optic *design)
{
    return design->coil_index * design->coil_length / IMKI_LIGHT_SPEED;
}

double imk_fibre_optic_proper_frequency(const imk_fibre_optic *design)
{
    return 0.5 / imk_fibre_optic_transit_time(design);
}

double imk_fibre_optic_fringe_rate(const imk_fibre_optic *design)
{
    return 2.0 * IMKI_PI / imk_fibre_optic_scale(design);
}

double imk_fibre_optic_reset_angle(const imk_fibre_optic *design)
{
    return design->wavelength * design->coil_index / design->coil_diameter;
}

double imk_fibre_optic_detector_power(const imk_fibre_optic *design)
{
    return after_losses(design, design->source_power);
}

double imk_fibre_optic_intensity_noise(const imk_fibre_optic *design)
{
    const double linewidth = /* [Hz] */
        IMKI_LIGHT_SPEED * design->linewidth / (design->wavelength * design->wavelength);
    return design->intensity_noise > 0.0 ? design->intensity_noise : 2.0 / linewidth;
}

/* ---- the operating point --------------------------------------------------------------------- */

static double slope_at(const imk_fibre_optic *design, double half_power, double depth)
{
    const double shape =
        design->loop == IMK_FIBRE_OPTIC_OPEN ? 2.0 * imki_bessel_j(1, depth) : imk_sin(depth);
    return half_power * design->visibility * shape;
}

double imki_fibre_optic_nominal_slope(const imk_fibre_optic *design)
{
    return slope_at(design, 0.5 * imk_fibre_optic_detector_power(design), design->modulation_depth);
}

imki_fibre_optic_point imki_fibre_optic_operate(const imk_fibre_optic *design)
{
    imki_fibre_optic_point point;
    const double responsivity = design->responsivity;
    point.half_power = 0.5 * imk_fibre_optic_detector_power(design) * (1.0 + design->power_error);
    point.depth = design->modulation_depth * (1.0 + design->depth_error);
    point.slope = slope_at(design, point.half_power, point.depth);
    point.centre = point.half_power * (1.0 + design->visibility * imk_cos(point.depth));
    point.noise[0] = 4.0 * IMKI_BOLTZMANN * IMKI_DESIGN_TEMPERATURE /
                     (design->load_resistance * responsivity * responsivity);
    point.noise[1] = 2.0 * IMKI_ELEMENTARY_CHARGE / responsivity;
    point.noise[2] = imk_fibre_optic_intensity_noise(design);
    point.count = 0.0;
    if (design->converter_bits > 0 && design->converter_range > 0.0)
        point.count = 2.0 * design->converter_range / (double)(1 << design->converter_bits);
    return point;
}

double imki_fibre_optic_fringe(const void *design, double phase)
{
    const imk_fibre_optic *d = design;
    return imki_fibre_optic_operate(d).half_power * (1.0 + d->visibility * imk_cos(phase));
}

static double noise_of(const imki_fibre_optic_point *point, double power)
{
    return point->noise[0] + power * (point->noise[1] + power * point->noise[2]);
}

/* Closed loop: the phase is half the difference of two powers, each measured for half the time, so
 * the density is S itself. Open loop: the amplitude of a harmonic 2 <P cos t> has the density
 * 4 <S cos^2 t>, mean over a period; S is as good as a trigonometric polynomial, for which the sum
 * over equal steps is the mean. */
double imki_fibre_optic_demodulated_noise(const imk_fibre_optic *design,
                                          const imki_fibre_optic_point *point)
{
    if (design->loop != IMK_FIBRE_OPTIC_OPEN)
        return noise_of(point, point->centre);
    enum { STEPS = 64 };
    double sum = 0.0;
    for (int i = 0; i < STEPS; i++) {
        const double c = imk_cos(2.0 * IMKI_PI * (i + 0.5) / STEPS);
        const double power =
            point->half_power * (1.0 + design->visibility * imk_cos(point->depth * c));
        sum += noise_of(point, power) * c * c;
    }
    return 4.0 * sum / STEPS;
}

/* Rounding by a step a adds a^2/12 to each reading: of one transit (density a^2 tau/6), open loop
 * of one period (a^2 tau/3). */
static double converter_noise(const imk_fibre_optic *design, const imki_fibre_optic_point *point)
{
    const double share = design->loop == IMK_FIBRE_OPTIC_OPEN ? 3.0 : 6.0;
    return point->count * point->count * imk_fibre_optic_transit_time(design) / share;
}

double imk_fibre_optic_phase_noise(const imk_fibre_optic *design)
{
    const imki_fibre_optic_point point = imki_fibre_optic_operate(design);
    return sqrt(imki_fibre_optic_demodulated_noise(design, &point) +
                converter_noise(design, &point)) /
           point.slope;
}

double imk_fibre_optic_angle_random_walk(const imk_fibre_optic *design)
{
    return imk_fibre_optic_phase_noise(design) / (sqrt(2.0) * imk_fibre_optic_scale(design));
}

/* ---- the loop -------------------------------------------------------------------------------- */

double imk_fibre_optic_effective_gain(const imk_fibre_optic *design)
{
    return design->loop_gain * (1.0 + design->demodulation_error) * (1.0 + design->gain_error) *
           imki_fibre_optic_operate(design).slope / imki_fibre_optic_nominal_slope(design);
}

double imk_fibre_optic_loop_pole(const imk_fibre_optic *design)
{
    return -imk_ln(1.0 - imk_fibre_optic_effective_gain(design)) /
           (4.0 * IMKI_PI * imk_fibre_optic_transit_time(design));
}

double imk_fibre_optic_bandwidth(const imk_fibre_optic *design)
{
    if (design->loop == IMK_FIBRE_OPTIC_OPEN)
        return 0.0;
    const double g = imk_fibre_optic_effective_gain(design);
    const double rest = 1.0 - g;
    /* sin^2 of half the angle, which does not cancel for small g: 1 - cos = 2 sin^2 */
    const double square = g * g / (4.0 * rest);
    if (!(rest > 0.0 && square < 1.0))
        return 0.0;
    const double angle = 2.0 * imk_atan2(sqrt(square), sqrt(1.0 - square));
    return angle / (4.0 * IMKI_PI * imk_fibre_optic_transit_time(design));
}

double imk_fibre_optic_harmonic_gain(const imk_fibre_optic *design)
{
    return (1.0 + design->demodulation_error) * imki_fibre_optic_operate(design).slope /
           imki_fibre_optic_nominal_slope(design);
}

double imki_fibre_optic_count_angle(const imk_fibre_optic *design)
{
    return design->output_bits > 0
               ? imk_fibre_optic_reset_angle(design) / (double)(1 << design->output_bits)
               : 0.0;
}

/* ---- the Shupe effect ------------------------------------------------------------------------ */

double imk_fibre_optic_shupe_rate(const imk_fibre_optic *design, size_t count, const double *rate)
{
    const double length = design->coil_length, section = length / (double)count;
    double integral = 0.0;
    for (size_t i = 0; i < count; i++) /* L - 2 z is linear: its mean is that of the middle */
        integral += rate[i] * section * (length - 2.0 * section * ((double)i + 0.5));
    return design->coil_index * design->thermo_optic * integral / (design->coil_diameter * length);
}

double imk_fibre_optic_shupe_coefficient(const imk_fibre_optic *design)
{
    return design->winding_residual * design->coil_index * design->thermo_optic *
           design->coil_length / (4.0 * design->coil_diameter);
}

/* ---- the error model ------------------------------------------------------------------------- */

/* Linear terms in the temperature over this range [K]: -40 to 85 degC. */
static void linear(imk_temperature_polynomial *polynomial, double coefficient)
{
    polynomial->order = coefficient == 0.0 ? 0 : 1;
    polynomial->coefficient[0].value[0] = coefficient;
    polynomial->reference = IMKI_DESIGN_TEMPERATURE;
    polynomial->minimum = -40.0 + 273.15;
    polynomial->maximum = 358.15;
}

void imki_fibre_optic_reduce(const imk_fibre_optic *design, imk_triad *triad)
{
    const bool open = design->loop == IMK_FIBRE_OPTIC_OPEN;
    const double scale = imk_fibre_optic_scale(design);
    /* reading per rate of phase: what phases that are not Sagnac's are multiplied by */
    const double reading = open ? imk_fibre_optic_harmonic_gain(design) : 1.0 + design->reset_error;
    const double ratio = imki_fibre_optic_scale_ratio(design, 0.0, IMKI_DESIGN_TEMPERATURE);
    const double per_phase = reading / scale;

    triad->bias.fixed.value[0] = design->phase_fixed * per_phase;
    triad->bias.repeatability.value[0] = design->phase_repeatability * per_phase;
    linear(&triad->bias.temperature, design->phase_temperature * per_phase);
    triad->bias.temperature_rate.value[0] = imk_fibre_optic_shupe_coefficient(design) * reading;

    triad->scale_factor.fixed.value[0] = reading * ratio - 1.0;
    triad->scale_factor.repeatability.value[0] =
        reading * ratio * ratio * design->wavelength_repeatability;
    linear(&triad->scale_factor.temperature,
           reading * ratio * (design->coil_expansion - design->wavelength_temperature * ratio));
    if (open) { /* sin x = x - x^3/6, with the nonreciprocal phase in x */
        const double phase = design->phase_fixed, slope = reading * ratio;
        triad->nonlinearity.k3.value[0] = -slope * ratio * ratio * scale * scale / 6.0;
        triad->nonlinearity.k2.value[0] = -0.5 * slope * ratio * scale * phase;
        triad->scale_factor.fixed.value[0] -= 0.5 * slope * phase * phase;
    }

    triad->noise.white.value[0] = reading * imk_fibre_optic_angle_random_walk(design);
    triad->noise.bias_instability.value[0] = design->phase_instability * per_phase;
    triad->noise.quantization.value[0] = imki_fibre_optic_count_angle(design) / sqrt(12.0);
    triad->bandwidth.value[0] = imk_fibre_optic_bandwidth(design);
    triad->dead_band.value[0] = open ? 0.0 : design->crosstalk * per_phase;
    triad->range.value[0] = design->range;
}
