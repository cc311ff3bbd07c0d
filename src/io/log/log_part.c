/* SPDX-License-Identifier: Apache-2.0 */
/* A part of a log: rows before and after it are read and dropped. */
#include "log_reader_internal.h"

#include <math.h>
#include <stdio.h>

/* Times from the first row [s], of rows that are not yet counted. A row without a time is where the
 * row before it is. */
static double place_of(imk_log_reader *reader, const double *time, size_t row)
{
    imki_log_part *part = &reader->part;
    if (!time) {
        const size_t rows = part->before + reader->rows + part->after;
        part->place = (double)(rows + row) / reader->rate;
        return part->place;
    }
    if (isfinite(time[row])) {
        const double t = time[row] * reader->layout.factor[reader->layout.time_column];
        if (!part->begun)
            part->first_time = t;
        part->begun = true;
        part->place = t - part->first_time;
    }
    return part->place;
}

static bool is_finite_row(const imk_log_reader *reader, double *const *out, size_t row)
{
    bool finite = true;
    for (size_t i = 0; i < reader->layout.cell_count; i++)
        if (reader->layout.cell_column[i] >= 0 && out[i] != reader->spare)
            finite &= (bool)isfinite(out[i][row]);
    return finite;
}

size_t imki_log_part_keep(imk_log_reader *reader, size_t rows, const double *time,
                          double *const *out)
{
    const imk_log_settings *s = &reader->settings;
    imki_log_part *part = &reader->part;
    size_t kept = 0, before = 0, after = 0;
    if (s->after == 0 && s->before == 0)
        return rows;
    reader->not_finite = part->not_finite;
    for (size_t row = 0; row < rows; row++) {
        const double place = place_of(reader, time, row);
        if (place < s->after) {
            before++;
            continue;
        }
        if (s->before > 0 && place > s->before) {
            after++;
            continue;
        }
        for (size_t i = 0; i < reader->layout.cell_count; i++)
            out[i][kept] = out[i][row];
        kept++;
        if (!is_finite_row(reader, out, kept - 1) && reader->not_finite++ == 0)
            reader->first_not_finite = part->before + before + reader->rows + kept;
    }
    part->before += before;
    part->after += after;
    part->not_finite = reader->not_finite;
    return kept;
}

imk_status imki_log_part_empty(const imk_log_reader *reader, imk_error *error)
{
    char found[64];
    if (reader->part.before + reader->part.after == 0)
        return IMK_OK;
    snprintf(found, sizeof found, "the log ends after %.6g s", reader->part.place);
    return imk_error_set(error, IMK_ERROR_EMPTY, "", found,
                         "give --after and --before times within the log");
}

imk_status imki_log_part_check(const imk_log_settings *s, imk_error *error)
{
    if (s->after >= 0 && isfinite(s->after) && s->before >= 0 && isfinite(s->before) &&
        (s->before == 0 || s->before > s->after))
        return IMK_OK;
    imk_error_set(error, IMK_ERROR_RANGE, "after, before", NULL,
                  "two times from the start of the log, the second behind the first, as in --after "
                  "30s --before 1800s");
    if (error)
        error->value = s->before;
    return IMK_ERROR_RANGE;
}
