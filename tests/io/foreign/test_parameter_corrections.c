/* SPDX-License-Identifier: Apache-2.0 */
/* Files of programs that correct readings themselves: with the numbers of the file, the program's
 * own formula gives the true vector again. */
#include "check.h"

#include "imukit/io.h"
#include "imukit/parameter_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static imk_model model, back;
static imk_parameter_notes notes;

/* Response T = (1 + s) e + A of each axis, and bias. */
static void fill(imk_triad *triad, double unit)
{
    for (int i = 0; i < 3; i++) {
        triad->scale_factor.fixed.value[i] = 0.01 * (i + 1);
        triad->misalignment.value[i][(i + 1) % 3] = 0.002 * (i + 1);
        triad->bias.fixed.value[i] = unit * (i - 1.5);
    }
}

static void fill_model(void)
{
    imk_model_default(&model);
    fill(&model.gyro, 1e-3);
    fill(&model.accel, 0.1);
    model.mag.present = true;
    fill(&model.mag, 1e-5);
}

/* The reading of a vector. */
static void distort(const imk_triad *triad, const double vector[3], double reading[3])
{
    for (int i = 0; i < 3; i++) {
        reading[i] = triad->bias.fixed.value[i];
        for (int j = 0; j < 3; j++)
            reading[i] += ((1 + triad->scale_factor.fixed.value[i]) * triad->direction[i][j] +
                           triad->misalignment.value[i][j]) *
                          vector[j];
    }
}

static char *print(const char *format)
{
    imk_parameter_settings settings = imk_parameter_default();
    char *text = NULL;
    size_t size;
    imk_error error;
    settings.format = imk_parameter_format_find(format);
    CHECK_OK(imk_parameters_print(NULL, &settings, &model, &text, &size, &notes, &error));
    return text;
}

static imk_status read_as(const char *format, const char *text)
{
    imk_parameter_settings settings = imk_parameter_default();
    settings.format = imk_parameter_format_find(format);
    return imk_parameters_parse(text, strlen(text), &settings, &back, &notes, NULL);
}

static bool has_note(bool lost, const char *part)
{
    for (size_t i = 0; i < notes.count; i++)
        if (notes.note[i].lost == lost && strstr(notes.note[i].text, part))
            return true;
    return false;
}

/* The numbers behind a name. */
static void numbers_of(const char *text, const char *name, int count, double *values)
{
    const char *at = strstr(text, name);
    assert_non_null(at);
    at += strcspn(at, "{[");
    at += strspn(at, "{[");
    for (int i = 0; i < count; i++) {
        char *end;
        values[i] = strtod(at, &end);
        assert_ptr_not_equal(end, at);
        at = end + strspn(end, "f, ");
    }
}

static const double vector[3] = {0.3, -0.7, 9.5};

/* odom.cc: sm f - bias, w - bias. */
static void test_dlio(void **state)
{
    (void)state;
    double sm[9], bias[3], reading[3];
    fill_model();
    char *text = print("dlio");
    numbers_of(text, "sm:", 9, sm);
    numbers_of(text, "accel:\n        bias:", 3, bias);
    distort(&model.accel, vector, reading);
    for (int i = 0; i < 3; i++)
        CHECK_CLOSE(sm[3 * i] * reading[0] + sm[3 * i + 1] * reading[1] +
                        sm[3 * i + 2] * reading[2] - bias[i],
                    vector[i], 1e-13);
    numbers_of(text, "gyro:\n        bias:", 3, bias);
    for (int i = 0; i < 3; i++)
        CHECK_RELATIVE(bias[i], model.gyro.bias.fixed.value[i], 0);
    assert_non_null(strstr(text, "calibration: false"));
    assert_true(has_note(true, "gyro.scale_factor.fixed is not held"));
    assert_false(has_note(true, "accel.bias"));
    assert_false(has_note(true, "accel.misalignment"));
    CHECK_OK(read_as("dlio", text));
    for (int i = 0; i < 3; i++)
        CHECK_CLOSE(back.accel.bias.fixed.value[i], model.accel.bias.fixed.value[i], 1e-14);
    free(text);
    /* As parameters of ROS 2 are called, and where DLIO would not use the numbers. */
    CHECK_OK(read_as("dlio", "/**: {ros__parameters: {imu/calibration: true, "
                             "imu/intrinsics/gyro/bias: [0.1, 0.2, 0.3]}}\n"));
    CHECK_RELATIVE(back.gyro.bias.fixed.value[2], 0.3, 0);
    assert_true(has_note(false, "finds biases by itself"));
    static const char *const wrong[] = {
        "imu: {intrinsics: 1}\n",
        "imu: {intrinsics: {accel: {sm: [1, 2]}}}\n",
        "imu: {intrinsics: {accel: {sm: [1, 0, 0, 0, 1, 0, 0, 1, 0]}}}\n",
        "imu: {intrinsics: {accel: {bias: [1, 2, 300]}}}\n",
        "imu: {intrinsics: {accel: {biass: [1, 2, 3]}}}\n",
        "imu: {}\n"};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++)
        assert_int_not_equal(read_as("dlio", wrong[i]), IMK_OK);
}

/* FusionCalibrationInertial: M (s o (raw - offset)); FusionCalibrationMagnetic: S (raw - h). */
static void check_fusion(const char *text, const char *sensor, const imk_triad *triad, double unit)
{
    double m[9], s[3] = {1, 1, 1}, offset[3], reading[3];
    char name[64];
    const bool magnetic = strcmp(sensor, "mag") == 0;
    snprintf(name, sizeof name, "%sMisalignment =", sensor);
    numbers_of(text, magnetic ? "softIronMatrix =" : name, 9, m);
    snprintf(name, sizeof name, "%sSensitivity =", sensor);
    if (!magnetic)
        numbers_of(text, name, 3, s);
    snprintf(name, sizeof name, "%sOffset =", sensor);
    numbers_of(text, magnetic ? "hardIronOffset =" : name, 3, offset);
    distort(triad, vector, reading);
    for (int i = 0; i < 3; i++) {
        double corrected = 0;
        for (int j = 0; j < 3; j++)
            corrected += m[3 * i + j] * s[j] * (reading[j] / unit - offset[j]);
        CHECK_CLOSE(corrected * unit, vector[i], 1e-12);
    }
}

static void test_fusion(void **state)
{
    (void)state;
    static const double degree = 0.017453292519943295;
    for (int turned = 0; turned < 2; turned++) {
        fill_model();
        if (turned) { /* x senses along y, y along -x */
            const double rows[2][3] = {{0, 1, 0}, {-1, 0, 0}};
            memcpy(model.gyro.direction[0], rows[0], sizeof rows[0]);
            memcpy(model.gyro.direction[1], rows[1], sizeof rows[1]);
            memset(&model.gyro.misalignment, 0, sizeof model.gyro.misalignment);
        }
        char *text = print("fusion");
        check_fusion(text, "gyroscope", &model.gyro, degree);
        check_fusion(text, "accelerometer", &model.accel, 9.80665);
        check_fusion(text, "mag", &model.mag, 1e-6);
        for (size_t i = 0; i < notes.count; i++)
            assert_false(notes.note[i].lost);
        imk_parameter_settings settings = imk_parameter_default(); /* found by its content */
        CHECK_OK(imk_parameters_parse(text, strlen(text), &settings, &back, &notes, NULL));
        assert_true(back.mag.present);
        for (int i = 0; i < 3; i++) {
            CHECK_CLOSE(back.gyro.scale_factor.fixed.value[i],
                        model.gyro.scale_factor.fixed.value[i], 1e-14);
            CHECK_CLOSE(back.mag.bias.fixed.value[i], model.mag.bias.fixed.value[i], 1e-18);
            CHECK_CLOSE(back.mag.misalignment.value[i][(i + 1) % 3],
                        model.mag.misalignment.value[i][(i + 1) % 3], 1e-14);
        }
        free(text);
    }
    /* A scale factor alone is the inverse of the sensitivity. */
    imk_model_default(&model);
    model.gyro.scale_factor.fixed.value[0] = 0.25;
    char *text = print("fusion");
    assert_non_null(strstr(text, "gyroscopeSensitivity = {{0.8f, 1.0f, 1.0f}};"));
    assert_null(strstr(text, "softIronMatrix"));
    free(text);
}

/* Of a magnetometer alone only Fusion has something to say. */
static void test_magnetometer_alone(void **state)
{
    (void)state;
    fill_model();
    model.gyro.present = model.accel.present = false;
    char *text = print("fusion");
    check_fusion(text, "mag", &model.mag, 1e-6);
    free(text);
    for (int format = 1; format < IMK_PARAMETERS_FUSION; format++) {
        imk_parameter_settings settings = imk_parameter_default();
        size_t size;
        settings.format = (imk_parameter_format)format;
        CHECK_STATUS(imk_parameters_print(NULL, &settings, &model, &text, &size, NULL, NULL),
                     IMK_ERROR_UNSUPPORTED);
    }
}

static void test_fusion_read(void **state)
{
    (void)state;
    CHECK_OK(read_as("fusion", "/* gyroscopeOffset is in deg/s */\nFusionVector gyroscopeOffset = "
                               "{.array = {180.0f, 0, 0}};\n"));
    CHECK_RELATIVE(back.gyro.bias.fixed.value[0], 3.14159265358979323846, 1e-15);
    assert_false(back.accel.present);
    CHECK_OK(read_as("fusion", "FusionMatrix gyroscopeMisalignment = {{1.0f, 0, 0}, {0, 1, 0}, {0, "
                               "0, 1}};"));
    static const char *const wrong[] = {
        "FusionVector gyroscopeOffset = {1, 2};",
        "FusionVector gyroscopeOffset = {1, 2, 3, 4};",
        "FusionVector gyroscopeOffset = 1, 2, 3;",
        "FusionVector gyroscopeOffset = {a, b, c};",
        "FusionVector gyroscopeOffset = {1, 2, 3",
        "FusionVector gyroscopeOffset =",
        "FusionVector gyroscopeOffset = {.array",
        "FusionVector gyroscopeOffset = {1e9f, 2, 3};",
        "FusionVector gyroscopeOffset = {1, 2, 3};\nFusionVector gyroscopeOffset = {1, 2, 3};",
        "FusionVector gyroscopeSensitivity = {0.07f, 0.07f, 0.00007f};", /* of counts */
        "FusionMatrix gyroscopeMisalignment = {1, 0, 0, 0, 1, 0, 0, 1, 0};",
        "FusionVector offset = {1, 2, 3};"};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++)
        assert_int_not_equal(read_as("fusion", wrong[i]), IMK_OK);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_dlio), cmocka_unit_test(test_fusion),
                                       cmocka_unit_test(test_fusion_read),
                                       cmocka_unit_test(test_magnetometer_alone)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
