/* SPDX-License-Identifier: Apache-2.0 */
/* imukit grade: classes by biases and by computed positions, claims beside figures, maps. */
#include "run_command.h"

#include <math.h>

static const double mile = 1852;
static json_t *document;

static json_t *models_of(const char *line)
{
    json_error_t problem;
    if (run(line) != 0)
        fail_msg("%s: %s", line, err);
    document = json_loads(out, 0, &problem);
    if (!document)
        fail_msg("%s: %s", problem.text, out);
    return json_object_get(json_object_get(document, "result"), "models");
}

static const char *word(json_t *object, const char *key)
{
    const char *text = json_string_value(json_object_get(object, key));
    return text ? text : "null";
}

static json_t *way_of(json_t *models, size_t index, const char *way)
{
    return json_object_get(json_object_get(json_array_get(models, index), "position"), way);
}

static double cep(json_t *way, size_t time)
{
    json_t *figures = json_array_get(json_object_get(way, "times"), time);
    json_t *value = json_object_get(json_object_get(figures, "cep"), "value");
    return json_is_number(value) ? json_number_value(value) : (double)NAN;
}

/* Biases at the limits of the classes and nothing else: the known table (models of the theory page;
 * independent arithmetic on a sphere, 1.5 % from the ellipsoid; three digits). Strategic by its
 * biases is not strategic by performance: its claim needs less than its limits. */
static void test_classes_at_their_limits(void **state)
{
    (void)state;
    static const struct {
        const char *model, *by_bias, *by_position;
        double cep[3]; /* [m] */
    } k[] = {{"gyro: {bias: {repeatability: 0.00499 deg/h}}\n"
              "accel: {bias: {repeatability: 29.9 ug}}\n",
              "strategic",
              "navigation",
              {0.62, 0.455 * 1852, 3.45 * 1852}},
             {"gyro: {bias: {repeatability: 0.01 deg/h}}\naccel: {bias: {repeatability: 50 ug}}\n",
              "navigation",
              "navigation",
              {1.04, 0.895 * 1852, 6.90 * 1852}},
             {"gyro: {bias: {repeatability: 1 deg/h}}\naccel: {bias: {repeatability: 1 mg}}\n",
              "tactical",
              "tactical",
              {20.9, 86 * 1852, (double)NAN}}};
    for (size_t i = 0; i < sizeof k / sizeof k[0]; i++) {
        if (check_skips(i, 3))
            continue;
        char text[300];
        snprintf(text, sizeof text, "imukit: 1\n%s", k[i].model);
        put("limits.yaml", text);
        json_t *models = models_of("$I grade limits.yaml --json");
        json_t *given = way_of(models, 0, "given");
        assert_string_equal(word(json_array_get(models, 0), "overall"), k[i].by_bias);
        assert_string_equal(word(given, "class"), k[i].by_position);
        for (size_t t = 0; t < 3; t++) {
            if (isnan(k[i].cep[t]))
                assert_true(isnan(cep(given, t))); /* beyond a tenth of the Earth's radius */
            else
                CHECK_RELATIVE(cep(given, t), k[i].cep[t], 0.03);
        }
        json_decref(document);
    }
    sweep();
}

/* The presets are made so that the claims of their classes hold for the whole. */
static void test_presets_meet_their_claims(void **state)
{
    (void)state;
    static const char *const names[] = {"strategic", "navigation", "tactical", "null", "null"};
    json_t *models = models_of("$I grade strategic navigation tactical AHRS control --json");
    assert_string_equal(err, "");
    for (size_t i = 0; i < 5; i++)
        assert_string_equal(word(way_of(models, i, "given"), "class"), names[i]);
    assert_true(cep(way_of(models, 0, "given"), 2) <= mile);
    assert_true(cep(way_of(models, 1, "given"), 1) <= mile);
    json_decref(document);
    sweep();
}

/* What is known and taken out makes a better unit; the way it says what the next class needs is
 * true: the terms named, made so many times better, reach it. */
static void test_needs_are_enough(void **state)
{
    (void)state;
    put("a.yaml", "imukit: 1\ngyro: {bias: {repeatability: 0.03 deg/h}}\n"
                  "accel: {bias: {repeatability: 40 ug}}\n");
    json_t *models = models_of("$I grade a.yaml --json");
    json_t *next = json_object_get(json_object_get(json_array_get(models, 0), "position"), "next");
    assert_string_equal(word(next, "class"), "navigation");
    json_t *need = json_array_get(json_object_get(next, "terms"), 0);
    assert_int_equal(json_array_size(json_object_get(next, "terms")), 1);
    assert_string_equal(word(need, "term"), "gyro bias repeatability");
    const double times = json_number_value(json_object_get(need, "times_better"));
    json_decref(document);
    char text[200];
    /* A part in a thousand to either side of the border. */
    for (int side = -1; side <= 1; side += 2) {
        snprintf(text, sizeof text,
                 "imukit: 1\ngyro: {bias: {repeatability: %.9f deg/h}}\n"
                 "accel: {bias: {repeatability: 40 ug}}\n",
                 0.03 / times * (1 + 1e-3 * side));
        put("b.yaml", text);
        models = models_of("$I grade b.yaml --json");
        assert_string_equal(word(way_of(models, 0, "given"), "class"),
                            side < 0 ? "navigation" : "tactical");
        json_decref(document);
    }
    sweep();
}

static void test_compensation(void **state)
{
    (void)state;
    put("a.yaml", "imukit: 1\ngyro: {bias: {fixed: 1 ± 0.005 deg/h}}\n"
                  "accel: {bias: {fixed: 1 ± 0.03 mg}}\n");
    json_t *models = models_of("$I grade a.yaml --json");
    assert_string_equal(word(way_of(models, 0, "given"), "class"), "tactical");
    assert_string_equal(word(way_of(models, 0, "given_compensated"), "class"), "navigation");
    json_decref(document);
    assert_int_equal(run("$I grade a.yaml"), 0);
    check_contains(out, "\nperfect start, compensated ", out);
    check_contains(out, "scatter but a shift by known values; compensation takes it out\n", out);
    sweep();
}

/* ---- words ---- */

static void test_claims_beside_figures(void **state)
{
    (void)state;
    assert_int_equal(run("$I grade navigation"), 0);
    check_contains(out, "navigation: navigation\nGyro: navigation; remaining bias ", out);
    check_contains(out, "\nPosition: navigation; CEP 0.7", out);
    check_contains(out, "nmi, met  0.01, met     RLG, FOG ", out);
    check_contains(out, "\nFor strategic (1 nmi / 24 h) every term would have to be ", out);
    check_contains(out, "at rest at 45 deg N", out);
    assert_int_equal(run("$I grade control"), 0);
    check_contains(out, "no position any more after 1 h", out);
    check_contains(out, "no north", out);
    assert_null(strstr(out, "nan"));
    assert_null(strstr(out, "inf "));
    assert_int_equal(run("$I grade ADIS16465"), 0);
    check_contains(out, "states no run-to-run bias of its gyros and accelerometers", out);
    sweep();
}

static void test_parts_of_a_unit(void **state)
{
    (void)state;
    put("g.yaml", "imukit: 1\ngyro: {bias: {repeatability: 0.01 deg/h}}\n");
    assert_int_equal(run("$I grade g.yaml"), 0);
    check_contains(out, "Position: not computed; the model has no accelerometers\n", out);
    assert_null(strstr(out, "CEP after"));
    json_t *models = models_of("$I grade g.yaml --json");
    assert_true(json_is_null(json_object_get(json_array_get(models, 0), "position")));
    json_decref(document);
    put("one.yaml", "imukit: 1\ngyro: {direction: [1 0 0], bias: {repeatability: 1 deg/h}}\n"
                    "accel: {bias: {repeatability: 1 mg}}\n");
    assert_int_equal(run("$I grade one.yaml"), 0);
    check_contains(out, "Position: not computed; a position needs three gyros and three acc", out);
    /* Without a stated bias there is a position still, and no class by the table. */
    models = models_of("$I grade 'Groves aviation' --json");
    assert_string_equal(word(json_array_get(models, 0), "overall"), "null");
    assert_true(cep(way_of(models, 0, "given"), 1) > 0);
    json_decref(document);
    check_message("$I grade g.yaml --map cost", 2,
                  "imukit grade: error: --map selects a drawing; add --plot FILE.svg\nTry: imukit "
                  "grade --help\n");
    sweep();
}

/* ---- maps ---- */

static void test_maps(void **state)
{
    (void)state;
    assert_int_equal(run("$I grade tactical HG1700 --plot m.svg --report r.html"), 0);
    read_text("m.svg", out);
    check_contains(out, "aircraft, survey", "map");
    check_contains(out, "HG1700, scale factor not stated", "map");
    check_contains(out, "cost of a unit [dollars]", "map");
    read_text("r.html", out);
    check_contains(out, "[ELSHEIMY2020] table 1", "page");
    check_contains(out, "[YAZDI1998] table 1", "page");
    check_contains(out, "Comparison", "page");
    put("g.yaml", "imukit: 1\ngyro: {bias: {repeatability: 0.01 deg/h}}\n");
    assert_int_equal(run("$I grade g.yaml --map cost --plot c.svg"), 1);
    check_contains(err, "--map: the model has no value for this map", err);
    assert_int_equal(access("c.svg", F_OK), -1);
    if (imk_plot_available()) {
        assert_int_equal(run("$I grade tactical --plot term"), 0);
        check_contains(out, "stability of the scale factor [ppm]", "term");
    }
    sweep();
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_classes_at_their_limits),
                                       cmocka_unit_test(test_presets_meet_their_claims),
                                       cmocka_unit_test(test_needs_are_enough),
                                       cmocka_unit_test(test_compensation),
                                       cmocka_unit_test(test_claims_beside_figures),
                                       cmocka_unit_test(test_parts_of_a_unit),
                                       cmocka_unit_test(test_maps)};
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
