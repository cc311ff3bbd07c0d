/* SPDX-License-Identifier: Apache-2.0 */
/* The electronics of a shell gyro: measured amplitudes in, forces out, once a block.
 *
 * From C and S, the amplitudes in phase and in quadrature with the reference, turned into the
 * directions along (u) and across (v) the pattern, follow [LYNCH1995]
 *
 *     phase error  -S_u/C_u,   amplitude  C_u,   quadrature  S_v,
 *     angle        half that of the point (R, S),
 *                  R = C_u^2 + S_u^2 - C_v^2 - S_v^2,  S = 2 (C_u C_v + S_u S_v),
 *
 * the last of which holds at any phase of the reference. Each of the loops is an integral and a
 * proportional part whose ratio is 1/tau: their zero cancels the pole of the resonator, so that
 * each loop is of first order. */
#include "imukit/elementary.h"
#include "shell_gyro_internal.h"

#include <math.h>
#include <string.h>

imki_shell_ellipse imki_shell_ellipse_of(imki_shell_pair c, imki_shell_pair s)
{
    const double energy = c.x * c.x + c.y * c.y + s.x * s.x + s.y * s.y;
    const double twist = 2.0 * (c.x * s.y - c.y * s.x);
    const double plus = sqrt(energy + twist > 0.0 ? energy + twist : 0.0);
    const double minus = sqrt(energy - twist > 0.0 ? energy - twist : 0.0);
    return (imki_shell_ellipse){.amplitude = 0.5 * (plus + minus),
                                .quadrature = 0.5 * (plus - minus),
                                .angle =
                                    0.5 * imk_atan2(2.0 * (c.x * c.y + s.x * s.y),
                                                    c.x * c.x + s.x * s.x - c.y * c.y - s.y * s.y)};
}

/* Amplitudes in phase (c) and in quadrature (s) of both modes, by least squares. */
static void fit(imki_shell_cycle *cycle, imki_shell_pair *c, imki_shell_pair *s)
{
    const double *sum = cycle->sum;
    const double cc = sum[4], cs = sum[5];
    /* the reference has the modulus 1 to rounding */
    const double ss = (double)cycle->block - cc;
    const double scale = 1.0 / (cc * ss - cs * cs);
    *c =
        (imki_shell_pair){(sum[0] * ss - sum[1] * cs) * scale, (sum[2] * ss - sum[3] * cs) * scale};
    *s =
        (imki_shell_pair){(sum[1] * cc - sum[0] * cs) * scale, (sum[3] * cc - sum[2] * cs) * scale};
    memset(cycle->sum, 0, sizeof cycle->sum);
}

static imki_shell_pair measured(imki_shell_state *state, imki_shell_pair true_pair)
{
    imki_shell_pair pair = imki_shell_apply(state->pickoff_axes, true_pair);
    pair.x += state->cycle.pickoff_noise * imki_draw(&state->pickoff);
    pair.y += state->cycle.pickoff_noise * imki_draw(&state->pickoff);
    return pair;
}

static imki_shell_pair turn(imki_shell_pair p, imki_shell_pair by)
{
    return (imki_shell_pair){p.x * by.x - p.y * by.y, p.x * by.y + p.y * by.x};
}

static imki_shell_pair turn_back(imki_shell_pair p, imki_shell_pair by)
{
    return (imki_shell_pair){p.x * by.x + p.y * by.y, p.y * by.x - p.x * by.y};
}

/* Proportional and integral part, held within the limit of the force; the integral stops there. */
static double command(double *integral, double gain, double error, double decay, double update,
                      double limit)
{
    *integral += gain * error * decay * update;
    *integral = imki_clamped(*integral, limit);
    return imki_clamped(*integral + gain * error, limit);
}

/* What electronics do when a pattern turns away faster than it can be held: the phase detector and
 * the oscillator reach their ends, and the drive is cut while the vibration is twice as large as it
 * should be. */
static const double largest_phase_error = 0.5; /* [rad] */
static const double pulling_range = 0.1;       /* of the frequency */
static const double largest_quadrature =
    0.02; /* command, of the frequency; 1 % of split need 0.5 % */

static double clamped_phase_error(imki_shell_pair c, imki_shell_pair s)
{
    const double limit = largest_phase_error * fabs(c.x);
    return fabs(s.x) < limit ? -s.x / c.x
           : s.x * c.x < 0.0 ? largest_phase_error
                             : -largest_phase_error;
}

/* The loops, given the amplitudes along and across the pattern. */
static void close_loops(imki_shell_state *state, imki_shell_pair c, imki_shell_pair s)
{
    imki_shell_loops *loops = &state->loops;
    const imk_shell_gyro *design = &state->design;
    const double update = state->cycle.step * (double)state->cycle.block;
    const double decay = state->decay;
    const double amplitude = design->pattern.amplitude;
    const double size = c.x * c.x + c.y * c.y + s.x * s.x + s.y * s.y;
    loops->phase_error = clamped_phase_error(c, s);
    loops->frequency += loops->gain_phase_integral * update * loops->phase_error;
    loops->frequency =
        state->omega + imki_clamped(loops->frequency - state->omega, pulling_range * state->omega);
    loops->reference = loops->frequency + loops->gain_phase * loops->phase_error;
    loops->command[0] = command(&loops->drive, loops->gain_support, (amplitude - c.x) / amplitude,
                                decay, update, (double)INFINITY);
    if (size > 4.0 * amplitude * amplitude)
        loops->command[0] = loops->drive = 0.0;
    loops->command[2] = command(&loops->quadrature, loops->gain_support, -s.y / amplitude, decay,
                                update, largest_quadrature * state->omega);
    if (design->mode == IMK_SHELL_REBALANCE) {
        loops->command[1] = command(&loops->rebalance, loops->gain_rebalance, -c.y / amplitude,
                                    decay, update, state->limit);
        loops->estimate = loops->command[1] / state->assumed;
    }
}

/* What the pattern has turned by, and where it will be in the middle of the next block: a block
 * later, less half a step, for samples are taken at the ends of steps. */
static void follow_pattern(imki_shell_state *state, imki_shell_pair c, imki_shell_pair s)
{
    imki_shell_loops *loops = &state->loops;
    const double update = state->cycle.step * (double)state->cycle.block;
    const double beside = imki_shell_ellipse_of(c, s).angle;
    const double angle = loops->pointing + beside;
    const double block = (double)state->cycle.block;
    loops->turned = angle - loops->angle;
    loops->angle = angle;
    loops->ahead = loops->turned * (block - 0.5) / block;
    if (state->design.mode == IMK_SHELL_REBALANCE)
        return;
    loops->estimate = -loops->turned / (state->assumed * update);
    loops->pointing = angle + loops->ahead;
    loops->along = (imki_shell_pair){imk_cos(loops->pointing), imk_sin(loops->pointing)};
}

/* Commands -> forces per cosine and sine of the reference, as f/(m w0^2), behind forcers that lag.
 * A rate r stands for the force 2 m w0 a r. */
static void electrode_forces(const imki_shell_state *state, imki_shell_pair *c, imki_shell_pair *s)
{
    const imki_shell_loops *loops = &state->loops;
    const imk_shell_gyro *design = &state->design;
    const double unit = 2.0 * design->pattern.amplitude / state->omega;
    const double lag_c = state->lag_cosine, lag_s = state->lag_sine;
    const double *r = loops->command;
    const double drive = design->forcer.drive == IMK_SHELL_DIRECTIONAL ? r[0] : 0.0;
    /* (x, y) = (along, across), turned into the axes of the electrodes */
    const imki_shell_pair sine = turn((imki_shell_pair){-unit * drive, -unit * r[1]}, loops->along);
    const imki_shell_pair cosine = turn((imki_shell_pair){0.0, unit * r[2]}, loops->along);
    *c = imki_shell_apply(state->forcer_axes, (imki_shell_pair){cosine.x * lag_c - sine.x * lag_s,
                                                                cosine.y * lag_c - sine.y * lag_s});
    *s = imki_shell_apply(state->forcer_axes, (imki_shell_pair){cosine.x * lag_s + sine.x * lag_c,
                                                                cosine.y * lag_s + sine.y * lag_c});
}

/* The parametric drive, -4 w p sin(2 wt) X, of which the part at w is -2 w p (C sin + S cos), and
 * the part of the damping that wanders, -M X', whose part at w is -w M (S cos - C sin). Both follow
 * the motion at once; C and S are those of the last block, turned on by what the pattern turns. */
static void forces_of_motion(const imki_shell_state *state, imki_shell_pair motion_c,
                             imki_shell_pair motion_s, imki_shell_pair *c, imki_shell_pair *s)
{
    const imk_shell_gyro *design = &state->design;
    const double w0 = state->omega;
    const imki_shell_pair by = {imk_cos(state->loops.ahead), imk_sin(state->loops.ahead)};
    const imki_shell_pair x = turn(motion_c, by), y = turn(motion_s, by);
    const double pump =
        design->forcer.drive == IMK_SHELL_PARAMETRIC ? 2.0 * state->loops.command[0] / w0 : 0.0;
    const double dc = state->damping[0] / w0, ds = state->damping[1] / w0;
    s->x += -pump * x.x + (dc * x.x + ds * x.y);
    s->y += -pump * x.y + (ds * x.x - dc * x.y);
    c->x += -pump * y.x - (dc * y.x + ds * y.y);
    c->y += -pump * y.y - (ds * y.x - dc * y.y);
}

/* Forces for the block to come, for a converter that holds them over each step. */
static void set_forces(imki_shell_state *state, imki_shell_pair c, imki_shell_pair s)
{
    imki_shell_cycle *cycle = &state->cycle;
    const double half = 0.5 * state->loops.reference * cycle->step;
    const double hc = imk_cos(half), hs = imk_sin(half), gain = half / hs;
    const double u[4] = {gain * (c.x * hc + s.x * hs), gain * (c.y * hc + s.y * hs),
                         gain * (s.x * hc - c.x * hs), gain * (s.y * hc - c.y * hs)};
    const double size = cycle->cosine * cycle->cosine + cycle->sine * cycle->sine;
    const double restore = 1.5 - 0.5 * size; /* of the modulus, which rounding changes */
    for (int i = 0; i < 4; i++) {
        cycle->per_cosine[i] = cycle->force[2 * i] * u[0] + cycle->force[2 * i + 1] * u[1];
        cycle->per_sine[i] = cycle->force[2 * i] * u[2] + cycle->force[2 * i + 1] * u[3];
    }
    cycle->turn_cosine = hc * hc - hs * hs;
    cycle->turn_sine = 2.0 * hc * hs;
    cycle->cosine *= restore;
    cycle->sine *= restore;
}

void imki_shell_update_loops(imki_shell_state *state)
{
    imki_shell_loops *loops = &state->loops;
    imki_shell_pair motion_c = {state->cycle.z[0], state->cycle.z[2]}, motion_s = {0.0, 0.0};
    imki_shell_pair c = {0.0, 0.0}, s = {0.0, 0.0};
    if (state->cycle.position > 0) { /* not the first call, before any block */
        fit(&state->cycle, &motion_c, &motion_s);
        c = turn_back(measured(state, motion_c), loops->along);
        s = turn_back(measured(state, motion_s), loops->along);
        if (state->design.mode != IMK_SHELL_FREE)
            close_loops(state, c, s);
        follow_pattern(state, c, s);
    }
    c = s = (imki_shell_pair){0.0, 0.0};
    if (state->design.mode != IMK_SHELL_FREE)
        electrode_forces(state, &c, &s);
    forces_of_motion(state, motion_c, motion_s, &c, &s);
    set_forces(state, c, s);
}
