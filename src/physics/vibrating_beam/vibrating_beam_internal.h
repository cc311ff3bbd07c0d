/* SPDX-License-Identifier: Apache-2.0 */
/* The two beams of a vibrating beam accelerometer in motion. */
#ifndef IMUKI_VIBRATING_BEAM_INTERNAL_H
#define IMUKI_VIBRATING_BEAM_INTERNAL_H

#include "imukit/vibrating_beam.h"
#include "physics/physics_internal.h"

/* First root of cos(x) cosh(x) = 1. */
#define IMKI_BEAM_ROOT 4.730040744862704
/* Loads n = N L^2/(E I): at -4 pi^2 a clamped beam buckles; up to 19/20 of that, pushed and pulled,
 * a beam is simulated, and beyond it keeps the frequency that it has there. */
#define IMKI_BEAM_BUCKLING (4.0 * IMKI_PI * IMKI_PI)
#define IMKI_BEAM_LOAD_MAX (0.95 * IMKI_BEAM_BUCKLING)

/* Square of the frequency over that without a load, and its derivatives with respect to n; from
 * buckling on all are 0. Relative error below 1e-12 up to 0.99 of the load that buckles it. */
typedef struct imki_beam_load {
    double square, first, second, third;
} imki_beam_load;
imki_beam_load imki_beam_load_at(double n);

/* The same square by a polynomial, for the dynamics: within 2e-15 up to IMKI_BEAM_LOAD_MAX. Four
 * interleaved sums, because they do not wait for each other. */
enum { IMKI_LOAD_TERMS = 20 };
void imki_load_series_make(double *coefficient);
static inline double imki_load_series_at(const double *coefficient, double n)
{
    const double x = imki_clamped(n, IMKI_BEAM_LOAD_MAX) * (1.0 / IMKI_BEAM_LOAD_MAX);
    const double x2 = x * x, x4 = x2 * x2;
    double sum[4] = {0.0, 0.0, 0.0, 0.0};
    for (int j = IMKI_LOAD_TERMS - 4; j >= 0; j -= 4)
        for (int k = 0; k < 4; k++)
            sum[k] = sum[k] * x4 + coefficient[j + k];
    return (sum[0] + sum[1] * x) + (sum[2] + sum[3] * x) * x2;
}

/* One beam. Its phase is that of x = amplitude sin(phase); a cycle is counted when it passes a
 * multiple of 2 pi upwards. */
typedef struct imki_beam {
    double x, y;    /* displacement, velocity / w [m]; the slow level keeps the amplitude in y */
    double phase;   /* slow level: of the cycle under way [cycles], 0 … 1 */
    int64_t cycles; /* since the last reading */
    double turn_cos, turn_sin;     /* of one step at the frequency under this force */
    double square, load_per_force; /* at this temperature: f^2 without a load [Hz^2], load [1/N] of
                                      the force on the first beam */
    double frequency;              /* [Hz] */
    double w;                      /* of the steps before [rad/s] */
    double crossing;               /* age of the last crossing read, by the clock [s] */
    double kick;  /* 1 sigma of x and y in a step [m]; slow: of the phase [cycles] */
    bool started; /* a crossing has been timed */
    imki_draws noise, edges;
} imki_beam;

typedef struct imki_beams {
    imk_vibrating_beam d;
    bool slow;
    size_t forces;                  /* parts of a sample for which the force is held */
    size_t steps;                   /* of the oscillation in each */
    double hold, h;                 /* their lengths [s] */
    double square;                  /* of the first beam's frequency without a load [Hz^2] */
    double load_per_force;          /* of the first beam at T_0 [1/N] */
    double series[IMKI_LOAD_TERMS]; /* square of the frequency by load */
    double pull;                    /* 1 - e^{-h/tau}: how fast the drive restores the amplitude */
    double mass[2];                 /* what the beams feel [m/s^2], and its rate */
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
/* Load n = N L^2/(E I) of the first beam at T_0 per force [1/N]; stiffness E of a beam over that of
 * the first at T_0, with a floor at 1 % of its own; how it grows [1/K]. */
double imki_beam_load_per_force(const imk_vibrating_beam *design);
double imki_beam_stiffness(const imk_vibrating_beam *design, int beam, double warm);
double imki_beam_temperature(const imk_vibrating_beam *design, int beam);

/* Modal mass [kg]; two-sided densities of the angular frequency [rad^2/s^2/Hz] of one beam and of
 * the acceleration of the suspension's Brownian force [(m/s^2)^2/Hz]; 1 sigma of the time of a
 * crossing at a frequency, by the noise of the pickoff [s]. */
double imki_beam_mass(const imk_vibrating_beam *design);
double imki_beam_phase_density(const imk_vibrating_beam *design, int beam);
double imki_suspension_density(const imk_vibrating_beam *design);
double imki_beam_edge(const imk_vibrating_beam *design, double frequency);

/* The reading of two frequencies, by the nominal design [m/s^2]. */
double imki_beams_reading(const imk_vibrating_beam *design, double f1, double f2);
/* How much warmer than T_0 a pair is by its two frequencies, whatever the force [K]; with
 * frequency_temperature, not 0, for both beams. */
double imki_beams_warmth(const imk_vibrating_beam *design, const double *series, double f1,
                         double f2);

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
