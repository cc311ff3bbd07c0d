/* SPDX-License-Identifier: Apache-2.0 */
/* What trajectory.c and trajectory_means.c share, and the kernels behind them. */
#ifndef IMUKIT_TRAJECTORY_INTERNAL_H
#define IMUKIT_TRAJECTORY_INTERNAL_H

#include "imukit/motion.h"

enum { IMKI_INTERVALS = 8 }; /* most intervals in one call of a kernel */

/* Intervals that each lie in one piece, and what is found for them. */
typedef struct imki_intervals {
    double begin[IMKI_INTERVALS], end[IMKI_INTERVALS];
    const imk_trajectory_piece *piece[IMKI_INTERVALS];
    double rate[3][IMKI_INTERVALS], force[3][IMKI_INTERVALS]; /* means */
    double first[3][IMKI_INTERVALS], last[3][IMKI_INTERVALS]; /* rates at begin and end */
} imki_intervals;

/* A body at one instant. */
typedef struct imki_instant {
    double position[3]; /* Earth-fixed, relative to the origin */
    double velocity[3]; /* Earth-fixed */
    double rotation[3]; /* by vibration, about x, then y, then z */
    double rate[3], acceleration[3], force[3];
} imki_instant;

/* The outputs of imk_trajectory_means(). */
typedef struct imki_means {
    double *rate[3], *acceleration[3], *force[3];
} imki_means;

/* The piece at a time. Outside the span the motion goes on as it is at the end of it. */
typedef struct imki_cursor {
    const imk_trajectory *trajectory;
    size_t next;                       /* index of the piece after it */
    const imk_trajectory_piece *piece; /* may be `beyond` */
    double end;                        /* of the piece */
    imk_trajectory_piece beyond;
} imki_cursor;

/* Begin at a time: the last piece that starts at or before it. */
void imki_cursor_start(imki_cursor *cursor, const imk_trajectory *trajectory, double time);

/* Go on to the piece that holds `time`, which is not before the present one. */
void imki_cursor_advance(imki_cursor *cursor, double time);

/* The piece for the state at an instant, not before the present piece: at the end of the
 * trajectory, and later by rounding, still the last one. */
const imk_trajectory_piece *imki_cursor_at(imki_cursor *cursor, double time);

/* Means over the first `count` intervals. The bits for one interval do not depend on the others,
 * nor on the kernel. */
typedef void imki_means_of_intervals(const imk_trajectory *trajectory, size_t count,
                                     imki_intervals *intervals);

/* Means over `count` samples within one piece, a multiple of IMKI_INTERVALS: the same bits as those
 * of intervals. */
typedef void imki_means_of_samples(const imk_trajectory *trajectory,
                                   const imk_trajectory_piece *piece, size_t count,
                                   const double *boundary, const imki_means *means);

imki_means_of_intervals imki_means_of_intervals_portable, imki_means_of_intervals_avx2,
    imki_means_of_intervals_avx512;
imki_means_of_samples imki_means_of_samples_portable, imki_means_of_samples_avx2,
    imki_means_of_samples_avx512;

/* State at a time within a piece (or beyond, where its polynomials go on). */
void imki_instant_of(const imk_trajectory *trajectory, const imk_trajectory_piece *piece,
                     double time, imki_instant *instant);

#endif
