/* SPDX-License-Identifier: Apache-2.0 */
/* Logs of bench tests as records: columns as they are, rows with gaps as they are. Only rows whose
 * time does not increase are left out, because no sample interval belongs to them. */
#include "calibrate_internal.h"

#include "jobs/job_internal.h"
#include "jobs/record/even_record_internal.h"
#include "jobs/record/record_check_internal.h"
#include "jobs/record/record_stamps_internal.h"

#include "imukit/even_record.h"
#include "imukit/names.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Close up the rows whose time increases. */
static void drop_rows(imk_calibrate_record *log, int time, imk_findings *findings)
{
    imk_log *columns = &log->log;
    double last = -HUGE_VAL;
    size_t kept = 0;
    for (size_t row = 0; row < columns->rows; row++) {
        const double now = columns->data[time][row];
        if (!(now > last) || !isfinite(now))
            continue;
        last = now;
        for (size_t c = 0; c < columns->column_count && kept != row; c++)
            columns->data[c][kept] = columns->data[c][row];
        kept++;
    }
    log->dropped = columns->rows - kept;
    columns->rows = kept;
    if (log->dropped > 0)
        imki_find(findings, IMK_FINDING_WARNING, "calibrate:time_order", NULL,
                  IMKI_NUMBERS((double)log->dropped));
}

/* Axes beyond z have directions of their own, which only a model states: all before them must be
 * there. Of x, y and z some may be missing. */
static imk_status check_gap(imk_calibrate_record *log, int sensor, int axis, int axes,
                            imk_error *error)
{
    const char *key = imki_sensor_keys[sensor];
    char which[60];
    if (axis == axes || axis < 3)
        return IMK_OK;
    snprintf(which, sizeof which, "%s_%c but no %s_%c", key, imk_axis_letter(axis), key,
             imk_axis_letter(axes));
    return imki_fail(&log->loaded, error, IMK_ERROR_COLUMN, "axis_gap", which, 0, NULL);
}

/* Even times where the stamps are late, coarse or of a clock that jumps. Those that fit no rate
 * stay: a procedure needs times, but not evenly spaced ones. */
static imk_status settle_times(double rate, imk_calibrate_record *log, imk_findings *findings,
                               imk_error *error)
{
    const size_t before = findings->count;
    const imk_status status = imki_settle_times(rate, &log->log, findings, error);
    if (status != IMK_ERROR_TIME_ORDER)
        return status;
    findings->count = before;
    return IMK_OK;
}

/* The axes of one kind of sensor, in their order. */
static imk_status take_axes(imk_calibrate_record *log, int sensor, imk_findings *findings,
                            imk_error *error)
{
    static const imk_quantity kinds[2] = {IMK_QUANTITY_ANGULAR_RATE, IMK_QUANTITY_SPECIFIC_FORCE};
    imk_test_record *record = &log->record;
    int axes = 0;
    for (int axis = 0; axis < IMK_AXES_MAX; axis++) {
        const int column = imk_log_find(&log->log, kinds[sensor], axis);
        if (column < 0)
            continue;
        const imk_status status = check_gap(log, sensor, axis, axes, error);
        if (status != IMK_OK)
            return status;
        const bool counts = imk_dimension_equal(log->log.column[column].unit.dimension,
                                                imk_unit_of("count").dimension);
        if (axes > 0 && counts != record->counts[sensor])
            return imki_fail(findings, error, IMK_ERROR_COLUMN, "counts_mixed",
                             imki_sensor_keys[sensor], 0, NULL);
        record->counts[sensor] = counts;
        log->body_axis[sensor][axes] = axis;
        record->reading[sensor][axes++] = log->log.data[column];
    }
    record->axis_count[sensor] = axes;
    return IMK_OK;
}

/* Columns of this name whose unit is missing are none of a magnetometer. */
static bool names_magnetometer(const imk_log *log)
{
    for (size_t c = 0; c < log->column_count; c++)
        if (strncmp(log->column[c].name, "mag_", 4) == 0 &&
            log->column[c].quantity != IMK_QUANTITY_MAGNETIC)
            return true;
    return false;
}

/* A magnetometer with three axes; else what there is of it is not looked at. */
static imk_status take_magnetometer(imk_calibrate_record *log, imk_findings *findings,
                                    imk_error *error)
{
    imk_test_record *record = &log->record;
    const bool wanted = log->procedure == IMK_PROCEDURE_MAGNETOMETER;
    int axes = 0;
    log->mag_counts = false;
    for (int i = 0; i < 3; i++) {
        const int column = imk_log_find(&log->log, IMK_QUANTITY_MAGNETIC, i);
        if (column < 0)
            continue;
        axes++;
        record->mag[i] = log->log.data[column];
        log->mag_counts =
            log->mag_counts || imk_dimension_equal(log->log.column[column].unit.dimension,
                                                   imk_unit_of("count").dimension);
    }
    if (axes < 3 || log->mag_counts)
        for (int i = 0; i < 3; i++)
            record->mag[i] = NULL;
    else
        log->mag = imk_magnetometer_look(record);
    if (wanted && log->mag_counts)
        return imki_fail(findings, error, IMK_ERROR_UNIT_MISSING, "mag_counts", NULL, 0, NULL);
    if (wanted && axes < 3 && names_magnetometer(&log->log))
        return imki_fail(findings, error, IMK_ERROR_UNIT_MISSING, "mag_counts", NULL, 0, NULL);
    if (wanted && axes < 3)
        return imki_fail(findings, error, IMK_ERROR_COLUMN, "no_magnetometer", NULL,
                         IMKI_NUMBERS(axes));
    if (!wanted && axes == 3 && record->axis_count[0] + record->axis_count[1] == 0)
        return imki_fail(findings, error, IMK_ERROR_COLUMN, "magnetometer_only", NULL, 0, NULL);
    return IMK_OK;
}

/* The column of this name, or the only one that holds texts; -1: there is none. */
static imk_status find_section(const imk_calibrate_record *log, const char *wanted, int *found,
                               imk_findings *findings, imk_error *error)
{
    const char *names[IMK_LOG_COLUMNS_MAX] = {NULL};
    size_t labels = 0;
    *found = -1;
    for (size_t c = 0; c < log->log.column_count; c++) {
        if (!log->log.column[c].label)
            continue;
        names[labels++] = log->log.column[c].name;
        if (!wanted || strcmp(wanted, names[labels - 1]) == 0)
            *found = (int)c;
    }
    if (wanted && *found < 0) {
        char words[96];
        const size_t nearest = imk_nearest_name(wanted, labels, names);
        const bool near = nearest < labels;
        snprintf(words, sizeof words, "%.47s\t%s", wanted, near ? names[nearest] : "");
        return imki_fail(findings, error, IMK_ERROR_COLUMN, "no_section", words,
                         IMKI_NUMBERS(near));
    }
    if (!wanted && labels > 1)
        return imki_fail(findings, error, IMK_ERROR_COLUMN, "sections", names[0],
                         IMKI_NUMBERS((double)labels));
    return IMK_OK;
}

static imk_status take_sections(imk_calibrate_record *log, int column, imk_error *error)
{
    const imk_allocator *allocator = &log->log.allocator;
    const size_t rows = log->log.rows, labels = log->log.label_count;
    if (column < 0)
        return IMK_OK;
    log->section = imki_resize(allocator, NULL, rows * sizeof *log->section);
    log->section_name = imki_resize(allocator, NULL, (labels + 1) * sizeof *log->section_name);
    if (!log->section || !log->section_name)
        return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
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
    return IMK_OK;
}

static void tell_missing(const imk_test_record *record, imk_findings *findings)
{
    size_t first;
    const size_t rows = imk_test_record_missing(record, &first);
    if (rows > 0)
        imki_find(findings, IMK_FINDING_WARNING, "calibrate:not_finite", NULL,
                  IMKI_NUMBERS((double)rows, (double)record->count, (double)first + 1));
}

/* Long enough for what is asked. */
static imk_status check_length(const imk_calibrate_log_settings *s, imk_calibrate_record *log,
                               imk_error *error)
{
    const struct {
        const char *name;
        double value;
    } times[] = {{"initial-rest", s->initial_rest}, {"window", s->window}, {"minimum", s->minimum}};
    const double length = (double)log->record.count * log->record.dt;
    if (log->record.count < 2)
        return imki_fail(&log->loaded, error, IMK_ERROR_TOO_SHORT, "one_row_of_test", NULL, 0,
                         NULL);
    for (size_t k = 0; k < sizeof times / sizeof times[0]; k++)
        if (times[k].value > length)
            return imki_fail(&log->loaded, error, IMK_ERROR_ARGUMENT, "longer_than_record",
                             times[k].name, IMKI_NUMBERS(times[k].value, length));
    return IMK_OK;
}

const char *imki_record_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

/* The columns of a loaded record as those of a test. */
static imk_status make_record(imk_calibrate_record *log, const char *section,
                              imk_findings *findings, imk_error *error)
{
    imk_log *columns = &log->log;
    imk_test_record *record = &log->record;
    const int time = imk_log_find(columns, IMK_QUANTITY_TIME, -1);
    const int temperature = imk_log_find(columns, IMK_QUANTITY_TEMPERATURE, -1);
    int column = -1;
    imk_log_forget_faults(columns);
    if (time >= 0 && !record->means)
        drop_rows(log, time, findings);
    if (columns->rows == 0)
        return imki_fail(findings, error, IMK_ERROR_EMPTY, "no_rows", NULL, 0, NULL);
    record->name = imki_record_name(log->path);
    record->count = columns->rows;
    record->dt = record->means ? 1.0 : columns->findings.interval;
    record->time = time >= 0 && !record->means ? columns->data[time] : NULL;
    record->temperature = temperature >= 0 ? columns->data[temperature] : NULL;
    imk_status status = take_axes(log, 0, findings, error);
    if (status == IMK_OK)
        status = take_axes(log, 1, findings, error);
    if (status == IMK_OK)
        status = take_magnetometer(log, findings, error);
    if (status == IMK_OK && record->axis_count[0] + record->axis_count[1] == 0 && !record->mag[0])
        status = imki_fail(findings, error, IMK_ERROR_COLUMN, "no_sensor", NULL, 0, NULL);
    if (status == IMK_OK)
        status = find_section(log, section, &column, findings, error);
    if (status == IMK_OK)
        status = take_sections(log, column, error);
    if (status == IMK_OK)
        imki_tell_unused(columns->column_count, columns->column, IMK_KINDS, findings);
    if (status == IMK_OK && !record->means) {
        tell_missing(record, findings);
        imki_tell_fill_rows(record, findings);
    }
    return status;
}

imk_status imk_calibrate_record_load(const imk_calibrate_log_settings *settings, const char *name,
                                     const imk_record_source *source, const imk_job *job,
                                     imk_calibrate_record *record, imk_error *error)
{
    const uint32_t cookie = imk_calibrate_log_default().cookie;
    imk_status status =
        imki_check_call(record, settings, cookie, "imk_calibrate_log_default()", error);
    if (status != IMK_OK)
        return status;
    const bool means = settings->pose_means && imk_procedure_takes_means(record->procedure);
    imk_calibrate_log_settings known = *settings;
    if (means)
        known.motion = NULL; /* a programme says when, a table does not */
    record->path = name;
    record->record.means = means;
    status = imki_record_load(source, imki_job_of(job), &record->log, error);
    if (status == IMK_OK)
        imki_tell_damage(source, &record->loaded);
    if (status == IMK_OK && !means)
        status = settle_times(source->rate, record, &record->loaded, error);
    if (status == IMK_OK)
        status = make_record(record, settings->section, &record->loaded, error);
    if (status == IMK_OK)
        status = means ? imki_take_means(settings, record, error)
                       : check_length(settings, record, error);
    if (status == IMK_OK)
        status = imki_take_reference(&known, record, error);
    return status;
}

void imk_calibrate_record_free(imk_calibrate_record *log)
{
    const imk_allocator allocator = log->log.allocator;
    imki_resize(&allocator, log->section, 0);
    imki_resize(&allocator, log->section_name, 0);
    imki_resize(&allocator, log->reference, 0);
    imki_resize(&allocator, log->mean_sigma, 0);
    imk_log_free(&log->log);
}
