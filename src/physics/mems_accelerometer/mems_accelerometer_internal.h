/* SPDX-License-Identifier: Apache-2.0 */
/* What the parts of the MEMS accelerometer share: forces, the point about which it works, its
 * linear system. */
#ifndef IMUKI_MEMS_ACCELEROMETER_INTERNAL_H
#define IMUKI_MEMS_ACCELEROMETER_INTERNAL_H

#include "imukit/mems_accelerometer.h"
#include "physics/physics_internal.h"

#include <stdalign.h>

/* Steps to a cycle of the fastest of springs and loop: default, and fewest. */
#define IMKI_MEMS_STEPS 25.0
#define IMKI_MEMS_STEPS_MIN 16.0

/* Value, slope, half the second and a sixth of the third derivative. */
typedef struct imki_series {
    double value, first, second, third;
} imki_series;

/* Springs, -w0^2 (...) without its sign [m/s^2], at X. */
imki_series imki_mems_spring(const imk_mems_accelerometer *design, double x);
/* Attraction by plates at the squared voltages plus and minus [m/s^2], at z. */
imki_series imki_mems_attraction(const imk_mems_accelerometer *design, double plus, double minus,
                                 double z);
/* What the amplifier reads, in units of displacement: slope 1 at z = 0. */
imki_series imki_mems_pickoff_series(const imk_mems_accelerometer *design, double z);

/* Where the mass is without input, and the series about it: with x the displacement from there,
 *   x'' = -(a1 x + a2 x^2 + a3 x^3) - damping x' + ... */
typedef struct imki_mems_point {
    bool exists;
    double spring, z;  /* X and z there */
    double control;    /* analog: control voltage there [V] */
    double a1, a2, a3; /* [1/s^2], [1/(m s^2)], [1/(m^2 s^2)] */
    double damping;    /* [1/s] */
    imki_series pickoff;
    double b1, b2; /* analog: dE/du and half d2E/du2 [m/s^2/V, m/s^2/V^2] */
    double unit;   /* sigma-delta: half the difference of the two forces [m/s^2] */
    double rest;   /* sigma-delta: mean of the two forces and the spring's [m/s^2] */
} imki_mems_point;
imki_mems_point imki_mems_operating_point(const imk_mems_accelerometer *design);

/* Relative change of the reading and of the bias that follow from the design. */
typedef struct imki_mems_static {
    double k2, k3;            /* [1/(m/s^2)], [1/(m/s^2)^2] */
    double scale;             /* of the finite gain of a loop without integral part */
    double bias;              /* that it leaves of the force at rest [m/s^2] */
    double scale_temperature; /* [1/K] */
    double bias_temperature;  /* [m/s^2/K] */
} imki_mems_static;
imki_mems_static imki_mems_static_errors(const imk_mems_accelerometer *design,
                                         const imki_mems_point *point);

/* The linear system
 *   position, velocity, output filter (value, rate), integral of the output
 *   [analog: amplifier, second stage, integral part]
 * with the inputs force [m/s^2] and signal (the input of the output filter) [m/s^2]. */
enum {
    IMKI_POSITION,
    IMKI_VELOCITY,
    IMKI_FILTER,
    IMKI_FILTER_RATE,
    IMKI_INTEGRAL,
    IMKI_AMPLIFIER,
    IMKI_COMPENSATOR,
    IMKI_RESET,
    IMKI_MEMS_STATES
};
enum { IMKI_FORCE, IMKI_SIGNAL, IMKI_MEMS_INPUTS };
typedef struct imki_mems_system {
    int n;
    double a[IMKI_MEMS_STATES * IMKI_MEMS_STATES];
    double b[IMKI_MEMS_STATES * IMKI_MEMS_INPUTS];
    double w[IMKI_MEMS_STATES * IMKI_MEMS_STATES];
    double control[IMKI_MEMS_STATES]; /* analog: the acceleration asked for, as a row */
} imki_mems_system;
/* `slow`: for steps of a whole sample (sigma-delta: white noise at the signal). */
void imki_mems_linear_system(const imk_mems_accelerometer *design, const imki_mems_point *point,
                             bool slow, imki_mems_system *system);

/* Stiffness left by the carrier (and by the feedback of a sigma-delta loop), mass in the middle
 * [1/s^2]. */
double imki_mems_stiffness(const imk_mems_accelerometer *design);
/* Two-sided white noise of the reading [m/s^2/sqrt(Hz)]. */
double imki_mems_white(const imk_mems_accelerometer *design, const imki_mems_point *point);
/* True when Routh's criterion holds for the analog loop with this stiffness of the mass. */
bool imki_mems_loop_stable(const imk_mems_accelerometer *design, double stiffness);
/* True when the noise leaves the limit cycle of a sigma-delta loop alone: four standard deviations
 * of the compensated noise are within its margin. */
bool imki_mems_locked(const imk_mems_accelerometer *design);
/* Fastest of springs, loop and derivative gain [Hz]: what limits the step. */
double imki_mems_fastest(const imk_mems_accelerometer *design);

/* The instrument in time. phi, root and gamma by columns. */
typedef struct imki_mems_state {
    alignas(64) double s[IMKI_MEMS_STATES];
    double phi[IMKI_MEMS_STATES][IMKI_MEMS_STATES], root[IMKI_MEMS_STATES][IMKI_MEMS_STATES];
    double gamma[IMKI_MEMS_INPUTS][IMKI_MEMS_STATES];
    double control[IMKI_MEMS_STATES];
    int n, noise_columns;
    imk_mems_accelerometer design;
    imki_mems_point point;
    imki_mems_static errors;
    bool slow, pickoff_bends, film_noise;
    size_t clocks, substeps; /* per sample, per clock; without a clock one per sample */
    double h, sample, limit, pickoff_deviation;
    int output_into; /* state that the signal goes into, */
    double output_gain, pull_constant, spring_constant, damping_constant; /* and how much */
    /* what changes */
    double temperature; /* above the design's [K] */
    double voltage, highest_voltage, time;
    double bit, compensated, before, sum;
    double control_voltage, feedback;
    double signal_time; /* of the sample so far [s] */
    imk_exposure exposure;
    imki_draws linear, pickoff, film;
    imki_wander bias, gain;
} imki_mems_state;

/* Of a design that has been validated. */
imk_status imki_mems_init(const void *design, const imk_physics_settings *settings, void *state,
                          imk_error *error);
void imki_mems_step(void *state, const imk_exposure *exposure, double *outputs);
void imki_mems_observe(const void *state, double *signals);
double imki_mems_step_length(const void *design, const imk_physics_settings *settings);

/* The error model of a valid design, into a triad that imki_reduction_begin() gave. */
void imki_mems_accelerometer_reduce(const imk_mems_accelerometer *design, imk_triad *triad);

/* The table of its derived quantities. */
extern const imk_derived imki_mems_accelerometer_derived[];

#endif
