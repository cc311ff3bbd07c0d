/* SPDX-License-Identifier: Apache-2.0 */
/* Constants of a suspended ball and the gradient of its drift's generator. */
#ifndef IMUKI_SUSPENDED_ROTOR_INTERNAL_H
#define IMUKI_SUSPENDED_ROTOR_INTERNAL_H

#include "imukit/suspended_rotor.h"
#include "physics/physics_internal.h"

/* Sources of randomness: fixed for ever. Three of each, one per case axis. */
enum {
    IMKI_SUSPENDED_ROTOR_TORQUE = 0, /* 0, 1, 2 */
    IMKI_SUSPENDED_ROTOR_READING = 3 /* 3, 4, 5 */
};

typedef struct imki_suspended_ball {
    double per_h;         /* 1/H */
    double mass;          /* m */
    double moment;        /* m d */
    double second, third; /* a2, a3 */
    double pull[3];       /* T0 (1 + error) [N] */
    double per_pull;      /* 1/(4 T0) */
    double limit;
} imki_suspended_ball;

imki_suspended_ball imki_suspended_ball_of(const imk_suspended_rotor *design);

/* grad G (suspended_rotor.h), the first, second and third harmonic weakened by a wobble by `first`,
 * `second` and `third`. */
void imki_suspended_gradient(const imki_suspended_ball *ball, const double weak[3],
                             const double axis[3], const double force[3], double gradient[3]);

/* The spin axis a design starts with. */
void imki_suspended_start(const imk_suspended_rotor *design, double axis[3]);

/* The error model of a valid design, into a triad that imki_reduction_begin() gave. */
void imki_suspended_rotor_reduce(const imk_suspended_rotor *design, imk_triad *gyro);

/* The table of its derived quantities. */
extern const imk_derived imki_suspended_rotor_derived[];

#endif
