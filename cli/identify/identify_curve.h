/* SPDX-License-Identifier: Apache-2.0 */
/* Identification from a table of Allan deviations instead of a log. */
#ifndef IMUKIT_IDENTIFY_CURVE_H
#define IMUKIT_IDENTIFY_CURVE_H

#include "identify_parts.h"

#include "imukit/allan_fit.h"

/* What the table does not say. */
typedef struct identify_curve_input {
    double rate;           /* [Hz] of the record behind it */
    double duration;       /* [s] of that record */
    double tolerance;      /* relative error of the model admitted in each deviation */
    uint64_t gauss_markov; /* terms looked for */
    bool plain;            /* clusters that do not overlap */
} identify_curve_input;

/* Read the table at i->path, with a column tau [s] and deviations in gyro_x [deg/s], …, and put
 * what a fit of all of them says into i->result, i->channels, i->curve and the verdict. Free with
 * identify_free().
 * @return -1 or the exit code */
int identify_curve(identification *i, const identify_curve_input *input);

#endif
