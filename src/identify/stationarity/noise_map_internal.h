/* SPDX-License-Identifier: Apache-2.0 */
/* Parts of the search for changes of the noise. */
#ifndef IMUKIT_NOISE_MAP_INTERNAL_H
#define IMUKIT_NOISE_MAP_INTERNAL_H

#include "imukit/noise_map.h"

/* noise_map.c: sums over columns first … end - 1. */
imk_noise_cell imki_noise_cells(const imk_noise_map *map, size_t octave, size_t first, size_t end);

/* A stretch of columns whose noise differs from that of the others of a range. */
typedef struct imki_noise_contrast {
    size_t first, end;
    double probability; /* of as large a difference, or larger, anywhere in the range */
    double size;        /* in standard deviations */
} imki_noise_contrast;

/* noise_contrast.c */
/* Octaves that are compared together. */
typedef struct imki_noise_band {
    size_t joined;                       /* so many columns are taken as one */
    double share[IMK_NOISE_MAP_OCTAVES]; /* what a difference counts; 0: not in the band */
    double scale[IMK_NOISE_MAP_OCTAVES]; /* 1/(its mean square); any number if only one octave */
} imki_noise_band;
/* A single octave. */
imki_noise_band imki_noise_octave(size_t octave);
/* The stretch that differs most within columns low … high - 1.
 * @param scatter  of a single octave, variance of the strength from column to column over that of
 *                 independent differences, at least 1; 0: not known, too few differences */
imki_noise_contrast imki_noise_contrast_find(const imk_noise_map *map, const imki_noise_band *band,
                                             size_t low, size_t high, double scatter);
/* Probability of as large a difference between columns low … middle - 1 and middle … high - 1. */
double imki_noise_compare(const imk_noise_map *map, const imki_noise_band *band, size_t low,
                          size_t middle, size_t high, double scatter);
/* Scatter of columns low … high - 1, see above. */
double imki_noise_scatter(const imk_noise_map *map, size_t octave, size_t low, size_t high);

/* Sum of the squared steps from column to column, over their variance for independent differences;
 * adds their number to `steps`. Columns of few differences have none. */
double imki_noise_steps(const imk_noise_map *map, size_t octave, size_t low, size_t high,
                        double *steps);

/* noise_strength.c */
/* Shares of the terms in the Allan variance of each octave. */
typedef struct imki_noise_shares {
    size_t octaves;
    unsigned skipped; /* octaves that N and B are not estimated from */
    double white[IMK_NOISE_MAP_OCTAVES], flicker[IMK_NOISE_MAP_OCTAVES], /* [unit^2] */
        other[IMK_NOISE_MAP_OCTAVES], tones[IMK_NOISE_MAP_OCTAVES],      /* other: with the tones */
        slow[IMK_NOISE_MAP_OCTAVES]; /* flicker, random walk, Gauss-Markov */
} imki_noise_shares;
static inline double imki_noise_total(const imki_noise_shares *s, size_t octave)
{
    return s->white[octave] + s->flicker[octave] + s->other[octave];
}
void imki_noise_shares_find(const imk_identification *identified, double dt, size_t octaves,
                            imki_noise_shares *shares);
/* What correlation of a Gaussian process makes of the scatter, at most. */
double imki_noise_expected_scatter(const imk_identification *identified, double dt,
                                   const imki_noise_shares *shares, size_t octave);
/* N and B of columns first … end - 1. */
void imki_noise_strengths(const imk_noise_map *map, const imki_noise_shares *shares,
                          const imk_identification *identified, double confidence, size_t first,
                          size_t end, imk_noise_segment *segment);

/* noise_tails.c: kurtosis and scatter. */
void imki_noise_tails(const imk_noise_map *map, const imk_noise_changes_settings *settings,
                      const imk_identification *identified, const imki_noise_shares *shares,
                      imk_noise_changes *result);

#endif
