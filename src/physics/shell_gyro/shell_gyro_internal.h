/* SPDX-License-Identifier: Apache-2.0 */
/* State of a shell gyro, and what its parts share. Forces are counted as the rates they cause: a
 * force 2 m w a r changes an amplitude a at the relative rate r, or turns the pattern at r. */
#ifndef IMUKI_SHELL_GYRO_INTERNAL_H
#define IMUKI_SHELL_GYRO_INTERNAL_H

#include "imukit/shell_gyro.h"
#include "physics/physics_internal.h"

enum { IMKI_SHELL_COOKIE = 0x53484C31, IMKI_SHELL_POINTS = 16 };

/* Sources of randomness; fixed for ever. */
enum {
    IMKI_SHELL_THERMAL = 0,
    IMKI_SHELL_PICKOFF = 1,
    IMKI_SHELL_DAMPING_COSINE = 2,
    IMKI_SHELL_DAMPING_SINE = 3
};

typedef struct imki_shell_pair {
    double x, y;
} imki_shell_pair;

/* The resonator at one temperature. */
typedef struct imki_shell_resonator {
    double omega;                            /* w [rad/s] */
    double decay;                            /* 1/tau [1/s] */
    double damping_cosine, damping_sine;     /* D cos, sin 2 theta_d [1/s] */
    double stiffness_cosine, stiffness_sine; /* dw cos, sin 2 theta_w [rad/s] */
    double forcer_gain;                      /* actual force/commanded */
} imki_shell_resonator;

imki_shell_resonator imki_shell_resonator_at(const imk_shell_gyro *design, double temperature);

/* Symmetric matrix of a pair of transducers: gain, mismatch, misalignment. */
typedef struct imki_shell_axes {
    double xx, xy, yy;
} imki_shell_axes;

imki_shell_axes imki_shell_pickoff(const imk_shell_gyro *design);
imki_shell_axes imki_shell_forcer(const imk_shell_gyro *design, double gain);
static inline imki_shell_pair imki_shell_apply(imki_shell_axes m, imki_shell_pair v)
{
    return (imki_shell_pair){m.xx * v.x + m.xy * v.y, m.xy * v.x + m.yy * v.y};
}

/* Steady state of the loops with the pattern measured at `angle`. Commanded rates; `precession` is
 * the rate of the actual angle (0 when the pattern is held), `actual` that angle. */
typedef struct imki_shell_balance {
    double drive, rebalance, quadrature; /* [1/s] */
    double frequency;                    /* of the vibration [rad/s] */
    double amplitude, actual;            /* the pattern as it is: [m], [rad] */
    double precession;                   /* [rad/s] */
} imki_shell_balance;

imki_shell_balance imki_shell_balance_at(const imk_shell_gyro *design, double temperature,
                                         double rate, double angle);

/* Loop gain K T, per update T, that puts the dominant pole at a bandwidth. */
double imki_shell_loop_gain(double bandwidth, double update);
/* -3 dB of the rebalance loop [Hz]. */
double imki_shell_loop_bandwidth(const imk_shell_gyro *design);
/* Time between updates of the loops [s]; k as the electronics assume it. */
double imki_shell_update(const imk_shell_gyro *design);
double imki_shell_assumed_gain(const imk_shell_gyro *design);
/* Largest rate a loop can command [1/s]; infinite without a limit. */
double imki_shell_command_limit(const imk_shell_gyro *design);
/* Standard deviation of a measured modal angle [rad]. */
double imki_shell_angle_noise(const imk_shell_gyro *design);
/* Input rate of the instrument. */
static inline double imki_shell_input(const imk_shell_gyro *design, const double vector[3])
{
    return vector[0] + design->package.misalignment_y * vector[1] +
           design->package.misalignment_z * vector[2];
}

/* ---- full dynamics --------------------------------------------------------------------------- */

/* States x, x'/w0, y, y'/w0 [m]; forces as f/(m w0^2) [m]. */
typedef struct imki_shell_cycle {
    double step;                            /* [s] */
    double phi[16], force[8];               /* of a step: 4 x 4; 4 x 2 */
    double root[16];                        /* of the thermal noise of a block */
    double noise_scale;                     /* of it, at this temperature */
    double rate, acceleration, temperature; /* that phi is for */
    size_t block, middle;                   /* steps from update to update, and to the noise */
    size_t position;                        /* in the block */
    bool fresh;                             /* no step taken yet */
    double z[4];
    double pickoff_noise;              /* of an amplitude fitted to a block [m] */
    double cosine, sine;               /* of the reference, at the present instant */
    double turn_cosine, turn_sine;     /* of a step of it */
    double per_cosine[4], per_sine[4]; /* force on the states, per cosine and sine */
    double sum[6];                     /* x cos, x sin, y cos, y sin, cos cos, cos sin */
} imki_shell_cycle;

typedef struct imki_shell_loops {
    double reference;                               /* of the phase loop [rad/s] */
    double drive, rebalance, quadrature, frequency; /* integrals: rates */
    double gain_support, gain_rebalance, gain_phase, gain_phase_integral;
    imki_shell_pair along; /* direction the electronics take the pattern to have */
    double angle;          /* measured, unwrapped [rad] */
    double turned, ahead;  /* in the last update; until the middle of the next block [rad] */
    double pointing;       /* of `along` [rad] */
    double command[3];     /* drive, rebalance, quadrature: in force [1/s] */
    double phase_error;    /* measured [rad] */
    double estimate;       /* of the rate, held [rad/s] */
} imki_shell_loops;

/* ---- slow ------------------------------------------------------------------------------------ */

/* Rebalance: r' = w_b (target - r) and the pickoff's noise behind the same filter. Whole angle:
 * theta' = -k W + drift, harmonics 0, 2 and 4 of theta. */
typedef struct imki_shell_slow {
    size_t count;                            /* substeps in a sample, at least */
    double temperature;                      /* that the rest is for [K] */
    double bias, gain;                       /* of the target [rad/s], [1] */
    double double_cosine, double_sine;       /* of twice the actual angle */
    double drift[5];                         /* 1, cos 2, sin 2, cos 4, sin 4 theta [rad/s] */
    double fade, fade_integral, decay;       /* e^(-w_b h), its integral over h [s], 1/tau [1/s] */
    double thermal_root[3], pickoff_root[3]; /* rebalance: of a step; see shell_gyro_slow.c */
    double thermal_angle, pointing_angle;    /* whole angle: random turns of a sample [rad] */
    double angle_noise;                      /* and error of a reading [rad] */
    double thermal;                          /* noise at this temperature, relative */
    double reading, noise;                   /* states [rad/s], [rad] */
    double angle, last;                      /* actual, and measured at the last sample [rad] */
} imki_shell_slow;

typedef struct imki_shell_state {
    imk_shell_gyro design;
    imk_level level;
    double sample, gain, assumed; /* [s]; k actual and assumed */
    size_t count;                 /* steps in a sample */
    imki_draws thermal, pickoff;
    imki_wander wander[2]; /* of D cos, D sin */
    double damping[2];     /* their present values [1/s] */
    imki_shell_axes pickoff_axes, forcer_axes;
    double limit, lag_cosine, lag_sine; /* of commands [1/s]; of the phase error */
    double decay, omega;                /* 1/tau [1/s], w0 [rad/s] of the design */
    imki_shell_cycle cycle;
    imki_shell_loops loops;
    imki_shell_slow slow;
} imki_shell_state;

void imki_shell_cycle_start(imki_shell_state *state);
void imki_shell_cycle_step(imki_shell_state *state, const imk_exposure *exposure, double *outputs);
/* The next `count` steps, forces and reference as they are. */
void imki_shell_advance(imki_shell_cycle *cycle, size_t count);
/* Matrices of a step for this rate, its derivative and temperature. */
void imki_shell_matrices(imki_shell_state *state, double rate, double acceleration,
                         double temperature);
/* End of a block: measured amplitudes in, forces out. */
void imki_shell_update_loops(imki_shell_state *state);

void imki_shell_slow_start(imki_shell_state *state);
void imki_shell_slow_step(imki_shell_state *state, const imk_exposure *exposure, double *outputs);

/* The ellipse that a state of motion is part of: long axis, short axis (sign: sense of rotation),
 * angle. [LYNCH1995]: E = a^2 + q^2, Q = 2 a q, R, S = (a^2 - q^2) cos, sin 2 theta. */
typedef struct imki_shell_ellipse {
    double amplitude, quadrature, angle;
} imki_shell_ellipse;
imki_shell_ellipse imki_shell_ellipse_of(imki_shell_pair cosine, imki_shell_pair sine);

imk_status imki_shell_init(const void *design_pointer, const imk_physics_settings *settings,
                           void *state_pointer, imk_error *error);
void imki_shell_step(void *state_pointer, const imk_exposure *exposure, double *values);
void imki_shell_observe(const void *state_pointer, double *values);
double imki_shell_step_length(const void *design, const imk_physics_settings *settings);

/* The error model of a valid design, into a triad that imki_reduction_begin() gave. */
void imki_shell_gyro_reduce(const imk_shell_gyro *design, imk_triad *triad);

/* The table of its derived quantities. */
extern const imk_derived imki_shell_gyro_derived[];

#endif
