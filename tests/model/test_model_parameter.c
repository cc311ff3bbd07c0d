/* SPDX-License-Identifier: Apache-2.0 */
/* Every number of a model has one place, one name and one unit; and what the correlation of a model
 * may say. */
#include "check.h"

#include "imukit/model_parameter.h"
#include "imukit/units.h"

#include <string.h>

typedef void visit(imk_model *model, imk_model_parameter parameter);

/* All the numbers of a model of 4 gyros and 3 accelerometers. */
static size_t for_each(imk_model *model, visit *what)
{
    size_t count = 0;
    for (unsigned sensor = 0; sensor < 3; sensor++)
        for (unsigned term = 0; term <= IMK_MODEL_TERMS; term++)
            for (unsigned axis = 0; axis <= IMK_AXES_MAX; axis++)
                for (unsigned element = 0; element < 7; element++) {
                    const imk_model_parameter parameter = {(uint8_t)sensor, (uint8_t)term,
                                                           (uint8_t)axis, (uint8_t)element};
                    if (!imk_model_parameter_at(model, parameter, NULL))
                        continue;
                    what(model, parameter);
                    count++;
                }
    return count;
}

static imk_model four_gyros(void)
{
    imk_model model;
    imk_model_default(&model);
    model.gyro.axis_count = 4;
    model.gyro.direction[3][0] = 1;
    return model;
}

static void mark(imk_model *model, imk_model_parameter parameter)
{
    double *sigma = NULL, *value = imk_model_parameter_at(model, parameter, &sigma);
    CHECK_CLOSE(*value, 0, 0);
    CHECK_CLOSE(*sigma, 0, 0);
    *value = 0.25;
    *sigma = 0.5;
    CHECK_CLOSE(imk_model_parameter_get(model, parameter), 0.25, 0);
}

static int elements_of(int sensor)
{
    int sum = 0;
    for (int term = 0; term < IMK_MODEL_TERMS; term++)
        sum += imk_model_term_elements(sensor, term);
    return sum;
}

/* Of three accelerometers two terms have no diagonal. No place is met twice: mark() finds zeros
 * everywhere. */
static void every_number_has_one_place(void **state)
{
    (void)state;
    imk_model model = four_gyros();
    assert_int_equal(for_each(&model, mark), 4 * elements_of(0) + 3 * elements_of(1) - 6);
    for (int axis = 0; axis < 4; axis++) {
        CHECK_CLOSE(model.gyro.bias.fixed.value[axis], 0.25, 0);
        CHECK_CLOSE(model.gyro.bias.fixed.sigma[axis], 0.5, 0);
        CHECK_CLOSE(model.gyro.misalignment.sigma[axis][axis % 3], 0.5, 0);
        CHECK_CLOSE(model.gyro.g2_sensitivity.value[axis][5], 0.25, 0);
        CHECK_CLOSE(model.gyro.g2_sensitivity.sigma[axis][5], 0.5, 0);
        CHECK_CLOSE(model.gyro.bias.temperature.coefficient[4].value[axis], 0.25, 0);
        CHECK_CLOSE(model.gyro.scale_factor.temperature.coefficient[4].sigma[axis], 0.5, 0);
    }
    CHECK_CLOSE(model.accel.lever_arm.value[2][2], 0.25, 0);
    CHECK_CLOSE(model.accel.nonlinearity.cross_products.sigma[1][0], 0.5, 0);
    CHECK_CLOSE(model.accel.misalignment.value[1][1], 0, 0);
    CHECK_CLOSE(model.accel.misalignment.value[1][2], 0.25, 0);
    /* Beyond the axes nothing was touched. */
    CHECK_CLOSE(model.gyro.bias.fixed.value[4], 0, 0);
    CHECK_CLOSE(model.gyro.misalignment.sigma[4][0], 0, 0);
    CHECK_CLOSE(model.accel.bias.fixed.sigma[3], 0, 0);
}

static void check_name(imk_model *model, imk_model_parameter parameter)
{
    (void)model;
    char name[IMK_MODEL_PARAMETER_NAME];
    imk_model_parameter back = {9, 9, 9, 9};
    CHECK_OK(imk_model_parameter_name(parameter, name));
    CHECK_OK(imk_model_parameter_parse(name, &back));
    assert_memory_equal(&back, &parameter, sizeof back);
    /* A unit of scale 1: an SI unit that can be read. */
    CHECK_CLOSE(imk_unit_of(imk_model_parameter_unit(parameter)).scale, 1, 0);
}

static void every_name_reads_back(void **state)
{
    (void)state;
    imk_model model = four_gyros();
    assert_int_equal(for_each(&model, check_name), 128 + 81);
}

static void names_are_those_of_the_model_file(void **state)
{
    (void)state;
    static const struct {
        const char *name, *unit;
        imk_model_parameter parameter;
    } cases[] = {
        {"accel.bias.fixed.x", "m/s^2", {1, IMK_MODEL_BIAS, 0, 0}},
        {"gyro.scale_factor.fixed.z", "1", {0, IMK_MODEL_SCALE_FACTOR, 2, 0}},
        {"gyro.misalignment.x.y", "rad", {0, IMK_MODEL_MISALIGNMENT, 0, 1}},
        {"accel.cross_products.z.ip", "1/(m/s^2)", {1, IMK_MODEL_CROSS_PRODUCTS, 2, 0}},
        {"accel.nonlinearity.k3.y", "1/(m/s^2)^2", {1, IMK_MODEL_K3, 1, 0}},
        {"gyro.g_sensitivity.y.z", "rad/s/(m/s^2)", {0, IMK_MODEL_G_SENSITIVITY, 1, 2}},
        {"gyro.g2_sensitivity.x.yz", "rad/s/(m/s^2)^2", {0, IMK_MODEL_G2_SENSITIVITY, 0, 4}},
        {"accel.lever_arm.x.x", "m", {1, IMK_MODEL_LEVER_ARM, 0, 0}},
        {"accel.bias.temperature.x.2", "m/s^2/K^2", {1, IMK_MODEL_BIAS_TEMPERATURE, 0, 1}},
        {"mag.bias.fixed.y", "T", {2, IMK_MODEL_BIAS, 1, 0}},
        {"mag.cross_axis.x.z", "1", {2, IMK_MODEL_CROSS_AXIS, 0, 2}},
        {"gyro.scale_factor.temperature.y.5", "1/K^5", {0, IMK_MODEL_SCALE_TEMPERATURE, 1, 4}},
        {"gyro.bias.temperature_rate.7", "rad/s/(K/s)", {0, IMK_MODEL_TEMPERATURE_RATE, 7, 0}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char name[IMK_MODEL_PARAMETER_NAME];
        CHECK_OK(imk_model_parameter_name(cases[i].parameter, name));
        assert_string_equal(name, cases[i].name);
        assert_string_equal(imk_model_parameter_unit(cases[i].parameter), cases[i].unit);
    }
    imk_model_parameter numbered;
    CHECK_OK(imk_model_parameter_parse("accel.bias.fixed.1", &numbered));
    assert_int_equal(numbered.axis, 1);
}

static void what_is_no_number_is_refused(void **state)
{
    (void)state;
    static const char *const names[] = {"",
                                        "accel",
                                        "accel.bias.fixed",
                                        "accel.bias.fixed.",
                                        "accel.bias.fixed.w",
                                        "accel.bias.fixed.8",
                                        "accel.bias.fixed.x.y",
                                        "accel.bias.fixedx.x",
                                        "accel.misalignment.x",
                                        "accel.misalignment.x.w",
                                        "accel.misalignment.xy",
                                        "accel.g_sensitivity.x.y",
                                        "gyro.lever_arm.x.y",
                                        "gyro.bias.temperature.x.6",
                                        "mag.lever_arm.x.y"};
    imk_model_parameter parameter = {3, 3, 3, 3};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        assert_int_equal(imk_model_parameter_parse(names[i], &parameter), IMK_ERROR_NAME_UNKNOWN);
    assert_int_equal(parameter.sensor, 3);

    imk_model model;
    imk_model_default(&model);
    const imk_model_parameter bias = {0, IMK_MODEL_BIAS, 0, 0};
    const imk_model_parameter diagonal = {1, IMK_MODEL_MISALIGNMENT, 2, 2};
    const imk_model_parameter fourth = {1, IMK_MODEL_BIAS, 3, 0};
    const imk_model_parameter beyond = {1, IMK_MODEL_BIAS, 8, 0};
    char name[IMK_MODEL_PARAMETER_NAME];
    assert_null(imk_model_parameter_at(&model, diagonal, NULL));
    assert_null(imk_model_parameter_at(&model, fourth, NULL));
    assert_true(isnan(imk_model_parameter_get(&model, fourth)));
    assert_int_equal(imk_model_parameter_name(beyond, name), IMK_ERROR_ARGUMENT);
    assert_string_equal(imk_model_parameter_unit(beyond), "");
    model.gyro.present = false;
    assert_null(imk_model_parameter_at(&model, bias, NULL));
    assert_int_equal(imk_model_term_elements(0, IMK_MODEL_G2_SENSITIVITY), 6);
    assert_int_equal(imk_model_term_elements(1, IMK_MODEL_G2_SENSITIVITY), 0);
    assert_int_equal(imk_model_term_elements(1, IMK_MODEL_BIAS_TEMPERATURE), 5);
    assert_int_equal(imk_model_term_elements(-1, IMK_MODEL_BIAS), 0);
    assert_int_equal(imk_model_term_elements(0, IMK_MODEL_TERMS), 0);
}

static imk_model correlated(void)
{
    imk_model model;
    imk_model_default(&model);
    model.correlation.count = 3;
    model.correlation.parameter[0] = (imk_model_parameter){1, IMK_MODEL_BIAS, 0, 0};
    model.correlation.parameter[1] = (imk_model_parameter){1, IMK_MODEL_SCALE_FACTOR, 0, 0};
    model.correlation.parameter[2] = (imk_model_parameter){0, IMK_MODEL_MISALIGNMENT, 0, 1};
    model.correlation.value[0] = -1;
    model.correlation.value[2] = 0.5f;
    return model;
}

static void check_refused(const imk_model *model, imk_status due, const char *field, int index)
{
    imk_error error = {.index = 0};
    assert_int_equal(imk_model_validate(model, &error), due);
    assert_string_equal(error.field, field);
    assert_int_equal(error.index, index);
}

static void correlation_is_validated(void **state)
{
    (void)state;
    imk_model model = correlated();
    imk_error error;
    CHECK_OK(imk_model_validate(&model, &error));
    model.correlation.value[2] = 1.01f;
    check_refused(&model, IMK_ERROR_RANGE, "correlation.values", 2);
    model.correlation.value[2] = NAN;
    check_refused(&model, IMK_ERROR_RANGE, "correlation.values", 2);
    model = correlated();
    model.correlation.parameter[2].element = 0; /* the diagonal */
    check_refused(&model, IMK_ERROR_KEY_UNKNOWN, "correlation.parameters", 2);
    model.correlation.parameter[2].sensor = IMK_KINDS;
    check_refused(&model, IMK_ERROR_KEY_UNKNOWN, "correlation.parameters", 2);
    model = correlated();
    model.correlation.parameter[1] = model.correlation.parameter[0];
    check_refused(&model, IMK_ERROR_KEY_DUPLICATE, "correlation.parameters", 1);
    model = correlated();
    model.correlation.count = IMK_CORRELATED_MAX + 1;
    check_refused(&model, IMK_ERROR_RANGE, "correlation.values", -1);
    /* A sensor that was taken out leaves what was known about the other. */
    model = correlated();
    model.gyro.present = false;
    CHECK_OK(imk_model_validate(&model, &error));
}

static void correlation_changes_no_simulation(void **state)
{
    (void)state;
    const imk_model with = correlated();
    imk_model without;
    imk_model_default(&without);
    assert_true(imk_model_equal(&with, &without));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_number_has_one_place),
        cmocka_unit_test(every_name_reads_back),
        cmocka_unit_test(names_are_those_of_the_model_file),
        cmocka_unit_test(what_is_no_number_is_refused),
        cmocka_unit_test(correlation_is_validated),
        cmocka_unit_test(correlation_changes_no_simulation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
