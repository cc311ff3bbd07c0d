/* SPDX-License-Identifier: Apache-2.0 */
/* imukit devices: the catalogue of real devices and grade presets. */
#include "shell/show.h"

#include "imukit/model_file.h"

#include <stdlib.h>
#include <string.h>

typedef struct devices_options {
    bool json;
} devices_options;

static const option devices_option_table[] = {
    {"json", OPTION_FLAG, offsetof(devices_options, json), .help = "print as JSON"},
};

/* The figures of the overview. */
static const struct {
    const char *title, *unit, *si;
    size_t offset; /* of the term in a model */
} headlines[] = {
    {"gyro N", "deg/sqrt(h)", "rad/sqrt(s)", offsetof(imk_model, gyro.noise.white)},
    {"gyro B", "deg/h", "rad/s", offsetof(imk_model, gyro.noise.bias_instability)},
    {"accel N", "m/s/sqrt(h)", "m/s/sqrt(s)", offsetof(imk_model, accel.noise.white)},
    {"accel B", "ug", "m/s^2", offsetof(imk_model, accel.noise.bias_instability)},
};
enum { HEADLINES = sizeof headlines / sizeof headlines[0] };

/* SI; 0: not stated. */
static double headline(const imk_model *model, size_t k)
{
    return ((const imk_axes *)((const char *)model + headlines[k].offset))->value[0];
}

static void show_data(const imk_device *device, const imk_model *model, imk_result *result)
{
    imk_result_object(result, NULL);
    imk_result_text(result, "name", device->name);
    imk_result_text(result, "grade", device->grade);
    imk_result_flag(result, "preset", device->is_preset);
    imk_result_text(result, "source", device->source);
    imk_result_text(result, "note", device->note);
    imk_result_object(result, "figures");
    for (size_t k = 0; k < HEADLINES; k++)
        if (headline(model, k) > 0)
            imk_result_quantity(result, headlines[k].title, headline(model, k), headlines[k].si);
        else
            imk_result_null(result, headlines[k].title);
    imk_result_end(result);
    imk_result_end(result);
}

static void show_row(const imk_device *device, const imk_model *model, imk_table *table)
{
    imk_table_row(table, "%s\t%s", device->name,
                  device->is_preset ? "grade preset" : device->grade);
    for (size_t k = 0; k < HEADLINES; k++)
        if (headline(model, k) > 0)
            imk_table_add(table, "%.4g", headline(model, k) / imk_unit_of(headlines[k].unit).scale);
        else
            imk_table_add(table, "-");
}

static imk_table *begin_table(imk_result *result)
{
    imk_table *table = imk_result_table(result, 0x3cU); /* the figures to the right */
    imk_table_row(table, "name\tclass");
    for (size_t k = 0; k < HEADLINES; k++)
        imk_table_add(table, "%s [%s]", headlines[k].title, headlines[k].unit);
    imk_result_line(result, "\nOne entry with its source: imukit devices NAME\n"
                            "Simulate it: imukit simulate NAME --rate 100Hz --duration 1h -o "
                            "static.csv");
    return table;
}

static void show_entry(const imk_device *device, const imk_model *model, imk_result *result)
{
    char *text = NULL;
    size_t size = 0;
    imk_result_line(result, "# %s (%s)\n# source: %s", device->name, device->grade, device->source);
    if (device->note[0])
        imk_result_line(result, "# note: %s", device->note);
    (void)command_unless_memory(imk_model_print(model, NULL, &text, &size, NULL));
    if (size > 0)
        text[size - 1] = '\0'; /* the line feed, which the result adds */
    imk_result_code(result, text);
    free(text);
}

/* @param only  NULL: all */
static void show(const imk_device *only, imk_model *model, imk_result *result)
{
    imk_result_object(result, "inputs");
    if (only)
        imk_result_text(result, "name", only->name);
    imk_result_end(result);
    imk_result_object(result, "result");
    imk_result_array(result, "devices");
    imk_table *table = only ? NULL : begin_table(result);
    for (size_t d = 0; d < imk_device_count(); d++) {
        const imk_device *device = imk_device_get(d);
        if (only && device != only)
            continue;
        imk_device_model(device, model);
        show_data(device, model, result);
        if (only)
            show_entry(device, model, result);
        else
            show_row(device, model, table);
    }
    imk_result_end(result);
    imk_result_end(result);
}

static int unknown(const char *name)
{
    size_t count = imk_device_count();
    const char **names = command_memory(NULL, count * sizeof *names);
    for (size_t d = 0; d < count; d++)
        names[d] = imk_device_get(d)->name;
    const char *nearest = command_nearest(name, count, names);
    free(names);
    if (nearest)
        return command_failed("there is no device \"%s\"; did you mean \"%s\"?", name, nearest);
    return command_failed("there is no device \"%s\"; the names are listed by: imukit devices",
                          name);
}

static int run(int count, char **words)
{
    devices_options o = {0};
    const char *operands[OPERANDS_MAX];
    int code = options_parse(&devices_verb, count, words, &o, operands);
    if (code >= 0)
        return code;
    const imk_device *device = operands[0] ? imk_device_find(operands[0]) : NULL;
    if (operands[0] && !device)
        return unknown(operands[0]);
    imk_model *model = command_memory(NULL, sizeof *model);
    imk_result *result = show_begin("devices");
    show(device, model, result);
    free(model);
    return show_end(result, &(show_options){.json = o.json}, EXIT_DONE);
}

const verb devices_verb = {
    .name = "devices",
    .summary = "catalogue of real devices and grade presets",
    .operands = "[NAME]",
    .operands_minimum = 0,
    .operands_maximum = 1,
    .examples = {{"imukit devices", "every entry with its main figures"},
                 {"imukit devices ADIS16488", "one entry: its source, notes and model file"}},
    .description = "Every verb that takes a MODEL accepts these names. Figures are of the axis "
                   "given first; bias instability is B of IEEE 952: datasheets that quote the "
                   "floor of the Allan deviation were divided by 0.664, and the note says so.",
    .groups = {{"Options", 1, devices_option_table, 0}},
    .run = run};
