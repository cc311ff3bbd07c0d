/* SPDX-License-Identifier: Apache-2.0 */
/* What the header and the settings leave open, or say differently. All that is missing comes in one
 * message; a unit that the file does not show is UNIT in it, so that nobody runs a command with a
 * unit that was only an example. */
#include "log_columns_internal.h"

#include "base/text_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Is this the unit of the text? */
static bool is_unit(const imk_unit *unit, const imk_unit *other)
{
    return imk_dimension_equal(unit->dimension, other->dimension) &&
           fabs(unit->scale - other->scale) <= 1e-12 * fabs(other->scale) &&
           unit->offset == other->offset;
}

/* The kind that the option of `asked` is of and that the unit does not fit; NULL: it fits a column,
 * or where there is none, a kind that there might be. */
static const imki_log_kind *misfit(const imki_log_layout_read *layout, const imki_log_kind *asked,
                                   const imk_unit *unit)
{
    const imki_log_kind *due = NULL;
    bool fits = false;
    for (size_t i = 0; i < IMKI_LOG_KINDS; i++) {
        const imki_log_kind *k = &imki_log_kinds[i];
        if (!k->option || !asked->option || strcmp(k->option, asked->option) != 0)
            continue;
        fits = fits || imki_log_unit_fits(k, unit);
        for (size_t j = 0; j < layout->column_count; j++) {
            const imk_log_column *column = &layout->column[j];
            if (column->quantity != k->quantity || column->increment != k->increment)
                continue;
            if (imki_log_unit_fits(k, unit))
                return NULL;
            due = due ? due : k;
        }
    }
    return due ? due : fits ? NULL : asked;
}

/* A column whose unit the file states otherwise. */
static imk_status check_agreement(const imki_log_layout_read *layout, const imki_log_kind *kind,
                                  const imk_unit *unit, const char *text, imk_error *error)
{
    for (size_t i = 0; i < layout->column_count; i++) {
        const imk_log_column *column = &layout->column[i];
        char found[96];
        if (column->quantity != kind->quantity || column->increment != kind->increment ||
            column->unit_origin == IMK_UNIT_OF_SETTINGS || is_unit(&column->unit, unit) ||
            !imki_log_unit_fits(kind, unit))
            continue;
        bool dates = false;
        for (size_t k = 0; k < layout->cell_count; k++)
            dates = dates || (layout->cell_column[k] == (int)i && layout->date_cell[k]);
        dates = dates && kind->quantity == IMK_QUANTITY_TIME;
        snprintf(found, sizeof found,
                 dates ? "%s %.30s does not agree with the file, whose times are dates"
                       : "%s %.12s does not agree with the file, which says %.20s [%.16s]",
                 kind->option, text, column->name, column->unit.text);
        return imk_error_set(error, IMK_ERROR_CONFLICT, "", found,
                             "leave the option out, or correct the unit in the header if it is "
                             "wrong");
    }
    return IMK_OK;
}

imk_status imki_log_settings_check(const imki_log_layout_read *layout,
                                   const imk_log_settings *settings, imk_error *error)
{
    for (size_t i = 0; i < IMKI_LOG_KINDS; i++) {
        const imki_log_kind *kind = &imki_log_kinds[i];
        const char *text = imki_log_unit_setting(kind->quantity, settings);
        imk_unit unit;
        if (!text)
            continue;
        imk_status status =
            imki_log_unit_read((imki_log_piece){text, text + strlen(text)}, kind, &unit, error);
        if (status != IMK_OK) {
            if (error)
                snprintf(error->field, sizeof error->field, "%s", kind->option);
            return status;
        }
        const imki_log_kind *due = misfit(layout, kind, &unit);
        if (due)
            return imki_log_unit_refuse(due, &unit, due->option, error);
        status = check_agreement(layout, kind, &unit, text, error);
        if (status != IMK_OK)
            return status;
    }
    return IMK_OK;
}

/* A column whose unit says that it is a time, by whatever name: "tempo [s]". */
static const char *find_time(const imki_log_layout_read *layout)
{
    for (size_t i = 0; i < layout->column_count; i++) {
        const imk_log_column *c = &layout->column[i];
        if (c->quantity == IMK_QUANTITY_OTHER &&
            imk_dimension_equal(c->unit.dimension, imk_unit_of("s").dimension))
            return c->name;
    }
    return NULL;
}

static void note_missing(const imki_log_cell *cells, imki_log_layout_read *layout,
                         const imk_log_settings *settings)
{
    imki_log_missing *m = &layout->missing;
    m->rate = layout->time_column < 0 && settings->rate == 0.0;
    for (size_t i = 0; i < layout->cell_count; i++) {
        const imki_log_kind *kind = cells[i].name.kind;
        bool known = false;
        if (!cells[i].lacks_unit)
            continue;
        m->cell[i] = true;
        for (size_t k = 0; k < m->count; k++)
            known = known || strcmp(imki_log_kinds[m->kind[k]].option, kind->option) == 0;
        if (known)
            continue;
        m->first[m->count] = layout->cell_column[i];
        m->kind[m->count++] = (size_t)(kind - imki_log_kinds);
    }
}

/* "time", "gyro_x" have no unit, and the log has no time column. */
static void word_found(const imki_log_layout_read *layout, size_t size, char *found)
{
    const imki_log_missing *m = &layout->missing;
    size_t cells = 0;
    found[0] = '\0';
    for (size_t i = 0; i < IMK_LOG_COLUMNS_MAX; i++)
        cells += m->cell[i];
    for (size_t k = 0; k < m->count; k++) {
        imki_append_text(found, size, k == 0 ? "\"" : ", \"");
        imki_append_text(found, size, layout->column[m->first[k]].name);
        imki_append_text(found, size, "\"");
    }
    if (m->count > 0 && cells > m->count)
        imki_append_text(found, size, ", …");
    imki_append_text(found, size, cells > 1 ? " have no unit" : " has no unit");
    if (m->rate)
        imki_append_text(found, size, ", and there is no time column");
}

/* The units that an option may state, or what the file shows of them. */
static void explain(const imki_log_missing *m, const imki_log_hints *hints,
                    const imki_log_kind *kind, size_t size, char *text)
{
    char one[160] = "";
    const bool time = kind->quantity == IMK_QUANTITY_TIME;
    if (time && hints && hints->time_unit)
        snprintf(one, sizeof one, "times such as %.24s look like %s since 1970", hints->time,
                 hints->time_words);
    else if (m->count == 1)
        snprintf(one, sizeof one, "UNIT is the unit of the log: %s, …", kind->examples);
    if (one[0] == '\0')
        return;
    imki_append_text(text, size, text[0] ? "; " : "");
    imki_append_text(text, size, one);
}

imk_status imki_log_missing_refuse(const imki_log_layout_read *layout, const imki_log_hints *hints,
                                   imk_error *error)
{
    const imki_log_missing *m = &layout->missing;
    const char *time = m->rate ? find_time(layout) : NULL;
    if (m->rate && !time && hints && hints->time_like >= 0)
        time = layout->column[hints->time_like].name;
    char found[96], expected[400] = "add", why[400] = "", one[160];
    for (size_t k = 0; k < m->count; k++) {
        const imki_log_kind *kind = &imki_log_kinds[m->kind[k]];
        const bool shown = kind->quantity == IMK_QUANTITY_TIME && hints && hints->time_unit;
        snprintf(one, sizeof one, " %s %s", kind->option, shown ? hints->time_unit : "UNIT");
        imki_append_text(expected, sizeof expected, one);
        explain(m, hints, kind, sizeof why, why);
    }
    if (m->count > 1)
        imki_append_text(why, sizeof why,
                         why[0] ? "; UNIT is the unit of the log" : "UNIT is the unit of the log");
    if (m->count > 0 && hints && hints->counts)
        imki_append_text(why, sizeof why,
                         "; the readings are whole numbers: count, if they are those of the "
                         "converter");
    if (m->rate) {
        imki_append_text(expected, sizeof expected, " --rate RATE");
        imki_append_text(why, sizeof why,
                         why[0] ? "; RATE: samples per second, as 100Hz"
                                : "samples per second, as in --rate 100Hz");
    }
    if (time) {
        snprintf(one, sizeof one,
                 "; if %.40s is the time, name it so with --columns, or with --map "
                 "\"time=%.40s,...\"",
                 time, time);
        imki_append_text(why, sizeof why, one);
    }
    imki_append_text(expected, sizeof expected, " (");
    imki_append_text(expected, sizeof expected, why);
    imki_append_text(expected, sizeof expected, ")");
    if (m->count == 0)
        return imk_error_set(error, IMK_ERROR_RATE_MISSING, "time", "the log has no time column",
                             expected);
    word_found(layout, sizeof found, found);
    return imk_error_set(error, IMK_ERROR_UNIT_MISSING, "", found, expected);
}

imk_status imki_log_missing_check(const imki_log_cell *cells, imki_log_layout_read *layout,
                                  const imk_log_settings *settings, imk_error *error)
{
    note_missing(cells, layout, settings);
    return !settings->as_written && (layout->missing.count > 0 || layout->missing.rate)
               ? imki_log_missing_refuse(layout, NULL, error)
               : IMK_OK;
}
