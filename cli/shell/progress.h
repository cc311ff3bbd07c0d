/* SPDX-License-Identifier: Apache-2.0 */
/* A line of progress on standard error, only on a terminal and only for work that takes long. */
#ifndef IMUKIT_PROGRESS_H
#define IMUKIT_PROGRESS_H

#include <stdbool.h>
#include <stdint.h>

typedef struct progress {
    bool shown, visible;
    const char *label, *unit; /* "reading log.csv", "B" */
    double scale;             /* of one counted thing in `unit` */
    double start, last;       /* [s] */
} progress;

/* @param unit  of the rate shown, "rows"; @param scale units per counted thing */
progress progress_begin(const char *label, const char *unit, double scale);
void progress_update(progress *p, uint64_t done, uint64_t total);
/* Erase the line. */
void progress_end(progress *p);

#endif
