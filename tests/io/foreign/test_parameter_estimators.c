/* SPDX-License-Identifier: Apache-2.0 */
/* Files of estimators and simulators: numbers computed here by hand from what the program's source
 * does with them, what comes back, what is refused. */
#include "check.h"

#include "imukit/io.h"
#include "imukit/parameter_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double rounding = 1e-12;
static const double degree = 0.017453292519943295;

static imk_model model, back;
static imk_parameter_notes notes;
static char message[1000];

static imk_parameter_settings settings_of(const char *format)
{
    imk_parameter_settings settings = imk_parameter_default();
    settings.format = imk_parameter_format_find(format);
    settings.rate = 100;
    settings.frame_rate = 10;
    return settings;
}

/* N = 2e-4, K = 3e-6 of the gyros, N = 9.80665e-3 (1 mg/sqrt(Hz)), K = 1e-5 of the others. */
static void fill_model(void)
{
    imk_model_default(&model);
    for (int axis = 0; axis < 3; axis++) {
        model.gyro.noise.white.value[axis] = 2e-4;
        model.gyro.noise.random_walk.value[axis] = 3e-6;
        model.accel.noise.white.value[axis] = 9.80665e-3;
        model.accel.noise.random_walk.value[axis] = 1e-5;
    }
}

static char *print(const char *path, const imk_parameter_settings *settings)
{
    char *text = NULL;
    size_t size;
    imk_error error;
    CHECK_OK(imk_parameters_print(path, settings, &model, &text, &size, &notes, &error));
    return text;
}

static imk_status read_as(const char *format, const char *text)
{
    imk_parameter_settings settings = settings_of(format);
    imk_error error = {.status = IMK_OK};
    const imk_status status =
        imk_parameters_parse(text, strlen(text), &settings, &back, &notes, &error);
    message[0] = '\0';
    if (status != IMK_OK)
        imk_error_text(&error, "f", message, sizeof message);
    return status;
}

static void check_part(const char *text, const char *part)
{
    if (!strstr(text, part)) {
        print_error("%s\nexpected in it: %s\n", text, part);
        fail();
    }
}

static void check_note(bool lost, const char *part)
{
    for (size_t i = 0; i < notes.count; i++)
        if (notes.note[i].lost == lost && strstr(notes.note[i].text, part))
            return;
    print_error("expected a note with: %s\n", part);
    fail();
}

/* The number behind a key. */
static double number_of(const char *text, const char *key)
{
    const char *at = strstr(text, key);
    assert_non_null(at);
    return strtod(at + strlen(key), NULL);
}

static void check_axes(const imk_axes *axes, double x, double y, double z)
{
    const double expected[3] = {x, y, z};
    for (int i = 0; i < 3; i++)
        CHECK_RELATIVE(axes->value[i], expected[i], rounding);
}

/* A saved input of the fuzzer. */
static char *sample(const char *name)
{
    static char text[8192];
    char path[512];
    snprintf(path, sizeof path, "%s/fuzz/corpus/parameters/%s", SOURCE_DIRECTORY, name);
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    fclose(file);
    return text;
}

/* With equal axes nothing is lost, and the format is found by its content. */
static void test_round_trip(void **state)
{
    (void)state;
    static const char *const formats[][2] = {{"lio-sam", "p.yaml"},   {"fast-lio", "p.yaml"},
                                             {"orb-slam3", "p.yaml"}, {"gtsam", "p.py"},
                                             {"gtsam", "p.hpp"},      {"airsim", "p.json"}};
    fill_model();
    for (size_t i = 0; i < sizeof formats / sizeof formats[0]; i++) {
        imk_parameter_settings settings = settings_of(formats[i][0]);
        imk_error error;
        char *text = print(formats[i][1], &settings);
        for (size_t k = 0; k < notes.count; k++)
            assert_false(notes.note[k].lost);
        settings.format = IMK_PARAMETERS_UNKNOWN;
        CHECK_OK(imk_parameters_parse(text, strlen(text), &settings, &back, &notes, &error));
        const imk_triad *both[2][2] = {{&model.gyro, &back.gyro}, {&model.accel, &back.accel}};
        for (int kind = 0; kind < 2; kind++) {
            const double *n = both[kind][0]->noise.white.value;
            const double *k = both[kind][0]->noise.random_walk.value;
            check_axes(&both[kind][1]->noise.white, n[0], n[1], n[2]);
            check_axes(&both[kind][1]->noise.random_walk, k[0], k[1], k[2]);
        }
        free(text);
    }
}

/* GTSAM squares the noises, and scales the walks by the root of the time itself: N and K. */
static void test_lio_sam(void **state)
{
    (void)state;
    fill_model();
    model.gyro.noise.white.value[1] = 4e-4;
    imk_parameter_settings settings = settings_of("lio-sam");
    char *text = print(NULL, &settings);
    check_part(text, "lio_sam:\n  imuGyrNoise: 0.0004  # [rad/s/sqrt(Hz)], axis y (the largest)\n"
                     "  imuGyrBiasN: 3e-6  # [rad/s^2/sqrt(Hz)]\n  imuAccNoise: 0.00980665  # "
                     "[m/s^2/sqrt(Hz)]\n  imuAccBiasN: 0.00001  # [m/s^3/sqrt(Hz)]\n");
    check_note(true, "imuGyrNoise is one number for all axes");
    free(text);
    CHECK_OK(read_as("lio-sam", sample("lio_sam.yaml")));
    check_axes(&back.gyro.noise.white, 1.5636343949698187e-03, 1.5636343949698187e-03,
               1.5636343949698187e-03);
    check_axes(&back.accel.noise.random_walk, 6.4356659353532566e-05, 6.4356659353532566e-05,
               6.4356659353532566e-05);
    check_note(true, "2 other keys");
    CHECK_OK(read_as("lio-sam", "a: {b: {imuGyrNoise: 1e-3}}\n"));
    check_note(true, "imuAccBiasN is not in the file");
    CHECK_STATUS(read_as("lio-sam", "a: {imuGyrNoise: 1e-3}\nb: {imuAccNoise: 1e-3}\n"),
                 IMK_ERROR_KEY_DUPLICATE);
    check_part(message, "in several");
    CHECK_STATUS(read_as("lio-sam", "imuGyroNoise: 1e-3\n"), IMK_ERROR_KEY_MISSING);
    CHECK_STATUS(read_as("lio-sam", "imuGyrNoise: 5\n"), IMK_ERROR_RANGE);
}

/* predict() lets the variance of the angle grow by gyr_cov dt^2 and that of the bias by b_gyr_cov
 * dt^2 at each of the 100 steps of a second: N^2 and K^2 in all. */
static void test_fast_lio(void **state)
{
    (void)state;
    fill_model();
    imk_parameter_settings settings = settings_of("fast-lio");
    char *text = print(NULL, &settings);
    const double steps = 100 * 0.01 * 0.01;
    CHECK_RELATIVE(number_of(text, " gyr_cov: ") * steps, 2e-4 * 2e-4, rounding);
    CHECK_RELATIVE(number_of(text, "b_gyr_cov: ") * steps, 3e-6 * 3e-6, rounding);
    CHECK_RELATIVE(number_of(text, " acc_cov: ") * steps, 9.80665e-3 * 9.80665e-3, rounding);
    CHECK_RELATIVE(number_of(text, "b_acc_cov: ") * steps, 1e-10, rounding);
    free(text);
    CHECK_OK(read_as("fast-lio", sample("fast_lio.yaml")));
    check_axes(&back.gyro.noise.white, 1e-3, 1e-3, 1e-3); /* sqrt(1e-4/100) */
    const double k = sqrt(2e-6 / 100);
    check_axes(&back.gyro.noise.random_walk, k, k, k);
    check_note(false, "per sample at 100 Hz");
    CHECK_STATUS(read_as("fast-lio", "mapping: {gyr_cov: -1}\n"), IMK_ERROR_RANGE);
    check_part(message, "a variance");
    CHECK_STATUS(read_as("fast-lio", "mapping: {gyr_cov: nan}\n"), IMK_ERROR_RANGE);
    CHECK_STATUS(read_as("fast-lio", "other: {gyr_cov: 1}\n"), IMK_ERROR_KEY_MISSING);
    CHECK_STATUS(read_as("fast-lio", "mapping: {gyr_cov: 1e9}\n"), IMK_ERROR_RANGE);
    CHECK_STATUS(read_as("fast-lio", "a: {mapping: {gyr_cov: 1}}\nmapping: {acc_cov: 1}\n"),
                 IMK_ERROR_KEY_DUPLICATE);
    imk_error error;
    settings.rate = 0;
    CHECK_STATUS(imk_parameters_print(NULL, &settings, &model, &text, &(size_t){0}, NULL, &error),
                 IMK_ERROR_KEY_MISSING);
    assert_string_equal(error.expected, "add --rate RATE (samples per second, as 200Hz)");
}

/* Noise sqrt(frequency) and walk/sqrt(frequency) are made by ORB-SLAM3; each number has a point. */
static void test_orb_slam3(void **state)
{
    (void)state;
    fill_model();
    imk_parameter_settings settings = settings_of("orb-slam3");
    char *text = print(NULL, &settings);
    check_part(text, "IMU.NoiseGyro: 0.0002  #");
    check_part(text, "IMU.GyroWalk: 3.0e-6  #");
    check_part(text, "IMU.NoiseAcc: 0.00980665  #");
    check_part(text, "IMU.Frequency: 100.0  # [Hz]");
    free(text);
    CHECK_OK(read_as("orb-slam3", sample("orb_slam3.yaml")));
    check_axes(&back.gyro.noise.white, 1.7e-4, 1.7e-4, 1.7e-4);
    check_axes(&back.accel.noise.random_walk, 3e-3, 3e-3, 3e-3);
    settings.rate = 99.5;
    text = print(NULL, &settings);
    check_part(text, "IMU.Frequency: 99.5  # [Hz]");
    free(text);
    /* One sensor is half of what it needs. */
    model.accel.present = false;
    text = print(NULL, &settings);
    check_note(true, "IMU.NoiseAcc is not written, because the model has no accelerometers");
    assert_null(strstr(text, "IMU.AccWalk"));
    free(text);
}

/* The biases may change by imu_bias_noise from frame to frame: K/sqrt(10) at 10 frames per second.
 */
static void test_glim(void **state)
{
    (void)state;
    fill_model();
    for (int axis = 0; axis < 3; axis++) {
        model.gyro.bias.fixed.value[axis] = 0.01 * (axis + 1);
        model.accel.bias.fixed.value[axis] = 0.1 * (axis + 1);
    }
    imk_parameter_settings settings = settings_of("glim");
    char *text = print("config_sensors.json", &settings);
    check_part(text, "\"imu_gyro_noise\": 0.0002,");
    check_part(text, "\"imu_acc_noise\": 0.00980665,");
    CHECK_RELATIVE(number_of(text, "\"imu_bias_noise\": "), 1e-5 / sqrt(10), rounding);
    check_part(text, "\"imu_bias\": [0.1, 0.2, 0.30000000000000004, 0.01, 0.02, 0.03]");
    check_part(text, "10 frames per second, of the accelerometers");
    check_note(true, "T_lidar_imu");
    check_note(true, "both sensors: that of the accelerometers");
    CHECK_OK(read_as("glim", text));
    check_axes(&back.gyro.noise.white, 2e-4, 2e-4, 2e-4);
    check_axes(&back.gyro.noise.random_walk, 1e-5, 1e-5, 1e-5);
    check_axes(&back.gyro.bias.fixed, 0.01, 0.02, 0.03);
    free(text);
    CHECK_OK(read_as("glim", sample("glim.json"))); /* with comments */
    check_axes(&back.accel.bias.fixed, 0.1, 0.2, 0.3);
    check_axes(&back.accel.noise.white, 0.05, 0.05, 0.05);
    CHECK_STATUS(read_as("glim", "{\"sensors\": {\"imu_bias\": [1, 2, 3]}}"), IMK_ERROR_SYNTAX);
    imk_error error;
    settings.frame_rate = 0;
    CHECK_STATUS(imk_parameters_print(NULL, &settings, &model, &text, &(size_t){0}, NULL, &error),
                 IMK_ERROR_KEY_MISSING);
    assert_string_equal(error.expected, "add --frame-rate RATE (LiDAR scans per second, as 10Hz)");
    static const char walk[] = "{\"sensors\": {\"imu_bias_noise\": 1e-3}}";
    CHECK_OK(imk_parameters_parse(walk, sizeof walk - 1, &settings, &back, &notes, &error));
    check_note(true, "per frame and is not read");
    settings.frame_rate = 1e10;
    CHECK_STATUS(imk_parameters_print(NULL, &settings, &model, &text, &(size_t){0}, NULL, &error),
                 IMK_ERROR_RANGE);
}

/* Covariances per axis: N^2 and K^2. */
static void test_gtsam(void **state)
{
    (void)state;
    fill_model();
    model.gyro.noise.white.value[2] = 1e-4;
    imk_parameter_settings settings = settings_of("gtsam");
    char *text = print("imu.py", &settings);
    check_part(text, "import gtsam");
    const char *at = strstr(text, "setGyroscopeCovariance(np.diag([");
    assert_non_null(at);
    double n[3];
    assert_int_equal(sscanf(strchr(at, '[') + 1, "%lf, %lf, %lf", &n[0], &n[1], &n[2]), 3);
    CHECK_RELATIVE(n[0], 4e-8, rounding);
    CHECK_RELATIVE(n[2], 1e-8, rounding);
    CHECK_RELATIVE(number_of(text, "setBiasOmegaCovariance(np.diag(["), 9e-12, rounding);
    free(text);
    text = print("imu.hpp", &settings);
    check_part(text, "#pragma once");
    CHECK_RELATIVE(number_of(text, "setBiasAccCovariance(gtsam::Vector3("), 1e-10, rounding);
    free(text);
    CHECK_OK(read_as("gtsam", sample("gtsam.txt")));
    check_axes(&back.gyro.noise.white, 1e-4, 2e-4, 3e-4);
    check_axes(&back.accel.noise.random_walk, 1e-5, 1e-5, 1e-5);
    CHECK_OK(read_as("gtsam", "p.setGyroscopeCovariance(np.diag([1e-8,1e-8,1e-8]))"));
    check_note(true, "setBiasAccCovariance is not in the file");
    static const char *const wrong[] = {"p.setGyroscopeCovariance(sigma * np.eye(3))",
                                        "p.setGyroscopeCovariance(np.diag([1e-8, 1e-8]))",
                                        "p.setGyroscopeCovariance(np.diag([1e-8, 1e-8, 1e-8",
                                        "p.setGyroscopeCovariance(np.diag([1e-8, 1e-8, -1e-8]))",
                                        "p.setGyroscopeCovariance",
                                        "p.setGyroscopeCovariance(np.diag([1, 1, 1]))",
                                        "a.setGyroscopeCovariance(np.diag([1e-8, 1e-8, 1e-8]))\n"
                                        "b.setGyroscopeCovariance(np.diag([1e-8, 1e-8, 1e-8]))\n",
                                        "nothing"};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++)
        assert_int_not_equal(read_as("gtsam", wrong[i]), IMK_OK);
    /* A 0 on one axis would make GTSAM's matrix singular. */
    model.gyro.noise.white.value[1] = 0;
    text = print(NULL, &settings);
    check_note(true, "setGyroscopeCovariance has a 0");
    free(text);
}

/* The bias walks by (stability/sqrt(tau)) sqrt(dt) in each step. */
static void test_airsim(void **state)
{
    (void)state;
    fill_model();
    imk_parameter_settings settings = settings_of("airsim");
    char *text = print("settings.json", &settings);
    CHECK_RELATIVE(number_of(text, "\"AngularRandomWalk\": "), 2e-4 / degree * 60, rounding);
    CHECK_RELATIVE(number_of(text, "\"GyroBiasStability\": "), 3e-6 * sqrt(500) / degree * 3600,
                   rounding);
    CHECK_RELATIVE(number_of(text, "\"VelocityRandomWalk\": "), 1, rounding);
    CHECK_RELATIVE(number_of(text, "\"AccelBiasStability\": "), 1e-5 * sqrt(800) / 9.80665e-6,
                   rounding);
    check_part(text, "\"Gps\": {\"SensorType\": 3");
    free(text);
    CHECK_OK(read_as("airsim", sample("airsim.json")));
    const double n = 0.3 * degree / 60, k = 4.6 * degree / 3600 / sqrt(500);
    check_axes(&back.gyro.noise.white, n, n, n);
    check_axes(&back.gyro.noise.random_walk, k, k, k);
    /* A missing key has AirSim's default. */
    CHECK_OK(read_as("airsim", "{\"Imu\": {\"VelocityRandomWalk\": 1}}"));
    check_axes(&back.gyro.noise.random_walk, k, k, k);
    check_note(false, "GyroBiasStabilityTau is not in the file: AirSim's default of 500 s");
    CHECK_STATUS(read_as("airsim", "{\"Imu\": {\"GyroBiasStabilityTau\": 0}}"), IMK_ERROR_RANGE);
    CHECK_STATUS(
        read_as("airsim", "{\"Imu\": {\"AngularRandomWalk\": 1, \"Angularrandomwalk\": 2}}"),
        IMK_ERROR_KEY_UNKNOWN);
    CHECK_STATUS(read_as("airsim", "{\"a\": {\"AngularRandomWalk\": 1}, \"b\": "
                                   "{\"AngularRandomWalk\": 2}}"),
                 IMK_ERROR_KEY_MISSING);
    check_part(message, "--sensor NAME with one of a, b");
    CHECK_STATUS(read_as("airsim", "{\"a\": 1}"), IMK_ERROR_KEY_MISSING);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_round_trip), cmocka_unit_test(test_lio_sam),
        cmocka_unit_test(test_fast_lio),   cmocka_unit_test(test_orb_slam3),
        cmocka_unit_test(test_glim),       cmocka_unit_test(test_gtsam),
        cmocka_unit_test(test_airsim)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
