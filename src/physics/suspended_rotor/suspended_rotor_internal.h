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

/* The ball in its cavity. */
typedef struct imki_suspended_cavity {
    double mass, limit, gap, clearance;
    double stiffness, damping; /* of the control, over the mass */
    double restitution, friction;
    double x[3], v[3]; /* of the centre, from the middle */
    bool away;         /* not at rest there */
    bool touched;
    /* of the first touch: when, the force along the axis, the speed, the axis */
    double time, force, speed;
    const char *axis;
} imki_suspended_cavity;

/* A push of a stop on the ball. */
typedef struct imki_suspended_push {
    double impulse;   /* [N s]; 0: none */
    double normal[3]; /* from the middle to the place of contact, of unit length */
} imki_suspended_push;

imki_suspended_cavity imki_suspended_cavity_of(const imk_suspended_rotor *design);

/* Does the ball stay at rest in the middle under this force? */
bool imki_suspended_held(const imki_suspended_cavity *cavity, const double force[3]);

/* Steps to a time, that follow the ball's fall and its control. */
size_t imki_suspended_steps(const imki_suspended_cavity *cavity, const double force[3],
                            double duration);

/* A step of the ball.
 * @param spin  direction of its spin; zeros: it does not slide on the stop
 * @param time  at the end of the step */
imki_suspended_push imki_suspended_move(imki_suspended_cavity *cavity, const double force[3],
                                        const double spin[3], double step, double time);

/* The same without what is fast: the ball is in the middle or lies on its stop. */
imki_suspended_push imki_suspended_rest(imki_suspended_cavity *cavity, const double force[3],
                                        double step, double time);

/* Internal signals. */
enum {
    IMKI_SUSPENDED_AXIS_X,
    IMKI_SUSPENDED_AXIS_Y,
    IMKI_SUSPENDED_AXIS_Z,
    IMKI_SUSPENDED_DRIFT,
    IMKI_SUSPENDED_WOBBLE,
    IMKI_SUSPENDED_FALLEN,
    IMKI_SUSPENDED_DISPLACEMENT_X,
    IMKI_SUSPENDED_DISPLACEMENT_Y,
    IMKI_SUSPENDED_DISPLACEMENT_Z,
    IMKI_SUSPENDED_CONTACT,
    IMKI_SUSPENDED_SPIN
};

typedef struct imki_suspended_state {
    double axis[3], across[3];         /* s, n */
    double momentum, initial_momentum; /* H now, and before the ball touched anything */
    double spin_rate, radius;
    double cone, decay; /* angle of the cone [rad], and its factor per step */
    double turns, turns_per_step;
    imki_suspended_ball ball;
    imki_suspended_cavity cavity;
    double contact; /* mean force of the stops in the last sample [N] */
    uint64_t samples;
    double sample, step;
    size_t steps;
    imk_level level;
    double torque[3], torque_temperature, torque_sigma;
    double resolution, reading_noise;
    double reading[3];
    double drift; /* magnitude of ds/dt by unbalance and shape, at the last step */
    imki_wander error[3];
    imki_draws white[3], readout[3];
} imki_suspended_state;

double imki_suspended_step_length(const void *design, const imk_physics_settings *settings);
/* Of a design that has been validated. */
imk_status imki_suspended_init(const void *given, const imk_physics_settings *settings,
                               void *memory, imk_error *error);
void imki_suspended_step(void *memory, const imk_exposure *exposure, double *out);
void imki_suspended_observe(const void *memory, double *values);
bool imki_suspended_happened(const void *memory, imk_instrument_event *event);

/* The error model of a valid design, into a triad that imki_reduction_begin() gave. */
void imki_suspended_rotor_reduce(const imk_suspended_rotor *design, imk_triad *gyro);

/* The table of its derived quantities. */
extern const imk_derived imki_suspended_rotor_derived[];

#endif
