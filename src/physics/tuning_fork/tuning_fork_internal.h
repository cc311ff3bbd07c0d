/* SPDX-License-Identifier: Apache-2.0 */
/* What the files of the tuning fork gyro share: phasors, the gyro at a temperature, the exact map
 * of one carrier cycle, the envelope, and the state. */
#ifndef IMUKI_TUNING_FORK_INTERNAL_H
#define IMUKI_TUNING_FORK_INTERNAL_H

#include "imukit/tuning_fork.h"
#include "physics/physics_internal.h"

/* Ends of the straight lines by temperature [K]. */
#define IMKI_FORK_COLDEST (-40.0 + 273.15)
#define IMKI_FORK_HOTTEST 398.15

/* Complex number; C's own would call the compiler's library for every product. */
typedef struct imki_phasor {
    double re, im;
} imki_phasor;

static inline imki_phasor imki_phasor_product(imki_phasor a, imki_phasor b)
{
    return (imki_phasor){a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}

static inline imki_phasor imki_phasor_inverse(imki_phasor a)
{
    const double square = a.re * a.re + a.im * a.im;
    return (imki_phasor){a.re / square, -a.im / square};
}

/* The gyro at one temperature. */
typedef struct imki_fork_point {
    double drive, sense;                 /* wd, ws [rad/s] */
    double drive_damping, sense_damping; /* wd/Qd, ws/Qs [1/s] */
    double amplitude;                    /* held [m] */
    double phase;                        /* error [rad] */
    double temperature;                  /* [K], as it is */
} imki_fork_point;

imki_fork_point imki_fork_at(const imk_tuning_fork *design, double temperature);

/* 2 k x0 wd, which the electronics assume [m/s^2 per rad/s]. */
double imki_fork_coriolis(const imk_tuning_fork *design);
/* H(wd) = 1/(ws^2 - wd^2 + i wd ws/Qs) [s^2]. */
imki_phasor imki_fork_compliance(const imki_fork_point *point);
/* Decay rate a of the envelope of a free motion along y, e^{-a t}, seen from the carrier [1/s]. */
imki_phasor imki_fork_decay(const imki_fork_point *point);
/* Response relative to the one assumed: of the force (x0 wd), and of y (H as well). */
double imki_fork_force_ratio(const imk_tuning_fork *design, const imki_fork_point *point);
imki_phasor imki_fork_motion_ratio(const imk_tuning_fork *design, const imki_fork_point *point);
/* The rate that the couplings look like, at this specific force along the sense axis [rad/s]. */
double imki_fork_in_phase(const imk_tuning_fork *design, const imki_fork_point *point,
                          double specific_force);
/* Turn of the drive force under a specific force [rad]. */
double imki_fork_force_angle(const imk_tuning_fork *design, double specific_force);
/* Natural angular frequency of the output filter [rad/s]; 0 without. */
double imki_fork_filter_frequency(const imk_tuning_fork *design);

/* ---- one carrier cycle, exactly -------------------------------------------------------------- */

/* A frame is about one cycle of the drive, of `steps` internal steps. Within it the forces are
 * samples of a sinusoid, held over each step, and the displacements are demodulated by least
 * squares. All that is linear, and collapses into one matrix:
 *
 *     [x x' y y' | X Y] at the end = [x x' y y'] at the start, forces, constant, 8 normals
 *
 * X and Y phasors of the frame in its own phase, zero at its centre. By columns, for the vector
 * units: one column is the effect of one input. */
enum {
    IMKI_FORK_ROWS = 8,
    IMKI_FORK_STATES = 4,
    IMKI_FORK_INPUTS = 9, /* states, re and im of both forces, constant acceleration along y */
    IMKI_FORK_COLUMNS = IMKI_FORK_INPUTS + IMKI_FORK_ROWS,
    IMKI_FORK_STEPS_MIN = 16,
    IMKI_FORK_STEPS_MAX = 128
};

typedef struct imki_fork_frame {
    double column[IMKI_FORK_COLUMNS][IMKI_FORK_ROWS];
    double phi[16], gamma[8]; /* of one step; gamma's columns: ux, uy */
    double angle;             /* of the carrier per step [rad] */
    double hold;              /* gain that makes the held sinusoid's first harmonic 1 */
    int steps;
} imki_fork_frame;

/* What the frame's matrix depends on besides the design. */
typedef struct imki_fork_condition {
    double rate, acceleration, temperature; /* about x [rad/s], [rad/s^2]; [K] */
} imki_fork_condition;

void imki_fork_frame_design(const imk_tuning_fork *design, const imki_fork_condition *condition,
                            double step, int steps, bool noise, imki_fork_frame *frame);
/* x, x', y, y' after `count` steps of a frame, without noise. force: re, im of ux and uy in the
 * frame's own phase, and the constant acceleration. */
void imki_fork_frame_inside(const imki_fork_frame *frame, const double state[4],
                            const double force[5], int count, double inside[4]);

/* Two rows at a time: what every vector unit has. Left to itself gcc 12 sums over columns in pairs
 * and transposes, at three times the cost. */
typedef double imki_row_pair __attribute__((vector_size(16), aligned(8), may_alias));

/* out = sum over `columns` of column input, in the order of the columns. */
static inline void imki_fork_apply(const double *column, int columns, const double *input,
                                   double *out)
{
    imki_row_pair sum[IMKI_FORK_ROWS / 2] = {{0.0}};
    for (int c = 0; c < columns; c++) {
        const imki_row_pair *row = (const imki_row_pair *)(column + IMKI_FORK_ROWS * c);
        for (int p = 0; p < IMKI_FORK_ROWS / 2; p++)
            sum[p] += row[p] * input[c];
    }
    for (int p = 0; p < IMKI_FORK_ROWS / 2; p++)
        ((imki_row_pair *)out)[p] = sum[p];
}

/* ---- the envelope, exactly over a sample ----------------------------------------------------- */

/* States of the slow level, all as rates [rad/s]: y as phasor (quadrature, rate), integral of the
 * closed loop's controller, output filter, and the integrals of both outputs over the sample. */
enum { IMKI_FORK_ENVELOPE_INPUTS = 2 };
typedef struct imki_fork_envelope {
    double column[2 * IMKI_FORK_ROWS + IMKI_FORK_ENVELOPE_INPUTS][IMKI_FORK_ROWS];
} imki_fork_envelope;

void imki_fork_envelope_design(const imk_tuning_fork *design, double temperature, double sample,
                               bool noise, imki_fork_envelope *envelope);

/* ---- state ----------------------------------------------------------------------------------- */

/* Sources of random numbers, fixed for ever. */
enum {
    IMKI_FORK_SOURCE_FRAME = 0,
    IMKI_FORK_SOURCE_ENVELOPE = 1,
    IMKI_FORK_SOURCE_PHASE = 2,
    IMKI_FORK_SOURCE_AMPLITUDE = 3
};

/* The electronics: constants of the loops, per frame. */
typedef struct imki_fork_electronics {
    double frame_time;             /* [s] */
    double amplitude, force_limit; /* [m], [m/s^2] */
    double agc_gain, agc_zero;     /* u += gain (e - zero e before) */
    double pll_gain, pll_integral; /* [rad/rad], [rad/s/rad] */
    imki_phasor to_rate;           /* 1/(-2 k x0 wd H): phasor of y -> quadrature + i rate */
    double coriolis;               /* 2 k x0 wd */
    imki_phasor loop_gain, loop_zero;
    bool closed;
    double range;
    int filter_order;
    double filter_phi[4], filter_gamma[2];
} imki_fork_electronics;

void imki_fork_electronics_design(const imk_tuning_fork *design, double frame_time,
                                  imki_fork_electronics *electronics);

typedef struct imki_fork_state {
    _Alignas(64) imki_fork_frame frame;
    imki_fork_envelope envelope;
    imki_draws draws;
    imki_wander phase, amplitude;
    imk_tuning_fork design;
    imki_fork_electronics electronics;
    imki_fork_point point;
    imki_fork_condition condition;
    bool full, noise, ready; /* ready: frame or envelope fit the condition */
    int leak_axis;
    size_t steps;                  /* per sample */
    double step, sample;           /* [s] */
    double motion[IMKI_FORK_ROWS]; /* full: x x' y y'; slow: the envelope's states */
    int position;                  /* steps done of the frame */
    double reference;              /* phase of the reference at the centre of the frame [rad] */
    double detuning;               /* its frequency less that of the frame [rad/s] */
    double drive_force, amplitude_error_before; /* [m/s^2], [m] */
    imki_phasor drive_motion, sense_motion;     /* of the last frame, in the reference's phase */
    imki_phasor rebalance, measured_before, measured;
    double phase_error;                     /* of the electronics, now */
    imki_phasor reference_turn, phase_turn; /* e^{i reference}, e^{i phase_error} */
    double force_angle;                     /* now */
    double constant;                        /* acceleration along y [m/s^2] */
    double filter[2];
} imki_fork_state;

/* The functions of imk_instrument that run the gyro. */
/* Of a design that has been validated. */
imk_status imki_fork_init(const void *place, const imk_physics_settings *settings, void *memory,
                          imk_error *error);
void imki_fork_step(void *place, const imk_exposure *exposure, double *outputs);
void imki_fork_observe(const void *place, double *signals);
double imki_fork_step_length(const void *place, const imk_physics_settings *settings);

/* The error model of a valid design, into a triad that imki_reduction_begin() gave. */
void imki_tuning_fork_reduce(const imk_tuning_fork *design, imk_triad *gyro);

/* The table of its derived quantities. */
extern const imk_derived imki_tuning_fork_derived[];

#endif
