/* SPDX-License-Identifier: Apache-2.0 */
/* What the columns of a log are, from their names and units. Nothing is guessed: what is missing is
 * refused with the options that state it (log_missing.c), and an option that contradicts the file
 * is refused, too. */
#include "log_columns_internal.h"

#include "base/text_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* A column without meaning here: in SI if its unit is known. */
static void make_other(imki_log_cell *cell)
{
    imk_log_column *column = &cell->column;
    cell->name.kind = NULL;
    *column = (imk_log_column){.axis = -1};
    imki_log_piece_copy(column->name, sizeof column->name, cell->text);
    if (imk_unit_parse(cell->unit.begin, cell->unit.end, &column->unit, NULL) != IMK_OK) {
        column->unit = (imk_unit){.scale = 1.0};
        imki_log_piece_copy(column->unit.text, sizeof column->unit.text, cell->unit);
    }
}

/* An option states a unit where the file has none; one that is not known is named anew. */
static void advise(const imki_log_cell *cell, const imk_log_settings *settings, imk_error *error)
{
    static const char rest[] = "columns that --map does not name are not read";
    const imki_log_kind *kind = cell->name.kind;
    char name[48], meant[64] = "", way[200];
    if (kind->quantity == IMK_QUANTITY_TEMPERATURE) {
        snprintf(error->expected, sizeof error->expected,
                 "write the column in degC or K, or leave it out, with - in its place in "
                 "--columns, or with --map: %s",
                 rest);
        return;
    }
    imki_log_piece_copy(name, sizeof name, cell->text);
    if (error->expected[0] && !strchr(error->expected, ' '))
        snprintf(meant, sizeof meant, "did you mean %.24s? ", error->expected);
    if (settings->columns)
        snprintf(way, sizeof way, "in --columns, as %s [UNIT]", cell->column.name);
    else
        snprintf(way, sizeof way, "with --map, as in \"%s=%s [UNIT],...\"", cell->column.name,
                 settings->map ? "NAME" : name);
    snprintf(error->expected, sizeof error->expected,
             "%sif it is another word for a known unit, state that %s (UNIT: %s), or write it "
             "into the header; %s",
             meant, way, kind->examples ? kind->examples : "uT, nT, gauss", rest);
}

/* The unit of a known column: beside its name, at the end of the name, or of the settings. */
static imk_status find_unit(imki_log_cell *cell, const imk_log_settings *settings, bool dates,
                            imk_error *error)
{
    const imki_log_kind *kind = cell->name.kind;
    imki_log_piece unit = cell->unit;
    const char *text = kind->quantity == IMK_QUANTITY_TIME && dates ? "s"
                       : unit.begin < unit.end                      ? NULL
                                                                    : cell->name.unit;
    cell->column.unit_origin = IMK_UNIT_OF_HEADER;
    if (unit.begin == unit.end && !text) {
        text = imki_log_unit_setting(kind->quantity, settings);
        if (!text && imki_log_counted(settings, kind->quantity))
            text = "count";
        cell->column.unit_origin = IMK_UNIT_OF_SETTINGS;
        cell->lacks_unit = !text;
        if (!text) {
            cell->column.unit = (imk_unit){.scale = 1.0};
            return IMK_OK;
        }
    }
    if (text)
        unit = (imki_log_piece){text, text + strlen(text)};
    if (cell->name.unit && !dates) {
        const imki_log_piece end = {cell->name.unit, cell->name.unit + strlen(cell->name.unit)};
        const imk_status agree =
            imki_log_units_agree(cell->column.name, kind, cell->text, unit, end, error);
        if (agree != IMK_OK)
            return agree;
    }
    const imk_status status = imki_log_unit_read(unit, kind, &cell->column.unit, error);
    if (status == IMK_ERROR_UNIT_UNKNOWN && cell->column.unit_origin == IMK_UNIT_OF_HEADER)
        advise(cell, settings, error);
    if (status != IMK_OK)
        snprintf(error->field, sizeof error->field, "%s",
                 cell->column.unit_origin == IMK_UNIT_OF_SETTINGS ? kind->option
                                                                  : cell->column.name);
    return status;
}

/* Name and unit of a column whose kind is known. */
static imk_status make_known(imki_log_cell *cell, const imk_log_settings *settings, bool dates,
                             imk_error *error)
{
    const imki_log_name *name = &cell->name;
    imk_log_column *column = &cell->column;
    *column = (imk_log_column){
        .quantity = name->kind->quantity, .axis = name->axis, .increment = name->kind->increment};
    /* Numbers stay numbers: sets of more than three axes. */
    const char last = imki_lower(cell->text.end > cell->text.begin ? cell->text.end[-1] : '\0');
    const bool number = name->exact && last >= '0' && last <= '7';
    snprintf(column->name, sizeof column->name, "%s%c", name->kind->name,
             name->axis < 0 ? '\0'
             : number       ? last
                            : "xyz34567"[name->axis]);
    imk_error why = {.status = IMK_OK};
    const imk_status status = find_unit(cell, settings, dates, &why);
    const bool unknown = status == IMK_ERROR_UNIT_UNKNOWN || status == IMK_ERROR_SYNTAX;
    if (unknown && !name->kind->option) { /* as without a unit */
        make_other(cell);
        return IMK_OK;
    }
    if (status != IMK_OK && error)
        *error = why;
    if (status != IMK_OK || cell->lacks_unit)
        return status;
    if (imki_log_unit_fits(name->kind, &column->unit))
        return IMK_OK;
    if (name->exact || column->unit_origin == IMK_UNIT_OF_SETTINGS)
        return imki_log_unit_refuse(name->kind, &column->unit, column->name, error);
    make_other(cell);
    return IMK_OK;
}

/* Columns called as in sensor_msgs/Imu are of that message, whose linear_acceleration has gravity
 * in it. Beside other accelerometers, or without angular_velocity, the words are those of
 * telephones for what has none. */
static void judge_message(imki_log_cell *cells, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        imki_log_name *name = &cells[i].name;
        bool rates = false, forces = false;
        if (!name->kind || !name->of_message || name->kind->quantity != IMK_QUANTITY_SPECIFIC_FORCE)
            continue;
        for (size_t k = 0; k < count; k++) {
            const imki_log_name *other = &cells[k].name;
            const imk_quantity quantity = other->kind ? other->kind->quantity : IMK_QUANTITY_OTHER;
            rates = rates || (other->of_message && quantity == IMK_QUANTITY_ANGULAR_RATE &&
                              strcmp(other->group, name->group) == 0);
            forces = forces || (!other->of_message && quantity == IMK_QUANTITY_SPECIFIC_FORCE);
        }
        if (!rates || forces)
            cells[i].no_message = true;
    }
    for (size_t i = 0; i < count; i++)
        if (cells[i].no_message)
            cells[i].name.kind = NULL;
}

static bool is_word(imki_log_piece text, const char *word)
{
    while (text.begin < text.end && imki_lower(*text.begin) == *word && *word) {
        text.begin++;
        word++;
    }
    return text.begin == text.end && !*word;
}

/* Seconds beside minutes are those of a clock, and no time of their own. */
static void judge_seconds(imki_log_cell *cells, size_t count)
{
    bool minutes = false;
    for (size_t i = 0; i < count; i++)
        minutes = minutes || is_word(cells[i].text, "minute") ||
                  is_word(cells[i].text, "minutes") || is_word(cells[i].text, "min");
    for (size_t i = 0; i < count && minutes; i++)
        if (is_word(cells[i].text, "seconds"))
            cells[i].name.kind = NULL;
}

/* MATLAB's writetable() divides a matrix into columns _1, _2, _3, which are x, y, z where they are
 * all three, and no other number stands beside them. gyro_1 is of a set that counts from 0. */
static void count_from_one(imki_log_cell *cells, size_t count)
{
    bool shifted[IMK_LOG_COLUMNS_MAX] = {false};
    for (size_t i = 0; i < count; i++) {
        const imki_log_name *name = &cells[i].name;
        unsigned axes = 0;
        for (size_t k = 0; k < count && name->kind && name->numbered; k++)
            if (cells[k].name.kind == name->kind && cells[k].name.numbered &&
                strcmp(cells[k].name.group, name->group) == 0)
                axes |= 1U << cells[k].name.axis;
        shifted[i] = !name->exact && axes == (1U << 1 | 1U << 2 | 1U << 3);
    }
    for (size_t i = 0; i < count; i++)
        cells[i].name.axis -= shifted[i];
}

/* The letter T is a time, or by its unit a temperature or another quantity. */
static void judge_letter(imki_log_cell *cell)
{
    const imki_log_kind *temperature = imki_log_kind_of(IMK_QUANTITY_TEMPERATURE);
    imk_unit unit;
    if (!cell->name.kind || cell->name.kind->quantity != IMK_QUANTITY_TIME ||
        cell->text.end - cell->text.begin != 1 || cell->unit.begin == cell->unit.end)
        return;
    const imk_status status = imki_log_unit_read(cell->unit, cell->name.kind, &unit, NULL);
    if (status == IMK_OK && imki_log_unit_fits(cell->name.kind, &unit))
        return;
    if (imki_log_unit_read(cell->unit, temperature, &unit, NULL) == IMK_OK &&
        imki_log_unit_fits(temperature, &unit))
        cell->name.kind = temperature;
    else if (status == IMK_OK)
        cell->name.kind = NULL;
    cell->name.exact = cell->name.exact && cell->name.kind != temperature;
}

/* "G_X" may be gravity, or a gyro; by the unit of a rate it is a gyro. */
static void judge_g(imki_log_cell *cell)
{
    const imki_log_kind *gyro = imki_log_kind_of(IMK_QUANTITY_ANGULAR_RATE);
    char name[] = "w_x"; /* the letter that is a gyro alone */
    imk_unit unit;
    if (cell->name.kind || cell->text.end - cell->text.begin != 3 ||
        imki_lower(*cell->text.begin) != 'g' ||
        imk_unit_parse(cell->unit.begin, cell->unit.end, &unit, NULL) != IMK_OK ||
        !imk_dimension_equal(unit.dimension, imk_unit_of(gyro->unit).dimension))
        return;
    name[1] = cell->text.begin[1];
    name[2] = cell->text.begin[2];
    cell->name = imki_log_name_of(name);
}

void imki_log_cells_name(const imki_log_piece *header, size_t count, imki_log_cell *cells)
{
    for (size_t i = 0; i < count; i++) {
        imki_log_cell *cell = &cells[i];
        char text[sizeof cell->column.name];
        *cell = (imki_log_cell){.text = header[i]};
        imki_log_unit_split(&cell->text, &cell->unit);
        const size_t length = (size_t)(cell->text.end - cell->text.begin);
        cell->skipped = cell->unit.begin == cell->unit.end &&
                        (length == 0 || (length == 1 && *cell->text.begin == '-'));
        imki_log_piece_copy(text, sizeof text, cell->text);
        cell->name = cell->skipped ? (imki_log_name){.axis = -1} : imki_log_name_of(text);
        judge_letter(cell);
        judge_g(cell);
        const imki_log_kind *kind = cell->name.kind;
        if (kind && !kind->option && cell->unit.begin == cell->unit.end && !cell->name.unit)
            cell->name.kind = NULL;
    }
    judge_message(cells, count);
    judge_seconds(cells, count);
    count_from_one(cells, count);
}

bool imki_log_cells_same(const imki_log_cell *a, const imki_log_cell *b)
{
    return a->name.kind && b->name.kind && a->name.kind->quantity == b->name.kind->quantity &&
           a->name.axis == b->name.axis;
}

static bool has_unit(const imki_log_cell *cell)
{
    return cell->unit.begin < cell->unit.end || cell->name.unit;
}

/* Of two columns for the same, the one with the exact name; of two times, the one with a unit.
 * @return the one to leave; NULL: neither is better */
static imki_log_cell *worse_of(imki_log_cell *a, imki_log_cell *b)
{
    if (a->name.exact != b->name.exact)
        return a->name.exact ? b : a;
    if (a->name.kind->quantity == IMK_QUANTITY_TIME && has_unit(a) != has_unit(b))
        return has_unit(a) ? b : a;
    return NULL;
}

static imk_status refuse_twice(const imki_log_cell *a, const imki_log_cell *b, imk_error *error)
{
    char found[96], name[48], first[24], second[24];
    snprintf(name, sizeof name, "%s%.*s", a->name.kind->name, a->name.axis >= 0,
             a->name.axis >= 0 ? &"xyz34567"[a->name.axis] : "");
    imki_log_piece_copy(first, sizeof first, a->text);
    imki_log_piece_copy(second, sizeof second, b->text);
    snprintf(found, sizeof found, "this column is in the file twice, as %s and %s", first, second);
    return imk_error_set(error, IMK_ERROR_COLUMN, name, found,
                         "say which columns to read: --map with a name for each, such as "
                         "--map gyro_x=NAME,gyro_y=NAME, or - in place of the other in --columns");
}

static imk_status resolve_doubles(imki_log_cell *cells, size_t count, imk_error *error)
{
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; k < i; k++) {
            if (!imki_log_cells_same(&cells[k], &cells[i]))
                continue;
            imki_log_cell *worse = worse_of(&cells[k], &cells[i]);
            if (!worse)
                return refuse_twice(&cells[k], &cells[i], error);
            worse->name.kind = NULL;
        }
    return IMK_OK;
}

/* Turn the columns of the first three axes to forward-right-down. */
static imk_status apply_axes(imki_log_layout_read *layout, const char *axes, imk_error *error)
{
    int body[3];
    double sign[3];
    const imk_status status = imki_log_axes_parse(axes, body, sign, error);
    if (status != IMK_OK)
        return status;
    for (int a = 0; a < 3; a++)
        layout->axes_turned = layout->axes_turned || body[a] != a || sign[a] != 1.0;
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

/* Is any column of use? */
static imk_status check_known(const imki_log_layout_read *layout, const imk_log_settings *settings,
                              imk_error *error)
{
    bool known = settings->columns || settings->any_columns;
    const bool any = settings->any_columns;
    bool axis[3] = {false};
    for (size_t i = 0; i < layout->column_count; i++) {
        const imk_log_column *c = &layout->column[i];
        known = known || c->quantity != IMK_QUANTITY_OTHER;
        const bool position = imk_dimension_equal(c->unit.dimension, imk_unit_of("m").dimension);
        for (int a = 0; a < 3; a++)
            axis[a] =
                axis[a] || (imki_lower(c->name[0]) == "xyz"[a] && c->name[1] == '\0' && !position);
    }
    if (layout->column_count == 0)
        return imk_error_set(error, IMK_ERROR_COLUMN, "columns", "every column is skipped",
                             "at least one name in --columns");
    const bool bare = !any && axis[0] && axis[1] && axis[2];
    for (size_t i = 0; bare && i < layout->column_count; i++)
        known = known && layout->column[i].axis >= 0;
    if (known)
        return IMK_OK;
    return imk_error_set(
        error, IMK_ERROR_COLUMN, layout->column[0].name,
        bare ? "the names x, y, z do not say of which sensor they are"
             : "no column has a known name",
        bare
            ? "say so: --map \"gyro_x=x,gyro_y=y,gyro_z=z\" for gyros, or accel_x and so on; with "
              "time=NAME for the time, and units as in gyro_x=x [UNIT]"
            : "known are time, gyro_x, dtheta_x, accel_x, dvel_x, mag_x, temperature, and the like "
              "(docs/logs.md); add --columns with a name for each column (- skips a column), or "
              "--map gyro_x=NAME,...");
}

static imk_status add_cell(imki_log_layout_read *layout, size_t index, imki_log_cell *cell,
                           const imk_log_settings *settings, imk_error *error)
{
    layout->cell_column[index] = -1;
    layout->cell_factor[index] = 1.0;
    if (cell->skipped)
        return IMK_OK;
    imk_status status = IMK_OK;
    if (cell->name.kind)
        status = make_known(cell, settings, layout->date_cell[index], error);
    else
        make_other(cell);
    if (status != IMK_OK)
        return status;
    const size_t column = layout->column_count++;
    layout->column[column] = cell->column;
    layout->cell_column[index] = (int)column;
    layout->factor[column] = cell->column.unit.scale;
    layout->offset[column] = cell->column.unit.offset;
    status = imki_log_counts_apply(settings, &layout->column[column], &layout->factor[column],
                                   &layout->offset[column], &layout->most[column], error);
    if (status != IMK_OK)
        return status;
    if (cell->column.quantity == IMK_QUANTITY_TIME)
        layout->time_column = (int)column;
    layout->has_increments |= cell->column.increment;
    return IMK_OK;
}

imk_status imki_log_layout_make(const imki_log_piece *header, size_t cell_count,
                                const imk_log_settings *settings, imki_log_layout_read *layout,
                                imk_error *error)
{
    imki_log_cell cells[IMK_LOG_COLUMNS_MAX];
    imki_log_piece mapped[IMK_LOG_COLUMNS_MAX];
    char text[IMK_LOG_COLUMNS_MAX][IMKI_LOG_NAME_SIZE];
    bool dates[IMK_LOG_COLUMNS_MAX];
    memcpy(dates, layout->date_cell, sizeof dates);
    *layout = (imki_log_layout_read){.cell_count = cell_count,
                                     .separator = layout->separator,
                                     .decimal_comma = layout->decimal_comma,
                                     .time_column = -1};
    memcpy(layout->date_cell, dates, sizeof dates);
    imk_status status = IMK_OK;
    if (settings->map)
        status = imki_log_map(settings->map, header, cell_count, text, mapped, error);
    if (status != IMK_OK)
        return status;
    imki_log_cells_name(settings->map ? mapped : header, cell_count, cells);
    status = resolve_doubles(cells, cell_count, error);
    for (size_t i = 0; i < cell_count && status == IMK_OK; i++)
        status = add_cell(layout, i, &cells[i], settings, error);
    if (status == IMK_OK)
        status = check_known(layout, settings, error);
    if (status == IMK_OK)
        status = imki_log_settings_check(layout, settings, error);
    if (status == IMK_OK)
        status = imki_log_missing_check(cells, layout, settings, error);
    if (status == IMK_OK && settings->axes)
        status = apply_axes(layout, settings->axes, error);
    if (status != IMK_OK)
        return status;
    for (size_t i = 0; i < cell_count; i++)
        if (layout->cell_column[i] >= 0 && layout->cell_column[i] != layout->time_column)
            layout->cell_factor[i] = layout->factor[layout->cell_column[i]];
    return IMK_OK;
}

void imki_log_layout_scale(imki_log_layout_read *layout, size_t cell, double factor)
{
    const int column = layout->cell_column[cell];
    if (column < 0)
        return;
    layout->factor[column] *= factor;
    if (column != layout->time_column)
        layout->cell_factor[cell] *= factor;
}
