/* SPDX-License-Identifier: Apache-2.0 */
/* Rows that are written again much later: a log that stands there twice, a buffer that is
 * replayed. */
#ifndef IMUKI_RECORD_REPLAY_INTERNAL_H
#define IMUKI_RECORD_REPLAY_INTERNAL_H

#include "imukit/job.h"

#include <stdint.h>

enum { IMKI_REPLAY_WINDOW = 32, IMKI_REPLAY_SLOTS = 4096 };

/* A passage whose windows of rows came before, all `lag` rows earlier. */
typedef struct imki_passage_again {
    size_t lag;          /* 0: none */
    size_t first, last;  /* rows at which its first and last window ends */
    size_t before;       /* changes from row to row up to `first` */
    size_t changes;      /* from row to row, in it */
    bool from_the_start; /* no window that is remembered is earlier than the first one of it */
} imki_passage_again;

/* Of a sensor. Windows that are remembered are those whose hash is below a limit, which falls when
 * half of the slots are taken: the same windows in every passage, all over the log. */
typedef struct imki_replay {
    size_t rows, changes;                /* so far; unlike the row before */
    uint64_t recent[IMKI_REPLAY_WINDOW]; /* keys of the last rows */
    uint64_t window;                     /* hash of the last IMKI_REPLAY_WINDOW of them */
    uint64_t limit;
    size_t remembered, earliest;      /* windows; the row at which the first of them ends */
    uint64_t hash[IMKI_REPLAY_SLOTS]; /* 0: empty */
    size_t place[IMKI_REPLAY_SLOTS];
    imki_passage_again now, longest;
    size_t again; /* rows in all passages */
} imki_replay;

void imki_replay_start(imki_replay *replay);
/* Go on with rows. @param column  the channels of the sensor, as indices into `columns` */
void imki_replay_add(imki_replay *replay, size_t channels, const int *column, size_t rows,
                     double *const *columns);
/* Tell if rows are written again.
 * @param agreement  by imki_packets_agreement() @param name  of the sensor @param dt  of the log
 * [s]
 */
void imki_replay_tell(imki_replay *replay, double agreement, const char *name, double dt,
                      imk_findings *findings);

#endif
