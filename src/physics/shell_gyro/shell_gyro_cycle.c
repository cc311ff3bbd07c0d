/* SPDX-License-Identifier: Apache-2.0 */
/* Full dynamics of a shell gyro: every cycle of the vibration, at 16 or more steps to it.
 *
 * The state z = (x, x'/w0, y, y'/w0) is carried from step to step by the exact solution,
 *
 *     z[j+1] = phi z[j] + gamma u[j],   u = f/(m w0^2),
 *
 * phi and gamma of the equations in shell_gyro.h with rate and temperature constant. There is no
 * numerical damping: what phi loses by rounding is of the order of 1e-15 a step. The forces are the
 * output of a converter that holds them for a step,
 *
 *     u[j] = A cos p_j + B sin p_j,   p_j the phase of the reference,
 *
 * with A and B, constant for a block of some cycles, turned on by half a step's phase h wr/2 and
 * divided by sin(h wr/2)/(h wr/2), which makes the fundamental of the held force exact. The held
 * force also has parts at 15, 17, … times the frequency, where the shell does not respond.
 *
 * The electronics see x and y at the end of every step. At the end of a block the amplitudes that
 * fit x = C cos p + S sin p best follow from the sums of x cos p, x sin p, cos^2 p and cos p sin p:
 * no part at 2 wr is left whatever the length of the block. Pickoff noise of density n on every
 * sample adds errors of variance 2 n^2/T to them, T the length of the block; they are drawn as
 * such.
 *
 * Brownian forces are white, of the two-sided density 2 kB Temp (damping matrix). Their effect over
 * a block is added in its middle, with the covariance that becomes the exact one at the block's
 * end, the case at rest; a turning case leaves it what it is but for (k W T)(D tau). What the loops
 * see of it within the block differs from a steady stream of noise by parts (T/tau)^2. */
#include "base/algebra/linear_system_internal.h"
#include "imukit/elementary.h"
#include "shell_gyro_internal.h"

#include <math.h>
#include <string.h>

/* z' = A z + B u in the units of the state. */
static void equations(const imki_shell_state *state, const imki_shell_resonator *r, double rate,
                      double acceleration, double a[16], double b[8])
{
    const double w0 = state->omega, k = state->gain;
    const double stiff = r->omega * r->omega, split = r->omega;
    memset(a, 0, 16 * sizeof *a);
    memset(b, 0, 8 * sizeof *b);
    a[1] = a[11] = w0;
    a[4] = -(stiff + split * r->stiffness_cosine) / w0;
    a[5] = -2.0 * r->decay - r->damping_cosine;
    a[6] = (k * acceleration - split * r->stiffness_sine) / w0;
    a[7] = 2.0 * k * rate - r->damping_sine;
    a[12] = (-k * acceleration - split * r->stiffness_sine) / w0;
    a[13] = -2.0 * k * rate - r->damping_sine;
    a[14] = -(stiff - split * r->stiffness_cosine) / w0;
    a[15] = -2.0 * r->decay + r->damping_cosine;
    b[2] = b[7] = w0;
}

void imki_shell_matrices(imki_shell_state *state, double rate, double acceleration,
                         double temperature)
{
    imki_shell_cycle *cycle = &state->cycle;
    const imki_shell_resonator r = imki_shell_resonator_at(&state->design, temperature);
    double a[16], b[8];
    equations(state, &r, rate, acceleration, a, b);
    imki_discretise(4, 2, a, b, cycle->step, cycle->phi, cycle->force);
    cycle->rate = rate;
    cycle->acceleration = acceleration;
    cycle->temperature = temperature;
    cycle->noise_scale = sqrt(temperature / IMKI_DESIGN_TEMPERATURE * r.decay *
                              imk_shell_gyro_decay_time(&state->design));
    state->forcer_axes = imki_shell_forcer(&state->design, r.forcer_gain);
}

/* Root of the covariance of the Brownian motion that a block adds, at the reference temperature and
 * carried back to the middle of the block. Force density 2 kB T m (2/tau + D c, D s; D s, 2/tau -
 * D c); on x'/w0 divided by (m w0)^2. */
static void thermal_root(imki_shell_state *state)
{
    imki_shell_cycle *cycle = &state->cycle;
    const imk_shell_gyro *design = &state->design;
    const imki_shell_resonator r = imki_shell_resonator_at(design, IMKI_DESIGN_TEMPERATURE);
    const double w0 = state->omega;
    const double unit =
        2.0 * IMKI_BOLTZMANN * IMKI_DESIGN_TEMPERATURE / (design->resonator.mass * w0 * w0);
    double a[16], b[8], w[16] = {0.0}, q[16], back[16], half[16];
    equations(state, &r, 0.0, 0.0, a, b);
    w[5] = unit * (2.0 * r.decay + r.damping_cosine);
    w[7] = w[13] = unit * r.damping_sine;
    w[15] = unit * (2.0 * r.decay - r.damping_cosine);
    imki_step_covariance(4, a, w, cycle->step * (double)cycle->block, q);
    imki_exponential(4, a, -cycle->step * (double)(cycle->block - cycle->middle), back);
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++) {
            half[4 * i + j] = 0.0;
            for (int k = 0; k < 4; k++)
                half[4 * i + j] += back[4 * i + k] * q[4 * k + j];
        }
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++) {
            q[4 * i + j] = 0.0;
            for (int k = 0; k < 4; k++)
                q[4 * i + j] += half[4 * i + k] * back[4 * j + k];
        }
    imki_covariance_root(4, q, cycle->root);
}

/* The loops as they are when they have settled, case at rest. */
static void loops_start(imki_shell_state *state, double temperature)
{
    const imk_shell_gyro *design = &state->design;
    imki_shell_loops *loops = &state->loops;
    const double update = state->cycle.step * (double)state->cycle.block;
    const imki_shell_balance balance =
        imki_shell_balance_at(design, temperature, 0.0, design->pattern.angle);
    const bool free_pattern = design->mode == IMK_SHELL_FREE;
    const double phase_gain = imki_shell_loop_gain(design->control.support_bandwidth, update);
    memset(loops, 0, sizeof *loops);
    loops->gain_support = phase_gain / update;
    loops->gain_rebalance =
        imki_shell_loop_gain(design->control.rebalance_bandwidth, update) / update;
    /* a double pole */
    loops->gain_phase = phase_gain / update;
    loops->gain_phase_integral = 0.25 * loops->gain_phase * loops->gain_phase;
    loops->frequency = loops->reference = free_pattern ? state->omega : balance.frequency;
    loops->angle = loops->pointing = design->pattern.angle;
    loops->along = (imki_shell_pair){imk_cos(loops->pointing), imk_sin(loops->pointing)};
    if (!free_pattern) {
        loops->command[0] = loops->drive = balance.drive;
        loops->command[1] = loops->rebalance = balance.rebalance;
        loops->command[2] = loops->quadrature = balance.quadrature;
    }
    if (design->mode == IMK_SHELL_REBALANCE)
        loops->estimate = balance.rebalance / state->assumed;
    state->cycle.z[0] = balance.amplitude * imk_cos(balance.actual);
    state->cycle.z[2] = balance.amplitude * imk_sin(balance.actual);
}

void imki_shell_cycle_start(imki_shell_state *state)
{
    imki_shell_cycle *cycle = &state->cycle;
    const double steps = imki_shell_update(&state->design) / cycle->step;
    cycle->block = (size_t)(steps + 0.5);
    cycle->middle = cycle->block / 2;
    cycle->cosine = 1.0;
    cycle->pickoff_noise =
        state->design.pickoff.noise * sqrt(2.0 / (cycle->step * (double)cycle->block));
    thermal_root(state);
    imki_shell_matrices(state, 0.0, 0.0, IMKI_DESIGN_TEMPERATURE);
    loops_start(state, IMKI_DESIGN_TEMPERATURE);
    imki_shell_update_loops(state); /* the forces of the first block */
    cycle->fresh = true;
}

/* Two numbers at a time: what every vector unit has. Left to itself gcc 12 does one at a time. */
typedef double number_pair __attribute__((vector_size(16)));

static inline number_pair both(double x)
{
    return (number_pair){x, x};
}

void imki_shell_advance(imki_shell_cycle *restrict cycle, size_t count)
{
    const double tc = cycle->turn_cosine, ts = cycle->turn_sine;
    const number_pair forward = {tc, ts}, across = {-ts, tc};
    number_pair phi[4][2], per_cosine[2], per_sine[2], z[2], x_sum, y_sum; /* phi by columns */
    number_pair reference = {cycle->cosine, cycle->sine};
    number_pair square = {cycle->sum[4], cycle->sum[5]};
    for (int p = 0; p < 2; p++) {
        const int i = 2 * p;
        z[p] = (number_pair){cycle->z[i], cycle->z[i + 1]};
        per_cosine[p] = (number_pair){cycle->per_cosine[i], cycle->per_cosine[i + 1]};
        per_sine[p] = (number_pair){cycle->per_sine[i], cycle->per_sine[i + 1]};
        for (int j = 0; j < 4; j++)
            phi[j][p] = (number_pair){cycle->phi[4 * i + j], cycle->phi[4 * (i + 1) + j]};
    }
    x_sum = (number_pair){cycle->sum[0], cycle->sum[1]};
    y_sum = (number_pair){cycle->sum[2], cycle->sum[3]};
    for (size_t n = 0; n < count; n++) {
        const number_pair c = both(reference[0]), s = both(reference[1]);
        const number_pair z0 = both(z[0][0]), z1 = both(z[0][1]);
        const number_pair z2 = both(z[1][0]), z3 = both(z[1][1]);
        for (int p = 0; p < 2; p++)
            z[p] = ((phi[0][p] * z0 + phi[1][p] * z1) + (phi[2][p] * z2 + phi[3][p] * z3)) +
                   (per_cosine[p] * c + per_sine[p] * s);
        reference = c * forward + s * across;
        x_sum += both(z[0][0]) * reference;
        y_sum += both(z[1][0]) * reference;
        square += both(reference[0]) * reference;
    }
    for (int p = 0; p < 2; p++) {
        cycle->z[2 * p] = z[p][0];
        cycle->z[2 * p + 1] = z[p][1];
        cycle->sum[p] = x_sum[p];
        cycle->sum[2 + p] = y_sum[p];
        cycle->sum[4 + p] = square[p];
    }
    cycle->cosine = reference[0];
    cycle->sine = reference[1];
}

static void add_thermal_noise(imki_shell_state *state)
{
    imki_shell_cycle *cycle = &state->cycle;
    double normal[4];
    for (int i = 0; i < 4; i++)
        normal[i] = imki_draw(&state->thermal) * cycle->noise_scale;
    for (int i = 0; i < 4; i++)
        for (int j = 0; j <= i; j++)
            cycle->z[i] += cycle->root[4 * i + j] * normal[j];
}

static void follow_exposure(imki_shell_state *state, const imk_exposure *exposure)
{
    const double rate = imki_shell_input(&state->design, exposure->angular_rate);
    const double acceleration = imki_shell_input(&state->design, exposure->angular_acceleration);
    for (int i = 0; i < 2; i++)
        state->damping[i] = imki_wander_next(&state->wander[i]);
    if (rate != state->cycle.rate || acceleration != state->cycle.acceleration ||
        exposure->temperature != state->cycle.temperature)
        imki_shell_matrices(state, rate, acceleration, exposure->temperature);
    if (state->cycle.fresh && exposure->temperature != IMKI_DESIGN_TEMPERATURE) {
        loops_start(state, exposure->temperature); /* settled at the temperature it starts in */
        imki_shell_update_loops(state);
    }
    state->cycle.fresh = false;
}

void imki_shell_cycle_step(imki_shell_state *state, const imk_exposure *exposure, double *outputs)
{
    imki_shell_cycle *cycle = &state->cycle;
    double turned = 0.0;
    size_t left = state->count;
    follow_exposure(state, exposure);
    while (left > 0) {
        const size_t target = cycle->position < cycle->middle ? cycle->middle : cycle->block;
        const size_t ahead = target - cycle->position, count = left < ahead ? left : ahead;
        imki_shell_advance(cycle, count);
        turned += state->loops.estimate * (double)count;
        cycle->position += count;
        left -= count;
        if (cycle->position == cycle->middle)
            add_thermal_noise(state);
        if (cycle->position == cycle->block) {
            imki_shell_update_loops(state);
            cycle->position = 0;
        }
    }
    outputs[0] = turned / (double)state->count;
    outputs[1] = state->loops.angle / state->design.resonator.mode_number;
}
