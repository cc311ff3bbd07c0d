/* SPDX-License-Identifier: Apache-2.0 */
/* A log on its way through a compensator. */
#ifndef IMUKIT_COMPENSATE_STREAM_H
#define IMUKIT_COMPENSATE_STREAM_H

#include "compensate_parts.h"

/* What was met on the way; rows count from 1. */
typedef struct compensate_counts {
    uint64_t rows, any_flag, stretches, first_gap, temperatures_held;
    uint64_t times_missing, first_time_missing; /* whose time is no number */
    uint64_t flagged[IMK_FLAG_COUNT], first_flagged[IMK_FLAG_COUNT];
} compensate_counts;

typedef struct compensation {
    imk_model *model; /* what is taken out */
    imk_model *whole; /* the same before terms were selected */
    imk_log_reader *reader;
    compensate_columns columns;
    imk_compensator compensator;
    compensate_counts counts;
} compensation;

/* Read, correct, write. @return -1 or the exit code, the message printed */
int compensate_stream(const compensate_options *o, compensation *c, const char *log,
                      const char *name);

#endif
