/* SPDX-License-Identifier: Apache-2.0 */
/* A MEMS accelerometer in time. A step of the full level is
 *
 *     kick by what is not linear (h/2), linear system (h, exact, with its noise), stops, kick (h/2)
 *
 * a symmetric splitting [STRANG1968]: of second order, time-reversible without damping, and without
 * error where the forces are linear. The kicks hold the rest of the plates' and springs' forces,
 * what temperature changes in them, the film's damping beyond that at rest, the pickoff's
 * curvature, and the limit of the control voltage. */
#include "base/algebra/linear_system_internal.h"
#include "mems_accelerometer_internal.h"

#include <math.h>
#include <string.h>

enum { N = IMKI_MEMS_STATES };

/* Sources of randomness, fixed for ever. */
enum { DRAW_LINEAR = 0, DRAW_PICKOFF = 1, DRAW_FILM = 2 };
enum { WANDER_BIAS = 0, WANDER_GAIN = 1 };

typedef imki_mems_state mems_state;

/* ---- the linear part ------------------------------------------------------------------------- */

/* Two rows at a time: what every vector unit has. The sums stay in registers over all columns. */
typedef double row_pair __attribute__((vector_size(16)));
enum { PAIRS = N / 2 };

static inline row_pair pair_of(const double *row)
{
    return (row_pair){row[0], row[1]};
}

static void advance(mems_state *m, double force, double signal)
{
    row_pair next[PAIRS];
    for (int p = 0; p < PAIRS; p++)
        next[p] = pair_of(m->gamma[IMKI_FORCE] + 2 * p) * force +
                  pair_of(m->gamma[IMKI_SIGNAL] + 2 * p) * signal;
    for (int j = 0; j < m->n; j++)
        for (int p = 0; p < PAIRS; p++)
            next[p] += pair_of(m->phi[j] + 2 * p) * m->s[j];
    for (int j = 0; j < m->noise_columns; j++) {
        const double draw = imki_draw(&m->linear);
        for (int p = 0; p < PAIRS; p++)
            next[p] += pair_of(m->root[j] + 2 * p) * draw;
    }
    memcpy(m->s, next, sizeof m->s);
}

static void discretise(mems_state *m, double h, bool noise)
{
    imki_mems_system system;
    double phi[N * N], gamma[N * IMKI_MEMS_INPUTS], root[N * N];
    imki_mems_linear_system(&m->design, &m->point, m->slow, &system);
    const int n = m->n = system.n;
    imki_discretise(n, IMKI_MEMS_INPUTS, system.a, system.b, h, phi, gamma);
    imki_step_covariance(n, system.a, system.w, h, root);
    imki_covariance_root(n, root, root);
    memset(m->phi, 0, sizeof m->phi);
    memset(m->root, 0, sizeof m->root);
    memset(m->gamma, 0, sizeof m->gamma);
    memcpy(m->control, system.control, sizeof m->control);
    m->noise_columns = 0;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) {
            m->phi[j][i] = phi[i * n + j];
            m->root[j][i] = root[i * n + j];
            if (noise && root[i * n + j] != 0.0 && j >= m->noise_columns)
                m->noise_columns = j + 1;
        }
    for (int i = 0; i < n; i++)
        for (int j = 0; j < IMKI_MEMS_INPUTS; j++)
            m->gamma[j][i] = gamma[i * IMKI_MEMS_INPUTS + j];
}

/* ---- what is not linear ---------------------------------------------------------------------- */

/* The analog loop: voltage on the mass for the acceleration that the controller asks for. Beyond
 * its limit the output sees the limit too, and the integral part stands still. */
static double control_voltage(mems_state *m, double *asked, double duration)
{
    *asked = 0.0;
    for (int j = IMKI_AMPLIFIER; j < N; j++)
        *asked += m->control[j] * m->s[j];
    const double wanted = m->point.control + *asked / m->point.b1;
    const double given = imki_clamped(wanted, m->design.feedback_voltage);
    if (given != wanted) {
        const double excess = m->point.b1 * (given - m->point.control) - *asked;
        m->s[m->output_into] += m->output_gain * excess * duration;
        if (m->design.reset > 0.0)
            m->s[IMKI_RESET] -= m->s[IMKI_COMPENSATOR] * duration;
    }
    m->control_voltage = given;
    m->feedback = m->point.b1 * (given - m->point.control);
    return given;
}

/* Acceleration beyond the linear part's. */
static double excess_force(mems_state *m, double duration)
{
    const imk_mems_accelerometer *d = &m->design;
    const double x = m->s[IMKI_POSITION], z = m->point.z + x, spring_x = m->point.spring + x;
    const double v = m->voltage;
    double plus = v * v, minus = v * v, linear = -m->point.a1 * x;
    if (d->loop == IMK_MEMS_ANALOG) {
        double asked;
        const double u = control_voltage(m, &asked, duration);
        plus = (v - u) * (v - u);
        minus = (v + u) * (v + u);
        linear += asked;
    } else if (d->loop == IMK_MEMS_SIGMA_DELTA) {
        *(m->bit > 0.0 ? &plus : &minus) += d->feedback_voltage * d->feedback_voltage;
        linear += m->point.rest + m->point.unit * m->bit;
    }
    const double inverse = 1.0 / ((d->gap - z) * (d->gap + z));
    const double near = (d->gap + z) * inverse, far = (d->gap - z) * inverse;
    const double volts = 1.0 + d->voltage_temperature * m->temperature;
    if (d->plates == IMK_MEMS_SINGLE)
        minus = 0.0;
    const double pull = m->pull_constant * volts * volts * (plus * near * near - minus * far * far);
    const double spring = m->spring_constant * (1.0 + d->spring_temperature * m->temperature) *
                          spring_x *
                          (1.0 + spring_x * (d->spring_quadratic + spring_x * d->spring_cubic));
    return pull - spring - linear;
}

/* Where the pickoff is not linear, what it reads beyond the displacement. */
static void bend_pickoff(mems_state *m, double duration)
{
    const imk_mems_accelerometer *d = &m->design;
    const double x = m->s[IMKI_POSITION];
    const double reads = imki_mems_pickoff_series(d, m->point.z + x).value;
    const double excess = (reads - m->point.pickoff.value) / m->point.pickoff.first - x;
    if (d->loop == IMK_MEMS_OPEN)
        m->s[m->output_into] -= m->output_gain * m->point.a1 * excess * duration;
    else if (d->loop == IMK_MEMS_ANALOG)
        m->s[IMKI_AMPLIFIER] += 2.0 * IMKI_PI * d->amplifier * excess * duration;
}

static void kick(mems_state *m, double duration)
{
    const double force = excess_force(m, duration);
    if (m->pickoff_bends)
        bend_pickoff(m, duration);
    if (!m->design.squeeze_film) {
        m->s[IMKI_VELOCITY] += force * duration;
        return;
    }
    /* v' = force - r v, r the damping beyond that at rest, by the midpoint rule; its noise gives
     * the mass the same temperature, v^2 = kT/m */
    const double z = m->point.z + m->s[IMKI_POSITION];
    const double r =
        m->damping_constant * imk_mems_accelerometer_damping(&m->design, z) - m->point.damping;
    const double half = 0.5 * r * duration, left = (1.0 - half) / (1.0 + half);
    double *v = &m->s[IMKI_VELOCITY];
    *v = left * *v + force * duration / (1.0 + half);
    const double draw = imki_draw(&m->film);
    if (r > 0.0)
        *v += draw *
              sqrt(IMKI_BOLTZMANN * m->design.temperature / m->design.mass * (1.0 - left * left));
}

static void meet_stops(mems_state *m)
{
    const double end = m->design.stop * m->design.gap, z = m->point.z + m->s[IMKI_POSITION];
    if (fabs(z) < end)
        return;
    m->s[IMKI_POSITION] = (z > 0.0 ? end : -end) - m->point.z;
    if (m->s[IMKI_VELOCITY] * z > 0.0)
        m->s[IMKI_VELOCITY] *= -m->design.restitution;
}

/* ---- a sample -------------------------------------------------------------------------------- */

/* The bit of the coming clock. */
static void decide(mems_state *m)
{
    const imk_mems_accelerometer *d = &m->design;
    const double z = m->point.z + m->s[IMKI_POSITION];
    double y =
        (imki_mems_pickoff_series(d, z).value - m->point.pickoff.value) / m->point.pickoff.first;
    y += m->pickoff_deviation * imki_draw(&m->pickoff);
    m->sum += d->integral * y;
    m->compensated = y + d->lead * (y - m->before) + m->sum;
    m->before = y;
    m->bit = m->compensated > 0.0 ? -1.0 : 1.0;
    m->feedback = m->point.unit * m->bit + m->point.rest;
}

static double run_full(mems_state *m, double force)
{
    const bool clocked = m->design.loop == IMK_MEMS_SIGMA_DELTA;
    m->s[IMKI_INTEGRAL] = 0.0;
    for (size_t i = 0; i < m->clocks; i++) {
        if (clocked)
            decide(m);
        const double fed = clocked ? m->feedback : 0.0;
        kick(m, 0.5 * m->h);
        for (size_t j = 1; j <= m->substeps; j++) {
            advance(m, fed - force, fed);
            if (m->design.voltage_rate != 0.0) {
                m->time += m->h;
                m->voltage = m->design.voltage + m->design.voltage_rate * m->time;
                if (m->voltage > m->highest_voltage)
                    m->voltage = m->highest_voltage;
            }
            meet_stops(m);
            /* the half kicks of two steps in one */
            kick(m, j < m->substeps ? m->h : 0.5 * m->h);
        }
    }
    return m->s[IMKI_INTEGRAL] / m->sample;
}

static double run_slow(mems_state *m, double force)
{
    const imki_mems_static *e = &m->errors;
    const bool clocked = m->design.loop == IMK_MEMS_SIGMA_DELTA;
    const double more = (e->bias_temperature - m->design.bias_temperature) * m->temperature;
    /* what the loop leaves of a force: of the linear system already; without its bits, by hand */
    const double shown = clocked ? 1.0 : 1.0 + e->scale;
    const double scale =
        1.0 + e->scale_temperature / shown * m->temperature + (clocked ? e->scale : 0.0);
    force = imki_clamped(force + more, m->limit); /* the series mean nothing beyond */
    const double seen = force * (scale + force * (e->k2 + force * e->k3) / shown);
    m->s[IMKI_INTEGRAL] = 0.0;
    advance(m, clocked ? 0.0 : -seen, clocked ? seen + e->bias : 0.0);
    return imki_clamped(m->s[IMKI_INTEGRAL] / m->sample, m->limit);
}

void imki_mems_step(void *state, const imk_exposure *exposure, double *outputs)
{
    mems_state *m = state;
    const imk_mems_accelerometer *d = &m->design;
    const double *f = exposure->specific_force;
    m->temperature = exposure->temperature - d->temperature;
    const double bias = d->bias + d->bias_temperature * m->temperature + imki_wander_next(&m->bias);
    const double force = f[0] + d->tilt_y * f[1] + d->tilt_z * f[2] + bias;
    double reading = m->slow ? run_slow(m, force) : run_full(m, force);
    reading *= 1.0 + m->gain.constant;
    if (d->range > 0.0)
        reading = imki_clamped(reading, d->range);
    reading = imki_quantised(reading, d->resolution);
    outputs[0] = reading;
}

void imki_mems_observe(const void *state, double *signals)
{
    const mems_state *m = state;
    const bool analog = m->design.loop == IMK_MEMS_ANALOG;
    signals[0] = m->point.z + m->s[IMKI_POSITION];
    signals[1] = m->s[IMKI_VELOCITY];
    signals[2] = m->voltage;
    signals[3] = analog ? m->control_voltage : 0.0;
    signals[4] = m->design.loop == IMK_MEMS_OPEN ? 0.0 : m->feedback;
    signals[5] = m->bit;
    signals[6] = m->compensated;
}

/* ---- start ----------------------------------------------------------------------------------- */

double imki_mems_step_length(const void *design, const imk_physics_settings *settings)
{
    const imk_mems_accelerometer *d = design;
    const double steps = d->voltage_rate != 0.0 ? IMKI_MEMS_RAMP_STEPS : IMKI_MEMS_STEPS;
    double step = 1.0 / (steps * imki_mems_fastest(d));
    if (settings->level == IMK_LEVEL_SLOW)
        return 1.0 / settings->rate;
    if (d->loop == IMK_MEMS_SIGMA_DELTA && 1.0 / d->clock < step)
        step = 1.0 / d->clock;
    return step;
}

/* Clocks to a sample and steps to a clock. */
static imk_status divide(mems_state *m, const imk_physics_settings *settings, imk_error *error)
{
    imk_mems_accelerometer *d = &m->design;
    imk_physics_settings unit = *settings;
    m->clocks = 1;
    m->substeps = 1;
    m->h = m->sample;
    if (m->slow)
        return IMK_OK;
    if (d->loop == IMK_MEMS_SIGMA_DELTA) {
        if (settings->rate > d->clock * (1.0 + 1e-9))
            return imki_refuse(error, IMK_ERROR_RANGE, "rate", settings->rate, d->clock,
                               "a sample rate not above the clock of the loop");
        imk_physics_settings clocked = *settings;
        double clock;
        clocked.step = 0.0;
        const imk_status status =
            imki_divide_sample(&clocked, 1.0 / d->clock, (double)INFINITY,
                               "at least one step to a clock", &m->clocks, &clock, error);
        if (status != IMK_OK)
            return status;
        unit.rate = d->clock = settings->rate * (double)m->clocks;
    }
    return imki_divide_sample(&unit, imki_mems_step_length(d, settings),
                              1.0 / (IMKI_MEMS_STEPS_MIN * imki_mems_fastest(d)),
                              "at least 16 steps to a cycle of the springs or the loop",
                              &m->substeps, &m->h, error);
}

static void set_constants(mems_state *m)
{
    const imk_mems_accelerometer *d = &m->design;
    const double wf = 2.0 * IMKI_PI * d->output_bandwidth, w0 = 2.0 * IMKI_PI * d->frequency;
    m->output_into = wf > 0.0 ? IMKI_FILTER_RATE : IMKI_INTEGRAL;
    m->output_gain = wf > 0.0 ? wf * wf : 1.0;
    m->pull_constant = 0.5 * IMKI_PERMITTIVITY * d->area / d->mass;
    m->spring_constant = w0 * w0;
    m->damping_constant = w0 / d->quality;
    m->pickoff_bends = d->plates == IMK_MEMS_SINGLE || d->pickoff != IMK_MEMS_RATIO;
    m->pickoff_deviation = d->pickoff_noise * sqrt(0.5 * d->clock);
    m->voltage = d->voltage;
    m->highest_voltage = 10.0 * imk_mems_accelerometer_pull_in(d); /* far beyond is no experiment */
    m->control_voltage = m->point.control;
    m->bit = 1.0;
    m->limit = imk_mems_accelerometer_limit(d);
}

imk_status imki_mems_init(const void *design, const imk_physics_settings *settings, void *state,
                          imk_error *error)
{
    mems_state *m = state;
    m->design = *(const imk_mems_accelerometer *)design;
    m->slow = settings->level == IMK_LEVEL_SLOW;
    m->sample = 1.0 / settings->rate;
    imk_status status = divide(m, settings, error);
    if (status != IMK_OK)
        return status;
    m->point = imki_mems_operating_point(&m->design);
    m->errors = imki_mems_static_errors(&m->design, &m->point);
    set_constants(m);
    discretise(m, m->h, settings->noise);
    imki_draws_start(&m->linear, settings, DRAW_LINEAR);
    imki_draws_start(&m->pickoff, settings, DRAW_PICKOFF);
    imki_draws_start(&m->film, settings, DRAW_FILM);
    const imk_mems_accelerometer *d = &m->design;
    imki_wander_start(&m->bias, settings, WANDER_BIAS, d->bias_repeatability, d->bias_instability);
    imki_wander_start(&m->gain, settings, WANDER_GAIN, d->gain_repeatability, 0.0);
    return IMK_OK;
}
