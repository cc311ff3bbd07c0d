/* SPDX-License-Identifier: Apache-2.0 */
/* State of a free gyro. Equations: free_gyro_dynamics.c. */
#ifndef IMUKI_FREE_GYRO_INTERNAL_H
#define IMUKI_FREE_GYRO_INTERNAL_H

#include "imukit/free_gyro.h"
#include "physics/physics_internal.h"

/* Sources of randomness: fixed for ever. */
enum {
    IMKI_FREE_GYRO_TORQUE_OUTER = 0,
    IMKI_FREE_GYRO_TORQUE_INNER = 1,
    IMKI_FREE_GYRO_PICKOFF_OUTER = 2,
    IMKI_FREE_GYRO_PICKOFF_INNER = 3,
    IMKI_FREE_GYRO_ERROR_OUTER = 4,
    IMKI_FREE_GYRO_ERROR_INNER = 5
};

/* Angles, their canonical momenta, and the sines and cosines that go with the angles. */
typedef struct imki_gimbals {
    double outer, inner;     /* [rad] */
    double p_outer, p_inner; /* [N m s] */
    double so, co, si, ci;
} imki_gimbals;

/* Constants of a design. */
typedef struct imki_free_gyro_parts {
    double h, per_b;        /* H, 1/B */
    double b, j_least, a_c; /* B, Ao + C, A - C */
    double bo, co_c;        /* Bo, Co + C */
    double moment[3];       /* m d [kg m] */
    double elastic[3];      /* m^2 (Cy - Cz, Cz - Cx, Cx - Cy) [kg^2 m/N] */
    double viscous, coulomb, rate_square, slope;
    double stop;
} imki_free_gyro_parts;

/* What acts during a sample: case rate at its middle and its growth, force, error torques. */
typedef struct imki_free_gyro_drive {
    double rate[3], acceleration[3], force[3];
    double outer, inner; /* [N m] */
} imki_free_gyro_drive;

typedef struct imki_free_gyro_state {
    imki_gimbals gimbals;
    imki_free_gyro_parts parts;
    double sample, step;
    size_t steps;
    imk_level level;
    bool caged, on_stop;
    double start_nutation;
    double torque[2], torque_temperature; /* outer, inner */
    double torque_sigma;                  /* of the white torque over a step */
    double scale, resolution, reading_noise;
    double reading[2];     /* outer, inner: last */
    double last_torque[2]; /* shown: outer, inner */
    imki_wander error[2];
    imki_draws white[2], pickoff[2];
} imki_free_gyro_state;

imki_free_gyro_parts imki_free_gyro_parts_of(const imk_free_gyro *design);
/* Torques of unbalance and compliance about the outer and inner axes. */
void imki_free_gyro_force_torque(const imki_free_gyro_parts *parts, const imki_gimbals *gimbals,
                                 const double force[3], double *outer, double *inner);
/* Friction torque at a relative rate. */
double imki_free_gyro_friction(const imki_free_gyro_parts *parts, double rate);
void imki_free_gyro_trigonometry(imki_gimbals *gimbals);
/* Momenta of a motion without nutation, but for start_nutation. */
void imki_free_gyro_uncage(imki_free_gyro_state *state, const imki_free_gyro_drive *drive);
/* A sample of either level. */
void imki_free_gyro_full(imki_free_gyro_state *state, const imki_free_gyro_drive *drive);
void imki_free_gyro_slow(imki_free_gyro_state *state, const imki_free_gyro_drive *drive);

/* The error model of a valid design, into a triad that imki_reduction_begin() gave. */
void imki_free_gyro_reduce(const imk_free_gyro *design, imk_triad *gyro);

/* The table of its derived quantities. */
extern const imk_derived imki_free_gyro_derived[];

#endif
