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
#include "model/model_schema_internal.h"
#include "parameter_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char *const sensor_names[2] = {"Gyroscope", "Accelerometer"};
static const char *const units[2] = {"rad/s", "m/s^2"};

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

static imk_status read_noise_type(imki_parameters *p, const imk_document *document, int sensor,
                                  noise_scale *scale)
{
    int node = imki_document_value(document, sensor, "NoiseType");
    const char *type = imki_node_text(document, node);
    bool single = strcmp(type, "single-sided") == 0;
    if (node != IMKI_NONE && !single && strcmp(type, "double-sided") != 0)
        return imki_document_error(document, node, IMK_ERROR_SYNTAX, type,
                                   "a noise type: \"single-sided\" or \"double-sided\"", p->error);
    if (p->settings->density != IMK_DENSITY_UNSTATED) {
        single = p->settings->density == IMK_DENSITY_TWO_SIDED;
        imki_note(p, false, "NoiseDensity is taken as %s, as the option says",
                  single ? "two-sided" : "one-sided");
    } else if (!single) {
        imki_note(p, false,
                  "NoiseType %sdouble-sided is simulated by MATLAB with sigma = "
                  "NoiseDensity*sqrt(rate/2): NoiseDensity is taken as one-sided, N = "
                  "NoiseDensity/sqrt(2)",
                  node == IMKI_NONE ? "is not given; its default " : "");
    }
    *scale = single ? (noise_scale){1, 1} : (noise_scale){sqrt(0.5), sqrt(2.0)};
    return IMK_OK;
}

/* A scalar or three: the off-diagonal elements of the columns [%]; or the matrix. */
static imk_status read_misalignment(imki_parameters *p, const imk_document *document, int sensor,
                                    imk_triad *triad)
{
    int node = imki_document_value(document, sensor, "AxesMisalignment");
    double matrix[3][3], column[3];
    imk_status status;
    if (node == IMKI_NONE)
        return IMK_OK;
    const imki_node *n = &document->node[node];
    if (n->kind == IMKI_NODE_SEQUENCE && n->count == 3 &&
        document->node[n->first].kind == IMKI_NODE_SEQUENCE) {
        status = imki_node_matrix(p, document, node, matrix);
    } else {
        status = imki_node_numbers(p, document, node, 3, column);
        for (int i = 0; i < 9 && status == IMK_OK; i++)
            matrix[i / 3][i % 3] = i % 4 == 0 ? 100 : column[i % 3];
    }
    if (status != IMK_OK)
        return status;
    for (int i = 0; i < 9; i++)
        matrix[i / 3][i % 3] /= 100;
    return imki_response_set(p, imki_node_place(document, node), triad, matrix);
}

static void set_linear(imk_temperature_polynomial *polynomial, const double slope[3])
{
    if (slope[0] == 0 && slope[1] == 0 && slope[2] == 0)
        return;
    polynomial->order = 1;
    imki_to_axes(slope, &polynomial->coefficient[0]);
    polynomial->reference = reference_temperature;
    polynomial->minimum = minimum_temperature;
    polynomial->maximum = maximum_temperature;
}

static imk_status read_temperature(imki_parameters *p, const imk_document *document, int sensor,
                                   int kind, imk_triad *triad)
{
    double bias[3] = {0}, scale[3] = {0};
    imk_status status = imki_node_accept(p, document, sensor, "TemperatureBias", kind, IMKI_PLAIN,
                                         (imki_unit){"", 1}, bias);
    if (status == IMK_OK)
        status = imki_node_accept(p, document, sensor, "TemperatureScaleFactor", kind, IMKI_PLAIN,
                                  (imki_unit){"%/degC", 0.01}, scale);
    if (status != IMK_OK)
        return status;
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
    return IMK_OK;
}

static imk_status read_acceleration_bias(imki_parameters *p, const imk_document *document,
                                         int sensor, imk_triad *triad)
{
    double g[3] = {0};
    imk_status status = imki_node_accept(p, document, sensor, "AccelerationBias", IMK_GYRO,
                                         IMKI_PLAIN, (imki_unit){"(rad/s)/(m/s^2)", 1}, g);
    for (int i = 0; i < 3; i++)
        triad->g_sensitivity.value[i][i] = g[i];
    if (g[0] != 0 || g[1] != 0 || g[2] != 0)
        imki_note(p, false,
                  "AccelerationBias becomes the diagonal of g_sensitivity, which multiplies the "
                  "specific force; MATLAB multiplies the acceleration it is given");
    return status;
}

static imk_status read_output(imki_parameters *p, const imk_document *document, int sensor,
                              int kind, imk_triad *triad)
{
    double range[3] = {INFINITY, INFINITY, INFINITY}, resolution[3] = {0};
    int node = imki_document_value(document, sensor, "MeasurementRange");
    imk_status status = IMK_OK;
    if (node != IMKI_NONE)
        status = imki_node_numbers(p, document, node, 3, range);
    if (status == IMK_OK)
        status = imki_node_accept(p, document, sensor, "Resolution", kind, IMKI_PLAIN,
                                  (imki_unit){units[kind], 1}, resolution);
    for (int i = 0; i < 3 && status == IMK_OK; i++) {
        if (!(range[i] > 0))
            return imki_document_error(document, node, IMK_ERROR_RANGE,
                                       imki_node_text(document, node), "a positive range",
                                       p->error);
        triad->range.value[i] = isinf(range[i]) ? 0 : range[i];
        triad->resolution.value[i] = resolution[i];
    }
    return status;
}

static imk_status read_noise(imki_parameters *p, const imk_document *document, int sensor, int kind,
                             imk_triad *triad)
{
    static const char *const white[2] = {"rad/s/sqrt(Hz)", "m/s^2/sqrt(Hz)"};
    static const char *const walk[2] = {"rad/s*sqrt(Hz)", "m/s^2*sqrt(Hz)"};
    double bias[3] = {0}, n[3] = {0}, b[3] = {0}, k[3] = {0};
    noise_scale scale = {1, 1};
    imk_status status = read_noise_type(p, document, sensor, &scale);
    if (status == IMK_OK)
        status = imki_node_accept(p, document, sensor, "ConstantBias", kind, IMKI_BIAS,
                                  (imki_unit){units[kind], 1}, bias);
    if (status == IMK_OK)
        status = imki_node_accept(p, document, sensor, "NoiseDensity", kind, IMKI_WHITE,
                                  (imki_unit){white[kind], scale.white}, n);
    if (status == IMK_OK)
        status = imki_node_accept(p, document, sensor, "BiasInstability", kind, IMKI_DRIFT,
                                  (imki_unit){units[kind], 1}, b);
    if (status == IMK_OK)
        status = imki_node_accept(p, document, sensor, "RandomWalk", kind, IMKI_RANDOM_WALK,
                                  (imki_unit){walk[kind], scale.random_walk}, k);
    if (b[0] != 0 || b[1] != 0 || b[2] != 0)
        imki_note(p, false,
                  "BiasInstability is taken as B (the Allan floor is 0.664 B); what MATLAB "
                  "simulates depends on BiasInstabilityCoefficients, which are not read");
    imki_to_axes(bias, &triad->bias.fixed);
    imki_to_axes(n, &triad->noise.white);
    imki_to_axes(b, &triad->noise.bias_instability);
    imki_to_axes(k, &triad->noise.random_walk);
    return status;
}

static imk_status read_sensor(imki_parameters *p, const imk_document *document, int sensor,
                              int kind, imk_triad *triad)
{
    triad->present = sensor != IMKI_NONE;
    if (!triad->present)
        return IMK_OK;
    if (document->node[sensor].kind != IMKI_NODE_MAPPING)
        return imki_document_error(document, sensor, IMK_ERROR_SYNTAX, "",
                                   "an object with the properties of the sensor", p->error);
    imk_status status = read_noise(p, document, sensor, kind, triad);
    if (status == IMK_OK)
        status = read_misalignment(p, document, sensor, triad);
    if (status == IMK_OK)
        status = read_temperature(p, document, sensor, kind, triad);
    if (status == IMK_OK)
        status = read_output(p, document, sensor, kind, triad);
    if (status == IMK_OK && kind == IMK_GYRO)
        status = read_acceleration_bias(p, document, sensor, triad);
    for (int key = document->node[sensor].first; key != IMKI_NONE && status == IMK_OK;) {
        size_t i = 0;
        while (i < KEYS && strcmp(document->node[key].text, keys[i]) != 0)
            i++;
        if (i == KEYS)
            status = imki_foreign_key(p, document, key, KEYS, keys);
        key = document->node[document->node[key].next].next;
    }
    return status;
}

static bool is_part(const imk_document *document, int node)
{
    return imki_document_value(document, node, sensor_names[0]) != IMKI_NONE ||
           imki_document_value(document, node, sensor_names[1]) != IMKI_NONE;
}

/* The part of settings->sensor, or the only one; the root itself may be one. */
static imk_status find_part(imki_parameters *p, const imk_document *document, int *part)
{
    const char *wanted = p->settings->sensor;
    char names[96] = "";
    int found = 0;
    *part = 0;
    if (is_part(document, 0))
        return IMK_OK;
    for (int key = document->node[0].first; key != IMKI_NONE;) {
        int value = document->node[key].next;
        const char *name = document->node[key].text;
        if (is_part(document, value)) {
            size_t length = strlen(names);
            snprintf(names + length, sizeof names - length, "%s%.30s", length > 0 ? ", " : "",
                     name);
            if (!wanted || strcmp(wanted, name) == 0) {
                *part = value;
                found++;
            }
        }
        key = document->node[value].next;
    }
    if (found == 1)
        return IMK_OK;
    char expected[140];
    snprintf(expected, sizeof expected,
             names[0] ? "add --sensor NAME with one of %s"
                      : "a part with a Gyroscope or an "
                        "Accelerometer%s",
             names);
    imk_status status = wanted && names[0] ? IMK_ERROR_NAME_UNKNOWN : IMK_ERROR_KEY_MISSING;
    return imk_error_set(p->error, status, "sensor",
                         status == IMK_ERROR_NAME_UNKNOWN ? wanted
                         : names[0] ? "\"sensor\" is missing: the file has several parts"
                                    : "Gyroscope",
                         expected);
}

imk_status imki_matlab_read(imki_parameters *p)
{
    imk_document *document = NULL;
    int part = 0;
    imk_status status = imki_parameters_document(p, &document);
    if (status != IMK_OK)
        return status;
    status = find_part(p, document, &part);
    if (status == IMK_OK && document->node[part].key != IMKI_NONE)
        snprintf(p->model->name, sizeof p->model->name, "%.90s",
                 document->node[document->node[part].key].text);
    if (status == IMK_OK)
        status = read_sensor(p, document, imki_document_value(document, part, sensor_names[0]),
                             IMK_GYRO, &p->model->gyro);
    if (status == IMK_OK)
        status = read_sensor(p, document, imki_document_value(document, part, sensor_names[1]),
                             IMK_ACCEL, &p->model->accel);
    if (status == IMK_OK && imki_document_value(document, part, "Magnetometer") != IMKI_NONE)
        imki_note(p, true, "Magnetometer: a model has none");
    imk_document_free(document);
    return status;
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
    imki_text_add(&p->out, "      \"MeasurementRange\": ");
    if (range > 0)
        imki_text_numbers(&p->out, &range, 1, "");
    else
        imki_text_add(&p->out, "\"Inf\"");
    imki_text_add(&p->out, ",\n      \"Resolution\": ");
    imki_text_numbers(&p->out, &resolution, 1, "");
    imki_text_add(&p->out, ",\n");
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
    imki_note(p, false, "NoiseDensity is %s N, right for NoiseType %s",
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
        imki_text_numbers(&p->out, &percent, 1, "");
        imki_text_add(&p->out, i < 2 ? ", " : "]\n");
    }
    imki_text_add(&p->out, is_last ? "    }\n" : "    },\n");
}

imk_status imki_matlab_write(imki_parameters *p)
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
    if (p->source->gyro.present)
        write_sensor(p, IMK_GYRO, &p->source->gyro, !p->source->accel.present);
    if (p->source->accel.present)
        write_sensor(p, IMK_ACCEL, &p->source->accel, true);
    imki_text_add(&p->out, "  }\n}\n");
    return IMK_OK;
}
