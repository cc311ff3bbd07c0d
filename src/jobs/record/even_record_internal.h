/* SPDX-License-Identifier: Apache-2.0 */
/* From the rows of a log to equal spacing. */
#ifndef IMUKI_EVEN_RECORD_INTERNAL_H
#define IMUKI_EVEN_RECORD_INTERNAL_H

#include "imukit/even_record.h"

/* IMK_GAPS_REFUSE, _BRIDGE, _LONGEST of a loaded log. */
imk_status imki_space_evenly(double rate, imk_gap_policy gaps, imk_even_record *record,
                             imk_findings *findings, imk_error *error);
/* IMK_GAPS_KEEP: every row on its place of the grid, NaN where there is none. */
imk_status imki_keep_grid(double rate, imk_even_record *record, imk_findings *findings,
                          imk_error *error);

/* The places of rows on the even grid of their times, one row after the other. A row has its place
 * round(step/interval) behind the row before; one whose time is not finite or not later is left
 * out. */
typedef struct imki_grid {
    double interval;              /* [s] */
    double first_time, last_time; /* [s], of rows taken */
    size_t places;                /* so far */
    size_t rows;                  /* of the log, also those left out */
    bool leaps;                   /* far more places than rows: a jump of the clock; no grid */
} imki_grid;

/* How many places further the next row is; 0: it is left out. What is missing is counted. */
size_t imki_grid_step(imki_grid *grid, double time, imk_even_record *record);

/* Scatter of the steps that is told [% of the interval]. */
enum { IMKI_JITTER_TOLD = 5 };

/* Refuse, or tell of, times that scatter: record->log.findings against record->dt. */
imk_status imki_grid_jitter(const imk_even_record *record, imk_findings *findings,
                            imk_error *error);
/* What was found on the way to the grid, in one finding each. */
void imki_grid_tell(const imk_even_record *record, size_t first_not_finite, imk_findings *findings);

/* Tell of columns that resemble those of the first `kinds` kinds of sensors and are none: a note,
 * or a warning where an axis lacks between others of its sensor, or the whole sensor.
 * @return a whole sensor is not read */
bool imki_tell_unused(size_t count, const imk_log_column *columns, int kinds,
                      imk_findings *findings);
/* The same of a record whose channels are chosen. */
void imki_even_record_unused(const imk_even_record *record, imk_findings *findings);
/* Tell of columns that depend on the axes of the sensors and kept their own where these were
 * turned: attitudes, velocities, vectors that are of no sensor. */
void imki_tell_not_turned(const imk_record_source *source, size_t count,
                          const imk_log_column *columns, imk_findings *findings);

/* The whole of a source. */
imk_status imki_record_load(const imk_record_source *source, const imk_job *job, imk_log *log,
                            imk_error *error);

#endif
