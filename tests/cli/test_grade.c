/* SPDX-License-Identifier: Apache-2.0 */
/* imukit grade: classes by biases and by computed positions, claims beside figures, maps. */
#include "run_command.h"

#include "imukit/technology_map.h"

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

/* A model of run-to-run biases, its other terms stated to be 0. */
static void put_biases(const char *path, const char *gyro, const char *accel)
{
    char text[1500];
    snprintf(text, sizeof text,
             "imukit: 1\ngyro: {bias: {repeatability: %s}, " NO_OTHER_GYRO_TERM "}\n"
             "accel: {bias: {repeatability: %s}, " NO_OTHER_ACCEL_TERM "}\n",
             gyro, accel);
    put(path, text);
}

/* Biases at the limits of the classes and nothing else: the known table (models of the theory page;
 * independent arithmetic on a sphere, 1.5 % from the ellipsoid; three digits). Strategic by its
 * biases is not strategic by performance: its claim needs less than its limits. */
static void test_classes_at_their_limits(void **state)
{
    (void)state;
    static const struct {
        const char *gyro, *accel, *by_bias, *by_position;
        double cep[3]; /* [m] */
    } k[] = {
        {"0.00499 deg/h", "29.9 ug", "strategic", "navigation", {0.62, 0.455 * 1852, 3.45 * 1852}},
        {"0.01 deg/h", "50 ug", "navigation", "navigation", {1.04, 0.895 * 1852, 6.90 * 1852}},
        {"1 deg/h", "1 mg", "tactical", "tactical", {20.9, 86 * 1852, (double)NAN}}};
    for (size_t i = 0; i < sizeof k / sizeof k[0]; i++) {
        if (check_skips(i, 3))
            continue;
        put_biases("limits.yaml", k[i].gyro, k[i].accel);
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
    if (check_quick()) /* figures alone differ */
        return;
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
    put_biases("a.yaml", "0.03 deg/h", "40 ug");
    json_t *models = models_of("$I grade a.yaml --json");
    json_t *next = json_object_get(json_object_get(json_array_get(models, 0), "position"), "next");
    assert_string_equal(word(next, "class"), "navigation");
    json_t *need = json_array_get(json_object_get(next, "terms"), 0);
    assert_int_equal(json_array_size(json_object_get(next, "terms")), 1);
    assert_string_equal(word(need, "term"), "gyro bias repeatability");
    const double times = json_number_value(json_object_get(need, "times_better"));
    json_decref(document);
    char text[40];
    /* A part in a thousand to either side of the border. */
    for (int side = -1; side <= 1; side += 2) {
        snprintf(text, sizeof text, "%.9f deg/h", 0.03 / times * (1 + 1e-3 * side));
        put_biases("b.yaml", text, "40 ug");
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
    put("a.yaml",
        "imukit: 1\n"
        "gyro: {bias: {fixed: 1 ± 0.005 deg/h, repeatability: 0 deg/h}, " NO_OTHER_GYRO_TERM "}\n"
        "accel: {bias: {fixed: 1 ± 0.03 mg, repeatability: 0 mg}, " NO_OTHER_ACCEL_TERM "}\n");
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
    check_contains(out, "nmi, met  0.01, met     floated, DTG, RLG, FOG ", out);
    check_contains(out, "\nFor strategic (1 nmi / 24 h) every term would have to be ", out);
    check_contains(out, "at rest at 45 deg N", out);
    if (check_quick()) { /* the rest goes the same way */
        sweep();
        return;
    }
    assert_int_equal(run("$I grade control"), 0);
    check_contains(out, "no position any more after 1 h", out);
    check_contains(out, "no north", out);
    assert_null(strstr(out, "nan"));
    assert_null(strstr(out, "inf "));
    assert_int_equal(run("$I grade ADIS16465"), 0);
    check_contains(out, "ADIS16465: at best AHRS; not stated: gyro run-to-run bias, acc", out);
    assert_null(strstr(out, ", met"));
    sweep();
}

static void test_parts_of_a_unit(void **state)
{
    (void)state;
    put("g.yaml", "imukit: 1\ngyro: {bias: {repeatability: 0.01 deg/h}}\n");
    assert_int_equal(run("$I grade g.yaml"), 0);
    check_contains(out, "Position: not computed; the model has no accelerometers (imukit join ",
                   out);
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
    check_contains(out, "floated", "map");
    check_contains(out, "DTG", "map");
    check_contains(out, "price of a whole unit [US dollars]", "map");
    check_contains(out, "price of one gyro [US dollars]", "map");
    read_text("r.html", out);
    check_contains(out, "[ELSHEIMY2020] table 1", "page");
    check_contains(out, "[YAZDI1998] table 1", "page");
    check_contains(out, "from memory, each within a factor of 10", "page");
    check_contains(out, "undated", "page");
    check_contains(out, "Comparison", "page");
    put("a.yaml", "imukit: 1\naccel: {bias: {repeatability: 1 mg}}\n");
    assert_int_equal(run("$I grade a.yaml --map cost --plot c.svg"), 1);
    check_contains(err, "--map: the model has no value for this map", err);
    assert_int_equal(access("c.svg", F_OK), -1);
    if (imk_plot_available("term")) {
        assert_int_equal(run("$I grade tactical --plot term"), 0);
        check_contains(out, "stability of the scale factor [ppm]", "term");
    }
    sweep();
}

/* White noise N has the Allan deviation N / sqrt(tau): 0.3 deg/sqrt(h) is 0.3 * 60 = 18 deg/h at 1
 * s. The worst axis is drawn. */
static void test_noise_is_drawn(void **state)
{
    (void)state;
    put("n.yaml", "imukit: 1\n"
                  "gyro: {bias: {repeatability: 1 deg/h},"
                  " noise: {angle_random_walk: 0.1 0.3 0.2 deg/sqrt(h)}}\n"
                  "accel: {bias: {repeatability: 1 mg}}\n");
    assert_int_equal(run("$I grade n.yaml --report r.html"), 0);
    read_text("r.html", out);
    check_contains(out, "<h2>Noise</h2>", "page");
    check_contains(out, ",1,18,", "page");
    assert_null(strstr(out, "\"title\":\"accelerometers\""));
    put("n.yaml", "imukit: 1\naccel: {bias: {repeatability: 1 mg}}\n");
    assert_int_equal(run("$I grade n.yaml --report r.html"), 0);
    read_text("r.html", out);
    assert_null(strstr(out, "<h2>Noise</h2>"));
    sweep();
}

/* A unit's price and a sensor's are never in one figure. */
static void test_prices_are_apart(void **state)
{
    (void)state;
    if (check_quick()) /* drawn by the same code as the maps above */
        return;
    assert_int_equal(run("$I grade tactical --map cost --plot c.svg"), 0);
    read_text("c.svg", out);
    check_contains(out, "Prices of whole units only.", "map");
    check_contains(out, "MEMS, HG4930", "map");
    assert_null(strstr(out, "one gyro"));
    assert_int_equal(run("$I grade tactical --map sensor-cost --plot c.svg"), 0);
    read_text("c.svg", out);
    check_contains(out, "Prices of single gyros only.", "map");
    assert_null(strstr(out, "whole unit"));
    assert_null(strstr(out, "HG4930"));
    sweep();
}

/* That a place means nothing stands on the map itself, for what is not stated, zero, and outside;
 * a model that has its place is not named. */
static void test_note_is_on_the_map(void **state)
{
    (void)state;
    put("z.yaml", "imukit: 1\ngyro: {bias: {repeatability: 2 deg/h}, scale_factor: {repeatability: "
                  "0 ppm}}\naccel: {scale_factor: {repeatability: 30 ppm}}\n");
    put("o.yaml", "imukit: 1\ngyro: {bias: {repeatability: 1e-9 deg/h}, scale_factor: "
                  "{repeatability: 90 %}}\n");
    assert_int_equal(run("$I grade tactical z.yaml o.yaml HG1700 --map gyro --plot m.svg"), 0);
    read_text("m.svg", out);
    check_contains(out, "Dashed outlines: limits from memory; each may be wrong by a factor of ten",
                   "map");
    check_contains(out, "ESG, at the left edge, has no scale factor: its place", "map");
    check_contains(out,
                   ">HG1700 states no scale factor: a dashed line, whose place along that axis "
                   "means nothing.<",
                   "map");
    check_contains(out, ">z.yaml states no scale factor: a dashed line", "map");
    check_contains(out, ">o.yaml has its bias outside the map: drawn at the edge", "map");
    check_contains(out, ">o.yaml has its scale factor outside the map: drawn at the edge", "map");
    assert_null(strstr(out, ">tactical states"));
    assert_null(strstr(out, ">tactical has"));
    if (check_quick()) { /* the rest goes the same way */
        sweep();
        return;
    }
    assert_int_equal(run("$I grade tactical z.yaml o.yaml --map accel --plot m.svg"), 0);
    read_text("m.svg", out);
    check_contains(out, ">z.yaml states no bias: a dashed line", "map");
    check_contains(out, ">o.yaml states no scale factor and no bias: it is not on this map.<",
                   "map");
    sweep();
}

static json_t *member(json_t *object, const char *a, const char *b)
{
    return json_object_get(json_object_get(object, a), b);
}

/* As data: the regions of the library, the places of the models, and what a device measures. */
static void test_maps_as_data(void **state)
{
    (void)state;
    static const char *const keys[IMK_GRADE_MAPS] = {"gyro", "accel", "cost", "sensor_cost"};
    json_t *models = models_of("$I grade tactical HG1700 STIM300 --json");
    json_t *maps = member(document, "result", "maps");
    for (int map = 0; map < IMK_GRADE_MAPS; map++) {
        json_t *regions = member(maps, keys[map], "regions");
        const size_t count = imk_map_region_count((imk_grade_map)map);
        assert_int_equal(json_array_size(regions), count);
        for (size_t i = 0; i < count; i++) {
            const imk_map_region *of = imk_map_region_get((imk_grade_map)map, i);
            json_t *region = json_array_get(regions, i);
            assert_string_equal(word(region, "name"), of->name);
            assert_string_equal(word(region, "source"), of->source);
            assert_true(json_number_value(member(region, "y", "high")) == of->y_high);
            assert_int_equal(json_is_null(json_object_get(region, "x")), isnan(of->x_low));
            assert_int_equal(json_is_true(json_object_get(region, "from_memory")), of->doubt > 1);
        }
    }
    json_t *places = json_object_get(json_array_get(models, 1), "places");
    assert_string_equal(word(json_object_get(places, "gyro"), "x"), "not stated");
    assert_string_equal(word(json_object_get(places, "gyro"), "y"), "stated");
    assert_true(json_is_true(member(places, "gyro", "drawn")));
    assert_string_equal(word(json_object_get(places, "cost"), "y"), "not stated");
    json_t *size = json_object_get(member(json_array_get(models, 2), "build", "size"), "value");
    CHECK_RELATIVE(json_number_value(json_array_get(size, 1)), 0.0448, 1e-12);
    assert_true(json_is_null(json_object_get(json_array_get(models, 0), "build")));
    json_decref(document);
    sweep();
}

/* The catalogue and the comparison show what was read of size, mass and supply. */
static void test_builds_are_shown(void **state)
{
    (void)state;
    assert_int_equal(run("$I devices VN-100"), 0);
    check_contains(out, "\n# size: 24 x 22 x 3 mm\n# mass: 3.5 g\n# supply: below 105 mW\n", out);
    assert_int_equal(run("$I devices bmi"), 0);
    check_contains(out, "size [mm]  mass [g]   supply\n", out);
    check_contains(out, "2.5 x 3 x 0.8         -  0.95 mA\n", out);
    if (check_quick()) { /* the rest goes the same way */
        sweep();
        return;
    }
    assert_int_equal(run("$I grade STIM300 tactical"), 0);
    check_contains(out, "\nSTIM300  38.6 x 44.8 x 21.5         -       -  data sheet TS1524", out);
    assert_int_equal(run("$I grade tactical"), 0);
    assert_null(strstr(out, "size [mm]"));
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
                                       cmocka_unit_test(test_maps),
                                       cmocka_unit_test(test_noise_is_drawn),
                                       cmocka_unit_test(test_prices_are_apart),
                                       cmocka_unit_test(test_note_is_on_the_map),
                                       cmocka_unit_test(test_maps_as_data),
                                       cmocka_unit_test(test_builds_are_shown)};
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
