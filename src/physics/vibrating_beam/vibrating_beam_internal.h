/* SPDX-License-Identifier: Apache-2.0 */
/* The two beams of a vibrating beam accelerometer in motion. */
#ifndef IMUKI_VIBRATING_BEAM_INTERNAL_H
#define IMUKI_VIBRATING_BEAM_INTERNAL_H

#include "imukit/vibrating_beam.h"
#include "physics/physics_internal.h"

/* One beam. Its phase is that of x = amplitude sin(phase); a cycle is counted when it passes a
 * multiple of 2 pi upwards. */
typedef struct imki_beam {
    double x, y;    /* displacement, velocity / w [m]; the slow level keeps the amplitude in y */
    double phase;   /* slow level: of the cycle under way [cycles], 0 … 1 */
    int64_t cycles; /* since the last reading */
    double turn_cos, turn_sin; /* of one step at the frequency under this force */
    double frequency;          /* [Hz] */
    double w;                  /* of the steps before [rad/s] */
    double crossing;           /* age of the last crossing read, by the clock [s] */
    bool started;              /* a crossing has been timed */
    imki_draws noise;
} imki_beam;

typedef struct imki_beams {
    imk_vibrating_beam d;
    bool slow;
    size_t forces;                     /* parts of a sample for which the force is held */
    size_t steps;                      /* of the oscillation in each */
    double hold, h;                    /* their lengths [s] */
    double frequency_0[2], stiffening; /* f_0i [Hz], kappa [Hz^2/N] */
    double kick;    /* 1 sigma of x and y in a step [m]; slow: of the phase [cycles] */
    double pull;    /* 1 - e^{-h/tau}: how fast the drive restores the amplitude */
    double mass[2]; /* what the beams feel [m/s^2], and its rate */
    double phi[4], gamma[2], root[4];
    double force;      /* on the first beam [N] */
    double clock_time; /* now, in ticks of the clock since its last one, 0 … 1 */
    double reading[2]; /* frequencies last read [Hz] */
    imki_beam beam[2];
    imki_draws suspension;
    imki_wander mount;
} imki_beams;

/* E I of one beam [N m^2]. */
double imki_beam_bending_stiffness(const imk_vibrating_beam *design);
/* Modal mass [kg]; two-sided densities of the angular frequency [rad^2/s^2/Hz] of one beam and of
 * the acceleration of the suspension's Brownian force [(m/s^2)^2/Hz]. */
double imki_beam_mass(const imk_vibrating_beam *design);
double imki_beam_phase_density(const imk_vibrating_beam *design);
double imki_suspension_density(const imk_vibrating_beam *design);

/* The reading of two frequencies, by the nominal design [m/s^2]. */
double imki_beams_reading(const imk_vibrating_beam *design, double f1, double f2);

double imki_beams_step_length(const void *design, const imk_physics_settings *settings);
/* Of a design that has been validated. */
imk_status imki_beams_start(const void *design, const imk_physics_settings *settings, void *state,
                            imk_error *error);
const imk_vibrating_beam *imki_beams_design(const void *state);
/* A sample: the frequencies that the counters read [Hz]. */
void imki_beams_advance(void *state, const imk_exposure *exposure, double frequency[2]);
void imki_beams_observe(const void *state, double *signals);

/* The error model of a valid design, into a triad that imki_reduction_begin() gave. */
void imki_vibrating_beam_reduce(const imk_vibrating_beam *design, imk_triad *triad);

/* The table of its derived quantities. */
extern const imk_derived imki_vibrating_beam_derived[];

#endif
