/* SPDX-License-Identifier: Apache-2.0 */
/* Gazebo: the noise of an IMU sensor in SDF, also within URDF.
 *
 *     <sensor name="…" type="imu"><update_rate>200</update_rate><imu>
 *       <angular_velocity><x><noise type="gaussian"><mean>…</mean><stddev>…</stddev>…
 *
 * As GaussianNoiseModel of gz-sensors (and of Gazebo classic) has it: a sample gets a normal number
 * of mean and stddev, N = stddev/sqrt(rate); the run constant bias_mean ± bias_stddev with either
 * sign; and with dynamic_bias_stddev s and dynamic_bias_correlation_time T a bias driven by noise
 * of density s, sigma = s sqrt(T/2). precision is the resolution.
 *
 * The file of SDF 1.4 and before (<imu><noise><type>, <rate>, <accel>) is read as well. */
#include "parameter_internal.h"

#include <expat.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { DEPTH_MAX = 32, NAME_SIZE = 40, TEXT_SIZE = 64, SENSORS_MAX = 16 };

typedef enum noise_key {
    MEAN,
    STDDEV,
    BIAS_MEAN,
    BIAS_STDDEV,
    DYNAMIC_STDDEV,
    DYNAMIC_TIME,
    PRECISION,
    KEYS
} noise_key;
static const char *const key_names[KEYS] = {"mean",
                                            "stddev",
                                            "bias_mean",
                                            "bias_stddev",
                                            "dynamic_bias_stddev",
                                            "dynamic_bias_correlation_time",
                                            "precision"};

typedef struct noise {
    bool present[3];
    double value[KEYS][3];
    imki_place place[KEYS];
} noise;

typedef struct sensor {
    char name[NAME_SIZE];
    double rate;
    noise noise[2];
} sensor;

typedef struct xml_reader {
    imki_parameters *p;
    XML_Parser parser;
    int depth;
    char path[DEPTH_MAX][NAME_SIZE]; /* names of the open elements */
    char text[TEXT_SIZE];            /* of the innermost */
    size_t length;
    bool is_none; /* within <noise type="none"> */
    int sensor_depth, count;
    bool is_open; /* within a sensor that is an IMU */
    sensor sensor[SENSORS_MAX];
} xml_reader;

/* ---- reading --------------------------------------------------------------------------------- */

static imki_place place_of(const xml_reader *r, const char *name)
{
    return (imki_place){name, XML_GetCurrentLineNumber(r->parser),
                        XML_GetCurrentColumnNumber(r->parser) + 1};
}

static void fail(xml_reader *r, const char *name, imk_status status, const char *found,
                 const char *expected)
{
    imki_parameter_refuse_at(r->p, place_of(r, name), status, found, expected);
    XML_StopParser(r->parser, XML_FALSE);
}

static void open_sensor(xml_reader *r, const char **attributes)
{
    const char *name = "", *type = "";
    for (int i = 0; attributes[i]; i += 2) {
        name = strcmp(attributes[i], "name") == 0 ? attributes[i + 1] : name;
        type = strcmp(attributes[i], "type") == 0 ? attributes[i + 1] : type;
    }
    if (strcmp(type, "imu") != 0)
        return;
    if (r->count == SENSORS_MAX) {
        fail(r, "sensor", IMK_ERROR_UNSUPPORTED, "too many sensors", "at most 16 IMUs in a file");
        return;
    }
    sensor *s = &r->sensor[r->count++];
    memset(s, 0, sizeof *s);
    snprintf(s->name, sizeof s->name, "%s", name);
    r->is_open = true;
    r->sensor_depth = r->depth;
}

static void XMLCALL start_element(void *data, const char *name, const char **attributes)
{
    xml_reader *r = data;
    if (r->depth == DEPTH_MAX) {
        fail(r, "sensor", IMK_ERROR_UNSUPPORTED, "nested too deeply", "at most 32 levels");
        return;
    }
    snprintf(r->path[r->depth++], NAME_SIZE, "%s", name);
    r->length = 0;
    r->text[0] = '\0';
    if (strcmp(name, "sensor") == 0 && !r->is_open)
        open_sensor(r, attributes);
    if (strcmp(name, "noise") != 0)
        return;
    r->is_none = false;
    for (int i = 0; attributes[i]; i += 2)
        if (strcmp(attributes[i], "type") == 0)
            r->is_none = strcmp(attributes[i + 1], "none") == 0;
}

static void XMLCALL take_characters(void *data, const char *characters, int count)
{
    xml_reader *r = data;
    for (int i = 0; i < count && r->length + 1 < sizeof r->text; i++)
        r->text[r->length++] = characters[i];
    r->text[r->length] = '\0';
}

static bool is_open_element(const xml_reader *r, int above, const char *name)
{
    return r->depth > above && strcmp(r->path[r->depth - 1 - above], name) == 0;
}

/* Which of gyro and accelerometer, and which axes, the innermost element speaks of. */
static bool find_axes(const xml_reader *r, int *kind, int *first, int *last)
{
    static const char *const names[2][2] = {{"angular_velocity", "rate"},
                                            {"linear_acceleration", "accel"}};
    for (*kind = 0; *kind < 2; (*kind)++) {
        *first = 0;
        *last = 2;
        /* <noise><rate><mean> of old */
        if (is_open_element(r, 1, names[*kind][1]) && is_open_element(r, 2, "noise"))
            return true;
        if (!is_open_element(r, 1, "noise") || !is_open_element(r, 3, names[*kind][0]))
            continue;
        const char *axis = r->path[r->depth - 3];
        *first = *last = axis[0] - 'x';
        return axis[0] >= 'x' && axis[0] <= 'z' && axis[1] == '\0';
    }
    return false;
}

static void take_value(xml_reader *r, const char *name)
{
    sensor *s = &r->sensor[r->count - 1];
    int kind = 0, first = 0, last = 0;
    size_t key = 0;
    double value = 0;
    bool is_rate = strcmp(name, "update_rate") == 0 && r->depth == r->sensor_depth + 1;
    while (key < KEYS && strcmp(name, key_names[key]) != 0)
        key++;
    bool is_noise = key < KEYS && find_axes(r, &kind, &first, &last);
    if (!is_rate && !is_noise)
        return;
    const char *field = is_rate ? "update_rate" : key_names[key];
    if (!imki_number(r->text, r->text + r->length, &value) || !(fabs(value) < 1e300)) {
        bool is_macro = strstr(r->text, "${") != NULL;
        fail(r, field, IMK_ERROR_SYNTAX, r->text,
             is_macro ? "expand the macros first: xacro FILE > expanded.urdf"
                      : "a number without a unit");
        return;
    }
    if (is_rate) {
        s->rate = value;
        return;
    }
    for (int axis = first; axis <= last; axis++) {
        s->noise[kind].present[axis] = true;
        s->noise[kind].value[key][axis] = r->is_none ? 0 : value;
    }
    s->noise[kind].place[key] = place_of(r, field);
}

static void XMLCALL end_element(void *data, const char *name)
{
    xml_reader *r = data;
    if (r->p->status != IMK_OK) /* a stopped parser still closes an empty element */
        return;
    if (r->is_open) {
        if (strcmp(name, "type") == 0 && is_open_element(r, 1, "noise"))
            r->is_none = strstr(r->text, "none") != NULL;
        take_value(r, name);
    }
    if (r->is_open && r->depth == r->sensor_depth)
        r->is_open = false;
    r->depth--;
    r->length = 0;
    r->text[0] = '\0';
}

/* Entities can be defined only in a document type, which SDF does not have. */
static void XMLCALL refuse_doctype(void *data, const char *name, const char *system,
                                   const char *public_name, int has_subset)
{
    xml_reader *r = data;
    (void)name, (void)system, (void)public_name, (void)has_subset;
    fail(r, "", IMK_ERROR_UNSUPPORTED, "a document type", "remove <!DOCTYPE …>: SDF has none");
}

static void parse(xml_reader *r, imki_parameters *p)
{
    r->p = p;
    r->parser = XML_ParserCreate(NULL);
    if (!r->parser) {
        imki_parameter_refuse(p, IMK_ERROR_MEMORY, "", "", "");
        return;
    }
    XML_SetUserData(r->parser, r);
    XML_SetElementHandler(r->parser, start_element, end_element);
    XML_SetCharacterDataHandler(r->parser, take_characters);
    XML_SetStartDoctypeDeclHandler(r->parser, refuse_doctype);
    enum XML_Status result = XML_Parse(r->parser, p->text, (int)p->size, XML_TRUE);
    if (result != XML_STATUS_OK)
        imki_parameter_refuse_at(p, place_of(r, ""), IMK_ERROR_SYNTAX, "",
                                 XML_ErrorString(XML_GetErrorCode(r->parser)));
    XML_ParserFree(r->parser);
}

static const sensor *choose(imki_parameters *p, const xml_reader *r)
{
    imki_choice choice = {.found = 0};
    for (int i = 0; i < r->count; i++)
        imki_choice_add(p, &choice, r->sensor[i].name, i);
    if (r->count == 0)
        imki_parameter_refuse(p, IMK_ERROR_KEY_MISSING, "sensor", "<sensor type=\"imu\">",
                              "an IMU: <sensor name=\"imu\" type=\"imu\">");
    imki_choice_end(p, choice.found, choice.names, "NAME", "the file has several IMUs");
    return &r->sensor[choice.chosen];
}

static double find_rate(imki_parameters *p, const sensor *s)
{
    const double given = p->settings->rate, rate = given > 0 ? given : s->rate;
    bool white = false;
    for (int i = 0; i < 6; i++)
        white = white || s->noise[i / 3].value[STDDEV][i % 3] != 0;
    if (given > 0 && s->rate > 0 && given != s->rate)
        imki_note(
            p, false,
            "stddev is taken per sample at %g Hz, as --rate says, not at the update_rate of %g Hz",
            given, s->rate);
    if (white && !(rate > 0))
        imki_parameter_refuse_at(p, s->noise[s->noise[0].place[STDDEV].field ? 0 : 1].place[STDDEV],
                                 IMK_ERROR_KEY_MISSING,
                                 "\"stddev\" is per sample, and update_rate is missing",
                                 "add --rate RATE (samples per second, as 200Hz)");
    return rate;
}

static void fill(imki_parameters *p, const noise *n, int kind, double rate)
{
    static const imki_quantity quantities[KEYS] = {
        IMKI_BIAS, IMKI_WHITE, IMKI_BIAS, IMKI_DRIFT, IMKI_RANDOM_WALK, IMKI_TIME, IMKI_DRIFT};
    imk_triad *triad = p->triad[kind];
    double si[KEYS][3] = {{0}};
    triad->present = n->present[0] || n->present[1] || n->present[2];
    for (int key = 0; key < KEYS; key++) {
        char unit[40];
        snprintf(unit, sizeof unit, "%s%s", imki_kind_units[kind],
                 key == STDDEV           ? " per sample"
                 : key == DYNAMIC_STDDEV ? "/s/sqrt(Hz)"
                                         : "");
        double scale = key == STDDEV && rate > 0 ? 1 / sqrt(rate) : 1;
        imki_place place = n->place[key];
        place.field = key_names[key];
        imki_accept(p, place, kind, quantities[key], n->value[key], (imki_unit){unit, scale},
                    si[key]);
    }
    double sigma[3] = {0}, time[3] = {0};
    for (int i = 0; i < 3; i++) {
        triad->bias.fixed.value[i] = si[MEAN][i] + si[BIAS_MEAN][i];
        if (si[DYNAMIC_STDDEV][i] != 0 && si[DYNAMIC_TIME][i] > 0) {
            sigma[i] = si[DYNAMIC_STDDEV][i] * sqrt(si[DYNAMIC_TIME][i] / 2);
            time[i] = si[DYNAMIC_TIME][i];
        }
        if (si[BIAS_MEAN][i] != 0)
            imki_note(p, false,
                      "bias_mean keeps its sign; Gazebo draws the sign at random in each run");
        if (si[DYNAMIC_STDDEV][i] != 0 && si[DYNAMIC_TIME][i] <= 0)
            imki_note(p, true, "dynamic_bias_stddev without a correlation time: Gazebo ignores it");
    }
    if (sigma[0] + sigma[1] + sigma[2] > 0)
        imki_note(p, false,
                  "dynamic_bias_stddev s is the density of the noise that drives the bias: sigma = "
                  "s*sqrt(correlation_time/2)");
    memcpy(triad->noise.white.value, si[STDDEV], sizeof si[STDDEV]);
    memcpy(triad->bias.repeatability.value, si[BIAS_STDDEV], sizeof si[BIAS_STDDEV]);
    memcpy(triad->resolution.value, si[PRECISION], sizeof si[PRECISION]);
    imki_add_gauss_markov(triad, sigma, time);
}

void imki_gazebo_read(imki_parameters *p)
{
    xml_reader reader = {.count = 0};
    parse(&reader, p);
    const sensor *chosen = choose(p, &reader);
    const double rate = find_rate(p, chosen);
    for (int kind = 0; kind < 2; kind++)
        fill(p, &chosen->noise[kind], kind, rate);
    if (!p->model->gyro.present && !p->model->accel.present)
        imki_parameter_refuse(p, IMK_ERROR_KEY_MISSING, "noise", "<noise>",
                              "a noise in angular_velocity or linear_acceleration");
    snprintf(p->model->name, sizeof p->model->name, "%s", chosen->name);
}

/* ---- writing --------------------------------------------------------------------------------- */

static void write_axis(imki_parameters *p, const imk_triad *triad, int axis, double rate)
{
    double sigma[3], time[3], value[KEYS] = {0};
    imki_first_gauss_markov(triad, sigma, time);
    /* With its sign the bias must be the mean: bias_mean gets a random one. */
    value[MEAN] = triad->bias.fixed.value[axis];
    value[STDDEV] = rate > 0 ? triad->noise.white.value[axis] * sqrt(rate) : 0;
    value[BIAS_STDDEV] = triad->bias.repeatability.value[axis];
    value[DYNAMIC_STDDEV] = sigma[axis] == 0 ? 0 : sigma[axis] * sqrt(2 / time[axis]);
    value[DYNAMIC_TIME] = sigma[axis] == 0 ? 0 : time[axis];
    value[PRECISION] = triad->resolution.value[axis];
    imki_text_add(&p->out, "            <%c>\n              <noise type=\"gaussian%s\">\n",
                  'x' + axis, value[PRECISION] > 0 ? "_quantized" : "");
    for (int key = 0; key < KEYS; key++) {
        if (key > BIAS_STDDEV && value[key] == 0)
            continue;
        imki_text_add(&p->out, "                <%s>%s</%s>\n", key_names[key],
                      imki_shortest(value[key]).text, key_names[key]);
    }
    imki_text_add(&p->out, "              </noise>\n            </%c>\n", 'x' + axis);
}

static bool has_white(const imk_triad *triad)
{
    return triad->present && imki_any(triad->noise.white.value);
}

void imki_gazebo_write(imki_parameters *p)
{
    static const char *const names[2] = {"angular_velocity", "linear_acceleration"};
    const double rate = p->settings->rate;
    if (!(rate > 0) && (has_white(p->origin[0]) || has_white(p->origin[1])))
        imki_parameter_refuse(p, IMK_ERROR_KEY_MISSING, "stddev",
                              "\"stddev\" is per sample, and the sampling rate is not known",
                              "add --rate RATE (samples per second, as 200Hz)");
    imki_text_add(&p->out, "<?xml version=\"1.0\"?>\n<sdf version=\"1.9\">\n  <model "
                           "name=\"imu\">\n    <link name=\"link\">\n      <sensor name=\"imu\" "
                           "type=\"imu\">\n        <always_on>true</always_on>\n");
    if (rate > 0)
        imki_text_add(&p->out,
                      "        <update_rate>%s</update_rate>\n        <!-- stddev is per sample at "
                      "this rate -->\n",
                      imki_shortest(rate).text);
    imki_text_add(&p->out, "        <imu>\n");
    for (int kind = 0; kind < 2; kind++) {
        if (!p->origin[kind]->present)
            continue;
        imki_text_add(&p->out,
                      "          <%s> <!-- [%s]; dynamic_bias_stddev per s per sqrt(Hz), "
                      "correlation time [s] -->\n",
                      names[kind], imki_kind_units[kind]);
        for (int axis = 0; axis < 3; axis++)
            write_axis(p, p->origin[kind], axis, rate);
        imki_text_add(&p->out, "          </%s>\n", names[kind]);
    }
    imki_text_add(&p->out, "        </imu>\n      </sensor>\n    </link>\n  </model>\n</sdf>\n");
}
