/* SPDX-License-Identifier: Apache-2.0 */
/* A whole record, and its channels equally spaced. */
#include "even_record_internal.h"
#include "record_check_internal.h"
#include "record_repeats_internal.h"
#include "record_stamps_internal.h"

#include "jobs/arena_internal.h"
#include "jobs/job_internal.h"

#include "imukit/model.h"
#include "imukit/samples.h"

#include <math.h>

const imk_log_column *imk_even_record_column(const imk_even_record *record, size_t channel)
{
    return &record->log.column[record->column[channel]];
}

double *imk_even_record_data(const imk_even_record *record, size_t channel)
{
    return record->log.data[record->column[channel]];
}

size_t imk_even_record_finite(const imk_even_record *record, size_t channel)
{
    const double *data = imk_even_record_data(record, channel);
    size_t count = 0;
    for (size_t row = 0; row < record->rows; row++)
        count += isfinite(data[row]) != 0;
    return count;
}

void imk_even_record_free(imk_even_record *record)
{
    imk_log_free(&record->log);
    record->count = 0;
}

/* Gyros in the order of their axes, then accelerometers; every other column when there are none. */
void imk_even_record_choose(imk_even_record *record)
{
    const imk_log *log = &record->log;
    static const imk_quantity kinds[] = {IMK_QUANTITY_ANGULAR_RATE, IMK_QUANTITY_SPECIFIC_FORCE};
    record->count = 0;
    for (size_t k = 0; k < 2; k++) {
        for (int axis = 0; axis < IMK_AXES_MAX; axis++) {
            const int column = imk_log_find(log, kinds[k], axis);
            if (column >= 0)
                record->column[record->count++] = column;
        }
    }
    if (record->count > 0)
        return;
    for (size_t c = 0; c < log->column_count; c++) {
        const imk_quantity quantity = log->column[c].quantity;
        if ((quantity == IMK_QUANTITY_OTHER || quantity == IMK_QUANTITY_MAGNETIC) &&
            !log->column[c].label)
            record->column[record->count++] = (int)c;
    }
}

/* Where no column is one of a gyro or an accelerometer, all are channels. */
void imki_even_record_unused(const imk_even_record *record, imk_findings *findings)
{
    const imk_quantity first = imk_even_record_column(record, 0)->quantity;
    const bool whole =
        imki_tell_unused(record->log.column_count, record->log.column, IMK_MAG, findings);
    if (first != IMK_QUANTITY_ANGULAR_RATE && first != IMK_QUANTITY_SPECIFIC_FORCE)
        imki_find(findings, whole ? IMK_FINDING_WARNING : IMK_FINDING_NOTE, "unknown_channels",
                  NULL, 0, NULL);
}

/* Numbers that are no readings become NaN: missing. Times stay. */
void imk_log_forget_faults(imk_log *log)
{
    for (size_t c = 0; c < log->column_count; c++) {
        if (log->column[c].quantity == IMK_QUANTITY_TIME || log->column[c].label)
            continue;
        for (size_t row = 0; row < log->rows; row++)
            if (!(fabs(log->data[c][row]) <= IMK_READING_MAX))
                log->data[c][row] = (double)NAN;
    }
}

/* Held samples are seen in the rows as they are in the log. */
static void count_repeats(const imk_even_record *record, imki_repeats *repeats)
{
    imki_repeats_start(repeats, record->count, record->column, record->log.column);
    imki_repeats_add(repeats, record->log.rows, record->log.data);
}

static imk_status space(double rate, imk_gap_policy gaps, imk_even_record *record,
                        imki_repeats *repeats, imk_findings *findings, imk_error *error)
{
    const size_t before = findings->count;
    const imk_status settled = imki_settle_times(rate, &record->log, findings, error);
    if (settled == IMK_ERROR_TIME_ORDER && gaps == IMK_GAPS_LONGEST)
        findings->count = before; /* a stretch of it may have a rate */
    else if (settled != IMK_OK)
        return settled;
    count_repeats(record, repeats);
    record->rows = record->log.rows;
    record->dt = rate > 0 ? 1 / rate : record->log.findings.interval;
    if (record->rows == 0)
        return imki_fail(findings, error, IMK_ERROR_EMPTY, "no_rows", NULL, 0, NULL);
    if (record->count == 0)
        return imki_fail(findings, error, IMK_ERROR_COLUMN, "no_channel", NULL, 0, NULL);
    if (record->rows < 2)
        return imki_fail(findings, error, IMK_ERROR_TOO_SHORT, "one_row", NULL, 0, NULL);
    if (!(record->dt > 0) || !isfinite(record->dt))
        return imki_fail(findings, error, IMK_ERROR_RATE_MISSING, "no_interval", NULL, 0, NULL);
    return gaps == IMK_GAPS_KEEP ? imki_keep_grid(rate, record, findings, error)
                                 : imki_space_evenly(rate, gaps, record, findings, error);
}

static imk_status load_and_tell(const imk_record_source *source, imk_gap_policy gaps,
                                const imk_job *job, imk_even_record *record, imki_repeats *repeats,
                                imk_findings *findings, imk_error *error)
{
    imk_status status = imki_record_load(source, job, &record->log, error);
    if (status != IMK_OK)
        return status;
    imki_tell_damage(source, findings);
    imk_even_record_choose(record);
    imk_log_forget_faults(&record->log);
    status = space(source->rate, gaps, record, repeats, findings, error);
    if (status != IMK_OK)
        return status;
    imki_repeats_tell(repeats, record->log.column, record->dt, findings);
    imki_even_record_unused(record, findings);
    return IMK_OK;
}

/* What is counted is too large for a small stack. */
imk_status imk_even_record_load(const imk_record_source *source, imk_gap_policy gaps,
                                const imk_job *job, imk_even_record *record, imk_findings *findings,
                                imk_error *error)
{
    *record = (imk_even_record){.count = 0};
    imki_arena scratch = {.allocator = job->allocator};
    imki_repeats *repeats = imki_arena_room(&scratch, sizeof *repeats);
    const imk_status status =
        repeats ? load_and_tell(source, gaps, job, record, repeats, findings, error)
                : imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    imki_arena_free(&scratch);
    return status;
}
