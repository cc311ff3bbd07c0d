/* SPDX-License-Identifier: Apache-2.0 */
/* The block form of the mechanisation: what is carried from sample to sample, the constants that
 * all instruction sets take from one place, and the kernels. Equations: strapdown_block_kernel.h.
 */
#ifndef IMUKIT_STRAPDOWN_BLOCK_INTERNAL_H
#define IMUKIT_STRAPDOWN_BLOCK_INTERNAL_H

#include "imukit/navigate.h"

#include <stddef.h>

/* Rows of what is carried; a row is one number, or one for each lane. */
enum {
    IMKI_POSITION = 0,
    IMKI_POSITION_LOW = 3,
    IMKI_VELOCITY = 6,
    IMKI_ATTITUDE = 9,
    IMKI_ATTITUDE_LOW = 13,
    IMKI_TIME = 17,
    IMKI_LAST = 18,   /* rate and force of the sample before */
    IMKI_BEFORE = 24, /* and of the one before that */
    IMKI_TURN = 30,   /* of the body since the block began */
    IMKI_GAIN = 34,   /* sum of turned forces */
    IMKI_WAY = 37,    /* sum of these sums */
    IMKI_FORCE = 40,  /* when the block began */
    IMKI_HEIGHT = 43, /* held, after the last sample */
    IMKI_CLIMB = 44,
    IMKI_ROWS = 45
};
_Static_assert((int)IMKI_ROWS == (int)IMK_STRAPDOWN_CARRIED, "room in navigate.h");

/* Of a pair of samples: dt alone makes them. Series in n = (x/dt)^2, x the turn. */
typedef struct imki_sample_constants {
    double dt;
    double share;      /* 2/3 dt */
    double tangent[4]; /* tan(x/4)/(x/dt) = t0 + n (t1 + n (t2 + n t3)) */
    double scale[4];   /* 2 cos^2(x/4) */
    double bend[2];    /* 3/2 dt (1 - sin(x/2)/(x/2))/x^2 */
    double limit;      /* largest n for these */
} imki_sample_constants;

/* Of a block: dt and the number of samples make them. */
typedef struct imki_block_constants {
    double dt, length, half_length;              /* [s] */
    double angle;                                /* h, that the Earth turns by */
    double cosine_to_one, sine;                  /* of h/2: 1 - cos, sin */
    double solved;                               /* 1/(1 + h^2) */
    double middle, way_share, edge;              /* (m + 2)/4, 2 dt/m, dt/(3 m) */
    double gradient_velocity, gradient_position; /* g/R T^2/6, g/R T^3/12 */
    double vertical;                             /* T/(2 R) */
} imki_block_constants;

/* What ends a block of a single mechanisation. */
typedef struct imki_block_end {
    imki_block_constants block;
    bool hold_height;
    bool alone, known;          /* a sample waits for another; the one before it is known */
    imki_sample_constants half; /* of half its length */
} imki_block_end;

/* Samples of LANES mechanisations that begin at `carried`, a row every `stride` numbers. */
typedef struct imki_block_run {
    double *carried;
    size_t stride;
    imk_strapdown_block *block;
    bool hold_height;
    size_t count;
    const double *const (*channel)[6]; /* of each lane */
    const double *height, *climb;
    imki_sample_constants sample;
    imki_block_constants whole;
    uint32_t size; /* samples of a whole block */
} imki_block_run;

imki_sample_constants imki_sample_constants_of(double dt);
imki_block_constants imki_block_constants_of(double dt, uint32_t samples);
/* How many samples make a block. */
uint32_t imki_block_size(double dt);

/* The run with what follows from dt, which block->step becomes: a block of another dt has been
 * completed. */
imki_block_run imki_block_run_of(double *carried, size_t stride, imk_strapdown_block *block,
                                 bool hold_height, size_t count, double dt,
                                 const double *const (*channel)[6], const double *height,
                                 const double *climb);
/* Set one lane at the start of a block. */
void imki_block_enter(double *carried, size_t stride, const imk_navigation_state *state,
                      double height, double climb);
/* Complete the block under way of a single mechanisation, or of one copied from its lane. */
void imki_block_complete(double carried[IMKI_ROWS], imk_strapdown_block *block, bool hold_height);
/* What stands in the rows of a single one. */
imk_navigation_state imki_block_state(const double carried[IMKI_ROWS]);

typedef void imki_block_kernel(const imki_block_run *run);
typedef void imki_block_ending(const imki_block_end *end, double carried[IMKI_ROWS]);

/* One mechanisation: in portable C, and with the machine's multiply-add. */
imki_block_kernel imki_block_run_portable, imki_block_run_fma;
imki_block_ending imki_block_end_portable, imki_block_end_fma;
/* As many as a register holds, 4 and 8. */
imki_block_kernel imki_block_run_avx2, imki_block_run_avx512;

/* Whether this machine has multiply-add, and the environment lets it be used. */
bool imki_block_has_fma(imk_kernel kernel);

#endif
