/* SPDX-License-Identifier: Apache-2.0 */
/* The instruments there are, and the design of one. */
#include "physics_parts.h"

#include <stdlib.h>
#include <string.h>

/* ---- the list -------------------------------------------------------------------------------- */

json_t *physics_instrument_json(const imk_instrument *instrument)
{
    return json_pack("{s:s, s:s, s:s, s:s, s:s}", "name", instrument->name, "title",
                     instrument->title, "sensor", instrument->sensor == IMK_GYRO ? "gyro" : "accel",
                     "technology", instrument->technology, "source", instrument->source);
}

int physics_list(const physics_options *o)
{
    if (o->json) {
        json_t *list = json_array();
        for (size_t i = 0; i < imk_instrument_count(); i++)
            json_array_append_new(list, physics_instrument_json(imk_instrument_get(i)));
        return json_print("physics", json_object(), json_pack("{s:o}", "instruments", list),
                          EXIT_DONE);
    }
    text_table table = text_table_make(4);
    static const char *const headers[] = {"name", "instrument", "technology", "measures"};
    text_table_row(&table);
    for (size_t c = 0; c < 4; c++)
        text_table_set(&table, c, "%s", headers[c]);
    for (size_t i = 0; i < imk_instrument_count(); i++) {
        const imk_instrument *instrument = imk_instrument_get(i);
        text_table_row(&table);
        text_table_set(&table, 0, "%s", instrument->name);
        text_table_set(&table, 1, "%s", instrument->title);
        text_table_set(&table, 2, "%s", instrument->technology[0] ? instrument->technology : "-");
        text_table_set(&table, 3, "%s",
                       instrument->sensor == IMK_GYRO ? "angular rate" : "specific force");
    }
    text_table_print(&table, stdout);
    text_table_free(&table);
    printf("\nDefault designs\n");
    for (size_t i = 0; i < imk_instrument_count(); i++)
        printf("  %s: %s\n", imk_instrument_get(i)->name, imk_instrument_get(i)->source);
    printf("\nOne of them: imukit physics NAME\n"
           "A design of your own: imukit physics NAME --show > mine.yaml\n");
    return EXIT_DONE;
}

/* ---- one design ------------------------------------------------------------------------------ */

int physics_show(const physics *p)
{
    imk_error error;
    char *text = NULL;
    size_t size;
    imk_status status;
    if (p->options->output)
        status = imk_design_write(p->options->output, &p->file, &error);
    else
        status = imk_design_print(&p->file, &text, &size, &error);
    if (status != IMK_OK)
        return command_error(&error, NULL);
    if (text)
        fwrite(text, 1, size, stdout);
    free(text);
    return EXIT_DONE;
}

text_table physics_design_table(const physics *p)
{
    const imk_instrument *instrument = p->file.instrument;
    text_table table = text_table_make(3);
    static const char *const headers[] = {"parameter", "value", ""};
    text_table_row(&table);
    for (size_t c = 0; c < 3; c++)
        text_table_set(&table, c, "%s", headers[c]);
    for (size_t i = 0; i < instrument->field_count; i++) {
        char value[CELL_SIZE] = "";
        (void)imk_design_field_text(&instrument->fields[i], p->file.design, 6, value, sizeof value);
        text_table_row(&table);
        text_table_set(&table, 0, "%s", instrument->fields[i].path);
        text_table_set(&table, 1, "%s", value);
        text_table_set(&table, 2, "%s", instrument->fields[i].help);
    }
    return table;
}

static json_t *field_json(const imk_design_field *field, const void *design)
{
    const char *place = (const char *)design + field->offset;
    char text[CELL_SIZE] = "", si[48];
    double number;
    int whole;
    bool is_on;
    switch (field->kind) {
    case IMK_DESIGN_NUMBER:
        memcpy(&number, place, sizeof number);
        imk_dimension_si(imk_unit_of(field->unit).dimension, si, sizeof si);
        return json_quantity(number, si);
    case IMK_DESIGN_COUNT:
        memcpy(&whole, place, sizeof whole);
        return json_integer(whole);
    case IMK_DESIGN_SWITCH:
        memcpy(&is_on, place, sizeof is_on);
        return json_boolean(is_on);
    case IMK_DESIGN_CHOICE:
        break;
    }
    (void)imk_design_field_text(field, design, 0, text, sizeof text);
    return json_string(text);
}

json_t *physics_design_json(const physics *p)
{
    const imk_instrument *instrument = p->file.instrument;
    json_t *design = json_object();
    for (size_t i = 0; i < instrument->field_count; i++)
        json_object_set_new(design, instrument->fields[i].path,
                            field_json(&instrument->fields[i], p->file.design));
    return design;
}

static void print_signals(const char *title, size_t count, const imk_signal *signals)
{
    if (count == 0)
        return;
    printf("\n%s\n", title);
    for (size_t i = 0; i < count; i++)
        printf("  %s [%s]: %s\n", signals[i].name, signals[i].unit, signals[i].help);
}

int physics_overview(const physics *p)
{
    const imk_instrument *instrument = p->file.instrument;
    if (p->options->json)
        return json_print("physics", json_pack("{s:o}", "design", json_text(p->source)),
                          json_pack("{s:o, s:o, s:o}", "instrument",
                                    physics_instrument_json(instrument), "design",
                                    physics_design_json(p), "reduced",
                                    physics_model_json(p->model, instrument->sensor)),
                          EXIT_DONE);
    const char *bold = command_color(stdout, COLOR_BOLD),
               *reset = command_color(stdout, COLOR_RESET);
    printf("%s%s%s%s%s\nDefault design: %s\n\n", bold,
           p->file.name[0] ? p->file.name : instrument->title, reset, p->file.name[0] ? ": " : "",
           p->file.name[0] ? instrument->title : "", instrument->source);
    text_table table = physics_design_table(p);
    text_table_print(&table, stdout);
    text_table_free(&table);
    print_signals("Outputs", instrument->output_count, instrument->outputs);
    print_signals("Inside (--signals)", instrument->signal_count, instrument->signals);
    if (instrument->view_count > 0)
        printf("\nViews (--view NUMBER --plot FILE)\n");
    for (size_t i = 0; i < instrument->view_count; i++)
        printf("  %zu: %s\n", i + 1, instrument->views[i].title);
    printf("\nNext\n"
           "  imukit physics %s --%s --duration 10s -o out.csv\n"
           "  imukit physics %s --report report.html\n"
           "  imukit physics %s --reduce -o model.yaml\n"
           "  imukit physics %s --sweep\n",
           p->source, instrument->sensor == IMK_GYRO ? "rate \"10 deg/s\"" : "acceleration \"1 g\"",
           p->source, p->source, p->source);
    return EXIT_DONE;
}
