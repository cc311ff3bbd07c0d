/* SPDX-License-Identifier: Apache-2.0 */
/* The parts of `imukit allan`: what was asked, and the ways to show what was found. */
#ifndef IMUKIT_ALLAN_OUTPUT_H
#define IMUKIT_ALLAN_OUTPUT_H

#include "log/allan_curve.h"
#include "log/log_input.h"
#include "shell/show.h"

typedef struct allan_options {
    log_input log;
    int edf, type, bias;
    const char *statistic, *tau, *output, *plot, *report;
    double confidence;
    bool json;
    option_integer threads;
} allan_options;

/* What was found: one curve per channel and statistic. */
typedef struct allan_result {
    const allan_options *options;
    const char *path;
    log_channels channels;
    size_t statistic_count;
    imk_allan_statistic statistic[IMK_ALLAN_STATISTICS];
    allan_curve curve[IMK_LOG_COLUMNS_MAX][IMK_ALLAN_STATISTICS];
} allan_result;

/* @return -1 or the exit code, the message printed */
int allan_write_csv(const allan_result *result, const char *output);
void allan_show(const allan_result *a, imk_result *result);

#endif
