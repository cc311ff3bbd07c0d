/* SPDX-License-Identifier: Apache-2.0 */
/* A record in windows of a second, and the motion they show. */
#ifndef IMUKI_INFO_LOG_INTERNAL_H
#define IMUKI_INFO_LOG_INTERNAL_H

#include "imukit/info_log.h"

enum {
    IMKI_INFO_AXES = 6,          /* three gyros, three accelerometers */
    IMKI_INFO_WINDOW_ROWS = 16,  /* at least */
    IMKI_INFO_WINDOWS = 1 << 14, /* kept; of a longer record every second one, fourth … */
    IMKI_INFO_SAMPLE = 1 << 14   /* rows that show the step between values */
};

/* Mean and scatter of a window [SI]. */
typedef struct imki_info_window {
    double mean[IMKI_INFO_AXES], scatter[IMKI_INFO_AXES];
    bool follows; /* the window before stands right before it */
} imki_info_window;

/* Sums of a column. */
typedef struct imki_info_sums {
    double sum, squares;                       /* of the window at present */
    bool hole;                                 /* in the window: a value that is none */
    double total;                              /* of all rows */
    double within;                             /* sum of squares about the means of windows */
    size_t degrees;                            /* of it */
    size_t at_low, at_high, run_low, run_high; /* rows at the extremes in runs, and in this run */
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

/* Begin a place: the rows to come do not follow those before. */
void imki_info_rows_begin(imki_info_rows *r);
void imki_info_rows_add(imki_info_rows *r, size_t rows, double *const *column);
/* Figures of the columns; the motion. */
/* @param scratch  IMKI_INFO_SAMPLE numbers */
void imki_info_rows_end(imki_info_rows *r, double *scratch);
/* @param rests,sorted  room for a number of each window */
void imki_info_motion(imki_info_rows *r, double *rests, double *sorted);

#endif
