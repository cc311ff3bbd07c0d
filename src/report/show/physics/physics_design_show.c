/* SPDX-License-Identifier: Apache-2.0 */
/* The list of instruments, and the design of one of them. */
#include "physics_show_internal.h"

#include <string.h>

void imki_instrument_data(const imk_instrument *instrument, const char *key, imk_result *result)
{
    imk_result_object(result, key);
    imk_result_text(result, "name", instrument->name);
    imk_result_text(result, "title", instrument->title);
    imk_result_text(result, "sensor", instrument->sensor == IMK_GYRO ? "gyro" : "accel");
    imk_result_text(result, "technology", instrument->technology);
    imk_result_text(result, "source", instrument->source);
    imk_result_end(result);
}

void imk_show_instruments(imk_result *result)
{
    imk_result_object(result, "inputs");
    imk_result_end(result);
    imk_result_object(result, "result");
    imk_result_array(result, "instruments");
    imk_table *table = imk_result_table(result, 0);
    imk_table_row(table, "name\tinstrument\ttechnology\tmeasures");
    imk_result_line(result, "\nDefault designs");
    for (size_t i = 0; i < imk_instrument_count(); i++) {
        const imk_instrument *instrument = imk_instrument_get(i);
        imki_instrument_data(instrument, NULL, result);
        imk_table_row(table, "%s\t%s\t%s\t%s", instrument->name, instrument->title,
                      instrument->technology[0] ? instrument->technology : "-",
                      instrument->sensor == IMK_GYRO ? "angular rate" : "specific force");
        imk_result_line(result, "  %s: %s", instrument->name, instrument->source);
    }
    imk_result_end(result);
    imk_result_end(result);
}

/* ---- one design ------------------------------------------------------------------------------ */

enum { VALUE_SIZE = 120 };

void imki_show_design(const imk_physics_shown *p, imk_result *result)
{
    const imk_instrument *instrument = p->settings->instrument;
    imk_table *table = imk_result_table(result, 0);
    imk_table_row(table, "parameter\tvalue\t");
    for (size_t i = 0; i < instrument->field_count; i++) {
        const imk_design_field *field = &instrument->fields[i];
        char value[VALUE_SIZE] = "";
        (void)imk_design_field_text(field, p->settings->design, 6, value, sizeof value);
        imk_table_row(table, "%s\t%s\t%s", field->path, value, field->help);
    }
}

static void field_data(const imk_design_field *field, const void *design, imk_result *result)
{
    const char *place = (const char *)design + field->offset;
    char text[VALUE_SIZE] = "", si[48];
    double number;
    int whole;
    bool is_on;
    switch (field->kind) {
    case IMK_DESIGN_NUMBER:
        memcpy(&number, place, sizeof number);
        imk_dimension_si(imk_unit_of(field->unit).dimension, si, sizeof si);
        imk_result_quantity(result, field->path, number, si);
        break;
    case IMK_DESIGN_COUNT:
        memcpy(&whole, place, sizeof whole);
        imk_result_count(result, field->path, whole);
        break;
    case IMK_DESIGN_SWITCH:
        memcpy(&is_on, place, sizeof is_on);
        imk_result_flag(result, field->path, is_on);
        break;
    case IMK_DESIGN_CHOICE:
        (void)imk_design_field_text(field, design, 0, text, sizeof text);
        imk_result_text(result, field->path, text);
    }
}

void imki_design_data(const imk_physics_shown *p, imk_result *result)
{
    const imk_instrument *instrument = p->settings->instrument;
    imk_result_object(result, "design");
    for (size_t i = 0; i < instrument->field_count; i++)
        field_data(&instrument->fields[i], p->settings->design, result);
    imk_result_end(result);
}

static void show_signals(const char *title, size_t count, const imk_signal *signals,
                         imk_result *result)
{
    if (count > 0)
        imk_result_line(result, "\n%s", title);
    for (size_t i = 0; i < count; i++)
        imk_result_line(result, "  %s [%s]: %s", signals[i].name, signals[i].unit, signals[i].help);
}

void imki_show_overview(const imk_physics_shown *p, imk_result *result)
{
    const imk_instrument *instrument = p->settings->instrument;
    const bool named = p->name && p->name[0];
    imk_result_line(result, IMK_BOLD "%s" IMK_PLAIN "%s%s\nDefault design: %s\n",
                    imki_physics_name(p), named ? ": " : "", named ? instrument->title : "",
                    instrument->source);
    imki_show_design(p, result);
    imk_result_line(result, "\nDerived quantities");
    imki_show_derived(p, result);
    show_signals("Outputs", instrument->output_count, instrument->outputs, result);
    show_signals("Inside (--signals)", instrument->signal_count, instrument->signals, result);
    if (instrument->view_count > 0)
        imk_result_line(result, "\nViews (--view NUMBER --plot FILE)");
    for (size_t i = 0; i < instrument->view_count; i++)
        imk_result_line(result, "  %zu: %s", i + 1, instrument->views[i].title);
}
