/* SPDX-License-Identifier: Apache-2.0 */
/* Packets of rows that are written again. */
#ifndef IMUKI_RECORD_PACKETS_INTERNAL_H
#define IMUKI_RECORD_PACKETS_INTERNAL_H

#include "imukit/job.h"

enum { IMKI_PACKET_LAGS = 64 };

/* Of a sensor: rows compared; by the lag, those whose channels equal those of the row so far
 * before, and those of them in runs as long as the lag. */
typedef struct imki_packets {
    size_t stretches, rows;
    size_t equal[IMKI_PACKET_LAGS + 1], again[IMKI_PACKET_LAGS + 1];
    /* by the lag: rows that differ from the one before, behind a row that equals that so far
     * before; those of them that equal it, too */
    size_t behind[IMKI_PACKET_LAGS + 1], on[IMKI_PACKET_LAGS + 1];
} imki_packets;

/* Count in some rows, at most 2048.
 * @param column  the channels of the sensor, as indices into `columns` */
void imki_packets_add(imki_packets *packets, size_t channels, const int *column, size_t rows,
                      double *const *columns, size_t first);
/* Where rows so far equal those some rows before, the probability that the next one does, if it is
 * a change: of the lag where it is largest. */
double imki_packets_agreement(const imki_packets *packets);
/* Tell if packets are written again. @param name  of the sensor */
void imki_packets_tell(const imki_packets *packets, size_t channels, const char *name,
                       imk_findings *findings);

#endif
