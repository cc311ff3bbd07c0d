/* SPDX-License-Identifier: Apache-2.0 */
/* imukit join: one unit from models of its parts. */
#include "shell/show.h"

#include "imukit/model_file.h"
#include "imukit/model_join.h"

#include <stdlib.h>
#include <string.h>

typedef struct join_options {
    const char *axis[3], *from[IMK_KINDS], *timing, *output, *name;
    bool json;
} join_options;

#define AT(field) offsetof(join_options, field)
#define AXIS_OPTION(letter, k)                                                                     \
    {                                                                                              \
        letter, OPTION_FILE, AT(axis[k]),                                                          \
            .value = "MODEL",                                                                      \
            .help = "model that gives the axis " letter ": one sensor, or the " letter " of three" \
    }

static const option join_option_table[] = {
    {"output", OPTION_OUTPUT, AT(output), .letter = 'o', .value = "UNIT",
     .help = "model file of the unit (.yaml, .json)"},
    AXIS_OPTION("x", 0),
    AXIS_OPTION("y", 1),
    AXIS_OPTION("z", 2),
    {"gyro", OPTION_FILE, AT(from[IMK_GYRO]), .value = "MODEL",
     .help = "take the gyros of this model, where several have some"},
    {"accel", OPTION_FILE, AT(from[IMK_ACCEL]), .value = "MODEL",
     .help = "take the accelerometers of this model"},
    {"mag", OPTION_FILE, AT(from[IMK_MAG]), .value = "MODEL",
     .help = "take the magnetometer of this model"},
    {"timing", OPTION_FILE, AT(timing), .value = "MODEL",
     .help = "take the sample clock of this model, where several state one"},
    {"name", OPTION_TEXT, AT(name), .value = "NAME",
     .help = "name of the unit; default: the name of the file"},
    JSON_OPTION(AT(json), "print as JSON"),
};

static const char *const kind_names[IMK_KINDS] = {"gyro", "accel", "mag"};
static const char *const axis_names[3] = {"x", "y", "z"};

/* The models that are joined. */
typedef struct parts {
    size_t count;
    imk_join_part part[IMK_JOIN_MAX + 1];
    imk_model *model[IMK_JOIN_MAX + 1];
    imk_join_settings settings;
} parts;

/* @return -1 or the exit code */
static int add(parts *p, const char *name, int axis)
{
    if (p->count == IMK_JOIN_MAX)
        return command_misused("at most %d models can be joined", IMK_JOIN_MAX);
    p->model[p->count] = command_memory(NULL, sizeof *p->model[0]);
    p->part[p->count] = (imk_join_part){p->model[p->count], name, axis};
    return command_model(name, p->model[p->count++], NULL);
}

/* The part of this name, which is added if it is none of the operands. */
static int choose(parts *p, const char *name, int *from)
{
    for (size_t i = 0; i < p->count; i++)
        if (p->part[i].axis == IMK_JOIN_WHOLE && strcmp(p->part[i].name, name) == 0) {
            *from = (int)i;
            return -1;
        }
    *from = (int)p->count;
    return add(p, name, IMK_JOIN_WHOLE);
}

/* ---- single axes among the operands -----------------------------------------------------------
 */

static int body_axis(const double e[3])
{
    for (int k = 0; k < 3; k++)
        if (e[k] == 1)
            return k;
    return -1;
}

/* Three models of one sensor each of the same kind: along x, y and z if they say so, or all along
 * the same axis, as instruments are, in their order. */
static int find_single_axes(parts *p, int kind)
{
    size_t of[IMK_JOIN_MAX], count = 0;
    unsigned seen = 0;
    int direction[IMK_JOIN_MAX] = {0};
    for (size_t i = 0; i < p->count; i++) {
        const imk_triad *triad = imk_model_triad(p->model[i], kind);
        bool alone = triad->present && triad->axis_count == 1;
        for (int other = 0; other < IMK_KINDS; other++)
            alone = alone && (other == kind || !imk_model_triad(p->model[i], other)->present);
        if (!alone || p->part[i].axis != IMK_JOIN_WHOLE)
            continue;
        direction[count] = body_axis(triad->direction[0]);
        seen |= direction[count] >= 0 ? 1U << direction[count] : 8U;
        of[count++] = i;
    }
    if (count != 3)
        return -1;
    const bool in_order = (seen & (seen - 1)) == 0 && seen < 8;
    if (seen != 7 && !in_order)
        return command_misused(
            "%s, %s and %s are along two directions only; say which axis each is: "
            "--x MODEL --y MODEL --z MODEL",
            p->part[of[0]].name, p->part[of[1]].name, p->part[of[2]].name);
    for (int k = 0; k < 3; k++)
        p->part[of[k]].axis = in_order ? k : direction[k];
    return -1;
}

/* ---- what is told -----------------------------------------------------------------------------
 */

static void note_text(const parts *p, const imk_join_note *note, char *text, size_t size)
{
    const char *kind = note->sensor >= 0 ? kind_names[note->sensor] : "";
    const char *part = note->part >= 0 ? p->part[note->part].name : "";
    switch (note->kind) {
    case IMK_JOIN_PARALLEL:
        snprintf(text, size,
                 "the sensors are from different models, so their axes are taken as parallel: a "
                 "misalignment between them is not in the unit");
        break;
    case IMK_JOIN_AXIS_UNSTATED:
        snprintf(text, size, "%s: %.100s does not state %s, as other axes do: its axis has 0", kind,
                 part, note->key);
        break;
    case IMK_JOIN_INTERVAL_LOST:
        snprintf(text, size, "%s: the evidence of %s is left out, because not all axes have it",
                 kind, note->key);
        break;
    case IMK_JOIN_CORRELATION_LOST:
        snprintf(text, size,
                 "the correlations of %.100s are left out: a model holds those of %d parameters",
                 part, IMK_CORRELATED_MAX);
        break;
    case IMK_JOIN_RANGE_NARROWED:
        snprintf(text, size, "%s: the valid_range of %s is the one that all axes have", kind,
                 note->key);
        break;
    case IMK_JOIN_FRAME_LOST:
        snprintf(text, size, "%s: the models state different frames, and none is kept", kind);
        break;
    default:
        snprintf(text, size,
                 "residual_of is left out: the models are not the residual of one compensation");
    }
}

static const char *code_of(imk_join_note_kind kind)
{
    static const char *const codes[] = {"parallel",         "axis_unstated",  "interval_lost",
                                        "correlation_lost", "range_narrowed", "frame_lost",
                                        "residual_lost"};
    return codes[kind];
}

/* A unit without one of the sensors cannot navigate; a note is something that the unit lacks. */
static void judge(const parts *p, const imk_model *unit, const imk_joined *joined,
                  imk_result *result)
{
    char text[300], more[40] = "";
    const int gyros = unit->gyro.present ? unit->gyro.axis_count : 0,
              accels = unit->accel.present ? unit->accel.axis_count : 0;
    if (joined->note_count > 0)
        note_text(p, &joined->note[0], text, sizeof text);
    if (joined->note_count > 1)
        (void)snprintf(more, sizeof more, "; and %zu more note%s", joined->note_count - 1,
                       joined->note_count == 2 ? "" : "s");
    if (gyros < 3 || accels < 3)
        imk_result_judge(result, IMK_NOT_USABLE,
                         "Not usable for navigation: the unit has %d gyros and %d accelerometers.",
                         gyros, accels);
    else if (joined->note_count > 0)
        imk_result_judge(result, IMK_USABLE_WITH_CARE, "Usable with care: %s%s.", text, more);
    else
        imk_result_judge(result, IMK_USABLE, "Usable: the unit has %d gyros and %d accelerometers.",
                         gyros, accels);
}

static void show_data(const parts *p, const join_options *o, const imk_model *unit,
                      const imk_joined *joined, imk_result *result)
{
    char text[300];
    imk_result_object(result, "inputs");
    imk_result_array(result, "models");
    for (size_t i = 0; i < p->count; i++)
        imk_result_text(result, NULL, p->part[i].name);
    imk_result_end(result);
    imk_result_end(result);
    imk_result_object(result, "result");
    judge(p, unit, joined, result);
    imk_result_text(result, "output", o->output);
    imk_result_text(result, "name", unit->name);
    for (int kind = 0; kind < IMK_KINDS; kind++) {
        imk_result_array(result, kind_names[kind]);
        for (int k = 0; k < 3 && joined->from[kind][k] >= 0; k++)
            imk_result_text(result, NULL, p->part[joined->from[kind][k]].name);
        imk_result_end(result);
    }
    imk_result_text(result, "timing",
                    joined->timing_from >= 0 ? p->part[joined->timing_from].name : NULL);
    imk_result_end(result);
    for (size_t i = 0; o->json && i < joined->note_count; i++) {
        note_text(p, &joined->note[i], text, sizeof text);
        command_note(code_of(joined->note[i].kind), "%s", text);
    }
}

static void show_sensor(const parts *p, const imk_model *unit, const imk_joined *joined, int kind,
                        imk_table *table)
{
    static const char *const words[IMK_KINDS] = {"gyros", "accelerometers", "magnetometer"};
    const int *from = joined->from[kind];
    if (from[0] < 0)
        return;
    if (p->part[from[0]].axis == IMK_JOIN_WHOLE)
        imk_table_row(table, "%s\t%d\t%s", words[kind], imk_model_triad(unit, kind)->axis_count,
                      p->part[from[0]].name);
    for (int k = 0; k < 3 && p->part[from[0]].axis != IMK_JOIN_WHOLE; k++)
        imk_table_row(table, "%s\t%s\t%s", words[kind], axis_names[k], p->part[from[k]].name);
}

static int show(const parts *p, const join_options *o, const imk_model *unit,
                const imk_joined *joined)
{
    char text[300];
    imk_result *result = show_begin("join");
    show_data(p, o, unit, joined, result);
    imk_table *table = imk_result_table(result, 0);
    imk_table_row(table, "sensors\taxes\tfrom");
    for (int kind = 0; kind < IMK_KINDS; kind++)
        show_sensor(p, unit, joined, kind, table);
    if (joined->timing_from >= 0)
        imk_table_row(table, "sample clock\t\t%s", p->part[joined->timing_from].name);
    if (joined->note_count > 0)
        imk_result_gap(result);
    for (size_t i = 0; i < joined->note_count; i++) {
        note_text(p, &joined->note[i], text, sizeof text);
        imk_result_line(result, "Note: %s.", text);
    }
    if (!command_is_stream(o->output))
        imk_result_line(result, "\nNext: imukit drift %s", o->output);
    return show_end(result, &(show_options){.json = o->json}, EXIT_DONE);
}

/* ---- all --------------------------------------------------------------------------------------
 */

/* What two models give can be settled by an option. */
static int refuse(const imk_error *error)
{
    if (error->status == IMK_ERROR_CONFLICT)
        for (int kind = 0; kind <= IMK_KINDS; kind++) {
            const char *name = kind < IMK_KINDS ? kind_names[kind] : "timing";
            if (strcmp(error->field, name) == 0)
                return command_misused("%s: %s; take one of them: --%s MODEL", name, error->found,
                                       name);
        }
    if (error->status == IMK_ERROR_KEY_MISSING && error->found[0])
        return command_failed_by(NULL, error, NULL, "%s: %s has none; expected %s", error->field,
                                 error->found, error->expected);
    return command_error(error, NULL);
}

static int join(const join_options *o, parts *p)
{
    imk_error error;
    imk_joined joined;
    char name[sizeof((imk_model *)0)->name];
    imk_model *unit = command_memory(NULL, sizeof *unit);
    command_model_name(o->name                        ? o->name
                       : command_is_stream(o->output) ? "joined"
                                                      : NULL,
                       o->output, name, sizeof name);
    p->settings.name = name;
    int code = imk_model_join(p->count, p->part, &p->settings, unit, &joined, &error) == IMK_OK
                   ? -1
                   : refuse(&error);
    if (code < 0 && imk_model_write(o->output, unit, NULL, &error) != IMK_OK)
        code = command_error(&error, NULL);
    if (code < 0)
        code = show(p, o, unit, &joined);
    free(unit);
    return code;
}

static int open_parts(const join_options *o, const char *const *names, parts *p)
{
    int code = -1;
    if (!o->output)
        return command_misused("-o is missing: the model file of the unit, such as -o unit.yaml");
    for (int k = 0; k < 3; k++)
        if (!o->axis[k] && (o->axis[0] || o->axis[1] || o->axis[2]))
            return command_misused("--x, --y and --z go together, and --%s is missing",
                                   axis_names[k]);
    for (int i = 0; names[i] && code < 0; i++)
        code = add(p, names[i], IMK_JOIN_WHOLE);
    for (int kind = 0; kind < IMK_KINDS && code < 0; kind++)
        code = find_single_axes(p, kind);
    for (int k = 0; k < 3 && code < 0; k++)
        if (o->axis[k])
            code = add(p, o->axis[k], k);
    for (int kind = 0; kind < IMK_KINDS && code < 0; kind++)
        if (o->from[kind])
            code = choose(p, o->from[kind], &p->settings.from[kind]);
    if (code < 0 && o->timing)
        code = choose(p, o->timing, &p->settings.timing_from);
    if (code < 0 && p->count < 2)
        code = command_misused("join takes two models or more");
    return code;
}

static int run(int count, char **words)
{
    join_options o = {.output = NULL};
    const char *names[IMK_JOIN_MAX + 1] = {NULL};
    parts p = {.settings = imk_join_default()};
    int code = options_parse(&join_verb, count, words, &o, names);
    if (code < 0)
        code = open_parts(&o, names, &p);
    if (code < 0)
        code = join(&o, &p);
    for (size_t i = 0; i < p.count; i++)
        free(p.model[i]);
    return code;
}

const verb join_verb = {
    .name = "join",
    .summary = "one unit from models of its gyros and accelerometers, or of its single axes",
    .operands = "[MODEL...]",
    .operands_minimum = 0,
    .operands_maximum = IMK_JOIN_MAX,
    .examples = {{"imukit join gyro.yaml accel.yaml -o unit.yaml",
                  "the unit that has these gyros and these accelerometers"},
                 {"imukit join --x a.yaml --y b.yaml --z c.yaml accel.yaml -o unit.yaml",
                  "three gyros, each from a model of its own, and accelerometers"}},
    .description =
        "MODEL is a model file or a name from `imukit devices`. Each gives the sensors that it "
        "has, "
        "with their evidence and correlations. Three models of one sensor each are the axes x, y "
        "and z, by the directions they state, or in their order if all state the same. What two "
        "models give is refused unless an option says which to take.",
    .groups = {OPTION_GROUP("Options", join_option_table, 0)},
    .run = run};
