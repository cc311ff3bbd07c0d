/* SPDX-License-Identifier: Apache-2.0 */
/* The joint fit of everything that shapes the fast end of a spectrum (joint_shape.c), as the search
 * for further resonances (fast_shape.c) uses it. */
#ifndef IMUKIT_JOINT_SHAPE_INTERNAL_H
#define IMUKIT_JOINT_SHAPE_INTERNAL_H

#include "identify/likelihood/identify_internal.h"

enum {
    /* Amounts, bandwidth and damping of the filter, frequency and quality of each resonance. */
    IMKI_SHAPE_PARAMETERS = IMKI_TEMPLATES_MAX + 2 + 2 * IMK_TERMS_MAX,
    /* Rows in the work's two spare fits: the derivatives by these; v/(2 S^2) of the bands, P - S,
     * and one for what is needed for a while; then matrices of the parameters. */
    IMKI_SHAPE_WEIGHT = IMKI_SHAPE_PARAMETERS,
    IMKI_SHAPE_EXCESS,
    IMKI_SHAPE_SCRATCH,
    IMKI_SHAPE_INFORMATION,
    IMKI_SHAPE_FACTOR,
    IMKI_SHAPE_INVERSE,
    IMKI_SHAPE_ROWS
};

typedef enum imki_shape_kind {
    IMKI_SHAPE_AMOUNT,
    IMKI_SHAPE_BANDWIDTH,
    IMKI_SHAPE_DAMPING,
    IMKI_SHAPE_FREQUENCY,
    IMKI_SHAPE_QUALITY
} imki_shape_kind;

typedef struct imki_shape_parameter {
    imki_shape_kind kind;
    size_t index; /* of the template or of the resonance */
} imki_shape_parameter;

/* Every parameter enters by its logarithm. */
typedef struct imki_joint_fit {
    imki_work *w;
    imk_identification *result;
    double enough; /* a step that raises the likelihood by less is the last */
    size_t count;
    imki_shape_parameter parameter[IMKI_SHAPE_PARAMETERS];
    double gradient[IMKI_SHAPE_PARAMETERS];
} imki_joint_fit;

/* Resonances wider than that would stand for the filter's slope and for the white noise. */
#define IMKI_WIDEST 4.0

/* All parameters to the likelihood's top near where they are; returns the likelihood. */
double imki_joint_fit_maximise(imki_joint_fit *j);
/* Lists the parameters; their derivatives, gradient and information at the fit. */
void imki_joint_fit_linearise(imki_joint_fit *j);
/* Information scaled to a unit diagonal, plus lambda on it, factored in its row; false if it cannot
 * be. */
bool imki_joint_fit_factor(const imki_joint_fit *j, double lambda, double *scale);
/* Shapes of the filter and of the active resonances as the result has them. */
void imki_joint_fit_update(imki_joint_fit *j);
/* Row i: of the derivatives, or one of those named above. */
double *imki_joint_fit_row(const imki_joint_fit *j, size_t i);

/* The narrowest resonance that the bands resolve at a frequency. */
double imki_quality_resolved(const imki_bands *bands, double frequency);

#endif
