/* SPDX-License-Identifier: Apache-2.0 */
/* What the unit was exposed to: columns of the record beside the readings, or the programme that
 * the table ran, as means over the record's samples. */
#include "calibrate_internal.h"

#include "jobs/job_internal.h"

#include "imukit/random.h"
#include "imukit/samples.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* An offset is searched for so far on both sides, when the record is long enough [s]. */
static const double largest_shift = 10.0;
/* Correlation of readings and programme from which on they are taken to be of one motion. */
static const double followed = 0.5;
/* A drift between the halves of a record that is less does not reach from one step into the next
 * [s]: 0.2 s are left out at both ends of a step. */
static const double clock_tolerance = 0.1;
/* So much is left out at both ends of a step [s]: a shorter delay is that of a filter. */
static const double trimmed = 0.2;

static imk_status no_memory(imk_error *error)
{
    return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
}

/* One of the columns of references, zeros at first; NULL when memory is exhausted. */
static double *reference_column(imk_calibrate_record *log, int column)
{
    const size_t rows = log->record.count, size = IMK_CALIBRATE_REFERENCES * rows * sizeof(double);
    if (!log->reference) {
        log->reference = imki_resize(&log->log.allocator, NULL, size);
        if (!log->reference)
            return NULL;
        memset(log->reference, 0, size);
    }
    return log->reference + (size_t)column * rows;
}

/* ---- columns --------------------------------------------------------------------------------- */

imk_status imki_find_column(imk_calibrate_record *log, const char *name, const char *unit,
                            int *found, imk_error *error)
{
    *found = -1;
    for (size_t c = 0; c < log->log.column_count; c++) {
        char words[96];
        const imk_log_column *column = &log->log.column[c];
        const imk_dimension due = imk_unit_of(unit).dimension;
        if (strcmp(column->name, name) != 0)
            continue;
        *found = (int)c;
        snprintf(words, sizeof words, "%s\t%s", name, unit);
        if (!column->unit.text[0])
            return imki_fail(&log->loaded, error, IMK_ERROR_UNIT_MISSING, "calibrate:no_unit",
                             words, 0, NULL);
        snprintf(words, sizeof words, "%s [%.24s]\t%s, such as %s", name, column->unit.text,
                 imk_dimension_name(due), unit);
        if (!imk_dimension_equal(column->unit.dimension, due))
            return imki_fail(&log->loaded, error, IMK_ERROR_DIMENSION, "wrong_unit", words, 0,
                             NULL);
    }
    return IMK_OK;
}

/* reference_rate_x … of one vector: the components that are not there are zero. */
static imk_status take_vector(imk_calibrate_record *log, const char *name, const char *unit,
                              const double *target[3], imk_error *error)
{
    int column[3];
    for (int k = 0; k < 3; k++) {
        char full[48];
        snprintf(full, sizeof full, "%s_%c", name, "xyz"[k]);
        const imk_status status = imki_find_column(log, full, unit, &column[k], error);
        if (status != IMK_OK)
            return status;
    }
    if (column[0] < 0 && column[1] < 0 && column[2] < 0)
        return IMK_OK;
    const double *zero = reference_column(log, 0);
    for (int k = 0; k < 3; k++)
        target[k] = column[k] < 0 ? zero : log->log.data[column[k]];
    return zero ? IMK_OK : no_memory(error);
}

/* table_rate, about an axis of the unit that is named. */
static imk_status take_table(const imk_calibrate_log_settings *s, imk_calibrate_record *log,
                             imk_error *error)
{
    int column;
    const imk_status status = imki_find_column(log, "table_rate", "deg/s", &column, error);
    if (status != IMK_OK)
        return status;
    if (column < 0)
        return s->table_axis >= 0 && log->procedure == IMK_PROCEDURE_RATE_TABLE
                   ? imki_fail(&log->loaded, error, IMK_ERROR_COLUMN, "no_table_rate", NULL, 0,
                               NULL)
                   : IMK_OK;
    if (s->table_axis < 0 || s->table_axis > 2)
        return imki_fail(&log->loaded, error, IMK_ERROR_ARGUMENT, "no_table_axis", NULL, 0, NULL);
    const double *zero = reference_column(log, 0);
    log->record.reference_on_ground = true;
    for (int k = 0; k < 3; k++)
        log->record.reference_rate[k] = k == s->table_axis ? log->log.data[column] : zero;
    return zero ? IMK_OK : no_memory(error);
}

/* ---- programme ------------------------------------------------------------------------------- */

static void fill_from_recorded(const imk_recorded_motion *motion, imk_calibrate_record *log,
                               double *const column[IMK_CALIBRATE_REFERENCES])
{
    for (size_t row = 0; row < log->record.count; row++) {
        const double place = floor(
            (imk_test_record_time(&log->record, row) - log->motion_offset) * motion->rate + 0.5);
        const bool inside = place >= 0 && place < (double)motion->count;
        const size_t k = inside ? (size_t)place : 0;
        for (int i = 0; i < 3; i++) {
            column[i][row] = inside ? motion->angular_rate[i][k] : (double)NAN;
            column[3 + i][row] = inside ? motion->specific_force[i][k] : (double)NAN;
            column[6 + i][row] = !inside ? (double)NAN
                                 : motion->angular_acceleration[i]
                                     ? motion->angular_acceleration[i][k]
                                     : 0;
        }
    }
}

/* Means over stretches without gap: sample k covers the sample interval that ends at its time. */
static imk_status fill_from_trajectory(const imk_trajectory *trajectory, imk_calibrate_record *log,
                                       double *const column[IMK_CALIBRATE_REFERENCES])
{
    const imk_test_record *record = &log->record;
    const imk_random random = imk_random_seeded(0);
    const imk_allocator *allocator = &log->log.allocator;
    double *boundary = imki_resize(allocator, NULL, (record->count + 1) * sizeof *boundary);
    if (!boundary)
        return IMK_ERROR_MEMORY;
    for (size_t begin = 0, end; begin < record->count; begin = end) {
        double now = imk_test_record_time(record, begin);
        boundary[0] = now - record->dt - log->motion_offset;
        boundary[1] = now - log->motion_offset;
        for (end = begin + 1; end < record->count; end++) {
            const double next = imk_test_record_time(record, end);
            if (imk_step_is_gap(next - now, record->dt))
                break;
            now = next;
            boundary[end - begin + 1] = now - log->motion_offset;
        }
        double *at[IMK_CALIBRATE_REFERENCES];
        for (int i = 0; i < IMK_CALIBRATE_REFERENCES; i++)
            at[i] = column[i] + begin;
        imk_trajectory_means(trajectory, random.kernel, end - begin, boundary, at, at + 6, at + 3);
    }
    imki_resize(allocator, boundary, 0);
    return IMK_OK;
}

/* References by a motion that begins at log->motion_offset; NaN outside a recorded one. */
static imk_status expose(imk_calibrate_record *log, const imk_motion *motion, imk_error *error)
{
    double *column[IMK_CALIBRATE_REFERENCES];
    for (int i = 0; i < IMK_CALIBRATE_REFERENCES; i++)
        if (!(column[i] = reference_column(log, i)))
            return no_memory(error);
    for (int i = 0; i < 3; i++) {
        log->record.reference_rate[i] = column[i];
        log->record.reference_force[i] = column[3 + i];
        log->record.reference_acceleration[i] = column[6 + i];
    }
    if (!motion->trajectory) {
        fill_from_recorded(motion->recorded, log, column);
        return IMK_OK;
    }
    if (fill_from_trajectory(motion->trajectory, log, column) == IMK_OK)
        return IMK_OK;
    return no_memory(error);
}

/* Where readings follow the references best. */
static imk_status find_shift(const imk_test_record *record, const imk_allocator *allocator,
                             imk_reference_shift *shift, imk_error *error)
{
    const double length = (double)record->count * record->dt;
    const double most = fmin(largest_shift, length / 4);
    const size_t size = imk_reference_offset_workspace_size(record, most);
    void *workspace = imki_resize(allocator, NULL, size);
    if (!workspace)
        return no_memory(error);
    const imk_status status = imk_reference_offset(record, most, shift, workspace, size, error);
    imki_resize(allocator, workspace, 0);
    return status;
}

/* Another beginning of the programme, if it fits nearly as well. */
static void tell_rival(imk_calibrate_record *log, const imk_reference_shift *shift)
{
    if (shift->rival > 0.95 * shift->correlation)
        imki_find(&log->loaded, IMK_FINDING_WARNING, "rival:motion_offset", NULL,
                  IMKI_NUMBERS(log->motion_offset + shift->rival_offset));
}

static imk_status find_offset(imk_calibrate_record *log, imk_error *error)
{
    imk_reference_shift shift;
    const imk_status status = find_shift(&log->record, &log->log.allocator, &shift, error);
    if (status != IMK_OK)
        return status;
    if (!(shift.correlation > followed))
        return imki_fail(&log->loaded, error, IMK_ERROR_CONFLICT, "programme_not_followed", NULL,
                         IMKI_NUMBERS(largest_shift, shift.correlation));
    imki_find(&log->loaded, IMK_FINDING_NOTE, "programme_begins", NULL,
              IMKI_NUMBERS(shift.offset, shift.sigma, shift.correlation));
    tell_rival(log, &shift);
    log->motion_offset = shift.offset;
    return IMK_OK;
}

/* A record that begins at another time than the programme looks like a bad sensor. */
static imk_status check_offset(imk_calibrate_record *log, imk_error *error)
{
    imk_error why;
    imk_reference_shift shift;
    const imk_status status = find_shift(&log->record, &log->log.allocator, &shift, &why);
    if (status == IMK_OK && shift.correlation > followed &&
        fabs(shift.offset) >= log->record.dt + 5 * shift.sigma) {
        imki_find(&log->loaded, IMK_FINDING_WARNING, "calibrate:motion_offset", NULL,
                  IMKI_NUMBERS(fabs(shift.offset), shift.offset > 0, shift.sigma,
                               log->motion_offset + shift.offset));
        tell_rival(log, &shift);
    }
    if (status == IMK_ERROR_NO_CONVERGENCE && fabs(why.value) > clock_tolerance)
        imki_find(&log->loaded, IMK_FINDING_WARNING, "calibrate:not_aligned", NULL, 0, NULL);
    return status == IMK_ERROR_MEMORY ? no_memory(error) : IMK_OK;
}

/* Columns of rates, or of forces, that are late or early beside the readings. A sine has many
 * shifts, and so have equal steps. */
static imk_status check_columns(imk_calibrate_record *log, int sensor, imk_error *error)
{
    imk_error why;
    imk_reference_shift shift;
    imk_test_record one = log->record;
    for (int i = 0; i < 3; i++)
        *(sensor == IMK_GYRO ? &one.reference_force[i] : &one.reference_rate[i]) = NULL;
    if (one.means || (!one.reference_rate[0] && !one.reference_force[0]))
        return IMK_OK;
    const imk_status status = find_shift(&one, &log->log.allocator, &shift, &why);
    if (status == IMK_OK && shift.correlation > followed &&
        shift.rival < 0.95 * shift.correlation &&
        fabs(shift.offset) > trimmed + log->record.dt + 5 * shift.sigma)
        imki_find(&log->loaded, IMK_FINDING_WARNING, "calibrate:reference_offset",
                  sensor == IMK_GYRO ? "gyro\treference_rate" : "accelerometer\treference_force",
                  IMKI_NUMBERS(fabs(shift.offset), shift.offset > 0, shift.sigma));
    return status == IMK_ERROR_MEMORY ? no_memory(error) : IMK_OK;
}

/* `count` samples from `begin` on, of readings and references. */
static imk_test_record part_of(const imk_test_record *whole, size_t begin, size_t count)
{
    imk_test_record part = *whole;
    part.count = count;
    part.time = whole->time ? whole->time + begin : NULL;
    part.section = NULL;
    part.temperature = NULL;
    for (int sensor = 0; sensor < 2; sensor++)
        for (int i = 0; i < whole->axis_count[sensor]; i++)
            part.reading[sensor][i] += begin;
    for (int i = 0; i < 3; i++) {
        part.reference_rate[i] += whole->reference_rate[i] ? begin : 0;
        part.reference_force[i] += whole->reference_force[i] ? begin : 0;
        part.reference_acceleration[i] += whole->reference_acceleration[i] ? begin : 0;
    }
    return part;
}

/* Mean square of the reference rates about their means, or of the forces. */
static double variation(const imk_test_record *record)
{
    const double *const *channel =
        record->reference_rate[0] ? record->reference_rate : record->reference_force;
    double total = 0;
    for (int i = 0; i < 3; i++) {
        double sum = 0, square = 0, count = 0;
        for (size_t k = 0; channel[i] && k < record->count; k++)
            if (isfinite(channel[i][k])) {
                sum += channel[i][k];
                square += channel[i][k] * channel[i][k];
                count += 1;
            }
        total += count > 0 ? square / count - sum * sum / (count * count) : 0;
    }
    return total;
}

/* A log whose clock runs faster or slower than the programme's is another time off in its second
 * half than in its first. Each half must follow the programme. */
static imk_status check_clock(imk_calibrate_record *log, imk_error *error)
{
    imk_error why;
    imk_reference_shift shift[2];
    const size_t half = log->record.count / 2;
    for (int k = 0; k < 2; k++) {
        const imk_test_record part = part_of(&log->record, k == 0 ? 0 : half, half);
        const imk_status status = find_shift(&part, &log->log.allocator, &shift[k], &why);
        if (status == IMK_ERROR_MEMORY)
            return no_memory(error);
        if (status == IMK_ERROR_NO_CONVERGENCE && fabs(why.value) > clock_tolerance &&
            variation(&part) > 0.1 * variation(&log->record)) {
            imki_find(&log->loaded, IMK_FINDING_WARNING, "calibrate:not_aligned", NULL, 0, NULL);
            return IMK_OK;
        }
        if (status != IMK_OK || !(shift[k].correlation > followed))
            return IMK_OK;
    }
    const double grows = shift[1].offset - shift[0].offset;
    const double part = grows / ((double)half * log->record.dt);
    if (fabs(grows) > clock_tolerance && fabs(grows) > 6 * hypot(shift[0].sigma, shift[1].sigma))
        imki_find(&log->loaded, IMK_FINDING_WARNING, "calibrate:clock", NULL,
                  IMKI_NUMBERS(fabs(grows), 100 * fabs(part), part > 0, (1 + part) / log->record.dt,
                               1 / log->record.dt));
    return IMK_OK;
}

static imk_status take_motion(const imk_calibrate_log_settings *s, imk_calibrate_record *log,
                              imk_error *error)
{
    log->motion_offset = s->find_offset ? 0 : s->motion_offset;
    imk_status status = expose(log, s->motion, error);
    if (status == IMK_OK && !s->find_offset) {
        const size_t before = log->loaded.count;
        status = check_offset(log, error);
        if (log->loaded.count > before) /* one doubt about the time is enough */
            return status;
    } else if (status == IMK_OK && (status = find_offset(log, error)) == IMK_OK)
        status = expose(log, s->motion, error);
    return status == IMK_OK ? check_clock(log, error) : status;
}

imk_status imki_take_reference(const imk_calibrate_log_settings *s, imk_calibrate_record *log,
                               imk_error *error)
{
    const struct {
        const char *name, *unit;
        const double **target;
    } vectors[] = {{"reference_rate", "deg/s", log->record.reference_rate},
                   {"reference_force", "g", log->record.reference_force},
                   {"reference_acceleration", "deg/s^2", log->record.reference_acceleration}};
    imk_status status = IMK_OK;
    for (size_t k = 0; status == IMK_OK && k < sizeof vectors / sizeof *vectors; k++)
        status = take_vector(log, vectors[k].name, vectors[k].unit, vectors[k].target, error);
    if (status == IMK_OK && !log->record.reference_rate[0])
        status = take_table(s, log, error);
    if (status != IMK_OK)
        return status;
    imki_check_reference_force(log);
    for (int sensor = 0; sensor < 2 && status == IMK_OK && !s->motion; sensor++)
        status = check_columns(log, sensor, error);
    if (status != IMK_OK || !s->motion)
        return status;
    if (log->record.reference_rate[0] || log->record.reference_force[0])
        return imki_fail(&log->loaded, error, IMK_ERROR_ARGUMENT, "reference_twice", NULL, 0, NULL);
    return take_motion(s, log, error);
}
