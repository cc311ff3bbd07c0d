/* SPDX-License-Identifier: Apache-2.0 */
/* What a unit was exposed to by the programme that the table ran, as means over the log's
 * samples. */
#include "calibrate_internal.h"

#include "imukit/random.h"
#include "imukit/samples.h"

#include <math.h>
#include <string.h>

double *imk_calibrate_record_column(imk_calibrate_record *log, int column)
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

imk_status imk_calibrate_record_expose(imk_calibrate_record *log, const imk_motion *motion,
                                       imk_error *error)
{
    double *column[IMK_CALIBRATE_REFERENCES];
    for (int i = 0; i < IMK_CALIBRATE_REFERENCES; i++)
        if (!(column[i] = imk_calibrate_record_column(log, i)))
            return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
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
    return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
}

imk_status imk_calibrate_record_shift(const imk_calibrate_record *log, double largest,
                                      imk_reference_shift *shift, imk_error *error)
{
    const double length = (double)log->record.count * log->record.dt;
    const double most = fmin(largest, length / 4);
    const size_t size = imk_reference_offset_workspace_size(&log->record, most);
    void *workspace = imki_resize(&log->log.allocator, NULL, size);
    if (!workspace)
        return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    const imk_status status =
        imk_reference_offset(&log->record, most, shift, workspace, size, error);
    imki_resize(&log->log.allocator, workspace, 0);
    return status;
}
