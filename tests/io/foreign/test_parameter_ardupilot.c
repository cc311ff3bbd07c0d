/* SPDX-License-Identifier: Apache-2.0 */
/* ArduPilot's parameters: its equation by hand, and that writing loses nothing but what is said. */
#include "check.h"

#include "imukit/io.h"
#include "imukit/parameter_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static imk_model model, back;
static imk_parameter_notes notes;
static char message[1000];

static imk_status read_text(const char *text, const char *sensor)
{
    imk_error error = {.status = IMK_OK};
    imk_parameter_settings settings = imk_parameter_default();
    settings.sensor = sensor;
    const imk_status status =
        imk_parameters_parse(text, strlen(text), &settings, &model, &notes, &error);
    message[0] = '\0';
    if (status != IMK_OK)
        imk_error_text(&error, "f", message, sizeof message);
    return status;
}

static bool has_note(bool lost, const char *part)
{
    for (size_t i = 0; i < notes.count; i++)
        if (notes.note[i].lost == lost && strstr(notes.note[i].text, part))
            return true;
    return false;
}

static const char vehicle[] = "# Vehicle\n"
                              "INS_ACCOFFS_X,0.12\n"
                              "INS_ACCOFFS_Y -0.05\n"
                              "INS_ACCOFFS_Z=0.5\n"
                              "INS_ACCSCAL_X,0.8\n"
                              "INS_ACCSCAL_Y,1\n"
                              "INS_ACCSCAL_Z,1\n"
                              "INS_ACC1_CALTEMP,45\n"
                              "INS_GYROFFS_Z,0.01\n"
                              "INS_TCAL1_ENABLE,1\n"
                              "INS_TCAL1_TMIN,-10\n"
                              "INS_TCAL1_TMAX,60\n"
                              "INS_TCAL1_ACC1_X,2000\n"
                              "INS_TCAL1_ACC2_X,-30\n"
                              "INS_TCAL1_ACC3_X,5\n"
                              "INS_TCAL1_GYR1_Y,100\n"
                              "INS_ACC2OFFS_X,0\n"
                              "INS_ACC2SCAL_X,1\n"
                              "SERVO1_MIN,1000\n";

/* p(T) of the file, 1e-6 (2000 d - 30 d^2 + 5 d^3) from 35 degC, T clipped. */
static double thermal(double celsius)
{
    const double d = fmin(fmax(celsius, -10), 60) - 35;
    return 1e-6 * (2000 * d - 30 * d * d + 5 * d * d * d);
}

/* The bias of an axis at a temperature, by the model. */
static double bias_at(const imk_triad *triad, int axis, double celsius)
{
    const imk_temperature_polynomial *t = &triad->bias.temperature;
    const double kelvins = fmin(fmax(celsius + 273.15, t->minimum), t->maximum);
    double sum = 0;
    for (int k = t->order - 1; k >= 0; k--)
        sum = (sum + t->coefficient[k].value[axis]) * (kelvins - t->reference);
    return triad->bias.fixed.value[axis] + (t->order > 0 ? sum : 0);
}

static void test_reading(void **state)
{
    (void)state;
    CHECK_OK(read_text(vehicle, NULL));
    /* corrected = (reading - p(T) + p(45) - 0.12) 0.8: forward bias 0.12 + p(T) - p(45),
     * scale 1.25. Re-expansion about 45 degC costs some roundings of numbers near 0.1. */
    for (double celsius = -30; celsius <= 80; celsius += 5)
        CHECK_CLOSE(bias_at(&model.accel, 0, celsius), 0.12 + thermal(celsius) - thermal(45),
                    1e-15);
    CHECK_CLOSE(model.accel.scale_factor.fixed.value[0], 0.25, 1e-15);
    CHECK_CLOSE(model.accel.bias.fixed.value[1], -0.05, 0);
    CHECK_CLOSE(model.accel.bias.fixed.value[2], 0.5, 0);
    CHECK_CLOSE(model.gyro.bias.fixed.value[2], 0.01, 0);
    /* CALTEMP of the gyros was never set: -300 degC, clipped to -10. */
    assert_int_equal(model.gyro.bias.temperature.order, 1);
    CHECK_CLOSE(bias_at(&model.gyro, 1, 40), 1e-4 * 50, 1e-17);
    CHECK_OK(read_text("INS_TCAL1_ENABLE,0\nINS_TCAL1_ACC1_X,10\nINS_ACCOFFS_X,1\n", NULL));
    assert_int_equal(model.accel.bias.temperature.order, 0);
    assert_true(has_note(true, "INS_TCAL1_ENABLE is 0"));
    assert_false(model.gyro.present);
    CHECK_OK(read_text("INS_TCAL1_ACC1_X,10\n", NULL));
    assert_true(has_note(false, "INS_TCAL1_ENABLE is not in the file"));
}

static void test_refusals(void **state)
{
    (void)state;
    static const char two[] = "INS_ACCOFFS_X,0.1\nINS_ACC2OFFS_X,0.2\nINS_GYR2OFFS_X,0.01\n";
    CHECK_STATUS(read_text(two, NULL), IMK_ERROR_KEY_MISSING);
    assert_non_null(strstr(message, "add --sensor NUMBER with one of 1, 2"));
    CHECK_OK(read_text(two, "2"));
    CHECK_CLOSE(model.accel.bias.fixed.value[0], 0.2, 0);
    CHECK_CLOSE(model.gyro.bias.fixed.value[0], 0.01, 0);
    CHECK_STATUS(read_text(two, "3"), IMK_ERROR_NAME_UNKNOWN);
    CHECK_STATUS(read_text("INS_ACCOFFS_X,abc\n", NULL), IMK_ERROR_SYNTAX);
    assert_string_equal(message,
                        "f:1:15: INS_ACCOFFS_X: \"abc\" cannot be read; expected a finite number");
    CHECK_STATUS(read_text("INS_ACCSCAL_X,0\n", NULL), IMK_ERROR_RANGE);
    CHECK_STATUS(read_text("INS_TCAL1_ACC1_X,1\nINS_TCAL1_TMIN,80\n", NULL), IMK_ERROR_RANGE);
    CHECK_STATUS(read_text("INS_ACC_BODYFIX,2\n", NULL), IMK_ERROR_KEY_MISSING);
}

/* A model with a polynomial of some order, read back as it was written. */
static void write_and_read(int order)
{
    imk_parameter_settings settings = imk_parameter_default();
    imk_triad *triads[2] = {&back.gyro, &back.accel};
    imk_error error;
    char *text = NULL;
    size_t size = 0;
    double power = 1;
    imk_model_default(&back);
    for (int sensor = 0; sensor < 2; sensor++) {
        imk_temperature_polynomial *t = &triads[sensor]->bias.temperature;
        *t = (imk_temperature_polynomial){
            .order = order, .reference = 298.15, .minimum = 253.15, .maximum = 343.15};
        power = 1;
        for (int i = 0; i < 3; i++)
            triads[sensor]->bias.fixed.value[i] = 0.1 * (i + 1);
        for (int k = 0; k < order; k++, power *= 40)
            for (int i = 0; i < 3; i++)
                t->coefficient[k].value[i] = 1e-3 * (i + 1) / power;
    }
    back.accel.scale_factor.fixed.value[1] = 0.01;
    back.accel.misalignment.value[0][1] = 1e-3;
    settings.format = IMK_PARAMETERS_ARDUPILOT;
    CHECK_OK(imk_parameters_print(NULL, &settings, &back, &text, &size, &notes, &error));
    const imk_parameter_notes kept = notes;
    CHECK_OK(read_text(text, NULL));
    notes = kept;
    free(text);
}

static void test_writing(void **state)
{
    (void)state;
    for (int order = 0; order <= 3; order++) {
        write_and_read(order);
        for (int axis = 0; axis < 3; axis++)
            for (double celsius = -30; celsius <= 80; celsius += 10) {
                CHECK_CLOSE(bias_at(&model.accel, axis, celsius),
                            bias_at(&back.accel, axis, celsius), 1e-14);
                CHECK_CLOSE(bias_at(&model.gyro, axis, celsius), bias_at(&back.gyro, axis, celsius),
                            1e-14);
            }
        CHECK_CLOSE(model.accel.scale_factor.fixed.value[1], 0.01, 1e-15);
        assert_true(has_note(true, "accel.misalignment is not held"));
        assert_true(has_note(false, "INS_GYROFFS_X"));
        assert_false(has_note(true, "bias.temperature"));
    }
}

/* Beyond the third order the cubic is as near as the note says, to its two digits, and what is left
 * is not far from the smallest possible: of d^5 40^-4 1e-3 3 over half a width of 45 K, the fourth
 * and fifth Chebyshev terms. */
static void test_higher_orders(void **state)
{
    (void)state;
    write_and_read(5);
    double worst = 0, stated = 0;
    for (double celsius = -20; celsius <= 70; celsius += 0.25)
        for (int axis = 0; axis < 3; axis++)
            worst = fmax(worst, fabs(bias_at(&model.accel, axis, celsius) -
                                     bias_at(&back.accel, axis, celsius)));
    assert_true(has_note(true, "accel.bias.temperature: ArduPilot has cubic"));
    for (size_t i = 0; i < notes.count; i++) {
        const char *at = strstr(notes.note[i].text, "accel.bias.temperature: ArduPilot has cubic");
        if (at)
            assert_int_equal(sscanf(strstr(at, "up to"), "up to %lf", &stated), 1);
    }
    CHECK_RELATIVE(worst, stated, 0.05);
    /* 3e-3 times (45^5/40^4/16 + the same of d^4 and what d^5 gives to it, below a third as much).
     */
    CHECK_BELOW(worst, 3e-3 * 45 * (pow(45.0 / 40, 4) / 16 + pow(45.0 / 40, 3) / 8) * 1.5);
}

/* One range for both sensors: what they have in common; without any, refused. */
static void test_ranges(void **state)
{
    (void)state;
    imk_parameter_settings settings = imk_parameter_default();
    imk_error error;
    char *text = NULL;
    size_t size = 0;
    write_and_read(1);
    settings.format = IMK_PARAMETERS_ARDUPILOT;
    back.gyro.bias.temperature.minimum = 263.15;
    CHECK_OK(imk_parameters_print(NULL, &settings, &back, &text, &size, &notes, &error));
    assert_non_null(strstr(text, "INS_TCAL1_TMIN,-10\n"));
    assert_true(has_note(true, "accel.bias.temperature is held only in part"));
    free(text);
    back.gyro.bias.temperature.minimum = 350;
    back.gyro.bias.temperature.maximum = 360;
    CHECK_STATUS(imk_parameters_print(NULL, &settings, &back, &text, &size, &notes, &error),
                 IMK_ERROR_UNSUPPORTED);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_reading), cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_writing), cmocka_unit_test(test_higher_orders),
        cmocka_unit_test(test_ranges),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
