/* SPDX-License-Identifier: Apache-2.0 */
/* Missing samples in the likelihood: the conditional mean of what is missing given the rest and a
 * spectrum, and what that leaves of each band's information. */
#ifndef IMUKIT_MISSING_INTERNAL_H
#define IMUKIT_MISSING_INTERNAL_H

#include "identify/likelihood/identify_internal.h"

/* A record or a segment with samples missing, and a spectrum that it is thought to have. Vectors
 * are the caller's. */
typedef struct imki_fill {
    size_t n;               /* samples, missing ones included */
    size_t missing;         /* of them */
    const uint32_t *index;  /* their places, ascending */
    const double *variance; /* expected square of cosine coefficient k, 1 <= k < n; all > 0 */
    double gap;             /* mean length of a run of missing samples */
    double tolerance;       /* error of the solution per missing sample, in standard deviations */
    bool bridge;            /* in use: the covariance as preconditioner */
    int steps;              /* of conjugate gradients so far, all calls */
    double *scratch;        /* n */
    double *residual, *direction, *solution; /* `missing` each */
    void *transform;                         /* of imk_cosine_workspace_size(n) */
    size_t transform_size;
} imki_fill;

/* missing_fill.c */

/* Replace the missing of the samples by their mean given the others; the values there are the
 * start. The mean of the record is free. */
void imki_fill_mean(imki_fill *fill, double *samples);
/* One draw of what the mean leaves open: Gaussian with the covariance of the missing samples given
 * the others, in fill->solution. The same source and stream give the same draw. */
void imki_fill_draw(imki_fill *fill, imk_random random, uint64_t stream);
/* By how much the missing of the n samples in fill->scratch differ from that mean, in
 * fill->solution; the scratch is used up. */
void imki_fill_correction(imki_fill *fill);
/* Scatter the solution over n samples, zero elsewhere, and transform: cosine coefficients in
 * fill->scratch. */
void imki_fill_coefficients(imki_fill *fill);

/* What is known about the missing samples of a channel. */
enum { IMKI_RUN_OCTAVES = 32 };

typedef struct imki_missing {
    size_t count;                  /* missing samples */
    uint32_t *index;               /* their places */
    double *vector[3];             /* `count` each, for imki_fill; at the end the first holds a
                                      draw of the missing samples */
    size_t bands;                  /* of the spectrum below */
    double centre[IMKI_BANDS_MAX]; /* index k of a band's middle */
    double first[IMKI_BANDS_MAX];  /* first k */
    double width[IMKI_BANDS_MAX];  /* coefficients */
    double level[IMKI_BANDS_MAX];  /* log of the expected square of a coefficient */
    double lost[IMKI_BANDS_MAX];   /* share of a coefficient's variance that is missing */
    size_t line_count;             /* narrow lines, apart from the bands */
    imki_line line[IMKI_LINES_MAX];
    double ramp[IMKI_SINGLE_BANDS]; /* coefficient k of a ramp of 1 unit/s, filled like the rest */
    double runs[IMKI_RUN_OCTAVES],
        in_runs[IMKI_RUN_OCTAVES]; /* of missing samples, by octaves of
                                      their length, and samples in them */
    double
        whole[IMKI_BANDS_MAX]; /* degrees of freedom of the fit's bands if nothing were missing */
    int rounds, refinements;
    double scratch[5][IMKI_BANDS_MAX]; /* for a while; of a level's making the last three */
} imki_missing;

/* missing_spectrum.c */

/* Bands over n samples: one coefficient each at first, then 3 % wide. */
void imki_missing_bands(imki_missing *m, size_t n);
/* Mean over each band, without lines, of the squares of the coefficients, divided by the variance
 * if given; and over how many. */
void imki_missing_means(const imki_missing *m, const double *coefficients, const double *variance,
                        double *mean, double *count);
/* Weighted mean over as many neighbours on both sides as make up the weight. */
void imki_missing_smooth(size_t bands, const double *value, const double *weight, double needed,
                         double *out);
/* Value of one of the bands' tables at index k, linear in k between their centres; *b is the last
 * band whose centre is not above k, 0 to start with, and is moved on. */
double imki_missing_between(const imki_missing *m, const double *table, size_t *b, size_t k);
/* Levels from the bands' powers; returns how far they have moved. */
double imki_missing_levels(imki_work *w, imki_missing *m, const double *power,
                           const double *degrees);
/* Strong narrow lines in the work's coefficients; uses its running sums. */
void imki_missing_lines(imki_work *w, imki_missing *m);
/* The variance of each coefficient; lines as the coefficients show them, without if NULL. */
void imki_missing_spread(const imki_missing *m, size_t n, const double *coefficients,
                         double *variance);

/* missing_record.c, missing_information.c */

/* Bytes for so many missing samples; its place in memory that is aligned to 64. */
size_t imki_missing_size(size_t count);
imki_missing *imki_missing_place(void *memory, size_t count);
/* Estimate spectrum and missing samples (NaN) of the work's samples by turns; they come back
 * filled, and the result says what was missing. */
void imki_missing_fill(imki_work *w, imk_identification *result);
/* Fill again, with the spectrum of the fit; the work's samples hold the draw of the missing ones.
 * False, and nothing done, when the fit has settled. */
bool imki_missing_refine(imki_work *w, imk_identification *result);
/* Put the draw of the missing samples in their places. */
void imki_missing_draw(const imki_missing *m, double *samples);
/* Cosine coefficients of the filled record -> coefficients of full variance. */
void imki_missing_restore(const imki_missing *m, size_t n, double *coefficients);
/* The degrees of freedom that the present samples leave to the bands. */
void imki_missing_weigh(imki_missing *m, imki_bands *bands);

#endif
