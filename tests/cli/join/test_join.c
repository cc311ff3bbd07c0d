/* SPDX-License-Identifier: Apache-2.0 */
/* imukit join: from designs and calibrations to a unit that is navigated, and what is refused. */
#include "cli/run_command.h"

#include "imukit/model_file.h"

#include <math.h>

static imk_model read_model(const char *path)
{
    imk_model model;
    imk_error error;
    if (imk_model_read(path, &model, NULL, &error) != IMK_OK)
        fail_msg("%s: %s %s", path, error.field, error.expected);
    return model;
}

static void put_designs(void)
{
    assert_int_equal(run("$I physics fibre_optic --reduce -o gyro.yaml && "
                         "$I physics pendulous_servo --reduce -o accel.yaml"),
                     0);
}

/* Variance of the CEP's figure that the sources of a sensor have in a budget. */
static double figure_of(const char *line, const char *source)
{
    json_error_t problem;
    if (run(line) != 0)
        fail_msg("%s: %s", line, err);
    json_t *document = json_loads(out, 0, &problem), *term;
    assert_non_null(document);
    json_t *models = json_object_get(json_object_get(document, "result"), "models");
    json_t *budget = json_object_get(json_array_get(models, 0), "budget");
    double figure = (double)NAN;
    size_t i;
    json_array_foreach(budget, i, term)
    {
        json_t *cep = json_object_get(json_object_get(term, "figures"), "cep");
        if (strcmp(json_string_value(json_object_get(term, "source")), source) == 0)
            figure = json_number_value(json_object_get(cep, "value"));
    }
    json_decref(document);
    return figure;
}

/* The unit's errors are those of its parts, and every verb takes it. */
static void test_from_designs_to_navigation(void **state)
{
    (void)state;
    put_designs();
    assert_int_equal(run("$I join accel.yaml gyro.yaml -o unit.yaml"), 0);
    assert_string_equal(err, "");
    check_contains(out, "gyros           3     gyro.yaml\naccelerometers  3     accel.yaml\n", out);
    check_contains(out, "their axes are taken as parallel", out);
    check_contains(out, "Next: imukit drift unit.yaml\n", out);
    static const char *const sources[] = {"gyro.bias.repeatability", "accel.bias.repeatability",
                                          "accel.bias.fixed"};
    for (int i = 0; i < 3; i++) {
        char alone[120];
        snprintf(alone, sizeof alone, "$I drift %s.yaml -d 1h --json 2>/dev/null",
                 i == 0 ? "gyro" : "accel");
        const double due = figure_of(alone, sources[i]);
        assert_true(due > 1);
        CHECK_RELATIVE(figure_of("$I drift unit.yaml -d 1h --json 2>/dev/null", sources[i]), due,
                       1e-9);
    }
    assert_int_equal(run("$I drift unit.yaml -d 1h 2>&1 >/dev/null"), 0);
    assert_null(strstr(out, "perfect ones"));
    assert_int_equal(run("$I grade unit.yaml"), 0);
    check_contains(out, "Position: ", out);
    assert_null(strstr(out, "not computed"));
    assert_int_equal(run("$I simulate unit.yaml --temperature 20degC -r 100Hz -d 90s "
                         "--latitude 45deg -o log.csv && $I navigate log.csv --position "
                         "'45 deg, 11 deg, 0 m' --align 60s --model unit.yaml >/dev/null"),
                     0);
    /* One of them alone says how to get there. */
    assert_int_equal(run("$I drift gyro.yaml -d 1min"), 0);
    check_contains(err, "imukit join gyro.yaml MODEL -o UNIT.yaml adds those of another model",
                   err);
    sweep();
}

/* Calibrated triads of two units, apart and together: 1 sigmas and correlations go over. */
static void test_calibrated_parts(void **state)
{
    (void)state;
    put("cal.yaml", "imukit: 1\n"
                    "gyro: {bias: {fixed: 1 2 3 ± 0.1 deg/h}, scale_factor: {fixed: 10 ± 5 ppm}}\n"
                    "accel: {bias: {fixed: 1 2 3 ± 0.1 mg}, scale_factor: {fixed: 9 ± 5 ppm}}\n"
                    "correlation:\n"
                    "  parameters: [gyro.bias.fixed.x, accel.bias.fixed.x, "
                    "accel.scale_factor.fixed.x]\n"
                    "  values: [0.1, 0.2 -0.5]\n");
    put("other.yaml", "imukit: 1\ngyro: {bias: {fixed: 7 ± 0.5 deg/h}}\n"
                      "timing: {jitter: 5 us}\n");
    check_message("$I join cal.yaml other.yaml -o unit.yaml", 2,
                  "imukit join: error: gyro: both cal.yaml and other.yaml give it; take one of "
                  "them: --gyro MODEL\n" TRY("join"));
    assert_int_equal(run("$I join cal.yaml --gyro other.yaml -o unit.yaml --name 'my unit'"), 0);
    const imk_model unit = read_model("unit.yaml"), cal = read_model("cal.yaml");
    assert_string_equal(unit.name, "my unit");
    CHECK_RELATIVE(unit.gyro.bias.fixed.value[1], 7 * 4.84813681109536e-6, 1e-12);
    assert_memory_equal(&unit.accel.bias, &cal.accel.bias, sizeof unit.accel.bias);
    assert_int_equal(unit.correlation.count, 2);
    CHECK_CLOSE((double)unit.correlation.value[0], -0.5, 1e-6);
    CHECK_CLOSE(unit.timing.jitter.value, 5e-6, 1e-18);
    sweep();
}

/* Three gyros in the order given, or by the directions that they state. */
static void test_single_axes(void **state)
{
    (void)state;
    char text[200];
    for (int k = 0; k < 3; k++) {
        char name[20];
        static const char *const along[] = {"0 0 1", "1 0 0", "0 1 0"};
        snprintf(name, sizeof name, "%c.yaml", "abc"[k]);
        snprintf(text, sizeof text,
                 "imukit: 1\ngyro: {direction: [1 0 0], bias: {repeatability: %d deg/h}}\n", k + 1);
        put(name, text);
        snprintf(name, sizeof name, "%c.yaml", "def"[k]);
        snprintf(text, sizeof text,
                 "imukit: 1\ngyro: {direction: [%s], bias: {repeatability: %d deg/h}}\n", along[k],
                 k + 1);
        put(name, text);
    }
    put("accel.yaml", "imukit: 1\naccel: {bias: {repeatability: 1 mg}}\n");
    static const struct {
        const char *line;
        int due[3]; /* repeatability of x, y, z [deg/h] */
    } known[] = {{"$I join a.yaml b.yaml c.yaml accel.yaml -o unit.yaml", {1, 2, 3}},
                 {"$I join c.yaml accel.yaml b.yaml a.yaml -o unit.yaml", {3, 2, 1}},
                 {"$I join d.yaml e.yaml f.yaml accel.yaml -o unit.yaml", {2, 3, 1}},
                 {"$I join --x c.yaml --y a.yaml --z d.yaml accel.yaml -o unit.yaml", {3, 1, 1}}};
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        if (run(known[i].line) != 0)
            fail_msg("%s: %s", known[i].line, err);
        const imk_model unit = read_model("unit.yaml");
        for (int k = 0; k < 3; k++)
            CHECK_RELATIVE(unit.gyro.bias.repeatability.value[k],
                           known[i].due[k] * 4.84813681109536e-6, 1e-12);
        assert_true(unit.accel.present);
    }
    check_message(
        "$I join a.yaml b.yaml e.yaml -o unit.yaml && $I join a.yaml b.yaml d.yaml "
        "-o unit.yaml >/dev/null",
        2,
        "imukit join: error: a.yaml, b.yaml and d.yaml are along two directions only; say "
        "which axis each is: --x MODEL --y MODEL --z MODEL\n" TRY("join"));
    check_message("$I join --x a.yaml --z b.yaml -o unit.yaml", 2,
                  "imukit join: error: --x, --y and --z go together, and --y is "
                  "missing\n" TRY("join"));
    check_message("$I join a.yaml -o unit.yaml", 2,
                  "imukit join: error: join takes two models or more\n" TRY("join"));
    check_message("$I join a.yaml accel.yaml", 2,
                  "imukit join: error: -o is missing: the model file of the unit, such as -o "
                  "unit.yaml\n" TRY("join"));
    check_message("$I join a.yaml accel.yaml --mag a.yaml -o unit.yaml", 1,
                  "imukit join: error: mag: a.yaml has none; expected a part that has such "
                  "sensors\n");
    assert_int_equal(run("$I join a.yaml b.yaml c.yaml accel.yaml -o unit.yaml --json"), 0);
    check_contains(out, "\"code\": \"parallel\"", out);
    check_contains(out, "\"b.yaml\"", out);
    assert_int_equal(run("$I join a.yaml b.yaml c.yaml accel.yaml -o -"), 0);
    check_contains(out, "name: joined\n", out);
    sweep();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_from_designs_to_navigation),
        cmocka_unit_test(test_calibrated_parts),
        cmocka_unit_test(test_single_axes),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
