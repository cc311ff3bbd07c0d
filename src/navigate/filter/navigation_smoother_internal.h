/* SPDX-License-Identifier: Apache-2.0 */
/* What the filter tells its smoother, if it has one. */
#ifndef IMUKIT_NAVIGATE_NAVIGATION_SMOOTHER_INTERNAL_H
#define IMUKIT_NAVIGATE_NAVIGATION_SMOOTHER_INTERNAL_H

#include "navigation_filter_internal.h"

#include "imukit/navigation_smoother.h"

/* What happened, in order; later ones first. */
typedef struct imki_smoother_record {
    struct imki_smoother_record *before;
    size_t rows;  /* of an update; 0: a point */
    double *step; /* 10 x n: rows 0-8 of the transition since the record before, and the decays;
                     NULL: no time has gone by */
    double *h;    /* rows x n; of a point: 15 x n, rows of P of the nine errors
                               and of the sums of the parts of gyros and accelerometers */
    double *gain; /* n x rows */
    double z[3], inverse[3][3]; /* S^-1 z and S^-1; of a point not used */
    imk_navigation_state state;
    imk_vector3 bias[2];
} imki_smoother_record;

/* The last record. */
const imki_smoother_record *imki_smoother_last(const imk_navigation_smoother *smoother);

/* A step of the covariance. @param held_up  upwards, where the vertical is held; else NULL */
void imki_smoother_step(imk_navigation_smoother *smoother, const imki_filter_step *by,
                        const double *decay, const imk_vector3 *held_up);
/* An update. @param inverse  of the covariance of its innovation */
void imki_smoother_update(imk_navigation_smoother *smoother, const imki_measurement *measurement,
                          const double *gain, double inverse[3][3]);

#endif
