/* SPDX-License-Identifier: Apache-2.0 */
/* The tuning fork gyro at a temperature, and the closed forms that its designer computes by hand:
 * equations in tuning_fork.h. */
#include "tuning_fork_internal.h"

#include "imukit/elementary.h"

#include <math.h>

imki_fork_point imki_fork_at(const imk_tuning_fork *design, double temperature)
{
    const double limited = temperature < IMKI_FORK_COLDEST   ? IMKI_FORK_COLDEST
                           : temperature > IMKI_FORK_HOTTEST ? IMKI_FORK_HOTTEST
                                                             : temperature;
    const double change = limited - IMKI_DESIGN_TEMPERATURE;
    const double frequency = 1.0 + design->temperature.frequency * change;
    const double q = 1.0 + design->temperature.q * change;
    const double drive = design->drive.frequency, split = design->sense.split;
    imki_fork_point point;
    point.drive = 2.0 * IMKI_PI * drive * frequency;
    point.sense =
        2.0 * IMKI_PI * ((drive + split) * frequency + design->temperature.split * change);
    point.drive_damping = point.drive / (design->drive.q * q);
    point.sense_damping = point.sense / (design->sense.q * q);
    point.amplitude = design->drive.amplitude * (1.0 + design->drive.amplitude_error +
                                                 design->temperature.amplitude * change);
    point.phase = design->phase.error + design->temperature.phase * change;
    point.temperature = temperature;
    return point;
}

double imki_fork_coriolis(const imk_tuning_fork *design)
{
    return 4.0 * IMKI_PI * design->angular_gain * design->drive.amplitude * design->drive.frequency;
}

imki_phasor imki_fork_compliance(const imki_fork_point *point)
{
    /* ws^2 - wd^2 as a product: a small split keeps its digits */
    return imki_phasor_inverse(
        (imki_phasor){(point->sense - point->drive) * (point->sense + point->drive),
                      point->drive * point->sense_damping});
}

imki_phasor imki_fork_decay(const imki_fork_point *point)
{
    const double g = 0.5 * point->sense_damping;
    const double free = sqrt(point->sense * point->sense - g * g);
    return (imki_phasor){g, -(free - point->drive)};
}

double imki_fork_force_ratio(const imk_tuning_fork *design, const imki_fork_point *point)
{
    return point->amplitude * point->drive /
           (design->drive.amplitude * 2.0 * IMKI_PI * design->drive.frequency);
}

imki_phasor imki_fork_motion_ratio(const imk_tuning_fork *design, const imki_fork_point *point)
{
    const imki_fork_point nominal = imki_fork_at(design, IMKI_DESIGN_TEMPERATURE);
    const imki_phasor ratio = imki_phasor_product(
        imki_fork_compliance(point), imki_phasor_inverse(imki_fork_compliance(&nominal)));
    const double force = imki_fork_force_ratio(design, point);
    return (imki_phasor){ratio.re * force, ratio.im * force};
}

double imki_fork_force_angle(const imk_tuning_fork *design, double specific_force)
{
    const double w = 2.0 * IMKI_PI * design->tines.common_frequency;
    return design->drive.force_angle +
           design->tines.asymmetry * specific_force / (w * w * design->tines.gap);
}

double imki_fork_in_phase(const imk_tuning_fork *design, const imki_fork_point *point,
                          double specific_force)
{
    return design->damping_coupling + imki_fork_force_angle(design, specific_force) *
                                          point->drive_damping / (2.0 * design->angular_gain);
}

double imki_fork_filter_frequency(const imk_tuning_fork *design)
{
    const double w = 2.0 * IMKI_PI * design->output.bandwidth, damping = design->output.damping;
    if (!(damping > 0.0))
        return w;
    /* -3 dB of w0^2/(s^2 + 2 zeta w0 s + w0^2) is at w0 sqrt(c + sqrt(c^2 + 1)) */
    const double c = 1.0 - 2.0 * damping * damping, root = sqrt(c * c + 1.0);
    return w / sqrt(c < 0.0 ? 1.0 / (root - c) : c + root);
}

double imk_tuning_fork_reading(const imk_tuning_fork *design, double rate, double specific_force,
                               double temperature)
{
    const imki_fork_point point = imki_fork_at(design, temperature);
    imki_phasor rho = imki_fork_motion_ratio(design, &point);
    if (design->sense.loop == IMK_TUNING_FORK_CLOSED)
        rho = (imki_phasor){imki_fork_force_ratio(design, &point), 0.0};
    const imki_phasor turn =
        imki_phasor_product(rho, (imki_phasor){imk_cos(point.phase), imk_sin(point.phase)});
    /* the coupling stiffness is fixed, so what it looks like goes with 1/wd */
    const double quadrature =
        design->quadrature * 2.0 * IMKI_PI * design->drive.frequency / point.drive;
    return turn.re * (rate + imki_fork_in_phase(design, &point, specific_force)) +
           turn.im * quadrature;
}

static double magnitude(imki_phasor a)
{
    return sqrt(a.re * a.re + a.im * a.im);
}

double imk_tuning_fork_response(const imk_tuning_fork *design)
{
    const imki_fork_point point = imki_fork_at(design, IMKI_DESIGN_TEMPERATURE);
    return imki_fork_coriolis(design) * magnitude(imki_fork_compliance(&point));
}

double imk_tuning_fork_brownian_noise(const imk_tuning_fork *design, double temperature)
{
    const imki_fork_point point = imki_fork_at(design, IMKI_DESIGN_TEMPERATURE);
    return 2.0 * sqrt(IMKI_BOLTZMANN * temperature * point.sense_damping / design->mass) /
           imki_fork_coriolis(design);
}

double imk_tuning_fork_pickoff_noise(const imk_tuning_fork *design)
{
    return design->sense.pickoff_noise / imk_tuning_fork_response(design);
}

double imk_tuning_fork_gain(const imk_tuning_fork *design, double frequency)
{
    const imki_fork_point point = imki_fork_at(design, IMKI_DESIGN_TEMPERATURE);
    const imki_phasor p = imki_fork_decay(&point);
    const double square = p.re * p.re + p.im * p.im, w = 2.0 * IMKI_PI * frequency;
    return magnitude((imki_phasor){square, p.re * w}) /
           magnitude((imki_phasor){square - w * w, 2.0 * p.re * w});
}

/* |G|^2 = 2 or 1/2 are quadratic equations in w^2; the first that has a root on the way up. */
double imk_tuning_fork_bandwidth(const imk_tuning_fork *design)
{
    const imki_fork_point point = imki_fork_at(design, IMKI_DESIGN_TEMPERATURE);
    const imki_phasor p = imki_fork_decay(&point);
    const double square = p.re * p.re + p.im * p.im, damping = p.re * p.re;
    double first = (double)INFINITY;
    for (int i = 0; i < 2; i++) {
        const double level = i == 0 ? 2.0 : 0.5;
        /* level [(P - v)^2 + 4 g^2 v] = P^2 + g^2 v,  v = w^2 */
        const double half = square - 2.0 * damping + 0.5 * damping / level;
        const double constant = square * square * (1.0 - 1.0 / level);
        const double discriminant = half * half - constant;
        if (!(discriminant >= 0.0))
            continue;
        const double low = half - sqrt(discriminant), high = half + sqrt(discriminant);
        const double root = low > 0.0 ? low : high;
        if (root > 0.0 && root < first)
            first = root;
    }
    return sqrt(first) / (2.0 * IMKI_PI);
}

double imk_tuning_fork_cubic(const imk_tuning_fork *design)
{
    const imki_fork_point point = imki_fork_at(design, IMKI_DESIGN_TEMPERATURE);
    const imki_phasor p = imki_fork_decay(&point);
    const double pull = design->angular_gain * p.im / (p.re * p.re + p.im * p.im);
    return -pull * pull;
}

double imk_tuning_fork_drive_force(const imk_tuning_fork *design)
{
    const imki_fork_point point = imki_fork_at(design, IMKI_DESIGN_TEMPERATURE);
    return design->mass * point.drive * point.drive_damping * point.amplitude;
}

double imk_tuning_fork_coupling(double difference, double angle, double angular_gain)
{
    return difference * imk_sin(2.0 * angle) / (2.0 * angular_gain);
}
