/* SPDX-License-Identifier: Apache-2.0 */
/* Noise that the axes of one sensor share. */
#ifndef IMUKI_LOG_COHERENCE_INTERNAL_H
#define IMUKI_LOG_COHERENCE_INTERNAL_H

#include "imukit/job.h"
#include "imukit/record.h"

enum { IMKI_COHERENT_AXES = 8, IMKI_COHERENT_BANDS = 31 };

/* Sums over segments of a sensor: spectra, and the cross spectra of two axes, the earlier first. */
typedef struct imki_coherent_axes {
    int column[IMKI_COHERENT_AXES];
    size_t axes, rows;
    double segments, power[IMKI_COHERENT_AXES][IMKI_COHERENT_BANDS];
    double cross[IMKI_COHERENT_AXES * (IMKI_COHERENT_AXES - 1) / 2][IMKI_COHERENT_BANDS][2];
} imki_coherent_axes;

typedef struct imki_coherence {
    imki_coherent_axes sensor[2]; /* gyros, accelerometers */
} imki_coherence;

/* Begin with the channels that are analysed. */
void imki_coherence_start(imki_coherence *coherence, size_t count, const int *channel,
                          const imk_log_column *columns);
/* Count in some rows of the log, one array for each column. */
void imki_coherence_add(imki_coherence *coherence, size_t rows, double *const *columns);
/* Tell of axes with one noise, unless one is known as computed from the other. */
void imki_coherence_tell(const imki_coherence *coherence, const imk_log_column *columns,
                         imk_findings *findings);

#endif
