/* SPDX-License-Identifier: Apache-2.0 */
/* The filter's memory, shared by its propagation and its updates. States: position 0-2, velocity
 * 3-5, attitude 6-8, estimate minus truth in Earth-fixed axes, C (estimated) = exp([e x]) C (true);
 * then three per bias part, gyro parts first: what the parts' estimates leave of the readings'
 * error. */
#ifndef IMUKIT_NAVIGATE_NAVIGATION_FILTER_INTERNAL_H
#define IMUKIT_NAVIGATE_NAVIGATION_FILTER_INTERNAL_H

#include "imukit/navigation_filter.h"

enum { IMKI_GYRO_PART = 0, IMKI_ACCEL_PART = 1 };

struct imk_navigation_filter {
    imk_navigation_filter_settings settings;
    imk_strapdown strapdown;
    size_t states;
    size_t parts[2];
    double bias[2][IMK_BIAS_PARTS_MAX][3]; /* estimated */
    imk_vector3 bias_sum[2];
    /* Since the covariance was last propagated: */
    double span;          /* [s] */
    imk_matrix3 turned;   /* integral of C_eb */
    imk_vector3 force;    /* integral of C_eb f */
    imk_matrix3 attitude; /* C_eb now */
    /* Since the stand began: */
    double stand;           /* [s] */
    imk_vector3 stand_turn; /* what the gyros read beyond the Earth's rate and the biases [rad] */
    imk_matrix3 stand_attitude; /* integral of C_eb */
    imk_navigation_filter_counts counts;
    double *covariance; /* states x states */
    double *cross;      /* states x 3: covariance of the errors with the gyros' noise since the
                           stand began, integrated [rad] */
    double *scratch;    /* states x states */
    /* Of the last update that was accepted: */
    size_t rows;
    double *h;    /* rows x states */
    double *gain; /* states x rows */
};

/* Second moments of a part's mean over an alignment of length `time` and of its value at the end.
 */
typedef struct imki_part_moments {
    double mean, both, end;
} imki_part_moments;
imki_part_moments imki_bias_part_moments(const imk_bias_part *part, int axis, double time);

/* What a part's values keep over a time h: e^{-h/T}, or 1. */
double imki_bias_part_decay(const imk_bias_part *part, double h);

/* The last update that was accepted: z = h x + v, and gain K, by which x <- K z was taken out of
 * the state; no rows before the first. Valid until the next call of the filter. */
typedef struct imki_filter_gain {
    size_t states, rows;
    const double *h;    /* rows x states */
    const double *gain; /* states x rows */
} imki_filter_gain;
imki_filter_gain imki_navigation_filter_gain(const imk_navigation_filter *filter);
/* The covariance of all states, states x states, brought up to the last sample. */
const double *imki_navigation_filter_covariance(imk_navigation_filter *filter);

/* Bring the covariance up to the last sample. */
void imki_navigation_filter_propagate(imk_navigation_filter *filter);

/* z = H x + v with up to three rows: what is measured of the states x, with noise v of covariance
 * `noise` and, when `cross` is not NULL, covariance `cross` (states x 3) with the errors. Tests,
 * and takes the estimated errors out. `h` is rows x states. @return false: refused */
bool imki_navigation_filter_measure(imk_navigation_filter *filter, size_t rows, const double *h,
                                    const double z[3], double noise[3][3], const double *cross);

#endif
