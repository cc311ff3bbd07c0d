/* SPDX-License-Identifier: Apache-2.0 */
/* The vibration of a motion script: single lines, and random vibration made of lines.
 *
 * A line of displacement a sin(2 pi f t) has the velocity amplitude 2 pi f a and the acceleration
 * amplitude (2 pi f)^2 a, so its amplitude may be stated as any of the three. */
#include "motion_file_internal.h"

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
    imki_reading *reading;
    imk_motion_file *file;
    imk_random random;
    uint8_t draws[3]; /* random vibrations so far on each axis: each is another draw */
    double reach[3];  /* sum of the amplitudes so far along each axis [m] */
} vibration_reader;

/* Room for `count` more lines; NULL: there is none, or something failed before. */
static imk_vibration_line *room_for(const vibration_reader *r, int node, size_t count)
{
    const imk_trajectory *trajectory = &r->file->trajectory;
    if (trajectory->line_count + count > IMK_VIBRATION_LINES_MAX)
        imki_value_refuse(r->reading, node, IMK_ERROR_UNSUPPORTED,
                          "the file has too many vibration lines",
                          "at most 512 lines in all; give the random vibrations fewer lines");
    return r->reading->status == IMK_OK ? r->file->line + trajectory->line_count : NULL;
}

/* Take up the `count` lines that stand behind those of the file, if the body stays on the Earth. */
static void add_lines(vibration_reader *r, int node, size_t count)
{
    const imk_vibration_line *line = r->file->line + r->file->trajectory.line_count;
    for (size_t i = 0; i < count; i++) {
        if (line[i].axis >= 3)
            continue;
        r->reach[line[i].axis] += line[i].amplitude;
        if (!(r->reach[line[i].axis] <= IMK_VIBRATION_DISPLACEMENT_MAX))
            imki_value_refuse(r->reading, node, IMK_ERROR_CONFLICT,
                              "the displacement must stay within 10 km along an axis",
                              "raise the frequencies or lower the amplitudes");
    }
    r->file->trajectory.line_count += count;
}

/* ---- one line -------------------------------------------------------------------------------- */

/* Amplitude of displacement or rotation, stated as such, as a velocity or an acceleration. */
static double read_amplitude(const imki_step_text *s, bool rotates, double frequency)
{
    static const char *const units[2][3] = {{"m/s^2", "m", "m/s"}, {"rad", "rad/s", "rad/s^2"}};
    static const int orders[2][3] = {{2, 0, 1}, {0, 1, 2}}; /* of the derivative */
    const int kind = rotates ? 1 : 0;
    int which = 0;
    for (; which < 3; which++) {
        imki_reading trial = {.document = s->reading->document};
        imki_step_text quiet = *s;
        quiet.reading = &trial;
        (void)imki_step_text_number(&quiet, IMKI_PART_BARE, units[kind][which]);
        if (trial.status != IMK_ERROR_DIMENSION)
            break;
    }
    which = which == 3 ? 0 : which; /* none fits: the message speaks of the first */
    double amplitude = imki_step_text_positive(s, IMKI_PART_BARE, units[kind][which]);
    for (int i = 0; i < orders[kind][which]; i++)
        amplitude /= 2.0 * PI * frequency;
    if (rotates && !(amplitude < rotation_max))
        imki_step_text_refuse(s, IMKI_PART_BARE, IMK_ERROR_RANGE,
                              "a rotation below 0.1 rad; write a step swing for larger ones");
    return amplitude;
}

static void read_sine(vibration_reader *r, const imki_step_text *s)
{
    imk_vibration_line line = {.axis = imki_step_text_axis(s),
                               .frequency = imki_step_text_positive(s, IMKI_PART_AT, "Hz")};
    if (!(line.frequency >= IMK_VIBRATION_FREQUENCY_MIN &&
          line.frequency <= IMK_VIBRATION_FREQUENCY_MAX))
        imki_step_text_refuse(s, IMKI_PART_AT, IMK_ERROR_RANGE,
                              "a frequency from 1e-6 Hz to 1e9 Hz");
    if (imki_step_text_has(s, IMKI_PART_PHASE))
        line.phase = imki_step_text_number(s, IMKI_PART_PHASE, "rad") / (2.0 * PI);
    line.amplitude = read_amplitude(s, line.axis >= 3, line.frequency);
    imk_vibration_line *place = room_for(r, s->node, 1);
    if (!place)
        return;
    *place = line;
    add_lines(r, s->node, 1);
}

/* ---- many lines ------------------------------------------------------------------------------ */

static const char density_unit[] = "(m/s^2)^2/Hz";

/* An error of something else than the document gets the place of a node. */
static void place_error(imki_reading *r, int node)
{
    if (r->status == IMK_OK || !r->error)
        return;
    r->error->line = r->document->node[node].line;
    r->error->column = r->document->node[node].column;
    r->error->index = -1;
    imki_document_path(r->document, node, r->error->field, sizeof r->error->field);
}

static void add_random(vibration_reader *r, int node, const density *d)
{
    imki_reading *reading = r->reading;
    for (size_t i = 1; i < d->corners; i++)
        if (!(d->frequency[i] > d->frequency[i - 1]))
            imki_value_refuse(reading, node, IMK_ERROR_CONFLICT, "the frequencies do not rise",
                              "put the lower frequency first");
    imk_vibration_line *lines = room_for(r, node, d->lines);
    if (!lines)
        return;
    const uint64_t stream =
        imk_stream(0, IMKI_VIBRATION_TERM, r->draws[d->axis]++, (uint8_t)d->axis);
    reading->status =
        imk_vibration_from_density(d->axis, d->corners, d->frequency, d->value, r->random, stream,
                                   d->lines, lines, reading->error);
    if (reading->status == IMK_OK)
        add_lines(r, node, d->lines);
    else
        place_error(reading, node);
}

static void read_flat(vibration_reader *r, const imki_step_text *s)
{
    density d = {.axis = imki_step_text_axis(s), .corners = 2, .lines = IMKI_VIBRATION_LINES};
    d.value[0] = d.value[1] = imki_step_text_positive(s, IMKI_PART_BARE, density_unit);
    d.frequency[0] = imki_step_text_positive(s, IMKI_PART_FROM, "Hz");
    d.frequency[1] = imki_step_text_positive(s, IMKI_PART_TO, "Hz");
    add_random(r, s->node, &d);
}

/* "20 Hz 0.01 g^2/Hz": two quantities; the second begins where a number follows a unit. */
static void read_corner(imki_reading *r, int node, double *frequency, double *value)
{
    static const char due[] = "a frequency and a density, such as 20 Hz 0.01 g^2/Hz";
    if (!imki_value_require(r, node, IMKI_NODE_SCALAR, due))
        return;
    const imki_node *n = &r->document->node[node];
    const char *second = n->text;
    second += strcspn(second, " ");
    second += strspn(second, " ");
    second += strcspn(second, " "); /* behind "20 Hz" */
    if (*second == '\0') {
        imki_refuse_value(r, node, IMK_ERROR_SYNTAX, due);
        return;
    }
    double sigma;
    size_t count;
    r->status = imk_quantity_parse(n->text, second, imk_unit_of("Hz").dimension, 1, frequency,
                                   &sigma, &count, NULL, r->error);
    if (r->status == IMK_OK)
        r->status =
            imk_quantity_parse(second, n->text + n->length, imk_unit_of(density_unit).dimension, 1,
                               value, &sigma, &count, NULL, r->error);
    place_error(r, node);
    if (!(*frequency > 0.0 && *value > 0.0))
        imki_refuse_value(r, node, IMK_ERROR_RANGE, "a frequency and a density above 0");
}

static int read_axis(imki_reading *r, int node)
{
    const imki_node *n = &r->document->node[node];
    if (n->kind == IMKI_NODE_SCALAR && n->length == 1 && n->text[0] >= 'x' && n->text[0] <= 'z')
        return n->text[0] - 'x';
    imki_refuse_value(r, node, IMK_ERROR_SYNTAX, "one of the axes x, y, z");
    return 0;
}

/* {random: {axis: z, density: […], lines: 128}} */
static void read_random(vibration_reader *r, int node)
{
    static const char *const outer[] = {"random"}, *const inner[] = {"axis", "density", "lines"};
    static const char due[] =
        "a mapping: {axis: z, density: [20 Hz 0.01 g^2/Hz, 2000 Hz 0.01 g^2/Hz]}";
    density d = {.lines = IMKI_VIBRATION_LINES};
    imki_reading *reading = r->reading;
    const imki_node *nodes = reading->document->node;
    const int mapping = imki_document_value(reading->document, node, "random");
    int axis, list;
    imki_value_keys(reading, node, 1, outer);
    if (mapping == IMKI_NONE)
        imki_value_refuse(reading, node, IMK_ERROR_SYNTAX, "", verbs[SINE].usage);
    else if (imki_value_require(reading, mapping, IMKI_NODE_MAPPING, due))
        imki_value_keys(reading, mapping, 3, inner);
    if (reading->status != IMK_OK || !imki_value_find(reading, mapping, "axis", due, &axis) ||
        !imki_value_find(reading, mapping, "density", due, &list))
        return;
    const int lines = imki_document_value(reading->document, mapping, "lines");
    d.axis = read_axis(reading, axis);
    if (lines != IMKI_NONE)
        d.lines = imki_value_count(reading, lines, LINES_MIN, IMK_VIBRATION_LINES_MAX,
                                   "a whole number of lines, from 8 to 512");
    if (nodes[list].kind != IMKI_NODE_SEQUENCE || nodes[list].count < 2 ||
        nodes[list].count > CORNERS_MAX)
        imki_value_refuse(reading, list, IMK_ERROR_SYNTAX, "",
                          "a list of 2 to 64 corners: [20 Hz 0.01 g^2/Hz, 2000 Hz 0.01 g^2/Hz]");
    for (int i = nodes[list].first; reading->status == IMK_OK && i != IMKI_NONE;
         i = nodes[i].next, d.corners++)
        read_corner(reading, i, &d.frequency[d.corners], &d.value[d.corners]);
    add_random(r, node, &d);
}

static void read_vibration(vibration_reader *r, int node)
{
    imki_step_text s;
    if (r->reading->document->node[node].kind == IMKI_NODE_MAPPING)
        read_random(r, node);
    else if (imki_value_require(r->reading, node, IMKI_NODE_SCALAR, verbs[SINE].usage) &&
             imki_step_text_read(r->reading, node, "a vibration", 2, verbs, &s))
        (s.verb->kind == SINE ? read_sine : read_flat)(r, &s);
}

void imki_vibration_read(imki_reading *reading, int sequence, uint64_t seed, imk_motion_file *file)
{
    vibration_reader r = {.reading = reading, .file = file, .random = imk_random_seeded(seed)};
    if (!imki_value_require(reading, sequence, IMKI_NODE_SEQUENCE,
                            "a list: [sine z 0.5 g at 50 Hz, …]"))
        return;
    file->line = calloc(IMK_VIBRATION_LINES_MAX, sizeof *file->line);
    if (!file->line)
        reading->status = imk_error_set(reading->error, IMK_ERROR_MEMORY, "", "", "");
    file->trajectory.line = file->line;
    for (int i = reading->document->node[sequence].first;
         reading->status == IMK_OK && i != IMKI_NONE; i = reading->document->node[i].next)
        read_vibration(&r, i);
}
