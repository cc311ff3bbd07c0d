/* SPDX-License-Identifier: Apache-2.0 */
/* What the parts of the fibre-optic gyro share: the operating point, the state, and the instrument
 * interface's functions. */
#ifndef IMUKI_FIBRE_OPTIC_INTERNAL_H
#define IMUKI_FIBRE_OPTIC_INTERNAL_H

#include "imukit/fibre_optic.h"
#include "physics/physics_internal.h"

/* Instants of a period of the sine modulation at which the detector is read. A sum over them picks
 * the harmonic 1 of the power, and 15, 17, …: J15(3.1) is 3e-10. */
enum { IMKI_FIBRE_OPTIC_INSTANTS = 16 };

/* The detector at its operating point, departures included. */
typedef struct imki_fibre_optic_point {
    double half_power; /* P0/2 [W] */
    double depth;      /* b [rad] */
    double slope;      /* power that the demodulator sees per phase: P0/2 V sin b, or P0 V J1(b) */
    double centre;     /* power at the operating point of the square modulation [W] */
    double noise[3];   /* S(P) = noise[0] + noise[1] P + noise[2] P^2 one-sided [W^2/Hz] */
    double count;      /* step of the converter [W], 0: none */
} imki_fibre_optic_point;

imki_fibre_optic_point imki_fibre_optic_operate(const imk_fibre_optic *design);
/* Power on the detector at a phase between the two waves: the raised cosine [W]. */
double imki_fibre_optic_fringe(const void *design, double phase);
/* P0/2 V sin b or P0 V J1(b) of the nominal design: what the electronics divide by. */
double imki_fibre_optic_nominal_slope(const imk_fibre_optic *design);
/* Density of the demodulated power at phase 0, one-sided [W^2/Hz], without the converter. */
double imki_fibre_optic_demodulated_noise(const imk_fibre_optic *design,
                                          const imki_fibre_optic_point *point);

/* Phase per rate, actual/nominal: (1 + expansion dT)/(1 + departure of the wavelength). */
static inline double imki_fibre_optic_scale_ratio(const imk_fibre_optic *design,
                                                  double wavelength_run, double temperature)
{
    const double warmer = temperature - IMKI_DESIGN_TEMPERATURE;
    return (1.0 + design->coil_expansion * warmer) /
           (1.0 + design->wavelength_error + wavelength_run +
            design->wavelength_temperature * warmer);
}

/* Angle of one count of the output [rad]; 0: not rounded. */
double imki_fibre_optic_count_angle(const imk_fibre_optic *design);

/* Of a design that has been validated. */
imk_status imki_fibre_optic_init(const void *design, const imk_physics_settings *settings,
                                 void *state, imk_error *error);
void imki_fibre_optic_step(void *state, const imk_exposure *exposure, double *outputs);
void imki_fibre_optic_observe(const void *state, double *signals);
double imki_fibre_optic_step_length(const void *design, const imk_physics_settings *settings);

/* Signals, in the order of the table in fibre_optic.c. */
enum {
    IMKI_FIBRE_OPTIC_INPUT = 0,
    IMKI_FIBRE_OPTIC_FEEDBACK,
    IMKI_FIBRE_OPTIC_ERROR,
    IMKI_FIBRE_OPTIC_DIFFERENCE,
    IMKI_FIBRE_OPTIC_POWER,
    IMKI_FIBRE_OPTIC_RAMP,
    IMKI_FIBRE_OPTIC_NONRECIPROCAL,
    IMKI_FIBRE_OPTIC_SCALE,
    IMKI_FIBRE_OPTIC_SIGNALS
};

/* The loop, transit by transit. */
typedef struct imki_fibre_optic_loop {
    double step, ramp, applied; /* [rad]; applied: the ramp as its converter gave it last */
    double first;               /* power of the first transit of the pair, from the centre [W] */
    double error, difference, power;
    double resets; /* of this sample, up less down */
    bool second;   /* the next transit is the second of its pair */
} imki_fibre_optic_loop;

typedef struct imki_fibre_optic_state {
    imk_fibre_optic design;
    imki_fibre_optic_loop loop;
    bool open, slow, rounds;
    double sample, transit;          /* [s] */
    double remaining;                /* of the current transit [s] */
    double half_power, cosine, sine; /* P0/2 [W]; V cos b, V sin b */
    double centre, noise[3];         /* [W]; variance of a reading */
    double converter_limit, count, per_count;
    double gain; /* of the step per watt, or of the reading [rad/W] */
    double wrap, ramp_gain, ramp_count, per_ramp_count, step_limit;
    double scale, reading; /* K; rate per phase of the reading, 1/K */
    double wavelength_run;
    double angle_count, residual; /* of the output [rad] */
    double nonreciprocal, scale_error, input;
    double slow_rate, phi[2][2], gamma[2], root[2][2]; /* the linear loop over a sample */
    double harmonic_gain, white;                       /* of the open loop at the slow level */
    double instant_cosine[IMKI_FIBRE_OPTIC_INSTANTS];  /* cos t, V cos(b cos t), V sin(b cos t) */
    double instant_even[IMKI_FIBRE_OPTIC_INSTANTS], instant_odd[IMKI_FIBRE_OPTIC_INSTANTS];
    imki_wander phase;
    imki_draws draws;
} imki_fibre_optic_state;

/* The error model of a valid design, into a triad that imki_reduction_begin() gave. */
void imki_fibre_optic_reduce(const imk_fibre_optic *design, imk_triad *triad);

/* The table of its derived quantities. */
extern const imk_derived imki_fibre_optic_derived[];

#endif
