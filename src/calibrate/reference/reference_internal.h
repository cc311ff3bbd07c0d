/* SPDX-License-Identifier: Apache-2.0 */
/* Between the parts of the procedures that have a reference for every sample. */
#ifndef IMUKIT_REFERENCE_INTERNAL_H
#define IMUKIT_REFERENCE_INTERNAL_H

#include "calibrate/procedures/procedure_internal.h"
#include "imukit/reference_alignment.h"

/* ---- reference_fit.c: readings against the reference, linear ------------------------------------
 */

/* A reference channel `lag` samples before sample k, by Lagrange's polynomial through the six
 * nearest; NaN where these are not all in the record. */
double imki_reference_at(const double *channel, size_t count, size_t k, double lag);

/* Least squares of y on a constant and three channels x, from sums. */
typedef struct imki_linear_fit {
    size_t count;
    double origin[4];   /* first x and y: what the sums are about */
    double sum[4];      /* of x and y */
    double product[10]; /* xx xy xz yy yz zz, x r, y r, z r, r r */
    double intercept, slope[3];
    double variance; /* of y */
    double residual; /* standard deviation of y about the fit */
    double share;    /* of the variance of y that the fit explains, 0 … 1 */
} imki_linear_fit;
void imki_linear_fit_add(imki_linear_fit *fit, const double x[3], double y);
/* Channels that do not vary, or vary with others only, get the slope 0. */
void imki_linear_fit_solve(imki_linear_fit *fit);

/* Reading of an axis against its reference (rate of gyros, force of accelerometers), which is
 * `lag` samples older, samples begin … end - 1, every `stride`th. */
imki_linear_fit imki_reference_fit(const imk_test_record *record, int sensor, int axis, double lag,
                                   size_t begin, size_t end, size_t stride);

/* Newton's steps from `lag` to the shift that fits best, all axes of the sensors named (bit 1
 * gyros, bit 2 accelerometers). @return false when they do not converge within `limit` */
bool imki_reference_lag(const imk_test_record *record, int sensors, double limit, double *lag,
                        double *sigma);

/* Three channels of what a sensor is compared with; NULL when the record does not have it. */
const double *const *imki_reference_channels(const imk_test_record *record, int sensor);

/* ---- reference_determined.c: which parameters the observations tell apart ----------------------
 */

/* One element of a term a procedure may make free, of every axis of a sensor. */
typedef struct imki_candidate {
    uint8_t sensor, term;
    bool promised; /* told to the caller when it is not determined */
    bool hidden;   /* not to be estimated, but what it may be is part of the other sigmas */
} imki_candidate;
enum { IMKI_CANDIDATES_MAX = 24 };

/* reference_candidates.c: what the procedure of the call would make free. @return how many */
size_t imki_reference_candidates(const imki_procedure_call *call,
                                 imki_candidate list[IMKI_CANDIDATES_MAX]);

/* Make free what all observations of known input determine, in the order of the candidates. */
imk_status imki_free_determined(const imki_procedure_call *call, size_t count,
                                const imki_candidate *candidate);

/* Bytes of the call's workspace it needs. */
size_t imki_free_determined_workspace(void);

/* ---- reference_readings.c: what the observations of these procedures are made of ---------------
 */

/* Variance of a sample as far as it counts in a mean, of every axis [unit of the reading squared]:
 * the geometric mean over the stretches, so that neither the luck of a short stretch nor a
 * disturbed one sets the weights. */
typedef struct imki_pooled_noise {
    double variance[2][IMK_AXES_MAX];
} imki_pooled_noise;
imki_pooled_noise imki_reference_noise(const imki_procedure_call *call, size_t count,
                                       const imk_reference_stretch *stretch);

/* An observation of the record: nothing observed, no input. */
imk_observation imki_reference_blank(const imki_procedure_call *call, size_t begin, size_t end,
                                     int fixture);
/* Samples begin … end - 1 of a sensor are numbers, and within the model's range. */
bool imki_reference_usable(const imki_procedure_call *call, int sensor, size_t begin, size_t end);
/* The smallest sigma worth stating: of a mean whose samples are all the same [unit of the
 * reading]. */
double imki_reference_floor(const imki_procedure_call *call, int sensor, int axis);
/* Sigma of a sample of each axis, by that noise. */
void imki_reference_sigmas(const imki_procedure_call *call, int sensor,
                           const imki_pooled_noise *noise, double sigma[IMK_AXES_MAX]);
/* The readings of a sensor in a stretch into an observation, with temperature. */
void imki_reference_take(const imki_procedure_call *call, int sensor,
                         const imki_pooled_noise *noise, const imk_reference_stretch *stretch,
                         imk_observation *observation);
/* What the gyros of a rate table are off by together, as far as its input is not known. */
double imki_reference_offset_sigma(const imki_procedure_call *call,
                                   const imk_observation *observation);
/* Counts per unit of an axis; 1 where readings are in SI. */
double imki_reference_sensitivity(const imki_procedure_call *call, int sensor, int axis);
/* Rate and force that the sensors themselves read at means of their readings, by the nominal
 * model. Axes that are no orthogonal triad give the nearest. */
void imki_reference_own(const imki_procedure_call *call, int sensor, const double *mean,
                        double vector[3]);
/* IMK_ERROR_WORKSPACE when `wanted` more observations find no room. */
imk_status imki_reference_room(const imki_procedure_call *call, size_t wanted);
/* An error with numbers; index -1: none. */
imk_status imki_reference_refuse(const imki_procedure_call *call, imk_status status,
                                 const char *field, int index, double value, double limit,
                                 const char *expected);

/* ---- reference_blocks.c: where the reference moves ---------------------------------------------
 */

/* Blocks of samples as observations, the reference `lag` samples older. Samples that `skip` holds
 * (stretches in order, taken otherwise) are left out.
 * @param sensor  whose readings are taken; with those of accelerometers come rate and angular
 *                acceleration of the gyros where the reference has none
 * @param sigma   of a sample, per axis [unit of the reading]; NULL: from a linear fit */
imk_status imki_reference_blocks(const imki_procedure_call *call, int sensor, double lag,
                                 int fixture, size_t skip_count, const imk_reference_stretch *skip,
                                 const double *sigma);

/* ---- reference_creep.c --------------------------------------------------------------------------
 */

/* In how many of the stretches the accelerometers have a slope beyond the noise. */
size_t imki_reference_creeping(const imk_test_record *record, size_t count,
                               const imk_reference_stretch *stretch);

/* ---- reference_spin.c --------------------------------------------------------------------------
 */

/* Add the observations of a spin test. */
imk_status imki_spin_observe(const imki_procedure_call *call, size_t stretch_count,
                             const imk_reference_stretch *stretch, int fixture);

#endif
