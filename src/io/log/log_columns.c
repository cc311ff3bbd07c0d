/* SPDX-License-Identifier: Apache-2.0 */
/* What a column is, from its name and unit. Nothing is guessed: a missing unit or rate is refused
 * with the option that states it. */
#include "log_reader_internal.h"

#include "base/text_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Kinds of columns with a meaning here. */
typedef struct kind {
    const char *prefix; /* in lower case; with axis: followed by x, y, z or 0 … 7 */
    const char *name;   /* as it is called from here on */
    imk_quantity quantity;
    bool has_axis, increment;
    const char *unit;   /* one of the right dimension */
    const char *option; /* states the unit; NULL: without a unit it is a column like any other */
    const char *due;    /* end of the message when it is missing */
} kind;

static const kind kinds[] = {{"time", "time", IMK_QUANTITY_TIME, false, false, "s", "--time-unit",
                              "add --time-unit s (or ms, us, ns)"},
                             {"timestamp", "time", IMK_QUANTITY_TIME, false, false, "s",
                              "--time-unit", "add --time-unit s (or ms, us, ns)"},
                             {"t", "time", IMK_QUANTITY_TIME, false, false, "s", "--time-unit",
                              "add --time-unit s (or ms, us, ns)"},
                             {"gyro_", "gyro_", IMK_QUANTITY_ANGULAR_RATE, true, false, "rad/s",
                              "--gyro-unit", "add --gyro-unit deg/s (or rad/s, deg/h, count)"},
                             {"dtheta_", "dtheta_", IMK_QUANTITY_ANGULAR_RATE, true, true, "rad",
                              "--gyro-unit", "add --gyro-unit arcsec (or rad, deg, count)"},
                             {"accel_", "accel_", IMK_QUANTITY_SPECIFIC_FORCE, true, false, "m/s^2",
                              "--accel-unit", "add --accel-unit g (or m/s^2, mg, count)"},
                             {"acc_", "accel_", IMK_QUANTITY_SPECIFIC_FORCE, true, false, "m/s^2",
                              "--accel-unit", "add --accel-unit g (or m/s^2, mg, count)"},
                             {"dvel_", "dvel_", IMK_QUANTITY_SPECIFIC_FORCE, true, true, "m/s",
                              "--accel-unit", "add --accel-unit m/s (or count)"},
                             {"mag_", "mag_", IMK_QUANTITY_MAGNETIC, true, false, "T", NULL, NULL},
                             {"temperature", "temperature", IMK_QUANTITY_TEMPERATURE, false, false,
                              "K", "--temperature-unit", "add --temperature-unit degC"},
                             {"temp", "temperature", IMK_QUANTITY_TEMPERATURE, false, false, "K",
                              "--temperature-unit", "add --temperature-unit degC"}};

static bool begins_with(const char *text, const char *prefix)
{
    for (; *prefix; prefix++, text++)
        if (imki_lower(*text) != *prefix)
            return false;
    return true;
}

static int axis_of(const char *text)
{
    if (text[0] == '\0' || text[1] != '\0')
        return -1;
    const char c = imki_lower(text[0]);
    if (c >= 'x' && c <= 'z')
        return c - 'x';
    return c >= '0' && c <= '7' ? c - '0' : -1;
}

/* The kind of a name, or NULL. */
static const kind *find_kind(const char *name, int *axis)
{
    *axis = -1;
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
        const size_t length = strlen(kinds[i].prefix);
        if (!begins_with(name, kinds[i].prefix))
            continue;
        if (!kinds[i].has_axis && name[length] == '\0')
            return &kinds[i];
        *axis = kinds[i].has_axis ? axis_of(name + length) : -1;
        if (*axis >= 0)
            return &kinds[i];
    }
    return NULL;
}

static void trim(imki_log_piece *piece)
{
    while (piece->begin < piece->end && (*piece->begin == ' ' || *piece->begin == '\t'))
        piece->begin++;
    while (piece->end > piece->begin && (piece->end[-1] == ' ' || piece->end[-1] == '\t'))
        piece->end--;
}

static void copy_piece(char *target, size_t size, imki_log_piece piece)
{
    size_t length = (size_t)(piece.end - piece.begin);
    if (length >= size) {
        length = size - 1;
        while (length > 0 && ((unsigned char)piece.begin[length] & 0xC0) == 0x80)
            length--;
    }
    memcpy(target, piece.begin, length);
    target[length] = '\0';
}

/* "gyro_x [deg/s]": divide at the first bracket that closes at the end. */
static void split_unit(imki_log_piece *name, imki_log_piece *unit)
{
    trim(name);
    *unit = (imki_log_piece){name->end, name->end};
    if (name->begin == name->end || (name->end[-1] != ']' && name->end[-1] != ')'))
        return;
    const char open = name->end[-1] == ']' ? '[' : '(';
    for (const char *p = name->begin; p < name->end; p++)
        if (*p == open) {
            *unit = (imki_log_piece){p + 1, name->end - 1};
            name->end = p;
            break;
        }
    trim(name);
    trim(unit);
}

static const char *unit_setting(imk_quantity quantity, const imk_log_settings *settings)
{
    switch (quantity) {
    case IMK_QUANTITY_TIME:
        return settings->time_unit;
    case IMK_QUANTITY_ANGULAR_RATE:
        return settings->gyro_unit;
    case IMK_QUANTITY_SPECIFIC_FORCE:
        return settings->accel_unit;
    case IMK_QUANTITY_TEMPERATURE:
        return settings->temperature_unit;
    case IMK_QUANTITY_MAGNETIC:
    case IMK_QUANTITY_OTHER:
        break;
    }
    return NULL;
}

/* Is this the unit of the text? */
static bool is_unit(const imk_unit *unit, const char *text)
{
    imk_unit other;
    return imk_unit_parse(text, text + strlen(text), &other, NULL) == IMK_OK &&
           imk_dimension_equal(unit->dimension, other.dimension) &&
           fabs(unit->scale - other.scale) <= 1e-12 * fabs(other.scale) &&
           unit->offset == other.offset;
}

const char *imk_log_unit_ignored(const imk_log_reader *reader, const imk_log_settings *settings,
                                 imk_quantity quantity, const imk_log_column **column)
{
    const char *text = unit_setting(quantity, settings);
    imk_unit unit; /* a text that is no unit means something to the format that took it */
    if (text && imk_unit_parse(text, text + strlen(text), &unit, NULL) != IMK_OK)
        text = NULL;
    for (size_t i = 0; text && i < reader->layout.column_count; i++) {
        *column = &reader->layout.column[i];
        if ((*column)->quantity == quantity && !is_unit(&(*column)->unit, text))
            return text;
    }
    *column = NULL;
    return NULL;
}

static bool has_dimension(const kind *k, const imk_unit *unit)
{
    return imk_dimension_equal(unit->dimension, imk_unit_of(k->unit).dimension) ||
           (k->quantity != IMK_QUANTITY_TIME &&
            imk_dimension_equal(unit->dimension, imk_unit_of("count").dimension));
}

static imk_status check_dimension(const kind *k, const imk_unit *unit, const char *field,
                                  imk_error *error)
{
    if (has_dimension(k, unit))
        return IMK_OK;
    const imk_dimension due = imk_unit_of(k->unit).dimension;
    char found[96], expected[160];
    snprintf(found, sizeof found, "\"%.47s\" is %.40s", unit->text,
             imk_dimension_name(unit->dimension));
    snprintf(expected, sizeof expected, "%.60s, such as %.80s", imk_dimension_name(due),
             imk_dimension_examples(due));
    return imk_error_set(error, IMK_ERROR_DIMENSION, field, found, expected);
}

imk_status imki_log_column_make(imki_log_piece name, const imk_log_settings *settings,
                                imk_log_column *column, imk_error *error)
{
    imki_log_piece unit;
    split_unit(&name, &unit);
    *column = (imk_log_column){.axis = -1};
    copy_piece(column->name, sizeof column->name, name);
    const kind *k = find_kind(column->name, &column->axis);
    if (!k || (!k->option && unit.begin == unit.end)) {
        column->axis = -1;
        if (imk_unit_parse(unit.begin, unit.end, &column->unit, NULL) != IMK_OK) {
            column->unit = (imk_unit){.scale = 1.0};
            copy_piece(column->unit.text, sizeof column->unit.text, unit);
        }
        return IMK_OK;
    }
    char suffix[2] = {k->has_axis ? imki_lower(column->name[strlen(column->name) - 1]) : '\0',
                      '\0'};
    snprintf(column->name, sizeof column->name, "%s%s", k->name, suffix);
    column->quantity = k->quantity;
    column->increment = k->increment;
    const char *field = column->name;
    if (unit.begin == unit.end) {
        const char *setting = unit_setting(k->quantity, settings);
        if (!setting)
            return imk_error_set(error, IMK_ERROR_UNIT_MISSING, "", column->name, k->due);
        unit = (imki_log_piece){setting, setting + strlen(setting)};
        field = k->option;
    }
    const imk_status status = imk_unit_parse(unit.begin, unit.end, &column->unit, error);
    if (status != IMK_OK) {
        if (error)
            snprintf(error->field, sizeof error->field, "%s", field);
        return status;
    }
    return check_dimension(k, &column->unit, column->name, error);
}

/* Turn the columns of the first three axes to forward-right-down. */
static imk_status apply_axes(imki_log_layout_read *layout, const char *axes, imk_error *error)
{
    int body[3];
    double sign[3];
    const imk_status status = imki_log_axes_parse(axes, body, sign, error);
    if (status != IMK_OK)
        return status;
    for (size_t i = 0; i < layout->column_count; i++) {
        imk_log_column *column = &layout->column[i];
        if (column->axis < 0 || column->axis > 2)
            continue;
        layout->factor[i] *= sign[column->axis];
        column->axis = body[column->axis];
        column->name[strlen(column->name) - 1] = "xyz"[column->axis];
    }
    return IMK_OK;
}

static bool is_doubled(const imki_log_layout_read *layout, size_t index)
{
    const imk_log_column *column = &layout->column[index];
    for (size_t i = 0; i < index; i++)
        if (column->quantity != IMK_QUANTITY_OTHER &&
            layout->column[i].quantity == column->quantity &&
            layout->column[i].axis == column->axis)
            return true;
    return false;
}

/* The kind that the option of `asked` is of and that the unit does not fit; NULL: it fits a column,
 * or where there is none, a kind that there might be. */
static const kind *misfit(const imki_log_layout_read *layout, const kind *asked,
                          const imk_unit *unit)
{
    const kind *due = NULL;
    bool fits = false;
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
        const kind *k = &kinds[i];
        if (!k->option || !asked->option || strcmp(k->option, asked->option) != 0)
            continue;
        fits = fits || has_dimension(k, unit);
        for (size_t j = 0; j < layout->column_count; j++) {
            const imk_log_column *column = &layout->column[j];
            if (column->quantity != k->quantity || column->increment != k->increment)
                continue;
            if (has_dimension(k, unit))
                return NULL;
            due = due ? due : k;
        }
    }
    return due ? due : fits ? NULL : asked;
}

/* A unit of the settings is looked at also where each column has its own. */
static imk_status check_settings(const imki_log_layout_read *layout,
                                 const imk_log_settings *settings, imk_error *error)
{
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
        const char *text = unit_setting(kinds[i].quantity, settings);
        imk_unit unit;
        if (!text)
            continue;
        const imk_status status = imk_unit_parse(text, text + strlen(text), &unit, error);
        if (status != IMK_OK) {
            if (error)
                snprintf(error->field, sizeof error->field, "%s", kinds[i].option);
            return status;
        }
        const kind *due = misfit(layout, &kinds[i], &unit);
        if (due)
            return check_dimension(due, &unit, due->option, error);
    }
    return IMK_OK;
}

/* "tempo [s]" is a time by its unit. */
static imk_status refuse_without_time(const imki_log_layout_read *layout, imk_error *error)
{
    char next[160] = "add --rate 100Hz (samples per second)";
    for (size_t i = 0; i < layout->column_count; i++) {
        const imk_log_column *c = &layout->column[i];
        if (c->quantity == IMK_QUANTITY_OTHER &&
            imk_dimension_equal(c->unit.dimension, imk_unit_of("s").dimension)) {
            snprintf(next, sizeof next,
                     "add --rate 100Hz (samples per second); if %.40s is the time, name it so "
                     "with --columns, with a name for each column",
                     c->name);
            break;
        }
    }
    return imk_error_set(error, IMK_ERROR_RATE_MISSING, "time", "the log has no time column", next);
}

/* Is any column of use? Is the time known? */
static imk_status check_layout(const imki_log_layout_read *layout, const imk_log_settings *settings,
                               imk_error *error)
{
    bool known = settings->columns != NULL || settings->any_columns;
    for (size_t i = 0; i < layout->column_count; i++)
        known |= layout->column[i].quantity != IMK_QUANTITY_OTHER;
    if (!known)
        return imk_error_set(
            error, IMK_ERROR_COLUMN, layout->column[0].name, "no column has a known name",
            "known are time, gyro_x, dtheta_x, accel_x, dvel_x, mag_x, temperature; add "
            "--columns with a name for each column (- skips a column)");
    return layout->time_column < 0 && settings->rate == 0.0 ? refuse_without_time(layout, error)
                                                            : IMK_OK;
}

static imk_status add_cell(imki_log_layout_read *layout, size_t cell, imki_log_piece name,
                           const imk_log_settings *settings, imk_error *error)
{
    layout->cell_column[cell] = -1;
    layout->cell_factor[cell] = 1.0;
    trim(&name);
    if (name.end - name.begin == 1 && *name.begin == '-')
        return IMK_OK;
    const size_t index = layout->column_count;
    imk_log_column *column = &layout->column[index];
    const imk_status status = imki_log_column_make(name, settings, column, error);
    if (status != IMK_OK)
        return status;
    if (is_doubled(layout, index))
        return imk_error_set(error, IMK_ERROR_COLUMN, column->name,
                             "this column is in the file twice",
                             "remove one of the two, or skip it: - in its place in --columns");
    layout->cell_column[cell] = (int)index;
    layout->factor[index] = column->unit.scale;
    if (column->quantity == IMK_QUANTITY_TIME)
        layout->time_column = (int)index;
    layout->has_increments |= column->increment;
    layout->column_count++;
    return IMK_OK;
}

imk_status imki_log_layout_make(const imki_log_piece *header, size_t cell_count,
                                const imk_log_settings *settings, imki_log_layout_read *layout,
                                imk_error *error)
{
    const char separator = layout->separator;
    *layout =
        (imki_log_layout_read){.cell_count = cell_count, .separator = separator, .time_column = -1};
    for (size_t i = 0; i < cell_count; i++) {
        const imk_status status = add_cell(layout, i, header[i], settings, error);
        if (status != IMK_OK)
            return status;
    }
    if (layout->column_count == 0)
        return imk_error_set(error, IMK_ERROR_COLUMN, "columns", "every column is skipped",
                             "at least one name in --columns");
    imk_status status = check_layout(layout, settings, error);
    if (status == IMK_OK)
        status = check_settings(layout, settings, error);
    if (status == IMK_OK && settings->axes)
        status = apply_axes(layout, settings->axes, error);
    if (status != IMK_OK)
        return status;
    for (size_t i = 0; i < cell_count; i++)
        if (layout->cell_column[i] >= 0 && layout->cell_column[i] != layout->time_column)
            layout->cell_factor[i] = layout->factor[layout->cell_column[i]];
    return IMK_OK;
}

imk_status imki_log_first_rows(imk_log_reader *reader, uint64_t rows, const double time[2],
                               const char *none, const char *due, imk_error *error)
{
    const imki_log_layout_read *layout = &reader->layout;
    if (rows == 0)
        return imk_error_set(error, IMK_ERROR_EMPTY, "", none, due);
    if (rows < 2 && layout->has_increments && reader->rate == 0.0)
        return imk_error_set(error, IMK_ERROR_TOO_SHORT, "",
                             "a single row of increments does not tell the sampling rate",
                             "give two rows, or add --rate 100Hz (samples per second)");
    if (layout->time_column >= 0) {
        const double scale = layout->factor[layout->time_column];
        if (fabs(time[0]) * scale > 1e6)
            reader->time_origin = time[0];
        reader->last_step = (time[1] - time[0]) * scale;
    }
    return IMK_OK;
}
