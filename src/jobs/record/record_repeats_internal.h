/* SPDX-License-Identifier: Apache-2.0 */
/* Samples of a slow sensor, held in the rows of a faster log, and columns that repeat another. */
#ifndef IMUKI_RECORD_REPEATS_INTERNAL_H
#define IMUKI_RECORD_REPEATS_INTERNAL_H

#include "record_packets_internal.h"
#include "record_replay_internal.h"

#include "imukit/job.h"
#include "imukit/record.h"

enum { IMKI_REPEAT_AXES = 8 };

/* Windows of rows: number, and sums of what is counted in one and of its squares. */
typedef struct imki_windows {
    double windows, sum, square_sum;
} imki_windows;

/* What is counted of one sensor: rows whose channels equal those of a row before, [0] of the next
 * row before, [1] of one far enough to be equal by chance only. */
typedef struct imki_repeat_counts {
    int column[IMK_LOG_COLUMNS_MAX];
    size_t channels, rows, all[2], equal[IMK_LOG_COLUMNS_MAX][2];
    size_t stretches;         /* of a long log, counted or not */
    imki_windows held, blank; /* rows that repeat the one before; that have no value at all */
    bool differ[IMK_LOG_COLUMNS_MAX][IMK_LOG_COLUMNS_MAX]; /* of channels, the earlier one first */
    /* of the first channels: sums of products of the steps from row to row, and how many of these
     * are above 0 and below */
    double product[IMKI_REPEAT_AXES][IMKI_REPEAT_AXES];
    double alike[IMKI_REPEAT_AXES][IMKI_REPEAT_AXES], opposed[IMKI_REPEAT_AXES][IMKI_REPEAT_AXES];
    imki_packets packets;
    imki_replay replay;
} imki_repeat_counts;

typedef struct imki_repeats {
    imki_repeat_counts sensor[2]; /* gyros, accelerometers */
    bool others;                  /* the first are no gyros but all other columns */
} imki_repeats;

/* Begin with the channels that are analysed. */
void imki_repeats_start(imki_repeats *repeats, size_t count, const int *channel,
                        const imk_log_column *columns);
/* Count in some rows of the log, one array for each column. */
void imki_repeats_add(imki_repeats *repeats, size_t rows, double *const *columns);
/* Tell of sensors that are slower than the log, whose samples are held or stand in every second row
 * only, of rows that are written again, and of columns that
 * are copies.
 * @param columns  of the log  @param dt  of the log [s] */
void imki_repeats_tell(imki_repeats *repeats, const imk_log_column *columns, double dt,
                       imk_findings *findings);

#endif
