/* SPDX-License-Identifier: Apache-2.0 */
/* imukit devices: the catalogue of real devices and grade presets. */
#include "shell/json_output.h"
#include "shell/text_table.h"

#include "imukit/model_file.h"

#include <stdlib.h>
#include <string.h>

typedef struct devices_options {
    bool json;
} devices_options;

static const option devices_option_table[] = {
    {"json", 0, OPTION_FLAG, NULL, NULL, NULL, "print as JSON", offsetof(devices_options, json)},
};

static int run(int count, char **words);

const verb devices_verb = {
    .name = "devices",
    .summary = "catalogue of real devices and grade presets",
    .operands = "[NAME]",
    .operands_minimum = 0,
    .operands_maximum = 1,
    .examples = {{"imukit devices", "every entry with its main figures"},
                 {"imukit devices ADIS16488", "one entry: its source, notes and model file"}},
    .description = "Any name may stand where a verb asks for a MODEL. Figures are of the axis "
                   "given first; bias instability is B of IEEE 952: datasheets that quote the "
                   "floor of the Allan deviation were divided by 0.664, and the note says so.",
    .groups = {{"Options", 1, devices_option_table, 0}},
    .run = run};

/* The figures of the overview: gyro N and B, accelerometer N and B. */
typedef struct headline {
    const char *title, *unit, *si;
    double value; /* SI; 0: not stated */
} headline;
enum { HEADLINES = 4 };

static void headlines(const imk_model *model, headline *line)
{
    const imk_noise *gyro = &model->gyro.noise, *accel = &model->accel.noise;
    line[0] = (headline){"gyro N", "deg/sqrt(h)", "rad/sqrt(s)", gyro->white.value[0]};
    line[1] = (headline){"gyro B", "deg/h", "rad/s", gyro->bias_instability.value[0]};
    line[2] = (headline){"accel N", "m/s/sqrt(h)", "m/s/sqrt(s)", accel->white.value[0]};
    line[3] = (headline){"accel B", "ug", "m/s^2", accel->bias_instability.value[0]};
}

static void print_overview(imk_model *model)
{
    headline line[HEADLINES] = {{0}};
    text_table table = text_table_make(2 + HEADLINES);
    table.right = 0x3cu; /* the figures */
    text_table_row(&table);
    text_table_set(&table, 0, "name");
    text_table_set(&table, 1, "class");
    for (size_t d = 0; d < imk_device_count(); d++) {
        const imk_device *device = imk_device_get(d);
        imk_device_model(device, model);
        headlines(model, line);
        if (d == 0)
            for (size_t k = 0; k < HEADLINES; k++)
                text_table_set(&table, 2 + k, "%s [%s]", line[k].title, line[k].unit);
        text_table_row(&table);
        text_table_set(&table, 0, "%s", device->name);
        text_table_set(&table, 1, "%s", device->is_preset ? "grade preset" : device->grade);
        for (size_t k = 0; k < HEADLINES; k++)
            if (line[k].value > 0)
                text_table_set(&table, 2 + k, "%.4g",
                               line[k].value / imk_unit_of(line[k].unit).scale);
            else
                text_table_set(&table, 2 + k, "-");
    }
    text_table_print(&table, stdout);
    text_table_free(&table);
    printf("\nOne entry with its source: imukit devices NAME\n"
           "Simulate it: imukit simulate NAME --rate 100Hz --duration 1h -o static.csv\n");
}

static json_t *device_json(const imk_device *device, imk_model *model)
{
    headline line[HEADLINES];
    json_t *figures = json_object();
    imk_device_model(device, model);
    headlines(model, line);
    for (size_t k = 0; k < HEADLINES; k++)
        json_object_set_new(figures, line[k].title,
                            line[k].value > 0 ? json_quantity(line[k].value, line[k].si)
                                              : json_null());
    return json_pack("{s:s, s:s, s:b, s:s, s:s, s:o}", "name", device->name, "grade", device->grade,
                     "preset", device->is_preset, "source", device->source, "note", device->note,
                     "figures", figures);
}

static int print_json(const imk_device *only, imk_model *model)
{
    json_t *list = json_array();
    for (size_t d = 0; d < imk_device_count(); d++) {
        const imk_device *device = imk_device_get(d);
        if (!only || device == only)
            json_array_append_new(list, device_json(device, model));
    }
    json_t *inputs = only ? json_pack("{s:s}", "name", only->name) : json_object();
    return json_print("devices", inputs, json_pack("{s:o}", "devices", list), EXIT_DONE);
}

static int print_entry(const imk_device *device, imk_model *model)
{
    char *text = NULL;
    size_t size;
    imk_error error;
    imk_device_model(device, model);
    if (imk_model_print(model, NULL, &text, &size, &error) != IMK_OK)
        return command_error(&error, device->name);
    printf("# %s (%s)\n# source: %s\n", device->name, device->grade, device->source);
    if (device->note[0])
        printf("# note: %s\n", device->note);
    fwrite(text, 1, size, stdout);
    free(text);
    return EXIT_DONE;
}

static int unknown(const char *name)
{
    size_t count = imk_device_count();
    const char **names = malloc(count * sizeof *names);
    if (!names)
        return command_failed("memory is exhausted");
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
    imk_model *model = malloc(sizeof *model);
    if (!model)
        return command_failed("memory is exhausted");
    code = EXIT_DONE;
    if (o.json)
        code = print_json(device, model);
    else if (device)
        code = print_entry(device, model);
    else
        print_overview(model);
    free(model);
    return code;
}
