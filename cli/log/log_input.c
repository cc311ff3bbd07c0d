/* SPDX-License-Identifier: Apache-2.0 */
/* The common options of verbs that read logs, and loading one. */
#include "log_input.h"

#include "shell/progress.h"

#include "imukit/samples.h"

#include <math.h>
#include <string.h>

const option log_input_options[LOG_INPUT_OPTIONS] = {
    {"rate", 'r', OPTION_QUANTITY, "RATE", "Hz", "1e-9..1e9",
     "sample rate, needed when the log has no time column", offsetof(log_input, rate)},
    {"columns", 0, OPTION_TEXT, "NAMES", NULL, NULL,
     "names of the columns of a log without header, such as time,gyro_x,gyro_y,gyro_z; - skips one",
     offsetof(log_input, columns)},
    {"gyro-unit", 0, OPTION_TEXT, "UNIT", NULL, NULL,
     "unit of the gyro columns where the header has none, such as deg/s",
     offsetof(log_input, gyro_unit)},
    {"accel-unit", 0, OPTION_TEXT, "UNIT", NULL, NULL,
     "unit of the accelerometer columns where the header has none, such as g",
     offsetof(log_input, accel_unit)},
    {"time-unit", 0, OPTION_TEXT, "UNIT", NULL, NULL,
     "unit of the time column where the header has none, such as us",
     offsetof(log_input, time_unit)},
    {"temperature-unit", 0, OPTION_TEXT, "UNIT", NULL, NULL,
     "unit of the temperature column where the header has none, such as degC",
     offsetof(log_input, temperature_unit)},
    {"axes", 0, OPTION_TEXT, "NAMES", NULL, NULL,
     "where the log's x, y, z point, such as right-forward-up; mapped to forward-right-down",
     offsetof(log_input, axes)},
    {"gaps", 0, OPTION_CHOICE, "CHOICE", NULL, "refuse|bridge|longest|keep",
     "rows that are missing, not finite or out of order: keep their places empty (the default of "
     "allan and identify, which know how), refuse the log (the default elsewhere; gaps of up to "
     "0.1 % are bridged with a warning), interpolate over them, or use the longest clean stretch",
     offsetof(log_input, gaps)},
};

imk_log_settings log_input_settings(const log_input *input)
{
    imk_log_settings settings = imk_log_settings_default();
    settings.columns = input->columns;
    settings.gyro_unit = input->gyro_unit;
    settings.accel_unit = input->accel_unit;
    settings.time_unit = input->time_unit;
    settings.temperature_unit = input->temperature_unit;
    settings.rate = input->rate;
    settings.axes = input->axes;
    return settings;
}

/* Gyros in the order of their axes, then accelerometers; every other column when there are none. */
void log_choose_channels(log_channels *channels)
{
    const imk_log *log = &channels->log;
    static const imk_quantity kinds[] = {IMK_QUANTITY_ANGULAR_RATE, IMK_QUANTITY_SPECIFIC_FORCE};
    channels->count = 0;
    for (size_t k = 0; k < 2; k++) {
        for (int axis = 0; axis < IMK_AXES_MAX; axis++) {
            int column = imk_log_find(log, kinds[k], axis);
            if (column >= 0)
                channels->column[channels->count++] = column;
        }
    }
    if (channels->count > 0)
        return;
    for (size_t c = 0; c < log->column_count; c++)
        if (log->column[c].quantity == IMK_QUANTITY_OTHER && !log->column[c].label)
            channels->column[channels->count++] = (int)c;
}

void log_forget_faults(imk_log *log)
{
    for (size_t c = 0; c < log->column_count; c++) {
        if (log->column[c].quantity == IMK_QUANTITY_TIME || log->column[c].label)
            continue;
        for (size_t row = 0; row < log->rows; row++)
            if (!(fabs(log->data[c][row]) <= IMK_READING_MAX))
                log->data[c][row] = (double)NAN;
    }
}

int log_input_load(const log_input *input, const char *path, log_channels *channels)
{
    imk_error error;
    memset(channels, 0, sizeof *channels);
    if (input->gaps == GAPS_KEEP && !input->missing_allowed)
        return command_misused("--gaps keep: what this verb does needs every sample; use --gaps "
                               "bridge or --gaps longest");
    imk_log_settings settings = log_input_settings(input);
    char label[120];
    snprintf(label, sizeof label, "reading %.100s", path);
    progress p = progress_begin(label, "B", 1);
    imk_status status = imk_log_load(path, &settings, progress_update, &p, &channels->log, &error);
    progress_end(&p);
    if (status != IMK_OK)
        return command_log_error(&error, path);
    log_choose_channels(channels);
    log_forget_faults(&channels->log);
    int code = -1;
    if (channels->log.rows == 0)
        code = command_failed("%s: there is a header but no data row", path);
    else if (channels->count == 0)
        code = command_failed("%s: there is no column to analyse; name one with --columns, such "
                              "as gyro_x or accel_z",
                              path);
    else
        code = log_space_evenly(input, path, channels);
    if (code >= 0)
        log_channels_free(channels);
    return code;
}

void log_channels_free(log_channels *channels)
{
    imk_log_free(&channels->log);
    channels->count = 0;
}

const imk_log_column *log_channel_column(const log_channels *channels, size_t channel)
{
    return &channels->log.column[channels->column[channel]];
}

double *log_channel_data(const log_channels *channels, size_t channel)
{
    return channels->log.data[channels->column[channel]];
}

size_t log_channel_finite(const log_channels *channels, size_t channel)
{
    const double *data = log_channel_data(channels, channel);
    size_t count = 0;
    for (size_t row = 0; row < channels->rows; row++)
        count += isfinite(data[row]) != 0;
    return count;
}
