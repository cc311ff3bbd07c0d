/* SPDX-License-Identifier: Apache-2.0 */
/* The vibration of a motion script: single lines, and random vibration made of lines.
 *
 * A line of displacement a sin(2 pi f t) has the velocity amplitude 2 pi f a and the acceleration
 * amplitude (2 pi f)^2 a, so its amplitude may be stated as any of the three. */
#include "motion_file_internal.h"
#include "step_sentence_internal.h"

#include "imukit/noise.h"
#include "imukit/units.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846

enum { SINE, RANDOM, CORNERS_MAX = 64, LINES_MIN = 8 };

/* imk_vibration_line is for small rotations. */
static const double rotation_max = 0.1;

static const imki_verb verbs[] = {
    {"sine",
     SINE,
     0,
     IMKI_WORDS_AXES,
     {IMKI_BARE_BIT | IMKI_AT_BIT, IMKI_BARE_BIT | IMKI_AT_BIT | IMKI_PHASE_BIT},
     "write sine z 0.5 g at 50 Hz, sine y 0.1 mm at 50 Hz phase 90 deg or sine roll 0.01 deg at "
     "30 Hz"},
    {"random",
     RANDOM,
     0,
     IMKI_WORDS_XYZ,
     {IMKI_BARE_BIT | IMKI_FROM_BIT | IMKI_TO_BIT},
     "write random z 0.01 g^2/Hz from 20 Hz to 2000 Hz, or random: {axis: z, density: [20 Hz 0.01 "
     "g^2/Hz, …]}"},
};

/* A one-sided density at corner frequencies. */
typedef struct density {
    int axis;
    size_t corners, lines;
    double frequency[CORNERS_MAX], value[CORNERS_MAX];
} density;

typedef struct vibration_reader {
    const imk_document *document;
    imk_motion_file *file;
    imk_error *error;
    imk_random random;
    uint8_t draws[3]; /* random vibrations so far on each axis: each is another draw */
    double reach[3];  /* sum of the amplitudes so far along each axis [m] */
} vibration_reader;

/* Is there room for more lines? */
static imk_status check_room(const vibration_reader *r, int node, size_t count)
{
    if (r->file->trajectory.line_count + count > IMK_VIBRATION_LINES_MAX)
        return imki_document_error(r->document, node, IMK_ERROR_UNSUPPORTED, "too many lines",
                                   "at most 512 lines in all; give the random ones fewer",
                                   r->error);
    return IMK_OK;
}

/* Take up the `count` lines that stand behind those of the file, if the body stays on the Earth. */
static imk_status add_lines(vibration_reader *r, int node, size_t count)
{
    const imk_vibration_line *line = r->file->line + r->file->trajectory.line_count;
    for (size_t i = 0; i < count; i++) {
        if (line[i].axis >= 3)
            continue;
        r->reach[line[i].axis] += line[i].amplitude;
        if (!(r->reach[line[i].axis] <= IMK_VIBRATION_DISPLACEMENT_MAX))
            return imki_document_error(r->document, node, IMK_ERROR_CONFLICT,
                                       "the displacement must stay within 10 km along an axis",
                                       "raise the frequencies or lower the amplitudes", r->error);
    }
    r->file->trajectory.line_count += count;
    return IMK_OK;
}

/* ---- one line -------------------------------------------------------------------------------- */

/* Amplitude of displacement or rotation, stated as such, as a velocity or an acceleration. */
static imk_status read_amplitude(const imki_sentence *s, bool rotates, double frequency,
                                 double *amplitude)
{
    static const char *const units[2][3] = {{"m/s^2", "m", "m/s"}, {"rad", "rad/s", "rad/s^2"}};
    static const int orders[2][3] = {{2, 0, 1}, {0, 1, 2}}; /* of the derivative */
    imki_sentence quiet = *s;
    quiet.error = NULL;
    const int kind = rotates ? 1 : 0;
    int which = 0;
    while (which < 3 && imki_sentence_numbers(&quiet, IMKI_PART_BARE, units[kind][which], 1,
                                              amplitude) == IMK_ERROR_DIMENSION)
        which++;
    which = which == 3 ? 0 : which; /* none fits: the message speaks of the first */
    const imk_status status =
        imki_sentence_positive(s, IMKI_PART_BARE, units[kind][which], amplitude);
    for (int i = 0; status == IMK_OK && i < orders[kind][which]; i++)
        *amplitude /= 2.0 * PI * frequency;
    if (status == IMK_OK && rotates && !(*amplitude < rotation_max))
        return imki_sentence_refuse(s, IMKI_PART_BARE, IMK_ERROR_RANGE,
                                    "a rotation below 0.1 rad; write a step swing for larger ones");
    return status;
}

static imk_status read_sine(vibration_reader *r, const imki_sentence *s)
{
    imk_vibration_line line = {.axis = imki_sentence_axis(s)};
    imk_status status = imki_sentence_positive(s, IMKI_PART_AT, "Hz", &line.frequency);
    if (status == IMK_OK && !(line.frequency >= IMK_VIBRATION_FREQUENCY_MIN &&
                              line.frequency <= IMK_VIBRATION_FREQUENCY_MAX))
        status = imki_sentence_refuse(s, IMKI_PART_AT, IMK_ERROR_RANGE,
                                      "a frequency from 1e-6 Hz to 1e9 Hz");
    if (status == IMK_OK && imki_sentence_has(s, IMKI_PART_PHASE))
        status = imki_sentence_numbers(s, IMKI_PART_PHASE, "rad", 1, &line.phase);
    line.phase /= 2.0 * PI;
    if (status == IMK_OK)
        status = read_amplitude(s, line.axis >= 3, line.frequency, &line.amplitude);
    if (status == IMK_OK)
        status = check_room(r, s->node, 1);
    if (status != IMK_OK)
        return status;
    r->file->line[r->file->trajectory.line_count] = line;
    return add_lines(r, s->node, 1);
}

/* ---- many lines ------------------------------------------------------------------------------ */

static const char density_unit[] = "(m/s^2)^2/Hz";

static imk_status add_random(vibration_reader *r, int node, const density *d)
{
    for (size_t i = 1; i < d->corners; i++)
        if (!(d->frequency[i] > d->frequency[i - 1]))
            return imki_document_error(r->document, node, IMK_ERROR_CONFLICT,
                                       "the frequencies do not rise",
                                       "put the lower frequency first", r->error);
    imk_status status = check_room(r, node, d->lines);
    if (status != IMK_OK)
        return status;
    const uint64_t stream =
        imk_stream(0, IMKI_VIBRATION_TERM, r->draws[d->axis]++, (uint8_t)d->axis);
    status = imk_vibration_from_density(d->axis, d->corners, d->frequency, d->value, r->random,
                                        stream, d->lines,
                                        r->file->line + r->file->trajectory.line_count, r->error);
    if (status == IMK_OK)
        return add_lines(r, node, d->lines);
    if (r->error) {
        r->error->line = r->document->node[node].line;
        r->error->column = r->document->node[node].column;
        r->error->index = -1;
        imki_document_path(r->document, node, r->error->field, sizeof r->error->field);
    }
    return status;
}

static imk_status read_flat(vibration_reader *r, const imki_sentence *s)
{
    density d = {.axis = imki_sentence_axis(s), .corners = 2, .lines = IMKI_VIBRATION_LINES};
    imk_status status = imki_sentence_positive(s, IMKI_PART_BARE, density_unit, &d.value[0]);
    if (status == IMK_OK)
        status = imki_sentence_positive(s, IMKI_PART_FROM, "Hz", &d.frequency[0]);
    if (status == IMK_OK)
        status = imki_sentence_positive(s, IMKI_PART_TO, "Hz", &d.frequency[1]);
    d.value[1] = d.value[0];
    return status == IMK_OK ? add_random(r, s->node, &d) : status;
}

/* "20 Hz 0.01 g^2/Hz": two quantities; the second begins where a number follows a unit. */
static imk_status read_corner(const vibration_reader *r, int node, double *frequency, double *value)
{
    static const char due[] = "a frequency and a density, such as 20 Hz 0.01 g^2/Hz";
    imk_status status = imki_value_require(r->document, node, IMKI_NODE_SCALAR, due, r->error);
    if (status != IMK_OK)
        return status;
    const imki_node *n = &r->document->node[node];
    const char *second = n->text;
    second += strcspn(second, " ");
    second += strspn(second, " ");
    second += strcspn(second, " "); /* behind "20 Hz" */
    if (*second == '\0')
        return imki_document_error(r->document, node, IMK_ERROR_SYNTAX, n->text, due, r->error);
    double sigma;
    size_t count;
    status = imk_quantity_parse(n->text, second, imk_unit_of("Hz").dimension, 1, frequency, &sigma,
                                &count, NULL, r->error);
    if (status == IMK_OK)
        status =
            imk_quantity_parse(second, n->text + n->length, imk_unit_of(density_unit).dimension, 1,
                               value, &sigma, &count, NULL, r->error);
    if (status != IMK_OK && r->error) {
        imki_document_path(r->document, node, r->error->field, sizeof r->error->field);
        r->error->line = n->line;
        r->error->column = n->column;
    }
    if (status == IMK_OK && !(*frequency > 0.0 && *value > 0.0))
        return imki_document_error(r->document, node, IMK_ERROR_RANGE, n->text,
                                   "a frequency and a density above 0", r->error);
    return status;
}

static imk_status read_axis(const vibration_reader *r, int node, int *axis)
{
    const imki_node *n = &r->document->node[node];
    if (n->kind == IMKI_NODE_SCALAR && n->length == 1 && n->text[0] >= 'x' && n->text[0] <= 'z') {
        *axis = n->text[0] - 'x';
        return IMK_OK;
    }
    return imki_document_error(r->document, node, IMK_ERROR_SYNTAX,
                               n->kind == IMKI_NODE_SCALAR ? n->text : "",
                               "one of the axes x, y, z", r->error);
}

static imk_status read_line_count(const vibration_reader *r, int node, size_t *lines)
{
    const imki_node *n = &r->document->node[node];
    if (n->kind == IMKI_NODE_SCALAR && n->text[0] >= '1' && n->text[0] <= '9') {
        char *end;
        *lines = strtoul(n->text, &end, 10);
        if (*end == '\0' && *lines >= LINES_MIN && *lines <= IMK_VIBRATION_LINES_MAX)
            return IMK_OK;
    }
    return imki_document_error(r->document, node, IMK_ERROR_SYNTAX,
                               n->kind == IMKI_NODE_SCALAR ? n->text : "",
                               "a whole number of lines, from 8 to 512", r->error);
}

/* {random: {axis: z, density: […], lines: 128}} */
static imk_status read_random(vibration_reader *r, int node)
{
    static const char *const outer[] = {"random"}, *const inner[] = {"axis", "density", "lines"};
    static const char due[] =
        "a mapping: {axis: z, density: [20 Hz 0.01 g^2/Hz, 2000 Hz 0.01 g^2/Hz]}";
    density d = {.lines = IMKI_VIBRATION_LINES};
    const imk_document *document = r->document;
    imk_status status = imki_value_keys(document, node, 1, outer, r->error);
    if (status != IMK_OK)
        return status;
    const int mapping = imki_document_value(document, node, "random");
    if (mapping == IMKI_NONE)
        return imki_document_error(document, node, IMK_ERROR_SYNTAX, "", verbs[SINE].usage,
                                   r->error);
    status = imki_value_require(document, mapping, IMKI_NODE_MAPPING, due, r->error);
    if (status == IMK_OK)
        status = imki_value_keys(document, mapping, 3, inner, r->error);
    if (status != IMK_OK)
        return status;
    const int axis = imki_document_value(document, mapping, "axis");
    const int list = imki_document_value(document, mapping, "density");
    const int lines = imki_document_value(document, mapping, "lines");
    if (axis == IMKI_NONE || list == IMKI_NONE)
        return imki_document_error(document, mapping, IMK_ERROR_KEY_MISSING,
                                   axis == IMKI_NONE ? "axis" : "density", due, r->error);
    status = read_axis(r, axis, &d.axis);
    if (status == IMK_OK && lines != IMKI_NONE)
        status = read_line_count(r, lines, &d.lines);
    if (status == IMK_OK &&
        (document->node[list].kind != IMKI_NODE_SEQUENCE || document->node[list].count < 2 ||
         document->node[list].count > CORNERS_MAX))
        status = imki_document_error(document, list, IMK_ERROR_SYNTAX, "",
                                     "a list of 2 to 64 corners: [20 Hz 0.01 g^2/Hz, 2000 Hz 0.01 "
                                     "g^2/Hz]",
                                     r->error);
    for (int i = document->node[list].first; status == IMK_OK && i != IMKI_NONE;
         i = document->node[i].next, d.corners++)
        status = read_corner(r, i, &d.frequency[d.corners], &d.value[d.corners]);
    return status == IMK_OK ? add_random(r, node, &d) : status;
}

static imk_status read_vibration(vibration_reader *r, int node)
{
    imki_sentence s;
    if (r->document->node[node].kind == IMKI_NODE_MAPPING)
        return read_random(r, node);
    imk_status status =
        imki_value_require(r->document, node, IMKI_NODE_SCALAR, verbs[SINE].usage, r->error);
    if (status == IMK_OK)
        status = imki_sentence_read(r->document, node, "a vibration", 2, verbs, &s, r->error);
    if (status != IMK_OK)
        return status;
    return s.verb->kind == SINE ? read_sine(r, &s) : read_flat(r, &s);
}

imk_status imki_vibration_read(const imk_document *document, int sequence, uint64_t seed,
                               imk_motion_file *file, imk_error *error)
{
    vibration_reader r = {
        .document = document, .file = file, .error = error, .random = imk_random_seeded(seed)};
    imk_status status = imki_value_require(document, sequence, IMKI_NODE_SEQUENCE,
                                           "a list: [sine z 0.5 g at 50 Hz, …]", error);
    file->line = calloc(IMK_VIBRATION_LINES_MAX, sizeof *file->line);
    if (!file->line)
        return imk_error_set(error, IMK_ERROR_MEMORY, "", "", "");
    file->trajectory.line = file->line;
    for (int i = document->node[sequence].first; status == IMK_OK && i != IMKI_NONE;
         i = document->node[i].next)
        status = read_vibration(&r, i);
    return status;
}
