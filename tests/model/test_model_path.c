/* SPDX-License-Identifier: Apache-2.0 */
/* The numbers of a model by their path are those of the structs. */
#include "check.h"

#include "imukit/model_path.h"

#include <math.h>
#include <string.h>

static imk_model model;

static int set_up(void **state)
{
    (void)state;
    imk_model_default(&model);
    return 0;
}

static imk_model_numbers get(const char *path)
{
    imk_model_numbers numbers;
    imk_error error;
    assert_int_equal(imk_model_numbers_get(&model, path, &numbers, &error), IMK_OK);
    return numbers;
}

static void test_shapes(void **state)
{
    (void)state;
    model.gyro.noise.white.value[1] = 2e-5;
    model.gyro.noise.white.sigma[2] = 3e-6;
    model.gyro.misalignment.value[1][2] = 1e-3;
    model.timing.jitter.value = 5e-6;
    imk_model_numbers n = get("gyro.noise.angle_random_walk");
    assert_int_equal(n.axes, 3);
    assert_int_equal(n.columns, 1);
    assert_string_equal(n.unit, "rad/sqrt(s)");
    assert_true(n.value[1] == 2e-5 && n.sigma[2] == 3e-6);
    n = get("gyro.misalignment");
    assert_true(n.columns == 3 && n.value[5] == 1e-3);
    n = get("timing.jitter");
    assert_true(n.axes == 0 && n.columns == 1 && n.value[0] == 5e-6);
    assert_true(get("accel.direction").value[4] == 1);
}

static void test_lists(void **state)
{
    (void)state;
    imk_temperature_polynomial *p = &model.accel.bias.temperature;
    model.gyro.noise.gauss_markov_count = 2;
    model.gyro.noise.gauss_markov[1].correlation_time.value[2] = 300;
    assert_true(get("gyro.noise.gauss_markov[1].correlation_time").value[2] == 300);
    *p = (imk_temperature_polynomial){.order = 2, .reference = 298, .minimum = 233, .maximum = 358};
    p->coefficient[1].value[0] = 0.25;
    imk_model_numbers n = get("accel.bias.temperature.coefficients[1]");
    assert_string_equal(n.unit, "m/s^2/K^2");
    assert_true(n.value[0] == 0.25);
    n = get("accel.bias.temperature.valid_range");
    assert_true(n.axes == 0 && n.columns == 2 && n.value[1] == 358);
}

/* The floor is 0.664 of the instability [IEEE952]; counts per microtesla. */
static void test_other_units(void **state)
{
    (void)state;
    model.gyro.noise.bias_instability.value[0] = 1e-5;
    assert_float_equal(get("gyro.noise.allan_floor").value[0], 0.66428247e-5, 1e-13);
    model.mag = model.gyro;
    model.mag.sensitivity.value[0] = 15e6;
    const imk_model_numbers n = get("mag.sensitivity");
    assert_string_equal(n.unit, "count/uT");
    assert_float_equal(n.value[0], 15, 1e-12);
}

static void test_evidence(void **state)
{
    (void)state;
    model.gyro_evidence.interval_count = 1;
    imk_interval *interval = &model.gyro_evidence.interval[0];
    strcpy(interval->key, "noise.gauss_markov.sigma");
    interval->instance = 1;
    interval->lower.value[2] = 1e-6;
    interval->upper.value[2] = 2e-6;
    const imk_model_numbers n = get("gyro.evidence.interval_95.noise.gauss_markov[1].sigma");
    assert_true(n.axes == 3 && n.columns == 2);
    assert_true(n.value[4] == 1e-6 && n.value[5] == 2e-6);
}

static void test_units(void **state)
{
    (void)state;
    assert_string_equal(imk_model_path_unit("gyro.noise.gauss_markov[7].sigma"), "rad/s");
    assert_string_equal(imk_model_path_unit("accel.bias.temperature.coefficients[1]"), "m/s^2/K^2");
    assert_string_equal(imk_model_path_unit("accel.bias.temperature.reference_temperature"), "K");
    assert_string_equal(imk_model_path_unit("accel.evidence.upper_bound.bias.fixed"), "m/s^2");
    assert_string_equal(imk_model_path_unit("gyro.damping"), "");
    assert_string_equal(imk_model_path_unit("gyro.scale_factor.fixed"), "1");
    assert_null(imk_model_path_unit("accel.bias"));
    assert_null(imk_model_path_unit("accel.bias.temperature.coefficients[5]"));
    assert_null(imk_model_path_unit(""));
}

/* Each path that is listed has numbers, or belongs to a list that is empty. */
static void test_all_paths(void **state)
{
    (void)state;
    char path[IMK_MODEL_PATH];
    size_t count = 0;
    model.mag = model.gyro;
    for (; imk_model_path(count, path); count++) {
        imk_model_numbers n;
        imk_error error;
        char *brackets = strstr(path, "[]");
        if (brackets) {
            char rest[IMK_MODEL_PATH];
            strcpy(rest, brackets + 2);
            strcpy(brackets, "[0]");
            strcat(path, rest);
        }
        const imk_status status = imk_model_numbers_get(&model, path, &n, &error);
        const bool element = brackets != NULL || strstr(path, "reference_temperature") ||
                             strstr(path, "valid_range");
        if (status != (brackets ? IMK_ERROR_KEY_MISSING : IMK_OK) && !element)
            fail_msg("%s", path);
    }
    assert_true(count > 100);
}

static void test_refused(void **state)
{
    (void)state;
    static const struct {
        const char *path;
        imk_status status;
    } cases[] = {
        {"", IMK_ERROR_NAME_UNKNOWN},
        {"gyro", IMK_ERROR_NAME_UNKNOWN},
        {"gyro.", IMK_ERROR_NAME_UNKNOWN},
        {"gyro.noise", IMK_ERROR_NAME_UNKNOWN},
        {"gyro.noise.density", IMK_ERROR_NAME_UNKNOWN},
        {"gyro.noise.gauss_markov", IMK_ERROR_NAME_UNKNOWN},
        {"gyro.noise.gauss_markov.sigma", IMK_ERROR_NAME_UNKNOWN},
        {"gyro.noise.gauss_markov[0]", IMK_ERROR_NAME_UNKNOWN},
        {"gyro.noise.gauss_markov[-1].sigma", IMK_ERROR_NAME_UNKNOWN},
        {"gyro.noise.gauss_markov[99999999999].sigma", IMK_ERROR_NAME_UNKNOWN},
        {"gyro.noise.gauss_markov[0].sigma", IMK_ERROR_KEY_MISSING},
        {"gyro.bias.fixed[0]", IMK_ERROR_NAME_UNKNOWN},
        {"gyro.bias.temperature", IMK_ERROR_NAME_UNKNOWN},
        {"gyro.bias.temperature.coefficients", IMK_ERROR_NAME_UNKNOWN},
        {"gyro.bias.temperature.coefficients[0]", IMK_ERROR_KEY_MISSING},
        {"gyro.lever_arm", IMK_ERROR_NAME_UNKNOWN},
        {"mag.bias.fixed", IMK_ERROR_KEY_MISSING},
        {"timing.jiter", IMK_ERROR_NAME_UNKNOWN},
        {"gyro.evidence.interval_95.noise.bias_instability", IMK_ERROR_KEY_MISSING},
        {"gyro.evidence.source", IMK_ERROR_NAME_UNKNOWN},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        imk_model_numbers n;
        imk_error error;
        const imk_status status = imk_model_numbers_get(&model, cases[i].path, &n, &error);
        if (status != cases[i].status)
            fail_msg("%s: %s", cases[i].path, imk_status_name(status));
    }
    imk_error error;
    (void)imk_model_numbers_get(&model, "gyro.noise.angle_random_walks", NULL, &error);
    assert_string_equal(error.expected, "did you mean \"gyro.noise.angle_random_walk\"?");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(test_shapes, set_up),
        cmocka_unit_test_setup(test_lists, set_up),
        cmocka_unit_test_setup(test_other_units, set_up),
        cmocka_unit_test_setup(test_evidence, set_up),
        cmocka_unit_test(test_units),
        cmocka_unit_test_setup(test_all_paths, set_up),
        cmocka_unit_test_setup(test_refused, set_up),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
