/* SPDX-License-Identifier: Apache-2.0 */
/* The electrostatically suspended gyro: what follows from its parts. */
#include "imukit/spinning_mass.h"
#include "physics/derived_rows_internal.h"
#include "suspended_rotor_internal.h"

#define DESIGN imk_suspended_rotor

/* Drift rate without force, the spin axis half way between two case axes. */
static double preload_drift(const DESIGN *d)
{
    const double half = sqrt(0.5), axis[3] = {half, 0.0, half}, force[3] = {0.0, 0.0, 0.0};
    double drift[3];
    imk_suspended_rotor_drift(d, axis, force, drift);
    return sqrt(drift[0] * drift[0] + drift[1] * drift[1] + drift[2] * drift[2]);
}

VALUE(mass, imk_suspended_rotor_mass(d))
VALUE(polar_inertia, imk_suspended_rotor_momentum(d) / d->spin_rate)
VALUE(momentum, imk_suspended_rotor_momentum(d))
VALUE(rim_speed, 0.5 * d->diameter * d->spin_rate)
VALUE(wobble, imk_suspended_rotor_wobble(d))
VALUE(per_torque, imki_suspended_ball_of(d).per_h)
VALUE(unbalance, imk_unbalance_drift(mass(d), d->unbalance, momentum(d)))
VALUE(preload, 0.25 / imki_suspended_ball_of(d).per_pull)
VALUE(touch_down, mass(d) * d->limit)
VALUE(unequal, preload_drift(d))

const imk_derived imki_suspended_rotor_derived[] = {
    {"mass", "m", "kg", "gram", "m = pi/6 (D^3 - D_i^3) density", "[LANDAU1976]", mass, NULL},
    {"polar moment of inertia", "C", "kg*m^2", "kg*m^2",
     "C = 3 (1 + e)/(3 + e) 8 pi/15 density (R^5 - r^5)", "[LANDAU1976]", polar_inertia, NULL},
    {"angular momentum", "H", "kg*m^2/s", "kg*m^2/s", "H = C spin", "[LAWRENCE1998]", momentum,
     NULL},
    {"rim speed", "v", "m/s", "m/s", "v = R spin", "[LAWRENCE1998]", rim_speed, NULL},
    {"free nutation frequency", "f_n", "Hz", "Hz", "f_n = H/(2 pi A) = (1 + e) spin/(2 pi)",
     "[LANDAU1976]", wobble, NULL},
    {"drift per torque", "w/M", "rad/s/(N*m)", "deg/h/(pN*m)", "w/M = 1/H", "[LAWRENCE1998]",
     per_torque, NULL},
    {"mass unbalance drift, force across the spin axis", "D_g", "rad/s/(m/s^2)", "deg/h/g",
     "D_g = m d/H", "[LAWRENCE1998]", unbalance, NULL},
    {"preload of a pair of electrodes", "T_0", "N", "mN", "T_0 = m limit/2", "[LAWRENCE1998]",
     preload, NULL},
    {"touch-down force", "F_t", "N", "mN", "F_t = 2 T_0 = m limit", "[LAWRENCE1998]", touch_down,
     NULL},
    {"drift by unequal preloads, spin axis between x and z", "D_p", "rad/s", "deg/h",
     "D_p = 3/2 |a2| |T_x - T_z|/H", "[LAWRENCE1998]", unequal, NULL},
    DERIVED_END,
};
