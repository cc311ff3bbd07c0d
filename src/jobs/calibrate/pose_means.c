/* SPDX-License-Identifier: Apache-2.0 */
/* Tables of pose means: a row has the mean readings of one pose at rest, and in columns beside them
 * how well these are known:
 *
 *     gyro_x_std, accel_x_std …            standard deviation s of the samples; with a column
 *                                          `samples`, their number n, sigma of the mean is
 * s/sqrt(n) gyro_x_std_of_mean …                 sigma itself
 *
 * Counts that scatter by less than their step q = 1 do not average out; by [WIDROW2008] that adds
 * q^2/12 exp(-2 pi^2 (s^2 - q^2/12)/q^2) to the variance of the mean, as in static_summary.c.
 *
 * A table that says nothing gets equal sigmas of some size; the solution replaces them by what the
 * residuals show (calibrate_solve.c). */
#include "calibrate_internal.h"

#include "jobs/job_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum {
    FEW_ROWS = 64,      /* so few may be of any order */
    ROWS_OF_HAND = 500, /* more poses than anybody sets by hand */
    ROWS_OF_LOG = 1000
};

/* Of the extent of the readings: rows that differ by more are in different attitudes, 11 deg. */
static const double jump = 0.1;
/* Of the size of the force: the readings of one attitude extend over less. */
static const double one_attitude = 0.3;

/* ---- table or log ---------------------------------------------------------------------------- */

/* How the accelerometers of rows differ. */
typedef struct variety {
    double extent; /* largest less smallest reading, of the axis where that is most */
    double amount; /* of the force, root mean square */
    double jumps;  /* share of the rows that are far from the row before */
} variety;

static variety variety_of(const imk_test_record *record)
{
    variety v = {0, 0, 0};
    double square = 0, jumps = 0;
    for (int axis = 0; axis < record->axis_count[1]; axis++) {
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (size_t row = 0; row < record->count; row++) {
            const double now = record->reading[1][axis][row];
            low = now < low ? now : low;
            high = now > high ? now : high;
            square += isfinite(now) ? now * now : 0;
        }
        v.extent = high - low > v.extent ? high - low : v.extent;
    }
    for (size_t row = 1; row < record->count; row++) {
        bool far = false;
        for (int axis = 0; axis < record->axis_count[1]; axis++)
            far = far || fabs(record->reading[1][axis][row] - record->reading[1][axis][row - 1]) >
                             jump * v.extent;
        jumps += far;
    }
    v.amount = sqrt(square / (double)record->count);
    v.jumps = record->count > 1 ? jumps / (double)(record->count - 1) : 0;
    return v;
}

bool imk_calibrate_looks_like_means(const imk_calibrate_record *log)
{
    const imk_test_record *record = &log->record;
    if (record->count < 4 || record->count > ROWS_OF_HAND || record->axis_count[1] < 3)
        return false;
    const variety v = variety_of(record);
    return v.jumps >= 0.5 && v.extent > one_attitude * v.amount;
}

/* Rows follow each other as samples do, or there are too many for poses. */
static bool looks_like_log(const imk_test_record *record)
{
    if (record->count < FEW_ROWS || record->axis_count[1] == 0)
        return record->count > ROWS_OF_LOG;
    const variety v = variety_of(record);
    return record->count > ROWS_OF_LOG || v.jumps < 0.5 ||
           (!record->counts[1] && v.extent < one_attitude * v.amount);
}

/* ---- columns --------------------------------------------------------------------------------- */

/* Columns of one axis: index, or -1. */
typedef struct spread_columns {
    int of_samples, of_mean;
} spread_columns;

static void name_axis(const imk_calibrate_record *log, int sensor, int axis, char text[20])
{
    snprintf(text, 20, "%s_%c", imki_sensor_keys[sensor],
             imk_axis_letter(log->body_axis[sensor][axis]));
}

static imk_status find_spread(imk_calibrate_record *log, int sensor, int axis,
                              spread_columns *found, imk_error *error)
{
    char name[20], full[48], words[96];
    const char *unit = log->record.counts[sensor] ? "count" : imki_sensor_units[sensor];
    name_axis(log, sensor, axis, name);
    snprintf(full, sizeof full, "%s_std", name);
    imk_status status = imki_find_column(log, full, unit, &found->of_samples, error);
    snprintf(full, sizeof full, "%s_std_of_mean", name);
    if (status == IMK_OK)
        status = imki_find_column(log, full, unit, &found->of_mean, error);
    if (status != IMK_OK || found->of_samples < 0 || found->of_mean < 0)
        return status;
    snprintf(words, sizeof words, "%s_std\t%s_std_of_mean", name, name);
    return imki_fail(&log->loaded, error, IMK_ERROR_COLUMN, "means_both", words, 0, NULL);
}

/* All axes of a sensor have such a column, or none. */
static imk_status find_spreads(imk_calibrate_record *log, int sensor,
                               spread_columns found[IMK_AXES_MAX], imk_error *error)
{
    const int axes = log->record.axis_count[sensor];
    int with = 0, without = -1;
    for (int axis = 0; axis < axes; axis++) {
        const imk_status status = find_spread(log, sensor, axis, &found[axis], error);
        if (status != IMK_OK)
            return status;
        const bool has = found[axis].of_samples >= 0 || found[axis].of_mean >= 0;
        with += has;
        without = has ? without : axis;
    }
    log->no_sigma[sensor] = axes > 0 && with == 0;
    if (with == 0 || with == axes)
        return IMK_OK;
    char name[20];
    name_axis(log, sensor, without, name);
    return imki_fail(&log->loaded, error, IMK_ERROR_COLUMN, "means_incomplete", name, 0, NULL);
}

static int find_samples(const imk_calibrate_record *log)
{
    for (size_t c = 0; c < log->log.column_count; c++)
        if (strcmp(log->log.column[c].name, "samples") == 0)
            return (int)c;
    return -1;
}

static imk_status refuse_value(imk_calibrate_record *log, const char *code, int column, size_t row,
                               double value, imk_error *error)
{
    return imki_fail(&log->loaded, error, IMK_ERROR_COLUMN, code, log->log.column[column].name,
                     IMKI_NUMBERS((double)row + 1, value, isfinite(value)));
}

static imk_status take_sigma(imk_calibrate_record *log, const spread_columns *from, int samples,
                             int sensor, double *sigma, imk_error *error)
{
    const bool counts = log->record.counts[sensor];
    static const double two_pi_squared = 19.739208802178716;
    const bool of_mean = from->of_mean >= 0;
    const int column = of_mean ? from->of_mean : from->of_samples;
    if (!of_mean && samples < 0)
        return imki_fail(&log->loaded, error, IMK_ERROR_COLUMN, "means_no_samples",
                         log->log.column[column].name, 0, NULL);
    for (size_t row = 0; row < log->record.count; row++) {
        const bool text = log->log.column[column].label;
        const double s = text ? (double)NAN : log->log.data[column][row];
        const bool constant = counts && !of_mean && s == 0;
        if (!(s > 0 && s < HUGE_VAL) && !constant)
            return refuse_value(log, "means_std", column, row, s, error);
        sigma[row] = s;
        if (of_mean)
            continue;
        const bool word = log->log.column[samples].label;
        const double n = word ? (double)NAN : log->log.data[samples][row];
        if (!(n >= 1 && n < HUGE_VAL))
            return refuse_value(log, "means_samples", samples, row, n, error);
        log->samples[sensor] += (n - log->samples[sensor]) / (double)(row + 1);
        const double before = fmax(0, s * s - 1.0 / 12);
        const double step = counts ? exp(-two_pi_squared * before) / 12 : 0;
        sigma[row] = sqrt(s * s / n + step);
    }
    return IMK_OK;
}

/* Equal sigmas, the size of which is to be found: of accelerometers a part of what gravity does, of
 * gyros a part of the scatter, which the noise is a part of. */
static void guess_sigmas(const imk_test_record *record, int sensor, double *sigma)
{
    const double part = sensor == 1 ? 1e-4 * variety_of(record).extent : 0;
    double square = 0;
    for (int axis = 0; sensor == 0 && axis < record->axis_count[0]; axis++) {
        const double *x = record->reading[0][axis];
        double sum = 0, squares = 0;
        for (size_t row = 0; row < record->count; row++)
            sum += x[row] / (double)record->count;
        for (size_t row = 0; row < record->count; row++)
            squares += (x[row] - sum) * (x[row] - sum);
        square += squares / ((double)record->count * record->axis_count[0]);
    }
    const double guess = sensor == 1 ? part : 0.1 * sqrt(square);
    for (size_t k = 0; k < record->count * (size_t)record->axis_count[sensor]; k++)
        sigma[k] = guess > 0 ? guess : 1e-9;
}

/* ---- readings -------------------------------------------------------------------------------- */

static imk_status check_readings(imk_calibrate_record *log, imk_error *error)
{
    const imk_test_record *record = &log->record;
    for (int sensor = 0; sensor < 2; sensor++)
        for (int axis = 0; axis < record->axis_count[sensor]; axis++) {
            char name[20];
            name_axis(log, sensor, axis, name);
            for (size_t row = 0; row < record->count; row++)
                if (!isfinite(record->reading[sensor][axis][row]))
                    return imki_fail(&log->loaded, error, IMK_ERROR_NOT_FINITE, "means_no_number",
                                     name, IMKI_NUMBERS((double)row + 1));
        }
    for (size_t row = 0; record->temperature && row < record->count; row++)
        if (!isfinite(record->temperature[row]))
            return imki_fail(&log->loaded, error, IMK_ERROR_NOT_FINITE, "means_no_number",
                             "temperature", IMKI_NUMBERS((double)row + 1));
    for (size_t c = 0; c < log->log.column_count; c++)
        if (log->log.column[c].increment)
            return imki_fail(&log->loaded, error, IMK_ERROR_COLUMN, "means_increments",
                             log->log.column[c].name, 0, NULL);
    return IMK_OK;
}

static bool equal_rows(const imk_test_record *record, size_t a, size_t b)
{
    for (int sensor = 0; sensor < 2; sensor++)
        for (int axis = 0; axis < record->axis_count[sensor]; axis++)
            if (record->reading[sensor][axis][a] != record->reading[sensor][axis][b])
                return false;
    return true;
}

/* A row that is there twice counts twice. */
static void tell_equal(imk_calibrate_record *log)
{
    enum { LOOKED_AT = 5000 };
    const imk_test_record *record = &log->record;
    size_t pairs = 0, first[2] = {0, 0};
    for (size_t row = 1; row < record->count && row < LOOKED_AT; row++)
        for (size_t before = 0; before < row; before++)
            if (equal_rows(record, row, before)) {
                if (pairs++ == 0)
                    first[0] = before, first[1] = row;
                break;
            }
    if (pairs > 0)
        imki_find(
            &log->loaded, IMK_FINDING_WARNING, "calibrate:equal_rows", NULL,
            IMKI_NUMBERS((double)first[0] + 1, (double)first[1] + 1, (double)pairs - 1, pairs > 1));
}

/* ---- all of it ------------------------------------------------------------------------------- */

static imk_status take_sigmas(imk_calibrate_record *log, int sensor, int samples,
                              const spread_columns *from, double *sigma, imk_error *error)
{
    imk_test_record *record = &log->record;
    imk_status status = IMK_OK;
    if (log->no_sigma[sensor])
        guess_sigmas(record, sensor, sigma);
    for (int axis = 0; status == IMK_OK && axis < record->axis_count[sensor]; axis++) {
        double *column = sigma + (size_t)axis * record->count;
        if (!log->no_sigma[sensor])
            status = take_sigma(log, &from[axis], samples, sensor, column, error);
        record->mean_sigma[sensor][axis] = column;
    }
    return status;
}

imk_status imki_take_means(const imk_calibrate_log_settings *s, imk_calibrate_record *log,
                           imk_error *error)
{
    imk_test_record *record = &log->record;
    spread_columns from[2][IMK_AXES_MAX];
    const int samples = find_samples(log);
    imk_status status = IMK_OK;
    if (s->motion && log->procedure == IMK_PROCEDURE_TUMBLE)
        return imki_fail(&log->loaded, error, IMK_ERROR_ARGUMENT, "means_motion", NULL, 0, NULL);
    for (int sensor = 0; status == IMK_OK && sensor < 2; sensor++)
        status = find_spreads(log, sensor, from[sensor], error);
    const bool stated = samples >= 0 || (!log->no_sigma[0] && record->axis_count[0] > 0) ||
                        (!log->no_sigma[1] && record->axis_count[1] > 0);
    if (status == IMK_OK && !stated && looks_like_log(record))
        status = imki_fail(&log->loaded, error, IMK_ERROR_CONFLICT, "means_of_log", NULL,
                           IMKI_NUMBERS((double)record->count));
    if (status == IMK_OK)
        status = check_readings(log, error);
    if (status != IMK_OK)
        return status;
    const size_t axes = (size_t)record->axis_count[0] + (size_t)record->axis_count[1];
    log->mean_sigma = imki_resize(&log->log.allocator, NULL, axes * record->count * sizeof(double));
    if (!log->mean_sigma)
        return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    double *place = log->mean_sigma;
    for (int sensor = 0; status == IMK_OK && sensor < 2; sensor++) {
        status = take_sigmas(log, sensor, samples, from[sensor], place, error);
        place += (size_t)record->axis_count[sensor] * record->count;
    }
    if (status == IMK_OK)
        tell_equal(log);
    return status;
}
