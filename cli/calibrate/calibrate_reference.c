/* SPDX-License-Identifier: Apache-2.0 */
/* What the unit was exposed to: columns of the log beside the readings, or the programme that the
 * table ran (--motion), as means over the log's samples. */
#include "calibrate_parts.h"

#include <math.h>
#include <string.h>

/* An offset is searched for so far on both sides, when the log is long enough [s]. */
static const double largest_shift = 10.0;
/* Correlation of readings and programme from which on they are taken to be of one motion. */
static const double followed = 0.5;

/* A column of zeros. */
static const double *nothing(session_log *log)
{
    const double *zeros = imk_calibrate_record_column(log, 0);
    (void)command_unless_memory(zeros ? IMK_OK : IMK_ERROR_MEMORY);
    return zeros;
}

/* ---- columns --------------------------------------------------------------------------------- */

/* Index of the column of this name with the dimension of a unit; -1: there is none. */
static int find_column(const session_log *log, const char *name, const char *unit, int *found)
{
    *found = -1;
    for (size_t c = 0; c < log->log.column_count; c++) {
        const imk_log_column *column = &log->log.column[c];
        if (strcmp(column->name, name) != 0)
            continue;
        if (!column->unit.text[0])
            return command_failed("%s: %s has no unit; write it into the header, such as %s [%s]",
                                  log->path, name, name, unit);
        if (!imk_dimension_equal(column->unit.dimension, imk_unit_of(unit).dimension))
            return command_failed("%s: %s [%s] should be %s, such as %s", log->path, name,
                                  column->unit.text,
                                  imk_dimension_name(imk_unit_of(unit).dimension), unit);
        *found = (int)c;
    }
    return -1;
}

/* reference_rate_x … of one vector: the components that are not there are zero. */
static int take_vector(session_log *log, const char *name, const char *unit,
                       const double *target[3])
{
    int column[3];
    for (int k = 0; k < 3; k++) {
        char full[48];
        snprintf(full, sizeof full, "%s_%c", name, "xyz"[k]);
        int code = find_column(log, full, unit, &column[k]);
        if (code >= 0)
            return code;
    }
    if (column[0] < 0 && column[1] < 0 && column[2] < 0)
        return -1;
    for (int k = 0; k < 3; k++)
        target[k] = column[k] < 0 ? nothing(log) : log->log.data[column[k]];
    return -1;
}

static int take_table(const session *b, session_log *log)
{
    int column;
    int code = find_column(log, "table_rate", "deg/s", &column);
    if (code < 0 && column < 0 && b->options->table_axis >= 0 &&
        log->procedure == IMK_PROCEDURE_RATE_TABLE)
        return command_failed("%s has no column table_rate [deg/s], whose axis --table-axis names",
                              log->path);
    if (code >= 0 || column < 0)
        return code;
    if (b->options->table_axis < 0)
        return command_misused("%s has a column table_rate: say about which axis of the unit it "
                               "turns, such as --table-axis z",
                               log->path);
    for (int k = 0; k < 3; k++)
        log->record.reference_rate[k] = nothing(log);
    log->record.reference_rate[b->options->table_axis] = log->log.data[column];
    return -1;
}

static bool has_reference(const session_log *log)
{
    return log->record.reference_rate[0] || log->record.reference_force[0];
}

/* ---- programme ------------------------------------------------------------------------------ */

static int find_offset(session_log *log)
{
    imk_error error;
    imk_reference_shift shift;
    if (command_unless_memory(imk_calibrate_record_shift(log, largest_shift, &shift, &error)) !=
        IMK_OK)
        return command_error(&error, log->path);
    if (!(shift.correlation > followed))
        return command_failed("%s does not follow the programme at any offset within %.3g s (the "
                              "best correlation is %.2f): is it the programme that was run?",
                              log->path, largest_shift, shift.correlation);
    log->motion_offset = shift.offset;
    command_note("%s: the programme begins at %.4f s of the log (1 sigma %.2g s, correlation %.4f)",
                 log->path, shift.offset, shift.sigma, shift.correlation);
    if (shift.rival > 0.95 * shift.correlation)
        command_warn("motion_offset",
                     "%s: at %.4f s the programme fits nearly as well; if that is right, add "
                     "--motion-offset %.4fs",
                     log->path, shift.rival_offset, shift.rival_offset);
    return -1;
}

/* A log that begins at another time than the programme looks like a bad sensor. */
static void check_offset(const session_log *log)
{
    imk_error error;
    imk_reference_shift shift;
    if (command_unless_memory(imk_calibrate_record_shift(log, largest_shift, &shift, &error)) !=
            IMK_OK ||
        !(shift.correlation > followed) || fabs(shift.offset) < log->record.dt + 5 * shift.sigma)
        return;
    command_warn("motion_offset",
                 "%s follows the programme best when that begins %.4f s %s in the log than it "
                 "was told (1 sigma %.2g s): give --motion-offset %.4fs, or auto",
                 log->path, fabs(shift.offset), shift.offset > 0 ? "later" : "earlier", shift.sigma,
                 log->motion_offset + shift.offset);
}

static void expose(const session *b, session_log *log)
{
    (void)command_unless_memory(
        imk_calibrate_record_expose(log, imk_motion_file_motion(b->motion), NULL));
}

static int take_motion(const session *b, session_log *log)
{
    const char *text = b->options->motion_offset;
    const bool search = text && strcmp(text, "auto") == 0;
    if (text && !search) {
        double sigma;
        size_t count;
        imk_error error;
        if (imk_quantity_parse(text, text + strlen(text), imk_unit_of("s").dimension, 1,
                               &log->motion_offset, &sigma, &count, NULL, &error) != IMK_OK)
            return command_misused("--motion-offset %s: expected the time of the log at which the "
                                   "programme begins, such as 2.5s, or auto",
                                   text);
    }
    expose(b, log);
    if (!search) {
        check_offset(log);
        return -1;
    }
    const int code = find_offset(log);
    if (code < 0)
        expose(b, log);
    return code;
}

int session_reference(session *b, session_log *log)
{
    imk_test_record *record = &log->record;
    int code = take_vector(log, "reference_rate", "deg/s", record->reference_rate);
    if (code < 0)
        code = take_vector(log, "reference_force", "g", record->reference_force);
    if (code < 0)
        code =
            take_vector(log, "reference_acceleration", "deg/s^2", record->reference_acceleration);
    if (code < 0 && !record->reference_rate[0])
        code = take_table(b, log);
    if (code >= 0 || !b->motion)
        return code;
    if (has_reference(log))
        return command_misused("%s has reference columns and --motion says what they say: leave "
                               "one out",
                               log->path);
    return take_motion(b, log);
}
