/* SPDX-License-Identifier: Apache-2.0 */
/* Logs of bench tests: columns as they are, rows with gaps as they are. Only rows whose time does
 * not increase are left out, because no sample interval belongs to them. */
#include "calibrate_parts.h"

#include "shell/progress.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- rows ------------------------------------------------------------------------------------ */

/* Close up the rows whose time increases. */
static void drop_rows(bench_log *b, int time)
{
    imk_log *log = &b->log;
    double last = -HUGE_VAL;
    size_t kept = 0;
    for (size_t row = 0; row < log->rows; row++) {
        const double now = log->data[time][row];
        if (!(now > last) || !isfinite(now))
            continue;
        last = now;
        for (size_t c = 0; c < log->column_count && kept != row; c++)
            log->data[c][kept] = log->data[c][row];
        kept++;
    }
    b->dropped = log->rows - kept;
    log->rows = kept;
    if (b->dropped > 0)
        command_warn("time_order",
                     "%s: %zu rows whose time does not increase, or is no number, are left out",
                     b->path, b->dropped);
}

static void tell_missing(const bench_log *log)
{
    size_t first;
    const size_t rows = imk_test_record_missing(&log->record, &first);
    if (rows > 0)
        command_warn("not_finite",
                     "%s: in %zu of %zu rows a reading or the temperature is no finite number, or "
                     "beyond 1e60, first in row %zu: such rows are left out, or the hold or step "
                     "that they interrupt",
                     log->path, rows, log->record.count, first + 1);
}

/* ---- columns --------------------------------------------------------------------------------- */

static bool in_counts(const imk_log_column *column)
{
    return imk_dimension_equal(column->unit.dimension, imk_unit_of("count").dimension);
}

/* The axes of one kind of sensor, in their order. */
static int take_axes(bench_log *b, int sensor)
{
    static const imk_quantity kinds[2] = {IMK_QUANTITY_ANGULAR_RATE, IMK_QUANTITY_SPECIFIC_FORCE};
    imk_test_record *record = &b->record;
    int axes = 0;
    for (int axis = 0; axis < IMK_AXES_MAX; axis++) {
        const int column = imk_log_find(&b->log, kinds[sensor], axis);
        if (column < 0)
            continue;
        if (axis != axes)
            return command_failed("%s has %s_%c but no %s_%c: calibration needs the axes one after "
                                  "the other; name the columns with --columns",
                                  b->path, sensor_keys[sensor], imk_axis_letter(axis),
                                  sensor_keys[sensor], imk_axis_letter(axes));
        const bool counts = in_counts(&b->log.column[column]);
        if (axes > 0 && counts != record->counts[sensor])
            return command_failed("%s: some %s columns are in counts and some are not", b->path,
                                  sensor_keys[sensor]);
        record->counts[sensor] = counts;
        record->reading[sensor][axes++] = b->log.data[column];
    }
    record->axis_count[sensor] = axes;
    return -1;
}

/* The column of --section, or the only one that holds texts. */
static int find_section(const bench *b, const bench_log *log, int *found)
{
    const char *wanted = b->options->section;
    const char *names[IMK_LOG_COLUMNS_MAX];
    size_t labels = 0;
    *found = -1;
    for (size_t c = 0; c < log->log.column_count; c++) {
        if (!log->log.column[c].label)
            continue;
        names[labels++] = log->log.column[c].name;
        if (!wanted || strcmp(wanted, log->log.column[c].name) == 0)
            *found = (int)c;
    }
    if (wanted && *found < 0) {
        const char *nearest = command_nearest(wanted, labels, names);
        return command_failed("%s has no column \"%s\" of texts to divide it into sections%s%s%s",
                              log->path, wanted, nearest ? "; did you mean \"" : "",
                              nearest ? nearest : "", nearest ? "\"?" : "");
    }
    if (!wanted && labels > 1)
        return command_failed("%s has %zu columns of texts: say which one divides it into "
                              "sections, such as --section %s",
                              log->path, labels, names[0]);
    return -1;
}

static int take_sections(const bench *b, bench_log *log)
{
    int column;
    int code = find_section(b, log, &column);
    if (code >= 0 || column < 0)
        return code;
    const size_t rows = log->log.rows, labels = log->log.label_count;
    log->section = command_memory(NULL, rows * sizeof *log->section);
    log->section_name = command_memory(NULL, (labels + 1) * sizeof *log->section_name);
    for (size_t row = 0; row < rows; row++) {
        const double label = log->log.data[column][row];
        const bool none = !(label >= 0 && label < (double)labels);
        log->section[row] = none || !log->log.label[(size_t)label][0] ? -1 : (int)label;
    }
    for (size_t k = 0; k < labels; k++)
        log->section_name[k] = log->log.label[k];
    log->record.section = log->section;
    log->record.section_count = labels;
    log->record.section_name = log->section_name;
    return -1;
}

static int fill_record(const bench *b, bench_log *log)
{
    imk_log *l = &log->log;
    const int time = imk_log_find(l, IMK_QUANTITY_TIME, -1);
    const int temperature = imk_log_find(l, IMK_QUANTITY_TEMPERATURE, -1);
    if (time >= 0)
        drop_rows(log, time);
    if (l->rows == 0)
        return command_failed("%s: there is a header but no data row", log->path);
    imk_test_record *record = &log->record;
    const char *slash = strrchr(log->path, '/');
    record->name = slash ? slash + 1 : log->path;
    record->count = l->rows;
    record->dt = l->findings.interval;
    record->time = time >= 0 ? l->data[time] : NULL;
    record->temperature = temperature >= 0 ? l->data[temperature] : NULL;
    int code = take_axes(log, 0);
    if (code < 0)
        code = take_axes(log, 1);
    if (code < 0 && record->axis_count[0] + record->axis_count[1] == 0)
        code = command_failed("%s has no gyro and no accelerometer column; name them with "
                              "--columns, such as time,gyro_x,gyro_y,gyro_z,accel_x,accel_y,"
                              "accel_z",
                              log->path);
    if (code < 0)
        code = take_sections(b, log);
    if (code < 0)
        tell_missing(log);
    return code;
}

/* Long enough for what was asked. */
static int check_length(const calibrate_options *o, const bench_log *log)
{
    const struct {
        const char *option;
        double value;
    } times[] = {{"initial-rest", o->initial_rest}, {"window", o->window}, {"minimum", o->minimum}};
    const double length = (double)log->record.count * log->record.dt;
    if (log->record.count < 2)
        return command_failed("%s has one row of data; a test takes thousands, some seconds of "
                              "each pose or step",
                              log->path);
    for (size_t k = 0; k < sizeof times / sizeof times[0]; k++)
        if (times[k].value > length)
            return command_misused("--%s %.6gs is longer than %s, which has %.4g s",
                                   times[k].option, times[k].value, log->path, length);
    return -1;
}

int bench_load(bench *b, bench_log *log)
{
    imk_error error;
    char label[120];
    const imk_log_settings settings = log_input_settings(&b->options->log);
    snprintf(label, sizeof label, "reading %.100s", log->path);
    progress p = progress_begin(label, "B", 1);
    const imk_status status =
        imk_log_load(log->path, &settings, progress_update, &p, &log->log, &error);
    progress_end(&p);
    if (status != IMK_OK)
        return command_log_error(&error, log->path);
    log_forget_faults(&log->log);
    int code = fill_record(b, log);
    return code < 0 ? check_length(b->options, log) : code;
}
