/* SPDX-License-Identifier: Apache-2.0 */
/* What a designer of a ring laser gyro computes by hand, and its error model. */
#include "base/distributions/bessel_internal.h"
#include "ring_laser_internal.h"

#include <math.h>

static double omega_of(const imk_ring_laser *design)
{
    return 2.0 * IMKI_PI * design->dither.frequency;
}

/* K = 2 pi S [rad/rad]. */
static double phase_per_radian(const imk_ring_laser *design)
{
    return 2.0 * IMKI_PI * imk_ring_laser_fringes_per_radian(design);
}

double imk_ring_laser_area(const imk_ring_laser *design)
{
    const double p = design->cavity.perimeter;
    return design->cavity.shape == IMK_RING_LASER_SQUARE ? p * p / 16.0
                                                         : p * p / (12.0 * sqrt(3.0));
}

double imk_ring_laser_fringes_per_radian(const imk_ring_laser *design)
{
    return 4.0 * imk_ring_laser_area(design) /
           (design->cavity.wavelength * design->cavity.perimeter);
}

double imk_ring_laser_count_angle(const imk_ring_laser *design)
{
    return 1.0 / (imk_ring_laser_fringes_per_radian(design) *
                  (double)(1 << (int)design->readout.decoding));
}

double imk_ring_laser_undithered_rate(const imk_ring_laser *design, double rate)
{
    const double limit = design->lock_in.rate;
    if (!(fabs(rate) > limit))
        return 0.0;
    return copysign(sqrt((fabs(rate) - limit) * (fabs(rate) + limit)), rate);
}

double imk_ring_laser_dither_angle(const imk_ring_laser *design)
{
    return design->dither.rate / omega_of(design);
}

double imk_ring_laser_band(const imk_ring_laser *design, int n, double *half_width)
{
    const double k = phase_per_radian(design);
    if (half_width)
        *half_width =
            design->lock_in.rate * fabs(imki_bessel_j(n, k * imk_ring_laser_dither_angle(design)));
    return (double)n * omega_of(design) / k;
}

/* Root mean square of the random phase at a turn of the dither, K th_d r [rad]. */
static double random_phase(const imk_ring_laser *design)
{
    return phase_per_radian(design) * imk_ring_laser_dither_angle(design) *
           design->dither.randomness;
}

double imk_ring_laser_dead_band(const imk_ring_laser *design)
{
    const double phase = random_phase(design);
    double half_width;
    if (!(design->dither.rate > 0.0))
        return design->lock_in.rate;
    imk_ring_laser_band(design, 0, &half_width);
    return half_width * imk_exp(-0.5 * phase * phase);
}

double imk_ring_laser_dithered_rate(const imk_ring_laser *design, double rate)
{
    const double spacing = imk_ring_laser_band(design, 1, NULL);
    const double reach = phase_per_radian(design) * imk_ring_laser_dither_angle(design);
    const double nearest = nearbyint(rate / spacing);
    /* beyond its argument a Bessel function falls faster than any power */
    const int last = (int)(reach + 15.0 * sqrt(sqrt(reach)) + 20.0), n = (int)nearest;
    double half_width, others = 0.0;
    for (int m = -last; m <= last; m++) {
        const double centre = imk_ring_laser_band(design, m, &half_width);
        if (m != n)
            others += half_width * half_width / (2.0 * (rate - centre));
    }
    const double centre = imk_ring_laser_band(design, n, &half_width), x = rate - centre;
    const double beat = fabs(x) > half_width
                            ? copysign(sqrt((fabs(x) - half_width) * (fabs(x) + half_width)), x)
                            : 0.0;
    return centre + beat - (beat == 0.0 ? 0.0 : others);
}

double imk_ring_laser_lock_in_noise(const imk_ring_laser *design)
{
    const double phase = random_phase(design);
    if (!(design->dither.rate > 0.0))
        return 0.0;
    return design->lock_in.rate / sqrt(phase_per_radian(design) * design->dither.rate) *
           sqrt(-imk_expm1(-phase * phase));
}

double imk_ring_laser_decay_rate(const imk_ring_laser *design)
{
    return IMKI_LIGHT_SPEED * design->cavity.loss / design->cavity.perimeter;
}

double imk_ring_laser_quantum_noise(const imk_ring_laser *design)
{
    const double photon = IMKI_PLANCK * IMKI_LIGHT_SPEED / design->cavity.wavelength;
    return imk_ring_laser_decay_rate(design) / phase_per_radian(design) *
           sqrt(photon / (design->cavity.loss * design->cavity.power));
}

double imk_ring_laser_mode_hop(const imk_ring_laser *design)
{
    return design->cavity.wavelength / design->cavity.perimeter;
}

double imk_ring_laser_hop_temperature(const imk_ring_laser *design)
{
    const double expansion = fabs(design->path_length.expansion) * design->cavity.perimeter;
    return expansion > 0.0 ? 0.5 * design->path_length.stroke / expansion : (double)INFINITY;
}

double imk_ring_laser_dither_residual(const imk_ring_laser *design, double rate)
{
    const double cycles = design->dither.frequency / rate, rest = cycles - nearbyint(cycles);
    return fabs(design->readout.pickoff_error) * 2.0 * imk_ring_laser_dither_angle(design) *
           fabs(imk_sin(IMKI_PI * rest)) * rate;
}

/* ---- error model ----------------------------------------------------------------------------- */

static void reduce_temperature(const imk_ring_laser *design, imk_triad *triad)
{
    const imk_temperature_polynomial range = {.order = 1,
                                              .reference = design->temperature.reference,
                                              .minimum = design->temperature.minimum,
                                              .maximum = design->temperature.maximum};
    if (design->null_shift.temperature != 0.0) {
        triad->bias.temperature = range;
        triad->bias.temperature.coefficient[0].value[0] = design->null_shift.temperature;
    }
    const double below = range.reference - range.minimum, above = range.maximum - range.reference;
    /* each hop makes up for the expansion since the last */
    if (fmax(below, above) > imk_ring_laser_hop_temperature(design)) {
        triad->scale_factor.temperature = range;
        triad->scale_factor.temperature.coefficient[0].value[0] = design->path_length.expansion;
    }
}

void imki_ring_laser_reduce(const imk_ring_laser *design, imk_triad *triad)
{
    triad->bias.fixed.value[0] = design->null_shift.fixed;
    triad->bias.repeatability.value[0] = design->null_shift.repeatability;
    triad->scale_factor.fixed.value[0] = design->scale_factor.error;
    triad->scale_factor.repeatability.value[0] = design->scale_factor.repeatability;
    triad->misalignment.value[0][1] = design->alignment.y;
    triad->misalignment.value[0][2] = design->alignment.z;
    reduce_temperature(design, triad);

    const double lock = imk_ring_laser_lock_in_noise(design);
    const double quantum = imk_ring_laser_quantum_noise(design);
    const double white = sqrt(lock * lock + quantum * quantum);
    triad->noise.white.value[0] = white;
    triad->noise.bias_instability.value[0] = design->null_shift.instability;
    /* What the pickoff takes out of the counts has moved them: their errors are independent. Read
     * at one point of a cycle, or without dither, they are rounded as they stand. */
    const double count = imk_ring_laser_count_angle(design);
    const bool moved = design->readout.stripping == IMK_RING_LASER_PICKOFF &&
                       imk_ring_laser_dither_angle(design) > count;
    imk_axes *axes = moved ? &triad->noise.reading_noise : &triad->noise.quantization;
    axes->value[0] = count / sqrt(12.0);

    /* A phase in a tilted washboard with noise: where the barrier 2 K b is below the temperature
     * K^2 N^2 it runs almost freely; at the limit its slope at zero is 1/I_0(1)^2 = 0.62
     * [STRATONOVICH1967]. */
    const double band = imk_ring_laser_dead_band(design);
    if (2.0 * band > phase_per_radian(design) * white * white)
        triad->dead_band.value[0] = band;
    triad->range.value[0] = design->readout.range;
}
