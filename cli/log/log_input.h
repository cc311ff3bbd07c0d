/* SPDX-License-Identifier: Apache-2.0 */
/* Reading a log for analysis: the options every such verb takes, loading with progress, and equally
 * spaced channels out of rows that may have gaps. */
#ifndef IMUKIT_LOG_INPUT_H
#define IMUKIT_LOG_INPUT_H

#include "shell/command.h"

#include "imukit/log.h"

typedef enum gap_policy { GAPS_REFUSE = 0, GAPS_BRIDGE, GAPS_LONGEST, GAPS_KEEP } gap_policy;

/* What the options of log_input_options fill. */
typedef struct log_input {
    double rate; /* [Hz]; 0: from the time column */
    const char *columns, *gyro_unit, *accel_unit, *time_unit, *temperature_unit, *axes;
    int gaps; /* gap_policy; a verb that can do with missing samples begins with GAPS_KEEP */
    bool missing_allowed; /* it can: --gaps keep is no error */
} log_input;

/* How to read a file, and last what analysis does about gaps, which conversion leaves out. */
enum { LOG_INPUT_OPTIONS = 8, LOG_FORMAT_OPTIONS = LOG_INPUT_OPTIONS - 1 };
extern const option log_input_options[LOG_INPUT_OPTIONS];

imk_log_settings log_input_settings(const log_input *input);

/* Equally spaced channels of a log. */
typedef struct log_channels {
    imk_log log;                     /* owns the memory */
    size_t count, rows;              /* channels analysed; rows of each */
    int column[IMK_LOG_COLUMNS_MAX]; /* of the log: gyros, then accelerometers, or all others */
    double dt;                       /* [s] */
    size_t bridged;                  /* samples that were interpolated */
    /* With GAPS_KEEP: rows of the grid that no row of the log fills (NaN in all channels), in how
     * many holes, the longest; rows of the log left out because their time is not later than that
     * of the row before; rows with a value that is not finite in some channel. */
    size_t missing, holes, longest_hole, unordered, not_finite;
    const double *temperature; /* of each row; NULL without a column, or after bridging */
} log_channels;

/* Load a log and make its channels equally spaced by the policy on gaps. Messages are printed.
 * @return -1 or the exit code */
int log_input_load(const log_input *input, const char *path, log_channels *channels);
void log_channels_free(log_channels *channels);
/* The channels among the columns of channels->log. */
void log_choose_channels(log_channels *channels);
/* Numbers that are no readings become NaN: missing. Times stay. */
void log_forget_faults(imk_log *log);

const imk_log_column *log_channel_column(const log_channels *channels, size_t channel);
double *log_channel_data(const log_channels *channels, size_t channel);
/* How many rows of the channel are finite numbers. */
size_t log_channel_finite(const log_channels *channels, size_t channel);

/* Equal spacing of rows (log_spacing.c, log_grid.c). @return -1 or the exit code, the message
 * printed */
int log_space_evenly(const log_input *input, const char *path, log_channels *channels);
/* GAPS_KEEP: every row on its place of the grid, NaN where there is none. */
int log_keep_grid(const log_input *input, const char *path, log_channels *channels);
/* Refuse, or tell of, times that scatter: channels->log.findings against channels->dt.
 * @return -1 or the exit code */
int log_grid_jitter(const char *path, const log_channels *channels);
/* What was found on the way to the grid, in one warning each. */
void log_grid_tell(const log_channels *channels, size_t first_not_finite);
/* More empty places than this for every row are a jump of the clock, not missing samples. */
enum { LOG_EMPTY_MOST = 20 };

#endif
