/* SPDX-License-Identifier: Apache-2.0 */
/* Model files: what the reader takes and refuses, where its errors point, and that writing and
 * reading lose nothing. Converted values are computed here from the definitions of the units:
 * deg = pi/180 rad, h = 3600 s, g = 9.80665 m/s^2. */
#define _POSIX_C_SOURCE 200809L

#include "check.h"

#include "imukit/io.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const double degree = 3.14159265358979323846 / 180;
static const double gravity = 9.80665;

/* A few roundings of conversion. */
static const double rounding = 5e-16;

static const char example[] =
    "imukit: 1                       # format version\n"
    "name: tactical example\n"
    "gyro:\n"
    "  sensitivity: 4778 count/(rad/s)      # counts\n"
    "  bias: {fixed: 0.1 -0.2 0.05 ± 0.01 deg/h, repeatability: 1 deg/h}\n"
    "  scale_factor: {fixed: 0 ppm, repeatability: 150 ppm}\n"
    "  misalignment: 0.2 mrad\n"
    "  g_sensitivity: [0.5 0 0 deg/h/g, 0 0.5 0 deg/h/g, 0 0 0.5 deg/h/g]\n"
    "  noise:\n"
    "    angle_random_walk: 0.0501 ± 0.0003 deg/sqrt(h)   # of the data sheet\n"
    "    bias_instability: 0.3 deg/h\n"
    "    gauss_markov: [{sigma: 0.2 deg/h, correlation_time: 300 s}]\n"
    "  range: 1000 deg/s\n"
    "accel:\n"
    "  bias: {fixed: 0 mg, repeatability: 1 mg}\n"
    "  noise: {density: two-sided, velocity_random_walk: 60 ug/sqrt(Hz), bias_instability: 30 ug}\n"
    "  lever_arm: [0 0 0 mm, 5 0 0 mm, 0 5 0 mm]\n";

static imk_model parsed(const char *text)
{
    imk_model model;
    imk_error error;
    if (imk_model_parse(text, strlen(text), &model, NULL, &error) != IMK_OK) {
        char message[512];
        imk_error_text(&error, NULL, message, sizeof message);
        fail_msg("%s", message);
    }
    return model;
}

static imk_document *opened(const char *text, imk_model *model)
{
    imk_document *document = NULL;
    CHECK_OK(imk_model_parse(text, strlen(text), model, &document, NULL));
    return document;
}

/* Text of a model, to be freed. */
static char *printed(const imk_model *model, const imk_document *document)
{
    char *text = NULL;
    size_t size = 0;
    CHECK_OK(imk_model_print(model, document, &text, &size, NULL));
    assert_int_equal(size, strlen(text));
    return text;
}

/* ---- reading --------------------------------------------------------------------------------- */

static void example_of_the_contract_is_read(void **state)
{
    (void)state;
    imk_model model = parsed(example);
    assert_string_equal(model.name, "tactical example");
    CHECK_CLOSE(model.gyro.sensitivity.value[2], 4778, 0);
    CHECK_RELATIVE(model.gyro.bias.fixed.value[1], -0.2 * degree / 3600, rounding);
    CHECK_RELATIVE(model.gyro.bias.fixed.sigma[2], 0.01 * degree / 3600, rounding);
    CHECK_RELATIVE(model.gyro.scale_factor.repeatability.value[0], 150e-6, rounding);
    CHECK_RELATIVE(model.gyro.misalignment.value[2][1], 0.2e-3, rounding);
    CHECK_CLOSE(model.gyro.misalignment.value[1][1], 0, 0);
    CHECK_RELATIVE(model.gyro.g_sensitivity.value[1][1], 0.5 * degree / 3600 / gravity, rounding);
    CHECK_RELATIVE(model.gyro.noise.white.value[0], 0.0501 * degree / 60, rounding);
    CHECK_RELATIVE(model.gyro.noise.white.sigma[1], 0.0003 * degree / 60, rounding);
    assert_int_equal(model.gyro.noise.gauss_markov_count, 1);
    CHECK_CLOSE(model.gyro.noise.gauss_markov[0].correlation_time.value[2], 300, 0);
    CHECK_RELATIVE(model.gyro.range.value[0], 1000 * degree, rounding);
    CHECK_RELATIVE(model.accel.noise.white.value[0], 60e-6 * gravity, rounding);
    assert_int_equal(model.accel.noise.density, IMK_DENSITY_TWO_SIDED);
    CHECK_RELATIVE(model.accel.lever_arm.value[1][0], 5e-3, rounding);
}

/* 60 ug/sqrt(Hz) one-sided is 60/sqrt(2) two-sided; a unit per sqrt(h) is two-sided always. */
static void one_sided_densities_are_converted(void **state)
{
    (void)state;
    imk_model model = parsed("imukit: 1\naccel: {noise: {velocity_random_walk: 60 ug/sqrt(Hz), "
                             "density: one-sided}}\ngyro: {noise: {density: one-sided, "
                             "angle_random_walk: 0.3 deg/√h}}");
    CHECK_RELATIVE(model.accel.noise.white.value[0], 60e-6 * gravity / sqrt(2), 2 * rounding);
    CHECK_RELATIVE(model.gyro.noise.white.value[0], 0.3 * degree / 60, rounding);
}

/* Densities of the integral: one-sided ones are 1/sqrt(2) of what is stated, those per sqrt(s) are
 * two-sided always, and a unit per sqrt(Hz) needs `density`. Reading noise and quantization are no
 * densities. What is read comes back. */
static void errors_of_readings_are_read(void **state)
{
    (void)state;
    static const char *const texts[] = {
        "imukit: 1\ngyro: {noise: {density: one-sided, angle_white: 0.3 arcsec/sqrt(Hz), "
        "reading_noise: 2 arcsec, quantization: 1 arcsec}}\naccel: {noise: {density: one-sided, "
        "velocity_white: 1 mm/s/sqrt(Hz), reading_noise: 3 mm/s}}",
        "imukit: 1\ngyro: {noise: {density: two-sided, angle_white: 0.3 arcsec/sqrt(Hz), "
        "reading_noise: 2 arcsec, quantization: 1 arcsec}}\naccel: {noise: {density: two-sided, "
        "velocity_white: 1 mm/s/sqrt(Hz), reading_noise: 3 mm/s}}",
        "imukit: 1\ngyro: {noise: {angle_white: 0.3 arcsec*sqrt(s), reading_noise: 2 arcsec, "
        "quantization: 1 arcsec}}\naccel: {noise: {velocity_white: 1 mm/s*sqrt(s), "
        "reading_noise: 3 mm/s}}"};
    for (int i = 0; i < 3; i++) {
        const imk_model model = parsed(texts[i]);
        const double sided = i == 0 ? 1 / sqrt(2) : 1;
        CHECK_RELATIVE(model.gyro.noise.angle_white.value[1], sided * 0.3 * degree / 3600,
                       2 * rounding);
        CHECK_RELATIVE(model.gyro.noise.reading_noise.value[1], 2 * degree / 3600, rounding);
        CHECK_RELATIVE(model.gyro.noise.quantization.value[1], degree / 3600, rounding);
        CHECK_RELATIVE(model.accel.noise.angle_white.value[2], sided * 1e-3, 2 * rounding);
        CHECK_RELATIVE(model.accel.noise.reading_noise.value[2], 3e-3, rounding);
        char *text = printed(&model, NULL);
        const imk_model back = parsed(text);
        assert_true(imk_model_equal(&model, &back));
        free(text);
    }
    imk_model model;
    imk_error error;
    const char *unstated = "imukit: 1\naccel: {noise: {velocity_white: 1 mm/s/sqrt(Hz)}}";
    assert_int_not_equal(imk_model_parse(unstated, strlen(unstated), &model, NULL, &error), IMK_OK);
    assert_string_equal(error.field, "accel.noise.velocity_white");
}

static void allan_floor_is_the_other_name(void **state)
{
    (void)state;
    imk_model model = parsed("imukit: 1\ngyro: {noise: {allan_floor: 2 ± 0.1 deg/h}}");
    double floor = sqrt(2 * log(2) / 3.14159265358979323846);
    CHECK_RELATIVE(model.gyro.noise.bias_instability.value[1] * floor, 2 * degree / 3600,
                   2 * rounding);
    CHECK_RELATIVE(model.gyro.noise.bias_instability.sigma[1] * floor, 0.1 * degree / 3600,
                   2 * rounding);
}

static void matrices_have_three_forms(void **state)
{
    (void)state;
    imk_model model =
        parsed("imukit: 1\ngyro:\n  misalignment: 1 2 3 4 5 6 mrad\n"
               "  cross_axis:\n    - 0 1 2 %\n    - 3 0 4 %\n    - 5 6 0 ± 0 1 0 %\n");
    CHECK_RELATIVE(model.gyro.misalignment.value[0][1], 1e-3, rounding);
    CHECK_RELATIVE(model.gyro.misalignment.value[1][0], 3e-3, rounding);
    CHECK_RELATIVE(model.gyro.misalignment.value[1][2], 4e-3, rounding);
    CHECK_RELATIVE(model.gyro.misalignment.value[2][1], 6e-3, rounding);
    CHECK_RELATIVE(model.gyro.cross_axis.value[2][0], 0.05, rounding);
    CHECK_RELATIVE(model.gyro.cross_axis.sigma[2][1], 0.01, rounding);
}

static void temperature_is_read(void **state)
{
    (void)state;
    imk_model model = parsed(
        "imukit: 1\naccel:\n  bias:\n    temperature:\n      reference_temperature: 25 degC\n"
        "      valid_range: -40 85 degC\n      coefficients: [20 30 40 ug/K, 0.1 ug/degC^2]\n"
        "    temperature_rate: 6 ug/(degC/min)\n    warm_up: {amplitude: 1 mg, time: 5 min}\n");
    const imk_temperature_polynomial *polynomial = &model.accel.bias.temperature;
    assert_int_equal(polynomial->order, 2);
    CHECK_RELATIVE(polynomial->reference, 298.15, rounding);
    CHECK_RELATIVE(polynomial->minimum, 233.15, rounding);
    CHECK_RELATIVE(polynomial->coefficient[0].value[2], 40e-6 * gravity, rounding);
    CHECK_RELATIVE(polynomial->coefficient[1].value[1], 0.1e-6 * gravity, rounding);
    CHECK_RELATIVE(model.accel.bias.temperature_rate.value[0], 6e-6 * gravity * 60, rounding);
    CHECK_CLOSE(model.accel.bias.warm_up_time.value, 300, 0);
}

static void redundant_axes_have_directions(void **state)
{
    (void)state;
    imk_model model = parsed("imukit: 1\ngyro:\n  range: 1 2 3 4 deg/s\n"
                             "  direction: [1 0 0, 0 1 0, 0 0 1, 1 1 1]\n");
    assert_int_equal(model.gyro.axis_count, 4);
    CHECK_RELATIVE(model.gyro.direction[3][2], 1 / sqrt(3), rounding);
    CHECK_RELATIVE(model.gyro.range.value[3], 4 * degree, rounding);
    assert_false(model.accel.present);
}

static void pendulous_axes_are_directions(void **state)
{
    (void)state;
    imk_model model = parsed("imukit: 1\naccel:\n  pendulous_axis: [0 3 4, 0 0 0, 1 0 0]\n");
    const double(*p)[3] = (const double(*)[3])model.accel.nonlinearity.pendulous_axis;
    CHECK_CLOSE(p[0][1], 0.6, 1e-16);
    CHECK_CLOSE(p[0][2], 0.8, 1e-16);
    CHECK_CLOSE(p[1][0] + p[1][1] + p[1][2], 0, 0);
    CHECK_CLOSE(p[2][0], 1, 0);
}

static void evidence_is_read(void **state)
{
    (void)state;
    imk_model model = parsed(
        "imukit: 1\ngyro:\n  noise: {density: one-sided, gauss_markov: [{sigma: 1 deg/h, "
        "correlation_time: 10 s}]}\n  evidence:\n    source: \"a log: 3 h\"\n    method: spectrum\n"
        "    interval_95:\n      noise.angle_random_walk: [1 deg/s/sqrt(Hz), 2 3 4 "
        "deg/s/sqrt(Hz)]\n"
        "      noise.gauss_markov[0].sigma: [0.5 deg/h, 2 deg/h]\n"
        "    upper_bound: {noise.rate_random_walk: 1 deg/h/sqrt(h)}\n");
    const imk_evidence *evidence = &model.gyro_evidence;
    assert_string_equal(evidence->source, "a log: 3 h");
    assert_int_equal(evidence->interval_count, 3);
    CHECK_RELATIVE(evidence->interval[0].upper.value[2], 4 * degree / sqrt(2), 2 * rounding);
    assert_string_equal(evidence->interval[1].key, "noise.gauss_markov.sigma");
    CHECK_CLOSE(evidence->interval[2].lower.value[0], 0, 0);
}

static void json_is_the_same_tree(void **state)
{
    (void)state;
    imk_model model =
        parsed("{\n\t\"imukit\":1, \"name\":\"caf\\u00e9 \\\"x\\\" \\/\",\n\t\"gyro\": {\"range\": "
               "\"300 deg/s\", \"bandwidth\": \"50 Hz\", \"damping\": 0.7}\n}\n");
    assert_string_equal(model.name, "café \"x\" /");
    CHECK_CLOSE(model.gyro.damping.value[1], 0.7, 0);
    imk_error error;
    const char surrogates[] = "{\"imukit\": 1, \"name\": \"\\ud83d\\ude00\", \"gyro\": {}}";
    CHECK_STATUS(imk_model_parse(surrogates, sizeof surrogates - 1, &model, NULL, &error),
                 IMK_ERROR_SYNTAX);
}

static void byte_order_mark_and_crlf_are_read(void **state)
{
    (void)state;
    imk_model model = parsed("\xEF\xBB\xBFimukit: 1\r\ngyro:\r\n  range: 2 deg/s\r\n");
    CHECK_RELATIVE(model.gyro.range.value[0], 2 * degree, rounding);
}

/* ---- refusals -------------------------------------------------------------------------------- */

typedef struct refusal {
    const char *text; /* below imukit: 1, so its first line is line 2 */
    imk_status status;
    size_t line, column;
    const char *field;
    const char *says; /* part of error.expected */
} refusal;

static const refusal refusals[] = {
    {"gyro: {noise: {angle_random_walk: 0.1 deg/h}}", IMK_ERROR_DIMENSION, 2, 35,
     "gyro.noise.angle_random_walk", "deg/sqrt(h)"},
    {"gyro: {noise: {angle_random_walk: 0.1}}", IMK_ERROR_UNIT_MISSING, 2, 35,
     "gyro.noise.angle_random_walk", "deg/sqrt(h)"},
    {"gyro: {bias: {fixed: 0}}", IMK_ERROR_UNIT_MISSING, 2, 22, "gyro.bias.fixed", "deg/h"},
    {"gyro: {scale_factor: {fixed: 0.001}}", IMK_ERROR_UNIT_MISSING, 2, 30,
     "gyro.scale_factor.fixed", "ppm"},
    {"gyro: {range: 1 furlong/s}", IMK_ERROR_UNIT_UNKNOWN, 2, 15, "gyro.range", ""},
    {"gyro: {noise: {angle_random_walk: 0.1 deg/s/sqrt(Hz)}}", IMK_ERROR_KEY_MISSING, 2, 35,
     "gyro.noise.angle_random_walk", "one-sided"},
    {"gyro: {noise: {density: both}}", IMK_ERROR_SYNTAX, 2, 25, "gyro.noise.density", "two-sided"},
    {"gyro:\n  nois: {}", IMK_ERROR_KEY_UNKNOWN, 3, 3, "gyro.nois", "did you mean \"noise\"?"},
    {"gyro: {noise: {gauss_markov: [{sigma: 1 deg/h, correlation_tim: 1 s}]}}",
     IMK_ERROR_KEY_UNKNOWN, 2, 48, "gyro.noise.gauss_markov[0].correlation_tim",
     "did you mean \"correlation_time\"?"},
    {"acel: {}", IMK_ERROR_KEY_UNKNOWN, 2, 1, "acel", "did you mean \"accel\"?"},
    {"accel: {noise: {angle_random_walk: 1 deg/sqrt(h)}}", IMK_ERROR_KEY_UNKNOWN, 2, 17,
     "accel.noise.angle_random_walk", "velocity_random_walk"},
    {"accel: {noise: {rate_ramp: 1 deg/h/h}}", IMK_ERROR_KEY_UNKNOWN, 2, 17,
     "accel.noise.rate_ramp", "acceleration_ramp"},
    {"gyro: {lever_arm: [0 0 0 mm]}", IMK_ERROR_KEY_UNKNOWN, 2, 8, "gyro.lever_arm", "only accel"},
    {"gyro: {range: 1 deg/s, range: 2 deg/s}", IMK_ERROR_KEY_DUPLICATE, 2, 24, "gyro.range",
     "line 2"},
    {"gyro: &x {}", IMK_ERROR_UNSUPPORTED, 2, 7, "", "anchors"},
    {"gyro: {}\naccel: *x", IMK_ERROR_UNSUPPORTED, 3, 8, "", "aliases"},
    {"gyro: {range: !!str 1 deg/s}", IMK_ERROR_UNSUPPORTED, 2, 15, "", "tag"},
    {"gyro: {}\n---\nimukit: 1", IMK_ERROR_UNSUPPORTED, 3, 1, "", "one model"},
    {"gyro: {noise: {gauss_markov: [{sigma: 1 deg/h, correlation_time: .inf}]}}",
     IMK_ERROR_NOT_FINITE, 2, 66, "gyro.noise.gauss_markov[0].correlation_time",
     "rate_random_walk"},
    {"gyro: {noise: {gauss_markov: [{sigma: 1 deg/h}]}}", IMK_ERROR_KEY_MISSING, 2, 31,
     "gyro.noise.gauss_markov[0]", "correlation_time"},
    {"gyro: {noise: {gauss_markov: {sigma: 1 deg/h, correlation_time: 1 s}}}", IMK_ERROR_SYNTAX, 2,
     30, "gyro.noise.gauss_markov", "list"},
    {"gyro: {noise: {bias_instability: 1 deg/h, allan_floor: 1 deg/h}}", IMK_ERROR_CONFLICT, 2, 56,
     "gyro.noise.allan_floor", "0.664"},
    {"gyro: {bias: {fixed: 1 2 deg/h}}", IMK_ERROR_SYNTAX, 2, 22, "gyro.bias.fixed", "one number"},
    {"gyro: {bias: 1 deg/h}", IMK_ERROR_SYNTAX, 2, 14, "gyro.bias", "mapping"},
    {"gyro: {bias: {fixed: [1 deg/h]}}", IMK_ERROR_SYNTAX, 2, 22, "gyro.bias.fixed", "numbers"},
    {"gyro:", IMK_ERROR_SYNTAX, 2, 6, "gyro", "mapping"},
    {"gyro: {g_sensitivity: 1 deg/h/g}", IMK_ERROR_SYNTAX, 2, 23, "gyro.g_sensitivity", "rows"},
    {"gyro: {g_sensitivity: [1 2 3 deg/h/g, 1 2 deg/h/g, 1 2 3 deg/h/g]}", IMK_ERROR_SYNTAX, 2, 39,
     "gyro.g_sensitivity[1]", "three numbers"},
    {"gyro: {misalignment: 1 2 mrad}", IMK_ERROR_SYNTAX, 2, 22, "gyro.misalignment", "six"},
    {"gyro: {direction: [0 0 0]}", IMK_ERROR_SYNTAX, 2, 20, "gyro.direction[0]", "x y z"},
    {"accel: {pendulous_axis: [0 0 1]}", IMK_ERROR_SYNTAX, 2, 25, "accel.pendulous_axis",
     "row x y z for each axis"},
    {"accel: {pendulous_axis: [1 0 0, 0 0 0, 0 0 0]}", IMK_ERROR_RANGE, 2, 25,
     "accel.pendulous_axis", "right angles"},
    {"gyro: {range: -3 deg/s}", IMK_ERROR_RANGE, 2, 15, "gyro.range", "negative"},
    {"gyro: {noise: {resonance: [{sigma: 1 deg/h, frequency: 5 Hz, q: 0.3}]}}", IMK_ERROR_RANGE, 2,
     65, "gyro.noise.resonance[0].q", "limit"},
    {"gyro: {damping: 0.7}", IMK_ERROR_CONFLICT, 2, 17, "gyro.damping", "bandwidth"},
    {"gyro: {bias: {temperature: {coefficients: [1 deg/h/K]}}}", IMK_ERROR_KEY_MISSING, 2, 28,
     "gyro.bias.temperature", "reference_temperature"},
    {"gyro: {bias: {temperature: {reference_temperature: 1 degC, valid_range: 5 1 degC, "
     "coefficients: [1 deg/h/K]}}}",
     IMK_ERROR_RANGE, 2, 28, "gyro.bias.temperature", "valid_range"},
    {"gyro: {evidence: {interval_95: {noise.bias: [1 deg/h, 2 deg/h]}}}", IMK_ERROR_KEY_UNKNOWN, 2,
     33, "gyro.evidence.interval_95.noise.bias", "noise.bias_instability"},
    {"gyro: {evidence: {interval_95: {noise.bias_instability: [2 deg/h, 1 deg/h]}}}",
     IMK_ERROR_RANGE, 2, 32, "gyro.evidence.interval_95.noise.bias_instability", "lower end"},
    {"timing: {jiter: 1 us}\ngyro: {}", IMK_ERROR_KEY_UNKNOWN, 2, 10, "timing.jiter",
     "did you mean \"jitter\"?"},
    {"gyro: {range: 1 deg/s", IMK_ERROR_SYNTAX, 3, 1, "", ""},
    {"gyro:\n\trange: 1 deg/s", IMK_ERROR_SYNTAX, 3, 1, "", "tabs"},
    {"? {a: b}\n: c", IMK_ERROR_SYNTAX, 2, 3, "", "key"},
    {"name: x", IMK_ERROR_KEY_MISSING, 1, 1, "gyro", "accel"},
    /* The correlation: its keys, names, rows and numbers. */
    {"accel: {}\ncorrelation: 1", IMK_ERROR_SYNTAX, 3, 14, "correlation", "parameters and values"},
    {"accel: {}\ncorrelation: {parameters: [accel.bias.fixed.x]}", IMK_ERROR_KEY_MISSING, 3, 14,
     "correlation", "values"},
    {"accel: {}\ncorrelation: {parameter: []}", IMK_ERROR_KEY_UNKNOWN, 3, 15,
     "correlation.parameter", "did you mean \"parameters\""},
    {"accel: {}\ncorrelation: {parameters: [accel.bias.x], values: []}", IMK_ERROR_KEY_UNKNOWN, 3,
     28, "correlation.parameters[0]", "like accel.bias.fixed.x"},
    {"accel: {}\ncorrelation:\n  parameters: [accel.bias.fixed.x, accel.bias.fixed.y]\n"
     "  values: [0.1 0.2]",
     IMK_ERROR_SYNTAX, 5, 12, "correlation.values[0]", "a row of 1 number"},
    {"accel: {}\ncorrelation:\n  parameters: [accel.bias.fixed.x, accel.bias.fixed.y]\n"
     "  values: []",
     IMK_ERROR_SYNTAX, 5, 11, "correlation.values", "a row for each parameter but the first"},
    {"accel: {}\ncorrelation:\n  parameters: [accel.bias.fixed.x, accel.bias.fixed.y]\n"
     "  values: [1.5]",
     IMK_ERROR_RANGE, 5, 11, "correlation.values", "from -1 to 1"},
    {"accel: {}\ncorrelation:\n  parameters: [accel.bias.fixed.x, accel.misalignment.y.y]\n"
     "  values: [0.5]",
     IMK_ERROR_KEY_UNKNOWN, 4, 15, "correlation.parameters", "a number of the model"},
};

static void errors_point_to_their_place(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof refusals / sizeof refusals[0]; i++) {
        const refusal *r = &refusals[i];
        char text[512];
        imk_error error;
        imk_model model, before;
        imk_model_default(&model);
        imk_model_default(&before);
        snprintf(text, sizeof text, "imukit: 1\n%s\n", r->text);
        imk_status status = imk_model_parse(text, strlen(text), &model, NULL, &error);
        if (status != r->status || error.status != status || error.line != r->line ||
            error.column != r->column || strcmp(error.field, r->field) != 0 ||
            !strstr(error.expected, r->says))
            fail_msg("%s\n  %s %zu:%zu %s; %s; %s", r->text, imk_status_name(status), error.line,
                     error.column, error.field, error.found, error.expected);
        assert_memory_equal(&model, &before, sizeof model);
    }
}

static imk_status status_of(const char *text, size_t size)
{
    imk_model model;
    imk_error error;
    return imk_model_parse(text, size, &model, NULL, &error);
}

static void what_is_no_model_file_is_refused(void **state)
{
    (void)state;
    CHECK_STATUS(status_of("", 0), IMK_ERROR_EMPTY);
    CHECK_STATUS(status_of("# nothing\n", 10), IMK_ERROR_EMPTY);
    CHECK_STATUS(status_of("time,x\n1,2\n", 11), IMK_ERROR_FORMAT);
    CHECK_STATUS(status_of("- a\n", 4), IMK_ERROR_FORMAT);
    CHECK_STATUS(status_of("gyro: {}\n", 9), IMK_ERROR_KEY_MISSING);
    CHECK_STATUS(status_of("imukit: 2\ngyro: {}\n", 19), IMK_ERROR_VERSION);
    CHECK_STATUS(status_of("\x1f\x8b\x08\0\0\0", 6), IMK_ERROR_SYNTAX);
    CHECK_STATUS(status_of("imukit: \xff\xfe", 10), IMK_ERROR_SYNTAX);
    CHECK_STATUS(status_of("imukit: 1\nname: \"a\\0b\"\ngyro: {}", 31), IMK_ERROR_SYNTAX);
    char *brackets = malloc(2000000);
    assert_non_null(brackets);
    memset(brackets, '[', 2000000);
    CHECK_STATUS(status_of(brackets, 2000000), IMK_ERROR_UNSUPPORTED);
    CHECK_STATUS(status_of(brackets, 1000), IMK_ERROR_UNSUPPORTED);
    free(brackets);
}

static void too_long_a_text_is_refused(void **state)
{
    (void)state;
    char text[256] = "imukit: 1\ngyro: {}\nname: ";
    size_t start = strlen(text);
    memset(text + start, 'n', 95);
    CHECK_OK(status_of(text, start + 95));
    memset(text + start, 'n', 96);
    CHECK_STATUS(status_of(text, start + 96), IMK_ERROR_RANGE);
}

/* ---- writing with the document --------------------------------------------------------------- */

static void unchanged_model_keeps_every_byte(void **state)
{
    (void)state;
    imk_model model;
    imk_document *document = opened(example, &model);
    char *text = printed(&model, document);
    assert_string_equal(text, example);
    free(text);
    imk_document_free(document);
}

/* Replaces one line of the example. */
static char *with_line(const char *old_line, const char *new_line)
{
    const char *at = strstr(example, old_line);
    assert_non_null(at);
    char *text = malloc(sizeof example + strlen(new_line));
    assert_non_null(text);
    size_t before = (size_t)(at - example);
    memcpy(text, example, before);
    strcpy(text + before, new_line);
    strcat(text, at + strlen(old_line));
    return text;
}

/* A change of the example's model that should change one line. */
#define CHANGES_LINE(change, old_line, new_line)                                                   \
    do {                                                                                           \
        imk_model model;                                                                           \
        imk_document *document = opened(example, &model);                                          \
        change;                                                                                    \
        char *text = printed(&model, document), *due = with_line(old_line, new_line);              \
        assert_string_equal(text, due);                                                            \
        free(text);                                                                                \
        free(due);                                                                                 \
        imk_document_free(document);                                                               \
    } while (0)

static void changed_field_changes_its_text_only(void **state)
{
    (void)state;
    CHANGES_LINE(
        model.gyro.noise.white.value[1] *= 2,
        "    angle_random_walk: 0.0501 ± 0.0003 deg/sqrt(h)   # of the data sheet\n",
        "    angle_random_walk: 0.0501 0.1002 0.0501 ± 0.0003 deg/sqrt(h)   # of the data sheet\n");
    CHANGES_LINE(model.accel.lever_arm.value[2][1] *= 2, "0 5 0 mm]", "0 10 0 mm]");
    CHANGES_LINE(strcpy(model.name, "another: one"), "name: tactical example\n",
                 "name: \"another: one\"\n");
}

static void new_field_is_put_in_its_place(void **state)
{
    (void)state;
    CHANGES_LINE(model.gyro.noise.random_walk.value[0] = model.gyro.noise.random_walk.value[1] =
                     model.gyro.noise.random_walk.value[2] = degree / 3600 / 60,
                 "    bias_instability: 0.3 deg/h\n",
                 "    bias_instability: 0.3 deg/h\n    rate_random_walk: 1 deg/h/sqrt(h)\n");
    CHANGES_LINE(strcpy(model.description, "text"), "name: tactical example\n",
                 "name: tactical example\ndescription: text\n");
    CHANGES_LINE(model.accel.bias.warm_up_time.value = 60, "repeatability: 1 mg}",
                 "repeatability: 1 mg, warm_up: {time: 60 s}}");
    CHANGES_LINE(model.timing.jitter.value = 1e-6, "  lever_arm: [0 0 0 mm, 5 0 0 mm, 0 5 0 mm]\n",
                 "  lever_arm: [0 0 0 mm, 5 0 0 mm, 0 5 0 mm]\ntiming:\n  jitter: 1 us\n");
}

static void removed_term_is_removed(void **state)
{
    (void)state;
    CHANGES_LINE(memset(&model.gyro.noise.bias_instability, 0, sizeof(imk_axes)),
                 "    bias_instability: 0.3 deg/h\n", "");
    CHANGES_LINE(model.gyro.noise.gauss_markov_count = 0,
                 "    gauss_markov: [{sigma: 0.2 deg/h, correlation_time: 300 s}]\n", "");
    CHANGES_LINE(memset(&model.accel.noise.bias_instability, 0, sizeof(imk_axes)),
                 ", bias_instability: 30 ug", "");
    CHANGES_LINE(memset(&model.accel.noise.white, 0, sizeof(imk_axes)),
                 "velocity_random_walk: 60 ug/sqrt(Hz), ", "");
}

/* A density changed from two- to one-sided leaves N as it is: the number must change. */
static void changed_density_keeps_the_model(void **state)
{
    (void)state;
    imk_model model, back;
    imk_document *document = opened(example, &model);
    model.accel.noise.density = IMK_DENSITY_ONE_SIDED;
    char *text = printed(&model, document);
    back = parsed(text);
    assert_true(imk_model_equal(&model, &back));
    assert_int_equal(back.accel.noise.density, IMK_DENSITY_ONE_SIDED);
    assert_non_null(strstr(text, "density: one-sided, velocity_random_walk: "));
    assert_null(strstr(text, "velocity_random_walk: 60 ug"));
    free(text);
    imk_document_free(document);
}

/* The floor's text cannot say every B: a changed one is written as bias_instability. */
static void changed_floor_becomes_an_instability(void **state)
{
    (void)state;
    imk_model model;
    imk_document *document = opened("imukit: 1\ngyro:\n  noise:\n    allan_floor: 2 deg/h # floor\n"
                                    "    rate_ramp: 1 deg/h/h\n",
                                    &model);
    char *same = printed(&model, document);
    assert_non_null(strstr(same, "allan_floor: 2 deg/h # floor"));
    for (int i = 0; i < 3; i++)
        model.gyro.noise.bias_instability.value[i] = 3 * (degree / 3600);
    char *text = printed(&model, document);
    assert_string_equal(text, "imukit: 1\ngyro:\n  noise:\n    bias_instability: 3 deg/h\n"
                              "    rate_ramp: 1 deg/h/h\n");
    free(same);
    free(text);
    imk_document_free(document);
}

static void json_document_stays_json(void **state)
{
    (void)state;
    imk_model model;
    imk_document *document =
        opened("{\"imukit\": 1, \"gyro\": {\"range\": \"300 deg/s\"}}\n", &model);
    for (int i = 0; i < 3; i++) {
        model.gyro.bandwidth.value[i] = 50;
        model.gyro.damping.value[i] = 0.7;
        model.gyro.range.value[i] *= 2;
    }
    char *text = printed(&model, document);
    assert_string_equal(text, "{\"imukit\": 1, \"gyro\": {\"bandwidth\": \"50 Hz\", \"damping\": "
                              "0.7, \"range\": \"600 deg/s\"}}\n");
    free(text);
    imk_document_free(document);
}

/* ---- writing without a document -------------------------------------------------------------- */

static void canonical_text_is_readable(void **state)
{
    (void)state;
    imk_model model = parsed(example);
    char *text = printed(&model, NULL);
    assert_string_equal(text, "imukit: 1\n"
                              "name: tactical example\n"
                              "gyro:\n"
                              "  sensitivity: 4778 count/(rad/s)\n"
                              "  bias:\n"
                              "    fixed: 0.1 -0.2 0.05 ± 0.01 deg/h\n"
                              "    repeatability: 1 deg/h\n"
                              "  scale_factor:\n"
                              "    fixed: 0 ppm\n"
                              "    repeatability: 150 ppm\n"
                              "  misalignment: 0.2 mrad\n"
                              "  g_sensitivity: [0.5 0 0 deg/h/g, 0 0.5 0 deg/h/g, 0 0 0.5 "
                              "deg/h/g]\n"
                              "  noise:\n"
                              "    angle_random_walk: 0.0501 ± 0.0003 deg/sqrt(h)\n"
                              "    bias_instability: 0.3 deg/h\n"
                              "    gauss_markov:\n"
                              "      - {sigma: 0.2 deg/h, correlation_time: 300 s}\n"
                              "  range: 1000 deg/s\n"
                              "accel:\n"
                              "  bias:\n"
                              "    fixed: 0 mg\n"
                              "    repeatability: 1 mg\n"
                              "  lever_arm: [0 0 0 mm, 5 0 0 mm, 0 5 0 mm]\n"
                              "  noise:\n"
                              "    density: two-sided\n"
                              "    velocity_random_walk: 60 ug/sqrt(Hz)\n"
                              "    bias_instability: 30 ug\n");
    free(text);
}

/* A zero that is stated is not the same as nothing: it is read, written anew, added to a file and
 * kept by a model that is copied. */
static void stated_zeros_are_kept(void **state)
{
    (void)state;
    static const char text[] = "imukit: 1\n"
                               "gyro:\n"
                               "  bias:\n"
                               "    repeatability: 0 deg/h\n"
                               "  misalignment: 0 mrad\n"
                               "accel: {}\n";
    imk_model model = parsed(text), bare = parsed("imukit: 1\ngyro: {}\naccel: {}\n");
    assert_true(imk_model_states(&model, IMK_GYRO, "bias.repeatability"));
    assert_true(imk_model_states(&model, IMK_GYRO, "misalignment"));
    assert_false(imk_model_states(&model, IMK_GYRO, "bias.fixed"));
    assert_false(imk_model_states(&model, IMK_ACCEL, "misalignment"));
    assert_false(imk_model_states(&bare, IMK_GYRO, "misalignment"));
    assert_true(imk_model_equal(&model, &bare));
    char *written = printed(&model, NULL);
    assert_string_equal(written, text);
    free(written);
    imk_document *document = opened("imukit: 1\ngyro:\n  range: 1 deg/s # so\n", &bare);
    CHECK_OK(imk_model_state_zero(&bare, IMK_GYRO, "bias.repeatability", NULL));
    written = printed(&bare, document);
    assert_string_equal(written, "imukit: 1\ngyro:\n  bias:\n    repeatability: 0 deg/h\n"
                                 "  range: 1 deg/s # so\n");
    free(written);
    imk_document_free(document);
    imk_model floor = parsed("imukit: 1\ngyro: {noise: {allan_floor: 0 deg/h}}\n");
    assert_true(imk_model_states(&floor, IMK_GYRO, "noise.bias_instability"));
}

static void perfect_unit_is_short(void **state)
{
    (void)state;
    imk_model model;
    imk_model_default(&model);
    char *text = printed(&model, NULL);
    assert_string_equal(text, "imukit: 1\ngyro: {}\naccel: {}\n");
    free(text);
    model.accel.present = false;
    text = printed(&model, NULL);
    assert_string_equal(text, "imukit: 1\ngyro: {}\n");
    free(text);
}

static void invalid_model_is_not_written(void **state)
{
    (void)state;
    imk_model model;
    imk_model_default(&model);
    imk_error error;
    char *text = NULL;
    size_t size = 0;
    model.gyro.range.value[0] = (double)NAN;
    CHECK_STATUS(imk_model_print(&model, NULL, &text, &size, &error), IMK_ERROR_NOT_FINITE);
    imk_model_default(&model);
    strcpy(model.name, "\xC3(");
    CHECK_STATUS(imk_model_print(&model, NULL, &text, &size, &error), IMK_ERROR_ARGUMENT);
    assert_string_equal(error.field, "name");
    assert_null(text);
}

static void strange_texts_survive(void **state)
{
    (void)state;
    static const char *const texts[] = {"yes",
                                        "1",
                                        "a: b",
                                        "a #b",
                                        " a",
                                        "a ",
                                        "\"q\"",
                                        "\\",
                                        "tab\there",
                                        "l1\nl2",
                                        "é",
                                        "😀",
                                        "\x7F",
                                        "\xC2\x85",
                                        "\xE2\x80\xA8",
                                        "'",
                                        "-",
                                        "null",
                                        "[x], {",
                                        "\xEF\xBB\xBF",
                                        "\xEF\xBF\xBF",
                                        "%",
                                        "@",
                                        "Off"};
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        imk_model model;
        imk_model_default(&model);
        strcpy(model.name, texts[i]);
        char *text = printed(&model, NULL), *json = NULL;
        size_t size;
        assert_string_equal(parsed(text).name, texts[i]);
        CHECK_OK(imk_model_print_json(&model, NULL, &json, &size, NULL));
        assert_string_equal(parsed(json).name, texts[i]);
        free(text);
        free(json);
    }
}

/* ---- files and names ------------------------------------------------------------------------- */

static void files_are_written_and_read(void **state)
{
    (void)state;
    static const char *const names[] = {"model.yaml", "model.json"};
    char directory[] = "/tmp/imukit-model-XXXXXX", path[96];
    assert_non_null(mkdtemp(directory));
    imk_model model, back;
    imk_document *document = opened(example, &model);
    for (int i = 0; i < 2; i++) {
        imk_document *read_document = NULL;
        snprintf(path, sizeof path, "%s/%s", directory, names[i]);
        CHECK_OK(imk_model_write(path, &model, document, NULL));
        CHECK_OK(imk_model_open(path, &back, &read_document, NULL));
        assert_true(imk_model_equal(&model, &back));
        char *text = printed(&back, read_document);
        assert_true(i == 0 ? strcmp(text, example) == 0 : text[0] == '{');
        free(text);
        imk_document_free(read_document);
        assert_int_equal(unlink(path), 0);
    }
    imk_error error;
    CHECK_STATUS(imk_model_open(path, &back, NULL, &error), IMK_ERROR_OPEN);
    CHECK_STATUS(imk_model_open(directory, &back, NULL, &error), IMK_ERROR_OPEN);
    imk_document_free(document);
    assert_int_equal(rmdir(directory), 0);
}

static void catalogue_names_are_models(void **state)
{
    (void)state;
    imk_model model;
    imk_error error;
    imk_document *document = NULL;
    CHECK_OK(imk_model_open("adis16465", &model, &document, &error));
    assert_string_equal(model.name, "ADIS16465");
    assert_null(document);
    CHECK_STATUS(imk_model_open("ADIS16645", &model, NULL, &error), IMK_ERROR_NAME_UNKNOWN);
    assert_non_null(strstr(error.expected, "ADIS16465"));
    CHECK_STATUS(imk_model_open("?", &model, NULL, &error), IMK_ERROR_NAME_UNKNOWN);
    CHECK_STATUS(imk_model_open("none.yaml", &model, NULL, &error), IMK_ERROR_OPEN);
}

/* Every entry of the catalogue says the same after writing and reading. */
static void catalogue_survives(void **state)
{
    (void)state;
    for (size_t i = 0; i < imk_device_count(); i++) {
        imk_model model, back;
        imk_device_model(imk_device_get(i), &model);
        char *text = printed(&model, NULL);
        back = parsed(text);
        assert_true(imk_model_equal(&model, &back));
        free(text);
    }
}

/* The examples of the manual are models, and its last one has every key that the reader knows: it
 * is also the fuzzer's first input. */
static void examples_of_the_manual_are_models(void **state)
{
    (void)state;
    enum { CAPACITY = 100000 };
    char *manual = malloc(CAPACITY);
    FILE *file = fopen(SOURCE_DIRECTORY "/docs/model-file.md", "rb");
    assert_non_null(manual);
    assert_non_null(file);
    size_t size = fread(manual, 1, CAPACITY - 1, file);
    fclose(file);
    manual[size] = '\0';
    int count = 0;
    imk_model model;
    imk_model_default(&model);
    for (char *at = strstr(manual, "```yaml\nimukit: 1"); at;
         at = strstr(at, "```yaml\nimukit: 1"), count++) {
        char *begin = strchr(at, '\n') + 1, *end = strstr(begin, "```");
        assert_non_null(end);
        *end = '\0';
        model = parsed(begin);
        at = end + 1;
    }
    assert_int_equal(count, 4);
    assert_int_equal(model.gyro.noise.resonance_count, 1);
    assert_int_equal(model.gyro_evidence.interval_count, 3);
    assert_int_equal(model.correlation.count, 3);
    CHECK_RELATIVE(model.timing.drops.value, 0.001, rounding);
    free(manual);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(example_of_the_contract_is_read),
        cmocka_unit_test(one_sided_densities_are_converted),
        cmocka_unit_test(errors_of_readings_are_read),
        cmocka_unit_test(allan_floor_is_the_other_name),
        cmocka_unit_test(matrices_have_three_forms),
        cmocka_unit_test(temperature_is_read),
        cmocka_unit_test(redundant_axes_have_directions),
        cmocka_unit_test(pendulous_axes_are_directions),
        cmocka_unit_test(evidence_is_read),
        cmocka_unit_test(json_is_the_same_tree),
        cmocka_unit_test(byte_order_mark_and_crlf_are_read),
        cmocka_unit_test(errors_point_to_their_place),
        cmocka_unit_test(what_is_no_model_file_is_refused),
        cmocka_unit_test(too_long_a_text_is_refused),
        cmocka_unit_test(unchanged_model_keeps_every_byte),
        cmocka_unit_test(changed_field_changes_its_text_only),
        cmocka_unit_test(new_field_is_put_in_its_place),
        cmocka_unit_test(removed_term_is_removed),
        cmocka_unit_test(changed_density_keeps_the_model),
        cmocka_unit_test(changed_floor_becomes_an_instability),
        cmocka_unit_test(json_document_stays_json),
        cmocka_unit_test(canonical_text_is_readable),
        cmocka_unit_test(stated_zeros_are_kept),
        cmocka_unit_test(perfect_unit_is_short),
        cmocka_unit_test(invalid_model_is_not_written),
        cmocka_unit_test(strange_texts_survive),
        cmocka_unit_test(files_are_written_and_read),
        cmocka_unit_test(catalogue_names_are_models),
        cmocka_unit_test(catalogue_survives),
        cmocka_unit_test(examples_of_the_manual_are_models),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
