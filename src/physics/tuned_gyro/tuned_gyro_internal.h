/* SPDX-License-Identifier: Apache-2.0 */
/* The dynamically tuned gyro: what its files share. */
#ifndef IMUKI_TUNED_GYRO_INTERNAL_H
#define IMUKI_TUNED_GYRO_INTERNAL_H

#include "imukit/tuned_gyro.h"
#include "physics/spinning_mass/spinning_mass_internal.h"

enum { IMKI_TUNED_GYRO_SIGNALS = 6 };

/* The rotor: tilt and its derivative about axis 1, then about axis 2. What acts on it turns
 * backwards in the shaft's axes: rate of the case, torque, angular acceleration. */
enum { IMKI_ROTOR_STATES = 4, IMKI_ROTOR_FORCES = 6 };

/* The rotor over a step. */
typedef struct imki_rotor_step {
    double phi[IMKI_ROTOR_STATES][IMKI_ROTOR_STATES];
    double gamma[IMKI_ROTOR_STATES][IMKI_ROTOR_FORCES];
} imki_rotor_step;

/* The loop, the same for both axes: a filter as discrete system and the gains behind it. */
typedef struct imki_capture_loop {
    double filter[2][2], input[2];
    double proportional, integral; /* [1/s], [1/s^2] */
    double step;
} imki_capture_loop;

typedef struct imki_tuned_gyro_state {
    imk_level level;
    bool captured;
    size_t count;
    double step, rate;
    double momentum, true_momentum; /* as designed, and as it is [N m s] */
    imki_rotor_step rotor;
    imki_capture_loop loop;
    double turn_cosine, turn_sine; /* of a step of the shaft */
    double cosine, sine;           /* of the shaft now */
    double x[IMKI_ROTOR_STATES];
    double filtered[2][2], integral[2]; /* of the tilts about x and y */
    double command[2];                  /* rates, as measured [rad/s] */
    double limit;                       /* of a command [rad/s] */
    double tilt[2], last_tilt[2];       /* about x and y [rad] */
    double offset[2], pickoff_range;
    double axial_moment, quadrature_moment, anisoelastic;
    double residual_spring, drag, speed; /* K and D [N m/rad] */
    double fixed_torque, torque_temperature, error_torque[2];
    double torque_noise, pickoff_noise; /* 1 sigma of a step */
    double torquer_error, torquer_temperature;
    imki_wander wander[2];
    imki_draws torque_draws[2], pickoff_draws[2];
} imki_tuned_gyro_state;

/* Ag + Bg - Cg of the gimbal [kg m^2]. */
static inline double imki_tuned_gyro_gimbal_sum(const imk_tuned_gyro *design)
{
    return design->gimbal_inertia_x + design->gimbal_inertia_y - design->gimbal_inertia_z;
}

void imki_rotor_start(imki_rotor_step *rotor, const imk_tuned_gyro *design, double step);
void imki_capture_loop_start(imki_capture_loop *loop, const imk_tuned_gyro *design, double step);
/* False when the loop, sampled at this step, drives the rotor. */
bool imki_capture_loop_stable(const imk_tuned_gyro *design, double step);
double imki_tuned_gyro_longest_step(const imk_tuned_gyro *design);

/* Of a design that has been validated. */
imk_status imki_tuned_gyro_init(const void *design, const imk_physics_settings *settings,
                                void *state, imk_error *error);
void imki_tuned_gyro_step(void *state, const imk_exposure *exposure, double *outputs);
void imki_tuned_gyro_observe(const void *state, double *signals);
double imki_tuned_gyro_step_length(const void *design, const imk_physics_settings *settings);

/* -3 dB of the loop, were it closed [Hz]. */
double imki_tuned_gyro_bandwidth(const imk_tuned_gyro *design);

/* The error model of a valid design, into a triad that imki_reduction_begin() gave. */
void imki_tuned_gyro_reduce(const imk_tuned_gyro *design, imk_triad *triad);

/* The table of its derived quantities. */
extern const imk_derived imki_tuned_gyro_derived[];

#endif
