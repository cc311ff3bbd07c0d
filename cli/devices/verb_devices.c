/* SPDX-License-Identifier: Apache-2.0 */
/* imukit devices: the catalogue of real devices and grade presets, and what a count of a part is.
 */
#include "shell/show.h"

#include "imukit/device_sensitivity.h"
#include "imukit/model_file.h"
#include "imukit/names.h"
#include "imukit/show.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct devices_options {
    bool json;
} devices_options;

static const option devices_option_table[] = {
    {"json", OPTION_FLAG, offsetof(devices_options, json), .help = "print as JSON"},
};

/* The figures of the overview, two of each sensor. */
static const struct {
    const char *title, *unit;
    const char *sensor, *key, *si; /* in JSON, as the model file calls them */
    size_t offset;                 /* of the term in a model */
} headlines[] = {
    {"gyro N", "deg/sqrt(h)", "gyro", "angle_random_walk", "rad/sqrt(s)",
     offsetof(imk_model, gyro.noise.white)},
    {"gyro B", "deg/h", "gyro", "bias_instability", "rad/s",
     offsetof(imk_model, gyro.noise.bias_instability)},
    {"accel N", "m/s/sqrt(h)", "accel", "velocity_random_walk", "m/s/sqrt(s)",
     offsetof(imk_model, accel.noise.white)},
    {"accel B", "ug", "accel", "bias_instability", "m/s^2",
     offsetof(imk_model, accel.noise.bias_instability)},
};
enum { HEADLINES = sizeof headlines / sizeof headlines[0] };

/* SI; 0: not stated. */
static double headline(const imk_model *model, size_t k)
{
    return ((const imk_axes *)((const char *)model + headlines[k].offset))->value[0];
}

/* A device of the catalogue, or a part of which only sensitivities are known. */
typedef struct subject {
    const char *name;
    const imk_device *device; /* NULL: sensitivities only */
} subject;

typedef struct subjects {
    size_t count;
    subject *of;
} subjects;

/* What there is, or what is asked for: the subject of that name, or those with it in theirs. */
static subjects select_subjects(const char *name)
{
    subjects all = {0}, chosen = {0};
    imk_device_sensitivity row;
    const size_t limit = imk_device_count() + imk_device_sensitivity_count();
    all.of = command_memory(NULL, limit * sizeof *all.of);
    for (size_t d = 0; d < imk_device_count(); d++)
        all.of[all.count++] = (subject){imk_device_get(d)->name, imk_device_get(d)};
    for (size_t i = 0; imk_device_sensitivity_get(i, &row); i++)
        if (!imk_device_find(row.part) && strcmp(row.part, all.of[all.count - 1].name) != 0)
            all.of[all.count++] = (subject){row.part, NULL};
    if (!name)
        return all;
    chosen.of = command_memory(NULL, limit * sizeof *chosen.of);
    for (size_t i = 0; i < all.count; i++)
        if (imk_name_equal(name, all.of[i].name))
            chosen.of[chosen.count++] = all.of[i];
    const bool none = chosen.count == 0;
    for (size_t i = 0; none && i < all.count; i++)
        if (imk_name_within(name, all.of[i].name))
            chosen.of[chosen.count++] = all.of[i];
    free(all.of);
    return chosen;
}

static const char *const kinds[IMK_COUNT_KINDS] = {"gyro", "accel", "temperature"};

static void show_sensitivity_data(const imk_device_sensitivity *row, imk_result *result)
{
    static const char *const si[IMK_COUNT_KINDS] = {"rad/s", "m/s^2", "K"};
    imk_result_object(result, NULL);
    imk_result_text(result, "part", row->part);
    imk_result_text(result, "kind", kinds[row->kind]);
    imk_result_count(result, "bits", row->bits);
    if (row->range > 0)
        imk_result_quantity(result, "range", row->range, si[row->kind]);
    else
        imk_result_null(result, "range");
    imk_result_quantity(result, "per_count", row->per_count, si[row->kind]);
    if (row->kind == IMK_COUNTS_TEMPERATURE)
        imk_result_quantity(result, "zero", row->zero, "K");
    else
        imk_result_null(result, "zero");
    imk_result_text(result, "stated", row->stated);
    imk_result_text(result, "source", row->source);
    imk_result_end(result);
}

static void show_sensitivities_data(const char *name, imk_result *result)
{
    imk_device_sensitivity row;
    imk_result_array(result, "sensitivities");
    for (size_t i = 0; imk_device_sensitivity_get(i, &row); i++)
        if (imk_device_sensitivity_of(&row, name))
            show_sensitivity_data(&row, result);
    imk_result_end(result);
}

/* As comments, so that what is printed stays a model file. */
static void show_sensitivities(const char *name, imk_result *result)
{
    imk_device_sensitivity row;
    const char *source = NULL;
    for (size_t i = 0; imk_device_sensitivity_get(i, &row); i++) {
        if (!imk_device_sensitivity_of(&row, name))
            continue;
        if (!source || strcmp(row.source, source) != 0)
            imk_result_line(result, "# sensitivities from: %s", row.source);
        source = row.source;
        if (row.kind == IMK_COUNTS_TEMPERATURE)
            imk_result_line(result, "#   %s temperature: %s, %d bits, 0 at %g degC", row.part,
                            row.stated, row.bits, row.zero - imk_unit_of("degC").offset);
        else
            imk_result_line(result, "#   %s %s%s%s: %s, %d bits", row.part, kinds[row.kind],
                            row.range > 0 ? " " : "", row.range_stated, row.stated, row.bits);
    }
}

static void show_figures_data(const imk_model *model, imk_result *result)
{
    imk_result_object(result, "figures");
    for (size_t k = 0; k < HEADLINES; k++) {
        if (k % 2 == 0)
            imk_result_object(result, headlines[k].sensor);
        if (headline(model, k) > 0)
            imk_result_quantity(result, headlines[k].key, headline(model, k), headlines[k].si);
        else
            imk_result_null(result, headlines[k].key);
        if (k % 2 == 1)
            imk_result_end(result);
    }
    imk_result_end(result);
}

static void show_data(const subject *s, const imk_model *model, imk_result *result)
{
    imk_result_object(result, NULL);
    imk_result_text(result, "name", s->name);
    if (s->device) {
        imk_result_text(result, "grade", s->device->grade);
        imk_result_flag(result, "preset", s->device->is_preset);
        imk_result_text(result, "source", s->device->source);
        imk_result_text(result, "note", s->device->note);
        show_figures_data(model, result);
    }
    imk_show_build(imk_device_build_find(s->name), result);
    show_sensitivities_data(s->name, result);
    imk_result_end(result);
}

static void show_row(const subject *s, const imk_model *model, imk_table *table)
{
    const char *grade = !s->device             ? "sensitivities only"
                        : s->device->is_preset ? "grade preset"
                                               : s->device->grade;
    imk_table_row(table, "%s\t%s", s->name, grade);
    for (size_t k = 0; k < HEADLINES; k++)
        if (s->device && headline(model, k) > 0)
            imk_table_add(table, "%.4g", headline(model, k) / imk_unit_of(headlines[k].unit).scale);
        else
            imk_table_add(table, "-");
    imk_show_build_cells(imk_device_build_find(s->name), table);
}

static imk_table *begin_table(imk_result *result)
{
    imk_table *table = imk_result_table(result, 0x1fcU); /* the figures to the right */
    imk_table_row(table, "name\tclass");
    for (size_t k = 0; k < HEADLINES; k++)
        imk_table_add(table, "%s [%s]", headlines[k].title, headlines[k].unit);
    imk_table_add(table, "size [mm]\tmass [g]\tsupply");
    imk_result_line(result, "\nOne entry with its source: imukit devices NAME\n"
                            "Simulate it: imukit simulate NAME --rate 100Hz --duration 1h -o "
                            "static.csv");
    return table;
}

/* As comments. */
static void show_build_lines(const imk_device_build *b, imk_result *result)
{
    if (!b)
        return;
    if (b->size[0] > 0)
        imk_result_line(result, "# size: %g x %g x %g mm", 1e3 * b->size[0], 1e3 * b->size[1],
                        1e3 * b->size[2]);
    if (b->mass > 0)
        imk_result_line(result, "# mass: %g g", 1e3 * b->mass);
    if (b->power > 0 || b->current > 0)
        imk_result_line(result, "# supply: %s%g %s", b->is_limit ? "below " : "",
                        1e3 * (b->power > 0 ? b->power : b->current), b->power > 0 ? "mW" : "mA");
    imk_result_line(result, "# size, mass and supply from: %s", b->source);
}

/* As what an entry can be used; a comment, too. */
static void judge_entry(const subject *s, const imk_model *model, imk_result *result)
{
    imk_unstated unstated = {.count = 0};
    char sentence[300] = "Usable: it states every term that drift and grade look for.",
         more[40] = "";
    if (s->device)
        imk_model_unstated(model, &unstated);
    if (unstated.count > 1)
        (void)snprintf(more, sizeof more, " and %zu more term%s", unstated.count - 1,
                       unstated.count == 2 ? "" : "s");
    if (!s->device)
        (void)snprintf(sentence, sizeof sentence,
                       "Not usable as a model: only what a count is is known of it.");
    else if (unstated.count > 0)
        (void)snprintf(sentence, sizeof sentence,
                       "Usable with care: it does not state %s%s, so that figures of drift and "
                       "grade may be lower bounds.",
                       unstated.term[0].text, more);
    imk_result_usability(result,
                         !s->device           ? IMK_NOT_USABLE
                         : unstated.count > 0 ? IMK_USABLE_WITH_CARE
                                              : IMK_USABLE,
                         sentence);
    imk_result_line(result, "# %s", sentence);
}

static void judge_list(const subjects *chosen, imk_result *result)
{
    size_t models = 0;
    for (size_t i = 0; i < chosen->count; i++)
        models += chosen->of[i].device != NULL;
    if (models == chosen->count)
        imk_result_judge(result, IMK_USABLE,
                         "Usable: all %zu entries have a model of their errors.", models);
    else
        imk_result_judge(result, models > 0 ? IMK_USABLE_WITH_CARE : IMK_NOT_USABLE,
                         "%s: %zu of %zu entries have a model of their errors; of the others only "
                         "what a count is is known.",
                         models > 0 ? "Usable with care" : "Not usable as models", models,
                         chosen->count);
}

static void show_entry(const subject *s, const imk_model *model, imk_result *result)
{
    char *text = NULL;
    size_t size = 0;
    if (!s->device) {
        imk_result_line(result,
                        "# %s: the catalogue has no errors of this part, only what a count "
                        "is",
                        s->name);
        show_sensitivities(s->name, result);
        return;
    }
    imk_result_line(result, "# %s (%s)\n# source: %s", s->name, s->device->grade,
                    s->device->source);
    if (s->device->note[0])
        imk_result_line(result, "# note: %s", s->device->note);
    show_build_lines(imk_device_build_find(s->name), result);
    show_sensitivities(s->name, result);
    (void)command_unless_memory(imk_model_print(model, NULL, &text, &size, NULL));
    if (size > 0)
        text[size - 1] = '\0'; /* the line feed, which the result adds */
    imk_result_code(result, text);
    free(text);
}

/* The devices, or the parts that are none. */
static void show_some(const subjects *chosen, bool devices, imk_table *table, imk_model *model,
                      imk_result *result)
{
    imk_result_array(result, devices ? "devices" : "parts");
    for (size_t i = 0; i < chosen->count; i++) {
        const subject *s = &chosen->of[i];
        if ((s->device != NULL) != devices)
            continue;
        if (s->device)
            imk_device_model(s->device, model);
        show_data(s, model, result);
        if (table)
            show_row(s, model, table);
        else
            show_entry(s, model, result);
    }
    imk_result_end(result);
}

/* @param name  as it was asked for; NULL: all */
static void show(const subjects *chosen, const char *name, imk_model *model, imk_result *result)
{
    const bool one = name && chosen->count == 1;
    imk_result_object(result, "inputs");
    if (name)
        imk_result_text(result, "name", one ? chosen->of[0].name : name);
    imk_result_end(result);
    imk_result_object(result, "result");
    if (one && chosen->of[0].device)
        imk_device_model(chosen->of[0].device, model);
    if (one)
        judge_entry(&chosen->of[0], model, result);
    else
        judge_list(chosen, result);
    imk_table *table = one ? NULL : begin_table(result);
    show_some(chosen, true, table, model, result);
    show_some(chosen, false, table, model, result);
    imk_result_end(result);
}

/* The nearest names, at most three. */
static int unknown(const char *name)
{
    enum { NEAREST = 3 };
    char text[256] = "";
    subjects all = select_subjects(NULL);
    const char **names = command_memory(NULL, all.count * sizeof *names);
    for (size_t i = 0; i < all.count; i++)
        names[i] = all.of[i].name;
    for (int found = 0; found < NEAREST; found++) {
        const size_t nearest = imk_nearest_name(name, all.count, names);
        if (nearest >= all.count)
            break;
        const size_t used = strlen(text);
        (void)snprintf(text + used, sizeof text - used, "%s\"%s\"", found > 0 ? " or " : "",
                       names[nearest]);
        names[nearest] = NULL;
    }
    free(names);
    free(all.of);
    if (text[0])
        return command_failed_by("name_unknown", NULL, NULL,
                                 "there is no device \"%s\"; did you mean %s?", name, text);
    return command_failed_by("name_unknown", NULL, NULL,
                             "there is no device \"%s\"; the names are listed by: imukit devices",
                             name);
}

static int run(int count, char **words)
{
    devices_options o = {0};
    const char *operands[OPERANDS_MAX];
    int code = options_parse(&devices_verb, count, words, &o, operands);
    if (code >= 0)
        return code;
    subjects chosen = select_subjects(operands[0]);
    if (chosen.count == 0) {
        free(chosen.of);
        return unknown(operands[0]);
    }
    imk_model *model = command_memory(NULL, sizeof *model);
    imk_result *result = show_begin("devices");
    show(&chosen, operands[0], model, result);
    free(model);
    free(chosen.of);
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
    .description =
        "A name may be a part of one; case, blanks and hyphens do not count. Several "
        "that fit are listed. An entry says what a count of the part is, by range. "
        "Every verb that takes a MODEL accepts these names in full. Figures are of the axis "
        "given first; bias instability is B of IEEE 952: datasheets that quote the "
        "floor of the Allan deviation were divided by 0.664, and the note says so.",
    .groups = {{"Options", 1, devices_option_table, 0}},
    .run = run};
