/* SPDX-License-Identifier: Apache-2.0 */
/* Models as Kalman filters want them: numbers computed here by hand, what comes back, what is said
 * to be lost. */
#include "check.h"

#include "imukit/io.h"
#include "imukit/parameter_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static imk_model model, back;
static imk_parameter_notes notes;

static imk_parameter_settings settings_at(double rate)
{
    imk_parameter_settings settings = imk_parameter_default();
    settings.format = IMK_PARAMETERS_FILTER;
    settings.rate = rate;
    return settings;
}

static void fill_model(void)
{
    imk_model_default(&model);
    for (int axis = 0; axis < 3; axis++) {
        model.gyro.noise.white.value[axis] = 1e-4 * (axis + 1);
        model.gyro.noise.random_walk.value[axis] = 2e-7;
        model.gyro.bias.repeatability.value[axis] = 1e-3;
        model.accel.noise.white.value[axis] = 1e-3;
        model.accel.noise.quantization.value[axis] = 1e-5;
        model.accel.noise.reading_noise.value[axis] = 2e-5;
        model.gyro.noise.angle_white.value[axis] = 3e-7;
    }
    /* One axis without the process keeps its place. */
    model.accel.noise.gauss_markov_count = 1;
    model.accel.noise.gauss_markov[0].sigma.value[1] = 4e-4;
    model.accel.noise.gauss_markov[0].correlation_time.value[1] = 300;
}

/* The text of the model; the caller frees it. */
static char *print(const char *path, const imk_parameter_settings *settings)
{
    static char *text;
    size_t size;
    imk_error error;
    CHECK_OK(imk_parameters_print(path, settings, &model, &text, &size, &notes, &error));
    return text;
}

static bool has_note(bool lost, const char *part)
{
    for (size_t i = 0; i < notes.count; i++)
        if (notes.note[i].lost == lost && strstr(notes.note[i].text, part))
            return true;
    return false;
}

static void check_line(const char *text, const char *part)
{
    if (!strstr(text, part)) {
        print_error("%s\nexpected in it: %s\n", text, part);
        fail();
    }
}

/* N/sqrt(dt), N sqrt(dt), K sqrt(dt) at 100 Hz, and the matrices of gyro x: Q_d holds N^2 dt +
 * K^2 dt^3/3, K^2 dt^2/2, K^2 dt. */
static void test_numbers(void **state)
{
    (void)state;
    fill_model();
    const imk_parameter_settings settings = settings_at(100);
    char *text = print("filter.yaml", &settings);
    check_line(text, "white_noise: [0.0001, 0.0002, 0.0003");
    check_line(text, "white_noise_per_reading: [0.001, 0.002, 0.003");
    check_line(text, "driving_noise_per_sample: [2e-8, 2e-8, 2e-8]");
    check_line(text, "# [rad/s^2/sqrt(Hz)]");
    check_line(text, "sigma_d  = sigma_c / sqrt(dt)");
    check_line(text, "F: [[0, 1], [0, 0]]");
    check_line(text, "Phi: [[1, 0.01], [0, 1]]");
    double q[4];
    assert_int_equal(sscanf(strstr(text, "Q_d: [["), "Q_d: [[%lf, %lf], [%lf, %lf]]", &q[0], &q[1],
                            &q[2], &q[3]),
                     4);
    CHECK_RELATIVE(q[0], 1e-8 * 0.01 + 4e-14 * 1e-6 / 3, 1e-14);
    CHECK_RELATIVE(q[1], 4e-14 * 1e-4 / 2, 1e-14);
    CHECK_RELATIVE(q[2], q[1], 0);
    CHECK_RELATIVE(q[3], 4e-14 * 0.01, 1e-14);
    assert_true(has_note(false, "accel: quantization"));
    free(text);
}

/* What a model's states say comes back, from YAML and from JSON. */
static void test_round_trip(void **state)
{
    (void)state;
    static const char *const paths[] = {"filter.yaml", "filter.json"};
    fill_model();
    for (int i = 0; i < 2; i++) {
        imk_parameter_settings settings = settings_at(200);
        imk_error error;
        char *text = print(paths[i], &settings);
        assert_false(has_note(true, ""));
        settings = imk_parameter_default(); /* found by its content */
        CHECK_OK(imk_parameters_parse(text, strlen(text), &settings, &back, &notes, &error));
        assert_true(imk_model_equal(&model, &back));
        free(text);
    }
}

/* Bias instability is approximated, which is said; its states are not taken for the model's. */
static void test_flicker(void **state)
{
    (void)state;
    fill_model();
    for (int axis = 0; axis < 3; axis++)
        model.gyro.noise.bias_instability.value[axis] = 3e-5;
    for (int flicker = 0; flicker < 4; flicker++) {
        imk_parameter_settings settings = settings_at(200);
        imk_error error;
        settings.filter.flicker = (imk_filter_flicker)flicker;
        char *text = print("filter.yaml", &settings);
        assert_true(has_note(true, "gyro.noise.bias_instability is not held"));
        assert_true(has_note(false, "approximated by") == (flicker < 3));
        CHECK_OK(imk_parameters_parse(text, strlen(text), &settings, &back, &notes, &error));
        assert_int_equal(back.gyro.noise.gauss_markov_count, 0);
        CHECK_CLOSE(back.gyro.noise.random_walk.value[0], 2e-7, 0);
        free(text);
    }
}

static void test_refusals(void **state)
{
    (void)state;
    fill_model();
    imk_parameter_settings settings = settings_at(0);
    char *text = NULL, message[500];
    size_t size;
    imk_error error;
    CHECK_STATUS(imk_parameters_print("x.yaml", &settings, &model, &text, &size, &notes, &error),
                 IMK_ERROR_KEY_MISSING);
    imk_error_text(&error, "m", message, sizeof message);
    check_line(message, "add --rate RATE");
    static const struct {
        const char *text, *says;
    } wrong[] = {{"imukit_filter: 1\ngyro: 3\n", "a mapping with white_noise"},
                 {"imukit_filter: 1\ngyro: {white_noize: 3}\n", "white_noise"},
                 {"imukit_filter: 1\ngyro: {white_noise: [1, 2, 3]}\n", "rad/s/sqrt(Hz)"},
                 {"imukit_filter: 1\ngyro: {bias_states: [{from: nothing}]}\n", "random_walk"},
                 {"imukit_filter: 1\ngyro: {white_noise: [1e-4, 2]}\n", "list of 3"}};
    settings = imk_parameter_default();
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        assert_int_not_equal(imk_parameters_parse(wrong[i].text, strlen(wrong[i].text), &settings,
                                                  &back, &notes, &error),
                             IMK_OK);
        imk_error_text(&error, "f", message, sizeof message);
        check_line(message, wrong[i].says);
    }
}

/* kalibr's file explains the sqrt(dt) trap and where B goes. */
static void test_kalibr_comments(void **state)
{
    (void)state;
    fill_model();
    for (int axis = 0; axis < 3; axis++)
        model.accel.noise.random_walk.value[axis] = 1e-5;
    imk_parameter_settings settings = settings_at(200);
    settings.format = IMK_PARAMETERS_KALIBR;
    char *text = print("imu.yaml", &settings);
    check_line(text, "sigma_d  = noise_density / sqrt(dt)");
    check_line(text, "sigma_bd = random_walk * sqrt(dt)");
    check_line(text, "random_walk = sqrt(K^2 + 6 ln 2/pi B^2/tau)");
    check_line(text, "update_rate: 200");
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_numbers), cmocka_unit_test(test_round_trip),
        cmocka_unit_test(test_flicker), cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_kalibr_comments)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
