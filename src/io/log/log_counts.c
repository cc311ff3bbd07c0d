/* SPDX-License-Identifier: Apache-2.0 */
/* Counts of digital sensors as rates, forces and temperatures: by a sensitivity that the settings
 * state, or by that of a device and its range. */
#include "log_reader_internal.h"

#include "imukit/device_sensitivity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* What the settings say of counts of a quantity. */
typedef struct counted {
    imk_count_kind kind;
    const char *scale, *range;               /* NULL: not stated */
    const char *scale_option, *range_option; /* that state them */
    const char *unit;                        /* in which the readings are shown */
    const char *quantity;                    /* SI unit of the dimension */
} counted;

static bool find_counted(const imk_log_settings *s, imk_quantity quantity, counted *c)
{
    *c = (counted){.kind = IMK_COUNTS_TEMPERATURE};
    switch (quantity) {
    case IMK_QUANTITY_ANGULAR_RATE:
        *c = (counted){IMK_COUNTS_GYRO, s->gyro_scale, s->gyro_range, "--gyro-scale",
                       "--gyro-range",  "deg/s",       "rad/s"};
        break;
    case IMK_QUANTITY_SPECIFIC_FORCE:
        *c = (counted){IMK_COUNTS_ACCEL, s->accel_scale,  s->accel_range,
                       "--accel-scale",  "--accel-range", "g",
                       "m/s^2"};
        break;
    case IMK_QUANTITY_TEMPERATURE:
        *c = (counted){IMK_COUNTS_TEMPERATURE, NULL, NULL, NULL, NULL, "degC", "K"};
        break;
    case IMK_QUANTITY_OTHER:
    case IMK_QUANTITY_TIME:
    case IMK_QUANTITY_MAGNETIC:
        return false;
    }
    return c->scale || s->device;
}

bool imki_log_counted(const imk_log_settings *settings, imk_quantity quantity)
{
    counted c;
    return find_counted(settings, quantity, &c);
}

/* "BMI088 with a gyro range of 2000 deg/s": what the device has is found by the core, which knows
 * no options. */
static imk_status by_device(const counted *c, const imk_log_settings *s, double *per_count,
                            double *zero, double *most, imk_error *error)
{
    imk_device_sensitivity found;
    const imk_status status =
        imk_device_sensitivity_find(s->device, c->kind, c->range, &found, error);
    if (status == IMK_OK) {
        *per_count = found.per_count;
        *zero = found.zero;
        *most = ldexp(found.per_count, found.bits - 1);
    } else if (status == IMK_ERROR_KEY_MISSING && c->range_option) {
        char field[32], expected[512] = "";
        snprintf(field, sizeof field, "%s", c->range_option + 2);
        if (error)
            snprintf(expected, sizeof expected, "add %s RANGE (%.400s)", c->range_option,
                     error->expected);
        return imk_error_set(error, IMK_ERROR_CONFLICT, field,
                             "the device has several full scales, and none is stated", expected);
    } else if (error && strcmp(error->field, "range") == 0 && c->range_option) {
        snprintf(error->field, sizeof error->field, "%s", c->range_option + 2);
    }
    return status;
}

imk_status imki_log_counts_apply(const imk_log_settings *settings, imk_log_column *column,
                                 double *factor, double *offset, double *most, imk_error *error)
{
    counted c;
    double zero = 0;
    char found[96];
    if (!find_counted(settings, column->quantity, &c))
        return IMK_OK;
    const char *option = c.scale ? c.scale_option : "--device";
    if (!imk_dimension_equal(column->unit.dimension, imk_unit_of("count").dimension)) {
        if (!c.scale && column->quantity == IMK_QUANTITY_TEMPERATURE)
            return IMK_OK; /* parts of which only the temperature is converted already */
        snprintf(found, sizeof found, "its unit is %.40s, and %s is for counts", column->unit.text,
                 option);
        return imk_error_set(error, IMK_ERROR_CONFLICT, column->name, found,
                             "leave that option out");
    }
    if (column->increment) {
        snprintf(found, sizeof found, "%s is for counts of a rate, and these are increments",
                 option);
        return imk_error_set(error, IMK_ERROR_CONFLICT, column->name, found,
                             "read them as counts, without that option");
    }
    const imk_status status =
        c.scale ? imk_count_scale_parse(c.scale, c.scale + strlen(c.scale),
                                        imk_unit_of(c.quantity).dimension, factor, error)
                : by_device(&c, settings, factor, &zero, most, error);
    if (status == IMK_ERROR_UNSUPPORTED && column->quantity == IMK_QUANTITY_TEMPERATURE)
        return IMK_OK; /* it stays in counts */
    if (status != IMK_OK) {
        /* What lacks its unit here is an option, not a column. */
        if (error && status == IMK_ERROR_UNIT_MISSING)
            error->status = IMK_ERROR_SYNTAX;
        if (error && c.scale)
            snprintf(error->field, sizeof error->field, "%s", c.scale_option + 2);
        return status == IMK_ERROR_UNIT_MISSING ? IMK_ERROR_SYNTAX : status;
    }
    *offset = zero;
    column->unit = imk_unit_of(c.unit);
    column->unit_origin = c.scale ? IMK_UNIT_OF_SETTINGS : IMK_UNIT_OF_DEVICE;
    return IMK_OK;
}

imk_status imki_log_counts_check(const imk_log_reader *reader, size_t rows, double *const *columns,
                                 imk_error *error)
{
    const imki_log_layout_read *layout = &reader->layout;
    const double rounding = 1 + 1e-9;
    for (size_t c = 0; c < layout->column_count; c++) {
        const double *value = columns[c], most = layout->most[c] * rounding;
        char found[96];
        if (!value || !(most > 0))
            continue;
        for (size_t i = 0; i < rows; i++) {
            if (!(fabs(value[i] - layout->offset[c]) > most))
                continue;
            snprintf(found, sizeof found, "%.0f counts in row %zu are beyond the range of %.24s",
                     (value[i] - layout->offset[c]) / layout->factor[c],
                     reader->rows - rows + i + 1, reader->settings.device);
            return imk_error_set(error, IMK_ERROR_CONFLICT, layout->column[c].name, found,
                                 "where they were written without a sign, subtract 65536 "
                                 "from those above 32767 (16 bits); or check --device");
        }
    }
    return IMK_OK;
}
