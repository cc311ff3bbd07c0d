/* SPDX-License-Identifier: Apache-2.0 */
/* From the tree of a motion script to a trajectory: the keys, the steps with their repeats written
 * out, the compilation, and where its errors stand in the file. */
#include "motion_file_internal.h"
#include "step_sentence_internal.h"

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
static imk_status read_entries(const imk_document *document, const char *key, size_t count,
                               const entry *entries, imk_error *error)
{
    const char *names[8];
    const int mapping = imki_document_value(document, 0, key);
    if (mapping == IMKI_NONE)
        return IMK_OK;
    imk_status status = imki_value_require(document, mapping, IMKI_NODE_MAPPING,
                                           "a mapping: {key: value, …}", error);
    for (size_t i = 0; i < count; i++)
        names[i] = entries[i].key;
    if (status == IMK_OK)
        status = imki_value_keys(document, mapping, count, names, error);
    for (size_t i = 0; status == IMK_OK && i < count; i++) {
        const int node = imki_document_value(document, mapping, entries[i].key);
        if (node != IMKI_NONE)
            status = imki_value_numbers(document, node, entries[i].si, 1, entries[i].value, error);
    }
    return status;
}

static imk_status read_start(imki_script_reader *r)
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
    imk_status status = read_entries(r->document, "start", 6, start, r->error);
    if (status == IMK_OK)
        status = read_entries(r->document, "mounting", 3, mounting, r->error);
    r->speed = script->speed;
    r->heading = script->heading;
    r->climb = script->climb;
    return status;
}

/* One of two words; YAML has more than one for yes. */
static imk_status read_choice(const imk_document *document, const char *key,
                              const char *const words[6], const char *expected, bool *value,
                              imk_error *error)
{
    const int node = imki_document_value(document, 0, key);
    if (node == IMKI_NONE)
        return IMK_OK;
    imk_status status = imki_value_require(document, node, IMKI_NODE_SCALAR, expected, error);
    if (status != IMK_OK)
        return status;
    for (int i = 0; i < 6; i++)
        if (words[i] && strcmp(words[i], document->node[node].text) == 0) {
            *value = i < 3;
            return IMK_OK;
        }
    return imki_document_error(document, node, IMK_ERROR_SYNTAX, document->node[node].text,
                               expected, error);
}

/* ---- steps ----------------------------------------------------------------------------------- */

static imk_status read_steps(imki_script_reader *r, int sequence);

/* How often: a whole number, which needs no unit. */
static imk_status read_times(const imki_script_reader *r, int node, long *times)
{
    const imki_node *n = &r->document->node[node];
    char *end = NULL;
    if (n->kind == IMKI_NODE_SCALAR && n->text[0] >= '1' && n->text[0] <= '9') {
        *times = strtol(n->text, &end, 10);
        if (*end == '\0' && *times <= IMKI_STEPS_MAX)
            return IMK_OK;
    }
    return imki_document_error(r->document, node, IMK_ERROR_SYNTAX,
                               n->kind == IMKI_NODE_SCALAR ? n->text : "",
                               "a whole number of times, from 1 to 100000", r->error);
}

/* {repeat: {times: 3, steps: […]}} */
static imk_status read_repeat(imki_script_reader *r, int node)
{
    static const char *const outer[] = {"repeat"}, *const inner[] = {"times", "steps"};
    static const char due[] = "a mapping: {times: 3, steps: [hold 1 s, …]}";
    const imk_document *document = r->document;
    imk_status status = imki_value_keys(document, node, 1, outer, r->error);
    if (status != IMK_OK)
        return status;
    const int repeat = imki_document_value(document, node, "repeat");
    if (repeat == IMKI_NONE)
        return imki_value_require(document, node, IMKI_NODE_SCALAR, "a step such as hold 10 s",
                                  r->error);
    status = imki_value_require(document, repeat, IMKI_NODE_MAPPING, due, r->error);
    if (status == IMK_OK)
        status = imki_value_keys(document, repeat, 2, inner, r->error);
    if (status != IMK_OK)
        return status;
    const int count = imki_document_value(document, repeat, "times");
    const int steps = imki_document_value(document, repeat, "steps");
    if (count == IMKI_NONE || steps == IMKI_NONE)
        return imki_document_error(document, repeat, IMK_ERROR_KEY_MISSING,
                                   count == IMKI_NONE ? "times" : "steps", due, r->error);
    long times = 0;
    status = read_times(r, count, &times);
    for (long i = 0; status == IMK_OK && i < times; i++)
        status = read_steps(r, steps);
    return status;
}

static imk_status read_step(imki_script_reader *r, int node)
{
    if (r->sentence_count++ == IMKI_STEPS_MAX)
        return imki_document_error(r->document, node, IMK_ERROR_UNSUPPORTED, "too many steps",
                                   "at most 100000 steps, repeats written out", r->error);
    if (r->document->node[node].kind == IMKI_NODE_MAPPING)
        return read_repeat(r, node);
    const imk_status status = imki_value_require(r->document, node, IMKI_NODE_SCALAR,
                                                 "a step such as hold 10 s", r->error);
    return status == IMK_OK ? imki_step_sentence_read(r, node) : status;
}

static imk_status read_steps(imki_script_reader *r, int sequence)
{
    imk_status status = imki_value_require(r->document, sequence, IMKI_NODE_SEQUENCE,
                                           "a list of steps: [hold 10 s, …]", r->error);
    if (status == IMK_OK && r->document->node[sequence].count == 0)
        status = imki_document_error(r->document, sequence, IMK_ERROR_SYNTAX, "[]",
                                     "at least one step, such as hold 10 s", r->error);
    for (int i = r->document->node[sequence].first; status == IMK_OK && i != IMKI_NONE;
         i = r->document->node[i].next)
        status = read_step(r, i);
    return status;
}

/* ---- the whole file -------------------------------------------------------------------------- */

static imk_status check_keys(const imk_document *document, imk_error *error)
{
    static const char *const names[] = {"imukit_motion", "name",      "start",
                                        "mounting",      "smoothing", "earth",
                                        "steps",         "vibration", "then"};
    const imk_status status =
        imki_value_keys(document, 0, sizeof names / sizeof names[0], names, error);
    return status == IMK_OK ? imki_value_version(document, "imukit_motion", error) : status;
}

static imk_status read_settings(imki_script_reader *r)
{
    static const char *const yes_no[6] = {"yes", "true", "on", "no", "false", "off"};
    const int smoothing = imki_document_value(r->document, 0, "smoothing");
    imk_status status = check_keys(r->document, r->error);
    if (status == IMK_OK)
        status = read_start(r);
    if (status == IMK_OK && smoothing != IMKI_NONE)
        status = imki_value_numbers(r->document, smoothing, "s", 1, &r->script.smoothing, r->error);
    if (status == IMK_OK && !(r->script.smoothing >= 1e-3 && r->script.smoothing <= 1e3))
        status = imki_document_error(r->document, smoothing, IMK_ERROR_RANGE,
                                     r->document->node[smoothing].text,
                                     "a time from 1 ms to 1000 s", r->error);
    if (status == IMK_OK)
        status = read_choice(r->document, "earth", yes_no, "\"yes\" or \"no\"", &r->script.earth,
                             r->error);
    return status;
}

imk_status imki_script_read(const imk_document *document, const imk_geodetic *place,
                            imki_script_reader *r, imk_error *error)
{
    *r = (imki_script_reader){
        .document = document, .error = error, .script = imk_motion_script_default()};
    r->script.place = place ? *place : imki_default_place();
    imk_status status = read_settings(r);
    if (status != IMK_OK)
        return status;
    const int steps = imki_document_value(document, 0, "steps");
    if (steps == IMKI_NONE)
        return imki_document_error(document, 0, IMK_ERROR_KEY_MISSING, "steps",
                                   "a list of steps: [hold 10 s, …]", error);
    status = read_steps(r, steps);
    if (status == IMK_OK && r->step_count == 0)
        status = imki_document_error(document, steps, IMK_ERROR_CONFLICT,
                                     "the steps do not change anything",
                                     "at least one step that takes time", error);
    r->script.step = r->step;
    r->script.step_count = r->step_count;
    return status;
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
    return imki_document_find(r->document, 0, path, NULL);
}

/* Give an error of the compiler the place of the step or key it speaks of. */
static void place_error(const imki_script_reader *r, imk_error *error)
{
    if (!error || error->status == IMK_ERROR_MEMORY)
        return;
    const int node = node_of(r, error);
    if (node == 0) /* it came from the caller */
        return;
    const imki_node *n = &r->document->node[node];
    error->index = -1;
    error->line = n->line;
    error->column = n->column;
    if (n->kind == IMKI_NODE_SCALAR && error->found[0] == '\0')
        snprintf(error->found, sizeof error->found, "%.80s", n->text);
    imki_document_path(r->document, node, error->field, sizeof error->field);
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
static imk_status compile(const imki_script_reader *r, imk_motion_file *file, imk_error *error)
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
    if (status == IMK_OK)
        return IMK_OK;
    place_error(r, &found);
    if (error)
        *error = found;
    return status;
}

/* `then: hold` asks for a body at rest; else the motion ends with its steps. */
static imk_status read_end(const imki_script_reader *r, imk_motion_file *file, imk_error *error)
{
    static const char *const hold_stop[6] = {"hold", NULL, NULL, "stop"};
    bool holds = false;
    double first = 0.0, last = 0.0;
    const int node = imki_document_value(r->document, 0, "then");
    const imk_status status =
        read_choice(r->document, "then", hold_stop, "\"stop\" or \"hold\"", &holds, error);
    if (status != IMK_OK)
        return status;
    imk_trajectory_span(&file->trajectory, &first, &last);
    if (holds && !isinf(last))
        return imki_document_error(
            r->document, node, IMK_ERROR_CONFLICT, "the body is not at rest after the last step",
            "end with a step such as stop at 3 m/s^2, or write then: stop", error);
    file->duration = 0.0;
    for (size_t i = 0; i < r->step_count; i++)
        file->duration += imk_motion_step_duration(&r->script, i);
    if (holds)
        file->duration = (double)INFINITY;
    return IMK_OK;
}

imk_status imki_motion_script_open(const imk_document *document, const imk_geodetic *place,
                                   uint64_t seed, imk_motion_file *file, imk_error *error)
{
    imki_script_reader r;
    const int vibration = imki_document_value(document, 0, "vibration");
    imk_status status = imki_script_read(document, place, &r, error);
    if (status == IMK_OK)
        status = imki_value_name(document, "name", file->name, sizeof file->name, error);
    if (status == IMK_OK)
        status = compile(&r, file, error);
    if (status == IMK_OK)
        status = read_end(&r, file, error);
    if (status == IMK_OK && vibration != IMKI_NONE)
        status = imki_vibration_read(document, vibration, seed, file, error);
    free(r.step);
    free(r.step_node);
    file->kind = IMK_MOTION_SCRIPT;
    file->motion.trajectory = &file->trajectory;
    return status;
}
