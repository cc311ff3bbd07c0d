/* SPDX-License-Identifier: Apache-2.0 */
/* The numbers that a page holds beside its figures: those of the drawing, as JSON that a script can
 * read, whatever stands in the texts. */
#include "check.h"

#include "imukit/model.h"
#include "imukit/noise.h"
#include "report/figure_internal.h"
#include "report/markup_internal.h"
#include "report/page_internal.h"

#include <jansson.h>
#include <stdlib.h>
#include <string.h>

enum { POINTS = 5 };
static double x[POINTS] = {1, 2, 3, 4, 5};

static json_t *read_text(imki_text *made)
{
    size_t size;
    char *text = imki_text_take(made, &size);
    json_error_t error;
    assert_non_null(text);
    assert_int_equal(strlen(text), size);
    json_t *json = json_loads(text, 0, &error);
    if (!json)
        fail_msg("%s at %d of %s", error.text, error.position, text);
    free(text);
    return json;
}

static json_t *data_of(const imk_panel *panel)
{
    imki_text made = {.bytes = NULL};
    imki_panel_data(&made, panel, true);
    return read_text(&made);
}

static json_t *curve_of(json_t *data, size_t index)
{
    return json_array_get(json_object_get(data, "curves"), index);
}

/* The numbers of a curve's points, NaN for null. */
static size_t numbers_of(json_t *data, size_t index, double *values, size_t room)
{
    json_t *points = json_object_get(curve_of(data, index), "points");
    const size_t count = json_array_size(points);
    assert_true(count <= room);
    for (size_t i = 0; i < count; i++) {
        const json_t *one = json_array_get(points, i);
        values[i] = json_is_null(one) ? (double)NAN : json_number_value(one);
    }
    return count;
}

static void check_numbers(json_t *data, size_t index, int width, const double *expected,
                          size_t count)
{
    double found[40];
    assert_int_equal(json_integer_value(json_object_get(curve_of(data, index), "width")), width);
    assert_int_equal(numbers_of(data, index, found, 40), count);
    for (size_t i = 0; i < count; i++)
        assert_true(isnan(expected[i]) ? isnan(found[i]) : found[i] == expected[i]);
}

/* Each style has the numbers that it is drawn with; a gap is a point of nulls. */
static void test_styles(void **state)
{
    (void)state;
    const double gap = (double)NAN;
    double y[POINTS] = {1, 4, gap, 16, 25}, low[POINTS] = {0, 3, 8, 15, 24},
           high[POINTS] = {2, 5, gap, 17, 26};
    const imk_curve curves[] = {{"line", IMK_CURVE_LINE, 0, POINTS, x, y, NULL, NULL},
                                {"points", IMK_CURVE_POINTS, 1, POINTS, x, y, NULL, NULL},
                                {"bars", IMK_CURVE_POINTS, 2, POINTS, x, y, low, high},
                                {"", IMK_CURVE_BAND, -1, POINTS, x, y, low, high}};
    const imk_panel panel = {
        .title = "t", .x_label = "x", .y_label = "y", .curve_count = 4, .curves = curves};
    json_t *data = data_of(&panel);
    check_numbers(data, 0, 2, (double[]){1, 1, 2, 4, gap, gap, 4, 16, 5, 25}, 10);
    check_numbers(data, 1, 2, (double[]){1, 1, 2, 4, 4, 16, 5, 25}, 8);
    check_numbers(data, 2, 4, (double[]){1, 1, 0, 2, 2, 4, 3, 5, 4, 16, 15, 17, 5, 25, 24, 26}, 16);
    check_numbers(data, 3, 3, (double[]){1, 0, 2, 2, 3, 5, gap, gap, gap, 4, 15, 17, 5, 24, 26},
                  15);
    assert_int_equal(json_integer_value(json_object_get(curve_of(data, 3), "color")), 7);
    assert_true(json_is_true(json_object_get(curve_of(data, 2), "bars")));
    const json_t *axis = json_object_get(data, "x");
    imki_axis across, along;
    imki_panel_axes(&panel, &across, &along);
    assert_true(json_number_value(json_object_get(axis, "low")) == across.low);
    assert_true(json_number_value(json_object_get(axis, "high")) == across.high);
    assert_true(json_is_false(json_object_get(axis, "log")));
    json_decref(data);
}

/* What has a band in its colour without a name has its intervals, without bars. */
static void test_intervals(void **state)
{
    (void)state;
    const double gap = (double)NAN;
    double y[POINTS] = {1, 4, gap, 16, 25}, low[POINTS] = {0, 3, 8, 15, 24},
           high[POINTS] = {2, 5, 10, 17, 26};
    const imk_curve curves[] = {{"", IMK_CURVE_BAND, 2, POINTS, x, y, low, high},
                                {"", IMK_CURVE_BAND, 3, POINTS - 1, x, y, low, high},
                                {"line", IMK_CURVE_LINE, 2, POINTS, x, y, NULL, NULL},
                                {"points", IMK_CURVE_POINTS, 2, POINTS, x, y, NULL, NULL},
                                {"other", IMK_CURVE_POINTS, 3, POINTS, x, y, NULL, NULL}};
    const imk_panel panel = {
        .title = "t", .x_label = "x", .y_label = "y", .curve_count = 5, .curves = curves};
    json_t *data = data_of(&panel);
    check_numbers(
        data, 2, 4,
        (double[]){1, 1, 0, 2, 2, 4, 3, 5, gap, gap, gap, gap, 4, 16, 15, 17, 5, 25, 24, 26}, 20);
    check_numbers(data, 3, 4, (double[]){1, 1, 0, 2, 2, 4, 3, 5, 4, 16, 15, 17, 5, 25, 24, 26}, 16);
    check_numbers(data, 4, 2, (double[]){1, 1, 2, 4, 4, 16, 5, 25}, 8);
    assert_true(json_is_false(json_object_get(curve_of(data, 3), "bars")));
    json_decref(data);
}

/* Seven digits, and a millionth of an axis that begins far from zero. */
static void test_digits(void **state)
{
    (void)state;
    double y[POINTS], expected[2 * POINTS];
    for (int i = 0; i < POINTS; i++) {
        y[i] = 9.80665 + 1.23456789e-7 * i;
        expected[2 * i] = x[i];
        expected[2 * i + 1] = y[i];
    }
    const imk_curve curve = {"", IMK_CURVE_LINE, 0, POINTS, x, y, NULL, NULL};
    imk_panel panel = {
        .title = "", .x_label = "", .y_label = "", .curve_count = 1, .curves = &curve};
    double found[2 * POINTS];
    json_t *data = data_of(&panel);
    assert_int_equal(numbers_of(data, 0, found, 2 * POINTS), 2 * POINTS);
    for (int i = 0; i < 2 * POINTS; i++)
        CHECK_CLOSE(found[i], expected[i], 1e-6 * (y[4] - y[0]));
    json_decref(data);
    for (int i = 0; i < POINTS; i++)
        y[i] = 1.23456789e-7 * (i + 1);
    panel.y_logarithmic = true;
    data = data_of(&panel);
    numbers_of(data, 0, found, 2 * POINTS);
    for (int i = 0; i < POINTS; i++)
        CHECK_CLOSE(found[2 * i + 1], y[i], 1e-7 * y[i]);
    json_decref(data);
}

/* A million points are those of the drawing. */
static void test_a_million_points(void **state)
{
    (void)state;
    const size_t count = 1000000;
    double *many = malloc(2 * count * sizeof *many);
    for (size_t i = 0; i < count; i++) {
        many[i] = (double)i;
        many[count + i] = (double)(i * 7919 % 1000);
    }
    imk_curve curve = {"", IMK_CURVE_LINE, 0, count, many, many + count, NULL, NULL};
    const imk_panel panel = {
        .title = "", .x_label = "", .y_label = "", .curve_count = 1, .curves = &curve};
    for (int style = 0; style < 2; style++) {
        imki_text made = {.bytes = NULL};
        curve.style = style == 0 ? IMK_CURVE_LINE : IMK_CURVE_POINTS;
        imki_panel_data(&made, &panel, false);
        assert_true(made.size < 400000);
        json_t *data = read_text(&made);
        const size_t kept = json_array_size(json_object_get(curve_of(data, 0), "points"));
        assert_true(kept > 1000 && kept <= 2 * IMKI_CURVE_POINTS_MAX);
        json_decref(data);
    }
    free(many);
}

/* No text ends the element that holds it, and what is not UTF-8 is replaced. */
static void test_texts(void **state)
{
    (void)state;
    const imk_curve curve = {
        "</script><b>\"\\\x01\xff", IMK_CURVE_LINE, 0, POINTS, x, x, NULL, NULL};
    const imk_region region = {
        .label = "<!--", .x_low = 1, .x_high = HUGE_VAL, .y_low = 1, .y_high = 2};
    const imk_panel panel = {.title = "",
                             .x_label = "",
                             .y_label = "rate [no unit]",
                             .curve_count = 1,
                             .curves = &curve,
                             .region_count = 1,
                             .regions = &region,
                             .allan_deviation = true};
    imki_text made = {.bytes = NULL}, script = {.bytes = NULL};
    imki_panel_data(&made, &panel, true);
    imki_markup_data(&script, made.bytes);
    assert_null(strchr(script.bytes, '<'));
    json_t *data = read_text(&script);
    free(made.bytes);
    assert_string_equal(json_string_value(json_object_get(curve_of(data, 0), "label")),
                        "</script><b>\"\\\x01\xef\xbf\xbd");
    const json_t *drawn = json_array_get(json_object_get(data, "regions"), 0);
    assert_string_equal(json_string_value(json_object_get(drawn, "label")), "<!--");
    assert_true(json_is_null(json_array_get(json_object_get(drawn, "limits"), 1)));
    assert_null(json_object_get(data, "unit"));
    json_decref(data);
}

static void test_unit(void **state)
{
    (void)state;
    const imk_curve curve = {"", IMK_CURVE_LINE, 0, POINTS, x, x, NULL, NULL};
    const imk_panel panel = {.title = "",
                             .x_label = "averaging time [s]",
                             .y_label = "Allan deviation [ug]",
                             .curve_count = 1,
                             .curves = &curve,
                             .allan_deviation = true};
    json_t *data = data_of(&panel), *unit = json_object_get(data, "unit");
    assert_string_equal(json_string_value(json_object_get(unit, "si")), "m/s^2");
    CHECK_CLOSE(json_number_value(json_object_get(unit, "scale")), 9.80665e-6, 1e-20);
    json_decref(data);
}

/* The curves of the catalogue are those of the terms of its models. */
static void test_catalogue(void **state)
{
    (void)state;
    imki_text made = {.bytes = NULL};
    imki_catalogue_data(&made);
    assert_true(made.size < 60000); /* each page with Allan deviations has it */
    json_t *data = read_text(&made), *sensors = json_object_get(data, "sensors");
    json_t *times = json_object_get(data, "tau");
    assert_int_equal(json_array_size(sensors), imk_device_count());
    for (size_t d = 0; d < imk_device_count(); d++) {
        json_t *sensor = json_array_get(sensors, d), *curve = json_object_get(sensor, "rad/s");
        imk_model model;
        imk_device_model(imk_device_get(d), &model);
        assert_string_equal(json_string_value(json_object_get(sensor, "name")),
                            imk_device_get(d)->name);
        const imk_noise *noise = &model.gyro.noise;
        if (!curve || noise->gauss_markov_count > 0 || noise->sinusoid_count > 0)
            continue;
        for (size_t i = 16; i < json_array_size(times); i += 8) { /* from 10 s */
            const double tau = json_number_value(json_array_get(times, i));
            double most = 0;
            for (int axis = 0; axis < model.gyro.axis_count; axis++)
                most =
                    fmax(most,
                         imk_white_allan_variance(noise->white.value[axis], tau) +
                             imk_flicker_allan_variance(noise->bias_instability.value[axis], tau) +
                             imk_random_walk_allan_variance(noise->random_walk.value[axis], tau) +
                             imk_ramp_allan_variance(noise->ramp.value[axis], tau) +
                             imk_quantization_allan_variance(noise->quantization.value[axis], tau));
            /* The flicker noise of a sensor is not infinitely slow, and its stages leave a ripple.
             */
            CHECK_CLOSE(json_number_value(json_array_get(curve, i)), sqrt(most), 0.03 * sqrt(most));
        }
    }
    json_decref(data);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_styles),    cmocka_unit_test(test_intervals),
        cmocka_unit_test(test_digits),    cmocka_unit_test(test_a_million_points),
        cmocka_unit_test(test_texts),     cmocka_unit_test(test_unit),
        cmocka_unit_test(test_catalogue),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
