/* SPDX-License-Identifier: Apache-2.0 */
/* The parts of an alignment: means, the errors of a model during it, the whitened comparison of
 * velocities, and what weighs them. */
#ifndef IMUKIT_NAVIGATE_ALIGNMENT_INTERNAL_H
#define IMUKIT_NAVIGATE_ALIGNMENT_INTERNAL_H

#include "imukit/alignment.h"

/* ---- attitude from means (alignment_means.c) --------------------------------------------------
 */

/** C_nb of a body that does not move, from its means of force and rate: gravity first,
 *
 *      d = -f/|f|,   e = d x w/|d x w|,   n = e x d       rows of C_nb
 *
 *  turned by what gravity at the place has toward the equator, so that errors b of force and c
 *  of rate, in north-east-down axes, leave to first order
 *
 *      north: -b_E/g,   east: b_N/g,   down: b_E tan(L)/g - c_E/(w_ie cos L).
 *
 *  @return IMK_ERROR_SINGULAR with C_nb untouched when they are zero, parallel or not finite */
imk_status imki_alignment_of_means(imk_vector3 force, imk_vector3 rate, imk_geodetic place,
                                   imk_matrix3 *c_nb);

/** covariance += what errors of covariance `force` and `rate` (of means over the time, in body
 *  axes) do by these formulas. */
void imki_alignment_response(imk_matrix3 c_nb, double latitude, double gravity,
                             const imk_matrix3 *force, const imk_matrix3 *rate,
                             imk_matrix3 *covariance);

/* ---- what a model says of its errors during the alignment (alignment_errors.c) ----------------
 */

/** Of one triad, in body axes. */
typedef struct imki_alignment_errors {
    imk_matrix3 white;   /**< density [unit^2/Hz] */
    imk_matrix3 mean;    /**< covariance of the mean over the time of all else but what follows
                              [unit^2] */
    imk_matrix3 walk;    /**< K^2 [unit^2/s]: of the mean K^2 T/3 */
    imk_matrix3 change;  /**< K^2 of a random walk that changes as much over the time as flicker and
                              Gauss-Markov processes are [unit^2/s] */
    imk_matrix3 reading; /**< covariance of errors that depend on what is measured [unit^2] */
    imk_matrix3 quantum; /**< variance of the integral's rounding [unit^2 s^2] */
} imki_alignment_errors;

/** @param duration,dt  of the alignment and of a sample [s]
 *  @param input        what the triad measures, body axes
 *  @param force        specific force in body axes, for a gyro's sensitivity to it; NULL: none */
imki_alignment_errors imki_alignment_errors_of(const imk_triad *triad, double duration, double dt,
                                               imk_vector3 input, const imk_vector3 *force);
/** A third of the trace: the variance along one axis, whichever it is. */
double imki_alignment_isotropic(const imk_matrix3 *covariance);

/* ---- velocities compared (alignment_whitener.c) -----------------------------------------------
 */

/** How velocities err along each axis: by independent amounts at each epoch, by a white force, by a
 *  force that walks as the attitude does, and by one that grows as a gyro's bias turns it. */
typedef struct imki_velocity_noise {
    double epoch;  /**< variance at each epoch [m^2/s^2] */
    double force;  /**< density of white force [m^2/s^3] */
    double turn;   /**< of the white derivative of force, by the attitude's walk [m^2/s^5] */
    double forced; /**< the same by that of the accelerometers [m^2/s^5] */
    double growth; /**< variance of force's derivative by the gyros' bias [m^2/s^6] */
    double walk;   /**< density of the bias's white derivative [m^2/s^7] */
} imki_velocity_noise;

/** A noise, the filter that makes it white, and the sums of the two velocities that went through
 *  it. The second velocity is kept as its difference from what a coarse rotation expects. */
typedef struct imki_whitener {
    imki_velocity_noise noise;
    size_t count;              /**< epochs */
    double p[3][3];            /**< covariance of velocity, force, growth at the end of it */
    imk_vector3 reference[3];  /**< the three, of what is known */
    imk_vector3 difference[3]; /**< and of measured minus expected, in the body's axes */
    double log_variance;       /**< sum over innovations of the log of their variance */
    double known[3][3];        /**< sums of products of innovations over variance: reference by
                                    reference, */
    double mixed[3][3];        /**< reference by difference, */
    double rest[3][3];         /**< difference by difference */
} imki_whitener;

/** The rotation that fits best, body to reference, and what it leaves. */
typedef struct imki_velocity_fit {
    imk_matrix3 rotation;
    imk_matrix3 change;      /**< of the coarse rotation, scale included */
    double scale;            /**< of force */
    imk_matrix3 information; /**< about its error, in reference axes */
    double square;           /**< sum of squares across gravity that is left, over variance */
    double rate_ratio;       /**< turn of gravity seen over that expected */
} imki_velocity_fit;

/** Covariance of what white parts add in `step` [s] to the mean of velocity over it, and to
 * velocity, force and growth at its end: integrals of products of powers of time. */
void imki_velocity_added(const imki_velocity_noise *noise, double step, double q[4][4]);
/** Take the means over an epoch, `step` long [s], that follows the last. */
void imki_whitener_add(imki_whitener *whitener, double step, imk_vector3 reference,
                       imk_vector3 difference);
/** The coarse rotation (reference to body, as a matrix) has grown by `change`. */
void imki_whitener_rebase(imki_whitener *whitener, const imk_matrix3 *change);
/** @param coarse  rotation, reference to body
 *  @return IMK_ERROR_SINGULAR */
imk_status imki_whitener_fit(const imki_whitener *whitener, const imk_matrix3 *coarse,
                             imki_velocity_fit *fit);

/* ---- equal weights under other noise (alignment_spread.c) -------------------------------------
 */

enum { IMKI_SPREAD_STATES = 8 };

/** What velocity noise does to sums over epochs that weigh all alike: joint covariance of sum v x,
 * y, z times n, sum n, n (the mean over the epoch) and its states; n along any axis. */
typedef struct imki_spread {
    double p[IMKI_SPREAD_STATES][IMKI_SPREAD_STATES];
} imki_spread;

enum { IMKI_SPREAD_FORCE, IMKI_SPREAD_TURN, IMKI_SPREAD_GROWTH, IMKI_SPREAD_WALK, IMKI_SPREADS };

/** An epoch, `step` long, of the known velocity. */
void imki_spread_add(imki_spread *spread, const imki_velocity_noise *noise, double step,
                     imk_vector3 reference, bool first);
/** covariance += strength times what it leaves of the attitude at the end, in reference axes.
 *  @param turning  it is the attitude that goes, not the accelerometers'
 *  @param inverse  of the information with all weights 1
 *  @param mean     of the known velocity over the epochs
 *  @param force    at the end, in reference axes */
void imki_spread_covariance(const imki_spread *spread, const imk_matrix3 *inverse, imk_vector3 mean,
                            imk_vector3 force, bool turning, double strength,
                            imk_matrix3 *covariance);

/* ---- the whole --------------------------------------------------------------------------------
 */

enum { IMKI_WHITENERS = 40 };

/** Velocities from gravity and by the sensors, in inertial axes, and their means by epoch. */
typedef struct imki_velocities {
    imk_quaternion body; /**< from body to inertial body axes */
    imk_vector3 measured, reference;
    imk_vector3 last_angle, last_velocity;
    double last_step;
    imk_vector3 position, moving;                /**< Earth-fixed */
    imk_matrix3 axes;                            /**< Earth-fixed axes at the start to reference */
    double last_epoch;                           /**< end of the last complete one [s] */
    imk_vector3 epoch_measured, epoch_reference; /**< sums, times dt */
} imki_velocities;

struct imk_alignment {
    imk_alignment_settings settings;
    double time;
    size_t count;
    imk_vector3 angle, velocity;     /**< sums of increments */
    double epoch_length, epoch_time; /**< [s] */
    size_t epochs;                   /**< complete ones */

    imk_vector3 epoch_angle, epoch_velocity, last_rate, last_force; /**< means: for their scatter */
    double rate_scatter[3], force_scatter[3];

    imki_velocities velocities;
    imk_matrix3 coarse; /**< reference to body */
    size_t next_rebase;
    size_t whitener_count;
    imki_whitener equal;
    imki_whitener whitener[IMKI_WHITENERS];
    imk_vector3 reference_sum; /**< over epochs */
    imki_spread spread[IMKI_SPREADS];
};

void imki_alignment_inertial_start(imk_alignment *alignment);
void imki_alignment_inertial_add(imk_alignment *alignment, double dt, imk_vector3 angle,
                                 imk_vector3 velocity, const imk_vector3 *moving);
/** The epoch is complete. */
void imki_alignment_inertial_close(imk_alignment *alignment);
/** From Earth-fixed axes at `time` to reference axes. */
imk_vector3 imki_alignment_to_reference(const imk_alignment *alignment, double time, imk_vector3 v);
/** Result of the methods inertial and fine (alignment_solution.c). */
imk_status imki_alignment_inertial_finish(const imk_alignment *alignment,
                                          imk_alignment_result *result, imk_error *error);
imk_status imki_alignment_means_finish(const imk_alignment *alignment, imk_alignment_result *result,
                                       imk_error *error);

#endif
