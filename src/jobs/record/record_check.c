/* SPDX-License-Identifier: Apache-2.0 */
/* Sources, sinks, models and settings that are none are refused before they are used. */
#include "record_check_internal.h"

#include "record_stamps_internal.h"
#include "record_times_internal.h"

#include "base/refuse_internal.h"
#include "jobs/arena_internal.h"
#include "jobs/job_internal.h"

#include <stdio.h>

imk_status imki_check_source(const imk_record_source *source, imk_error *error)
{
    const size_t most = IMK_LOG_COLUMNS_MAX;
    const char *missing = !source            ? "a record source"
                          : !source->read    ? "a source with a function `read`"
                          : !source->columns ? "a source with `columns`"
                                             : NULL;
    if (missing)
        return imk_error_set(error, IMK_ERROR_ARGUMENT, "source", NULL, missing);
    if (source->column_count < 1 || source->column_count > most)
        return imki_refuse(error, IMK_ERROR_ARGUMENT, "source", (double)source->column_count,
                           source->column_count < 1 ? 1 : (double)most,
                           "a source with a `column_count` of 1 to 64");
    return IMK_OK;
}

imk_status imki_check_sink(const imk_record_sink *sink, imk_error *error)
{
    if (sink && sink->begin && sink->write)
        return IMK_OK;
    return imk_error_set(error, IMK_ERROR_ARGUMENT, "sink", NULL,
                         sink ? "a sink with functions `begin` and `write`" : "a record sink");
}

imk_status imki_check_model(const imk_model *model, imk_error *error)
{
    if (imk_model_validate(model, NULL) == IMK_ERROR_UNINITIALISED)
        return imk_model_validate(model, error);
    return IMK_OK;
}

imk_status imki_check_fraction(const char *field, double value, imk_error *error)
{
    if (value > 0 && value < 1)
        return IMK_OK;
    return imki_refuse(error, IMK_ERROR_RANGE, field, value, value >= 1 ? 1 : 0, "between 0 and 1");
}

imk_status imki_check_unit(const imk_unit *asked, imk_dimension due, const char *field,
                           imk_error *error)
{
    char expected[160];
    if (!(asked->scale > 0) || imk_dimension_equal(asked->dimension, due))
        return IMK_OK;
    snprintf(expected, sizeof expected, "%s such as %s", imk_dimension_name(due),
             imk_dimension_examples(due));
    return imk_error_set(error, IMK_ERROR_DIMENSION, field, asked->text, expected);
}

imk_status imki_source_findings(const imk_record_source *source, size_t rows, double *const *data,
                                const imk_allocator *allocator, imk_log_findings *found,
                                imk_error *error)
{
    const int time = imk_record_find(source, IMK_QUANTITY_TIME, -1);
    imki_arena scratch = {.allocator = *allocator};
    if (source->findings) {
        *found = source->findings(source->context);
        return IMK_OK;
    }
    imki_record_times *times = imki_arena_take(&scratch, sizeof *times);
    if (!times)
        return imk_error_set(error, IMK_ERROR_MEMORY, "time", NULL, NULL);
    imki_record_times_start(times, source->rate > 0 ? 1 / source->rate : 0);
    if (time >= 0)
        imki_record_times_add(times, 1, rows, data[time]);
    *found = imki_record_times_findings(times);
    found->rows = rows;
    imki_arena_free(&scratch);
    return IMK_OK;
}

void imki_tell_manner(const imk_record_source *source, imk_findings *findings)
{
    static const char *const what[3] = {"gyros", "accelerometers", "a temperature"};
    if (!source->findings)
        return;
    const imk_log_findings f = source->findings(source->context);
    bool increments = false;
    for (size_t c = 0; c < source->column_count; c++)
        increments = increments || source->columns[c].increment;
    const double scatter = f.interval > 0 ? f.jitter / f.interval : 0, told = 0.02;
    if (increments && source->rate == 0 && (scatter > told || imki_stamps_uneven(0, &f)))
        imki_find(findings, IMK_FINDING_WARNING, "uneven_increments", NULL, 0, NULL);
    if (f.received)
        imki_find(findings, IMK_FINDING_WARNING, "received", NULL, IMKI_NUMBERS((double)f.stamps));
    for (int i = 0; i < 3; i++)
        if (f.later[i] > 0)
            imki_find(findings, IMK_FINDING_WARNING, "later", what[i],
                      IMKI_NUMBERS((double)f.later[i]));
    if (f.device_interval > 0 && f.interval > 1.5 * f.device_interval)
        imki_find(
            findings, IMK_FINDING_WARNING, "decimated", NULL,
            IMKI_NUMBERS(1 / f.interval, 1 / f.device_interval, f.interval / f.device_interval));
    if (f.absent > 0)
        imki_find(findings, IMK_FINDING_WARNING, "absent", NULL,
                  IMKI_NUMBERS((double)f.absent, (double)f.stated));
    if (f.unclosed)
        imki_find(findings, IMK_FINDING_NOTE, "unclosed", NULL, 0, NULL);
    if (f.unlisted > 0)
        imki_find(findings, IMK_FINDING_WARNING, "unlisted", f.unlisted_name,
                  IMKI_NUMBERS((double)f.unlisted));
    if (f.unread > 0) {
        char both[96];
        snprintf(both, sizeof both, "%s\t%s", f.unread_name, f.unread_kind);
        imki_find(findings, IMK_FINDING_WARNING, "unread", both, IMKI_NUMBERS((double)f.unread));
    }
}

void imki_tell_damage(const imk_record_source *source, imk_findings *findings)
{
    if (!source->findings)
        return;
    const imk_log_findings f = source->findings(source->context);
    if (f.damaged > 0)
        imki_find(findings, IMK_FINDING_WARNING, "damaged", NULL,
                  IMKI_NUMBERS((double)f.damaged, (double)f.rows, (double)f.first_damaged,
                               (double)f.damaged_line, (double)f.damaged_column));
    if (f.headers > 0)
        imki_find(findings, IMK_FINDING_WARNING, "headers", NULL,
                  IMKI_NUMBERS((double)f.headers, (double)f.first_header));
    if (f.cut_short)
        imki_find(findings, IMK_FINDING_WARNING, "cut_short", NULL, IMKI_NUMBERS((double)f.rows));
    if (f.other_frames > 0)
        imki_find(findings, IMK_FINDING_WARNING, "frames", f.frames,
                  IMKI_NUMBERS((double)f.other_frames, (double)f.rows));
    imki_tell_manner(source, findings);
}
