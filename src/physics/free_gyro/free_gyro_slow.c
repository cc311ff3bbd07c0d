/* SPDX-License-Identifier: Apache-2.0 */
/* Precession of a free gyro without gimbals' inertia, so without nutation: the spin axis turns in
 * inertial space with the torques alone,
 *
 *     b' = -q + Mo/(H c),    a' = -wx + r tan b - Mi/(H c)
 *
 * (b, a inner and outer angle, q and r the case's rates along the outer gimbal's y and z). Half a
 * step's torque, the exact turn of the case, the other half: the error is of second order in the
 * step times the product of drift and case rate. At the stop the outer gimbal follows the spin axis
 * and the inner one stays: the tumbling there is in the full dynamics only. */
#include "base/algebra/vector_internal.h"
#include "free_gyro_internal.h"
#include "imukit/elementary.h"

#include <math.h>

/* Precession of both angles in inertial space, friction included. The friction turns on the rates
 * it changes itself by the slope over H, squared after two rounds. */
static void precession(const imki_free_gyro_state *state, const imki_free_gyro_drive *drive,
                       const double w[3], const double white[2], double rate[2])
{
    const imki_gimbals *g = &state->gimbals;
    const imki_free_gyro_parts *parts = &state->parts;
    const double per_h = 1.0 / (parts->h * g->ci);
    const double q = w[1] * g->co + w[2] * g->so, r = w[2] * g->co - w[1] * g->so;
    double torque[2];
    imki_free_gyro_force_torque(parts, g, drive->force, &torque[0], &torque[1]);
    torque[0] += drive->outer + white[0];
    torque[1] += drive->inner + white[1];
    rate[0] = -torque[1] * per_h;
    rate[1] = torque[0] * per_h;
    for (int i = 0; i < 4 && parts->slope > 0.0; i++) {
        const double outer = rate[0] - w[0] + r * g->si / g->ci, inner = rate[1] - q;
        rate[0] = -(torque[1] + imki_free_gyro_friction(parts, inner)) * per_h;
        rate[1] = (torque[0] + imki_free_gyro_friction(parts, outer)) * per_h;
    }
}

/* The spin axis in case axes turns by the rotation vector -turned (Rodrigues' formula), and the
 * gimbals follow; the outer angle by the way round that is shorter. */
static void turn_case(imki_gimbals *g, const double turned[3])
{
    const double angle = imki_norm3(turned);
    double axis[3] = {g->si, -g->so * g->ci, g->co * g->ci}, n[3];
    if (!(angle > 0.0))
        return;
    for (int k = 0; k < 3; k++)
        n[k] = turned[k] / angle;
    const double sine = imk_sin(angle), half = imk_sin(0.5 * angle);
    const double along = imki_dot3(n, axis);
    double next[3];
    for (int k = 0; k < 3; k++) {
        const int l = (k + 1) % 3, m = (k + 2) % 3;
        next[k] = axis[k] - sine * (n[l] * axis[m] - n[m] * axis[l]) -
                  2.0 * half * half * (axis[k] - along * n[k]);
    }
    /* the angle between the two azimuths, without the digits of a large outer angle */
    g->outer +=
        imk_atan2(next[2] * axis[1] - next[1] * axis[2], next[2] * axis[2] + next[1] * axis[1]);
    g->inner = imk_atan2(next[0], sqrt(next[1] * next[1] + next[2] * next[2]));
}

void imki_free_gyro_slow(imki_free_gyro_state *state, const imki_free_gyro_drive *drive)
{
    imki_gimbals *g = &state->gimbals;
    const double h = state->step;
    state->on_stop = false;
    for (size_t i = 0; i < state->steps; i++) {
        const double time = ((double)i + 0.5) * h - 0.5 * state->sample;
        double w[3], turned[3], rate[2], white[2] = {0.0, 0.0};
        for (int k = 0; k < 3; k++) {
            w[k] = drive->rate[k] + time * drive->acceleration[k];
            turned[k] = h * w[k];
        }
        for (int k = 0; k < 2 && state->torque_sigma > 0.0; k++)
            white[k] = state->torque_sigma * imki_draw(&state->white[k]);
        for (int half = 0; half < 2; half++) {
            imki_free_gyro_trigonometry(g);
            precession(state, drive, w, white, rate);
            g->outer += 0.5 * h * rate[0];
            g->inner += 0.5 * h * rate[1];
            if (half == 0) {
                imki_free_gyro_trigonometry(g);
                turn_case(g, turned);
            }
        }
        if (g->inner > state->parts.stop || g->inner < -state->parts.stop) {
            g->inner = g->inner > 0.0 ? state->parts.stop : -state->parts.stop;
            state->on_stop = true;
        }
    }
    imki_free_gyro_trigonometry(g);
    imki_free_gyro_force_torque(&state->parts, g, drive->force, &state->last_torque[0],
                                &state->last_torque[1]);
    state->last_torque[0] += drive->outer;
    state->last_torque[1] += drive->inner;
}
