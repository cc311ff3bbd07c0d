/* SPDX-License-Identifier: Apache-2.0 */
/* State of a running ring laser gyro, and what its files share. Phases are in fringes (turns of
 * psi): whole ones in an integer and a part within +-1/2, so that no digit is lost in runs of any
 * length. */
#ifndef IMUKI_RING_LASER_INTERNAL_H
#define IMUKI_RING_LASER_INTERNAL_H

#include "imukit/elementary.h"
#include "imukit/ring_laser.h"
#include "physics/physics_internal.h"

/* Sources of randomness. Fixed for ever. */
enum {
    IMKI_RING_LASER_QUANTUM = 0, /* draws: phase noise of the beat */
    IMKI_RING_LASER_DITHER = 1,  /* draws: amplitude of each half cycle */
    IMKI_RING_LASER_NULL = 2,    /* run constant and flicker of the null shift */
    IMKI_RING_LASER_SCALE = 3,   /* run constant of the scale factor */
    IMKI_RING_LASER_START = 4    /* run constant: phase at the start */
};

/* A phase [fringes]. */
typedef struct imki_fringes {
    int64_t whole;
    double part; /* -1/2 … 1/2 */
} imki_fringes;

typedef struct imki_ring_laser {
    imk_ring_laser design;
    imk_level level;
    double dt;         /* of a sample [s] */
    double fringes;    /* S with the errors of this run [1/rad], but for mode hops */
    double slope;      /* the same with the present mode */
    double kappa;      /* K W_L [rad/s] */
    double scatter;    /* e [fringes] */
    double mode;       /* wavelengths the perimeter has more than at the reference */
    bool warm;         /* the mode has been chosen */
    imki_fringes beat; /* psi; of IMK_LEVEL_SLOW without the dither */

    /* dither: A sin(2 pi phase), A drawn anew at each half cycle */
    bool dithers;
    double angle;     /* mean amplitude [rad] */
    double amplitude; /* of the present half cycle [rad] */
    uint64_t phase;   /* 2^-64 cycles */
    double sine;      /* of it */

    /* full level */
    size_t steps;
    double step;           /* [s] */
    uint64_t phase_step;   /* 2^-64 cycles */
    double turn_s, turn_c; /* sine and cosine of a step of the dither */
    double bend;           /* curvature of the phase over a step, per amplitude and S [1] */
    double noise;          /* of a step [fringes]; IMK_LEVEL_SLOW: of a second */
    double rate;           /* input of the last sample [rad/s], for the observer */

    /* slow level */
    double radian_time;    /* of a radian of the dither, 1/w [s] */
    double merged;         /* least 1 - r^2 at a turn */
    double kick_phase;     /* small terms in the phase of a kick [fringes]: next order, */
    double kick_pull;      /* and pull on the way */
    double whole_cycles;   /* of the dither in a sample */
    uint64_t phase_sample; /* and the rest, 2^-64 cycles */

    /* readout */
    double multiple;      /* counts per fringe */
    double count_angle;   /* nominal [rad] */
    int64_t counts;       /* at the last sample */
    double pickoff;       /* reading of the dither angle then [rad] */
    int64_t latched[2];   /* counts at the last two beginnings of a cycle */
    int64_t stripped;     /* the reading of whole periods at the last sample: whole counts */
    double stripped_part; /* and the rest */
    double null_shift;    /* now [rad/s] */

    imki_wander null_wander;
    imki_draws quantum_draws, dither_draws;
} imki_ring_laser;

/* Longest steps of the full level: the curvature of the phase over a step [rad], the phase that
 * lock-in can take in a step [rad], and the part of a dither cycle. They leave errors of 1e-4 of a
 * kick. */
#define IMKI_RING_LASER_BEND 0.08
#define IMKI_RING_LASER_PULL 0.02
#define IMKI_RING_LASER_CYCLE (1.0 / 32.0)

/* Beyond these the kicks are wrong by more than 1 %. */
#define IMKI_RING_LASER_BEND_LIMIT 0.32
#define IMKI_RING_LASER_PULL_LIMIT 0.1
#define IMKI_RING_LASER_CYCLE_LIMIT (1.0 / 16.0)

/* Sine and cosine of a phase in turns, |turns| < 1e9: reduced exactly to an eighth, then Taylor's
 * series to below 1e-16. */
static inline void imki_ring_laser_sine(double turns, double *sine, double *cosine)
{
    const double shift = 0x1.8p52;
    const double quarters = (4.0 * turns + shift) - shift;
    const double x = 2.0 * IMKI_PI * (turns - 0.25 * quarters), y = x * x;
    const int quadrant = (int)((int64_t)quarters & 3);
    const double yy = y * y, y4 = yy * yy; /* short chains: this is what the time goes into */
    const double s =
        x +
        x * y *
            ((-1.0 / 6.0 + y * (1.0 / 120.0)) + yy * (-1.0 / 5040.0 + y * (1.0 / 362880.0)) +
             y4 * ((-1.0 / 39916800.0 + y * (1.0 / 6227020800.0)) - yy * (1.0 / 1307674368000.0)));
    const double c = (1.0 - 0.5 * y) + yy * ((1.0 / 24.0 - y * (1.0 / 720.0)) +
                                             yy * (1.0 / 40320.0 - y * (1.0 / 3628800.0)) +
                                             y4 * ((1.0 / 479001600.0 - y * (1.0 / 87178291200.0)) +
                                                   yy * (1.0 / 20922789888000.0)));
    const double a = quadrant & 1 ? c : s, b = quadrant & 1 ? s : c;
    *sine = quadrant & 2 ? -a : a;
    *cosine = (quadrant + 1) & 2 ? -b : b;
}

static inline void imki_fringes_add(imki_fringes *fringes, double more)
{
    const double shift = 0x1.8p52;
    const double sum = fringes->part + more;
    const double whole = (sum + shift) - shift;
    fringes->whole += (int64_t)whole;
    fringes->part = sum - whole;
}

/* Counts: floor of the phase in parts of a fringe. */
static inline int64_t imki_ring_laser_count(const imki_ring_laser *gyro, imki_fringes fringes)
{
    const double counts = gyro->multiple * fringes.part; /* within +-2 */
    const int64_t rounded = (int64_t)counts;
    return (int64_t)gyro->multiple * fringes.whole + rounded - ((double)rounded > counts);
}

/* A cycle of the dither begins at this phase. */
static inline void imki_ring_laser_latch(imki_ring_laser *gyro, imki_fringes fringes)
{
    gyro->latched[0] = gyro->latched[1];
    gyro->latched[1] = imki_ring_laser_count(gyro, fringes);
}

/* The next half cycle has another amplitude. */
static inline void imki_ring_laser_next_amplitude(imki_ring_laser *gyro)
{
    gyro->amplitude =
        gyro->angle * (1.0 + gyro->design.dither.randomness * imki_draw(&gyro->dither_draws));
}

/* Advance psi by a sample at the rate about the input axis, null shift included [rad/s]. */
void imki_ring_laser_full(imki_ring_laser *gyro, double rate);
void imki_ring_laser_slow(imki_ring_laser *gyro, double rate);

/* Longest internal step of the full level [s], and the longest allowed. */
double imki_ring_laser_step(const imk_ring_laser *design, double bend, double pull, double cycle);

/* The error model of a valid design, into a triad that imki_reduction_begin() gave. */
void imki_ring_laser_reduce(const imk_ring_laser *design, imk_triad *triad);

/* The table of its derived quantities. */
extern const imk_derived imki_ring_laser_derived[];

#endif
