/* SPDX-License-Identifier: Apache-2.0 */
/* MATLAB's imuSensor: the JSON file that loadparams() reads, one object per part with Gyroscope and
 * Accelerometer objects of gyroparams and accelparams.
 *
 * imuSensor computes, with fs the sample rate and B = fs/2 for NoiseType double-sided (its default)
 * or fs for single-sided:
 *
 *     reading = (1 + (T - 25) TemperatureScaleFactor/100) (AxesMisalignment/100 v + ConstantBias
 *               + (T - 25) TemperatureBias + AccelerationBias a + noise)
 *     white noise: sigma = NoiseDensity sqrt(B),   random walk: step RandomWalk/sqrt(B)
 *
 * so that N = NoiseDensity/sqrt(2) and K = sqrt(2) RandomWalk when double-sided, N = NoiseDensity
 * and K = RandomWalk when single-sided: its names are the other way round than one would think. */
#include "parameter_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char *const sensor_names[2] = {"Gyroscope", "Accelerometer"};

static const char *const keys[] = {"MeasurementRange",
                                   "Resolution",
                                   "ConstantBias",
                                   "AxesMisalignment",
                                   "NoiseDensity",
                                   "BiasInstability",
                                   "RandomWalk",
                                   "NoiseType",
                                   "TemperatureBias",
                                   "AccelerationBias",
                                   "TemperatureScaleFactor",
                                   "BiasInstabilityCoefficients"};
enum { KEYS = sizeof keys / sizeof keys[0] };

/* 25 degC, at which temperature terms vanish, and the range MATLAB does not state: that of
 * industrial parts. */
static const double reference_temperature = 25 + 273.15, minimum_temperature = -40 + 273.15,
                    maximum_temperature = 85 + 273.15;

/* ---- reading --------------------------------------------------------------------------------- */

/* Of NoiseDensity and RandomWalk; 1/sqrt(2) and sqrt(2) for double-sided. */
typedef struct noise_scale {
    double white, random_walk;
} noise_scale;

static noise_scale read_noise_type(imki_parameters *p, int sensor)
{
    const int node = imki_node_value(p, sensor, "NoiseType");
    const char *type = imki_node_text(p, node);
    bool single = strcmp(type, "single-sided") == 0;
    if (node != IMKI_NONE && !single && strcmp(type, "double-sided") != 0)
        imki_refuse_node(p, node, IMK_ERROR_SYNTAX, type,
                         "a noise type: \"single-sided\" or \"double-sided\"");
    if (p->settings->density != IMK_DENSITY_UNSTATED) {
        single = p->settings->density == IMK_DENSITY_TWO_SIDED;
        imki_note(p, false, "NoiseDensity is taken as %s, as --density says",
                  single ? "two-sided" : "one-sided");
    } else if (!single) {
        imki_note(p, false,
                  "NoiseType %sdouble-sided is simulated by MATLAB with sigma = "
                  "NoiseDensity*sqrt(rate/2): NoiseDensity is taken as one-sided, N = "
                  "NoiseDensity/sqrt(2)",
                  node == IMKI_NONE ? "is not given; its default " : "");
    }
    return single ? (noise_scale){1, 1} : (noise_scale){sqrt(0.5), sqrt(2.0)};
}

/* A scalar or three: the off-diagonal elements of the columns [%]; or the matrix. */
static void read_misalignment(imki_parameters *p, int sensor, imk_triad *triad)
{
    const int node = imki_node_value(p, sensor, "AxesMisalignment");
    double matrix[3][3] = {{0}}, column[3] = {0};
    if (node == IMKI_NONE)
        return;
    const imki_node *n = &p->document->node[node];
    if (n->kind == IMKI_NODE_SEQUENCE && n->count == 3 &&
        imki_node_is(p, n->first, IMKI_NODE_SEQUENCE)) {
        imki_node_matrix(p, node, matrix);
    } else {
        imki_node_numbers(p, node, 3, column);
        for (int i = 0; i < 9; i++)
            matrix[i / 3][i % 3] = i % 4 == 0 ? 100 : column[i % 3];
    }
    for (int i = 0; i < 9; i++)
        matrix[i / 3][i % 3] /= 100;
    imki_response_set(p, imki_node_place(p, node), triad, matrix);
}

static void set_linear(imk_temperature_polynomial *polynomial, const double slope[3])
{
    if (!imki_any(slope))
        return;
    polynomial->order = 1;
    memcpy(polynomial->coefficient[0].value, slope, 3 * sizeof slope[0]);
    polynomial->reference = reference_temperature;
    polynomial->minimum = minimum_temperature;
    polynomial->maximum = maximum_temperature;
}

static void read_temperature(imki_parameters *p, int sensor, int kind, imk_triad *triad)
{
    double bias[3] = {0}, scale[3] = {0};
    imki_node_accept(p, sensor, "TemperatureBias", kind, IMKI_PLAIN, (imki_unit){"", 1}, bias);
    imki_node_accept(p, sensor, "TemperatureScaleFactor", kind, IMKI_PLAIN,
                     (imki_unit){"%/degC", 0.01}, scale);
    set_linear(&triad->bias.temperature, bias);
    set_linear(&triad->scale_factor.temperature, scale);
    if (triad->bias.temperature.order + triad->scale_factor.temperature.order > 0)
        imki_note(p, false,
                  "temperature terms are linear about 25 degC; MATLAB states no range: -40 to 85 "
                  "degC is assumed");
    if (triad->scale_factor.temperature.order > 0)
        imki_note(p, false,
                  "MATLAB multiplies bias and noise by the temperature scale factor as well; the "
                  "model does not");
}

static void read_acceleration_bias(imki_parameters *p, int sensor, imk_triad *triad)
{
    double g[3] = {0};
    imki_node_accept(p, sensor, "AccelerationBias", IMK_GYRO, IMKI_PLAIN,
                     (imki_unit){"(rad/s)/(m/s^2)", 1}, g);
    for (int i = 0; i < 3; i++)
        triad->g_sensitivity.value[i][i] = g[i];
    if (imki_any(g))
        imki_note(p, false,
                  "AccelerationBias becomes the diagonal of g_sensitivity, which multiplies the "
                  "specific force; MATLAB multiplies the acceleration it is given");
}

static void read_output(imki_parameters *p, int sensor, int kind, imk_triad *triad)
{
    double range[3] = {INFINITY, INFINITY, INFINITY};
    const int node = imki_node_value(p, sensor, "MeasurementRange");
    if (node != IMKI_NONE)
        imki_node_numbers(p, node, 3, range);
    imki_node_accept(p, sensor, "Resolution", kind, IMKI_PLAIN,
                     (imki_unit){imki_kind_units[kind], 1}, triad->resolution.value);
    for (int i = 0; i < 3; i++) {
        if (!(range[i] > 0))
            imki_refuse_node(p, node, IMK_ERROR_RANGE, imki_node_text(p, node), "a positive range");
        triad->range.value[i] = isinf(range[i]) ? 0 : range[i];
    }
}

static void read_noise(imki_parameters *p, int sensor, int kind, imk_triad *triad)
{
    static const char *const white[2] = {"rad/s/sqrt(Hz)", "m/s^2/sqrt(Hz)"};
    static const char *const walk[2] = {"rad/s*sqrt(Hz)", "m/s^2*sqrt(Hz)"};
    const imki_unit unit = {imki_kind_units[kind], 1};
    const noise_scale scale = read_noise_type(p, sensor);
    imki_node_accept(p, sensor, "ConstantBias", kind, IMKI_BIAS, unit, triad->bias.fixed.value);
    imki_node_accept(p, sensor, "NoiseDensity", kind, IMKI_WHITE,
                     (imki_unit){white[kind], scale.white}, triad->noise.white.value);
    imki_node_accept(p, sensor, "BiasInstability", kind, IMKI_DRIFT, unit,
                     triad->noise.bias_instability.value);
    imki_node_accept(p, sensor, "RandomWalk", kind, IMKI_RANDOM_WALK,
                     (imki_unit){walk[kind], scale.random_walk}, triad->noise.random_walk.value);
    if (imki_any(triad->noise.bias_instability.value))
        imki_note(p, false,
                  "BiasInstability is taken as B (the Allan floor is 0.664 B); what MATLAB "
                  "simulates depends on BiasInstabilityCoefficients, which are not read");
}

static void read_sensor(imki_parameters *p, int part, int kind)
{
    const int sensor = imki_node_value(p, part, sensor_names[kind]);
    imk_triad *triad = p->triad[kind];
    triad->present = sensor != IMKI_NONE;
    if (!triad->present)
        return;
    if (!imki_node_is(p, sensor, IMKI_NODE_MAPPING)) {
        imki_refuse_node(p, sensor, IMK_ERROR_SYNTAX, "",
                         "an object with the properties of the sensor");
        return;
    }
    read_noise(p, sensor, kind, triad);
    read_misalignment(p, sensor, triad);
    read_temperature(p, sensor, kind, triad);
    read_output(p, sensor, kind, triad);
    if (kind == IMK_GYRO)
        read_acceleration_bias(p, sensor, triad);
    imki_foreign_keys(p, sensor, KEYS, keys);
}

static bool is_part(const imki_parameters *p, int node)
{
    return imki_node_value(p, node, sensor_names[0]) != IMKI_NONE ||
           imki_node_value(p, node, sensor_names[1]) != IMKI_NONE;
}

/* The part of settings->sensor, or the only one; the root itself may be one. */
static int find_part(imki_parameters *p)
{
    imki_choice choice = {.found = 0};
    if (is_part(p, 0))
        return 0;
    for (int key = p->document->node[0].first; key != IMKI_NONE; key = imki_key_after(p, key))
        if (is_part(p, p->document->node[key].next))
            imki_choice_add(p, &choice, p->document->node[key].text, p->document->node[key].next);
    if (choice.count == 0)
        imki_parameter_refuse(p, IMK_ERROR_KEY_MISSING, "sensor", "Gyroscope",
                              "a part with a Gyroscope or an Accelerometer");
    imki_choice_end(p, choice.found, choice.names, "NAME", "the file has several parts");
    return choice.chosen;
}

void imki_matlab_read(imki_parameters *p)
{
    if (!imki_parameters_document(p))
        return;
    const int part = find_part(p), key = p->document->node[part].key;
    if (key != IMKI_NONE)
        snprintf(p->model->name, sizeof p->model->name, "%.90s", p->document->node[key].text);
    for (int kind = 0; kind < 2; kind++)
        read_sensor(p, part, kind);
    if (imki_node_value(p, part, "Magnetometer") != IMKI_NONE)
        imki_note(p, true, "Magnetometer is not read: a model has none");
}

/* ---- writing --------------------------------------------------------------------------------- */

static void write_vector(imki_parameters *p, const char *key, const double values[3], double scale)
{
    double scaled[3] = {values[0] * scale, values[1] * scale, values[2] * scale};
    imki_text_add(&p->out, "      \"%s\": ", key);
    imki_text_vector(&p->out, scaled);
    imki_text_add(&p->out, ",\n");
}

/* One number for all axes: the smallest range, the coarsest resolution. */
static void write_output(imki_parameters *p, const imk_triad *triad)
{
    double range = 0, resolution = 0;
    for (int i = 0; i < 3; i++) {
        double x = triad->range.value[i];
        range = x > 0 && (range == 0 || x < range) ? x : range;
        resolution = fmax(resolution, triad->resolution.value[i]);
    }
    imki_text_add(&p->out, "      \"MeasurementRange\": %s,\n      \"Resolution\": %s,\n",
                  range > 0 ? imki_shortest(range).text : "\"Inf\"",
                  imki_shortest(resolution).text);
}

static void write_sensor(imki_parameters *p, int kind, const imk_triad *triad, bool is_last)
{
    static const double none[3] = {0};
    double response[3][3], diagonal[3];
    const imk_temperature_polynomial *bias = &triad->bias.temperature,
                                     *scale = &triad->scale_factor.temperature;
    imki_response_of(triad, response);
    imki_text_add(&p->out, "    \"%s\": {\n", sensor_names[kind]);
    write_output(p, triad);
    write_vector(p, "ConstantBias", triad->bias.fixed.value, 1);
    imki_text_add(&p->out, "      \"AxesMisalignment\": [");
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            response[i][j] *= 100;
        imki_text_vector(&p->out, response[i]);
        imki_text_add(&p->out, i < 2 ? ", " : "],\n");
    }
    /* loadparams() takes no text but "Inf", so that NoiseType stays double-sided. */
    bool single = p->settings->density == IMK_DENSITY_TWO_SIDED;
    write_vector(p, "NoiseDensity", triad->noise.white.value, single ? 1 : sqrt(2.0));
    write_vector(p, "BiasInstability", triad->noise.bias_instability.value, 1);
    write_vector(p, "RandomWalk", triad->noise.random_walk.value, single ? 1 : sqrt(0.5));
    imki_note(p, false, "NoiseDensity is written as %s N, for NoiseType %s",
              single ? "the two-sided" : "sqrt(2)",
              single ? "single-sided: set it in MATLAB" : "double-sided, MATLAB's default");
    for (int i = 0; i < 3; i++)
        diagonal[i] = triad->g_sensitivity.value[i][i];
    if (kind == IMK_GYRO)
        write_vector(p, "AccelerationBias", diagonal, 1);
    write_vector(p, "TemperatureBias", bias->order > 0 ? bias->coefficient[0].value : none, 1);
    imki_text_add(&p->out, "      \"TemperatureScaleFactor\": [");
    for (int i = 0; i < 3; i++) {
        double percent = scale->order > 0 ? 100 * scale->coefficient[0].value[i] : 0;
        if (percent < 0)
            imki_note(p, true,
                      "TemperatureScaleFactor must not be negative in MATLAB: it will "
                      "refuse the file");
        imki_text_add(&p->out, "%s%s", imki_shortest(percent).text, i < 2 ? ", " : "]\n");
    }
    imki_text_add(&p->out, is_last ? "    }\n" : "    },\n");
}

void imki_matlab_write(imki_parameters *p)
{
    char name[sizeof p->source->name];
    size_t length = 0;
    /* A part is a field of a structure: letters and digits. */
    for (const char *c = p->source->name; *c; c++)
        if ((*c >= '0' && *c <= '9' && length > 0) || (*c >= 'a' && *c <= 'z') ||
            (*c >= 'A' && *c <= 'Z'))
            name[length++] = *c;
    name[length] = '\0';
    imki_text_add(&p->out, "{\n  \"%s\": {\n", length > 0 ? name : "imu");
    for (int kind = 0; kind < 2; kind++)
        if (p->origin[kind]->present)
            write_sensor(p, kind, p->origin[kind], kind == IMK_ACCEL || !p->source->accel.present);
    imki_text_add(&p->out, "  }\n}\n");
}
