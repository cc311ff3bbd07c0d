/* SPDX-License-Identifier: Apache-2.0 */
/* The spring-restrained rate gyro: what its files share. */
#ifndef IMUKI_RATE_GYRO_INTERNAL_H
#define IMUKI_RATE_GYRO_INTERNAL_H

#include "imukit/rate_gyro.h"
#include "physics/spinning_mass/spinning_mass_internal.h"

enum { IMKI_RATE_GYRO_SIGNALS = 4 };

/* Angle, rate, and the integral of the angle since the sample began. */
enum { IMKI_RATE_GYRO_STATES = 3 };

typedef struct imki_rate_gyro_state {
    imk_level level;
    size_t count; /* steps per sample */
    double step, rate;
    imki_gimbal gimbal;
    double stiffness, stiffness_temperature, friction, stop;
    double fixed_torque, torque_temperature, torque_sigma;
    double reading;      /* k/H as designed: reading per angle [1/s] */
    double noise;        /* of the pickoff, 1 sigma of a sample [rad] */
    double resolution;   /* [rad] */
    double error_torque; /* of this sample [N m] */
    double phi[IMKI_RATE_GYRO_STATES * IMKI_RATE_GYRO_STATES];
    double gamma[IMKI_RATE_GYRO_STATES];
    double root[IMKI_RATE_GYRO_STATES * IMKI_RATE_GYRO_STATES];
    double x[IMKI_RATE_GYRO_STATES];
    imki_wander wander;
    imki_draws torque_draws, pickoff_draws;
} imki_rate_gyro_state;

imki_gimbal imki_rate_gyro_gimbal(const imk_rate_gyro *design);
double imki_rate_gyro_stiffness(const imk_rate_gyro *design); /* the true one */
/* Of a design that has been validated. */
imk_status imki_rate_gyro_init(const void *design, const imk_physics_settings *settings,
                               void *state, imk_error *error);
void imki_rate_gyro_step(void *state, const imk_exposure *exposure, double *outputs);
void imki_rate_gyro_observe(const void *state, double *signals);
double imki_rate_gyro_step_length(const void *design, const imk_physics_settings *settings);

/* The error model of a valid design, into a triad that imki_reduction_begin() gave. */
void imki_rate_gyro_reduce(const imk_rate_gyro *design, imk_triad *triad);

/* The table of its derived quantities. */
extern const imk_derived imki_rate_gyro_derived[];

#endif
