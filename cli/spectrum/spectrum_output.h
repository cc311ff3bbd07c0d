/* SPDX-License-Identifier: Apache-2.0 */
/* The parts of `imukit spectrum`: what was asked, what was found, and the ways to show it. */
#ifndef IMUKIT_SPECTRUM_OUTPUT_H
#define IMUKIT_SPECTRUM_OUTPUT_H

#include "log/channel_units.h"
#include "log/log_input.h"

#include "imukit/spectrum.h"

typedef struct spectrum_options {
    log_input log;
    int method, window, density;
    double resolution, from, to, confidence, false_alarm;
    const char *output, *plot, *report;
    bool trend, json;
    option_integer threads;
} spectrum_options;

enum { SPECTRUM_LINES_MAX = 64, SPECTRUM_PLOTTED_PER_DECADE = 100, SPECTRUM_TABLE_PER_DECADE = 4 };

/* What was found on one channel. */
typedef struct channel_spectrum {
    imk_status status;
    imk_error error;
    imk_spectrum spectrum; /* its arrays are in `memory` */
    double *memory;
    size_t line_count;
    imk_spectrum_line line[SPECTRUM_LINES_MAX];
    size_t plotted_count, table_count;
    imk_spectrum_band *plotted; /* fine, lines in them */
    imk_spectrum_band *table;   /* coarse, lines left out */
    imk_status fit_status;
    imk_spectrum_parameters fit;
} channel_spectrum;

typedef struct spectrum_result {
    const spectrum_options *options;
    const char *path;
    log_channels channels;
    channel_spectrum found[IMK_LOG_COLUMNS_MAX];
} spectrum_result;

/* 2 for a one-sided density, else 1. */
double spectrum_sides(const spectrum_result *result);
/* Unit a person reads the root of the densities of one kind of channels in, without /sqrt(Hz); its
 * scale is 0 when there are none. */
imk_unit spectrum_root_unit(const spectrum_result *result, channel_kind kind);
/* "two-sided" */
const char *spectrum_sides_text(const spectrum_result *result);

/* Each returns -1 or the exit code, the message printed. */
int spectrum_write_csv(const spectrum_result *result, const char *output);
int spectrum_print_json(const spectrum_result *result);
void spectrum_print_tables(const spectrum_result *result);
int spectrum_draw(const spectrum_result *result, const char *plot);
int spectrum_write_report(const spectrum_result *result, const char *path);

#endif
