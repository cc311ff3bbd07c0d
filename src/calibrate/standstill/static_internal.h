/* SPDX-License-Identifier: Apache-2.0 */
/* The parts of static detection (static_detection.h): moments of blocks of samples, what the rest
 * is like, and windows of four blocks assessed by it. */
#ifndef IMUKIT_STATIC_INTERNAL_H
#define IMUKIT_STATIC_INTERNAL_H

#include "imukit/static_detection.h"

enum {
    IMKI_STATIC_AXES = 2 * IMK_AXES_MAX,
    IMKI_WINDOW_BLOCKS = 4, /* a window is four blocks long and moves on by one */
    IMKI_REST_WINDOWS = 6   /* of the stretch that is searched for as the quietest, at first */
};

/* What is known of one axis before anything is assessed. */
typedef struct imki_static_axis {
    int sensor, axis;
    const double *reading;
    double step;                  /* smallest difference of neighbours that differ; 0: constant */
    double range_low, range_high; /* readings at and beyond are saturated */
    double unit;                  /* reading * unit is SI, up to an offset; 0: not known */
    double zero;                  /* reading of no input, where the unit is known */
} imki_static_axis;

enum { IMKI_BLOCK_INVALID = 1, IMKI_BLOCK_BREAK = 2 }; /* BREAK: a gap or another section before */

/* Blocks of `length` samples each, without overlap, from sample 0. */
typedef struct imki_static_blocks {
    size_t length, count;
    double *mean[IMKI_STATIC_AXES];
    double *square[IMKI_STATIC_AXES]; /* sum of squares about the mean */
    uint8_t *flag;
} imki_static_blocks;

/* What one axis does at rest, and the limits on a window. */
typedef struct imki_static_limit {
    double noise;           /* standard deviation of a sample within a window */
    double effective;       /* independent samples in a window */
    double inefficiency;    /* variance of a mean, times samples, over that of a sample */
    double mean;            /* at rest */
    double scatter_squared; /* limit on the variance within a window; 0: the axis is not assessed */
    double half;            /* on the difference of the means of its halves */
    double mean_off;        /* on its mean less that of the rest before; infinite: not assessed */
} imki_static_limit;

typedef struct imki_static_job {
    const imk_test_record *record;
    int axis_count;
    imki_static_axis axis[IMKI_STATIC_AXES];
    imki_static_blocks blocks;
    imki_static_limit limit[IMKI_STATIC_AXES];
    double false_alarm;
    double *activity;            /* per window, by its first block; NaN: not assessed */
    double *scratch;             /* as long */
    size_t rest_begin, rest_end; /* blocks */
    bool rests;                  /* a rest was found */
} imki_static_job;

/* ---- static_blocks.c ---- */

/* Axes with readings, their steps and ranges. */
void imki_static_axes(const imk_test_record *record, const imk_model *model, imki_static_job *job);
/* Smallest difference between neighbours that differ, samples begin … end - 1; 0: constant. */
double imki_static_step(const double *reading, size_t begin, size_t end);
/* Mean and sum of squares about it; not finite when a value is not. */
typedef struct imki_moments {
    double mean, square;
} imki_moments;
imki_moments imki_static_moments(const double *x, size_t n);
/* Moments of all blocks; counts what was left out. */
void imki_static_blocks_fill(imki_static_job *job, imk_static_findings *findings);
/* Join pairs of blocks into one of twice the length, in place. */
void imki_static_blocks_join(imki_static_job *job);

/* Windows that can be assessed. */
static inline size_t imki_static_windows(const imki_static_blocks *b)
{
    return b->count < IMKI_WINDOW_BLOCKS ? 0 : b->count - IMKI_WINDOW_BLOCKS + 1;
}
static inline bool imki_static_window_valid(const imki_static_blocks *b, size_t window)
{
    const uint8_t *f = b->flag + window;
    return !((f[0] | f[1] | f[2] | f[3]) & IMKI_BLOCK_INVALID) &&
           !((f[1] | f[2] | f[3]) & IMKI_BLOCK_BREAK);
}
/* Mean, variance (n - 1) and difference of the halves' means of a window of one axis. */
typedef struct imki_window_moments {
    double mean, variance, half;
} imki_window_moments;
static inline imki_window_moments imki_static_window(const imki_static_blocks *b, int axis,
                                                     size_t window)
{
    const double *m = b->mean[axis] + window, *q = b->square[axis] + window;
    const double length = (double)b->length;
    const double mean = 0.25 * ((m[0] + m[1]) + (m[2] + m[3]));
    const double d0 = m[0] - mean, d1 = m[1] - mean, d2 = m[2] - mean, d3 = m[3] - mean;
    const double square =
        (q[0] + q[1]) + (q[2] + q[3]) + length * ((d0 * d0 + d1 * d1) + (d2 * d2 + d3 * d3));
    return (imki_window_moments){mean, square / (4.0 * length - 1.0),
                                 0.5 * ((d2 + d3) - (d0 + d1))};
}

/* ---- static_noise.c ---- */

/* Find the quietest stretch, and learn from it. */
void imki_static_find_rest(imki_static_job *job);
/* Learn noise and limits from blocks begin … end - 1, all valid. */
void imki_static_learn(imki_static_job *job, size_t begin, size_t end);
/* False when no sensor at rest looks like this stretch. */
bool imki_static_looks_at_rest(const imki_static_job *job, size_t begin, size_t end);

/* ---- static_assess.c ---- */

/* Fill the activity of every window, by the limits. */
void imki_static_assess(imki_static_job *job);
/* A run of standing windows: blocks begin … end - 1. */
typedef struct imki_static_run {
    size_t begin, end;
} imki_static_run;
/* The next one from window *window on, which moves behind it; false: there is none. */
bool imki_static_next_run(const imki_static_job *job, size_t *window, imki_static_run *run);

/* ---- static_means.c: a table of means, every row of which is an interval ---- */

imk_static_interval imki_static_mean(const imk_test_record *record, size_t row);
/* As imk_static_detect(). @return the number of rows */
size_t imki_static_means(const imk_test_record *record, imk_static_interval *interval,
                         size_t capacity, double *activity, imk_static_findings *findings);

/* ---- static_summary.c ---- */

/* As imk_static_summary(), with the steps of the readings where they are known. */
imk_static_interval imki_static_summarise(const imk_test_record *record, size_t begin, size_t end,
                                          double step[2][IMK_AXES_MAX]);

/* sum x[k] x[k - lag] */
double imki_lagged_product(const double *x, size_t n, size_t lag);

#endif
