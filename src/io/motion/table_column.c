/* SPDX-License-Identifier: Apache-2.0 */
/* What is checked of every column of a table that is used. */
#include "motion_file_internal.h"

#include "imukit/units.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

imk_status imki_table_row_error(const char *name, imk_status status, size_t row, const char *found,
                                const char *expected, imk_error *error)
{
    char field[96];
    snprintf(field, sizeof field, "%.60s, row %zu", name, row);
    return imk_error_set(error, status, field, found, expected);
}

imk_status imki_table_column_check(const imk_log *log, size_t column, const char *si,
                                   imk_error *error)
{
    const imk_log_column *c = &log->column[column];
    const imk_dimension due = imk_unit_of(si).dimension;
    char found[96], expected[160];
    if (c->label)
        return imk_error_set(error, IMK_ERROR_COLUMN, c->name, "this column contains texts",
                             "a column of numbers");
    /* An angle that says no unit could be in degrees or radians. A bare quaternion is right. */
    if (c->unit.text[0] == '\0' && si[0] != '1') {
        snprintf(expected, sizeof expected, "write the unit in the header, as in %s [%s]", c->name,
                 strcmp(si, "rad") == 0 ? "deg" : si);
        return imk_error_set(error, IMK_ERROR_UNIT_MISSING, "", c->name, expected);
    }
    if (!imk_dimension_equal(c->unit.dimension, due)) {
        snprintf(found, sizeof found, "\"%.40s\" is %.48s", c->unit.text,
                 imk_dimension_name(c->unit.dimension));
        snprintf(expected, sizeof expected, "%.60s, such as %.80s", imk_dimension_name(due),
                 imk_dimension_examples(due));
        return imk_error_set(error, IMK_ERROR_DIMENSION, c->name, found, expected);
    }
    for (size_t i = 0; i < log->rows; i++) {
        if (isfinite(log->data[column][i]))
            continue;
        const imk_status status = imki_table_row_error(c->name, IMK_ERROR_NOT_FINITE, i + 1, "",
                                                       "a number in every row", error);
        if (error)
            error->value = log->data[column][i];
        return status;
    }
    return IMK_OK;
}
