/* SPDX-License-Identifier: Apache-2.0 */
/* Noise that axes share. */
#ifndef IMUKI_LOG_COHERENCE_INTERNAL_H
#define IMUKI_LOG_COHERENCE_INTERNAL_H

#include "imukit/job.h"
#include "imukit/record.h"

enum { IMKI_COHERENT_AXES = 12, IMKI_COHERENT_BANDS = 31 };

/* Sums over segments: spectra of the axes, and the cross spectra of two, the earlier first. A
 * segment counts for the axes that have samples in it. */
typedef struct imki_coherence {
    int column[IMKI_COHERENT_AXES];
    size_t axes, rows;
    double segments[IMKI_COHERENT_AXES], power[IMKI_COHERENT_AXES][IMKI_COHERENT_BANDS];
    struct {
        double segments, cross[IMKI_COHERENT_BANDS][2];
    } pair[IMKI_COHERENT_AXES * (IMKI_COHERENT_AXES - 1) / 2];
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
