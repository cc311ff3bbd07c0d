/* SPDX-License-Identifier: Apache-2.0 */
/* From the tree of a motion script to a trajectory: the keys, the steps with their repeats written
 * out, the compilation, and where its errors stand in the file. */
#include "motion_file_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A number of a mapping. */
typedef struct entry {
    const char *key, *si;
    double *value;
} entry;

/* Mapping `key` of the root, if it is there: any of `count` numbers. */
static void read_entries(imki_reading *r, const char *key, size_t count, const entry *entries)
{
    const char *names[8];
    const int mapping = imki_document_value(r->document, 0, key);
    if (mapping == IMKI_NONE ||
        !imki_value_require(r, mapping, IMKI_NODE_MAPPING, "a mapping: {key: value, …}"))
        return;
    for (size_t i = 0; i < count; i++)
        names[i] = entries[i].key;
    imki_value_keys(r, mapping, count, names);
    for (size_t i = 0; i < count; i++)
        imki_value_number(r, mapping, entries[i].key, entries[i].si, entries[i].value);
}

static void read_start(imki_script_reader *r)
{
    imk_motion_script *script = &r->script;
    const entry start[] = {{"latitude", "rad", &script->place.latitude},
                           {"longitude", "rad", &script->place.longitude},
                           {"height", "m", &script->place.height},
                           {"heading", "rad", &script->heading},
                           {"climb", "rad", &script->climb},
                           {"speed", "m/s", &script->speed}};
    const entry mounting[] = {{"roll", "rad", &script->mounting[0]},
                              {"pitch", "rad", &script->mounting[1]},
                              {"yaw", "rad", &script->mounting[2]}};
    read_entries(&r->reading, "start", 6, start);
    read_entries(&r->reading, "mounting", 3, mounting);
    r->speed = script->speed;
    r->heading = script->heading;
    r->climb = script->climb;
}

/* ---- steps ----------------------------------------------------------------------------------- */

static void read_steps(imki_script_reader *r, int sequence);

/* {repeat: {times: 3, steps: […]}} */
static void read_repeat(imki_script_reader *r, int node)
{
    static const char *const outer[] = {"repeat"}, *const inner[] = {"times", "steps"};
    static const char due[] = "a mapping: {times: 3, steps: [hold 1 s, …]}";
    imki_reading *reading = &r->reading;
    const int repeat = imki_document_value(reading->document, node, "repeat");
    int count, steps;
    imki_value_keys(reading, node, 1, outer);
    if (repeat == IMKI_NONE) {
        imki_value_require(reading, node, IMKI_NODE_SCALAR, "a step such as hold 10 s");
        return;
    }
    if (!imki_value_require(reading, repeat, IMKI_NODE_MAPPING, due))
        return;
    imki_value_keys(reading, repeat, 2, inner);
    if (!imki_value_find(reading, repeat, "times", due, &count) ||
        !imki_value_find(reading, repeat, "steps", due, &steps))
        return;
    const size_t times = imki_value_count(reading, count, 1, IMKI_STEPS_MAX,
                                          "a whole number of times, from 1 to 100000");
    for (size_t i = 0; reading->status == IMK_OK && i < times; i++)
        read_steps(r, steps);
}

static void read_step(imki_script_reader *r, int node)
{
    imki_reading *reading = &r->reading;
    if (r->steps_read++ == IMKI_STEPS_MAX)
        imki_value_refuse(reading, node, IMK_ERROR_UNSUPPORTED, "the file has too many steps",
                          "at most 100000 steps, with every repetition counted");
    else if (reading->document->node[node].kind == IMKI_NODE_MAPPING)
        read_repeat(r, node);
    else if (imki_value_require(reading, node, IMKI_NODE_SCALAR, "a step such as hold 10 s"))
        imki_step_read(r, node);
}

static void read_steps(imki_script_reader *r, int sequence)
{
    imki_reading *reading = &r->reading;
    const imki_node *nodes = reading->document->node;
    if (!imki_value_require(reading, sequence, IMKI_NODE_SEQUENCE,
                            "a list of steps: [hold 10 s, …]"))
        return;
    if (nodes[sequence].count == 0)
        imki_value_refuse(reading, sequence, IMK_ERROR_SYNTAX, "[]",
                          "at least one step, such as hold 10 s");
    for (int i = nodes[sequence].first; reading->status == IMK_OK && i != IMKI_NONE;
         i = nodes[i].next)
        read_step(r, i);
}

/* ---- the whole file -------------------------------------------------------------------------- */

static void read_settings(imki_script_reader *r)
{
    static const char *const names[] = {"imukit_motion", "name",      "start",
                                        "mounting",      "smoothing", "earth",
                                        "steps",         "vibration", "then"};
    imki_reading *reading = &r->reading;
    const int smoothing = imki_document_value(reading->document, 0, "smoothing");
    const int earth = imki_document_value(reading->document, 0, "earth");
    imki_value_keys(reading, 0, sizeof names / sizeof names[0], names);
    imki_value_version(reading, "imukit_motion");
    read_start(r);
    imki_value_number(reading, 0, "smoothing", "s", &r->script.smoothing);
    if (!(r->script.smoothing >= 1e-3 && r->script.smoothing <= 1e3))
        imki_refuse_value(reading, smoothing, IMK_ERROR_RANGE, "a time from 1 ms to 1000 s");
    if (earth != IMKI_NONE)
        imki_value_choice(reading, earth, imki_yes_no, "\"yes\" or \"no\"", &r->script.earth);
}

imk_status imki_script_read(const imk_document *document, const imk_geodetic *place,
                            imki_script_reader *r, imk_error *error)
{
    *r = (imki_script_reader){.reading = {.document = document, .error = error},
                              .script = imk_motion_script_default()};
    r->script.place = place ? *place : imki_default_place();
    read_settings(r);
    int steps;
    if (!imki_value_find(&r->reading, 0, "steps", "a list of steps: [hold 10 s, …]", &steps))
        return r->reading.status;
    read_steps(r, steps);
    if (r->step_count == 0)
        imki_value_refuse(&r->reading, steps, IMK_ERROR_CONFLICT,
                          "the steps do not change anything", "at least one step that takes time");
    r->script.step = r->step;
    r->script.step_count = r->step_count;
    return r->reading.status;
}

/* The node a field of the script comes from, or the nearest above it. */
static int node_of(const imki_script_reader *r, const imk_error *error)
{
    char path[sizeof error->field + 8];
    const bool is_place = strncmp(error->field, "place.", 6) == 0;
    const bool is_root =
        strncmp(error->field, "mounting", 8) == 0 || strcmp(error->field, "smoothing") == 0;
    if (error->index >= 0 && (size_t)error->index < r->step_count)
        return r->step_node[error->index];
    snprintf(path, sizeof path, "%s%.*s", is_root ? "" : "start.", (int)sizeof error->field - 1,
             error->field + (is_place ? 6 : 0));
    return imki_document_find(r->reading.document, 0, path, NULL);
}

/* Give an error of the compiler the place of the step or key it speaks of. */
static void place_error(const imki_script_reader *r, imk_error *error)
{
    if (!error || error->status == IMK_ERROR_MEMORY)
        return;
    const int node = node_of(r, error);
    if (node == 0) /* it came from the caller */
        return;
    const imki_node *n = &r->reading.document->node[node];
    error->index = -1;
    error->line = n->line;
    error->column = n->column;
    if (n->kind == IMKI_NODE_SCALAR && error->found[0] == '\0')
        snprintf(error->found, sizeof error->found, "%.80s", n->text);
    imki_document_path(r->reading.document, node, error->field, sizeof error->field);
}

/* Room for `count` pieces, and the script compiled into it. */
static imk_status compile_into(const imki_script_reader *r, size_t count, imk_motion_file *file,
                               imk_error *error)
{
    free(file->piece);
    file->piece = calloc(count, sizeof *file->piece);
    if (!file->piece)
        return imk_error_set(error, IMK_ERROR_MEMORY, "", "", "");
    return imk_motion_script_compile(&r->script, file->piece, count, &file->trajectory, error);
}

/* Counting pieces takes as long as compiling, so only scripts of many are counted. */
static void compile(imki_script_reader *r, imk_motion_file *file)
{
    enum { FEW = 1024 };
    size_t count = 0;
    imk_error found;
    imk_status status = compile_into(r, FEW, file, &found);
    if (status == IMK_ERROR_WORKSPACE) {
        status = imk_motion_script_pieces(&r->script, &count, &found);
        if (status == IMK_OK)
            status = compile_into(r, count, file, &found);
    }
    r->reading.status = status;
    if (status == IMK_OK)
        return;
    place_error(r, &found);
    if (r->reading.error)
        *r->reading.error = found;
}

/* `then: hold` asks for a body at rest; else the motion ends with its steps. */
static void read_end(imki_script_reader *r, imk_motion_file *file)
{
    static const char *const hold_stop[6] = {"hold", NULL, NULL, "stop"};
    bool holds = false;
    double first = 0.0, last = 0.0;
    const int node = imki_document_value(r->reading.document, 0, "then");
    if (node != IMKI_NONE)
        imki_value_choice(&r->reading, node, hold_stop, "\"stop\" or \"hold\"", &holds);
    imk_trajectory_span(&file->trajectory, &first, &last);
    if (holds && !isinf(last))
        imki_value_refuse(&r->reading, node, IMK_ERROR_CONFLICT,
                          "the body is not at rest after the last step",
                          "add a last step such as stop at 3 m/s^2, or write then: stop");
    file->duration = 0.0;
    for (size_t i = 0; i < r->step_count; i++)
        file->duration += imk_motion_step_duration(&r->script, i);
    if (holds)
        file->duration = (double)INFINITY;
}

imk_status imki_motion_script_open(const imk_document *document, const imk_geodetic *place,
                                   uint64_t seed, imk_motion_file *file, imk_error *error)
{
    imki_script_reader r;
    const int vibration = imki_document_value(document, 0, "vibration");
    (void)imki_script_read(document, place, &r, error);
    imki_value_name(&r.reading, "name", file->name, sizeof file->name);
    if (r.reading.status == IMK_OK)
        compile(&r, file);
    if (r.reading.status == IMK_OK)
        read_end(&r, file);
    if (vibration != IMKI_NONE)
        imki_vibration_read(&r.reading, vibration, seed, file);
    free(r.step);
    free(r.step_node);
    file->kind = IMK_MOTION_SCRIPT;
    file->motion.trajectory = &file->trajectory;
    return r.reading.status;
}
