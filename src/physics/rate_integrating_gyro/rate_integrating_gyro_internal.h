/* SPDX-License-Identifier: Apache-2.0 */
/* The floated rate-integrating gyro: what its files share. */
#ifndef IMUKI_RATE_INTEGRATING_GYRO_INTERNAL_H
#define IMUKI_RATE_INTEGRATING_GYRO_INTERNAL_H

#include "imukit/rate_integrating_gyro.h"
#include "physics/spinning_mass/spinning_mass_internal.h"

enum { IMKI_RATE_INTEGRATING_GYRO_SIGNALS = 5 };

/* Angle, rate, integral of the angle, and the integral of that. */
enum { IMKI_FLOAT_STATES = 4, IMKI_FLOAT_INPUTS = 2 /* torque, error of the pickoff */ };

/* The float over one step, with its loop closed or without it. */
typedef struct imki_float_step {
    double phi[IMKI_FLOAT_STATES * IMKI_FLOAT_STATES];
    double gamma[IMKI_FLOAT_STATES * IMKI_FLOAT_INPUTS];
    double root[IMKI_FLOAT_STATES * IMKI_FLOAT_STATES];
} imki_float_step;

typedef struct imki_rate_integrating_gyro_state {
    imk_level level;
    imk_rebalance rebalance;
    size_t count, steps_per_pulse;
    double step, rate;
    imki_gimbal gimbal;
    double momentum; /* as designed */
    double inertia, damping, stiffness, stop;
    double fixed_torque, torque_temperature, torque_sigma, error_torque;
    double pickoff_sigma, pickoff_resolution;
    double limit, torquer_error, torquer_temperature, torquer_gain;
    double proportional, integral; /* K1, K2 */
    double lead, threshold;        /* of the pulses: [s], [rad] */
    double pulse_angle;            /* [rad] of the case */
    imki_float_step closed, open;
    double x[IMKI_FLOAT_STATES];
    double torque;     /* that the torquer is commanded to give [N m] */
    double last_angle; /* read at the end of the last sample, open loop [rad] */
    double carried;    /* angle not yet counted, slow level [rad] */
    imki_wander wander;
    imki_draws torque_draws, pickoff_draws;
} imki_rate_integrating_gyro_state;

imki_gimbal imki_rate_integrating_gyro_gimbal(const imk_rate_integrating_gyro *design);
/* -3 dB of the float without a loop, or of the analog loop [Hz]; 0 of pulses. */
double imki_rate_integrating_gyro_bandwidth(const imk_rate_integrating_gyro *design);
/* Of a design that has been validated. */
imk_status imki_rate_integrating_gyro_init(const void *design, const imk_physics_settings *settings,
                                           void *state, imk_error *error);
void imki_rate_integrating_gyro_step(void *state, const imk_exposure *exposure, double *outputs);
void imki_rate_integrating_gyro_observe(const void *state, double *signals);
double imki_rate_integrating_gyro_step_length(const void *design,
                                              const imk_physics_settings *settings);

/* The error model of a valid design, into a triad that imki_reduction_begin() gave. */
void imki_rate_integrating_gyro_reduce(const imk_rate_integrating_gyro *design, imk_triad *triad);

/* The table of its derived quantities. */
extern const imk_derived imki_rate_integrating_gyro_derived[];

#endif
