/* SPDX-License-Identifier: Apache-2.0 */
/* Steady state of a shell gyro with its loops closed, and its closed forms.
 *
 * With the pattern along u (v across), the averaged equations need the forces, as rates,
 *
 *     along, in phase with the velocity       1/tau + (D/2) cos 2(theta - theta_d)
 *     across, in phase with the velocity      k W - (D/2) sin 2(theta - theta_d)   to hold it
 *     across, in phase with the displacement  -(dw/2) sin 2(theta - theta_w)
 *
 * The electronics command r_a along and g across, in phase with the velocity, and r_q in phase with
 * the displacement, along the directions they measure (u', v'), and the forces lag by b. With
 * m_uv = u . F v', F the matrix of the forcers, that gives
 *
 *     along    m_uu cos b r_a + m_uv (cos b g - sin b r_q)
 *     across   m_vu cos b r_a + m_vv (cos b g - sin b r_q)
 *     across   m_vu sin b r_a + m_vv (sin b g + cos b r_q)      in phase with the displacement
 *
 * and three equations for three unknowns: r_a, r_q and either g or the precession. */
#include "imukit/elementary.h"
#include "shell_gyro_internal.h"

#include <math.h>

/* ---- closed forms ---------------------------------------------------------------------------- */

double imk_shell_gyro_angular_gain(const imk_shell_gyro *design)
{
    const double n = design->resonator.mode_number;
    switch (design->resonator.shape) {
    case IMK_SHELL_RING:
        return 2.0 / (n * n + 1.0);
    case IMK_SHELL_HEMISPHERE:
        return 0.277;
    case IMK_SHELL_OTHER:
        break;
    }
    return design->resonator.angular_gain;
}

double imk_shell_gyro_modal_gain(const imk_shell_gyro *design)
{
    return design->resonator.mode_number * imk_shell_gyro_angular_gain(design);
}

double imk_shell_gyro_decay_time(const imk_shell_gyro *design)
{
    return design->resonator.quality / (IMKI_PI * design->resonator.frequency);
}

double imk_shell_gyro_precession(const imk_shell_gyro *design, double rate, double angle)
{
    return -imk_shell_gyro_modal_gain(design) * (rate + imk_shell_gyro_damping_bias(design, angle));
}

double imk_shell_gyro_damping_bias(const imk_shell_gyro *design, double angle)
{
    return -0.5 * design->anisotropy.damping_difference *
           imk_sin(2.0 * (angle - design->anisotropy.damping_angle)) /
           imk_shell_gyro_modal_gain(design);
}

double imk_shell_gyro_quadrature_rate(const imk_shell_gyro *design, double angle)
{
    return -IMKI_PI * design->anisotropy.frequency_split *
           imk_sin(2.0 * (angle - design->anisotropy.stiffness_angle)) /
           imk_shell_gyro_modal_gain(design);
}

double imk_shell_gyro_thermal_random_walk(const imk_shell_gyro *design, double temperature)
{
    const double omega = 2.0 * IMKI_PI * design->resonator.frequency;
    return sqrt(IMKI_BOLTZMANN * temperature /
                (design->resonator.mass * omega * design->resonator.quality)) /
           (imk_shell_gyro_modal_gain(design) * design->pattern.amplitude);
}

/* Force per rate, 2 m w a. */
static double force_of_unit_rate(const imk_shell_gyro *design)
{
    return 4.0 * IMKI_PI * design->resonator.mass * design->resonator.frequency *
           design->pattern.amplitude;
}

double imk_shell_gyro_rebalance_force(const imk_shell_gyro *design, double rate)
{
    return force_of_unit_rate(design) * imk_shell_gyro_modal_gain(design) * rate;
}

double imk_shell_gyro_drive_force(const imk_shell_gyro *design)
{
    return force_of_unit_rate(design) / imk_shell_gyro_decay_time(design);
}

/* ---- parts ----------------------------------------------------------------------------------- */

imki_shell_resonator imki_shell_resonator_at(const imk_shell_gyro *design, double temperature)
{
    const double warmer = temperature - IMKI_DESIGN_TEMPERATURE;
    /* lines in the temperature, not followed to where damping or stiffness would vanish */
    const double damping = fmax(1.0 + design->resonator.damping_temperature * warmer, 0.1);
    const double tuning = fmax(1.0 + design->resonator.frequency_temperature * warmer, 0.1);
    const double d = design->anisotropy.damping_difference * damping;
    const double split = 2.0 * IMKI_PI * design->anisotropy.frequency_split;
    return (imki_shell_resonator){
        .omega = 2.0 * IMKI_PI * design->resonator.frequency * tuning,
        .decay = damping / imk_shell_gyro_decay_time(design),
        .damping_cosine = d * imk_cos(2.0 * design->anisotropy.damping_angle),
        .damping_sine = d * imk_sin(2.0 * design->anisotropy.damping_angle),
        .stiffness_cosine = split * imk_cos(2.0 * design->anisotropy.stiffness_angle),
        .stiffness_sine = split * imk_sin(2.0 * design->anisotropy.stiffness_angle),
        .forcer_gain = (1.0 + design->forcer.gain_error) *
                       fmax(1.0 + design->forcer.gain_temperature * warmer, 0.1)};
}

static imki_shell_axes transducers(double gain, double mismatch, double misalignment)
{
    return (imki_shell_axes){gain * (1.0 + 0.5 * mismatch), gain * 0.5 * misalignment,
                             gain * (1.0 - 0.5 * mismatch)};
}

imki_shell_axes imki_shell_pickoff(const imk_shell_gyro *design)
{
    return transducers(1.0 + design->pickoff.gain_error, design->pickoff.gain_mismatch,
                       design->pickoff.misalignment);
}

imki_shell_axes imki_shell_forcer(const imk_shell_gyro *design, double gain)
{
    return transducers(gain, design->forcer.gain_mismatch, design->forcer.misalignment);
}

double imki_shell_update(const imk_shell_gyro *design)
{
    return design->control.cycles / design->resonator.frequency;
}

double imki_shell_assumed_gain(const imk_shell_gyro *design)
{
    return imk_shell_gyro_modal_gain(design) * (1.0 + design->resonator.angular_gain_error);
}

double imki_shell_command_limit(const imk_shell_gyro *design)
{
    return design->forcer.limit > 0.0 ? design->forcer.limit / force_of_unit_rate(design)
                                      : (double)INFINITY;
}

/* The amplitude of a sinusoid in white noise of density n, fitted over T, has the variance
 * 2 n^2/T. */
double imki_shell_angle_noise(const imk_shell_gyro *design)
{
    return design->pickoff.noise * sqrt(2.0 / imki_shell_update(design)) /
           design->pattern.amplitude;
}

/* ---- steady state ---------------------------------------------------------------------------- */

static double dot(imki_shell_pair a, imki_shell_pair b)
{
    return a.x * b.x + a.y * b.y;
}

static imki_shell_pair across(imki_shell_pair u)
{
    return (imki_shell_pair){-u.y, u.x};
}

/* u . M v, M = (c, s; s, -c) */
static double reflect(double c, double s, imki_shell_pair u, imki_shell_pair v)
{
    return u.x * (c * v.x + s * v.y) + u.y * (s * v.x - c * v.y);
}

/* Solve (a b; c d) (x, y) = (p, q). */
static imki_shell_pair solve(double a, double b, double c, double d, double p, double q)
{
    const double determinant = a * d - b * c;
    return (imki_shell_pair){(p * d - b * q) / determinant, (a * q - p * c) / determinant};
}

/* The forces needed along and across, and what the forcers make of commands. */
typedef struct mechanics {
    double along, held, quadrature; /* needed, as commands through a perfect forcer [1/s] */
    double uu, uv, vu, vv;
    double cosine, sine; /* of the phase error */
    double scale;        /* command per rate */
    double drift;        /* of the pattern without forces [rad/s] */
} mechanics;

/* The parametric drive feeds the pattern along itself, whatever the electrodes' directions. */
static void whole_angle_commands(const mechanics *m, bool parametric, imki_shell_balance *balance)
{
    double push; /* across, in phase with the velocity */
    if (parametric) {
        balance->quadrature = m->quadrature / (m->vv * m->cosine);
        push = -m->vv * m->sine * balance->quadrature;
        balance->drive = m->along / m->scale;
    } else {
        const imki_shell_pair x = solve(m->uu * m->cosine, -m->uv * m->sine, m->vu * m->sine,
                                        m->vv * m->cosine, m->along, m->quadrature);
        balance->drive = x.x;
        balance->quadrature = x.y;
        push = m->vu * m->cosine * x.x - m->vv * m->sine * x.y;
    }
    balance->rebalance = 0.0;
    balance->precession = m->drift + push / m->scale;
}

static void rebalance_commands(const mechanics *m, bool parametric, imki_shell_balance *balance)
{
    double in_phase, displaced; /* of the command across, as it arrives */
    if (parametric) {
        in_phase = m->held / m->vv;
        displaced = m->quadrature / m->vv;
        balance->drive = m->along / m->scale;
    } else {
        const imki_shell_pair x = solve(m->uu, m->uv, m->vu, m->vv, m->along, m->held);
        balance->drive = x.x / m->cosine;
        in_phase = x.y;
        displaced = (m->quadrature - m->sine * m->vu * balance->drive) / m->vv;
    }
    balance->rebalance = m->cosine * in_phase + m->sine * displaced;
    balance->quadrature = m->cosine * displaced - m->sine * in_phase;
    balance->precession = 0.0;
}

imki_shell_balance imki_shell_balance_at(const imk_shell_gyro *design, double temperature,
                                         double rate, double angle)
{
    imki_shell_balance balance;
    const imki_shell_resonator r = imki_shell_resonator_at(design, temperature);
    const imki_shell_axes p = imki_shell_pickoff(design);
    const imki_shell_axes f = imki_shell_forcer(design, r.forcer_gain);
    const imki_shell_pair pointing = {imk_cos(angle), imk_sin(angle)};
    const imki_shell_pair motion =
        solve(p.xx, p.xy, p.xy, p.yy, pointing.x, pointing.y); /* at amplitude 1 */
    const double size = sqrt(dot(motion, motion));
    const imki_shell_pair u = {motion.x / size, motion.y / size}, v = across(u);
    const imki_shell_pair fu = imki_shell_apply(f, pointing);
    const imki_shell_pair fv = imki_shell_apply(f, across(pointing));
    const double omega = 2.0 * IMKI_PI * design->resonator.frequency;
    /* along u: velocity, and with it the forces of rotation and damping, goes with this one */
    const double frequency = r.omega + 0.5 * reflect(r.stiffness_cosine, r.stiffness_sine, u, u);
    const double scale = size * frequency / omega;
    const double drift = -imk_shell_gyro_modal_gain(design) * rate -
                         0.5 * reflect(r.damping_cosine, r.damping_sine, u, v);
    const mechanics m = {
        .along = scale * (r.decay + 0.5 * reflect(r.damping_cosine, r.damping_sine, u, u)),
        .held = -scale * drift,
        .quadrature = size * r.omega / omega * 0.5 *
                      reflect(r.stiffness_cosine, r.stiffness_sine, u, v), /* m w dw a */
        .uu = dot(u, fu),
        .uv = dot(u, fv),
        .vu = dot(v, fu),
        .vv = dot(v, fv),
        .cosine = imk_cos(design->control.phase_error),
        .sine = imk_sin(design->control.phase_error),
        .scale = scale,
        .drift = drift};
    const bool parametric = design->forcer.drive == IMK_SHELL_PARAMETRIC;
    balance.amplitude = size * design->pattern.amplitude;
    balance.actual = angle + imk_atan2(pointing.x * u.y - pointing.y * u.x, dot(pointing, u));
    balance.frequency = frequency;
    if (design->mode == IMK_SHELL_REBALANCE)
        rebalance_commands(&m, parametric, &balance);
    else
        whole_angle_commands(&m, parametric, &balance);
    return balance;
}

/* ---- loops ----------------------------------------------------------------------------------- */

/* An integrator under a command that is held for an update T, measured as its mean over T, one
 * update later corrected by K times it, has with x = K T the poles of
 *
 *     z^2 - (1 - x/2) z + x/2 = 0;   z1 = e^(-2 pi f T) is one for x = 2 z1 (1 - z1)/(1 + z1),
 *
 * and as long as f T <= 0.1 the other, (1 - z1)/(1 + z1), is the faster one. */
double imki_shell_loop_gain(double bandwidth, double update)
{
    const double pole = imk_exp(-2.0 * IMKI_PI * bandwidth * update);
    return 2.0 * pole * (1.0 - pole) / (1.0 + pole);
}

/* |G|^2 at the angle 2 pi f T, G = x (z + 1)/(2 z (z - 1) + x (z + 1)). */
static double loop_power(double x, double turn)
{
    const double c = imk_cos(turn), s = imk_sin(turn);
    const double c2 = c * c - s * s, s2 = 2.0 * c * s;
    const double real = 2.0 * (c2 - c) + x * (c + 1.0), imaginary = 2.0 * (s2 - s) + x * s;
    return x * x * ((c + 1.0) * (c + 1.0) + s * s) / (real * real + imaginary * imaginary);
}

double imki_shell_loop_bandwidth(const imk_shell_gyro *design)
{
    const double update = imki_shell_update(design);
    const double x = imki_shell_loop_gain(design->control.rebalance_bandwidth, update);
    double low = 0.0, high = IMKI_PI;
    for (int i = 0; i < 60; i++) { /* bisection to rounding */
        const double middle = 0.5 * (low + high);
        if (loop_power(x, middle) > 0.5)
            low = middle;
        else
            high = middle;
    }
    return low / (2.0 * IMKI_PI * update);
}
