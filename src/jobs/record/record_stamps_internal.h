/* SPDX-License-Identifier: Apache-2.0 */
/* Stamps that are no sample times: coarse, bunched, late, from a clock that jumps. */
#ifndef IMUKI_RECORD_STAMPS_INTERNAL_H
#define IMUKI_RECORD_STAMPS_INTERNAL_H

#include "imukit/even_record.h"

/* One way to read the stamps: what is assumed, and what follows from it. Numbers in intervals. */
typedef struct imki_stamp_reading {
    double interval;  /* [s] */
    double threshold; /* a delay that stays is a loss of rows if it is longer */
    size_t window;    /* rows among which one comes without delay */
    double usual;     /* rows with a longer delay are late */
    /* what follows */
    size_t rows;
    double down;  /* sum of the steps back that nothing explains, each counted up to 2 */
    size_t jumps; /* the clock steps back for good */
    double largest_jump;
    double up; /* lost rows, of each loss up to 3 */
    size_t losses, lost, longest_loss;
    size_t late;
    double latest; /* of all rows */
    double drift;  /* of the interval: this much longer or shorter [s] */
} imki_stamp_reading;

/* Read the stamps of n rows, NaN where a stamp is missing.
 * @param even  receives the evenly spaced times [s]; NULL: only the reading is wanted */
void imki_read_stamps(size_t n, const double *time, imki_stamp_reading *reading, double *even);

/* The interval by the majority of steps; by the rows per stamp; by the long run. 0: it has none.
 * `scratch` holds 2 n + 4096 numbers. */
typedef struct imki_stamp_intervals {
    double steps, groups, long_run;
    double rows_per_stamp, most_rows_per_stamp; /* mean, most */
    double between;                             /* median of the positive steps [s] */
} imki_stamp_intervals;

imki_stamp_intervals imki_stamp_intervals_of(size_t n, const double *time, double *scratch);

/* Are these times none of evenly spaced samples, or not of the rate that was stated (0: none)? */
bool imki_stamps_uneven(double rate, const imk_log_findings *found);

/* The times of a record as they are read, block by block, and what became of them. */
typedef struct imki_stamps {
    imk_allocator allocator;
    size_t rows, room;
    double *time; /* [s] of each row; evenly spaced after imki_stamps_settle() */
    bool *same;   /* stamp and values are those of the row before */
    size_t column_count, time_column;
    double last[IMK_LOG_COLUMNS_MAX];
    size_t repeated, doubled; /* rows with the stamp of the row before; with its values, too */
} imki_stamps;

/* Begin with zeros, the allocator and the columns. Add rows; columns that are NULL are not
 * compared.
 * @return false: memory is exhausted */
bool imki_stamps_add(imki_stamps *stamps, size_t rows, double *const *columns);
void imki_stamps_free(imki_stamps *stamps);

/* Give every row the time of an evenly spaced sample where the stamps are no such times, and tell
 * what they are. Rows to be left out have the time of the row before.
 * @param rate   0: from the stamps; else the times are those of this rate
 * @param found  of the stamps; the interval, and the jitter, become those of the new times */
imk_status imki_stamps_settle(imki_stamps *stamps, double rate, imk_log_findings *found,
                              imk_findings *findings, imk_error *error);

/* Read the stamps of a source with rewind, progress and a time column, which is at its first row
 * then. Free them. */
imk_status imki_stamps_of_source(const imk_record_source *source, const imk_job *job,
                                 imki_stamps *stamps, imk_error *error);

/* The same with the times of a whole record, where its stamps need it. */
imk_status imki_settle_times(double rate, imk_log *log, imk_findings *findings, imk_error *error);

/* Tell of stamps on an even grid that are not those of one sensor at one rate. */
void imki_tell_steps(const imk_log_findings *found, imk_findings *findings);

/* Tell of a stated rate (0: none) that is not that of the stamps, 1/own. */
void imki_tell_rate(double rate, double own, imk_findings *findings);

#endif
