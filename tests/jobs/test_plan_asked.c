/* SPDX-License-Identifier: Apache-2.0 */
/* Requirements of a test programme, as they are written, and the settings that a plan takes from a
 * calibration. */
#include "check.h"

#include "imukit/jobs.h"

#include <string.h>

enum { ROOM = 8 };

static imk_status read_text(const char *text, imk_sigma_requirement requirement[ROOM],
                            size_t *count, imk_error *error)
{
    static imk_calibration calibration;
    imk_calibration_default(&calibration);
    return imk_calibrate_requirements(&calibration, 0, text, ROOM, requirement, count, error);
}

/* A term means each of its numbers; units are those of the file or others of the dimension. */
static void test_read(void **state)
{
    (void)state;
    imk_sigma_requirement requirement[ROOM];
    size_t count;
    imk_error error;
    CHECK_OK(read_text(NULL, requirement, &count, &error));
    assert_int_equal(count, 0);
    CHECK_OK(read_text("accel.scale_factor 50 ppm,  gyro.bias 3.6 deg/h,accel.bias.fixed.y 1 mg",
                       requirement, &count, &error));
    assert_int_equal(count, 7);
    for (size_t k = 0; k < count; k++) {
        char name[IMK_MODEL_PARAMETER_NAME];
        static const char *const due[] = {
            "accel.scale_factor.fixed.x", "accel.scale_factor.fixed.y",
            "accel.scale_factor.fixed.z", "gyro.bias.fixed.x",
            "gyro.bias.fixed.y",          "gyro.bias.fixed.z",
            "accel.bias.fixed.y"};
        const double sigma = k < 3 ? 50e-6 : k < 6 ? 1e-3 * 0.017453292519943295 : 9.80665e-3;
        CHECK_OK(imk_model_parameter_name(requirement[k].parameter, name));
        assert_string_equal(name, due[k]);
        CHECK_CLOSE(requirement[k].sigma, sigma, 1e-12 * sigma);
    }
}

static void test_refused(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        imk_status status;
        const char *field, *found, *expected;
    } cases[] = {
        {"accel.scale_factor", IMK_ERROR_SYNTAX, "want", "accel.scale_factor", "a term and its 1"},
        {"gyro.bias 1 deg/h, ", IMK_ERROR_SYNTAX, "want", "", "a term and its 1"},
        {"accel.bias 5 ppm", IMK_ERROR_SYNTAX, "want", "accel.bias 5 ppm",
         "with a unit such as mg"},
        {"accel.bias 0 mg", IMK_ERROR_SYNTAX, "want", "accel.bias 0 mg", "a positive number"},
        {"accel.bias nan mg", IMK_ERROR_SYNTAX, "want", "accel.bias nan mg", "a positive number"},
        {"accel.bais 5 mg", IMK_ERROR_KEY_UNKNOWN, "accel.bais", "", "nonlinearity, k2, "},
        {"accel.bias.fixed.7 5 mg", IMK_ERROR_RANGE, "accel.bias.fixed.7", "", "no such axis"},
        {"accel.nonlinearity 5 1", IMK_ERROR_SYNTAX, "want", "", ""},
        {"bias.fixed.x 5 mg", IMK_ERROR_KEY_UNKNOWN, "bias.fixed.x", "", ""},
        {"gyro.g_sensitivity 5 deg/h/g", IMK_ERROR_WORKSPACE, "want", "too many", ""},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        imk_sigma_requirement requirement[ROOM];
        size_t count;
        imk_error error;
        assert_int_equal(read_text(cases[k].text, requirement, &count, &error), cases[k].status);
        assert_string_equal(error.field, cases[k].field);
        assert_non_null(strstr(error.found, cases[k].found));
        assert_non_null(strstr(error.expected, cases[k].expected));
    }
}

/* What was asked of the calibration is what is planned for; what needs no programme is refused. */
static void test_settings(void **state)
{
    (void)state;
    imk_calibrate_log_settings s = imk_calibrate_log_default();
    imk_procedure procedure = IMK_PROCEDURE_THERMAL;
    imk_calibrate_log *session = NULL;
    imk_plan_settings plan;
    imk_error error;
    s.placement = 0.002;
    s.mounting = 0.003;
    s.temperature_order = 2;
    s.with = IMK_CALIBRATE_NONLINEARITY;
    CHECK_OK(imk_calibrate_log_create(1, &procedure, &s, NULL, &session, &error));
    CHECK_OK(imk_calibrate_plan_settings(session, &plan, &error));
    assert_int_equal(plan.procedure, IMK_PROCEDURE_THERMAL);
    assert_int_equal(plan.temperature_order, 2);
    assert_true(plan.nonlinear && plan.placement_sigma == 0.002 && plan.fixture_sigma == 0.003);
    assert_true(plan.rate == imk_plan_default(procedure).rate);
    imk_calibrate_log_free(session);

    s = imk_calibrate_log_default();
    procedure = IMK_PROCEDURE_MAGNETOMETER;
    for (int repeated = 0; repeated < 2; repeated++) {
        s.repeatability = repeated;
        CHECK_OK(imk_calibrate_log_create(1, &procedure, &s, NULL, &session, &error));
        assert_int_equal(imk_calibrate_plan_settings(session, &plan, &error),
                         IMK_ERROR_UNSUPPORTED);
        assert_non_null(strstr(error.found, repeated ? "repeatability" : "magnetometer"));
        imk_calibrate_log_free(session);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_read),
        cmocka_unit_test(test_refused),
        cmocka_unit_test(test_settings),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
