/* SPDX-License-Identifier: Apache-2.0 */
/* The filter's memory, shared by its propagation and its updates. States: position 0-2, velocity
 * 3-5, attitude 6-8, estimate minus truth in Earth-fixed axes, C (estimated) = exp([e x]) C (true);
 * then three per bias part, gyro parts first: what the parts' estimates leave of the readings'
 * error; then the errors of aids, what their estimates leave, too. */
#ifndef IMUKIT_NAVIGATE_NAVIGATION_FILTER_INTERNAL_H
#define IMUKIT_NAVIGATE_NAVIGATION_FILTER_INTERNAL_H

#include "imukit/navigation_filter.h"

enum {
    IMKI_GYRO_PART = 0,
    IMKI_ACCEL_PART = 1,
    IMKI_AID_STATES_MAX = 6 * IMK_AIDS_MAX,
    IMKI_FILTER_STATES_MAX = IMK_NAVIGATION_ERRORS + 6 * IMK_BIAS_PARTS_MAX + IMKI_AID_STATES_MAX
};

/* Have they the same lever arm, and the same sigma of it? (aiding.c) */
bool imki_aids_at_one_point(const imk_aid *a, const imk_aid *b);

/* An error of an aid on one axis: a constant, or a Gauss-Markov process. */
typedef struct imki_aid_state {
    double correlation_time; /* [s]; 0: a constant */
    double sigma;
    double estimate;
} imki_aid_state;

/* Where the errors of an aid are among the states; 0: it has none. */
typedef struct imki_aid_places {
    size_t correlated, lever_arm;
} imki_aid_places;

/* The last sample, as the mechanisation made it: readings of aids are within it. */
typedef struct imki_last_sample {
    double dt;
    imk_vector3 rate;  /* mean, less the bias, body axes [rad/s] */
    imk_vector3 force; /* mean, less the bias, Earth-fixed axes [m/s^2] */
    imk_navigation_state before, after;
} imki_last_sample;

/* The normalised innovation of the last accepted update of a kind. */
typedef struct imki_whitened {
    size_t rows;
    double value[3];
} imki_whitened;

struct imk_navigation_filter {
    imk_navigation_filter_settings settings;
    imk_strapdown strapdown;
    size_t states;
    size_t parts[2];
    double bias[2][IMK_BIAS_PARTS_MAX][3]; /* estimated */
    imk_vector3 bias_sum[2];
    size_t first_aid_state, aid_states;
    imki_aid_state aid_state[IMKI_AID_STATES_MAX];
    imki_aid_places aid_places[IMK_AIDS_MAX];
    imki_last_sample last;
    /* Since the covariance was last propagated: */
    double span;          /* [s] */
    imk_matrix3 turned;   /* integral of C_eb */
    imk_vector3 force;    /* integral of C_eb f */
    imk_matrix3 attitude; /* C_eb now */
    /* Since the stand began: */
    double stand;           /* [s] */
    imk_vector3 stand_turn; /* what the gyros read beyond the Earth's rate and the biases [rad] */
    imk_matrix3 stand_attitude; /* integral of C_eb */
    /* Of each aid, then of stands: */
    imk_navigation_filter_counts counts[IMK_AIDS_MAX + 1];
    imki_whitened whitened[IMK_AIDS_MAX + 1];
    double limit[3]; /* of the test, by rows - 1 */
    imk_innovation innovation;
    double *covariance; /* states x states */
    double *cross;      /* states x 3: covariance of the errors with the gyros' noise since the
                           stand began, integrated [rad] */
    double *scratch;    /* states x states */
    /* Of the last update that was accepted: */
    size_t rows;
    double *h;                                /* rows x states */
    double *gain;                             /* states x rows */
    struct imk_navigation_smoother *smoother; /* which records; NULL: none */
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

/* State and covariance of the nine errors in Earth-fixed axes, rows `stride` apart, into an
 * estimate, whose biases stay. */
void imki_estimate_of(const imk_navigation_state *state, const double *covariance, size_t stride,
                      imk_navigation_filter_estimate *estimate);

/* Are the settings as they must be? */
imk_status imki_navigation_filter_check(const imk_navigation_filter_settings *settings,
                                        imk_error *error);

/* Bring the covariance up to the last sample. */
void imki_navigation_filter_propagate(imk_navigation_filter *filter);

/* What the errors at a time h from now are of those now, without noise: x = phi x(now) + gamma
 * b(now), where h may be negative; phi is 9 x 9, gamma 9 x 3 of gyro and accelerometer biases. */
typedef struct imki_filter_step {
    double phi[IMK_NAVIGATION_ERRORS][IMK_NAVIGATION_ERRORS];
    double gamma[2][IMK_NAVIGATION_ERRORS][3];
} imki_filter_step;
void imki_navigation_filter_shift(const imk_navigation_filter *filter, double h,
                                  imki_filter_step *step);

/* z = H x + v with up to three rows: what is measured of the states x, with noise v of covariance
 * `noise` and, when `cross` is not NULL, covariance `cross` (states x 3) with the errors. */
typedef struct imki_measurement {
    size_t rows;
    int axis[3];
    double h[3 * IMKI_FILTER_STATES_MAX]; /* rows x states */
    double z[3], noise[3][3];
    const double *cross;
    bool compare; /* only */
} imki_measurement;

/* Tests a measurement, and takes the estimated errors out.
 * @param kind  of the counts: the number of the aid, or IMK_AIDS_MAX */
imk_aid_verdict imki_navigation_filter_measure(imk_navigation_filter *filter, size_t kind,
                                               const imki_measurement *measurement);

#endif
