/* SPDX-License-Identifier: Apache-2.0 */
/* MATLAB's imuSensor: the JSON file that loadparams() reads, one object per part with Gyroscope,
 * Accelerometer and Magnetometer objects of gyroparams, accelparams and magparams.
 *
 * imuSensor computes, with fs the sample rate and B = fs/2 for NoiseType double-sided (its default)
 * or fs for single-sided:
 *
 *     reading = (1 + (T - 25) TemperatureScaleFactor/100) (AxesMisalignment/100 v + ConstantBias
 *               + (T - 25) TemperatureBias + AccelerationBias a + noise)
 *     white noise: sigma = NoiseDensity sqrt(B),   random walk: step RandomWalk/sqrt(B)
 *     bias instability: filter(Numerator, Denominator, BiasInstability randn)
 *
 * so that N = NoiseDensity/sqrt(2) and K = sqrt(2) RandomWalk when double-sided, N = NoiseDensity
 * and K = RandomWalk when single-sided: its names are the other way round than one would think.
 *
 * loadparams() takes numbers and "Inf" of a sensor and refuses all else. Objects of a part that are
 * no sensors it leaves aside: there the coefficients of the filter are written. */
#include "matlab_flicker_internal.h"
#include "parameter_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Of IMK_GYRO, IMK_ACCEL and IMK_MAG. */
static const char *const sensor_names[3] = {"Gyroscope", "Accelerometer", "Magnetometer"};
static const imki_unit units[3] = {{"rad/s", 1}, {"m/s^2", 1}, {"uT", 1e-6}};
static const char filter_name[] = "BiasInstabilityFilter";

/* A magnetometer has no limits of its own. */
static imki_quantity quantity_of(int kind, imki_quantity quantity)
{
    return kind == IMK_MAG ? IMKI_PLAIN : quantity;
}

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
enum { KEYS = sizeof keys / sizeof keys[0], SHORTEST_RANGE = 10 };

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
    imki_node_accept(p, sensor, "TemperatureBias", kind, IMKI_PLAIN, units[kind], bias);
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
    imki_node_accept(p, sensor, "Resolution", kind, IMKI_PLAIN, units[kind],
                     triad->resolution.value);
    for (int i = 0; i < 3; i++) {
        if (!(range[i] > 0))
            imki_refuse_node(p, node, IMK_ERROR_RANGE, imki_node_text(p, node), "a positive range");
        triad->range.value[i] = isinf(range[i]) ? 0 : range[i] * units[kind].scale;
    }
}

static void read_noise(imki_parameters *p, int sensor, int kind, imk_triad *triad)
{
    static const char *const white[3] = {"rad/s/sqrt(Hz)", "m/s^2/sqrt(Hz)", "uT/sqrt(Hz)"};
    static const char *const walk[3] = {"rad/s*sqrt(Hz)", "m/s^2*sqrt(Hz)", "uT*sqrt(Hz)"};
    const double unit = units[kind].scale;
    const noise_scale scale = read_noise_type(p, sensor);
    imki_node_accept(p, sensor, "ConstantBias", kind, quantity_of(kind, IMKI_BIAS), units[kind],
                     triad->bias.fixed.value);
    imki_node_accept(p, sensor, "NoiseDensity", kind, quantity_of(kind, IMKI_WHITE),
                     (imki_unit){white[kind], scale.white * unit}, triad->noise.white.value);
    imki_node_accept(p, sensor, "BiasInstability", kind, quantity_of(kind, IMKI_DRIFT), units[kind],
                     triad->noise.bias_instability.value);
    imki_node_accept(p, sensor, "RandomWalk", kind, quantity_of(kind, IMKI_RANDOM_WALK),
                     (imki_unit){walk[kind], scale.random_walk * unit},
                     triad->noise.random_walk.value);
    if (imki_any(triad->noise.bias_instability.value))
        imki_note(p, false,
                  "BiasInstability is taken as B (the Allan floor is 0.664 B); what MATLAB "
                  "simulates depends on BiasInstabilityCoefficients, which are not read");
}

static void read_sensor(imki_parameters *p, int part, int kind)
{
    const int sensor = imki_node_value(p, part, sensor_names[kind]);
    imk_triad *triad = imk_model_triad_to_set(p->model, kind);
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
    bool any = false;
    for (int kind = 0; kind < IMK_KINDS; kind++)
        any = any || imki_node_value(p, node, sensor_names[kind]) != IMKI_NONE;
    return any;
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
                              "a part with a Gyroscope, an Accelerometer or a Magnetometer");
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
    for (int kind = 0; kind < IMK_KINDS; kind++)
        read_sensor(p, part, kind);
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
static void write_output(imki_parameters *p, const imk_triad *triad, double unit)
{
    double range = 0, resolution = 0;
    for (int i = 0; i < 3; i++) {
        double x = triad->range.value[i];
        range = x > 0 && (range == 0 || x < range) ? x : range;
        resolution = fmax(resolution, triad->resolution.value[i]);
    }
    imki_text_add(&p->out, "      \"MeasurementRange\": %s,\n      \"Resolution\": %s,\n",
                  range > 0 ? imki_shortest(range / unit).text : "\"Inf\"",
                  imki_shortest(resolution / unit).text);
}

static void write_response(imki_parameters *p, const imk_triad *triad)
{
    double response[3][3];
    imki_response_of(triad, response);
    imki_text_add(&p->out, "      \"AxesMisalignment\": [");
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            response[i][j] *= 100;
        imki_text_vector(&p->out, response[i]);
        imki_text_add(&p->out, i < 2 ? ", " : "],\n");
    }
}

/* loadparams() takes no text but "Inf", so that NoiseType stays double-sided. */
static void write_noise(imki_parameters *p, const imk_triad *triad, double per_unit)
{
    const bool single = p->settings->density == IMK_DENSITY_TWO_SIDED;
    write_vector(p, "NoiseDensity", triad->noise.white.value, (single ? 1 : sqrt(2.0)) * per_unit);
    write_vector(p, "BiasInstability", triad->noise.bias_instability.value, per_unit);
    write_vector(p, "RandomWalk", triad->noise.random_walk.value,
                 (single ? 1 : sqrt(0.5)) * per_unit);
    imki_note(p, false, "NoiseDensity is written as %s N, for NoiseType %s",
              single ? "the two-sided" : "sqrt(2)",
              single ? "single-sided: set it in MATLAB" : "double-sided, MATLAB's default");
}

static void write_temperature(imki_parameters *p, const imk_triad *triad, double per_unit)
{
    static const double none[3] = {0};
    const imk_temperature_polynomial *bias = &triad->bias.temperature,
                                     *scale = &triad->scale_factor.temperature;
    write_vector(p, "TemperatureBias", bias->order > 0 ? bias->coefficient[0].value : none,
                 per_unit);
    imki_text_add(&p->out, "      \"TemperatureScaleFactor\": [");
    for (int i = 0; i < 3; i++) {
        double percent = scale->order > 0 ? 100 * scale->coefficient[0].value[i] : 0;
        if (percent < 0)
            imki_note(p, true,
                      "TemperatureScaleFactor must not be negative in MATLAB: it will "
                      "refuse the file");
        imki_text_add(&p->out, "%s%s", imki_shortest(percent).text, i < 2 ? ", " : "]\n");
    }
}

static void write_sensor(imki_parameters *p, int kind, const imk_triad *triad)
{
    const double unit = units[kind].scale, per_unit = kind == IMK_MAG ? 1e6 : 1;
    double diagonal[3];
    imki_text_add(&p->out, "    \"%s\": {\n", sensor_names[kind]);
    write_output(p, triad, unit);
    write_vector(p, "ConstantBias", triad->bias.fixed.value, per_unit);
    write_response(p, triad);
    write_noise(p, triad, per_unit);
    for (int i = 0; i < 3; i++)
        diagonal[i] = triad->g_sensitivity.value[i][i];
    if (kind == IMK_GYRO)
        write_vector(p, "AccelerationBias", diagonal, 1);
    write_temperature(p, triad, per_unit);
    imki_text_add(&p->out, "    }");
}

static void write_coefficients(imki_parameters *p, const char *key, const double *values, int count)
{
    imki_text_add(&p->out, "      \"%s\": [", key);
    imki_text_numbers(&p->out, values, count, ", ");
    imki_text_add(&p->out, "]");
}

/* The time up to which the Allan deviation of the filter is the model's [s]; 0: only at few
 * samples. */
static double range_of(const imki_parameters *p, const imk_triad *triad)
{
    const imk_noise *noise = &triad->noise;
    double n = IMKI_MATLAB_FARTHEST;
    for (int i = 0; i < 3; i++)
        if (noise->bias_instability.value[i] > 0) {
            const imk_flicker flicker = {1, noise->bias_instability_correlation_time.value};
            n = fmin(n, imki_matlab_flicker_range(flicker, 1 / p->settings->rate));
        }
    return n < SHORTEST_RANGE ? 0 : n / p->settings->rate;
}

/* The filter of bias instability, if there is one. */
static void write_filter(imki_parameters *p)
{
    const double rate = p->settings->rate;
    double to = (double)INFINITY;
    for (int kind = 0; kind < IMK_KINDS; kind++) {
        const imk_triad *triad = imk_model_triad(p->source, kind);
        if (triad->present && imki_any(triad->noise.bias_instability.value))
            to = rate > 0 ? fmin(to, range_of(p, triad)) : 0;
    }
    if (isinf(to))
        return;
    if (!(rate > 0)) {
        imki_note(p, false,
                  "MATLAB's default BiasInstabilityCoefficients make nearly white noise of "
                  "BiasInstability: add --rate RATE for those of flicker noise");
        return;
    }
    if (to == 0) {
        imki_note(
            p, true,
            "bias_instability_correlation_time is so short that at %g Hz no coefficients make "
            "this noise in MATLAB",
            rate);
        return;
    }
    imki_text_add(&p->out, ",\n    \"%s\": {\n      \"SampleRate\": %s,\n", filter_name,
                  imki_shortest(rate).text);
    write_coefficients(p, "Numerator", imki_matlab_flicker.numerator, IMKI_MATLAB_STAGES);
    imki_text_add(&p->out, ",\n");
    write_coefficients(p, "Denominator", imki_matlab_flicker.denominator, IMKI_MATLAB_STAGES + 1);
    imki_text_add(&p->out, "\n    }");
    imki_note(
        p, false,
        "%s is for BiasInstabilityCoefficients, which loadparams() does not read: with it the "
        "Allan deviation is within %g %% of the model's from %.4g s to %.4g s",
        filter_name, 100 * IMKI_MATLAB_ERROR, 1 / rate, to);
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
    bool any = false;
    for (int kind = 0; kind < IMK_KINDS; kind++) {
        const imk_triad *triad = imk_model_triad(p->source, kind);
        if (!triad->present || triad->axis_count != 3)
            continue;
        imki_text_add(&p->out, any ? ",\n" : "");
        write_sensor(p, kind, triad);
        any = true;
    }
    write_filter(p);
    imki_text_add(&p->out, "\n  }\n}\n");
}
