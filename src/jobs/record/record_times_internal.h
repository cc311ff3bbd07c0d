/* SPDX-License-Identifier: Apache-2.0 */
/* Gaps, repeats, reversals and jitter of the times of a log, in bounded memory. */
#ifndef IMUKI_RECORD_TIMES_INTERNAL_H
#define IMUKI_RECORD_TIMES_INTERNAL_H

#include "imukit/record.h"

/* Steps are assessed in groups of this many. Median of the groups' medians is the remedian
 * [ROUSSEEUW1990]; with two levels of medians kept it covers 4096^2 groups. */
enum { IMKI_STEP_GROUP = 4096 };

typedef struct imki_record_step {
    double size; /* [s], > 0 */
    size_t row;
} imki_record_step;

/* What neighbouring steps have to do with each other. */
typedef struct imki_step_pattern {
    size_t steps, gap_row, gap_distance, steady_gaps;
    double last, sum, square_sum, product_sum; /* of step/interval - 1, 1 at most */
} imki_step_pattern;

typedef struct imki_record_times {
    imk_log_findings findings; /* without those of the pending group */
    double given_interval;     /* 1/rate [s], 0: median */
    double last_time;          /* NaN: none, or not finite */
    size_t times;              /* finite ones */
    size_t pending, groups, upper_groups;
    imki_record_step step[IMKI_STEP_GROUP];
    double median[IMKI_STEP_GROUP]; /* of whole groups */
    double upper[IMKI_STEP_GROUP];  /* of 4096 groups each */
    double reference;               /* [s], the first median: deviations are summed from it */
    size_t regular;                 /* steps that are no gap */
    double deviation_sum, deviation_square_sum;
    imki_step_pattern pattern;
} imki_record_times;

/* Begin with a structure of zeros: clearing its 128 KiB again takes longer than reading a short
 * log. */
void imki_record_times_start(imki_record_times *times, double given_interval);

/* Add the times of rows first_row, first_row + 1, … */
void imki_record_times_add(imki_record_times *times, size_t first_row, size_t count,
                           const double *time);

/* Findings with the pending steps, which stay pending. */
imk_log_findings imki_record_times_findings(const imki_record_times *times);

#endif
