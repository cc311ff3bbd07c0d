/* SPDX-License-Identifier: Apache-2.0 */
/* The captured pendulum of a servo accelerometer in motion. */
#ifndef IMUKI_PENDULOUS_SERVO_INTERNAL_H
#define IMUKI_PENDULOUS_SERVO_INTERNAL_H

#include "imukit/pendulous_servo.h"
#include "physics/physics_internal.h"

/* States of the linear loop: angle, its rate, integral of the pickoff, control torque's integral.
 */
enum { IMKI_SERVO_STATES = 4 };
enum { IMKI_SERVO_ANGLE, IMKI_SERVO_RATE, IMKI_SERVO_INTEGRAL, IMKI_SERVO_CONTROL };

typedef struct imki_servo {
    imk_pendulous_servo d;
    bool slow;
    size_t steps;
    double h;
    double x[IMKI_SERVO_STATES];
    double phi[IMKI_SERVO_STATES * IMKI_SERVO_STATES], gamma[IMKI_SERVO_STATES],
        root[IMKI_SERVO_STATES * IMKI_SERVO_STATES];
    double readout_deviation; /* of a sample's mean current [A] */
    double constant_torquer;  /* relative, of this run */
    double torque, current;   /* of the last step [N m], [A] */
    imki_draws loop, readout;
    imki_wander hinge;
} imki_servo;

/* K_p + K_h [N m/rad]. */
static inline double imki_servo_stiffness(const imk_pendulous_servo *design)
{
    return design->proportional + design->hinge_stiffness;
}

double imki_servo_step_length(const void *design, const imk_physics_settings *settings);
/* Of a design that has been validated. */
imk_status imki_servo_init(const void *design, const imk_physics_settings *settings, void *state,
                           imk_error *error);
void imki_servo_step(void *state, const imk_exposure *exposure, double *outputs);
void imki_servo_observe(const void *state, double *signals);

/* The error model of a valid design, into a triad that imki_reduction_begin() gave. */
void imki_pendulous_servo_reduce(const imk_pendulous_servo *design, imk_triad *triad);

/* The table of its derived quantities. */
extern const imk_derived imki_pendulous_servo_derived[];

#endif
