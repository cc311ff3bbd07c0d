/* SPDX-License-Identifier: Apache-2.0 */
/* A record in windows of a second, and the motion they show. */
#ifndef IMUKI_INFO_LOG_INTERNAL_H
#define IMUKI_INFO_LOG_INTERNAL_H

#include "imukit/info_log.h"
#include "jobs/record/record_stamps_internal.h"

enum {
    IMKI_INFO_AXES = 6,          /* three gyros, three accelerometers */
    IMKI_INFO_WINDOW_ROWS = 16,  /* at least */
    IMKI_INFO_VALUES = 8,        /* of a column in a window, at least */
    IMKI_INFO_WINDOWS = 1 << 14, /* kept; of a longer record every second one, fourth … */
    IMKI_INFO_SAMPLE = 1 << 14   /* rows that show the step between values */
};

/* Mean and scatter of a window [SI]. */
typedef struct imki_info_window {
    double mean[IMKI_INFO_AXES], scatter[IMKI_INFO_AXES];
    bool follows; /* the window before stands right before it */
} imki_info_window;

/* An end of the range of a column: the lowest or the highest value. */
typedef struct imki_info_end {
    size_t rows, run; /* rows at it, and those that follow one another now */
    bool sticks;      /* three have followed one another */
} imki_info_end;

/* Sums of a column. */
typedef struct imki_info_sums {
    double sum, squares; /* of the window at present */
    double least, most;  /* in it */
    size_t values;       /* in it */
    double total;        /* of all rows */
    double within;       /* sum of squares about the means of windows */
    size_t degrees;      /* of it */
    imki_info_end low, high;
} imki_info_sums;

typedef struct imki_info_rows {
    imk_info_log *info;
    int axis[IMKI_INFO_AXES]; /* column of each; -1: none */
    bool counts[2];           /* gyros, accelerometers are in counts */
    size_t window_rows, in_window;
    imki_info_sums sums[IMK_LOG_COLUMNS_MAX];
    double *sample[IMK_LOG_COLUMNS_MAX];
    size_t sampled;
    imki_info_window *window;
    size_t window_count, stride, passed;
    bool follows;
} imki_info_rows;

/* Stamps of the first place. */
typedef struct imki_info_stamps {
    imki_stamps stamps;
    bool failed;     /* memory is exhausted, or there are none */
    bool settled;    /* they are no sample times */
    double interval; /* then [s]; 0: none */
} imki_info_stamps;

void imki_info_stamps_add(imki_info_stamps *stamps, size_t rows, double *const *column);
/* Where the stamps are no sample times: interval, gaps, and what is told of them.
 * @param found  of the stamps as they are */
void imki_info_stamps_settle(imki_info_stamps *stamps, imk_info_log *info,
                             const imk_log_findings *found);

/* Begin a place: the rows to come do not follow those before. */
void imki_info_rows_begin(imki_info_rows *r);
void imki_info_rows_add(imki_info_rows *r, size_t rows, double *const *column);
/* Figures of the columns; the motion. */
/* @param scratch  IMKI_INFO_SAMPLE numbers */
void imki_info_rows_end(imki_info_rows *r, double *scratch);
/* @param rests,sorted  room for a number of each window */
void imki_info_motion(imki_info_rows *r, double *rests, double *sorted);

#endif
