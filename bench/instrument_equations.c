/* SPDX-License-Identifier: Apache-2.0 */
#include "instrument_equations.h"

#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* ---- free gyro ------------------------------------------------------------------------------- */

/* Newton and Euler: docs/physics/free_gyro.md. */
static void free_gyro_slope(double t, const double *y, double *dy, const void *with)
{
    (void)t;
    const free_gyro_equations *e = with;
    const double s = sin(y[1]), c = cos(y[1]), p = y[2], v = y[3];
    const double u = p * c, w3 = p * s; /* the case is at rest: q = r = 0 */
    dy[0] = p;
    dy[1] = v;
    dy[2] = ((e->a * v * w3 - v * (e->c * w3 + e->h) + w3 * e->b * v) * c -
             (e->c * v * u + u * e->b * v - v * e->a * u) * s) /
            (e->ao + e->a * c * c + e->c * s * s);
    dy[3] = (e->h * u - (e->a - e->c) * u * w3) / e->b;
}

static void free_gyro_read(double t, const double *y, double *readings, const void *with)
{
    (void)t;
    (void)with;
    readings[0] = y[0];
    readings[1] = y[1];
}

void free_gyro_problem(const imk_free_gyro *design, free_gyro_equations *with, ode_problem *problem)
{
    *with = (free_gyro_equations){.h = imk_free_gyro_momentum(design),
                                  .ao = design->outer_inertia[0],
                                  .a = design->inner_inertia[0] + design->rotor_transverse,
                                  .b = design->inner_inertia[1] + design->rotor_transverse,
                                  .c = design->inner_inertia[2]};
    const double nutation = 2.0 * pi * imk_free_gyro_nutation(design, design->start_inner);
    const double swing = design->start_nutation;
    *problem =
        (ode_problem){.states = 4,
                      .readings = 2,
                      .start = {design->start_outer, design->start_inner, 0.0, nutation * swing},
                      .size = {swing, swing, nutation * swing, nutation * swing},
                      .reference_step = 0.5 / nutation,
                      .slope = free_gyro_slope,
                      .read = free_gyro_read,
                      .with = with};
}

/* ---- ring laser ------------------------------------------------------------------------------ */

static double rotation(const ring_laser_equations *e, double t)
{
    return e->slope * (e->rate * t + e->dither / e->w * sin(e->w * t));
}

static void ring_laser_slope(double t, const double *y, double *dy, const void *with)
{
    const ring_laser_equations *e = with;
    dy[0] = e->moving ? -e->kappa * sin(y[0] + rotation(e, t))
                      : e->slope * (e->rate + e->dither * cos(e->w * t)) - e->kappa * sin(y[0]);
}

static void ring_laser_read(double t, const double *y, double *readings, const void *with)
{
    const ring_laser_equations *e = with;
    readings[0] = e->moving ? y[0] + rotation(e, t) : y[0];
}

void ring_laser_problem(const imk_ring_laser *design, double rate, bool moving,
                        ring_laser_equations *with, ode_problem *problem)
{
    const double slope = 2.0 * pi * imk_ring_laser_fringes_per_radian(design);
    *with = (ring_laser_equations){.slope = slope,
                                   .rate = rate,
                                   .dither = design->dither.rate,
                                   .w = 2.0 * pi * design->dither.frequency,
                                   .kappa = slope * design->lock_in.rate,
                                   .moving = moving};
    *problem = (ode_problem){.states = 1,
                             .readings = 1,
                             .size = {1.0},
                             .reference_step = 2.0 / (slope * design->dither.rate),
                             .slope = ring_laser_slope,
                             .read = ring_laser_read,
                             .with = with};
}

/* ---- vibratory gyros ------------------------------------------------------------------------- */

static void oscillator_slope(double t, const double *y, double *dy, const void *with)
{
    const oscillator_equations *e = with;
    const double force = e->force != 0.0 ? e->force * cos(e->w * t + e->phase) : 0.0;
    dy[0] = y[1];
    dy[1] = -e->xx * y[0] - e->xv * y[1] - e->xy * y[2] + e->xyv * y[3] + force;
    dy[2] = y[3];
    dy[3] = -e->yy * y[2] - e->yv * y[3] - e->yx * y[0] + e->yxv * y[1] + e->leak * force;
}

static void oscillator_read(double t, const double *y, double *readings, const void *with)
{
    (void)t;
    const oscillator_equations *e = with;
    readings[0] = y[0] / e->size_x;
    readings[1] = y[2] / e->size_y;
}

static void oscillator_problem(const double start[4], oscillator_equations *with,
                               ode_problem *problem)
{
    const double w = sqrt(with->xx);
    *problem =
        (ode_problem){.states = 4,
                      .readings = 2,
                      .start = {start[0], start[1], start[2], start[3]},
                      .size = {with->size_x, w * with->size_x, with->size_y, w * with->size_y},
                      .reference_step = 0.25 * pi / w,
                      .slope = oscillator_slope,
                      .read = oscillator_read,
                      .with = with};
}

void tuning_fork_problem(const imk_tuning_fork *design, double rate, double force, double phase,
                         double frequency, const double start[4], oscillator_equations *with,
                         ode_problem *problem)
{
    const double wd = 2.0 * pi * design->drive.frequency, ws = wd + 2.0 * pi * design->sense.split;
    const double k = design->angular_gain, q = 2.0 * k * wd * design->quadrature;
    const double coupling = 2.0 * k * design->damping_coupling;
    const double sense = imk_tuning_fork_response(design) * (fabs(rate) + fabs(design->quadrature));
    *with = (oscillator_equations){.xx = wd * wd,
                                   .xv = wd / design->drive.q,
                                   .xy = q,
                                   .xyv = 2.0 * k * rate - coupling,
                                   .yy = ws * ws,
                                   .yv = ws / design->sense.q,
                                   .yx = q,
                                   .yxv = -2.0 * k * rate - coupling,
                                   .force = force,
                                   .leak = -design->drive.force_angle,
                                   .w = frequency,
                                   .phase = phase,
                                   .size_x = design->drive.amplitude,
                                   .size_y = sense};
    oscillator_problem(start, with, problem);
}

void shell_gyro_problem(const imk_shell_gyro *design, double rate, double x, double y,
                        oscillator_equations *with, ode_problem *problem)
{
    const double w = 2.0 * pi * design->resonator.frequency;
    const double k = imk_shell_gyro_modal_gain(design);
    const double loss = 2.0 / imk_shell_gyro_decay_time(design);
    const double damping = design->anisotropy.damping_difference;
    const double split = w * 2.0 * pi * design->anisotropy.frequency_split;
    const double c = cos(2.0 * design->anisotropy.damping_angle);
    const double s = sin(2.0 * design->anisotropy.damping_angle);
    const double stiff_c = split * cos(2.0 * design->anisotropy.stiffness_angle);
    const double stiff_s = split * sin(2.0 * design->anisotropy.stiffness_angle);
    const double start[4] = {x, 0.0, y, 0.0};
    *with = (oscillator_equations){.xx = w * w + stiff_c,
                                   .xv = loss + damping * c,
                                   .xy = stiff_s,
                                   .xyv = 2.0 * k * rate - damping * s,
                                   .yy = w * w - stiff_c,
                                   .yv = loss - damping * c,
                                   .yx = stiff_s,
                                   .yxv = -2.0 * k * rate - damping * s,
                                   .size_x = design->pattern.amplitude,
                                   .size_y = design->pattern.amplitude};
    oscillator_problem(start, with, problem);
}

/* q = quadrature + i rate: q' = a (r - q), r = e^{i phase} (quadrature + i rate); f' = w (rate of q
 * - f); s' = f. */
static void fork_envelope_slope(double t, const double *y, double *dy, const void *with)
{
    (void)t;
    const envelope_equations *e = with;
    const double rate = e->rate + e->bias;
    const double re = e->cosine * e->quadrature - e->sine * rate - y[0];
    const double im = e->cosine * rate + e->sine * e->quadrature - y[1];
    dy[0] = e->decay * re - e->turn * im;
    dy[1] = e->decay * im + e->turn * re;
    dy[2] = e->filter * (y[1] - y[2]);
    dy[3] = y[2];
}

static void fork_envelope_begin(size_t piece, double *y, void *with)
{
    envelope_equations *e = with;
    e->rate = e->exposure[piece].angular_rate[0];
    y[3] = 0.0;
}

static void fork_envelope_read(double t, const double *y, double *readings, const void *with)
{
    (void)t;
    const envelope_equations *e = with;
    readings[0] = y[3] / e->sample;
}

void tuning_fork_envelope_problem(const imk_tuning_fork *design, const imk_exposure *exposure,
                                  double sample, envelope_equations *with, ode_problem *problem)
{
    const double wd = 2.0 * pi * design->drive.frequency, ws = wd + 2.0 * pi * design->sense.split;
    const double g = 0.5 * ws / design->sense.q, k = design->angular_gain;
    *with = (envelope_equations){.exposure = exposure,
                                 .decay = g,
                                 .turn = -(sqrt(ws * ws - g * g) - wd),
                                 .cosine = cos(design->phase.error),
                                 .sine = sin(design->phase.error),
                                 .bias = design->damping_coupling + design->drive.force_angle * wd /
                                                                        (2.0 * k * design->drive.q),
                                 .quadrature = design->quadrature,
                                 .filter = 2.0 * pi * design->output.bandwidth,
                                 .sample = sample};
    *problem = (ode_problem){.states = 4,
                             .readings = 1,
                             .size = {1.0, 1.0, 1.0, sample},
                             .piece = sample,
                             .reference_step = 2.0 / hypot(with->decay, with->turn),
                             .slope = fork_envelope_slope,
                             .begin = fork_envelope_begin,
                             .read = fork_envelope_read,
                             .with = with};
}

static void shell_lag_slope(double t, const double *y, double *dy, const void *with)
{
    (void)t;
    const envelope_equations *e = with;
    dy[0] = e->filter * (e->bias + e->gain * e->rate - y[0]);
    dy[1] = y[0];
}

static void shell_lag_begin(size_t piece, double *y, void *with)
{
    envelope_equations *e = with;
    e->rate = e->exposure[piece].angular_rate[0];
    y[1] = 0.0;
}

static void shell_lag_read(double t, const double *y, double *readings, const void *with)
{
    (void)t;
    const envelope_equations *e = with;
    readings[0] = y[1] / e->sample;
}

void shell_gyro_lag_problem(const imk_shell_gyro *design, double bias, double gain,
                            const imk_exposure *exposure, double sample, envelope_equations *with,
                            ode_problem *problem)
{
    *with = (envelope_equations){.exposure = exposure,
                                 .bias = bias,
                                 .gain = gain,
                                 .filter = 2.0 * pi * design->control.rebalance_bandwidth,
                                 .sample = sample};
    *problem = (ode_problem){.states = 2,
                             .readings = 1,
                             .start = {bias, 0.0},
                             .size = {1.0, sample},
                             .piece = sample,
                             .reference_step = 1.0 / with->filter,
                             .slope = shell_lag_slope,
                             .begin = shell_lag_begin,
                             .read = shell_lag_read,
                             .with = with};
}

/* ---- accelerometer --------------------------------------------------------------------------- */

static const double permittivity = 8.8541878128e-12; /* [F/m], CODATA 2018 */

static double pull(const imk_mems_accelerometer *d, double plus, double minus, double z)
{
    const double near = d->gap - z, far = d->gap + z;
    return 0.5 * permittivity * d->area / d->mass * (plus / (near * near) - minus / (far * far));
}

static double spring(const imk_mems_accelerometer *d, double x)
{
    const double w0 = 2.0 * pi * d->frequency;
    return w0 * w0 * (x + x * x * (d->spring_quadratic + x * d->spring_cubic));
}

/* X, X', filter and its rate, integral of the output. */
static void mems_slope(double t, const double *y, double *dy, const void *with)
{
    (void)t;
    const mems_equations *e = with;
    const imk_mems_accelerometer *d = e->design;
    const double signal = e->unit > 0.0 ? e->signal : -e->stiffness * (y[0] - e->rest);
    dy[0] = y[1];
    dy[1] = pull(d, e->plus, e->minus, y[0] + d->offset) - spring(d, y[0]) -
            2.0 * pi * d->frequency / d->quality * y[1] - e->force;
    dy[2] = y[3];
    dy[3] = e->filter * e->filter * (signal - y[2]) - sqrt(2.0) * e->filter * y[3];
    dy[4] = y[2];
}

static void mems_open_begin(size_t piece, double *y, void *with)
{
    mems_equations *e = with;
    e->force = e->exposure[piece].specific_force[0] + e->constant;
    y[4] = 0.0;
}

static void mems_open_read(double t, const double *y, double *readings, const void *with)
{
    (void)t;
    const mems_equations *e = with;
    readings[0] = y[4] / e->sample;
}

static void mems_problem(const mems_equations *e, ode_problem *problem)
{
    const double w0 = 2.0 * pi * e->design->frequency, nm = 1e-9;
    *problem = (ode_problem){.states = 5,
                             .size = {10.0 * nm, 10.0 * nm * w0, 1.0, e->filter, e->sample},
                             .reference_step = 0.5 / w0,
                             .slope = mems_slope};
    problem->start[0] = e->rest;
}

void mems_open_problem(const imk_mems_accelerometer *design, const imk_exposure *exposure,
                       double sample, mems_equations *with, ode_problem *problem)
{
    const double v2 = design->voltage * design->voltage, small = 1e-4 * design->gap;
    const double w0 = 2.0 * pi * design->frequency;
    *with = (mems_equations){.design = design,
                             .exposure = exposure,
                             .sample = sample,
                             .constant = design->bias,
                             .filter = 2.0 * pi * design->output_bandwidth,
                             .plus = v2,
                             .minus = design->plates == IMK_MEMS_DOUBLE ? v2 : 0.0};
    /* the plates' force is a small part of the springs', so that this converges */
    for (int i = 0; i < 200; i++)
        with->rest = pull(design, with->plus, with->minus, with->rest + design->offset) / (w0 * w0);
    /* slope by differences of fourth order */
    double slope = 0.0;
    for (int i = 1; i <= 2; i++) {
        const double up = with->rest + i * small, down = with->rest - i * small;
        const double change = spring(design, up) - spring(design, down) -
                              pull(design, with->plus, with->minus, up + design->offset) +
                              pull(design, with->plus, with->minus, down + design->offset);
        slope += (i == 1 ? 4.0 / 3.0 : -1.0 / 3.0) * change / (2.0 * i * small);
    }
    with->stiffness = slope;
    mems_problem(with, problem);
    problem->readings = 1;
    problem->piece = sample;
    problem->begin = mems_open_begin;
    problem->read = mems_open_read;
    problem->with = with;
}

/* A clock: position, compensator, bit, force. */
static void mems_clock(size_t piece, double *y, void *with)
{
    mems_equations *e = with;
    const imk_mems_accelerometer *d = e->design;
    const double carrier = d->voltage * d->voltage,
                 more = d->feedback_voltage * d->feedback_voltage;
    const double z = y[0] + d->offset - d->pickoff_offset;
    if (piece == 0)
        e->before = e->sum = 0.0;
    if (piece % e->clocks == 0)
        y[4] = 0.0;
    e->force = e->exposure[piece / e->clocks].specific_force[0] + e->constant;
    e->sum += d->integral * z;
    const double compensated = z + d->lead * (z - e->before) + e->sum;
    const bool up = !(compensated > 0.0);
    e->before = z;
    e->plus = carrier + (up ? more : 0.0);
    e->minus = carrier + (up ? 0.0 : more);
    e->signal = e->middle + (up ? e->unit : -e->unit);
}

static void mems_clock_read(double t, const double *y, double *readings, const void *with)
{
    (void)t;
    const mems_equations *e = with;
    readings[0] = (y[0] + e->design->offset) / e->design->gap;
}

void mems_sigma_delta_problem(const imk_mems_accelerometer *design, const imk_exposure *exposure,
                              double sample, size_t clocks, mems_equations *with,
                              ode_problem *problem)
{
    const double carrier = design->voltage * design->voltage;
    const double more = carrier + design->feedback_voltage * design->feedback_voltage;
    const double null = design->pickoff_offset;
    const double up = pull(design, more, carrier, null), down = pull(design, carrier, more, null);
    *with = (mems_equations){.design = design,
                             .exposure = exposure,
                             .sample = sample,
                             .constant = design->bias,
                             .filter = 2.0 * pi * design->output_bandwidth,
                             .rest = null - design->offset,
                             .unit = 0.5 * (up - down),
                             .middle = 0.5 * (up + down) - spring(design, null - design->offset),
                             .clocks = clocks};
    mems_problem(with, problem);
    problem->readings = 1;
    problem->piece = sample / (double)clocks;
    problem->begin = mems_clock;
    problem->read = mems_clock_read;
    problem->with = with;
}
